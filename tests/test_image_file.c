/* Tests image files, failed writes that keep the old file, and image metrics with values computed by hand. */
#include <fixsplat/image.h>

#include <dirent.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#ifdef FXS_WITH_JPEG
#include <jpeglib.h>
#endif
#ifdef FXS_WITH_WEBP
#include <webp/decode.h>
#endif
#ifdef FXS_WITH_ZLIB
#include <zlib.h>
#endif

#include "src/base/opened.h"
#include "tools/command/metrics.h"
#include "check.h"
#include "jpeg_bytes.h"

enum { WIDTH = 37, HEIGHT = 23, PIXELS = WIDTH * HEIGHT };

static char folder[] = "/tmp/fixsplat-images-XXXXXX";
static fxs_message message;
static uint8_t image[4 * PIXELS], other[4 * PIXELS];

static const char *in_folder(const char *name)
{
    static char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static uint32_t seed;

static uint8_t random_byte(void)
{
    seed = seed * 1664525u + 1013904223u;
    return (uint8_t)(seed >> 24);
}

static void make_image(int opaque)
{
    seed = 1;
    for (int i = 0; i < 4 * PIXELS; i++)
        image[i] = i % 4 == 3 && opaque ? 255 : random_byte();
}

static int files_in_folder(void)
{
    int count = 0;
    DIR *directory = opendir(folder);
    if (!directory)
        return -1;
    while (readdir(directory))
        count++;
    closedir(directory);
    return count - 2;
}

static int write_image(const char *name)
{
    memset(&message, 0, sizeof message);
    int status = fxs_image_file_write(in_folder(name), image, WIDTH, HEIGHT, &message);
    CHECK(status == 0 || (status < 0 && message.text[0] != 0));
    return status;
}

static void check_read(const char *name, int keeps_alpha)
{
    uint8_t *rgba;
    int width, height;
    if (!CHECK(!fxs_image_file_read(in_folder(name), &rgba, &width, &height, &message)))
        return;
    if (CHECK(width == WIDTH && height == HEIGHT))
        for (int i = 0; i < 4 * PIXELS; i++)
            if (!CHECK(rgba[i] == (i % 4 == 3 && !keeps_alpha ? 255 : image[i])))
                break;
    free(rgba);
}

static void round_trips(void)
{
    for (int opaque = 0; opaque < 2; opaque++) {
        make_image(opaque);
        CHECK(!write_image("a.png"));
        check_read("a.png", 1);
        CHECK(!write_image("a.PPM"));
        check_read("a.PPM", 0);
    }
    CHECK(files_in_folder() == 2);
    remove(in_folder("a.png"));
    remove(in_folder("a.PPM"));
}

static void raw(void)
{
    uint8_t bytes[4 * PIXELS + 1];
    make_image(0);
    CHECK(!write_image("a.raw"));
    FILE *file = fopen(in_folder("a.raw"), "rb");
    if (!CHECK(file != NULL))
        return;
    CHECK(fread(bytes, 1, sizeof bytes, file) == 4 * PIXELS && !memcmp(bytes, image, 4 * PIXELS));
    fclose(file);
    remove(in_folder("a.raw"));
}

static void endings(void)
{
    static const char *const known[] = {"a.png", "b/c.d.ppm", "x.raw", "a.JPG", "a.jpeg", "a.webp"};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        CHECK(fxs_image_file_known(known[i]));
    CHECK(!fxs_image_file_known("a.gif") && !fxs_image_file_known("png") && !fxs_image_file_known("a.png/b"));
    CHECK(!fxs_image_file_known("a.y4m") && fxs_image_format_of("a.y4m") == FXS_IMAGE_Y4M);
    CHECK(!fxs_image_file_known("a.rgba") && fxs_image_format_of("a.rgba") == FXS_IMAGE_RGBA);
    CHECK(write_image("a.gif") == FXS_ERR_ARGUMENT && strstr(message.text, "a.gif") &&
          strstr(message.text, ".png, .ppm, .raw, .jpg and .webp"));
    CHECK(write_image("a.y4m") == FXS_ERR_ARGUMENT);
    CHECK(fxs_image_file_write(in_folder("a.png"), image, 0, 5, &message) == FXS_ERR_ARGUMENT);
    CHECK(fxs_image_file_write(in_folder("a.png"), image, 16385, 1, &message) == FXS_ERR_ARGUMENT);
    CHECK(fxs_image_file_write(in_folder("a.webp"), image, 16384, 1, &message) == FXS_ERR_ARGUMENT);
    CHECK(files_in_folder() == 0);
}

static int encode(enum fxs_image_format format, int quality, fxs_encoded *encoded)
{
    const int status = fxs_image_encode(format, quality, image, WIDTH, HEIGHT, encoded, &message);
    CHECK(status == 0 || status == FXS_ERR_UNSUPPORTED);
    return status == 0;
}

static void qualities(void)
{
    static const enum fxs_image_format lossy[] = {FXS_IMAGE_JPG, FXS_IMAGE_WEBP};
    fxs_encoded low = {0}, high = {0};
    make_image(1);
    for (int i = 0; i < 2; i++) {
        if (!encode(lossy[i], 20, &low))
            continue;
        CHECK(encode(lossy[i], 90, &high) && low.size < high.size);
        CHECK(fxs_image_encode(lossy[i], 101, image, WIDTH, HEIGHT, &low, &message) == FXS_ERR_ARGUMENT);
        fxs_encoded_free(&low);
        fxs_encoded_free(&high);
    }
}

/* Checks a frame of a .y4m film: colours by BT.709, rounded to a nearest level. */
static void frames_of_films(void)
{
    fxs_encoded frame = {0};
    make_image(0);
    if (!CHECK(encode(FXS_IMAGE_Y4M, 0, &frame) && frame.size == 6 + 3 * PIXELS && !memcmp(frame.bytes, "FRAME\n", 6)))
        return;
    for (int i = 0; i < PIXELS; i++) {
        const double r = image[4 * i] / 255.0, g = image[4 * i + 1] / 255.0, b = image[4 * i + 2] / 255.0;
        const double y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        const double wanted[3] = {16 + 219 * y, 128 + 224 * (b - y) / 1.8556, 128 + 224 * (r - y) / 1.5748};
        for (int k = 0; k < 3; k++)
            if (!CHECK(fabs(frame.bytes[6 + k * PIXELS + i] - wanted[k]) < 0.51))
                return;
    }
    const void *memory = frame.memory;
    CHECK(encode(FXS_IMAGE_RGBA, 0, &frame) && frame.bytes == image && frame.size == sizeof image);
    /* the encoder reuses the memory of the first frame */
    CHECK(encode(FXS_IMAGE_Y4M, 0, &frame) && frame.bytes == memory);
    fxs_encoded_free(&frame);

    static const struct {
        enum fxs_image_format format;
        int width, height, rate;
    } wrong[] = {
        {FXS_IMAGE_Y4M, 8, 6, 0}, {FXS_IMAGE_Y4M, 8, 6, -1}, {FXS_IMAGE_Y4M, 0, 6, 30}, {FXS_IMAGE_RGBA, 8, -6, 30},
        {FXS_IMAGE_PNG, 8, 6, 30}, {FXS_IMAGE_RAW, 8, 6, 30}, {FXS_IMAGE_UNKNOWN, 8, 6, 30}
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        fxs_film *film = (fxs_film *)&frame;
        CHECK(fxs_film_open(&film, in_folder("a.y4m"), wrong[i].format, wrong[i].width, wrong[i].height, wrong[i].rate,
                            &message) == FXS_ERR_ARGUMENT && !film);
    }
}

static void jpg(void)
{
    uint8_t *rgba;
    int width, height;
    for (int i = 0; i < PIXELS; i++)
        memcpy(image + 4 * i, (uint8_t[4]){(uint8_t)(5 * (i % WIDTH)), (uint8_t)(9 * (i / WIDTH)), 90, 255}, 4);
    const int status = write_image("a.jpg");
    if (status == FXS_ERR_UNSUPPORTED)
        SKIP("built without stb");
    CHECK(!status);
#ifndef FXS_WITH_JPEG
    CHECK(fxs_image_file_read(in_folder("a.jpg"), &rgba, &width, &height, &message) == FXS_ERR_UNSUPPORTED &&
          strstr(message.text, "built without libjpeg-turbo") && !rgba);
    remove(in_folder("a.jpg"));
    SKIP("built without libjpeg-turbo");
#endif
    if (!CHECK(!fxs_image_file_read(in_folder("a.jpg"), &rgba, &width, &height, &message)))
        return;
    CHECK(width == WIDTH && height == HEIGHT);
    for (int i = 0; i < 4 * PIXELS; i++)
        if (!CHECK(abs(rgba[i] - image[i]) <= 8))
            break;
    free(rgba);
    remove(in_folder("a.jpg"));
}

#ifdef FXS_WITH_WEBP
static void webp(void)
{
    fxs_encoded encoded = {0};
    int width, height;
    make_image(0);
    image[3] = 0;
    if (!CHECK(encode(FXS_IMAGE_WEBP, 0, &encoded)))
        return;
    uint8_t *rgba = WebPDecodeRGBA(encoded.bytes, encoded.size, &width, &height);
    CHECK(rgba && width == WIDTH && height == HEIGHT && !memcmp(rgba, image, sizeof image));
    WebPFree(rgba);
    fxs_encoded_free(&encoded);
}
#endif

static void bad_targets(void)
{
    make_image(1);
    CHECK(write_image("missing/a.png") == FXS_ERR_FILE && strstr(message.text, "No such file"));
    CHECK(!mkdir(in_folder("d.png"), 0777));
    CHECK(write_image("d.png") == FXS_ERR_FILE && strstr(message.text, "directory"));
    CHECK(files_in_folder() == 1);
    rmdir(in_folder("d.png"));
}

static int refuse(const char *path, fxs_message *why)
{
    return strstr(path, "a.png") ? fxs_fail(why, "%s: not this one", path) : 0;
}

static void refused_targets(void)
{
    make_image(0);
    CHECK(!write_image("a.png"));
    make_image(1);
    fxs_ask_outputs(refuse);
    CHECK(write_image("a.png") == FXS_ERR_FILE && strstr(message.text, "a.png: not this one"));
    CHECK(!write_image("b.png") && files_in_folder() == 2);
    fxs_ask_outputs(NULL);
    check_read("b.png", 1);
    make_image(0);
    check_read("a.png", 1);
    remove(in_folder("a.png"));
    remove(in_folder("b.png"));
}

static void unwritable_folder(void)
{
    if (!geteuid())
        SKIP("root may write everywhere");
    make_image(1);
    CHECK(!write_image("a.png"));
    CHECK(!chmod(folder, 0500));
    CHECK(write_image("a.png") == FXS_ERR_FILE && strstr(message.text, "ermission"));
    CHECK(!chmod(folder, 0700));
    check_read("a.png", 1);
    remove(in_folder("a.png"));
}

static void full_disk(void)
{
    static const char *const names[] = {"a.png", "a.ppm", "a.raw"};
    struct rlimit old, limit;
    CHECK(!getrlimit(RLIMIT_FSIZE, &old));
    signal(SIGXFSZ, SIG_IGN);
    for (int i = 0; i < 3; i++) {
        make_image(1);
        CHECK(!write_image(names[i]));
        struct stat before, after;
        CHECK(!stat(in_folder(names[i]), &before));
        limit = old;
        limit.rlim_cur = 1000;
        CHECK(!setrlimit(RLIMIT_FSIZE, &limit));
        memset(image, 255, sizeof image);
        for (int j = 0; j < 4 * PIXELS; j++)
            image[j] = random_byte();
        CHECK(write_image(names[i]) == FXS_ERR_FILE && strstr(message.text, "too large"));
        CHECK(!setrlimit(RLIMIT_FSIZE, &old));
        CHECK(!stat(in_folder(names[i]), &after) && before.st_ino == after.st_ino && before.st_size == after.st_size);
        CHECK(files_in_folder() == 1);
        remove(in_folder(names[i]));
    }
    signal(SIGXFSZ, SIG_DFL);
}

static void check_unreadable(const char *name, const char *words)
{
    uint8_t *rgba;
    int width, height;
    memset(&message, 0, sizeof message);
    if (!CHECK(fxs_image_file_read(in_folder(name), &rgba, &width, &height, &message) == FXS_ERR_FILE &&
               strstr(message.text, words) && strstr(message.text, name)))
        printf("  %s: \"%s\"\n", name, message.text);
}

static void put(const char *name, const void *data, size_t size)
{
    FILE *file = fopen(in_folder(name), "wb");
    if (!CHECK(file != NULL))
        return;
    CHECK(fwrite(data, 1, size, file) == size);
    fclose(file);
}

static void bad_images(void)
{
    static const char *const faults[][2] = {
        {"", "not a .png, .jpg, .webp, .heic or .ppm"}, {"not an image", "not a .png, .jpg, .webp, .heic or .ppm"},
        {"P5\n1 1\n255\n1", "(P6)"}, {"PK\3\4....", "not a .png, .jpg, .webp, .heic or .ppm (P6), but a .zip archive"},
        {"P6\n1 1\n65535\n123456", "255 levels"}, {"P6\n1 1\n255", "255 levels"}, {"P6 1 99999999999 255 ", "levels"},
        {"P6\n8193 8192\n255\n", "2^26"}, {"P6\n16385 1\n255\n", "16384"}, {"P6\n0 1\n255\n", "without pixels"},
        {"P6\n1 2\n255\n12345", "cut short"}, {"P6 # 1 1 255", "255 levels"},
    };
    check_unreadable("missing.png", "No such file");
    check_unreadable("", "not a regular file");
    for (size_t i = 0; i < sizeof faults / sizeof *faults; i++) {
        put("a.png", faults[i][0], strlen(faults[i][0]));
        check_unreadable("a.png", faults[i][1]);
    }
    remove(in_folder("a.png"));
}

static void ppm_comment(void)
{
    uint8_t *rgba;
    int width, height;
    const char text[] = "P6 # a comment\n# 3\n 2\t1 # 4\n255\n\n#3456";
    put("a.ppm", text, sizeof text - 1);
    if (CHECK(!fxs_image_file_read(in_folder("a.ppm"), &rgba, &width, &height, &message))) {
        CHECK(width == 2 && height == 1 && !memcmp(rgba, "\n#3\377456\377", 8));
        free(rgba);
    }
    remove(in_folder("a.ppm"));
}

#ifdef FXS_WITH_JPEG
static const struct {
    const uint8_t *bytes;
    size_t size;
    int grey;
    uint32_t hash;                 /* expected hash of the decoded pixels, equal on all machines */
} jpegs[] = {
    {baseline_jpeg, sizeof baseline_jpeg, 0, 0xa65fd5fe},
    {progressive_jpeg, sizeof progressive_jpeg, 0, 0xa65fd5fe},
    {grey_jpeg, sizeof grey_jpeg, 1, 0xdb864545},
};
enum { JPEGS = sizeof jpegs / sizeof *jpegs };

static uint32_t hash_of(const uint8_t *bytes, size_t size)
{
    uint32_t hash = 2166136261u;
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ bytes[i]) * 16777619u;
    return hash;
}

static void jpeg(void)
{
    for (int i = 0; i < JPEGS; i++) {
        uint8_t *rgba;
        int width, height;
        put("a.png", jpegs[i].bytes, jpegs[i].size);
        if (!CHECK(!fxs_image_file_read(in_folder("a.png"), &rgba, &width, &height, &message)))
            continue;
        if (CHECK(width == JPEG_WIDTH && height == JPEG_HEIGHT)) {
            for (int y = 0; y < height; y++)
                for (int x = 0; x < width; x++) {
                    const uint8_t *c = rgba + 4 * (y * width + x);
                    const int grey = 40 + 7 * x, green = 200 - 6 * y, blue = 60 + 3 * x + 4 * y;
                    CHECK(abs(c[0] - grey) <= 12 && abs(c[1] - (jpegs[i].grey ? grey : green)) <= 12 &&
                          abs(c[2] - (jpegs[i].grey ? grey : blue)) <= 12 && c[3] == 255);
                }
            const uint32_t hash = hash_of(rgba, 4 * JPEG_WIDTH * JPEG_HEIGHT);
            if (!CHECK(hash == jpegs[i].hash))
                printf("  jpeg %d: 0x%x\n", i, (unsigned)hash);
        }
        free(rgba);
    }
    remove(in_folder("a.png"));
}

static void put_cmyk(J_COLOR_SPACE space, int is_adobe, const uint8_t values[4])
{
    enum { SIDE = 16 };
    struct jpeg_compress_struct jpeg;
    struct jpeg_error_mgr errors;
    uint8_t row[4 * SIDE], *bytes = NULL;
    unsigned long size = 0;
    for (int i = 0; i < 4 * SIDE; i++)
        row[i] = values[i % 4];
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    jpeg_mem_dest(&jpeg, &bytes, &size);
    jpeg.image_width = jpeg.image_height = SIDE;
    jpeg.input_components = 4;
    jpeg.in_color_space = JCS_CMYK;
    jpeg_set_defaults(&jpeg);
    jpeg_set_colorspace(&jpeg, space);
    jpeg_set_quality(&jpeg, 100, TRUE);
    jpeg.write_Adobe_marker = (boolean)is_adobe;
    jpeg_start_compress(&jpeg, TRUE);
    for (int y = 0; y < SIDE; y++)
        jpeg_write_scanlines(&jpeg, &(JSAMPROW){row}, 1);
    jpeg_finish_compress(&jpeg);
    jpeg_destroy_compress(&jpeg);
    put("cmyk.jpg", bytes, size);
    free(bytes);
}

/* Reads CMYK and YCCK JPEGs. Adobe stores both inverted. Plain CMYK is not inverted. */
static void cmyk(void)
{
    static const uint8_t stored[4] = {200, 100, 50, 180}, inks[4] = {55, 155, 205, 75};
    static const struct { J_COLOR_SPACE space; int is_adobe; const uint8_t *values; } ways[] = {
        {JCS_CMYK, 1, stored}, {JCS_YCCK, 1, stored}, {JCS_CMYK, 0, inks}
    };
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        uint8_t *rgba;
        int width, height;
        put_cmyk(ways[i].space, ways[i].is_adobe, ways[i].values);
        if (!CHECK(!fxs_image_file_read(in_folder("cmyk.jpg"), &rgba, &width, &height, &message)))
            continue;
        CHECK(width == 16 && height == 16);
        for (int k = 0; k < 16 * 16; k++)
            for (int c = 0; c < 3; c++)
                CHECK(abs(rgba[4 * k + c] - stored[c] * stored[3] / 255) <= 2 && rgba[4 * k + 3] == 255);
        free(rgba);
    }
    remove(in_folder("cmyk.jpg"));
}

static void put_changed_jpeg(int marker, size_t offset, const void *bytes, size_t size)
{
    uint8_t changed[sizeof baseline_jpeg];
    size_t at = 2;                 /* byte offset of a JPEG segment; starts at the first segment */
    memcpy(changed, baseline_jpeg, sizeof changed);
    while (changed[at + 1] != marker)
        at += 2 + (size_t)(changed[at + 2] << 8 | changed[at + 3]);
    memcpy(changed + at + offset, bytes, size);
    put("a.jpg", changed, sizeof changed);
}

static void bad_jpeg(void)
{
    uint8_t most[16];
    put_changed_jpeg(0xc0, 5, "\40\0\40\0", 4);   /* sets the size in the JPEG header to 8192 x 8192 pixels */
    check_unreadable("a.jpg", "more than 512 a byte of the file");
    put_changed_jpeg(0xc0, 5, "\40\1\40\1", 4);
    check_unreadable("a.jpg", "2^26 in all");
    /* sets the chroma subsampling factors in the JPEG header to 3 x 2 and 2 x 1 */
    put_changed_jpeg(0xc0, 11, "\62\0\2\41", 4);
    check_unreadable("a.jpg", "Fractional sampling not implemented");
    put_changed_jpeg(0xc0, 9, "\4", 1);
    check_unreadable("a.jpg", "Bogus marker length");
    memset(most, 255, sizeof most);
    put_changed_jpeg(0xc4, 5, most, sizeof most);
    check_unreadable("a.jpg", "Bogus Huffman table definition");
    put_changed_jpeg(0xc4, 5, "\377", 1);
    check_unreadable("a.jpg", "Bogus Huffman table definition");
    put("a.jpg", "\377not a picture", 14);
    check_unreadable("a.jpg", "Not a JPEG file");
    remove(in_folder("a.jpg"));
}

static void damaged_jpeg(void)
{
    uint8_t bytes[sizeof baseline_jpeg + 3], *rgba;
    int width, height;
    memcpy(bytes, baseline_jpeg, sizeof baseline_jpeg - 20);
    memcpy(bytes + sizeof baseline_jpeg - 20, "\377\331", 2);
    put("a.jpg", bytes, sizeof baseline_jpeg - 18);
    check_unreadable("a.jpg", "premature end of data segment");
    memcpy(bytes, baseline_jpeg, 2);
    memcpy(bytes + 2, "\1\2\3", 3);
    memcpy(bytes + 5, baseline_jpeg + 2, sizeof baseline_jpeg - 2);
    put("a.jpg", bytes, sizeof bytes);
    if (CHECK(!fxs_image_file_read(in_folder("a.jpg"), &rgba, &width, &height, &message)))
        CHECK(hash_of(rgba, 4 * JPEG_WIDTH * JPEG_HEIGHT) == jpegs[0].hash);
    free(rgba);
    remove(in_folder("a.jpg"));
}

/* Reads a grey JPEG of 8 x 8 pixels that repeats its mean in many scans of 11 bytes. */
static void scans(void)
{
    static const uint8_t frame[] = {0xff, 0xc2, 0, 11, 8, 0, 8, 0, 8, 1, 1, 0x11, 0};
    static const uint8_t codes[] = {0xff, 0xc4, 0, 20, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    static const uint8_t scan[11] = {0xff, 0xda, 0, 8, 1, 1, 0, 0, 0, 0, 0x7f};
    uint8_t bytes[2000] = {0xff, 0xd8, 0xff, 0xdb, 0, 67, 0}, *rgba;
    int width, height;
    memset(bytes + 7, 1, 64);
    memcpy(bytes + 71, frame, sizeof frame);
    memcpy(bytes + 71 + sizeof frame, codes, sizeof codes);
    uint8_t *to = bytes + 71 + sizeof frame + sizeof codes;
    for (int count = 1; count <= 101; count++) {
        memcpy(to, scan, sizeof scan);
        to += sizeof scan;
        memcpy(to, "\377\331", 2);
        if (count < 100)
            continue;
        put("a.jpg", bytes, (size_t)(to - bytes) + 2);
        if (count > 100)
            check_unreadable("a.jpg", "more scans than a picture needs");
        else if (CHECK(!fxs_image_file_read(in_folder("a.jpg"), &rgba, &width, &height, &message))) {
            CHECK(width == 8 && height == 8 && rgba[0] == 128 && rgba[255] == 255);
            free(rgba);
        }
    }
    remove(in_folder("a.jpg"));
}
#endif

#if defined(FXS_WITH_PNG) && defined(FXS_WITH_ZLIB)
static uint8_t *put_word(uint8_t *to, size_t word)
{
    for (int i = 0; i < 4; i++)
        *to++ = (uint8_t)(word >> (24 - 8 * i));
    return to;
}

static uint8_t *put_chunk(uint8_t *to, const char *type, const void *data, size_t size)
{
    to = put_word(to, size);
    memcpy(to, type, 4);
    memcpy(to + 4, data, size);
    return put_word(to + 4 + size, crc32(0, to, (uInt)size + 4));
}

/* Writes a .png. rows: rows of pixels, each after its filter byte. palette: .png chunks before the pixels, or
   null. */
static void put_png(const char *name, const uint8_t header[13], const uint8_t *palette, size_t palette_size,
                    const uint8_t *rows, size_t size)
{
    uLongf compressed = compressBound(size);
    uint8_t *data = malloc(compressed), *bytes = malloc(compressed + palette_size + 100), *to = bytes;
    if (CHECK(data && bytes && compress(data, &compressed, rows, size) == Z_OK)) {
        memcpy(to, "\211PNG\r\n\032\n", 8);
        to = put_chunk(to + 8, "IHDR", header, 13);
        if (palette) {
            to = put_chunk(to, "PLTE", palette, 9);
            to = put_chunk(to, "tRNS", palette + 9, palette_size - 9);
        }
        to = put_chunk(to, "IDAT", data, compressed);
        to = put_chunk(to, "IEND", "", 0);
        put(name, bytes, (size_t)(to - bytes));
    }
    free(data);
    free(bytes);
}

static void put_zeros(const char *name, int side, int depth, int interlaced, size_t size)
{
    uint8_t *zeros = calloc(1, size);
    const uint8_t header[13] = {0, 0, (uint8_t)(side >> 8), (uint8_t)side, 0, 0, (uint8_t)(side >> 8), (uint8_t)side,
                                (uint8_t)depth, 6, 0, 0, (uint8_t)interlaced};
    if (CHECK(zeros != NULL))
        put_png(name, header, NULL, 0, zeros, size);
    free(zeros);
}

static void png_kinds(void)
{
    static const uint8_t palette[12] = {10, 20, 30, 40, 50, 60, 70, 80, 90, 100, 0, 255};
    static const struct {
        uint8_t depth, kind, rows[20], rgba[8];
        size_t size;
    } kinds[] = {
        {8, 0, {0, 7, 200}, {7, 7, 7, 255, 200, 200, 200, 255}, 3},
        {1, 0, {0, 64}, {0, 0, 0, 255, 255, 255, 255, 255}, 2},
        {4, 0, {0, 0x3f}, {51, 51, 51, 255, 255, 255, 255, 255}, 2},
        {16, 0, {0, 7, 255, 200, 1}, {7, 7, 7, 255, 200, 200, 200, 255}, 5},
        {8, 4, {0, 7, 8, 200, 9}, {7, 7, 7, 8, 200, 200, 200, 9}, 5},
        {8, 2, {0, 1, 2, 3, 4, 5, 6}, {1, 2, 3, 255, 4, 5, 6, 255}, 7},
        {16, 2, {0, 1, 255, 2, 0, 3, 128, 4, 1, 5, 2, 6, 3}, {1, 2, 3, 255, 4, 5, 6, 255}, 13},
        {16, 6, {0, 1, 9, 2, 9, 3, 9, 4, 9, 5, 9, 6, 9, 7, 9, 8, 9}, {1, 2, 3, 4, 5, 6, 7, 8}, 17},
        {8, 3, {0, 0, 1}, {10, 20, 30, 100, 40, 50, 60, 0}, 3},
        {2, 3, {0, 0x80}, {70, 80, 90, 255, 10, 20, 30, 100}, 2},
        /* pixels with a colour index beyond the end of the palette */
        {2, 3, {0, 0xc0}, {0, 0, 0, 255, 10, 20, 30, 100}, 2},
    };
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        const uint8_t header[13] = {0, 0, 0, 2, 0, 0, 0, 1, kinds[i].depth, kinds[i].kind, 0, 0, 0};
        uint8_t *rgba;
        int width, height;
        put_png("a.png", header, kinds[i].kind == 3 ? palette : NULL, kinds[i].kind == 3 ? sizeof palette : 0,
                kinds[i].rows, kinds[i].size);
        if (!CHECK(!fxs_image_file_read(in_folder("a.png"), &rgba, &width, &height, &message)))
            continue;
        if (!CHECK(width == 2 && height == 1 && !memcmp(rgba, kinds[i].rgba, 8)))
            printf("  kind %zu: %d %d %d %d\n", i, rgba[0], rgba[1], rgba[2], rgba[3]);
        free(rgba);
    }
    remove(in_folder("a.png"));
}

/* Returns the number of bytes of a .png's rows before compression. An interlaced picture has seven parts with
   their own rows. */
static size_t row_bytes(int side, int depth, int interlaced)
{
    static const int parts[8][4] = {{0, 0, 1, 1}, {0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4}, {0, 2, 2, 4},
                                    {1, 0, 2, 2}, {0, 1, 1, 2}};
    size_t bytes = 0;
    for (int i = interlaced ? 1 : 0; i < (interlaced ? 8 : 1); i++) {
        int width = (side - parts[i][0] + parts[i][2] - 1) / parts[i][2];
        int height = (side - parts[i][1] + parts[i][3] - 1) / parts[i][3];
        bytes += (size_t)height * (1 + (size_t)width * (size_t)depth / 2);
    }
    return bytes;
}

static void inflated_size(void)
{
    uint8_t *rgba;
    int width, height;
    for (int i = 0; i < 4; i++) {
        int depth = i & 1 ? 16 : 8, interlaced = i >> 1;
        put_zeros("a.png", 300, depth, interlaced, row_bytes(300, depth, interlaced));
        if (CHECK(!fxs_image_file_read(in_folder("a.png"), &rgba, &width, &height, &message)))
            free(rgba);
        put_zeros("a.png", 300, depth, interlaced, row_bytes(300, depth, interlaced) + 1);
        check_unreadable("a.png", "Too much image data");
        put_zeros("a.png", 300, depth, interlaced, row_bytes(300, depth, interlaced) - 1);
        check_unreadable("a.png", "Not enough image data");
    }
    put_zeros("a.png", 1, 8, 0, 1 << 24);
    check_unreadable("a.png", "Too much image data");
    put_zeros("a.png", 8192, 8, 0, 1 << 17);
    check_unreadable("a.png", "more than 512 a byte of the file");
    put_zeros("a.png", 8193, 8, 0, 1);
    check_unreadable("a.png", "2^26 in all");
    put_zeros("a.png", 0, 8, 0, 1);
    check_unreadable("a.png", "Image width is zero");
    remove(in_folder("a.png"));
}

static void little_for_much(void)
{
    enum { MOST = 8192 };
    static const int sides[] = {1024, 2048, MOST};
    static uint8_t zeros[MOST * (MOST / 8 + 1)];
    uint8_t *rgba;
    int width, height;
    for (int i = 0; i < 3; i++) {
        const int side = sides[i];
        const uint8_t high = (uint8_t)(side >> 8), header[13] = {0, 0, high, 0, 0, 0, high, 0, 1};
        put_png("a.png", header, NULL, 0, zeros, (size_t)side * (size_t)(side / 8 + 1));
        if (i)
            check_unreadable("a.png", "more than 512 a byte of the file; as a .ppm");
        else if (CHECK(!fxs_image_file_read(in_folder("a.png"), &rgba, &width, &height, &message)))
            free(rgba);
    }
    remove(in_folder("a.png"));
}

/* Writes a .png with an additional chunk of `size` bytes. wrong: number that is added to the checksum of the
   chunk. */
static void put_chunked(const char *type, size_t size, int wrong)
{
    static const uint8_t header[13] = {0, 0, 0, 1, 0, 0, 0, 1, 8, 0, 0, 0, 0};
    static const uint8_t data[] = {0x78, 1, 1, 2, 0, 0xfd, 0xff, 0, 7, 0, 9, 0, 8};
    uint8_t *bytes = calloc(1, size + 200), *content = calloc(1, size + 1), *to = bytes;
    if (CHECK(bytes && content)) {
        memcpy(to, "\211PNG\r\n\032\n", 8);
        to = put_chunk(to + 8, "IHDR", header, sizeof header);
        to = put_chunk(to, type, content, size);
        to[-1] = (uint8_t)(to[-1] + wrong);
        to = put_chunk(to, "IDAT", data, sizeof data);
        put("a.png", bytes, (size_t)(put_chunk(to, "IEND", "", 0) - bytes));
    }
    free(bytes);
    free(content);
}

static void chunks(void)
{
    static const char *const types[] = {"iCCP", "gAMA", "tEXt", "abCd"};
    uint8_t *rgba;
    int width, height;
    for (int i = 0; i < 4; i++) {
        put_chunked(types[i], i == 3 ? 9000000 : 5, 0);
        if (CHECK(!fxs_image_file_read(in_folder("a.png"), &rgba, &width, &height, &message)))
            CHECK(!memcmp(rgba, "\7\7\7\377", 4));
        free(rgba);
        put_chunked(types[i], 5, 1);
        check_unreadable("a.png", "CRC error");
    }
    put_chunked("AbCd", 5, 0);
    check_unreadable("a.png", "unhandled critical chunk");
    put_chunked("tRNS", 5, 0);
    check_unreadable("a.png", "tRNS");
    put("a.png", "\211not a picture", 14);
    check_unreadable("a.png", "Not a PNG file");
    remove(in_folder("a.png"));
}
#endif

static int near(double a, double b)
{
    return fabs(a - b) < 1e-9;
}

static void metrics_equal(void)
{
    struct fxs_metrics metrics;
    make_image(0);
    memcpy(other, image, sizeof image);
    for (int i = 3; i < 4 * PIXELS; i += 4)
        other[i] = random_byte();   /* changes only alpha, which the metrics must ignore */
    CHECK(!fxs_metrics_compare(image, other, WIDTH, HEIGHT, &metrics));
    CHECK(metrics.mse == 0 && isinf(metrics.psnr) && metrics.psnr > 0 && metrics.largest == 0);
    CHECK(near(metrics.ssim, 1));
}

/* Compares two pictures of one colour each, a and b. Their variances are 0, so SSIM = (2 a b + c1) / (a^2 + b^2
   + c1). */
static void metrics_flat(void)
{
    static const int sizes[][2] = {{WIDTH, HEIGHT}, {11, 11}, {WIDTH, 4}, {1, HEIGHT}, {1, 1}, {10, 12}};
    const double c1 = 6.5025;
    struct fxs_metrics metrics;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        memset(image, 100, sizeof image);
        memset(other, 110, sizeof other);
        CHECK(!fxs_metrics_compare(image, other, sizes[i][0], sizes[i][1], &metrics));
        CHECK(metrics.mse == 100 && metrics.largest == 10 && near(metrics.psnr, 10 * log10(650.25)));
        CHECK(near(metrics.ssim, (2 * 100 * 110 + c1) / (100 * 100 + 110 * 110 + c1)));
    }
}

static void metrics_pixel(void)
{
    struct fxs_metrics metrics;
    memset(image, 0, sizeof image);
    memset(other, 0, sizeof other);
    other[4 * 300 + 1] = 255;
    CHECK(!fxs_metrics_compare(image, other, WIDTH, HEIGHT, &metrics));
    CHECK(near(metrics.mse, 65025.0 / (3 * PIXELS)) && metrics.largest == 255);
    CHECK(near(metrics.psnr, 10 * log10(3 * PIXELS)));
    CHECK(metrics.ssim < 1 && metrics.ssim > 2.0 / 3);
    struct fxs_metrics rest;
    fxs_metrics_without_ssim(image, other, WIDTH, HEIGHT, &rest);
    CHECK(rest.mse == metrics.mse && rest.psnr == metrics.psnr && rest.largest == 255 && isnan(rest.ssim));
}

/* Computes the SSIM of Wang et al. 2004 for a channel, with two-dimensional weights and centred moments. */
static double plain_ssim(int channel)
{
    double sum = 0, c1 = 6.5025, c2 = 58.5225, total = 0, weight[11][11];
    for (int y = 0; y < 11; y++)
        for (int x = 0; x < 11; x++)
            total += weight[y][x] = exp(-((x - 5) * (x - 5) + (y - 5) * (y - 5)) / 4.5);
    for (int top = 0; top + 11 <= HEIGHT; top++)
        for (int left = 0; left + 11 <= WIDTH; left++) {
            double mean_a = 0, mean_b = 0, aa = 0, bb = 0, ab = 0;
            for (int pass = 0; pass < 2; pass++)
                for (int y = 0; y < 11; y++)
                    for (int x = 0; x < 11; x++) {
                        int i = 4 * ((top + y) * WIDTH + left + x) + channel;
                        double w = weight[y][x] / total, a = image[i], b = other[i];
                        mean_a += pass ? 0 : w * a;
                        mean_b += pass ? 0 : w * b;
                        aa += pass ? w * (a - mean_a) * (a - mean_a) : 0;
                        bb += pass ? w * (b - mean_b) * (b - mean_b) : 0;
                        ab += pass ? w * (a - mean_a) * (b - mean_b) : 0;
                    }
            sum += (2 * mean_a * mean_b + c1) * (2 * ab + c2) /
                   ((mean_a * mean_a + mean_b * mean_b + c1) * (aa + bb + c2));
        }
    return sum / ((HEIGHT - 10) * (WIDTH - 10));
}

static void metrics_plain(void)
{
    struct fxs_metrics metrics, swapped;
    make_image(1);
    for (int i = 0; i < 4 * PIXELS; i++)
        other[i] = (uint8_t)((3 * image[i] + random_byte()) / 4);
    CHECK(!fxs_metrics_compare(image, other, WIDTH, HEIGHT, &metrics));
    CHECK(near(metrics.ssim, (plain_ssim(0) + plain_ssim(1) + plain_ssim(2)) / 3));
    CHECK(!fxs_metrics_compare(other, image, WIDTH, HEIGHT, &swapped));
    CHECK(swapped.mse == metrics.mse && near(swapped.ssim, metrics.ssim));
}

static void difference(void)
{
    const uint8_t a[8] = {10, 10, 200, 0, 0, 5, 255, 9}, b[8] = {10, 11, 100, 0, 31, 0, 223, 200};
    const uint8_t expected[8] = {0, 8, 255, 255, 248, 40, 255, 255};
    uint8_t *out = 0;
    int width = 0, height = 0;
    CHECK(!fxs_metrics_difference(in_folder("a.png"), a, b, 2, 1, &message));
    CHECK(!fxs_image_file_read(in_folder("a.png"), &out, &width, &height, &message));
    CHECK(width == 2 && height == 1 && !memcmp(out, expected, 8));
    free(out);
    remove(in_folder("a.png"));
}

int main(void)
{
    if (!mkdtemp(folder)) {
        perror(folder);
        return 1;
    }
    RUN(round_trips);
    RUN(raw);
    RUN(endings);
    RUN(qualities);
    RUN(frames_of_films);
    RUN(jpg);
#ifdef FXS_WITH_WEBP
    RUN(webp);
#endif
    RUN(bad_targets);
    RUN(refused_targets);
    RUN(unwritable_folder);
    RUN(full_disk);
    RUN(bad_images);
    RUN(ppm_comment);
#ifdef FXS_WITH_JPEG
    RUN(jpeg);
    RUN(cmyk);
    RUN(bad_jpeg);
    RUN(damaged_jpeg);
    RUN(scans);
#endif
#if defined(FXS_WITH_PNG) && defined(FXS_WITH_ZLIB)
    RUN(inflated_size);
    RUN(little_for_much);
    RUN(chunks);
    RUN(png_kinds);
#endif
    RUN(metrics_equal);
    RUN(metrics_flat);
    RUN(metrics_pixel);
    RUN(metrics_plain);
    RUN(difference);
    CHECK(!rmdir(folder));
    return check_report();
}
