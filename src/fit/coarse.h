/* A coarse fit of a whole set, from which the fits of its blocks go on. */
#ifndef FXS_FIT_COARSE_H
#define FXS_FIT_COARSE_H

#include <fixsplat/blocks.h>
#include "src/camera/camera_internal.h"
#include "fit_internal.h"

/* Of a photograph. */
typedef struct fxs_fit_coarse_camera {
    uint64_t key;
    uint32_t number;               /* of its exposure and its pose */
} fxs_fit_coarse_camera;

struct fxs_fit_coarse {
    fxs_fit *fit;                  /* without photographs, engine and stepper */
    fxs_fit_coarse_camera *cameras;    /* of its photographs, ascending by key and number */
    size_t camera_count;
    uint64_t number;               /* of the file */
};

/* The same for a photograph of any size from one place in one direction. */
uint64_t fxs_fit_camera_key(const fxs_fit_camera *camera);

/* Reads a saved fit but for its photographs (checkpoint.c). Returns 0, or an error and a message; fxs_fit_coarse_free
   frees what was read. */
int fxs_fit_checkpoint_read(fxs_fit_coarse *coarse, const char *path, fxs_message *message);

/* Whether the coarse fit had photographs from where these were taken; with skip_bad, some of them. Returns 0, or an
   error and a message. */
int fxs_fit_coarse_check(const fxs_fit_coarse *coarse, const fxs_view_list *views, int skip_bad,
                         fxs_message *message);

#endif
