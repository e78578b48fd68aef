/* Reads tilesets that the test makes: refinement, transforms, nesting, positions on the Earth, faulty tilesets, and
   limits of the import. */
#include <math.h>

#include <fixsplat/scene.h>
#include "spz_bytes.h"
#include "folder.h"

static fxs_message message;
static fxs_scene_file_info info;

#ifdef FXS_WITH_CJSON

enum { MOST = 400, TILES = 100 };

static fxs_gaussian out[MOST];

static uint8_t glb[1 << 16];
static size_t glb_size;

static uint8_t *put_floats(uint8_t *to, int count, const float *values)
{
    uint32_t bits;
    for (int i = 0; i < count; i++) {
        memcpy(&bits, &values[i], 4);
        to = spz_put(to, bits, 4);
    }
    return to;
}

static void values_of(int number, int i, float row[14])
{
    const float made[14] = {(float)number, 0.25f * (float)i, -1, 0, 0, 0.6f, 0.8f, 0.5f, 0.125f, 0.25f, 0.5f,
                            (float)number / 64, 0.5f, -0.25f};
    memcpy(row, made, sizeof made);
}

/* Writes a .glb of `count` Gaussians of 14 floats. count 0: a scene without Gaussians. */
static void make_glb(int number, int count)
{
    static const struct { const char *name, *type; int offset; } attributes[] = {
        {"POSITION", "VEC3", 0}, {"KHR_gaussian_splatting:ROTATION", "VEC4", 12},
        {"KHR_gaussian_splatting:SCALE", "VEC3", 28}, {"KHR_gaussian_splatting:OPACITY", "SCALAR", 40},
        {"KHR_gaussian_splatting:SH_DEGREE_0_COEF_0", "VEC3", 44}
    };
    float row[14];
    length = 0;
    say("{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
        "\"buffers\":[{\"byteLength\":%d}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":%d,\"byteStride\":56}],"
        "\"accessors\":[", 56 * count + 1, 56 * count + 1);
    for (int i = 0; i < 5; i++)
        say("%s{\"bufferView\":0,\"byteOffset\":%d,\"componentType\":5126,\"count\":%d,\"type\":\"%s\"}", i ? "," : "",
            attributes[i].offset, count, attributes[i].type);
    say("],\"meshes\":[{\"primitives\":[{\"mode\":0,\"extensions\":{\"%s\":{\"kernel\":\"ellipse\"}},\"attributes\":{",
        count ? "KHR_gaussian_splatting" : "other");
    for (int i = 0; i < 5; i++)
        say("%s\"%s\":%d", i ? "," : "", attributes[i].name, i);
    say("}}]}]}");
    uint8_t *to = spz_put(spz_put(spz_put(glb, 0x46546c67, 4), 2, 4), 28 + length + 56 * (size_t)count + 1, 4);
    to = spz_put(spz_put(to, length, 4), 0x4e4f534a, 4);
    memcpy(to, text, length);
    to = spz_put(spz_put(to + length, 56 * (size_t)count + 1, 4), 0x004e4942, 4);
    for (int i = 0; i < count; i++) {
        values_of(number, i, row);
        to = put_floats(to, 14, row);
    }
    *to++ = 0;
    glb_size = (size_t)(to - glb);
}

static void put_glb(const char *name, int number, int count)
{
    make_glb(number, count);
    put_file(name, glb, glb_size);
}

static void put_tiles(const char *name, const char *tiles)
{
    length = 0;
    say("{\"asset\":{\"version\":\"1.1\"},\"geometricError\":9,\"root\":%s}", tiles);
    put_file(name, text, length);
}

#define BOX "\"boundingVolume\":{\"sphere\":[0,0,0,9]},\"geometricError\":4,"
#define CONTENT(name) "\"content\":{\"uri\":\"" name "\"}"

static long read_step(const char *name, const fxs_scene_file_options *options, size_t step)
{
    static fxs_gaussian again[MOST];
    fxs_scene_file *file;
    long total[2] = {0, 0}, count = 0;
    const int error = fxs_scene_file_open(in_folder(name), options, &file, &info, &message);
    if (error) {
        CHECK(file == NULL && strncmp(message.text, folder, strlen(folder)) == 0 && !strchr(message.text, '\n'));
        return error;
    }
    CHECK(strcmp(info.format, "tileset") == 0 && info.levels == 1);
    for (int pass = 0; pass < 2 && count >= 0; pass++) {
        while (total[pass] + (long)step <= MOST &&
               (count = fxs_scene_file_read(file, (pass ? again : out) + total[pass], step, &message)) > 0)
            total[pass] += count;
        CHECK(fxs_scene_file_rewind(file, &message) == 0);
    }
    fxs_scene_file_close(file);
    if (count < 0)
        return count;
    CHECK(total[0] == total[1] && total[0] == (long)info.count);
    CHECK(memcmp(out, again, (size_t)total[0] * sizeof *out) == 0);
    return total[0];
}

static long read_scene(const char *name)
{
    return read_step(name, NULL, 3);
}

static void check_fails(const char *words)
{
    message.text[0] = 0;
    if (!CHECK(read_scene("tileset.json") == FXS_ERR_FILE && strstr(message.text, words)))
        printf("  said: %s\n  not:  %s\n", message.text, words);
}

/* Reads a tileset. Returns the set of .glb files that it took: bit n for file n. Each file stores its number in
   the colour dc. */
static int numbers_read(const char *tiles)
{
    int bits = 0;
    put_tiles("tileset.json", tiles);
    const long count = read_scene("tileset.json");
    for (long i = 0; i < count; i++)
        bits |= 1 << (int)floor((double)out[i].dc[0] * 64 + 0.5);
    if (count < 0)
        printf("  %s\n", message.text);
    return bits;
}

static void put_five(void)
{
    char name[16];
    for (int i = 0; i < 5; i++) {
        snprintf(name, sizeof name, "%d.glb", i);
        put_glb(name, i, i + 1);
    }
}

static void refinement(void)
{
    put_five();
    CHECK(numbers_read("{" BOX "\"refine\":\"ADD\"," CONTENT("0.glb") "}") == 1);
    CHECK(numbers_read("{" BOX "\"refine\":\"ADD\"," CONTENT("0.glb") ",\"children\":[{" BOX CONTENT("1.glb") "},{"
                       BOX CONTENT("2.glb") "}]}") == 7);
    CHECK(numbers_read("{" BOX "\"refine\":\"REPLACE\"," CONTENT("0.glb") ",\"children\":[{" BOX CONTENT("1.glb")
                       "},{" BOX CONTENT("2.glb") "}]}") == 6);
    CHECK(numbers_read("{" BOX "\"refine\":\"REPLACE\"," CONTENT("0.glb") ",\"children\":[{" BOX "\"children\":[]}]}")
          == 1);
    CHECK(numbers_read("{" BOX CONTENT("0.glb") ",\"children\":[{" BOX "\"children\":[{" BOX CONTENT("1.glb") "}]}]}")
          == 2);
    CHECK(numbers_read("{" BOX "\"refine\":\"REPLACE\"," CONTENT("0.glb") ",\"children\":[{" BOX "\"refine\":\"add\","
                       CONTENT("1.glb") ",\"children\":[{" BOX CONTENT("2.glb") ",\"children\":[{" BOX CONTENT("3.glb")
                       "}]}]},{" BOX CONTENT("4.glb") "}]}") == 30);
    CHECK(numbers_read("{" BOX "\"refine\":\"ADD\"," CONTENT("0.glb") ",\"children\":[{" BOX "\"refine\":\"REPLACE\","
                       CONTENT("1.glb") ",\"children\":[{" BOX CONTENT("2.glb") ",\"children\":[{" BOX CONTENT("3.glb")
                       "}]}]},{" BOX CONTENT("4.glb") "}]}") == 25);
}

static void forms_of_content(void)
{
    put_five();
    put_glb("a b.glb", 3, 2);
    put_glb("mesh.glb", 0, 0);
    CHECK(numbers_read("{" BOX "\"contents\":[{\"uri\":\"0.glb\"},{\"uri\":\"2.glb\"}]}") == 5);
    CHECK(numbers_read("{" BOX "\"content\":{\"url\":\"1.glb\"}}") == 2);
    CHECK(numbers_read("{" BOX CONTENT("./a%20b.glb") "}") == 8);
    CHECK(numbers_read("{" BOX "\"extensions\":{\"3DTILES_multiple_contents\":{\"contents\":[{\"uri\":\"0.glb\"},"
                       "{\"uri\":\"4.glb\"}]}}}") == 17);
    CHECK(numbers_read("{" BOX "\"contents\":[{\"uri\":\"mesh.glb\"},{\"uri\":\"2.glb\"}]}") == 4);
    CHECK(read_step("", NULL, 1) == 3 && read_step("tileset.json", NULL, 100) == 3);
    length = 0;
    say("{\"root\":{" CONTENT("0.glb") "},\"asset\":{\"version\":\"1.0\",\"gltfUpAxis\":\"y\"}}");
    put_file("tileset.json", text, length);
    CHECK(read_scene("tileset.json") == 1);
}

static void same_as_its_content(void)
{
    static fxs_gaussian alone[MOST];
    fxs_scene_file *file;
    put_glb("0.glb", 7, 20);
    CHECK(fxs_scene_file_open(in_folder("0.glb"), NULL, &file, &info, &message) == 0);
    CHECK(fxs_scene_file_read(file, alone, MOST, &message) == 20);
    fxs_scene_file_close(file);
    put_tiles("tileset.json", "{" BOX CONTENT("0.glb") "}");
    CHECK(read_scene("tileset.json") == 20 && memcmp(out, alone, 20 * sizeof *out) == 0);
}

/* True if a Gaussian was read from the point (x, y, z) of a tileset with z up. The point becomes (-x, -z, -y). */
static int is_at(const fxs_gaussian *g, double x, double y, double z)
{
    const int is_there = fabs((double)g->position[0] + x) < 1e-5 && fabs((double)g->position[1] + z) < 1e-5 &&
                         fabs((double)g->position[2] + y) < 1e-5;
    if (!is_there)
        printf("  at %g %g %g\n", (double)-g->position[0], (double)-g->position[2], (double)-g->position[1]);
    return is_there;
}

#define MOVE(x, y, z) "\"transform\":[1,0,0,0,0,1,0,0,0,0,1,0," #x "," #y "," #z ",1],"
/* a tile's transform: rotates by 90 degrees around z, scales by 2 and moves */
#define TURN "\"transform\":[0,2,0,0,-2,0,0,0,0,0,2,0,5,6,7,1],"

static void transforms(void)
{
    put_glb("1.glb", 1, 2);
    put_glb("2.glb", 2, 2);
    put_tiles("tileset.json", "{" BOX MOVE(10, 20, 30) "\"refine\":\"ADD\"," CONTENT("1.glb") ",\"children\":[{" BOX
              TURN CONTENT("2.glb") "}]}");
    if (CHECK(read_scene("tileset.json") == 4)) {
        CHECK(is_at(&out[1], 10 + 5 - 2, 20 + 6 + 4, 30 + 7 + 0.5));
        CHECK(is_at(&out[3], 11, 21, 30.25));
        CHECK(fabs(exp((double)out[3].scale[0] + (double)out[3].scale[1] + (double)out[3].scale[2]) - 1 / 64.0) < 1e-6);
        CHECK(fabs(exp((double)out[1].scale[0] + (double)out[1].scale[1] + (double)out[1].scale[2]) - 1 / 8.0) < 1e-5);
    }
    length = 0;
    say("{\"asset\":{\"version\":\"1.0\",\"gltfUpAxis\":\"Z\"},\"geometricError\":1,\"root\":{" MOVE(1, 2, 3)
        CONTENT("1.glb") "}}");
    put_file("tileset.json", text, length);
    CHECK(read_scene("tileset.json") == 2 && is_at(&out[1], 2, 2.25, 2));
}

static void globe(void)
{
    put_glb("1.glb", 1, 2);
    put_glb("2.glb", 2, 2);
    put_tiles("tileset.json", "{" BOX "\"transform\":[0,1,0,0,-1,0,0,0,0,0,1,0,1215019.25,-4736339.5,4081627.75,1],"
              "\"refine\":\"ADD\"," CONTENT("1.glb") ",\"children\":[{" BOX MOVE(0.125, 20, 30) CONTENT("2.glb") "}]}");
    if (CHECK(read_scene("tileset.json") == 4)) {
        CHECK(is_at(&out[1], 2.125, 21, 30.25));
        CHECK(is_at(&out[3], 1, 1, 0.25));
    }
    put_tiles("tileset.json", "{" BOX "\"transform\":[0,0,0,0,0,0,0,0,0,0,0,0,1215019,-4736339,4081627,1],"
              CONTENT("1.glb") "}");
    check_fails("tileset.json: the transform of a tile has no inverse");
}

static void nested(void)
{
    mkdir(in_folder("sub"), 0700);
    mkdir(in_folder("sub/deep"), 0700);
    put_glb("1.glb", 1, 2);
    put_glb("sub/deep/2.glb", 2, 2);
    put_glb("sub/3.glb", 3, 2);
    put_tiles("sub/more.json", "{" BOX "\"refine\":\"ADD\"," MOVE(0, 0, 3) CONTENT("deep/2.glb") ",\"children\":[{"
              CONTENT("3.glb") "}]}");
    put_tiles("tileset.json", "{" BOX "\"refine\":\"REPLACE\"," CONTENT("1.glb") ",\"children\":[{" BOX TURN
              CONTENT("sub/more.json") "}]}");
    /* a tileset in a tileset has y up; the change of axes must not be applied twice */
    if (CHECK(read_scene("tileset.json") == 4)) {
        CHECK(is_at(&out[1], 5 - 2, 6 + 6, 7 + 6.5));
        CHECK(is_at(&out[3], 5 - 2, 6 + 4, 7 + 6.5));
    } else {
        printf("  %s\n", message.text);
    }
}

static const char good[] =
    "{\"asset\":{\"version\":\"1.1\"},\"geometricError\":9,\"root\":{" BOX "\"refine\":\"ADD\"," MOVE(1, 2, 3)
    CONTENT("1.glb") ",\"children\":[{" BOX CONTENT("2.glb") "}]}}";

static void faulty_tilesets(void)
{
    /* each case: a text of the tileset, the text that replaces it, the expected error message */
    static const char *const cases[][3] = {
        {"\"1.1\"", "\"2.0\"", "tileset.json: not 3D Tiles 1"}, {"\"1.1\"", "1.1", "not 3D Tiles 1"},
        {"\"asset\"", "\"assets\"", "not 3D Tiles 1"}, {"\"root\"", "\"rood\"", "a tile that is not an object"},
        {"\"version\"", "\"gltfUpAxis\":\"X\",\"version\"", "a \"gltfUpAxis\" that is neither Y nor Z"},
        {"\"version\"", "\"gltfUpAxis\":7,\"version\"", "a \"gltfUpAxis\" that is neither Y nor Z"},
        {"\"children\":[", "\"children\":[7,", "a tile that is not an object"},
        {"\"children\":[", "\"children\":{},\"c\":[", "\"children\" that are not an array"},
        {"\"ADD\"", "\"ADDED\"", "the \"refine\" of a tile is neither ADD nor REPLACE"},
        {"\"ADD\"", "1", "the \"refine\" of a tile is neither ADD nor REPLACE"},
        {"[1,0,0,0,", "[1,0,0,", "the \"transform\" of a tile is not 16 numbers"},
        {"[1,0,0,0,", "[1,0,0,2,", "the \"transform\" of a tile is not 16 numbers"},
        {"[1,0,0,0,", "[\"1\",0,0,0,", "the \"transform\" of a tile is not 16 numbers"},
        {"\"transform\":[", "\"transform\":7,\"t\":[", "the \"transform\" of a tile is not 16 numbers"},
        {"[1,0,0,0,", "[0,0,0,0,", "glb: a node's transform has no inverse"},
        {"[1,0,0,0,", "[1e999,0,0,0,", "glb: a node's transform has no inverse"},
        {"\"content\":", "\"implicitTiling\":{},\"content\":", "implicit tiling is not read"},
        {"\"content\":", "\"extensions\":{\"3DTILES_implicit_tiling\":{}},\"content\":", "implicit tiling is not read"},
        {"\"content\":", "\"contents\":", "the \"contents\" of a tile are not an array"},
        {"\"uri\":\"1.glb\"", "\"uri\":1", "the content of a tile has no \"uri\""},
        {"{\"uri\":\"1.glb\"}", "7", "the content of a tile has no \"uri\""},
        {"1.glb", "no.glb", "no.glb: No such file"}, {"1.glb", "", "a file name that is missing"},
        {"1.glb", "../1.glb", "leaves the folder"}, {"1.glb", "%2e%2e/1.glb", "leaves the folder"},
        {"1.glb", "a/../../1.glb", "leaves the folder"}, {"1.glb", "/etc/passwd", "leaves the folder"},
        {"1.glb", "..\\\\1.glb", "leaves the folder"}, {"1.glb", "%5c%5chost/1.glb", "leaves the folder"},
        {"1.glb", "//host/1.glb", "leaves the folder"}, {"1.glb", "https://host/1.glb", "leaves the folder"},
        {"1.glb", "%252e%252e/1.glb", "leaves the folder"}, {"1.glb", "d:1.glb", "leaves the folder"},
        {"1.glb", "a\\nb", "control characters"}, {"1.glb", "a%0ab", "control characters"},
        {"1.glb", ".", "not a regular file"}, {"1.glb", "out.glb", "out.glb: leaves the folder of"},
        {"1.glb", "..\\\\1.glb", "leaves the folder"},
        {"1.glb", "tileset.json", "tileset.json: a tileset that is its own content"},
        {"1.glb", "other.json", "a tileset that is its own content"},
        {"1.glb", "own.json", "own.json: a tileset that is its own content"},
        {"1.glb", "old.b3dm", "old.b3dm: the content of a tile is b3dm, not glTF"},
        {"1.glb", "a.ply", "a.ply: the content of a tile is ply, not glTF"},
        {"1.glb", "text", "text: not a scene file of a known format"}, {"1.glb", "empty", "empty: not a scene file"},
        {"1.glb", "bad.glb", "bad.glb: the file ends early"}
    };
    put_glb("1.glb", 1, 2);
    put_glb("2.glb", 2, 2);
    put_file("bad.glb", glb, glb_size - 1);
    put_file("old.b3dm", "b3dm\1\0\0\0", 8);
    put_file("text", "text", 4);
    put_file("empty", "", 0);
    put_file("a.ply", "ply\nformat ascii 1.0\nelement vertex 0\nend_header\n", 49);
    put_tiles("other.json", "{" CONTENT("tileset.json") "}");
    put_tiles("own.json", "{" CONTENT("own.json") "}");
    CHECK(symlink("/etc/passwd", in_folder("out.glb")) == 0);
    put_file("tileset.json", good, sizeof good - 1);
    CHECK(read_scene("tileset.json") == 4);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *found = strstr(good, cases[i][0]);
        length = 0;
        if (CHECK(found != NULL))
            say("%.*s%s%s", (int)(found - good), good, cases[i][1], found + strlen(cases[i][0]));
        put_file("tileset.json", text, length);
        check_fails(cases[i][2]);
    }
    put_glb("1.glb", 1, 0);
    put_tiles("tileset.json", "{" CONTENT("1.glb") "}");
    check_fails("tileset.json: no Gaussians in the contents of its tiles");
    put_tiles("tileset.json", "{}");
    check_fails("tileset.json: no Gaussians in the contents of its tiles");
}

#define MOVED(x) "\"transform\":[1,0,0,0,0,1,0,0,0,0,1,0," x ",0,0,1],"

static void repeated_contents(void)
{
    static const char *const names[] = {"1.glb", ".//1.glb", "link.glb", "hard.glb", "sub\\\\1.glb",
                                        "sub/tileset.json", "sub\\\\tileset.json"};
    char tiles[1024];
    put_glb("1.glb", 1, 3);
    mkdir(in_folder("sub"), 0700);
    put_glb("sub/1.glb", 1, 3);
    put_tiles("sub/tileset.json", "{" CONTENT("1.glb") "}");
    CHECK(symlink("1.glb", in_folder("link.glb")) == 0 && link(in_folder("1.glb"), in_folder("hard.glb")) == 0);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        snprintf(tiles, sizeof tiles, "{\"refine\":\"ADD\",\"children\":[{\"content\":{\"uri\":\"%s\"}},{" MOVED("3")
                 "\"content\":{\"uri\":\"%s\"}}]}", names[i], names[i]);
        put_tiles("tileset.json", tiles);
        if (CHECK(read_scene("tileset.json") == 6))
            for (int k = 0; k < 3; k++)
                CHECK(fabsf(out[k].position[0] - 3 - out[3 + k].position[0]) < 1e-5f &&
                      !memcmp(out[k].scale, out[3 + k].scale, sizeof out[k].scale));
    }
}

/* Makes tilesets that each name the next tileset twice: 2^20 contents from 20 files. */
static void doubling(void)
{
    char name[32], tiles[256];
    put_glb("1.glb", 1, 1);
    for (int i = 0; i < 15; i++) {
        char next[32];
        snprintf(name, sizeof name, i ? "double%d.json" : "tileset.json", i);
        snprintf(next, sizeof next, i < 14 ? "double%d.json" : "1.glb", i + 1);
        snprintf(tiles, sizeof tiles, "{\"refine\":\"ADD\",\"children\":[{\"content\":{\"uri\":\"%s\"}},{\"content\":"
                 "{\"uri\":\"%s\"}}]}", next, next);
        put_tiles(name, tiles);
    }
    check_fails("more than 16384 contents of tiles");
}

static void deep_nesting(void)
{
    char path[256] = "nest", tiles[64];
    mkdir(in_folder(path), 0700);
    for (int i = 0; i < 20; i++) {
        char name[300];
        snprintf(name, sizeof name, "%s/tileset.json", path);
        put_tiles(name, "{" CONTENT("n/tileset.json") "}");
        strcat(path, "/n");
        mkdir(in_folder(path), 0700);
    }
    snprintf(tiles, sizeof tiles, "{%s}", CONTENT("nest/tileset.json"));
    put_tiles("tileset.json", tiles);
    check_fails("tilesets nested too deep");
}

static void put_many(void)
{
    static char tiles[1 << 15];
    size_t at = (size_t)sprintf(tiles, "{\"refine\":\"ADD\",\"children\":[");
    for (int i = 0; i < TILES; i++) {
        char name[16];
        snprintf(name, sizeof name, "many%d.glb", i);
        put_glb(name, i, 1 + i % 5);
        at += (size_t)sprintf(tiles + at, "%s{\"content\":{\"uri\":\"%s\"}}", i ? "," : "", name);
    }
    sprintf(tiles + at, "]}");
    put_tiles("tileset.json", tiles);
}

static void many_contents(void)
{
    const long count = TILES / 5 * 15;
    long i = 0;
    put_many();
    CHECK(read_step("tileset.json", NULL, 7) == count);
    for (int tile = 0; tile < TILES; tile++)
        for (int k = 0; k < 1 + tile % 5; k++, i++)
            CHECK(is_at(&out[i], tile, 1, 0.25 * k));
    CHECK(read_step("tileset.json", &(fxs_scene_file_options){.size = sizeof(fxs_scene_file_options),
                                                              .max_gaussians = (uint64_t)count}, 50) == count);
    const fxs_scene_file_options fewer = {.size = sizeof(fxs_scene_file_options), .max_gaussians = (uint64_t)count - 1};
    CHECK(read_step("tileset.json", &fewer, 50) == FXS_ERR_FILE);
    CHECK(strstr(message.text, "300 Gaussians or more in ") != NULL);
    CHECK(read_step("tileset.json", &(fxs_scene_file_options){.size = sizeof(fxs_scene_file_options),
                                                              .max_memory = 400000}, 50) == count);
    CHECK(read_step("tileset.json", &(fxs_scene_file_options){.size = sizeof(fxs_scene_file_options),
                                                              .max_memory = 4000}, 50) == FXS_ERR_MEMORY);
    CHECK(strstr(message.text, "bytes of memory or more") != NULL);
}

static void bytes_count_once(void)
{
    char words[64];
    struct stat status;
    put_glb("1.glb", 1, 2);
    put_tiles("tileset.json", "{" CONTENT("1.glb") "}");
    stat(in_folder("tileset.json"), &status);
    snprintf(words, sizeof words, "2 Gaussians or more in %zu bytes", (size_t)status.st_size + glb_size);
    CHECK(read_step("tileset.json", &(fxs_scene_file_options){.size = sizeof(fxs_scene_file_options),
                                                              .max_gaussians = 1}, 1) == FXS_ERR_FILE);
    if (!CHECK(strstr(message.text, words) != NULL))
        printf("  %s, not %s\n", message.text, words);
}

static void changed_while_open(void)
{
    fxs_scene_file *file;
    put_many();
    if (!CHECK(fxs_scene_file_open(in_folder("tileset.json"), NULL, &file, &info, &message) == 0))
        return;
    put_glb("many90.glb", 1, 3);
    CHECK(fxs_scene_file_read(file, out, MOST, &message) == FXS_ERR_FILE);
    CHECK(strstr(message.text, "many90.glb: changed while it was open") != NULL);
    fxs_scene_file_close(file);
}

static void too_many_contents(void)
{
    static char tiles[1 << 19];
    size_t at = (size_t)sprintf(tiles, "{\"asset\":{\"version\":\"1.0\"},\"geometricError\":1,\"root\":"
                                "{\"contents\":[");
    for (int i = 0; i <= 16384; i++)
        at += (size_t)sprintf(tiles + at, "%s{\"uri\":\"%d\"}", i ? "," : "", i);
    at += (size_t)sprintf(tiles + at, "]}}");
    put_file("tileset.json", tiles, at);
    check_fails("tileset.json: more than 16384 contents of tiles");
}

static int stop_at_once(void *argument, double done)
{
    (void)argument;
    return done >= 0;
}

static void stopped(void)
{
    put_many();
    CHECK(read_step("tileset.json", &(fxs_scene_file_options){.size = sizeof(fxs_scene_file_options),
                                                              .progress.call = stop_at_once}, 1) == FXS_ERR_STOPPED);
    CHECK(strstr(message.text, "tileset.json: stopped") != NULL);
}

static void from_memory(void)
{
    fxs_scene_file *file;
    CHECK(fxs_scene_file_open_memory("a.json", good, sizeof good - 1, NULL, &file, &info, &message) == FXS_ERR_FILE);
    CHECK(strstr(message.text, "a.json: needs the file 2.glb beside it") != NULL);
}

static void run_tests(void)
{
    RUN(refinement);
    RUN(forms_of_content);
    RUN(same_as_its_content);
    RUN(transforms);
    RUN(globe);
    RUN(nested);
    RUN(faulty_tilesets);
    RUN(repeated_contents);
    RUN(doubling);
    RUN(deep_nesting);
    RUN(many_contents);
    RUN(bytes_count_once);
    RUN(changed_while_open);
    RUN(too_many_contents);
    RUN(stopped);
    RUN(from_memory);
}

#else

static void built_without(void)
{
    fxs_scene_file *file;
    const char tiles[] = "{\"asset\":{\"version\":\"1.1\"},\"geometricError\":0,\"root\":{}}";
    put_file("tileset.json", tiles, sizeof tiles - 1);
    CHECK(fxs_scene_file_open(in_folder("tileset.json"), NULL, &file, &info, &message) == FXS_ERR_UNSUPPORTED);
    CHECK(strstr(message.text, "cannot read 3D Tiles: built without cJSON") != NULL);
}

static void run_tests(void)
{
    RUN(built_without);
}

#endif

int main(void)
{
    return in_a_folder(run_tests);
}
