/* .fxs files: packed scenes (packed.h) with their checksums filled in.
 *
 * The renderer reads such a file directly from a read-only mapping. The functions need no other library. Several
 * threads may share a scene; only fxs_file_seal writes to it.
 *
 * Stable from version 1.0 on. */
#ifndef FXS_FXS_FILE_H
#define FXS_FXS_FILE_H

#include <stddef.h>

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Writes the packed scene of `bytes` bytes at `data` (aligned to 64) to a file, as output.h says: after an error, an
   existing file of that name is unchanged. Returns 0, or an error and a message: the error of fxs_scene_open if the
   data are not a packed scene, FXS_ERR_FILE, FXS_ERR_MEMORY. */
FXS_API int fxs_file_write(const char *path, const void *data, size_t bytes, fxs_message *message);

/* Fills in the checksums of a packed scene in memory, `bytes` bytes at `data` (aligned to 64), which then equals the
   content of an .fxs file. Returns 0, or the error of fxs_scene_open. */
FXS_API int fxs_file_seal(void *data, size_t bytes);

/* Checks the size and the header's checksum of a file of `bytes` bytes that was mapped or read to `data` (aligned to
   64). With `all` it also checks the palette and every chunk, which reads the whole file. `path` is for the message.
   Returns 0, or an error and a message: FXS_ERR_FILE if the file is damaged, FXS_ERR_VERSION if it has another
   version. */
FXS_API int fxs_file_check(const char *path, const void *data, size_t bytes, int all, fxs_message *message);

/* Writes the numbers of the Gaussians of an open scene, as in fxs_id, to `numbers`, which has room for scene->count of
   them, in the order of a stream of the scene. They are 0, 1, 2 ... except in scenes with holes (packed.h). Returns the
   number of entries written, fewer than scene->count only if the scene is damaged. */
FXS_API uint32_t fxs_scene_numbers(const fxs_scene *scene, uint32_t *numbers);

#ifdef __cplusplus
}
#endif

#endif
