/* The pool of a pager. src/core/pool_places.c chooses the chunks to evict. */
#include "pager_pool.h"

#include <string.h>

#include <fixsplat/internal/packed.h>

#include "src/base/os_calls.h"
#include "src/base/try_internal.h"

#define POOL_USUAL ((size_t)256 << 20)

enum {
    ROOM_LEAST = 256, ROOM_SHARE = 8,  /* a turn evicts at most this many chunks, or an eighth of a larger pool */
    FAILURES_MOST = 20
};

/* Puts a chunk of Gaussians that was read into its place of the pool. */
static void settle(fxs_pager_pool *p, fxs_arrival a)
{
    fxs_places_settle(&p->in_pool, a.chunk, a.place);
    p->taken[a.chunk] = 0;
}

/* Evicts the least recently drawn chunk of Gaussians from the pool, unless it was drawn in the current turn. */
static int free_place(fxs_pager_pool *p)
{
    const uint32_t number = fxs_places_evict(&p->in_pool, p->in_pool.turn);
    if (number == FXS_NOTHING)
        return 0;
    p->spare[p->spare_count++] = number;
    return 1;
}

/* After FXS_PAGER_TRIES failures in a row, which are the source's, chunks that counted as lost may be read again. */
static void note_success(fxs_pager_pool *p)
{
    if (p->failures >= FXS_PAGER_TRIES) {
        memset(p->tries, 0, p->chunks);
        p->lost = 0;
    }
    p->failures = 0;
}

void fxs_pager_pool_note(fxs_pager_pool *p, const fxs_arrival *list, uint32_t count, const uint8_t *good, int unread)
{
    if (!unread)
        note_success(p);
    else if (p->failures < FAILURES_MOST)
        p->failures++;
    for (uint32_t i = 0; i < count; i++) {
        if (good[i]) {
            p->arrived[p->arrived_count++] = list[i];
            p->bytes_read += p->chunk_bytes;
            continue;
        }
        p->taken[list[i].chunk] = 0;
        p->spare[p->spare_count++] = list[i].place;
        if (p->tries[list[i].chunk] < FXS_PAGER_TRIES)
            p->lost += ++p->tries[list[i].chunk] == FXS_PAGER_TRIES;
    }
}

uint32_t fxs_pager_pool_take(fxs_pager_pool *p, fxs_arrival *list, uint32_t most)
{
    uint32_t count = 0;
    while (count < most && p->queue_next < p->queue_count && p->spare_count) {
        const uint32_t chunk = p->queue[p->queue_next++];
        if (p->taken[chunk])
            continue;
        p->taken[chunk] = 1;
        list[count++] = (fxs_arrival){chunk, p->spare[--p->spare_count]};
    }
    return count;
}

unsigned char *fxs_pager_rows(const fxs_pager_pool *p, uint32_t place)
{
    return p->rows + (size_t)place * p->chunk_bytes;
}

void *fxs_pager_allocate(fxs_pager_pool *p, uint64_t count, size_t size)
{
    const int fits = count <= (SIZE_MAX - 64) / size;
    void *block = fits ? fxs_aligned_allocate((size_t)count * size + (count ? 0 : 1)) : 0;
    p->memory += block ? (size_t)count * size : 0;
    return block;
}

static int choose_room(fxs_pager_pool *p, const fxs_scene *scene, size_t bytes, const char *name, fxs_message *message)
{
    bytes = bytes ? bytes : POOL_USUAL;
    p->chunks = fxs_scene_chunks(scene);
    p->chunk_bytes = scene->chunk_bytes;
    p->room = fxs_places_room(scene, bytes, p->chunk_bytes);
    return p->room ? 0 : fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: a pool of %zu bytes is too little: %zu at least",
                                     name, bytes, FXS_PLACES_LEAST * p->chunk_bytes);
}

static int allocate_all(fxs_pager_pool *p)
{
    p->rows = fxs_pager_allocate(p, p->room, p->chunk_bytes);
    p->places = fxs_pager_allocate(p, p->chunks, sizeof *p->places);
    p->asked = fxs_pager_allocate(p, p->chunks, sizeof *p->asked);
    p->tries = fxs_pager_allocate(p, p->chunks, sizeof *p->tries);
    p->taken = fxs_pager_allocate(p, p->chunks, sizeof *p->taken);
    p->list = fxs_pager_allocate(p, p->room, sizeof *p->list);
    p->wanted = fxs_pager_allocate(p, p->room, sizeof *p->wanted);
    p->queue = fxs_pager_allocate(p, (uint64_t)p->room + FXS_KEPT_MOST, sizeof *p->queue);
    p->spare = fxs_pager_allocate(p, p->room, sizeof *p->spare);
    p->arrived = fxs_pager_allocate(p, p->room, sizeof *p->arrived);
    return p->rows && p->places && p->asked && p->tries && p->taken && p->list && p->wanted && p->queue &&
           p->spare && p->arrived;
}

int fxs_pager_pool_create(fxs_pager_pool *p, fxs_scene *scene, size_t bytes, const char *name, fxs_message *message)
{
    FXS_TRY(choose_room(p, scene, bytes, name, message));
    if (!allocate_all(p))
        return fxs_fail_memory(message, name, (uint64_t)p->room * p->chunk_bytes);
    fxs_places_init(&p->in_pool, scene, p->room, p->places, p->list);
    memset(p->asked, 0, p->chunks * sizeof *p->asked);
    memset(p->tries, 0, p->chunks);
    memset(p->taken, 0, p->chunks);
    for (p->spare_count = 0; p->spare_count < p->room; p->spare_count++)
        p->spare[p->spare_count] = p->room - 1 - p->spare_count;
    scene->rows = p->rows;
    scene->places = p->places;
    return 0;
}

void fxs_pager_pool_free(fxs_pager_pool *p)
{
    void *blocks[] = {p->rows, p->places, p->asked, p->tries, p->taken, p->list, p->wanted, p->queue, p->spare,
                      p->arrived};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
        fxs_aligned_free(blocks[i]);
}

void fxs_pager_pool_root(fxs_pager_pool *p, uint32_t place)
{
    p->bytes_read += p->chunk_bytes;
    settle(p, (fxs_arrival){p->in_pool.leaves, place});
}

void fxs_pager_pool_want(fxs_pager_pool *p, uint32_t chunk, int there)
{
    if (!p->has_asked) {
        p->in_pool.turn++;
        p->wanted_count = 0;
        p->has_asked = 1;
    }
    if (there && p->places[chunk] != FXS_NOTHING) {
        fxs_places_note_drawn(&p->in_pool, p->places[chunk]);
    } else if (p->asked[chunk] != p->in_pool.turn) {
        p->asked[chunk] = p->in_pool.turn;
        if (p->wanted_count < p->room)
            p->wanted[p->wanted_count++] = chunk;
    }
}

static void enqueue(fxs_pager_pool *p, uint32_t chunk)
{
    const int readable = p->tries[chunk] < FXS_PAGER_TRIES || p->failures >= FXS_PAGER_TRIES;
    if (!p->taken[chunk] && p->places[chunk] == FXS_NOTHING && readable)
        p->queue[p->queue_count++] = chunk;
}

/* Fills the queue of chunks to read: first those that frames need, then the coarsest. */
static void fill_queue(fxs_pager_pool *p)
{
    p->queue_count = p->queue_next = 0;
    for (uint32_t i = 0; i < p->wanted_count; i++)
        enqueue(p, p->wanted[i]);
    for (uint32_t chunk = p->in_pool.leaves; chunk < p->in_pool.leaves + p->in_pool.kept; chunk++)
        if (p->asked[chunk] != p->in_pool.turn)
            enqueue(p, chunk);
}

/* Evicts chunks to make room in the pool. Limits their number, because an evicted chunk may be needed again soon. */
static void free_places(fxs_pager_pool *p, uint32_t left)
{
    const uint32_t share = p->room / ROOM_SHARE > ROOM_LEAST ? p->room / ROOM_SHARE : ROOM_LEAST;
    const uint32_t need = left < share ? left : share;
    while (p->spare_count < need && free_place(p))
        ;
}

void fxs_pager_pool_turn(fxs_pager_pool *p, fxs_pager_state *state)
{
    const uint32_t arrived = p->arrived_count;
    for (uint32_t i = 0; i < arrived; i++)
        settle(p, p->arrived[i]);
    p->arrived_count = 0;
    p->has_asked = 0;
    fill_queue(p);
    const uint32_t left = p->queue_count;
    free_places(p, left);
    const fxs_places *in = &p->in_pool;
    const int is_full = in->oldest == FXS_NOTHING || in->list[in->oldest].drawn == in->turn;
    *state = (fxs_pager_state){
        .chunks = p->chunks, .room = p->room, .there = in->there, .arrived = arrived,
        .coming = left + (p->room - in->there - p->spare_count),
        .no_room = is_full && left > p->spare_count ? left - p->spare_count : 0, .lost = p->lost,
        .bytes_read = p->bytes_read, .memory = p->memory
    };
}
