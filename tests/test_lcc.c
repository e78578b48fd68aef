/* Reads .lcc files that the test's own encoder makes: SH, levels, an environment, faults. `--write FOLDER SCENE
   [SKY]` writes a scene as FOLDER/scene.lcc. */
#include <fixsplat/scene.h>

#include <math.h>
#include <stdint.h>

#include "src/gaussian/transform_internal.h"
#include "folder.h"

static fxs_message message;
static fxs_scene_file_info info;

#ifdef FXS_WITH_CJSON

enum { LEVELS = 2, CELLS = 4, UNIT = 4 + 16 * LEVELS, COUNT = 24, SKY = 3, MOST = 4096 };

typedef struct blob {
    uint8_t bytes[96 * MOST];
    size_t size;
} blob;

typedef struct bounds {
    double low[3], high[3];
} bounds;

static blob index_bytes, data, sh, sky_bytes;
static fxs_gaussian made[COUNT], made_sky[SKY], out[MOST + 1];
static int level_counts[LEVELS];
/* value ranges of the codes in the .lcc. [0]: for the cells, [1]: for the environment */
static bounds scale_bounds[2], sh_bounds[2];

static void put(blob *to, uint64_t value, int size)
{
    for (int i = 0; i < size; i++)
        to->bytes[to->size++] = (uint8_t)(value >> 8 * i);
}

static uint64_t code_of(double value, double low, double high, int most)
{
    return high > low ? (uint64_t)floor((value - low) / (high - low) * most + 0.5) : 0;
}

static void widen(bounds *b, int i, double value)
{
    b->low[i] = fmin(b->low[i], value);
    b->high[i] = fmax(b->high[i], value);
}

static void find_bounds(const fxs_gaussian *g, size_t count, bounds *scale, bounds *coefficients)
{
    const bounds none = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    *scale = *coefficients = none;
    for (size_t n = 0; n < count; n++)
        for (int i = 0; i < 3; i++) {
            widen(scale, i, exp((double)g[n].scale[i]));
            for (int k = 0; k < 15; k++)
                widen(coefficients, i, (double)g[n].sh[3 * k + i]);
        }
}

/* Encodes a quaternion for .lcc. The code omits its largest component. */
static uint32_t rotation_code(const float rotation[4])
{
    uint32_t code = 0, greatest = 0;
    double q[4], norm = 0;
    for (int i = 0; i < 4; i++) {
        q[i] = (double)rotation[(i + 1) % 4];
        norm += q[i] * q[i];
    }
    for (uint32_t i = 1; i < 4; i++)
        greatest = fabs(q[i]) > fabs(q[greatest]) ? i : greatest;
    norm = copysign(sqrt(norm), q[greatest]);
    for (uint32_t i = 0, shift = 0; i < 4; i++)
        if (i != greatest) {
            code |= (uint32_t)code_of(q[i] / norm, -sqrt(0.5), sqrt(0.5), 1023) << shift;
            shift += 10;
        }
    return code | greatest << 30;
}

static void put_row(blob *to, const fxs_gaussian *g, const bounds *scale)
{
    for (int i = 0; i < 3; i++) {
        uint32_t bits;
        memcpy(&bits, &g->position[i], 4);
        put(to, bits, 4);
    }
    for (int i = 0; i < 3; i++)
        put(to, code_of(fmin(fmax(0.5 + 0.28209479177387814 * (double)g->dc[i], 0), 1), 0, 1, 255), 1);
    put(to, code_of(1 / (1 + exp(-(double)g->opacity)), 0, 1, 255), 1);
    for (int i = 0; i < 3; i++)
        put(to, code_of(exp((double)g->scale[i]), scale->low[i], scale->high[i], 65535), 2);
    put(to, rotation_code(g->rotation), 4);
    put(to, 0x112233445566, 6);   /* writes a normal vector, which readers of .lcc ignore */
}

static void put_sh(blob *to, const fxs_gaussian *g, const bounds *b)
{
    static const int most[3] = {2047, 1023, 2047}, shift[3] = {0, 11, 21};
    for (int k = 0; k < 15; k++) {
        uint32_t word = 0;
        for (int i = 0; i < 3; i++)
            word |= (uint32_t)code_of((double)g->sh[3 * k + i], b->low[i], b->high[i], most[i]) << shift[i];
        put(to, word, 4);
    }
    put(to, 0xffffffff, 4);       /* fills the SH record of a Gaussian up to 64 bytes */
}

/* Converts a Gaussian to the axes of .lcc (x right, y front, z up) from the axes of scenes (x right, y down, z
   front). */
static void to_lcc(const fxs_gaussian *from, fxs_gaussian *to)
{
    static double rows[3][4] = {{1, 0, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 0}};
    static fxs_transform transform;
    fxs_transform_init(&transform, rows);
    *to = *from;
    fxs_transform_apply(&transform, to, 3);
}

static void say_attribute(const char *name, const bounds *b)
{
    say(",{\"name\":\"%s\",\"min\":[%.17g,%.17g,%.17g],\"max\":[%.17g,%.17g,%.17g]}", name, b->low[0], b->low[1],
        b->low[2], b->high[0], b->high[1], b->high[2]);
}

/* Makes the JSON text of an .lcc. type: JSON text that is inserted before "attributes". */
static void make_meta(const char *type, int has_sh)
{
    length = 0;
    say("{\"version\":\"5.0\",\"source\":\"ply\",\"totalSplats\":%d,\"totalLevel\":%d,\"indexDataSize\":%d,%s"
        "\"splats\":[%d,%d],\"encoding\":\"COMPRESS\",\"attributes\":[{\"name\":\"opacity\",\"min\":[0],\"max\":[1]}",
        level_counts[0] + level_counts[1], LEVELS, UNIT, type, level_counts[0], level_counts[1]);
    say_attribute("scale", &scale_bounds[0]);
    say_attribute("envscale", &scale_bounds[1]);
    if (has_sh) {
        say_attribute("shcoef", &sh_bounds[0]);
        say_attribute("envshcoef", &sh_bounds[1]);
    }
    say("]}");
}

/* True if Gaussian i is in a level of a cell. Level 0 has all Gaussians of the cell. Level 1 has every fourth,
   except in the last cell. */
static int is_in(const fxs_gaussian *g, size_t i, int cell, int level)
{
    const int own = (g[i].position[0] > 0) + 2 * (g[i].position[2] > 0);
    return own == cell && (level == 0 || (i % 4 == 0 && cell < CELLS - 1));
}

static void make_cells(const fxs_gaussian *g, size_t count, int has_sh)
{
    fxs_gaussian turned;
    index_bytes.size = data.size = sh.size = 0;
    memset(level_counts, 0, sizeof level_counts);
    for (int cell = 0; cell < CELLS; cell++) {
        uint8_t *unit = index_bytes.bytes + UNIT * (CELLS - 1 - cell);
        index_bytes.size = (size_t)(unit - index_bytes.bytes);
        put(&index_bytes, (uint64_t)cell, 4);
        for (int level = 0; level < LEVELS; level++) {
            const size_t begin = data.size;
            for (size_t i = 0; i < count; i++)
                if (is_in(g, i, cell, level)) {
                    to_lcc(&g[i], &turned);
                    put_row(&data, &turned, &scale_bounds[0]);
                    if (has_sh)
                        put_sh(&sh, &turned, &sh_bounds[0]);
                }
            put(&index_bytes, (data.size - begin) / 32, 4);
            put(&index_bytes, begin, 8);
            put(&index_bytes, data.size - begin, 4);
            level_counts[level] += (int)(data.size - begin) / 32;
        }
    }
    index_bytes.size = CELLS * UNIT;
}

static void make_sky(const fxs_gaussian *g, size_t count, int has_sh)
{
    fxs_gaussian turned;
    sky_bytes.size = 0;
    for (size_t i = 0; i < count; i++) {
        to_lcc(&g[i], &turned);
        put_row(&sky_bytes, &turned, &scale_bounds[1]);
        if (has_sh)
            put_sh(&sky_bytes, &turned, &sh_bounds[1]);
    }
}

static void find_turned_bounds(const fxs_gaussian *g, size_t count, int which)
{
    for (size_t i = 0; i < count; i++)
        to_lcc(&g[i], &out[i]);
    find_bounds(out, count, &scale_bounds[which], &sh_bounds[which]);
}

static void write_scene(const fxs_gaussian *g, size_t count, const fxs_gaussian *sky, size_t sky_count, int has_sh)
{
    find_turned_bounds(g, count, 0);
    find_turned_bounds(sky_count ? sky : g, sky_count ? sky_count : count, 1);
    make_cells(g, count, has_sh);
    make_sky(sky, sky_count, has_sh);
    make_meta(has_sh ? "\"fileType\":\"Quality\"," : "\"fileType\":\"Portable\",", 1);
    put_file("scene.lcc", text, length);
    put_file("index.bin", index_bytes.bytes, index_bytes.size);
    put_file("data.bin", data.bytes, data.size);
    remove(in_folder("shcoef.bin"));
    remove(in_folder("environment.bin"));
    if (has_sh)
        put_file("shcoef.bin", sh.bytes, sh.size);
    if (sky_count)
        put_file("environment.bin", sky_bytes.bytes, sky_bytes.size);
}

static long read_scene(const fxs_scene_file_options *options)
{
    fxs_scene_file *file;
    long total[2] = {0, 0}, count = 0;
    memset(&info, 0, sizeof info);
    const int error = fxs_scene_file_open(in_folder("scene.lcc"), options, &file, &info, &message);
    if (error) {
        CHECK(file == NULL && strncmp(message.text, folder, strlen(folder)) == 0 && !strchr(message.text, '\n'));
        return error;
    }
    for (int pass = 0; pass < 2 && count >= 0; pass++) {
        while ((count = fxs_scene_file_read(file, out + total[pass], 7, &message)) > 0)
            total[pass] += count;
        CHECK(fxs_scene_file_rewind(file, &message) == 0);
    }
    fxs_scene_file_close(file);
    CHECK(count == 0 && total[0] == total[1] && total[0] == (long)info.count && strcmp(info.format, "lcc") == 0);
    return total[0];
}

static void check_fails(const char *words)
{
    const long result = read_scene(NULL);
    if (!CHECK(result == FXS_ERR_FILE && strstr(message.text, words)))
        printf("  said: %s\n  not:  %s\n", result < 0 ? message.text : "nothing", words);
}

static double angle_between(const float a[4], const float b[4])
{
    double dot = 0, norm_a = 0, norm_b = 0;
    for (int i = 0; i < 4; i++) {
        dot += (double)a[i] * (double)b[i];
        norm_a += (double)a[i] * (double)a[i];
        norm_b += (double)b[i] * (double)b[i];
    }
    return sqrt(fmax(0, 1 - dot * dot / (norm_a * norm_b)));
}

/* Compares a read Gaussian with its original. Tolerances are half a code's step. For SH they are larger, since a
   rotation mixes up to 7 coefficients. */
static int is_as_made(const fxs_gaussian *g, const fxs_gaussian *from, int which, int has_sh)
{
    const double opacity = 1 / (1 + exp(-(double)g->opacity)), made_opacity = 1 / (1 + exp(-(double)from->opacity));
    int same = fabs(opacity - made_opacity) < 0.501 / 255 && angle_between(g->rotation, from->rotation) < 0.0025;
    for (int i = 0; i < 3; i++) {
        const double step = (scale_bounds[which].high[i] - scale_bounds[which].low[i]) / 65535;
        same &= g->position[i] <= from->position[i] && g->position[i] >= from->position[i];
        same &= fabs((double)g->dc[i] - (double)from->dc[i]) < 0.501 / 255 / 0.28209479177387814;
        const double sigma = exp((double)g->scale[i]);
        same &= fabs(sigma - exp((double)from->scale[i])) < 0.501 * step + 1e-6 * sigma;
    }
    for (int k = 0; k < 45; k++) {
        const double step = (sh_bounds[which].high[k % 3] - sh_bounds[which].low[k % 3]) / 1023;
        same &= fabs((double)g->sh[k] - (has_sh ? (double)from->sh[k] : 0)) < 0.501 * step * sqrt(7);
    }
    return same;
}

static double random_in(double low, double high)
{
    static uint32_t state = 1;
    state = state * 1664525 + 1013904223;
    return low + (high - low) * (state >> 8) / (1 << 24);
}

static void make_gaussians(fxs_gaussian *g, size_t count, double size)
{
    for (; count > 0; count--, g++) {
        for (int i = 0; i < 3; i++) {
            g->position[i] = (float)random_in(-size, size);
            g->scale[i] = (float)log(size * random_in(0.01 * (i + 1), 0.3));
            g->dc[i] = (float)random_in(-1.7, 1.7);
        }
        for (int i = 0; i < 4; i++)
            g->rotation[i] = (float)random_in(-1, 1);
        g->opacity = (float)random_in(-4, 4);
        for (int i = 0; i < 45; i++)
            g->sh[i] = (float)random_in(-0.3 * (i % 3 + 1), 0.2);
    }
}

static void write_made(size_t sky_count, int has_sh)
{
    make_gaussians(made, COUNT, 4);
    make_gaussians(made_sky, SKY, 900);
    write_scene(made, COUNT, made_sky, sky_count, has_sh);
}

static void check_level(int level, size_t sky_count, int has_sh)
{
    const fxs_scene_file_options options = {.size = sizeof(fxs_scene_file_options), .level = level};
    const long count = read_scene(&options);
    long at = 0;
    if (!CHECK(count >= 0))
        printf("  %s\n", message.text);
    CHECK(info.levels == LEVELS && info.sh_degree == (has_sh ? 3 : 0) && info.antialiased == 0);
    for (int cell = 0; cell < CELLS; cell++)
        for (size_t i = 0; i < COUNT; i++)
            if (is_in(made, i, cell, level) && at < count)
                CHECK(is_as_made(&out[at++], &made[i], 0, has_sh));
    CHECK(level > 0 ? at > 0 && at < COUNT / 2 : at == COUNT);
    for (size_t i = 0; i < sky_count && at < count; i++)
        CHECK(is_as_made(&out[at++], &made_sky[i], 1, has_sh));
    CHECK(at == count);
}

static void levels(void)
{
    for (int has_sh = 0; has_sh < 2; has_sh++)
        for (size_t sky_count = 0; sky_count <= SKY; sky_count += SKY) {
            write_made(sky_count, has_sh);
            for (int level = 0; level < LEVELS; level++)
                check_level(level, sky_count, has_sh);
        }
    for (int level = -1; level <= LEVELS; level += LEVELS + 1) {
        CHECK(read_scene(&(fxs_scene_file_options){.size = sizeof(fxs_scene_file_options),
                                                   .level = level}) == FXS_ERR_ARGUMENT);
        CHECK(strstr(message.text, ": levels of detail in this scene: 2") != NULL);
    }
}

/* Checks the change of axes from .lcc (right, front, up) to scenes (right, down, front). SH of degree 1: -y, z,
   -x become -y', z', -x'. */
static void axes(void)
{
    const fxs_gaussian g = {.position = {1, -3, 2}, .scale = {-1, -2, -3}, .rotation = {1, 0, 0, 0}};
    write_scene(&g, 1, NULL, 0, 1);
    /* the position is stored as little-endian floats 1, 2, 3 */
    CHECK(memcmp(data.bytes, "\0\0\200\77\0\0\0\100\0\0\100\100", 12) == 0);
    CHECK(read_scene(NULL) == 1);
    CHECK(angle_between(out[0].rotation, g.rotation) < 0.0025);
    for (int i = 0; i < 3; i++)
        CHECK(fabsf(out[0].position[i] - g.position[i]) < 1e-6f && fabsf(out[0].scale[i] - g.scale[i]) < 1e-4f);
    memset(sh.bytes, 0, sh.size);
    /* sets the code of the first red SH coefficient to its maximum, all others to 0 */
    memcpy(sh.bytes, "\377\7", 2);
    sh_bounds[0] = (bounds){{0, 0, 0}, {0.5, 0, 0}};
    put_file("shcoef.bin", sh.bytes, sh.size);
    make_meta("", 1);
    put_file("scene.lcc", text, length);
    CHECK(read_scene(NULL) == 1);
    for (int i = 0; i < 9; i++)   /* the coefficient of -y in the file becomes the coefficient of -z in the scene */
        CHECK(fabsf(out[0].sh[i] - (i == 3 ? -0.5f : 0)) < 1e-6f);
}

static void names_of_the_white_paper(void)
{
    static const char *const names[][2] = {{"index.bin", "Index.bin"}, {"data.bin", "Data.bin"},
                                           {"shcoef.bin", "Shcoef.bin"}, {"environment.bin", "Environment.bin"}};
    write_made(SKY, 1);
    for (int i = 0; i < 4; i++)
        CHECK(rename(in_folder(names[i][0]), in_folder(names[i][1])) == 0);
    check_level(0, SKY, 1);
    for (int i = 0; i < 4; i++)
        remove(in_folder(names[i][1]));
}

static void without_a_type(void)
{
    static const char *const types[] = {"", "\"fileType\":\"other\",", "\"fileType\":7,"};
    for (int i = 0; i < 3; i++)
        for (int has_sh = 0; has_sh < 2; has_sh++) {
            write_made(SKY, has_sh);
            make_meta(types[i], has_sh);
            put_file("scene.lcc", text, length);
            check_level(0, SKY, has_sh);
        }
}

static void bounds_of_the_sky(void)
{
    write_made(0, 1);
    make_sky(made, SKY, 1);
    put_file("environment.bin", sky_bytes.bytes, sky_bytes.size);
    make_meta("", 1);
    for (char *at; (at = strstr(text, "\"env"));)
        memcpy(at, "\"not", 4);
    put_file("scene.lcc", text, length);
    CHECK(read_scene(NULL) == COUNT + SKY);
    for (size_t i = 0; i < SKY; i++)
        CHECK(is_as_made(&out[COUNT + i], &made[i], 0, 1));
}

static void faulty_meta(void)
{
    static const struct { const char *from, *to, *words; } cases[] = {
        {"totalLevel\":2", "totalLevel\":0", "no valid \"totalLevel\""},
        {"totalLevel\":2", "totalLevel\":-1", "no valid \"totalLevel\""},
        {"totalLevel\":2", "totalLevel\":1.5", "no valid \"totalLevel\""},
        {"totalLevel\":2", "totalLevel\":1e9", "no valid \"totalLevel\""},
        {"totalLevel\":2", "totalLevel\":\"2\"", "no valid \"totalLevel\""},
        {"totalLevel\":2", "totalLevel\":3", "index.bin: 144 bytes are not whole cells of 52"},
        {"COMPRESS", "PLAIN", "an \"encoding\" that is not known: not COMPRESS"},
        {"\"scale\"", "\"scales\"", "no valid \"min\" and \"max\" of \"scale\""},
        {"\"envscale\",\"min\":[", "\"envscale\",\"min\":[1,", "no valid \"min\" and \"max\" of \"scale\""},
        {"\"shcoef\"", "\"other\"", "no valid \"min\" and \"max\" of \"shcoef\""},
        {"\"attributes\":[", "\"attributes\":[7,{},{\"name\":8},", NULL},
        {"\"attributes\"", "\"none\"", "no valid \"min\" and \"max\" of \"scale\""},
        {"{\"version\"", "{\"version", "bad JSON at byte "},
    };
    static char changed[sizeof text];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        write_made(SKY, 1);
        const char *at = strstr(text, cases[i].from);
        if (!CHECK(at != NULL))
            continue;
        snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - text), text, cases[i].to, at + strlen(cases[i].from));
        put_file("scene.lcc", changed, strlen(changed));
        if (cases[i].words)
            check_fails(cases[i].words);
        else
            CHECK(read_scene(NULL) == COUNT + SKY);
    }
}

static void faulty_index(void)
{
    static const struct { int at, size; uint64_t value; const char *words; } cases[] = {
        {0, 4, 0xffffffff, "index.bin: cell 4 of 4: more Gaussians than its bytes hold"},
        {12, 4, 0, "index.bin: cell 4 of 4: more Gaussians than its bytes hold"},
        {4, 8, UINT64_MAX, "data.bin: the file ends before the last Gaussian of a cell"},
        {4, 8, UINT64_MAX - 31, "data.bin: the file ends before the last Gaussian of a cell"},
        {4, 8, (uint64_t)1 << 63, "data.bin: the file ends before the last Gaussian of a cell"},
        {4, 8, 32 * COUNT, "data.bin: two cells share a Gaussian"}
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        write_made(0, 1);
        index_bytes.size = (size_t)(UNIT * (CELLS - 1) + 4 + cases[i].at);
        put(&index_bytes, cases[i].value, cases[i].size);
        put_file("index.bin", index_bytes.bytes, CELLS * UNIT);
        check_fails(cases[i].words);
        CHECK(read_scene(&(fxs_scene_file_options){.size = sizeof(fxs_scene_file_options), .level = 1}) > 0);
    }
}

/* Cells that share the same Gaussians are refused, since a small file could expand to a huge scene. */
static void same_cell_again(void)
{
    write_made(0, 1);
    index_bytes.size = 0;
    for (int i = 0; i < 1000; i++) {
        put(&index_bytes, (uint64_t)i, 4);
        for (int level = 0; level < LEVELS; level++) {
            put(&index_bytes, data.size / 32, 4);
            put(&index_bytes, 0, 8);
            put(&index_bytes, data.size, 4);
        }
    }
    put_file("index.bin", index_bytes.bytes, index_bytes.size);
    check_fails("data.bin: two cells share a Gaussian");
}

static void limits(void)
{
    write_made(SKY, 1);
    CHECK(read_scene(&(fxs_scene_file_options){.size = sizeof(fxs_scene_file_options),
                                               .max_gaussians = COUNT + SKY}) == COUNT + SKY);
    CHECK(read_scene(&(fxs_scene_file_options){.size = sizeof(fxs_scene_file_options),
                                               .max_gaussians = COUNT + SKY - 1}) == FXS_ERR_FILE);
    CHECK(strstr(message.text, "beyond the limit of 26") != NULL);
    CHECK(read_scene(&(fxs_scene_file_options){.size = sizeof(fxs_scene_file_options),
                                               .max_memory = 1000}) == FXS_ERR_MEMORY);
}

static void missing_files(void)
{
    static const char *const names[] = {"index.bin", "data.bin", "shcoef.bin"};
    for (int i = 0; i < 3; i++) {
        write_made(SKY, 1);
        remove(in_folder(names[i]));
        check_fails(names[i]);
    }
}

static void without_cells(void)
{
    write_made(SKY, 0);
    put_file("index.bin", "", 0);
    CHECK(read_scene(NULL) == SKY);
    remove(in_folder("environment.bin"));
    CHECK(read_scene(NULL) == 0);
}

static void run_tests(void)
{
    RUN(levels);
    RUN(axes);
    RUN(names_of_the_white_paper);
    RUN(without_a_type);
    RUN(bounds_of_the_sky);
    RUN(faulty_meta);
    RUN(faulty_index);
    RUN(same_cell_again);
    RUN(limits);
    RUN(missing_files);
    RUN(without_cells);
}

static long read_other(const char *path, fxs_gaussian *gaussians)
{
    fxs_scene_file *file;
    if (fxs_scene_file_open(path, NULL, &file, &info, &message) || info.count > MOST)
        return -1;
    const long count = fxs_scene_file_read(file, gaussians, MOST, &message);
    fxs_scene_file_close(file);
    return count;
}

static int write_of(const char *to, const char *scene, const char *sky)
{
    static fxs_gaussian others[2][MOST];
    snprintf(folder, sizeof folder, "%s", to);
    const long count = read_other(scene, others[0]), sky_count = sky ? read_other(sky, others[1]) : 0;
    if (count > 0 && sky_count >= 0)
        write_scene(others[0], (size_t)count, others[1], (size_t)sky_count, 1);
    return count <= 0 || sky_count < 0 || check_faults != 0;
}

#else

static void built_without(void)
{
    fxs_scene_file *file;
    const char meta[] = "{\"version\":\"5.0\",\"totalLevel\":1}";
    put_file("scene.lcc", meta, sizeof meta - 1);
    CHECK(fxs_scene_file_open(in_folder("scene.lcc"), NULL, &file, &info, &message) == FXS_ERR_UNSUPPORTED);
    CHECK(strstr(message.text, "cannot read .lcc: built without cJSON") != NULL);
}

static void run_tests(void)
{
    RUN(built_without);
}

static int write_of(const char *to, const char *scene, const char *sky)
{
    (void)to, (void)scene, (void)sky;
    return 1;
}

#endif

int main(int argc, char **argv)
{
    if (argc >= 4 && strcmp(argv[1], "--write") == 0)
        return write_of(argv[2], argv[3], argc > 4 ? argv[4] : NULL);
    return in_a_folder(run_tests);
}
