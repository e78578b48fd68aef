/* Converts the renderer's input to doubles for the reference renderer. */
#ifndef IN_DOUBLES_H
#define IN_DOUBLES_H

#include <math.h>

#include "src/core/chunk.h"
#include "check.h"
#include "reference.h"
#include "rotation_word.h"

static inline fxs_view view_of(const fxs_camera *camera)
{
    fxs_view view = {"", camera->width, camera->height, ldexp(camera->fx_q12, -12), ldexp(camera->fy_q12, -12),
                          ldexp(camera->cx_q12, -12), ldexp(camera->cy_q12, -12), {0}, {0},
                          ldexp((double)camera->near_q32, -32), camera->projection, 0};
    for (int i = 0; i < 9; i++)
        view.rotation[i] = ldexp(camera->rotation_q30[i], -30);
    for (int i = 0; i < 3; i++)
        view.position[i] = ldexp((double)camera->position_q32[i], -32);
    return view;
}

static inline struct reference_object object_in_doubles(const fxs_object *object)
{
    struct reference_object o = {.scale = ldexp((double)object->scale_q32, -32),
                                 .opacity = object->visible ? ldexp(object->opacity_q16, -16) : 0};
    for (int i = 0; i < 9; i++)
        o.rotation[i] = ldexp(object->rotation_q30[i], -30);
    for (int i = 0; i < 3; i++) {
        o.translation[i] = ldexp((double)object->translation_q32[i], -32);
        o.tint[i] = ldexp(object->tint_q13[i], -13);
    }
    return o;
}

static inline fxs_gaussian decode(const fxs_scene *scene, uint32_t index)
{
    const unsigned char *rows = fxs_rows(scene, index / FXS_CHUNK);
    fxs_chunk header, *chunk = &header;
    const uint16_t *position = (const uint16_t *)(const void *)(rows + FXS_ROW_POSITION);
    const int8_t *sh = (const int8_t *)rows + FXS_ROW_SH;
    const uint32_t at = index % FXS_CHUNK;
    CHECK(fxs_chunk_read(&header, scene, index / FXS_CHUNK) == 0);
    uint32_t rotation, scale, colour;
    memcpy(&rotation, rows + FXS_ROW_ROTATION + 4 * at, 4);
    memcpy(&scale, rows + FXS_ROW_SCALE + 4 * at, 4);
    memcpy(&colour, rows + FXS_ROW_COLOUR + 4 * at, 4);
    fxs_gaussian g;
    memset(&g, 0, sizeof g);
    for (int i = 0; i < 3; i++) {
        double code = i < 2 ? scale >> 10 * i & 1023 : (scale >> 20 & 511) * 2;
        g.position[i] = (float)(ldexp((double)chunk->origin_q32[i], -32) + position[(uint32_t)i * FXS_CHUNK + at] *
                                ldexp(chunk->step_q32[i], (int)chunk->step_shift - 32));
        g.scale[i] = (float)(log(2) * (ldexp(chunk->scale_q16, -16) - code * code * ldexp(chunk->scale_step_q24, -24)));
        g.dc[i] =
            (float)((ldexp(chunk->colour_q16[i], -16) - 0.5 +
                     ((colour >> 8 * i & 255) * 2 + (scale >> (29 + i) & 1)) * ldexp(chunk->colour_step_q20[i], -20)) /
                    0.28209479177387814);
    }
    double q[4];
    word_quaternion(q, rotation, axis_bits_of_word(0, scale, chunk->scale_step_q24));
    for (int i = 0; i < 4; i++)
        g.rotation[i] = (float)q[i];
    const double part = ((colour >> 24) - 1.0) / 254, top = ldexp(1, 2 - 2 * header.opacity_law);
    double opacity = header.opacity_law && colour >> 24 ? 1 / 255.0 + (top - 1 / 255.0) * part * part
                                                        : (colour >> 24) / 255.0;
    g.opacity = (float)fmax(-50, fmin(50, log(opacity / (1 - opacity))));
    for (int k = 0; k < FXS_SH_COUNT(scene->sh_degree); k++)
        for (int c = 0; c < 3; c++)
            g.sh[3 * k + c] = (float)(sh[(3 * k + c) * FXS_CHUNK + (int)at] *
                                      ldexp(chunk->sh_step_q19[k < 3 ? 0 : k < 8 ? 1 : 2], -19));
    return g;
}

#endif
