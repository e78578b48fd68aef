/* The Gaussians of a fit (the model), and changes of their number. Functions return 0 or FXS_ERR_MEMORY. */
#ifndef FXS_FIT_MODEL_H
#define FXS_FIT_MODEL_H

#include "stepper.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Makes a model of `count` Gaussians with all numbers 0. After an error the model is empty. */
int fxs_fit_model_room(fxs_fit_model *model, size_t count);

/* Sets the number of Gaussians; the caller then fills the parameters. A quantised model must keep its number. After an
   error the model is unchanged. */
int fxs_fit_model_resize(fxs_fit_model *model, size_t count);

/* Creates a Gaussian at each point, with sigma the root mean square of the distances to the three nearest points. */
int fxs_fit_model_begin(fxs_fit_model *model, const fxs_fit_point *points, size_t count, float opacity);

void fxs_fit_model_widen(fxs_fit_model *model, float factor);

void fxs_fit_model_set_sigma(fxs_fit_model *model, size_t first, float sigma);
void fxs_fit_model_free(fxs_fit_model *model);

void fxs_fit_model_give(const fxs_fit_model *model, size_t i, fxs_gaussian *out);

enum { FXS_FIT_KEPT, FXS_FIT_CLONE, FXS_FIT_FIRST_CHILD, FXS_FIT_SECOND_CHILD };
typedef struct fxs_fit_origin {
    uint32_t source;
    uint32_t kind;                 /* FXS_FIT_KEPT keeps Adam's moments; other kinds start with 0 */
} fxs_fit_origin;

/* Replaces the Gaussians by copies of the origins. After an error the model is unchanged. */
int fxs_fit_model_rebuild(fxs_fit_model *model, const fxs_fit_origin *origins, size_t count, fxs_run_fn *run,
                          void *pool);

typedef struct fxs_fit_densify {
    float gradient;                /* smallest mean |dL/dcentre| for a clone or split */
    float small, large;            /* limits of the largest scale: clones up to `small`, splits above; removes above
                                      `large` */
    float opacity;                 /* Gaussians with less opacity are removed */
    size_t most;                   /* limit of the number of Gaussians */
    fxs_fit_far far;               /* unit of `small` and `large` */
} fxs_fit_densify;

/* Clones, splits and removes Gaussians. If all would be removed, nothing changes. */
int fxs_fit_model_densify(fxs_fit_model *model, const fxs_fit_densify *densify);

/* Clamps opacities to at most `opacity` and clears their Adam moments. */
void fxs_fit_model_reset_opacity(fxs_fit_model *model, float opacity);

typedef struct fxs_fit_relocate {
    float opacity;                 /* Gaussians with at most this opacity are relocated */
    size_t most;                   /* limit of the number of Gaussians; each call adds up to 1/20 */
    uint64_t seed, step;
} fxs_fit_relocate;

/* Moves faint Gaussians to the places of others drawn by opacity, and adds new ones there (Kheradmand et al. 2024). */
int fxs_fit_model_relocate(fxs_fit_model *model, const fxs_fit_relocate *relocate);

/* Sorts the Gaussians along a Morton curve, so that neighbours are adjacent in memory. */
int fxs_fit_model_order(fxs_fit_model *model);

#ifdef __cplusplus
}
#endif

#endif
