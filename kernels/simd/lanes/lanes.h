/* The functions of src/include/fixsplat/internal/fixed.h for LANES numbers at a time. Include an instruction set's
 * operations, such as lanes_avx2.h, first. */
#ifndef FXS_LANES_H
#define FXS_LANES_H

/* Counts the lanes in a mask. For 4 lanes a table is used, because not every processor has an instruction to count
   bits. */
static inline uint32_t lanes_of(mask which)
{
    return LANES > 4 ? (uint32_t)__builtin_popcount(bits(which))
                     : (uint32_t)(0x4332322132212110 >> 4 * bits(which)) & 15;
}

static inline vu mulhi(vu a, vu b)
{
    return high_half(mul_wide_u(a, b));
}

static inline vi mul_q15(vi a, vi b)
{
    return round_shift(a * b, 15);
}

static inline vi clamp(vi x, vi low, vi high)
{
    return least(most(x, low), high);
}

static inline vu root(vu x)
{
    vi shift = clz(x) & ~1;
    vu m = shift_left(x, shift);
    return shift_right(mulhi(m, rsqrt(m)), 14 + (shift >> 1));
}

/* Returns a splat's radius sqrt(r2) in sigmas, Q12, rounded up. Only faint splats need the square root. */
static inline vi radius_q12(vi r2_q11)
{
    if (!any(greater(all(FXS_CUT_Q11), r2_q11)))
        return all((int32_t)fxs_sqrt((FXS_CUT_Q11 + 1) << 13) + 1);
    return (vi)root((vu)(r2_q11 + 1) << 13) + 1;
}

static inline vi exp2_q15(vi f_q15)
{
    vi p = round_shift(256 * f_q15, 15);
    p = mul_q15(p - 1820, f_q15);
    p = mul_q15(p + 7904, f_q15);
    p = mul_q15(p - 22724, f_q15);
    return 32768 + p;
}

/* Returns log2(2^whole m), Q16, for a mantissa m in [1, 2). m is stored with its top bit set. */
static inline vi log2_of_top_q16(vi whole, vu m)
{
    vi t_q15 = (vi)(m >> 16) & 32767;
    vi q = mul_q15(all(-2776), t_q15);
    q = mul_q15(q + 6897, t_q15);
    q = mul_q15(q - 9697, t_q15);
    q = mul_q15(q + 14605, 32768 - t_q15);
    return whole * 65536 + 2 * round_shift((32768 + q) * (t_q15 >> 1), 14);
}

static inline vi log2_q16(wide x)
{
    vi n = clz_wide(x);
    return log2_of_top_q16(63 - n, top_half(x, n));
}

static inline vi log2_of_32_q16(vu x)
{
    vi n = clz(x);
    return log2_of_top_q16(31 - n, shift_left(x, n));
}

#endif
