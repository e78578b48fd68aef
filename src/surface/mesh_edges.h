/* The edges of a mesh and the triangles at each. */
#ifndef FXS_MESH_EDGES_H
#define FXS_MESH_EDGES_H

#include <fixsplat/surface.h>

/* Side k of triangle t, from its corner k to the next, has the number 3 * t + k. */
typedef struct fxs_mesh_edges {
    uint32_t count;
    uint32_t *of;                  /* the edge of each side */
    uint32_t *sides;               /* all sides, by edge, ascending */
    uint32_t *first;               /* first[e]: number in `sides` of the first side of edge e; count + 1 numbers */
    uint8_t *joined;               /* of each edge; 1: as many triangles run one way as the other */
} fxs_mesh_edges;

/* Finds the edges of a mesh, in time and memory in proportion to its size. Errors: FXS_ERR_MEMORY. The caller frees the
   edges in any case. */
int fxs_mesh_edges_find(fxs_mesh_edges *edges, const fxs_mesh *mesh, fxs_message *message);

void fxs_mesh_edges_free(fxs_mesh_edges *edges);

/* Returns the vertex at which a side begins. */
static inline uint32_t fxs_side_begin(const fxs_mesh *mesh, uint32_t side)
{
    return mesh->triangles[side];
}

static inline uint32_t fxs_side_next(uint32_t side)
{
    return side % 3 == 2 ? side - 2 : side + 1;
}

static inline uint32_t fxs_side_end(const fxs_mesh *mesh, uint32_t side)
{
    return mesh->triangles[fxs_side_next(side)];
}

#endif
