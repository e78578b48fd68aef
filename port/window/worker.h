/* A thread that runs jobs while the window stays responsive. Only the window's thread may call these functions,
 * except fxs_worker_stopped and fxs_worker_tell. */
#ifndef FXS_WORKER_H
#define FXS_WORKER_H

typedef struct fxs_worker fxs_worker;

/* Starts the thread, which calls `done` after each job. Returns null if memory or threads ran out. */
fxs_worker *fxs_worker_start(void (*done)(void));

/* Stops the job, waits for its end and frees the worker. worker may be null. */
void fxs_worker_end(fxs_worker *worker);

/* Returns 1 while a job runs. */
int fxs_worker_busy(fxs_worker *worker);

void fxs_worker_stop(fxs_worker *worker);

void fxs_worker_wait(fxs_worker *worker);

/* Gives a job to the worker, which must be idle. */
void fxs_worker_do(fxs_worker *worker, void (*job)(void *argument), void *argument);

/* Returns the progress of the job, 0 to 1. */
double fxs_worker_progress(fxs_worker *worker);

/* Called by the job: an fxs_stop_fn, which returns 1 if the job must stop, and an fxs_progress_fn. */
int fxs_worker_stopped(void *worker);
int fxs_worker_tell(void *worker, double done);

#endif
