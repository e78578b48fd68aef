/* Computes a splat's colour from spherical harmonics (SH) and the view direction: max(0, 0.5 + sum basis *
 * coefficient). Basis and signs are as in Kerbl et al. 2023 and KHR_gaussian_splatting. */
#include "codes.h"
#include <fixsplat/internal/fixed.h>

#define Q15(x_millionths) ((int32_t)(((int64_t)(x_millionths) * 32768 + 500000) / 1000000))

/* Returns the unit vector from the camera to a Gaussian, Q15. */
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
        int64_t x = fxs_round_shift(fxs_mul_add(d[i] * (1 << zeros / 2), (int32_t)inverse_q30, 0), 31);
        d_q15[i] = fxs_clamp((int32_t)x, -32767, 32767);
    }
}

/* Computes the spherical harmonics (SH) basis functions of degree 1 to `degree` in a direction, Q15. They are at most
   0.75. */
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

/* Adds the colour of spherical harmonics (SH) degree d to a splat's colour sums: step * sum of basis * code, Q16. `sh`
   points to the first code of red. */
static inline void add_band(int32_t sum_q16[3], const int8_t *sh, const int32_t b_q15[15], int d, int step_q19)
{
    int32_t band_q15[3] = {0, 0, 0};
    for (int k = FXS_SH_COUNT(d - 1); k < FXS_SH_COUNT(d); k++) {
        const int8_t *codes = sh + 3 * k * FXS_CHUNK;
        band_q15[0] += b_q15[k] * codes[0];
        band_q15[1] += b_q15[k] * codes[FXS_CHUNK];
        band_q15[2] += b_q15[k] * codes[2 * FXS_CHUNK];
    }
    for (int c = 0; c < 3; c++)
        sum_q16[c] += (((band_q15[c] + 512) >> 10) * step_q19 + 128) >> 8;
}

static void add_entry(fxs_sh_sums *s, const int8_t *entry, int sign, const int32_t b_q15[15])
{
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 15; k++)
            s->palette[c] += b_q15[k] * sign * entry[16 * c + k];
}

static void add_residual(fxs_sh_sums *s, const unsigned char *record, int degree, const int32_t b_q15[15])
{
    for (int c = 0; c < 3; c++) {
        uint64_t codes = fxs_residual(record, degree, c);
        for (int k = 0; k < 15; k++, codes >>= 3)
            s->odd[c] += b_q15[k] * (2 * (int32_t)((codes & 7) ^ 4) - 7);
    }
    s->gain = record[FXS_GAIN_BYTE];
}

static fxs_sh_sums sum_of(const fxs_scene *scene, const fxs_chunk *chunk, const unsigned char *record,
                          const int32_t b_q15[15])
{
    fxs_sh_sums s = {{0, 0, 0}, {0, 0, 0}, 0};
    add_entry(&s, chunk->sh_mean, 1, b_q15);
    for (uint32_t stage = 0; stage < fxs_palette_stages(scene->profile, scene->sh_degree); stage++)
        add_entry(&s, fxs_palette_entry(scene, stage, record[stage]), record[stage] & FXS_PALETTE_NEGATIVE ? -1 : 1,
                  b_q15);
    if (scene->profile == FXS_PROFILE_COMPACT)
        add_residual(&s, record, scene->sh_degree, b_q15);
    return s;
}

static void basis_at(int32_t b_q15[15], const fxs_stage_view *view, const fxs_chunk *chunk, const uint16_t position[3])
{
    int64_t offset_q32[3];
    int32_t d_q15[3];
    for (int k = 0; k < 3; k++) {
        int64_t reach = (int64_t)chunk->step_q32[k] * position[k] << chunk->step_shift;
        offset_q32[k] = chunk->origin_q32[k] - view->eye_q32[k] + reach;
    }
    direction(d_q15, offset_q32);
    if (view->sh_degree < 3)
        memset(b_q15, 0, 15 * sizeof *b_q15);
    basis(b_q15, d_q15, view->sh_degree);
}

static void directional(int32_t sum_q16[3], const fxs_stage_view *view, const fxs_scene *scene, const fxs_chunk *chunk,
                        const unsigned char *rows, uint32_t g, const uint16_t position[3])
{
    int32_t b_q15[15];
    basis_at(b_q15, view, chunk, position);
    if (scene->palette) {
        const fxs_sh_sums s = sum_of(scene, chunk, fxs_sh_record(scene, rows, g), b_q15);
        for (int c = 0; c < 3; c++)
            sum_q16[c] += fxs_sh_sum_q16(&s, scene, c);
        return;
    }
    const int8_t *sh = (const int8_t *)rows + FXS_ROW_SH + g;
    add_band(sum_q16, sh, b_q15, 1, chunk->sh_step_q19[0]);
    if (view->sh_degree > 1)
        add_band(sum_q16, sh, b_q15, 2, chunk->sh_step_q19[1]);
    if (view->sh_degree > 2)
        add_band(sum_q16, sh, b_q15, 3, chunk->sh_step_q19[2]);
}

/* Computes the colour of a splat from the codes of its Gaussian, and from its SH, number g of the rows. */
static void shade_codes(fxs_splat *splat, const fxs_stage_view *view, const fxs_scene *scene, const fxs_chunk *chunk,
                        const unsigned char *rows, uint32_t g, const fxs_codes *codes)
{
    int32_t sum_q16[3];
    for (int c = 0; c < 3; c++) {
        uint32_t step = chunk->colour_step_q20[c] * fxs_colour_code(codes, c);
        sum_q16[c] = chunk->colour_q16[c] + (int32_t)((step + 8) >> 4);
    }
    if (view->sh_degree > 0)
        directional(sum_q16, view, scene, chunk, rows, g, codes->position);
    for (int c = 0; c < 3; c++)
        splat->colour_q13[c] = (int16_t)fxs_clamp((sum_q16[c] + 4) >> 3, 0, 32767);
}

static void shade_one(fxs_splat *splat, const fxs_stage_view *view, const fxs_scene *scene, const fxs_chunk *chunk,
                      const unsigned char *rows, uint32_t g)
{
    const fxs_codes codes = fxs_codes_of(scene, rows, g);
    shade_codes(splat, view, scene, chunk, rows, g, &codes);
}

void fxs_shade_list(const fxs_stage_view *view, const fxs_scene *scene, const fxs_chunk *header,
                    const unsigned char *rows, const uint32_t *indices, uint32_t count, fxs_splat *splats)
{
    for (uint32_t i = 0; i < count; i++)
        shade_one(&splats[i], view, scene, header, rows, indices[i] % FXS_CHUNK);
}

int fxs_shade_c(const fxs_stage_view *view, const fxs_scene *scene, uint32_t chunk, const uint32_t *indices,
                uint32_t count, fxs_splat *splats)
{
    fxs_chunk header;
    const int error = fxs_chunk_read(&header, scene, chunk);
    if (!error)
        fxs_shade_list(view, scene, &header, fxs_rows(scene, chunk), indices, count, splats);
    return error;
}
