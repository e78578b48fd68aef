/* Runs jobs on threads in a module with shared memory (fxs_config.workers.run). A helper is a worker (thread.js) with
   another instance of the module. One batch of jobs runs at a time. The caller always runs job 0 and does not wait for
   helpers that have not started. */
#include <stdint.h>
#include <stdlib.h>

#include "web.h"

#define HOT __attribute__((aligned(64)))       /* aligns a variable to a cache line of its own */
/* Number of rounds that a thread spins before it sleeps: some ten microseconds, less than a wake-up takes. */
#define SPINS 2000u

static HOT uint32_t turn;          /* counter of batches of jobs; odd while a batch accepts helpers */
static HOT uint32_t inside;
static HOT uint32_t next;
static HOT void (*batch_job)(void *, uint32_t);
static void *batch_argument;
static uint32_t batch_jobs, failed;
static uint32_t helpers, ending;
/* whether the caller may sleep; 0 on the main thread of a page, which may only spin */
static int may_wait;

static uint32_t get(const uint32_t *at)
{
    return __atomic_load_n(at, __ATOMIC_SEQ_CST);
}

static void add(uint32_t *at, uint32_t x)
{
    __atomic_fetch_add(at, x, __ATOMIC_SEQ_CST);
}

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

/* Closes the batch of jobs to new helper threads, and waits for the helpers that run jobs. */
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
    fxs_web_settle();              /* ends the last batch of jobs, which is still open if one of its jobs trapped */
    batch_job = job;
    batch_argument = argument;
    batch_jobs = jobs;
    next = 1;
    add(&turn, 1);
    wake(&turn);
    if (jobs > 0)
        job(argument, 0);
    work();
    fxs_web_settle();
    if (get(&failed)) {
        failed = 0;
        __builtin_trap();
    }
}

static void leave(void)
{
    add(&inside, ~0u);
    wake(&inside);
}

EXPORT(may_wait) void fxs_web_may_wait(int yes)
{
    may_wait = yes;
}

EXPORT(help) void fxs_web_help(void)
{
    uint32_t seen;
    add(&helpers, 1);
    /* `turn` is read before `ending`, since fxs_web_end writes them in the reverse order */
    while (seen = get(&turn), !get(&ending)) {
        if (seen & 1) {
            add(&inside, 1);
            /* if the batch of jobs has not been closed, its caller waits until this helper has left */
            if (get(&turn) == seen)
                work();
            leave();
        }
        wait_while(&turn, seen, 1);
    }
    add(&helpers, ~0u);
}

EXPORT(trapped) void fxs_web_trapped(void)
{
    add(&helpers, ~0u);
    add(&failed, 1);
    leave();
}

EXPORT(threads) uint32_t fxs_web_threads(void)
{
    return get(&helpers) + 1;
}

EXPORT(end) void fxs_web_end(void)
{
    add(&ending, 1);
    add(&turn, 2);
    wake(&turn);
}
