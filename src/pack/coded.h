/* Packs a scene with attributes that are already quantised, such as the result of a fit. A chunk is 256 Gaussians. */
#ifndef FXS_CODED_H
#define FXS_CODED_H

#include "encode.h"
#include <fixsplat/pack.h>

typedef struct fxs_coded {
    const fxs_chunk *chunks;           /* chunk headers, one per FXS_CHUNK (256) Gaussians */
    const fxs_palette *palette;        /* palette of SH vectors; null if the file profile has no palette */
    /* Writes the codes (quantised attributes) of Gaussian `index` to `record`, SH codes last. Called from several
       threads. */
    void (*record)(const void *argument, uint32_t index, unsigned char record[FXS_RECORD_BYTES]);
    const void *argument;
} fxs_coded;

/* Packs a scene like fxs_pack, but takes the quantised attributes from `coded`. The file is still read for the scene's
   header. The report has no losses. A null `coded` gives fxs_pack. */
int fxs_pack_coded(fxs_scene_file *file, const fxs_scene_file_info *info, const fxs_coded *coded,
                   fxs_packed_scene *scene, fxs_pack_report *report, const fxs_pack_options *options,
                   fxs_message *message);

/* Packs a scene like fxs_pack_coded, but holds at most `held` chunks in memory, at least 1. These chunks wait until
   their SH coefficients are coded with the palette. The file is read again for every `held` chunks. */
int fxs_pack_held(fxs_scene_file *file, const fxs_scene_file_info *info, const fxs_coded *coded, uint32_t held,
                  fxs_packed_scene *scene, fxs_pack_report *report, const fxs_pack_options *options,
                  fxs_message *message);

#endif
