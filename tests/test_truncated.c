/* Truncates a file of every format at every length. The reader must refuse the file with a message, or read a file
   that looks complete. */
#include <limits.h>
#include <sys/stat.h>

#include <fixsplat/camera.h>
#include <fixsplat/fit.h>
#include <fixsplat/image.h>
#include <fixsplat/scene.h>
#include <fixsplat/internal/packed.h>
#include "every_format_bytes.h"
#include "jpeg_bytes.h"
#include "packed_scene.h"

#define EITHER LONG_MIN            /* expected result if a truncated file may be either read or refused */

static char folder[] = "/tmp/fixsplat-truncated-XXXXXX";
static const char *words;          /* text that the error message must contain; null: not checked */

static void add_file_of(const char *from, const char *name)
{
    FILE *stream = fopen(from, "rb");
    size = stream ? fread(bytes, 1, MAX_FILE, stream) : 0;
    CHECK(stream && size > 0 && !fclose(stream) && !unlink(from));
    add_file(name);
}

static const char *in_folder(const char *name)
{
    static char full[128];
    snprintf(full, sizeof full, "%s/%.31s", folder, name);
    return full;
}

static long read_scene(const char *name)
{
    static fxs_gaussian gaussians[64];
    fxs_scene_file *file;
    long count, total = 0;
    const int error = fxs_scene_file_open(name, NULL, &file, &info, &message);
    if (error) {
        CHECK(file == NULL);
        return error;
    }
    while ((count = fxs_scene_file_read(file, gaussians, 1, &message)) > 0)
        total += count;
    CHECK(count < 0 || total == (long)info.count);
    CHECK(fxs_scene_file_rewind(file, &message) == 0);
    CHECK(fxs_scene_file_read(file, gaussians, 64, &message) == (count < 0 ? count : total));
    fxs_scene_file_close(file);
    return count < 0 ? count : total;
}

static long any_fault(const struct made_file *f, size_t length)
{
    (void)f, (void)length;
    return FXS_ERR_FILE;
}

static long fault(const char *said)
{
    words = said;
    return FXS_ERR_FILE;
}

static size_t ply_header(const struct made_file *f)
{
    return (size_t)(strstr((const char *)f->data, "end_header\n") - (const char *)f->data) + 11;
}

static long of_ply(const struct made_file *f, size_t length)
{
    static char text[80];
    snprintf(text, sizeof text, "at least %zu bytes, the file has %zu", f->size, length);
    return fault(length < 3 ? "not a scene file" : length < ply_header(f) ? "no end_header" : text);
}

/* Returns the expected result for a truncated ASCII .ply. A cut within the last number is undetectable. */
static long of_ascii_ply(const struct made_file *f, size_t length)
{
    size_t last = f->size - 2;
    while (f->data[last - 1] != ' ')
        last--;
    if (length > last)
        return f->data[length - 1] == '-' ? FXS_ERR_FILE : GAUSSIANS;
    return fault(length < last - 1 ? "" : "vertex 3 of 3: the file ends early");
}

static long of_ascii_lists(const struct made_file *f, size_t length)
{
    return length < f->size - 3 ? FXS_ERR_FILE : EITHER;
}

static void make_ascii_ply(void)
{
    put_ply_header("ascii", "");
    for (int i = 0; i < 9; i++)
        put("property float f_rest_%d\n", i);
    put("end_header\n");
    for (int row = 0; row < GAUSSIANS; row++) {
        for (int i = 0; i < 23; i++)
            put("%.17g ", (i - row - 30) / 64.0);
        put("\n");
    }
    add_file("a.ply");
}

static void put_zeros(int encoding, int count, int width)
{
    for (int i = 0; i < (encoding ? count * width : count); i++)
        if (encoding)
            put_u8(0);
        else
            put("0 ");
}

/* Makes a .ply with list properties. Its header gives only a lower bound of the size. encoding: 0 ASCII, 1
   little-endian, 2 big-endian. */
static void make_lists_ply(int encoding)
{
    static const char *const encodings[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    put_ply_header(encodings[encoding], "property list uchar double a\n");
    put("property list int ushort b\nend_header\n");
    for (int row = 0; row < GAUSSIANS; row++) {
        if (encoding)
            put_u8(row);
        else
            put("%d ", row);
        put_zeros(encoding, row, 8);
        put_zeros(encoding, 14, 4);
        if (encoding)
            put_u32(encoding == 1 ? (uint32_t)row : (uint32_t)row << 24);
        else
            put("%d ", row);
        put_zeros(encoding, row, 2);
        put("%s", encoding ? "" : "\n");
    }
    add_file("a.ply");
}

static void make_ascii_lists(void) { make_lists_ply(0); }
static void make_little_lists(void) { make_lists_ply(1); }
static void make_big_lists(void) { make_lists_ply(2); }

/* Returns the expected result for a truncated .splat. A file of whole records is valid. */
static long of_splat(const struct made_file *f, size_t length)
{
    (void)f;
    return length && length % 32 == 0 ? (long)length / 32 : fault("not a scene file of a known format");
}

/* Makes a .ksplat of SH degree 1 with three sections of one Gaussian each. */
static void make_compressed_ksplat(int level)
{
    const size_t gaussian = level == 0 ? 44 + 36 : level == 1 ? 24 + 18 : 24 + 9;
    size = 4096 + 3 * 1024 + 3 * (gaussian + (level ? 16 : 0));
    memset(bytes, 0, size);
    bytes[1] = 1;
    put_u32_at(4, 3);
    put_u32_at(16, 3);
    put_u32_at(20, (uint32_t)level);
    for (size_t at = 4096; at < 4096 + 3 * 1024; at += 1024) {
        put_u32_at(at, 1);
        put_u32_at(at + 4, 1);
        put_u32_at(at + 40, 1);
        if (level) {
            put_u32_at(at + 8, 1);
            put_u32_at(at + 12, 1);
            put_float_at(at + 16, 6);
            put_u32_at(at + 20, 16);
            put_u32_at(at + 24, 1000);
            put_u32_at(at + 32, 1);
        }
    }
    add_file("a.ksplat");
}

static void make_ksplat_0(void) { make_compressed_ksplat(0); }
static void make_ksplat_1(void) { make_compressed_ksplat(1); }
static void make_ksplat_2(void) { make_compressed_ksplat(2); }

static long of_ksplat(const struct made_file *f, size_t length)
{
    const size_t headers = 4096 + 1024 * (size_t)f->data[4];
    return fault(length < 4 ? "" : length < 4096 ? "header: the file ends early"
                 : length < headers ? "the header asks for at least 7168 bytes"
                 : "of 3: the file ends before its last Gaussian");
}

/* Returns the expected result for a truncated .spz. A file without its 12-byte extension is complete too. */
static long of_plain_spz(const struct made_file *f, size_t length)
{
    return length == f->size - 12 ? GAUSSIANS : FXS_ERR_FILE;
}

#ifdef FXS_WITH_CJSON
/* Returns the expected result for a truncated .lcc. The scene is valid with whole index cells and whole
   environment Gaussians. */
static long of_lcc(const struct made_file *f, size_t length)
{
    static char text[128];
    if (!strcmp(f->name, "index.bin") && length % 20 == 0)
        return 1 + (long)length / 20;
    if (!strcmp(f->name, "environment.bin") && length % 96 == 0)
        return GAUSSIANS - 1 + (long)length / 96;
    snprintf(text, sizeof text, "%s: %s", f->name, *f->name == 'd' || *f->name == 's'
             ? "the file ends before the last Gaussian of a cell" : "");
    return fault(strcmp(f->name, "a.lcc") ? text : "");
}
#endif

#ifdef WITH_SOG
static long of_sog(const struct made_file *f, size_t length)
{
    return fault(!strcmp(f->name, "lod-meta.json") && length >= 2 ? "bad JSON" : "");
}

#ifdef FXS_WITH_ZIP
static long of_zip(const struct made_file *f, size_t length)
{
    (void)f;
    return fault(length < 4 ? "not a scene file of a known format" : "cannot be read as a zip");
}
#endif
#endif

/* Reads a file into memory of exactly the file's length, so that a sanitizer detects reads beyond the end. */
static void *file_of(const char *name, size_t *length)
{
    struct stat about;
    FILE *stream = fopen(name, "rb");
    if (!CHECK(stream && !fstat(fileno(stream), &about)))
        abort();
    *length = (size_t)about.st_size;
    void *memory = check_aligned(*length);
    CHECK(fread(memory, 1, *length, stream) == *length && !fclose(stream));
    return memory;
}

static void make_fxs(void)
{
    packed_scene s = packed_scene_make(FXS_PROFILE_DEFAULT, 1, 40, 1);
    CHECK(!packed_scene_finish(&s) && !fxs_file_write(in_folder("made.fxs"), s.data, s.bytes, &message));
    free(s.data);
    add_file_of(in_folder("made.fxs"), "a.fxs");
}

static long read_packed(const char *name)
{
    fxs_scene scene;
    size_t length;
    void *memory = file_of(name, &length);
    const int error = fxs_scene_open(&scene, memory, length);
    free(memory);
    return error;
}

static long read_fxs(const char *name)
{
    size_t length;
    void *memory = file_of(name, &length);
    const int error = fxs_file_check(name, memory, length, 0, &message);
    free(memory);
    return error;
}

static long of_packed(const struct made_file *f, size_t length)
{
    (void)f, (void)length;
    words = NULL;
    return FXS_ERR_SCENE;
}

static void put_u64(uint64_t value)
{
    put_u32((uint32_t)value);
    put_u32((uint32_t)(value >> 32));
}

static void put_doubles(int count, double first, double more)
{
    for (int i = 0; i < count; i++) {
        const double value = i ? more : first;
        uint64_t bits;
        memcpy(&bits, &value, 8);
        put_u64(bits);
    }
}

static void make_colmap(void)
{
    put_u64(1);
    put_u32(7);
    put_u32(1);
    put_u64(4);
    put_u64(3);
    put_doubles(4, 5, 2);
    add_file("sparse/0/cameras.bin");
    put_u64(1);
    put_u32(3);
    put_doubles(7, 1, 0);
    put_u32(7);
    memcpy(bytes + size, "a.ppm", 6);
    size += 6;
    put_u64(2);
    put_doubles(6, 0, 0);
    add_file("sparse/0/images.bin");
}

static void make_ppm(const char *name)
{
    put("P6\n4 3\n255\n%36s", "");
    add_file(name);
}

static void make_photos(void)
{
    make_colmap();
    put_u64(3);
    for (uint32_t i = 0; i < 3; i++) {
        put_u64(7 + i);
        put_doubles(3, i, 5);
        put("rgb");
        put_doubles(1, 0.5, 0);
        put_u64(i);
        for (uint32_t k = 0; k < i; k++)
            put_u64(1);
    }
    add_file("sparse/0/points3D.bin");
    make_ppm("images/a.ppm");
}

static void make_cameras_json(void)
{
    put("[{\"id\": 0, \"img_name\": \"a\", \"width\": 640, \"height\": 480, \"position\": [1.25, -0.375, 2.0625], "
        "\"rotation\": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], \"fx\": 500.5, \"fy\": 499.25}]");
    add_file("cameras.json");
}

static long read_cameras(const char *name)
{
    fxs_view *views = NULL;
    const long count = fxs_camera_file_read(name, &views, &message);
    if (count >= 0)
        free(views);
    return count;
}

static long read_photos(const char *name)
{
    const fxs_photos_options options = {.size = sizeof(fxs_photos_options)};
    fxs_photos photos;
    const int error = fxs_photos_read(name, &options, &photos, &message);
    CHECK(!error || (!photos.fit && !photos.held_out && !photos.points));
    fxs_photos_free(&photos);
    return error;
}

static long of_colmap(const struct made_file *f, size_t length)
{
    static char text[64];
    (void)length;
    snprintf(text, sizeof text, "%s: %s", strrchr(f->name, '/') + 1, strstr(f->name, ".ppm") ? "" : "cut short");
    return fault(text);
}

#ifdef FXS_WITH_CJSON
static long of_json(const struct made_file *f, size_t length)
{
    (void)f;
    return fault(length ? "bad JSON" : "but this is empty");
}
#endif

static long read_image(const char *name)
{
    uint8_t *rgba;
    int width, height;
    const int error = fxs_image_file_read(name, &rgba, &width, &height, &message);
    if (!error)
        free(rgba);
    return error;
}

static void make_image_ppm(void) { make_ppm("a.ppm"); }

#if defined(FXS_WITH_PNG) && defined(FXS_WITH_ZLIB)
static void make_png(void)
{
    static uint8_t rgba[4 * 33 * 21];
    for (size_t i = 0; i < sizeof rgba; i++)
        rgba[i] = (uint8_t)(i * i >> 3);
    CHECK(!fxs_image_file_write(in_folder("made.png"), rgba, 33, 21, &message));
    add_file_of(in_folder("made.png"), "a.png");
}
#endif

#ifdef FXS_WITH_JPEG
static void make_jpeg(const uint8_t *jpeg, size_t length)
{
    memcpy(bytes, jpeg, size = length);
    add_file("a.jpg");
}

static void make_baseline(void) { make_jpeg(baseline_jpeg, sizeof baseline_jpeg); }
static void make_progressive(void) { make_jpeg(progressive_jpeg, sizeof progressive_jpeg); }
static void make_grey(void) { make_jpeg(grey_jpeg, sizeof grey_jpeg); }

#endif

#if defined(FXS_WITH_PNG) || defined(FXS_WITH_JPEG)
static long of_picture(const struct made_file *f, size_t length)
{
    (void)f;
    return fault(!length ? "not a .png, .jpg, .webp, .heic or .ppm" : "cut short");
}
#endif

static uint8_t pixels[3 * 16 * 16];
static const fxs_fit_photo photo = {
    .view = {.name = "a", .width = 16, .height = 16, .fx = 16, .fy = 16, .cx = 8, .cy = 8,
             .rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .position = {0, 0, -4}},
    .pixels = pixels
};

static void make_saved_fit(void)
{
    static const fxs_fit_point points[3] = {{{0, 0, 0}, {9, 8, 7}}, {{1, 0, 0}, {6, 5, 4}}, {{0, 1, 0}, {3, 2, 1}}};
    fxs_fit *fit;
    fxs_fit_options options;
    fxs_fit_options_init(&options);
    if (!CHECK(!fxs_fit_create(&fit, &photo, 1, points, 3, &options, &message)))
        abort();
    CHECK(!fxs_fit_step(fit, NULL, &message) && !fxs_fit_save(fit, in_folder("made.fit"), &message));
    fxs_fit_destroy(fit);
    add_file_of(in_folder("made.fit"), "a.fit");
}

static long read_saved_fit(const char *name)
{
    fxs_fit *fit;
    fxs_fit_options options;
    fxs_fit_options_init(&options);
    const int error = fxs_fit_resume(&fit, name, &photo, 1, &options, &message);
    if (!error)
        fxs_fit_destroy(fit);
    return error;
}

/* Returns the expected result for a truncated checkpoint of a fit. If only the checksum is truncated, the file
   counts as damaged. */
static long of_saved_fit(const struct made_file *f, size_t length)
{
    return fault(length < 4 ? "not a saved fit" : length < f->size - 8 ? "it ends early" : "damaged");
}

static const struct row {
    const char *name;
    void (*make)(void);
    long (*read)(const char *name);
    /* returns the expected result of reading a file that is cut to `length` bytes */
    long (*result)(const struct made_file *f, size_t length);
} rows[] = {
    {"ply", make_ply, read_scene, of_ply},
    {"ply in ASCII", make_ascii_ply, read_scene, of_ascii_ply},
    {"ply with lists in ASCII", make_ascii_lists, read_scene, of_ascii_lists},
    {"ply with lists, little-endian", make_little_lists, read_scene, any_fault},
    {"ply with lists, big-endian", make_big_lists, read_scene, any_fault},
    {"compressed ply", make_compressed_ply, read_scene, of_ply},
    {"splat", make_splat, read_scene, of_splat},
    {"ksplat of floats", make_ksplat_0, read_scene, of_ksplat},
    {"ksplat of halves", make_ksplat_1, read_scene, of_ksplat},
    {"ksplat of bytes", make_ksplat_2, read_scene, of_ksplat},
    {"spz", make_plain_spz, read_scene, of_plain_spz},
#ifdef FXS_WITH_ZLIB
    {"spz by gzip", make_gzip_spz, read_scene, any_fault},
#endif
#ifdef FXS_WITH_ZSTD
    {"spz by zstd", make_zstd_spz, read_scene, any_fault},
#endif
#ifdef FXS_WITH_CJSON
    {"glb", make_glb, read_scene, any_fault},
    {"glTF", make_gltf, read_scene, any_fault},
    {"tileset", make_tileset, read_scene, any_fault},
    {"lcc", make_lcc, read_scene, of_lcc},
    {"rad", make_rad, read_scene, any_fault},
#ifdef FXS_WITH_ZLIB
    {"rad with a tree", make_rad_tree, read_scene, any_fault},
    {"rad in several files", make_rad_chunks, read_scene, any_fault},
#endif
    {"cameras as JSON", make_cameras_json, read_cameras, of_json},
#endif
#ifdef WITH_SOG
    {"sog", make_sog_folder, read_scene, of_sog},
    {"streamed sog", make_streamed_sog, read_scene, of_sog},
#ifdef FXS_WITH_ZIP
    {"sog as zip", make_sog_zip, read_scene, of_zip},
#endif
#endif
    {"packed scene", make_fxs, read_packed, of_packed},
    {"fxs", make_fxs, read_fxs, any_fault},
    {"fxs as a scene", make_fxs, read_scene, any_fault},
    {"cameras of COLMAP", make_colmap, read_cameras, of_colmap},
    {"photographs", make_photos, read_photos, of_colmap},
    {"ppm", make_image_ppm, read_image, any_fault},
#if defined(FXS_WITH_PNG) && defined(FXS_WITH_ZLIB)
    {"png", make_png, read_image, of_picture},
#endif
#ifdef FXS_WITH_JPEG
    {"baseline jpg", make_baseline, read_image, of_picture},
    {"progressive jpg", make_progressive, read_image, of_picture},
    {"grey jpg", make_grey, read_image, of_picture},
#endif
    {"saved fit", make_saved_fit, read_saved_fit, of_saved_fit},
};

static int is_as_expected(const struct row *row, const struct made_file *f, size_t length, const char *opened)
{
    words = "";
    memset(&message, 0, sizeof message);
    const long want = row->result(f, length), got = row->read(opened);
    if (want == EITHER)
        return 1;
    if (got == want && (got >= 0 || !words || (message.text[0] && !strchr(message.text, '\n') &&
                                               strstr(message.text, words))))
        return 1;
    printf("  %s of %zu bytes, not %zu: %ld, \"%s\", expected %ld, \"%s\"\n", f->name, length, f->size, got,
           message.text, want, words ? words : "");
    return 0;
}

static void every_length(const struct row *row)
{
    char opened[128];
    size = 0;
    file_count = 0;
    row->make();
    write_made(folder);
    strcpy(opened, in_folder(files[0].name));
    if (!CHECK(row->read(opened) >= 0))
        printf("  %s\n", message.text);
    for (const struct made_file *f = files; f < files + file_count; f++) {
        for (size_t length = f->size; length-- > 0;)
            if (!CHECK(!truncate(in_folder(f->name), (off_t)length) && is_as_expected(row, f, length, opened)))
                break;
        write_made(folder);
    }
    remove_made(folder);
}

int main(void)
{
    if (!mkdtemp(folder))
        return 1;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        RUN_AS(rows[i].name, every_length(&rows[i]));
    CHECK(!rmdir(folder));
    return check_report();
}
