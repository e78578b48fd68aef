/* Maps a file into memory, read-only. Stable from version 1.0 on. */
#ifndef FXS_MAP_H
#define FXS_MAP_H

#include <stddef.h>
#include <stdint.h>

#include "message.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_mapping {
    void *data;                    /* aligned to a page; null: nothing is mapped */
    size_t bytes;
    int descriptor;
    int slot;                      /* index in the table of mapped files */
    int64_t modified[2];           /* modification time of the file when it was mapped: seconds, nanoseconds */
} fxs_mapping;

/* Maps a regular file of at least 1 byte. Returns 0, or FXS_ERR_FILE and a message. At most 64 files can be mapped at
   once. Several threads may map, check and unmap their own files at the same time. */
FXS_API int fxs_map(fxs_mapping *mapping, const char *path, fxs_message *message);

/* Checks a mapped file. Later writes to the file may appear in the memory, and if the file is truncated, a read beyond
   its end raises SIGBUS. A program that renders from a mapping calls this after each frame, before it uses the picture.
   Returns 0, or FXS_ERR_FILE and a message if the file was written to or truncated since it was mapped. */
FXS_API int fxs_map_check(const fxs_mapping *mapping, const char *path, fxs_message *message);

/* Installs a handler for SIGBUS, once per process; later calls do nothing. Truncated parts of a mapped file then
   read as 0, on any thread, and fxs_map_check reports the loss. Any other SIGBUS goes to the previously installed
   handler. */
FXS_API void fxs_map_guard(void);

/* Unmaps a file; a mapping with null data is allowed. */
FXS_API void fxs_unmap(fxs_mapping *mapping);

#ifdef __cplusplus
}
#endif

#endif
