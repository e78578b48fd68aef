/* Where a reader's bytes come from: a file, memory or functions of the caller. */
#ifndef FXS_SOURCE_INTERNAL_H
#define FXS_SOURCE_INTERNAL_H

#include "scene_file.h"
#include "text_internal.h"

typedef struct fxs_scene_source fxs_scene_source;
struct fxs_scene_source {
    fxs_scene_input input;
    char *path;                       /* or name; for messages */
    const fxs_scene_source *first;    /* the one that this lies beside, or NULL */
    fxs_scene_file_options options;
};

/* These open a source whose options are set and the rest is 0. Each returns 0, or -1 and a message; close it also
   then. A path must be that of a regular file. */
int fxs_scene_source_open(fxs_scene_source *source, const char *path, fxs_message *message);
int fxs_scene_source_open_input(fxs_scene_source *source, const char *name, const fxs_scene_input *input,
                                fxs_message *message);

/* Opens, with the options of `source`, a file whose name is relative to its folder. */
int fxs_scene_source_open_beside(fxs_scene_source *opened, const fxs_scene_source *source, const char *name,
                                 fxs_message *message);

/* Bytes in memory; `data` is not copied. */
fxs_scene_input fxs_memory_input(const void *data, size_t size);

/* Reads the bytes at an offset, all of them. Returns 0, or -1 and a message. */
int fxs_scene_source_read(const fxs_scene_source *source, uint64_t offset, void *out, size_t size,
                          fxs_message *message);

/* Loads the bytes at an offset, at most FXS_TEXT_MAX; text->data is for fxs_release. Returns 0, or -1 and a message. */
int fxs_scene_source_load(const fxs_scene_source *source, uint64_t offset, uint64_t size, fxs_text *text,
                          fxs_message *message);

/* Tells the progress, 0 to 1. Returns 0, or -1 and a message where the caller wants to stop. */
int fxs_scene_source_progress(const fxs_scene_source *source, double done, fxs_message *message);

void fxs_scene_source_close(fxs_scene_source *source);

#endif
