/* The stages of a frame: what they hand to each other, and the table through which a faster version replaces the C
   one. */
#ifndef FXS_STAGE_H
#define FXS_STAGE_H

#include <stdint.h>

#include "fixsplat.h"
#include "packed.h"

#define FXS_FN static inline
#include "pixel.h"

/* Before functions of a stage that other files call; the CUDA back end compiles their text for the device as well. */
#ifndef FXS_STAGE
#define FXS_STAGE
#endif

#define FXS_TILE 16
#define FXS_TILE_PIXELS (FXS_TILE * FXS_TILE)

/* In a tile list, with the square cut-off: the tile is in the square, the ellipse does not touch it. */
#define FXS_ENTRY_FAR 0x80000000u
/* Whitened coordinate of the corner of such a tile: over the tile it stays beyond +-4 and within +-128. */
#define FXS_FAR_Q24 (70 << 24)

/* A camera made ready for a scene, once a frame. */
typedef struct fxs_view {
    int32_t width, height, tiles_x, tiles_y;
    int64_t position_q32[3], near_q32;
    int32_t rotation_q30[9];
    int64_t fx_q12, fy_q12, cx_q12, cy_q12;
    uint32_t focal_q32;            /* max(fx, fy) = focal * 2^focal_exponent, focal in [0.5, 1) */
    int32_t focal_exponent;
    int32_t slope_low_q23[2], slope_high_q23[2];   /* x/z and y/z are cut to these in the Jacobian */
    int32_t edge_low_q23[2], edge_high_q23[2];     /* x/z and y/z at the picture's edges, 18 pixels out, cut to +-64 */
    int32_t veil_exponent;         /* a Gaussian with its centre out of range is seen from this size exponent on */
    int32_t jacobian_exponent;     /* 2^that >= length of a row (1, 0, -x/z) of the Jacobian, times z / f */
    int32_t row_q15[2][3];         /* first and second row of f'/f * rotation * 2^-jacobian_exponent */
    int32_t forward_q15[2][3];     /* f'/f * third row of the rotation */
    int32_t cut_q11;               /* for fxs_limit_q11 */
    int sh_degree, antialiased;
    int square;                    /* the square cut-off */
} fxs_view;

/* Where a chunk lies for a camera: camera coordinates = (base + m code) * 2^-16, in units of 2^(shift - 32), each
   below 2^30. */
typedef struct fxs_chunk_view {
    uint32_t chunk;
    int32_t scale_q16;             /* of its header */
    uint32_t scale_step_q24, opacity_law;
    int64_t base_q16[3];
    int32_t m_q16[3][3];           /* below 2^29 */
    int shift;
    int32_t near;                  /* the near plane's depth, 0 to 2^31 - 1; only what is beyond it is drawn */
} fxs_chunk_view;

/* Constants of project. */
#define FXS_DILATION_Q30 322122547u              /* 0.3 pixels^2 */
#define FXS_DILATION_LEAST_Q30 64u               /* 2^-24: no needle is thinner than 1 in 4096, see docs/numbers.md */
#define FXS_CENTRE_LIMIT_Q14 (1 << 30)           /* 65536 pixels */
#define FXS_EXPONENT_MAX 16                      /* sigma up to 65536 pixels; what is larger is a veil */
#define FXS_EVERYWHERE_Q8 (1 << 30)              /* half_width_q8 of a veil: it is listed in every tile */
#define FXS_DEPTH_BIAS 32                        /* floor(log2 z), -32 to 30, plus this fits in 6 bits */

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
    uint32_t radius;               /* square cut-off: ceil(3 sigma_max), pixels; else 0 */
} fxs_bounds;

/* The tiles that a splat is listed in, where they fit in 4x4: bit 4 r + c of the mask stands for tile `base` + r
   tiles_x + c. Mask 0: they do not fit, and are found again from the bounds when the lists are made; but there are none
   where `base` is FXS_NOWHERE. */
#define FXS_NOWHERE UINT32_MAX
typedef struct fxs_box {
    uint32_t base;
    uint32_t mask;
} fxs_box;

/* What a sort moves: depth above, slot below. */
typedef uint64_t fxs_key;
#define FXS_KEY(depth, slot) ((fxs_key)(depth) << 32 | (slot))
#define FXS_KEY_SLOT(key) ((uint32_t)(key))

/* The pixels of one tile, while it is blended. */
typedef struct fxs_tile {
    int16_t transmittance_q15[FXS_TILE_PIXELS];
    int16_t sum_q13[3][FXS_TILE_PIXELS];
} fxs_tile;

/* A run of tiles, first to last, ready to be drawn by a back end. Tile t's list is counts[t] entries that end before
   entries[ends[t]]. A back end without lists draws all tiles; entries, ends and counts are null then. */
typedef struct fxs_tile_run {
    const fxs_config *config;
    const fxs_view *view;
    const fxs_options *options;
    const fxs_splat *splats;       /* by slot */
    const fxs_bounds *bounds;
    const fxs_key *keys;           /* of the visible splats, near to far */
    uint32_t visible;
    const uint32_t *entries, *ends, *counts;
    uint32_t first_tile, last_tile;
    unsigned char *pixels;         /* of the whole picture, as in fxs_render */
    ptrdiff_t stride;
} fxs_tile_run;

/* Bytes of a pixel. */
static inline int fxs_pixel_bytes(const fxs_options *options)
{
    return options->format == FXS_FORMAT_RGB565 ? 2 : 4;
}

/* Whether rows of pixels, `stride` bytes apart, do not overlap. */
static inline int fxs_stride_valid(const fxs_camera *camera, const fxs_options *options, ptrdiff_t stride)
{
    const ptrdiff_t row = camera->width * (ptrdiff_t)fxs_pixel_bytes(options);
    return camera->height <= 1 || stride >= row || stride <= -row;
}

/* The background that resolve adds, colour c of r g b. */
static inline int fxs_background_q13(const fxs_options *options, int c)
{
    return options->format == FXS_FORMAT_RGBA8_COVERAGE ? 0 : (options->background[c] * 8192 + 127) / 255;
}

/* A pixel of FXS_FORMAT_RGB565. */
static inline uint16_t fxs_rgb565(int r, int g, int b)
{
    return (uint16_t)((r * 31 + 127) / 255 << 11 | (g * 63 + 127) / 255 << 5 | (b * 31 + 127) / 255);
}

/* Of a packed scene. */
static inline const unsigned char *fxs_aligned(const unsigned char *bytes)
{
#if defined(__CUDA_ARCH__)
    bytes = (const unsigned char *)__builtin_assume_aligned(bytes, 64);   /* else nvcc reads single bytes */
#endif
    return bytes;
}

/* The rows of a chunk, aligned to 64. */
static inline const unsigned char *fxs_rows(const fxs_scene *scene, uint32_t chunk)
{
    return fxs_aligned(scene->rows + (size_t)chunk * scene->chunk_bytes);
}

/* ---- The C versions -------------------------------------------------------------------------------------------- */

/* The table of all of these. */
extern const fxs_kernels fxs_kernels_c;

int32_t fxs_project_c(const fxs_view *view, const fxs_scene *scene, uint32_t chunk, fxs_splat *splats,
                      fxs_bounds *bounds, uint32_t *indices, uint32_t *depths);
int fxs_shade_c(const fxs_view *view, const fxs_scene *scene, uint32_t chunk, const uint32_t *indices, uint32_t count,
                fxs_splat *splats);
void fxs_bin_c(const fxs_view *view, const fxs_splat *splats, const fxs_bounds *bounds, uint32_t count,
               fxs_box *boxes);
void fxs_blend_c(const fxs_view *view, int32_t x, int32_t y, const fxs_splat *splats, const uint32_t *entries,
                 uint32_t count, fxs_tile *tile);
void fxs_resolve_c(const fxs_options *options, const fxs_tile *tile, int32_t columns, int32_t rows,
                   unsigned char *pixels, ptrdiff_t stride);

/* fxs_blend_c that counts: see fxs_count_pairs. */
void fxs_blend_count(const fxs_view *view, int32_t x, int32_t y, const fxs_splat *splats, const uint32_t *entries,
                     uint32_t count, fxs_tile *tile, uint64_t *evaluated, uint64_t *blended);

/* Prepares the camera. Returns 0 or an FXS_ERR_*. */
int fxs_view_init(fxs_view *view, const fxs_scene *scene, const fxs_camera *camera, const fxs_options *options);

/* Runs job(argument, i) for i in 0..jobs-1 as the configuration says. */
void fxs_run(const fxs_config *config, void (*job)(void *argument, uint32_t i), void *argument, uint32_t jobs);

/* Part `i` of `parts` of `count` things: from fxs_part(count, parts, i) to fxs_part(count, parts, i + 1). */
static inline uint32_t fxs_part(uint32_t count, uint32_t parts, uint32_t i)
{
    return (uint32_t)((uint64_t)count * i / parts);
}

#define FXS_SORT_BUCKETS 2048

/* Copies a chunk's header and checks its ranges, on which project and shade rely: the scene's bytes may have changed
   since it was opened. Returns 0 or FXS_ERR_SCENE. */
FXS_STAGE int fxs_chunk_read(fxs_chunk *header, const fxs_scene *scene, uint32_t chunk);

/* Reads and places a chunk. Returns 1, or 0 where nothing of it can be seen (behind the near plane, or beside the
   picture by more than its largest Gaussian reaches), or FXS_ERR_SCENE. */
FXS_STAGE int fxs_chunk_view_init(fxs_chunk_view *cv, const fxs_view *view, const fxs_scene *scene, uint32_t chunk);

/* fxs_shade_c with a header that was read and the chunk's rows. */
void fxs_shade_list(const fxs_view *view, const fxs_scene *scene, const fxs_chunk *header, const unsigned char *rows,
                    const uint32_t *indices, uint32_t count, fxs_splat *splats);

/* -2 ln(opacity of a code) under each law (packed.h), Q11; code 0 is never drawn. */
extern const uint16_t fxs_offset_of_code_q11[FXS_OPACITY_LAWS][256];

/* Sorts keys by depth, ties by slot (they arrive in the order of their slots), in `parts` jobs. `spare` has room for
   as many, `histograms` for `parts`. Returns where the result is: keys or spare. */
fxs_key *fxs_sort(const fxs_config *config, fxs_key *keys, fxs_key *spare, uint32_t count,
                  uint32_t (*histograms)[FXS_SORT_BUCKETS], uint32_t parts);

/* A stretch of sorted keys, and the boxes of their slots in the same order. */
typedef struct fxs_sorted {
    const fxs_key *keys;
    fxs_box *boxes;
    uint32_t count;
} fxs_sorted;

/* Tile columns or rows, first to last; none where first > last. */
typedef struct fxs_span {
    int32_t first, last;
} fxs_span;

/* The tile rows in which a splat may be listed. */
FXS_STAGE fxs_span fxs_bin_rows(const fxs_view *view, const fxs_splat *splat, const fxs_bounds *bounds);

/* Fetches the boxes of a stretch from `boxes` (by slot) and adds 1 to counts[tile] for every tile that each is in. */
void fxs_bin_count(const fxs_view *view, const fxs_splat *splats, const fxs_bounds *bounds, const fxs_box *boxes,
                   const fxs_sorted *sorted, uint32_t *counts);

/* Lists a stretch in tiles first_tile to last_tile: for each key in order, and each such tile that it is in,
   entries[next[tile]++] = slot. */
void fxs_bin_fill(const fxs_view *view, const fxs_splat *splats, const fxs_bounds *bounds, const fxs_sorted *sorted,
                  uint32_t first_tile, uint32_t last_tile, uint32_t *next, uint32_t *entries);

#endif
