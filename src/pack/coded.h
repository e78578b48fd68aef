/* A scene that is coded already, as a fit has it, to be packed: in the order of its chunks, with their headers, its
 * palette and the codes of each Gaussian. */
#ifndef FXS_CODED_H
#define FXS_CODED_H

#include "encode.h"
#include <fixsplat/pack.h>

typedef struct fxs_coded {
    const fxs_chunk *chunks;           /* of each FXS_CHUNK Gaussians */
    const fxs_palette *palette;        /* null where the profile has none */
    /* Writes the codes of a Gaussian one after the other, those of SH last. Called from several threads. */
    void (*record)(const void *argument, uint32_t index, unsigned char record[FXS_RECORD_BYTES]);
    const void *argument;
} fxs_coded;

/* As fxs_pack, of a file whose Gaussians are what the codes say; it is read for what a scene's header says of them. The
   report has no losses. `coded` may be null: then it is fxs_pack. */
int fxs_pack_coded(fxs_scene_file *file, const fxs_scene_file_info *info, const fxs_coded *coded,
                   fxs_packed_scene *scene, fxs_pack_report *report, const fxs_pack_options *options,
                   fxs_message *message);

#endif
