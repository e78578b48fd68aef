/* Checks that rendering allocates no memory after set-up, on any number of threads. */
#include <stdlib.h>
#include <string.h>

#include <fixsplat/camera.h>
#include <fixsplat/system.h>
#include "one_scene.h"
#include "packed_scene.h"
#include "fastest.h"
#ifdef FXS_WITH_KERNELS
#include <fixsplat/internal/kernels.h>
#include <fixsplat/internal/view_more.h>
#endif

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define COUNTING 1
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);
void *__libc_memalign(size_t alignment, size_t size);

static int allocations;

static void count(void)
{
    __atomic_fetch_add(&allocations, 1, __ATOMIC_RELAXED);
}

void *malloc(size_t size)
{
    count();
    return __libc_malloc(size);
}

void *calloc(size_t n, size_t size)
{
    count();
    return __libc_calloc(n, size);
}

void *realloc(void *old, size_t size)
{
    count();
    return __libc_realloc(old, size);
}

int posix_memalign(void **out, size_t alignment, size_t size)
{
    count();
    *out = __libc_memalign(alignment, size);
    return *out ? 0 : 12;
}
#endif

enum { WIDTH = 200, HEIGHT = 120, COUNT = 5000 };

static packed_scene make_scene(void)
{
    packed_scene s = packed_scene_make(FXS_PROFILE_DEFAULT, 1, COUNT, 0);
    for (uint32_t c = 0; c < s.header->chunk_count; c++) {
        unsigned char *rows = packed_scene_rows(&s, c);
        fxs_chunk *chunk = &s.chunks[c];
        for (int i = 0; i < 3; i++) {
            chunk->origin_q32[i] = -((int64_t)1 << 32);
            chunk->step_q32[i] = 1 << 17;
            chunk->colour_step_q20[i] = 4000;
            chunk->sh_step_q19[i] = 200;
        }
        chunk->scale_q16 = -4 * 65536;
        chunk->scale_step_q24 = 60;
        uint32_t state = c + 1;
        for (uint32_t at = 0; at < s.header->chunk_bytes; at++)
            rows[at] = (unsigned char)((state = state * 1664525 + 1013904223) >> 24);
    }
    CHECK(packed_scene_finish(&s) == 0);
    return s;
}

static void render_frames(uint32_t threads)
{
#ifdef COUNTING
    static const double middle[3] = {0, 0, 0}, up[3] = {0, -1, 0}, eye[3] = {0, 0, -4};
    fxs_pool *pool = fxs_pool_create(threads);
    fxs_config config = {.size = sizeof(fxs_config), .workers.run = fxs_pool_run, .workers.pool = pool,
                         .workers.count = threads};
    fxs_context context;
    fxs_scene scene;
    fxs_options options;
    fxs_view view;
    fxs_message m;
    packed_scene packed = make_scene();
    unsigned char *pixels = malloc(WIDTH * HEIGHT * 4);
    fxs_context_init(&context, &config);
#ifdef FXS_WITH_KERNELS
    context.config.kernels = kernels_for(fxs_cpu_detect());
#endif
    fxs_options_init(&options);
    CHECK(pool && pixels && !fxs_scene_open(&scene, packed.data, packed.bytes) &&
          !fxs_view_look_at(&view, eye, middle, up, &(fxs_picture){50, WIDTH, HEIGHT}, &m));
    size_t bytes = one_frame_bytes(&context, &scene, WIDTH, HEIGHT, 0);
    void *memory = check_aligned(bytes);
    int before = allocations;
    uint32_t visible = 0, bands = 0;
    for (int i = 0; i < 30; i++) {
        fxs_camera camera;
        fxs_stats stats;
        fxs_view_orbit(&view, middle, up, 0.2);
        CHECK(!fxs_camera_from_view(&camera, &view, &m) &&
              !one_render(&context, &scene, &camera, &options, FXS_FORMAT_RGBA8, memory, i % 2 ? bytes : bytes / 2,
                          pixels, WIDTH * 4, &stats));
        visible += stats.visible;
        bands += stats.bands;
    }
    CHECK(visible > 30 * 1000);
    CHECK(bands > 30);
    CHECK(allocations == before);
    fxs_pool_destroy(pool);
    free(memory);
    free(pixels);
    free(packed.data);
#else
    (void)threads;
    (void)fill_scene;
    SKIP("malloc cannot be counted here");
#endif
}

static void test_one_thread(void)
{
    render_frames(1);
}

static void test_four_threads(void)
{
    render_frames(4);
}

int main(void)
{
    RUN(test_one_thread);
    RUN(test_four_threads);
    return check_report();
}
