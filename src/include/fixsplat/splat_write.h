/* Writes .splat as antimatter15/splat reads it: 32 bytes a Gaussian, no SH above degree 0, no anti-aliasing flag.
 *
 * Functions return 0, or an error and a message. A writer is used by one thread at a time. */
#ifndef FXS_SPLAT_WRITE_H
#define FXS_SPLAT_WRITE_H

#include <stddef.h>
#include <stdint.h>

#include "fixsplat.h"
#include "scene_file.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_splat_writer fxs_splat_writer;

/* Begins a file of exactly `count` Gaussians. Until it is complete it is beside `path`, under a temporary name
   (output.h). *writer is for fxs_splat_writer_close, and null after an error. Errors: FXS_ERR_FILE, FXS_ERR_MEMORY. */
int fxs_splat_writer_open(const char *path, uint64_t count, fxs_splat_writer **writer, fxs_message *message);

/* Writes the next n Gaussians, which fxs_drawable has accepted. Colours and opacities are rounded to 1/255, colours are
   clamped to 0..1, and rotations are rounded to 1/128. Centres beyond +-2^27 units are brought in, as fxs_pack does.
   Errors: FXS_ERR_FILE, and FXS_ERR_ARGUMENT where these are more than announced. */
int fxs_splat_writer_put(fxs_splat_writer *writer, const fxs_gaussian *gaussians, size_t n, fxs_message *message);

/* Completes the file under its name and frees the writer, which may be null. Errors: FXS_ERR_FILE where something could
   not be written, now or earlier, and FXS_ERR_ARGUMENT where Gaussians are missing. After an error nothing is left
   behind, and an earlier file of that name is as it was. */
int fxs_splat_writer_close(fxs_splat_writer *writer, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
