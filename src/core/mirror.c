/* The bookkeeping of a scene that is partly on a device. */
#include "mirror.h"

#include "chunk.h"

uint64_t fxs_mirror_place_bytes(const fxs_scene *scene)
{
    return sizeof(fxs_chunk) + (uint64_t)scene->chunk_bytes;
}

uint64_t fxs_mirror_bytes(const fxs_scene *scene, uint32_t room)
{
    return fxs_scene_chunks(scene) * (uint64_t)sizeof(uint32_t) +
           room * (uint64_t)(sizeof(fxs_place) + sizeof(uint32_t));
}

uint64_t fxs_mirror_usual_bytes(const fxs_scene *scene, uint32_t budget)
{
    const uint64_t chunks = budget ? 2 * (uint64_t)fxs_chunks_of(budget) + FXS_KEPT_MOST : fxs_scene_chunks(scene);
    return chunks * fxs_mirror_place_bytes(scene);
}

fxs_scene fxs_mirror_pool(const fxs_mirror *m)
{
    fxs_scene pool = *m->from;
    pool.chunk_count = m->pool.room;
    pool.nodes = 0;
    return pool;
}

void fxs_mirror_init(fxs_mirror *m, const fxs_scene *scene, uint32_t room, void *memory)
{
    uint32_t *of_chunks = memory, *wanted = of_chunks + fxs_scene_chunks(scene);
    *m = (fxs_mirror){.scene = *scene, .from = scene, .wanted = wanted};
    fxs_places_init(&m->pool, scene, room, of_chunks, (fxs_place *)(void *)(wanted + room));
    m->scene.places = of_chunks;
}

void fxs_mirror_begin(fxs_mirror *m, uint32_t turn, uint32_t since, const fxs_want *want)
{
    m->want = *want;
    m->wanted_count = m->pool.turn == turn ? m->wanted_count : 0;
    m->pool.turn = turn;
    m->since = since;
}

static int is_in_memory(const fxs_mirror *m, uint32_t chunk)
{
    return !m->from->places || m->from->places[chunk] != FXS_NOTHING;
}

void fxs_mirror_want(void *argument, const fxs_scene *scene, uint32_t chunk, int there)
{
    fxs_mirror *m = (fxs_mirror *)(uintptr_t)scene;
    (void)argument;
    if (there)
        fxs_places_note_drawn(&m->pool, scene->places[chunk]);
    else if (m->wanted_count < m->pool.room)
        m->wanted[m->wanted_count++] = chunk;
    if (m->want.call)
        m->want.call(m->want.argument, m->from, chunk, is_in_memory(m, chunk));
}

static uint32_t take_place(fxs_mirror *m)
{
    return m->used < m->pool.room ? m->used++ : fxs_places_evict(&m->pool, m->since);
}

uint32_t fxs_mirror_step(fxs_mirror *m, uint64_t bytes, const uint32_t **places)
{
    const uint32_t wanted = m->wanted_count, all = wanted + m->pool.kept;
    const uint64_t most = bytes / fxs_mirror_place_bytes(m->from);
    uint32_t count = 0;
    m->wanted_count = 0;
    for (uint32_t i = 0; i < all && count < most && count < m->pool.room; i++) {
        const uint32_t chunk = i < wanted ? m->wanted[i] : m->pool.leaves + i - wanted;
        if (m->scene.places[chunk] != FXS_NOTHING || !is_in_memory(m, chunk))
            continue;
        const uint32_t place = take_place(m);
        if (place == FXS_NOTHING)
            break;
        fxs_places_settle(&m->pool, chunk, place);
        m->wanted[count++] = place;
    }
    *places = m->wanted;
    return count;
}
