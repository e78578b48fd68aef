/* What else the reader of glTF can do, for a tileset of such files. With cJSON (FXS_WITH_CJSON). */
#ifndef FXS_GLTF_INTERNAL_H
#define FXS_GLTF_INTERNAL_H

#include "src/scene/formats_internal.h"

/* As fxs_scene_gltf opens, but: what is read comes in a frame to which these rows map the file's own (x right, y up, z
   back); a scene without Gaussians is opened too; and another reader answers for the import's memory. */
int fxs_gltf_open(void *reader, const fxs_scene_source *source, double frame[3][4], fxs_scene_file_info *info,
                  fxs_message *message);

/* Lets go of something that was decompressed and is not being read. Returns 0 where there is nothing. */
int fxs_gltf_drop(void *reader);

#endif
