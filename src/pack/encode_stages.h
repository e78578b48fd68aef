/* The stages take_ranges and encode of pack_stage.h: small loops that become vectors. */
#include "encode.h"

#define DEGREES 57.29577951308232   /* in a radian */

/* x in low..high, rounded down, for low >= 0; NaN is low. */
static inline int32_t cut_within(double x, int32_t low, int32_t high)
{
    const double held = x > low ? x < high ? x : high : low;
    return (int32_t)held;
}

static inline double larger_of(double x, double y)
{
    return x > y ? x : y;
}

/* ---- Opacities ------------------------------------------------------------------------------------------------- */

/* 4^(1 - law) - 1/255, and 254 / sqrt of it; law 0 has even steps */
static const double opacity_reaches[FXS_OPACITY_LAWS] = {4 - 1 / 255.0, 1 - 1 / 255.0, 0.25 - 1 / 255.0,
                                                         0.0625 - 1 / 255.0};
static const double opacity_scales[FXS_OPACITY_LAWS] = {0, 254.4995088403905, 512.0318092708492, 1049.4574808843379};

/* The nearest codes by each law of an opacity of 1/255 or more, and their opacities less it: 1/255 + (4^(1 - law) -
   1/255) ((code - 1) / 254)^2, or code / 255. */
static inline void encode_by_laws(double opacity, int32_t codes[FXS_OPACITY_LAWS], double errors[FXS_OPACITY_LAWS])
{
    const double root = sqrt(opacity - 1 / 255.0);
    for (uint32_t law = 0; law < FXS_OPACITY_LAWS; law++)
        codes[law] = cut_within(root * opacity_scales[law] + 1, 1, 255);
    for (uint32_t law = 0; law < FXS_OPACITY_LAWS; law++) {
        const int32_t code = codes[law], next = code < 255 ? code + 1 : code;
        const double part = (code - 1) / 254.0, next_part = (next - 1) / 254.0;
        const double below = 1 / 255.0 + opacity_reaches[law] * (part * part) - opacity;
        const double above = 1 / 255.0 + opacity_reaches[law] * (next_part * next_part) - opacity;
        codes[law] = fabs(above) < fabs(below) ? next : code;
        errors[law] = fabs(above) < fabs(below) ? above : below;
    }
    codes[0] = cut_within(opacity * 255 + 0.5, 0, 255);
    errors[0] = codes[0] / 255.0 - opacity;
}

/* An opacity that never reaches 1/255 is not drawn. */
static inline int32_t encode_opacity(double opacity, uint32_t law, double *error)
{
    int32_t codes[FXS_OPACITY_LAWS] = {0};
    double errors[FXS_OPACITY_LAWS] = {-opacity, -opacity, -opacity, -opacity};
    if (opacity >= 1 / 255.0)
        encode_by_laws(opacity, codes, errors);
    else if (law == 0) {
        codes[0] = cut_within(opacity * 255 + 0.5, 0, 255);
        errors[0] = codes[0] / 255.0 - opacity;
    }
    *error = errors[law];
    return codes[law];
}

/* Fainter Gaussians overlap in greater numbers, so the harm of an error is its square over the opacity. */
static inline void weigh_opacity(fxs_chunk_ranges *r, double opacity)
{
    int32_t codes[FXS_OPACITY_LAWS];
    double errors[FXS_OPACITY_LAWS];
    if (!(opacity >= 1 / 255.0))
        return;
    encode_by_laws(opacity, codes, errors);
    for (uint32_t law = 0; law < FXS_OPACITY_LAWS; law++)
        r->opacity_harm[law] += (float)(errors[law] * errors[law] / opacity);
}

/* ---- Ranges ---------------------------------------------------------------------------------------------------- */

static inline void widen(fxs_range *r, float x)
{
    r->low = x < r->low ? x : r->low;
    r->high = x > r->high ? x : r->high;
}

static void NAMED(fxs_pack_take_ranges_, ISA)(fxs_chunk_ranges *r, const fxs_gaussian *g, double opacity,
                                              int sh_degree)
{
    for (int i = 0; i < 3; i++) {
        widen(&r->position[i], g->position[i]);
        widen(&r->scale, (float)(g->scale[i] * FXS_LOG2_E));
        widen(&r->colour[i], (float)fxs_base_colour(g, i));
    }
    weigh_opacity(r, opacity);
    for (int degree = 1; degree <= sh_degree; degree++) {
        const int first = 3 * FXS_SH_COUNT(degree - 1);
        const float most = fxs_largest_coefficient(g->sh + first, 3 * FXS_SH_COUNT(degree) - first);
        r->sh[degree - 1] = most > r->sh[degree - 1] ? most : r->sh[degree - 1];
    }
}

/* ---- Codes ----------------------------------------------------------------------------------------------------- */

/* Notes the errors of three numbers. */
static inline void note_three(fxs_loss *loss, int which, const double errors[3])
{
    if (!FXS_MEASURES_LOSS)
        return;
    loss->largest[which] = larger_of(larger_of(fabs(errors[0]), fabs(errors[1])),
                                     larger_of(fabs(errors[2]), loss->largest[which]));
    loss->squares[which] += errors[0] * errors[0] + errors[1] * errors[1] + errors[2] * errors[2];
}

/* Extends a code to `wide` bits as the renderer does, by repeating its high bits below. */
static inline int32_t spread(int32_t code, int32_t bits, int32_t wide)
{
    return code << (wide - bits) | code >> (2 * bits - wide);
}

/* The three positions, 16 bits, and the three colours, 8 bits; in small 11, and 7, 7, 6. Codes for which low + code
   step is nearest, with the code extended. */
static inline void encode_even(const fxs_encoder *e, const fxs_chunk *chunk, const fxs_gaussian *g, fxs_codes *codes,
                               fxs_loss *loss)
{
    enum { LANES = 8 };
    static const int32_t wides[LANES] = {16, 16, 16, 8, 8, 8, 8, 8};
    static const int32_t widths[2][LANES] = {{16, 16, 16, 8, 8, 8, 8, 8}, {11, 11, 11, 7, 7, 6, 8, 8}};
    const int32_t *bits = widths[e->profile == FXS_PROFILE_SMALL];
    double x[LANES] = {0}, low[LANES] = {0}, step[LANES] = {0}, errors[LANES];
    int32_t found[LANES];
    for (int i = 0; i < 3; i++) {
        x[i] = (double)g->position[i];
        low[i] = (double)chunk->origin_q32[i] * 0x1p-32;
        step[i] = (double)((uint64_t)chunk->step_q32[i] << chunk->step_shift) * 0x1p-32;
        x[3 + i] = fxs_base_colour(g, i);
        low[3 + i] = chunk->colour_q16[i] * 0x1p-16;
        step[3 + i] = chunk->colour_step_q20[i] * 0x1p-20;
    }
    for (int i = 0; i < LANES; i++) {
        const int32_t most = (1 << bits[i]) - 1, widest = (1 << wides[i]) - 1;
        const double own = step[i] * widest / most;    /* exact where both are the same: a step has 32 bits */
        found[i] = cut_within((x[i] - low[i]) / own + 0.5, 0, most);
    }
    for (int i = 0; i < LANES; i++) {
        found[i] = step[i] > 0 ? found[i] : 0;
        errors[i] = low[i] + spread(found[i], bits[i], wides[i]) * step[i] - x[i];
    }
    for (int i = 0; i < 3; i++) {
        codes->position[i] = (uint32_t)found[i];
        codes->colour[i] = (uint32_t)found[3 + i];
    }
    note_three(loss, FXS_LOSS_POSITION, errors);
    note_three(loss, FXS_LOSS_DC, errors + 3);
}

/* The nearest codes with log2(sigma) = high - code^2 step: 10 bits, in small 7, 7 and 6. */
static inline void encode_scales(const fxs_encoder *e, const fxs_chunk *chunk, const float scale[3], uint32_t codes[3],
                                 fxs_loss *loss)
{
    enum { LANES = 4 };
    static const int32_t widths[2][LANES] = {{10, 10, 10, 10}, {7, 7, 6, 6}};
    const int32_t *bits = widths[e->profile == FXS_PROFILE_SMALL];
    const double high = chunk->scale_q16 * 0x1p-16, step = chunk->scale_step_q24 * 0x1p-24;
    double x[LANES], errors[LANES];
    int32_t found[LANES];
    for (int i = 0; i < LANES; i++)
        x[i] = scale[i < 3 ? i : 2] * FXS_LOG2_E;
    for (int i = 0; i < LANES; i++) {
        const int32_t most = (1 << bits[i]) - 1;
        const int32_t root = cut_within(sqrt((high - x[i]) / step) * (most / 1023.0), 0, most);
        const int32_t code = step > 0 && x[i] < high ? root : 0, next = code < most && step > 0 ? code + 1 : code;
        const int32_t wide = spread(code, bits[i], 10), next_wide = spread(next, bits[i], 10);
        const double above = high - wide * wide * step - x[i], below = high - next_wide * next_wide * step - x[i];
        errors[i] = fabs(below) < fabs(above) ? below : above;
        found[i] = fabs(below) < fabs(above) ? next : code;
    }
    for (int i = 0; i < 3; i++)
        codes[i] = (uint32_t)found[i];
    note_three(loss, FXS_LOSS_SCALE, errors);
}

/* Notes the angle 2 acos(|dot|), degrees. acos(x)^2 is at most 2.5 (1 - x), and about 2 (1 - x) near x = 1, so few
   angles must be computed to find the largest. */
static inline void note_angle(fxs_loss *loss, double dot)
{
    double *largest = &loss->largest[FXS_LOSS_ROTATION];
    if (!FXS_MEASURES_LOSS)
        return;
    dot = fabs(dot) < 1 ? fabs(dot) : 1;
    loss->squares[FXS_LOSS_ROTATION] += 8 * DEGREES * DEGREES * (1 - dot);
    if (10 * DEGREES * DEGREES * (1 - dot) > *largest * *largest)
        *largest = larger_of(*largest, 2 * acos(dot) * DEGREES);
}

/* Smallest three: the largest component is left out, the others are in +-1/sqrt(2), 10 bits each, 7 in small. Returns
   the index of the largest. */
static inline uint32_t encode_rotation(const fxs_encoder *e, const double rotation[4], uint32_t codes[3],
                                       fxs_loss *loss)
{
    double q[4], decoded[4], norm = 0, rest = 0, dot = 0;
    int32_t found[4];
    const int32_t bits = e->profile == FXS_PROFILE_SMALL ? 7 : 10, most = (1 << bits) - 1;
    uint32_t largest = 0;
    for (uint32_t i = 0; i < 4; i++) {
        norm += rotation[i] * rotation[i];
        largest = fabs(rotation[i]) > fabs(rotation[largest]) ? i : largest;
    }
    norm = copysign(sqrt(norm), rotation[largest]);
    for (int i = 0; i < 4; i++) {
        q[i] = rotation[i] / norm;
        found[i] = cut_within((q[i] * 1.4142135623730951 + 1) * (most / 2.0) + 0.5, 0, most);
        decoded[i] = (spread(found[i], bits, 10) - 511.5) * (1 / (511.5 * 1.4142135623730951));
    }
    decoded[largest] = 0;
    for (int i = 0; i < 4; i++)
        rest += decoded[i] * decoded[i];
    decoded[largest] = sqrt(larger_of(0, 1 - rest));
    for (int i = 0; i < 4; i++)
        dot += q[i] * decoded[i];
    for (uint32_t i = 0; i < 3; i++)
        codes[i] = (uint32_t)found[i < largest ? i : i + 1];
    note_angle(loss, dot);
    return largest;
}

/* Turns the axes of a Gaussian so that the thinnest is last: a quarter turn about the axis that stays, q (1 + i) or
   q (1 + j), up to a factor. The changed sign of an axis makes no difference. */
static inline void put_thinnest_last(float scale[3], double rotation[4])
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

/* ---- SH -------------------------------------------------------------------------------------------------------- */

enum { BANDS = 48 };

static inline void fill_by_degree(double numbers[BANDS], const double of[3])
{
    for (int i = 0; i < 9; i++)
        numbers[i] = of[0];
    for (int i = 9; i < 24; i++)
        numbers[i] = of[1];
    for (int i = 24; i < BANDS; i++)
        numbers[i] = of[2];
}

/* Notes the sizes of the errors of 48 numbers, which it changes. */
static inline void note_bands(fxs_loss *loss, double errors[BANDS])
{
    double most[BANDS / 2];
    if (!FXS_MEASURES_LOSS)
        return;
    for (int i = 0; i < BANDS / 2; i++)
        most[i] = larger_of(errors[i], errors[BANDS / 2 + i]);
    for (int i = 0; i < BANDS; i++)
        errors[i] *= errors[i];
    for (int i = 0; i < BANDS / 2; i++)
        errors[i] += errors[BANDS / 2 + i];
    for (int left = BANDS / 4; left >= 3; left /= 2)
        for (int i = 0; i < left; i++) {
            most[i] = larger_of(most[i], most[left + i]);
            errors[i] += errors[left + i];
        }
    loss->largest[FXS_LOSS_SH] = larger_of(larger_of(most[0], most[1]), larger_of(most[2], loss->largest[FXS_LOSS_SH]));
    loss->squares[FXS_LOSS_SH] += errors[0] + errors[1] + errors[2];
}

/* Codes SH of profile default: 48 numbers, of which those above the degree are 0. */
static inline void encode_bands(const fxs_encoder *e, const fxs_chunk *chunk, const fxs_gaussian *g,
                                unsigned char *record, fxs_loss *loss)
{
    const int count = 3 * FXS_SH_COUNT(e->sh_degree);
    float x[BANDS] = {0};
    double steps[BANDS], inverses[BANDS], own[3], errors[BANDS];
    signed char codes[BANDS];
    memcpy(x, g->sh, (size_t)count * sizeof *x);
    for (int k = 0; k < 3; k++)
        own[k] = chunk->sh_step_q19[k] * 0x1p-19;
    fill_by_degree(steps, own);
    for (int k = 0; k < 3; k++)
        own[k] = own[k] > 0 ? 1 / own[k] : 0;
    fill_by_degree(inverses, own);
    for (int i = 0; i < BANDS; i++) {
        const int32_t code = fxs_coefficient_code((double)x[i], steps[i], inverses[i]);
        codes[i] = (signed char)code;
        errors[i] = fabs(code * steps[i] - (double)x[i]);
    }
    memcpy(record, codes, (size_t)count);
    note_bands(loss, errors);
}

static void NAMED(fxs_pack_encode_, ISA)(const fxs_encoder *e, const fxs_chunk *chunk, const fxs_gaussian *g,
                                         double opacity, unsigned char record[FXS_RECORD_BYTES], fxs_loss *loss)
{
    fxs_codes codes;
    float scale[3] = {g->scale[0], g->scale[1], g->scale[2]};
    double rotation[4] = {g->rotation[0], g->rotation[1], g->rotation[2], g->rotation[3]}, error;
    if (e->profile == FXS_PROFILE_SMALL)
        put_thinnest_last(scale, rotation);
    encode_even(e, chunk, g, &codes, loss);
    encode_scales(e, chunk, scale, codes.scale, loss);
    codes.largest = encode_rotation(e, rotation, codes.rotation, loss);
    codes.opacity = (uint32_t)encode_opacity(opacity, chunk->opacity_law, &error);
    loss->largest[FXS_LOSS_OPACITY] = larger_of(fabs(error), loss->largest[FXS_LOSS_OPACITY]);
    loss->squares[FXS_LOSS_OPACITY] += error * error;
    record = fxs_put_codes(e, &codes, record);
    if (e->profile == FXS_PROFILE_DEFAULT)
        encode_bands(e, chunk, g, record, loss);
}
