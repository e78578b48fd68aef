/* Reads .rad files that the test makes: every encoding of every property, SH palettes, level-of-detail trees, faulty
   files. */
#include "scene_writer.h"
#include "rad_bytes.h"

#if defined(FXS_WITH_CJSON) && defined(FXS_WITH_ZLIB)

enum { COUNT = 5, CHUNK = 3, SH = 45 };

static fxs_gaussian out[64];

static int code_of(int property, int row, int i)
{
    return (int)((uint32_t)(property * 4096 + row * 64 + i + 1) * 2654435761u >> 24);
}

static int half_bits(int property, int row, int i)
{
    const int code = code_of(property, row, i);
    return (code & 1) << 15 | (10 + code % 6) << 10 | code << 2;
}

static double half_value(int bits)
{
    return (bits >> 15 ? -1 : 1) * ldexp(1 + (bits & 1023) / 1024.0, (bits >> 10 & 31) - 15);
}

static float float_value(int property, int row, int i)
{
    return (float)half_value(half_bits(property, row, i)) * 1.0001f;
}

enum { CENTER, ALPHA, RGB, SCALES, ORIENTATION, SH1, SH2, SH3, CHILD_COUNT, CHILD_START, SH_LABEL, PROPERTIES };

static const struct { const char *name; int numbers; } properties[PROPERTIES] = {
    {"center", 3}, {"alpha", 1}, {"rgb", 3}, {"scales", 3}, {"orientation", 3}, {"sh1", 9}, {"sh2", 15}, {"sh3", 21},
    {"child_count", 1}, {"child_start", 1}, {"sh_label", 1}
};

/* Returns the value that a code in a .rad decodes to. Encodings with a value range use the range -1 to 3. */
static double value_of(const char *encoding, int property, int row, int i)
{
    const int code = code_of(property, row, i);
    if (!strncmp(encoding, "f32", 3))
        return (double)float_value(property, row, i);
    if (strstr(encoding, "f16"))
        return half_value(half_bits(property, row, i));
    if (!strncmp(encoding, "s8", 2))
        return (code < 128 ? code : code - 256) / 127.0 * 3;
    return !strcmp(encoding, "ln_0r8") ? (code ? -1 + (code - 1) * 4 / 254.0 : -20) : -1 + code / 255.0 * 4;
}

static void put_bytes_of(const char *encoding, int property, int first, int rows)
{
    const int numbers = properties[property].numbers;
    const int planes = !strcmp(encoding, "f32_lebytes") ? 4 : !strcmp(encoding, "f16_lebytes") ? 2 : 1;
    for (int plane = 0; plane < planes; plane++)
        for (int i = 0; i < numbers; i++)
            for (int row = first, last = 0; row < first + rows; row++) {
                const int code = code_of(property, row, i), half = half_bits(property, row, i);
                const float value = float_value(property, row, i);
                uint32_t bits;
                memcpy(&bits, &value, 4);
                if (planes > 1)
                    put_u8((int)((planes == 4 ? bits : (uint32_t)half) >> 8 * plane & 255));
                else if (!strcmp(encoding, "f32"))
                    put_float(value);
                else if (strstr(encoding, "f16"))
                    put_u16(half);
                else
                    put_u8(strstr(encoding, "_delta") ? code - last : code);
                last = code;
            }
}

/* Writes the column of rotations of a .rad. The quaternions' vectors x, y, z are shorter than 1. */
static void put_rotations(const char *encoding, int first, int rows)
{
    if (strcmp(encoding, "oct88r8") == 0)
        for (int row = first; row < first + rows; row++)
            for (int i = 0; i < 3; i++)
                put_u8(code_of(ORIENTATION, row, i));
    else
        for (int i = 0; i < 3; i++)
            for (int row = first; row < first + rows; row++)
                if (strcmp(encoding, "f32") == 0)
                    put_float((float)code_of(ORIENTATION, row, i) / 512);
                else
                    put_u16(14 << 10 | (code_of(ORIENTATION, row, i) & 15));
}

static const char *encodings[PROPERTIES];

static void put_columns(int first, int rows, int degree)
{
    for (int property = 0; property < SH1 + degree; property++) {
        const char *encoding = encodings[property];
        if (property == ORIENTATION)
            put_rotations(encoding, first, rows);
        else
            put_bytes_of(encoding, property, first, rows);
        rad_add_column(properties[property].name, encoding, strstr(encoding, "8") ? ",\"min\":-1,\"max\":3" : "");
    }
}

static void make(int degree, int compressed)
{
    char more[32];
    rad_begin(compressed);
    for (int base = 0; base < COUNT; base += CHUNK) {
        const int rows = COUNT - base < CHUNK ? COUNT - base : CHUNK;
        put_columns(base, rows, degree);
        rad_add_chunk(base, rows);
    }
    snprintf(more, sizeof more, ",\"maxSh\":%d", degree);
    rad_end(COUNT, CHUNK, more);
}

static int reads(uint64_t count)
{
    put_file(size);
    if (!CHECK(read_file(out, 64) == 0)) {
        printf("  %s\n", message.text);
        return 0;
    }
    return CHECK(info.count == count && strcmp(info.format, "rad") == 0 && !info.antialiased);
}

/* Decodes a .rad's rotation by Spark's formulas: an octahedral axis and an angle of 0 to pi. */
static void expected_rotation(int row, double q[4])
{
    int code[3];
    double rest = 1;
    for (int i = 0; i < 3; i++)
        code[i] = code_of(ORIENTATION, row, i);
    if (!strcmp(encodings[ORIENTATION], "oct88r8")) {
        double x = code[0] / 127.5 - 1, y = code[1] / 127.5 - 1, z = 1 - fabs(x) - fabs(y), t = fmax(-z, 0);
        const double half = code[2] / 255.0 * acos(-1) / 2;
        x += x >= 0 ? -t : t;
        y += y >= 0 ? -t : t;
        const double length = sqrt(x * x + y * y + z * z);
        const double made[4] = {x / length * sin(half), y / length * sin(half), z / length * sin(half), cos(half)};
        memcpy(q, made, sizeof made);
        return;
    }
    for (int i = 0; i < 3; i++) {
        q[i] = !strcmp(encodings[ORIENTATION], "f32") ? code[i] / 512.0 : ldexp(1024 + (code[i] & 15), -11);
        rest -= q[i] * q[i];
    }
    q[3] = sqrt(fmax(rest, 0));
}

static void check_gaussian(const fxs_gaussian *g, int row, int degree)
{
    double q[4];
    const double alpha = fmin(fmax(value_of(encodings[ALPHA], ALPHA, row, 0), 2e-9), 1 - 2e-9);
    const int is_linear = !strcmp(encodings[SCALES], "f32");
    expected_rotation(row, q);
    CHECK(is_near(g->rotation[0], q[3], 2e-6) && is_near(opacity_of(g), alpha, 2e-6));
    for (int i = 0; i < 3; i++) {
        const double scale = value_of(encodings[SCALES], SCALES, row, i);
        CHECK(is_near(g->rotation[1 + i], q[i], 2e-6));
        CHECK(is_near(g->position[i], value_of(encodings[CENTER], CENTER, row, i), 2e-6));
        CHECK(is_near(g->dc[i], (value_of(encodings[RGB], RGB, row, i) - 0.5) / 0.28209479177387814, 2e-6));
        CHECK(is_near(g->scale[i], is_linear ? log(fabs(scale)) : scale, 2e-6));
    }
    for (int i = 0; i < SH; i++) {
        const int d = i < 9 ? 0 : i < 24 ? 1 : 2, first = i < 9 ? 0 : i < 24 ? 9 : 24;
        CHECK(is_near(g->sh[i], d < degree ? value_of(encodings[SH1 + d], SH1 + d, row, i - first) : 0, 2e-6));
    }
}

static const char *const all_encodings[] = {
    "f32", "f16", "f32_lebytes", "f16_lebytes", "r8", "r8_delta", "s8", "s8_delta", "ln_0r8", "ln_f16", "oct88r8",
    "u16", "u32", "r16"
};

enum { ENCODINGS = sizeof all_encodings / sizeof *all_encodings };

static const char *const known[PROPERTIES] = {
    "f32 f16 f32_lebytes f16_lebytes ", "f32 f16 r8 ", "f32 f16 r8 r8_delta ", "f32 ln_0r8 ln_f16 ", "f32 f16 oct88r8 ",
    "f32 f16 r8 r8_delta s8 s8_delta ", "f32 f16 r8 r8_delta s8 s8_delta ", "f32 f16 r8 r8_delta s8 s8_delta "
};

static void usual_encodings(void)
{
    static const char *const usual[SH3 + 1] = {"f32_lebytes", "f16", "r8_delta", "ln_0r8", "oct88r8", "s8", "s8", "s8"};
    memcpy(encodings, usual, sizeof usual);
}

static int is_known(int property, const char *encoding)
{
    char word[32];
    snprintf(word, sizeof word, "%s ", encoding);
    const char *at = strstr(known[property], word);
    return at && (at == known[property] || at[-1] == ' ');
}

static void every_encoding(void)
{
    for (int property = 0; property <= SH3; property++)
        for (int e = 0; e < ENCODINGS; e++)
            for (int compressed = 0; compressed < 2; compressed++) {
                const int degree = property < SH1 ? e % 4 : property - SH1 + 1;
                usual_encodings();
                encodings[property] = all_encodings[e];
                make(degree, compressed);
                if (!is_known(property, all_encodings[e])) {
                    check_fails("chunk 1 of 2: an encoding that is not known");
                    continue;
                }
                if (!reads(COUNT))
                    continue;
                CHECK(info.sh_degree == degree && info.levels == 1);
                for (int row = 0; row < COUNT; row++)
                    check_gaussian(&out[row], row, degree);
            }
}

static void steps_of_colours(void)
{
    usual_encodings();
    make(0, 1);
    CHECK(reads(COUNT) && info.colour.low == -1 && is_near(info.colour.step, 4 / 255.0, 1e-12));
    encodings[RGB] = "f16";
    make(0, 1);
    CHECK(reads(COUNT) && info.colour.step == 0);
}

static void palettes(void)
{
    static const int labels[COUNT] = {1, 0, 1, 1, 0};
    for (int wide = 0; wide < 2; wide++) {
        usual_encodings();
        rad_begin(1);
        for (int base = 0; base < COUNT; base += CHUNK) {
            const int rows = COUNT - base < CHUNK ? COUNT - base : CHUNK;
            put_columns(base, rows, 0);
            for (int degree = 0; degree < 2 && !base; degree++) {
                put_bytes_of("s8", SH1 + degree, 0, 2);
                rad_add_column(degree ? "sh2_code" : "sh1_code", "s8", ",\"max\":3");
            }
            for (int row = base; row < base + rows; row++)
                wide ? put_u32((uint32_t)labels[row]) : put_u16(labels[row]);
            rad_add_column("sh_label", wide ? "u32" : "u16", "");
            rad_add_chunk(base, rows);
        }
        rad_end(COUNT, CHUNK, ",\"maxSh\":2,\"shCodeCount\":2");
        if (reads(COUNT))
            for (int row = 0; row < COUNT; row++)
                for (int i = 0; i < 24; i++) {
                    const double value = value_of("s8", i < 9 ? SH1 : SH2, labels[row], i < 9 ? i : i - 9);
                    CHECK(is_near(out[row].sh[i], value, 2e-6));
                }
    }
    bytes[size - 8]++;                 /* damages the compressed last column, the SH labels */
    put_file(size);
    CHECK(read_file(out, 64) == FXS_ERR_FILE);
}

/* Makes a .rad with a level-of-detail tree. children[i]: first child and number of children of node i. */
static void make_tree(const int (*children)[2], int count, int chunk, float alpha)
{
    rad_begin(1);
    usual_encodings();
    encodings[ALPHA] = "f32";
    for (int base = 0; base < count; base += chunk) {
        const int rows = count - base < chunk ? count - base : chunk;
        for (int property = 0; property < SH1; property++) {
            if (property == ALPHA)
                for (int row = 0; row < rows; row++)
                    put_float(alpha);
            else if (property == ORIENTATION)
                put_rotations(encodings[property], base, rows);
            else
                put_bytes_of(encodings[property], property, base, rows);
            rad_add_column(properties[property].name, encodings[property], ",\"min\":-1,\"max\":3");
        }
        for (int row = base; row < base + rows; row++)
            put_u16(children[row][1]);
        rad_add_column("child_count", "u16", "");
        for (int row = base; row < base + rows; row++)
            put_u32((uint32_t)children[row][0]);
        rad_add_column("child_start", "u32", "");
        rad_add_chunk(base, rows);
    }
    rad_end(count, chunk, ",\"lodTree\":true");
}

static int has_node(int row)
{
    for (uint64_t i = 0; i < info.count; i++)
        if (is_near(out[i].position[0], value_of("f32", CENTER, row, 0), 1e-6))
            return 1;
    return 0;
}

/* A level-of-detail tree: first child and number of children of each node. */
static const int tree[7][2] = {{1, 3}, {4, 2}, {0, 0}, {0, 0}, {0, 0}, {6, 1}, {0, 0}};

static void levels(void)
{
    static const char *const drawn[4] = {"..xxx.x", "..xxxx.", ".xxx...", "x......"};
    make_tree(tree, 7, 4, 0.5f);
    for (int level = 0; level < 4; level++) {
        open_options.level = level;
        uint64_t count = 0;
        for (int row = 0; row < 7; row++)
            count += drawn[level][row] == 'x';
        if (!reads(count))
            continue;
        CHECK(info.levels == 4);
        for (int row = 0; row < 7; row++)
            CHECK(has_node(row) == (drawn[level][row] == 'x'));
    }
    open_options.level = 4;
    put_file(size);
    CHECK(read_file(out, 64) == FXS_ERR_ARGUMENT);
    open_options.level = 0;
}

/* A .rad codes opacities above 1. Code 1.5 decodes to D = 3 and A = e^(8/e). The reader makes the node opaque
   and enlarges it by A^(1/3). */
static void more_than_opaque(void)
{
    static const int alone[1][2] = {{0, 0}};
    make_tree(alone, 1, 1, 1.5f);
    CHECK(reads(1) && out[0].opacity == 20 && info.levels == 1);
    CHECK(is_near(out[0].scale[0], value_of("ln_0r8", SCALES, 0, 0) + 8 / exp(1) / 3, 1e-6));
    make_tree(alone, 1, 1, 1);
    CHECK(reads(1) && out[0].opacity == 20 && is_near(out[0].scale[0], value_of("ln_0r8", SCALES, 0, 0), 1e-6));
}

static void bad_trees(void)
{
    static const int backward[3][2] = {{1, 1}, {0, 1}, {0, 0}}, itself[3][2] = {{0, 1}, {0, 0}, {0, 0}},
                     beyond[3][2] = {{1, 3}, {0, 0}, {0, 0}}, far[3][2] = {{4000, 1}, {0, 0}, {0, 0}},
                     shared[3][2] = {{1, 2}, {2, 1}, {0, 0}};
    const int (*const trees[])[2] = {backward, itself, beyond, far, shared};
    for (int i = 0; i < 5; i++) {
        make_tree(trees[i], 3, 2, 0.5f);
        check_fails("children that are no later nodes of their own");
    }
}

/* Reads unusual level-of-detail trees. A node with two parents is drawn once. A chain of nodes has at most 255
   levels. */
static void chains(void)
{
    static int chain[600][2];
    for (int i = 0; i < 599; i++) {
        chain[i][0] = i + 1;
        chain[i][1] = 1;
    }
    make_tree((const int (*)[2])chain, 600, 600, 0.5f);
    CHECK(reads(1) && info.levels == 255);
    open_options.level = 254;
    CHECK(reads(1));
    open_options.level = 0;
}

enum { MANY = 3000 };

static void write_line(int count, float opacity)
{
    static fxs_gaussian line[MANY];
    fxs_scene_writer *writer;
    for (int i = 0; i < count; i++)
        line[i] = (fxs_gaussian){.position = {(float)i / 64, 0, 0}, .scale = {-4, -4, -4}, .rotation = {1, 0, 0, 0},
                                 .opacity = opacity, .dc = {i % 2 ? 1.0f : -1.0f, 0, 0}, .sh = {(float)(i % 2) / 2}};
    CHECK(open_writer("rad", written, (uint64_t)count, 1, 0, &writer, &message) == 0);
    CHECK(fxs_scene_writer_put(writer, line, (size_t)count, &message) == 0);
    CHECK(close_writer(writer, &message) == 0);
    take_written();
    size = file_size;
}

static void check_level(int level, uint64_t before)
{
    static fxs_gaussian all[MANY];
    const double middle = (MANY - 1) / 128.0;
    double sum = 0, mean = 0, variance = 0, dc = 0, sh = 0;
    open_options.level = level;
    put_file(size);
    if (!CHECK(read_file(all, MANY) == 0 && info.count < before))
        return;
    for (uint64_t i = 0; i < info.count; i++) {
        const fxs_gaussian *g = &all[i];
        const double longest = fmax(fmax(g->scale[0], g->scale[1]), g->scale[2]), from = g->position[0] - middle;
        double area = 0;
        for (int k = 0; k < 3; k++)
            area += exp(2 * ((double)g->scale[k] + g->scale[(k + 1) % 3]));
        const double weight = sqrt(area) * opacity_of(g);
        sum += weight;
        mean += weight * from;
        dc += weight * g->dc[0];
        sh += weight * g->sh[0];
        variance += weight * (from * from + exp(2 * longest));
    }
    CHECK(fabs(mean / sum) < 0.1 && fabs(dc / sum) < 0.02 && fabs(sh / sum - 0.25) < 0.02);
    CHECK(fabs(sqrt(variance / sum) - MANY / 64.0 / sqrt(12)) < 0.1);
}

static void written_trees(void)
{
    static uint8_t again[MAX_FILE];
    write_line(MANY, -6);
    memcpy(again, bytes, size);
    const size_t before = size;
    write_line(MANY, -6);
    CHECK(size == before && !memcmp(again, bytes, size));
    uint64_t count = MANY + 1;
    put_file(size);
    fxs_scene_file *file;
    CHECK(fxs_scene_file_open_memory(path, bytes, size, NULL, &file, &info, &message) == 0);
    fxs_scene_file_close(file);
    const int levels = info.levels;
    CHECK(levels > 8 && levels < 20);
    for (int level = 0; level < levels; level++) {
        check_level(level, count);
        count = info.count;
    }
    CHECK(count == 1);
    open_options.level = levels - 1;   /* level with opaque leaves merged into nodes of a coded opacity above 1 */
    write_line(MANY, 6);
    put_file(size);
    CHECK(read_file(out, 64) == 0 && out[0].opacity == 20);
    open_options.level = 0;
}

static void small_trees(void)
{
    static const int counts[] = {0, 1, 2, 256, 257};
    for (int i = 0; i < 5; i++) {
        static fxs_gaussian all[MANY];
        write_line(counts[i], 0);
        put_file(size);
        CHECK(read_file(all, MANY) == 0 && info.count == (uint64_t)counts[i]);
        CHECK((info.levels > 1) == (counts[i] > 1));
    }
}

static void replace(const char *from, const char *to)
{
    size_t i = 0;
    while (i + strlen(from) < size && memcmp(bytes + i, from, strlen(from)))
        i++;
    if (CHECK(i + strlen(from) < size && strlen(from) == strlen(to)))
        memcpy(bytes + i, to, strlen(to));
}

static void faults(void)
{
    static const struct { const char *from, *to, *said; } all[] = {
        {"\"version\":1", "\"version\":2", "a version that is not known"},
        {"gsplat", "points", "a type that is not known"},
        {"\"count\":5", "\"count\":x", "bad JSON"},
        {"\"count\":5", "\"count\":7", "\"chunks\" that are not as many"},
        {"\"count\":5", "\"count\":6", "\"base\" and \"count\""},
        {"\"chunkSize\":3", "\"chunkSize\":0", "no valid \"chunkSize\""},
        {"\"maxSh\":1", "\"maxSh\":4", "no valid \"maxSh\""},
        {"\"offset\":0", "\"offset\":8", "no RADC where a chunk should begin"},
        {"\"offset\":0", "\"offsex\":0", "a chunk with no valid \"offset\" and \"bytes\""},
        {"RADC", "RADD", "no RADC where a chunk should begin"},
        {"\"base\":0", "\"base\":3", "chunk 1 of 2: a \"base\" and \"count\""},
        {"\"alpha\"", "\"rgb\"  ", "chunk 1 of 2: a property that it has twice"},
        {"\"alpha\"", "\"olpha\"", "chunk 1 of 2: without center, alpha"},
        {"\"max\":3", "\"mix\":3", "chunk 1 of 2: no \"min\" and \"max\""},
        {"\"gz\"", "\"xz\"", "chunk 1 of 2: a compression that is not known"}
    };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        usual_encodings();
        make(1, 1);
        replace(all[i].from, all[i].to);
        check_fails(all[i].said);
    }
    make(1, 0);
    replace("\"count\":5", "\"count\":4");
    check_fails("\"base\" and \"count\"");
    make(1, 1);
    memcpy(bytes, "RADC", 4);
    check_fails("one chunk of a .rad");
}

static void wrong_sizes(void)
{
    for (int rows = 1; rows <= 3; rows += 2)
        for (int compressed = 0; compressed < 2; compressed++) {
            usual_encodings();
            rad_begin(compressed);
            put_columns(0, 2, 1);
            rad_columns[0] = rad_columns[--rad_column_count];
            put_bytes_of("f32", CENTER, 0, rows);
            rad_add_column("center", "f32", "");
            for (int i = 0; i < 9; i++)
                put_u16(0);
            rad_add_column("sh1", "s8", ",\"max\":1");
            rad_column_count--;
            rad_add_chunk(0, 2);
            rad_end(2, 2, "");
            check_fails(compressed ? "compressed data that are damaged, or not 24 bytes"
                                   : "cannot be the 24 of 2 Gaussians");
        }
}

int main(void)
{
    make_written();
    RUN(every_encoding);
    RUN(steps_of_colours);
    RUN(palettes);
    RUN(levels);
    RUN(more_than_opaque);
    RUN(bad_trees);
    RUN(chains);
    RUN(written_trees);
    RUN(small_trees);
    RUN(faults);
    RUN(wrong_sizes);
    remove(written);
    return check_report();
}

#else

static void nothing(void)
{
    SKIP("built without cJSON or zlib");
}

int main(void)
{
    RUN(nothing);
    return check_report();
}

#endif
