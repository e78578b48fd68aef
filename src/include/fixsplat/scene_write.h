/* Writes Gaussians to a scene file, in the format that the ending of its name says (formats.h lists them), or that the
 * options name. Functions return 0, or an error and a message. A writer is used by one thread at a time. */
#ifndef FXS_SCENE_WRITE_H
#define FXS_SCENE_WRITE_H

#include <stddef.h>
#include <stdint.h>

#include "gaussian.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_scene_writer fxs_scene_writer;

typedef struct fxs_scene_write_options {
    uint64_t count;              /* Gaussians that are to come: exactly as many */
    int sh_degree;               /* 0 to 3 */
    int antialiased;             /* 1: opacities were fitted with the dilation compensated */
    float low[3], high[3];       /* bounds of the centres, which a .glb says first; others need none */
    int spz_version;             /* of an .spz: 3 (gzip) or 4 (zstd); 0: 4 */
    const char *format;          /* a name of formats.h, as "ply"; null: by the ending of the path */
} fxs_scene_write_options;

/* How many Gaussians of an .spz had a value that the format cannot hold, by a step or more. One that is as good as flat
   is held. Logarithms of scales are clamped to -10 to 5.9375, dc to +-3.33, and SH to +-1 in steps of 1/128. */
typedef struct fxs_spz_clamped {
    uint32_t position, scale, dc, sh;
    double reach;                /* scene units: positions beyond it, on any axis, are brought to there, towards the
                                    origin */
} fxs_spz_clamped;

/* What the file does not say of what it was given. */
typedef struct fxs_scene_write_report {
    int lost_sh;                 /* the degree of the SH that are left out, or 0 */
    int lost_antialiased;        /* 1: it cannot say that the scene is anti-aliased */
    fxs_spz_clamped clamped;     /* all 0 where the format is another */
} fxs_scene_write_report;

/* Begins a file. A .ply is Inria's, binary, all properties floats, normals 0; a scene that is anti-aliased says so in a
   comment. A .glb has KHR_gaussian_splatting, floats. Until it is complete, it is beside `path`, under a temporary name (output.h). *writer is for
   fxs_scene_writer_close, and null after an error. What a writer holds until then: of a .ply, .splat, .glb or .csv
   nothing; of an .spz 44 bytes a Gaussian and one for each SH coefficient; of a .compressed.ply and .sog 56 bytes a Gaussian and 2 for each SH
   coefficient, and to close them up to as much again. Errors: FXS_ERR_ARGUMENT (ending, degree, count, version),
   FXS_ERR_UNSUPPORTED where this was built without a library that the format needs, FXS_ERR_FILE, FXS_ERR_MEMORY. */
int fxs_scene_writer_open(const char *path, const fxs_scene_write_options *options, fxs_scene_writer **writer,
                          fxs_message *message);

/* Adds the next n Gaussians, which fxs_drawable has accepted. Errors: FXS_ERR_FILE, and FXS_ERR_ARGUMENT where these
   are more than announced. */
int fxs_scene_writer_put(fxs_scene_writer *writer, const fxs_gaussian *gaussians, size_t n, fxs_message *message);

/* Completes the file under its name, fills in *report, which may be null, and frees the writer, which may be null. `progress` may be null.
   Errors: FXS_ERR_FILE where something could not be written, now or earlier, FXS_ERR_STOPPED by `progress`,
   FXS_ERR_ARGUMENT where Gaussians are missing, FXS_ERR_MEMORY. After an error nothing is left behind, and an
   earlier file of that name is as it was. */
int fxs_scene_writer_close(fxs_scene_writer *writer, fxs_scene_write_report *report, fxs_progress_fn *progress,
                           void *argument, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
