/* Makes the voxels of a loaded scene. */
#ifndef MAKE_VOXELS_H
#define MAKE_VOXELS_H

#include <fixsplat/collide.h>
#include "frame_options.h"

typedef struct voxel_options {
    double voxel, opacity, radius, height;  /* as in fxs_collide_options; 0: its default */
    point_option seed;
    const double *from;            /* a place to start from instead of the start view's camera; null: that camera */
    size_t max_memory;
    const char *hint;              /* end of an error message about a seed that was not given */
} voxel_options;

/* Makes the voxels of a scene. Free them with fxs_voxels_free. */
int make_voxels(fxs_voxels **voxels, const voxel_options *options, const loaded_scene *scene,
                const frame_options *frame);

#endif
