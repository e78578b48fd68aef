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

/* Adds photographs and points to a running fit, between two steps. `photos`: the fit's photographs in
   their order, followed by the new ones; the array may have moved. Each point becomes a new Gaussian; of more points
   than max_gaussians has room for, the fit uses evenly spaced ones. There may be no new photographs, or no points. The
   cameras of the fit's photographs, exposures and poses stay. Copies its arguments, except the photographs' pixels and
   masks, which the caller keeps until the fit is freed. One thread at a time may use a fit. Errors: FXS_ERR_ARGUMENT
   (a camera, a point, a block, a scene that moves, or a fit in the last tenth of its steps), with the fit unchanged;
   FXS_ERR_MEMORY or FXS_ERR_DEVICE, after which the fit can only be freed. */
FXS_EXPERIMENTAL int fxs_fit_add_photos(fxs_fit *fit, const fxs_fit_photo *photos, size_t photo_count,
                                        const fxs_fit_point *points, size_t point_count, fxs_message *message);

/* Repeats the last `steps` steps of a fit's recipe: its learning rates and other schedules go back by this number of
   steps, and the whole fit gets as many more. For a fit that waits for photographs: in repeated steps, the recipes fast
   and mcmc add Gaussians only for new points. Errors: FXS_ERR_ARGUMENT if the recipe has made fewer steps, or in the
   last tenth of the steps. */
FXS_EXPERIMENTAL int fxs_fit_repeat(fxs_fit *fit, uint32_t steps, fxs_message *message);

/* Returns the number of repeated steps. A fit is complete after options.steps + this number of steps. */
FXS_EXPERIMENTAL uint32_t fxs_fit_repeated(const fxs_fit *fit);

/* Sorts photographs for fxs_fit_resume: the *count photographs of the saved fit come first, in its order, recognised by
   their cameras. Reads the whole saved fit. Errors: as fxs_fit_resume; FXS_ERR_FILE also if one is missing. */
FXS_EXPERIMENTAL int fxs_fit_saved_order(const char *path, fxs_fit_photo *photos, size_t photo_count, size_t *count,
                                         fxs_message *message);

/* Returns 1 if the photograph of this name shall be read. */
typedef int fxs_photo_wanted_fn(void *argument, const char *name);

/* Reads some photographs of a set as fxs_photos_read does, without points. None is held out: all are in photos->fit,
   sorted by name, and there may be none. */
FXS_EXPERIMENTAL int fxs_photos_read_some(const char *path, const fxs_photos_options *options,
                                          fxs_photo_wanted_fn *wanted, void *argument, fxs_photos *photos,
                                          fxs_message *message);

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
