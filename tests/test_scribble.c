/* Tests a scene that changes while it is rendered. Rendering may write only to its memory and the pixels. The pages
   of the scene are protected, so that the scene can change at a chosen access to a page. */
#define _DEFAULT_SOURCE
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "one_scene.h"
#include "random_scene.h"
#include "fastest.h"
#ifdef FXS_WITH_KERNELS
#include <fixsplat/internal/kernels.h>
#endif

enum {
    OPEN = 4,   /* number of pages of the scene that are accessible at once; an access may need two */
    SCENES = 3,                    /* number of scenes, one for each packing profile */
    SEEN = 4,                      /* number of Gaussians in each chunk (256 Gaussians) that the faint scene shows */
    CHANGES = 12,                  /* number of times that the scene changes during a run */
    ZONE = 1 << 20                 /* protected bytes before and after the renderer's memory and the pixels */
};

typedef struct bytes {
    unsigned char *data;
    size_t size;
} bytes;

static struct {
    unsigned char *data;
    size_t size, page;
    fxs_scene scene;
    fxs_camera camera;
    fxs_options options;
    unsigned char *bright, *faint;   /* bright: bytes of the original scene; faint: the same with most opacities 0 */
} drawn;

static struct {
    unsigned char *recent[OPEN];
    int oldest;
    uint64_t touches, first, every;   /* numbers of page accesses: so far; at the first change; between changes */
    int wild;   /* 1: random bytes are written into the scene; 0: the bright scene is written */
} watch;

static void protect(void *start, size_t size, int how)
{
    if (mprotect(start, size, how))
        _exit(3);
}

static void change(void)
{
    if (!watch.wild) {
        memcpy(drawn.data, drawn.bright, drawn.size);
        return;
    }
    const size_t headers = sizeof(fxs_packed_header) + drawn.scene.chunk_count * sizeof(fxs_chunk);
    const size_t end = between(0, 1) ? headers : drawn.size, at = next() % end, most = next() % 2000;
    for (size_t i = at; i < end && i < at + most; i++)
        drawn.data[i] = (unsigned char)next();
}

static void on_touch(int number, siginfo_t *info, void *context)
{
    unsigned char *address = info->si_addr;
    (void)context;
    if (address < drawn.data || address >= drawn.data + drawn.size) {
        signal(number, SIG_DFL);           /* a fault outside of the scene is an error, so it may end the process */
        return;
    }
    const uint64_t touch = watch.touches++;
    if (touch == watch.first || (watch.every && touch > watch.first && (touch - watch.first) % watch.every == 0)) {
        protect(drawn.data, drawn.size, PROT_READ | PROT_WRITE);
        change();
        protect(drawn.data, drawn.size, PROT_NONE);
        for (int i = 0; i < OPEN; i++)
            watch.recent[i] = NULL;
    }
    unsigned char **oldest = &watch.recent[watch.oldest++ % OPEN];
    if (*oldest)
        protect(*oldest, drawn.page, PROT_NONE);
    *oldest = drawn.data + (size_t)(address - drawn.data) / drawn.page * drawn.page;
    protect(*oldest, drawn.page, PROT_READ);
}

static void start_watch(const unsigned char *scene)
{
    memcpy(drawn.data, scene, drawn.size);
    memset(watch.recent, 0, sizeof watch.recent);
    watch.touches = 0;
    protect(drawn.data, drawn.size, PROT_NONE);
}

static uint64_t end_watch(void)
{
    protect(drawn.data, drawn.size, PROT_READ | PROT_WRITE);
    return watch.touches;
}

static bytes make_room(size_t size)
{
    const size_t whole = (size + drawn.page - 1) / drawn.page * drawn.page;
    unsigned char *start = mmap(NULL, whole + 2 * (size_t)ZONE, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (start == MAP_FAILED)
        _exit(3);
    protect(start + ZONE, whole, PROT_READ | PROT_WRITE);
    memset(start + ZONE, 0xa5, whole - size);
    return (bytes){start + ZONE + whole - size, size};
}

static int free_room(bytes room)
{
    const size_t whole = (room.size + drawn.page - 1) / drawn.page * drawn.page;
    unsigned char *start = room.data + room.size - whole;
    int untouched = 1;
    for (const unsigned char *byte = start; byte < room.data; byte++)
        untouched &= *byte == 0xa5;
    munmap(start - ZONE, whole + 2 * (size_t)ZONE);
    return untouched;
}

enum call { SLICES, HALF, WHOLE, STEREO, PAIRS, CALLS };
static const char *const call_names[CALLS] = {"least memory", "half the memory", "whole memory", "stereo",
                                              "count_pairs"};

static size_t to_multiple_of_64(size_t size)
{
    return (size + 63) / 64 * 64;
}

static size_t memory_for(const fxs_context *context, enum call call)
{
    fxs_frame_memory memory;
    fxs_stats stats;
    const size_t all = one_frame_bytes(context, &drawn.scene, drawn.camera.width, drawn.camera.height, &memory);
    if (call == WHOLE || call == STEREO)
        return to_multiple_of_64(all);
    bytes room = make_room(to_multiple_of_64(memory.least)), pixels = make_room(1 << 16);
    memcpy(drawn.data, drawn.faint, drawn.size);
    const int error = one_render(context, &drawn.scene, &drawn.camera, &drawn.options, FXS_FORMAT_RGBA8, room.data,
                                 memory.least, pixels.data, 4 * (ptrdiff_t)drawn.camera.width, &stats);
    CHECK(free_room(room) + free_room(pixels) == 2);
    CHECK(!error);
    const size_t pairs = stats.memory.rows > memory.least ? stats.memory.rows : memory.least;
    return to_multiple_of_64(call == HALF ? (memory.least + all) / 2 : call == PAIRS ? pairs : memory.least);
}

static uint64_t render(const fxs_context *context, enum call call, size_t size)
{
    bytes room = make_room(size);
    const ptrdiff_t stride = 4 * (ptrdiff_t)drawn.camera.width;
    const size_t picture = to_multiple_of_64((size_t)stride * (size_t)drawn.camera.height);
    bytes left = make_room(picture), right = make_room(picture);
    const fxs_camera right_camera = {.width = drawn.camera.width};
    fxs_camera cameras[2] = {drawn.camera, right_camera};
    uint64_t pairs[2];
    int error;
    cameras[1] = drawn.camera;
    cameras[1].position_q32[0] += INT64_C(1) << 28;
    start_watch(drawn.faint);
    if (call == PAIRS)
        error = one_count_pairs(&drawn.scene, &drawn.camera, &drawn.options, room.data, size, &pairs[0], &pairs[1]);
    else if (call == STEREO)
        error = one_render_stereo(context, &drawn.scene, cameras, &drawn.options, FXS_FORMAT_RGBA8,
                                  room.data, size, (void *const[2]){left.data, right.data}, stride, NULL);
    else
        error = one_render(context, &drawn.scene, &drawn.camera, &drawn.options, FXS_FORMAT_RGBA8, room.data, size,
                           left.data, stride, NULL);
    const uint64_t touches = end_watch();
    CHECK(error == 0 || error == FXS_ERR_SCENE || ((call <= HALF || call == PAIRS) && error == FXS_ERR_MEMORY));
    CHECK(free_room(room) && free_room(left) && free_room(right));
    return touches;
}

static void render_all(const fxs_context *context, enum call call)
{
    const size_t size = memory_for(context, call);
    watch.first = UINT64_MAX;
    watch.every = 0;
    const uint64_t touches = render(context, call, size);
    CHECK(touches > drawn.scene.chunk_count);
    for (watch.wild = 0; watch.wild < 2; watch.wild++)
        for (uint64_t i = 0; i < CHANGES; i++) {
            watch.first = touches * i / CHANGES;
            watch.every = watch.wild ? 1 + touches / (1 + 2 * i) : 0;
            render(context, call, size);
        }
}

/* Renders in a child process while the scene changes. A write outside of the renderer's memory ends the child. */
static void check_call(const fxs_context *context, const char *name, enum call call)
{
    int status;
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        const struct sigaction action = {.sa_sigaction = on_touch, .sa_flags = SA_SIGINFO};
        sigaction(SIGSEGV, &action, NULL);
        alarm(30);
        state = 5;
        check_faults = 0;
        render_all(context, call);
        fflush(stdout);
        _exit(check_faults != 0);
    }
    if (!CHECK(child > 0 && waitpid(child, &status, 0) == child && status == 0))
        printf("  %s, %s, profile %d: %s %d\n", name, call_names[call], (int)drawn.scene.profile,
               WIFSIGNALED(status) ? "signal" : "status", WIFSIGNALED(status) ? WTERMSIG(status) : status);
}

static uint32_t visible(const unsigned char *scene)
{
    fxs_context context;
    fxs_stats stats;
    fxs_context_init(&context, NULL);
    memcpy(drawn.data, scene, drawn.size);
    const size_t size = one_frame_bytes(&context, &drawn.scene, drawn.camera.width, drawn.camera.height, NULL);
    void *memory = check_aligned(size), *pixels = check_aligned(1 << 16);
    CHECK(!one_render(&context, &drawn.scene, &drawn.camera, &drawn.options, FXS_FORMAT_RGBA8, memory, size, pixels,
                      4 * (ptrdiff_t)drawn.camera.width, &stats));
    free(memory);
    free(pixels);
    return stats.visible;
}

static void make_faint(void)
{
    const size_t opacities = drawn.scene.profile == FXS_PROFILE_SMALL ? FXS_SMALL_A : FXS_ROW_COLOUR;
    unsigned char *rows = drawn.faint + (drawn.scene.rows - drawn.data);
    memcpy(drawn.faint, drawn.bright, drawn.size);
    for (uint32_t c = 0; c < drawn.scene.chunk_count; c++)
        memset(rows + (size_t)c * drawn.scene.chunk_bytes + opacities + 4 * SEEN, 0, 4 * (FXS_CHUNK - SEEN));
}

static void free_scene(void)
{
    munmap(drawn.data, drawn.size);
    free(drawn.bright);
    free(drawn.faint);
}

static int make_scene(enum fxs_profile profile, uint64_t seed)
{
    state = seed;
    const packed_scene packed = random_scene(profile, 5000);
    drawn.size = (packed.bytes + drawn.page - 1) / drawn.page * drawn.page;
    drawn.data = mmap(NULL, drawn.size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    drawn.bright = calloc(1, drawn.size);
    drawn.faint = malloc(drawn.size);
    if (drawn.data == MAP_FAILED || !drawn.bright || !drawn.faint)
        exit(1);
    memcpy(drawn.bright, packed.data, packed.bytes);
    memcpy(drawn.data, packed.data, packed.bytes);
    free(packed.data);
    random_camera(&drawn.camera);
    fxs_options_init(&drawn.options);
    drawn.options.cutoff = (enum fxs_cutoff)between(0, 1);
    if (!CHECK(!fxs_scene_open(&drawn.scene, drawn.data, drawn.size)))
        exit(1);
    make_faint();
    const uint32_t most = visible(drawn.bright), least = visible(drawn.faint);
    if (least > drawn.scene.chunk_count / 2 && most > least + 1000)
        return 1;
    free_scene();
    return 0;
}

static void check_versions(enum call call)
{
    uint64_t seed = 1;
    for (int i = 0; i < SCENES; i++) {
        while (!make_scene((enum fxs_profile)i, seed++))
            ;
        fxs_context context;
        fxs_context_init(&context, NULL);
        check_call(&context, "c", call);
#ifdef FXS_WITH_KERNELS
        /* plain C only, since counting pairs of splats and pixels never uses other kernels */
        const unsigned cpu = call == PAIRS ? 0 : fxs_cpu_detect();
        for (unsigned flag = 1; flag <= cpu; flag *= 2)
            if (cpu & flag) {
                context.config.kernels = kernels_for(flag);
                check_call(&context, fxs_cpu_name(flag), call);
            }
#endif
        free_scene();
    }
}

static void test_bands(void)
{
    check_versions(SLICES);
    check_versions(HALF);
}

static void test_whole(void)
{
    check_versions(WHOLE);
}

static void test_stereo(void)
{
    check_versions(STEREO);
}

static void test_count_pairs(void)
{
    check_versions(PAIRS);
}

int main(void)
{
    drawn.page = (size_t)sysconf(_SC_PAGESIZE);
    RUN(test_bands);
    RUN(test_whole);
    RUN(test_stereo);
    RUN(test_count_pairs);
    return check_report();
}
