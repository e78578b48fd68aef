/* Packs a scene that is already coded, such as a fit's result. Its Gaussians are in chunk order, with chunk headers,
 * the palette, and the codes of each Gaussian. */
#ifndef FXS_CODED_H
#define FXS_CODED_H

#include "encode.h"
#include <fixsplat/pack.h>

typedef struct fxs_coded {
    const fxs_chunk *chunks;           /* one per FXS_CHUNK Gaussians */
    const fxs_palette *palette;        /* null: the profile has no palette */
    /* Writes the record of Gaussian `index`: its codes, SH codes last. Called from several threads. */
    void (*record)(const void *argument, uint32_t index, unsigned char record[FXS_RECORD_BYTES]);
    const void *argument;
} fxs_coded;

/* Like fxs_pack, but the codes come from `coded`. The file is still read, for the scene's header. The report has no
   losses. If `coded` is null, this is fxs_pack. */
int fxs_pack_coded(fxs_scene_file *file, const fxs_scene_file_info *info, const fxs_coded *coded,
                   fxs_packed_scene *scene, fxs_pack_report *report, const fxs_pack_options *options,
                   fxs_message *message);

/* As fxs_pack_coded, with a limit on memory: at most `held` chunks, at least 1, wait for SH codes of a palette at
   once. A scene with more chunks is read once more for every `held` chunks. The packed scene does not depend on
   `held`. */
int fxs_pack_held(fxs_scene_file *file, const fxs_scene_file_info *info, const fxs_coded *coded, uint32_t held,
                  fxs_packed_scene *scene, fxs_pack_report *report, const fxs_pack_options *options,
                  fxs_message *message);

#endif
