/* The renderer of a subcommand, and the pictures that it renders. */
#ifndef DRAWING_H
#define DRAWING_H

#include <fixsplat/backend.h>
#include "frame_options.h"

/* Flags of the optional render targets. */
enum { DRAW_MEAN_DEPTH = 1, DRAW_MEDIAN_DEPTH = 2, DRAW_IDS = 4 };

/* A rendered picture. A stereo picture has the left eye in its left half. */
typedef struct picture {
    uint8_t *pixels;
    uint32_t *depths;                       /* depths in fixed point with depth_bits fraction bits */
    fxs_id *ids;
    size_t pixel_room, depth_room, id_room;
    int width, height, depth_bits;
} picture;

void picture_free(picture *p);

typedef struct renderer {
    const fxs_backend *backend;
    void *self;                             /* private state of the back end; null: closed */
    fxs_backend_options how;                /* options of the open back end */
    int is_auto;                            /* 1: the processor replaces a back end that lacks a feature or fails */
    double stereo;                          /* distance of the eyes in scene units; 0: mono */
    size_t max_memory;
    enum fxs_format format;
    int draws;                              /* flags DRAW_* of render targets; at most one kind of depth */
    int mirrored;                           /* 1: the right eye's field of view mirrors the left one's */
    int has_scissor, scissor[4];            /* part of the picture to draw: x, y, width, height */
    int shows_part;    /* for scenes partly in memory: 1 draws what is loaded; 0 waits until no part is missing */
    int gazes, gaze[4];                     /* as in frame_options */
    uint8_t *rates;
    size_t rate_room;
    int lost;                               /* 1: a missing part of the last picture could not be read */
    fxs_message why_lost;                   /* reason why the part could not be read */
} renderer;

/* Opens the first device of the back end that the options name. Set `format`, `draws` and the scissor after this
   call. */
int renderer_open(renderer *r, const frame_options *options);

/* True if large scenes are paged (kept partly in memory) without --pool. Not so with CUDA, which chooses the level of
   detail of whole scenes on the device, faster than of paged scenes. */
int renderer_pages(const renderer *r);

void renderer_close(renderer *r);

/* Frees the back end's copies of a world's scenes. Call renderer_forget before closing the world. */
void renderer_forget(renderer *r, const world *w);

int renderer_camera(const renderer *r, const fxs_view *view, fxs_camera *camera);

/* Renders a view into *out, whose buffers grow as needed. `stats` may be null. */
int renderer_render(renderer *r, const world *w, const fxs_view *view, const fxs_options *options, picture *out,
                    fxs_stats *stats);

/* Finds the object and the Gaussian at a pixel. Returns 1 if found; 0: empty pixel; -1: failure. */
int renderer_pick(renderer *r, const world *w, const fxs_view *view, const fxs_options *options, int x, int y,
                  fxs_pick_result *result);

#endif
