/* The renderer of the command: an open back end, and the pictures that it draws. */
#ifndef DRAWING_H
#define DRAWING_H

#include <fixsplat/foveate.h>
#include <fixsplat/pool.h>
#include "frame_options.h"

/* What is drawn beside colour. */
enum { DRAW_MEAN_DEPTH = 1, DRAW_MEDIAN_DEPTH = 2, DRAW_IDS = 4 };

/* What was drawn; of two eyes side by side, the left one left. All 0: nothing yet. */
typedef struct picture {
    uint8_t *pixels;                        /* RGBA */
    uint32_t *depths;                       /* times 2^depth_bits, as fxs_targets has them */
    fxs_id *ids;
    size_t pixel_room, depth_room, id_room; /* bytes */
    int width, height, depth_bits;
} picture;

void picture_free(picture *p);

typedef struct renderer {
    const fxs_backend *backend;
    void *self;                             /* the back end's; null: not open */
    double stereo;                          /* as in frame_options */
    int stereo_exact;
    size_t max_memory;
    enum fxs_format format;
    int draws;                              /* DRAW_*; depths of one kind */
    int mirrored;                           /* the right eye's field of view is the left one's mirror */
    int has_scissor, scissor[4];            /* what is drawn of the picture: x, y, width, height */
    foveate_options foveate;
    int shows_part;                         /* of a world of which a part is in memory, a picture is what is there; 0:
                                               it waits until all that it takes has come */
    int lost;                               /* of such a picture: something of it cannot be read, */
    fxs_message why_lost;                   /* and why */
    int divisor;                            /* its numbers are of a picture so many times as large; 0: 1 */
    void *rings;                            /* of foveated pictures */
    size_t ring_room;                       /* bytes */
    fxs_pool *pool;                         /* that put them together */
    fxs_foveation foveation;                /* of the last picture */
    fxs_foveated foveated;
} renderer;

/* Opens the back end that the options name, on the first of their devices. `format`, `draws` and the scissor may be set
   after that. Returns 0, or prints why not and returns EXIT_FAILED or EXIT_USAGE (an unknown --cpu or --backend), with
   nothing to close. */
int renderer_open(renderer *r, const frame_options *options);

/* Whether it draws scenes of which a part is in memory. */
int renderer_may_page(const renderer *r);

void renderer_close(renderer *r);

/* To be called before the scenes of a world are closed, where the renderer is used afterwards. */
void renderer_forget(renderer *r, const world *w);

/* The camera of a view, or of the part of it that is drawn. Returns 0, or prints why not and returns EXIT_FAILED. */
int renderer_camera(const renderer *r, const fxs_file_view *view, fxs_camera *camera);

/* Renders into *out, making room where the size has changed. *stats may be null. Returns 0, or prints why not and
   returns EXIT_FAILED. */
int renderer_render(renderer *r, const world *w, const fxs_file_view *view, const fxs_options *options, picture *out,
                    fxs_stats *stats);

/* What the view shows at a pixel: 1, 0 where that is nothing, or -1 where it prints why not. */
int renderer_pick(renderer *r, const world *w, const fxs_file_view *view, const fxs_options *options, int x, int y,
                  fxs_pick_result *result);

#endif
