/* The state of a fit. */
#ifndef FXS_FIT_INTERNAL_H
#define FXS_FIT_INTERNAL_H

#include "engine.h"
#include <fixsplat/fit.h>
#include "model.h"
#include "profile.h"

struct fxs_fit {
    fxs_fit_options options;
    fxs_fit_photograph *photographs;
    uint32_t *order;               /* order of the photographs, one for each until all are used */
    size_t count;
    const fxs_fit_engine *engine;
    void *self;                    /* the engine's own data */
    fxs_fit_stepper *stepper;      /* makes the steps on the processor where there is no device */
    fxs_fit_model model;
    fxs_fit_gains gains;           /* exposures of the photographs, all 0 where the options ask for none */
    fxs_fit_poses poses;           /* of their cameras, all 0 where they stay as they are given */
    fxs_fit_cameras cameras;       /* of the photographs, of an antialiased fit; else none */
    fxs_fit_profile profile;
    float extent;
    fxs_fit_far far;               /* of a fit with a sky */
    size_t sky_count;              /* Gaussians that the sky began with; 0 in a fit that is resumed */
    uint32_t step;                 /* number of steps made so far */
};

/* The camera of a view, with the Mahalanobis cut-off, not anti-aliased. */
void fxs_fit_set_camera(fxs_fit_camera *camera, const fxs_file_view *view);

/* The common part of fxs_fit_create and fxs_fit_resume: a fit without Gaussians and extent, at step 0. */
int fxs_fit_begin(fxs_fit **fit, const fxs_fit_photo *photos, size_t photo_count, const fxs_fit_options *options,
                  fxs_message *message);

/* Hands the model, which was begun or read, and the exposures to the engine. Returns 0, or an error and a message. */
int fxs_fit_hand_over(fxs_fit *fit, fxs_message *message);

/* The engine of the processor, whose `self` is the fit. */
extern const fxs_fit_engine fxs_fit_engine_cpu;

/* Sets the engine that the options ask for (port/backend/fit_engines.c). Returns 0, or an error and a message. */
int fxs_fit_choose_engine(fxs_fit *fit, fxs_message *message);

/* Called before each step. The last tenth of the steps quantises by the packed profile; a fit in that phase that gets
   more steps leaves it. Returns 0 or an error. */
int fxs_fit_pass_profile(fxs_fit *fit, fxs_message *message);

/* Leaves these Gaussians of a fit, all KEPT and one at least, and codes them anew where they are coded. Returns 0, or an
   error and a message, after which the fit can only be freed. */
int fxs_fit_keep(fxs_fit *fit, const fxs_fit_origin *origins, size_t count, fxs_message *message);

/* Sets `order` for the photograph with this number in the sequence of all, up to the next permutation. */
void fxs_fit_set_order(fxs_fit *fit, uint64_t number);

#endif
