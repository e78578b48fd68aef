/* Further functions of the reader of glTF, for tilesets of such files. With cJSON (FXS_WITH_CJSON). */
#ifndef FXS_GLTF_INTERNAL_H
#define FXS_GLTF_INTERNAL_H

#include "src/scene/formats_internal.h"

/* Opens a file as fxs_read_gltf does, with these differences: the rows map the axes of the file (x right, y up, z back)
   to those of the Gaussians; a scene without Gaussians is opened too; another reader sets `drop` of fxs_import. */
int fxs_gltf_open(void *reader, const fxs_scene_source *source, double frame[3][4], fxs_scene_file_info *info,
                  fxs_message *message);

/* Frees decompressed data that are not being read. Returns 0 where there are none. */
int fxs_gltf_drop(void *reader);

#endif
