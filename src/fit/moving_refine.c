/* Keeps the poses of a moving scene's Gaussians, and refines them over all moments.
 *
 * The positions of a Gaussian that moves become a uniform cubic B-spline in time, its quaternions a piecewise linear
 * curve, both with a knot every KNOT moments. So between two knots a position is a polynomial of degree 3, as in a
 * packed scene. A step draws one moment. The gradient by a control of a curve is the gradient by the pose times the
 * weight of the control in the pose. All moments share scale, opacity, colour and SH, and the poses of Gaussians that
 * stay. */
#include "moving.h"

#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/message.h>
#include "src/base/try_internal.h"
#include "src/fit/stages/adam.h"
#include "src/fit/stages/planes.h"
#include "moving_internal.h"
#include "src/base/random.h"
#include "turn.h"

enum {
    KNOT = 4,                      /* moments from one knot to the next */
    WIDTH = 4,                     /* number of controls with a weight in a pose, at most */
    VISIT = 8                      /* number of successive steps with the photographs of one moment */
};

#define POSITION_RATE 3e-4f        /* first learning rate of positions, relative to the extent */
#define ROTATION_RATE 0.006f
#define STILL_RATE 1e-5f           /* of positions of Gaussians that stay, relative to the extent */
#define STILL_TURN_RATE 1e-4f
#define SCALE_RATE 0.002f
#define OPACITY_RATE 0.01f
#define COLOUR_RATE 0.0025f
#define SH_RATE 0.000125f
#define RATE_FALL 3.0f             /* all rates fall by this power of e, to 1/20 */
#define SHORT 1e-6                 /* weight of the squared differences of a curve's controls, where moments are few */
#define SMOOTH 1e-3                /* weight of their squared third differences */

/* ---- Tracks ------------------------------------------------------------------------------------------------------ */

int fxs_fit_moved_plane(int k)
{
    return k < 3 ? FXS_FIT_POSITION + k : FXS_FIT_ROTATION + k - 3;
}

int fxs_fit_tracks_begin(fxs_fit_tracks *t, size_t gaussians)
{
    t->number = malloc(gaussians * sizeof *t->number);
    t->gaussian = malloc(gaussians * sizeof *t->gaussian);
    for (size_t i = 0; i < gaussians && t->number; i++)
        t->number[i] = FXS_FIT_STILL;
    return t->number && t->gaussian ? 0 : FXS_ERR_MEMORY;
}

void fxs_fit_tracks_free(fxs_fit_tracks *t)
{
    for (size_t i = 0; i < t->moments; i++)
        free(t->poses[i]);
    free(t->poses);
    free(t->number);
    free(t->gaussian);
}

float *fxs_fit_pose_of(const fxs_fit_tracks *t, size_t moment, size_t gaussian)
{
    return t->poses[moment] + (size_t)t->number[gaussian] * FXS_FIT_MOVED;
}

static void take_pose(const fxs_fit_model *model, size_t gaussian, float *pose)
{
    for (int k = 0; k < FXS_FIT_MOVED; k++)
        pose[k] = plane(model, fxs_fit_moved_plane(k))[gaussian];
}

int fxs_fit_tracks_add(fxs_fit_tracks *t, const fxs_fit_model *model, size_t gaussian)
{
    const size_t larger = 2 * t->room + 256;
    for (size_t i = 0; i < t->moments && t->count == t->room; i++) {
        float *poses = realloc(t->poses[i], larger * FXS_FIT_MOVED * sizeof *poses);
        if (!poses)
            return FXS_ERR_MEMORY;
        t->poses[i] = poses;
    }
    t->room = t->count == t->room ? larger : t->room;
    t->gaussian[t->count] = (uint32_t)gaussian;
    t->number[gaussian] = (uint32_t)t->count++;
    for (size_t i = 0; i < t->moments; i++)
        take_pose(model, gaussian, fxs_fit_pose_of(t, i, gaussian));
    return 0;
}

int fxs_fit_tracks_keep(fxs_fit_tracks *t, const fxs_fit_model *model)
{
    float **more = realloc(t->poses, (t->moments + 1) * sizeof *more);
    t->poses = more ? more : t->poses;
    float *poses = more ? malloc((t->room + 1) * FXS_FIT_MOVED * sizeof *poses) : NULL;
    if (!poses)
        return FXS_ERR_MEMORY;
    t->poses[t->moments++] = poses;
    for (size_t i = 0; i < t->count; i++)
        take_pose(model, t->gaussian[i], poses + i * FXS_FIT_MOVED);
    return 0;
}

/* Gives quaternions the length 1, and the sign that is nearer to the moment before. */
static void align_turns(const fxs_fit_tracks *t)
{
    for (size_t moment = 0; moment < t->moments; moment++)
        for (size_t i = 0; i < t->count; i++) {
            float *now = t->poses[moment] + i * FXS_FIT_MOVED + 3;
            const turn a = turn_at(t->poses[moment ? moment - 1 : 0] + i * FXS_FIT_MOVED + 3, 1, 0);
            const turn b = unit(turn_at(now, 1, 0));
            const int is_opposite = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z < 0;
            put_turn(now, 1, 0, is_opposite ? (turn){-b.w, -b.x, -b.y, -b.z} : b);
        }
}

/* ---- Curves ------------------------------------------------------------------------------------------------------ */

/* The curves of all tracks. Control n has `components` rows with a float for each track. */
typedef struct curves {
    int components, first, is_cubic;   /* first: number of the first component in a pose */
    size_t controls, count;
    float *at, *means, *squares;       /* controls and Adam's moments of them */
    uint32_t *visits;                  /* number of steps that changed each control */
} curves;

/* Sets the weights of controls in the poses of a moment. Weights of 0 come last. Returns the number of the first
   control. */
static size_t weights_of(const curves *c, size_t moment, float weights[WIDTH])
{
    const float u = (float)(moment % KNOT) / KNOT, v = 1 - u;
    weights[0] = c->is_cubic ? v * v * v / 6 : v;
    weights[1] = c->is_cubic ? (4 - 6 * u * u + 3 * u * u * u) / 6 : u;
    weights[2] = c->is_cubic ? (4 - 6 * v * v + 3 * v * v * v) / 6 : 0;
    weights[3] = c->is_cubic ? u * u * u / 6 : 0;
    return moment / KNOT;
}

static size_t width_of(const curves *c)
{
    return c->is_cubic ? 4 : 2;
}

static float *row_of(const curves *c, float *of, size_t control, int component)
{
    return of + (control * (size_t)c->components + (size_t)component) * c->count;
}

static int curves_room(curves *c, const fxs_fit_tracks *t)
{
    c->count = t->count;
    c->controls = (t->moments - 1) / KNOT + width_of(c);
    const size_t numbers = c->controls * (size_t)c->components * c->count + 1;
    c->at = malloc(numbers * sizeof *c->at);
    c->means = calloc(numbers, sizeof *c->means);
    c->squares = calloc(numbers, sizeof *c->squares);
    c->visits = calloc(c->controls, sizeof *c->visits);
    return c->at && c->means && c->squares && c->visits ? 0 : FXS_ERR_MEMORY;
}

static void curves_free(curves *c)
{
    free(c->at);
    free(c->means);
    free(c->squares);
    free(c->visits);
}

/* Inverts a positive definite matrix of n rows in place (Gauss and Jordan). */
static void invert(double *a, size_t n)
{
    for (size_t k = 0; k < n; k++) {
        const double pivot = 1 / a[k * n + k];
        a[k * n + k] = 1;
        for (size_t j = 0; j < n; j++)
            a[k * n + j] *= pivot;
        for (size_t i = 0; i < n; i++) {
            const double factor = a[i * n + k];
            if (i == k)
                continue;
            a[i * n + k] = 0;
            for (size_t j = 0; j < n; j++)
                a[i * n + j] -= factor * a[k * n + j];
        }
    }
}

/* Adds the outer product of some coefficients to the part of a matrix that begins at row and column `first`. */
static void add_product(double *a, size_t n, size_t first, const double *coefficients, size_t count, double share)
{
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < count; j++)
            a[(first + i) * n + first + j] += share * coefficients[i] * coefficients[j];
}

/* Sets a to the matrix of the normal equations of curves at all moments. */
static void add_equations(const curves *c, size_t moments, double *a)
{
    static const double first_differences[] = {-1, 1}, third_differences[] = {-1, 3, -3, 1};
    const size_t n = c->controls;
    float w[WIDTH];
    for (size_t t = 0; t < moments; t++) {
        const size_t first = weights_of(c, t, w);
        const double wide[WIDTH] = {(double)w[0], (double)w[1], (double)w[2], (double)w[3]};
        add_product(a, n, first, wide, width_of(c), 1);
    }
    for (size_t i = 0; i + 2 <= n; i++)
        add_product(a, n, i, first_differences, 2, SHORT);
    for (size_t i = 0; i + 4 <= n; i++)
        add_product(a, n, i, third_differences, 4, SMOOTH);
}

/* Fits the curves to the poses of all moments by least squares. `inverse` is the inverse matrix of the normal
   equations, `sums` has room for a double for each control. */
static void solve(const curves *c, const fxs_fit_tracks *t, const double *inverse, double *sums)
{
    const size_t n = c->controls;
    float w[WIDTH];
    for (int d = 0; d < c->components; d++)
        for (size_t i = 0; i < c->count; i++) {
            memset(sums, 0, n * sizeof *sums);
            for (size_t moment = 0; moment < t->moments; moment++) {
                const size_t first = weights_of(c, moment, w);
                const float pose = t->poses[moment][i * FXS_FIT_MOVED + (size_t)(c->first + d)];
                for (size_t k = 0; k < width_of(c); k++)
                    sums[first + k] += (double)w[k] * (double)pose;
            }
            for (size_t k = 0; k < n; k++) {
                double at = 0;
                for (size_t j = 0; j < n; j++)
                    at += inverse[k * n + j] * sums[j];
                row_of(c, c->at, k, d)[i] = (float)at;
            }
        }
}

static int curves_begin(curves *c, const fxs_fit_tracks *t)
{
    if (curves_room(c, t))
        return FXS_ERR_MEMORY;
    double *matrix = calloc(c->controls * (c->controls + 1), sizeof *matrix);
    if (!matrix)
        return FXS_ERR_MEMORY;
    add_equations(c, t->moments, matrix);
    invert(matrix, c->controls);
    solve(c, t, matrix, matrix + c->controls * c->controls);
    free(matrix);
    return 0;
}

/* Writes the curves' part of the poses of a moment to the model, or to `poses` if that is not null. */
static void curves_pose(const curves *c, const fxs_fit_tracks *t, const fxs_fit_model *model, size_t moment,
                        float *poses)
{
    float w[WIDTH];
    const size_t first = weights_of(c, moment, w);
    for (int d = 0; d < c->components; d++) {
        float *to = poses ? poses + c->first + d : plane(model, fxs_fit_moved_plane(c->first + d));
        for (size_t i = 0; i < c->count; i++) {
            float sum = 0;
            for (size_t k = 0; k < width_of(c); k++)
                sum += w[k] * row_of(c, c->at, first + k, d)[i];
            to[poses ? i * FXS_FIT_MOVED : t->gaussian[i]] = sum;
        }
    }
}

/* Makes a step of Adam by the gradients at the poses of a moment. The model's first moments hold a tenth of them. */
static void curves_step(curves *c, const fxs_fit *f, const fxs_fit_step_options *options, float rate, size_t moment,
                        const fxs_fit_photograph *batch)
{
    const fxs_fit_tracks *t = &f->moving->tracks;
    fxs_fit_step_options own = *options;
    fxs_fit_adam adam;
    float w[WIDTH];
    const size_t first = weights_of(c, moment, w);
    for (size_t k = 0; k < width_of(c) && w[k] > 0; k++) {
        own.rate[0] = rate;
        own.number = ++c->visits[first + k];
        fxs_fit_set_adam(&adam, &own, batch, f->options.batch, f->model.count);
        for (int d = 0; d < c->components; d++) {
            const float *g = f->model.means + (size_t)fxs_fit_moved_plane(c->first + d) * f->model.stride;
            float *at = row_of(c, c->at, first + k, d), *mean = row_of(c, c->means, first + k, d);
            float *square = row_of(c, c->squares, first + k, d);
            for (size_t i = 0; i < c->count; i++)
                adam_step(&adam, adam.rate[0], 10 * w[k] * g[t->gaussian[i]], &at[i], &mean[i], &square[i]);
        }
    }
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

typedef struct refinement {
    fxs_fit *fit;
    size_t first;                  /* first moment that is drawn */
    uint32_t steps;
    curves positions, rotations;
    uint32_t *order;               /* random order of the moments */
    fxs_fit_moment_fn *read;
    void *argument;
    double *absolute;
} refinement;

static void set_moment_of(const refinement *r, size_t moment, float *poses)
{
    const fxs_fit_tracks *t = &r->fit->moving->tracks;
    curves_pose(&r->positions, t, &r->fit->model, moment, poses);
    curves_pose(&r->rotations, t, &r->fit->model, moment, poses);
}

/* Clears Adam's first moments of the poses that curves change, so that a step leaves a tenth of the gradients there. */
static void clear_gradients(fxs_fit *f)
{
    const fxs_fit_tracks *t = &f->moving->tracks;
    for (int k = 0; k < FXS_FIT_MOVED; k++)
        for (size_t i = 0; i < t->count; i++)
            f->model.means[(size_t)fxs_fit_moved_plane(k) * f->model.stride + t->gaussian[i]] = 0;
}

static void set_options(const fxs_fit *f, uint32_t step, float fall, fxs_fit_step_options *o)
{
    memset(o, 0, sizeof *o);
    o->sh_degree = f->options.sh_degree;
    o->number = step;
    o->far = f->far;
    for (int k = 0; k < 3; k++)
        o->background[k] = (float)f->options.background[k] / 255.0f;
    for (int k = 0; k < FXS_FIT_PARAMETERS; k++)
        o->rate[k] = fall * (k < FXS_FIT_SCALE      ? STILL_RATE * f->extent
                             : k < FXS_FIT_ROTATION ? SCALE_RATE
                             : k < FXS_FIT_OPACITY  ? STILL_TURN_RATE
                             : k < FXS_FIT_COLOUR   ? OPACITY_RATE
                             : k < FXS_FIT_SH       ? COLOUR_RATE
                                                    : SH_RATE);
}

static int make_step(refinement *r, size_t moment, uint32_t step, fxs_message *message)
{
    fxs_fit *f = r->fit;
    fxs_fit_photograph batch[FXS_FIT_BATCH];
    fxs_fit_step_options options;
    fxs_fit_report report;
    const float fall = exp_e(-RATE_FALL * (float)step / (float)r->steps);
    for (uint32_t v = 0; v < f->options.batch; v++)
        fxs_fit_take_photograph(f, (uint64_t)f->step * f->options.batch + v, 1, &batch[v]);
    f->step++;
    set_moment_of(r, moment, NULL);
    clear_gradients(f);
    set_options(f, step, fall, &options);
    FXS_TRY(f->engine->step(f->self, batch, f->options.batch, &options, &report, message));
    *r->absolute += report.absolute / r->steps;
    curves_step(&r->positions, f, &options, POSITION_RATE * f->extent * fall, moment, batch);
    curves_step(&r->rotations, f, &options, ROTATION_RATE * fall, moment, batch);
    return 0;
}

/* Returns the moment of a visit. Each pass over all moments has its own random order. */
static uint32_t moment_of(const refinement *r, uint32_t visit)
{
    const uint32_t count = (uint32_t)(r->fit->moving->tracks.moments - r->first);
    for (uint32_t i = 0; i < count && visit % count == 0; i++) {
        const uint32_t j = (uint32_t)(fxs_random(r->fit->options.seed, r->fit->step, i) % (i + 1));
        r->order[i] = r->order[j];
        r->order[j] = (uint32_t)r->first + i;
    }
    return r->order[visit % count];
}

static int make_steps(refinement *r, fxs_message *message)
{
    const fxs_fit_photo *photos;
    uint32_t moment = 0;
    for (uint32_t step = 0; step < r->steps; step++) {
        if (step % VISIT == 0) {
            moment = moment_of(r, step / VISIT);
            FXS_TRY(r->read(r->argument, moment, &photos, message));
            fxs_fit_show_moment(r->fit, photos);
        }
        FXS_TRY(make_step(r, moment, step + 1, message));
    }
    return 0;
}

/* Takes the refined poses. */
static void end_curves(const refinement *r)
{
    struct fxs_fit_moving *m = r->fit->moving;
    const fxs_fit_tracks *t = &m->tracks;
    const size_t before = t->moments > 1 ? t->moments - 2 : 0;
    for (size_t moment = 0; moment < t->moments; moment++)
        set_moment_of(r, moment, t->poses[moment]);
    set_moment_of(r, t->moments - 1, NULL);
    for (int k = 0; k < FXS_FIT_MOVED; k++) {
        float *rest = m->rest + (size_t)k * m->stride, *last = m->last + (size_t)k * m->stride;
        memcpy(rest, plane(&r->fit->model, fxs_fit_moved_plane(k)), m->stride * sizeof *rest);
        memcpy(last, rest, m->stride * sizeof *rest);
        for (size_t i = 0; i < t->count; i++) {
            rest[t->gaussian[i]] = t->poses[0][i * FXS_FIT_MOVED + (size_t)k];
            last[t->gaussian[i]] = t->poses[before][i * FXS_FIT_MOVED + (size_t)k];
        }
    }
}

static int refine(refinement *r, fxs_message *message)
{
    const fxs_fit_tracks *t = &r->fit->moving->tracks;
    r->order = malloc(t->moments * sizeof *r->order);
    align_turns(t);
    if (!r->order || curves_begin(&r->positions, t) || curves_begin(&r->rotations, t))
        return fxs_fail_memory(message, "a fit", 0);
    FXS_TRY(make_steps(r, message));
    end_curves(r);
    return 0;
}

int fxs_fit_refine_moving(fxs_fit *f, size_t first, uint32_t steps, fxs_fit_moment_fn *read, void *argument,
                          double *absolute, fxs_message *message)
{
    refinement r = {f, first, steps, {.components = 3, .first = 0, .is_cubic = 1}, {.components = 4, .first = 3}, 0,
                    read, argument, absolute};
    const size_t bytes = FXS_FIT_PARAMETERS * f->model.stride * sizeof(float);
    memset(f->model.means, 0, bytes);
    memset(f->model.squares, 0, bytes);
    const int error = refine(&r, message);
    curves_free(&r.positions);
    curves_free(&r.rotations);
    free(r.order);
    return error;
}

void fxs_fit_set_moment(fxs_fit *f, size_t number)
{
    const fxs_fit_tracks *t = &f->moving->tracks;
    for (int k = 0; k < FXS_FIT_MOVED; k++)
        for (size_t i = 0; i < t->count; i++)
            plane(&f->model, fxs_fit_moved_plane(k))[t->gaussian[i]] =
                t->poses[number][i * FXS_FIT_MOVED + (size_t)k];
}
