/* Changes to the model (the Gaussians of a fit) and to their number. */
#ifndef FXS_FIT_MODEL_H
#define FXS_FIT_MODEL_H

#include "stepper.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Makes a model of `count` Gaussians with all numbers 0. Returns 0, or FXS_ERR_MEMORY and an empty model. */
int fxs_fit_model_room(fxs_fit_model *model, size_t count);

/* Sets the number of Gaussians. The caller fills the planes up to `count`; the rest is set here. A model with masters
   must keep its count. Returns 0, or FXS_ERR_MEMORY and an unchanged model. */
int fxs_fit_model_resize(fxs_fit_model *model, size_t count);

/* Creates a Gaussian at each point, with this opacity and the point's colour. Its sigma is the root mean square of the
   distances to the three nearest points. Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_model_begin(fxs_fit_model *model, const fxs_fit_point *points, size_t count, float opacity);

/* Multiplies all scales by a factor. */
void fxs_fit_model_widen(fxs_fit_model *model, float factor);

/* Sets the scales of the Gaussians from `first` on to `sigma`, scene units. */
void fxs_fit_model_set_sigma(fxs_fit_model *model, size_t first, float sigma);
void fxs_fit_model_free(fxs_fit_model *model);

/* Copies all parameters of Gaussian i to *out. */
void fxs_fit_model_give(const fxs_fit_model *model, size_t i, fxs_gaussian *out);

/* Where a Gaussian of the new model comes from. */
enum { FXS_FIT_KEPT, FXS_FIT_CLONE, FXS_FIT_FIRST_CHILD, FXS_FIT_SECOND_CHILD };
typedef struct fxs_fit_origin {
    uint32_t source;
    uint32_t kind;                 /* KEPT keeps Adam's moments; the others start with 0 */
} fxs_fit_origin;

/* Replaces the model by these origins; jobs run by `run` with `pool`. Clears the sums for densification. Returns 0, or
   FXS_ERR_MEMORY and an unchanged model. */
int fxs_fit_model_rebuild(fxs_fit_model *model, const fxs_fit_origin *origins, size_t count, fxs_run_fn *run,
                          void *pool);

typedef struct fxs_fit_densify {
    float gradient;                /* least mean |dL/dcentre| (by_centre / views) for a clone or split */
    float small, large;            /* by largest scale, scene units: cloned up to `small`, else split; removed above
                                      `large` */
    float opacity;                 /* Gaussians with less opacity are removed */
    size_t most;                   /* limit of Gaussians; those with the largest gradients grow first */
    fxs_fit_far far;               /* `small` and `large` are in this unit */
} fxs_fit_densify;

/* Clones and splits Gaussians, and removes those with too little opacity, too large a scale or a zero quaternion. If
   that would remove all, nothing changes. Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_model_densify(fxs_fit_model *model, const fxs_fit_densify *densify);

/* Clamps opacities to at most `opacity` and clears their Adam moments. */
void fxs_fit_model_reset_opacity(fxs_fit_model *model, float opacity);

typedef struct fxs_fit_relocate {
    float opacity;                 /* Gaussians with at most this opacity are relocated */
    size_t most;                   /* limit of Gaussians; each call adds up to 1/20 */
    uint64_t seed, step;
} fxs_fit_relocate;

/* Relocates dead Gaussians and adds new ones at the places of others, drawn by opacity (Kheradmand et al. 2024).
   Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_model_relocate(fxs_fit_model *model, const fxs_fit_relocate *relocate);

/* Sorts the Gaussians along a Morton curve, so that neighbours are adjacent in memory. Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_model_order(fxs_fit_model *model);

#ifdef __cplusplus
}
#endif

#endif
