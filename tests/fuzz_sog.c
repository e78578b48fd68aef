/* Fuzzes the readers of scenes in several files: SOG, tilesets, .lcc and gsplat's folders. Two bytes of an input give
   the size of each file. A scene is read twice and must give the same result. */
#include <stdlib.h>
#include <string.h>

#include <fixsplat/scene.h>

static struct file { const char *name; const uint8_t *data; size_t size; } files[] = {
    {"a.sog", NULL, 0}, {"meta.json", NULL, 0}, {"lod-meta.json", NULL, 0}, {"0", NULL, 0}, {"1", NULL, 0},
    {"2", NULL, 0}, {"3", NULL, 0}, {"4", NULL, 0}, {"5", NULL, 0}, {"6", NULL, 0}, {"tileset.json", NULL, 0},
    {"environment.sog", NULL, 0}, {"a.lcc", NULL, 0}, {"index.bin", NULL, 0}, {"data.bin", NULL, 0},
    {"shcoef.bin", NULL, 0}, {"environment.bin", NULL, 0}
};

enum { FILES = sizeof files / sizeof *files };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void cut_files(const uint8_t *data, size_t size)
{
    for (int i = 0; i < FILES; i++) {
        size_t length = size < 2 ? 0 : data[0] | (size_t)data[1] << 8;
        data += size < 2 ? size : 2;
        size -= size < 2 ? size : 2;
        files[i].data = data;
        files[i].size = length < size ? length : size;
        data += files[i].size;
        size -= files[i].size;
    }
}

static int read_bytes(void *file, uint64_t offset, void *out, size_t size)
{
    memcpy(out, ((const struct file *)file)->data + offset, size);
    return 0;
}

static int open_beside(void *argument, const char *name, fxs_scene_input *input)
{
    static const char *const images[] = {"means_l.png", "means_u.png", "scales.png", "quats.png", "opacities.png",
                                         "sh0.png", "shN.npz"};
    (void)argument;
    for (size_t i = 0; i < sizeof images / sizeof *images; i++)
        if (strcmp(name, images[i]) == 0)
            name = files[3 + i].name;
    for (int i = 0; i < FILES; i++)
        if (strcmp(files[i].name, name) == 0 && (files[i].size > 0 || strncmp(name, "environment.", 12) != 0)) {
            *input = (fxs_scene_input){files[i].size, read_bytes, open_beside, NULL, &files[i]};
            return 0;
        }
    return -1;
}

static long read_all(fxs_scene_file *file, uint64_t *total)
{
    static fxs_gaussian gaussians[100];
    fxs_message message;
    long count;
    while ((count = fxs_scene_file_read(file, gaussians, 100, &message)) > 0)
        *total += (uint64_t)count;
    return count;
}

static void read_scene(const char *name, int level)
{
    const fxs_scene_file_options options = {.size = sizeof(fxs_scene_file_options), .level = level};
    fxs_scene_input input;
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_message message;
    if (open_beside(NULL, name, &input) != 0)
        abort();
    if (fxs_scene_file_open_input(name, &input, &options, &file, &info, &message) != 0) {
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
    cut_files(data, size);
    read_scene("a.sog", 0);
    read_scene("meta.json", 0);
    read_scene("lod-meta.json", 0);
    read_scene("lod-meta.json", 1);
    read_scene("tileset.json", 0);
    read_scene("a.lcc", 0);
    read_scene("a.lcc", 1);
    return 0;
}
