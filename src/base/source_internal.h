/* Where a reader's bytes come from: a file, memory or functions of the caller. */
#ifndef FXS_SOURCE_INTERNAL_H
#define FXS_SOURCE_INTERNAL_H

#include <fixsplat/input.h>
#include "text_internal.h"

/* What the sources of one scene take together, to be held against the limits of the options. */
typedef struct fxs_import {
    uint64_t file_bytes;              /* of all its files, as far as they are known; each counts once */
    uint64_t *files;                  /* which they are: a hash table of `room` places, a power of two; 0: free */
    size_t file_count, room;
    uint64_t held;                    /* bytes, by fxs_hold */
    int (*drop)(void *reader);        /* lets go of something that can be had again: 1, or 0 where there is nothing */
    void *reader;
} fxs_import;

typedef struct fxs_scene_source fxs_scene_source;
struct fxs_scene_source {
    fxs_scene_input input;
    char *path;                       /* or name; for messages */
    const fxs_scene_source *first;    /* the one that this lies beside, or NULL */
    fxs_scene_file_options options;
    fxs_import *import;               /* NULL: without limits */
    uint64_t device, inode;           /* of a file that was opened by its path; else 0 */
};

/* These open a source whose options are set and the rest is 0. Each returns 0, or an error and a message; close it also
   then. A path must be that of a regular file. */
int fxs_scene_source_open(fxs_scene_source *source, const char *path, fxs_message *message);
int fxs_scene_source_open_input(fxs_scene_source *source, const char *name, const fxs_scene_input *input,
                                fxs_message *message);

/* Opens, with the options and limits of `source`, a file whose name is relative to its folder. Its path, followed
   through symbolic links, must stay in the folder of the first file. */
int fxs_scene_source_open_beside(fxs_scene_source *opened, const fxs_scene_source *source, const char *name,
                                 fxs_message *message);

/* Counts the bytes of a file, where it is not counted yet: by whatever name, it is known by its device and inode, or,
   from functions, by its name. Returns 0, or an error and a message. */
int fxs_import_count(const fxs_scene_source *source, fxs_message *message);

/* ---- Names of files beside ---- */

/* Whether a name (NULL: none) stays in the folder and can be shown in one line. Returns 0, or an error and a
   message. */
int fxs_check_name(const fxs_scene_source *source, const char *name, fxs_message *message);

/* The order of names, in which "a/b", "a//b" and "./a/b" are the same. */
int fxs_compare_names(const char *a, const char *b);

/* Undoes %XX of a URI, in place. */
void fxs_decode_percent(char *text);

/* 1 where there is such a file, which need not be one that can be opened; 0, or an error and a message. */
int fxs_scene_source_is_beside(const fxs_scene_source *source, const char *name, fxs_message *message);

/* Bytes in memory; `data` is not copied. */
fxs_scene_input fxs_memory_input(const void *data, size_t size);

/* Reads the bytes at an offset, all of them. Returns 0, or an error and a message. */
int fxs_scene_source_read(const fxs_scene_source *source, uint64_t offset, void *out, size_t size,
                          fxs_message *message);

/* Loads the bytes at an offset, at most FXS_TEXT_MAX, for fxs_text_let_go. Returns 0, or an error and a message. */
int fxs_scene_source_load(const fxs_scene_source *source, uint64_t offset, uint64_t size, fxs_text *text,
                          fxs_message *message);
void fxs_text_let_go(const fxs_scene_source *source, fxs_text *text);

/* Tells the progress, 0 to 1. Returns 0, or an error and a message where the caller wants to stop. */
int fxs_scene_source_progress(const fxs_scene_source *source, double done, fxs_message *message);

/* Closes the file; the path stays. */
void fxs_scene_source_shut(fxs_scene_source *source);

void fxs_scene_source_close(fxs_scene_source *source);

/* ---- Limits ---- */

/* Whether the scene may have so many Gaussians. Returns 0, or an error and a message that says how to raise the
   limit. */
int fxs_limit_gaussians(const fxs_scene_source *source, uint64_t count, fxs_message *message);

/* Whether so many more bytes may be held, for which others may have to go. Returns 0, or FXS_ERR_MEMORY and a message
   as above. */
int fxs_limit_memory(const fxs_scene_source *source, uint64_t bytes, fxs_message *message);

/* A block that counts as held until it is let go. NULL, and a message for FXS_ERR_MEMORY, where it may not be, or there
   is no memory. */
void *fxs_hold(const fxs_scene_source *source, uint64_t bytes, fxs_message *message);
void fxs_let_go(const fxs_scene_source *source, void *block, uint64_t bytes);

#endif
