/* Prepares the scene of `fixsplat publish`, packed again if the options ask for that. */
#ifndef PUBLISH_SCENE_H
#define PUBLISH_SCENE_H

#include "load_scene.h"
#include "start_option.h"

typedef struct publish_start {
    vector_option up;              /* up direction of the scene */
    start_option view;             /* start view; not given: stays that of the file, or is chosen if there is none or
                                      `up` is given */
    const char *sound;             /* file of the sound of a moving scene; null: the sound in the scene's file */
} publish_start;

/* Opens a scene, sets its start view and computes its checksums. If `profile` is 1, an .fxs file is packed again with
   the compression profile of the options. Missing levels of detail are added. Close the scene with free_scene. */
int publish_load(loaded_scene *scene, const char *path, const load_options *options, int profile,
                 const publish_start *start);

enum { POSTER_FRAME = 40 };

/* Option --sound: takes the name of an audio file. */
int take_sound(const option_row *row, void *field, const char *value);

#define SOUND_EXPECTED "the name of an .mp3, .m4a, .aac, .ogg, .opus, .wav, .flac or .webm"

/* Writes the attribute poster-frame of <fixsplat-viewer> for a poster of width x height pixels that shows the scene's
   start view. The text is empty for a scene without a start view. */
void publish_frame(char text[POSTER_FRAME], const fxs_opened *opened, int width, int height);

/* Prints a note how much smaller the option --profile small would make an .fxs file. `words` is the current command,
   ended by null. */
void publish_say_gain(const loaded_scene *scene, char *const *words);

#endif
