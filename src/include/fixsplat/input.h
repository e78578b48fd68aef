/* The source of a scene file's bytes, and the limits on reading it.
 *
 * Stable from version 1.0 on. */
#ifndef FXS_INPUT_H
#define FXS_INPUT_H

#include <stddef.h>
#include <stdint.h>

#include "allocator.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Called from time to time with the finished share of the work, 0 to 1. A nonzero return stops the work; the function
   at work then returns FXS_ERR_STOPPED. */
typedef int fxs_progress_fn(void *argument, double done);

/* Default limits. A scene may have one Gaussian for each byte of its files (including files that a .gltf or .sog refers
   to) plus FXS_GAUSSIANS_ALWAYS, but at most FXS_GAUSSIANS_CEILING. Reading it may take FXS_IMPORT_BYTES of memory for
   each Gaussian of that limit, or of FXS_GAUSSIANS_ALWAYS if the limit is lower. Compressed captured scenes have 12
   bytes a Gaussian and more. */
#define FXS_GAUSSIANS_ALWAYS 1000000u
#define FXS_GAUSSIANS_CEILING 67108864u
#define FXS_IMPORT_BYTES 96u

/* The directions of x, y and z in an .spz. FXS_AXES_OF_FILE: as the file states (right, up, back if it states nothing);
   FXS_AXES_RUB: right, up, back; FXS_AXES_RDF: right, down, front, as in a .ply. */
enum fxs_axes { FXS_AXES_OF_FILE, FXS_AXES_RUB, FXS_AXES_RDF };

/* All fields 0: finest level, axes as the file says, malloc and free, no progress, the limits above. */
typedef struct fxs_scene_file_options {
    int level;                       /* level of detail; 0: the finest */
    enum fxs_axes axes;              /* for an .spz only; other formats return FXS_ERR_ARGUMENT */
    const fxs_allocator *allocator;  /* for the reader's own memory; null: malloc. Must outlive the file */
    fxs_progress_fn *progress;       /* for opening a streamed SOG and the first read of an .spz; may be null */
    void *progress_argument;
    uint64_t max_gaussians;          /* a scene with more is an error; 0: the limit above */
    uint64_t max_memory;             /* most bytes that reading may hold at once, without the packed scene; 0: the limit
                                        above */
} fxs_scene_file_options;

/* A file whose bytes come from callbacks. */
typedef struct fxs_scene_input fxs_scene_input;
struct fxs_scene_input {
    uint64_t size;        /* bytes */
    /* Copies the `size` bytes at `offset`, which lie within the file, to `out`. Returns 0, or another number after an
       error. */
    int (*read)(void *argument, uint64_t offset, void *out, size_t size);
    /* Opens another file: fills in *input. `name` is a path relative to the folder of this file, without "..". Returns
       0, or another number if the file does not exist. *input needs no `beside`. Null: no other files exist. */
    int (*beside)(void *argument, const char *name, fxs_scene_input *input);
    void (*close)(void *argument);   /* called once, when the file is no longer needed; may be null */
    void *argument;                  /* first argument of the functions */
};

#ifdef __cplusplus
}
#endif

#endif
