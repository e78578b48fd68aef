/* Reads synthetic .ksplat files of each compression level and SH degree, and faulty files. */
#include "scene_bytes.h"

enum { HEADER = 4096, SECTION = 1024, SECTIONS = 3, ROWS = 9, ROOM = 10, BLOCK_RANGE = 1000 };

static fxs_gaussian gaussians[ROOM], expected[ROOM];

/* A .ksplat has sections, which group their Gaussians in buckets. Section 0 has buckets of 2, 2 and 1 Gaussians,
   section 2 of 1, 0 and 3. */
static const struct { uint32_t count, room, bucket_size, full, partial, lengths[3]; } sections[SECTIONS] = {
    {5, 6, 2, 2, 1, {1, 0, 0}}, {0, 0, 0, 0, 0, {0, 0, 0}}, {4, 4, 7, 0, 3, {1, 0, 3}}
};

static const int row_buckets[SECTIONS][6] = {{0, 0, 1, 1, 2, 2}, {0}, {0, 2, 2, 2}};

static int code_of(int row, int i)
{
    uint32_t hash = (uint32_t)(row * 64 + i + 1) * 2654435761u;
    return (int)(hash >> 16);
}

static float centre_of(int section, int bucket, int axis)
{
    return (float)(100 * section + 10 * bucket + axis) / 4;
}

static float put_real(int level, int row, int i)
{
    int code = code_of(row, i) % 2048;
    float value = ldexpf(1 + (float)(code % 1024) / 1024, code / 1024);
    if (level == 0)
        put_float(value);
    else
        put_u16(15 * 1024 + code);
    return value;
}

static float put_coefficient(int level, int row, int i)
{
    if (level < 2)
        return put_real(level, row, 16 + i);
    int code = code_of(row, 16 + i) % 256;
    put_u8(code);
    return -2 + 5 * (float)code / 255;
}

/* Returns the place of a .ksplat's SH coefficient in memory. In the file, coefficients are in blocks by degree
   and channel. */
static int place_of(int i)
{
    int degree = i < 9 ? 1 : i < 24 ? 2 : 3, first = degree * degree - 1, width = 2 * degree + 1;
    int channel = (i - 3 * first) / width, k = (i - 3 * first) % width;
    return 3 * (first + k) + channel;
}

static void put_gaussian(int level, int degree, int section, int bucket, int row)
{
    fxs_gaussian *g = &expected[row];
    memset(g, 0, sizeof *g);
    for (int i = 0; i < 3; i++)
        if (level == 0) {
            g->position[i] = put_real(level, row, i);
        } else {
            put_u16(code_of(row, i));
            g->position[i] = (float)(code_of(row, i) - BLOCK_RANGE) * 3 / BLOCK_RANGE + centre_of(section, bucket, i);
        }
    for (int i = 0; i < 3; i++)
        g->scale[i] = logf(put_real(level, row, 3 + i));
    for (int i = 0; i < 4; i++)
        g->rotation[i] = put_real(level, row, 6 + i);
    for (int i = 0; i < 4; i++)
        put_u8(code_of(row, 10 + i) % 256);
    for (int i = 0; i < 3; i++)
        g->dc[i] = (float)((code_of(row, 10 + i) % 256 / 255.0 - 0.5) / 0.28209479177387814);
    g->opacity = (float)log(code_of(row, 13) % 256 / 255.0 / (1 - code_of(row, 13) % 256 / 255.0));
    for (int i = 0; i < 3 * degree * (degree + 2); i++)
        g->sh[place_of(i)] = put_coefficient(level, row, i);
}

static void put_section_header(int level, int degree, int s)
{
    const size_t at = HEADER + SECTION * (size_t)s;
    put_u32_at(at, sections[s].count);
    put_u32_at(at + 4, sections[s].room);
    put_u32_at(at + 40, (uint32_t)degree);
    if (level == 0)
        return;
    put_u32_at(at + 8, sections[s].bucket_size);
    put_u32_at(at + 12, sections[s].full + sections[s].partial);
    put_float_at(at + 16, 6);
    put_u32_at(at + 20, 16);   /* size of a bucket's record: 12 bytes for a centre and 4 bytes of padding */
    put_u32_at(at + 24, BLOCK_RANGE);
    put_u32_at(at + 32, sections[s].full);
    put_u32_at(at + 36, sections[s].partial);
}

static void put_section(int level, int degree, int s, int *row)
{
    put_section_header(level, degree, s);
    for (uint32_t i = 0; level > 0 && i < sections[s].partial; i++)
        put_u32(sections[s].lengths[i]);
    for (uint32_t b = 0; level > 0 && b < sections[s].full + sections[s].partial; b++) {
        for (int i = 0; i < 3; i++)
            put_float(centre_of(s, (int)b, i));
        put_u32(0xffffffff);
    }
    for (uint32_t i = 0; i < sections[s].room; i++) {
        put_gaussian(level, degree, s, row_buckets[s][i], *row);
        *row += i < sections[s].count;
    }
}

static void make_file(int level, int degree)
{
    int row = 0;
    size = HEADER + SECTIONS * SECTION;
    memset(bytes, 0, size);
    bytes[1] = 1;
    put_u32_at(4, SECTIONS);
    put_u32_at(16, ROWS);
    put_u32_at(20, (uint32_t)level);
    put_float_at(36, -2);
    put_float_at(40, 3);
    for (int s = 0; s < SECTIONS; s++)
        put_section(level, degree, s, &row);
}

static void every_level_and_degree(void)
{
    for (int level = 0; level < 3; level++)
        for (int degree = 0; degree < 4; degree++) {
            make_file(level, degree);
            put_file(size);
            if (!CHECK(read_file(gaussians, ROOM) == 0)) {
                printf("  %s\n", message.text);
                continue;
            }
            CHECK(info.count == ROWS && info.sh_degree == degree && !info.antialiased);
            CHECK(strcmp(info.format, "ksplat") == 0);
            for (int row = 0; row < ROWS; row++)
                CHECK(is_same(&gaussians[row], &expected[row], 1e-6));
        }
}

static void sizes(void)
{
    static const size_t row_sizes[3][3] = {{44, 80, 140}, {24, 42, 72}, {24, 33, 48}};
    for (int level = 0; level < 3; level++)
        for (int degree = 0; degree < 3; degree++) {
            make_file(level, degree);
            size_t buckets = level == 0 ? 0 : 6 * 16 + 4 * 4;
            CHECK(size == HEADER + SECTIONS * SECTION + buckets + ROOM * row_sizes[level][degree]);
        }
}

/* Reads a .ksplat with zero fields, which mean defaults. Compression range 0 means 32767. SH bounds of 0 mean
   +-1.5. */
static void defaults(void)
{
    make_file(2, 1);
    put_u32_at(36, 0);
    put_u32_at(40, 0x80000000);
    put_u32_at(HEADER + 24, 0);
    put_file(size);
    CHECK(read_file(gaussians, ROOM) == 0);
    for (int i = 0; i < 3; i++) {
        double position = (code_of(0, i) - 32767) * 3 / 32767.0 + (double)centre_of(0, 0, i);
        CHECK(is_near((double)gaussians[0].position[i], position, 1e-6));
    }
    for (int i = 0; i < 9; i++)
        CHECK(is_near((double)gaussians[0].sh[place_of(i)], code_of(0, 16 + i) % 256 / 85.0 - 1.5, 1e-6));
}

static void bounds_to_one_side(void)
{
    static const float bounds[][2] = {{0.5f, 2.5f}, {-3, -1}};
    for (int k = 0; k < 2; k++) {
        uint32_t words[2];
        memcpy(words, bounds[k], sizeof words);
        make_file(2, 1);
        put_u32_at(36, words[0]);
        put_u32_at(40, words[1]);
        put_file(size);
        CHECK(read_file(gaussians, ROOM) == 0);
        for (int i = 0; i < 9; i++)
            CHECK(is_near((double)gaussians[0].sh[place_of(i)],
                          (double)bounds[k][0] + code_of(0, 16 + i) % 256 / 127.5, 1e-6));
    }
}

static void halves(void)
{
    static const struct { int bits; double value; } cases[] = {
        {0x3c00, 1}, {0x0001, 5.960464477539063e-8}, {0x03ff, 6.097555160522461e-5}, {0x0400, 6.103515625e-5},
        {0x7bff, 65504}, {0xbc00, -1}, {0x7c00, INFINITY}, {0xfc00, -INFINITY}, {0, 0}, {0x8000, 0}
    };
    const size_t rows = HEADER + SECTIONS * SECTION + 4 + 3 * 16;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        make_file(1, 0);
        /* byte offsets in a record of a scale and of a rotation component */
        for (size_t at = 6; at <= 12; at += 6) {
            bytes[rows + at] = (uint8_t)cases[i].bits;
            bytes[rows + at + 1] = (uint8_t)(cases[i].bits >> 8);
        }
        put_file(size);
        CHECK(read_file(gaussians, ROOM) == 0 && (double)gaussians[0].rotation[0] == cases[i].value);
        double scale = (double)gaussians[0].scale[0], value = cases[i].value;
        CHECK(value == 0 ? scale == -20 : scale == (double)(float)log(fabs(value)));
    }
    make_file(1, 0);
    bytes[rows + 12] = 1;
    bytes[rows + 13] = 0x7c;
    put_file(size);
    CHECK(read_file(gaussians, ROOM) == 0 && isnan(gaussians[0].rotation[0]));
}

/* Reads a .ksplat with unused capacity in a section, which the file omits. */
static void room_at_the_end(void)
{
    make_file(1, 0);
    put_u32_at(HEADER + 2 * SECTION + 4, 1000000);
    put_file(size);
    CHECK(read_file(gaussians, ROOM) == 0 && info.count == ROWS);
}

static void faulty_headers(void)
{
    static const struct { size_t offset; uint32_t value; const char *text; } cases[] = {
        {20, 3, "compression level 3, not 0 to 2"},
        {20, 0xffff, "compression level 65535, not 0 to 2"},
        {4, 0xffffffff, "the header asks for at least 4398046514176 bytes"},
        {HEADER + 40, 4, "section 1 of 3: an SH degree above 3"},
        {HEADER + 40, 0xffff, "section 1 of 3: an SH degree above 3"},
        {HEADER, 7, "section 1 of 3: more Gaussians than it has room for"},
        {HEADER, 0xffffffff, "section 1 of 3: the file ends before its last Gaussian"},
        {HEADER + 4, 0xffffffff, "section 2 of 3: the file ends before its last Gaussian"},
        {HEADER + 12, 0xffffffff, "section 1 of 3: the file ends before its last Gaussian"},
        {HEADER + 12, 2, "section 1 of 3: more full and partly filled buckets than buckets"},
        {HEADER + 32, 0xffffffff, "section 1 of 3: more full and partly filled buckets than buckets"},
        {HEADER + 36, 0xffffffff, "section 1 of 3: the file ends before its last Gaussian"},
        {HEADER + 20, 11, "section 1 of 3: bucket centres of less than 12 bytes"},
        {HEADER + 16, 0, "section 1 of 3: no valid block size"},
        {HEADER + 16, 0x7fc00000, "section 1 of 3: no valid block size"},
        {HEADER + 2 * SECTION + 16, 0xc0000000, "section 3 of 3: no valid block size"},
        {HEADER + 8, 0, "Gaussian 2 of 9: not in any bucket"},
        {HEADER + SECTIONS * SECTION, 0, "Gaussian 5 of 9: not in any bucket"}
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        make_file(1, 0);
        put_u32_at(cases[i].offset, cases[i].value);
        check_fails(cases[i].text);
    }
    make_file(1, 0);
    bytes[0] = 1;
    check_fails("not a scene file of a known format");
}

static void no_sections(void)
{
    size = HEADER;
    memset(bytes, 0, size);
    bytes[1] = 1;
    put_file(size);
    CHECK(read_file(gaussians, ROOM) == 0 && info.count == 0);
}

int main(void)
{
    RUN(every_level_and_degree);
    RUN(sizes);
    RUN(defaults);
    RUN(bounds_to_one_side);
    RUN(halves);
    RUN(room_at_the_end);
    RUN(faulty_headers);
    RUN(no_sections);
    return check_report();
}
