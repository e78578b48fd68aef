#include "pool.h"

#include <pthread.h>
#include <stdlib.h>
#include <unistd.h>

struct fxs_pool {
    pthread_mutex_t lock;
    pthread_cond_t start, done;
    uint32_t threads;                      /* beside the caller */
    uint32_t round, busy;                  /* rounds started; threads still in this one */
    int stop;
    void (*job)(void *, uint32_t);
    void *argument;
    uint32_t jobs, next;                   /* next is taken atomically */
    pthread_t handles[64];
};

static void work(fxs_pool *pool)
{
    for (;;) {
        uint32_t i = __atomic_fetch_add(&pool->next, 1, __ATOMIC_RELAXED);
        if (i >= pool->jobs)
            return;
        pool->job(pool->argument, i);
    }
}

static void *thread_main(void *argument)
{
    fxs_pool *pool = argument;
    uint32_t round = 0;
    for (;;) {
        pthread_mutex_lock(&pool->lock);
        while (pool->round == round && !pool->stop)
            pthread_cond_wait(&pool->start, &pool->lock);
        round = pool->round;
        int stop = pool->stop;
        pthread_mutex_unlock(&pool->lock);
        if (stop)
            return 0;
        work(pool);
        pthread_mutex_lock(&pool->lock);
        if (--pool->busy == 0)
            pthread_cond_signal(&pool->done);
        pthread_mutex_unlock(&pool->lock);
    }
}

fxs_pool *fxs_pool_create(uint32_t threads)
{
    fxs_pool *pool = threads < 1 || threads > 64 ? 0 : calloc(1, sizeof *pool);
    if (!pool)
        return 0;
    pthread_mutex_init(&pool->lock, 0);
    pthread_cond_init(&pool->start, 0);
    pthread_cond_init(&pool->done, 0);
    for (; pool->threads < threads - 1; pool->threads++)
        if (pthread_create(&pool->handles[pool->threads], 0, thread_main, pool)) {
            fxs_pool_destroy(pool);
            return 0;
        }
    return pool;
}

void fxs_pool_run(void *argument, void (*job)(void *, uint32_t), void *job_argument, uint32_t jobs)
{
    fxs_pool *pool = argument;
    pthread_mutex_lock(&pool->lock);
    pool->job = job;
    pool->argument = job_argument;
    pool->jobs = jobs;
    pool->next = 0;
    pool->busy = pool->threads;
    pool->round++;
    pthread_cond_broadcast(&pool->start);
    pthread_mutex_unlock(&pool->lock);
    work(pool);
    pthread_mutex_lock(&pool->lock);
    while (pool->busy)
        pthread_cond_wait(&pool->done, &pool->lock);
    pthread_mutex_unlock(&pool->lock);
}

void fxs_pool_destroy(fxs_pool *pool)
{
    if (!pool)
        return;
    pthread_mutex_lock(&pool->lock);
    pool->stop = 1;
    pthread_cond_broadcast(&pool->start);
    pthread_mutex_unlock(&pool->lock);
    for (uint32_t i = 0; i < pool->threads; i++)
        pthread_join(pool->handles[i], 0);
    pthread_mutex_destroy(&pool->lock);
    pthread_cond_destroy(&pool->start);
    pthread_cond_destroy(&pool->done);
    free(pool);
}

uint32_t fxs_processors(void)
{
    long n = sysconf(_SC_NPROCESSORS_ONLN);
    return n < 1 ? 1 : n > 64 ? 64 : (uint32_t)n;
}
