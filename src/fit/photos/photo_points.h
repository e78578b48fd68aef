/* Initial points of a fit: read from COLMAP, Bundler or .ply files, or random. */
#ifndef FXS_FIT_PHOTO_POINTS_H
#define FXS_FIT_PHOTO_POINTS_H

#include <fixsplat/fit.h>

typedef struct fxs_photo_points {
    fxs_fit_point *points;         /* the points; freed by the caller */
    size_t count, capacity;
    uint64_t after, last;          /* of COLMAP, only points with a number above `after` are read; largest number of a
                                      point of the file. For the first read both are 0 */
} fxs_photo_points;

/* Read points from files of COLMAP, Bundler or .ply. Return 0, or an error and a message. Coordinates that are not
   finite or beyond 2^27 scene units are errors. */
int fxs_photo_points_colmap(fxs_photo_points *points, const char *path, fxs_message *message);
int fxs_photo_points_bundler(fxs_photo_points *points, const char *path, fxs_message *message);
int fxs_photo_points_ply(fxs_photo_points *points, const char *path, fxs_message *message);

/* Makes 100,000 random grey points in the cube with the centre `middle` and half the side `half`. */
int fxs_photo_points_random(fxs_photo_points *points, const double middle[3], double half, uint64_t seed,
                            fxs_message *message);

#endif
