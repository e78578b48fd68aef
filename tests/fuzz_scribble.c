/* Fuzzes a scene that changes during rendering. A thread writes into the scene while the renderer reads it. Instead,
   the renderer's clock callback may write, so that findings are reproducible. Any picture or error is accepted. Memory
   outside of the caller's buffers must stay untouched. */
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>

#include "one_scene.h"
#include "fuzz_frame.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* The scene to overwrite during rendering. `original` and `other` are valid scenes of the same layout. */
static struct {
    _Atomic uint32_t wanted, busy;
    unsigned char *data;
    size_t bytes, headers;
    const unsigned char *original, *other;
    uint32_t how;
} target;

static uint32_t scribble_random(uint32_t *seed)
{
    *seed ^= *seed << 13;
    *seed ^= *seed >> 17;
    return *seed ^= *seed << 5;
}

/* Overwrites a random range of the scene with bytes of a valid scene, or with up to 64 equal bytes. */
static void scribble(uint32_t *seed)
{
    const uint32_t what = scribble_random(seed);
    const size_t first = target.how & 1 ? 192 : 0, end = target.how & 2 ? target.headers : target.bytes;
    if (end == first)
        return;
    const size_t at = first + scribble_random(seed) % (end - first);
    size_t count = (size_t)1 << (what >> 4) % 20;
    count = count < end - at ? count : end - at;
    if ((what & 15) < (target.how & 4 ? 16u : 12u))
        memcpy(target.data + at, (what & 1 ? target.original : target.other) + at, count);
    else
        memset(target.data + at, (int)(what >> 24), count < 64 ? count : 64);
}

static uint64_t scribbling_clock(void *seed)
{
    if (scribble_random(seed) % 4 == 0)
        scribble(seed);
    return 0;
}

static void *run_scribbler(void *argument)
{
    uint32_t seed = 2463534242u;
    for (;;) {
        atomic_store(&target.busy, 0);
        while (!atomic_load(&target.wanted))
            sched_yield();
        atomic_store(&target.busy, 1);
        while (atomic_load(&target.wanted)) {
            scribble(&seed);
            if (target.how & 8)
                sched_yield();
        }
    }
    return argument;
}

static void start_scribbling(void)
{
    static int running;
    pthread_t thread;
    if (!running && pthread_create(&thread, NULL, run_scribbler, NULL))
        abort();
    running = 1;
    atomic_store(&target.wanted, 1);
    while (!atomic_load(&target.busy))
        sched_yield();
}

static void stop_scribbling(void)
{
    atomic_store(&target.wanted, 0);
    while (atomic_load(&target.busy))
        sched_yield();
}

static void check(int error)
{
    if (error < 0 && error != FXS_ERR_SCENE && error != FXS_ERR_MEMORY && error != FXS_ERR_CAMERA &&
        error != FXS_ERR_SIZE && error != FXS_ERR_OBJECT && error != FXS_ERR_TARGET)
        abort();
}

static void render(const fuzz_frame *f, const fxs_context *context, size_t least, size_t all)
{
    const fxs_camera *camera = &f->cameras[0];
    const size_t sizes[] = {least, least + (all - least) / 4, least + (all - least) / 2, all};
    fxs_pick_result picked;
    uint64_t pairs[2];
    for (int i = 0; i < 4; i++)
        check(fuzz_render(f, context, sizes[i], NULL));
    for (int i = 0; i < 4; i++)
        check(fuzz_render_stereo(f, context, sizes[i]));
    check(count_pairs(f->objects, f->count, camera, &f->options, fuzz_room(0, least), least, &pairs[0], &pairs[1]));
    check(pick_pixel(context, f->objects, f->count, camera, &f->options, NULL, camera->width / 2, camera->height / 2,
                   fuzz_room(0, least), least, &picked));
}

/* Makes a valid second scene from a scene. Its chunk headers may be in reverse order. In some chunks (256 Gaussians
   each) only the first few Gaussians have a nonzero opacity. */
static unsigned char *make_other(const fuzz_frame *f)
{
    unsigned char *other = check_aligned(f->bytes), *rows = other + (f->scene.rows - f->data);
    const size_t chunks = f->scene.chunk_count, bytes = f->scene.chunk_bytes;
    const size_t opacities = f->scene.profile == FXS_PROFILE_SMALL ? FXS_SMALL_A : FXS_ROW_COLOUR;
    const size_t seen = 1 + f->scribble % 8;
    memcpy(other, f->data, f->bytes);
    for (size_t i = 0; i < chunks; i++) {
        if (f->scribble & 32)
            memcpy(other + 192 + 128 * i, f->data + 192 + 128 * (chunks - 1 - i), 128);
        if (i % 4 || f->scribble & 16)
            memset(rows + i * bytes + opacities + 4 * seen, 0, 4 * (FXS_CHUNK - seen));
    }
    return other;
}

static void render_scribbled(fuzz_frame *f, size_t least, size_t all)
{
    unsigned char *original = check_aligned(f->bytes), *other = make_other(f);
    uint32_t seed = f->scribble + 1;
    memcpy(original, f->data, f->bytes);
    target.data = f->data;
    target.bytes = f->bytes;
    target.headers = 192 + 128 * (size_t)f->scene.chunk_count;
    target.original = original;
    target.other = other;
    target.how = f->scribble;
    const int threaded = f->scribble >> 8 & 1;
    if (threaded)
        start_scribbling();
    for (int level = 0; level < f->level_count; level++) {
        f->levels[level].config.clock = threaded ? NULL : scribbling_clock;
        f->levels[level].config.clock_argument = &seed;
        render(f, &f->levels[level], least, all);
    }
    if (threaded)
        stop_scribbling();
    free(original);
    free(other);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static fuzz_frame f;
    fxs_frame_memory memory;
    if (fuzz_frame_make(&f, data, size)) {
        const size_t all = fuzz_frame_bytes(&f, &memory);
        if (all && all <= FUZZ_ROOM && f.picture <= FUZZ_ROOM)
            render_scribbled(&f, fuzz_least(&f, &f.levels[0], &memory), all);
    }
    free(f.data);
    return 0;
}
