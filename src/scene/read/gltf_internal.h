/* Functions of the glTF reader for tilesets of glTF files. Available with cJSON (FXS_WITH_CJSON). */
#ifndef FXS_GLTF_INTERNAL_H
#define FXS_GLTF_INTERNAL_H

#include "src/scene/formats_internal.h"

/* Like open of fxs_read_gltf, with these differences: the rows of `frame` map the axes of the file (x right, y up, z
   back) to the Gaussians' axes; a scene without Gaussians can be opened; fxs_import.drop is left to the caller. */
int fxs_gltf_open(void *reader, const fxs_scene_source *source, double frame[3][4], fxs_scene_file_info *info,
                  fxs_message *message);

/* Frees decompressed data not being read. Returns 0 if nothing was freed. */
int fxs_gltf_drop(void *reader);

#endif
