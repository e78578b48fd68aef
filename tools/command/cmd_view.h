/* The options of `fixsplat view`. */
#ifndef CMD_VIEW_H
#define CMD_VIEW_H

#include "frame_options.h"

typedef struct view_options {
    frame_options frame;
    const char *screenshot;
    double rate;                            /* --fps; 0: not given */
    int web;                                /* 1: in a browser; the following fields are for that: */
    const char *bind, *host, *certificate, *key;
    uint64_t port;
    int no_open, qr;
} view_options;

/* Returns 0, or prints the error and returns EXIT_USAGE; --help ends the program. */
int view_options_take(view_options *options, int argc, char **argv);

/* One line for each key and its action. */
extern const char viewer_keys[];

#endif
