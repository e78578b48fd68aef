/* Builds the level-of-detail tree of a .rad file. An inner node has the moments of its children, weighted by opacity
   times area. Its opacity A preserves the sum of opacity times area and may exceed 1. Inner nodes hardly larger than
   their descendants are left out (Spark's bhatt_lod.rs). Large nodes come first in the file, then the rest by regions
   (chunk_tree.rs). */
#include "rad_tree_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "held_levels_internal.h"
#include "src/base/exponential.h"
#include "src/gaussian/attributes.h"
#include "src/pack/coarsen.h"
#include "src/scene/read/rad_internal.h"

enum {
    ROOT_BATCH = 65536, BATCH = 32768,
    MANY = 64,                           /* an inner node with this many children always stays in the tree */
    COLOURS = 48
};

#define NONE UINT32_MAX
#define WORTH 1.75   /* least ratio of an inner node's weight (opacity times area) to the heaviest node below */
#define LEAST_OPACITY 1e-6
#define MOST_OPACITY 1000.0

typedef struct moments {
    double weight;
    double mean[3], covariance[6];
} moments;

typedef struct sums {
    moments all;
    double colours[COLOURS];
    uint32_t members, last;
} sums;

typedef struct builder {
    fxs_held *held;
    fxs_levels levels;
    uint32_t nodes;
    uint32_t *parents;             /* index of each node's parent; NONE: the node is the root */
    uint32_t *firsts, *children;   /* node i has the children children[firsts[i]] to children[firsts[i + 1] - 1] */
    /* size of a node: two sigmas of the longest axis times Spark's dilation D (fxs_rad_dilation) */
    float *weights, *sizes;
    uint32_t *reps;
    moments *moments;
    sums sums[FXS_LEVEL_SET];
} builder;

double fxs_rad_dilation(double opacity)
{
    return opacity > 1 ? sqrt(1 + FXS_RAD_E * fxs_log(opacity)) : 1;
}

static double measure(moments *m, const fxs_held_gaussian *held)
{
    fxs_gaussian g;
    fxs_coarse c;
    fxs_held_get(held, NULL, &g, 0);
    fxs_coarse_set(&c, &g);
    for (int k = 0; k < 3; k++)
        m->mean[k] = (double)held->position[k];
    for (int k = 0; k < 6; k++)
        m->covariance[k] = (double)c.covariance[k];
    return (double)c.area;
}

static void note_node(builder *b, uint32_t node, double weight)
{
    const fxs_held_gaussian *g = &b->held->gaussians[node];
    const float longest = fmaxf(fmaxf(g->scale[0], g->scale[1]), g->scale[2]);
    b->parents[node] = NONE;
    b->weights[node] = (float)weight;
    b->sizes[node] = (float)(2 * fxs_exp((double)longest) * fxs_rad_dilation((double)g->opacity));
}

static int are_finite(const moments *m)
{
    int finite = 1;
    for (int k = 0; k < 6; k++)
        finite &= m->covariance[k] < 1e30 && (k >= 3 || fabs(m->mean[k]) < 1e30);
    return finite;
}

/* Adds an inner node to the tree. If the node's moments are too large for floats, the node copies its last child. */
static uint32_t add_node(builder *b, const sums *s)
{
    fxs_held *h = b->held;
    const uint32_t node = b->nodes++;
    int16_t *sh = h->sh + (size_t)node * h->coefficients;
    fxs_gaussian g = {.rotation = {1, 0, 0, 0}};
    moments m;
    h->gaussians[node] = h->gaussians[s->last];
    memcpy(sh, h->sh + (size_t)s->last * h->coefficients, h->coefficients * sizeof *sh);
    if (are_finite(&s->all)) {
        float covariance[6];
        for (int k = 0; k < 6; k++)
            covariance[k] = (float)s->all.covariance[k];
        for (int k = 0; k < 3; k++) {
            g.position[k] = (float)s->all.mean[k];
            g.dc[k] = (float)s->colours[k];
        }
        for (uint32_t k = 0; k < h->coefficients; k++)
            g.sh[k] = (float)(s->colours[3 + k] / FXS_HELD_SH_ONE);
        fxs_coarse_axes(&g, covariance);
        fxs_held_set(&h->gaussians[node], sh, &g, h->coefficients);
        const double opacity = s->all.weight / measure(&m, &h->gaussians[node]);
        h->gaussians[node].opacity = (float)fmin(fmax(opacity, LEAST_OPACITY), MOST_OPACITY);
    }
    note_node(b, node, s->all.weight);
    return node;
}

static int make_room(builder *b)
{
    const size_t leaves = b->held->count;
    size_t room = leaves;
    for (uint32_t level = 1; level < b->levels.count; level++)
        room += b->levels.levels[level].count;
    fxs_held_gaussian *gaussians = realloc(b->held->gaussians, room * sizeof *gaussians);
    b->held->gaussians = gaussians ? gaussians : b->held->gaussians;
    int16_t *sh = realloc(b->held->sh, room * b->held->coefficients * sizeof *sh + 1);
    b->held->sh = sh ? sh : b->held->sh;
    b->parents = malloc(room * sizeof *b->parents);
    b->weights = malloc(room * sizeof *b->weights);
    b->sizes = malloc(room * sizeof *b->sizes);
    b->firsts = calloc(room + 2, sizeof *b->firsts);
    b->children = malloc(room * sizeof *b->children);
    b->reps = malloc(leaves * sizeof *b->reps);
    b->moments = malloc(leaves * sizeof *b->moments);
    return gaussians && sh && b->parents && b->weights && b->sizes && b->firsts && b->children && b->reps && b->moments;
}

static void add_leaves(builder *b)
{
    b->nodes = b->held->count;
    for (uint32_t i = 0; i < b->nodes; i++) {
        const uint32_t node = b->held->order[i];
        const fxs_held_gaussian *g = &b->held->gaussians[node];
        b->reps[i] = node;
        b->moments[i].weight = (double)g->opacity * measure(&b->moments[i], g);
        note_node(b, node, b->moments[i].weight);
    }
}

static double share_of(const builder *b, const sums *s, uint32_t member)
{
    return s->all.weight > 0 ? b->moments[member].weight / s->all.weight : 1.0 / s->members;
}

static void add_mean(const builder *b, sums *s, uint32_t member)
{
    const fxs_held *h = b->held;
    const double share = share_of(b, s, member);
    const int16_t *sh = h->sh + (size_t)b->reps[member] * h->coefficients;
    for (int k = 0; k < 3; k++) {
        s->all.mean[k] += share * b->moments[member].mean[k];
        s->colours[k] += share * (double)h->gaussians[b->reps[member]].dc[k];
    }
    for (uint32_t k = 0; k < h->coefficients; k++)
        s->colours[3 + k] += share * sh[k];
}

/* Adds the covariance of a child to that of a tree node, including the covariance of the child's position about the
   mean. */
static void add_covariance(const builder *b, sums *s, uint32_t member)
{
    const moments *m = &b->moments[member];
    const double share = share_of(b, s, member);
    const double x = m->mean[0] - s->all.mean[0], y = m->mean[1] - s->all.mean[1], z = m->mean[2] - s->all.mean[2];
    const double products[6] = {x * x, y * y, z * z, x * y, x * z, y * z};
    for (int k = 0; k < 6; k++)
        s->all.covariance[k] += share * (m->covariance[k] + products[k]);
}

static void make_set(builder *b, const uint32_t *into, uint32_t begin, uint32_t end, uint32_t first, uint32_t last)
{
    memset(b->sums, 0, (last - first) * sizeof *b->sums);
    for (uint32_t i = begin; i < end; i++) {
        sums *s = &b->sums[into[i] - first];
        s->all.weight += b->moments[i].weight;
        s->members++;
        s->last = b->reps[i];
    }
    for (uint32_t i = begin; i < end; i++)
        add_mean(b, &b->sums[into[i] - first], i);
    for (uint32_t i = begin; i < end; i++)
        add_covariance(b, &b->sums[into[i] - first], i);
    for (uint32_t j = 0; j < last - first; j++)
        if (b->sums[j].members > 1)
            b->sums[j].last = add_node(b, &b->sums[j]);
    for (uint32_t i = begin; i < end; i++)
        if (b->sums[into[i] - first].members > 1)
            b->parents[b->reps[i]] = b->sums[into[i] - first].last;
    for (uint32_t j = 0; j < last - first; j++) {
        b->reps[first + j] = b->sums[j].last;
        b->moments[first + j] = b->sums[j].all;
    }
}

static void make_nodes(builder *b)
{
    add_leaves(b);
    for (uint32_t level = 1; level < b->levels.count; level++) {
        const fxs_level *to = &b->levels.levels[level], *from = to - 1;
        for (uint32_t set = 0; set < to->sets; set++) {
            const uint32_t next = 2 * set + 2 < from->sets ? 2 * set + 2 : from->sets;
            make_set(b, to->into, fxs_level_begin(&b->levels, level - 1, 2 * set),
                     fxs_level_begin(&b->levels, level - 1, next), to->begins[set], to->begins[set + 1]);
        }
    }
}

/* Returns 1 for a node that is left out of the tree. Such a node is marked as its own parent. */
static int is_left_out(const builder *b, uint32_t node)
{
    return b->parents[node] == node;
}

/* Leaves out tree nodes hardly larger than their descendants. Children have smaller indices than their parents. */
static int thin_out(builder *b)
{
    const uint32_t leaves = b->held->count;
    float *heaviest = malloc(b->nodes * sizeof *heaviest);
    uint32_t *kept = calloc(b->nodes, sizeof *kept);
    uint32_t *above = malloc(b->nodes * sizeof *above);
    int made = heaviest && kept && above;
    for (uint32_t i = 0; i < b->nodes && made; i++)
        heaviest[i] = i < leaves ? b->weights[i] : 0;
    for (uint32_t i = 0; i < b->nodes && made; i++) {
        const uint32_t parent = b->parents[i];
        const int is_worth = !(b->weights[i] < (float)WORTH * heaviest[i]);
        const int stays = i < leaves || parent == NONE || is_worth || kept[i] >= MANY;
        if (stays)
            heaviest[i] = b->weights[i];
        if (parent != NONE) {
            heaviest[parent] = fmaxf(heaviest[parent], heaviest[i]);
            kept[parent] += stays ? 1 : kept[i];
        }
        above[i] = stays ? i : NONE;
    }
    for (uint32_t i = b->nodes; i-- > 0 && made;) {
        const uint32_t parent = b->parents[i];
        if (above[i] == NONE)
            above[i] = above[parent];
        else if (parent != NONE)
            b->parents[i] = above[parent];
    }
    for (uint32_t i = 0; i < b->nodes && made; i++)
        if (above[i] != i)
            b->parents[i] = i;
    free(heaviest);
    free(kept);
    free(above);
    return made;
}

static void list_children(builder *b)
{
    for (uint32_t i = 0; i < b->nodes; i++)
        if (b->parents[i] != NONE && !is_left_out(b, i))
            b->firsts[b->parents[i] + 2]++;
    for (uint32_t i = 0; i < b->nodes; i++)
        b->firsts[i + 1] += b->firsts[i];
    for (uint32_t i = 0; i < b->nodes; i++)
        if (b->parents[i] != NONE && !is_left_out(b, i))
            b->children[b->firsts[b->parents[i] + 1]++] = i;
}

typedef struct queue {
    uint32_t *nodes;
    size_t count, room, at;
    size_t *ends;
    size_t batches, batch_room;
} queue;

static uint32_t child_count(const builder *b, uint32_t node)
{
    return b->firsts[node + 1] - b->firsts[node];
}

static int is_larger(const builder *b, uint32_t x, uint32_t y)
{
    return b->sizes[x] != b->sizes[y] ? b->sizes[x] > b->sizes[y] : x < y;
}

static void sift_down(const builder *b, uint32_t *heap, size_t count, size_t at)
{
    const uint32_t moved = heap[at];
    for (size_t child; (child = 2 * at + 1) < count; at = child) {
        child += child + 1 < count && is_larger(b, heap[child + 1], heap[child]);
        if (!is_larger(b, heap[child], moved))
            break;
        heap[at] = heap[child];
    }
    heap[at] = moved;
}

static void sift_up(const builder *b, uint32_t *heap, size_t at)
{
    const uint32_t moved = heap[at];
    for (; at > 0 && is_larger(b, moved, heap[(at - 1) / 2]); at = (at - 1) / 2)
        heap[at] = heap[(at - 1) / 2];
    heap[at] = moved;
}

static int add_batch(queue *q, const uint32_t *nodes, size_t count)
{
    if (q->count + count > q->room) {
        const size_t room = 2 * q->room + count;
        uint32_t *more = realloc(q->nodes, room * sizeof *more);
        if (!more)
            return 0;
        q->nodes = more;
        q->room = room;
    }
    if (q->batches == q->batch_room) {
        size_t *more = realloc(q->ends, (2 * q->batch_room + 16) * sizeof *more);
        if (!more)
            return 0;
        q->ends = more;
        q->batch_room = 2 * q->batch_room + 16;
    }
    memcpy(q->nodes + q->count, nodes, count * sizeof *nodes);
    q->count += count;
    q->ends[q->batches++] = q->count;
    return 1;
}

static size_t place_children(const builder *b, fxs_rad_tree *t, uint32_t *heap, size_t count, uint32_t *places,
                             uint32_t end)
{
    for (size_t i = count / 2; i-- > 0;)
        sift_down(b, heap, count, i);
    for (int is_first = 1; count > 0; is_first = 0) {
        const uint32_t node = heap[0], children = child_count(b, node);
        if (!is_first && t->count + children > end)
            break;
        heap[0] = heap[--count];
        if (count)
            sift_down(b, heap, count, 0);
        t->child_starts[places[node]] = t->count;
        t->child_counts[places[node]] = (uint16_t)children;
        for (uint32_t i = b->firsts[node]; i < b->firsts[node + 1]; i++) {
            const uint32_t child = b->children[i];
            places[child] = t->count;
            t->order[t->count++] = child;
            if (child_count(b, child)) {
                heap[count] = child;
                sift_up(b, heap, count++);
            }
        }
    }
    return count;
}

/* Returns the octant of the bounding box of all nodes in which a node lies. If the box is long, returns the half along
   its longest side. */
static int region_of(const builder *b, uint32_t node, const float low[3], const float high[3])
{
    const float *at = b->held->gaussians[node].position;
    float shortest = INFINITY, longest = 0;
    int axis = 0, octant = 0;
    for (int k = 0; k < 3; k++) {
        const float length = high[k] - low[k];
        axis = length > longest ? k : axis;
        longest = length > longest ? length : longest;
        shortest = length < shortest ? length : shortest;
        octant |= (at[k] < low[k] / 2 + high[k] / 2 ? 0 : 1) << k;
    }
    return longest >= 3 * shortest ? octant >> axis & 1 : octant;
}

static int split(const builder *b, queue *q, const uint32_t *nodes, size_t count, uint32_t *region)
{
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    int made = 1;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            const float x = b->held->gaussians[nodes[i]].position[k];
            low[k] = x < low[k] ? x : low[k];
            high[k] = x > high[k] ? x : high[k];
        }
    for (int which = 0; which < 8 && made; which++) {
        size_t found = 0;
        for (size_t i = 0; i < count; i++)
            if (region_of(b, nodes[i], low, high) == which)
                region[found++] = nodes[i];
        made = !found || add_batch(q, region, found);
    }
    return made;
}

static int place_all(const builder *b, fxs_rad_tree *t, queue *q, uint32_t root, uint32_t *heap, uint32_t *places,
                     uint32_t *region)
{
    t->order[t->count++] = root;
    places[root] = 0;
    int made = !child_count(b, root) || add_batch(q, &root, 1);
    for (size_t batch = 0; batch < q->batches && made; batch++) {
        const size_t count = q->ends[batch] - q->at;
        memcpy(heap, q->nodes + q->at, count * sizeof *heap);
        q->at = q->ends[batch];
        const size_t left = place_children(b, t, heap, count, places, t->count + (batch ? BATCH : ROOT_BATCH - 1));
        made = !left || split(b, q, heap, left, region);
    }
    return made;
}

static int order_nodes(const builder *b, fxs_rad_tree *t)
{
    const size_t room = b->nodes;
    queue q = {NULL, 0, 0, 0, NULL, 0, 0};
    uint32_t *heap = malloc(room * sizeof *heap), *places = malloc(room * sizeof *places),
             *region = malloc(room * sizeof *region);
    t->order = malloc(room * sizeof *t->order);
    t->child_starts = calloc(room, sizeof *t->child_starts);
    t->child_counts = calloc(room, sizeof *t->child_counts);
    const int made = heap && places && region && t->order && t->child_starts && t->child_counts &&
                     place_all(b, t, &q, b->reps[0], heap, places, region);
    free(q.nodes);
    free(q.ends);
    free(heap);
    free(places);
    free(region);
    return made;
}

int fxs_rad_tree_make(fxs_rad_tree *t, fxs_held *held, int (*progress)(void *argument, double done), void *argument)
{
    builder *b = calloc(1, sizeof *b);
    memset(t, 0, sizeof *t);
    if (!b)
        return 0;
    b->held = held;
    int made = fxs_levels_make(&b->levels, held, FXS_LEVELS_MOST, progress, argument) && make_room(b);
    if (made)
        make_nodes(b);
    made = made && thin_out(b);
    if (made)
        list_children(b);
    made = made && order_nodes(b, t);
    fxs_levels_free(&b->levels);
    free(b->parents);
    free(b->firsts);
    free(b->children);
    free(b->weights);
    free(b->sizes);
    free(b->reps);
    free(b->moments);
    free(b);
    return made;
}

void fxs_rad_tree_free(fxs_rad_tree *t)
{
    free(t->order);
    free(t->child_starts);
    free(t->child_counts);
}
