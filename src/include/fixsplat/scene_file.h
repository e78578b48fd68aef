/* Opens scene files of any format as streams of Gaussians (gaussian.h), in file order.
 *
 * Functions return 0 or a count, or an error and a message: FXS_ERR_FILE for a file that is missing, damaged, of an
 * unknown format, changed while it was open, or larger than max_gaussians; FXS_ERR_STOPPED by a progress function;
 * FXS_ERR_MEMORY if memory ran out or max_memory would be exceeded (bytes_needed has the size); FXS_ERR_UNSUPPORTED if
 * fixsplat was built without a library that the format needs; FXS_ERR_ARGUMENT for a level that the scene lacks. One
 * thread at a time may use a file; several threads may each use their own.
 *
 * Stable from version 1.0 on. */
#ifndef FXS_SCENE_FILE_H
#define FXS_SCENE_FILE_H

#include "gaussian.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Opens a scene file, or a folder with the meta.json or lod-meta.json of a .sog or the tileset.json of 3D Tiles. The
   content determines the format. `options` may be null. Returns 0 and a handle that fxs_scene_file_close frees, or an
   error and a message, with *file null. 2D Gaussians are read as 3D Gaussians with a third scale of e^-20. The
   filter_3D of a Mip-Splatting .ply is applied. fxs_scene_file_info reports all other changes and unused data.

   The header is checked completely, including the size of a binary body. Only headers are read, so *info is known
   before large allocations. Two exceptions: a .ply with lists or text before its vertices is read up to them, and the
   .sog files of a level are read up to their images, which stay compressed.

   Memory of a reader:
   - .fxs, .ply, .ksplat, .splat: at most 1 MiB.
   - .lcc: 1 MiB, its JSON, and 16 bytes a cell.
   - .spz: from the first read on, 65 bytes a Gaussian of SH degree 3 (92 of degree 4); during that read also the
     longest stream of version 4.
   - .rad: its JSON, a byte and a bit for each node of a tree, and the attributes of a chunk: at most 240 bytes for each
     of its 65,536 Gaussians.
   - .sog: its compressed images; from the first read on, 4 bytes a pixel instead.
   - A folder of gsplat: 24 bytes a pixel, its palette and its labels.
   - .glb, .gltf: 3 MiB, its JSON and base64, and the memory of its .spz.
   - A tileset: 1200 bytes and the name of each content, and the memory of 33 contents.
   cJSON, libzip, libwebp and zstd allocate their own memory with malloc; cJSON's also counts towards max_memory.

   Decompressed data are kept until the file is closed, for later passes over the file; an .spz that several nodes of a
   glTF share is kept once. If the .spz of a glTF or the files of a streamed SOG exceed max_memory together, the files
   that fit are kept and the others are decompressed again in each pass. A tileset keeps 32 contents open and reopens
   the others in each pass.

   `path` must name a regular file or a folder as above. Files that it refers to must lie in the folder of the opened
   file or below it: a path that leaves that folder, by ".." or a symbolic link, is refused. A \ in a file name
   separates folders, unless a file with that exact name exists. Several tiles may share one content, but a tileset must
   not contain itself. */
FXS_API int fxs_scene_file_open(const char *path, const fxs_scene_file_options *options, fxs_scene_file **file,
                                fxs_scene_file_info *info, fxs_message *message);

/* fxs_scene_file_open for a file in memory, which must stay unchanged until the handle is closed. Messages begin with
   `name`, which is copied. Scenes of several files cannot be opened from memory. */
FXS_API int fxs_scene_file_open_memory(const char *name, const void *data, size_t size,
                                       const fxs_scene_file_options *options, fxs_scene_file **file,
                                       fxs_scene_file_info *info, fxs_message *message);

/* fxs_scene_file_open for a file that callbacks read; *input is copied. Its `close` is called even if opening fails. */
FXS_API int fxs_scene_file_open_input(const char *name, const fxs_scene_input *input,
                                      const fxs_scene_file_options *options, fxs_scene_file **file,
                                      fxs_scene_file_info *info, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
