/* Distortion of lenses: OpenCV's models, as COLMAP and nerfstudio write them. They are computed in doubles by + - * /
 * and sqrt alone, so the results are the same on every machine. */
#ifndef FXS_LENS_H
#define FXS_LENS_H

#include <fixsplat/camera_file.h>

/* All 0: a pinhole. The coefficients are OpenCV's. */
typedef struct fxs_lens {
    int fisheye;             /* 1: OpenCV's fisheye model with k[0] to k[3]; it distorts even with all of them 0 */
    double k[6], p[2];       /* radial: the quotient of two polynomials; tangential */
    int is_unknown;          /* 1: of a model that is neither */
} fxs_lens;

/* 1 where the lens has no distortion, else 0. */
int fxs_lens_is_pinhole(const fxs_lens *lens);

/* Maps a place x, y in the pinhole picture to its place in the photograph, both in focal lengths from the principal
   point. */
void fxs_lens_bend(const fxs_lens *lens, double x, double y, double bent[2]);

/* Scales the focal lengths of a pinhole camera, by 1/2 to 2, so that its picture has the widest view that the
   photograph through the lens fills without gaps. Returns 0 where no such scale exists. */
int fxs_lens_fill(const fxs_lens *lens, const fxs_file_view *photograph, fxs_file_view *pinhole);

#endif
