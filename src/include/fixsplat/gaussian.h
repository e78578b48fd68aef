/* Gaussians before they are packed, and streams of them: a scene file, whatever its format, or a program's own.
 *
 * Functions return 0 or a count, or an error and a message: FXS_ERR_FILE where a file is damaged or has changed while it
 * was open, FXS_ERR_STOPPED where a progress function said so, FXS_ERR_MEMORY. A stream is used by one thread at a time;
 * several threads may each have streams of their own. */
#ifndef FXS_GAUSSIAN_H
#define FXS_GAUSSIAN_H

#include <stddef.h>
#include <stdint.h>

#include "fixsplat.h"
#include "input.h"

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

/* Reads the next `capacity` Gaussians, or as many as are left and some formats have at hand. Returns their number, 0 at
   the end, or an error and a message. */
long fxs_scene_file_read(fxs_scene_file *file, fxs_gaussian *gaussians, size_t capacity, fxs_message *message);

/* Goes back to the first Gaussian. Returns 0, or an error and a message. */
int fxs_scene_file_rewind(fxs_scene_file *file, fxs_message *message);

/* Closes the file and frees the handle, which may be null. */
void fxs_scene_file_close(fxs_scene_file *file);

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

#ifdef __cplusplus
}
#endif

#endif
