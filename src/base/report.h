/* Calls the progress function of a program. */
#ifndef FXS_REPORT_H
#define FXS_REPORT_H

#include <fixsplat/scene.h>

/* Reports the finished share of the work, 0 to 1, to a progress function. `progress` may be null. Returns nonzero if
   the work should stop. */
static inline int fxs_report(const fxs_progress *progress, double done)
{
    return progress && progress->call && progress->call(progress->argument, done);
}

#endif
