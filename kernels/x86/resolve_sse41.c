/* resolve, SSE4.1, 8 pixels at a time: (255 c + 2^12) >> 13 is the rounding product with 4 * 255. */
#include <smmintrin.h>

#include "../../src/memory.h"
#include "x86.h"

static inline __m128i load(const int16_t *from)
{
    return _mm_loadu_si128((const __m128i *)(const void *)from);
}

/* 8 pixels of RGBA8. background: null with coverage. */
static inline void eight(unsigned char *to, const fxs_tile *tile, int i, const int16_t background_q13[3], int coverage)
{
    const __m128i white = _mm_set1_epi16(255);
    __m128i t = load(tile->transmittance_q15 + i), c[4];
    for (int k = 0; k < 3; k++) {
        __m128i over = _mm_mulhrs_epi16(t, _mm_set1_epi16(background_q13[k]));
        c[k] = _mm_adds_epi16(load(tile->sum_q13[k] + i), over);
        c[k] = _mm_min_epi16(_mm_mulhrs_epi16(c[k], _mm_set1_epi16(4 * 255)), white);
    }
    c[3] = coverage ? _mm_mulhrs_epi16(_mm_sub_epi16(_mm_set1_epi16(FXS_CLEAR_Q15), t), white) : white;
    __m128i rg = _mm_or_si128(c[0], _mm_slli_epi16(c[1], 8)), ba = _mm_or_si128(c[2], _mm_slli_epi16(c[3], 8));
    _mm_storeu_si128((__m128i *)(void *)to, _mm_unpacklo_epi16(rg, ba));
    _mm_storeu_si128((__m128i *)(void *)(to + 16), _mm_unpackhi_epi16(rg, ba));
}

void fxs_resolve_sse41(const fxs_options *options, enum fxs_format format, const fxs_tile *tile, int32_t columns,
                       int32_t rows, unsigned char *pixels, ptrdiff_t stride)
{
    const int coverage = format == FXS_FORMAT_RGBA8_COVERAGE;
    int16_t background_q13[3];
    if (format != FXS_FORMAT_RGBA8 && !coverage) {
        fxs_resolve_c(options, format, tile, columns, rows, pixels, stride);
        return;
    }
    for (int c = 0; c < 3; c++)
        background_q13[c] = (int16_t)(coverage ? 0 : fxs_background_q13(options->background[c]));
    for (int32_t y = 0; y < rows; y++) {
        unsigned char row[4 * FXS_TILE], *to = columns == FXS_TILE ? pixels + y * stride : row;
        eight(to, tile, y * FXS_TILE, background_q13, coverage);
        eight(to + 32, tile, y * FXS_TILE + 8, background_q13, coverage);
        if (to == row)
            memcpy(pixels + y * stride, row, (size_t)columns * 4);
    }
}
