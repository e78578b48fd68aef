/* Scenes with only a part of their rows in memory, for ports with a pager of their own. pager.h has the library's pager. */
#ifndef FXS_PARTS_H
#define FXS_PARTS_H

#include <fixsplat/fixsplat.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Offsets of the parts of a packed scene, in bytes from its start. The head is the `rows` bytes before the rows:
   header, chunk headers, palette. The head of the tree is everything before the rows of the nodes, from `tree` to
   `node_rows`. Without a tree, `tree` and the fields after it are equal. */
typedef struct fxs_scene_parts {
    uint64_t palette, rows, tree, node_chunks, node_rows, bytes;
} fxs_scene_parts;

/* Finds the parts from the header of a packed scene, its first 192 bytes; the rest need not be in memory. Errors as
   fxs_scene_open. */
FXS_API int fxs_scene_find_parts(fxs_scene_parts *parts, const void *header);

/* Opens a scene from its head and the head of its tree, each aligned to 64, without the rows. `tree` may be null for a
   scene without a tree. The caller must set `places` and `rows` before rendering. Errors as fxs_scene_open. */
FXS_API int fxs_scene_open_parts(fxs_scene *scene, const void *head, const void *tree);

/* Prefetch: finds the chunks that a request's frame would draw and calls options.want for them as fxs_render does, but
   draws nothing. Call it with the camera of a later frame, to have its chunks loaded in time. `memory` as for
   fxs_render; targets are not read. Returns 0, or an error as fxs_render. Returns 0 at once if no budget, detail or
   places limit the chunks. */
FXS_API int fxs_foresee(const fxs_context *context, const fxs_request *request, void *memory, size_t memory_bytes);

#ifdef __cplusplus
}
#endif

#endif
