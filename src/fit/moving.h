/* Fits a moving scene moment by moment. After the fit of the first moment, the Gaussians of a fit follow the
 * photographs of the next moments: their number and order stay. Gaussians that the new photographs do not ask to move
 * keep all bits. The others change position and rotation, and a little their scale, opacity and colour. The fitted
 * moments can be refined together, with smooth motions. Functions return 0, or an error and a message. */
#ifndef FXS_FIT_MOVING_H
#define FXS_FIT_MOVING_H

#include <fixsplat/fit.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_fit_followed {
    size_t tried, moved;           /* number of Gaussians that the steps could move, and of those that moved */
    size_t added;                  /* number of new Gaussians, in places that were hidden before */
    double absolute;               /* mean of |picture - photograph| over pixels and channels, in the last steps */
} fxs_fit_followed;

/* Makes a fit one of a moving scene, before its first step: the last steps then do not fit the codes of a packed
   scene. */
void fxs_fit_set_moving(fxs_fit *fit);

/* Ends the first moment of a moving scene, after the last step: sorts the Gaussians, which then keep their order, and
   measures how well they fit. Adds spare Gaussians, a quarter of the number, which cannot be seen until they show what
   was hidden before. The following moments are fitted on the processor. Errors: as fxs_fit_step. */
int fxs_fit_begin_moving(fxs_fit *fit, fxs_message *message);

/* Fits the next moment in `steps` steps. `photos` are the photographs of the same cameras, in the same order, as those
   that the fit was created with. The caller keeps their pixels and masks until the next call, or until the fit is
   freed. The previous photographs may be freed before the call. Errors: as fxs_fit_step. */
int fxs_fit_follow(fxs_fit *fit, const fxs_fit_photo *photos, uint32_t steps, fxs_fit_followed *followed,
                   fxs_message *message);

/* Sets *photos to the photographs of a moment, which stay until the next call. Returns 0, or an error and a message. */
typedef int fxs_fit_moment_fn(void *argument, size_t moment, const fxs_fit_photo **photos, fxs_message *message);

/* Refines the scene over the fitted moments from number `first` on, in `steps` steps: the motion of the Gaussians that
   moved, and the numbers that all moments share. Adds the mean of |picture - photograph|, over all steps, to *absolute.
   Errors: as fxs_fit_step and `read`. */
int fxs_fit_refine_moving(fxs_fit *fit, size_t first, uint32_t steps, fxs_fit_moment_fn *read, void *argument,
                          double *absolute, fxs_message *message);

/* Gives the Gaussians their poses in a fitted moment. Afterwards the fit cannot follow further moments. */
void fxs_fit_set_moment(fxs_fit *fit, size_t number);

#ifdef __cplusplus
}
#endif

#endif
