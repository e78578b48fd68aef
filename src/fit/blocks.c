/* Divides a large set of photographs into blocks of space that are fitted one after the other. Chooses each block's
 * bounds and photographs, and its points or the Gaussians of a coarse fit of the whole. Bounds come from repeated
 * splits of the points' box along its widest axis. A photograph belongs to a block if it sees the block's points and
 * stands near them, or sees at least 1/20 of them. */
#include "blocks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/message.h>
#include "coarse.h"
#include "src/fit/photos/photo_pixels.h"
#include "src/fit/photos/photos_internal.h"
#include "recipe.h"

#define FAR 2.0                    /* The outermost blocks extend beyond the cameras' bounding box by this multiple of
                                      its longest side. */

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

/* Returns the axis along which the points are widest. Uses the middle three quarters of the points, so that outliers
   have no effect. */
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

static size_t find_bounds(fxs_fit_block *b, uint32_t index, uint32_t blocks, fxs_fit_point *points, size_t count,
                          float *sorted)
{
    count = keep_inside(points, count, b);
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

static int is_seen(const fxs_view *view, const float place[3])
{
    double seen[3] = {0, 0, 0};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            seen[i] += view->rotation[3 * i + k] * ((double)place[k] - view->position[k]);
    const double depth = seen[2], x = seen[0] * view->fx + view->cx * depth, y = seen[1] * view->fy + view->cy * depth;
    return depth > 0 && x >= 0 && x < view->width * depth && y >= 0 && y < view->height * depth;
}

typedef struct neighbourhood {
    const fxs_fit_point *points;
    size_t count;
    double low[3], high[3];
} neighbourhood;

/* Computes the bounding box of a block's points without 1/64 of them on each side as outliers. Then widens the box by
   0.2 of its longest side. */
static void widen(neighbourhood *n, float *sorted)
{
    const size_t outer = n->count / 64;
    double longest = 0;
    for (int k = 0; k < 3; k++) {
        sort_axis(n->points, n->count, k, sorted);
        n->low[k] = (double)sorted[outer];
        n->high[k] = (double)sorted[n->count - 1 - outer];
        longest = n->high[k] - n->low[k] > longest ? n->high[k] - n->low[k] : longest;
    }
    for (int k = 0; k < 3; k++) {
        n->low[k] -= 0.2 * longest;
        n->high[k] += 0.2 * longest;
    }
}

static int is_chosen(const neighbourhood *n, const fxs_view *view)
{
    size_t seen = 0;
    int stands_in = 1;
    for (size_t i = 0; i < n->count; i++)
        seen += (size_t)is_seen(view, n->points[i].position);
    for (int k = 0; k < 3; k++)
        stands_in &= view->position[k] >= n->low[k] && view->position[k] < n->high[k];
    return seen && (stands_in || 20 * seen >= n->count);
}

static size_t choose_photos(const neighbourhood *n, const fxs_fit_photo *photos, size_t count, uint8_t *chosen)
{
    size_t kept = 0;
    for (size_t i = 0; i < count; i++)
        kept += chosen[i] = (uint8_t)is_chosen(n, &photos[i].view);
    return kept;
}

typedef struct choice {
    uint8_t *fit, *held_out, *points;
    fxs_fit_point *inner;
    float *sorted;
} choice;

static void choice_free(choice *c)
{
    free(c->fit);
    free(c->held_out);
    free(c->points);
    free(c->inner);
    free(c->sorted);
}

static int choice_room(choice *c, const fxs_photos *whole, fxs_message *message)
{
    memset(c, 0, sizeof *c);
    c->fit = calloc(whole->fit_count + 1, 1);
    c->held_out = calloc(whole->held_out_count + 1, 1);
    c->points = calloc(whole->point_count + 1, 1);
    c->inner = malloc((whole->point_count + 1) * sizeof *c->inner);
    c->sorted = malloc((whole->point_count + 1) * sizeof *c->sorted);
    return c->fit && c->held_out && c->points && c->inner && c->sorted
               ? 0
               : fxs_fail_memory(message, "a block", whole->point_count * (sizeof *c->inner + sizeof *c->sorted));
}

static void choose_points(const neighbourhood *n, const fxs_photos *whole, choice *c)
{
    for (size_t i = 0; i < whole->point_count; i++) {
        const float *place = whole->points[i].position;
        int is_wanted = is_in(place, n->low, n->high);
        for (size_t k = 0; k < whole->fit_count && !is_wanted; k++)
            is_wanted = c->fit[k] && is_seen(&whole->fit[k].view, place);
        c->points[i] = (uint8_t)is_wanted;
    }
}

/* Chooses the photographs and points of a block. Block 0 is the space outside of all blocks and has no photographs. */
static int choose(fxs_fit_block *b, const fxs_photos *whole, choice *c, fxs_message *message)
{
    const unsigned number = b->number, blocks = b->blocks;
    neighbourhood n = {.points = c->inner};
    if (!number)
        return 0;
    memcpy(c->inner, whole->points, whole->point_count * sizeof *c->inner);
    n.count = find_bounds(b, number - 1, blocks, c->inner, whole->point_count, c->sorted);
    if (!n.count)
        return fxs_fail(message, "block %u of %u: no point is in it", number, blocks);
    widen(&n, c->sorted);
    choose_photos(&n, whole->held_out, whole->held_out_count, c->held_out);
    if (!choose_photos(&n, whole->fit, whole->fit_count, c->fit))
        return fxs_fail(message, "block %u of %u: no photograph to fit sees it", number, blocks);
    choose_points(&n, whole, c);
    return 0;
}

static int begin(fxs_fit_block *b, uint32_t first, uint32_t number, uint32_t blocks, fxs_message *message)
{
    memset(b, 0, sizeof *b);
    b->number = number;
    b->blocks = blocks;
    for (int k = 0; k < 3; k++) {
        b->low[k] = -(double)INFINITY;
        b->high[k] = (double)INFINITY;
    }
    if (number < first || number > blocks || !blocks || blocks > FXS_FIT_BLOCKS_MOST)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "there is no block %u of %u", (unsigned)number, (unsigned)blocks);
    return 0;
}

static int copy_photos(fxs_fit_photo **copy, size_t *kept, const fxs_fit_photo *photos, size_t count,
                       const uint8_t *chosen)
{
    *copy = malloc((count + 1) * sizeof **copy);
    for (size_t i = 0; i < count && *copy; i++)
        if (chosen[i])
            (*copy)[(*kept)++] = photos[i];
    return !*copy;
}

static int copy_points(fxs_photos *p, const fxs_photos *whole, const uint8_t *chosen)
{
    p->points = malloc((whole->point_count + 1) * sizeof *p->points);
    for (size_t i = 0; i < whole->point_count && p->points; i++)
        if (chosen[i])
            p->points[p->point_count++] = whole->points[i];
    return !p->points;
}

int fxs_fit_block_choose(const fxs_photos *whole, uint32_t number, uint32_t blocks, fxs_fit_block *b,
                         fxs_message *message)
{
    choice c = {0};
    int error = begin(b, 1, number, blocks, message);
    if (!error && !whole->point_count)
        error = fxs_fail_as(FXS_ERR_ARGUMENT, message, "blocks of no points");
    if (!error)
        error = choice_room(&c, whole, message);
    if (!error)
        error = choose(b, whole, &c, message);
    if (!error && (copy_photos(&b->photos.fit, &b->photos.fit_count, whole->fit, whole->fit_count, c.fit) ||
                   copy_photos(&b->photos.held_out, &b->photos.held_out_count, whole->held_out,
                               whole->held_out_count, c.held_out) ||
                   copy_points(&b->photos, whole, c.points)))
        error = fxs_fail_memory(message, "a block", 0);
    b->photos.points_are_random = whole->points_are_random;
    b->photos.skipped = whole->skipped;
    b->extent = fxs_fit_extent(whole->fit, whole->fit_count, whole->points, whole->point_count);
    choice_free(&c);
    if (error)
        fxs_fit_block_free(b);
    return error;
}

void fxs_fit_block_free(fxs_fit_block *b)
{
    if (b->owns_pixels) {
        fxs_photos_free(&b->photos);
    } else {
        free(b->photos.points);
        free(b->photos.fit);
        free(b->photos.held_out);
    }
    free(b->gaussians);
    memset(b, 0, sizeof *b);
}

static int take_views(fxs_fit_photo **photos, size_t *count, const fxs_view_list *views)
{
    *photos = calloc(views->count + 1, sizeof **photos);
    for (size_t i = 0; i < views->count && *photos; i++)
        fxs_photo_view(&views->views[i], &(*photos)[i].view);
    *count = *photos ? views->count : 0;
    return !*photos;
}

static int take_centres(fxs_photos *whole, const fxs_fit_model *m)
{
    whole->points = calloc(m->count + 1, sizeof *whole->points);
    for (size_t i = 0; i < m->count && whole->points; i++)
        for (size_t k = 0; k < 3; k++)
            whole->points[i].position[k] = m->parameters[(FXS_FIT_POSITION + k) * m->stride + i];
    whole->point_count = whole->points ? m->count : 0;
    return !whole->points;
}

static void take_cameras(const fxs_fit_photo *photos, size_t count, double low[3], double high[3])
{
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], photos[i].view.position[k]);
            high[k] = fmax(high[k], photos[i].view.position[k]);
        }
}

/* Sets `b` to the bounds of all blocks together. The space beyond needs no block, because all cameras see it from about
   the same side: the coarse fit of the whole suffices there. */
static void bound(fxs_fit_block *b, const fxs_photos *whole)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, longest = 0;
    take_cameras(whole->fit, whole->fit_count, low, high);
    take_cameras(whole->held_out, whole->held_out_count, low, high);
    for (int k = 0; k < 3; k++)
        longest = fmax(longest, high[k] - low[k]);
    for (int k = 0; k < 3 && longest > 0; k++) {
        b->low[k] = low[k] - FAR * longest;
        b->high[k] = high[k] + FAR * longest;
    }
}

static int take_gaussians(fxs_fit_block *b, const fxs_photos *whole, const uint8_t *chosen)
{
    b->gaussians = malloc((whole->point_count + 1) * sizeof *b->gaussians);
    for (size_t i = 0; i < whole->point_count && b->gaussians; i++)
        if (b->number ? chosen[i] : !is_in(whole->points[i].position, b->low, b->high))
            b->gaussians[b->gaussian_count++] = (uint32_t)i;
    return !b->gaussians;
}

static int check_sizes(const fxs_view_list *views, fxs_message *message)
{
    for (size_t i = 0; i < views->count; i++)
        if (views->views[i].sizeless == FXS_SIZE_OF_PIXELS || views->views[i].sizeless == FXS_SIZE_OF_LONGER)
            return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: it states no size of the photographs, without which "
                               "blocks cannot be chosen; export the cameras in another format, as COLMAP's",
                               views->path);
    return 0;
}

static int read_whole(fxs_photos *whole, const fxs_photo_list *list, const fxs_photos_options *options,
                      const fxs_fit_coarse *coarse, fxs_message *message)
{
    FXS_TRY(check_sizes(&list->fit, message));
    FXS_TRY(check_sizes(&list->held_out, message));
    if (take_views(&whole->fit, &whole->fit_count, &list->fit) ||
        take_views(&whole->held_out, &whole->held_out_count, &list->held_out))
        return fxs_fail_memory(message, "a block", (list->fit.count + list->held_out.count) * sizeof *whole->fit);
    if (!coarse)
        return fxs_photos_points(list, options, whole, message);
    return take_centres(whole, &coarse->fit->model) ? fxs_fail_memory(message, "a block", 0) : 0;
}

static int read_chosen(fxs_fit_block *b, fxs_photo_list *list, const fxs_photos *whole, const choice *c,
                       const fxs_photos_options *options, const fxs_fit_coarse *coarse, fxs_message *message)
{
    fxs_photos *p = &b->photos;
    b->owns_pixels = 1;
    p->points_are_random = whole->points_are_random;
    if (coarse ? take_gaussians(b, whole, c->points) : copy_points(p, whole, c->points))
        return fxs_fail_memory(message, "a block", 0);
    if (!b->number)
        return 0;
    fxs_photo_list_keep(&list->fit, c->fit);
    fxs_photo_list_keep(&list->held_out, c->held_out);
    return fxs_photos_pixels(list, options, p, message);
}

static int choose_of(const char *path, const fxs_photo_list *list, const fxs_photos *whole,
                     const fxs_photos_options *options, const fxs_fit_coarse *coarse, fxs_fit_block *b, choice *c,
                     fxs_message *message)
{
    fxs_message why;
    FXS_TRY(choice_room(c, whole, message));
    int error = coarse ? fxs_fit_coarse_check(coarse, &list->fit, options->skip_bad, &why) : 0;
    if (coarse)
        bound(b, whole);
    if (!error)
        error = choose(b, whole, c, &why);
    return error ? fxs_fail_as(error, message, "%s: %s", path, why.text) : 0;
}

int fxs_fit_block_read(const char *path, const fxs_photos_options *options, const fxs_fit_coarse *coarse,
                       uint32_t number, uint32_t blocks, fxs_fit_block *b, fxs_message *message)
{
    fxs_photo_list list;
    fxs_photos whole = {0};
    choice c = {0};
    FXS_TRY(begin(b, !coarse, number, blocks, message));
    FXS_TRY(fxs_photo_list_find(&list, path, options->hold_out, message));
    int error = fxs_photo_masks_check(&list, options, message);
    if (!error)
        error = read_whole(&whole, &list, options, coarse, message);
    if (!error)
        error = choose_of(path, &list, &whole, options, coarse, b, &c, message);
    if (!error)
        error = read_chosen(b, &list, &whole, &c, options, coarse, message);
    b->coarse = coarse;
    b->extent = coarse ? coarse->fit->extent
                       : fxs_fit_extent(whole.fit, whole.fit_count, whole.points, whole.point_count);
    choice_free(&c);
    fxs_photos_free(&whole);
    fxs_photo_list_free(&list);
    if (error)
        fxs_fit_block_free(b);
    return error;
}
