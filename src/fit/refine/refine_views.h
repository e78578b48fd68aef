/* Makes pictures of a packed scene at full detail. Its levels of detail are then fitted to these pictures. */
#ifndef FXS_REFINE_VIEWS_H
#define FXS_REFINE_VIEWS_H

#include <fixsplat/fit.h>
#include "src/fit/stepper.h"

enum { FXS_REFINE_LARGE, FXS_REFINE_SMALL, FXS_REFINE_SIZES };

typedef struct fxs_refine_views {
    fxs_fit_photograph photographs[FXS_REFINE_SIZES][FXS_REFINE_VIEWS];
    uint32_t count;
    uint8_t *pixels;
    float extent;                      /* half the diagonal of the scene's inner box, which leaves out far Gaussians */
} fxs_refine_views;

/* Chooses views of a scene and renders them. Returns 0, or an error and a message. In any case, fxs_refine_views_free
   must be called. */
int fxs_refine_views_make(fxs_refine_views *views, const fxs_scene *scene, const void *data,
                          const fxs_refine_options *options, fxs_message *message);
void fxs_refine_views_free(fxs_refine_views *views);

#endif
