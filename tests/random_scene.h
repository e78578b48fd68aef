/* Makes random packed scenes and random cameras. */
#ifndef RANDOM_SCENE_H
#define RANDOM_SCENE_H

#include <stdlib.h>
#include <string.h>

#include <fixsplat/fixsplat.h>
#include "packed_scene.h"

static uint64_t state;

/* Random generator splitmix64 (Steele, Lea, Flood 2014). */
static uint64_t next(void)
{
    uint64_t z = state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

static int32_t between(int32_t low, int32_t high)
{
    return low + (int32_t)(next() % (uint64_t)((int64_t)high - low + 1));
}

static void fill_words(void *out, size_t bytes)
{
    for (size_t at = 0; at < bytes; at += 4) {
        uint32_t word = fxs_little_32((uint32_t)next());
        memcpy((unsigned char *)out + at, &word, 4);
    }
}

static void fill_chunk(const packed_scene *s, uint32_t c)
{
    fxs_chunk *chunk = &s->chunks[c];
    for (int i = 0; i < 3; i++) {
        chunk->origin_q32[i] = (int64_t)between(-3145728, 3145728) * 4096;
        uint32_t step_q32 = (uint32_t)next();
        chunk->step_q32[i] = step_q32 >> between(8, 20);
        chunk->colour_q16[i] = between(-20000, 60000);
        chunk->colour_step_q20[i] = (uint32_t)between(0, 4000);
        chunk->sh_step_q19[i] = (uint16_t)between(0, 2000);
    }
    chunk->scale_q16 = between(-393216, 65536);
    chunk->scale_step_q24 = (uint16_t)between(0, 200);
    fill_words(packed_scene_rows(s, c), s->header->chunk_bytes);
    if (s->header->profile == FXS_PROFILE_DEFAULT)
        return;
    chunk->opacity_law = (uint16_t)between(0, FXS_OPACITY_LAWS - 1);
    for (size_t i = 0; i < sizeof chunk->sh_mean; i++)
        chunk->sh_mean[i] = (int8_t)between(-128, 127);
}

/* Makes a random packed scene of 1 to `most` Gaussians. The caller releases its data with free. */
static inline packed_scene random_scene(enum fxs_profile profile, int32_t most)
{
    int degree = between(0, 3);
    uint32_t count = (uint32_t)between(1, most);
    packed_scene s = packed_scene_make(profile, degree, count, between(0, 1));
    for (uint32_t c = 0; c < s.header->chunk_count; c++)
        fill_chunk(&s, c);
    if (s.palette) {
        s.header->palette_step_q19 = (uint32_t)between(0, 2000);
        fill_words(s.palette, (size_t)(s.rows - (unsigned char *)s.palette));
    }
    if (packed_scene_finish(&s))
        abort();
    return s;
}

/* Gives the chunks of a packed scene any numbers that it allows. */
static inline void fill_wild(const packed_scene *s)
{
    for (uint32_t c = 0; c < s->header->chunk_count; c++) {
        fxs_chunk *chunk = &s->chunks[c];
        do {
            const int places = between(0, 58);
            for (int i = 0; i < 3; i++) {
                chunk->origin_q32[i] = (int64_t)next() >> (63 - places) >> 3;
                chunk->step_q32[i] = (uint32_t)next() >> between(0, 31);
                chunk->colour_q16[i] = between(-(64 << 16), 64 << 16);
                chunk->colour_step_q20[i] = (uint32_t)between(0, 1 << 17);
                chunk->sh_step_q19[i] = (uint16_t)between(0, 32767);
            }
            chunk->step_shift = (uint16_t)between(0, 12);
            chunk->scale_q16 = between(-(32 << 16), 32 << 16);
            chunk->scale_step_q24 = (uint16_t)between(0, 1026);
        } while (!fxs_chunk_valid(chunk));
    }
}

/* Makes a camera that is rotated about one axis by an angle with a rational sine and cosine. */
static void random_camera(fxs_camera *camera)
{
    static const int32_t triples[][3] = {{1, 0, 1}, {3, 4, 5}, {5, 12, 13}, {8, 15, 17}, {-7, 24, 25}, {-20, 21, 29}};
    const int32_t *t = triples[between(0, 5)];
    int32_t c = (int32_t)(t[0] * (INT64_C(1) << 30) / t[2]), s = (int32_t)(t[1] * (INT64_C(1) << 30) / t[2]);
    int axis = between(0, 2), a = (axis + 1) % 3, b = (axis + 2) % 3;
    memset(camera, 0, sizeof *camera);
    camera->rotation_q30[axis * 4] = 1 << 30;
    camera->rotation_q30[a * 3 + a] = camera->rotation_q30[b * 3 + b] = c;
    camera->rotation_q30[a * 3 + b] = -s;
    camera->rotation_q30[b * 3 + a] = s;
    camera->width = between(1, 100);
    camera->height = between(1, 80);
    camera->fx_q12 = between(20 << 12, 200 << 12);
    camera->fy_q12 = camera->fx_q12 + between(0, 10 << 12);
    camera->cx_q12 = camera->width * 2048 + between(-40000, 40000);
    camera->cy_q12 = camera->height * 2048;
    for (int i = 0; i < 3; i++)
        camera->position_q32[i] = (int64_t)between(-4194304, 4194304) * 4096;
}

static inline void random_near(fxs_camera *camera)
{
    camera->near_q32 = (int64_t)between(4096, 8191) << between(0, 22);
}

/* Places the second eye beside the first, with a field of view of its own. */
static inline void random_other_eye(fxs_camera cameras[2])
{
    const int32_t wider_q12 = between(0, 8 << 12);
    cameras[1] = cameras[0];
    cameras[1].position_q32[between(0, 2)] += (int64_t)between(-65536, 65536) * (1 << between(4, 16));
    cameras[1].fx_q12 += wider_q12;
    cameras[1].fy_q12 += wider_q12;
    cameras[1].cx_q12 += between(-200000, 200000);
    cameras[1].cy_q12 += between(-200000, 200000);
}

static inline void random_view(fxs_camera *camera, fxs_options *options)
{
    random_camera(camera);
    fxs_options_init(options);
    options->cutoff = (enum fxs_cutoff)(between(0, 3) == 0);
    options->sh_degree = between(0, 3);
    for (int c = 0; c < 3; c++)
        options->background[c] = (uint8_t)between(0, 255);
    if (between(0, 3) == 0) {
        camera->projection = FXS_ORTHOGRAPHIC;
        camera->fx_q12 = camera->fy_q12 = between(2 << 12, 40 << 12);
    }
}

#endif
