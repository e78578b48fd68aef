/* Reads .ply files made by the test in every encoding, faulty files, and real scenes. */
#include <math.h>
#include <string.h>

#include "scene_bytes.h"

enum { ROWS = 3 };

static const char *const encodings[] = {"ascii", "binary_little_endian", "binary_big_endian"};
enum { ASCII, LITTLE, BIG };

/* Returns the expected value of a property in a row: a whole number that fits every type, or an exact fraction. */
static double value_of(const char *name, int row, int is_whole)
{
    unsigned hash = 17u * (unsigned)row + 5;
    for (; *name; name++)
        hash = 31 * hash + (unsigned char)*name;
    return is_whole ? hash % 100 : (hash % 20000 - 10000.0) / 64 + 1.0 / 1024;
}

static uint32_t half_of(double value)
{
    int exponent = 0;
    double fraction = frexp(fabs(value), &exponent);
    uint32_t sign = value < 0 ? 0x8000 : 0;
    return value == 0 ? 0 : sign + ((uint32_t)(exponent + 13) << 10) + (uint32_t)(2048 * fraction);
}

static void put_number(int encoding, const char *type, double value)
{
    static const struct { const char *name; int size; } sizes[] = {
        {"char", 1}, {"int8", 1}, {"uchar", 1}, {"uint8", 1}, {"short", 2}, {"int16", 2}, {"ushort", 2}, {"uint16", 2},
        {"int", 4}, {"int32", 4}, {"uint", 4}, {"uint32", 4},
        {"float", -4}, {"float32", -4}, {"double", -8}, {"float64", -8}, {"half", -2}, {"float16", -2}
    };
    int i = 0;
    if (encoding == ASCII) {
        put("%.17g ", value);
        return;
    }
    while (strcmp(sizes[i].name, type) != 0)
        i++;
    float real = (float)value;
    uint64_t bits;
    uint32_t float_bits;
    memcpy(&float_bits, &real, 4);
    memcpy(&bits, &value, 8);
    if (sizes[i].size == -4)
        bits = float_bits;
    if (sizes[i].size == -2)
        bits = half_of(value);
    if (sizes[i].size > 0)
        bits = (uint64_t)(int64_t)value;
    int count = abs(sizes[i].size);
    for (int k = 0; k < count; k++)
        bytes[size++] = (uint8_t)(bits >> 8 * (encoding == BIG ? count - 1 - k : k));
}

static void put_row(int encoding, const char *const *properties, int count, int row, int is_whole)
{
    char type[3][16], name[32];
    for (int i = 0; i < count; i++) {
        if (sscanf(properties[i], "list %15s %15s %31s", type[0], type[1], name) == 3) {
            int length = (row + i) % 4;
            put_number(encoding, type[0], length);
            for (int k = 0; k < length; k++)
                put_number(encoding, type[1], 7 * k);
        } else if (sscanf(properties[i], "%15s %31s", type[2], name) == 2) {
            int real = strncmp(type[2], "float", 5) == 0 || strncmp(type[2], "double", 6) == 0;
            put_number(encoding, type[2], value_of(name, row, is_whole || !real));
        }
    }
    if (encoding == ASCII)
        put("\n");
}

static void put_element(const char *name, int rows, const char *const *properties, int count)
{
    put("element %s %d\n", name, rows);
    for (int i = 0; i < count; i++)
        put("property %s\n", properties[i]);
}

static const char *const core[] = {
    "float x", "float y", "float z", "float nx", "float f_dc_0", "float f_dc_1", "float f_dc_2", "float opacity",
    "float scale_0", "float scale_1", "float scale_2", "float rot_0", "float rot_1", "float rot_2", "float rot_3"
};
enum { CORE = sizeof core / sizeof *core };

static char rest_text[72][24];
static const char *properties[CORE + 72 + 4];

static int fill_properties(int rest)
{
    memcpy(properties, core, sizeof core);
    for (int i = 0; i < rest; i++) {
        snprintf(rest_text[i], sizeof rest_text[i], "float f_rest_%d", i);
        properties[CORE + i] = rest_text[i];
    }
    return CORE + rest;
}

static void make_file(int encoding, int count, int is_whole)
{
    size = 0;
    put("ply\nformat %s 1.0\n", encodings[encoding]);
    put_element("vertex", ROWS, properties, count);
    put("end_header\n");
    for (int row = 0; row < ROWS; row++)
        put_row(encoding, properties, count, row, is_whole);
}

static void expect_gaussian(fxs_gaussian *g, int row, int rest, int is_whole)
{
    char name[32];
    float *fields = (float *)g;
    static const char *const names[] = {"x", "y", "z", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2",
                                        "rot_3", "opacity", "f_dc_0", "f_dc_1", "f_dc_2"};
    memset(g, 0, sizeof *g);
    for (int i = 0; i < 14; i++)
        fields[i] = (float)value_of(names[i], row, is_whole);
    for (int channel = 0; channel < 3; channel++)
        for (int k = 0; k < rest / 3 && k < 15; k++) {
            snprintf(name, sizeof name, "f_rest_%d", channel * (rest / 3) + k);
            g->sh[3 * k + channel] = (float)value_of(name, row, is_whole);
        }
}

static void check_file(int degree, int rest, int is_whole)
{
    fxs_gaussian gaussians[ROWS + 1], expected;
    put_file(size);
    if (!CHECK(read_file(gaussians, ROWS + 1) == 0)) {
        printf("  %s\n", message.text);
        return;
    }
    CHECK(info.stored_sh_degree == (rest == 72 ? 4 : degree));
    CHECK(info.count == ROWS && info.sh_degree == degree && strcmp(info.format, "ply") == 0);
    for (int row = 0; row < ROWS; row++) {
        expect_gaussian(&expected, row, rest, is_whole);
        CHECK(memcmp(&gaussians[row], &expected, sizeof expected) == 0);
    }
}

static void every_degree_in_every_encoding(void)
{
    static const int rests[] = {0, 9, 24, 45, 72};
    for (int degree = 0; degree <= 4; degree++)
        for (int encoding = ASCII; encoding <= BIG; encoding++) {
            make_file(encoding, fill_properties(rests[degree]), 0);
            check_file(degree < 3 ? degree : 3, rests[degree], 0);
        }
}

static void shuffled_properties(void)
{
    int count = fill_properties(45);
    for (int i = count - 1, seed = 1; i > 0; i--) {
        seed = (seed * 75 + 74) % 65537;
        const char *other = properties[seed % (i + 1)];
        properties[seed % (i + 1)] = properties[i];
        properties[i] = other;
    }
    for (int encoding = ASCII; encoding <= BIG; encoding++) {
        make_file(encoding, count, 0);
        check_file(3, 45, 0);
    }
}

static void every_type(void)
{
    static const char *const types[] = {"char", "int8", "uchar", "uint8", "short", "int16", "ushort", "uint16", "int",
                                        "int32", "uint", "uint32", "float", "float32", "double", "float64", "half",
                                        "float16"};
    static char text[CORE][32];
    for (size_t type = 0; type < sizeof types / sizeof *types; type++)
        for (int encoding = ASCII; encoding <= BIG; encoding++) {
            int count = fill_properties(9);
            if (encoding != ASCII && (!strcmp(types[type], "ushort") || !strcmp(types[type], "uint16")))
                continue;
            for (int i = 0; i < CORE; i++) {
                snprintf(text[i], sizeof text[i], "%s %s", types[type], strchr(core[i], ' ') + 1);
                properties[i] = text[i];
            }
            make_file(encoding, count, 1);
            check_file(1, 9, 1);
        }
}

/* Reads half floats, which some .ply files state as the type ushort. An infinite logit of the opacity is read as
   20. */
static void halves(void)
{
    static const struct { uint16_t bits; double value; } cases[] = {
        {0, 0}, {0x8000, 0}, {1, 1 / 16777216.0}, {0x83ff, -1023 / 16777216.0}, {0x0400, 1 / 16384.0},
        {0x3c00, 1}, {0xbc00, -1}, {0x3c01, 1 + 1 / 1024.0}, {0x4248, 3.140625}, {0xd1e0, -47}, {0x7bff, 65504},
        {0xfbff, -65504}, {0x7c00, INFINITY}, {0xfc00, -INFINITY}, {0x7e01, NAN}
    };
    static const char *const types[] = {"half", "float16", "ushort", "uint16"};
    enum { CASES = sizeof cases / sizeof *cases };
    fxs_gaussian gaussians[CASES + 1];
    for (int type = 0; type < 4; type++)
        for (int wide = 0; wide < 2; wide++)   /* wide 1: positions are floats, all else half floats */
            for (int encoding = LITTLE; encoding <= BIG; encoding++) {
                size = 0;
                put("ply\nformat %s 1.0\nelement vertex %d\n", encodings[encoding], CASES);
                for (int i = 0; i < CORE; i++)
                    put("property %s %s\n", wide && i < 3 ? "float" : types[type], strchr(core[i], ' ') + 1);
                put("end_header\n");
                for (int row = 0; row < CASES; row++)
                    for (int i = 0; i < CORE; i++)
                        if (wide && i < 3)
                            put_number(encoding, "float", row);
                        else
                            put_number(encoding, "ushort", cases[row].bits);
                put_file(size);
                if (!CHECK(read_file(gaussians, CASES + 1) == 0 && info.count == CASES))
                    continue;
                for (int row = 0; row < CASES; row++) {
                    float want = cases[row].value == INFINITY ? 20 : (float)cases[row].value;
                    const float got[2] = {gaussians[row].opacity, gaussians[row].position[1]};
                    CHECK(isnan(want) ? isnan(got[0]) : want == got[0]);
                    want = wide ? (float)row : (float)cases[row].value;
                    CHECK(isnan(want) ? isnan(got[1]) : want == got[1]);
                }
            }
}

/* Reads a .ply with one ushort property among floats, which is a half float too. Its bits 0x3555 are 0.333. */
static void one_half(void)
{
    fxs_gaussian g;
    for (int property = 0; property < CORE; property++)
        for (int encoding = LITTLE; encoding <= BIG; encoding++) {
            const int count = fill_properties(0);
            char text[32];
            snprintf(text, sizeof text, "ushort %s", strchr(core[property], ' ') + 1);
            properties[property] = text;
            size = 0;
            put("ply\nformat %s 1.0\n", encodings[encoding]);
            put_element("vertex", 1, properties, count);
            put("end_header\n");
            for (int i = 0; i < count; i++)
                put_number(encoding, i == property ? "ushort" : "float", i == property ? 0x3555 : 1);
            put_file(size);
            if (!CHECK(read_file(&g, 1) == 0))
                continue;
            float sum = 0;
            for (int i = 0; i < 14; i++)
                sum += ((float *)&g)[i];
            CHECK(is_near((double)sum, property == 3 ? 14 : 13 + 1365 / 4096.0, 1e-6));
        }
}

static void infinite_opacities(void)
{
    static const char *const types[] = {"float", "double", "half"};
    static const double values[] = {INFINITY, -INFINITY, NAN};
    fxs_gaussian gaussians[3];
    for (int type = 0; type < 3; type++)
        for (int encoding = ASCII; encoding <= BIG; encoding++) {
            const int count = fill_properties(0);
            char text[32];
            snprintf(text, sizeof text, "%s opacity", types[type]);
            properties[7] = text;
            size = 0;
            put("ply\nformat %s 1.0\n", encodings[encoding]);
            put_element("vertex", 3, properties, count);
            put("end_header\n");
            for (int row = 0; row < 3; row++) {
                static const int halves[] = {0x7c00, 0xfc00, 0x7e00};
                for (int i = 0; i < count; i++)
                    if (i == 7 && type == 2 && encoding != ASCII)
                        put_number(encoding, "ushort", halves[row]);
                    else
                        put_number(encoding, i == 7 ? types[type] : "float", i == 7 ? values[row] : 1);
                put(encoding == ASCII ? "\n" : "");
            }
            put_file(size);
            CHECK(read_file(gaussians, 3) == 0);
            CHECK(gaussians[0].opacity == 20 && gaussians[1].opacity == -INFINITY && isnan(gaussians[2].opacity));
        }
}

/* ---- Properties under other names ---- */

/* Writes a .ply of one Gaussian whose properties are all 1. The strings in `more` ("type name") add properties. */
static void put_with(const char *const *more, const double *values, int count, int encoding)
{
    size = 0;
    put("ply\nformat %s 1.0\nelement vertex 1\n", encodings[encoding]);
    for (int i = 0; i < CORE; i++)
        if (strncmp(core[i] + 6, "f_dc", 4) != 0)
            put("property %s\n", core[i]);
    for (int i = 0; i < count; i++)
        put("property %s\n", more[i]);
    put("end_header\n");
    for (int i = 0; i < CORE - 3; i++)
        put_number(encoding, "float", 1);
    for (int i = 0; i < count; i++) {
        char type[16];
        sscanf(more[i], "%15s", type);
        put_number(encoding, type, values[i]);
    }
    put("\n");
    put_file(size);
}

static void colours(void)
{
    static const struct { const char *names[3]; double values[3]; double full; } cases[] = {
        {{"uchar red", "uchar green", "uchar blue"}, {0, 128, 255}, 255},
        {{"uint8 red", "uint8 green", "uint8 blue"}, {1, 2, 254}, 255},
        {{"ushort red", "ushort green", "ushort blue"}, {0, 13107, 65535}, 65535},
        {{"float red", "float green", "float blue"}, {0, 0.25, 1}, 1},
        {{"double diffuse_red", "double diffuse_green", "double diffuse_blue"}, {0.125, 0.25, 1}, 1},
        {{"uchar r", "uchar g", "uchar b"}, {7, 128, 255}, 255}
    };
    fxs_gaussian g;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int encoding = ASCII; encoding <= BIG; encoding++) {
            put_with(cases[i].names, cases[i].values, 3, encoding);
            if (!CHECK(read_file(&g, 1) == 0))
                continue;
            CHECK(!info.unused[0] && g.opacity == 1 && g.rotation[3] == 1);
            for (int c = 0; c < 3; c++)
                CHECK(is_near((double)g.dc[c], (cases[i].values[c] / cases[i].full - 0.5) / 0.28209479, 1e-6));
        }
    static const char *const two[] = {"uchar red", "uchar green"};
    put_with(two, cases[0].values, 2, LITTLE);
    check_fails("element vertex has no property f_dc_0");
}

/* Reads a .ply with the 3D filter f of Mip-Splatting. The filter widens sigma to sigma' = sqrt(sigma^2 + f^2).
   The opacity is multiplied by product(sigma) / product(sigma'). */
static void filters(void)
{
    static const char *const names[] = {"float f_dc_0", "float f_dc_1", "float f_dc_2", "float filter_3D"};
    static const double filter[] = {0, 0.01, 3, 1e30};
    fxs_gaussian g;
    for (int i = 0; i < 4; i++)
        for (int encoding = ASCII; encoding <= BIG; encoding++) {
            const double values[] = {1, 1, 1, filter[i]}, f = (double)(float)filter[i];
            put_with(names, values, 4, encoding);
            if (!CHECK(read_file(&g, 1) == 0))
                continue;
            const double sigma = exp(1), grown = sqrt(sigma * sigma + f * f), part = pow(sigma / grown, 3);
            for (int k = 0; k < 3; k++)
                CHECK(is_near((double)g.scale[k], log(grown), 1e-6));
            CHECK(fabs(opacity_of(&g) - part / (1 + exp(-1))) < 1e-6 && (f > 0 || g.opacity == 1));
            CHECK(!info.unused[0] && g.dc[2] == 1 && g.position[1] == 1);
        }
}

/* Reads a .ply with unknown properties. A message must name properties that affect the pictures of other
   programs. */
static void unused_properties(void)
{
    static const struct { const char *properties[4]; const char *named; } cases[] = {
        {{"float ny", "float nz", "uchar red", "uchar alpha"}, ""},
        {{"float confidence", "int label", "float s", "float tx"}, ""},
        {{"float t", "float scale_t", "float rot_r_0", "float rot_r_1"}, "t, scale_t, rot_r_*"},
        {{"float motion_0", "float motion_1", "float trbf_center", "float motion_2"}, "motion_*, trbf_center"},
        {{"float beta", "float f_new_0", "float filter_2D", "float f_dc_3"}, "beta, f_new_0, filter_2D, f_dc_3"},
        {{"float f_a_very_long_name_of_a_property_1", "float f_a_very_long_name_of_a_property_b",
          "float f_a_very_long_name_of_a_property_c", "float f_a_very_long_name_of_a_property_d"},
         "f_a_very_long_name_of_a_property_1, f_a_very_long_name_of_a_property_b, "
         "f_a_very_long_name_of_a_property_c, ..."}
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int rest = 0; rest <= 72; rest += 72) {
            fxs_gaussian gaussians[ROWS];
            const int count = fill_properties(rest);
            memcpy(properties + count, cases[i].properties, sizeof cases[i].properties);
            make_file(LITTLE, count + 4, 0);
            put_file(size);
            if (!CHECK(read_file(gaussians, ROWS) == 0 && !strcmp(info.unused, cases[i].named)))
                printf("  %s, not %s\n", info.unused, cases[i].named);
        }
}

static void flat_gaussians(void)
{
    fxs_gaussian gaussians[ROWS + 1], expected;
    for (int encoding = ASCII; encoding <= BIG; encoding++) {
        fill_properties(45);
        properties[10] = "float other";   /* replaces the property scale_2, so that Gaussians are flat */
        make_file(encoding, CORE + 45, 0);
        put_file(size);
        if (!CHECK(read_file(gaussians, ROWS + 1) == 0 && info.count == ROWS && info.sh_degree == 3))
            continue;
        for (int row = 0; row < ROWS; row++) {
            expect_gaussian(&expected, row, 45, 0);
            expected.scale[2] = -20;
            CHECK(memcmp(&gaussians[row], &expected, sizeof expected) == 0);
        }
    }
}

static void negative_and_large_integers(void)
{
    static const struct { const char *type; double value; } cases[] = {
        {"char", -128}, {"uchar", 255}, {"short", -32768}, {"int", -2147483648.0},
        {"uint", 4294967295.0}, {"double", -1e300}
    };
    fxs_gaussian g;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int encoding = ASCII; encoding <= BIG; encoding++) {
            int count = fill_properties(0);
            size = 0;
            put("ply\nformat %s 1.0\nelement vertex 1\nproperty %s x\n", encodings[encoding], cases[i].type);
            for (int k = 1; k < count; k++)
                put("property %s\n", properties[k]);
            put("end_header\n");
            put_number(encoding, cases[i].type, cases[i].value);
            put_row(encoding, properties + 1, count - 1, 0, 0);
            put_file(size);
            CHECK(read_file(&g, 1) == 0 &&
                  (float)(info.origin[0] + (double)g.position[0]) == (float)cases[i].value);
        }
}

static void other_elements_and_lists(void)
{
    static const char *const face[] = {"list uchar int vertex_indices", "uchar red", "list uint double weights"};
    static const char *const camera[] = {"double focal", "int x"};
    for (int with_list = 0; with_list <= 1; with_list++)
        for (int encoding = ASCII; encoding <= BIG; encoding++) {
            int count = fill_properties(9);
            if (with_list)
                properties[3] = "list ushort short extra";
            size = 0;
            put("ply\nformat %s 1.0\n", encodings[encoding]);
            put_element("camera", 2, camera, 2);
            put_element("face", 5, face, 3);
            put_element("nothing", 2000000000, NULL, 0);
            put_element("vertex", ROWS, properties, count);
            put_element("edge", 4, face, 3);
            put("end_header\n");
            for (int row = 0; row < 2; row++)
                put_row(encoding, camera, 2, row, 0);
            for (int row = 0; row < 5; row++)
                put_row(encoding, face, 3, row, 0);
            for (int row = 0; row < ROWS; row++)
                put_row(encoding, properties, count, row, 0);
            for (int row = 0; row < 4; row++)
                put_row(encoding, face, 3, row, 0);
            check_file(1, 9, 0);
        }
}

static void long_list(void)
{
    int count = fill_properties(0);
    size = 0;
    put("ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list uint float values\n");
    put_element("vertex", ROWS, properties, count);
    put("end_header\n");
    put_number(LITTLE, "uint", 200000);
    memset(bytes + size, 0, 800000);
    size += 800000;
    for (int row = 0; row < ROWS; row++)
        put_row(LITTLE, properties, count, row, 0);
    put("trailing");
    check_file(0, 0, 0);
}

static void comments(void)
{
    static const struct { const char *text; int antialiased; } cases[] = {
        {"comment", 0}, {"comment SplatRenderMode: mip", 1}, {"comment SplatRenderMode: default", 0},
        {"comment antialiased 1", 1}, {"comment antialiased 0", 0}, {"comment not antialiased 1", 0},
        {"obj_info antialiased 1", 0}, {"comment  antialiased\t1 \r", 1},
        {"comment element vertex 12 element vertex 13", 0}
    };
    fxs_gaussian gaussians[ROWS];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        int count = fill_properties(0);
        size = 0;
        put("ply\n%s\nformat binary_little_endian 1.0\n", cases[i].text);
        put_element("vertex", ROWS, properties, count);
        put("end_header\n");
        for (int row = 0; row < ROWS; row++)
            put_row(LITTLE, properties, count, row, 0);
        put_file(size);
        CHECK(read_file(gaussians, ROWS) == 0 && info.antialiased == cases[i].antialiased);
    }
}

static void carriage_returns(void)
{
    static uint8_t plain[1 << 14];
    for (int encoding = ASCII; encoding <= BIG; encoding++) {
        make_file(encoding, fill_properties(9), 0);
        size_t length = size, header = (size_t)(strstr((char *)bytes, "end_header\n") - (char *)bytes) + 11;
        memcpy(plain, bytes, length);
        size = 0;
        for (size_t i = 0; i < length; i++) {
            if (plain[i] == '\n' && (encoding == ASCII || i < header))
                bytes[size++] = '\r';
            bytes[size++] = plain[i];
        }
        check_file(1, 9, 0);
    }
}

static void empty_scene(void)
{
    fxs_gaussian g;
    size = 0;
    put("ply\nformat ascii 1.0\n");
    put_element("vertex", 0, properties, fill_properties(0));
    put("end_header");
    check_fails("the header has no end_header");
    put("\n");
    put_file(size);
    CHECK(read_file(&g, 1) == 0 && info.count == 0);
}

static int read_ascii_x(const char *text, float *x)
{
    fxs_gaussian g;
    int count = fill_properties(0);
    size = 0;
    put("ply\nformat ascii 1.0\n");
    put_element("vertex", 1, properties, count);
    put("end_header\n\n\n%s\t", text);
    put_row(ASCII, properties + 1, count - 1, 0, 0);
    put_file(size);
    int status = read_file(&g, 1);
    *x = g.position[0];
    return status;
}

static void ascii_numbers(void)
{
    static const struct { const char *text; double value; } good[] = {
        {"0", 0}, {"-12", -12}, {"+3", 3}, {".5", 0.5}, {"5.", 5}, {"1e3", 1000}, {"1E-3", 1e-3}, {"-2.5e+2", -250},
        {"0.1", 0.1}, {"3.4028235e38", 3.4028235e38}, {"1.17549435e-38", 1.17549435e-38},
        {"1.40129846e-45", 1.40129846e-45},
        {"1e400", INFINITY}, {"-1e99999999999", -INFINITY}, {"1e-400", 0}, {"0e99999", 0}, {"inf", INFINITY},
        {"-INF", -INFINITY}, {"0.33333333333333333333333333333333333333333333333333", 1 / 3.0},
        {"123456789012345678901234567890", 1.2345678901234568e29}
    };
    static const char *const bad[] = {"-", ".", "1e", "1e+", "1.2.3", "1,5", "abc", "0x10", "nano", "--1", "1-", "e5"};
    float x;
    char text[800];
    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
        if (!CHECK(read_ascii_x(good[i].text, &x) == 0 && x == (float)good[i].value))
            printf("  %s\n", good[i].text);
    CHECK(read_ascii_x("-nan", &x) == 0 && isnan(x));
    CHECK(read_ascii_x("NaN", &x) == 0 && isnan(x));
    snprintf(text, sizeof text, "%f", -1e300);
    CHECK(read_ascii_x(text, &x) == 0 && x == -INFINITY);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (!CHECK(read_ascii_x(bad[i], &x) == FXS_ERR_FILE &&
                   strstr(message.text, ": vertex 1 of 1: a value is not a number")))
            printf("  %s\n", bad[i]);
    memset(text, '1', 700);
    text[700] = '\0';
    CHECK(read_ascii_x(text, &x) == FXS_ERR_FILE && strstr(message.text, "a value is too long"));
    CHECK(read_ascii_x("1 2", &x) == FXS_ERR_FILE && strstr(message.text, "too many values"));
    CHECK(read_ascii_x("1\n", &x) == FXS_ERR_FILE && strstr(message.text, "too few values"));
}

static void ascii_round_trip(void)
{
    enum { COUNT = 1000 };
    static fxs_gaussian gaussians[COUNT];
    static float values[COUNT][CORE];
    uint32_t bits = 1;
    size = 0;
    put("ply\nformat ascii 1.0\n");
    put_element("vertex", COUNT, properties, fill_properties(0));
    put("end_header\n");
    for (int row = 0; row < COUNT; row++, put("\n"))
        for (int i = 0; i < CORE; i++) {
            do {
                bits = bits * 1664525u + 1013904223u;
                uint32_t mixed = bits ^ bits >> 15;
                memcpy(&values[row][i], &mixed, 4);
            } while (!isfinite(values[row][i]));
            put("%.9g ", (double)values[row][i]);
        }
    put_file(size);
    CHECK(read_file(gaussians, COUNT) == 0);
    for (int row = 0; row < COUNT; row++)
        CHECK(memcmp(gaussians[row].position, values[row], 12) == 0
              && memcmp(gaussians[row].rotation, values[row] + 11, 16) == 0);
}

static void not_finite_values_pass(void)
{
    fxs_gaussian gaussians[ROWS];
    make_file(LITTLE, fill_properties(0), 0);
    memcpy(bytes + size - 8, "\x00\x00\xc0\x7f\x00\x00\x80\xff", 8);
    put_file(size);
    CHECK(read_file(gaussians, ROWS) == 0 && isnan(gaussians[ROWS - 1].rotation[2]));
    CHECK(gaussians[ROWS - 1].rotation[3] == -INFINITY);
}

static void utf8_mark(void)
{
    static fxs_gaussian plain[ROWS], marked[ROWS];
    for (int encoding = ASCII; encoding <= BIG; encoding++) {
        make_file(encoding, fill_properties(9), 0);
        put_file(size);
        CHECK(read_file(plain, ROWS) == 0);
        memmove(bytes + 3, bytes, size);
        memcpy(bytes, "\xef\xbb\xbf", 3);
        size += 3;
        put_file(size);
        CHECK(read_file(marked, ROWS) == 0 && !memcmp(plain, marked, sizeof plain));
    }
}

static void list_lengths(void)
{
    static const char *const lengths[] = {"-1", "nan", "1e30"};
    for (int i = 0; i < 3; i++) {
        size = 0;
        put("ply\nformat ascii 1.0\nelement face 1\nproperty list int int v\n");
        put_element("vertex", 0, properties, fill_properties(0));
        put("end_header\n%s\n", lengths[i]);
        check_fails(": face 1 of 1: a list has no valid length");
    }
    size = 0;
    put("ply\nformat binary_big_endian 1.0\nelement face 1\nproperty list int double v\n");
    put_element("vertex", 0, properties, fill_properties(0));
    put("end_header\n\x7f\xff\xff\xff");
    check_fails(": face 1 of 1: the file ends early");
}

#define START "ply\nformat ascii 1.0\n"
#define VERTEX START "element vertex 1\n"

static void faulty_headers(void)
{
    static const char *const cases[][2] = {
        {"", "not a scene file of a known format"},
        {"plx\n", "not a scene file of a known format"},
        {"ply", "the header has no end_header"},
        {"plyx\n", "header line 1: not \"ply\" alone: \"plyx\""},
        {"ply ply\n", "header line 1: not \"ply\" alone"},
        {"ply\nformat ascii 2.0\n", "header line 2: unknown version \"2.0\""},
        {"ply\nformat binary 1.0\n", "header line 2: unknown format \"binary\""},
        {"ply\nformat ascii\n", "header line 2: cannot read this \"format\""},
        {"ply\nend_header\n", "the header has no format line"},
        {START "end_header\n", "the header has no element vertex"},
        {START "elephant\n", "header line 3: cannot read this \"elephant\""},
        {START "end_header 1\n", "header line 3: cannot read this \"end_header\""},
        {START "element vertex\n", "header line 3: cannot read this \"element\""},
        {START "element vertex -1\n", "header line 3: not a count from 0 to 2147483647: \"-1\""},
        {START "element vertex 12x\n", "header line 3: not a count from 0 to 2147483647: \"12x\""},
        {START "element vertex 2147483648\n", "header line 3: not a count from 0 to 2147483647: \"2147483648\""},
        {START "element vertex 99999999999999999999999999\n", "header line 3: not a count from 0 to 2147483647"},
        {VERTEX "element vertex 1\n", "header line 4: a second element \"vertex\""},
        {START "property float x\n", "header line 3: a property before the first element: \"x\""},
        {VERTEX "property flaot x\n", "header line 4: unknown type \"flaot\""},
        {VERTEX "property list uchar flaot x\n", "header line 4: unknown type \"flaot\""},
        {VERTEX "property list float int x\n", "header line 4: a list length that is not of an integer type: \"x\""},
        {VERTEX "property list uchar int\n", "header line 4: cannot read this \"property\""},
        {VERTEX "property float x\nproperty double x\n", "header line 5: a second property \"x\""},
        {VERTEX "property float f_rest_8\nproperty float f_rest_8\n", "header line 5: a second property \"f_rest_8\""},
        {VERTEX "property float \x1b[2J\n", "header line 4 is not text"},
        {VERTEX "property list uchar float x\nend_header\n", "element vertex has no property x"},
        {VERTEX "property uint packed_position\nend_header\n", "a compressed .ply that is not binary_little_endian"}
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        size = 0;
        put("%s", cases[i][0]);
        check_fails(cases[i][1]);
    }
}

static void points_and_meshes(void)
{
    size = 0;
    put(VERTEX "property float x\nproperty float y\nproperty float z\nproperty uchar red\nend_header\n");
    check_fails("a point cloud, not Gaussians: a .ply of points is what fit begins with");
    size = 0;
    put(VERTEX "property float x\nproperty float y\nproperty float z\nelement face 2\nproperty list uchar int v\n"
        "end_header\n");
    check_fails("a mesh, not Gaussians");
    size = 0;
    put(VERTEX "property float x\nproperty float y\nproperty float z\nproperty float opacity\nend_header\n");
    check_fails("element vertex has no property scale_0");
}

static void header_limits(void)
{
    size = 0;
    put(START "comment %4088s\ncomment %4089s\n", "", "");
    check_fails("header line 4 has more than 4096 characters");
    size = 0;
    put(START);
    while (size <= 1 << 20)
        put("comment %4000s\n", "");
    check_fails("the header has more than 1048576 bytes");
    size = 0;
    put(VERTEX);
    for (int i = 0; i <= 1024; i++)
        put("property float p%d\n", i);
    check_fails("header line 1028: more than 1024 properties, at \"p1024\"");
    size = 0;
    put(START);
    for (int i = 0; i <= 64; i++)
        put("element e%d 1\n", i);
    check_fails("header line 67: more than 64 elements, at \"e64\"");
}

static void missing_properties(void)
{
    char text[80];
    for (int missing = 0; missing < CORE; missing++) {
        int count = fill_properties(0);
        const char *name = strchr(properties[missing], ' ') + 1;
        properties[missing] = "float other";
        make_file(LITTLE, count, 0);
        snprintf(text, sizeof text, "element vertex has no property %s", name);
        if (strcmp(name, "scale_2") != 0 && strcmp(name, "nx") != 0)
            check_fails(text);
    }
}

static void wrong_rest_counts(void)
{
    char text[80];
    for (int rest = 1; rest <= 72; rest++) {
        if (rest == 9 || rest == 24 || rest == 45 || rest == 72)
            continue;
        make_file(LITTLE, fill_properties(rest), 0);
        snprintf(text, sizeof text, "%d f_rest_* properties, not 0, 9, 24, 45 or 72", rest);
        check_fails(text);
    }
    int count = fill_properties(9);
    properties[CORE + 4] = "float f_rest_9";
    make_file(LITTLE, count, 0);
    check_fails("element vertex has no property f_rest_4");
    properties[CORE + 4] = "float f_rest_99999999999999999999";
    make_file(LITTLE, count, 0);
    check_fails("element vertex has no property f_rest_4");
}

static void absurd_counts(void)
{
    for (int encoding = ASCII; encoding <= BIG; encoding++) {
        size = 0;
        put("ply\nformat %s 1.0\n", encodings[encoding]);
        put_element("vertex", 2147483647, properties, fill_properties(0));
        put("end_header\n1 2 3\n");
        check_fails("the header asks for at least");
    }
}

static void one_level(void)
{
    fxs_scene_file *file;
    fxs_scene_file_options options = {.size = sizeof(fxs_scene_file_options), .level = 0};
    make_file(LITTLE, fill_properties(0), 0);
    CHECK(fxs_scene_file_open_memory(path, bytes, size, &options, &file, &info, &message) == 0 && info.levels == 1);
    fxs_scene_file_close(file);
    options.level = 1;
    CHECK(fxs_scene_file_open_memory(path, bytes, size, &options, &file, &info, &message) == FXS_ERR_ARGUMENT &&
          file == NULL);
    CHECK(strstr(message.text, ": no level 1: levels of detail in this scene: 1") != NULL);
}

static void not_files(void)
{
    fxs_scene_file *file;
    CHECK(fxs_scene_file_open("/dev/null", NULL, &file, &info, &message) == FXS_ERR_FILE && file == NULL);
    CHECK(strcmp(message.text, "/dev/null: not a regular file") == 0);
    CHECK(fxs_scene_file_open("/dev", NULL, &file, &info, &message) == FXS_ERR_FILE && file == NULL);
    CHECK(strncmp(message.text, "/dev: not a regular file, but a folder ", 39) == 0);
    CHECK(fxs_scene_file_open("no/such/file", NULL, &file, &info, &message) == FXS_ERR_FILE && file == NULL);
    CHECK(strncmp(message.text, "no/such/file: ", 14) == 0);
    fxs_scene_file_close(NULL);
}

static void real_scenes(void)
{
    static const struct { const char *name; uint64_t count; int degree; } scenes[] = {
        {"snowmiku/snowmiku.ply", 335690, 3}, {"donut/donut.ply", 45624, 0},
        {"fruit-drops/fruit_drops_minimal.ply", 4721, 3}, {"train-1000/train-1000.ply", 1000, 3}
    };
    static fxs_gaussian gaussians[1000];
    char name[1024];
    if (access(scenes_folder(), R_OK) != 0)
        SKIP("no folder of scenes; set FXS_SCENES");
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        fxs_scene_file *file;
        uint64_t total = 0, odd = 0;
        long count;
        snprintf(name, sizeof name, "%s/%s", scenes_folder(), scenes[i].name);
        if (!CHECK(fxs_scene_file_open(name, NULL, &file, &info, &message) == 0)) {
            printf("  %s\n", message.text);
            continue;
        }
        CHECK(info.count == scenes[i].count && info.sh_degree == scenes[i].degree && !info.antialiased);
        while ((count = fxs_scene_file_read(file, gaussians, 1000, &message)) > 0) {
            for (long k = 0; k < count; k++)
                odd += !(fabsf(gaussians[k].scale[0]) < 30 && fabsf(gaussians[k].opacity) < 100);
            total += (uint64_t)count;
        }
        CHECK(count == 0 && total == scenes[i].count && odd == 0);
        fxs_scene_file_close(file);
    }
}

int main(void)
{
    RUN(every_degree_in_every_encoding);
    RUN(shuffled_properties);
    RUN(every_type);
    RUN(halves);
    RUN(one_half);
    RUN(infinite_opacities);
    RUN(colours);
    RUN(filters);
    RUN(unused_properties);
    RUN(flat_gaussians);
    RUN(negative_and_large_integers);
    RUN(other_elements_and_lists);
    RUN(long_list);
    RUN(comments);
    RUN(carriage_returns);
    RUN(empty_scene);
    RUN(ascii_numbers);
    RUN(ascii_round_trip);
    RUN(not_finite_values_pass);
    RUN(utf8_mark);
    RUN(points_and_meshes);
    RUN(list_lengths);
    RUN(faulty_headers);
    RUN(header_limits);
    RUN(missing_properties);
    RUN(wrong_rest_counts);
    RUN(absurd_counts);
    RUN(one_level);
    RUN(not_files);
    RUN(real_scenes);
    return check_report();
}
