/* Options of `fixsplat view`. */
#ifndef CMD_VIEW_H
#define CMD_VIEW_H

#include "frame_options.h"

typedef struct view_options {
    frame_options frame;
    const char *screenshot, *walls;
    double rate, eye_height;
    int web;
    const char *bind, *host, *certificate, *key;
    uint64_t port;
    int no_open, qr;
    int xr, pass_through;
    double metres_per_unit;
} view_options;

int view_options_take(view_options *options, int argc, char **argv);

/* Shows the scenes in a headset until the session ends or a signal asks for it. */
int view_in_headset(const view_options *options);

/* Help text about the keys of the viewer's window. */
extern const char viewer_keys[];

#endif
