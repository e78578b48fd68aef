/* .spz in memory: a file of its own, or a bufferView of a glTF. */
#ifndef FXS_SPZ_INTERNAL_H
#define FXS_SPZ_INTERNAL_H

#include "scene_file.h"

#define FXS_SPZ_MAGIC 0x5053474eu   /* "NGSP" */
enum { FXS_SPZ_MAX_COUNT = 1 << 30 };

/* The arrays of a payload, in their order. */
enum {
    FXS_SPZ_POSITION, FXS_SPZ_ALPHA, FXS_SPZ_COLOUR, FXS_SPZ_SCALE, FXS_SPZ_ROTATION, FXS_SPZ_SH, FXS_SPZ_ARRAYS
};

/* Sets the bytes a Gaussian of each. */
void fxs_spz_strides(uint8_t stride[FXS_SPZ_ARRAYS], uint32_t version, int sh_degree);

/* Of the SH of degrees 1 to 3: bits 0, 1, 2 where odd in x, y, z. */
extern const uint8_t fxs_spz_odd_in[15];

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
