/* Writes the headers and rows of chunks. A chunk is 256 Gaussians of a packed scene, a row has one attribute of them.
 * The header gets the smallest fixed-point steps that cover the ranges of the Gaussians. */
#include "encode.h"

#include <math.h>
#include <string.h>

#include "pack_stage.h"

#define SCALE_LIMIT 20.0f           /* largest |ln(sigma)| of an axis */
#define THINNEST 9.0f               /* largest ln(longest axis / shortest axis) of a Gaussian */

int fxs_floor_within(double x, int low, int high)
{
    const double held = x > low ? x < high ? x : high : low;
    const int cut = (int)held;
    return cut - (cut > held);
}

float fxs_held_scale(float scale)
{
    return scale > -SCALE_LIMIT ? scale < SCALE_LIMIT ? scale : SCALE_LIMIT : -SCALE_LIMIT;
}

/* Limits the scales of a Gaussian, because one needle would coarsen the scale steps of its whole chunk (256
   Gaussians). */
void fxs_hold_scales(fxs_gaussian *g)
{
    const float *s = g->scale, most = s[0] > s[1] ? s[0] : s[1], least = (s[2] > most ? s[2] : most) - THINNEST;
    for (int i = 0; i < 3; i++)
        g->scale[i] = fxs_held_scale(s[i] > least ? s[i] : least);
}

int fxs_bring_in(fxs_gaussian *g, double limit)
{
    double most = 0;
    for (int i = 0; i < 3; i++)
        most = fabs(g->position[i]) > most ? fabs(g->position[i]) : most;
    if (!(most > limit))
        return 0;
    for (int i = 0; i < 3; i++) {
        g->position[i] = (float)(g->position[i] / most * limit);
        g->scale[i] += (float)fxs_log(limit / most);
    }
    return 1;
}

void fxs_ranges_clear(fxs_chunk_ranges *ranges)
{
    const fxs_range none = {INFINITY, -INFINITY};
    *ranges = (fxs_chunk_ranges){{none, none, none}, none, {none, none, none}, {0, 0, 0}, {0, 0, 0, 0}};
}

/* Clamps x to low..high and rounds it towards 0. NaN gives low. */
static int64_t cut_to(double x, double low, double high)
{
    return (int64_t)(x > low ? x < high ? x : high : low);
}

void fxs_ranges_take(fxs_chunk_ranges *ranges, const fxs_gaussian *g, double opacity, int sh_degree)
{
    fxs_pack_stages_choose(~0u)->take_ranges(ranges, g, opacity, sh_degree);
}

/* Returns the smallest quantisation step, in units of 2^-q, with which codes 0 to `codes` cover a range of width
   `reach`. */
static uint32_t step_for(double reach, int codes, int q)
{
    return (uint32_t)cut_to(ceil(ldexp(reach, q) / codes), 0, UINT32_MAX);
}

static void find_colour_codes(fxs_chunk *chunk, int channel, const fxs_range *r, const fxs_grid *grid)
{
    double low = grid->step > 0 ? floor((r->low - grid->low) / grid->step + 0.5) * grid->step + grid->low : 0;
    if (grid->step > 0 && r->high < low + 255.5 * grid->step) {
        chunk->colour_q16[channel] = (int32_t)cut_to(floor(ldexp(low, 16) + 0.5), INT32_MIN, INT32_MAX);
        chunk->colour_step_q20[channel] = (uint32_t)cut_to(floor(ldexp(grid->step, 19) + 0.5), 0, UINT32_MAX);
        return;
    }
    chunk->colour_q16[channel] = (int32_t)cut_to(floor(ldexp(r->low, 16)), INT32_MIN, INT32_MAX);
    chunk->colour_step_q20[channel] = step_for(r->high - ldexp(chunk->colour_q16[channel], -16), FXS_COLOUR_MOST, 20);
}

static uint32_t sh_step(float most, const fxs_grid *grid)
{
    double own = ldexp(grid->step, 19);
    uint32_t step = step_for(most, 127, 19);
    return own == floor(own) && step <= own ? (uint32_t)own : step < 32767 ? step : 32767;
}

void fxs_encode_places(fxs_chunk *chunk, const fxs_range position[3])
{
    double most = 0;
    chunk->step_shift = 0;
    for (int i = 0; i < 3; i++)
        most = fmax(most, (double)position[i].high - position[i].low);
    while (chunk->step_shift < 12 && ldexp(most, 32 - (int)chunk->step_shift) / 65535 > 4294967294.0)
        chunk->step_shift++;
    for (int i = 0; i < 3; i++) {
        chunk->origin_q32[i] = cut_to(floor(ldexp(position[i].low, 32)), -0x1p60, 0x1p60);
        chunk->step_q32[i] = step_for(position[i].high - ldexp((double)chunk->origin_q32[i], -32), 65535,
                                      32 - (int)chunk->step_shift);
    }
}

void fxs_encode_header(fxs_chunk *chunk, const fxs_chunk_ranges *r, const fxs_scene_file_info *info)
{
    memset(chunk, 0, sizeof *chunk);
    fxs_encode_places(chunk, r->position);
    chunk->scale_q16 = (int32_t)cut_to(ceil(ldexp(r->scale.high, 16)), INT32_MIN, INT32_MAX);
    chunk->scale_step_q24 = (uint16_t)step_for(ldexp(chunk->scale_q16, -16) - r->scale.low, 1022 * 1022, 24);
    for (uint32_t law = 1; law < FXS_OPACITY_LAWS; law++)
        if (r->opacity_harm[law] < r->opacity_harm[chunk->opacity_law])
            chunk->opacity_law = (uint16_t)law;
    for (int i = 0; i < 3; i++) {
        find_colour_codes(chunk, i, &r->colour[i], &info->colour);
        chunk->sh_step_q19[i] = (uint16_t)sh_step(r->sh[i], &info->sh);
    }
}

void fxs_code_coefficients(const float *restrict x, int count, double step, int32_t *restrict codes)
{
    const double inverse = step > 0 ? 1 / step : 0;
    for (int i = 0; i < count; i++)
        codes[i] = fxs_coefficient_code((double)x[i], step, inverse);
}

double fxs_gain(int code)
{
    return fxs_scaled(8 + (code & 7), (code >> 3) - 32);
}

static unsigned char *put(unsigned char *to, uint32_t value, int bytes)
{
    for (int i = 0; i < bytes; i++)
        *to++ = (unsigned char)(value >> 8 * i);
    return to;
}

unsigned char *fxs_put_codes(const fxs_encoder *e, const fxs_row_codes *codes, unsigned char *record)
{
    const uint32_t *p = codes->position, *s = codes->scale, *c = codes->colour, rotation = codes->rotation;
    if (e->profile == FXS_PROFILE_SMALL) {
        record = put(record, p[0] | p[1] << 11 | (rotation >> 10 & 3) << 22 | codes->opacity << 24, 4);
        record = put(record, p[2] | c[0] << 11 | c[1] << 18 | c[2] << 25 | (rotation >> 9) << 31, 4);
        record = put(record, s[0] | s[1] << 7 | s[2] << 14 | (rotation & 0xfff00000u), 4);
        return put(record, rotation >> 12 & 255, 1);
    }
    for (int i = 0; i < 3; i++)
        record = put(record, p[i], 2);
    record = put(record, rotation, 4);
    record = put(record, s[0] | s[1] << 10 | s[2] << 20 | (c[0] & 1) << 29 | (c[1] & 1) << 30 | c[2] << 31, 4);
    return put(record, c[0] >> 1 | c[1] >> 1 << 8 | c[2] >> 1 << 16 | codes->opacity << 24, 4);
}

void fxs_encode(const fxs_encoder *e, const fxs_chunk *chunk, const fxs_gaussian *g, double opacity,
                unsigned char record[FXS_RECORD_BYTES], fxs_loss *loss)
{
    fxs_pack_stages_choose(~0u)->encode(e, chunk, g, opacity, record, loss);
}

static unsigned char *put_row(unsigned char *to, const unsigned char *records, uint32_t bytes, uint32_t first,
                              uint32_t width)
{
    records += first;
    for (uint32_t at = 0; at < FXS_CHUNK && width == 1; at++, records += bytes)
        *to++ = *records;
    for (uint32_t at = 0; at < FXS_CHUNK && width > 1; at++, records += bytes)
        for (uint32_t i = 0; i < width; i++)
            *to++ = records[i];
    return to;
}

void fxs_encode_rows(const fxs_encoder *e, uint32_t motion_bytes, const unsigned char *records, unsigned char *rows)
{
    static const unsigned char small[] = {4, 4, 4, 1, 0}, others[] = {2, 2, 2, 4, 4, 4, 0};
    const uint32_t still = fxs_chunk_bytes(e->profile, e->sh_degree) / FXS_CHUNK, bytes = still + motion_bytes;
    uint32_t first = 0;
    for (const unsigned char *width = e->profile == FXS_PROFILE_SMALL ? small : others; *width; first += *width++)
        rows = put_row(rows, records, bytes, first, *width);
    const uint32_t width = e->profile == FXS_PROFILE_DEFAULT ? 1 : still - first;
    for (; first < still; first += width)
        rows = put_row(rows, records, bytes, first, width);
    for (; first < bytes; first += 2)
        rows = put_row(rows, records, bytes, first, 2);
}
