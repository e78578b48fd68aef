/* Views of a list, and the frames of a film. */
#ifndef VIEWS_H
#define VIEWS_H

#include "options.h"

/* Whether the value of --view is all, or a list as 8..40 or 0,8,40..20. */
int names_several(const char *view);

/* The views that --view names, of `count` of its file: one, or those of a list. Returns how many, with *chosen
   allocated; or prints why not and returns -1, with *chosen null. */
long views_of_list(const frame_options *options, const fxs_file_view *views, long count, fxs_file_view **chosen);

/* Makes `count` views the frames of a turn about the world's middle, or of a way through them. Returns how many; or
   prints why not and returns -1, with *views freed and null. */
long frames_of_film(const frame_options *options, const world *w, fxs_file_view **views, long count);

#endif
