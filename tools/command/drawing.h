/* The renderer of a command: an open back end, and the pictures that it draws. */
#ifndef DRAWING_H
#define DRAWING_H

#include <fixsplat/backend.h>
#include "frame_options.h"

/* Targets besides colour. */
enum { DRAW_MEAN_DEPTH = 1, DRAW_MEDIAN_DEPTH = 2, DRAW_IDS = 4 };

/* A rendered picture; stereo: the left eye on the left half. All fields 0: empty. */
typedef struct picture {
    uint8_t *pixels;                        /* RGBA */
    uint32_t *depths;                       /* times 2^depth_bits, as in fxs_targets */
    fxs_id *ids;
    size_t pixel_room, depth_room, id_room; /* bytes allocated */
    int width, height, depth_bits;
} picture;

void picture_free(picture *p);

typedef struct renderer {
    const fxs_backend *backend;
    void *self;                             /* the back end's state; null: closed */
    double stereo;                          /* as in frame_options */
    size_t max_memory;
    enum fxs_format format;
    int draws;                              /* DRAW_*; at most one kind of depth */
    int mirrored;                           /* 1: the right eye's field of view mirrors the left one's */
    int has_scissor, scissor[4];            /* part of the picture to draw: x, y, width, height */
    int shows_part;                         /* paged worlds: 1 draws with the chunks that are loaded; 0 waits until
                                               none is missing */
    int lost;                               /* with shows_part: a chunk of the last picture cannot be read; */
    fxs_message why_lost;                   /* the reason */
} renderer;

/* Opens the back end that the options name, on their first device. `format`, `draws` and the scissor may be set
   afterwards. Returns 0, or prints the reason and returns EXIT_FAILED or EXIT_USAGE (unknown --cpu or --backend),
   with nothing to close. */
int renderer_open(renderer *r, const frame_options *options);

/* True if the renderer can draw paged scenes. */
int renderer_may_page(const renderer *r);

void renderer_close(renderer *r);

/* Drops the back end's copies of a world's scenes. Call it before they are closed if the renderer is used
   afterwards. */
void renderer_forget(renderer *r, const world *w);

/* The camera of a view, cropped to the scissor if set. Returns 0, or prints the reason and returns EXIT_FAILED. */
int renderer_camera(const renderer *r, const fxs_file_view *view, fxs_camera *camera);

/* Renders into *out, which grows as needed. *stats may be null. Returns 0, or prints the reason and returns
   EXIT_FAILED. */
int renderer_render(renderer *r, const world *w, const fxs_file_view *view, const fxs_options *options, picture *out,
                    fxs_stats *stats);

/* Finds the object and Gaussian at a pixel. Returns 1, 0 if the pixel is empty, or prints the reason and returns -1. */
int renderer_pick(renderer *r, const world *w, const fxs_file_view *view, const fxs_options *options, int x, int y,
                  fxs_pick_result *result);

#endif
