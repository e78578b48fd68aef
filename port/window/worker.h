/* A thread that does one job at a time, while the window goes on. The last two functions are for any thread,
   the others for one, the window's. */
#ifndef FXS_WORKER_H
#define FXS_WORKER_H

typedef struct fxs_worker fxs_worker;

/* Starts it; `done` is called on it after each job. Null where there is no memory or thread. */
fxs_worker *fxs_worker_start(void (*done)(void));

/* Asks the job to stop, waits for its end and frees the worker; null is allowed. */
void fxs_worker_end(fxs_worker *worker);

/* Whether a job is given and not done yet. */
int fxs_worker_busy(fxs_worker *worker);

/* Asks the job that it has to stop. */
void fxs_worker_stop(fxs_worker *worker);

/* Waits until it is not busy. */
void fxs_worker_wait(fxs_worker *worker);

/* Gives it a job; it is not busy. */
void fxs_worker_do(fxs_worker *worker, void (*job)(void *argument), void *argument);

/* How much of the job is done, 0 to 1, by what it told last. */
double fxs_worker_progress(fxs_worker *worker);

/* For the job: whether it is to stop, an fxs_stop_fn; and the same that tells how much is done, an fxs_progress_fn. The
   argument is the worker. */
int fxs_worker_stopped(void *worker);
int fxs_worker_tell(void *worker, double done);

#endif
