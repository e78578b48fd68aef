/* The tiles that splats' ellipses touch, row by row, and the blocks of them; LANES splats at once. */
#ifndef FXS_FIT_SPAN_H
#define FXS_FIT_SPAN_H

#include "lanes.h"
#include "stage.h"

/* Of LANES splats. radius2: that of u and v, squared; first, end: rows of tiles. */
typedef struct ellipses {
    real x, y, ux, uy, vy, radius2, half_y, tip, first, end;
} ellipses;

static inline real floor_of(real x)
{
    return whole_to_real(real_to_whole(x));
}

/* Where a splat is not seen, there are no rows. */
static inline void find_rows(const fxs_fit_camera *camera, mask seen, ellipses *e)
{
    const real rows = all((float)camera->tiles_y);
    e->first = floor_of(least(most((e->y - e->half_y) * 0.0625f, all(0)), rows));
    e->end = keep(seen, floor_of(least(most((e->y + e->half_y) * 0.0625f + 1.0f, all(0)), rows)));
}

/* Columns of blocks first..end, in the given rows of blocks: u = r cos, v = r sin, x = (u - uy y) / ux, y = v / vy. x is
   largest where y is the tip, or as near to there as the row's pixels are. With a margin of a hundredth of a pixel. Where
   the ellipse is not, end is not above first. */
static inline void find_span(const ellipses *e, real row, real blocks, real *first, real *end)
{
    const real top = row * 4.0f + (0.5f - e->y), bottom = top + 3.0f;
    real reach[2];
    for (int i = 0; i < 2; i++) {
        const real y = least(most(i ? e->tip : -e->tip, top), bottom), v = y * e->vy, along = y * e->uy;
        const real half = root(most(e->radius2 - v * v, all(0)));
        reach[i] = (i ? half - along : half + along) / e->ux + 0.01f;
    }
    const mask is_in = both(at_most(top, e->half_y), at_most(-e->half_y, bottom));
    const real from = ((e->x - reach[0]) + 0.5f) * 0.25f, to = ((e->x + reach[1]) + 3.5f) * 0.25f;
    *first = floor_of(least(most(from, all(0)), blocks));
    *end = keep(is_in, floor_of(least(most(to, all(0)), blocks)));
}

/* The spans of the four rows of blocks in a row of tiles, and the columns of tiles from..to that they touch. */
typedef struct tile_spans {
    real first[4], end[4], from, to;
} tile_spans;

static inline void find_tile_spans(const fxs_fit_camera *camera, const ellipses *e, real row, tile_spans *t)
{
    const real blocks = all((float)(4 * camera->tiles_x));
    const mask is_in = below(row, e->end);
    t->from = blocks;
    t->to = all(0);
    for (int k = 0; k < 4; k++) {
        find_span(e, row * 4.0f + (float)k, blocks, &t->first[k], &t->end[k]);
        const mask is_some = both(is_in, below(t->first[k], t->end[k]));
        t->from = choose(is_some, least(t->from, t->first[k]), t->from);
        t->to = choose(is_some, most(t->to, t->end[k]), t->to);
    }
    t->from = floor_of(t->from * 0.25f);
    t->to = most(floor_of((t->to + 3.0f) * 0.25f), t->from);
}

static inline real count_tiles(const fxs_fit_camera *camera, const ellipses *e)
{
    real count = all(0);
    for (real row = e->first; any(below(row, e->end)); row = row + 1.0f) {
        tile_spans t;
        find_tile_spans(camera, e, row, &t);
        count = count + keep(below(row, e->end), t.to - t.from);
    }
    return count;
}

/* A bit for each of the numbers first..end, from `base` on; 60 at most. */
static inline uint64_t span_bits(float first, float end, float base)
{
    const float f = first - base, e = end - base;
    const uint64_t below_first = (uint64_t)1 << (f < 0 ? 0 : f > 60 ? 60 : (int)f);
    const uint64_t below_end = (uint64_t)1 << (e < 0 ? 0 : e > 60 ? 60 : (int)e);
    return below_end > below_first ? below_end - below_first : 0;
}

/* The tiles from..to of a row; `first` and `end` are `step` apart. */
static inline fxs_fit_piece *put_row(const float *first, const float *end, int step, float from, float to,
                                     uint32_t tile_row, fxs_fit_piece *out)
{
    for (float base = from; base < to; base += 15) {
        uint64_t bits[4];
        for (int k = 0; k < 4; k++)
            bits[k] = span_bits(first[k * step], end[k * step], 4 * base);
        const uint32_t tile = tile_row + (uint32_t)base;
        for (uint32_t x = 0; x < 15 && base + (float)x < to; x++) {
            *out++ = (fxs_fit_piece){tile + x, (uint32_t)((bits[0] & 15) | (bits[1] & 15) << 4 | (bits[2] & 15) << 8 |
                                                          (bits[3] & 15) << 12)};
            for (int k = 0; k < 4; k++)
                bits[k] >>= 4;
        }
    }
    return out;
}

/* The pieces of LANES splats to where `out` says for each. */
static inline void put_pieces(const fxs_fit_camera *camera, const ellipses *e, fxs_fit_piece *out[LANES])
{
    for (real row = e->first; any(below(row, e->end)); row = row + 1.0f) {
        tile_spans t;
        float rows[LANES], ends[LANES], first[4][LANES], end[4][LANES], from[LANES], to[LANES];
        find_tile_spans(camera, e, row, &t);
        store(rows, row);
        store(ends, e->end);
        store(from, t.from);
        store(to, t.to);
        for (int k = 0; k < 4; k++) {
            store(first[k], t.first[k]);
            store(end[k], t.end[k]);
        }
        for (int i = 0; i < LANES; i++)
            if (rows[i] < ends[i])
                out[i] = put_row(first[0] + i, end[0] + i, LANES, from[i], to[i],
                                 (uint32_t)rows[i] * (uint32_t)camera->tiles_x, out[i]);
    }
}

#endif
