/* Functions of the glTF reader that the 3D Tiles reader and the mesh reader use. */
#ifndef FXS_GLTF_INTERNAL_H
#define FXS_GLTF_INTERNAL_H

#include "src/scene/formats_internal.h"

/* Takes the vertices and triangles of meshes. Triangles number the vertices in the order of the calls. */
typedef struct fxs_triangle_sink {
    int (*vertex)(void *argument, const double at[3], fxs_message *message);
    int (*triangle)(void *argument, const uint32_t corners[3], fxs_message *message);
    void *argument;
} fxs_triangle_sink;

/* Reads the triangles of all meshes in a glTF's scene, placed by their nodes, in the file's axes. Skins and morph
   targets are not applied. */
int fxs_gltf_triangles(const fxs_scene_source *source, const fxs_triangle_sink *sink, fxs_message *message);

/* ---- In builds with FXS_WITH_CJSON ---- */

/* Opens a glTF file, even without Gaussians. The rows of `frame` map the file's axes (x right, y up, z back) to the
   Gaussians' axes. Does not register a function to free memory (fxs_import.drop). */
int fxs_gltf_open(void *reader, const fxs_scene_source *source, double frame[3][4], fxs_scene_file_info *info,
                  fxs_message *message);

/* Frees the decompressed data of a glTF reader that are not being read. Returns 0 if nothing was freed. */
int fxs_gltf_drop(void *reader);

#endif
