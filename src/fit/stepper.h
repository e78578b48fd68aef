/* A step: all stages for one photograph. What a step needs beside the parameters is allocated once and grows. */
#ifndef FXS_FIT_STEPPER_H
#define FXS_FIT_STEPPER_H

#include <fixsplat/fit.h>
#include "fit_stage.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_fit_stepper fxs_fit_stepper;

typedef struct fxs_fit_photograph {
    const uint8_t *pixels;         /* red, green, blue, rows without gaps */
    int32_t width, height;         /* of the pixels */
    int32_t divisor;               /* the mean of so many by so many of them is one of the camera's; what is left over
                                      at the right and below is not used */
    fxs_fit_camera camera;
} fxs_fit_photograph;

/* The parameters of `count` Gaussians, Adam's two moments of them, and sums for the densification. `stride` is `count`
   rounded up to FXS_FIT_GROUP, or more; what is beyond `count` is 0 but the quaternions' w. */
typedef struct fxs_fit_model {
    size_t count, stride;
    float *parameters, *means, *squares;        /* FXS_FIT_PARAMETERS planes each */
    float *by_centre, *views;      /* sums of |dL/dcentre| (stage.h: update), and of steps with it in the picture */
    float *masters;                /* null; or the parameters as Adam has them: the others are quantised by `grid` */
    const fxs_fit_grid *grid;
} fxs_fit_model;

typedef struct fxs_fit_step_options {
    int sh_degree;
    float background[3];
    float rate[FXS_FIT_PARAMETERS];
    uint32_t number;               /* of the step, from 1 on */
    float by_opacity, by_scale;    /* weights of the mean opacity and the mean scale in the loss */
    fxs_fit_noise noise;           /* after the update; amount 0: none */
} fxs_fit_step_options;

/* `run` and `pool`: as in fxs_config. Null where memory ends. */
fxs_fit_stepper *fxs_fit_stepper_create(const fxs_fit_stages *stages, fxs_run_fn *run, void *pool, uint32_t threads,
                                  fxs_clock_fn *clock);
void fxs_fit_stepper_free(fxs_fit_stepper *step);

/* Draws the model as the camera sees it: planes red, green, blue, `stride` of the picture's. For tests and previews.
   Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_draw(fxs_fit_stepper *step, const fxs_fit_model *model, const fxs_fit_camera *camera,
                 const fxs_fit_step_options *options, fxs_fit_plane planes[3]);

/* One step of the fit, by a batch of photographs. Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_stepper_step(fxs_fit_stepper *step, fxs_fit_model *model, const fxs_fit_photograph *photographs,
                         uint32_t batch, const fxs_fit_step_options *options, fxs_fit_report *report);

/* The numbers of Adam's step. The gradient is that of the sum over pixels and channels of the batch; epsilon is meant
   for their mean, and so are the weights of the means over Gaussians. */
void fxs_fit_set_adam(fxs_fit_adam *adam, const fxs_fit_step_options *options, const fxs_fit_photograph *photographs,
                      uint32_t batch, size_t gaussians);

/* Adds a photograph's losses to a report of a batch. `rows`: of each channel the sums of |a - b| of its rows, then
   those of 1 - SSIM. */
void fxs_fit_add_loss(const float *rows, const fxs_fit_camera *camera, uint32_t batch, fxs_fit_report *report);

/* The parameters of a model with masters become what its grid makes of them. */
void fxs_fit_quantise(fxs_fit_stepper *step, fxs_fit_model *model);

#ifdef __cplusplus
}
#endif

#endif
