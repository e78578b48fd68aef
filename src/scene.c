#include "memory.h"
#include "packed.h"
#include "stage.h"

size_t fxs_scene_bytes(uint32_t count, int sh_degree)
{
    if (count > FXS_MAX_COUNT || sh_degree < 0 || sh_degree > 3)
        return 0;
    uint64_t chunks = ((uint64_t)count + FXS_CHUNK - 1) / FXS_CHUNK;
    uint64_t bytes = sizeof(fxs_packed_header) + chunks * FXS_CHUNK_BYTES(sh_degree);
    return bytes > SIZE_MAX ? 0 : (size_t)bytes;
}

static int within(int64_t x, int64_t limit)
{
    return x >= -limit && x <= limit;
}

/* The ranges that project and shade rely on. */
static int chunk_valid(const fxs_chunk *chunk)
{
    int64_t scale = chunk->scale_q16, scale_reach = (int64_t)chunk->scale_step_q24 * (1023 * 1023) >> 8;
    if (chunk->step_shift > 12)
        return 0;
    int valid = within(scale, 32 << 16) && within(scale - scale_reach, 32 << 16);
    for (int i = 0; i < 3; i++) {
        int64_t reach = (int64_t)chunk->step_q32[i] * 65535 << chunk->step_shift;
        int64_t colour = chunk->colour_q16[i], colour_reach = (int64_t)chunk->colour_step_q20[i] * 255 >> 4;
        valid = valid && within(chunk->origin_q32[i], (int64_t)1 << 60) &&
                within(chunk->origin_q32[i] + reach, (int64_t)1 << 60) && within(colour, 64 << 16) &&
                within(colour + colour_reach, 64 << 16) && chunk->sh_step_q19[i] <= 32767;
    }
    return valid;
}

int fxs_scene_open(fxs_scene *scene, const void *data, size_t bytes)
{
    fxs_packed_header header;
    if (!scene || !data || (uintptr_t)data % 64)
        return FXS_ERR_ARGUMENT;
    if (bytes < sizeof header)
        return FXS_ERR_SCENE;
    memcpy(&header, data, sizeof header);
    if (header.magic != FXS_PACKED_MAGIC)
        return FXS_ERR_SCENE;
    if (header.version != FXS_PACKED_VERSION)
        return FXS_ERR_VERSION;
    if (header.sh_degree > 3 || header.count > FXS_MAX_COUNT ||
        header.chunk_count != (header.count + FXS_CHUNK - 1) / FXS_CHUNK ||
        header.chunk_bytes != FXS_CHUNK_BYTES(header.sh_degree))
        return FXS_ERR_SCENE;
    size_t needed = fxs_scene_bytes(header.count, (int)header.sh_degree);
    if (!needed || bytes < needed)
        return FXS_ERR_SCENE;
    scene->chunks = (const unsigned char *)data + sizeof header;
    scene->count = header.count;
    scene->chunk_count = header.chunk_count;
    scene->chunk_bytes = header.chunk_bytes;
    scene->sh_degree = (int)header.sh_degree;
    scene->antialiased = (header.flags & FXS_PACKED_ANTIALIASED) != 0;
    for (uint32_t i = 0; i < scene->chunk_count; i++)
        if (!chunk_valid((const fxs_chunk *)(const void *)(scene->chunks + (size_t)i * scene->chunk_bytes)))
            return FXS_ERR_SCENE;
    return 0;
}
