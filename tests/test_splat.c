/* Reads of .splat files made here, of what is none, and of a real scene. */
#include "scene_bytes.h"

enum { RECORD = 32, ROWS = 100 };

static void put_record(float position, float scale, int code)
{
    for (int i = 0; i < 3; i++)
        put_float(position + (float)i);
    for (int i = 0; i < 3; i++)
        put_float(scale * (float)(i + 1));
    for (int i = 0; i < 8; i++)
        put_u8((code + 16 * i) % 256);
}

static void make_file(int rows)
{
    size = 0;
    for (int row = 0; row < rows; row++)
        put_record((float)row - 2, 0.5f, row);
}

static void values(void)
{
    fxs_gaussian g[3];
    make_file(3);
    put_file(size);
    CHECK(read_file(g, 3) == 0 && info.count == 3 && info.sh_degree == 0 && !info.antialiased);
    CHECK(strcmp(info.format, "splat") == 0);
    for (int row = 0; row < 3; row++) {
        for (int i = 0; i < 3; i++) {
            CHECK(g[row].position[i] == (float)(row - 2 + i));
            CHECK(is_near((double)g[row].scale[i], log(0.5 * (i + 1)), 1e-6));
            CHECK(is_near(0.5 + 0.28209479177387814 * (double)g[row].dc[i], (row + 16 * i) / 255.0, 1e-6));
        }
        CHECK(is_near(opacity_of(&g[row]), (row + 48) / 255.0, 1e-6));
        for (int i = 0; i < 4; i++)
            CHECK(g[row].rotation[i] == (float)(row + 64 + 16 * i - 128) / 128);
        for (int i = 0; i < 45; i++)
            CHECK(g[row].sh[i] == 0);
    }
}

static void ends_of_ranges(void)
{
    fxs_gaussian g[3];
    size = 0;
    put_record(0, 0, 0);
    put_record(134217726.0f, 1e8f, 0);
    put_record(-134217728.0f, 1e-30f, 0);
    bytes[27] = 0;
    bytes[RECORD + 27] = 255;
    put_file(size);
    CHECK(read_file(g, 3) == 0 && g[0].opacity == -20 && g[1].opacity == 20);
    for (int i = 0; i < 3; i++)
        CHECK(g[0].scale[i] == -20 && g[1].scale[i] > 18 && g[1].scale[i] < 20 && g[2].scale[i] == -20);
}

static void every_length(void)
{
    fxs_gaussian g[3];
    make_file(3);
    for (size_t length = 0; length < size; length++) {
        if (length == 0 || length % RECORD != 0) {
            check_cut_fails(length, "not a scene file of a known format");
            continue;
        }
        put_file(length);
        CHECK(read_file(g, 3) == 0 && info.count == length / RECORD);
    }
}

static void implausible_records(void)
{
    static const float wrong[] = {NAN, INFINITY, -INFINITY, 1e9f, -1e9f};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        for (size_t field = 0; field < 6; field++) {
            make_file(3);
            put_float_at(2 * RECORD + 4 * field, wrong[i]);
            check_fails(".splat: whole records of 32 bytes, finite positions, scales of 0 or more");
        }
    make_file(3);
    put_float_at(RECORD + 16, -0.1f);
    check_fails("not a scene file of a known format");
    size = 1024;
    memset(bytes, 0, size);
    check_fails("not a scene file of a known format");
    size = 0;
    put("%-64s", "A text whose length is a multiple of 32 bytes.");
    check_fails("not a scene file of a known format");
}

/* Only the first records are looked at; what the others hold is for the importer. */
static void wild_record_at_the_end(void)
{
    fxs_gaussian g[ROWS];
    make_file(ROWS);
    put_float_at((ROWS - 1) * RECORD, NAN);
    put_float_at((ROWS - 1) * RECORD + 12, -1);
    put_file(size);
    CHECK(read_file(g, ROWS) == 0 && info.count == ROWS);
    CHECK(isnan(g[ROWS - 1].position[0]) && isnan(g[ROWS - 1].scale[0]));
}

static void real_scene(void)
{
    if (access(scenes_folder(), R_OK) != 0)
        SKIP("no folder of scenes; set FXS_SCENES");
    check_same_scenes("luma-seal/luma-seal.splat", "luma-seal/luma-seal.ply", 2e-6);
}

int main(void)
{
    RUN(values);
    RUN(ends_of_ranges);
    RUN(every_length);
    RUN(implausible_records);
    RUN(wild_record_at_the_end);
    RUN(real_scene);
    return check_report();
}
