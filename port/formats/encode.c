#include "encode.h"

#include <math.h>
#include <string.h>

#define C0 0.28209479177387814
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

static int degree_of(int coefficient)
{
    return coefficient < 3 ? 0 : coefficient < 8 ? 1 : 2;
}

void fxs_ranges_take(fxs_chunk_ranges *r, const fxs_gaussian *g, int sh_degree)
{
    for (int i = 0; i < 3; i++) {
        widen(&r->position[i], g->position[i]);
        widen(&r->scale, (float)log2_scale(g, i));
        widen(&r->colour[i], (float)base_colour(g, i));
    }
    for (int k = 0; k < FXS_SH_COUNT(sh_degree); k++)
        for (int c = 0; c < 3; c++) {
            float *most = &r->sh[degree_of(k)];
            *most = fmaxf(*most, fabsf(g->sh[3 * k + c]));
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
    *largest = fmax(*largest, fabs(error));
}

/* round((x - low) / step) in 0..codes, and how far off that is. */
static uint32_t encode(double x, double low, double step, int codes, double *largest)
{
    double code = step > 0 ? floor((x - low) / step + 0.5) : 0;
    code = code < 0 ? 0 : code > codes ? codes : code;
    note_error(largest, low + code * step - x);
    return (uint32_t)code;
}

/* Nearest code with log2(sigma) = high - code^2 step. */
static uint32_t encode_scale(double x, double high, double step, double *largest)
{
    double code = step > 0 ? floor(sqrt(fmax(0, (high - x) / step))) : 0;
    double above = high - code * code * step - x, below = x - (high - (code + 1) * (code + 1) * step);
    code += code < 1023 && step > 0 && below < above;
    note_error(largest, high - code * code * step - x);
    return (uint32_t)fmin(code, 1023);
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
        double code = floor((q[i] * 1.4142135623730951 + 1) * 511.5 + 0.5);
        code = code < 0 ? 0 : code > 1023 ? 1023 : code;
        decoded[i] = (code / 511.5 - 1) / 1.4142135623730951;
        rest += decoded[i] * decoded[i];
        word |= (uint32_t)code << shift;
        shift -= 10;
    }
    decoded[largest] = sqrt(fmax(0, 1 - rest));
    for (int i = 0; i < 4; i++)
        dot += q[i] * decoded[i];
    note_error(largest_error, 2 * acos(fmin(1, fabs(dot))) * 57.29577951308232);
    return word;
}

static uint32_t encode_colour(const fxs_gaussian *g, const fxs_chunk *chunk, fxs_pack_error *largest)
{
    double opacity = 1 / (1 + exp(-g->opacity)), colour_error = 0;
    uint32_t word = (uint32_t)floor(opacity * 255 + 0.5) << 24;
    note_error(&largest->opacity, (word >> 24) / 255.0 - opacity);
    for (int i = 0; i < 3; i++)
        word |= encode(base_colour(g, i), ldexp(chunk->colour_q16[i], -16), ldexp(chunk->colour_step_q20[i], -20), 255,
                       &colour_error) << 8 * i;
    note_error(&largest->dc, colour_error / C0);
    return word;
}

static int8_t encode_coefficient(double x, uint32_t step_q19, double *largest)
{
    double step = ldexp(step_q19, -19), code = step > 0 ? floor(x / step + 0.5) : 0;
    code = code < -127 ? -127 : code > 127 ? 127 : code;
    note_error(largest, code * step - x);
    return (int8_t)code;
}

void fxs_encode(const fxs_chunk *chunk, unsigned char *rows, uint32_t at, const fxs_gaussian *g, int sh_degree, fxs_pack_error *largest)
{
    uint16_t *position = (uint16_t *)(void *)(rows + FXS_ROW_POSITION);
    uint32_t *rotation = (uint32_t *)(void *)(rows + FXS_ROW_ROTATION), scale_word = 0;
    uint32_t *scale = (uint32_t *)(void *)(rows + FXS_ROW_SCALE);
    uint32_t *colour = (uint32_t *)(void *)(rows + FXS_ROW_COLOUR);
    int8_t *sh = (int8_t *)(rows + FXS_ROW_SH);
    double scale_error = 0;
    for (int i = 0; i < 3; i++) {
        position[i * FXS_CHUNK + (int)at] = (uint16_t)encode(
            g->position[i], ldexp((double)chunk->origin_q32[i], -32),
            ldexp(chunk->step_q32[i], (int)chunk->step_shift - 32), 65535, &largest->position);
        scale_word |= encode_scale(log2_scale(g, i), ldexp(chunk->scale_q16, -16), ldexp(chunk->scale_step_q24, -24),
                                   &scale_error) << 10 * i;
    }
    note_error(&largest->scale, scale_error / LOG2_E);
    rotation[at] = encode_rotation(g->rotation, &largest->rotation);
    scale[at] = scale_word;
    colour[at] = encode_colour(g, chunk, largest);
    for (int k = 0; k < FXS_SH_COUNT(sh_degree); k++)
        for (int c = 0; c < 3; c++)
            sh[(3 * k + c) * FXS_CHUNK + (int)at] =
                encode_coefficient(g->sh[3 * k + c], chunk->sh_step_q19[degree_of(k)], &largest->sh);
}
