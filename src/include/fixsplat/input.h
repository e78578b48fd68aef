/* Where the bytes of a scene file come from, and what reading it may take. */
#ifndef FXS_INPUT_H
#define FXS_INPUT_H

#include <stddef.h>
#include <stdint.h>

#include "allocator.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Called now and then with the work done, 0 to 1; a return other than 0 stops it, which is an error. */
typedef int fxs_progress_fn(void *argument, double done);

/* Where the options do not say another limit, a scene may have one Gaussian for each byte of its files (those that a
   .gltf or .sog refers to included) and FXS_GAUSSIANS_ALWAYS more, FXS_GAUSSIANS_CEILING at most, and reading it may
   take FXS_IMPORT_BYTES for each Gaussian of that limit, or of FXS_GAUSSIANS_ALWAYS where it is lower. Compressed
   scenes that were captured have 12 bytes a Gaussian and more. */
#define FXS_GAUSSIANS_ALWAYS 1000000u
#define FXS_GAUSSIANS_CEILING 67108864u
#define FXS_IMPORT_BYTES 96u

/* Which way x, y and z point in an .spz: as the file says (without a word, right, up, back); right, up, back; or
   right, down, front, as in a .ply. */
enum fxs_axes { FXS_AXES_OF_FILE, FXS_AXES_RUB, FXS_AXES_RDF };

/* All 0: the finest level, axes as the file says, malloc and free, no progress, the limits above. */
typedef struct fxs_scene_file_options {
    int level;                       /* of detail, 0 the finest */
    enum fxs_axes axes;              /* of an .spz; for others FXS_ERR_ARGUMENT */
    const fxs_allocator *allocator;  /* for all that a reader allocates itself; may be null, else outlives the file */
    fxs_progress_fn *progress;       /* of opening streamed SOG, and of the first read of .spz; may be null */
    void *progress_argument;
    uint64_t max_gaussians;          /* a scene with more is an error; 0: see above */
    uint64_t max_memory;             /* bytes that reading may take at a time, without the packed scene; 0: see above */
} fxs_scene_file_options;

/* The bytes of a file, by functions of the caller. */
typedef struct fxs_scene_input fxs_scene_input;
struct fxs_scene_input {
    uint64_t size;        /* bytes */
    /* Copies the `size` bytes at `offset`, all of them within the file. Returns 0, or any other number for an error. */
    int (*read)(void *argument, uint64_t offset, void *out, size_t size);
    /* Fills *input for another file, a path relative to this one's folder without "..". Returns 0, or any other number
       where there is none. It needs no `beside` of its own. Null: there are no other files. */
    int (*beside)(void *argument, const char *name, fxs_scene_input *input);
    void (*close)(void *argument);   /* once, when it is not needed any more; may be null */
    void *argument;
};

#ifdef __cplusplus
}
#endif

#endif
