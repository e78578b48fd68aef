/* Builds a packed scene by hand. packed_scene_make fills in its arguments and zeroes the rest. The test then fills in
   the headers in native byte order. The test also fills in the rows (data of the Gaussians) in little-endian order.
   packed_scene_finish opens the scene. */
#ifndef PACKED_SCENE_H
#define PACKED_SCENE_H

#include <string.h>

#include <fixsplat/internal/packed.h>
#include "check.h"

typedef struct packed_scene {
    unsigned char *data;
    size_t bytes;
    fxs_packed_header *header;
    fxs_chunk *chunks;
    int8_t *palette;               /* SH palette of the scene, or null for a scene without SH palette */
    unsigned char *rows;
    fxs_scene scene;
} packed_scene;

/* Converts the headers of the packed scene between native byte order and little-endian. */
static inline void packed_scene_turn(packed_scene *s, uint32_t chunk_count)
{
    for (uint32_t i = 0; i < chunk_count; i++)
        fxs_chunk_turn(&s->chunks[i]);
    fxs_packed_header_turn(s->header);
}

/* Converts the headers to little-endian and opens the scene. The test must not read the headers afterwards. */
static inline int packed_scene_finish(packed_scene *s)
{
    packed_scene_turn(s, s->header->chunk_count);
    return fxs_scene_open(&s->scene, s->data, s->bytes);
}

static inline packed_scene packed_scene_make(enum fxs_profile profile, int degree, uint32_t count, int antialiased)
{
    packed_scene s;
    memset(&s, 0, sizeof s);
    const uint32_t entries = fxs_palette_stages(profile, degree) ? 77 : 0;
    s.bytes = fxs_scene_bytes(count, degree, profile, entries);
    s.data = check_aligned(s.bytes);
    if (!s.bytes || !s.data)
        abort();
    memset(s.data, 0, s.bytes);
    s.header = (fxs_packed_header *)(void *)s.data;
    s.header->magic = FXS_PACKED_MAGIC;
    s.header->version = FXS_PACKED_VERSION;
    s.header->count = count;
    s.header->chunk_count = (count + FXS_CHUNK - 1) / FXS_CHUNK;
    s.header->chunk_bytes = fxs_chunk_bytes(profile, degree);
    s.header->sh_degree = (uint32_t)degree;
    s.header->flags = antialiased ? FXS_PACKED_ANTIALIASED : 0;
    s.header->profile = (uint32_t)profile;
    s.header->palette_entries = entries;
    s.chunks = (fxs_chunk *)(void *)(s.data + sizeof *s.header);
    s.rows = s.data + s.bytes - (size_t)s.header->chunk_count * s.header->chunk_bytes;
    s.palette = entries ? (int8_t *)(s.chunks + s.header->chunk_count) : 0;
    if (packed_scene_finish(&s))
        abort();
    packed_scene_turn(&s, (count + FXS_CHUNK - 1) / FXS_CHUNK);
    return s;
}

static inline unsigned char *packed_scene_rows(const packed_scene *s, uint32_t chunk)
{
    return s->rows + (size_t)chunk * s->header->chunk_bytes;
}

#endif
