/* The mean of several pictures in linear light, by sums of integers, and the points of a lens. */
#include "samples.h"

#include "src/base/exponential.h"
#include "src/base/sine.h"

/* Converts sRGB c (0 to 1) to linear light (IEC 61966-2-1): c / 12.92 up to 0.04045, else ((c + 0.055) / 1.055)^2.4. */
static double light_of(double c)
{
    return c > 0.04045 ? fxs_exp(2.4 * fxs_log((c + 0.055) / 1.055)) : c / 12.92;
}

void light_codes_make(light_codes *codes, int is_srgb)
{
    for (int i = 0; i < 256; i++)
        codes->light[i] = (uint16_t)(65535 * (is_srgb ? light_of(i / 255.0) : i / 255.0) + 0.5);
    for (int light = 0, code = 0; light < 65536; light++) {
        while (code < 255 && 2 * light >= codes->light[code] + codes->light[code + 1])
            code++;
        codes->code[light] = (uint8_t)code;
    }
}

void light_add(light_sums *sums, const light_codes *codes, const uint8_t *rgba, size_t first, size_t count, int sample)
{
    for (size_t i = first; i < first + count; i++)
        sums->sums[i] = (sample ? sums->sums[i] : 0) + codes->light[rgba[i]];   /* <= 1024 * 65535 */
}

void light_mean(const light_sums *sums, const light_codes *codes, int samples, size_t first, size_t count,
                uint8_t *rgba)
{
    const uint32_t n = (uint32_t)samples;
    for (size_t i = first; i < first + count; i++)
        rgba[i] = codes->code[(sums->sums[i] + n / 2) / n];
}

static int common_divisor(int a, int b)
{
    return b ? common_divisor(b, a % b) : a;
}

/* Point k of n lies at sqrt((k + 1/2) / n) of the radius, and k golden angles around (Vogel's spiral). Samples take
   the points in steps of about 0.618 n, so that in a film the time of a sample says nothing of its place. */
void lens_move(fxs_view *view, double aperture, double focus, int sample, int samples)
{
    int step = (int)(0.618 * samples) + 1;
    while (common_divisor(samples, step) > 1)
        step++;
    const int k = (int)((int64_t)sample * step % samples);
    const double radius = aperture / 2 * sqrt((k + 0.5) / samples), turns = 0.38196601125010515 * k;
    const double x = radius * fxs_sine(turns + 0.25), y = radius * fxs_sine(turns);
    for (int i = 0; i < 3; i++)
        view->position[i] += x * view->rotation[i] + y * view->rotation[3 + i];
    view->cx += view->fx * x / focus;
    view->cy += view->fy * y / focus;
}
