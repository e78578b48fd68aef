/* A thread that runs one job at a time while the window stays responsive. Only the window's thread may call the
   functions, except the last two, which any thread may call. */
#ifndef FXS_WORKER_H
#define FXS_WORKER_H

typedef struct fxs_worker fxs_worker;

/* Starts the thread. It calls `done` after each job. Returns null if memory or threads ran out. */
fxs_worker *fxs_worker_start(void (*done)(void));

/* Asks the job to stop, waits for it and frees the worker. Null is allowed. */
void fxs_worker_end(fxs_worker *worker);

/* Returns 1 from fxs_worker_do until the job ends. */
int fxs_worker_busy(fxs_worker *worker);

/* Asks the job to stop. */
void fxs_worker_stop(fxs_worker *worker);

/* Waits until the worker is not busy. */
void fxs_worker_wait(fxs_worker *worker);

/* Gives a job to the worker, which must be idle. */
void fxs_worker_do(fxs_worker *worker, void (*job)(void *argument), void *argument);

/* The progress that the job last reported, 0 to 1. */
double fxs_worker_progress(fxs_worker *worker);

/* For the job, with the worker as argument: an fxs_stop_fn, which returns 1 if the job must stop, and an
   fxs_progress_fn, which also records the progress. */
int fxs_worker_stopped(void *worker);
int fxs_worker_tell(void *worker, double done);

#endif
