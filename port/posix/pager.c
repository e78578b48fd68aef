/* Renders a packed scene that is larger than memory. A pool has places for some of the scene's chunks of 256 Gaussians.
 * The caller's thread draws from the pool, while a reader thread fills free places. Only fxs_pager_turn, called between
 * frames, assigns a place to a chunk or evicts a chunk. */
#include <fixsplat/pager.h>

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/system.h>
#include <fixsplat/internal/message.h>
#include <fixsplat/internal/packed.h>
#include <fixsplat/internal/pager_more.h>
#include <fixsplat/internal/parts.h>

#include "src/base/crc32.h"
#include "src/base/options.h"
#include "src/base/os_calls.h"
#include "src/base/try_internal.h"
#include "src/scene/fxs_file_internal.h"
#include "timed_wait.h"

#define POOL_USUAL ((size_t)256 << 20)

enum {
    PLACES_LEAST = 16,
    /* the coarsest chunks (256 merged Gaussians each) always stay in the pool: 1/8 of it, 256 at most */
    KEPT_SHARE = 8, KEPT_MOST = 256,
    HEAD_PIECE = 1 << 20,
    READ_MOST = 1 << 20,
    BATCH_LEAST = 8, BATCH_MOST = 256, /* least and most chunks of 256 Gaussians that are read together in a batch */
    BATCH_APART = 64,
    BATCH_QUICK_MS = 20, BATCH_SLOW_MS = 100,
    ROOM_LEAST = 256,
    /* a chunk is lost after this many failed reads; an error is reported after this many failures in a row */
    TRIES = 3,
    PAUSE_MS = 100, PAUSE_MOST = 20
};

/* A place of the pool, with room for a chunk of 256 Gaussians. Places whose chunks may be evicted form a linked list in
   the order of last use. */
typedef struct place {
    /* index of the chunk (256 Gaussians) in this place; FXS_NOTHING: the place is free or being filled */
    uint32_t chunk;
    uint32_t drawn;
    uint32_t newer, older;
} place;

typedef struct arrival {
    uint32_t chunk, place;
} arrival;

struct fxs_pager {
    fxs_scene scene;
    fxs_scene_parts parts;
    fxs_pager_source source;
    fxs_pager_options options;
    fxs_crc32_table table;
    char *name;
    unsigned char *head, *tree, *pool, *stage;
    size_t memory, stage_bytes;
    uint32_t chunks, room, kept;   /* kept: number of coarse chunks of Gaussians that are never evicted from the pool */

    /* The fields from here to the lock are for the caller's thread only. */
    uint32_t *places;                  /* index of each chunk's place in the pool; FXS_NOTHING: not in the pool */
    uint32_t *asked;
    place *in_pool;
    uint32_t newest, oldest, there;
    uint32_t turn;
    int has_asked;
    /* chunks of Gaussians that the current frames need but the pool lacks, most needed first */
    uint32_t *wanted, wanted_count;

    pthread_mutex_t lock;              /* mutex that guards all fields below */
    pthread_cond_t work, done;
    pthread_t reader;
    int has_reader, stop, reading;
    uint8_t *tries;
    uint8_t *taken;
    uint32_t *queue, queue_count, queue_next;
    uint32_t *spare, spare_count;
    arrival *arrived;
    uint32_t arrived_count, batch_least, batch_most, lost;
    uint64_t bytes_read;
    int error;
    fxs_message why;
    uint32_t failures;
};

static void leave_ring(fxs_pager *p, uint32_t number)
{
    const place *at = &p->in_pool[number];
    *(at->newer == FXS_NOTHING ? &p->newest : &p->in_pool[at->newer].older) = at->older;
    *(at->older == FXS_NOTHING ? &p->oldest : &p->in_pool[at->older].newer) = at->newer;
}

static void enter_ring(fxs_pager *p, uint32_t number)
{
    place *at = &p->in_pool[number];
    at->newer = FXS_NOTHING;
    at->older = p->newest;
    *(p->newest == FXS_NOTHING ? &p->oldest : &p->in_pool[p->newest].newer) = number;
    p->newest = number;
}

static int is_kept(const fxs_pager *p, uint32_t chunk)
{
    return chunk >= p->scene.chunk_count && chunk - p->scene.chunk_count < p->kept;
}

static void note_drawn(fxs_pager *p, uint32_t number)
{
    p->in_pool[number].drawn = p->turn;
    if (is_kept(p, p->in_pool[number].chunk) || p->newest == number)
        return;
    leave_ring(p, number);
    enter_ring(p, number);
}

/* Puts a chunk of Gaussians that was read into its place of the pool. The caller holds the lock. */
static void settle(fxs_pager *p, arrival a)
{
    p->in_pool[a.place] = (place){a.chunk, p->turn, FXS_NOTHING, FXS_NOTHING};
    p->places[a.chunk] = a.place;
    p->taken[a.chunk] = 0;
    p->there++;
    if (!is_kept(p, a.chunk))
        enter_ring(p, a.place);
}

/* Evicts the least recently drawn chunk of Gaussians from the pool, unless it was drawn in the current turn. The caller
   holds the lock. */
static int free_place(fxs_pager *p)
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

static uint64_t offset_of(const fxs_pager *p, uint32_t chunk)
{
    const uint32_t leaves = p->scene.chunk_count;
    return chunk < leaves ? p->parts.rows + (uint64_t)chunk * p->scene.chunk_bytes
                          : p->parts.node_rows + (uint64_t)(chunk - leaves) * p->scene.chunk_bytes;
}

static int by_chunk(const void *a, const void *b)
{
    const uint32_t x = ((const arrival *)a)->chunk, y = ((const arrival *)b)->chunk;
    return (x > y) - (x < y);
}

static uint32_t run_of(const fxs_pager *p, const arrival *list, uint32_t count)
{
    const uint64_t start = offset_of(p, list[0].chunk), size = p->scene.chunk_bytes;
    uint32_t run = 1;
    while (run < count && offset_of(p, list[run].chunk) - offset_of(p, list[run - 1].chunk) - size <= p->source.gap &&
           offset_of(p, list[run].chunk) + size - start <= p->stage_bytes)
        run++;
    return run;
}

static unsigned char *place_at(const fxs_pager *p, uint32_t number)
{
    return p->pool + (size_t)number * p->scene.chunk_bytes;
}

static int read_source(const fxs_pager *p, uint64_t offset, void *out, size_t size, fxs_message *why)
{
    why->text[0] = 0;
    const int error = p->source.read(p->source.argument, offset, out, size, why);
    if (error && !why->text[0])
        fxs_fail(why, "%s: cannot be read", p->name);
    return error > 0 ? FXS_ERR_FILE : error;
}

/* Reads chunks of Gaussians that follow each other in the file. good[i] = 1: chunk i is valid. *unread = 1: the read
   itself failed. */
static int read_run(fxs_pager *p, const arrival *list, uint32_t count, uint8_t *good, int *unread, fxs_message *why)
{
    const uint64_t start = offset_of(p, list[0].chunk);
    const size_t size = (size_t)(offset_of(p, list[count - 1].chunk) - start) + p->scene.chunk_bytes;
    int result = read_source(p, start, p->stage, size, why);
    *unread = result != 0;
    for (uint32_t i = 0; i < count; i++) {
        const unsigned char *rows = p->stage + (offset_of(p, list[i].chunk) - start);
        const int error = *unread ? result
                                  : fxs_file_check_chunk(p->name, &p->table, &p->scene, list[i].chunk, rows, why);
        good[i] = !error;
        if (good[i])
            memcpy(place_at(p, list[i].place), rows, p->scene.chunk_bytes);
        else
            result = error;
    }
    return result;
}

/* Notes a successful read of chunks of Gaussians. After TRIES failures in a row, chunks that counted as lost may be
   read again. The caller holds the lock. */
static void note_success(fxs_pager *p)
{
    if (p->failures >= TRIES) {
        memset(p->tries, 0, p->chunks);
        p->lost = 0;
    }
    p->failures = 0;
}

/* Notes which chunks of Gaussians a batch has read, for the next call of fxs_pager_turn. The caller holds the lock. */
static void hand_over(fxs_pager *p, const arrival *list, uint32_t count, const uint8_t *good, int unread)
{
    if (!unread)
        note_success(p);
    else if (p->failures < PAUSE_MOST && ++p->failures == TRIES)
        pthread_cond_broadcast(&p->done);
    for (uint32_t i = 0; i < count; i++) {
        if (good[i]) {
            p->arrived[p->arrived_count++] = list[i];
            p->bytes_read += p->scene.chunk_bytes;
            continue;
        }
        p->taken[list[i].chunk] = 0;
        p->spare[p->spare_count++] = list[i].place;
        p->lost += ++p->tries[list[i].chunk] == TRIES;
    }
}

/* Takes chunks of Gaussians from the queue for a batch, and assigns free places of the pool to them. The caller holds
   the lock. */
static uint32_t take_batch(fxs_pager *p, arrival *list)
{
    uint32_t count = 0;
    while (count < p->batch_most && p->queue_next < p->queue_count && p->spare_count) {
        const uint32_t chunk = p->queue[p->queue_next++];
        if (p->taken[chunk])
            continue;
        p->taken[chunk] = 1;
        list[count++] = (arrival){chunk, p->spare[--p->spare_count]};
    }
    return count;
}

static void tell_arrived(fxs_pager *p)
{
    if (!p->options.arrived || !p->arrived_count)
        return;
    pthread_mutex_unlock(&p->lock);
    p->options.arrived(p->options.arrived_argument);
    pthread_mutex_lock(&p->lock);
}

/* Reads a batch of chunks of Gaussians. Releases the caller's lock during each read. Adapts batch_most to the time that
   the batch took. */
static void read_batch(fxs_pager *p, arrival *list, uint32_t count)
{
    const uint64_t start = fxs_clock(0);
    uint8_t good[BATCH_MOST];
    int unread;
    fxs_message why = {.bytes_needed = 0};
    qsort(list, count, sizeof *list, by_chunk);
    for (uint32_t first = 0, run; first < count; first += run) {
        run = run_of(p, list + first, count - first);
        if (p->stop)
            return;
        pthread_mutex_unlock(&p->lock);
        const int error = read_run(p, list + first, run, good, &unread, &why);
        pthread_mutex_lock(&p->lock);
        hand_over(p, list + first, run, good, unread);
        if (error) {
            p->error = error;
            p->why = why;
        }
        tell_arrived(p);
    }
    const uint64_t milliseconds = (fxs_clock(0) - start) / 1000000;
    if (milliseconds < BATCH_QUICK_MS && p->batch_most < BATCH_MOST)
        p->batch_most *= 2;
    else if (milliseconds > BATCH_SLOW_MS && p->batch_most > p->batch_least)
        p->batch_most /= 2;
}

static void hold_off(fxs_pager *p)
{
    const uint64_t end = fxs_clock(0) + (uint64_t)PAUSE_MS * 1000000 * p->failures;
    while (!p->stop && !timed_wait(&p->work, &p->lock, end))
        ;
}

static void *read_wanted(void *pager)
{
    fxs_pager *p = pager;
    arrival list[BATCH_MOST];
    pthread_mutex_lock(&p->lock);
    while (!p->stop) {
        const uint32_t count = take_batch(p, list);
        p->reading = count > 0;
        if (!count) {
            pthread_cond_broadcast(&p->done);
            pthread_cond_wait(&p->work, &p->lock);
            continue;
        }
        read_batch(p, list, count);
        if (p->failures)
            hold_off(p);
    }
    p->reading = 0;
    pthread_cond_broadcast(&p->done);
    pthread_mutex_unlock(&p->lock);
    return 0;
}

static void *allocate(fxs_pager *p, uint64_t count, size_t size)
{
    const int fits = count <= (SIZE_MAX - 64) / size;
    void *block = fits ? fxs_aligned_allocate((size_t)count * size + (count ? 0 : 1)) : 0;
    p->memory += block ? (size_t)count * size : 0;
    return block;
}

/* Reads the scene's headers in pieces, so that a false size in a damaged file costs no physical memory. */
static int read_head(fxs_pager *p, uint64_t offset, unsigned char *out, uint64_t size, fxs_message *message)
{
    for (uint64_t done = 0; done < size;) {
        const size_t piece = size - done < HEAD_PIECE ? (size_t)(size - done) : HEAD_PIECE;
        FXS_TRY(read_source(p, offset + done, out + done, piece, message));
        done += piece;
        p->bytes_read += piece;
    }
    return 0;
}

static int read_header(fxs_pager *p, unsigned char *header, fxs_message *message)
{
    if (p->source.size < sizeof(fxs_packed_header))
        return fxs_fail(message, "%s: not an .fxs file", p->name);
    FXS_TRY(read_head(p, 0, header, sizeof(fxs_packed_header), message));
    FXS_TRY(fxs_file_check_header(p->name, &p->table, header, message));
    if (fxs_scene_find_parts(&p->parts, header))
        return fxs_fail(message, "%s: damaged: its header makes no sense", p->name);
    if (p->parts.bytes == p->parts.tree)
        return fxs_fail(message, "%s: has no levels of detail, so it cannot be read in part; convert --levels makes "
                        "them", p->name);
    if (p->source.size < p->parts.bytes)
        return fxs_fail(message, "%s: damaged or cut short: %llu bytes, expected %llu", p->name,
                        (unsigned long long)p->source.size, (unsigned long long)p->parts.bytes);
    return 0;
}

static int read_heads(fxs_pager *p, fxs_message *message)
{
    unsigned char header[sizeof(fxs_packed_header)];
    const size_t known = sizeof header;
    fxs_crc32_fill(&p->table);
    FXS_TRY(read_header(p, header, message));
    p->head = allocate(p, p->parts.rows, 1);
    p->tree = allocate(p, p->parts.node_rows - p->parts.tree, 1);
    if (!p->head || !p->tree)
        return fxs_fail_memory(message, p->name, p->parts.rows + p->parts.node_rows - p->parts.tree);
    memcpy(p->head, header, known);
    FXS_TRY(read_head(p, known, p->head + known, p->parts.rows - known, message));
    FXS_TRY(read_head(p, p->parts.tree, p->tree, p->parts.node_rows - p->parts.tree, message));
    const int error = fxs_scene_open_parts(&p->scene, p->head, p->tree);
    if (error)
        return fxs_fail_as(error, message, "%s: %s", p->name, fxs_strerror(error));
    return fxs_file_check_heads(p->name, &p->table, p->head, &p->scene,
                                p->scene.palette ? (size_t)(p->parts.rows - p->parts.palette) : 0, message);
}

static int make_room(fxs_pager *p, fxs_message *message)
{
    const size_t bytes = p->options.pool_bytes ? p->options.pool_bytes : POOL_USUAL, each = p->scene.chunk_bytes;
    p->chunks = fxs_scene_chunks(&p->scene);
    p->room = bytes / each < p->chunks ? (uint32_t)(bytes / each) : p->chunks;
    if (p->room < PLACES_LEAST && p->room < p->chunks)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: a pool of %zu bytes is too little: %zu at least", p->name,
                           bytes, PLACES_LEAST * each);
    p->kept = p->room / KEPT_SHARE < KEPT_MOST ? p->room / KEPT_SHARE : KEPT_MOST;
    p->kept = p->kept < p->scene.chunk_count - 1 ? p->kept : p->scene.chunk_count - 1;
    p->kept += p->kept == 0;
    p->stage_bytes = READ_MOST > each ? READ_MOST : each;
    p->pool = allocate(p, p->room, each);
    p->stage = allocate(p, p->stage_bytes, 1);
    p->places = allocate(p, p->chunks, sizeof *p->places);
    p->asked = allocate(p, p->chunks, sizeof *p->asked);
    p->tries = allocate(p, p->chunks, sizeof *p->tries);
    p->taken = allocate(p, p->chunks, sizeof *p->taken);
    p->in_pool = allocate(p, p->room, sizeof *p->in_pool);
    p->wanted = allocate(p, p->room, sizeof *p->wanted);
    p->queue = allocate(p, (uint64_t)p->room + p->kept, sizeof *p->queue);
    p->spare = allocate(p, p->room, sizeof *p->spare);
    p->arrived = allocate(p, p->room, sizeof *p->arrived);
    if (!p->pool || !p->stage || !p->places || !p->asked || !p->tries || !p->taken || !p->in_pool || !p->wanted ||
        !p->queue || !p->spare || !p->arrived)
        return fxs_fail_memory(message, p->name, (uint64_t)p->room * each);
    memset(p->places, 0xff, p->chunks * sizeof *p->places);
    memset(p->asked, 0, p->chunks * sizeof *p->asked);
    memset(p->tries, 0, p->chunks);
    memset(p->taken, 0, p->chunks);
    for (p->spare_count = 0; p->spare_count < p->room; p->spare_count++)
        p->spare[p->spare_count] = p->room - 1 - p->spare_count;
    p->scene.rows = p->pool;
    p->scene.places = p->places;
    p->turn = 1;
    return 0;
}

static int read_root(fxs_pager *p, fxs_message *message)
{
    const arrival root = {p->scene.chunk_count, p->spare[--p->spare_count]};
    uint8_t good;
    int unread;
    FXS_TRY(read_run(p, &root, 1, &good, &unread, message));
    p->bytes_read += p->scene.chunk_bytes;
    settle(p, root);
    return 0;
}

static int start_reader(fxs_pager *p, fxs_message *message)
{
    p->has_reader = !pthread_create(&p->reader, 0, read_wanted, p);
    return p->has_reader ? 0 : fxs_fail_as(FXS_ERR_MEMORY, message, "%s: cannot start a thread", p->name);
}

static fxs_pager *make(const char *name, const fxs_pager_source *source, const fxs_pager_options *options)
{
    fxs_pager *p = calloc(1, sizeof *p);
    if (!p || !(p->name = strdup(name))) {
        free(p);
        return 0;
    }
    p->source = *source;
    p->options = *options;
    p->newest = p->oldest = FXS_NOTHING;
    p->batch_least = p->batch_most = source->gap ? BATCH_APART : BATCH_LEAST;
    pthread_mutex_init(&p->lock, 0);
    timed_condition_init(&p->work);
    timed_condition_init(&p->done);
    return p;
}

static void close_source(const fxs_pager_source *source)
{
    if (source && source->close)
        source->close(source->argument);
}

int fxs_pager_open(const char *name, const fxs_pager_source *source, const fxs_pager_options *options,
                   fxs_pager **pager, fxs_message *message)
{
    if (pager)
        *pager = 0;
    if (!name || !source || !source->read || !pager) {
        close_source(source);
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "no %s to open a scene",
                           !name ? "name" : pager ? "source" : "place");
    }
    fxs_pager_options all;
    fxs_pager_options_init(&all);
    const int unset = FXS_OPTIONS_READ(fxs_pager_options, &all, options, message);
    if (unset) {
        close_source(source);
        return unset;
    }
    fxs_pager *p = make(name, source, &all);
    if (!p) {
        close_source(source);
        return fxs_fail_memory(message, name, sizeof *p);
    }
    int error = read_heads(p, message);
    error = error ? error : make_room(p, message);
    error = error ? error : read_root(p, message);
    error = error ? error : start_reader(p, message);
    if (error)
        fxs_pager_close(p);
    else
        *pager = p;
    return error;
}

int fxs_pager_open_file(const char *path, const fxs_pager_options *options, fxs_pager **pager, fxs_message *message)
{
    fxs_pager_source source;
    if (pager)
        *pager = 0;
    if (!path || !pager)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "no %s to open a scene", path ? "place" : "name");
    FXS_TRY((fxs_pager_is_url(path) ? fxs_pager_url : fxs_pager_file)(path, &source, message));
    return fxs_pager_open(path, &source, options, pager, message);
}

void fxs_pager_close(fxs_pager *p)
{
    if (!p)
        return;
    pthread_mutex_lock(&p->lock);
    p->stop = 1;
    pthread_cond_broadcast(&p->work);
    pthread_mutex_unlock(&p->lock);
    if (p->has_reader) {
        if (p->source.cancel)
            p->source.cancel(p->source.argument);
        pthread_join(p->reader, 0);
    }
    if (p->source.close)
        p->source.close(p->source.argument);
    void *blocks[] = {p->head, p->tree, p->pool, p->stage, p->places, p->asked, p->tries, p->taken, p->in_pool,
                      p->wanted, p->queue, p->spare, p->arrived};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
        fxs_aligned_free(blocks[i]);
    free(p->name);
    pthread_cond_destroy(&p->work);
    pthread_cond_destroy(&p->done);
    pthread_mutex_destroy(&p->lock);
    free(p);
}

const fxs_scene *fxs_pager_scene(const fxs_pager *pager)
{
    return &pager->scene;
}

const void *fxs_pager_head(const fxs_pager *pager)
{
    return pager->head;
}

uint32_t fxs_pager_room(const fxs_pager *pager)
{
    return pager ? pager->room : 0;
}

void fxs_pager_want(void *pager, const fxs_scene *scene, uint32_t chunk, int there)
{
    fxs_pager *p = pager;
    if (scene != &p->scene || chunk >= p->chunks)
        return;
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

/* Fills the queue of chunks of Gaussians to read: first those that frames need, then the coarsest. The caller holds the
   lock. */
static void fill_queue(fxs_pager *p)
{
    const uint32_t leaves = p->scene.chunk_count;
    p->queue_count = p->queue_next = 0;
    for (uint32_t i = 0; i < p->wanted_count; i++) {
        const uint32_t chunk = p->wanted[i];
        if (!p->taken[chunk] && p->places[chunk] == FXS_NOTHING && p->tries[chunk] < TRIES)
            p->queue[p->queue_count++] = chunk;
    }
    for (uint32_t chunk = leaves; chunk < leaves + p->kept; chunk++)
        if (!p->taken[chunk] && p->places[chunk] == FXS_NOTHING && p->tries[chunk] < TRIES &&
            p->asked[chunk] != p->turn)
            p->queue[p->queue_count++] = chunk;
}

static uint32_t left_in_queue(const fxs_pager *p)
{
    return p->queue_count - p->queue_next;
}

/* Evicts chunks of Gaussians to make room in the pool. Limits their number, because an evicted chunk may be needed
   again soon. The caller holds the lock. */
static void free_places(fxs_pager *p)
{
    const uint32_t share = p->room / KEPT_SHARE > ROOM_LEAST ? p->room / KEPT_SHARE : ROOM_LEAST;
    const uint32_t need = left_in_queue(p) < share ? left_in_queue(p) : share;
    while (p->spare_count < need && free_place(p))
        ;
}

int fxs_pager_turn(fxs_pager *p, fxs_pager_state *state, fxs_message *message)
{
    pthread_mutex_lock(&p->lock);
    const uint32_t arrived = p->arrived_count;
    for (uint32_t i = 0; i < arrived; i++)
        settle(p, p->arrived[i]);
    p->arrived_count = 0;
    p->has_asked = 0;
    fill_queue(p);
    free_places(p);
    const uint32_t left = left_in_queue(p);
    const int is_full = p->oldest == FXS_NOTHING || p->in_pool[p->oldest].drawn == p->turn;
    if (state)
        *state = (fxs_pager_state){
            .chunks = p->chunks, .room = p->room, .there = p->there, .arrived = arrived,
            .coming = left + (p->room - p->there - p->spare_count),
            .no_room = is_full && left > p->spare_count ? left - p->spare_count : 0, .lost = p->lost,
            .bytes_read = p->bytes_read, .memory = p->memory
        };
    const int error = p->lost || p->failures >= TRIES ? p->error : 0;
    if (error && message)
        *message = p->why;
    p->reading |= left > 0 && p->spare_count > 0;
    pthread_cond_signal(&p->work);
    pthread_mutex_unlock(&p->lock);
    return error;
}

int fxs_pager_wait(fxs_pager *p, uint64_t nanoseconds)
{
    const uint64_t end = fxs_clock(0) + nanoseconds;
    int late = 0;
    pthread_mutex_lock(&p->lock);
    while (p->reading && p->failures < TRIES && !late)
        late = timed_wait(&p->done, &p->lock, end);
    const int is_idle = !p->reading || p->failures >= TRIES;
    pthread_mutex_unlock(&p->lock);
    return is_idle;
}
