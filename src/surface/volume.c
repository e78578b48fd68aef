/* The volume: marks bricks near the surface, and adds views to the sums of their voxels. All floating-point arithmetic
   is + - * / and sqrt of doubles in a fixed order, and sums are integers, so results are the same on every machine. */
#include "volume.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/fixed.h>
#include <fixsplat/internal/message.h>
#include "src/base/run.h"
#include "src/base/sine.h"
#include "src/base/try_internal.h"

enum { ROWS_OF_JOB = 16, BRICKS_OF_JOB = 32, CELLS_OF_JOB = 4096, TILE = 16 };

#define NEAR_SURFACE 2.0         /* distance in voxels from a depth at which voxels are reserved */
#define TO_CORNER 3.5            /* from the middle of a brick to its outermost voxels along each axis */
#define RADIUS 6.1               /* radius of a brick's voxels around their middle, 3.5 sqrt(3) and a margin, voxels */
#define CONTRACTED_MOST 0x1p19   /* places beyond this many voxels are not contracted: they are beyond all volumes */
#define OPEN 4.0                 /* a cell is open if its middle is this many voxels before the surface */
#define BEHIND 2.0               /* voxels behind a surface in which a sample has its whole weight */
#define COLOURED 1.5             /* largest distance in voxels from a surface whose colour a voxel takes */
#define OUTSIDE_Q15 32767

#define MESH_BYTES_OF_BRICK 4096 /* estimate: a brick on a surface has 100 vertices and 200 triangles */
#define SITE_BYTES 512           /* estimate: bits of edges, of the brick and of its share of neighbours */

void fxs_volume_run(const fxs_volume *volume, void (*job)(void *argument, uint32_t i), void *argument, uint32_t jobs)
{
    const fxs_workers *w = &volume->options.workers;
    (w->run ? w->run : fxs_run_here)(w->pool, job, argument, jobs);
}

int fxs_surface_check(uint64_t bytes, uint64_t limit, fxs_message *message)
{
    if (!limit || bytes <= limit)
        return 0;
    fxs_fail_as(FXS_ERR_MEMORY, message, "the mesh takes %" PRIu64 " MB, more than the limit of %" PRIu64 " MB",
                (bytes + 999999) / 1000000, limit / 1000000);
    message->bytes_needed = bytes;
    return FXS_ERR_MEMORY;
}

/* ---- Making ------------------------------------------------------------------------------------------------------ */

static int check_options(const fxs_volume_options *o, fxs_message *message)
{
    if (o->resolution < 16 || o->resolution > FXS_VOLUME_RESOLUTION)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "a resolution of %" PRIu32 ": expected 16 to %u", o->resolution,
                           FXS_VOLUME_RESOLUTION);
    if (!(o->truncation >= 1 && o->truncation <= 64))
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "a truncation of %g voxels: expected 1 to 64", o->truncation);
    return 0;
}

/* Places the grid: the box lies in the middle of its cells, which have a border of one cell. */
static int place_grid(fxs_volume *v, fxs_message *message)
{
    const fxs_volume_options *o = &v->options;
    const double far = o->is_unbounded ? 2 - 1.0 / FXS_VOLUME_FAR : 1;
    double longest = 0;
    uint64_t cells = 1;
    for (int i = 0; i < 3; i++) {
        const double side = o->high[i] - o->low[i];
        if (!(side >= 0) || !(fabs(o->low[i]) <= 0x1p28) || !(fabs(o->high[i]) <= 0x1p28))
            return fxs_fail_as(FXS_ERR_ARGUMENT, message, "a box without a size, or beyond 2^28 units");
        longest = side > longest ? side : longest;
    }
    if (!(longest > 0))
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "a box without a size");
    v->step = longest / o->resolution;
    for (int i = 0; i < 3; i++) {
        const double side = o->is_unbounded ? longest * far : o->high[i] - o->low[i];
        v->size[i] = (uint32_t)(side / v->step / FXS_BRICK) + 3;
        cells *= v->size[i];
        const double middle = (FXS_BRICK * v->size[i] - 1) / 2.0, half = side / v->step / 2;
        v->origin[i] = (o->low[i] + o->high[i]) / 2 - v->step * middle;
        v->last[i] = (uint32_t)(middle + half);
        v->first[i] = FXS_BRICK * v->size[i] - 1 - v->last[i];      /* at least FXS_BRICK */
    }
    v->cells = (uint32_t)cells;                 /* at most (2 * 2048 / 8 + 3)^3 */
    if (o->is_unbounded) {
        v->half_q16 = o->resolution << 15;
        v->middle_q16 = (FXS_BRICK * v->size[0] - 1) << 15;
    }
    return 0;
}

int fxs_volume_make(fxs_volume **volume, const fxs_volume_options *options, fxs_message *message)
{
    *volume = NULL;
    fxs_volume *v = fxs_allocate_zeroed(NULL, 1, sizeof *v);
    if (!v)
        return fxs_fail_memory(message, NULL, sizeof *v);
    memcpy(&v->options, options, options->size < sizeof v->options ? options->size : sizeof v->options);
    fxs_volume_options *o = &v->options;
    o->resolution = o->resolution ? o->resolution : 512;
    o->truncation = o->truncation > 0 ? o->truncation : o->resolution > 128 ? o->resolution / 32.0 : 4;
    o->least_views = o->least_views ? o->least_views : 1;
    int error = check_options(o, message);
    error = error ? error : place_grid(v, message);
    error = error ? error : fxs_surface_check(9 * (uint64_t)v->cells, o->max_memory, message);
    if (!error) {
        v->grid = fxs_allocate(NULL, v->cells, sizeof *v->grid);
        v->open = o->closed ? fxs_allocate_zeroed(NULL, v->cells, 1) : NULL;
        if (!v->grid || (o->closed && !v->open))
            error = fxs_fail_memory(message, NULL, 9 * (uint64_t)v->cells);
    }
    if (error) {
        fxs_volume_free(v);
        return error;
    }
    for (uint32_t i = 0; i < v->cells; i++)
        v->grid[i] = FXS_NO_BRICK;
    *volume = v;
    return 0;
}

void fxs_volume_free(fxs_volume *v)
{
    if (!v)
        return;
    fxs_release(NULL, v->grid);
    fxs_release(NULL, v->open);
    fxs_release(NULL, v->places);
    fxs_release(NULL, v->bricks);
    fxs_release(NULL, v);
}

/* ---- A view ------------------------------------------------------------------------------------------------------ */

typedef struct plane {
    double x, y, z, d;              /* x X + y Y + z Z + d is the distance from the plane, inside above 0 */
} plane;

/* The range of depths in a tile of pixels. */
typedef struct tile {
    uint32_t nearest, farthest;
} tile;

/* A view, in the coordinates of the grid. */
typedef struct sight {
    fxs_volume *volume;
    const fxs_depth_picture *picture;
    int width, height, is_flat;     /* is_flat: orthographic */
    double fx, fy, cx, cy, near, unit;
    double zero[3], axes[3][3];     /* a voxel (x, y, z) has the camera coordinates zero + x axes[0] + ... */
    double to_q15, to_weight, truncation;
    double behind, hidden;          /* signed distances below which a sample weighs less, and nothing */
    plane sides[4];
    tile *tiles;
    int tiles_across;
} sight;

static plane plane_of(double x, double y, double z, double d)
{
    const double length = sqrt(x * x + y * y + z * z);
    return (plane){x / length, y / length, z / length, d / length};
}

static int sight_of(sight *s, fxs_volume *v, const fxs_depth_picture *picture, fxs_message *message)
{
    const fxs_view *view = picture->view;
    if (view->width < 2 || view->height < 2 || view->width > FXS_MAX_SIZE || view->height > FXS_MAX_SIZE ||
        !(view->fx > 0) || !(view->fy > 0) || picture->depth_bits < 1 || picture->depth_bits > 28)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "view %s: wrong size, focal length or depth", view->name);
    *s = (sight){.volume = v, .picture = picture, .width = view->width, .height = view->height, .fx = view->fx,
                 .fy = view->fy, .cx = view->cx, .cy = view->cy, .near = view->near > 0 ? view->near : 0.2};
    s->is_flat = view->projection == FXS_ORTHOGRAPHIC;
    s->unit = 1.0 / (double)(1 << picture->depth_bits);
    for (int a = 0; a < 3; a++)
        for (int k = 0; k < 3; k++) {
            s->zero[a] += view->rotation[3 * a + k] * (v->origin[k] - view->position[k]);
            s->axes[k][a] = view->rotation[3 * a + k] * v->step;
        }
    s->truncation = v->options.truncation * v->step;
    s->to_q15 = OUTSIDE_Q15 / s->truncation;
    s->hidden = -s->truncation / 2;
    s->behind = v->options.truncation > 2 * BEHIND ? -BEHIND * v->step : s->hidden;
    s->to_weight = s->behind > s->hidden ? FXS_WHOLE / (s->behind - s->hidden) : 0;
    const double right = s->width - s->cx, down = s->height - s->cy, flat = s->is_flat;
    s->sides[0] = plane_of(s->fx, 0, s->cx * (1 - flat), s->cx * flat);
    s->sides[1] = plane_of(-s->fx, 0, right * (1 - flat), right * flat);
    s->sides[2] = plane_of(0, s->fy, s->cy * (1 - flat), s->cy * flat);
    s->sides[3] = plane_of(0, -s->fy, down * (1 - flat), down * flat);
    return 0;
}

/* A voxel, or the voxels of a brick, as a view sees them. */
typedef struct sample {
    double at[3];                   /* the place in the camera's coordinates */
    double growth;                  /* side of the voxel along the ray from the middle, relative to one in the box */
    double radius;                  /* of a brick */
} sample;

static void place_of(const sight *s, const double place[3], double at[3])
{
    for (int a = 0; a < 3; a++)
        at[a] = s->zero[a] + place[0] * s->axes[0][a] + place[1] * s->axes[1][a] + place[2] * s->axes[2][a];
}

/* Finds where a place of the grid is. */
static void find_place(const sight *s, const double of_grid[3], sample *to)
{
    const fxs_volume *v = s->volume;
    double place[3] = {of_grid[0], of_grid[1], of_grid[2]};
    int64_t at[3];
    to->growth = 1;
    if (v->half_q16) {
        for (int i = 0; i < 3; i++)
            at[i] = (int64_t)(place[i] * 65536) - v->middle_q16;
        const double norm = (double)fxs_expand(at, v->half_q16) / v->half_q16;
        to->growth = norm * norm;
        for (int i = 0; i < 3; i++)
            place[i] = (double)(at[i] + v->middle_q16) / 65536;
    }
    place_of(s, place, to->at);
}

/* Finds a ball around the voxels of a brick, and their largest growth. Expanded, the corners are the outermost places
   on each axis: a coordinate grows with itself and with the norm. */
static void find_brick(const sight *s, const double middle[3], sample *brick)
{
    double most[3] = {0}, growth;
    find_place(s, middle, brick);
    brick->radius = RADIUS * s->volume->step;
    growth = brick->growth;
    for (int corner = 0; corner < 8 && s->volume->half_q16; corner++) {
        sample c;
        double place[3];
        for (int i = 0; i < 3; i++)
            place[i] = middle[i] + (corner >> i & 1 ? TO_CORNER : -TO_CORNER);
        find_place(s, place, &c);
        for (int i = 0; i < 3; i++)
            most[i] = fmax(most[i], fabs(c.at[i] - brick->at[i]));
        growth = c.growth > growth ? c.growth : growth;
    }
    if (growth > 1)
        brick->radius = 1.01 * sqrt(most[0] * most[0] + most[1] * most[1] + most[2] * most[2]);
    brick->growth = growth;
}

/* ---- Marking ----------------------------------------------------------------------------------------------------- */

/* Marks the cells of a box of 2 * margin voxels around a place of the grid. */
static void mark_around(fxs_volume *v, const double place[3], double margin)
{
    uint32_t from[3], to[3];
    for (int i = 0; i < 3; i++) {
        const double low = (place[i] - margin) / FXS_BRICK, high = (place[i] + margin) / FXS_BRICK;
        const double last = v->size[i] - 2.0;
        if (!(high >= 1 && low < last + 1))
            return;
        from[i] = low > 1 ? (uint32_t)low : 1;
        to[i] = high < last ? (uint32_t)high : v->size[i] - 2;
    }
    for (uint32_t z = from[2]; z <= to[2]; z++)
        for (uint32_t y = from[1]; y <= to[1]; y++)
            for (uint32_t x = from[0]; x <= to[0]; x++)
                FXS_SHARED_WRITE(v->grid[(z * v->size[1] + y) * v->size[0] + x], 0);
}

/* Contracts a place of the grid, if the scene is unbounded. Returns 0 if it is too far away. */
static int contract_place(const fxs_volume *v, double place[3])
{
    int64_t at[3];
    if (!v->half_q16)
        return 1;
    for (int i = 0; i < 3; i++) {
        if (!(fabs(place[i]) < CONTRACTED_MOST))
            return 0;
        at[i] = (int64_t)(place[i] * 65536) - v->middle_q16;
    }
    fxs_contract(at, v->half_q16);
    for (int i = 0; i < 3; i++)
        place[i] = (double)(at[i] + v->middle_q16) / 65536;
    return 1;
}

static void mark_pixel(const sight *s, int x, int y)
{
    const uint32_t depth = s->picture->depths[(size_t)y * (size_t)s->width + (size_t)x];
    const double step = s->volume->step, z = depth * s->unit, wide = s->is_flat ? 1 : z;
    double place[3] = {0};
    if (depth == FXS_NOTHING)
        return;
    const double at[3] = {(x + 0.5 - s->cx) / s->fx * wide - s->zero[0], (y + 0.5 - s->cy) / s->fy * wide - s->zero[1],
                          z - s->zero[2]};
    for (int i = 0; i < 3; i++)                 /* the axes are orthogonal, with a length of `step` */
        place[i] = (at[0] * s->axes[i][0] + at[1] * s->axes[i][1] + at[2] * s->axes[i][2]) / (step * step);
    const double pixel = wide / (s->fx < s->fy ? s->fx : s->fy) / step;
    if (contract_place(s->volume, place))
        mark_around(s->volume, place, NEAR_SURFACE + (pixel < 2 * FXS_BRICK ? pixel / 2 : FXS_BRICK));
}

static void mark_rows(void *argument, uint32_t job)
{
    const sight *s = argument;
    const int first = (int)job * ROWS_OF_JOB, end = first + ROWS_OF_JOB;
    for (int y = first; y < end && y < s->height; y++)
        for (int x = 0; x < s->width; x++)
            mark_pixel(s, x, y);
}

int fxs_volume_mark(fxs_volume *v, const fxs_depth_picture *picture, fxs_message *message)
{
    sight s;
    FXS_TRY(sight_of(&s, v, picture, message));
    fxs_volume_run(v, mark_rows, &s, (uint32_t)(s.height + ROWS_OF_JOB - 1) / ROWS_OF_JOB);
    return 0;
}

static uint64_t bytes_of(const fxs_volume *v, uint32_t bricks)
{
    return 9 * (uint64_t)v->cells + bricks * (uint64_t)(sizeof(fxs_brick) + MESH_BYTES_OF_BRICK + SITE_BYTES);
}

int fxs_volume_reserve(fxs_volume *v, fxs_volume_size *size, fxs_message *message)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < v->cells; i++)
        count += v->grid[i] != FXS_NO_BRICK;
    const uint64_t bytes = bytes_of(v, count);
    if (size)
        *size = (fxs_volume_size){.bricks = count, .bytes = bytes, .voxel = v->step};
    FXS_TRY(fxs_surface_check(bytes, v->options.max_memory, message));
    v->places = fxs_allocate(NULL, (size_t)count + 1, sizeof *v->places);
    v->bricks = fxs_allocate_zeroed(NULL, (size_t)count + 1, sizeof *v->bricks);
    if (!v->places || !v->bricks)
        return fxs_fail_memory(message, NULL, bytes);
    for (uint32_t i = 0; i < v->cells; i++)
        if (v->grid[i] != FXS_NO_BRICK) {
            v->places[v->brick_count] = i;
            v->grid[i] = v->brick_count++;
        }
    return 0;
}

/* ---- Adding ------------------------------------------------------------------------------------------------------ */

static void measure_tiles(void *argument, uint32_t row)
{
    const sight *s = argument;
    const int first = (int)row * TILE;
    for (int i = 0; i < s->tiles_across; i++)
        s->tiles[(int)row * s->tiles_across + i] = (tile){FXS_NOTHING, 0};
    for (int y = first; y < first + TILE && y < s->height; y++)
        for (int x = 0; x < s->width; x++) {
            tile *t = &s->tiles[(int)row * s->tiles_across + x / TILE];
            const uint32_t depth = s->picture->depths[(size_t)y * (size_t)s->width + (size_t)x];
            t->nearest = depth < t->nearest ? depth : t->nearest;
            t->farthest = depth > t->farthest ? depth : t->farthest;
        }
}

/* Returns the depth at a place of the picture: between the middles of four pixels, if they are on one surface; else of
   the nearest pixel. A negative depth: nothing is there. */
static double depth_at(const sight *s, double u, double v, double growth)
{
    const int x = (int)u, y = (int)v;
    int left = (int)(u + 0.5) - 1, top = (int)(v + 0.5) - 1;
    left = left < 0 ? 0 : left > s->width - 2 ? s->width - 2 : left;
    top = top < 0 ? 0 : top > s->height - 2 ? s->height - 2 : top;
    const uint32_t *d = s->picture->depths + (size_t)top * (size_t)s->width + (size_t)left, *e = d + s->width;
    const uint32_t low0 = d[0] < d[1] ? d[0] : d[1], low1 = e[0] < e[1] ? e[0] : e[1];
    const uint32_t high0 = d[0] > d[1] ? d[0] : d[1], high1 = e[0] > e[1] ? e[0] : e[1];
    const uint32_t low = low0 < low1 ? low0 : low1, high = high0 > high1 ? high0 : high1;
    if ((high - low) * s->unit < s->truncation * growth && high != FXS_NOTHING) {
        double across = u - 0.5 - left, along = v - 0.5 - top;
        across = across < 0 ? 0 : across > 1 ? 1 : across;
        along = along < 0 ? 0 : along > 1 ? 1 : along;
        const double above = d[0] + across * ((double)d[1] - d[0]), below = e[0] + across * ((double)e[1] - e[0]);
        return (above + along * (below - above)) * s->unit;
    }
    const uint32_t depth = s->picture->depths[(size_t)y * (size_t)s->width + (size_t)x];
    return depth == FXS_NOTHING ? -1 : depth * s->unit;
}

/* Adds a pixel's colour, with its coverage divided out. */
static void add_colour(const sight *s, fxs_brick *brick, uint32_t voxel, int x, int y)
{
    const uint8_t *c = s->picture->colours + 4 * ((size_t)y * (size_t)s->width + (size_t)x);
    const uint32_t coverage = c[3];
    if (!coverage)
        return;
    for (int i = 0; i < 3; i++) {
        const uint32_t value = (255u * c[i] + coverage / 2) / coverage;
        brick->colour[voxel][i] += value < 255 ? value : 255;
    }
    brick->coloured[voxel]++;
}

/* Adds the distance of a voxel from the surface, in units in which voxels have the size of those in the box. */
static void add_voxel(const sight *s, fxs_brick *brick, uint32_t voxel, const sample *of)
{
    const double *at = of->at, scale = s->is_flat ? 1 : 1 / at[2];
    const double u = s->fx * at[0] * scale + s->cx, v = s->fy * at[1] * scale + s->cy;
    if (!(at[2] > s->near) || !(u >= 0 && u < s->width && v >= 0 && v < s->height))
        return;
    const double depth = depth_at(s, u, v, of->growth), distance = (depth - at[2]) / of->growth;
    if (depth < 0 || distance >= s->truncation) {
        brick->sum_q15[voxel] += FXS_WHOLE * OUTSIDE_Q15;
        brick->weight[voxel] += FXS_WHOLE;
    } else if (distance > s->hidden) {
        const int32_t weight = distance < s->behind ? (int32_t)((distance - s->hidden) * s->to_weight) : FXS_WHOLE;
        brick->sum_q15[voxel] += weight * (int32_t)fxs_floor(distance * s->to_q15 + 0.5);
        brick->weight[voxel] = (uint16_t)(brick->weight[voxel] + weight);
        if (fabs(distance) <= COLOURED * s->volume->step)
            add_colour(s, brick, voxel, (int)u, (int)v);
    }
}

/* Finds the range of pixels along an axis that a ball covers. */
static void cover(double middle, double depth, double radius, double focal, double centre, int is_flat, int size,
                  int range[2])
{
    const double near = is_flat ? 1 : depth - radius, far = is_flat ? 1 : depth + radius;
    const double low = middle - radius, high = middle + radius;
    const double from = focal * (low / (low < 0 ? near : far)) + centre - 1;
    const double to = focal * (high / (high < 0 ? far : near)) + centre + 1;
    range[0] = from < -1 ? -1 : from > size ? size : (int)fxs_floor(from);
    range[1] = to < -1 ? -1 : to > size ? size : (int)fxs_floor(to);
}

enum brick_sight { NOT_SEEN, SEEN, ALL_OUTSIDE };

/* Finds out whether a view sees a part of a brick, or all of it before the surface. */
static enum brick_sight look_at_brick(const sight *s, const sample *brick)
{
    const double *at = brick->at, radius = brick->radius;
    int across[2], along[2];
    uint32_t nearest = FXS_NOTHING, farthest = 0;
    for (int i = 0; i < 4; i++) {
        const plane *p = &s->sides[i];
        if (p->x * at[0] + p->y * at[1] + p->z * at[2] + p->d < -radius)
            return NOT_SEEN;
    }
    if (at[2] + radius < s->near)
        return NOT_SEEN;
    if (at[2] - radius <= s->near)
        return SEEN;
    cover(at[0], at[2], radius, s->fx, s->cx, s->is_flat, s->width, across);
    cover(at[1], at[2], radius, s->fy, s->cy, s->is_flat, s->height, along);
    const int is_whole = across[0] >= 0 && along[0] >= 0 && across[1] < s->width && along[1] < s->height;
    for (int y = along[0] < 0 ? 0 : along[0] / TILE; y <= along[1] / TILE && y * TILE < s->height; y++)
        for (int x = across[0] < 0 ? 0 : across[0] / TILE; x <= across[1] / TILE && x < s->tiles_across; x++) {
            const tile *t = &s->tiles[y * s->tiles_across + x];
            nearest = t->nearest < nearest ? t->nearest : nearest;
            farthest = t->farthest > farthest ? t->farthest : farthest;
        }
    if (farthest != FXS_NOTHING && farthest * s->unit - (at[2] - radius) < s->hidden * brick->growth)
        return NOT_SEEN;
    const int is_outside = nearest == FXS_NOTHING ||
                           nearest * s->unit - (at[2] + radius) >= s->truncation * brick->growth;
    return is_whole && is_outside ? ALL_OUTSIDE : SEEN;
}

static void add_all_outside(fxs_brick *brick)
{
    for (int i = 0; i < FXS_BRICK_VOXELS; i++) {
        brick->sum_q15[i] += FXS_WHOLE * OUTSIDE_Q15;
        brick->weight[i] += FXS_WHOLE;
    }
}

static void add_to_brick(const sight *s, uint32_t number)
{
    const fxs_volume *v = s->volume;
    const uint32_t cell = v->places[number];
    const double first[3] = {FXS_BRICK * (cell % v->size[0]), FXS_BRICK * (cell / v->size[0] % v->size[1]),
                             FXS_BRICK * (cell / v->size[0] / v->size[1])};
    const double middle[3] = {first[0] + 3.5, first[1] + 3.5, first[2] + 3.5};
    fxs_brick *brick = &v->bricks[number];
    sample at;
    find_brick(s, middle, &at);
    const enum brick_sight seen = look_at_brick(s, &at);
    if (seen == ALL_OUTSIDE)
        add_all_outside(brick);
    for (uint32_t i = 0; i < FXS_BRICK_VOXELS && seen == SEEN; i++) {
        const double voxel[3] = {first[0] + i % FXS_BRICK, first[1] + i / FXS_BRICK % FXS_BRICK,
                                 first[2] + i / FXS_BRICK / FXS_BRICK};
        find_place(s, voxel, &at);
        add_voxel(s, brick, i, &at);
    }
}

static void add_bricks(void *argument, uint32_t job)
{
    const sight *s = argument;
    const uint32_t first = job * BRICKS_OF_JOB, count = s->volume->brick_count;
    for (uint32_t i = first; i < count && i < first + BRICKS_OF_JOB; i++)
        add_to_brick(s, i);
}

/* Finds cells without a brick that a view sees through. */
static void open_cells(void *argument, uint32_t job)
{
    const sight *s = argument;
    fxs_volume *v = s->volume;
    const uint32_t first = job * CELLS_OF_JOB;
    for (uint32_t i = first; i < v->cells && i < first + CELLS_OF_JOB; i++) {
        const double middle[3] = {FXS_BRICK * (i % v->size[0]) + 3.5, FXS_BRICK * (i / v->size[0] % v->size[1]) + 3.5,
                                  FXS_BRICK * (i / v->size[0] / v->size[1]) + 3.5};
        sample cell;
        if (v->grid[i] != FXS_NO_BRICK || v->open[i])
            continue;
        find_place(s, middle, &cell);
        const double *at = cell.at;
        const double scale = s->is_flat ? 1 : 1 / at[2];
        const double x = s->fx * at[0] * scale + s->cx, y = s->fy * at[1] * scale + s->cy;
        if (!(at[2] > s->near) || !(x >= 0 && x < s->width && y >= 0 && y < s->height))
            continue;
        const double depth = depth_at(s, x, y, cell.growth);
        v->open[i] = depth < 0 || depth - at[2] > OPEN * v->step * cell.growth;
    }
}

int fxs_volume_add(fxs_volume *v, const fxs_depth_picture *picture, fxs_message *message)
{
    sight s;
    FXS_TRY(sight_of(&s, v, picture, message));
    if (!v->bricks || v->views == FXS_VOLUME_VIEWS)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "a volume without bricks, or more than %u views",
                           FXS_VOLUME_VIEWS);
    const int down = (s.height + TILE - 1) / TILE;
    s.tiles_across = (s.width + TILE - 1) / TILE;
    s.tiles = fxs_allocate(NULL, (size_t)(down * s.tiles_across), sizeof *s.tiles);
    if (!s.tiles)
        return fxs_fail_memory(message, NULL, 0);
    v->views++;
    fxs_volume_run(v, measure_tiles, &s, (uint32_t)down);
    fxs_volume_run(v, add_bricks, &s, (v->brick_count + BRICKS_OF_JOB - 1) / BRICKS_OF_JOB);
    if (v->open)
        fxs_volume_run(v, open_cells, &s, (v->cells + CELLS_OF_JOB - 1) / CELLS_OF_JOB);
    fxs_release(NULL, s.tiles);
    return 0;
}
