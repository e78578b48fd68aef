/* Tests edits by hand: what shapes select, compared with a plain computation; deleting, keeping, taking back and
   writing; and files of edits, good and bad. Expected numbers are the same on every machine. */
#include <math.h>
#include <string.h>

#include <fixsplat/pack.h>
#include <fixsplat/internal/edits.h>
#include <fixsplat/internal/packed.h>
#include "folder.h"

enum { SIDE = 20, COUNT = SIDE * SIDE * SIDE, WIDTH = 200, HEIGHT = 160 };

typedef struct edited {
    fxs_packed_scene packed;
    fxs_scene scene;
    fxs_editor editor;
    fxs_context context;
    uint32_t slots[COUNT];
} edited;

static fxs_message message;

/* Two groups of Gaussians side by side, a red one at x < 10 and a green one, if `has_two`; then nothing is between. */
static int has_two;

/* A cube of SIDE^3 opaque Gaussians in a shuffled order, at whole coordinates from 0 on. Every 1000th has a NaN. */
static long read_cube(void *argument, uint64_t first, fxs_gaussian *out, size_t capacity)
{
    (void)argument;
    for (size_t i = 0; i < capacity; i++) {
        const uint32_t n = (uint32_t)((first + i) * 4421 % COUNT);
        out[i] = (fxs_gaussian){.position = {(float)(n % SIDE), (float)(n / SIDE % SIDE), (float)(n / SIDE / SIDE)},
                                .scale = {-0.7f, -0.7f, -0.7f}, .rotation = {1, 0, 0, 0}, .opacity = 5,
                                .dc = {(float)(n % 7), 0, 0}};
        if (has_two) {
            out[i].dc[0] = n % SIDE < SIDE / 2 ? 1.5f : -1.5f;
            out[i].dc[1] = -out[i].dc[0];
            out[i].position[0] += n % SIDE < SIDE / 2 ? -4.0f : 4.0f;
        }
        if (n % 1000 == 0)
            out[i].dc[0] = NAN;
    }
    return (long)capacity;
}

static edited *cube(enum fxs_profile profile)
{
    static edited e;
    const fxs_gaussian_source source = {COUNT, 0, 0, read_cube, NULL, {0}};
    const fxs_pack_options how = {.size = sizeof how, .profile = profile, .slots = e.slots};
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_pack_report report;
    CHECK(!fxs_scene_file_open_gaussians("cube", &source, NULL, &file, &info, &message));
    CHECK(!fxs_pack(file, &info, &e.packed, &report, &how, &message));
    fxs_scene_file_close(file);
    CHECK(!fxs_file_seal(e.packed.data, e.packed.bytes));
    CHECK(!fxs_scene_open(&e.scene, e.packed.data, e.packed.bytes));
    CHECK(!fxs_editor_open(&e.editor, &e.scene, &message));
    fxs_context_init(&e.context, NULL);
    return &e;
}

static void end(edited *e)
{
    fxs_editor_close(&e->editor);
    fxs_packed_scene_free(&e->packed);
}

/* Before the cube, in the middle of its sides, looking along z: the layer at z is at depth z + 20. */
static fxs_camera camera_of(void)
{
    fxs_camera c;
    fxs_camera_init(&c, WIDTH, HEIGHT);
    c.position_q32[0] = c.position_q32[1] = (int64_t)19 << 31;
    c.position_q32[2] = -((int64_t)20 << 32);
    return c;
}

static const int32_t corners[] = {60, 40, 140, 40, 140, 120, 60, 120};

static fxs_edit_shape lasso(void)
{
    return (fxs_edit_shape){.kind = FXS_EDIT_LASSO, .camera = camera_of(), .points = corners, .point_numbers = 8};
}

static int select(edited *e, fxs_edit_shape shape)
{
    const int error = fxs_editor_select(&e->editor, &e->context, &shape, &message);
    return error ? error : (int)e->editor.chosen;
}

/* Counts the finite Gaussians of the cube that a test in float coordinates accepts. */
static int count_by(int (*is_in)(int x, int y, int z))
{
    int count = 0;
    for (int n = 0; n < COUNT; n++)
        count += n % 1000 != 0 && is_in(n % SIDE, n / SIDE % SIDE, n / SIDE / SIDE);
    return count;
}

static int in_box(int x, int y, int z)
{
    return x >= 2 && x <= 5 && y <= 9 && z >= 18;
}

static int in_sphere(int x, int y, int z)
{
    return x * x + y * y + z * z <= 25;
}

/* Pixel of a centre: focal length WIDTH / 2, and the principal point in the middle. */
static int in_lasso(int x, int y, int z)
{
    const double px = floor(100.0 * (x - 9.5) / (z + 20) + 100), py = floor(100.0 * (y - 9.5) / (z + 20) + 80);
    return px >= 60 && px < 140 && py >= 40 && py < 120;
}

static int in_disc(int x, int y, int z)
{
    const double px = floor(100.0 * (x - 9.5) / (z + 20) + 100), py = floor(100.0 * (y - 9.5) / (z + 20) + 80);
    return (px - 90) * (px - 90) + (py - 70) * (py - 70) <= 225;
}

static void test_shapes(void)
{
    static const int32_t disc[] = {90, 70, 15}, star[] = {100, 20, 140, 140, 40, 60, 160, 60, 60, 140};
    for (int profile = 0; profile < 3; profile++) {
        edited *e = cube((enum fxs_profile)profile);
        fxs_edit_shape brush = lasso(), five = lasso(), less = lasso();
        brush.kind = FXS_EDIT_BRUSH;
        brush.points = disc;
        brush.point_numbers = 3;
        five.points = star;
        five.point_numbers = 10;
        less.subtract = 1;
        CHECK(select(e, (fxs_edit_shape){.numbers = {1.9, -1, 17.9, 5.1, 9.1, 30}}) == count_by(in_box));
        fxs_editor_clear(&e->editor);
        CHECK(select(e, (fxs_edit_shape){.kind = FXS_EDIT_SPHERE, .numbers = {0, 0, 0, 5.02}}) == count_by(in_sphere));
        fxs_editor_clear(&e->editor);
        const int all = select(e, lasso());
        CHECK(abs(all - count_by(in_lasso)) <= 8 && all > 1000);      /* codes round places at the edges */
        CHECK(select(e, less) == 0);
        CHECK(abs(select(e, brush) - count_by(in_disc)) <= 20);
        fxs_editor_clear(&e->editor);
        const int points = select(e, five);              /* the star's middle is outside by the even-odd rule */
        CHECK(points > 200 && points < all);
        end(e);
    }
}

/* A camera beside the cube, turned about y by the angle with the cosine 0.6. */
static void test_turned(void)
{
    for (int profile = 0; profile < 3; profile++) {
        edited *e = cube((enum fxs_profile)profile);
        fxs_edit_shape shape = lasso();
        int32_t *r = shape.camera.rotation_q30;
        r[0] = r[8] = 644245094;
        r[2] = -(r[6] = 858993459);
        shape.camera.position_q32[0] -= (int64_t)20 << 32;
        const int through = select(e, shape);
        fxs_editor_clear(&e->editor);
        shape.front = 1;
        const int first = select(e, shape);
        if (!CHECK(through == 4812 && first == 334))
            printf("  profile %d: %d, %d\n", profile, through, first);
        end(e);
    }
}

static void test_front(void)
{
    edited *e = cube(FXS_PROFILE_DEFAULT);
    fxs_edit_shape front = lasso();
    front.front = 1;
    const int first = select(e, front);
    CHECK(first == 256);                                 /* one layer, 16 x 16 */
    CHECK(fxs_editor_act(&e->editor, 0, &message) == first);
    CHECK(select(e, front) == 256);                      /* the next layer */
    front.camera.rotation_q30[0] = 5;
    CHECK(select(e, front) == FXS_ERR_CAMERA);
    front.camera.width = 20000;
    CHECK(select(e, front) == FXS_ERR_ARGUMENT);
    end(e);
}

static int of_x(const edited *e, int side)
{
    int count = 0;
    for (uint32_t n = 0; n < COUNT; n++)
        count += n % 1000 && (int)(n % SIDE) / (SIDE / 2) == side && e->slots[n] != UINT32_MAX;
    return count;
}

/* Clicks select the group of their pixel, as boxes do; another click mends or replaces, and "not this" takes out. */
static void test_object(void)
{
    static const int32_t left[] = {55, 80, 55, 80, 1}, both[] = {55, 80, 55, 80, 1, 145, 80, 145, 80, 1};
    static const int32_t box[] = {102, 12, 190, 148, 1}, not_left[] = {20, 20, 180, 140, 1, 55, 80, 55, 80, 0};
    static const int32_t nothing[] = {100, 80, 100, 80, 1}, outside[] = {55, 200, 55, 200, 1};
    has_two = 1;
    edited *e = cube(FXS_PROFILE_DEFAULT);
    has_two = 0;
    fxs_edit_shape shape = lasso();
    shape.kind = FXS_EDIT_OBJECT;
    shape.points = left;
    shape.point_numbers = FXS_EDIT_HINT;
    const int red = select(e, shape);
    CHECK(red > 0.97 * of_x(e, 0) && red <= of_x(e, 0));
    shape.points = nothing;
    CHECK(select(e, shape) == FXS_ERR_ARGUMENT && strstr(message.text, "nothing is there"));
    shape.points = outside;
    CHECK(select(e, shape) == FXS_ERR_ARGUMENT && (int)e->editor.chosen == red);
    shape.points = both;
    shape.point_numbers = 2 * FXS_EDIT_HINT;
    CHECK(!fxs_editor_replace(&e->editor, &e->context, &shape, &message));
    CHECK(e->editor.chosen > 0.97 * 7992 && e->editor.chosen <= 7992);
    shape.points = not_left;
    CHECK(!fxs_editor_replace(&e->editor, &e->context, &shape, &message));
    const int green = (int)e->editor.chosen;
    CHECK(green > 0.9 * of_x(e, 1) && green <= of_x(e, 1));
    fxs_editor_clear(&e->editor);
    shape.points = box;
    shape.point_numbers = FXS_EDIT_HINT;
    CHECK(select(e, shape) > 0.9 * of_x(e, 1));
    shape.points = left;
    const int all = select(e, shape);
    shape.subtract = 1;
    CHECK(all > 0.9 * 7992 && select(e, shape) == all - red);
    CHECK(fxs_editor_act(&e->editor, 1, &message) == 7992 - (all - red));
    end(e);
}

static int faint(const edited *e)
{
    int count = 0;
    for (uint32_t i = 0; i < COUNT; i++)
        count += e->slots[i] != FXS_NOTHING && fxs_editor_deleted(&e->editor, e->slots[i]);
    return count;
}

static void test_acts(void)
{
    edited *e = cube(FXS_PROFILE_COMPACT);
    fxs_editor *d = &e->editor;
    unsigned char *before = malloc(e->packed.bytes);
    const uint32_t all = d->left;
    memcpy(before, e->packed.data, e->packed.bytes);
    CHECK(all == COUNT - 8);
    CHECK(fxs_editor_act(d, 0, &message) == FXS_ERR_ARGUMENT && fxs_editor_act(d, 1, &message) == FXS_ERR_ARGUMENT);
    const int first = select(e, lasso());
    CHECK(fxs_editor_act(d, 0, &message) == first && d->left == all - (uint32_t)first && d->chosen == 0);
    CHECK(select(e, lasso()) == 0);
    const int second = select(e, (fxs_edit_shape){.numbers = {0, 0, 0, 19, 19, 3}});
    CHECK(fxs_editor_act(d, 1, &message) > 0 && d->left == (uint32_t)second && d->last == 2);
    CHECK(faint(e) == (int)all - second);
    fxs_editor_go(d, 1);
    CHECK(d->left == all - (uint32_t)first && faint(e) == first);
    fxs_editor_go(d, 2);
    CHECK(d->left == (uint32_t)second);
    fxs_editor_go(d, 0);
    CHECK(d->left == all && !memcmp(before, e->packed.data, e->packed.bytes));
    CHECK(select(e, (fxs_edit_shape){.numbers = {-0.1, -0.1, -0.1, 0.1, 0.1, 5.1}}) == 4);   /* two are not finite */
    CHECK(fxs_editor_act(d, 0, &message) == 4 && d->last == 1 && d->done == 1);
    fxs_editor_go(d, 9);
    CHECK(d->left == all - 4);
    free(before);
    end(e);
}

/* The written scene has the Gaussians that are left, with their floats, in the same order. */
static void test_written(void)
{
    for (int profile = 0; profile < 3; profile++) {
        edited *e = cube((enum fxs_profile)profile);
        fxs_scene_file *files[2];
        fxs_scene_file_info info;
        fxs_gaussian whole, part;
        uint32_t slots[COUNT], n = 0;
        const uint32_t all = fxs_scene_numbers(&e->scene, slots);
        unsigned char *copy = malloc(e->packed.bytes);
        memcpy(copy, e->packed.data, e->packed.bytes);
        CHECK(select(e, (fxs_edit_shape){.numbers = {-1, -1, -1, 30, 30, 7.5}}) > 0);
        CHECK(fxs_editor_act(&e->editor, 1, &message) > 0);
        const size_t bytes = fxs_editor_bytes(&e->editor);
        void *out = check_aligned(bytes);
        CHECK(bytes < e->packed.bytes / 2 + e->packed.bytes / 8);
        fxs_editor_write(&e->editor, e->packed.data, out);
        CHECK(!fxs_file_check("edited", out, bytes, 1, &message));
        CHECK(!fxs_scene_file_open_memory("whole", copy, e->packed.bytes, NULL, &files[0], &info, &message));
        CHECK(!fxs_scene_file_open_memory("part", out, bytes, NULL, &files[1], &info, &message));
        CHECK(info.count == e->editor.left);
        for (uint32_t i = 0; i < all; i++) {
            CHECK(fxs_scene_file_read(files[0], &whole, 1, &message) == 1);
            if (fxs_editor_deleted(&e->editor, slots[i]))
                continue;
            if (!CHECK(fxs_scene_file_read(files[1], &part, 1, &message) == 1 && !memcmp(&whole, &part, sizeof part)))
                break;
            n++;
        }
        CHECK(n == e->editor.left && fxs_scene_file_read(files[1], &part, 1, &message) == 0);
        fxs_scene_file_close(files[0]);
        fxs_scene_file_close(files[1]);
        free(copy);
        free(out);
        end(e);
    }
}

static int read_edits(fxs_edits *edits, const char *json)
{
    put_file("edits.json", json, strlen(json));
    return fxs_edits_read(edits, in_folder("edits.json"), &message);
}

#define CAMERA "{\"width\":200,\"height\":160,\"fx\":100,\"fy\":100,\"cx\":100,\"cy\":80," \
               "\"rotation\":[1,0,0,0,1,0,0,0,1],\"position\":[9.5,9.5,-20],\"near\":0.2}"
#define LASSO "{\"shape\":\"lasso\",\"front\":true,\"camera\":" CAMERA ",\"points\":[60,40,140,40,140,120,60,120]}"
#define OBJECT "{\"shape\":\"object\",\"camera\":" CAMERA ",\"points\":[100,80,100,80,1]}"
#define BOX "{\"shape\":\"box\",\"numbers\":[-0.1,-0.1,-0.1,1.1,1.1,1.1]}"
#define FILE_OF(gaussians, act, shapes) "{\"format\":\"fixsplat edits\",\"version\":1,\"scene\":{\"gaussians\":" \
    gaussians ",\"checksum\":\"%08x\"},\"edits\":[{\"act\":\"" act "\",\"select\":[" shapes "]}]}"

static void test_file(void)
{
    edited *e = cube(FXS_PROFILE_DEFAULT);
    fxs_edits edits;
    char json[2048];
    const unsigned checksum = fxs_edit_checksum(&e->scene);
    snprintf(json, sizeof json, FILE_OF("7992", "delete", LASSO "," BOX), checksum);
    if (read_edits(&edits, json))
        SKIP(message.text);
    CHECK(edits.count == 1 && edits.shape_count == 2 && !memcmp(edits.shapes[0].camera.rotation_q30,
                                                                camera_of().rotation_q30, 36));
    CHECK(!fxs_edits_do(&edits, &e->editor, &e->context, &message));
    CHECK(e->editor.left == 7992 - 256 - 7);
    CHECK(fxs_edits_do(&edits, &e->editor, &e->context, &message) == FXS_ERR_ARGUMENT);
    CHECK(strstr(message.text, "another scene"));
    fxs_edits_free(&edits);
    fxs_editor_go(&e->editor, 0);
    e->editor.last = 0;
    snprintf(json, sizeof json, FILE_OF("7992", "delete", OBJECT), checksum);
    CHECK(!read_edits(&edits, json) && edits.shapes[0].kind == FXS_EDIT_OBJECT);
    CHECK(!fxs_editor_select(&e->editor, &e->context, &edits.shapes[0], &message));
    const uint32_t chosen = e->editor.chosen;
    fxs_editor_clear(&e->editor);
    CHECK(!fxs_edits_do(&edits, &e->editor, &e->context, &message) && e->editor.left == 7992 - chosen);
    fxs_edits_free(&edits);
    fxs_editor_go(&e->editor, 0);
    snprintf(json, sizeof json, FILE_OF("7992", "keep", LASSO), checksum ^ 1);
    CHECK(!read_edits(&edits, json));
    CHECK(fxs_edits_do(&edits, &e->editor, &e->context, &message) == FXS_ERR_ARGUMENT);
    fxs_edits_free(&edits);
    end(e);
}

/* A list that is made, written and read again has the same numbers, and does the same. */
static void test_made(void)
{
    edited *e = cube(FXS_PROFILE_DEFAULT);
    fxs_edits made = {.gaussians = e->editor.left, .checksum = fxs_edit_checksum(&e->scene)}, read;
    fxs_edit_shape shape = lasso(), box = {.subtract = 1, .numbers = {-0.1, 1e-7, -0.1, 11, 11.1, 11.3}};
    const char *name = in_folder("made.json");
    shape.front = 1;
    shape.camera.position_q32[1] += 12345;
    for (int i = 0; i < 3; i++) {
        CHECK(!fxs_edits_add_shape(&made, &box, &message) && !fxs_edits_add_shape(&made, &shape, &message));
        CHECK(!fxs_edits_add(&made, i == 2, i != 1, &message));       /* the second and the third replace edits */
    }
    CHECK(made.count == 2 && made.shape_count == 4 && made.edits[0].end == 2 && made.edits[1].end == 4);
    CHECK(!fxs_edits_write(&made, 2, name, &message));
    if (fxs_edits_read(&read, name, &message))
        SKIP(message.text);
    CHECK(read.count == 2 && read.shape_count == 4 && read.checksum == made.checksum && !read.edits[0].keep);
    CHECK(read.edits[1].keep && read.edits[1].first == 2);
    CHECK(!memcmp(&read.shapes[1].camera, &shape.camera, sizeof shape.camera) && read.shapes[1].front);
    CHECK(!memcmp(read.shapes[0].numbers, box.numbers, sizeof box.numbers) && read.shapes[0].subtract);
    CHECK(read.shapes[3].point_numbers == 8 && !memcmp(read.shapes[3].points, corners, sizeof corners));
    fxs_edits_free(&made);
    fxs_edits_free(&read);
    end(e);
}

static void test_bad_files(void)
{
    static const struct {
        const char *text, *why;
    } bad[] = {
        {"", ""}, {"[1,2", ""}, {"{\"format\":\"other\",\"edits\":[]}", "is no file of edits"},
        {"{\"format\":\"fixsplat edits\",\"version\":2,\"edits\":[]}", "another version"},
        {"{\"format\":\"fixsplat edits\",\"version\":1,\"edits\":[]}", "checksum"},
        {FILE_OF("-1", "delete", LASSO), "checksum"},
        {FILE_OF("1", "paint", LASSO), "\"act\" is delete or keep"},
        {FILE_OF("1", "delete", ""), "\"select\" is not a list"},
        {FILE_OF("1", "delete", "{\"shape\":\"torus\"}"), "\"shape\" is box"},
        {FILE_OF("1", "delete", "{\"shape\":\"box\",\"numbers\":[1,2,3]}"), "a box are 6"},
        {FILE_OF("1", "delete", "{\"shape\":\"sphere\",\"numbers\":[1,2,3,1e999]}"), ""},
        {FILE_OF("1", "delete", "{\"shape\":\"sphere\",\"numbers\":[1,2,3,NaN]}"), ""},
        {FILE_OF("1", "delete", "{\"shape\":\"lasso\",\"points\":[1,2]}"), "\"camera\" needs"},
        {FILE_OF("1", "delete", "{\"shape\":\"lasso\",\"camera\":" CAMERA ",\"points\":[1,2,3]}"), "\"points\" of"},
        {FILE_OF("1", "delete", "{\"shape\":\"lasso\",\"camera\":" CAMERA ",\"points\":[1,2.5]}"), "whole pixels"},
        {FILE_OF("1", "delete", "{\"shape\":\"brush\",\"camera\":" CAMERA ",\"points\":[1,2,2000]}"), "whole pixels"},
        {FILE_OF("1", "delete", "{\"shape\":\"object\",\"camera\":" CAMERA ",\"points\":[1,2,3,4,2]}"), "then 0 or 1"},
        {FILE_OF("1", "delete", "{\"shape\":\"object\",\"camera\":" CAMERA ",\"points\":[-1,2,3,4,1]}"), "then 0 or 1"},
        {FILE_OF("1", "delete", "{\"shape\":\"object\",\"camera\":" CAMERA ",\"points\":[1,2,3,4]}"), "\"points\" of"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        fxs_edits edits;
        char json[2048];
        snprintf(json, sizeof json, bad[i].text, 7u);
        if (!CHECK(read_edits(&edits, json) < 0 && !edits.count && !edits.shapes))
            printf("  %s\n", json);
        if (strstr(message.text, "built without"))
            SKIP(message.text);
        if (!CHECK(strstr(message.text, bad[i].why)))
            printf("  %s\n", message.text);
    }
}

static void tests(void)
{
    RUN(test_shapes);
    RUN(test_turned);
    RUN(test_front);
    RUN(test_object);
    RUN(test_acts);
    RUN(test_written);
    RUN(test_file);
    RUN(test_made);
    RUN(test_bad_files);
}

int main(void)
{
    return in_a_folder(tests);
}
