/* Cuts ranges of time out of moving scenes, and repeats or extends them. */
#ifndef FXS_TIME_RANGE_H
#define FXS_TIME_RANGE_H

#include <fixsplat/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Attaches a range of times to an open file of a moving scene. From then on, fxs_scene_file_read returns the Gaussians
   that are visible from `from` to before `to`, seconds; time `from` is 0, and info->time and info->count are the new
   ones. Before 0 and after its duration, a scene that loops is repeated, at most 4096 times, and another stays at its
   first or last moment. Times within 2^-12 seconds of the start of a frame mean this frame. A still scene is not
   changed. The file is read once, and each pass over the result reads it once for each repetition. Returns 0, or an
   error and a message; the caller must then close the file. Errors: as fxs_scene_file_at; FXS_ERR_ARGUMENT for less
   than 1/1024 second, 16384 or more, or too many repetitions. */
FXS_EXPERIMENTAL int fxs_scene_file_between(fxs_scene_file *file, double from, double to, fxs_scene_file_info *info,
                                            fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
