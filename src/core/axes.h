/* Reads and writes the rotation word of a Gaussian. The word has the numbers X and Y, `bits` bits each, then the roll
 * U. (X, Y) is the first axis in Lambert's equal-area projection of the hemisphere around +z. With s = sqrt(2 - X^2 -
 * Y^2), this axis is (X s, Y s, 1 - X^2 - Y^2). Two vectors perpendicular to it, the sides, are (1 - X^2, -X Y, -X s)
 * and (-X Y, 1 - Y^2, -Y s). The roll turns the sides by an angle of about pi/2 U, with cos = 1 - U^2 (1.225 - 0.225
 * U^2) and sin = U (1.56607 - U^2 (0.62924 - 0.06305 U^2)). */
#ifndef FXS_AXES_H
#define FXS_AXES_H

#include <fixsplat/internal/fixed.h>
#include <fixsplat/internal/pixel.h>

typedef struct fxs_gaussian_axes {
    int32_t axis_q15[3], side_q15[2][3];
    int32_t cos_q15, sin_q15;      /* roll about the first axis: second axis = cos side[0] + sin side[1] */
} fxs_gaussian_axes;

/* Computes the first axis and its sides from (X, Y). Returns 0 if (X, Y) is longer than 1. */
static inline int fxs_axes_of(fxs_gaussian_axes *out, int32_t x_q15, int32_t y_q15)
{
    const int32_t xx_q15 = (x_q15 * x_q15 + 16384) >> 15, yy_q15 = (y_q15 * y_q15 + 16384) >> 15;
    const int32_t xy_q15 = (x_q15 * y_q15 + 16384) >> 15;
    const uint32_t square_q30 = (uint32_t)(x_q15 * x_q15) + (uint32_t)(y_q15 * y_q15);
    if (square_q30 > 1u << 30)
        return 0;
    /* m is (2 - X^2 - Y^2) / 4 in Q32, from 1/4 to 1/2 */
    const uint32_t m = (1u << 31) - square_q30;
    const int32_t s_q15 = (int32_t)((fxs_mulhi(m, fxs_rsqrt(m)) + 8192) >> 14);
    const int32_t xs_q15 = (x_q15 * s_q15 + 16384) >> 15, ys_q15 = (y_q15 * s_q15 + 16384) >> 15;
    const fxs_gaussian_axes axes = {{xs_q15, ys_q15, (int32_t)((m + 16384) >> 15) - 32768},
                           {{32768 - xx_q15, -xy_q15, -xs_q15}, {-xy_q15, 32768 - yy_q15, -ys_q15}}, 0, 0};
    *out = axes;
    return 1;
}

/* Decodes the rotation of a Gaussian. Each number is read as 16 bits in two's complement, Q15; the next number's bits
   act as a fraction. Returns 0 if (X, Y) is longer than 1. */
static inline int fxs_read_axes(fxs_gaussian_axes *out, uint32_t word, int32_t bits)
{
    const int32_t u_q15 = (int32_t)(word << 2 * bits) >> 16;
    if (!fxs_axes_of(out, (int32_t)word >> 16, (int32_t)(word << bits) >> 16))
        return 0;
    const int32_t uu_q15 = (u_q15 * u_q15 + 16384) >> 15;
    out->cos_q15 = 32768 - fxs_mul_q15(uu_q15, 40141 - fxs_mul_q15(uu_q15, 7373));
    out->sin_q15 = fxs_mul_q15(u_q15, 51317 - fxs_mul_q15(uu_q15, 20619 - fxs_mul_q15(uu_q15, 2066)));
    return 1;
}

/* Returns the code of a number of `bits` bits, 4 to 14, that reads as x if `rest`, the word's bits behind it, follow.
 */
static inline int32_t fxs_axis_code(int32_t x_q15, uint32_t rest, int32_t bits)
{
    const int32_t most = (1 << (bits - 1)) - 1, fraction = (int32_t)(rest >> (16 + bits));
    return fxs_clamp((x_q15 - fraction + (1 << (15 - bits))) >> (16 - bits), -most - 1, most);
}

static inline int32_t fxs_axis_towards_0(int32_t code)
{
    return code > 0 ? code - 1 : code < -1 ? code + 1 : code;
}

/* Encodes the rotation with the given first axis and second axis, of length 1, Q15. `width` is the length of the word,
   32 or 23 bits. The sign of an axis is free, so both are turned to the half that the word can hold. With h = sqrt(1 +
   z) of the first axis (x, y, z), (X, Y) = (x, y) / h. With c and d the parts of the second axis along the sides, the
   roll is U = 4 / pi atan(d / (1 + c)), for c >= 0. atan is a polynomial with an error below 0.0001. */
static inline uint32_t fxs_write_axes(const int32_t first_q15[3], const int32_t second_q15[3], int32_t bits, int width)
{
    const int32_t sign = first_q15[2] < 0 ? -1 : 1, z_q15 = first_q15[2] * sign;
    const int32_t inverse_q14 = (int32_t)(fxs_rsqrt((uint32_t)(32768 + (z_q15 < 32767 ? z_q15 : 32767)) << 15) >> 16);
    int32_t x_q15 = (sign * first_q15[0] * inverse_q14 + 16384) >> 15;
    int32_t y_q15 = (sign * first_q15[1] * inverse_q14 + 16384) >> 15;
    fxs_gaussian_axes axes;
    if (!fxs_axes_of(&axes, x_q15, y_q15)) {     /* longer than 1 by rounding: z is 0 */
        x_q15 -= x_q15 >> 10;
        y_q15 -= y_q15 >> 10;
        if (!fxs_axes_of(&axes, x_q15, y_q15))
            return 0;
    }
    int32_t c_q15 = fxs_mul_q15(second_q15[0], axes.side_q15[0][0]) + fxs_mul_q15(second_q15[1], axes.side_q15[0][1]) +
                    fxs_mul_q15(second_q15[2], axes.side_q15[0][2]);
    int32_t d_q15 = fxs_mul_q15(second_q15[0], axes.side_q15[1][0]) + fxs_mul_q15(second_q15[1], axes.side_q15[1][1]) +
                    fxs_mul_q15(second_q15[2], axes.side_q15[1][2]);
    if (c_q15 < 0) {
        c_q15 = -c_q15;
        d_q15 = -d_q15;
    }
    /* 1 + c is 1 to 2 in Q30, saturated below 2 */
    const uint32_t sum_q30 = (uint32_t)(32768 + (c_q15 < 32767 ? c_q15 : 32767)) << 15;
    const int32_t inverse_q15 = (int32_t)(fxs_reciprocal(sum_q30 << 1) >> 16);      /* 1 / (1 + c) in Q15: 1/2 to 1 */
    const int32_t t_q15 = fxs_clamp(fxs_mul_q15(fxs_clamp(d_q15, -32768, 32768), inverse_q15), -32767, 32767);
    const int32_t w_q15 = fxs_mul_q15(t_q15, t_q15);
    const int32_t u_q15 = fxs_clamp(fxs_mul_q15(t_q15, 41689 - fxs_mul_q15(w_q15, 13400 - fxs_mul_q15(w_q15, 6102 -
                                                       fxs_mul_q15(w_q15, 1627)))), -32768, 32767);
    /* U, then Y, then X, since each reads the bits behind it. A roll of +1 is one of -1. */
    const int32_t roll = width - 2 * bits < 16 ? width - 2 * bits : 16;
    const uint32_t u_code = (uint32_t)((u_q15 + (1 << (15 - roll))) >> (16 - roll));
    const uint32_t behind_y = u_code << (32 - roll);
    int32_t y_code = fxs_axis_code(y_q15, behind_y, bits);
    uint32_t behind_x = (uint32_t)y_code << (32 - bits) | behind_y >> bits;
    int32_t x_code = fxs_axis_code(x_q15, behind_x, bits);
    const int32_t x_read = (int32_t)((uint32_t)x_code << (32 - bits) | behind_x >> bits) >> 16;
    const int32_t y_read = (int32_t)behind_x >> 16;
    if ((uint32_t)(x_read * x_read) + (uint32_t)(y_read * y_read) > 1u << 30) {
        y_code = fxs_axis_towards_0(y_code);
        x_code = fxs_axis_towards_0(x_code);
        behind_x = (uint32_t)y_code << (32 - bits) | behind_y >> bits;
    }
    return (uint32_t)x_code << (32 - bits) | behind_x >> bits;
}

#endif
