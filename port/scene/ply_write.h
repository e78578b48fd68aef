/* Writes Inria's .ply: binary, little-endian, all properties float, normals zero. */
#ifndef FXS_PLY_WRITE_H
#define FXS_PLY_WRITE_H

#include <stddef.h>
#include <stdint.h>

#include "../files/message.h"
#include "scene_file.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_ply_writer fxs_ply_writer;

/* Begins a file of exactly `count` Gaussians with SH up to `sh_degree`, 0 to 3; antialiased 1 says so in a comment.
   The file takes the name `path` when it is complete; until then it is beside it, under a temporary name.
   Returns 0 and a writer that fxs_ply_writer_close frees, or -1 and a message. */
int fxs_ply_writer_open(const char *path, uint64_t count, int sh_degree, int antialiased, fxs_ply_writer **writer,
                        fxs_message *message);

/* Writes the next n Gaussians. Returns 0, or -1 and a message. */
int fxs_ply_writer_put(fxs_ply_writer *writer, const fxs_gaussian *gaussians, size_t n, fxs_message *message);

/* Completes the file under its name and frees the writer; NULL is allowed. Returns 0; or -1 and a message where a write
   failed or Gaussians are missing: then nothing is left behind, and an earlier file of that name is as it was. */
int fxs_ply_writer_close(fxs_ply_writer *writer, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
