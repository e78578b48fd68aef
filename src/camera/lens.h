/* Lens distortion models of OpenCV, COLMAP and nerfstudio. They use + - * / and sqrt of doubles only, so results are
   the same on every machine. */
#ifndef FXS_LENS_H
#define FXS_LENS_H

#include <fixsplat/camera.h>

/* Lens models: each gives the position in the photograph of a point (x, y) of the pinhole picture, both in focal
   lengths from the principal point. r^2 = x^2 + y^2, theta = atan r. The tangential and thin prism terms at u, v, with
   t^2 = u^2 + v^2, are 2 p0 u v + p1 (t^2 + 2 u^2) + s0 t^2 + s1 t^4 in x, and p0 (t^2 + 2 v^2) + 2 p1 u v + s2 t^2 +
   s3 t^4 in y. */
enum fxs_lens_kind {
    FXS_LENS_BROWN,          /* maps (x, y) to (x, y) (1 + k0 r^2 + ... + k3 r^8) / (1 + d0 r^2 + d1 r^4 + d2 r^6), plus
                                the tangential and thin prism terms at u, v = x, y */
    FXS_LENS_FISHEYE,        /* maps (x, y) to (u, v) (1 + k0 theta^2 + ... + k5 theta^12), plus the tangential and thin
                                prism terms at u, v, where u, v = (x, y) theta / r */
    FXS_LENS_FISHEYE_AFTER,  /* maps like FXS_LENS_FISHEYE, with the tangential and thin prism terms taken at the result
                                of the series */
    FXS_LENS_FOV,            /* maps (x, y) to (x, y) atan(2 r tan(k0 / 2)) / (k0 r) */
    FXS_LENS_DIVISION,       /* maps (x, y) to (x, y) 2 / (1 + sqrt(1 - 4 k0 r^2)) */
    FXS_LENS_EUCM            /* maps (x, y) to (x, y) / (k0 sqrt(k1 r^2 + 1) + 1 - k0) */
};

/* Coefficients of a lens model; all 0: pinhole. */
typedef struct fxs_lens {
    enum fxs_lens_kind kind;
    double k[6], d[3], p[2], s[4];
    double skew;             /* skew of the lens: x += skew * y, in the photograph */
} fxs_lens;

/* Returns the coefficient of a lens model that a letter names: k for 0 to 5, d for a to c, p for p and q, s for s to
   v. */
double *fxs_lens_coefficient(fxs_lens *lens, char letter);

/* Checks the coefficients of a lens model and fills in derived fields. Returns 0 if a coefficient is not finite or out
   of range. Ranges: k0 of FXS_LENS_FOV -3.14 to 3.14; k0 of FXS_LENS_EUCM 0 to 1, its k1 above 0. */
int fxs_lens_complete(fxs_lens *lens);

int fxs_lens_is_pinhole(const fxs_lens *lens);

/* Maps a point of the pinhole picture to the photograph, both in focal lengths from the principal point. The result is
   not finite where the lens sees nothing. */
void fxs_lens_bend(const fxs_lens *lens, double x, double y, double bent[2]);

/* Scales the focal lengths of a pinhole camera to the widest view that the photograph fills. The scale is 1/2 to
   2. Models other than FXS_LENS_BROWN may exceed 2 if they see more than 60 degrees to a side. Returns 0 if no
   scale fits. */
int fxs_lens_fill(const fxs_lens *lens, const fxs_view *photograph, fxs_view *pinhole);

/* Returns the tangent of an angle from 0 to pi / 2. */
double fxs_tangent(double angle);

#endif
