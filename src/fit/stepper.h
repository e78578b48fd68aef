/* Makes a step: all stages for the photographs of a batch. Its working memory is kept between steps and grows. */
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
    int32_t divisor;               /* a pixel of the camera is the mean of divisor x divisor of these; a remainder at
                                      the right and lower edges is not used */
    fxs_fit_camera camera;         /* as it was given */
    uint32_t number;               /* of its exposure and its pose in the model's */
    const uint8_t *mask;           /* null, or a byte for each of the pixels; 0: it is ignored. A pixel of the camera is
                                      ignored where one of its divisor x divisor is */
} fxs_fit_photograph;

/* The parameters of `count` Gaussians, their two moments of Adam, and sums for the densification. `stride` is `count`
   rounded up to FXS_FIT_GROUP, or more. Beyond `count`, all numbers but the w of quaternions are 0. */
typedef struct fxs_fit_model {
    size_t count, stride;
    float *parameters, *means, *squares;        /* FXS_FIT_PARAMETERS planes each */
    float *by_centre, *views;      /* sums of |dL/dcentre| (fit_stage.h: update), and numbers of steps in the picture */
    float *masters;                /* null, or Adam's exact parameters, which `grid` quantises to `parameters` */
    const fxs_fit_grid *grid;
    fxs_fit_gains *gains;          /* exposures of the photographs, changed by steps; null: none has one */
    fxs_fit_poses *poses;          /* the same of the poses of their cameras */
    const fxs_fit_cameras *cameras;    /* by which steps bound scales; null: they do not */
} fxs_fit_model;

typedef struct fxs_fit_step_options {
    int sh_degree;
    float background[3];
    float rate[FXS_FIT_PARAMETERS];
    uint32_t number;               /* number of the step, from 1 on */
    float gain_rate;               /* of the exposures of the batch's photographs, log2; 0: they stay */
    float gain_decay;              /* share of them that is taken off (exposure.h) */
    float pose_rate;               /* of the poses of their cameras, radians; 0: they stay */
    float by_opacity, by_scale;    /* weights of the mean opacity and the mean scale in the loss */
    int smooths;                   /* scales are bounded after the update, where the model has cameras: by what
                                      photographs are reduced meanwhile; 0: they are not */
    fxs_fit_far far;               /* where by_scale is of scales in its units */
    fxs_fit_noise noise;           /* noise after the update; amount 0: none */
    size_t changed;                /* so many Gaussians are changed, the first of the model, rounded down to
                                      FXS_FIT_GROUP; 0: all. Of the processor's stepper alone */
} fxs_fit_step_options;

/* `run` and `pool` are as in fxs_config. Returns null where memory runs out. */
fxs_fit_stepper *fxs_fit_stepper_create(const fxs_fit_stages *stages, fxs_run_fn *run, void *pool, uint32_t threads,
                                  fxs_clock_fn *clock);
void fxs_fit_stepper_free(fxs_fit_stepper *step);

/* Draws the model as the camera sees it, to planes of red, green and blue. For tests and previews. Returns 0 or
   FXS_ERR_MEMORY. */
int fxs_fit_draw(fxs_fit_stepper *step, const fxs_fit_model *model, const fxs_fit_camera *camera,
                 const fxs_fit_step_options *options, fxs_fit_plane planes[3]);

/* Makes one step of the fit by a batch of photographs. Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_stepper_step(fxs_fit_stepper *step, fxs_fit_model *model, const fxs_fit_photograph *photographs,
                         uint32_t batch, const fxs_fit_step_options *options, fxs_fit_report *report);

/* Draws the model as a photograph's camera sees it, over black, and shares out the squared difference of each pixel,
   colours^2, by the weights with which Gaussians are blended in it. `errors`: each Gaussian's sum over the pixels; the
   model's `views` count where it is in the picture. The photograph is not divided. Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_find_errors(fxs_fit_stepper *step, fxs_fit_model *model, const fxs_fit_photograph *photograph,
                        const fxs_fit_step_options *options, float *errors);

/* Sets the numbers of Adam's step. The gradient is of the sum over pixels and channels of the batch; so epsilon and the
   weights of means over Gaussians, which are for the mean over pixels, are scaled. */
void fxs_fit_set_adam(fxs_fit_adam *adam, const fxs_fit_step_options *options, const fxs_fit_photograph *photographs,
                      uint32_t batch, size_t gaussians);

/* Adds a photograph's losses to the report of a batch. `rows`: for each channel the sums of |a - b| over each row, then
   the sums of 1 - SSIM. */
void fxs_fit_add_loss(const float *rows, const fxs_fit_camera *camera, uint32_t batch, fxs_fit_report *report);

/* Sets the parameters of a model with masters to the masters as its grid quantises them. */
void fxs_fit_quantise(fxs_fit_stepper *step, fxs_fit_model *model);

#ifdef __cplusplus
}
#endif

#endif
