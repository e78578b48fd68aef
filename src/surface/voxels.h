/* Sparse grids of bits: a cell of 32^3 bits is empty, solid, or has 4 KB of bits. Passes over a grid run on all threads
 * and give the same bits for any number of them. */
#ifndef FXS_VOXELS_H
#define FXS_VOXELS_H

#include <fixsplat/collide.h>

#define FXS_CELL 32
#define FXS_CELL_WORDS (FXS_CELL * FXS_CELL)

/* States of a cell. From FXS_CELL_MIXED on, the state is FXS_CELL_MIXED plus the number of the cell's bits. */
enum { FXS_CELL_EMPTY, FXS_CELL_SOLID, FXS_CELL_MIXED };

typedef struct fxs_bits {
    int32_t n[3];                  /* cells on each axis */
    uint32_t *states;              /* state of each cell, x first */
    uint32_t *bits;                /* bits of the mixed cells: word 32 z + y has the bits x */
    uint32_t mixed;                /* number of mixed cells */
    uint32_t room;                 /* mixed cells that `bits` has room for */
} fxs_bits;

/* What all passes share. */
typedef struct fxs_voxel_work {
    fxs_workers workers;
    const fxs_allocator *allocator;
    const fxs_progress *progress;
    fxs_message *message;
    size_t used, peak;             /* bytes allocated now, and at most */
    double done, share;            /* progress before this pass, and the pass's share of all work */
} fxs_voxel_work;

void *fxs_work_allocate(fxs_voxel_work *work, size_t count, size_t size);
void fxs_work_release(fxs_voxel_work *work, void *block, size_t count, size_t size);

/* Makes cell `cell`'s words. `scratch` is the thread's own. */
typedef void fxs_cell_fn(void *argument, uint32_t cell, uint32_t words[FXS_CELL_WORDS], void *scratch);

size_t fxs_bits_cells(const fxs_bits *grid);

/* Allocates a grid of n cells on each axis, all empty. Returns 0 or FXS_ERR_MEMORY, as all functions here do that
   allocate. */
int fxs_bits_open(fxs_bits *grid, const int32_t n[3], fxs_voxel_work *work);
void fxs_bits_close(fxs_bits *grid, fxs_voxel_work *work);

/* Fills in the cells whose state is FXS_CELL_MIXED by calls of `make`, on all threads. Also FXS_ERR_STOPPED. */
int fxs_bits_make(fxs_bits *grid, fxs_cell_fn *make, void *argument, size_t scratch, fxs_voxel_work *work);

/* Returns the 32 bits of row (y, z) in the cells at x. */
uint32_t fxs_bits_row(const fxs_bits *grid, int32_t x, int32_t y, int32_t z);
int fxs_bits_bit(const fxs_bits *grid, int32_t x, int32_t y, int32_t z);
uint64_t fxs_bits_count(const fxs_bits *grid);
void fxs_bits_invert(fxs_bits *grid);

/* One row of a set of offsets: (x, dy, dz) for x from -run to run. Each number is at most 31. */
typedef struct fxs_offsets {
    int32_t dy, dz, run;
} fxs_offsets;

#define FXS_REACH_MOST 31

/* Replaces a grid by its dilation: each bit is set that has a set bit at one of the offsets. `outside` is the state of
   cells outside of the grid. `reach` is the largest number of an offset. */
int fxs_bits_dilate(fxs_bits *grid, const fxs_offsets *runs, uint32_t count, int32_t reach, uint32_t outside,
                    fxs_voxel_work *work);

/* Clears set bits without a set bit at one of their six faces. */
int fxs_bits_drop_dust(fxs_bits *grid, fxs_voxel_work *work);

/* Makes the bits that are connected by faces with bit `seed`, in the clear bits of `walls`. */
int fxs_bits_flood(fxs_bits *flooded, const fxs_bits *walls, const int32_t seed[3], fxs_voxel_work *work);

#define FXS_SOLID_NODE 0xff000000u
#define FXS_NODE_NUMBER 0xffffffu

/* The words of a .voxel.bin: nodes, then leaves. All numbers in them are valid. */
typedef struct fxs_octree {
    uint32_t *words;               /* null: the voxels are a grid */
    uint32_t nodes, leaf_words;
    int depth;
} fxs_octree;

/* Returns 1 if a voxel, counted from the corner of the octree's box, is solid. */
int fxs_octree_solid(const fxs_octree *tree, const uint32_t at[3]);

struct fxs_voxels {
    fxs_voxels_info info;
    fxs_bits solid;
    fxs_octree tree;
    int32_t origin[3];             /* first voxel of the grid or of the octree */
    double bounds[2][3];           /* box of the scene that was asked for, in the axes of the voxels */
    fxs_allocator allocator;
    fxs_voxel_work work;
};

int fxs_voxels_write_octree(const fxs_voxels *voxels, const char *path, fxs_message *message);
int fxs_voxels_write_glb(const fxs_voxels *voxels, const char *path, fxs_message *message);

/* Finds the voxels that absorb at least `depth_q15` of the scene, -ln(1 - opacity). `origin` is the first voxel of the
   grid, voxel_q32 the size. FXS_ERR_MEMORY also if this or later passes may need more than max_memory. Also
   FXS_ERR_SCENE, FXS_ERR_STOPPED. */
int fxs_bits_absorb(fxs_bits *grid, const fxs_scene *scene, const int32_t origin[3], int64_t voxel_q32,
                    uint32_t depth_q15, size_t max_memory, fxs_voxel_work *work);

#endif
