/* Foveated pictures: all of a picture at a quarter of its rate, a window of it at half, and one around the gaze at the
 * full rate, put together. In every window the pixels are those that the back end renders there, so the bytes are the
 * same by every exact back end; at the full rate they are those of the picture without foveation.
 *
 * A window is a square of twice its radius about the gaze, in whole tiles of 16x16 of its own pixels, moved into the
 * picture where the gaze is near an edge. Pixels of half and quarter rate lie centred on their 2x2 and 4x4 pixels and
 * are enlarged bilinearly, in integers. In a band along its edges, inside, a window fades into the coarser one; not
 * where it ends with the picture. Gaussians that are seen only where a finer ring hides a coarser one are left out of
 * that. */
#ifndef FXS_FOVEATE_H
#define FXS_FOVEATE_H

#include "backend.h"

#ifdef __cplusplus
extern "C" {
#endif

#define FXS_RINGS 3                /* full, half, quarter rate */

typedef struct fxs_foveation {
    int32_t gaze[2][2];            /* of each eye: x, y of the pixel looked at; may lie outside the picture */
    int32_t radius[2];             /* of the full and of the half rate, pixels: 1 to FXS_MAX_SIZE, the second larger */
    int32_t band;                  /* pixels, 0 to radius[0] */
} fxs_foveation;

/* Straight ahead (the principal point, which is the middle but for asymmetric fields of view), a fifth and two fifths
   of the picture's shorter side, a band of a quarter of the first: a quarter of the pixels at 1280x720. */
void fxs_foveation_init(fxs_foveation *foveation, const fxs_camera *cameras, uint32_t eyes);

/* What was rendered for one rate. */
typedef struct fxs_ring {
    int32_t rate;                  /* pixels of the picture across one of its own: 1, 2 or 4 */
    int32_t x[2], y[2];            /* of each eye: its first pixel, in pixels of the picture */
    int32_t width, height;         /* in its own pixels; of the picture it covers that times its rate */
    fxs_stats stats;
} fxs_ring;

typedef struct fxs_foveated {
    uint32_t count;                /* rings: fewer where one covers the picture */
    fxs_ring rings[FXS_RINGS];
    fxs_stats stats;               /* counts and times of all; the memory of the largest */
    uint64_t device_nanoseconds;   /* of the back end's device, where it has a clock */
    uint64_t compose_nanoseconds;  /* included in the frame's time of `stats` */
} fxs_foveated;

/* Bytes of memory for the rings of a picture, before they are put together. 0 where an argument is out of range. */
size_t fxs_foveation_bytes(const fxs_foveation *foveation, const fxs_camera *cameras, uint32_t eyes);

/* Renders a request by a back end, as its `render` does, foveated. Each eye has a colour target of FXS_FORMAT_RGBA8 or
   RGBA8_COVERAGE, with nothing else asked for or read; else FXS_ERR_UNSUPPORTED. The pictures of two eyes are of one
   size.
   `memory`: `memory_bytes` bytes, aligned to 4, at least fxs_foveation_bytes. `run` and `pool` as in fxs_config: for
   the putting together; null: this thread does. *out may be null. Errors: FXS_ERR_ARGUMENT, FXS_ERR_SIZE,
   FXS_ERR_CAMERA, FXS_ERR_TARGET (rows longer than their stride), FXS_ERR_MEMORY, FXS_ERR_UNSUPPORTED, and those of
   the back end; nothing is written to the targets then. */
int fxs_foveate(const fxs_backend *backend, void *self, const fxs_request *request, const fxs_foveation *foveation,
                void *memory, size_t memory_bytes, fxs_run_fn *run, void *pool, fxs_foveated *out, fxs_message *why);

#ifdef __cplusplus
}
#endif

#endif
