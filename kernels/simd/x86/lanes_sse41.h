/* Vector operations of 4 lanes with SSE4.1. vectors.h describes the operations. */
#ifndef FXS_LANES_SSE41_H
#define FXS_LANES_SSE41_H

#define ISA sse41
#define LANES 4
#define V __m128i
#define MM(name) _mm_##name
#include "src/core/memory.h"
#include <fixsplat/internal/stage.h>
#include "common.h"

typedef vi mask;

static inline vi load_u16(const uint16_t *from)
{
    return (vi)_mm_cvtepu16_epi32(_mm_loadl_epi64((const __m128i *)(const void *)from));
}

static inline vi load_i16(const int16_t *from)
{
    return (vi)_mm_cvtepi16_epi32(_mm_loadl_epi64((const __m128i *)(const void *)from));
}

static inline void store_u16(uint16_t *to, vi x)
{
    _mm_storel_epi64((__m128i *)(void *)to, _mm_packus_epi32((__m128i)x, (__m128i)x));
}

static inline vi load_i8(const int8_t *from)
{
    int32_t four;
    memcpy(&four, from, sizeof four);
    return (vi)_mm_cvtepi8_epi32(_mm_cvtsi32_si128(four));
}

static inline __m128i every_fourth(const int32_t *from, int stride, const int32_t *at)
{
    return (__m128i)load(from + stride * at[0]);
}

static inline void store_pairs(void *to, vi a, vi b)
{
    store(to, (vi)_mm_unpacklo_epi32((__m128i)a, (__m128i)b));
    store((int32_t *)to + 4, (vi)_mm_unpackhi_epi32((__m128i)a, (__m128i)b));
}

static inline void load_pairs(const void *from, vi *a, vi *b)
{
    const __m128 low = (__m128)load(from), high = (__m128)load((const int32_t *)from + 4);
    *a = (vi)_mm_shuffle_ps(low, high, 0x88);
    *b = (vi)_mm_shuffle_ps(low, high, 0xdd);
}

static inline int any(mask which)
{
    return !_mm_testz_si128((__m128i)which, (__m128i)which);
}

static inline unsigned bits(mask which)
{
    return (unsigned)_mm_movemask_ps((__m128)which);
}

static inline void store_compressed(void *to, vi x, mask which)
{
    const __m128i order = _mm_load_si128((const __m128i *)(const void *)compress_order[bits(which)]);
    store(to, (vi)_mm_shuffle_epi8((__m128i)x, order));
}

static inline mask equal(vi a, vi b)
{
    return (mask)_mm_cmpeq_epi32((__m128i)a, (__m128i)b);
}

static inline mask greater(vi a, vi b)
{
    return (mask)_mm_cmpgt_epi32((__m128i)a, (__m128i)b);
}

static inline vi choose(mask which, vi a, vi b)
{
    return (vi)_mm_blendv_epi8((__m128i)b, (__m128i)a, (__m128i)which);
}

static inline vu interleave(vw a, vw b)
{
    return (vu)_mm_blend_epi16((__m128i)a, (__m128i)b, 0xcc);
}

static inline vw sign_64(vw x)
{
    return (vw)_mm_shuffle_epi32(_mm_srai_epi32((__m128i)x, 31), 0xf5);
}

static inline vw shift_right_64(vw x, vw shift)
{
    const vw sign = sign_64(x);
    const __m128i y = (__m128i)(x ^ sign);
    const __m128i high = _mm_srl_epi64(y, _mm_unpackhi_epi64((__m128i)shift, (__m128i)shift));
    return (vw)_mm_blend_epi16(_mm_srl_epi64(y, (__m128i)shift), high, 0xf0) ^ sign;
}

static inline vw magnitude_64(vw x)
{
    const vw sign = sign_64(x);
    return (x ^ sign) - sign;
}

/* Shifts each lane left by multiplying with 2^shift, built in the exponent of a float. The conversion of 2^31
   overflows, but returns 2^31. */
static inline vu shift_left(vu x, vi shift)
{
    const __m128i power = _mm_cvttps_epi32(_mm_castsi128_ps((__m128i)((shift << 23) + (127 << 23))));
    const mask in_range = (mask)_mm_cmpeq_epi32(_mm_min_epu32((__m128i)shift, _mm_set1_epi32(31)), (__m128i)shift);
    return (vu)_mm_mullo_epi32((__m128i)x, _mm_and_si128(power, (__m128i)in_range));
}

static inline vu shift_right(vu x, vi shift)
{
    const __m128i zero = _mm_setzero_si128(), low = _mm_unpacklo_epi32((__m128i)shift, zero);
    const __m128i high = _mm_unpackhi_epi32((__m128i)shift, zero);
    const __m128i a = _mm_srl_epi32((__m128i)x, low), b = _mm_srl_epi32((__m128i)x, _mm_unpackhi_epi64(low, low));
    const __m128i c = _mm_srl_epi32((__m128i)x, high), d = _mm_srl_epi32((__m128i)x, _mm_unpackhi_epi64(high, high));
    return (vu)_mm_blend_epi16(_mm_blend_epi16(a, b, 0x0c), _mm_blend_epi16(c, d, 0xc0), 0xf0);
}

#include "wide.h"

typedef struct octet {
    __m128i low, high;
} octet;

static inline void store_8(void *to, octet x)
{
    _mm_storeu_si128(to, x.low);
    _mm_storeu_si128((__m128i *)to + 1, x.high);
}

static inline void store_6(void *to, octet x)
{
    _mm_storeu_si128(to, x.low);
    _mm_storel_epi64((__m128i *)to + 1, x.high);
}

static inline void transpose_4(__m128i out[4], const vi rows[4])
{
    const __m128i a = _mm_unpacklo_epi32((__m128i)rows[0], (__m128i)rows[1]);
    const __m128i b = _mm_unpacklo_epi32((__m128i)rows[2], (__m128i)rows[3]);
    const __m128i c = _mm_unpackhi_epi32((__m128i)rows[0], (__m128i)rows[1]);
    const __m128i d = _mm_unpackhi_epi32((__m128i)rows[2], (__m128i)rows[3]);
    out[0] = _mm_unpacklo_epi64(a, b);
    out[1] = _mm_unpackhi_epi64(a, b);
    out[2] = _mm_unpacklo_epi64(c, d);
    out[3] = _mm_unpackhi_epi64(c, d);
}

static inline void transpose(octet out[4], const vi rows[8], int first)
{
    __m128i low[4], high[4];
    (void)first;
    transpose_4(low, rows);
    transpose_4(high, rows + 4);
    for (int i = 0; i < 4; i++)
        out[i] = (octet){low[i], high[i]};
}

static inline octet load_16(const int8_t *from)
{
    const __m128i x = (__m128i)load(from);
    return (octet){_mm_cvtepi8_epi16(x), _mm_cvtepi8_epi16(_mm_srli_si128(x, 8))};
}

static inline octet add_16(octet x, const int8_t *from, int negative)
{
    const __m128i sign = _mm_set1_epi16(negative ? -1 : 1);
    const octet entry = load_16(from);
    return (octet){_mm_add_epi16(x.low, _mm_sign_epi16(entry.low, sign)),
                   _mm_add_epi16(x.high, _mm_sign_epi16(entry.high, sign))};
}

static inline __m128i products(octet x, octet y)
{
    return _mm_add_epi32(_mm_madd_epi16(x.low, y.low), _mm_madd_epi16(x.high, y.high));
}

static inline void dot_16(int32_t sum[3], const octet x[3], octet y)
{
    int32_t sums[4];
    const __m128i third = products(x[2], y), pairs = _mm_hadd_epi32(products(x[0], y), products(x[1], y));
    store(sums, (vi)_mm_hadd_epi32(pairs, _mm_hadd_epi32(third, third)));
    for (int i = 0; i < 3; i++)
        sum[i] = sums[i];
}

static inline octet odd_numbers(uint64_t codes)
{
#define WINDOW(k) (char)(3 * (k) / 8), (char)(3 * (k) / 8 + 1)
#define UP(k) (short)(1 << (13 - 3 * (k) % 8))
    const __m128i word = _mm_set1_epi64x((int64_t)codes), one = _mm_set1_epi16(1);
    const __m128i low = _mm_setr_epi8(WINDOW(0), WINDOW(1), WINDOW(2), WINDOW(3), WINDOW(4), WINDOW(5), WINDOW(6),
                                      WINDOW(7));
    const __m128i high = _mm_setr_epi8(WINDOW(8), WINDOW(9), WINDOW(10), WINDOW(11), WINDOW(12), WINDOW(13),
                                       WINDOW(14), -1, -1);
    const __m128i low_up = _mm_setr_epi16(UP(0), UP(1), UP(2), UP(3), UP(4), UP(5), UP(6), UP(7));
    const __m128i high_up = _mm_setr_epi16(UP(8), UP(9), UP(10), UP(11), UP(12), UP(13), UP(14), 0);
#undef WINDOW
#undef UP
    const __m128i a = _mm_srai_epi16(_mm_mullo_epi16(_mm_shuffle_epi8(word, low), low_up), 13);
    const __m128i b = _mm_srai_epi16(_mm_mullo_epi16(_mm_shuffle_epi8(word, high), high_up), 13);
    return (octet){_mm_or_si128(_mm_add_epi16(a, a), one), _mm_or_si128(_mm_add_epi16(b, b), one)};
}

typedef vh mask_h;

static inline mask_h open_of(vh transmittance_q15)
{
    return (mask_h)_mm_cmpgt_epi16((__m128i)transmittance_q15, _mm_set1_epi16(FXS_CLOSED_Q15 - 1));
}

static inline mask_h within(vh level, vh limit)
{
    return (mask_h)_mm_cmpeq_epi16(_mm_min_epu16((__m128i)level, (__m128i)limit), (__m128i)level);
}

static inline vh where(mask_h which, vh x)
{
    return which & x;
}

static inline mask_h greater_h(vh a, vh b)
{
    return (mask_h)_mm_cmpgt_epi16((__m128i)a, (__m128i)b);
}

static inline vh choose_h(mask_h which, vh a, vh b)
{
    return (vh)_mm_blendv_epi8((__m128i)b, (__m128i)a, (__m128i)which);
}

static inline int any_h(mask_h which)
{
    return !_mm_testz_si128((__m128i)which, (__m128i)which);
}

static inline uint32_t bits_h(mask_h which)
{
    return (uint32_t)_mm_movemask_epi8(_mm_packs_epi16((__m128i)which, _mm_setzero_si128()));
}

static inline void store_pixels(unsigned char *to, vh r, vh g, vh b, vh a)
{
    __m128i fours[2];
    mix_bytes(fours, r, g, b, a);
    memcpy(to, fours, sizeof fours);
}

static inline void store_wide_pixels(unsigned char *to, vh r, vh g, vh b, vh a)
{
    __m128i twos[4];
    mix_words(twos, r, g, b, a);
    memcpy(to, twos, sizeof twos);
}

#endif
