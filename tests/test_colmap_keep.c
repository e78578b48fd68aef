/* Tests that a COLMAP model to which photographs were added keeps its old cameras and its place. */
#include <math.h>

#include <fixsplat/camera.h>
#include "src/camera/colmap_keep.h"
#include "src/fit/photos/photo_points.h"
#include "folder.h"

static fxs_message message;
static uint8_t bytes[4096];
static size_t size;

static void give(uint64_t value, int count)
{
    for (int i = 0; i < count; i++)
        bytes[size++] = (uint8_t)(value >> 8 * i);
}

static void give_double(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, 8);
    give(bits, 8);
}

/* Image `number` stands at (number, number^2, 1) and is turned about the y axis; `moved` 1: in a model that is half as
   large and shifted by (3, -1, 2). */
static void give_image(int number, int moved)
{
    const double half = 0.1 * number, w = cos(half), y = sin(half), c = cos(2 * half), s = sin(2 * half);
    double at[3] = {number, number * number, 1};
    const double shift[3] = {3, -1, 2};
    for (int k = 0; k < 3; k++)
        at[k] = moved ? 0.5 * at[k] + shift[k] : at[k];
    give((uint64_t)number, 4);
    give_double(w);
    give_double(0);
    give_double(y);
    give_double(0);
    give_double(-(c * at[0] + s * at[2]));
    give_double(-at[1]);
    give_double(-(-s * at[0] + c * at[2]));
    give(1, 4);
    bytes[size++] = (uint8_t)('0' + number);
    bytes[size++] = 0;
    give(1, 8);                    /* a point of the picture, of point 7 of the scene */
    give_double(1);
    give_double(2);
    give(7, 8);
}

static void put_model(const char *model, const char *images, int moved)
{
    char name[64];
    mkdir(in_folder(model), 0777);
    size = 0;
    give(1, 8);
    give(1, 4);
    give(1, 4);
    give(40, 8);
    give(30, 8);
    for (int i = 0; i < 4; i++)
        give_double(i < 2 ? 30 + moved : 20);
    snprintf(name, sizeof name, "%s/cameras.bin", model);
    put_file(name, bytes, size);
    size = 0;
    give(strlen(images), 8);
    for (const char *c = images; *c; c++)
        give_image(*c - '0', moved);
    snprintf(name, sizeof name, "%s/images.bin", model);
    put_file(name, bytes, size);
    size = 0;
    give(1, 8);
    give(7, 8);
    for (int k = 0; k < 3; k++)
        give_double(moved ? 0.5 * (k + 4) + (k == 0 ? 3 : k == 1 ? -1 : 2) : k + 4);
    give(0x332211, 3);
    give_double(0.5);
    give(1, 8);
    give(0, 8);
    snprintf(name, sizeof name, "%s/points3D.bin", model);
    put_file(name, bytes, size);
}

static int keep(void)
{
    return fxs_colmap_keep(in_folder("before"), in_folder("after"), &message);
}

static long read_views(const char *name, fxs_view **views)
{
    const long count = fxs_camera_file_read(in_folder(name), views, &message);
    return CHECK(count > 0) ? count : 0;
}

static void new_images_come_back(void)
{
    fxs_view *before, *after;
    fxs_photo_points points = {0};
    put_model("before", "12357", 0);
    put_model("after", "123456", 1);
    if (!CHECK(!keep()) || !CHECK(read_views("before", &before) == 5) || !CHECK(read_views("after", &after) == 7))
        return;
    for (int i = 0; i < 7; i++) {  /* sorted by name: 1, 2, 3, 4, 5, 6, 7 */
        const double expected[3] = {i + 1, (i + 1) * (i + 1), 1};
        for (int k = 0; k < 3; k++)
            CHECK(fabs(after[i].position[k] - expected[k]) < 1e-9);
    }
    CHECK(!memcmp(&before[0], &after[0], sizeof *before) && !memcmp(&before[3], &after[4], sizeof *before));
    CHECK(!memcmp(&before[4], &after[6], sizeof *before));     /* an image that the model had lost */
    if (CHECK(!fxs_photo_points_colmap(&points, in_folder("after/points3D.bin"), &message) && points.count == 1))
        for (int k = 0; k < 3; k++)
            CHECK(fabs((double)points.points[0].position[k] - (k + 4)) < 1e-6);
    CHECK(points.last == 7);
    free(points.points);
    free(before);
    free(after);
}

static void only_new_points_are_read(void)
{
    fxs_photo_points points = {.after = 6};
    CHECK(!fxs_photo_points_colmap(&points, in_folder("before/points3D.bin"), &message) && points.count == 1);
    free(points.points);
    points = (fxs_photo_points){.after = 7};
    CHECK(!fxs_photo_points_colmap(&points, in_folder("before/points3D.bin"), &message) && points.count == 0);
    free(points.points);
}

static void bad_models_are_refused(void)
{
    put_model("after", "456", 1);
    CHECK(keep() == FXS_ERR_FILE && strstr(message.text, "has too few of the images") != NULL);
    put_model("after", "1234", 1);
    static const char *const names[] = {"after/images.bin", "after/points3D.bin", "after/cameras.bin", NULL};
    for (const char *const *name = names; *name; name++) {
        static uint8_t whole[4096];
        FILE *file = fopen(in_folder(*name), "rb");
        const size_t all = file ? fread(whole, 1, sizeof whole, file) : 0;
        fclose(file);
        for (size_t cut = 0; cut < all; cut++) {
            put_file(*name, whole, cut);
            if (!CHECK(keep() == FXS_ERR_FILE))
                printf("  %s, cut to %zu bytes\n", *name, cut);
        }
        put_file(*name, whole, all);
    }
    CHECK(!keep());
    CHECK(fxs_colmap_keep(in_folder("none"), in_folder("after"), &message) == FXS_ERR_FILE);
}

static void tests(void)
{
    RUN(new_images_come_back);
    RUN(only_new_points_are_read);
    RUN(bad_models_are_refused);
}

int main(void)
{
    return in_a_folder(tests);
}
