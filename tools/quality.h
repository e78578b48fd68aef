/* How far the pictures of a scene are from those of its original. */
#ifndef QUALITY_H
#define QUALITY_H

#include "command.h"
#include "metrics.h"

typedef struct quality_view {
    char name[128];
    long index;                     /* in the camera file */
    int width, height;              /* pixels */
    struct fxs_metrics metrics;
} quality_view;

typedef struct quality {
    quality_view *views;
    long count;
    double psnr, ssim;              /* means over the views; psnr over those that differ, infinity where none does */
} quality;

/* Renders both from up to `wanted` views: evenly spaced ones of the camera file in the options, else around the middle
   of the original; of the size in the options. Returns 0 and what quality_free frees, or prints why not and returns
   EXIT_FAILED. */
int quality_measure(quality *q, const loaded_scene *scene, const loaded_scene *original, const view_options *options,
                    long wanted);

void quality_print_text(const quality *q);
void quality_print_json(const quality *q);   /* an object, without a newline */
void quality_free(quality *q);

#endif
