/* Scene files: a stream of Gaussians in the file's order, whatever the format.
 *
 * Functions return 0 or a count, or an error and a message: FXS_ERR_FILE where a file is missing, damaged, of an
 * unknown format, changed while it was open, or beyond max_gaussians; FXS_ERR_STOPPED where a progress function said
 * so; FXS_ERR_MEMORY where memory ended, or more than max_memory would be needed (bytes_needed has how much);
 * FXS_ERR_UNSUPPORTED where this was built without a library that the format needs; FXS_ERR_ARGUMENT for a level that
 * there is not. A file is used by one thread at a time; several threads may each have files of their own. */
#ifndef FXS_SCENE_FILE_H
#define FXS_SCENE_FILE_H

#include <stddef.h>
#include <stdint.h>

#include "fixsplat.h"
#include "allocator.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One Gaussian as an Inria .ply means it, before any quantisation. */
typedef struct fxs_gaussian {
    float position[3];   /* scene units */
    float scale[3];      /* natural logarithm of the standard deviation, scene units */
    float rotation[4];   /* quaternion w, x, y, z; as in the file, not normalised */
    float opacity;       /* logit: the opacity is 1 / (1 + exp(-opacity)) */
    float dc[3];         /* SH degree 0, r g b; the colour is 0.5 + 0.28209479177387814 dc + higher degrees */
    float sh[45];        /* degrees 1 to 3, coefficient-major: sh[3 * k + channel]; 0 above the file's degree */
} fxs_gaussian;

typedef struct fxs_scene_file fxs_scene_file;

/* Numbers that a file holds in few bits: all are `low` plus a whole multiple of `step`. Step 0: they are not. */
typedef struct fxs_grid {
    double low, step;
} fxs_grid;

typedef struct fxs_scene_file_info {
    const char *format;   /* "ply", "compressed ply", "ksplat", "lcc", "sog", "splat", "spz", "gltf", "tileset",
                             "gaussians" (of the program); static */
    uint64_t count;       /* Gaussians in the file */
    int sh_degree;        /* 0 to 3 */
    int stored_sh_degree; /* the same, or 4 where the coefficients of degree 4 are left out */
    int antialiased;      /* 1: opacities were fitted with the dilation compensated */
    int levels;           /* of detail that can be opened; 1 but for .lcc and streamed SOG. A leaf of the
                             latter that lacks the level is read at the nearest that it has */
    fxs_grid colour;      /* of 0.5 + 0.28209479177387814 dc */
    fxs_grid sh;          /* of the coefficients above degree 0 */
} fxs_scene_file_info;

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
    enum fxs_axes axes;              /* of a file that is an .spz; of no meaning in others */
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

/* Opens a scene file, or a folder with the meta.json or lod-meta.json of a .sog or the tileset.json of 3D Tiles. The
   content tells the format. `options` may be null. Returns 0 and a handle that fxs_scene_file_close frees, or an error
   and a message, with *file null. 2D Gaussians are read as 3D ones with a scale of e^-20 across; a glTF of linear
   light is refused.

   The header is checked whole, and the size of a binary body against it. Only headers are read, so that *info is known
   before anything large is allocated. But a .ply is read up to its vertices where it has lists or text before them, and
   .sog (each file of a level) as far as its images, which are kept compressed.

   What a reader allocates. A .ply, .ksplat or .splat: at most 1 MiB. An .lcc: 1 MiB, its JSON, and 16 bytes a cell. An
   .spz: from the first read on 65 bytes a Gaussian of SH degree 3 (92 of 4), and for that read the longest stream of
   version 4. A .sog: its images, and from the first read on 4 bytes a pixel of each instead. A .glb or .gltf: 3 MiB, its
   JSON and base64, and as its .spz. A tileset: 512 bytes a content, and as 33 of them. What cJSON, libzip, libwebp and
   zstd need themselves comes from malloc. Of that, cJSON's part is held against max_memory too.

   What is decompressed is kept until the file is closed, so that no pass over it decompresses it again, and one .spz
   that several nodes of a glTF use is there once. Where the .spz of a glTF or the files of a streamed SOG are more than
   max_memory together, those that fit are kept, and the others are decompressed again in each pass. Of a tileset 32
   contents stay open; the others are opened again in each pass.

   A path must be that of a regular file, or of a folder as above. A file that another refers to must lie in the folder
   of the one that was opened, or in a folder within: neither ".." nor a symbolic link may lead out of it. It may be
   the content of one tile only. */
int fxs_scene_file_open(const char *path, const fxs_scene_file_options *options, fxs_scene_file **file,
                        fxs_scene_file_info *info, fxs_message *message);

/* The same for a file in memory, which must stay as it is until the handle is closed. `name` begins messages, and is
   copied. A format that refers to other files cannot be opened so. */
int fxs_scene_file_open_memory(const char *name, const void *data, size_t size, const fxs_scene_file_options *options,
                               fxs_scene_file **file, fxs_scene_file_info *info, fxs_message *message);

/* The same by functions; *input is copied. Its `close` is called also where opening fails. */
int fxs_scene_file_open_input(const char *name, const fxs_scene_input *input, const fxs_scene_file_options *options,
                              fxs_scene_file **file, fxs_scene_file_info *info, fxs_message *message);

/* Gaussians that a program has in memory, or makes as they are asked for. */
typedef struct fxs_gaussian_source {
    uint64_t count;       /* Gaussians, up to FXS_MAX_COUNT */
    int sh_degree;        /* 0 to 3 */
    int antialiased;      /* as in fxs_scene_file_info */
    /* Fills in Gaussians from number `first` on, 1 to `capacity` of them, in `out`, which is all 0 before; SH above
       sh_degree become 0. Returns how many it filled in, or a negative FXS_ERR_*. `first` is 0 in the first call of
       each pass, and then goes on where the last call ended, never to `count`. Each pass is to give the same
       Gaussians: fxs_pack makes three, and a filter one. Calls come one at a time, but in fxs_pack from any thread of
       its pool. */
    long (*read)(void *argument, uint64_t first, fxs_gaussian *out, size_t capacity);
    void *argument;       /* first argument of read, which must stay until the handle is closed */
} fxs_gaussian_source;

/* Opens the program's Gaussians as a file, which can be filtered, packed and written like any other; *gaussians is
   copied. The packed scene has the same bytes as one from a .ply with these Gaussians. For an array:

       static long read_array(void *array, uint64_t first, fxs_gaussian *out, size_t capacity)
       {
           memcpy(out, (const fxs_gaussian *)array + first, capacity * sizeof *out);
           return (long)capacity;
       }

       const fxs_gaussian_source source = {count, 3, 0, read_array, array};
       if (fxs_scene_file_open_gaussians("knot", &source, NULL, &file, &info, &message) ||
           fxs_pack(file, &info, &packed, &report, NULL, &message))
           ...

   What `read` gives is checked as a file is: NaN is left out, and counted. A number out of its range is FXS_ERR_FILE,
   an FXS_ERR_* is returned as it is, and positions that another pass did not have are FXS_ERR_FILE in fxs_pack. There
   is no limit on the count where options->max_gaussians is 0. Errors: FXS_ERR_ARGUMENT (no `read`, the degree),
   FXS_ERR_FILE, FXS_ERR_MEMORY. */
int fxs_scene_file_open_gaussians(const char *name, const fxs_gaussian_source *gaussians,
                                  const fxs_scene_file_options *options, fxs_scene_file **file,
                                  fxs_scene_file_info *info, fxs_message *message);

/* Reads the next `capacity` Gaussians, or as many as are left and some formats have at hand. Returns their number, 0 at
   the end, or an error and a message. */
long fxs_scene_file_read(fxs_scene_file *file, fxs_gaussian *gaussians, size_t capacity, fxs_message *message);

/* Goes back to the first Gaussian. Returns 0, or an error and a message. */
int fxs_scene_file_rewind(fxs_scene_file *file, fxs_message *message);

/* Closes the file and frees the handle, which may be null. */
void fxs_scene_file_close(fxs_scene_file *file);

#ifdef __cplusplus
}
#endif

#endif
