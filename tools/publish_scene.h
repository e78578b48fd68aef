/* The scene that `fixsplat publish` writes: as its file has it, or packed as the options say. */
#ifndef PUBLISH_SCENE_H
#define PUBLISH_SCENE_H

#include "load_scene.h"

/* Opens a scene, sealed, for free_scene. An .fxs is packed anew where `profile` is 1 and its profile is not that of the
   options, or where they ask for levels of detail that it lacks; what else it has stays, with up and its start view.
   Returns 0, or prints why not and returns EXIT_FAILED. */
int publish_load(loaded_scene *scene, const char *path, const load_options *options, int profile);

/* Says what packing an .fxs for a page would gain, and the command for it: that of `words`, up to a null, and more. */
void publish_say_gain(const loaded_scene *scene, char *const *words);

#endif
