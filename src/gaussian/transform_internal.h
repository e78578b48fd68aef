/* Affine maps of Gaussians, for file formats with transforms. */
#ifndef FXS_TRANSFORM_INTERNAL_H
#define FXS_TRANSFORM_INTERNAL_H

#include <fixsplat/scene.h>

typedef struct fxs_transform {
    double linear[3][3], shift[3];
    double sh[15][15];   /* rotation of the SH coefficients of degrees 1 to 3 */
} fxs_transform;

/* Sets the affine map from the rows of its matrix. Returns 0, or -1 if the map has no inverse. */
int fxs_transform_init(fxs_transform *transform, double rows[3][4]);

/* Maps the position and the covariance of a Gaussian, and rotates the SH coefficients by the rotation part of the
   map. */
void fxs_transform_apply(const fxs_transform *transform, fxs_gaussian *gaussian, int sh_degree);

/* Sets the rotation and the scales of a Gaussian from the covariance m m^T. Overwrites m. */
void fxs_set_axes(fxs_gaussian *gaussian, double m[3][3]);

/* Sets the rotation and the scales of a Gaussian from a covariance xx, yy, zz, xy, xz, yz. Each variance is raised by
   `least` and by 1e-12 of the variances' sum. */
void fxs_set_covariance(fxs_gaussian *gaussian, const double covariance[6], double least);

#endif
