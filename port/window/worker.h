/* A thread that does one job at a time while the window goes on. Any thread may call the last two functions, only the
   window's thread the others. */
#ifndef FXS_WORKER_H
#define FXS_WORKER_H

typedef struct fxs_worker fxs_worker;

/* Starts the thread, which calls `done` after each job. Null where there is no memory or thread. */
fxs_worker *fxs_worker_start(void (*done)(void));

/* Asks the job to stop, waits for its end and frees the worker; null is allowed. */
void fxs_worker_end(fxs_worker *worker);

/* Whether a job was given and is not done yet. */
int fxs_worker_busy(fxs_worker *worker);

/* Asks the job to stop. */
void fxs_worker_stop(fxs_worker *worker);

/* Waits until the worker is not busy. */
void fxs_worker_wait(fxs_worker *worker);

/* Gives a job to the worker, which must not be busy. */
void fxs_worker_do(fxs_worker *worker, void (*job)(void *argument), void *argument);

/* The part of the job that is done, 0 to 1, by its last report. */
double fxs_worker_progress(fxs_worker *worker);

/* For the job: an fxs_stop_fn, which says whether it must stop, and an fxs_progress_fn, which also notes its progress.
   The argument is the worker. */
int fxs_worker_stopped(void *worker);
int fxs_worker_tell(void *worker, double done);

#endif
