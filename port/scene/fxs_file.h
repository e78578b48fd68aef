/* .fxs: a packed scene (src/packed.h) in a file, checksums filled in. It is rendered from a read-only mapping as it
   is. Needs zlib for the checksums. */
#ifndef FXS_FXS_FILE_H
#define FXS_FXS_FILE_H

#include <stddef.h>

#include "../files/message.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Writes a packed scene that fxs_scene_open accepts, under a temporary name first. Returns 0, or -1 and a message. */
int fxs_file_write(const char *path, const void *data, size_t bytes, fxs_message *message);

/* Checks a mapped file of `bytes` bytes: its header's checksum and size; with `all`, every chunk's checksum too,
   which reads the whole file. `path` is for the message. Returns 0, or -1 and a message. */
int fxs_file_check(const char *path, const void *data, size_t bytes, int all, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
