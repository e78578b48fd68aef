/* The renderer of a command: an open back end, and the pictures that it draws. */
#ifndef DRAWING_H
#define DRAWING_H

#include <fixsplat/foveate.h>
#include <fixsplat/pool.h>
#include "frame_options.h"

/* Render targets beside colour. */
enum { DRAW_MEAN_DEPTH = 1, DRAW_MEDIAN_DEPTH = 2, DRAW_IDS = 4 };

/* A picture in memory. Stereo: the left eye is in the left half. All fields 0: empty. */
typedef struct picture {
    uint8_t *pixels;                        /* RGBA */
    uint32_t *depths;                       /* depth times 2^depth_bits, as in fxs_targets */
    fxs_id *ids;
    size_t pixel_room, depth_room, id_room; /* allocated bytes */
    int width, height, depth_bits;
} picture;

void picture_free(picture *p);

typedef struct renderer {
    const fxs_backend *backend;
    void *self;                             /* state of the back end; null: closed */
    double stereo;                          /* distance of the eyes, scene units; 0: mono */
    size_t max_memory;
    enum fxs_format format;
    int draws;                              /* DRAW_* flags; at most one kind of depth */
    int mirrored;                           /* 1: mirror the field of view for the right eye */
    int has_scissor, scissor[4];            /* x, y, width, height in pixels */
    foveate_options foveate;
    int shows_part;                         /* paged worlds; 1: draw without missing chunks; 0: wait */
    int lost;                               /* 1: a chunk of the last picture cannot be read */
    fxs_message why_lost;
    int divisor;                            /* reduction of the picture that `foveate` is meant for; 0: 1 */
    void *rings;                            /* pixels of foveated rings */
    size_t ring_room;
    fxs_pool *pool;
    fxs_foveation foveation;                /* of the last picture */
    fxs_foveated foveated;
} renderer;

/* Opens the first device of the back end that the options name. Returns 0, or prints the reason and returns an exit
   status; then nothing is to be closed. `format`, `draws` and the scissor may be set afterwards. */
int renderer_open(renderer *r, const frame_options *options);

/* Tests for support of paged scenes, which are partly in memory. */
int renderer_may_page(const renderer *r);

void renderer_close(renderer *r);

/* Frees the back end's copies of a world's scenes, before the world is closed. */
void renderer_forget(renderer *r, const world *w);

/* Computes the camera of a view, cropped to the scissor. Returns 0, or prints the reason and returns EXIT_FAILED. */
int renderer_camera(const renderer *r, const fxs_file_view *view, fxs_camera *camera);

/* Renders into *out, which grows as needed. `stats` may be null. Returns 0, or prints the reason and returns
   EXIT_FAILED. */
int renderer_render(renderer *r, const world *w, const fxs_file_view *view, const fxs_options *options, picture *out,
                    fxs_stats *stats);

/* Finds the object and Gaussian at a pixel. Returns 1 if found; 0: empty pixel; -1: failure, with the reason
   printed. */
int renderer_pick(renderer *r, const world *w, const fxs_file_view *view, const fxs_options *options, int x, int y,
                  fxs_pick_result *result);

#endif
