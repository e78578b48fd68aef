/* Reads the compressed .ply of PlayCanvas: synthetic files, faulty files, a real scene. */
#include "scene_bytes.h"

enum { MANY = 300, FEW = 3, BOUNDS = 18 };

static const char *const bounds[BOUNDS] = {
    "min_x", "min_y", "min_z", "max_x", "max_y", "max_z",
    "min_scale_x", "min_scale_y", "min_scale_z", "max_scale_x", "max_scale_y", "max_scale_z",
    "min_r", "min_g", "min_b", "max_r", "max_g", "max_b"
};

static fxs_gaussian gaussians[MANY], expected[MANY];
static uint32_t state;

static uint32_t random_word(void)
{
    state = state * 1664525u + 1013904223u;
    return state ^ state >> 15;
}

static void put_properties(const char *type, const char *const *names, int count)
{
    for (int i = 0; i < count; i++)
        put("property %s %s\n", type, names[i]);
}

static void put_header(int count, int has_colour, int rest)
{
    put("ply\nformat binary_little_endian 1.0\ncomment antialiased 1\nelement chunk %d\n", (count + 255) / 256);
    put_properties("float", bounds, has_colour ? 18 : 12);
    put("element vertex %d\nproperty uint packed_scale\nproperty uchar extra\nproperty uint packed_position\n", count);
    put("property uint packed_color\nproperty uint packed_rotation\n");
    if (rest)
        put("element sh %d\n", count);
    for (int i = rest - 1; i >= 0; i--)
        put("property uchar f_rest_%d\n", i);
    put("end_header\n");
}

static void expect_words(fxs_gaussian *g, const float *b, const uint32_t words[4])
{
    static const uint32_t codes[3] = {2047, 1023, 2047};
    static const int shifts[3] = {21, 11, 0};
    double rest = 1;
    for (int i = 0; i < 3; i++) {
        double t = (words[0] >> shifts[i] & codes[i]) / (double)codes[i];
        g->position[i] = (float)((double)b[i] + ((double)b[3 + i] - (double)b[i]) * t);
        t = (words[2] >> shifts[i] & codes[i]) / (double)codes[i];
        g->scale[i] = (float)((double)b[6 + i] + ((double)b[9 + i] - (double)b[6 + i]) * t);
        t = (words[3] >> (24 - 8 * i) & 255) / 255.0;
        t = (double)b[12 + i] + ((double)b[15 + i] - (double)b[12 + i]) * t;
        g->dc[i] = (float)((t - 0.5) / 0.28209479177387814);
    }
    for (uint32_t i = 0, k = 0; i < 4; i++)
        if (i != words[1] >> 30) {
            double q = ((words[1] >> (20 - 10 * k++) & 1023) / 1023.0 - 0.5) * sqrt(2);
            g->rotation[i] = (float)q;
            rest -= q * q;
        }
    g->rotation[words[1] >> 30] = (float)sqrt(rest > 0 ? rest : 0);
    double alpha = (words[3] & 255) / 255.0;
    g->opacity = (float)fmax(-20, fmin(20, log(alpha / (1 - alpha))));
}

static void make_file(int count, int has_colour, int rest)
{
    float chunk[2][BOUNDS];
    size = 0;
    state = 1;
    memset(expected, 0, sizeof expected);
    put_header(count, has_colour, rest);
    for (int c = 0; c < (count + 255) / 256; c++)
        for (int i = 0; i < BOUNDS; i++) {
            chunk[c][i] = (float)(random_word() % 1000) / 64 - 8;
            if (has_colour || i < 12)
                put_float(chunk[c][i]);
            else
                chunk[c][i] = i >= 15;
        }
    for (int row = 0; row < count; row++) {
        uint32_t words[4] = {random_word(), random_word(), random_word(), random_word()};
        put_u32(words[2]);
        put_u8(7);
        put_u32(words[0]);
        put_u32(words[3]);
        put_u32(words[1]);
        expect_words(&expected[row], chunk[row / 256], words);
    }
    for (int row = 0; row < count; row++)
        for (int i = rest - 1; i >= 0; i--) {
            int code = i == 0 ? 255 * (row % 2) : (int)(random_word() % 256), k = i % (rest / 3);
            put_u8(code);
            if (k < 15)
                expected[row].sh[3 * k + i / (rest / 3)] =
                    code == 0 ? -4 : code == 255 ? 4 : (float)(code + 0.5) / 32 - 4;
        }
}

static void check_file(int count, int degree)
{
    put_file(size);
    if (!CHECK(read_file(gaussians, MANY) == 0)) {
        printf("  %s\n", message.text);
        return;
    }
    CHECK(info.count == (uint64_t)count && info.sh_degree == (degree < 3 ? degree : 3) && info.antialiased);
    CHECK(info.stored_sh_degree == degree);
    CHECK(strcmp(info.format, "compressed ply") == 0);
    for (int row = 0; row < count; row++) {
        CHECK(is_same(&gaussians[row], &expected[row], 1e-6));
        CHECK(is_near((double)gaussians[row].opacity, (double)expected[row].opacity, 1e-6));
    }
}

static void every_kind(void)
{
    static const int rests[] = {0, 9, 24, 45, 72}, counts[] = {0, 1, 255, 256, 257, MANY};
    for (int degree = 0; degree < 5; degree++)
        for (int has_colour = 0; has_colour < 2; has_colour++)
            for (int i = 0; i < 6; i++) {
                make_file(counts[i], has_colour, rests[degree]);
                check_file(counts[i], degree);
            }
}

static void replace(const char *from, const char *to)
{
    char *at = strstr((char *)bytes, from);
    if (!CHECK(at != NULL))
        return;
    size_t tail = size - (size_t)((uint8_t *)at - bytes) - strlen(from);
    memmove(at + strlen(to), at + strlen(from), tail);
    memcpy(at, to, strlen(to));
    size += strlen(to) - strlen(from);
}

static void faulty_headers(void)
{
    static const char *const cases[][3] = {
        {"binary_little_endian", "binary_big_endian", "a compressed .ply that is not binary_little_endian"},
        {"binary_little_endian", "ascii", "a compressed .ply that is not binary_little_endian"},
        {"element chunk", "element chunks", "the header has no element chunk"},
        {"chunk 2", "chunk 1", "1 chunks for 300 Gaussians, not one for every 256"},
        {"chunk 2", "chunk 3", "3 chunks for 300 Gaussians, not one for every 256"},
        {"float min_y", "float mini_y", "element chunk has no property min_y of type float"},
        {"float max_scale_z", "double max_scale_z", "element chunk has no property max_scale_z of type float"},
        {"float max_b", "float max_blue", "element chunk has no property max_b of type float"},
        {"packed_rotation", "rotation", "element vertex has no property packed_rotation of type uint"},
        {"uint packed_color", "int packed_color", "element vertex has no property packed_color of type uint"},
        {"uint packed_color", "uint packed_scale", "a second property \"packed_scale\""},
        {"element sh 300", "element sh 299", "SH coefficients for 299 of 300 Gaussians"},
        {"uchar f_rest_3", "char f_rest_3", "element sh has no property f_rest_3 of type uchar"},
        {"uchar f_rest_3", "uchar f_rest_9", "element sh has no property f_rest_3"},
        {"uchar f_rest_3", "uchar other", "8 f_rest_* properties, not 0, 9, 24, 45 or 72"},
        {"element sh", "element face 1\nproperty list uchar int index\nelement sh", "element face has lists"},
        {"vertex 300", "vertex 2147483647", "chunks for 2147483647 Gaussians"}
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        make_file(MANY, 1, 9);
        replace(cases[i][0], cases[i][1]);
        check_fails(cases[i][2]);
    }
}

static void absurd_count(void)
{
    make_file(MANY, 1, 0);
    replace("chunk 2", "chunk 8388608");
    replace("vertex 300", "vertex 2147483647");
    check_fails("the header asks for at least");
}

static void other_elements(void)
{
    make_file(FEW, 0, 0);
    replace("element vertex", "element other 0\nproperty double a\nelement vertex");
    check_file(FEW, 0);
}

static void real_scene(void)
{
    if (access(scenes_folder(), R_OK) != 0)
        SKIP("no folder of scenes; set FXS_SCENES");
    check_same_scenes("guitar/guitar.compressed.ply", "guitar/guitar.ply", 2e-6);
}

int main(void)
{
    RUN(every_kind);
    RUN(faulty_headers);
    RUN(absurd_count);
    RUN(other_elements);
    RUN(real_scene);
    return check_report();
}
