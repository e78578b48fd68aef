/* Tests the readers of camera files: the same camera in every format, faulty files, real files. */
#include <fixsplat/camera.h>
#include <fixsplat/fit.h>
#include <fixsplat/scene.h>
#include <fixsplat/world.h>
#include <fixsplat/internal/message.h>
#include <fixsplat/internal/packed.h>
#include <fixsplat/internal/placements.h>
#include <fixsplat/internal/start.h>
#include <fixsplat/internal/view_more.h>

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "check.h"

static char folder[] = "/tmp/fixsplat-cameras-XXXXXX";
static fxs_message message;

static const char *in_folder(const char *name)
{
    static char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static void put(const char *name, const void *data, size_t size)
{
    FILE *file = fopen(in_folder(name), "wb");
    if (!CHECK(file != NULL))
        return;
    CHECK(fwrite(data, 1, size, file) == size);
    CHECK(!fclose(file));
}

static void put_text(const char *name, const char *format, ...)
{
    char text[8192];
    va_list arguments;
    va_start(arguments, format);
    int size = vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    CHECK(size >= 0 && size < (int)sizeof text);
    put(name, text, strlen(text));
}

static long read_views(const char *name, fxs_view **views)
{
    *views = NULL;
    memset(&message, 0, sizeof message);
    long count = fxs_camera_file_read(in_folder(name), views, &message);
    if (count < 0)
        CHECK(message.text[0] != 0 && !strchr(message.text, '\n'));
    return count;
}

static void check_fault(const char *name, const char *words)
{
    fxs_view *views;
    long count = read_views(name, &views);
    const int error = strstr(words, "built without") ? FXS_ERR_UNSUPPORTED : FXS_ERR_FILE;
    if (!CHECK(count == error && strstr(message.text, words) != NULL))
        printf("  %s: %ld views, \"%s\", expected \"%s\"\n", name, count, message.text, words);
    if (count > 0)
        free(views);
}

/* The rotation of the test camera is 0.7 radians about (1, 2, 3). Rodrigues' formula for an axis k is R = cos I + sin
   [k] + (1 - cos) k k^T. */

static const double centre[3] = {1.25, -0.375, 2.0625};
static double rotation[9], quaternion[4], translation[3];

static void make_camera(void)
{
    const double angle = 0.7, k[3] = {1 / sqrt(14), 2 / sqrt(14), 3 / sqrt(14)};
    const double cross[9] = {0, -k[2], k[1], k[2], 0, -k[0], -k[1], k[0], 0};
    for (int i = 0; i < 9; i++)
        rotation[i] = cos(angle) * (i % 4 == 0) + sin(angle) * cross[i] + (1 - cos(angle)) * k[i / 3] * k[i % 3];
    quaternion[0] = cos(angle / 2);
    for (int i = 0; i < 3; i++) {
        quaternion[1 + i] = sin(angle / 2) * k[i];
        translation[i] = 0;
        for (int j = 0; j < 3; j++)
            translation[i] -= rotation[3 * i + j] * centre[j];
    }
}

static void check_camera(const char *name, const char *view_name, double cx, double cy)
{
    fxs_view *views;
    if (!CHECK(read_views(name, &views) == 1)) {
        printf("  %s\n", message.text);
        return;
    }
    CHECK(!strcmp(views->name, view_name) && views->width == 640 && views->height == 480);
    CHECK(fabs(views->fx - 500.5) < 1e-9 && fabs(views->fy - 499.25) < 1e-9);
    CHECK(fabs(views->cx - cx) < 1e-9 && fabs(views->cy - cy) < 1e-9);
    for (int i = 0; i < 9; i++)
        CHECK(fabs(views->rotation[i] - rotation[i]) < 1e-9);
    for (int i = 0; i < 3; i++)
        CHECK(fabs(views->position[i] - centre[i]) < 1e-9);
    free(views);
}

static unsigned char bytes[4096];
static size_t size;

static void add_integer(uint64_t value, int count)
{
    for (int i = 0; i < count; i++)
        bytes[size++] = (unsigned char)(value >> 8 * i);
}

static void add_double(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, 8);
    add_integer(bits, 8);
}

static void make_cameras_bin(uint64_t model, const double *params, int count)
{
    size = 0;
    add_integer(1, 8);
    add_integer(7, 4);
    add_integer(model, 4);
    add_integer(640, 8);
    add_integer(480, 8);
    for (int i = 0; i < count; i++)
        add_double(params[i]);
}

static void add_image_bin(const char *name, const double q[4])
{
    add_integer(3, 4);
    for (int i = 0; i < 4; i++)
        add_double(q[i]);
    for (int i = 0; i < 3; i++)
        add_double(translation[i]);
    add_integer(7, 4);
    memcpy(bytes + size, name, strlen(name) + 1);
    size += strlen(name) + 1;
    add_integer(2, 8);
    for (int i = 0; i < 6; i++)
        add_integer((uint64_t)i, 8);
}

static void make_images_bin(uint64_t count, const char *name, const double q[4])
{
    size = 0;
    add_integer(count, 8);
    add_image_bin(name, q);
}

static const double pinhole[4] = {500.5, 499.25, 320, 240};

static void put_colmap_bin(void)
{
    make_cameras_bin(1, pinhole, 4);
    put("cameras.bin", bytes, size);
    make_images_bin(1, "b.jpg", quaternion);
    put("images.bin", bytes, size);
}

#define BYTE_ORDER_MARK "\xef\xbb\xbf"

static void put_colmap_txt(const char *camera, const char *points)
{
    put_text("cameras.txt", "# a comment\n\n%s\n", camera);
    put_text("images.txt", "# a comment\r\n3 %.17g %.17g %.17g %.17g %.17g %.17g %.17g 7 b.jpg\r\n%s", quaternion[0],
             quaternion[1], quaternion[2], quaternion[3], translation[0], translation[1], translation[2], points);
}

static void remove_all(void)
{
    static const char *const names[] = {"cameras.bin", "images.bin", "cameras.txt", "images.txt", "cameras.json",
                                        "transforms.json"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        remove(in_folder(names[i]));
}

static void colmap_bin(void)
{
    remove_all();
    put_colmap_bin();
    check_camera("", "b.jpg", 320, 240);
    check_camera("images.bin", "b.jpg", 320, 240);
    check_camera("cameras.bin", "b.jpg", 320, 240);
}

static void colmap_txt(void)
{
    remove_all();
    put_colmap_txt("7 PINHOLE 640 480 500.5 499.25 320.5 239", "1 2 -1 3.5 4 17\n");
    check_camera("", "b.jpg", 320.5, 239);
    put_colmap_txt("7 OPENCV 640 480 500.5 499.25 320 240 0 0 0 0.0 ", "\n");
    check_camera("images.txt", "b.jpg", 320, 240);
    put_colmap_txt("7 FULL_OPENCV 640 480 500.5 499.25 320 240 0 0 0 0 0 0 0 0", "");
    check_camera("cameras.txt", "b.jpg", 320, 240);
    put_text("cameras.txt", BYTE_ORDER_MARK "7 PINHOLE 640 480 500.5 499.25 320 240\n");
    put_text("images.txt", BYTE_ORDER_MARK "3 %.17g %.17g %.17g %.17g %.17g %.17g %.17g 7  my photo (03).jpg \r\n"
             "1 2 -1\n",
             quaternion[0], quaternion[1], quaternion[2], quaternion[3], translation[0], translation[1],
             translation[2]);
    check_camera("", "my photo (03).jpg", 320, 240);
    put_text("images.txt", BYTE_ORDER_MARK "3 1 0 0 0 0 0 0 7 \n\n");
    check_fault("", "image 0: not nine numbers and a name");
}

static void check_bends(const char *name, int bends)
{
    fxs_view *views;
    if (!CHECK(read_views(name, &views) >= 1))
        return;
    CHECK(views->bends == bends && views->fx == 500 && views->width > 0);
    free(views);
}

static void colmap_models(void)
{
    fxs_view *views;
    remove_all();
    put_colmap_txt("7 SIMPLE_RADIAL 640 480 500 310 250 0", "\n");
    if (CHECK(read_views("", &views) == 1)) {
        CHECK(views->fx == 500 && views->fy == 500 && views->cx == 310 && views->cy == 250);
        free(views);
    }
    put_colmap_txt("7 SIMPLE_RADIAL 640 480 500 310 250 0", "\n");
    check_bends("", 0);
    put_colmap_txt("7 SIMPLE_RADIAL 640 480 500 310 250 1e-9", "\n");
    check_bends("", 1);
    put_colmap_txt("7 OPENCV_FISHEYE 640 480 500 500 310 250 0 0 0 0", "\n");
    check_bends("", 1);
    put_colmap_txt("7 RADIAL_FISHEYE 640 480 500 310 250 0 0", "\n");
    check_bends("", 1);
    put_colmap_txt("7 FOV 640 480 500 500 310 250 0", "\n");
    check_bends("", 0);
    put_colmap_txt("7 FOV 640 480 500 500 310 250 1e-9", "\n");
    check_bends("", 1);
    put_colmap_txt("7 THIN_PRISM_FISHEYE 640 480 500 500 310 250 0 0 0 0 0 0 0 0", "\n");
    check_bends("", 1);
    put_colmap_txt("7 CYLINDER 640 480 500 500 310 250", "\n");
    check_fault("", "cameras.txt: camera 7: a camera model that is not known here; expected one of COLMAP 3");
    put_colmap_txt("7 PINHOLE 640 480 500 310 250", "\n");
    check_fault("", "camera 7: not a size and 4 parameters");
    put_colmap_txt("7 PINHOLE 640 480 500 500 310 250 0", "\n");
    check_fault("", "camera 7: not a size and 4 parameters");
    put_colmap_txt("8 PINHOLE 640 480 500 500 310 250", "\n");
    check_fault("", "images.txt: view b.jpg: its camera is not");
    put_colmap_txt("7 PINHOLE 640.5 480 500 500 310 250", "\n");
    check_fault("", "view b.jpg: width and height");
    put_colmap_txt("7 PINHOLE 640 16385 500 500 310 250", "\n");
    check_fault("", "view b.jpg: width and height");
    put_colmap_txt("7 PINHOLE 640 480 500 -500 310 250", "\n");
    check_fault("", "view b.jpg: no focal length");
    put_colmap_txt("7 PINHOLE 640 480 500 500 nan 250", "\n");
    check_fault("", "camera 7: not a size and 4 parameters");
}

static void colmap_images(void)
{
    fxs_view *views;
    remove_all();
    put_text("cameras.txt", "7 PINHOLE 640 480 500 500 310 250\n2 SIMPLE_PINHOLE 64 48 50 31 25\n");
    put_text("images.txt", "9 1 0 0 0 1 2 3 2 z\n\n5 3 0 0 0 4 5 6 7 a\n1 2 3\n");
    if (CHECK(read_views("", &views) == 2)) {
        CHECK(!strcmp(views[0].name, "a") && views[0].width == 640 && views[0].position[0] == -4);
        CHECK(!strcmp(views[1].name, "z") && views[1].width == 64 && views[1].position[2] == -3);
        CHECK(views[0].rotation[0] == 1 && views[0].rotation[4] == 1 && views[0].rotation[8] == 1);
        free(views);
    }
    put_text("images.txt", "1 0 0 0 0 1 2 3 7 a\n\n");
    check_fault("", "view a: its quaternion is zero");
    put_text("images.txt", "1 1 0 0 0 1 2 7 a\n\n");
    check_fault("", "image 0: not nine numbers and a name");
    put_text("images.txt", "1 1 0 0 0 1 2 3 7 \n\n");
    check_fault("", "image 0: not nine numbers and a name");
    put_text("images.txt", "1 1 0 0 0 1e308 1e309 3 7 a\n\n");
    check_fault("", "not nine numbers");
    put_text("images.txt", "# nothing\n");
    check_fault("", "no views");
    put("images.txt", "1 1 0 0 0 1 2 3 7 a\0\n", 21);
    check_fault("", "zero bytes");
    remove(in_folder("cameras.txt"));
    check_fault("images.txt", "cameras.txt: No such file");
    remove(in_folder("images.txt"));
    check_fault("", "neither sparse/0 of COLMAP");
}

static void colmap_bin_faults(void)
{
    const double distorted[8] = {500, 500, 320, 240, 0, 0, 0.01, 0}, zero[4] = {0, 0, 0, 0}, bad[4] = {NAN, 0, 0, 0};
    remove_all();
    put_colmap_bin();
    make_cameras_bin(4, distorted, 8);
    put("cameras.bin", bytes, size);
    check_bends("", 1);
    make_cameras_bin(5, distorted, 8);
    put("cameras.bin", bytes, size);
    check_bends("", 1);
    make_cameras_bin(4000000000u, distorted, 8);
    put("cameras.bin", bytes, size);
    check_fault("", "a camera model that is not known here");
    put_colmap_bin();
    make_images_bin(1, "b.jpg", zero);
    put("images.bin", bytes, size);
    check_fault("", "images.bin: view b.jpg: its quaternion is zero");
    make_images_bin(1, "b.jpg", bad);
    put("images.bin", bytes, size);
    check_fault("", "quaternion");
    make_images_bin(UINT64_MAX, "b.jpg", quaternion);
    put("images.bin", bytes, size);
    check_fault("", "cut short");
    make_images_bin(0, "b.jpg", quaternion);
    put("images.bin", bytes, size);
    check_fault("", "no views");
}

static void colmap_long_name(void)
{
    fxs_view *views;
    char name[400];
    memset(name, 'n', sizeof name - 1);
    name[0] = '\n';
    name[sizeof name - 1] = 0;
    remove_all();
    put_colmap_bin();
    make_images_bin(2, name, quaternion);
    add_image_bin("a", quaternion);
    put("images.bin", bytes, size);
    if (CHECK(read_views("", &views) == 2)) {
        CHECK(strlen(views[0].name) == 127 && views[0].name[0] == '?');
        CHECK(!strcmp(views[1].name, "a"));
        free(views);
    }
}

static void no_file(void)
{
    remove_all();
    check_fault("missing.json", "missing.json: No such file");
    put("cameras.json", "", 0);
    CHECK(!truncate(in_folder("cameras.json"), (off_t)1 << 40));
    check_fault("cameras.json", "larger than");
    remove(in_folder("cameras.json"));
    CHECK(!mkfifo(in_folder("cameras.json"), 0600));
    check_fault("cameras.json", "not a regular file");
    remove_all();
}

#ifdef FXS_WITH_CJSON

#define INRIA_POSE "\"position\":[0,0,0],\"rotation\":[[1,0,0],[0,1,0],[0,0,1]]"

static void put_inria(void)
{
    const double *r = rotation;
    put_text("cameras.json",
             " [{\"id\":0,\"img_name\":\"b.jpg\",\"width\":640,\"height\":480,\"position\":[%.17g,%.17g,%.17g],"
             "\"rotation\":[[%.17g,%.17g,%.17g],[%.17g,%.17g,%.17g],[%.17g,%.17g,%.17g]],\"fy\":499.25,\"fx\":500.5}]",
             centre[0], centre[1], centre[2], r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8]);
}

static double stretch[3] = {1, 1, 1};

static void put_transforms(const char *top, const char *own)
{
    double r[9];
    for (int i = 0; i < 9; i++)
        r[i] = stretch[i / 3] * rotation[i];
    put_text("transforms.json",
             BYTE_ORDER_MARK "{%s \"frames\":[{\"file_path\":\"b.jpg\",%s "
             "\"transform_matrix\":[[%.17g,%.17g,%.17g,%.17g],"
             "[%.17g,%.17g,%.17g,%.17g],[%.17g,%.17g,%.17g,%.17g],[0,0,0,1]]}]}", top, own,
             r[0], -r[3], -r[6], centre[0], r[1], -r[4], -r[7], centre[1], r[2], -r[5], -r[8], centre[2]);
}

static void inria(void)
{
    fxs_view *views;
    remove_all();
    put_inria();
    check_camera("cameras.json", "b.jpg", 320, 240);
    put_text("cameras.json", "[{\"width\":10,\"height\":5,\"fx\":1,\"fy\":2," INRIA_POSE "}]");
    if (CHECK(read_views("cameras.json", &views) == 1)) {
        CHECK(!strcmp(views->name, "0") && views->cx == 5 && views->cy == 2.5);
        CHECK(views->projection == FXS_PERSPECTIVE);
        free(views);
    }
}

static void inria_extended(void)
{
    fxs_view *views;
    remove_all();
    put_text("cameras.json", "[{\"width\":10,\"height\":5,\"fx\":1,\"fy\":2,\"cx\":3,\"cy\":-1.5,"
                             "\"orthographic\":true," INRIA_POSE "},"
                             "{\"width\":10,\"height\":5,\"fx\":1,\"fy\":2,\"orthographic\":false," INRIA_POSE "}]");
    if (CHECK(read_views("cameras.json", &views) == 2)) {
        CHECK(views->cx == 3 && views->cy == -1.5 && views->projection == FXS_ORTHOGRAPHIC);
        CHECK(views[1].projection == FXS_PERSPECTIVE);
        free(views);
    }
}

static void written(void)
{
    fxs_view views[2], *again;
    memset(views, 0, sizeof views);
    for (int i = 0; i < 2; i++) {
        const double turn[9] = {0.8, 0, -0.6, 0, 1, 0, 0.6, 0, 0.8};
        fxs_view *v = &views[i];
        snprintf(v->name, sizeof v->name, i ? "a\"b\\c d.jpg" : "b.png");
        v->width = 640 + i, v->height = 480;
        v->fx = 500.1, v->fy = 1 / 3.0 + 400, v->cx = 320.7, v->cy = 200 + i;
        memcpy(v->rotation, turn, sizeof turn);
        for (int k = 0; k < 3; k++)
            v->position[k] = (k - 1) / 7.0 + i;
        v->projection = i ? FXS_ORTHOGRAPHIC : FXS_PERSPECTIVE;
    }
    CHECK(fxs_camera_file_write(in_folder("written.json"), views, 2, &message) == 0);
    if (CHECK(read_views("written.json", &again) == 2))
        for (int i = 0; i < 2; i++) {
            CHECK(!strcmp(again[i].name, views[i].name) && again[i].width == views[i].width);
            CHECK(again[i].fx == views[i].fx && again[i].fy == views[i].fy && again[i].cx == views[i].cx);
            CHECK(again[i].cy == views[i].cy && again[i].height == 480 && again[i].projection == views[i].projection);
            CHECK(!memcmp(again[i].rotation, views[i].rotation, sizeof views[i].rotation));
            CHECK(!memcmp(again[i].position, views[i].position, sizeof views[i].position));
        }
    free(again);
    CHECK(fxs_camera_file_write(in_folder("written.json"), views, 0, &message) == 0);
    CHECK(read_views("written.json", &again) < 0);
    remove(in_folder("written.json"));
    CHECK(fxs_camera_file_write(in_folder("none/written.json"), views, 2, &message) == FXS_ERR_FILE);
    CHECK(strstr(message.text, "No such file") != NULL);
}


static void inria_faults(void)
{
    static const struct {
        const char *text, *words;
    } faults[] = {
        {"", "but this is empty"}, {"ply\nformat ascii 1.0\n", "but this is a .ply"},
        {"0, 1", "but this is another file"}, {" {\"frames\"", "bad JSON"},
        {"[]", "no views"},
        {"{}", "neither an array of cameras nor an object with \"frames\""},
        {"[3]", "view 0: \"position\""},
        {"[{\"img_name\":\"q\"}]", "view q: \"position\""},
        {"[{\"position\":[0,0,\"1\"]}]", "view 0: \"position\""},
        {"[{\"position\":[0,0,1,2]}]", "view 0: \"position\""},
        {"[{\"position\":[0,0,1]}]", "view 0: \"rotation\""},
        {"[{\"position\":[0,0,0],\"rotation\":[[1,0,0],[0,1],[0,0,1]]}]", "view 0: \"rotation\""},
        {"[{" INRIA_POSE "}]", "view 0: width and height"},
        {"[{\"width\":1e300,\"height\":5,\"fx\":1,\"fy\":1," INRIA_POSE "}]", "width and height"},
        {"[{\"width\":0,\"height\":5,\"fx\":1,\"fy\":1," INRIA_POSE "}]", "width and height"},
        {"[{\"width\":9,\"height\":5,\"fx\":0,\"fy\":1," INRIA_POSE "}]", "no focal length"},
        {"[{\"width\":9,\"height\":5,\"fx\":\"1\",\"fy\":1," INRIA_POSE "}]", "no focal length"},
        {"[{\"width\":9,\"height\":5,\"fx\":1," INRIA_POSE "}]", "no focal length"},
        {"[{\"width\":9,\"height\":5,\"fx\":1,\"fy\":1,\"cx\":\"4\"," INRIA_POSE "}]", "principal point"},
        {"[{\"width\":9,\"height\":5,\"fx\":1,\"fy\":1," INRIA_POSE "},1]", "view 1: \"position\""},
        {"[{\"width\":9,\"height\":5,\"fx\":1,\"fy\":1," INRIA_POSE "}] x", "bad JSON"},
        {"[{\"width\":9,\"height\":5,\"fx\":1,\"fy\":1,\"position\":[1e999,0,0],"
         "\"rotation\":[[1,0,0],[0,1,0],[0,0,1]]}]", "view 0: position not finite"},
        {"[{\"width\":9,\"height\":5,\"fx\":1,\"fy\":1,\"position\":[1,0,0],"
         "\"rotation\":[[1,0,0],[0,1,0],[0,0,-1]]}]", "view 0: rotation"},
        {"[{\"width\":9,\"height\":5,\"fx\":1,\"fy\":1,\"position\":[1,0,0],"
         "\"rotation\":[[1,0,0],[0,1,0],[0,0.0011,1]]}]", "view 0: rotation"},
        {"[{\"width\":9,\"height\":5,\"fx\":1,\"fy\":1,\"position\":[1,0,0],"
         "\"rotation\":[[0,0,0],[0,0,0],[0,0,0]]}]", "view 0: rotation"},
        {"[{\"img_name\":\"a\\nb\"}]", "view a?b: \"position\""},
    };
    remove_all();
    for (size_t i = 0; i < sizeof faults / sizeof *faults; i++) {
        put("cameras.json", faults[i].text, strlen(faults[i].text));
        check_fault("cameras.json", faults[i].words);
    }
}

static void inria_orthonormalised(void)
{
    fxs_view *views;
    remove_all();
    put_text("cameras.json", "[{\"width\":9,\"height\":5,\"fx\":1,\"fy\":1,\"position\":[1,0,0],"
                             "\"rotation\":[[1.0003,0.0002,0],[0,0.9997,-0.0004],[0.0003,0.0005,1]]}]");
    if (!CHECK(read_views("cameras.json", &views) == 1))
        return;
    const double *r = views->rotation;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            CHECK(fabs(r[3 * i] * r[3 * j] + r[3 * i + 1] * r[3 * j + 1] + r[3 * i + 2] * r[3 * j + 2] -
                       (i == j)) < 1e-15);
    CHECK(fabs(r[0] - 1) < 1e-6 && fabs(r[5] - 0.00045) < 1e-6 && fabs(r[7] + 0.00045) < 1e-6);
    free(views);
}

static void transforms(void)
{
    char top[512];
    remove_all();
    put_transforms("\"w\":640,\"h\":480,\"fl_x\":500.5,\"fl_y\":499.25,\"cx\":320,\"cy\":240,\"k1\":0.1,"
                   "\"camera_model\":\"OPENCV\",", "");
    check_camera("transforms.json", "b.jpg", 320, 240);
    put_transforms("\"w\":1,\"h\":2,\"fl_x\":3,\"camera_angle_x\":1,",
                   "\"w\":640.0,\"h\":480,\"fl_x\":500.5,\"fl_y\":499.25,\"cx\":300,\"cy\":200,");
    check_camera("transforms.json", "b.jpg", 300, 200);
    snprintf(top, sizeof top, "\"w\":640,\"h\":480,\"camera_angle_x\":%.17g,\"camera_angle_y\":%.17g,",
             2 * atan(320 / 500.5), 2 * atan(240 / 499.25));
    put_transforms(top, "");
    check_camera("transforms.json", "b.jpg", 320, 240);
    put_transforms("\"w\":640,\"h\":480,\"fl_x\":1,\"fl_y\":2,\"camera_angle_x\":1,", top);
    check_camera("transforms.json", "b.jpg", 320, 240);
    for (int i = 0; i < 3; i++)
        stretch[i] = 0.037;   /* the reader accepts a matrix with all columns scaled by the same factor */
    put_transforms(top, "");
    check_camera("transforms.json", "b.jpg", 320, 240);
    stretch[1] = 0.04;
    put_transforms(top, "");
    check_fault("transforms.json", "view b.jpg: rotation not orthonormal within 1e-3 with determinant 1, nor so times");
    stretch[0] = stretch[1] = stretch[2] = -1;
    put_transforms(top, "");
    check_fault("transforms.json", "mirrored, sheared or stretched");
    stretch[0] = stretch[1] = stretch[2] = 1;
}

static void blender(void)
{
    static const double axes[9] = {1, 0, 0, 0, -1, 0, 0, 0, -1};
    fxs_view *views;
    remove_all();
    put_text("transforms.json", "{\"camera_angle_x\":1.5707963267948966,\"frames\":[{\"file_path\":\"./train/r_0\","
                                "\"transform_matrix\":[[1,0,0,5],[0,1,0,6],[0,0,1,7],[0,0,0,1]]}]}");
    if (!CHECK(read_views("transforms.json", &views) == 1))
        return;
    CHECK(!strcmp(views->name, "./train/r_0") && views->width == 800 && views->height == 800);
    CHECK(fabs(views->fx - 400) < 1e-9 && views->fy == views->fx && views->cx == 400 && views->cy == 400);
    for (int i = 0; i < 9; i++)
        CHECK(fabs(views->rotation[i] - axes[i]) < 1e-15);
    CHECK(views->position[0] == 5 && views->position[1] == 6 && views->position[2] == 7);
    free(views);
}

static void angles(void)
{
    fxs_view *views;
    remove_all();
    for (double angle = 0.01; angle < 3.14; angle += 0.13) {
        char top[64];
        snprintf(top, sizeof top, "\"w\":640,\"h\":480,\"camera_angle_x\":%.17g,", angle);
        put_transforms(top, "");
        if (CHECK(read_views("transforms.json", &views) == 1)) {
            CHECK(fabs(views->fx * tan(angle / 2) / 320 - 1) < 1e-14 / cos(angle / 2));
            free(views);
        }
    }
    remove_all();
}

static void transforms_faults(void)
{
    remove_all();
    put_transforms("", "");
    check_fault("transforms.json", "view b.jpg: no focal length");
    put_transforms("\"camera_angle_x\":50,", "");
    check_fault("transforms.json", "view b.jpg: no focal length");
    put_transforms("\"fl_x\":null,\"camera_angle_x\":1,", "");
    check_fault("transforms.json", "view b.jpg: no focal length");
    put_transforms("\"fl_x\":500,\"w\":640,", "");
    check_fault("transforms.json", "view b.jpg: width and height");
    put_transforms("\"fl_x\":500,\"cx\":1e999,", "");
    check_fault("transforms.json", "view b.jpg: principal point");
    put_transforms("\"fl_x\":500,\"camera_model\":\"OPENCV_FISHEYE\",", "");
    check_bends("transforms.json", 1);
    put_transforms("\"fl_x\":500,\"camera_model\":\"EQUIRECTANGULAR\",", "");
    check_fault("transforms.json", "camera_model \"EQUIRECTANGULAR\" is not known here");
    put_text("transforms.json", "{\"frames\":[]}");
    check_fault("transforms.json", "no views");
    put_text("transforms.json", "{\"frames\":[{}]}");
    check_fault("transforms.json", "view 0: \"transform_matrix\"");
    put_text("transforms.json", "{\"frames\":[{\"transform_matrix\":[[1,0,0,0],[0,1,0,0],[0,0,1,0],[5,6,7,1]]}]}");
    check_fault("transforms.json", "last row");
}

static void too_many_values(void)
{
    size_t length = (size_t)17 << 20;
    char *text = malloc(length);
    if (!CHECK(text != NULL))
        return;
    for (size_t i = 0; i < length; i++)
        text[i] = i % 2 ? '0' : ',';
    text[0] = '[';
    text[length - 1] = ']';
    put("cameras.json", text, length);
    check_fault("cameras.json", "more than 8388608 values");
    free(text);
}

static void real_cameras(void)
{
    fxs_view *views;
    char path[1024];
    const char *scenes = getenv("FXS_SCENES");
    snprintf(path, sizeof path, "%s/snowmiku/cameras.json", scenes ? scenes : "../shared/scenes");
    if (access(path, R_OK))
        SKIP("no scenes");
    if (!CHECK(fxs_camera_file_read(path, &views, &message) == 97))
        return;
    CHECK(!strcmp(views[0].name, "20240212_003919.jpg") && views[96].width == 1200 && views[96].height == 900);
    CHECK(fabs(views[0].rotation[6] - 0.18865072947177312) < 1e-12 && fabs(views[0].fy - 993.6739021830649) < 1e-12);
    for (int i = 0; i < 97; i++)
        CHECK(views[i].rotation[6] * -views[i].position[0] + views[i].rotation[7] * -views[i].position[1] +
              views[i].rotation[8] * -views[i].position[2] > 0);
    free(views);
}

#else

static void without_cjson(void)
{
    put_text("cameras.json", "[]");
    check_fault("cameras.json", "built without cJSON");
}

#endif

static void control_characters_in_messages(void)
{
    static const struct {
        const char *text, *safe;
    } rows[] = {
        {"\033[1m\177 a\n", "?[1m? a?"},
        {"a\xc2\x80-\xc2\x9b-\xc2\x9f-\xc2\xa0", "a?-?-?-\xc2\xa0"},
        {"\xe2\x80\xa7-\xe2\x80\xa8-\xe2\x80\xa9-\xe2\x80\xaa-\xe2\x80\xae-\xe2\x80\xaf",
         "\xe2\x80\xa7-?-?-?-?-\xe2\x80\xaf"},
        {"\xe2\x81\xa5-\xe2\x81\xa6-\xe2\x81\xa9-\xe2\x81\xaa", "\xe2\x81\xa5-?-?-\xe2\x81\xaa"},
        {"\xc3\x84 \xe4\xb8\x80\xe4\xba\x9b \xf0\x9f\x98\x80 \xd0\x9b",
         "\xc3\x84 \xe4\xb8\x80\xe4\xba\x9b \xf0\x9f\x98\x80 \xd0\x9b"},
        {"\x9b" "1m \xc0\x9b \xe2\x80", "?1m \xc0? \xe2\x80"},
        {"\xe2\x80\033\xe2", "\xe2\x80?\xe2"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        CHECK(fxs_fail(&message, "%s", rows[i].text) == FXS_ERR_FILE && !strcmp(message.text, rows[i].safe));
}

static void camera_from_view(void)
{
    fxs_view view = {"", 640, 360, 501.25, 502.5, 303.75, 204.5, {0}, {7, -8.5, 9.25}, 0,
                          FXS_PERSPECTIVE, 0};
    const double rows[9] = {0, 0, 1, 1, 0, 0, 0, 1, 0};
    fxs_camera camera;
    memcpy(view.rotation, rows, sizeof rows);
    CHECK(fxs_camera_from_view(&camera, &view, &message) == 0);
    CHECK(camera.width == 640 && camera.height == 360);
    CHECK(camera.fx_q12 == 501.25 * 4096 && camera.fy_q12 == 502.5 * 4096);
    CHECK(camera.cx_q12 == 303.75 * 4096 && camera.cy_q12 == 204.5 * 4096);
    for (int i = 0; i < 9; i++)
        CHECK(camera.rotation_q30[i] == (rows[i] > 0 ? 1 << 30 : 0));
    for (int i = 0; i < 3; i++)
        CHECK(camera.position_q32[i] == (int64_t)(view.position[i] * 4294967296.0));
}

/* Computes the projection matrix of glFrustum or glOrtho from left, right, bottom, top, near, far. far = 0 means
   infinity. */
static void make_projection(double m[16], int flat, const double at[6])
{
    const double wide = at[1] - at[0], high = at[3] - at[2], deep = at[5] - at[4], near = at[4], far = at[5];
    memset(m, 0, 16 * sizeof *m);
    m[0] = (flat ? 2 : 2 * near) / wide;
    m[5] = (flat ? 2 : 2 * near) / high;
    m[flat ? 12 : 8] = (flat ? -1 : 1) * (at[1] + at[0]) / wide;
    m[flat ? 13 : 9] = (flat ? -1 : 1) * (at[3] + at[2]) / high;
    m[10] = flat ? -2 / deep : far > 0 ? -(far + near) / deep : -1;
    m[14] = flat ? -(far + near) / deep : far > 0 ? -2 * far * near / deep : -2 * near;
    m[11] = flat ? 0 : -1;
    m[15] = flat;
}

/* Makes an OpenGL view matrix. OpenGL's camera has y up and z back. */
static void make_view_matrix(double m[16])
{
    memset(m, 0, 16 * sizeof *m);
    for (int row = 0; row < 3; row++)
        for (int i = 0; i < 4; i++)
            m[4 * i + row] = (row ? -1 : 1) * (i < 3 ? rotation[3 * row + i] : translation[row]);
    m[15] = 1;
}

static void apply(double out[4], const double m[16], const double v[4])
{
    for (int row = 0; row < 4; row++) {
        out[row] = 0;
        for (int i = 0; i < 4; i++)
            out[row] += m[4 * i + row] * v[i];
    }
}

static void check_matrices(int flat, const double at[6])
{
    double view[16], projection[16], eye[4], clip[4];
    fxs_camera camera;
    make_view_matrix(view);
    make_projection(projection, flat, at);
    if (!CHECK(fxs_camera_from_matrices(&camera, view, projection, 640, 360, &message) == 0))
        return;
    CHECK(camera.projection == (flat ? FXS_ORTHOGRAPHIC : FXS_PERSPECTIVE));
    CHECK(fabs(ldexp((double)camera.near_q32, -32) - at[4]) < 1e-9);
    for (int i = 0; i < 27; i++) {
        const double world[4] = {i % 3 - 1.5, i / 3 % 3 + 0.25, i / 9 + 4, 1};
        double p[3] = {0, 0, 0};
        apply(eye, view, world);
        apply(clip, projection, eye);
        for (int k = 0; k < 9; k++)
            p[k / 3] += ldexp(camera.rotation_q30[k], -30) *
                        (world[k % 3] - ldexp((double)camera.position_q32[k % 3], -32));
        const double scale = flat ? 1 : p[2];
        const double x = ldexp(camera.fx_q12, -12) * p[0] / scale + ldexp(camera.cx_q12, -12);
        const double y = ldexp(camera.fy_q12, -12) * p[1] / scale + ldexp(camera.cy_q12, -12);
        CHECK(fabs(p[2] + eye[2]) < 1e-7);
        CHECK(fabs(x - 320 * (clip[0] / clip[3] + 1)) < 1e-3 * (1 + fabs(p[0] / scale)));
        CHECK(fabs(y - 180 * (1 - clip[1] / clip[3])) < 1e-3 * (1 + fabs(p[1] / scale)));
    }
}

static const double frustum[6] = {-0.1, 0.3, -0.05, 0.2, 0.25, 50};

static void refuses_matrices(const double view[16], const double projection[16], const char *words)
{
    fxs_camera camera;
    const int error = fxs_camera_from_matrices(&camera, view, projection, 640, 360, &message);
    if (!CHECK(error == FXS_ERR_CAMERA && strstr(message.text, words) && !strchr(message.text, '\n')))
        printf("  %d, \"%s\", expected \"%s\"\n", error, message.text, words);
}

static void bad_projections(const double view[16])
{
    static const struct { int at; double factor, added; const char *words; } changes[] = {
        {0, -1, 0, "neither"}, {0, 0, 0, "neither"}, {5, -1, 0, "neither"}, {4, 1, 0.1, "neither"},
        {3, 1, 0.1, "neither"}, {11, -1, 0, "neither"}, {11, 0, 0, "neither"}, {12, 1, 0.1, "neither"},
        {15, 1, 1, "neither"}, {5, 1, NAN, "neither"}, {10, 1, INFINITY, "neither"}, {0, 1e6, 0, "focal length"},
        {8, 1, 1e6, "principal point"}, {10, -1, 0, "near plane"}, {14, -1, 0, "near plane"},
        {14, 1e-8, 0, "near plane"}, {14, 0, 0, "near plane"}};
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        double m[16];
        make_projection(m, 0, frustum);
        m[changes[i].at] = m[changes[i].at] * changes[i].factor + changes[i].added;
        refuses_matrices(view, m, changes[i].words);
    }
    const double behind[6] = {-1, 1, -1, 1, -1, 10};
    double flat[16];
    make_projection(flat, 1, behind);
    refuses_matrices(view, flat, "near plane");
    make_projection(flat, 1, frustum);
    flat[8] = 0.1;
    refuses_matrices(view, flat, "neither");
}

static void camera_from_matrices(void)
{
    static const double endless[6] = {-0.2, 0.2, -0.1, 0.1, 0.1, 0}, box[6] = {-3, 5, -2, 1, 0.5, 40};
    static const struct { int at; double added; const char *words; } changes[] = {
        {3, 0.1, "last row"}, {15, 1, "last row"}, {0, 0.01, "scales, shears"}, {9, 0.01, "scales, shears"},
        {5, NAN, "not finite"}, {13, INFINITY, "not finite"}, {14, 1e9, "a position of"}};
    double view[16], changed[16], projection[16];
    fxs_camera camera;
    check_matrices(0, frustum);
    check_matrices(0, endless);
    check_matrices(1, box);
    make_view_matrix(view);
    make_projection(projection, 0, frustum);
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        memcpy(changed, view, sizeof view);
        changed[changes[i].at] += changes[i].added;
        refuses_matrices(changed, projection, changes[i].words);
    }
    memcpy(changed, view, sizeof view);
    for (int i = 0; i < 4; i++)
        changed[4 * i] = -view[4 * i];
    refuses_matrices(changed, projection, "mirrors");
    bad_projections(view);
    CHECK(fxs_camera_from_matrices(&camera, view, projection, 0, 360, &message) == FXS_ERR_SIZE);
    CHECK(fxs_camera_from_matrices(&camera, view, projection, 640, FXS_MAX_SIZE + 1, &message) == FXS_ERR_SIZE);
}

static void view_resized(void)
{
    const fxs_view before = {.width = 640, .height = 480, .fx = 500, .fy = 510, .cx = 300.3, .cy = 250.7};
    fxs_view view = before;
    fxs_view_resize(&view, 640, 480);
    CHECK(view.fx == before.fx && view.fy == before.fy && view.cx == before.cx && view.cy == before.cy);
    fxs_view_resize(&view, 1280, 960);
    CHECK(view.fx == 1000 && view.fy == 1020 && fabs(view.cx - 600.6) < 1e-9 && fabs(view.cy - 501.4) < 1e-9);
    view = before;
    fxs_view_resize(&view, 320, 480);
    CHECK(fabs(view.fx * view.fy - before.fx * before.fy / 2) < 1e-6 && fabs(view.fy / view.fx - 1.02) < 1e-12);
    CHECK(fabs(view.cx - 160 + 19.7 * sqrt(0.5)) < 1e-9 && fabs(view.cy - 240 - 10.7 * sqrt(0.5)) < 1e-9);
    view = before;
    fxs_view_resize(&view, 333, 250);   /* 3 : 4 of 333 is 249.75 */
    CHECK(view.fx == 500 * (333 / 640.0) && view.fy == 510 * (333 / 640.0));
}

static void view_of_a_box(void)
{
    const double low[3] = {1, 20, -300}, high[3] = {5, 24, -290}, up[3] = {0, -1, 0};
    fxs_view view;
    CHECK(fxs_view_frame_box(&view, low, high, up, &(fxs_picture){50, 640, 360}, &message) == 0);
    for (int corner = 0; corner <= 8; corner++) {
        double p[3] = {0, 0, 0};
        for (int i = 0; i < 3; i++) {
            double at = corner == 8 ? (low[i] + high[i]) / 2 : corner >> i & 1 ? high[i] : low[i];
            for (int k = 0; k < 3; k++)
                p[k] += view.rotation[3 * k + i] * (at - view.position[i]);
        }
        const double x = view.fx * p[0] / p[2] + view.cx, y = view.fy * p[1] / p[2] + view.cy;
        CHECK(p[2] > 0.2 && x >= 0 && x <= 640 && y >= 0 && y <= 360);
        CHECK(corner < 8 || (fabs(x - 320) < 1e-6 && fabs(y - 180) < 1e-6));
    }
    static const double wrong[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 18; i++) {
        double ends[6] = {1, 20, -300, 5, 24, -290};
        ends[i % 6] = wrong[i / 6];
        CHECK(fxs_view_frame_box(&view, ends, ends + 3, up, &(fxs_picture){50, 640, 360},
                                 &message) == FXS_ERR_ARGUMENT);
    }
    const double far_low[3] = {-1.7e308, 0, 0}, far_high[3] = {1.7e308, 1, 1};
    CHECK(fxs_view_frame_box(&view, far_low, far_high, up, &(fxs_picture){50, 640, 360}, &message) == FXS_ERR_ARGUMENT);
}

/* Interpolates a camera path at `at`. state: position, viewing direction, log focal length. */
static void state_at(const fxs_view *keys, long count, double at, double state[7])
{
    fxs_view view;
    fxs_view_between(keys, count, at, &view);
    memcpy(state, view.position, sizeof view.position);
    memcpy(state + 3, view.rotation + 6, 3 * sizeof *state);
    state[6] = log(view.fx);
}

static void start_views(void)
{
    static const double ups[3][3] = {{0, -1, 0}, {0, 1, 0}, {1, 0.2, 0.3}}, middle[3] = {0, 0, 0};
    unsigned char scene[sizeof(fxs_packed_header)] = {0}, bad[sizeof scene];
    fxs_view view, again;
    CHECK(fxs_view_of_start(&again, scene, 64, 48) == 0);
    for (int i = 0; i < 3 * 24; i++) {
        const double eye[3] = {3 - i % 5, 1.5 - i % 3, -4.25}, fov = 1 + 169 * i / 71.0;
        if (!CHECK(!fxs_view_look_at(&view, eye, middle, ups[i / 24], &(fxs_picture){fov, 640, 480}, &message)))
            return;
        fxs_view_orbit(&view, middle, ups[(i + 1) % 3], i % 24 * 0.2617993877991494);
        if (!CHECK(!fxs_view_to_start(scene, &view, &message) && fxs_view_of_start(&again, scene, 64, 48) == 1))
            return;
        CHECK(again.width == 64 && again.height == 48 && fabs(again.fx / view.fx - 0.1) < 1e-6 && again.fy == again.fx);
        CHECK(again.cx == 32 && again.cy == 24 && again.projection == FXS_PERSPECTIVE);
        for (int k = 0; k < 9; k++)
            CHECK(fabs(again.rotation[k] - view.rotation[k]) < 1e-7);
        for (int k = 0; k < 3; k++)
            CHECK(fabs(again.position[k] - view.position[k]) < 1e-9);
    }
    view.projection = FXS_ORTHOGRAPHIC;
    CHECK(fxs_view_to_start(scene, &view, &message) == FXS_ERR_CAMERA);
    for (int k = 0; k < 3; k++) {
        memcpy(bad, scene, sizeof bad);
        memset(bad + (k == 0 ? 148 : k == 1 ? 152 : 176), 0x7f, k == 0 ? 4 : k == 1 ? 8 : 12);
        CHECK(fxs_view_of_start(&again, bad, 64, 48) == 0);
    }
}

/* Returns the largest |x / z| or |y / z| in camera space of points on the ellipsoid in a box, 1.2 times as large. */
static double reach_by_points(const fxs_view *view, const double low[3], const double high[3], int axis)
{
    double most = 0;
    for (int i = 0; i <= 400; i++)
        for (int k = 0; k < 800; k++) {
            const double polar = 3.141592653589793 * i / 400, round = 6.283185307179586 * k / 800;
            const double on[3] = {sin(polar) * cos(round), sin(polar) * sin(round), cos(polar)};
            double seen[3] = {0};
            for (int row = 0; row < 3; row++)
                for (int j = 0; j < 3; j++) {
                    const double at = (low[j] + high[j]) / 2 + 1.2 * (high[j] - low[j]) / 2 * on[j];
                    seen[row] += view->rotation[3 * row + j] * (at - view->position[j]);
                }
            most = fmax(most, fabs(seen[axis]) / seen[2]);
        }
    return most;
}

/* A start view widens in pictures higher than wide, and only there. */
static void start_views_in_portrait(void)
{
    static const double low[3] = {-1, -2, -0.5}, high[3] = {2, 1, 0.5}, up[3] = {0.1, -1, 0.2}, look[3] = {0.3, 0, 0};
    static const double eyes[3][3] = {{1, -2, -7}, {-9, 1, 3}, {0.4, -0.2, 0.1}};
    static const int sizes[6][2] = {{200, 100}, {100, 100}, {90, 100}, {70, 100}, {50, 100}, {10, 100}};
    for (int i = 0; i < 3; i++) {
        unsigned char scene[sizeof(fxs_packed_header)] = {0};
        fxs_packed_header h = {0};
        fxs_view view, seen;
        for (int k = 0; k < 3; k++) {
            h.inner_low_q32[k] = (int64_t)ldexp(low[k], 32);
            h.inner_high_q32[k] = (int64_t)ldexp(high[k], 32);
        }
        fxs_packed_header_turn(&h);
        memcpy(scene, &h, sizeof h);
        if (!CHECK(!fxs_view_look_at(&view, eyes[i], look, up, &(fxs_picture){15, 640, 360}, &message) &&
                   !fxs_view_to_start(scene, &view, &message)))
            return;
        const double tangent = 180 / view.fy, reach = i == 2 ? 0 : reach_by_points(&view, low, high, 0);
        CHECK(fabs(fxs_view_reach(&view, low, high, 0) - reach) < 1e-3 * reach + 1e-9);
        CHECK(i == 2 || fabs(fxs_view_reach(&view, low, high, 1) / reach_by_points(&view, low, high, 1) - 1) < 1e-3);
        for (int k = 0; k < 6; k++) {
            const double tall = (double)sizes[k][1] / sizes[k][0];
            const double sides = fmin(fmin(reach, tangent * 16 / 9), tangent * tall);
            const double wanted = tall > 1 ? fmax(tangent, fmin(sides * tall, 12)) : tangent;
            CHECK(fxs_view_of_start(&seen, scene, sizes[k][0], sizes[k][1]) == 1);
            CHECK(fabs(sizes[k][1] / 2.0 / seen.fy / wanted - 1) < 2e-3 && seen.fx == seen.fy);
        }
    }
}

static double along(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void up_of_a_scene(void)
{
    unsigned char scene[sizeof(fxs_packed_header)] = {0}, again[sizeof scene];
    fxs_start start, found;
    fxs_start_of(&start, scene);
    CHECK(start.up[0] == 0 && start.up[1] == 0 && start.up[2] == 0 && start.tangent == 0);
    start = (fxs_start){.tangent = 0.5, .position = {1, -2, 3.25}, .rotation = {0.5, -0.5, 0.5, 0.5}};
    for (int i = 0; i < 4000; i++) {
        const double z = i % 4 ? 1 - i / 2000.0 : i % 8 ? 1e-5 : -1e-5, around = i * 2.399963229728653;
        start.up[0] = 7 * sqrt(1 - z * z) * cos(around);
        start.up[1] = 7 * sqrt(1 - z * z) * sin(around);
        start.up[2] = 7 * z;
        fxs_start_to(scene, &start);
        fxs_start_of(&found, scene);
        const double cosine = along(found.up, start.up) / 7;
        CHECK(cosine > cos(0.01 * 0.017453292519943295) && fabs(along(found.up, found.up) - 1) < 1e-12);
        CHECK(!memcmp(&found.tangent, &start.tangent, sizeof found - offsetof(fxs_start, tangent)));
        memcpy(again, scene, sizeof again);
        fxs_start_to(again, &found);
        CHECK(!memcmp(again, scene, sizeof again));
    }
    for (int i = 0; i < 6; i++) {
        const double up[3] = {i < 2 ? 1 - 2 * i : 0, i / 2 == 1 ? 5 - 2 * i : 0, i / 2 == 2 ? 9 - 2 * i : 0};
        memcpy(start.up, up, sizeof up);
        fxs_start_to(scene, &start);
        fxs_start_of(&found, scene);
        CHECK(found.up[0] == up[0] && found.up[1] == up[1] && found.up[2] == up[2]);
    }
}

static void start_that_is_none(void)
{
    static const uint32_t codes[] = {0x7fffffff, 0x80000000 | 0x4000 << 1, 0x80000000 | (uint32_t)0x4000 << 16};
    unsigned char scene[sizeof(fxs_packed_header)] = {0};
    const fxs_start known = {{0, 0, 1}, 0.5, {1, 2, 3}, {1, 0, 0, 0}};
    const double wrong[][3] = {{0, 0, 0}, {NAN, 0, 1}, {INFINITY, 0, 0}, {1e308, 1e308, 0}};
    fxs_start start;
    for (size_t i = 0; i < sizeof codes / sizeof *codes; i++) {
        const uint32_t flags = fxs_little_32(codes[i]);
        memcpy(scene + 24, &flags, sizeof flags);
        fxs_start_of(&start, scene);
        CHECK(start.up[0] == 0 && start.up[1] == 0 && start.up[2] == 0);
    }
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        start = known;
        memcpy(start.up, wrong[i], sizeof start.up);
        fxs_start_to(scene, &start);
        fxs_start_of(&start, scene);
        CHECK(start.up[0] == 0 && start.up[1] == 0 && start.up[2] == 0 && start.tangent == 0.5);
    }
    for (int i = 0; i < 4; i++) {
        start = known;
        if (i < 2)
            start.tangent = i ? 13 : -1;
        else if (i == 2)
            start.position[1] = NAN;
        else
            start.rotation[2] = 0.5;
        fxs_start_to(scene, &start);
        fxs_start_of(&start, scene);
        CHECK(start.up[2] == 1 && start.tangent == 0 && start.position[0] == 0 && start.rotation[0] == 0);
    }
}

static void start_is_placed(void)
{
    fxs_placement p;
    fxs_start start = {{0, 0, 1}, 0.5, {1, 2, 3}, {1, 0, 0, 0}}, plain = start;
    fxs_placement_init(&p, 0, 0);
    fxs_placement_start(&p, &start);
    CHECK(!memcmp(&start, &plain, sizeof start));
    fxs_placement_turn(&p, 0, 90);     /* rotates the scene: the y axis to z, and z to -y */
    for (int i = 0; i < 4; i++)
        p.rotation[i] *= 3;
    p.scale = 2;
    p.translation[2] = 10;
    fxs_placement_start(&p, &start);
    const double up[3] = {0, -1, 0}, eye[3] = {2, -6, 14}, back = sqrt(0.5);
    for (int k = 0; k < 3; k++)
        CHECK(fabs(start.up[k] - up[k]) < 1e-12 && fabs(start.position[k] - eye[k]) < 1e-12);
    CHECK(fabs(start.rotation[0] - back) < 1e-12 && fabs(start.rotation[1] + back) < 1e-12 && start.tangent == 0.5);
    p.translation[0] = 0x1p28;
    fxs_placement_start(&p, &start);
    CHECK(start.tangent == 0 && start.position[0] == 0 && fabs(start.up[2] + 1) < 1e-12);
}

static void start_view_is_upright(void)
{
    enum { COUNT = 12, LEVEL = 7 };
    static const double middle[3] = {1, 2, 3}, up[3] = {0.6, 0, 0.8};
    unsigned char scene[sizeof(fxs_packed_header)] = {0};
    fxs_fit_photo photos[COUNT];
    fxs_view first;
    double found[3];
    for (int i = 0; i < COUNT; i++) {
        const double height = i == LEVEL ? -0.2 : 1;
        const double eye[3] = {1 + 4 * 0.8 + height * 0.6, 2, 3 - 4 * 0.6 + height * 0.8};
        fxs_view *view = &photos[i].view;
        CHECK(!fxs_view_look_at(view, eye, middle, up, &(fxs_picture){50, 64, 48}, &message));
        fxs_view_orbit(view, middle, up, i * 0.5235987755982988);
        const double forward[3] = {view->rotation[6], view->rotation[7], view->rotation[8]};
        fxs_view_orbit(view, view->position, forward, i % 2 ? 0.05 : -0.05);
    }
    CHECK(fxs_views_up(&photos->view, COUNT, sizeof *photos, found) == 1);
    CHECK(along(found, up) > 1 - 1e-6 && fabs(along(found, found) - 1) < 1e-12);
    /* The mean of the cameras' up vectors leans, but all right vectors are horizontal. */
    CHECK(fxs_views_up(&photos->view, COUNT / 2, sizeof *photos, found) == 1);
    CHECK(along(found, up) > 0.9998);
    CHECK(!fxs_fit_start_view(photos, COUNT, scene, &message) && fxs_view_of_start(&first, scene, 64, 48) == 1);
    CHECK(fabs(along(first.rotation, up)) < 1e-3 && along(first.rotation + 3, up) < -0.9);
    for (int k = 0; k < 3; k++) {
        CHECK(fabs(first.rotation[6 + k] - photos[LEVEL].view.rotation[6 + k]) < 1e-7);
        CHECK(fabs(first.position[k] - photos[LEVEL].view.position[k]) < 1e-9);
    }
    CHECK(fabs(first.fy - photos->view.fy) < 1e-4);
    fxs_start start;
    fxs_start_of(&start, scene);
    CHECK(along(start.up, up) > cos(0.02));

    photos[1] = photos[0];
    for (int k = 0; k < 6; k++)
        photos[1].view.rotation[k] = -photos[0].view.rotation[k];
    CHECK(fxs_views_up(&photos->view, 2, sizeof *photos, found) == 0);
    CHECK(!fxs_fit_start_view(photos, 2, scene, &message) && fxs_view_of_start(&first, scene, 64, 48) == 1);
    for (int k = 0; k < 9; k++)
        CHECK(fabs(first.rotation[k] - photos->view.rotation[k]) < 1e-7);
    fxs_start_of(&start, scene);
    CHECK(along(start.up, start.up) == 0);
    CHECK(fxs_view_level(&first, first.rotation + 6) == 0);
    CHECK(fxs_fit_start_view(photos, 0, scene, &message) == FXS_ERR_ARGUMENT);
}

static void up_of_a_view(void)
{
    static const double middle[3] = {0, 0, 0};
    for (int i = 0; i < 6 * 24; i++) {
        const int axis = i % 3, sign = i / 3 % 2 ? 1 : -1;
        const double height = (i / 6 % 4 - 1) * 1.5, turn = 0.3 + i / 24 * 0.4;
        double up[3] = {0, 0, 0}, eye[3], found[3];
        fxs_view view;
        up[axis] = sign;
        eye[axis] = sign * height;
        eye[(axis + 1) % 3] = 2 * cos(turn);
        eye[(axis + 2) % 3] = 2 * sin(turn);
        CHECK(!fxs_view_look_at(&view, eye, middle, up, &(fxs_picture){50, 64, 48}, &message));
        fxs_view_up(&view, found);
        CHECK(along(found, up) > 1 - 1e-12);
    }
    const double eye[3] = {1, 2, 3}, up[3] = {0.6, 0, 0.8};
    double found[3];
    fxs_view view;
    CHECK(!fxs_view_look_at(&view, eye, middle, up, &(fxs_picture){50, 64, 48}, &message));
    fxs_view_up(&view, found);
    for (int k = 0; k < 3; k++)
        CHECK(found[k] == -view.rotation[3 + k]);
}

static void way_is_smooth(void)
{
    enum { KEYS = 6 };
    static const double eyes[KEYS][3] = {{0, 0, -6}, {3, -1, -5}, {6, 0, 0}, {2, 1, 5}, {-4, 0, 3}, {-6, -2, -1}};
    static const double middle[3] = {0, 0, 0}, up[3] = {0, -1, 0};
    const double h = 1e-6;
    fxs_view keys[KEYS], view;
    for (int i = 0; i < KEYS; i++) {
        CHECK(!fxs_view_look_at(&keys[i], eyes[i], middle, up, &(fxs_picture){30 + 10 * (i % 3), 64, 48}, &message));
        keys[i].near = 0.2;
    }
    for (long i = 1; i < KEYS - 1; i++) {
        double before[7], here[7], behind[7];
        state_at(keys, KEYS, (double)i - h, before);
        state_at(keys, KEYS, (double)i, here);
        state_at(keys, KEYS, (double)i + h, behind);
        for (int k = 0; k < 7; k++)
            CHECK(fabs((behind[k] - here[k]) - (here[k] - before[k])) < 1e-4 * h);
    }
    for (double at = 0; at <= KEYS - 1; at += 0.05) {
        fxs_view_between(keys, KEYS, at, &view);
        for (int i = 0; i < 9; i++) {
            const double *a = view.rotation + i / 3 * 3, *b = view.rotation + i % 3 * 3;
            CHECK(fabs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2] - (i % 4 == 0)) < 1e-12);
        }
    }
}

int main(void)
{
    if (!mkdtemp(folder)) {
        perror(folder);
        return 1;
    }
    make_camera();
    RUN(control_characters_in_messages);
    RUN(camera_from_view);
    RUN(camera_from_matrices);
    RUN(view_resized);
    RUN(view_of_a_box);
    RUN(start_views);
    RUN(start_views_in_portrait);
    RUN(up_of_a_scene);
    RUN(start_that_is_none);
    RUN(start_is_placed);
    RUN(start_view_is_upright);
    RUN(up_of_a_view);
    RUN(way_is_smooth);
    RUN(colmap_bin);
    RUN(colmap_txt);
    RUN(colmap_models);
    RUN(colmap_images);
    RUN(colmap_bin_faults);
    RUN(colmap_long_name);
    RUN(no_file);
#ifdef FXS_WITH_CJSON
    RUN(inria);
    RUN(inria_extended);
    RUN(inria_faults);
    RUN(written);
    RUN(inria_orthonormalised);
    RUN(transforms);
    RUN(blender);
    RUN(angles);
    RUN(transforms_faults);
    RUN(too_many_values);
    RUN(real_cameras);
#else
    RUN(without_cjson);
#endif
    remove_all();
    rmdir(folder);
    return check_report();
}
