/* A sample of the Gaussians of some objects, small enough to be drawn dozens of times. */
#ifndef FXS_SAMPLE_H
#define FXS_SAMPLE_H

#include <fixsplat/fixsplat.h>
#include <fixsplat/message.h>

#define FXS_SAMPLE_MOST 20480u       /* Gaussians that are drawn */
#define FXS_SAMPLE_POINTS (3 * FXS_SAMPLE_MOST)

/* A Gaussian of the objects, in the world. */
typedef struct fxs_sample_point {
    double place[3];
    double normal[3];                /* of length 1: the thinnest axis, in either direction */
    double size;                     /* root of the product of the two largest sigmas */
    double flatness;                 /* 31/32 - thinnest / middle sigma, or 0 */
    double opacity;                  /* 0 to 1 */
} fxs_sample_point;

/* Every so many-th Gaussian of the objects as a point; of these one in one to three packed again, of SH degree 0 and
   larger in proportion. */
typedef struct fxs_sample {
    fxs_object *objects;
    uint32_t count;                  /* of those with a Gaussian that is drawn */
    fxs_sample_point *points;
    uint32_t point_count;
    double step;                     /* Gaussians of the objects for each point */
    fxs_scene *scenes;               /* of each object; they point into `bytes` */
    unsigned char *bytes;            /* of all chunks */
} fxs_sample;

/* Returns 0 and a sample that fxs_sample_free frees; or FXS_ERR_MEMORY, or FXS_ERR_SCENE, and a message, with nothing
   to free. Integers and exact doubles alone: the same on every machine. */
int fxs_sample_take(fxs_sample *sample, const fxs_object *objects, uint32_t count, fxs_message *message);
void fxs_sample_free(fxs_sample *sample);

/* Sorts in ascending order. */
void fxs_sort_values(double *values, uint32_t count);

#endif
