/* Reads and writes the rotation words of LANES Gaussians together. src/core/axes.h is the scalar version. */
#include "lane_codes.h"

typedef struct axes {
    vi axis_q15[3], side_q15[2][3], cos_q15, sin_q15;
} axes;

static inline vi fall_of(vi code, uint32_t scale_step_q24)
{
    return (vi)(((vu)(code * code * (int32_t)scale_step_q24) + 128) >> 8);
}

static inline void falls_of(vi fall_q16[3], vi scale_word, uint32_t scale_step_q24)
{
    for (int i = 0; i < 3; i++)
        fall_q16[i] = fall_of(i < 2 ? scale_word >> 10 * i & 1023 : scale_word >> 19 & 1022, scale_step_q24);
}

static inline vi axis_bits(enum fxs_profile profile, const vi fall_q16[3])
{
    const vi y = fall_q16[1] - fall_q16[0], z = fall_q16[2] - fall_q16[0];
    const vi gap = least(most(y, -y), most(z, -z)) >> 4;
    return least(FXS_AXIS_BITS_LEAST(profile) + (5 * gap >> 16), all(FXS_AXIS_BITS_MOST(profile)));
}

/* Returns the lanes whose (X, Y) is no longer than 1. */
static inline mask in_circle(vi x_q15, vi y_q15)
{
    return greater((1 << 30) - (x_q15 * x_q15 + y_q15 * y_q15), all(-1));
}

static inline void axes_of(axes *out, vi x_q15, vi y_q15)
{
    const vi xx = x_q15 * x_q15, yy = y_q15 * y_q15, xy_q15 = mul_q15(x_q15, y_q15);
    const vu m = 0x80000000u - (vu)(xx + yy);
    const vi s_q15 = (vi)((mulhi(m, rsqrt(m)) + 8192) >> 14);
    out->axis_q15[0] = mul_q15(x_q15, s_q15);
    out->axis_q15[1] = mul_q15(y_q15, s_q15);
    out->axis_q15[2] = (vi)((m + 16384) >> 15) - 32768;
    out->side_q15[0][0] = 32768 - round_shift(xx, 15);
    out->side_q15[0][1] = out->side_q15[1][0] = -xy_q15;
    out->side_q15[0][2] = -out->axis_q15[0];
    out->side_q15[1][1] = 32768 - round_shift(yy, 15);
    out->side_q15[1][2] = -out->axis_q15[1];
}

static inline mask read_axes(axes *out, vi word, vi bits)
{
    const vu y_word = shift_left((vu)word, bits), roll_word = shift_left(y_word, bits);
    const vi x = word >> 16, y = (vi)y_word >> 16, u = (vi)roll_word >> 16, uu_q15 = mul_q15(u, u);
    axes_of(out, x, y);
    out->cos_q15 = 32768 - mul_q15(uu_q15, 40141 - mul_q15(uu_q15, all(7373)));
    out->sin_q15 = mul_q15(u, 51317 - mul_q15(uu_q15, 20619 - mul_q15(uu_q15, all(2066))));
    return in_circle(x, y);
}

static inline vi with_sign_of(vi x, vi other)
{
    return (x ^ other >> 31) - (other >> 31);
}

/* Rounds x, less the fraction that the bits behind it add, to a multiple of `unit`, a power of two from 4 to 256. */
static inline vi axis_code(vi x_q15, vi fraction, vi unit)
{
    return clamp((x_q15 - fraction + (unit >> 1)) & -unit, all(-32768), 32768 - unit);
}

static inline vi axis_towards_0(vi code, vi unit)
{
    return choose(greater(code, all(0)), code - unit, choose(greater(-unit, code), code + unit, code));
}

/* Returns the roll U of the second axes, whose parts along the sides are c and d, in Q15. */
static inline vi roll_of(vi c_q15, vi d_q15)
{
    const vi d = clamp(with_sign_of(d_q15, c_q15), all(-32768), all(32768)), c = most(c_q15, -c_q15);
    const vi inverse_q15 = (vi)(reciprocal((vu)(32768 + least(c, all(32767))) << 16) >> 16);
    const vi t = clamp(mul_q15(d, inverse_q15), all(-32767), all(32767)), w = mul_q15(t, t);
    return clamp(mul_q15(t, 41689 - mul_q15(w, 13400 - mul_q15(w, 6102 - mul_q15(w, all(1627))))), all(-32768),
                 all(32767));
}

/* Joins X, Y and U to words of `width` bits. A number's code is kept where it reads as 16 bits: with zeros below it. */
static inline vi axes_word(vi x_q15, vi y_q15, vi u_q15, vi bits, int width)
{
    const vi unit = (vi)shift_left((vu)all(1), 16 - bits);
    const vi roll_unit = (vi)shift_left((vu)all(1), 2 * bits + (16 - width));
    const vi roll = (u_q15 + (roll_unit >> 1)) & -roll_unit;
    const vu behind_y = shift_right((vu)roll << 16, bits);
    vi y = axis_code(y_q15, (vi)(behind_y >> 16), unit);
    vu behind_x = shift_right((vu)y << 16 | behind_y, bits);
    vi x = axis_code(x_q15, (vi)(behind_x >> 16), unit);
    const mask within = in_circle(x + (vi)(behind_x >> 16), y + (vi)(behind_y >> 16));
    if (any(~within)) {
        x = choose(within, x, axis_towards_0(x, unit));
        y = choose(within, y, axis_towards_0(y, unit));
        behind_x = shift_right((vu)y << 16 | behind_y, bits);
    }
    return x << 16 | (vi)behind_x;
}

static inline vi write_axes(const vi first_q15[3], const vi second_q15[3], vi bits, int width)
{
    const vi z = most(first_q15[2], -first_q15[2]);
    const vi inverse_q14 = (vi)(rsqrt((vu)(32768 + least(z, all(32767))) << 15) >> 16);
    vi x = mul_q15(with_sign_of(first_q15[0], first_q15[2]), inverse_q14);
    vi y = mul_q15(with_sign_of(first_q15[1], first_q15[2]), inverse_q14), part_q15[2];
    const mask short_enough = in_circle(x, y);
    axes a;
    x = choose(short_enough, x, x - (x >> 10));
    y = choose(short_enough, y, y - (y >> 10));
    axes_of(&a, x, y);
    for (int i = 0; i < 2; i++)
        part_q15[i] = mul_q15(second_q15[0], a.side_q15[i][0]) + mul_q15(second_q15[1], a.side_q15[i][1]) +
                      mul_q15(second_q15[2], a.side_q15[i][2]);
    const vi word = axes_word(x, y, roll_of(part_q15[0], part_q15[1]), bits, width);
    return choose(in_circle(x, y), word, all(0));
}
