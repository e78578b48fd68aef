/* Finds the core of a scene, the region of its small Gaussians, and free places in the core's lower half. The
   surroundings of a place are divided by direction into bins. The place's rating is (covered bins)^2 * harmonic mean
   distance. */
#include "within.h"

#include <math.h>

#include <fixsplat/internal/allocator.h>

enum { FACE = 6, BINS = 6 * FACE * FACE };
enum { GRID = 7, PLACES = GRID * GRID * GRID };
enum { CORE_POINTS = 8192, POINTS = 2048 };

#define TALL 1.8                     /* least height / width of a standing subject */
#define FLAT 0.25                    /* least width / depth of a standing subject */

double fxs_distance(const double a[3], const double b[3])
{
    double square = 0;
    for (int k = 0; k < 3; k++)
        square += (a[k] - b[k]) * (a[k] - b[k]);
    return sqrt(square);
}

static uint32_t stride_of(const fxs_sample *s, uint32_t most)
{
    return (s->point_count + most - 1) / most;
}

enum measure { PLACE_X, PLACE_Y, PLACE_Z, DISTANCE };

static uint32_t measure(const fxs_sample *s, double size, enum measure what, const double middle[3], double *values)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < s->point_count; i += stride_of(s, CORE_POINTS)) {
        const fxs_sample_point *p = &s->points[i];
        if (p->size <= size)
            values[n++] = what == DISTANCE ? fxs_distance(p->place, middle) : p->place[what];
    }
    fxs_sort_values(values, n);
    return n;
}

int fxs_core_find(fxs_core *core, const fxs_sample *s, fxs_message *message)
{
    double *v = fxs_allocate(NULL, CORE_POINTS, sizeof *v);
    uint32_t n = 0;
    if (!v)
        return fxs_fail_memory(message, NULL, CORE_POINTS * sizeof *v);
    for (uint32_t i = 0; i < s->point_count; i += stride_of(s, CORE_POINTS))
        v[n++] = s->points[i].size;
    fxs_sort_values(v, n);
    const double small = v[n / 2];
    for (int k = 0; k < 3; k++) {
        n = measure(s, small, (enum measure)(PLACE_X + k), NULL, v);
        core->middle[k] = v[n / 2];
        core->low[k] = v[n / 50];
        core->high[k] = v[n - 1 - n / 50];
    }
    n = measure(s, small, DISTANCE, core->middle, v);
    core->reach = v[n / 2];
    fxs_release(NULL, v);
    return 0;
}

static double side_of(const fxs_core *core, int k)
{
    return core->high[k] - core->low[k];
}

double fxs_core_height(const fxs_core *core, int axis)
{
    return side_of(core, axis) / fmax(side_of(core, 0), side_of(core, 3 - axis));
}

int fxs_core_stands(const fxs_core *core)
{
    for (int high = 1; high < 3; high++) {
        const double a = side_of(core, 0), b = side_of(core, 3 - high);
        if (fxs_core_height(core, high) > TALL && fmin(a, b) > FLAT * fmax(a, b))
            return high;
    }
    return 0;
}

static int bin_of(const double d[3])
{
    const double x = fabs(d[0]), y = fabs(d[1]), z = fabs(d[2]);
    const int axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    const double u = d[(axis + 1) % 3] / fabs(d[axis]), v = d[(axis + 2) % 3] / fabs(d[axis]);
    const int i = (int)fmin((u + 1) * (FACE / 2.0), FACE - 1), j = (int)fmin((v + 1) * (FACE / 2.0), FACE - 1);
    return ((axis * 2 + (d[axis] > 0)) * FACE + i) * FACE + j;
}

/* Rates a place inside the scene. A direction is covered if Gaussians span half of its solid angle. */
static void look_about(fxs_within *w, const fxs_sample *s)
{
    const double pi = 3.141592653589793, most = 4 * pi / BINS;
    const uint32_t stride = stride_of(s, POINTS);
    double taken[BINS] = {0}, near[BINS] = {0}, nearness = 0;
    int covered = 0;
    for (uint32_t i = 0; i < s->point_count; i += stride) {
        const fxs_sample_point *p = &s->points[i];
        const double d[3] = {p->place[0] - w->place[0], p->place[1] - w->place[1], p->place[2] - w->place[2]};
        const double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        if (!(square > 0))
            continue;
        const double angle = fmin(pi * p->size * p->size * p->opacity * s->step * stride / square, most);
        const int bin = bin_of(d);
        taken[bin] += angle;
        near[bin] += angle / sqrt(square);
    }
    for (int i = 0; i < BINS; i++)
        if (taken[i] > most / 2) {
            nearness += near[i] / taken[i];
            covered++;
        }
    w->clear = covered ? covered / nearness : 0;
    w->merit = (double)covered * covered * w->clear;
}

/* Returns 1 if a place is not higher than the middle of the scene's core. */
static int is_low(const double place[3], const fxs_core *core, const double up[3])
{
    double height = 0, size = 0;
    for (int k = 0; k < 3; k++) {
        height += up[k] * (place[k] - (core->low[k] + core->high[k]) / 2);
        size += fabs(up[k]) * (core->high[k] - core->low[k]);
    }
    return height < size / (2 * GRID);
}

static const fxs_within *best_of(const fxs_within *all, int tried, const fxs_within *found, int count, double reach)
{
    const fxs_within *best = NULL;
    for (const fxs_within *w = all; w < all + tried; w++) {
        int apart = 1;
        for (int i = 0; i < count; i++)
            apart &= fxs_distance(w->place, found[i].place) > fmin(found[i].clear, reach);
        if (apart && (!best || w->merit > best->merit))
            best = w;
    }
    return best;
}

int fxs_within_find(fxs_within found[FXS_WITHIN_MOST], const fxs_sample *sample, const fxs_core *core,
                    const double up[3])
{
    fxs_within all[PLACES];
    int count = 0, tried = 0;
    for (int i = 0; i < PLACES; i++) {
        const int at[3] = {i % GRID, i / GRID % GRID, i / GRID / GRID};
        fxs_within *w = &all[tried];
        for (int k = 0; k < 3; k++)
            w->place[k] = core->low[k] + (core->high[k] - core->low[k]) * (at[k] + 0.5) / GRID;
        if (!is_low(w->place, core, up))
            continue;
        look_about(w, sample);
        tried++;
    }
    for (const fxs_within *best; count < FXS_WITHIN_MOST; count++) {
        if (!(best = best_of(all, tried, found, count, core->reach)))
            break;
        found[count] = *best;
    }
    return count;
}
