/* A file as read-only memory. */
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
    int slot;                      /* in the table of what is mapped */
    int64_t modified[2];           /* the file's time when it was mapped: seconds, nanoseconds */
} fxs_mapping;

/* Maps a regular file of at least 1 byte. Returns 0, or FXS_ERR_FILE and a message. At most 64 files are mapped at
   once. Threads may map, check and unmap files of their own at the same time. */
int fxs_map(fxs_mapping *mapping, const char *path, fxs_message *message);

/* What is written to the file afterwards may show in the memory, and where the file is cut short, a read beyond its
   end is a SIGBUS. So a program that renders from a mapping asks after each frame, before it uses the picture. Returns
   0, or FXS_ERR_FILE and a message where the file has been written to or cut short since it was mapped. */
int fxs_map_check(const fxs_mapping *mapping, const char *path, fxs_message *message);

/* Installs a handler for SIGBUS, once a process; later calls do nothing. What a mapped file has lost reads as 0 from
   then on, on any thread, and fxs_map_check says so. Any other SIGBUS goes to the handler that was there before. */
void fxs_map_guard(void);

/* Null data is allowed. */
void fxs_unmap(fxs_mapping *mapping);

#ifdef __cplusplus
}
#endif

#endif
