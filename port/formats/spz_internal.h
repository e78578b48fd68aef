/* .spz in memory: a file of its own, or a bufferView of a glTF. */
#ifndef FXS_SPZ_INTERNAL_H
#define FXS_SPZ_INTERNAL_H

#include "scene_file.h"

typedef struct fxs_spz fxs_spz;

/* Decompresses and checks all of it; `data` is not needed afterwards. The Gaussians are in the axes of a .ply (right,
   down, front), or with keep_axes as stored. `name` begins messages. Returns 0 and what fxs_spz_close frees, and *info
   but for its format; or -1 and a message. */
int fxs_spz_open(const char *name, const uint8_t *data, size_t size, int keep_axes, fxs_spz **spz,
                 fxs_scene_file_info *info, fxs_message *message);

/* The next `capacity` Gaussians or as many as are left; returns their number. */
size_t fxs_spz_read(fxs_spz *spz, fxs_gaussian *gaussians, size_t capacity);

/* Back to the first. */
void fxs_spz_rewind(fxs_spz *spz);

/* NULL is allowed. */
void fxs_spz_close(fxs_spz *spz);

#endif
