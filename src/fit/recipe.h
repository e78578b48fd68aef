/* What a step does, by recipe: a function of the options, the extent of the scene and the step's number. */
#ifndef FXS_FIT_RECIPE_H
#define FXS_FIT_RECIPE_H

#include <fixsplat/fit.h>
#include "fit_stage.h"

typedef struct fxs_fit_plan {
    int sh_degree;
    int divisor;                   /* the photograph is averaged down by it, either way */
    float rate[FXS_FIT_PARAMETERS];
    float by_opacity, by_scale;    /* weights of the mean opacity and the mean scale in the loss */
    float noise;                   /* of positions, in covariances */
    int densify, relocate, order;  /* after the update; 0 or 1 */
    float gradient;                /* of densify, from which on a Gaussian is cloned or split */
    float large;                   /* scale above which densify takes a Gaussian away; infinity: none */
    int reset;                     /* of opacities, after that */
} fxs_fit_plan;

/* `step`: from 1 on. `least_side`: pixels of the photograph's shorter side. */
void fxs_fit_plan_step(const fxs_fit_options *options, float extent, uint32_t step, int least_side,
                       fxs_fit_plan *plan);

/* At the start: opacity, and the scale in units of the distance to the neighbours. */
float fxs_fit_first_opacity(enum fxs_fit_recipe recipe);
float fxs_fit_first_scale(enum fxs_fit_recipe recipe);

/* 1.1 times the largest distance of a camera from their mean. Where they are all in one place: that from there to the
   mean of the points, or 1. */
float fxs_fit_extent(const fxs_fit_photo *photos, size_t count, const fxs_fit_point *points, size_t point_count);

#endif
