/* Makes a step of the fit on the CPU. Working memory is kept between steps and grows as needed. Functions return 0 or
 * FXS_ERR_MEMORY. */
#ifndef FXS_FIT_STEPPER_H
#define FXS_FIT_STEPPER_H

#include <fixsplat/fit.h>
#include "src/fit/stages/fit_stage.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_fit_stepper fxs_fit_stepper;

typedef struct fxs_fit_photograph {
    const uint8_t *pixels;         /* red, green, blue; rows without gaps */
    int32_t width, height;
    int32_t divisor;               /* a pixel of the camera is the mean of divisor x divisor pixels */
    fxs_fit_camera camera;         /* without pose correction */
    uint32_t number;               /* index of the photograph's exposure and pose */
    const uint8_t *mask;           /* null, or a byte per pixel of `pixels`; 0: ignored */
} fxs_fit_photograph;

/* The parameters of `count` Gaussians, Adam's moments, and sums for densification. stride: at least `count` rounded up
   to FXS_FIT_GROUP. Gaussians beyond `count` have scales and opacities of -FXS_FIT_FARTHEST, quaternions (1, 0, 0, 0),
   and zeros. */
typedef struct fxs_fit_model {
    size_t count, stride;
    float *parameters, *means, *squares;
    float *by_centre, *views;      /* sums of |dL/dcentre|; number of views that saw the Gaussian */
    float *masters;                /* parameters before quantisation by `grid`; null: not quantised */
    const fxs_fit_grid *grid;
    fxs_fit_gains *gains;          /* null: exposures are not fitted */
    fxs_fit_poses *poses;          /* null: poses are not fitted */
    const fxs_fit_cameras *cameras;    /* cameras that limit scales from below; null: no limit */
} fxs_fit_model;

typedef struct fxs_fit_step_options {
    int sh_degree;
    float background[3];
    float rate[FXS_FIT_PARAMETERS];
    uint32_t number;               /* number of the step, from 1 */
    float gain_rate;               /* learning rate of exposures, log2 units; 0: fixed */
    float gain_decay;
    float pose_rate;               /* learning rate of poses, radians; 0: fixed */
    float by_opacity, by_scale;    /* weights of mean opacity and mean scale in the loss */
    int smooths;                   /* divisor of the photographs, for the lower limit of scales; 0: no limit */
    fxs_fit_far far;
    fxs_fit_noise noise;           /* noise of positions; amount 0: none */
    size_t changed;                /* CPU only: changes only the first `changed` Gaussians; 0: all */
} fxs_fit_step_options;

fxs_fit_stepper *fxs_fit_stepper_create(const fxs_fit_stages *stages, fxs_run_fn *run, void *pool, uint32_t threads,
                                  fxs_clock_fn *clock);
void fxs_fit_stepper_free(fxs_fit_stepper *step);

/* Draws the model into planes of red, green and blue. */
int fxs_fit_draw(fxs_fit_stepper *step, const fxs_fit_model *model, const fxs_fit_camera *camera,
                 const fxs_fit_step_options *options, fxs_fit_plane planes[3]);

int fxs_fit_stepper_step(fxs_fit_stepper *step, fxs_fit_model *model, const fxs_fit_photograph *photographs,
                         uint32_t batch, const fxs_fit_step_options *options, fxs_fit_report *report);

/* Draws the model over black with a photograph's camera, and distributes each pixel's squared difference from the
   photograph over Gaussians by blending weights. errors: sum per Gaussian. Increments the model's `views` of visible
   Gaussians. */
int fxs_fit_find_errors(fxs_fit_stepper *step, fxs_fit_model *model, const fxs_fit_photograph *photograph,
                        const fxs_fit_step_options *options, float *errors);

/* Sets Adam's parameters. Gradients are sums over all pixels and channels of the batch, so epsilon and weights are
   scaled accordingly. */
void fxs_fit_set_adam(fxs_fit_adam *adam, const fxs_fit_step_options *options, const fxs_fit_photograph *photographs,
                      uint32_t batch, size_t gaussians);

/* Adds a photograph's loss to a report. rows: for each channel, row sums of |a - b|, then of 1 - SSIM. */
void fxs_fit_add_loss(const float *rows, const fxs_fit_camera *camera, uint32_t batch, fxs_fit_report *report);

void fxs_fit_quantise(fxs_fit_stepper *step, fxs_fit_model *model);

#ifdef __cplusplus
}
#endif

#endif
