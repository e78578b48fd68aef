/* Takes a sample of the Gaussians of objects. Every step-th Gaussian becomes a point, and some points are packed again
   for drawing, in profile default with SH degree 0. It uses fixed point and exact doubles only. */
#include "sample.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/fixed.h>
#include "src/gaussian/tilt.h"
#include "src/core/codes.h"

typedef struct loose {
    int64_t position_q32[3];
    int32_t scale_q16[3];            /* log2(sigma) */
    int32_t colour_q16[3];
    uint32_t rotation;
    int32_t axis_bits;               /* number of bits of x and of y in the rotation word */
    uint32_t opacity;                /* opacity, 0 to 255 */
} loose;

/* Decodes an opacity code c to 0..255. Law 0: c. Laws 1 to 3: 1 + (255 * 4^(1 - law) - 1) ((c - 1) / 254)^2. */
static uint32_t opacity_of(uint32_t code, uint32_t law)
{
    static const uint32_t reach_q4[FXS_OPACITY_LAWS] = {0, 254 * 16, 1004, 239};   /* factors of the opacity laws in Q4:
                                                                                      255 * 4^(1 - law) - 1 */
    if (law == 0 || code == 0)
        return code;
    return 1 + (reach_q4[law] * (code - 1) * (code - 1) + 254 * 254 * 8) / (254 * 254 * 16);
}

static int32_t axis_bits_of(enum fxs_profile profile, uint32_t scale_word, uint32_t scale_step_q24)
{
    int32_t fall_q16[3];
    for (int i = 0; i < 3; i++)
        fall_q16[i] = fxs_fall_q16(fxs_scale_code(scale_word, i), scale_step_q24);
    return fxs_axis_bits(profile, fall_q16);
}

static loose loosen(enum fxs_profile profile, const fxs_chunk *chunk, const fxs_codes *codes)
{
    loose l = {.rotation = codes->rotation, .opacity = opacity_of(codes->colour >> 24, chunk->opacity_law),
               .axis_bits = axis_bits_of(profile, codes->scale, chunk->scale_step_q24)};
    for (int i = 0; i < 3; i++) {
        const uint32_t scale = fxs_scale_code(codes->scale, i), colour = fxs_colour_code(codes, i);
        l.position_q32[i] = chunk->origin_q32[i] +
                            ((int64_t)((uint64_t)codes->position[i] * chunk->step_q32[i]) << chunk->step_shift);
        l.scale_q16[i] = chunk->scale_q16 - (int32_t)((uint64_t)scale * scale * chunk->scale_step_q24 >> 8);
        l.colour_q16[i] = chunk->colour_q16[i] + (int32_t)((uint64_t)colour * chunk->colour_step_q20[i] >> 4);
    }
    return l;
}

/* Power of two: returns 2^(x / 65536). */
static double exp2_of(int32_t x_q16)
{
    const int32_t whole = -(-x_q16 >> 16);
    return ldexp(fxs_exp2_q15((int32_t)((int64_t)whole * 65536 - x_q16) >> 1), whole - 15);
}

static void turn(const fxs_object *o, const double in[3], double out[3])
{
    for (int i = 0; i < 3; i++) {
        out[i] = 0;
        for (int k = 0; k < 3; k++)
            out[i] += ldexp((double)o->rotation_q30[3 * i + k], -30) * in[k];
    }
}

static fxs_sample_point point_of(const fxs_object *o, const loose *l)
{
    const double scale = ldexp((double)o->scale_q32, -32);
    const int32_t *s = l->scale_q16;
    const int thin = s[0] <= s[1] && s[0] <= s[2] ? 0 : s[1] <= s[2] ? 1 : 2;
    const int a = (thin + 1) % 3, b = (thin + 2) % 3, middle = s[a] < s[b] ? a : b;
    const fxs_tilt axes = fxs_tilt_of_word(l->rotation, l->axis_bits);
    double axis[3][3], place[3], normal[3];
    fxs_sample_point p;
    fxs_tilt_directions(&axes, axis);
    for (int i = 0; i < 3; i++) {
        place[i] = ldexp((double)l->position_q32[i], -32);
        normal[i] = axis[thin][i];
    }
    turn(o, place, p.place);
    turn(o, normal, p.normal);
    for (int i = 0; i < 3; i++)
        p.place[i] = p.place[i] * scale + ldexp((double)o->translation_q32[i], -32);
    p.size = exp2_of((s[a] + s[b]) / 2) * scale;
    p.flatness = fmax(1 - exp2_of(s[thin] - s[middle]) - 1 / 32.0, 0);   /* 1/32 is subtracted, because quantised
                                                                            spheres are slightly flat */
    p.opacity = l->opacity / 255.0 * ldexp((double)o->opacity_q16, -16);
    return p;
}

static uint64_t step_for(uint64_t reach, uint32_t codes)
{
    return (reach + codes - 1) / codes;
}

static void put_half(unsigned char *row, uint32_t g, uint64_t code)
{
    const uint16_t half = fxs_little_16((uint16_t)code);
    memcpy(row + 2 * g, &half, sizeof half);
}

static void put_word(unsigned char *row, uint32_t g, uint32_t word)
{
    word = fxs_little_32(word);
    memcpy(row + 4 * g, &word, sizeof word);
}

static void pack_positions(fxs_chunk *chunk, const loose *l, uint32_t count, unsigned char *rows)
{
    uint64_t reach[3], most = 0;
    for (int i = 0; i < 3; i++) {
        int64_t low = INT64_MAX, high = INT64_MIN;
        for (uint32_t g = 0; g < count; g++) {
            low = l[g].position_q32[i] < low ? l[g].position_q32[i] : low;
            high = l[g].position_q32[i] > high ? l[g].position_q32[i] : high;
        }
        chunk->origin_q32[i] = low;
        reach[i] = (uint64_t)(high - low);
        most = reach[i] > most ? reach[i] : most;
    }
    while (step_for(most >> chunk->step_shift, 65535) >= UINT32_MAX - 1)
        chunk->step_shift++;
    for (int i = 0; i < 3; i++) {
        const uint64_t step = step_for(reach[i] >> chunk->step_shift, 65535) + 1;
        chunk->step_q32[i] = (uint32_t)step;
        for (uint32_t g = 0; g < count; g++)
            put_half(rows + FXS_ROW_POSITION + 2 * FXS_CHUNK * i, g,
                     ((uint64_t)(l[g].position_q32[i] - chunk->origin_q32[i]) >> chunk->step_shift) / step);
    }
}

static uint32_t recoded(uint32_t word, int32_t from, int32_t to)
{
    const uint32_t half = 1u << (31 - to), roll = ((word << 2 * from) + (1u << (2 * to - 1))) >> 2 * to;
    const uint32_t y = ((word << from) - (roll << to) + half) >> (32 - to) << (32 - 2 * to) | roll;
    return (word - y + half) >> (32 - to) << (32 - to) | y;
}

/* Packs the sizes of Gaussians, after adding larger_q16 to all log2(sigma). The code of a size x is sqrt((scale - x) /
   step). */
static void pack_scales(fxs_chunk *chunk, const loose *l, uint32_t count, int32_t larger_q16, unsigned char *rows)
{
    int32_t low = INT32_MAX, high = INT32_MIN;
    for (uint32_t g = 0; g < count; g++)
        for (int i = 0; i < 3; i++) {
            low = l[g].scale_q16[i] < low ? l[g].scale_q16[i] : low;
            high = l[g].scale_q16[i] > high ? l[g].scale_q16[i] : high;
        }
    chunk->scale_q16 = high + larger_q16;
    chunk->scale_step_q24 = (uint16_t)(step_for((uint64_t)(high - low) << 8, 1022 * 1022) + 1);
    for (uint32_t g = 0; g < count; g++) {
        uint32_t word = 0, code[3];
        for (int i = 0; i < 3; i++)
            code[i] = fxs_sqrt(((uint32_t)(high - l[g].scale_q16[i]) << 8) / chunk->scale_step_q24);
        word = code[0] | code[1] << 10 | code[2] >> 1 << 20;
        put_word(rows + FXS_ROW_SCALE, g, word);
        put_word(rows + FXS_ROW_ROTATION, g,
                 recoded(l[g].rotation, l[g].axis_bits,
                         axis_bits_of(FXS_PROFILE_DEFAULT, word, chunk->scale_step_q24)));
    }
}

/* Packs the colours of Gaussians. Call it after pack_scales, because scale words hold the lowest colour bits. */
static void pack_colours(fxs_chunk *chunk, const loose *l, uint32_t count, unsigned char *rows)
{
    uint32_t words[FXS_CHUNK], scales[FXS_CHUNK];
    for (uint32_t g = 0; g < count; g++) {
        words[g] = l[g].opacity << 24;
        scales[g] = fxs_word_at(rows + FXS_ROW_SCALE, g);
    }
    for (int i = 0; i < 3; i++) {
        int32_t low = INT32_MAX, high = INT32_MIN;
        for (uint32_t g = 0; g < count; g++) {
            low = l[g].colour_q16[i] < low ? l[g].colour_q16[i] : low;
            high = l[g].colour_q16[i] > high ? l[g].colour_q16[i] : high;
        }
        chunk->colour_q16[i] = low;
        chunk->colour_step_q20[i] = (uint32_t)step_for((uint64_t)(high - low) << 4, FXS_COLOUR_MOST) + 1;
        for (uint32_t g = 0; g < count; g++) {
            const uint32_t code = ((uint32_t)(l[g].colour_q16[i] - low) << 4) / chunk->colour_step_q20[i];
            words[g] |= code >> 1 << (8 * i);
            scales[g] |= (code & 1) << (29 + i);
        }
    }
    for (uint32_t g = 0; g < count; g++) {
        put_word(rows + FXS_ROW_COLOUR, g, words[g]);
        put_word(rows + FXS_ROW_SCALE, g, scales[g]);
    }
}

/* Packs a chunk of 256 Gaussians. Unused slots keep opacity 0. */
static void pack_chunk(unsigned char *header, unsigned char *rows, const loose *l, uint32_t count, int32_t larger_q16)
{
    fxs_chunk chunk = {{0}, {0}, 0, {0}, {0}, 0, {0}, 0, 0, 0, {0}};
    memset(rows, 0, fxs_chunk_bytes(FXS_PROFILE_DEFAULT, 0));
    pack_positions(&chunk, l, count, rows);
    pack_scales(&chunk, l, count, larger_q16, rows);
    pack_colours(&chunk, l, count, rows);
    fxs_chunk_turn(&chunk);
    memcpy(header, &chunk, sizeof chunk);
}

typedef struct taking {
    fxs_sample *sample;
    unsigned char *headers, *rows;
    uint64_t step, next;
    uint32_t each;
    int32_t larger_q16;
} taking;

static uint64_t drawn(const fxs_object *o)
{
    return o->visible ? o->scene->count : 0;
}

static int is_kept(const fxs_object *o, const int64_t p[3])
{
    int keeps = 0, kept = 0;
    for (uint32_t c = 0; c < o->crop_count; c++) {
        const fxs_crop *b = &o->crops[c];
        int inside = 1;
        for (int i = 0; i < 3; i++)
            inside &= p[i] >= b->low_q32[i] && p[i] <= b->high_q32[i];
        if (b->outside && inside)
            return 0;
        keeps |= !b->outside;
        kept |= inside;
    }
    return kept || !keeps;
}

static void end_chunk(taking *t, fxs_scene *scene, const loose *l, uint32_t count)
{
    if (count == 0)
        return;
    pack_chunk(t->headers, t->rows, l, count, t->larger_q16);
    t->headers += sizeof(fxs_chunk);
    t->rows += scene->chunk_bytes;
    scene->chunk_count++;
    scene->count += count;
}

static int take_object(taking *t, const fxs_object *o)
{
    fxs_sample *s = t->sample;
    fxs_scene *scene = &s->scenes[s->count];
    loose l[FXS_CHUNK];
    fxs_chunk header;
    uint32_t count = 0, chunk = UINT32_MAX;
    *scene = (fxs_scene){.chunks = t->headers, .rows = t->rows, .chunk_bytes = fxs_chunk_bytes(FXS_PROFILE_DEFAULT, 0),
                         .antialiased = o->scene->antialiased};
    for (; t->next < drawn(o); t->next += t->step) {
        const uint32_t g = (uint32_t)t->next;
        if (g / FXS_CHUNK != chunk && fxs_chunk_read(&header, o->scene, chunk = g / FXS_CHUNK))
            return FXS_ERR_SCENE;
        if (o->scene->places && o->scene->places[chunk] == FXS_NOTHING)
            continue;
        const fxs_codes codes = fxs_codes_of(o->scene, fxs_rows(o->scene, chunk), g % FXS_CHUNK);
        l[count] = loosen(o->scene->profile, &header, &codes);
        if (l[count].opacity == 0 || !is_kept(o, l[count].position_q32))
            continue;
        s->points[s->point_count++] = point_of(o, &l[count]);
        count += s->point_count % t->each == 0;
        if (count == FXS_CHUNK) {
            end_chunk(t, scene, l, count);
            count = 0;
        }
    }
    t->next -= drawn(o);
    end_chunk(t, scene, l, count);
    if (scene->count > 0) {
        s->objects[s->count] = *o;
        s->objects[s->count].scene = scene;
        s->objects[s->count++].crop_count = 0;
    }
    return 0;
}

/* Growth of log2(sigma) that lets every x-th Gaussian fill space as well as all of them: log2(x) / 3, linear between
   powers of two. */
static int32_t larger_of(uint64_t x)
{
    const int whole = 63 - fxs_clz64(x);
    return (int32_t)((((uint64_t)whole << 16) + ((x << 16 >> whole) - 65536)) / 3);
}

int fxs_sample_take(fxs_sample *s, const fxs_object *objects, uint32_t count, fxs_message *message)
{
    taking t = {.sample = s};
    uint64_t total = 0, chunks = 0;
    int error = 0;
    for (uint32_t i = 0; i < count; i++)
        total += drawn(&objects[i]);
    t.step = total / FXS_SAMPLE_POINTS + 1;
    t.next = t.step / 2;
    t.each = (uint32_t)(total / t.step / FXS_SAMPLE_MOST) + 1;
    t.larger_q16 = larger_of(t.step * t.each);
    for (uint32_t i = 0; i < count; i++)
        chunks += (drawn(&objects[i]) / (t.step * t.each) + FXS_CHUNK) / FXS_CHUNK;
    chunks = chunks < FXS_SAMPLE_MOST + 1 ? chunks : FXS_SAMPLE_MOST + 1;
    const size_t header_bytes = (size_t)chunks * sizeof(fxs_chunk);
    const size_t bytes = header_bytes + (size_t)chunks * fxs_chunk_bytes(FXS_PROFILE_DEFAULT, 0) + 63;
    *s = (fxs_sample){fxs_allocate(NULL, count, sizeof *s->objects), 0,
                      fxs_allocate(NULL, FXS_SAMPLE_POINTS, sizeof *s->points), 0, 0,
                      fxs_allocate(NULL, count, sizeof *s->scenes), fxs_allocate(NULL, bytes, 1)};
    if (!s->objects || !s->points || !s->scenes || !s->bytes)
        error = fxs_fail_memory(message, NULL, bytes);
    s->step = (double)t.step;
    t.headers = s->bytes + (64 - (uintptr_t)s->bytes % 64) % 64;
    t.rows = t.headers + header_bytes;
    for (uint32_t i = 0; i < count && !error; i++)
        if ((error = take_object(&t, &objects[i])) != 0)
            fxs_fail_as(error, message, "%s", fxs_strerror(error));
    if (error)
        fxs_sample_free(s);
    return error;
}

void fxs_sample_free(fxs_sample *s)
{
    fxs_release(NULL, s->objects);
    fxs_release(NULL, s->points);
    fxs_release(NULL, s->scenes);
    fxs_release(NULL, s->bytes);
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

void fxs_sort_values(double *values, uint32_t count)
{
    qsort(values, count, sizeof *values, ascending);
}
