/* Chooses initial points of the sky: photographs vote on directions of a spherical lattice. A direction is free in a
 * photograph if no point of the reconstruction is projected near it. */
#include "sky.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    CELLS = 48,                    /* number of square cells along the longer side of a picture */
    MOST = 1 << 17                 /* largest number of points examined, evenly spaced */
};
#define TIMES 1000.0               /* radius of the sphere of sky points, relative to the extent of the scene */
#define FARTHEST 67108864.0

typedef struct tally {
    uint32_t seen, is_free;        /* numbers of photographs that see a direction, and that have no point near it (the
                                      direction is free) */
    uint64_t colour[3];            /* sums of a direction's colours over the photographs where it is free */
} tally;

typedef struct cells {
    uint8_t is_near[CELLS][CELLS];
    double size;                   /* side of a cell in pixels */
} cells;

/* Projects a place to pixels. Returns true if it is in the picture, or at most `beyond` pixels outside. */
static int project(const fxs_view *view, const double place[3], double beyond, double at[2])
{
    double seen[3] = {0, 0, 0};
    for (int i = 0; i < 9; i++)
        seen[i / 3] += view->rotation[i] * (place[i % 3] - view->position[i % 3]);
    at[0] = seen[0] / seen[2] * view->fx + view->cx;
    at[1] = seen[1] / seen[2] * view->fy + view->cy;
    return seen[2] > 0 && at[0] >= -beyond && at[0] < view->width + beyond && at[1] >= -beyond &&
           at[1] < view->height + beyond;
}

static void place_of(const fxs_fit_point *point, double place[3])
{
    for (int k = 0; k < 3; k++)
        place[k] = (double)point->position[k];
}

static void find_cells(cells *c, const fxs_view *view, const fxs_fit_point *points, size_t count)
{
    const size_t some = count < MOST ? count : MOST;
    memset(c->is_near, 0, sizeof c->is_near);
    c->size = (double)(view->width > view->height ? view->width : view->height) / CELLS;
    for (size_t i = 0; i < some; i++) {
        double place[3], at[2];
        place_of(&points[(size_t)((uint64_t)i * count / some)], place);
        if (!project(view, place, c->size, at))
            continue;
        const int x = (int)(at[0] / c->size + 1) - 1, y = (int)(at[1] / c->size + 1) - 1;
        for (int k = 0; k < 9; k++) {
            const int column = x + k % 3 - 1, row = y + k / 3 - 1;
            if (column >= 0 && column < CELLS && row >= 0 && row < CELLS)
                c->is_near[row][column] = 1;
        }
    }
}

static int cell_of(const cells *c, double at)
{
    const int cell = (int)(at / c->size);
    return cell < CELLS ? cell : CELLS - 1;
}

static void look(const fxs_fit_photo *photo, const cells *c, const fxs_fit_point *point, tally *t)
{
    double place[3], at[2];
    place_of(point, place);
    if (!project(&photo->view, place, 0, at))
        return;
    const size_t pixel = (size_t)at[1] * (size_t)photo->view.width + (size_t)at[0];
    if (photo->mask && !photo->mask[pixel])
        return;
    t->seen++;
    if (c->is_near[cell_of(c, at[1])][cell_of(c, at[0])])
        return;
    t->is_free++;
    for (int k = 0; k < 3; k++)
        t->colour[k] += photo->pixels[3 * pixel + (size_t)k];
}

/* Spreads points evenly over a sphere, as a Fibonacci lattice. Heights are evenly spaced; each point is rotated from
   the last by the golden angle, pi (3 - sqrt(5)). */
static void spread(fxs_fit_point *points, uint32_t count, const double middle[3], double radius)
{
    double x = 1, z = 0;
    for (uint32_t i = 0; i < count; i++) {
        const double y = 1 - (2 * (double)i + 1) / count, level = sqrt(1 - y * y);
        const double at[3] = {level * x, y, level * z};
        for (int k = 0; k < 3; k++)
            points[i].position[k] = (float)(middle[k] + radius * at[k]);
        const double turned = x * -0.73736887807831985 - z * 0.67549029426152362;
        z = x * 0.67549029426152362 + z * -0.73736887807831985;
        x = turned;
        const double length = sqrt(x * x + z * z);
        x /= length;
        z /= length;
    }
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Returns the distance from `middle` within which 19 of 20 points are; below 0 if memory runs out. */
static double distance_of(const fxs_fit_point *points, size_t count, const double middle[3])
{
    const size_t some = count < MOST ? count : MOST;
    double *squares = malloc(some * sizeof *squares), distance = -1;
    for (size_t i = 0; i < some && squares; i++) {
        double place[3];
        place_of(&points[(size_t)((uint64_t)i * count / some)], place);
        squares[i] = 0;
        for (int k = 0; k < 3; k++)
            squares[i] += (place[k] - middle[k]) * (place[k] - middle[k]);
    }
    if (squares) {
        qsort(squares, some, sizeof *squares, ascending);
        distance = sqrt(squares[some - 1 - some / 20]);
    }
    free(squares);
    return distance;
}

static size_t choose(fxs_fit_point *points, const tally *tallies, uint32_t count)
{
    size_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        const tally *t = &tallies[i];
        if (2 * t->is_free <= t->seen)
            continue;
        points[kept] = points[i];
        for (int k = 0; k < 3; k++)
            points[kept].colour[k] = (uint8_t)((t->colour[k] + t->is_free / 2) / t->is_free);
        kept++;
    }
    return kept;
}

int fxs_fit_sky_find(const fxs_fit_photo *photos, size_t photo_count, const fxs_fit_point *points, size_t point_count,
                     uint32_t directions, float extent, fxs_fit_sky *sky)
{
    double middle[3] = {0, 0, 0};
    cells near;
    memset(sky, 0, sizeof *sky);
    for (size_t i = 0; i < photo_count; i++)
        for (int k = 0; k < 3; k++)
            middle[k] += photos[i].view.position[k] / (double)photo_count;
    tally *tallies = calloc(directions, sizeof *tallies);
    const double away = distance_of(points, point_count, middle);
    sky->points = malloc(directions * sizeof *sky->points);
    if (!tallies || !sky->points || away < 0) {
        free(tallies);
        free(sky->points);
        sky->points = NULL;
        return FXS_ERR_MEMORY;
    }
    const double size = TIMES * (away > (double)extent ? away : (double)extent);
    const double radius = size < FARTHEST ? size : FARTHEST;
    spread(sky->points, directions, middle, radius);
    for (size_t i = 0; i < photo_count; i++) {
        find_cells(&near, &photos[i].view, points, point_count);
        for (uint32_t k = 0; k < directions; k++)
            look(&photos[i], &near, &sky->points[k], &tallies[k]);
    }
    sky->count = choose(sky->points, tallies, directions);
    sky->sigma = (float)(0.5 * radius * sqrt(4 * 3.14159265358979324 / directions));
    for (int k = 0; k < 3; k++)
        sky->far.middle[k] = (float)middle[k];
    sky->far.inverse = fminf(1 / extent, FXS_FIT_INVERSE_MOST);
    free(tallies);
    return 0;
}
