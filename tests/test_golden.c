/* Renders small frames and compares them with tests/golden/NAME.png byte for byte, by the CPU and each back end.
   --cuda: only CUDA. --update: writes the images. On a mismatch the frame and a difference picture go to
   build/golden. */
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <fixsplat/backend.h>
#include <fixsplat/camera.h>
#include <fixsplat/image.h>
#include "tools/command/metrics.h"
#include "check.h"
#include "one_scene.h"
#include "procedural_scene.h"

typedef struct golden {
    const char *name, *scene;
    uint64_t count;
    double eye[3], look[3], fov;
    int width, height;
    int antialiased;
    enum fxs_format format;
    fxs_options options;
} golden;

#define RGBA8 FXS_FORMAT_RGBA8
#define OPTIONS(of, degree, r, g, b) \
    {.size = sizeof(fxs_options), .cutoff = FXS_CUTOFF_##of, .sh_degree = degree, .background = {r, g, b}}

static const golden cases[] = {
    /* Tests projection and shading: SH degree 3 on an object. Tests blending: opaque surfaces, where pixels end
       early. */
    {"knot", "knot", 30000, {0.9, -2.6, -12.8}, {0, 0.42, 0}, 36, 240, 135, 0,
     RGBA8, OPTIONS(MAHALANOBIS, 3, 17, 19, 27)},
    /* Tests shading: SH of degree 1 only, from a scene with degree 3. */
    {"knot-degree1", "knot", 30000, {-6, -4, 9}, {0, 0.4, 0}, 40, 120, 90, 0, RGBA8, OPTIONS(MAHALANOBIS, 1, 0, 0, 0)},
    /* Tests tile lists and blending with the square cut-off of Kerbl et al. instead of the elliptical cut-off. */
    {"knot-square", "knot", 30000, {0.9, -2.6, -12.8}, {0, 0.42, 0}, 36, 120, 68, 0,
     RGBA8, OPTIONS(SQUARE, 3, 17, 19, 27)},
    /* Tests projection: opacity compensated for the dilation, Gaussians smaller than a pixel. */
    {"knot-antialiased", "knot", 30000, {3, -9, -40}, {0, 0, 0}, 20, 96, 64, 1,
     RGBA8, OPTIONS(MAHALANOBIS, 3, 40, 40, 40)},
    /* Tests projection: depths from near to far, culling at the edges. Tests sorting: 150,000 keys. */
    {"landscape", "landscape", 150000, {4.6, -1.9, -12.7}, {0, -2.2, 0}, 52, 256, 144, 0,
     RGBA8, OPTIONS(MAHALANOBIS, 3, 153, 189, 230)},
    /* Tests projection and tile lists: thin Gaussians of 1:1000 at all angles, thinner than a pixel. */
    {"needles", "needles", 20000, {0, -2, -11}, {0, 0, 0}, 50, 200, 150, 0, RGBA8, OPTIONS(MAHALANOBIS, 3, 25, 25, 30)},
    /* Tests blending: many translucent layers, small weights. Tests conversion to bytes: coverage, premultiplied
       alpha. */
    {"fog-coverage", "fog", 5000, {0, -1, -12}, {0, 0, 0}, 45, 160, 90, 0,
     FXS_FORMAT_RGBA8_COVERAGE, OPTIONS(MAHALANOBIS, 3, 0, 0, 0)},
    /* Tests sorting: splats of equal depth keep the scene's order. Tests blending: tiles that become opaque. */
    {"layers", "layers", 10000, {0, 0, -7}, {0, 0, 0}, 55, 128, 96, 0, RGBA8, OPTIONS(MAHALANOBIS, 0, 0, 0, 0)},
    /* Tests projection: Gaussians from below a pixel to larger than the picture, tiles cut by the picture's
       edge. */
    {"cubes", "cubes", 4096, {7, -5, -10}, {0, 0, 0}, 50, 173, 101, 0, RGBA8, OPTIONS(MAHALANOBIS, 3, 255, 255, 255)},
    /* Tests projection: camera inside the scene with a very wide view, near plane, clamped slopes x/z, huge
       Gaussians. */
    {"inside", "knot", 30000, {0.4, 0.3, 0.2}, {1.5, 0.9, 2}, 140, 160, 120, 0,
     RGBA8, OPTIONS(MAHALANOBIS, 3, 90, 60, 30)},
    /* Tests a picture of one pixel. */
    {"pixel", "fog", 500, {0, 0, -8}, {0, 0, 0}, 20, 1, 1, 0, RGBA8, OPTIONS(MAHALANOBIS, 2, 10, 200, 100)},
};

static int updating;
static const golden *current;
static const fxs_backend *backend;

static int draw(const fxs_scene *scene, const fxs_camera *camera, const golden *g, void *self, uint8_t *pixels,
                fxs_message *m)
{
    const fxs_object object = one_object(scene);
    const fxs_targets targets = one_target(g->format, pixels, (ptrdiff_t)camera->width * 4);
    const fxs_request request = request_for(&object, 1, &g->options, 1, camera, &targets);
    return backend->render(self, &request, 0, m);
}

static uint8_t *render(const golden *g, void *self, fxs_message *m)
{
    static const double up[3] = {0, -1, 0};
    fxs_packed_scene packed;
    fxs_scene scene;
    fxs_view view;
    fxs_camera camera;
    if (procedural_scene_make(g->scene, g->count, g->antialiased, &packed, 0, m))
        return 0;
    fxs_scene_open(&scene, packed.data, packed.bytes);
    uint8_t *pixels = malloc((size_t)g->width * (size_t)g->height * 4);
    int error = !pixels || fxs_view_look_at(&view, g->eye, g->look, up, &(fxs_picture){g->fov, g->width, g->height},
                                            m) ||
                fxs_camera_from_view(&camera, &view, m) || draw(&scene, &camera, g, self, pixels, m);
    fxs_packed_scene_free(&packed);
    if (!error)
        return pixels;
    free(pixels);
    return 0;
}

static void leave_pictures(const golden *g, const uint8_t *actual, const uint8_t *expected)
{
    char path[128];
    fxs_message m;
    struct fxs_metrics metrics;
    mkdir("build", 0777);
    mkdir("build/golden", 0777);
    snprintf(path, sizeof path, "build/golden/%s.png", g->name);
    fxs_image_file_write(path, actual, g->width, g->height, &m);
    if (expected && !fxs_metrics_compare(actual, expected, g->width, g->height, &metrics)) {
        printf("  %s: PSNR %.2f dB, SSIM %.5f, largest difference %d: see build/golden\n", g->name, metrics.psnr,
               metrics.ssim, metrics.largest);
        snprintf(path, sizeof path, "build/golden/%s-difference.png", g->name);
        fxs_metrics_difference(path, actual, expected, g->width, g->height, &m);
    }
}

static void compare(const golden *g, const uint8_t *actual, const char *path)
{
    fxs_message m;
    uint8_t *expected = 0;
    int width = 0, height = 0;
    if (!CHECK(!fxs_image_file_read(path, &expected, &width, &height, &m))) {
        puts(m.text);
        return;
    }
    int same_size = width == g->width && height == g->height;
    if (!CHECK(same_size && !memcmp(actual, expected, (size_t)width * (size_t)height * 4)))
        leave_pictures(g, actual, same_size ? expected : 0);
    free(expected);
}

static void golden_image(void)
{
    char path[128];
    fxs_message m = {.text = "render failed"};
    const fxs_backend_options options = {.size = sizeof(fxs_backend_options), .threads = 1, .without_cpu = ~0u};
    void *self;
    if (backend->open(&self, &options, &m))
        SKIP(m.text);
    uint8_t *actual = render(current, self, &m);
    snprintf(path, sizeof path, "tests/golden/%s.png", current->name);
    if (!CHECK(actual != 0))
        puts(m.text);
    else if (updating && backend == fxs_backend_at(0))
        CHECK(!fxs_image_file_write(path, actual, current->width, current->height, &m));
    else
        compare(current, actual, path);
    free(actual);
    backend->close(self);
}

static void by_backend(const fxs_backend *one)
{
    char device[256];
    fxs_message m;
    backend = one;
    if (backend->device(0, device, sizeof device, &m)) {
        printf("%s: %s\nskip %s\n", backend->name, m.text, backend->name);
        check_skipped++;
        return;
    }
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        current = &cases[i];
        printf("%s, %s: ", current->name, backend->name);
        RUN(golden_image);
    }
}

int main(int argc, char **argv)
{
    const char *only = argc > 1 && !strcmp(argv[1], "--cuda") ? "cuda" : 0;
    updating = argc > 1 && !strcmp(argv[1], "--update");
    for (int i = 0; fxs_backend_at(i); i++)
        if (!only || !strcmp(fxs_backend_at(i)->name, only))
            by_backend(fxs_backend_at(i));
    return check_report();
}
