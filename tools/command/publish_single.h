/* `fixsplat publish --single`: a page in one file, with scripts and scene inside. */
#ifndef PUBLISH_SINGLE_H
#define PUBLISH_SINGLE_H

#include "frame_options.h"

typedef struct single_page {
    const char *package;           /* folder of the npm package */
    const char *title;
    const char *scene;             /* path of the scene */
    const char *name;              /* name of the scene in the page, without an ending */
    char *const *words;            /* the command line */
    int has_profile;               /* 1: an .fxs is also packed in the options' profile */
} single_page;

/* Writes the page to `out`, whole or not at all. Its picture has the size of `frame`. Returns 0 and its size in
   bytes, or prints the reason and returns EXIT_FAILED. */
int write_single(const single_page *page, const frame_options *frame, const char *out, size_t *bytes);

#endif
