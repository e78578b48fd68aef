/* Fuzzes the scene readers. A file is read twice and must give the same result. */
#include <stdlib.h>
#include <string.h>

#include <fixsplat/scene.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Reads all bytes of the motions, so that a sanitizer finds those that are not there. Returns 0. */
static uint64_t look_at(const fxs_motion *motions, long count)
{
    const unsigned char *bytes = (const void *)motions;
    uint64_t sum = 0;
    for (size_t i = 0; motions && i < (size_t)count * sizeof *motions; i++)
        sum += bytes[i];
    return sum >> 63;
}

static long read_all(fxs_scene_file *file, uint64_t *total)
{
    static fxs_gaussian gaussians[100];
    fxs_message message;
    long count;
    while ((count = fxs_scene_file_read(file, gaussians, 100, &message)) > 0)
        *total += (uint64_t)count + look_at(fxs_scene_file_motions(file), count);
    return count;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_message message;
    if (fxs_scene_file_open_memory("fuzz", data, size, NULL, &file, &info, &message) != 0) {
        if (strchr(message.text, '\n') || strncmp(message.text, "fuzz: ", 6) != 0)
            abort();
        return 0;
    }
    uint64_t first = 0, second = 0;
    long first_end = read_all(file, &first);
    if (fxs_scene_file_rewind(file, &message) != 0)
        abort();
    long second_end = read_all(file, &second);
    if (first != second || first_end != second_end || (first_end == 0 && first != info.count))
        abort();
    fxs_scene_file_close(file);
    return 0;
}
