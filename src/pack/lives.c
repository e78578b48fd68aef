/* Packs moving scenes. A chunk has 256 Gaussians that are seen at about the same time, so a frame reads only the chunks
 * that are alive then. The Gaussians are cut in two, by the length or the middle of their lives, as long as that
 * reduces the sum of chunks times lives. Each part is then ordered in space.
 *
 * The motion of each Gaussian is developed about the middle of its chunk's time: a polynomial of degree 3 in t is one
 * in u = (t - middle) / unit too. */
#include "lives.h"

#include <math.h>
#include <stdlib.h>

#include <fixsplat/internal/allocator.h>

#define LEAST 1024                 /* fewest Gaussians that are cut in two */
#define WORTH 0.9                  /* a cut must reduce the cost to this share */
#define OCTAVES_MOST 9.0           /* an opacity code, at most 255, is 0 below 2^-9 of it */
#define SWEEP_STEPS 16
#define TURN_MOST 32767

int fxs_motion_usable(const fxs_motion *m)
{
    int finite = fabsf(m->centre) < 1e9f;
    for (int i = 0; i < 9; i++)
        finite &= fabsf(m->drift[i / 3][i % 3]) < 1e18f;
    for (int i = 0; i < 4; i++)
        finite &= fabsf(m->turn[i]) < 1e18f;
    return finite && m->fade > 0 && m->from < m->to;
}

fxs_life fxs_life_of(const fxs_motion *m, double opacity, const fxs_time *time)
{
    const double last = time->duration, most = opacity * 510;
    double octaves = most > 1 ? fxs_log(most) * FXS_LOG2_E : 0;
    if (time->least > 0)
        octaves = fmin(octaves, -fxs_log(time->least) * FXS_LOG2_E);
    /* opacity 2^-(log2(e) (d / fade)^2) */
    const double reach = m->fade * sqrt(fmax(0.001, fmin(octaves, OCTAVES_MOST)) / FXS_LOG2_E);
    fxs_life life = {0, (float)last, (float)fmax(m->from, 0), (float)fmin(m->to, last), m->centre};
    life.from = (float)fmin(fmax(fmax(m->from, m->centre - reach), 0), last);
    life.to = (float)fmax(fmin(fmin(m->to, m->centre + reach), last), life.from);
    life.centre = m->fade < INFINITY ? m->centre : life.from;
    return life;
}

static double at(const float *position, const fxs_motion *m, int axis, double d)
{
    return *position + d * (m->drift[0][axis] + d * (m->drift[1][axis] + d * m->drift[2][axis]));
}

void fxs_motion_sweep(fxs_range position[3], const fxs_gaussian *g, const fxs_motion *m, const fxs_life *life)
{
    for (int step = 0; step <= SWEEP_STEPS; step++) {
        const double t = life->from + (life->to - life->from) * (double)step / SWEEP_STEPS;
        for (int i = 0; i < 3; i++) {
            const float x = (float)at(&g->position[i], m, i, t - m->centre);
            position[i].low = x < position[i].low ? x : position[i].low;
            position[i].high = x > position[i].high ? x : position[i].high;
        }
    }
}

/* ---- Order ------------------------------------------------------------------------------------------------------- */

typedef struct item {
    fxs_life life;
    uint32_t index;
    float key;
} item;

/* Equal keys are ordered by index, so that every sort gives the same order. */
static int by_key(const void *a, const void *b)
{
    const item *x = a, *y = b;
    return x->key != y->key ? (x->key < y->key ? -1 : 1) : x->index < y->index ? -1 : x->index > y->index;
}

static int by_window(const void *a, const void *b)
{
    const item *x = a, *y = b;
    return x->life.start != y->life.start ? (x->life.start < y->life.start ? -1 : 1)
           : x->life.end != y->life.end ? (x->life.end < y->life.end ? -1 : 1)
           : x->index < y->index ? -1 : x->index > y->index;
}

static double cost_of(const item *items, uint32_t count)
{
    float from = INFINITY, to = -INFINITY;
    for (uint32_t i = 0; i < count; i++) {
        from = items[i].life.from < from ? items[i].life.from : from;
        to = items[i].life.to > to ? items[i].life.to : to;
    }
    return count ? (double)(to - from) * count : 0;
}

static void sort_by(item *items, uint32_t count, int by_length)
{
    for (uint32_t i = 0; i < count; i++)
        items[i].key = by_length ? items[i].life.to - items[i].life.from : items[i].life.to + items[i].life.from;
    qsort(items, count, sizeof *items, by_key);
}

typedef struct ordering {
    fxs_order_entry *entries, *sorted;   /* as given; in the order of time */
    uint32_t *indices;
    item *items;
    float reach;
    const fxs_pack_options *options;
} ordering;

static int order_run(ordering *o, uint32_t first, uint32_t count)
{
    fxs_order_entry *run = o->sorted + first;
    for (uint32_t i = 0; i < count; i++) {
        run[i] = o->entries[o->items[first + i].index];
        o->indices[i] = o->items[first + i].index;
    }
    const int error = fxs_order(run, count, o->reach, o->options);
    for (uint32_t i = 0; i < count && !error; i++)
        run[i].index = o->indices[run[i].index & ~FXS_BEGINS_CHUNK] | (run[i].index & FXS_BEGINS_CHUNK);
    run->index |= FXS_BEGINS_CHUNK;
    return error;
}

/* Cuts a run in the middle, in whole chunks, if that reduces the cost, else orders it in space. */
static int cut_run(ordering *o, uint32_t first, uint32_t count)
{
    const uint32_t half = (count / 2 + FXS_CHUNK - 1) / FXS_CHUNK * FXS_CHUNK;
    const double whole = cost_of(o->items + first, count);
    double costs[2] = {whole, whole};
    if (count < LEAST || whole <= 0)
        return order_run(o, first, count);
    for (int by_length = 0; by_length < 2; by_length++) {
        sort_by(o->items + first, count, by_length);
        costs[by_length] = cost_of(o->items + first, half) + cost_of(o->items + first + half, count - half);
    }
    if (fmin(costs[0], costs[1]) > WORTH * whole)
        return order_run(o, first, count);
    if (costs[0] <= costs[1])
        sort_by(o->items + first, count, 0);
    const int error = cut_run(o, first, half);
    return error ? error : cut_run(o, first + half, count - half);
}

static uint32_t count_windows(item *items, uint32_t count)
{
    uint32_t windows = 0;
    qsort(items, count, sizeof *items, by_window);
    for (uint32_t i = 0; i < count; i++)
        windows += i == 0 || items[i].life.start != items[i - 1].life.start ||
                   items[i].life.end != items[i - 1].life.end;
    return windows;
}

/* Gaussians of a chunk exist in one window of time. Rounds the windows to a grid, outwards, until there are few enough
   for their chunks to be half full on average. Windows of frames are exact, though, unless their chunks would be almost
   empty. */
static void share_windows(item *items, uint32_t count, const fxs_time *time)
{
    const double frames = time->rate * time->duration;
    const uint32_t most = 1 + count / (frames > 0 ? FXS_CHUNK / 32 : FXS_CHUNK / 2);
    uint32_t windows = count_windows(items, count);
    for (double steps = frames > 1 ? frames : 1024; windows > most && steps >= 1; steps /= 2) {
        for (uint32_t i = 0; i < count; i++) {
            fxs_life *life = &items[i].life;
            life->start = (float)(floor(life->start / time->duration * steps + 0.001) * time->duration / steps);
            life->end = (float)(ceil(life->end / time->duration * steps - 0.001) * time->duration / steps);
        }
        windows = count_windows(items, count);
    }
}

int fxs_order_in_time(fxs_order_entry *entries, const fxs_life *lives, uint32_t count, const fxs_time *time,
                      float reach, const fxs_pack_options *options)
{
    const fxs_allocator *allocator = options->allocator;
    ordering o = {entries, fxs_allocate(allocator, count, sizeof *entries), fxs_allocate(allocator, count, 4),
                  fxs_allocate(allocator, count, sizeof(item)), reach, options};
    uint32_t kept = 0, dropped = count;
    int error = o.sorted && o.indices && o.items ? 0 : FXS_ERR_MEMORY;
    for (uint32_t i = 0; i < count && !error; i++)
        if (!isnan(entries[i].position[0]))
            o.items[kept++] = (item){lives[i], i, 0};
    if (!error)
        share_windows(o.items, kept, time);
    for (uint32_t first = 0, end; first < kept && !error; first = end) {
        for (end = first + 1; end < kept && o.items[end].life.start == o.items[first].life.start &&
                              o.items[end].life.end == o.items[first].life.end;)
            end++;
        error = cut_run(&o, first, end - first);
    }
    for (uint32_t i = count; i-- > 0 && !error;)
        if (isnan(entries[i].position[0])) {
            o.sorted[--dropped] = entries[i];
            o.sorted[dropped].index = i;
        }
    if (!error)
        memcpy(entries, o.sorted, count * sizeof *entries);
    fxs_release(allocator, o.sorted);
    fxs_release(allocator, o.indices);
    fxs_release(allocator, o.items);
    return error;
}

/* ---- Codes ------------------------------------------------------------------------------------------------------- */

static int32_t ticks(double seconds)
{
    return (int32_t)floor(ldexp(seconds, 16));
}

void fxs_chunk_time_set(fxs_chunk_time *time, fxs_chunk_motion *motion, const fxs_life *all, double centre_low,
                        double centre_high, const fxs_time *scene)
{
    const double middle = ldexp(ticks(((double)all->from + all->to) / 2), -16);
    /* the code of a centre has a range of 4 units */
    double reach = fmax(all->to - middle, middle - all->from);
    reach = fmax(reach, fmin(fmax(centre_high - middle, middle - centre_low) / 3.99, ldexp(1, 14)));
    int unit = 0;
    while (unit < 30 && ldexp(1, unit - 16) < reach)
        unit++;
    *time = (fxs_chunk_time){middle, ldexp(1, unit - 16), {0, 0, 0}};
    *motion = (fxs_chunk_motion){ticks(fmax(all->from, all->start)), ticks(all->to) + 1, ticks(middle), (uint8_t)unit,
                                 0, 0};
    if (all->end < scene->duration && motion->to_q16 > ticks(all->end))
        motion->to_q16 = ticks(all->end);
}

void fxs_motion_develop(double out[3], double *rest, const fxs_gaussian *g, const fxs_motion *m, int axis,
                        const fxs_chunk_time *time)
{
    const double d = time->middle - m->centre, u = time->unit;
    const double a = m->drift[0][axis], b = m->drift[1][axis], c = m->drift[2][axis];
    *rest = at(&g->position[axis], m, axis, d);
    out[0] = u * (a + d * (2 * b + 3 * c * d));
    out[1] = u * u * (b + 3 * c * d);
    out[2] = u * u * u * c;
}

static void rotation_at(double out[4], const fxs_gaussian *g, const fxs_motion *m, double t)
{
    for (int i = 0; i < 4; i++)
        out[i] = g->rotation[i] + m->turn[i] * (t - m->centre);
}

void fxs_motion_rest(fxs_gaussian *g, const fxs_motion *m, const fxs_chunk_time *time)
{
    double coefficients[3], rest, rotation[4];
    rotation_at(rotation, g, m, time->middle);
    const fxs_gaussian given = *g;
    for (int i = 0; i < 3; i++) {
        fxs_motion_develop(coefficients, &rest, &given, m, i, time);
        g->position[i] = (float)rest;
    }
    for (int i = 0; i < 4; i++)
        g->rotation[i] = (float)rotation[i];
    if (rotation[0] == 0 && rotation[1] == 0 && rotation[2] == 0 && rotation[3] == 0)
        g->rotation[0] = 1;
}

void fxs_motion_take(fxs_chunk_time *time, const fxs_gaussian *g, const fxs_motion *m)
{
    for (int i = 0; i < 3; i++) {
        double coefficients[3], rest;
        fxs_motion_develop(coefficients, &rest, g, m, i, time);
        for (int k = 0; k < 3; k++)
            time->drift[i] = fmaxf(time->drift[i], (float)fabs(coefficients[k]));
    }
}

/* Position codes per scene unit. */
static double codes_per_unit(const fxs_chunk *chunk, int axis)
{
    return chunk->step_q32[axis] ? ldexp(1.0 / chunk->step_q32[axis], 32 - (int)chunk->step_shift) : 0;
}

void fxs_chunk_shift_set(fxs_chunk_motion *motion, const fxs_chunk_time *time, const fxs_chunk *chunk)
{
    double most = 0;
    for (int i = 0; i < 3; i++)
        most = fmax(most, time->drift[i] * codes_per_unit(chunk, i));
    motion->shift = -15;
    while (motion->shift < 4 && ldexp(most, -motion->shift) > 32767)
        motion->shift++;
}

static int put_limited(unsigned char **to, double x, double low, double high)
{
    const double held = x > low ? x < high ? x : high : low;
    const int32_t code = (int32_t)floor(held + 0.5);
    *(*to)++ = (unsigned char)code;
    *(*to)++ = (unsigned char)(code >> 8);
    return !(x >= low && x <= high);
}

/* turn (rotation)^-1 */
void fxs_motion_turn(double out[4], const fxs_gaussian *g, const fxs_motion *m, const fxs_chunk_time *time)
{
    double q[4];
    rotation_at(q, g, m, time->middle);
    const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    const double f = square > 0 ? time->unit / square : 0;
    const float *w = m->turn;
    out[0] = f * (w[0] * q[0] + w[1] * q[1] + w[2] * q[2] + w[3] * q[3]);
    out[1] = f * (-w[0] * q[1] + w[1] * q[0] - w[2] * q[3] + w[3] * q[2]);
    out[2] = f * (-w[0] * q[2] + w[2] * q[0] - w[3] * q[1] + w[1] * q[3]);
    out[3] = f * (-w[0] * q[3] + w[3] * q[0] - w[1] * q[2] + w[2] * q[1]);
}

int fxs_motion_encode(unsigned char *to, const fxs_time *scene, const fxs_chunk_time *time,
                      const fxs_chunk_motion *chunk_motion, const fxs_chunk *chunk, const fxs_gaussian *g,
                      const fxs_motion *m)
{
    double drift[3][3], rest, turn[4];
    int limited = 0;
    for (int i = 0; i < 3; i++)
        fxs_motion_develop(drift[i], &rest, g, m, i, time);
    for (int k = 0; k < scene->degree; k++)
        for (int i = 0; i < 3; i++)
            limited |= put_limited(&to, ldexp(drift[i][k] * codes_per_unit(chunk, i), -chunk_motion->shift), -32767,
                                   32767);
    fxs_motion_turn(turn, g, m, time);
    for (int i = 0; i < 4 && scene->turns; i++)
        limited |= put_limited(&to, turn[i] * 16384, -TURN_MOST, TURN_MOST);
    if (!scene->fades)
        return limited;
    const double width = m->fade / (time->unit * sqrt(FXS_LOG2_E));
    limited |= m->fade < INFINITY && put_limited(&to, (m->centre - time->middle) / time->unit * 8192, -32768, 32767);
    if (m->fade == INFINITY)
        put_limited(&to, 0, 0, 0);
    put_limited(&to, m->fade < INFINITY ? (fxs_log(width) * FXS_LOG2_E + 8) * 4096 : 65535, 0, 65535);
    return limited;
}

static int by_time(const void *a, const void *b)
{
    const int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return x < y ? -1 : x > y;
}

uint32_t fxs_motion_most(const fxs_chunk_motion *motions, uint32_t count, int32_t *times)
{
    int32_t *starts = times, *ends = times + count;
    uint32_t most = 1, ended = 0;
    for (uint32_t i = 0; i < count; i++) {
        starts[i] = motions[i].from_q16;
        ends[i] = motions[i].to_q16;
    }
    qsort(starts, count, sizeof *starts, by_time);
    qsort(ends, count, sizeof *ends, by_time);
    for (uint32_t i = 0; i < count; i++) {
        while (ends[ended] <= starts[i] && ended < count - 1)
            ended++;
        most = i + 1 - ended > most ? i + 1 - ended : most;
    }
    return most;
}
