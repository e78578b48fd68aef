/* Who looks on while a scene is fitted (--preview). */
#ifndef FIT_WATCHER_H
#define FIT_WATCHER_H

#include <fixsplat/photos.h>
#include "quality.h"

typedef struct fit_now {
    uint32_t step, steps;
    size_t gaussians;
    double loss, left;              /* a mean of the last steps; seconds until the last one */
} fit_now;

/* All are called on one thread: open first, before photographs are read, then begin, then the others. But for open they
   print what goes wrong with them, and the fit goes on. */
typedef struct fit_watcher {
    /* Returns 0, or prints why it cannot look on and returns the exit status. */
    int (*open)(const char *out, uint64_t port);

    /* Before the first step of this run. `photos` are there until `written`. `measures`: whether it is to measure the
       scene by itself from time to time, drawn with the options of `frame`; else `measured` is called. */
    void (*begin)(fxs_fit *fit, const fxs_photos *photos, const frame_options *frame, int measures,
                  const fit_now *now);

    /* Between two steps. */
    void (*look)(fxs_fit *fit, const fit_now *now);

    /* The scene was measured by all photographs that are for it, after that step. */
    void (*measured)(uint32_t step, const quality *q);

    /* The scene as it was written, and what is measured: the same, or all that was cropped. Fills in their start views
       and checksums. */
    void (*written)(fxs_packed_scene *packed, fxs_packed_scene *measured);

    /* No step follows: of a signal. */
    void (*stopped)(void);

    /* The end, with the exit status; also without begin. */
    void (*close)(int status);
} fit_watcher;

/* `fixsplat fit`. Where the watcher is null, --preview has the server run in the place of this program. Returns the
   exit status. */
int fit_run(int argc, char **argv, const fit_watcher *watcher);

#endif
