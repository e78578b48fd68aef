/* The Gaussians of a fit (the model), and functions that change their number. Functions return 0 or FXS_ERR_MEMORY. */
#ifndef FXS_FIT_MODEL_H
#define FXS_FIT_MODEL_H

#include "stepper.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Allocates memory for `count` Gaussians, with all numbers 0. After an error the model is empty. */
int fxs_fit_model_room(fxs_fit_model *model, size_t count);

/* Sets the number of Gaussians; the caller then fills in their parameters. Quantised Gaussians must keep their number.
   After an error the model is unchanged. */
int fxs_fit_model_resize(fxs_fit_model *model, size_t count);

/* Creates a Gaussian at each point. Its sigma is the root mean square of the distances to the three nearest points. */
int fxs_fit_model_begin(fxs_fit_model *model, const fxs_fit_point *points, size_t count, float opacity);

/* Adds a Gaussian at each point. Its sigma is `factor` times the root mean square of the distances to the three nearest
   Gaussians, old and new. After an error the model is unchanged. */
int fxs_fit_model_add(fxs_fit_model *model, const fxs_fit_point *points, size_t count, float opacity, float factor);

void fxs_fit_model_widen(fxs_fit_model *model, float factor);

void fxs_fit_model_set_sigma(fxs_fit_model *model, size_t first, float sigma);
void fxs_fit_model_free(fxs_fit_model *model);

void fxs_fit_model_give(const fxs_fit_model *model, size_t i, fxs_gaussian *out);

enum { FXS_FIT_KEPT, FXS_FIT_CLONE, FXS_FIT_FIRST_CHILD, FXS_FIT_SECOND_CHILD };
typedef struct fxs_fit_origin {
    uint32_t source;
    uint32_t kind;                 /* origin of a new Gaussian: FXS_FIT_KEPT keeps Adam's moments; with other kinds they
                                      start with 0 */
} fxs_fit_origin;

/* Allocates a part of a model of `count` Gaussians: the planes before FXS_FIT_COLOUR, without moments. The functions
   below change it like the whole model, and its origins say how the rest changes. fxs_fit_model_free frees it. */
int fxs_fit_model_part(fxs_fit_model *part, size_t count);

/* Replaces the Gaussians by copies of the Gaussians that `origins` names. After an error the model is unchanged. */
int fxs_fit_model_rebuild(fxs_fit_model *model, const fxs_fit_origin *origins, size_t count, fxs_run_fn *run,
                          void *pool);

typedef struct fxs_fit_densify {
    float gradient;                /* Gaussians with at least this mean |dL/dcentre| are cloned or split. */
    float small, large;            /* limits of a Gaussian's largest scale: up to `small` it is cloned, above it is
                                      split; above `large` it is removed */
    float opacity;                 /* Gaussians with a lower opacity are removed. */
    size_t most;                   /* largest number of Gaussians */
    fxs_fit_far far;               /* unit of the limits `small` and `large`, which are angles at far Gaussians */
} fxs_fit_densify;

/* Clones, splits and removes Gaussians. If this would remove all of them, nothing changes. */
int fxs_fit_model_densify(fxs_fit_model *model, const fxs_fit_densify *densify);

/* Clamps the opacities of all Gaussians to at most `opacity`, and clears the Adam moments of opacities. */
void fxs_fit_model_reset_opacity(fxs_fit_model *model, float opacity);

typedef struct fxs_fit_relocate {
    float opacity;                 /* Gaussians with at most this opacity are moved to other places. */
    size_t most;                   /* largest number of Gaussians; each call adds up to 1/20 of their number */
    uint64_t seed, step;
} fxs_fit_relocate;

/* Moves faint Gaussians to the places of other Gaussians, which are drawn at random by opacity. Then adds new Gaussians
   in the same way (Kheradmand et al. 2024). */
int fxs_fit_model_relocate(fxs_fit_model *model, const fxs_fit_relocate *relocate);

/* Sorts the Gaussians along a Morton curve, so that neighbours in space are near each other in memory. */
int fxs_fit_model_order(fxs_fit_model *model);

#ifdef __cplusplus
}
#endif

#endif
