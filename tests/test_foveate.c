/* Tests crops of a picture and foveated pictures. A crop must have the pixels of the whole picture. Foveated
   pictures must be composed as the public header states. */
#include <math.h>
#include <stdio.h>

#include <fixsplat/backend.h>
#include <fixsplat/camera.h>
#include <fixsplat/foveate.h>
#include <fixsplat/system.h>
#include "check.h"
#include "one_scene.h"
#include "procedural_scene.h"
#include "random_scene.h"

enum { GUARD = 0xa5 };

static const fxs_backend_options one_thread = {.size = sizeof(fxs_backend_options), .threads = 1};

static void render(const fxs_scene *scene, const fxs_camera *camera, const fxs_options *options, uint8_t *pixels,
                   ptrdiff_t stride)
{
    fxs_context context;
    fxs_init(&context, 0);
    const size_t bytes = one_frame_bytes(&context, scene, camera->width, camera->height, 0);
    void *memory = check_aligned(bytes);
    CHECK(!one_render(&context, scene, camera, options, FXS_FORMAT_RGBA8, memory, bytes, pixels, stride, 0));
    free(memory);
}

static fxs_camera window_of(const fxs_camera *camera, int32_t x, int32_t y, int32_t width, int32_t height)
{
    fxs_camera window = *camera;
    window.width = width;
    window.height = height;
    window.cx_q12 -= x * 4096;
    window.cy_q12 -= y * 4096;
    window.whole_width = camera->width;
    window.whole_height = camera->height;
    window.whole_x = x;
    window.whole_y = y;
    return window;
}

static int differences(const fxs_scene *scene, const fxs_camera *camera, const fxs_options *options,
                       const uint8_t *whole, const fxs_camera *window)
{
    uint8_t *pixels = malloc((size_t)window->width * (size_t)window->height * 4);
    int count = 0;
    render(scene, window, options, pixels, 4 * window->width);
    for (int32_t y = 0; y < window->height; y++)
        for (int32_t x = 0; x < window->width; x++)
            count += memcmp(pixels + 4 * (y * window->width + x),
                            whole + 4 * ((window->whole_y + y) * camera->width + window->whole_x + x), 4) != 0;
    free(pixels);
    return count;
}

static void check_windows(const fxs_scene *scene, const fxs_camera *camera, const fxs_options *options, int count)
{
    uint8_t *whole = malloc((size_t)camera->width * (size_t)camera->height * 4);
    const int32_t step = options->cutoff == FXS_CUTOFF_SQUARE ? 16 : 1;
    render(scene, camera, options, whole, 4 * camera->width);
    for (int i = 0; i < count; i++) {
        const int32_t x = between(0, camera->width - 1) / step * step;
        const int32_t y = between(0, camera->height - 1) / step * step;
        const fxs_camera window = window_of(camera, x, y, between(1, camera->width - x),
                                            between(1, camera->height - y));
        CHECK(!differences(scene, camera, options, whole, &window));
    }
    free(whole);
}

static void test_windows_of_random_scenes(void)
{
    for (int i = 0; i < 60 && !check_faults; i++) {
        fxs_scene scene;
        fxs_camera camera;
        fxs_options options;
        state = (uint64_t)i * 0x1234567u;
        const packed_scene packed = random_scene((enum fxs_profile)(i % 3), 3000);
        CHECK(!fxs_scene_open(&scene, packed.data, packed.bytes));
        random_view(&camera, &options);
        check_windows(&scene, &camera, &options, 6);
        free(packed.data);
    }
}

/* slopes of the edges left, right, up, down for the left eye, the right eye, and a symmetric view */
static const double headset[][4] = {{-1.38, 1.19, 1.0, -1.2}, {-1.19, 1.38, 1.0, -1.2}, {-1.38, 1.38, 1.2, -1.2}};

static int make_scene(const char *name, fxs_packed_scene *packed, fxs_scene *scene)
{
    fxs_message m;
    fxs_pack_report report;
    return CHECK(!procedural_scene_make(name, 20000, 0, packed, &report, &m) &&
                 !fxs_scene_open(scene, packed->data, packed->bytes));
}

static fxs_camera headset_camera(const double tangents[4], int32_t width, int32_t height, double beside)
{
    const double eye[3] = {0.9 + beside, -2.6, -9}, look[3] = {beside, 0.42, 0}, up[3] = {0, -1, 0};
    fxs_message m;
    fxs_file_view view;
    fxs_camera camera = {.width = 0};
    CHECK(!fxs_view_look_at(&view, eye, look, up, 50, width, height, &m));
    CHECK(!fxs_view_set_tangents(&view, tangents, &m) && !fxs_camera_from_view(&camera, &view, &m));
    return camera;
}

static void test_windows_of_wide_pictures(void)
{
    static const char *const names[] = {"knot", "landscape"};
    for (int i = 0; i < 2; i++) {
        fxs_packed_scene packed;
        fxs_scene scene;
        fxs_options options;
        state = (uint64_t)i;
        if (!make_scene(names[i], &packed, &scene))
            return;
        fxs_options_init(&options);
        for (int k = 0; k < 3; k++) {
            const fxs_camera camera = headset_camera(headset[k], 172, 184, 0);
            check_windows(&scene, &camera, &options, 8);
        }
        fxs_packed_scene_free(&packed);
    }
}

/* Without the option `whole`, a crop clamps slopes at its own edges and pixels change. */
static void test_what_windows_are_for(void)
{
    fxs_packed_scene packed;
    fxs_scene scene;
    fxs_options options;
    if (!make_scene("landscape", &packed, &scene))
        return;
    fxs_options_init(&options);
    const fxs_camera camera = headset_camera(headset[0], 172, 184, 0);
    fxs_camera window = window_of(&camera, 60, 60, 48, 48);
    uint8_t *whole = malloc((size_t)camera.width * (size_t)camera.height * 4), *alone = malloc(48 * 48 * 4);
    render(&scene, &camera, &options, whole, 4 * camera.width);
    CHECK(!differences(&scene, &camera, &options, whole, &window));
    window.whole_width = window.whole_height = 0;
    window.whole_x = window.whole_y = 60;
    CHECK(differences(&scene, &camera, &options, whole, &window) > 0);
    free(whole);
    free(alone);
    fxs_packed_scene_free(&packed);
}

static fxs_stats render_counted(const fxs_scene *scene, const fxs_camera *camera, const fxs_options *options,
                                uint8_t *pixels)
{
    fxs_context context;
    fxs_stats stats;
    fxs_init(&context, 0);
    const size_t bytes = one_frame_bytes(&context, scene, camera->width, camera->height, 0);
    void *memory = check_aligned(bytes);
    CHECK(!one_render(&context, scene, camera, options, FXS_FORMAT_RGBA8, memory, bytes, pixels, 4 * camera->width,
                      &stats));
    free(memory);
    return stats;
}

/* Returns the number of Gaussians drawn. *all: the number drawn without a hidden part. */
static uint32_t check_hidden(const fxs_scene *scene, const fxs_camera *camera, const fxs_options *options,
                             uint32_t *all)
{
    const size_t bytes = 4 * (size_t)camera->width * (size_t)camera->height;
    uint8_t *pixels[2] = {malloc(bytes), malloc(bytes)};
    fxs_camera whole = *camera;
    whole.hidden_width = 0;
    *all = render_counted(scene, &whole, options, pixels[0]).visible;
    const uint32_t visible = render_counted(scene, camera, options, pixels[1]).visible;
    for (int32_t y = 0; y < camera->height; y++)
        for (int32_t x = 0; x < camera->width; x++) {
            const size_t at = 4 * ((size_t)y * (size_t)camera->width + (size_t)x);
            const int hidden = x >= camera->hidden_x && x < camera->hidden_x + camera->hidden_width &&
                               y >= camera->hidden_y && y < camera->hidden_y + camera->hidden_height;
            CHECK(hidden || !memcmp(pixels[0] + at, pixels[1] + at, 4));
        }
    free(pixels[0]);
    free(pixels[1]);
    return visible;
}

static void random_hidden(fxs_camera *camera)
{
    camera->hidden_x = between(0, camera->width);
    camera->hidden_y = between(0, camera->height);
    camera->hidden_width = between(0, camera->width - camera->hidden_x);
    camera->hidden_height = between(0, camera->height - camera->hidden_y);
}

static void test_hidden_parts(void)
{
    fxs_packed_scene knot;
    fxs_scene scene;
    fxs_options options;
    uint32_t drawn = 0, of = 0, all;
    for (int i = 0; i < 120 && !check_faults; i++) {
        fxs_camera camera;
        state = (uint64_t)i * 0x2233445u;
        const packed_scene packed = random_scene((enum fxs_profile)(i % 3), 3000);
        CHECK(!fxs_scene_open(&scene, packed.data, packed.bytes));
        random_view(&camera, &options);
        random_hidden(&camera);
        drawn += check_hidden(&scene, &camera, &options, &all);
        of += all;
        free(packed.data);
    }
    CHECK(drawn < of);
    if (!make_scene("knot", &knot, &scene))
        return;
    fxs_options_init(&options);
    fxs_camera camera = headset_camera(headset[0], 172, 184, 0);
    for (int i = 0; i < 20; i++) {
        random_hidden(&camera);
        check_hidden(&scene, &camera, &options, &all);
    }
    camera.hidden_x = camera.hidden_y = 0;
    camera.hidden_width = camera.width;
    camera.hidden_height = camera.height;
    drawn = check_hidden(&scene, &camera, &options, &all);
    CHECK(drawn < all / 50);
    fxs_packed_scene_free(&knot);
}

static void test_window_errors(void)
{
    const int32_t bad[][4] = {{9, 10, 0, 0}, {10, 9, 0, 0}, {20, 20, -1, 0}, {20, 20, 0, -1}, {20, 20, 11, 0},
                              {20, 20, 0, 11}, {FXS_MAX_SIZE + 1, 20, 0, 0}, {20, FXS_MAX_SIZE + 1, 0, 0},
                              {INT32_MIN, 20, 0, 0}, {20, 20, INT32_MAX, 0}, {20, 0, 0, 0}, {0, 20, 0, 0}};
    fxs_options options;
    fxs_view view;
    fxs_options_init(&options);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        fxs_camera camera;
        fxs_camera_init(&camera, 10, 10);
        camera.whole_width = bad[i][0];
        camera.whole_height = bad[i][1];
        camera.whole_x = bad[i][2];
        camera.whole_y = bad[i][3];
        CHECK(fxs_view_init(&view, &camera, &options) == FXS_ERR_SIZE);
        camera.whole_width = camera.whole_height = FXS_MAX_SIZE;
        camera.whole_x = camera.whole_y = FXS_MAX_SIZE - 10;
        CHECK(!fxs_view_init(&view, &camera, &options));
    }
    const int32_t hidden[][4] = {{-1, 0, 1, 1}, {0, -1, 1, 1}, {0, 0, -1, 1}, {0, 0, 1, -1}, {0, 0, 11, 1},
                                 {0, 0, 1, 11}, {5, 0, 6, 1}, {0, 5, 1, 6}, {11, 0, 0, 0}, {INT32_MAX, 0, 1, 1},
                                 {1, 0, INT32_MAX, 1}, {INT32_MIN, 0, INT32_MIN, 0}};
    for (size_t i = 0; i < sizeof hidden / sizeof *hidden; i++) {
        fxs_camera camera;
        fxs_camera_init(&camera, 10, 10);
        camera.hidden_x = hidden[i][0];
        camera.hidden_y = hidden[i][1];
        camera.hidden_width = hidden[i][2];
        camera.hidden_height = hidden[i][3];
        CHECK(fxs_view_init(&view, &camera, &options) == FXS_ERR_SIZE);
    }
}

/* A back end that draws random bytes and records requests. */
typedef struct recorder {
    uint32_t calls, fail_at;
    fxs_camera cameras[FXS_RINGS][2];
    uint8_t *pixels[FXS_RINGS][2];
} recorder;

static int record(void *self, const fxs_request *q, fxs_stats *stats, fxs_message *why)
{
    recorder *r = self;
    memset(stats, 0, sizeof *stats);
    stats->visible = 1;
    stats->nanoseconds[FXS_BLEND] = 10;
    strcpy(why->text, "as asked");
    if (r->calls == r->fail_at)
        return FXS_ERR_DEVICE;
    for (uint32_t eye = 0; eye < q->eyes; eye++) {
        const fxs_camera *c = &q->cameras[eye];
        CHECK(q->targets[eye].colour.stride == 4 * c->width);
        r->cameras[r->calls][eye] = *c;
        r->pixels[r->calls][eye] = q->targets[eye].colour.pixels;
        for (int32_t i = 0; i < 4 * c->width * c->height; i++)
            r->pixels[r->calls][eye][i] = (uint8_t)(i % 7 ? next() : 255);
    }
    r->calls++;
    return 0;
}

static uint64_t no_time(const void *self)
{
    (void)self;
    return 3;
}

static const fxs_backend recording = {.name = "recording", .render = record, .nanoseconds = no_time};

static int clamp(int x, int end)
{
    return x < 0 ? 0 : x < end ? x : end - 1;
}

/* Returns a pixel of a ring (a crop at a lower rate) times (2 rate)^2. */
static int enlarged(const uint8_t *pixels, const fxs_ring *r, int x, int y, int channel)
{
    const int steps = 2 * r->rate, nx = 2 * x + 1 - r->rate, ny = 2 * y + 1 - r->rate;
    const int column = (int)floor((double)nx / steps), row = (int)floor((double)ny / steps);
    int sum = 0;
    for (int j = 0; j < 2; j++)
        for (int i = 0; i < 2; i++) {
            const int wx = i ? nx - column * steps : steps - nx + column * steps;
            const int wy = j ? ny - row * steps : steps - ny + row * steps;
            const int at = clamp(row + j, r->height) * r->width + clamp(column + i, r->width);
            sum += wx * wy * pixels[4 * at + channel];
        }
    return sum;
}

/* Returns the weight of a ring (a crop at a lower rate) in 1/256. */
static int share(const fxs_ring *r, const fxs_foveation *f, int eye, int x, int y, int width, int height)
{
    const int left = r->x[eye], top = r->y[eye], right = left + r->width * r->rate, lower = top + r->height * r->rate;
    const int inside[4] = {left > 0 ? x - left : INT32_MAX, top > 0 ? y - top : INT32_MAX,
                           right < width ? right - 1 - x : INT32_MAX, lower < height ? lower - 1 - y : INT32_MAX};
    int least = 256;
    if (x < left || y < top || x >= right || y >= lower)
        return 0;
    for (int i = 0; i < 4; i++)
        if (inside[i] < f->band) {
            const int ramp = (int)floor((inside[i] + 0.5) * floor(256 * 32768.0 / f->band) / 32768);
            least = ramp < least ? ramp : least;
        }
    return least;
}

static void naive(uint8_t rgba[4], const recorder *r, const fxs_foveated *out, const fxs_foveation *f, int eye, int x,
                  int y, int width, int height)
{
    for (int k = (int)out->count - 1; k >= 0; k--) {
        const fxs_ring *ring = &out->rings[k];
        const int shown = share(ring, f, eye, x, y, width, height), whole = 4 * ring->rate * ring->rate;
        for (int c = 0; c < 4 && shown; c++) {
            const int sum = enlarged(r->pixels[k][eye], ring, x - ring->x[eye], y - ring->y[eye], c);
            const int value = (sum + whole / 2) / whole;
            rgba[c] = (uint8_t)((value * shown + rgba[c] * (256 - shown) + 128) / 256);
        }
    }
}

static void random_foveation(fxs_foveation *f, int32_t width, int32_t height)
{
    const int32_t side = width < height ? width : height;
    for (int eye = 0; eye < 2; eye++) {
        f->gaze[eye][0] = between(-width / 4, width + width / 4);
        f->gaze[eye][1] = between(-height / 4, height + height / 4);
    }
    f->radius[0] = between(1, side / 3 + 2);
    f->radius[1] = f->radius[0] + between(1, side / 3 + 2);
    f->band = between(0, 3) ? between(0, f->radius[0]) : 0;
}

static void check_composition(int32_t width, int32_t height, uint32_t eyes, fxs_run_fn *run, void *pool)
{
    recorder r = {.fail_at = UINT32_MAX};
    fxs_camera cameras[2];
    fxs_targets targets[2];
    fxs_foveation f;
    fxs_foveated out;
    fxs_message why;
    random_foveation(&f, width, height);
    const ptrdiff_t stride = 4 * ((int32_t)eyes * width + between(0, 3));
    uint8_t *pixels = malloc((size_t)stride * (size_t)height);
    memset(pixels, GUARD, (size_t)stride * (size_t)height);
    for (uint32_t eye = 0; eye < eyes; eye++) {
        random_camera(&cameras[eye]);
        cameras[eye].width = width;
        cameras[eye].height = height;
        targets[eye] = one_target(FXS_FORMAT_RGBA8_COVERAGE, pixels + 4 * eye * (size_t)width, stride);
    }
    fxs_request q;
    fxs_request_init(&q, 0, 0);
    q.eyes = eyes;
    memcpy(q.cameras, cameras, sizeof cameras);
    memcpy(q.targets, targets, sizeof targets);
    const size_t bytes = fxs_foveation_bytes(&f, cameras, eyes);
    uint8_t *memory = malloc(bytes);
    CHECK(fxs_foveate(&recording, &r, &q, &f, memory, bytes - 1, run, pool, &out, &why) == FXS_ERR_MEMORY &&
          why.bytes_needed == bytes && r.calls == 0);
    CHECK(!fxs_foveate(&recording, &r, &q, &f, memory, bytes, run, pool, &out, &why));
    CHECK(out.count == r.calls && out.stats.visible == out.count && out.device_nanoseconds == 3 * out.count &&
          out.stats.nanoseconds[FXS_BLEND] == 10 * out.count);
    int wrong = 0;
    for (int32_t y = 0; y < height; y++)
        for (int32_t i = 0; i < (int32_t)stride / 4; i++) {
            uint8_t expected[4] = {GUARD, GUARD, GUARD, GUARD};
            if (i < (int32_t)eyes * width)
                naive(expected, &r, &out, &f, i / width, i % width, y, width, height);
            wrong += memcmp(expected, pixels + y * stride + 4 * i, 4) != 0;
        }
    CHECK(!wrong);
    free(memory);
    free(pixels);
}

static void test_putting_together(void)
{
    fxs_pool *pool = fxs_pool_create(3);
    state = 11;
    for (int i = 0; i < 120 && !check_faults; i++)
        check_composition(between(1, i % 4 ? 90 : 300), between(1, 80), 1 + (uint32_t)i % 2, i % 3 ? fxs_pool_run : 0,
                          pool);
    check_composition(1, 1, 2, 0, 0);
    check_composition(FXS_MAX_SIZE, 3, 1, fxs_pool_run, pool);
    fxs_pool_destroy(pool);
}

/* Pixel (X, Y) of a ring (a crop at a lower rate) lies at the centre of its block. */
static void test_cameras_of_rings(void)
{
    recorder r = {.fail_at = UINT32_MAX};
    fxs_camera camera = headset_camera(headset[0], 1000, 900, 0);
    fxs_foveation f = {{{950, 20}, {0, 0}}, {100, 300}, 10};
    fxs_foveated out;
    fxs_message why;
    static uint8_t pixels[1000 * 900 * 4];
    const fxs_targets targets = one_target(FXS_FORMAT_RGBA8, pixels, 4000);
    fxs_request q;
    fxs_request_init(&q, 0, 0);
    q.cameras[0] = camera;
    q.targets[0] = targets;
    const size_t bytes = fxs_foveation_bytes(&f, &camera, 1);
    void *memory = malloc(bytes);
    CHECK(!fxs_foveate(&recording, &r, &q, &f, memory, bytes, 0, 0, &out, &why) && out.count == 3);
    for (uint32_t k = 0; k < out.count; k++) {
        const fxs_ring *ring = &out.rings[k];
        const fxs_camera *c = &r.cameras[k][0];
        const int rate = 1 << k;
        const double slope = (ring->x[0] + rate / 2.0 - camera.cx_q12 / 4096.0) / (camera.fx_q12 / 4096.0);
        CHECK(ring->rate == rate && c->width == ring->width && c->height == ring->height);
        CHECK(fabs((0.5 - c->cx_q12 / 4096.0) / (c->fx_q12 / 4096.0) - slope) < 1e-5);
        CHECK(c->whole_width == (1000 + rate - 1) / rate && c->whole_height == (900 + rate - 1) / rate);
        CHECK(c->whole_x * rate == ring->x[0] && c->whole_y * rate == ring->y[0]);
        CHECK(k == 2 || (c->width % 16 == 0 && c->height % 16 == 0));
    }
    CHECK(out.rings[0].width == 208 && out.rings[0].x[0] == 792 && out.rings[0].y[0] == 0);
    CHECK(out.rings[1].width == 304 && out.rings[1].x[0] == 392 && out.rings[2].width == 250);
    camera.whole_width = 1100;
    camera.whole_height = 900;
    camera.whole_x = 100;
    q.cameras[0] = camera;
    r.calls = 0;
    CHECK(!fxs_foveate(&recording, &r, &q, &f, memory, bytes, 0, 0, &out, &why));
    CHECK(r.cameras[1][0].whole_width == 550 && r.cameras[1][0].whole_x == 50 + 196);
    free(memory);
}

typedef struct eyes {
    fxs_object object;
    fxs_options options;
    fxs_camera cameras[2];
    fxs_targets targets[2];
    uint8_t *pixels;
    size_t bytes;
} eyes;

static eyes eyes_of(const fxs_scene *scene, int32_t width, int32_t height)
{
    eyes e;
    e.object = one_object(scene);
    fxs_options_init(&e.options);
    e.bytes = 8 * (size_t)width * (size_t)height;
    e.pixels = malloc(e.bytes);
    for (int eye = 0; eye < 2; eye++) {
        e.cameras[eye] = headset_camera(headset[eye], width, height, eye ? 0.03 : -0.03);
        e.targets[eye] = one_target(FXS_FORMAT_RGBA8, e.pixels + 4 * eye * width, 8 * width);
    }
    return e;
}

static fxs_request request_of(const eyes *e)
{
    return request_for(&e->object, 1, &e->options, 2, e->cameras, e->targets);
}

static int foveate(const char *name, const fxs_foveation *f, eyes *e, fxs_foveated *out)
{
    const fxs_backend *backend = fxs_backend_find(name);
    const size_t bytes = fxs_foveation_bytes(f, e->cameras, 2);
    const fxs_request q = request_of(e);
    fxs_message why;
    void *self;
    if (backend->open(&self, &one_thread, &why)) {
        printf("  %s: %s\n", name, why.text);
        return 0;
    }
    void *memory = malloc(bytes);
    memset(e->pixels, GUARD, e->bytes);
    if (!CHECK(!fxs_foveate(backend, self, &q, f, memory, bytes, 0, 0, out, &why)))
        printf("  %s: %s\n", name, why.text);
    free(memory);
    backend->close(self);
    return 1;
}

static void check_inside(const eyes *e, const uint8_t *whole, const fxs_foveation *f, const fxs_foveated *out)
{
    const fxs_ring *r = &out->rings[0];
    const int32_t width = e->cameras->width;
    for (int eye = 0; eye < 2; eye++)
        for (int32_t y = r->y[eye] + f->band; y < r->y[eye] + r->height - f->band; y++) {
            const size_t at = 4 * ((size_t)(2 * y + eye) * (size_t)width + (size_t)(r->x[eye] + f->band));
            CHECK(!memcmp(e->pixels + at, whole + at, 4 * (size_t)(r->width - 2 * f->band)));
        }
}

static void test_back_ends(void)
{
    static const char *const names[] = {"gles", "gles-compute", "osmesa", "cuda"};
    fxs_packed_scene packed;
    fxs_scene scene;
    fxs_foveation f;
    fxs_foveated out;
    if (!make_scene("knot", &packed, &scene))
        return;
    eyes e = eyes_of(&scene, 206, 220);
    uint8_t *expected = malloc(e.bytes), *whole = malloc(e.bytes);
    for (int eye = 0; eye < 2; eye++)
        render(&scene, &e.cameras[eye], &e.options, whole + 4 * eye * 206, 8 * 206);
    fxs_foveation_init(&f, e.cameras, 2);
    CHECK(f.gaze[0][0] == 110 && f.gaze[1][0] == 95 && f.gaze[0][1] == 100 && f.radius[0] == 41 &&
          f.radius[1] == 82 && f.band == 10);
    CHECK(foveate("cpu", &f, &e, &out) && out.count == 3);
    check_inside(&e, whole, &f, &out);
    memcpy(expected, e.pixels, e.bytes);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        CHECK(!foveate(names[i], &f, &e, &out) || !memcmp(e.pixels, expected, e.bytes));
    f = (fxs_foveation){{{0, 0}, {0, 0}}, {110, 111}, 0};       /* the ring of the full rate covers the whole picture */
    CHECK(foveate("cpu", &f, &e, &out) && out.count == 1 && !memcmp(e.pixels, whole, e.bytes));
    free(expected);
    free(whole);
    free(e.pixels);
    fxs_packed_scene_free(&packed);
}

static int render_all(void *self, const fxs_request *q, fxs_stats *stats, fxs_message *why)
{
    fxs_request all = *q;
    for (uint32_t eye = 0; eye < q->eyes; eye++)
        all.cameras[eye].hidden_width = 0;
    return fxs_backend_cpu.render(self, &all, stats, why);
}

static void test_nothing_is_missed(void)
{
    const fxs_backend all = {.name = "all", .render = render_all, .nanoseconds = no_time};
    fxs_packed_scene packed;
    fxs_scene scene;
    fxs_foveation f;
    fxs_foveated out;
    fxs_message why;
    void *self;
    uint64_t drawn = 0, of = 0;
    if (!make_scene("knot", &packed, &scene) || !CHECK(!fxs_backend_cpu.open(&self, &one_thread, &why)))
        return;
    state = 5;
    for (int i = 0; i < 60 && !check_faults; i++) {
        eyes e = eyes_of(&scene, between(30, 160), between(30, 160));
        const fxs_request q = request_of(&e);
        random_foveation(&f, e.cameras->width, e.cameras->height);
        const size_t bytes = fxs_foveation_bytes(&f, e.cameras, 2);
        uint8_t *memory = malloc(bytes), *expected = malloc(e.bytes);
        CHECK(!fxs_foveate(&all, self, &q, &f, memory, bytes, 0, 0, &out, &why));
        of += out.stats.visible;
        memcpy(expected, e.pixels, e.bytes);
        memset(e.pixels, GUARD, e.bytes);
        CHECK(!fxs_foveate(&fxs_backend_cpu, self, &q, &f, memory, bytes, 0, 0, &out, &why));
        drawn += out.stats.visible;
        CHECK(!memcmp(e.pixels, expected, e.bytes));
        free(memory);
        free(expected);
        free(e.pixels);
    }
    printf("  %.2f of the Gaussians are drawn\n", (double)drawn / (double)of);
    CHECK(drawn < of);
    fxs_backend_cpu.close(self);
    fxs_packed_scene_free(&packed);
}

static uint8_t error_pixels[2 * 64 * 48 * 4];

static int attempt(recorder *r, const fxs_request *q, const fxs_foveation *f)
{
    static uint8_t memory[1 << 17];
    fxs_message why = {.text = ""};
    memset(error_pixels, GUARD, sizeof error_pixels);
    const int error = fxs_foveate(&recording, r, q, f, memory, sizeof memory, 0, 0, 0, &why);
    CHECK(!error || (*why.text && !strchr(why.text, '\n')));
    for (size_t i = 0; i < sizeof error_pixels && error; i++)
        CHECK(error_pixels[i] == GUARD);
    return error;
}

static void test_errors(void)
{
    const int32_t bad[][3] = {{0, 5, 0}, {5, 5, 0}, {5, 4, 0}, {5, FXS_MAX_SIZE + 1, 0}, {5, 9, -1}, {5, 9, 6},
                              {-1, 5, 0}, {INT32_MIN, INT32_MAX, 0}};
    recorder r = {.fail_at = UINT32_MAX};
    fxs_foveation f;
    fxs_request q;
    fxs_request_init(&q, 0, 0);
    q.eyes = 2;
    for (int eye = 0; eye < 2; eye++) {
        fxs_camera_init(&q.cameras[eye], 64, 48);
        q.targets[eye] = one_target(FXS_FORMAT_RGBA8, error_pixels + eye * 64 * 48 * 4, 256);
    }
    fxs_foveation_init(&f, q.cameras, 2);
    f.radius[0] = 5;
    f.radius[1] = 7;
    CHECK(!attempt(&r, &q, &f) && r.calls == 3);
    for (uint32_t k = 0; k < 3; k++) {
        r = (recorder){.fail_at = k};
        CHECK(attempt(&r, &q, &f) == FXS_ERR_DEVICE && r.calls == k);
    }
    r = (recorder){.fail_at = 0};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const fxs_foveation wrong = {{{0, 0}, {0, 0}}, {bad[i][0], bad[i][1]}, bad[i][2]};
        CHECK(attempt(&r, &q, &wrong) == FXS_ERR_ARGUMENT && !fxs_foveation_bytes(&wrong, q.cameras, 2));
    }
    CHECK(attempt(&r, &q, 0) == FXS_ERR_ARGUMENT);
    for (uint32_t number = 0; number <= 3; number += 3) {
        fxs_request wrong = q;
        wrong.eyes = number;
        CHECK(attempt(&r, &wrong, &f) == FXS_ERR_ARGUMENT);
    }
    for (int i = 0; i < 4; i++) {
        q.cameras[1].width = (const int32_t[]){0, 63, FXS_MAX_SIZE + 1, INT32_MIN}[i];
        CHECK(attempt(&r, &q, &f) == FXS_ERR_SIZE);
    }
    q.cameras[1].width = 64;
    const int32_t near_least = INT32_MIN + (FXS_MAX_SIZE << 12) - 1;
    int32_t *const centres[] = {&q.cameras[1].cx_q12, &q.cameras[1].cy_q12};
    for (int i = 0; i < 2; i++) {
        const int32_t was = *centres[i];
        *centres[i] = near_least;
        CHECK(attempt(&r, &q, &f) == FXS_ERR_CAMERA);
        *centres[i] = was;
    }
    const fxs_image image = {error_pixels, 512};
    fxs_image *const others[] = {&q.targets[1].coverage, &q.targets[1].mean_depth, &q.targets[1].median_depth,
                                 &q.targets[1].id, &q.targets[1].occluder, &q.targets[1].backdrop};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        *others[i] = image;
        CHECK(attempt(&r, &q, &f) == FXS_ERR_UNSUPPORTED);
        others[i]->pixels = 0;
    }
    q.targets[1].colour.pixels = 0;
    CHECK(attempt(&r, &q, &f) == FXS_ERR_UNSUPPORTED);
    q.targets[1] = q.targets[0];
    q.targets[1].format = FXS_FORMAT_RGB565;
    CHECK(attempt(&r, &q, &f) == FXS_ERR_UNSUPPORTED);
    q.targets[1].format = FXS_FORMAT_RGBA16_COVERAGE;
    CHECK(attempt(&r, &q, &f) == FXS_ERR_UNSUPPORTED);
    q.targets[1].format = FXS_FORMAT_RGBA8;
    for (ptrdiff_t stride = -252; stride <= 252; stride += 84) {
        q.targets[1].colour.stride = stride;
        CHECK(attempt(&r, &q, &f) == FXS_ERR_TARGET);
    }
}

static void test_tangents(void)
{
    const double nan = NAN, bad[][4] = {{1, 1, 1, -1}, {1, -1, 1, -1}, {-1, 1, -1, 1}, {-1, 1, 0, 0}, {-65, 1, 1, -1},
                                        {-1, 65, 1, -1}, {-1, 1, 65, -1}, {-1, 1, 1, -65}, {nan, 1, 1, -1},
                                        {-1, nan, 1, -1}, {-1, 1, nan, -1}, {-1, 1, 1, nan}};
    const double eye[3] = {0, 0, 0}, look[3] = {0, 0, 1}, up[3] = {0, -1, 0};
    fxs_message m;
    fxs_file_view view;
    CHECK(!fxs_view_look_at(&view, eye, look, up, 50, 2064, 2208, &m));
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        CHECK(fxs_view_set_tangents(&view, bad[i], &m) == FXS_ERR_ARGUMENT);
    CHECK(!fxs_view_set_tangents(&view, headset[0], &m));
    CHECK(fabs((0 - view.cx) / view.fx + 1.38) < 1e-9 && fabs((2064 - view.cx) / view.fx - 1.19) < 1e-9);
    CHECK(fabs((0 - view.cy) / view.fy + 1.0) < 1e-9 && fabs((2208 - view.cy) / view.fy - 1.2) < 1e-9);
}

int main(void)
{
    RUN(test_windows_of_random_scenes);
    RUN(test_windows_of_wide_pictures);
    RUN(test_what_windows_are_for);
    RUN(test_hidden_parts);
    RUN(test_window_errors);
    RUN(test_putting_together);
    RUN(test_cameras_of_rings);
    RUN(test_back_ends);
    RUN(test_nothing_is_missed);
    RUN(test_errors);
    RUN(test_tangents);
    return check_report();
}
