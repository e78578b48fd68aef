/* The voxels of a volume. Bricks of 8x8x8 voxels lie in a grid that covers the box and one brick more on each side. */
#ifndef FXS_VOLUME_H
#define FXS_VOLUME_H

#include <fixsplat/surface.h>

enum { FXS_BRICK = 8, FXS_BRICK_VOXELS = 512 };

#define FXS_NO_BRICK UINT32_MAX

#define FXS_WHOLE 16             /* weight of a view's sample of a voxel */

/* Sums of a brick's voxels. weight <= FXS_WHOLE * FXS_VOLUME_VIEWS < 2^16, so |sum| < 2^31. */
typedef struct fxs_brick {
    int32_t sum_q15[FXS_BRICK_VOXELS];        /* of weight * clamp(signed distance / truncation); above 0: outside */
    uint16_t weight[FXS_BRICK_VOXELS];
    uint16_t coloured[FXS_BRICK_VOXELS];      /* views in the colour sums */
    uint32_t colour[FXS_BRICK_VOXELS][3];
} fxs_brick;

struct fxs_volume {
    fxs_volume_options options;
    double origin[3], step;         /* a voxel (x, y, z) of the grid lies at origin + step * (x, y, z) */
    uint32_t size[3], cells;        /* size of the grid in bricks, and its product */
    uint32_t first[3], last[3];     /* range of the voxels in the box; if unbounded, of those up to FXS_VOLUME_FAR */
    uint32_t half_q16, middle_q16;  /* of an unbounded scene: half the side of the cube, and its middle on each axis, in
                                       voxels; else 0 */
    uint32_t *grid;                 /* number of the brick in a cell, or FXS_NO_BRICK */
    uint8_t *open;                  /* 1: a view sees through the middle of a cell without a brick */
    uint32_t *places;               /* the cell of each brick, ascending */
    fxs_brick *bricks;
    uint32_t brick_count, views;
};

/* Contracts a place, relative to the middle of a cube with half the side `half_q16` <= 2^26, with coordinates below
   2^35. An expanded place is contracted to the same place again, to 1 in Q16. */
void fxs_contract(int64_t at_q16[3], int64_t half_q16);

/* Expands a contracted place. Returns its largest coordinate, or half_q16 within the cube. Places beyond 32 halves are
   taken as there. */
int64_t fxs_expand(int64_t at_q16[3], int64_t half_q16);

/* Runs jobs on the volume's workers. */
void fxs_volume_run(const fxs_volume *volume, void (*job)(void *argument, uint32_t i), void *argument, uint32_t jobs);

/* Fails if `bytes` exceed the limit. */
int fxs_surface_check(uint64_t bytes, uint64_t limit, fxs_message *message);

/* Returns the bytes of memory that decimation of a mesh takes. */
uint64_t fxs_mesh_decimate_bytes(uint32_t vertices, uint32_t triangles);

/* Removes vertices without a triangle. Returns 0, or FXS_ERR_MEMORY and a message. */
int fxs_mesh_compact(fxs_mesh *mesh, fxs_message *message);

/* Counts the parts that shared vertices connect. Returns 0, or FXS_ERR_MEMORY and a message. */
int fxs_mesh_count_parts(const fxs_mesh *mesh, uint32_t *parts, fxs_message *message);

/* Splits triangles with a side along an axis that touches other sides, at the vertices on it, so that they share edges.
   A mesh grows to 8 times its triangles at most. Errors: FXS_ERR_MEMORY. */
int fxs_mesh_join(fxs_mesh *mesh, fxs_message *message);

/* Finds the box of a mesh's places. Errors: FXS_ERR_ARGUMENT without triangles, or if places differ by 2^28 or more. */
int fxs_mesh_find_box(const fxs_mesh *mesh, int32_t low[3], int32_t high[3], fxs_message *message);

/* Gives each of several fans of triangles that meet at a vertex a vertex of its own. They meet where the border of the
   surface touches itself. Returns 0, or FXS_ERR_MEMORY and a message. */
int fxs_mesh_split_fans(fxs_mesh *mesh, fxs_message *message);

/* Gives vertices without a colour the mean of their neighbours' colours, from the coloured ones outwards. */
int fxs_mesh_spread_colours(fxs_mesh *mesh, fxs_message *message);

#endif
