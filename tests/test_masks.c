/* Tests masks of photographs: file names, masks through lenses and in smaller pictures, and refused masks. */
#include "photo_folder.h"

enum { WIDTH = 24, HEIGHT = 20, PIXELS = WIDTH * HEIGHT, VIEWS = 3 };

static const char *kept_name(const char *name)
{
    static char path[1024];
    snprintf(path, sizeof path, "%s", in_folder(name));
    return path;
}

static void put_grey(const char *name, int width, int height, const uint8_t *grey)
{
    static uint8_t rgb[3 * 4 * PIXELS];
    for (int i = 0; i < 3 * width * height; i++)
        rgb[i] = grey[i / 3];
    put_ppm(name, width, height, rgb);
}

static void draw(uint8_t grey[PIXELS], int seed)
{
    for (int i = 0; i < PIXELS; i++) {
        const int x = i % WIDTH - 9 - seed, y = i / WIDTH - 8;
        grey[i] = x * x + y * y < 20 || (i * 7 + seed) % 61 == 0 ? 0 : 255;
    }
}

static void put_set(const char *camera)
{
    static const char *const names[VIEWS] = {"a.jpg", "b.png", "sub/c.jpg"};
    say("1 %s\n", camera);
    put_text("m/cameras.txt");
    for (int i = 0; i < VIEWS; i++)
        say("%d 1 0 0 0 %d 0 0 1 %s\n\n", i, i, names[i]);
    put_text("m/images.txt");
    say("1 0 0 5 9 9 9 0\n");
    put_text("m/points3D.txt");
    for (int i = 0; i < VIEWS; i++) {
        char name[64];
        sprintf(name, "m/images/%s", names[i]);
        put_ppm(name, WIDTH, HEIGHT, NULL);
    }
}

static int are_masks(const uint8_t *const wanted[VIEWS])
{
    for (int i = 0; i < VIEWS; i++) {
        const uint8_t *mask = photos.fit[i].mask;
        if (!wanted[i] != !mask)
            return 0;
        for (int p = 0; p < PIXELS && mask; p++)
            if (mask[p] != (wanted[i][p] != 0))
                return 0;
    }
    return 1;
}

static uint8_t disc[2][PIXELS], inverse[2][PIXELS], white[PIXELS], black[PIXELS];

static void names(void)
{
    fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    const uint8_t *const of_two[VIEWS] = {disc[0], NULL, disc[1]};
    const uint8_t *const inverted[VIEWS] = {inverse[0], NULL, inverse[1]};
    const uint8_t *const nothing[VIEWS] = {NULL, NULL, NULL}, *const of_all[VIEWS] = {disc[1], disc[0], NULL};
    put_set("PINHOLE 24 20 25 25 12 10");
    CHECK(!read_photos("m", &options) && are_masks(nothing) && !photos.with_mask && !photos.without_mask);
    make_folder("m/masks");
    make_folder("m/masks/sub");
    put_grey("m/masks/a.jpg.png", WIDTH, HEIGHT, disc[0]);
    put_grey("m/masks/sub/c.png", WIDTH, HEIGHT, disc[1]);
    CHECK(!read_photos("m", &options) && are_masks(of_two) && photos.with_mask == 2 && photos.without_mask == 1);
    options.invert_masks = 1;
    CHECK(!read_photos("m", &options) && are_masks(inverted));
    options.masks = "";
    CHECK(!read_photos("m", &options) && are_masks(nothing) && !photos.with_mask && !photos.without_mask);
    make_folder("other");
    make_folder("other/sub");
    put_grey("other/a.jpg.png", WIDTH, HEIGHT, disc[1]);
    /* black mask that must be ignored, because the mask a.jpg.png takes precedence */
    put_grey("other/a.png", WIDTH, HEIGHT, black);
    put_grey("other/b.png", WIDTH, HEIGHT, disc[0]);
    put_grey("other/sub/c.png", WIDTH, HEIGHT, white);
    options = (fxs_photos_options){.size = sizeof(fxs_photos_options), .masks = kept_name("other"), .hold_out = 2};
    CHECK(!read_photos("m", &options) && photos.with_mask == 3 && photos.held_out_count == 2 &&
          photos.held_out[0].mask && !photos.held_out[1].mask && photos.fit[0].mask);
    options.hold_out = 0;
    CHECK(!read_photos("m", &options) && are_masks(of_all) && photos.with_mask == 3 && !photos.without_mask);
}

static void from_elsewhere(void)
{
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    const uint8_t *const wanted[VIEWS] = {disc[0], disc[1], NULL};
    make_folder("q");
    make_folder("q/images");
    make_folder("q/images2");
    make_folder("q/masks");
    make_folder("q/masks/2");
    say("1 PINHOLE 24 20 25 25 12 10\n");
    put_text("q/cameras.txt");
    say("1 1 0 0 0 0 0 0 1 ../images2/x.png\n\n2 1 0 0 0 0 0 0 1 %s\n\n3 1 0 0 0 0 0 0 1 z.png\n\n",
        in_folder("q/images2/y.png"));
    put_text("q/images.txt");
    say("1 0 0 5 9 9 9 0\n");
    put_text("q/points3D.txt");
    put_ppm("q/images2/x.png", WIDTH, HEIGHT, NULL);
    put_ppm("q/images2/y.png", WIDTH, HEIGHT, NULL);
    put_ppm("q/images/z.png", WIDTH, HEIGHT, NULL);
    put_grey("q/masks/x.png", WIDTH, HEIGHT, disc[0]);
    put_grey("q/masks/y.png", WIDTH, HEIGHT, disc[1]);
    put_grey("q/masks/2/y.png", WIDTH, HEIGHT, black);
    CHECK(!read_photos("q", &options) && are_masks(wanted));
}

static void greys(void)
{
    static const uint8_t colours[6][3] = {{128, 128, 128}, {127, 127, 127}, {255, 129, 0}, {255, 128, 0}, {0, 255, 255},
                                          {0, 0, 255}};
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    uint8_t rgb[3 * PIXELS];
    for (int i = 0; i < 3 * PIXELS; i++)
        rgb[i] = colours[i / 3 % 6][i % 3];
    put_ppm("m/masks/a.jpg.png", WIDTH, HEIGHT, rgb);
    if (CHECK(!read_photos("m", &options) && photos.fit[0].mask))
        for (int i = 0; i < PIXELS; i++)
            CHECK(photos.fit[0].mask[i] == (i % 6 % 2 == 0));
    put_grey("m/masks/a.jpg.png", WIDTH, HEIGHT, disc[0]);
}

/* Reduces photographs and their masks. A pixel of a reduced mask counts if all source pixels in it count. */
static void smaller(void)
{
    for (int resolution = 1; resolution <= WIDTH; resolution++) {
        const fxs_photos_options options = {.size = sizeof(fxs_photos_options), .resolution = resolution};
        if (!CHECK(!read_photos("m", &options)) || !CHECK(photos.fit[0].mask && photos.fit[2].mask))
            return;
        const int width = photos.fit[0].view.width, height = photos.fit[0].view.height;
        for (int i = 0; i < width * height; i++) {
            const int left = i % width * WIDTH, top = i / width * HEIGHT;
            int counts = 1;
            for (int p = 0; p < PIXELS; p++) {
                const int x = p % WIDTH * width, y = p / WIDTH * height;
                if (x < left + WIDTH && x + width > left && y < top + HEIGHT && y + height > top)
                    counts &= disc[0][p] != 0;
            }
            CHECK(photos.fit[0].mask[i] == counts);
        }
    }
}

/* Undistorts photographs and masks. Each photograph is its own mask. Pixels that count must be white, and
   ignored pixels must contain some black. */
static void lenses(void)
{
    static const char *const cameras[] = {"PINHOLE 24 20 25 25 12 10", "SIMPLE_RADIAL 24 20 25 12 10 -0.2",
                                          "OPENCV 24 20 25 26 12 10 -.1 .02 .003 -.004",
                                          "OPENCV_FISHEYE 24 20 20 20 12 10 .05 -.01 .002 .001"};
    for (int resolution = WIDTH; resolution >= 7; resolution -= 17)
        for (size_t k = 0; k < sizeof cameras / sizeof *cameras; k++) {
            const fxs_photos_options options = {.size = sizeof(fxs_photos_options), .resolution = resolution};
            int counts = 0, doubtful = 0;
            put_set(cameras[k]);
            put_grey("m/images/a.jpg", WIDTH, HEIGHT, disc[0]);
            if (!CHECK(!read_photos("m", &options)) || !CHECK(photos.fit[0].mask))
                return;
            const fxs_fit_photo *photo = &photos.fit[0];
            for (int i = 0; i < photo->view.width * photo->view.height; i++) {
                const int is_white = photo->pixels[3 * i] == 255;
                CHECK(is_white || !photo->mask[i]);
                counts += photo->mask[i];
                doubtful += is_white && !photo->mask[i];   /* counts ignored pixels that are white only by rounding */
            }
            if (!CHECK(counts > 0 && doubtful <= 5))
                printf("  %s, %d: %d count, %d doubtful\n", cameras[k], resolution, counts, doubtful);
        }
}

static void lens_of_almost_nothing(void)
{
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    const uint8_t *const wanted[VIEWS] = {disc[0], NULL, disc[1]};
    put_set("SIMPLE_RADIAL 24 20 25 12 10 1e-9");
    CHECK(!read_photos("m", &options) && photos.fit[0].view.width == WIDTH && are_masks(wanted));
}

static void bad_masks(void)
{
    fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    uint8_t dark[PIXELS];
    put_set("PINHOLE 24 20 25 25 12 10");
    put_grey("m/masks/a.jpg.png", WIDTH / 2, HEIGHT / 2, disc[0]);
    check_refused("m", &options, FXS_ERR_FILE, "masks/a.jpg.png: 12 x 10 pixels, its photograph ");
    CHECK(strstr(message.text, "images/a.jpg has 24 x 20") && strstr(message.text, "--skip-bad"));
    options.skip_bad = 1;
    CHECK(!read_photos("m", &options) && photos.fit_count == 2 && photos.skipped == 1);
    options.skip_bad = 0;
    put_file("m/masks/a.jpg.png", "P6\n24 20\n255\nxx", 15);
    check_refused("m", &options, FXS_ERR_FILE, "masks/a.jpg.png");
    memset(dark, 1, sizeof dark);                          /* a mask with the levels 0 and 1 instead of 0 and 255 */
    dark[7] = 0;
    put_grey("m/masks/a.jpg.png", WIDTH, HEIGHT, dark);
    check_refused("m", &options, FXS_ERR_FILE, "nothing is brighter than 1 of 255");
    put_grey("m/masks/a.jpg.png", WIDTH, HEIGHT, black);
    CHECK(!read_photos("m", &options) && photos.fit[0].mask && !memchr(photos.fit[0].mask, 1, PIXELS));
    put_grey("m/masks/b.png", WIDTH, HEIGHT, black);
    put_grey("m/masks/sub/c.png", WIDTH, HEIGHT, black);
    check_refused("m", &options, FXS_ERR_FILE, "all pixels of all photographs to fit are ignored");
    options.masks = kept_name("m/nothing");
    check_refused("m", &options, FXS_ERR_FILE, "m/nothing: no such folder of masks");
    options.masks = kept_name("m/images/a.jpg");
    options.skip_bad = 1;
    check_refused("m", &options, FXS_ERR_FILE, "a.jpg: no such folder of masks");
    make_folder("empty");
    options.masks = kept_name("empty");
    check_refused("m", &options, FXS_ERR_FILE, "it has a mask of none of the photographs; that of IMAGE.jpg is ");
    put_grey("m/masks/a.jpg.png", WIDTH, HEIGHT, disc[0]);
}

#ifdef FXS_WITH_CJSON

#define MATRIX "\"transform_matrix\":[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]"

/* Without mask_path in transforms.json, masks are in the folder "masks", with names without images/. */
static void transforms(void)
{
    fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    make_folder("n");
    make_folder("n/images");
    make_folder("n/masks");
    make_folder("n/shapes");
    put_ppm("n/images/a.jpg", WIDTH, HEIGHT, NULL);
    put_ppm("n/images/b.jpg", WIDTH, HEIGHT, NULL);
    put_ppm("n/images/c.jpg", WIDTH, HEIGHT, NULL);
    put_grey("n/shapes/1.png", WIDTH, HEIGHT, disc[0]);
    put_grey("n/masks/a.png", WIDTH, HEIGHT, white);
    put_grey("n/masks/b.png", WIDTH, HEIGHT, disc[1]);
    say("{\"fl_x\":25,\"w\":24,\"h\":20,\"frames\":[{\"file_path\":\"images/a.jpg\",\"mask_path\":\"./shapes/1.png\","
        MATRIX "},{\"file_path\":\"./images/b.jpg\"," MATRIX "},{\"file_path\":\"images/c\"," MATRIX "}]}");
    put_text("n/transforms.json");
    const uint8_t *const wanted[VIEWS] = {disc[1], disc[0], NULL}, *const of_folder[VIEWS] = {NULL, NULL, disc[0]};
    CHECK(!read_photos("n", &options) && are_masks(wanted) && photos.with_mask == 2 && photos.without_mask == 1);
    options.masks = kept_name("n/shapes");
    put_grey("n/shapes/c.png", WIDTH, HEIGHT, disc[0]);
    CHECK(!read_photos("n", &options) && are_masks(of_folder) && photos.with_mask == 1);
    options.masks = NULL;
    CHECK(!remove(in_folder("n/shapes/1.png")));
    check_refused("n", &options, FXS_ERR_FILE, "n/shapes/1.png");
}

#endif

#if defined(FXS_WITH_PNG) && defined(FXS_WITH_ZLIB)
#include <fixsplat/image.h>

/* Photographs with a mask and with alpha. A pixel counts only if both the mask and the alpha count it. */
static void alpha(void)
{
    fxs_photos_options options = {.size = sizeof(fxs_photos_options), .background = {9, 9, 9}};
    static uint8_t rgba[4 * PIXELS];
    for (int i = 0; i < 4 * PIXELS; i++)
        rgba[i] = (uint8_t)(i % 4 == 3 ? (i / 4 * 5) % 256 : 10 + i % 200);
    put_set("PINHOLE 24 20 25 25 12 10");
    CHECK(!fxs_image_file_write(in_folder("m/images/b.png"), rgba, WIDTH, HEIGHT, &message));
    options.masks = "";
    CHECK(!read_photos("m", &options) && !photos.fit[1].mask);
    options.ignore_transparent = 1;
    if (CHECK(!read_photos("m", &options) && photos.fit[1].mask && !photos.fit[0].mask && !photos.without_mask))
        for (int i = 0; i < PIXELS; i++) {
            const int counts = rgba[4 * i + 3] >= 128;
            CHECK(photos.fit[1].mask[i] == counts);
            CHECK(!counts || !memcmp(photos.fit[1].pixels + 3 * i, rgba + 4 * i, 3));
        }
    options.masks = NULL;
    put_grey("m/masks/b.png", WIDTH, HEIGHT, disc[0]);
    if (CHECK(!read_photos("m", &options) && photos.fit[1].mask))
        for (int i = 0; i < PIXELS; i++)
            CHECK(photos.fit[1].mask[i] == (rgba[4 * i + 3] >= 128 && disc[0][i]));
    for (int i = 0; i < 4 * PIXELS; i++)
        rgba[i] = (uint8_t)(i % 4 == 3 ? disc[1][i / 4] : 255);
    CHECK(!fxs_image_file_write(in_folder("m/masks/b.png"), rgba, WIDTH, HEIGHT, &message));
    options.ignore_transparent = 0;
    if (CHECK(!read_photos("m", &options) && photos.fit[1].mask))
        for (int i = 0; i < PIXELS; i++)
            CHECK(photos.fit[1].mask[i] == (disc[1][i] != 0));
}

#endif

static void tests(void)
{
    make_folder("m");
    make_folder("m/images");
    make_folder("m/images/sub");
    for (int k = 0; k < 2; k++) {
        draw(disc[k], 3 * k);
        for (int i = 0; i < PIXELS; i++)
            inverse[k][i] = (uint8_t)(255 - disc[k][i]);
    }
    memset(white, 255, sizeof white);
    RUN(names);
    RUN(from_elsewhere);
    RUN(greys);
    RUN(smaller);
    RUN(lenses);
    RUN(lens_of_almost_nothing);
    RUN(bad_masks);
#ifdef FXS_WITH_CJSON
    RUN(transforms);
#endif
#if defined(FXS_WITH_PNG) && defined(FXS_WITH_ZLIB)
    RUN(alpha);
#endif
    fxs_photos_free(&photos);
}

int main(void)
{
    return in_a_folder(tests);
}
