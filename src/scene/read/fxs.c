/* Reads .fxs, the packed scene, without the merged Gaussians of its level-of-detail tree. */
#include <math.h>
#include <string.h>

#include <fixsplat/internal/message.h>
#include <fixsplat/internal/start.h>

#include "src/base/crc32.h"
#include "src/gaussian/origin_internal.h"
#include "src/core/codes.h"
#include "src/pack/decode.h"
#include "src/pack/move.h"
#include "src/scene/formats_internal.h"

enum { MOST_PALETTE = FXS_PALETTE_STAGES * FXS_PALETTE_ENTRIES * FXS_PALETTE_STRIDE, MOST_ROWS = 63 * FXS_CHUNK };

typedef struct fxs_file_reader {
    const fxs_scene_source *source;
    fxs_crc32_table crc;
    fxs_scene scene;
    uint64_t rows_at;                    /* file offset in bytes of the first chunk's Gaussians */
    uint32_t slots, holes;
    uint32_t next, passed;
    fxs_chunk chunk;
    unsigned char rows[MOST_ROWS];
    int8_t palette[MOST_PALETTE];
} fxs_file_reader;

static int is_fxs(const fxs_head *head, fxs_message *message)
{
    if (!memcmp(head->bytes, "FXSP", 4))
        return fxs_fail(message, "%s: one part of a scene; fixsplat convert PART... OUT merges all of them",
                        head->source->path);
    return !memcmp(head->bytes, "FXS1", 4);
}

static int damaged(const fxs_file_reader *r, const char *what, fxs_message *message)
{
    return fxs_fail(message, "%s: %s is damaged", r->source->path, what);
}

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
    const uint32_t version = fxs_little_32(h->version);
    if (version != FXS_PACKED_VERSION && version != FXS_PACKED_VERSION_TREE)
        return fxs_fail_as(FXS_ERR_VERSION, message, "%s: .fxs of version %u, this program reads %u and %u; convert "
                           "its source again", r->source->path, version, FXS_PACKED_VERSION,
                           FXS_PACKED_VERSION_TREE);
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
    const size_t tree = version == FXS_PACKED_VERSION ? 0 : fxs_tree_bytes(s->chunk_count, s->sh_degree, s->profile);
    if (!bytes || bytes + (uint64_t)tree != r->source->input.size ||
        (version == FXS_PACKED_VERSION_TREE && !tree) || h->holes > h->count || h->sh_degree > 3 ||
        h->palette_step_q19 > 32767 || h->chunk_count != s->chunk_count || h->chunk_bytes != s->chunk_bytes)
        return damaged(r, "the header, or the file's length,", message);
    r->rows_at = bytes - (uint64_t)s->chunk_count * s->chunk_bytes;
    return 0;
}

static int choose_origin(const fxs_file_reader *r, fxs_message *message)
{
    double places[FXS_ORIGIN_SAMPLE][3];
    fxs_chunk chunk;
    for (uint64_t i = 0; i < FXS_ORIGIN_SAMPLE; i++) {
        const uint64_t number = r->scene.chunk_count * i / FXS_ORIGIN_SAMPLE;
        FXS_TRY(fxs_scene_source_read(r->source, sizeof(fxs_packed_header) + number * sizeof chunk, &chunk,
                                      sizeof chunk, message));
        fxs_packed_place(&chunk, places[i]);
    }
    fxs_origin_of(r->source->import->origin, places, FXS_ORIGIN_SAMPLE);
    r->source->import->moves = 1;
    return 0;
}

static int fxs_open_file(void *data, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    fxs_file_reader *r = data;
    fxs_packed_header header;
    r->source = source;
    fxs_crc32_fill(&r->crc);
    FXS_TRY(take_header(r, &header, message));
    fxs_packed_header_turn(&header);
    fxs_start_of(&info->start, &header);
    fxs_packed_header_turn(&header);
    const uint64_t palette_at = sizeof header + (uint64_t)r->scene.chunk_count * sizeof(fxs_chunk);
    const size_t palette_bytes = (size_t)(r->rows_at - palette_at);
    FXS_TRY(fxs_scene_source_read(source, palette_at, r->palette, palette_bytes, message));
    if (palette_bytes && fxs_crc32(&r->crc, 0, r->palette, palette_bytes) != header.palette_checksum)
        return damaged(r, "the palette", message);
    r->scene.palette = r->palette;
    FXS_TRY(choose_origin(r, message));
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
    if (!fxs_chunk_valid(&r->chunk))
        return damaged(r, "a chunk's header", message);
    for (int i = 0; i < 3; i++)
        r->chunk.origin_q32[i] -= (int64_t)floor(ldexp(r->source->import->origin[i], 32) + 0.5);
    return 0;
}

static long fxs_read_gaussians(void *data, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    fxs_file_reader *r = data;
    size_t n = 0;
    for (; n < capacity && r->next < r->slots; r->next++) {
        const uint32_t g = r->next % FXS_CHUNK;
        if (g == 0)
            FXS_TRY(take_chunk(r, r->next / FXS_CHUNK, message));
        if (r->holes && fxs_slot_is_empty(&r->scene, r->rows, g))
            r->passed++;
        else
            fxs_decode(&r->scene, &r->chunk, r->rows, g, &gaussians[n++]);
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
                                 NULL, NULL};
