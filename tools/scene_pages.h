/* The HTML of pages that `fixsplat publish` writes and `fixsplat view --web` serves. */
#ifndef SCENE_PAGES_H
#define SCENE_PAGES_H

#include <stdio.h>

/* Prints a format in which each %s is a text, written as HTML wants it. */
void print_html(FILE *file, const char *format, ...);

/* Up to what the body begins with. */
void print_page_head(FILE *file, const char *title);

/* The page of a list: its beginning, with the address of the viewer's folder; then each scene with its address and its
   picture, null where that comes later. */
void print_list_head(FILE *file, const char *title, const char *viewer);
void print_listed(FILE *file, const char *address, const char *picture, const char *title);

#endif
