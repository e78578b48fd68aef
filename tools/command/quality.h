/* Compares pictures of a scene with those of its original, which is drawn from floats in double precision. */
#ifndef QUALITY_H
#define QUALITY_H

#include "metrics.h"
#include "drawing.h"

typedef struct quality_view {
    char name[128];
    long index;                     /* in the camera file */
    int width, height;
    struct fxs_metrics metrics;
    double affine_psnr;             /* see fxs_metrics_affine_psnr; valid with has_affine */
    double nudged_psnr;             /* of the nudged original, dB; infinity: not measured */
} quality_view;

typedef struct quality {
    quality_view *views;
    long count;
    double psnr, ssim;              /* means; psnr over views that differ; ssim over views with one */
    double worst_psnr, worst_ssim;  /* lowest over the views */
    long worst_view;                /* index of the first view with worst_psnr */
    long nudged_view;               /* index of the view with least nudged_psnr - psnr */
    int has_nudged;                 /* 1: views have nudged_psnr */
    int has_affine;                 /* 1: views show photographs, and have affine_psnr */
    double affine_psnr, worst_affine_psnr; /* mean; lowest */
} quality;

/* Scene files that open_merged reads as floats. */
typedef struct float_files {
    const fxs_world *placed;
    const char *name;
    const load_options *load;
} float_files;

/* Compares scene and original from up to `wanted` views: of the camera file, or around the scene. Scenes of `files`,
   unless null, are drawn from floats, others packed. In views below `nudge_below` dB the original is also compared
   with a nudged copy. Nudging moves Gaussians at random by up to 1e-6 of the camera's distance, which reorders
   coincident Gaussians. Returns 0, or prints the reason and returns EXIT_FAILED. Free *q with quality_free. */
int quality_measure(quality *q, const world *scene, const float_files *files, const float_files *original,
                    enum fxs_cutoff original_cutoff, const frame_options *options, long wanted, double nudge_below);

/* Computes the means and the worst values over the views. */
void quality_sum_up(quality *q);

/* Returns a view in which the nudged original has at least a quarter of the scene's squared error, or null. Such a
   view is sensitive to the order of coincident Gaussians, so no coding of positions can lose much less. */
const quality_view *quality_nudged(const quality *q);

void quality_print_text(const quality *q);
void quality_print_json(const quality *q);   /* an object without a newline */
void quality_free(quality *q);

#endif
