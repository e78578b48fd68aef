/* What a scene format provides to scene_file.c. */
#ifndef FXS_SCENE_FORMAT_H
#define FXS_SCENE_FORMAT_H

#include <stdio.h>

#include "scene_file.h"

/* An open regular file; outlives the reader that is given it. */
typedef struct fxs_scene_source {
    FILE *stream;    /* at the first byte, unbuffered */
    char *path;
    uint64_t size;   /* bytes */
    int level;       /* of detail, 0 the finest; a format that has only this one may ignore it */
} fxs_scene_source;

/* Opens a regular file. Returns 0, or -1 and a message; close it also then. */
int fxs_scene_source_open(fxs_scene_source *source, const char *path, fxs_message *message);

/* Reads the bytes at an offset, all of them. Returns 0, or -1 and a message. */
int fxs_scene_source_read(const fxs_scene_source *source, uint64_t offset, void *out, size_t size,
                          fxs_message *message);

void fxs_scene_source_close(fxs_scene_source *source);

typedef struct fxs_scene_format {
    const char *name;
    /* Returns 0 with *reader for the other functions and *info filled in, but for its format, and but for its levels
       where there is one; or -1 and a message. Either way, close is called where *reader was set. */
    int (*open)(const fxs_scene_source *source, void **reader, fxs_scene_file_info *info, fxs_message *message);
    long (*read)(void *reader, fxs_gaussian *gaussians, size_t capacity, fxs_message *message);
    int (*rewind)(void *reader, fxs_message *message);
    void (*close)(void *reader);
} fxs_scene_format;

extern const fxs_scene_format fxs_scene_ply, fxs_scene_compressed_ply, fxs_scene_ksplat, fxs_scene_sog, fxs_scene_splat,
                              fxs_scene_spz, fxs_scene_gltf;

/* Swaps the reader of an open file for another, and the format whose functions read from it. */
void fxs_scene_file_swap(fxs_scene_file *file, const fxs_scene_format **format, void **reader);

/* Whether a file that begins with "ply" is PlayCanvas's compressed one. */
int fxs_is_compressed_ply(const fxs_scene_source *source);

/* Whether a file without a magic number can be a .splat: whole records, the first of them plausible. */
int fxs_is_splat(const fxs_scene_source *source);

#endif
