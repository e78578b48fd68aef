/* Quantises LANES Gaussians as packing does: finds their codes and the values of the codes (docs/format.md). */
#ifndef FXS_FIT_QUANTISE_H
#define FXS_FIT_QUANTISE_H

#include "fit_lanes.h"
#include "fit_stage.h"

/* Rounds to the nearest integer in 0..most; most below 2^22. */
static inline whole code_of(real x, int most_code)
{
    const real held = least(most(x, all(0)), all((float)most_code));
    return bits_of(held + 12582912.0f) - 0x4b400000;
}

/* Extends a code to `wide` bits by repeating its high bits below. */
static inline real spread_code(whole code, int width, int wide)
{
    return whole_to_real(shifted_left(code, wide - width) | (code >> (2 * width - wide)));
}

/* low + code step */
static inline real quantise_evenly(real x, float low, float step, float inverse_step, int width, int wide, whole *code)
{
    *code = code_of((x - low) * inverse_step, (1 << width) - 1);
    return low + spread_code(*code, width, wide) * step;
}

/* log2(sigma) = high - code^2 step; from and to ln(sigma) */
static inline real quantise_scale(const fxs_fit_chunk *c, real x, int width, whole *code)
{
    const int most_code = (1 << width) - 1;
    const real octaves = x * 1.44269504f, from_high = most(c->scale - octaves, all(0)) * c->scale_inverse;
    const whole near = code_of(root(from_high) * ((float)most_code / 1023.0f) - 0.5f, most_code);
    const whole far = code_of(whole_to_real(near) + 1.0f, most_code);
    const real a = spread_code(near, width, 10), b = spread_code(far, width, 10);
    const real of_near = c->scale - a * a * c->scale_step, of_far = c->scale - b * b * c->scale_step;
    const mask is_far = below(absolute(of_far - octaves), absolute(of_near - octaves));
    *code = bits_of(choose(is_far, real_of(far), real_of(near)));
    return choose(is_far, of_far, of_near) * 0.693147181f;
}

/* The opacity of a code. Law 0: code / 255; else 1/255 + range ((code - 1) / 254)^2, and 0 for code 0. */
static inline real opacity_of(const fxs_fit_chunk *c, whole code)
{
    const real number = whole_to_real(code);
    if (c->opacity_range == 0)
        return number * (1.0f / 255.0f);
    const real part = (number - 1.0f) * (1.0f / 254.0f);
    return choose(below(all(0), number), (1.0f / 255.0f) + part * part * c->opacity_range, all(0));
}

/* From a logit to opacity, and from opacity to a logit: -80 for 0, at most 6.9, for 0.999. */
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

/* Codes a quaternion by its smallest three components. Its sign stays, so that the gradient fits the master. Codes: the
   index of the largest component, then the others in order, signed so that the largest is positive. */
static inline void quantise_rotation(const real from[4], int width, real to[4], whole codes[4])
{
    const float half = (float)((1 << width) - 1) * 0.5f;
    real largest = from[0], place = all(0), rest = all(0);
    for (int i = 1; i < 4; i++) {
        const mask is_larger = below(absolute(largest), absolute(from[i]));
        largest = choose(is_larger, from[i], largest);
        place = choose(is_larger, all((float)i), place);
    }
    const real length = root((from[0] * from[0] + from[1] * from[1]) + (from[2] * from[2] + from[3] * from[3]));
    const real sign = choose(below(largest, all(0)), all(-1), all(1)), scale = 1.41421356f * sign / length;
    real others[3];
    for (int i = 0; i < 3; i++) {
        const real q = choose(below(all((float)i), place), from[i], from[i + 1]);
        codes[1 + i] = code_of((q * scale + 1.0f) * half, (1 << width) - 1);
        others[i] = (spread_code(codes[1 + i], width, 10) * (1.0f / 511.5f) - 1.0f) * 0.707106781f;
        rest += others[i] * others[i];
    }
    codes[0] = code_of(place, 3);
    rest = root(most(1.0f - rest, all(0)));
    for (int i = 0; i < 4; i++) {
        const real after = i > 0 ? others[i - 1] : rest, before = i < 3 ? others[i] : rest;
        to[i] = sign * choose(below(all((float)i), place), before, choose(below(place, all((float)i)), after, rest));
    }
}

/* `from` and `to`: the Gaussians' first parameter; planes are `stride` apart. Codes: a number for each parameter up to
   the colours; those of the rotation are the index of the largest component, then the others. SH are not coded here. */
static inline void quantise_shape(const fxs_fit_grid *g, const fxs_fit_chunk *c, const float *from, float *to,
                                  ptrdiff_t stride, whole codes[FXS_FIT_SH])
{
    real q[4], rounded[4];
    for (int i = 0; i < 3; i++) {
        const ptrdiff_t at = (FXS_FIT_POSITION + i) * stride, scale = (FXS_FIT_SCALE + i) * stride,
                        colour = (FXS_FIT_COLOUR + i) * stride;
        store(to + at, quantise_evenly(load(from + at), c->low[i], c->step[i], c->inverse[i], g->position_bits, 16,
                                       &codes[FXS_FIT_POSITION + i]));
        store(to + scale, quantise_scale(c, load(from + scale), g->scale_bits[i], &codes[FXS_FIT_SCALE + i]));
        store(to + colour, quantise_evenly(load(from + colour), c->colour[i], c->colour_step[i], c->colour_inverse[i],
                                           g->colour_bits[i], 8, &codes[FXS_FIT_COLOUR + i]));
    }
    for (int i = 0; i < 4; i++)
        q[i] = load(from + (FXS_FIT_ROTATION + i) * stride);
    quantise_rotation(q, g->rotation_bits, rounded, &codes[FXS_FIT_ROTATION]);
    for (int i = 0; i < 4; i++)
        store(to + (FXS_FIT_ROTATION + i) * stride, rounded[i]);
    const ptrdiff_t at = FXS_FIT_OPACITY * stride;
    store(to + at, quantise_opacity(c, load(from + at), &codes[FXS_FIT_OPACITY]));
}

/* SH with a code step for each degree, codes in -127..127. */
static inline real quantise_band(const fxs_fit_chunk *c, int degree, real x, whole *code)
{
    *code = code_of(x * c->sh_inverse[degree - 1] + 127.0f, 254) - 127;
    return whole_to_real(*code) * c->sh_step[degree - 1];
}

#endif
