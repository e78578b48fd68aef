/* What the shaders of a fitting step get besides the Gaussians, and what they say. Only 32-bit numbers, so that C and
 * GLSL (std430) lay it out alike; tools/scripts/fit_shaders.mjs translates this header to GLSL. Numbers at_... are
 * places in the buffers `gaussians`, `slots`, `pixels` and `photograph`, in words of 32 bits. */
#ifndef FXS_FIT_ORDER_H
#define FXS_FIT_ORDER_H

#include "src/fit/stages/fit_stage.h"

typedef struct fit_status {
    uint32_t slot_groups[3];       /* numbers of workgroups for work on slots, for an indirect dispatch */
    uint32_t done;                 /* number of completed steps */
    uint32_t is_full;              /* 1: the tiles' lists overflowed; this step and all later ones change nothing */
    uint32_t entries_most;         /* largest number of slots of a view since the last look */
    uint32_t visible, entries;     /* sums over the views of a step with a report */
    uint32_t large;                /* number of Gaussians of a view that touch many tiles, while it is counted */
    uint32_t listed;               /* and later */
    uint32_t reserved[6];
} fit_status;

/* Places of a photograph and its mask, at the camera's size and at full size, and its exposure. */
typedef struct fit_photograph {
    uint32_t at, at_mask;          /* at_mask: UINT32_MAX without a mask */
    uint32_t at_full, at_full_mask;
    int32_t full_width, divisor;
    float factors[FXS_FIT_GAIN];   /* of the exposure (exposure.h) */
} fit_photograph;

enum { GRID_NUMBERS = 11 };        /* numbers of fxs_fit_grid before its pointer */

typedef struct fit_order {
    fxs_fit_camera cameras[FXS_FIT_BATCH];
    fit_photograph photographs[FXS_FIT_BATCH];
    fxs_fit_adam adam;
    fxs_fit_noise noise;
    int32_t grid[GRID_NUMBERS];
    float background[3], surface_weight;   /* surface_weight: of depths in the loss of a pixel; 0: not compared */
    int32_t degree, smooths, has_exposure, is_affine;
    uint32_t count, stride;        /* Gaussians; floats of a plane */
    uint32_t batch, capacity;      /* capacity: number of slots that fit */
    uint32_t camera_count;         /* cameras for the lower limit of scales */
    uint32_t at_splats, at_bases, at_parts, at_large, at_by_centre, at_views, at_chunks, at_cameras;
    uint32_t at_planes, view_numbers;      /* planes of the first view's sums; numbers from view to view */
    uint32_t at_splat_of, at_tiles, at_keys, at_slots, at_list, at_blocks, at_sums;
    uint32_t at_picture, at_derivatives, at_dissimilar, at_gradient, at_rows, at_gain_rows, at_pose_parts;
    uint32_t at_starts, at_next, at_needed;
} fit_order;

/* Arguments of the shader `rebuild`. */
typedef struct fit_rebuilt {
    uint32_t count, from_stride, to_stride, from_plane, to_plane;
    uint32_t has_moments;          /* 1: numbers of new Gaussians are 0 */
} fit_rebuilt;

#endif
