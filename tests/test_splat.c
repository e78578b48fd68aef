/* Reads .splat files that the test makes and a real scene. Writes files and reads them back. */
#include "scene_writer.h"
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

static void flat_scene(void)
{
    fxs_gaussian g[3];
    make_file(3);
    for (size_t row = 0; row < 3; row++)
        put_float_at(RECORD * row + 12 + 4 * row, 0);
    put_file(size);
    CHECK(read_file(g, 3) == 0 && info.count == 3);
    for (int row = 0; row < 3; row++)
        CHECK(g[row].scale[row] == -20 && g[row].scale[(row + 1) % 3] > -1);
}

/* Reads a .splat with negative scales S. The covariance R S S R' must not depend on their sign. */
static void scales_below_0(void)
{
    fxs_gaussian g[2][3];
    for (int below = 0; below < 2; below++) {
        make_file(3);
        for (size_t row = 0; row < 3; row++)
            put_float_at(RECORD * row + 12 + 4 * row, below ? -0.25f : 0.25f);
        put_float_at(RECORD + 12, below ? -0.0f : 0);
        put_file(size);
        CHECK(read_file(g[below], 3) == 0);
    }
    CHECK(!memcmp(g[0], g[1], sizeof g[0]) && is_near((double)g[0][0].scale[0], log(0.25), 1e-6));
}

static void implausible_records(void)
{
    static const float wrong[] = {NAN, INFINITY, -INFINITY, 1e9f, -1e9f};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        for (size_t field = 0; field < 6; field++) {
            make_file(3);
            put_float_at(2 * RECORD + 4 * field, wrong[i]);
            check_fails(".splat: whole records of 32 bytes, finite positions and scales");
        }
    size = 1024;
    memset(bytes, 0, size);
    check_fails("not a scene file of a known format");
    size = 0;
    put("%-64s", "A text whose length is a multiple of 32 bytes.");
    check_fails("not a scene file of a known format");
}

static void wild_record_at_the_end(void)
{
    fxs_gaussian g[ROWS];
    make_file(ROWS);
    put_float_at((ROWS - 1) * RECORD, NAN);
    put_float_at((ROWS - 1) * RECORD + 12, NAN);
    put_file(size);
    CHECK(read_file(g, ROWS) == 0 && info.count == ROWS);
    CHECK(isnan(g[ROWS - 1].position[0]) && isnan(g[ROWS - 1].scale[0]));
}

static int write_file(const fxs_gaussian *gaussians, uint64_t announced, size_t count)
{
    fxs_scene_writer *writer;
    int result = open_writer("splat", written, announced, 0, 0, &writer, &message);
    if (result)
        return result;
    fxs_scene_writer_put(writer, gaussians, count, &message);
    result = close_writer(writer, &message);
    take_written();
    return result;
}

static void written_and_read(void)
{
    static fxs_gaussian wanted[ROWS], got[ROWS];
    uint32_t state = 1;
    for (int i = 0; i < ROWS; i++) {
        float *values = (float *)&wanted[i];
        for (int k = 0; k < 14; k++)
            values[k] = (float)((state = state * 1664525 + 1013904223) >> 8) / 8388608 - 1;
    }
    CHECK(write_file(wanted, ROWS, ROWS) == 0);
    if (!CHECK(read_file(got, ROWS) == 0 && info.count == ROWS))
        return;
    for (int i = 0; i < ROWS; i++) {
        const fxs_gaussian *a = &wanted[i], *b = &got[i];
        CHECK(rotation_match(a, b) > 1 - 1e-4 && fabs(opacity_of(a) - opacity_of(b)) < 0.501 / 255);
        for (int k = 0; k < 3; k++) {
            CHECK(a->position[k] == b->position[k] && is_near((double)a->scale[k], (double)b->scale[k], 1e-6));
            CHECK(fabs((double)a->dc[k] - b->dc[k]) * 0.28209479177387814 < 0.501 / 255);
        }
    }
}

static void written_extremes(void)
{
    fxs_gaussian got[3], wild[3] = {
        {.position = {1.34e8f, -1.34e8f, 0}, .scale = {20, 20, 20}, .rotation = {1e-30f, 0, 0, 0}, .opacity = INFINITY,
         .dc = {1e30f, -1e30f, 0}},
        {.position = {0, -0.0f, 1e-40f}, .scale = {-20, -20, -20}, .rotation = {-1e10f, 0, 0, 0}, .opacity = -INFINITY},
        {.position = {3e38f, 3e38f, -1e38f}, .scale = {3e38f, -INFINITY, 80}, .rotation = {1, 0, 0, 0}}
    };
    CHECK(write_file(wild, 3, 3) == 0);
    if (!CHECK(read_file(got, 3) == 0))
        return;
    CHECK(got[2].position[0] == 134217728 && is_near((double)got[2].position[2], -134217728 / 3.0, 1e-6));
    CHECK(got[2].scale[0] > 19.99f && got[2].scale[1] == -20);
    CHECK(got[0].opacity == 20 && got[1].opacity == -20 && got[0].rotation[0] > 0.99f && got[1].rotation[0] == -1);
    for (int i = 0; i < 3; i++) {
        CHECK(got[0].position[i] == wild[0].position[i] && is_near((double)got[0].scale[i], 20, 1e-4));
        CHECK(is_near((double)got[1].scale[i], -20, 1e-6));
    }
    CHECK(is_near((double)got[0].dc[0], 0.5 / 0.28209479177387814, 1e-6) && got[0].dc[0] == -got[0].dc[1]);
}

static void faulty_writes(void)
{
    fxs_gaussian g[2] = {{.rotation = {1, 0, 0, 0}}, {.rotation = {1, 0, 0, 0}}};
    fxs_gaussian kept[3];
    fxs_scene_writer *writer;
    CHECK(write_file((fxs_gaussian[3]){g[0], g[0], g[0]}, 3, 3) == 0);
    CHECK(write_file(g, 2, 1) == FXS_ERR_ARGUMENT && strstr(message.text, "1 Gaussians fewer than announced"));
    CHECK(write_file(g, 1, 2) == FXS_ERR_FILE && strncmp(message.text, written, strlen(written)) == 0);
    CHECK(read_file(kept, 3) == 0 && info.count == 3);
    CHECK(open_writer("splat", "no/such/folder/a.splat", 1, 0, 0, &writer, &message) == FXS_ERR_FILE && !writer);
    CHECK(strstr(message.text, "no/such/folder/a.splat: cannot be written: No such file"));
    CHECK(close_writer(NULL, &message) == 0);
}

static void real_scene(void)
{
    if (access(scenes_folder(), R_OK) != 0)
        SKIP("no folder of scenes; set FXS_SCENES");
    check_same_scenes("luma-seal/luma-seal.splat", "luma-seal/luma-seal.ply", 2e-6);
}

int main(void)
{
    make_written();
    RUN(values);
    RUN(ends_of_ranges);
    RUN(flat_scene);
    RUN(scales_below_0);
    RUN(implausible_records);
    RUN(wild_record_at_the_end);
    RUN(written_and_read);
    RUN(written_extremes);
    RUN(faulty_writes);
    RUN(real_scene);
    unlink(written);
    return check_report();
}
