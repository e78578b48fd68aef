/* Keeps the Gaussians that a writer gets in memory until all are known. Also codes numbers as integers or 16-bit
   floats. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/fixsplat.h>
#include "src/gaussian/attributes.h"
#include "src/pack/order.h"
#include "scene_write_internal.h"

uint8_t *fxs_put_u32(uint8_t *to, uint32_t value)
{
    for (int shift = 0; shift < 32; shift += 8)
        *to++ = (uint8_t)(value >> shift);
    return to;
}

uint8_t *fxs_put_floats(uint8_t *to, const float *values, size_t n)
{
    for (size_t k = 0; k < n; k++) {
        uint32_t bits;
        memcpy(&bits, &values[k], sizeof bits);
        to = fxs_put_u32(to, bits);
    }
    return to;
}

uint32_t fxs_code_half(double x)
{
    const double size = fmin(fabs(x), 65504);
    int exponent = 0;
    if (!(size > 0))
        return 0;
    frexp(size, &exponent);
    /* 16-bit floats below 2^-14 all have steps of 2^-24, so the exponent is not decreased further */
    exponent = exponent > -13 ? exponent : -13;
    const uint32_t fraction = (uint32_t)floor(ldexp(size, 11 - exponent) + 0.5);
    return (x < 0 ? 0x8000u : 0) | ((uint32_t)(exponent + 13) * 1024 + fraction);
}

uint32_t fxs_code_within(double x, uint32_t most)
{
    x = floor(x + 0.5);
    return x > 0 ? x < most ? (uint32_t)x : most : 0;
}

uint32_t fxs_code_rotation(const float q[4], uint32_t most, uint32_t codes[3])
{
    uint32_t largest = 0;
    for (uint32_t i = 1; i < 4; i++)
        largest = fabsf(q[i]) > fabsf(q[largest]) ? i : largest;
    const double sign = q[largest] < 0 ? -1 : 1;
    for (uint32_t i = 0; i < 4; i++)
        if (i != largest)
            *codes++ = fxs_code_within((sign * q[i] * 0.70710678118654752 + 0.5) * most, most);
    return largest;
}

static void release(fxs_held *h)
{
    free(h->gaussians);
    free(h->sh);
    free(h->order);
}

int fxs_held_open(fxs_held *h, const char *path, const fxs_scene_write_options *o, fxs_message *message)
{
    if (o->count > FXS_MAX_COUNT)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: more than %u Gaussians", path, FXS_MAX_COUNT);
    h->count = (uint32_t)o->count;
    h->coefficients = 3 * (uint32_t)(o->sh_degree * (o->sh_degree + 2));
    const size_t sh_bytes = (size_t)h->count * h->coefficients * sizeof *h->sh;
    h->gaussians = malloc(h->count * sizeof *h->gaussians + 1);
    h->sh = malloc(sh_bytes + 1);
    const int error = h->gaussians && h->sh
                          ? fxs_output_open(&h->output, path, o->count, message)
                          : fxs_fail_memory(message, path, h->count * sizeof *h->gaussians + sh_bytes);
    if (error)
        release(h);
    return error;
}

void fxs_held_set(fxs_held_gaussian *to, int16_t *sh, const fxs_gaussian *g, uint32_t coefficients)
{
    double norm = 0;
    memcpy(to->position, g->position, sizeof to->position);
    memcpy(to->dc, g->dc, sizeof to->dc);
    for (int i = 0; i < 3; i++)
        to->scale[i] = fminf(fmaxf(g->scale[i], -20), 20);
    for (int i = 0; i < 4; i++)
        norm += (double)g->rotation[i] * g->rotation[i];
    for (int i = 0; i < 4; i++)
        to->rotation[i] = (float)(g->rotation[i] / sqrt(norm));
    to->opacity = (float)(fxs_opacity_of_logit(g->opacity));
    for (uint32_t k = 0; k < coefficients; k++)
        sh[k] = (int16_t)fmin(fmax(floor((double)g->sh[k] * FXS_HELD_SH_ONE + 0.5), INT16_MIN), INT16_MAX);
}

void fxs_held_get(const fxs_held_gaussian *held, const int16_t *sh, fxs_gaussian *g, uint32_t coefficients)
{
    memset(g, 0, sizeof *g);
    memcpy(g->position, held->position, sizeof g->position);
    memcpy(g->scale, held->scale, sizeof g->scale);
    memcpy(g->rotation, held->rotation, sizeof g->rotation);
    memcpy(g->dc, held->dc, sizeof g->dc);
    g->opacity = fxs_logit_of_opacity((double)held->opacity);
    for (uint32_t k = 0; k < coefficients; k++)
        g->sh[k] = (float)sh[k] / FXS_HELD_SH_ONE;
}

int fxs_held_put(fxs_held *h, const fxs_gaussian *gaussians, size_t n, fxs_message *message)
{
    FXS_TRY(fxs_output_expect(&h->output, n, message));
    for (size_t i = 0; i < n; i++, h->next++)
        fxs_held_set(&h->gaussians[h->next], h->sh + (size_t)h->next * h->coefficients, &gaussians[i], h->coefficients);
    return 0;
}

static void run(void *pool, void (*job)(void *argument, uint32_t i), void *argument, uint32_t jobs)
{
    (void)pool;
    for (uint32_t i = 0; i < jobs; i++)
        job(argument, i);
}

int fxs_held_order(fxs_held *h)
{
    const fxs_pack_options options = {.size = sizeof(fxs_pack_options), .workers.run = run, .workers.count = 1};
    if (h->next != h->count || h->output.error)
        return 0;
    fxs_order_entry *entries = calloc((size_t)h->count + 1, sizeof *entries);
    h->order = malloc(((size_t)h->count + 1) * sizeof *h->order);
    for (uint32_t i = 0; i < h->count && entries; i++)
        memcpy(entries[i].position, h->gaussians[i].position, sizeof entries[i].position);
    if (!entries || !h->order || (h->count && fxs_order(entries, h->count, 0, &options)))
        h->output.error = ENOMEM;
    for (uint32_t i = 0; i < h->count && !h->output.error; i++)
        h->order[i] = entries[i].index;
    free(entries);
    return !h->output.error;
}

int fxs_held_close(fxs_held *h, fxs_message *message)
{
    const int result = fxs_output_close(&h->output, message);
    release(h);
    return result;
}
