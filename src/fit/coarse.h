/* A coarse fit of a complete set of photographs. The fits of its blocks continue from it. */
#ifndef FXS_FIT_COARSE_H
#define FXS_FIT_COARSE_H

#include "blocks.h"
#include "src/camera/camera_internal.h"
#include "fit_internal.h"

/* A photograph's camera. */
typedef struct fxs_fit_coarse_camera {
    uint64_t key;
    uint32_t number;               /* index of the photograph's exposure and pose */
} fxs_fit_coarse_camera;

struct fxs_fit_coarse {
    fxs_fit *fit;                  /* has no photographs, engine or stepper */
    fxs_fit_coarse_camera *cameras;    /* cameras of the fit's photographs, sorted by key and number */
    size_t camera_count;
    uint64_t number;               /* identifies the file */
};

/* A key of a camera's position and direction, independent of the picture's size. */
uint64_t fxs_fit_camera_key(const fxs_fit_camera *camera);

/* Reads a saved fit except its photographs (checkpoint.c). Returns 0, or an error and a message; fxs_fit_coarse_free
   frees the parts that were read. */
int fxs_fit_checkpoint_read(fxs_fit_coarse *coarse, const char *path, fxs_message *message);

/* Checks that the coarse fit had photographs from these views' cameras; with skip_bad, one known camera suffices.
   Returns 0, or an error and a message. */
int fxs_fit_coarse_check(const fxs_fit_coarse *coarse, const fxs_view_list *views, int skip_bad,
                         fxs_message *message);

#endif
