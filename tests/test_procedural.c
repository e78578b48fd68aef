/* Tests the procedural scenes: hashes of their bytes, plausible values, and each scene's special property. */
#include "tools/command/procedural.h"
#include "scene_writer.h"
#include "check.h"

#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#define FLOATS (sizeof(fxs_gaussian) / sizeof(float))

static uint32_t bits_of(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static uint64_t scene_hash(const fxs_procedural_scene *scene, uint64_t count, uint32_t seed)
{
    uint64_t hash = UINT64_C(0xCBF29CE484222325);
    for (uint64_t i = 0; i < count; i++) {
        fxs_gaussian g;
        float values[FLOATS];
        scene->gaussian(i, count, seed, &g);
        memcpy(values, &g, sizeof g);
        for (size_t k = 0; k < FLOATS; k++)
            for (int shift = 0; shift < 32; shift += 8)
                hash = (hash ^ (bits_of(values[k]) >> shift & 255)) * UINT64_C(0x100000001B3);
    }
    return hash;
}

static void test_hashes(void)
{
    static const struct {
        const char *name;
        uint64_t hash;
    } expected[] = {
        { "knot", UINT64_C(0x5889F021FA7A782C) },
        { "landscape", UINT64_C(0x835A6BE0CC05B2F1) },
        { "needles", UINT64_C(0xAEE8AC7E83C6816D) },
        { "fog", UINT64_C(0x13AA6321D1ABF9A8) },
        { "layers", UINT64_C(0x91AF63BD405D9470) },
        { "cubes", UINT64_C(0xC3033D8233AE36B4) },
        { "meadow", UINT64_C(0x2330866780B750AC) },
        { "fence", UINT64_C(0x1B7F53AB07F0E69D) },
        { "mirrors", UINT64_C(0x05D7957C7C753470) },
        { "discs", UINT64_C(0xAE4FF844F675597C) },
        { "haze", UINT64_C(0xCE0BEB6AEE71F848) },
        { "site", UINT64_C(0x0B2C9EF2D972B5AE) },
    };
    size_t count;
    fxs_procedural_list(&count);
    CHECK(count == sizeof expected / sizeof expected[0]);
    for (size_t k = 0; k < sizeof expected / sizeof expected[0]; k++) {
        const fxs_procedural_scene *scene = fxs_procedural_find(expected[k].name);
        if (!CHECK(scene))
            continue;
        uint64_t hash = scene_hash(scene, 10000, 1);
        if (!CHECK(hash == expected[k].hash))
            printf("  %s: 0x%016llX\n", scene->name, (unsigned long long)hash);
        CHECK(scene_hash(scene, 10000, 2) != hash);
    }
    CHECK(!fxs_procedural_find("no such scene"));
}

static int plausible(const fxs_gaussian *g, int sh_degree, float extent)
{
    float values[FLOATS];
    memcpy(values, g, sizeof *g);
    for (size_t k = 0; k < FLOATS; k++)
        if (!isfinite(values[k]))
            return 0;
    double norm = 0;
    for (int k = 0; k < 4; k++)
        norm += (double)g->rotation[k] * (double)g->rotation[k];
    for (int k = 3 * ((sh_degree + 1) * (sh_degree + 1) - 1); k < 45; k++)
        if (bits_of(g->sh[k]) != 0)
            return 0;
    for (int k = 0; k < 3; k++)
        if (fabsf(g->position[k]) > extent || g->scale[k] < -20.8f || g->scale[k] > 4.4f)
            return 0;
    return fabs(norm - 1) < 1e-6 && fabsf(g->opacity) < 12;
}

static void test_values(void)
{
    static const uint64_t counts[] = { 1, 2, 7, 1000, 123457, 10000000 };
    size_t scenes;
    const fxs_procedural_scene *scene = fxs_procedural_list(&scenes);
    for (; scenes > 0; scenes--, scene++) {
        float extent = strcmp(scene->name, "meadow") == 0 ? 24570 : strcmp(scene->name, "discs") == 0 ? 400
                     : strcmp(scene->name, "site") == 0 ? 210 : 100;
        for (size_t k = 0; k < sizeof counts / sizeof counts[0]; k++) {
            uint64_t step = counts[k] / 2000 + 1, bad = 0;
            for (uint64_t i = 0; i < counts[k]; i += step) {
                fxs_gaussian g;
                scene->gaussian(i, counts[k], 7, &g);
                bad += !plausible(&g, scene->sh_degree, extent);
            }
            if (!CHECK(bad == 0))
                printf("  %s, %llu Gaussians\n", scene->name, (unsigned long long)counts[k]);
        }
    }
}

static float reach_of(const fxs_gaussian *g)
{
    return hypotf(hypotf(g->position[0], g->position[1]), g->position[2]);
}

static void test_meadow_has_strays_and_discs(void)
{
    const fxs_procedural_scene *scene = fxs_procedural_find("meadow");
    for (uint64_t count = scene->count / 4; count <= scene->count; count *= 2) {
        size_t strays = 0, far = 0, thin = 0, faint = 0;
        for (uint64_t i = 0; i < count; i++) {
            fxs_gaussian g;
            scene->gaussian(i, count, 1, &g);
            const float r = reach_of(&g);
            thin += g.scale[2] < -20;
            strays += r > 79;
            far += r > 700;
            faint += r > 79 && g.opacity < logf(0.14f / 0.86f);
        }
        CHECK(strays == 256 && far == 8 && thin > count / 20 && faint > 90 && faint < 180);
    }
}

/* Checks the procedural scene "fence": nearly all its Gaussians are 5 to 40 times as long as wide. */
static void test_fence_has_needles(void)
{
    const fxs_procedural_scene *scene = fxs_procedural_find("fence");
    for (uint64_t count = 2000; count < 1000000; count *= 20) {
        size_t needles = 0;
        for (uint64_t i = 0; i < count; i++) {
            fxs_gaussian g;
            scene->gaussian(i, count, 1, &g);
            const float ratio = expf(g.scale[0] - g.scale[1]);
            needles += ratio > 4.99f && ratio < 40.01f && g.scale[2] < g.scale[1];
        }
        CHECK(needles == count * 9 / 10);
    }
}

static void test_layers_have_ties(void)
{
    const fxs_procedural_scene *scene = fxs_procedural_find("layers");
    size_t same_depth = 0, same_position = 0;
    for (uint64_t i = 0; i + 10 < scene->count; i++) {
        fxs_gaussian a, b;
        scene->gaussian(i, scene->count, 1, &a);
        scene->gaussian(i + 10, scene->count, 1, &b);
        same_depth += bits_of(a.position[2]) == bits_of(b.position[2]);
        same_position += memcmp(a.position, b.position, sizeof a.position) == 0;
    }
    CHECK(same_depth == scene->count - 10);
    CHECK(same_position >= scene->count / 2 - 10);
}

/* ---- The .ply writer ---- */

static char folder[64] = "/tmp/fxs_procedural_XXXXXX";

static const char *in_folder(const char *name)
{
    static char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static int exists(const char *name)
{
    struct stat found;
    return stat(in_folder(name), &found) == 0;
}

static int write_scene(const char *path, const fxs_procedural_scene *scene, uint64_t announced, uint64_t written,
                       fxs_message *message)
{
    fxs_scene_writer *writer;
    const int error = open_writer("ply", path, announced, scene->sh_degree, 0, &writer, message);
    if (error)
        return error;
    for (uint64_t i = 0; i < written; i++) {
        fxs_gaussian g;
        scene->gaussian(i, written, 1, &g);
        if (fxs_scene_writer_put(writer, &g, 1, message))
            break;
    }
    return close_writer(writer, message);
}

static float float_at(const unsigned char *bytes)
{
    uint32_t bits = bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Compares a row of a .ply with a Gaussian. The SH coefficients f_rest of a .ply are stored channel by channel. */
static void check_row(const unsigned char *row, const fxs_gaussian *g)
{
    int wrong = 0;
    for (int k = 0; k < 3; k++) {
        wrong += bits_of(float_at(row + 4 * k)) != bits_of(g->position[k]);
        wrong += bits_of(float_at(row + 4 * (3 + k))) != 0;
        wrong += bits_of(float_at(row + 4 * (6 + k))) != bits_of(g->dc[k]);
        wrong += bits_of(float_at(row + 4 * (55 + k))) != bits_of(g->scale[k]);
    }
    for (int k = 0; k < 45; k++)
        wrong += bits_of(float_at(row + 4 * (9 + k))) != bits_of(g->sh[3 * (k % 15) + k / 15]);
    wrong += bits_of(float_at(row + 4 * 54)) != bits_of(g->opacity);
    for (int k = 0; k < 4; k++)
        wrong += bits_of(float_at(row + 4 * (58 + k))) != bits_of(g->rotation[k]);
    CHECK(wrong == 0);
}

static void test_ply_body(void)
{
    enum { COUNT = 300 };
    static char bytes[COUNT * 248 + 4096];
    const fxs_procedural_scene *scene = fxs_procedural_find("knot");
    fxs_message message;
    CHECK(write_scene(in_folder("knot.ply"), scene, COUNT, COUNT, &message) == 0);
    CHECK(!exists("knot.ply.tmp"));
    FILE *file = fopen(in_folder("knot.ply"), "rb");
    if (!CHECK(file))
        return;
    size_t size = fread(bytes, 1, sizeof bytes - 1, file);
    fclose(file);
    CHECK(strncmp(bytes, "ply\nformat binary_little_endian 1.0\nelement vertex 300\nproperty float x\n", 72) == 0);
    const char *end = strstr(bytes, "end_header\n");
    if (!CHECK(end && size == (size_t)(end + 11 - bytes) + COUNT * 248))
        return;
    for (uint64_t i = 0; i < COUNT; i += 23) {
        fxs_gaussian g;
        scene->gaussian(i, COUNT, 1, &g);
        check_row((const unsigned char *)end + 11 + 248 * i, &g);
    }
}

static void test_ply_degrees(void)
{
    static const char *names[] = { "layers", "needles", "fog", "knot" };
    static const long floats[] = { 17, 26, 41, 62 };
    for (int degree = 0; degree < 4; degree++) {
        fxs_message message;
        long sizes[2];
        for (uint64_t n = 1; n <= 2; n++) {
            struct stat found = { .st_size = 0 };
            CHECK(write_scene(in_folder("size.ply"), fxs_procedural_find(names[degree]), n, n, &message) == 0);
            CHECK(stat(in_folder("size.ply"), &found) == 0);
            sizes[n - 1] = (long)found.st_size;
        }
        CHECK(sizes[1] - sizes[0] == 4 * floats[degree]);
    }
}

static void test_ply_failures(void)
{
    const fxs_procedural_scene *scene = fxs_procedural_find("cubes");
    fxs_message message;
    fxs_scene_writer *writer;
    struct stat before, after;
    const struct rlimit small = { 20000, RLIM_INFINITY }, unlimited = { RLIM_INFINITY, RLIM_INFINITY };
    CHECK(write_scene(in_folder("kept.ply"), scene, 5, 5, &message) == 0);
    CHECK(stat(in_folder("kept.ply"), &before) == 0);
    CHECK(write_scene(in_folder("kept.ply"), scene, 6, 5, &message) == FXS_ERR_ARGUMENT &&
          strstr(message.text, "1 Gaussians fewer"));
    CHECK(write_scene(in_folder("kept.ply"), scene, 4, 5, &message) == FXS_ERR_FILE);
    signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &small);
    CHECK(write_scene(in_folder("kept.ply"), scene, 4000, 4000, &message) == FXS_ERR_FILE &&
          strstr(message.text, "kept.ply"));
    setrlimit(RLIMIT_FSIZE, &unlimited);
    CHECK(stat(in_folder("kept.ply"), &after) == 0 && after.st_size == before.st_size);
    CHECK(!exists("kept.ply.tmp"));
    CHECK(write_scene(in_folder("none/a.ply"), scene, 5, 5, &message) == FXS_ERR_FILE &&
          strstr(message.text, "none/a.ply"));
    CHECK(mkdir(in_folder("folder"), 0700) == 0);
    CHECK(write_scene(in_folder("folder"), scene, 5, 5, &message) == FXS_ERR_FILE && !exists("folder.tmp"));
    CHECK(open_writer("ply", in_folder("a.ply"), 1, 4, 0, &writer, &message) == FXS_ERR_ARGUMENT && !writer);
    CHECK(close_writer(NULL, &message) == 0);
}

int main(void)
{
    RUN(test_hashes);
    RUN(test_values);
    RUN(test_layers_have_ties);
    RUN(test_meadow_has_strays_and_discs);
    RUN(test_fence_has_needles);
    if (!mkdtemp(folder))
        return 1;
    RUN(test_ply_body);
    RUN(test_ply_degrees);
    RUN(test_ply_failures);
    static const char *const made[] = { "knot.ply", "size.ply", "kept.ply", "folder" };
    for (size_t k = 0; k < sizeof made / sizeof made[0]; k++)
        remove(in_folder(made[k]));
    rmdir(folder);
    return check_report();
}
