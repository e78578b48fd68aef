/* Refines the levels of detail of a packed scene: coarse Gaussians are fitted to pictures of the fine ones, and what
 * opening each node is worth is measured in these pictures, with all that hides it.
 *
 * The result is a function of the scene, the views and the number of steps, the same with any number of threads and on
 * every processor. docs/convert.md says what it brings.
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

#define FXS_REFINE_STEPS 200u          /* steps of a level that are usual, */
#define FXS_REFINE_STEPS_MOST 100000u  /* and the most */
#define FXS_REFINE_VIEWS 64u           /* views, at most, */
#define FXS_REFINE_MEASURED 16u        /* and without steps */

typedef struct fxs_refine_options {
    const fxs_context *context;        /* renders; its run, pool and threads also make the steps. Not null */
    uint32_t steps;                    /* of each level, at most FXS_REFINE_STEPS_MOST. 0: the Gaussians stay as they
                                          are, and only what opening the nodes is worth is measured */
    const fxs_file_view *views;        /* cameras that show the scene as it will be seen, null: there are none. Those */
    size_t view_count;                 /* in perspective are used, FXS_REFINE_VIEWS at most (without
                                          steps FXS_REFINE_MEASURED), evenly spaced */
    unsigned cpu;                      /* instruction sets that may be used for steps, bits of enum fxs_cpu */
    fxs_progress_fn *progress;         /* may be null */
    void *argument;                    /* first argument of progress */
} fxs_refine_options;

/* Refines the packed scene of `bytes` bytes at `data` (aligned to 64), in place; fxs_file_write or fxs_file_seal come
   after it. A scene without a tree stays as it is. Where there are no views in perspective, the views are from around
   and within the box of what is seen. It takes 1.3 KB for each Gaussian of the finest level that is refined, and up to
   200 MB of pictures, of a scene of more than a million up to 1.4 GB; without steps an eighth of that. Returns 0, or an
   error and a message, after which levels may be refined in part and can be drawn all the same: FXS_ERR_ARGUMENT,
   FXS_ERR_STOPPED, FXS_ERR_MEMORY, and those of fxs_scene_open, of nodes too. */
FXS_API int fxs_refine(void *data, size_t bytes, const fxs_refine_options *options, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
