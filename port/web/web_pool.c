/* Threads for fxs_config, of a module whose memory is shared. A helper is an instance of the same module in a worker
 * of its own (thread.js), with a stack of its own. One batch of jobs at a time, never from within a job. The caller
 * works at its own jobs and needs no helper: one that has not started yet, or never does, is not waited for. */
#include <stdint.h>
#include <stdlib.h>

#include "web.h"

#define HOT __attribute__((aligned(64)))       /* in a cache line of its own */
#define SPINS 2000u                            /* some ten microseconds, less than it takes to wake up */

static HOT uint32_t turn;          /* odd: there is a batch to help with. It only grows: a late helper sees that */
static HOT uint32_t inside;        /* helpers at work */
static HOT uint32_t next;          /* the first job that nobody has taken */
static HOT void (*batch_job)(void *, uint32_t);
static void *batch_argument;
static uint32_t batch_jobs, failed;
static uint32_t helpers, ending;   /* helpers: that have started */
static int may_wait;               /* 0: on a page's main thread, which may only spin */

static uint32_t get(const uint32_t *at)
{
    return __atomic_load_n(at, __ATOMIC_SEQ_CST);
}

static void add(uint32_t *at, uint32_t x)
{
    __atomic_fetch_add(at, x, __ATOMIC_SEQ_CST);
}

/* Until *at is no longer `value`. */
static void wait_while(uint32_t *at, uint32_t value, int sleeps)
{
    for (uint32_t i = 0; get(at) == value; i++)
        if (sleeps && i >= SPINS)
            __builtin_wasm_memory_atomic_wait32((int *)at, (int)value, -1);
}

static void wake(uint32_t *at)
{
    __builtin_wasm_memory_atomic_notify((int *)at, ~0u);
}

static void work(void)
{
    for (uint32_t i; (i = __atomic_fetch_add(&next, 1, __ATOMIC_SEQ_CST)) < batch_jobs;)
        batch_job(batch_argument, i);
}

/* Nobody joins any more; until those who did are done. */
EXPORT(settle) void fxs_web_settle(void)
{
    if (get(&turn) & 1)
        add(&turn, 1);
    for (uint32_t left; (left = get(&inside)) > 0;)
        wait_while(&inside, left, may_wait);
}

void fxs_web_run(void *pool, void (*job)(void *argument, uint32_t i), void *argument, uint32_t jobs)
{
    (void)pool;
    fxs_web_settle();              /* where the last one trapped */
    batch_job = job;
    batch_argument = argument;
    batch_jobs = jobs;
    next = 0;
    add(&turn, 1);
    wake(&turn);
    work();
    fxs_web_settle();
    if (get(&failed)) {
        failed = 0;
        __builtin_trap();          /* as the job would have done here */
    }
}

static void leave(void)
{
    add(&inside, ~0u);
    wake(&inside);
}

/* Whether the calling thread may wait for helpers; else it spins. */
EXPORT(may_wait) void fxs_web_may_wait(int yes)
{
    may_wait = yes;
}

/* What a helper does, until it is told to end. */
EXPORT(help) void fxs_web_help(void)
{
    uint32_t seen;
    add(&helpers, 1);
    while (seen = get(&turn), !get(&ending)) {     /* in this order: `end` writes them in the other */
        if (seen & 1) {
            add(&inside, 1);
            if (get(&turn) == seen)            /* then the caller sees who is inside, and keeps the batch */
                work();
            leave();
        }
        wait_while(&turn, seen, 1);
    }
    add(&helpers, ~0u);
}

/* A helper's job trapped, and the helper ends. */
EXPORT(trapped) void fxs_web_trapped(void)
{
    add(&helpers, ~0u);
    add(&failed, 1);
    leave();
}

/* Threads that there are by now, with the caller. */
EXPORT(threads) uint32_t fxs_web_threads(void)
{
    return get(&helpers) + 1;
}

/* Helpers end. */
EXPORT(end) void fxs_web_end(void)
{
    add(&ending, 1);
    add(&turn, 2);
    wake(&turn);
}
