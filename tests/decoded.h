/* Decodes a packed scene by the description in docs/format.md. Shares no code with the library. */
#ifndef DECODED_H
#define DECODED_H

#include <math.h>
#include <string.h>

#include "src/core/chunk.h"
#include <fixsplat/internal/packed.h>
#include "check.h"
#include "rotation_word.h"

static inline const fxs_chunk *chunk_of(const fxs_scene *scene, uint32_t i)
{
    static fxs_chunk header;
    CHECK(fxs_chunk_read(&header, scene, i / FXS_CHUNK) == 0);
    return &header;
}

static inline const unsigned char *rows_of(const fxs_scene *scene, uint32_t i)
{
    return scene->rows + (size_t)(i / FXS_CHUNK) * scene->chunk_bytes;
}

static inline double position_step(const fxs_chunk *chunk, uint32_t axis)
{
    return ldexp(chunk->step_q32[axis], (int)chunk->step_shift - 32);
}

static inline double opacity_of(uint32_t code, uint32_t law)
{
    const double part = (code - 1.0) / 254, top = law == 1 ? 1 : law == 2 ? 1 / 4.0 : 1 / 16.0;
    return law == 0 ? code / 255.0 : code == 0 ? 0 : 1 / 255.0 + (top - 1 / 255.0) * part * part;
}

/* Extends a code (quantised number) to `wide` bits by repeating its high bits. */
static inline uint32_t widen(uint32_t code, int bits, int wide)
{
    return code << (wide - bits) | code >> (2 * bits - wide);
}

typedef struct decoded {
    double position[3], scale[3], opacity, dc[3], sh[45];
    uint32_t rotation;
    int axis_bits;
} decoded;

static inline uint32_t little_16(const unsigned char *at)
{
    return at[0] | (uint32_t)at[1] << 8;
}

static inline uint32_t little_32(const unsigned char *at)
{
    return little_16(at) | little_16(at + 2) << 16;
}

enum { FIELDS = 11 };   /* fields of a Gaussian: 3 positions, 3 scales, the rotation word, 3 colours, opacity */

static inline void small_codes(uint32_t codes[FIELDS], const unsigned char *rows, uint32_t at)
{
    const uint32_t a = little_32(rows + 4 * at), b = little_32(rows + 1024 + 4 * at);
    const uint32_t c = little_32(rows + 2048 + 4 * at), d = rows[3072 + at];
    const uint32_t all[FIELDS] = {
        widen(a & 2047, 11, 16), widen(a >> 11 & 2047, 11, 16), widen(b & 2047, 11, 16),
        widen(c & 127, 7, 10), widen(c >> 7 & 127, 7, 10), 2 * widen(c >> 14 & 63, 6, 9),
        (c >> 20) << 20 | d << 12 | (a >> 22 & 3) << 10 | (b >> 31) << 9,
        widen(b >> 11 & 127, 7, 9), widen(b >> 18 & 127, 7, 9), widen(b >> 25 & 63, 6, 9), a >> 24
    };
    memcpy(codes, all, sizeof all);
}

static inline void other_codes(uint32_t codes[FIELDS], const unsigned char *rows, uint32_t at)
{
    uint32_t words[3];
    for (uint32_t i = 0; i < 3; i++) {
        codes[i] = little_16(rows + 512 * i + 2 * at);
        words[i] = little_32(rows + 1536 + 1024 * i + 4 * at);
    }
    for (int i = 0; i < 3; i++) {
        codes[3 + i] = i < 2 ? words[1] >> 10 * i & 1023 : (words[1] >> 20 & 511) * 2;
        codes[7 + i] = (words[2] >> 8 * i & 255) * 2 + (words[1] >> (29 + i) & 1);
    }
    codes[6] = words[0];
    codes[10] = words[2] >> 24;
}

static inline void decode_palette(double sh[45], const fxs_scene *s, const fxs_chunk *chunk,
                                  const unsigned char *record)
{
    const int stages = s->profile == FXS_PROFILE_COMPACT ? 3 : s->sh_degree == 1 ? 4 : 6;
    const int count = FXS_SH_COUNT(s->sh_degree);
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < count; k++) {
            int sum = chunk->sh_mean[16 * c + k], bit = 32 + 3 * (c * count + k);
            for (int stage = 0; stage < stages; stage++)
                sum += (record[stage] < 128 ? 1 : -1) *
                       s->palette[((uint32_t)stage * s->palette_entries + record[stage] % 128) * 48 + 16 * (uint32_t)c +
                                  (uint32_t)k];
            sh[3 * k + c] = ldexp(sum * (double)s->palette_step_q19, -19);
            if (s->profile != FXS_PROFILE_COMPACT)
                continue;
            int code = 0;
            for (int i = 0; i < 3; i++)
                code += (record[(bit + i) / 8] >> (bit + i) % 8 & 1) << i;
            sh[3 * k + c] += (2 * (code < 4 ? code : code - 8) + 1) * ldexp(8 + record[3] % 8, record[3] / 8 - 32);
        }
}

static inline decoded decode(const fxs_scene *s, uint32_t i)
{
    decoded d;
    uint32_t codes[FIELDS], at = i % FXS_CHUNK;
    const fxs_chunk *chunk = chunk_of(s, i);
    const unsigned char *rows = rows_of(s, i);
    memset(&d, 0, sizeof d);
    (s->profile == FXS_PROFILE_SMALL ? small_codes : other_codes)(codes, rows, at);
    for (uint32_t k = 0; k < 3; k++) {
        double scale = codes[3 + k];
        d.position[k] = ldexp((double)chunk->origin_q32[k], -32) + codes[k] * position_step(chunk, k);
        d.scale[k] = log(2) * (ldexp(chunk->scale_q16, -16) - scale * scale * ldexp(chunk->scale_step_q24, -24));
        d.dc[k] = (ldexp(chunk->colour_q16[k], -16) + codes[7 + k] * ldexp(chunk->colour_step_q20[k], -20) - 0.5) /
                  0.28209479177387814;
    }
    d.axis_bits = axis_bits(s->profile == FXS_PROFILE_SMALL, codes + 3, chunk->scale_step_q24);
    d.rotation = codes[6];
    d.opacity = opacity_of(codes[10], chunk->opacity_law);
    if (s->profile != FXS_PROFILE_DEFAULT && s->sh_degree) {
        const int small = s->profile == FXS_PROFILE_SMALL;
        const uint32_t bytes = (const uint32_t[2][4]){{0, 8, 13, 21}, {0, 4, 6, 6}}[small][s->sh_degree];
        decode_palette(d.sh, s, chunk, rows + (small ? 3328 : 4608) + bytes * at);
        return d;
    }
    for (int k = 0; k < 3 * FXS_SH_COUNT(s->sh_degree); k++)
        d.sh[k] = ldexp((int8_t)rows[4608 + 256 * k + (int)at] *
                        (double)chunk->sh_step_q19[k < 9 ? 0 : k < 24 ? 1 : 2], -19);
    return d;
}

#endif
