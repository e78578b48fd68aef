/* Decodes the 32-bit rotation word of a packed Gaussian by docs/format.md. The word stores the axes of the Gaussian
   by two numbers X and Y. */
#ifndef ROTATION_WORD_H
#define ROTATION_WORD_H

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

/* Returns the number of bits of each of the numbers X and Y of a rotation word. The three 10-bit scale codes of the
   Gaussian decide the number. */
static inline int axis_bits(int is_small, const uint32_t scale[3], uint32_t scale_step_q24)
{
    int32_t fall[3];
    for (int i = 0; i < 3; i++)
        fall[i] = (int32_t)((scale[i] * scale[i] * scale_step_q24 + 128) / 256);
    const int32_t y = abs(fall[1] - fall[0]), z = abs(fall[2] - fall[0]), gap = (y < z ? y : z) / 16;
    const int bits = (is_small ? 8 : 11) + 5 * gap / 65536, most = is_small ? 10 : 14;
    return bits < most ? bits : most;
}

static inline int axis_bits_of_word(int is_small, uint32_t scale_word, uint32_t scale_step_q24)
{
    const uint32_t scale[3] = {scale_word & 1023, scale_word >> 10 & 1023, (scale_word >> 20 & 511) * 2};
    return axis_bits(is_small, scale, scale_step_q24);
}

/* Returns the upper 16 bits of a word as a signed number divided by 2^15. */
static inline double in_units(uint32_t word)
{
    return (word >> 16) / 32768.0 - (word >> 31 ? 2 : 0);
}

/* Decodes a rotation word. Sets axis[i] to the direction of the Gaussian's axis i. Returns X^2 + Y^2. */
static inline double word_axes(double axis[3][3], uint32_t word, int bits)
{
    const double x = in_units(word), y = in_units(word << bits), u = in_units(word << 2 * bits), square = x * x + y * y;
    const double cosine = 1 - u * u * (1.225 - 0.225 * u * u);
    const double sine = u * (1.56607 - u * u * (0.62924 - 0.06305 * u * u)), roll = atan2(sine, cosine);
    const double s = sqrt(2 - square), side[2][3] = {{1 - x * x, -x * y, -x * s}, {-x * y, 1 - y * y, -y * s}};
    const double first[3] = {x * s, y * s, 1 - square};
    for (int i = 0; i < 3; i++) {
        axis[0][i] = first[i];
        axis[1][i] = cos(roll) * side[0][i] + sin(roll) * side[1][i];
        axis[2][i] = cos(roll) * side[1][i] - sin(roll) * side[0][i];
    }
    return square;
}

/* Computes the quaternion w, x, y, z of the matrix with the axes as columns. */
static inline void word_quaternion(double q[4], uint32_t word, int bits)
{
    double a[3][3];
    word_axes(a, word, bits);
    const double squares[4] = {1 + a[0][0] + a[1][1] + a[2][2], 1 + a[0][0] - a[1][1] - a[2][2],
                               1 - a[0][0] + a[1][1] - a[2][2], 1 - a[0][0] - a[1][1] + a[2][2]};
    const double of[4][4] = {{squares[0], a[1][2] - a[2][1], a[2][0] - a[0][2], a[0][1] - a[1][0]},
                             {a[1][2] - a[2][1], squares[1], a[0][1] + a[1][0], a[2][0] + a[0][2]},
                             {a[2][0] - a[0][2], a[0][1] + a[1][0], squares[2], a[1][2] + a[2][1]},
                             {a[0][1] - a[1][0], a[2][0] + a[0][2], a[1][2] + a[2][1], squares[3]}};
    int most = 0;
    for (int i = 1; i < 4; i++)
        most = squares[i] > squares[most] ? i : most;
    for (int i = 0; i < 4; i++)
        q[i] = of[most][i] / (2 * sqrt(squares[most]));
}

/* Returns the angle in degrees between the rotations of a rotation word and of a quaternion. order[i]: the
   quaternion's axis that corresponds to axis i of the word. */
static inline double angle_of_word(uint32_t word, int bits, const float rotation[4], const int order[3])
{
    const double w = (double)rotation[0], x = (double)rotation[1], y = (double)rotation[2], z = (double)rotation[3];
    const double s = 2 / (w * w + x * x + y * y + z * z);
    const double columns[3][3] = {{1 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)},
                                  {s * (x * y - w * z), 1 - s * (x * x + z * z), s * (y * z + w * x)},
                                  {s * (x * z + w * y), s * (y * z - w * x), 1 - s * (x * x + y * y)}};
    double axis[3][3], trace = 0;
    word_axes(axis, word, bits);
    for (int i = 0; i < 3; i++) {
        const double *c = columns[order[i]];
        trace += fabs(axis[i][0] * c[0] + axis[i][1] * c[1] + axis[i][2] * c[2]);
    }
    return acos(fmin(1, (trace - 1) / 2)) * 57.29577951308232;
}

#endif
