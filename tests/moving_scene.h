/* Makes random moving scenes: gives the chunks of a still scene random motion. */
#ifndef MOVING_SCENE_H
#define MOVING_SCENE_H

#include "random_scene.h"

/* Chooses when a chunk is alive: one in eight always, the others for a part of the duration or longer. */
static inline fxs_chunk_motion random_chunk_motion(int32_t duration_q16)
{
    const int32_t from_q16 = between(-65536, duration_q16);
    fxs_chunk_motion m = {from_q16, from_q16 + between(1, 2 * duration_q16), between(0, duration_q16),
                          (uint8_t)(between(0, 3) ? between(12, 20) : between(0, 30)), (int8_t)between(-15, 4), 0};
    if (!between(0, 7)) {
        m.from_q16 = INT32_MIN;
        m.to_q16 = INT32_MAX;
    }
    return m;
}

/* Returns the largest number of chunks that are alive at one time, 1 or more. */
static inline uint32_t most_alive(const fxs_chunk_motion *motions, uint32_t count)
{
    uint32_t most = 1;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t alive = 0;
        for (uint32_t k = 0; k < count; k++)
            alive += motions[k].from_q16 <= motions[i].from_q16 && motions[i].from_q16 < motions[k].to_q16;
        most = alive > most ? alive : most;
    }
    return most;
}

/* Writes the motion header and the chunks' motions. */
static inline void fill_motion_table(unsigned char *out, uint32_t chunks, uint32_t degree, uint32_t flags)
{
    fxs_chunk_motion *motions = check_aligned(chunks * sizeof *motions);
    if (!motions)
        abort();
    fxs_motion_header h = {.magic = FXS_MOTION_MAGIC, .duration_q16 = (uint32_t)between(1, 8 << 16), .flags = flags,
                           .degree = degree, .cut_q16 = (uint32_t)between(0, 16 << 16)};
    for (uint32_t i = 0; i < chunks; i++)
        motions[i] = random_chunk_motion((int32_t)h.duration_q16);
    h.most_chunks = most_alive(motions, chunks);
    fxs_motion_header_turn(&h);
    memcpy(out, &h, sizeof h);
    for (uint32_t i = 0; i < chunks; i++) {
        fxs_chunk_motion_turn(&motions[i]);
        memcpy(out + sizeof h + i * sizeof *motions, &motions[i], sizeof *motions);
    }
    free(motions);
}

/* Copies the rows of chunks, with random rows of motion behind them. Returns the end. */
static inline unsigned char *fill_moving_rows(unsigned char *at, const unsigned char *rows, uint32_t chunks,
                                              uint32_t chunk_bytes, uint32_t motion_bytes)
{
    for (uint32_t i = 0; i < chunks; i++) {
        memcpy(at, rows + (size_t)i * chunk_bytes, chunk_bytes);
        fill_words(at + chunk_bytes, motion_bytes);
        at += chunk_bytes + motion_bytes;
    }
    return at;
}

/* Copies a level-of-detail tree. Its nodes are alive at random times, as the leaves are. */
static inline void fill_moving_tree(unsigned char *at, const fxs_scene *still, uint32_t motion_bytes)
{
    const unsigned char *head = still->nodes - sizeof(fxs_tree_header);
    const size_t bytes = (size_t)(still->node_rows - head);
    memcpy(at, head, bytes);
    fill_moving_rows(at + bytes, still->node_rows, still->chunk_count - 1, still->chunk_bytes, motion_bytes);
}

/* Makes a moving scene of the Gaussians of a still one, which has no holes. `degree` and `flags` are
   those of its motion header; the rest of its motion follows from `seed`. Returns its bytes, which the caller frees,
   and their number in *bytes. */
static inline unsigned char *make_moving(const fxs_scene *still, uint32_t degree, uint32_t flags, uint64_t seed,
                                         size_t *bytes)
{
    const uint64_t before = state;
    const uint32_t chunks = still->chunk_count, motion_bytes = fxs_motion_bytes(degree, flags);
    const size_t headers = chunks * sizeof(fxs_chunk);
    const int has_tree = still->nodes != 0;
    fxs_packed_header h = {.magic = FXS_PACKED_MAGIC, .version = fxs_packed_version(1, has_tree), .count = still->count,
                           .chunk_count = chunks, .chunk_bytes = still->chunk_bytes + motion_bytes,
                           .sh_degree = (uint32_t)still->sh_degree, .profile = (uint32_t)still->profile,
                           .flags = still->antialiased ? FXS_PACKED_ANTIALIASED : 0,
                           .palette_entries = still->palette_entries, .palette_step_q19 = still->palette_step_q19};
    *bytes = fxs_moving_scene_bytes(h.count, still->sh_degree, still->profile, h.palette_entries, degree, flags,
                                    has_tree) +
             (has_tree ? fxs_tree_bytes(chunks, h.chunk_bytes) : 0);
    unsigned char *data = *bytes ? check_aligned(*bytes) : 0, *at = data;
    if (!data)
        abort();
    state = seed;
    memset(data, 0, *bytes);
    fxs_packed_header_turn(&h);
    memcpy(at, &h, sizeof h);
    at += sizeof h;
    memcpy(at, still->chunks, headers);
    at += headers;
    if (still->palette)
        memcpy(at, still->palette, fxs_palette_bytes(still));
    at += fxs_palette_bytes(still);
    fill_motion_table(at, fxs_scene_chunks(still), degree, flags);
    at += fxs_motion_table_bytes(fxs_scene_chunks(still));
    at = fill_moving_rows(at, still->rows, chunks, still->chunk_bytes, motion_bytes);
    if (has_tree)
        fill_moving_tree(at, still, motion_bytes);
    state = before;
    return data;
}

#endif
