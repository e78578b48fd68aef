/* An object of a frame: the camera in its space, and its changes to projected Gaussians. */
#ifndef FXS_OBJECT_H
#define FXS_OBJECT_H

#include "chunk.h"
#include "view.h"

typedef struct fxs_object_view {
    fxs_view view;                 /* the camera, in the object's space */
    fxs_scene scene;
    uint32_t first_chunk, end_chunk;   /* of the chunks of all objects */
    uint32_t id;
    int visible;
    int plain;                     /* 1: the scale is 1, and nothing is cropped */
    fxs_scale scale;               /* of its depths in the world's */
    int32_t tint_q13[3];
    const fxs_crop *crops;         /* the caller's */
    uint32_t crop_count, keep_count;   /* keep_count of these keep what is inside */
} fxs_object_view;

/* Checks an object, but for where it is: 0 or FXS_ERR_ARGUMENT, FXS_ERR_OBJECT. */
int fxs_object_check(const fxs_object *object);

/* All of an object that was checked, but for first_chunk and end_chunk. Errors as fxs_view_of_object. */
int fxs_object_view_init(fxs_object_view *out, const fxs_view *world, const fxs_camera *camera,
                         const fxs_object *object);

/* The object that a chunk of all objects is of. */
FXS_STAGE uint32_t fxs_object_of(const fxs_object_view *objects, uint32_t count, uint32_t chunk);

/* Applies the object to a projected Gaussian with these position codes: *depth becomes the depth in the world. Returns
   0 where the crop boxes leave the Gaussian out. */
FXS_STAGE int fxs_object_change(const fxs_object_view *object, const fxs_chunk *header, const uint16_t position[3],
                                uint32_t *depth);

/* Applies the object's tint to a splat's colour. */
FXS_STAGE void fxs_object_tint(const fxs_object_view *object, fxs_splat *splat);

/* A chunk's header was read: returns 0 where none of its Gaussians is within the crop boxes. */
FXS_STAGE int fxs_object_has_chunk(const fxs_object_view *object, const fxs_chunk *header);

/* The project stage, on a chunk of the object, counted from its own first one, of which a share is drawn, 1 to 1024 of
   256 of its optical depth, and whose sigmas grow by 2^grow, 0 to 256 of 256; `indices` are in the object's scene. */
int32_t fxs_object_project(const fxs_object_view *object, const fxs_kernels *kernels, uint32_t chunk,
                           uint32_t share_q8, uint32_t grow_q8, fxs_splat *splats, fxs_bounds *bounds,
                           uint32_t *indices, uint32_t *depths);

/* The shade stage. */
int fxs_object_shade(const fxs_object_view *object, const fxs_kernels *kernels, uint32_t chunk,
                     const uint32_t *indices, uint32_t count, fxs_splat *splats);

#endif
