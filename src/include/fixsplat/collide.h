/* Makes solid voxels of a packed scene: walls and floors for a program in which a user walks through the scene.
 *
 * A voxel absorbs 1 - exp(-sum of alpha) of the light (Beer-Lambert). The sum is over all Gaussians that reach the
 * voxel, with their alpha at the voxel's point nearest to their centre. A voxel that absorbs enough is solid. Then a
 * capsule (the walker) moves from a seed to all places that it fits into. Voxels that the capsule touches are free. All
 * others are solid, so walls are closed from behind.
 *
 * The voxels have the axes of glTF: x left, y up, z forward, (-x, -y, z) of a scene's (x, y, z). Voxel (i, j, k) is the
 * cube from (i, j, k) to (i + 1, j + 1, k + 1), times the voxel's size. All sums are in integers, so the voxels are the
 * same on every machine and for any number of threads. */
#ifndef FXS_COLLIDE_H
#define FXS_COLLIDE_H

#include "scene.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_voxels fxs_voxels;

#define FXS_COLLIDE_HEIGHT 1.6     /* default height of the capsule */

/* Lengths are in scene units. Fields of 0 stand for their defaults. */
typedef struct fxs_collide_options {
    uint32_t size;
    double voxel;                  /* edge of a voxel, 2^-16 to 2^16; default 0.05 */
    double opacity;                /* share of light that a solid voxel absorbs at least, 0.001 to 0.999; default 0.1 */
    double radius, height;         /* the capsule: defaults 0.2 and FXS_COLLIDE_HEIGHT. The radius is at most 31 voxels,
                                      the height 2 radii to 4096 voxels */
    double up[3];                  /* up direction of the scene (default 0, -1, 0). The capsule stands along the nearest
                                      axis */
    double low[3], high[3];        /* part of the scene that becomes voxels, such as the inner bounds of a pack report.
                                      It is widened by the capsule's height, then to multiples of 32 voxels */
    double seeds[2][3];            /* a free place, and a second one for a first that is not free */
    uint32_t seed_count;           /* 1 or 2 */
    size_t max_memory;             /* most bytes of working memory; default 2^31 */
    fxs_workers workers;
    fxs_progress progress;
    const fxs_allocator *allocator;   /* null: malloc */
} fxs_collide_options;
FXS_INIT(fxs_collide_options)

/* Makes the voxels of an open scene, which must be still. Returns 0, or an error and a message: FXS_ERR_ARGUMENT,
   FXS_ERR_SCENE, FXS_ERR_UNSUPPORTED (a scene that moves), FXS_ERR_MEMORY (more than max_memory, found before the work
   begins), FXS_ERR_STOPPED, FXS_ERR_OBJECT (nothing is solid, or a seed is not free). */
FXS_EXPERIMENTAL int fxs_collide(const fxs_scene *scene, const fxs_collide_options *options, fxs_voxels **voxels,
                                 fxs_message *message);

/* Later versions may add fields at its end. */
typedef struct fxs_voxels_info {
    double voxel;
    int32_t low[3], high[3];       /* box around the free voxels, from `low` to before `high`, multiples of 4 */
    uint64_t absorbing;            /* voxels that absorb enough light */
    uint64_t free;                 /* voxels that the capsule touches on its way */
    uint32_t seed;                 /* the seed that was used, 0 or 1 */
    size_t memory;                 /* largest working memory, bytes */
} fxs_voxels_info;

FXS_EXPERIMENTAL const fxs_voxels_info *fxs_voxels_describe(const fxs_voxels *voxels);

/* Reads a .voxel.json and the .voxel.bin beside it, of fxs_voxels_write or of splat-transform. Returns 0, or an error
   and a message: FXS_ERR_FILE, FXS_ERR_MEMORY, FXS_ERR_ARGUMENT for another ending, FXS_ERR_UNSUPPORTED in a build
   without cJSON. Such voxels cannot be written, and of their description only `voxel`, `low` and `high` are set. Free
   them with fxs_voxels_free. */
FXS_EXPERIMENTAL int fxs_voxels_read(fxs_voxels **voxels, const char *path, fxs_message *message);

/* Returns 1 if voxel (x, y, z) is solid. All voxels outside of the box are. */
FXS_EXPERIMENTAL int fxs_voxels_solid(const fxs_voxels *voxels, int32_t x, int32_t y, int32_t z);

/* Writes voxels by the ending of the path: X.voxel.json and X.voxel.bin, the octree of splat-transform 3, or a .glb, a
   mesh of the faces between solid and free voxels. Returns 0, or an error and a message. */
FXS_EXPERIMENTAL int fxs_voxels_write(const fxs_voxels *voxels, const char *path, fxs_message *message);

/* Returns 1 if fxs_voxels_write knows the ending of a path. */
FXS_EXPERIMENTAL int fxs_voxels_ending(const char *path);

FXS_EXPERIMENTAL void fxs_voxels_free(fxs_voxels *voxels);

/* ---- Walking ----------------------------------------------------------------------------------------------------- */

#define FXS_WALKER_PACE 2.5        /* heights of the eye that a walker goes in a second at full speed */

/* A walker: an upright capsule whose radius is an eighth of its height. Lengths are in scene units, places in the axes
   of the scene. Set size, up and height, then call fxs_walker_place. */
typedef struct fxs_walker {
    uint32_t size;
    double up[3];                  /* up direction of the scene, of length 1 */
    double height;                 /* of the eye above the feet */
    double eye[3];                 /* where the eye is */
    double floor;                  /* height of the floor: product of its place with `up` */
    double fall;                   /* speed of the fall, units a second */
} fxs_walker;
FXS_INIT(fxs_walker)

/* Lets the walker stand on the floor below a place. Returns 1, or 0 if the place is solid or the walker has no room
   there. */
FXS_EXPERIMENTAL int fxs_walker_place(fxs_walker *walker, const fxs_voxels *voxels, const double at[3]);

/* Walks by the horizontal part of a way and lets `seconds` pass. The walker slides along walls, climbs steps up to a
   quarter of its height, and falls where the floor is deeper. Returns 1 while the eye has not come to rest. */
FXS_EXPERIMENTAL int fxs_walker_move(fxs_walker *walker, const fxs_voxels *voxels, const double way[3],
                                     double seconds);

#ifdef __cplusplus
}
#endif

#endif
