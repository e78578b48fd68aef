/* The packed scene: what an importer writes and the renderer reads in place, in memory or from a mapped .fxs file.
 * Little-endian, aligned to 64.
 *
 *   fxs_packed_header, then chunk_count chunks, each
 *       fxs_chunk                          128 bytes: how the codes of these 256 Gaussians are read
 *       uint16_t x[256], y[256], z[256]    position codes
 *       uint32_t rotation[256]             bits 31..30: which of w, x, y, z is the largest; then the others, in
 *                                          that order, 10 bits each, from bit 20 down
 *       uint32_t scale[256]                three codes of 10 bits: x in bits 9..0, y, z; bits 31..30 are 0
 *       uint32_t colour[256]               r in bits 7..0, g, b, opacity in bits 31..24
 *       int8_t   sh[3 * K][256]            K = 0, 3, 8, 15 for degree 0..3; row 3 * k + channel
 *
 * Rows are whole, so that 16, 32 or 64 neighbours load at once. The Gaussians lie along a Morton curve, so that a
 * chunk is small in space. The last chunk is padded with opacity 0. */
#ifndef FXS_PACKED_H
#define FXS_PACKED_H

#include <stdint.h>

#define FXS_CHUNK 256
#define FXS_PACKED_MAGIC 0x31535846u      /* "FXS1" */
#define FXS_PACKED_VERSION 1u
#define FXS_PACKED_ANTIALIASED 1u

typedef struct fxs_packed_header {   /* 128 bytes */
    uint32_t magic, version;
    uint32_t count, chunk_count;
    uint32_t chunk_bytes;
    uint32_t sh_degree;
    uint32_t flags;                  /* FXS_PACKED_ANTIALIASED */
    uint32_t checksum[1];            /* in a file: CRC-32 of the header with 0 here; in memory: 0 */
    int64_t low_q32[3], high_q32[3];               /* bounds of the centres; not read by the renderer */
    int64_t inner_low_q32[3], inner_high_q32[3];   /* the same for the middle 90 % on each axis */
} fxs_packed_header;

typedef struct fxs_chunk {           /* 128 bytes */
    int64_t origin_q32[3];           /* position = origin + (code * step << step_shift), within +-2^28 units */
    uint32_t step_q32[3];
    uint32_t step_shift;             /* 0 to 12 */
    int32_t scale_q16;               /* log2(sigma) = scale - code^2 * scale_step, within +-32: large sigmas, which */
    uint32_t scale_step_q24;         /* cover many pixels, get the fine steps; at most 1026 */
    int32_t colour_q16[3];           /* 0.5 + C0 dc = colour + code * colour_step, within +-64 */
    uint32_t colour_step_q20[3];
    uint32_t sh_step_q19[3];         /* a coefficient of degree d is code * sh_step[d - 1]; at most 32767 */
    uint32_t checksum;               /* in a file: CRC-32 of the chunk with 0 here; in memory: 0 */
    uint32_t reserved[8];            /* 0 */
} fxs_chunk;

#define FXS_CHUNK_POSITION 128u                          /* offsets in a chunk, in bytes */
#define FXS_CHUNK_ROTATION (FXS_CHUNK_POSITION + 6u * FXS_CHUNK)
#define FXS_CHUNK_SCALE (FXS_CHUNK_ROTATION + 4u * FXS_CHUNK)
#define FXS_CHUNK_COLOUR (FXS_CHUNK_SCALE + 4u * FXS_CHUNK)
#define FXS_CHUNK_SH (FXS_CHUNK_COLOUR + 4u * FXS_CHUNK)

/* SH coefficients a channel above degree 0: 0, 3, 8, 15. */
#define FXS_SH_COUNT(degree) (((degree) + 1) * ((degree) + 1) - 1)

#define FXS_CHUNK_BYTES(degree) (FXS_CHUNK_SH + 3u * (uint32_t)FXS_SH_COUNT(degree) * FXS_CHUNK)

#endif
