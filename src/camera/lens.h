/* Distortion of lenses: OpenCV's models, as COLMAP and nerfstudio write them, and others of COLMAP. They are computed
 * in doubles by + - * / and sqrt alone, so the results are the same on every machine. */
#ifndef FXS_LENS_H
#define FXS_LENS_H

#include <fixsplat/camera_file.h>

/* Where a lens puts the place x, y of the pinhole picture, in focal lengths from the principal point, with r^2 = x^2 +
   y^2 and theta = atan r. The terms of p and s are, with t^2 = u^2 + v^2,
       2 p0 u v + p1 (t^2 + 2 u^2) + s0 t^2 + s1 t^4   in x, and
       p0 (t^2 + 2 v^2) + 2 p1 u v + s2 t^2 + s3 t^4   in y. */
enum fxs_lens_kind {
    FXS_LENS_BROWN,          /* (x, y) (1 + k0 r^2 + ... + k3 r^8) / (1 + d0 r^2 + d1 r^4 + d2 r^6), and the terms of p
                                at u, v = x, y */
    FXS_LENS_FISHEYE,        /* u, v = (x, y) theta / r: (u, v) (1 + k0 theta^2 + ... + k5 theta^12), and the terms at
                                u, v */
    FXS_LENS_FISHEYE_AFTER,  /* the same, but with the terms at the place that the series gives */
    FXS_LENS_FOV,            /* (x, y) atan(2 r tan(k0 / 2)) / (k0 r) */
    FXS_LENS_DIVISION,       /* (x, y) 2 / (1 + sqrt(1 - 4 k0 r^2)) */
    FXS_LENS_EUCM            /* (x, y) / (k0 sqrt(k1 r^2 + 1) + 1 - k0) */
};

/* All 0: a pinhole. */
typedef struct fxs_lens {
    enum fxs_lens_kind kind;
    double k[6], d[3], p[2], s[4];
    double skew;             /* so much of the place in y is added to that in x */
} fxs_lens;

/* The coefficient of a letter: 0 to 5 for k, a to c for d, p and q for p, s to v for s. */
double *fxs_lens_coefficient(fxs_lens *lens, char letter);

/* Checks coefficients as they were read, and adds what follows from them. Returns 0 where one is not finite, or is out
   of the range of its model: k0 of FXS_LENS_FOV 0 to 3.14, k0 of FXS_LENS_EUCM 0 to 1, and its k1 above 0. */
int fxs_lens_complete(fxs_lens *lens);

/* 1 where the lens has no distortion, else 0. */
int fxs_lens_is_pinhole(const fxs_lens *lens);

/* Maps a place x, y in the pinhole picture to its place in the photograph, both in focal lengths from the principal
   point; not finite where the lens does not see it. */
void fxs_lens_bend(const fxs_lens *lens, double x, double y, double bent[2]);

/* Scales the focal lengths of a pinhole camera so that its picture has the widest view that the photograph through the
   lens fills without gaps: by 1/2 to 2, or more where a lens that is not FXS_LENS_BROWN would see more than 60 degrees
   from the axis to a side. Returns 0 where no such scale exists. */
int fxs_lens_fill(const fxs_lens *lens, const fxs_file_view *photograph, fxs_file_view *pinhole);

/* The tangent of 0 to pi / 2. */
double fxs_tangent(double angle);

#endif
