/* Extracts frames from a film with ffmpeg. */
#ifndef FILM_FRAMES_H
#define FILM_FRAMES_H

#include "tools/command/task.h"

/* True if the name's ending is a film's. */
int film_is_named(const char *path);

/* Writes `wanted` frames (0: a tenth of the film's, 60 to 300) as .jpg to a folder that must not exist yet. The film
   is divided into `wanted` stretches, and the sharpest frame of each is taken. The folder appears when it is
   complete. Returns 0, or prints the error and returns EXIT_FAILED. */
int film_frames(task *t, const char *film, size_t wanted, const char *folder);

#endif
