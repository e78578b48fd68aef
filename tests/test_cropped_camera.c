/* A camera for a crop ("window") of a picture must render the same pixels as the whole picture. Also tests the fields
   of view of headsets. */
#include <math.h>

#include <fixsplat/camera.h>
#include "check.h"
#include "one_scene.h"
#include "procedural_scene.h"
#include "random_scene.h"

static void render(const fxs_scene *scene, const fxs_camera *camera, const fxs_options *options, uint8_t *pixels,
                   ptrdiff_t stride)
{
    fxs_context context;
    fxs_context_init(&context, 0);
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

/* tangents of the field of view (left, right, up, down) of the left eye, the right eye, and a symmetric view */
static const double headset[][4] = {{-1.38, 1.19, 1.0, -1.2}, {-1.19, 1.38, 1.0, -1.2}, {-1.38, 1.38, 1.2, -1.2}};

static int make_scene(const char *name, fxs_packed_scene *packed, fxs_scene *scene)
{
    fxs_message m;
    fxs_pack_report report;
    return CHECK(!procedural_scene_make(name, 20000, 0, packed, &report, &m) &&
                 !fxs_scene_open(scene, packed->data, packed->bytes));
}

static fxs_camera headset_camera(const double tangents[4], int32_t width, int32_t height)
{
    const double eye[3] = {0.9, -2.6, -9}, look[3] = {0, 0.42, 0}, up[3] = {0, -1, 0};
    fxs_message m;
    fxs_view view;
    fxs_camera camera = {.width = 0};
    CHECK(!fxs_view_look_at(&view, eye, look, up, &(fxs_picture){50, width, height}, &m));
    CHECK(!fxs_view_set_tangents(&view, tangents, &m) && !fxs_camera_from_view(&camera, &view, &m));
    return camera;
}

/* The slopes x/z in the projection's Jacobian are clamped to the whole picture, not to the window. An eye's picture
   is a window of a symmetric picture. */
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
            const fxs_camera camera = headset_camera(headset[k], 172, 184);
            check_windows(&scene, &camera, &options, 8);
        }
        fxs_packed_scene_free(&packed);
    }
}

/* Control: if the camera does not state the whole picture, slopes are clamped to the window, which changes pixels. */
static void test_what_windows_are_for(void)
{
    fxs_packed_scene packed;
    fxs_scene scene;
    fxs_options options;
    if (!make_scene("landscape", &packed, &scene))
        return;
    fxs_options_init(&options);
    const fxs_camera camera = headset_camera(headset[0], 172, 184);
    fxs_camera window = window_of(&camera, 60, 60, 48, 48);
    uint8_t *whole = malloc((size_t)camera.width * (size_t)camera.height * 4);
    render(&scene, &camera, &options, whole, 4 * camera.width);
    CHECK(!differences(&scene, &camera, &options, whole, &window));
    window.whole_width = window.whole_height = 0;
    window.whole_x = window.whole_y = 60;
    CHECK(differences(&scene, &camera, &options, whole, &window) > 0);
    free(whole);
    fxs_packed_scene_free(&packed);
}

static void test_window_errors(void)
{
    const int32_t bad[][4] = {{9, 10, 0, 0}, {10, 9, 0, 0}, {20, 20, -1, 0}, {20, 20, 0, -1}, {20, 20, 11, 0},
                              {20, 20, 0, 11}, {FXS_MAX_SIZE + 1, 20, 0, 0}, {20, FXS_MAX_SIZE + 1, 0, 0},
                              {INT32_MIN, 20, 0, 0}, {20, 20, INT32_MAX, 0}, {20, 0, 0, 0}, {0, 20, 0, 0}};
    fxs_options options;
    fxs_stage_view view;
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
}

static void test_tangents(void)
{
    const double nan = NAN, bad[][4] = {{1, 1, 1, -1}, {1, -1, 1, -1}, {-1, 1, -1, 1}, {-1, 1, 0, 0}, {-65, 1, 1, -1},
                                        {-1, 65, 1, -1}, {-1, 1, 65, -1}, {-1, 1, 1, -65}, {nan, 1, 1, -1},
                                        {-1, nan, 1, -1}, {-1, 1, nan, -1}, {-1, 1, 1, nan}};
    const double eye[3] = {0, 0, 0}, look[3] = {0, 0, 1}, up[3] = {0, -1, 0};
    fxs_message m;
    fxs_view view;
    CHECK(!fxs_view_look_at(&view, eye, look, up, &(fxs_picture){50, 2064, 2208}, &m));
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
    RUN(test_window_errors);
    RUN(test_tangents);
    return check_report();
}
