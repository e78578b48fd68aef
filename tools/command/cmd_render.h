/* The options of `fixsplat render`, and its functions. */
#ifndef CMD_RENDER_H
#define CMD_RENDER_H

#include <fixsplat/image.h>
#include "drawing.h"

typedef struct render_options {
    frame_options frame;
    enum fxs_format format;
    const char *output, *depth, *ids;
    const char *expect, *diff;              /* expected picture; output for the difference */
    int has_expected_hash;
    uint64_t expected_hash;                 /* used instead of a picture */
    enum fxs_image_format encoding;         /* output format; FXS_IMAGE_UNKNOWN: y4m for several views, png for one */
    int quality, rate;                      /* quality of .jpg and .webp, 0: best; frames a second of a .y4m */
    int draws;                              /* DRAW_* */
    double depth_range;                     /* 0: the picture's own range */
    int has_pick, pick[2], has_scissor, scissor[4];
    int hash, stats, pairs, json;
} render_options;

/* Renders all views; writes, compares and prints as the options say. Returns the exit status. */
int render_views(const render_options *o);

/* Print the results of --stats or --pick for a view. Return 0, or print the error and return EXIT_FAILED. */
int print_stats(const renderer *r, const render_options *o, const world *w, const fxs_file_view *view,
                const fxs_stats *stats);
int print_pick(renderer *r, const render_options *o, const world *w, const fxs_file_view *view);

#endif
