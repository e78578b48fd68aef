#include <fixsplat/blocks.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/message.h>
#include "recipe.h"

/* ---- The block's bounds ------------------------------------------------------------------------------------------ */

static int is_in(const float place[3], const double low[3], const double high[3])
{
    for (int k = 0; k < 3; k++)
        if (!((double)place[k] >= low[k] && (double)place[k] < high[k]))
            return 0;
    return 1;
}

static int compare_floats(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static void sort_axis(const fxs_fit_point *points, size_t count, int axis, float *sorted)
{
    for (size_t i = 0; i < count; i++)
        sorted[i] = points[i].position[axis];
    qsort(sorted, count, sizeof *sorted, compare_floats);
}

/* The axis on which the middle three quarters of the points are widest: a few far points do not matter. */
static int widest_axis(const fxs_fit_point *points, size_t count, float *sorted)
{
    double widest = -1;
    int axis = 0;
    for (int k = 0; k < 3; k++) {
        sort_axis(points, count, k, sorted);
        const double width = (double)sorted[count - 1 - count / 8] - (double)sorted[count / 8];
        if (width > widest) {
            widest = width;
            axis = k;
        }
    }
    return axis;
}

static size_t keep_inside(fxs_fit_point *points, size_t count, const fxs_fit_block *b)
{
    size_t kept = 0;
    for (size_t i = 0; i < count; i++)
        if (is_in(points[i].position, b->low, b->high))
            points[kept++] = points[i];
    return kept;
}

/* Keeps the block's points in `points` and returns their number; 0 where many are in one place of another block. */
static size_t find_bounds(fxs_fit_block *b, uint32_t index, uint32_t blocks, fxs_fit_point *points, size_t count,
                          float *sorted)
{
    for (int k = 0; k < 3; k++) {
        b->low[k] = -(double)INFINITY;
        b->high[k] = (double)INFINITY;
    }
    while (blocks > 1 && count) {
        const uint32_t left = blocks / 2;
        const int axis = widest_axis(points, count, sorted);
        sort_axis(points, count, axis, sorted);
        const double plane = (double)sorted[(size_t)((uint64_t)count * left / blocks)];
        if (index < left) {
            b->high[axis] = plane;
            blocks = left;
        } else {
            b->low[axis] = plane;
            index -= left;
            blocks -= left;
        }
        count = keep_inside(points, count, b);
    }
    return count;
}

/* ---- What sees it ------------------------------------------------------------------------------------------------ */

static int is_seen(const fxs_file_view *view, const float place[3])
{
    double seen[3] = {0, 0, 0};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            seen[i] += view->rotation[3 * i + k] * ((double)place[k] - view->position[k]);
    const double depth = seen[2], x = seen[0] * view->fx + view->cx * depth, y = seen[1] * view->fy + view->cy * depth;
    return depth > 0 && x >= 0 && x < view->width * depth && y >= 0 && y < view->height * depth;
}

typedef struct neighbourhood {
    const fxs_fit_point *points;   /* of the block */
    size_t count;
    double low[3], high[3];        /* the widened box of these points */
} neighbourhood;

static void widen(neighbourhood *n)
{
    double longest = 0;
    for (int k = 0; k < 3; k++) {
        n->low[k] = n->high[k] = (double)n->points[0].position[k];
        for (size_t i = 1; i < n->count; i++) {
            const double at = (double)n->points[i].position[k];
            n->low[k] = at < n->low[k] ? at : n->low[k];
            n->high[k] = at > n->high[k] ? at : n->high[k];
        }
        longest = n->high[k] - n->low[k] > longest ? n->high[k] - n->low[k] : longest;
    }
    for (int k = 0; k < 3; k++) {
        n->low[k] -= 0.2 * longest;
        n->high[k] += 0.2 * longest;
    }
}

static int is_chosen(const neighbourhood *n, const fxs_file_view *view)
{
    size_t seen = 0;
    int stands_in = 1;
    for (size_t i = 0; i < n->count; i++)
        seen += (size_t)is_seen(view, n->points[i].position);
    for (int k = 0; k < 3; k++)
        stands_in &= view->position[k] >= n->low[k] && view->position[k] < n->high[k];
    return seen && (stands_in || 20 * seen >= n->count);
}

static size_t choose_photos(const neighbourhood *n, const fxs_fit_photo *photos, size_t count, fxs_fit_photo *chosen)
{
    size_t kept = 0;
    for (size_t i = 0; i < count; i++)
        if (is_chosen(n, &photos[i].view))
            chosen[kept++] = photos[i];
    return kept;
}

static void choose_points(const neighbourhood *n, const fxs_photos *whole, fxs_photos *chosen)
{
    for (size_t i = 0; i < whole->point_count; i++) {
        const float *place = whole->points[i].position;
        int is_wanted = is_in(place, n->low, n->high);
        for (size_t k = 0; k < chosen->fit_count && !is_wanted; k++)
            is_wanted = is_seen(&chosen->fit[k].view, place);
        if (is_wanted)
            chosen->points[chosen->point_count++] = whole->points[i];
    }
}

/* ---- The block --------------------------------------------------------------------------------------------------- */

static int fill(fxs_fit_block *b, const fxs_photos *whole, uint32_t number, uint32_t blocks, fxs_fit_point *points,
                float *sorted, fxs_message *message)
{
    fxs_photos *p = &b->photos;
    neighbourhood n = {.points = points};
    memcpy(points, whole->points, whole->point_count * sizeof *points);
    n.count = find_bounds(b, number - 1, blocks, points, whole->point_count, sorted);
    if (!n.count)
        return fxs_fail(message, "block %u of %u: no point is in it", (unsigned)number, (unsigned)blocks);
    widen(&n);
    p->fit_count = choose_photos(&n, whole->fit, whole->fit_count, p->fit);
    p->held_out_count = choose_photos(&n, whole->held_out, whole->held_out_count, p->held_out);
    if (!p->fit_count)
        return fxs_fail(message, "block %u of %u: no photograph to fit sees it", (unsigned)number, (unsigned)blocks);
    choose_points(&n, whole, p);
    return 0;
}

int fxs_fit_block_choose(const fxs_photos *whole, uint32_t number, uint32_t blocks, fxs_fit_block *b,
                         fxs_message *message)
{
    memset(b, 0, sizeof *b);
    if (!number || number > blocks || blocks > FXS_FIT_BLOCKS_MOST || !whole->point_count)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "there is no block %u of %u", (unsigned)number, (unsigned)blocks);
    fxs_photos *p = &b->photos;
    fxs_fit_point *points = malloc(whole->point_count * sizeof *points);
    float *sorted = malloc(whole->point_count * sizeof *sorted);
    p->points = malloc(whole->point_count * sizeof *p->points);
    p->fit = malloc((whole->fit_count + 1) * sizeof *p->fit);
    p->held_out = malloc((whole->held_out_count + 1) * sizeof *p->held_out);
    p->points_are_random = whole->points_are_random;
    p->skipped = whole->skipped;
    b->extent = fxs_fit_extent(whole->fit, whole->fit_count, whole->points, whole->point_count);
    const int error = points && sorted && p->points && p->fit && p->held_out
                          ? fill(b, whole, number, blocks, points, sorted, message)
                          : fxs_fail_memory(message, "a block", 0);
    free(points);
    free(sorted);
    if (error)
        fxs_fit_block_free(b);
    return error;
}

void fxs_fit_block_free(fxs_fit_block *b)
{
    free(b->photos.points);
    free(b->photos.fit);
    free(b->photos.held_out);
    memset(b, 0, sizeof *b);
}
