/* Options and functions of `fixsplat render`. */
#ifndef CMD_RENDER_H
#define CMD_RENDER_H

#include <fixsplat/image.h>
#include "drawing.h"

typedef struct render_options {
    frame_options frame;
    enum fxs_format format;
    const char *output, *depth, *ids, *cameras;
    const char *expect, *diff;
    int has_expected_hash;
    uint64_t expected_hash;
    enum fxs_image_format encoding;
    int quality;                            /* quality of .jpg and .webp files */
    int draws;
    double depth_range;                     /* largest depth that a depth picture can show; 0: automatic */
    int has_pick, pick[2], has_scissor, scissor[4];
    int hash, stats, pairs, json;
} render_options;

/* True if an option asks for pictures, not only for their cameras. */
int render_draws(const render_options *o);

/* Renders all views and writes, compares or prints them. Returns the exit status. */
int render_views(const render_options *o);

/* The options are those of the picture, with its moment. */
int print_stats(const renderer *r, const render_options *o, const world *w, const fxs_view *view,
                const fxs_options *options, const fxs_stats *stats);
int print_pick(renderer *r, const render_options *o, const world *w, const fxs_view *view, const fxs_options *options);

#endif
