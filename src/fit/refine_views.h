/* The pictures of a packed scene's leaves that its levels of detail are refined by. */
#ifndef FXS_REFINE_VIEWS_H
#define FXS_REFINE_VIEWS_H

#include <fixsplat/refine.h>
#include "stepper.h"

/* The views in two sizes; the large ones only where there are steps. */
enum { FXS_REFINE_LARGE, FXS_REFINE_SMALL, FXS_REFINE_SIZES };

typedef struct fxs_refine_views {
    fxs_fit_photograph photographs[FXS_REFINE_SIZES][FXS_REFINE_VIEWS];
    uint32_t count;
    uint8_t *pixels;                   /* of all */
    float extent;                      /* half the diagonal of the box of what is seen */
} fxs_refine_views;

/* Chooses the views of an open scene at `data` and renders them. Returns 0, or an error and a message;
   fxs_refine_views_free is called in any case. */
int fxs_refine_views_make(fxs_refine_views *views, const fxs_scene *scene, const void *data,
                          const fxs_refine_options *options, fxs_message *message);
void fxs_refine_views_free(fxs_refine_views *views);

#endif
