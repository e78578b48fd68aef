/* Turns a scene in front of a camera that frames it, in integers alone. The firmware of the boards shows it, and the
 * tests compare its pictures with those on the host. */
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
    int64_t middle_q32[3];         /* middle of the visible part of the scene */
} fxs_turntable;

/* Opens the packed scene of `bytes` bytes at `data`, which stays in place, and frames it for a picture of this size.
   Errors are those of fxs_scene_open, FXS_ERR_SIZE, and FXS_ERR_SCENE where the box of the visible part is not valid.
   *t must not move in memory, as it points into itself. */
int fxs_turntable_open(fxs_turntable *t, const void *data, size_t bytes, int32_t width, int32_t height);

/* Turns the object to step / FXS_TURNTABLE_STEPS of a turn about the y axis; step 0 leaves the scene unturned. */
void fxs_turntable_turn(fxs_turntable *t, uint32_t step);

#ifdef __cplusplus
}
#endif

#endif
