/* Finds where the path of a film goes through something. */
#ifndef WALLS_H
#define WALLS_H

#include "drawing.h"

/* Prints a note if more than half of a frame is nearer than five near planes (a twentieth of the scene's radius, at
   most one unit), as while a camera passes through a wall. Looks at most at 200 frames. */
void say_walls(const renderer *r, const world *w, const frame_options *o, const fxs_view *frames, long count);

#endif
