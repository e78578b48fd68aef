/* Writes the page of `fixsplat publish --single`: one file with scripts and scene inside. */
#ifndef PUBLISH_SINGLE_H
#define PUBLISH_SINGLE_H

#include "frame_options.h"

typedef struct single_page {
    const char *package;
    const char *title;
    const char *scene;
    const char *name;
    char *const *words;
    const struct publish_start *start;
    int has_profile;               /* 1: packs an .fxs file again, with the compression profile of the options */
} single_page;

/* Writes the HTML page to the file `out`, as a whole or not at all. */
int write_single(const single_page *page, const frame_options *frame, const char *out, size_t *bytes);

#endif
