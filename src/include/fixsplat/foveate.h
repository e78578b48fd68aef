/* Foveated rendering: combines the whole picture at a quarter of its resolution, a window at half, and a smaller window
 * around the gaze at full resolution. Each of these three pictures (rings) has the same pixels with every back end, so
 * the result has too. Pixels at full resolution are the same as without foveation.
 *
 * A window is a square around the gaze, 2 * radius pixels wide, rounded to whole tiles of 16x16 of the window's pixels.
 * Near an edge of the picture it is moved inside. Pixels at half and quarter resolution are centred on 2x2 and 4x4
 * pixels of the picture and enlarged bilinearly, in integers. In a band along the inside of its edges, a window fades
 * into the coarser picture, except at the edges of the whole picture. A coarser ring omits Gaussians that a finer ring
 * covers completely.
 *
 * Not stable: may change with every version. */
#ifndef FXS_FOVEATE_H
#define FXS_FOVEATE_H

#include "backend.h"

#ifdef __cplusplus
extern "C" {
#endif

#define FXS_RINGS 3                /* at full, half and quarter resolution */

typedef struct fxs_foveation {
    int32_t gaze[2][2];            /* x, y of the pixel that each eye looks at; may lie outside the picture */
    int32_t radius[2];             /* windows at full and half resolution, pixels: 1 to FXS_MAX_SIZE, second larger */
    int32_t band;                  /* width of the fading, pixels, 0 to radius[0] */
} fxs_foveation;

/* Sets the gaze to the principal point, the radii to a fifth and two fifths of the picture's shorter side, and the band
   to a quarter of the first radius. At 1280x720, this renders a quarter of the pixels. */
FXS_API void fxs_foveation_init(fxs_foveation *foveation, const fxs_camera *cameras, uint32_t eyes);

/* One of the three combined pictures, at full, half or quarter resolution. */
typedef struct fxs_ring {
    int32_t rate;                  /* width of its pixels in pixels of the whole picture: 1, 2 or 4 */
    int32_t x[2], y[2];            /* its first pixel for each eye, in pixels of the whole picture */
    int32_t width, height;         /* in its own pixels; multiply by `rate` for pixels of the whole picture */
    fxs_stats stats;
} fxs_ring;

typedef struct fxs_foveated {
    uint32_t count;                /* number of rings; fewer than FXS_RINGS if a window covers the picture */
    fxs_ring rings[FXS_RINGS];
    fxs_stats stats;               /* sums of the rings' counts and times; memory of the largest ring */
    uint64_t device_nanoseconds;   /* time of the back end's device; 0 without a clock */
    uint64_t compose_nanoseconds;  /* included in the frame's time of `stats` */
} fxs_foveated;

/* Bytes of memory that fxs_foveate needs for the rings; 0 if an argument is out of range. */
FXS_API size_t fxs_foveation_bytes(const fxs_foveation *foveation, const fxs_camera *cameras, uint32_t eyes);

/* Renders a request foveated, with a back end. A budget is divided among the rings in proportion to their pixels. Each
   eye must have a colour target of FXS_FORMAT_RGBA8 or RGBA8_COVERAGE and no other target, occluder or backdrop; else
   FXS_ERR_UNSUPPORTED. The pictures of two eyes must have the same size. `memory` has `memory_bytes` bytes, aligned to
   4, at least fxs_foveation_bytes. `run` and `pool`, as in fxs_config, combine the rings; a null `run` uses the calling
   thread. `out` may be null. Errors: FXS_ERR_ARGUMENT, FXS_ERR_SIZE, FXS_ERR_CAMERA, FXS_ERR_TARGET (rows longer than
   their stride), FXS_ERR_MEMORY, FXS_ERR_UNSUPPORTED, and the back end's errors. After an error the targets are
   unchanged. */
FXS_API int fxs_foveate(const fxs_backend *backend, void *self, const fxs_request *request,
                        const fxs_foveation *foveation, void *memory, size_t memory_bytes, fxs_run_fn *run, void *pool,
                        fxs_foveated *out, fxs_message *why);

#ifdef __cplusplus
}
#endif

#endif
