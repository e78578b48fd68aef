/* Opens scenes that are only partly in memory, for ports with their own pager. A packed scene has headers, and rows
   with the Gaussians' codes. */
#ifndef FXS_PARTS_H
#define FXS_PARTS_H

#include <fixsplat/fixsplat.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Byte offsets of the parts of a packed scene. The head of the scene (scene header, chunk headers, palette, motion)
   ends at `rows`. In a still scene, `motion` is equal to `rows`. The head of the level-of-detail tree runs from `tree`
   to `node_rows`. Without a tree, all offsets from `tree` on are equal. */
typedef struct fxs_scene_parts {
    uint64_t palette, motion, rows, tree, node_chunks, node_rows, bytes;
} fxs_scene_parts;

/* Computes the offsets of a scene's parts from its header of 192 bytes. Errors: as fxs_scene_open. */
FXS_EXPERIMENTAL int fxs_scene_find_parts(fxs_scene_parts *parts, const void *header);

/* Opens a scene from its head (headers and palette) and the head of its tree, each aligned to 64. `tree` may be null
   for a scene without a tree. The caller must set the scene's `places` and `rows` before rendering. Errors: as
   fxs_scene_open. */
FXS_EXPERIMENTAL int fxs_scene_open_parts(fxs_scene *scene, const void *head, const void *tree);

/* Finds chunks to prefetch: calls options.want for the chunks (256 Gaussians each) that a frame would draw, but draws
   nothing. `memory` is as for fxs_render; targets are not read. Returns 0, or an error as fxs_render. Does nothing if
   budget, detail and places do not limit the chunks. */
FXS_EXPERIMENTAL int fxs_foresee(const fxs_context *context, const fxs_request *request, void *memory,
                                 size_t memory_bytes);

#ifdef __cplusplus
}
#endif

#endif
