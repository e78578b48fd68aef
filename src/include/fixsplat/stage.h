/* The records that the stages of a frame (src/core/frame.c) hand to each other, for faster versions of the stages and
   for back ends. Not stable: it may change with every version. */
#ifndef FXS_STAGE_H
#define FXS_STAGE_H

#include <stdint.h>

#include "fixed.h"
#include "fixsplat.h"
#include "pixel.h"

#if defined(__cplusplus) && !defined(__CUDACC__)   /* the CUDA back end has copies of its own */
extern "C" {
#endif

/* Before functions of a stage that other files call; the CUDA back end compiles their text for the device as well. */
#ifndef FXS_STAGE
#define FXS_STAGE
#endif

#define FXS_TILE 16
#define FXS_TILE_PIXELS (FXS_TILE * FXS_TILE)

/* A bit of a list's entries, set with FXS_CUTOFF_SQUARE alone. The square lists a splat in tiles that its ellipse does
   not touch. It adds nothing there, and its u and v, which are right modulo 2^32 only where the ellipse is, may come
   out as if it did. So such an entry is marked as cut off, and does without them. */
#define FXS_ENTRY_CUT_OFF 0x80000000u
/* What the C version of blend takes for the u and v of such an entry at the tile's corner: over the whole tile, where
   each changes by at most 40.3, they stay beyond +-4, where nothing is drawn, and within +-128, where Q24 ends. */
#define FXS_CUT_OFF_Q24 (70 << 24)

/* A camera made ready for the stages, in the world or in the space of an object. */
typedef struct fxs_view {
    int32_t width, height, tiles_x, tiles_y;
    int64_t position_q32[3], near_q32;
    int64_t eye_q32[3];            /* where colours are seen from; within +-2^29 units */
    int32_t rotation_q30[9];
    int64_t fx_q12, fy_q12, cx_q12, cy_q12;
    uint32_t focal_q32;            /* max(fx, fy) = focal * 2^focal_exponent, focal in [0.5, 1) */
    int32_t focal_exponent;
    int32_t slope_low_q23[2], slope_high_q23[2];   /* x/z and y/z are cut to these in the Jacobian */
    int32_t edge_low_q23[2], edge_high_q23[2];     /* x/z and y/z at the picture's edges, 18 pixels out, cut to +-64 */
    int32_t hidden_low_q23[2], hidden_high_q23[2]; /* at the edges of the camera's hidden part, 4 pixels in */
    int32_t hidden[2], hidden_end[2];              /* its pixels, x and y, from the first to before the end */
    int32_t veil_exponent;         /* a Gaussian with its centre out of range is seen from this size exponent on */
    int32_t jacobian_exponent;     /* 2^that >= length of a row (1, 0, -x/z) of the Jacobian, times z / f */
    int32_t row_q15[2][3];         /* first and second row of f'/f * rotation * 2^-jacobian_exponent */
    int32_t forward_q15[2][3];     /* f'/f * third row of the rotation */
    int32_t cut_q11;               /* for fxs_limit_q11 */
    int32_t offset_q11;            /* of an object: -2 ln(opacity factor), at most FXS_FAINT_Q11 + 1 */
    uint32_t share_q8;             /* of a chunk's optical depth that is drawn: 256 leaves it as it is; 1 to 4096 */
    int32_t grow_q16;              /* log2 by which the sigmas of a chunk grow; 0 to 1 */
    int sh_degree, antialiased;    /* of an object's scene */
    enum fxs_cutoff cutoff;
    int orthographic;              /* 1: all is projected as if z were 2^plane_exponent */
    int32_t plane_exponent;
} fxs_view;

/* A projected Gaussian, as the blend stage reads it: 32 bytes. u = u0 + X ux + Y uy, v = v0 + Y vy for the pixel (X,
   Y), all modulo 2^32: right wherever |u|, |v| < 128, which holds in every tile that the ellipse touches. */
typedef struct fxs_splat {
    uint32_t u0_q24, v0_q24;       /* plus 2^10, so that a shift by 11 rounds */
    int32_t ux_q24, uy_q24, vy_q24;
    uint16_t offset_q11;           /* -2 ln(opacity), 0 to 22697 */
    int16_t colour_q13[3];         /* 0 to 4 */
    uint16_t first_row, last_row;  /* pixel rows that the ellipse can touch */
} fxs_splat;

/* The same Gaussian, as the bin stage reads it: x = cx + shear v + breadth sqrt(r^2 - v^2) bounds the ellipse at v. */
typedef struct fxs_bounds {
    int32_t cx_q14, cy_q14;        /* centre, in pixels, 0 at the centre of the first pixel */
    uint32_t breadth_q8;           /* sqrt(A - B^2 / C), pixels */
    int32_t shear_q8;              /* B / sqrt(C) */
    uint32_t half_width_q8;        /* r sqrt(A), plus 1/256 of it and 1/8 pixel */
    uint32_t square_radius;        /* of FXS_CUTOFF_SQUARE: half a side, ceil(3 sigma_max) pixels; else 0 */
} fxs_bounds;

#define FXS_CENTRE_LIMIT_Q14 (1 << 30)           /* 65536 pixels */
#define FXS_EVERYWHERE_Q8 (1 << 30)              /* half_width_q8 of a veil: it is listed in every tile */

/* Tile columns or rows, first to last; none where first > last. */
typedef struct fxs_span {
    int32_t first, last;
} fxs_span;

/* How many more than they are asked for versions of `spans` and of `note` may write, as they write whole vectors. */
#define FXS_SPANS_MORE 15
#define FXS_NOTES_MORE 15

/* Lists are made for macro tiles of 2x2 tiles. Bit 2 r + c of a mask stands for the tile in row r and column c. */
#define FXS_MACRO 2

static inline uint32_t fxs_macros(int32_t tiles)
{
    return (uint32_t)(tiles + FXS_MACRO - 1) / FXS_MACRO;
}

/* The tiles that a splat is listed in, where they fit in 3x3 macro tiles: bits 4 (3 r + c) to 4 (3 r + c) + 3 are the
   mask of the one in row r and column c; the bits from 36 on number the one in row 0 and column 0 in the picture. */
typedef struct fxs_box {
    uint64_t bits;
} fxs_box;
#define FXS_BOX_BITS 36
#define FXS_BOX_LOW_BITS 24        /* rows 0 and 1 */
#define FXS_BOX_TILES 6            /* a side */
#define FXS_NARROW 4               /* columns up to which a splat on one tile row is listed in all of its box */
#define FXS_NOWHERE ((fxs_box){0})     /* there are none */
#define FXS_LARGE ((fxs_box){(uint64_t)1 << 63})   /* they do not fit, and are found when lists are made */

/* What a sort moves: depth above, slot below. */
typedef uint64_t fxs_key;
#define FXS_KEY(depth, slot) ((fxs_key)(depth) << 32 | (slot))
#define FXS_KEY_SLOT(key) ((uint32_t)(key))

/* A key of a macro tile's list: the mask below the slot. */
#define FXS_MAX_SLOTS (1u << 28)
#define FXS_LISTED(slot, mask) ((uint32_t)(slot) << 4 | (uint32_t)(mask))
#define FXS_LISTED_SLOT(key) ((uint32_t)(key) >> 4)

/* The pixels of one tile, while it is blended. */
typedef struct fxs_tile {
    int16_t transmittance_q15[FXS_TILE_PIXELS];
    int16_t sum_q13[3][FXS_TILE_PIXELS];
} fxs_tile;

/* The auxiliary outputs of a tile while it is blended by `trace`: numbers for each pixel, from which its depths and id
   are made. `which` says which of the arrays are wanted. An entry is named by its place in the list that `trace` is
   given. */
enum { FXS_TRACE_MEAN = 1, FXS_TRACE_MEDIAN = 2, FXS_TRACE_ID = 4, FXS_TRACE_END = 8 };

typedef struct fxs_trace {
    unsigned which;
    int16_t depth_q15[FXS_TILE_PIXELS];     /* MEAN: sum of weight * depths_q15, at most 32767 */
    int16_t median[FXS_TILE_PIXELS];        /* MEDIAN: the last that found T at 1/2 or above and took some */
    int16_t weight_q15[FXS_TILE_PIXELS];    /* ID: the largest so far, of all parts */
    int16_t largest[FXS_TILE_PIXELS];       /* ID: the first with that weight */
    int16_t end[FXS_TILE_PIXELS];           /* END, read: the pixel takes none from this one on */
} fxs_trace;

#define FXS_HALF_Q15 16384         /* transmittance */

struct fxs_object_view;            /* src/core/object.h */

/* Tiles for a back end to draw: first_tile to last_tile as the picture has them, row by row, so that the run may begin
   and end within a row. Tile t's list is counts[t] entries that end before entries[ends[t]]. Without lists
   (draw_unlisted) entries, ends and counts are null, and `keys` has every splat that touches the tiles. */
typedef struct fxs_tile_run {
    const fxs_config *config;
    const fxs_view *view;          /* of the world */
    const fxs_options *options;
    const fxs_splat *splats;       /* by slot */
    const fxs_bounds *bounds;
    const uint32_t *depths;        /* depth keys by slot: fxs_depth_key */
    const fxs_key *keys;           /* near to far; null with lists */
    uint32_t visible;
    const uint32_t *entries, *ends, *counts;
    uint32_t first_tile, last_tile;
    const fxs_tile *blended;       /* these tiles, with draw_blended where memory is short; then there is no list */
    const fxs_targets *targets;    /* of the whole picture, as in fxs_request */
    const uint32_t *indices;       /* by slot: the Gaussian's place in the chunks of all objects */
    const struct fxs_object_view *objects;
    uint32_t object_count;
} fxs_tile_run;

/* Bytes of a pixel. */
static inline int fxs_pixel_bytes(enum fxs_format format)
{
    return format == FXS_FORMAT_RGB565 || format == FXS_FORMAT_RGB565_SWAPPED ? 2
           : format == FXS_FORMAT_RGBA16_COVERAGE ? 8 : 4;
}

static inline int fxs_is_premultiplied(enum fxs_format format)
{
    return format == FXS_FORMAT_RGBA8_COVERAGE || format == FXS_FORMAT_RGBA16_COVERAGE;
}

/* A background of 8 bits, as resolve adds it. */
static inline int fxs_background_q13(int background)
{
    return (background * 8192 + 127) / 255;
}

/* A pixel of FXS_FORMAT_RGB565. */
static inline uint16_t fxs_rgb565(int r, int g, int b)
{
    return (uint16_t)((r * 31 + 127) / 255 << 11 | (g * 63 + 127) / 255 << 5 | (b * 31 + 127) / 255);
}

/* A depth of a target as a depth key. Keys are in the same order as depths z: floor(log2 z), -32 to 31, plus 32 in 6
   bits, then the 26 bits behind the leading one. What is nearer than 2^-32 has the key 0; what is farther than 2^32,
   and FXS_NOTHING of a target, the largest. */
static inline uint32_t fxs_depth_key(uint32_t depth, int bits)
{
    const int zeros = fxs_clz32(depth | 1);
    return depth == FXS_NOTHING ? UINT32_MAX
           : !depth ? 0 : (uint32_t)(63 - zeros - bits) << 26 | ((depth << zeros) >> 5 & 0x3ffffff);
}

/* A depth key as a depth of a target, rounded down. */
static inline uint32_t fxs_depth_of_key(uint32_t key, int bits)
{
    const int shift = (int)(key >> 26) - 32 + bits - 26;
    const uint32_t mantissa = 1u << 26 | (key & 0x3ffffff);
    return shift > 5 ? FXS_NOTHING - 1 : shift >= 0 ? mantissa << shift : shift > -32 ? mantissa >> -shift : 0;
}

/* The mean depth of a pixel is made from sums with FXS_DEPTH_GUARD bits below a unit of the target. A Gaussian at depth
   2^octave (1 + code), of weight w, adds w + fxs_mul_q15(w, code) times 2^shift: integers, so their order does not
   matter. */
#define FXS_DEPTH_GUARD 8

/* The code of a depth key: how far into its octave it is, 0 to 1. */
static inline int fxs_depth_code_q15(uint32_t key)
{
    return fxs_min((int)(((key & 0x3ffffff) + 1024) >> 11), 32767);
}

/* The sum of Gaussians that are in one octave, that of `key`, in units of the target. Depths beyond the target's range
   count as the least depth beyond; those below 2^-FXS_DEPTH_GUARD units as 0. */
static inline uint64_t fxs_depth_sum(uint32_t sum_q15, uint32_t key, int bits)
{
    const int shift = fxs_min((int)(key >> 26) - 32 + bits, 32) + FXS_DEPTH_GUARD;
    return shift < 0 ? 0 : (uint64_t)sum_q15 << shift;
}

/* sum of weight * depth / sum of weight, rounded */
static inline uint32_t fxs_mean_depth(uint64_t sum, int transmittance_q15)
{
    const uint64_t weight = (uint64_t)(FXS_CLEAR_Q15 - transmittance_q15) << FXS_DEPTH_GUARD;
    const uint64_t mean = weight ? (sum + weight / 2) / weight : FXS_NOTHING;
    return !weight || mean < FXS_NOTHING ? (uint32_t)mean : FXS_NOTHING - 1;
}

/* ---- The C versions -------------------------------------------------------------------------------------------- */

/* The table of all of these. */
FXS_API extern const fxs_kernels fxs_kernels_c;

FXS_API int32_t fxs_project_c(const fxs_view *view, const fxs_scene *scene, uint32_t chunk, fxs_splat *splats,
                              fxs_bounds *bounds, uint32_t *indices, uint32_t *depths);
FXS_API int fxs_shade_c(const fxs_view *view, const fxs_scene *scene, uint32_t chunk, const uint32_t *indices,
                        uint32_t count, fxs_splat *splats);
FXS_API void fxs_bin_c(const fxs_view *view, const fxs_splat *splats, const fxs_bounds *bounds, uint32_t count,
                       fxs_box *boxes);
FXS_API void fxs_spans_c(const fxs_view *view, const fxs_splat *splat, const fxs_bounds *bounds, int32_t row,
                         int32_t rows, fxs_span *spans);
FXS_API uint32_t fxs_note_c(const fxs_view *view, const fxs_box *boxes, uint32_t first, uint32_t count,
                            uint32_t *macros, uint32_t *listed);
FXS_API void fxs_sort_c(fxs_key *keys, fxs_key *spare, uint32_t count);
FXS_API uint32_t fxs_list_c(const fxs_key *keys, uint32_t count, uint32_t tile, uint32_t *entries);
FXS_API void fxs_blend_c(const fxs_view *view, int32_t x, int32_t y, const fxs_splat *splats, const uint32_t *entries,
                         uint32_t count, fxs_tile *tile);
FXS_API void fxs_trace_c(const fxs_view *view, int32_t x, int32_t y, const fxs_splat *splats, const uint32_t *entries,
                         const int16_t *depths_q15, uint32_t first, uint32_t end, fxs_tile *tile, fxs_trace *trace);
FXS_API void fxs_resolve_c(const fxs_options *options, enum fxs_format format, const fxs_tile *tile, int32_t columns,
                           int32_t rows, unsigned char *pixels, ptrdiff_t stride);

/* `resolve` in any format. */
FXS_API void fxs_resolve_colour(const fxs_kernels *kernels, const fxs_options *options, enum fxs_format format,
                                const fxs_tile *tile, int32_t columns, int32_t rows, unsigned char *pixels,
                                ptrdiff_t stride);

/* fxs_blend_c, and adds to *evaluated and *blended the pairs that fxs_count_pairs counts. */
FXS_API void fxs_blend_count(const fxs_view *view, int32_t x, int32_t y, const fxs_splat *splats,
                             const uint32_t *entries, uint32_t count, fxs_tile *tile, uint64_t *evaluated,
                             uint64_t *blended);

/* Runs job(argument, i) for i in 0..jobs-1 as the configuration says. */
static inline void fxs_run(const fxs_config *config, void (*job)(void *argument, uint32_t i), void *argument,
                           uint32_t jobs)
{
    if (config->run && jobs > 1)
        config->run(config->pool, job, argument, jobs);
    else
        for (uint32_t i = 0; i < jobs; i++)
            job(argument, i);
}

/* Part `i` of `parts` of `count` things: from fxs_part(count, parts, i) to fxs_part(count, parts, i + 1). */
static inline uint32_t fxs_part(uint32_t count, uint32_t parts, uint32_t i)
{
    return (uint32_t)((uint64_t)count * i / parts);
}

#if defined(__cplusplus) && !defined(__CUDACC__)
}
#endif

#endif
