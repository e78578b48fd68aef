/* Takes frames out of a film, by ffmpeg. */
#ifndef FILM_FRAMES_H
#define FILM_FRAMES_H

#include "task.h"

/* Whether the name is one of a film. */
int film_is_named(const char *path);

/* Writes `wanted` frames (0: as many as seem right) to a folder that is not there yet, .jpg: the film is cut into as many
   stretches, and of each the sharpest is taken. The folder is there when all of them are. Returns 0, or prints what is
   wrong and returns EXIT_FAILED. */
int film_frames(task *t, const char *film, size_t wanted, const char *folder);

#endif
