/* A sample of some objects' Gaussians, small enough to render dozens of times. */
#ifndef FXS_SAMPLE_H
#define FXS_SAMPLE_H

#include <fixsplat/fixsplat.h>
#include <fixsplat/internal/message.h>

#define FXS_SAMPLE_MOST 20480u       /* most Gaussians that are drawn */
#define FXS_SAMPLE_POINTS (3 * FXS_SAMPLE_MOST)

/* A sampled Gaussian in world coordinates. */
typedef struct fxs_sample_point {
    double place[3];
    double normal[3];                /* the thinnest axis, length 1, either sign */
    double size;                     /* root of the product of the two largest sigmas */
    double flatness;                 /* 31/32 - thinnest / middle sigma, at least 0 */
    double opacity;                  /* 0 to 1 */
} fxs_sample_point;

/* Every step-th Gaussian as a point. Every point, every second or every third is packed again for drawing, with SH
   degree 0 and enlarged. */
typedef struct fxs_sample {
    fxs_object *objects;
    uint32_t count;                  /* objects with a drawn Gaussian */
    fxs_sample_point *points;
    uint32_t point_count;
    double step;                     /* Gaussians per point */
    fxs_scene *scenes;               /* one per object; they point into `bytes` */
    unsigned char *bytes;            /* all chunks */
} fxs_sample;

/* Takes a sample; free it with fxs_sample_free. Returns 0, or FXS_ERR_MEMORY or FXS_ERR_SCENE and a message, with
   nothing to free. The same on every machine: integers and exact doubles only. */
int fxs_sample_take(fxs_sample *sample, const fxs_object *objects, uint32_t count, fxs_message *message);
void fxs_sample_free(fxs_sample *sample);

/* Sorts in ascending order. */
void fxs_sort_values(double *values, uint32_t count);

#endif
