/* The scene that `fixsplat publish` writes: its file's content, or packed again by the options. */
#ifndef PUBLISH_SCENE_H
#define PUBLISH_SCENE_H

#include "load_scene.h"

/* Opens a scene, sealed; close it with free_scene. An .fxs is packed again if `profile` is 1 and its profile differs
   from the options', or if it lacks the levels of detail that the options ask for; its other properties stay,
   including up and start view. Returns 0, or prints the reason and returns EXIT_FAILED. */
int publish_load(loaded_scene *scene, const char *path, const load_options *options, int profile);

/* Notes how much smaller profile small would make an .fxs, with the command: `words`, ended by null, and --profile
   small. */
void publish_say_gain(const loaded_scene *scene, char *const *words);

#endif
