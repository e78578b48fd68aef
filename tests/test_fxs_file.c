/* Tests .fxs files: writing, mapping, and rendering. Damage anywhere must be found. A failed write must keep the old
   file. */
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <fixsplat/fixsplat.h>
#include <fixsplat/pack.h>
#include <fixsplat/scene.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/packed.h>
#include "tools/command/procedural.h"
#include "scene_writer.h"
#include "check.h"
#include "one_scene.h"

enum { COUNT = 1000, SIZE = 48 };

static char folder[] = "/tmp/fixsplat-fxs-XXXXXX";
static char fxs_path[64], ply_path[64];
static fxs_packed_scene packed;

static int import(void)
{
    fxs_message m;
    fxs_scene_writer *writer;
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_pack_report report;
    const fxs_procedural_scene *scene = fxs_procedural_find("knot");
    if (open_writer("ply", ply_path, COUNT, 3, 0, &writer, &m))
        return -1;
    for (uint64_t i = 0; i < COUNT; i++) {
        fxs_gaussian g;
        scene->gaussian(i, COUNT, 1, &g);
        fxs_scene_writer_put(writer, &g, 1, &m);
    }
    if (close_writer(writer, &m) || fxs_scene_file_open(ply_path, NULL, &file, &info, &m))
        return -1;
    int result = fxs_pack(file, &info, &packed, &report, 0, &m);
    fxs_scene_file_close(file);
    return result;
}

static void draw(const void *data, size_t bytes, uint8_t *rgba)
{
    fxs_scene scene;
    fxs_context context;
    fxs_options options;
    fxs_camera camera = {.width = SIZE, .height = SIZE, .fx_q12 = SIZE << 12, .fy_q12 = SIZE << 12,
                         .cx_q12 = SIZE << 11, .cy_q12 = SIZE << 11,
                         .rotation_q30 = {1 << 30, 0, 0, 0, 1 << 30, 0, 0, 0, 1 << 30},
                         .position_q32 = {0, 0, -((int64_t)14 << 32)}};
    fxs_context_init(&context, 0);
    fxs_options_init(&options);
    if (!CHECK(!fxs_scene_open(&scene, data, bytes)))
        return;
    size_t need = one_frame_bytes(&context, &scene, SIZE, SIZE, 0);
    void *memory = check_aligned(need);
    CHECK(!one_render(&context, &scene, &camera, &options, FXS_FORMAT_RGBA8, memory, need, rgba, SIZE * 4, 0));
    free(memory);
}

static void test_seal(void)
{
    fxs_message m;
    fxs_mapping file;
    void *copy;
    if (!CHECK(!posix_memalign(&copy, 64, packed.bytes) && !fxs_file_write(fxs_path, packed.data, packed.bytes, &m) &&
               !fxs_map_open(&file, fxs_path, &m)))
        return;
    memcpy(copy, packed.data, packed.bytes);
    CHECK(fxs_file_seal(copy, packed.bytes - 1) == FXS_ERR_SCENE && !memcmp(copy, packed.data, packed.bytes));
    CHECK(!fxs_file_seal(copy, packed.bytes) && !memcmp(copy, file.data, packed.bytes));
    CHECK(!fxs_file_seal(copy, packed.bytes) && !memcmp(copy, file.data, packed.bytes));
    fxs_map_close(&file);
    free(copy);
}

static void test_round_trip(void)
{
    static uint8_t from_memory[SIZE * SIZE * 4], from_file[SIZE * SIZE * 4];
    fxs_message m;
    fxs_mapping file;
    if (!CHECK(!fxs_file_write(fxs_path, packed.data, packed.bytes, &m) && !fxs_map_open(&file, fxs_path, &m)))
        return;
    CHECK(file.bytes == packed.bytes && !fxs_file_check(fxs_path, file.data, file.bytes, 1, &m));
    draw(packed.data, packed.bytes, from_memory);
    draw(file.data, file.bytes, from_file);
    CHECK(!memcmp(from_memory, from_file, sizeof from_file));
    CHECK(memcmp(from_memory, from_memory + 4, sizeof from_file - 4));   /* several colours */
    /* writes a file over itself, from its own mapping */
    CHECK(!fxs_file_write(fxs_path, file.data, file.bytes, &m));
    /* the path now names a new file, while the mapping keeps the old file */
    CHECK(!fxs_map_check(&file, fxs_path, &m));
    fxs_map_close(&file);
    CHECK(!file.data);
}

/* Changes or shortens a file while it is mapped. The check must report the change. Lost pages of the mapping must
   read as 0. */
static void test_changed(void)
{
    enum { PAGE = 4096, PAGES = 16 };
    static unsigned char bytes[PAGES * PAGE];
    char path[96];
    fxs_message m;
    fxs_mapping file;
    snprintf(path, sizeof path, "%s/changed", folder);
    for (int cut = 0; cut < 2; cut++) {
        memset(bytes, 7, sizeof bytes);
        FILE *out = fopen(path, "wb");
        if (!CHECK(out && fwrite(bytes, 1, sizeof bytes, out) == sizeof bytes && !fclose(out) &&
                   !fxs_map_open(&file, path, &m)))
            return;
        const volatile unsigned char *data = file.data;
        CHECK(!fxs_map_check(&file, path, &m) && data[PAGES * PAGE - 1] == 7);
        /* waits longer than a tick of file times, which is 4 or 10 ms */
        nanosleep(&(struct timespec){0, 20000000}, 0);
        out = fopen(path, "r+b");
        CHECK(out && fputc(8, out) == 8 && !fclose(out) && (!cut || !truncate(path, PAGE)));
        CHECK(data[0] == 8 && data[PAGES * PAGE - 1] == (cut ? 0 : 7));
        CHECK(fxs_map_check(&file, path, &m) == FXS_ERR_FILE && strstr(m.text, cut ? "cut short" : "written to") &&
              strstr(m.text, path));
        fxs_map_close(&file);
    }
    unlink(path);
}

static void test_cut_and_grown(void)
{
    enum { PAGE = 4096, PAGES = 4 };
    static const unsigned char bytes[PAGES * PAGE] = {1};
    char path[96];
    fxs_message m;
    fxs_mapping file;
    struct stat status;
    snprintf(path, sizeof path, "%s/grown", folder);
    FILE *out = fopen(path, "wb");
    if (!CHECK(out && fwrite(bytes, 1, sizeof bytes, out) == sizeof bytes && !fclose(out) && !stat(path, &status) &&
               !fxs_map_open(&file, path, &m)))
        return;
    const struct timespec times[2] = {status.st_atim, status.st_mtim};
    CHECK(!truncate(path, PAGE) && ((const volatile unsigned char *)file.data)[PAGES * PAGE - 1] == 0);
    CHECK(!truncate(path, PAGES * PAGE) && !utimensat(AT_FDCWD, path, times, 0));
    CHECK(fxs_map_check(&file, path, &m) == FXS_ERR_FILE && strstr(m.text, "cut short"));
    fxs_map_close(&file);
    unlink(path);
}

static void test_other_faults(void)
{
    enum { PAGE = 4096 };
    char path[96];
    fxs_message m;
    fxs_mapping file;
    snprintf(path, sizeof path, "%s/other", folder);
    FILE *out = fopen(path, "wb");
    if (!CHECK(out && fputc(1, out) == 1 && !fclose(out)))
        return;
    if (!CHECK(!fxs_map_open(&file, fxs_path, &m)))
        return;
    for (int above = 0; above < 2; above++) {
        int status = 0, descriptor = open(path, O_RDONLY);
        char *wish = (char *)file.data + (above ? 1L : -1L) * (1L << 28);
        const volatile char *other = mmap(wish, 2 * PAGE, PROT_READ, MAP_PRIVATE, descriptor, 0);
        CHECK(above || other < (char *)file.data);
        pid_t child = fork();
        if (child == 0) {
            alarm(10);                 /* kills the child process if it loops endlessly over signals */
            _exit(other[PAGE]);        /* reads beyond the last page of the file */
        }
        CHECK(child > 0 && waitpid(child, &status, 0) == child && WIFSIGNALED(status) && WTERMSIG(status) == SIGBUS);
        munmap((void *)other, 2 * PAGE);
        close(descriptor);
    }
    fxs_map_close(&file);
    unlink(path);
}

static void test_many(void)
{
    fxs_message m;
    static fxs_mapping files[65];
    int count = 0;
    while (count < 65 && !fxs_map_open(&files[count], fxs_path, &m))
        count++;
    CHECK(count == 64 && strstr(m.text, "64 files"));
    while (count-- > 0)
        fxs_map_close(&files[count]);
    CHECK(!fxs_map_open(&files[0], fxs_path, &m));
    fxs_map_close(&files[0]);
    fxs_map_close(&files[0]);
}

/* Computes the CRC-32 of zlib and PNG (ISO 3309), bit by bit. */
static uint32_t crc_32(uint32_t crc, const void *data, size_t bytes)
{
    const unsigned char *byte = data;
    for (crc = ~crc; bytes > 0; bytes--, byte++) {
        crc ^= *byte;
        for (int bit = 0; bit < 8; bit++)
            crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
    }
    return ~crc;
}

static void test_checksums(void)
{
    fxs_message m;
    fxs_mapping file;
    if (!CHECK(!fxs_file_write(fxs_path, packed.data, packed.bytes, &m) && !fxs_map_open(&file, fxs_path, &m)))
        return;
    fxs_packed_header header;
    memcpy(&header, file.data, sizeof header);
    const uint32_t said = header.checksum;
    header.checksum = 0;
    CHECK(said == crc_32(0, &header, sizeof header));
    const unsigned char *chunks = (const unsigned char *)file.data + sizeof header;
    const unsigned char *rows = chunks + header.chunk_count * sizeof(fxs_chunk);
    for (uint32_t i = 0; i < header.chunk_count; i++) {
        fxs_chunk chunk;
        memcpy(&chunk, chunks + i * sizeof chunk, sizeof chunk);
        const uint32_t said_of_chunk = chunk.checksum;
        chunk.checksum = 0;
        CHECK(said_of_chunk == crc_32(crc_32(0, &chunk, sizeof chunk), rows + (size_t)i * header.chunk_bytes,
                                      header.chunk_bytes));
    }
    fxs_map_close(&file);
}

/* Flips one bit in each byte of a file's headers and in a sample of its other bytes. */
static void test_damage(void)
{
    fxs_message m;
    fxs_mapping file;
    size_t unseen = 0;
    if (!CHECK(!fxs_map_open(&file, fxs_path, &m)))
        return;
    const size_t bytes = file.bytes;
    unsigned char *copy = check_aligned(bytes);
    memcpy(copy, file.data, bytes);
    for (size_t i = 0; i < bytes; i += i < 256 ? 1 : 97) {
        copy[i] ^= 16;
        unseen += fxs_file_check("x.fxs", copy, bytes, 1, &m) == 0 || !strstr(m.text, "x.fxs");
        copy[i] ^= 16;
    }
    CHECK(unseen == 0);
    CHECK(!fxs_file_check("x.fxs", copy, bytes, 1, &m));
    free(copy);
    fxs_map_close(&file);
}

static void test_failures(void)
{
    char path[96];
    fxs_message m;
    fxs_mapping file;
    struct stat before, after;
    CHECK(fxs_file_write(fxs_path, packed.data, packed.bytes - 1, &m) == FXS_ERR_SCENE);
    stat(fxs_path, &before);
    snprintf(path, sizeof path, "%s/none/a.fxs", folder);
    CHECK(fxs_file_write(path, packed.data, packed.bytes, &m) == FXS_ERR_FILE && strstr(m.text, path));
    CHECK(fxs_file_write(folder, packed.data, packed.bytes, &m) == FXS_ERR_FILE && strstr(m.text, folder));
    CHECK(!stat(fxs_path, &after) && before.st_ino == after.st_ino && before.st_size == after.st_size);
    CHECK(fxs_map_open(&file, path, &m) == FXS_ERR_FILE && fxs_map_open(&file, folder, &m) == FXS_ERR_FILE &&
          !file.data);
}

int main(void)
{
    fxs_map_guard();
    if (!mkdtemp(folder))
        return 1;
    snprintf(fxs_path, sizeof fxs_path, "%s/a.fxs", folder);
    snprintf(ply_path, sizeof ply_path, "%s/a.ply", folder);
    if (import())
        return 1;
    RUN(test_seal);
    RUN(test_round_trip);
    RUN(test_checksums);
    RUN(test_damage);
    RUN(test_failures);
    RUN(test_changed);
    RUN(test_cut_and_grown);
    RUN(test_other_faults);
    RUN(test_many);
    fxs_packed_scene_free(&packed);
    unlink(fxs_path);
    unlink(ply_path);
    rmdir(folder);
    return check_report();
}
