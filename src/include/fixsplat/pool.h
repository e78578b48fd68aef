/* A pool of POSIX threads for fxs_config: config.run = fxs_pool_run, config.pool = the pool. */
#ifndef FXS_POOL_H
#define FXS_POOL_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_pool fxs_pool;

/* Starts threads - 1 threads, the caller of fxs_pool_run is the last; threads in 1..64. Null where they cannot be
   had. */
fxs_pool *fxs_pool_create(uint32_t threads);

/* Runs job(argument, i) for i in 0..jobs-1 and returns when all are done. Several threads may call it at once, and a
   job may call it too: every caller works at its own jobs, and the pool's threads help the one that came first. */
void fxs_pool_run(void *pool, void (*job)(void *argument, uint32_t i), void *argument, uint32_t jobs);

/* Ends the threads and frees the pool, when every fxs_pool_run has returned; null is allowed. */
void fxs_pool_destroy(fxs_pool *pool);

/* Processors that the calling thread may run on, by its affinity mask on Linux; 1 to 64. */
uint32_t fxs_processors(void);

#ifdef __cplusplus
}
#endif

#endif
