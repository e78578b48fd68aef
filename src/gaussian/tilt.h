/* Computes the axes of a Gaussian from its packed rotation, a word of 32 bits. Formulas: docs/format.md. */
#ifndef FXS_TILT_H
#define FXS_TILT_H

#include <math.h>
#include <stdint.h>

/* A packed rotation: x and y give the direction of the first axis, roll the turn about that axis. All are from -1 to
   1. */
typedef struct fxs_tilt {
    double x, y, roll;
} fxs_tilt;

/* Computes the cosine and sine of a rotation's roll * pi/2, by the same polynomials as the renderer. */
static inline void fxs_tilt_roll(double roll, double *cosine, double *sine)
{
    const double square = roll * roll;
    *cosine = 1 - square * (1.225 - 0.225 * square);
    *sine = roll * (1.56607 - square * (0.62924 - 0.06305 * square));
}

/* Computes the first axis of a Gaussian, and two directions perpendicular to that axis. */
static inline void fxs_tilt_sides(const fxs_tilt *a, double axis[3], double side[2][3])
{
    const double x = a->x, y = a->y, s = sqrt(2 - x * x - y * y);
    axis[0] = x * s, axis[1] = y * s, axis[2] = 1 - x * x - y * y;
    side[0][0] = 1 - x * x, side[0][1] = -x * y, side[0][2] = -x * s;
    side[1][0] = -x * y, side[1][1] = 1 - y * y, side[1][2] = -y * s;
}

static inline void fxs_tilt_directions(const fxs_tilt *a, double axis[3][3])
{
    double side[2][3], cosine, sine;
    fxs_tilt_sides(a, axis[0], side);
    fxs_tilt_roll(a->roll, &cosine, &sine);
    for (int i = 0; i < 3; i++) {
        axis[1][i] = cosine * side[0][i] + sine * side[1][i];
        axis[2][i] = cosine * side[1][i] - sine * side[0][i];
    }
}

/* Packs the codes of a rotation into a word. x and y have `bits` bits each. roll has the rest of the `all` upper bits
   of the word. */
static inline uint32_t fxs_tilt_word(uint32_t x, uint32_t y, uint32_t roll, int32_t bits, int32_t all)
{
    const int32_t roll_bits = all - 2 * bits;
    return x << (32 - bits) | (y & ((1u << bits) - 1)) << (32 - 2 * bits) |
           (roll & ((1u << roll_bits) - 1)) << (32 - all);
}

/* Rotation word that replaces 0, because a Gaussian of all zeros counts as empty. */
#define FXS_NOT_EMPTY (1u << 9)

/* Unpacks a rotation word. bits: number of bits of x and of y. */
static inline fxs_tilt fxs_tilt_of_word(uint32_t word, int32_t bits)
{
    return (fxs_tilt){((int32_t)word >> 16) * 0x1p-15, ((int32_t)(word << bits) >> 16) * 0x1p-15,
                      ((int32_t)(word << 2 * bits) >> 16) * 0x1p-15};
}

#endif
