/* Small scene files that demand much time or memory (decompression bombs) must be refused quickly, with a message.
   `test_bombs --write FOLDER` keeps the files. */
#define _DEFAULT_SOURCE

#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <fixsplat/pack.h>
#include "every_format_bytes.h"

#if defined(FXS_WITH_ZLIB) && defined(WITH_SOG) && defined(FXS_WITH_ZIP)

static char folder[96] = "/tmp/test_bombs_XXXXXX";

static const char *in_folder(const char *name)
{
    static char full[160];
    snprintf(full, sizeof full, "%s/%s", folder, name);
    return full;
}

static void write_file(const char *name, const void *data, size_t length)
{
    FILE *stream = fopen(in_folder(name), "wb");
    if (CHECK(stream != NULL)) {
        CHECK(fwrite(data, 1, length, stream) == length);
        fclose(stream);
    }
}

/* Makes a WebP image of pixels that take no bits: each of the five prefix codes has a single symbol. */
static size_t flat_webp(int width, int height, uint8_t out[40])
{
    uint64_t bits = (uint64_t)(width - 1) | (uint64_t)(height - 1) << 14 | (uint64_t)1 << 28;
    uint8_t *to = out;
    memcpy(out, "RIFF\32\0\0\0WEBPVP8L\15\0\0\0\x2f", 21);
    to = spz_put(out + 21, bits | (uint64_t)1 << 35 | (uint64_t)1 << 39 | (uint64_t)1 << 43 | (uint64_t)1 << 47 |
                 (uint64_t)1 << 51, 8);
    memset(to, 0, 5);
    return 34;
}

static void put_zeros(int count)
{
    for (int i = 0; i < count; i++)
        put(i ? ",0" : "0");
}

static void put_meta(int count, const char *const names[5])
{
    put("{\"version\":2,\"count\":%d,\"means\":{\"mins\":[0,0,0],\"maxs\":[1,1,1],\"files\":[\"%s\",\"%s\"]},", count,
        names[0], names[1]);
    put("\"scales\":{\"files\":[\"%s\"],\"codebook\":[", names[2]);
    put_zeros(256);
    put("]},\"quats\":{\"files\":[\"%s\"]},\"sh0\":{\"files\":[\"%s\"],\"codebook\":[", names[3], names[4]);
    put_zeros(256);
    put("]}}");
}

static const char *const one_name[5] = {"a", "a", "a", "a", "a"}, *const five_names[5] = {"a", "b", "c", "d", "e"};

static void write_sog(const char *name, int images, const void *image, size_t length)
{
    int code;
    unlink(in_folder(name));
    zip_t *zip = zip_open(in_folder(name), ZIP_CREATE, &code);
    if (!CHECK(zip != NULL))
        return;
    zip_file_add(zip, "meta.json", zip_source_buffer(zip, bytes, size, 0), 0);
    for (int i = 0; i < images; i++)
        zip_file_add(zip, five_names[i], zip_source_buffer(zip, image, length, 0), 0);
    CHECK(zip_close(zip) == 0);
    size = 0;
}

static size_t flat_spz(int count, int degree, uint8_t *out, size_t room)
{
    spz_bytes s;
    memset(&s, 0, sizeof s);
    s.version = 3;
    s.count = count;
    s.degree = degree;
    size_t length = 16;
    for (int i = 0; i < SPZ_ARRAYS; i++)
        length += spz_array_size(&s, i);
    uint8_t *plain = calloc(length, 1);
    if (!CHECK(plain != NULL))
        return 0;
    spz_put_header(&s, plain);
    length = spz_gzip(plain, length, out, room);
    free(plain);
    return length;
}

static size_t put_glb(int nodes, const uint8_t *const spz[], const size_t spz_size[], int count)
{
    size_t at = 0;
    size = 20;
    put("{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[");
    for (int i = 0; i < nodes; i++)
        put(i ? ",%d" : "%d", i);
    put("]}],\"nodes\":[");
    for (int i = 0; i < nodes; i++)
        put("%s{\"mesh\":%d}", i ? "," : "", i % count);
    put("],\"meshes\":[");
    for (int i = 0; i < count; i++)
        put("%s{\"primitives\":[{\"extensions\":{\"KHR_gaussian_splatting_compression_spz\":{\"bufferView\":%d}}}]}",
            i ? "," : "", i);
    put("],\"bufferViews\":[");
    for (int i = 0; i < count; at += spz_size[i++])
        put("%s{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu}", i ? "," : "", at, spz_size[i]);
    put("],\"buffers\":[{\"byteLength\":%zu}]}", at);
    const uint32_t json = (uint32_t)size - 20;
    put_u32((uint32_t)at);
    put_u32(0x004e4942);
    for (int i = 0; i < count; i++) {
        memcpy(bytes + size, spz[i], spz_size[i]);
        size += spz_size[i];
    }
    memcpy(bytes, "glTF\2\0\0", 8);
    put_u32_at(8, (uint32_t)size);
    put_u32_at(12, json);
    memcpy(bytes + 16, "JSON", 4);
    return size;
}

enum { SIDE = 16383, PADDED = (1 << 20) + (1 << 16) };

/* Makes a .sog with a single zip entry that serves as all images. Zero padding after the image deflates to
   almost nothing. */
static void make_padded_sog(const char *name)
{
    uint8_t *image = calloc(PADDED, 1);
    if (!CHECK(image != NULL))
        return;
    flat_webp(SIDE, SIDE, image);
    put_meta(SIDE * SIDE, one_name);
    write_sog(name, 1, image, PADDED);
    free(image);
}

/* Makes a .sog with a zip entry for each image. The images have twice as many pixels as needed. */
static void make_large_sog(const char *name)
{
    uint8_t *image = calloc(PADDED, 1);
    if (!CHECK(image != NULL))
        return;
    flat_webp(16383, 8191, image);
    put_meta(16383 * 4096, five_names);
    write_sog(name, 5, image, PADDED);
    free(image);
}

static void make_json_sog(const char *name)
{
    enum { LENGTH = 16 << 20 };
    char *json = malloc(LENGTH);
    int code;
    if (!CHECK(json != NULL))
        return;
    for (size_t i = 0; i < LENGTH; i++)
        json[i] = i & 1 ? ',' : '0';
    memcpy(json, "{\"means\":[", 10);
    memcpy(json + LENGTH - 3, "0]}", 3);
    unlink(in_folder(name));
    zip_t *zip = zip_open(in_folder(name), ZIP_CREATE, &code);
    if (CHECK(zip != NULL)) {
        zip_file_add(zip, "meta.json", zip_source_buffer(zip, json, LENGTH, 0), 0);
        CHECK(zip_close(zip) == 0);
    }
    free(json);
}

enum { FILES = 65536 };

static void look_different(char *name, int i)
{
    static const char *const ways[4] = {"s/meta.json", "./s/meta.json", "s//meta.json", "s/./meta.json"};
    strcpy(name, ways[i % 4]);
}

static void go_through_links(char *name, int i)
{
    for (int bit = 0; bit < 16; bit++)
        memcpy(name + 2 * bit, i >> bit & 1 ? "a/" : "b/", 2);
    strcpy(name + 32, "s/meta.json");
}

/* Writes a streamed SOG scene that names a file of one Gaussian 65,536 times. */
static void write_streamed_sog(const char *name, void name_of(char *name, int i))
{
    uint8_t image[40];
    char *json = malloc(FILES * 128), *to = json, file[64];
    const size_t length = flat_webp(100, 100, image);
    if (!CHECK(json != NULL))
        return;
    snprintf(file, sizeof file, "%.*ss/", (int)(strlen(name) - strlen("lod-meta.json")), name);
    const size_t at = strlen(file);
    mkdir(in_folder(file), 0700);
    put_meta(1, five_names);
    strcpy(file + at, "meta.json");
    write_file(file, bytes, size);
    size = 0;
    for (int i = 0; i < 5; i++) {
        strcpy(file + at, five_names[i]);
        write_file(file, image, length);
    }
    to += sprintf(to, "{\"version\":1,\"lodLevels\":1,\"filenames\":[");
    for (int i = 0; i < FILES; i++) {
        name_of(file, i);
        to += sprintf(to, "%s\"%s\"", i ? "," : "", file);
    }
    to += sprintf(to, "],\"tree\":{\"children\":[");
    for (int i = 0; i < FILES; i++)
        to += sprintf(to, "%s{\"lods\":{\"0\":{\"file\":%d,\"offset\":0,\"count\":1}}}", i ? "," : "", i);
    to += sprintf(to, "]}}");
    write_file(name, json, (size_t)(to - json));
    free(json);
}

static void make_streamed_sog_bomb(const char *name)
{
    write_streamed_sog(name, look_different);
}

static void make_linked_sog_bomb(const char *name)
{
    mkdir(in_folder("links"), 0700);
    CHECK(symlink(".", in_folder("links/a")) == 0 && symlink(".", in_folder("links/b")) == 0);
    write_streamed_sog(name, go_through_links);
}

static void make_shared_images(const char *name)
{
    enum { SCENES = 63, EACH = 1000000 };
    char file[32], *json = malloc(SCENES * 128), *to = json;
    uint8_t *image = calloc(PADDED, 1);
    if (!CHECK(json != NULL && image != NULL))
        return;
    mkdir(in_folder("shared"), 0700);
    const size_t length = flat_webp(1000, 1000, image);
    for (int i = 0; i < 5; i++) {
        snprintf(file, sizeof file, "shared/%s", five_names[i]);
        write_file(file, image, i ? length : PADDED);
    }
    to += sprintf(to, "{\"version\":1,\"lodLevels\":1,\"filenames\":[");
    for (int i = 0; i < SCENES; i++) {
        snprintf(file, sizeof file, "shared/%d.json", i);
        put_meta(EACH, five_names);
        write_file(file, bytes, size);
        size = 0;
        to += sprintf(to, "%s\"%d.json\"", i ? "," : "", i);
    }
    to += sprintf(to, "],\"tree\":{\"children\":[");
    for (int i = 0; i < SCENES; i++)
        to += sprintf(to, "%s{\"lods\":{\"0\":{\"file\":%d,\"offset\":0,\"count\":%d}}}", i ? "," : "", i, EACH);
    to += sprintf(to, "]}}");
    write_file(name, json, (size_t)(to - json));
    free(json);
    free(image);
}

/* Makes a .gltf with many buffers that all name the same file. The file begins with an .spz. */
static void make_shared_buffer(const char *name)
{
    uint8_t *spz = calloc(PADDED, 1);
    if (!CHECK(spz != NULL))
        return;
    const size_t length = flat_spz(100000, 0, spz, PADDED);
    write_file("same.bin", spz, PADDED);
    free(spz);
    put("{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[");
    for (int i = 0; i < 640; i++)
        put(i ? ",%d" : "%d", i);
    put("]}],\"nodes\":[");
    for (int i = 0; i < 640; i++)
        put("%s{\"mesh\":%d}", i ? "," : "", i % 64);
    put("],\"meshes\":[");
    for (int i = 0; i < 64; i++)
        put("%s{\"primitives\":[{\"extensions\":{\"KHR_gaussian_splatting_compression_spz\":{\"bufferView\":%d}}}]}",
            i ? "," : "", i);
    put("],\"bufferViews\":[");
    for (int i = 0; i < 64; i++)
        put("%s{\"buffer\":%d,\"byteLength\":%zu}", i ? "," : "", i, length);
    put("],\"buffers\":[");
    for (int i = 0; i < 64; i++)
        put("%s{\"byteLength\":%d,\"uri\":\"same.bin\"}", i ? "," : "", (int)PADDED);
    put("]}");
    write_file(name, bytes, size);
    size = 0;
}

/* Makes an .spz of 4 million equal Gaussians. Gzip compresses the .spz by the factor 1032. Packing needs yet more
   memory for each Gaussian. */
static void make_inflating_spz(const char *name)
{
    write_file(name, bytes, flat_spz(4000000, 3, bytes, MAX_FILE));
}

typedef struct zero_column { const char *property, *encoding; int width; } zero_column;

static size_t put_deflated(uint8_t *out, size_t room, size_t count)
{
    uint8_t *zeros = calloc(count, 1);
    z_stream stream;
    memset(&stream, 0, sizeof stream);
    stream.next_in = zeros;
    stream.avail_in = (uInt)count;
    stream.next_out = out;
    stream.avail_out = (uInt)room;
    CHECK(zeros && deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 9, Z_DEFAULT_STRATEGY) == Z_OK &&
          deflate(&stream, Z_FINISH) == Z_STREAM_END);
    deflateEnd(&stream);
    free(zeros);
    return room - stream.avail_out;
}

static void write_rad(const char *name, size_t count, const zero_column *columns, const char *more)
{
    static uint8_t payload[1 << 19];
    size_t at = 0;
    put("RADC....{\"version\":1,\"base\":0,\"count\":%zu,\"properties\":[", count);
    for (const zero_column *c = columns; c->property; c++) {
        const size_t length = put_deflated(payload + at, sizeof payload - at, count * (size_t)c->width);
        put("%s{\"offset\":%zu,\"bytes\":%zu,\"property\":\"%s\",\"encoding\":\"%s\",\"compression\":\"gz\",\"min\":0,"
            "\"max\":1}", at ? "," : "", at, length, c->property, c->encoding);
        at += length;
    }
    put("]}");
    put_u32_at(4, (uint32_t)size - 8);
    rad_pad();
    put_u32((uint32_t)at);
    put_u32(0);
    const size_t chunk = size + at, head = size;
    uint8_t *body = malloc(chunk);
    if (!CHECK(body != NULL))
        return;
    memcpy(body, bytes, head);
    memcpy(body + head, payload, at);
    size = 0;
    put("RAD0....{\"version\":1,\"type\":\"gsplat\",\"count\":%zu%s,\"chunks\":[{\"offset\":0,\"bytes\":%zu}]}", count,
        more, chunk);
    put_u32_at(4, (uint32_t)size - 8);
    rad_pad();
    memcpy(bytes + size, body, chunk);
    write_file(name, bytes, size + chunk);
    size = 0;
    free(body);
}

static void make_inflating_rad(const char *name)
{
    static const zero_column columns[] = {{"center", "f16", 6}, {"alpha", "r8", 1}, {"rgb", "r8", 3},
                                          {"scales", "ln_0r8", 3}, {"orientation", "oct88r8", 3}, {NULL, NULL, 0}};
    write_rad(name, 4000000, columns, "");
}

static void make_wide_rad(const char *name)
{
    static const zero_column columns[] = {{"center", "f32", 12}, {"alpha", "f32", 4}, {"rgb", "f32", 12},
                                          {"scales", "f32", 12}, {"orientation", "f32", 12}, {"sh1", "f32", 36},
                                          {"sh2", "f32", 60}, {"sh3", "f32", 84}, {NULL, NULL, 0}};
    write_rad(name, 1000000, columns, ",\"maxSh\":3");
}

static void make_palette_rad(const char *name)
{
    static const zero_column columns[] = {{"center", "f16", 6}, {"alpha", "r8", 1}, {"rgb", "r8", 3},
                                          {"scales", "ln_0r8", 3}, {"orientation", "oct88r8", 3},
                                              {"sh_label", "u16", 2},
                                          {"sh1_code", "f32", 36}, {NULL, NULL, 0}};
    write_rad(name, 4, columns, ",\"maxSh\":1,\"shCodeCount\":2000000000");
}

/* Makes a .rad with a faulty level-of-detail tree: each node names all later nodes as its children. */
static void make_tangled_rad(const char *name)
{
    enum { NODES = 5000 };
    rad_begin(1);
    for (int half = 0; half < 2; half++) {
        for (int i = 0; i < NODES && half; i++)
            put_u32(i < NODES - 1 ? (uint32_t)i + 1 : 0);
        for (int i = 0; i < NODES && !half; i++)
            put_u16(NODES - 1 - i);
        rad_add_column(half ? "child_start" : "child_count", half ? "u32" : "u16", "");
    }
    for (int i = 0; i < 5; i++) {
        memset(bytes, 0, size = NODES * (i == 0 ? 6 : i == 1 ? 2 : 3));
        rad_add_column((const char *[]){"center", "alpha", "rgb", "scales", "orientation"}[i],
                       (const char *[]){"f16", "f16", "r8", "ln_0r8", "oct88r8"}[i], ",\"min\":0,\"max\":1");
    }
    rad_add_chunk(0, NODES);
    rad_end(NODES, NODES, ",\"lodTree\":true");
    write_file(name, bytes, size);
    size = 0;
}

static void make_instances_glb(const char *name)
{
    static uint8_t spz[1 << 14];
    const uint8_t *const all[1] = {spz};
    const size_t length = flat_spz(100000, 0, spz, sizeof spz);
    write_file(name, bytes, put_glb(1024, all, &length, 1));
    size = 0;
}

static void make_exponents_ply(const char *name)
{
    static const char *const names[] = {"x", "y", "z", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2",
                                        "rot_3", "opacity", "f_dc_0", "f_dc_1", "f_dc_2"};
    enum { ROWS = 18000 };
    put("ply\nformat ascii 1.0\nelement vertex %d\n", ROWS);
    for (int i = 0; i < 14; i++)
        put("property float %s\n", names[i]);
    put("end_header\n");
    for (int i = 0; i < 14 * ROWS; i++)
        put(i % 14 == 6 ? "1 " : i % 14 == 13 ? "1e-9999\n" : "1e-9999 ");
    write_file(name, bytes, size);
    size = 0;
}

static const struct bomb {
    /* line: expected part of the error message for a bomb; null: the file must be readable */
    const char *name, *line;
    void (*make)(const char *name);
} bombs[] = {
    {"padded.sog", "268402689 Gaussians or more in 1", make_padded_sog},
    {"large.sog", "67104768 Gaussians or more in ", make_large_sog},
    {"json.sog", "bytes of memory or more, beyond the limit of 97", make_json_sog},
    {"lod-meta.json", "s/meta.json: two leaves share Gaussian 0", make_streamed_sog_bomb},
    {"links/lod-meta.json", "s/meta.json: the same file as ", make_linked_sog_bomb},
    {"shared/lod-meta.json", " Gaussians or more in 1", make_shared_images},
    {"same.gltf", " Gaussians or more in 1", make_shared_buffer},
    {"inflating.spz", "4000000 Gaussians or more in ", make_inflating_spz},
    {"inflating.rad", "4000000 Gaussians or more in ", make_inflating_rad},
    {"wide.rad", "bytes of memory or more, beyond the limit of ", make_wide_rad},
    {"palette.rad", "cannot be the 72000000000 of 2000000000 Gaussians", make_palette_rad},
    {"tangled.rad", "children that are no later nodes of their own", make_tangled_rad},
    {"instances.glb", "102400000 Gaussians or more in 17", make_instances_glb},
    {"exponents.ply", NULL, make_exponents_ply}
};

enum { BOMBS = sizeof bombs / sizeof *bombs };

static void make_bomb(const struct bomb *b)
{
    int status;
    pid_t child = fork();
    if (child == 0) {
        check_faults = 0;
        b->make(b->name);
        _exit(check_faults != 0);
    }
    CHECK(child > 0 && waitpid(child, &status, 0) == child && status == 0);
}

enum { MOST_KIB = 256 << 10, MOST_SECONDS = 2, SURELY_SECONDS = 20 };

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
enum { MEASURED = 0 };
#else
enum { MEASURED = 1 };
#endif

static int import(const char *name, fxs_message *said)
{
    fxs_scene_file *file;
    fxs_packed_scene packed;
    fxs_pack_report report;
    int result = fxs_scene_file_open(in_folder(name), NULL, &file, &info, said);
    if (result)
        return result;
    result = fxs_pack(file, &info, &packed, &report, NULL, said);
    fxs_scene_file_close(file);
    if (result == 0)
        fxs_packed_scene_free(&packed);
    return result;
}

static void import_measured(const struct bomb *b)
{
    const struct rlimit most = {(rlim_t)4 << 30, (rlim_t)4 << 30};
    struct { int result; fxs_message said; } answer;
    struct rusage usage;
    int pipe_ends[2], status = -1;
    memset(&answer, 0, sizeof answer);
    if (!CHECK(pipe(pipe_ends) == 0))
        return;
    pid_t child = fork();
    if (child == 0) {
        if (MEASURED)
            setrlimit(RLIMIT_AS, &most);
        alarm(SURELY_SECONDS);
        answer.result = import(b->name, &answer.said);
        _exit(write(pipe_ends[1], &answer, sizeof answer) != sizeof answer);
    }
    close(pipe_ends[1]);
    CHECK(child > 0 && wait4(child, &status, 0, &usage) == child);
    if (!CHECK(status == 0 && read(pipe_ends[0], &answer, sizeof answer) == sizeof answer))
        printf("  %s: ended by signal %d\n", b->name, status & 127);
    close(pipe_ends[0]);
    const double seconds = (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
                           1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
    printf("  %-19s %7ld KiB %6.2f s  %s\n", b->name, usage.ru_maxrss, seconds, answer.said.text);
    CHECK(!MEASURED || (usage.ru_maxrss <= MOST_KIB && seconds <= MOST_SECONDS));
    const int refused = answer.result == FXS_ERR_FILE || answer.result == FXS_ERR_MEMORY;
    CHECK(b->line ? refused && strstr(answer.said.text, b->line) : answer.result == 0);
}

static void every_bomb_ends(void)
{
    for (int i = 0; i < BOMBS; i++) {
        make_bomb(&bombs[i]);
        import_measured(&bombs[i]);
    }
}

static int open_limited(const char *name, uint64_t max_gaussians, uint64_t max_memory)
{
    fxs_scene_file *file;
    fxs_gaussian one;
    const fxs_scene_file_options options = {.size = sizeof(fxs_scene_file_options), .max_gaussians = max_gaussians,
                                            .max_memory = max_memory};
    int result = fxs_scene_file_open(in_folder(name), &options, &file, &info, &message);
    if (result == 0)
        result = (int)fxs_scene_file_read(file, &one, 1, &message);
    fxs_scene_file_close(file);
    return result < 0 ? result : 0;
}

static int says(const char *words)
{
    return strstr(message.text, words) && !strchr(message.text, '\n');
}

static void small_ones_pass(void)
{
    uint8_t image[40];
    const size_t length = flat_webp(1000, 1000, image);
    put_meta(1000000, five_names);
    write_sog("honest.sog", 5, image, length);
    CHECK(open_limited("honest.sog", 0, 0) == 0 && info.count == 1000000);
    write_file("honest.spz", bytes, flat_spz(1000000, 3, bytes, MAX_FILE));
    if (!CHECK(open_limited("honest.spz", 0, 0) == 0 && info.count == 1000000))
        printf("  %s\n", message.text);
}

static void limits_are_exact(void)
{
    CHECK(open_limited("honest.spz", 1000000, 0) == 0);
    CHECK(open_limited("honest.spz", 999999, 0) == FXS_ERR_FILE && says("1000000 Gaussians or more in ") &&
          says("beyond the limit of 999999; --max-gaussians raises it"));
    CHECK(open_limited("honest.spz", 0, 65000000 + (1 << 18)) == 0);
    CHECK(open_limited("honest.spz", 0, 65000000) == FXS_ERR_MEMORY && message.bytes_needed > 65000000 &&
          says("beyond the limit of 65000000; --import-memory raises"));
    CHECK(open_limited("honest.sog", 1000000, 20000000 + (1 << 18)) == 0);
    CHECK(open_limited("honest.sog", 0, 19999999) == FXS_ERR_MEMORY && says("--import-memory raises it"));
    CHECK(open_limited("inflating.spz", 4000000, 0) == 0);
    CHECK(open_limited("exponents.ply", 17999, 0) == FXS_ERR_FILE && says("18000 Gaussians or more in "));
}

/* read: number of bytes that the reader took from the file, counted from offset `from` on */
static struct { uint64_t read, from; int opened; } taken;

static int read_counted(void *argument, uint64_t offset, void *out, size_t length)
{
    const struct made_file *f = argument;
    taken.read += offset >= taken.from ? length : 0;
    memcpy(out, f->data + offset, length);
    return 0;
}

static int open_counted(void *argument, const char *name, fxs_scene_input *input)
{
    (void)argument;
    for (int i = 0; i < file_count; i++)
        if (strcmp(files[i].name, name) == 0) {
            *input = (fxs_scene_input){files[i].size, read_counted, NULL, NULL, &files[i]};
            taken.opened++;
            return 0;
        }
    return -1;
}

enum { PASSES = 3, MOST_READ = 4096 };
static fxs_gaussian pass_read[PASSES][MOST_READ];

/* Reads the scene PASSES times and counts the bytes read. Returns the number of Gaussians, or -1. */
static long read_passes(uint64_t max_memory, uint64_t from)
{
    const fxs_scene_file_options options = {.size = sizeof(fxs_scene_file_options), .max_memory = max_memory};
    const fxs_scene_input input = {files[0].size, read_counted, open_counted, NULL, &files[0]};
    fxs_scene_file *file;
    long count = 0;
    if (fxs_scene_file_open_input("made", &input, &options, &file, &info, &message))
        return -1;
    memset(&taken, 0, sizeof taken);
    taken.from = from;
    for (int i = 0; i < PASSES && count >= 0; i++) {
        count = fxs_scene_file_rewind(file, &message) ? -1 : fxs_scene_file_read(file, pass_read[i], MOST_READ,
                                                                                 &message);
        CHECK(count < 0 || memcmp(pass_read[i], pass_read[0], (size_t)count * sizeof **pass_read) == 0);
    }
    fxs_scene_file_close(file);
    return count;
}

/* Reads a .glb with two .spz files. With enough memory each .spz is read once. The minimum memory holds a single
   one decompressed, so they are read again. */
static void spz_is_inflated_once(void)
{
    enum { NODES = 20, EACH = 100, PAYLOAD = 20 * EACH };
    static uint8_t spz[2][1 << 10];
    static fxs_gaussian kept[MOST_READ];
    const uint8_t *const both[2] = {spz[0], spz[1]};
    size_t sizes[2];
    for (int i = 0; i < 2; i++)
        sizes[i] = flat_spz(EACH, 0, spz[i], sizeof spz[i]);
    file_count = 0;
    put_glb(NODES, both, sizes, 2);
    add_file("a.glb");
    const uint64_t at = files[0].size - sizes[0] - sizes[1];
    CHECK(read_passes(0, at) == NODES * EACH && taken.read == sizes[0] + sizes[1]);
    memcpy(kept, pass_read[0], sizeof kept);
    uint64_t least = 1 << 10;
    while (least < 1 << 20 && read_passes(least, at) < 0 && CHECK(says("--import-memory")))
        least += 1 << 8;
    CHECK(taken.read > sizes[0] + sizes[1]);
    CHECK(read_passes(least, at) == NODES * EACH && memcmp(kept, pass_read[0], sizeof kept) == 0);
}

static void files_are_loaded_once(void)
{
    file_count = 0;
    size = 0;
    make_streamed_sog();
    const long count = read_passes(0, 0);
    CHECK(count == 5 && taken.opened == 0 && taken.read == 0);
    uint64_t least = 1 << 12;
    while (least < 1 << 20 && read_passes(least, 0) < 0 && CHECK(says("--import-memory")))
        least += 1 << 8;
    CHECK(taken.opened > 0 && least < 1 << 16);
    CHECK(read_passes(least, 0) == count);
}

static void same_name_is_one_file(void)
{
    file_count = 0;
    size = 0;
    put("{\"version\":1,\"lodLevels\":1,\"filenames\":[\"0/meta.json\",\"0//./meta.json\"],\"tree\":{\"children\":["
        "{\"lods\":{\"0\":{\"file\":1,\"offset\":2,\"count\":1}}},{\"lods\":{\"0\":{\"file\":0,\"offset\":0,"
        "\"count\":2}}}]}}");
    add_file("lod-meta.json");
    add_sog("0/");
    CHECK(read_passes(0, 0) == 3 && taken.opened == 0);
}

static void one_file_for_two_images(void)
{
    uint8_t image[40];
    static const char *const names[5] = {"a", "b", "c", "./a", "e"};
    const size_t length = flat_webp(10, 10, image);
    put_meta(100, names);
    write_sog("two.sog", 5, image, length);
    CHECK(open_limited("two.sog", 0, 0) == FXS_ERR_FILE && says("./a: the file of two images"));
}

static int run_tests(int argc, char **argv)
{
    if (argc == 3 && strcmp(argv[1], "--write") == 0) {
        snprintf(folder, sizeof folder, "%s", argv[2]);
        for (int i = 0; i < BOMBS; i++)
            make_bomb(&bombs[i]);
        return check_faults != 0;
    }
    if (!mkdtemp(folder))
        return 1;
    RUN(every_bomb_ends);
    RUN(small_ones_pass);
    RUN(limits_are_exact);
    RUN(spz_is_inflated_once);
    RUN(files_are_loaded_once);
    RUN(same_name_is_one_file);
    RUN(one_file_for_two_images);
    char command[128];
    snprintf(command, sizeof command, "rm -r %s", folder);
    return system(command) != 0 || check_report();
}

#else

static void every_bomb_ends(void)
{
    SKIP("built without zlib, libwebp, libzip or cJSON");
}

static int run_tests(int argc, char **argv)
{
    (void)argv;
    if (argc == 3)
        return 1;
    RUN(every_bomb_ends);
    return check_report();
}

#endif

int main(int argc, char **argv)
{
    return run_tests(argc, argv);
}
