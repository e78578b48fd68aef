/* Chooses the views to draw: from the options, a camera file or the scene. */
#ifndef VIEWS_H
#define VIEWS_H

#include "frame_options.h"
#include "src/camera/lens.h"

/* True if a value of option --view names several views, such as "all" or 0,8,40..20. */
int names_several(const char *view);

/* Allocates the views that the options ask for and returns their number; a frame of a film has views_per_frame. An up
   direction found in the scene is stored in the options. *lenses, initially null, gets the lenses of a camera file;
   `lenses` may be null. On failure prints the reason and returns -1. */
long choose_views(frame_options *options, const world *w, fxs_view **views, fxs_lens **lenses);

/* Returns the number of views of each frame: more than 1 with motion blur, a view for each sample. */
int views_per_frame(const frame_options *options);

/* Returns the number of the view that option --view names, 0 by default. On failure prints the reason and returns
   -1. */
long find_view(const frame_options *options, const fxs_view *views, long count);

#endif
