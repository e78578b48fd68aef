/* Decodes packed Gaussians to floats by the formulas of docs/format.md. */
#include "decode.h"

#include <math.h>
#include <string.h>

#include "src/gaussian/tilt.h"
#include "src/core/codes.h"
#include "src/gaussian/attributes.h"

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
        const uint32_t scale = fxs_scale_code(codes.scale, i), colour = fxs_colour_code(&codes, i);
        const int64_t steps = (int64_t)codes.position[i] * chunk->step_q32[i] << chunk->step_shift;
        out->position[i] = (float)((double)(chunk->origin_q32[i] + steps) * 0x1p-32);
        out->scale[i] = (float)(LN_2 * (chunk->scale_q16 * 0x1p-16 -
                                        (double)scale * scale * chunk->scale_step_q24 * 0x1p-24));
        out->dc[i] = fxs_dc_of_colour(chunk->colour_q16[i] * 0x1p-16 +
                                      (double)colour * chunk->colour_step_q20[i] * 0x1p-20);
    }
    take_rotation(s, chunk, &codes, out->rotation);
    out->opacity = fxs_logit_of_opacity(opacity_of(codes.colour >> 24, chunk->opacity_law));
    if (s->profile == FXS_PROFILE_DEFAULT)
        take_bands(s, chunk, rows, g, out->sh);
    else if (s->sh_degree)
        take_palette(s, chunk, rows, g, out->sh);
}
