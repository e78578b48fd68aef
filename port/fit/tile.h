/* blend and back: what the splats of a list do to the pixels of a tile, and back. */
#ifndef FXS_FIT_TILE_H
#define FXS_FIT_TILE_H

#include "lanes.h"
#include "stage.h"

/* Rows of the tile that the splat's ellipse may touch. */
static inline void rows_of(const fxs_fit_splat *s, float top, int32_t *first, int32_t *end)
{
    const float low = s->centre[1] - s->half[1] - top, high = s->centre[1] + s->half[1] - top;
    *first = low > 0 ? (int32_t)low : 0;
    *end = high < 15 ? (int32_t)(high + 1) : 16;
}

/* exp(-level / 2) */
static inline real alpha_of(real level)
{
    return exp_2(level * -0.72134752f);
}

static inline void blend_row(const fxs_fit_splat *s, fxs_fit_tile *tile, int32_t at, real u, float row_level)
{
    const real t = load(tile->transmittance + at), level = u * u + row_level;
    const whole takes = (level <= s->limit) & (t >= FXS_FIT_CLOSED);
    if (!any(takes))
        return;
    const real alpha = least(alpha_of(level), all(FXS_FIT_ALPHA_MOST)), weight = choose(takes, alpha * t, all(0));
    store(tile->transmittance + at, t - weight);
    for (int c = 0; c < 3; c++)
        store(tile->colour[c] + at, load(tile->colour[c] + at) + weight * s->colour[c]);
}

static inline int is_open(const fxs_fit_tile *tile)
{
    whole open = {0};
    for (int32_t i = 0; i < FXS_FIT_PIXELS; i += LANES)
        open |= load(tile->transmittance + i) >= FXS_FIT_CLOSED;
    return any(open);
}

/* Blends until all pixels are closed. Returns how many entries that took. */
static inline uint32_t blend(const fxs_fit_splat *splats, const fxs_fit_entry *entries, uint32_t count, int32_t left,
                             int32_t top, fxs_fit_tile *tile)
{
    memset(tile->colour, 0, sizeof tile->colour);
    for (int i = 0; i < FXS_FIT_PIXELS; i++)
        tile->transmittance[i] = 1;
    for (uint32_t e = 0; e < count; e++) {
        if (e % 16 == 0 && e && !is_open(tile))
            return e;
        const fxs_fit_splat *s = &splats[entries[e].splat];
        __builtin_prefetch(&splats[entries[e + 8 < count ? e + 8 : e].splat]);
        int32_t first, end;
        rows_of(s, (float)top, &first, &end);
        for (int32_t row = first; row < end; row++) {
            const float y = ((float)(top + row) + 0.5f) - s->centre[1], v = s->vy * y, row_level = v * v + s->offset;
            if (row_level > s->limit)
                continue;
            for (int32_t column = 0; column < FXS_FIT_TILE; column += LANES) {
                const real x = (column_numbers() + ((float)(left + column) + 0.5f)) - s->centre[0];
                blend_row(s, tile, row * FXS_FIT_TILE + column, x * s->ux + s->uy * y, row_level);
            }
        }
    }
    return count;
}

/* ---- back -------------------------------------------------------------------------------------------------------- */

/* Sums over the rows of LANES columns. */
typedef struct column_sums {
    real h, hy, hyy, colour[3];
} column_sums;

/* What has passed of the pixels: transmittance; the product of dL/dcolour with the sum of colours. */
typedef struct passed {
    float transmittance[FXS_FIT_PIXELS], sum[FXS_FIT_PIXELS];
} passed;

/* dL/dalpha = T (c . g) - behind / (1 - alpha), behind = (C - what has passed, this one included) . g */
static inline void back_row(const fxs_fit_splat *s, const fxs_fit_tile_gradient *g, passed *p, int32_t at, real u,
                            float y, float row_level, column_sums *sums)
{
    const real t = load(p->transmittance + at), level = u * u + row_level;
    const whole takes = (level <= s->limit) & (t >= FXS_FIT_CLOSED);
    if (!any(takes))
        return;
    const real exact = alpha_of(level), alpha = least(exact, all(FXS_FIT_ALPHA_MOST));
    const real weight = choose(takes, alpha * t, all(0));
    const real g0 = load(g->colour[0] + at), g1 = load(g->colour[1] + at), g2 = load(g->colour[2] + at);
    const real along = (g0 * s->colour[0] + g1 * s->colour[1]) + g2 * s->colour[2];
    const real sum = load(p->sum + at) + weight * along;
    store(p->transmittance + at, t - weight);
    store(p->sum + at, sum);
    const real behind = (load(g->whole + at) - sum) * inverse(1.0f - alpha);
    const whole varies = takes & (exact < FXS_FIT_ALPHA_MOST);
    const real h = choose(varies, alpha * (behind - t * along), all(0)), hy = h * y;
    sums->h += h;
    sums->hy += hy;
    sums->hyy += hy * y;
    sums->colour[0] += weight * g0;
    sums->colour[1] += weight * g1;
    sums->colour[2] += weight * g2;
}

/* The sum of each row: of columns c and c + 8, of those of c and c + 4, c + 2, c + 1. */
#if LANES == 1
static inline void add_columns(const float (*rows)[FXS_FIT_TILE], float *sums)
{
    for (int i = 0; i < FXS_FIT_SUMS; i++) {
        float four[4];
        for (int k = 0; k < 4; k++)
            four[k] = (rows[i][k] + rows[i][k + 8]) + (rows[i][k + 4] + rows[i][k + 12]);
        sums[i] = (four[0] + four[2]) + (four[1] + four[3]);
    }
}
#else
typedef float real4 __attribute__((vector_size(16)));
#define MIX(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)

static inline real4 load_4(const float *from)
{
    real4 x;
    memcpy(&x, from, sizeof x);
    return x;
}

/* The sums of four rows' last four columns. */
static inline real4 add_4(const real4 *f)
{
    const real4 a = MIX(f[0], f[1], 0, 4, 1, 5), b = MIX(f[2], f[3], 0, 4, 1, 5);
    const real4 c = MIX(f[0], f[1], 2, 6, 3, 7), d = MIX(f[2], f[3], 2, 6, 3, 7);
    return (MIX(a, b, 0, 1, 4, 5) + MIX(c, d, 0, 1, 4, 5)) + (MIX(a, b, 2, 3, 6, 7) + MIX(c, d, 2, 3, 6, 7));
}

static inline void add_columns(const float (*rows)[FXS_FIT_TILE], float *sums)
{
    real4 four[12] = {{0}};
    for (int i = 0; i < FXS_FIT_SUMS; i++)
        four[i] = (load_4(rows[i]) + load_4(rows[i] + 8)) + (load_4(rows[i] + 4) + load_4(rows[i] + 12));
    const real4 first = add_4(four), second = add_4(four + 4), third = add_4(four + 8);
    memcpy(sums, &first, sizeof first);
    memcpy(sums + 4, &second, sizeof second);
    sums[8] = third[0];
}
#undef MIX
#endif

static inline void back_splat(const fxs_fit_splat *s, const fxs_fit_tile_gradient *g, passed *p, int32_t left,
                              int32_t top, float *sums)
{
    float of_columns[FXS_FIT_SUMS][FXS_FIT_TILE];
    int32_t first, end;
    rows_of(s, (float)top, &first, &end);
    for (int32_t column = 0; column < FXS_FIT_TILE; column += LANES) {
        const real x = (column_numbers() + ((float)(left + column) + 0.5f)) - s->centre[0];
        column_sums c = {all(0), all(0), all(0), {all(0), all(0), all(0)}};
        for (int32_t row = first; row < end; row++) {
            const float y = ((float)(top + row) + 0.5f) - s->centre[1], v = s->vy * y, row_level = v * v + s->offset;
            if (row_level <= s->limit)
                back_row(s, g, p, row * FXS_FIT_TILE + column, x * s->ux + s->uy * y, y, row_level, &c);
        }
        const real hx = x * c.h;
        const real all_sums[FXS_FIT_SUMS] = {c.h, hx, c.hy, x * hx, x * c.hy, c.hyy,
                                             c.colour[0], c.colour[1], c.colour[2]};
        for (int i = 0; i < FXS_FIT_SUMS; i++)
            store(of_columns[i] + column, all_sums[i]);
    }
    add_columns((const float(*)[FXS_FIT_TILE])of_columns, sums);
}

/* The first `count` entries of a list, as many as blend took; `sums` of each go to its slot. */
static inline void back_tile(const fxs_fit_splat *splats, const fxs_fit_entry *entries, uint32_t count, int32_t left,
                             int32_t top, const fxs_fit_tile_gradient *g, float (*sums)[FXS_FIT_SUMS])
{
    passed p;
    memset(p.sum, 0, sizeof p.sum);
    for (int i = 0; i < FXS_FIT_PIXELS; i++)
        p.transmittance[i] = 1;
    for (uint32_t e = 0; e < count; e++) {
        __builtin_prefetch(&splats[entries[e + 8 < count ? e + 8 : e].splat]);
        back_splat(&splats[entries[e].splat], g, &p, left, top, sums[entries[e].slot]);
    }
}

#endif
