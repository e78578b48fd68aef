/* shade, LANES Gaussians at a time: src/shade.c with the same numbers in the same order. Include lanes_avx2.h
 * or lanes_avx512.h first. */
#include "codes_body.h"

/* A constant of the basis, Q15. */
#define Q15(x_millionths) ((int32_t)(((int64_t)(x_millionths) * 32768 + 500000) / 1000000))

static inline wide offset_q32(const fxs_view *view, const fxs_chunk *chunk, int axis, vi position)
{
    wide x = mul_wide_u((vu)position, (vu)all((int32_t)chunk->step_q32[axis]));
    x.even <<= chunk->step_shift;
    x.odd <<= chunk->step_shift;
    return offset_wide(x, chunk->origin_q32[axis] - view->eye_q32[axis]);
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
static inline vi bands(const int8_t *codes, const vi b_q15[15], const uint16_t step_q19[3], int degree)
{
    vi sum_q16 = all(0);
    for (int d = 1, k = 0; d <= degree; d++) {
        vi band_q15 = all(0);
        for (int end = FXS_SH_COUNT(d); k < end; k++)
            band_q15 += mul_16(load_i8(codes + 3 * k * FXS_CHUNK), b_q15[k]);
        sum_q16 += (((band_q15 + 512) >> 10) * step_q19[d - 1] + 128) >> 8;
    }
    return sum_q16;
}

/* The basis towards the Gaussians first to first + LANES - 1; 0 above the view's degree. */
static inline void basis_at(vi b_q15[16], const fxs_view *view, const fxs_chunk *chunk, const vi position[3])
{
    vi d_q15[3];
    wide offset[3];
    for (int k = 0; k < 3; k++)
        offset[k] = offset_q32(view, chunk, k, position[k]);
    direction(d_q15, offset);
    for (int k = FXS_SH_COUNT(view->sh_degree); k < 16; k++)
        b_q15[k] = all(0);
    basis(b_q15, d_q15, view->sh_degree);
    for (int k = 0; k < 16; k++)
        b_q15[k] &= 65535;
}

/* A basis of 16 bits for each of LANES Gaussians, from rows of one function each. */
static inline void basis_by_gaussian(__m256i b_q15[LANES], const vi rows[16])
{
    int32_t pairs[8][LANES];
    for (int k = 0; k < 8; k++)
        store(pairs[k], rows[2 * k] | rows[2 * k + 1] << 16);
    for (int lane = 0; lane < LANES; lane += 4)
        transpose(b_q15 + lane, pairs, lane);
}

/* The sum of each of three vectors. */
static inline void sum_each(int32_t sums[4], __m256i a, __m256i b, __m256i c)
{
    __m256i pairs = _mm256_hadd_epi32(_mm256_hadd_epi32(a, b), _mm256_hadd_epi32(c, c));
    _mm_storeu_si128((__m128i *)(void *)sums,
                     _mm_add_epi32(_mm256_castsi256_si128(pairs), _mm256_extracti128_si256(pairs, 1)));
}

/* The codes of a channel, 3 bits each from the low end of `codes`, as odd numbers -7 to 7: each in a window of 16 bits
   that is moved up until it is on top. */
static inline __m256i odd_numbers(uint64_t codes)
{
#define WINDOW(k) (char)(3 * (k) / 8), (char)(3 * (k) / 8 + 1)
#define UP(k) (short)(1 << (13 - 3 * (k) % 8))
    const __m256i windows = _mm256_setr_epi8(
        WINDOW(0), WINDOW(1), WINDOW(2), WINDOW(3), WINDOW(4), WINDOW(5), WINDOW(6), WINDOW(7),
        WINDOW(8), WINDOW(9), WINDOW(10), WINDOW(11), WINDOW(12), WINDOW(13), WINDOW(14), -1, -1);
    const __m256i up = _mm256_setr_epi16(UP(0), UP(1), UP(2), UP(3), UP(4), UP(5), UP(6), UP(7), UP(8), UP(9), UP(10),
                                         UP(11), UP(12), UP(13), UP(14), 0);
#undef WINDOW
#undef UP
    __m256i x = _mm256_shuffle_epi8(_mm256_set1_epi64x((int64_t)codes), windows);
    x = _mm256_srai_epi16(_mm256_mullo_epi16(x, up), 13);
    return _mm256_or_si256(_mm256_add_epi16(x, x), _mm256_set1_epi16(1));
}

/* A channel of an entry of the palette. */
static inline __m256i load_entry(const int8_t *entry, int channel)
{
    return _mm256_cvtepi8_epi16(_mm_loadu_si128((const __m128i *)(const void *)entry + channel));
}

static inline fxs_sh_sums sum_of(const fxs_scene *scene, const unsigned char *record, const __m256i mean[3],
                                 __m256i b_q15)
{
    fxs_sh_sums s;
    int32_t sums[4];
    __m256i numbers[3] = {mean[0], mean[1], mean[2]};
    for (uint32_t stage = 0; stage < fxs_palette_stages(scene->profile, scene->sh_degree); stage++) {
        const int8_t *entry = fxs_palette_entry(scene, stage, record[stage]);
        const __m256i sign = _mm256_set1_epi16(record[stage] & FXS_PALETTE_NEGATIVE ? -1 : 1);
        for (int c = 0; c < 3; c++)
            numbers[c] = _mm256_add_epi16(numbers[c], _mm256_sign_epi16(load_entry(entry, c), sign));
    }
    sum_each(sums, _mm256_madd_epi16(numbers[0], b_q15), _mm256_madd_epi16(numbers[1], b_q15),
             _mm256_madd_epi16(numbers[2], b_q15));
    memcpy(s.palette, sums, sizeof s.palette);
    if (scene->profile == FXS_PROFILE_COMPACT) {
        for (int c = 0; c < 3; c++)
            numbers[c] = _mm256_madd_epi16(odd_numbers(fxs_residual(record, scene->sh_degree, c)), b_q15);
        sum_each(sums, numbers[0], numbers[1], numbers[2]);
    } else {
        memset(sums, 0, sizeof sums);
    }
    memcpy(s.odd, sums, sizeof s.odd);
    s.gain = record[FXS_GAIN_BYTE];
    return s;
}

/* Adds what a palette says to the lanes that are wanted, one at a time: their entries lie far apart. */
static inline void add_palette(vi sum_q16[3], const fxs_scene *scene, const fxs_chunk *header,
                               const unsigned char *rows, uint32_t first, const vi b_q15[16], uint32_t wanted)
{
    const __m256i mean[3] = {load_entry(header->sh_mean, 0), load_entry(header->sh_mean, 1),
                             load_entry(header->sh_mean, 2)};
    __m256i by_gaussian[LANES];
    int32_t more_q16[3][LANES] = {{0}};
    basis_by_gaussian(by_gaussian, b_q15);
    for (uint32_t lane = 0; lane < LANES; lane++) {
        if (!(wanted >> lane & 1))
            continue;
        const fxs_sh_sums s = sum_of(scene, fxs_sh_record(scene, rows, first + lane), mean, by_gaussian[lane]);
        for (int c = 0; c < 3; c++)
            more_q16[c][lane] = fxs_sh_sum_q16(&s, scene, c);
    }
    for (int c = 0; c < 3; c++)
        sum_q16[c] += load(more_q16[c]);
}

/* The Gaussians first to first + LANES - 1; those of a bit in `wanted` at least. */
static inline void colours(vi colour_q13[3], const fxs_view *view, const fxs_scene *scene, const fxs_chunk *header,
                           const unsigned char *rows, uint32_t first, uint32_t wanted)
{
    vi colour = load_colours(scene, rows, first), sum_q16[3];
    for (int c = 0; c < 3; c++) {
        vi step = (colour >> 8 * c & 255) * (int32_t)header->colour_step_q20[c];
        sum_q16[c] = header->colour_q16[c] + ((step + 8) >> 4);
    }
    if (view->sh_degree > 0) {
        vi position[3], b_q15[16];
        load_positions(position, scene, rows, first);
        basis_at(b_q15, view, header, position);
        if (scene->palette)
            add_palette(sum_q16, scene, header, rows, first, b_q15, wanted);
        else
            for (int c = 0; c < 3; c++)
                sum_q16[c] += bands((const int8_t *)rows + FXS_ROW_SH + first + c * FXS_CHUNK, b_q15,
                                    header->sh_step_q19, view->sh_degree);
    }
    for (int c = 0; c < 3; c++)
        colour_q13[c] = clamp((sum_q16[c] + 4) >> 3, all(0), all(32767));
}

static inline int shade(const fxs_view *view, const fxs_scene *scene, uint32_t chunk, const uint32_t *indices,
                        uint32_t count, fxs_splat *splats)
{
    const unsigned char *rows = fxs_rows(scene, chunk);
    fxs_chunk header;
    const int error = fxs_chunk_read(&header, scene, chunk);
    if (error)
        return error;
    for (uint32_t i = 0, end; i < count; i = end) {
        const uint32_t first = indices[i] & ~(LANES - 1u);
        uint32_t wanted = 0;
        for (end = i; end < count && indices[end] - first < LANES; end++)
            wanted |= 1u << (indices[end] - first);
        if (end - i == 1) {            /* a vector costs as much as one or two Gaussians in C */
            fxs_shade_list(view, scene, &header, rows, indices + i, 1, splats + i);
            continue;
        }
        vi colour_q13[3];
        int32_t red_green[LANES], blue[LANES];
        colours(colour_q13, view, scene, &header, rows, first % FXS_CHUNK, wanted);
        store(red_green, colour_q13[0] | colour_q13[1] << 16);
        store(blue, colour_q13[2]);
        for (; i < end; i++) {
            const uint32_t lane = indices[i] % LANES;
            memcpy(splats[i].colour_q13, &red_green[lane], sizeof red_green[lane]);
            splats[i].colour_q13[2] = (int16_t)blue[lane];
        }
    }
    return 0;
}
