/* More functions on fits (scenes fitted to photographs), for the library's ports and the command. */
#ifndef FXS_INTERNAL_FIT_MORE_H
#define FXS_INTERNAL_FIT_MORE_H

#include <fixsplat/fit.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Returns the number of sky Gaussians (distant ones) that the fit started with: 0 if no photograph shows sky, and in a
   resumed fit. */
FXS_EXPERIMENTAL size_t fxs_fit_sky_count(const fxs_fit *fit);

/* Finds the subject that the photographs' cameras look at, as a sphere. Its middle is the point nearest to the axes of
   all cameras (least squares). Each camera gives a distance: from its axis to the nearest edge of its picture, at the
   depth of the middle. The radius is the median of these distances. Returns 0, or an error and a message:
   FXS_ERR_ARGUMENT if the cameras do not look at one subject (their axes are nearly parallel, or in more than a quarter
   of the pictures the point is not in the middle half of the width and height), or FXS_ERR_MEMORY. */
FXS_EXPERIMENTAL int fxs_fit_find_subject(const fxs_fit *fit, fxs_fit_subject *subject, fxs_message *message);

/* Makes points to start a fit with, for photographs that a program has in memory without points: 100,000 grey points in
   a cube around the cameras. Returns 0 and points that the caller frees, or an error and a message, with *points null:
   FXS_ERR_ARGUMENT (no photographs), FXS_ERR_FILE if the cube reaches beyond 2^27 units, FXS_ERR_MEMORY. */
FXS_EXPERIMENTAL int fxs_photos_random_points(const fxs_fit_photo *photos, size_t photo_count, uint64_t seed,
                                     fxs_fit_point **points, size_t *point_count, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
