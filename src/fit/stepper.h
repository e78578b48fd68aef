/* Makes a step on the CPU: all stages for the photographs of a batch. Its working memory is kept between steps and
   grows as needed. */
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
    int32_t width, height;         /* size of `pixels` */
    int32_t divisor;               /* a pixel of the camera is the mean of divisor x divisor pixels; a remainder at the
                                      right and lower edges is not used */
    fxs_fit_camera camera;         /* without pose correction */
    uint32_t number;               /* index of its exposure and pose in the model */
    const uint8_t *mask;           /* null, or one byte per pixel of `pixels`; 0: ignored. A pixel of the camera is
                                      ignored if any of its divisor x divisor pixels is */
} fxs_fit_photograph;

/* The parameters of `count` Gaussians, two moments of Adam, and sums for densification. `stride` is at least `count`
   rounded up to FXS_FIT_GROUP. Beyond `count`, scales and opacities are -FXS_FIT_FARTHEST, the w of quaternions is 1,
   and all other numbers are 0. */
typedef struct fxs_fit_model {
    size_t count, stride;
    float *parameters, *means, *squares;        /* FXS_FIT_PARAMETERS planes each */
    float *by_centre, *views;      /* sums of |dL/dcentre| (fit_stage.h: update); views: number of views that saw the
                                      Gaussian */
    float *masters;                /* null, or exact parameters for Adam, which `grid` quantises to `parameters` */
    const fxs_fit_grid *grid;
    fxs_fit_gains *gains;          /* exposures of the photographs, changed by steps; null: none */
    fxs_fit_poses *poses;          /* pose corrections of the cameras, changed by steps; null: none */
    const fxs_fit_cameras *cameras;    /* cameras that bound scales; null: no bound */
} fxs_fit_model;

typedef struct fxs_fit_step_options {
    int sh_degree;
    float background[3];
    float rate[FXS_FIT_PARAMETERS];
    uint32_t number;               /* number of the step, from 1 */
    float gain_rate;               /* learning rate of the batch's exposures (log2 units); 0: fixed */
    float gain_decay;              /* decay of exposures per step (exposure.h) */
    float pose_rate;               /* learning rate of the batch's poses, radians; 0: fixed */
    float by_opacity, by_scale;    /* weights of the mean opacity and the mean scale in the loss */
    int smooths;                   /* 0, or the photographs' current divisor: bounds scales after the update, if the
                                      model has cameras */
    fxs_fit_far far;               /* by_scale weights scales in this unit */
    fxs_fit_noise noise;           /* applied after the update; amount 0: none */
    size_t changed;                /* CPU stepper only: changes only the first `changed` Gaussians, rounded down to
                                      FXS_FIT_GROUP; 0: all */
} fxs_fit_step_options;

/* `run` and `pool` are as in fxs_config. Returns null if memory runs out. */
fxs_fit_stepper *fxs_fit_stepper_create(const fxs_fit_stages *stages, fxs_run_fn *run, void *pool, uint32_t threads,
                                  fxs_clock_fn *clock);
void fxs_fit_stepper_free(fxs_fit_stepper *step);

/* Draws the model into planes of red, green and blue. For tests and previews. Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_draw(fxs_fit_stepper *step, const fxs_fit_model *model, const fxs_fit_camera *camera,
                 const fxs_fit_step_options *options, fxs_fit_plane planes[3]);

/* Makes one step of the fit by a batch of photographs. Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_stepper_step(fxs_fit_stepper *step, fxs_fit_model *model, const fxs_fit_photograph *photographs,
                         uint32_t batch, const fxs_fit_step_options *options, fxs_fit_report *report);

/* Draws the model with a photograph's camera over black, and distributes each pixel's squared difference (colours^2)
   over Gaussians by their blending weights. `errors`: the sum for each Gaussian; the model's `views` are incremented
   for visible ones. The photograph's divisor is not applied. Returns 0 or FXS_ERR_MEMORY. */
int fxs_fit_find_errors(fxs_fit_stepper *step, fxs_fit_model *model, const fxs_fit_photograph *photograph,
                        const fxs_fit_step_options *options, float *errors);

/* Sets the parameters of Adam's step. The gradient is summed over the batch's pixels and channels, but epsilon and the
   weights of means over Gaussians are for the mean over pixels; so these are scaled. */
void fxs_fit_set_adam(fxs_fit_adam *adam, const fxs_fit_step_options *options, const fxs_fit_photograph *photographs,
                      uint32_t batch, size_t gaussians);

/* Adds a photograph's losses to a batch's report. `rows`: for each channel the sums of |a - b| over each row, then the
   sums of 1 - SSIM. */
void fxs_fit_add_loss(const float *rows, const fxs_fit_camera *camera, uint32_t batch, fxs_fit_report *report);

/* Sets the parameters of a model with masters to the masters, quantised by its grid. */
void fxs_fit_quantise(fxs_fit_stepper *step, fxs_fit_model *model);

#ifdef __cplusplus
}
#endif

#endif
