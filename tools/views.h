/* The views that a scene is drawn from: from the options, a camera file or the scene itself. */
#ifndef VIEWS_H
#define VIEWS_H

#include "frame_options.h"
#include "src/camera/lens.h"

/* Whether the value of --view is all, or a list as 8..40 or 0,8,40..20. */
int names_several(const char *view);

/* The views that the options ask for, at their final size; of a film one for each frame. Up that is found in the scene
   becomes that of the options. Returns how many, with *views allocated; or prints why not and returns -1, with views
   null if it was null before. `lenses` may be null; *lenses, null before, gets those of the views of a file, but of a
   film. */
long choose_views(frame_options *options, const world *w, fxs_file_view **views, fxs_lens **lenses);

/* The number of the view that --view asks for, 0 without it; or prints that there is none and returns -1. */
long find_view(const frame_options *options, const fxs_file_view *views, long count);

#endif
