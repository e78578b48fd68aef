/* Callbacks that show a running fit (--preview). */
#ifndef FIT_WATCHER_H
#define FIT_WATCHER_H

#include <fixsplat/fit.h>
#include "tools/command/quality.h"

typedef struct fit_now {
    uint32_t step, steps;
    size_t gaussians;
    double loss, left;              /* running mean of the loss; seconds to the end */
} fit_now;

/* All callbacks run on one thread, starting with open and begin. A failure after open does not stop the fit. */
typedef struct fit_watcher {
    int (*open)(const char *out, uint64_t port);

    /* Runs before the first step. `photos` stay valid until `written`. measures 1: the watcher measures the scene
       itself; 0: `measured` is called. */
    void (*begin)(fxs_fit *fit, const fxs_photos *photos, const frame_options *frame, int measures,
                  const fit_now *now);

    void (*look)(fxs_fit *fit, const fit_now *now);

    void (*measured)(uint32_t step, const quality *q);

    /* Runs after the scene was written. `measured` is the scene, uncropped. The callback sets the start views and
       checksums of both scenes. */
    void (*written)(fxs_packed_scene *packed, fxs_packed_scene *measured);

    void (*stopped)(void);

    /* Runs at the end of the program, even without begin. */
    void (*close)(int status);
} fit_watcher;

/* Runs `fixsplat fit`, and returns the exit status. With a null watcher, --preview starts the server program
   instead. */
int fit_run(int argc, char **argv, const fit_watcher *watcher);

#endif
