/* .fxs: a packed scene (src/include/fixsplat/packed.h) in a file, with its checksums filled in.
 *
 * The renderer reads such a file from a read-only mapping as it is. These functions need zlib for the checksums; built
 * without it, all are FXS_ERR_UNSUPPORTED. But for fxs_file_seal they only read the scene, so several threads may share
 * it. */
#ifndef FXS_FXS_FILE_H
#define FXS_FXS_FILE_H

#include <stddef.h>

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Writes the packed scene of `bytes` bytes at `data` (aligned to 64) to a file, as output.h says: after an error, a
   file that was there is as it was. Returns 0, or an error and a message: that of fxs_scene_open where this is no
   packed scene, FXS_ERR_FILE, FXS_ERR_MEMORY. */
int fxs_file_write(const char *path, const void *data, size_t bytes, fxs_message *message);

/* Fills in the checksums of a packed scene in memory: its `bytes` bytes at `data` (aligned to 64) are those of a file
   then. Returns 0, or the error of fxs_scene_open. */
int fxs_file_seal(void *data, size_t bytes);

/* Checks a file of `bytes` bytes that was mapped or read to `data` (aligned to 64): its size and the checksum of its
   header, and with `all` those of all chunks too, which reads the whole file. `path` is for the message. Returns 0, or
   an error and a message: FXS_ERR_FILE where it is damaged, FXS_ERR_VERSION where it is of another version. */
int fxs_file_check(const char *path, const void *data, size_t bytes, int all, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
