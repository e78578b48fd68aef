/* Reads .fxs: decodes the Gaussians of a packed scene, as docs/format.md describes. */
#include <string.h>

#include <fixsplat/message.h>

#include "src/base/crc32.h"
#include "src/core/codes.h"
#include "src/gaussian/attributes.h"
#include "src/scene/formats_internal.h"

#define LN_2 0.69314718055994531
enum { MOST_PALETTE = FXS_PALETTE_STAGES * FXS_PALETTE_ENTRIES * FXS_PALETTE_STRIDE, MOST_ROWS = 63 * FXS_CHUNK };

typedef struct fxs_file_reader {
    const fxs_scene_source *source;
    fxs_crc32_table crc;
    fxs_scene scene;                     /* without pointers to its bytes, except the palette */
    uint64_t rows_at;                    /* offset of the first chunk's rows in the file, bytes */
    uint32_t slots, holes;               /* of the file */
    uint32_t next, passed;               /* the next slot; how many before it were holes */
    fxs_chunk chunk;                     /* chunk of that slot, and its rows */
    unsigned char rows[MOST_ROWS];
    int8_t palette[MOST_PALETTE];
} fxs_file_reader;

static int is_fxs(const fxs_head *head, fxs_message *message)
{
    (void)message;
    return !memcmp(head->bytes, "FXS1", 4);
}

static int damaged(const fxs_file_reader *r, const char *what, fxs_message *message)
{
    return fxs_fail(message, "%s: %s is damaged", r->source->path, what);
}

/* Checks the checksum of bytes that contain it, computed with 0 in its place. */
static int is_whole(const fxs_file_reader *r, uint32_t *checksum, const void *bytes, size_t size, const void *more,
                    size_t more_size)
{
    const uint32_t wanted = fxs_little_32(*checksum);
    *checksum = 0;
    return fxs_crc32(&r->crc, fxs_crc32(&r->crc, 0, bytes, size), more, more_size) == wanted;
}

static int take_header(fxs_file_reader *r, fxs_packed_header *h, fxs_message *message)
{
    fxs_scene *s = &r->scene;
    FXS_TRY(fxs_scene_source_read(r->source, 0, h, sizeof *h, message));
    if (fxs_little_32(h->version) != FXS_PACKED_VERSION)
        return fxs_fail_as(FXS_ERR_VERSION, message, "%s: .fxs of version %u, this program reads %u; convert its source "
                           "again", r->source->path, fxs_little_32(h->version), FXS_PACKED_VERSION);
    if (!is_whole(r, &h->checksum, h, sizeof *h, NULL, 0))
        return damaged(r, "the header", message);
    fxs_packed_header_turn(h);
    s->profile = (enum fxs_profile)h->profile;
    r->slots = h->count;
    r->holes = h->holes;
    s->count = h->count - h->holes;
    s->chunk_count = fxs_chunks_of(h->count);
    s->palette_entries = h->palette_entries;
    s->palette_step_q19 = h->palette_step_q19;
    s->sh_degree = (int)(h->sh_degree & 3);
    s->antialiased = (h->flags & FXS_PACKED_ANTIALIASED) != 0;
    const size_t bytes = fxs_scene_bytes(h->count, s->sh_degree, s->profile, h->palette_entries);
    s->chunk_bytes = fxs_chunk_bytes(s->profile, s->sh_degree);
    if (!bytes || bytes != r->source->input.size || h->holes > h->count || h->sh_degree > 3 ||
        h->palette_step_q19 > 32767 || h->chunk_count != s->chunk_count || h->chunk_bytes != s->chunk_bytes)
        return damaged(r, "the header, or the file's length,", message);
    r->rows_at = bytes - (uint64_t)s->chunk_count * s->chunk_bytes;
    return 0;
}

static int fxs_open_file(void *data, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    fxs_file_reader *r = data;
    fxs_packed_header header;
    r->source = source;
    fxs_crc32_fill(&r->crc);
    FXS_TRY(take_header(r, &header, message));
    const uint64_t palette_at = sizeof header + (uint64_t)r->scene.chunk_count * sizeof(fxs_chunk);
    const size_t palette_bytes = (size_t)(r->rows_at - palette_at);
    FXS_TRY(fxs_scene_source_read(source, palette_at, r->palette, palette_bytes, message));
    if (palette_bytes && fxs_crc32(&r->crc, 0, r->palette, palette_bytes) != header.palette_checksum)
        return damaged(r, "the palette", message);
    r->scene.palette = r->palette;
    info->count = r->scene.count;
    info->sh_degree = r->scene.sh_degree;
    info->antialiased = r->scene.antialiased;
    return 0;
}

static int take_chunk(fxs_file_reader *r, uint32_t number, fxs_message *message)
{
    const fxs_scene *s = &r->scene;
    const uint64_t header_at = sizeof(fxs_packed_header) + (uint64_t)number * sizeof r->chunk;
    FXS_TRY(fxs_scene_source_read(r->source, header_at, &r->chunk, sizeof r->chunk, message));
    FXS_TRY(fxs_scene_source_read(r->source, r->rows_at + (uint64_t)number * s->chunk_bytes, r->rows, s->chunk_bytes,
                                  message));
    if (!is_whole(r, &r->chunk.checksum, &r->chunk, sizeof r->chunk, r->rows, s->chunk_bytes))
        return damaged(r, "a chunk", message);
    fxs_chunk_turn(&r->chunk);
    return fxs_chunk_valid(&r->chunk) ? 0 : damaged(r, "a chunk's header", message);
}

/* ---- Codes ------------------------------------------------------------------------------------------------------- */

/* Law 0: c / 255; else 1/255 + (4^(1 - law) - 1/255) ((c - 1) / 254)^2, and 0 for code 0. */
static double opacity_of(uint32_t code, uint32_t law)
{
    const double part = (code - 1.0) / 254, top = ldexp(1, 2 - 2 * (int)law);
    return law == 0 ? code / 255.0 : code == 0 ? 0 : 1 / 255.0 + (top - 1 / 255.0) * part * part;
}

/* Three components are (2 c - 1023) / (1023 sqrt(2)); the largest follows from the length of 1. */
static void take_rotation(uint32_t code, float rotation[4])
{
    const uint32_t largest = code >> 30;
    double rest = 1;
    for (uint32_t i = 0; i < 3; i++) {
        const double q = (2.0 * (code >> (20 - 10 * i) & 1023) - 1023) / 1023 / 1.4142135623730951;
        rotation[i < largest ? i : i + 1] = (float)q;
        rest -= q * q;
    }
    rotation[largest] = (float)sqrt(rest > 0 ? rest : 0);
}

/* Profile default: a coefficient of degree d is code * sh_step[d - 1]. */
static void take_bands(const fxs_file_reader *r, uint32_t g, float sh[45])
{
    for (int k = 0; k < 3 * FXS_SH_COUNT(r->scene.sh_degree); k++)
        sh[k] = (float)ldexp((int8_t)r->rows[FXS_ROW_SH + (uint32_t)k * FXS_CHUNK + g] *
                             (double)r->chunk.sh_step_q19[k < 9 ? 0 : k < 24 ? 1 : 2], -19);
}

/* Profiles compact and small: the sum of the chunk's mean and an entry of each palette, in compact also of the residual
   (2 code + 1) gain, gain = (8 + (g mod 8)) 2^(floor(g / 8) - 32). */
static void take_palette(const fxs_file_reader *r, uint32_t g, float sh[45])
{
    const fxs_scene *s = &r->scene;
    const unsigned char *record = fxs_sh_record(s, r->rows, g);
    const int is_compact = s->profile == FXS_PROFILE_COMPACT, count = FXS_SH_COUNT(s->sh_degree);
    const double gain = is_compact ? ldexp(8 + record[FXS_GAIN_BYTE] % 8, record[FXS_GAIN_BYTE] / 8 - 32) : 0;
    for (int c = 0; c < 3; c++) {
        const uint64_t residual = is_compact ? fxs_residual(record, s->sh_degree, c) : 0;
        for (int k = 0; k < count; k++) {
            int sum = r->chunk.sh_mean[16 * c + k];
            for (uint32_t stage = 0; stage < fxs_palette_stages(s->profile, s->sh_degree); stage++) {
                const int number = fxs_palette_entry(s, stage, record[stage])[16 * c + k];
                sum += record[stage] & FXS_PALETTE_NEGATIVE ? -number : number;
            }
            const int code = (int)(residual >> 3 * k & 7);
            sh[3 * k + c] = (float)(ldexp(sum * (double)s->palette_step_q19, -19) +
                                    (2 * (code < 4 ? code : code - 8) + 1) * gain);
        }
    }
}

static void take_gaussian(const fxs_file_reader *r, uint32_t g, const fxs_codes *of, fxs_gaussian *out)
{
    const fxs_scene *s = &r->scene;
    const fxs_chunk *chunk = &r->chunk;
    const fxs_codes codes = *of;
    memset(out, 0, sizeof *out);
    for (int i = 0; i < 3; i++) {
        const uint32_t scale = codes.scale >> 10 * i & 1023, colour = codes.colour >> 8 * i & 255;
        const int64_t steps = (int64_t)codes.position[i] * chunk->step_q32[i] << chunk->step_shift;
        out->position[i] = (float)ldexp((double)(chunk->origin_q32[i] + steps), -32);
        out->scale[i] = (float)(LN_2 * (ldexp(chunk->scale_q16, -16) -
                                        ldexp((double)scale * scale * chunk->scale_step_q24, -24)));
        out->dc[i] = fxs_dc_of_colour(ldexp(chunk->colour_q16[i], -16) +
                                      ldexp((double)colour * chunk->colour_step_q20[i], -20));
    }
    take_rotation(codes.rotation, out->rotation);
    out->opacity = fxs_logit_of_opacity(opacity_of(codes.colour >> 24, chunk->opacity_law));
    if (s->profile == FXS_PROFILE_DEFAULT)
        take_bands(r, g, out->sh);
    else if (s->sh_degree)
        take_palette(r, g, out->sh);
}

static long fxs_read_gaussians(void *data, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    fxs_file_reader *r = data;
    size_t n = 0;
    for (; n < capacity && r->next < r->slots; r->next++) {
        const uint32_t g = r->next % FXS_CHUNK;
        if (g == 0)
            FXS_TRY(take_chunk(r, r->next / FXS_CHUNK, message));
        const fxs_codes codes = fxs_codes_of(&r->scene, r->rows, g);
        if (r->holes && codes.rotation == 0)
            r->passed++;
        else
            take_gaussian(r, g, &codes, &gaussians[n++]);
    }
    if (r->next == r->slots && r->passed != r->holes)
        return damaged(r, "the number of Gaussians", message);
    return (long)n;
}

static int fxs_rewind_file(void *data, fxs_message *message)
{
    (void)message;
    fxs_file_reader *r = data;
    r->next = r->passed = 0;
    return 0;
}

const fxs_reader fxs_read_fxs = {is_fxs, sizeof(fxs_file_reader), fxs_open_file, fxs_read_gaussians, fxs_rewind_file,
                                 NULL};
