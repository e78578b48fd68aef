/* Tests thread safety. Threads render with one context and one thread pool. Each thread has its own memory. */
#ifdef __linux__
#define _GNU_SOURCE
#include <sched.h>
#endif
#include <pthread.h>
#include <string.h>
#include <unistd.h>

#include <fixsplat/system.h>
#include <fixsplat/internal/kernels.h>
#include "check.h"
#include "one_scene.h"
#include "random_scene.h"
#include "fastest.h"

enum { CALLERS = 4, FRAMES = 12, ROUNDS = 5, SIDE = 128, LIMIT_SECONDS = 100 };

typedef struct frame {
    packed_scene packed;
    fxs_scene scene;
    fxs_camera camera;
    fxs_options options;
    unsigned char expected[4 * SIDE * SIDE];
} frame;

static frame frames[FRAMES];
static fxs_context shared;

/* Renders a frame. Returns true if the pixels are as expected. fill: 1 stores the pixels as the expected ones. */
static int draw(const fxs_context *context, frame *f, int fill)
{
    unsigned char *pixels = fill ? f->expected : calloc(1, sizeof f->expected);
    const size_t bytes = one_frame_bytes(context, &f->scene, f->camera.width, f->camera.height, 0);
    void *memory = check_aligned(bytes);
    const int error = one_render(context, &f->scene, &f->camera, &f->options, FXS_FORMAT_RGBA8, memory, bytes, pixels,
                                 4 * SIDE, 0);
    const int equal = !error && !memcmp(pixels, f->expected, sizeof f->expected);
    free(memory);
    if (!fill)
        free(pixels);
    return equal;
}

static void make_frames(void)
{
    fxs_context alone;
    fxs_context_init(&alone, 0);
    for (int i = 0; i < FRAMES; i++) {
        frame *f = &frames[i];
        state = 77 + (uint64_t)i;
        f->packed = random_scene((enum fxs_profile)(i % 3), 20000);
        CHECK(!fxs_scene_open(&f->scene, f->packed.data, f->packed.bytes));
        random_camera(&f->camera);
        fxs_options_init(&f->options);
        CHECK(draw(&alone, f, 1));
    }
}

static void *draw_frames(void *argument)
{
    uintptr_t first = (uintptr_t)argument, wrong = 0;
    for (uintptr_t i = 0; i < ROUNDS * FRAMES; i++)
        wrong += !draw(&shared, &frames[(first + i) % FRAMES], 0);
    return (void *)wrong;
}

static uintptr_t call_at_once(void *(*body)(void *))
{
    pthread_t threads[CALLERS];
    uintptr_t sum = 0;
    for (uintptr_t i = 0; i < CALLERS; i++)
        CHECK(!pthread_create(&threads[i], 0, body, (void *)(i * FRAMES / CALLERS)));
    for (int i = 0; i < CALLERS; i++) {
        void *one = 0;
        pthread_join(threads[i], &one);
        sum += (uintptr_t)one;
    }
    return sum;
}

static void test_a_context_for_several_threads(void)
{
    make_frames();
    for (uint32_t threads = 1; threads <= 4 && !check_faults; threads += threads) {
        const fxs_config config = {.size = sizeof(fxs_config), .workers.run = fxs_pool_run,
                                   .workers.pool = fxs_pool_create(threads), .workers.count = threads};
        fxs_context_init(&shared, &config);
#ifdef FXS_WITH_KERNELS
        shared.config.kernels = kernels_for(fxs_cpu_detect());
#endif
        CHECK(call_at_once(draw_frames) == 0);
        fxs_pool_destroy(config.workers.pool);
    }
    for (int i = 0; i < FRAMES; i++)
        free(frames[i].packed.data);
}

enum { OUTER = 8, INNER = 16, CALLS = 200 };

static fxs_pool *pool;

static void count_inner(void *argument, uint32_t i)
{
    ((uint32_t *)argument)[i]++;
}

static void run_inner(void *argument, uint32_t i)
{
    fxs_pool_run(pool, count_inner, (uint32_t *)argument + i * INNER, INNER);
}

static void *run_outer(void *argument)
{
    uint32_t ran[OUTER * INNER] = {0};
    uintptr_t wrong = 0;
    (void)argument;
    for (int i = 0; i < CALLS; i++)
        fxs_pool_run(pool, run_inner, ran, OUTER);
    for (int i = 0; i < OUTER * INNER; i++)
        wrong += ran[i] != CALLS;
    return (void *)wrong;
}

static void test_jobs_of_several_callers_that_run_jobs(void)
{
    for (uint32_t threads = 1; threads <= 4; threads += threads) {
        pool = fxs_pool_create(threads);
        CHECK(pool && call_at_once(run_outer) == 0);
        fxs_pool_destroy(pool);
    }
}

static void test_processors_are_those_allowed(void)
{
#ifdef __linux__
    cpu_set_t before, one;
    CPU_ZERO(&one);
    if (sched_getaffinity(0, sizeof before, &before) || CPU_COUNT(&before) < 2)
        SKIP("one processor here");
    CHECK(fxs_processors() == (uint32_t)(CPU_COUNT(&before) < 64 ? CPU_COUNT(&before) : 64));
    for (size_t i = 0; CPU_COUNT(&one) == 0; i++)
        if (CPU_ISSET(i, &before))
            CPU_SET(i, &one);
    CHECK(!sched_setaffinity(0, sizeof one, &one));
    CHECK(fxs_processors() == 1);
    sched_setaffinity(0, sizeof before, &before);
#else
    SKIP("affinity masks are Linux's");
#endif
}

int main(void)
{
    alarm(LIMIT_SECONDS);
    RUN(test_processors_are_those_allowed);
    RUN(test_jobs_of_several_callers_that_run_jobs);
    RUN(test_a_context_for_several_threads);
    return check_report();
}
