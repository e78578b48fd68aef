/* Lenses that bend what a pinhole would show: OpenCV's models, as COLMAP and nerfstudio write them. Computed in doubles
 * by + - * / and sqrt alone, so that it is the same everywhere. */
#ifndef FXS_LENS_H
#define FXS_LENS_H

#include <fixsplat/camera_file.h>

/* All 0: a pinhole. The coefficients are OpenCV's. */
typedef struct fxs_lens {
    int fisheye;             /* 1: k[0] to k[3] are those of its fisheye model, which bends with all of them 0, too */
    double k[6], p[2];       /* radial: a polynomial over another; tangential */
} fxs_lens;

/* 1 where it bends nothing. */
int fxs_lens_is_pinhole(const fxs_lens *lens);

/* Where the lens puts what a pinhole puts to x, y: both in focal lengths from the principal point. */
void fxs_lens_bend(const fxs_lens *lens, double x, double y, double bent[2]);

/* Scales the focal lengths of a pinhole camera, by 1/2 to 2, so that its picture is as wide as the photograph that was
   taken through the lens can fill without gaps. Returns 0 where it cannot. */
int fxs_lens_fill(const fxs_lens *lens, const fxs_file_view *photograph, fxs_file_view *pinhole);

#endif
