/* Gaussians before packing, and streams of them, from a scene file of any format or from the program.
 *
 * Functions return 0 or a count, or an error and a message: FXS_ERR_FILE if a file is damaged or changed while it was
 * open, FXS_ERR_STOPPED by a progress function, FXS_ERR_MEMORY. One thread at a time may use a stream; several threads
 * may each have their own.
 *
 * Stable from version 1.0 on. */
#ifndef FXS_GAUSSIAN_H
#define FXS_GAUSSIAN_H

#include <stddef.h>
#include <stdint.h>

#include "fixsplat.h"
#include "input.h"
#include "start.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One Gaussian, with the numbers of an Inria .ply, before quantisation. */
typedef struct fxs_gaussian {
    float position[3];   /* scene units, relative to the stream's origin (fxs_scene_file_info) */
    float scale[3];      /* natural logarithm of the standard deviation, scene units */
    float rotation[4];   /* quaternion w, x, y, z, as in the file, not normalised */
    float opacity;       /* logit: the opacity is 1 / (1 + exp(-opacity)); infinite if the opacity is exactly 0 or 1 */
    float dc[3];         /* SH degree 0, r g b; the colour is 0.5 + 0.28209479177387814 dc + higher degrees */
    float sh[45];        /* SH degrees 1 to 3, coefficient-major: sh[3 * k + channel]; 0 above the file's degree */
} fxs_gaussian;

typedef struct fxs_scene_file fxs_scene_file;

/* The grid of values that a file with few bits can store: `low` plus a whole multiple of `step`. Step 0: any value. */
typedef struct fxs_grid {
    double low, step;
} fxs_grid;

#define FXS_UNUSED_TEXT 128

typedef struct fxs_scene_file_info {
    const char *format;   /* a name of formats.h, or "gaussians" for the program's Gaussians; static */
    uint64_t count;       /* Gaussians in the file */
    int sh_degree;        /* 0 to 3 */
    int stored_sh_degree; /* sh_degree, or 4 if the file has degree 4, which is not read */
    int antialiased;      /* 1: opacities were fitted with compensation for the renderer's dilation */
    int levels;           /* levels of detail that can be opened; 1 except for .lcc, .rad and streamed SOG. A leaf of a
                             streamed SOG without the level is read at its nearest level */
    fxs_grid colour;      /* grid of 0.5 + 0.28209479177387814 dc */
    fxs_grid sh;          /* grid of the coefficients above degree 0 */
    int linear_light;     /* 1: a glTF has colours in linear light, which are converted to sRGB for each Gaussian; the
                             picture differs from linear light where different colours blend */
    int log_scales;       /* 1: a glTF stores scales as logarithms, as in a draft of the extension; they are read as
                             such */
    int clamped_opacity;  /* 1: a glTF has opacities above 1, which are read as 1 */
    char unused[FXS_UNUSED_TEXT];   /* properties of a .ply that affect other programs' pictures, but are not read */
    fxs_start start;      /* from an .fxs: the up direction and the start view, which fxs_pack keeps */
    double origin[3];     /* scene units: add it to a position. Nonzero only for a scene far from 0 with coordinates
                             finer than floats there: doubles of a .ply, a far node of a glTF, a far placement */
    double coarse;        /* 0, or the spacing of floats, scene units, at parts that lie too far from the origin */
} fxs_scene_file_info;

/* Reads the next Gaussians, at most `capacity`; some formats return fewer before the end, too. Returns their number, 0
   at the end, or an error and a message. */
FXS_API long fxs_scene_file_read(fxs_scene_file *file, fxs_gaussian *gaussians, size_t capacity, fxs_message *message);

/* Goes back to the first Gaussian. Returns 0, or an error and a message. */
FXS_API int fxs_scene_file_rewind(fxs_scene_file *file, fxs_message *message);

/* Closes the stream and frees its handle; null is allowed. */
FXS_API void fxs_scene_file_close(fxs_scene_file *file);

/* Gaussians that a program has in memory or generates on demand. */
typedef struct fxs_gaussian_source {
    uint64_t count;       /* Gaussians, up to FXS_MAX_COUNT */
    int sh_degree;        /* 0 to 3 */
    int antialiased;      /* as in fxs_scene_file_info */
    /* Writes 1 to `capacity` Gaussians, starting with number `first`, to `out`, which is zeroed before; SH above
       sh_degree are set to 0. Returns the number written, or a negative FXS_ERR_*. In the first call of each pass
       `first` is 0, in the others the number after the last Gaussian of the previous call; `first` is always less than
       `count`. Every pass must give the same Gaussians: fxs_pack makes three passes or more, a filter one or two more.
       Calls come one at a time, but in fxs_pack from any thread of its pool. */
    long (*read)(void *argument, uint64_t first, fxs_gaussian *out, size_t capacity);
    void *argument;       /* first argument of read; must stay valid until the handle is closed */
    double origin[3];     /* origin of the positions, as in fxs_scene_file_info: within 2^26 units, 0 for positions near
                             0 */
} fxs_gaussian_source;

/* Opens the program's Gaussians as a stream that can be filtered, packed and written like a file; *gaussians is copied.
   The packed scene has the same bytes as one packed from a .ply with these Gaussians. For an array:

       static long read_array(void *array, uint64_t first, fxs_gaussian *out, size_t capacity)
       {
           memcpy(out, (const fxs_gaussian *)array + first, capacity * sizeof *out);
           return (long)capacity;
       }

       const fxs_gaussian_source source = {count, 3, 0, read_array, array, {0}};
       if (fxs_scene_file_open_gaussians("knot", &source, NULL, &file, &info, &message) ||
           fxs_pack(file, &info, &packed, &report, NULL, &message))
           ...

   Gaussians from `read` are checked like a file's: fxs_pack drops and counts a Gaussian with a NaN. If `read` returns a
   number out of range, or in fxs_pack other positions than in an earlier pass, the error is FXS_ERR_FILE; an FXS_ERR_*
   of `read` is passed on. If options->max_gaussians is 0, the limit is FXS_MAX_COUNT. Errors: FXS_ERR_ARGUMENT (no
   `read`, the degree, the origin), FXS_ERR_FILE, FXS_ERR_MEMORY. */
FXS_API int fxs_scene_file_open_gaussians(const char *name, const fxs_gaussian_source *gaussians,
                                          const fxs_scene_file_options *options, fxs_scene_file **file,
                                          fxs_scene_file_info *info, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
