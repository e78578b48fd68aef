/* Photographs must load to the same bytes on every machine. The test needs only libjpeg-turbo, so that it can be
   built for other processors. */
#include "jpeg_bytes.h"
#include "photo_folder.h"
#include "src/camera/lens_warp.h"
#include <fixsplat/system.h>

/* Expected hash of the pixels of all photographs. */
#define EXPECTED 0xac8c35eeu

#define EXPECTED_WARP 0x91768e01u

static uint32_t hash_of_view(uint32_t hash, const fxs_fit_photo *photo)
{
    const fxs_view *v = &photo->view;
    const double numbers[] = {v->fx, v->fy, v->cx, v->cy, v->position[0], v->position[1], v->position[2]};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        const float single = (float)numbers[i];
        uint32_t bits;
        memcpy(&bits, &single, 4);
        const uint8_t bytes[4] = {(uint8_t)bits, (uint8_t)(bits >> 8), (uint8_t)(bits >> 16), (uint8_t)(bits >> 24)};
        hash = hash_on(hash, bytes, 4);
    }
    return hash_on(hash, photo->pixels, 3 * (size_t)v->width * (size_t)v->height);
}

static uint32_t hash_of_photos(void)
{
    uint32_t hash = 2166136261u;
    for (size_t i = 0; i < photos.fit_count; i++)
        hash = hash_of_view(hash, &photos.fit[i]);
    for (size_t i = 0; i < photos.point_count; i++)
        for (int k = 0; k < 3; k++) {
            const int32_t fixed = (int32_t)(photos.points[i].position[k] * 65536);
            const uint8_t bytes[4] = {(uint8_t)fixed, (uint8_t)(fixed >> 8), (uint8_t)(fixed >> 16),
                                      (uint8_t)(fixed >> 24)};
            hash = hash_on(hash, bytes, 4);
        }
    return hash;
}

static void put_folder(void)
{
    static const char *const cameras[] = {
        "SIMPLE_RADIAL 48 40 50 24 20 -0.2", "RADIAL 24 20 25 12 10 0.1 0.05",
        "OPENCV 24 20 25 26 12 10 -.1 .02 .003 -.004",
        "OPENCV_FISHEYE 24 20 20 20 12 10 .05 -.01 .002 .001",
        "FULL_OPENCV 24 20 25 25 12 10 .1 .02 0 0 .01 .03 .02 .01",
        "PINHOLE 24 20 25 25 12 10"
    };
    make_folder("images");
    for (int i = 0; i < 6; i++)
        say("%d %s\n", i, cameras[i]);
    put_text("cameras.txt");
    for (int i = 0; i < 6; i++)
        say("%d 1 0.1 0.2 %d 0 0 %d %d %d.jpg\n\n", i, i, i, i, i);
    put_text("images.txt");
    for (int i = 0; i < 5; i++) {
        char name[32];
        sprintf(name, "images/%d.jpg", i);
        if (i & 1)
            put_file(name, progressive_jpeg, sizeof progressive_jpeg);
        else
            put_file(name, baseline_jpeg, sizeof baseline_jpeg);
    }
    put_ppm("images/5.jpg", JPEG_WIDTH, JPEG_HEIGHT, NULL);
}

static void same_bytes(void)
{
    fxs_photos_options options = {.size = sizeof(fxs_photos_options), .resolution = 17, .seed = 3};
    put_folder();
    for (uint32_t threads = 1; threads <= 3; threads++) {
        options.workers.run = threads == 1 ? NULL : fxs_pool_run;
        options.workers.pool = threads == 1 ? NULL : fxs_pool_create(threads);
        if (!CHECK(!read_photos("", &options))) {
            printf("  %s\n", message.text);
            return;
        }
        CHECK(photos.fit_count == 6 && photos.point_count == 100000 && photos.points_are_random);
        const uint32_t hash = hash_of_photos();
        if (!CHECK(hash == EXPECTED))
            printf("  0x%08x\n", (unsigned)hash);
        fxs_pool_destroy(options.workers.pool);
    }
    fxs_photos_free(&photos);
}

/* Warps a picture as a lens with distortion shows it, the reverse of undistortion. */
static void same_warps(void)
{
    static const fxs_lens lenses[] = {
        {.k = {-0.2, .05}, .p = {.01, -.02}, .skew = .01},
        {.kind = FXS_LENS_FISHEYE, .k = {.05}, .s = {.01, 0, .02, 0}}, {.kind = FXS_LENS_FOV, .k = {1.1}},
        {.kind = FXS_LENS_DIVISION, .k = {-.3}}, {.kind = FXS_LENS_EUCM, .k = {.6, 1}},
    };
    static const uint8_t outside[4] = {1, 2, 3, 4};
    static fxs_lens_warp warp;
    static uint8_t cover[4 * 100 * 84], out[4 * 24 * 20];
    const fxs_view view = {.width = 24, .height = 20, .fx = 17, .fy = 18, .cx = 11, .cy = 10.5};
    uint32_t hash = 2166136261u;
    for (size_t i = 0; i < sizeof cover; i++)
        cover[i] = (uint8_t)((uint32_t)i * 2654435761u >> 24);
    for (size_t i = 0; i < sizeof lenses / sizeof *lenses; i++) {
        fxs_lens lens = lenses[i];
        CHECK(fxs_lens_complete(&lens));
        fxs_lens_warp_make(&warp, &lens, &view);
        fxs_lens_warp_rows(&warp, cover, outside, out, 0, 20);
        hash = hash_on(hash, out, sizeof out);
    }
    if (!CHECK(hash == EXPECTED_WARP))
        printf("  0x%08xu\n", (unsigned)hash);
}

static void tests(void)
{
    RUN(same_warps);
#ifdef FXS_WITH_JPEG
    RUN(same_bytes);
#else
    puts("skipped: built without libjpeg-turbo");
    check_skipped++;
#endif
}

int main(void)
{
    return in_a_folder(tests);
}
