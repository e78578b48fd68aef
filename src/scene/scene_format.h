/* What a scene format provides to scene_file.c. */
#ifndef FXS_SCENE_FORMAT_H
#define FXS_SCENE_FORMAT_H

#include "src/base/source_internal.h"

typedef struct fxs_scene_format {
    const char *name;
    size_t reader_size;   /* bytes */
    /* Is given a reader that is all 0 and a source that outlives it. Returns 0 with *info filled in, but for its
       format, for its levels where there is one, and for its stored SH degree where that is its SH degree; or an error
       and a message. Either way, close is called. */
    int (*open)(void *reader, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message);
    long (*read)(void *reader, fxs_gaussian *gaussians, size_t capacity, fxs_message *message);
    int (*rewind)(void *reader, fxs_message *message);
    void (*close)(void *reader);   /* frees what the reader holds; NULL: nothing */
} fxs_scene_format;

extern const fxs_scene_format fxs_scene_ply, fxs_scene_compressed_ply, fxs_scene_ksplat, fxs_scene_lcc, fxs_scene_sog,
                              fxs_scene_splat, fxs_scene_spz, fxs_scene_gltf, fxs_scene_tileset, fxs_scene_gaussians;

/* Finds the format of a file by its first bytes. Returns 0, or an error and a message. */
int fxs_scene_format_of(const fxs_scene_source *source, const fxs_scene_format **format, fxs_message *message);

/* Swaps the reader of an open file for another, and the format whose functions read from it. */
void fxs_scene_file_swap(fxs_scene_file *file, const fxs_scene_format **format, void **reader);

/* What readers are from. */
const fxs_allocator *fxs_scene_file_allocator(const fxs_scene_file *file);

/* Whether a file that begins with "ply" is PlayCanvas's compressed one: 1 or 0, or an error and a message. */
int fxs_is_compressed_ply(const fxs_scene_source *source, fxs_message *message);

/* Whether a file without a magic number can be a .splat: whole records, the first of them plausible. */
int fxs_is_splat(const fxs_scene_source *source);

#endif
