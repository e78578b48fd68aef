/* The pool of a pager. Places whose chunks may be evicted form a linked list in the order of last use: the least
 * recently drawn chunk is evicted first. The coarsest chunks (256 merged Gaussians each) always stay. */
#include "pager_pool.h"

#include <string.h>

#include <fixsplat/internal/packed.h>

#include "src/base/os_calls.h"
#include "src/base/try_internal.h"

#define POOL_USUAL ((size_t)256 << 20)

enum {
    PLACES_LEAST = 16,
    KEPT_SHARE = 8, KEPT_MOST = 256,   /* 1/8 of the pool keeps coarse chunks, 256 at most */
    ROOM_LEAST = 256,                  /* a turn evicts at most this many chunks, or an eighth of a larger pool */
    FAILURES_MOST = 20
};

struct fxs_pager_place {
    uint32_t chunk;                    /* FXS_NOTHING: the place is free or being filled */
    uint32_t drawn;                    /* last turn in which the chunk was drawn */
    uint32_t newer, older;
};

static void leave_ring(fxs_pager_pool *p, uint32_t number)
{
    const fxs_pager_place *at = &p->in_pool[number];
    *(at->newer == FXS_NOTHING ? &p->newest : &p->in_pool[at->newer].older) = at->older;
    *(at->older == FXS_NOTHING ? &p->oldest : &p->in_pool[at->older].newer) = at->newer;
}

static void enter_ring(fxs_pager_pool *p, uint32_t number)
{
    fxs_pager_place *at = &p->in_pool[number];
    at->newer = FXS_NOTHING;
    at->older = p->newest;
    *(p->newest == FXS_NOTHING ? &p->oldest : &p->in_pool[p->newest].newer) = number;
    p->newest = number;
}

static int is_kept(const fxs_pager_pool *p, uint32_t chunk)
{
    return chunk >= p->leaves && chunk - p->leaves < p->kept;
}

static void note_drawn(fxs_pager_pool *p, uint32_t number)
{
    p->in_pool[number].drawn = p->turn;
    if (is_kept(p, p->in_pool[number].chunk) || p->newest == number)
        return;
    leave_ring(p, number);
    enter_ring(p, number);
}

/* Puts a chunk of Gaussians that was read into its place of the pool. */
static void settle(fxs_pager_pool *p, fxs_arrival a)
{
    p->in_pool[a.place] = (fxs_pager_place){a.chunk, p->turn, FXS_NOTHING, FXS_NOTHING};
    p->places[a.chunk] = a.place;
    p->taken[a.chunk] = 0;
    p->there++;
    if (!is_kept(p, a.chunk))
        enter_ring(p, a.place);
}

/* Evicts the least recently drawn chunk of Gaussians from the pool, unless it was drawn in the current turn. */
static int free_place(fxs_pager_pool *p)
{
    const uint32_t number = p->oldest;
    if (number == FXS_NOTHING || p->in_pool[number].drawn == p->turn)
        return 0;
    leave_ring(p, number);
    p->places[p->in_pool[number].chunk] = FXS_NOTHING;
    p->in_pool[number].chunk = FXS_NOTHING;
    p->spare[p->spare_count++] = number;
    p->there--;
    return 1;
}

/* After FXS_PAGER_TRIES failures in a row, chunks that counted as lost may be read again. */
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

/* Chooses the number of places from the pool's size, and how many coarse chunks stay. */
static int choose_room(fxs_pager_pool *p, const fxs_scene *scene, size_t bytes, const char *name, fxs_message *message)
{
    bytes = bytes ? bytes : POOL_USUAL;
    p->leaves = scene->chunk_count;
    p->chunks = fxs_scene_chunks(scene);
    p->chunk_bytes = scene->chunk_bytes;
    p->room = bytes / p->chunk_bytes < p->chunks ? (uint32_t)(bytes / p->chunk_bytes) : p->chunks;
    if (p->room < PLACES_LEAST && p->room < p->chunks)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: a pool of %zu bytes is too little: %zu at least", name,
                           bytes, PLACES_LEAST * p->chunk_bytes);
    p->kept = p->room / KEPT_SHARE < KEPT_MOST ? p->room / KEPT_SHARE : KEPT_MOST;
    p->kept = p->kept < p->leaves - 1 ? p->kept : p->leaves - 1;
    p->kept += p->kept == 0;
    return 0;
}

static int allocate_all(fxs_pager_pool *p)
{
    p->rows = fxs_pager_allocate(p, p->room, p->chunk_bytes);
    p->places = fxs_pager_allocate(p, p->chunks, sizeof *p->places);
    p->asked = fxs_pager_allocate(p, p->chunks, sizeof *p->asked);
    p->tries = fxs_pager_allocate(p, p->chunks, sizeof *p->tries);
    p->taken = fxs_pager_allocate(p, p->chunks, sizeof *p->taken);
    p->in_pool = fxs_pager_allocate(p, p->room, sizeof *p->in_pool);
    p->wanted = fxs_pager_allocate(p, p->room, sizeof *p->wanted);
    p->queue = fxs_pager_allocate(p, (uint64_t)p->room + p->kept, sizeof *p->queue);
    p->spare = fxs_pager_allocate(p, p->room, sizeof *p->spare);
    p->arrived = fxs_pager_allocate(p, p->room, sizeof *p->arrived);
    return p->rows && p->places && p->asked && p->tries && p->taken && p->in_pool && p->wanted && p->queue &&
           p->spare && p->arrived;
}

int fxs_pager_pool_create(fxs_pager_pool *p, fxs_scene *scene, size_t bytes, const char *name, fxs_message *message)
{
    FXS_TRY(choose_room(p, scene, bytes, name, message));
    if (!allocate_all(p))
        return fxs_fail_memory(message, name, (uint64_t)p->room * p->chunk_bytes);
    memset(p->places, 0xff, p->chunks * sizeof *p->places);
    memset(p->asked, 0, p->chunks * sizeof *p->asked);
    memset(p->tries, 0, p->chunks);
    memset(p->taken, 0, p->chunks);
    for (p->spare_count = 0; p->spare_count < p->room; p->spare_count++)
        p->spare[p->spare_count] = p->room - 1 - p->spare_count;
    p->newest = p->oldest = FXS_NOTHING;
    p->turn = 1;
    scene->rows = p->rows;
    scene->places = p->places;
    return 0;
}

void fxs_pager_pool_free(fxs_pager_pool *p)
{
    void *blocks[] = {p->rows, p->places, p->asked, p->tries, p->taken, p->in_pool, p->wanted, p->queue, p->spare,
                      p->arrived};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
        fxs_aligned_free(blocks[i]);
}

void fxs_pager_pool_root(fxs_pager_pool *p, uint32_t place)
{
    p->bytes_read += p->chunk_bytes;
    settle(p, (fxs_arrival){p->leaves, place});
}

void fxs_pager_pool_want(fxs_pager_pool *p, uint32_t chunk, int there)
{
    if (!p->has_asked) {
        p->turn++;
        p->wanted_count = 0;
        p->has_asked = 1;
    }
    if (there && p->places[chunk] != FXS_NOTHING) {
        note_drawn(p, p->places[chunk]);
    } else if (p->asked[chunk] != p->turn) {
        p->asked[chunk] = p->turn;
        if (p->wanted_count < p->room)
            p->wanted[p->wanted_count++] = chunk;
    }
}

static void enqueue(fxs_pager_pool *p, uint32_t chunk)
{
    if (!p->taken[chunk] && p->places[chunk] == FXS_NOTHING && p->tries[chunk] < FXS_PAGER_TRIES)
        p->queue[p->queue_count++] = chunk;
}

/* Fills the queue of chunks to read: first those that frames need, then the coarsest. */
static void fill_queue(fxs_pager_pool *p)
{
    p->queue_count = p->queue_next = 0;
    for (uint32_t i = 0; i < p->wanted_count; i++)
        enqueue(p, p->wanted[i]);
    for (uint32_t chunk = p->leaves; chunk < p->leaves + p->kept; chunk++)
        if (p->asked[chunk] != p->turn)
            enqueue(p, chunk);
}

/* Evicts chunks to make room in the pool. Limits their number, because an evicted chunk may be needed again soon. */
static void free_places(fxs_pager_pool *p, uint32_t left)
{
    const uint32_t share = p->room / KEPT_SHARE > ROOM_LEAST ? p->room / KEPT_SHARE : ROOM_LEAST;
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
    const int is_full = p->oldest == FXS_NOTHING || p->in_pool[p->oldest].drawn == p->turn;
    *state = (fxs_pager_state){
        .chunks = p->chunks, .room = p->room, .there = p->there, .arrived = arrived,
        .coming = left + (p->room - p->there - p->spare_count),
        .no_room = is_full && left > p->spare_count ? left - p->spare_count : 0, .lost = p->lost,
        .bytes_read = p->bytes_read, .memory = p->memory
    };
}
