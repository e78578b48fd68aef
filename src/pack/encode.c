#include "encode.h"

#include <math.h>
#include <string.h>

#include "src/gaussian/attributes.h"

#define DEGREES 57.29577951308232   /* in a radian */
#define SCALE_LIMIT 20.0f           /* the largest |ln(sigma)| */
#define THINNEST 9.0f               /* the largest ln of the largest axis over the thinnest */

int fxs_floor_within(double x, int low, int high)
{
    const double held = x > low ? x < high ? x : high : low;
    const int cut = (int)held;
    return cut - (cut > held);
}

/* ---- What a packed scene can hold ------------------------------------------------------------------------------ */

float fxs_held_scale(float scale)
{
    return scale > -SCALE_LIMIT ? scale < SCALE_LIMIT ? scale : SCALE_LIMIT : -SCALE_LIMIT;
}

/* Without this, one needle would widen a chunk's range, and so the steps of the chunk's scales. */
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

/* ---- Ranges of each chunk -------------------------------------------------------------------------------------- */

void fxs_ranges_clear(fxs_chunk_ranges *ranges)
{
    const fxs_range none = {INFINITY, -INFINITY};
    *ranges = (fxs_chunk_ranges){{none, none, none}, none, {none, none, none}, {0, 0, 0}, {0, 0, 0, 0}};
}

/* x clamped to low..high and rounded towards 0; NaN gives low. A file that changes between two passes may have any
   number here. */
static int64_t cut_to(double x, double low, double high)
{
    return (int64_t)(x > low ? x < high ? x : high : low);
}

static void widen(fxs_range *r, float x)
{
    r->low = x < r->low ? x : r->low;
    r->high = x > r->high ? x : r->high;
}

/* log2(sigma) */
static double log2_scale(float scale)
{
    return scale * FXS_LOG2_E;
}

static double base_colour(const fxs_gaussian *g, int channel)
{
    double colour = 0.5 + FXS_SH_0 * g->dc[channel];
    return colour < -60 ? -60 : colour > 60 ? 60 : colour;
}

/* 4^(1 - law), and 254 / sqrt(4^(1 - law) - 1/255); law 0 has even steps */
static const double opacity_tops[FXS_OPACITY_LAWS] = {4, 1, 0.25, 0.0625};
static const double opacity_scales[FXS_OPACITY_LAWS] = {0, 254.4995088403905, 512.0318092708492, 1049.4574808843379};

/* The opacity of a code: 1/255 + (4^(1 - law) - 1/255) ((code - 1) / 254)^2 */
static double opacity_of(int code, uint32_t law)
{
    const double part = (code - 1) / 254.0;
    return law == 0 ? code / 255.0 : code == 0 ? 0 : 1 / 255.0 + (opacity_tops[law] - 1 / 255.0) * (part * part);
}

/* The nearest code, and its opacity less the wanted one; an opacity that never reaches 1/255 is not drawn. */
static int encode_opacity(double opacity, uint32_t law, double *error)
{
    if (law == 0 || !(opacity >= 1 / 255.0)) {
        const int code = law == 0 ? fxs_floor_within(opacity * 255 + 0.5, 0, 255) : 0;
        *error = opacity_of(code, law) - opacity;
        return code;
    }
    const int code = fxs_floor_within(sqrt(opacity - 1 / 255.0) * opacity_scales[law] + 1, 1, 255);
    const int next = code < 255 ? code + 1 : code;
    const double below = opacity_of(code, law) - opacity, above = opacity_of(next, law) - opacity;
    *error = fabs(above) < fabs(below) ? above : below;
    return fabs(above) < fabs(below) ? next : code;
}

/* Fainter Gaussians overlap in greater numbers, so the harm of an error is its square over the opacity. */
static void weigh_opacity(fxs_chunk_ranges *r, double opacity)
{
    for (uint32_t law = 0; law < FXS_OPACITY_LAWS && opacity >= 1 / 255.0; law++) {
        double error;
        encode_opacity(opacity, law, &error);
        r->opacity_harm[law] += (float)(error * error / opacity);
    }
}

float fxs_largest_coefficient(const float *sh, int count)
{
    enum { LANES = 8 };              /* so that comparisons do not wait for each other */
    float most[LANES] = {0};
    for (int i = 0; i < count; i += LANES) {
        const float *x = count - i < LANES ? sh + count - LANES : sh + i;
        for (int k = 0; k < LANES; k++)
            most[k] = fabsf(x[k]) > most[k] ? fabsf(x[k]) : most[k];
    }
    for (int k = 1; k < LANES; k++)
        most[0] = most[k] > most[0] ? most[k] : most[0];
    return most[0];
}

void fxs_ranges_take(fxs_chunk_ranges *r, const fxs_gaussian *g, double opacity, int sh_degree)
{
    for (int i = 0; i < 3; i++) {
        widen(&r->position[i], g->position[i]);
        widen(&r->scale, (float)log2_scale(g->scale[i]));
        widen(&r->colour[i], (float)base_colour(g, i));
    }
    weigh_opacity(r, opacity);
    for (int degree = 1; degree <= sh_degree; degree++) {
        const int first = 3 * FXS_SH_COUNT(degree - 1);
        const float most = fxs_largest_coefficient(g->sh + first, 3 * FXS_SH_COUNT(degree) - first);
        r->sh[degree - 1] = most > r->sh[degree - 1] ? most : r->sh[degree - 1];
    }
}

/* The smallest step, in units of 2^-q, with which `codes` + 1 codes cover the whole range. */
static uint32_t step_for(double reach, int codes, int q)
{
    return (uint32_t)cut_to(ceil(ldexp(reach, q) / codes), 0, UINT32_MAX);
}

static void find_colour_codes(fxs_chunk *chunk, int channel, const fxs_range *r, const fxs_grid *grid)
{
    double low = grid->step > 0 ? floor((r->low - grid->low) / grid->step + 0.5) * grid->step + grid->low : 0;
    if (grid->step > 0 && r->high < low + 255.5 * grid->step) {
        chunk->colour_q16[channel] = (int32_t)cut_to(floor(ldexp(low, 16) + 0.5), INT32_MIN, INT32_MAX);
        chunk->colour_step_q20[channel] = (uint32_t)cut_to(floor(ldexp(grid->step, 20) + 0.5), 0, UINT32_MAX);
        return;
    }
    chunk->colour_q16[channel] = (int32_t)cut_to(floor(ldexp(r->low, 16)), INT32_MIN, INT32_MAX);
    chunk->colour_step_q20[channel] = step_for(r->high - ldexp(chunk->colour_q16[channel], -16), 255, 20);
}

/* At most 32767. */
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
    chunk->scale_step_q24 = (uint16_t)step_for(ldexp(chunk->scale_q16, -16) - r->scale.low, 1023 * 1023, 24);
    for (uint32_t law = 1; law < FXS_OPACITY_LAWS; law++)
        if (r->opacity_harm[law] < r->opacity_harm[chunk->opacity_law])
            chunk->opacity_law = (uint16_t)law;
    for (int i = 0; i < 3; i++) {
        find_colour_codes(chunk, i, &r->colour[i], &info->colour);
        chunk->sh_step_q19[i] = (uint16_t)sh_step(r->sh[i], &info->sh);
    }
}

/* ---- Codes ----------------------------------------------------------------------------------------------------- */

static void note(fxs_loss *loss, int which, double error)
{
    error = fabs(error);
    loss->largest[which] = error > loss->largest[which] ? error : loss->largest[which];
    loss->squares[which] += error * error;
}

/* Extends a code to `wide` bits as the renderer does, by repeating its high bits below. */
static int spread(int code, int bits, int wide)
{
    return bits == wide ? code : code << (wide - bits) | code >> (2 * bits - wide);
}

/* The code of `bits` bits for which low + code step is nearest, with the code extended to `wide` bits. */
static uint32_t encode(double x, double low, double step, int bits, int wide)
{
    const int most = (1 << bits) - 1;
    const double own = bits == wide ? step : step * ((1 << wide) - 1) / most;
    return step > 0 ? (uint32_t)fxs_floor_within((x - low) / own + 0.5, 0, most) : 0;
}

/* Position codes have 11 bits in profile small, else 16. */
static uint32_t encode_position(const fxs_encoder *e, const fxs_chunk *chunk, const fxs_gaussian *g, int axis,
                                fxs_loss *loss)
{
    const int bits = e->profile == FXS_PROFILE_SMALL ? 11 : 16;
    double low = (double)chunk->origin_q32[axis] * 0x1p-32;
    double step = (double)((uint64_t)chunk->step_q32[axis] << chunk->step_shift) * 0x1p-32;
    uint32_t code = encode(g->position[axis], low, step, bits, 16);
    note(loss, FXS_LOSS_POSITION, low + spread((int)code, bits, 16) * step - g->position[axis]);
    return code;
}

/* The nearest code with log2(sigma) = high - code^2 step: 7 bits in small, 6 for its last axis, else 10. */
static uint32_t encode_scale(const fxs_encoder *e, const fxs_chunk *chunk, float scale, int axis, fxs_loss *loss)
{
    const int bits = e->profile != FXS_PROFILE_SMALL ? 10 : axis < 2 ? 7 : 6, most = (1 << bits) - 1;
    double x = log2_scale(scale), high = chunk->scale_q16 * 0x1p-16, step = chunk->scale_step_q24 * 0x1p-24;
    int code = step > 0 && x < high ? fxs_floor_within(sqrt((high - x) / step) * (most / 1023.0), 0, most) : 0;
    int next = code < most && step > 0 ? code + 1 : code;
    double above = high - spread(code, bits, 10) * spread(code, bits, 10) * step - x;
    double below = high - spread(next, bits, 10) * spread(next, bits, 10) * step - x;
    note(loss, FXS_LOSS_SCALE, fabs(below) < fabs(above) ? below : above);
    return (uint32_t)(fabs(below) < fabs(above) ? next : code);
}

/* Notes the angle 2 acos(|dot|), degrees. acos(x)^2 is at most 2.5 (1 - x), and about 2 (1 - x) near x = 1, so few
   angles must be computed to find the largest. */
static void note_angle(fxs_loss *loss, double dot)
{
    double *largest = &loss->largest[FXS_LOSS_ROTATION];
    dot = fabs(dot) < 1 ? fabs(dot) : 1;
    loss->squares[FXS_LOSS_ROTATION] += 8 * DEGREES * DEGREES * (1 - dot);
    if (10 * DEGREES * DEGREES * (1 - dot) > *largest * *largest)
        *largest = fmax(*largest, 2 * acos(dot) * DEGREES);
}

/* Smallest three: the largest component is left out, the others are in +-1/sqrt(2), 10 bits each, 7 in small. Returns
   the index of the largest. */
static uint32_t encode_rotation(const fxs_encoder *e, const double rotation[4], uint32_t codes[3], fxs_loss *loss)
{
    double q[4], decoded[4], norm = 0, rest = 0, dot = 0;
    const int bits = e->profile == FXS_PROFILE_SMALL ? 7 : 10, most = (1 << bits) - 1;
    int largest = 0, n = 0;
    for (int i = 0; i < 4; i++) {
        norm += rotation[i] * rotation[i];
        largest = fabs(rotation[i]) > fabs(rotation[largest]) ? i : largest;
    }
    norm = copysign(sqrt(norm), rotation[largest]);
    for (int i = 0; i < 4; i++)
        q[i] = rotation[i] / norm;
    for (int i = 0; i < 4; i++) {
        if (i == largest)
            continue;
        int code = fxs_floor_within((q[i] * 1.4142135623730951 + 1) * (most / 2.0) + 0.5, 0, most);
        decoded[i] = (spread(code, bits, 10) - 511.5) * (1 / (511.5 * 1.4142135623730951));
        rest += decoded[i] * decoded[i];
        codes[n++] = (uint32_t)code;
    }
    decoded[largest] = sqrt(fmax(0, 1 - rest));
    for (int i = 0; i < 4; i++)
        dot += q[i] * decoded[i];
    note_angle(loss, dot);
    return (uint32_t)largest;
}

/* Turns the axes of a Gaussian so that the thinnest is last: a quarter turn about the axis that stays, q (1 + i) or
   q (1 + j), up to a factor. The changed sign of an axis makes no difference. */
static void put_thinnest_last(float scale[3], double rotation[4])
{
    const int thinnest = scale[0] < scale[1] ? 0 : 1;
    const double w = rotation[0], x = rotation[1], y = rotation[2], z = rotation[3];
    if (!(scale[thinnest] < scale[2]))
        return;
    const float last = scale[2];
    scale[2] = scale[thinnest];
    scale[thinnest] = last;
    rotation[0] = thinnest ? w - x : w - y;
    rotation[1] = thinnest ? x + w : x - z;
    rotation[2] = thinnest ? y + z : y + w;
    rotation[3] = thinnest ? z - y : z + x;
}

/* Colour codes have 8 bits; in small 7, 7 and 6. */
static void encode_colour(const fxs_encoder *e, const fxs_gaussian *g, double opacity, const fxs_chunk *chunk,
                          fxs_codes *codes, fxs_loss *loss)
{
    const int small = e->profile == FXS_PROFILE_SMALL;
    double error;
    codes->opacity = (uint32_t)encode_opacity(opacity, chunk->opacity_law, &error);
    note(loss, FXS_LOSS_OPACITY, error);
    for (int i = 0; i < 3; i++) {
        const int bits = !small ? 8 : i < 2 ? 7 : 6;
        double low = chunk->colour_q16[i] * 0x1p-16, step = chunk->colour_step_q20[i] * 0x1p-20, x = base_colour(g, i);
        codes->colour[i] = encode(x, low, step, bits, 8);
        note(loss, FXS_LOSS_DC, low + spread((int)codes->colour[i], bits, 8) * step - x);
    }
}

/* ---- SH -------------------------------------------------------------------------------------------------------- */

/* x and step are floats of 24 bits, so no quotient but an exact half lies within 2^-26 of a half; and the quotient by
   way of 1 / step, which is wrong by 2^-45 at most, is on the right side of it once 2^-30 is added. */
void fxs_code_coefficients(const float *restrict x, int count, double step, int32_t *restrict codes)
{
    const double most = 127 * step, inverse = step > 0 ? 1 / step : 0;
    for (int i = 0; i < count; i++) {
        const double above = x[i] > -most ? x[i] : -most, held = above < most ? above : most;
        codes[i] = (int32_t)(held * inverse + (128.5 + 0x1p-30)) - 128;
    }
}

/* Codes SH of profile default. Each channel has its own sum, so that additions do not wait for each other. */
static void encode_bands(const fxs_encoder *e, const fxs_chunk *chunk, const fxs_gaussian *g, unsigned char *record,
                         fxs_loss *loss)
{
    const int count = 3 * FXS_SH_COUNT(e->sh_degree);
    double errors[45], most[3] = {0, 0, 0}, sums[3] = {0, 0, 0};
    int32_t codes[45];
    for (int degree = 1; degree <= e->sh_degree; degree++) {
        const int first = 3 * FXS_SH_COUNT(degree - 1), end = 3 * FXS_SH_COUNT(degree);
        const double step = chunk->sh_step_q19[degree - 1] * 0x1p-19;
        fxs_code_coefficients(g->sh + first, end - first, step, codes + first);
        for (int i = first; i < end; i++)
            errors[i] = fabs(codes[i] * step - g->sh[i]);
    }
    for (int i = 0; i < count; i++)
        record[i] = (unsigned char)codes[i];
    for (int i = 0; i < count; i += 3)
        for (int c = 0; c < 3; c++) {
            sums[c] += errors[i + c] * errors[i + c];
            most[c] = errors[i + c] > most[c] ? errors[i + c] : most[c];
        }
    for (int c = 0; c < 3; c++)
        loss->largest[FXS_LOSS_SH] = most[c] > loss->largest[FXS_LOSS_SH] ? most[c] : loss->largest[FXS_LOSS_SH];
    loss->squares[FXS_LOSS_SH] += sums[0] + sums[1] + sums[2];
}

double fxs_gain(int code)
{
    return fxs_scaled(8 + (code & 7), (code >> 3) - 32);
}

/* ---- Records --------------------------------------------------------------------------------------------------- */

static unsigned char *put(unsigned char *to, uint32_t value, int bytes)
{
    for (int i = 0; i < bytes; i++)
        *to++ = (unsigned char)(value >> 8 * i);
    return to;
}

unsigned char *fxs_put_codes(const fxs_encoder *e, const fxs_codes *codes, unsigned char *record)
{
    const uint32_t *p = codes->position, *s = codes->scale, *q = codes->rotation, *c = codes->colour;
    if (e->profile == FXS_PROFILE_SMALL) {
        record = put(record, p[0] | p[1] << 11 | codes->largest << 22 | codes->opacity << 24, 4);
        record = put(record, p[2] | c[0] << 11 | c[1] << 18 | c[2] << 25 | (q[1] >> 5 & 1) << 31, 4);
        record = put(record, s[0] | s[1] << 7 | s[2] << 14 | q[0] << 20 | (q[1] & 31) << 27, 4);
        return put(record, q[2] | (q[1] >> 6) << 7, 1);
    }
    for (int i = 0; i < 3; i++)
        record = put(record, p[i], 2);
    record = put(record, codes->largest << 30 | q[0] << 20 | q[1] << 10 | q[2], 4);
    record = put(record, s[0] | s[1] << 10 | s[2] << 20, 4);
    return put(record, c[0] | c[1] << 8 | c[2] << 16 | codes->opacity << 24, 4);
}

void fxs_encode(const fxs_encoder *e, const fxs_chunk *chunk, const fxs_gaussian *g, double opacity,
                unsigned char record[FXS_RECORD_BYTES], fxs_loss *loss)
{
    fxs_codes codes;
    float scale[3] = {g->scale[0], g->scale[1], g->scale[2]};
    double rotation[4] = {g->rotation[0], g->rotation[1], g->rotation[2], g->rotation[3]};
    if (e->profile == FXS_PROFILE_SMALL)
        put_thinnest_last(scale, rotation);
    for (int i = 0; i < 3; i++) {
        codes.position[i] = encode_position(e, chunk, g, i, loss);
        codes.scale[i] = encode_scale(e, chunk, scale[i], i, loss);
    }
    codes.largest = encode_rotation(e, rotation, codes.rotation, loss);
    encode_colour(e, g, opacity, chunk, &codes, loss);
    record = fxs_put_codes(e, &codes, record);
    if (e->profile == FXS_PROFILE_DEFAULT)
        encode_bands(e, chunk, g, record, loss);
}

/* Bytes `first` to first + width - 1 of each record, side by side. */
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

void fxs_encode_rows(const fxs_encoder *e, const unsigned char *records, unsigned char *rows)
{
    static const unsigned char small[] = {4, 4, 4, 1, 0}, others[] = {2, 2, 2, 4, 4, 4, 0};
    const uint32_t bytes = fxs_chunk_bytes(e->profile, e->sh_degree) / FXS_CHUNK;
    uint32_t first = 0;
    for (const unsigned char *width = e->profile == FXS_PROFILE_SMALL ? small : others; *width; first += *width++)
        rows = put_row(rows, records, bytes, first, *width);
    const uint32_t width = e->profile == FXS_PROFILE_DEFAULT ? 1 : bytes - first;
    for (; first < bytes; first += width)
        rows = put_row(rows, records, bytes, first, width);
}
