/* Writes scene files in each format and reads them back. Checks the numbers in the files, and errors. */
#include <locale.h>
#include <stdlib.h>

#include "src/base/number.h"
#include "src/scene/write/codebook_internal.h"
#include <fixsplat/scene.h>
#include "scene_bytes.h"

enum { COUNT = 300 };

#define SH_0 0.28209479177387814

static fxs_gaussian wanted[COUNT], got[COUNT];
static fxs_scene_write_report report;
static char name[64];
static uint32_t state;

static double random_between(double low, double high)
{
    state = state * 1664525 + 1013904223;
    return low + (high - low) * (state >> 8) / 16777216.0;
}

/* Makes test Gaussians that are far apart, so that they can be identified after quantisation. */
static void make(int sh_degree)
{
    state = 1;
    memset(wanted, 0, sizeof wanted);
    for (int i = 0; i < COUNT; i++) {
        fxs_gaussian *g = &wanted[i];
        const int cell[3] = {i % 7, i / 7 % 7, i / 49};
        for (int k = 0; k < 3; k++) {
            g->position[k] = (float)(cell[k] - 3 + random_between(-0.2, 0.2));
            g->scale[k] = (float)random_between(-6, -1);
            g->dc[k] = (float)random_between(-1.5, 1.5);
        }
        for (int k = 0; k < 4; k++)
            g->rotation[k] = (float)random_between(-1, 1);
        g->opacity = (float)random_between(-4, 4);
        for (int k = 0; k < 3 * sh_degree * (sh_degree + 2); k++)
            g->sh[k] = (float)random_between(-0.5, 0.5);
    }
    wanted[5].opacity = -9;   /* almost transparent, so that its opacity code is 0; it must keep its colour */
}

static fxs_scene_write_options options_of(int sh_degree, int antialiased)
{
    fxs_scene_write_options o = {.size = sizeof(fxs_scene_write_options), .count = COUNT, .sh_degree = sh_degree,
                                 .antialiased = antialiased,
                                 .spz_fine = 1};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < COUNT; k++) {
            const float x = wanted[k].position[i];
            o.low[i] = !k || x < o.low[i] ? x : o.low[i];
            o.high[i] = !k || x > o.high[i] ? x : o.high[i];
        }
    return o;
}

static const char *named(const char *ending)
{
    snprintf(name, sizeof name, "%s%s", written, ending);
    return name;
}

static int write_all(const char *ending, const fxs_scene_write_options *o, const fxs_progress *progress)
{
    fxs_scene_writer *writer;
    FILE *stream;
    int result = fxs_scene_writer_open(named(ending), o, &writer, &message);
    if (result)
        return result;
    CHECK(fxs_scene_writer_put(writer, wanted, 7, &message) == 0);
    CHECK(fxs_scene_writer_put(writer, wanted + 7, COUNT - 7, &message) == 0);
    result = fxs_scene_writer_close(writer, &report, progress, &message);
    stream = fopen(name, "rb");
    put_file(stream ? fread(bytes, 1, MAX_FILE, stream) : 0);
    if (stream)
        fclose(stream);
    remove(name);
    return result;
}

static const fxs_gaussian *nearest(const fxs_gaussian *to)
{
    const fxs_gaussian *best = got;
    double least = INFINITY;
    for (const fxs_gaussian *g = got; g < got + COUNT; g++) {
        double distance = 0;
        for (int k = 0; k < 3; k++)
            distance += ((double)g->position[k] - to->position[k]) * ((double)g->position[k] - to->position[k]);
        best = distance < least ? g : best;
        least = distance < least ? distance : least;
    }
    return best;
}

typedef struct tolerance {
    const char *ending, *format;
    /* tolerances; rotation: 1 - cosine of half the angle between two rotations */
    double position, scale, rotation, opacity, dc, sh;
    int antialiased;
    double finer;      /* below sigma 1 / e the scale tolerance is multiplied by this power of sigma */
} tolerance;

static const tolerance formats[] = {
    {".ply", "ply", 0, 0, 1e-6, 0, 0, 0, 1, 0},
    {".glb", "gltf", 0, 1e-6, 1e-6, 1e-6, 0, 0, 0, 0},
    {".spz", "spz", 1e-6, 0.033, 1e-4, 0.002, 0.014, 0.004, 1, 0},
    {".rad", "rad", 0, 0.002, 1e-6, 0.00025, 0.0009, 0.0041, 0, 0},
    {".compressed.ply", "compressed ply", 0.0032, 0.0025, 1e-5, 0.002, 0.006, 0.0159, 1, 0},
    /* A .sog stores positions as ln(1 + |x|). All other values use codebooks learned from 900 values. The SH of
       this test are noise, which no palette can hold. */
    {".sog", "sog", 1e-4, 0.008, 1e-4, 0.002, 0.02, 1.02, 1, 1.25 / 3}
};

static void check_one(const tolerance *t, const fxs_gaussian *a)
{
    const fxs_gaussian *b = nearest(a);
    int same = rotation_match(a, b) >= 1 - t->rotation && fabs(opacity_of(a) - opacity_of(b)) <= t->opacity;
    for (int k = 0; k < 3; k++)
        same &= fabs((double)a->position[k] - b->position[k]) <= t->position &&
                fabs((double)a->scale[k] - b->scale[k]) <= t->scale * exp(-t->finer * (a->scale[k] + 1.0)) &&
                fabs((double)a->dc[k] - b->dc[k]) <= t->dc;
    for (int k = 0; k < 45; k++)
        same &= fabs((double)a->sh[k] - b->sh[k]) <= t->sh;
    if (!CHECK(same))
        printf("  of %s\n", t->ending);
}

static void written_and_read(void)
{
    for (size_t f = 0; f < sizeof formats / sizeof *formats; f++)
        for (int degree = 0; degree <= 3; degree++) {
            const tolerance *t = &formats[f];
            make(degree);
            const fxs_scene_write_options o = options_of(degree, degree == 1);
            const int error = write_all(t->ending, &o, NULL);
            if (error == FXS_ERR_UNSUPPORTED)
                SKIP(message.text);
            CHECK(error == 0 && read_file(got, COUNT) == 0 && !strcmp(info.format, t->format));
            CHECK(info.count == COUNT && info.sh_degree == degree);
            CHECK(info.antialiased == (t->antialiased && degree == 1));
            CHECK(report.lost_sh == 0 && report.lost_antialiased == (!t->antialiased && degree == 1));
            for (int i = 0; i < COUNT; i++)
                check_one(t, &wanted[i]);
        }
}

/* Tests the SH of a .sog. 256 palette entries serve 300 Gaussians, so most SH have only the error of the
   codebook. */
static void sh_of_sog(void)
{
    double squares = 0;
    make(3);
    const fxs_scene_write_options o = options_of(3, 0);
    if (write_all(".sog", &o, NULL) == FXS_ERR_UNSUPPORTED)
        SKIP(message.text);
    CHECK(read_file(got, COUNT) == 0);
    for (int i = 0; i < COUNT; i++)
        for (int k = 0; k < 45; k++) {
            const double off = (double)wanted[i].sh[k] - nearest(&wanted[i])->sh[k];
            squares += off * off;
        }
    CHECK(sqrt(squares / (COUNT * 45)) < 0.12);   /* RMS error of the SH; leaving all SH out gives 0.29 */
}

static void what_splat_cannot_hold(void)
{
    make(2);
    const fxs_scene_write_options o = options_of(2, 1);
    CHECK(write_all(".splat", &o, NULL) == 0 && report.lost_sh == 2 && report.lost_antialiased);
    CHECK(read_file(got, COUNT) == 0 && info.count == COUNT && info.sh_degree == 0);
}

static uint32_t u32_at(size_t offset)
{
    return bytes[offset] | (uint32_t)bytes[offset + 1] << 8 | (uint32_t)bytes[offset + 2] << 16 |
           (uint32_t)bytes[offset + 3] << 24;
}

static float float_at(size_t offset)
{
    const uint32_t word = u32_at(offset);
    float value;
    memcpy(&value, &word, sizeof value);
    return value;
}

/* Checks the bytes of a written .glb. A Gaussian has 236 bytes. The y axis points up. Rotations are x, y, z, w. */
static void bytes_of_glb(void)
{
    make(3);
    const fxs_scene_write_options o = options_of(3, 0);
    CHECK(write_all(".glb", &o, NULL) == 0 && !memcmp(bytes, "glTF\2\0\0\0", 8) && u32_at(8) == file_size);
    const size_t json = u32_at(12), row = 28 + json;
    CHECK(json % 4 == 0 && !memcmp(bytes + 16, "JSON{", 5) && !memcmp(bytes + 24 + json, "BIN\0", 4));
    CHECK(u32_at(20 + json) == COUNT * 236 && row + COUNT * 236 == file_size);
    const fxs_gaussian *g = wanted;
    CHECK(float_at(row) == -g->position[0] && float_at(row + 4) == -g->position[1] &&
          float_at(row + 8) == g->position[2]);
    double square = 0;
    for (size_t k = 0; k < 4; k++)
        square += (double)float_at(row + 24 + 4 * k) * float_at(row + 24 + 4 * k);
    CHECK(is_near(square, 1, 1e-6));
    CHECK(is_near((double)float_at(row + 12), exp((double)g->scale[0]), 1e-6));
    CHECK(is_near((double)float_at(row + 40), opacity_of(g), 1e-6) && float_at(row + 44) == g->dc[0]);
    /* The SH of degree 1 belong to y, z, x. The change of axes reverses the sign of two. */
    CHECK(float_at(row + 56) == -g->sh[0] && float_at(row + 68) == g->sh[3] && float_at(row + 80) == -g->sh[6]);
    bytes[row] = 0;
    CHECK(strstr((char *)bytes + 20, "\"byteStride\":236") && strstr((char *)bytes + 20, "SH_DEGREE_3_COEF_6\":19"));
}

/* Checks the bytes of a compressed .ply. A chunk header has 72 bytes. A chunk (256 Gaussians) holds neighbours,
   so its box is smaller than the scene. */
static void bytes_of_compressed_ply(void)
{
    make(0);
    const fxs_scene_write_options o = options_of(0, 1);
    CHECK(write_all(".compressed.ply", &o, NULL) == 0);
    const char *end = strstr((char *)bytes, "end_header\n");
    if (!CHECK(end != NULL))
        return;
    const size_t body = (size_t)(end - (char *)bytes) + 11;
    CHECK(file_size == body + 2 * 72 + COUNT * 16);
    CHECK(strstr((char *)bytes, "comment antialiased 1\nelement chunk 2\n") && !strstr((char *)bytes, "element sh"));
    double volumes = 0, whole = 1;
    for (size_t c = 0; c < 2; c++) {
        double volume = 1;
        for (size_t k = 0; k < 3; k++)
            volume *= (double)float_at(body + 72 * c + 12 + 4 * k) - float_at(body + 72 * c + 4 * k);
        volumes += volume;
    }
    for (int k = 0; k < 3; k++)
        whole *= (double)o.high[k] - o.low[k];
    CHECK(volumes < 1.05 * whole);
}

static void lines_of_csv(void)
{
    make(1);
    const fxs_scene_write_options o = options_of(1, 0);
    CHECK(write_all(".csv", &o, NULL) == 0);
    bytes[file_size < MAX_FILE ? file_size : MAX_FILE - 1] = 0;
    const char *line = (char *)bytes;
    CHECK(!strncmp(line, "x,y,z,f_dc_0,f_dc_1,f_dc_2,f_rest_0,", 35) &&
          strstr(line, ",f_rest_8,opacity,scale_0,scale_1,scale_2,rot_0,rot_1,rot_2,rot_3\n"));
    for (int i = 0; i < COUNT; i++) {
        line = strchr(line, '\n') + 1;
        const char *at = line;
        float values[23];
        for (int k = 0; k < 23; k++) {
            char *after;
            values[k] = strtof(at, &after);
            CHECK(*after == (k < 22 ? ',' : '\n'));
            at = after + 1;
        }
        CHECK(!memcmp(values, wanted[i].position, 12) && !memcmp(values + 3, wanted[i].dc, 12));
        CHECK(values[6] == wanted[i].sh[0] && values[7] == wanted[i].sh[3] && values[9] == wanted[i].sh[1]);
        CHECK(values[15] == wanted[i].opacity && !memcmp(values + 19, wanted[i].rotation, 16));
    }
    CHECK(!*(strchr(line, '\n') + 1));
}

static void another_locale(void)
{
    static const char *const endings[] = {".csv", ".sog", ".glb", ".rad"};
    static uint8_t usual[MAX_FILE];
    char folder[sizeof written + 8], command[256];
    snprintf(folder, sizeof folder, "%s.locale", written);
    snprintf(command, sizeof command, "mkdir %s && localedef -i de_DE -f UTF-8 %s/de_DE.UTF-8 2>%s/log", folder, folder,
             folder);
    const int made = system(command) == 0 && setenv("LOCPATH", folder, 1) == 0;
    const int spoken = made && setlocale(LC_NUMERIC, "de_DE.UTF-8") != NULL;
    make(1);
    const fxs_scene_write_options o = options_of(1, 0);
    for (int i = 0; spoken && i < 4; i++) {
        double half;
        setlocale(LC_NUMERIC, "C");
        CHECK(write_all(endings[i], &o, NULL) == 0);
        const size_t written_size = file_size;
        memcpy(usual, bytes, written_size);
        setlocale(LC_NUMERIC, "de_DE.UTF-8");
        CHECK(write_all(endings[i], &o, NULL) == 0);
        CHECK(file_size == written_size && !memcmp(usual, bytes, written_size));
        CHECK(fxs_read_number("-2.5e-1", &half) && half == -0.25);
        CHECK(!fxs_read_number("0,5", &half) && !fxs_read_number("0x1", &half) && !fxs_read_number("", &half));
    }
    setlocale(LC_NUMERIC, "C");
    unsetenv("LOCPATH");
    snprintf(command, sizeof command, "rm -rf %s", folder);
    CHECK(system(command) == 0);
    if (!spoken)
        SKIP("no localedef, or no locale de_DE");
}

static void extremes(void)
{
    static const char *const endings[] = {".ply", ".compressed.ply", ".sog", ".spz", ".rad", ".glb", ".splat"};
    const fxs_gaussian wild[2] = {
        {.position = {3e38f, -3e38f, 0}, .scale = {20, -INFINITY, 80}, .rotation = {1e-30f, 0, 0, 0}, .opacity = 1e30f,
         .dc = {1e30f, -1e30f, 0}, .sh = {1e30f, -1e30f}},
        {.position = {0, -0.0f, 1e-40f}, .scale = {-80, -20, -20}, .rotation = {-1e10f, 0, 0, 0}, .opacity = -1e30f}
    };
    fxs_scene_write_options o = {.size = sizeof(fxs_scene_write_options), .count = 2, .sh_degree = 1};
    for (size_t e = 0; e < sizeof endings / sizeof *endings; e++) {
        fxs_scene_writer *writer;
        if (fxs_scene_writer_open(named(endings[e]), &o, &writer, &message) == FXS_ERR_UNSUPPORTED)
            continue;
        CHECK(fxs_scene_writer_put(writer, wild, 2, &message) == 0);
        CHECK(fxs_scene_writer_close(writer, &report, NULL, &message) == 0);
        FILE *stream = fopen(name, "rb");
        put_file(stream ? fread(bytes, 1, MAX_FILE, stream) : 0);
        if (stream)
            fclose(stream);
        remove(name);
        if (!CHECK(read_file(got, 2) == 0 && info.count == 2))
            printf("  %s: %s\n", endings[e], message.text);
        for (int i = 0; i < 2; i++)
            CHECK(!isnan(got[i].position[0]) && !isnan(got[i].rotation[0]) && !isnan(got[i].dc[1]));
    }
}

static int stop(void *calls, double done)
{
    CHECK(done >= 0 && done <= 1);
    return ++*(int *)calls == 2;
}

static void faulty(void)
{
    static const char *const endings[] = {".ply", ".compressed.ply", ".sog", ".spz", ".rad", ".glb", ".csv",
                                          ".splat"};
    make(3);
    for (size_t e = 0; e < sizeof endings / sizeof *endings; e++) {
        fxs_scene_writer *writer;
        char nowhere[64];
        fxs_scene_write_options o = options_of(3, 0);
        if (write_all(endings[e], &o, NULL) == FXS_ERR_UNSUPPORTED)
            continue;
        CHECK(fxs_scene_writer_open(named(endings[e]), &o, &writer, &message) == 0);
        CHECK(fxs_scene_writer_put(writer, wanted, 1, &message) == 0);
        CHECK(fxs_scene_writer_close(writer, &report, NULL, &message) == FXS_ERR_ARGUMENT);
        CHECK(strstr(message.text, "fewer than announced") && access(name, F_OK));
        o.count = 1;
        CHECK(fxs_scene_writer_open(name, &o, &writer, &message) == 0);
        CHECK(fxs_scene_writer_put(writer, wanted, 2, &message) == FXS_ERR_ARGUMENT);
        CHECK(fxs_scene_writer_close(writer, &report, NULL, &message) != 0 && access(name, F_OK));
        snprintf(nowhere, sizeof nowhere, "no/such/folder/a%s", endings[e]);
        CHECK(fxs_scene_writer_open(nowhere, &o, &writer, &message) == FXS_ERR_FILE && !writer);
        o.sh_degree = 4;
        CHECK(fxs_scene_writer_open(name, &o, &writer, &message) == FXS_ERR_ARGUMENT && !writer);
    }
    const fxs_scene_write_options o = options_of(0, 0);
    fxs_scene_writer *writer;
    CHECK(fxs_scene_writer_open("a.gltf", &o, &writer, &message) == FXS_ERR_ARGUMENT && !writer);
    CHECK(!fxs_scene_format_of(".ply", 1) && !fxs_scene_format_of("x.plyx", 1) && fxs_scene_format_of("x.ply", 1));
    CHECK(fxs_scene_writer_close(NULL, &report, NULL, &message) == 0);
}

static void too_many(void)
{
    fxs_scene_writer *writer;
    fxs_scene_write_options o = {.size = sizeof(fxs_scene_write_options), .count = UINT64_MAX, .sh_degree = 3};
    CHECK(fxs_scene_writer_open(named(".glb"), &o, &writer, &message) == FXS_ERR_ARGUMENT);
    CHECK(fxs_scene_writer_open(named(".compressed.ply"), &o, &writer, &message) == FXS_ERR_ARGUMENT);
    const int error = fxs_scene_writer_open(named(".sog"), &o, &writer, &message);
    CHECK(error == FXS_ERR_ARGUMENT || error == FXS_ERR_UNSUPPORTED);
}

static void stopped(void)
{
    static const char *const endings[] = {".compressed.ply", ".sog", ".rad"};
    make(3);
    for (size_t e = 0; e < 3; e++) {
        int calls = 0;
        const fxs_scene_write_options o = options_of(3, 0);
        const int error = write_all(endings[e], &o, &(fxs_progress){stop, &calls});
        CHECK(error == FXS_ERR_UNSUPPORTED || (error == FXS_ERR_STOPPED && calls == 2 && access(name, F_OK)));
    }
}

static void books(void)
{
    float values[5000], book[FXS_BOOK];
    state = 5;
    for (int i = 0; i < 5000; i++)
        values[i] = (float)((i % 200) * (i % 200));
    CHECK(fxs_book_learn(book, values, 5000, 0) == 0);
    for (int i = 0; i < 200; i++)
        /* 200 distinct values fit the codebook, so each is exact */
        CHECK(book[fxs_book_find(book, values[i])] == values[i]);
    double squares = 0;
    for (int i = 0; i < 5000; i++)
        values[i] = (float)(random_between(-1, 1) * random_between(0, 1) * random_between(0, 1));
    CHECK(fxs_book_learn(book, values, 5000, 0) == 0);
    for (int i = 0; i < FXS_BOOK - 1; i++)
        CHECK(book[i] <= book[i + 1]);
    for (int i = 0; i < 5000; i++) {
        const float found = book[fxs_book_find(book, values[i])];
        float best = INFINITY;
        for (int k = 0; k < FXS_BOOK; k++)
            best = fabsf(book[k] - values[i]) < best ? fabsf(book[k] - values[i]) : best;
        CHECK(fabsf(found - values[i]) <= best + 1e-7f);
        squares += ((double)found - values[i]) * ((double)found - values[i]);
    }
    /* RMS error below 0.9 of the error of 256 evenly spaced values */
    CHECK(sqrt(squares / 5000) < 0.9 * 2 / FXS_BOOK / sqrt(12));
    for (int i = 0; i < 5000; i++)     /* random scales; ten of these are large */
        values[i] = (float)(i % 500 ? random_between(-8, -4) : 0.3 * i / 500);
    CHECK(fxs_book_learn(book, values, 5000, 1.25) == 0);
    for (int i = 0; i < 5000; i++)
        CHECK(fabsf(book[fxs_book_find(book, values[i])] - values[i]) < (i % 500 ? 0.2f : 0.01f));
    values[0] = 3;
    CHECK(fxs_book_learn(book, values, 1, 0) == 0 && book[fxs_book_find(book, 3)] == 3);
}

static void book_of_flat(float flat, int of, double spread)
{
    float values[6000], book[FXS_BOOK];
    state = 7;
    for (int i = 0; i < 6000; i++)
        values[i] = (float)(i % of ? random_between(-4.5 - spread, -4.5 + spread) : flat + random_between(-0.2, 0.2));
    CHECK(fxs_book_learn(book, values, 6000, 1.25) == 0);
    for (int i = 0; i < FXS_BOOK - 1; i++)
        CHECK(book[i] <= book[i + 1]);
    for (int i = 0; i < 6000; i++)
        if (!CHECK(fabsf(book[fxs_book_find(book, values[i])] - values[i]) < (i % of ? 0.2f : 0.4f)))
            printf("  %g is %g, one of %d flat\n", (double)values[i], (double)book[fxs_book_find(book, values[i])], of);
}

static void books_of_flat(void)
{
    static const int of[] = {6000, 100, 3, 2};
    static const float flat[] = {-20, -14, -9, 2};
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++) {
            book_of_flat(flat[k], of[i], 2);
            book_of_flat(flat[k], of[i], 0);
        }
}

static void flat_in_sog(void)
{
    for (int of = 1; of <= 100; of += 99) {
        make(0);
        for (int i = 0; i < COUNT; i += of)
            wanted[i].scale[2] = i % 2 ? -20 : -14;
        const fxs_scene_write_options o = options_of(0, 0);
        if (write_all(".sog", &o, NULL) == FXS_ERR_UNSUPPORTED)
            SKIP(message.text);
        CHECK(read_file(got, COUNT) == 0);
        for (int i = 0; i < COUNT; i += of)
            CHECK(fabsf(nearest(&wanted[i])->scale[2] - wanted[i].scale[2]) < 0.4f);
    }
}

static int stop_at_once(void *argument, double done)
{
    (void)argument;
    return done > 0;
}

static void palettes(void)
{
    enum { VECTORS = 4096, CENTRES = 64, ENTRIES = 1024 };
    static fxs_sh_palette_vector vectors[VECTORS], palette[ENTRIES], centres[CENTRES];
    static uint32_t labels[VECTORS];
    double squares = 0;
    state = 9;
    CHECK(fxs_sh_palette_entries(1) == 1 && fxs_sh_palette_entries(4095) == 2048 &&
          fxs_sh_palette_entries(UINT32_MAX) == 65536);
    for (int i = 0; i < CENTRES; i++)
        for (int d = 0; d < 45; d++)
            centres[i][d] = (int16_t)random_between(-4000, 4000);
    for (int i = 0; i < VECTORS; i++)
        for (int d = 0; d < 45; d++)
            vectors[i][d] = (int16_t)(centres[i % CENTRES][d] + random_between(-20, 20));
    CHECK(fxs_sh_palette_learn(palette, ENTRIES, labels, (const fxs_sh_palette_vector *)vectors, VECTORS, NULL) ==
          0);
    for (int i = 0; i < VECTORS && CHECK(labels[i] < ENTRIES); i++)
        for (int d = 0; d < 45; d++)
            squares += (vectors[i][d] - palette[labels[i]][d]) * (vectors[i][d] - palette[labels[i]][d]);
    CHECK(sqrt(squares / (VECTORS * 45)) < 12);
    CHECK(fxs_sh_palette_learn(palette, ENTRIES, labels, (const fxs_sh_palette_vector *)vectors, VECTORS,
                               &(fxs_progress){stop_at_once, NULL}) == -1);
}

int main(void)
{
    make_written();
    RUN(written_and_read);
    RUN(sh_of_sog);
    RUN(what_splat_cannot_hold);
    RUN(bytes_of_glb);
    RUN(bytes_of_compressed_ply);
    RUN(lines_of_csv);
    RUN(another_locale);
    RUN(extremes);
    RUN(faulty);
    RUN(too_many);
    RUN(stopped);
    RUN(books);
    RUN(books_of_flat);
    RUN(flat_in_sog);
    RUN(palettes);
    remove(written);
    return check_report();
}
