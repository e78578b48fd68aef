/* Decodes packed Gaussians to floats by the formulas of docs/format.md. */
#include "decode.h"

#include <math.h>
#include <string.h>

#include "src/gaussian/tilt.h"
#include "src/core/animate.h"

#define LN_2 0.69314718055994531

/* Decodes opacity code c by a quantisation law. Law 0: c / 255. Other laws: 0 for c = 0, else 1/255 + (4^(1 - law)
   - 1/255) ((c - 1) / 254)^2. */
static double opacity_of(uint32_t code, uint32_t law)
{
    static const double tops[FXS_OPACITY_LAWS] = {4, 1, 0.25, 0.0625};
    const double part = (code - 1.0) / 254, top = tops[law];
    return law == 0 ? code / 255.0 : code == 0 ? 0 : 1 / 255.0 + (top - 1 / 255.0) * part * part;
}

/* Computes a Gaussian's rotation as a quaternion w, x, y, z. It is a product of three rotations: +z to the first axis,
   the roll about z, and the permutation of x, y, z to z, x, y. */
static void take_rotation(const fxs_scene *s, const fxs_chunk *chunk, const fxs_codes *codes, float rotation[4])
{
    int32_t fall_q16[3];
    double cosine, sine;
    for (int i = 0; i < 3; i++)
        fall_q16[i] = fxs_fall_q16(fxs_scale_code(codes->scale, i), chunk->scale_step_q24);
    const fxs_tilt a = fxs_tilt_of_word(codes->rotation, fxs_axis_bits(s->profile, fall_q16));
    const double rest = 2 - a.x * a.x - a.y * a.y, half = sqrt(0.5), w = sqrt(rest > 0 ? rest : 0) * half;
    fxs_tilt_roll(a.roll, &cosine, &sine);
    const double c = sqrt((1 + cosine) / 2), d = sine / (2 * c), x = -a.y * half, y = a.x * half;
    const double q[4] = {w * c, x * c + y * d, y * c - x * d, w * d};
    rotation[0] = (float)((q[0] + q[1] + q[2] + q[3]) / 2);
    rotation[1] = (float)((q[1] - q[0] - q[2] + q[3]) / 2);
    rotation[2] = (float)((q[2] - q[0] - q[3] + q[1]) / 2);
    rotation[3] = (float)((q[3] - q[0] - q[1] + q[2]) / 2);
}

/* Decodes SH coefficients of file profile default: a coefficient of degree d is code * sh_step[d - 1]. */
static void take_bands(const fxs_scene *s, const fxs_chunk *chunk, const unsigned char *rows, uint32_t g, float sh[45])
{
    for (int k = 0; k < 3 * FXS_SH_COUNT(s->sh_degree); k++)
        sh[k] = (float)((int8_t)rows[FXS_ROW_SH + (uint32_t)k * FXS_CHUNK + g] *
                        (chunk->sh_step_q19[k < 9 ? 0 : k < 24 ? 1 : 2] * 0x1p-19));
}

/* Decodes SH coefficients of the file profiles compact and small: a coefficient is the chunk's mean plus an entry of
   each palette. Compact adds (2 code + 1) gain, where gain = (8 + (g mod 8)) 2^(floor(g / 8) - 32) for gain code g. */
static void take_palette(const fxs_scene *s, const fxs_chunk *chunk, const unsigned char *rows, uint32_t g,
                         float sh[45])
{
    const unsigned char *record = fxs_sh_record(s, rows, g);
    const int is_compact = s->profile == FXS_PROFILE_COMPACT, count = FXS_SH_COUNT(s->sh_degree);
    const double gain = is_compact ? ldexp(8 + record[FXS_GAIN_BYTE] % 8, record[FXS_GAIN_BYTE] / 8 - 32) : 0;
    for (int c = 0; c < 3; c++) {
        const uint64_t residual = is_compact ? fxs_residual(record, s->sh_degree, c) : 0;
        for (int k = 0; k < count; k++) {
            int sum = chunk->sh_mean[16 * c + k];
            for (uint32_t stage = 0; stage < fxs_palette_stages(s->profile, s->sh_degree); stage++) {
                const int number = fxs_palette_entry(s, stage, record[stage])[16 * c + k];
                sum += record[stage] & FXS_PALETTE_NEGATIVE ? -number : number;
            }
            const int code = (int)(residual >> 3 * k & 7);
            sh[3 * k + c] = (float)(sum * (s->palette_step_q19 * 0x1p-19) +
                                    (2 * (code < 4 ? code : code - 8) + 1) * gain);
        }
    }
}

void fxs_decode(const fxs_scene *s, const fxs_chunk *chunk, const unsigned char *rows, uint32_t g, fxs_gaussian *out)
{
    const fxs_codes codes = fxs_codes_of(s, rows, g);
    memset(out, 0, sizeof *out);
    for (int i = 0; i < 3; i++) {
        const uint32_t scale = fxs_scale_code(codes.scale, i);
        out->scale[i] = (float)(LN_2 * (chunk->scale_q16 * 0x1p-16 -
                                        (double)scale * scale * chunk->scale_step_q24 * 0x1p-24));
    }
    fxs_decode_point(chunk, &codes, out->position, out->dc);
    take_rotation(s, chunk, &codes, out->rotation);
    out->opacity = fxs_logit_of_opacity(opacity_of(codes.colour >> 24, chunk->opacity_law));
    if (s->profile == FXS_PROFILE_DEFAULT)
        take_bands(s, chunk, rows, g, out->sh);
    else if (s->sh_degree)
        take_palette(s, chunk, rows, g, out->sh);
}

/* Decodes the polynomial of one axis, about the middle of the chunk's time, and develops it about `centre`. Both are in
   units of u. */
static void take_drift(const fxs_motion_rows *how, const fxs_chunk_motion *m, const fxs_chunk *chunk,
                       const unsigned char *row, uint32_t g, int axis, double centre, float *position,
                       float drift[3][3])
{
    const double step = ldexp((double)chunk->step_q32[axis], (int)chunk->step_shift - 32 + m->shift);
    const double seconds = ldexp(1, m->unit - 16);
    double a[3] = {0, 0, 0};
    for (uint32_t k = 0; k < how->degree; k++)
        a[k] = step * fxs_signed_half_at(row + 2 * FXS_CHUNK * (3 * k + (uint32_t)axis), g);
    *position = (float)(*position + centre * (a[0] + centre * (a[1] + centre * a[2])));
    drift[0][axis] = (float)((a[0] + centre * (2 * a[1] + 3 * centre * a[2])) / seconds);
    drift[1][axis] = (float)((a[1] + 3 * centre * a[2]) / (seconds * seconds));
    drift[2][axis] = (float)(a[2] / (seconds * seconds * seconds));
}

/* turn codes T: rotation(u) = (1 + T u) rotation(0), as a product of quaternions. */
static void take_turn(const unsigned char *row, uint32_t g, double centre, double seconds, float r[4], float turn[4])
{
    double t[4], q[4] = {(double)r[0], (double)r[1], (double)r[2], (double)r[3]};
    for (int i = 0; i < 4; i++)
        t[i] = fxs_signed_half_at(row + 2 * FXS_CHUNK * i, g) * 0x1p-14;
    double d[4];
    fxs_quaternion_product(d, t, q);
    for (int i = 0; i < 4; i++) {
        r[i] = (float)(q[i] + d[i] * centre);
        turn[i] = (float)(d[i] / seconds);
    }
}

void fxs_decode_motion(const fxs_motion_rows *how, const fxs_motion_header *header, const fxs_chunk_motion *m,
                       const fxs_chunk *chunk, const unsigned char *rows, uint32_t g, fxs_gaussian *out,
                       fxs_motion *motion)
{
    const unsigned char *row = rows + how->at, *turns = row + 6 * FXS_CHUNK * how->degree;
    const unsigned char *fades = turns + (how->turns ? 8 * FXS_CHUNK : 0);
    const double seconds = ldexp(1, m->unit - 16), middle = ldexp(m->middle_q16, -16);
    const double centre = how->fades ? fxs_signed_half_at(fades, g) * 0x1p-13 : 0;
    const uint32_t width = how->fades ? fxs_half_at(fades + 2 * FXS_CHUNK, g) : 65535;
    memset(motion, 0, sizeof *motion);
    for (int i = 0; i < 3; i++)
        take_drift(how, m, chunk, row, g, i, centre, &out->position[i], motion->drift);
    if (how->turns)
        take_turn(turns, g, centre, seconds, out->rotation, motion->turn);
    motion->centre = (float)(middle + centre * seconds);
    motion->fade = width == 65535 ? INFINITY : (float)(exp2(width / 4096.0 - 8) * seconds * sqrt(1.4426950408889634));
    motion->from = m->from_q16 <= 0 ? -INFINITY : (float)ldexp(m->from_q16, -16);
    motion->to = (uint32_t)m->to_q16 > header->duration_q16 && m->to_q16 > 0 ? INFINITY : (float)ldexp(m->to_q16, -16);
}
