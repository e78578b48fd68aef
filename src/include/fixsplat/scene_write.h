/* Writes a scene file in the format that the ending of its name says:
 *
 *     .ply             Inria's: as ply_write.h
 *     .compressed.ply  PlayCanvas's: 16 bytes a Gaussian and a byte for each SH coefficient, ordered in chunks
 *     .splat           as splat_write.h
 *     .spz             as spz_write.h
 *     .sog             PlayCanvas's, version 2: lossless WebP in a zip, ordered, with codebooks and a palette of SH
 *     .glb             binary glTF with KHR_gaussian_splatting, floats
 *     .csv             a line of text a Gaussian, behind one with the names that a .ply has for the columns
 *
 * Functions return 0, or an error and a message. A writer is used by one thread at a time. */
#ifndef FXS_SCENE_WRITE_H
#define FXS_SCENE_WRITE_H

#include "spz_write.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_scene_writer fxs_scene_writer;

typedef struct fxs_scene_write_options {
    uint64_t count;              /* Gaussians that are to come: exactly as many */
    int sh_degree;               /* 0 to 3 */
    int antialiased;             /* 1: opacities were fitted with the dilation compensated */
    float low[3], high[3];       /* bounds of the centres, which a .glb says first; others need none */
    int spz_version;             /* of an .spz; 0: 4 */
} fxs_scene_write_options;

/* What the file does not say of what it was given. */
typedef struct fxs_scene_write_report {
    int lost_sh;                 /* the degree of the SH that are left out, or 0 */
    int lost_antialiased;        /* 1: it cannot say that the scene is anti-aliased */
    fxs_spz_clamped clamped;     /* all 0 where the format is another */
} fxs_scene_write_report;

/* 1 where there is a format for the ending of this name. */
int fxs_scene_is_written(const char *path);

/* Begins a file. Until it is complete, it is beside `path`, under a temporary name (output.h). *writer is for
   fxs_scene_writer_close, and null after an error. What a writer holds until then: of a .ply, .splat, .glb or .csv
   nothing; of an .spz what spz_write.h says; of a .compressed.ply and .sog 56 bytes a Gaussian and 2 for each SH
   coefficient, and to close them up to as much again. Errors: FXS_ERR_ARGUMENT (ending, degree, count, version),
   FXS_ERR_UNSUPPORTED where this was built without a library that the format needs, FXS_ERR_FILE, FXS_ERR_MEMORY. */
int fxs_scene_writer_open(const char *path, const fxs_scene_write_options *options, fxs_scene_writer **writer,
                          fxs_message *message);

/* Adds the next n Gaussians, which fxs_drawable has accepted. Errors: FXS_ERR_FILE, and FXS_ERR_ARGUMENT where these
   are more than announced. */
int fxs_scene_writer_put(fxs_scene_writer *writer, const fxs_gaussian *gaussians, size_t n, fxs_message *message);

/* Completes the file under its name, fills in *report, and frees the writer, which may be null. `progress` may be null.
   Errors: FXS_ERR_FILE where something could not be written, now or earlier, FXS_ERR_STOPPED by `progress`,
   FXS_ERR_ARGUMENT where Gaussians are missing, FXS_ERR_MEMORY. After an error nothing is left behind, and an
   earlier file of that name is as it was. */
int fxs_scene_writer_close(fxs_scene_writer *writer, fxs_scene_write_report *report, fxs_progress_fn *progress,
                           void *argument, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
