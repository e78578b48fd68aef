/* Gaussians that are moved and added without a change of the picture: Kheradmand et al. 2024, "3D Gaussian Splatting as
 * Markov Chain Monte Carlo". */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "planes.h"
#include "random.h"

enum { SHARING = 51 };             /* Gaussians that share a place, as far as it is computed */
#define DEAD UINT32_MAX            /* instead of how often one was drawn */

/* What draws need: sums of opacities (up to 2^24 each) up to and with each Gaussian, and how often each was drawn. */
typedef struct draws {
    uint64_t *sums;
    uint32_t *times, *sources;     /* of each draw, what was drawn */
    size_t count;
} draws;

/* Opacities up to `least` have no chance. */
static void sum_opacities(const fxs_fit_model *m, float least_opacity, draws *d)
{
    uint64_t sum = 0;
    for (size_t i = 0; i < m->count; i++) {
        const float opacity = opacity_at(m, i);
        sum += opacity > least_opacity ? (uint64_t)(opacity * 16777216.0f) : 0;
        d->sums[i] = sum;
    }
}

/* The first Gaussian whose sum is above `at`. */
static uint32_t find(const draws *d, size_t count, uint64_t at)
{
    size_t first = 0, end = count - 1;
    while (first < end) {
        const size_t middle = first + (end - first) / 2;
        if (d->sums[middle] > at)
            end = middle;
        else
            first = middle + 1;
    }
    return (uint32_t)first;
}

/* `stream`: 0 and 1 have numbers of their own. */
static void draw(const fxs_fit_model *m, const fxs_fit_relocate *r, uint64_t stream, draws *d)
{
    memset(d->times, 0, m->count * sizeof *d->times);
    for (size_t k = 0; k < d->count; k++) {
        const uint64_t random = fxs_fit_random(r->seed, r->step, 2 * (uint64_t)k + stream);
        d->sources[k] = find(d, m->count, random % d->sums[m->count - 1]);
        d->times[d->sources[k]]++;
    }
}

/* x^(1 / n), x up to 1, above 0: Newton's method from above */
static double root_of(double x, int n)
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

/* Of N at one place, together as opaque as one was: o' = 1 - (1 - o)^(1 / N). And of about its picture: s' = s o / sum of
   C(N, k) (-1)^(k - 1) o'^k / sqrt(k), k from 1 to N (the double sum over i and k of the paper, by columns). */
static void share(fxs_fit_model *m, size_t i, uint32_t times)
{
    const int n = times + 1 < SHARING ? (int)times + 1 : SHARING;
    const double opacity = (double)opacity_at(m, i), rest = 1 - opacity;
    double each = 1 - root_of(rest > 0x1p-24 ? rest : 0x1p-24, n), term = -1, sum = 0;
    for (int k = 1; k <= n; k++) {
        term *= -each * (n + 1 - k) / k;
        sum += term / sqrt(k);
    }
    each = each < 0.005 ? 0.005 : each;
    plane(m, FXS_FIT_OPACITY)[i] = logit_of((float)each);
    for (int k = 0; k < 3; k++)
        plane(m, FXS_FIT_SCALE + k)[i] += ln((float)(opacity / sum));
}

static void forget(fxs_fit_model *m, size_t i)
{
    for (size_t k = 0; k < FXS_FIT_PARAMETERS; k++)
        m->means[k * m->stride + i] = m->squares[k * m->stride + i] = 0;
}

static void share_all(fxs_fit_model *m, const draws *d, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (d->times[i] && d->times[i] != DEAD) {
            share(m, i, d->times[i]);
            forget(m, i);
        }
}

static void move_dead(fxs_fit_model *m, const fxs_fit_relocate *r, draws *d)
{
    d->count = 0;
    sum_opacities(m, r->opacity, d);
    for (size_t i = 0; i < m->count; i++)
        d->count += !(opacity_at(m, i) > r->opacity);
    if (!d->count || !d->sums[m->count - 1])
        return;
    draw(m, r, 0, d);
    for (size_t i = 0; i < m->count; i++)
        if (!(opacity_at(m, i) > r->opacity))
            d->times[i] = DEAD;
    share_all(m, d, m->count);
    for (size_t i = 0, dead = 0; i < m->count; i++)
        if (d->times[i] == DEAD) {
            for (int k = 0; k < FXS_FIT_PARAMETERS; k++)
                plane(m, k)[i] = plane(m, k)[d->sources[dead]];
            forget(m, i);
            dead++;
        }
}

static void set_added(fxs_fit_model *m, const draws *d, size_t count)
{
    share_all(m, d, count);
    for (size_t i = 0; i < d->count; i++)
        for (int k = FXS_FIT_SCALE; k <= FXS_FIT_OPACITY; k++)
            plane(m, k)[count + i] = plane(m, k)[d->sources[i]];
}

static int add(fxs_fit_model *m, const fxs_fit_relocate *r, draws *d)
{
    const size_t count = m->count, more = count + count / 20, next = more < r->most ? more : r->most;
    if (next <= count)
        return 0;
    d->count = next - count;
    sum_opacities(m, 0, d);
    if (!d->sums[count - 1])
        return 0;
    fxs_fit_origin *origins = malloc(next * sizeof *origins);
    if (!origins)
        return FXS_ERR_MEMORY;
    draw(m, r, 1, d);
    for (size_t i = 0; i < next; i++)
        origins[i] = i < count ? (fxs_fit_origin){(uint32_t)i, FXS_FIT_KEPT}
                               : (fxs_fit_origin){d->sources[i - count], FXS_FIT_CLONE};
    const int error = fxs_fit_model_rebuild(m, origins, next);
    if (!error)
        set_added(m, d, count);
    free(origins);
    return error;
}

int fxs_fit_model_relocate(fxs_fit_model *m, const fxs_fit_relocate *r)
{
    draws d = {malloc(m->count * sizeof *d.sums), malloc(m->count * sizeof *d.times),
               malloc(m->count * sizeof *d.sources), 0};
    int error = d.sums && d.times && d.sources ? 0 : FXS_ERR_MEMORY;
    if (!error) {
        move_dead(m, r, &d);
        error = add(m, r, &d);
    }
    free(d.sums);
    free(d.times);
    free(d.sources);
    return error;
}
