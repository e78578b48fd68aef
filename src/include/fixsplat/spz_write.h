/* Writes .spz version 3 (gzip) or 4 (zstd).
 *
 * Functions return 0, or an error and a message. A writer is used by one thread at a time. */
#ifndef FXS_SPZ_WRITE_H
#define FXS_SPZ_WRITE_H

#include <stddef.h>
#include <stdint.h>

#include "fixsplat.h"
#include "scene_file.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_spz_writer fxs_spz_writer;

/* Begins a file of exactly `count` Gaussians with SH up to `sh_degree`, 0 to 3. They are held in memory until the file
   is closed: 44 bytes each, and 3 for each SH coefficient. To close a file of version 4 takes up to as much again.
   *writer is for fxs_spz_writer_close, and null after an error. Errors: FXS_ERR_ARGUMENT (version, degree, count),
   FXS_ERR_UNSUPPORTED where this was built without the library of that version, FXS_ERR_FILE, FXS_ERR_MEMORY. */
int fxs_spz_writer_open(const char *path, int version, uint64_t count, int sh_degree, int antialiased,
                        fxs_spz_writer **writer, fxs_message *message);

/* Adds the next n Gaussians, in the axes of a .ply. What the format cannot hold is clamped: logarithms of scales to -10
   to 5.9375, dc to +-3.33, and SH to +-1 in steps of 1/128 (all 8 bits, where the reference writer keeps 5 or 4).
   Errors: FXS_ERR_ARGUMENT where these are more than announced. */
int fxs_spz_writer_put(fxs_spz_writer *writer, const fxs_gaussian *gaussians, size_t n, fxs_message *message);

/* How many Gaussians had something that the file cannot hold, by a step or more. One that is as good as flat is held.
   */
typedef struct fxs_spz_clamped {
    uint32_t position, scale, dc, sh; double reach; /* scene units: positions beyond it, on any axis, are brought to
    there, towards the origin */
} fxs_spz_clamped;

/* Chooses the fractional bits of positions, which have 24 bits with their sign: as many as hold all, 24 at most. Where
   that is less than 12 (2048 units), it is the most up to 12 with which at most one in a hundred is beyond. It is to be
   called once all Gaussians are there; fxs_spz_writer_close calls it where the program has not. */
fxs_spz_clamped fxs_spz_writer_finish(fxs_spz_writer *writer);

/* Compresses and writes the file, under a temporary name first (output.h), and frees the writer, which may be null.
   `progress` may be null. Errors: FXS_ERR_FILE where something could not be written, FXS_ERR_STOPPED by `progress`,
   FXS_ERR_ARGUMENT where Gaussians are missing, FXS_ERR_MEMORY. After an error nothing is left behind, and an earlier
   file of that name is as it was. */
int fxs_spz_writer_close(fxs_spz_writer *writer, fxs_progress_fn *progress, void *argument, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
