/* .fxs files and their rendered pictures must have the same bytes on every processor. Constant hashes are compared. */
#include <float.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <fixsplat/fixsplat.h>
#include <fixsplat/pack.h>
#include <fixsplat/scene.h>
#include "scene_writer.h"
#include "check.h"
#include "one_scene.h"

enum { WIDTH = 72, HEIGHT = 50 };

static char folder[] = "/tmp/fixsplat-bytes-XXXXXX";
static char ply_path[64], fxs_path[64];
static fxs_message message;

/* Returns a random multiple of 1/256, which floats represent exactly. */
static float grid(uint32_t *seed, int low, int high)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (float)(low + (int)((*seed >> 8) % (uint32_t)(high - low + 1))) / 256;
}

static void make_gaussian(uint32_t *seed, fxs_gaussian *g)
{
    memset(g, 0, sizeof *g);
    for (int k = 0; k < 3; k++) {
        g->position[k] = grid(seed, -2000, 2000);
        g->scale[k] = grid(seed, -1500, -100);
        g->dc[k] = grid(seed, -400, 400);
    }
    for (int k = 0; k < 4; k++)
        g->rotation[k] = grid(seed, 1, 500);
    g->opacity = grid(seed, -1000, 1000);
    for (int k = 0; k < 45; k++)
        g->sh[k] = grid(seed, -60, 60);
}

static int write_ply(int count, int sh_degree)
{
    fxs_scene_writer *writer;
    fxs_gaussian gaussian;
    uint32_t seed = 11;
    if (open_writer("ply", ply_path, (uint64_t)count, sh_degree, 0, &writer, &message))
        return 0;
    for (int i = 0; i < count; i++) {
        make_gaussian(&seed, &gaussian);
        fxs_scene_writer_put(writer, &gaussian, 1, &message);
    }
    return !close_writer(writer, &message);
}

static int pack(enum fxs_profile profile, int tree)
{
    const fxs_pack_options options = {.size = sizeof(fxs_pack_options), .profile = profile, .tree = tree};
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_packed_scene packed;
    fxs_pack_report report;
    if (fxs_scene_file_open(ply_path, NULL, &file, &info, &message))
        return 0;
    int done = !fxs_pack(file, &info, &packed, &report, &options, &message);
    fxs_scene_file_close(file);
    if (done) {
        done = !fxs_file_write(fxs_path, packed.data, packed.bytes, &message);
        fxs_packed_scene_free(&packed);
    }
    return done;
}

static void *load(size_t *bytes)
{
    FILE *file = fopen(fxs_path, "rb");
    if (!file)
        return 0;
    fseek(file, 0, SEEK_END);
    *bytes = (size_t)ftell(file);
    rewind(file);
    void *data = check_aligned(*bytes);
    if (!data || fread(data, 1, *bytes, file) != *bytes)
        *bytes = 0;
    fclose(file);
    return data;
}

static uint64_t hash(uint64_t value, const void *bytes, size_t count)
{
    for (const unsigned char *byte = bytes; count > 0; byte++, count--)
        value = (value ^ *byte) * 0x100000001b3u;
    return value;
}

static uint64_t draw(const fxs_scene *scene, enum fxs_format format)
{
    static unsigned char pixels[WIDTH * HEIGHT * 4];
    const fxs_camera camera = {.width = WIDTH, .height = HEIGHT, .fx_q12 = WIDTH << 12, .fy_q12 = WIDTH << 12,
                               .cx_q12 = WIDTH << 11, .cy_q12 = HEIGHT << 11,
                               .rotation_q30 = {1 << 30, 0, 0, 0, 1 << 30, 0, 0, 0, 1 << 30},
                               .position_q32 = {0, 0, -((int64_t)12 << 32)}};
    const int pixel_bytes = format == FXS_FORMAT_RGB565 ? 2 : 4;
    fxs_context context;
    fxs_options options;
    fxs_context_init(&context, 0);
    fxs_options_init(&options);
    size_t bytes = one_frame_bytes(&context, scene, WIDTH, HEIGHT, 0);
    void *memory = check_aligned(bytes);
    CHECK(!one_render(&context, scene, &camera, &options, format, memory, bytes, pixels, WIDTH * pixel_bytes, 0));
    free(memory);
    return hash(0xcbf29ce484222325u, pixels, (size_t)(WIDTH * HEIGHT * pixel_bytes));
}

static void check_file(enum fxs_profile profile, int count, int sh_degree, int tree, const uint64_t expected[3])
{
    fxs_scene scene;
    size_t bytes = 0;
    if (!CHECK(write_ply(count, sh_degree) && pack(profile, tree))) {
        printf("  %s\n", message.text);
        return;
    }
    void *data = load(&bytes);
    if (CHECK(data && !fxs_file_check(fxs_path, data, bytes, 1, &message) && !fxs_scene_open(&scene, data, bytes))) {
        const uint64_t found[3] = {hash(0xcbf29ce484222325u, data, bytes), draw(&scene, FXS_FORMAT_RGBA8),
                                   draw(&scene, FXS_FORMAT_RGB565)};
        printf("  file, RGBA8, RGB565: %016" PRIx64 " %016" PRIx64 " %016" PRIx64 "\n", found[0], found[1], found[2]);
        CHECK(!memcmp(found, expected, sizeof found));
    }
    free(data);
}

static void test_default(void)
{
    static const uint64_t expected[3] = {0xda68ee8ce6dde5b0u, 0xb77ce4cbb2f39631u,
                                         0x18f9e4c0aea4f367u};
    check_file(FXS_PROFILE_DEFAULT, 700, 3, 0, expected);
}

static void test_compact(void)
{
    static const uint64_t expected[3] = {0x650ce74297309b50u, 0x2565bea3b8712e78u,
                                         0xc35c53b6b06290b1u};
    check_file(FXS_PROFILE_COMPACT, 40, 2, 0, expected);
}

static void test_small(void)
{
    static const uint64_t expected[3] = {0x2f96b5fce33b5decu, 0xfd007c378d6abd8bu,
                                         0xb09d705c63fd1cc2u};
    check_file(FXS_PROFILE_SMALL, 40, 1, 0, expected);
}

/* Packs a scene that is large enough for full SH palettes. Smaller palettes need no search. */
static void test_full_palettes(void)
{
    static const uint64_t compact[3] = {0x3cd5c70902e00437u, 0x0fea4dc982ced672u,
                                        0xfd1f4f9934e6e083u};
    static const uint64_t small[3] = {0x8f14fc60f59804e0u, 0x6408ef1bd2b66eaeu,
                                      0x41cfefc109b551e8u};
    check_file(FXS_PROFILE_COMPACT, 12000, 1, 0, compact);
    check_file(FXS_PROFILE_SMALL, 12000, 1, 0, small);
}

static void test_tree(void)
{
    static const uint64_t expected[3] = {0xb4ac07b150dc25c8u, 0xddf2486c9aa86a74u,
                                         0xdb4bcc7a3a7f819au};
    static const uint64_t small[3] = {0x291e5f90dfd04546u, 0xcdc9b5f48d74e1ebu,
                                      0x38598508e0976ea7u};
    /* compilers that compute floats with excess precision would change the bytes, so packing is refused */
    if (FLT_EVAL_METHOD != 0) {
        CHECK(write_ply(3000, 3) && !pack(FXS_PROFILE_DEFAULT, 1) && strstr(message.text, "single precision"));
        return;
    }
    check_file(FXS_PROFILE_DEFAULT, 3000, 3, 1, expected);
    check_file(FXS_PROFILE_SMALL, 3000, 2, 1, small);
}

int main(void)
{
    if (!mkdtemp(folder))
        return 1;
    snprintf(ply_path, sizeof ply_path, "%s/a.ply", folder);
    snprintf(fxs_path, sizeof fxs_path, "%s/a.fxs", folder);
    RUN(test_default);
    RUN(test_compact);
    RUN(test_small);
    RUN(test_full_palettes);
    RUN(test_tree);
    unlink(ply_path);
    unlink(fxs_path);
    rmdir(folder);
    return check_report();
}
