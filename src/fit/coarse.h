/* A coarse fit of all photographs of a scene, which the fits of single blocks of space continue. Functions return 0, or
 * an error and a message. */
#ifndef FXS_FIT_COARSE_H
#define FXS_FIT_COARSE_H

#include "blocks.h"
#include "src/camera/camera_internal.h"
#include "fit_internal.h"

typedef struct fxs_fit_coarse_camera {
    uint64_t key;
    uint32_t number;               /* index of the exposure and pose that belong to the camera's photograph */
} fxs_fit_coarse_camera;

struct fxs_fit_coarse {
    fxs_fit *fit;
    fxs_fit_coarse_camera *cameras;    /* cameras of the photographs, sorted by their keys */
    size_t camera_count;
    uint64_t number;               /* checksum that identifies the file of the coarse fit */
};

/* Returns a hash of a camera's position and direction that does not depend on the picture's size. */
uint64_t fxs_fit_camera_key(const fxs_fit_camera *camera);

/* Reads a saved fit, but not its photographs. After an error, fxs_fit_coarse_free frees the parts already read. */
int fxs_fit_checkpoint_read(fxs_fit_coarse *coarse, const char *path, fxs_message *message);

/* Checks that the coarse fit had a photograph with the camera of each view in `views`. With skip_bad one such view
   suffices. */
int fxs_fit_coarse_check(const fxs_fit_coarse *coarse, const fxs_view_list *views, int skip_bad,
                         fxs_message *message);

#endif
