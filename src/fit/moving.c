/* Fits the moments of a moving scene, each from the last one's Gaussians.
 *
 * Gaussians that moved before go on as they did. A Gaussian is tried if it moved before, or if most photographs that
 * show it differ at its pixels more than those that it was fitted to. Tried neighbours form things. The steps move each
 * thing as one stiff part, then smaller parts, then each Gaussian by itself, drawn towards where its neighbours' motion
 * since the first moment would carry it. Colour, opacity and scale change little. Tried Gaussians for which the old
 * place is as good get their old numbers back. Spare Gaussians fill holes, where something shows that was hidden
 * before. */
#include "moving.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/message.h>
#include "src/base/os_calls.h"
#include "src/base/run.h"
#include "src/base/try_internal.h"
#include "src/fit/stages/planes.h"
#include "moving_internal.h"
#include "src/gaussian/nearest.h"
#include "turn.h"

enum {
    DOUBTFUL = 1, MAY_STAY,        /* whether it may be better at its old place */
    POSE = FXS_FIT_MOVED,          /* number of planes of a pose: position and rotation */
    KEPT = 14,                     /* number of planes that steps change */
    NEAR = FXS_NEAR,
    THING_LEAST = 16,              /* smaller things do not move as one */
    CARRY_PASSES = 4,              /* rounds in which Gaussians among tried ones are tried too */
    FIRST_STEPS = 2,               /* the first move takes this many times the steps, as nothing is known of it */
    SPARE = 4,                     /* a spare Gaussian is made for as many Gaussians */
    SIDE_LEAST = 50,               /* photographs are not reduced to a shorter side below this, pixels */
    DRAW_EVERY = 2                 /* steps between two draws of Gaussians towards their neighbours */
};

/* The stages of a moment. In each but the last, stiff parts of up to `size` Gaussians move as one; in the last, each
   Gaussian moves by itself. share: the stage's share of the steps. Before stage SECOND, Gaussians are added. */
static const struct {
    size_t size;
    float share;
} stages[] = {{SIZE_MAX, 0.25f}, {SIZE_MAX, 0.15f}, {256, 0.2f}, {48, 0.2f}, {1, 0.2f}};
enum { STAGES = sizeof stages / sizeof *stages, SECOND = 2 };

#define ERROR_LEAST 1e-3f          /* mean squared difference of a pixel, summed over three channels from 0 to 1: below,
                                      a Gaussian is never tried */
#define UNKNOWN 1e6f               /* of a Gaussian that was not measured yet */
#define ERROR_GROWTH 2.0f          /* a Gaussian is tried if its mean squared difference grows by this factor */
#define SEEN_LEAST 0.1f            /* sum of blending weights in a picture, below which the picture does not count */
#define ASKED_LEAST 0.6f           /* a Gaussian is tried if this share of the pictures that show it ask for it */
#define SHOWN_LEAST 3.0f           /* and if as many pictures show it */
#define MOVE_MOST 1.0f             /* a Gaussian may stay if it moved by less pixels in the picture that shows it
                                      largest */
#define POSITION_RATE 1.5e-3f      /* first learning rate of positions, relative to the extent */
#define ROTATION_RATE 0.004f       /* first learning rate of rotations; the next ones do not fall */
#define SCALE_RATE 0.0005f         /* slow: the packed scene keeps what hardly changes once */
#define OPACITY_RATE 0.005f
#define COLOUR_RATE 0.001f
#define RATE_FALL 5.7037825f       /* rates fall by this power of e, to 1/300 */
#define DRAW 0.5f                  /* share of the way to where the neighbours carry a Gaussian */
#define SPARE_LOGIT -10.0f         /* logit of the opacity of a spare Gaussian */
#define FILL_SHARE 0.15f           /* steps that fit the Gaussians in holes, relative to those of a moment */

void fxs_fit_moving_free(struct fxs_fit_moving *m)
{
    if (!m)
        return;
    float *const planes[] = {m->before, m->last, m->rest, m->fitted, m->errors, m->weights, m->some_errors,
                             m->some_weights, m->asking, m->showing, m->moved_errors};
    for (size_t i = 0; i < sizeof planes / sizeof *planes; i++)
        fxs_aligned_free(planes[i]);
    free(m->order);
    free(m->near);
    free(m->place);
    free(m->thing);
    free(m->tried);
    free(m->moves);
    free(m->doubtful);
    free(m->carried);
    fxs_fit_tracks_free(&m->tracks);
    free(m);
}

void fxs_fit_set_moving(fxs_fit *f)
{
    f->is_moving = 1;
}

static int make_room(fxs_fit *f, fxs_message *message)
{
    const size_t stride = f->model.stride, bytes = stride * sizeof(float);
    struct fxs_fit_moving *m = f->moving = calloc(1, sizeof *m);
    if (!m)
        return fxs_fail_memory(message, "a fit", 0);
    m->count = f->model.count;
    m->stride = stride;
    m->before = fxs_aligned_allocate(KEPT * bytes);
    m->last = fxs_aligned_allocate(POSE * bytes);
    m->rest = fxs_aligned_allocate(POSE * bytes);
    m->fitted = fxs_aligned_allocate(bytes);
    m->errors = fxs_aligned_allocate(bytes);
    m->weights = fxs_aligned_allocate(bytes);
    m->some_errors = fxs_aligned_allocate(bytes);
    m->some_weights = fxs_aligned_allocate(bytes);
    m->asking = fxs_aligned_allocate(bytes);
    m->showing = fxs_aligned_allocate(bytes);
    m->order = malloc(stride * sizeof *m->order);
    m->near = malloc(stride * NEAR * sizeof *m->near);
    m->place = malloc(stride * sizeof *m->place);
    m->thing = malloc(stride * sizeof *m->thing);
    m->tried = calloc(stride, 1);
    m->moves = calloc(stride, 1);
    m->doubtful = calloc(stride, 1);
    m->carried = calloc(stride, 1);
    m->moved_errors = fxs_aligned_allocate(bytes);
    return m->before && m->last && m->rest && m->fitted && m->errors && m->weights && m->some_errors &&
                   m->some_weights && m->asking && m->showing && m->moved_errors && m->order && m->near && m->place &&
                   m->thing && m->tried && m->moves && m->doubtful && m->carried &&
                   !fxs_fit_tracks_begin(&m->tracks, stride)
               ? 0 : fxs_fail_memory(message, "a fit", stride * (40 * sizeof(float) + NEAR * sizeof(uint32_t)));
}

/* Returns the number of a plane that steps change among the planes of a model: first the pose, then scale, opacity and
   colour. */
static int kept_plane(int k)
{
    return k < POSE       ? fxs_fit_moved_plane(k)
           : k < POSE + 3 ? FXS_FIT_SCALE + k - POSE
                          : FXS_FIT_OPACITY + k - POSE - 3;
}

static void take_planes(const fxs_fit_model *model, float *to, int count)
{
    for (int k = 0; k < count; k++)
        memcpy(to + (size_t)k * model->stride, plane(model, kept_plane(k)), model->stride * sizeof *to);
}

/* Gives a Gaussian its old numbers. at: its place in the model. */
static void restore(fxs_fit *f, size_t i, size_t at)
{
    for (int k = 0; k < KEPT; k++)
        plane(&f->model, kept_plane(k))[at] = f->moving->before[(size_t)k * f->moving->stride + i];
}

/* ---- Differences ------------------------------------------------------------------------------------------------- */

/* Counts for each Gaussian the pictures that show it, and those in which it differs more than when it was fitted. */
static void count_asking(struct fxs_fit_moving *m)
{
    for (size_t i = 0; i < m->count; i++) {
        const float weight = m->some_weights[i];
        if (weight < SEEN_LEAST)
            continue;
        m->showing[i] += 1;
        m->asking[i] += m->some_errors[i] > weight * (ERROR_GROWTH * m->fitted[i] + ERROR_LEAST);
    }
}

/* Finds each Gaussian's mean squared difference from the photographs, in m->errors, and the sum of its weights in their
   pictures, in m->weights. */
static int measure(fxs_fit *f, fxs_message *message)
{
    struct fxs_fit_moving *m = f->moving;
    const fxs_fit_step_options options = {.sh_degree = f->options.sh_degree,
                                          .background = {(float)f->options.background[0] / 255.0f,
                                                         (float)f->options.background[1] / 255.0f,
                                                         (float)f->options.background[2] / 255.0f}};
    memset(m->errors, 0, m->stride * sizeof *m->errors);
    memset(m->weights, 0, m->stride * sizeof *m->weights);
    memset(m->asking, 0, m->stride * sizeof *m->asking);
    memset(m->showing, 0, m->stride * sizeof *m->showing);
    for (size_t v = 0; v < f->count; v++) {
        if (fxs_fit_find_errors(f->stepper, &f->model, &f->photographs[v], &options, m->some_errors, m->some_weights))
            return fxs_fail_memory(message, "a fit", 0);
        for (size_t i = 0; i < m->count; i++) {
            m->errors[i] += m->some_errors[i];
            m->weights[i] += m->some_weights[i];
        }
        count_asking(m);
    }
    for (size_t i = 0; i < m->count; i++)
        m->errors[i] = m->weights[i] > 0 ? m->errors[i] / m->weights[i] : 0;
    return 0;
}

/* ---- What is tried ----------------------------------------------------------------------------------------------- */


static int is_asked(const struct fxs_fit_moving *m, size_t i)
{
    return m->showing[i] >= SHOWN_LEAST && m->asking[i] >= ASKED_LEAST * m->showing[i];
}

/* A Gaussian is also tried if most of its neighbours are: one inside a thing, or in an even part of it. */
static int is_carried(const struct fxs_fit_moving *m, size_t i)
{
    size_t tried = 0;
    for (size_t k = 0; k < NEAR; k++)
        tried += m->tried[m->near[i * NEAR + k]] != STAYS;
    return 2 * tried > NEAR;
}

static uint32_t first_of(uint32_t *thing, uint32_t i)
{
    while (thing[i] != i)
        i = thing[i] = thing[thing[i]];
    return i;
}

static int by_thing(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Divides the tried Gaussians into things: sets that hang together by neighbours. Sorts the tried ones in
   m->order by thing. */
static int find_things(struct fxs_fit_moving *m)
{
    uint32_t *const thing = m->thing;
    uint64_t *keys = malloc((m->tried_count + 1) * sizeof *keys);
    if (!keys)
        return FXS_ERR_MEMORY;
    for (size_t i = 0; i < m->tried_count; i++) {
        thing[i] = (uint32_t)i;
        m->place[m->order[i]] = (uint32_t)i;
    }
    for (size_t i = 0; i < m->tried_count; i++)
        for (size_t k = 0; k < NEAR; k++) {
            const uint32_t self = m->order[i], other = m->near[(size_t)self * NEAR + k];
            if (m->tried[other] == STAYS)
                continue;
            const uint32_t a = first_of(thing, (uint32_t)i), b = first_of(thing, m->place[other]);
            thing[a > b ? a : b] = a < b ? a : b;
        }
    for (size_t i = 0; i < m->tried_count; i++)
        keys[i] = (uint64_t)first_of(thing, (uint32_t)i) << 32 | m->order[i];
    qsort(keys, m->tried_count, sizeof *keys, by_thing);
    for (size_t i = 0; i < m->tried_count; i++) {
        m->order[i] = (uint32_t)keys[i];
        m->place[m->order[i]] = (uint32_t)i;
        thing[i] = i && keys[i - 1] >> 32 == keys[i] >> 32 ? thing[i - 1] : (uint32_t)i;
    }
    free(keys);
    return 0;
}

/* Adds to the Gaussians to try, which become `kind`, and puts all that are tried first in m->order. */
static int add_tried(struct fxs_fit_moving *m, uint8_t kind)
{
    size_t count = 0;
    for (size_t i = 0; i < m->count; i++)
        if (m->tried[i] == STAYS && (m->moves[i] || is_asked(m, i)))
            m->tried[i] = kind;
    for (int pass = 0; pass < CARRY_PASSES; pass++)
        for (size_t i = 0; i < m->made; i++)
            if (m->tried[i] == STAYS && is_carried(m, i))
                m->tried[i] = kind;
    for (size_t i = 0; i < m->count; i++)
        if (m->tried[i])
            m->order[count++] = (uint32_t)i;
    m->tried_count = count;
    for (size_t i = 0; i < m->count; i++)
        if (!m->tried[i])
            m->order[count++] = (uint32_t)i;
    for (size_t i = m->count; i < m->stride; i++)
        m->order[i] = (uint32_t)i;
    return find_things(m);
}

/* Reorders all planes of parameters: number i of the new order is number order[i] of the old, or the reverse. Clears
   Adam's moments. */
static void reorder(fxs_fit *f, int back)
{
    struct fxs_fit_moving *m = f->moving;
    for (int k = 0; k < FXS_FIT_PARAMETERS; k++) {
        float *p = plane(&f->model, k);
        memcpy(m->some_errors, p, m->stride * sizeof *p);
        for (size_t i = 0; i < m->stride; i++)
            p[back ? m->order[i] : i] = m->some_errors[back ? i : m->order[i]];
    }
    memset(f->model.means, 0, FXS_FIT_PARAMETERS * m->stride * sizeof(float));
    memset(f->model.squares, 0, FXS_FIT_PARAMETERS * m->stride * sizeof(float));
}

/* ---- Motion ------------------------------------------------------------------------------------------------------ */

/* Returns how a Gaussian has turned since the first moment. `i`: its place in the order of the steps. */
static turn turned(const fxs_fit *f, size_t i)
{
    const struct fxs_fit_moving *m = f->moving;
    const turn now = unit(turn_at(plane(&f->model, FXS_FIT_ROTATION), m->stride, i));
    const turn then = unit(turn_at(m->rest + 3 * m->stride, m->stride, m->order[i]));
    const turn by = product(now, inverse(then));
    return by.w < 0 ? (turn){-by.w, -by.x, -by.y, -by.z} : by;
}

/* Moves the Gaussians that moved before as far again, and turns them as far. */
static void extrapolate(fxs_fit *f)
{
    const struct fxs_fit_moving *m = f->moving;
    const size_t stride = m->stride;
    for (size_t i = 0; i < m->count; i++) {
        if (!m->moves[i])
            continue;
        for (int k = 0; k < 3; k++) {
            const float now = m->before[(size_t)k * stride + i];
            plane(&f->model, FXS_FIT_POSITION + k)[i] = now + (now - m->last[(size_t)k * stride + i]);
        }
        const turn now = unit(turn_at(m->before + 3 * stride, stride, i));
        const turn then = unit(turn_at(m->last + 3 * stride, stride, i));
        put_turn(plane(&f->model, FXS_FIT_ROTATION), stride, i, unit(product(product(now, inverse(then)), now)));
    }
}

/* Finds the pose to which the motion of its neighbours would carry a Gaussian, as part of one stiff thing. Leaves out
   the neighbours of the kind `without`. Returns 0 if no neighbour is left. */
static int carry(const fxs_fit *f, size_t i, int without, float pose[POSE])
{
    const struct fxs_fit_moving *m = f->moving;
    const size_t stride = m->stride, self = m->order[i];
    turn sum = {0, 0, 0, 0};
    float count = 0;
    memset(pose, 0, POSE * sizeof *pose);
    for (size_t k = 0; k < NEAR; k++) {
        const size_t other = m->near[self * NEAR + k], at = m->place[other];
        if (m->tried[other] == without || other == self || m->tried[other] == STAYS)
            continue;
        count += 1;
        const turn by = turned(f, at);
        float away[3], carried[3];
        for (size_t c = 0; c < 3; c++)
            away[c] = m->rest[c * stride + self] - m->rest[c * stride + other];
        rotate(by, away, carried);
        for (int c = 0; c < 3; c++)
            pose[c] += plane(&f->model, FXS_FIT_POSITION + c)[at] + carried[c];
        sum = (turn){sum.w + by.w, sum.x + by.x, sum.y + by.y, sum.z + by.z};
    }
    for (int c = 0; c < 3 && count > 0; c++)
        pose[c] /= count;
    const turn then = unit(turn_at(m->rest + 3 * stride, stride, self));
    put_turn(pose + 3, 1, 0, unit(product(unit(sum), then)));
    return count > 0;
}

/* Carries the Gaussians that were added with their neighbours. */
static void carry_added(fxs_fit *f)
{
    const struct fxs_fit_moving *m = f->moving;
    float pose[POSE];
    for (size_t i = 0; i < m->tried_count; i++)
        if (m->tried[m->order[i]] == ADDED && carry(f, i, ADDED, pose))
            for (int k = 0; k < POSE; k++)
                plane(&f->model, kept_plane(k))[i] = pose[k];
}

/* Draws each tried Gaussian towards the pose to which its neighbours would carry it. */
static void draw_together(fxs_fit *f, float *poses)
{
    const struct fxs_fit_moving *m = f->moving;
    for (size_t i = 0; i < m->tried_count; i++)
        m->carried[i] = (uint8_t)carry(f, i, -1, poses + i * POSE);
    for (size_t i = 0; i < m->tried_count; i++) {
        if (!m->carried[i])
            continue;
        const turn now = unit(turn_at(plane(&f->model, FXS_FIT_ROTATION), m->stride, i));
        turn to = turn_at(poses + i * POSE + 3, 1, 0);
        const float side = now.w * to.w + now.x * to.x + now.y * to.y + now.z * to.z < 0 ? -DRAW : DRAW;
        for (int c = 0; c < 3; c++) {
            float *p = plane(&f->model, FXS_FIT_POSITION + c) + i;
            *p += DRAW * (poses[i * POSE + (size_t)c] - *p);
        }
        const float rest = 1 - DRAW;
        put_turn(plane(&f->model, FXS_FIT_ROTATION), m->stride, i,
                 unit((turn){rest * now.w + side * to.w, rest * now.x + side * to.x, rest * now.y + side * to.y,
                             rest * now.z + side * to.z}));
    }
}

/* A stiff part: tried Gaussians of one thing that are successive in m->order. Its motion since the beginning of the
   stage, and Adam's moments of it. */
typedef struct part {
    size_t first, end;
    float centre[3], radius;
    float shift[3];
    turn by;
    float means[6], squares[2];
} part;

typedef struct parts {
    part *of;
    size_t count;
    float *start;                  /* poses of the tried Gaussians at the beginning of the stage */
} parts;

static void measure_part(const struct fxs_fit_moving *m, const float *start, part *p)
{
    const size_t count = p->end - p->first;
    double sum[3] = {0, 0, 0}, square = 0;
    for (size_t i = p->first; i < p->end; i++)
        for (size_t k = 0; k < 3; k++)
            sum[k] += (double)start[k * m->stride + i];
    for (size_t k = 0; k < 3; k++)
        p->centre[k] = (float)(sum[k] / (double)count);
    for (size_t i = p->first; i < p->end; i++)
        for (size_t k = 0; k < 3; k++) {
            const double d = (double)start[k * m->stride + i] - (double)p->centre[k];
            square += d * d;
        }
    p->radius = (float)sqrt(square / (double)count);
}

/* Divides the things into parts of up to `size` Gaussians. */
static int parts_begin(const fxs_fit *f, parts *all, size_t size)
{
    const struct fxs_fit_moving *m = f->moving;
    *all = (parts){calloc(m->tried_count + 1, sizeof *all->of), 0, malloc(POSE * m->stride * sizeof *all->start)};
    if (!all->of || !all->start)
        return FXS_ERR_MEMORY;
    take_planes(&f->model, all->start, POSE);
    for (size_t first = 0, end; first < m->tried_count; first = end) {
        for (end = first + 1; end < m->tried_count && m->thing[end] == m->thing[first];)
            end++;
        const size_t count = end - first, pieces = (count - 1) / size + 1;
        for (size_t n = 0; n < pieces && count >= THING_LEAST; n++) {
            part *p = &all->of[all->count++];
            *p = (part){.first = first + n * count / pieces, .end = first + (n + 1) * count / pieces,
                        .by = {1, 0, 0, 0}};
            measure_part(m, all->start, p);
        }
    }
    return 0;
}

static void parts_end(parts *all)
{
    free(all->of);
    free(all->start);
}

/* Sums the loss's gradient by a part's shift and turn. A step with rates of 0 and no moments leaves a tenth of the
   gradients in Adam's first moments. */
static void take_gradient(const fxs_fit *f, const part *p, float gradient[6])
{
    double sum[6] = {0};
    for (size_t i = p->first; i < p->end; i++) {
        double g[3], away[3];
        for (int k = 0; k < 3; k++) {
            g[k] = (double)f->model.means[(size_t)(FXS_FIT_POSITION + k) * f->model.stride + i];
            away[k] = (double)plane(&f->model, FXS_FIT_POSITION + k)[i] - (double)p->centre[k] - (double)p->shift[k];
        }
        for (int k = 0; k < 3; k++) {
            sum[k] += g[k];
            sum[3 + k] += away[(k + 1) % 3] * g[(k + 2) % 3] - away[(k + 2) % 3] * g[(k + 1) % 3];
        }
    }
    for (int k = 0; k < 6; k++)
        gradient[k] = (float)sum[k];
}

/* Moves a part by a step of Adam, whose second moments are of the shift's and the turn's lengths. number: step of the
   stage. */
static void step_part(const fxs_fit *f, part *p, float rate, uint32_t number)
{
    float gradient[6], step[6];
    take_gradient(f, p, gradient);
    const float first = 1 / (1 - exp_e(-0.105360516f * (float)number));
    const float second = 1 / (1 - exp_e(-0.0512932944f * (float)number));
    for (int half = 0; half < 2; half++) {
        float square = 0;
        for (int k = 3 * half; k < 3 * half + 3; k++) {
            p->means[k] = 0.9f * p->means[k] + 0.1f * gradient[k];
            square += gradient[k] * gradient[k];
        }
        p->squares[half] = 0.95f * p->squares[half] + 0.05f * square;
        const float length = sqrtf(p->squares[half] * second);
        for (int k = 3 * half; k < 3 * half + 3; k++)
            step[k] = length > 0 ? rate * first * p->means[k] / length : 0;
    }
    for (int k = 0; k < 3; k++)
        p->shift[k] -= step[k];
    const float half = p->radius > 0 ? 0.5f / p->radius : 0;
    p->by = unit(product((turn){1, -step[3] * half, -step[4] * half, -step[5] * half}, p->by));
}

static void place_part(fxs_fit *f, const float *start, const part *p)
{
    const size_t stride = f->model.stride;
    for (size_t i = p->first; i < p->end; i++) {
        float away[3], carried[3];
        for (size_t k = 0; k < 3; k++)
            away[k] = start[k * stride + i] - p->centre[k];
        rotate(p->by, away, carried);
        for (int k = 0; k < 3; k++)
            plane(&f->model, FXS_FIT_POSITION + k)[i] = p->centre[k] + p->shift[k] + carried[k];
        put_turn(plane(&f->model, FXS_FIT_ROTATION), stride, i,
                 unit(product(p->by, unit(turn_at(start + 3 * stride, stride, i)))));
    }
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

static float rate_at(const fxs_fit *f, uint32_t step, uint32_t steps)
{
    return POSITION_RATE * f->extent * exp_e(-RATE_FALL * (float)step / (float)steps);
}

/* Sets the options of a step. is_stiff: the rates are 0, as parts are moved by the gradients. */
static void set_step(const fxs_fit *f, uint32_t step, uint32_t steps, int is_stiff, fxs_fit_step_options *o)
{
    memset(o, 0, sizeof *o);
    o->sh_degree = f->options.sh_degree;
    o->number = step;
    o->far = f->far;
    o->changed = (f->moving->tried_count + FXS_FIT_GROUP - 1) / FXS_FIT_GROUP * FXS_FIT_GROUP;
    for (int k = 0; k < 3; k++)
        o->background[k] = (float)f->options.background[k] / 255.0f;
    for (int k = 0; k < 3 && !is_stiff; k++)
        o->rate[FXS_FIT_POSITION + k] = rate_at(f, step, steps);
    for (int k = FXS_FIT_SCALE; k < FXS_FIT_SH && !is_stiff; k++)
        o->rate[k] = k < FXS_FIT_ROTATION  ? SCALE_RATE
                     : k < FXS_FIT_OPACITY ? ROTATION_RATE * exp_e(-RATE_FALL * (float)step / (float)steps)
                     : k < FXS_FIT_COLOUR  ? OPACITY_RATE
                                           : COLOUR_RATE;
}

/* Puts back the Gaussians beyond the tried ones that fill the last group of them. */
static void restore_fillers(fxs_fit *f)
{
    const struct fxs_fit_moving *m = f->moving;
    for (size_t i = m->tried_count; i < m->count && i % FXS_FIT_GROUP; i++)
        restore(f, m->order[i], i);
}

/* Returns by how much the photographs of a step are reduced: much at first, so that far moves are found. */
static int32_t divisor_of(const fxs_fit *f, uint32_t step, uint32_t steps)
{
    const fxs_fit_camera *c = &f->photographs[0].camera;
    const int32_t side = c->width < c->height ? c->width : c->height;
    int32_t divisor = step <= steps / 5 && !f->moving->is_under_way ? 4 : step <= steps / 2 ? 2 : 1;
    while (divisor > 1 && side / divisor < SIDE_LEAST)
        divisor /= 2;
    return divisor;
}

static void clear_moments(fxs_fit *f)
{
    memset(f->model.means, 0, FXS_FIT_PARAMETERS * f->model.stride * sizeof(float));
    memset(f->model.squares, 0, FXS_FIT_PARAMETERS * f->model.stride * sizeof(float));
}

static int make_step(fxs_fit *f, uint32_t step, uint32_t steps, const fxs_fit_step_options *options,
                     fxs_fit_followed *followed, fxs_message *message)
{
    fxs_fit_photograph batch[FXS_FIT_BATCH];
    fxs_fit_report report;
    const uint32_t last = steps < 20 ? steps : 20;
    for (uint32_t v = 0; v < f->options.batch; v++)
        fxs_fit_take_photograph(f, (uint64_t)f->step * f->options.batch + v, divisor_of(f, step, steps), &batch[v]);
    f->step++;
    FXS_TRY(f->engine->step(f->self, batch, f->options.batch, options, &report, message));
    followed->absolute += step + last > steps ? report.absolute / last : 0;
    restore_fillers(f);
    return 0;
}

/* Makes the steps first + 1 to end of a moment, with stiff parts. */
static int move_parts(fxs_fit *f, size_t size, uint32_t first, uint32_t end, uint32_t steps, fxs_fit_followed *followed,
                      fxs_message *message)
{
    fxs_fit_step_options options;
    parts all;
    int error = parts_begin(f, &all, size) ? fxs_fail_memory(message, "a fit", 0) : 0;
    for (uint32_t step = first + 1; step <= end && !error; step++) {
        clear_moments(f);
        set_step(f, step, steps, 1, &options);
        error = make_step(f, step, steps, &options, followed, message);
        for (size_t n = 0; n < all.count && !error; n++) {
            step_part(f, &all.of[n], rate_at(f, step, steps), step - first);
            place_part(f, all.start, &all.of[n]);
        }
    }
    parts_end(&all);
    return error;
}

/* Makes the steps first + 1 to end of a moment, in which each Gaussian moves by itself. */
static int move_each(fxs_fit *f, uint32_t first, uint32_t end, uint32_t steps, fxs_fit_followed *followed,
                     fxs_message *message)
{
    fxs_fit_step_options options;
    float *poses = malloc((f->moving->tried_count + 1) * POSE * sizeof *poses);
    int error = poses ? 0 : fxs_fail_memory(message, "a fit", 0);
    clear_moments(f);
    for (uint32_t step = first + 1; step <= end && !error; step++) {
        if ((step - first) % DRAW_EVERY == 1)
            draw_together(f, poses);
        set_step(f, step, steps, 0, &options);
        options.number = step - first;
        error = make_step(f, step, steps, &options, followed, message);
    }
    free(poses);
    return error;
}

/* Makes the steps of some stages of a moment. */
static int make_stages(fxs_fit *f, size_t stage, size_t stage_end, uint32_t steps, fxs_fit_followed *followed,
                       fxs_message *message)
{
    float share = 0;
    for (size_t i = 0; i < stage_end && f->moving->tried_count; i++) {
        const uint32_t first = (uint32_t)(share * (float)steps);
        share += stages[i].share;
        const uint32_t end = i + 1 == STAGES ? steps : (uint32_t)(share * (float)steps);
        if (i >= stage)
            FXS_TRY(stages[i].size > 1 ? move_parts(f, stages[i].size, first, end, steps, followed, message)
                                       : move_each(f, first, end, steps, followed, message));
    }
    return 0;
}

/* ---- What stays -------------------------------------------------------------------------------------------------- */

/* Returns the largest move of a Gaussian in pixels, in a picture that shows its centre. */
static float pixels_moved(const fxs_fit *f, size_t i)
{
    const struct fxs_fit_moving *m = f->moving;
    float square = 0, most_per_unit = 0;
    for (int k = 0; k < 3; k++) {
        const float d = plane(&f->model, FXS_FIT_POSITION + k)[i] - m->before[(size_t)k * m->stride + i];
        square += d * d;
    }
    for (size_t v = 0; v < f->count; v++) {
        const fxs_fit_camera *c = &f->photographs[v].camera;
        float depth = 0;
        for (int k = 0; k < 3; k++)
            depth += c->rotation[6 + k] * (plane(&f->model, FXS_FIT_POSITION + k)[i] - c->eye[k]);
        if (depth > c->near && c->focal[0] / depth > most_per_unit)
            most_per_unit = c->focal[0] / depth;
    }
    return sqrtf(square) * most_per_unit;
}

static void swap_pose(fxs_fit *f, float *poses, size_t i)
{
    for (int k = 0; k < POSE; k++) {
        float *p = plane(&f->model, kept_plane(k)) + i, *other = poses + (size_t)k * f->moving->stride + i;
        const float swap = *p;
        *p = *other;
        *other = swap;
    }
}

/* True if a doubtful Gaussian may stay, by the differences at its old place and, in m->moved_errors, at its new one. */
static int may_stay(const fxs_fit *f, size_t i, int is_last)
{
    const struct fxs_fit_moving *m = f->moving;
    return is_last && pixels_moved(f, i) < MOVE_MOST ? m->errors[i] <= 1.2f * m->moved_errors[i] + 1e-4f
                                                    : m->errors[i] < 0.5f * m->moved_errors[i];
}

/* True if a doubtful Gaussian may stay, and half of its neighbours do. */
static int stays(const struct fxs_fit_moving *m, size_t i)
{
    size_t staying = 0;
    for (size_t k = 0; k < NEAR; k++) {
        const size_t other = m->near[i * NEAR + k];
        staying += m->tried[other] == STAYS || m->doubtful[other] == MAY_STAY;
    }
    return m->doubtful[i] == MAY_STAY && 2 * staying >= NEAR;
}

/* Gives doubtful Gaussians their old poses, where they and their neighbours are not worse there; the others move.
   Doubtful are those that the photographs ask to move though they have moved; if is_last, also those that moved by less
   than MOVE_MOST pixels. */
static int settle(fxs_fit *f, int is_last, fxs_message *message)
{
    struct fxs_fit_moving *m = f->moving;
    FXS_TRY(measure(f, message));
    memcpy(m->moved_errors, m->errors, m->stride * sizeof *m->errors);
    for (size_t i = 0; i < m->count; i++) {
        m->doubtful[i] = m->tried[i] != STAYS && (is_asked(m, i) || (is_last && pixels_moved(f, i) < MOVE_MOST));
        if (m->doubtful[i])
            swap_pose(f, m->before, i);
    }
    FXS_TRY(measure(f, message));
    for (size_t i = 0; i < m->count; i++)
        if (m->doubtful[i]) {
            swap_pose(f, m->before, i);
            m->doubtful[i] = may_stay(f, i, is_last) ? MAY_STAY : DOUBTFUL;
        }
    for (size_t i = 0; i < m->count; i++) {
        m->moves[i] = m->tried[i] != STAYS && !stays(m, i);
        if (!m->moves[i])
            restore(f, i, i);
    }
    for (size_t i = 0; i < m->count && !is_last; i++)
        m->tried[i] = m->moves[i] ? m->tried[i] : STAYS;
    return 0;
}

static void count_moved(struct fxs_fit_moving *m, fxs_fit_followed *followed)
{
    for (size_t i = 0; i < m->count; i++) {
        followed->moved += m->moves[i];
        followed->tried += m->tried[i] != STAYS;
        if (m->moves[i] && m->moved_errors[i] < m->fitted[i])
            m->fitted[i] = m->moved_errors[i];
        m->fitted[i] = m->fitted[i] < UNKNOWN ? m->fitted[i] : m->errors[i];
    }
}

/* ---- Holes ------------------------------------------------------------------------------------------------------- */

/* Finds the earlier pose of a Gaussian that moved like another one since then. The numbers of poses are `stride` floats
   apart. */
static void put_beside(const fxs_fit_model *model, size_t i, size_t other, float *to, const float *from, size_t stride)
{
    const turn now = unit(turn_at(plane(model, FXS_FIT_ROTATION), model->stride, other));
    const turn back = product(unit(turn_at(from + 3 * stride, stride, 0)), inverse(now));
    float away[3], carried[3];
    for (int k = 0; k < 3; k++)
        away[k] = plane(model, FXS_FIT_POSITION + k)[i] - plane(model, FXS_FIT_POSITION + k)[other];
    rotate(back, away, carried);
    for (size_t k = 0; k < 3; k++)
        to[k * stride] = from[k * stride] + carried[k];
    put_turn(to + 3 * stride, stride, 0,
             unit(product(back, unit(turn_at(plane(model, FXS_FIT_ROTATION), model->stride, i)))));
}

/* Begins the track of a new Gaussian, which moved like another one before. */
static int adopt_track(fxs_fit *f, size_t i, size_t other)
{
    fxs_fit_tracks *t = &f->moving->tracks;
    if (fxs_fit_tracks_add(t, &f->model, i))
        return FXS_ERR_MEMORY;
    for (size_t moment = 0; moment < t->moments; moment++)
        put_beside(&f->model, i, other, fxs_fit_pose_of(t, moment, i), fxs_fit_pose_of(t, moment, other), 1);
    return 0;
}

/* Finds the neighbours of new Gaussians, and where each would have been in the first moment if it had moved like its
   nearest neighbour. */
static int adopt(fxs_fit *f, size_t first)
{
    struct fxs_fit_moving *m = f->moving;
    const size_t stride = m->stride;
    const float *const planes[3] = {plane(&f->model, 0), plane(&f->model, 1), plane(&f->model, 2)};
    uint32_t *near = malloc(m->made * NEAR * sizeof *near);
    if (!near || fxs_neighbours(planes, m->made, near)) {
        free(near);
        return FXS_ERR_MEMORY;
    }
    memcpy(m->near + first * NEAR, near + first * NEAR, (m->made - first) * NEAR * sizeof *near);
    free(near);
    for (size_t i = first; i < m->made; i++) {
        size_t old = i;
        for (size_t k = 0; k < NEAR && old >= first; k++)
            old = m->near[i * NEAR + k];
        for (int k = 0; k < POSE; k++)
            m->rest[(size_t)k * stride + i] = plane(&f->model, kept_plane(k))[i];
        if (old < first)
            put_beside(&f->model, i, old, m->rest + i, m->rest + old, stride);
        if (old < first && m->tracks.number[old] != FXS_FIT_STILL && adopt_track(f, i, old))
            return FXS_ERR_MEMORY;
        m->fitted[i] = UNKNOWN;
        for (size_t k = 0; k < KEPT; k++)
            m->before[k * stride + i] = plane(&f->model, kept_plane((int)k))[i];
    }
    return 0;
}

/* Fits all numbers of the Gaussians from number `first` on, and no others. */
static int fit_fresh(fxs_fit *f, size_t first, uint32_t steps, fxs_message *message)
{
    struct fxs_fit_moving *m = f->moving;
    fxs_fit_step_options options;
    fxs_fit_followed unwanted;
    size_t place = 0;
    int error = 0;
    for (size_t i = first; i < m->count; i++)
        m->order[place++] = (uint32_t)i;
    for (size_t i = 0; i < first; i++)
        m->order[place++] = (uint32_t)i;
    for (size_t i = m->count; i < m->stride; i++)
        m->order[i] = (uint32_t)i;
    m->tried_count = (m->made - first) / FXS_FIT_GROUP * FXS_FIT_GROUP;
    reorder(f, 0);
    for (uint32_t step = 1; step <= steps && !error; step++) {
        set_step(f, step, steps, 1, &options);
        for (int k = 0; k < FXS_FIT_SH; k++)
            options.rate[k] = k < FXS_FIT_SCALE      ? 1e-4f * f->extent
                              : k < FXS_FIT_ROTATION ? 0.01f
                              : k < FXS_FIT_OPACITY  ? 0.002f
                              : k < FXS_FIT_COLOUR   ? 0.05f
                                                     : 0.01f;
        error = make_step(f, steps + step, 2 * steps, &options, &unwanted, message);
    }
    reorder(f, 1);
    return error;
}

/* Puts spare Gaussians where light passes through the scene and the photographs show something. */
static int fill_holes(fxs_fit *f, uint32_t steps, fxs_fit_followed *followed, fxs_message *message)
{
    struct fxs_fit_moving *m = f->moving;
    const size_t first = m->made;
    if (fxs_fit_fill_holes(f))
        return fxs_fail_memory(message, "a fit", 0);
    while (m->made > first && (m->made - first) % FXS_FIT_GROUP)
        plane(&f->model, FXS_FIT_OPACITY)[--m->made] = SPARE_LOGIT;
    followed->added += m->made - first;
    if (m->made == first)
        return 0;
    FXS_TRY(fit_fresh(f, first, steps, message));
    return adopt(f, first) ? fxs_fail_memory(message, "a fit", 0) : 0;
}

/* Makes some stages of a moment, after adding the Gaussians that the photographs ask for. */
static int make_part(fxs_fit *f, uint8_t kind, size_t stage, size_t stage_end, uint32_t steps,
                     fxs_fit_followed *followed, fxs_message *message)
{
    FXS_TRY(measure(f, message));
    if (add_tried(f->moving, kind))
        return fxs_fail_memory(message, "a fit", 0);
    reorder(f, 0);
    if (kind == ADDED)
        carry_added(f);
    const int error = make_stages(f, stage, stage_end, steps, followed, message);
    reorder(f, 1);
    return error;
}

/* Keeps the poses of a moment, and those before of the Gaussians that move for the first time. */
static int keep_moment(fxs_fit *f)
{
    struct fxs_fit_moving *m = f->moving;
    for (size_t i = 0; i < m->count; i++) {
        if (!m->moves[i] || m->tracks.number[i] != FXS_FIT_STILL)
            continue;
        swap_pose(f, m->before, i);
        const int error = fxs_fit_tracks_add(&m->tracks, &f->model, i);
        swap_pose(f, m->before, i);
        if (error)
            return error;
    }
    return fxs_fit_tracks_keep(&m->tracks, &f->model);
}

static int move(fxs_fit *f, uint32_t steps, fxs_fit_followed *followed, fxs_message *message)
{
    struct fxs_fit_moving *m = f->moving;
    take_planes(&f->model, m->before, KEPT);
    extrapolate(f);
    memset(m->tried, STAYS, m->stride);
    steps *= m->is_under_way ? 1 : FIRST_STEPS;
    FXS_TRY(make_part(f, ASKED, 0, SECOND, steps, followed, message));
    FXS_TRY(settle(f, 0, message));
    memset(m->moves, 0, m->stride);
    FXS_TRY(fill_holes(f, (uint32_t)(FILL_SHARE * (float)steps), followed, message));
    FXS_TRY(make_part(f, ADDED, SECOND, STAGES, steps, followed, message));
    FXS_TRY(settle(f, 1, message));
    count_moved(m, followed);
    memcpy(m->last, m->before, POSE * m->stride * sizeof *m->last);
    m->is_under_way = 1;
    return keep_moment(f) ? fxs_fail_memory(message, "a fit", 0) : 0;
}

/* Appends spare Gaussians, which cannot be seen until they fill a hole. */
static int add_spare(fxs_fit *f)
{
    fxs_fit_model *m = &f->model;
    const size_t made = m->count, count = made + (made / SPARE / FXS_FIT_GROUP + 1) * FXS_FIT_GROUP;
    fxs_fit_origin *origins = malloc(count * sizeof *origins);
    if (!origins)
        return FXS_ERR_MEMORY;
    for (size_t i = 0; i < count; i++)
        origins[i] = (fxs_fit_origin){(uint32_t)(i < made ? i : i - made), i < made ? FXS_FIT_KEPT : FXS_FIT_CLONE};
    const int error = fxs_fit_model_rebuild(m, origins, count, fxs_run_here, NULL);
    for (size_t i = made; i < count && !error; i++)
        plane(m, FXS_FIT_OPACITY)[i] = SPARE_LOGIT;
    free(origins);
    return error;
}

int fxs_fit_begin_moving(fxs_fit *f, fxs_message *message)
{
    FXS_TRY(f->engine->fetch(f->self, message));
    f->engine->free(f->self);
    f->engine = &fxs_fit_engine_cpu;
    f->self = f;
    const size_t made = f->model.count;
    if (fxs_fit_model_order(&f->model) || add_spare(f))
        return fxs_fail_memory(message, "a fit", 0);
    FXS_TRY(make_room(f, message));
    f->moving->made = made;
    const float *const planes[3] = {plane(&f->model, 0), plane(&f->model, 1), plane(&f->model, 2)};
    if (fxs_neighbours(planes, made, f->moving->near))
        return fxs_fail_memory(message, "a fit", 0);
    take_planes(&f->model, f->moving->last, POSE);
    take_planes(&f->model, f->moving->rest, POSE);
    FXS_TRY(measure(f, message));
    memcpy(f->moving->fitted, f->moving->errors, f->moving->stride * sizeof(float));
    return fxs_fit_tracks_keep(&f->moving->tracks, &f->model) ? fxs_fail_memory(message, "a fit", 0) : 0;
}

void fxs_fit_show_moment(fxs_fit *f, const fxs_fit_photo *photos)
{
    for (size_t i = 0; i < f->count; i++) {
        f->photographs[i].pixels = photos[i].pixels;
        f->photographs[i].mask = photos[i].mask;
    }
}

int fxs_fit_follow(fxs_fit *f, const fxs_fit_photo *photos, uint32_t steps, fxs_fit_followed *followed,
                   fxs_message *message)
{
    memset(followed, 0, sizeof *followed);
    fxs_fit_show_moment(f, photos);
    return move(f, steps, followed, message);
}
