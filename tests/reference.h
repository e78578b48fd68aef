/* The measuring stick of image quality: a double-precision renderer of unquantised Gaussians, after Kerbl et al. 2023,
   "3D Gaussian Splatting for Real-Time Radiance Field Rendering", and Zwicker et al. 2001, "EWA Volume Splatting".
   It shares no code with the renderer it measures. */
#ifndef REFERENCE_H
#define REFERENCE_H

#include <stddef.h>
#include <stdint.h>

#include <fixsplat/camera_file.h>
#include <fixsplat/scene_file.h>

enum reference_cutoff {
    REFERENCE_MAHALANOBIS,   /* distance squared <= 9 */
    REFERENCE_SQUARE         /* the 16x16 tiles that the square centre +- radius touches, as in the original */
};

struct reference_options {
    enum reference_cutoff cutoff;
    int sh_degree;            /* degrees above it are ignored */
    int antialiased;          /* opacity compensates the dilation */
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

/* How Gaussians stand in the world: world = translation + scale * rotation * position, and SH turn with them. */
struct reference_object {
    double rotation[9];  /* rows; orthonormal */
    double translation[3], scale;
    double opacity, tint[3];   /* factors */
};

/* Returns 1, or 0 where the Gaussian is culled: not finite, no rotation, not beyond the near plane, or its bounding box
   holds no pixel at which it reaches alpha 1/255. */
int reference_project(const fxs_gaussian *gaussian, const fxs_file_view *view, const struct reference_options *options,
                      struct reference_splat *out);

/* The same of a Gaussian of an object. */
int reference_project_object(const fxs_gaussian *gaussian, const struct reference_object *object,
                             const fxs_file_view *view, const struct reference_options *options,
                             struct reference_splat *out);

/* Renders to width * height * 3 doubles, rows from the top, not clamped. Returns 0, or -1 when out of memory. */
int reference_render(const fxs_gaussian *gaussians, size_t count, const fxs_file_view *view,
                     const struct reference_options *options, double *rgb);

/* The same from projected Gaussians, in any order: front to back by depth, ties by index. */
int reference_render_splats(const struct reference_splat *splats, size_t count, int width, int height,
                            const struct reference_options *options, double *rgb);

#define REFERENCE_NONE ((size_t)-1)

/* What is seen at each pixel beside its colour. Splats are named by their place in the list; REFERENCE_NONE: none. */
struct reference_trace {
    const double *occluder;    /* depths; what is farther adds nothing. May be null */
    double *mean;              /* sum of weight * depth / sum of weights; infinite where no splat has one */
    double *weight;            /* sum of weights */
    size_t *median;            /* at which the transmittance falls below 1/2 */
    double *median_margin;     /* how near to 1/2 the transmittance was after any splat, at least */
    size_t *largest;           /* of the largest weight, the first of equal ones */
    double *most;              /* that weight */
    double *largest_margin;    /* how much smaller the next weight is, as a part of it */
};

/* Room for a picture, but for the occluder, which is null. Returns 0, or -1 when out of memory. */
int reference_trace_init(struct reference_trace *trace, int width, int height);
void reference_trace_free(struct reference_trace *trace);

/* reference_render_splats that fills in *trace. */
int reference_trace_splats(const struct reference_splat *splats, size_t count, int width, int height,
                           const struct reference_options *options, struct reference_trace *trace, double *rgb);

/* Clamps to 0..1 and rounds to the nearest of 0..255; alpha 255. */
void reference_to_rgba8(const double *rgb, int width, int height, uint8_t *rgba);

#endif
