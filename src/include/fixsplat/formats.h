/* The formats of scene files: the library's one list of them, for help texts, file dialogs and other languages. */
#ifndef FXS_FORMATS_H
#define FXS_FORMATS_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_scene_format {
    const char *name;      /* as fxs_scene_file_info has it: "spz" */
    const char *endings;   /* endings of file names, or whole names, separated by spaces; a file is written by the first */
    const char *about;     /* what it is, in a few words */
    int is_read;           /* 1: files of it are opened, where the libraries that it needs are built in */
    int is_written;        /* the same for writing; of .fxs by fxs_file_write, of others by fxs_scene_writer_open */
    int sh_degree;         /* the highest that is written */
    int antialiased;       /* 1: a file says whether opacities were fitted with the dilation compensated */
    const char *loses;     /* what writing it rounds or leaves out, in a few words; null: nothing that floats hold */
} fxs_scene_format;

/* From 0 on; null beyond the last. */
const fxs_scene_format *fxs_scene_format_at(int index);

/* The format that the ending of a name says, or null. `to_write`: among those that are written, by the ending that
   they are written by. */
const fxs_scene_format *fxs_scene_format_of(const char *path, int to_write);

/* Writes the endings of all formats that are read, or that are written, as ".fxs, .ply, .spz", cut to `size` bytes with
   the final 0. Returns the bytes that all of them take, without the 0. */
size_t fxs_scene_format_endings(char *text, size_t size, int to_write);

#ifdef __cplusplus
}
#endif

#endif
