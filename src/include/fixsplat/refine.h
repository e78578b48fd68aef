/* Refines the levels of detail of a packed scene: fits coarse Gaussians to pictures of the fine ones, and measures for
 * each node how much its children improve these pictures, occlusion included.
 *
 * The result is a function of the scene, the views and the number of steps, the same with any number of threads and on
 * every processor. docs/convert.md has measurements.
 *
 * Stable from version 1.0 on. */
#ifndef FXS_REFINE_H
#define FXS_REFINE_H

#include <stddef.h>
#include <stdint.h>

#include "camera_file.h"
#include "fixsplat.h"
#include "input.h"

#ifdef __cplusplus
extern "C" {
#endif

#define FXS_REFINE_STEPS 200u          /* usual steps per level */
#define FXS_REFINE_STEPS_MOST 100000u  /* most steps per level */
#define FXS_REFINE_VIEWS 64u           /* most views */
#define FXS_REFINE_MEASURED 16u        /* most views without steps */

typedef struct fxs_refine_options {
    const fxs_context *context;        /* renders; its run, pool and threads also make the steps. Not null */
    uint32_t steps;                    /* per level, at most FXS_REFINE_STEPS_MOST. 0: leaves the Gaussians unchanged
                                          and only measures the gain of drawing each node's children */
    /* Cameras that show the scene as viewers will see it; null: none. Only perspective views are used, at most
       FXS_REFINE_VIEWS (without steps FXS_REFINE_MEASURED), evenly spaced. */
    const fxs_file_view *views;
    size_t view_count;
    unsigned cpu;                      /* allowed instruction sets for the steps, bits of enum fxs_cpu */
    fxs_progress_fn *progress;         /* may be null */
    void *argument;                    /* first argument of progress */
} fxs_refine_options;

/* Refines the packed scene of `bytes` bytes at `data` (aligned to 64), in place; call fxs_file_write or fxs_file_seal
   afterwards. A scene without a tree is unchanged. Without perspective views, it uses views from around and inside the
   box of the scene's visible part. Takes 1.3 KB for each Gaussian of the finest refined level, and up to 200 MB of
   pictures, or 1.4 GB for a scene of more than a million Gaussians; without steps an eighth of that. Returns 0, or an
   error and a message; levels may then be partly refined, and the scene can still be drawn. Errors: FXS_ERR_ARGUMENT,
   FXS_ERR_STOPPED, FXS_ERR_MEMORY, and the errors of fxs_scene_open, also for nodes. */
FXS_API int fxs_refine(void *data, size_t bytes, const fxs_refine_options *options, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
