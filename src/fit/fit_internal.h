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
    uint32_t *order;               /* permutation of the photographs for the current pass */
    size_t count;
    const fxs_fit_engine *engine;
    void *self;                    /* the engine's own data */
    fxs_fit_stepper *stepper;      /* CPU engine only */
    fxs_fit_model model;
    fxs_fit_gains gains;           /* exposures of the photographs; all 0 if not fitted */
    fxs_fit_poses poses;           /* pose corrections of the cameras; all 0 if not fitted */
    fxs_fit_cameras cameras;       /* cameras of the photographs; used by an antialiased fit */
    fxs_fit_profile profile;
    float extent;
    fxs_fit_far far;               /* used by a fit with a sky */
    size_t sky_count;              /* initial Gaussians of the sky; 0 in a resumed fit */
    uint32_t step;                 /* steps made so far */
};

/* The camera of a view, with the Mahalanobis cut-off, not anti-aliased. */
void fxs_fit_set_camera(fxs_fit_camera *camera, const fxs_file_view *view);

/* The common part of fxs_fit_create and fxs_fit_resume: a fit without Gaussians and extent, at step 0. */
int fxs_fit_begin(fxs_fit **fit, const fxs_fit_photo *photos, size_t photo_count, const fxs_fit_options *options,
                  fxs_message *message);

/* Hands the model and the exposures to the engine, after they were created or read. Returns 0, or an error and a
   message. */
int fxs_fit_hand_over(fxs_fit *fit, fxs_message *message);

/* The CPU engine; its `self` is the fit. */
extern const fxs_fit_engine fxs_fit_engine_cpu;

/* Sets the engine for the options (port/backend/fit_engines.c). Returns 0, or an error and a message. */
int fxs_fit_choose_engine(fxs_fit *fit, fxs_message *message);

/* Call before each step. The last tenth of the steps quantises by the packed profile; if a fit in that phase gets more
   steps, it leaves the phase. Returns 0 or an error. */
int fxs_fit_pass_profile(fxs_fit *fit, fxs_message *message);

/* Reduces a fit to these Gaussians (all KEPT, at least one), and recodes them if they are coded. Returns 0, or an error
   and a message; after an error the fit can only be freed. */
int fxs_fit_keep(fxs_fit *fit, const fxs_fit_origin *origins, size_t count, fxs_message *message);

/* Sets `order` to the permutation that contains this number in the endless sequence of photographs. */
void fxs_fit_set_order(fxs_fit *fit, uint64_t number);

#endif
