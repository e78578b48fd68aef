/* Takes a sample of Gaussians, small enough to render dozens of times. */
#ifndef FXS_SAMPLE_H
#define FXS_SAMPLE_H

#include <fixsplat/fixsplat.h>
#include <fixsplat/internal/message.h>

#define FXS_SAMPLE_MOST 20480u       /* largest number of Gaussians in the sample that are drawn */
#define FXS_SAMPLE_POINTS (3 * FXS_SAMPLE_MOST)

typedef struct fxs_sample_point {
    double place[3];
    double normal[3];                /* direction of the Gaussian's thinnest axis, length 1, either sign */
    double size;                     /* size of the Gaussian: square root of the product of its two largest sigmas */
    double flatness;                 /* flatness of the Gaussian: 31/32 - thinnest / middle sigma, at least 0 */
    double opacity;
} fxs_sample_point;

/* A sample of Gaussians as points. Some points are also packed for drawing, enlarged and with SH degree 0. */
typedef struct fxs_sample {
    fxs_object *objects;
    uint32_t count;                  /* number of objects that have a drawn Gaussian */
    fxs_sample_point *points;
    uint32_t point_count;
    double step;                     /* number of the scene's Gaussians for each point of the sample */
    fxs_scene *scenes;
    unsigned char *bytes;
} fxs_sample;

/* Takes a sample of the Gaussians of objects. Returns 0, or FXS_ERR_MEMORY or FXS_ERR_SCENE and a message. The result
   is the same on every machine. */
int fxs_sample_take(fxs_sample *sample, const fxs_object *objects, uint32_t count, fxs_message *message);
void fxs_sample_free(fxs_sample *sample);

void fxs_sort_values(double *values, uint32_t count);

#endif
