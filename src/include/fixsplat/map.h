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
    int64_t modified[2];           /* the file's modification time when it was mapped: seconds, nanoseconds */
} fxs_mapping;

/* Maps a regular file of at least 1 byte. Returns 0, or FXS_ERR_FILE and a message. At most 64 files can be mapped at
   once. Several threads may map, check and unmap files of their own at the same time. */
FXS_API int fxs_map(fxs_mapping *mapping, const char *path, fxs_message *message);

/* Checks a mapped file. Later writes to the file may show in the memory, and where the file was cut short, a read
   beyond its end raises SIGBUS. So a program that renders from a mapping calls this after each frame, before it uses
   the picture. Returns 0, or FXS_ERR_FILE and a message where the file was written to or cut short since it was mapped.
   */
FXS_API int fxs_map_check(const fxs_mapping *mapping, const char *path, fxs_message *message);

/* Installs a handler for SIGBUS, once in a process; later calls do nothing. Bytes that a mapped file has lost then read
   as 0, on any thread, and fxs_map_check reports it. Any other SIGBUS goes to the handler that was installed before. */
FXS_API void fxs_map_guard(void);

/* Unmaps a file; a mapping whose data are null is allowed. */
FXS_API void fxs_unmap(fxs_mapping *mapping);

#ifdef __cplusplus
}
#endif

#endif
