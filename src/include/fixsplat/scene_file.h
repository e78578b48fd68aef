/* Opens scene files of any format as streams of Gaussians (gaussian.h), in the order of the file.
 *
 * Functions return 0 or a count, or an error and a message: FXS_ERR_FILE where a file is missing, damaged, of an
 * unknown format, changed while it was open, or beyond max_gaussians; FXS_ERR_STOPPED where a progress function said
 * so; FXS_ERR_MEMORY where memory ran out, or more than max_memory would be needed (bytes_needed says how much);
 * FXS_ERR_UNSUPPORTED where fixsplat was built without a library that the format needs; FXS_ERR_ARGUMENT for a level
 * that the scene lacks. A file is used by one thread at a time; several threads may each have files of their own.
 *
 * Stable from version 1.0 on. */
#ifndef FXS_SCENE_FILE_H
#define FXS_SCENE_FILE_H

#include "gaussian.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Opens a scene file, or a folder with the meta.json or lod-meta.json of a .sog or the tileset.json of 3D Tiles. The
   format is found by the content. `options` may be null. Returns 0 and a handle that fxs_scene_file_close frees, or an
   error and a message, with *file null. 2D Gaussians are read as 3D Gaussians with a third scale of e^-20, and the
   filter_3D of a Mip-Splatting .ply is applied; fxs_scene_file_info says what else was changed or not used.

   The header is checked completely, and the size of a binary body against it. Only headers are read, so *info is known
   before anything large is allocated. But a .ply is read up to its vertices where it has lists or text before them, and
   the .sog files of a level are read up to their images, which stay compressed.

   Memory of a reader. An .fxs, .ply, .ksplat or .splat: at most 1 MiB. An .lcc: 1 MiB, its JSON, and 16 bytes a cell.
   An .spz: from the first read on 65 bytes a Gaussian of SH degree 3 (92 of degree 4), and during that read the longest
   stream of version 4. A .rad: its JSON, a byte and a bit for each node of a tree, and the attributes of a chunk: at most
   240 bytes for each of its 65,536 Gaussians. A .sog: its compressed images; from the first read on, 4 bytes a pixel
   instead. A folder of gsplat: 24 bytes a pixel, and its palette and labels. A .glb or .gltf: 3 MiB, its JSON and
   base64, and the memory of its .spz. A tileset: 1200 bytes and the name of each content, and the memory of 33
   contents. cJSON, libzip, libwebp and zstd take their own memory from malloc; the part of cJSON counts towards
   max_memory too.

   Decompressed data are kept until the file is closed, so that later passes need not decompress them again; an .spz
   that several nodes of a glTF use is kept once. Where the .spz of a glTF or the files of a streamed SOG exceed
   max_memory together, those that fit are kept, and the others are decompressed again in each pass. Of the contents of
   a tileset, 32 stay open; the others are opened again in each pass.

   `path` must name a regular file or a folder as above. A file that another file refers to must lie in the folder of
   the opened file or below it: neither ".." nor a symbolic link may lead out of that folder. A \ in its name separates
   folders where no file has that very name. Several tiles may have one content, but no tileset is within itself. */
FXS_API int fxs_scene_file_open(const char *path, const fxs_scene_file_options *options, fxs_scene_file **file,
                                fxs_scene_file_info *info, fxs_message *message);

/* The same for a file in memory, which must stay unchanged until the handle is closed. Messages begin with `name`,
   which is copied. A scene of several files cannot be opened from memory. */
FXS_API int fxs_scene_file_open_memory(const char *name, const void *data, size_t size,
                                       const fxs_scene_file_options *options, fxs_scene_file **file,
                                       fxs_scene_file_info *info, fxs_message *message);

/* The same for a file that functions read; *input is copied. Its `close` is called also where opening fails. */
FXS_API int fxs_scene_file_open_input(const char *name, const fxs_scene_input *input,
                                      const fxs_scene_file_options *options, fxs_scene_file **file,
                                      fxs_scene_file_info *info, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
