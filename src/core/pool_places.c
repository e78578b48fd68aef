/* The places of a pool. Places whose chunks may be evicted form a linked list in the order of last use: the least
 * recently drawn chunk is evicted first. */
#include "pool_places.h"

#include <fixsplat/internal/packed.h>
#include "memory.h"

uint32_t fxs_places_room(const fxs_scene *scene, uint64_t bytes, uint64_t place_bytes)
{
    const uint32_t chunks = fxs_scene_chunks(scene);
    const uint64_t fits = bytes / place_bytes, room = fits < chunks ? fits : chunks;
    return room < FXS_PLACES_LEAST && room < chunks ? 0 : (uint32_t)room;
}

void fxs_places_init(fxs_places *p, const fxs_scene *scene, uint32_t room, uint32_t *of_chunks, fxs_place *list)
{
    const uint32_t share = room / FXS_KEPT_SHARE < FXS_KEPT_MOST ? room / FXS_KEPT_SHARE : FXS_KEPT_MOST;
    const uint32_t nodes = fxs_scene_chunks(scene) - scene->chunk_count, kept = share ? share : 1;
    *p = (fxs_places){.of_chunks = of_chunks, .list = list, .leaves = scene->chunk_count,
                      .chunks = fxs_scene_chunks(scene), .room = room, .kept = kept < nodes ? kept : nodes, .turn = 1,
                      .newest = FXS_NOTHING, .oldest = FXS_NOTHING};
    memset(of_chunks, 0xff, (size_t)p->chunks * sizeof *of_chunks);
    memset(list, 0xff, (size_t)room * sizeof *list);
}

static void leave_ring(fxs_places *p, uint32_t number)
{
    const fxs_place *at = &p->list[number];
    *(at->newer == FXS_NOTHING ? &p->newest : &p->list[at->newer].older) = at->older;
    *(at->older == FXS_NOTHING ? &p->oldest : &p->list[at->older].newer) = at->newer;
}

static void enter_ring(fxs_places *p, uint32_t number)
{
    fxs_place *at = &p->list[number];
    at->newer = FXS_NOTHING;
    at->older = p->newest;
    *(p->newest == FXS_NOTHING ? &p->oldest : &p->list[p->newest].newer) = number;
    p->newest = number;
}

static int is_kept(const fxs_places *p, uint32_t chunk)
{
    return chunk >= p->leaves && chunk - p->leaves < p->kept;
}

void fxs_places_note_drawn(fxs_places *p, uint32_t number)
{
    p->list[number].drawn = p->turn;
    if (is_kept(p, p->list[number].chunk) || p->newest == number)
        return;
    leave_ring(p, number);
    enter_ring(p, number);
}

void fxs_places_settle(fxs_places *p, uint32_t chunk, uint32_t number)
{
    p->list[number] = (fxs_place){chunk, p->turn, FXS_NOTHING, FXS_NOTHING};
    p->of_chunks[chunk] = number;
    p->there++;
    if (!is_kept(p, chunk))
        enter_ring(p, number);
}

uint32_t fxs_places_evict(fxs_places *p, uint32_t since)
{
    const uint32_t number = p->oldest;
    if (number == FXS_NOTHING || p->list[number].drawn >= since)
        return FXS_NOTHING;
    leave_ring(p, number);
    p->of_chunks[p->list[number].chunk] = FXS_NOTHING;
    p->list[number].chunk = FXS_NOTHING;
    p->there--;
    return number;
}
