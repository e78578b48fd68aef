/* Reads .spz data from a file or from a buffer of a glTF file. */
#ifndef FXS_SPZ_INTERNAL_H
#define FXS_SPZ_INTERNAL_H

#include <fixsplat/scene.h>

#include "src/base/source_internal.h"

#define FXS_SPZ_MAGIC 0x5053474eu
enum { FXS_SPZ_MAX_COUNT = 1 << 30 };

/* Arrays of attributes in an .spz file, in file order. */
enum {
    FXS_SPZ_POSITION, FXS_SPZ_ALPHA, FXS_SPZ_COLOUR, FXS_SPZ_SCALE, FXS_SPZ_ROTATION, FXS_SPZ_SH, FXS_SPZ_ARRAYS
};

/* Computes the bytes per Gaussian of each array in an .spz. */
void fxs_spz_strides(uint8_t stride[FXS_SPZ_ARRAYS], uint32_t version, int sh_degree);

/* Symmetry of the 15 SH functions of degrees 1 to 3. Bits 0, 1, 2 are set if the function is odd in x, y, z. */
extern const uint8_t fxs_spz_odd_in[15];

typedef struct fxs_spz fxs_spz;

/* Opens an .spz; `source` must stay open for as long. The Gaussians have the axes of a .ply (right, down, front).
   Returns 0 and *info without its format, or an error and a message. */
int fxs_spz_open(const fxs_scene_source *source, uint64_t offset, uint64_t size, enum fxs_axes axes, fxs_spz **spz,
                 fxs_scene_file_info *info, fxs_message *message);

/* Reads up to `capacity` of the remaining Gaussians of an .spz. The first call decompresses all data. Returns the
   number of Gaussians, or an error and a message. */
long fxs_spz_read(fxs_spz *spz, fxs_gaussian *gaussians, size_t capacity, fxs_message *message);

/* Frees the decompressed data of an .spz until the next read. Returns 0 if nothing was freed. */
int fxs_spz_drop(fxs_spz *spz);

void fxs_spz_rewind(fxs_spz *spz);

void fxs_spz_close(fxs_spz *spz);

#endif
