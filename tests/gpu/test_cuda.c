/* Compares the CUDA back end with the processor: splats, tile lists and every target.
 *   test_cuda [--quick] [FILE.fxs...]
 * --quick: few random frames. */
#include <inttypes.h>

#include <fixsplat/internal/backends.h>
#include <fixsplat/camera.h>
#include <fixsplat/system.h>
#include "src/core/frame.h"
#include "src/core/pool_places.h"
#include "src/core/targets.h"
#include "tests/moving_scene.h"
#include "tests/one_scene.h"
#include "tests/random_scene.h"
#include "tests/random_tree.h"
#include "tests/tile_lists.h"
#include "peek.h"

static fxs_cuda *cuda;
static fxs_message why;
static int quick;
static int overflows;              /* number of frames whose tile lists did not fit */
static char **files;
static int file_count;

static int cases(int count)
{
    return quick ? 3 : count;
}

static void *room(size_t bytes)
{
    void *memory = calloc(1, bytes + 1);
    if (!memory)
        abort();
    return memory;
}

/* ---- Random objects ---------------------------------------------------------------------------------------------- */

enum { SCENES = 3, OBJECTS = 100, CROPS = 3 };

typedef struct world {
    packed_scene packed[SCENES];
    fxs_scene scenes[SCENES];
    fxs_object objects[OBJECTS];
    fxs_crop crops[OBJECTS][CROPS];
    uint32_t count;
} world;

static void world_free(world *w)
{
    for (int i = 0; i < SCENES; i++) {
        fxs_cuda_forget(cuda, &w->scenes[i]);
        free(w->packed[i].data);
    }
}

static void random_crop(fxs_crop *crop)
{
    for (int i = 0; i < 3; i++) {
        crop->low_q32[i] = (int64_t)between(-4194304, 1048576) * 4096;
        crop->high_q32[i] = crop->low_q32[i] + (int64_t)between(0, 6291456) * 4096;
    }
    crop->outside = between(0, 1);
}

static void random_object(fxs_object *object, fxs_crop crops[CROPS])
{
    fxs_camera turned;
    random_camera(&turned);
    memcpy(object->rotation_q30, turned.rotation_q30, sizeof object->rotation_q30);
    for (int i = 0; i < 3; i++) {
        object->translation_q32[i] = (int64_t)between(-2097152, 2097152) * 4096;
        object->tint_q13[i] = between(0, 2) ? 8192 : (uint32_t)between(0, 4 * 8192);
    }
    object->scale_q32 = between(0, 2) ? (int64_t)1 << 32 : (int64_t)between(1 << 14, 1 << 18) << 16;
    object->opacity_q16 = between(0, 2) ? 65536 : (uint32_t)between(0, 65536);
    object->visible = between(0, 7) > 0;
    object->id = (uint32_t)between(0, 1000000);
    object->crop_count = between(0, 2) ? 0 : (uint32_t)between(1, CROPS);
    object->crops = crops;
    for (uint32_t i = 0; i < object->crop_count; i++)
        random_crop(&crops[i]);
}

static void random_world(world *w, uint32_t count, int32_t most)
{
    for (int i = 0; i < SCENES; i++) {
        w->packed[i] = random_scene((enum fxs_profile)i, most);
        fxs_scene_open(&w->scenes[i], w->packed[i].data, w->packed[i].bytes);
    }
    w->count = count;
    for (uint32_t i = 0; i < count; i++) {
        fxs_object_init(&w->objects[i], &w->scenes[between(0, SCENES - 1)]);
        random_object(&w->objects[i], w->crops[i]);
    }
}

static void random_options(fxs_options *options)
{
    fxs_options_init(options);
    options->cutoff = between(0, 3) ? FXS_CUTOFF_MAHALANOBIS : FXS_CUTOFF_SQUARE;
    options->sh_degree = between(0, 3);
    for (int c = 0; c < 3; c++)
        options->background[c] = (uint8_t)between(0, 255);
}

static void enlarge(fxs_camera *camera, int32_t times)
{
    camera->width *= times;
    camera->height *= times;
    camera->fx_q12 *= times;
    camera->fy_q12 *= times;
    camera->cx_q12 *= times;
    camera->cy_q12 *= times;
}

static void varied_view(fxs_camera *camera, int i)
{
    random_camera(camera);
    if (i % 3 == 1)
        random_near(camera);
    if (i % 5 == 2) {
        camera->projection = FXS_ORTHOGRAPHIC;
        camera->fx_q12 = between(1 << 12, 40 << 12);
        camera->fy_q12 = camera->fx_q12 + between(0, 4096);
    }
    if (i % 4 == 0)
        enlarge(camera, quick ? 3 : 9);
}

/* ---- Targets ----------------------------------------------------------------------------------------------------- */

enum { COLOUR = 1, COVERAGE = 2, MEAN = 4, MEDIAN = 8, ID = 16, OCCLUDER = 32, BACKDROP = 64, PLANES = 7 };

typedef struct pictures {
    fxs_targets targets;
    size_t bytes;
    uint8_t *memory;
} pictures;

static void images_of(fxs_targets *t, fxs_image *images[PLANES])
{
    fxs_image *const all[PLANES] = {&t->colour, &t->coverage, &t->mean_depth, &t->median_depth,
                                    &t->id, &t->occluder, &t->backdrop};
    memcpy(images, all, sizeof all);
}

static void lay_out(pictures *p, const fxs_camera *camera, unsigned which, enum fxs_format format, int depth_bits)
{
    const size_t pixel_bytes[PLANES] = {(size_t)fxs_pixel_bytes(format), 1, 4, 4, 8, 4, 4};
    size_t offsets[PLANES];
    fxs_image *images[PLANES];
    fxs_targets_init(&p->targets);
    p->targets.format = format;
    p->targets.depth_bits = depth_bits;
    p->bytes = 0;
    images_of(&p->targets, images);
    for (int i = 0; i < PLANES; i++) {
        offsets[i] = p->bytes;
        images[i]->stride = (ptrdiff_t)pixel_bytes[i] * (camera->width + between(0, 5));
        if (which >> i & 1)
            p->bytes += ((size_t)images[i]->stride * (size_t)camera->height + 63) / 64 * 64;
    }
    p->memory = room(p->bytes);
    for (int i = 0; i < PLANES; i++) {
        if (!(which >> i & 1))
            continue;
        images[i]->pixels = p->memory + offsets[i];
        if (between(0, 3) == 0) {
            images[i]->pixels = p->memory + offsets[i] + images[i]->stride * (camera->height - 1);
            images[i]->stride = -images[i]->stride;
        }
    }
}

/* Fills the targets with random bytes. Some depths of the occluder (a depth picture in front of the scene) become 0 or
 * FXS_NOTHING, which means no depth. */
static void fill_in(pictures *p, const fxs_camera *camera)
{
    for (size_t i = 0; i < p->bytes; i++)
        p->memory[i] = (uint8_t)next();
    for (int32_t y = 0; y < camera->height && p->targets.occluder.pixels; y++) {
        uint32_t *row = (uint32_t *)(void *)fxs_image_at(&p->targets.occluder, 0, y, 4);
        for (int32_t x = 0; x < camera->width; x++) {
            const int bits = fxs_depth_bits(&p->targets), kind = between(0, 9);
            const int64_t depth_q20 = between(1 << 19, 8 << 20);
            row[x] = kind == 0 ? FXS_NOTHING : kind == 1 ? 0
                     : (uint32_t)((depth_q20 << 8) >> (28 - bits));
        }
    }
}

static void move_to(pictures *to, const pictures *from, uint8_t *memory)
{
    fxs_image *images[PLANES];
    *to = *from;
    to->memory = memory;
    images_of(&to->targets, images);
    for (int i = 0; i < PLANES; i++)
        if (images[i]->pixels)
            images[i]->pixels = memory + ((uint8_t *)images[i]->pixels - from->memory);
}

static void twice(pictures p[2], const fxs_camera *camera, unsigned which, enum fxs_format format, int depth_bits)
{
    lay_out(&p[0], camera, which, format, depth_bits);
    fill_in(&p[0], camera);
    move_to(&p[1], &p[0], room(p[0].bytes));
    memcpy(p[1].memory, p[0].memory, p[0].bytes);
}

/* ---- The expected frame, by the plain C stages ------------------------------------------------------------------- */

typedef struct expected {
    fxs_stage_view view;
    uint32_t count, tiles;
    fxs_splat *splats;
    fxs_bounds *bounds;
    fxs_box *boxes;
    uint32_t *indices, *depths;
    tile_lists lists;
} expected;

static void expected_chunk(expected *e, const fxs_object_view *object, uint32_t chunk)
{
    uint32_t *indices = e->indices + e->count;
    const int32_t n = fxs_object_project(object, &fxs_kernels_c, chunk, 256, 0, e->splats + e->count,
                                         e->bounds + e->count, indices, e->depths + e->count);
    if (n < 0 || fxs_object_shade(object, &fxs_kernels_c, chunk, indices, (uint32_t)n, e->splats + e->count))
        abort();
    for (int32_t i = 0; i < n; i++)
        indices[i] += object->first_chunk * FXS_CHUNK;
    e->count += (uint32_t)n;
}

static int expected_splats(expected *e, const fxs_cuda_frame *frame)
{
    size_t most = 0;
    for (uint32_t i = 0; i < frame->count; i++)
        most += (size_t)frame->objects[i].scene->chunk_count * FXS_CHUNK;
    e->splats = room(most * sizeof *e->splats);
    e->bounds = room(most * sizeof *e->bounds);
    e->boxes = room(most * sizeof *e->boxes);
    e->indices = room(most * 4);
    e->depths = room(most * 4);
    uint32_t first_chunk = 0;
    for (uint32_t i = 0; i < frame->count; i++) {
        fxs_object_view object;
        const uint32_t chunks = frame->objects[i].scene->chunk_count;
        if (fxs_object_view_init(&object, &e->view, &frame->camera, &frame->objects[i]))
            return 0;
        object.first_chunk = first_chunk;
        for (uint32_t chunk = 0; chunk < chunks; chunk++)
            expected_chunk(e, &object, chunk);
        first_chunk += chunks;
    }
    fxs_bin_c(&e->view, e->splats, e->bounds, e->count, e->boxes);
    return 1;
}

static void expected_lists(expected *e)
{
    e->tiles = (uint32_t)(e->view.tiles_x * e->view.tiles_y);
    e->lists = tile_lists_new(&e->view, e->splats, e->bounds, e->boxes, e->depths, e->count);
}

static void expected_free(expected *e)
{
    void *const all[] = {e->splats, e->bounds, e->boxes, e->indices, e->depths};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        free(all[i]);
    if (e->lists.counts)
        tile_lists_free(&e->lists);
}

static int compare_keys(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

static int list_equal(const expected *e, uint32_t tile, uint64_t *list)
{
    const uint32_t count = e->lists.counts[tile], *entries = e->lists.entries + e->lists.ends[tile] - count;
    uint64_t *wanted = room(count * sizeof *wanted);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t slot = entries[i] & ~FXS_ENTRY_CUT_OFF;
        wanted[i] = (uint64_t)e->depths[slot] << 32 | e->indices[slot] | (entries[i] & FXS_ENTRY_CUT_OFF);
    }
    qsort(wanted, count, sizeof *wanted, compare_keys);
    int equal = 1;
    if (peek_is_sorted(count)) {
        for (uint32_t i = 0; i < count; i++)
            equal &= ((const uint32_t *)(const void *)list)[i] == (uint32_t)wanted[i];
    } else {
        qsort(list, count, sizeof *list, compare_keys);
        equal = !memcmp(wanted, list, count * sizeof *wanted);
    }
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
    overflows += !p->entries;
    for (uint32_t tile = 0; tile < e->tiles && p->entries; tile++)
        if (p->counts[tile] != e->lists.counts[tile] ||
            !list_equal(e, tile, p->entries + p->ends[tile] - p->counts[tile])) {
            printf("  list of tile %" PRIu32 " differs: %" PRIu32 " entries, %" PRIu32 " expected\n", tile,
                   p->counts[tile], e->lists.counts[tile]);
            return 0;
        }
    return 1;
}

static int stages_equal(const fxs_cuda_frame *frame, const fxs_options *options, const fxs_cuda_stats *stats)
{
    expected e;
    peeked p;
    memset(&e, 0, sizeof e);
    memset(&p, 0, sizeof p);
    if (fxs_view_init(&e.view, &frame->camera, options) || !expected_splats(&e, frame))
        return 0;
    expected_lists(&e);
    int equal = stats->visible == e.count && !peek(cuda, &p) && buffers_equal(&e, &p);
    if (stats->visible != e.count)
        printf("  %" PRIu32 " visible, %" PRIu32 " expected\n", stats->visible, e.count);
    peek_free(&p);
    expected_free(&e);
    return equal;
}

/* ---- Frames ------------------------------------------------------------------------------------------------------ */

static int render_eyes_c(const fxs_cuda_frame *frames, uint32_t eyes, const fxs_options *options,
                         const fxs_targets *targets, fxs_stats *stats)
{
    fxs_context context;
    const fxs_camera cameras[2] = {frames[0].camera, frames[eyes - 1].camera};
    const fxs_request request = request_for(frames->objects, frames->count, options, eyes, cameras, targets);
    fxs_context_init(&context, 0);
    const size_t bytes = fxs_request_bytes(&context, &request, 0);
    void *memory = check_aligned(bytes);
    if (!memory)
        abort();
    const int error = fxs_render(&context, &request, memory, bytes, stats);
    free(memory);
    return error;
}

static void render_c(const fxs_cuda_frame *frame, const fxs_options *options, const fxs_targets *targets)
{
    if (render_eyes_c(frame, 1, options, targets, 0))
        abort();
}

static int pictures_equal(pictures p[2], const fxs_camera *camera)
{
    static const char *const names[PLANES] = {"colour", "coverage", "mean", "median", "id", "occluder", "backdrop"};
    fxs_image *images[2][PLANES];
    const int pixel_bytes[PLANES] = {fxs_pixel_bytes(p->targets.format), 1, 4, 4, 8, 4, 4};
    if (!memcmp(p[0].memory, p[1].memory, p->bytes))
        return 1;
    images_of(&p[0].targets, images[0]);
    images_of(&p[1].targets, images[1]);
    for (int i = 0; i < PLANES; i++)
        for (int32_t y = 0; y < camera->height && images[0][i]->pixels; y++)
            for (int32_t x = 0; x < camera->width; x++)
                if (memcmp(fxs_image_at(images[0][i], x, y, pixel_bytes[i]),
                           fxs_image_at(images[1][i], x, y, pixel_bytes[i]), (size_t)pixel_bytes[i])) {
                    printf("  %s differs at %d, %d\n", names[i], (int)x, (int)y);
                    return 0;
                }
    puts("  what lies between rows was written");
    return 0;
}

static int frame_equal(const fxs_object *objects, uint32_t count, const fxs_camera *camera, const fxs_options *options,
                       unsigned which, enum fxs_format format, int depth_bits)
{
    pictures p[2];
    fxs_cuda_stats stats;
    twice(p, camera, which, format, depth_bits);
    fxs_cuda_frame frame = {*camera, objects, count, p[1].targets};
    render_c(&frame, options, &p[0].targets);
    int equal = !fxs_cuda_render_host(cuda, &frame, 1, options, &stats, &why);
    if (!equal)
        printf("  %s\n", why.text);
    equal = equal && stages_equal(&frame, options, &stats) && pictures_equal(p, camera);
    free(p[0].memory);
    free(p[1].memory);
    return equal;
}

static int scene_equal(const fxs_scene *scene, const fxs_camera *camera, const fxs_options *options)
{
    fxs_object object;
    fxs_object_init(&object, scene);
    return frame_equal(&object, 1, camera, options, COLOUR, (enum fxs_format)between(0, 3), 0);
}

static void check_random(enum fxs_profile profile, int count)
{
    for (int i = 0; i < count; i++) {
        state = (uint64_t)i * 0x1234567u + 99;
        packed_scene packed = random_scene(profile, i % 8 == 1 ? (quick ? 15000 : 60000) : 3000);
        fxs_scene scene;
        fxs_camera camera;
        fxs_options options;
        varied_view(&camera, i);
        random_options(&options);
        fxs_scene_open(&scene, packed.data, packed.bytes);
        const int good = CHECK(scene_equal(&scene, &camera, &options));
        fxs_cuda_forget(cuda, &scene);
        free(packed.data);
        if (!good) {
            printf("  case %d\n", i);
            return;
        }
    }
}

static void test_default(void)
{
    check_random(FXS_PROFILE_DEFAULT, cases(200));
}

static void test_compact(void)
{
    check_random(FXS_PROFILE_COMPACT, cases(100));
}

static void test_small(void)
{
    check_random(FXS_PROFILE_SMALL, cases(100));
}

static void check_objects(int count, uint32_t most_objects, int32_t most_gaussians)
{
    for (int i = 0; i < count; i++) {
        world w;
        fxs_camera camera;
        fxs_options options;
        state = (uint64_t)i * 0x7654321u + most_objects;
        const uint32_t objects = most_objects == OBJECTS ? OBJECTS : (uint32_t)between(0, (int32_t)most_objects);
        random_world(&w, objects, most_gaussians);
        varied_view(&camera, i);
        random_options(&options);
        const unsigned which = i % 2 ? (unsigned)between(1, 31) | (between(0, 1) ? OCCLUDER : 0) : COLOUR;
        const enum fxs_format format = (enum fxs_format)between(0, 3);
        const int good = CHECK(frame_equal(w.objects, w.count, &camera, &options, which, format, between(0, 28)));
        world_free(&w);
        if (!good) {
            printf("  case %d\n", i);
            return;
        }
    }
}

static void test_objects(void)
{
    check_objects(cases(300), 5, 2000);
}

static void test_hundred_objects(void)
{
    check_objects(quick ? 1 : 12, OBJECTS, quick ? 600 : 3000);
}

static void test_targets(void)
{
    for (int i = 0; i < cases(250); i++) {
        fxs_object object;
        fxs_scene scene;
        fxs_camera camera;
        fxs_options options;
        state = (uint64_t)i * 0x1020304u + 5;
        packed_scene packed = random_scene((enum fxs_profile)between(0, 2), i % 4 == 3 && !quick ? 60000 : 4000);
        fxs_scene_open(&scene, packed.data, packed.bytes);
        fxs_object_init(&object, &scene);
        object.id = (uint32_t)next();
        varied_view(&camera, i);
        random_options(&options);
        const enum fxs_format format = (enum fxs_format)(i % 4);
        unsigned which = i < 5 ? 1u << i : (unsigned)between(1, 31);
        which |= quick && i == 2 ? MEAN | MEDIAN | ID | OCCLUDER : 0;
        which |= i >= 5 && between(0, 1) ? OCCLUDER : 0;
        which |= between(0, 1) && !fxs_is_premultiplied(format) ? BACKDROP : 0;
        const int good = CHECK(frame_equal(&object, 1, &camera, &options, which, format, i % 3 ? between(1, 28) : 0));
        fxs_cuda_forget(cuda, &scene);
        free(packed.data);
        if (!good) {
            printf("  case %d\n", i);
            return;
        }
    }
}

static void test_levels(void)
{
    long wrong = peek_levels();
    if (!CHECK(wrong == 0))
        printf("  %ld levels\n", wrong);
}

static void overview(fxs_camera *camera, const fxs_packed_header *header)
{
    const double up[3] = {0, -1, 0};
    double low[3], high[3];
    fxs_view view;
    for (int k = 0; k < 3; k++) {
        low[k] = (double)header->inner_low_q32[k] / 4294967296.0;
        high[k] = (double)header->inner_high_q32[k] / 4294967296.0;
    }
    fxs_view_frame_box(&view, low, high, up, &(fxs_picture){50, 1280, 720}, &why);
    fxs_camera_from_view(camera, &view, &why);
}

static void test_files(void)
{
    if (!file_count)
        SKIP("no .fxs file given");
    for (int i = 0; i < file_count; i++) {
        fxs_mapping file;
        fxs_scene scene;
        fxs_camera camera;
        fxs_options options;
        fxs_object objects[2];
        if (!CHECK(!fxs_map_open(&file, files[i], &why)) || !CHECK(!fxs_scene_open(&scene, file.data, file.bytes)))
            continue;
        overview(&camera, file.data);
        fxs_options_init(&options);
        fxs_object_init(&objects[0], &scene);
        objects[1] = objects[0];
        objects[1].translation_q32[0] = (int64_t)1 << 31;
        objects[1].opacity_q16 = 40000;
        int good = CHECK(scene_equal(&scene, &camera, &options));
        good &= CHECK(frame_equal(objects, 2, &camera, &options, COLOUR | MEAN | MEDIAN | ID, FXS_FORMAT_RGBA8, 0));
        options.cutoff = FXS_CUTOFF_SQUARE;
        good &= CHECK(scene_equal(&scene, &camera, &options));
        if (!good)
            printf("  %s\n", files[i]);
        fxs_cuda_forget(cuda, &scene);
        fxs_map_close(&file);
    }
}

/* ---- Levels of detail -------------------------------------------------------------------------------------------- */

enum { TREES = 2, TREE_OBJECTS = 4 };

typedef struct forest {
    packed_scene packed[TREES + 1];        /* the last of these scenes has no level-of-detail tree */
    fxs_object objects[TREE_OBJECTS];
    uint32_t count, chunks;
} forest;

static void random_forest(forest *w, uint32_t most_leaves, int deep, int alike)
{
    for (int i = 0; i < TREES; i++)
        w->packed[i] = random_tree((enum fxs_profile)between(0, 2), (uint32_t)between(2, (int32_t)most_leaves), deep,
                                   alike);
    w->packed[TREES] = random_scene(FXS_PROFILE_DEFAULT, 3000);
    w->count = (uint32_t)between(1, TREE_OBJECTS);
    w->chunks = 0;
    for (uint32_t i = 0; i < w->count; i++) {
        fxs_object *object = &w->objects[i];
        fxs_object_init(object, &w->packed[between(0, 5) ? between(0, TREES - 1) : TREES].scene);
        for (int k = 0; k < 3; k++)
            object->translation_q32[k] = (int64_t)between(-2097152, 2097152) * 4096;
        object->scale_q32 = between(0, 2) ? FXS_ONE_Q32 : (int64_t)between(1 << 14, 1 << 18) << 16;
        object->visible = between(0, 7) > 0;
        w->chunks += object->scene->chunk_count;
    }
}

static void forest_free(forest *w)
{
    for (int i = 0; i <= TREES; i++) {
        fxs_cuda_forget(cuda, &w->packed[i].scene);
        free(w->packed[i].data);
    }
}

static int cuts_equal(const fxs_cuda_frame *frame, const fxs_camera *cameras, uint32_t eyes,
                      const fxs_options *options, int *by_device)
{
    uint32_t wanted_count, count;
    void *drawn = 0;
    fxs_drawn *wanted = find_cut(frame->objects, frame->count, cameras, eyes, options, &wanted_count);
    int equal = 1;
    *by_device = 0;
    if (wanted) {
        equal = !peek_cut(cuda, &drawn, &count, by_device) && count == wanted_count &&
                !memcmp(drawn, wanted, count * sizeof *wanted);
        if (!equal)
            printf("  %" PRIu32 " chunks are drawn, %" PRIu32 " expected\n", count, wanted_count);
    }
    free(drawn);
    free(wanted);
    return equal;
}

static int cut_frame_equal(const fxs_object *objects, uint32_t count, const fxs_camera *cameras, uint32_t eyes,
                           const fxs_options *options, int *by_device)
{
    pictures p[2][2];
    fxs_cuda_frame frames[2];
    fxs_targets targets[2];
    for (uint32_t eye = 0; eye < eyes; eye++) {
        twice(p[eye], &cameras[eye], COLOUR | ID, FXS_FORMAT_RGBA8, 0);
        frames[eye] = (fxs_cuda_frame){cameras[eye], objects, count, p[eye][1].targets};
        targets[eye] = p[eye][0].targets;
    }
    fxs_cuda_stereo(cuda, eyes == 2);
    int equal = !render_eyes_c(frames, eyes, options, targets, 0) &&
                !fxs_cuda_render_host(cuda, frames, eyes, options, 0, &why);
    fxs_cuda_stereo(cuda, 0);
    if (!equal)
        printf("  %s\n", why.text);
    equal = equal && cuts_equal(frames, cameras, eyes, options, by_device);
    for (uint32_t eye = 0; eye < eyes; eye++) {
        equal = equal && pictures_equal(p[eye], &cameras[eye]);
        free(p[eye][0].memory);
        free(p[eye][1].memory);
    }
    return equal;
}

/* On random level-of-detail trees, the device must choose the same nodes and draw the same picture as the processor.
 * Every tenth tree is too deep for the device. */
static void test_cut(void)
{
    int of_device = 0, of_host = 0;
    for (int i = 0; i < cases(500); i++) {
        fxs_camera cameras[2];
        fxs_options options;
        int by_device;
        state = (uint64_t)i * 0x2468aceu + 17;
        forest w;
        random_forest(&w, i % 7 == 0 && !quick ? 1500 : 100, i % 10 == 9, i % 6 == 5);
        random_cut(cameras, &options, w.chunks);
        random_other_eye(cameras);
        const int good = CHECK(cut_frame_equal(w.objects, w.count, cameras, 1 + (uint32_t)i % 2, &options, &by_device));
        of_device += by_device;
        of_host += !by_device;
        forest_free(&w);
        if (!good) {
            printf("  case %d\n", i);
            return;
        }
    }
    printf("  %d cuts by the device, %d none or by the host\n", of_device, of_host);
    CHECK(of_device > of_host || quick);
}

static void test_equal_keys(void)
{
    fxs_camera camera;
    fxs_options options;
    int by_device;
    state = 4;
    packed_scene tree = random_tree(FXS_PROFILE_SMALL, quick ? 300 : 12000, 0, 1);
    fxs_object object = one_object(&tree.scene);
    do
        random_view(&camera, &options);
    while (camera.projection != FXS_ORTHOGRAPHIC);
    camera.fx_q12 = camera.fy_q12 = 2 << 12;
    for (uint32_t budget = 1; budget < tree.scene.count; budget = 3 * budget + 200) {
        options.budget = budget;
        CHECK(cut_frame_equal(&object, 1, &camera, 1, &options, &by_device) && by_device);
    }
    fxs_cuda_forget(cuda, &tree.scene);
    fxs_node *nodes = (fxs_node *)(void *)(tree.data + (tree.scene.nodes - tree.data));
    nodes[0].children[0] = nodes[0].children[1];
    options.budget = 1000;
    uint8_t pixels[4 * 100 * 80];
    const fxs_cuda_frame frame = {camera, &object, 1, {.colour = {pixels, camera.width * 4}}};
    CHECK(fxs_cuda_render_host(cuda, &frame, 1, &options, 0, &why) == FXS_ERR_SCENE);
    fxs_cuda_forget(cuda, &tree.scene);
    free(tree.data);
}

enum { POOL_FRAMES = 3 };

static int check_pooled(fxs_cuda *by, const fxs_object *objects, uint32_t budget, fxs_cuda_stats *stats)
{
    pictures p[POOL_FRAMES][2];
    fxs_cuda_frame frames[POOL_FRAMES];
    fxs_options options;
    fxs_options_init(&options);
    options.budget = budget;
    for (uint32_t i = 0; i < POOL_FRAMES; i++) {
        random_camera(&frames[i].camera);
        twice(p[i], &frames[i].camera, COLOUR | ID, FXS_FORMAT_RGBA8, 0);
        frames[i].objects = objects + i % 2;
        frames[i].count = 3 - i % 2;
        frames[i].targets = p[i][1].targets;
        render_c(&frames[i], &options, &p[i][0].targets);
    }
    const int error = fxs_cuda_render_host(by, frames, POOL_FRAMES, &options, stats, &why);
    for (int i = 0; i < POOL_FRAMES; i++) {
        CHECK(error || pictures_equal(p[i], &frames[i].camera));
        free(p[i][0].memory);
        free(p[i][1].memory);
    }
    return error;
}

static int check_limit(uint64_t limit, const fxs_object *objects, fxs_cuda_stats *stats)
{
    fxs_cuda *small;
    int error = fxs_cuda_create(&small, 0, limit, 2, &why);
    state = 99;
    for (int i = 0; i < (quick ? 2 : 8) && !error; i++)
        error = check_pooled(small, objects, i % 4 == 1 ? 0 : (uint32_t)between(1, 100) * FXS_CHUNK, stats);
    fxs_cuda_destroy(small);
    return error;
}

static void test_pool(void)
{
    state = 57;
    const packed_scene tree = random_tree(FXS_PROFILE_DEFAULT, quick ? 40 : 200, 0, 0);
    const packed_scene plain = random_scene(FXS_PROFILE_COMPACT, 30000);
    const fxs_scene *const scenes[2] = {&tree.scene, &plain.scene};
    fxs_object objects[3] = {one_object(scenes[0]), one_object(scenes[0]), one_object(scenes[1])};
    objects[1].translation_q32[0] = FXS_ONE_Q32 / 2;
    const uint64_t rows = fxs_scene_chunks(scenes[0]) * (uint64_t)tree.scene.chunk_bytes +
                          plain.scene.chunk_count * (uint64_t)plain.scene.chunk_bytes;
    fxs_cuda_stats stats = {0};
    uint64_t least = 1000;
    for (int tries = 0; tries < 20 && check_limit(least, objects, &stats) == FXS_ERR_MEMORY; tries++)
        if (CHECK(why.bytes_needed > least))
            least = why.bytes_needed;
    for (uint64_t part = 0; part < (quick ? 2 : 4); part++) {
        const uint64_t limit = least + rows * part / 6;
        if (!CHECK(!check_limit(limit, objects, &stats)))
            printf("  %s\n", why.text);
        CHECK(stats.memory.total <= limit && stats.memory.scenes < rows);
        printf("  %" PRIu64 " of %" PRIu64 " bytes of rows on the device, with all else\n", stats.memory.scenes, rows);
    }
    free(tree.data);
    free(plain.data);
}

/* ---- Scenes in parts --------------------------------------------------------------------------------------------- */

enum { PARTS = 2, PART_OBJECTS = 4 };

/* A scene of which `part` has some chunks in memory, in `room` places. `shown` has the chunks that the device has. */
typedef struct streamed {
    packed_scene tree;
    fxs_scene part, shown;
    uint32_t *in_memory, *on_device, *owners, *wanted;
    uint32_t chunks, room, wanted_count;
    unsigned char *rows, *places;
} streamed;

static void load(streamed *s, uint32_t chunk, uint32_t place)
{
    const size_t bytes = s->part.chunk_bytes;
    if (s->in_memory[chunk] != FXS_NOTHING)
        return;
    if (s->owners[place] != FXS_NOTHING)
        s->in_memory[s->owners[place]] = FXS_NOTHING;
    s->owners[place] = chunk;
    s->in_memory[chunk] = place;
    memcpy(s->places + place * bytes, s->rows + chunk * bytes, bytes);
}

static void note_wanted(void *argument, const fxs_scene *scene, uint32_t chunk, int there)
{
    streamed *s = argument, *const end = s + PARTS;
    while (s < end && scene != &s->part)
        s++;
    if (!CHECK(s < end && there == (s->in_memory[chunk] != FXS_NOTHING)))
        return;
    if (!there && s->wanted_count < s->chunks)
        s->wanted[s->wanted_count++] = chunk;
}

/* Loads wanted chunks and `more` others into random places in memory, whose chunks are evicted. */
static void load_wanted(streamed parts[PARTS], int more)
{
    for (streamed *s = parts; s < parts + PARTS; s++) {
        for (uint32_t i = 0; i < s->wanted_count; i++)
            load(s, s->wanted[i], (uint32_t)between(0, (int32_t)s->room - 1));
        for (int i = 0; i < more; i++)
            load(s, (uint32_t)between(0, (int32_t)s->chunks - 1), (uint32_t)between(0, (int32_t)s->room - 1));
        s->wanted_count = 0;
    }
}

static void streamed_make(streamed *s, enum fxs_profile profile, uint32_t leaves, uint32_t room_of_memory)
{
    memset(s, 0, sizeof *s);
    do {
        free(s->tree.data);
        s->tree = random_tree(profile, leaves, 0, 0);
    } while (profile != FXS_PROFILE_DEFAULT && !s->tree.scene.palette);
    s->tree.scene.palette_step_q19 = 1500;
    const size_t bytes = s->tree.scene.chunk_bytes;
    s->chunks = fxs_scene_chunks(&s->tree.scene);
    s->room = room_of_memory;
    uint32_t *numbers = s->in_memory = room((3 * s->chunks + s->room) * sizeof *numbers);
    memset(numbers, 0xff, (3 * s->chunks + s->room) * sizeof *numbers);
    s->on_device = numbers + s->chunks;
    s->wanted = numbers + 2 * s->chunks;
    s->owners = numbers + 3 * s->chunks;
    s->rows = check_aligned((s->chunks + s->room) * bytes);
    s->places = s->rows + s->chunks * bytes;
    memcpy(s->rows, s->tree.scene.rows, leaves * bytes);
    memcpy(s->rows + leaves * bytes, s->tree.scene.node_rows, (leaves - 1) * bytes);
    s->part = s->shown = s->tree.scene;
    s->part.rows = s->places;
    s->part.places = s->in_memory;
    s->shown.rows = s->rows;
    s->shown.places = s->on_device;
    load(s, leaves, 0);
}

static void streamed_free(streamed parts[PARTS])
{
    for (streamed *s = parts; s < parts + PARTS; s++) {
        free(s->in_memory);
        free(s->rows);
        free(s->tree.data);
    }
}

static uint64_t bytes_of_place(const streamed *s)
{
    return s->part.chunk_bytes + sizeof(fxs_chunk);
}

/* Notes the chunks on the device, for `shown`. Returns the bytes of those that came. */
static uint64_t note_device(streamed *s, const fxs_cuda *by)
{
    const uint32_t *places = peek_places(by, &s->part);
    uint32_t came = 0;
    for (uint32_t i = 0; i < s->chunks && places; i++) {
        came += places[i] != FXS_NOTHING && s->on_device[i] == FXS_NOTHING;
        s->on_device[i] = places[i] == FXS_NOTHING ? FXS_NOTHING : i;
    }
    return came * bytes_of_place(s);
}

/* A view of all chunks of a random scene. */
static void far_view(fxs_camera *camera)
{
    *camera = (fxs_camera){.width = 64, .height = 48, .fx_q12 = 60 << 12, .fy_q12 = 60 << 12, .cx_q12 = 32 << 12,
                           .cy_q12 = 24 << 12, .position_q32 = {0, 0, -12 * FXS_ONE_Q32}};
    for (int i = 0; i < 3; i++)
        camera->rotation_q30[4 * i] = 1 << 30;
}

typedef struct streamed_frame {
    streamed *parts;
    fxs_object objects[PART_OBJECTS];      /* two of the first scene in parts, one of the second, one of a whole
                                              scene */
    fxs_camera cameras[2];
    fxs_options options;
    uint32_t count, eyes;
    fxs_cuda_stats stats;
    uint64_t came;
} streamed_frame;

static void streamed_objects(streamed_frame *f, streamed parts[PARTS], const fxs_scene *whole)
{
    const fxs_scene *scenes[PART_OBJECTS] = {&parts[0].part, &parts[0].part, &parts[1].part, whole};
    f->parts = parts;
    for (int i = 0; i < PART_OBJECTS; i++) {
        f->objects[i] = one_object(scenes[i]);
        f->objects[i].translation_q32[0] = i * FXS_ONE_Q32 / 3;
        f->objects[i].id = (uint32_t)i;
    }
}

/* Draws a frame on the processor, with the chunks that are on the device. */
static void streamed_expected(streamed_frame *f, const fxs_cuda_frame *frames, const fxs_targets *targets,
                              fxs_stats *stats)
{
    fxs_object objects[PART_OBJECTS];
    fxs_cuda_frame shown[2] = {frames[0], frames[f->eyes - 1]};
    memcpy(objects, f->objects, sizeof objects);
    for (int i = 0; i < 3; i++)
        objects[i].scene = &f->parts[i / 2].shown;
    shown[0].objects = shown[1].objects = objects;
    fxs_options options = f->options;
    options.want.call = 0;
    CHECK(!render_eyes_c(shown, f->eyes, &options, targets, stats));
}

/* Draws a frame on the device, and compares it to the processor's. */
static int streamed_draw(streamed_frame *f, fxs_cuda *by)
{
    pictures p[2][2];
    fxs_cuda_frame frames[2];
    fxs_targets targets[2];
    fxs_stats wanted;
    for (uint32_t eye = 0; eye < f->eyes; eye++) {
        twice(p[eye], &f->cameras[eye], COLOUR | ID, FXS_FORMAT_RGBA8, 0);
        frames[eye] = (fxs_cuda_frame){f->cameras[eye], f->objects, f->count, p[eye][1].targets};
        targets[eye] = p[eye][0].targets;
    }
    f->options.want = (fxs_want){note_wanted, f->parts};
    fxs_cuda_stereo(by, f->eyes == 2);
    const int error = fxs_cuda_render_host(by, frames, f->eyes, &f->options, &f->stats, &why);
    fxs_cuda_stereo(by, 0);
    f->came = note_device(&f->parts[0], by) + note_device(&f->parts[1], by);
    if (!error)
        streamed_expected(f, frames, targets, &wanted);
    CHECK(error || f->stats.missing == wanted.missing);
    for (uint32_t eye = 0; eye < f->eyes; eye++) {
        CHECK(error || pictures_equal(p[eye], &f->cameras[eye]));
        free(p[eye][0].memory);
        free(p[eye][1].memory);
    }
    return error;
}

static int stop_now(void *argument)
{
    (void)argument;
    return 1;
}

/* Frames of scenes in parts from changing views, and then of one view until it is complete. Each frame uploads at most
 * `limit` bytes to pools of `pool` bytes. Returns the number of bytes that were evicted from the pools. */
static uint64_t check_parts(streamed parts[PARTS], uint64_t pool, uint64_t limit, int count)
{
    enum { STILL = 60 };
    streamed_frame f = {.count = 0};
    fxs_cuda *by;
    uint64_t gone = 0;
    const packed_scene whole = random_scene(FXS_PROFILE_COMPACT, 1000);
    if (!CHECK(!fxs_cuda_create(&by, 0, 0, 2, &why)))
        return 0;
    fxs_cuda_stream(by, pool, limit);
    CHECK(!fxs_cuda_upload(by, &parts[0].part, &why) && !fxs_cuda_upload(by, &parts[1].part, &why));
    streamed_objects(&f, parts, &whole.scene);
    for (int i = 0; i < count && !check_faults; i++) {
        if (i % 3 == 0) {
            random_cut(f.cameras, &f.options, parts->chunks);
            if (i % 2)
                far_view(f.cameras);
            random_other_eye(f.cameras);
        }
        f.count = (uint32_t)between(1, PART_OBJECTS);
        f.eyes = (uint32_t)between(1, 2);
        f.objects[1].visible = i % 5 > 0;
        const int stops = i % 7 == 5;
        f.options.stop.call = stops ? stop_now : 0;
        CHECK(streamed_draw(&f, by) == (stops ? FXS_ERR_STOPPED : 0) && f.came <= limit);
        gone += f.came;
        load_wanted(parts, 3);
    }
    fxs_options_init(&f.options);
    f.options.budget = 8 * FXS_CHUNK;
    f.count = 3;
    far_view(f.cameras);
    random_other_eye(f.cameras);
    for (int i = 0; i < STILL && (i == 0 || f.stats.missing) && !check_faults; i++) {
        CHECK(!streamed_draw(&f, by) && f.came <= limit);
        gone += f.came;
        load_wanted(parts, 0);
    }
    CHECK(!f.stats.missing);
    for (streamed *s = parts; s < parts + PARTS; s++)
        for (uint32_t i = 0; i < s->chunks; i++)
            gone -= s->on_device[i] != FXS_NOTHING ? bytes_of_place(s) : 0;
    fxs_cuda_destroy(by);
    free(whole.data);
    return gone;
}

static void test_parts(void)
{
    uint64_t evicted = 0;
    for (int i = 0; i < cases(30); i++) {
        streamed parts[PARTS];
        state = (uint64_t)i * 0x1357913u + 7;
        for (int k = 0; k < PARTS; k++)
            streamed_make(&parts[k], (enum fxs_profile)((i + k) % 3), quick ? 40 : 150, quick ? 40 : 150);
        const uint64_t a = bytes_of_place(&parts[0]), b = bytes_of_place(&parts[1]), each = a > b ? a : b;
        evicted += check_parts(parts, (uint64_t)between(16, 24) * each, 5 * each + 1, quick ? 15 : 60) / each;
        streamed_free(parts);
    }
    printf("  %" PRIu64 " chunks evicted\n", evicted);
    CHECK(evicted > 10);
}

/* A pool that is smaller than the cut: the picture stays as coarse as the pool, and tells how much is missing. A larger
 * pool completes it. */
static void test_small_pool(void)
{
    streamed parts[PARTS];
    streamed_frame f = {.count = 2, .eyes = 1};
    fxs_cuda *by;
    state = 77;
    for (int i = 0; i < PARTS; i++)
        streamed_make(&parts[i], FXS_PROFILE_SMALL, 40, 79);
    const uint64_t each = bytes_of_place(parts), least = FXS_PLACES_LEAST * each;
    if (!CHECK(!fxs_cuda_create(&by, 0, 0, 1, &why)))
        return;
    streamed_objects(&f, parts, &parts->part);
    far_view(f.cameras);
    fxs_options_init(&f.options);
    fxs_cuda_stream(by, least - 1, 0);
    CHECK(streamed_draw(&f, by) == FXS_ERR_MEMORY && why.bytes_needed == least && strstr(why.text, "16 chunks"));
    fxs_cuda_stream(by, least, 1);
    for (int i = 0; i < 40; i++) {
        CHECK(!streamed_draw(&f, by) && f.came <= each && f.stats.missing);
        load_wanted(parts, 0);
    }
    fxs_cuda_stream(by, 0, 30 * each);
    for (int i = 0; i < 10; i++) {
        CHECK(!streamed_draw(&f, by));
        load_wanted(parts, 0);
    }
    CHECK(!f.stats.missing && !f.came && f.stats.memory.scenes >= parts->chunks * each);
    fxs_cuda_destroy(by);
    CHECK(!fxs_cuda_create(&by, 0, 2 * least - 1, 1, &why));
    CHECK(fxs_cuda_upload(by, &parts->part, &why) == FXS_ERR_MEMORY && why.bytes_needed == 2 * least);
    fxs_cuda_destroy(by);
    CHECK(!fxs_cuda_create(&by, 0, 2 * least, 1, &why) && !fxs_cuda_upload(by, &parts->part, &why));
    CHECK(streamed_draw(&f, by) == FXS_ERR_MEMORY && why.bytes_needed > 2 * least);
    fxs_cuda_destroy(by);
    streamed_free(parts);
}

/* Several calls in flight on two streams, with uploads and evictions between them. */
static void test_parts_in_flight(void)
{
    enum { FRAMES = 24, POOL = 30, BYTES = 4 * 100 * 80 };
    void *const streams[] = {peek_stream(), peek_stream()};
    uint8_t *device = peek_device_memory(FRAMES * BYTES), *wanted = room(FRAMES * BYTES), *drawn = room(BYTES);
    size_t bytes[FRAMES];
    streamed_frame f = {.count = 3, .eyes = 1};
    streamed parts[PARTS];
    fxs_cuda *by;
    uint64_t came = 0;
    state = 41;
    for (int i = 0; i < PARTS; i++)
        streamed_make(&parts[i], FXS_PROFILE_COMPACT, 60, 119);
    const uint64_t each = bytes_of_place(parts);
    streamed_objects(&f, parts, &parts->part);
    if (!CHECK(device && streams[1] && !fxs_cuda_create(&by, 0, 0, 2, &why)))
        return;
    fxs_cuda_stream(by, POOL * each, 9 * each);
    for (int i = 0; i < FRAMES; i++) {
        random_cut(f.cameras, &f.options, parts->chunks);
        if (i % 2)
            far_view(f.cameras);
        const fxs_cuda_frame frame = {*f.cameras, f.objects, f.count, {.colour = {device + i * BYTES,
                                                                                  4 * f.cameras->width}}};
        fxs_targets targets;
        fxs_targets_init(&targets);
        targets.colour = (fxs_image){wanted + i * BYTES, 4 * f.cameras->width};
        bytes[i] = 4 * (size_t)f.cameras->width * (size_t)f.cameras->height;
        f.options.want = (fxs_want){note_wanted, parts};
        CHECK(bytes[i] <= BYTES && !fxs_cuda_render(by, &frame, 1, &f.options, streams[i % 2], &why));
        came += note_device(&parts[0], by) + note_device(&parts[1], by);
        streamed_expected(&f, &frame, &targets, 0);
        load_wanted(parts, 0);
    }
    CHECK(!fxs_cuda_finish(by, 0, &why) && came > (2 * POOL + 20) * each);
    for (int i = 0; i < FRAMES; i++)
        CHECK(!peek_copy(drawn, device + i * BYTES, bytes[i]) && !memcmp(drawn, wanted + i * BYTES, bytes[i]));
    fxs_cuda_destroy(by);
    streamed_free(parts);
    peek_device_free(device);
    peek_stream_free(streams[0]);
    peek_stream_free(streams[1]);
    free(wanted);
    free(drawn);
}

/* By the table of the back end: a view of a scene in parts, until it is complete. */
static void test_table_parts(void)
{
    const fxs_backend *b = &fxs_backend_cuda;
    const fxs_backend_options settings = {.size = sizeof(fxs_backend_options)};
    streamed parts[PARTS];
    pictures p[2];
    fxs_camera camera;
    fxs_options options;
    fxs_stats stats = {.missing = 1};
    void *self;
    state = 61;
    for (int i = 0; i < PARTS; i++)
        streamed_make(&parts[i], FXS_PROFILE_DEFAULT, 30, 59);
    const fxs_object object = one_object(&parts->part), whole = one_object(&parts->tree.scene);
    far_view(&camera);
    fxs_options_init(&options);
    options.budget = 20 * FXS_CHUNK;
    twice(p, &camera, COLOUR | ID, FXS_FORMAT_RGBA8, 0);
    const fxs_cuda_frame frame = {camera, &whole, 1, p[0].targets};
    render_c(&frame, &options, &p[0].targets);
    options.want = (fxs_want){note_wanted, parts};
    const fxs_request request = request_for(&object, 1, &options, 1, &camera, &p[1].targets);
    if (!CHECK(b->can & FXS_CAN_PART && !b->open(&self, &settings, &why)))
        return;
    for (int i = 0; i < 20 && stats.missing; i++) {
        CHECK(!b->render(self, &request, &stats, &why));
        load_wanted(parts, 0);
    }
    CHECK(!stats.missing && pictures_equal(p, &camera));
    b->forget(self, &parts->part);
    b->close(self);
    free(p[0].memory);
    free(p[1].memory);
    streamed_free(parts);
}

/* ---- Batches ----------------------------------------------------------------------------------------------------- */

enum { BATCH_FRAMES = 7, BATCH_BYTES = 1 << 25 };

static void check_batch(uint8_t *memory)
{
    enum { SLOTS = 3 };
    fxs_cuda *batch;
    fxs_cuda_frame frames[BATCH_FRAMES];
    pictures wanted[BATCH_FRAMES], there[BATCH_FRAMES];
    fxs_options options;
    world w;
    state = 5;
    random_world(&w, 4, quick ? 2000 : 8000);
    fxs_options_init(&options);
    if (!CHECK(memory && !fxs_cuda_create(&batch, 0, 0, SLOTS, &why)))
        return;
    for (uint32_t i = 0; i < BATCH_FRAMES; i++) {
        fxs_camera *camera = &frames[i].camera;
        const unsigned which = COLOUR | (i % 3 == 1 ? MEAN | MEDIAN | ID | OCCLUDER : i % 2 ? COVERAGE : BACKDROP);
        random_camera(camera);
        camera->width = (quick ? 60 : 250) * (int32_t)(i + 2);
        camera->height = quick ? 200 : 900;
        lay_out(&wanted[i], camera, which, i % 2 ? FXS_FORMAT_RGBA16_COVERAGE : FXS_FORMAT_RGBA8, 0);
        fill_in(&wanted[i], camera);
        CHECK(wanted[i].bytes <= BATCH_BYTES);
        move_to(&there[i], &wanted[i], memory + (size_t)i * BATCH_BYTES);
        CHECK(!peek_copy(there[i].memory, wanted[i].memory, wanted[i].bytes));
        frames[i].objects = w.objects + i % 4;
        frames[i].count = 4 - i % 4;
        frames[i].targets = there[i].targets;
    }
    CHECK(!fxs_cuda_render(batch, frames, BATCH_FRAMES, &options, 0, &why) && !fxs_cuda_finish(batch, 0, &why));
    for (int i = 0; i < BATCH_FRAMES; i++) {
        pictures both[2];
        render_c(&frames[i], &options, &wanted[i].targets);
        both[0] = wanted[i];
        move_to(&both[1], &wanted[i], room(wanted[i].bytes));
        CHECK(!peek_copy(both[1].memory, there[i].memory, wanted[i].bytes));
        CHECK(pictures_equal(both, &frames[i].camera));
        free(both[1].memory);
        free(wanted[i].memory);
    }
    fxs_cuda_destroy(batch);
    world_free(&w);
}

static void test_batch(void)
{
    uint8_t *device = peek_device_memory((size_t)BATCH_FRAMES * BATCH_BYTES);
    uint8_t *pinned = peek_pinned_memory((size_t)BATCH_FRAMES * BATCH_BYTES);
    check_batch(device);
    check_batch(pinned);
    peek_device_free(device);
    peek_pinned_free(pinned);
}

/* Renders frames one after another on a stream without fxs_cuda_finish, and copies each picture in stream order. The
 * tile lists of the first frames do not fit. */
static void test_stream_order(void)
{
    enum { FRAMES = 6, WIDTH = 1100, HEIGHT = 900, BYTES = 4 * WIDTH * HEIGHT };
    uint8_t *device = peek_device_memory(BYTES), *pinned = peek_pinned_memory((size_t)FRAMES * BYTES);
    fxs_cuda *by;
    fxs_cuda_frame frames[FRAMES];
    fxs_cuda_stats stats = {0};
    fxs_options options;
    world w;
    state = 5;
    random_world(&w, 3, 3000);
    fxs_options_init(&options);
    if (!CHECK(device && pinned && !fxs_cuda_create(&by, 0, 0, 1, &why)))
        return;
    for (int i = 0; i < FRAMES; i++) {
        random_camera(&frames[i].camera);
        enlarge(&frames[i].camera, 9);
        frames[i].camera.width = WIDTH;
        frames[i].camera.height = HEIGHT - i;
        frames[i].objects = w.objects;
        frames[i].count = w.count;
        frames[i].targets = (fxs_targets){.colour = {device, 4 * WIDTH}};
        CHECK(!fxs_cuda_render(by, &frames[i], 1, &options, 0, &why));
        CHECK(!peek_copy_after(pinned + (size_t)i * BYTES, device, BYTES));
    }
    CHECK(!fxs_cuda_finish(by, &stats, &why) && fxs_cuda_finish(by, 0, &why) == FXS_ERR_ARGUMENT);
    CHECK(!peek_copy(device, pinned, 1));      /* waits for the copies */
    for (int i = 0; i < FRAMES; i++) {
        uint8_t *pixels = room(BYTES);
        fxs_targets targets;
        fxs_targets_init(&targets);
        targets.colour = (fxs_image){pixels, 4 * WIDTH};
        render_c(&frames[i], &options, &targets);
        CHECK(!memcmp(pixels, pinned + (size_t)i * BYTES, (size_t)(HEIGHT - i) * 4 * WIDTH));
        free(pixels);
    }
    CHECK(stats.memory.entries / 8 > 2 * stats.gaussians + 65536 && stats.memory.entries / 8 >= stats.entries);
    fxs_cuda_destroy(by);
    peek_device_free(device);
    peek_pinned_free(pinned);
    world_free(&w);
}

/* ---- Moving scenes ----------------------------------------------------------------------------------------------- */

enum { MOVING = 2, MOVING_OBJECTS = 5, MOVING_FRAMES = 5 };

/* Two moving scenes, the second mostly with a level-of-detail tree, a still one and one with a tree. The first scene is
   that of two objects. */
typedef struct moving_world {
    unsigned char *data[MOVING];
    fxs_scene scenes[MOVING];
    packed_scene still, tree;
    fxs_object objects[MOVING_OBJECTS];
    fxs_crop crops[MOVING_OBJECTS][CROPS];
    uint32_t count, chunks;
} moving_world;

/* A time within or near a scene's duration; one in eight is any number. */
static int64_t random_time_q32(void)
{
    return between(0, 7) ? (int64_t)between(-(1 << 17), 9 << 16) * 65536 : (int64_t)next();
}

static void random_moving(moving_world *w, int i, int32_t most)
{
    for (int k = 0; k < MOVING; k++) {
        size_t bytes;
        const enum fxs_profile profile = (enum fxs_profile)((i + k) % 3);
        packed_scene still = k && i % 3 ? random_tree(profile, (uint32_t)between(2, 12), 0, 0)
                                        : random_scene(profile, most);
        w->data[k] = make_moving(&still.scene, (uint32_t)((i / 3 + k) % 4), (uint32_t)between(0, 7), next(), &bytes);
        if (fxs_scene_open(&w->scenes[k], w->data[k], bytes))
            abort();
        free(still.data);
    }
    w->still = random_scene(FXS_PROFILE_COMPACT, 1000);
    w->tree = random_tree(FXS_PROFILE_SMALL, 12, 0, 0);
    const fxs_scene *const scenes[MOVING_OBJECTS] = {&w->scenes[0], &w->scenes[1], &w->scenes[0], &w->still.scene,
                                                     &w->tree.scene};
    w->count = i % 4 ? (uint32_t)between(1, MOVING_OBJECTS) : 1;
    w->chunks = 0;
    for (uint32_t k = 0; k < w->count; k++) {
        w->objects[k] = one_object(scenes[k]);
        if (k && between(0, 1))
            random_object(&w->objects[k], w->crops[k]);
        w->objects[k].time_q32 = random_time_q32();
        w->chunks += scenes[k]->chunk_count;
    }
}

static void forget_moving(moving_world *w, fxs_cuda *by)
{
    for (int k = 0; k < MOVING; k++)
        fxs_cuda_forget(by, &w->scenes[k]);
    fxs_cuda_forget(by, &w->still.scene);
    fxs_cuda_forget(by, &w->tree.scene);
}

static void moving_free(moving_world *w)
{
    for (int k = 0; k < MOVING; k++)
        free(w->data[k]);
    free(w->still.data);
    free(w->tree.data);
}

static void test_moving(void)
{
    for (int i = 0; i < (quick ? 12 : 200); i++) {
        moving_world w;
        fxs_camera cameras[2];
        fxs_options options;
        int by_device;
        state = (uint64_t)i * 0x3579bd1u + 23;
        random_moving(&w, i, i % 8 == 3 && !quick ? 20000 : 3000);
        random_cut(cameras, &options, w.chunks);
        random_other_eye(cameras);
        options.time_q32 = random_time_q32();
        const int good = CHECK(cut_frame_equal(w.objects, w.count, cameras, 1 + (uint32_t)i % 2, &options,
                                               &by_device) && !by_device);
        forget_moving(&w, cuda);
        moving_free(&w);
        if (!good) {
            printf("  case %d\n", i);
            return;
        }
    }
}

/* Draws a batch of frames of the same objects at different times, with all targets. Returns the error. */
static int draw_moments(fxs_cuda *by, const moving_world *w, const fxs_options *options, fxs_cuda_stats *stats)
{
    pictures p[MOVING_FRAMES][2];
    fxs_cuda_frame frames[MOVING_FRAMES];
    fxs_object objects[MOVING_FRAMES][MOVING_OBJECTS];
    for (uint32_t i = 0; i < MOVING_FRAMES; i++) {
        memcpy(objects[i], w->objects, sizeof objects[i]);
        for (uint32_t k = 0; k < w->count; k++)
            objects[i][k].time_q32 = random_time_q32();
        random_camera(&frames[i].camera);
        twice(p[i], &frames[i].camera, i % 2 ? COLOUR | BACKDROP : COLOUR | MEAN | MEDIAN | ID | OCCLUDER,
              FXS_FORMAT_RGBA8, 0);
        frames[i].objects = objects[i];
        frames[i].count = w->count;
        frames[i].targets = p[i][1].targets;
        render_c(&frames[i], options, &p[i][0].targets);
    }
    const int error = fxs_cuda_render_host(by, frames, MOVING_FRAMES, options, stats, &why);
    for (int i = 0; i < MOVING_FRAMES; i++) {
        CHECK(error || pictures_equal(p[i], &frames[i].camera));
        free(p[i][0].memory);
        free(p[i][1].memory);
    }
    return error;
}

static void test_moments(void)
{
    enum { SLOTS = 3 };
    fxs_cuda *by;
    if (!CHECK(!fxs_cuda_create(&by, 0, 0, SLOTS, &why)))
        return;
    for (int i = 0; i < (quick ? 4 : 24); i++) {
        moving_world w;
        fxs_options options;
        state = (uint64_t)i * 0x1122335u + 41;
        random_moving(&w, i, 3000);
        random_options(&options);
        options.time_q32 = random_time_q32();
        CHECK(!draw_moments(by, &w, &options, 0));
        forget_moving(&w, by);
        moving_free(&w);
    }
    fxs_cuda_destroy(by);
}

/* Of a moving scene that does not fit into the memory allowed, the device keeps a part. */
static void test_moving_pool(void)
{
    moving_world w;
    fxs_options options;
    fxs_cuda_stats stats = {0};
    uint64_t least = 1000;
    int error = FXS_ERR_MEMORY;
    state = 4;
    random_moving(&w, 4, 30000);
    fxs_options_init(&options);
    for (int tries = 0; tries < 20 && error == FXS_ERR_MEMORY; tries++) {
        fxs_cuda *by;
        if (!CHECK(!fxs_cuda_create(&by, 0, least, 2, &why)))
            return;
        error = draw_moments(by, &w, &options, &stats);
        fxs_cuda_destroy(by);
        if (error && CHECK(why.bytes_needed > least))
            least = why.bytes_needed;
    }
    CHECK(!error && stats.memory.scenes < w.scenes[0].chunk_count * (uint64_t)w.scenes[0].chunk_bytes);
    moving_free(&w);
}

/* A moving scene in parts: after some frames, the device has all chunks that are alive. */
static void test_moving_parts(void)
{
    moving_world w;
    fxs_options options;
    state = 6;
    random_moving(&w, 4, 30000);
    fxs_scene part = w.scenes[0];
    uint32_t *places = room(part.chunk_count * sizeof *places);
    for (uint32_t i = 0; i < part.chunk_count; i++)
        places[i] = i;
    part.places = places;
    const fxs_object object = one_object(&part), whole = one_object(&w.scenes[0]);
    fxs_options_init(&options);
    for (int i = 0; i < 5; i++) {
        pictures p[2];
        fxs_camera camera;
        fxs_cuda_stats stats = {.missing = 1};
        random_camera(&camera);
        options.time_q32 = random_time_q32();
        twice(p, &camera, COLOUR | ID, FXS_FORMAT_RGBA8, 0);
        const fxs_cuda_frame shown = {camera, &whole, 1, p[0].targets}, frame = {camera, &object, 1, p[1].targets};
        render_c(&shown, &options, &p[0].targets);
        for (int tries = 0; tries < 9 && stats.missing; tries++)
            CHECK(!fxs_cuda_render_host(cuda, &frame, 1, &options, &stats, &why));
        CHECK(!stats.missing && pictures_equal(p, &camera));
        free(p[0].memory);
        free(p[1].memory);
    }
    fxs_cuda_forget(cuda, &part);
    free(places);
    moving_free(&w);
}

/* The bytes of a mapped scene may change after it was opened. */
static void test_changed_motion(void)
{
    moving_world w;
    fxs_camera camera;
    fxs_options options;
    uint8_t pixels[4 * 100 * 80];
    state = 12;
    random_moving(&w, 0, 3000);
    random_camera(&camera);
    fxs_options_init(&options);
    unsigned char *table = w.data[0] + (w.scenes[0].motion - w.data[0]);
    fxs_motion_header kept, changed;
    memcpy(&kept, table, sizeof kept);
    const fxs_cuda_frame frame = {camera, w.objects, 1, {.colour = {pixels, camera.width * 4}}};
    CHECK(!fxs_cuda_render_host(cuda, &frame, 1, &options, 0, &why));
    changed = kept;
    changed.degree ^= 1;
    memcpy(table, &changed, sizeof changed);
    CHECK(fxs_cuda_render_host(cuda, &frame, 1, &options, 0, &why) == FXS_ERR_SCENE);
    changed = kept;
    changed.most_chunks = 1;
    memcpy(table, &changed, sizeof changed);
    for (uint32_t i = 0; i < w.scenes[0].chunk_count; i++)
        memcpy(table + sizeof kept + i * sizeof(fxs_chunk_motion), &(fxs_chunk_motion){0, INT32_MAX, 0, 16, 0, 0},
               sizeof(fxs_chunk_motion));
    CHECK(w.scenes[0].chunk_count > 1);
    CHECK(fxs_cuda_render_host(cuda, &frame, 1, &options, 0, &why) == FXS_ERR_SCENE);
    memcpy(table, &kept, sizeof kept);
    forget_moving(&w, cuda);
    moving_free(&w);
}

/* ---- Scenes, memory and errors ----------------------------------------------------------------------------------- */

static int draw(fxs_cuda *by, const fxs_scene *scene, const fxs_camera *camera, fxs_cuda_stats *stats)
{
    fxs_object object;
    fxs_options options;
    uint8_t *pixels = room((size_t)camera->width * (size_t)camera->height * 4);
    const fxs_cuda_frame frame = {*camera, &object, 1, {.colour = {pixels, camera->width * 4}}};
    fxs_object_init(&object, scene);
    fxs_options_init(&options);
    const int error = fxs_cuda_render_host(by, &frame, 1, &options, stats, &why);
    free(pixels);
    return error;
}

static void check_long_lists(int count)
{
    uint64_t most = 0;
    for (int i = 0; i < count; i++) {
        fxs_object object;
        fxs_scene scene;
        fxs_camera camera;
        fxs_options options;
        fxs_cuda_stats stats = {0};
        state = (uint64_t)i + 71;
        packed_scene packed = random_scene(FXS_PROFILE_DEFAULT, 120000);
        random_camera(&camera);
        camera.width = between(9, 40);
        camera.height = between(9, 40);
        camera.fx_q12 = camera.fy_q12 = between(4 << 12, 20 << 12);
        camera.cx_q12 = camera.width * 2048;
        camera.cy_q12 = camera.height * 2048;
        fxs_options_init(&options);
        fxs_scene_open(&scene, packed.data, packed.bytes);
        fxs_object_init(&object, &scene);
        CHECK(scene_equal(&scene, &camera, &options) && !draw(cuda, &scene, &camera, &stats));
        CHECK(frame_equal(&object, 1, &camera, &options, COLOUR | MEAN | MEDIAN | ID | (i % 2 ? OCCLUDER : 0),
                          FXS_FORMAT_RGBA8, 0));
        for (uint64_t split = 0; split < stats.entries; split = 3 * split + stats.entries / 20) {
            peek_limit_room(cuda, stats.entries, split, 0);
            CHECK(frame_equal(&object, 1, &camera, &options, COLOUR, FXS_FORMAT_RGBA8, 0));
            CHECK(frame_equal(&object, 1, &camera, &options, COLOUR | ID, FXS_FORMAT_RGBA8, 0));
        }
        for (uint64_t entries = stats.entries - 1; entries; entries /= 300) {
            peek_limit_room(cuda, entries, 0, 0);
            CHECK(frame_equal(&object, 1, &camera, &options, COLOUR, FXS_FORMAT_RGBA8, 0));
            CHECK(frame_equal(&object, 1, &camera, &options, COLOUR | ID, FXS_FORMAT_RGBA8, 0));
        }
        peek_limit_room(cuda, 0, 0, 0);
        const uint64_t each = stats.entries / (uint64_t)((camera.width + 15) / 16 * ((camera.height + 15) / 16));
        most = each > most ? each : most;
        fxs_cuda_forget(cuda, &scene);
        free(packed.data);
    }
    CHECK(most >= 8192);
}

static void test_long_lists(void)
{
    check_long_lists(cases(12));
}

static void test_small_blocks(void)
{
    fxs_cuda *const whole = cuda;
    if (CHECK(!fxs_cuda_create(&cuda, 0, 0, 1, &why)) && CHECK(!peek_fit_blocks(cuda, 99 << 10, &why))) {
        check_random(FXS_PROFILE_DEFAULT, cases(60));
        check_objects(cases(30), 4, 20000);
        check_long_lists(cases(4));
    }
    CHECK(peek_fit_blocks(cuda, 48 << 10, &why) == FXS_ERR_UNSUPPORTED);
    fxs_cuda_destroy(cuda);
    cuda = whole;
}

/* Frames whose tile lists do not fit: room for one entry, for few entries, or for one large splat. */
static void test_overflow(void)
{
    static const struct { uint64_t entries; uint32_t larges; } rooms[] = {{1, 0}, {500, 0}, {0, 1}};
    for (int i = 0; i < 3; i++) {
        const int before = overflows;
        peek_limit_room(cuda, rooms[i].entries, 0, rooms[i].larges);
        for (int profile = 0; profile < 3; profile++)
            check_random((enum fxs_profile)profile, cases(40));
        check_objects(cases(60), 5, 2000);
        check_objects(1, OBJECTS, quick ? 600 : 3000);
        test_targets();
        test_cut();
        test_moving();
        CHECK(overflows - before > (quick ? 5 : 60));
        printf("  %d overflows\n", overflows - before);
    }
    peek_limit_room(cuda, 0, 0, 0);
}

static void test_scenes(void)
{
    fxs_cuda *other;
    world w;
    fxs_cuda_stats stats = {0};
    fxs_camera camera;
    fxs_options options;
    state = 21;
    random_world(&w, 0, 3000);
    random_camera(&camera);
    fxs_options_init(&options);
    CHECK(!fxs_cuda_create(&other, 0, 0, 2, &why));
    fxs_cuda_forget(other, &w.scenes[0]);
    for (int times = 0; times < 2; times++)
        for (int i = 0; i < SCENES; i++)
            CHECK(!fxs_cuda_upload(other, &w.scenes[i], &why) && !draw(other, &w.scenes[i], &camera, &stats));
    uint64_t bytes = 0;
    for (int i = 0; i < SCENES; i++)
        bytes += (uint64_t)(w.scenes[i].rows - w.scenes[i].chunks) +
                 (uint64_t)w.scenes[i].chunk_count * w.scenes[i].chunk_bytes;
    CHECK(stats.memory.scenes == bytes);
    fxs_cuda_forget(other, &w.scenes[0]);
    CHECK(!draw(other, &w.scenes[1], &camera, &stats) && stats.memory.scenes < bytes);
    fxs_cuda_destroy(other);

    CHECK(scene_equal(&w.scenes[0], &camera, &options));
    for (uint32_t c = 0; c < w.scenes[0].chunk_count; c++)
        w.packed[0].chunks[c].colour_q16[0] ^= 0x3fff;
    fxs_cuda_forget(cuda, &w.scenes[0]);
    CHECK(scene_equal(&w.scenes[0], &camera, &options));
    w.scenes[0] = w.scenes[1];
    CHECK(scene_equal(&w.scenes[0], &camera, &options) && scene_equal(&w.scenes[1], &camera, &options));
    world_free(&w);
}

/* A frame with too little device memory must fail and report the bytes that it needs. With them it renders. */
static void test_memory(void)
{
    fxs_cuda *small;
    fxs_scene scene;
    fxs_camera camera;
    fxs_cuda_stats stats = {0};
    state = 11;
    packed_scene packed = random_scene(FXS_PROFILE_DEFAULT, 3000);
    random_camera(&camera);
    fxs_scene_open(&scene, packed.data, packed.bytes);
    uint64_t needed = 1000;
    for (int tries = 0; tries < 8; tries++) {
        if (!CHECK(!fxs_cuda_create(&small, 0, needed, 1, &why)))
            break;
        const int error = draw(small, &scene, &camera, &stats);
        fxs_cuda_destroy(small);
        if (!error)
            break;
        if (!CHECK(error == FXS_ERR_MEMORY && why.bytes_needed > needed))
            break;
        needed = why.bytes_needed;
    }
    CHECK(needed > 1000 && needed < 8000000 && stats.memory.total && stats.memory.total <= needed);

    CHECK(!fxs_cuda_create(&small, 0, stats.memory.total, 1, &why));
    for (int i = 0; i < 3; i++) {
        CHECK(!draw(small, &scene, &camera, &stats));
        if (i)
            fxs_cuda_forget(small, &scene);
    }
    fxs_cuda_destroy(small);
    free(packed.data);
}

static int render_error(const fxs_cuda_frame *frames, uint32_t count)
{
    fxs_options options;
    fxs_options_init(&options);
    const int error = fxs_cuda_render(cuda, frames, count, &options, 0, &why);
    CHECK(fxs_cuda_finish(cuda, 0, &why) == FXS_ERR_ARGUMENT);
    return error;
}

static void test_errors(void)
{
    fxs_cuda *none;
    fxs_scene scene;
    fxs_object object;
    fxs_camera camera;
    fxs_options options;
    state = 3;
    fxs_options_init(&options);
    random_camera(&camera);
    packed_scene packed = random_scene(FXS_PROFILE_DEFAULT, 3000);
    fxs_scene_open(&scene, packed.data, packed.bytes);
    fxs_object_init(&object, &scene);
    uint8_t *device = peek_device_memory((size_t)camera.width * (size_t)camera.height * 4 + 4);
    const fxs_cuda_frame good = {camera, &object, 1, {.colour = {device, camera.width * 4}}};
    fxs_cuda_frame frames[2] = {good, good};
    frames[0].targets.colour.pixels = 0;
    CHECK(render_error(frames, 1) == FXS_ERR_TARGET);
    frames[0].targets.colour.pixels = device + 1;
    CHECK(render_error(frames, 1) == FXS_ERR_TARGET);
    frames[0].targets.colour = (fxs_image){device, 4 - camera.width * 4};
    CHECK(camera.height == 1 || render_error(frames, 1) == FXS_ERR_TARGET);
    frames[0] = good;
    frames[0].targets.id = good.targets.colour;
    CHECK(render_error(frames, 1) == FXS_ERR_TARGET);
    frames[0] = good;
    frames[1].camera.width = 0;
    CHECK(render_error(frames, 2) == FXS_ERR_SIZE);
    frames[1] = good;
    frames[1].camera.fx_q12 = 0;
    CHECK(render_error(frames, 2) == FXS_ERR_CAMERA);
    CHECK(render_error(frames, 0) == FXS_ERR_ARGUMENT && render_error(0, 1) == FXS_ERR_ARGUMENT);
    object.rotation_q30[0] = 0;
    CHECK(render_error(&good, 1) == FXS_ERR_OBJECT);
    fxs_object_init(&object, &scene);
    object.scale_q32 = 1 << 16;
    object.translation_q32[0] = (int64_t)1 << 50;
    CHECK(render_error(&good, 1) == FXS_ERR_OBJECT);
    object.scene = 0;
    CHECK(render_error(&good, 1) == FXS_ERR_ARGUMENT);
    fxs_object_init(&object, &scene);
    peek_device_free(device);
    CHECK(fxs_cuda_create(&none, 1000, 0, 1, &why) == FXS_ERR_DEVICE && !none);
    CHECK(fxs_cuda_create(&none, 0, 0, 17, &why) == FXS_ERR_ARGUMENT && !none);
    CHECK(scene_equal(&scene, &camera, &options));

    /* A chunk (256 Gaussians) whose header is damaged after opening causes an error only if its object is visible. */
    packed.chunks[scene.chunk_count / 2].step_shift = 63;
    fxs_cuda_forget(cuda, &scene);
    CHECK(draw(cuda, &scene, &camera, 0) == FXS_ERR_SCENE);
    object.visible = 0;
    CHECK(frame_equal(&object, 1, &camera, &options, COLOUR | ID, FXS_FORMAT_RGBA8, 0));
    packed.chunks[scene.chunk_count / 2].step_shift = 0;
    fxs_cuda_forget(cuda, &scene);
    CHECK(scene_equal(&scene, &camera, &options));

    CHECK(frame_equal(0, 0, &camera, &options, COLOUR | COVERAGE | MEAN | MEDIAN | ID, FXS_FORMAT_RGBA8, 0));
    scene.chunk_count = scene.count = 0;
    scene.rows = scene.chunks;
    CHECK(scene_equal(&scene, &camera, &options));
    fxs_cuda_forget(cuda, &scene);
    free(packed.data);
}

static int stop_third(void *times)
{
    return ++*(int *)times == 3;
}

static void test_stopped(void)
{
    world w;
    fxs_camera camera;
    fxs_options options;
    int times = 0;
    state = 8;
    random_world(&w, 4, 2000);
    random_camera(&camera);
    fxs_options_init(&options);
    uint8_t *device = peek_device_memory(4 * (size_t)camera.width * (size_t)camera.height * 4);
    fxs_cuda_frame frames[4];
    for (int i = 0; i < 4; i++)
        frames[i] = (fxs_cuda_frame){camera, &w.objects[i], 1, {.colour = {
            device + (size_t)i * (size_t)camera.width * (size_t)camera.height * 4, camera.width * 4}}};
    options.stop.call = stop_third;
    options.stop.argument = &times;
    CHECK(fxs_cuda_render(cuda, frames, 4, &options, 0, &why) == FXS_ERR_STOPPED && times == 3);
    CHECK(!strcmp(why.text, fxs_strerror(FXS_ERR_STOPPED)) &&
          fxs_cuda_finish(cuda, 0, &why) == FXS_ERR_ARGUMENT);
    CHECK(!fxs_cuda_render(cuda, frames, 4, &options, 0, &why) && !fxs_cuda_finish(cuda, 0, &why) && times >= 7);
    options.stop.call = 0;
    CHECK(frame_equal(w.objects, 4, &camera, &options, COLOUR | ID, FXS_FORMAT_RGBA8, 0));
    peek_device_free(device);
    world_free(&w);
}

static void test_in_place(void)
{
    fxs_scene scene;
    fxs_object object;
    fxs_camera camera;
    fxs_options options;
    pictures p[2];
    state = 8;
    packed_scene packed = random_scene(FXS_PROFILE_DEFAULT, 3000);
    fxs_scene_open(&scene, packed.data, packed.bytes);
    fxs_object_init(&object, &scene);
    random_camera(&camera);
    fxs_options_init(&options);
    twice(p, &camera, COLOUR | ID, FXS_FORMAT_RGBA8, 0);
    p[0].targets.backdrop = p[0].targets.colour;
    p[1].targets.backdrop = p[1].targets.colour;
    const fxs_cuda_frame frame = {camera, &object, 1, p[1].targets};
    render_c(&frame, &options, &p[0].targets);
    CHECK(!fxs_cuda_render_host(cuda, &frame, 1, &options, 0, &why) && pictures_equal(p, &camera));
    fxs_cuda_forget(cuda, &scene);
    free(p[0].memory);
    free(p[1].memory);
    free(packed.data);
}

/* ---- Stereo ------------------------------------------------------------------------------------------------------ */

static void test_table(void)
{
    const fxs_backend *b = &fxs_backend_cuda;
    const fxs_backend_options settings = {.size = sizeof(fxs_backend_options)};
    void *self;
    char name[64];
    world w;
    fxs_camera cameras[2];
    fxs_options options;
    fxs_targets targets[2];
    pictures p[2][2];
    fxs_request request;
    fxs_stats stats, wanted;
    state = 31;
    random_world(&w, 3, 2000);
    random_camera(&cameras[0]);
    cameras[1] = cameras[0];
    cameras[1].position_q32[0] += (int64_t)1 << 27;
    fxs_options_init(&options);
    if (!CHECK(!b->device(0, name, sizeof name, &why) && name[0] && !b->open(&self, &settings, &why)))
        return;
    for (int eye = 0; eye < 2; eye++)
        twice(p[eye], &cameras[0], COLOUR | MEDIAN, FXS_FORMAT_RGBA8, 0);
    fxs_cuda_frame frames[2];
    for (int eye = 0; eye < 2; eye++) {
        frames[eye] = (fxs_cuda_frame){cameras[eye], w.objects, w.count, p[eye][0].targets};
        targets[eye] = p[eye][0].targets;
    }
    CHECK(!render_eyes_c(frames, 2, &options, targets, &wanted));
    for (int eye = 0; eye < 2; eye++)
        targets[eye] = p[eye][1].targets;
    request = request_for(w.objects, w.count, &options, 2, cameras, targets);
    CHECK(!b->render(self, &request, &stats, &why) && stats.frame_nanoseconds && b->nanoseconds(self));
    CHECK(stats.visible == wanted.visible && stats.entries == wanted.entries && stats.bands == wanted.bands &&
          stats.gaussians == wanted.gaussians);
    uint64_t sum = 0;
    for (int stage = 0; stage < FXS_STAGES; stage++)
        sum += stats.nanoseconds[stage];
    CHECK(sum <= b->nanoseconds(self) && sum + 10 > b->nanoseconds(self));
    for (int eye = 0; eye < 2; eye++)
        CHECK(pictures_equal(p[eye], &cameras[0]));
    for (int i = 0; i < 2; i++)
        memset(p[0][i].memory, 0, p[0][i].bytes);
    const fxs_cuda_frame left = {cameras[0], w.objects, w.count, p[0][0].targets};
    render_c(&left, &options, &p[0][0].targets);
    request.eyes = 1;
    CHECK(!b->render(self, &request, 0, &why) && pictures_equal(p[0], &cameras[0]));
    request.eyes = 2;
    request.cameras[1].width++;
    CHECK(b->render(self, &request, 0, &why) == FXS_ERR_SIZE);
    request.cameras[1].width--;
    request.targets[1] = request.targets[0];
    CHECK(b->render(self, &request, 0, &why) == FXS_ERR_TARGET);
    fxs_cuda_stereo(cuda, 1);
    CHECK(fxs_cuda_render_host(cuda, &left, 1, &options, 0, &why) == FXS_ERR_ARGUMENT);
    fxs_cuda_stereo(cuda, 0);
    for (int i = 0; i < SCENES; i++)
        b->forget(self, &w.scenes[i]);
    b->close(self);
    b->close(0);
    for (int eye = 0; eye < 2; eye++) {
        free(p[eye][0].memory);
        free(p[eye][1].memory);
    }
    world_free(&w);
}

int main(int argc, char **argv)
{
    quick = argc > 1 && !strcmp(argv[1], "--quick");
    files = argv + 1 + quick;
    file_count = argc - 1 - quick;
    if (fxs_cuda_create(&cuda, 0, 0, 1, &why)) {
        printf("no CUDA device: %s\n", why.text);
        return 1;
    }
    if (!quick)
        RUN(test_levels);
    RUN(test_default);
    RUN(test_compact);
    RUN(test_small);
    RUN(test_objects);
    RUN(test_hundred_objects);
    RUN(test_targets);
    RUN(test_cut);
    RUN(test_equal_keys);
    RUN(test_pool);
    RUN(test_parts);
    RUN(test_small_pool);
    RUN(test_parts_in_flight);
    RUN(test_table_parts);
    RUN(test_small_blocks);
    RUN(test_batch);
    RUN(test_stream_order);
    RUN(test_moving);
    RUN(test_moments);
    RUN(test_moving_pool);
    RUN(test_moving_parts);
    RUN(test_changed_motion);
    RUN(test_long_lists);
    RUN(test_overflow);
    RUN(test_scenes);
    RUN(test_memory);
    RUN(test_errors);
    RUN(test_stopped);
    RUN(test_in_place);
    RUN(test_table);
    RUN(test_files);
    fxs_cuda_destroy(cuda);
    return check_report();
}
