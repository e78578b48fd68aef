/* The source of a reader's bytes: a file, memory or functions of the caller. */
#ifndef FXS_SOURCE_INTERNAL_H
#define FXS_SOURCE_INTERNAL_H

#include <fixsplat/input.h>
#include "text_internal.h"

/* The files and the memory of all sources of one scene, which the limits of the options are for. */
typedef struct fxs_import {
    uint64_t file_bytes;              /* size of all files found so far, each counted once */
    uint64_t *files;                  /* hash table of these files, with `room` places, a power of two; 0: free */
    size_t file_count, room;
    uint64_t held;                    /* bytes that fxs_hold has allocated */
    int (*drop)(void *reader);        /* frees data that can be read again: returns 1, or 0 where there are none */
    void *reader;
    double origin[3];                 /* positions are read relative to it */
    int moves;                        /* 1: the reader subtracts `origin` in doubles, whatever it is set to */
} fxs_import;

typedef struct fxs_scene_source fxs_scene_source;
struct fxs_scene_source {
    fxs_scene_input input;
    char *path;                       /* path or name, for messages */
    const fxs_scene_source *first;    /* the source that was opened first, if this one lies beside it, or NULL */
    fxs_scene_file_options options;
    fxs_import *import;               /* NULL: without limits */
    uint64_t device, inode;           /* of a file that was opened by its path; else 0 */
};

/* These open a source whose options are set and whose other fields are 0. They return 0, or an error and a message; the
   source must be closed in either case. A path must name a regular file. */
int fxs_scene_source_open(fxs_scene_source *source, const char *path, fxs_message *message);
int fxs_scene_source_open_input(fxs_scene_source *source, const char *name, const fxs_scene_input *input,
                                fxs_message *message);

/* Opens, with the options and limits of `source`, a file whose name is relative to its folder: a foreign scene must not
   choose other files. The name must pass fxs_check_name, and its path, followed through symbolic links, must stay in
   the folder of the first file. A backslash separates folders where no file has that very name. */
int fxs_scene_source_open_beside(fxs_scene_source *opened, const fxs_scene_source *source, const char *name,
                                 fxs_message *message);

/* Counts the bytes of a file, unless it has been counted. Files are told apart by device and inode, those of functions
   by name. Returns 0, or an error and a message. */
int fxs_import_count(const fxs_scene_source *source, fxs_message *message);

/* ---- Names of files beside ---- */

/* 1 where a name stays in the folder and can be shown in one line: no "..", no / at the beginning, no drive of Windows
   and no scheme of an address (C:, https:), no control characters, not empty. A \ counts as a /, and %XX as its
   character, as other systems and servers take them. The function staysInside of read.js is the same. */
int fxs_name_stays(const char *name);

/* Checks that. Returns 0, or an error and a message, also for NULL. */
int fxs_check_name(const fxs_scene_source *source, const char *name, fxs_message *message);

/* Compares names as strcmp does, but "a/b", "a//b" and "./a/b" are equal. */
int fxs_compare_names(const char *a, const char *b);

/* Decodes the %XX of a URI, in place. */
void fxs_decode_percent(char *text);

/* Returns 1 where such a file exists, even if it cannot be opened; 0; or an error and a message. */
int fxs_scene_source_is_beside(const fxs_scene_source *source, const char *name, fxs_message *message);

/* An input from bytes in memory; `data` is not copied. */
fxs_scene_input fxs_memory_input(const void *data, size_t size);

/* Reads all `size` bytes at an offset. Returns 0, or an error and a message. */
int fxs_scene_source_read(const fxs_scene_source *source, uint64_t offset, void *out, size_t size,
                          fxs_message *message);

/* Loads the bytes at an offset, at most FXS_TEXT_MAX, for fxs_text_let_go. Returns 0, or an error and a message. */
int fxs_scene_source_load(const fxs_scene_source *source, uint64_t offset, uint64_t size, fxs_text *text,
                          fxs_message *message);
void fxs_text_let_go(const fxs_scene_source *source, fxs_text *text);

/* Reports the progress, 0 to 1. Returns 0, or an error and a message where the caller wants to stop. */
int fxs_scene_source_progress(const fxs_scene_source *source, double done, fxs_message *message);

/* Closes the file; the path stays. */
void fxs_scene_source_shut(fxs_scene_source *source);

void fxs_scene_source_close(fxs_scene_source *source);

/* ---- Limits ---- */

/* Checks the number of Gaussians against the limit. Returns 0, or an error and a message that says how to raise it. */
int fxs_limit_gaussians(const fxs_scene_source *source, uint64_t count, fxs_message *message);

/* Checks that `bytes` more bytes may be held, and frees others by `drop` if necessary. Returns 0, or FXS_ERR_MEMORY and
   a message as above. */
int fxs_limit_memory(const fxs_scene_source *source, uint64_t bytes, fxs_message *message);

/* Allocates a block that counts as held until fxs_let_go. Returns NULL, and a message for FXS_ERR_MEMORY, where the
   limit is reached or memory ran out. */
void *fxs_hold(const fxs_scene_source *source, uint64_t bytes, fxs_message *message);
void fxs_let_go(const fxs_scene_source *source, void *block, uint64_t bytes);

#endif
