/* An object in a camera's space, and the changes that its scale, crop boxes and tint make to splats. A chunk has 256
 * Gaussians. */
#ifndef FXS_OBJECT_H
#define FXS_OBJECT_H

#include "chunk.h"
#include "view.h"

typedef struct fxs_object_view {
    fxs_stage_view view;
    fxs_scene scene;
    fxs_motion_rows motion;        /* of a moving scene */
    uint32_t first_chunk, end_chunk;   /* numbers of the object's first chunk and of the chunk after its last, counted
                                          over all objects */
    uint32_t id;
    int visible;
    int plain;
    fxs_scale scale;               /* factor from depths in the object's space to depths in the world */
    int32_t tint_q13[3];
    const fxs_crop *crops;
    uint32_t crop_count, keep_count;   /* number of crop boxes; number of crop boxes without the flag `outside` */
} fxs_object_view;

int fxs_object_check(const fxs_object *object);

/* Transforms an object that is already checked to a camera's space. Does not set first_chunk and end_chunk. Returns the
   errors of fxs_view_of_object. */
int fxs_object_view_init(fxs_object_view *out, const fxs_stage_view *world, const fxs_camera *camera,
                         const fxs_object *object);

/* Returns the index of the object that contains a chunk, with chunks counted over all objects. */
FXS_STAGE uint32_t fxs_object_of(const fxs_object_view *objects, uint32_t count, uint32_t chunk);

/* Scales *depth of a projected Gaussian from object to world units. Returns 0 if the object's crop boxes remove the
   Gaussian. */
FXS_STAGE int fxs_object_change(const fxs_object_view *object, const fxs_chunk *header, const uint16_t position[3],
                                uint32_t *depth);

FXS_STAGE void fxs_object_tint(const fxs_object_view *object, fxs_splat *splat);

/* Returns 0 if the object's crop boxes remove all Gaussians of a chunk. */
FXS_STAGE int fxs_object_has_chunk(const fxs_object_view *object, const fxs_chunk *header);

/* Projects the Gaussians of a chunk; chunks are counted within the object. share_q8 scales their optical depth, 1 to
   1024; 256: unchanged. grow_q8 is log2 of the growth of their sigmas, 0 to 256. */
int32_t fxs_object_project(const fxs_object_view *object, const fxs_kernels *kernels, uint32_t chunk,
                           uint32_t share_q8, uint32_t grow_q8, fxs_splat *splats, fxs_bounds *bounds,
                           uint32_t *indices, uint32_t *depths);

int fxs_object_shade(const fxs_object_view *object, const fxs_kernels *kernels, uint32_t chunk,
                     const uint32_t *indices, uint32_t count, fxs_splat *splats);

#endif
