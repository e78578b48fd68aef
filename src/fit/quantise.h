/* Quantises the parameters of LANES Gaussians as packed scenes do: computes the codes and the values of these codes
 * (docs/format.md). */
#ifndef FXS_FIT_QUANTISE_H
#define FXS_FIT_QUANTISE_H

#include "src/fit/stages/fit_lanes.h"
#include "src/fit/stages/fit_stage.h"

/* Rounds x to the nearest integer in 0..most_code, as a code; most_code must be below 2^22. */
static inline whole code_of(real x, int most_code)
{
    const real held = least(most(x, all(0)), all((float)most_code));
    return bits_of(held + 12582912.0f) - 0x4b400000;
}

/* Widens a code from `width` to `wide` bits, by repeating its high bits below. */
static inline real spread_code(whole code, int width, int wide)
{
    return whole_to_real(shifted_left(code, wide - width) | (code >> (2 * width - wide)));
}

/* Quantises x in even steps: returns low + step times the code of `width` bits, which is widened to `wide` bits. */
static inline real quantise_evenly(real x, float low, float step, float inverse_step, int width, int wide, whole *code)
{
    *code = code_of((x - low) * inverse_step, (1 << width) - 1);
    return low + spread_code(*code, width, wide) * step;
}

static inline real spread_scale(whole code, int width, int i)
{
    return i < 2 ? spread_code(code, width, 10) : spread_code(code, width, 9) * 2.0f;
}

/* Quantises ln(sigma) of a Gaussian's axis i. A code stands for log2(sigma) = high - code^2 step, with `high` and
   `step` given by the chunk of 256 Gaussians. */
static inline real quantise_scale(const fxs_fit_chunk *c, real x, int width, int i, whole *code)
{
    const int most_code = (1 << width) - 1;
    const float largest = i < 2 ? 1023.0f : 1022.0f;
    const real octaves = x * 1.44269504f, from_high = most(c->scale - octaves, all(0)) * c->scale_inverse;
    const whole near = code_of(root(from_high) * ((float)most_code / largest) - 0.5f, most_code);
    const whole far = code_of(whole_to_real(near) + 1.0f, most_code);
    const real a = spread_scale(near, width, i), b = spread_scale(far, width, i);
    const real of_near = c->scale - a * a * c->scale_step, of_far = c->scale - b * b * c->scale_step;
    const mask is_far = below(absolute(of_far - octaves), absolute(of_near - octaves));
    *code = bits_of(choose(is_far, real_of(far), real_of(near)));
    return choose(is_far, of_far, of_near) * 0.693147181f;
}

/* Returns the opacity that a code stands for. If opacity_range is 0: code / 255. Else 0 for code 0, and 1/255 +
   opacity_range ((code - 1) / 254)^2 for others. */
static inline real opacity_of(const fxs_fit_chunk *c, whole code)
{
    const real number = whole_to_real(code);
    if (c->opacity_range == 0)
        return number * (1.0f / 255.0f);
    const real part = (number - 1.0f) * (1.0f / 254.0f);
    return choose(below(all(0), number), (1.0f / 255.0f) + part * part * c->opacity_range, all(0));
}

/* Quantises opacities given as logits, and returns logits. Opacity 0 gives -80; 0.999 and more give 6.9. */
static inline real quantise_opacity(const fxs_fit_chunk *c, real logit, whole *code)
{
    const real opacity = 1.0f / (1.0f + exp_e(least(-logit, all(80))));
    if (c->opacity_range == 0)
        *code = code_of(opacity * 255.0f, 255);
    else {
        const real part = most(opacity - 1.0f / 255.0f, all(0)) * c->opacity_inverse;
        const whole near = code_of(root(part) * 254.0f + 0.5f, 255), far = code_of(whole_to_real(near) + 1.0f, 255);
        const mask is_far = below(absolute(opacity_of(c, far) - opacity), absolute(opacity_of(c, near) - opacity));
        const real drawn = choose(is_far, real_of(far), real_of(near));
        *code = bits_of(choose(below(opacity, all(1.0f / 255.0f)), all(0), drawn));
    }
    const real said = opacity_of(c, *code);
    return choose(below(all(0), said), ln(most(said, all(0.001f)) / most(1.0f - said, all(0.001f))), all(-80));
}

static inline whole magnitude(whole x)
{
    return (x ^ (x >> 31)) - (x >> 31);
}

static inline whole smaller(whole a, whole b)
{
    return b + ((a - b) & ((a - b) >> 31));
}

static inline whole axis_bits(const fxs_fit_grid *g, const fxs_fit_chunk *c, const whole codes[3])
{
    const int step = (int)(c->scale_step * 16777216.0f);
    whole fall[3];
    for (int i = 0; i < 3; i++) {
        const whole code = real_to_whole(spread_scale(codes[i], g->scale_bits[i], i));
        fall[i] = (code * code * step + 128) >> 8;
    }
    const whole gap = smaller(magnitude(fall[1] - fall[0]), magnitude(fall[2] - fall[0]));
    return smaller((((gap >> 4) * 5) >> 16) + g->axis_bits_least, gap * 0 + g->axis_bits_most);
}

/* Rounds x to the nearest integer; |x| must be below 2^21. */
static inline real nearest(real x)
{
    return whole_to_real(bits_of(x + 12582912.0f) - 0x4b400000);
}

/* Rounds x down to a multiple of 2^-15. */
static inline real upper_bits(real x)
{
    return nearest(x * 32768.0f - 0.499f) * (1.0f / 32768.0f);
}

/* Returns the fraction code / count, which the bits that follow a rotation code add to it as a refinement. A negative
   `code` is in two's complement. */
static inline real part_above(real code, real count)
{
    return choose(below(code, all(0)), code + count, code) / count;
}

/* Approximates the cosine and sine of the angle pi/2 roll. */
static inline void roll_of(real roll, real *cosine, real *sine)
{
    const real square = roll * roll;
    *cosine = 1.0f - square * (1.225f - 0.225f * square);
    *sine = roll * (1.56607f - square * (0.62924f - 0.06305f * square));
}

/* Returns the angle (roll) of a rotation's second axis, b, about its first axis, which x and y encode. */
static inline real find_roll(const real b[3], real x, real y)
{
    const real s = root(most(2.0f - x * x - y * y, all(0)));
    const real along = b[0] * (1.0f - x * x) - b[1] * (x * y) - b[2] * (x * s);
    const real across = b[1] * (1.0f - y * y) - b[0] * (x * y) - b[2] * (y * s);
    const real length = root(along * along + across * across), sign = choose(below(along, all(0)), all(-1), all(1));
    const real u = sign * along / length, v = sign * across / length;
    real roll = v / (u + absolute(v));
    for (int i = 0; i < 3; i++) {
        real cosine, sine;
        roll_of(roll, &cosine, &sine);
        roll += (v * cosine - u * sine) * 0.636619772f;
    }
    return roll;
}

/* Decodes a quaternion from its codes. Several quaternions give the same Gaussian and differ only in signs of axes.
   Returns the one nearest to `from`, so that gradients apply to the exact parameters. */
static inline void quaternion_near(const real from[4], real x, real y, real roll, real to[4])
{
    real cosine, sine;
    roll_of(roll, &cosine, &sine);
    const real half = all(0.707106781f), w = root(most(2.0f - x * x - y * y, all(0))) * half;
    const real c = root(most(1.0f + cosine, all(0)) * 0.5f), d = sine / (c * 2.0f), i = -y * half, j = x * half;
    const real p[4] = {w * c, i * c + j * d, j * c - i * d, w * d};
    const real q[4] = {(p[0] + p[1] + (p[2] + p[3])) * 0.5f, (p[1] - p[0] + (p[3] - p[2])) * 0.5f,
                       (p[2] - p[0] + (p[1] - p[3])) * 0.5f, (p[3] - p[0] + (p[2] - p[1])) * 0.5f};
    const real turned[4][4] = {{q[0], q[1], q[2], q[3]}, {-q[1], q[0], q[3], -q[2]},
                               {-q[2], -q[3], q[0], q[1]}, {-q[3], q[2], -q[1], q[0]}};
    real largest = all(0);
    for (int n = 0; n < 4; n++)
        to[n] = q[n];
    for (int k = 0; k < 4; k++) {
        const real dot = (turned[k][0] * from[0] + turned[k][1] * from[1]) +
                         (turned[k][2] * from[2] + turned[k][3] * from[3]);
        const mask is_nearer = below(largest, absolute(dot));
        const real sign = choose(below(dot, all(0)), all(-1), all(1));
        largest = choose(is_nearer, absolute(dot), largest);
        for (int n = 0; n < 4; n++)
            to[n] = choose(is_nearer, sign * turned[k][n], to[n]);
    }
}

/* Codes a quaternion by the first axis of its rotation (X, Y) and the roll about this axis. codes: n, X, Y, roll, with
   n the number of bits of X and of Y. */
static inline void quantise_rotation(const real from[4], whole n, int all_bits, real to[4], whole codes[4])
{
    const real w = from[0], i = from[1], j = from[2], k = from[3];
    const real twice = 2.0f / ((w * w + i * i) + (j * j + k * k));
    const real a[3] = {1.0f - (j * j + k * k) * twice, (i * j + w * k) * twice, (i * k - w * j) * twice};
    const real b[3] = {(i * j - w * k) * twice, 1.0f - (i * i + k * k) * twice, (j * k + w * i) * twice};
    const real sign = choose(below(a[2], all(0)), all(-1), all(1)), length = root(1.0f + absolute(a[2]));
    const real x = sign * a[0] / length, y = sign * a[1] / length;
    const real count = real_of(shifted_left(n + 127, 23)), half = count * 0.5f;
    const real rolls = real_of(shifted_left(all_bits - (n + n) + 127, 23));
    real said_x = x, said_y = y, roll = all(0), x_code = all(0), y_code = all(0), roll_code = all(0);
    for (int round = 0; round < 2; round++) {
        roll_code = nearest(find_roll(b, said_x, said_y) * (rolls * 0.5f));
        roll_code = choose(below(roll_code, rolls * 0.5f), roll_code, -rolls * 0.5f);
        const real below_y = part_above(roll_code, rolls);
        y_code = most(least(nearest(y * half - below_y), half - 1.0f), -half);
        x_code = most(least(nearest(x * half - part_above(y_code + below_y, count)), half - 1.0f), -half);
        for (int again = 0; again < 4; again++) {
            said_y = (y_code + below_y) / half;
            said_x = (x_code + part_above(y_code + below_y, count)) / half;
            const mask is_long = below(all(0.9998f), said_x * said_x + said_y * said_y);
            const mask is_wide = below(absolute(y), absolute(x));
            x_code += keep(both(is_long, is_wide), choose(below(x, all(0)), all(1), all(-1)));
            y_code += choose(is_wide, all(0), keep(is_long, choose(below(y, all(0)), all(1), all(-1))));
        }
        said_y = upper_bits((y_code + below_y) / half);
        said_x = upper_bits((x_code + part_above(y_code + below_y, count)) / half);
        roll = roll_code / (rolls * 0.5f);
    }
    quaternion_near(from, said_x, said_y, roll, to);
    codes[0] = n;
    codes[1] = real_to_whole(x_code);
    codes[2] = real_to_whole(y_code);
    codes[3] = real_to_whole(roll_code);
}

static inline void quantise_shape(const fxs_fit_grid *g, const fxs_fit_chunk *c, const float *from, float *to,
                                  ptrdiff_t stride, whole codes[FXS_FIT_SH])
{
    real q[4], rounded[4];
    whole scales[3], turns[4];
    for (int i = 0; i < 3; i++) {
        const ptrdiff_t at = (FXS_FIT_POSITION + i) * stride, scale = (FXS_FIT_SCALE + i) * stride,
                        colour = (FXS_FIT_COLOUR + i) * stride;
        store(to + at, quantise_evenly(load(from + at), c->low[i], c->step[i], c->inverse[i], g->position_bits, 16,
                                       &codes[FXS_FIT_POSITION + i]));
        store(to + scale, quantise_scale(c, load(from + scale), g->scale_bits[i], i, &scales[i]));
        store(to + colour, quantise_evenly(load(from + colour), c->colour[i], c->colour_step[i], c->colour_inverse[i],
                                           g->colour_bits[i], 9, &codes[FXS_FIT_COLOUR + i]));
        codes[FXS_FIT_SCALE + i] = scales[i];
    }
    for (int i = 0; i < 4; i++)
        q[i] = load(from + (FXS_FIT_ROTATION + i) * stride);
    quantise_rotation(q, axis_bits(g, c, scales), g->rotation_bits, rounded, turns);
    for (int i = 0; i < 4; i++) {
        store(to + (FXS_FIT_ROTATION + i) * stride, rounded[i]);
        codes[FXS_FIT_ROTATION + i] = turns[i];
    }
    const ptrdiff_t at = FXS_FIT_OPACITY * stride;
    store(to + at, quantise_opacity(c, load(from + at), &codes[FXS_FIT_OPACITY]));
}

static inline real quantise_band(const fxs_fit_chunk *c, int degree, real x, whole *code)
{
    *code = code_of(x * c->sh_inverse[degree - 1] + 127.0f, 254) - 127;
    return whole_to_real(*code) * c->sh_step[degree - 1];
}

#endif
