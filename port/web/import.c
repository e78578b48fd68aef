/* The readers and the packing as a module of their own: a file goes in, an .fxs file comes out, and fixsplat.js drops
 * the module with all of its memory. */
#include <stdlib.h>
#include <string.h>

#include "../import/pack.h"
#include "../scene/fxs_file.h"
#include "../scene/scene_file.h"
#include "web.h"

__attribute__((import_module("env"), import_name("progress"))) void fxs_web_progress(double done);

static double numbers[NUMBERS];
static fxs_message message;
static fxs_packed_scene packed;

static int progress(void *argument, double done)
{
    (void)argument;
    fxs_web_progress(done);
    return 0;
}

EXPORT(start) double *fxs_web_start(void)
{
    return numbers;
}

EXPORT(words) const char *fxs_web_words(void)
{
    return message.text;
}

EXPORT(allocate) void *fxs_web_allocate(size_t bytes)
{
    return malloc(bytes);
}

static int pack(fxs_scene_file *file, const fxs_scene_file_info *info, int profile)
{
    fxs_pack_report report;
    const fxs_pack_options options = {(enum fxs_profile)profile, NULL, NULL, 1, progress, NULL, NULL};
    const int error = fxs_pack(file, info, &packed, &report, &options, &message);
    return error ? error : fxs_file_seal(packed.data, packed.bytes);
}

/* In: limits of Gaussians and of memory, or 0. Out: where the .fxs file is, and its bytes. */
EXPORT(import) int fxs_web_import(const char *name, const void *data, size_t size, int profile, int axes)
{
    fxs_scene_file *file;
    fxs_scene_file_info info;
    const fxs_scene_file_options options = {.axes = (enum fxs_axes)axes, .max_gaussians = (uint64_t)numbers[0],
                                            .max_memory = (uint64_t)numbers[1]};
    int error = fxs_scene_file_open_memory(name, data, size, &options, &file, &info, &message);
    if (error)
        return error;
    error = pack(file, &info, profile);
    fxs_scene_file_close(file);
    numbers[0] = (double)(uintptr_t)packed.data;
    numbers[1] = (double)packed.bytes;
    return error;
}
