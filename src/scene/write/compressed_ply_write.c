/* Writes PlayCanvas's compressed .ply. Positions are relative to the box of a chunk (256 Gaussians), so neighbours are
   grouped first. */
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>

#include "scene_write_internal.h"
#include "src/base/report.h"
#include "src/gaussian/attributes.h"

enum { CHUNK = 256, BOUNDS = 18, CHUNK_BYTES = 4 * BOUNDS, WORDS_BYTES = 16 };

/* A chunk of 256 Gaussians: bounds of position, of ln(sigma), and of the colour 0.5 + SH_0 dc. */
typedef struct chunk {
    float low[9], high[9];
} chunk;

typedef struct compressed_writer {
    fxs_held held;
    int antialiased;
} compressed_writer;

static int compressed_open(void *writer, const char *path, const fxs_scene_write_options *o, fxs_message *message)
{
    compressed_writer *w = writer;
    w->antialiased = o->antialiased;
    return fxs_held_open(&w->held, path, o, message);
}

static int compressed_put(void *writer, const fxs_gaussian *gaussians, size_t n, fxs_message *message)
{
    return fxs_held_put(&((compressed_writer *)writer)->held, gaussians, n, message);
}

static void values_of(const fxs_held_gaussian *g, float values[9])
{
    for (int i = 0; i < 3; i++) {
        values[i] = g->position[i];
        values[3 + i] = g->scale[i];
        values[6 + i] = (float)(0.5 + FXS_SH_0 * g->dc[i]);
    }
}

static void find_bounds(chunk *c, const fxs_held *h, uint32_t first, uint32_t end)
{
    *c = (chunk){.low = {0}};
    for (uint32_t i = first; i < end; i++) {
        float values[9];
        values_of(&h->gaussians[h->order[i]], values);
        for (int k = 0; k < 9; k++) {
            c->low[k] = i == first || values[k] < c->low[k] ? values[k] : c->low[k];
            c->high[k] = i == first || values[k] > c->high[k] ? values[k] : c->high[k];
        }
    }
}

/* Codes a number in a range with `bits` bits: value = low + (high - low) code / (2^bits - 1). */
static uint32_t code(const chunk *c, const float values[9], int k, int bits)
{
    const double width = (double)c->high[k] - c->low[k];
    const uint32_t most = (1u << bits) - 1;
    return width > 0 ? fxs_code_within(((double)values[k] - c->low[k]) / width * most, most) : 0;
}

static uint32_t code_three(const chunk *c, const float values[9], int k)
{
    return code(c, values, k, 11) << 21 | code(c, values, k + 1, 10) << 11 | code(c, values, k + 2, 11);
}

static void encode_words(const chunk *c, const fxs_held_gaussian *g, uint8_t *to)
{
    float values[9];
    uint32_t rest[3];
    values_of(g, values);
    const uint32_t largest = fxs_code_rotation(g->rotation, 1023, rest);
    const uint32_t colour = code(c, values, 6, 8) << 24 | code(c, values, 7, 8) << 16 | code(c, values, 8, 8) << 8 |
                            fxs_code_within(255.0 * g->opacity, 255);
    to = fxs_put_u32(to, code_three(c, values, 0));
    to = fxs_put_u32(to, largest << 30 | rest[0] << 20 | rest[1] << 10 | rest[2]);
    to = fxs_put_u32(to, code_three(c, values, 3));
    fxs_put_u32(to, colour);
}

/* Codes SH coefficients in 8 bits, all of red, then green, then blue: value = 8 ((code + 0.5) / 256 - 0.5). */
static void encode_sh(const int16_t *sh, uint32_t coefficients, uint8_t *to)
{
    for (uint32_t c = 0; c < 3; c++)
        for (uint32_t k = c; k < coefficients; k += 3)
            *to++ = (uint8_t)fxs_code_within((sh[k] / (8.0 * FXS_HELD_SH_ONE) + 0.5) * 256 - 0.5, 255);
}

static void write_header(const compressed_writer *w)
{
    static const char *const bounds[] = {"x", "y", "z", "scale_x", "scale_y", "scale_z", "r", "g", "b"};
    const fxs_held *h = &w->held;
    FILE *file = h->output.file;
    fprintf(file, "ply\nformat binary_little_endian 1.0\n%selement chunk %" PRIu32 "\n",
            w->antialiased ? "comment antialiased 1\n" : "", (h->count + CHUNK - 1) / CHUNK);
    for (int attribute = 0; attribute < 9; attribute += 3)
        for (int k = 0; k < 6; k++)
            fprintf(file, "property float %s_%s\n", k < 3 ? "min" : "max", bounds[attribute + k % 3]);
    fprintf(file, "element vertex %" PRIu32 "\nproperty uint packed_position\nproperty uint packed_rotation\n"
            "property uint packed_scale\nproperty uint packed_color\n", h->count);
    if (h->coefficients)
        fprintf(file, "element sh %" PRIu32 "\n", h->count);
    for (uint32_t k = 0; k < h->coefficients; k++)
        fprintf(file, "property uchar f_rest_%" PRIu32 "\n", k);
    fputs("end_header\n", file);
}

static void write_chunk(fxs_output *output, const chunk *c, fxs_message *message)
{
    uint8_t bytes[CHUNK_BYTES], *to = bytes;
    for (int attribute = 0; attribute < 9; attribute += 3) {
        to = fxs_put_floats(to, c->low + attribute, 3);
        to = fxs_put_floats(to, c->high + attribute, 3);
    }
    fxs_output_write(output, bytes, sizeof bytes, message);
}

static void write_body(fxs_held *h, chunk *chunks, const fxs_progress *progress, fxs_message *message)
{
    uint8_t bytes[45];
    for (uint32_t i = 0; i < h->count; i += CHUNK) {
        find_bounds(&chunks[i / CHUNK], h, i, i + CHUNK < h->count ? i + CHUNK : h->count);
        write_chunk(&h->output, &chunks[i / CHUNK], message);
    }
    for (uint32_t i = 0; i < h->count && !h->output.error; i++) {
        encode_words(&chunks[i / CHUNK], &h->gaussians[h->order[i]], bytes);
        fxs_output_write(&h->output, bytes, WORDS_BYTES, message);
        if (i % CHUNK == 0 && fxs_report(progress, (double)i / h->count))
            h->output.error = ECANCELED;
    }
    for (uint32_t i = 0; i < h->count && !h->output.error; i++) {
        encode_sh(h->sh + (size_t)h->order[i] * h->coefficients, h->coefficients, bytes);
        fxs_output_write(&h->output, bytes, h->coefficients, message);
    }
}

static int compressed_close(void *writer, fxs_scene_write_report *report, const fxs_progress *progress,
                            fxs_message *message)
{
    compressed_writer *w = writer;
    fxs_held *h = &w->held;
    (void)report;
    if (fxs_held_order(h)) {
        chunk *chunks = malloc(((size_t)h->count / CHUNK + 1) * sizeof *chunks);
        if (chunks) {
            write_header(w);
            write_body(h, chunks, progress, message);
        } else {
            h->output.error = ENOMEM;
        }
        free(chunks);
    }
    return fxs_held_close(h, message);
}

const fxs_writer fxs_write_compressed_ply = {
    sizeof(compressed_writer), compressed_open, compressed_put, compressed_close, NULL
};
