/* Writes Inria's .ply: binary, little-endian, all properties float, normals zero.
 *
 * Functions return 0, or an error and a message. A writer is used by one thread at a time. */
#ifndef FXS_PLY_WRITE_H
#define FXS_PLY_WRITE_H

#include <stddef.h>
#include <stdint.h>

#include "fixsplat.h"
#include "scene_file.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_ply_writer fxs_ply_writer;

/* Begins a file of exactly `count` Gaussians with SH up to `sh_degree`, 0 to 3. Where `antialiased` is 1, a comment in
   the file says so. The file takes the name `path` when it is complete; until then it is beside it, under a temporary
   name (output.h). *writer is for fxs_ply_writer_close, and null after an error. Errors: FXS_ERR_ARGUMENT (the degree),
   FXS_ERR_FILE, FXS_ERR_MEMORY. */
int fxs_ply_writer_open(const char *path, uint64_t count, int sh_degree, int antialiased, fxs_ply_writer **writer,
                        fxs_message *message);

/* Writes the next n Gaussians. Errors: FXS_ERR_FILE, and FXS_ERR_ARGUMENT where these are more than announced. */
int fxs_ply_writer_put(fxs_ply_writer *writer, const fxs_gaussian *gaussians, size_t n, fxs_message *message);

/* Completes the file under its name and frees the writer, which may be null. Errors: FXS_ERR_FILE where something could
   not be written, now or earlier, and FXS_ERR_ARGUMENT where Gaussians are missing. After an error nothing is left
   behind, and an earlier file of that name is as it was. */
int fxs_ply_writer_close(fxs_ply_writer *writer, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
