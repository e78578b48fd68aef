/* shade: 8 neighbours of a chunk at once, whether visible or not; the colours of those that are go to their splats. */
#include "arm.h"
#include "codes_neon.h"
#include "fixed_neon.h"

#define LANES 8u
/* A constant of the basis, Q15. */
#define Q15(x_millionths) ((int32_t)(((int64_t)(x_millionths) * 32768 + 500000) / 1000000))

/* x / 2 and x / 4, rounded towards 0 */
static inline int32x4_t half(int32x4_t x)
{
    return vshrq_n_s32(vsubq_s32(x, vshrq_n_s32(x, 31)), 1);
}

static inline int32x4_t quarter(int32x4_t x)
{
    return vshrq_n_s32(vaddq_s32(x, vandq_s32(vshrq_n_s32(x, 31), vdupq_n_s32(3))), 2);
}

/* From the camera to two Gaussians, along one axis. */
static inline int64x2_t offset_q32(const fxs_view *view, const fxs_chunk *header, int axis, uint32x2_t code)
{
    uint64x2_t step_q32 = vshlq_u64(vmull_n_u32(code, header->step_q32[axis]), vdupq_n_s64(header->step_shift));
    return vaddq_s64(vdupq_n_s64(header->origin_q32[axis] - view->eye_q32[axis]), vreinterpretq_s64_u64(step_q32));
}

/* Unit vectors from the camera to four Gaussians. */
static inline void direction(int32x4_t d_q15[3], const fxs_view *view, const fxs_chunk *header,
                             const uint32x4_t position[3])
{
    int64x2_t low[3], high[3];
    uint64x2x2_t most = {{vdupq_n_u64(1), vdupq_n_u64(1)}};
    uint32x4_t square = vdupq_n_u32(0);
    for (int i = 0; i < 3; i++) {
        low[i] = offset_q32(view, header, i, vget_low_u32(position[i]));
        high[i] = offset_q32(view, header, i, vget_high_u32(position[i]));
        most.val[0] = vorrq_u64(most.val[0], vreinterpretq_u64_s64(vabsq_s64(low[i])));
        most.val[1] = vorrq_u64(most.val[1], vreinterpretq_u64_s64(vabsq_s64(high[i])));
    }
    int32x4_t left = vminq_s32(vsubq_s32(clz64(most), vdupq_n_s32(49)), vdupq_n_s32(0));
    for (int i = 0; i < 3; i++) {
        d_q15[i] = vcombine_s32(vmovn_s64(vshlq_s64(low[i], vmovl_s32(vget_low_s32(left)))),
                                vmovn_s64(vshlq_s64(high[i], vmovl_high_s32(left))));
        square = vmlaq_u32(square, vreinterpretq_u32_s32(d_q15[i]), vreinterpretq_u32_s32(d_q15[i]));
    }
    square = vmaxq_u32(square, vdupq_n_u32(1));
    int32x4_t zeros = even_zeros(square), shift = vsubq_s32(vdupq_n_s32(31), vshrq_n_s32(zeros, 1));
    int32x4_t inverse_q30 = vreinterpretq_s32_u32(rsqrt(vshlq_u32(square, zeros)));
    for (int i = 0; i < 3; i++) {
        int32x4_t x = mul_round_shift(d_q15[i], inverse_q30, shift);
        d_q15[i] = vmaxq_s32(vminq_s32(x, vdupq_n_s32(32767)), vdupq_n_s32(-32767));
    }
}

/* basis() of src/shade.c for four Gaussians. */
static inline void basis(int32x4_t b[15], const int32x4_t d_q15[3], int degree)
{
    const int32x4_t x = d_q15[0], y = d_q15[1], z = d_q15[2];
    b[0] = mul_n_q15(y, -Q15(488603));
    b[1] = mul_n_q15(z, Q15(488603));
    b[2] = mul_n_q15(x, -Q15(488603));
    if (degree < 2)
        return;
    const int32x4_t xx = mul_q15(x, x), yy = mul_q15(y, y), zz = mul_q15(z, z), xx_yy = vsubq_s32(xx, yy);
    const int32x4_t xy = mul_q15(x, y), yz = mul_q15(y, z), xz = mul_q15(x, z), sum = vaddq_s32(xx, yy);
    b[3] = vmulq_n_s32(mul_n_q15(xy, Q15(546274)), 2);
    b[4] = vmulq_n_s32(mul_n_q15(yz, Q15(546274)), -2);
    b[5] = mul_n_q15(vsubq_s32(vmulq_n_s32(zz, 2), sum), Q15(315392));
    b[6] = vmulq_n_s32(mul_n_q15(xz, Q15(546274)), -2);
    b[7] = mul_n_q15(xx_yy, Q15(546274));
    if (degree < 3)
        return;
    const int32x4_t along_z = quarter(vsubq_s32(vmulq_n_s32(zz, 4), sum));
    const int32x4_t across_z = quarter(vmlsq_n_s32(vmulq_n_s32(zz, 2), sum, 3));
    b[8] = vmulq_n_s32(mul_q15(mul_n_q15(y, Q15(590044)), half(vsubq_s32(vmulq_n_s32(xx, 3), yy))), -2);
    b[9] = vmulq_n_s32(mul_q15(mul_n_q15(xy, Q15(722653)), z), 4);
    b[10] = vmulq_n_s32(mul_q15(mul_n_q15(y, Q15(457046)), along_z), -4);
    b[11] = vmulq_n_s32(mul_q15(mul_n_q15(z, Q15(373176)), across_z), 4);
    b[12] = vmulq_n_s32(mul_q15(mul_n_q15(x, Q15(457046)), along_z), -4);
    b[13] = vmulq_n_s32(mul_q15(mul_n_q15(z, Q15(722653)), xx_yy), 2);
    b[14] = vmulq_n_s32(mul_q15(mul_n_q15(x, Q15(590044)), half(vmlsq_n_s32(xx, yy, 3))), -2);
}

/* The basis functions of 8 Gaussians; at most 0.75, so 16 bits hold them. */
static void basis_8(int16x8_t b_q15[15], const fxs_view *view, const fxs_chunk *header, const codes_neon codes[2])
{
    int32x4_t d_q15[3], low[15], high[15];
    direction(d_q15, view, header, codes[0].position);
    basis(low, d_q15, view->sh_degree);
    direction(d_q15, view, header, codes[1].position);
    basis(high, d_q15, view->sh_degree);
    for (int k = 0; k < FXS_SH_COUNT(view->sh_degree); k++)
        b_q15[k] = vcombine_s16(vmovn_s32(low[k]), vmovn_s32(high[k]));
}

/* sum_q16 of 8 Gaussians, one channel. */
typedef struct sum_8 {
    int32x4_t low, high;
} sum_8;

/* + basis * code */
static inline void add_code(sum_8 *band_q15, int16x8_t b_q15, const int8_t *codes)
{
    int16x8_t code = vmovl_s8(vld1_s8(codes));
    band_q15->low = vmlal_s16(band_q15->low, vget_low_s16(b_q15), vget_low_s16(code));
    band_q15->high = vmlal_high_s16(band_q15->high, b_q15, code);
}

/* + step * band */
static inline void add_band(sum_8 *sum_q16, sum_8 band_q15, int32_t step_q19)
{
    sum_q16->low = vrsraq_n_s32(sum_q16->low, vmulq_n_s32(vrshrq_n_s32(band_q15.low, 10), step_q19), 8);
    sum_q16->high = vrsraq_n_s32(sum_q16->high, vmulq_n_s32(vrshrq_n_s32(band_q15.high, 10), step_q19), 8);
}

/* Adds what is above degree 0. */
static void add_bands(sum_8 sum_q16[3], const int8_t *codes, const int16x8_t b_q15[15], const uint16_t step_q19[3],
                      int degree)
{
    for (int d = 1, k = 0; d <= degree; d++) {
        sum_8 r = {vdupq_n_s32(0), vdupq_n_s32(0)}, g = r, b = r;
        for (int end = FXS_SH_COUNT(d); k < end; k++, codes += 3 * FXS_CHUNK) {
            add_code(&r, b_q15[k], codes);
            add_code(&g, b_q15[k], codes + FXS_CHUNK);
            add_code(&b, b_q15[k], codes + 2 * FXS_CHUNK);
        }
        add_band(&sum_q16[0], r, step_q19[d - 1]);
        add_band(&sum_q16[1], g, step_q19[d - 1]);
        add_band(&sum_q16[2], b, step_q19[d - 1]);
    }
}

/* One channel of degree 0. The step is below 2^23 / 255 * 2^4, so the product fits 32 bits. */
static inline int32x4_t degree_0_q16(const fxs_chunk *header, uint32x4_t colour, int channel)
{
    uint32x4_t code = vandq_u32(vshlq_u32(colour, vdupq_n_s32(-8 * channel)), vdupq_n_u32(255));
    int32x4_t step_q20 = vmulq_n_s32(vreinterpretq_s32_u32(code), (int32_t)header->colour_step_q20[channel]);
    return vrsraq_n_s32(vdupq_n_s32(header->colour_q16[channel]), step_q20, 4);
}

/* sum basis * number */
static inline int32_t dot(const int16x8_t b_q15[2], int16x8_t low, int16x8_t high)
{
    int32x4_t sum = vmull_s16(vget_low_s16(b_q15[0]), vget_low_s16(low));
    sum = vmlal_high_s16(sum, b_q15[0], low);
    sum = vmlal_s16(sum, vget_low_s16(b_q15[1]), vget_low_s16(high));
    return vaddvq_s32(vmlal_high_s16(sum, b_q15[1], high));
}

/* 8 codes of 3 bits, the first at bit `first` of `codes`, as odd numbers -7 to 7. */
static inline int16x8_t odd_numbers(uint64_t codes, int first)
{
    static const int64_t down[8] = {0, -3, -6, -9, -12, -15, -18, -21};
    const uint64x2_t word = vdupq_n_u64(codes >> first);
    uint16x4_t code[2];
    for (int i = 0; i < 2; i++) {
        uint32x2_t low = vmovn_u64(vshlq_u64(word, vld1q_s64(down + 4 * i)));
        uint32x2_t high = vmovn_u64(vshlq_u64(word, vld1q_s64(down + 4 * i + 2)));
        code[i] = vmovn_u32(vcombine_u32(low, high));
    }
    uint16x8_t low_bits = vandq_u16(vcombine_u16(code[0], code[1]), vdupq_n_u16(7));
    int16x8_t flipped = vreinterpretq_s16_u16(veorq_u16(low_bits, vdupq_n_u16(4)));
    return vsubq_s16(vshlq_n_s16(flipped, 1), vdupq_n_s16(7));
}

static fxs_sh_sums sum_of(const fxs_scene *scene, const fxs_chunk *header, const unsigned char *record,
                          const int16x8_t b_q15[2])
{
    fxs_sh_sums s = {{0, 0, 0}, {0, 0, 0}, record[FXS_GAIN_BYTE]};
    const uint32_t stages = fxs_palette_stages(scene->profile, scene->sh_degree);
    for (int c = 0; c < 3; c++) {
        const int8x16_t mean = vld1q_s8(header->sh_mean + 16 * c);
        int16x8_t low = vmovl_s8(vget_low_s8(mean)), high = vmovl_high_s8(mean);
        for (uint32_t stage = 0; stage < stages; stage++) {
            const int8x16_t entry = vld1q_s8(fxs_palette_entry(scene, stage, record[stage]) + 16 * c);
            const int8x8_t sign = vdup_n_s8(record[stage] & FXS_PALETTE_NEGATIVE ? -1 : 1);
            low = vmlal_s8(low, vget_low_s8(entry), sign);
            high = vmlal_s8(high, vget_high_s8(entry), sign);
        }
        s.palette[c] = dot(b_q15, low, high);
        if (scene->profile != FXS_PROFILE_COMPACT)
            continue;
        uint64_t codes = fxs_residual(record, scene->sh_degree, c);
        s.odd[c] = dot(b_q15, odd_numbers(codes, 0), odd_numbers(codes, 24));
    }
    return s;
}

/* Adds what a palette says to the lanes that are wanted, one at a time: their entries lie far apart. */
static void add_palette(sum_8 sum_q16[3], const fxs_scene *scene, const fxs_chunk *header, const unsigned char *rows,
                        uint32_t g, const int16x8_t b_q15[15], int degree, uint32_t wanted)
{
    int16_t by_function[16][LANES] = {{0}}, by_gaussian[LANES][16];
    int32_t more_q16[3][LANES] = {{0}};
    for (int k = 0; k < FXS_SH_COUNT(degree); k++)
        vst1q_s16(by_function[k], b_q15[k]);
    for (uint32_t lane = 0; lane < LANES; lane++) {
        if (!(wanted >> lane & 1))
            continue;
        for (int k = 0; k < 16; k++)
            by_gaussian[lane][k] = by_function[k][lane];
        const int16x8_t b[2] = {vld1q_s16(by_gaussian[lane]), vld1q_s16(by_gaussian[lane] + 8)};
        const fxs_sh_sums s = sum_of(scene, header, fxs_sh_record(scene, rows, g + lane), b);
        for (int c = 0; c < 3; c++)
            more_q16[c][lane] = fxs_sh_sum_q16(&s, scene, c);
    }
    for (int c = 0; c < 3; c++) {
        sum_q16[c].low = vaddq_s32(sum_q16[c].low, vld1q_s32(more_q16[c]));
        sum_q16[c].high = vaddq_s32(sum_q16[c].high, vld1q_s32(more_q16[c] + 4));
    }
}

/* The colours of the 8 Gaussians from g on; those of a bit in `wanted` at least. */
static void shade_8(int16_t colour_q13[3][LANES], const fxs_view *view, const fxs_scene *scene,
                    const fxs_chunk *header, const unsigned char *rows, uint32_t g, uint32_t wanted)
{
    const codes_neon codes[2] = {load_codes(scene, rows, g), load_codes(scene, rows, g + 4)};
    sum_8 sum_q16[3];
    for (int c = 0; c < 3; c++) {
        sum_q16[c].low = degree_0_q16(header, codes[0].colour, c);
        sum_q16[c].high = degree_0_q16(header, codes[1].colour, c);
    }
    if (view->sh_degree > 0) {
        int16x8_t b_q15[15];
        basis_8(b_q15, view, header, codes);
        if (scene->palette)
            add_palette(sum_q16, scene, header, rows, g, b_q15, view->sh_degree, wanted);
        else
            add_bands(sum_q16, (const int8_t *)rows + FXS_ROW_SH + g, b_q15, header->sh_step_q19, view->sh_degree);
    }
    for (int c = 0; c < 3; c++) {
        int16x8_t q13 = vqrshrn_high_n_s32(vqrshrn_n_s32(sum_q16[c].low, 3), sum_q16[c].high, 3);
        vst1q_s16(colour_q13[c], vmaxq_s16(q13, vdupq_n_s16(0)));
    }
}

int fxs_shade_neon(const fxs_view *view, const fxs_scene *scene, uint32_t chunk, const uint32_t *indices, uint32_t count,
                   fxs_splat *splats)
{
    const unsigned char *rows = fxs_rows(scene, chunk);
    fxs_chunk header;
    const int error = fxs_chunk_read(&header, scene, chunk);
    if (error)
        return error;
    for (uint32_t i = 0, end; i < count; i = end) {
        const uint32_t first = indices[i] & ~(LANES - 1u);
        int16_t colour_q13[3][LANES];
        uint32_t wanted = 0;
        for (end = i; end < count && indices[end] - first < LANES; end++)
            wanted |= 1u << (indices[end] - first);
        shade_8(colour_q13, view, scene, &header, rows, first % FXS_CHUNK, wanted);
        for (; i < end; i++)
            for (int c = 0; c < 3; c++)
                splats[i].colour_q13[c] = colour_q13[c][indices[i] % LANES];
    }
    return 0;
}
