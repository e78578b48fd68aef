/* Writes Gaussians to a scene file, in a format of formats.h: given in the options, or found from the file's ending.
 * Functions return 0, or an error and a message. One thread at a time may use a writer.
 *
 * Stable from version 1.0 on. */
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
    uint64_t count;              /* exact number of Gaussians that will be written */
    int sh_degree;               /* 0 to 3 */
    int antialiased;             /* 1: opacities were fitted with compensation for the renderer's dilation */
    float low[3], high[3];       /* bounds of the centres, for the header of a .glb; unused by other formats */
    int spz_version;             /* version of an .spz: 3 (gzip) or 4 (zstd); 0: 4 */
    const char *format;          /* a name of formats.h, such as "ply"; null: by the path's ending */
    int spz_fine;                /* 1: an .spz gets SH in 8 bits instead of 5 and 4, and positions in all 24 bits */
    double origin[3];            /* origin of the stream (fxs_scene_file_info), added to each position and to the
                                    bounds */
} fxs_scene_write_options;

/* Numbers of Gaussians in an .spz with a value that was clamped by at least a step of the format. Axes too thin to be
   seen do not count. ln(scale) is clamped to -10 to 5.9375, dc to +-3.33, and SH to +-1 in steps of 1/128. */
typedef struct fxs_spz_clamped {
    uint32_t position, scale, dc, sh;
    double reach;                /* scene units: a coordinate beyond +-reach is moved to +-reach */
} fxs_spz_clamped;

/* Losses in the written file. */
typedef struct fxs_scene_write_report {
    int lost_sh;                 /* highest SH degree that was dropped, or 0 */
    int lost_antialiased;        /* 1: the scene is anti-aliased, but the format cannot record it */
    fxs_spz_clamped clamped;     /* all 0 for formats other than .spz */
    double moved;                /* scene units: largest distance that positions moved when rounded to floats far from
                                    0; 0 if `origin` is 0, and for formats that can store the positions */
} fxs_scene_write_report;

/* Begins a file. A .ply is binary, with Inria's properties as floats and normals of 0; a comment marks an anti-aliased
   scene. A .glb has KHR_gaussian_splatting with floats. If options->origin is not 0, a .ply has x, y and z as doubles,
   a .glb a translated node, and a .csv more digits; other formats get the nearest floats.

   Until it is complete, the file has a temporary name next to `path` (output.h). fxs_scene_writer_close frees *writer,
   which is null after an error. A lod-meta.json creates folders next to it, 0_0 and so on; after an error, their new
   content is removed.

   Memory of a writer:
   - .ply, .splat, .glb, .csv: holds no Gaussians.
   - .spz: 44 bytes a Gaussian and 1 byte for each SH coefficient.
   - .compressed.ply, .sog: 56 bytes a Gaussian and 2 bytes for each SH coefficient; while closing up to twice that.
   - .rad, lod-meta.json: as .sog; while closing up to four times as much.
   Errors: FXS_ERR_ARGUMENT (ending, degree, count, version), FXS_ERR_UNSUPPORTED if fixsplat was built without a
   library that the format needs, FXS_ERR_FILE, FXS_ERR_MEMORY. */
FXS_API int fxs_scene_writer_open(const char *path, const fxs_scene_write_options *options, fxs_scene_writer **writer,
                                  fxs_message *message);

/* Adds the next n Gaussians; fxs_drawable must have accepted each. Errors: FXS_ERR_FILE, and FXS_ERR_ARGUMENT for more
   Gaussians than announced. */
FXS_API int fxs_scene_writer_put(fxs_scene_writer *writer, const fxs_gaussian *gaussians, size_t n,
                                 fxs_message *message);

/* Completes the file under its name, fills in *report and frees the writer. `writer`, `report` and `progress` may be
   null. Errors: FXS_ERR_FILE if a write failed, now or earlier, FXS_ERR_STOPPED by `progress`, FXS_ERR_ARGUMENT if
   Gaussians are missing, FXS_ERR_MEMORY. After an error the new file is removed, and an existing file of that name is
   unchanged. */
FXS_API int fxs_scene_writer_close(fxs_scene_writer *writer, fxs_scene_write_report *report, fxs_progress_fn *progress,
                                   void *argument, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
