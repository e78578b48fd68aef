/* Reads an .spz in a file of its own or in a bufferView of a glTF. */
#ifndef FXS_SPZ_INTERNAL_H
#define FXS_SPZ_INTERNAL_H

#include <fixsplat/gaussian.h>

#include "src/base/source_internal.h"

#define FXS_SPZ_MAGIC 0x5053474eu   /* "NGSP" */
enum { FXS_SPZ_MAX_COUNT = 1 << 30 };

/* The arrays of a payload, in their order. */
enum {
    FXS_SPZ_POSITION, FXS_SPZ_ALPHA, FXS_SPZ_COLOUR, FXS_SPZ_SCALE, FXS_SPZ_ROTATION, FXS_SPZ_SH, FXS_SPZ_ARRAYS
};

/* Sets the bytes that a Gaussian has in each array. */
void fxs_spz_strides(uint8_t stride[FXS_SPZ_ARRAYS], uint32_t version, int sh_degree);

/* For SH of degrees 1 to 3: bits 0, 1, 2 where the function is odd in x, y, z. */
extern const uint8_t fxs_spz_odd_in[15];

typedef struct fxs_spz fxs_spz;

/* Reads and checks the header of an .spz at an offset of a source, which outlives it. The Gaussians are in the axes of
   a .ply (right, down, front); with FXS_AXES_RDF they are as stored. Returns 0, an .spz for fxs_spz_close, and *info
   without its format; or an error and a message. */
int fxs_spz_open(const fxs_scene_source *source, uint64_t offset, uint64_t size, enum fxs_axes axes, fxs_spz **spz,
                 fxs_scene_file_info *info, fxs_message *message);

/* Reads the next `capacity` Gaussians, or as many as are left. The first call decompresses and checks all data, and
   keeps them until the .spz is closed or dropped. Returns the number of Gaussians, or an error and a message. */
long fxs_spz_read(fxs_spz *spz, fxs_gaussian *gaussians, size_t capacity, fxs_message *message);

/* Frees the decompressed data, which the next read decompresses again. Returns 0 where there are none. */
int fxs_spz_drop(fxs_spz *spz);

/* Goes back to the first Gaussian. */
void fxs_spz_rewind(fxs_spz *spz);

/* NULL is allowed. */
void fxs_spz_close(fxs_spz *spz);

#endif
