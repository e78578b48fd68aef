/* Blends the splats of a tile to pixels, and sums the gradients of the tile's pixels for each splat (the backward
 * pass). */
#ifndef FXS_FIT_TILE_H
#define FXS_FIT_TILE_H

#include "fit_pixel.h"

enum {
    PLACES = 16,                   /* number of pixels in a 4x4 block */
    BATCH = 16,
    EARLY = 8
};

/* Normalised coordinates u and v of a splat at the first pixel of each 4x4-pixel block of a tile. */
typedef struct corners {
    float u[FXS_FIT_BLOCKS], v[FXS_FIT_BLOCKS];
} corners;

static inline void find_corners(const fxs_fit_splat *s, int32_t left, int32_t top, corners *c)
{
    static const float along[FXS_FIT_BLOCKS] = {0, 4, 8, 12, 0, 4, 8, 12, 0, 4, 8, 12, 0, 4, 8, 12};
    static const float down[FXS_FIT_BLOCKS] = {0, 0, 0, 0, 4, 4, 4, 4, 8, 8, 8, 8, 12, 12, 12, 12};
    for (int b = 0; b < FXS_FIT_BLOCKS; b += LANES) {
        const real x = (load(along + b) + ((float)left + 0.5f)) - s->centre[0];
        const real y = (load(down + b) + ((float)top + 0.5f)) - s->centre[1];
        store(c->u + b, x * s->ux + y * s->uy);
        store(c->v + b, y * s->vy);
    }
}

/* Returns the bit set of the 4x4-pixel blocks of a tile that the splat's ellipse may touch. */
static inline uint32_t find_blocks(const fxs_fit_splat *s, const corners *c)
{
    const float across = 3 * s->ux, slant = 3 * s->uy, down = 3 * s->vy;
    const float limit = (s->limit - s->offset) * FXS_FIT_WIDER;
    uint32_t blocks = 0;
    if (s->radius2 < 0)
        return (1u << FXS_FIT_BLOCKS) - 1;
    for (int b = 0; b < FXS_FIT_BLOCKS; b += LANES) {
        const real u0 = load(c->u + b), v0 = load(c->v + b);
        const real u = most(most(u0 + (slant < 0 ? slant : 0), -u0 - (across + (slant > 0 ? slant : 0))), all(0));
        const real v = most(most(v0, -v0 - down), all(0));
        blocks |= bits_of_mask(at_most(u * u + v * v, all(limit))) << b;
    }
    return blocks;
}

static inline void find_places(const fxs_fit_splat *s, int place, real *u, real *v)
{
    static const float along[PLACES] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
    static const float down[PLACES] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
    const real y = load(down + place);
    *u = load(along + place) * s->ux + y * s->uy;
    *v = y * s->vy;
}

static inline int blend_pixels(const fxs_fit_splat *s, fxs_fit_tile *tile, int at, real u, real v)
{
    const real t = load(tile->transmittance + at), level = (u * u + v * v) + s->offset;
    const mask takes = takes_of(level, all(s->limit), t);
    if (LANES < 8 && !any(takes))
        return 0;
    const real weight = weight_of(takes, level, t);
    store(tile->transmittance + at, t - weight);
    for (int c = 0; c < 3; c++)
        store(tile->colour[c] + at, load(tile->colour[c] + at) + weight * s->colour[c]);
    return any(takes);
}

/* Blends a splat into a tile. Returns the bit set of the 4x4-pixel blocks that the splat changes. */
static inline uint32_t blend_splat(const fxs_fit_splat *from, const corners *c, uint32_t blocks, fxs_fit_tile *tile)
{
    const fxs_fit_splat s = *from;
    uint32_t taken = 0;
    for (int place = 0; place < PLACES; place += LANES) {
        real u, v;
        find_places(&s, place, &u, &v);
        for (uint32_t rest = blocks; rest; rest &= rest - 1) {
            const int b = __builtin_ctz(rest);
            taken |= (uint32_t)blend_pixels(&s, tile, b * PLACES + place, u + c->u[b], v + c->v[b]) << b;
        }
    }
    return taken;
}

static inline int is_open(const fxs_fit_tile *tile)
{
    for (int i = 0; i < FXS_FIT_PIXELS; i += LANES)
        if (any(at_most(all(FXS_FIT_CLOSED), load(tile->transmittance + i))))
            return 1;
    return 0;
}

/* Blends a tile's list of splats until all pixels are opaque. Returns the number of list entries up to the last one
   that changed a pixel. */
static inline uint32_t blend(const fxs_fit_splat *splats, fxs_fit_entry *entries, uint32_t count, int32_t left,
                             int32_t top, float light, fxs_fit_tile *tile)
{
    uint32_t needed = 0;
    memset(tile->colour, 0, sizeof tile->colour);
    for (int i = 0; i < FXS_FIT_PIXELS; i++)
        tile->transmittance[i] = light;
    for (uint32_t first = 0; first < count; first += BATCH) {
        const uint32_t end = count - first < BATCH ? count : first + BATCH;
        corners c[BATCH];
        if (!is_open(tile))
            break;
        for (uint32_t e = first; e < end; e++) {
            const fxs_fit_splat *s = &splats[entries[e].splat];
            __builtin_prefetch(&splats[entries[e + BATCH < count ? e + BATCH : e].splat]);
            find_corners(s, left, top, &c[e - first]);
            entries[e].blocks = find_blocks(s, &c[e - first]);
        }
        for (uint32_t e = first; e < end; e++) {
            entries[e].blocks = blend_splat(&splats[entries[e].splat], &c[e - first], entries[e].blocks, tile);
            needed = entries[e].blocks ? e + 1 : needed;
        }
    }
    return needed;
}

typedef struct passed {
    float transmittance[FXS_FIT_PIXELS], behind[FXS_FIT_PIXELS];
} passed;

static inline void find_sums(const fxs_fit_splat *s, const fxs_fit_tile_gradient *g, passed *p, int at, real u, real v,
                             real sums[FXS_FIT_SUMS])
{
    const real level = (u * u + v * v) + s->offset;
    passed_pixel pixel = {load(p->transmittance + at), load(p->behind + at)};
    const mask takes = takes_of(level, all(s->limit), pixel.transmittance);
    if (LANES < 8 && !any(takes)) {
        for (int i = 0; i < FXS_FIT_SUMS; i++)
            sums[i] = all(0);
        return;
    }
    const real g0 = load(g->colour[0] + at), g1 = load(g->colour[1] + at), g2 = load(g->colour[2] + at);
    const real of_colour = (g0 * s->colour[0] + g1 * s->colour[1]) + g2 * s->colour[2];
    real weight;
    const real h = pass_splat(takes, level, of_colour, &pixel, &weight);
    store(p->transmittance + at, pixel.transmittance);
    store(p->behind + at, pixel.behind);
    sums_of(h, weight, u, v, g0, g1, g2, sums);
}

/* Computes gradient sums of 16 numbers each, as binary trees: numbers p and p + 8 are added first, then p + 4, p + 2
   and p + 1. */
#if LANES == 1
static inline void add_places(const float (*rows)[PLACES], float *sums)
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
typedef int32_t whole4 __attribute__((vector_size(16)));
#ifdef __clang__
#define MIX(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#else
#define MIX(a, b, ...) __builtin_shuffle(a, b, (whole4){__VA_ARGS__})
#endif

static inline real4 load_4(const float *from)
{
    real4 x;
    memcpy(&x, from, sizeof x);
    return x;
}

static inline real4 add_4(const real4 *f)
{
    const real4 a = MIX(f[0], f[1], 0, 4, 1, 5), b = MIX(f[2], f[3], 0, 4, 1, 5);
    const real4 c = MIX(f[0], f[1], 2, 6, 3, 7), d = MIX(f[2], f[3], 2, 6, 3, 7);
    return (MIX(a, b, 0, 1, 4, 5) + MIX(c, d, 0, 1, 4, 5)) + (MIX(a, b, 2, 3, 6, 7) + MIX(c, d, 2, 3, 6, 7));
}

static inline void add_places(const float (*rows)[PLACES], float *sums)
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

static inline void backward_block(const fxs_fit_splat *s, const corners *c, int b, const real of_places[][2],
                                  const fxs_fit_tile_gradient *g, passed *p, float *sums)
{
    float own[FXS_FIT_SUMS];
#ifdef ADD_PLACES
    real all_sums[FXS_FIT_SUMS];
    find_sums(s, g, p, b * PLACES, of_places[0][0] + c->u[b], of_places[0][1] + c->v[b], all_sums);
    ADD_PLACES(all_sums, own);
#else
    float rows[FXS_FIT_SUMS][PLACES];
    for (int place = 0; place < PLACES; place += LANES) {
        const real *at = of_places[place / LANES];
        real all_sums[FXS_FIT_SUMS];
        find_sums(s, g, p, b * PLACES + place, at[0] + c->u[b], at[1] + c->v[b], all_sums);
        for (int i = 0; i < FXS_FIT_SUMS; i++)
            store(rows[i] + place, all_sums[i]);
    }
    add_places((const float(*)[PLACES])rows, own);
#endif
    for (int i = 0; i < FXS_FIT_SUMS; i++)
        sums[i] += own[i];
}

static inline void backward_splat(const fxs_fit_splat *from, uint32_t blocks, const fxs_fit_tile_gradient *g, passed *p,
                                  int32_t left, int32_t top, float *sums)
{
    const fxs_fit_splat s = *from;
    float all_sums[FXS_FIT_SUMS] = {0};
    real of_places[PLACES / LANES][2];
    corners c;
    find_corners(&s, left, top, &c);
    for (int place = 0; place < PLACES; place += LANES)
        find_places(&s, place, &of_places[place / LANES][0], &of_places[place / LANES][1]);
    for (uint32_t rest = blocks; rest; rest &= rest - 1)
        backward_block(&s, &c, __builtin_ctz(rest), (const real(*)[2])of_places, g, p, all_sums);
    memcpy(sums, all_sums, sizeof all_sums);
}

static inline void backward(const fxs_fit_splat *splats, const fxs_fit_entry *entries, uint32_t count, int32_t left,
                        int32_t top, const fxs_fit_tile_gradient *g, float (*sums)[FXS_FIT_SUMS])
{
    passed p;
    memcpy(p.behind, g->whole, sizeof p.behind);
    for (int i = 0; i < FXS_FIT_PIXELS; i++)
        p.transmittance[i] = 1;
    for (uint32_t e = 0; e < count; e++) {
        const fxs_fit_entry *later = &entries[e + EARLY < count ? e + EARLY : e];
        __builtin_prefetch(&splats[later->splat]);
        __builtin_prefetch(sums[later->slot], 1);
        if (entries[e].blocks)
            backward_splat(&splats[entries[e].splat], entries[e].blocks, g, &p, left, top, sums[entries[e].slot]);
        else
            memset(sums[entries[e].slot], 0, sizeof *sums);
    }
}

#endif
