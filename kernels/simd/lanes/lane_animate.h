/* Moves the codes of LANES Gaussians of a chunk to a moment together. src/core/animate.h is the scalar version. */
#include "lane_axes.h"

static inline vi moved_position(vi code, const fxs_motion_rows *motion, const unsigned char *row,
                                const fxs_moment *moment)
{
    const int up = moment->shift > 0 ? moment->shift : 0, down = up - moment->shift;
    vi sum = all(0);
    for (uint32_t k = 0; k < motion->degree; k++, row += 6 * FXS_CHUNK)
        sum += mul_q15(load_i16((const int16_t *)(const void *)row), all(moment->power_q15[k]));
    return clamp(code + ((sum * all(1 << up) + all(1 << down >> 1)) >> down), all(0), all(65535));
}

/* With q a part in Q13 and the square of the length times 2^zeros below 2^32, q 2^(zeros / 2) is at most 2^16, and the
   inverse length that belongs to it is below 2^15 in Q14. */
static inline void turns_at(vi turn_q15[4], const unsigned char *row, int32_t u_q15)
{
    vi q_q13[4], square_q26 = all(0);
    for (int i = 0; i < 4; i++, row += 2 * FXS_CHUNK) {
        q_q13[i] = round_shift(load_i16((const int16_t *)(const void *)row) * all(u_q15), 16) + (i == 0 ? 8192 : 0);
        square_q26 += q_q13[i] * q_q13[i];
    }
    square_q26 = most(square_q26, all(1));
    const vi zeros = clz((vu)square_q26) & ~1;
    const vi inverse = (vi)shift_left(rsqrt(shift_left((vu)square_q26, zeros)) >> 16, zeros >> 1);
    for (int i = 0; i < 4; i++)
        turn_q15[i] = mul_q15(q_q13[i], inverse);
}

static inline void cross_q15(vi out_q15[3], const vi a_q15[3], const vi b_q15[3])
{
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        out_q15[i] = mul_q15(a_q15[j], b_q15[k]) - mul_q15(a_q15[k], b_q15[j]);
    }
}

static inline void turn(vi v_q15[3], const vi turn_q15[4])
{
    vi c_q15[3], twice_q15[3];
    cross_q15(c_q15, turn_q15 + 1, v_q15);
    cross_q15(twice_q15, turn_q15 + 1, c_q15);
    for (int i = 0; i < 3; i++)
        v_q15[i] += 2 * (mul_q15(turn_q15[0], c_q15[i]) + twice_q15[i]);
}

static inline vi turned_words(vi word, vi bits, int width, const vi turn_q15[4])
{
    axes a;
    vi second_q15[3];
    const mask valid = read_axes(&a, word, bits);
    for (int i = 0; i < 3; i++)
        second_q15[i] = round_shift(a.side_q15[0][i] * a.cos_q15 + a.side_q15[1][i] * a.sin_q15, 15);
    turn(a.axis_q15, turn_q15);
    turn(second_q15, turn_q15);
    return choose(valid, write_axes(a.axis_q15, second_q15, bits, width), word);
}

/* The distance in widths is shifted left by 8 and then right by the width's exponent. Both factors are below 2^16. */
static inline vi faded(vi code, const fxs_motion_rows *motion, const unsigned char *row, int32_t u_q15)
{
    const vi away_q13 = ((u_q15 + 2) >> 2) - load_i16((const int16_t *)(const void *)row);
    const vi width = load_u16((const uint16_t *)(const void *)(row + 2 * FXS_CHUNK));
    const vi product = most(away_q13, -away_q13) * exp2_q15((width & 4095) << 3);
    const vi widths_q13 = (vi)shift_right((vu)(product >> 15 << 8), width >> 12);
    const vi widths_q12 = least(widths_q13, all(32767)) >> 1, octaves_q16 = widths_q12 * widths_q12 >> 8;
    const vi left_q15 = (vi)shift_right((vu)exp2_q15((octaves_q16 & 65535) >> 1), octaves_q16 >> 16);
    const int32_t cut_q16 = (int32_t)(motion->cut_q16 < INT32_MAX ? motion->cut_q16 : INT32_MAX);
    return choose(greater(octaves_q16, all(cut_q16)), all(0), mul_q15(code, left_q15));
}

/* Profile small keeps the upper 11 bits of a position code, and 23 bits of the rotation word. */
static inline void store_small(unsigned char *out, const unsigned char *rows, uint32_t i, const vi position[3],
                               vi rotation, vi opacity)
{
    const vi b = load(rows + FXS_SMALL_B + 4 * i), c = load(rows + FXS_SMALL_C + 4 * i);
    const vi x = position[0] >> 5, y = position[1] >> 5, z = position[2] >> 5;
    store(out + FXS_SMALL_A + 4 * i, x | y << 11 | (rotation >> 10 & 3) << 22 | opacity << 24);
    store(out + FXS_SMALL_B + 4 * i, (b & 0x7ffff800) | z | (rotation >> 9) << 31);
    store(out + FXS_SMALL_C + 4 * i, (c & 0xfffff) | (rotation & (int32_t)0xfff00000));
    for (uint32_t lane = 0; lane < LANES; lane++)
        out[FXS_SMALL_D + i + lane] = (unsigned char)(rotation[lane] >> 12);
}

static inline void store_codes(unsigned char *out, const unsigned char *rows, uint32_t i, const vi position[3],
                               vi rotation, vi opacity)
{
    for (uint32_t k = 0; k < 3; k++)
        store_u16((uint16_t *)(void *)(out + FXS_ROW_POSITION) + FXS_CHUNK * k + i, position[k]);
    store(out + FXS_ROW_ROTATION + 4 * i, rotation);
    store(out + FXS_ROW_SCALE + 4 * i, load(rows + FXS_ROW_SCALE + 4 * i));
    store(out + FXS_ROW_COLOUR + 4 * i, (load(rows + FXS_ROW_COLOUR + 4 * i) & 0xffffff) | opacity << 24);
}

FXS_ANIMATE(ISA)
{
    const enum fxs_profile profile = scene->profile;
    const int32_t u_q15 = moment->power_q15[0];
    for (uint32_t i = 0; i < FXS_CHUNK; i += LANES) {
        const unsigned char *drifts = rows + motion->at + 2 * i, *turns = drifts + 6 * FXS_CHUNK * motion->degree;
        vi position[3], rotation = load_rotations(scene, rows, i), opacity = load_opacities(scene, rows, i);
        load_positions(position, scene, rows, i);
        for (uint32_t k = 0; k < 3; k++)
            position[k] = moved_position(position[k], motion, drifts + 2 * FXS_CHUNK * k, moment);
        if (motion->fades)
            opacity = faded(opacity, motion, turns + (motion->turns ? 8 * FXS_CHUNK : 0), u_q15);
        const mask seen = greater(opacity, all(0));
        if (motion->turns && any(seen)) {
            vi fall_q16[3], turn_q15[4];
            falls_of(fall_q16, load_scales(scene, rows, i), scale_step_q24);
            turns_at(turn_q15, turns, u_q15);
            rotation = choose(seen, turned_words(rotation, axis_bits(profile, fall_q16), FXS_ROTATION_BITS(profile),
                                                 turn_q15), rotation);
        }
        (profile == FXS_PROFILE_SMALL ? store_small : store_codes)(out, rows, i, position, rotation, opacity);
    }
}
