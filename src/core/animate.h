/* Moving scenes: the chunks that are alive at a time, and their Gaussians at that time. docs/numbers.md has the
 * formulas. A chunk has 256 Gaussians. */
#ifndef FXS_ANIMATE_H
#define FXS_ANIMATE_H

#include "axes.h"
#include "codes.h"

/* Returns the time of a moving scene, 0 to its duration, Q16. */
FXS_STAGE int32_t fxs_time_of(const fxs_motion_header *motion, int64_t time_q32);

/* Copies the motion header of a moving scene, and checks it and the length of a chunk's rows. Returns 0 or
   FXS_ERR_SCENE. */
FXS_STAGE int fxs_motion_read(fxs_motion_header *header, const fxs_scene *scene);

/* Finds out whether a chunk is alive at a time, and computes its powers of u. Returns 1, 0 or FXS_ERR_SCENE. */
FXS_STAGE int fxs_moment_of(fxs_moment *out, const fxs_scene *scene, uint32_t chunk, int32_t time_q16);

/* Returns the largest number of chunks of a moving scene that are alive at one time, with the chunks of its tree. Of a
   still scene, returns the number of its leaves. */
uint32_t fxs_most_alive(const fxs_scene *scene);

/* Returns the layout of the rows of motion of a scene. */
FXS_STAGE fxs_motion_rows fxs_motion_rows_of(const fxs_scene *scene, const fxs_motion_header *motion);

/* Moves the codes of one Gaussian to a moment: to the codes that the chunk has as fxs_animate_chunk writes it.
   `scale_step_q24` is the chunk's. A Gaussian whose opacity code becomes 0 is not turned, because it is never drawn. */
static inline void fxs_animate_codes(fxs_codes *codes, const fxs_motion_rows *motion, const unsigned char *rows,
                                     uint32_t g, const fxs_moment *moment, enum fxs_profile profile,
                                     uint32_t scale_step_q24);

/* Writes a chunk of a moving scene as it is at a moment to `room`, fxs_animated_bytes, aligned to 64: its header and
   its rows without SH. Returns 0 or FXS_ERR_SCENE. */
int fxs_animate_chunk(const fxs_kernels *kernels, const fxs_scene *scene, const fxs_motion_rows *motion, uint32_t chunk,
                      const fxs_moment *moment, unsigned char *room);

/* Returns the scene of the one chunk that fxs_animate_chunk wrote. */
fxs_scene fxs_animated_scene(const fxs_scene *scene, const unsigned char *room);

/* Copies the SH of a chunk behind the rows that fxs_animate_chunk wrote. */
void fxs_animate_sh(const fxs_scene *scene, uint32_t chunk, unsigned char *room);

static inline uint32_t fxs_animated_bytes(const fxs_scene *scene)
{
    return (uint32_t)sizeof(fxs_chunk) + fxs_chunk_bytes(scene->profile, scene->sh_degree);
}

/* ---- One Gaussian ------------------------------------------------------------------------------------------------ */

static inline int32_t fxs_signed_half_at(const unsigned char *row, uint32_t g)
{
    return (int16_t)fxs_half_at(row, g);
}

/* x(u) = x + (a u + b u^2 + c u^3) 2^shift, limited to the range of codes. Each product is rounded to nearest. */
static inline uint16_t fxs_drifted(uint16_t code, const fxs_motion_rows *motion, const unsigned char *row, uint32_t g,
                                   const fxs_moment *moment)
{
    int32_t sum = 0;
    for (uint32_t k = 0; k < motion->degree; k++, row += 3 * 2 * FXS_CHUNK)
        sum += fxs_mul_q15(fxs_signed_half_at(row, g), moment->power_q15[k]);
    sum = moment->shift >= 0 ? sum * (1 << moment->shift)
                             : (sum + (1 << (-moment->shift - 1))) >> -moment->shift;
    return (uint16_t)fxs_clamp(code + sum, 0, 65535);
}

/* Computes the unit quaternion (1 + a u, b u) / length, Q15, from turn codes in Q14. Before the division, its parts are
   in Q13, at most 24576, so that the square of the length is below 2^31. */
static inline void fxs_turn_at(int32_t turn_q15[4], const unsigned char *row, uint32_t g, int32_t u_q15)
{
    int32_t q_q13[4];
    uint32_t square_q26 = 0;
    for (int i = 0; i < 4; i++, row += 2 * FXS_CHUNK) {
        q_q13[i] = ((fxs_signed_half_at(row, g) * u_q15 + 32768) >> 16) + (i == 0 ? 8192 : 0);
        square_q26 += (uint32_t)(q_q13[i] * q_q13[i]);
    }
    square_q26 = square_q26 ? square_q26 : 1;
    const int zeros = fxs_clz32(square_q26) & ~1;
    const int32_t inverse_q14 = (int32_t)(fxs_rsqrt(square_q26 << zeros) >> 16);
    for (int i = 0; i < 4; i++)
        turn_q15[i] = (2 * q_q13[i] * inverse_q14 + (1 << (15 - zeros / 2))) >> (16 - zeros / 2);
}

/* Rotates a vector v by the unit quaternion (w, q): v + 2 w c + 2 q x c, with c = q x v. */
static inline void fxs_turned(int32_t v_q15[3], const int32_t turn_q15[4])
{
    const int32_t *q = turn_q15 + 1;
    int32_t c_q15[3];
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        c_q15[i] = fxs_mul_q15(q[j], v_q15[k]) - fxs_mul_q15(q[k], v_q15[j]);
    }
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        v_q15[i] += 2 * (fxs_mul_q15(turn_q15[0], c_q15[i]) + fxs_mul_q15(q[j], c_q15[k]) -
                         fxs_mul_q15(q[k], c_q15[j]));
    }
}

static inline uint32_t fxs_turned_word(uint32_t word, int32_t bits, int width, const int32_t turn_q15[4])
{
    fxs_gaussian_axes axes;
    int32_t second_q15[3];
    if (!fxs_read_axes(&axes, word, bits))
        return word;
    for (int i = 0; i < 3; i++)
        second_q15[i] = (axes.side_q15[0][i] * axes.cos_q15 + axes.side_q15[1][i] * axes.sin_q15 + 16384) >> 15;
    fxs_turned(axes.axis_q15, turn_q15);
    fxs_turned(second_q15, turn_q15);
    return fxs_write_axes(axes.axis_q15, second_q15, bits, width);
}

/* Returns how much an opacity code remains at u: 2^-((u - centre) / width)^2, rounded. */
static inline uint32_t fxs_faded(uint32_t code, const fxs_motion_rows *motion, const unsigned char *row, uint32_t g,
                                 int32_t u_q15)
{
    const int32_t away_q13 = ((u_q15 + 2) >> 2) - fxs_signed_half_at(row, g);
    const uint32_t width = fxs_half_at(row + 2 * FXS_CHUNK, g);
    const uint32_t distance_q13 = (uint32_t)(away_q13 < 0 ? -away_q13 : away_q13);
    const uint32_t mantissa_q15 = (uint32_t)fxs_exp2_q15((int32_t)(width & 4095) << 3);
    const int shift = 8 - (int)(width >> 12);
    uint32_t widths_q13 = (distance_q13 * mantissa_q15) >> 15;
    widths_q13 = shift >= 0 ? widths_q13 << shift : widths_q13 >> -shift;
    const uint32_t widths_q12 = widths_q13 < 32767 ? widths_q13 >> 1 : 16383;
    const uint32_t octaves_q16 = widths_q12 * widths_q12 >> 8;
    if (octaves_q16 > motion->cut_q16)
        return 0;
    const uint32_t left_q15 = (uint32_t)fxs_exp2_q15((int32_t)((octaves_q16 & 65535) >> 1)) >> (octaves_q16 >> 16);
    return (code * left_q15 + 16384) >> 15;
}

static inline void fxs_animate_codes(fxs_codes *codes, const fxs_motion_rows *motion, const unsigned char *rows,
                                     uint32_t g, const fxs_moment *moment, enum fxs_profile profile,
                                     uint32_t scale_step_q24)
{
    const unsigned char *drifts = rows + motion->at, *turns = drifts + 6 * FXS_CHUNK * motion->degree;
    const unsigned char *fades = turns + (motion->turns ? 8 * FXS_CHUNK : 0);
    for (uint32_t i = 0; i < 3; i++) {
        const uint16_t drifted = fxs_drifted(codes->position[i], motion, drifts + 2 * FXS_CHUNK * i, g, moment);
        codes->position[i] = profile == FXS_PROFILE_SMALL ? fxs_spread_11(drifted >> 5) : drifted;
    }
    if (motion->fades)
        codes->colour = (codes->colour & 0xffffff) |
                        fxs_faded(codes->colour >> 24, motion, fades, g, moment->power_q15[0]) << 24;
    if (motion->turns && codes->colour >> 24) {
        int32_t fall_q16[3], turn_q15[4];
        for (int i = 0; i < 3; i++)
            fall_q16[i] = fxs_fall_q16(fxs_scale_code(codes->scale, i), scale_step_q24);
        fxs_turn_at(turn_q15, turns, g, moment->power_q15[0]);
        codes->rotation = fxs_turned_word(codes->rotation, fxs_axis_bits(profile, fall_q16),
                                          FXS_ROTATION_BITS(profile), turn_q15);
    }
}

#endif
