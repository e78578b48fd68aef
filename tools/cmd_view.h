/* The options of `fixsplat view`. */
#ifndef CMD_VIEW_H
#define CMD_VIEW_H

#include "frame_options.h"

typedef struct view_options {
    frame_options frame;
    const char *screenshot;
    double rate;                            /* of --fps; 0: none given */
    int web;                                /* in a page of a browser; the rest is of that: */
    const char *bind, *host, *certificate, *key;
    uint64_t port;
    int no_open, qr;
} view_options;

/* Returns 0, or prints what is wrong and returns EXIT_USAGE; after --help the program ends. */
int view_options_take(view_options *options, int argc, char **argv);

/* What each key does, a line each. */
extern const char viewer_keys[];

#endif
