/* Finds the nearest neighbours of points by a binary tree with bounding boxes. The tree is split at the median along
 * the widest axis. */
#include "nearest.h"

#include <math.h>
#include <stdlib.h>

#include <fixsplat/fixsplat.h>
#include "src/base/random.h"

enum { LEAF = 8 };                 /* largest number of points in a leaf of the tree */

typedef struct item {
    float at[3];
    uint32_t point;
} item;

typedef struct box {
    float low[3], high[3];
} box;

/* A binary tree of points in an array. Node n has the children 2 n + 1 (lower half of its points) and 2 n + 2 (upper
   half). */
typedef struct tree {
    item *items;
    box *boxes;
} tree;

static int is_before(const item *a, const item *b, int axis)
{
    return a->at[axis] != b->at[axis] ? a->at[axis] < b->at[axis] : a->point < b->point;
}

static void swap_items(item *a, item *b)
{
    const item swap = *a;
    *a = *b;
    *b = swap;
}

/* Partially sorts points: moves the item of rank `middle` to its place and smaller items before it (Hoare's
   quickselect, random pivots). */
static void select_item(item *items, size_t count, size_t middle, int axis)
{
    size_t first = 0, end = count;
    while (end - first > 1) {
        swap_items(&items[first], &items[first + fxs_random(first, end, middle) % (end - first)]);
        const item pivot = items[first];
        size_t at = first;
        for (size_t i = first + 1; i < end; i++)
            if (is_before(&items[i], &pivot, axis))
                swap_items(&items[++at], &items[i]);
        swap_items(&items[first], &items[at]);
        if (at == middle)
            return;
        if (at < middle)
            first = at + 1;
        else
            end = at;
    }
}

static int widest_side(const box *b)
{
    const float x = b->high[0] - b->low[0], y = b->high[1] - b->low[1], z = b->high[2] - b->low[2];
    return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

static void build(tree *t, size_t node, size_t first, size_t count)
{
    box b;
    for (int k = 0; k < 3; k++) {
        b.low[k] = b.high[k] = t->items[first].at[k];
        for (size_t i = first + 1; i < first + count; i++) {
            b.low[k] = fminf(b.low[k], t->items[i].at[k]);
            b.high[k] = fmaxf(b.high[k], t->items[i].at[k]);
        }
    }
    t->boxes[node] = b;
    if (count <= LEAF)
        return;
    select_item(t->items + first, count, count / 2, widest_side(&b));
    build(t, 2 * node + 1, first, count / 2);
    build(t, 2 * node + 2, first + count / 2, count - count / 2);
}

static float square_of(float x, float y, float z)
{
    return (x * x + y * y) + z * z;
}

/* Returns the squared distance from p to a box. Rounding is monotonic, so no point in the box has a smaller computed
   distance. */
static float square_to(const box *b, const float p[3])
{
    float away[3];
    for (int k = 0; k < 3; k++)
        away[k] = fmaxf(fmaxf(b->low[k] - p[k], p[k] - b->high[k]), 0);
    return square_of(away[0], away[1], away[2]);
}

/* The nearest points found so far, from near to far. */
typedef struct found {
    float squares[FXS_NEAR];   /* squared distances; INFINITY: none */
    uint32_t points[FXS_NEAR];
    int wanted;
} found;

static void look_at_leaf(const item *items, size_t count, const item *self, found *f)
{
    for (size_t i = 0; i < count; i++) {
        if (&items[i] == self)
            continue;
        float d = square_of(items[i].at[0] - self->at[0], items[i].at[1] - self->at[1], items[i].at[2] - self->at[2]);
        uint32_t point = items[i].point;
        for (int k = 0; k < f->wanted; k++)
            if (d < f->squares[k]) {
                const float farther = f->squares[k];
                const uint32_t other = f->points[k];
                f->squares[k] = d;
                f->points[k] = point;
                d = farther;
                point = other;
            }
    }
}

static void look(const tree *t, size_t node, size_t first, size_t count, const item *self, found *f)
{
    if (count <= LEAF) {
        look_at_leaf(t->items + first, count, self, f);
        return;
    }
    const float lower = square_to(&t->boxes[2 * node + 1], self->at);
    const float upper = square_to(&t->boxes[2 * node + 2], self->at);
    for (int turn = 0; turn < 2; turn++) {
        const int is_upper = turn ^ (upper < lower);
        if (!((is_upper ? upper : lower) < f->squares[f->wanted - 1]))
            continue;
        if (is_upper)
            look(t, 2 * node + 2, first + count / 2, count - count / 2, self, f);
        else
            look(t, 2 * node + 1, first, count / 2, self, f);
    }
}

static float mean_of(const float nearest[3])
{
    float sum = 0;
    int count = 0;
    while (count < 3 && nearest[count] < INFINITY)
        sum += nearest[count++];
    return count ? sum / (float)count : 1;
}

static size_t nodes_of(size_t count)
{
    size_t nodes = 1;
    while (count > LEAF) {
        count -= count / 2;
        nodes = 2 * nodes + 1;
    }
    return nodes;
}

static int tree_build(tree *t, const float *const planes[3], size_t step, size_t count)
{
    *t = (tree){malloc((count + 1) * sizeof *t->items), malloc(nodes_of(count) * sizeof *t->boxes)};
    if (!t->items || !t->boxes)
        return FXS_ERR_MEMORY;
    for (size_t i = 0; i < count; i++)
        t->items[i] = (item){{planes[0][i * step], planes[1][i * step], planes[2][i * step]}, (uint32_t)i};
    if (count)
        build(t, 0, 0, count);
    return 0;
}

static void tree_free(tree *t)
{
    free(t->items);
    free(t->boxes);
}

static found look_around(const tree *t, size_t count, size_t i, int wanted)
{
    found f = {.wanted = wanted};
    for (int k = 0; k < wanted; k++) {
        f.squares[k] = INFINITY;
        f.points[k] = t->items[i].point;
    }
    look(t, 0, 0, count, &t->items[i], &f);
    return f;
}

int fxs_nearest_squares(const float *const planes[3], size_t step, size_t count, float *squares)
{
    tree t;
    const int error = tree_build(&t, planes, step, count);
    for (size_t i = 0; i < count && !error; i++) {
        const found f = look_around(&t, count, i, 3);
        squares[t.items[i].point] = mean_of(f.squares);
    }
    tree_free(&t);
    return error;
}

int fxs_neighbours(const float *const planes[3], size_t count, uint32_t *near)
{
    tree t;
    const int error = tree_build(&t, planes, 1, count);
    for (size_t i = 0; i < count && !error; i++) {
        const found f = look_around(&t, count, i, FXS_NEAR);
        for (int k = 0; k < FXS_NEAR; k++)
            near[(size_t)t.items[i].point * FXS_NEAR + (size_t)k] = f.points[k];
    }
    tree_free(&t);
    return error;
}
