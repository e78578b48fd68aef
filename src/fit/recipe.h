/* The recipe's plan for a step: a function of the options, the scene's extent and the step's number. */
#ifndef FXS_FIT_RECIPE_H
#define FXS_FIT_RECIPE_H

#include <fixsplat/fit.h>
#include "src/fit/stages/fit_stage.h"

typedef struct fxs_fit_plan {
    int sh_degree;
    int divisor;                   /* photographs are averaged down by this factor in width and height */
    float rate[FXS_FIT_PARAMETERS];
    float by_opacity, by_scale;
    float gain_part;               /* factor of the exposures' learning rate, 0 to 1 */
    float pose_way;                /* total movement of poses in radians, divided by the steps per photograph */
    float noise;
    int smooths;                   /* divisor of the photographs, for the lower limit of scales; 0: no limit */
    int densify, relocate, order;
    float large;                   /* densify removes Gaussians with a larger scale */
    int reset;                     /* 1: resets opacities after all other changes */
} fxs_fit_plan;

/* step: from 1. least_side: the photograph's shorter side in pixels. */
void fxs_fit_plan_step(const fxs_fit_options *options, float extent, uint32_t step, int least_side,
                       fxs_fit_plan *plan);

/* Initial opacity, and initial scale relative to the distance of neighbouring points. */
float fxs_fit_first_opacity(enum fxs_fit_recipe recipe);
float fxs_fit_first_scale(enum fxs_fit_recipe recipe);

/* Returns 1.1 times the largest distance of a camera from the cameras' mean. With all cameras in one place: 1.1 times
   the distance to the points' mean, or 1.1 if that is 0. */
float fxs_fit_extent(const fxs_fit_photo *photos, size_t count, const fxs_fit_point *points, size_t point_count);

#endif
