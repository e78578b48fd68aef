/* A double-precision renderer of unquantised Gaussians, the reference for image quality. The method follows Kerbl et
   al. 2023, "3D Gaussian Splatting for Real-Time Radiance Field Rendering", and Zwicker et al. 2001, "EWA Volume
   Splatting". No code is shared with the library's renderer. */
#ifndef REFERENCE_H
#define REFERENCE_H

#include <stddef.h>
#include <stdint.h>

#include <fixsplat/camera.h>
#include <fixsplat/scene.h>

enum reference_cutoff {
    REFERENCE_MAHALANOBIS,   /* draws a splat at pixels with a squared Mahalanobis distance <= 9 */
    REFERENCE_SQUARE   /* draws a splat in all 16x16 tiles that the square of its radius around its centre touches */
};

struct reference_options {
    enum reference_cutoff cutoff;
    int sh_degree;
    int antialiased;          /* 1: lower the opacity of a splat to compensate for its dilation */
    double background[3];
};

struct reference_splat {
    double x, y;         /* centre in pixels; pixel centres lie at +0.5 */
    double a, b, c;      /* covariance [[a, b], [b, c]] in pixels^2, with dilation; positive definite */
    double opacity;      /* opacity from 0 to 1, after compensation for the dilation */
    double colour[3];
    double depth;
    int radius;          /* radius in pixels: ceil(3 sigma_max) */
};

/* Places a scene in the world: world = translation + scale * rotation * position. SH coefficients rotate with the
   object. */
struct reference_object {
    double rotation[9];  /* rotation matrix of the placed object, row by row */
    double translation[3], scale;
    double opacity, tint[3];
};

/* Returns 1, or 0 if the Gaussian is culled: not finite, without rotation, not beyond the near plane, or below alpha
   1/255 at every pixel of its bounding box. */
int reference_project(const fxs_gaussian *gaussian, const fxs_view *view, const struct reference_options *options,
                      struct reference_splat *out);

/* Projects a Gaussian of a placed object. Returns 1, or 0 if the Gaussian is culled. */
int reference_project_object(const fxs_gaussian *gaussian, const struct reference_object *object,
                             const fxs_view *view, const struct reference_options *options,
                             struct reference_splat *out);

/* Renders Gaussians to width * height * 3 doubles, top row first, not clamped. Returns 0, or -1 if memory runs
   out. */
int reference_render(const fxs_gaussian *gaussians, size_t count, const fxs_view *view,
                     const struct reference_options *options, double *rgb);

/* Renders projected Gaussians after sorting them by depth, then by index. */
int reference_render_splats(const struct reference_splat *splats, size_t count, int width, int height,
                            const struct reference_options *options, double *rgb);

#define REFERENCE_NONE ((size_t)-1)

/* Depths and indices of the splats (projected Gaussians) at each pixel, recorded while blending. REFERENCE_NONE is
   the index of no splat. */
struct reference_trace {
    const double *occluder;    /* depth at each pixel beyond which splats are hidden; may be null */
    double *mean;              /* mean depth: sum of weight * depth / sum of weights; infinite if all weights are 0 */
    double *weight;
    size_t *median;            /* index of the splat at which the transmittance falls below 1/2 */
    double *median_margin;     /* smallest |transmittance - 1/2| after any splat at the pixel */
    size_t *largest;           /* index of the splat with the largest weight */
    double *most;
    /* relative gap between the largest and the second largest weight of a splat at the pixel */
    double *largest_margin;
};

/* Allocates the arrays of a trace and sets occluder to null. Returns 0, or -1 if memory runs out. */
int reference_trace_init(struct reference_trace *trace, int width, int height);
void reference_trace_free(struct reference_trace *trace);

int reference_trace_splats(const struct reference_splat *splats, size_t count, int width, int height,
                           const struct reference_options *options, struct reference_trace *trace, double *rgb);

/* Converts a picture from levels of 0..1 to bytes of 0..255, clamped and rounded to nearest. Alpha is 255. */
void reference_to_rgba8(const double *rgb, int width, int height, uint8_t *rgba);

#endif
