/* A pool of POSIX threads for fxs_config: config.run = fxs_pool_run, config.pool = the pool.
 *
 * Stable from version 1.0 on. */
#ifndef FXS_POOL_H
#define FXS_POOL_H

#include <stdint.h>

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_pool fxs_pool;

/* Starts threads - 1 threads; the caller of fxs_pool_run works as one more. `threads` is 1 to 64. Returns null if the
   threads cannot be started. */
FXS_API fxs_pool *fxs_pool_create(uint32_t threads);

/* Runs job(argument, i) for i in 0..jobs-1 and returns when all jobs are done. Several threads may call it at once, and
   jobs may call it too: every caller runs its own jobs, and the pool's threads help the earliest caller. */
FXS_API void fxs_pool_run(void *pool, void (*job)(void *argument, uint32_t i), void *argument, uint32_t jobs);

/* Ends the threads and frees the pool, after every fxs_pool_run has returned; null is allowed. */
FXS_API void fxs_pool_destroy(fxs_pool *pool);

/* The number of processors that the calling thread may run on (on Linux by its affinity mask), 1 to 64. */
FXS_API uint32_t fxs_processors(void);

#ifdef __cplusplus
}
#endif

#endif
