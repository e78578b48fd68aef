/* Finds one thing in a scene without cameras, in four passes over the Gaussians. The first pass finds the middle of the
   small opaque Gaussians. The second fills a grid about the middle with the area that the Gaussians cover, and fits a
   plane to the widest level layer: the ground. The third fills the grid again, turned until the ground is level. The
   thing is a set of full cells above the ground that hang together, and the cells around them. If the set reaches too
   far, as along a wall, it consists of cells with many small Gaussians. The fourth pass keeps the Gaussians in it. */
#include "thing_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>
#include "src/gaussian/attributes.h"

/* Lengths in cells. A cell is a tenth of the reach, the radius about the middle with half of the small Gaussians of
   twice this radius. */
enum { REACH = 10, SIDE = 18 * REACH, COLUMNS = SIDE * SIDE, CELLS = SIDE * COLUMNS, NEAR = 3 * REACH,
       LONGEST = 45, TALL = 8, RING = 5 };
enum { POINTS = 65536, LEAST_POINTS = 64, ROUNDS = 12, ACROSS = 24 };
enum { FULL = 64 };                  /* least covered area of a full cell, relative to a side of the cell, Q8 */
enum { SEEN = 1, THING = 2, KEPT = 4 };
#define ABOVE 2.5                    /* least height above the ground of the thing; beside it and at its foot less */
#define FOOT 1.5
#define EDGE 0.5
#define ENDS 1.5                     /* sigmas from a Gaussian's centre to its ends */

typedef struct cell {
    uint16_t area, level;            /* area covered by Gaussians, and by flat level ones, Q8 */
    uint16_t fine;                   /* number of small opaque Gaussians */
    uint16_t marks;
} cell;

struct fxs_thing_grid {
    cell cells[CELLS];
    uint32_t queue[CELLS];
    float points[POINTS][5];         /* sample of Gaussians: centre, log of the area, opacity */
    float values[POINTS];
    uint8_t inner[COLUMNS], outer[COLUMNS], ground[COLUMNS];
    uint32_t count;
    double fine;                     /* least number of small Gaussians in a cell of the thing */
};

typedef struct plane {
    double x, z, at;                 /* y = x * (cell's x) + z * (cell's z) + at; y points down */
} plane;

static int ascending(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static float median(float *values, uint32_t count)
{
    qsort(values, count, sizeof *values, ascending);
    return values[count / 2];
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void normalise(double v[3])
{
    const double length = sqrt(dot(v, v));
    for (int i = 0; i < 3; i++)
        v[i] /= length;
}

/* Makes the frame of the grid for an up direction. Of the axes x and z, the one farther from it is kept
   in direction, as far as possible. */
static void set_frame(fxs_thing *t, const double up[3])
{
    double (*f)[3] = t->frame;
    const int keeps = fabs(up[0]) < fabs(up[2]) ? 0 : 2, other = 2 - keeps;
    const double *a = f[(other + 1) % 3], *b = f[(other + 2) % 3];
    for (int i = 0; i < 3; i++)
        f[1][i] = -up[i];
    normalise(f[1]);
    for (int i = 0; i < 3; i++)
        f[keeps][i] = (i == keeps) - f[1][keeps] * f[1][i];
    normalise(f[keeps]);
    for (int i = 0; i < 3; i++)
        f[other][i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

int fxs_thing_init(fxs_thing *t, uint64_t count, const double up[3], const fxs_allocator *allocator,
                   fxs_message *message)
{
    static const double usual[3] = {0, -1, 0};
    set_frame(t, dot(up, up) > 0 ? up : usual);
    t->step = count / POINTS + 1;
    t->grid = fxs_allocate_zeroed(allocator, 1, sizeof *t->grid);
    return t->grid ? 0 : fxs_fail_memory(message, NULL, sizeof *t->grid);
}

void fxs_thing_free(fxs_thing *t, const fxs_allocator *allocator)
{
    fxs_release(allocator, t->grid);
}

/* ---- The middle -------------------------------------------------------------------------------------------------- */

static int thinnest(const fxs_gaussian *g)
{
    const float *s = g->scale;
    return s[0] <= s[1] && s[0] <= s[2] ? 0 : s[1] <= s[2] ? 1 : 2;
}

static void sample(fxs_thing *t, const fxs_gaussian *g)
{
    const int thin = thinnest(g);
    if (t->next++ % t->step || t->grid->count == POINTS)
        return;
    float *p = t->grid->points[t->grid->count++];
    memcpy(p, g->position, sizeof g->position);
    p[3] = g->scale[(thin + 1) % 3] + g->scale[(thin + 2) % 3];
    p[4] = (float)fxs_opacity_of_logit(g->opacity);
}

static double distance(const float *p, const double middle[3])
{
    const double d[3] = {p[0] - middle[0], p[1] - middle[1], p[2] - middle[2]};
    return sqrt(dot(d, d));
}

/* Returns the median coordinate (axis 3: distance from the middle) of the small opaque points within `reach`. */
static double median_within(fxs_thing *t, float small, double reach, int axis, uint32_t *count)
{
    fxs_thing_grid *g = t->grid;
    *count = 0;
    for (uint32_t i = 0; i < g->count; i++) {
        const float *p = g->points[i];
        if (p[3] <= small && p[4] >= 0.5f && distance(p, t->middle) <= reach)
            g->values[(*count)++] = axis < 3 ? p[axis] : (float)distance(p, t->middle);
    }
    return *count ? (double)median(g->values, *count) : 0;
}

static int find_middle(fxs_thing *t)
{
    fxs_thing_grid *g = t->grid;
    double reach = INFINITY;
    uint32_t count = 0;
    for (uint32_t i = 0; i < g->count; i++)
        g->values[i] = g->points[i][3];
    const float small = g->count ? median(g->values, g->count) : 0;
    for (int round = 0; round < ROUNDS; round++) {
        double middle[3];
        for (int i = 0; i < 3; i++)
            middle[i] = median_within(t, small, 2 * reach, i, &count);
        if (count < LEAST_POINTS)
            return 0;
        memcpy(t->middle, middle, sizeof middle);
        reach = median_within(t, small, 2 * reach, 3, &count);
    }
    t->cell = reach / REACH;
    return t->cell > 0;
}

/* ---- The grid ---------------------------------------------------------------------------------------------------- */

static int cell_at(const fxs_thing *t, const double place[3])
{
    const double d[3] = {place[0] - t->middle[0], place[1] - t->middle[1], place[2] - t->middle[2]};
    int at = 0;
    for (int i = 0; i < 3; i++) {
        const double x = floor(dot(t->frame[i], d) / t->cell + SIDE / 2.0);
        if (!(x >= 1 && x < SIDE - 1))
            return -1;
        at = at * SIDE + (int)x;
    }
    return at;
}

static int x_of(int at)
{
    return at / COLUMNS;
}

static int y_of(int at)
{
    return at / SIDE % SIDE;
}

static int z_of(int at)
{
    return at % SIDE;
}

static int column_of(int at)
{
    return x_of(at) * SIDE + z_of(at);
}

static int neighbour(int at, int k)
{
    return at + (k % 3 - 1) * COLUMNS + (k / 3 % 3 - 1) * SIDE + k / 9 - 1;
}

typedef struct ellipse {
    double axes[2][3];               /* from the centre to the ends of the two longest axes, scene units */
    double sigmas[2];                /* cells */
    int level;
} ellipse;

static ellipse ellipse_of(const fxs_thing *t, const fxs_gaussian *g)
{
    const float *q = g->rotation, *s = g->scale;
    const int thin = thinnest(g), a = (thin + 1) % 3, b = (thin + 2) % 3;
    double rows[3][3], normal[3];
    ellipse e;
    fxs_rotation_matrix(rows, q[0], q[1], q[2], q[3]);
    for (int k = 0; k < 2; k++)
        e.sigmas[k] = fxs_exp(fmin(s[k ? b : a], 40)) / t->cell;
    for (int i = 0; i < 3; i++) {
        normal[i] = rows[i][thin];
        e.axes[0][i] = ENDS * e.sigmas[0] * t->cell * rows[i][a];
        e.axes[1][i] = ENDS * e.sigmas[1] * t->cell * rows[i][b];
    }
    e.level = fabs(dot(normal, t->frame[1])) > 0.85 && s[thin] < fminf(s[a], s[b]) - 0.7f;
    return e;
}

static void add(uint16_t *sum, double part)
{
    *sum = (uint16_t)fmin(*sum + floor(part), UINT16_MAX);
}

/* Adds the area 2 pi opacity sigma sigma of a Gaussian to the cells along its two longest axes. */
static void fill(fxs_thing *t, const fxs_gaussian *g)
{
    const ellipse e = ellipse_of(t, g);
    const double opacity = fxs_opacity_of_logit(g->opacity);
    double place[3] = {g->position[0], g->position[1], g->position[2]};
    int at = cell_at(t, place), n[2];
    if (at >= 0 && opacity > 0.25 && fmax(e.sigmas[0], e.sigmas[1]) < 1)
        add(&t->grid->cells[at].fine, 1);
    for (int k = 0; k < 2; k++)
        n[k] = (int)fmin(2 * ENDS * e.sigmas[k], ACROSS - 1) + 1;
    const double share = 256 * 6.283185307179586 * opacity * e.sigmas[0] * e.sigmas[1] / (n[0] * n[1]);
    for (int k = 0; k < n[0] * n[1]; k++) {
        for (int i = 0; i < 3; i++)
            place[i] = g->position[i] + e.axes[0][i] * ((k % n[0] * 2 + 1.0) / n[0] - 1) +
                       e.axes[1][i] * ((k / n[0] * 2 + 1.0) / n[1] - 1);
        if ((at = cell_at(t, place)) < 0)
            continue;
        add(&t->grid->cells[at].area, share);
        add(&t->grid->cells[at].level, e.level ? share : 0);
    }
}

static int is_full(const fxs_thing *t, int at)
{
    return t->grid->cells[at].area >= FULL;
}

/* ---- The ground -------------------------------------------------------------------------------------------------- */

static double height_of(const plane *p, int at)
{
    return p->x * x_of(at) + p->z * z_of(at) + p->at - y_of(at);
}

static int is_level_near(const fxs_thing *t, int at)
{
    const int x = x_of(at) - SIDE / 2, z = z_of(at) - SIDE / 2;
    return t->grid->cells[at].level >= FULL && x * x + z * z < NEAR * NEAR;
}

static void find_layer(const fxs_thing *t, plane *p)
{
    int count[SIDE] = {0}, best = 1;
    for (int at = 0; at < CELLS; at++)
        count[y_of(at)] += is_level_near(t, at);
    for (int y = 1; y < SIDE - 1; y++)
        if (count[y - 1] + 2 * count[y] + count[y + 1] > count[best - 1] + 2 * count[best] + count[best + 1])
            best = y;
    *p = (plane){0, 0, best};
}

/* Fits the plane to the level cells at most `within` from it, by least squares. */
static void fit_plane(const fxs_thing *t, plane *p, double within)
{
    double n = 0, x = 0, z = 0, y = 0, xx = 0, xz = 0, zz = 0, xy = 0, zy = 0;
    for (int at = 0; at < CELLS; at++)
        if (is_level_near(t, at) && fabs(height_of(p, at)) <= within) {
            const double u = x_of(at), v = z_of(at), w = y_of(at);
            n++, x += u, z += v, y += w;
            xx += u * u, xz += u * v, zz += v * v, xy += u * w, zy += v * w;
        }
    if (n < 3)
        return;
    xx -= x * x / n, xz -= x * z / n, zz -= z * z / n, xy -= x * y / n, zy -= z * y / n;
    const double determinant = xx * zz - xz * xz;
    if (!(determinant > 0))
        return;
    p->x = (xy * zz - zy * xz) / determinant;
    p->z = (zy * xx - xy * xz) / determinant;
    p->at = (y - p->x * x - p->z * z) / n;
}

static void find_plane(const fxs_thing *t, plane *p)
{
    static const double within[] = {5, 5, 4, 4, 3, 3, 2, 2};
    find_layer(t, p);
    for (size_t i = 0; i < sizeof within / sizeof *within; i++)
        fit_plane(t, p, within[i]);
}

/* ---- The thing --------------------------------------------------------------------------------------------------- */

static int is_middle(int at)
{
    const int x = x_of(at) - SIDE / 2, y = y_of(at) - SIDE / 2, z = z_of(at) - SIDE / 2;
    return x * x + y * y + z * z < REACH * REACH;
}

/* True if a full cell may belong to the thing, without a mark. `ground` is null if there is none. */
static int is_free(const fxs_thing *t, int at, const plane *ground, double above, int mark)
{
    const cell *c = &t->grid->cells[at];
    return is_full(t, at) && c->fine >= t->grid->fine && !(c->marks & mark) &&
           !(ground && height_of(ground, at) <= above);
}

/* Marks the cells that hang together with the `count` cells in the queue, in the columns `columns` (null: all). Returns
   the number of cells then in the queue, and their area in the middle. */
static uint32_t spread(fxs_thing *t, uint32_t count, const plane *ground, double above, int mark,
                       const uint8_t *columns, double *area)
{
    fxs_thing_grid *g = t->grid;
    *area = 0;
    for (uint32_t i = 0; i < count; i++) {
        const int at = (int)g->queue[i];
        g->cells[at].marks |= (uint16_t)mark;
        *area += is_middle(at) ? g->cells[at].area : 0;
        for (int k = 0; k < 27; k++) {
            const int next = neighbour(at, k);
            if (!is_free(t, next, ground, above, mark) || (columns && !columns[column_of(next)]))
                continue;
            g->cells[next].marks |= (uint16_t)mark;
            g->queue[count++] = (uint32_t)next;
        }
    }
    return count;
}

/* Finds the set of cells with the most area in the middle. Returns the number of its cells. */
static uint32_t find_body(fxs_thing *t, const plane *ground)
{
    fxs_thing_grid *g = t->grid;
    double area, most = 0;
    uint32_t best = 0;
    for (int at = 0; at < CELLS; at++)
        g->cells[at].marks = 0;
    for (int at = 0; at < CELLS; at++)
        if (is_middle(at) && is_free(t, at, ground, ABOVE, SEEN)) {
            g->queue[0] = (uint32_t)at;
            spread(t, 1, ground, ABOVE, SEEN, NULL, &area);
            best = area > most ? (uint32_t)at : best;
            most = fmax(area, most);
        }
    g->queue[0] = best;
    return best ? spread(t, 1, ground, ABOVE, THING, NULL, &area) : 0;
}

/* True if the set of cells in the queue is long in two directions. */
static int is_long(const fxs_thing *t, uint32_t count)
{
    int low[3] = {SIDE, SIDE, SIDE}, high[3] = {0}, is = 0;
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            const int at = (int)t->grid->queue[i], x = k == 0 ? x_of(at) : k == 1 ? y_of(at) : z_of(at);
            low[k] = x < low[k] ? x : low[k];
            high[k] = x > high[k] ? x : high[k];
        }
    for (int k = 0; k < 3; k++)
        is += high[k] - low[k] > LONGEST;
    return is > 1;
}

/* Marks the columns of the set of cells, and `more` columns to each side. */
static void find_columns(const fxs_thing *t, uint32_t count, int more, uint8_t *columns)
{
    memset(columns, 0, COLUMNS);
    for (uint32_t i = 0; i < count; i++) {
        const int at = (int)t->grid->queue[i], x = x_of(at), z = z_of(at);
        for (int u = x - more; u <= x + more; u++)
            for (int v = z - more; v <= z + more; v++)
                if (u >= 0 && v >= 0 && u < SIDE && v < SIDE)
                    columns[u * SIDE + v] = 1;
    }
}

/* True if the plane is a ground: half of the ring around the set of cells lies on it, little lies below it, and the set
   is tall. */
static int is_ground(fxs_thing *t, const plane *p, uint32_t count)
{
    fxs_thing_grid *g = t->grid;
    double full = 0, below = 0, top = 0;
    int ring = 0, ground = 0;
    memset(g->ground, 0, sizeof g->ground);
    for (int at = 0; at < CELLS; at++) {
        const int x = x_of(at) - SIDE / 2, z = z_of(at) - SIDE / 2;
        if (!is_full(t, at) || x * x + z * z >= NEAR * NEAR)
            continue;
        const double height = height_of(p, at);
        full++;
        below += height < -3;
        g->ground[column_of(at)] |= fabs(height) < 3;
    }
    for (uint32_t i = 0; i < count; i++)
        top = fmax(top, height_of(p, (int)g->queue[i]));
    find_columns(t, count, 1, g->inner);
    find_columns(t, count, RING, g->outer);
    for (int i = 0; i < COLUMNS; i++) {
        ring += g->outer[i] && !g->inner[i];
        ground += g->outer[i] && !g->inner[i] && g->ground[i];
    }
    return top >= TALL && below < 0.4 * full && 2 * ground > ring;
}

/* Finds the thing's cells as a set in the queue, above the ground if there is one, of all full cells or of those with
   many small Gaussians. Returns their number; 0: none stands out. */
static uint32_t find_cells(fxs_thing *t, plane *p, int *has_ground)
{
    fxs_thing_grid *g = t->grid;
    double fine = 0, full = 0;
    find_plane(t, p);
    g->fine = 0;
    uint32_t count = find_body(t, p);
    if (count && is_long(t, count)) {
        for (int at = 0; at < CELLS; at++)
            if (is_middle(at) && is_free(t, at, p, ABOVE, 0)) {
                fine += g->cells[at].fine;
                full++;
            }
        g->fine = fine / full / 4;
        count = find_body(t, p);
    }
    *has_ground = count && is_ground(t, p, count);
    if (*has_ground)
        return count;
    g->fine = 0;
    count = find_body(t, NULL);
    return is_long(t, count) ? 0 : count;
}

/* Sets the frame's up direction to the normal of the ground. */
static void level(fxs_thing *t, const plane *p)
{
    double up[3];
    for (int i = 0; i < 3; i++)
        up[i] = p->x * t->frame[0][i] - t->frame[1][i] + p->z * t->frame[2][i];
    set_frame(t, up);
}

static void mark_kept(fxs_thing *t, uint32_t count, const plane *ground)
{
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 27; k++) {
            const int next = neighbour((int)t->grid->queue[i], k);
            if (!ground || height_of(ground, next) > EDGE)
                t->grid->cells[next].marks |= KEPT;
        }
}

static int find_thing(fxs_thing *t, int is_last)
{
    fxs_thing_grid *g = t->grid;
    plane p;
    int has_ground;
    double area;
    uint32_t count = find_cells(t, &p, &has_ground);
    if (!is_last) {
        if (has_ground)
            level(t, &p);
        memset(g->cells, 0, sizeof g->cells);
        return 1;
    }
    if (!count)
        return 0;
    if (has_ground) {
        g->fine /= 2;
        find_columns(t, count, 1, g->inner);
        count = spread(t, count, &p, FOOT, THING, g->inner, &area);
    }
    mark_kept(t, count, has_ground ? &p : NULL);
    return 1;
}

static int is_kept(const fxs_thing *t, const double place[3])
{
    const int at = cell_at(t, place);
    return at >= 0 && t->grid->cells[at].marks & KEPT;
}

/* True if the centre of a Gaussian and the ends of its two longest axes lie in cells of the thing. */
static int is_of_thing(const fxs_thing *t, const fxs_gaussian *g)
{
    const ellipse e = ellipse_of(t, g);
    double place[3] = {g->position[0], g->position[1], g->position[2]};
    int kept = is_kept(t, place);
    for (int end = 0; end < 4 && kept; end++) {
        for (int i = 0; i < 3; i++)
            place[i] = g->position[i] + e.axes[end / 2][i] * (end % 2 ? 1 : -1);
        kept = is_kept(t, place);
    }
    return kept;
}

/* ---- The passes -------------------------------------------------------------------------------------------------- */

/* True if all numbers are finite and the Gaussian has a rotation: x - x is NaN if x is not finite. */
static int can_be_placed(const fxs_gaussian *g)
{
    float sum = g->opacity != g->opacity ? NAN : 0, square = 0;
    for (int i = 0; i < 3; i++)
        sum += g->position[i] - g->position[i] + (g->scale[i] - g->scale[i]);
    for (int i = 0; i < 4; i++)
        square += g->rotation[i] * g->rotation[i];
    return sum == 0 && square > 0 && isfinite(square);
}

int fxs_thing_take(fxs_thing *t, const fxs_gaussian *g)
{
    if (!can_be_placed(g))
        return t->pass == FXS_THING_KEEP;
    if (t->pass == FXS_THING_KEEP)
        return !is_of_thing(t, g);
    if (t->pass == FXS_THING_SAMPLE)
        sample(t, g);
    else
        fill(t, g);
    return 0;
}

int fxs_thing_next(fxs_thing *t, fxs_message *message)
{
    const int found = t->pass == FXS_THING_SAMPLE ? find_middle(t) : find_thing(t, t->pass == FXS_THING_FILL_LEVEL);
    t->pass++;
    return found ? 0 : fxs_fail_as(FXS_ERR_ARGUMENT, message, "no thing stands out from its surroundings");
}
