/* Operations on 64-bit numbers, and other operations of all x86 vectors. Include the header of an instruction set
 * first. */
#ifndef FXS_X86_WIDE_H
#define FXS_X86_WIDE_H

/* Vectors of 64-bit numbers, one per 32-bit lane: the numbers of the even lanes and of the odd lanes. */
typedef struct wide {
    vw even, odd;
} wide;

static inline wide mul_wide(vi a, vi b)
{
    return (wide){(vw)MM(mul_epi32)((V)a, (V)b), (vw)MM(mul_epi32)((V)((vw)a >> 32), (V)((vw)b >> 32))};
}

static inline vw mul_low(vw a, vw b)
{
    return (vw)MM(mul_epu32)((V)a, (V)b);
}

static inline wide mul_wide_u(vu a, vu b)
{
    return (wide){mul_low((vw)a, (vw)b), mul_low((vw)a >> 32, (vw)b >> 32)};
}

static inline wide add_wide(wide a, wide b)
{
    return (wide){a.even + b.even, a.odd + b.odd};
}

static inline wide offset_wide(wide a, int64_t b)
{
    return (wide){a.even + (uint64_t)b, a.odd + (uint64_t)b};
}

static inline wide shift_left_wide(wide x, int shift)
{
    return (wide){x.even << shift, x.odd << shift};
}

static inline wide or_magnitude(wide a, wide b)
{
    return (wide){a.even | magnitude_64(b.even), a.odd | magnitude_64(b.odd)};
}

static inline vu narrow(wide x, const int shift)
{
    return interleave(x.even >> shift, x.odd << (32 - shift));
}

static inline vu low_half(wide x)
{
    return interleave(x.even, x.odd << 32);
}

static inline vu high_half(wide x)
{
    return interleave(x.even >> 32, x.odd);
}

static inline vu scale_down(vu x, vi shift)
{
    return (shift_right(x, shift - 1) + 1) >> 1;
}

static inline vi narrow_by(wide x, vi shift)
{
    vw odd = (vw)shift >> 32, even = ((vw)shift << 32) >> 32;
    return (vi)low_half((wide){shift_right_64(x.even, even), shift_right_64(x.odd, odd)});
}

static inline vi scale_down_wide(wide x, vi shift)
{
    return (narrow_by(x, shift - 1) + 1) >> 1;
}

static inline vi clz_wide(wide x)
{
    const vu high = high_half(x);
    const mask empty = equal((vi)high, all(0));
    return clz((vu)choose(empty, (vi)low_half(x), (vi)high)) + choose(empty, all(32), all(0));
}

static inline vu top_half(wide x, vi shift)
{
    const vu high = high_half(x), low = low_half(x);
    return shift_left(high, shift) | shift_right(low, 32 - shift) | shift_left(low, shift - 32);
}

static inline vi round_shift(vi x, const int shift)
{
    const int32_t half = 1 << (shift - 1);
    return (x + half) >> shift;
}

/* Newton's steps for reciprocals and roots, as in src/include/fixsplat/internal/fixed.h. The steps work on the low
   halves of 64-bit numbers, so that no step has to narrow. */
static inline vw reciprocal_step(vw m, vw y_q30)
{
    return mul_low(y_q30, 0x80000000u - (mul_low(m, y_q30) >> 32)) >> 30;
}

static inline vw rsqrt_step(vw m, vw y_q30)
{
    return mul_low(y_q30, 0x60000000u - (mul_low(m, mul_low(y_q30, y_q30) >> 31) >> 32)) >> 30;
}

static inline vw reciprocal_low(vw m)
{
    vw y_q30 = 3031741620u - (mul_low(m, (vw)all(2021161081)) >> 32);
    return reciprocal_step(m, reciprocal_step(m, reciprocal_step(m, y_q30)));
}

static inline vw rsqrt_low(vw m)
{
    vw y_q30 = 2369829601u - (mul_low(m, (vw)all(1431655765)) >> 32);
    return rsqrt_step(m, rsqrt_step(m, rsqrt_step(m, y_q30)));
}

static inline vu reciprocal(vu m)
{
    return interleave(reciprocal_low((vw)m), reciprocal_low((vw)m >> 32) << 32);
}

static inline vu rsqrt(vu m)
{
    return interleave(rsqrt_low((vw)m), rsqrt_low((vw)m >> 32) << 32);
}

/* Loads four words per lane and transposes them to four vectors, which is faster than gather instructions. */
static inline __attribute__((always_inline)) void load_fours(vi words[4], const int32_t *from, int stride,
                                                             const int32_t at[LANES])
{
    V x = every_fourth(from, stride, at), y = every_fourth(from, stride, at + 1);
    V z = every_fourth(from, stride, at + 2), w = every_fourth(from, stride, at + 3);
    V xy = MM(unpacklo_epi32)(x, y), zw = MM(unpacklo_epi32)(z, w);
    words[0] = (vi)MM(unpacklo_epi64)(xy, zw);
    words[1] = (vi)MM(unpackhi_epi64)(xy, zw);
    xy = MM(unpackhi_epi32)(x, y), zw = MM(unpackhi_epi32)(z, w);
    words[2] = (vi)MM(unpacklo_epi64)(xy, zw);
    words[3] = (vi)MM(unpackhi_epi64)(xy, zw);
}

#define PARTS 1
typedef vi factor;                 /* 16-bit numbers in 32-bit words, with an upper half of 0 */

static inline factor factor_of(vi first, vi last)
{
    (void)last;
    return first & 65535;
}

static inline void add_products(vi sum[PARTS], const int8_t *codes, factor x)
{
    sum[0] += (vi)MM(madd_epi16)((V)load_i8(codes), (V)x);
}

#endif
