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

/* 12 bits to 16 */
static inline uint32x4_t spread_12(uint32x4_t code)
{
    return vorrq_u32(vshlq_n_u32(code, 4), vshrq_n_u32(code, 8));
}

/* Three codes of 8 bits to three of 10. */
static inline uint32x4_t spread_8(uint32x4_t x, uint32x4_t y, uint32x4_t z)
{
    uint32x4_t word = vorrq_u32(vorrq_u32(x, vshlq_n_u32(y, 10)), vshlq_n_u32(z, 20));
    return vorrq_u32(vshlq_n_u32(word, 2), field(word, 6, 0x00300c03));
}

static inline codes_neon load_small(const unsigned char *rows, uint32_t i)
{
    const uint32x4_t a = load_words(rows + FXS_SMALL_A, i), b = load_words(rows + FXS_SMALL_B, i);
    const uint32x4_t c = load_words(rows + FXS_SMALL_C, i), d = load_halves(rows + FXS_SMALL_D, i);
    uint32_t four;
    memcpy(&four, rows + FXS_SMALL_E + i, sizeof four);
    const uint16x4_t e = vget_low_u16(vmovl_u8(vcreate_u8(four)));
    codes_neon codes;
    codes.position[0] = spread_12(field(a, 0, 4095));
    codes.position[1] = spread_12(field(a, 12, 4095));
    codes.position[2] = spread_12(field(b, 0, 4095));
    codes.rotation = spread_8(field(d, 8, 255), field(d, 0, 255), field(c, 24, 255));
    codes.rotation = vorrq_u32(codes.rotation, vshlq_n_u32(field(b, 12, 3), 30));
    codes.scale = spread_8(field(c, 0, 255), field(c, 8, 255), field(c, 16, 255));
    codes.colour = vorrq_u32(field(b, 16, 65535), vshll_n_u16(e, 16));
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
