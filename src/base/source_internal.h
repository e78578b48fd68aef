/* Sources of a reader's bytes: a file, memory, or callbacks. Also limits on files and memory while reading. */
#ifndef FXS_SOURCE_INTERNAL_H
#define FXS_SOURCE_INTERNAL_H

#include <fixsplat/scene.h>
#include "text_internal.h"

/* Totals over all sources of one scene, for the limits in the options. */
typedef struct fxs_import {
    uint64_t file_bytes;              /* size of all files so far, each counted once */
    uint64_t *files;                  /* hash table of the keys of these files; `room` slots, a power of two; 0: free */
    size_t file_count, room;
    uint64_t held;                    /* bytes that fxs_hold has allocated */
    int (*drop)(void *reader);        /* frees data that can be read again; returns 1, or 0 if none is left */
    void *reader;
    double origin[3];                 /* subtracted from positions */
    int moves;                        /* 1: the reader subtracts `origin` in doubles, so it may be changed */
} fxs_import;

typedef struct fxs_scene_source fxs_scene_source;
struct fxs_scene_source {
    fxs_scene_input input;
    char *path;                       /* path or name, for messages */
    const fxs_scene_source *first;    /* for a companion file: the source opened first; else NULL */
    fxs_scene_file_options options;
    fxs_import *import;               /* NULL: no limits */
    uint64_t device, inode;           /* identify a file opened by path; else 0 */
};

/* Open a source. The caller sets its options and clears all other fields. A path must name a regular file. Return 0,
   or an error and a message; close the source in either case. */
int fxs_scene_source_open(fxs_scene_source *source, const char *path, fxs_message *message);
int fxs_scene_source_open_input(fxs_scene_source *source, const char *name, const fxs_scene_input *input,
                                fxs_message *message);

/* Opens a file with a name relative to the folder of `source`, with its options and limits. Protects against
   untrusted scenes that name other files: the name must pass fxs_check_name, and the resolved path must lie in the
   folder of the first file. A backslash separates folders unless a file has exactly this name. */
int fxs_scene_source_open_beside(fxs_scene_source *opened, const fxs_scene_source *source, const char *name,
                                 fxs_message *message);

/* Counts a file's bytes, once per file. Identifies files by device and inode, callback sources by name. Returns 0,
   or an error and a message. */
int fxs_import_count(const fxs_scene_source *source, fxs_message *message);

/* ---- Names of companion files ---- */

/* 1 if a name stays within the folder and fits one line. It must not be empty, and must not have "..", a leading /,
   a drive or URL scheme (C:, https:), or control characters. \ counts as /, and %XX as its character, as on other
   systems and servers. read.js has the same check in staysInside. */
int fxs_name_stays(const char *name);

/* Checks a name with fxs_name_stays. NULL is an error. Returns 0, or an error and a message. */
int fxs_check_name(const fxs_scene_source *source, const char *name, fxs_message *message);

/* As strcmp, but "a/b", "a//b" and "./a/b" are equal. */
int fxs_compare_names(const char *a, const char *b);

/* Decodes %XX of a URI in place. */
void fxs_decode_percent(char *text);

/* 1 if the file exists, even if it cannot be opened; else 0; or an error and a message. */
int fxs_scene_source_is_beside(const fxs_scene_source *source, const char *name, fxs_message *message);

/* An input from bytes in memory; `data` is not copied. */
fxs_scene_input fxs_memory_input(const void *data, size_t size);

/* Reads all `size` bytes at an offset. Returns 0, or an error and a message. */
int fxs_scene_source_read(const fxs_scene_source *source, uint64_t offset, void *out, size_t size,
                          fxs_message *message);

/* Loads `size` bytes at an offset, at most FXS_TEXT_MAX; free the text with fxs_text_let_go. Returns 0, or an error
   and a message. */
int fxs_scene_source_load(const fxs_scene_source *source, uint64_t offset, uint64_t size, fxs_text *text,
                          fxs_message *message);
void fxs_text_let_go(const fxs_scene_source *source, fxs_text *text);

/* Reports progress, 0 to 1. Returns 0, or an error and a message if the caller stops. */
int fxs_scene_source_progress(const fxs_scene_source *source, double done, fxs_message *message);

/* Closes the file but keeps the path. */
void fxs_scene_source_shut(fxs_scene_source *source);

void fxs_scene_source_close(fxs_scene_source *source);

/* ---- Limits ---- */

/* Checks a number of Gaussians against the limit. Returns 0, or an error with a message that says how to raise the
   limit. */
int fxs_limit_gaussians(const fxs_scene_source *source, uint64_t count, fxs_message *message);

/* Checks that `bytes` more can be allocated, and calls `drop` if necessary. Returns 0, or FXS_ERR_MEMORY with a
   message that says how to raise the limit. */
int fxs_limit_memory(const fxs_scene_source *source, uint64_t bytes, fxs_message *message);

/* Allocates a block that counts against the limit until fxs_let_go. Returns NULL and a message for FXS_ERR_MEMORY if
   the limit or the memory is exhausted. */
void *fxs_hold(const fxs_scene_source *source, uint64_t bytes, fxs_message *message);
void fxs_let_go(const fxs_scene_source *source, void *block, uint64_t bytes);

#endif
