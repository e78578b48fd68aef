/* HTML of the pages that `fixsplat publish` writes and `fixsplat view --web` serves. */
#ifndef SCENE_PAGES_H
#define SCENE_PAGES_H

#include <stdio.h>

/* Prints a format whose only conversion is %s; its texts are escaped for HTML. */
void print_html(FILE *file, const char *format, ...);

/* Prints the page up to the start of its body. */
void print_page_head(FILE *file, const char *title);

/* The page of a list: print_list_head, with the address of the viewer's folder, then print_listed for each scene;
   `picture` may be null. */
void print_list_head(FILE *file, const char *title, const char *viewer);
void print_listed(FILE *file, const char *address, const char *picture, const char *title);

#endif
