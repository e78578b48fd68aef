/* The options of `fixsplat render`, and what follows from them. */
#ifndef CMD_RENDER_H
#define CMD_RENDER_H

#include <fixsplat/image_file.h>
#include "drawing.h"

typedef struct render_options {
    frame_options frame;
    enum fxs_format format;
    const char *output, *depth, *ids;
    const char *expect, *diff;              /* a picture, and where to write how it differs */
    int has_expected_hash;
    uint64_t expected_hash;                 /* in the place of that picture */
    enum fxs_image_format encoding;         /* of the output; FXS_IMAGE_UNKNOWN: y4m of several, png of one */
    int quality, rate;                      /* of .jpg and .webp, 0: the best; frames a second of a .y4m */
    int draws;                              /* DRAW_* */
    double depth_range;                     /* 0: that of the picture */
    int has_pick, pick[2], has_scissor, scissor[4];
    int hash, stats, pairs, json;
} render_options;

/* Renders all views and writes, compares and prints what is asked of them. Returns the exit status. */
int render_views(const render_options *o);

/* Print the answer to --stats or --pick for a view. Return 0, or print what is wrong and return EXIT_FAILED. */
int print_stats(const renderer *r, const render_options *o, const world *w, const fxs_file_view *view,
                const fxs_stats *stats);
int print_pick(renderer *r, const render_options *o, const world *w, const fxs_file_view *view);

#endif
