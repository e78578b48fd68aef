/* shade: quantised SH and view direction -> colour = max(0, 0.5 + sum basis * coefficient). Basis functions and signs
 * as in Kerbl et al. 2023 (code) and KHR_gaussian_splatting, "Calculating color". */
#include "fixed.h"
#include "memory.h"
#include "stage.h"

/* A constant of the basis, Q15. */
#define Q15(x_millionths) ((int32_t)(((int64_t)(x_millionths) * 32768 + 500000) / 1000000))

/* Unit vector from the camera to a Gaussian: components to 15 bits, then times 1 / length. */
static void direction(int32_t d_q15[3], const int64_t offset_q32[3])
{
    uint64_t most = 1;
    for (int i = 0; i < 3; i++)
        most |= (uint64_t)(offset_q32[i] < 0 ? -offset_q32[i] : offset_q32[i]);
    int bits = 64 - fxs_clz64(most), shift = bits > 15 ? bits - 15 : 0;
    int32_t d[3];
    uint32_t square = 0;
    for (int i = 0; i < 3; i++) {
        d[i] = (int32_t)(offset_q32[i] >> shift);
        square += (uint32_t)(d[i] * d[i]);
    }
    int zeros = fxs_clz32(square + !square) & ~1;
    uint32_t inverse_q30 = fxs_rsqrt((square + !square) << zeros);
    for (int i = 0; i < 3; i++) {
        int64_t x = fxs_round_shift((int64_t)d[i] * inverse_q30, 31 - zeros / 2);
        d_q15[i] = fxs_clamp((int32_t)x, -32767, 32767);
    }
}

/* The basis functions of degree 1 to `degree`, Q15; each at most 0.75. */
static void basis(int32_t b[15], const int32_t d_q15[3], int degree)
{
    const int32_t x = d_q15[0], y = d_q15[1], z = d_q15[2];
    b[0] = fxs_mul_q15(-Q15(488603), y);
    b[1] = fxs_mul_q15(Q15(488603), z);
    b[2] = fxs_mul_q15(-Q15(488603), x);
    if (degree < 2)
        return;
    const int32_t xx = fxs_mul_q15(x, x), yy = fxs_mul_q15(y, y), zz = fxs_mul_q15(z, z);
    const int32_t xy = fxs_mul_q15(x, y), yz = fxs_mul_q15(y, z), xz = fxs_mul_q15(x, z);
    b[3] = 2 * fxs_mul_q15(Q15(546274), xy);
    b[4] = -2 * fxs_mul_q15(Q15(546274), yz);
    b[5] = fxs_mul_q15(Q15(315392), 2 * zz - xx - yy);
    b[6] = -2 * fxs_mul_q15(Q15(546274), xz);
    b[7] = fxs_mul_q15(Q15(546274), xx - yy);
    if (degree < 3)
        return;
    b[8] = -2 * fxs_mul_q15(fxs_mul_q15(Q15(590044), y), (3 * xx - yy) / 2);
    b[9] = 4 * fxs_mul_q15(fxs_mul_q15(Q15(722653), xy), z);
    b[10] = -4 * fxs_mul_q15(fxs_mul_q15(Q15(457046), y), (4 * zz - xx - yy) / 4);
    b[11] = 4 * fxs_mul_q15(fxs_mul_q15(Q15(373176), z), (2 * zz - 3 * xx - 3 * yy) / 4);
    b[12] = -4 * fxs_mul_q15(fxs_mul_q15(Q15(457046), x), (4 * zz - xx - yy) / 4);
    b[13] = 2 * fxs_mul_q15(fxs_mul_q15(Q15(722653), z), xx - yy);
    b[14] = -2 * fxs_mul_q15(fxs_mul_q15(Q15(590044), x), (xx - 3 * yy) / 2);
}

/* One channel above degree 0, Q16: sum over degrees of step * sum basis * code. */
static int32_t bands(const int8_t *codes, const int32_t b_q15[15], const uint32_t step_q19[3], int degree)
{
    int32_t sum_q16 = 0;
    for (int d = 1, k = 0; d <= degree; d++) {
        int32_t band_q15 = 0;
        for (int end = FXS_SH_COUNT(d); k < end; k++)
            band_q15 += b_q15[k] * codes[3 * k * FXS_CHUNK];
        sum_q16 += (((band_q15 + 512) >> 10) * (int32_t)step_q19[d - 1] + 128) >> 8;
    }
    return sum_q16;
}

void fxs_shade_c(const fxs_view *view, const unsigned char *chunk, const uint32_t *indices, uint32_t count,
                 fxs_splat *splats)
{
    const fxs_chunk *header = (const fxs_chunk *)(const void *)chunk;
    const uint16_t *position = (const uint16_t *)(const void *)(chunk + FXS_CHUNK_POSITION);
    const uint32_t *colour = (const uint32_t *)(const void *)(chunk + FXS_CHUNK_COLOUR);
    const int8_t *sh = (const int8_t *)(chunk + FXS_CHUNK_SH);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t g = indices[i] % FXS_CHUNK;
        int32_t d_q15[3], b_q15[15];
        if (view->sh_degree > 0) {
            int64_t offset_q32[3];
            for (uint32_t k = 0; k < 3; k++) {
                int64_t reach = (int64_t)header->step_q32[k] * position[k * FXS_CHUNK + g] << header->step_shift;
                offset_q32[k] = header->origin_q32[k] - view->position_q32[k] + reach;
            }
            direction(d_q15, offset_q32);
            basis(b_q15, d_q15, view->sh_degree);
        }
        for (int k = 0; k < 3; k++) {
            int64_t step = (int64_t)header->colour_step_q20[k] * (colour[g] >> 8 * k & 255);
            int32_t sum_q16 = header->colour_q16[k] + (int32_t)((step + 8) >> 4);
            if (view->sh_degree > 0)
                sum_q16 += bands(sh + k * FXS_CHUNK + g, b_q15, header->sh_step_q19, view->sh_degree);
            splats[i].colour_q13[k] = (int16_t)fxs_clamp((sum_q16 + 4) >> 3, 0, 32767);
        }
    }
}
