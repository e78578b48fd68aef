/* Scene files and streams of Gaussians: reads every format, filters, decimates and writes. */
#ifndef FXS_SCENE_H
#define FXS_SCENE_H

#include <stddef.h>
#include <stdint.h>

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A progress callback: called from time to time with the finished share of the work, 0 to 1. A nonzero return stops the
   work; the function at work then returns FXS_ERR_STOPPED. */
typedef int fxs_progress_fn(void *argument, double done);

typedef struct fxs_progress {
    fxs_progress_fn *call;           /* the progress callback; null: no progress is reported */
    void *argument;                  /* first argument of the progress callback */
} fxs_progress;

/* ---- Formats ----------------------------------------------------------------------------------------------------- */

/* A scene file format. The list of formats serves help texts, file dialogs and other languages. */

typedef struct fxs_scene_format {
    const char *name;      /* name of the format, as in fxs_scene_file_info, such as "spz" */
    const char *endings;   /* endings of file names, or whole names, separated by spaces; the first is used for
                              writing */
    const char *about;     /* description of the format in a few words */
    int is_read;           /* 1: files of this format can be opened, if the libraries that it needs are built in */
    int is_written;        /* 1: files of this format can be written; fxs_file_write writes .fxs, fxs_scene_writer_open
                              the others */
    int sh_degree;         /* highest SH degree that a file of this format is written with */
    int antialiased;       /* 1: a file can record whether opacities were fitted with compensation for the renderer's
                              dilation (a small blur of each Gaussian) */
    const char *loses;     /* what writing to this format loses (precision or data), in a few words; null: nothing
                              beyond the precision of floats */
    int far;               /* 1: the format keeps positions beyond the precision of floats
                              (fxs_scene_write_options.origin) */
    int moves;             /* 1: the format keeps how Gaussians move */
} fxs_scene_format;

/* Returns a scene file format by its number in the list, from 0 on; null beyond the last. */
FXS_API const fxs_scene_format *fxs_scene_format_at(int index);

/* Returns the scene file format for the ending of a file name, or null. With `to_write`, only writable formats are
   considered, each by its first ending. */
FXS_API const fxs_scene_format *fxs_scene_format_of(const char *path, int to_write);

/* Writes the file name endings of all readable formats (with `to_write`: writable ones) as ".fxs, .ply, .spz", cut to
   `size` bytes with the final 0. Returns the length of the whole text in bytes, without the 0. */
FXS_API size_t fxs_scene_format_endings(char *text, size_t size, int to_write);

/* ---- Start data -------------------------------------------------------------------------------------------------- */

/* The start data of a packed scene: its up direction and a start view (the first camera for viewers). Both are in the
   header (internal/packed.h) and optional. The renderer does not read them. */

/* Up direction and start view of a scene. All fields 0: both are unknown. */
typedef struct fxs_start {
    double up[3];         /* up direction in the scene, of length 1; all 0: unknown */
    double tangent;       /* tangent of half the start view's vertical field of view, up to 12; 0: no start view */
    double position[3];   /* centre of the start view's camera, scene units, within +-2^28 */
    double rotation[4];   /* rotation of the start view's camera, from world to camera (x right, y down, z forward):
                             unit quaternion w, x, y, z */
} fxs_start;

/* ---- Input ------------------------------------------------------------------------------------------------------- */

/* The source of a scene file's bytes, and the limits on reading it. */

/* Default limits of reading a scene. A scene may have one Gaussian for each byte of its files (including files that a
   .gltf or .sog refers to) plus FXS_GAUSSIANS_ALWAYS, but at most FXS_GAUSSIANS_CEILING. Reading it may take
   FXS_IMPORT_BYTES of memory for each Gaussian of that limit, or of FXS_GAUSSIANS_ALWAYS if the limit is lower.
   Compressed captured scenes have 12 bytes a Gaussian and more. */
#define FXS_GAUSSIANS_ALWAYS 1000000u
#define FXS_GAUSSIANS_CEILING 67108864u
#define FXS_IMPORT_BYTES 96u

/* The directions of x, y and z in an .spz. FXS_AXES_OF_FILE: as the file states (right, up, back if it states nothing);
   FXS_AXES_RUB: right, up, back; FXS_AXES_RDF: right, down, front, as in a .ply. */
enum fxs_axes { FXS_AXES_OF_FILE, FXS_AXES_RUB, FXS_AXES_RDF };

/* Options for reading a scene file. The defaults: finest level, axes as the file says, malloc and free, no progress,
   default limits. */
typedef struct fxs_scene_file_options {
    uint32_t size;
    int level;                       /* level of detail to read; 0: the finest */
    enum fxs_axes axes;              /* meaning of x, y and z in an .spz; other formats return FXS_ERR_ARGUMENT */
    const fxs_allocator *allocator;  /* allocator for the reader's own memory; null: malloc. Must outlive the file */
    fxs_progress progress;           /* progress callback, called while a streamed SOG is opened and during the first
                                        read of an .spz */
    uint64_t max_gaussians;          /* largest number of Gaussians in a scene, more is an error; 0: the limit by
                                        FXS_GAUSSIANS_ALWAYS */
    uint64_t max_memory;             /* most bytes that reading may hold at once, without the packed scene; 0: the limit
                                        by FXS_IMPORT_BYTES */
    double rate;                     /* frames a second of numbered files; 0: 30 */
} fxs_scene_file_options;
FXS_INIT(fxs_scene_file_options)

/* A scene file with bytes from the program's callbacks. */
typedef struct fxs_scene_input fxs_scene_input;
struct fxs_scene_input {
    uint64_t size;        /* bytes */
    /* Reads a part of the file: copies the `size` bytes at `offset`, which lie within the file, to `out`. Returns 0, or
       another number after an error. */
    int (*read)(void *argument, uint64_t offset, void *out, size_t size);
    /* Opens another file next to this one: fills in *input. `name` is a path relative to the folder of this file,
       without "..". Returns 0, or another number if the file does not exist. *input needs no `beside`. The pointer is
       null if no other files exist. */
    int (*beside)(void *argument, const char *name, fxs_scene_input *input);
    void (*close)(void *argument);   /* frees the file: called once, when it is no longer needed; may be null */
    void *argument;                  /* first argument of read, beside and close */
};

/* ---- Gaussians --------------------------------------------------------------------------------------------------- */

/* Gaussians before packing, and streams of them, from a scene file of any format or from the program. Functions return
   0 or a count, or an error and a message: FXS_ERR_FILE if a file is damaged or changed while it was open,
   FXS_ERR_STOPPED by a progress callback, FXS_ERR_MEMORY. One thread at a time may use a stream; several threads may
   each have their own. */

/* One Gaussian before quantisation. Its numbers mean the same as in a .ply of Inria's code (Kerbl et al. 2023). */
typedef struct fxs_gaussian {
    float position[3];   /* centre, scene units, relative to the stream's origin (fxs_scene_file_info) */
    float scale[3];      /* natural logarithm of the standard deviation along each axis, scene units */
    float rotation[4];   /* rotation: quaternion w, x, y, z, as in the file, not normalised */
    float opacity;       /* logit: the opacity is 1 / (1 + exp(-opacity)); infinite if the opacity is exactly 0 or 1 */
    float dc[3];         /* SH coefficients of degree 0 for red, green, blue; the colour is 0.5 + 0.28209479177387814 dc
                            + higher degrees */
    float sh[45];        /* SH coefficients of degrees 1 to 3: sh[3 * k + channel] for coefficient k; 0 above the file's
                            degree */
} fxs_gaussian;

/* How a Gaussian of a moving scene moves, with d = t - centre in seconds: its position is position + d drift[0] + d^2
   drift[1] + d^3 drift[2], its rotation is (rotation + d turn) normalised, its opacity is opacity exp(-(d / fade)^2).
   It exists from the time `from` until before the time `to`. Source: Li et al. 2024, Spacetime Gaussian feature
   splatting, section 4.1. */
typedef struct fxs_motion {
    float drift[3][3];   /* scene units per second, per second^2 and per second^3, each x, y, z */
    float turn[4];       /* change of the quaternion w, x, y, z per second */
    float centre, fade;  /* seconds; a fade of INFINITY: the opacity does not change */
    float from, to;      /* seconds; -INFINITY, INFINITY: it always exists */
} fxs_motion;

/* The time of a moving scene in a file. */
typedef struct fxs_time {
    double duration;     /* seconds; times are 0 to the duration; 0: the scene is still */
    double rate;         /* frames a second of the source; 0: none, the motion is continuous */
    int loops;           /* 1: after its duration the scene starts again */
    int degree;          /* of the polynomials of the position: 0 to 3 */
    int turns, fades;    /* 1: turns are not all 0; fades are not all INFINITY */
    double least;        /* a Gaussian is not drawn while its opacity has fallen below this share of its largest; 0: as
                            the renderer draws it */
} fxs_time;

typedef struct fxs_scene_file fxs_scene_file;

/* The values of a number that a file stores with few bits: `low` plus a whole multiple of `step`. Step 0: any value. */
typedef struct fxs_grid {
    double low, step;
} fxs_grid;

#define FXS_UNUSED_TEXT 128

typedef struct fxs_scene_file_info {
    const char *format;   /* name of the file's format, or "gaussians" for the program's Gaussians; a static string */
    uint64_t count;       /* number of Gaussians in the file */
    int sh_degree;        /* SH degree of the Gaussians, 0 to 3 */
    int stored_sh_degree; /* SH degree in the file: equal to sh_degree, or 4, as degree 4 is not read */
    int antialiased;      /* 1: opacities were fitted with compensation for the renderer's dilation, a small blur of
                             each Gaussian */
    int levels;           /* number of levels of detail that can be opened; 1 except for .lcc, .rad and streamed SOG. A
                             leaf of a streamed SOG that lacks the requested level is read at its nearest level */
    fxs_grid colour;      /* values that the file can store for colours, 0.5 + 0.28209479177387814 dc */
    fxs_grid sh;          /* values that the file can store for SH coefficients above degree 0 */
    int linear_light;     /* 1: a glTF has colours in linear light, which are converted to sRGB for each Gaussian; the
                             picture differs from linear light where different colours blend */
    int log_scales;       /* 1: a glTF stores scales as logarithms, as a draft of the Gaussian splatting extension did,
                             and they are read so */
    int clamped_opacity;  /* 1: a glTF has opacities above 1, which are read as 1 */
    char unused[FXS_UNUSED_TEXT];   /* properties of a .ply that affect other programs' pictures, but are not read */
    fxs_start start;      /* up direction and start view of an .fxs; fxs_pack keeps them */
    double origin[3];     /* origin of the stream, scene units, to add to each position. Nonzero only for a scene far
                             from 0 with coordinates finer than floats there: doubles of a .ply, a far node of a glTF, a
                             far placement */
    double coarse;        /* loss of precision of positions: the spacing of floats in scene units, at parts that lie too
                             far from the origin; 0: none */
    fxs_time time;        /* of a moving scene */
} fxs_scene_file_info;

/* Reads the next Gaussians of a stream, at most `capacity`; some formats return fewer before the end, too. Returns
   their number, 0 at the end, or an error and a message. */
FXS_API long fxs_scene_file_read(fxs_scene_file *file, fxs_gaussian *gaussians, size_t capacity, fxs_message *message);

/* Returns how the Gaussians of the last call of fxs_scene_file_read move, one fxs_motion each, until the next call;
   null for a still scene. */
FXS_API const fxs_motion *fxs_scene_file_motions(const fxs_scene_file *file);

/* Attaches a moment to an open file of a moving scene. From then on, fxs_scene_file_read returns still Gaussians as
   they are at that time, and info->count is the number of those that exist then. `seconds` is limited to the scene's
   duration, or taken modulo it if the scene loops. A still scene is not changed. The file is read once. Returns 0, or
   an error and a message; the caller must then close the file. Errors: as fxs_scene_file_read; FXS_ERR_FILE if no
   Gaussian exists then; FXS_ERR_MEMORY. */
FXS_API int fxs_scene_file_at(fxs_scene_file *file, double seconds, fxs_scene_file_info *info,
                                       fxs_message *message);

/* Moves a Gaussian to a time, seconds, 0 to the duration. Returns 0 if it does not exist then. */
FXS_API int fxs_gaussian_at(fxs_gaussian *gaussian, const fxs_motion *motion, const fxs_time *time,
                                     double seconds);

/* Returns a time within a moving scene: modulo its duration if it loops, else limited to it. */
FXS_API double fxs_time_within(const fxs_time *time, double seconds);

/* Goes back to the first Gaussian of a stream. Returns 0, or an error and a message. */
FXS_API int fxs_scene_file_rewind(fxs_scene_file *file, fxs_message *message);

/* Closes a stream of Gaussians and frees its handle; null is allowed. */
FXS_API void fxs_scene_file_close(fxs_scene_file *file);

/* A source of Gaussians that a program has in memory or generates on demand. */
typedef struct fxs_gaussian_source {
    uint64_t count;       /* number of Gaussians, up to FXS_MAX_COUNT */
    int sh_degree;        /* SH degree of the Gaussians, 0 to 3 */
    int antialiased;      /* 1: opacities were fitted with compensation for the renderer's dilation, a small blur of
                             each Gaussian */
    /* Callback that writes 1 to `capacity` Gaussians, starting with number `first`, to `out`, which is zeroed before.
       SH above sh_degree are set to 0. It returns the number written, or a negative FXS_ERR_*. In the first call of
       each pass `first` is 0, in the others the number after the last Gaussian of the previous call; `first` is always
       less than `count`. Every pass must give the same Gaussians: fxs_pack makes three passes or more, a filter one or
       two more. Calls come one at a time, but in fxs_pack from any thread of its pool. */
    long (*read)(void *argument, uint64_t first, fxs_gaussian *out, size_t capacity);
    void *argument;       /* first argument of the callback `read`; must stay valid until the handle is closed */
    double origin[3];     /* origin that is added to each position, as in fxs_scene_file_info: within 2^26 units, 0 for
                             positions near 0 */
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

/* Gaussians that move, for fxs_scene_file_open_moving. */
typedef struct fxs_motion_source {
    uint32_t size;
    fxs_time time;
    /* Writes the motions of `count` Gaussians, those that `read` of the fxs_gaussian_source wrote last, from number
       `first` on. Returns 0 or an FXS_ERR_*. */
    int (*read)(void *argument, uint64_t first, fxs_motion *out, size_t count);
    void *argument;
} fxs_motion_source;
FXS_INIT(fxs_motion_source)

/* Opens the program's moving Gaussians as fxs_scene_file_open_gaussians opens still ones; *motions is copied too.
   fxs_pack drops and counts a Gaussian whose motion has a NaN, a fade of 0 or less, or an empty window. Errors: also
   FXS_ERR_ARGUMENT for a duration that is not above 0 and at most 16,384 seconds, a degree, or no `read`. */
FXS_API int fxs_scene_file_open_moving(const char *name, const fxs_gaussian_source *gaussians,
                                                const fxs_motion_source *motions,
                                                const fxs_scene_file_options *options, fxs_scene_file **file,
                                                fxs_scene_file_info *info, fxs_message *message);

/* ---- Scene files ------------------------------------------------------------------------------------------------- */

/* Opens scene files of any format as streams of Gaussians (scene.h), in file order.

   Functions return 0 or a count, or an error and a message: FXS_ERR_FILE for a file that is missing, damaged, of an
   unknown format, changed while it was open, or larger than max_gaussians; FXS_ERR_STOPPED by a progress function;
   FXS_ERR_MEMORY if memory ran out or max_memory would be exceeded (bytes_needed has the size); FXS_ERR_UNSUPPORTED if
   fixsplat was built without a library that the format needs; FXS_ERR_ARGUMENT for a level that the scene lacks. One
   thread at a time may use a file; several threads may each use their own. */

/* Opens a scene file, or a folder with the meta.json or lod-meta.json of a .sog or the tileset.json of 3D Tiles, or the
   frames of a moving scene: a folder of numbered files (frame0001.ply, frame0002.ply ...; any format of one file), or a
   path with a * for the number. The content determines the format. `options` may be null. Returns 0 and a handle that
   fxs_scene_file_close frees, or an error and a message, with *file null. 2D Gaussians are read as 3D Gaussians with a
   third scale of e^-20. The filter_3D of a Mip-Splatting .ply is applied. fxs_scene_file_info reports all other changes
   and unused data.

   The header is checked completely, including the size of a binary body. Only headers are read, so *info is known
   before large allocations. Two exceptions: a .ply with lists or text before its vertices is read up to them, and the
   .sog files of a level are read up to their images, which stay compressed.

   Memory of a reader:
   - .fxs, .ply, .ksplat, .splat: at most 1 MiB.
   - .lcc: 1 MiB, its JSON, and 16 bytes a cell.
   - .spz: from the first read on, 65 bytes a Gaussian of SH degree 3 (92 of degree 4); during that read also the
     longest stream of version 4.
   - .rad: its JSON, a byte and a bit for each node of a tree, and the attributes of a chunk: at most 240 bytes for each
     of its 65,536 Gaussians.
   - .sog: its compressed images; from the first read on, 4 bytes a pixel instead.
   - A folder of gsplat: 24 bytes a pixel, its palette and its labels.
   - .glb, .gltf: 3 MiB, its JSON and base64, and the memory of its .spz.
   - A tileset: 1200 bytes and the name of each content, and the memory of 33 contents.
   cJSON, libzip, libwebp and zstd allocate their own memory with malloc; cJSON's also counts towards max_memory.

   Decompressed data are kept until the file is closed, for later passes over the file; an .spz that several nodes of a
   glTF share is kept once. If the .spz of a glTF or the files of a streamed SOG exceed max_memory together, the files
   that fit are kept and the others are decompressed again in each pass. A tileset keeps 32 contents open and reopens
   the others in each pass.

   `path` must name a regular file or a folder as above. Files that it refers to must lie in the folder of the opened
   file or below it: a path that leaves that folder, by ".." or a symbolic link, is refused. A \ in a file name
   separates folders, unless a file with that exact name exists. Several tiles may share one content, but a tileset must
   not contain itself. */
FXS_API int fxs_scene_file_open(const char *path, const fxs_scene_file_options *options, fxs_scene_file **file,
                                fxs_scene_file_info *info, fxs_message *message);

/* Opens a scene file in memory like fxs_scene_file_open. The bytes must stay unchanged until the handle is closed.
   Messages begin with `name`, which is copied. Scenes of several files cannot be opened from memory. */
FXS_API int fxs_scene_file_open_memory(const char *name, const void *data, size_t size,
                                       const fxs_scene_file_options *options, fxs_scene_file **file,
                                       fxs_scene_file_info *info, fxs_message *message);

/* Opens a scene file that callbacks read, like fxs_scene_file_open; *input is copied. Its `close` is called even if
   opening fails. */
FXS_API int fxs_scene_file_open_input(const char *name, const fxs_scene_input *input,
                                      const fxs_scene_file_options *options, fxs_scene_file **file,
                                      fxs_scene_file_info *info, fxs_message *message);

/* ---- Filters ----------------------------------------------------------------------------------------------------- */

/* Filters a stream of Gaussians: keeps or drops them by position, opacity and SH degree, and drops floaters (stray
   Gaussians with few neighbours). */

/* Gaussians that cannot be drawn and are dropped: their number by reason, and the weights of the dropped and of the
   kept Gaussians. */
typedef struct fxs_pack_dropped {
    uint64_t not_finite;      /* number of Gaussians with a value that is NaN or infinite; only ln(sigma) may be minus
                                 infinity */
    uint64_t rotation;        /* number of Gaussians with a quaternion of zero */
    uint64_t transparent;     /* number of Gaussians with an opacity of minus infinity, exactly 0 after the sigmoid: not
                                 a fault of the file */
    double weight, kept;      /* sums of fxs_weight over the dropped Gaussians and over the kept ones */
} fxs_pack_dropped;

#define FXS_FLOATER_NEIGHBOURS 8
#define FXS_FLOATER_STRENGTHS 5

enum fxs_filter_kind { FXS_FILTER_BOX, FXS_FILTER_SPHERE, FXS_FILTER_CYLINDER, FXS_FILTER_KINDS };

/* A shape of a filter, as numbers. For a box the least x, y, z and the greatest; for a sphere the middle and the
   radius; for a cylinder the middles of its two ends, which differ, and the radius. Scene units; surfaces count as
   inside. */
typedef struct fxs_filter_shape {
    enum fxs_filter_kind kind;
    double numbers[7];
} fxs_filter_shape;

typedef struct fxs_scene_filter {
    uint32_t size;
    double low[3], high[3];   /* keeps Gaussians with centres in this box, scene units; -INFINITY to INFINITY: all */
    double middle[3], radius; /* keeps Gaussians with centres in this sphere; a radius of INFINITY: all */
    double opacity;           /* least opacity of Gaussians to keep, 0 to 1 */
    int sh_degree;            /* highest SH degree to keep, 0 to 3 */
    int drawable;             /* 1: drops the Gaussians that fxs_pack would drop */
    int floaters;             /* strength of the floater filter, 1 to 5: drops floaters (Gaussians with few neighbours)
                                 among the Gaussians that the other filters keep. fxs_scene_filter describes the
                                 strengths; 0: keeps floaters */
    /* Shapes of the filter. For each kind (box, sphere, cylinder) with shapes, it keeps Gaussians with centres in at
       least one shape of that kind. The caller owns the array, which must stay valid until the file is closed. */
    const fxs_filter_shape *shapes;
    uint32_t shape_count;
    /* 1: keeps only the thing, of the Gaussians that the rest of the filter keeps: a set of Gaussians that touch, about
       the middle of the small opaque ones, without the ground below. info->start.up is roughly up (all 0: -y). 2: also
       sets info->start.up to the normal of the ground, if the scene has one. The filter reads the file four times more,
       and holds 72 MB. If no thing stands out, the error is FXS_ERR_ARGUMENT */
    int thing;
    const uint8_t *deleted;        /* a byte for each of the stream's first deleted_count Gaussians; not 0: the Gaussian
                                      is dropped, and not counted in the report. Null: none. The caller keeps it like
                                      `shapes` */
    uint64_t deleted_count;
} fxs_scene_filter;

typedef struct fxs_scene_filter_report {
    uint64_t read, kept;
    uint64_t outside, faint;   /* numbers of Gaussians that the filter dropped by position and by opacity */
    uint64_t floaters;         /* number of Gaussians that the filter dropped for too few neighbours */
    fxs_pack_dropped dropped;  /* Gaussians that the filter dropped because its option `drawable` is 1 */
} fxs_scene_filter_report;

/* Initialises a filter that keeps every Gaussian. */
FXS_API void fxs_scene_filter_init(fxs_scene_filter *filter, uint32_t size);
#define fxs_scene_filter_init(filter) fxs_scene_filter_init(filter, (uint32_t)sizeof *(filter))

/* Attaches the filter to an open file. From then on, fxs_scene_file_read returns the kept Gaussians, and info->count
   and info->sh_degree describe them. The file is read once to count them, and is at its beginning when the function
   returns. `progress` may be null.

   A Gaussian of a moving scene is kept by position if its centre is inside at any time while it is visible. Its way is
   tested in steps of at most its largest sigma, but in at most 256 steps. Its opacity is the largest that it has.
   Floaters and the thing are found in still scenes only.

   A Gaussian is a floater if fewer than FXS_FLOATER_NEIGHBOURS other centres lie in the cube of 27 cells around it. The
   grid of cells goes through the origin. The width of a cell is the least power of two that is at least 4 times the
   Gaussian's largest sigma, but at least the width for the Gaussian of median size. So the neighbours of a large
   background Gaussian may be farther away than the neighbours of a small one, and fine detail needs no closer
   neighbours than the median Gaussian. The strengths:
   - 1: as described.
   - 2: for a Gaussian with an opacity below 0.9, the width is at most twice the width for the median Gaussian.
   - 3: for such a Gaussian, the width is the median Gaussian's.
   - 4: for every Gaussian, the width is the median Gaussian's.
   - 5: as 4; a Gaussian is also a floater if one of the two places one sigma from its centre along its longest axis has
     too few centres around it.
   For floaters, the file is read once more, and the filter holds 28 bytes a Gaussian, 60 during the search.

   Returns 0, or an error and a message; the caller must then close the file. Errors: as fxs_scene_file_read,
   FXS_ERR_FILE if no Gaussian is left, FXS_ERR_STOPPED by `progress`, FXS_ERR_ARGUMENT (degree, strength, shape),
   FXS_ERR_UNSUPPORTED (floaters or the thing of a moving scene), FXS_ERR_MEMORY. */
FXS_API int fxs_scene_file_filter(fxs_scene_file *file, const fxs_scene_filter *filter, fxs_scene_file_info *info,
                                  fxs_scene_filter_report *report, const fxs_progress *progress,
                                  fxs_message *message);

/* ---- Decimation -------------------------------------------------------------------------------------------------- */

/* Decimates a stream of Gaussians: merges neighbours until the target number is left. */

/* Reads an open file of a still scene from its start and merges Gaussians until `target` are left, 1 or more.
   fxs_drawable must accept every Gaussian of the file. From then on, fxs_scene_file_read returns the merged Gaussians,
   and info->count is their number. A scene of at most `target` Gaussians is unchanged.

   The two Gaussians of a pair are weighted by opacity times area. The merged position and covariance are the mean and
   the covariance of the pair as one distribution; dc and SH are weighted means. The merged opacity keeps the sum of
   opacity times area, but is at most 0.99, or the larger opacity of the two if that is higher. Each round pairs every
   Gaussian with the neighbour of least loss, among the nearest 16 in its chunk of 256. Then it merges the quarter of
   the pairs with the least loss, skipping a pair that shares a Gaussian with an earlier pair. The loss is Runnalls'
   bound (2007, "Kullback-Leibler approach to Gaussian mixture reduction") and the difference of the colours. The result
   is the same on every machine.

   Memory: 340 bytes a Gaussian, and 236 for each remaining Gaussian until the file is closed. `progress` may be null.
   Returns 0, or an error and a message; the caller must then close the file. Errors: as fxs_scene_file_read,
   FXS_ERR_STOPPED by `progress`, FXS_ERR_ARGUMENT (the target), FXS_ERR_MEMORY. */
FXS_API int fxs_scene_file_decimate(fxs_scene_file *file, uint64_t target, fxs_scene_file_info *info,
                                    const fxs_progress *progress, fxs_message *message);

/* ---- Writers ----------------------------------------------------------------------------------------------------- */

/* Writes Gaussians to a scene file. The format is given in the options, or found from the file's ending. Functions
   return 0, or an error and a message. One thread at a time may use a writer. */

typedef struct fxs_scene_writer fxs_scene_writer;

typedef struct fxs_scene_write_options {
    uint32_t size;
    uint64_t count;              /* exact number of Gaussians that will be written */
    int sh_degree;               /* SH degree to write, 0 to 3 */
    int antialiased;             /* 1: opacities were fitted with compensation for the renderer's dilation, a small blur
                                    of each Gaussian */
    float low[3], high[3];       /* bounds of the Gaussians' centres, for the header of a .glb; unused by other
                                    formats */
    int spz_version;             /* version of an .spz: 3 (gzip) or 4 (zstd); 0: 4 */
    const char *format;          /* name of a scene file format, such as "ply"; null: chosen by the path's ending */
    int spz_fine;                /* 1: an .spz gets SH in 8 bits instead of 5 and 4, and positions in all 24 bits */
    double origin[3];            /* origin of the Gaussians (fxs_scene_file_info), which is added to each position and
                                    to the bounds */
    fxs_time time;               /* time of a moving scene (fxs_scene_writer_put_moving); all 0: a still scene */
} fxs_scene_write_options;
FXS_INIT(fxs_scene_write_options)

/* Numbers of Gaussians with values that were clamped to the range of an .spz, by at least a step of the format. Axes
   too thin to be seen do not count. ln(scale) is clamped to -10 to 5.9375, dc to +-3.33, and SH to +-1 in steps of
   1/128. */
typedef struct fxs_spz_clamped {
    uint32_t position, scale, dc, sh;
    double reach;                /* range of positions in the .spz, scene units: a coordinate beyond +-reach is moved to
                                    +-reach */
} fxs_spz_clamped;

/* What a written scene file has lost. */
typedef struct fxs_scene_write_report {
    int lost_sh;                 /* highest SH degree that writing dropped, or 0 */
    int lost_antialiased;        /* 1: opacities compensate for the renderer's dilation (a small blur), but the format
                                    cannot record it */
    fxs_spz_clamped clamped;     /* clamped values of an .spz; all 0 for other formats */
    double moved;                /* largest distance in scene units between a position and its written value, if
                                    positions were rounded to floats far from 0; 0 if `origin` is 0, and for formats
                                    that can store the positions */
} fxs_scene_write_report;

/* Begins a scene file. A .ply is binary, with Inria's properties as floats and normals of 0; a comment marks an
   anti-aliased scene. A .glb has KHR_gaussian_splatting with floats. If options->origin is not 0, a .ply has x, y and z
   as doubles, a .glb a translated node, and a .csv more digits; other formats get the nearest floats.

   Until it is complete, the file has a temporary name next to `path` (system.h). fxs_scene_writer_close frees *writer,
   which is null after an error. A lod-meta.json creates folders next to it, 0_0 and so on; after an error, their new
   content is removed.

   Memory of a writer:
   - .ply, .splat, .glb, .csv: holds no Gaussians.
   - .spz: 44 bytes a Gaussian and 1 byte for each SH coefficient.
   - .compressed.ply, .sog: 56 bytes a Gaussian and 2 bytes for each SH coefficient; while closing up to twice that.
   - .rad, lod-meta.json: as .sog; while closing up to four times as much.
   - .splat4d: 168 bytes a Gaussian; while closing also 8, the compressed file, and the largest of its streams unpacked,
     up to 1 GiB.
   Errors: FXS_ERR_ARGUMENT (ending, degree, count, version), FXS_ERR_UNSUPPORTED if fixsplat was built without a
   library that the format needs, FXS_ERR_FILE, FXS_ERR_MEMORY. */
FXS_API int fxs_scene_writer_open(const char *path, const fxs_scene_write_options *options, fxs_scene_writer **writer,
                                  fxs_message *message);

/* Adds the next n Gaussians to a file; fxs_drawable must have accepted each. Errors: FXS_ERR_FILE, and FXS_ERR_ARGUMENT
   for more Gaussians than announced. */
FXS_API int fxs_scene_writer_put(fxs_scene_writer *writer, const fxs_gaussian *gaussians, size_t n,
                                 fxs_message *message);

/* Adds the next n Gaussians of a moving scene and how they move, one fxs_motion each, like fxs_scene_writer_put. Only
   for formats with fxs_scene_format.moves; the others return FXS_ERR_ARGUMENT. A .splat4d has frames at
   options->time.rate, or 30 a second, up to 1048576. Where a Gaussian does not exist, its opacity in the frame is 0. */
FXS_API int fxs_scene_writer_put_moving(fxs_scene_writer *writer, const fxs_gaussian *gaussians,
                                        const fxs_motion *motions, size_t n, fxs_message *message);

/* Completes a file under its final name, fills in *report and frees the writer. `writer`, `report` and `progress` may
   be null. Errors: FXS_ERR_FILE if a write failed, now or earlier, FXS_ERR_STOPPED by `progress`, FXS_ERR_ARGUMENT if
   Gaussians are missing, FXS_ERR_MEMORY. After an error the new file is removed, and an existing file of that name is
   unchanged. */
FXS_API int fxs_scene_writer_close(fxs_scene_writer *writer, fxs_scene_write_report *report,
                                   const fxs_progress *progress, fxs_message *message);

/* ---- .fxs files -------------------------------------------------------------------------------------------------- */

/* .fxs files: packed scenes (internal/packed.h) with their checksums filled in.

   The renderer reads such a file directly from a read-only mapping. The functions need no other library. Several
   threads may share a scene; only fxs_file_seal writes to it. */

/* Writes the packed scene of `bytes` bytes at `data` (aligned to 64) to a file, as system.h says: after an error, an
   existing file of that name is unchanged. Returns 0, or an error and a message: the error of fxs_scene_open if the
   data are not a packed scene, FXS_ERR_FILE, FXS_ERR_MEMORY. */
FXS_API int fxs_file_write(const char *path, const void *data, size_t bytes, fxs_message *message);

/* Fills in the checksums of a packed scene in memory, `bytes` bytes at `data` (aligned to 64), which then equals the
   content of an .fxs file. Returns 0, or the error of fxs_scene_open. */
FXS_API int fxs_file_seal(void *data, size_t bytes);

/* Checks the size and the header's checksum of an .fxs file of `bytes` bytes that was mapped or read to `data` (aligned
   to 64). With `all` it also checks the palette and every chunk, which reads the whole file. `path` is for the message.
   Returns 0, or an error and a message: FXS_ERR_FILE if the file is damaged, FXS_ERR_VERSION if it has another
   version. */
FXS_API int fxs_file_check(const char *path, const void *data, size_t bytes, int all, fxs_message *message);

#ifdef __cplusplus
}
#endif

#endif
