/* Draws Gaussians as they are read, in single precision, by the forward pass of the fit: the pictures with which
 * packed scenes are compared. Functions return 0, or an error and a message. */
#ifndef FXS_FLOAT_SCENE_H
#define FXS_FLOAT_SCENE_H

#include <fixsplat/camera_file.h>
#include <fixsplat/gaussian.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_float_scene fxs_float_scene;

/* Reads an open scene file from its start, and keeps the Gaussians that fxs_pack would pack, with 68 bytes each, or 248
   at SH degree 3; drawing takes 96 more. `run` (null: one thread), `pool` and `threads` are as in fxs_pack_options.
   fxs_float_scene_free frees *scene, which is null after an error. */
int fxs_float_scene_read(fxs_float_scene **scene, fxs_scene_file *file, const fxs_scene_file_info *info,
                         fxs_run_fn *run, void *pool, uint32_t threads, fxs_message *message);
void fxs_float_scene_free(fxs_float_scene *scene);   /* null is allowed */

/* Moves each Gaussian at random, by up to `distance` on each axis, in the pictures drawn from here on. 0: none. */
void fxs_float_scene_nudge(fxs_float_scene *scene, double distance);

/* Draws a view over black to width * height RGBA pixels of 8 bits, rows from the top. Errors: FXS_ERR_ARGUMENT for a
   camera that cannot be used, FXS_ERR_MEMORY. */
int fxs_float_scene_draw(fxs_float_scene *scene, const fxs_file_view *view, enum fxs_cutoff cutoff, uint8_t *rgba,
                         fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
