/* Reads synthetic .glb and .gltf files, faulty files, and a real scene. */
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <unistd.h>

#include <fixsplat/scene.h>
#include "check.h"
#include "spz_bytes.h"

#ifdef FXS_WITH_CJSON

enum { COUNT = 5, MAX_TEXT = 1 << 16, MAX_BYTES = 1 << 16 };
enum { BYTE = 5120, UBYTE, SHORT, USHORT, FLOAT = 5126 };

static char folder[] = "/tmp/test_gltf_XXXXXX";
static fxs_message message;
static fxs_scene_file_info info;
static fxs_gaussian out[4 * COUNT];

static uint8_t bin[MAX_BYTES], file_bytes[MAX_BYTES + MAX_TEXT];
static size_t bin_size, file_size;
static char views[MAX_TEXT], accessors[MAX_TEXT], attributes[MAX_TEXT], json[MAX_TEXT];
static int accessor_count;

static void append(char *text, const char *format, ...)
{
    va_list arguments;
    size_t length = strlen(text);
    va_start(arguments, format);
    vsnprintf(text + length, MAX_TEXT - length, format, arguments);
    va_end(arguments);
}

static void clear(void)
{
    bin_size = 0;
    accessor_count = 0;
    views[0] = accessors[0] = attributes[0] = json[0] = '\0';
}

static void put_component(int type, int normalized, double value)
{
    static const int size[] = {1, 1, 2, 2, 0, 0, 4};
    static const double most[] = {127, 255, 32767, 65535};
    float real = (float)value;
    uint32_t bits;
    memcpy(&bits, &real, 4);
    if (type != FLOAT)
        bits = (uint32_t)(int32_t)floor(value * (normalized ? most[type - BYTE] : 1) + 0.5);
    spz_put(bin + bin_size, bits, size[type - BYTE]);
    bin_size += (size_t)size[type - BYTE];
}

/* Adds an accessor with values to the .glb. `gap` is the number of padding bytes after each element. */
static void add(const char *name, int components, int type, int normalized, int gap, const double *values)
{
    static const char *const shapes[] = {"", "SCALAR", "", "VEC3", "VEC4"};
    const char *comma = accessor_count ? "," : "";
    size_t start = bin_size, element = 0;
    bin_size += 8;   /* room before the values, since byteOffset is 4 in the bufferView and 4 in the accessor */
    for (int i = 0; i < COUNT; i++) {
        size_t at = bin_size;
        for (int c = 0; c < components; c++)
            put_component(type, normalized, values[components * i + c]);
        element = bin_size - at;
        bin_size += (size_t)gap;
    }
    append(views, "%s{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu", comma, start + 4, bin_size - start - 4);
    append(views, gap ? ",\"byteStride\":%zu}" : "}", element + (size_t)gap);
    append(accessors, "%s{\"bufferView\":%d,\"byteOffset\":4,\"componentType\":%d,\"count\":%d,\"type\":\"%s\"%s}",
           comma, accessor_count, type, COUNT, shapes[components], normalized ? ",\"normalized\":true" : "");
    append(attributes, "%s\"%s%s\":%d", comma, strcmp(name, "POSITION") ? "KHR_gaussian_splatting:" : "", name,
           accessor_count++);
}

static const char extension[] =
    "\"KHR_gaussian_splatting\":{\"kernel\":\"ellipse\",\"colorSpace\":\"srgb_rec709_display\"}";

static void write_json(const char *nodes, const char *extensions, const char *buffer)
{
    json[0] = '\0';
    append(json, "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[%s],"
           "\"meshes\":[{\"primitives\":[{\"mode\":0,\"attributes\":{%s},\"extensions\":{%s}}]}],"
           "\"accessors\":[%s],\"bufferViews\":[%s],\"buffers\":[{%s\"byteLength\":%zu}]}", nodes, attributes,
           extensions, accessors, views, buffer, bin_size);
}

static void make_glb(void)
{
    size_t length = (strlen(json) + 3) / 4 * 4, bin_length = (bin_size + 3) / 4 * 4;
    uint8_t *to = spz_put(file_bytes, 0x46546c67, 4);
    to = spz_put(spz_put(to, 2, 4), 28 + length + bin_length, 4);
    to = spz_put(spz_put(to, length, 4), 0x4e4f534a, 4);
    memset(to, ' ', length);
    memcpy(to, json, strlen(json));
    to = spz_put(spz_put(to + length, bin_length, 4), 0x004e4942, 4);
    memcpy(to, bin, bin_size);
    file_size = (size_t)(to - file_bytes) + bin_length;
}

static void put_named(const char *name, const void *bytes, size_t size)
{
    char full[128];
    snprintf(full, sizeof full, "%s/%s", folder, name);
    FILE *stream = fopen(full, "wb");
    if (!CHECK(stream != NULL))
        return;
    CHECK(fwrite(bytes, 1, size, stream) == size);
    fclose(stream);
}

static double position[3 * COUNT], rotation[4 * COUNT], scale[3 * COUNT], opacity[COUNT], sh[16][3 * COUNT];

static double random_number(void)
{
    static uint32_t state = 1;
    state = state * 1664525 + 1013904223;
    return (state >> 8) / 16777216.0;
}

static void fill_values(void)
{
    for (int i = 0; i < COUNT; i++) {
        double norm = 0, *q = rotation + 4 * i;
        for (int c = 0; c < 4; c++) {
            q[c] = random_number() - 0.5;
            norm += q[c] * q[c];
        }
        for (int c = 0; c < 4; c++)
            q[c] /= sqrt(norm);
        for (int c = 0; c < 3; c++) {
            position[3 * i + c] = 8 * random_number() - 4;
            scale[3 * i + c] = floor(250 * random_number() + 1) / 255;
            for (int k = 0; k < 16; k++)
                sh[k][3 * i + c] = 2 * random_number() - 1;
        }
        opacity[i] = (i + 0.5) / COUNT;
    }
}

static void add_sh(int degree)
{
    char name[40];
    for (int l = 0, k = 0; l <= degree; l++)
        for (int n = 0; n <= 2 * l; n++, k++) {
            snprintf(name, sizeof name, "SH_DEGREE_%d_COEF_%d", l, n);
            add(name, 3, FLOAT, 0, 0, sh[k]);
        }
}

static void add_all(int degree)
{
    clear();
    fill_values();
    add("POSITION", 3, FLOAT, 0, 0, position);
    add("ROTATION", 4, FLOAT, 0, 4, rotation);
    add("SCALE", 3, FLOAT, 0, 0, scale);
    add("OPACITY", 1, FLOAT, 0, 0, opacity);
    add_sh(degree);
}

static long read_scene(const char *name, int step)
{
    char full[128];
    fxs_scene_file *file;
    long total = 0, got = 0;
    snprintf(full, sizeof full, "%s/%s", folder, name);
    const int error = fxs_scene_file_open(full, NULL, &file, &info, &message);
    if (error)
        return error;
    CHECK(strcmp(info.format, "gltf") == 0);
    fxs_scene_file_read(file, out, 2, &message);
    CHECK(fxs_scene_file_rewind(file, &message) == 0);
    while (total + step <= 4 * COUNT && (got = fxs_scene_file_read(file, out + total, (size_t)step, &message)) > 0)
        total += got;
    fxs_scene_file_close(file);
    return got < 0 ? got : total;
}

static long read_glb(void)
{
    make_glb();
    put_named("a.glb", file_bytes, file_size);
    return read_scene("a.glb", 3);
}

static void expect_fault(long result, const char *text)
{
    if (!CHECK(result == FXS_ERR_FILE) || !CHECK(strstr(message.text, text) && strstr(message.text, folder)))
        printf("  got \"%s\", wanted \"%s\"\n", message.text, text);
}

static void check_fails(const char *text)
{
    message.text[0] = '\0';
    expect_fault(read_glb(), text);
}

static void expect_read(long result, long count)
{
    if (!CHECK(result == count))
        printf("  %ld: %s\n", result, message.text);
}

static void rotation_matrix(double x, double y, double z, double w, double m[3][3])
{
    const double made[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                               {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                               {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
    memcpy(m, made, sizeof made);
}

/* Computes the covariance m diag(s)^2 m^T of a Gaussian with axes m and sigmas s. */
static void covariance(double m[3][3], const double s[3], double c[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            c[i][j] = m[i][0] * m[j][0] * s[0] * s[0] + m[i][1] * m[j][1] * s[1] * s[1] +
                      m[i][2] * m[j][2] * s[2] * s[2];
}

static void multiply(double a[3][3], double b[3][3], double c[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            c[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
}

/* Evaluates the view-dependent colour from the SH of degrees 1 to 3, by the section "Calculating color" of
   KHR_gaussian_splatting. */
static double colour(const double k[15], const double d[3])
{
    double x = d[0], y = d[1], z = d[2];
    return -0.48860251 * (k[0] * y - k[1] * z + k[2] * x) + 1.0925484 * (k[3] * x * y - k[4] * y * z - k[6] * x * z) +
           0.31539157 * k[5] * (3 * z * z - 1) + 0.54627422 * k[7] * (x * x - y * y) -
           0.59004359 * (k[8] * y * (3 * x * x - y * y) + k[14] * x * (x * x - 3 * y * y)) +
           2.8906114 * k[9] * x * y * z - 0.45704580 * (5 * z * z - 1) * (k[10] * y + k[12] * x) +
           0.37317633 * k[11] * z * (5 * z * z - 3) +
           1.4453057 * k[13] * z * (x * x - y * y);
}

static void check_colours(const fxs_gaussian *g, int i, double turn[3][3], double tolerance)
{
    for (int trial = 0; trial < 10; trial++) {
        double angle = 6.28 * random_number(), z = 2 * random_number() - 1, r = sqrt(1 - z * z);
        double d[3] = {r * cos(angle), r * sin(angle), z}, turned[3], before[15], after[15];
        for (int k = 0; k < 3; k++)
            turned[k] = turn[k][0] * d[0] + turn[k][1] * d[1] + turn[k][2] * d[2];
        for (int c = 0; c < 3; c++) {
            for (int k = 0; k < 15; k++) {
                before[k] = k < info.sh_degree * (info.sh_degree + 2) ? sh[k + 1][3 * i + c] : 0;
                after[k] = g->sh[3 * k + c];
            }
            CHECK(fabs(colour(before, d) - colour(after, turned)) < tolerance);
        }
    }
}

/* Checks Gaussians that were moved by x -> m x + shift in glTF's coordinate system. turn: the rotation in m. */
static void check_gaussians(const fxs_gaussian *g, double m[3][3], const double shift[3], double turn[3][3],
                            double tolerance)
{
    double to_ply[3][3] = {{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}}, a[3][3], a_turn[3][3];
    multiply(to_ply, m, a);
    multiply(to_ply, turn, a_turn);
    for (int i = 0; i < COUNT; i++, g++) {
        const double *q = rotation + 4 * i, *p = position + 3 * i;
        double r[3][3], mr[3][3], want[3][3], got[3][3], s[3], norm = 0;
        for (int k = 0; k < 3; k++) {
            double x = a[k][0] * p[0] + a[k][1] * p[1] + a[k][2] * p[2] + to_ply[k][k] * shift[k];
            CHECK(fabs(g->position[k] - x) < 1e-5 * (1 + fabs(x)));
            CHECK(fabs(g->dc[k] - sh[0][3 * i + k]) < 1e-6);
            s[k] = exp(g->scale[k]);
        }
        for (int k = 0; k < 4; k++)
            norm += g->rotation[k] * g->rotation[k];
        CHECK(fabs(norm - 1) < 1e-5);
        CHECK(fabs(1 / (1 + exp(-g->opacity)) - opacity[i]) < tolerance);
        rotation_matrix(q[0], q[1], q[2], q[3], r);
        multiply(a, r, mr);
        covariance(mr, scale + 3 * i, want);
        rotation_matrix(g->rotation[1], g->rotation[2], g->rotation[3], g->rotation[0], r);
        covariance(r, s, got);
        double size = want[0][0] + want[1][1] + want[2][2];
        for (int k = 0; k < 9; k++)
            CHECK(fabs(want[k / 3][k % 3] - got[k / 3][k % 3]) < 4 * tolerance * size);
        check_colours(g, i, a_turn, 1e-5);
    }
}

static double identity[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
static const double nowhere[3] = {0, 0, 0};

static void every_degree(void)
{
    for (int degree = 0; degree <= 3; degree++) {
        add_all(degree);
        write_json("{\"mesh\":0}", extension, "");
        expect_read(read_glb(), COUNT);
        CHECK(info.count == COUNT && info.sh_degree == degree && !info.antialiased);
        check_gaussians(out, identity, nowhere, identity, 2e-6);
    }
}

static void every_type(void)
{
    static const struct { int type, normalized; double error; }
        rotations[] = {{FLOAT, 0, 2e-6}, {BYTE, 1, 0.01}, {SHORT, 1, 1e-4}},
        scales[] = {{FLOAT, 0, 0}, {UBYTE, 1, 0}, {USHORT, 1, 0}, {UBYTE, 0, 0}, {USHORT, 0, 0}},
        opacities[] = {{FLOAT, 0, 1e-6}, {UBYTE, 1, 0.003}, {USHORT, 1, 1e-5}};
    for (int r = 0; r < 3; r++)
        for (int s = 0; s < 5; s++)
            for (int o = 0; o < 3; o++) {
                clear();
                fill_values();
                for (int i = 0; i < 3 * COUNT && s >= 3; i++)
                    scale[i] = floor(scale[i] * 200) + 1;
                add("POSITION", 3, FLOAT, 0, 8, position);
                add("ROTATION", 4, rotations[r].type, rotations[r].normalized, 3 * s, rotation);
                add("SCALE", 3, scales[s].type, scales[s].normalized, r, scale);
                add("OPACITY", 1, opacities[o].type, opacities[o].normalized, 3, opacity);
                add_sh(0);
                write_json("{\"mesh\":0}", extension, "");
                expect_read(read_glb(), COUNT);
                check_gaussians(out, identity, nowhere, identity, rotations[r].error + opacities[o].error + 1e-6);
            }
}

static void extreme_values(void)
{
    clear();
    fill_values();
    scale[0] = 0;
    scale[1] = -1;
    opacity[0] = 0;
    opacity[1] = 1;
    opacity[2] = 1.5;
    add("POSITION", 3, FLOAT, 0, 0, position);
    add("ROTATION", 4, FLOAT, 0, 0, rotation);
    add("SCALE", 3, FLOAT, 0, 0, scale);
    add("OPACITY", 1, FLOAT, 0, 0, opacity);
    add_sh(0);
    write_json("{\"mesh\":0}", extension, "");
    expect_read(read_glb(), COUNT);
    CHECK(out[0].scale[1] == 0 && out[0].opacity == -20 && out[1].opacity == 20 && out[2].opacity == 20);
}

/* Reads SCALE as logarithms, which drafts of the glTF extension KHR_gaussian_splatting store. */
static void log_scales(void)
{
    static const struct { int type, normalized; double low, step; } types[] = {
        {FLOAT, 0, -9, 0.03125}, {BYTE, 0, -9, 1}, {SHORT, 0, -9, 1}, {BYTE, 1, -1, 2 / 127.0},
        {SHORT, 1, -1, 2 / 32767.0}
    };
    for (int t = 0; t < 5; t++) {
        add_all(0);
        clear();
        for (int i = 0; i < 3 * COUNT; i++) {
            scale[i] = types[t].low + types[t].step * (i % 10);
            scale[i] = types[t].normalized ? floor(scale[i] * (t == 3 ? 127 : 32767) + 0.5) / (t == 3 ? 127 : 32767)
                       : scale[i];
        }
        add("POSITION", 3, FLOAT, 0, 0, position);
        add("ROTATION", 4, FLOAT, 0, 0, rotation);
        add("SCALE", 3, types[t].type, types[t].normalized, 1, scale);
        add("OPACITY", 1, FLOAT, 0, 0, opacity);
        add_sh(0);
        write_json("{\"mesh\":0}", extension, "");
        expect_read(read_glb(), COUNT);
        for (int i = 0; i < 3 * COUNT; i++)
            scale[i] = exp(scale[i]);
        check_gaussians(out, identity, nowhere, identity, 1e-5);
        CHECK(info.log_scales);
    }
    /* with only one negative scale, scales are linear; with two of five, they are logarithms */
    for (int below = 1; below <= 2; below++) {
        add_all(0);
        clear();
        for (int i = 0; i < below; i++)
            scale[3 * i] = -1;
        add("POSITION", 3, FLOAT, 0, 0, position);
        add("ROTATION", 4, FLOAT, 0, 0, rotation);
        add("SCALE", 3, FLOAT, 0, 0, scale);
        add("OPACITY", 1, FLOAT, 0, 0, opacity);
        add_sh(0);
        write_json("{\"mesh\":0}", extension, "");
        expect_read(read_glb(), COUNT);
        CHECK(out[0].scale[0] == (below == 2 ? -1 : 0) && info.log_scales == (below == 2));
    }
}

/* Two primitives in a file. SCALE from 0 to 2 in one could be linear. The negative SCALE of the other proves
   logarithms for the whole file. */
static void log_scales_of_a_file(void)
{
    static char whole[MAX_TEXT];
    double low[3 * COUNT], high[3 * COUNT];
    for (int i = 0; i < 3 * COUNT; i++) {
        low[i] = -1 - i % 3;
        high[i] = i % 3;
    }
    add_all(0);
    clear();
    add("POSITION", 3, FLOAT, 0, 0, position);
    add("ROTATION", 4, FLOAT, 0, 0, rotation);
    add("SCALE", 3, FLOAT, 0, 0, high);
    add("OPACITY", 1, FLOAT, 0, 0, opacity);
    add_sh(0);
    add("OTHER", 3, FLOAT, 0, 0, low);
    write_json("{\"mesh\":0}", extension, "");
    const char *first = strstr(json, "{\"mode\""), *end = strstr(json, "]}],\"accessors\"");
    const char *at = strstr(json, ":SCALE\":2");
    snprintf(whole, sizeof whole, "%.*s,%.*s:SCALE\":5%s", (int)(end - json), json, (int)(at - first), first,
             at + strlen(":SCALE\":2"));
    strcpy(json, whole);
    expect_read(read_glb(), 2 * COUNT);
    for (int i = 0; i < COUNT; i++)
        CHECK(out[i].scale[0] + out[i].scale[1] + out[i].scale[2] == 3 &&
              out[COUNT + i].scale[0] + out[COUNT + i].scale[1] + out[COUNT + i].scale[2] == -6);
}

static void draft_names(void)
{
    static const struct { int type, normalized; double error; } colours[] = {
        {UBYTE, 1, 0.51 / 255}, {USHORT, 1, 0.51 / 65535}, {FLOAT, 0, 1e-6}
    };
    double rgba[4 * COUNT];
    for (int t = 0; t < 3; t++) {
        char *at;
        add_all(0);
        clear();
        for (int i = 0; i < COUNT; i++) {
            for (int c = 0; c < 3; c++) {
                rgba[4 * i + c] = 0.1 + 0.05 * i + 0.2 * c;
                sh[0][3 * i + c] = 0;
            }
            rgba[4 * i + 3] = opacity[i];
        }
        add("POSITION", 3, FLOAT, 0, 0, position);
        add("ROTATION", 4, FLOAT, 0, 0, rotation);
        add("SCALE", 3, FLOAT, 0, 0, scale);
        add("COLOR_0", 4, colours[t].type, colours[t].normalized, 0, rgba);
        while ((at = strstr(attributes, "KHR_gaussian_splatting:"))) {
            char *name = at + strlen("KHR_gaussian_splatting:");
            *at = '_';
            memmove(strncmp(name, "COLOR", 5) ? at + 1 : at, name, strlen(name) + 1);
        }
        write_json("{\"mesh\":0}", "\"KHR_gaussian_splatting\":{\"quantizedPositionScale\":1.0}", "");
        expect_read(read_glb(), COUNT);
        for (int i = 0; i < COUNT; i++)
            for (int c = 0; c < 3; c++) {
                CHECK(fabs(0.5 + 0.28209479177387814 * (double)out[i].dc[c] - rgba[4 * i + c]) < colours[t].error);
                out[i].dc[c] = 0;
            }
        check_gaussians(out, identity, nowhere, identity, colours[t].error + 1e-6);
        CHECK(info.sh_degree == 0 && info.stored_sh_degree == 0);
        write_json("{\"mesh\":0}", "\"KHR_gaussian_splatting\":{\"quantizedPositionScale\":13.2}", "");
        check_fails("a quantizedPositionScale (of a draft) is not read");
    }
}

static double srgb(double c)
{
    return c <= 0.0031308 ? 12.92 * c : 1.055 * pow(c, 1 / 2.4) - 0.055;
}

static fxs_gaussian plain[COUNT];

/* Checks colours that are converted from linear light to sRGB. SH coefficients scale with the slope of the sRGB
   curve at the Gaussian's colour. */
static void check_srgb(int degree)
{
    static const double sh_0 = 0.28209479177387814;
    const int coefficients = (degree + 1) * (degree + 1);
    for (int i = 0; i < COUNT; i++)
        for (int c = 0; c < 3; c++) {
            const double colour = 0.5 + sh_0 * sh[0][3 * i + c];
            CHECK(fabs(0.5 + sh_0 * (double)out[i].dc[c] - srgb(colour)) < 1e-5);
            for (int k = 1; k < coefficients; k++) {
                const double slope = (srgb(colour + 1e-7) - srgb(colour - 1e-7)) / 2e-7;
                const double stored = (double)plain[i].sh[3 * (k - 1) + c];
                CHECK(fabs((double)out[i].sh[3 * (k - 1) + c] - slope * stored) < 1e-3 * (1 + fabs(slope * stored)));
            }
        }
}

static void colour_spaces(void)
{
    static const struct { const char *text; int fails, is_linear; } cases[] = {
        {"\"colorSpace\":\"srgb_rec709_display\"", 0, 0}, {"\"kernel\":\"ellipse\"", 0, 0},
        {"\"colorSpace\":\"BT.709-srgb\"", 0, 0}, {"\"colorSpace\":\"lin_rec709_display\"", 0, 1},
        {"\"colorSpace\":\"BT.709-linear\"", 0, 1}, {"\"colorSpace\":\"linear\"", 0, 1}, {"\"colorSpace\":\"\"", 1, 0},
        {"\"colorSpace\":\"lin_p3d65_display\"", 1, 0}
    };
    add_all(1);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[100];
        snprintf(text, sizeof text, "\"KHR_gaussian_splatting\":{%s}", cases[i].text);
        write_json("{\"mesh\":0}", text, "");
        if (cases[i].fails)
            check_fails("\" is not read: expected srgb_rec709_display or lin_rec709_display");
        else {
            expect_read(read_glb(), COUNT);
            CHECK(info.linear_light == cases[i].is_linear && !info.log_scales);
            if (!cases[i].is_linear)
                memcpy(plain, out, sizeof plain);
            else
                check_srgb(1);
        }
    }
}

static void transforms(void)
{
    double r[3][3], m[3][3], shift[3] = {1.5, -2, 30};
    static const double scales[][3] = {{1, 1, 1}, {3, 3, 3}, {0.01, 0.01, 0.01}, {1, 2, 0.25}, {100, 1, 0.001}};
    rotation_matrix(0.1, 0.5, -0.7, 0.5, r);
    for (size_t k = 0; k < sizeof scales / sizeof *scales; k++) {
        char node[400];
        add_all(3);
        snprintf(node, sizeof node, "{\"mesh\":0,\"translation\":[1.5,-2,30],"
                 "\"rotation\":[0.2,1,-1.4,1],\"scale\":[%g,%g,%g]}", scales[k][0], scales[k][1], scales[k][2]);
        for (int i = 0; i < 9; i++)
            m[i / 3][i % 3] = r[i / 3][i % 3] * scales[k][i % 3];
        write_json(node, extension, "");
        expect_read(read_glb(), COUNT);
        check_gaussians(out, m, shift, r, 1e-5);
        snprintf(node, sizeof node, "{\"mesh\":0,\"matrix\":[%.17g,%.17g,%.17g,0,%.17g,%.17g,%.17g,0,"
                 "%.17g,%.17g,%.17g,0,1.5,-2,30,1]}", m[0][0], m[1][0], m[2][0], m[0][1], m[1][1], m[2][1],
                 m[0][2], m[1][2], m[2][2]);
        write_json(node, extension, "");
        expect_read(read_glb(), COUNT);
        check_gaussians(out, m, shift, r, 1e-5);
    }
}

static void nested_nodes(void)
{
    double turn[3][3] = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}, m[3][3], shift[3] = {2 * 3, 2 * 1, 2 * 2 + 7};
    add_all(2);
    for (int i = 0; i < 9; i++)
        m[i / 3][i % 3] = 2 * turn[i / 3][i % 3];
    write_json("{\"children\":[2,1],\"translation\":[0,0,7],\"scale\":[2,2,2]},{\"mesh\":0,\"translation\":[3,1,2],"
               "\"rotation\":[0.5,0.5,0.5,0.5]},{\"name\":\"empty\"}", extension, "");
    expect_read(read_glb(), COUNT);
    check_gaussians(out, m, shift, turn, 2e-6);
}

static void mirrored(void)
{
    double m[3][3] = {{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    add_all(3);
    write_json("{\"mesh\":0,\"scale\":[-1,1,1]}", extension, "");
    expect_read(read_glb(), COUNT);
    check_gaussians(out, m, nowhere, m, 2e-6);
}

static void several_parts(void)
{
    double shift[3] = {0, 10, 0};
    add_all(1);
    write_json("{\"children\":[1,2]},{\"mesh\":0},{\"mesh\":0,\"translation\":[0,10,0]}", extension, "");
    expect_read(read_glb(), 2 * COUNT);
    CHECK(info.count == 2 * COUNT);
    check_gaussians(out, identity, nowhere, identity, 2e-6);
    check_gaussians(out + COUNT, identity, shift, identity, 2e-6);
}

static void check_moved(int i, const double by[3])
{
    static const double signs[3] = {-1, -1, 1};
    for (int k = 0; k < 3; k++) {
        const double place = signs[k] * (info.origin[k] + (double)out[i].position[k]);
        CHECK(fabs(place - (double)(float)position[3 * (i % COUNT) + k] - by[k]) < 1e-6);
    }
}

static void far_nodes(void)
{
    static const double far[3] = {-500000.25, 4500000, 3}, also[3] = {-500000.25, 4500002, 3}, still[3] = {0};
    add_all(0);
    write_json("{\"children\":[1,2],\"translation\":[-500000.25,4500000,3]},{\"mesh\":0},{\"mesh\":0,"
               "\"translation\":[0,2,0]}", extension, "");
    expect_read(read_glb(), 2 * COUNT);
    CHECK(info.origin[0] == 500000 && info.origin[1] == -4500000 && info.origin[2] == 0 && info.coarse == 0);
    for (int i = 0; i < COUNT; i++) {
        check_moved(i, far);
        check_moved(COUNT + i, also);
    }
    write_json("{\"children\":[1,2]},{\"mesh\":0},{\"mesh\":0,\"translation\":[-500000,0,0]}", extension, "");
    expect_read(read_glb(), 2 * COUNT);
    CHECK(info.origin[0] == 0 && info.coarse == 0x1p-5);
    check_moved(0, still);
}

static void far_accessor(void)
{
    char rest[2048];
    add_all(0);
    for (int i = 0; i < COUNT; i++) {
        const float moved = (float)(position[3 * i] += 100000);
        memcpy(bin + 8 + 12 * i, &moved, sizeof moved);
        position[3 * i] = (double)moved;
    }
    char *end = strchr(accessors, '}');
    snprintf(rest, sizeof rest, "%s", end);
    snprintf(end, sizeof accessors - (size_t)(end - accessors), ",\"min\":[99996,-4,-4],\"max\":[100004,4,4]%s", rest);
    write_json("{\"mesh\":0,\"translation\":[-100000.1,0,0]}", extension, "");
    expect_read(read_glb(), COUNT);
    CHECK(info.origin[0] == 0 && info.coarse == 0);
    for (int i = 0; i < COUNT; i++)
        check_moved(i, (const double[3]){-100000.1, 0, 0});
}

static void put_base64(char *text, const uint8_t *bytes, size_t size)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        uint32_t word = (uint32_t)bytes[i] << 16 | (i + 1 < size ? (uint32_t)bytes[i + 1] << 8 : 0) |
                        (i + 2 < size ? bytes[i + 2] : 0u);
        append(text, "%c%c%c%c", digits[word >> 18], digits[word >> 12 & 63],
               i + 1 < size ? digits[word >> 6 & 63] : '=', i + 2 < size ? digits[word & 63] : '=');
    }
}

static long read_gltf(void)
{
    put_named("a.gltf", json, strlen(json));
    return read_scene("a.gltf", 3);
}

static void separate_buffers(void)
{
    static char uri[MAX_TEXT];
    for (int more = 0; more < 3; more++) {
        add_all(1);
        bin_size += (size_t)more;
        put_named("a b.bin", bin, bin_size);
        write_json("{\"mesh\":0}", extension, "\"uri\":\"a%20b.bin\",");
        expect_read(read_gltf(), COUNT);
        check_gaussians(out, identity, nowhere, identity, 2e-6);
        strcpy(uri, "\"uri\":\"data:application/octet-stream;base64,");
        put_base64(uri, bin, bin_size);
        append(uri, "\",");
        write_json("{\"mesh\":0}", extension, uri);
        expect_read(read_gltf(), COUNT);
        check_gaussians(out, identity, nowhere, identity, 2e-6);
    }
}

static void faulty_buffers(void)
{
    static const char *const cases[][2] = {
        {"\"uri\":\"../a.bin\",", "a URI that is not a file name in the same folder"},
        {"\"uri\":\"/etc/passwd\",", "a URI that is not a file name in the same folder"},
        {"\"uri\":\"..%2fa.bin\",", "a URI that is not a file name in the same folder"},
        {"\"uri\":\"\",", "a URI that is not a file name in the same folder"},
        {"\"uri\":\"..\",", "leaves the folder"}, {"\"uri\":\"c%3aa.bin\",", "leaves the folder"},
        {"\"uri\":\"..%5ca.bin\",", "leaves the folder"}, {"\"uri\":\"none.bin\",", "No such file"},
        {"\"uri\":\"short.bin\",", "buffer 0 has 7 bytes, not"},
        {"\"uri\":\"data:,abc\",", "not base64"}, {"\"uri\":\"data:;base64\",", "not base64"},
        {"\"uri\":\"data:;base64,AA*A\",", "not base64"},
        {"\"uri\":\"data:;base64,AAAA\",", "buffer 0 has 3 bytes, not"},
        {"", "buffer 0 has 0 bytes, not"}
    };
    put_named("short.bin", "1234567", 7);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        add_all(0);
        write_json("{\"mesh\":0}", extension, cases[i][0]);
        expect_fault(read_gltf(), cases[i][1]);
    }
}

static void make_spz(spz_bytes *s)
{
    memset(s, 0, sizeof *s);
    s->version = 2;
    s->count = COUNT;
    s->fractional_bits = 4;
    s->flags = 1;
    for (int i = 0; i < 9 * COUNT; i += 3)
        s->arrays[0][i] = (uint8_t)(i + 16);
    memset(s->arrays[4], 127, sizeof s->arrays[4]);
}

static int is_near(double a, double b)
{
    return fabs(a - b) < 1e-5;
}

static void replace(const char *old, const char *by)
{
    static char changed[MAX_TEXT];
    const char *at = strstr(json, old);
    if (!CHECK(at != NULL)) {
        printf("  no %s in %s\n", old, json);
        return;
    }
    snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - json), json, by, at + strlen(old));
    strcpy(json, changed);
}

static void compressed(void)
{
    static const char *const forms[] = {
        "\"KHR_gaussian_splatting\":{\"extensions\":{\"KHR_gaussian_splatting_compression_spz_2\":{\"bufferView\":1}}}",
        "\"KHR_gaussian_splatting\":{\"extensions\":{\"KHR_gaussian_splatting_compression_spz\":{\"bufferView\":1}}}",
        "\"KHR_spz_gaussian_splats_compression\":{\"bufferView\":1}"
    };
    static spz_bytes s;
    make_spz(&s);
    for (int i = 0; i < 3; i++) {
        clear();
        bin_size = 5 + spz_plain(&s, bin + 5);
        append(views, "{\"buffer\":0,\"byteLength\":1},{\"buffer\":0,\"byteOffset\":5,\"byteLength\":%zu}",
               bin_size - 5);
        write_json("{\"mesh\":0,\"scale\":[2,2,2]}", forms[i], "");
        expect_read(read_glb(), COUNT);
        CHECK(info.count == COUNT && info.antialiased && !info.log_scales && !info.clamped_opacity);
        for (int k = 0; k < COUNT; k++) {
            CHECK(out[k].position[0] == (float)-(9 * k + 16) / 8 && out[k].position[1] == (float)-(9 * k + 19) / 8 &&
                  out[k].position[2] == (float)(9 * k + 22) / 8);
            CHECK(fabs(out[k].scale[0] - (log(2) - 10)) < 1e-5);
        }
        bin[5 + 8]++;
        check_fails("bytes of attributes, there are");
    }
}

static void opacities_beside_spz(void)
{
    static const char *const forms[] = {
        "\"KHR_gaussian_splatting\":{\"extensions\":{\"KHR_gaussian_splatting_compression_spz_2\":{\"bufferView\":1},"
        "\"EXT_splat_opacity\":{\"opacityAccessor\":0}}}",
        "\"KHR_gaussian_splatting\":{\"extensions\":{\"KHR_gaussian_splatting_compression_spz_2\":{\"bufferView\":1}}},"
        "\"EXT_splat_opacity\":{\"opacityAccessor\":0}"
    };
    static const double values[COUNT] = {0.5, 1.5, -1, NAN, 0.125};
    static spz_bytes s;
    make_spz(&s);
    memset(s.arrays[1], 255, sizeof s.arrays[1]);
    for (int i = 0; i < 2; i++) {
        clear();
        add("OPACITY", 1, FLOAT, 0, 0, values);
        const size_t start = bin_size;
        bin_size += spz_plain(&s, bin + start);
        append(views, ",{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu}", start, bin_size - start);
        write_json("{\"mesh\":0}", forms[i], "");
        expect_read(read_glb(), COUNT);
        CHECK(info.clamped_opacity && is_near(out[0].opacity, 0) && out[1].opacity == 20 && out[2].opacity == 20 &&
              out[3].opacity == 20 && is_near(out[4].opacity, log(0.125 / 0.875)));
        replace("\"count\":5", "\"count\":4");
        check_fails("differ in count");
    }
    write_json("{\"mesh\":0}", forms[0], "");
    replace("opacityAccessor", "sourceOpacityAccessor");
    expect_read(read_glb(), COUNT);
    CHECK(info.clamped_opacity && out[0].opacity == 20);
}

static void opacities_out_of_range(void)
{
    add_all(0);
    write_json("{\"mesh\":0}", extension, "");
    expect_read(read_glb(), COUNT);
    CHECK(!info.clamped_opacity);
    clear();
    static const double values[COUNT] = {1.5, NAN, INFINITY, -0.5, 1};
    add("POSITION", 3, FLOAT, 0, 0, position);
    add("ROTATION", 4, FLOAT, 0, 4, rotation);
    add("SCALE", 3, FLOAT, 0, 0, scale);
    add("OPACITY", 1, FLOAT, 0, 0, values);
    add_sh(0);
    write_json("{\"mesh\":0}", extension, "");
    expect_read(read_glb(), COUNT);
    CHECK(info.clamped_opacity && out[0].opacity == 20 && isnan(out[1].opacity) && out[2].opacity == 20 &&
          out[3].opacity == -20 && out[4].opacity == 20);
}

/* Makes a .glb that replaces two positions by a sparse accessor. Without a base (has_base 0), all other
   positions are 0. */
static void make_sparse(int type, const uint32_t indices[2], int has_base)
{
    char text[256];
    add_all(0);
    const size_t start = bin_size;
    for (int i = 0; i < 2; i++, bin_size += (size_t)(type == UBYTE ? 1 : type == USHORT ? 2 : 4))
        spz_put(bin + bin_size, indices[i], 4);
    append(views, ",{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu}", start, bin_size - start);
    append(views, ",{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":24}", bin_size);
    for (int c = 0; c < 6; c++)
        put_component(FLOAT, 0, 10 + c);
    write_json("{\"mesh\":0}", extension, "");
    snprintf(text, sizeof text, "%s\"sparse\":{\"count\":2,\"indices\":{\"bufferView\":%d,\"componentType\":%d},"
             "\"values\":{\"bufferView\":%d}},", has_base ? "\"bufferView\":0,\"byteOffset\":4," : "",
             accessor_count, type, accessor_count + 1);
    replace("\"bufferView\":0,\"byteOffset\":4,", text);
}

static void sparse(void)
{
    static const uint32_t indices[2] = {1, 3};
    for (int type = UBYTE; type <= 5125; type += 2)
        for (int has_base = 0; has_base < 2; has_base++) {
            make_sparse(type, indices, has_base);
            expect_read(read_glb(), COUNT);
            for (int i = 0; i < COUNT; i++)
                for (int c = 0; c < 3; c++) {
                    const double own = has_base ? position[3 * i + c] : 0;
                    const double want = i == 1 ? 10 + c : i == 3 ? 13 + c : own;
                    CHECK(out[i].position[c] == (float)(c < 2 ? -want : want));
                }
        }
}

static void faulty_sparse(void)
{
    static const uint32_t good[2] = {1, 3}, wrong[][2] = {{3, 1}, {2, 2}, {1, 5}, {5, 6}, {4, 0xffffffff}};
    static const char *const cases[][3] = {
        {"\"sparse\":{\"count\":2", "\"sparse\":{\"count\":6", "no valid count or componentType in sparse"},
        {"\"sparse\":{\"count\":2", "\"sparse\":{\"count\":0", "no valid count or componentType in sparse"},
        {"\"sparse\":{\"count\":2", "\"sparse\":{\"count\":3", "accessor 0: not within its bufferView"},
        {"\"componentType\":5125", "\"componentType\":5124", "no valid count or componentType in sparse"},
        {"\"componentType\":5125", "\"componentType\":5126", "no valid count or componentType in sparse"},
        {"\"indices\":{\"bufferView\":5", "\"indices\":{\"bufferView\":9", "accessor 0: no valid bufferView"},
        {"\"values\":{\"bufferView\":6", "\"values\":{\"byteOffset\":4,\"bufferView\":6",
         "accessor 0: not within its bufferView"},
        {"\"values\":{\"bufferView\":6", "\"values\":{\"bufferView\":1", "accessor 0: a byteStride in sparse"},
        {"\"values\"", "\"valuez\"", "accessor 0: no valid bufferView"}
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        make_sparse(5125, wrong[i], 1);
        check_fails("indices of a sparse accessor that do not ascend, or are beyond its elements");
    }
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        make_sparse(5125, good, 1);
        replace(cases[i][0], cases[i][1]);
        check_fails(cases[i][2]);
    }
}

static void zeros(void)
{
    add_all(1);
    write_json("{\"mesh\":0}", extension, "");
    replace("\"bufferView\":0,\"byteOffset\":4,", "");
    replace("\"bufferView\":5,\"byteOffset\":4,", "");
    expect_read(read_glb(), COUNT);
    for (int i = 0; i < COUNT; i++)
        CHECK(out[i].position[0] == 0 && out[i].position[2] == 0 && is_near(out[i].sh[0], 0) && out[i].sh[3] != 0);
    add_all(0);
    write_json("{\"mesh\":0}", extension, "");
    for (int i = 0; i < accessor_count; i++) {
        char text[64];
        snprintf(text, sizeof text, "{\"bufferView\":%d,\"byteOffset\":4,", i);
        replace(text, "{");
        replace("\"count\":5", "\"count\":2147483647");
    }
    check_fails("no accessor of a primitive with Gaussians has data for each of them");
}

static void quantized_positions(void)
{
    double whole[3 * COUNT];
    add_all(0);
    clear();
    for (int i = 0; i < 3 * COUNT; i++)
        whole[i] = 100 * i - 700;
    add("POSITION", 3, SHORT, 0, 2, whole);
    add("ROTATION", 4, FLOAT, 0, 4, rotation);
    add("SCALE", 3, FLOAT, 0, 0, scale);
    add("OPACITY", 1, FLOAT, 0, 0, opacity);
    add_sh(0);
    write_json("{\"mesh\":0}", extension, "");
    check_fails("accessor 0: not of a type that POSITION may have");
    replace("\"scenes\"", "\"extensionsUsed\":[\"KHR_gaussian_splatting\",\"KHR_mesh_quantization\"],\"scenes\"");
    expect_read(read_glb(), COUNT);
    for (int i = 0; i < COUNT; i++)
        CHECK(out[i].position[0] == (float)-whole[3 * i] && out[i].position[2] == (float)whole[3 * i + 2]);
}

static void faulty_text(void)
{
    /* each case: a text of the file, the text that replaces it, the expected error message */
    static const char *const cases[][3] = {
        {"\"2.0\"", "\"1.0\"", "not glTF 2"}, {"\"version\"", "\"verzion\"", "not glTF 2"},
        {"\"scenes\":[", "\"scenes\":[,", "bad JSON"},
        {"\"scenes\"", "\"scanes\"", "no primitive with KHR_gaussian_splatting"},
        {"\"nodes\":[0]", "\"nodes\":[1]", "a node that does not exist"},
        {"\"nodes\":[0]", "\"nodes\":[-1]", "a node that does not exist"},
        {"\"nodes\":[0]", "\"nodes\":[0.5]", "a node that does not exist"},
        {"\"nodes\":[0]", "\"nodes\":[0,0]", "node 0: reached twice"},
        {"{\"mesh\":0}", "{\"mesh\":1}", "node 0: a mesh that does not exist"},
        {"{\"mesh\":0}", "{\"mesh\":0,\"children\":[0]}", "node 0: reached twice"},
        {"{\"mesh\":0}", "{\"mesh\":0,\"matrix\":[1,2]}", "node 0: not a matrix"},
        {"{\"mesh\":0}", "{\"mesh\":0,\"matrix\":[1,0,0,1,0,1,0,0,0,0,1,0,0,0,0,1]}", "node 0: not a matrix"},
        {"{\"mesh\":0}", "{\"mesh\":0,\"scale\":[1,2]}", "node 0: not 3 numbers"},
        {"{\"mesh\":0}", "{\"mesh\":0,\"scale\":[1,0,1]}", "has no inverse"},
        {"{\"mesh\":0}", "{\"mesh\":0,\"scale\":[1,1e999,1]}", "has no inverse"},
        {"{\"mesh\":0}", "{\"mesh\":0,\"rotation\":[0,0,0,0]}", "has no inverse"},
        {"KHR_gaussian_splatting\":{", "KHR_other\":{",
         "no primitive with KHR_gaussian_splatting in the scene, which is a point cloud, not Gaussians"},
        {"ellipse", "gausses", "kernel \"gausses\" is not read"},
        {"ellipse", "g\\u000as\\u007f", "kernel \"g?s?\" is not read"},
        {"\"POSITION\"", "\"POSITIONS\"", "no accessor for POSITION"},
        {":SCALE", ":SCALES", "no accessor for KHR_gaussian_splatting:SCALE"},
        {"DEGREE_0_COEF_0", "DEGREE_0_COEF_1", "no accessor for KHR_gaussian_splatting:SH_DEGREE_0_COEF_0"},
        {"DEGREE_1_COEF_2", "DEGREE_1_COEF_3", "no accessor for KHR_gaussian_splatting:SH_DEGREE_1_COEF_2"},
        {"\"POSITION\":0", "\"POSITION\":90", "no accessor for POSITION"},
        {"5126", "5123", "accessor 0: not of a type that POSITION may have"},
        {"5126", "5120", "accessor 0: not of a type that POSITION may have"},
        {"5126", "\"a\"", "accessor 0: not of a type that POSITION may have"},
        {"5126", "99999999999999999999", "accessor 0: not of a type that POSITION may have"},
        {"VEC3", "VEC4", "accessor 0: not of a type that POSITION may have"},
        {"\"count\":5", "\"count\":4", "differ in count"},
        {"\"count\":5", "\"count\":6", "accessor 0: not within its bufferView"},
        {"\"count\":5", "\"count\":2147483648", "accessor 0: no valid count"},
        {"\"count\":5", "\"count\":-5", "accessor 0: no valid count"},
        {"\"count\":5", "\"sparse\":{},\"count\":5", "accessor 0: no valid count or componentType in sparse"},
        {"\"bufferView\":0", "\"bufferView\":99", "accessor 0: no valid bufferView"},
        {"\"bufferView\":0,\"byteOffset\":4", "\"bufferView\":0,\"byteOffset\":5",
         "accessor 0: not within its bufferView"},
        {"\"bufferView\":0,\"byteOffset\":4", "\"bufferView\":0,\"byteOffset\":9007199254740991",
         "accessor 0: not within its bufferView"},
        {"\"byteStride\":20", "\"byteStride\":15", "accessor 1: no valid count or byteStride"},
        {"\"byteStride\":20", "\"byteStride\":253", "accessor 1: no valid count or byteStride"},
        {"\"buffer\":0", "\"buffer\":1", "bufferView 0: no valid buffer"},
        {"\"byteOffset\":4,\"byteLength\":64", "\"byteOffset\":9999,\"byteLength\":64",
         "bufferView 0: not within its buffer"},
        {"\"byteOffset\":4,\"byteLength\":64", "\"byteOffset\":4,\"byteLength\":9007199254740991",
         "bufferView 0: not within its buffer"},
        {"\"buffer\":0", "\"extensions\":{\"EXT_meshopt_compression\":{}},\"buffer\":0",
         "meshopt compression is not read"},
        {"\"buffers\":[{", "\"buffers\":[{\"byteLength\":0,", "buffer 0: no byteLength above 0"},
        {"\"buffers\":[{", "\"buffers\":[{\"byteLength\":99999,", "bytes, not 99999"},
        {"\"buffers\":", "\"bufferz\":", "bufferView 0: no valid buffer"}
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        add_all(1);
        write_json("{\"mesh\":0}", extension, "");
        replace(cases[i][0], cases[i][1]);
        check_fails(cases[i][2]);
    }
}

static void many_of_all(void)
{
    static char text[MAX_TEXT];
    add_all(0);
    strcpy(text, "{\"children\":[1");
    for (int i = 2; i < 1030; i++)
        append(text, ",%d", i);
    append(text, "]}");
    for (int i = 1; i < 1030; i++)
        append(text, ",{\"mesh\":0}");
    write_json(text, extension, "");
    check_fails("more than 1024 primitives with Gaussians");
    strcpy(text, "{\"mesh\":0");
    for (int i = 0; i < 1030; i++)
        append(text, ",\"a\":0");
    append(text, "}");
    write_json(text, extension, "");
    check_fails("nodes 0: too many members");
}

static void deep_nodes(void)
{
    static char nodes[MAX_TEXT];
    nodes[0] = '\0';
    for (int i = 0; i < 70; i++)
        append(nodes, "{\"children\":[%d]},", i + 1);
    append(nodes, "{\"mesh\":0}");
    add_all(0);
    write_json(nodes, extension, "");
    check_fails("node 65: nested too deep");
}

static void faulty_containers(void)
{
    static const struct { int offset; uint32_t value; const char *text; } cases[] = {
        {4, 1, "glTF version 1, not 2"}, {8, 19, "the file ends early"}, {8, 0xffffffff, "the file ends early"},
        {12, 0xfffffff0, "the file ends early"}, {12, 5, "bad JSON"}, {16, 0, "the first chunk is not JSON"}
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        add_all(0);
        write_json("{\"mesh\":0}", extension, "");
        make_glb();
        spz_put(file_bytes + cases[i].offset, cases[i].value, 4);
        put_named("a.glb", file_bytes, file_size);
        expect_fault(read_scene("a.glb", 3), cases[i].text);
    }
}

/* Compares a real scene as .gltf with its .ply, which has z up. 3D Tiles map glTF's y up to z up by (x, y, z) ->
   (x, -z, y). */
static void real_scene(void)
{
    const char *scenes = getenv("FXS_SCENES") ? getenv("FXS_SCENES") : "../shared/scenes";
    static fxs_gaussian g[2][1000];
    double turn[3][3] = {{-1, 0, 0}, {0, 0, -1}, {0, -1, 0}};
    fxs_scene_file *files[2];
    fxs_scene_file_info infos[2];
    char name[1024];
    long count;
    double worst = 0, turned = 0;
    for (int i = 0; i < 2; i++) {
        snprintf(name, sizeof name, "%s/boatyard-tile3/boatyard-tile3.%s", scenes, i ? "ply" : "glb");
        if (access(name, R_OK) != 0)
            SKIP("no such scene; set FXS_SCENES");
        if (fxs_scene_file_open(name, NULL, &files[i], &infos[i], &message) != 0) {
            CHECK(strstr(message.text, "built without zlib"));
            SKIP(message.text);
        }
    }
    CHECK(infos[0].count == infos[1].count && infos[0].sh_degree == 3 && !infos[0].antialiased);
    while ((count = fxs_scene_file_read(files[0], g[0], 1000, &message)) > 0) {
        CHECK(fxs_scene_file_read(files[1], g[1], 1000, &message) == count);
        for (long i = 0; i < count; i++) {
            const fxs_gaussian *a = &g[0][i], *b = &g[1][i];
            double r[3][3], tr[3][3], got[3][3], d[3] = {0.6, -0.64, 0.48}, td[3], ka[15], kb[15];
            rotation_matrix(b->rotation[1], b->rotation[2], b->rotation[3], b->rotation[0], r);
            multiply(turn, r, tr);
            rotation_matrix(a->rotation[1], a->rotation[2], a->rotation[3], a->rotation[0], got);
            for (int k = 0; k < 3; k++) {
                const float *p = b->position;
                worst = fmax(worst, fabs(a->position[k] - (turn[k][0] * p[0] + turn[k][1] * p[1] + turn[k][2] * p[2])));
                worst = fmax(worst, fabs((double)a->scale[k] - b->scale[k]));
                worst = fmax(worst, fabs((double)a->dc[k] - b->dc[k]));
                td[k] = turn[k][0] * d[0] + turn[k][1] * d[1] + turn[k][2] * d[2];
            }
            for (int k = 0; k < 9; k++)
                turned = fmax(turned, fabs(tr[k / 3][k % 3] - got[k / 3][k % 3]));
            for (int k = 0; k < 15; k++) {
                ka[k] = a->sh[3 * k];
                kb[k] = b->sh[3 * k];
            }
            worst = fmax(worst, fabs(colour(ka, td) - colour(kb, d)));
            worst = fmax(worst, fabs(1 / (1 + exp(-a->opacity)) - 1 / (1 + exp(-b->opacity))));
        }
    }
    CHECK(count == 0 && worst < 2e-5 && turned < 1e-5);
    printf("  worst difference %g, of the rotation %g\n", worst, turned);
    fxs_scene_file_close(files[0]);
    fxs_scene_file_close(files[1]);
}

static void remove_files(void)
{
    static const char *const names[] = {"a.glb", "a.gltf", "a.bin", "a b.bin", "short.bin"};
    char full[128];
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        snprintf(full, sizeof full, "%s/%s", folder, names[i]);
        unlink(full);
    }
    rmdir(folder);
}

int main(void)
{
    if (!mkdtemp(folder)) {
        perror(folder);
        return 1;
    }
    RUN(every_degree);
    RUN(every_type);
    RUN(extreme_values);
    RUN(log_scales);
    RUN(log_scales_of_a_file);
    RUN(draft_names);
    RUN(colour_spaces);
    RUN(transforms);
    RUN(nested_nodes);
    RUN(mirrored);
    RUN(several_parts);
    RUN(far_nodes);
    RUN(far_accessor);
    RUN(separate_buffers);
    RUN(faulty_buffers);
    RUN(compressed);
    RUN(opacities_beside_spz);
    RUN(opacities_out_of_range);
    RUN(sparse);
    RUN(faulty_sparse);
    RUN(zeros);
    RUN(quantized_positions);
    RUN(faulty_text);
    RUN(many_of_all);
    RUN(deep_nodes);
    RUN(faulty_containers);
    RUN(real_scene);
    remove_files();
    return check_report();
}

#else

static void gltf(void)
{
    SKIP("built without cJSON");
}

int main(void)
{
    RUN(gltf);
    return check_report();
}

#endif
