/* Compares the renderer of float Gaussians with the reference renderer in doubles. The quality loss of each packing
   profile is measured against both. */
#include <math.h>
#include <string.h>

#include <fixsplat/camera.h>
#include <fixsplat/pack.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/view_more.h>
#include "src/fit/float_scene.h"
#include "tools/command/procedural.h"
#include "tools/command/metrics.h"
#include "check.h"
#include "one_scene.h"
#include "reference.h"

enum { COUNT = 4000, WIDTH = 320, HEIGHT = 240, PIXELS = WIDTH * HEIGHT, VIEWS = 4 };

static fxs_gaussian gaussians[COUNT];
static uint8_t exact[4 * PIXELS], floats[4 * PIXELS], packed[4 * PIXELS];
static double linear[3 * PIXELS];

static long read_gaussians(void *argument, uint64_t first, fxs_gaussian *out, size_t capacity)
{
    memcpy(out, (const fxs_gaussian *)argument + first, capacity * sizeof *out);
    return (long)capacity;
}

static double psnr(const uint8_t *a, const uint8_t *b)
{
    struct fxs_metrics m;
    return CHECK(!fxs_metrics_compare(a, b, WIDTH, HEIGHT, &m)) ? m.psnr : 0;
}

/* Makes the camera with the given number, around the scene's box, near or far. The last camera is orthographic. */
static int find_view(int number, const fxs_pack_report *report, fxs_view *view)
{
    static const double up[3] = {0, -1, 0};
    double middle[3];
    fxs_message m;
    if (fxs_view_frame_box(view, report->inner_low, report->inner_high, up, &(fxs_picture){50, WIDTH, HEIGHT}, &m))
        return -1;
    for (int k = 0; k < 3; k++) {
        middle[k] = (report->inner_low[k] + report->inner_high[k]) / 2;
        view->position[k] = middle[k] + (number == 1 ? 0.4 : 1) * (view->position[k] - middle[k]);
    }
    fxs_view_orbit(view, middle, up, 1.1 * number);
    if (number == VIEWS - 1) {
        const double units = 1.2 * (report->inner_high[1] - report->inner_low[1]);
        view->projection = FXS_ORTHOGRAPHIC;
        view->fx = view->fy = HEIGHT / units;
    }
    return 0;
}

static int draw_packed(const fxs_packed_scene *scene, const fxs_view *view)
{
    fxs_message m;
    fxs_scene opened;
    fxs_camera camera;
    fxs_context context;
    fxs_options options;
    fxs_context_init(&context, 0);
    fxs_options_init(&options);
    if (fxs_scene_open(&opened, scene->data, scene->bytes) || fxs_camera_from_view(&camera, view, &m))
        return -1;
    const size_t bytes = one_frame_bytes(&context, &opened, WIDTH, HEIGHT, 0);
    void *memory = check_aligned(bytes);
    const int error = one_render(&context, &opened, &camera, &options, FXS_FORMAT_RGBA8, memory, bytes, packed,
                                 4 * WIDTH, 0);
    free(memory);
    return error;
}

/* Compares a view rendered from floats with the picture in doubles. Both must measure the same quality loss for each
   packing profile. */
static void check_view(fxs_float_scene *scene, const fxs_packed_scene profiles[3], const fxs_view *view,
                       int antialiased)
{
    const struct reference_options options = {.sh_degree = 3, .antialiased = antialiased};
    fxs_message m;
    CHECK(!reference_render(gaussians, COUNT, view, &options, linear));
    reference_to_rgba8(linear, WIDTH, HEIGHT, exact);
    if (!CHECK(!fxs_float_scene_draw(scene, view, FXS_CUTOFF_MAHALANOBIS, floats, &m)))
        return;
    if (!CHECK(psnr(exact, floats) > 64))
        printf("  the floats are %.1f dB from the doubles\n", psnr(exact, floats));
    for (int i = 0; i < 3; i++) {
        CHECK(!draw_packed(&profiles[i], view));
        if (!CHECK(fabs(psnr(packed, floats) - psnr(packed, exact)) < 0.5))
            printf("  profile %d: %.2f dB, not %.2f\n", i, psnr(packed, floats), psnr(packed, exact));
    }
}

static void check_scene(const char *name, int antialiased, float away)
{
    const fxs_procedural_scene *made = fxs_procedural_find(name);
    const fxs_gaussian_source source = {COUNT, made->sh_degree, antialiased, read_gaussians, gaussians, {0}};
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_packed_scene profiles[3] = {{0}};
    fxs_pack_report report;
    fxs_float_scene *scene = 0;
    fxs_view view;
    fxs_message m;
    for (int i = 0; i < COUNT; i++) {
        made->gaussian((uint64_t)i, COUNT, 1, &gaussians[i]);
        for (int k = 0; k < 3; k++)
            gaussians[i].position[k] += away;
    }
    if (!CHECK(!fxs_scene_file_open_gaussians(name, &source, 0, &file, &info, &m)))
        return;
    for (int i = 0; i < 3; i++)
        CHECK(!fxs_pack(file, &info, &profiles[i], &report, &(fxs_pack_options){.size = sizeof(fxs_pack_options),
                                                                                .profile = (enum fxs_profile)i}, &m));
    if (CHECK(!fxs_float_scene_read(&scene, file, &info, 0, 0, 1, &m)))
        for (int v = 0; v < VIEWS; v++)
            if (CHECK(!find_view(v, &report, &view)))
                check_view(scene, profiles, &view, antialiased);
    fxs_float_scene_free(scene);
    fxs_scene_file_close(file);
    for (int i = 0; i < 3; i++)
        fxs_packed_scene_free(&profiles[i]);
}

static void a_closed_scene(void)
{
    check_scene("knot", 0, 0);
}

static void antialiased_scenes(void)
{
    check_scene("knot", 1, 0);
    check_scene("landscape", 1, 0);
}

static void a_landscape(void)
{
    check_scene("landscape", 0, 0);
}

static void far_from_the_origin(void)
{
    check_scene("knot", 0, 1000);
}

static void what_is_left_out(void)
{
    const fxs_gaussian_source source = {3, 0, 0, read_gaussians, gaussians, {0}};
    fxs_gaussian *const g = gaussians;
    fxs_view view = {.width = 40, .height = 20, .fx = 50, .fy = 50, .cx = 20, .cy = 10,
                          .rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_float_scene *scene;
    fxs_message m;
    memset(g, 0, 3 * sizeof *g);
    for (int i = 0; i < 3; i++) {
        g[i].position[2] = 4;
        g[i].opacity = INFINITY;
        for (int k = 0; k < 3; k++)
            g[i].dc[k] = i == 1 ? -1.2f : 4;
        g[i].rotation[0] = (float)(i == 1);
    }
    g[1].opacity = 2;
    g[2].rotation[0] = NAN;
    if (!CHECK(!fxs_scene_file_open_gaussians("three", &source, 0, &file, &info, &m)) ||
        !CHECK(!fxs_float_scene_read(&scene, file, &info, 0, 0, 1, &m)))
        return;
    CHECK(!fxs_float_scene_draw(scene, &view, FXS_CUTOFF_MAHALANOBIS, floats, &m));
    const int level = (int)lrint(255 / (1 + exp(-2)) * (0.5 - 1.2 * 0.28209479177387814));
    CHECK(abs(floats[4 * (10 * 40 + 20)] - level) <= 1 && floats[3] == 255);
    view.width = 64;
    CHECK(!fxs_float_scene_draw(scene, &view, FXS_CUTOFF_MAHALANOBIS, floats, &m));
    CHECK(abs(floats[4 * (10 * 64 + 20)] - level) <= 1);
    view.fx = -1;
    CHECK(fxs_float_scene_draw(scene, &view, FXS_CUTOFF_MAHALANOBIS, floats, &m) == FXS_ERR_ARGUMENT);
    fxs_float_scene_free(scene);
    info.count = 2;
    CHECK(fxs_float_scene_read(&scene, file, &info, 0, 0, 1, &m) == FXS_ERR_FILE && !scene);
    fxs_scene_file_close(file);
}

/* Returns the PSNR between a rendered scene and a copy with all Gaussians moved by a millionth of a unit. */
static double psnr_of_nudge(const char *name)
{
    const fxs_procedural_scene *made = fxs_procedural_find(name);
    const fxs_gaussian_source source = {COUNT, made->sh_degree, 0, read_gaussians, gaussians, {0}};
    const double low[3] = {-2, -2, -2}, high[3] = {2, 2, 2}, up[3] = {0, -1, 0};
    fxs_view view;
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_float_scene *scene;
    fxs_message m;
    double difference = 0;
    for (int i = 0; i < COUNT; i++)
        made->gaussian((uint64_t)i, COUNT, 1, &gaussians[i]);
    CHECK(!fxs_view_frame_box(&view, low, high, up, &(fxs_picture){50, WIDTH, HEIGHT}, &m));
    if (!CHECK(!fxs_scene_file_open_gaussians(name, &source, 0, &file, &info, &m)))
        return 0;
    if (CHECK(!fxs_float_scene_read(&scene, file, &info, 0, 0, 1, &m))) {
        CHECK(!fxs_float_scene_draw(scene, &view, FXS_CUTOFF_MAHALANOBIS, exact, &m));
        fxs_float_scene_nudge(scene, 1e-6);
        CHECK(!fxs_float_scene_draw(scene, &view, FXS_CUTOFF_MAHALANOBIS, floats, &m));
        difference = psnr(exact, floats);
        fxs_float_scene_nudge(scene, 0);
        CHECK(!fxs_float_scene_draw(scene, &view, FXS_CUTOFF_MAHALANOBIS, floats, &m));
        CHECK(!memcmp(exact, floats, sizeof floats));
    }
    fxs_float_scene_free(scene);
    fxs_scene_file_close(file);
    return difference;
}

static void nudges_change_coincident_gaussians_alone(void)
{
    CHECK(psnr_of_nudge("layers") < 40);
    CHECK(psnr_of_nudge("knot") > 70);
}

int main(void)
{
    RUN(a_closed_scene);
    RUN(antialiased_scenes);
    RUN(a_landscape);
    RUN(far_from_the_origin);
    RUN(what_is_left_out);
    RUN(nudges_change_coincident_gaussians_alone);
    return check_report();
}
