/* Moves a walker through voxels. Speed, steps, slides and ease are those of the page (port/web/viewer/walk.js), which
 * has no gravity, measures the floor in pictures of depths, and has a wider body.
 *
 * The body is a capsule from a step's height above the feet up to the eye. It is sampled at points a voxel apart. Each
 * step of the walk tries some directions. It takes the first one in which the body touches no more solid points than
 * before, and fits above the next floor. The floor is the mean of the middle half of the heights below the feet. The
 * eye rises to its height above the floor exponentially, and falls by gravity. */
#include <math.h>
#include <stdlib.h>

#include <fixsplat/collide.h>
#include "src/base/exponential.h"

/* Lengths are multiples of the walker's height. */
#define BODY (1 / 8.0)            /* radius of the capsule */
#define FOOT 0.12                  /* radius around the feet in which the height of the floor is measured */
#define STEP 0.25                  /* largest height of a step that is climbed */
#define STRIDE 0.05                /* longest single step of the walk */
#define EASE 10                    /* rate a second at which the eye approaches its height above the floor */
#define LAG 0.5                    /* largest distance that the eye lacks after a move */
#define GRAVITY 6                  /* heights a second, each second */
#define REST 1e-3                  /* smallest distance of the eye from its height */

enum { SAMPLES = 8, COLUMNS = (2 * SAMPLES + 1) * (2 * SAMPLES + 1), DEEP = 1 << 14, HALVES = 5, STEPS_MOST = 1000 };

/* Cosines and sines of the angles between the wanted direction and those that are tried: 0, 20, -20 to 80, -80
   degrees. */
static const double asides[9][2] = {{1, 0}, {0.93969262078590838, 0.34202014332566873},
    {0.93969262078590838, -0.34202014332566873}, {0.76604444311897804, 0.64278760968653933},
    {0.76604444311897804, -0.64278760968653933}, {0.5, 0.86602540378443865}, {0.5, -0.86602540378443865},
    {0.17364817766693035, 0.98480775301220806}, {0.17364817766693035, -0.98480775301220806}};

/* A walker with horizontal axes and the distance of sample points. */
typedef struct walk {
    fxs_walker *walker;
    const fxs_voxels *voxels;
    double right[3], ahead[3], spacing;
} walk;

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(double out[3], const double a[3], const double b[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static void add(double out[3], const double a[3], const double b[3], double times)
{
    for (int i = 0; i < 3; i++)
        out[i] = a[i] + times * b[i];
}

static walk begin(fxs_walker *w, const fxs_voxels *voxels)
{
    static const double x[3] = {1, 0, 0}, z[3] = {0, 0, 1};
    walk k = {.walker = w, .voxels = voxels};
    cross(k.right, w->up, fabs(w->up[0]) < 0.9 ? x : z);
    add(k.right, (double[3]){0, 0, 0}, k.right, 1 / sqrt(dot(k.right, k.right)));
    cross(k.ahead, w->up, k.right);
    k.spacing = fmin(fmax(fxs_voxels_describe(voxels)->voxel, BODY * w->height / SAMPLES), BODY * w->height);
    return k;
}

static int is_solid(const walk *k, const double at[3])
{
    const double size = fxs_voxels_describe(k->voxels)->voxel;
    int32_t cell[3];
    for (int i = 0; i < 3; i++)
        cell[i] = (int32_t)fmin(fmax(floor((i < 2 ? -at[i] : at[i]) / size), -0x1p30), 0x1p30);
    return fxs_voxels_solid(k->voxels, cell[0], cell[1], cell[2]);
}

/* Computes the point of column (i, j) around a place, at a height. */
static void column_at(double out[3], const walk *k, const double place[3], int i, int j, double height)
{
    add(out, place, k->right, i * k->spacing);
    add(out, out, k->ahead, j * k->spacing);
    add(out, out, k->walker->up, height - dot(place, k->walker->up));
}

/* Counts the solid points of a capsule around a place, at heights from `low` to `high`. */
static int stops(const walk *k, const double place[3], double low, double high)
{
    const double radius = BODY * k->walker->height;
    const int far = (int)(radius / k->spacing);
    int found = 0;
    for (int i = -far; i <= far; i++)
        for (int j = -far; j <= far; j++)
            for (double y = high; y >= low; y -= k->spacing) {
                const double aside = (i * i + j * j) * k->spacing * k->spacing, over = fmax(0, y - high + radius);
                double point[3];
                column_at(point, k, place, i, j, y);
                found += aside + over * over <= radius * radius && is_solid(k, point);
            }
    return found;
}

/* Finds the floor of a column below height `high`. Returns 0 if the column is solid there, or has no floor. */
static int floor_of(double *floor_, const walk *k, const double place[3], int i, int j, double high)
{
    double point[3], y = high, half = k->spacing / 2;
    int steps = 0;
    column_at(point, k, place, i, j, y);
    if (is_solid(k, point))
        return 0;
    for (; !is_solid(k, point) && steps < DEEP; steps++) {
        y -= k->spacing;
        column_at(point, k, place, i, j, y);
    }
    for (int n = 0; n < HALVES; n++, half /= 2) {
        column_at(point, k, place, i, j, y + half);
        y += is_solid(k, point) ? half : 0;
    }
    *floor_ = y + half;
    return steps < DEEP;
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Finds the height of the floor around a place below height `high`. Returns 0 if there is none. */
static int find_floor(double *found, const walk *k, const double place[3], double high)
{
    const double radius = FOOT * k->walker->height;
    const int far = (int)(radius / k->spacing);
    double list[COLUMNS], sum = 0;
    int count = 0;
    for (int i = -far; i <= far; i++)
        for (int j = -far; j <= far; j++)
            if ((i * i + j * j) * k->spacing * k->spacing <= radius * radius)
                count += floor_of(&list[count], k, place, i, j, high);
    if (!count)
        return 0;
    qsort(list, (size_t)count, sizeof *list, ascending);
    for (int i = count / 4; i < count - count / 4; i++)
        sum += list[i];
    *found = sum / (count - count / 4 * 2);
    return 1;
}

int fxs_walker_place(fxs_walker *w, const fxs_voxels *voxels, const double at[3])
{
    const walk k = begin(w, voxels);
    double found;
    if (is_solid(&k, at) || !find_floor(&found, &k, at, dot(at, w->up)) ||
        stops(&k, at, found + STEP * w->height, found + w->height))
        return 0;
    add(w->eye, at, w->up, found + w->height - dot(at, w->up));
    w->floor = found;
    w->fall = 0;
    return 1;
}

/* Takes one step of the walk, along a wall if the way is blocked. `way` has length 1. Returns 0 if it is blocked. */
static int take_step(const walk *k, const double way[3], double length)
{
    fxs_walker *w = k->walker;
    const double feet = fmax(w->floor, dot(w->eye, w->up) - w->height), limit = feet + STEP * w->height;
    const int now = stops(k, w->eye, limit, feet + w->height);
    double aside[3], next[3];
    cross(aside, w->up, way);
    for (size_t i = 0; i < sizeof asides / sizeof *asides; i++) {
        add(next, w->eye, way, length * asides[i][0] * asides[i][0]);
        add(next, next, aside, length * asides[i][0] * asides[i][1]);
        double found = w->floor;
        if (stops(k, next, limit, feet + w->height) > now)
            continue;
        find_floor(&found, k, next, limit);
        if (found > feet && stops(k, next, found + STEP * w->height, found + w->height) > now)
            continue;
        add(w->eye, next, w->up, 0);
        w->floor = found;
        return 1;
    }
    return 0;
}

/* Moves the eye towards its height above the floor. */
static int settle(fxs_walker *w, double seconds)
{
    const double lacks = w->floor + w->height - dot(w->eye, w->up);
    double rise = fmax(lacks * (1 - fxs_exp(-EASE * seconds)), lacks - LAG * w->height);
    w->fall = lacks < 0 ? fmin(w->fall + GRAVITY * w->height * seconds, EASE * -lacks) : 0;
    if (lacks < 0)
        rise = -fmin(w->fall * seconds, -lacks);
    const int rests = fabs(lacks) < REST * w->height;
    add(w->eye, w->eye, w->up, rests ? lacks : rise);
    return !rests;
}

int fxs_walker_move(fxs_walker *w, const fxs_voxels *voxels, const double way[3], double seconds)
{
    const walk k = begin(w, voxels);
    double unit[3];
    add(unit, way, w->up, -dot(way, w->up));
    const double whole = sqrt(dot(unit, unit));
    const int steps = (int)fmin(ceil(whole / (STRIDE * w->height)), STEPS_MOST);
    add(unit, (double[3]){0, 0, 0}, unit, steps ? 1 / whole : 0);
    for (int i = 0; i < steps; i++)
        if (!take_step(&k, unit, whole / steps))
            break;
    return settle(w, seconds);
}
