/* Scene files: opens a stream of Gaussians (gaussian.h) in the file's order, whatever the format.
 *
 * Functions return 0 or a count, or an error and a message: FXS_ERR_FILE where a file is missing, damaged, of an
 * unknown format, changed while it was open, or beyond max_gaussians; FXS_ERR_STOPPED where a progress function said
 * so; FXS_ERR_MEMORY where memory ended, or more than max_memory would be needed (bytes_needed has how much);
 * FXS_ERR_UNSUPPORTED where this was built without a library that the format needs; FXS_ERR_ARGUMENT for a level that
 * there is not. A file is used by one thread at a time; several threads may each have files of their own. */
#ifndef FXS_SCENE_FILE_H
#define FXS_SCENE_FILE_H

#include "gaussian.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Opens a scene file, or a folder with the meta.json or lod-meta.json of a .sog or the tileset.json of 3D Tiles. The
   content tells the format. `options` may be null. Returns 0 and a handle that fxs_scene_file_close frees, or an error
   and a message, with *file null. 2D Gaussians are read as 3D ones with a scale of e^-20 across; a glTF of linear
   light is refused.

   The header is checked whole, and the size of a binary body against it. Only headers are read, so that *info is known
   before anything large is allocated. But a .ply is read up to its vertices where it has lists or text before them, and
   .sog (each file of a level) as far as its images, which are kept compressed.

   What a reader allocates. A .ply, .ksplat or .splat: at most 1 MiB. An .lcc: 1 MiB, its JSON, and 16 bytes a cell. An
   .spz: from the first read on 65 bytes a Gaussian of SH degree 3 (92 of 4), and for that read the longest stream of
   version 4. A .sog: its images, and from the first read on 4 bytes a pixel of each instead. A .glb or .gltf: 3 MiB, its
   JSON and base64, and as its .spz. A tileset: 512 bytes a content, and as 33 of them. What cJSON, libzip, libwebp and
   zstd need themselves comes from malloc. Of that, cJSON's part is held against max_memory too.

   What is decompressed is kept until the file is closed, so that no pass over it decompresses it again, and one .spz
   that several nodes of a glTF use is there once. Where the .spz of a glTF or the files of a streamed SOG are more than
   max_memory together, those that fit are kept, and the others are decompressed again in each pass. Of a tileset 32
   contents stay open; the others are opened again in each pass.

   A path must be that of a regular file, or of a folder as above. A file that another refers to must lie in the folder
   of the one that was opened, or in a folder within: neither ".." nor a symbolic link may lead out of it. It may be
   the content of one tile only. */
int fxs_scene_file_open(const char *path, const fxs_scene_file_options *options, fxs_scene_file **file,
                        fxs_scene_file_info *info, fxs_message *message);

/* The same for a file in memory, which must stay as it is until the handle is closed. `name` begins messages, and is
   copied. A format that refers to other files cannot be opened so. */
int fxs_scene_file_open_memory(const char *name, const void *data, size_t size, const fxs_scene_file_options *options,
                               fxs_scene_file **file, fxs_scene_file_info *info, fxs_message *message);

/* The same by functions; *input is copied. Its `close` is called also where opening fails. */
int fxs_scene_file_open_input(const char *name, const fxs_scene_input *input, const fxs_scene_file_options *options,
                              fxs_scene_file **file, fxs_scene_file_info *info, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
