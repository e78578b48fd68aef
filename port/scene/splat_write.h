/* Writes .splat as antimatter15/splat reads it: 32 bytes a Gaussian, no SH above degree 0, no anti-aliasing flag. */
#ifndef FXS_SPLAT_WRITE_H
#define FXS_SPLAT_WRITE_H

#include <stddef.h>
#include <stdint.h>

#include "../files/message.h"
#include "scene_file.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_splat_writer fxs_splat_writer;

/* Begins a file of exactly `count` Gaussians; until it is complete it is beside `path`, under a temporary name. Returns
   0 and a writer that fxs_splat_writer_close frees, or -1 and a message. */
int fxs_splat_writer_open(const char *path, uint64_t count, fxs_splat_writer **writer, fxs_message *message);

/* Writes the next n Gaussians, all of them drawable (fxs_drawable). Colours and opacities are rounded to 1/255, colours
   clamped to 0..1, rotations rounded to 1/128; centres from beyond +-2^27 units are brought in, as fxs_pack does.
   Returns 0, or -1 and a message. */
int fxs_splat_writer_put(fxs_splat_writer *writer, const fxs_gaussian *gaussians, size_t n, fxs_message *message);

/* Completes the file under its name and frees the writer; NULL is allowed. Returns 0; or -1 and a message where a write
   failed or Gaussians are missing: then nothing is left behind, and an earlier file of that name is as it was. */
int fxs_splat_writer_close(fxs_splat_writer *writer, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
