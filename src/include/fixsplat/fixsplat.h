/* fixsplat: renders 3D Gaussian splatting scenes in fixed point.
 *
 * A picture is a pure function of (objects, camera, options): the same bytes on every machine. The library allocates
 * nothing, opens no files and keeps no global state. The caller owns every buffer. Functions return 0 (or a count) on
 * success and a negative FXS_ERR_* otherwise; fxs_strerror describes the code.
 *
 * Threads: scenes, objects, cameras, options and contexts are read-only, so any number of threads may share them.
 * Several threads may render frames with one context at the same time if each frame has its own memory and targets, and
 * if the context's `run` is thread-safe (fxs_pool_run is). A context with a `draw` function renders one frame at a
 * time.
 *
 * Conventions: lengths are in units of the scene's file; with several objects, in world units. Camera axes: x right, y
 * down, z forward; pixel centres at +0.5. A name that ends in `_qN` is an integer that holds the real value times 2^N.
 *
 * Structs: a struct that a program fills in for the library begins with `size`, its size in bytes. Call the struct's
 * init function first; it sets `size` and the defaults. Then set the fields you need. Later versions append fields. The
 * library reads no further than `size` says, and uses the defaults for fields behind it. A size of 0 is FXS_ERR_STRUCT.
 * Structs that the
 * library fills in keep their size within 1.x; some have reserved bytes, which mean nothing yet. */
#ifndef FXS_FIXSPLAT_H
#define FXS_FIXSPLAT_H

#include <stddef.h>
#include <stdint.h>

/* Swift packages have no compiler options such as -ffp-contract=off. */
#ifdef FXS_SAME_FLAGS
#pragma STDC FP_CONTRACT OFF
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define FXS_VERSION_MAJOR 1
#define FXS_VERSION_MINOR 0
#define FXS_VERSION_PATCH 0
#define FXS_VERSION "1.0.0"
#define FXS_VERSION_NUMBER (FXS_VERSION_MAJOR * 10000 + FXS_VERSION_MINOR * 100 + FXS_VERSION_PATCH)

/* Marks a stable function: within 1.x it stays, and so do the fields of the structs that it takes. The shared library
   exports it and hides all others. A program that links the library statically into its own shared library may define
   FXS_API as nothing. */
#ifndef FXS_API
#if defined(__GNUC__)
#define FXS_API __attribute__((visibility("default")))
#else
#define FXS_API
#endif
#endif

/* Marks an experimental function: any later version may change or remove it. */
#define FXS_EXPERIMENTAL FXS_API

/* Marks a public function that the next major version will remove: the compiler warns and names the replacement.
   FXS_DEPRECATED("fxs_render") FXS_API int fxs_render_eyes(...); */
#ifndef FXS_DEPRECATED
#if defined(__GNUC__)
#define FXS_DEPRECATED(instead) __attribute__((deprecated("call " instead " in its place")))
#else
#define FXS_DEPRECATED(instead)
#endif
#endif

/* Zeroes a struct of `size` bytes and stores the size in its first field. */
FXS_API void fxs_struct_init(void *options, uint32_t size);

/* Declares the init function of an options struct with the default 0 in each field: void TYPE_init(TYPE *options). */
#define FXS_INIT(type) \
    static inline void type##_init(type *options) { fxs_struct_init(options, (uint32_t)sizeof *options); }

/* Returns FXS_VERSION_NUMBER of the linked library. The library suits programs that were built with the same major
   version and with the same or a lower minor version. */
FXS_API int fxs_version(void);

#define FXS_NOTHING UINT32_MAX       /* special value for "no Gaussian", "no depth" and "not in memory" */
#define FXS_MAX_SIZE 16384           /* largest width and height of a picture, pixels */
#define FXS_MAX_COUNT (1u << 30)     /* largest number of Gaussians in a scene, and in all objects of a frame (counted
                                        in whole chunks of 256) */
#define FXS_MAX_OBJECTS 65536u       /* per frame */
#define FXS_MAX_CROPS 8u             /* per object */

enum fxs_error {
    FXS_ERR_ARGUMENT = -1,      /* an argument is a null pointer, or an option is out of range */
    FXS_ERR_SCENE = -2,         /* the data are not a packed scene, or are truncated, damaged or changed during
                                   rendering */
    FXS_ERR_VERSION = -3,       /* the data are a packed scene of another version */
    FXS_ERR_CAMERA = -4,        /* a field of the camera is out of range: focal length not above 0, rotation not
                                   orthonormal, position beyond +-2^28 units, or near plane not 2^-20 to 2^28 units */
    FXS_ERR_SIZE = -5,          /* the picture's width or height is outside 1..FXS_MAX_SIZE; a cropped camera's window
                                   is outside the whole picture; or two eyes have different sizes or projections */
    FXS_ERR_MEMORY = -6,        /* too little working memory, or working memory not aligned to 64; or too little device
                                   memory */
    FXS_ERR_UNSUPPORTED = -7,   /* this build, machine or back end lacks a feature that the call needs */
    FXS_ERR_DEVICE = -8,        /* the device of a back end is missing, failed or was lost */
    FXS_ERR_OBJECT = -9,        /* a field of an object (a placed scene) is out of range, such as its rotation or scale;
                                   or the frame has too many objects */
    FXS_ERR_TARGET = -10,       /* a target (output picture) is missing, misaligned, overlaps another, has rows longer
                                   than its stride, or does not suit the format */
    FXS_ERR_FILE = -11,         /* a file is missing, cannot be read or written, or has the wrong content */
    FXS_ERR_STOPPED = -12,      /* a callback asked to stop: fxs_options.stop, or the progress callback of a long
                                   call */
    FXS_ERR_STRUCT = -13        /* the field `size` of an options struct is 0 or above 65535: the struct's init function
                                   was not called */
};

/* Describes an error code in one line. The string is static and never null. */
FXS_API const char *fxs_strerror(int error);

/* Why a call failed, as text for users. Functions outside the core fill it in when they return an error. */
typedef struct fxs_message {
    char text[512];                /* one line */
    uint64_t bytes_needed;         /* for FXS_ERR_MEMORY: number of bytes that would be enough, if known; else 0 */
    uint64_t reserved[3];
} fxs_message;

/* Callbacks that provide memory for reading and packing scenes. A null allocator stands for malloc and free. fxs_pack
   calls the functions from any thread of the pool, one call at a time. */
typedef struct fxs_allocator {
    void *(*allocate)(void *argument, size_t bytes);   /* returns a block of `bytes` bytes, 1 or more, aligned as by
                                                          malloc; null on failure */
    void (*release)(void *argument, void *block);      /* frees a block that `allocate` returned; the block is never
                                                          null */
    void *argument;                                    /* first argument of allocate and release */
} fxs_allocator;

/* ---- Scene ----------------------------------------------------------------------------------------------------- */

/* A packed scene (Gaussians as integer codes) as the renderer sees it. Its layout is in internal/packed.h. The struct
   points into the caller's bytes. */

enum fxs_profile {                 /* packed formats, and their bytes per Gaussian in a large scene of SH degree 3 */
    FXS_PROFILE_DEFAULT = 0,       /* 63.5 */
    FXS_PROFILE_COMPACT = 1,       /* 39.6 bytes: stores SH by a palette, with a residual of 3 bits */
    FXS_PROFILE_SMALL = 2          /* 19.6 bytes: stores SH by a palette, and all other numbers in 6 to 11 bits */
};

typedef struct fxs_scene {
    const unsigned char *chunks;      /* headers of the scene's chunks; a chunk has 256 slots, and a few slots hold no
                                         Gaussian */
    const unsigned char *rows;        /* rows (codes of the Gaussians) of all chunks, from the first chunk on; aligned
                                         to 64, like `chunks` */
    const int8_t *palette;            /* palette of SH coefficients; null: the scene has no palette */
    enum fxs_profile profile;
    uint32_t count;                   /* Gaussians */
    uint32_t chunk_count, chunk_bytes;
    uint32_t palette_entries, palette_step_q19;
    int sh_degree;                    /* SH degree of the scene, 0 to 3 */
    int antialiased;                  /* 1: opacities compensate for the dilation, a blur that the renderer adds to each
                                         Gaussian */
    const unsigned char *nodes;       /* the chunk_count - 1 nodes of the level-of-detail tree over the chunks; null: no
                                         tree */
    const unsigned char *node_chunks, *node_rows;   /* chunk headers and rows (codes) of the tree's coarse Gaussians;
                                                       aligned to 64 */

    /* Places of chunks, for programs that keep only a part of a scene's rows (Gaussian codes) in memory. Null after
       fxs_scene_open: all rows lie as in the file. `places` has one number for each chunk of the leaves, then one for
       each chunk of the nodes. The rows of chunk i start at `rows` + places[i] * chunk_bytes. FXS_NOTHING: the chunk is
       not in memory. In a scene with a tree its nearest ancestor in memory is drawn instead; otherwise the chunk is
       skipped. */
    const uint32_t *places;

    const unsigned char *motion;      /* when the chunks of a moving scene are drawn, and how their rows describe their
                                         motion; null: the scene is still */
} fxs_scene;

/* The time of a moving scene. All fields are 0 for a still scene. */
typedef struct fxs_motion_info {
    int64_t duration_q32;             /* seconds; a moving scene has the times 0 to its duration */
    int64_t rate_q32;                 /* frames a second of the source; 0: none, the motion is continuous */
    int loops;                        /* 1: after its duration the scene starts again; 0: it stops at its last moment */
    uint32_t most_chunks;             /* largest number of chunks of 256 Gaussians that are drawn at one time */
} fxs_motion_info;

/* Returns the time of an open scene. */
FXS_API fxs_motion_info fxs_scene_motion(const fxs_scene *scene);

/* Returns the number of slots for Gaussians, in whole chunks of 256, that a moving scene draws at a time in seconds; of
   a still scene all. */
FXS_API uint32_t fxs_scene_alive(const fxs_scene *scene, int64_t time_q32);

/* Checks `bytes` bytes of a packed scene at `data` (aligned to 64; memory, a mapped file or flash) and fills *scene.
   Nothing is copied: `data` must stay in place and unchanged while the scene is in use. If another program changes the
   bytes, as it can in a mapped file, a frame ends with FXS_ERR_SCENE or mixes old and new bytes; the renderer never
   reads or writes outside the caller's memory. The caller must prevent memory from vanishing (SIGBUS when a mapped file
   is truncated), or catch the signal as system.h does.
   Errors: FXS_ERR_ARGUMENT, FXS_ERR_SCENE, FXS_ERR_VERSION. */
FXS_API int fxs_scene_open(fxs_scene *scene, const void *data, size_t bytes);

/* ---- Objects --------------------------------------------------------------------------------------------------- */

/* A crop box in an object's own space: it keeps or drops the Gaussians with centres low <= x, y, z <= high. A low above
   its high is FXS_ERR_OBJECT. */
typedef struct fxs_crop {
    int64_t low_q32[3], high_q32[3];   /* corners of the crop box, in units of the object's scene */
    int outside;                   /* 0: the box keeps only Gaussians inside; 1: the box drops Gaussians inside */
} fxs_crop;

/* An object: a packed scene placed in the world, by world = translation + scale * rotation * position. SH are rotated
   too. With keeping crop boxes (outside = 0), only Gaussians in at least one of them are drawn. Gaussians in a dropping
   crop box (outside = 1) are never drawn. */
typedef struct fxs_object {
    uint32_t size;
    const fxs_scene *scene;        /* scene of the object; any number of objects may share it */
    int32_t rotation_q30[9];       /* rotation matrix from object to world, row by row */
    int64_t translation_q32[3];    /* position of the object's origin, world units, within +-2^28 */
    int64_t scale_q32;             /* size of the object's unit in world units, 2^-16 to 2^16 */
    uint32_t opacity_q16;          /* factor for all opacities of the object, 0 to 1 */
    uint32_t tint_q13[3];          /* factors for red, green and blue of the object, 0 to 4 */
    int visible;                   /* 0: the object is not drawn */
    uint32_t id;                   /* number of the object, chosen by the caller, for id targets and fxs_pick */
    const fxs_crop *crops;         /* crop boxes of the object; null: none */
    uint32_t crop_count;           /* number of crop boxes, 0 to FXS_MAX_CROPS */
    uint32_t unused;               /* 0: room for a field of a later version */
    int64_t time_q32;              /* of a moving scene: seconds that are added to the time of the options */
} fxs_object;

/* Initialises an object: its scene lies at the origin of the world, unscaled, visible, with id 0 and without crops. */
FXS_API void fxs_object_init(fxs_object *object, const fxs_scene *scene, uint32_t size);
#define fxs_object_init(object, scene) fxs_object_init(object, scene, (uint32_t)sizeof *(object))

/* ---- Camera and options ---------------------------------------------------------------------------------------- */

enum fxs_projection {
    FXS_PERSPECTIVE = 0,
    FXS_ORTHOGRAPHIC = 1           /* orthographic: rays are parallel to z, and fx, fy are pixels per unit. As in
                                      perspective, positions are exact to 2^-29 of the distance from the camera, so keep
                                      the camera close to the scene */
};

typedef struct fxs_camera {
    int32_t width, height;         /* size of the picture in pixels, 1 to FXS_MAX_SIZE */
    int32_t fx_q12, fy_q12;        /* focal lengths in pixels, above 0 */
    int32_t cx_q12, cy_q12;        /* principal point, in pixels from the picture's top left corner */
    int32_t rotation_q30[9];       /* rotation matrix from world to camera; its rows are the camera's x, y and z axes in
                                      the world */
    int64_t position_q32[3];       /* centre of the camera, world units, within +-2^28 */
    int64_t near_q32;              /* depth of the near plane, world units, 2^-20 to 2^28; 0: the default, 0.2 */
    enum fxs_projection projection;

    /* Cropping: the camera's picture may be a window of a larger picture. The fields are the size of the larger picture
       (whole_width, whole_height), and position of the window's first pixel in it. All 0: not cropped. The window has
       the same pixels as that part of the larger picture, except that Gaussians larger than 65536 pixels, or with a
       centre more than 65536 pixels outside, may differ in the last bit. With FXS_CUTOFF_SQUARE, whose cut-off depends
       on tiles, the pixels are the same only if whole_x and whole_y are multiples of 16. */
    int32_t whole_width, whole_height;
    int32_t whole_x, whole_y;
    int32_t reserved[8];           /* 0 */
} fxs_camera;

/* Initialises a camera: at the origin, looking along z, with a horizontal field of view of 90 degrees. */
FXS_API void fxs_camera_init(fxs_camera *camera, int32_t width, int32_t height);

enum fxs_cutoff {
    FXS_CUTOFF_MAHALANOBIS = 0,    /* cut-off by distance: a Gaussian covers pixels up to a Mahalanobis distance of 3
                                      from its centre */
    FXS_CUTOFF_SQUARE = 1          /* cut-off by tiles: a Gaussian covers the tiles of 16x16 pixels that a square around
                                      its centre touches, with sides of 6 sigma_max (Kerbl et al. 2023) */
};

/* A callback that may end a frame early: it returns nonzero, and the frame ends with FXS_ERR_STOPPED. The renderer
   calls it every 4096 Gaussians and every macro tile of 32x32 pixels, from all rendering threads concurrently, so it
   must be quick and thread-safe. A GPU back end calls it once before each frame, or before each window of a frame that
   it divides. */
typedef int fxs_stop_fn(void *argument);

typedef struct fxs_stop {
    fxs_stop_fn *call;             /* the stop callback; null: every frame is finished */
    void *argument;                /* first argument of the stop callback `call` */
} fxs_stop;

/* A callback for each chunk (256 Gaussians) that a frame wants to draw, if only a part of the scene's rows is in memory
   (fxs_scene.places). `there`: 1 if the chunk's rows are in memory. The callback must not change `places`. */
typedef void fxs_want_fn(void *argument, const fxs_scene *scene, uint32_t chunk, int there);

typedef struct fxs_want {
    fxs_want_fn *call;             /* the callback for wanted chunks; null: none */
    void *argument;                /* first argument of the callback `call` */
} fxs_want;

typedef struct fxs_options {
    uint32_t size;
    enum fxs_cutoff cutoff;
    int sh_degree;                 /* highest SH degree to evaluate, 0 to 3; limited by the scene's degree */
    uint8_t background[3];         /* background colour: red, green, blue */
    fxs_stop stop;

    /* Level of detail, for scenes with a tree (internal/packed.h): a coarse chunk of Gaussians replaces all chunks
       below it. With `budget` and `detail_q8` both 0, the finest Gaussians are drawn, as in scenes without a tree. */
    uint32_t budget;               /* most Gaussians to draw, counted in whole chunks of 256; 0: no limit. The root of
                                      each tree and objects without a tree are always drawn, even beyond the budget */
    uint32_t detail_q8;            /* smallest size of details, pixels: a tree node with smaller details is drawn
                                      instead of its children; 0: no limit */
    fxs_want want;                 /* callback for scenes that are partly in memory (`places`): called for each chunk to
                                      be drawn, most important first, before drawing starts, on the thread that called
                                      fxs_render */
    int show_levels;               /* debug view of the levels of detail: 1 gives each Gaussian the colour of its
                                      chunk's level, with the Gaussian's own brightness; leaves are white. Processor
                                      only; other back ends ignore it */
    uint32_t unused;               /* 0: room for a field of a later version */
    int64_t time_q32;              /* the moment of moving scenes, seconds. A scene that loops takes it modulo its
                                      duration; others stop at their first and last moment. Still scenes ignore it */
} fxs_options;

/* Initialises rendering options: Mahalanobis cut-off, SH degree 3, black background, no stop callback, no budget. */
FXS_API void fxs_options_init(fxs_options *options, uint32_t size);
#define fxs_options_init(options) fxs_options_init(options, (uint32_t)sizeof *(options))

/* ---- Targets --------------------------------------------------------------------------------------------------- */

enum fxs_format {
    FXS_FORMAT_RGBA8 = 0,          /* pixel of 4 bytes: red, green, blue, 255 */
    FXS_FORMAT_RGBA8_COVERAGE = 1, /* pixel of 4 bytes: red, green, blue times coverage, then coverage; no background */
    FXS_FORMAT_RGB565 = 2,         /* pixel of 2 bytes, low byte first: red in bits 15..11, green in 10..5, blue in
                                      4..0 */
    FXS_FORMAT_RGBA16_COVERAGE = 3, /* pixel of 4 uint16_t: as FXS_FORMAT_RGBA8_COVERAGE, with a largest value of
                                       65535 */
    FXS_FORMAT_BGRA8 = 4,          /* pixel of 4 bytes: blue, green, red, 255. Processor only, else
                                      FXS_ERR_UNSUPPORTED */
    FXS_FORMAT_RGB565_SWAPPED = 5  /* pixel of 2 bytes as FXS_FORMAT_RGB565, but high byte first. Processor only, else
                                      FXS_ERR_UNSUPPORTED */
};

/* A picture in the caller's memory, of the camera's size. `pixels` is the top left pixel. `stride` is the number of
   bytes from row to row, at least a row's size (negative: bottom up). If the pixels are uint16_t, uint32_t or fxs_id,
   the address and the stride are multiples of 2, 4 and 4 bytes. */
typedef struct fxs_image {
    void *pixels;                  /* address of the picture; null: the picture is not wanted */
    ptrdiff_t stride;
} fxs_image;

/* A pixel of an id target, 8 bytes. Both fields are FXS_NOTHING if no Gaussian contributes. */
typedef struct fxs_id {
    uint32_t object;               /* id of the object that the pixel shows */
    uint32_t gaussian;             /* slot (place in the packed scene) of the Gaussian that the pixel shows; in a scene
                                      without empty slots the Gaussian's number. An empty slot appears only if a damaged
                                      scene has codes there. From 256 * chunk_count on: a coarse Gaussian of the
                                      level-of-detail tree */
} fxs_id;

/* Outputs of a frame: colour and auxiliary outputs (coverage, depths, ids), any subset, in one pass. Unused outputs
 * cost nothing.
 *
 * Depths are distances along the camera's z axis in world units, stored as uint32_t times 2^depth_bits (0: 16). With 16
 * bits, the range is 0 to 65,535 units in steps of 15 millionths. Depths saturate at 2^32 - 2. A pixel without a depth
 * has FXS_NOTHING, 2^32 - 1. The depth of a Gaussian is the depth of its centre.
 *   mean     mean over the Gaussians at the pixel, weighted by their contributions. Haze in front of a wall pulls the
 *            depth forward by the haze's share. A pixel without contributions has no depth.
 *   median   depth of the Gaussian at which the transmittance falls below 1/2. Haze in front of a wall does not show if
 *            it takes less than half of the light. A pixel with a transmittance of 1/2 or more has no depth. */
typedef struct fxs_targets {
    uint32_t size;
    fxs_image colour;
    enum fxs_format format;        /* of colour */
    fxs_image coverage;            /* output of coverage, uint8_t: 255 times the light that the Gaussians absorb */
    fxs_image mean_depth;          /* uint32_t */
    fxs_image median_depth;        /* uint32_t */
    fxs_image id;                  /* output of ids, fxs_id: the Gaussian with the largest contribution to the pixel; of
                                      equal ones, the nearest */
    int depth_bits;                /* fraction bits of both depth targets and of the occluder, 1 to 28; 0: 16 */

    /* Inputs of a frame: pictures that the caller has drawn. */
    fxs_image occluder;            /* input of depths, uint32_t: the depth of a surface at each pixel; a Gaussian behind
                                      the surface adds nothing to the pixel */
    fxs_image backdrop;            /* input picture that replaces the background: RGBA8, alpha ignored. Not allowed for
                                      formats with coverage. May be the colour target if its format is RGBA8 */
    fxs_image rates;               /* input map of rates, uint8_t for each macro tile of 32x32 pixels, (width + 31) / 32
                                      a row: 1, 2 or 4. In a macro tile with rate r, the Gaussians at pixel (r / 2, r /
                                      2) of each block of r x r pixels fill the block: colours, coverage, depths and id.
                                      A backdrop keeps its own pixels. At the right and lower edge, a rate is halved
                                      while it does not divide the picture's width and height. Null: 1. Experimental.
                                      FXS_CUTOFF_SQUARE has no rates (FXS_ERR_TARGET) */
} fxs_targets;

/* Initialises the targets of a frame: no picture is wanted, and the colour format is RGBA8. */
FXS_API void fxs_targets_init(fxs_targets *targets, uint32_t size);
#define fxs_targets_init(targets) fxs_targets_init(targets, (uint32_t)sizeof *(targets))

/* ---- Context --------------------------------------------------------------------------------------------------- */

/* A function that runs job(argument, i) for every i in 0..jobs-1, in any order, on any threads. It returns when all
   jobs are done. */
typedef void fxs_run_fn(void *pool, void (*job)(void *argument, uint32_t i), void *argument, uint32_t jobs);

/* Who runs the library's parallel jobs. The result of its functions does not depend on it. */
typedef struct fxs_workers {
    fxs_run_fn *run;               /* function that runs jobs; null: the calling thread runs one job after the other */
    void *pool;                    /* first argument of the function `run` */
    uint32_t count;                /* number of threads that `run` uses, 1 to 64; 0: 1 */
} fxs_workers;

/* A clock function: returns nanoseconds of a clock that never goes back. */
typedef uint64_t fxs_clock_fn(void *clock);

/* A function that draws a run of tiles (internal/stage.h) in place of the stages blend and resolve, on the thread that
   called fxs_render. Returns 0, or an FXS_ERR_* that ends the frame and that fxs_render returns. */
struct fxs_tile_run;
typedef int fxs_draw_fn(void *argument, const struct fxs_tile_run *run);

typedef struct fxs_config {
    uint32_t size;
    fxs_workers workers;
    fxs_clock_fn *clock;           /* clock for stage times; null: stage times are reported as 0 */
    void *clock_argument;
    fxs_draw_fn *draw;             /* function that draws tiles, such as a back end's; null: the library's own stages
                                      blend and resolve */
    void *draw_argument;
    int draw_blended;              /* 1: the function `draw` expects all tiles row by row. It also accepts tiles that
                                      the kernels have blended (fxs_tile_run.blended), which it only resolves (converts
                                      to pixels) */
    int draw_unlisted;             /* 1: the function `draw` needs no tile lists; it is called once per band (some rows
                                      of tiles) of a frame */
    const struct fxs_kernels *kernels;   /* versions of the rendering stages; null: plain C. internal/kernels.h makes a
                                            table of the fastest versions for a processor. The table must stay valid */
} fxs_config;
FXS_INIT(fxs_config)

enum fxs_stage { FXS_PROJECT, FXS_SHADE, FXS_SORT, FXS_BIN, FXS_BLEND, FXS_RESOLVE, FXS_STAGES };

/* Returns the name of a rendering stage: "project", "shade", ... */
FXS_API const char *fxs_stage_name(enum fxs_stage stage);

/* A context: a configuration that is ready for rendering. Its fields are the library's; the struct keeps its size
   within 1.x. */
typedef struct fxs_context {
    fxs_config config;
    void *reserved[8];
} fxs_context;

/* Fills in a context. `config` may be null: one thread, no clock. Errors: FXS_ERR_ARGUMENT, FXS_ERR_STRUCT. */
FXS_API int fxs_context_init(fxs_context *context, const fxs_config *config);

/* ---- Frame ----------------------------------------------------------------------------------------------------- */

/* The working memory of a frame by use, in bytes. */
typedef struct fxs_frame_memory {
    size_t splats;                 /* projected Gaussians: 72 bytes each; 424 per object */
    size_t tiles;                  /* tiles of 16x16 pixels: 17 bytes each, plus 1 per thread */
    size_t entries;                /* lists of macro tiles of 2x2 tiles, 8 bytes an entry */
    size_t keys;                   /* room to sort the lists, as large as `entries`; with draw_unlisted plus 8 KiB a
                                      thread */
    size_t total;                  /* sum of the four fields above */
    size_t least;                  /* smallest sufficient memory; with less, fxs_render returns FXS_ERR_MEMORY */
    size_t rows;                   /* memory that the fullest tile row of this view needs. With less, tile rows are
                                      drawn in slices (from near to far). 0 if all splats fitted at once */
} fxs_frame_memory;

typedef struct fxs_stats {
    uint32_t gaussians;            /* number of Gaussians in all objects */
    uint32_t drawn;                /* number of Gaussians in the drawn chunks, in whole chunks of 256. With a budget at
                                      most the budget, except that a chunk of each tree and all objects without a tree
                                      are always drawn */
    uint32_t missing;              /* number of wanted chunks that were not in memory; 0: the picture is complete */
    uint32_t visible;              /* number of Gaussians left after culling. If a GPU back end divides the frame into
                                      windows, the sum over all windows; so too `entries` */
    uint64_t entries;              /* number of entries in the tiles' lists of Gaussians */
    uint32_t bands;                /* number of bands (groups of tile rows drawn one after the other), or of a GPU back
                                      end's windows; 1 if all splats fitted into the memory */
    uint32_t slices;               /* number of slices (depth ranges of one tile row) that were drawn for rows that did
                                      not fit into the memory; 0 if all did */
    uint32_t runs;                 /* number of runs (groups of tiles drawn together): one per band or slice if all its
                                      lists fitted */
    fxs_frame_memory memory;       /* memory of the frame's last band of tile rows; `least` is exact for this view, or 0
                                      if the whole frame fitted */
    uint64_t nanoseconds[FXS_STAGES];   /* wall time of each rendering stage. Blend and resolve run together; their wall
                                           time is divided in proportion to the threads' time in each */
    uint64_t frame_nanoseconds;
    uint64_t reserved[4];
} fxs_stats;

/* A request: what to render, as one frame or as a stereo pair. */
typedef struct fxs_request {
    uint32_t size;
    uint32_t count;                /* number of objects, 0 to FXS_MAX_OBJECTS */
    const fxs_object *objects;     /* array of objects, owned by the caller; all have the same value in their field
                                      `size` */
    uint32_t eyes;                 /* number of eyes: 1, or 2 for left and right */
    fxs_camera cameras[2];         /* cameras, one per eye */
    fxs_targets targets[2];
    fxs_options options;
} fxs_request;

/* Initialises a request for one eye, with the values of fxs_options_init and fxs_targets_init, and with cameras that
   are all 0. */
static inline void fxs_request_init(fxs_request *request, const fxs_object *objects, uint32_t count)
{
    fxs_struct_init(request, (uint32_t)sizeof *request);
    request->objects = objects;
    request->count = count;
    request->eyes = 1;
    fxs_targets_init(&request->targets[0]);
    fxs_targets_init(&request->targets[1]);
    fxs_options_init(&request->options);
}

/* Renders a request. All objects are sorted together by depth; ties go by object, then by Gaussian. A single object
   from fxs_object_init gives the picture of the scene itself. Gaussians whose centre is not beyond the near plane are
   culled.
   `memory`: `memory_bytes` bytes, aligned to 64. Its content does not matter before the call and is undefined after.
   The size that fxs_request_bytes returns is always enough. FXS_ERR_MEMORY has two causes; in both, stats->memory.least
   is a sufficient size for this number of threads:
   - `memory_bytes` is below the `least` of fxs_request_bytes. stats has that value, although this view may need more.
   - A tile row of this view does not fit and cannot be drawn in slices, because of depths, ids, an occluder or the back
     end. stats has the exact size.
   stats->memory.least is 0 if `memory` is misaligned or no size_t is enough.
   Targets: at least one is required, except with config.draw, which gets the targets passed on. The bytes between the
   end of a row and the next row are not written. *stats may be null.

   Stereo: each eye is byte for byte the mono frame of its camera. With a budget or a detail, both eyes draw the same
   chunks, which are chosen once for both. The eyes are rendered one after the other in the same memory. Both cameras
   must have the same size and projection; their fields of view and principal points may differ, as in a headset. A
   target that is written must not overlap another target or input. *stats has sums over both eyes, except for
   `gaussians`, `drawn` (one eye) and `memory`.

   Errors that leave the targets untouched: FXS_ERR_ARGUMENT, FXS_ERR_CAMERA, FXS_ERR_SIZE, FXS_ERR_OBJECT (also if the
   camera is more than 2^28 of an object's units from that object's origin), FXS_ERR_TARGET, FXS_ERR_MEMORY.
   Errors that may leave a part of the pixels written: FXS_ERR_SCENE, FXS_ERR_STOPPED, and a back end's errors. */
FXS_API int fxs_render(const fxs_context *context, const fxs_request *request, void *memory, size_t memory_bytes,
                       fxs_stats *stats);

/* Returns the working memory of a request in bytes: memory->total. With it the frame is rendered in one pass, for every
   camera and placement: the memory holds a splat (a projected Gaussian) for every Gaussian of every object, or with a
   budget for as many as the budget allows. With less, but at least memory->least, the picture has the same bytes and
   takes longer. (`least` is about 45 KB with one thread, or 200 KB a thread with several; plus 24 bytes a chunk of 256
   Gaussians, the objects and the tiles.)
     Bands   An extra pass projects every Gaussian and counts the splats on each row of tiles. Then the frame is
             rendered in bands, each with as many rows as fit: 88 bytes for each Gaussian that touches the band.
     Slices  A row of tiles that does not fit alone is drawn in slices: the nearest splats that fit, then the next ones.
             The time grows with the square of the number of slices. Slices support colour and coverage only; a back end
             needs `draw_blended`. Otherwise the frame ends with FXS_ERR_MEMORY.
   *memory may be null. Returns 0 if an argument is out of range or the memory exceeds a size_t. */
FXS_API size_t fxs_request_bytes(const fxs_context *context, const fxs_request *request, fxs_frame_memory *memory);

/* The Gaussian at a pixel, as found by fxs_pick. */
typedef struct fxs_pick_result {
    uint32_t object;               /* index of the Gaussian's object in the request's `objects` */
    uint32_t gaussian;             /* slot (place in the packed scene) of the Gaussian with the largest contribution, as
                                      in fxs_id */
    uint32_t id;                   /* id of the Gaussian's object, as the caller chose it */
    int64_t depth_q32;             /* depth of the Gaussian's centre along the camera's z axis; saturates at 2^28
                                      units */
    int64_t position_q32[3];       /* world position of the point on the pixel's ray at the depth of the Gaussian's
                                      centre; its offsets from the camera's axis saturate at +-2^28 */
    uint64_t reserved[4];
} fxs_pick_result;

/* Finds the Gaussian that fxs_render shows at pixel (x, y) of the first eye, as in its id target. Of the targets it
   reads only the occluder and depth_bits. It projects the whole frame but blends only one tile. Returns 1, 0 if no
   Gaussian contributes, or an error as fxs_render. */
FXS_API int fxs_pick(const fxs_context *context, const fxs_request *request, int32_t x, int32_t y, void *memory,
                     size_t memory_bytes, fxs_pick_result *result);

#ifdef __cplusplus
}
#endif

#endif
