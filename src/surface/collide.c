/* Makes solid voxels: absorbs the scene, then carves what a capsule reaches from a seed. With the capsule K and the
 * solid voxels S, the capsule fits at the centres outside of S + K. F are those connected with the seed. Then F + K is
 * free, and everything else is solid. Sums are dilations; K is a segment + a ball. */
#include <math.h>
#include <string.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/fixed.h>
#include <fixsplat/internal/message.h>
#include "src/base/exponential.h"
#include "src/base/options.h"
#include "src/base/try_internal.h"
#include "voxels.h"

enum { HEIGHT_MOST = 4096, CELLS_MOST = 1 << 15, RUNS_MOST = 64 * 64 };

typedef struct capsule {
    int axis;                      /* the axis along which it stands */
    int32_t half, radius;          /* voxels: half of the segment, and the reach of the ball */
    int32_t square_q16;            /* square of the ball's radius */
} capsule;

static void set_defaults(fxs_collide_options *o)
{
    o->voxel = o->voxel == 0 ? 0.05 : o->voxel;
    o->opacity = o->opacity == 0 ? 0.1 : o->opacity;
    o->radius = o->radius == 0 ? 0.2 : o->radius;
    o->height = o->height == 0 ? FXS_COLLIDE_HEIGHT : o->height;
    o->max_memory = o->max_memory ? o->max_memory : (size_t)1 << 31;
    if (o->up[0] == 0 && o->up[1] == 0 && o->up[2] == 0)
        o->up[1] = -1;
}

static int is_point(const double at[3])
{
    return fabs(at[0]) <= 0x1p28 && fabs(at[1]) <= 0x1p28 && fabs(at[2]) <= 0x1p28;
}

static int check(const fxs_collide_options *o, fxs_message *m)
{
    if (!(o->voxel >= 0x1p-16 && o->voxel <= 0x1p16))
        return fxs_fail_as(FXS_ERR_ARGUMENT, m, "the size of a voxel is 2^-16 to 2^16 units");
    if (!(o->opacity >= 0.001 && o->opacity <= 0.999))
        return fxs_fail_as(FXS_ERR_ARGUMENT, m, "the opacity of a solid voxel is 0.001 to 0.999");
    if (!(o->radius > 0 && o->radius / o->voxel < FXS_REACH_MOST + 0.5))
        return fxs_fail_as(FXS_ERR_ARGUMENT, m, "the radius of the capsule is above 0, at most 31 voxels: here %.3g "
                           "units", FXS_REACH_MOST * o->voxel);
    if (!(o->height >= 2 * o->radius && o->height / o->voxel <= HEIGHT_MOST))
        return fxs_fail_as(FXS_ERR_ARGUMENT, m, "the height of the capsule is twice its radius to 4096 voxels: here "
                           "%.3g to %.3g units", 2 * o->radius, HEIGHT_MOST * o->voxel);
    int valid = is_point(o->up) && is_point(o->low) && is_point(o->high) && o->seed_count >= 1 && o->seed_count <= 2;
    for (int i = 0; i < 3; i++)
        valid = valid && o->low[i] <= o->high[i];
    for (uint32_t i = 0; valid && i < o->seed_count; i++)
        valid = is_point(o->seeds[i]);
    return valid ? 0 : fxs_fail_as(FXS_ERR_ARGUMENT, m, "the box, the seed or the up direction is out of range");
}

static capsule capsule_of(const fxs_collide_options *o)
{
    const double radius_q8 = floor(o->radius / o->voxel * 256 + 0.5), x = fabs(o->up[0]), y = fabs(o->up[1]);
    capsule c = {.half = (int32_t)floor((o->height / 2 - o->radius) / o->voxel + 0.5)};
    c.square_q16 = (int32_t)(radius_q8 * radius_q8);
    c.radius = (int32_t)radius_q8 >> 8;
    c.axis = fabs(o->up[2]) > (x > y ? x : y) ? 2 : x > y ? 0 : 1;
    return c;
}

/* ---- Dilation by the capsule ------------------------------------------------------------------------------------- */

static int dilate_segment(fxs_bits *g, const capsule *c, uint32_t outside, fxs_voxel_work *work)
{
    fxs_offsets runs[2 * FXS_REACH_MOST + 1];
    for (int32_t left = c->half, reach; left > 0; left -= reach) {
        uint32_t count = 0;
        reach = left < FXS_REACH_MOST ? left : FXS_REACH_MOST;
        if (c->axis == 0)
            runs[count++] = (fxs_offsets){0, 0, reach};
        for (int32_t d = -reach; d <= reach && c->axis; d++)
            runs[count++] = (fxs_offsets){c->axis == 1 ? d : 0, c->axis == 2 ? d : 0, 0};
        FXS_TRY(fxs_bits_dilate(g, runs, count, reach, outside, work));
    }
    return 0;
}

static int32_t run_of_ball(const capsule *c, int32_t dy, int32_t dz)
{
    const int32_t left_q16 = c->square_q16 - ((dy * dy + dz * dz) << 16);
    int32_t run = left_q16 < 0 ? -1 : 0;
    while (run >= 0 && (run + 1) * (run + 1) << 16 <= left_q16)
        run++;
    return run;
}

static int dilate_ball(fxs_bits *g, const capsule *c, uint32_t outside, fxs_voxel_work *work)
{
    fxs_offsets *runs = fxs_work_allocate(work, RUNS_MOST, sizeof *runs);
    uint32_t count = 0;
    if (!runs)
        return FXS_ERR_MEMORY;
    for (int32_t dz = -c->radius; dz <= c->radius; dz++)
        for (int32_t dy = -c->radius; dy <= c->radius; dy++) {
            const int32_t run = run_of_ball(c, dy, dz);
            if (run >= 0)
                runs[count++] = (fxs_offsets){dy, dz, run};
        }
    const int error = fxs_bits_dilate(g, runs, count, c->radius, outside, work);
    fxs_work_release(work, runs, RUNS_MOST, sizeof *runs);
    return error;
}

static int dilate(fxs_bits *g, const capsule *c, uint32_t outside, fxs_voxel_work *work)
{
    FXS_TRY(dilate_segment(g, c, outside, work));
    work->done += work->share;
    FXS_TRY(dilate_ball(g, c, outside, work));
    work->done += work->share;
    return 0;
}

/* ---- Seeds ------------------------------------------------------------------------------------------------------- */

/* Turns a point of the scene to the axes of the voxels. */
static void turn(double out[3], const double at[3])
{
    out[0] = 0 - at[0];
    out[1] = 0 - at[1];
    out[2] = at[2];
}

/* True if (x, y, z) from a capsule's centre is in the capsule. */
static int is_in_capsule(const capsule *c, const int32_t at[3])
{
    int32_t d[3] = {at[0], at[1], at[2]};
    const int32_t along = d[c->axis] < 0 ? -d[c->axis] : d[c->axis];
    d[c->axis] = along > c->half ? along - c->half : 0;
    return d[0] * d[0] + d[1] * d[1] + d[2] * d[2] <= c->square_q16 >> 16;
}

static int is_in_grid(const fxs_bits *g, const int32_t at[3])
{
    int inside = 1;
    for (int i = 0; i < 3; i++)
        inside = inside && at[i] >= 0 && at[i] < g->n[i] * FXS_CELL;
    return inside;
}

/* Finds the free centre nearest to a seed at which the capsule holds the seed. Returns 0 if there is none. */
static int find_centre(int32_t centre[3], const fxs_bits *blocked, const capsule *c, const int32_t seed[3])
{
    int64_t least = INT64_MAX;
    const int32_t most = c->half + c->radius;
    int32_t d[3];
    for (d[2] = -most; d[2] <= most; d[2]++)
        for (d[1] = -most; d[1] <= most; d[1]++)
            for (d[0] = -most; d[0] <= most; d[0]++) {
                const int64_t far = (int64_t)d[0] * d[0] + (int64_t)d[1] * d[1] + (int64_t)d[2] * d[2];
                const int32_t at[3] = {seed[0] + d[0], seed[1] + d[1], seed[2] + d[2]};
                if (far >= least || !is_in_capsule(c, d) || !is_in_grid(blocked, at) ||
                    fxs_bits_bit(blocked, at[0], at[1], at[2]))
                    continue;
                least = far;
                memcpy(centre, at, sizeof at);
            }
    return least < INT64_MAX;
}

static int refuse_seed(const fxs_collide_options *o, uint32_t i, const char *why, fxs_message *m)
{
    const double *at = o->seeds[i];
    return fxs_fail_as(FXS_ERR_OBJECT, m, "the seed %.6g,%.6g,%.6g %s", at[0], at[1], at[2], why);
}

/* What is known of the seeds before the solid voxels are dilated. */
typedef struct seeds {
    int32_t at[2][3];
    int is_free[2];
} seeds;

static int look_at_seeds(seeds *s, const fxs_voxels *v, const fxs_collide_options *o, fxs_message *m)
{
    int any = 0, outside = 0;
    for (uint32_t i = 0; i < o->seed_count; i++) {
        double at[3];
        turn(at, o->seeds[i]);
        for (int k = 0; k < 3; k++)
            s->at[i][k] = (int32_t)fmin(fmax(floor(at[k] / o->voxel) - v->origin[k], -1), 0x1p30);
        const int inside = is_in_grid(&v->solid, s->at[i]);
        s->is_free[i] = inside && !fxs_bits_bit(&v->solid, s->at[i][0], s->at[i][1], s->at[i][2]);
        any |= s->is_free[i];
        outside += !inside;
    }
    return any ? 0 : refuse_seed(o, 0, outside ? "is outside of the box" : "is inside of something solid", m);
}

static int choose_seed(int32_t centre[3], fxs_voxels *v, const seeds *s, const fxs_bits *blocked, const capsule *c,
                       const fxs_collide_options *o, fxs_message *m)
{
    uint32_t first = o->seed_count;
    for (uint32_t i = o->seed_count; i-- > 0;)
        first = s->is_free[i] ? i : first;
    for (v->info.seed = first; v->info.seed < o->seed_count; v->info.seed++)
        if (s->is_free[v->info.seed] && find_centre(centre, blocked, c, s->at[v->info.seed]))
            return 0;
    return refuse_seed(o, first, "has no room for the capsule", m);
}

/* ---- Steps ------------------------------------------------------------------------------------------------------- */

static int size_grid(int32_t n[3], fxs_voxels *v, const fxs_collide_options *o, fxs_message *m)
{
    double cells = 1;
    turn(v->bounds[0], o->low);
    turn(v->bounds[1], o->high);
    for (int i = 0; i < 3; i++) {
        const double a = v->bounds[0][i], b = v->bounds[1][i];
        v->bounds[0][i] = fmin(a, b);
        v->bounds[1][i] = fmax(a, b);
        const double first = floor((v->bounds[0][i] - o->height) / o->voxel / FXS_CELL);
        const double end = ceil((v->bounds[1][i] + o->height) / o->voxel / FXS_CELL);
        cells *= end - first;
        if (fabs(first) > 0x1p24 || fabs(end) > 0x1p24 || end - first > CELLS_MOST)
            return fxs_fail_as(FXS_ERR_MEMORY, m, "voxels of %.3g units are too small for a scene of this size or "
                               "place: make them larger", o->voxel);
        n[i] = (int32_t)(end - first);
        v->origin[i] = (int32_t)first * FXS_CELL;
    }
    if (16 * cells > (double)o->max_memory)
        return fxs_fail_as(FXS_ERR_MEMORY, m, "voxels of %.3g units need over %.1f MiB, more than %.1f MiB: make them "
                           "larger", o->voxel, cells / 65536, (double)o->max_memory / 1048576);
    return 0;
}

static int find_solid(fxs_voxels *v, const fxs_scene *scene, const fxs_collide_options *o, fxs_voxel_work *work)
{
    const int64_t voxel_q32 = (int64_t)floor(o->voxel * 0x1p32 + 0.5);
    const uint32_t depth_q15 = (uint32_t)floor(-fxs_log(1 - o->opacity) * 32768 + 0.5);
    work->share = 0.7;
    FXS_TRY(fxs_bits_absorb(&v->solid, scene, v->origin, voxel_q32, depth_q15, o->max_memory, work));
    work->done = 0.7;
    work->share = 0.05;
    FXS_TRY(fxs_bits_drop_dust(&v->solid, work));
    v->info.absorbing = fxs_bits_count(&v->solid);
    if (!v->info.absorbing)
        return fxs_fail_as(FXS_ERR_OBJECT, work->message, "nothing is solid: no voxels side by side absorb %.3g of the "
                           "light", o->opacity);
    return 0;
}

/* Replaces the solid voxels by those that the capsule cannot reach. */
static int carve(fxs_voxels *v, const fxs_collide_options *o, fxs_voxel_work *work)
{
    const capsule c = capsule_of(o);
    seeds s;
    int32_t centre[3];
    fxs_bits reached = {{0, 0, 0}, NULL, NULL, 0, 0};
    FXS_TRY(look_at_seeds(&s, v, o, work->message));
    FXS_TRY(dilate(&v->solid, &c, FXS_CELL_SOLID, work));
    FXS_TRY(choose_seed(centre, v, &s, &v->solid, &c, o, work->message));
    const int error = fxs_bits_flood(&reached, &v->solid, centre, work);
    fxs_bits_close(&v->solid, work);
    v->solid = reached;
    FXS_TRY(error);
    FXS_TRY(dilate(&v->solid, &c, FXS_CELL_EMPTY, work));
    v->info.free = fxs_bits_count(&v->solid);
    return 0;
}

typedef struct box {
    int32_t low[3], high[3];
} box;

/* Widens a box by the bits x of row (y, z). */
static void add_row(box *b, int32_t x, int32_t y, int32_t z, uint32_t bits)
{
    const int32_t low[3] = {x + fxs_ctz32(bits), y, z}, high[3] = {x + 31 - fxs_clz32(bits), y, z};
    for (int i = 0; i < 3; i++) {
        b->low[i] = low[i] < b->low[i] ? low[i] : b->low[i];
        b->high[i] = high[i] > b->high[i] ? high[i] : b->high[i];
    }
}

/* Sets the box of the free voxels, with a block of 4 more on each side. */
static void find_box(fxs_voxels *v)
{
    const fxs_bits *g = &v->solid;
    box b = {{INT32_MAX, INT32_MAX, INT32_MAX}, {0, 0, 0}};
    for (int32_t z = 0; z < g->n[2] * FXS_CELL; z++)
        for (int32_t y = 0; y < g->n[1] * FXS_CELL; y++)
            for (int32_t x = 0; x < g->n[0]; x++) {
                const uint32_t bits = fxs_bits_row(g, x, y, z);
                if (bits)
                    add_row(&b, x * FXS_CELL, y, z, bits);
            }
    for (int i = 0; i < 3; i++) {
        v->info.low[i] = (b.low[i] & ~3) - 4 + v->origin[i];
        v->info.high[i] = (b.high[i] | 3) + 5 + v->origin[i];
    }
}

static int make(fxs_voxels *v, const fxs_scene *scene, const fxs_collide_options *o, fxs_message *m)
{
    fxs_voxel_work *work = &v->work;
    int32_t n[3];
    *work = (fxs_voxel_work){.workers = o->workers, .progress = &o->progress, .message = m,
                             .allocator = o->allocator ? &v->allocator : NULL};
    v->info.voxel = o->voxel;
    FXS_TRY(size_grid(n, v, o, m));
    FXS_TRY(fxs_bits_open(&v->solid, n, work));
    FXS_TRY(find_solid(v, scene, o, work));
    FXS_TRY(carve(v, o, work));
    find_box(v);
    fxs_bits_invert(&v->solid);
    v->info.memory = work->peak;
    work->message = NULL;
    work->progress = NULL;
    return 0;
}

int fxs_collide(const fxs_scene *scene, const fxs_collide_options *given, fxs_voxels **voxels, fxs_message *message)
{
    fxs_collide_options o = {0};
    if (!scene || !voxels || !given)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "no scene, options or place for voxels");
    *voxels = NULL;
    FXS_TRY(FXS_OPTIONS_READ(fxs_collide_options, &o, given, message));
    set_defaults(&o);
    FXS_TRY(check(&o, message));
    if (scene->motion)
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "a scene that moves has no voxels");
    fxs_voxels *v = fxs_allocate_zeroed(o.allocator, 1, sizeof *v);
    if (!v)
        return fxs_fail_memory(message, NULL, sizeof *v);
    if (o.allocator)
        v->allocator = *o.allocator;
    const int error = make(v, scene, &o, message);
    if (error)
        fxs_voxels_free(v);
    else
        *voxels = v;
    return error;
}

void fxs_voxels_free(fxs_voxels *v)
{
    if (!v)
        return;
    const fxs_allocator allocator = v->allocator;
    const int is_own = v->work.allocator != NULL;
    fxs_bits_close(&v->solid, &v->work);
    fxs_release(NULL, v->tree.words);
    fxs_release(is_own ? &allocator : NULL, v);
}

const fxs_voxels_info *fxs_voxels_describe(const fxs_voxels *v)
{
    return &v->info;
}

int fxs_voxels_solid(const fxs_voxels *v, int32_t x, int32_t y, int32_t z)
{
    const int64_t at[3] = {(int64_t)x - v->origin[0], (int64_t)y - v->origin[1], (int64_t)z - v->origin[2]};
    for (int i = 0; i < 3; i++)
        if (at[i] < 0 || at[i] >= (v->tree.words ? (int64_t)v->info.high[i] - v->info.low[i]
                                   : (int64_t)v->solid.n[i] * FXS_CELL))
            return 1;
    if (v->tree.words)
        return fxs_octree_solid(&v->tree, (uint32_t[3]){(uint32_t)at[0], (uint32_t)at[1], (uint32_t)at[2]});
    return fxs_bits_bit(&v->solid, (int32_t)at[0], (int32_t)at[1], (int32_t)at[2]);
}
