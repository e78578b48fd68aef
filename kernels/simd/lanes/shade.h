/* Computes the colours of PARTS vectors of neighbouring Gaussians together, even of invisible Gaussians. The colours of
 * visible Gaussians are copied to their splats. */
#include "lane_codes.h"

#define GROUP (PARTS * LANES)
/* number of groups of Gaussians that compute their view directions together, so that operations overlap */
#define SOME (LANES > 4 ? 4u : 1u)

#define Q15(x_millionths) ((int32_t)(((int64_t)(x_millionths) * 32768 + 500000) / 1000000))

static inline wide offset_q32(const fxs_stage_view *view, const fxs_chunk *chunk, int axis, vi position)
{
    const wide x = mul_wide_u((vu)position, (vu)all((int32_t)chunk->step_q32[axis]));
    return offset_wide(shift_left_wide(x, chunk->step_shift), chunk->origin_q32[axis] - view->eye_q32[axis]);
}

static inline void direction(vi d_q15[3], const wide offset_q32[3])
{
    wide largest = mul_wide(all(0), all(0));
    vi d[3];
    for (int i = 0; i < 3; i++)
        largest = or_magnitude(largest, offset_q32[i]);
    vi shift = most(49 - clz_wide(largest), all(0));
    for (int i = 0; i < 3; i++)
        d[i] = narrow_by(offset_q32[i], shift);
    vu square = (vu)d[0] * (vu)d[0] + (vu)d[1] * (vu)d[1] + (vu)d[2] * (vu)d[2];
    vi zeros = clz(square) & ~1;
    vi inverse_q30 = (vi)rsqrt(shift_left(square, zeros));
    for (int i = 0; i < 3; i++)
        d_q15[i] = clamp(scale_down_wide(mul_wide(d[i], inverse_q30), 31 - (zeros >> 1)), all(-32767), all(32767));
}

/* Returns x / 2^shift, rounded towards 0, per lane. */
static inline vi divide(vi x, int shift)
{
    const int32_t rest = (1 << shift) - 1;
    return (x + (x >> 31 & rest)) >> shift;
}

static inline vi scale_q15(int32_t constant_q15, vi x)
{
    return round_shift(x * constant_q15, 15);
}

static inline void basis(vi b[15], const vi d_q15[3], int degree)
{
    const vi x = d_q15[0], y = d_q15[1], z = d_q15[2];
    b[0] = scale_q15(-Q15(488603), y);
    b[1] = scale_q15(Q15(488603), z);
    b[2] = scale_q15(-Q15(488603), x);
    if (degree < 2)
        return;
    const vi xx = mul_q15(x, x), yy = mul_q15(y, y), zz = mul_q15(z, z);
    const vi xy = mul_q15(x, y), yz = mul_q15(y, z), xz = mul_q15(x, z);
    b[3] = 2 * scale_q15(Q15(546274), xy);
    b[4] = -2 * scale_q15(Q15(546274), yz);
    b[5] = scale_q15(Q15(315392), 2 * zz - xx - yy);
    b[6] = -2 * scale_q15(Q15(546274), xz);
    b[7] = scale_q15(Q15(546274), xx - yy);
    if (degree < 3)
        return;
    const vi zz_xx_yy = divide(4 * zz - xx - yy, 2);
    b[8] = -2 * mul_q15(scale_q15(Q15(590044), y), divide(3 * xx - yy, 1));
    b[9] = 4 * mul_q15(scale_q15(Q15(722653), xy), z);
    b[10] = -4 * mul_q15(scale_q15(Q15(457046), y), zz_xx_yy);
    b[11] = 4 * mul_q15(scale_q15(Q15(373176), z), divide(2 * zz - 3 * xx - 3 * yy, 2));
    b[12] = -4 * mul_q15(scale_q15(Q15(457046), x), zz_xx_yy);
    b[13] = 2 * mul_q15(scale_q15(Q15(722653), z), xx - yy);
    b[14] = -2 * mul_q15(scale_q15(Q15(590044), x), divide(xx - 3 * yy, 1));
}

typedef struct neighbours {
    uint32_t start, end;           /* start and end of the neighbours in the chunk's list of visible Gaussians */
    uint32_t first, wanted;        /* number of the first neighbour in its chunk; mask of visible neighbours */
    vi d_q15[PARTS][3];
} neighbours;

static inline void find_direction(vi d_q15[3], const fxs_stage_view *view, const fxs_scene *scene,
                                  const fxs_chunk *chunk, const unsigned char *rows, uint32_t first)
{
    vi position[3];
    wide offset[3];
    load_positions(position, scene, rows, first);
    for (int k = 0; k < 3; k++)
        offset[k] = offset_q32(view, chunk, k, position[k]);
    direction(d_q15, offset);
}

static __attribute__((noinline)) void find_directions(neighbours *some, uint32_t count, const fxs_stage_view *view,
                                                      const fxs_scene *scene, const fxs_chunk *chunk,
                                                      const unsigned char *rows)
{
    for (neighbours *n = some; n < some + count; n++)
        for (uint32_t part = 0; part < PARTS; part++)
            find_direction(n->d_q15[part], view, scene, chunk, rows, n->first + part * LANES);
}

static inline void basis_at(vi b_q15[16], const neighbours *n, uint32_t part, const fxs_stage_view *view,
                            const fxs_scene *scene, const fxs_chunk *chunk, const unsigned char *rows)
{
    vi d_q15[3];
    if (SOME == 1)
        find_direction(d_q15, view, scene, chunk, rows, n->first + part * LANES);
    basis(b_q15, SOME == 1 ? d_q15 : n->d_q15[part], view->sh_degree);
}

static inline void add_band(vi sum_q16[PARTS], const vi band_q15[PARTS], int32_t step_q19)
{
    for (int part = 0; part < PARTS; part++)
        sum_q16[part] += round_shift(round_shift(band_q15[part], 10) * step_q19, 8);
}

static inline void add_bands(vi sum_q16[3][PARTS], const int8_t *codes, vi b_q15[PARTS][16],
                             const uint16_t step_q19[3], int degree)
{
    for (int d = 1, k = 0; d <= degree; d++) {
        vi red_q15[PARTS] = {{0}}, green_q15[PARTS] = {{0}}, blue_q15[PARTS] = {{0}};
        for (int end = FXS_SH_COUNT(d); k < end; k++, codes += 3 * FXS_CHUNK) {
            const factor b = factor_of(b_q15[0][k], b_q15[PARTS - 1][k]);
            add_products(red_q15, codes, b);
            add_products(green_q15, codes + FXS_CHUNK, b);
            add_products(blue_q15, codes + 2 * FXS_CHUNK, b);
        }
        add_band(sum_q16[0], red_q15, step_q19[d - 1]);
        add_band(sum_q16[1], green_q15, step_q19[d - 1]);
        add_band(sum_q16[2], blue_q15, step_q19[d - 1]);
    }
}

static inline fxs_sh_sums sum_of(const fxs_scene *scene, const unsigned char *record, const octet mean[3], octet b_q15)
{
    fxs_sh_sums s = {{0, 0, 0}, {0, 0, 0}, record[FXS_GAIN_BYTE]};
    octet numbers[3] = {mean[0], mean[1], mean[2]};
    for (uint32_t stage = 0; stage < fxs_palette_stages(scene->profile, scene->sh_degree); stage++) {
        const int8_t *entry = fxs_palette_entry(scene, stage, record[stage]);
        for (int c = 0; c < 3; c++)
            numbers[c] = add_16(numbers[c], entry + 16 * c, record[stage] & FXS_PALETTE_NEGATIVE);
    }
    dot_16(s.palette, numbers, b_q15);
    if (scene->profile == FXS_PROFILE_COMPACT) {
        for (int c = 0; c < 3; c++)
            numbers[c] = odd_numbers(fxs_residual(record, scene->sh_degree, c));
        dot_16(s.odd, numbers, b_q15);
    }
    return s;
}

/* Adds the share of the SH palette to the colours. Works on one lane after another, because the palette entries of the
   lanes lie far apart. */
static inline void add_palette(vi sum_q16[3][PARTS], const fxs_scene *scene, const fxs_chunk *header,
                               const unsigned char *rows, uint32_t first, vi b_q15[PARTS][16], int degree,
                               uint32_t wanted)
{
    const octet mean[3] = {load_16(header->sh_mean), load_16(header->sh_mean + 16), load_16(header->sh_mean + 32)};
    octet by_gaussian[GROUP];
    int32_t more_q16[3][GROUP] = {{0}};
    for (int part = 0; part < PARTS; part++) {
        vi pairs[8];
        for (int k = FXS_SH_COUNT(degree); k < 16; k++)
            b_q15[part][k] = all(0);
        for (int k = 0; k < 8; k++)
            pairs[k] = (b_q15[part][2 * k] & 65535) | b_q15[part][2 * k + 1] << 16;
        for (int lane = 0; lane < LANES; lane += 4)
            transpose(by_gaussian + part * LANES + lane, pairs, lane);
    }
    for (; wanted; wanted &= wanted - 1) {
        const uint32_t g = (uint32_t)__builtin_ctz(wanted);
        const fxs_sh_sums s = sum_of(scene, fxs_sh_record(scene, rows, first + g), mean, by_gaussian[g]);
        for (int c = 0; c < 3; c++)
            more_q16[c][g] = fxs_sh_sum_q16(&s, scene, c);
    }
    for (int c = 0; c < 3; c++)
        for (int part = 0; part < PARTS; part++)
            sum_q16[c][part] += load(more_q16[c] + part * LANES);
}

/* Computes the colours of neighbouring Gaussians. Not inlined, because the caller would then save constants around
   calls of the C version. */
static __attribute__((noinline)) void colours(int32_t red_green[GROUP], int32_t blue[GROUP], const neighbours *n,
                                              const fxs_stage_view *view, const fxs_scene *scene,
                                                  const fxs_chunk *header,
                                              const unsigned char *rows)
{
    const uint32_t first = n->first;
    vi sum_q16[3][PARTS], b_q15[PARTS][16];
    for (uint32_t part = 0; part < PARTS; part++) {
        vi code[3];
        load_colours(code, scene, rows, first + part * LANES);
        for (int c = 0; c < 3; c++) {
            const vi step = code[c] * (int32_t)header->colour_step_q20[c];
            sum_q16[c][part] = header->colour_q16[c] + round_shift(step, 4);
        }
        if (view->sh_degree > 0)
            basis_at(b_q15[part], n, part, view, scene, header, rows);
    }
    if (view->sh_degree > 0 && scene->palette)
        add_palette(sum_q16, scene, header, rows, first, b_q15, view->sh_degree, n->wanted);
    else if (view->sh_degree > 0)
        add_bands(sum_q16, (const int8_t *)rows + FXS_ROW_SH + first, b_q15, header->sh_step_q19, view->sh_degree);
    for (int part = 0; part < PARTS; part++) {
        vi colour_q13[3];
        for (int c = 0; c < 3; c++)
            colour_q13[c] = clamp(round_shift(sum_q16[c][part], 3), all(0), all(32767));
        store(red_green + part * LANES, colour_q13[0] | colour_q13[1] << 16);
        store(blue + part * LANES, colour_q13[2]);
    }
}

/* Collects the visible neighbours of Gaussian i in *n. Returns the first visible Gaussian after these neighbours. */
static inline uint32_t take_neighbours(neighbours *n, const uint32_t *indices, uint32_t i, uint32_t count)
{
    const uint32_t first = indices[i] & ~(GROUP - 1u);
    uint32_t wanted = 0, end = i;
    for (; end < count && indices[end] - first < GROUP; end++)
        wanted |= 1u << (indices[end] - first);
    n->start = i;
    n->end = end;
    n->first = first % FXS_CHUNK;
    n->wanted = wanted;
    return end;
}

static inline void shade_neighbours(const neighbours *n, const fxs_stage_view *view, const fxs_scene *scene,
                                    const fxs_chunk *header, const unsigned char *rows, const uint32_t *indices,
                                    fxs_splat *splats)
{
    int32_t red_green[GROUP], blue[GROUP];
    if (n->end - n->start == 1 && !scene->palette) {       /* For a lone Gaussian, the C version is as fast. */
        fxs_shade_list(view, scene, header, rows, indices + n->start, 1, splats + n->start);
        return;
    }
    colours(red_green, blue, n, view, scene, header, rows);
    for (uint32_t i = n->start; i < n->end; i++) {
        const uint32_t g = indices[i] % GROUP;
        memcpy(splats[i].colour_q13, &red_green[g], sizeof red_green[g]);
        splats[i].colour_q13[2] = (int16_t)blue[g];
    }
}

FXS_SHADE(ISA)
{
    const unsigned char *rows = fxs_rows(scene, chunk);
    fxs_chunk header;
    const int error = fxs_chunk_read(&header, scene, chunk);
    if (error)
        return error;
    for (uint32_t i = 0; i < count;) {
        neighbours some[SOME];
        uint32_t filled = 0;
        for (; filled < SOME && i < count; filled++)
            i = take_neighbours(&some[filled], indices, i, count);
        if (SOME > 1 && view->sh_degree > 0)
            find_directions(some, filled, view, scene, &header, rows);
        for (uint32_t k = 0; k < filled; k++)
            shade_neighbours(&some[k], view, scene, &header, rows, indices, splats);
    }
    return 0;
}
