/* Tests the near plane. A close view of an object must give an equal picture when the object is scaled together
   with its distance. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <fixsplat/camera.h>
#include <fixsplat/pack.h>
#include <fixsplat/internal/view_more.h>
#include "tools/command/metrics.h"
#include "tools/command/procedural.h"
#include "scene_writer.h"
#include "check.h"
#include "one_scene.h"
#include "reference.h"

enum { COUNT = 20000, WIDTH = 96, HEIGHT = 72, PIXELS = WIDTH * HEIGHT };

#define FLOOR 54.0   /* minimum PSNR in dB of the packed scene against the reference renderer in doubles */

static fxs_gaussian gaussians[COUNT];
static fxs_packed_scene packed;
static fxs_pack_report report;

static int make_knot(double size)
{
    char path[] = "/tmp/fixsplat-near-XXXXXX";
    fxs_message m;
    fxs_scene_writer *writer;
    fxs_scene_file *file;
    fxs_scene_file_info info;
    const fxs_procedural_scene *scene = fxs_procedural_find("knot");
    const int descriptor = mkstemp(path);
    for (int i = 0; i < COUNT; i++) {
        scene->gaussian((uint64_t)i, COUNT, 1, &gaussians[i]);
        for (int k = 0; k < 3; k++) {
            gaussians[i].position[k] = (float)(gaussians[i].position[k] * size);
            gaussians[i].scale[k] += (float)log(size);
        }
    }
    if (descriptor < 0 || close(descriptor) || open_writer("ply", path, COUNT, scene->sh_degree, 0, &writer, &m))
        return -1;
    int result = fxs_scene_writer_put(writer, gaussians, COUNT, &m);
    result = close_writer(writer, &m) || result || fxs_scene_file_open(path, NULL, &file, &info, &m) ? -1 : 0;
    if (!result) {
        result = fxs_pack(file, &info, &packed, &report, NULL, &m);
        fxs_scene_file_close(file);
    }
    unlink(path);
    return result;
}

static int render(const fxs_view *view, uint8_t *rgba)
{
    fxs_message m;
    fxs_scene scene;
    fxs_camera camera;
    fxs_context context;
    fxs_options options;
    fxs_context_init(&context, 0);
    fxs_options_init(&options);
    if (fxs_scene_open(&scene, packed.data, packed.bytes) || fxs_camera_from_view(&camera, view, &m))
        return -1;
    const size_t bytes = one_frame_bytes(&context, &scene, WIDTH, HEIGHT, 0);
    void *memory = check_aligned(bytes);
    const int error = one_render(&context, &scene, &camera, &options, FXS_FORMAT_RGBA8, memory, bytes, rgba,
                                 WIDTH * 4, 0);
    free(memory);
    return error;
}

static double mean_of(const uint8_t *rgba)
{
    double sum = 0;
    for (int i = 0; i < PIXELS * 4; i++)
        sum += i % 4 < 3 ? rgba[i] : 0;
    return sum / (3 * PIXELS);
}

static double psnr_of(const uint8_t *a, const uint8_t *b)
{
    struct fxs_metrics metrics;
    CHECK(!fxs_metrics_compare(a, b, WIDTH, HEIGHT, &metrics));
    return metrics.psnr;
}

static void check_size(double size, const uint8_t full[PIXELS * 4], uint8_t out[PIXELS * 4])
{
    static const double up[3] = {0, -1, 0}, place[3] = {0.5, -0.9, -3.6}, target[3] = {0.2, -0.2, 0};
    static double doubles[PIXELS * 3];
    static uint8_t expected[PIXELS * 4];
    const struct reference_options options = {REFERENCE_MAHALANOBIS, 3, 0, {0, 0, 0}};
    double eye[3], look[3];
    fxs_message m;
    fxs_view view;
    for (int i = 0; i < 3; i++) {
        eye[i] = place[i] * size;
        look[i] = target[i] * size;
    }
    if (!CHECK(!make_knot(size)) || !CHECK(!fxs_view_look_at(&view, eye, look, up, &(fxs_picture){60, WIDTH, HEIGHT},
                                                             &m)))
        return;
    view.near = 0.02 * size;
    const double near = fxs_near_of_box(report.inner_low, report.inner_high);
    CHECK(near > 0.05 * size && near < 0.1 * size);
    CHECK(!render(&view, out) && !reference_render(gaussians, COUNT, &view, &options, doubles));
    reference_to_rgba8(doubles, WIDTH, HEIGHT, expected);
    const double psnr = psnr_of(out, expected), same = full ? psnr_of(out, full) : INFINITY;
    printf("  %g of its size: %.1f dB against doubles, %.1f against the full size, mean %.1f\n", size, psnr, same,
           mean_of(out));
    CHECK(psnr >= FLOOR && same >= FLOOR && mean_of(out) > 20);
    fxs_packed_scene_free(&packed);
}

static void test_sizes_are_approached_alike(void)
{
    static uint8_t full[PIXELS * 4], small[PIXELS * 4];
    check_size(1, 0, full);
    check_size(0.1, full, small);
    check_size(0.01, full, small);
    check_size(0.0001, full, small);
}

static void test_sizes_are_framed_alike(void)
{
    static const double up[3] = {0, -1, 0}, sizes[] = {1, 0.1, 0.001};
    static uint8_t full[PIXELS * 4], small[PIXELS * 4];
    fxs_message m;
    fxs_view view;
    for (int i = 0; i < 3; i++) {
        if (!CHECK(!make_knot(sizes[i])) || !CHECK(!fxs_view_frame_box(&view, report.inner_low, report.inner_high, up,
                                                                       &(fxs_picture){50, WIDTH, HEIGHT}, &m)))
            return;
        CHECK(view.near > 0 && view.near <= 0.2);
        CHECK(!render(&view, i ? small : full));
        CHECK(mean_of(full) > 10 && (i == 0 || psnr_of(small, full) >= FLOOR));
        fxs_packed_scene_free(&packed);
    }
}

static void test_boxes_are_framed_whole(void)
{
    static const double boxes[][3] = {{1, 1, 1},       {0.1, 9, 0.1},      {9, 0.1, 9},
                                      {0.01, 0.01, 7}, {1e-5, 2e-5, 1e-5}, {5, 0, 0}};
    static const double ups[][3] = {{0, -1, 0}, {0, 0, 1}, {1, 2, 3}}, middle[3] = {3, -2, 1};
    for (int i = 0; i < 6 * 3 * 4; i++) {
        const double *half = boxes[i % 6], *up = ups[i / 6 % 3];
        double low[3], high[3], most = 0;
        fxs_message m;
        fxs_view view;
        for (int k = 0; k < 3; k++) {
            low[k] = middle[k] - half[k];
            high[k] = middle[k] + half[k];
        }
        CHECK(!fxs_view_frame_box(&view, low, high, up, &(fxs_picture){i / 18 % 2 ? 50 : 150, i / 36 ? 96 : 72, i / 36
                                                                       ? 72 : 96}, &m));
        for (int corner = 0; corner < 8; corner++) {
            double seen[3] = {0, 0, 0};
            for (int k = 0; k < 3; k++)
                for (int row = 0; row < 3; row++)
                    seen[row] += view.rotation[3 * row + k] * ((corner >> k & 1 ? high[k] : low[k]) - view.position[k]);
            CHECK(seen[2] > 2 * view.near);
            most = fmax(most,
                        fmax(fabs(seen[0]) * view.fx / view.width, fabs(seen[1]) * view.fy / view.height) / seen[2]);
        }
        CHECK(most < 0.5 && (most > 0.46 || i / 18 % 2 == 0));
    }
}

static void test_range(void)
{
    static const double origin[3] = {0, 0, 0}, ahead[3] = {0, 0, 1}, up[3] = {0, -1, 0};
    static const double bad[] = {-1, 0x1p-21, 0x1.1p28, INFINITY, NAN}, good[] = {0x1p-20, 0.2, 0x1p28};
    fxs_message m;
    fxs_view view;
    fxs_camera camera;
    CHECK(!fxs_view_look_at(&view, origin, ahead, up, &(fxs_picture){50, WIDTH, HEIGHT}, &m));
    CHECK(!fxs_camera_from_view(&camera, &view, &m) && camera.near_q32 == 0);
    for (int i = 0; i < 5; i++) {
        view.near = bad[i];
        CHECK(fxs_camera_from_view(&camera, &view, &m) == FXS_ERR_CAMERA && strstr(m.text, "near plane"));
    }
    for (int i = 0; i < 3; i++) {
        view.near = good[i];
        CHECK(!fxs_camera_from_view(&camera, &view, &m) && camera.near_q32 == (int64_t)(good[i] * 0x1p32 + 0.5));
    }
    CHECK(fxs_near_of_box(origin, origin) == 0.2 && fxs_near_of_box(origin, ahead) == 0.005);
}

int main(void)
{
    RUN(test_sizes_are_approached_alike);
    RUN(test_sizes_are_framed_alike);
    RUN(test_boxes_are_framed_whole);
    RUN(test_range);
    return check_report();
}
