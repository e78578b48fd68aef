/* Chooses the views to draw: from the options, a camera file or the scene itself. */
#ifndef VIEWS_H
#define VIEWS_H

#include "frame_options.h"
#include "src/camera/lens.h"

/* True if the value of --view is "all" or a list such as 8..40 or 0,8,40..20. */
int names_several(const char *view);

/* Returns the number of views that the options ask for, and allocates them in *views at their final size; a film has
   one for each frame. An up direction found in the scene is stored in the options. On failure prints the reason and
   returns -1, and leaves *views null if it was null. `lenses` may be null; otherwise *lenses must be null, and gets
   the lenses of a camera file's views, except for a film. */
long choose_views(frame_options *options, const world *w, fxs_file_view **views, fxs_lens **lenses);

/* The number of the view that --view names, 0 without --view. If it does not exist, prints that and returns -1. */
long find_view(const frame_options *options, const fxs_file_view *views, long count);

#endif
