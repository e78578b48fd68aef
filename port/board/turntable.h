/* Turns a scene in front of a camera that shows the whole scene, with integers only. */
#ifndef FXS_TURNTABLE_H
#define FXS_TURNTABLE_H

#include <fixsplat/fixsplat.h>

#ifdef __cplusplus
extern "C" {
#endif

#define FXS_TURNTABLE_STEPS 64

typedef struct fxs_turntable {
    fxs_scene scene;
    fxs_object object;
    fxs_camera camera;
    int64_t middle_q32[3], duration_q32;
} fxs_turntable;

/* Opens a packed scene and places the camera so that a picture of this size shows the whole scene. `data` and *t must
 * stay in place. Returns 0, an error of fxs_scene_open, FXS_ERR_SIZE, or FXS_ERR_SCENE if the header has an invalid box
 * of the visible part. */
int fxs_turntable_open(fxs_turntable *t, const void *data, size_t bytes, int32_t width, int32_t height);

/* Turns the scene about the y axis by step / FXS_TURNTABLE_STEPS of a full turn, and shows a moving scene after the
 * same part of its duration. */
void fxs_turntable_turn(fxs_turntable *t, uint32_t step);

#ifdef __cplusplus
}
#endif

#endif
