/* The tiles that a splat's ellipse touches, row by row, and the blocks of them. */
#ifndef FXS_FIT_SPAN_H
#define FXS_FIT_SPAN_H

#include "lanes.h"
#include "stage.h"

/* Of 16 rows of blocks, that is of four rows of tiles, the columns of blocks first..end. */
typedef struct span_rows {
    int32_t first[16], end[16];
} span_rows;

static inline int32_t cut_at(float x, int32_t most_of)
{
    return x > 0 ? (x < (float)most_of ? (int32_t)x : most_of) : 0;
}

/* Of LANES rows from `row` on: u = r cos, v = r sin, x = (u - uy y) / ux, y = v / vy. x is largest where y is the tip,
   or as near to there as the row's pixels are. With a margin of a hundredth, and of a hundredth of a pixel. Where the
   ellipse is not, end is not above first. */
static inline void find_spans(const fxs_fit_camera *camera, const fxs_fit_splat *s, int32_t row, int32_t *first,
                              int32_t *end)
{
    const float r2 = (s->limit - s->offset) * FXS_FIT_WIDER, blocks = (float)(4 * camera->tiles_x);
    const real top = (numbers_from(0) + (float)row) * 4.0f + (0.5f - s->centre[1]), bottom = top + 3.0f;
    real reach[2];
    for (int i = 0; i < 2; i++) {
        const real y = least(most(all(i ? s->tip : -s->tip), top), bottom), v = y * s->vy, along = y * s->uy;
        const real half = root(most(r2 - v * v, all(0)));
        reach[i] = (i ? half - along : half + along) / s->ux + 0.01f;
    }
    const mask is_in = both(at_most(top, all(s->half[1])), at_most(all(-s->half[1]), bottom));
    const real from = (s->centre[0] - reach[0] + 0.5f) * 0.25f, to = (s->centre[0] + reach[1] + 3.5f) * 0.25f;
    const whole f = real_to_whole(least(most(from, all(0)), all(blocks)));
    const whole e = real_to_whole(keep(is_in, least(most(to, all(0)), all(blocks))));
    memcpy(first, &f, sizeof f);
    memcpy(end, &e, sizeof e);
}

/* Bits of a tile's four blocks in a row of which first..end are touched. */
static inline uint32_t span_bits(int32_t first, int32_t end)
{
    const int32_t f = first < 0 ? 0 : first > 4 ? 4 : first, e = end < 0 ? 0 : end > 4 ? 4 : end;
    return e > f ? (1u << e) - (1u << f) : 0;
}

/* Tiles of a row of tiles, whose rows of blocks have these spans. Returns how many. */
static inline uint32_t cover_row(const int32_t *first, const int32_t *end, uint32_t tile_row, fxs_fit_piece *out)
{
    int32_t from = INT32_MAX, to = 0;
    for (int k = 0; k < 4; k++)
        if (end[k] > first[k]) {
            from = first[k] < from ? first[k] : from;
            to = end[k] > to ? end[k] : to;
        }
    from /= 4;
    to = (to + 3) / 4;
    for (int32_t x = from; out && x < to; x++, out++) {
        out->tile = tile_row + (uint32_t)x;
        out->blocks = 0;
        for (int k = 0; k < 4; k++)
            out->blocks |= span_bits(first[k] - 4 * x, end[k] - 4 * x) << 4 * k;
    }
    return to > from ? (uint32_t)(to - from) : 0;
}

/* All of the tiles that the square touches. */
static inline uint32_t cover_square(const fxs_fit_camera *camera, const fxs_fit_splat *s, fxs_fit_piece *out)
{
    const int32_t left = cut_at((s->centre[0] - s->half[0]) / 16, camera->tiles_x);
    const int32_t right = cut_at((s->centre[0] + s->half[0]) / 16 + 1, camera->tiles_x);
    const int32_t top = cut_at((s->centre[1] - s->half[1]) / 16, camera->tiles_y);
    const int32_t bottom = cut_at((s->centre[1] + s->half[1]) / 16 + 1, camera->tiles_y);
    for (int32_t y = top; out && y < bottom; y++)
        for (int32_t x = left; x < right; x++)
            *out++ = (fxs_fit_piece){(uint32_t)(y * camera->tiles_x + x), 0xffff};
    return (uint32_t)((right - left) * (bottom - top));
}

/* The splat's pieces, to `out` where that is not null. Returns how many. */
static inline uint32_t cover(const fxs_fit_camera *camera, const fxs_fit_splat *s, fxs_fit_piece *out)
{
    const int32_t rows = 4 * camera->tiles_y;
    const int32_t first = cut_at((s->centre[1] - s->half[1]) / 4, rows) & ~3;
    const int32_t end = (cut_at((s->centre[1] + s->half[1]) / 4 + 1, rows) + 3) & ~3;
    uint32_t count = 0;
    if (camera->is_square)
        return cover_square(camera, s, out);
    for (int32_t row = first; row < end; row += 16) {
        span_rows spans;
        for (int32_t i = 0; i < 16 && row + i < end; i += LANES)
            find_spans(camera, s, row + i, spans.first + i, spans.end + i);
        for (int32_t i = 0; i < 16 && row + i < end; i += 4)
            count += cover_row(spans.first + i, spans.end + i, (uint32_t)((row + i) / 4 * camera->tiles_x),
                               out ? out + count : NULL);
    }
    return count;
}

#endif
