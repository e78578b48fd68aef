/* Thread pool. Each call of fxs_pool_run puts a batch of jobs in a list. The caller and all threads of the pool take
   jobs by an atomic counter. */
#include <fixsplat/system.h>

#include <pthread.h>
#include <stdlib.h>

typedef struct batch {
    void (*job)(void *, uint32_t);
    void *argument;
    uint32_t jobs, next;                   /* next: index of the batch's next job, incremented atomically */
    uint32_t helpers;
    struct batch *after;
} batch;

struct fxs_pool {
    pthread_mutex_t lock;
    pthread_cond_t start, done;
    uint32_t threads;                      /* number of pool threads, without callers */
    int stop;
    batch *first;
    pthread_t handles[64];
};

static void append(fxs_pool *pool, batch *b)
{
    batch **end = &pool->first;
    while (*end)
        end = &(*end)->after;
    *end = b;
}

/* Runs jobs of a batch until none is left. Releases the pool's lock while jobs run. */
static void work(fxs_pool *pool, batch *b)
{
    pthread_mutex_unlock(&pool->lock);
    for (uint32_t i; (i = __atomic_fetch_add(&b->next, 1, __ATOMIC_RELAXED)) < b->jobs;)
        b->job(b->argument, i);
    pthread_mutex_lock(&pool->lock);
    for (batch **at = &pool->first; *at; at = &(*at)->after)
        if (*at == b) {
            *at = b->after;
            break;
        }
}

static void *thread_main(void *argument)
{
    fxs_pool *pool = argument;
    pthread_mutex_lock(&pool->lock);
    while (!pool->stop) {
        batch *b = pool->first;
        if (!b) {
            pthread_cond_wait(&pool->start, &pool->lock);
            continue;
        }
        b->helpers++;
        work(pool, b);
        if (--b->helpers == 0)
            pthread_cond_broadcast(&pool->done);
    }
    pthread_mutex_unlock(&pool->lock);
    return 0;
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
    batch b = {job, job_argument, jobs, 0, 0, 0};
    pthread_mutex_lock(&pool->lock);
    append(pool, &b);
    pthread_cond_broadcast(&pool->start);
    work(pool, &b);
    while (b.helpers)
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
