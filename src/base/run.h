/* What stands in for a caller's threads. */
#ifndef FXS_RUN_H
#define FXS_RUN_H

#include <stdint.h>

/* An fxs_run_fn that makes all jobs on the thread that calls it. */
static inline void fxs_run_here(void *pool, void (*job)(void *argument, uint32_t i), void *argument, uint32_t jobs)
{
    (void)pool;
    for (uint32_t i = 0; i < jobs; i++)
        job(argument, i);
}

#endif
