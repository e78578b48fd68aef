/* The reference for image quality: a double-precision renderer of unquantised Gaussians, after Kerbl et al. 2023,
   "3D Gaussian Splatting for Real-Time Radiance Field Rendering", and Zwicker et al. 2001, "EWA Volume Splatting".
   It shares no code with the library's renderer. */
#ifndef REFERENCE_H
#define REFERENCE_H

#include <stddef.h>
#include <stdint.h>

#include <fixsplat/camera.h>
#include <fixsplat/scene.h>

enum reference_cutoff {
    REFERENCE_MAHALANOBIS,   /* distance squared <= 9 */
    REFERENCE_SQUARE         /* all 16x16 tiles touched by the square centre +- radius, as in the original */
};

struct reference_options {
    enum reference_cutoff cutoff;
    int sh_degree;            /* higher degrees are ignored */
    int antialiased;          /* 1: opacity compensates the dilation */
    double background[3];
};

/* One projected Gaussian. */
struct reference_splat {
    double x, y;         /* centre, pixels; pixel centres at +0.5 */
    double a, b, c;      /* covariance [[a, b], [b, c]], pixels^2, dilation included; positive definite */
    double opacity;      /* after compensation, 0 to 1 */
    double colour[3];
    double depth;        /* z in camera axes */
    int radius;          /* ceil(3 sigma_max), pixels; used by REFERENCE_SQUARE only */
};

/* Placement of Gaussians: world = translation + scale * rotation * position; SH turn along. */
struct reference_object {
    double rotation[9];  /* rows; orthonormal */
    double translation[3], scale;
    double opacity, tint[3];   /* factors */
};

/* Returns 1, or 0 if the Gaussian is culled: not finite, without rotation, not beyond the near plane, or below alpha
   1/255 at every pixel of its bounding box. */
int reference_project(const fxs_gaussian *gaussian, const fxs_view *view, const struct reference_options *options,
                      struct reference_splat *out);

/* The same for a Gaussian of an object. */
int reference_project_object(const fxs_gaussian *gaussian, const struct reference_object *object,
                             const fxs_view *view, const struct reference_options *options,
                             struct reference_splat *out);

/* Renders to width * height * 3 doubles, top row first, not clamped. Returns 0, or -1 if memory runs out. */
int reference_render(const fxs_gaussian *gaussians, size_t count, const fxs_view *view,
                     const struct reference_options *options, double *rgb);

/* The same for projected Gaussians in any order; sorts them front to back by depth, ties by index. */
int reference_render_splats(const struct reference_splat *splats, size_t count, int width, int height,
                            const struct reference_options *options, double *rgb);

#define REFERENCE_NONE ((size_t)-1)

/* Other targets of a picture. A splat is given by its index in the list; REFERENCE_NONE: no splat. */
struct reference_trace {
    const double *occluder;    /* depths; splats behind it add nothing. May be null */
    double *mean;              /* sum of weight * depth / sum of weights; infinite if all weights are 0 */
    double *weight;            /* sum of weights */
    size_t *median;            /* the splat at which the transmittance falls below 1/2 */
    double *median_margin;     /* smallest distance of the transmittance from 1/2 after any splat */
    size_t *largest;           /* the splat of the largest weight; the first of equals */
    double *most;              /* the largest weight */
    double *largest_margin;    /* relative gap between the largest and the next weight */
};

/* Allocates the arrays for a picture, except occluder, which becomes null. Returns 0, or -1 if memory runs out. */
int reference_trace_init(struct reference_trace *trace, int width, int height);
void reference_trace_free(struct reference_trace *trace);

/* reference_render_splats, which also fills in *trace. */
int reference_trace_splats(const struct reference_splat *splats, size_t count, int width, int height,
                           const struct reference_options *options, struct reference_trace *trace, double *rgb);

/* Clamps to 0..1 and rounds to the nearest of 0..255; alpha 255. */
void reference_to_rgba8(const double *rgb, int width, int height, uint8_t *rgba);

#endif
