/* Affine maps of Gaussians, for formats whose scenes have transforms. */
#ifndef FXS_TRANSFORM_INTERNAL_H
#define FXS_TRANSFORM_INTERNAL_H

#include <fixsplat/gaussian.h>

typedef struct fxs_transform {
    double linear[3][3], shift[3];
    double sh[15][15];   /* rotates the coefficients of degrees 1 to 3 */
} fxs_transform;

/* Sets the map with these rows. Returns 0, or -1 where it has no inverse. */
int fxs_transform_init(fxs_transform *transform, double rows[3][4]);

/* Maps position and covariance, and the SH by the map's rotation. */
void fxs_transform_apply(const fxs_transform *transform, fxs_gaussian *gaussian, int sh_degree);

/* Sets rotation and scales from the covariance m m^T; m is changed. */
void fxs_set_axes(fxs_gaussian *gaussian, double m[3][3]);

/* The same from a covariance xx, yy, zz, xy, xz, yz. Numbers that rounding made negative become 0; to each variance a
   millionth of a millionth of their sum is added, and `least`. */
void fxs_set_covariance(fxs_gaussian *gaussian, const double covariance[6], double least);

#endif
