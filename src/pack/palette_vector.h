/* Arithmetic on vectors of SH coefficients, shared by learning and coding of palettes. */
#ifndef FXS_PALETTE_VECTOR_H
#define FXS_PALETTE_VECTOR_H

#include <string.h>

#include "palette.h"
#include "src/base/exponential.h"

enum {
    /* largest SH coefficient in palette units; sums of 7 vectors fit 16 bits, their dot products 32 bits */
    FXS_PALETTE_MOST = 1270,
    FXS_PALETTE_GROUP = 8,
    FXS_PALETTE_WIDTH = (int)FXS_PALETTE_STRIDE
};

typedef struct fxs_pack_place {
    int32_t cost;
    uint32_t place;
} fxs_pack_place;

static inline int16_t hold(int32_t x)
{
    return (int16_t)(x > -FXS_PALETTE_MOST ? x < FXS_PALETTE_MOST ? x : FXS_PALETTE_MOST : -FXS_PALETTE_MOST);
}

static inline int32_t absolute(int32_t x)
{
    return x < 0 ? -x : x;
}

static inline void vector_of(fxs_sh_vector vector, const fxs_sh_item *item, int unit_exponent)
{
    const double wanted_q12 = fxs_scaled(item->step, unit_exponent + 12);
    const int32_t step_q12 = wanted_q12 < FXS_PALETTE_MOST << 12 ? (int32_t)wanted_q12 : FXS_PALETTE_MOST << 12;
    int16_t held[45];
    for (int i = 0; i < 45; i++)
        held[i] = hold((item->codes[i] * step_q12 + 2048) >> 12);
    memset(vector, 0, sizeof(fxs_sh_vector));
    for (int k = 0; k < 15; k++)
        for (int c = 0; c < 3; c++)
            vector[16 * c + k] = held[3 * k + c];
}

static inline void subtract(fxs_sh_vector vector, const fxs_sh_vector from)
{
    for (int d = 0; d < FXS_PALETTE_WIDTH; d++)
        vector[d] = (int16_t)(vector[d] - from[d]);
}

static inline void subtract_entry(fxs_sh_vector vector, const fxs_palette *p, uint32_t stage, uint32_t index)
{
    const int16_t *entry = p->vectors[stage][index % FXS_PALETTE_ENTRIES];
    const int16_t sign = index & FXS_PALETTE_NEGATIVE ? -1 : 1;
    for (int d = 0; d < FXS_PALETTE_WIDTH; d++)
        vector[d] = (int16_t)(vector[d] - sign * entry[d]);
}

static inline int32_t dot(const int16_t *restrict a, const int16_t *restrict b)
{
    int32_t sum = 0;
#if defined(__GNUC__)
#pragma GCC unroll 6
#endif
    for (int d = 0; d < FXS_PALETTE_WIDTH; d++)
        sum += a[d] * b[d];
    return sum;
}

static inline uint32_t groups_of(const fxs_palette *p)
{
    return (p->entries + FXS_PALETTE_GROUP - 1) / FXS_PALETTE_GROUP;
}

static inline void find_mean(fxs_sh_vector mean, fxs_sh_vector *vectors, const fxs_sh_item *items, uint32_t count)
{
    int32_t sums[FXS_PALETTE_STRIDE] = {0}, weight = 0;
    for (uint32_t i = 0; i < count; i++) {
        const int16_t own = items[i].opacity;
        for (int d = 0; d < FXS_PALETTE_WIDTH; d++)
            sums[d] += vectors[i][d] * own;
        weight += own;
    }
    for (int d = 0; d < FXS_PALETTE_WIDTH; d++)
        mean[d] = (int16_t)(weight ? sums[d] / weight : 0);
}

/* Returns the code of an SH coefficient: round(x / step), clamped to +-127. */
static inline int32_t code_of(int32_t x, int32_t step)
{
    const int32_t code = (2 * absolute(x) + step) / (2 * step), held = code < 127 ? code : 127;
    return x < 0 ? -held : held;
}

#endif
