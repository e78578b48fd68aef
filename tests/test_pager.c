/* Tests paged scenes, which load chunks from a source into a pool on demand. Once no chunk is missing, frames must
   equal the whole scene's. Sources may be slow, fail, corrupt data, end early or never answer. */
#ifdef __linux__
#define _GNU_SOURCE
#endif
#include <math.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include <fixsplat/renderer.h>
#include <fixsplat/scene.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/packed.h>
#include <fixsplat/internal/pager_more.h>
#include <fixsplat/internal/parts.h>

#include "folder.h"
#include "one_scene.h"
#include "src/base/crc32.h"
#include "tree_scene.h"

enum { PIXELS = TREE_WIDTH * TREE_HEIGHT * 4, BUDGET = TREE_COUNT / 4 };
#define SECOND 1000000000ull

static fxs_packed_scene packed;
static fxs_scene whole;
static fxs_context context;
static unsigned char pictures[2][PIXELS];
static void *memory;
static size_t memory_bytes;

typedef struct bytes_source {
    const unsigned char *bytes;
    uint64_t rate;                     /* simulated speed of the source in bytes per second; 0: unlimited */
    /* fail_from: number of the first read that fails; fail_count: number of failing reads */
    long reads, fail_from, fail_count;
    int failure;                       /* error code that a failing read returns */
    int is_silent;                     /* 1: failing reads give no error message */
    int is_back;                       /* 1: the source works again, so that no more reads fail; set atomically */
    uint64_t lie_from, lie_to;         /* range of the file whose bytes the source corrupts */
    int hangs;                         /* 1: a read returns only when it is cancelled; set atomically */
    int is_hanging, cancelled, closed;
    uint64_t most;                     /* largest number of bytes that a read asked for */
} bytes_source;

static void hang(bytes_source *s)
{
    __atomic_store_n(&s->is_hanging, 1, __ATOMIC_RELEASE);
    while (!__atomic_load_n(&s->cancelled, __ATOMIC_ACQUIRE))
        nanosleep(&(struct timespec){0, 1000000}, 0);
}

static int read_bytes(void *argument, uint64_t offset, void *out, size_t size, fxs_message *message)
{
    bytes_source *s = argument;
    const long number = s->reads++;
    s->most = size > s->most ? size : s->most;
    if (s->rate)
        nanosleep(&(struct timespec){(time_t)(size / s->rate), (long)(size % s->rate * SECOND / s->rate)}, 0);
    if (__atomic_load_n(&s->hangs, __ATOMIC_ACQUIRE)) {
        hang(s);
        return fxs_fail_as(FXS_ERR_STOPPED, message, "cancelled");
    }
    if (number >= s->fail_from && number < s->fail_from + s->fail_count &&
        !__atomic_load_n(&s->is_back, __ATOMIC_ACQUIRE))
        return s->is_silent ? s->failure : fxs_fail_as(s->failure, message, "the line is cut");
    memcpy(out, s->bytes + offset, size);
    for (uint64_t at = s->lie_from; at < s->lie_to; at++)
        if (at >= offset && at < offset + size)
            ((unsigned char *)out)[at - offset] ^= 1;
    return 0;
}

static void cancel_read(void *argument)
{
    __atomic_store_n(&((bytes_source *)argument)->cancelled, 1, __ATOMIC_RELEASE);
}

static void close_bytes(void *argument)
{
    ((bytes_source *)argument)->closed++;
}

static fxs_pager_source source_of(bytes_source *s)
{
    s->bytes = packed.data;
    return (fxs_pager_source){.size = packed.bytes, .read = read_bytes, .cancel = cancel_read, .close = close_bytes,
                              .argument = s};
}

static fxs_pager *open_with(bytes_source *s, uint32_t places, fxs_message *why)
{
    const fxs_pager_source source = source_of(s);
    const fxs_pager_options options = {.size = sizeof(fxs_pager_options),
                                       .pool_bytes = (size_t)places * whole.chunk_bytes};
    fxs_pager *pager;
    return fxs_pager_open("made.fxs", &source, &options, &pager, why) ? 0 : pager;
}

static fxs_camera camera_on_way(int i)
{
    const double angle = i * 0.021, out = 5.2 + 3.6 * sin(i * 0.037);
    return camera_at(out * sin(angle), -1.5 + sin(i * 0.05), -out * cos(angle));
}

static fxs_stats frame_of(const fxs_scene *scene, fxs_pager *pager, fxs_camera camera, uint32_t budget,
                          unsigned char *pixels)
{
    const fxs_object object = one_object(scene);
    fxs_request request = request_of(&object, 1, camera, budget, pixels);
    fxs_stats stats;
    request.options.want.call = pager ? fxs_pager_want : 0;
    request.options.want.argument = pager;
    CHECK(fxs_request_bytes(&context, &request, 0) <= memory_bytes);
    CHECK(!fxs_render(&context, &request, memory, memory_bytes, &stats));
    return stats;
}

/* Renders frames until all chunks of the scene are loaded, or no more chunks arrive. Returns the number of
   frames. */
static int settle(fxs_pager *pager, fxs_camera camera, uint32_t budget, fxs_pager_state *state)
{
    int frames = 0, error;
    fxs_stats stats;
    do {
        stats = frame_of(fxs_pager_scene(pager), pager, camera, budget, pictures[1]);
        error = fxs_pager_turn(pager, state, 0);
        CHECK(state->there <= state->room);
        fxs_pager_wait(pager, 20 * SECOND);
        frames++;
    } while (stats.missing && frames < 100 && !error && !(state->no_room && frames > 10));
    return stats.missing ? -frames : frames;
}

static int is_as_whole(fxs_camera camera, uint32_t budget)
{
    frame_of(&whole, 0, camera, budget, pictures[0]);
    return !memcmp(pictures[0], pictures[1], PIXELS);
}

static void test_same_bytes(void)
{
    const uint32_t places = fxs_scene_chunks(&whole) / 3;
    bytes_source s = {.reads = 0};
    fxs_message why;
    fxs_pager_state state;
    fxs_pager *pager = open_with(&s, places, &why);
    if (!CHECK(pager))
        return;
    int most = 0;
    for (int i = 0; i < 300; i += 50) {
        const int frames = settle(pager, camera_on_way(i), BUDGET, &state);
        CHECK(frames > 0 && is_as_whole(camera_on_way(i), BUDGET));
        most = frames > most ? frames : most;
    }
    const size_t heads = (size_t)(whole.rows - (unsigned char *)packed.data) + (size_t)(whole.node_rows - whole.nodes);
    printf("  %u of %u places, %zu bytes with the heads of %zu; %d frames at most, %llu bytes read of %zu\n",
           state.there, state.room, state.memory, heads, most, (unsigned long long)state.bytes_read, packed.bytes);
    CHECK(state.room == places && state.memory < (size_t)places * (whole.chunk_bytes + 100) + heads + (2 << 20));
    CHECK(s.most <= 1 << 20 && most < 12);
    fxs_pager_close(pager);
    CHECK(s.closed == 1);
}

static void test_all(void)
{
    bytes_source s = {.reads = 0};
    fxs_message why;
    fxs_pager_state state;
    fxs_pager *pager = open_with(&s, 1 << 20, &why);
    if (!CHECK(pager))
        return;
    CHECK(settle(pager, camera_on_way(3), 0, &state) > 0 && is_as_whole(camera_on_way(3), 0));
    CHECK(state.room == fxs_scene_chunks(&whole));
    fxs_pager_close(pager);
}

static void test_file(void)
{
    char path[128];
    fxs_message why;
    fxs_pager_state state;
    fxs_pager *pager;
    fxs_opened *opened;
    const fxs_pager_options options = {.size = sizeof(fxs_pager_options), .pool_bytes = packed.bytes / 3};
    const fxs_open_options open = {.size = sizeof(fxs_open_options), .pager = &options};
    snprintf(path, sizeof path, "%s", in_folder("made.fxs"));
    CHECK(!fxs_file_write(path, packed.data, packed.bytes, &why));
    CHECK(!fxs_open(path, &open, &opened, &why) && opened->pager && opened->scene == fxs_pager_scene(opened->pager));
    CHECK(opened->info->count == TREE_COUNT && settle(opened->pager, camera_on_way(7), BUDGET, &state) > 0 &&
          is_as_whole(camera_on_way(7), BUDGET));
    fxs_close(opened);
    bytes_source s = {0};
    const fxs_pager_source source = source_of(&s);
    const fxs_open_options by_source = {.size = sizeof(fxs_open_options), .source = &source};
    CHECK(!fxs_open("a name", &by_source, &opened, &why) && opened->pager && opened->info->count == TREE_COUNT);
    CHECK(settle(opened->pager, camera_on_way(7), BUDGET, &state) > 0 && is_as_whole(camera_on_way(7), BUDGET));
    fxs_close(opened);
    for (int cut = 0; cut < 2; cut++) {
        CHECK(!fxs_file_write(path, packed.data, packed.bytes, &why));
        if (!CHECK(!fxs_pager_open_file(path, &options, &pager, &why)))
            continue;
        if (cut)
            CHECK(!truncate(path, (off_t)packed.bytes / 2));
        else
            CHECK(!fxs_file_write(path, packed.data, packed.bytes, &why) && !truncate(path, (off_t)packed.bytes));
        settle(pager, camera_on_way(7), BUDGET, &state);
        if (cut)
            CHECK(fxs_pager_turn(pager, &state, &why) == FXS_ERR_FILE && strstr(why.text, "cut short"));
        else   /* the path names a new file, but the pager still has the old file open */
            CHECK(!fxs_pager_turn(pager, &state, &why) && !state.lost);
        fxs_pager_close(pager);
    }
    CHECK(fxs_pager_open_file(path, &options, &pager, &why) == FXS_ERR_FILE && !pager && strstr(why.text, "cut short"));
    CHECK(fxs_pager_open_file(folder, &options, &pager, &why) == FXS_ERR_FILE && strstr(why.text, "not a regular"));
    unlink(path);
    CHECK(fxs_pager_open_file(path, &options, &pager, &why) == FXS_ERR_FILE && strstr(why.text, "No such file"));
}

static void test_damaged_heads(void)
{
    fxs_message why;
    const uint64_t parts[][2] = {{0, (uint64_t)(whole.chunks - (unsigned char *)packed.data)},
                                 {(uint64_t)(whole.nodes - (unsigned char *)packed.data) - 64,
                                  (uint64_t)(whole.node_chunks - (unsigned char *)packed.data)}};
    for (int part = 0; part < 2; part++)
        for (uint64_t at = parts[part][0]; at < parts[part][1]; at += 1 + (at - parts[part][0]) / 16) {
            bytes_source s = {.lie_from = at, .lie_to = at + 1};
            why.text[0] = 0;
            CHECK(!open_with(&s, 64, &why) && s.closed == 1 && strstr(why.text, "made.fxs: "));
        }
    for (uint64_t size = 0; size < packed.bytes; size += 1 + size / 3) {
        bytes_source s = {.reads = 0};
        fxs_pager_source source = source_of(&s);
        fxs_pager *pager;
        source.size = size;
        CHECK(fxs_pager_open("made.fxs", &source, 0, &pager, &why) == FXS_ERR_FILE && !pager && s.closed == 1);
    }
    bytes_source s = {.reads = 0};
    CHECK(!open_with(&s, 15, &why) && strstr(why.text, "too little"));
}

static void test_large_claim(void)
{
    fxs_packed_header h;
    fxs_message why;
    fxs_pager *pager;
    unsigned char *bytes = calloc(1, sizeof h);
    memcpy(&h, packed.data, sizeof h);
    h.count = FXS_MAX_COUNT;
    h.chunk_count = fxs_chunks_of(h.count);
    h.holes = h.checksum = 0;
    fxs_crc32_table table;
    fxs_crc32_fill(&table);
    h.checksum = fxs_crc32(&table, 0, &h, sizeof h);
    memcpy(bytes, &h, sizeof h);
    bytes_source s = {.fail_from = 1, .fail_count = 1, .failure = FXS_ERR_FILE};
    fxs_pager_source source = source_of(&s);
    s.bytes = bytes;
    source.size = UINT64_MAX;
    CHECK(fxs_pager_open("made.fxs", &source, 0, &pager, &why) == FXS_ERR_FILE && s.reads == 2);
    CHECK(!strcmp(why.text, "the line is cut"));
    free(bytes);
}

/* All chunks that a camera at rest wants are lost. When the source works again, they are read. */
static void test_all_lost(void)
{
    bytes_source s = {.reads = 0};
    fxs_message why;
    fxs_pager_state state = {0};
    fxs_pager *pager = open_with(&s, fxs_scene_chunks(&whole), &why);
    if (!CHECK(pager))
        return;
    s.fail_count = 1L << 30;
    s.failure = FXS_ERR_FILE;
    const uint64_t late = fxs_clock(0) + 60 * SECOND;
    uint32_t missing = 1;
    for (; state.lost < missing && fxs_clock(0) < late; nanosleep(&(struct timespec){0, 10000000}, 0)) {
        missing = frame_of(fxs_pager_scene(pager), pager, camera_on_way(3), BUDGET, pictures[1]).missing;
        fxs_pager_turn(pager, &state, 0);
    }
    CHECK(missing && state.lost >= missing);
    __atomic_store_n(&s.is_back, 1, __ATOMIC_RELEASE);
    while (missing && fxs_clock(0) < late) {
        missing = frame_of(fxs_pager_scene(pager), pager, camera_on_way(3), BUDGET, pictures[1]).missing;
        fxs_pager_turn(pager, &state, 0);
    }
    CHECK(!missing && is_as_whole(camera_on_way(3), BUDGET));
    fxs_pager_close(pager);
}

/* The source corrupts chunks (256 Gaussians each), so that their checksums are wrong. The pager must give up
   after three attempts. Coarser chunks replace them. */
static void test_lies(void)
{
    const uint64_t first = (uint64_t)(whole.rows - (unsigned char *)packed.data);
    bytes_source s = {.reads = 0};
    fxs_message why;
    fxs_pager_state state;
    fxs_pager *pager = open_with(&s, fxs_scene_chunks(&whole), &why);
    if (!CHECK(pager))
        return;
    s.lie_from = first + 5ull * whole.chunk_bytes + 100;
    s.lie_to = s.lie_from + 10;
    const uint64_t start = fxs_clock(0);
    CHECK(settle(pager, camera_on_way(3), 0, &state) < 0);
    for (int i = 0; i < 20; i++) {
        settle(pager, camera_on_way(3), 0, &state);
        fxs_pager_turn(pager, &state, &why);
    }
    fxs_pager_wait(pager, 20 * SECOND);
    CHECK(fxs_pager_turn(pager, &state, &why) == FXS_ERR_FILE && state.lost == 1 && state.coming == 0);
    CHECK(strstr(why.text, "made.fxs: chunk 5 of") && strstr(why.text, "damaged"));
    CHECK(frame_of(fxs_pager_scene(pager), pager, camera_on_way(3), 0, pictures[1]).missing == 1);
    CHECK(fxs_clock(0) - start < 20 * SECOND);
    fxs_pager_close(pager);
}

static void test_failures(void)
{
    fxs_message why;
    fxs_pager_state state;
    for (int way = 0; way < 3; way++) {
        bytes_source s = {.reads = 0};
        fxs_pager *pager = open_with(&s, fxs_scene_chunks(&whole), &why);
        if (!CHECK(pager))
            return;
        s.fail_from = 8;
        s.fail_count = way ? 1 << 20 : 2;
        s.failure = way == 2 ? 7 : FXS_ERR_DEVICE;
        s.is_silent = way == 2;
        const int frames = settle(pager, camera_on_way(3), 0, &state);
        CHECK(way ? frames < 0 : frames > 0 && is_as_whole(camera_on_way(3), 0));
        const int error = fxs_pager_turn(pager, &state, &why);
        CHECK(error == (way == 0 ? 0 : way == 1 ? FXS_ERR_DEVICE : FXS_ERR_FILE));
        CHECK(!way || !strcmp(why.text, way == 1 ? "the line is cut" : "made.fxs: cannot be read"));
        if (way == 1) {
            __atomic_store_n(&s.is_back, 1, __ATOMIC_RELEASE);
            for (int i = 0; i < 50 && fxs_pager_turn(pager, &state, &why); i++)
                nanosleep(&(struct timespec){0, 100000000}, 0);
            CHECK(settle(pager, camera_on_way(3), 0, &state) > 0 && is_as_whole(camera_on_way(3), 0));
        }
        fxs_pager_close(pager);
    }
    for (long fails = 0; fails < 4; fails++) {
        bytes_source s = {.fail_from = fails, .fail_count = 1 << 20, .failure = FXS_ERR_DEVICE};
        CHECK(!open_with(&s, 64, &why) && s.closed == 1 && !strcmp(why.text, "the line is cut"));
    }
}

static void test_never_answers(void)
{
    bytes_source s = {.reads = 0};
    fxs_message why;
    fxs_pager_state state;
    fxs_pager *pager = open_with(&s, 200, &why);
    if (!CHECK(pager))
        return;
    __atomic_store_n(&s.hangs, 1, __ATOMIC_RELEASE);
    const uint64_t start = fxs_clock(0);
    for (int i = 0; i < 20; i++) {
        const fxs_stats stats = frame_of(fxs_pager_scene(pager), pager, camera_on_way(i), BUDGET, pictures[1]);
        CHECK(stats.missing && stats.drawn && !fxs_pager_turn(pager, &state, &why) && state.coming);
    }
    while (!__atomic_load_n(&s.is_hanging, __ATOMIC_ACQUIRE))
        nanosleep(&(struct timespec){0, 1000000}, 0);
    CHECK(!fxs_pager_wait(pager, SECOND / 100));
    fxs_pager_close(pager);
    CHECK(s.closed == 1 && s.cancelled && fxs_clock(0) - start < 20 * SECOND);
}

static void test_no_room(void)
{
    bytes_source s = {.reads = 0};
    fxs_message why;
    fxs_pager_state state;
    fxs_pager *pager = open_with(&s, 20, &why);
    if (!CHECK(pager))
        return;
    CHECK(settle(pager, camera_on_way(3), 0, &state) < 0);
    CHECK(state.no_room > 0 && state.there <= 20 && state.lost == 0);
    CHECK(settle(pager, camera_on_way(3), 10 * FXS_CHUNK, &state) > 0 && is_as_whole(camera_on_way(3), 10 * FXS_CHUNK));
    fxs_pager_close(pager);
}

static void note_arrived(void *argument)
{
    __atomic_fetch_add((int *)argument, 1, __ATOMIC_RELAXED);
}

static double seconds_of_thread(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static long waits_of_thread(void)
{
#ifdef RUSAGE_THREAD
    struct rusage usage;
    return getrusage(RUSAGE_THREAD, &usage) ? 0 : usage.ru_nvcsw;
#else
    return 0;
#endif
}

/* Moves a camera while the source delivers 50 MB/s. Frames must not wait for the source. */
static void test_path(void)
{
    bytes_source s = {.rate = 50000000};
    const fxs_pager_source source = source_of(&s);
    int told = 0, waited = 0, missing = 0;
    const fxs_pager_options options = {sizeof(fxs_pager_options),
                                       (size_t)fxs_scene_chunks(&whole) / 3 * whole.chunk_bytes, note_arrived, &told};
    double longest = 0, longest_work = 0, longest_turn = 0, work = 0;
    fxs_message why;
    fxs_pager_state state;
    fxs_pager *pager;
    if (!CHECK(!fxs_pager_open("made.fxs", &source, &options, &pager, &why)))
        return;
    for (int i = 0; i < 300; i++) {
        const double own = seconds_of_thread();
        const long waits = waits_of_thread();
        const uint64_t start = fxs_clock(0);
        missing += frame_of(fxs_pager_scene(pager), pager, camera_on_way(i), BUDGET, pictures[1]).missing != 0;
        const uint64_t rendered = fxs_clock(0);
        CHECK(!fxs_pager_turn(pager, &state, &why) && state.there <= state.room);
        const double turn = 1e-9 * (double)(fxs_clock(0) - rendered), all = 1e-9 * (double)(fxs_clock(0) - start);
        const double mine = seconds_of_thread() - own;
        waited += waits_of_thread() != waits;
        work += mine;
        longest = all > longest ? all : longest;
        longest_work = mine > longest_work ? mine : longest_work;
        longest_turn = turn > longest_turn ? turn : longest_turn;
    }
    printf("  300 frames: %.2f ms of work each, %.2f at most; the longest took %.2f ms, the longest turn %.3f; %d "
           "waited; %d lacked chunks; %.1f MB read\n", work / 300 * 1e3, longest_work * 1e3, longest * 1e3,
           longest_turn * 1e3, waited, missing, (double)state.bytes_read * 1e-6);
    CHECK(waited < 30 && missing > 0 && __atomic_load_n(&told, __ATOMIC_RELAXED) > 0);
    CHECK(settle(pager, camera_on_way(299), BUDGET, &state) > 0 && is_as_whole(camera_on_way(299), BUDGET));
    fxs_pager_close(pager);
}

static void test_arguments(void)
{
    bytes_source s = {.reads = 0};
    const fxs_pager_source source = source_of(&s);
    fxs_pager_source unread = source;
    fxs_pager *pager;
    fxs_message why;
    unread.read = 0;
    CHECK(fxs_pager_open(0, &source, 0, &pager, &why) == FXS_ERR_ARGUMENT && !pager && s.closed == 1);
    CHECK(fxs_pager_open("x", 0, 0, &pager, &why) == FXS_ERR_ARGUMENT);
    CHECK(fxs_pager_open("x", &source, 0, 0, &why) == FXS_ERR_ARGUMENT && s.closed == 2);
    CHECK(fxs_pager_open("x", &unread, 0, &pager, &why) == FXS_ERR_ARGUMENT && s.closed == 3);
    CHECK(fxs_pager_open_file(0, 0, &pager, &why) == FXS_ERR_ARGUMENT);
    CHECK(fxs_pager_is_url("http://a/b.fxs") && fxs_pager_is_url("HTTPS://a") && !fxs_pager_is_url("http.fxs"));
    fxs_pager_close(0);
}

static void run_all(void)
{
    RUN(test_arguments);
    RUN(test_same_bytes);
    RUN(test_all);
    RUN(test_file);
    RUN(test_damaged_heads);
    RUN(test_large_claim);
    RUN(test_all_lost);
    RUN(test_lies);
    RUN(test_failures);
    RUN(test_never_answers);
    RUN(test_no_room);
    RUN(test_path);
}

int main(void)
{
    if (!pack_tree("knot", FXS_PROFILE_DEFAULT, &packed, &whole) || fxs_file_seal(packed.data, packed.bytes))
        return puts("FAIL cannot make the scene"), 1;
    fxs_context_init(&context, 0);
    const fxs_object object = one_object(&whole);
    memory_bytes = 2 * fxs_frame_bytes(&context, &object, 1, TREE_WIDTH, TREE_HEIGHT, 0) + (4 << 20);
    memory = check_aligned(memory_bytes);
    const int status = in_a_folder(run_all);
    free(memory);
    fxs_packed_scene_free(&packed);
    return status;
}
