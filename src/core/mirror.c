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

void fxs_mirror_init(fxs_mirror *m, const fxs_scene *scene, uint32_t room, void *memory)
{
    uint32_t *of_chunks = memory, *wanted = of_chunks + fxs_scene_chunks(scene);
    *m = (fxs_mirror){.scene = *scene, .from = scene, .wanted = wanted};
    fxs_places_init(&m->pool, scene, room, of_chunks, (fxs_place *)(void *)(wanted + room));
    m->scene.places = of_chunks;
}

void fxs_mirror_begin(fxs_mirror *m, uint32_t turn, uint64_t bytes, const fxs_want *want)
{
    const uint64_t left = bytes / fxs_mirror_place_bytes(m->from);
    m->want = *want;
    if (m->pool.turn == turn)
        return;
    m->pool.turn = turn;
    m->wanted_count = m->wanted_next = m->kept_next = 0;
    m->left = left == 0 ? 1 : left < m->pool.room ? (uint32_t)left : m->pool.room;
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
    return m->used < m->pool.room ? m->used++ : fxs_places_evict(&m->pool, m->pool.turn - 1);
}

int fxs_mirror_next(fxs_mirror *m, fxs_mirror_upload *upload)
{
    while (m->left && (m->wanted_next < m->wanted_count || m->kept_next < m->pool.kept)) {
        const uint32_t chunk = m->wanted_next < m->wanted_count ? m->wanted[m->wanted_next++]
                                                                : m->pool.leaves + m->kept_next++;
        if (m->scene.places[chunk] != FXS_NOTHING || !is_in_memory(m, chunk))
            continue;
        const uint32_t place = take_place(m);
        m->left = place == FXS_NOTHING ? 0 : m->left - 1;
        if (place == FXS_NOTHING)
            return 0;
        fxs_places_settle(&m->pool, chunk, place);
        *upload = (fxs_mirror_upload){chunk, place, fxs_header(m->from, chunk), fxs_rows(m->from, chunk)};
        return 1;
    }
    return 0;
}
