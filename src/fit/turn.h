/* Rotations of Gaussians, as quaternions w, x, y, z. In planes of `stride` floats each, a quaternion has its numbers
 * `stride` floats apart. */
#ifndef FXS_FIT_TURN_H
#define FXS_FIT_TURN_H

#include "src/fit/stages/fit_lanes.h"

typedef struct turn {
    float w, x, y, z;
} turn;

static inline turn product(turn a, turn b)
{
    return (turn){a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
                  a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

static inline turn inverse(turn a)
{
    return (turn){a.w, -a.x, -a.y, -a.z};
}

static inline turn unit(turn a)
{
    const float square = a.w * a.w + a.x * a.x + a.y * a.y + a.z * a.z;
    const float scale = square > 1e-30f ? 1 / sqrtf(square) : 0;
    return scale > 0 ? (turn){a.w * scale, a.x * scale, a.y * scale, a.z * scale} : (turn){1, 0, 0, 0};
}

static inline void rotate(turn q, const float v[3], float out[3])
{
    const turn r = product(product(q, (turn){0, v[0], v[1], v[2]}), inverse(q));
    out[0] = r.x;
    out[1] = r.y;
    out[2] = r.z;
}

static inline turn turn_at(const float *planes, size_t stride, size_t i)
{
    return (turn){planes[i], planes[stride + i], planes[2 * stride + i], planes[3 * stride + i]};
}

static inline void put_turn(float *planes, size_t stride, size_t i, turn q)
{
    planes[i] = q.w;
    planes[stride + i] = q.x;
    planes[2 * stride + i] = q.y;
    planes[3 * stride + i] = q.z;
}

#endif
