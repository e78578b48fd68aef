/* resolve: a row of 16 pixels a step. */
#include <arm_neon.h>
#include "../../src/memory.h"

#include "arm.h"

/* fxs_resolve_8bit: (255 c + 2^12) >> 13 = (1020 c + 2^14) >> 15. All in 0..32767, so nothing is cut but at 255. */
static inline uint8x8_t colour_8bit(const int16_t sum_q13[8], int16x8_t transmittance_q15, int16x8_t background_q13)
{
    int16x8_t c_q13 = vqaddq_s16(vld1q_s16(sum_q13), vqrdmulhq_s16(transmittance_q15, background_q13));
    return vqmovun_s16(vqrdmulhq_n_s16(c_q13, 1020));
}

/* fxs_coverage_8bit */
static inline uint8x8_t coverage_8bit(int16x8_t transmittance_q15)
{
    return vqmovun_s16(vqrdmulhq_n_s16(vsubq_s16(vdupq_n_s16(FXS_CLEAR_Q15), transmittance_q15), 255));
}

static inline void resolve_row(uint8_t rgba[4 * FXS_TILE], const fxs_tile *tile, int i,
                               const int16x8_t background_q13[3], uint8x16_t least_alpha)
{
    const int16x8_t t0 = vld1q_s16(tile->transmittance_q15 + i), t1 = vld1q_s16(tile->transmittance_q15 + i + 8);
    uint8x16x4_t out;
    for (int c = 0; c < 3; c++)
        out.val[c] = vcombine_u8(colour_8bit(tile->sum_q13[c] + i, t0, background_q13[c]),
                                 colour_8bit(tile->sum_q13[c] + i + 8, t1, background_q13[c]));
    out.val[3] = vorrq_u8(vcombine_u8(coverage_8bit(t0), coverage_8bit(t1)), least_alpha);
    vst4q_u8(rgba, out);
}

void fxs_resolve_neon(const fxs_options *options, enum fxs_format format, const fxs_tile *tile, int32_t columns,
                      int32_t rows, unsigned char *pixels, ptrdiff_t stride)
{
    const int coverage = format == FXS_FORMAT_RGBA8_COVERAGE;
    if (format != FXS_FORMAT_RGBA8 && !coverage) {
        fxs_resolve_c(options, format, tile, columns, rows, pixels, stride);
        return;
    }
    const uint8x16_t least_alpha = vdupq_n_u8(coverage ? 0 : 255);
    int16x8_t background_q13[3];
    for (int c = 0; c < 3; c++)
        background_q13[c] = vdupq_n_s16((int16_t)(coverage ? 0 : fxs_background_q13(options->background[c])));
    for (int32_t y = 0; y < rows; y++, pixels += stride) {
        uint8_t edge[4 * FXS_TILE];
        resolve_row(columns == FXS_TILE ? pixels : edge, tile, y * FXS_TILE, background_q13, least_alpha);
        if (columns < FXS_TILE)
            memcpy(pixels, edge, 4 * (size_t)columns);
    }
}
