/* Tests photographs with their cameras: every folder layout, sizes, backgrounds, lenses, points, bad input, and real
   sets if present. */
#include "photo_folder.h"
#include "src/camera/camera_internal.h"
#include "src/fit/blocks.h"
#include <fixsplat/internal/fit_more.h>
#include <fixsplat/system.h>
#include <time.h>

enum { VIEWS = 9 };

#define SNOWMIKU_HASH 0xa49170f0u
#define LEGO_HASH 0xf7f298f0u

static void add_integer(uint64_t value, int count)
{
    for (int i = 0; i < count; i++)
        text[length++] = (char)(value >> 8 * i);
}

static void add_double(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, 8);
    add_integer(bits, 8);
}

/* Writes a COLMAP points3D.bin. Point i is at (i, 2 i, 5 + i) with colour (10 i, 0, 255). */
static void make_points_bin(uint64_t count)
{
    add_integer(count, 8);
    for (int i = 0; i < 3; i++) {
        add_integer((uint64_t)i + 7, 8);
        add_double(i);
        add_double(2 * i);
        add_double(5 + i);
        add_integer((uint64_t)(10 * i), 1);
        add_integer(0, 1);
        add_integer(255, 1);
        add_double(0.5);
        add_integer((uint64_t)i, 8);
        for (int k = 0; k < i; k++)
            add_integer(1, 8);
    }
}

static void put_colmap(int binary)
{
    if (binary) {
        add_integer(2, 8);
        for (int i = 0; i < 2; i++) {
            const double params[4] = {25, 26, 12, 10};
            add_integer((uint64_t)(i ? 5 : 3), 4);
            add_integer(1, 4);
            add_integer(24, 8);
            add_integer(20, 8);
            for (int k = 0; k < 4; k++)
                add_double(params[k]);
        }
        put_text("c/sparse/0/cameras.bin");
        add_integer(VIEWS, 8);
        for (int i = 0; i < VIEWS; i++) {
            const double pose[7] = {1, 0, 0, 0, i, 0, 0};
            add_integer((uint64_t)i, 4);
            for (int k = 0; k < 7; k++)
                add_double(pose[k]);
            add_integer(i % 2 ? 5 : 3, 4);
            say("sub/%d.ppm", VIEWS - 1 - i);
            add_integer(0, 1);
            add_integer(0, 8);
        }
        put_text("c/sparse/0/images.bin");
        make_points_bin(3);
        put_text("c/sparse/0/points3D.bin");
    } else {
        say("3 PINHOLE 24 20 25 26 12 10\n5 PINHOLE 24 20 25 26 12 10\n");
        put_text("c/sparse/0/cameras.txt");
        for (int i = 0; i < VIEWS; i++)
            say("%d 1 0 0 0 %d 0 0 %d sub/%d.ppm\n\n", i, i, i % 2 ? 5 : 3, VIEWS - 1 - i);
        put_text("c/sparse/0/images.txt");
        say("# points\n7 0 0 5 0 0 255 0.5\n8 1 2 6 10 0 255 0.5 1 2\n9 2 4 7 20 0 255 0.5 1 2 3 4\n");
        put_text("c/sparse/0/points3D.txt");
    }
}

static void make_colmap(void)
{
    make_folder("c");
    make_folder("c/sparse");
    make_folder("c/sparse/0");
    make_folder("c/images");
    make_folder("c/images/sub");
}

static void remove_file(const char *name)
{
    CHECK(!remove(in_folder(name)));
}

static void put_colmap_photos(void)
{
    for (int i = 0; i < VIEWS; i++) {
        char name[64];
        sprintf(name, "c/images/sub/%d.ppm", i);
        put_ppm(name, i % 2 ? 48 : 24, i % 2 ? 40 : 20, NULL);
    }
}

static void check_colmap(const char *name)
{
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options), .hold_out = 4};
    if (!CHECK(!read_photos(name, &options))) {
        printf("  %s\n", message.text);
        return;
    }
    CHECK(photos.fit_count == 6 && photos.held_out_count == 3 && photos.skipped == 0 && !photos.points_are_random);
    CHECK(!strcmp(photos.held_out[0].view.name, "sub/0.ppm") && !strcmp(photos.held_out[2].view.name, "sub/8.ppm"));
    CHECK(!strcmp(photos.fit[0].view.name, "sub/1.ppm") && !strcmp(photos.fit[5].view.name, "sub/7.ppm"));
    for (size_t i = 0; i < photos.fit_count; i++) {
        const fxs_view *v = &photos.fit[i].view;
        const int number = v->name[4] - '0', twice = number % 2 ? 2 : 1;
        CHECK(v->width == 24 * twice && v->height == 20 * twice && v->fx == 25 * twice && v->fy == 26 * twice &&
              v->cx == 12 * twice && v->cy == 10 * twice && v->position[0] == number - (VIEWS - 1));
    }
    CHECK(photos.point_count == 3);
    for (int i = 0; i < 3 && photos.point_count == 3; i++) {
        const fxs_fit_point *p = &photos.points[i];
        CHECK(p->position[0] == (float)i && p->position[1] == 2.0f * (float)i && p->position[2] == 5.0f + (float)i);
        CHECK(p->colour[0] == 10 * i && p->colour[1] == 0 && p->colour[2] == 255);
    }
}

static uint32_t hash_of_pixels(void)
{
    uint32_t hash = 2166136261u;
    for (size_t i = 0; i < photos.fit_count; i++)
        hash = hash_on(hash, photos.fit[i].pixels,
                       3 * (size_t)photos.fit[i].view.width * (size_t)photos.fit[i].view.height);
    return hash;
}

static void colmap(void)
{
    static const char *const names[] = {"c", "c/", "c/sparse/0", "c/sparse/0/images.bin", "c/sparse/0/points3D.bin",
                                        "c/sparse/0/.", "c/sparse/0/deep/..", "c/sparse/0/deep/../"};
    put_colmap_photos();
    make_folder("c/sparse/0/deep");
    put_colmap(0);
    check_colmap("c");
    check_colmap("c/sparse/0/cameras.txt");
    const uint32_t hash = hash_of_pixels();
    put_colmap(1);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        check_colmap(names[i]);
        CHECK(hash_of_pixels() == hash);
    }
    CHECK(!rmdir(in_folder("c/sparse/0/deep")));
    CHECK(!rename(in_folder("c/sparse/0"), in_folder("c/sparse/1")));
    CHECK(!rename(in_folder("c/sparse/1"), in_folder("c/model")));
    check_colmap("c/model");
    CHECK(!rmdir(in_folder("c/sparse")) && !rename(in_folder("c/model"), in_folder("c/sparse")));
    check_colmap("c");
    CHECK(!rename(in_folder("c/sparse"), in_folder("c/model")) && !mkdir(in_folder("c/sparse"), 0777) &&
          !rename(in_folder("c/model"), in_folder("c/sparse/0")));
    /* COLMAP 3.12 adds the files rigs.bin and frames.bin. The file images.bin still has all poses. */
    put_file("c/sparse/0/rigs.bin", "\1\0\0\0\0\0\0\0\1", 9);
    put_file("c/sparse/0/frames.bin", "", 0);
    check_colmap("c");
    remove_file("c/sparse/0/rigs.bin");
    remove_file("c/sparse/0/frames.bin");
}

/* Checks the random points of a set of photographs without points. fxs_photos_random_points must make the same
   points. */
static void check_random_points(const fxs_photos_options *options)
{
    fxs_message why;
    fxs_fit_point *points;
    size_t count;
    CHECK(!fxs_photos_random_points(photos.fit, photos.fit_count, options->seed, &points, &count, &why));
    CHECK(count == photos.point_count);
    for (size_t i = 0; i < count && !check_faults; i++)
        CHECK(!memcmp(points[i].position, photos.points[i].position, sizeof points->position) &&
              !memcmp(points[i].colour, photos.points[i].colour, sizeof points->colour));
    free(points);
    CHECK(fxs_photos_random_points(photos.fit, 0, 0, &points, &count, &why) == FXS_ERR_ARGUMENT && !points && !count);
}

static void bad_points(void)
{
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    make_points_bin(UINT64_MAX);
    put_text("c/sparse/0/points3D.bin");
    check_refused("c", &options, FXS_ERR_FILE, "points3D.bin: cut short");
    make_points_bin(3);
    memset(text + 8 + 8 + 6, 255, 2);   /* sets the coordinate x of the first point to NaN */
    put_text("c/sparse/0/points3D.bin");
    check_refused("c", &options, FXS_ERR_FILE, "points3D.bin: point 0 is not finite");
    for (int i = 0; i < 2; i++) {
        const double behind[3] = {i, 0, -5};
        add_integer(1, 8);
        add_integer(1, 8);
        for (int k = 0; k < 3; k++)
            add_double(behind[k]);
        add_integer(0, 3);
        add_integer(0, 8);
        add_integer(0, 8);
        put_text("c/sparse/0/points3D.bin");
        check_refused("c", &options, FXS_ERR_FILE, "points3D.bin: all of the 1 points lie behind every camera");
    }
    add_integer(0, 8);
    put_text("c/sparse/0/points3D.bin");
    CHECK(!read_photos("c", &options) && photos.points_are_random && photos.point_count == 100000);
    remove_file("c/sparse/0/points3D.bin");
    CHECK(!read_photos("c", &options) && photos.points_are_random && photos.point_count == 100000);
    /* The cameras stand on a line at x = -8 to 0. Random points must fill a cube of 24 units around the middle
       of the line. */
    double low[3] = {99, 99, 99}, high[3] = {-99, -99, -99};
    for (size_t i = 0; i < photos.point_count; i++)
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], (double)photos.points[i].position[k]);
            high[k] = fmax(high[k], (double)photos.points[i].position[k]);
        }
    for (int k = 0; k < 3; k++)
        CHECK(fabs(low[k] - ((k ? 0 : -4) - 12)) < 0.01 && fabs(high[k] - ((k ? 0 : -4) + 12)) < 0.01);
    check_random_points(&options);
    put_colmap(1);
    say("1 0 0\n");
    put_text("c/sparse/0/points3D.txt");
    CHECK(!remove(in_folder("c/sparse/0/images.bin")));
    check_refused("c", &options, FXS_ERR_FILE, "points3D.txt: point 0: not a number, a position and a colour");
    put_colmap(0);
    put_colmap(1);
}

static int stop(void *argument, double done)
{
    double *last = argument;
    CHECK(done > *last && done <= 1);
    *last = done;
    return done > 0.3;
}

static void left_out(void *argument, const char *why)
{
    char *all = argument;
    strcat(strcat(all, strrchr(why, '/')), "; ");
}

static void bad_photos(void)
{
    fxs_photos_options options = {.size = sizeof(fxs_photos_options), .hold_out = 4};
    remove_file("c/images/sub/5.ppm");
    check_refused("c", &options, FXS_ERR_FILE, "c/images/sub/5.ppm: No such file");
    CHECK(strstr(message.text, "c/sparse/0/images.bin; skip_bad, --skip-bad, leaves such out)") != NULL);
    put_file("c/images/sub/3.ppm", "P6\n48 40\n255\nshort", 18);
    put_file("c/images/sub/4.ppm", "nothing", 7);
    check_refused("c", &options, FXS_ERR_FILE, "c/images/sub/3.ppm: cut short");
    options.workers.run = fxs_pool_run;
    options.workers.pool = fxs_pool_create(3);
    check_refused("c", &options, FXS_ERR_FILE, "c/images/sub/3.ppm: cut short");
    char said[256] = "";
    options.skip_bad = 1;
    options.left_out = left_out;
    options.left_out_argument = said;
    CHECK(!read_photos("c", &options) && photos.skipped == 3 && photos.fit_count == 4 && photos.held_out_count == 2);
    CHECK(!strcmp(said, "/3.ppm: cut short; /5.ppm: No such file or directory; "
                        "/4.ppm: not a .png, .jpg, .webp, .heic or .ppm (P6); "));
    options.left_out = NULL;
    fxs_pool_destroy(options.workers.pool);
    options.workers.run = NULL;
    double done = 0;
    options.progress = (fxs_progress){stop, &done};
    check_refused("c", &options, FXS_ERR_STOPPED, "stopped");
    options.progress.call = NULL;
    options.hold_out = 1;
    check_refused("c", &options, FXS_ERR_FILE, "every photograph of 9 would be held out");
    options.hold_out = 0;
    for (int i = 0; i < VIEWS; i++) {
        char name[64];
        sprintf(name, "c/images/sub/%d.ppm", i);
        put_file(name, "", 0);
    }
    check_refused("c", &options, FXS_ERR_FILE, "none of 9 photographs can be read; of the last: ");
    put_colmap_photos();
    options.resolution = -1;
    check_refused("c", &options, FXS_ERR_ARGUMENT, "a resolution of -1");
}

static void proportions(void)
{
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    /* writes a photograph that has one row of pixels more than its camera states */
    put_ppm("c/images/sub/4.ppm", 24, 21, NULL);
    CHECK(!read_photos("c", &options) && photos.fit_count == 9);
    put_ppm("c/images/sub/4.ppm", 24, 30, NULL);
    check_refused("c", &options, FXS_ERR_FILE, "c/images/sub/4.ppm: 24 x 30 pixels, its camera has 24 x 20");
    put_ppm("c/images/sub/4.ppm", 12, 10, NULL);
    if (CHECK(!read_photos("c", &options)))
        CHECK(photos.fit[4].view.width == 12 && photos.fit[4].view.fx == 12.5 && photos.fit[4].view.cy == 5);
    put_ppm("c/images/sub/4.ppm", 24, 20, NULL);
}

static void missing_folders(void)
{
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    char name[5000];
    check_refused("missing", &options, FXS_ERR_FILE, "missing: No such file");
    make_folder("empty");
    check_refused("empty", &options, FXS_ERR_FILE, "empty: neither sparse/0");
    CHECK(!rename(in_folder("c/images"), in_folder("c/elsewhere")));
    check_refused("c", &options, FXS_ERR_FILE, "no folder images");
    CHECK(!rename(in_folder("c/elsewhere"), in_folder("c/images")));
    memset(name, 'n', sizeof name - 1);
    name[sizeof name - 1] = 0;
    CHECK(fxs_photos_read(name, &options, &photos, &message) == FXS_ERR_FILE &&
          strstr(message.text, "a name of 4999 characters"));
    add_integer(0, 8);
    put_text("c/sparse/0/images.bin");
    check_refused("c", &options, FXS_ERR_FILE, "no views");
    put_colmap(1);
}

/* A single camera that is held out for testing leaves no photograph to fit, which is refused. */
static void one_camera(void)
{
    static const uint8_t black[24 * 20 * 3];
    fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    make_folder("one");
    make_folder("one/images");
    put_ppm("one/images/a.ppm", 24, 20, black);
    say("1 PINHOLE 24 20 25 25 12 10\n");
    put_text("one/cameras.txt");
    say("1 1 0 0 0 0 0 0 1 a.ppm\n\n");
    put_text("one/images.txt");
    if (CHECK(!read_photos("one", &options)))
        CHECK(photos.fit_count == 1 && photos.point_count == 100000 && !photos.held_out_count);
    for (size_t i = 0; i < photos.point_count; i++)
        for (int k = 0; k < 3; k++)
            if (!CHECK(fabs((double)photos.points[i].position[k]) <= 1.5))
                return;
    options.hold_out = 8;
    check_refused("one", &options, FXS_ERR_FILE, "every photograph of 1 would be held out");
}

/* Divides a line into `from` and into `to` equal parts. Returns the overlap of part i of `from` and part j of
   `to`, in units of 1 / (from * to). */
static int64_t shared(int64_t i, int64_t j, int64_t from, int64_t to)
{
    const int64_t low = i * to > j * from ? i * to : j * from;
    const int64_t high = (i + 1) * to < (j + 1) * from ? (i + 1) * to : (j + 1) * from;
    return high > low ? high - low : 0;
}

static void check_average(const uint8_t *rgb, int width, int height, int resolution)
{
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options), .resolution = resolution};
    put_ppm("one/images/a.ppm", width, height, rgb);
    say("1 PINHOLE %d %d 25 50 12 10\n", width, height);
    put_text("one/cameras.txt");
    if (!CHECK(!read_photos("one", &options)))
        return;
    const fxs_view *v = &photos.fit[0].view;
    const int longer = width > height ? width : height;
    const double factor = longer > resolution ? (double)resolution / longer : 1;
    CHECK((v->width > v->height ? v->width : v->height) == (longer > resolution ? resolution : longer));
    CHECK(fabs(v->width - width * factor) <= 0.5 && (v->height == 1 || fabs(v->height - height * factor) <= 0.5));
    CHECK(v->fx == 25.0 * ((double)v->width / width) && v->fy == 50.0 * ((double)v->height / height));
    CHECK(v->cx == 12.0 * ((double)v->width / width) && v->cy == 10.0 * ((double)v->height / height));
    for (int y = 0; y < v->height; y++)
        for (int x = 0; x < 3 * v->width; x++) {
            int64_t sum = 0, area = (int64_t)width * height;
            for (int j = 0; j < height; j++)
                for (int i = 0; i < width; i++)
                    sum += rgb[3 * (j * width + i) + x % 3] * shared(i, x / 3, width, v->width) *
                           shared(j, y, height, v->height);
            if (!CHECK(photos.fit[0].pixels[3 * y * v->width + x] == (2 * sum + area) / (2 * area)))
                return;
        }
}

static void averages(void)
{
    static const int sizes[][3] = {{37, 23, 10}, {23, 37, 36}, {24, 20, 12}, {24, 20, 24}, {24, 20, 100}, {40, 1, 7},
                                   {8, 8, 1}, {31, 17, 30}};
    uint8_t rgb[3 * 40 * 40];
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        for (size_t k = 0; k < sizeof rgb; k++)
            rgb[k] = (uint8_t)random_number();
        check_average(rgb, sizes[i][0], sizes[i][1], sizes[i][2]);
    }
}

enum { WIDE = 160, HIGH = 120 };

static double scene(double x, double y, int c)
{
    return 128 + 50 * sin(4 * x + c) + 50 * cos(3 * y - 2 * x + 2 * c);
}

/* Inverts a lens formula by Newton's method: finds the undistorted point of the point x, y. */
static void straighten(const fxs_lens *lens, double x, double y, double out[2])
{
    const double step = 1e-6;
    double at[2] = {x, y};
    for (int i = 0; i < 50; i++) {
        double bent[2], right[2], below[2];
        fxs_lens_bend(lens, at[0], at[1], bent);
        fxs_lens_bend(lens, at[0] + step, at[1], right);
        fxs_lens_bend(lens, at[0], at[1] + step, below);
        const double a = (right[0] - bent[0]) / step, b = (below[0] - bent[0]) / step;
        const double c = (right[1] - bent[1]) / step, d = (below[1] - bent[1]) / step;
        const double u = x - bent[0], v = y - bent[1], determinant = a * d - b * c;
        at[0] += (d * u - b * v) / determinant;
        at[1] += (a * v - c * u) / determinant;
    }
    out[0] = at[0];
    out[1] = at[1];
}

static const struct {
    const char *model;
    fxs_lens lens;                 /* lens parameters that the COLMAP camera model in `model` should give */
    double fx, fy, cx, cy;
    int widens;                    /* 1: the undistorted picture shows more than the photograph, 0: it shows less */
} lenses[] = {
    {"SIMPLE_RADIAL 160 120 140 80 60 -0.15", {.k = {-0.15}}, 140, 140, 80, 60, 1},
    {"SIMPLE_RADIAL 160 120 140 80 60 0.2", {.k = {0.2}}, 140, 140, 80, 60, 0},
    {"OPENCV 160 120 140 140 80 60 0 0 0 0.05", {.k = {0}, .p = {0, 0.05}}, 140, 140, 80, 60, 0},
    {"RADIAL 160 120 140 83 58 -0.2 0.05", {.k = {-0.2, 0.05}}, 140, 140, 83, 58, 1},
    {"OPENCV 160 120 140 150 80 60 -0.2 0.05 0.01 -0.02", {.k = {-0.2, 0.05}, .p = {0.01, -0.02}}, 140, 150, 80, 60, 1},
    {"FULL_OPENCV 160 120 140 140 80 60 0.1 -.05 .002 .001 .02 .3 .04 .01",
     {.k = {0.1, -.05, .02}, .d = {.3, .04, .01}, .p = {.002, .001}}, 140, 140, 80, 60, 1},
    {"OPENCV_FISHEYE 160 120 100 100 80 60 .05 -.01 .002 -.001", {.kind = FXS_LENS_FISHEYE,
                                                                  .k = {.05, -.01, .002, -.001}},
     100, 100, 80, 60, 1},
    {"OPENCV_FISHEYE 160 120 100 100 80 60 0 0 0 0", {.kind = FXS_LENS_FISHEYE, .k = {0}}, 100, 100, 80, 60, 1},
    {"RADIAL_FISHEYE 160 120 100 80 60 .05 -.01", {.kind = FXS_LENS_FISHEYE, .k = {.05, -.01}}, 100, 100, 80, 60, 1},
    {"SIMPLE_RADIAL_FISHEYE 160 120 100 80 60 .05", {.kind = FXS_LENS_FISHEYE, .k = {.05}}, 100, 100, 80, 60, 1},
    {"FISHEYE 160 120 100 105 80 60", {.kind = FXS_LENS_FISHEYE, .k = {0}}, 100, 105, 80, 60, 1},
    {"SIMPLE_FISHEYE 160 120 100 80 60", {.kind = FXS_LENS_FISHEYE, .k = {0}}, 100, 100, 80, 60, 1},
    {"THIN_PRISM_FISHEYE 160 120 100 100 80 60 .05 -.01 .01 -.02 .002 -.001 .03 -.04", {.kind = FXS_LENS_FISHEYE,
     .k = {.05, -.01, .002, -.001}, .p = {.01, -.02}, .s = {.03, 0, -.04, 0}}, 100, 100, 80, 60, 1},
    {"RAD_TAN_THIN_PRISM_FISHEYE 160 120 100 100 80 60 .05 -.01 .002 -.001 .0005 -.0002 .02 -.01 .01 .02 -.03 .004",
     {.kind = FXS_LENS_FISHEYE_AFTER, .k = {.05, -.01, .002, -.001, .0005, -.0002}, .p = {-.01, .02},
      .s = {.01, .02, -.03, .004}}, 100, 100, 80, 60, 1},
    {"FOV 160 120 140 140 80 60 0.9", {.kind = FXS_LENS_FOV, .k = {.9}}, 140, 140, 80, 60, 0},
    {"FOV 160 120 140 140 80 60 -0.9", {.kind = FXS_LENS_FOV, .k = {-.9}}, 140, 140, 80, 60, 0},
    {"SIMPLE_DIVISION 160 120 140 80 60 -.2", {.kind = FXS_LENS_DIVISION, .k = {-.2}}, 140, 140, 80, 60, 1},
    {"DIVISION 160 120 140 150 80 60 -.2", {.kind = FXS_LENS_DIVISION, .k = {-.2}}, 140, 150, 80, 60, 1},
    {"EUCM 160 120 140 150 80 60 .6 1.1", {.kind = FXS_LENS_EUCM, .k = {.6, 1.1}}, 140, 150, 80, 60, 1},
};
enum { LENSES = sizeof lenses / sizeof *lenses };

static fxs_lens lens_of(size_t number)
{
    fxs_lens lens = lenses[number].lens;
    CHECK(fxs_lens_complete(&lens));
    return lens;
}

/* Distorts a point by the lens formulas of OpenCV ("Camera Calibration and 3D Reconstruction") and of COLMAP
   (src/colmap/sensor/models.h). */
static void bend_plainly(const fxs_lens *l, double x, double y, double out[2])
{
    const double r = sqrt(x * x + y * y), t = atan(r), *k = l->k, *p = l->p, *s = l->s;
    const double radial = (1 + k[0] * pow(r, 2) + k[1] * pow(r, 4) + k[2] * pow(r, 6) + k[3] * pow(r, 8)) /
                          (1 + l->d[0] * pow(r, 2) + l->d[1] * pow(r, 4) + l->d[2] * pow(r, 6));
    const double theta = t + k[0] * pow(t, 3) + k[1] * pow(t, 5) + k[2] * pow(t, 7) + k[3] * pow(t, 9) +
                         k[4] * pow(t, 11) + k[5] * pow(t, 13);
    double by = 0, u = x, v = y;
    switch (l->kind) {
    case FXS_LENS_BROWN: by = radial; break;
    case FXS_LENS_FISHEYE: u = x * t / r, v = y * t / r, by = theta / t; break;
    case FXS_LENS_FISHEYE_AFTER: u = x * theta / r, v = y * theta / r, by = 1; break;
    case FXS_LENS_FOV: by = atan(2 * r * tan(k[0] / 2)) / (r * k[0]); break;
    case FXS_LENS_DIVISION: by = (1 - sqrt(1 - 4 * k[0] * r * r)) / (2 * k[0] * r * r); break;
    case FXS_LENS_EUCM: by = 1 / (k[0] * sqrt(k[1] * r * r + 1) + 1 - k[0]); break;
    }
    const double q = u * u + v * v;
    out[0] = u * by + 2 * p[0] * u * v + p[1] * (q + 2 * u * u) + s[0] * q + s[1] * q * q;
    out[1] = v * by + p[0] * (q + 2 * v * v) + 2 * p[1] * u * v + s[2] * q + s[3] * q * q;
    out[0] += l->skew * out[1];
}

static void lens_formulas(void)
{
    for (size_t i = 0; i < LENSES; i++)
        for (int k = 0; k < 1000; k++) {
            const double x = random_number() / 30000.0 - 1.1, y = random_number() / 30000.0 - 1.1;
            double plain[2], bent[2];
            fxs_lens lens = lens_of(i);
            lens.skew = k % 2 ? 0.03 : 0;
            bend_plainly(&lens, x, y, plain);
            fxs_lens_bend(&lens, x, y, bent);
            if (!CHECK(fabs(plain[0] - bent[0]) < 1e-14 && fabs(plain[1] - bent[1]) < 1e-14))
                printf("  %s: %.17g, %.17g at %g, %g\n", lenses[i].model, plain[0] - bent[0], plain[1] - bent[1], x, y);
        }
    fxs_lens brown = {.k = {.1, .2, -.3, .4}};
    double plain[2], bent[2];
    bend_plainly(&brown, .3, .4, plain);
    fxs_lens_bend(&brown, .3, .4, bent);
    CHECK(fabs(plain[0] - bent[0]) < 1e-14 && fabs(plain[1] - bent[1]) < 1e-14);
}

static void check_lens(size_t number)
{
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    static uint8_t rgb[3 * WIDE * HIGH];
    const fxs_lens lens = lens_of(number);
    for (int i = 0; i < WIDE * HIGH; i++) {
        double at[2];
        straighten(&lens, (i % WIDE + 0.5 - lenses[number].cx) / lenses[number].fx,
                   (i / WIDE + 0.5 - lenses[number].cy) / lenses[number].fy, at);
        for (int c = 0; c < 3; c++)
            rgb[3 * i + c] = (uint8_t)(scene(at[0], at[1], c) + 0.5);
    }
    put_ppm("one/images/a.ppm", WIDE, HIGH, rgb);
    say("1 %s\n", lenses[number].model);
    put_text("one/cameras.txt");
    if (!CHECK(!read_photos("one", &options))) {
        printf("  %s\n", message.text);
        return;
    }
    const fxs_view *v = &photos.fit[0].view;
    double worst = 0;
    CHECK(v->width == WIDE && v->height == HIGH && v->cx == lenses[number].cx && v->cy == lenses[number].cy);
    if (!CHECK(lenses[number].widens == (v->fx < lenses[number].fx) && v->fx != lenses[number].fx))
        printf("  %s: %g\n", lenses[number].model, v->fx);
    CHECK(fabs(v->fy / v->fx - lenses[number].fy / lenses[number].fx) < 1e-12);
    for (int i = 0; i < WIDE * HIGH; i++)
        for (int c = 0; c < 3; c++) {
            const double expected = scene((i % WIDE + 0.5 - v->cx) / v->fx, (i / WIDE + 0.5 - v->cy) / v->fy, c);
            worst = fmax(worst, fabs(photos.fit[0].pixels[3 * i + c] - expected));
        }
    if (!CHECK(worst < 3))
        printf("  lens %zu: %g\n", number, worst);
}

static void lens_models(void)
{
    for (size_t i = 0; i < LENSES; i++)
        check_lens(i);
}

static void lens_limits(void)
{
    static uint8_t rgb[3 * WIDE * HIGH];
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    for (size_t i = 0; i < sizeof rgb; i++)
        rgb[i] = (uint8_t)random_number();
    put_ppm("one/images/a.ppm", WIDE, HIGH, rgb);
    say("1 OPENCV 160 120 140 140 80 60 0 0 0 0\n");
    put_text("one/cameras.txt");
    if (CHECK(!read_photos("one", &options)))
        CHECK(!memcmp(photos.fit[0].pixels, rgb, sizeof rgb) && photos.fit[0].view.fx == 140);
    say("1 SIMPLE_RADIAL 160 120 140 80 60 -9\n");
    put_text("one/cameras.txt");
    check_refused("one", &options, FXS_ERR_FILE, "one/images/a.ppm: the distortion of its camera cannot be undone");
}

static void put_lens(const char *camera)
{
    static uint8_t grey[3 * WIDE * HIGH];
    memset(grey, 128, sizeof grey);
    put_ppm("one/images/a.ppm", WIDE, HIGH, grey);
    say("1 %s\n", camera);
    put_text("one/cameras.txt");
}

/* Undistorts pictures with a field of view of 180 degrees and more. They are cropped at 60 degrees from the
   axis. */
static void lens_widest(void)
{
    static const char *const cameras[] = {"FISHEYE 160 120 45 45 80 60", "FISHEYE 160 120 20 20 80 60",
                                          "EUCM 160 120 40 40 80 60 .6 1.1", "FOV 160 120 50 50 80 60 1.5"};
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    for (size_t i = 0; i < sizeof cameras / sizeof *cameras; i++) {
        put_lens(cameras[i]);
        if (!CHECK(!read_photos("one", &options)))
            printf("  %s\n", message.text);
        else
            CHECK(fabs(80 / photos.fit[0].view.fx - sqrt(3)) < 1e-12);
    }
    put_lens("FISHEYE 160 120 45 45 100 60");
    if (CHECK(!read_photos("one", &options)))
        CHECK(fabs(100 / photos.fit[0].view.fx - sqrt(3)) < 1e-12 && photos.fit[0].view.cx == 100);
    put_lens("FISHEYE 160 120 20 60 80 60");
    if (CHECK(!read_photos("one", &options)))
        CHECK(fabs(80 / photos.fit[0].view.fx - sqrt(3)) < 1e-12 &&
              fabs(photos.fit[0].view.fy / photos.fit[0].view.fx - 3) < 1e-12);
}

static void lens_faults(void)
{
    static const char *const cameras[] = {"FOV 160 120 50 50 80 60 3.2", "FOV 160 120 50 50 80 60 1e300",
                                          "EUCM 160 120 40 40 80 60 1.1 1", "EUCM 160 120 40 40 80 60 .5 0",
                                          "EUCM 160 120 40 40 80 60 -.1 1"};
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    for (size_t i = 0; i < sizeof cameras / sizeof *cameras; i++) {
        put_lens(cameras[i]);
        check_refused("one", &options, FXS_ERR_FILE,
                      "camera 1: a coefficient of its lens is not a finite number, or out of its range");
    }
    put_lens("DIVISION 160 120 40 40 80 60 9");
    check_refused("one", &options, FXS_ERR_FILE, "the distortion of its camera cannot be undone");
    put_lens("FOV 160 120 140 140 80 60 0");
    CHECK(!read_photos("one", &options) && photos.fit[0].view.fx == 140);
    put_lens("SIMPLE_DIVISION 160 120 140 80 60 0");
    CHECK(!read_photos("one", &options) && photos.fit[0].view.fx == 140);
    put_lens("EQUIRECTANGULAR 160 80 160 80");
    check_refused("one", &options, FXS_ERR_FILE, "a camera model that is not known here");
}

#ifdef FXS_WITH_CJSON

#define MATRIX "\"transform_matrix\":[[1,0,0,%d],[0,1,0,0],[0,0,1,4],[0,0,0,1]]"

static void say_frames(const char *top, const char *format, int count)
{
    say("{%s\"frames\":[", top);
    for (int i = 0; i < count; i++) {
        say("%s{\"file_path\":\"", i ? "," : "");
        say(format, i);
        say("\"," MATRIX "}", i);
    }
    say("]}");
}

static void blender(void)
{
    fxs_photos_options options = {.size = sizeof(fxs_photos_options), .hold_out = 8, .seed = 1};
    make_folder("b");
    make_folder("b/train");
    make_folder("b/test");
    for (int i = 0; i < 3; i++) {
        char name[64];
        sprintf(name, "b/train/r_%d.png", i);
        put_ppm(name, 24, 20, NULL);
        sprintf(name, "b/test/r_%d.png", i);
        put_ppm(name, 12, 12, NULL);
    }
    say_frames("\"camera_angle_x\":1.0,", "./train/r_%d", 3);
    put_text("b/transforms_train.json");
    say_frames("\"camera_angle_x\":1.0,", "./test/r_%d", 2);
    put_text("b/transforms_test.json");
    if (!CHECK(!read_photos("b", &options))) {
        printf("  %s\n", message.text);
        return;
    }
    const fxs_view *v = &photos.fit[1].view, *held = &photos.held_out[0].view;
    CHECK(photos.fit_count == 3 && photos.held_out_count == 2 && photos.points_are_random);
    CHECK(v->width == 24 && v->height == 20 && fabs(v->fx - 12 / tan(0.5)) < 1e-12 && v->fy == v->fx && v->cx == 12 &&
          v->cy == 10 && v->position[0] == 1);
    CHECK(held->width == 12 && held->height == 12 && fabs(held->fx - 6 / tan(0.5)) < 1e-12);
    CHECK(photos.point_count == 100000);
    float least = 0, most = 0;
    for (size_t i = 0; i < photos.point_count; i++)
        for (int k = 0; k < 3; k++) {
            least = fminf(least, photos.points[i].position[k]);
            most = fmaxf(most, photos.points[i].position[k]);
        }
    CHECK(least >= -1.3f && least < -1.299f && most <= 1.3f && most > 1.299f && photos.points[5].colour[1] == 128);
    const float x = photos.points[0].position[0];
    fxs_fit_block block;
    if (CHECK(!fxs_fit_block_read(in_folder("b"), &options, NULL, 1, 1, &block, &message) && block.photos.fit_count))
        fxs_fit_block_free(&block);
    char said[256] = "";
    options.left_out = left_out;
    options.left_out_argument = said;
    put_file("b/train/note.txt", "nothing", 7);
    CHECK(!read_photos("b", &options) && !*said);
    put_ppm("b/train/z.JPG", 9, 9, NULL);
    put_ppm("b/train/r_7.png", 9, 9, NULL);
    CHECK(!read_photos("b", &options) && photos.fit_count == 3 && photos.skipped == 0);
    CHECK(!strcmp(said, "/train: 2 photographs have no camera: r_7.png, z.JPG; "));
    remove_file("b/train/note.txt");
    remove_file("b/train/z.JPG");
    remove_file("b/train/r_7.png");
    options.left_out = NULL;
    options.seed = 2;
    CHECK(!read_photos("b", &options) && photos.points[0].position[0] != x);
    options.seed = 1;
    CHECK(!read_photos("b/transforms_train.json", &options) && photos.points[0].position[0] == x &&
          photos.held_out_count == 2);
    CHECK(!read_photos("b/transforms_test.json", &options) && photos.fit_count == 1 && photos.held_out_count == 1);
    remove_file("b/test/r_1.png");
    check_refused("b", &options, FXS_ERR_FILE, "b/test/r_1: No such file");
    CHECK(strstr(message.text, "b/transforms_test.json; skip_bad, --skip-bad, leaves such out)") != NULL);
    options.hold_out = 0;
    CHECK(!read_photos("b", &options) && photos.fit_count == 3 && photos.held_out_count == 0);
    options.hold_out = 2;
    CHECK(!rename(in_folder("b/transforms_test.json"), in_folder("b/transforms_val.json")));
    put_ppm("b/test/r_1.png", 12, 12, NULL);
    CHECK(!read_photos("b", &options) && photos.fit_count == 3 && photos.held_out_count == 2);
    say_frames("\"camera_angle_x\":1.0,\"test_filenames\":[\"train/r_1\"],", "./train/r_%d", 3);
    put_text("b/transforms_train.json");
    CHECK(!read_photos("b", &options) && photos.fit_count == 2 && photos.held_out_count == 1);
    say_frames("\"camera_angle_x\":1.0,", "./train/r_%d", 3);
    put_text("b/transforms_train.json");
    remove_file("b/transforms_val.json");
    CHECK(!read_photos("b", &options) && photos.fit_count == 1 && photos.held_out_count == 2);
}

static uint32_t hash_of_all(void)
{
    uint32_t hash = hash_of_pixels();
    for (size_t i = 0; i < photos.fit_count; i++) {
        const fxs_fit_photo *p = &photos.fit[i];
        hash = hash_on(hash, p->view.name, strlen(p->view.name) + 1);
        if (p->mask)
            hash = hash_on(hash, p->mask, (size_t)p->view.width * (size_t)p->view.height);
    }
    return hash_on(hash, photos.points, photos.point_count * sizeof *photos.points);
}

static void say_windows(const char *slash, const char *ending)
{
    say("{\"w\":24,\"h\":20,\"fl_x\":20,\"ply_file_path\":\".%sa%sp.ply\",\"frames\":[", slash, slash);
    for (int i = 0; i < 3; i++)
        say("%s{\"file_path\":\"%s%s%d%s\",\"mask_path\":\"a%sm.ppm\"," MATRIX "}", i ? "," : "",
            i == 1 ? "a0" : "a", slash, i, ending, slash, i);
    say("]}");
    put_text("w/transforms.json");
}

/* Photographs whose names have \ for / must keep the same order. Bytewise, "a0/1" comes after "a/0", but "a0\1"
   comes before "a\0". */
static void names_of_windows(void)
{
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    uint8_t mask[3 * 24 * 20];
    for (int i = 0; i < 3 * 24 * 20; i++)
        mask[i] = i / 3 % 24 < 9 ? 255 : 0;
    make_folder("w");
    make_folder("w/a");
    make_folder("w/a0");
    put_ppm("w/a/0.ppm", 24, 20, NULL);
    put_ppm("w/a0/1.ppm", 24, 20, NULL);
    put_ppm("w/a/2.ppm", 24, 20, NULL);
    put_ppm("w/a/m.ppm", 24, 20, mask);
    say("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
        "end_header\n1 2 3\n");
    put_text("w/a/p.ply");
    say_windows("/", ".ppm");
    if (!CHECK(!read_photos("w", &options) && photos.fit_count == 3 && photos.point_count == 1 && photos.fit[0].mask))
        printf("  %s\n", message.text);
    const uint32_t hash = hash_of_all();
    say_windows("\\\\", ".ppm");
    CHECK(!read_photos("w", &options) && photos.fit_count == 3 && hash_of_all() == hash);
    CHECK(!strcmp(photos.fit[2].view.name, "a0/1.ppm"));
    CHECK(!rename(in_folder("w/a/2.ppm"), in_folder("w/a/2.PPM")));
    CHECK(!read_photos("w", &options) && photos.fit_count == 3 && hash_of_all() == hash);
    char said[256] = "";
    const fxs_photos_options saying = {.size = sizeof(fxs_photos_options), .left_out = left_out,
                                       .left_out_argument = said};
    CHECK(!read_photos("w", &saying) && !strcmp(said, "/a: 1 photograph has no camera: m.ppm; "));
    say_windows("/", ".PPM");
    CHECK(!read_photos("w", &options) && photos.fit_count == 3);
    /* writes the photograph z.ppm; the camera file names it with a folder of another machine */
    put_ppm("w/z.ppm", 24, 20, NULL);
    say_frames("\"w\":24,\"h\":20,\"fl_x\":20,", "C:\\\\set\\\\z.PPM", 1);
    put_text("w/transforms.json");
    said[0] = 0;
    CHECK(!read_photos("w", &saying) && photos.fit_count == 1 && !*said);
    say_windows("\\\\", ".png");
    check_refused("w", &options, FXS_ERR_FILE, "w/a/0.png: No such file");
#ifndef _WIN32
    put_ppm("w/a\\0.ppm", 24, 20, NULL);
    say_windows("\\\\", ".ppm");
    CHECK(!read_photos("w", &options) && photos.fit_count == 3 && hash_of_all() != hash &&
          !strcmp(photos.fit[0].view.name, "a/2.ppm") && !strcmp(photos.fit[2].view.name, "a\\0.ppm"));
#endif
}

#define OPENCV_TOP "\"camera_model\":\"OPENCV\",\"w\":160,\"h\":120,\"fl_x\":140,\"fl_y\":150,\"cx\":80,\"cy\":60," \
                   "\"k1\":-0.2,\"k2\":0.05,\"p1\":0.01,\"p2\":-0.02,"

static void nerfstudio(void)
{
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    check_lens(4);                 /* writes the photograph and camera that the following lines use */
    const fxs_view view = photos.fit[0].view;
    const uint32_t hash = hash_of_pixels();
    say_frames(OPENCV_TOP "\"ply_file_path\":\"p.ply\",", "./images/a.ppm", 1);
    put_text("one/transforms.json");
    check_refused("one/transforms.json", &options, FXS_ERR_FILE, "one/p.ply: No such file");
    say("ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
        "property uint8 red\nproperty uint8 green\nproperty uint8 blue\nend_header\n"
        "1 2 -3 4 5 6\n7 8 -9.5 10 11 255\n");
    put_text("one/p.ply");
    if (!CHECK(!read_photos("one/transforms.json", &options))) {
        printf("  %s\n", message.text);
        return;
    }
    CHECK(photos.fit[0].view.fx == view.fx && photos.fit[0].view.fy == view.fy && hash_of_pixels() == hash);
    CHECK(photos.point_count == 2 && !photos.points_are_random && photos.points[1].position[2] == -9.5f &&
          photos.points[0].position[1] == 2 && photos.points[1].colour[2] == 255 && photos.points[0].colour[0] == 4);
    say("ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty double x\nproperty short n\nproperty double y\n"
        "property float z\nend_header\n");
    memcpy(text + length, "\100\0\0\0\0\0\0\0\1\2\100\10\0\0\0\0\0\0\300\200\0\0", 22);
    length += 22;
    const size_t whole = length;
    for (size_t i = whole - 25; i < whole; i++) {
        put_file("one/p.ply", text, i);
        check_refused("one/transforms.json", &options, FXS_ERR_FILE, "one/p.ply: ");
    }
    put_text("one/p.ply");
    if (CHECK(!read_photos("one/transforms.json", &options)))
        CHECK(photos.point_count == 1 && photos.points[0].position[0] == 2 && photos.points[0].position[1] == 3 &&
              photos.points[0].position[2] == -4 && photos.points[0].colour[0] == 128);
    say("ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int i\nelement vertex 1\nproperty float x\n"
        "end_header\n1 1\n1\n");
    put_text("one/p.ply");
    check_refused("one/transforms.json", &options, FXS_ERR_FILE, "its first element is not \"vertex\"");
    say_frames(OPENCV_TOP "\"k3\":\"much\",", "./images/a.ppm", 1);
    put_text("one/transforms.json");
    check_refused("one/transforms.json", &options, FXS_ERR_FILE, "a coefficient of its lens is not a finite number");
    say("{\"w\":160,\"h\":120,\"fl_x\":140,\"frames\":[{" MATRIX "}]}", 0);
    put_text("one/transforms.json");
    check_refused("one/transforms.json", &options, FXS_ERR_FILE, "view 0: it names no photograph");
    say_frames("\"camera_model\":\"EQUIRECTANGULAR\",", "./images/a.ppm", 1);
    put_text("one/transforms.json");
    check_refused("one/transforms.json", &options, FXS_ERR_FILE, "is not known here; expected one of a perspective");
    remove_file("one/transforms.json");
}

static void colours_of_points(void)
{
    static const struct { const char *type, *prefix, *values; uint8_t colour[3]; } cases[] = {
        {"uchar", "", "4 5 255", {4, 5, 255}}, {"float", "", "0 0.2 1", {0, 51, 255}},
        {"double", "", ".5 .7 .0039215", {128, 179, 1}}, {"float", "", "7 128 254.6", {7, 128, 255}},
        {"ushort", "", "257 65535 0", {1, 255, 0}}, {"uchar", "diffuse_", "9 8 7", {9, 8, 7}},
        {"float", "diffuse_", "1 1 0", {255, 255, 0}}, {"float", "", "nan -1 1", {0, 0, 255}},
        {"uchar", "other_", "9 8 7", {128, 128, 128}}
    };
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    check_lens(4);
    say_frames(OPENCV_TOP "\"ply_file_path\":\"p.ply\",", "./images/a.ppm", 1);
    put_text("one/transforms.json");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        static const char *const names[] = {"red", "green", "blue"};
        say("ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n");
        for (int c = 0; c < 3; c++)
            say("property %s %s%s\n", cases[i].type, cases[i].prefix, names[c]);
        say("end_header\n0 0 0 0 0 0\n1 2 3 %s\n", cases[i].values);
        put_text("one/p.ply");
        if (!CHECK(!read_photos("one/transforms.json", &options) && photos.point_count == 2))
            continue;
        for (int c = 0; c < 3; c++)
            if (!CHECK(photos.points[1].colour[c] == cases[i].colour[c]))
                printf("  %s %s: %d\n", cases[i].type, cases[i].values, photos.points[1].colour[c]);
    }
    remove_file("one/transforms.json");
}

#define FISHEYE_TOP "\"w\":160,\"h\":120,\"fl_x\":100,\"fl_y\":100,\"cx\":80,\"cy\":60,\"k1\":0.05," \
                    "\"k2\":-0.01,\"k3\":0.002,\"k4\":-0.001,"

static void nerfstudio_fisheye(void)
{
    static const struct {
        size_t lens;
        const char *top;
    } files[] = {
        {6, "\"camera_model\":\"OPENCV_FISHEYE\",\"p1\":9," FISHEYE_TOP}, {6, "\"is_fisheye\":true," FISHEYE_TOP},
        {12, "\"camera_model\":\"THIN_PRISM_FISHEYE\",\"p1\":0.01,\"p2\":-0.02,\"sx1\":0.03,\"sy1\":-0.04,"
             FISHEYE_TOP},
        {5, "\"w\":160,\"h\":120,\"fl_x\":140,\"fl_y\":140,\"cx\":80,\"cy\":60,\"k1\":0.1,\"k2\":-0.05,\"k3\":0.02,"
            "\"k4\":0.3,\"k5\":0.04,\"k6\":0.01,\"p1\":0.002,\"p2\":0.001,"},
    };
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        check_lens(files[i].lens);
        const fxs_view view = photos.fit[0].view;
        const uint32_t hash = hash_of_pixels();
        say_frames(files[i].top, "./images/a.ppm", 1);
        put_text("one/transforms.json");
        if (CHECK(!read_photos("one/transforms.json", &options)))
            CHECK(photos.fit[0].view.fx == view.fx && hash_of_pixels() == hash);
        else
            printf("  %s\n", message.text);
    }
    say_frames("\"w\":160,\"h\":120,\"fl_x\":140,\"k1\":0.1,\"k4\":0.2,", "./images/a.ppm", 1);
    put_text("one/transforms.json");
    fxs_view_list list = {.path = in_folder("one/transforms.json"), .message = &message};
    if (CHECK(!fxs_view_list_read(&list)))
        CHECK(list.views[0].lens.k[0] == 0.1 && list.views[0].lens.k[3] == 0.2 && list.views[0].lens.d[0] == 0);
    fxs_view_list_free(&list);
    remove_file("one/transforms.json");
}

static void nerfstudio_cameras(void)
{
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    make_folder("n");
    put_ppm("n/a.ppm", 24, 20, NULL);
    put_ppm("n/b.ppm", 16, 12, NULL);
    say("{\"w\":24,\"h\":20,\"fl_x\":20,\"fl_y\":21,\"cx\":11,\"cy\":10,\"applied_transform\":[[1,0,0,0],[0,0,1,0],"
        "[0,-1,0,0]],\"frames\":[{\"file_path\":\"b.ppm\",\"w\":16,\"h\":12,\"fl_x\":14,"
        "\"fl_y\":15,\"cx\":8,\"cy\":5," MATRIX "},{\"file_path\":\"a.ppm\"," MATRIX "}]}", 3, 4);
    put_text("n/transforms.json");
    if (!CHECK(!read_photos("n", &options)))
        return;
    const fxs_view *a = &photos.fit[0].view, *b = &photos.fit[1].view;
    CHECK(a->fx == 20 && a->fy == 21 && a->cx == 11 && a->cy == 10 && a->width == 24 && a->position[0] == 4);
    CHECK(b->fx == 14 && b->fy == 15 && b->cx == 8 && b->cy == 5 && b->width == 16 && b->position[0] == 3);
    remove_file("n/a.ppm");
    check_refused("n", &options, FXS_ERR_FILE, "n/transforms.json; skip_bad, --skip-bad, leaves such out)");
    put_ppm("n/a.ppm", 24, 20, NULL);
}

static void nerfstudio_parts(void)
{
    static const struct {
        const char *lists;
        /* expected numbers of photographs to fit and held out for testing, with hold_out = 8 */
        size_t fit, held_out;
        char first, held;   /* expected first letters of the first photograph to fit and of the first held out */
    } files[] = {
        {"", 4, 1, '1', '0'},
        {"\"train_filenames\":[\"./1.ppm\",\"2.ppm\",\"2.ppm\"],\"test_filenames\":[\"3.ppm\"],"
         "\"val_filenames\":[\"0.ppm\"],", 2, 1, '1', '3'},
        {"\"train_filenames\":[\"1.ppm\",\"2.ppm\"],\"val_filenames\":[\"0.ppm\",\"4.ppm\"],", 2, 2, '1', '0'},
        {"\"test_filenames\":[\"2.ppm\",\"3.ppm\"],\"val_filenames\":[\"0.ppm\"],", 2, 2, '1', '2'},
        {"\"val_filenames\":[\"4.ppm\"],", 4, 1, '0', '4'},
        {"\"train_filenames\":[\"4.ppm\",\"3.ppm\",\"2.ppm\"],\"test_filenames\":[],", 2, 1, '3', '2'},
    };
    fxs_photos_options options = {.size = sizeof(fxs_photos_options), .hold_out = 8};
    for (int i = 0; i < 5; i++) {
        char name[16];
        sprintf(name, "n/%d.ppm", i);
        put_ppm(name, 24, 20, NULL);
    }
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char top[512];
        snprintf(top, sizeof top, "%s\"w\":24,\"h\":20,\"fl_x\":20,", files[i].lists);
        say_frames(top, "%d.ppm", 5);
        put_text("n/transforms.json");
        if (!CHECK(!read_photos("n", &options)))
            printf("  %s\n", message.text);
        else if (!CHECK(photos.fit_count == files[i].fit && photos.held_out_count == files[i].held_out &&
                        photos.fit[0].view.name[0] == files[i].first &&
                        photos.held_out[0].view.name[0] == files[i].held))
            printf("  %s%zu, %zu\n", files[i].lists, photos.fit_count, photos.held_out_count);
    }
    say_frames("\"train_filenames\":[\"3.ppm\",\"1.ppm\"],\"test_filenames\":[\"0.ppm\"],\"w\":24,\"h\":20,"
               "\"fl_x\":20,", "%d.ppm", 5);
    put_text("n/transforms.json");
    options.hold_out = 0;
    char said[256] = "";
    /* reports photographs without a camera; photographs outside of the lists have cameras, so they are not
       reported */
    options.left_out = left_out;
    options.left_out_argument = said;
    CHECK(!read_photos("n", &options) && photos.fit_count == 2 && !photos.held_out_count);
    CHECK(!strcmp(said, "/n: 2 photographs have no camera: a.ppm, b.ppm; "));
}

static void one_name(void)
{
    enum { NAMES = 400000, FRAMES = 20000 };
    char *json = malloc(4 * NAMES + 128 * FRAMES + 256), *to = json;
    if (!CHECK(json != NULL))
        return;
    to += sprintf(to, "{\"w\":24,\"h\":20,\"fl_x\":20,\"train_filenames\":[\"b\"");
    for (int i = 0; i < NAMES; i++)
        to += sprintf(to, ",\"a\"");
    to += sprintf(to, "],\"frames\":[{\"file_path\":\"b\"," MATRIX "}", 0);
    for (int i = 0; i < FRAMES; i++)
        to += sprintf(to, ",{\"file_path\":\"a\"," MATRIX "}", i);
    to += sprintf(to, "]}");
    put_file("n/transforms.json", json, (size_t)(to - json));
    free(json);
    fxs_view_list list = {.path = in_folder("n/transforms.json"), .message = &message};
    const clock_t start = clock();
    CHECK(!fxs_view_list_read(&list) && list.count == FRAMES + 1);
    const double seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
    if (!CHECK(seconds < 4))
        printf("  %g s\n", seconds);
    for (size_t i = 0; i < list.count; i++)
        CHECK(list.views[i].part == FXS_VIEW_TO_FIT);
    fxs_view_list_free(&list);
}

static void nerfstudio_part_faults(void)
{
    static const struct {
        const char *lists, *words;
    } files[] = {
        {"\"test_filenames\":[\"0.ppm\",\"9.ppm\"],", "test_filenames: no frame has the file_path 9.ppm"},
        {"\"train_filenames\":[\"0.ppm\",3],", "train_filenames: not a list of names"},
        {"\"val_filenames\":\"0.ppm\",", "val_filenames: not a list of names"},
        {"\"train_filenames\":[\"0.ppm\"],\"test_filenames\":[\"0.ppm\"],", "view 0.ppm: both in train_filenames and"},
        {"\"test_filenames\":[\"0.ppm\",\"1.ppm\",\"2.ppm\",\"3.ppm\",\"4.ppm\"],", "none is left to fit"},
    };
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options), .hold_out = 8};
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char top[512];
        snprintf(top, sizeof top, "%s\"w\":24,\"h\":20,\"fl_x\":20,", files[i].lists);
        say_frames(top, "%d.ppm", 5);
        put_text("n/transforms.json");
        check_refused("n", &options, FXS_ERR_FILE, files[i].words);
    }
}

/* Reads the folder of a model by Inria's program. Its photograph names have no endings, and its points are in
   input.ply. */
static void inria(void)
{
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    make_folder("i");
    make_folder("i/images");
    put_ppm("i/images/b.JPG", 24, 20, NULL);
    put_ppm("i/images/a.png", 24, 20, NULL);
    for (int i = 0; i < 3; i++) {
        say("%s{\"img_name\":\"%s\",\"width\":12,\"height\":10,\"fx\":9,\"fy\":8,\"position\":[0,0,0],\"rotation\":"
            "[[1,0,0],[0,1,0],[0,0,1]]%s", i ? "," : "[", i ? "a" : "b", i == 2 ? ",\"orthographic\":true}]" : "}");
        if (i == 1) {
            text[length] = ']';
            put_file("i/cameras.json", text, length + 1);
        }
    }
    put_text("i/all.json");
    if (CHECK(!read_photos("i", &options)))
        CHECK(photos.fit_count == 2 && !strcmp(photos.fit[0].view.name, "a") && photos.fit[0].view.fx == 18 &&
              photos.fit[0].view.fy == 16 && photos.points_are_random);
    say("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
        "1 2 3\n");
    put_text("i/input.ply");
    CHECK(!read_photos("i/cameras.json", &options) && photos.point_count == 1 && !photos.points_are_random);
    check_refused("i/all.json", &options, FXS_ERR_FILE, "view a: not a perspective camera");
    remove_file("i/images/b.JPG");
    check_refused("i", &options, FXS_ERR_FILE, "i/cameras.json; skip_bad, --skip-bad, leaves such out)");
}

#endif

#if defined(FXS_WITH_PNG) && defined(FXS_WITH_ZLIB)
#include <fixsplat/image.h>

/* Reads photographs with alpha. A pixel becomes colour * alpha + background * (1 - alpha), before averaging, and
   is rounded once. */
static void alpha(void)
{
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options), .resolution = 6,
                                        .background = {255, 128, 3}};
    uint8_t rgba[4 * 24 * 20];
    for (size_t i = 0; i < sizeof rgba; i++)
        rgba[i] = (uint8_t)random_number();
    CHECK(!fxs_image_file_write(in_folder("one/a.png"), rgba, 24, 20, &message));
    CHECK(!rename(in_folder("one/a.png"), in_folder("one/images/a.ppm")));
    say("1 PINHOLE 24 20 25 25 12 10\n");
    put_text("one/cameras.txt");
    if (!CHECK(!read_photos("one", &options)) ||
        !CHECK(photos.fit[0].view.width == 6 && photos.fit[0].view.height == 5))
        return;
    for (int i = 0; i < 3 * 6 * 5; i++) {
        const int x = i / 3 % 6, y = i / 18, c = i % 3;
        int sum = 0;
        for (int k = 0; k < 16; k++) {
            const uint8_t *p = rgba + 4 * ((4 * y + k / 4) * 24 + 4 * x + k % 4);
            sum += p[c] * p[3] + options.background[c] * (255 - p[3]);
        }
        CHECK(photos.fit[0].pixels[i] == (sum + 8 * 255) / (16 * 255));
    }
}
#endif

#if defined(FXS_WITH_CJSON) && defined(FXS_WITH_PNG) && defined(FXS_WITH_JPEG)

static const char *real_set(const char *name)
{
    static char path[512];
    const char *scenes = getenv("FXS_SCENES");
    struct stat status;
    snprintf(path, sizeof path, "%s/../photos/%s", scenes ? scenes : "../shared/scenes", name);
    return stat(path, &status) ? NULL : path;
}

static uint32_t hash_of_set(const char *path, const fxs_photos_options *options)
{
    fxs_photos_free(&photos);
    if (!CHECK(!fxs_photos_read(path, options, &photos, &message))) {
        printf("  %s\n", message.text);
        return 0;
    }
    return hash_of_pixels();
}

static void snowmiku(void)
{
    fxs_photos_options options = {.size = sizeof(fxs_photos_options), .resolution = 600, .hold_out = 8,
                                  .workers.run = fxs_pool_run};
    const char *path = real_set("snowmiku");
    if (!path)
        SKIP("no photographs here");
    options.workers.pool = fxs_pool_create(2);
    const uint32_t hash = hash_of_set(path, &options);
    if (!CHECK(hash == SNOWMIKU_HASH))
        printf("  0x%08x\n", (unsigned)hash);
    CHECK(photos.fit_count == 84 && photos.held_out_count == 13 && photos.point_count == 25784 &&
          !photos.points_are_random);
    CHECK(photos.fit_count && photos.fit[0].view.width == 600 && photos.fit[0].view.height == 450);
    CHECK(photos.held_out_count && !strcmp(photos.held_out[0].view.name, "20240212_003919.jpg"));
    fxs_pool_destroy(options.workers.pool);
}

static void lego(void)
{
    fxs_photos_options options = {.size = sizeof(fxs_photos_options), .resolution = 400, .hold_out = 8,
                                  .background = {255, 255, 255}, .workers.run = fxs_pool_run};
    const char *path = real_set("lego");
    if (!path)
        SKIP("no photographs here");
    options.workers.pool = fxs_pool_create(2);
    const uint32_t hash = hash_of_set(path, &options);
    if (!CHECK(hash == LEGO_HASH))
        printf("  0x%08x\n", (unsigned)hash);
    CHECK(photos.fit_count == 100 && photos.held_out_count == 25 && photos.point_count == 100000 &&
          photos.points_are_random);
    CHECK(photos.fit_count && photos.fit[0].view.width == 400 && photos.fit[0].pixels[0] == 255);
    fxs_pool_destroy(options.workers.pool);
}
#endif

static void tests(void)
{
    make_colmap();
    RUN(colmap);
    RUN(bad_points);
    RUN(bad_photos);
    RUN(proportions);
    RUN(missing_folders);
    RUN(one_camera);
    RUN(averages);
    RUN(lens_formulas);
    RUN(lens_models);
    RUN(lens_limits);
    RUN(lens_widest);
    RUN(lens_faults);
#ifdef FXS_WITH_CJSON
    RUN(blender);
    RUN(names_of_windows);
    RUN(nerfstudio);
    RUN(colours_of_points);
    RUN(nerfstudio_fisheye);
    RUN(nerfstudio_cameras);
    RUN(nerfstudio_parts);
    RUN(one_name);
    RUN(nerfstudio_part_faults);
    RUN(inria);
#endif
#if defined(FXS_WITH_PNG) && defined(FXS_WITH_ZLIB)
    RUN(alpha);
#endif
#if defined(FXS_WITH_CJSON) && defined(FXS_WITH_PNG) && defined(FXS_WITH_JPEG)
    RUN(snowmiku);
    RUN(lego);
#endif
    fxs_photos_free(&photos);
}

int main(void)
{
    return in_a_folder(tests);
}
