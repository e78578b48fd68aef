/* Decodes one Gaussian of a packed scene. A profile is an encoding of Gaussians: default, compact or small. */
#ifndef FXS_CODES_H
#define FXS_CODES_H

#include "chunk.h"
#include "memory.h"

/* Codes of a Gaussian in the layout of the default profile (encoding). Shorter codes of other profiles fill the high
   bits. */
typedef struct fxs_codes {
    uint16_t position[3];
    uint32_t rotation, scale, colour;
} fxs_codes;

static inline uint32_t fxs_word_at(const unsigned char *row, uint32_t g)
{
    uint32_t word;
    memcpy(&word, row + 4 * g, sizeof word);
    return fxs_little_32(word);
}

static inline uint16_t fxs_half_at(const unsigned char *row, uint32_t g)
{
    uint16_t half;
    memcpy(&half, row + 2 * g, sizeof half);
    return fxs_little_16(half);
}

/* Widens an 11-bit code to 16 bits by repeating its high bits. */
static inline uint16_t fxs_spread_11(uint32_t code)
{
    return (uint16_t)(code << 5 | code >> 6);
}

/* Widens a Gaussian's three scale codes of 7, 7 and 6 bits to 10, 10 and 9 bits. */
static inline uint32_t fxs_spread_scale(uint32_t x, uint32_t y, uint32_t z)
{
    return (x << 3 | x >> 4) | (y << 3 | y >> 4) << 10 | (z << 3 | z >> 3) << 20;
}

/* Widens the codes of red, green and blue, of 7, 7 and 6 bits, to 9 bits each. Returns the high 8 bits of each code. */
static inline uint32_t fxs_spread_colour(uint32_t r, uint32_t g, uint32_t b)
{
    return (r << 1 | r >> 6) | (g << 1 | g >> 6) << 8 | (b << 2 | b >> 4) << 16;
}

static inline uint32_t fxs_spread_colour_low(uint32_t r, uint32_t g, uint32_t b)
{
    return (r >> 5 & 1) << 29 | (g >> 5 & 1) << 30 | (b >> 3 & 1) << 31;
}

static inline fxs_codes fxs_small_codes(const unsigned char *rows, uint32_t g)
{
    const uint32_t a = fxs_word_at(rows + FXS_SMALL_A, g), b = fxs_word_at(rows + FXS_SMALL_B, g);
    const uint32_t c = fxs_word_at(rows + FXS_SMALL_C, g), d = rows[FXS_SMALL_D + g];
    fxs_codes codes = {{fxs_spread_11(a & 2047), fxs_spread_11(a >> 11 & 2047), fxs_spread_11(b & 2047)}, 0, 0, 0};
    codes.rotation = (c & 0xfff00000u) | d << 12 | (a >> 22 & 3) << 10 | (b >> 31) << 9;
    const uint32_t red = b >> 11 & 127, green = b >> 18 & 127, blue = b >> 25 & 63;
    codes.scale = fxs_spread_scale(c & 127, c >> 7 & 127, c >> 14 & 63) | fxs_spread_colour_low(red, green, blue);
    codes.colour = fxs_spread_colour(red, green, blue) | (a & 0xff000000u);
    return codes;
}

static inline uint32_t fxs_colour_code(const fxs_codes *codes, int channel)
{
    return (codes->colour >> 8 * channel & 255) << 1 | (codes->scale >> (29 + channel) & 1);
}

static inline const unsigned char *fxs_sh_record(const fxs_scene *scene, const unsigned char *rows, uint32_t g)
{
    return rows + (scene->profile == FXS_PROFILE_COMPACT ? FXS_ROW_SH : FXS_SMALL_SH) +
           g * fxs_sh_bytes(scene->profile, scene->sh_degree);
}

/* The compact profile (an encoding) stores residuals of spherical harmonics as 3-bit codes. Returns the codes of one
   colour channel; the first is in bits 2..0. */
static inline uint64_t fxs_residual(const unsigned char *record, int degree, int channel)
{
    const uint32_t bytes = fxs_sh_bytes(FXS_PROFILE_COMPACT, degree);
    const uint32_t bit = FXS_RESIDUAL_BIT + 3u * (uint32_t)(channel * FXS_SH_COUNT(degree));
    const uint32_t first = bit / 8 < bytes - 8 ? bit / 8 : bytes - 8;
    uint64_t word;
    memcpy(&word, record + first, sizeof word);
    return fxs_little_64(word) >> (bit - 8 * first);
}

/* Returns an entry of the scene's palette of spherical harmonics, an int8_t[3][16]. Ignores the sign in `index`. */
static inline const int8_t *fxs_palette_entry(const fxs_scene *scene, uint32_t stage, uint32_t index)
{
    index &= FXS_PALETTE_NEGATIVE - 1;
    index = index < scene->palette_entries ? index : scene->palette_entries - 1;
    return scene->palette + (size_t)(stage * scene->palette_entries + index) * FXS_PALETTE_STRIDE;
}

/* Sums of a Gaussian's spherical harmonics that are stored by palette entries. A coefficient is the chunk's mean plus
   one palette entry per stage, times the scene's step. The compact profile adds odd numbers, -7 to 7, times the
   Gaussian's gain. */
typedef struct fxs_sh_sums {
    int32_t palette[3], odd[3];    /* sums of basis function * coefficient in Q15; at most 2^29 in `palette`, 2^22 in
                                      `odd` */
    int gain;                      /* coded factor of the compact profile's odd numbers: (8 + bits 2..0) * 2^(bits 7..3)
                                      * 2^-32 */
} fxs_sh_sums;

static inline int32_t fxs_sh_sum_q16(const fxs_sh_sums *s, const fxs_scene *scene, int channel)
{
    int64_t palette_q34 = (int64_t)s->palette[channel] * scene->palette_step_q19;
    return (int32_t)(palette_q34 >> 18) + (s->odd[channel] * (8 + (s->gain & 7)) >> (31 - (s->gain >> 3)));
}

static inline fxs_codes fxs_codes_of(const fxs_scene *scene, const unsigned char *rows, uint32_t g)
{
    if (scene->profile == FXS_PROFILE_SMALL)
        return fxs_small_codes(rows, g);
    const unsigned char *position = rows + FXS_ROW_POSITION;
    return (fxs_codes){{fxs_half_at(position, g), fxs_half_at(position, FXS_CHUNK + g),
                        fxs_half_at(position, 2 * FXS_CHUNK + g)},
                       fxs_word_at(rows + FXS_ROW_ROTATION, g), fxs_word_at(rows + FXS_ROW_SCALE, g),
                       fxs_word_at(rows + FXS_ROW_COLOUR, g)};
}

/* Returns true if place g of a chunk (up to 256 Gaussians) holds no Gaussian. */
static inline int fxs_slot_is_empty(const fxs_scene *scene, const unsigned char *rows, uint32_t g)
{
    const fxs_codes codes = fxs_codes_of(scene, rows, g);
    return !codes.rotation && !(codes.colour >> 24);
}

#endif
