/* A log of a fit: a header, then a line at every hundredth of its steps and wherever it is measured, fields between
   tabs. Where a line cannot be written, that is said, and nothing is written after it. All functions do nothing for a
   log of no name. */
#ifndef FIT_LOG_H
#define FIT_LOG_H

#include <stdint.h>
#include <stdio.h>

#include "quality.h"

typedef struct fit_log {
    const char *name;              /* null: none */
    FILE *file;
    uint32_t every;                /* steps */
} fit_log;

/* Opens the file, and leaves in it what it has. Returns 0, or prints why not and returns EXIT_FAILED. */
int fit_log_open(fit_log *log, const char *name);

/* Before the first step of `steps`: the file is emptied where the fit does not go on from another. */
void fit_log_begin(fit_log *log, int goes_on, uint32_t steps);

/* Whether there is to be a line after this step. */
int fit_log_wants(const fit_log *log, uint32_t step);

/* `measured` may be null: then its fields are empty. `seconds`: since the first step. */
void fit_log_write(fit_log *log, uint32_t step, double seconds, size_t gaussians, double loss, const quality *measured);

void fit_log_close(fit_log *log);

#endif
