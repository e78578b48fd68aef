/* Changes of the model, the Gaussians of a fit, and of their number. */
#ifndef FXS_FIT_MODEL_H
#define FXS_FIT_MODEL_H

#include "stepper.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Makes an empty model with room for `count` Gaussians, all 0. Returns 0, or FXS_ERR_MEMORY and a model of 0. */
int fxs_fit_model_room(fxs_fit_model *model, size_t count);

/* Sets the number of Gaussians. The caller fills the planes up to `count`; beyond it they are set. A model with masters
   must keep its count. Returns 0, or FXS_ERR_MEMORY and an unchanged model. */
int fxs_fit_model_resize(fxs_fit_model *model, size_t count);

/* Begins with a Gaussian at each point, with this opacity and the point's colour; its sigma is the root mean square of
   the distances to the three nearest points. Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_model_begin(fxs_fit_model *model, const fxs_fit_point *points, size_t count, float opacity);

/* Multiplies all scales by a factor. */
void fxs_fit_model_widen(fxs_fit_model *model, float factor);

/* Sets the scales of the Gaussians from `first` on. */
void fxs_fit_model_set_sigma(fxs_fit_model *model, size_t first, float sigma);
void fxs_fit_model_free(fxs_fit_model *model);

/* Gives out Gaussian i, with all its parameters. */
void fxs_fit_model_give(const fxs_fit_model *model, size_t i, fxs_gaussian *out);

/* The source of a Gaussian of the new model. */
enum { FXS_FIT_KEPT, FXS_FIT_CLONE, FXS_FIT_FIRST_CHILD, FXS_FIT_SECOND_CHILD };
typedef struct fxs_fit_origin {
    uint32_t source;
    uint32_t kind;                 /* KEPT: Adam's moments stay; in the others they become 0 */
} fxs_fit_origin;

/* Rebuilds the model from these origins, by `run` with `pool`; sums of densification become 0. Returns 0, or
   FXS_ERR_MEMORY and an unchanged model. */
int fxs_fit_model_rebuild(fxs_fit_model *model, const fxs_fit_origin *origins, size_t count, fxs_run_fn *run,
                          void *pool);

typedef struct fxs_fit_densify {
    float gradient;                /* the least mean length of dL/dcentre (by_centre) for a clone or split */
    float small, large;            /* scene units: cloned up to `small`, else split; removed above `large` */
    float opacity;                 /* the least opacity that stays */
    size_t most;                   /* the most Gaussians: the largest gradients are cloned and split first */
    fxs_fit_far far;               /* where `small` and `large` are in its units */
} fxs_fit_densify;

/* Clones and splits Gaussians, and removes those with too little opacity, too large a scale or no rotation; where that
   would remove all, nothing happens. Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_model_densify(fxs_fit_model *model, const fxs_fit_densify *densify);

/* Clamps opacities to at most this, and sets Adam's moments of opacities to 0. */
void fxs_fit_model_reset_opacity(fxs_fit_model *model, float opacity);

typedef struct fxs_fit_relocate {
    float opacity;                 /* Gaussians up to this opacity are relocated */
    size_t most;                   /* the most Gaussians; each call adds up to a 20th */
    uint64_t seed, step;
} fxs_fit_relocate;

/* Relocates and adds Gaussians at the places of others, drawn by opacity (Kheradmand et al. 2024). Returns 0 or
   FXS_ERR_MEMORY. */
int fxs_fit_model_relocate(fxs_fit_model *model, const fxs_fit_relocate *relocate);

/* Sorts the Gaussians along a Morton curve, so that neighbours share groups. Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_model_order(fxs_fit_model *model);

#ifdef __cplusplus
}
#endif

#endif
