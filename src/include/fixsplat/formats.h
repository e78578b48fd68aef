/* The list of scene file formats, for help texts, file dialogs and other languages.
 *
 * Stable from version 1.0 on. */
#ifndef FXS_FORMATS_H
#define FXS_FORMATS_H

#include <stddef.h>

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_scene_format {
    const char *name;      /* as in fxs_scene_file_info: "spz" */
    const char *endings;   /* endings of file names, or whole names, separated by spaces; the first is used for
                              writing */
    const char *about;     /* a short description */
    int is_read;           /* 1: files of this format can be opened, if the libraries that it needs are built in */
    int is_written;        /* 1: files of this format can be written; fxs_file_write writes .fxs, fxs_scene_writer_open
                              the others */
    int sh_degree;         /* highest SH degree that is written */
    int antialiased;       /* 1: a file records whether opacities were fitted with compensation for the renderer's
                              dilation */
    const char *loses;     /* precision or data lost by writing, in a few words; null: nothing beyond the precision of
                              floats */
    int far;               /* 1: positions beyond the precision of floats are kept: fxs_scene_write_options.origin */
} fxs_scene_format;

/* A format by number, from 0 on; null beyond the last. */
FXS_API const fxs_scene_format *fxs_scene_format_at(int index);

/* The format for the ending of a file name, or null. With `to_write`, only writable formats are considered, each by its
   first ending. */
FXS_API const fxs_scene_format *fxs_scene_format_of(const char *path, int to_write);

/* Writes the endings of all readable formats (with `to_write`: writable ones) as ".fxs, .ply, .spz", cut to `size`
   bytes with the final 0. Returns the length of the whole text in bytes, without the 0. */
FXS_API size_t fxs_scene_format_endings(char *text, size_t size, int to_write);

#ifdef __cplusplus
}
#endif

#endif
