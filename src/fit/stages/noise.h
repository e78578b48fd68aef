/* Random displacements of Gaussians (Kheradmand et al. 2024). Random numbers are hashes of a 32-bit counter, so that
 * vector lanes can compute them. */
#ifndef FXS_FIT_NOISE_H
#define FXS_FIT_NOISE_H

#include "distant.h"
#include "fit_gaussian.h"

#if LANES == 1
typedef uint32_t bits;
#else
typedef uint32_t bits __attribute__((vector_size(4 * LANES)));
#endif

/* Hashes 32 bits (final mix of MurmurHash3). */
static inline bits mix_32(bits x)
{
    x = (x ^ x >> 16) * 0x85ebca6bu;
    x = (x ^ x >> 13) * 0xc2b2ae35u;
    return x ^ x >> 16;
}

/* Returns approximately normal random numbers with deviation 1: the sum of twelve uniform 16-bit numbers, minus 6. */
static inline real normal(const fxs_fit_noise *noise, bits index, uint32_t axis)
{
    bits sum = index & 0u;
    for (uint32_t i = 0; i < 6; i++) {
        const bits random = mix_32(mix_32(index ^ noise->key[0]) + (noise->key[1] + 0x9e3779b9u * (6 * axis + i)));
        sum += (random & 0xffffu) + (random >> 16);
    }
    return (whole_to_real((whole)sum) - 393216.0f) * 0x1p-16f;
}

static inline void add_noise(const fxs_fit_noise *noise, float *at, size_t stride, uint32_t index)
{
    real q[4], r[3][3], along[3];
    for (int i = 0; i < 4; i++)
        q[i] = load(at + (FXS_FIT_ROTATION + i) * (ptrdiff_t)stride);
    const real length = 1.0f / root((q[0] * q[0] + q[1] * q[1]) + (q[2] * q[2] + q[3] * q[3]));
    for (int i = 0; i < 4; i++)
        q[i] *= length;
    rotation_of(q, r);
    const real opacity = 1.0f / (1.0f + exp_of_minus(load(at + FXS_FIT_OPACITY * (ptrdiff_t)stride)));
    const real amount = noise->amount / unit_at(&noise->far, at, stride) /
                        (1.0f + exp_e(least(100.0f * (opacity - 0.005f), all(80))));
    const bits numbers = (bits)real_to_whole(numbers_from(0)) + index;
    const real xi[3] = {normal(noise, numbers, 0), normal(noise, numbers, 1), normal(noise, numbers, 2)};
    /* Displacement by the covariance: R S^2 R^t xi, with rotation R, scales S and random vector xi. */
    for (int j = 0; j < 3; j++) {
        const real scale = exp_e(load(at + (FXS_FIT_SCALE + j) * (ptrdiff_t)stride));
        along[j] = scale * scale * ((r[0][j] * xi[0] + r[1][j] * xi[1]) + r[2][j] * xi[2]);
    }
    for (int i = 0; i < 3; i++) {
        float *to = at + (FXS_FIT_POSITION + i) * (ptrdiff_t)stride;
        const real old = load(to), next = old + amount * dot3(r[i], along);
        store(to, choose(below(absolute(next), all(FXS_FIT_FARTHEST_PLACE)), next, old));
    }
}

#endif
