/* src/codes.h, four Gaussians at a time. */
#ifndef FXS_CODES_NEON_H
#define FXS_CODES_NEON_H

#include <arm_neon.h>

#include "../../src/codes.h"

typedef struct codes_neon {
    uint32x4_t position[3], rotation, scale, colour;
} codes_neon;

static inline uint32x4_t load_words(const unsigned char *row, uint32_t i)
{
    return vld1q_u32((const uint32_t *)(const void *)row + i);
}

static inline uint32x4_t load_halves(const unsigned char *row, uint32_t i)
{
    return vmovl_u16(vld1_u16((const uint16_t *)(const void *)row + i));
}

/* The bits from `shift` on, `mask` of them. */
static inline uint32x4_t field(uint32x4_t word, int shift, uint32_t mask)
{
    return vandq_u32(vshlq_u32(word, vdupq_n_s32(-shift)), vdupq_n_u32(mask));
}

/* fxs_spread_11 */
static inline uint32x4_t spread_11(uint32x4_t code)
{
    return vorrq_u32(vshlq_n_u32(code, 5), vshrq_n_u32(code, 6));
}

/* 7 bits to 10 */
static inline uint32x4_t spread_7(uint32x4_t code)
{
    return vorrq_u32(vshlq_n_u32(code, 3), vshrq_n_u32(code, 4));
}

static inline uint32x4_t join(uint32x4_t x, uint32x4_t y, int y_bit, uint32x4_t z, int z_bit)
{
    return vorrq_u32(vorrq_u32(x, vshlq_u32(y, vdupq_n_s32(y_bit))), vshlq_u32(z, vdupq_n_s32(z_bit)));
}

static inline codes_neon load_small(const unsigned char *rows, uint32_t i)
{
    const uint32x4_t a = load_words(rows + FXS_SMALL_A, i), b = load_words(rows + FXS_SMALL_B, i);
    const uint32x4_t c = load_words(rows + FXS_SMALL_C, i);
    uint32_t four;
    memcpy(&four, rows + FXS_SMALL_D + i, sizeof four);
    const uint32x4_t d = vmovl_u16(vget_low_u16(vmovl_u8(vcreate_u8(four))));
    codes_neon codes;
    codes.position[0] = spread_11(field(a, 0, 2047));
    codes.position[1] = spread_11(field(a, 11, 2047));
    codes.position[2] = spread_11(field(b, 0, 2047));
    const uint32x4_t q1 = join(field(c, 27, 31), field(b, 31, 1), 5, field(d, 7, 1), 6);
    codes.rotation = join(spread_7(field(d, 0, 127)), spread_7(q1), 10, spread_7(field(c, 20, 127)), 20);
    codes.rotation = vorrq_u32(codes.rotation, vshlq_n_u32(field(a, 22, 3), 30));
    const uint32x4_t thin = field(c, 14, 63), blue = field(b, 25, 63);
    const uint32x4_t red = field(b, 11, 127), green = field(b, 18, 127);
    codes.scale = join(spread_7(field(c, 0, 127)), spread_7(field(c, 7, 127)), 10,
                       vorrq_u32(vshlq_n_u32(thin, 4), vshrq_n_u32(thin, 2)), 20);
    codes.colour = join(vorrq_u32(vshlq_n_u32(red, 1), vshrq_n_u32(red, 6)),
                        vorrq_u32(vshlq_n_u32(green, 1), vshrq_n_u32(green, 6)), 8,
                        vorrq_u32(vshlq_n_u32(blue, 2), vshrq_n_u32(blue, 4)), 16);
    codes.colour = vorrq_u32(codes.colour, vandq_u32(a, vdupq_n_u32(0xff000000u)));
    return codes;
}

static inline codes_neon load_codes(const fxs_scene *scene, const unsigned char *rows, uint32_t i)
{
    if (scene->profile == FXS_PROFILE_SMALL)
        return load_small(rows, i);
    codes_neon codes;
    for (uint32_t k = 0; k < 3; k++)
        codes.position[k] = load_halves(rows + FXS_ROW_POSITION, k * FXS_CHUNK + i);
    codes.rotation = load_words(rows + FXS_ROW_ROTATION, i);
    codes.scale = load_words(rows + FXS_ROW_SCALE, i);
    codes.colour = load_words(rows + FXS_ROW_COLOUR, i);
    return codes;
}

#endif
