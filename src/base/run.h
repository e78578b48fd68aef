/* Runs all jobs on the calling thread, for callers without a thread pool. The function has the type fxs_run_fn. */
#ifndef FXS_RUN_H
#define FXS_RUN_H

#include <stdint.h>

static inline void fxs_run_here(void *pool, void (*job)(void *argument, uint32_t i), void *argument, uint32_t jobs)
{
    (void)pool;
    for (uint32_t i = 0; i < jobs; i++)
        job(argument, i);
}

#endif
