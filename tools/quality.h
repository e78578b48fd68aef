/* How far the pictures of a scene are from those of its original, which is drawn from its floats. */
#ifndef QUALITY_H
#define QUALITY_H

#include "metrics.h"
#include "drawing.h"

typedef struct quality_view {
    char name[128];
    long index;                     /* in the camera file */
    int width, height;              /* pixels */
    struct fxs_metrics metrics;
    double affine_psnr;             /* see fxs_metrics_affine_psnr; where quality has_affine */
    double nudged_psnr;             /* nudged original against the original; infinity: not drawn */
} quality_view;

typedef struct quality {
    quality_view *views;
    long count;
    double psnr, ssim;              /* means over the views; psnr over those that differ, infinity where none does;
                                       ssim over those that have one (metrics.h), NaN where none has */
    double worst_psnr, worst_ssim;  /* the lowest of any view, of each by itself */
    long worst_view;                /* in `views`: the first with worst_psnr */
    long nudged_view;               /* in `views`: the one with the least nudged_psnr - psnr */
    int has_nudged;                 /* 1: views have nudged_psnr */
    int has_affine;                 /* 1: views are of photographs, and have affine_psnr */
    double affine_psnr, worst_affine_psnr; /* the mean, like psnr, and the lowest */
} quality;

/* Files to be read in floats, as open_merged has them. */
typedef struct float_files {
    const fxs_world *placed;
    const char *name;
    const load_options *load;
} float_files;

/* Draws both from up to `wanted` views of the size in the options: evenly spaced ones of the camera file there, else
   evenly turned about the middle of the scene and in turn at middle distance (as render frames the scene), close
   (0.35 of that, where the scene is larger than the picture) and far (twice that). The scene is rendered as it is
   packed or, where `files` is not null, drawn from the floats of its files. The original has a cut-off of its own.
   Where a view's PSNR is below `nudge_below`, the original is drawn once more, with its Gaussians moved at random by up
   to 1e-6 of the distance from the camera to the middle of the scene. That changes the order of coincident Gaussians.
   Returns 0 and what quality_free frees, or prints why not and returns EXIT_FAILED. */
int quality_measure(quality *q, const world *scene, const float_files *files, const float_files *original,
                    enum fxs_cutoff original_cutoff, const frame_options *options, long wanted, double nudge_below);

/* The means and the worst of the views' metrics. */
void quality_sum_up(quality *q);

/* A view in which nudging the Gaussians changes the picture by a quarter or more of the view's loss, in squared error;
   null: none. No coding of positions can be expected to lose much less there. */
const quality_view *quality_nudged(const quality *q);

void quality_print_text(const quality *q);
void quality_print_json(const quality *q);   /* an object, without a newline */
void quality_free(quality *q);

#endif
