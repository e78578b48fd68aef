/* The option --start-view of `fixsplat convert` and `fixsplat publish`, and the start view of a packed scene. */
#ifndef START_OPTION_H
#define START_OPTION_H

#include <fixsplat/renderer.h>
#include "command_line.h"

typedef struct start_option {
    int given;
    int is_level;                  /* 1: the view is rolled upright, as the scene's up direction says */
    fxs_view view;
} start_option;

#define START_EXPECTED "six numbers or seven, the last 1 to 170, or a camera file"
#define DIRECTION_EXPECTED "a direction X,Y,Z, not 0,0,0"

/* Takes the value of --start-view into a start_option. */
int take_start(const option_row *row, void *field, const char *value);

/* Takes a direction, X,Y,Z. */
int take_direction(const option_row *row, void *field, const char *value);

/* Stores the view of the option in a packed scene. Returns 0, or an error and a message. */
int start_store(const start_option *o, void *data, fxs_message *message);

/* Finds the up direction of an open scene by looking at it from many sides. Returns 0, or an error and a message. */
int find_up(const fxs_opened *opened, double up[3], fxs_message *message);

#endif
