/* Inner loops of packing for the instruction set ISA. The includer defines find_dots, the dot products of a vector with
 * GROUP vectors. The includer also defines find_leasts, which finds the `wanted` smallest costs in ascending order of
 * cost and index. find_leasts may change the costs; when all costs are taken, it returns index 0. */
#include "pack_stage.h"

#include <math.h>

#define JOIN(a, b) a##b
#define NAMED(a, b) JOIN(a, b)
#define STRING(a) #a
#define STRING_OF(a) STRING(a)

#include "encode_stages.h"

#ifdef FXS_TO_PACK
#define COARSEN NULL
#else
#define COARSEN NAMED(fxs_coarsen_, ISA)
FXS_COARSEN(ISA);
#endif

enum {
    ENTRIES = FXS_PALETTE_ENTRIES, WIDTH = FXS_PALETTE_STRIDE, STAGES = FXS_PALETTE_STAGES,
    GROUPS = FXS_PALETTE_GROUPS, GROUP = FXS_PALETTE_GROUP,
    BEAM = 2,                  /* number of partial sums kept after each stage of the beam search for palette entries */
    TRIED = 3,
    WINDOW = 48                 /* largest number of earlier Gaussians that diffuse their coding errors to a Gaussian */
};

/* Replaces eight numbers x by e^x. |x| is at most 700, so that powers of two are not subnormal. */
static inline void find_exponentials(double x[8])
{
    for (int i = 0; i < 8; i++) {
        int exponent;
        const double series = fxs_exp_series(x[i], &exponent);
        x[i] = series * fxs_power_of_two(exponent);
    }
}

static void NAMED(fxs_pack_exponentials_, ISA)(double *x, uint32_t count)
{
    uint32_t i = 0;
    for (; i + 8 <= count; i += 8) {
        int within = 1;
        for (uint32_t k = 0; k < 8; k++)
            within &= fabs(x[i + k]) <= 700;
        if (within)
            find_exponentials(x + i);
        for (uint32_t k = 0; k < 8 && !within; k++)
            x[i + k] = fxs_exp(x[i + k]);
    }
    for (; i < count; i++)
        x[i] = fxs_exp(x[i]);
}

typedef struct candidate {
    fxs_sh_vector left;            /* SH vector minus the sum of the palette entries chosen so far */
    int32_t cost;                  /* change of the squared error, relative to no palette entries */
    uint8_t indices[STAGES];
} candidate;

/* Computes the costs after adding each palette entry to a sum. An entry with the better sign changes the cost by
   |entry|^2 - 2 |dot(left, entry)|. */
static inline void find_costs(int32_t costs[GROUP], int32_t dots[GROUP], int32_t cost, const fxs_sh_vector left,
                              const fxs_sh_vector *vectors, const int32_t *squares)
{
    find_dots(dots, left, vectors);
    for (int j = 0; j < GROUP; j++)
        costs[j] = cost + squares[j] - 2 * absolute(dots[j]);
}

static inline void try_groups(int32_t costs[TRIED * GROUP], int32_t dots[TRIED * GROUP], uint32_t groups[TRIED],
                              const candidate *from, const fxs_palette *p, uint32_t stage)
{
    int32_t all[GROUPS], products[GROUP];
    fxs_pack_place nearest[TRIED];
    for (uint32_t g = 0; g < GROUPS; g += GROUP)
        find_costs(all + g, products, 0, from->left, p->groups[stage] + g, p->group_squares[stage] + g);
    for (uint32_t g = groups_of(p); g < GROUPS; g++)
        all[g] = INT32_MAX;
    find_leasts(all, GROUPS, nearest, TRIED);
    for (uint32_t g = 0; g < TRIED; g++) {
        groups[g] = nearest[g].place;
        find_costs(costs + g * GROUP, dots + g * GROUP, from->cost, from->left, p->vectors[stage] + groups[g] * GROUP,
                   p->squares[stage] + groups[g] * GROUP);
    }
}

static inline uint32_t extend(candidate to[BEAM], const candidate from[BEAM], uint32_t count, const fxs_palette *p,
                              uint32_t stage)
{
    enum { KEYS = BEAM * TRIED * GROUP };
    int32_t costs[KEYS], dots[KEYS];
    uint32_t groups[BEAM * TRIED];
    fxs_pack_place found[BEAM];
    for (uint32_t i = 0; i < count; i++)
        try_groups(costs + i * TRIED * GROUP, dots + i * TRIED * GROUP, groups + i * TRIED, &from[i], p, stage);
    for (uint32_t i = count * TRIED * GROUP; i < KEYS; i++)
        costs[i] = INT32_MAX;
    find_leasts(costs, KEYS, found, BEAM);
    for (uint32_t i = 0; i < BEAM; i++) {
        const uint32_t best = found[i].place;
        const candidate *parent = &from[best / (TRIED * GROUP)];
        const uint32_t j = groups[best / GROUP] * GROUP + best % GROUP;
        const uint32_t index = j | (dots[best] < 0 ? FXS_PALETTE_NEGATIVE : 0);
        to[i] = *parent;
        to[i].cost = found[i].cost;
        to[i].indices[stage] = (uint8_t)index;
        subtract_entry(to[i].left, p, stage, index);
    }
    return BEAM;
}

/* Improves the chosen palette entries. Each stage in turn takes the entry nearest to the SH vector minus the entries of
   all other stages (iterated conditional modes, Besag 1986). */
static inline void settle(candidate *sum, const fxs_palette *p)
{
    enum { KEYS = BEAM * TRIED * GROUP };
    for (uint32_t stage = 0; stage < p->stages; stage++) {
        int32_t costs[KEYS], dots[TRIED * GROUP];
        uint32_t groups[TRIED];
        fxs_pack_place found;
        candidate others = *sum;
        others.cost = 0;
        subtract_entry(others.left, p, stage, sum->indices[stage] ^ FXS_PALETTE_NEGATIVE);
        try_groups(costs, dots, groups, &others, p, stage);
        for (uint32_t i = TRIED * GROUP; i < KEYS; i++)
            costs[i] = INT32_MAX;
        find_leasts(costs, KEYS, &found, 1);
        if (found.cost >= dot(sum->left, sum->left) - dot(others.left, others.left))
            continue;
        const uint32_t j = groups[found.place / GROUP] * GROUP + found.place % GROUP;
        others.indices[stage] = (uint8_t)(j | (dots[found.place] < 0 ? FXS_PALETTE_NEGATIVE : 0));
        subtract_entry(others.left, p, stage, others.indices[stage]);
        *sum = others;
    }
}

static void NAMED(fxs_pack_find_, ISA)(const fxs_palette *p, fxs_sh_vector vector, uint8_t indices[STAGES])
{
    candidate sums[2][BEAM] = {{{{0}, 0, {0}}}};
    uint32_t count = 1;
    memcpy(sums[0][0].left, vector, sizeof sums[0][0].left);
    for (uint32_t stage = 0; stage < p->stages; stage++)
        count = extend(sums[(stage + 1) & 1], sums[stage & 1], count, p, stage);
    candidate *best = &sums[p->stages & 1][0];
    settle(best, p);
    memcpy(indices, best->indices, STAGES);
    memcpy(vector, best->left, sizeof(fxs_sh_vector));
}

static uint32_t NAMED(fxs_pack_nearest_, ISA)(const fxs_sh_vector *vectors, const int32_t *squares, uint32_t count,
                                              const fxs_sh_vector vector)
{
    int32_t costs[GROUPS], dots[GROUPS];
    fxs_pack_place found;
    const uint32_t whole = count > GROUP ? GROUPS : GROUP;
    for (uint32_t j = 0; j < whole; j += GROUP)
        find_costs(costs + j, dots + j, 0, vector, vectors + j, squares + j);
    for (uint32_t j = count; j < whole; j++)
        costs[j] = INT32_MAX;
    find_leasts(costs, whole, &found, 1);
    return found.place | (dots[found.place] < 0 ? FXS_PALETTE_NEGATIVE : 0);
}

enum { NUMBERS = 48 };

/* Quantises x to 8 levels: returns floor(x / (2 gain) + 4) clamped to 0..7, for |x| at most 16 gain. A quotient is an
   integer or at least 2^-13.2 below the next integer. Floats err by at most 2^-20, so adding 2^-14 rounds every
   quotient correctly. */
static inline int32_t eighth_of(float x, float half_inverse)
{
    const float eighths = x * half_inverse + (4 + 0x1p-14f), above = eighths > 0 ? eighths : 0;
    return (int32_t)(above < 7 ? above : 7);
}

/* Returns the sum of squared errors when each number is rounded to the nearest odd multiple of the gain, from -7 to
   7. */
static inline double sum_of_errors(const float numbers[NUMBERS], float gain)
{
    const float half_inverse = 0.5f / gain;
    float errors[NUMBERS];
    double squares[NUMBERS];
    for (int i = 0; i < NUMBERS; i++)
        errors[i] = (float)(2 * eighth_of(numbers[i], half_inverse) - 7) * gain - numbers[i];
    for (int i = 0; i < NUMBERS; i++)
        squares[i] = (double)errors[i] * (double)errors[i];
    for (int left = NUMBERS / 2; left >= 6; left /= 2)
        for (int i = 0; i < left; i++)
            squares[i] += squares[left + i];
    return squares[0] + squares[1] + squares[2] + (squares[3] + squares[4] + squares[5]);
}

/* Searches the gain (unit of the 3-bit codes) with the smallest squared error. The gain is at most 1.5 octaves below
   the smallest gain that clips no number. */
static inline float find_gain(const float numbers[NUMBERS], int count, int unit_exponent, int *code)
{
    const float unit = (float)fxs_scaled(1, unit_exponent);
    float most = 0, best = 0;
    double least = INFINITY;
    int first = 0;
    for (int i = 0; i < NUMBERS; i++)
        most = fabsf(numbers[i]) > most ? fabsf(numbers[i]) : most;
    while (first < 248 && 8 * (float)fxs_gain(first + 7) * unit < most)
        first += 8;
    while (first < 255 && 8 * (float)fxs_gain(first) * unit < most)
        first++;
    for (int tried = first; tried >= 0 && tried > first - 12; tried--) {
        const float gain = (float)fxs_gain(tried) * unit;
        const double sum = sum_of_errors(numbers, gain) - (NUMBERS - count) * ((double)gain * (double)gain);
        *code = sum < least ? tried : *code;
        best = sum < least ? gain : best;
        least = sum < least ? sum : least;
    }
    return best;
}

/* Writes 3-bit codes of `rest`, an SH vector minus its palette entries. Then `rest` becomes the error of the codes. */
static inline void encode_rest(fxs_sh_vector rest, int count, int unit_exponent, unsigned char *record)
{
    float numbers[NUMBERS] = {0};
    int code = 0;
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < count; k++)
            numbers[c * count + k] = rest[16 * c + k];
    const float gain = find_gain(numbers, 3 * count, unit_exponent, &code), half_inverse = 0.5f / gain;
    uint32_t bit = FXS_RESIDUAL_BIT;
    record[FXS_GAIN_BYTE] = (unsigned char)code;
    for (int c = 0; c < 3; c++, bit += 3 * (uint32_t)count) {
        uint64_t bits = 0;
        for (int k = 0; k < count; k++) {
            const int32_t eighth = eighth_of(numbers[c * count + k], half_inverse);
            bits |= (uint64_t)((eighth - 4) & 7) << 3 * k;
            rest[16 * c + k] = (int16_t)((float)rest[16 * c + k] - (float)(2 * eighth - 7) * gain);
        }
        bits <<= bit % 8;
        for (unsigned char *to = record + bit / 8; bits; bits >>= 8)
            *to++ |= (unsigned char)bits;
    }
}

/* Returns the overlap of two Gaussians relative to Gaussian `to`, Q8, 0 to 1024. For round Gaussians of areas a and
   b at distance d, the overlap is 2 a / (a + b) exp(-d^2 / (2 (a + b))), times the ratio of opacities. (1 - d^2 /
   (8 (a + b)))^4 approximates the exponential. */
static inline int16_t overlap_q8(const fxs_sh_item *from, double from_area, const fxs_sh_item *to, double to_area,
                                 double square)
{
    const double both = from_area + to_area;
    const double t = 1 - square / (8 * both), tail = (t * t) * (t * t);
    const double overlap = 2 * from_area / both * tail * from->opacity / to->opacity;
    /* the margin 2^-20 makes 4/3 times 3 give 4 in any float precision */
    return (int16_t)(256 * (overlap < 4 ? overlap : 4) + 0x1p-20);
}

static inline double area_of(const fxs_sh_item *item)
{
    static const double eighths[8] = {1, 1.0905077326652577, 1.189207115002721, 1.2968395546510096, 1.4142135623730951,
                                      1.5422108254079408, 1.681792830507429, 1.8340080864093424};
    return fxs_scaled(eighths[item->area & 7], (item->area - (item->area & 7)) / 8);
}

typedef struct coder {
    const fxs_palette *palette;
    const fxs_sh_item *items;
    fxs_sh_vector vectors[FXS_CHUNK];
    double places[3][FXS_CHUNK], areas[FXS_CHUNK];
    fxs_sh_vector errors[FXS_CHUNK];   /* original minus coded SH coefficients of each Gaussian, in palette units */
} coder;

/* Adds half the coding errors of earlier overlapping Gaussians to an SH vector. The added vector is at most as long as
   the SH vector. */
static inline void add_errors(const coder *c, uint32_t i, fxs_sh_vector vector)
{
    const uint32_t first = i > WINDOW ? i - WINDOW : 0;
    int32_t sums_q8[WIDTH] = {0};
    int16_t shift[WIDTH];
    double squares[WINDOW];
    for (uint32_t j = first; j < i; j++) {
        const double x = c->places[0][j] - c->places[0][i], y = c->places[1][j] - c->places[1][i];
        const double z = c->places[2][j] - c->places[2][i];
        squares[j - first] = x * x + y * y + z * z;
    }
    for (uint32_t j = first; j < i; j++) {
        if (!(c->items[j].opacity && squares[j - first] < 8 * (c->areas[j] + c->areas[i])))
            continue;
        const int16_t q8 = overlap_q8(&c->items[j], c->areas[j], &c->items[i], c->areas[i], squares[j - first]);
        for (int d = 0; d < WIDTH && q8 > 8; d++)
            sums_q8[d] += q8 * c->errors[j][d];
    }
    for (int d = 0; d < WIDTH; d++)
        shift[d] = hold(sums_q8[d] / 512);
    const int32_t own = dot(vector, vector), other = dot(shift, shift);
    const int32_t part_q8 = other > own ? (int32_t)(256 * sqrt((double)own / other)) : 256;
    for (int d = 0; d < WIDTH; d++)
        vector[d] = hold(vector[d] + shift[d] * part_q8 / 256);
}

/* Adds the coding error of a Gaussian's SH coefficients to `loss`. Each colour channel has its own sum of errors, so
   that additions overlap in the pipeline. */
static inline void note(fxs_sh_loss *loss, const fxs_palette *p, const fxs_sh_item *item, const fxs_sh_vector coded)
{
    const double unit = ldexp(1, -p->unit_exponent), step = (double)item->step;
    const int count = FXS_SH_COUNT(p->sh_degree);
    double errors[45], most[3] = {0, 0, 0}, sums[3] = {0, 0, 0};
    if (!FXS_MEASURES_LOSS)
        return;
    for (int k = 0; k < count; k++)
        for (int c = 0; c < 3; c++)
            errors[3 * k + c] = fabs(item->codes[3 * k + c] * step - coded[16 * c + k] * unit);
    for (int k = 0; k < count; k++)
        for (int c = 0; c < 3; c++) {
            most[c] = errors[3 * k + c] > most[c] ? errors[3 * k + c] : most[c];
            sums[c] += errors[3 * k + c] * errors[3 * k + c];
        }
    for (int c = 0; c < 3; c++)
        loss->largest = most[c] > loss->largest ? most[c] : loss->largest;
    loss->squares += sums[0] + sums[1] + sums[2];
}

static inline void code_one(coder *c, uint32_t i, const fxs_sh_vector mean, unsigned char *record, fxs_sh_loss *loss)
{
    const fxs_palette *p = c->palette;
    uint8_t indices[STAGES];
    fxs_sh_vector wanted, left;
    memcpy(wanted, c->vectors[i], sizeof wanted);
    subtract(wanted, mean);
    memcpy(left, wanted, sizeof left);
    if (c->items[i].opacity)
        add_errors(c, i, left);
    memcpy(c->errors[i], wanted, sizeof wanted);
    subtract(c->errors[i], left);
    NAMED(fxs_pack_find_, ISA)(p, left, indices);
    memset(record, 0, fxs_sh_bytes(p->profile, p->sh_degree));
    memcpy(record, indices, p->stages);
    if (p->profile == FXS_PROFILE_COMPACT)
        encode_rest(left, FXS_SH_COUNT(p->sh_degree), p->unit_exponent, record);
    for (int d = 0; d < WIDTH; d++) {
        c->errors[i][d] = (int16_t)(c->errors[i][d] + left[d]);
        wanted[d] = (int16_t)(wanted[d] + mean[d] - c->errors[i][d]);
    }
    note(loss, p, &c->items[i], wanted);
}

static void NAMED(fxs_pack_code_chunk_, ISA)(const fxs_palette *p, const fxs_sh_item *items, uint32_t count,
                                             int8_t mean[48], unsigned char *records, size_t stride, fxs_sh_loss *loss)
{
    coder c;
    fxs_sh_vector middle;
    c.palette = p;
    c.items = items;
    for (uint32_t i = 0; i < count; i++)
        vector_of(c.vectors[i], &items[i], p->unit_exponent);
    find_mean(middle, c.vectors, items, p->centred ? count : 0);
    for (int d = 0; d < WIDTH; d++) {
        mean[d] = (int8_t)code_of(middle[d], p->step);
        middle[d] = (int16_t)(mean[d] * p->step);
    }
    for (uint32_t i = 0; i < count; i++)
        c.areas[i] = area_of(&items[i]);
    for (int k = 0; k < 3; k++)
        for (uint32_t i = 0; i < count; i++)
            c.places[k][i] = (double)items[i].position[k];
    for (uint32_t i = 0; i < count; i++)
        code_one(&c, i, middle, records + i * stride, loss);
}

const fxs_pack_stages NAMED(fxs_pack_stages_, ISA) = {
    STRING_OF(ISA), NAMED(fxs_pack_exponentials_, ISA), NAMED(fxs_pack_take_ranges_, ISA), NAMED(fxs_pack_encode_, ISA),
    NAMED(fxs_pack_find_, ISA), NAMED(fxs_pack_nearest_, ISA), COARSEN,
    NAMED(fxs_pack_code_chunk_, ISA)};
