/* Packs a scene that is already coded, such as that of a fit: its Gaussians are in the order of the chunks, with the
 * headers of the chunks, the palette and the codes of each Gaussian. */
#ifndef FXS_CODED_H
#define FXS_CODED_H

#include "encode.h"
#include <fixsplat/pack.h>

typedef struct fxs_coded {
    const fxs_chunk *chunks;           /* one for each FXS_CHUNK Gaussians */
    const fxs_palette *palette;        /* null: the profile has none */
    /* Writes the codes of a Gaussian one after the other, SH codes last. Called from several threads. */
    void (*record)(const void *argument, uint32_t index, unsigned char record[FXS_RECORD_BYTES]);
    const void *argument;
} fxs_coded;

/* The same as fxs_pack for a file whose Gaussians have exactly these codes; it is read only for the numbers in the
   scene's header. The report has no losses. With a null `coded`, this is fxs_pack. */
int fxs_pack_coded(fxs_scene_file *file, const fxs_scene_file_info *info, const fxs_coded *coded,
                   fxs_packed_scene *scene, fxs_pack_report *report, const fxs_pack_options *options,
                   fxs_message *message);

/* The same. SH that are coded by a palette wait for their codes with those of `held` chunks, at least 1; where a scene
   has more, the file is read once more for every `held` of them. The packed scene is the same. */
int fxs_pack_held(fxs_scene_file *file, const fxs_scene_file_info *info, const fxs_coded *coded, uint32_t held,
                  fxs_packed_scene *scene, fxs_pack_report *report, const fxs_pack_options *options,
                  fxs_message *message);

#endif
