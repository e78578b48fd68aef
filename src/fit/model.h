/* The Gaussians of a fit, and how their number changes. */
#ifndef FXS_FIT_MODEL_H
#define FXS_FIT_MODEL_H

#include "stepper.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Room for so many, all 0. Returns 0, or FXS_ERR_MEMORY and a model that is all 0. */
int fxs_fit_model_room(fxs_fit_model *model, size_t count);

/* For so many, with planes to be filled; beyond the count they are right. A model with masters keeps its count.
   Returns 0, or FXS_ERR_MEMORY and the model as it was. */
int fxs_fit_model_resize(fxs_fit_model *model, size_t count);

/* Begins with a Gaussian at each point: as wide as its three neighbours are far (root of their mean square), of this
   opacity and the point's colour. Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_model_begin(fxs_fit_model *model, const fxs_fit_point *points, size_t count, float opacity);

/* All scales, times a factor. */
void fxs_fit_model_widen(fxs_fit_model *model, float factor);
void fxs_fit_model_free(fxs_fit_model *model);

/* Where a Gaussian of the next model comes from. */
enum { FXS_FIT_KEPT, FXS_FIT_CLONE, FXS_FIT_CHILD };
typedef struct fxs_fit_origin {
    uint32_t source;
    uint32_t kind;                 /* KEPT: with Adam's moments; the others with moments of 0 */
} fxs_fit_origin;

/* Makes it the model of these. Sums of densification become 0. Returns 0, or FXS_ERR_MEMORY and the model as it was. */
int fxs_fit_model_rebuild(fxs_fit_model *model, const fxs_fit_origin *origins, size_t count);

typedef struct fxs_fit_densify {
    float gradient;                /* mean length of dL/dcentre, as in by_centre, from which on it is taken */
    float small, large;            /* scene units: up to `small` it is cloned, else split; above `large` it goes */
    float opacity;                 /* the least that stays */
    size_t most;                   /* Gaussians: of more, those of the largest gradients are taken */
    uint64_t seed, step;
} fxs_fit_densify;

/* Clones and splits, and takes away those of too little opacity, too large, or without a rotation; where that would be
   all, nothing happens. Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_model_densify(fxs_fit_model *model, const fxs_fit_densify *densify);

/* Opacities above this become it, and Adam forgets them. */
void fxs_fit_model_reset_opacity(fxs_fit_model *model, float opacity);

typedef struct fxs_fit_relocate {
    float opacity;                 /* up to it a Gaussian is moved to where another is */
    size_t most;                   /* Gaussians; they become a 20th more at a time */
    uint64_t seed, step;
} fxs_fit_relocate;

/* Moves and adds Gaussians to places drawn by opacity (Kheradmand et al. 2024). Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_model_relocate(fxs_fit_model *model, const fxs_fit_relocate *relocate);

/* Puts the Gaussians along a Morton curve, so that neighbours share groups. Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_model_order(fxs_fit_model *model);

#ifdef __cplusplus
}
#endif

#endif
