/* Functions of the glTF reader that the 3D Tiles reader uses, in builds with FXS_WITH_CJSON. */
#ifndef FXS_GLTF_INTERNAL_H
#define FXS_GLTF_INTERNAL_H

#include "src/scene/formats_internal.h"

/* Opens a glTF file, even without Gaussians. The rows of `frame` map the file's axes (x right, y up, z back) to the
   Gaussians' axes. Does not register a function to free memory (fxs_import.drop). */
int fxs_gltf_open(void *reader, const fxs_scene_source *source, double frame[3][4], fxs_scene_file_info *info,
                  fxs_message *message);

/* Frees the decompressed data of a glTF reader that are not being read. Returns 0 if nothing was freed. */
int fxs_gltf_drop(void *reader);

#endif
