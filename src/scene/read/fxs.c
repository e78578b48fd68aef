/* Reads .fxs, the packed scene, without the merged Gaussians of its level-of-detail tree. */
#include <math.h>
#include <string.h>

#include <fixsplat/internal/message.h>
#include <fixsplat/internal/parts.h>
#include <fixsplat/internal/start.h>

#include "src/base/crc32.h"
#include "src/gaussian/origin_internal.h"
#include "src/core/codes.h"
#include "src/pack/decode.h"
#include "src/pack/move.h"
#include "src/scene/formats_internal.h"
#include "src/scene/fxs_file_internal.h"

enum { MOST_PALETTE = FXS_PALETTE_STAGES * FXS_PALETTE_ENTRIES * FXS_PALETTE_STRIDE, MOST_ROWS = 93 * FXS_CHUNK,
       AT_ONCE = 4096 };

typedef struct fxs_file_reader {
    const fxs_scene_source *source;
    fxs_crc32_table crc;
    fxs_scene scene;
    fxs_scene_parts parts;
    fxs_motion_header motion;            /* of a moving scene */
    fxs_motion motions[AT_ONCE];
    fxs_chunk_motion chunk_motion;
    fxs_motion_rows rows_of_motion;
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

/* Reads the motion header. The chunks' motions are read with their chunks. */
static int take_motion(fxs_file_reader *r, const fxs_packed_header *h, fxs_time *time, fxs_message *message)
{
    fxs_motion_header *m = &r->motion;
    FXS_TRY(fxs_scene_source_read(r->source, r->parts.motion, m, sizeof *m, message));
    fxs_motion_header_turn(m);
    if (!fxs_motion_header_valid(m, fxs_chunks_with_nodes(h->chunk_count, fxs_version_has_tree(h->version))) ||
        h->chunk_bytes != fxs_chunk_bytes(r->scene.profile, r->scene.sh_degree) + fxs_motion_bytes(m->degree, m->flags))
        return damaged(r, "the motion's header", message);
    *time = (fxs_time){ldexp(m->duration_q16, -16), ldexp(m->rate_q16, -16), (m->flags & FXS_MOTION_LOOPS) != 0,
                       (int)m->degree, (m->flags & FXS_MOTION_TURNS) != 0, (m->flags & FXS_MOTION_FADES) != 0,
                       m->cut_q16 < 16u << 16 ? exp2(-ldexp(m->cut_q16, -16)) : 0};
    r->rows_of_motion = (fxs_motion_rows){r->scene.chunk_bytes - fxs_motion_bytes(m->degree, m->flags), m->degree,
                                          m->cut_q16, (uint8_t)time->turns, (uint8_t)time->fades, {0}};
    return 0;
}

static int take_header(fxs_file_reader *r, fxs_packed_header *h, fxs_message *message)
{
    fxs_scene *s = &r->scene;
    FXS_TRY(fxs_scene_source_read(r->source, 0, h, sizeof *h, message));
    FXS_TRY(fxs_file_check_header(r->source->path, &r->crc, h, message));
    if (fxs_scene_find_parts(&r->parts, h) || r->parts.bytes != r->source->input.size)
        return damaged(r, "the header, or the file's length,", message);
    fxs_packed_header_turn(h);
    s->profile = (enum fxs_profile)h->profile;
    r->slots = h->count;
    r->holes = h->holes;
    s->count = h->count - h->holes;
    s->chunk_count = h->chunk_count;
    s->palette_entries = h->palette_entries;
    s->palette_step_q19 = h->palette_step_q19;
    s->sh_degree = (int)h->sh_degree;
    s->antialiased = (h->flags & FXS_PACKED_ANTIALIASED) != 0;
    s->chunk_bytes = h->chunk_bytes;
    return 0;
}

/* Reads the palette, and compares the checksum of palette and motion. */
static int take_palette(fxs_file_reader *r, const fxs_packed_header *h, fxs_message *message)
{
    const size_t bytes = (size_t)(r->parts.motion - r->parts.palette);
    FXS_TRY(fxs_scene_source_read(r->source, r->parts.palette, r->palette, bytes, message));
    uint32_t checksum = fxs_crc32(&r->crc, 0, r->palette, bytes);
    for (uint64_t at = r->parts.motion; at < r->parts.rows; at += sizeof r->rows) {
        const size_t size = r->parts.rows - at < sizeof r->rows ? (size_t)(r->parts.rows - at) : sizeof r->rows;
        FXS_TRY(fxs_scene_source_read(r->source, at, r->rows, size, message));
        checksum = fxs_crc32(&r->crc, checksum, r->rows, size);
    }
    r->scene.palette = r->palette;
    return r->parts.rows > r->parts.palette && checksum != h->palette_checksum
               ? damaged(r, "the palette", message) : 0;
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
    FXS_TRY(take_palette(r, &header, message));
    if (fxs_version_moves(header.version))
        FXS_TRY(take_motion(r, &header, &info->time, message));
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
    FXS_TRY(fxs_scene_source_read(r->source, r->parts.rows + (uint64_t)number * s->chunk_bytes, r->rows, s->chunk_bytes,
                                  message));
    if (!is_whole(r, &r->chunk.checksum, &r->chunk, sizeof r->chunk, r->rows, s->chunk_bytes))
        return damaged(r, "a chunk", message);
    fxs_chunk_turn(&r->chunk);
    if (!fxs_chunk_valid(&r->chunk))
        return damaged(r, "a chunk's header", message);
    if (r->motion.magic) {
        fxs_chunk_motion *m = &r->chunk_motion;
        FXS_TRY(fxs_scene_source_read(r->source, r->parts.motion + sizeof r->motion + (uint64_t)number * sizeof *m, m,
                                      sizeof *m, message));
        fxs_chunk_motion_turn(m);
        if (!fxs_chunk_motion_valid(m))
            return damaged(r, "a chunk's motion", message);
    }
    for (int i = 0; i < 3; i++)
        r->chunk.origin_q32[i] -= (int64_t)floor(ldexp(r->source->import->origin[i], 32) + 0.5);
    return 0;
}

static long fxs_read_gaussians(void *data, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    fxs_file_reader *r = data;
    size_t n = 0;
    capacity = r->motion.magic && capacity > AT_ONCE ? AT_ONCE : capacity;
    for (; n < capacity && r->next < r->slots; r->next++) {
        const uint32_t g = r->next % FXS_CHUNK;
        if (g == 0)
            FXS_TRY(take_chunk(r, r->next / FXS_CHUNK, message));
        if (r->holes && fxs_slot_is_empty(&r->scene, r->rows, g))
            r->passed++;
        else {
            fxs_decode(&r->scene, &r->chunk, r->rows, g, &gaussians[n]);
            if (r->motion.magic)
                fxs_decode_motion(&r->rows_of_motion, &r->motion, &r->chunk_motion, &r->chunk, r->rows, g,
                                  &gaussians[n], &r->motions[n]);
            n++;
        }
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

static const fxs_motion *fxs_motions(const void *data)
{
    return ((const fxs_file_reader *)data)->motions;
}

const fxs_reader fxs_read_fxs = {is_fxs, sizeof(fxs_file_reader), fxs_open_file, fxs_read_gaussians, fxs_rewind_file,
                                 NULL, fxs_motions};
