/* Fits LANES Gaussians to surfaces. Each Gaussian stands for a plane across its shortest axis. Blended planes give a
 * depth and a normal for each pixel. The loss penalises the smallest scale (Chen et al. 2024, PGSR), and the difference
 * between the normals of Gaussians and those of the depths (Huang et al. 2024, 2DGS). Blending weights count as
 * constants, so that the gradient sums of a splat are sums of its weights. Compiled for the CPU and for CUDA. */
#ifndef FXS_FIT_SURFACE_H
#define FXS_FIT_SURFACE_H

#include "distant.h"
#include "fit_gaussian.h"

#define FXS_FIT_FLAT 3.0f          /* flattening ends where the shortest axis is e^3 times shorter than the next one */
#define FXS_FIT_GRAZING 0.04f      /* least squared cosine between view and normal; below it, planes face the camera */
#define FXS_FIT_STEP 0.02f         /* limit of the second difference of 1 / depth between pixels, relative to it */

/* The axes of LANES Gaussians by length. second, third: masks of Gaussians whose shortest axis is axis 1, axis 2; the
   others have axis 0. */
typedef struct axes {
    mask second, third;
    real shortest, middle;         /* ln of the scales */
} axes;

static inline axes axes_of(const float *at, size_t stride)
{
    const float *const scale = at + FXS_FIT_SCALE * (ptrdiff_t)stride;
    const real a = load(scale), b = load(scale + stride), c = load(scale + 2 * stride);
    const real low = least(a, b), high = most(a, b);
    const axes found = {below(b, a), below(c, low), least(c, low), most(low, least(c, high))};
    return found;
}

/* Returns x in the lanes whose shortest axis is axis i, 0 in the others. */
static inline real keep_axis(const axes *a, int i, real x)
{
    const real without_third = choose(a->third, all(0), x);
    return i == 2 ? keep(a->third, x) : i == 1 ? keep(a->second, without_third)
                                               : choose(a->second, all(0), without_third);
}

/* Sets s->unit, s->length and s->rotation, and n to the Gaussian's shortest axis. */
static inline void find_normal(shape *s, const axes *a, const float *at, size_t stride, real n[3])
{
    find_rotation(s, at, stride);
    for (int i = 0; i < 3; i++)
        n[i] = choose(a->third, s->rotation[i][2], choose(a->second, s->rotation[i][1], s->rotation[i][0]));
}

/* Finds the plane through a Gaussian's centre that is perpendicular to its shortest axis: 1 / depth of the plane is
   plane . ray at the pixel with the ray (x, y, 1) in the camera. Such planes may be blended like colours. */
static inline void find_plane(const fxs_fit_camera *camera, const float *at, size_t stride, real plane[3])
{
    const axes a = axes_of(at, stride);
    shape s;
    real n[3], offset[3];
    find_normal(&s, &a, at, stride, n);
    for (int i = 0; i < 3; i++)
        offset[i] = load(at + (FXS_FIT_POSITION + i) * (ptrdiff_t)stride) - camera->eye[i];
    const real square = dot3(offset, offset), along = dot3(n, offset);
    const mask is_grazing = at_most(along * along, square * FXS_FIT_GRAZING);
    const real inverse = 1.0f / choose(is_grazing, square, along);
    for (int i = 0; i < 3; i++)
        n[i] = choose(is_grazing, offset[i], n[i]) * inverse;
    for (int i = 0; i < 3; i++)
        plane[i] = (camera->rotation[3 * i] * n[0] + camera->rotation[3 * i + 1] * n[1]) +
                   camera->rotation[3 * i + 2] * n[2];
}

/* Sets the numbers of a pixel in a depth_map from its blended planes. 1 / depth is 0 where less than half of the light
   is covered. */
static inline void depth_numbers(const fxs_fit_camera *camera, real x, real y, const real planes[3], real transmittance,
                                 real out[4])
{
    const real covered = 1.0f - transmittance, inverse = 1.0f / most(covered, all(0.5f));
    const real ray[2] = {((x + 0.5f) - camera->middle[0]) * (1.0f / camera->focal[0]),
                         ((y + 0.5f) - camera->middle[1]) * (1.0f / camera->focal[1])};
    const real sum = (planes[0] * ray[0] + planes[1] * ray[1]) + planes[2];
    out[0] = keep(below(all(0.5f), covered), sum * inverse);
    out[1] = covered;
    out[2] = planes[0] * inverse;
    out[3] = planes[1] * inverse;
}

static inline mask is_smooth(real before, real own, real after)
{
    const mask is_there = both(both(below(all(0), before), below(all(0), after)), below(all(0), own));
    return both(is_there, at_most(absolute((before + after) - (own + own)), own * FXS_FIT_STEP));
}

/* Planes of the pixels of a picture: 1 / depth, the covered light, and x and y of the blended planes, divided by the
   covered light. `stride`: floats from row to row. */
typedef struct depth_map {
    const float *inverse, *covered, *across, *down;
    ptrdiff_t stride;
} depth_map;

/* Finds the plane of the depths around a pixel, in the camera, from central differences. Returns the pixels that have
   one: those within the picture whose neighbours lie on one surface with them. */
static inline mask depth_plane(const fxs_fit_camera *camera, real x, real y, const depth_map *d, ptrdiff_t at,
                               real plane[3])
{
    const float *const inverse = d->inverse + at;
    const real own = load(inverse), left = load(inverse - 1), right = load(inverse + 1);
    const real up = load(inverse - d->stride), down = load(inverse + d->stride);
    plane[0] = (right - left) * (0.5f * camera->focal[0]);
    plane[1] = (down - up) * (0.5f * camera->focal[1]);
    plane[2] = own - (plane[0] * (((x + 0.5f) - camera->middle[0]) * (1.0f / camera->focal[0])) +
                      plane[1] * (((y + 0.5f) - camera->middle[1]) * (1.0f / camera->focal[1])));
    const mask is_inside = both(both(below(all(0), x), below(x, all((float)(camera->width - 1)))),
                                both(below(all(0), y), below(y, all((float)(camera->height - 1)))));
    return both(is_inside, both(is_smooth(left, own, right), is_smooth(up, own, down)));
}

/* Turns a vector to the world, times a factor; 0 where the pixel has no plane, as the vector is undefined there. */
static inline void to_world(const fxs_fit_camera *camera, mask has_plane, const real in_camera[3], real factor,
                            real out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = keep(has_plane, ((camera->rotation[i] * in_camera[0] + camera->rotation[3 + i] * in_camera[1]) +
                                  camera->rotation[6 + i] * in_camera[2]) * factor);
}

/* Sets `out` to the unit normals of the depths around pixels, in the world, away from the camera, times `weight` and
   the covered light. This is the gradient by the normals of splats, times -1. */
static inline void depth_normal(const fxs_fit_camera *camera, real x, real y, const depth_map *d, ptrdiff_t at,
                                float weight, real out[3])
{
    real plane[3];
    const mask has_plane = depth_plane(camera, x, y, d, at, plane);
    const real factor = (load(d->covered + at) * weight) / most(root(dot3(plane, plane)), all(1e-30f));
    to_world(camera, has_plane, plane, factor, out);
}

/* Returns coordinate i of the difference between the plane of the depths around a pixel and the blended plane,
   divided by the plane's squared length: about the difference of angles. */
static inline real difference(const fxs_fit_camera *camera, real x, real y, const depth_map *d, ptrdiff_t at, int i)
{
    real plane[3];
    const mask has_plane = depth_plane(camera, x, y, d, at, plane);
    const real blended = load((i ? d->down : d->across) + at);
    return keep(has_plane, (plane[i] - blended) * (load(d->covered + at) / most(dot3(plane, plane), all(1e-30f))));
}

/* Sets `out` to the gradient by the positions of splats: along the normals, where the depths around a pixel bend away
   from the blended planes. */
static inline void depth_gradient(const fxs_fit_camera *camera, real x, real y, const depth_map *d, ptrdiff_t at,
                                  float weight, real out[3])
{
    real plane[3];
    const mask has_plane = depth_plane(camera, x, y, d, at, plane);
    const real a = difference(camera, x - 1.0f, y, d, at - 1, 0) - difference(camera, x + 1.0f, y, d, at + 1, 0);
    const real b = difference(camera, x, y - 1.0f, d, at - d->stride, 1) -
                   difference(camera, x, y + 1.0f, d, at + d->stride, 1);
    const real by_inverse = a * (0.5f * camera->focal[0]) + b * (0.5f * camera->focal[1]);
    const real factor = by_inverse * (load(d->inverse + at) * weight) / most(load(d->covered + at), all(0.5f));
    to_world(camera, has_plane, plane, -factor, out);
}

/* Adds the gradients of the flattening, and of the normals or the positions. by_surface: sum of -dL/dnormal over
   pixels, for a normal of either sign; if adam->is_depth, sum of dL/dposition. */
static inline void add_surface(const fxs_fit_adam *adam, const float *at, size_t stride, const real by_surface[3],
                               real gradient[FXS_FIT_SH])
{
    const axes a = axes_of(at, stride);
    const real unit = unit_at(&adam->far, at, stride);
    const real flat = keep(below(a.middle - FXS_FIT_FLAT, a.shortest), adam->by_flat * exp_e(a.shortest) / unit);
    shape s;
    real n[3], by_rotation[3][3], by_quaternion[4];
    find_normal(&s, &a, at, stride, n);
    const real sign = choose(below(dot3(n, by_surface), all(0)), all(1), all(-1));
    for (int i = 0; i < 3; i++) {
        const real by_normal = adam->is_depth ? all(0) : by_surface[i];
        gradient[FXS_FIT_POSITION + i] += adam->is_depth ? by_surface[i] : all(0);
        for (int k = 0; k < 3; k++)
            by_rotation[i][k] = keep_axis(&a, k, sign * by_normal);
    }
    rotation_gradient(&s, (const real(*)[3])by_rotation, by_quaternion);
    for (int i = 0; i < 3; i++)
        gradient[FXS_FIT_SCALE + i] += keep_axis(&a, i, least(flat, all(FXS_FIT_FARTHEST_GRADIENT)));
    for (int i = 0; i < 4; i++) {
        const mask is_usable = below(absolute(by_quaternion[i]), all(FXS_FIT_FARTHEST_GRADIENT));
        gradient[FXS_FIT_ROTATION + i] += keep(is_usable, by_quaternion[i]);
    }
}

#endif
