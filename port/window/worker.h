/* A worker thread, which runs jobs in the background while the window stays responsive. Only the window's thread may
 * call these functions, except fxs_worker_stopped and fxs_worker_tell. */
#ifndef FXS_WORKER_H
#define FXS_WORKER_H

typedef struct fxs_worker fxs_worker;

/* Starts a worker thread, which calls `done` after each job. Returns null if memory or threads ran out. */
fxs_worker *fxs_worker_start(void (*done)(void));

/* Stops the worker's job, waits for the job's end and frees the worker. `worker` may be null. */
void fxs_worker_end(fxs_worker *worker);

/* Returns 1 while the worker runs a job. */
int fxs_worker_busy(fxs_worker *worker);

void fxs_worker_stop(fxs_worker *worker);

void fxs_worker_wait(fxs_worker *worker);

/* Gives a job to the worker, which must be idle. */
void fxs_worker_do(fxs_worker *worker, void (*job)(void *argument), void *argument);

/* Returns the progress of the worker's job, 0 to 1. */
double fxs_worker_progress(fxs_worker *worker);

/* A job calls these functions as its fxs_stop_fn and fxs_progress_fn. fxs_worker_stopped returns 1 if the job must
   stop. fxs_worker_tell reports progress. */
int fxs_worker_stopped(void *worker);
int fxs_worker_tell(void *worker, double done);

#endif
