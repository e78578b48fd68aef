/* Waits for a condition variable until a time of fxs_clock. On Windows and macOS, a change of the system's time changes
 * the length of the wait. */
#ifndef TIMED_WAIT_H
#define TIMED_WAIT_H

#include <errno.h>
#include <pthread.h>
#include <stdint.h>
#include <time.h>

#include <fixsplat/system.h>

#if defined(_WIN32) || defined(__APPLE__)
#define BY_TIME_OF_DAY
#endif

static inline void timed_condition_init(pthread_cond_t *condition)
{
#ifdef BY_TIME_OF_DAY
    pthread_cond_init(condition, 0);
#else
    pthread_condattr_t monotonic;
    pthread_condattr_init(&monotonic);
    pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
    pthread_cond_init(condition, &monotonic);
    pthread_condattr_destroy(&monotonic);
#endif
}

/* Waits like pthread_cond_timedwait, until a time of fxs_clock. Returns 1 after a timeout, else 0. */
static inline int timed_wait(pthread_cond_t *condition, pthread_mutex_t *lock, uint64_t until)
{
    uint64_t end = until;
#ifdef BY_TIME_OF_DAY
    const uint64_t now = fxs_clock(0);
    struct timespec day;
    clock_gettime(CLOCK_REALTIME, &day);
    end = (uint64_t)day.tv_sec * 1000000000 + (uint64_t)day.tv_nsec + (until > now ? until - now : 0);
#endif
    const struct timespec t = {.tv_sec = (time_t)(end / 1000000000), .tv_nsec = (long)(end % 1000000000)};
    return pthread_cond_timedwait(condition, lock, &t) == ETIMEDOUT;
}

#endif
