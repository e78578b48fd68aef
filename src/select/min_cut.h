/* The smallest cut of a graph between two terminals. */
#ifndef FXS_MIN_CUT_H
#define FXS_MIN_CUT_H

#include <fixsplat/internal/allocator.h>

/* An edge between nodes a and b with the same capacity, 0 or more, in both directions. */
typedef struct fxs_edge {
    uint32_t a, b;
    int32_t capacity;
} fxs_edge;

/* Finds a cut of least capacity between source and sink. terminals[i] is the capacity between node i and the source, or
   if it is below 0, between node i and the sink; it is used up. Sets side[i] to 1 if the node is on the source's side.
   Of several least cuts, takes the one with the fewest nodes there; it is unique. Takes 24 bytes an edge and 16 bytes a
   node. Returns 0 or FXS_ERR_MEMORY. */
int fxs_min_cut(int32_t *terminals, uint32_t nodes, const fxs_edge *edges, uint32_t edge_count, uint8_t *side,
                const fxs_allocator *allocator);

#endif
