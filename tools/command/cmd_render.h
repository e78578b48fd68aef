/* Options and functions of `fixsplat render`. */
#ifndef CMD_RENDER_H
#define CMD_RENDER_H

#include <fixsplat/image_file.h>
#include "drawing.h"

typedef struct render_options {
    frame_options frame;
    enum fxs_format format;
    const char *output, *depth, *ids;
    const char *expect, *diff;              /* paths of the expected picture and of the difference */
    int has_expected_hash;
    uint64_t expected_hash;
    enum fxs_image_format encoding;         /* FXS_IMAGE_UNKNOWN: y4m for several views, else png */
    int quality, rate;                      /* of .jpg and .webp, 0: best; frames per second of a .y4m */
    int draws;                              /* DRAW_* flags */
    double depth_range;                     /* depth shown as white; 0: range of the picture */
    int has_pick, pick[2], has_scissor, scissor[4];
    int hash, stats, pairs, json;
} render_options;

/* Renders all views and applies the outputs and checks of the options. Returns the exit status. */
int render_views(const render_options *o);

/* Prints --stats or --pick of a view. Returns 0 or an exit status. */
int print_stats(const renderer *r, const render_options *o, const world *w, const fxs_file_view *view,
                const fxs_stats *stats);
int print_pick(renderer *r, const render_options *o, const world *w, const fxs_file_view *view);

#endif
