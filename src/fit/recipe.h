/* The plan of a fitting step by a recipe: learning rates and changes that follow from the options, the scene's extent
 * and the step's number. */
#ifndef FXS_FIT_RECIPE_H
#define FXS_FIT_RECIPE_H

#include <fixsplat/fit.h>
#include "src/fit/stages/fit_stage.h"

typedef struct fxs_fit_plan {
    int sh_degree;
    int divisor;                   /* Photographs are averaged down by this factor in width and height. */
    float rate[FXS_FIT_PARAMETERS];
    float by_opacity, by_scale;
    float by_flat, by_surface;     /* as in fxs_fit_step_options, but by_flat in units of the extent */
    int is_depth;
    float gain_part;               /* factor of the learning rate of exposures, 0 to 1 */
    float pose_way;                /* total movement of camera poses in radians, which the caller divides by the steps
                                      per photograph */
    float noise;
    int smooths;                   /* divisor of the photographs' size, for the lower limit of scales; 0: no limit */
    int densify, relocate, order;
    float large;                   /* Densification removes Gaussians with a larger scale. */
    int reset;                     /* 1: opacities are reset after all other changes */
} fxs_fit_plan;

/* Sets the plan of a fitting step. step: number from 1. least_side: the photographs' shorter side in pixels. */
void fxs_fit_plan_step(const fxs_fit_options *options, float extent, uint32_t step, int least_side,
                       fxs_fit_plan *plan);

/* Returns the factor by which the recipe's first `step` steps raise the number of Gaussians, if max_gaussians allows:
   1.05 to the number of relocations; 1 for the recipe reference. */
double fxs_fit_growth(const fxs_fit_options *options, uint32_t step);

/* Return the initial opacity of a recipe, and the initial scale relative to the distance of neighbouring points. */
float fxs_fit_first_opacity(enum fxs_fit_recipe recipe);
float fxs_fit_first_scale(enum fxs_fit_recipe recipe);

/* Returns the extent of a scene: 1.1 times the largest distance of a camera from the cameras' mean. With all cameras in
   one place: 1.1 times the distance to the points' mean, or 1.1 if that is 0. */
float fxs_fit_extent(const fxs_fit_photo *photos, size_t count, const fxs_fit_point *points, size_t point_count);

#endif
