#include "encode.h"

#include <math.h>
#include <string.h>

#define C0 0.28209479177387814
#define DEGREES 57.29577951308232   /* a radian */
#define LOG2_E 1.4426950408889634

/* ---- Ranges of each chunk -------------------------------------------------------------------------------------- */

void fxs_ranges_clear(fxs_chunk_ranges *ranges)
{
    const fxs_range none = {INFINITY, -INFINITY};
    *ranges = (fxs_chunk_ranges){{none, none, none}, none, {none, none, none}, {0, 0, 0}};
}

static void widen(fxs_range *r, float x)
{
    r->low = x < r->low ? x : r->low;
    r->high = x > r->high ? x : r->high;
}

/* log2(sigma) */
static double log2_scale(const fxs_gaussian *g, int axis)
{
    return g->scale[axis] * LOG2_E;
}

static double base_colour(const fxs_gaussian *g, int channel)
{
    double colour = 0.5 + C0 * g->dc[channel];
    return colour < -60 ? -60 : colour > 60 ? 60 : colour;
}

void fxs_ranges_take(fxs_chunk_ranges *r, const fxs_gaussian *g, int sh_degree)
{
    for (int i = 0; i < 3; i++) {
        widen(&r->position[i], g->position[i]);
        widen(&r->scale, (float)log2_scale(g, i));
        widen(&r->colour[i], (float)base_colour(g, i));
    }
    for (int degree = 1; degree <= sh_degree; degree++) {
        float most = r->sh[degree - 1];
        for (int i = 3 * FXS_SH_COUNT(degree - 1); i < 3 * FXS_SH_COUNT(degree); i++)
            most = fabsf(g->sh[i]) > most ? fabsf(g->sh[i]) : most;
        r->sh[degree - 1] = most;
    }
}

/* The smallest step, in units of 2^-q, with which `codes` + 1 codes reach from low over the whole range. */
static uint32_t step_for(double reach, int codes, int q)
{
    return (uint32_t)fmin(ceil(ldexp(reach, q) / codes), UINT32_MAX);
}

void fxs_encode_header(fxs_chunk *chunk, const fxs_chunk_ranges *r)
{
    double most = 0;
    memset(chunk, 0, sizeof *chunk);
    for (int i = 0; i < 3; i++)
        most = fmax(most, (double)r->position[i].high - r->position[i].low);
    while (ldexp(most, 32 - (int)chunk->step_shift) / 65535 > 4294967294.0)
        chunk->step_shift++;
    chunk->scale_q16 = (int32_t)ceil(ldexp(r->scale.high, 16));
    chunk->scale_step_q24 = step_for(ldexp(chunk->scale_q16, -16) - r->scale.low, 1023 * 1023, 24);
    for (int i = 0; i < 3; i++) {
        chunk->origin_q32[i] = (int64_t)floor(ldexp(r->position[i].low, 32));
        chunk->step_q32[i] = step_for(r->position[i].high - ldexp((double)chunk->origin_q32[i], -32), 65535,
                                      32 - (int)chunk->step_shift);
        chunk->colour_q16[i] = (int32_t)floor(ldexp(r->colour[i].low, 16));
        chunk->colour_step_q20[i] = step_for(r->colour[i].high - ldexp(chunk->colour_q16[i], -16), 255, 20);
        uint32_t step = step_for(r->sh[i], 127, 19);
        chunk->sh_step_q19[i] = step < 32767 ? step : 32767;
    }
}

/* ---- Codes ----------------------------------------------------------------------------------------------------- */

static void note_error(double *largest, double error)
{
    error = fabs(error);
    *largest = error > *largest ? error : *largest;
}

/* floor(x) in low..high. */
static int floor_within(double x, int low, int high)
{
    x = x < low ? low : x > high ? high : x;
    int whole = (int)x;
    return whole - (whole > x);
}

/* round((x - low) / step) in 0..codes, and how far off that is. */
static uint32_t encode(double x, double low, double step, int codes, double *largest)
{
    int code = step > 0 ? floor_within((x - low) / step + 0.5, 0, codes) : 0;
    note_error(largest, low + code * step - x);
    return (uint32_t)code;
}

/* Nearest code with log2(sigma) = high - code^2 step. */
static uint32_t encode_scale(double x, double high, double step, double *largest)
{
    double code = step > 0 && x < high ? floor(sqrt((high - x) / step)) : 0;
    double above = high - code * code * step - x, below = x - (high - (code + 1) * (code + 1) * step);
    code += code < 1023 && step > 0 && below < above;
    note_error(largest, high - code * code * step - x);
    return code < 1023 ? (uint32_t)code : 1023;
}

/* 2 acos(|dot|), degrees. acos(x)^2 <= 2.5 (1 - x) in 0..1, so that few have to be known. */
static void note_angle(double *largest, double dot)
{
    dot = fabs(dot) < 1 ? fabs(dot) : 1;
    if (10 * DEGREES * DEGREES * (1 - dot) > *largest * *largest)
        note_error(largest, 2 * acos(dot) * DEGREES);
}

/* Smallest three: the largest component is left out, the others are in +-1/sqrt(2), 10 bits each. */
static uint32_t encode_rotation(const float rotation[4], double *largest_error)
{
    double q[4], decoded[4], norm = 0, rest = 0, dot = 0;
    int largest = 0;
    for (int i = 0; i < 4; i++) {
        norm += (double)rotation[i] * rotation[i];
        largest = fabsf(rotation[i]) > fabsf(rotation[largest]) ? i : largest;
    }
    norm = copysign(sqrt(norm), rotation[largest]);
    uint32_t word = (uint32_t)largest << 30;
    for (int i = 0, shift = 20; i < 4; i++) {
        q[i] = rotation[i] / norm;
        if (i == largest)
            continue;
        int code = floor_within((q[i] * 1.4142135623730951 + 1) * 511.5 + 0.5, 0, 1023);
        decoded[i] = (code / 511.5 - 1) / 1.4142135623730951;
        rest += decoded[i] * decoded[i];
        word |= (uint32_t)code << shift;
        shift -= 10;
    }
    decoded[largest] = sqrt(fmax(0, 1 - rest));
    for (int i = 0; i < 4; i++)
        dot += q[i] * decoded[i];
    note_angle(largest_error, dot);
    return word;
}

static uint32_t encode_colour(const fxs_gaussian *g, const fxs_chunk *chunk, fxs_pack_error *largest)
{
    double opacity = 1 / (1 + exp(-g->opacity)), colour_error = 0;
    uint32_t word = (uint32_t)floor(opacity * 255 + 0.5) << 24;
    note_error(&largest->opacity, (word >> 24) / 255.0 - opacity);
    for (int i = 0; i < 3; i++)
        word |= encode(base_colour(g, i), chunk->colour_q16[i] * 0x1p-16, chunk->colour_step_q20[i] * 0x1p-20, 255,
                       &colour_error) << 8 * i;
    note_error(&largest->dc, colour_error / C0);
    return word;
}

/* round(x / step) in +-127: x is a float and step a whole number of 2^-19, so that no quotient but an exact half lies
   within 2^-40 of a half, and adding 128.5 rounds nothing over it. */
static int8_t encode_coefficient(double x, double step, double *largest)
{
    double most = 127 * step, held = x < -most ? -most : x > most ? most : x;
    int code = step > 0 ? (int)(held / step + 128.5) - 128 : 0;
    note_error(largest, code * step - x);
    return (int8_t)code;
}

void fxs_encode(unsigned char *bytes, uint32_t at, const fxs_gaussian *g, int sh_degree, fxs_pack_error *largest)
{
    const fxs_chunk *chunk = (const fxs_chunk *)(void *)bytes;
    uint16_t *position = (uint16_t *)(void *)(bytes + FXS_CHUNK_POSITION);
    uint32_t *rotation = (uint32_t *)(void *)(bytes + FXS_CHUNK_ROTATION), scale_word = 0;
    uint32_t *scale = (uint32_t *)(void *)(bytes + FXS_CHUNK_SCALE);
    uint32_t *colour = (uint32_t *)(void *)(bytes + FXS_CHUNK_COLOUR);
    int8_t *sh = (int8_t *)(bytes + FXS_CHUNK_SH);
    double scale_error = 0, sh_error = 0;
    for (int i = 0; i < 3; i++) {
        position[i * FXS_CHUNK + (int)at] = (uint16_t)encode(
            g->position[i], (double)chunk->origin_q32[i] * 0x1p-32,
            (double)((uint64_t)chunk->step_q32[i] << chunk->step_shift) * 0x1p-32, 65535, &largest->position);
        scale_word |= encode_scale(log2_scale(g, i), chunk->scale_q16 * 0x1p-16, chunk->scale_step_q24 * 0x1p-24,
                                   &scale_error) << 10 * i;
    }
    note_error(&largest->scale, scale_error / LOG2_E);
    rotation[at] = encode_rotation(g->rotation, &largest->rotation);
    scale[at] = scale_word;
    colour[at] = encode_colour(g, chunk, largest);
    for (int degree = 1; degree <= sh_degree; degree++) {
        double step = chunk->sh_step_q19[degree - 1] * 0x1p-19;
        for (int i = 3 * FXS_SH_COUNT(degree - 1); i < 3 * FXS_SH_COUNT(degree); i++)
            sh[i * FXS_CHUNK + (int)at] = encode_coefficient(g->sh[i], step, &sh_error);
    }
    note_error(&largest->sh, sh_error);
}
