/* Progress of a fit, on stderr and in a log. */
#ifndef FIT_PROGRESS_H
#define FIT_PROGRESS_H

#include <stdint.h>
#include <stdio.h>

#include "fit_watcher.h"

enum { FIT_STAGES = 6 };

typedef struct fit_progress {
    uint32_t first, steps;          /* first step of this run; number of all steps */
    uint32_t counted, reports;      /* last step counted; number of reports */
    uint32_t saved;                 /* the step saved in OUT.fit; 0: this fit was not saved */
    uint64_t start, last, shown;    /* nanoseconds: start of the run, last step, last line */
    size_t gaussians;               /* after the last step counted */
    double pace, loss;              /* seconds a step, and loss; running means over about 50 steps */
    uint64_t stages[FIT_STAGES];    /* nanoseconds, summed over the reported steps */
} fit_progress;

/* Counts the steps up to `step`, which has a report, and shows progress. */
void fit_progress_count(fit_progress *progress, uint32_t step, const fxs_fit_report *report);

/* The state for a watcher. */
fit_now fit_progress_now(const fit_progress *progress, uint32_t step, size_t gaussians);

/* Seconds from the start to the last step counted. */
double fit_progress_seconds(const fit_progress *progress);

/* A log of a fit: a header, then a line of tab-separated fields at every hundredth of the steps and at every
   measurement. A failed write is reported once, and the log ends. With a null name all functions do nothing. */
typedef struct fit_log {
    const char *name;              /* null: no log */
    FILE *file;
    uint32_t every;                /* steps between lines */
} fit_log;

/* Opens the file without emptying it. Returns 0, or prints the reason and returns EXIT_FAILED. */
int fit_log_open(fit_log *log, const char *name);

/* Call before the first of `steps` steps. Empties the file unless goes_on is 1 (a resumed fit). */
void fit_log_begin(fit_log *log, int goes_on, uint32_t steps);

/* True if this step gets a line. */
int fit_log_wants(const fit_log *log, uint32_t step);

/* Writes a line for the last step counted. `measured` may be null; then its fields are empty. */
void fit_log_write(fit_log *log, const fit_progress *progress, const quality *measured);

void fit_log_close(fit_log *log);

#endif
