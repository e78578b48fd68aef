/* `fixsplat publish --single`: a page as one file, with all that it needs inside. */
#ifndef PUBLISH_SINGLE_H
#define PUBLISH_SINGLE_H

#include "frame_options.h"

typedef struct single_page {
    const char *package;           /* the folder of the npm package */
    const char *title;
    const char *scene;             /* a path */
    const char *name;              /* of the scene in the page, without an ending */
    char *const *words;            /* of the command */
    int has_profile;               /* in which an .fxs is to be packed too */
} single_page;

/* Writes it to `out`, complete or not at all; the picture has the size of `frame`. Returns 0 and its size in bytes, or
   prints why not and returns EXIT_FAILED. */
int write_single(const single_page *page, const frame_options *frame, const char *out, size_t *bytes);

#endif
