/* Tests photographs of cameras and phones: EXIF, orientations, damaged EXIF, HEIF, WebP. */
#include "photo_folder.h"
#include "heif_bytes.h"
#include "jpeg_bytes.h"
#include "src/image/photograph.h"
#include <fixsplat/image.h>

static uint8_t *rgba;
static int width, height;
static fxs_exif exif;

enum { SHORT = 3, LONG = 4, RATIONAL = 5, SEGMENT = 400 };

typedef struct maker {
    uint8_t bytes[SEGMENT];        /* bytes of an EXIF segment: "Exif\0\0" and a TIFF file */
    size_t size;
    int is_big;
} maker;

static void add(maker *m, uint32_t value, size_t bytes)
{
    for (size_t i = 0; i < bytes; i++)
        m->bytes[m->size++] = (uint8_t)(value >> 8 * (m->is_big ? bytes - 1 - i : i));
}

static void add_entry(maker *m, uint32_t tag, uint32_t type, uint32_t value)
{
    add(m, tag, 2);
    add(m, type, 2);
    add(m, 1, 4);
    add(m, value, type == SHORT ? 2 : 4);
    if (type == SHORT)
        add(m, 0, 2);
}

typedef struct facts {
    int is_big;
    uint32_t orientation, type, seconds[2], aperture[2], sensitivity, focal[2];
} facts;

static const facts ordinary = {0, 6, SHORT, {1, 60}, {28, 10}, 400, {425, 100}};

static void make_exif(maker *m, const facts *f)
{
    const uint32_t *const rationals[] = {f->seconds, f->aperture, f->focal};
    const uint32_t inner = 8 + 2 + 2 * 12 + 4, outside = inner + 2 + 4 * 12 + 4;
    memcpy(m->bytes, f->is_big ? "Exif\0\0MM" : "Exif\0\0II", 8);
    m->size = 8;
    m->is_big = f->is_big;
    add(m, 42, 2);
    add(m, 8, 4);
    add(m, 2, 2);
    add_entry(m, 0x112, f->type, f->orientation);
    add_entry(m, 0x8769, LONG, inner);
    add(m, 0, 4);
    add(m, 4, 2);
    add_entry(m, 0x829a, RATIONAL, outside);
    add_entry(m, 0x829d, RATIONAL, outside + 8);
    add_entry(m, 0x8827, SHORT, f->sensitivity);
    add_entry(m, 0x920a, RATIONAL, outside + 16);
    add(m, 0, 4);
    for (int i = 0; i < 6; i++)
        add(m, rationals[i / 2][i % 2], 4);
}

static void put_jpg(const char *name, const uint8_t *jpg, size_t size, const uint8_t *segment, size_t bytes)
{
    static uint8_t whole[1 << 17];
    memcpy(whole, jpg, 2);
    whole[2] = 0xff;
    whole[3] = 0xe1;
    whole[4] = (uint8_t)((bytes + 2) >> 8);
    whole[5] = (uint8_t)(bytes + 2);
    memcpy(whole + 6, segment, bytes);
    memcpy(whole + 6 + bytes, jpg + 2, size - 2);
    put_file(name, whole, size + 4 + bytes);
}

static void put_with(const char *name, const facts *f)
{
    maker m;
    make_exif(&m, f);
    put_jpg(name, baseline_jpeg, sizeof baseline_jpeg, m.bytes, m.size);
}

static int read_file(const char *name)
{
    free(rgba);
    return fxs_photograph_read(in_folder(name), &rgba, &width, &height, &exif, &message);
}

#if defined(FXS_WITH_JPEG) && defined(FXS_WITH_EXIF)
static void exposures(void)
{
    static const facts unknown[] = {
        {0, 1, SHORT, {0, 60}, {28, 10}, 400, {1, 1}},         {0, 1, SHORT, {1, 0}, {28, 10}, 400, {1, 1}},
        {0, 1, SHORT, {1, 60}, {0, 10}, 400, {1, 1}},          {0, 1, SHORT, {1, 60}, {28, 0}, 400, {1, 1}},
        {0, 1, SHORT, {1, 60}, {28, 10}, 0, {1, 1}},           {0, 1, SHORT, {1, 60}, {28, 10}, 65535, {1, 1}},
        {0, 1, SHORT, {4294967295u, 1}, {28, 10}, 400, {1, 1}}, {0, 1, SHORT, {1, 60}, {4294967295u, 1}, 400, {1, 1}},
    };
    for (int is_big = 0; is_big < 2; is_big++) {
        facts f = ordinary;
        f.is_big = is_big;
        put_with("a.jpg", &f);
        if (CHECK(!read_file("a.jpg")))
            CHECK(exif.exposure == 1.0 / 60 * 400 / (2.8 * 2.8) && exif.orientation == 6 && strstr(exif.lens, "4.250"));
    }
    for (size_t i = 0; i < sizeof unknown / sizeof *unknown; i++) {
        put_with("a.jpg", &unknown[i]);
        CHECK(!read_file("a.jpg") && exif.exposure == 0);
    }
    put_file("a.jpg", baseline_jpeg, sizeof baseline_jpeg);
    CHECK(!read_file("a.jpg") && exif.exposure == 0 && exif.orientation == 1 && !*exif.lens);
}

static void lies(void)
{
    static uint8_t noise[65533], plain[4 * JPEG_WIDTH * JPEG_HEIGHT];
    maker m;
    put_file("a.jpg", baseline_jpeg, sizeof baseline_jpeg);
    if (!CHECK(!read_file("a.jpg")))
        return;
    memcpy(plain, rgba, sizeof plain);
    make_exif(&m, &ordinary);
    for (size_t size = 0; size <= m.size; size++) {
        put_jpg("a.jpg", baseline_jpeg, sizeof baseline_jpeg, m.bytes, size);
        CHECK(!read_file("a.jpg") && !memcmp(rgba, plain, sizeof plain));
        CHECK(size < m.size || exif.orientation == 6);
    }
    for (size_t i = 0; i < 3 * m.size; i++) {
        static const uint8_t changes[3] = {0xff, 0x80, 0x01};
        const uint8_t old = m.bytes[i / 3];
        m.bytes[i / 3] ^= changes[i % 3];
        put_jpg("a.jpg", baseline_jpeg, sizeof baseline_jpeg, m.bytes, m.size);
        CHECK(!read_file("a.jpg") && !memcmp(rgba, plain, sizeof plain));
        CHECK(exif.orientation >= 1 && exif.orientation <= 8 && exif.exposure >= 0 && exif.exposure < 1e14 &&
              !strchr(exif.lens, '\n'));
        m.bytes[i / 3] = old;
    }
    memcpy(noise, m.bytes, m.size);
    for (int round = 0; round < 20; round++) {
        for (size_t i = 14; i < sizeof noise; i++)
            noise[i] = (uint8_t)random_number();
        put_jpg("a.jpg", baseline_jpeg, sizeof baseline_jpeg, noise, sizeof noise);
        CHECK(!read_file("a.jpg") && !memcmp(rgba, plain, sizeof plain));
    }
}

static int read_with(int camera_width, int camera_height)
{
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    say("1 PINHOLE %d %d 25 25 12 10\n", camera_width, camera_height);
    put_text("one/cameras.txt");
    return read_photos("one", &options);
}

static void shown_at(int orientation, int x, int y, int w, int h, int at[2])
{
    static const struct {
        int is_turned, from_right, from_bottom;
    } of[9] = {{0, 0, 0}, {0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 0, 1}};
    at[0] = of[orientation].is_turned ? y : x;
    at[1] = of[orientation].is_turned ? x : y;
    at[0] = of[orientation].from_right ? (of[orientation].is_turned ? h : w) - 1 - at[0] : at[0];
    at[1] = of[orientation].from_bottom ? (of[orientation].is_turned ? w : h) - 1 - at[1] : at[1];
}

static void check_turned(int orientation)
{
    const uint8_t *pixels = photos.fit[0].pixels;
    for (int y = 0; y < JPEG_HEIGHT; y++)
        for (int x = 0; x < JPEG_WIDTH; x++) {
            int at[2];
            shown_at(orientation, x, y, JPEG_WIDTH, JPEG_HEIGHT, at);
            const int shown = orientation > 4 ? JPEG_HEIGHT : JPEG_WIDTH;
            if (!CHECK(!memcmp(pixels + 3 * (at[1] * shown + at[0]), rgba + 4 * (y * JPEG_WIDTH + x), 3)))
                return;
        }
}

/* Tests photographs with an EXIF orientation. If the orientation swaps the sides, a camera of the swapped size gets
   rotated pixels. Otherwise the camera is refused. */
static void turns(void)
{
    facts f = ordinary;
    make_folder("one");
    make_folder("one/images");
    say("1 1 0 0 0 0 0 5 1 a.jpg\n\n");
    put_text("one/images.txt");
    say("1 0 0 0 255 0 0 0\n");
    put_text("one/points3D.txt");
    for (int i = 0; i < 22; i++) {
        f.orientation = (uint32_t)i / 2;
        f.is_big = i % 2;
        put_with("one/images/a.jpg", &f);
        CHECK(!read_file("one/images/a.jpg"));
        if (CHECK(!read_with(JPEG_WIDTH, JPEG_HEIGHT))) {
            CHECK(photos.fit[0].view.width == JPEG_WIDTH && photos.fit[0].exposure == exif.exposure);
            check_turned(1);
        }
        if (f.orientation >= 5 && f.orientation <= 8) {
            if (CHECK(!read_with(JPEG_HEIGHT, JPEG_WIDTH)))
                check_turned((int)f.orientation);
        } else {
            CHECK(read_with(JPEG_HEIGHT, JPEG_WIDTH) == FXS_ERR_FILE && strstr(message.text, "of another proportion"));
        }
    }
    f.orientation = 6;
    put_with("one/images/a.jpg", &f);
    CHECK(!read_with(2 * JPEG_HEIGHT, 2 * JPEG_WIDTH) && photos.fit[0].view.width == JPEG_HEIGHT);
    CHECK(read_with(JPEG_WIDTH, JPEG_WIDTH) == FXS_ERR_FILE);
    f.type = LONG;                 /* EXIF orientation as a 32-bit integer, though the standard wants 16 bits */
    put_with("one/images/a.jpg", &f);
    CHECK(!read_with(JPEG_HEIGHT, JPEG_WIDTH));
}

static void square(void)
{
    enum { SIDE = 16 };
    static uint8_t picture[4 * SIDE * SIDE];
    fxs_encoded jpg = {0};
    maker m;
    for (size_t i = 0; i < sizeof picture; i++)
        picture[i] = (uint8_t)(i % 4 == 3 ? 255 : i / 4 % SIDE * 15);
    if (fxs_image_encode(FXS_IMAGE_JPG, 90, picture, SIDE, SIDE, &jpg, &message))
        SKIP("built without stb");
    make_exif(&m, &ordinary);
    put_jpg("one/images/a.jpg", jpg.bytes, jpg.size, m.bytes, m.size);
    CHECK(!read_file("one/images/a.jpg") && exif.orientation == 6);
    if (CHECK(!read_with(SIDE, SIDE)))
        for (int i = 0; i < SIDE * SIDE; i++)
            CHECK(!memcmp(photos.fit[0].pixels + 3 * i, rgba + 4 * i, 3));
    fxs_encoded_free(&jpg);
}
#endif

#ifdef _WIN32
static const char why_not[] = "the build for Windows does not read";
#else
static const char why_not[] = "needs libheif";
#endif

static void heif_missing(void)
{
    put_file("a.heic", turned_heif, sizeof turned_heif);
    CHECK(read_file("a.heic") == FXS_ERR_UNSUPPORTED && strstr(message.text, why_not) && !rgba);
}

static int heif_is_here(void)
{
    put_file("a.heic", turned_heif, sizeof turned_heif);
    return read_file("a.heic") != FXS_ERR_UNSUPPORTED;
}

static void put_changed_heif(const char *name, size_t offset, const void *bytes, size_t size)
{
    static uint8_t changed[sizeof turned_heif];
    memcpy(changed, turned_heif, sizeof changed);
    for (size_t at = 0; at + offset + size <= sizeof changed; at++)
        if (!memcmp(changed + at, name, strlen(name)))
            memcpy(changed + at + offset, bytes, size);
    put_file("a.heic", changed, sizeof changed);
}

static void heif(void)
{
    if (!CHECK(!read_file("a.heic") && width == HEIF_WIDTH && height == HEIF_HEIGHT))
        return;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const uint8_t *c = rgba + 4 * (y * width + x);
            const int u = y, v = HEIF_WIDTH - 1 - x;
            CHECK(abs(c[0] - 40 - 7 * u) <= 8 && abs(c[1] - 200 + 6 * v) <= 8 && abs(c[2] - 60 - 3 * u - 4 * v) <= 8 &&
                  c[3] == 255);
        }
    const uint32_t hash = hash_on(2166136261u, rgba, 4 * HEIF_WIDTH * HEIF_HEIGHT);
    if (!CHECK(hash == 0x9bc37876u))
        printf("  heif: 0x%x\n", (unsigned)hash);
    CHECK(exif.orientation == 1);
#ifdef FXS_WITH_EXIF
    CHECK(exif.exposure == 1.0 / 60 * 400 / (2.8 * 2.8) && !strcmp(exif.lens, "Maker Model 4.250 26.000"));
#endif
    CHECK(!fxs_image_file_read(in_folder("a.heic"), &rgba, &width, &height, &message));
}

/* Computes colours by H.273 in doubles, from pixels in BT.601 full range. */
static void heif_colours(void)
{
    static const struct {
        /* colour box in the file: codes by H.273 of primaries, transfer function and matrix, then a bit for full
           range */
        uint8_t stated[7];
        double red, blue;
    } kinds[] = {{{0, 1, 0, 13, 0, 1, 0x80}, 0.2126, 0.0722}, {{0, 1, 0, 13, 0, 9, 0x80}, 0.2627, 0.0593},
                 {{0, 1, 0, 13, 0, 1, 0}, 0.2126, 0.0722},    {{0, 1, 0, 13, 0, 5, 0}, 0.299, 0.114}};
    static uint8_t first[4 * HEIF_WIDTH * HEIF_HEIGHT];
    put_file("a.heic", turned_heif, sizeof turned_heif);
    if (!CHECK(!read_file("a.heic")))
        return;
    memcpy(first, rgba, sizeof first);
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        const double r = kinds[i].red, b = kinds[i].blue, g = 1 - r - b;
        const int is_full = kinds[i].stated[6];
        put_changed_heif("nclx", 4, kinds[i].stated, 7);
        if (!CHECK(!read_file("a.heic")))
            continue;
        for (size_t k = 0; k < sizeof first; k += 4) {
            const double luma = 0.299 * first[k] + 0.587 * first[k + 1] + 0.114 * first[k + 2];
            const double cr = (first[k] - luma) / 1.402 * (is_full ? 1 : 255.0 / 224);
            const double cb = (first[k + 2] - luma) / 1.772 * (is_full ? 1 : 255.0 / 224);
            const double y = is_full ? luma : (luma - 16) * 255 / 219;
            const double expected[3] = {y + 2 * (1 - r) * cr, y - 2 * b * (1 - b) / g * cb - 2 * r * (1 - r) / g * cr,
                                        y + 2 * (1 - b) * cb};
            for (size_t c = 0; c < 3; c++)
                CHECK(fabs(fmin(fmax(expected[c], 0), 255) - rgba[k + c]) < 2.5);
        }
    }
    put_changed_heif("nclx", 4, "\0\1\0\15\0\12\0", 7);
    CHECK(read_file("a.heic") == FXS_ERR_FILE && strstr(message.text, "colours that are not known"));
}

static void bad_heif(void)
{
    for (size_t size = 12; size < sizeof turned_heif; size++) {
        put_file("a.heic", turned_heif, size);
        if (!CHECK(read_file("a.heic") == FXS_ERR_FILE && !rgba && !strchr(message.text, '\n')))
            printf("  %zu bytes\n", size);
    }
    put_changed_heif("ispe", 8, "\0\0\100\0\0\0\100\0", 8);
    CHECK(read_file("a.heic") == FXS_ERR_FILE);
    put_changed_heif("ispe", 8, "\177\377\377\377\177\377\377\377", 8);
    CHECK(read_file("a.heic") == FXS_ERR_FILE || (width <= 64 && height <= 64));
    put_changed_heif("ispe", 8, "\0\0\0\0\0\0\0\0", 8);
    CHECK(read_file("a.heic") == FXS_ERR_FILE);
    /* Changes the picture size in the video stream of a HEIF to 32766 x 32766, 8190 x 1022 and 2046 x 1022. */
    put_changed_heif("\x42\x01\x01\x03\x70", 18, "\xa0\x00\x3f\xff\x80\x01\xff\xfc", 8);
    CHECK(read_file("a.heic") == FXS_ERR_FILE && strstr(message.text, "a stream of more pixels"));
    put_changed_heif("\x42\x01\x01\x03\x70", 18, "\xa0\x00\xff\xf8\x03\xff\x00", 7);
    CHECK(read_file("a.heic") == FXS_ERR_FILE && strstr(message.text, "a stream of more pixels"));
    put_changed_heif("\x42\x01\x01\x03\x70", 18, "\xa0\x03\xff\x80\x3f\xf0", 6);
    CHECK(!read_file("a.heic") || !strstr(message.text, "a stream of more pixels"));
    /* A HEIF picture that is its own tile or its own alpha overflows the stack of libheif 1.15, so the reader must
       refuse the file. */
    put_changed_heif("dimg", 8, "\0\2", 2);
    CHECK(read_file("a.heic") == FXS_ERR_FILE && strstr(message.text, "in circles"));
    put_changed_heif("dimg", 0, "auxl\0\1\0\1\0\1", 10);
    CHECK(read_file("a.heic") == FXS_ERR_FILE && strstr(message.text, "in circles"));
    for (size_t i = 0; i < sizeof turned_heif; i += i < 700 ? 1 : 7) {
        static uint8_t changed[sizeof turned_heif];
        memcpy(changed, turned_heif, sizeof changed);
        changed[i] ^= 0x5a;
        put_file("a.heic", changed, sizeof changed);
        const int error = read_file("a.heic");
        CHECK(error ? !rgba && message.text[0] && !strchr(message.text, '\n') : width >= 1 && height >= 1);
    }
}

static void put_chained_heif(const void *bytes, size_t size, size_t times)
{
    enum { ZEROS = 1 << 16 };
    static uint8_t chained[(1 << 19) + ZEROS];
    memset(chained, 0, sizeof chained);
    memcpy(chained, turned_heif, sizeof turned_heif);
    for (size_t i = 0; i < times; i++)
        memcpy(chained + sizeof turned_heif + i * size, bytes, size);
    put_file("a.heic", chained, sizeof turned_heif + times * size + ZEROS);
}

/* HEIF files with references to pictures. If each contained all later references, reading would take quadratic time,
   so such files are refused. */
static void heif_references(void)
{
    static const uint8_t child[] = {0, 0, 0, 12, 'i', 'r', 'e', 'f', 0, 0, 0, 0};
    static const uint8_t numbers[] = {'i', 'r', 'e', 'f', 0, 0, 0, 0, 0, 1, 0, 0, 'd', 'i', 'm', 'g', 0, 9, 255, 255};
    static const uint8_t plain[] = {0, 0, 0, 12, 'c', 'd', 's', 'c', 0, 3, 0, 0};
    put_chained_heif(child, sizeof child, 20000);
    CHECK(read_file("a.heic") == FXS_ERR_FILE && strstr(message.text, "damaged: references of pictures"));
    put_chained_heif(numbers, sizeof numbers, 12000);
    CHECK(read_file("a.heic") == FXS_ERR_FILE && strstr(message.text, "damaged: references of pictures"));
    put_chained_heif(child, sizeof child, 300);
    CHECK(!read_file("a.heic") || !strstr(message.text, "references of pictures"));
    static uint8_t whole[12 + 30000 * sizeof plain] = {0, 5, 0x7e, 0x4c, 'i', 'r', 'e', 'f'};
    for (size_t i = 0; i < 30000; i++)
        memcpy(whole + 12 + i * sizeof plain, plain, sizeof plain);
    put_chained_heif(whole, sizeof whole, 1);
    CHECK(!read_file("a.heic") || !strstr(message.text, "references of pictures"));
}

static void heif_to_jpg(void)
{
    put_file("a.heic", turned_heif, sizeof turned_heif);
    const int error = fxs_photograph_to_jpg(in_folder("a.heic"), in_folder("b.jpg"), &message);
    if (error == FXS_ERR_UNSUPPORTED)
        SKIP("built without stb");
    CHECK(!error && !read_file("a.heic"));
    uint8_t *first = rgba;
    rgba = NULL;
    if (CHECK(!read_file("b.jpg") && width == HEIF_WIDTH && height == HEIF_HEIGHT))
        for (int i = 0; i < 4 * width * height; i++)
            CHECK(abs(first[i] - rgba[i]) <= 4);
    free(first);
    CHECK(exif.orientation == 1);
#ifdef FXS_WITH_EXIF
    CHECK(exif.exposure == 1.0 / 60 * 400 / (2.8 * 2.8) && !strcmp(exif.lens, "Maker Model 4.250 26.000"));
#endif
    put_file("a.heic", turned_heif, 500);
    CHECK(fxs_photograph_to_jpg(in_folder("a.heic"), in_folder("c.jpg"), &message) == FXS_ERR_FILE);
    CHECK(access(in_folder("c.jpg"), F_OK) != 0);
    CHECK(fxs_photograph_to_jpg(in_folder("b.jpg"), in_folder("none/c.jpg"), &message) == FXS_ERR_FILE);
}

static void webp(void)
{
    enum { WIDE = 19, HIGH = 13 };
    static uint8_t picture[4 * WIDE * HIGH];
    fxs_encoded encoded = {0};
    for (size_t i = 0; i < sizeof picture; i++)
        picture[i] = (uint8_t)random_number();
    if (fxs_image_encode(FXS_IMAGE_WEBP, 0, picture, WIDE, HIGH, &encoded, &message)) {
        put_file("a.webp", "RIFF\32\0\0\0WEBPVP8L\15\0\0\0\x2f", 21);
        CHECK(read_file("a.webp") == FXS_ERR_UNSUPPORTED && strstr(message.text, "built without libwebp"));
        SKIP("built without libwebp");
    }
    for (size_t size = 12; size < encoded.size; size++) {
        put_file("a.webp", encoded.bytes, size);
        CHECK(read_file("a.webp") == FXS_ERR_FILE && !rgba && !strchr(message.text, '\n'));
    }
    put_file("a.webp", encoded.bytes, encoded.size);
    if (CHECK(!read_file("a.webp") && width == WIDE && height == HIGH))
        CHECK(!memcmp(rgba, picture, sizeof picture) && exif.orientation == 1);
    put_file("a.webp", "RIFF\32\0\0\0WEBPVP8L\15\0\0\0\x2f\377\377\377\17\0\0\0\0\0\0\0\0", 33);
    CHECK(read_file("a.webp") == FXS_ERR_FILE);
    put_file("a.webp", "RIFF\26\0\0\0WEBPVP8X\12\0\0\0\2\0\0\0\7\0\0\7\0\0", 30);
    CHECK(read_file("a.webp") == FXS_ERR_FILE && strstr(message.text, "several pictures"));
    fxs_encoded_free(&encoded);
}

static void names(void)
{
    static const char *const some[] = {"a.png", "a.JPG", "b.c.jpeg", "a.ppm", "a.WebP"};
    static const char *const heifs[] = {"IMG_0001.HEIC", "a.heif", "DSC.HIF"};
    static const char *const none[] = {".jpg", "jpg", "a.gif", "a.mov", "a.jpg.txt", ""};
    for (size_t i = 0; i < sizeof some / sizeof *some; i++)
        CHECK(fxs_photograph_kind_of(some[i]) == FXS_PHOTOGRAPH);
    for (size_t i = 0; i < sizeof heifs / sizeof *heifs; i++)
        CHECK(fxs_photograph_kind_of(heifs[i]) == FXS_PHOTOGRAPH_HEIF);
    for (size_t i = 0; i < sizeof none / sizeof *none; i++)
        CHECK(fxs_photograph_kind_of(none[i]) == FXS_PHOTOGRAPH_NONE);
}

static void tests(void)
{
    RUN(names);
#if defined(FXS_WITH_JPEG) && defined(FXS_WITH_EXIF)
    RUN(exposures);
    RUN(lies);
    RUN(turns);
    RUN(square);
#endif
    if (heif_is_here()) {
        RUN(heif);
        RUN(heif_colours);
        RUN(bad_heif);
        RUN(heif_references);
#ifdef FXS_WITH_JPEG
        RUN(heif_to_jpg);
#endif
    } else {
        RUN(heif_missing);
    }
    RUN(webp);
    free(rgba);
    fxs_photos_free(&photos);
}

int main(void)
{
    return in_a_folder(tests);
}
