/* Draws the Gaussians of a scene file in single precision, as reference pictures for packed scenes. Functions return 0,
 * or an error and a message. */
#ifndef FXS_FLOAT_SCENE_H
#define FXS_FLOAT_SCENE_H

#include <fixsplat/camera.h>
#include <fixsplat/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_float_scene fxs_float_scene;

/* Reads an open scene file from its start, and keeps the Gaussians that fxs_pack would pack. With a null `run`, a
 * single thread works. *scene is null after an error; free it with fxs_float_scene_free. */
int fxs_float_scene_read(fxs_float_scene **scene, fxs_scene_file *file, const fxs_scene_file_info *info,
                         fxs_run_fn *run, void *pool, uint32_t threads, fxs_message *message);
void fxs_float_scene_free(fxs_float_scene *scene);   /* Frees a scene, which may be null. */

/* Displaces each Gaussian randomly by up to `distance` along each axis, in all later pictures. 0: no displacement. */
void fxs_float_scene_nudge(fxs_float_scene *scene, double distance);

/* Draws a view over a black background to width * height RGBA8 pixels, rows from the top. */
int fxs_float_scene_draw(fxs_float_scene *scene, const fxs_view *view, enum fxs_cutoff cutoff, uint8_t *rgba,
                         fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
