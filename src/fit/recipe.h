/* The plan of a step by recipe: a function of the options, the extent of the scene and the step's number. */
#ifndef FXS_FIT_RECIPE_H
#define FXS_FIT_RECIPE_H

#include <fixsplat/fit.h>
#include "fit_stage.h"

typedef struct fxs_fit_plan {
    int sh_degree;
    int divisor;                   /* photographs are reduced by it, in width and height */
    float rate[FXS_FIT_PARAMETERS];
    float by_opacity, by_scale;    /* weights of the mean opacity and the mean scale in the loss */
    float gain_part;               /* of the first rate of the exposures of photographs: 0 to 1 */
    float pose_way;                /* of their cameras' poses: radians, shared out among the steps of each photograph */
    float noise;                   /* amount of fxs_fit_noise */
    int smooths;                   /* 0, or as the divisor: scales are bounded after the update */
    int densify, relocate, order;  /* 1: done after that */
    float large;                   /* scale above which densify removes a Gaussian; infinity: none */
    int reset;                     /* 1: opacities are reset after that */
} fxs_fit_plan;

/* `step`: from 1 on. `least_side`: the photograph's shorter side in pixels. */
void fxs_fit_plan_step(const fxs_fit_options *options, float extent, uint32_t step, int least_side,
                       fxs_fit_plan *plan);

/* The initial opacity, and the initial scale in units of the distance to the neighbours. */
float fxs_fit_first_opacity(enum fxs_fit_recipe recipe);
float fxs_fit_first_scale(enum fxs_fit_recipe recipe);

/* 1.1 times the largest distance of a camera from the mean of the cameras. Where all cameras are in one place: 1.1
   times its distance to the mean of the points, or 1.1. */
float fxs_fit_extent(const fxs_fit_photo *photos, size_t count, const fxs_fit_point *points, size_t point_count);

#endif
