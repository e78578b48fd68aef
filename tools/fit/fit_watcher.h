/* Callbacks that show a fit while it runs (--preview). */
#ifndef FIT_WATCHER_H
#define FIT_WATCHER_H

#include <fixsplat/fit.h>
#include "tools/command/quality.h"

typedef struct fit_now {
    uint32_t step, steps;
    size_t gaussians;
    double loss, left;              /* running mean; seconds to the end */
} fit_now;

/* All are called on one thread: open before photographs are read, then begin, then the others. Except open, they
   print their own errors, and the fit goes on. */
typedef struct fit_watcher {
    /* Returns 0, or prints the reason and returns the exit status. */
    int (*open)(const char *out, uint64_t port);

    /* Before the first step of this run. `photos` stay valid until `written`. measures 1: the watcher measures the
       scene itself from time to time, drawn with the options of `frame`; 0: `measured` is called. */
    void (*begin)(fxs_fit *fit, const fxs_photos *photos, const frame_options *frame, int measures,
                  const fit_now *now);

    /* After a step. */
    void (*look)(fxs_fit *fit, const fit_now *now);

    /* After a measurement of the scene against its photographs, at that step. */
    void (*measured)(uint32_t step, const quality *q);

    /* After the scene was written. `measured` is the same scene, or the uncropped one. Sets the start views and
       checksums of both scenes. */
    void (*written)(fxs_packed_scene *packed, fxs_packed_scene *measured);

    /* A signal has stopped the fit. */
    void (*stopped)(void);

    /* At the end, with the exit status; also without begin. */
    void (*close)(int status);
} fit_watcher;

/* Runs `fixsplat fit`. With a null watcher, --preview executes the server in place of this program. Returns the exit
   status. */
int fit_run(int argc, char **argv, const fit_watcher *watcher);

#endif
