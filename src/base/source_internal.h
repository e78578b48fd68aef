/* Sources of a scene's bytes: a file, memory or a program's callbacks. Functions with a message return 0, or an error
   and the message. */
#ifndef FXS_SOURCE_INTERNAL_H
#define FXS_SOURCE_INTERNAL_H

#include <fixsplat/internal/sound.h>
#include "text_internal.h"

typedef struct fxs_import {
    uint64_t file_bytes;              /* size in bytes of all files of the scene, each counted once */
    uint64_t *files;                  /* hash set of the keys of counted files; 0: free slot */
    size_t file_count, room;
    uint64_t held;
    int (*drop)(void *reader);        /* frees data that can be read again; returns 0 if none is left */
    /* Reads the sound as fxs_scene_file_sound does; null: the format has none. */
    int (*sound)(void *reader, fxs_sound *sound, fxs_text *data, fxs_message *message);
    void *reader;
    double origin[3];
    int moves;
} fxs_import;

typedef struct fxs_scene_source fxs_scene_source;
struct fxs_scene_source {
    fxs_scene_input input;
    char *path;
    const fxs_scene_source *first;    /* main file of the scene if this is a companion file, else null */
    fxs_scene_file_options options;
    fxs_import *import;
    uint64_t device, inode;
};

/* Open a source of a scene's bytes. The caller sets source->options and clears all other fields before. Close the
   source even after an error. */
int fxs_scene_source_open(fxs_scene_source *source, const char *path, fxs_message *message);
int fxs_scene_source_open_input(fxs_scene_source *source, const char *name, const fxs_scene_input *input,
                                fxs_message *message);

/* Opens a companion file by a name relative to the folder of `source`. The name must pass fxs_check_name, and the
   resolved path must lie in the folder of the scene's main file. A backslash separates folders unless a file has
   exactly this name. */
int fxs_scene_source_open_beside(fxs_scene_source *opened, const fxs_scene_source *source, const char *name,
                                 fxs_message *message);

/* Adds a file's size to the total size of the scene, unless the file was counted before. */
int fxs_import_count(const fxs_scene_source *source, fxs_message *message);

/* Returns 1 if a file name cannot lead out of its folder. Forbidden are an empty name, "..", a leading slash, a drive,
   a URL scheme and control characters. Backslashes count as slashes, and %XX is decoded. read.js checks names in the
   same way. */
int fxs_name_stays(const char *name);

int fxs_check_name(const fxs_scene_source *source, const char *name, fxs_message *message);

/* Compares file names; "a/b", "a//b" and "./a/b" are equal. */
int fxs_compare_names(const char *a, const char *b);

/* Decodes escapes %XX of a URI in place. */
void fxs_decode_percent(char *text);

/* Returns 1 if a companion file in the folder of `source` exists, 0 if not, or an error. */
int fxs_scene_source_is_beside(const fxs_scene_source *source, const char *name, fxs_message *message);

fxs_scene_input fxs_memory_input(const void *data, size_t size);

int fxs_scene_source_read(const fxs_scene_source *source, uint64_t offset, void *out, size_t size,
                          fxs_message *message);

int fxs_scene_source_load(const fxs_scene_source *source, uint64_t offset, uint64_t size, fxs_text *text,
                          fxs_message *message);
void fxs_text_let_go(const fxs_scene_source *source, fxs_text *text);

/* Reports the finished share of the work, 0 to 1. Returns an error if the caller cancels. */
int fxs_scene_source_progress(const fxs_scene_source *source, double done, fxs_message *message);

void fxs_scene_source_shut(fxs_scene_source *source);

void fxs_scene_source_close(fxs_scene_source *source);

int fxs_limit_gaussians(const fxs_scene_source *source, uint64_t count, fxs_message *message);

/* Checks that `bytes` more may be allocated within the memory limit of the reader's options. May free data to make
   room. */
int fxs_limit_memory(const fxs_scene_source *source, uint64_t bytes, fxs_message *message);

/* Allocates a block that counts against the memory limit until fxs_let_go. Returns null and a message on failure. */
void *fxs_hold(const fxs_scene_source *source, uint64_t bytes, fxs_message *message);
void fxs_let_go(const fxs_scene_source *source, void *block, uint64_t bytes);

#endif
