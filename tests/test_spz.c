/* Reads .spz files that the test makes in every version, faulty files, and a real scene. */
#include "scene_writer.h"
#include "scene_bytes.h"
#include "spz_bytes.h"

enum { COUNT = 7 };
enum { PLAIN, GZIP, ZSTD, CONTAINERS };

static spz_bytes s;
static fxs_gaussian out[COUNT + 1];

static void fill(int version, int degree)
{
    uint32_t state = (uint32_t)(version * 8 + degree + 1);
    memset(&s, 0, sizeof s);
    s.version = version;
    s.count = COUNT;
    s.degree = degree;
    s.fractional_bits = 12;
    for (int i = 0; i < SPZ_ARRAYS; i++)
        for (size_t k = 0; k < spz_array_size(&s, i); k++) {
            state = state * 1664525 + 1013904223;
            s.arrays[i][k] = (uint8_t)(state >> 24);
        }
    if (version == 1)
        for (int k = 1; k < 6 * COUNT; k += 2)
            s.arrays[0][k] &= 0xbf;   /* clears a bit of each half float, so that positions are below 2 */
    s.arrays[1][0] = 0;
    s.arrays[1][1] = 255;
}

/* Makes the .spz in memory. Returns 0 in builds without the library that compresses it. */
static int make(int container)
{
    static uint8_t plain[MAX_FILE];
    (void)plain;
    size = 0;
    if (container == PLAIN)
        size = spz_plain(&s, bytes);
#ifdef FXS_WITH_ZLIB
    if (container == GZIP)
        size = spz_gzip(plain, spz_plain(&s, plain), bytes, MAX_FILE);
#endif
#ifdef FXS_WITH_ZSTD
    if (container == ZSTD)
        size = spz_zstd(&s, bytes, MAX_FILE);
#endif
    return size > 0;
}

static int reads(uint64_t count)
{
    put_file(size);
    if (!CHECK(read_file(out, COUNT + 1) == 0)) {
        printf("  %s\n", message.text);
        return 0;
    }
    return CHECK(info.count == count && strcmp(info.format, "spz") == 0);
}

static double expected_position(int i, int axis)
{
    if (s.version == 1) {
        int half = s.arrays[0][6 * i + 2 * axis] | s.arrays[0][6 * i + 2 * axis + 1] << 8, e = half >> 10 & 31;
        return (half >> 15 ? -1 : 1) * (e ? ldexp(1 + (half & 1023) / 1024.0, e - 15) : ldexp(half & 1023, -24));
    }
    const uint8_t *at = s.arrays[0] + 9 * i + 3 * axis;
    double value = at[0] + 256.0 * at[1] + 65536.0 * at[2];
    return (value >= 8388608 ? value - 16777216 : value) / pow(2, s.fractional_bits);
}

static void expected_rotation(int i, double q[4])
{
    double rest = 1;
    int largest = 3;
    const uint8_t *at = s.arrays[4] + (s.version < 3 ? 3 : 4) * i;
    if (s.version < 3) {
        for (int k = 0; k < 3; k++)
            q[k] = at[k] / 127.5 - 1;
    } else {
        uint32_t word = at[0] + 256u * at[1] + 65536u * at[2] + 16777216u * at[3];
        largest = (int)(word >> 30);
        for (int k = 3, shift = 0; k >= 0; k--)
            if (k != largest) {
                q[k] = (word >> shift & 511) / 511.0 * sqrt(0.5) * (word >> shift >> 9 & 1 ? -1 : 1);
                shift += 10;
            }
    }
    for (int k = 0; k < 4; k++)
        rest -= k == largest ? 0 : q[k] * q[k];
    q[largest] = sqrt(fmax(rest, 0));
}

/* Checks Gaussians with axes that may point the other way. sign: expected signs of x, y, z. */
static void check_gaussians(const double sign[3])
{
    const fxs_gaussian *g = out;
    for (int i = 0; i < COUNT; i++, g++) {
        double q[4], alpha = s.arrays[1][i] / 255.0, x = sign[0], y = sign[1], z = sign[2];
        double sh_sign[15] = {y, z, x, x * y, y * z, 1, x * z, 1, y, x * y * z, y, z, x, z, x};
        expected_rotation(i, q);
        CHECK(is_near(g->rotation[0], q[3], 2e-6) && fabs(1 / (1 + exp(-(double)g->opacity)) - alpha) < 1e-6);
        for (int k = 0; k < 3; k++) {
            CHECK(is_near((double)g->position[k], sign[k] * expected_position(i, k), 2e-6));
            CHECK(is_near((double)g->rotation[k + 1], sign[(k + 1) % 3] * sign[(k + 2) % 3] * q[k], 2e-6));
            CHECK(is_near((double)g->scale[k], s.arrays[3][3 * i + k] / 16.0 - 10, 2e-6));
            CHECK(is_near((double)g->dc[k], (s.arrays[2][3 * i + k] / 255.0 - 0.5) / 0.15, 2e-6));
        }
        for (int k = 0; k < 45; k++) {
            int stride = 3 * s.degree * (s.degree + 2);
            double value = k < stride ? (s.arrays[5][stride * i + k] - 128) / 128.0 : 0;
            CHECK(is_near((double)g->sh[k], sh_sign[k / 3] * value, 2e-6));
        }
    }
}

static const double to_rdf[3] = {1, -1, -1};

static void every_version_and_degree(void)
{
    for (int version = 1; version <= 4; version++)
        for (int degree = 0; degree <= 4; degree++)
            for (int container = PLAIN; container < CONTAINERS; container++) {
                fill(version, degree);
                if ((version == 4) != (container == ZSTD) || !make(container))
                    continue;
                if (!reads(COUNT))
                    continue;
                CHECK(info.sh_degree == (degree < 3 ? degree : 3) && info.stored_sh_degree == degree);
                CHECK(!info.antialiased);
                check_gaussians(to_rdf);
            }
}

static void halves(void)
{
    static const struct { uint16_t bits; float value; } cases[] = {
        {0x0000, 0}, {0x3c00, 1}, {0xc000, -2}, {0x7bff, 65504}, {0x0001, 5.9604645e-8f}, {0x83ff, -6.0975552e-5f},
        {0x0400, 6.1035156e-5f}
    };
    fill(1, 0);
    for (int i = 0; i < COUNT; i++)
        spz_put(s.arrays[0] + 6 * i, cases[i].bits, 2);
    spz_put(s.arrays[0] + 2, 0x7c00, 2);
    spz_put(s.arrays[0] + 8, 0x7e00, 2);
    if (!make(PLAIN) || !reads(COUNT))
        return;
    for (int i = 0; i < COUNT; i++)
        CHECK(out[i].position[0] == cases[i].value);
    CHECK(isinf(out[0].position[1]) && isnan(out[1].position[1]));
}

static void fractional_bits(void)
{
    for (int bits = 0; bits <= 24; bits += 6) {
        fill(2, 0);
        s.fractional_bits = bits;
        if (make(PLAIN) && reads(COUNT))
            check_gaussians(to_rdf);
    }
}

static void antialiased(void)
{
    fill(3, 1);
    s.flags = 1;
    CHECK(make(PLAIN) && reads(COUNT) && info.antialiased);
}

static void coordinate_systems(void)
{
    uint8_t records[64];
    for (int container = PLAIN; container < CONTAINERS; container++)
        for (uint32_t system = 0; system <= 9; system++) {
            fill(container == ZSTD ? 4 : 3, 3);
            s.flags = 2;
            s.extensions = records;
            uint8_t *to = spz_put(spz_put(spz_put(records, 0xadbe0002, 4), 12, 4), 0, 12);
            s.extensions_size = (size_t)(spz_put(spz_put(spz_put(to, 0xadbe0003, 4), 4, 4), system, 4) - records);
            if (!make(container))
                continue;
            if (system > 8) {
                check_fails("coordinate system 9, not 0 to 8");
                continue;
            }
            uint32_t bits = (system ? system : 4) - 1;
            const double sign[3] = {bits & 1 ? 1 : -1, bits & 2 ? -1 : 1, bits & 4 ? 1 : -1};
            if (reads(COUNT))
                check_gaussians(sign);
        }
}

static void faulty_extensions(void)
{
    static uint8_t records[1 << 17];
    for (int container = PLAIN; container < CONTAINERS; container++) {
        fill(container == ZSTD ? 4 : 3, 0);
        s.flags = 2;
        s.extensions = records;
        spz_put(spz_put(records, 0xadbe0003, 4), 5, 4);
        for (s.extensions_size = 1; s.extensions_size < 13; s.extensions_size++)
            if (make(container))
                check_fails("an extension ends early");
        if (make(container))
            check_fails("the extension with the coordinate system has not 4 bytes");
        spz_put(records + 4, 0xffffffff, 4);
        if (make(container))
            check_fails("an extension ends early");
    }
    s.version = 3;
    for (s.extensions_size = 65536; s.extensions_size <= 65537; s.extensions_size++) {
        spz_put(spz_put(records, 1, 4), s.extensions_size - 8, 4);
        if (!make(GZIP))
            continue;
        if (s.extensions_size == 65536)
            reads(COUNT);
        else
            check_fails("the gzip stream has more bytes than the header asks for");
    }
}

static void one_byte_more(void)
{
    fill(3, 1);
    CHECK(make(PLAIN));
    bytes[size++] = 0;
    check_fails("the header asks for 203 bytes of attributes, there are 204");
    fill(4, 1);
    if (make(ZSTD)) {
        bytes[size++] = 0;
        check_fails("there are bytes behind the last stream");
    }
}

static void faulty_headers(void)
{
    static const struct { int offset; uint32_t value; int size; const char *text; } cases[] = {
        {3, 'Q', 1, "not a scene file of a known format"}, {4, 0, 4, ".spz version 0, not 1 to 4"},
        {4, 5, 4, ".spz version 5, not 1 to 4"}, {8, COUNT + 1, 4, "bytes of attributes, there are"},
        {8, COUNT - 1, 4, "bytes of attributes, there are"},
        {8, 0x40000001, 4, "the header tells of 1073741825 Gaussians, more than 156 bytes hold"},
        {8, 0xffffffff, 4, "the header tells of 4294967295 Gaussians"}, {8, 18000, 4, "the header tells of 18000"},
        {12, 5, 1, "SH degree 5, not 0 to 4"}, {12, 1, 1, "bytes of attributes, there are"},
        {13, 25, 1, "25 fractional bits, not 0 to 24"}, {14, 0x80, 1, "levels of detail"}
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        fill(3, 0);
        CHECK(make(PLAIN));
        spz_put(bytes + cases[i].offset, cases[i].value, cases[i].size);
        check_fails(cases[i].text);
    }
}

static void empty_scene(void)
{
    for (int container = PLAIN; container < CONTAINERS; container++) {
        fill(container == ZSTD ? 4 : 3, 2);
        s.count = 0;
        if (make(container))
            reads(0);
    }
}

static void gzip_bombs(void)
{
#ifdef FXS_WITH_ZLIB
    const size_t zeros = (size_t)64 << 20;
    uint8_t *bomb = calloc(1, zeros);
    if (!CHECK(bomb != NULL))
        return;
    fill(3, 0);
    spz_plain(&s, bomb);
    size = spz_gzip(bomb, zeros, bytes, MAX_FILE);
    check_fails("the gzip stream has more bytes than the header asks for");
    spz_put(bomb + 8, (uint64_t)(size * 1024 / 9), 4);
    bomb[12] = 4;
    size = spz_gzip(bomb, zeros, bytes, MAX_FILE);
    check_fails("more than");
    spz_put(bomb + 8, 1 << 30, 4);
    size = spz_gzip(bomb, zeros, bytes, MAX_FILE);
    check_fails("the header tells of 1073741824 Gaussians");
    spz_put(bomb + 4, 4, 4);
    spz_put(bomb + 8, COUNT, 4);
    size = spz_gzip(bomb, 200, bytes, MAX_FILE);
    check_fails("version 4 within gzip");
    memset(bomb, 0, 200);
    size = spz_gzip(bomb, 200, bytes, MAX_FILE);
    check_fails("compressed by gzip, but no .spz: unpack it first");
    free(bomb);
#else
    SKIP("built without zlib");
#endif
}

static void damaged_gzip(void)
{
    fill(3, 3);
    if (!make(GZIP))
        SKIP("built without zlib");
    for (size_t i = size - 8; i < size; i++) {   /* damages each byte of the gzip stream's checksum and length */
        bytes[i] ^= 1;
        check_fails("the gzip stream is damaged");
        bytes[i] ^= 1;
    }
}

static void libraries(void)
{
    fill(4, 0);
    spz_put_header(&s, bytes);
    size = 200;
#ifndef FXS_WITH_ZSTD
    check_fails("cannot read .spz version 4: built without zstd");
#endif
#ifndef FXS_WITH_ZLIB
    spz_put(bytes, 0x8b1f, 2);
    check_fails("cannot read gzip: built without zlib");
#endif
    CHECK(size == 200);
}

static void faulty_streams(void)
{
    static const struct { int offset; uint64_t value; int size; const char *text; } cases[] = {
        {15, 5, 1, "5 streams, not 6"}, {15, 7, 1, "7 streams, not 6"},
        {16, 31, 4, "the table of contents is not within the file"},
        {16, 0xffffffff, 4, "the table of contents is not within the file"},
        {32, 1000000, 8, "the file ends early"}, {32, UINT64_MAX, 8, "the file ends early"},
        {40, 9 * COUNT + 1, 8, "the header asks for 63 bytes in a stream of 64"},
        {40, UINT64_MAX, 8, "the header asks for 63 bytes in a stream of"},
        {8, COUNT + 1, 4, "the header asks for 72 bytes in a stream of 63"},
        {128, 0, 4, "a zstd stream is damaged"}, {32, 3, 8, "there are bytes behind the last stream"}
    };
    fill(4, 1);
    if (!make(ZSTD))
        SKIP("built without zstd");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        make(ZSTD);
        spz_put(bytes + cases[i].offset, cases[i].value, cases[i].size);
        check_fails(cases[i].text);
    }
}

static void zstd_bombs(void)
{
#ifdef FXS_WITH_ZSTD
    uint8_t *zeros = calloc(1, MAX_FILE);
    if (!CHECK(zeros != NULL))
        return;
    for (size_t length = 10; length <= MAX_FILE; length *= 4) {
        fill(4, 0);
        make(ZSTD);
        uint8_t *last = bytes + 32 + 4 * 16;   /* entry of the array of rotations in the table of compressed sizes */
        size -= *last;
        size_t compressed = ZSTD_compress(bytes + size, MAX_FILE - size, zeros, length, 9);
        spz_put(last, compressed, 8);
        size += compressed;
        check_fails("a zstd stream is damaged, or of another size than the header asks for");
    }
    free(zeros);
#else
    SKIP("built without zstd");
#endif
}

static void real_scene(void)
{
    char name[1024];
    snprintf(name, sizeof name, "%s/kitchen-marble/kitchen-marble.spz", scenes_folder());
    if (access(name, R_OK) != 0)
        SKIP("no folder of scenes; set FXS_SCENES");
#ifndef FXS_WITH_ZLIB
    SKIP("built without zlib");
#endif
    check_same_scenes("kitchen-marble/kitchen-marble.spz", "kitchen-marble/kitchen-marble.ply", 2e-6);
}

static fxs_gaussian wanted[COUNT];

static void fill_gaussians(int degree)
{
    uint32_t state = (uint32_t)degree;
    float *values = (float *)wanted;
    memset(wanted, 0, sizeof wanted);
    for (int i = 0; i < COUNT; i++, values += sizeof *wanted / sizeof *values)
        for (int k = 0; k < 14 + 3 * degree * (degree + 2); k++) {
            state = state * 1664525 + 1013904223;
            values[k] = (float)(state >> 8) / 8388608 - 1;
        }
}

static fxs_spz_clamped clamped;
static int is_fine = 1;

static int write_file(int version, int degree)
{
    const fxs_scene_write_options options = {.size = sizeof(fxs_scene_write_options), .count = COUNT,
                                             .sh_degree = degree, .antialiased = degree == 1,
                                             .spz_version = version, .format = "spz", .spz_fine = is_fine};
    fxs_scene_writer *writer;
    int result = fxs_scene_writer_open(written, &options, &writer, &message);
    if (result)
        return result;
    CHECK(fxs_scene_writer_put(writer, wanted, 3, &message) == 0);
    CHECK(fxs_scene_writer_put(writer, wanted + 3, COUNT - 3, &message) == 0);
    fxs_scene_write_report report;
    result = fxs_scene_writer_close(writer, &report, NULL, &message);
    clamped = report.clamped;
    take_written();
    return result;
}

static int nothing_clamped(void)
{
    return clamped.position == 0 && clamped.scale == 0 && clamped.dc == 0 && clamped.sh == 0;
}

/* Writes an .spz and reads it back. By default SH of degree 1 have 5 bits and higher degrees have 4. */
static void written_and_read(void)
{
    const double place = is_fine ? 0x1p-22 : 0x1p-14, first = is_fine ? 1 : 8, higher = is_fine ? 1 : 16;
    for (int version = 3; version <= 4; version++)
        for (int degree = 0; degree <= 3; degree++) {
            fill_gaussians(degree);
            if (write_file(version, degree) != 0) {
                CHECK(strstr(message.text, "built without"));
                continue;
            }
            if (!CHECK(read_file(out, COUNT + 1) == 0)) {
                printf("  %s\n", message.text);
                continue;
            }
            CHECK(nothing_clamped());
            CHECK(info.count == COUNT && info.sh_degree == degree && info.antialiased == (degree == 1));
            for (int i = 0; i < COUNT; i++) {
                const fxs_gaussian *a = &wanted[i], *b = &out[i];
                CHECK(rotation_match(a, b) > 1 - 4e-6 && fabs(opacity_of(a) - opacity_of(b)) < 0.501 / 255);
                for (int k = 0; k < 3; k++) {
                    CHECK(fabs((double)a->position[k] - b->position[k]) < 0.501 * place);
                    CHECK(fabs((double)a->scale[k] - b->scale[k]) < 0.501 / 16);
                    CHECK(fabs((double)a->dc[k] - b->dc[k]) < 0.501 / 255 / 0.15);
                }
                for (int k = 0; k < 45; k++) {
                    const double step = (k < 9 ? first : higher) / 128, sh = (double)b->sh[k];
                    CHECK(fabs((double)a->sh[k] - sh) < (fabsf(a->sh[k]) > 0.99f ? 1.01 : 0.501) * step);
                    CHECK(fabs(sh - step * floor(sh / step + 0.5)) < 1e-6 || fabs(sh) > 0.99);
                }
            }
        }
}

static void usual_precision(void)
{
    is_fine = 0;
    written_and_read();
    is_fine = 1;
}

static void read_and_written(void)
{
    for (int version = 3; version <= 4; version++) {
        fill(version, 3);
        if (!make(version == 3 ? PLAIN : ZSTD) || !reads(COUNT))
            continue;
        memcpy(wanted, out, sizeof wanted);
        if (write_file(version, 3) == 0 && CHECK(nothing_clamped()) && CHECK(read_file(out, COUNT + 1) == 0))
            for (int i = 0; i < COUNT; i++)
                CHECK(is_same(&wanted[i], &out[i], 2e-3));
    }
}

/* Checks the number of fractional bits of positions. The writer chooses the most, up to 24, with which the
   largest coordinate fits. */
static void chosen_bits(void)
{
    static const struct { float largest, second; int bits; uint32_t beyond; } cases[] = {
        {0, 0, 24, 0}, {0.4f, 0.4f, 24, 0}, {0.6f, 0, 23, 0}, {-7.9f, 1, 20, 0}, {8, 1, 19, 0}, {-8, 8, 19, 0},
        {2047, 3, 12, 0}, {2049, 3, 12, 1}, {20000, 3, 12, 1}, {-1e30f, 3, 12, 1}, {1e30f, -1e30f, 0, 2},
        {20000, -15000, 9, 1}, {20000, 20000, 8, 0}, {5e6f, 5e6f, 0, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        fill_gaussians(0);
        for (int k = 0; k < COUNT; k++)
            for (int axis = 0; axis < 3; axis++)
                wanted[k].position[axis] = 0;
        wanted[2].position[2] = cases[i].largest;
        wanted[4].position[0] = cases[i].second;
        if (write_file(4, 0) != 0)
            SKIP(message.text);
        CHECK(bytes[13] == cases[i].bits && clamped.position == cases[i].beyond);
        CHECK(fabs(clamped.reach - ldexp(8388607, -cases[i].bits)) < 1e-9 && read_file(out, COUNT + 1) == 0);
        if (clamped.position == 0)
            CHECK(fabs((double)out[2].position[2] - cases[i].largest) <= ldexp(0.5, -cases[i].bits));
    }
}

static void far_ones_are_brought_in(void)
{
    fill_gaussians(0);
    for (int k = 0; k < 3; k++) {
        wanted[3].position[k] = (float)(20480 >> k);
        wanted[3].scale[k] = 7.5f - (float)k;
    }
    if (write_file(4, 0) != 0 || !CHECK(read_file(out, COUNT + 1) == 0))
        SKIP(message.text);
    CHECK(clamped.position == 1 && clamped.scale == 0);
    for (int k = 0; k < 3; k++) {
        CHECK(fabs((double)out[3].position[k] - (2048 >> k)) < 0.001);
        CHECK(fabs((double)out[3].scale[k] - (7.5 - k - log(10))) < 0.501 / 16);
        CHECK(fabs((double)out[1].position[k] - wanted[1].position[k]) < 0.501 / 4096);
    }
}

/* Writes values that an .spz cannot hold, which are clamped. y and z change sign in the file. A clamped Gaussian
   is counted once. */
static void written_extremes(void)
{
    const float far[COUNT] = {1e30f, -1e30f, 3, 1.5f, -0.999f, -3.4f, 0};
    fill_gaussians(1);
    for (int i = 0; i < COUNT; i++) {
        wanted[i].scale[0] = wanted[i].scale[2] = wanted[i].dc[0] = wanted[i].dc[1] = wanted[i].sh[4] = far[i];
        wanted[i].opacity = far[i];
        wanted[i].rotation[i % 4] = far[i];
    }
    memset(wanted[6].rotation, 0, sizeof wanted[6].rotation);
    if (write_file(3, 1) != 0 || !CHECK(read_file(out, COUNT + 1) == 0))
        SKIP(message.text);
    CHECK(clamped.position == 0 && clamped.scale == 1 && clamped.dc == 3 && clamped.sh == 5);
    CHECK(out[0].scale[0] == 5.9375f && out[1].scale[0] <= -10 && out[0].sh[4] == 1 && out[1].sh[4] == -127 / 128.0f);
    CHECK(out[6].rotation[0] == 1);
}

/* Writes flat Gaussians. A thin axis that is clamped counts only if the Gaussian's largest axis is below e^9
   times the written size. */
static void written_discs(void)
{
    static const float largest[COUNT] = {4, 0, -0.9f, -1.2f, -9, -11, 5};
    fill_gaussians(0);
    for (int i = 0; i < COUNT; i++) {
        wanted[i].scale[0] = wanted[i].scale[1] = largest[i];
        wanted[i].scale[2] = i % 2 ? -INFINITY : -20.7f;
    }
    if (write_file(3, 0) != 0 || !CHECK(read_file(out, COUNT + 1) == 0))
        SKIP(message.text);
    CHECK(clamped.scale == 3);
    for (int i = 0; i < COUNT; i++)
        CHECK(out[i].scale[2] <= -10);
}

static void asked_axes(void)
{
    uint8_t record[16];
    for (uint32_t system = 3; system <= 6; system += 3)
        for (int axes = FXS_AXES_OF_FILE; axes <= FXS_AXES_RDF; axes++) {
            /* expected signs of x, y, z if the .spz states the axes RDF or LUB */
            const double as_stored[3] = {1, 1, 1}, other[3] = {-1, -1, -1};
            fill(3, 3);
            s.flags = 2;
            s.extensions = record;
            s.extensions_size = (size_t)(spz_put(spz_put(spz_put(record, 0xadbe0003, 4), 4, 4), system, 4) - record);
            open_options.axes = (enum fxs_axes)axes;
            if (make(PLAIN) && reads(COUNT))
                check_gaussians(axes == FXS_AXES_RUB                   ? to_rdf
                                : axes == FXS_AXES_RDF || system == 6 ? as_stored
                                                                      : other);
        }
    fill(3, 3);
    if (make(PLAIN) && reads(COUNT))
        check_gaussians((const double[]){1, 1, 1});
    open_options.axes = FXS_AXES_OF_FILE;
}

static void faulty_writes(void)
{
    fxs_scene_writer *writer;
    CHECK(open_spz(written, 2, 1, 0, 0, &writer, &message) == FXS_ERR_ARGUMENT &&
          strstr(message.text, "version 2"));
    CHECK(open_spz(written, 5, 1, 0, 0, &writer, &message) == FXS_ERR_ARGUMENT &&
          strstr(message.text, "version 5"));
    CHECK(close_writer(NULL, &message) == 0);
    if (open_spz(written, 3, 1, 0, 0, &writer, &message) != 0)
        SKIP(message.text);
    CHECK(close_writer(writer, &message) == FXS_ERR_ARGUMENT);
    CHECK(strstr(message.text, "1 Gaussians fewer than announced"));
    CHECK(open_spz(written, 3, 1, 0, 0, &writer, &message) == 0);
    CHECK(fxs_scene_writer_put(writer, wanted, 2, &message) == FXS_ERR_ARGUMENT);
    CHECK(strstr(message.text, "more Gaussians than announced"));
    CHECK(close_writer(writer, &message) == FXS_ERR_FILE);
    CHECK(open_spz(written, 3, 1, 4, 0, &writer, &message) == FXS_ERR_ARGUMENT &&
          strstr(message.text, "SH degree 4"));
    CHECK(open_spz(written, 3, UINT64_MAX, 0, 0, &writer, &message) == FXS_ERR_ARGUMENT &&
          strstr(message.text, "more than"));
    CHECK(open_spz("no/such/folder/a.spz", 3, 0, 0, 0, &writer, &message) == FXS_ERR_FILE);
    CHECK(strstr(message.text, "No such file"));
}

typedef struct halt {
    double done, limit;
} halt;

static int note_progress(void *argument, double done)
{
    halt *h = argument;
    int forward = CHECK(done > h->done);
    h->done = done;
    return !forward || done >= h->limit;
}

static void progress(void)
{
    enum { MANY = 100000 };
    static const halt cases[] = {{0, 2}, {0, 0.5}};
    fill_gaussians(3);
    for (int k = 0; k < 4; k++) {
        fxs_scene_writer *writer;
        fxs_scene_file *whole = NULL;
        halt h = cases[k % 2];
        if (open_spz(written, 3 + k / 2, MANY, 3, 0, &writer, &message) != 0)
            SKIP(message.text);
        for (int i = 0; i < MANY; i++)
            fxs_scene_writer_put(writer, &wanted[i % COUNT], 1, &message);
        int result = fxs_scene_writer_close(writer, NULL, &(fxs_progress){note_progress, &h}, &message);
        CHECK(k % 2 ? result == FXS_ERR_STOPPED && h.done >= 0.5 && h.done < 0.9 : result == 0 && h.done == 1);
        if (k % 2)
            CHECK(strncmp(message.text, written, strlen(written)) == 0);
        else
            CHECK(fxs_scene_file_open(written, NULL, &whole, &info, &message) == 0 && info.count == MANY);
        fxs_scene_file_close(whole);
    }
}

int main(void)
{
    int descriptor = mkstemp(written);
    if (descriptor < 0 || close(descriptor) != 0)
        return 1;
    RUN(every_version_and_degree);
    RUN(halves);
    RUN(fractional_bits);
    RUN(antialiased);
    RUN(coordinate_systems);
    RUN(faulty_extensions);
    RUN(one_byte_more);
    RUN(faulty_headers);
    RUN(empty_scene);
    RUN(gzip_bombs);
    RUN(damaged_gzip);
    RUN(libraries);
    RUN(faulty_streams);
    RUN(zstd_bombs);
    RUN(written_and_read);
    RUN(usual_precision);
    RUN(read_and_written);
    RUN(chosen_bits);
    RUN(far_ones_are_brought_in);
    RUN(written_extremes);
    RUN(written_discs);
    RUN(asked_axes);
    RUN(faulty_writes);
    RUN(progress);
    RUN(real_scene);
    unlink(written);
    return check_report();
}
