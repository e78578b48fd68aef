/* Extracts frames from a film with ffmpeg. */
#ifndef FILM_FRAMES_H
#define FILM_FRAMES_H

#include "tools/command/task.h"

/* True if the path has the file ending of a film. */
int film_is_named(const char *path);

/* Writes `wanted` frames of a film as .jpg to a new folder: the sharpest frame of each of equal stretches. If `wanted`
   is 0, writes a tenth of the frames, but 60 to 300. */
int film_frames(task *t, const char *film, size_t wanted, const char *folder);

#endif
