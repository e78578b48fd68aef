/* What a fit is made of. */
#ifndef FXS_FIT_INTERNAL_H
#define FXS_FIT_INTERNAL_H

#include "fit.h"
#include "model.h"

struct fxs_fit {
    fxs_fit_options options;
    fxs_fit_photograph *photographs;
    uint32_t *order;               /* of the photographs, for as many steps as there are */
    size_t count;
    uint8_t *reduced;              /* pixels of a photograph that is averaged down, where the recipe does that */
    fxs_fit_stepper *stepper;
    fxs_fit_model model;
    float extent;
    uint32_t step;                 /* steps that were made */
};

/* What fxs_fit_create and fxs_fit_resume have in common: a fit without Gaussians and extent, at step 0. */
int fxs_fit_begin(fxs_fit **fit, const fxs_fit_photo *photos, size_t photo_count, const fxs_fit_options *options,
                  fxs_message *message);

/* Sets `order` for the step that follows `step`, and those up to the next permutation. */
void fxs_fit_set_order(fxs_fit *fit);

#endif
