/* Scene files: a stream of Gaussians in the file's order, whatever the format. */
#ifndef FXS_SCENE_FILE_H
#define FXS_SCENE_FILE_H

#include <stddef.h>
#include <stdint.h>

#include "message.h"

/* One Gaussian as an Inria .ply means it, before any quantisation. */
typedef struct fxs_gaussian {
    float position[3];   /* scene units */
    float scale[3];      /* natural logarithm of the standard deviation, scene units */
    float rotation[4];   /* quaternion w, x, y, z; as in the file, not normalised */
    float opacity;       /* logit: the opacity is 1 / (1 + exp(-opacity)) */
    float dc[3];         /* SH degree 0, r g b; the colour is 0.5 + 0.28209479177387814 dc + higher degrees */
    float sh[45];        /* degrees 1 to 3, coefficient-major: sh[3 * k + channel]; 0 above the file's degree */
} fxs_gaussian;

typedef struct fxs_scene_file fxs_scene_file;

typedef struct fxs_scene_file_info {
    const char *format;   /* "ply", "compressed ply", "ksplat", "sog", "splat", "spz", "gltf"; static */
    uint64_t count;       /* Gaussians in the file */
    int sh_degree;        /* 0 to 3 */
    int antialiased;      /* 1: opacities were fitted with the dilation compensated */
    int levels;           /* of detail that can be opened; 1 but for streamed SOG */
} fxs_scene_file_info;

/* Opens a scene file, or a folder with the meta.json or lod-meta.json of a .sog; the format is told by its content.
   Returns 0 and a handle that fxs_scene_file_close frees, or -1 and a message. The header is checked whole, and the
   size of a binary body against it. */
int fxs_scene_file_open(const char *path, fxs_scene_file **file, fxs_scene_file_info *info, fxs_message *message);

/* The same at a level of detail, 0 the finest, where the file has several (streamed SOG). */
int fxs_scene_file_open_lod(const char *path, int level, fxs_scene_file **file, fxs_scene_file_info *info,
                            fxs_message *message);

/* Reads the next `capacity` Gaussians or as many as are left. Returns their number, 0 at the end, or -1 and a
   message. */
long fxs_scene_file_read(fxs_scene_file *file, fxs_gaussian *gaussians, size_t capacity, fxs_message *message);

/* Back to the first Gaussian. Returns 0, or -1 and a message. */
int fxs_scene_file_rewind(fxs_scene_file *file, fxs_message *message);

/* Frees the handle; NULL is allowed. */
void fxs_scene_file_close(fxs_scene_file *file);

#endif
