/* Photographs with the cameras that took them, for a fit: a COLMAP folder (sparse/0 or sparse, .bin or .txt, and
 * images), Inria's cameras.json with images beside it, or transforms.json of nerfstudio and Blender. */
#ifndef FXS_FIT_PHOTOS_H
#define FXS_FIT_PHOTOS_H

#include "fit.h"

#ifdef __cplusplus
extern "C" {
#endif

/* All 0: every photograph is for the fit, at its own size but at most 1600 pixels wide or high. */
typedef struct fxs_photos_options {
    int resolution;                /* pixels of the longer side, at most; averaged down to it */
    uint32_t hold_out;             /* every n-th by name is held out, from the first on; 0: none */
    uint8_t background[3];         /* below photographs with alpha */
    int skip_bad;                  /* 1: photographs that cannot be read are left out, and counted */
    uint64_t seed;                 /* of the points where the files have none */
    fxs_run_fn *run;               /* null: one thread */
    void *pool;
    fxs_progress_fn *progress;     /* may be null */
    void *argument;
} fxs_photos_options;

typedef struct fxs_photos {
    fxs_fit_photo *fit, *held_out; /* by name; view.name names them */
    size_t fit_count, held_out_count;
    fxs_fit_point *points;
    size_t point_count;
    int points_are_random;         /* 1: the files had none */
    size_t skipped;
} fxs_photos;

/* Returns 0 and photographs that fxs_photos_free frees, or an error and a message, with photos all 0. */
int fxs_photos_read(const char *path, const fxs_photos_options *options, fxs_photos *photos, fxs_message *message);
void fxs_photos_free(fxs_photos *photos);

#ifdef __cplusplus
}
#endif

#endif
