/* fixsplat: renders 3D Gaussian splatting scenes in fixed point.
 *
 * A picture is a pure function of (objects, camera, options): the same bytes on every machine. The library allocates
 * nothing, opens nothing and keeps no global state. Every buffer belongs to the caller. Functions return 0 (or a count)
 * on success and a negative FXS_ERR_* otherwise; fxs_strerror gives the words.
 *
 * Threads: scenes, objects, cameras, options and a context are only read, so any number of threads may share them.
 * Frames may be rendered at the same time by one context where each has memory and targets of its own and the
 * context's `run` may be called by several threads (fxs_pool_run of the port may). A context whose `draw` is a back end
 * renders one frame at a time.
 *
 * Conventions: units are those of the scene's file, or the world's where there are objects. Camera axes: x right, y
 * down, z forward; pixel centres at +0.5. `_qN` in a name says that the integer is the real value times 2^N.
 *
 * Stable from version 1.0 on, as are the other headers that say so: within 1.x their functions stay, and structs that a
 * program allocates keep their size and the meaning of their fields. Fill a struct by its init function first, where it
 * has one, then set what you need. */
#ifndef FXS_FIXSPLAT_H
#define FXS_FIXSPLAT_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define FXS_VERSION_MAJOR 1
#define FXS_VERSION_MINOR 0
#define FXS_VERSION_PATCH 0
#define FXS_VERSION "1.0.0-rc1"
#define FXS_VERSION_NUMBER (FXS_VERSION_MAJOR * 10000 + FXS_VERSION_MINOR * 100 + FXS_VERSION_PATCH)

/* Before a public function: the shared library shows it, and hides its other functions. A program that takes the
   library into one of its own may define FXS_API as nothing. */
#ifndef FXS_API
#if defined(__GNUC__)
#define FXS_API __attribute__((visibility("default")))
#else
#define FXS_API
#endif
#endif

/* Before a public function that the next major version will not have: the compiler warns, and says what to call.
   FXS_DEPRECATED("fxs_render") FXS_API int fxs_render_eyes(...); */
#ifndef FXS_DEPRECATED
#if defined(__GNUC__)
#define FXS_DEPRECATED(instead) __attribute__((deprecated("call " instead " in its place")))
#else
#define FXS_DEPRECATED(instead)
#endif
#endif

/* FXS_VERSION_NUMBER of the library that is linked. A program that was built with the same major number, and a minor
   one that is no higher, goes with it. */
FXS_API int fxs_version(void);

#define FXS_NOTHING UINT32_MAX       /* no Gaussian, no depth, no place */
#define FXS_MAX_SIZE 16384           /* pixels, width and height of a picture */
#define FXS_MAX_COUNT (1u << 30)     /* Gaussians in a scene, and in all objects of a frame (in whole chunks of 256) */
#define FXS_MAX_OBJECTS 65536u       /* in a frame */
#define FXS_MAX_CROPS 8u             /* of an object */

enum fxs_error {
    FXS_ERR_ARGUMENT = -1,      /* a null pointer, or an option outside its range */
    FXS_ERR_SCENE = -2,         /* not a packed scene, or one cut short, damaged or changed while it was rendered */
    FXS_ERR_VERSION = -3,       /* a packed scene of another version */
    FXS_ERR_CAMERA = -4,        /* focal length not above 0, rotation not orthonormal, position beyond +-2^28 units,
                                   near plane out of range */
    FXS_ERR_SIZE = -5,          /* width or height outside 1..FXS_MAX_SIZE; a window or a hidden part
                                   outside its picture; two eyes of other sizes or projections */
    FXS_ERR_MEMORY = -6,        /* too little memory: the working memory given (or not aligned to 64), or a device's */
    FXS_ERR_UNSUPPORTED = -7,   /* something that this build, machine or back end does not have */
    FXS_ERR_DEVICE = -8,        /* a back end's device is missing, failed or was lost */
    FXS_ERR_OBJECT = -9,        /* an object's rotation, scale or another of its fields is out of range, or there are
                                   too many */
    FXS_ERR_TARGET = -10,       /* a target that is missing or not aligned, whose rows are longer than its stride, that
                                   overlaps another, or that the format does not allow */
    FXS_ERR_FILE = -11,         /* a file that is missing, cannot be read or written, or is not what it should be */
    FXS_ERR_STOPPED = -12       /* a function of the caller's said so: fxs_options.stop, progress of long calls */
};

/* The words for an error code: one line, static, never null. */
FXS_API const char *fxs_strerror(int error);

/* Why a call failed, for people: functions outside the core fill it in beside their error code. */
typedef struct fxs_message {
    char text[512];                /* one line */
    uint64_t bytes_needed;         /* with FXS_ERR_MEMORY, where it is known: the memory that would do; else 0 */
} fxs_message;

/* ---- Scene ----------------------------------------------------------------------------------------------------- */

/* A packed scene (packed.h has its layout), as seen by the renderer: it points into the caller's bytes. */

enum fxs_profile {                 /* at SH degree 3, of a large scene: */
    FXS_PROFILE_DEFAULT = 0,       /* 63.5 bytes a Gaussian */
    FXS_PROFILE_COMPACT = 1,       /* 39.6: SH by a palette and what is left of it in 3 bits */
    FXS_PROFILE_SMALL = 2          /* 19.6: SH by a palette, the rest in 6 to 11 bits */
};

typedef struct fxs_scene {
    const unsigned char *chunks;      /* headers of chunks of 256 slots, a few without a Gaussian */
    const unsigned char *rows;        /* of the first chunk; both aligned to 64 */
    const int8_t *palette;            /* null without one */
    enum fxs_profile profile;
    uint32_t count;                   /* Gaussians */
    uint32_t chunk_count, chunk_bytes;
    uint32_t palette_entries, palette_step_q19;
    int sh_degree;                    /* 0 to 3 */
    int antialiased;                  /* 1: the opacity is compensated for the dilation */
    const unsigned char *nodes;       /* chunk_count - 1 nodes of the tree over the chunks; null without a tree */
    const unsigned char *node_chunks, *node_rows;   /* of their chunks; aligned to 64 */

    /* Set by a program that keeps a part of the rows in memory: for each chunk, the leaves and then the nodes', the
       place of its rows, which are `rows` + places[chunk] * chunk_bytes; FXS_NOTHING where they are not there. A chunk
       that is not there is not drawn: of a tree, the nearest chunk above it that is there takes its place. Null after
       fxs_scene_open: all rows lie where they are in the file. */
    const uint32_t *places;
} fxs_scene;


/* Bytes of a packed scene of `count` Gaussians with SH of degree `sh_degree`, and `palette_entries` (0 to 128) in each
   stage of its palette; 0 where any is out of range. */
FXS_API size_t fxs_scene_bytes(uint32_t count, int sh_degree, enum fxs_profile profile, uint32_t palette_entries);

/* Bytes of the tree over so many chunks, which follows them in the packed scene; 0 where there are fewer than two
   chunks, or it would be more than a size_t can count. */
FXS_API size_t fxs_tree_bytes(uint32_t chunks, int sh_degree, enum fxs_profile profile);

/* Checks `bytes` bytes of a packed scene at `data` (aligned to 64; memory, a mapped file or flash) and fills *scene.
   `data` must stay in place and unchanged as long as the scene is used; nothing is copied. Where another program
   changes the bytes nevertheless, as in a mapped file, a frame ends with FXS_ERR_SCENE or shows a mixture of the old
   and the new bytes; in no case is anything read or written beyond the caller's memory. Memory that goes away (a mapped
   file that is cut short: SIGBUS) is for the caller to prevent, or to catch as map.h does.
   Errors: FXS_ERR_ARGUMENT, FXS_ERR_SCENE, FXS_ERR_VERSION. */
FXS_API int fxs_scene_open(fxs_scene *scene, const void *data, size_t bytes);

/* Where the parts of a packed scene lie, in bytes from its beginning: what comes before the rows (headers of chunks,
   palette) is its head, `rows` bytes; what comes before the rows of its nodes is the head of its tree, from `tree` to
   `node_rows`. Without a tree the last four are equal. */
typedef struct fxs_scene_parts {
    uint64_t palette, rows, tree, node_chunks, node_rows, bytes;
} fxs_scene_parts;

/* Finds them by the header of a packed scene, its first 192 bytes, wherever the rest is. Errors as fxs_scene_open. */
FXS_API int fxs_scene_find_parts(fxs_scene_parts *parts, const void *header);

/* fxs_scene_open of a scene of which only the heads are in memory, both aligned to 64; tree may be null without one. It
   is for the caller to set places, and rows, before it is rendered. */
FXS_API int fxs_scene_open_parts(fxs_scene *scene, const void *head, const void *tree);

/* ---- Objects --------------------------------------------------------------------------------------------------- */

/* A box in the object's own space: low <= x, y, z <= high, for the centres of Gaussians. A low above its high is
   FXS_ERR_OBJECT. */
typedef struct fxs_crop {
    int64_t low_q32[3], high_q32[3];   /* the object's units */
    int outside;                   /* 0: keeps what is inside. 1: leaves out what is inside */
} fxs_crop;

/* A packed scene placed in the world: world = translation + scale * rotation * position. SH turn with it. Where there
   are crop boxes that keep what is inside, only Gaussians in at least one of them are drawn; Gaussians in a box that
   leaves out what is inside never are. */
typedef struct fxs_object {
    const fxs_scene *scene;        /* may be shared by any number of objects */
    int32_t rotation_q30[9];       /* object to world, by rows */
    int64_t translation_q32[3];    /* world units, within +-2^28 */
    int64_t scale_q32;             /* 2^-16 to 2^16 */
    uint32_t opacity_q16;          /* factor, 0 to 1 */
    uint32_t tint_q13[3];          /* factor of red, green, blue, 0 to 4 */
    int visible;                   /* 0: not drawn */
    uint32_t id;                   /* the caller's, for id targets and fxs_pick */
    const fxs_crop *crops;         /* null where there are none */
    uint32_t crop_count;           /* 0 to FXS_MAX_CROPS */
} fxs_object;

/* The scene as it is, at the origin of the world: visible, id 0, no crop. */
FXS_API void fxs_object_init(fxs_object *object, const fxs_scene *scene);

/* ---- Camera and options ---------------------------------------------------------------------------------------- */

enum fxs_projection {
    FXS_PERSPECTIVE = 0,
    FXS_ORTHOGRAPHIC = 1           /* parallel rays along z: fx, fy are pixels a unit. As in perspective, positions are
                                      exact to 2^-29 of the distance from the camera, so it should not be far above */
};

typedef struct fxs_camera {
    int32_t width, height;         /* pixels, 1 to FXS_MAX_SIZE */
    int32_t fx_q12, fy_q12;        /* focal lengths, pixels; above 0 */
    int32_t cx_q12, cy_q12;        /* principal point, pixels from the top left corner */
    int32_t rotation_q30[9];       /* world to camera, rows: the camera's x, y and z axes in the world */
    int64_t position_q32[3];       /* the camera's centre, world units, within +-2^28 */
    int64_t near_q32;              /* depth of the near plane, world units, 2^-20 to 2^28; 0: 0.2 */
    enum fxs_projection projection;

    /* Where the picture is a window of a larger one, the whole: the size of the whole, and which of its pixels is the
       window's first; else 0. The window has the same pixels as that part of the whole, but for the last bit of
       Gaussians of more than 65536 pixels, or with a centre so far out; with FXS_CUTOFF_SQUARE only where whole_x and
       whole_y are multiples of 16, as its tiles are not those of the whole otherwise. */
    int32_t whole_width, whole_height;
    int32_t whole_x, whole_y;

    /* A part of the picture that nobody will see; width and height 0 where there is none. Its pixels may lack some of
       the Gaussians that touch no pixel outside of it. */
    int32_t hidden_x, hidden_y;
    int32_t hidden_width, hidden_height;
} fxs_camera;

/* A camera at the origin that looks along z, with a field of view of 90 degrees across the width. */
FXS_API void fxs_camera_init(fxs_camera *camera, int32_t width, int32_t height);

enum fxs_cutoff {
    FXS_CUTOFF_MAHALANOBIS = 0,    /* a Gaussian touches a pixel where its Mahalanobis distance is at most 3 */
    FXS_CUTOFF_SQUARE = 1          /* where its tile of 16x16 pixels is touched by a square of side 6 sigma_max about
                                      the Gaussian's centre, as in Kerbl et al. 2023 */
};

/* Returns not 0 where the frame is to end early, with FXS_ERR_STOPPED. It is asked every 4096 Gaussians and every macro
   tile of 32x32 pixels, on any thread that renders and on several at once, so it should be quick; before a GPU is given
   a frame, it is asked once. */
typedef int fxs_stop_fn(void *argument);

/* Is told of a chunk that a frame is to draw, of a scene of which a part is in memory (fxs_scene.places): whether its
   rows are there. It must not change `places`. */
typedef void fxs_want_fn(void *argument, const fxs_scene *scene, uint32_t chunk, int there);

typedef struct fxs_options {
    enum fxs_cutoff cutoff;
    int sh_degree;                 /* highest degree evaluated, 0 to 3; the scene's own where that is lower */
    uint8_t background[3];         /* r g b */
    fxs_stop_fn *stop;             /* null: a frame is always finished */
    void *stop_argument;

    /* Of scenes with a tree (packed.h), which chunks are drawn: coarse ones stand for all that lie below them. Both
       limits are 0 where there is none; then the leaves are drawn, as of scenes without a tree. */
    uint32_t budget;               /* Gaussians, in whole chunks of 256; with as many as all objects have there is no
                                      limit. Drawn even beyond it: the root of each tree, and objects without one */
    uint32_t detail_q8;            /* pixels: what is smaller is not drawn more finely */
    int budget_of_window;          /* of a camera that is a window: not 0: the budget is for what it shows, without its
                                      hidden part. 0: for the whole picture, whose pixels the window has */
    fxs_want_fn *want;             /* called for each chunk of scenes with places, what is needed most first, before
                                      anything is drawn, on the thread that called fxs_render; null: nobody asks */
    void *want_argument;
    int show_levels;               /* 1, to look at the levels of detail: each Gaussian has the colour of its chunk's
                                      level, in the brightness that it has; leaves are white. By the processor's shade
                                      alone: elsewhere it changes nothing */
} fxs_options;

/* A fxs_stop_fn: stops the frame once the byte at `byte` is not 0, which another thread or a signal handler writes. */
FXS_API int fxs_stop_by_byte(void *byte);

/* Mahalanobis cut-off, SH degree 3, black background, no stop, no budget. */
FXS_API void fxs_options_init(fxs_options *options);

/* ---- Targets --------------------------------------------------------------------------------------------------- */

enum fxs_format {
    FXS_FORMAT_RGBA8 = 0,          /* 4 bytes a pixel: r, g, b, 255 */
    FXS_FORMAT_RGBA8_COVERAGE = 1, /* 4 bytes a pixel: r, g, b times coverage, coverage; no background */
    FXS_FORMAT_RGB565 = 2,         /* 2 bytes a pixel, the low one first: r in bits 15..11, g 10..5, b 4..0 */
    FXS_FORMAT_RGBA16_COVERAGE = 3, /* 4 uint16_t a pixel: as RGBA8_COVERAGE, times 65535 */
    FXS_FORMAT_BGRA8 = 4,          /* as RGBA8: b, g, r, 255. This and the next are the processor's alone: elsewhere */
    FXS_FORMAT_RGB565_SWAPPED = 5  /* FXS_ERR_UNSUPPORTED. As RGB565, the high byte first */
};

/* A picture of the caller's, as large as the camera's: rows of pixels, `stride` bytes from row to row, at least those
   of a row (negative: bottom up; pixels is the top left one). Both are multiples of the size of the pixel's numbers. */
typedef struct fxs_image {
    void *pixels;                  /* null: not asked for */
    ptrdiff_t stride;
} fxs_image;

/* What is seen at a pixel: 8 bytes of an id target. Both are FXS_NOTHING where no Gaussian adds anything. */
typedef struct fxs_id {
    uint32_t object;               /* the object's id */
    uint32_t gaussian;             /* its slot in the packed scene: without holes (packed.h), its number. A slot
                                      without a Gaussian only where a damaged scene has some that are not clear. From
                                      256 chunk_count on, a coarse Gaussian of the tree */
} fxs_id;

/* What a frame writes: the colour and auxiliary outputs (coverage, depths, ids), any set of them, in one pass. What is
 * not asked for costs nothing.
 *
 * Depths are distances along the camera's z axis, in the world's units, as uint32_t times 2^depth_bits (16, where that
 * is 0): with 16, 0 to 65,535 units in steps of 15 millionths. What is farther has 2^32 - 2; a pixel without a depth
 * has FXS_NOTHING, 2^32 - 1. The depth of a Gaussian is that of its centre.
 *   mean     of the Gaussians at the pixel, weighted by what each contributes. Haze before a wall draws it forward by
 *            the haze's share. A pixel that nothing contributes to has no depth.
 *   median   of the Gaussian at which half of the light is taken (the transmittance falls below 1/2). Haze that takes
 *            less than half before the wall does not show. A pixel that lets half of the light through has no depth. */
typedef struct fxs_targets {
    fxs_image colour;
    enum fxs_format format;        /* of colour */
    fxs_image coverage;            /* uint8_t: 255 times the light that the Gaussians take */
    fxs_image mean_depth;          /* uint32_t */
    fxs_image median_depth;        /* uint32_t */
    fxs_image id;                  /* fxs_id: of the largest contribution, the nearer of equal ones */
    int depth_bits;                /* 1 to 28, or 0 for 16; of the two depths and of the occluder */

    /* Read, for what the caller has drawn itself. */
    fxs_image occluder;            /* uint32_t: depths; a Gaussian that is farther adds nothing at that pixel */
    fxs_image backdrop;            /* RGBA8, alpha not read: in place of the background, so not with the formats of
                                      coverage; may be the colour target, where that is RGBA8 */
} fxs_targets;

/* No targets, format RGBA8. */
FXS_API void fxs_targets_init(fxs_targets *targets);

/* ---- Context --------------------------------------------------------------------------------------------------- */

/* Runs job(argument, i) for every i in 0..jobs-1, in any order, on any threads, and returns when all are done. */
typedef void fxs_run_fn(void *pool, void (*job)(void *argument, uint32_t i), void *argument, uint32_t jobs);

/* A clock in nanoseconds that never runs backwards. */
typedef uint64_t fxs_clock_fn(void *clock);

/* Draws a run of tiles (stage.h) in place of blend and resolve, on the thread that called fxs_render. Returns 0 or an
   FXS_ERR_*, which ends the frame and is returned by fxs_render. */
struct fxs_tile_run;
typedef int fxs_draw_fn(void *argument, const struct fxs_tile_run *run);

typedef struct fxs_config {
    fxs_run_fn *run;               /* null: one thread, the caller's */
    void *pool;                    /* first argument of run */
    uint32_t threads;              /* threads that run uses, 1 to 64; 0: 1. The picture does not depend on it */
    fxs_clock_fn *clock;           /* null: stage times are reported as 0 */
    void *clock_argument;
    fxs_draw_fn *draw;             /* null: the kernels' blend and resolve */
    void *draw_argument;
    int draw_blended;              /* 1: draw is given all tiles row by row, and also takes tiles that the kernels have
                                      blended (fxs_tile_run.blended), which it only resolves */
    int draw_unlisted;             /* 1: draw needs no tile lists, and is called once for each band of a frame */
} fxs_config;

enum fxs_stage { FXS_PROJECT, FXS_SHADE, FXS_SORT, FXS_BIN, FXS_BLEND, FXS_RESOLVE, FXS_STAGES };

/* The name of a stage: "project", "shade", ... */
FXS_API const char *fxs_stage_name(enum fxs_stage stage);

/* The function of each stage, on one chunk or one tile: stage.h says what they are given. fxs_init fills in the
   plain C versions; a faster one with the same results may take the place of any. */
struct fxs_view;
struct fxs_splat;
struct fxs_bounds;
struct fxs_box;
struct fxs_tile;
struct fxs_trace;
struct fxs_span;

typedef struct fxs_kernels {
    const char *name[FXS_STAGES];  /* version of each stage: "c", "avx2", ... */

    /* Projects the Gaussians of a chunk. Those that can touch a pixel are appended: splats (but for the colour),
       bounds, index in the scene (ascending), depth key. Returns their number, at most 256, or FXS_ERR_SCENE where the
       chunk's header is out of range: it was not when the scene was opened. */
    int32_t (*project)(const struct fxs_view *view, const fxs_scene *scene, uint32_t chunk, struct fxs_splat *splats,
                       struct fxs_bounds *bounds, uint32_t *indices, uint32_t *depths);

    /* Fills in the colour of `count` splats of one chunk; indices ascend. Returns 0, or FXS_ERR_SCENE like project. */
    int (*shade)(const struct fxs_view *view, const fxs_scene *scene, uint32_t chunk, const uint32_t *indices,
                 uint32_t count, struct fxs_splat *splats);

    /* Finds the tiles of `count` splats. */
    void (*bin)(const struct fxs_view *view, const struct fxs_splat *splats, const struct fxs_bounds *bounds,
                uint32_t count, struct fxs_box *boxes);

    /* The tile columns of a splat on tile rows `row` to row + rows - 1, which are rows of its bounding box. There is
       room for 15 more. */
    void (*spans)(const struct fxs_view *view, const struct fxs_splat *splat, const struct fxs_bounds *bounds,
                  int32_t row, int32_t rows, struct fxs_span *spans);

    /* For slots `first` to first + count - 1 each macro tile that they are listed in by their boxes (by slot), and
       slot << 4 | mask of its tiles; 9 a slot at most, and room for 15 more. Returns how many, in any order. */
    uint32_t (*note)(const struct fxs_view *view, const struct fxs_box *boxes, uint32_t first, uint32_t count,
                     uint32_t *macros, uint32_t *listed);

    /* Sorts `count` keys; `spare` has room for as many. Quick where those of one depth arrive
       almost in the order of their slots. */
    void (*sort)(uint64_t *keys, uint64_t *spare, uint32_t count);

    /* Slots of those of `count` keys of a macro tile that are listed in its tile 0 to 3; room for `count`. Returns how
       many. */
    uint32_t (*list)(const uint64_t *keys, uint32_t count, uint32_t tile, uint32_t *entries);

    /* Blends a list of splats, near to far, into a tile at pixel (x, y). */
    void (*blend)(const struct fxs_view *view, int32_t x, int32_t y, const struct fxs_splat *splats,
                  const uint32_t *entries, uint32_t count, struct fxs_tile *tile);

    /* blend with auxiliary outputs: besides the tile it fills in *trace, from which depths and ids are made. It takes a
       part of a list, from entry `first` to before `end`, which is at most 32767, and goes on from the state in which
       *tile and *trace are. depths_q15: a code for the depth of each entry of the part, where a mean depth is wanted;
       else it may be null. */
    void (*trace)(const struct fxs_view *view, int32_t x, int32_t y, const struct fxs_splat *splats,
                  const uint32_t *entries, const int16_t *depths_q15, uint32_t first, uint32_t end,
                  struct fxs_tile *tile, struct fxs_trace *trace);

    /* Writes `columns` x `rows` pixels of a tile, over the background of the options; of the first four formats, of
       which the others are made. */
    void (*resolve)(const fxs_options *options, enum fxs_format format, const struct fxs_tile *tile, int32_t columns,
                    int32_t rows, unsigned char *pixels, ptrdiff_t stride);
} fxs_kernels;

typedef struct fxs_context {
    fxs_config config;
    fxs_kernels kernels;
} fxs_context;

/* Fills *context with the plain C version of each stage. `config` may be null: one thread, no clock. */
FXS_API int fxs_init(fxs_context *context, const fxs_config *config);

/* ---- Frame ----------------------------------------------------------------------------------------------------- */

/* Where the working memory of a frame goes, in bytes. */
typedef struct fxs_frame_memory {
    size_t splats;                 /* projected Gaussians: 72 bytes each; 456 an object */
    size_t tiles;                  /* of 16x16 pixels: 17 bytes each, and 1 for each thread */
    size_t entries;                /* lists of macro tiles of 2x2 tiles, 8 bytes an entry */
    size_t keys;                   /* room to sort them, as much; with draw_unlisted 8 KiB a thread */
    size_t total;                  /* the four above */
    size_t least;                  /* with less there is no frame */
    size_t rows;                   /* with less, tile rows of this view are drawn in slices; 0 where `total` is there */
} fxs_frame_memory;

/* The working memory of a frame of this size. With `total` it is rendered at once, whatever the camera sees, wherever
   the objects are and whatever is written: there is room for a splat for every Gaussian of every object. With less, but
   at least `least`, the picture has the same bytes and takes longer. (`least` is some 45 KB with one thread, or 200 KB
   a thread with more; and 24 bytes a chunk, the objects and the tiles.)
     Bands   Every Gaussian is projected once more, before, to count the splats on each row of tiles. Then the frame is
             rendered in bands, each of as many tile rows as have room for their splats: 88 bytes for each Gaussian that
             touches the band.
     Slices  A tile row that does not fit even by itself is drawn in slices: the nearest splats that fit, then the next
             ones. The time grows with the square of their number. So drawn are colour and coverage alone, and by a back
             end only where it has `draw_blended`; otherwise the frame ends with FXS_ERR_MEMORY.
   *memory may be null. Returns total; 0 where an argument is out of range, or the memory more than a size_t can
   count. */
FXS_API size_t fxs_frame_bytes(const fxs_context *context, const fxs_object *objects, uint32_t count, int32_t width,
                               int32_t height, fxs_frame_memory *memory);

/* The working memory of two eyes with pictures of this size: that of fxs_frame_bytes, and at most 68 bytes more for
   every Gaussian, of which a chunk that is not full counts as 256, and 512 for every object. 0 where an argument is out
   of range, or the memory more than a size_t can count. */
FXS_API size_t fxs_stereo_bytes(const fxs_context *context, const fxs_object *objects, uint32_t count, int32_t width,
                                int32_t height);

typedef struct fxs_stats {
    uint32_t gaussians;            /* in all objects */
    uint32_t drawn;                /* slots of the chunks that were projected: with a budget at most that, or a chunk
                                      for each tree and objects without one; else all */
    uint32_t missing;              /* chunks that were not there: with 0 the picture is what it is to be */
    uint32_t visible;              /* left after culling */
    uint64_t entries;              /* tile list entries */
    uint32_t bands;                /* bands of tile rows the frame was rendered in; 1 where all splats fitted */
    uint32_t slices;               /* of tile rows whose splats did not fit; 0 where all did */
    uint32_t runs;                 /* runs of tiles that those were rendered in; as many where all lists fitted */
    fxs_frame_memory memory;       /* of the last band; least: for this view, exact, or 0 where nothing was planned */
    uint64_t nanoseconds[FXS_STAGES];   /* wall time of each stage; blend and resolve share theirs by work done */
    uint64_t frame_nanoseconds;
} fxs_stats;

/* What to render: one frame, or a frame for each of two eyes. */
typedef struct fxs_request {
    const fxs_object *objects;     /* the caller's */
    uint32_t count;                /* 0 to FXS_MAX_OBJECTS */
    fxs_options options;
    uint32_t eyes;                 /* 1, or 2: left and right */
    fxs_camera cameras[2];         /* of each eye */
    fxs_targets targets[2];
    int exact;                     /* of two eyes: not 0: each has the very bytes of a frame of its own */
} fxs_request;

/* One eye, with the options and targets of fxs_options_init and fxs_targets_init, and a camera that is all 0. */
FXS_API void fxs_request_init(fxs_request *request, const fxs_object *objects, uint32_t count);

/* Renders a request. A frame has one order by depth over all of them, ties by object, then
   by Gaussian. One object as fxs_object_init leaves it is the scene itself. Not drawn are Gaussians whose centre is not
   beyond the camera's near plane.
   `memory`: `memory_bytes` bytes, aligned to 64; what they hold does not matter before, and is undefined after. As many
   as fxs_frame_bytes returns are always enough. FXS_ERR_MEMORY has two reasons, and stats->memory.least says how much
   would do with this number of threads. Either there is less than the `least` of fxs_frame_bytes; stats has that,
   though this view may take more. Or a tile row of this view does not fit and cannot be drawn in slices, because of
   depths, ids, an occluder or the back end; stats has the exact number. `least` is 0 where `memory` is not aligned, or
   where no size_t is enough.
   Targets: at least one; with a back end they are passed on to it, and there may be none. Only pixels are written, not
   what lies between rows. *stats may be null.
   Two eyes have pictures of one size and projection, and targets that do not overlap where one is written. Each eye has
   the geometry of its own camera: field of view and principal point may differ, as in a headset. Their colours are
   computed once, as seen from the point between them. So is the order by depth, where both cameras measure depth alike
   (their z axes are parallel, and neither is ahead of the other, within 2^-14) and the right eye has no occluder;
   otherwise each eye's splats are sorted by themselves. The bytes are the same on every machine. They are those of two
   frames only where both cameras are equal: with eyes 2 % of the distance to the scene apart, each picture has a PSNR
   of 54 dB or more against a frame of its own on the scenes measured (the tests hold 50). With `exact` nothing is
   shared: each eye has the very bytes of a frame of its own, in the time of two frames. There are no bands: two eyes
   take fxs_stereo_bytes. *stats is of both eyes together; `visible` counts a Gaussian that both eyes see once, or with
   `exact` once for each eye.
   Errors after which nothing is written to the targets: FXS_ERR_ARGUMENT, FXS_ERR_CAMERA, FXS_ERR_SIZE, FXS_ERR_OBJECT
   (also where the camera is more than 2^28 of the object's units away from its origin, and for two eyes beyond 2^28
   Gaussians in whole chunks), FXS_ERR_TARGET, FXS_ERR_MEMORY.
   Errors after which a part of the pixels may be written: FXS_ERR_SCENE, FXS_ERR_STOPPED and those of a back end. */
FXS_API int fxs_render(const fxs_context *context, const fxs_request *request, void *memory, size_t memory_bytes,
                       fxs_stats *stats);

/* The working memory of a request, of one eye or two: as fxs_frame_bytes and fxs_stereo_bytes, but where its options
   limit what is drawn, in proportion to the budget and not to the scenes. *memory may be null. */
FXS_API size_t fxs_request_bytes(const fxs_context *context, const fxs_request *request, fxs_frame_memory *memory);

/* Finds which chunks a request's frame would draw, and calls options.want for them, as fxs_render does; draws nothing.
   For the camera of a later frame, so that what it needs is there in time. `memory` as for fxs_render; targets are not
   read. Returns 0, or an error as fxs_render; 0 at once where neither a budget, a detail nor places limit what is
   drawn. */
FXS_API int fxs_foresee(const fxs_context *context, const fxs_request *request, void *memory, size_t memory_bytes);

/* Counts the work of the blend stage for the first eye of a request, in pairs of a pixel and a Gaussian. It renders the
   frame once more, by the plain C stages and one thread, without an occluder. A pair is
   evaluated where the Gaussian is in the list of the pixel's tile and may touch the pixel's row, and the pixel is not
   opaque yet; pixels of a tile beyond the picture's edge count too. It is blended where the pixel is also within the
   cut-off and alpha at least 1/255. Errors as fxs_render. */
FXS_API int fxs_count_pairs(const fxs_request *request, void *memory, size_t memory_bytes, uint64_t *evaluated,
                            uint64_t *blended);

/* What a pixel shows. */
typedef struct fxs_pick_result {
    uint32_t object;               /* its index in `objects` */
    uint32_t gaussian;             /* the one that contributes most: its number in the packed scene */
    uint32_t id;                   /* the object's */
    int64_t depth_q32;             /* of the Gaussian's centre, along the camera's z axis; cut to 2^28 units */
    int64_t position_q32[3];       /* in the world, on the pixel's ray, at that depth; across the axis cut to +-2^28 */
} fxs_pick_result;

/* Finds out what fxs_render shows at pixel (x, y) of the first eye: its id target holds the same. Of the targets the
   occluder and depth_bits are read. Projects the whole frame, blends one tile. Returns 1, 0 where no Gaussian
   contributes, or an error as fxs_render. */
FXS_API int fxs_pick(const fxs_context *context, const fxs_request *request, int32_t x, int32_t y, void *memory,
                     size_t memory_bytes, fxs_pick_result *result);

#ifdef __cplusplus
}
#endif

#endif
