/* Quantises the attributes of a Gaussian to codes. The loops are small, so that the compiler vectorises them. */
#include "encode.h"
#include "src/gaussian/tilt.h"

#define DEGREES 57.29577951308232

static inline int32_t cut_within(double x, int32_t low, int32_t high)
{
    const double held = x > low ? x < high ? x : high : low;
    return (int32_t)held;
}

static inline double larger_of(double x, double y)
{
    return x > y ? x : y;
}

/* Four laws quantise opacity. Law 0 has even steps. For the other laws, the tables hold reach = 4^(1 - law) - 1/255 and
   scale = 254 / sqrt(reach). */
static const double opacity_reaches[FXS_OPACITY_LAWS] = {4 - 1 / 255.0, 1 - 1 / 255.0, 0.25 - 1 / 255.0,
                                                         0.0625 - 1 / 255.0};
static const double opacity_scales[FXS_OPACITY_LAWS] = {0, 254.4995088403905, 512.0318092708492, 1049.4574808843379};

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

/* Adds the harm of coding an opacity by each of the four quantisation laws. Harm is squared error / opacity, because
   fainter Gaussians overlap in greater numbers. */
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

static inline void note_three(fxs_loss *loss, int which, const double errors[3])
{
    if (!FXS_MEASURES_LOSS)
        return;
    loss->largest[which] = larger_of(larger_of(fabs(errors[0]), fabs(errors[1])),
                                     larger_of(fabs(errors[2]), loss->largest[which]));
    loss->squares[which] += errors[0] * errors[0] + errors[1] * errors[1] + errors[2] * errors[2];
}

static inline int32_t spread(int32_t code, int32_t bits, int32_t wide)
{
    return code << (wide - bits) | code >> (2 * bits - wide);
}

/* Codes a Gaussian's position (16 bits per axis) and base colour (9 bits per channel). File profile small uses 11 bits
   per axis and 7, 7, 6 bits for red, green, blue. */
static inline void encode_even(const fxs_encoder *e, const fxs_chunk *chunk, const fxs_gaussian *g,
                               fxs_row_codes *codes, fxs_loss *loss)
{
    enum { LANES = 8 };
    static const int32_t wides[LANES] = {16, 16, 16, 9, 9, 9, 9, 9};
    static const int32_t widths[2][LANES] = {{16, 16, 16, 9, 9, 9, 9, 9}, {11, 11, 11, 7, 7, 6, 9, 9}};
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
        const double own = step[i] * widest / most;
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

static inline int32_t spread_scale(int32_t code, int32_t bits, int i)
{
    return i < 2 ? spread(code, bits, 10) : 2 * spread(code, bits, 9);
}

/* Finds the nearest scale codes of a Gaussian for log2(sigma) = high - code^2 * step. The three axes have 10, 10, 9
   bits, in file profile small 7, 7, 6 bits. */
static inline void encode_scales(const fxs_encoder *e, const fxs_chunk *chunk, const float scale[3], uint32_t codes[3],
                                 fxs_loss *loss)
{
    enum { LANES = 4 };
    static const int32_t widths[2][LANES] = {{10, 10, 9, 9}, {7, 7, 6, 6}};
    const int32_t *bits = widths[e->profile == FXS_PROFILE_SMALL];
    const double high = chunk->scale_q16 * 0x1p-16, step = chunk->scale_step_q24 * 0x1p-24;
    double x[LANES], errors[LANES];
    int32_t found[LANES];
    for (int i = 0; i < LANES; i++)
        x[i] = scale[i < 3 ? i : 2] * FXS_LOG2_E;
    for (int i = 0; i < LANES; i++) {
        const int32_t most = (1 << bits[i]) - 1;
        const int32_t root = cut_within(sqrt((high - x[i]) / step) * (most / (i < 2 ? 1023.0 : 1022.0)), 0, most);
        const int32_t code = step > 0 && x[i] < high ? root : 0, next = code < most && step > 0 ? code + 1 : code;
        const int32_t wide = spread_scale(code, bits[i], i), next_wide = spread_scale(next, bits[i], i);
        const double above = high - wide * wide * step - x[i], below = high - next_wide * next_wide * step - x[i];
        errors[i] = fabs(below) < fabs(above) ? below : above;
        found[i] = fabs(below) < fabs(above) ? next : code;
    }
    for (int i = 0; i < 3; i++)
        codes[i] = (uint32_t)found[i];
    note_three(loss, FXS_LOSS_SCALE, errors);
}

/* Adds a rotation error, given as a cosine, to the losses. acos(x)^2 is at most 2.5 (1 - x), so acos is called only for
   a possible new maximum. */
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

/* Returns the roll of a Gaussian about its first axis, -1 to 1. With this roll, the second axis is parallel to cosine
   side[0] + sine side[1]. */
static inline double roll_of(double cosine, double sine)
{
    const double sign = cosine < 0 ? -1 : 1, length = sqrt(cosine * cosine + sine * sine);
    const double c = sign * cosine / length, s = sign * sine / length;
    double roll = s / (c + fabs(s));
    for (int i = 0; i < 3; i++) {
        double said_c, said_s;
        fxs_tilt_roll(roll, &said_c, &said_s);
        roll += (s * said_c - c * said_s) * 0.6366197723675814;   /* 2 / pi converts an angle to roll */
    }
    return roll;
}

/* Returns the code of `bits` bits nearest to x, for -1 <= x <= 1. `below` is the fraction of a code step that the lower
   bits of the rotation word add. */
static inline int32_t code_around(double x, int32_t bits, double below)
{
    const int32_t half = 1 << (bits - 1);
    const int32_t code = cut_within(x * half - below + half + 0.5, 0, 2 * half - 1);
    return code - half;
}

static inline double part_of(int32_t code, int32_t bits, double below)
{
    const int32_t number = 1 << bits;
    return ((double)(code & (number - 1)) + below) / number;
}

static inline int is_too_long(uint32_t word, int32_t bits)
{
    const int32_t x_q15 = (int32_t)word >> 16, y_q15 = (int32_t)(word << bits) >> 16;
    return x_q15 * x_q15 + y_q15 * y_q15 > 1 << 30;
}

/* Codes the axes of a Gaussian to a rotation word. The roll is relative to the coded first axis, so a second round
   starts from the decoded result of the first round. */
static inline uint32_t encode_axes(double axis[3][3], int32_t bits, int32_t all)
{
    const double sign = axis[0][2] < 0 ? -1 : 1, length = sqrt(1 + fabs(axis[0][2]));
    const double x = sign * axis[0][0] / length, y = sign * axis[0][1] / length;
    const int32_t roll_bits = all - 2 * bits;
    fxs_tilt said = {x, y, 0};
    uint32_t word = 0;
    for (int round = 0; round < 2; round++) {
        double first[3], side[2][3], along[2];
        fxs_tilt_sides(&said, first, side);
        for (int i = 0; i < 2; i++)
            along[i] = axis[1][0] * side[i][0] + axis[1][1] * side[i][1] + axis[1][2] * side[i][2];
        const double roll = roll_of(along[0], along[1]), half = (double)(1 << (roll_bits - 1));
        const int32_t roll_code = cut_within((roll + 1) * half + 0.5, 0, 1 << roll_bits) - (1 << (roll_bits - 1));
        const double below_y = part_of(roll_code, roll_bits, 0);
        int32_t y_code = code_around(y, bits, below_y);
        int32_t x_code = code_around(x, bits, part_of(y_code, bits, below_y));
        for (int again = 0; again < 4; again++) {
            word = fxs_tilt_word((uint32_t)x_code, (uint32_t)y_code, (uint32_t)roll_code, bits, all);
            if (!is_too_long(word, bits))
                break;
            if (fabs(x) > fabs(y))
                x_code += x > 0 ? -1 : 1;
            else
                y_code += y > 0 ? -1 : 1;
        }
        said = fxs_tilt_of_word(word, bits);
    }
    return word;
}

static inline void order_axes(float scale[3], double axis[3][3])
{
    for (int i = 0; i < 3; i++) {
        const int k = i == 2 ? 0 : i;
        if (!(scale[k] < scale[k + 1]))
            continue;
        const float length = scale[k];
        scale[k] = scale[k + 1];
        scale[k + 1] = length;
        for (int d = 0; d < 3; d++) {
            const double direction = axis[k][d];
            axis[k][d] = axis[k + 1][d];
            axis[k + 1][d] = direction;
        }
    }
}

/* Returns the cosine of half the angle between a Gaussian's axes and the axes decoded from `word`. Opposite directions
   of an axis count as equal. */
static inline double half_angle_cosine(double axis[3][3], uint32_t word, int32_t bits)
{
    const fxs_tilt a = fxs_tilt_of_word(word, bits);
    double said[3][3], trace = 0;
    fxs_tilt_directions(&a, said);
    for (int i = 0; i < 3; i++) {
        const double *s = said[i], length = sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
        trace += fabs(axis[i][0] * s[0] + axis[i][1] * s[1] + axis[i][2] * s[2]) / length;
    }
    return sqrt(1 + trace) / 2;
}

/* Codes the rotation of a Gaussian to a word. The scale codes determine the number of bits per field of the word. */
static inline uint32_t encode_rotation(const fxs_encoder *e, const fxs_chunk *chunk, double axis[3][3],
                                       const uint32_t scale[3], fxs_loss *loss)
{
    const int small = e->profile == FXS_PROFILE_SMALL;
    const int32_t own[3] = {small ? 7 : 10, small ? 7 : 10, small ? 6 : 9};
    int32_t fall_q16[3];
    for (int i = 0; i < 3; i++)
        fall_q16[i] = fxs_fall_q16((uint32_t)spread_scale((int32_t)scale[i], own[i], i), chunk->scale_step_q24);
    const int32_t bits = fxs_axis_bits(e->profile, fall_q16);
    const uint32_t word = encode_axes(axis, bits, FXS_ROTATION_BITS(e->profile));
    note_angle(loss, half_angle_cosine(axis, word, bits));
    return word;
}

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
    fxs_row_codes codes;
    float scale[3] = {g->scale[0], g->scale[1], g->scale[2]};
    double rows[3][3], axis[3][3], error;
    fxs_rotation_matrix(rows, g->rotation[0], g->rotation[1], g->rotation[2], g->rotation[3]);
    for (int i = 0; i < 9; i++)
        axis[i % 3][i / 3] = rows[i / 3][i % 3];
    order_axes(scale, axis);
    encode_even(e, chunk, g, &codes, loss);
    encode_scales(e, chunk, scale, codes.scale, loss);
    codes.opacity = (uint32_t)encode_opacity(opacity, chunk->opacity_law, &error);
    codes.rotation = encode_rotation(e, chunk, axis, codes.scale, loss);
    codes.rotation |= !codes.rotation && !codes.opacity ? FXS_NOT_EMPTY : 0;
    loss->largest[FXS_LOSS_OPACITY] = larger_of(fabs(error), loss->largest[FXS_LOSS_OPACITY]);
    loss->squares[FXS_LOSS_OPACITY] += error * error;
    record = fxs_put_codes(e, &codes, record);
    if (e->profile == FXS_PROFILE_DEFAULT)
        encode_bands(e, chunk, g, record, loss);
}
