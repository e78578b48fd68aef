/* The photographs of a moving scene, grouped by moment. All cameras stand still, and each takes one photograph at each
 * moment. Functions return 0, or an error and a message. */
#ifndef FXS_FIT_MOMENTS_H
#define FXS_FIT_MOMENTS_H

#include <fixsplat/fit.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_moments fxs_moments;

/* How moments are found where the camera file states no times. */
typedef struct fxs_moments_options {
    const char *frames;            /* folder with a folder of photographs for each camera; null: the folder of the
                                      camera file, or the folder of its images */
    double fps;                    /* photographs of a camera a second; 0: 30 */
} fxs_moments_options;

/* Reads the cameras of a moving scene, and groups them by moment. Two layouts are read:

   - A transforms.json. Its frames have a "time", in seconds. The times may have any distance.
   - A camera file with a view for each camera, with the image NAME.png or NAME/FILE.png. The folder NAME of a camera
     has a photograph for each moment. The last number in the names gives the order.

   Of each `photos->hold_out` cameras, the first by name is held out at all moments, unless the file names test
   photographs. `photos` must stay until fxs_moments_free frees *moments, which is null after an error. Errors: as
   fxs_photos_read; FXS_ERR_FILE for a photograph without a time, a camera that moves or lacks a moment, and less than
   two moments or cameras. */
int fxs_moments_open(fxs_moments **moments, const char *path, const fxs_photos_options *photos,
                     const fxs_moments_options *options, fxs_message *message);
void fxs_moments_free(fxs_moments *moments);

size_t fxs_moments_count(const fxs_moments *moments);
double fxs_moments_time(const fxs_moments *moments, size_t number);    /* Returns the time of a moment in seconds. */

/* Reads the photographs of a moment; fxs_photos_free frees them. All moments have the same cameras in the same order.
   Only moment 0 gets points. The held-out photographs are of this moment too; perhaps none. */
int fxs_moments_read(const fxs_moments *moments, size_t number, fxs_photos *photos, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
