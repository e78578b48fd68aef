/* libFuzzer target: bytes as the files of a folder, each after its size of two bytes, for a .sog as a zip, as files and
   streamed. What opens is read whole, rewound, and read again with the same result. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../port/formats/scene_file.h"

static char folder[] = "/tmp/fuzz_sog_XXXXXX";
static const char *const names[] = {"a.sog", "meta.json", "lod-meta.json", "0", "1", "2", "3", "4", "5", "6"};

enum { FILES = sizeof names / sizeof *names };

static void remove_files(void)
{
    for (int i = 0; i < FILES; i++)
        unlink(names[i]);
    rmdir(folder);
}

static void write_files(const uint8_t *data, size_t size)
{
    static FILE *files[FILES];
    if (!files[0] && (!mkdtemp(folder) || chdir(folder) != 0 || atexit(remove_files) != 0))
        abort();
    for (int i = 0; i < FILES; i++) {
        size_t length = size < 2 ? 0 : data[0] | (size_t)data[1] << 8;
        data += size < 2 ? size : 2;
        size -= size < 2 ? size : 2;
        length = length < size ? length : size;
        if (!files[i] && !(files[i] = fopen(names[i], "wb")))
            abort();
        rewind(files[i]);
        if (ftruncate(fileno(files[i]), 0) != 0 || fwrite(data, 1, length, files[i]) != length ||
            fflush(files[i]) != 0)
            abort();
        data += length;
        size -= length;
    }
}

/* Returns read's last result; adds the Gaussians read to *total. */
static long read_all(fxs_scene_file *file, uint64_t *total)
{
    static fxs_gaussian gaussians[100];
    fxs_message message;
    long count;
    while ((count = fxs_scene_file_read(file, gaussians, 100, &message)) > 0)
        *total += (uint64_t)count;
    return count;
}

static void read_scene(const char *path, int level)
{
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_message message;
    if (fxs_scene_file_open_lod(path, level, &file, &info, &message) != 0) {
        if (strpbrk(message.text, "\r\n"))
            abort();
        return;
    }
    uint64_t first = 0, second = 0;
    long first_end = read_all(file, &first);
    if (fxs_scene_file_rewind(file, &message) != 0)
        abort();
    long second_end = read_all(file, &second);
    if (first != second || first_end != second_end || (first_end == 0 && first != info.count))
        abort();
    fxs_scene_file_close(file);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    write_files(data, size);
    read_scene("a.sog", 0);
    read_scene("meta.json", 0);
    read_scene("lod-meta.json", 0);
    read_scene("lod-meta.json", 1);
    return 0;
}
