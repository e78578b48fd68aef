/* Prints the HTML pages of `fixsplat publish` and `fixsplat view --web`. */
#ifndef SCENE_PAGES_H
#define SCENE_PAGES_H

#include <stdio.h>

/* Prints a format with %s conversions only. The inserted texts are escaped for HTML. */
void print_html(FILE *file, const char *format, ...);

void print_page_head(FILE *file, const char *title);

/* These functions print a list of scenes: print_list_head once, then print_listed for each scene. `picture`, the
   address of a preview picture, may be null. */
void print_list_head(FILE *file, const char *title, const char *viewer);
void print_listed(FILE *file, const char *address, const char *picture, const char *title);

#endif
