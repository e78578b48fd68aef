/* Gaussians before they are packed, and streams of them: from a scene file of any format, or from the program.
 *
 * Functions return 0 or a count, or an error and a message: FXS_ERR_FILE where a file is damaged or has changed while
 * it was open, FXS_ERR_STOPPED where a progress function said so, FXS_ERR_MEMORY. A stream is used by one thread at a
 * time; several threads may each have streams of their own.
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

/* One Gaussian, with the numbers of an Inria .ply, before any quantisation. */
typedef struct fxs_gaussian {
    float position[3];   /* scene units, from the origin of the stream: fxs_scene_file_info */
    float scale[3];      /* natural logarithm of the standard deviation, scene units */
    float rotation[4];   /* quaternion w, x, y, z, not normalised: as it is in the file */
    float opacity;       /* logit: the opacity is 1 / (1 + exp(-opacity)); infinite where that is exactly 0 or 1 */
    float dc[3];         /* SH degree 0, r g b; the colour is 0.5 + 0.28209479177387814 dc + higher degrees */
    float sh[45];        /* SH degrees 1 to 3, coefficient-major: sh[3 * k + channel]; 0 above the file's degree */
} fxs_gaussian;

typedef struct fxs_scene_file fxs_scene_file;

/* The values of numbers that a file stores in few bits: `low` plus a whole multiple of `step`. Step 0: any value. */
typedef struct fxs_grid {
    double low, step;
} fxs_grid;

#define FXS_UNUSED_TEXT 128

typedef struct fxs_scene_file_info {
    const char *format;   /* a name of formats.h, or "gaussians" for Gaussians of the program; static */
    uint64_t count;       /* Gaussians in the file */
    int sh_degree;        /* 0 to 3 */
    int stored_sh_degree; /* the same, or 4 where the file has degree 4, whose coefficients are left out */
    int antialiased;      /* 1: opacities were fitted with the dilation compensated */
    int levels;           /* levels of detail that can be opened; 1 except for .lcc, .rad and streamed SOG. A leaf of
                             streamed SOG that lacks the level is read at its nearest level */
    fxs_grid colour;      /* the values of 0.5 + 0.28209479177387814 dc */
    fxs_grid sh;          /* the values of the coefficients above degree 0 */
    int linear_light;     /* 1: a glTF has colours of linear light, which are turned into sRGB Gaussian by Gaussian:
                             where different colours blend, that is not the picture of linear light */
    int log_scales;       /* 1: a glTF has logarithms for scales, as in a draft, and is read so */
    int clamped_opacity;  /* 1: a glTF has opacities above 1, which are read as 1 */
    char unused[FXS_UNUSED_TEXT];   /* properties of a .ply by which other programs draw, and which are not read */
    fxs_start start;      /* of an .fxs: what is up, and its start view, which fxs_pack keeps */
    double origin[3];     /* scene units: add it to a position. 0, unless the scene is far out and has coordinates that
                             are finer than floats there: doubles of a .ply, a far node of a glTF, a far placement */
    double coarse;        /* 0, or the spacing of floats, scene units, at parts that are too far from the origin */
} fxs_scene_file_info;

/* Reads the next Gaussians, at most `capacity`; some formats return fewer also before the end. Returns their number, 0
   at the end, or an error and a message. */
FXS_API long fxs_scene_file_read(fxs_scene_file *file, fxs_gaussian *gaussians, size_t capacity, fxs_message *message);

/* Goes back to the first Gaussian. Returns 0, or an error and a message. */
FXS_API int fxs_scene_file_rewind(fxs_scene_file *file, fxs_message *message);

/* Closes the stream and frees its handle, which may be null. */
FXS_API void fxs_scene_file_close(fxs_scene_file *file);

/* Gaussians that a program has in memory or makes on demand. */
typedef struct fxs_gaussian_source {
    uint64_t count;       /* Gaussians, up to FXS_MAX_COUNT */
    int sh_degree;        /* 0 to 3 */
    int antialiased;      /* as in fxs_scene_file_info */
    /* Writes 1 to `capacity` Gaussians, from number `first` on, to `out`, which is all 0 before; SH above sh_degree
       become 0. Returns the number that it wrote, or a negative FXS_ERR_*. `first` is 0 in the first call of each pass,
       then the number at which the last call ended, and always less than `count`. Every pass must give the same
       Gaussians: fxs_pack makes three passes or more, a filter one more. Calls come one at a time, but in fxs_pack from
       any thread of its pool. */
    long (*read)(void *argument, uint64_t first, fxs_gaussian *out, size_t capacity);
    void *argument;       /* first argument of read; must stay valid until the handle is closed */
    double origin[3];     /* of their positions, as in fxs_scene_file_info: within 2^26 units, 0 where they are near 0 */
} fxs_gaussian_source;

/* Opens the program's Gaussians as a stream, which can be filtered, packed and written like a file; *gaussians is
   copied. The packed scene has the same bytes as one from a .ply with these Gaussians. For an array:

       static long read_array(void *array, uint64_t first, fxs_gaussian *out, size_t capacity)
       {
           memcpy(out, (const fxs_gaussian *)array + first, capacity * sizeof *out);
           return (long)capacity;
       }

       const fxs_gaussian_source source = {count, 3, 0, read_array, array, {0}};
       if (fxs_scene_file_open_gaussians("knot", &source, NULL, &file, &info, &message) ||
           fxs_pack(file, &info, &packed, &report, NULL, &message))
           ...

   Gaussians from `read` are checked like those of a file: fxs_pack leaves out and counts one with a NaN. Where `read`
   returns a number outside its range, or in fxs_pack other positions than in an earlier pass, the error is
   FXS_ERR_FILE; an FXS_ERR_* of `read` is returned as it is. Where options->max_gaussians is 0, FXS_MAX_COUNT is the
   limit. Errors: FXS_ERR_ARGUMENT (no `read`, the degree, the origin), FXS_ERR_FILE, FXS_ERR_MEMORY. */
FXS_API int fxs_scene_file_open_gaussians(const char *name, const fxs_gaussian_source *gaussians,
                                          const fxs_scene_file_options *options, fxs_scene_file **file,
                                          fxs_scene_file_info *info, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
