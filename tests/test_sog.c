/* Reads .sog files that the test makes: both versions, every SH degree, zips and folders, streamed scenes, faulty
   files. */
#include <fixsplat/internal/sound.h>

#include <math.h>
#include <stdint.h>

#include "folder.h"

static fxs_message message;
static fxs_scene_file_info info;

/* Reads the scene twice, a few Gaussians in each call. Returns the number of Gaussians, or -1. */
static long read_level(const char *name, int level, fxs_gaussian *gaussians, long capacity)
{
    fxs_scene_file *file;
    const fxs_scene_file_options options = {.size = sizeof(fxs_scene_file_options), .level = level};
    long total[2] = {0, 0}, count = 0;
    memset(&info, 0, sizeof info);
    const int error = fxs_scene_file_open(in_folder(name), &options, &file, &info, &message);
    if (error) {
        CHECK(file == NULL && strncmp(message.text, folder, strlen(folder)) == 0 && !strchr(message.text, '\n'));
        return error;
    }
    for (int pass = 0; pass < 2 && count >= 0; pass++) {
        while ((count = fxs_scene_file_read(file, gaussians + total[pass], (size_t)(capacity - total[pass] < 10
                ? capacity - total[pass] : 10), &message)) > 0)
            total[pass] += count;
        CHECK(fxs_scene_file_rewind(file, &message) == 0);
    }
    fxs_scene_file_close(file);
    if (count < 0)
        return count;
    CHECK(total[0] == total[1] && total[0] == (long)info.count &&
          strcmp(info.format, strstr(name, ".lcc2") ? "lcc2" : "sog") == 0);
    return total[0];
}

static void check_level_fails(const char *name, int level, const char *words)
{
    static fxs_gaussian gaussians[1000];
    const int error = level ? FXS_ERR_ARGUMENT : strstr(words, "built without") ? FXS_ERR_UNSUPPORTED : FXS_ERR_FILE;
    if (!CHECK(read_level(name, level, gaussians, 1000) == error && strstr(message.text, words)))
        printf("  said: %s\n  not:  %s\n", message.text, words);
}

static void check_fails(const char *name, const char *words)
{
    check_level_fails(name, 0, words);
}

#if defined(FXS_WITH_WEBP) && defined(FXS_WITH_CJSON) && defined(FXS_WITH_ZIP)

#include <webp/encode.h>
#include <zip.h>

enum { COUNT = 37, WIDTH = 7, HEIGHT = 6, PALETTE = 300, PALETTE_ROWS = 5 };
enum { LOW, HIGH, SCALES, QUATS, SH0, CENTROIDS, LABELS, TIMES_LOW, TIMES_HIGH, VELOCITIES_LOW, VELOCITIES_HIGH,
       IMAGES };
enum { SCALE_VALUES, COLOUR_VALUES, SH_VALUES };

static const char *const image_names[IMAGES] = {"low.webp", "high.webp", "scales.webp", "quats.webp", "sh0.webp",
                                                "centroids.webp", "labels.webp", "tl", "th", "vl", "vh"};

typedef struct made_scene {
    int version, degree;
    unsigned seed;
} made_scene;

static struct made_file { char name[32]; void *data; size_t size; } files[IMAGES + 4];
static int file_count;

static void forget_files(void)
{
    while (file_count > 0)
        free(files[--file_count].data);
}

static void add_file(const char *name, const void *data, size_t size)
{
    snprintf(files[file_count].name, sizeof files->name, "%s", name);
    files[file_count].data = malloc(size + 1);
    memcpy(files[file_count].data, data, size);
    ((char *)files[file_count].data)[size] = 0;
    files[file_count++].size = size;
}

static int coefficients(int degree)
{
    return degree * (degree + 2);
}

/* Returns a byte of an image of the test's .sog. Gaussian 0 is opaque with scale code 0. Gaussian 1 has opacity
   0. */
static uint8_t byte_of(const made_scene *m, int image, int pixel, int channel)
{
    unsigned h = m->seed * 977u + (unsigned)image * 131u + (unsigned)pixel * 7919u;
    unsigned label = (h * 2654435761u >> 12) % (64 * PALETTE_ROWS);
    if (image == LABELS && channel < 2)
        return (uint8_t)(label >> 8 * channel);
    h = ((h + (unsigned)channel * 31u) * 2654435761u) >> 20;
    if (image == QUATS && channel == 3)
        return (uint8_t)(250 + h % 6);
    if ((image == SCALES && pixel == 0 && channel == 1) || (image == SH0 && pixel == 1 && channel == 3))
        return 0;
    if (image == SH0 && channel == 3)
        return (uint8_t)(pixel == 0 ? 255 : h);
    return (uint8_t)(channel == 3 ? 255 : h);
}

/* Encodes a WebP losslessly. WebPEncodeLosslessRGBA is not used, since it would change colours where alpha is 0. */
static void encode(const uint8_t *rgba, int width, int height, WebPMemoryWriter *out)
{
    WebPConfig config;
    WebPPicture picture;
    CHECK(WebPConfigInit(&config) && WebPPictureInit(&picture));
    config.lossless = config.exact = picture.use_argb = 1;
    picture.width = width;
    picture.height = height;
    picture.writer = WebPMemoryWrite;
    picture.custom_ptr = out;
    WebPMemoryWriterInit(out);
    CHECK(WebPPictureImportRGBA(&picture, rgba, 4 * width) && WebPEncode(&config, &picture));
    WebPPictureFree(&picture);
}

static void add_image(const made_scene *m, int image, int width, int height)
{
    static uint8_t rgba[960 * HEIGHT * 4];
    WebPMemoryWriter out;
    for (int i = 0; i < 4 * width * height; i++)
        rgba[i] = byte_of(m, image, i / 4, i % 4);
    encode(rgba, width, height, &out);
    add_file(image_names[image], out.mem, out.size);
    WebPMemoryWriterClear(&out);
}

static const double position_mins[3] = {-3.25, -0.5, 0.125}, position_maxs[3] = {2.5, 4.75, 6};

static double codebook(int values, int code)
{
    return (code - 100) / 32.0 + values;
}

static double bound(int values, int channel, int high)
{
    return high ? 2.25 + channel : -1.5 - 0.25 * values - channel;
}

static void say_codebook(int values)
{
    say("\"codebook\":[");
    for (int i = 0; i < 256; i++)
        say("%s%.17g", i ? "," : "", codebook(values, i));
    say("],");
}

static void say_bounds(int values, int channels)
{
    for (int high = 0; high < 2; high++) {
        say("\"%s\":%s", high ? "maxs" : "mins", channels > 1 ? "[" : "");
        for (int c = 0; c < channels; c++)
            say("%s%.17g", c ? "," : "", bound(values, c, high));
        say("%s,", channels > 1 ? "]" : "");
    }
}

static void say_values(const made_scene *m, const char *name, int values, int channels)
{
    say(",\"%s\":{", name);
    if (m->version == 2)
        say_codebook(values);
    else
        say_bounds(values, channels);
}

static void add_meta(const made_scene *m)
{
    length = 0;
    say(m->version == 2 ? "{\"version\":2,\"count\":%d,\"means\":{" : "{\"means\":{\"shape\":[%d,3],", COUNT);
    say("\"mins\":[%g,%g,%g],\"maxs\":[%g,%g,%g],\"files\":[\"low.webp\",\"high.webp\"]}", position_mins[0],
        position_mins[1], position_mins[2], position_maxs[0], position_maxs[1], position_maxs[2]);
    say_values(m, "scales", SCALE_VALUES, 3);
    say("\"files\":[\"scales.webp\"]},\"quats\":{\"files\":[\"quats.webp\"]}");
    say_values(m, "sh0", COLOUR_VALUES, 4);
    say("\"files\":[\"sh0.webp\"]}");
    if (m->degree) {
        say_values(m, "shN", SH_VALUES, 1);
        if (m->version == 2)
            say("\"count\":%d,\"bands\":%d,", PALETTE, m->degree);
        say("\"files\":[\"centroids.webp\",\"labels.webp\"]}");
    }
    say("}");
    add_file("meta.json", text, length);
}

static void make(const made_scene *m)
{
    forget_files();
    for (int image = LOW; image <= SH0; image++)
        add_image(m, image, WIDTH, HEIGHT);
    if (m->degree) {
        add_image(m, CENTROIDS, 64 * coefficients(m->degree), PALETTE_ROWS);
        add_image(m, LABELS, WIDTH, HEIGHT);
    }
    add_meta(m);
}

static void edit(const char *old, const char *new)
{
    char *meta = files[file_count - 1].data, *found = strstr(meta, old);
    if (!CHECK(found != NULL))
        return;
    length = 0;
    say("%.*s%s%s", (int)(found - meta), meta, new, found + strlen(old));
    free(files[--file_count].data);
    add_file("meta.json", text, length);
}

static void put_folder(const char *name)
{
    char path[512];
    mkdir(in_folder(name), 0700);
    for (int i = 0; i < file_count; i++) {
        snprintf(path, sizeof path, "%s/%.31s", name, files[i].name);
        put_file(path, files[i].data, files[i].size);
    }
}

static void put_zip_in(const char *name, const char *folder_of_zip, int method)
{
    int error;
    char path[640];
    zip_t *zip = zip_open(in_folder(name), ZIP_CREATE | ZIP_TRUNCATE, &error);
    if (!CHECK(zip != NULL))
        return;
    for (int i = 0; i < file_count; i++) {
        zip_source_t *source = zip_source_buffer(zip, files[i].data, files[i].size, 0);
        snprintf(path, sizeof path, "%s%.31s", folder_of_zip, files[i].name);
        zip_int64_t index = zip_file_add(zip, path, source, 0);
        CHECK(index >= 0 && zip_set_file_compression(zip, (zip_uint64_t)index, method, 0) == 0);
    }
    CHECK(zip_close(zip) == 0);
}

static void put_zip(const char *name, int method)
{
    put_zip_in(name, "", method);
}

static size_t get(const char *name, uint8_t *bytes, size_t capacity)
{
    FILE *stream = fopen(in_folder(name), "rb");
    size_t size = CHECK(stream != NULL) ? fread(bytes, 1, capacity, stream) : 0;
    if (stream)
        fclose(stream);
    CHECK(size > 0 && size < capacity);
    return size;
}

static double value_of(const made_scene *m, int values, int channel, int code)
{
    double low = bound(values, channel, 0), high = bound(values, channel, 1);
    return m->version == 2 ? codebook(values, code) : low + (high - low) * code / 255;
}

static void expect_rotation(const made_scene *m, int i, float *rotation)
{
    static const int others[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};
    int omitted = byte_of(m, QUATS, i, 3) - 252;
    double sum = 0;
    memset(rotation, 0, 4 * sizeof *rotation);
    for (int k = 0; k < 3 && omitted >= 0; k++) {
        double value = (2 * byte_of(m, QUATS, i, k) / 255.0 - 1) / sqrt(2);
        rotation[others[omitted][k]] = (float)value;
        sum += value * value;
    }
    rotation[omitted < 0 ? 0 : omitted] = (float)sqrt(fmax(0, 1 - sum));
}

static void expect(const made_scene *m, int i, fxs_gaussian *g)
{
    memset(g, 0, sizeof *g);
    for (int c = 0; c < 3; c++) {
        int code = byte_of(m, LOW, i, c) + 256 * byte_of(m, HIGH, i, c);
        double n = position_mins[c] + (position_maxs[c] - position_mins[c]) * code / 65535;
        g->position[c] = (float)(n < 0 ? 1 - exp(-n) : exp(n) - 1);
        g->scale[c] = (float)value_of(m, SCALE_VALUES, c, byte_of(m, SCALES, i, c));
        g->dc[c] = (float)value_of(m, COLOUR_VALUES, c, byte_of(m, SH0, i, c));
    }
    int alpha = byte_of(m, SH0, i, 3);
    double logit = alpha == 0 ? -20 : alpha == 255 ? 20 : -log(255.0 / alpha - 1);
    g->opacity = (float)(m->version == 2 ? logit : value_of(m, COLOUR_VALUES, 3, alpha));
    expect_rotation(m, i, g->rotation);
    int label = byte_of(m, LABELS, i, 0) + 256 * byte_of(m, LABELS, i, 1), count = coefficients(m->degree);
    for (int k = 0; k < count && (m->version == 1 || label < PALETTE); k++)
        for (int c = 0; c < 3; c++) {
            int pixel = label / 64 * (64 * count) + label % 64 * count + k;
            g->sh[3 * k + c] = (float)value_of(m, SH_VALUES, 0, byte_of(m, CENTROIDS, pixel, c));
        }
}

static int same(const fxs_gaussian *a, const fxs_gaussian *b)
{
    const float *x = (const float *)a, *y = (const float *)b;
    for (size_t i = 0; i < sizeof *a / sizeof *x; i++)
        if (!(fabsf(x[i] - y[i]) <= 3e-7f * fmaxf(1, fabsf(y[i]))))
            return 0;
    return 1;
}

static int all_same(const made_scene *m, const fxs_gaussian *gaussians, int begin, int end)
{
    fxs_gaussian expected;
    for (int i = begin; i < end; i++) {
        expect(m, i, &expected);
        if (!CHECK(same(&gaussians[i - begin], &expected)))
            return 0;
    }
    return 1;
}

static void check_scene(const char *name, const made_scene *m)
{
    fxs_gaussian gaussians[COUNT + 1];
    if (!CHECK(read_level(name, 0, gaussians, COUNT + 1) == COUNT)) {
        printf("  %s\n", message.text);
        return;
    }
    CHECK(info.sh_degree == m->degree && info.antialiased == 0 && info.levels == 1);
    if (!all_same(m, gaussians, 0, COUNT))
        printf("  %s, version %d, degree %d\n", name, m->version, m->degree);
}

static void every_version_and_degree(void)
{
    for (int version = 1; version <= 2; version++)
        for (int degree = 0; degree <= 3; degree++) {
            made_scene m = {version, degree, (unsigned)(4 * version + degree)};
            make(&m);
            put_folder("scene");
            check_scene("scene", &m);
            check_scene("scene/", &m);
            check_scene("scene/meta.json", &m);
            put_zip("stored.sog", ZIP_CM_STORE);
            check_scene("stored.sog", &m);
            put_zip("deflated.sog", ZIP_CM_DEFLATE);
            check_scene("deflated.sog", &m);
        }
}

static const made_scene plain = {2, 1, 5};

/* Reads a .sog as PlayCanvas writes it: the sizes and the checksum of a zip entry follow its data. */
static void zip_with_data_descriptors(void)
{
    static uint8_t bytes[1 << 18], out[1 << 18];
    make(&plain);
    put_zip("a.sog", ZIP_CM_STORE);
    size_t size = get("a.sog", bytes, sizeof bytes), at = 0, end = 0, moved[IMAGES + 1];
    int entry = 0;
    for (; memcmp(bytes + at, "PK\3\4", 4) == 0; entry++) {
        size_t header = 30u + bytes[at + 26] + bytes[at + 28], data = files[entry].size;
        moved[entry] = end;
        memcpy(out + end, bytes + at, header + data);
        out[end + 6] = 8;
        memset(out + end + 14, 0, 12);
        end += header + data;
        memcpy(out + end, "PK\7\10", 4);
        memcpy(out + end + 4, bytes + at + 14, 12);
        end += 16;
        at += header + data;
    }
    size_t directory = end;
    memcpy(out + end, bytes + at, size - at);
    end += size - at;
    CHECK(entry == file_count);
    for (at = directory, entry = 0; memcmp(out + at, "PK\1\2", 4) == 0; entry++) {
        out[at + 8] = 8;
        for (int i = 0; i < 4; i++)
            out[at + 42 + (size_t)i] = (uint8_t)(moved[entry] >> 8 * i);
        at += 46u + out[at + 28] + out[at + 30];
    }
    for (int i = 0; i < 4; i++)
        out[at + 16 + (size_t)i] = (uint8_t)(directory >> 8 * i);
    put_file("a.sog", out, end);
    check_scene("a.sog", &plain);
}

/* Old programs write null as the first value of a .sog's codebook. The reader extrapolates it from the other
   values. */
static void null_in_codebook(void)
{
    fxs_gaussian gaussians[COUNT + 1];
    int found = 0;
    make(&plain);
    edit("\"codebook\":[-3.125,", "\"codebook\":[null,");
    put_folder("scene");
    CHECK(read_level("scene", 0, gaussians, COUNT + 1) == COUNT);
    double first = codebook(SCALE_VALUES, 1) + (codebook(SCALE_VALUES, 1) - codebook(SCALE_VALUES, 255)) / 255;
    for (int i = 0; i < COUNT; i++)
        for (int c = 0; c < 3; c++)
            if (byte_of(&plain, SCALES, i, c) == 0) {
                found++;
                CHECK(fabs(gaussians[i].scale[c] - first) < 1e-6);
            } else {
                CHECK(gaussians[i].scale[c] == (float)codebook(SCALE_VALUES, byte_of(&plain, SCALES, i, c)));
            }
    CHECK(found > 0);
}

static void tags(void)
{
    static const struct { const char *text; int antialiased; } cases[] = {
        {"\"antialias\":true,", 1}, {"\"antialias\":false,", 0}, {"\"model\":\"antialiased\",", 1},
        {"\"model\":\"classic\",", 0}, {"\"asset\":{\"generator\":\"model\"},", 0}
    };
    fxs_gaussian gaussians[COUNT + 1];
    char start[64];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        make(&plain);
        snprintf(start, sizeof start, " \n{%s", cases[i].text);
        edit("{", start);
        put_folder("scene");
        CHECK(read_level("scene", 0, gaussians, COUNT + 1) == COUNT && info.antialiased == cases[i].antialiased);
    }
    make(&plain);
    edit("{", "{\"model\":\"2dgs\",");
    put_folder("scene");
    /* a 2D scene: Gaussians are flat, whatever their third scale is */
    CHECK(read_level("scene", 0, gaussians, COUNT + 1) == COUNT);
    for (int i = 0; i < COUNT; i++) {
        fxs_gaussian expected;
        expect(&plain, i, &expected);
        expected.scale[2] = -20;
        CHECK(same(&gaussians[i], &expected));
    }
}

static void zip_of_a_folder(void)
{
    static const char *const folders[] = {"scene/", "a b/scene/", "scene\\"};
    fxs_gaussian gaussians[COUNT + 1];
    for (size_t i = 0; i < sizeof folders / sizeof *folders; i++) {
        make(&plain);
        add_file("x/__MACOSX/scene/meta.json", "{}", 2);
        add_file("._meta.json", "{}", 2);
        put_zip_in("a.sog", folders[i], ZIP_CM_STORE);
        if (!CHECK(read_level("a.sog", 0, gaussians, COUNT + 1) == COUNT && all_same(&plain, gaussians, 0, COUNT)))
            printf("  %s\n", message.text);
    }
    make(&plain);
    edit("\"labels.webp\"", "\"other.webp\"");
    put_zip_in("a.sog", "scene/", ZIP_CM_STORE);
    check_fails("a.sog", "a.sog: a .zip archive without other.webp");
}

static void empty_scene(void)
{
    fxs_gaussian none;
    make(&plain);
    edit("\"count\":37", "\"count\":0");
    put_zip("a.sog", ZIP_CM_STORE);
    CHECK(read_level("a.sog", 0, &none, 1) == 0 && info.count == 0);
}

/* ---- Moving scenes: .tsog ---- */

#define PROFILE "\"version\":4,\"profile\":{\"id\":\"org.opsiclear.tsog-playback\",\"version\":1}"
#define VELOCITIES "\"temporal\":{\"means\":{\"mins\":[[-2,0.5,1]],\"maxs\":[[2,0.75,9]],\"files\":[\"vl\",\"vh\"]}}"
#define CONTINUOUS_1 "\"timeline\":{\"type\":1,\"mins\":[-0.5,0.125],\"maxs\":[1.5,0.5],\"files\":[\"tl\",\"th\"]}"
#define CONTINUOUS CONTINUOUS_1 "," VELOCITIES
#define DISCRETE "\"timeline\":{\"type\":0,\"N\":5,\"delta\":13107,\"files\":[\"tl\",\"th\"]}"

/* Makes plain a .tsog with more members in its JSON. */
static void make_moving(const char *more)
{
    static const made_scene m = {2, 1, 9};
    char text_of_version[2048];
    make(&m);
    for (int image = TIMES_LOW; image < IMAGES; image++)
        add_image(&m, image, WIDTH, HEIGHT);
    struct made_file meta = files[file_count - 5];
    memmove(&files[file_count - 5], &files[file_count - 4], 4 * sizeof files[0]);
    files[file_count - 1] = meta;
    snprintf(text_of_version, sizeof text_of_version, PROFILE "%s%s", *more ? "," : "", more);
    edit("\"version\":2", text_of_version);
    put_zip("a.tsog", ZIP_CM_DEFLATE);
}

/* Reads the scene and its motions. Returns the number of Gaussians, or an error. */
static long read_motions(const char *name, fxs_gaussian *gaussians, fxs_motion *motions, long capacity)
{
    fxs_scene_file *file;
    long count, total = 0;
    const int error = fxs_scene_file_open(in_folder(name), NULL, &file, &info, &message);
    if (error)
        return error;
    while ((count = fxs_scene_file_read(file, gaussians + total,
                                        (size_t)(capacity - total < 10 ? capacity - total : 10), &message)) > 0) {
        const fxs_motion *given = fxs_scene_file_motions(file);
        if (CHECK((given != NULL) == (info.time.duration > 0)) && given)
            memcpy(motions + total, given, (size_t)count * sizeof *given);
        total += count;
    }
    CHECK(!strcmp(info.format, strstr(name, ".tsog") ? "tsog" : "sog"));
    fxs_scene_file_close(file);
    return count < 0 ? count : total;
}

static double code_16(const made_scene *m, int low, int i, int channel)
{
    return byte_of(m, low, i, channel) + 256 * byte_of(m, low + 1, i, channel);
}

static void continuous(void)
{
    static const struct { const char *playback; double duration, rate; int loops; } cases[] = {
        {"", 299 / 30.0, 0, 1}, {",\"fps\":25", 299 / 25.0, 25, 1}, {",\"playback\":{\"duration\":4}", 4, 0, 1},
        {",\"playback\":{\"duration\":0.5,\"fps\":60,\"rate\":2,\"loop\":false},\"fps\":25", 0.5, 60, 0}
    };
    static const made_scene m = {2, 1, 9};
    static const double lows[3] = {-2, 0.5, 1}, highs[3] = {2, 0.75, 9};
    fxs_gaussian gaussians[COUNT + 1];
    fxs_motion motions[COUNT + 1];
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        char more[1024];
        snprintf(more, sizeof more, CONTINUOUS "%s", cases[n].playback);
        make_moving(more);
        if (!CHECK(read_motions("a.tsog", gaussians, motions, COUNT + 1) == COUNT)) {
            printf("  %s\n", message.text);
            continue;
        }
        all_same(&m, gaussians, 0, COUNT);
        const double d = cases[n].duration;
        CHECK(fabs(info.time.duration - d) < 1e-12 && info.time.rate == cases[n].rate &&
              info.time.loops == cases[n].loops && info.time.degree == 1 && info.time.fades && !info.time.turns);
        for (int i = 0; i < COUNT; i++) {
            const double centre = -0.5 + 2 * code_16(&m, TIMES_LOW, i, 0) / 65535;
            const double sigma = 0.125 + 0.375 * code_16(&m, TIMES_LOW, i, 1) / 65535;
            CHECK(fabs((double)motions[i].centre - centre * d) < 1e-5 &&
                  fabs((double)motions[i].fade - sqrt(2) * sigma * d) < 1e-5);
            CHECK(motions[i].from == -INFINITY && motions[i].to == INFINITY && motions[i].drift[1][0] == 0);
            for (int c = 0; c < 3; c++) {
                const double v = lows[c] + (highs[c] - lows[c]) * code_16(&m, VELOCITIES_LOW, i, c) / 65535;
                CHECK(fabs((double)motions[i].drift[0][c] - v / d) < 1e-5);
            }
        }
    }
}

static void velocities_of_8_bits(void)
{
    static const made_scene m = {2, 1, 9};
    fxs_gaussian gaussians[COUNT + 1];
    fxs_motion motions[COUNT + 1];
    make_moving(CONTINUOUS ",\"playback\":{\"duration\":1}");
    edit("[\"vl\",\"vh\"]", "[\"vl\"]");
    put_zip("a.tsog", ZIP_CM_STORE);
    if (CHECK(read_motions("a.tsog", gaussians, motions, COUNT + 1) == COUNT))
        for (int i = 0; i < COUNT; i++)
            CHECK(fabs((double)motions[i].drift[0][0] - (-2 + 4 * byte_of(&m, VELOCITIES_LOW, i, 0) / 255.0)) < 1e-6);
    make_moving(CONTINUOUS_1);
    CHECK(read_motions("a.tsog", gaussians, motions, COUNT + 1) == COUNT && info.time.degree == 0);
    for (int i = 0; i < COUNT; i++)
        CHECK(motions[i].drift[0][0] == 0 && motions[i].fade > 0);
}

static void discrete(void)
{
    static const made_scene m = {2, 1, 9};
    static const char *const playbacks[] = {"", ",\"fps\":12", ",\"playback\":{\"duration\":2.5}",
                                            "," VELOCITIES ",\"playback\":{\"duration\":0.25,\"fps\":20}"};
    static const double durations[] = {5 / 30.0, 5 / 12.0, 2.5, 0.25};
    fxs_gaussian gaussians[COUNT + 1];
    fxs_motion motions[COUNT + 1];
    for (int n = 0; n < 4; n++) {
        char more[1024];
        snprintf(more, sizeof more, DISCRETE "%s", playbacks[n]);
        make_moving(more);
        if (!CHECK(read_motions("a.tsog", gaussians, motions, COUNT + 1) == COUNT)) {
            printf("  %s\n", message.text);
            continue;
        }
        all_same(&m, gaussians, 0, COUNT);
        CHECK(fabs(info.time.duration - durations[n]) < 1e-12 && fabs(info.time.rate - 5 / durations[n]) < 1e-9 &&
              info.time.degree == 0 && !info.time.fades);
        for (int i = 0; i < COUNT; i++) {
            const int frame = (int)fmin(4, floor(code_16(&m, TIMES_LOW, i, 0) / 13107));
            for (int f = 0; f < 5; f++) {
                const double t = (f + 0.5) * durations[n] / 5;
                CHECK((t >= (double)motions[i].from && t < (double)motions[i].to) == (f == frame));
            }
            CHECK(motions[i].fade == INFINITY && motions[i].drift[0][2] == 0);
        }
    }
}

/* A .tsog without a timeline does not move; without a profile it is of an older program. */
static void still_tsog(void)
{
    static const made_scene m = {2, 1, 9};
    fxs_gaussian gaussians[COUNT + 1];
    make_moving("");
    CHECK(read_motions("a.tsog", gaussians, NULL, COUNT + 1) == COUNT && info.time.duration == 0);
    all_same(&m, gaussians, 0, COUNT);
    make_moving(DISCRETE);
    edit("\"profile\":{\"id\":\"org.opsiclear.tsog-playback\",\"version\":1},", "");
    put_folder("moving");
    fxs_motion motions[COUNT + 1];
    CHECK(read_motions("moving", gaussians, motions, COUNT + 1) == COUNT && info.time.duration > 0);
}

/* The example of the specification: tests/fixtures/tsog/decode-vector.json of OpsiClear-4DGS/ftgs-player. */
static void example_of_specification(void)
{
    static const struct { const char *name; uint8_t pixels[8]; } images[] = {
        {"pl", {0, 0, 0, 255, 255, 0, 0, 255}}, {"ph", {0, 0, 0, 255, 255, 0, 0, 255}},
        {"s", {0, 0, 0, 255, 0, 0, 0, 255}}, {"q", {128, 128, 128, 252, 128, 128, 128, 255}},
        {"dc", {0, 1, 2, 128, 2, 0, 1, 255}}, {"tl", {0, 0, 0, 255, 255, 0, 0, 255}},
        {"th", {0, 0, 0, 255, 255, 0, 0, 255}}, {"vl", {0, 0, 1, 255, 255, 0, 2, 255}},
        {"vh", {0, 0, 2, 255, 255, 0, 1, 255}}
    };
    static const float positions[2][3] = {{-1, 0, 1}, {1, 0, 1}}, velocities[2][3] = {{-2, 0, 513}, {2, 0, 258}};
    static const float colours[2][3] = {{0, 1, -1}, {-1, 0, 1}};
    static const double at_zero[2][4] = {{-3, 0, 514, 0.0679330049187703}, {-1, 0, -257, 0.1353352832366127}};
    fxs_gaussian g[3];
    fxs_motion m[3];
    WebPMemoryWriter out;
    forget_files();
    for (size_t i = 0; i < sizeof images / sizeof *images; i++) {
        encode(images[i].pixels, 2, 1, &out);
        add_file(images[i].name, out.mem, out.size);
        WebPMemoryWriterClear(&out);
    }
    length = 0;
    say("{" PROFILE ",\"count\":2,\"means\":{\"mins\":[-0.6931471805599453,0,0.6931471805599453],\"maxs\":"
        "[0.6931471805599453,0,0.6931471805599453],\"files\":[\"pl\",\"ph\"]},\"scales\":{\"codebook\":[0],\"files\":"
        "[\"s\"]},\"quats\":{\"files\":[\"q\"]},\"sh0\":{\"codebook\":[0,1,-1],\"files\":[\"dc\"]},\"timeline\":{"
        "\"type\":1,\"mins\":[-1,0.5],\"maxs\":[1,0.5],\"files\":[\"tl\",\"th\"]},\"temporal\":{\"means\":{\"mins\":"
        "[[-2,0,0]],\"maxs\":[[2,0,65535]],\"files\":[\"vl\",\"vh\"]}},\"playback\":{\"duration\":2,\"fps\":2,"
        "\"rate\":2,\"loop\":false}}");
    add_file("meta.json", text, length);
    put_zip("a.tsog", ZIP_CM_STORE);
    if (!CHECK(read_motions("a.tsog", g, m, 3) == 2)) {
        printf("  %s\n", message.text);
        return;
    }
    CHECK(info.time.duration == 2 && info.time.rate == 2 && info.time.loops == 0);
    for (int i = 0; i < 2; i++) {
        const double d = 0 - (double)m[i].centre, opacity = 1 / (1 + exp(-(double)g[i].opacity));
        CHECK(fabsf(m[i].centre - (i ? 2 : -2)) < 1e-6f && fabs(opacity - (i ? 1 : 128 / 255.0)) < 1e-6);
        CHECK(fabs(opacity * exp(-pow(d / (double)m[i].fade, 2)) - at_zero[i][3]) < 1e-6);
        for (int c = 0; c < 3; c++) {
            CHECK(fabsf(g[i].position[c] - positions[i][c]) < 1e-6f && g[i].scale[c] == 0 &&
                  g[i].dc[c] == colours[i][c] && fabsf(2 * m[i].drift[0][c] - velocities[i][c]) < 1e-3f);
            CHECK(fabs((double)g[i].position[c] + d * (double)m[i].drift[0][c] - at_zero[i][c]) < 1e-3);
        }
    }
}

/* Returns the result of fxs_scene_file_sound, also when the scene has been read. */
static int sound_of(const char *name, fxs_sound *kept, const char *bytes)
{
    fxs_scene_file *file;
    fxs_sound sound;
    fxs_gaussian gaussians[COUNT];
    if (!CHECK(!fxs_scene_file_open(in_folder(name), NULL, &file, &info, &message)))
        return 0;
    int found = 0;
    for (int i = 0; i < 2; i++) {
        found = fxs_scene_file_sound(file, &sound, &message);
        if (found > 0)
            CHECK(sound.bytes == strlen(bytes) && !memcmp(sound.data, bytes, sound.bytes));
        *kept = sound;
        fxs_sound_free(file, &sound);
        CHECK(fxs_scene_file_read(file, gaussians, COUNT, &message) > 0 && fxs_scene_file_rewind(file, &message) == 0);
    }
    fxs_scene_file_close(file);
    return found;
}

static void sounds(void)
{
    static const struct { const char *audio, *type, *ending; double volume; } heard[] = {
        {"\"file\":\"a/B.MP3\"", "audio/mpeg", ".mp3", 1},
        {"\"file\":\"a/B.MP3\",\"volume\":0.25,\"other\":7", "audio/mpeg", ".mp3", 0.25},
        {"\"file\":\"a/B.MP3\",\"mimeType\":\"Audio/OGG\"", "audio/ogg", ".ogg", 1},
        {"\"file\":\"a/B.MP3\",\"mimeType\":\"audio/x-other\",\"volume\":0", "audio/mpeg", ".mp3", 0}
    };
    static const struct { const char *audio, *words; } faulty[] = {
        {"\"file\":\"none.mp3\"", "a.tsog: the sound none.mp3 is missing or damaged"},
        {"\"file\":\"../none.mp3\"", "a.tsog: the sound ../none.mp3 is missing or damaged"},
        {"\"file\":\"empty.wav\"", "a.tsog: an empty sound"},
        {"\"file\":\"sh0\"", "a.tsog: the sound sh0 is of a type that is not known"},
        {"\"file\":\"a/B.MP3\",\"mimeType\":\"text/html\"", "is of a type that is not known"},
        {"\"file\":7", "no valid \"audio\""}, {"", "no valid \"audio\""},
        {"\"file\":\"a/B.MP3\",\"mimeType\":1", "no valid \"audio\""},
        {"\"file\":\"a/B.MP3\",\"volume\":1.5", "no valid \"audio\""},
        {"\"file\":\"a/B.MP3\",\"volume\":\"1\"", "no valid \"audio\""}
    };
    enum { HEARD = sizeof heard / sizeof *heard, FAULTY = sizeof faulty / sizeof *faulty };
    char more[1024];
    fxs_sound sound;
    for (int n = 0; n < HEARD + FAULTY; n++) {
        const int is_heard = n < HEARD;
        snprintf(more, sizeof more, CONTINUOUS_1 ",\"audio\":{%s}",
                 is_heard ? heard[n].audio : faulty[n - HEARD].audio);
        make_moving(more);
        add_file("a/B.MP3", "the sound", 9);
        add_file("empty.wav", "", 0);
        put_zip("a.tsog", n % 2 ? ZIP_CM_STORE : ZIP_CM_DEFLATE);
        const int found = sound_of("a.tsog", &sound, "the sound");
        if (is_heard)
            CHECK(found == 1 && !strcmp(sound.type, heard[n].type) && !strcmp(sound.ending, heard[n].ending) &&
                  sound.volume == heard[n].volume);
        else if (!CHECK(found < 0 && strstr(message.text, faulty[n - HEARD].words)))
            printf("%d %s\n", found, message.text);
    }
    make_moving(CONTINUOUS_1);
    CHECK(sound_of("a.tsog", &sound, "") == 0);
}

static void faulty_tsog(void)
{
    static const struct { const char *more, *old, *new, *words; } cases[] = {
        {"", "playback\",\"version\":1", "playback\",\"version\":2", "TSOG of a profile that is not known"},
        {"", "org.opsiclear", "com.opsiclear", "TSOG of a profile that is not known"},
        {VELOCITIES, "", "", "\"temporal\" without a \"timeline\""},
        {CONTINUOUS, "\"type\":1", "\"type\":2", "a \"timeline\" of a type that is not read: 0 and 1 are"},
        {CONTINUOUS, "\"type\":1", "\"kind\":1", "a \"timeline\" of a type that is not read"},
        {CONTINUOUS, "[-0.5,0.125]", "[-0.5,0]", "no valid \"mins\" and \"maxs\" of \"timeline\""},
        {CONTINUOUS, "[-0.5,0.125]", "[-0.5,1e-100]", "no valid \"mins\" and \"maxs\" of \"timeline\""},
        {CONTINUOUS, "[-0.5,0.125]", "[-0.5]", "no valid \"mins\" and \"maxs\" of \"timeline\""},
        {CONTINUOUS, "[1.5,0.5]", "[1.5,0.1]", "no valid \"mins\" and \"maxs\" of \"timeline\""},
        {CONTINUOUS, "\"temporal\":{", "\"temporal\":{\"scales\":{},", "\"temporal\" has more than \"means\""},
        {CONTINUOUS, "[[-2,0.5,1]]", "[-2,0.5,1]", "no valid \"mins\" and \"maxs\" of \"temporal\""},
        {CONTINUOUS, "[[2,0.75,9]]", "[[2,0.75,9],[1,1,1]]", "no valid \"mins\" and \"maxs\" of \"temporal\""},
        {CONTINUOUS, "[\"vl\",\"vh\"]", "[]", "too few \"files\" of \"temporal\""},
        {CONTINUOUS, "[\"vl\",\"vh\"]", "[\"vl\",\"vl\"]", "vl: the file of two images"},
        {CONTINUOUS, "\"vh\"", "\"no\"", "a .zip archive without no"},
        {CONTINUOUS, "[\"tl\",\"th\"]", "[\"tl\"]", "too few \"files\" of \"timeline\""},
        {DISCRETE, "\"N\":5", "\"N\":0", "no valid \"N\" and \"delta\" of \"timeline\""},
        {DISCRETE, "\"N\":5", "\"N\":10000000", "no valid \"N\" and \"delta\" of \"timeline\""},
        {DISCRETE, "13107", "13108", "no valid \"N\" and \"delta\" of \"timeline\""},
        {DISCRETE ",\"fps\":0", "", "", "no valid \"playback\" or \"fps\""},
        {DISCRETE ",\"playback\":7", "", "", "no valid \"playback\" or \"fps\""},
        {DISCRETE ",\"playback\":{\"duration\":-1}", "", "", "no valid \"playback\" or \"fps\""},
        {DISCRETE ",\"playback\":{\"duration\":1e300}", "", "", "no valid \"playback\" or \"fps\""},
        {DISCRETE ",\"playback\":{\"loop\":1}", "", "", "no valid \"playback\" or \"fps\""},
        {DISCRETE ",\"playback\":{\"duration\":2,\"fps\":3}", "", "", "\"duration\" and \"fps\" of \"playback\" are"},
        {DISCRETE, "\"codebook\":[-3.125", "\"codebook\":[],\"other\":[-3.125", "no valid values of \"scales\""}
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        make_moving(cases[i].more);
        if (*cases[i].old)
            edit(cases[i].old, cases[i].new);
        put_zip("a.tsog", ZIP_CM_STORE);
        check_fails("a.tsog", cases[i].words);
    }
}

/* Codes beyond a short codebook give no number, so that the Gaussian is left out. */
static void short_codebook(void)
{
    static const made_scene m = {2, 1, 9};
    fxs_gaussian gaussians[COUNT + 1];
    make_moving("");
    edit("\"codebook\":[-3.125", "\"codebook\":[0.5,0.25],\"other\":[-3.125");
    put_zip("a.tsog", ZIP_CM_STORE);
    CHECK(read_motions("a.tsog", gaussians, NULL, COUNT + 1) == COUNT);
    for (int i = 0; i < COUNT; i++)
        for (int c = 0; c < 3; c++) {
            const int code = byte_of(&m, SCALES, i, c);
            CHECK(code > 1 ? isnan(gaussians[i].scale[c]) : gaussians[i].scale[c] == (code ? 0.25f : 0.5f));
        }
}

static void faulty_meta(void)
{
    static const struct { const char *old, *new, *words; } cases[] = {
        {"{", "x{", "not a scene file of a known format"},
        {"}}", "}", "meta.json: bad JSON at byte"},
        {"\"version\":2", "\"version\":3", "SOG of version 3, which is not read: 1 and 2 are, and 4 (TSOG)"},
        {"\"version\":2", "\"version\":4,\"profile\":\"a\"", "TSOG of a profile that is not known: not org.opsiclear"},
        {"\"version\":2", "\"version\":1", "SOG of a version that is not known: not 1, 2 or 4"},
        {"\"version\":2", "\"version\":5", "SOG of a version that is not known: not 1, 2 or 4"},
        {"\"version\":2", "\"version\":\"2\"", "a version that is not known"},
        {"\"version\":2,", "", "no valid \"shape\" of \"means\""},
        {"\"means\"", "\"mean\"", "not a SOG scene: no \"means\""},
        {"\"count\":37", "\"count\":-1", "no valid \"count\""},
        {"\"count\":37", "\"count\":1.5", "no valid \"count\""},
        {"\"count\":37", "\"count\":\"37\"", "no valid \"count\""},
        {"\"count\":37", "\"count\":1e300", "no valid \"count\""},
        {"\"count\":37", "\"count\":43", "low.webp: fewer pixels than Gaussians"},
        {"\"count\":37", "\"count\":2147483647", "low.webp: fewer pixels than Gaussians"},
        {"[-3.25,", "[", "no valid \"mins\" and \"maxs\" of \"means\""},
        {"[-3.25,", "[null,", "no valid \"mins\" and \"maxs\" of \"means\""},
        {"\"codebook\":[-3.125,", "\"codebook\":[", "no valid values of \"scales\""},
        {"-3.09375,", "null,", "no valid values of \"scales\""},
        {"\"codebook\":[-2.125,", "\"codebook\":[\"x\",", "no valid values of \"sh0\""},
        {"\"codebook\":[-1.125,", "\"codebook\":[-1.125,1,", "no valid values of \"shN\""},
        {"\"bands\":1", "\"bands\":0", "no valid \"bands\" of \"shN\""},
        {"\"bands\":1", "\"bands\":4", "no valid \"bands\" of \"shN\""},
        {"\"bands\":1", "\"bands\":2", "centroids.webp: not as wide as a palette of its degree"},
        {"\"count\":300", "\"count\":65537", "no valid \"count\" of \"shN\""},
        {"\"count\":300", "\"count\":321", "centroids.webp: not as high as a palette of its count"},
        {"\"low.webp\",", "", "too few \"files\" of \"means\""},
        {"[\"scales.webp\"]", "\"scales.webp\"", "too few \"files\" of \"scales\""},
        {"\"quats\"", "\"quat\"", "too few \"files\" of \"quats\""},
        {"\"scales.webp\"", "\"../scene/scales.webp\"", "a file name that is missing, leaves the folder"},
        {"\"scales.webp\"", "\"./../scene/scales.webp\"", "leaves the folder"},
        {"\"scales.webp\"", "\"/etc/passwd\"", "leaves the folder"},
        {"\"scales.webp\"", "\"\"", "leaves the folder"},
        {"\"scales.webp\"", "\"a/..\"", "leaves the folder"},
        {"\"scales.webp\"", "\"..\\\\scene\\\\scales.webp\"", "leaves the folder"},
        {"\"scales.webp\"", "\"\\\\\\\\host\\\\share\\\\scales.webp\"", "leaves the folder"},
        {"\"scales.webp\"", "\"C:\\\\scales.webp\"", "leaves the folder"},
        {"\"scales.webp\"", "\"c:scales.webp\"", "leaves the folder"},
        {"\"scales.webp\"", "\"https://host/scales.webp\"", "leaves the folder"},
        {"\"scales.webp\"", "\"data:,scales.webp\"", "leaves the folder"},
        {"\"scales.webp\"", "\"%2e%2E/scene/scales.webp\"", "leaves the folder"},
        {"\"scales.webp\"", "\"..%2fscene%5cscales.webp\"", "leaves the folder"},
        {"\"scales.webp\"", "\"%2fetc/passwd\"", "leaves the folder"},
        {"\"scales.webp\"", "\"a%00b\"", "or has control characters"},
        {"\"scales.webp\"", "\"..a/b..c/no:.webp\"", "no:.webp: No such file"},
        {"\"scales.webp\"", "\"100%.webp\"", "100%.webp: No such file"},
        {"\"scales.webp\"", "7", "leaves the folder"},
        {"\"scales.webp\"", "\"a\\nb\"", "or has control characters"},
        {"\"scales.webp\"", "\"no.webp\"", "scene/no.webp: No such file"},
        {"\"scales.webp\"", "\".\"", "not a regular file"},
        {"\"scales.webp\"", "\"meta.json\"", "meta.json: not a lossless WebP"},
        {"\"labels.webp\"", "\"no.webp\"", "no.webp: No such file"}
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        make(&plain);
        edit(cases[i].old, cases[i].new);
        put_folder("scene");
        check_fails("scene", cases[i].words);
    }
    made_scene first = {1, 1, 9};
    make(&first);
    edit("\"mins\":-", "\"mins\":[],\"min\":-");
    put_folder("scene");
    check_fails("scene", "no valid values of \"shN\"");
    CHECK(mkdir(in_folder("empty"), 0700) == 0);
    check_fails("empty", "a folder without an index or numbered scene files");
}

static void faulty_images(void)
{
    const uint8_t rgba[COUNT * 4] = {1, 2, 3, 255};
    uint8_t *data;
    fxs_gaussian gaussians[COUNT + 1];
    WebPMemoryWriter out;
    make(&plain);
    put_folder("scene");
    for (size_t size = 0; size < files[QUATS].size; size++) {
        put_file("scene/quats.webp", files[QUATS].data, size);
        CHECK(read_level("scene", 0, gaussians, COUNT + 1) == FXS_ERR_FILE);
    }
    CHECK(strstr(message.text, "an image cannot be decoded") != NULL);
    size_t size = WebPEncodeRGBA(rgba, COUNT, 1, 4 * COUNT, 50, &data);
    put_file("scene/quats.webp", data, size);
    WebPFree(data);
    check_fails("scene", "quats.webp: not a lossless WebP");
    put_folder("scene");
    encode(rgba, COUNT, 1, &out);
    put_file("scene/centroids.webp", out.mem, out.size);
    WebPMemoryWriterClear(&out);
    check_fails("scene", "centroids.webp: not as wide as a palette");
}

static void absurd_sizes(void)
{
    enum { SIDE = 1500 };
    uint8_t *rgba = calloc(SIDE * SIDE, 4);
    WebPMemoryWriter out;
    if (!CHECK(rgba != NULL))
        return;
    make(&plain);
    put_folder("scene");
    encode(rgba, SIDE, SIDE, &out);
    put_file("scene/low.webp", out.mem, out.size);
    check_fails("scene", "low.webp: far more pixels than Gaussians");
    edit("\"count\":37", "\"count\":2000000");
    put_file("scene/meta.json", files[file_count - 1].data, files[file_count - 1].size);
    for (int image = LOW; image < IMAGES; image++) {
        char name[32];
        snprintf(name, sizeof name, "scene/%s", image_names[image]);
        if (image != CENTROIDS)
            put_file(name, out.mem, out.size);
    }
    check_fails("scene", "scene/meta.json: 2000000 Gaussians or more in ");
    WebPMemoryWriterClear(&out);
    free(rgba);
}

static uint8_t zip_bytes[1 << 18];

static void damaged_zip(void)
{
    fxs_gaussian gaussians[COUNT + 1];
    make(&(made_scene){2, 0, 3});
    put_zip("a.sog", ZIP_CM_STORE);
    size_t size = get("a.sog", zip_bytes, sizeof zip_bytes);
    for (size_t i = 2; i < size; i++) {
        zip_bytes[i] ^= 0x55;
        put_file("a.sog", zip_bytes, size);
        long count = read_level("a.sog", 0, gaussians, COUNT + 1);
        CHECK(count == FXS_ERR_FILE || (count == COUNT && all_same(&(made_scene){2, 0, 3}, gaussians, 0, COUNT)));
        zip_bytes[i] ^= 0x55;
    }
}

static void faulty_zip(void)
{
    make(&plain);
    edit("\"labels.webp\"", "\"other.webp\"");
    put_zip("a.sog", ZIP_CM_STORE);
    check_fails("a.sog", "a.sog: a .zip archive without other.webp");
    free(files[--file_count].data);
    put_zip("a.sog", ZIP_CM_STORE);
    check_fails("a.sog", "a.sog: a .zip archive without meta.json, so no .sog");
    make(&plain);
    put_zip("a.sog", ZIP_CM_STORE);
    size_t size = get("a.sog", zip_bytes, sizeof zip_bytes), at = size - 22;
    at = zip_bytes[at + 16] | (size_t)zip_bytes[at + 17] << 8 | (size_t)zip_bytes[at + 18] << 16;
    zip_bytes[at + 23] = zip_bytes[at + 27] = 0x70;   /* changes both stated sizes of the first zip entry */
    put_file("a.sog", zip_bytes, size);
    check_fails("a.sog", "more than this file can hold");
}

/* scenes of the streamed SOG; the last is the environment */
static const made_scene chunks[] = {{2, 0, 20}, {2, 2, 21}, {1, 1, 22}, {2, 3, 23}};

#define BOUND "\"bound\":{\"min\":[0,0,0],\"max\":[1,1,1]},"

static const char index_text[] =
    "{\"version\":1,\"count\":99,\"counts\":[62,37],\"lodLevels\":2,\"environment\":\"env/meta.json\","
    "\"filenames\":[\"0_0/meta.json\",\"0_1/meta.json\",\"1_0/meta.json\"],\"tree\":{" BOUND "\"children\":["
    "{" BOUND "\"lods\":{\"0\":{\"file\":1,\"offset\":12,\"count\":25},\"1\":{\"file\":2,\"offset\":20,\"count\":17}}},"
    "{" BOUND "\"children\":["
    "{" BOUND "\"lods\":{\"0\":{\"file\":0,\"offset\":5,\"count\":32},\"1\":{\"file\":2,\"offset\":0,\"count\":20}}},"
    "{" BOUND "\"lods\":{\"0\":{\"file\":1,\"offset\":0,\"count\":12}},\"errors\":[0,1]}]}]}}";

static void put_index(const char *old, const char *new)
{
    const char *found = strstr(index_text, old);
    length = 0;
    if (CHECK(found != NULL))
        say("%.*s%s%s", (int)(found - index_text), index_text, new, found + strlen(old));
    put_file("lod-meta.json", text, length);
}

static void put_streamed(void)
{
    static const char *const names[] = {"0_0", "0_1", "1_0", "env"};
    for (int i = 0; i < 4; i++) {
        make(&chunks[i]);
        put_folder(names[i]);
    }
    put_index("", "");
}

static void streamed(void)
{
    fxs_gaussian g[4 * COUNT];
    put_streamed();
    CHECK(read_level("", 0, g, 4 * COUNT) == 32 + 37 + COUNT && info.sh_degree == 3 && info.levels == 2);
    all_same(&chunks[0], g, 5, 37);
    all_same(&chunks[1], g + 32, 0, 37);
    all_same(&chunks[3], g + 69, 0, COUNT);
    CHECK(read_level("lod-meta.json", 1, g, 4 * COUNT) == 12 + 37 + COUNT && info.levels == 2);
    all_same(&chunks[1], g, 0, 12);
    all_same(&chunks[2], g + 12, 0, 37);
    all_same(&chunks[3], g + 49, 0, COUNT);
    check_level_fails("", 2, "no level 2: levels of detail in this scene: 2");
    check_level_fails("", -1, "no level -1: levels of detail in this scene: 2");
    check_level_fails("env", 1, "no level 1: levels of detail in this scene: 1");
    put_index("\"environment\":\"env/meta.json\"", "\"environment\":null");
    CHECK(read_level("", 0, g, 4 * COUNT) == 69 && info.sh_degree == 2);
    put_index("\"version\":1,", "");
    CHECK(read_level("", 1, g, 4 * COUNT) == 12 + 37 + COUNT);
    put_index("\"offset\":12,\"count\":25", "\"offset\":5,\"count\":0");
    CHECK(read_level("", 0, g, 4 * COUNT) == 32 + 12 + COUNT);
    put_index("{", "{\"model\":\"default\",");
    CHECK(read_level("", 0, g, 4 * COUNT) == 69 + COUNT && !info.antialiased);
    put_index("{", "\xef\xbb\xbf{\"model\":\"antialiased\",");
    CHECK(read_level("", 0, g, 4 * COUNT) == 69 + COUNT && info.antialiased && g[3].scale[2] > -20);
    put_index("{", "{\"model\":\"2dgs\",");
    CHECK(read_level("", 0, g, 4 * COUNT) == 69 + COUNT && !info.antialiased);
    for (int i = 0; i < 69 + COUNT; i++)
        CHECK(g[i].scale[2] <= -20);
}

static void nearest_level(void)
{
    static const struct { const char *lods; int counts[5]; } cases[] = {
        /* level 2 is missing and as near to 0 as to 4, so the finer level 0 is used */
        {"\"0\":1,\"4\":5", {1, 1, 1, 5, 5}},
        {"\"4\":5,\"0\":1", {1, 1, 1, 5, 5}},
        {"\"3\":4", {4, 4, 4, 4, 4}},
        {"\"1\":2,\"2\":3", {2, 2, 3, 3, 3}},
        {"\"0\":1,\"1\":0,\"2\":3", {1, 0, 3, 3, 3}},   /* level 1 is present, so it is used, but has no Gaussians */
        {"", {0, 0, 0, 0, 0}}
    };
    fxs_gaussian g[COUNT];
    put_streamed();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        length = 0;
        say("{\"lodLevels\":5,\"filenames\":[\"0_0/meta.json\"],\"tree\":{\"children\":[{\"lods\":{");
        for (const char *c = cases[i].lods; *c; c++)
            if (c[0] == ':')
                say(":{\"file\":0,\"offset\":7,\"count\":%c}", *++c);
            else
                say("%c", *c);
        say("}}]}}");
        put_file("lod-meta.json", text, length);
        for (int level = 0; level < 5; level++) {
            CHECK(read_level("", level, g, COUNT) == cases[i].counts[level]);
            all_same(&chunks[0], g, 7, 7 + cases[i].counts[level]);
        }
    }
    /* In streamed SOG, a node with children is no leaf. The missing levels of such a node are not replaced. */
    length = 0;
    say("{\"lodLevels\":2,\"filenames\":[\"0_0/meta.json\"],\"tree\":{\"lods\":{\"1\":{\"file\":0,\"offset\":0,"
        "\"count\":5}},\"children\":[{\"lods\":{\"0\":{\"file\":0,\"offset\":5,\"count\":9}}}]}}");
    put_file("lod-meta.json", text, length);
    CHECK(read_level("", 0, g, COUNT) == 9 && all_same(&chunks[0], g, 5, 14));
    remove(in_folder("lod-meta.json"));
}

static void environment(void)
{
    static const struct { const char *file, *member; } cases[] = {
        {"environment.sog", "\"environment\":\"environment.sog\","}, {"environment.sog", "\"environment\":null,"},
        {"environment.sog", ""}, {"env/sky.sog", "\"environment\":\"env/sky.sog\","}
    };
    fxs_gaussian g[4 * COUNT];
    put_streamed();
    put_index("\"environment\":\"env/meta.json\",", "");
    CHECK(read_level("", 0, g, 4 * COUNT) == 69);
    make(&chunks[3]);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        put_zip(cases[i].file, ZIP_CM_STORE);
        put_index("\"environment\":\"env/meta.json\",", cases[i].member);
        for (int level = 0; level < 2; level++) {
            const long leaves = level ? 49 : 69;
            if (!CHECK(read_level("", level, g, 4 * COUNT) == leaves + COUNT))
                printf("  %s\n", message.text);
            all_same(&chunks[3], g + leaves, 0, COUNT);
        }
        remove(in_folder(cases[i].file));
    }
    put_index("\"environment\":\"env/meta.json\",", "\"environment\":7,");
    check_fails("", "lod-meta.json: an \"environment\" that is not a file name");
    put_index("\"environment\":\"env/meta.json\",", "");
    put_file("environment.sog", "", 0);
    check_fails("", "environment.sog: the file ends early");
    put_file("environment.sog", "PK\3\4", 4);
    check_fails("", "environment.sog: cannot be read as a zip");
    put_file("environment.sog", "{}", 2);
    check_fails("", "environment.sog: not a SOG scene");
    remove(in_folder("environment.sog"));
    CHECK(symlink("/etc/passwd", in_folder("environment.sog")) == 0);
    check_fails("", "environment.sog: leaves the folder");
    remove(in_folder("environment.sog"));
    remove(in_folder("lod-meta.json"));
}

static const char lcc2_text[] =
    "{\"totalSplats\":111,\"lodSplats\":[74,37],\"totalLevels\":2,\"splatType\":\".sog\",\"root\":{\"splatFiles\":"
    "[\"l/0.sog\",\"l\\\\1.sog\",\"l/2.sog\",\"l/sky.sog\"],\"data\":{\"env\":{\"name\":3}},\"child\":["
    "{\"data\":{\"3dgs\":{\"name\":2}},\"child\":{"
    "\"0\":{\"data\":{\"3dgs\":{\"name\":1,\"start\":0,\"count\":9}}},"
    "\"12\":{\"data\":{\"3dgs\":{\"name\":0,\"count\":37}}},"
    "\"x\":{\"data\":{\"3dgs\":{\"name\":1,\"start\":9,\"count\":28}}},\"y\":{}}}]}}";
static const char old_lcc2_text[] =
    "{\"root\":{\"files\":[\"/l/0\",\"/l/1\",\"/l/2.sog\"],\"child_num\":1,\"child\":{"
    "\"0\":{\"data\":{\"3dgs\":{\"name\":2}},\"child\":["
    "{\"data\":{\"3dgs\":{\"name\":0}}},{\"data\":{\"3dgs\":{\"name\":1}}}]}}},\"total_splats\":111,"
    "\"lod_3dgs_info\":[37,74],\"lod_level\":2}";

/* True if the Gaussians of an .lcc2 equal the rotated Gaussians of its .sog file. The axes of .lcc2 have z up. */
static int is_turned(const made_scene *m, const fxs_gaussian *g)
{
    for (int i = 0; i < COUNT; i++) {
        fxs_gaussian made;
        expect(m, i, &made);
        if (fabsf(g[i].position[0] - made.position[0]) > 1e-5f || fabsf(g[i].position[1] + made.position[2]) > 1e-4f ||
            fabsf(g[i].position[2] - made.position[1]) > 1e-4f || fabsf(g[i].dc[1] - made.dc[1]) > 1e-5f)
            return 0;
    }
    return 1;
}

static void lcc2(void)
{
    static const char *const names[] = {"l/0.sog", "l/1.sog", "l/2.sog", "l/sky.sog"};
    static const struct { const char *old, *new, *words; } faults[] = {
        {"\"totalLevels\":2", "\"totalLevels\":0", "scene.lcc2: no valid \"totalLevels\""},
        {"\".sog\"", "\".spz\"", "scene.lcc2: a .lcc2 with files of the kind \".spz\", which is not read"},
        {"\"splatFiles\"", "\"files\"", "\"splatFiles\" is not an array of up to 65536"},
        {"\"name\":1,", "\"name\":4,", "a node of a file that is not in \"splatFiles\""},
        {"l/0.sog", "../0.sog", "leaves the folder"}, {"l/sky.sog", "../../etc/passwd", "leaves the folder"},
        {"l/0.sog", "l/9.sog", "l/9.sog: No such file"},
    };
    fxs_gaussian g[4 * COUNT];
    mkdir(in_folder("l"), 0700);
    for (int i = 0; i < 4; i++) {
        make(&chunks[i]);
        put_zip(names[i], ZIP_CM_STORE);
    }
    put_file("scene.lcc2", lcc2_text, sizeof lcc2_text - 1);
    if (!CHECK(read_level("scene.lcc2", 0, g, 4 * COUNT) == 3 * COUNT && info.levels == 2 && info.sh_degree == 3))
        printf("  %s\n", message.text);
    CHECK(is_turned(&chunks[0], g) && is_turned(&chunks[1], g + COUNT) && is_turned(&chunks[3], g + 2 * COUNT));
    CHECK(read_level("scene.lcc2", 1, g, 4 * COUNT) == 2 * COUNT);
    CHECK(is_turned(&chunks[2], g) && is_turned(&chunks[3], g + COUNT));
    check_level_fails("scene.lcc2", 2, "no level 2: levels of detail in this scene: 2");
    for (size_t i = 0; i < sizeof faults / sizeof *faults; i++) {
        const char *found = strstr(lcc2_text, faults[i].old);
        length = 0;
        if (CHECK(found != NULL))
            say("%.*s%s%s", (int)(found - lcc2_text), lcc2_text, faults[i].new, found + strlen(faults[i].old));
        put_file("scene.lcc2", text, length);
        check_fails("scene.lcc2", faults[i].words);
    }
    remove(in_folder("l/sky.sog"));
    put_file("scene.lcc2", lcc2_text, sizeof lcc2_text - 1);
    CHECK(read_level("scene.lcc2", 1, g, 4 * COUNT) == COUNT);
    put_file("scene.lcc2", old_lcc2_text, sizeof old_lcc2_text - 1);
    CHECK(read_level("scene.lcc2", 0, g, 4 * COUNT) == 2 * COUNT && is_turned(&chunks[0], g));
    CHECK(read_level("scene.lcc2", 1, g, 4 * COUNT) == COUNT && is_turned(&chunks[2], g));
}

static void faulty_index(void)
{
    static const struct { const char *old, *new, *words; } cases[] = {
        {"\"version\":1", "\"version\":2", "lod-meta.json: streamed SOG of a version that is not known: not 1"},
        {"\"lodLevels\":2,", "", "no valid \"lodLevels\""},
        {"\"lodLevels\":2,", "\"lodLevels\":0,", "no valid \"lodLevels\""},
        {"\"lodLevels\":2,", "\"lodLevels\":1e9,", "no valid \"lodLevels\""},
        {"\"filenames\"", "\"names\"", "\"filenames\" is not an array"},
        {"{\"0\":", "{\"x\":", "a leaf with \"lods\" that are not levels"},
        {"{\"0\":", "{\"\":", "a leaf with \"lods\" that are not levels"},
        {"{\"0\":", "{\"4294967296\":", "a leaf with \"lods\" that are not levels"},
        {"\"file\":1", "\"file\":3", "a leaf with no valid \"file\""},
        {"\"file\":1", "\"file\":-1", "a leaf with no valid \"file\""},
        {"\"file\":1,", "", "a leaf with no valid \"file\""},
        {"\"offset\":12", "\"offset\":0.5", "a leaf with no valid \"file\""},
        {"\"count\":25", "\"count\":1e99", "a leaf with no valid \"file\""},
        {"\"count\":25", "\"count\":26", "0_1/meta.json: 37 Gaussians, but a leaf ends at 38"},
        {"\"offset\":12", "\"offset\":11", "0_1/meta.json: two leaves share Gaussian 11"},
        {"0_1/meta.json", "no/meta.json", "no/meta.json: No such file"},
        {"0_1/meta.json", "lod-meta.json", "not a SOG scene: no \"means\""},
        {"0_1/meta.json", "0_1/low.webp", "0_1/low.webp: bad JSON"},
        {"0_1/meta.json", "../0_1/meta.json", "leaves the folder"},
        {"0_1/meta.json", "0_1\\\\..\\\\..\\\\meta.json", "leaves the folder"},
        {"0_1/meta.json", "file:0_1/meta.json", "leaves the folder"},
        {"\"0_1/meta.json\"", "1", "leaves the folder"},
        {"env/meta.json", "no/meta.json", "no/meta.json: No such file"}
    };
    put_streamed();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        put_index(cases[i].old, cases[i].new);
        check_fails("lod-meta.json", cases[i].words);
    }
    length = 0;
    say("{\"lodLevels\":1,\"filenames\":[],\"tree\":");
    for (int i = 0; i < 5000; i++)
        say("{\"children\":[");
    put_file("lod-meta.json", text, length);
    check_fails("lod-meta.json", "bad JSON");
    remove(in_folder("lod-meta.json"));
}

static uint64_t least_memory(fxs_gaussian gaussians[4 * COUNT])
{
    fxs_scene_file_options options = {.size = sizeof(fxs_scene_file_options), .max_memory = 1 << 12};
    fxs_scene_file *file;
    for (long read = -1; read < 0 && options.max_memory < 1 << 20; options.max_memory += 1 << 10)
        if (fxs_scene_file_open(in_folder(""), &options, &file, &info, &message) == 0) {
            read = fxs_scene_file_read(file, gaussians, 4 * COUNT, &message);
            fxs_scene_file_close(file);
        }
    return options.max_memory - (1 << 10);
}

static void changed_while_open(void)
{
    fxs_gaussian gaussians[4 * COUNT];
    fxs_scene_file *file;
    put_streamed();
    const fxs_scene_file_options options = {.size = sizeof(fxs_scene_file_options),
                                            .max_memory = least_memory(gaussians)};
    if (!CHECK(fxs_scene_file_open(in_folder(""), &options, &file, &info, &message) == 0))
        return;
    make(&chunks[1]);
    edit("\"count\":37", "\"count\":20");
    put_folder("0_1");
    CHECK(fxs_scene_file_read(file, gaussians, 4 * COUNT, &message) == FXS_ERR_FILE);
    CHECK(strstr(message.text, "0_1/meta.json: 20 Gaussians, but a leaf ends at 37") != NULL);
    CHECK(fxs_scene_file_rewind(file, &message) == 0);
    CHECK(fxs_scene_file_read(file, gaussians, 32, &message) == 32 && all_same(&chunks[0], gaussians, 5, 37));
    fxs_scene_file_close(file);
    remove(in_folder("lod-meta.json"));
}

/* True if two Gaussians are equal, apart from opacity. The converter of the .ply moved opacities 0 and 1 by
   1e-6. */
static int same_but_for_ends(fxs_gaussian a, const fxs_gaussian *b)
{
    int close = fabs(1 / (1 + exp(-a.opacity)) - 1 / (1 + exp(-b->opacity))) < 1.5e-6;
    a.opacity = b->opacity;
    return close && same(&a, b);
}

static void real_scene(void)
{
    const char *scenes = getenv("FXS_SCENES") ? getenv("FXS_SCENES") : "../shared/scenes";
    char path[1024];
    fxs_scene_file *sog, *ply;
    fxs_gaussian a[1000], b[1000];
    long read, count = 0, different = 0;
    snprintf(path, sizeof path, "%s/statue-st-peter/st-peter.sog", scenes);
    if (access(path, R_OK) != 0)
        SKIP("no folder of scenes; set FXS_SCENES");
    if (!CHECK(fxs_scene_file_open(path, NULL, &sog, &info, &message) == 0))
        return;
    CHECK(info.count == 133618 && info.sh_degree == 0 && info.antialiased == 0);
    snprintf(path, sizeof path, "%s/statue-st-peter/st-peter.ply", scenes);
    if (CHECK(fxs_scene_file_open(path, NULL, &ply, &info, &message) == 0)) {
        for (; (read = fxs_scene_file_read(sog, a, 1000, &message)) > 0; count += read) {
            CHECK(fxs_scene_file_read(ply, b, 1000, &message) == read);
            for (long i = 0; i < read; i++)
                different += !same_but_for_ends(a[i], &b[i]);
        }
        CHECK(count == 133618 && different == 0);
        fxs_scene_file_close(ply);
    }
    fxs_scene_file_close(sog);
}

static void run_tests(void)
{
    RUN(every_version_and_degree);
    RUN(zip_with_data_descriptors);
    RUN(null_in_codebook);
    RUN(tags);
    RUN(zip_of_a_folder);
    RUN(empty_scene);
    RUN(faulty_meta);
    RUN(continuous);
    RUN(velocities_of_8_bits);
    RUN(discrete);
    RUN(still_tsog);
    RUN(example_of_specification);
    RUN(sounds);
    RUN(faulty_tsog);
    RUN(short_codebook);
    RUN(faulty_images);
    RUN(absurd_sizes);
    RUN(damaged_zip);
    RUN(faulty_zip);
    RUN(streamed);
    RUN(nearest_level);
    RUN(environment);
    RUN(lcc2);
    RUN(faulty_index);
    RUN(changed_while_open);
    RUN(real_scene);
    forget_files();
}

#else

static void built_without(void)
{
    put_file("a.sog", "PK\3\4", 4);
    check_fails("a.sog", "built without lib");
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
