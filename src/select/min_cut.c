/* Maximum flow by Dinic's method: levels are the distances to the sink, found anew until no node with flow left reaches
 * it. Source and sink are not nodes: `left` has what a node can still take from the source, or give to the sink if it
 * is below 0. */
#include "min_cut.h"

#include <string.h>

#define NONE UINT32_MAX

/* Arcs 2 e and 2 e + 1 are the two directions of edge e. The arcs of a node form a list. */
typedef struct graph {
    uint32_t nodes;
    int32_t *left;
    uint32_t *first, *now;             /* first arc of a node, and the one that the search has come to */
    uint32_t *next, *head;
    int32_t *capacity;
    uint32_t *level;                   /* arcs to the sink, plus 1; 0: none leads there */
    uint32_t *queue;
} graph;

static void add_arc(graph *g, uint32_t arc, uint32_t from, uint32_t to, int32_t capacity)
{
    g->head[arc] = to;
    g->capacity[arc] = capacity;
    g->next[arc] = g->first[from];
    g->first[from] = arc;
}

static int graph_make(graph *g, int32_t *terminals, uint32_t nodes, const fxs_edge *edges, uint32_t count,
                      const fxs_allocator *allocator)
{
    const size_t arcs = 2 * (size_t)count + 1, n = (size_t)nodes + 1;
    *g = (graph){.nodes = nodes, .left = terminals};
    g->first = fxs_allocate(allocator, n, sizeof *g->first);
    g->now = fxs_allocate(allocator, n, sizeof *g->now);
    g->level = fxs_allocate(allocator, n, sizeof *g->level);
    g->queue = fxs_allocate(allocator, n, sizeof *g->queue);
    g->next = fxs_allocate(allocator, arcs, sizeof *g->next);
    g->head = fxs_allocate(allocator, arcs, sizeof *g->head);
    g->capacity = fxs_allocate(allocator, arcs, sizeof *g->capacity);
    if (!g->first || !g->now || !g->level || !g->queue || !g->next || !g->head || !g->capacity)
        return FXS_ERR_MEMORY;
    memset(g->first, 0xff, n * sizeof *g->first);
    for (uint32_t e = 0; e < count; e++) {
        add_arc(g, 2 * e, edges[e].a, edges[e].b, edges[e].capacity);
        add_arc(g, 2 * e + 1, edges[e].b, edges[e].a, edges[e].capacity);
    }
    return 0;
}

static void graph_free(graph *g, const fxs_allocator *allocator)
{
    void *const blocks[] = {g->first, g->now, g->level, g->queue, g->next, g->head, g->capacity};
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
        for (uint32_t arc = g->first[node]; arc != NONE; arc = g->next[arc]) {
            const uint32_t other = g->head[arc];
            if (!g->level[other] && g->capacity[arc ^ 1] > 0) {
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
    uint32_t arc = g->now[node];
    while (arc != NONE && !(g->capacity[arc] > 0 && g->level[g->head[arc]] + 1 == g->level[node] && g->level[node] > 1))
        arc = g->next[arc];
    return g->now[node] = arc;
}

/* Pushes flow along a path, of arcs in the queue's memory. Returns the number of arcs before the first full one. */
static uint32_t push(graph *g, uint32_t source, uint32_t length)
{
    const uint32_t *path = g->queue, sink = length ? g->head[path[length - 1]] : source;
    int32_t flow = g->left[source] < -g->left[sink] ? g->left[source] : -g->left[sink];
    uint32_t kept = length;
    for (uint32_t i = 0; i < length; i++)
        flow = g->capacity[path[i]] < flow ? g->capacity[path[i]] : flow;
    g->left[source] -= flow;
    g->left[sink] += flow;
    for (uint32_t i = length; i-- > 0;) {
        g->capacity[path[i]] -= flow;
        g->capacity[path[i] ^ 1] += flow;
        kept = g->capacity[path[i]] ? kept : i;
    }
    return kept;
}

/* Pushes what a node can send along shortest paths. A node without a way on loses its level. */
static void send(graph *g, uint32_t source)
{
    uint32_t length = 0;
    while (g->left[source] > 0 && g->level[source]) {
        const uint32_t node = length ? g->head[g->queue[length - 1]] : source;
        if (g->left[node] < 0 && length) {
            length = push(g, source, length);
            continue;
        }
        const uint32_t arc = step(g, node);
        if (arc != NONE) {
            g->queue[length++] = arc;
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
        for (uint32_t arc = g->first[g->queue[at]]; arc != NONE; arc = g->next[arc]) {
            const uint32_t other = g->head[arc];
            if (g->capacity[arc] > 0 && !side[other]) {
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
