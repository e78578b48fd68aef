/* The records that the rendering stages pass to each other, and the table of stage functions. Faster versions of the
   stages and the back ends use them. A splat is a projected Gaussian, and its slot is its index in a frame. A list has
   the splats of a tile of 16x16 pixels. Lists are made for macro tiles of 2x2 tiles.

   Not stable: may change with every version. */
#ifndef FXS_STAGE_H
#define FXS_STAGE_H

#include <stdint.h>

#include "fixed.h"
#include <fixsplat/fixsplat.h>
#include "pixel.h"

#if defined(__cplusplus) && !defined(__CUDACC__)   /* for C++, except in the CUDA back end, which compiles its own C++
                                                      copies of the stages */
extern "C" {
#endif

/* Prefix of rendering stage functions that other files call. The CUDA back end defines it to compile them for the
   device too. */
#ifndef FXS_STAGE
#define FXS_STAGE
#endif

#define FXS_TILE 16
#define FXS_TILE_PIXELS (FXS_TILE * FXS_TILE)

/* Flag of an entry in a tile's list: the splat (projected Gaussian) adds nothing to the tile. FXS_CUTOFF_SQUARE also
   lists a splat in tiles that its ellipse misses. There its coordinates u and v could wrap modulo 2^32, and must be
   ignored. */
#define FXS_ENTRY_CUT_OFF 0x80000000u
/* Coordinates u and v of a splat at a tile's corner, for list entries with FXS_ENTRY_CUT_OFF. Over a tile, u and v
   change by at most 40.3 each. They stay above 4, where nothing is drawn, and below 128, the range of Q24. */
#define FXS_CUT_OFF_Q24 (70 << 24)

/* A camera prepared for the rendering stages, in world space or in the space of an object. */
typedef struct fxs_stage_view {
    int32_t width, height, tiles_x, tiles_y;
    int64_t position_q32[3], near_q32;
    int64_t eye_q32[3];            /* the point that SH colours are seen from; within +-2^29 units */
    int32_t rotation_q30[9];
    int64_t fx_q12, fy_q12, cx_q12, cy_q12;
    uint32_t focal_q32;            /* focal is max(fx, fy) as a mantissa: max(fx, fy) = focal * 2^focal_exponent, focal
                                      in [0.5, 1) */
    int32_t focal_exponent;
    int32_t slope_low_q23[2], slope_high_q23[2];   /* limits of the slopes x/z and y/z in the Jacobian of the
                                                      projection */
    int32_t edge_low_q23[2], edge_high_q23[2];     /* slopes x/z and y/z 18 pixels outside the picture's edges, clamped
                                                      to +-64 */
    int32_t veil_exponent;         /* smallest size exponent that makes a Gaussian visible although its centre is out of
                                      range */
    int32_t jacobian_exponent;     /* exponent that scales the projection's Jacobian: 2^jacobian_exponent >= length of a
                                      row (1, 0, -x/z) of the Jacobian times z / f */
    int32_t row_q15[2][3];         /* first and second row of the rotation, each times its focal length / larger focal
                                      length * 2^-jacobian_exponent */
    int32_t forward_q15[2][3];     /* third row of the rotation, times fx and fy / larger focal length */
    int32_t cut_q11;               /* for fxs_limit_q11 */
    int32_t offset_q11;            /* opacity factor of an object, as -2 ln(factor), at most FXS_FAINT_Q11 + 1 */
    uint32_t share_q8;             /* share of a chunk's optical depth that is drawn: 256 means all; 1 to 4096 */
    int32_t grow_q16;              /* growth of a chunk's sigmas: log2 of a factor, 0 to 1 */
    int sh_degree, antialiased;    /* SH degree and anti-aliasing flag of an object's scene */
    enum fxs_cutoff cutoff;
    int orthographic;              /* 1: orthographic, so all Gaussians are projected as if z were 2^plane_exponent */
    int32_t plane_exponent;
} fxs_stage_view;

/* A splat (projected Gaussian) for the blend stage, 32 bytes. Its coordinates at pixel (X, Y) are u = u0 + X ux + Y uy
   and v = v0 + Y vy, modulo 2^32. Both are right where |u|, |v| < 128, which holds in every tile that the ellipse
   touches. */
typedef struct fxs_splat {
    uint32_t u0_q24, v0_q24;       /* u and v at pixel (0, 0), plus 2^10, which rounds a later shift by 11 */
    int32_t ux_q24, uy_q24, vy_q24;
    uint16_t offset_q11;           /* opacity, as -2 ln(opacity), 0 to 22697 */
    int16_t colour_q13[3];         /* colour of the splat, each channel 0 to 4 */
    uint16_t first_row, last_row;  /* first and last row of pixels that the splat's ellipse can touch */
} fxs_splat;

/* Bounds of a projected Gaussian for the bin stage. Its ellipse is bounded by x = cx + shear v +- breadth sqrt(r^2 -
   v^2). (A B; B C) is its covariance, pixels^2. */
typedef struct fxs_bounds {
    int32_t cx_q14, cy_q14;        /* centre of the projected Gaussian, pixels; 0 is the centre of the first pixel */
    uint32_t breadth_q8;           /* breadth of the ellipse with covariance (A B; B C): sqrt(A - B^2 / C), pixels */
    int32_t shear_q8;              /* shear of the ellipse with covariance (A B; B C): B / sqrt(C), pixels */
    uint32_t half_width_q8;        /* half the ellipse's width, r sqrt(A), plus 1/256 of it and 1/8 pixel */
    uint32_t square_radius;        /* with FXS_CUTOFF_SQUARE: half a side of the square that a Gaussian covers, ceil(3
                                      sigma_max) pixels; else 0 */
} fxs_bounds;

#define FXS_CENTRE_LIMIT_Q14 (1 << 30)           /* 65536 pixels: limit of a projected Gaussian's centre */
#define FXS_EVERYWHERE_Q8 (1 << 30)              /* half width of a veil, a Gaussian that is listed in every tile */

/* A span of tile columns or rows, from first to last. It is empty if first > last. */
typedef struct fxs_span {
    int32_t first, last;
} fxs_span;

/* Number of array elements that the stages `spans` and `note` may write beyond those that the caller asked for. */
#define FXS_SPANS_MORE 15
#define FXS_NOTES_MORE 15

/* A macro tile is a square of 2x2 tiles with a mask of 4 bits. Bit 2 r + c stands for the tile in row r and column
   c. */
#define FXS_MACRO 2

static inline uint32_t fxs_macros(int32_t tiles)
{
    return (uint32_t)(tiles + FXS_MACRO - 1) / FXS_MACRO;
}

/* The tiles that a splat (projected Gaussian) touches, if they lie within 3x3 macro tiles. Bits 4 (3 r + c) to 4 (3 r +
   c) + 3 are the mask of the macro tile in row r and column c. The bits from 36 on number the upper left macro tile. */
typedef struct fxs_box {
    uint64_t bits;
} fxs_box;
#define FXS_BOX_BITS 36
#define FXS_BOX_LOW_BITS 24
#define FXS_BOX_TILES 6
#define FXS_NARROW 4               /* largest extent in tiles of a narrow splat: one on 1 x 4 tiles or fewer is listed
                                      in its whole bounding box */
#define FXS_NOWHERE ((fxs_box){0})
#define FXS_LARGE ((fxs_box){(uint64_t)1 << 63})   /* special value of a box: the splat touches too many tiles for a
                                                      box */

/* A sort key of a splat: its depth in the high 32 bits, its slot (index in the frame) in the low 32 bits. */
typedef uint64_t fxs_key;
#define FXS_KEY(depth, slot) ((fxs_key)(depth) << 32 | (slot))
#define FXS_KEY_SLOT(key) ((uint32_t)(key))

/* The low half of a sort key in a macro tile's list: slot << 4 | mask of the 2x2 tiles. */
#define FXS_MAX_SLOTS (1u << 28)
#define FXS_LISTED(slot, mask) ((uint32_t)(slot) << 4 | (uint32_t)(mask))
#define FXS_LISTED_SLOT(key) ((uint32_t)(key) >> 4)

typedef struct fxs_tile {
    int16_t transmittance_q15[FXS_TILE_PIXELS];
    int16_t sum_q13[3][FXS_TILE_PIXELS];
} fxs_tile;

/* Auxiliary outputs of the stage `trace` for each pixel of a tile; depths and ids are made from them. `which` selects
   the arrays. Entries are numbered by their index in the list passed to `trace`. */
enum { FXS_TRACE_MEAN = 1, FXS_TRACE_MEDIAN = 2, FXS_TRACE_ID = 4, FXS_TRACE_END = 8 };

typedef struct fxs_trace {
    unsigned which;
    int16_t depth_q15[FXS_TILE_PIXELS];     /* FXS_TRACE_MEAN: sum over the entries of weight * depth code, at most
                                               32767 */
    int16_t median[FXS_TILE_PIXELS];        /* FXS_TRACE_MEDIAN: last list entry that was blended while the
                                               transmittance was 1/2 or more */
    int16_t weight_q15[FXS_TILE_PIXELS];    /* FXS_TRACE_ID: largest weight of a Gaussian so far */
    int16_t largest[FXS_TILE_PIXELS];       /* FXS_TRACE_ID: first list entry with the largest weight */
    int16_t end[FXS_TILE_PIXELS];           /* FXS_TRACE_END, an input: list entries from `end` on do not contribute */
} fxs_trace;

#define FXS_HALF_Q15 16384

/* The powers of a chunk's time u in a moving scene (internal/packed.h), at one moment. */
typedef struct fxs_moment {
    int16_t power_q15[3];          /* u, u^2, u^3, within +-32767 */
    int8_t shift;                  /* left shift of a sum of drifts, -15 to 4 */
    uint8_t moves;                 /* 1; 0: the chunk's scene is still */
} fxs_moment;

/* The rows of motion in a chunk of a moving scene. */
typedef struct fxs_motion_rows {
    uint32_t at;                   /* offset of the first in the chunk's rows, bytes */
    uint32_t degree, cut_q16;      /* as in fxs_motion_header */
    uint8_t turns, fades, unused[2];
} fxs_motion_rows;

struct fxs_object_view;            /* the struct is defined in src/core/object.h */

/* Tiles for a back end to draw: first_tile to last_tile, numbered row by row. The list of tile t is the counts[t]
   entries before entries[ends[t]]. Without lists (draw_unlisted), entries, ends and counts are null, and `keys` has
   every splat that touches the tiles. */
typedef struct fxs_tile_run {
    const fxs_config *config;
    const fxs_stage_view *view;          /* camera in world space */
    const fxs_options *options;
    const fxs_splat *splats;       /* splats (projected Gaussians), indexed by slot */
    const fxs_bounds *bounds;
    const uint32_t *depths;        /* depth keys of the splats, indexed by slot */
    const fxs_key *keys;           /* sort keys of the splats, near to far; null if the run has tile lists */
    uint32_t visible;
    const uint32_t *entries, *ends, *counts;
    uint32_t first_tile, last_tile;
    const fxs_tile *blended;       /* tiles that the kernels have already blended, if the configuration sets
                                      draw_blended; or null */
    const fxs_targets *targets;    /* output pictures of the whole frame */
    const uint32_t *indices;       /* for each slot, the number of its Gaussian in the chunks of all objects */
    const struct fxs_object_view *objects;
    uint32_t object_count;
} fxs_tile_run;

static inline int fxs_pixel_bytes(enum fxs_format format)
{
    return format == FXS_FORMAT_RGB565 || format == FXS_FORMAT_RGB565_SWAPPED ? 2
           : format == FXS_FORMAT_RGBA16_COVERAGE ? 8 : 4;
}

static inline int fxs_is_premultiplied(enum fxs_format format)
{
    return format == FXS_FORMAT_RGBA8_COVERAGE || format == FXS_FORMAT_RGBA16_COVERAGE;
}

/* Converts an 8-bit background colour to Q13, for the stage `resolve`. */
static inline int fxs_background_q13(int background)
{
    return (background * 8192 + 127) / 255;
}

static inline uint16_t fxs_rgb565(int r, int g, int b)
{
    return (uint16_t)((r * 31 + 127) / 255 << 11 | (g * 63 + 127) / 255 << 5 | (b * 31 + 127) / 255);
}

/* Converts a depth in an output picture, with `bits` fraction bits, to a depth key. Keys sort like depths z: 6 bits of
   floor(log2 z) + 32, from -32 to 31, then the 26 bits after the leading one. Depths below 2^-32 have the key 0. Depths
   above 2^32 and FXS_NOTHING have the largest key. */
static inline uint32_t fxs_depth_key(uint32_t depth, int bits)
{
    const int zeros = fxs_clz32(depth | 1);
    return depth == FXS_NOTHING ? UINT32_MAX
           : !depth ? 0 : (uint32_t)(63 - zeros - bits) << 26 | ((depth << zeros) >> 5 & 0x3ffffff);
}

/* Converts a depth key (a depth as floating point) to a depth for an output picture, rounded down. */
static inline uint32_t fxs_depth_of_key(uint32_t key, int bits)
{
    const int shift = (int)(key >> 26) - 32 + bits - 26;
    const uint32_t mantissa = 1u << 26 | (key & 0x3ffffff);
    return shift > 5 ? FXS_NOTHING - 1 : shift >= 0 ? mantissa << shift : shift > -32 ? mantissa >> -shift : 0;
}

/* Extra fraction bits of a pixel's sum of weighted depths. A Gaussian at depth 2^octave (1 + code) with weight w adds w
   + fxs_mul_q15(w, code), times 2^shift. */
#define FXS_DEPTH_GUARD 8

/* Returns the position of a depth key within its octave (from one power of two to the next), 0 to 1. */
static inline int fxs_depth_code_q15(uint32_t key)
{
    return fxs_min((int)(((key & 0x3ffffff) + 1024) >> 11), 32767);
}

/* Converts a sum of weighted depth codes to the fixed point of an output picture. The sum is over the Gaussians in the
   octave of `key`. Depths beyond the picture's range saturate. Depths below 2^-FXS_DEPTH_GUARD units count as 0. */
static inline uint64_t fxs_depth_sum(uint32_t sum_q15, uint32_t key, int bits)
{
    const int shift = fxs_min((int)(key >> 26) - 32 + bits, 32) + FXS_DEPTH_GUARD;
    return shift < 0 ? 0 : (uint64_t)sum_q15 << shift;
}

/* Returns a pixel's mean depth, rounded to nearest. `sum` is its sum of weight * depth; the weights add up to 1 -
   transmittance. */
static inline uint32_t fxs_mean_depth(uint64_t sum, int transmittance_q15)
{
    const uint64_t weight = (uint64_t)(FXS_CLEAR_Q15 - transmittance_q15) << FXS_DEPTH_GUARD;
    const uint64_t mean = weight ? (sum + weight / 2) / weight : FXS_NOTHING;
    return !weight || mean < FXS_NOTHING ? (uint32_t)mean : FXS_NOTHING - 1;
}

/* The rendering stages as a table of functions. A call works on one chunk of 256 Gaussians or on one tile. */
typedef struct fxs_kernels {
    const char *name[FXS_STAGES];  /* name of each stage's version: "c", "avx2", ... */

    /* Writes the rows of a chunk of a moving scene as they are at a moment to `out`, without SH and motion. `rows` are
       the chunk's, scale_step_q24 is in its header; both are aligned to 64. The first part of the stage project. */
    void (*animate)(const fxs_scene *scene, const fxs_motion_rows *motion, const fxs_moment *moment,
                    uint32_t scale_step_q24, const unsigned char *rows, unsigned char *out);

    /* Projects the Gaussians of a chunk. Appends each Gaussian that can touch a pixel: its splat (without colour),
       bounds, index in the scene (ascending) and depth key. Returns the number of Gaussians appended, at most 256, or
       FXS_ERR_SCENE if the chunk's header is out of range: the scene changed after it was opened. */
    int32_t (*project)(const fxs_stage_view *view, const fxs_scene *scene, uint32_t chunk, fxs_splat *splats,
                       fxs_bounds *bounds, uint32_t *indices, uint32_t *depths);

    /* Computes the colours of `count` splats (projected Gaussians) of one chunk; indices ascend. Returns 0, or
       FXS_ERR_SCENE like project. */
    int (*shade)(const fxs_stage_view *view, const fxs_scene *scene, uint32_t chunk, const uint32_t *indices,
                 uint32_t count, fxs_splat *splats);

    /* Finds the tiles that `count` splats (projected Gaussians) touch, as boxes. */
    void (*bin)(const fxs_stage_view *view, const fxs_splat *splats, const fxs_bounds *bounds,
                uint32_t count, fxs_box *boxes);

    /* Finds the tile columns that a splat touches on tile rows `row` to row + rows - 1, all within its bounding box.
       May write up to 15 spans beyond these rows. */
    void (*spans)(const fxs_stage_view *view, const fxs_splat *splat, const fxs_bounds *bounds,
                  int32_t row, int32_t rows, fxs_span *spans);

    /* Lists the macro tiles (2x2 tiles) of slots `first` to first + count - 1, from the boxes of these slots. For each
       pair of slot and macro tile, it writes the macro tile to `macros` and slot << 4 | mask of its tiles to `listed`.
       At most 9 pairs a slot; may write up to 15 more. Returns the number of pairs, in any order. */
    uint32_t (*note)(const fxs_stage_view *view, const fxs_box *boxes, uint32_t first, uint32_t count,
                     uint32_t *macros, uint32_t *listed);

    /* Sorts `count` keys by depth, then by slot. `spare` is an array of the same capacity. Fast if keys of equal depth
       arrive almost in ascending order of slots. */
    void (*sort)(fxs_key *keys, fxs_key *spare, uint32_t count);

    /* Extracts the list of one tile, number 0 to 3, from the `count` keys of its macro tile (2x2 tiles). `entries` has
       room for `count`. Returns the length of the list. */
    uint32_t (*list)(const fxs_key *keys, uint32_t count, uint32_t tile, uint32_t *entries);

    /* Blends a list of splats, near to far, into the tile with first pixel (x, y). */
    void (*blend)(const fxs_stage_view *view, int32_t x, int32_t y, const fxs_splat *splats,
                  const uint32_t *entries, uint32_t count, fxs_tile *tile);

    /* Blends like the stage `blend`, with auxiliary outputs: also fills *trace, the source of depths and ids. It blends
       a part of a list, from entry `first` to before `end` (at most 32767), and continues from the present state of the
       tile and its trace. depths_q15 has a depth code for each entry of the part, if a mean depth is wanted; else it
       may be null. */
    void (*trace)(const fxs_stage_view *view, int32_t x, int32_t y, const fxs_splat *splats,
                  const uint32_t *entries, const int16_t *depths_q15, uint32_t first, uint32_t end,
                  fxs_tile *tile, fxs_trace *trace);

    /* Converts `columns` x `rows` pixels of a blended tile to output pixels, over the options' background. `format` is
       RGBA8, RGBA8_COVERAGE, RGB565 or RGBA16_COVERAGE. */
    void (*resolve)(const fxs_options *options, enum fxs_format format, const fxs_tile *tile, int32_t columns,
                    int32_t rows, unsigned char *pixels, ptrdiff_t stride);
} fxs_kernels;

/* Returns the working memory in bytes of a frame with one eye and without a budget, as fxs_request_bytes does. */
FXS_EXPERIMENTAL size_t fxs_frame_bytes(const fxs_context *context, const fxs_object *objects, uint32_t count,
                                        int32_t width, int32_t height, fxs_frame_memory *memory);

/* ---- The C versions -------------------------------------------------------------------------------------------- */

FXS_EXPERIMENTAL extern const fxs_kernels fxs_kernels_c;

FXS_EXPERIMENTAL void fxs_animate_c(const fxs_scene *scene, const fxs_motion_rows *motion, const fxs_moment *moment,
                                    uint32_t scale_step_q24, const unsigned char *rows, unsigned char *out);
FXS_EXPERIMENTAL int32_t fxs_project_c(const fxs_stage_view *view, const fxs_scene *scene, uint32_t chunk,
                                       fxs_splat *splats,
                              fxs_bounds *bounds, uint32_t *indices, uint32_t *depths);
FXS_EXPERIMENTAL int fxs_shade_c(const fxs_stage_view *view, const fxs_scene *scene, uint32_t chunk,
                                 const uint32_t *indices,
                        uint32_t count, fxs_splat *splats);
FXS_EXPERIMENTAL void fxs_bin_c(const fxs_stage_view *view, const fxs_splat *splats, const fxs_bounds *bounds,
                                uint32_t count,
                       fxs_box *boxes);
FXS_EXPERIMENTAL void fxs_spans_c(const fxs_stage_view *view, const fxs_splat *splat, const fxs_bounds *bounds,
                                  int32_t row,
                         int32_t rows, fxs_span *spans);
FXS_EXPERIMENTAL uint32_t fxs_note_c(const fxs_stage_view *view, const fxs_box *boxes, uint32_t first, uint32_t count,
                            uint32_t *macros, uint32_t *listed);
FXS_EXPERIMENTAL void fxs_sort_c(fxs_key *keys, fxs_key *spare, uint32_t count);
FXS_EXPERIMENTAL uint32_t fxs_list_c(const fxs_key *keys, uint32_t count, uint32_t tile, uint32_t *entries);
FXS_EXPERIMENTAL void fxs_blend_c(const fxs_stage_view *view, int32_t x, int32_t y, const fxs_splat *splats,
                                  const uint32_t *entries,
                         uint32_t count, fxs_tile *tile);
FXS_EXPERIMENTAL void fxs_trace_c(const fxs_stage_view *view, int32_t x, int32_t y, const fxs_splat *splats,
                                  const uint32_t *entries,
                         const int16_t *depths_q15, uint32_t first, uint32_t end, fxs_tile *tile, fxs_trace *trace);
FXS_EXPERIMENTAL void fxs_resolve_c(const fxs_options *options, enum fxs_format format, const fxs_tile *tile,
                                    int32_t columns,
                           int32_t rows, unsigned char *pixels, ptrdiff_t stride);

/* Converts a tile to output pixels like the stage `resolve`, in any format. */
FXS_EXPERIMENTAL void fxs_resolve_colour(const fxs_kernels *kernels, const fxs_options *options, enum fxs_format format,
                                const fxs_tile *tile, int32_t columns, int32_t rows, unsigned char *pixels,
                                ptrdiff_t stride);

/* Runs job(argument, i) for i in 0..jobs-1 on the threads of a configuration. */
static inline void fxs_run(const fxs_config *config, void (*job)(void *argument, uint32_t i), void *argument,
                           uint32_t jobs)
{
    if (config->workers.run && jobs > 1)
        config->workers.run(config->workers.pool, job, argument, jobs);
    else
        for (uint32_t i = 0; i < jobs; i++)
            job(argument, i);
}

/* Returns the first item of part `i` if `count` items are divided into `parts` parts. */
static inline uint32_t fxs_part(uint32_t count, uint32_t parts, uint32_t i)
{
    return (uint32_t)((uint64_t)count * i / parts);
}

#if defined(__cplusplus) && !defined(__CUDACC__)
}
#endif

#endif
