/* A thread that waits for jobs and runs them. A mutex guards the state that several threads use. */
#include "worker.h"

#include <pthread.h>
#include <stdlib.h>

struct fxs_worker {
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    void (*done)(void);
    void (*job)(void *argument);
    void *argument;
    double progress;
    int stop, ending;
};

static void *work(void *argument)
{
    fxs_worker *w = argument;
    pthread_mutex_lock(&w->lock);
    while (w->job || !w->ending) {
        if (!w->job) {
            pthread_cond_wait(&w->changed, &w->lock);
            continue;
        }
        pthread_mutex_unlock(&w->lock);
        w->job(w->argument);
        pthread_mutex_lock(&w->lock);
        w->job = 0;
        pthread_cond_broadcast(&w->changed);
        w->done();
    }
    pthread_mutex_unlock(&w->lock);
    return 0;
}

fxs_worker *fxs_worker_start(void (*done)(void))
{
    fxs_worker *w = calloc(1, sizeof *w);
    if (!w)
        return 0;
    w->done = done;
    pthread_mutex_init(&w->lock, 0);
    pthread_cond_init(&w->changed, 0);
    if (!pthread_create(&w->thread, 0, work, w))
        return w;
    pthread_cond_destroy(&w->changed);
    pthread_mutex_destroy(&w->lock);
    free(w);
    return 0;
}

void fxs_worker_end(fxs_worker *w)
{
    if (!w)
        return;
    pthread_mutex_lock(&w->lock);
    w->stop = w->ending = 1;
    pthread_cond_broadcast(&w->changed);
    pthread_mutex_unlock(&w->lock);
    pthread_join(w->thread, 0);
    pthread_cond_destroy(&w->changed);
    pthread_mutex_destroy(&w->lock);
    free(w);
}

int fxs_worker_busy(fxs_worker *w)
{
    pthread_mutex_lock(&w->lock);
    const int busy = w->job != 0;
    pthread_mutex_unlock(&w->lock);
    return busy;
}

void fxs_worker_stop(fxs_worker *w)
{
    pthread_mutex_lock(&w->lock);
    w->stop = 1;
    pthread_mutex_unlock(&w->lock);
}

void fxs_worker_wait(fxs_worker *w)
{
    pthread_mutex_lock(&w->lock);
    while (w->job)
        pthread_cond_wait(&w->changed, &w->lock);
    pthread_mutex_unlock(&w->lock);
}

void fxs_worker_do(fxs_worker *w, void (*job)(void *argument), void *argument)
{
    pthread_mutex_lock(&w->lock);
    w->progress = 0;
    w->stop = 0;
    w->argument = argument;
    w->job = job;
    pthread_cond_broadcast(&w->changed);
    pthread_mutex_unlock(&w->lock);
}

double fxs_worker_progress(fxs_worker *w)
{
    pthread_mutex_lock(&w->lock);
    const double progress = w->progress;
    pthread_mutex_unlock(&w->lock);
    return progress;
}

int fxs_worker_stopped(void *worker)
{
    fxs_worker *w = worker;
    pthread_mutex_lock(&w->lock);
    const int stop = w->stop;
    pthread_mutex_unlock(&w->lock);
    return stop;
}

int fxs_worker_tell(void *worker, double done)
{
    fxs_worker *w = worker;
    pthread_mutex_lock(&w->lock);
    w->progress = done;
    pthread_mutex_unlock(&w->lock);
    return fxs_worker_stopped(w);
}
