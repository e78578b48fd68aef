/* The CUDA back end against the C stages, buffer by buffer: splats by index, the lists of the tiles (with depths), pixels.
 * `test_cuda [--quick] [FILE.fxs...]`; --quick: few random scenes, for the sanitizers. */
#include <inttypes.h>

#include "../../port/camera/camera.h"
#include "../../port/posix/map.h"
#include "../../src/stage.h"
#include "../random_scene.h"
#include "peek.h"

static fxs_cuda *cuda;
static fxs_cuda_failure failure;
static int cases = 200;
static char **files;
static int file_count;

/* The C stages' answers for a frame. */
typedef struct expected {
    fxs_view view;
    uint32_t count, tiles;
    fxs_splat *splats;
    fxs_bounds *bounds;
    fxs_box *boxes, *sorted_boxes;
    uint32_t *indices, *depths, *counts, *ends, *entries;
    fxs_key *keys, *spare;
} expected;

static void *room(size_t bytes)
{
    void *memory = calloc(1, bytes + 1);
    if (!memory)
        abort();
    return memory;
}

static void expected_splats(expected *e, const fxs_scene *scene)
{
    size_t most = (size_t)scene->chunk_count * FXS_CHUNK;
    e->splats = room(most * sizeof *e->splats);
    e->bounds = room(most * sizeof *e->bounds);
    e->boxes = room(most * sizeof *e->boxes);
    e->sorted_boxes = room(most * sizeof *e->boxes);
    e->indices = room(most * 4);
    e->depths = room(most * 4);
    e->keys = room(most * sizeof *e->keys);
    e->spare = room(most * sizeof *e->keys);
    for (uint32_t chunk = 0; chunk < scene->chunk_count; chunk++) {
        uint32_t n = (uint32_t)fxs_project_c(&e->view, scene, chunk, e->splats + e->count, e->bounds + e->count,
                                             e->indices + e->count, e->depths + e->count);
        fxs_shade_c(&e->view, scene, chunk, e->indices + e->count, n, e->splats + e->count);
        e->count += n;
    }
    fxs_bin_c(&e->view, e->splats, e->bounds, e->count, e->boxes);
}

static void expected_lists(expected *e)
{
    static uint32_t histograms[1][FXS_SORT_BUCKETS];
    const fxs_config config = {.run = 0};
    for (uint32_t i = 0; i < e->count; i++)
        e->keys[i] = FXS_KEY(e->depths[i], i);
    fxs_sorted sorted = {fxs_sort(&config, e->keys, e->spare, e->count, histograms, 1), e->sorted_boxes, e->count};
    e->tiles = (uint32_t)(e->view.tiles_x * e->view.tiles_y);
    e->counts = room(e->tiles * 4);
    e->ends = room(e->tiles * 4);
    fxs_bin_count(&e->view, e->splats, e->bounds, e->boxes, &sorted, e->counts);
    uint32_t total = 0;
    for (uint32_t tile = 0; tile < e->tiles; total += e->counts[tile++])
        e->ends[tile] = total;
    e->entries = room(total * sizeof *e->entries);
    fxs_bin_fill(&e->view, e->splats, e->bounds, &sorted, 0, e->tiles - 1, e->ends, e->entries);
}

static void expected_free(expected *e)
{
    void *const all[] = {e->splats, e->bounds, e->boxes, e->sorted_boxes, e->indices, e->depths,
                         e->counts, e->ends, e->entries, e->keys, e->spare};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        free(all[i]);
}

static int compare_keys(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* A tile's list as the back end should have it, but for its order: depth above, index and FAR below. */
static int list_equal(const expected *e, uint32_t tile, uint64_t *list)
{
    const uint32_t count = e->counts[tile], *entries = e->entries + e->ends[tile] - count;
    uint64_t *wanted = room(count * sizeof *wanted);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t slot = entries[i] & ~FXS_ENTRY_FAR;
        wanted[i] = (uint64_t)e->depths[slot] << 32 | e->indices[slot] | (entries[i] & FXS_ENTRY_FAR);
    }
    qsort(wanted, count, sizeof *wanted, compare_keys);
    qsort(list, count, sizeof *list, compare_keys);
    int equal = !memcmp(wanted, list, count * sizeof *wanted);
    free(wanted);
    return equal;
}

static int buffers_equal(const expected *e, const peeked *p)
{
    const fxs_splat *splats = p->splats;
    for (uint32_t i = 0; i < e->count; i++)
        if (memcmp(&splats[e->indices[i]], &e->splats[i], sizeof *splats)) {
            printf("  splat %" PRIu32 " differs\n", e->indices[i]);
            return 0;
        }
    for (uint32_t tile = 0; tile < e->tiles; tile++)
        if (p->counts[tile] != e->counts[tile] ||
            !list_equal(e, tile, p->entries + p->ends[tile] - p->counts[tile])) {
            printf("  list of tile %" PRIu32 " differs: %" PRIu32 " entries, %" PRIu32 " expected\n", tile,
                   p->counts[tile], e->counts[tile]);
            return 0;
        }
    return 1;
}

static int stages_equal(const fxs_scene *scene, const fxs_camera *camera, const fxs_options *options,
                        const fxs_cuda_stats *stats)
{
    expected e;
    peeked p;
    memset(&e, 0, sizeof e);
    memset(&p, 0, sizeof p);
    if (fxs_view_init(&e.view, scene, camera, options))
        return 0;
    expected_splats(&e, scene);
    expected_lists(&e);
    int equal = stats->visible == e.count && !peek(cuda, e.tiles, &p) && buffers_equal(&e, &p);
    if (stats->visible != e.count)
        printf("  %" PRIu32 " visible, %" PRIu32 " expected\n", stats->visible, e.count);
    peek_free(&p);
    expected_free(&e);
    return equal;
}

static uint8_t *render_c(const fxs_scene *scene, const fxs_camera *camera, const fxs_options *options, size_t bytes)
{
    fxs_context context;
    fxs_init(&context, 0);
    size_t memory_bytes = fxs_frame_bytes(&context, scene, camera->width, camera->height, 0);
    void *memory = check_aligned(memory_bytes);
    uint8_t *pixels = room(bytes);
    if (!memory || fxs_render(&context, scene, camera, options, memory, memory_bytes, pixels,
                              (ptrdiff_t)(bytes / (size_t)camera->height), 0))
        abort();
    free(memory);
    return pixels;
}

/* One frame both ways; the scene is uploaded. */
static int frame_equal(const fxs_scene *scene, const fxs_camera *camera, const fxs_options *options)
{
    const size_t row = (size_t)camera->width * (options->format == FXS_FORMAT_RGB565 ? 2 : 4);
    const size_t bytes = row * (size_t)camera->height;
    uint8_t *wanted = render_c(scene, camera, options, bytes), *pixels = room(bytes);
    fxs_cuda_stats stats;
    int equal = !fxs_cuda_render_host(cuda, camera, options, pixels, (ptrdiff_t)row, &stats, &failure);
    if (!equal)
        printf("  %s\n", failure.text);
    equal = equal && stages_equal(scene, camera, options, &stats);
    if (equal && memcmp(wanted, pixels, bytes)) {
        printf("  pixels differ\n");
        equal = 0;
    }
    free(wanted);
    free(pixels);
    return equal;
}

static void random_options(fxs_options *options)
{
    fxs_options_init(options);
    options->cutoff = between(0, 3) ? FXS_CUTOFF_MAHALANOBIS : FXS_CUTOFF_SQUARE;
    options->format = (enum fxs_format)between(0, 2);
    options->sh_degree = between(0, 3);
    for (int c = 0; c < 3; c++)
        options->background[c] = (uint8_t)between(0, 255);
}

static void check_random(enum fxs_profile profile)
{
    for (int i = 0; i < cases; i++) {
        state = (uint64_t)i * 0x1234567u + 99;
        packed_scene packed = random_scene(profile, i % 8 == 3 ? 60000 : 3000);
        fxs_scene scene;
        fxs_camera camera;
        fxs_options options;
        random_camera(&camera);
        random_options(&options);
        if (i % 3 == 1)
            random_near(&camera);
        if (i % 4 == 0) {                        /* a larger picture: splats over more than 8x8 tiles */
            camera.width *= 10;
            camera.height *= 9;
            camera.fx_q12 *= 10;
            camera.fy_q12 *= 10;
            camera.cx_q12 *= 10;
            camera.cy_q12 *= 10;
        }
        fxs_scene_open(&scene, packed.data, packed.bytes);
        int good = CHECK(!fxs_cuda_upload(cuda, &scene, &failure)) && CHECK(frame_equal(&scene, &camera, &options));
        free(packed.data);
        if (!good) {
            printf("  case %d\n", i);
            return;
        }
    }
}

static void test_default(void)
{
    check_random(FXS_PROFILE_DEFAULT);
}

static void test_compact(void)
{
    check_random(FXS_PROFILE_COMPACT);
}

static void test_small(void)
{
    check_random(FXS_PROFILE_SMALL);
}

/* As on GPUs with 99 KiB of shared memory a block: fewer tiles at a time, and no blend_dense. */
static void test_small_blocks(void)
{
    fxs_cuda *const whole = cuda;
    if (CHECK(!fxs_cuda_create(&cuda, 0, 0, 1, &failure)) && CHECK(!peek_fit_blocks(cuda, 99 << 10, &failure)))
        check_random(FXS_PROFILE_DEFAULT);
    CHECK(peek_fit_blocks(cuda, 48 << 10, &failure) == FXS_ERR_UNSUPPORTED);
    fxs_cuda_destroy(cuda);
    cuda = whole;
}

static void test_levels(void)
{
    long wrong = peek_levels();
    if (!CHECK(wrong == 0))
        printf("  %ld levels\n", wrong);
}

static void test_files(void)
{
    if (!file_count)
        SKIP("no .fxs file given");
    for (int i = 0; i < file_count; i++) {
        fxs_mapping file;
        fxs_scene scene;
        fxs_message message;
        const double up[3] = {0, -1, 0};
        double low[3], high[3];
        fxs_file_view view;
        fxs_camera camera;
        fxs_options options;
        if (!CHECK(!fxs_map(&file, files[i], &message)) ||
            !CHECK(!fxs_scene_open(&scene, file.data, file.bytes)))
            continue;
        const fxs_packed_header *header = file.data;
        for (int k = 0; k < 3; k++) {
            low[k] = (double)header->inner_low_q32[k] / 4294967296.0;
            high[k] = (double)header->inner_high_q32[k] / 4294967296.0;
        }
        fxs_view_frame_box(&view, low, high, up, 50, 1280, 720, &message);
        fxs_camera_from_view(&camera, &view, &message);
        fxs_options_init(&options);
        CHECK(!fxs_cuda_upload(cuda, &scene, &failure));
        for (int cutoff = 0; cutoff < 2; cutoff++) {
            options.cutoff = (enum fxs_cutoff)cutoff;
            if (!CHECK(frame_equal(&scene, &camera, &options)))
                printf("  %s\n", files[i]);
        }
        fxs_unmap(&file);
    }
}

enum { BATCH_FRAMES = 7 };

/* Several frames in several slots, straight to device or pinned host memory, one of them into too small lists. */
static void check_batch(uint8_t *memory)
{
    enum { FRAMES = BATCH_FRAMES, SLOTS = 3 };
    fxs_cuda *batch;
    fxs_cuda_frame frames[FRAMES];
    fxs_options options;
    fxs_scene scene;
    if (!CHECK(!fxs_cuda_create(&batch, 0, 0, SLOTS, &failure)))
        return;
    state = 5;
    packed_scene packed = random_scene(FXS_PROFILE_DEFAULT, 20000);
    fxs_scene_open(&scene, packed.data, packed.bytes);
    fxs_options_init(&options);
    CHECK(memory && !fxs_cuda_upload(batch, &scene, &failure));
    for (int i = 0; i < FRAMES; i++) {
        random_camera(&frames[i].camera);
        frames[i].camera.width = 512 + 256 * i;
        frames[i].camera.height = 1024;
        frames[i].pixels = memory + ((size_t)i << 24);
        frames[i].stride = frames[i].camera.width * 4;
    }
    CHECK(!fxs_cuda_render(batch, frames, FRAMES, &options, 0, &failure) && !fxs_cuda_finish(batch, 0, &failure));
    for (int i = 0; i < FRAMES; i++) {
        const size_t bytes = (size_t)frames[i].stride * 1024;
        uint8_t *wanted = render_c(&scene, &frames[i].camera, &options, bytes);
        uint8_t *got = peek_host_copy(frames[i].pixels, bytes);
        CHECK(got && !memcmp(wanted, got, bytes));
        free(wanted);
        free(got);
    }
    free(packed.data);
    fxs_cuda_destroy(batch);
}

static void test_batch(void)
{
    uint8_t *device = peek_device_memory(BATCH_FRAMES << 24), *pinned = peek_pinned_memory(BATCH_FRAMES << 24);
    check_batch(device);
    check_batch(pinned);
    peek_device_free(device);
    peek_pinned_free(pinned);
}

/* Too little device memory is refused by name of what is needed, and what fits then still renders. */
static void test_memory(void)
{
    fxs_cuda *small;
    fxs_scene scene;
    fxs_camera camera;
    fxs_options options;
    state = 11;
    packed_scene packed = random_scene(FXS_PROFILE_DEFAULT, 3000);
    uint8_t *pixels = room(100 * 80 * 4);
    random_camera(&camera);
    fxs_options_init(&options);
    fxs_scene_open(&scene, packed.data, packed.bytes);
    uint64_t needed = 1000;
    for (int tries = 0; tries < 8; tries++) {
        if (!CHECK(!fxs_cuda_create(&small, 0, needed, 1, &failure)))
            break;
        int error = fxs_cuda_upload(small, &scene, &failure);
        error = error ? error : fxs_cuda_render_host(small, &camera, &options, pixels, camera.width * 4, 0, &failure);
        fxs_cuda_destroy(small);
        if (!error)
            break;
        if (!CHECK(error == FXS_ERR_MEMORY && failure.bytes_needed > needed))
            break;
        needed = failure.bytes_needed;
    }
    CHECK(needed > 1000 && needed < 8000000);
    camera.width = 0;
    CHECK(fxs_cuda_upload(cuda, &scene, &failure) == 0);
    CHECK(fxs_cuda_render_host(cuda, &camera, &options, pixels, 0, 0, &failure) == FXS_ERR_SIZE);
    CHECK(fxs_cuda_create(&small, 1000, 0, 1, &failure) == FXS_ERR_DEVICE);
    CHECK(fxs_cuda_create(&small, 0, 0, 17, &failure) == FXS_ERR_ARGUMENT);
    free(pixels);
    free(packed.data);
}

/* A scene of no Gaussians is background; a frame that fails leaves none under way; a scene can be loaded again. */
static void test_edges(void)
{
    fxs_cuda *small;
    fxs_scene scene;
    fxs_camera camera;
    fxs_options options;
    fxs_options_init(&options);
    state = 3;
    random_camera(&camera);
    packed_scene packed = random_scene(FXS_PROFILE_DEFAULT, 3000);
    fxs_scene_open(&scene, packed.data, packed.bytes);
    CHECK(!fxs_cuda_upload(cuda, &scene, &failure));
    fxs_cuda_frame frames[2] = {{camera, 0, camera.width * 4}, {camera, 0, camera.width * 4}};
    CHECK(fxs_cuda_render(cuda, frames, 1, &options, 0, &failure) == FXS_ERR_ARGUMENT);
    uint8_t *device = peek_device_memory((size_t)camera.width * (size_t)camera.height * 4 + 4);
    frames[0].pixels = device + 1;
    CHECK(fxs_cuda_render(cuda, frames, 1, &options, 0, &failure) == FXS_ERR_ARGUMENT);
    frames[0].pixels = frames[1].pixels = device;
    frames[1].camera.width = 0;
    CHECK(fxs_cuda_render(cuda, frames, 2, &options, 0, &failure) == FXS_ERR_SIZE);
    CHECK(fxs_cuda_finish(cuda, 0, &failure) == FXS_ERR_ARGUMENT);
    CHECK(frame_equal(&scene, &camera, &options));
    frames[0].stride = -(camera.width * 4 - 4);    /* less than a row */
    CHECK(fxs_cuda_render(cuda, frames, 1, &options, 0, &failure) == FXS_ERR_ARGUMENT);
    peek_device_free(device);

    /* In no more memory than one loading and frame take. */
    fxs_cuda_stats stats = {0};
    uint8_t *pixels = room((size_t)camera.width * (size_t)camera.height * 4);
    for (int limited = 0; limited < 2; limited++) {
        CHECK(!fxs_cuda_create(&small, 0, stats.memory.total, 1, &failure));
        for (int i = 0; i <= 2 * limited; i++)
            CHECK(!fxs_cuda_upload(small, &scene, &failure) &&
                  !fxs_cuda_render_host(small, &camera, &options, pixels, camera.width * 4, &stats, &failure));
        fxs_cuda_destroy(small);
    }
    free(pixels);

    /* A header that changed after the scene was opened. */
    pixels = room((size_t)camera.width * (size_t)camera.height * 4);
    packed.chunks[scene.chunk_count / 2].step_shift = 63;
    CHECK(!fxs_cuda_upload(cuda, &scene, &failure));
    CHECK(fxs_cuda_render_host(cuda, &camera, &options, pixels, camera.width * 4, 0, &failure) == FXS_ERR_SCENE);
    packed.chunks[scene.chunk_count / 2].step_shift = 0;
    CHECK(!fxs_cuda_upload(cuda, &scene, &failure) && frame_equal(&scene, &camera, &options));
    free(pixels);

    scene.chunk_count = scene.count = 0;
    scene.rows = scene.chunks;
    CHECK(!fxs_cuda_upload(cuda, &scene, &failure) && frame_equal(&scene, &camera, &options));
    free(packed.data);
}

int main(int argc, char **argv)
{
    int quick = argc > 1 && !strcmp(argv[1], "--quick");
    cases = quick ? 6 : cases;
    files = argv + 1 + quick;
    file_count = argc - 1 - quick;
    if (fxs_cuda_create(&cuda, 0, 0, 1, &failure)) {
        printf("no CUDA device: %s\n", failure.text);
        return 1;
    }
    if (!quick)
        RUN(test_levels);
    RUN(test_default);
    RUN(test_compact);
    RUN(test_small);
    RUN(test_small_blocks);
    RUN(test_batch);
    RUN(test_memory);
    RUN(test_edges);
    RUN(test_files);
    fxs_cuda_destroy(cuda);
    return check_report();
}
