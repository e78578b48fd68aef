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
    const uint8_t *pixels;         /* pixels of the photograph in red, green, blue; rows without gaps */
    int32_t width, height;
    int32_t divisor;               /* each pixel of the camera's picture is compared with the mean of divisor x divisor
                                      pixels */
    fxs_fit_camera camera;         /* camera of the photograph, without pose correction */
    uint32_t number;               /* index of the exposure and the pose that belong to the photograph */
    const uint8_t *mask;           /* mask of the photograph: null, or a byte per pixel of `pixels`; 0: ignored */
} fxs_fit_photograph;

/* The parameters of `count` Gaussians, Adam's moments, and sums for densification. stride: length of each parameter's
   array, at least `count` rounded up to FXS_FIT_GROUP. Gaussians beyond `count` have scales and opacities of
   -FXS_FIT_FARTHEST, quaternions (1, 0, 0, 0), and zeros. */
typedef struct fxs_fit_model {
    size_t count, stride;
    float *parameters, *means, *squares;
    float *by_centre, *views;      /* sums of |dL/dcentre| for each Gaussian; number of views that saw the Gaussian */
    float *masters;                /* exact parameters before quantisation by `grid`; null: not quantised */
    const fxs_fit_grid *grid;
    fxs_fit_gains *gains;          /* exposures of the photographs; null: not fitted */
    fxs_fit_poses *poses;          /* pose corrections of the cameras; null: not fitted */
    const fxs_fit_cameras *cameras;    /* cameras that limit the scales of Gaussians from below; null: no limit */
    struct fxs_fit_origin *origins;    /* null, or where the Gaussians of a part come from (model.h) */
} fxs_fit_model;

typedef struct fxs_fit_step_options {
    int sh_degree;
    float background[3];
    float rate[FXS_FIT_PARAMETERS];
    uint32_t number;               /* number of the fitting step, from 1 */
    float gain_rate;               /* learning rate of exposures: the share of the way to the best gains, or for affine
                                      exposures Adam's rate; 0: they stay fixed */
    float gain_decay;
    float pose_rate;               /* learning rate of camera poses in radians; 0: they stay fixed */
    float by_opacity, by_scale;    /* weights of the mean opacity and the mean scale in the loss */
    float by_flat, by_surface;     /* weights in the loss of the mean smallest scale, and of the mean disagreement of
                                      Gaussians and depths (fit_surface.h); by_surface 0: depths are not compared */
    int is_depth;                  /* 0: the comparison turns Gaussians; 1: it moves them */
    int smooths;                   /* divisor of the photographs' size, for the lower limit of scales; 0: no limit */
    fxs_fit_far far;
    fxs_fit_noise noise;           /* random displacements of Gaussians; amount 0: none */
    size_t changed;                /* number of Gaussians, from the first, that the step changes; 0: all; only on the
                                      CPU */
} fxs_fit_step_options;

fxs_fit_stepper *fxs_fit_stepper_create(const fxs_fit_stages *stages, fxs_run_fn *run, void *pool, uint32_t threads,
                                  fxs_clock_fn *clock);
void fxs_fit_stepper_free(fxs_fit_stepper *step);

/* Draws the Gaussians with a camera into three planes of pixels: red, green and blue. */
int fxs_fit_draw(fxs_fit_stepper *step, const fxs_fit_model *model, const fxs_fit_camera *camera,
                 const fxs_fit_step_options *options, fxs_fit_plane planes[3]);

int fxs_fit_stepper_step(fxs_fit_stepper *step, fxs_fit_model *model, const fxs_fit_photograph *photographs,
                         uint32_t batch, const fxs_fit_step_options *options, fxs_fit_report *report);

/* Draws the Gaussians over the background with a photograph's camera. Distributes each pixel's squared difference from
   the photograph over the Gaussians by their blending weights. errors: sum for each Gaussian; weights: sum of its
   weights, may be null. Both have the model's stride, and leave out pixels that the mask ignores. Adds 1 to `views` of
   each visible Gaussian in the model. */
int fxs_fit_find_errors(fxs_fit_stepper *step, fxs_fit_model *model, const fxs_fit_photograph *photograph,
                        const fxs_fit_step_options *options, float *errors, float *weights);

/* Sets the parameters of an Adam step. Gradients are sums over all pixels and channels of the batch, so epsilon and the
   regularisers' weights are scaled accordingly. */
void fxs_fit_set_adam(fxs_fit_adam *adam, const fxs_fit_step_options *options, const fxs_fit_photograph *photographs,
                      uint32_t batch, size_t gaussians);

/* Sums the gradient by a photograph's exposure over the rows of its picture. rows: for each number of an exposure, row
   sums of the terms of gain_gradient (exposure.h). */
void fxs_fit_sum_gains(const float *rows, const fxs_fit_camera *camera, float by_gain[FXS_FIT_GAIN]);

/* Updates the exposures of a batch's photographs. */
void fxs_fit_move_gains(const fxs_fit_gains *gains, const fxs_fit_photograph *photographs, uint32_t batch,
                        float (*by_gain)[FXS_FIT_GAIN], const fxs_fit_step_options *options);

/* Sets the factors of a photograph's exposure; without exposures, to those that change no colour. */
void fxs_fit_factors_of(const fxs_fit_model *model, const fxs_fit_photograph *photograph, float factors[FXS_FIT_GAIN]);

/* Returns a photograph's camera with its pose correction. */
fxs_fit_camera fxs_fit_camera_of(const fxs_fit_model *model, const fxs_fit_photograph *photograph);

/* Makes a step of a photograph's pose correction. parts: for each number of the gradient, `count` partial sums over
   Gaussians, of FXS_FIT_PART Gaussians each. */
void fxs_fit_move_pose(const fxs_fit_poses *poses, const fxs_fit_photograph *photograph, const float *parts,
                       size_t count, float rate);

/* Adds a photograph's loss to a progress report. rows: for each colour channel, row sums of |picture - photograph|,
   then of 1 - SSIM. */
void fxs_fit_add_loss(const float *rows, const fxs_fit_camera *camera, uint32_t batch, fxs_fit_report *report);

void fxs_fit_quantise(fxs_fit_stepper *step, fxs_fit_model *model);

#ifdef __cplusplus
}
#endif

#endif
