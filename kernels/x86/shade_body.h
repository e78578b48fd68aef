/* shade, LANES Gaussians at a time: src/shade.c with the same numbers in the same order. Include lanes_avx2.h
 * or lanes_avx512.h first. */
#include "../../src/memory.h"

#include "../../src/stage.h"
#include "lanes.h"

/* A constant of the basis, Q15. */
#define Q15(x_millionths) ((int32_t)(((int64_t)(x_millionths) * 32768 + 500000) / 1000000))

static inline wide offset_q32(const fxs_view *view, const fxs_chunk *chunk, int axis, const uint16_t *position)
{
    wide x = mul_wide_u((vu)load_u16(position), (vu)all((int32_t)chunk->step_q32[axis]));
    x.even <<= chunk->step_shift;
    x.odd <<= chunk->step_shift;
    return offset_wide(x, chunk->origin_q32[axis] - view->position_q32[axis]);
}

static inline void direction(vi d_q15[3], const wide offset_q32[3])
{
    wide largest = {(vw)all(0), (vw)all(0)};
    vi d[3];
    for (int i = 0; i < 3; i++) {
        largest.even |= magnitude_64(offset_q32[i].even);
        largest.odd |= magnitude_64(offset_q32[i].odd);
    }
    vi shift = most(49 - clz_64(narrow(largest, 32), narrow(largest, 0) | 1), all(0));
    for (int i = 0; i < 3; i++)
        d[i] = narrow_by(offset_q32[i], shift);
    vu square = (vu)d[0] * (vu)d[0] + (vu)d[1] * (vu)d[1] + (vu)d[2] * (vu)d[2];
    vi zeros = clz(square) & ~1;
    vi inverse_q30 = (vi)rsqrt(shift_left(square, zeros));
    for (int i = 0; i < 3; i++)
        d_q15[i] = clamp(scale_down_wide(mul_wide(d[i], inverse_q30), 31 - (zeros >> 1)), all(-32767), all(32767));
}

/* x / 2^shift, towards 0. */
static inline vi divide(vi x, int shift)
{
    const int32_t rest = (1 << shift) - 1;
    return (x + (x >> 31 & rest)) >> shift;
}

static inline vi scale_q15(int32_t constant_q15, vi x)
{
    return (x * constant_q15 + 16384) >> 15;
}

static inline void basis(vi b[15], const vi d_q15[3], int degree)
{
    const vi x = d_q15[0], y = d_q15[1], z = d_q15[2];
    b[0] = scale_q15(-Q15(488603), y);
    b[1] = scale_q15(Q15(488603), z);
    b[2] = scale_q15(-Q15(488603), x);
    if (degree < 2)
        return;
    const vi xx = mul_q15(x, x), yy = mul_q15(y, y), zz = mul_q15(z, z);
    const vi xy = mul_q15(x, y), yz = mul_q15(y, z), xz = mul_q15(x, z);
    b[3] = 2 * scale_q15(Q15(546274), xy);
    b[4] = -2 * scale_q15(Q15(546274), yz);
    b[5] = scale_q15(Q15(315392), 2 * zz - xx - yy);
    b[6] = -2 * scale_q15(Q15(546274), xz);
    b[7] = scale_q15(Q15(546274), xx - yy);
    if (degree < 3)
        return;
    const vi zz_xx_yy = divide(4 * zz - xx - yy, 2);
    b[8] = -2 * mul_q15(scale_q15(Q15(590044), y), divide(3 * xx - yy, 1));
    b[9] = 4 * mul_q15(scale_q15(Q15(722653), xy), z);
    b[10] = -4 * mul_q15(scale_q15(Q15(457046), y), zz_xx_yy);
    b[11] = 4 * mul_q15(scale_q15(Q15(373176), z), divide(2 * zz - 3 * xx - 3 * yy, 2));
    b[12] = -4 * mul_q15(scale_q15(Q15(457046), x), zz_xx_yy);
    b[13] = 2 * mul_q15(scale_q15(Q15(722653), z), xx - yy);
    b[14] = -2 * mul_q15(scale_q15(Q15(590044), x), divide(xx - 3 * yy, 1));
}

/* One channel above degree 0. The basis fits 16 bits; above them it is 0 here. */
static inline vi bands(const int8_t *codes, const vi b_q15[15], const uint32_t step_q19[3], int degree)
{
    vi sum_q16 = all(0);
    for (int d = 1, k = 0; d <= degree; d++) {
        vi band_q15 = all(0);
        for (int end = FXS_SH_COUNT(d); k < end; k++)
            band_q15 += mul_16(load_i8(codes + 3 * k * FXS_CHUNK), b_q15[k]);
        sum_q16 += (((band_q15 + 512) >> 10) * (int32_t)step_q19[d - 1] + 128) >> 8;
    }
    return sum_q16;
}

/* The Gaussians first to first + LANES - 1. */
static inline void colours(vi colour_q13[3], const fxs_view *view, const unsigned char *chunk, uint32_t first)
{
    const fxs_chunk *header = (const fxs_chunk *)(const void *)chunk;
    const uint16_t *position = (const uint16_t *)(const void *)(chunk + FXS_CHUNK_POSITION) + first;
    const int8_t *sh = (const int8_t *)(chunk + FXS_CHUNK_SH) + first;
    vi colour = load(chunk + FXS_CHUNK_COLOUR + 4 * first), b_q15[15];
    if (view->sh_degree > 0) {
        vi d_q15[3];
        wide offset[3];
        for (int k = 0; k < 3; k++)
            offset[k] = offset_q32(view, header, k, position + k * FXS_CHUNK);
        direction(d_q15, offset);
        basis(b_q15, d_q15, view->sh_degree);
        for (int k = 0; k < FXS_SH_COUNT(view->sh_degree); k++)
            b_q15[k] &= 65535;
    }
    for (int k = 0; k < 3; k++) {
        vi step = (colour >> 8 * k & 255) * (int32_t)header->colour_step_q20[k];
        vi sum_q16 = header->colour_q16[k] + ((step + 8) >> 4);
        if (view->sh_degree > 0)
            sum_q16 += bands(sh + k * FXS_CHUNK, b_q15, header->sh_step_q19, view->sh_degree);
        colour_q13[k] = clamp((sum_q16 + 4) >> 3, all(0), all(32767));
    }
}

static inline void shade(const fxs_view *view, const unsigned char *chunk, const uint32_t *indices, uint32_t count,
                         fxs_splat *splats)
{
    for (uint32_t i = 0, end; i < count; i = end) {
        const uint32_t first = indices[i] & ~(LANES - 1u);
        for (end = i + 1; end < count && indices[end] - first < LANES; end++)
            ;
        if (end - i == 1) {            /* a vector costs as much as one or two Gaussians in C */
            fxs_shade_c(view, chunk, indices + i, 1, splats + i);
            continue;
        }
        vi colour_q13[3];
        int32_t red_green[LANES], blue[LANES];
        colours(colour_q13, view, chunk, first % FXS_CHUNK);
        store(red_green, colour_q13[0] | colour_q13[1] << 16);
        store(blue, colour_q13[2]);
        for (; i < end; i++) {
            const uint32_t lane = indices[i] % LANES;
            memcpy(splats[i].colour_q13, &red_green[lane], sizeof red_green[lane]);
            splats[i].colour_q13[2] = (int16_t)blue[lane];
        }
    }
}
