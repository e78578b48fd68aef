/* Renders a packed scene that is larger than memory. The caller draws from a pool of chunks (pager_pool.h), while a
 * reader thread fills free places. Only fxs_pager_turn, called between frames, assigns a place to a chunk or evicts a
 * chunk. */
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
#include "src/open/pager_pool.h"
#include "src/scene/fxs_file_internal.h"
#include "timed_wait.h"

enum {
    HEAD_PIECE = 1 << 20,
    READ_MOST = 1 << 20,
    BATCH_LEAST = 8, BATCH_MOST = 256, /* least and most chunks of 256 Gaussians that are read together in a batch */
    BATCH_APART = 64,
    BATCH_QUICK_MS = 20, BATCH_SLOW_MS = 100,
    PAUSE_MS = 100
};

struct fxs_pager {
    fxs_scene scene;
    fxs_scene_parts parts;
    fxs_pager_source source;
    fxs_pager_options options;
    fxs_crc32_table table;
    char *name;
    unsigned char *head, *tree, *stage;
    size_t stage_bytes;

    fxs_pager_pool pool;               /* pager_pool.h says which of its fields the lock guards */
    pthread_mutex_t lock;              /* mutex that guards all fields below too */
    pthread_cond_t work, done;
    pthread_t reader;
    int has_reader, stop, reading;
    uint32_t batch_least, batch_most;
    int error;
    fxs_message why;
};

static uint64_t offset_of(const fxs_pager *p, uint32_t chunk)
{
    const uint32_t leaves = p->scene.chunk_count;
    return chunk < leaves ? p->parts.rows + (uint64_t)chunk * p->scene.chunk_bytes
                          : p->parts.node_rows + (uint64_t)(chunk - leaves) * p->scene.chunk_bytes;
}

static int by_chunk(const void *a, const void *b)
{
    const uint32_t x = ((const fxs_arrival *)a)->chunk, y = ((const fxs_arrival *)b)->chunk;
    return (x > y) - (x < y);
}

static uint32_t run_of(const fxs_pager *p, const fxs_arrival *list, uint32_t count)
{
    const uint64_t start = offset_of(p, list[0].chunk), size = p->scene.chunk_bytes;
    uint32_t run = 1;
    while (run < count && offset_of(p, list[run].chunk) - offset_of(p, list[run - 1].chunk) - size <= p->source.gap &&
           offset_of(p, list[run].chunk) + size - start <= p->stage_bytes)
        run++;
    return run;
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
static int read_run(fxs_pager *p, const fxs_arrival *list, uint32_t count, uint8_t *good, int *unread, fxs_message *why)
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
            memcpy(fxs_pager_rows(&p->pool, list[i].place), rows, p->scene.chunk_bytes);
        else
            result = error;
    }
    return result;
}

static void tell_arrived(fxs_pager *p)
{
    if (!p->options.arrived || !p->pool.arrived_count)
        return;
    pthread_mutex_unlock(&p->lock);
    p->options.arrived(p->options.arrived_argument);
    pthread_mutex_lock(&p->lock);
}

static int has_failed(const fxs_pager *p)
{
    return p->pool.failures >= FXS_PAGER_TRIES;
}

/* Reads a batch of chunks of Gaussians. Releases the caller's lock during each read. Adapts batch_most to the time that
   the batch took. */
static void read_batch(fxs_pager *p, fxs_arrival *list, uint32_t count)
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
        fxs_pager_pool_note(&p->pool, list + first, run, good, unread);
        if (has_failed(p))
            pthread_cond_broadcast(&p->done);
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
    const uint64_t end = fxs_clock(0) + (uint64_t)PAUSE_MS * 1000000 * p->pool.failures;
    while (!p->stop && !timed_wait(&p->work, &p->lock, end))
        ;
}

static void *read_wanted(void *pager)
{
    fxs_pager *p = pager;
    fxs_arrival list[BATCH_MOST];
    pthread_mutex_lock(&p->lock);
    while (!p->stop) {
        const uint32_t count = fxs_pager_pool_take(&p->pool, list, p->batch_most);
        p->reading = count > 0;
        if (!count) {
            pthread_cond_broadcast(&p->done);
            pthread_cond_wait(&p->work, &p->lock);
            continue;
        }
        read_batch(p, list, count);
        if (p->pool.failures)
            hold_off(p);
    }
    p->reading = 0;
    pthread_cond_broadcast(&p->done);
    pthread_mutex_unlock(&p->lock);
    return 0;
}

/* Reads the scene's headers in pieces, so that a false size in a damaged file costs no physical memory. */
static int read_head(fxs_pager *p, uint64_t offset, unsigned char *out, uint64_t size, fxs_message *message)
{
    for (uint64_t done = 0; done < size;) {
        const size_t piece = size - done < HEAD_PIECE ? (size_t)(size - done) : HEAD_PIECE;
        FXS_TRY(read_source(p, offset + done, out + done, piece, message));
        done += piece;
        p->pool.bytes_read += piece;
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
    p->head = fxs_pager_allocate(&p->pool, p->parts.rows, 1);
    p->tree = fxs_pager_allocate(&p->pool, p->parts.node_rows - p->parts.tree, 1);
    if (!p->head || !p->tree)
        return fxs_fail_memory(message, p->name, p->parts.rows + p->parts.node_rows - p->parts.tree);
    memcpy(p->head, header, known);
    FXS_TRY(read_head(p, known, p->head + known, p->parts.rows - known, message));
    FXS_TRY(read_head(p, p->parts.tree, p->tree, p->parts.node_rows - p->parts.tree, message));
    const int error = fxs_scene_open_parts(&p->scene, p->head, p->tree);
    if (error)
        return fxs_fail_as(error, message, "%s: %s", p->name, fxs_strerror(error));
    return fxs_file_check_heads(p->name, &p->table, p->head, &p->scene, (size_t)(p->parts.rows - p->parts.palette),
                                message);
}

static int make_room(fxs_pager *p, fxs_message *message)
{
    FXS_TRY(fxs_pager_pool_create(&p->pool, &p->scene, p->options.pool_bytes, p->name, message));
    p->stage_bytes = READ_MOST > p->scene.chunk_bytes ? READ_MOST : p->scene.chunk_bytes;
    p->stage = fxs_pager_allocate(&p->pool, p->stage_bytes, 1);
    return p->stage ? 0 : fxs_fail_memory(message, p->name, p->stage_bytes);
}

static int read_root(fxs_pager *p, fxs_message *message)
{
    const fxs_arrival root = {p->scene.chunk_count, p->pool.spare[--p->pool.spare_count]};
    uint8_t good;
    int unread;
    FXS_TRY(read_run(p, &root, 1, &good, &unread, message));
    fxs_pager_pool_root(&p->pool, root.place);
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
    fxs_aligned_free(p->head);
    fxs_aligned_free(p->tree);
    fxs_aligned_free(p->stage);
    fxs_pager_pool_free(&p->pool);
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
    return pager ? pager->pool.room : 0;
}

void fxs_pager_want(void *pager, const fxs_scene *scene, uint32_t chunk, int there)
{
    fxs_pager *p = pager;
    if (scene == &p->scene && chunk < p->pool.chunks)
        fxs_pager_pool_want(&p->pool, chunk, there);
}

int fxs_pager_turn(fxs_pager *p, fxs_pager_state *state, fxs_message *message)
{
    fxs_pager_state now;
    pthread_mutex_lock(&p->lock);
    fxs_pager_pool_turn(&p->pool, &now);
    const int error = now.lost || has_failed(p) ? p->error : 0;
    if (error && message)
        *message = p->why;
    p->reading |= p->pool.queue_count > 0 && p->pool.spare_count > 0;
    pthread_cond_signal(&p->work);
    pthread_mutex_unlock(&p->lock);
    if (state)
        *state = now;
    return error;
}

int fxs_pager_wait(fxs_pager *p, uint64_t nanoseconds)
{
    const uint64_t end = fxs_clock(0) + nanoseconds;
    int late = 0;
    pthread_mutex_lock(&p->lock);
    while (p->reading && !has_failed(p) && !late)
        late = timed_wait(&p->done, &p->lock, end);
    const int is_idle = !p->reading || has_failed(p);
    pthread_mutex_unlock(&p->lock);
    return is_idle;
}
