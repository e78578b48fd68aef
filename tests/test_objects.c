/* Compares frames of several placed objects with the reference renderer of the merged scene. Some frames must
   have the bytes of a frame of a single scene. */
#include <fixsplat/system.h>
#include <fixsplat/internal/parts.h>
#include "one_scene.h"
#include "random_scene.h"
#include "random_world.h"

#define FLOOR 54.0                 /* minimum PSNR in dB of a frame against the reference renderer */
enum { WIDTH = 400, HEIGHT = 260 };

static const double up[3] = {0, -1, 0}, y_axis[3] = {0, 1, 0};

static fxs_camera look(const double eye[3], const double target[3], double fov)
{
    fxs_message m;
    fxs_view view;
    fxs_camera camera;
    CHECK(!fxs_view_look_at(&view, eye, target, up, &(fxs_picture){fov, WIDTH, HEIGHT}, &m) &&
          !fxs_camera_from_view(&camera, &view, &m));
    return camera;
}

static void check_against_reference(const char *name, const world *w, const fxs_camera *camera, double least)
{
    fxs_context context;
    fxs_options options;
    double drawn;
    picture p = picture_new(camera->width, camera->height, FXS_FORMAT_RGBA8);
    fxs_context_init(&context, 0);
    fxs_options_init(&options);
    options.background[2] = 60;
    CHECK(!world_render(&context, w, camera, &options, &p.targets, 0));
    reference_world r = world_reference(w, camera, &options, 0);
    const double psnr = world_psnr(&p, &r, &drawn);
    printf("  %s: %.1f dB, %.0f %% covered\n", name, psnr, 100 * drawn);
    CHECK(psnr >= FLOOR && drawn >= least);
    reference_world_free(&r);
    picture_free(&p);
}

static void two_knots(world *w, const part *p)
{
    memset(w, 0, sizeof *w);
    object_place(world_add(w, p), y_axis, 0.4, 1, (const double[3]){-1.2, 0, 0});
    object_place(world_add(w, p), (const double[3]){1, 0.3, -0.2}, 1.4, 0.83, (const double[3]){1.7, -0.4, 0.6});
}

static const double front[3] = {0.9, -3, -11}, middle[3] = {0, 0, 0};

static void test_two_knots(void)
{
    part knot;
    world w;
    if (!part_make(&knot, "knot", 40000))
        return;
    two_knots(&w, &knot);
    const fxs_camera camera = look(front, middle, 45), close = look((const double[3]){0.4, -0.8, -3.5}, middle, 60);
    check_against_reference("two knots", &w, &camera, 0.2);
    check_against_reference("two knots, close", &w, &close, 0.5);
    part_free(&knot);
}

static void test_orthographic(void)
{
    part knot;
    world w;
    if (!part_make(&knot, "knot", 40000))
        return;
    two_knots(&w, &knot);
    fxs_camera camera = look(front, middle, 45);
    camera.projection = FXS_ORTHOGRAPHIC;
    for (int i = 0; i < 3; i++) {
        static const int pixels[] = {24, 60, 200};
        char name[40];
        camera.fx_q12 = pixels[i] << 12;
        camera.fy_q12 = (pixels[i] << 12) + 3000;
        camera.cx_q12 += i * 20000;
        snprintf(name, sizeof name, "%d pixels a unit", pixels[i]);
        check_against_reference(name, &w, &camera, 0.1);
    }
    part_free(&knot);
}

static void test_tint_and_opacity(void)
{
    part knot;
    world w;
    if (!part_make(&knot, "knot", 30000))
        return;
    two_knots(&w, &knot);
    w.objects[0].opacity_q16 = 30000;
    w.objects[0].tint_q13[0] = 2000;
    w.objects[1].tint_q13[1] = 12000;
    w.objects[1].tint_q13[2] = 0;
    fxs_camera camera = look(front, middle, 45);
    check_against_reference("tint and opacity", &w, &camera, 0.1);
    w.objects[0].opacity_q16 = 300;
    w.objects[1].opacity_q16 = 9000;
    check_against_reference("nearly clear", &w, &camera, 0);
    part_free(&knot);
}

static fxs_crop crop_of(double low, double high, int axis, int outside)
{
    fxs_crop crop = {{-(INT64_C(1) << 50), -(INT64_C(1) << 50), -(INT64_C(1) << 50)},
                     {INT64_C(1) << 50, INT64_C(1) << 50, INT64_C(1) << 50}, outside};
    crop.low_q32[axis] = (int64_t)ldexp(low, 32);
    crop.high_q32[axis] = (int64_t)ldexp(high, 32);
    return crop;
}

static void test_crops(void)
{
    part knot;
    world w;
    const fxs_crop keep[3] = {crop_of(-9, -0.3, 0, 0), crop_of(1, 9, 2, 0), crop_of(-1, 0.4, 1, 1)};
    const fxs_crop out[2] = {crop_of(-0.7, 0.9, 0, 1), crop_of(-0.5, 0.5, 2, 1)};
    if (!part_make(&knot, "knot", 40000))
        return;
    part_unpack(&knot);
    two_knots(&w, &knot);
    w.objects[0].crops = keep;
    w.objects[0].crop_count = 3;
    w.objects[1].crops = out;
    w.objects[1].crop_count = 2;
    fxs_camera camera = look(front, middle, 45);
    check_against_reference("crops", &w, &camera, 0.05);
    part_free(&knot);
}

static void test_hundred_objects(void)
{
    part knot, cubes;
    world w = {.count = 0};
    if (!part_make(&knot, "knot", 10000) || !part_make(&cubes, "cubes", 4096))
        return;
    state = 7;
    for (int i = 0; i < 100; i++) {
        const double axis[3] = {between(-99, 99), between(-99, 99), 100};
        const double at[3] = {1.8 * (i % 10) - 8.1, 1.4 * (i / 10) - 6.3, between(-300, 300) / 100.0};
        fxs_object *object = world_add(&w, i % 3 ? &knot : &cubes);
        object_place(object, axis, between(0, 628) / 100.0, i % 3 ? 0.2 : 0.12, at);
        object->tint_q13[i % 3] = (uint32_t)between(4000, 9000);
    }
    fxs_camera camera = look((const double[3]){0, -4, -19}, middle, 45);
    check_against_reference("a hundred objects", &w, &camera, 0.2);
    part_free(&knot);
    part_free(&cubes);
}

static fxs_camera carried(const fxs_view *view, const fxs_object *object)
{
    fxs_message m;
    fxs_camera camera;
    fxs_view out = *view;
    const struct reference_object o = object_in_doubles(object);
    for (int i = 0; i < 3; i++) {
        out.position[i] = o.translation[i];
        for (int k = 0; k < 3; k++) {
            out.position[i] += o.scale * o.rotation[3 * i + k] * view->position[k];
            out.rotation[3 * k + i] = 0;
            for (int j = 0; j < 3; j++)
                out.rotation[3 * k + i] += view->rotation[3 * k + j] * o.rotation[3 * i + j];
        }
    }
    out.near = o.scale * (view->near > 0 ? view->near : 0.2);
    CHECK(!fxs_camera_from_view(&camera, &out, &m));
    return camera;
}

static void check_captured(const char *file, double least)
{
    part captured;
    world w = {.count = 0};
    fxs_message m;
    fxs_view view;
    if (!part_load(&captured, file)) {
        printf("  %s is not here\n", file);
        return;
    }
    fxs_object *object = world_add(&w, &captured);
    CHECK(!fxs_view_frame_box(&view, captured.report.inner_low, captured.report.inner_high, up,
                              &(fxs_picture){50, WIDTH, HEIGHT}, &m));
    object_place(object, (const double[3]){0.3, 1, -0.5}, 2.1, 7.3, (const double[3]){120, -35, 11});
    const fxs_camera camera = carried(&view, object);
    check_against_reference(file, &w, &camera, least);
    object_place(object, (const double[3]){1, -0.4, 0.1}, -0.9, 0.021, (const double[3]){-2, 0.3, 5});
    const fxs_camera small = carried(&view, object);
    check_against_reference(file, &w, &small, least);
    part_free(&captured);
}

static void test_captured_scenes(void)
{
    check_captured("snowmiku/snowmiku.ply", 0.1);
    check_captured("guitar/guitar.ply", 0.04);
    check_captured("luma-seal/luma-seal.ply", 0.1);
}

static fxs_context plain;

static packed_scene scenes[4];

static void make_scenes(void)
{
    for (int i = 0; i < 4; i++)
        scenes[i] = random_scene((enum fxs_profile)(i % 3), i ? 3000 : 12000);
}

static void free_scenes(void)
{
    for (int i = 0; i < 4; i++)
        free(scenes[i].data);
}

static int draw(const fxs_context *context, const fxs_object *objects, uint32_t count, const fxs_camera *camera,
                const fxs_options *options, size_t bytes, picture *p, fxs_stats *stats)
{
    bytes = bytes ? bytes : fxs_frame_bytes(context, objects, count, camera->width, camera->height, 0);
    unsigned char *memory = check_aligned(bytes + 64);
    memset(memory + bytes, WORLD_GUARD, 64);
    picture_clear(p);
    const int error = render_frame(context, objects, count, camera, options, &p->targets, memory, bytes, stats);
    for (int i = 0; i < 64; i++)
        CHECK(memory[bytes + (size_t)i] == WORLD_GUARD);
    free(memory);
    return error;
}

static int same_pictures(const picture *a, const picture *b)
{
    return a->bytes == b->bytes && !memcmp(a->block, b->block, a->bytes);
}

static const int turns[][9] = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, -1, 0, 1, 0, 0, 0, 0, 1}, {0, 0, 1, 1, 0, 0, 0, 1, 0},
                               {-1, 0, 0, 0, 0, 1, 0, 1, 0}, {0, 1, 0, 0, 0, -1, -1, 0, 0}};
enum { TURNS = sizeof turns / sizeof *turns };

/* Rotates an object by right angles, scales it by a power of two, and moves it. The camera moves along, so the
   picture must stay. */
static void carry_exactly(fxs_object *object, fxs_camera *camera, const int turn[9], int shift)
{
    const fxs_camera before = *camera;
    const int64_t near_q32 = before.near_q32 ? before.near_q32 : 858993459;
    object->scale_q32 = shift < 0 ? (INT64_C(1) << 32) >> -shift : (INT64_C(1) << 32) << shift;
    for (int i = 0; i < 9; i++)
        object->rotation_q30[i] = turn[i] * (1 << 30);
    for (int i = 0; i < 3; i++) {
        object->translation_q32[i] = (int64_t)between(-4194304, 4194304) * 4096;
        int64_t p = 0;
        for (int k = 0; k < 3; k++) {
            const int64_t step = turn[3 * i + k] * before.position_q32[k];
            p += shift < 0 ? step / (1 << -shift) : step * (1 << shift);
            camera->rotation_q30[3 * k + i] = 0;
            for (int j = 0; j < 3; j++)
                camera->rotation_q30[3 * k + i] += before.rotation_q30[3 * k + j] * turn[3 * i + j];
        }
        camera->position_q32[i] = object->translation_q32[i] + p;
    }
    camera->near_q32 = shift < 0 ? near_q32 / (1 << -shift) : near_q32 * (1 << shift);
    if (camera->projection == FXS_ORTHOGRAPHIC) {
        camera->fx_q12 = shift < 0 ? before.fx_q12 * (1 << -shift) : before.fx_q12 >> shift;
        camera->fy_q12 = shift < 0 ? before.fy_q12 * (1 << -shift) : before.fy_q12 >> shift;
    }
}

/* Moves an object and the camera alike, which must not change the picture. Depths grow with the object's scale,
   so the frame has fewer depth bits. */
static void test_carried_with_the_camera(void)
{
    int drawn = 0;
    state = 11;
    for (int i = 0; i < 120; i++) {
        fxs_camera camera;
        fxs_options options;
        fxs_stats stats;
        const int shift = between(-4, 4);
        make_scenes();
        random_view(&camera, &options);
        if (camera.near_q32 == 0)
            camera.near_q32 = 3 << 28;
        camera.fx_q12 = camera.fx_q12 / 16 * 16;
        camera.fy_q12 = camera.fy_q12 / 16 * 16;
        picture expected = picture_new(camera.width, camera.height, FXS_FORMAT_RGBA8);
        picture actual = picture_new(camera.width, camera.height, FXS_FORMAT_RGBA8);
        fxs_object object = one_object(&scenes[i % 4].scene);
        expected.targets.depth_bits = 16;
        actual.targets.depth_bits = 16 - shift;
        CHECK(!draw(&plain, &object, 1, &camera, &options, 0, &expected, &stats));
        drawn += stats.visible > 0;
        carry_exactly(&object, &camera, turns[between(0, TURNS - 1)], shift);
        CHECK(!draw(&plain, &object, 1, &camera, &options, 0, &actual, &stats));
        if (!CHECK(same_pictures(&expected, &actual)))
            printf("  case %d, scale 2^%d, projection %d\n", i, shift, (int)camera.projection);
        picture_free(&expected);
        picture_free(&actual);
        free_scenes();
    }
    CHECK(drawn > 60);
}

static void test_crop_around_all(void)
{
    const fxs_crop all[2] = {{{INT64_MIN, INT64_MIN, INT64_MIN}, {INT64_MAX, INT64_MAX, INT64_MAX}, 0},
                             {{INT64_MAX, INT64_MAX, INT64_MAX}, {INT64_MAX, INT64_MAX, INT64_MAX}, 1}};
    state = 5;
    for (int i = 0; i < 80; i++) {
        fxs_camera camera;
        fxs_options options;
        make_scenes();
        random_view(&camera, &options);
        picture expected = picture_new(camera.width, camera.height, FXS_FORMAT_RGBA8);
        picture actual = picture_new(camera.width, camera.height, FXS_FORMAT_RGBA8);
        fxs_object object = one_object(&scenes[i % 4].scene);
        CHECK(!draw(&plain, &object, 1, &camera, &options, 0, &expected, 0));
        object.crops = all;
        object.crop_count = 1 + (uint32_t)i % 2;
        CHECK(!draw(&plain, &object, 1, &camera, &options, 0, &actual, 0));
        CHECK(same_pictures(&expected, &actual));
        picture_free(&expected);
        picture_free(&actual);
        free_scenes();
    }
}

static void test_centres_on_faces_of_crops(void)
{
    static const uint16_t places[] = {0, 30001, 65535};
    fxs_options options;
    fxs_options_init(&options);
    for (int i = 0; i < 3 * 3 * 8; i++) {
        const int axis = i / 8 % 3, is_high = i & 1, is_beside = i >> 1 & 1, is_outside = i >> 2 & 1;
        const uint16_t place = places[i / 24];
        const fxs_camera camera = {.width = 40, .height = 30, .fx_q12 = 40 << 12, .fy_q12 = 40 << 12,
                                   .cx_q12 = 20 << 12, .cy_q12 = 15 << 12, .rotation_q30 = {[0] = 1 << 30,
                                   [4] = 1 << 30, [8] = 1 << 30}, .position_q32 = {[2] = -((int64_t)9 << 32)}};
        packed_scene s = packed_scene_make(FXS_PROFILE_DEFAULT, 0, 1, 0);
        fxs_crop crop = crop_of(-9, 9, axis, is_outside);
        int64_t centre_q32 = 0;
        for (int k = 0; k < 3; k++) {
            s.chunks->origin_q32[k] = -12345 - ((int64_t)1 << 31);
            s.chunks->step_q32[k] = 65537;
            memcpy(packed_scene_rows(&s, 0) + FXS_ROW_POSITION + 512 * k, &(uint16_t){fxs_little_16(place)}, 2);
            centre_q32 = s.chunks->origin_q32[k] + 65537 * (int64_t)place;
        }
        packed_scene_rows(&s, 0)[FXS_ROW_COLOUR + 3] = 255;   /* sets the opacity code of the Gaussian to opaque */
        memset(packed_scene_rows(&s, 0) + FXS_ROW_ROTATION, 0, 4);     /* identity rotation */
        CHECK(!packed_scene_finish(&s));
        *(is_high ? &crop.high_q32[axis] : &crop.low_q32[axis]) = centre_q32 + (is_high ? -is_beside : is_beside);
        picture p = picture_new(camera.width, camera.height, FXS_FORMAT_RGBA8);
        fxs_object object = one_object(&s.scene);
        fxs_stats stats;
        object.crops = &crop;
        object.crop_count = 1;
        CHECK(!draw(&plain, &object, 1, &camera, &options, 0, &p, &stats));
        CHECK(stats.visible == (uint32_t)(is_beside == is_outside));
        picture_free(&p);
        free(s.data);
    }
}

static void test_hidden_objects(void)
{
    const fxs_crop none = {{INT64_MAX, INT64_MAX, INT64_MAX}, {INT64_MAX, INT64_MAX, INT64_MAX}, 0};
    state = 6;
    for (int i = 0; i < 80; i++) {
        fxs_camera camera;
        fxs_options options;
        fxs_stats stats[2];
        make_scenes();
        random_view(&camera, &options);
        picture expected = picture_new(camera.width, camera.height, FXS_FORMAT_RGBA8);
        picture actual = picture_new(camera.width, camera.height, FXS_FORMAT_RGBA8);
        fxs_object objects[2] = {one_object(&scenes[i % 4].scene), one_object(&scenes[i % 4].scene)};
        CHECK(!draw(&plain, objects, 1, &camera, &options, 0, &expected, &stats[0]));
        fxs_object *hidden = &objects[i % 2];
        hidden->id = 9;
        if (i % 3 == 0)
            hidden->visible = 0;
        else if (i % 3 == 1)
            hidden->opacity_q16 = (uint32_t)i / 3 % 2;
        else {
            hidden->crops = &none;
            hidden->crop_count = 1;
        }
        CHECK(!draw(&plain, objects, 2, &camera, &options, 0, &actual, &stats[1]));
        CHECK(same_pictures(&expected, &actual));
        CHECK(stats[0].visible == stats[1].visible && stats[0].entries == stats[1].entries &&
              stats[1].gaussians == 2 * stats[0].gaussians);
        picture_free(&expected);
        picture_free(&actual);
        free_scenes();
    }
}

static void test_ties(void)
{
    int seen = 0;
    state = 8;
    for (int i = 0; i < 40; i++) {
        fxs_camera camera;
        fxs_options options;
        make_scenes();
        random_view(&camera, &options);
        picture p = picture_new(camera.width, camera.height, FXS_FORMAT_RGBA8);
        fxs_object objects[2] = {one_object(&scenes[i % 4].scene), one_object(&scenes[i % 4].scene)};
        objects[0].id = 70;
        objects[1].id = 7;
        CHECK(!draw(&plain, objects, 2, &camera, &options, 0, &p, 0));
        for (int k = 0; k < p.width * p.height; k++) {
            CHECK(picture_id(&p, k).object == 70 || picture_id(&p, k).object == FXS_NOTHING);
            seen += picture_id(&p, k).object == 70;
        }
        picture_free(&p);
        free_scenes();
    }
    CHECK(seen > 10000);
}

static uint32_t random_objects(fxs_object objects[20], fxs_crop crops[20][2])
{
    const uint32_t count = (uint32_t)between(1, 20);
    for (uint32_t i = 0; i < count; i++) {
        fxs_object *o = &objects[i];
        const double axis[3] = {between(-9, 9), between(-9, 9), 10};
        const double at[3] = {between(-30, 30) / 10.0, between(-30, 30) / 10.0, between(-30, 30) / 10.0};
        *o = one_object(&scenes[between(0, 3)].scene);
        o->id = (uint32_t)next();
        if (between(0, 4))
            object_place(o, axis, between(0, 628) / 100.0, exp2(between(-30, 15) / 10.0), at);
        if (between(0, 2) == 0)
            o->opacity_q16 = (uint32_t)between(0, 65536);
        if (between(0, 2) == 0)
            o->tint_q13[between(0, 2)] = (uint32_t)between(0, 32768);
        o->visible = between(0, 9) > 0;
        o->crops = crops[i];
        o->crop_count = (uint32_t)(between(0, 2) ? 0 : between(1, 2));
        for (uint32_t k = 0; k < o->crop_count; k++)
            crops[i][k] = crop_of(between(-30, 0) / 10.0, between(0, 30) / 10.0, between(0, 2), between(0, 1));
    }
    return count;
}

typedef struct scenario {
    fxs_object objects[20];
    fxs_crop crops[20][2];
    uint32_t count;
    fxs_camera camera;
    fxs_options options;
    picture expected, actual;
    fxs_stats stats;
} scenario;

static void make_scenario(scenario *s)
{
    make_scenes();
    s->count = random_objects(s->objects, s->crops);
    random_view(&s->camera, &s->options);
    s->expected = picture_new(s->camera.width, s->camera.height, (enum fxs_format)between(0, 3));
    s->actual = picture_new(s->camera.width, s->camera.height, s->expected.targets.format);
    CHECK(!draw(&plain, s->objects, s->count, &s->camera, &s->options, 0, &s->expected, &s->stats));
}

static void free_scenario(scenario *s)
{
    picture_free(&s->expected);
    picture_free(&s->actual);
    free_scenes();
}

static uint32_t check_bands(scenario *s, const fxs_context *context)
{
    fxs_stats stats;
    fxs_frame_memory memory;
    uint32_t bands = 0;
    const size_t all = fxs_frame_bytes(context, s->objects, s->count, s->camera.width, s->camera.height, &memory);
    int error = draw(context, s->objects, s->count, &s->camera, &s->options, memory.least, &s->actual, &stats);
    const size_t least = error == FXS_ERR_MEMORY ? stats.memory.least : memory.least;
    CHECK(!error || (error == FXS_ERR_MEMORY && least > memory.least && least <= all));
    for (int i = 0; i <= 4; i++) {
        const size_t bytes = least + (all - least) / 4 * (size_t)i;
        CHECK(!draw(context, s->objects, s->count, &s->camera, &s->options, bytes, &s->actual, &stats));
        CHECK(same_pictures(&s->expected, &s->actual));
        CHECK(stats.visible == s->stats.visible && stats.entries == s->stats.entries);
        bands = stats.bands > bands ? stats.bands : bands;
    }
    error = draw(context, s->objects, s->count, &s->camera, &s->options, least - 1, &s->actual, &stats);
    CHECK(error == FXS_ERR_MEMORY && stats.memory.least == least);
    picture_clear(&s->expected);
    CHECK(same_pictures(&s->expected, &s->actual));
    CHECK(!draw(&plain, s->objects, s->count, &s->camera, &s->options, 0, &s->expected, 0));
    return bands;
}

static void test_bands(void)
{
    uint32_t banded = 0;
    state = 21;
    for (int i = 0; i < 25 && !check_faults; i++) {
        scenario s;
        make_scenario(&s);
        banded += check_bands(&s, &plain) > 1;
        free_scenario(&s);
    }
    CHECK(banded > 5);
}

static void test_threads_and_versions(void)
{
    fxs_kernels versions[WORLD_VERSIONS];
    const int count = world_versions(versions);
    state = 22;
    for (int i = 0; i < 16 && !check_faults; i++) {
        scenario s;
        make_scenario(&s);
        for (uint32_t threads = 1; threads <= 8; threads++) {
            fxs_context context;
            const fxs_config config = {.size = sizeof(fxs_config), .workers.run = fxs_pool_run,
                                       .workers.pool = fxs_pool_create(threads), .workers.count = threads};
            fxs_context_init(&context, &config);
            for (int k = 0; k < count; k++) {
                context.config.kernels = &versions[k];
                CHECK(!draw(&context, s.objects, s.count, &s.camera, &s.options, 0, &s.actual, 0));
                if (!CHECK(same_pictures(&s.expected, &s.actual)))
                    printf("  case %d, %s, %u threads\n", i, versions[k].name[FXS_BLEND], threads);
            }
            if (threads == 3)
                check_bands(&s, &context);
            fxs_pool_destroy(config.workers.pool);
        }
        free_scenario(&s);
    }
}

static int draw_stereo(const fxs_context *context, const scenario *s, const fxs_camera cameras[2], picture eyes[2])
{
    const size_t bytes = fxs_frame_bytes(context, s->objects, s->count, cameras[0].width, cameras[0].height, 0);
    void *memory = check_aligned(bytes);
    const fxs_targets targets[2] = {eyes[0].targets, eyes[1].targets};
    picture_clear(&eyes[0]);
    picture_clear(&eyes[1]);
    const int error = render_eyes(context, s->objects, s->count, cameras, &s->options, targets, memory, bytes, 0);
    free(memory);
    return error;
}

static void test_stereo(void)
{
    fxs_kernels versions[WORLD_VERSIONS];
    const int count = world_versions(versions);
    state = 23;
    for (int i = 0; i < 25 && !check_faults; i++) {
        scenario s;
        make_scenario(&s);
        fxs_camera cameras[2] = {s.camera, s.camera};
        const enum fxs_format format = s.expected.targets.format;
        picture eyes[2] = {picture_new(s.camera.width, s.camera.height, format),
                           picture_new(s.camera.width, s.camera.height, format)};
        CHECK(!draw_stereo(&plain, &s, cameras, eyes));
        CHECK(same_pictures(&s.expected, &eyes[0]) && same_pictures(&s.expected, &eyes[1]));
        for (int k = 0; k < 3; k++)
            cameras[1].position_q32[k] += (int64_t)s.camera.rotation_q30[k] * between(1, 3);
        CHECK(!draw_stereo(&plain, &s, cameras, eyes) && same_pictures(&s.expected, &eyes[0]));
        CHECK(!draw(&plain, s.objects, s.count, &cameras[1], &s.options, 0, &s.actual, 0));
        CHECK(same_pictures(&s.actual, &eyes[1]));
        for (int k = 0; k < count; k++) {
            const fxs_config config = {.size = sizeof(fxs_config), .workers.run = fxs_pool_run,
                                       .workers.pool = fxs_pool_create((uint32_t)k + 1),
                                       .workers.count = (uint32_t)k + 1};
            fxs_context context;
            fxs_context_init(&context, &config);
            context.config.kernels = &versions[k];
            CHECK(!draw_stereo(&context, &s, cameras, eyes));
            CHECK(same_pictures(&s.expected, &eyes[0]) && same_pictures(&s.actual, &eyes[1]));
            fxs_pool_destroy(config.workers.pool);
        }
        for (int eye = 0; eye < 2; eye++)
            picture_free(&eyes[eye]);
        free_scenario(&s);
    }
}

static void test_count_pairs(void)
{
    state = 24;
    for (int i = 0; i < 20; i++) {
        scenario s;
        uint64_t evaluated[2], blended[2];
        make_scenario(&s);
        fxs_frame_memory memory;
        size_t bytes = fxs_frame_bytes(&plain, s.objects, s.count, s.camera.width, s.camera.height, &memory);
        for (int k = 0; k < 2; k++) {
            void *room = check_aligned(bytes);
            int error = count_pairs(s.objects, s.count, &s.camera, &s.options, room, bytes, &evaluated[k],
                                        &blended[k]);
            CHECK(!error || (k && error == FXS_ERR_MEMORY));
            CHECK(error || (evaluated[k] == evaluated[0] && blended[k] == blended[0] && blended[k] <= evaluated[k]));
            free(room);
            bytes = memory.least + (bytes - memory.least) / 2;
        }
        free_scenario(&s);
    }
}

static void test_tint_is_rounded(void)
{
    fxs_object_view object;
    memset(&object, 0, sizeof object);
    state = 25;
    for (int i = 0; i < 20000; i++) {
        fxs_splat splat;
        const int colour = between(0, 32767), tint = i % 2 ? between(0, 32768) : between(0, 9000);
        for (int c = 0; c < 3; c++) {
            splat.colour_q13[c] = (int16_t)colour;
            object.tint_q13[c] = c == i % 3 ? tint : 8192;
        }
        fxs_object_tint(&object, &splat);
        for (int c = 0; c < 3; c++)
            CHECK(splat.colour_q13[c] ==
                  (c == i % 3 ? (int)fmin(32767, floor(colour * (double)tint / 8192 + 0.5)) : colour));
    }
}

/* Compares the depths of a scaled object with doubles. They must be right to two units of the last place. */
static void test_depths_are_scaled(void)
{
    static const uint16_t position[3];
    const fxs_chunk header = {0};
    long cut[2] = {0, 0};
    state = 26;
    for (int i = 0; i < 20000; i++) {
        const int64_t scale_q32 = (int64_t)exp2(32 + between(-16000, 16000) / 1000.0);
        const fxs_object_view object = {.scale = fxs_scale_of(scale_q32)};
        const uint32_t key = (uint32_t)next();
        uint32_t scaled = key;
        int exponent;
        CHECK(fxs_object_change(&object, &header, position, &scaled));
        const double mantissa = frexp(ldexp((double)scale_q32, -32) * (1u << 26 | (key & 0x3ffffff)), &exponent);
        const double octave = exponent - 27 + (int)(key >> 26), expected = ldexp(octave + 2 * mantissa - 1, 26);
        CHECK(fabs(scaled - fmin(fmax(expected, 0), UINT32_MAX)) <= 2);
        cut[expected > 0] += expected < 0 || expected > UINT32_MAX;
    }
    CHECK(cut[0] > 500 && cut[1] > 500);
}

static struct {
    fxs_object objects[2];
    fxs_crop crops[FXS_MAX_CROPS + 1];
    fxs_camera camera;
    fxs_options options;
    picture picture;
    void *memory;
    size_t bytes;
} good;

static int untouched(const picture *p)
{
    size_t i = 0;
    while (i < p->bytes && p->block[i] == WORLD_GUARD)
        i++;
    return i == p->bytes;
}

static int render_good(uint32_t count)
{
    return render_frame(&plain, good.objects, count, &good.camera, &good.options, &good.picture.targets, good.memory,
                      good.bytes, 0);
}

/* Puts a bad value into a request. Rendering must return the error and leave the pixels untouched. Then restores
   the value. */
#define REFUSES(error, place, value) do { \
        memcpy(saved, &(place), sizeof (place)); \
        (place) = (value); \
        uint64_t pairs[2]; \
        fxs_pick_result result; \
        if (!CHECK(render_good(2) == (error)) || !CHECK(untouched(&good.picture)) || \
            !CHECK(count_pairs(good.objects, 2, &good.camera, &good.options, good.memory, good.bytes, &pairs[0], \
                                   &pairs[1]) == (error)) || \
            !CHECK(pick_pixel(&plain, good.objects, 2, &good.camera, &good.options, 0, 3, 3, good.memory, good.bytes, \
                            &result) == (error))) \
            printf("  %s = %s\n", #place, #value); \
        memcpy(&(place), saved, sizeof (place)); \
    } while (0)

static void test_bad_objects(void)
{
    unsigned char saved[64];
    fxs_object *o = &good.objects[1];
    state = 3;
    make_scenes();
    random_camera(&good.camera);
    fxs_options_init(&good.options);
    good.objects[0] = one_object(&scenes[0].scene);
    good.objects[1] = one_object(&scenes[1].scene);
    o->crops = good.crops;
    good.picture = picture_new(good.camera.width, good.camera.height, FXS_FORMAT_RGBA8);
    good.bytes = fxs_frame_bytes(&plain, good.objects, 2, good.camera.width, good.camera.height, 0);
    good.memory = check_aligned(good.bytes);
    REFUSES(FXS_ERR_ARGUMENT, o->scene, 0);
    REFUSES(FXS_ERR_OBJECT, o->scale_q32, 0);
    REFUSES(FXS_ERR_OBJECT, o->scale_q32, -(INT64_C(1) << 32));
    REFUSES(FXS_ERR_OBJECT, o->scale_q32, (1 << 16) - 1);
    REFUSES(FXS_ERR_OBJECT, o->scale_q32, (INT64_C(1) << 48) + 1);
    REFUSES(FXS_ERR_OBJECT, o->scale_q32, INT64_MIN);
    REFUSES(FXS_ERR_OBJECT, o->scale_q32, INT64_MAX);
    for (int i = 0; i < 9; i++) {
        REFUSES(FXS_ERR_OBJECT, o->rotation_q30[i], o->rotation_q30[i] + (1 << 26));
        REFUSES(FXS_ERR_OBJECT, o->rotation_q30[i], INT32_MIN);
        REFUSES(FXS_ERR_OBJECT, o->rotation_q30[i], INT32_MAX);
    }
    /* turns the object's rotation into a reflection, which is refused */
    REFUSES(FXS_ERR_OBJECT, o->rotation_q30[4], -(1 << 30));
    for (int i = 0; i < 3; i++) {
        REFUSES(FXS_ERR_OBJECT, o->translation_q32[i], (INT64_C(1) << 60) + 1);
        REFUSES(FXS_ERR_OBJECT, o->translation_q32[i], INT64_MIN);
        REFUSES(FXS_ERR_OBJECT, o->tint_q13[i], 32769);
        REFUSES(FXS_ERR_OBJECT, o->tint_q13[i], UINT32_MAX);
    }
    REFUSES(FXS_ERR_OBJECT, o->opacity_q16, 65537);
    REFUSES(FXS_ERR_OBJECT, o->opacity_q16, UINT32_MAX);
    REFUSES(FXS_ERR_OBJECT, o->crop_count, FXS_MAX_CROPS + 1);
    REFUSES(FXS_ERR_OBJECT, o->crop_count, UINT32_MAX);
    for (uint32_t i = 0; i < FXS_MAX_CROPS; i++)
        for (int axis = 0; axis < 3; axis++) {
            o->crop_count = i + 1;
            /* puts the low corner of a crop box above its high corner */
            REFUSES(FXS_ERR_OBJECT, good.crops[i].low_q32[axis], 1);
        }
    o->crop_count = 1;
    REFUSES(FXS_ERR_ARGUMENT, o->crops, 0);
    o->crop_count = 0;
    o->scale_q32 = 1 << 16;
    REFUSES(FXS_ERR_OBJECT, good.camera.position_q32[0], INT64_C(1) << 45);
    o->scale_q32 = INT64_C(1) << 32;
    CHECK(render_frame(&plain, 0, 2, &good.camera, &good.options, &good.picture.targets, good.memory, good.bytes, 0) ==
          FXS_ERR_ARGUMENT);
    CHECK(fxs_frame_bytes(&plain, 0, 2, 10, 10, 0) == 0);
    CHECK(untouched(&good.picture));
    CHECK(render_good(2) == 0 && !untouched(&good.picture));
}

static void test_too_many_objects(void)
{
    fxs_object *objects = malloc((FXS_MAX_OBJECTS + 1) * sizeof *objects);
    packed_scene small = packed_scene_make(FXS_PROFILE_DEFAULT, 0, 1, 0);
    fxs_scene huge = small.scene;
    for (uint32_t i = 0; i <= FXS_MAX_OBJECTS; i++)
        objects[i] = one_object(&small.scene);
    good.camera.width = good.camera.height = 16;
    CHECK(fxs_frame_bytes(&plain, objects, FXS_MAX_OBJECTS + 1, 16, 16, 0) == 0);
    const size_t bytes = fxs_frame_bytes(&plain, objects, FXS_MAX_OBJECTS, 16, 16, 0);
    void *memory = check_aligned(bytes);
    picture p = picture_new(16, 16, FXS_FORMAT_RGBA8);
    CHECK(render_frame(&plain, objects, FXS_MAX_OBJECTS + 1, &good.camera, &good.options, &p.targets, memory, bytes,
                       0) == FXS_ERR_OBJECT &&
          untouched(&p));
    CHECK(render_frame(&plain, objects, UINT32_MAX, &good.camera, &good.options, &p.targets, memory, bytes, 0) ==
          FXS_ERR_OBJECT && untouched(&p));
    fxs_stats stats;
    CHECK(!render_frame(&plain, objects, FXS_MAX_OBJECTS, &good.camera, &good.options, &p.targets, memory, bytes,
                      &stats));
    CHECK(stats.gaussians == FXS_MAX_OBJECTS);
    huge.count = FXS_MAX_COUNT / 2;
    huge.chunk_count = huge.count / FXS_CHUNK;
    objects[0].scene = objects[1].scene = &huge;
    CHECK(fxs_frame_bytes(&plain, objects, 3, 16, 16, 0) == 0);
    CHECK(render_frame(&plain, objects, 3, &good.camera, &good.options, &p.targets, memory, bytes, 0) ==
          FXS_ERR_OBJECT);
    free(memory);
    free(objects);
    free(small.data);
    picture_free(&p);
}

static void test_no_objects(void)
{
    picture *p = &good.picture;
    fxs_camera camera = good.camera;
    fxs_pick_result result;
    fxs_stats stats;
    uint64_t pairs[2];
    camera.width = p->width;
    camera.height = p->height;
    good.options.background[0] = 200;
    picture_clear(p);
    const size_t bytes = fxs_frame_bytes(&plain, 0, 0, p->width, p->height, 0);
    CHECK(bytes > 0 && bytes <= good.bytes);
    CHECK(!render_frame(&plain, 0, 0, &camera, &good.options, &p->targets, good.memory, bytes, &stats));
    CHECK(stats.visible == 0 && stats.gaussians == 0 && stats.entries == 0);
    for (int i = 0; i < p->width * p->height; i++) {
        static const uint8_t background[4] = {200, 0, 0, 255};
        CHECK(!memcmp(picture_rgba(p) + 4 * i, background, 4));
        CHECK(picture_mean(p, i) == FXS_NOTHING && picture_median(p, i) == FXS_NOTHING);
        CHECK(picture_id(p, i).object == FXS_NOTHING && picture_id(p, i).gaussian == FXS_NOTHING);
        CHECK(((const uint8_t *)p->targets.coverage.pixels)[i] == 0);
    }
    CHECK(!pick_pixel(&plain, 0, 0, &camera, &good.options, 0, 0, 0, good.memory, bytes, &result));
    CHECK(!count_pairs(0, 0, &camera, &good.options, good.memory, bytes, &pairs[0], &pairs[1]) && !pairs[0]);
    picture_free(p);
    free(good.memory);
    free_scenes();
}

int main(void)
{
    fxs_context_init(&plain, 0);
    RUN(test_two_knots);
    RUN(test_orthographic);
    RUN(test_tint_and_opacity);
    RUN(test_crops);
    RUN(test_hundred_objects);
    RUN(test_captured_scenes);
    RUN(test_carried_with_the_camera);
    RUN(test_crop_around_all);
    RUN(test_centres_on_faces_of_crops);
    RUN(test_hidden_objects);
    RUN(test_ties);
    RUN(test_bands);
    RUN(test_threads_and_versions);
    RUN(test_stereo);
    RUN(test_count_pairs);
    RUN(test_tint_is_rounded);
    RUN(test_depths_are_scaled);
    RUN(test_bad_objects);
    RUN(test_too_many_objects);
    RUN(test_no_objects);
    return check_report();
}
