/* Maximum flow by Dinic's method: levels are the distances to the sink, found anew until no node with flow left reaches
 * it. Source and sink are not nodes: `left` has what a node can still take from the source, or give to the sink if it
 * is below 0. */
#include "min_cut.h"

#include <string.h>

#define NONE UINT32_MAX

/* One direction of an edge. Its capacity is what is left of it. */
typedef struct arc {
    uint32_t head, back;               /* node at its end, and the arc in the other direction */
    int32_t capacity;
} arc;

/* The arcs of node i are those from first[i] to before first[i + 1]. */
typedef struct graph {
    uint32_t nodes;
    int32_t *left;
    uint32_t *first, *now;             /* first arc of a node, and the one that the search has come to */
    arc *arcs;
    uint32_t *level;                   /* arcs to the sink, plus 1; 0: none leads there */
    uint32_t *queue;
} graph;

static void add_edge(graph *g, const fxs_edge *edge)
{
    const uint32_t forth = g->now[edge->a]++, back = g->now[edge->b]++;
    g->arcs[forth] = (arc){edge->b, back, edge->capacity};
    g->arcs[back] = (arc){edge->a, forth, edge->capacity};
}

static int graph_make(graph *g, int32_t *terminals, uint32_t nodes, const fxs_edge *edges, uint32_t count,
                      const fxs_allocator *allocator)
{
    const size_t n = (size_t)nodes + 1;
    *g = (graph){.nodes = nodes, .left = terminals};
    g->first = fxs_allocate_zeroed(allocator, n, sizeof *g->first);
    g->now = fxs_allocate(allocator, n, sizeof *g->now);
    g->level = fxs_allocate(allocator, n, sizeof *g->level);
    g->queue = fxs_allocate(allocator, n, sizeof *g->queue);
    g->arcs = fxs_allocate(allocator, 2 * (size_t)count + 1, sizeof *g->arcs);
    if (!g->first || !g->now || !g->level || !g->queue || !g->arcs)
        return FXS_ERR_MEMORY;
    for (uint32_t e = 0; e < count; e++)
        if (edges[e].capacity) {
            g->first[edges[e].a + 1]++;
            g->first[edges[e].b + 1]++;
        }
    for (uint32_t i = 0; i < nodes; i++)
        g->first[i + 1] += g->first[i];
    memcpy(g->now, g->first, n * sizeof *g->now);
    for (uint32_t e = 0; e < count; e++)
        if (edges[e].capacity)
            add_edge(g, &edges[e]);
    return 0;
}

static void graph_free(graph *g, const fxs_allocator *allocator)
{
    void *const blocks[] = {g->first, g->now, g->level, g->queue, g->arcs};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
        fxs_release(allocator, blocks[i]);
}

/* Finds the level of each node. Returns 1 if a node with flow left has one. */
static int find_levels(graph *g)
{
    uint32_t end = 0;
    int is_found = 0;
    memset(g->level, 0, g->nodes * sizeof *g->level);
    for (uint32_t i = 0; i < g->nodes; i++)
        if (g->left[i] < 0) {
            g->level[i] = 1;
            g->queue[end++] = i;
        }
    for (uint32_t at = 0; at < end; at++) {
        const uint32_t node = g->queue[at];
        is_found |= g->left[node] > 0;
        for (uint32_t i = g->first[node]; i < g->first[node + 1]; i++) {
            const uint32_t other = g->arcs[i].head;
            if (!g->level[other] && g->arcs[g->arcs[i].back].capacity > 0) {
                g->level[other] = g->level[node] + 1;
                g->queue[end++] = other;
            }
        }
    }
    return is_found;
}

/* Moves on from a node: returns an arc to a node one level nearer to the sink, or NONE. */
static uint32_t step(graph *g, uint32_t node)
{
    const uint32_t end = g->first[node + 1], level = g->level[node];
    uint32_t i = level > 1 ? g->now[node] : end;
    while (i < end && !(g->arcs[i].capacity > 0 && g->level[g->arcs[i].head] + 1 == level))
        i++;
    g->now[node] = i;
    return i < end ? i : NONE;
}

/* Pushes flow along a path, of arcs in the queue's memory. Returns the number of arcs before the first full one. */
static uint32_t push(graph *g, uint32_t source, uint32_t length)
{
    const uint32_t *path = g->queue, sink = length ? g->arcs[path[length - 1]].head : source;
    int32_t flow = g->left[source] < -g->left[sink] ? g->left[source] : -g->left[sink];
    uint32_t kept = length;
    for (uint32_t i = 0; i < length; i++)
        flow = g->arcs[path[i]].capacity < flow ? g->arcs[path[i]].capacity : flow;
    g->left[source] -= flow;
    g->left[sink] += flow;
    for (uint32_t i = length; i-- > 0;) {
        arc *along = &g->arcs[path[i]];
        along->capacity -= flow;
        g->arcs[along->back].capacity += flow;
        kept = along->capacity ? kept : i;
    }
    return kept;
}

/* Pushes what a node can send along shortest paths. A node without a way on loses its level. */
static void send(graph *g, uint32_t source)
{
    uint32_t length = 0;
    while (g->left[source] > 0 && g->level[source]) {
        const uint32_t node = length ? g->arcs[g->queue[length - 1]].head : source;
        if (g->left[node] < 0 && length) {
            length = push(g, source, length);
            continue;
        }
        const uint32_t next = step(g, node);
        if (next != NONE) {
            g->queue[length++] = next;
        } else {
            g->level[node] = 0;
            length -= length > 0;
        }
    }
}

static void find_side(graph *g, uint8_t *side)
{
    uint32_t end = 0;
    for (uint32_t i = 0; i < g->nodes; i++) {
        side[i] = g->left[i] > 0;
        if (side[i])
            g->queue[end++] = i;
    }
    for (uint32_t at = 0; at < end; at++)
        for (uint32_t i = g->first[g->queue[at]]; i < g->first[g->queue[at] + 1]; i++) {
            const uint32_t other = g->arcs[i].head;
            if (g->arcs[i].capacity > 0 && !side[other]) {
                side[other] = 1;
                g->queue[end++] = other;
            }
        }
}

int fxs_min_cut(int32_t *terminals, uint32_t nodes, const fxs_edge *edges, uint32_t edge_count, uint8_t *side,
                const fxs_allocator *allocator)
{
    graph g;
    const int error = graph_make(&g, terminals, nodes, edges, edge_count, allocator);
    while (!error && find_levels(&g)) {
        memcpy(g.now, g.first, nodes * sizeof *g.now);
        for (uint32_t i = 0; i < nodes; i++)
            send(&g, i);
    }
    if (!error)
        find_side(&g, side);
    graph_free(&g, allocator);
    return error;
}
