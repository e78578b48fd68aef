/* The options of `fixsplat view`. */
#ifndef WINDOW_OPTIONS_H
#define WINDOW_OPTIONS_H

#include "command.h"

typedef struct window_options {
    view_options view;
    const char *scene, *screenshot;
} window_options;

/* Returns 0, or prints what is wrong and returns EXIT_USAGE; after --help the program ends. */
int window_options_take(window_options *options, int argc, char **argv);

/* The keys, a line each. */
extern const char viewer_keys[];

#endif
