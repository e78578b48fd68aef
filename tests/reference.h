/* The measuring stick of image quality: a double-precision renderer of unquantised Gaussians, after Kerbl et al. 2023,
   "3D Gaussian Splatting for Real-Time Radiance Field Rendering", and Zwicker et al. 2001, "EWA Volume Splatting".
   It shares no code with the renderer it measures. */
#ifndef REFERENCE_H
#define REFERENCE_H

#include <stddef.h>
#include <stdint.h>

#include "../port/camera/camera_file.h"
#include "../port/scene/scene_file.h"

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

/* Returns 1, or 0 where the Gaussian is culled: not finite, no rotation, not beyond the near plane, or its bounding box
   holds no pixel at which it reaches alpha 1/255. */
int reference_project(const fxs_gaussian *gaussian, const fxs_file_view *view, const struct reference_options *options,
                      struct reference_splat *out);

/* Renders to width * height * 3 doubles, rows from the top, not clamped. Returns 0, or -1 when out of memory. */
int reference_render(const fxs_gaussian *gaussians, size_t count, const fxs_file_view *view,
                     const struct reference_options *options, double *rgb);

/* The same from projected Gaussians, in any order: front to back by depth, ties by index. */
int reference_render_splats(const struct reference_splat *splats, size_t count, int width, int height,
                            const struct reference_options *options, double *rgb);

/* Clamps to 0..1 and rounds to the nearest of 0..255; alpha 255. */
void reference_to_rgba8(const double *rgb, int width, int height, uint8_t *rgba);

#endif
