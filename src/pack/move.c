#include "move.h"

#include <math.h>
#include <string.h>

#include <fixsplat/internal/packed.h>
#include <fixsplat/internal/parts.h>

static void move_chunks(unsigned char *headers, uint32_t count, const int64_t by_q32[3])
{
    for (uint32_t i = 0; i < count; i++) {
        fxs_chunk chunk;
        memcpy(&chunk, headers + i * sizeof chunk, sizeof chunk);
        fxs_chunk_turn(&chunk);
        for (int k = 0; k < 3; k++)
            chunk.origin_q32[k] += by_q32[k];
        fxs_chunk_turn(&chunk);
        memcpy(headers + i * sizeof chunk, &chunk, sizeof chunk);
    }
}

void fxs_packed_move(void *data, const double by[3])
{
    fxs_packed_header h;
    fxs_scene_parts parts;
    int64_t by_q32[3];
    if (fxs_scene_find_parts(&parts, data))
        return;
    memcpy(&h, data, sizeof h);
    fxs_packed_header_turn(&h);
    for (int k = 0; k < 3; k++) {
        by_q32[k] = (int64_t)floor(ldexp(by[k], 32) + 0.5);
        h.low_q32[k] += by_q32[k];
        h.high_q32[k] += by_q32[k];
        h.inner_low_q32[k] += by_q32[k];
        h.inner_high_q32[k] += by_q32[k];
    }
    move_chunks((unsigned char *)data + sizeof h, h.chunk_count, by_q32);
    if (parts.node_chunks < parts.bytes)
        move_chunks((unsigned char *)data + parts.node_chunks, h.chunk_count - 1, by_q32);
    fxs_packed_header_turn(&h);
    memcpy(data, &h, sizeof h);
}

void fxs_packed_place(const void *header, double place[3])
{
    fxs_chunk chunk;
    memcpy(&chunk, header, sizeof chunk);
    fxs_chunk_turn(&chunk);
    for (int k = 0; k < 3; k++)
        place[k] = (double)chunk.origin_q32[k] * 0x1p-32;
}
