/* Fuzzes the reader of .glb files with Gaussians. */
#include <stdlib.h>
#include <string.h>

#include <fixsplat/scene.h>
#include "glb_bytes.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static long read_some(fxs_scene_file *file, uint64_t *total)
{
    static fxs_gaussian gaussians[100];
    fxs_message message;
    long count;
    while ((count = fxs_scene_file_read(file, gaussians, 100, &message)) > 0 && *total < 100000)
        *total += (uint64_t)count;
    return count;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static uint8_t glb[1 << 16];
    if (size > sizeof glb - 28)
        return 0;
    size = make_glb(data, size, glb);
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_message message;
    if (fxs_scene_file_open_memory("fuzz", glb, size, NULL, &file, &info, &message) != 0) {
        if (strchr(message.text, '\n') || strncmp(message.text, "fuzz: ", 6) != 0)
            abort();
        return 0;
    }
    uint64_t first = 0, second = 0;
    long first_end = read_some(file, &first);
    if (fxs_scene_file_rewind(file, &message) != 0)
        abort();
    if (read_some(file, &second) != first_end || first != second || (first_end == 0 && first != info.count))
        abort();
    fxs_scene_file_close(file);
    return 0;
}
