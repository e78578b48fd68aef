/* Compares pictures of a scene with pictures of its original, which is drawn from floats in double precision. */
#ifndef QUALITY_H
#define QUALITY_H

#include "metrics.h"
#include "drawing.h"

typedef struct quality_view {
    char name[128];
    long index;
    int width, height;
    struct fxs_metrics metrics;
    double affine_psnr;             /* PSNR in dB after the best affine map of colours, valid if has_affine is 1 */
    double nudged_psnr;    /* PSNR in dB of the original with randomly moved Gaussians; infinity: not measured */
} quality_view;

typedef struct quality {
    quality_view *views;
    long count;
    double psnr, ssim;              /* mean PSNR over the views that are not equal; mean SSIM */
    double worst_psnr, worst_ssim;  /* lowest PSNR and SSIM of all views */
    long worst_view;
    long nudged_view;               /* index of the view with the least difference nudged_psnr - psnr */
    int has_nudged;
    int has_affine;                 /* 1: the original pictures are photographs, so affine PSNR is valid */
    double affine_psnr, worst_affine_psnr;
} quality;

typedef struct float_files {
    const fxs_world *placed;
    const char *name;
    const load_options *load;
} float_files;

typedef struct quality_options {
    long views;             /* most views, of the camera file or around the scene */
    double nudge_below;     /* in views below this PSNR in dB, the original is also compared with a nudged copy */
    int has_ssim;           /* 0: SSIM is not computed */
} quality_options;

/* Compares pictures of a scene and of its original. Scenes of `files` are drawn from floats, others packed. Nudging
   moves Gaussians at random by up to 1e-6 of the camera's distance. Scenes that move are compared at the moment of
   --compare-time, else at half of the duration of `scene`. Free *q with quality_free. */
int quality_measure(quality *q, const world *scene, const float_files *files, const float_files *original,
                    enum fxs_cutoff original_cutoff, const frame_options *options, const quality_options *how);

void quality_sum_up(quality *q);

/* Returns a view in which random moves of the original's Gaussians cause at least a quarter of the scene's squared
   error; null: no such view. There, the order of coincident Gaussians matters more than compression. */
const quality_view *quality_nudged(const quality *q);

void quality_print_text(const quality *q);
void quality_print_json(const quality *q);
void quality_free(quality *q);

#endif
