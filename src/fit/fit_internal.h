/* The state of a fit. Functions return 0, or an error and a message. */
#ifndef FXS_FIT_INTERNAL_H
#define FXS_FIT_INTERNAL_H

#include "engine.h"
#include <fixsplat/fit.h>
#include "model.h"
#include "profile.h"

struct fxs_fit {
    fxs_fit_options options;
    fxs_fit_photograph *photographs;
    uint32_t *order;               /* permutation of the photographs for the current pass */
    size_t count;
    const fxs_fit_engine *engine;
    void *self;
    fxs_fit_stepper *stepper;
    fxs_fit_model model;
    fxs_fit_gains gains;
    fxs_fit_poses poses;
    fxs_fit_cameras cameras;
    fxs_fit_profile profile;
    float extent;
    fxs_fit_far far;
    size_t sky_count;              /* initial Gaussians of the sky; 0 in a resumed fit */
    uint32_t step;
};

/* Sets a view's camera, with Mahalanobis cut-off and without antialiasing. */
void fxs_fit_set_camera(fxs_fit_camera *camera, const fxs_view *view);

int fxs_fit_begin(fxs_fit **fit, const fxs_fit_photo *photos, size_t photo_count, const fxs_fit_options *options,
                  fxs_message *message);

int fxs_fit_hand_over(fxs_fit *fit, fxs_message *message);

extern const fxs_fit_engine fxs_fit_engine_cpu;

int fxs_fit_choose_engine(fxs_fit *fit, fxs_message *message);

/* Must be called before each step. Starts, refreshes or ends quantisation, which takes the last tenth of the steps. */
int fxs_fit_pass_profile(fxs_fit *fit, fxs_message *message);

/* Keeps only the Gaussians in `origins` (all FXS_FIT_KEPT, at least one). After an error the fit can only be freed. */
int fxs_fit_keep(fxs_fit *fit, const fxs_fit_origin *origins, size_t count, fxs_message *message);

/* Sets `order` to the permutation that contains this number in the endless sequence of photographs. */
void fxs_fit_set_order(fxs_fit *fit, uint64_t number);

#endif
