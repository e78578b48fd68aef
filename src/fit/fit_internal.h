/* The state of a fit of Gaussians to photographs. Functions return 0, or an error and a message. */
#ifndef FXS_FIT_INTERNAL_H
#define FXS_FIT_INTERNAL_H

#include "engine.h"
#include <fixsplat/fit.h>
#include "model.h"
#include "profile.h"

struct fxs_fit {
    fxs_fit_options options;
    fxs_fit_photograph *photographs;
    uint32_t *order;               /* random order of the photographs in the current pass over all of them */
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
    size_t sky_count;              /* number of initial Gaussians that form the sky; 0 in a resumed fit */
    uint32_t step;
    uint32_t repeated;             /* number of steps that repeated a part of the recipe, which is at step - repeated */
    uint32_t reached;              /* number of the recipe's steps that were made at the last repeat */
    uint32_t most;                 /* largest number of Gaussians in repeated steps */
    int is_moving;                 /* 1: the first moment of a moving scene, whose codes are not fitted */
    struct fxs_fit_moving *moving; /* state of moving.c; null: before the end of the first moment */
};

/* Sets a fit's camera from a view, with cut-off by Mahalanobis distance and without antialiasing. */
void fxs_fit_set_camera(fxs_fit_camera *camera, const fxs_view *view);

int fxs_fit_begin(fxs_fit **fit, const fxs_fit_photo *photos, size_t photo_count, const fxs_fit_options *options,
                  fxs_message *message);

int fxs_fit_check_photographs(const fxs_fit_photo *photos, size_t count, fxs_message *message);

/* Checks that all points are in range, and that a camera sees one. */
int fxs_fit_check_points(const fxs_fit_photo *photos, size_t photo_count, const fxs_fit_point *points,
                         size_t point_count, fxs_message *message);

/* Sets photograph i of a fit, with its camera and a neutral exposure. */
void fxs_fit_set_photograph(fxs_fit *fit, size_t i, const fxs_fit_photo *photo);

/* Sets the poses of photographs from `first` on to those given; their depths come from the points. */
void fxs_fit_begin_poses(fxs_fit *fit, size_t first, const fxs_fit_point *points, size_t count);

int fxs_fit_hand_over(fxs_fit *fit, fxs_message *message);

extern const fxs_fit_engine fxs_fit_engine_cpu;

int fxs_fit_choose_engine(fxs_fit *fit, fxs_message *message);

/* Starts, updates or ends the quantisation of the Gaussians, which takes the last tenth of a fit's steps. Must be
   called before each step. */
int fxs_fit_pass_profile(fxs_fit *fit, fxs_message *message);

/* Keeps only the Gaussians listed in `origins` (at least one, all of kind FXS_FIT_KEPT). After an error the fit can
   only be freed. */
int fxs_fit_keep(fxs_fit *fit, const fxs_fit_origin *origins, size_t count, fxs_message *message);

/* Shuffles the photographs for one pass over all of them. `number` counts the photographs that the fit has used; it
   selects the pass and its order. */
void fxs_fit_set_order(fxs_fit *fit, uint64_t number);

/* Sets *photograph to the one that a fit uses as number `number`, reduced by a divisor. */
void fxs_fit_take_photograph(fxs_fit *fit, uint64_t number, int32_t divisor, fxs_fit_photograph *photograph);

void fxs_fit_moving_free(struct fxs_fit_moving *moving);    /* Frees the state of moving.c; null is allowed. */

#endif
