/* Services of the operating system: clock, mapped files, threads, output files. */
#ifndef FXS_SYSTEM_H
#define FXS_SYSTEM_H

#include <stddef.h>
#include <stdint.h>

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Clock ------------------------------------------------------------------------------------------------------- */

/* A clock that a program can give to the library in fxs_config. */

/* Returns nanoseconds of a clock that never goes back. */
FXS_API uint64_t fxs_clock(void *unused);

/* ---- Mapped files ------------------------------------------------------------------------------------------------ */

/* Maps a file into memory, read-only. */

typedef struct fxs_mapping {
    void *data;                    /* content of the file, aligned to a page; null: nothing is mapped */
    size_t bytes;
    int descriptor;
    int slot;                      /* index of this mapping in the library's table of mapped files */
    int64_t modified[2];           /* modification time of the file when it was mapped: seconds, nanoseconds */
} fxs_mapping;

/* Maps a regular file of at least 1 byte. Returns 0, or FXS_ERR_FILE and a message. At most 64 files can be mapped at
   once. Several threads may map, check and unmap their own files at the same time. */
FXS_API int fxs_map_open(fxs_mapping *mapping, const char *path, fxs_message *message);

/* Checks that a mapped file is unchanged. Later writes to the file may appear in the memory, and if the file is
   truncated, a read beyond its end raises SIGBUS. A program that renders from a mapping calls this after each frame,
   before it uses the picture. Returns 0, or FXS_ERR_FILE and a message if the file was written to or truncated since it
   was mapped. */
FXS_API int fxs_map_check(const fxs_mapping *mapping, const char *path, fxs_message *message);

/* Installs a handler for SIGBUS, once per process; later calls do nothing. Truncated parts of a mapped file then
   read as 0, on any thread, and fxs_map_check reports the loss. Any other SIGBUS goes to the previously installed
   handler. */
FXS_API void fxs_map_guard(void);

/* Unmaps a file; a mapping with null data is allowed. */
FXS_API void fxs_map_close(fxs_mapping *mapping);

/* ---- Threads ----------------------------------------------------------------------------------------------------- */

/* A pool of POSIX threads that runs the library's jobs, for fxs_workers: {fxs_pool_run, pool, threads}. */

typedef struct fxs_pool fxs_pool;

/* Creates a thread pool. It starts threads - 1 threads; the caller of fxs_pool_run works as one more. `threads` is 1 to
   64. Returns null if the threads cannot be started. */
FXS_API fxs_pool *fxs_pool_create(uint32_t threads);

/* Runs job(argument, i) for i in 0..jobs-1 and returns when all jobs are done. Several threads may call it at once, and
   jobs may call it too: every caller runs its own jobs, and the pool's threads help the earliest caller. */
FXS_API void fxs_pool_run(void *pool, void (*job)(void *argument, uint32_t i), void *argument, uint32_t jobs);

/* Ends the threads of a pool and frees it, after every fxs_pool_run has returned; null is allowed. */
FXS_API void fxs_pool_destroy(fxs_pool *pool);

/* Returns the number of processors that the calling thread may run on (on Linux by its affinity mask), 1 to 64. */
FXS_API uint32_t fxs_processors(void);

/* ---- Output files ------------------------------------------------------------------------------------------------ */

/* How the library writes files. A file has a temporary name in the same folder until it is complete and on disk. If the
   process is killed, the temporary file stays; the next process that writes the same file removes it. An existing file
   keeps its permissions. For a symbolic link, its target is written, even if the target does not exist yet. A FIFO, a
   device or standard output ("-", or another name such as /dev/stdout) gets the bytes immediately, so bytes written
   before an error stay there. Several threads may write at the same time, each its own file. */

#ifdef __cplusplus
}
#endif

#endif
