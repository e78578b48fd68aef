/* libFuzzer target: a packed scene that another thread writes to while it is rendered, in bands, for two eyes, and while
   its pairs are counted. Any picture or error will do; nothing may be touched beyond the caller's memory. */
#include <pthread.h>
#include <stdatomic.h>

#include "fuzz_frame.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* The scene being written to: `original` and `other` are two that open, of the same layout. */
static struct {
    _Atomic uint32_t wanted, busy;
    unsigned char *data;
    size_t bytes, headers;         /* the headers of the file and its chunks come first */
    const unsigned char *original, *other;
    uint32_t how;
} target;

static uint32_t scribble_random(uint32_t *seed)
{
    *seed ^= *seed << 13;
    *seed ^= *seed >> 17;
    return *seed ^= *seed << 5;
}

/* Some bytes from `at` on: from one of the scenes, which keeps headers in range, or any. */
static void scribble(uint32_t *seed)
{
    const uint32_t what = scribble_random(seed);
    const size_t first = target.how & 1 ? 192 : 0, end = target.how & 2 ? target.headers : target.bytes;
    const size_t at = first + scribble_random(seed) % (end - first);
    size_t count = (size_t)1 << (what >> 4) % 14;
    count = count < end - at ? count : end - at;
    if ((what & 15) < (target.how & 4 ? 15u : 8u))
        memcpy(target.data + at, (what & 1 ? target.original : target.other) + at, count);
    else
        for (volatile unsigned char *byte = target.data + at; count > 0; count -= count < 64 ? count : 64, byte++)
            *byte = (unsigned char)scribble_random(seed);
}

static void *run_scribbler(void *argument)
{
    uint32_t seed = 2463534242u;
    for (;;) {
        atomic_store(&target.busy, 0);
        while (!atomic_load(&target.wanted))
            ;
        atomic_store(&target.busy, 1);
        while (atomic_load(&target.wanted))
            scribble(&seed);
    }
    return argument;
}

static void start_scribbling(const fuzz_frame *f, const unsigned char *original, const unsigned char *other)
{
    static int running;
    pthread_t thread;
    target.data = f->data;
    target.bytes = f->bytes;
    target.headers = 192 + 128 * (size_t)f->scene.chunk_count;
    target.original = original;
    target.other = other;
    target.how = f->scribble;
    if (!running && pthread_create(&thread, NULL, run_scribbler, NULL))
        abort();
    running = 1;
    atomic_store(&target.wanted, 1);
    while (!atomic_load(&target.busy))
        ;
}

static void stop_scribbling(void)
{
    atomic_store(&target.wanted, 0);
    while (atomic_load(&target.busy))
        ;
}

static void check(int error)
{
    if (error && error != FXS_ERR_SCENE && error != FXS_ERR_MEMORY && error != FXS_ERR_CAMERA && error != FXS_ERR_SIZE)
        abort();
}

static void render(const fuzz_frame *f, const fxs_context *context, size_t least, size_t all)
{
    const fxs_camera *camera = &f->cameras[0];
    const size_t sizes[] = {least, least + (all - least) / 4, least + (all - least) / 2, all};
    unsigned char *pixels[2];
    uint64_t pairs[2];
    for (int eye = 0; eye < 2; eye++)
        pixels[eye] = fuzz_room(1 + eye, f->row * (size_t)camera->height);
    for (int i = 0; i < 4; i++)
        check(fxs_render(context, &f->scene, camera, &f->options, fuzz_room(0, sizes[i]), sizes[i], pixels[0],
                         (ptrdiff_t)f->row, NULL));
    check(fxs_count_pairs(&f->scene, camera, &f->options, fuzz_room(0, least), least, &pairs[0], &pairs[1]));
    const size_t both = fxs_stereo_bytes(context, &f->scene, camera->width, camera->height);
    if (both <= FUZZ_ROOM)
        check(fxs_render_stereo(context, &f->scene, f->cameras, &f->options, f->exact, fuzz_room(0, both), both,
                                (void *const[2]){pixels[0], pixels[1]}, (ptrdiff_t)f->row, NULL));
}

/* A scene of the same layout as f's, where that is one made by fuzz_scene, else the same. */
static unsigned char *make_other(const fuzz_frame *f)
{
    unsigned char *other = check_aligned(f->bytes);
    memcpy(other, f->data, f->bytes);
    const size_t headers = 192 + 128 * (size_t)f->scene.chunk_count;
    for (size_t at = headers; at < f->bytes; at++)
        other[at] = (unsigned char)(f->data[at] * 5 + 77);
    for (size_t i = 0; i < f->scene.chunk_count; i++)    /* chunk i lies where the last but i did */
        memcpy(other + 192 + 128 * i, f->data + headers - 128 * (i + 1), 128);
    return other;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static fuzz_frame f;
    fxs_frame_memory memory;
    if (fuzz_frame_make(&f, data, size)) {
        const fxs_camera *camera = &f.cameras[0];
        const size_t all = fxs_frame_bytes(&f.levels[0], &f.scene, camera->width, camera->height, &memory);
        if (all && all <= FUZZ_ROOM && f.row * (size_t)camera->height <= FUZZ_ROOM) {
            const size_t least = fuzz_least(&f, &f.levels[0], &memory);
            unsigned char *original = check_aligned(f.bytes), *other = make_other(&f);
            memcpy(original, f.data, f.bytes);
            start_scribbling(&f, original, other);
            for (int level = 0; level < f.level_count; level++)
                render(&f, &f.levels[level], least, all);
            stop_scribbling();
            free(original);
            free(other);
        }
    }
    free(f.data);
    return 0;
}
