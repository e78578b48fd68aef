/* A leaf of the level-of-detail tree is a chunk (256 Gaussians). The tree's shape: all chunks, in order, are cut in two
 * where the sum of the costs of the two boxes is smallest; then each half is cut again. A node's chunk is merged from
 * its two children, depth first, so that few chunks are in memory at once. Nodes are numbered by descending number of
 * leaves, then by first leaf. So nodes for distant views lie together, and every node comes before its children. A part
 * of a scene is a run of its chunks, packed separately. The part builds the nodes with all leaves in this run: their
 * shape needs the boxes of all chunks, their contents only the run. Building the nodes above needs the sums of each
 * part's nodes, and the merged Gaussians of its topmost nodes as floats. */
#include <fixsplat/pack.h>
#include <fixsplat/internal/allocator.h>

#include "tree.h"
#include "src/base/report.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "src/base/exponential.h"
#include "src/base/try_internal.h"
#include "decode.h"
#include "src/core/codes.h"
#include "encode.h"
#include "coarsen.h"
#include "order.h"
#include "ways.h"
#include "src/core/animate.h"

enum {
    FREE_LEVELS = 40,   /* runs of leaves below this level of the level-of-detail tree are halved, to bound the depth */
    PARTS = 32                         /* one parallel job builds a subtree of at most max(4, leaves / PARTS) leaves */
};

#define NONE UINT32_MAX
#define UNMEASURED 0.2
#define SEEN 0.55                      /* visible share of a Gaussian's area: 0.5 for a disc, 0.58 for a ball */

typedef struct node {
    uint32_t first, leaves;
    uint32_t children[2];              /* the two children: index of a node, or number of nodes + index of a leaf */
    uint32_t parent, number;
    uint32_t part, at;               /* number of the part file with the node; index of the node's chunk in that file */
    fxs_node_sums sums;
} node;

typedef struct held {
    fxs_coarse gaussians[FXS_CHUNK];
    uint32_t count;
    double opacity;                    /* sum of opacities, of a moving scene their means over the span */
    fxs_range reach[3];
    float scale;                       /* log2 of the largest sigma in all chunks below the node */
    fxs_motion motions[FXS_CHUNK];     /* of a moving scene, like the next two */
    int32_t from_q16, to_q16;          /* when the chunk is alive, as in fxs_chunk_motion */
} held;

typedef struct worker {
    held *slots;
    held merged;
    fxs_merger *merger;
    fxs_way ways[2][FXS_CHUNK];        /* of a moving scene: of the two children's Gaussians, then of the merged ones */
    fxs_sh_item items[FXS_CHUNK];
    unsigned char records[FXS_CHUNK * FXS_RECORD_BYTES];
} worker;

typedef struct group {
    double sum, nodes;
    uint32_t heap;
    uint32_t left, right, rank;
    uint32_t into;
} group;

typedef struct fxs_tree tree;
struct fxs_tree {
    fxs_tree_run run;
    const fxs_tree_source *source;     /* callbacks that read part files; null: all leaves of the tree are in the run */
    fxs_pack_options options;
    fxs_encoder encoder;
    uint32_t count;
    node *nodes;                       /* nodes of the tree; each node comes before its children */
    uint32_t *places;                  /* index of each node by its number */
    fxs_motion_header motion;          /* of a moving scene; else zeros */
    fxs_motion_rows rows_of_motion;
    fxs_time time;
    uint32_t motion_bytes;             /* bytes of a Gaussian's motion codes */
    float (*boxes)[6];                 /* low and high corner of each leaf's box; only while planning */
    float (*spans)[2];                 /* when each leaf of a moving scene is alive, scaled to the boxes; or null */
    float *costs;
    uint32_t *subtrees, subtree_count;
    uint32_t built;
    uint32_t large;
    uint32_t limit;
    held **done;                       /* merged Gaussians of built nodes that wait for their parents; null: none */
    worker *workers;
    uint32_t worker_count;
};

void fxs_chunk_box(const fxs_chunk *chunk, float box[6])
{
    for (int i = 0; i < 3; i++) {
        const int64_t reach = (int64_t)chunk->step_q32[i] * 65535 << chunk->step_shift;
        box[i] = (float)ldexp((double)chunk->origin_q32[i], -32);
        box[3 + i] = (float)ldexp((double)(chunk->origin_q32[i] + reach), -32);
    }
}

void fxs_chunk_boxes(const unsigned char *chunks, uint32_t count, float (*boxes)[6])
{
    for (uint32_t i = 0; i < count; i++) {
        fxs_chunk chunk;
        memcpy(&chunk, chunks + (size_t)i * sizeof chunk, sizeof chunk);
        fxs_chunk_turn(&chunk);
        fxs_chunk_box(&chunk, boxes[i]);
    }
}

static void widen(float box[6], const float by[6])
{
    for (int i = 0; i < 3; i++) {
        box[i] = by[i] < box[i] ? by[i] : box[i];
        box[3 + i] = by[3 + i] > box[3 + i] ? by[3 + i] : box[3 + i];
    }
}

static void widen_span(float span[2], const float by[2])
{
    span[0] = by[0] < span[0] ? by[0] : span[0];
    span[1] = by[1] > span[1] ? by[1] : span[1];
}

static float cost_of(const float box[6], const float span[2], uint32_t leaves)
{
    const float x = box[3] - box[0], y = box[4] - box[1], z = box[5] - box[2], time = span[1] - span[0];
    return (x * x + y * y + z * z + time * time) * (float)leaves;
}

static uint32_t find_cut(tree *t, uint32_t first, uint32_t leaves, int level)
{
    static const float always[2];
    uint32_t best = leaves / 2;
    float box[6], span[2], least = INFINITY;
    if (level >= FREE_LEVELS)
        return best;
    memcpy(box, t->boxes[first + leaves - 1], sizeof box);
    memcpy(span, t->spans ? t->spans[first + leaves - 1] : always, sizeof span);
    for (uint32_t i = leaves - 1; i > 0; i--) {
        widen(box, t->boxes[first + i]);
        widen_span(span, t->spans ? t->spans[first + i] : always);
        t->costs[i] = cost_of(box, span, leaves - i);
    }
    memcpy(box, t->boxes[first], sizeof box);
    memcpy(span, t->spans ? t->spans[first] : always, sizeof span);
    for (uint32_t i = 1; i < leaves; i++) {
        widen(box, t->boxes[first + i - 1]);
        widen_span(span, t->spans ? t->spans[first + i - 1] : always);
        const float cost = cost_of(box, span, i) + t->costs[i];
        if (cost < least) {
            least = cost;
            best = i;
        }
    }
    return best;
}

static void cut_run(tree *t, uint32_t place, int level, uint32_t *next)
{
    node *n = &t->nodes[place];
    const uint32_t left = find_cut(t, n->first, n->leaves, level);
    for (int side = 0; side < 2; side++) {
        const uint32_t first = side ? n->first + left : n->first, leaves = side ? n->leaves - left : left;
        if (leaves == 1) {
            n->children[side] = t->count + first;
            continue;
        }
        const uint32_t child = (*next)++;
        n->children[side] = child;
        t->nodes[child] = (node){.first = first, .leaves = leaves, .parent = place, .part = FXS_TREE_ABOVE};
        cut_run(t, child, level + 1, next);
    }
}

static int compare_keys(const void *a, const void *b)
{
    const uint64_t *x = a, *y = b;
    return x[0] != y[0] ? (x[0] > y[0]) - (x[0] < y[0]) : (x[1] > y[1]) - (x[1] < y[1]);
}

static int number_nodes(tree *t)
{
    uint64_t (*keys)[2] = fxs_allocate(t->options.allocator, t->count, sizeof *keys);
    t->places = fxs_allocate(t->options.allocator, t->count, sizeof *t->places);
    for (uint32_t i = 0; i < t->count && keys; i++) {
        keys[i][0] = (uint64_t)(UINT32_MAX - t->nodes[i].leaves) << 32 | t->nodes[i].first;
        keys[i][1] = i;
    }
    if (keys)
        qsort(keys, t->count, sizeof *keys, compare_keys);
    for (uint32_t i = 0; i < t->count && keys && t->places; i++) {
        t->places[i] = (uint32_t)keys[i][1];
        t->nodes[keys[i][1]].number = i;
    }
    fxs_release(t->options.allocator, keys);
    return keys && t->places ? 0 : -1;
}

static int find_shape(tree *t)
{
    uint32_t next = 1;
    t->nodes = fxs_allocate(t->options.allocator, t->count, sizeof *t->nodes);
    t->costs = fxs_allocate(t->options.allocator, t->count + 1, sizeof *t->costs);
    if (!t->nodes || !t->costs)
        return -1;
    t->nodes[0] = (node){.leaves = t->count + 1, .parent = NONE, .part = FXS_TREE_ABOVE};
    cut_run(t, 0, 0, &next);
    fxs_release(t->options.allocator, t->costs);
    t->costs = 0;
    return number_nodes(t);
}

static int is_within(const node *n, uint32_t first, uint32_t end)
{
    return n->first >= first && n->first + n->leaves <= end;
}

/* Returns 1 if all leaves of a node, but not all leaves of its parent, lie in the run first..end - 1. */
static int is_topmost(const tree *t, const node *n, uint32_t first, uint32_t end)
{
    return is_within(n, first, end) && (n->parent == NONE || !is_within(&t->nodes[n->parent], first, end));
}

static int is_own(const tree *t, const node *n)
{
    return t->source ? n->part == FXS_TREE_ABOVE : is_within(n, t->run.first, t->run.end);
}

static void find_reach(held *h, const fxs_chunk *chunk)
{
    float box[6];
    fxs_chunk_box(chunk, box);
    for (int i = 0; i < 3; i++)
        h->reach[i] = (fxs_range){box[i], box[3 + i]};
    h->scale = (float)chunk->scale_q16 / 65536;
}

static void widen_range(fxs_range *range, const fxs_range *by)
{
    range->low = by->low < range->low ? by->low : range->low;
    range->high = by->high > range->high ? by->high : range->high;
}

static int moves(const tree *t)
{
    return t->run.node_motions != NULL;
}

static fxs_lifespan span_of(const held *h)
{
    return (fxs_lifespan){ldexp(h->from_q16, -16), ldexp(h->to_q16, -16)};
}

/* Reads the motion of the Gaussian that was decoded last. Returns the mean of its opacity, as a share of its
   largest. */
static double read_motion(const tree *t, const fxs_chunk_motion *m, const fxs_chunk *chunk, const unsigned char *rows,
                          uint32_t g, held *to)
{
    fxs_gaussian *gaussian = &to->gaussians[to->count].gaussian, copy;
    fxs_motion *motion = &to->motions[to->count];
    fxs_way way;
    fxs_decode_motion(&t->rows_of_motion, &t->motion, m, chunk, rows, g, gaussian, motion);
    copy = *gaussian;
    fxs_way_of(&way, &copy, motion, span_of(to), span_of(to));
    return (double)way.mean;
}

/* `motion` is null if the scene is still. */
static void read_coded(const tree *t, const unsigned char *header, const unsigned char *motion,
                       const unsigned char *rows, held *to)
{
    const fxs_scene *s = t->run.scene;
    fxs_chunk chunk;
    fxs_chunk_motion m;
    memcpy(&chunk, header, sizeof chunk);
    fxs_chunk_turn(&chunk);
    find_reach(to, &chunk);
    if (motion) {
        memcpy(&m, motion, sizeof m);
        fxs_chunk_motion_turn(&m);
        to->from_q16 = m.from_q16;
        to->to_q16 = m.to_q16;
    }
    to->opacity = 0;
    to->count = 0;
    for (uint32_t g = 0; g < FXS_CHUNK; g++)
        if (!fxs_slot_is_empty(s, rows, g)) {
            fxs_gaussian gaussian;
            fxs_decode(s, &chunk, rows, g, &gaussian);
            fxs_coarse_set(&to->gaussians[to->count], &gaussian);
            const double mean = motion ? read_motion(t, &m, &chunk, rows, g, to) : 1;
            to->opacity += mean * (double)fxs_coarse_drawn(&to->gaussians[to->count++]);
        }
}

static void read_leaf(const tree *t, uint32_t leaf, held *to)
{
    const size_t at = leaf - t->run.first;
    const unsigned char *motions = moves(t) ? t->run.scene->motion + sizeof(fxs_motion_header) : NULL;
    read_coded(t, t->run.chunks + at * sizeof(fxs_chunk), motions ? motions + at * sizeof(fxs_chunk_motion) : NULL,
               t->run.rows + at * t->run.scene->chunk_bytes, to);
}

static void copy_sorted(held *to, const held *from)
{
    fxs_order_entry order[FXS_CHUNK];
    for (uint32_t i = 0; i < from->count; i++) {
        memcpy(order[i].position, from->gaussians[i].gaussian.position, sizeof order[i].position);
        order[i].index = i;
    }
    fxs_order_chunk(order, from->count);
    for (uint32_t i = 0; i < from->count; i++) {
        to->gaussians[i] = from->gaussians[order[i].index];
        to->motions[i] = from->motions[order[i].index];
    }
    to->count = from->count;
}

/* Finds the time of a node's chunk and the largest drifts in it. */
static void time_chunk(const tree *t, const held *h, fxs_chunk_time *time, fxs_chunk_motion *motion)
{
    const fxs_lifespan span = span_of(h);
    const fxs_life all = {(float)span.from, (float)span.to, -INFINITY, INFINITY, 0};
    double low = INFINITY, high = -INFINITY;
    for (uint32_t i = 0; i < h->count; i++)
        if (h->motions[i].fade < INFINITY) {
            low = fmin(low, h->motions[i].centre);
            high = fmax(high, h->motions[i].centre);
        }
    fxs_chunk_time_set(time, motion, &all, fmin(low, span.to), fmax(high, span.from), &t->time);
    motion->from_q16 = h->from_q16;
    motion->to_q16 = h->to_q16;
    for (uint32_t i = 0; i < h->count; i++)
        fxs_motion_take(time, &h->gaussians[i].gaussian, &h->motions[i]);
}

/* Writes the motion of a node's chunk, and the motions of its Gaussians behind their records. */
static void write_motion(const tree *t, worker *w, const held *h, size_t at, fxs_chunk *chunk,
                         const fxs_chunk_time *time, fxs_chunk_motion *motion)
{
    const uint32_t bytes = t->run.scene->chunk_bytes / FXS_CHUNK;
    fxs_chunk_shift_set(motion, time, chunk);
    for (uint32_t i = 0; i < h->count; i++)
        fxs_motion_encode(w->records + (i + 1) * bytes - t->motion_bytes, &t->time, time, motion, chunk,
                          &h->gaussians[i].gaussian, &h->motions[i]);
    fxs_chunk_motion_turn(motion);
    memcpy(t->run.node_motions + at * sizeof *motion, motion, sizeof *motion);
}

/* Returns a Gaussian as its codes have it: of a moving scene, in the middle of the chunk's time. */
static fxs_gaussian at_rest(const tree *t, const held *h, uint32_t i, const fxs_chunk_time *time)
{
    fxs_gaussian g = h->gaussians[i].gaussian;
    if (moves(t))
        fxs_motion_rest(&g, &h->motions[i], time);
    return g;
}

static void write_chunk(const tree *t, worker *w, held *h, size_t at)
{
    static const fxs_scene_file_info any;
    const fxs_scene *s = t->run.scene;
    const uint32_t bytes = s->chunk_bytes / FXS_CHUNK;
    fxs_chunk_ranges ranges;
    fxs_chunk chunk;
    fxs_loss loss = {{0}, {0}};
    fxs_sh_loss sh_loss = {0, 0};
    fxs_chunk_time time = {0, 0, {0, 0, 0}};
    fxs_chunk_motion motion;
    if (moves(t))
        time_chunk(t, h, &time, &motion);
    fxs_ranges_clear(&ranges);
    for (uint32_t i = 0; i < h->count; i++) {
        fxs_hold_scales(&h->gaussians[i].gaussian);
        const fxs_gaussian g = at_rest(t, h, i, &time);
        fxs_ranges_take(&ranges, &g, (double)h->gaussians[i].opacity, t->encoder.sh_degree);
    }
    for (int i = 0; i < 3; i++)        /* a node's box and sigma cover its descendants, so a node is visible
                                          whenever a descendant is */
        widen_range(&ranges.position[i], &h->reach[i]);
    ranges.scale.high = h->scale > ranges.scale.high ? h->scale : ranges.scale.high;
    fxs_encode_header(&chunk, &ranges, &any);
    if (moves(t))
        chunk.opacity_law = 0;           /* codes in proportion to the opacity, so that a fade is a product */
    find_reach(h, &chunk);
    memset(w->records, 0, s->chunk_bytes);
    for (uint32_t i = 0; i < h->count; i++) {
        const fxs_gaussian g = at_rest(t, h, i, &time);
        const double opacity = (double)h->gaussians[i].opacity;
        unsigned char record[FXS_RECORD_BYTES] = {0};
        fxs_encode(&t->encoder, &chunk, &g, opacity, record, &loss);
        memcpy(w->records + i * bytes, record, bytes);
        if (t->run.palette)
            fxs_sh_item_set(&w->items[i], &g, opacity, t->encoder.sh_degree);
    }
    if (t->run.palette)
        fxs_palette_code_chunk(t->run.palette, w->items, h->count, chunk.sh_mean,
                               w->records + bytes - t->motion_bytes - fxs_sh_bytes(s->profile, s->sh_degree), bytes,
                               &sh_loss);
    if (moves(t))
        write_motion(t, w, h, at, &chunk, &time, &motion);
    fxs_encode_rows(&t->encoder, t->motion_bytes, w->records, t->run.node_rows + at * s->chunk_bytes);
    fxs_chunk_turn(&chunk);
    memcpy(t->run.node_chunks + at * sizeof chunk, &chunk, sizeof chunk);
}

/* `ways` is null if the scene is still. */
static void add_own(const tree *t, node *n, const held *h, const fxs_way *ways)
{
    n->sums.own = n->sums.area = 0;
    for (uint32_t i = 0; i < h->count; i++) {
        const double share = ways && t->time.fades ? fxs_way_share(&ways[i]) : 1;
        const double drawn = share * (double)fxs_coarse_drawn(&h->gaussians[i]);
        n->sums.own += drawn;
        n->sums.area += SEEN * drawn * (double)h->gaussians[i].area;
    }
}

static void widen_held(held *h, const held *by)
{
    for (int i = 0; i < 3; i++)
        widen_range(&h->reach[i], &by->reach[i]);
    h->scale = h->scale > by->scale ? h->scale : by->scale;
}

/* Replaces invalid positions of merged Gaussians, because numbers from a part file are untrusted. */
static void hold_places(held *h, const held *child)
{
    for (uint32_t i = 0; i < h->count; i++)
        for (int k = 0; k < 3; k++) {
            float *x = &h->gaussians[i].gaussian.position[k];
            *x = fabsf(*x) <= 0x1p28f ? *x : child->reach[k].low;
        }
}

/* Adds the moving Gaussians of a child to the set. Adds the error of Gaussians that cannot fade, and are drawn with a
   share s of their opacity at times when they are not there: s (1 - s) of their square. */
static void add_moving(const tree *t, worker *w, held *h, fxs_way *ways, fxs_lifespan set, fxs_merge_error *error)
{
    const fxs_lifespan own = span_of(h);
    for (uint32_t i = 0; i < h->count; i++) {
        fxs_gaussian g = h->gaussians[i].gaussian;
        fxs_way_of(&ways[i], &g, &h->motions[i], own, set);
        fxs_coarse_set(&h->gaussians[i], &g);
        const double drawn = (double)fxs_coarse_drawn(&h->gaussians[i]), share = (double)ways[i].mean;
        const double square = drawn * drawn * (double)h->gaussians[i].area * share * (1 - share);
        error->error += t->time.fades ? 0 : square;
        error->size += t->time.fades ? 0 : square * (double)h->gaussians[i].area;
    }
    fxs_merge_add_moving(w->merger, h->gaussians, ways, h->count, t->time.fades);
    h->opacity *= (own.to - own.from) / (set.to - set.from);
}

/* Merges the moving Gaussians of two children. The first becomes alive when the node is. */
static void merge_moving(const tree *t, worker *w, held *first, held *second, fxs_merge_error *error)
{
    held *out = &w->merged;
    fxs_merge_error windows = {0, 0};
    fxs_way *ways = w->ways[0];
    const int32_t from_q16 = first->from_q16 < second->from_q16 ? first->from_q16 : second->from_q16;
    const int32_t to_q16 = first->to_q16 > second->to_q16 ? first->to_q16 : second->to_q16;
    const fxs_lifespan set = {ldexp(from_q16, -16), ldexp(to_q16, -16)};
    add_moving(t, w, first, w->ways[0], set, &windows);
    add_moving(t, w, second, w->ways[1], set, &windows);
    out->count = fxs_merge_end(w->merger, FXS_CHUNK, out->gaussians, error);
    error->error += windows.error;
    error->size += windows.size;
    fxs_merge_ways(w->merger, ways);
    for (uint32_t i = 0; i < out->count; i++) {
        ways[i].width = t->time.fades ? ways[i].width : 1;
        fxs_way_motion(&out->motions[i], &out->gaussians[i].gaussian, &ways[i], set);
    }
    first->from_q16 = from_q16;
    first->to_q16 = to_q16;
}

static void merge_children(tree *t, worker *w, uint32_t place, held *first, held *second)
{
    node *n = &t->nodes[place];
    fxs_merge_error error;
    held *out = &w->merged;
    fxs_merge_begin(w->merger, t->encoder.sh_degree);
    if (moves(t))
        merge_moving(t, w, first, second, &error);
    else {
        fxs_merge_add(w->merger, first->gaussians, first->count);
        fxs_merge_add(w->merger, second->gaussians, second->count);
        out->count = fxs_merge_end(w->merger, FXS_CHUNK, out->gaussians, &error);
    }
    hold_places(out, first);
    n->sums.error = error.error;
    n->sums.size = error.size;
    first->opacity += second->opacity;
    n->sums.opacity = first->opacity;
    add_own(t, n, out, moves(t) ? w->ways[0] : NULL);
    copy_sorted(first, out);
    widen_held(first, second);
    write_chunk(t, w, first, n->at);
}

static uint32_t leaves_of(const tree *t, uint32_t child)
{
    return child < t->count ? t->nodes[child].leaves : 1;
}

/* Returns which child of a node to build first: the child with more leaves, or in a large node the first child that is
   not a leaf. */
static int first_side(const tree *t, const node *n)
{
    const uint32_t *children = n->children;
    return n->leaves > t->large ? children[0] >= t->count : leaves_of(t, children[1]) > leaves_of(t, children[0]);
}

/* Builds the subtree of a child. Building the child with more leaves first bounds the number of chunks in memory by
   log2(leaves). */
static void build(tree *t, worker *w, uint32_t child, uint32_t at)
{
    if (child >= t->count) {
        read_leaf(t, child - t->count, &w->slots[at]);
        return;
    }
    const node *n = &t->nodes[child];
    const int first = first_side(t, n);
    build(t, w, n->children[first], at);
    build(t, w, n->children[!first], at + 1);
    merge_children(t, w, child, &w->slots[at], &w->slots[at + 1]);
}

static void build_subtree(void *argument, uint32_t job)
{
    tree *t = argument;
    worker *w = &t->workers[job];
    const uint32_t place = t->subtrees[t->built + job];
    build(t, w, place, 0);
    memcpy(t->done[place], &w->slots[0], sizeof(held));
}

static int note_built(const tree *t, uint32_t leaves)
{
    const double all = t->run.end - t->run.first + 1.0;
    return fxs_report(&t->options.progress, leaves / all);
}

static int build_subtrees(tree *t)
{
    for (uint32_t leaves = 0; t->built < t->subtree_count; t->built += t->worker_count) {
        const uint32_t left = t->subtree_count - t->built, jobs = left < t->worker_count ? left : t->worker_count;
        if (note_built(t, leaves))
            return 1;
        t->options.workers.run(t->options.workers.pool, build_subtree, t, jobs);
        for (uint32_t i = 0; i < jobs; i++)
            leaves += t->nodes[t->subtrees[t->built + i]].leaves;
    }
    return note_built(t, t->run.end - t->run.first + 1);
}

/* Gets the Gaussians of a node's child. The caller frees them. */
static int take_child(tree *t, uint32_t child, held **to, fxs_message *message)
{
    const node *n = child < t->count ? &t->nodes[child] : NULL;
    if (n && t->done[child]) {
        *to = t->done[child];
        t->done[child] = 0;
        return 0;
    }
    held *h = *to = fxs_allocate(t->options.allocator, 1, sizeof *h);
    const unsigned char *header, *rows;
    fxs_chunk chunk;
    if (!h)
        return fxs_fail_memory(message, NULL, 0);
    if (!t->source) {
        read_leaf(t, child - t->count, h);
        return 0;
    }
    if (!n) {
        FXS_TRY(t->source->leaf(t->source->argument, child - t->count, &header, &rows, message));
        read_coded(t, header, NULL, rows, h);
        return 0;
    }
    FXS_TRY(t->source->top(t->source->argument, n->part, n->at, &chunk, h->gaussians, &h->count, message));
    find_reach(h, &chunk);
    h->opacity = n->sums.opacity;
    return 0;
}

static int build_node(tree *t, uint32_t place, fxs_message *message)
{
    const node *n = &t->nodes[place];
    const int side = first_side(t, n);
    held *first = 0, *second = 0;
    int error = take_child(t, n->children[side], &first, message);
    if (!error)
        error = take_child(t, n->children[!side], &second, message);
    if (!error)
        merge_children(t, &t->workers[0], place, first, second);
    fxs_release(t->options.allocator, second);
    t->done[place] = first;
    return error;
}

static int build_top(tree *t, fxs_message *message)
{
    int error = 0;
    for (uint32_t i = t->count; i-- > 0 && !error;)
        if (is_own(t, &t->nodes[i]) && t->nodes[i].leaves > t->limit)
            error = build_node(t, i, message);
    return error;
}

static int is_subtree(const tree *t, uint32_t place)
{
    const node *n = &t->nodes[place];
    const node *above = n->parent == NONE ? NULL : &t->nodes[n->parent];
    return is_own(t, n) && n->leaves <= t->limit && (!above || !is_own(t, above) || above->leaves > t->limit);
}

static int find_subtrees(tree *t)
{
    const fxs_allocator *allocator = t->options.allocator;
    uint32_t own = 0;
    t->subtrees = fxs_allocate(allocator, t->count, sizeof *t->subtrees);
    t->done = fxs_allocate_zeroed(allocator, t->count, sizeof *t->done);
    int error = !t->subtrees || !t->done;
    for (uint32_t i = 0; i < t->count && !error; i++) {
        node *n = &t->nodes[t->places[i]];
        if (is_own(t, n))
            n->at = own++;
        if (is_subtree(t, t->places[i])) {
            t->subtrees[t->subtree_count++] = t->places[i];
            t->done[t->places[i]] = fxs_allocate(allocator, 1, sizeof(held));
            error = !t->done[t->places[i]];
        }
    }
    return error;
}

static int make_workers(tree *t)
{
    const fxs_allocator *allocator = t->options.allocator;
    uint32_t slots = 2;
    for (uint32_t leaves = t->limit; leaves > 1; leaves /= 2)
        slots++;
    t->worker_count = t->source ? 1 : t->options.workers.count;
    t->workers = fxs_allocate_zeroed(allocator, t->worker_count, sizeof *t->workers);
    for (uint32_t i = 0; i < t->worker_count && t->workers; i++) {
        t->workers[i].slots = fxs_allocate(allocator, slots, sizeof *t->workers[i].slots);
        t->workers[i].merger = fxs_allocate(allocator, 1, fxs_merger_bytes());
        if (!t->workers[i].slots || !t->workers[i].merger)
            return -1;
    }
    return t->workers ? 0 : -1;
}

static double gain_of(const group *g)
{
    return g->sum / g->nodes;
}

/* Melds two leftist heaps (Crane 1972). */
static uint32_t meld(group *g, uint32_t a, uint32_t b)
{
    if (a == NONE || b == NONE)
        return a == NONE ? b : a;
    const int is_first = gain_of(&g[a]) > gain_of(&g[b]) || (gain_of(&g[a]) == gain_of(&g[b]) && a < b);
    const uint32_t top = is_first ? a : b;
    g[top].right = meld(g, g[top].right, is_first ? b : a);
    const uint32_t left = g[top].left, right = g[top].right;
    if (left == NONE || g[left].rank < g[right].rank) {
        g[top].left = right;
        g[top].right = left;
    }
    g[top].rank = g[top].right == NONE ? 1 : g[g[top].right].rank + 1;
    return top;
}

/* Pools the gains of tree nodes. The gain of a node is the error that replacing the node by its children removes. A
   node absorbs the group of descendants with the largest mean gain, while that gain exceeds the node's own. */
static void pool_gains(const tree *t, group *g)
{
    for (uint32_t i = t->count; i-- > 0;) {
        const node *n = &t->nodes[i];
        g[i] = (group){n->sums.error, 1, NONE, NONE, NONE, 1, NONE};
        for (int side = 0; side < 2; side++)
            if (n->children[side] < t->count)
                g[i].heap = meld(g, g[i].heap, n->children[side]);
        while (g[i].heap != NONE && gain_of(&g[g[i].heap]) > gain_of(&g[i])) {
            group *below = &g[g[i].heap];
            g[i].sum += below->sum;
            g[i].nodes += below->nodes;
            below->into = i;
            g[i].heap = meld(g, meld(g, below->left, below->right), below->heap);
        }
    }
    for (uint32_t i = 0; i < t->count; i++)
        if (g[i].into != NONE) {
            g[i].sum = g[g[i].into].sum;
            g[i].nodes = g[g[i].into].nodes;
        }
}

/* Returns round(scale log2(x)) clamped to +-most; -most for x <= 0. */
static int32_t log2_of(double x, int scale, int most)
{
    return x > 0 ? fxs_floor_within(scale * FXS_LOG2_E * fxs_log(x) + 0.5, -most, most) : -most;
}

static uint32_t number_of(const tree *t, uint32_t child)
{
    return child < t->count ? t->count + 1 + t->nodes[child].number : child - t->count;
}

static fxs_node node_at(const unsigned char *nodes, uint32_t i)
{
    fxs_node n;
    memcpy(&n, nodes + (size_t)i * sizeof n, sizeof n);
    fxs_node_turn(&n);
    return n;
}

static void put_node(unsigned char *nodes, uint32_t i, fxs_node n)
{
    fxs_node_turn(&n);
    memcpy(nodes + (size_t)i * sizeof n, &n, sizeof n);
}

static void set_swell(fxs_node *to, const fxs_node_sums *sums)
{
    const double swell = sums->own > 0 ? sums->opacity / sums->own : 1;
    to->area_q8 = (int16_t)(sums->own > 0 ? log2_of(sums->area / sums->own, 256, INT16_MAX) : 0);
    to->swell_q8 = (uint16_t)(swell > 1 ? log2_of(swell, 256, FXS_SWELL_MOST_Q8) : 0);
}

int fxs_tree_write(const fxs_tree *t, unsigned char *to, fxs_message *message)
{
    group *groups = fxs_allocate(t->options.allocator, t->count, sizeof *groups);
    if (!groups)
        return fxs_fail_memory(message, NULL, t->count * sizeof *groups);
    pool_gains(t, groups);
    for (uint32_t i = 0; i < t->count; i++) {
        const node *n = &t->nodes[i];
        const fxs_node_sums *s = &n->sums;
        fxs_node out = {{number_of(t, n->children[0]), number_of(t, n->children[1])},
                        (int16_t)log2_of(gain_of(&groups[i]), 256, INT16_MAX),
                        (int16_t)(s->error > 0 ? log2_of(s->size / s->error, 128, INT16_MAX) : 0), 0, 0};
        set_swell(&out, s);
        put_node(to, n->number, out);
    }
    fxs_release(t->options.allocator, groups);
    return 0;
}

static uint32_t parts_of(uint32_t leaves)
{
    return leaves / PARTS > 4 ? leaves / PARTS : 4;
}

/* Scales times so that the duration of a moving scene is as long as the diagonal of its box. */
static void scale_spans(tree *t, float (*spans)[2], uint32_t leaves)
{
    static const float always[2];
    float box[6];
    memcpy(box, t->boxes[0], sizeof box);
    for (uint32_t i = 1; i < leaves; i++)
        widen(box, t->boxes[i]);
    const float unit = sqrtf(cost_of(box, always, 1));
    for (uint32_t i = 0; i < leaves; i++)
        for (int k = 0; k < 2; k++)
            spans[i][k] *= unit;
    t->spans = spans;
}

int fxs_tree_plan(fxs_tree **planned, float (*boxes)[6], float (*spans)[2], uint32_t leaves,
                  const fxs_pack_options *options, fxs_message *message)
{
    tree *t = *planned = fxs_allocate_zeroed(options->allocator, 1, sizeof *t);
    if (!t)
        return fxs_fail_memory(message, NULL, sizeof *t);
    t->options = *options;
    t->boxes = boxes;
    t->count = leaves - 1;
    t->large = parts_of(leaves);
    if (spans)
        scale_spans(t, spans, leaves);
    const int error = find_shape(t);
    t->boxes = 0;
    t->spans = 0;
    return error ? fxs_fail_memory(message, NULL, 0) : 0;
}

static void end_run(tree *t)
{
    const fxs_allocator *allocator = t->options.allocator;
    for (uint32_t i = 0; i < t->count && t->done; i++)
        fxs_release(allocator, t->done[i]);
    fxs_release(allocator, t->done);
    fxs_release(allocator, t->subtrees);
    for (uint32_t i = 0; i < t->worker_count && t->workers; i++) {
        fxs_release(allocator, t->workers[i].slots);
        fxs_release(allocator, t->workers[i].merger);
    }
    fxs_release(allocator, t->workers);
    t->done = 0;
    t->subtrees = 0;
    t->workers = 0;
}

void fxs_tree_free(fxs_tree *t)
{
    if (!t)
        return;
    end_run(t);
    const fxs_allocator *allocator = t->options.allocator;
    fxs_release(allocator, t->costs);
    fxs_release(allocator, t->places);
    fxs_release(allocator, t->nodes);
    fxs_release(allocator, t);
}

void fxs_tree_count_within(const fxs_tree *t, uint32_t first, uint32_t end, uint32_t *nodes, uint32_t *tops)
{
    *nodes = *tops = 0;
    for (uint32_t i = 0; i < t->count; i++) {
        *nodes += (uint32_t)is_within(&t->nodes[i], first, end);
        *tops += (uint32_t)is_topmost(t, &t->nodes[i], first, end);
    }
}

static void write_run(const tree *t)
{
    const fxs_tree_run *r = &t->run;
    uint32_t nodes = 0, tops = 0;
    for (uint32_t i = 0; i < t->count; i++) {
        const node *n = &t->nodes[t->places[i]];
        if (!is_own(t, n))
            continue;
        fxs_node_sums sums = n->sums;
        fxs_node_sums_turn(&sums);
        memcpy(r->sums + nodes++ * sizeof sums, &sums, sizeof sums);
        if (!is_topmost(t, n, r->first, r->end))
            continue;
        const held *h = t->done[t->places[i]];
        unsigned char *to = r->tops + tops++ * FXS_TREE_TOP_BYTES;
        const uint32_t head[2] = {fxs_little_32(n->at), fxs_little_32(h->count)};
        memcpy(to, head, sizeof head);
        memcpy(to + FXS_TREE_TOP_HEAD, h->gaussians, h->count * sizeof *h->gaussians);
        fxs_little_endian(to, FXS_TREE_TOP_HEAD, h->count * sizeof *h->gaussians / sizeof(float), sizeof(float));
    }
}

static int take_motion(tree *t, fxs_message *message)
{
    fxs_motion_header *m = &t->motion;
    if (fxs_motion_read(m, t->run.scene))
        return fxs_fail(message, "the scene's motion is damaged");
    t->rows_of_motion = fxs_motion_rows_of(t->run.scene, m);
    t->motion_bytes = fxs_motion_bytes(m->degree, m->flags) / FXS_CHUNK;
    t->time = (fxs_time){.duration = ldexp(m->duration_q16, -16), .degree = (int)m->degree,
                         .turns = (m->flags & FXS_MOTION_TURNS) != 0, .fades = (m->flags & FXS_MOTION_FADES) != 0};
    return 0;
}

static int build_run(tree *t, const fxs_tree_run *run, const fxs_pack_options *options, fxs_message *message)
{
    if (FLT_EVAL_METHOD != 0)
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "levels of detail need IEEE single precision: this build "
                           "computes with more digits");
    t->run = *run;
    t->options = *options;
    t->encoder = (fxs_encoder){run->scene->profile, run->scene->sh_degree};
    t->limit = t->source ? 0 : parts_of(run->end - run->first);
    if (moves(t))
        FXS_TRY(take_motion(t, message));
    if (find_subtrees(t) || make_workers(t))
        return fxs_fail_memory(message, NULL, 0);
    if (build_subtrees(t))
        return fxs_fail_as(FXS_ERR_STOPPED, message, "import stopped");
    FXS_TRY(build_top(t, message));
    if (run->sums)
        write_run(t);
    return 0;
}

int fxs_tree_build_run(fxs_tree *t, const fxs_tree_run *run, const fxs_pack_options *options, fxs_message *message)
{
    const int error = build_run(t, run, options, message);
    end_run(t);
    return error;
}

/* Finds when the leaves are alive, as shares of the duration. */
static void find_spans(const fxs_scene *scene, float (*spans)[2])
{
    fxs_motion_header header;
    fxs_chunk_motion m;
    memcpy(&header, scene->motion, sizeof header);
    fxs_motion_header_turn(&header);
    for (uint32_t i = 0; i < scene->chunk_count; i++) {
        memcpy(&m, scene->motion + sizeof header + i * sizeof m, sizeof m);
        fxs_chunk_motion_turn(&m);
        spans[i][0] = (float)m.from_q16 / (float)header.duration_q16;
        spans[i][1] = (float)m.to_q16 / (float)header.duration_q16;
    }
}

int fxs_tree_build(const fxs_scene *scene, void *data, const fxs_palette *palette, const fxs_pack_options *options,
                   fxs_message *message)
{
    unsigned char *bytes = data;
    const size_t before = sizeof(fxs_motion_header) + scene->chunk_count * sizeof(fxs_chunk_motion);
    unsigned char *node_motions = scene->motion ? bytes + (scene->motion - bytes) + before : NULL;
    const fxs_tree_run run = {.scene = scene, .palette = palette, .end = scene->chunk_count, .chunks = scene->chunks,
                              .rows = scene->rows, .node_chunks = bytes + (scene->node_chunks - bytes),
                              .node_rows = bytes + (scene->node_rows - bytes), .node_motions = node_motions};
    float (*boxes)[6] = fxs_allocate(options->allocator, scene->chunk_count, sizeof *boxes);
    float (*spans)[2] = fxs_allocate(options->allocator, scene->chunk_count, sizeof *spans);
    fxs_tree *t = NULL;
    int error = boxes && spans ? 0 : fxs_fail_memory(message, NULL, scene->chunk_count * sizeof *boxes);
    if (!error) {
        fxs_chunk_boxes(scene->chunks, scene->chunk_count, boxes);
        if (scene->motion)
            find_spans(scene, spans);
        error = fxs_tree_plan(&t, boxes, scene->motion ? spans : NULL, scene->chunk_count, options, message);
    }
    fxs_release(options->allocator, boxes);
    fxs_release(options->allocator, spans);
    if (!error)
        error = fxs_tree_build_run(t, &run, options, message);
    if (!error)
        error = fxs_tree_write(t, bytes + (scene->nodes - bytes), message);
    fxs_tree_free(t);
    return error;
}

void fxs_tree_take_part(fxs_tree *t, uint32_t part, uint32_t first, uint32_t end, const unsigned char *sums)
{
    uint32_t at = 0;
    for (uint32_t i = 0; i < t->count; i++) {
        node *n = &t->nodes[t->places[i]];
        if (!is_within(n, first, end))
            continue;
        memcpy(&n->sums, sums + at * sizeof n->sums, sizeof n->sums);
        fxs_node_sums_turn(&n->sums);
        n->part = part;
        n->at = at++;
    }
}

uint32_t fxs_tree_count_above(const fxs_tree *t)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < t->count; i++)
        count += t->nodes[i].part == FXS_TREE_ABOVE;
    return count;
}

int fxs_tree_build_above(fxs_tree *t, const fxs_tree_run *run, const fxs_tree_source *source,
                         const fxs_pack_options *options, fxs_message *message)
{
    t->source = source;
    return fxs_tree_build_run(t, run, options, message);
}

uint32_t fxs_tree_find(const fxs_tree *t, uint32_t number, uint32_t *at)
{
    const node *n = &t->nodes[t->places[number]];
    *at = n->at;
    return n->part;
}

struct fxs_tree_editor {
    tree tree;                         /* tree in which every node's index equals its number */
    worker worker;
    held held[2];
    unsigned char *nodes;
    fxs_palette palette;
};

static void take_node(tree *t, uint32_t number)
{
    const fxs_node from = node_at(t->run.scene->nodes, number);
    t->nodes[number] = (node){.number = number, .at = number};
    for (int i = 0; i < 2; i++)
        t->nodes[number].children[i] =
            from.children[i] > t->count ? from.children[i] - t->count - 1 : from.children[i] + t->count;
}

int fxs_tree_edit(fxs_tree_editor **editor, const fxs_scene *scene, void *data, fxs_message *message)
{
    fxs_tree_editor *e = *editor = fxs_allocate_zeroed(NULL, 1, sizeof *e);
    if (!e)
        return fxs_fail_memory(message, NULL, sizeof *e);
    unsigned char *bytes = data;
    e->nodes = bytes + (scene->nodes - bytes);
    e->tree = (tree){.encoder = {scene->profile, scene->sh_degree}, .count = scene->chunk_count - 1};
    e->tree.run = (fxs_tree_run){.scene = scene, .end = scene->chunk_count, .chunks = scene->chunks,
                                 .rows = scene->rows, .node_chunks = bytes + (scene->node_chunks - bytes),
                                 .node_rows = bytes + (scene->node_rows - bytes)};
    if (scene->palette) {
        fxs_palette_of_scene(&e->palette, scene);
        e->tree.run.palette = &e->palette;
    }
    e->tree.nodes = fxs_allocate(NULL, e->tree.count, sizeof *e->tree.nodes);
    e->worker.merger = fxs_allocate(NULL, 1, fxs_merger_bytes());
    if (!e->tree.nodes || !e->worker.merger) {
        fxs_tree_edit_end(e);
        *editor = NULL;
        return fxs_fail_memory(message, NULL, e->tree.count * sizeof *e->tree.nodes);
    }
    for (uint32_t i = 0; i < e->tree.count; i++)
        take_node(&e->tree, i);
    return 0;
}

void fxs_tree_edit_end(fxs_tree_editor *e)
{
    if (e) {
        fxs_release(NULL, e->tree.nodes);
        fxs_release(NULL, e->worker.merger);
    }
    fxs_release(NULL, e);
}

static void read_child(const tree *t, uint32_t child, held *to)
{
    const fxs_scene *s = t->run.scene;
    if (child < t->count)
        read_coded(t, s->node_chunks + (size_t)child * sizeof(fxs_chunk), NULL,
                   s->node_rows + (size_t)child * s->chunk_bytes, to);
    else
        read_leaf(t, child - t->count, to);
}

void fxs_tree_edit_merge(fxs_tree_editor *e, uint32_t number)
{
    const uint32_t *children = e->tree.nodes[number].children;
    read_child(&e->tree, children[0], &e->held[0]);
    read_child(&e->tree, children[1], &e->held[1]);
    merge_children(&e->tree, &e->worker, number, &e->held[0], &e->held[1]);
}

/* Clears the opacity correction of a tree node, because fitted Gaussians already have the opacity of the leaves. */
static void clear_swell(const fxs_tree_editor *e, uint32_t number)
{
    fxs_node n = node_at(e->nodes, number);
    n.swell_q8 = 0;
    put_node(e->nodes, number, n);
}

void fxs_tree_edit_node(fxs_tree_editor *e, uint32_t number, const fxs_gaussian *gaussians, uint32_t count)
{
    const uint32_t *children = e->tree.nodes[number].children;
    held *to = &e->held[0], *from = &e->held[1];
    read_child(&e->tree, children[0], to);
    read_child(&e->tree, children[1], from);
    widen_held(to, from);
    for (uint32_t i = 0; i < count; i++) {
        fxs_gaussian g = gaussians[i];
        for (int k = 0; k < 3; k++)
            g.position[k] = fminf(fmaxf(g.position[k], to->reach[k].low), to->reach[k].high);
        fxs_coarse_set(&from->gaussians[i], &g);
    }
    from->count = count;
    clear_swell(e, number);
    copy_sorted(to, from);
    write_chunk(&e->tree, &e->worker, to, number);
}

/* Mixes the stored gains of tree nodes into the measured errors, so that nodes outside all views keep a gain. */
static void blend_errors(fxs_tree_editor *e, const double *errors)
{
    const tree *t = &e->tree;
    double measured = 0, known = 0;
    for (uint32_t i = 0; i < t->count; i++) {
        t->nodes[i].sums.error = fxs_exp(node_at(e->nodes, i).gain_q8 / (256 * FXS_LOG2_E));
        measured += errors[i] > 0 ? errors[i] : 0;
        known += errors[i] > 0 ? t->nodes[i].sums.error : 0;
    }
    for (uint32_t i = 0; i < t->count; i++)
        t->nodes[i].sums.error = errors[i] + (known > 0 ? UNMEASURED * measured / known : 0) * t->nodes[i].sums.error;
}

int fxs_tree_edit_gains(fxs_tree_editor *e, const double *errors, fxs_message *message)
{
    const tree *t = &e->tree;
    group *groups = fxs_allocate(NULL, t->count, sizeof *groups);
    if (!groups)
        return fxs_fail_memory(message, NULL, t->count * sizeof *groups);
    blend_errors(e, errors);
    pool_gains(t, groups);
    for (uint32_t i = 0; i < t->count; i++) {
        fxs_node n = node_at(e->nodes, i);
        n.gain_q8 = (int16_t)log2_of(gain_of(&groups[i]), 256, INT16_MAX);
        put_node(e->nodes, i, n);
    }
    fxs_release(NULL, groups);
    return 0;
}
