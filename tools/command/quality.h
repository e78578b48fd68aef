/* The difference of a scene's pictures from its original's, which are drawn from floats in double precision. */
#ifndef QUALITY_H
#define QUALITY_H

#include "metrics.h"
#include "drawing.h"

typedef struct quality_view {
    char name[128];
    long index;                     /* number of the view in the camera file */
    int width, height;              /* pixels */
    struct fxs_metrics metrics;
    double affine_psnr;             /* see fxs_metrics_affine_psnr; valid with has_affine */
    double nudged_psnr;             /* nudged original against the original; infinity: not drawn */
} quality_view;

typedef struct quality {
    quality_view *views;
    long count;
    double psnr, ssim;              /* means: psnr over the views that differ, infinity if none does; ssim over the
                                       views that have one (metrics.h), NaN if none has */
    double worst_psnr, worst_ssim;  /* lowest over the views, each by itself */
    long worst_view;                /* index in `views` of the first with worst_psnr */
    long nudged_view;               /* index in `views` of the smallest nudged_psnr - psnr */
    int has_nudged;                 /* 1: views have nudged_psnr */
    int has_affine;                 /* 1: views are of photographs, and have affine_psnr */
    double affine_psnr, worst_affine_psnr; /* mean, computed like psnr; lowest */
} quality;

/* Files to be read in floats with open_merged. */
typedef struct float_files {
    const fxs_world *placed;
    const char *name;
    const load_options *load;
} float_files;

/* Draws scene and original from up to `wanted` views of the size in the options. With a camera file: evenly spaced
   views of it. Otherwise: views evenly turned about the scene's middle, in turn at middle distance (as render frames
   the scene), close (0.35 times that, where the scene is larger than the picture) and far (2 times). The scene is
   rendered packed, or drawn from the floats of `files` unless null. The original has its own cut-off. If a view's
   PSNR is below `nudge_below` dB, the original is drawn once more with its Gaussians moved at random by up to 1e-6
   of the distance from the camera to the scene's middle, which changes the order of coincident Gaussians. Returns 0
   and a result for quality_free, or prints the reason and returns EXIT_FAILED. */
int quality_measure(quality *q, const world *scene, const float_files *files, const float_files *original,
                    enum fxs_cutoff original_cutoff, const frame_options *options, long wanted, double nudge_below);

/* Computes the means and the worst values over the views. */
void quality_sum_up(quality *q);

/* The view in which the nudged original differs from the original by a quarter or more of the scene's squared error, or
   null. In such a view no coding of positions can lose much less. */
const quality_view *quality_nudged(const quality *q);

void quality_print_text(const quality *q);
void quality_print_json(const quality *q);   /* an object without a newline */
void quality_free(quality *q);

#endif
