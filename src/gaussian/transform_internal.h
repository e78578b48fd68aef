/* Affine maps of Gaussians, for formats with transforms. */
#ifndef FXS_TRANSFORM_INTERNAL_H
#define FXS_TRANSFORM_INTERNAL_H

#include <fixsplat/scene.h>

typedef struct fxs_transform {
    double linear[3][3], shift[3];
    double sh[15][15];   /* rotates SH coefficients of degrees 1 to 3 */
} fxs_transform;

/* Sets the map from its rows. Returns 0, or -1 if it has no inverse. */
int fxs_transform_init(fxs_transform *transform, double rows[3][4]);

/* Maps position and covariance. Rotates the SH by the map's rotation part. */
void fxs_transform_apply(const fxs_transform *transform, fxs_gaussian *gaussian, int sh_degree);

/* Sets rotation and scales from the covariance m m^T. Overwrites m. */
void fxs_set_axes(fxs_gaussian *gaussian, double m[3][3]);

/* As fxs_set_axes, from a covariance xx, yy, zz, xy, xz, yz. Each variance is raised by 1e-12 of their sum and by
   `least`; values that rounding made negative become 0. */
void fxs_set_covariance(fxs_gaussian *gaussian, const double covariance[6], double least);

#endif
