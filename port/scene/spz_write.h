/* Writes .spz version 3 (gzip) or 4 (zstd). */
#ifndef FXS_SPZ_WRITE_H
#define FXS_SPZ_WRITE_H

#include <stddef.h>
#include <stdint.h>

#include "../files/message.h"
#include "../import/pack.h"
#include "scene_file.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_spz_writer fxs_spz_writer;

/* Begins a file of exactly `count` Gaussians with SH up to `sh_degree`, 0 to 3. They are held in memory, 44 bytes each
   and 3 for each SH coefficient, until the file is closed, which takes up to as much again for version 4. Returns 0 and
   a writer that fxs_spz_writer_close frees, or -1 and a message. */
int fxs_spz_writer_open(const char *path, int version, uint64_t count, int sh_degree, int antialiased,
                        fxs_spz_writer **writer, fxs_message *message);

/* Adds the next n Gaussians, in the axes of a .ply. What the format cannot hold is clamped: logarithms of scales to -10
   to 5.9375, dc to +-3.33, SH to +-1 in steps of 1/128 (all 8 bits,
   where the reference writer keeps 5 or 4). Returns 0, or -1 and a message. */
int fxs_spz_writer_put(fxs_spz_writer *writer, const fxs_gaussian *gaussians, size_t n, fxs_message *message);

/* Gaussians of a file with something that it cannot hold, by a step or more; a Gaussian that is as good as flat
   is held. */
typedef struct fxs_spz_clamped {
    uint32_t position, scale, dc, sh;
    double reach;             /* of positions, on each axis; those beyond are brought to there, towards the origin */
} fxs_spz_clamped;

/* Chooses the fractional bits of positions, which have 24 with their sign: as many as hold all, 24 at most. Where that
   is less than 12 (2048 units), the most up to 12 with which at most one in a hundred is beyond. To be called once all
   Gaussians are there, by fxs_spz_writer_close else. */
fxs_spz_clamped fxs_spz_writer_finish(fxs_spz_writer *writer);

/* Compresses and writes the file, under a temporary name first, and frees the writer; NULL is allowed. `progress` may
   be null. Returns 0; or -1 and a message where that failed or Gaussians are missing: then nothing is left behind, and
   an earlier file of that name is as it was. */
int fxs_spz_writer_close(fxs_spz_writer *writer, fxs_progress_fn *progress, void *argument, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
