/* Callbacks that show a running fit (option --preview). */
#ifndef FIT_WATCHER_H
#define FIT_WATCHER_H

#include <fixsplat/fit.h>
#include "tools/command/quality.h"

typedef struct fit_now {
    uint32_t step, steps;
    size_t gaussians;
    double loss, left;              /* running mean of the loss; estimated seconds to the end */
} fit_now;

/* Callbacks of a running fit. All run on one thread, starting with open and begin. A failure after open does not stop
   the fit. */
typedef struct fit_watcher {
    int (*open)(const char *out, uint64_t port);

    /* Runs before the first step. `photos` stay valid until callback `written`. measures 1: the watcher measures the
       scene itself; 0: the fit calls `measured`. */
    void (*begin)(fxs_fit *fit, const fxs_photos *photos, const frame_options *frame, int measures,
                  const fit_now *now);

    /* Runs after photographs were added to `photos` (--watch). */
    void (*grown)(void);

    void (*look)(fxs_fit *fit, const fit_now *now);

    void (*measured)(uint32_t step, const quality *q);

    /* Runs after the scene was written. `measured` is the scene before cropping. The callback sets the start views and
       checksums of both scenes. */
    void (*written)(fxs_packed_scene *packed, fxs_packed_scene *measured);

    void (*stopped)(void);

    /* Runs at the end of the program, even if `begin` never ran. */
    void (*close)(int status);
} fit_watcher;

/* Runs `fixsplat fit`, and returns the exit status. If `watcher` is null, option --preview starts the separate server
   program instead. */
int fit_run(int argc, char **argv, const fit_watcher *watcher);

#endif
