/* Moves one faint Gaussian to the place of another. Compiled for the CPU and for CUDA. */
#ifndef FXS_FIT_RELOCATE_ONE_H
#define FXS_FIT_RELOCATE_ONE_H

#include "planes.h"
#include "src/base/random.h"

enum { SHARING = 51 };             /* largest number of Gaussians that share one place; larger counts are clamped */
#define DEAD UINT32_MAX            /* marks a faint Gaussian, in place of the number of times that it is drawn */

/* Returns a Gaussian's weight in random draws: its opacity in Q24, or 0 for opacities up to least_opacity. */
static inline uint64_t chance_of(const fxs_fit_model *m, float least_opacity, size_t i)
{
    const float opacity = opacity_at(m, i);
    return opacity > least_opacity ? (uint64_t)(opacity * 16777216.0f) : 0;
}

static inline uint32_t find(const uint64_t *sums, size_t count, uint64_t at)
{
    size_t first = 0, end = count - 1;
    while (first < end) {
        const size_t middle = first + (end - first) / 2;
        if (sums[middle] > at)
            end = middle;
        else
            first = middle + 1;
    }
    return (uint32_t)first;
}

/* Returns the Gaussian of the random draw k, from prefix sums of the Gaussians' weights. Streams 0 and 1 use different
   random numbers. */
static inline uint32_t drawn(const fxs_fit_relocate *r, uint64_t stream, uint64_t k, const uint64_t *sums, size_t count)
{
    return find(sums, count, fxs_random(r->seed, r->step, 2 * k + stream) % sums[count - 1]);
}

static inline int is_dead(const fxs_fit_model *m, const fxs_fit_relocate *r, size_t i)
{
    return !(opacity_at(m, i) > r->opacity);
}

/* Returns x^(1 / n) for 0 < x <= 1, by Newton's method from above. */
static inline double root_of(double x, int n)
{
    double y = 1;
    for (int turn = 0; turn < 40; turn++) {
        double power = 1;
        for (int i = 1; i < n; i++)
            power *= y;
        y -= (y - x / power) / n;
    }
    return y;
}

/* Divides a Gaussian of opacity o and scale s into N = times + 1 equal Gaussians at one place (Kheradmand et al. 2024).
   The opacity becomes o' = 1 - (1 - o)^(1 / N), so that together they are as opaque as before. The scale becomes s o /
   sum of C(N, k) (-1)^(k - 1) o'^k / sqrt(k), k from 1 to N. */
static inline void share(fxs_fit_model *m, size_t i, uint32_t times)
{
    const int n = times + 1 < SHARING ? (int)times + 1 : SHARING;
    const double opacity = (double)opacity_at(m, i), rest = 1 - opacity;
    double each = 1 - root_of(rest > 0x1p-24 ? rest : 0x1p-24, n), term = -1, sum = 0;
    for (int k = 1; k <= n; k++) {
        term *= -each * (n + 1 - k) / k;
        sum += term / sqrt((double)k);
    }
    each = each < 0.005 ? 0.005 : each;
    plane(m, FXS_FIT_OPACITY)[i] = logit_of((float)each);
    for (int k = 0; k < 3; k++)
        plane(m, FXS_FIT_SCALE + k)[i] += ln((float)(opacity / sum));
}

static inline void forget(fxs_fit_model *m, size_t i)
{
    if (m->origins) {
        m->origins[i].kind = FXS_FIT_CLONE;
        return;
    }
    for (size_t k = 0; k < FXS_FIT_PARAMETERS; k++)
        m->means[k * m->stride + i] = m->squares[k * m->stride + i] = 0;
}

#endif
