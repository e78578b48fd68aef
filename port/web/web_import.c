/* The readers of scene formats and the packer as WebAssembly modules. make/web.mk lists the readers of each module. A
   module reads files by functions imported from fixsplat.js, and makes an .fxs file in its memory. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/pack.h>
#include <fixsplat/internal/sound.h>
#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>
#include "src/base/exponential.h"
#include "src/scene/formats_internal.h"
#include "web.h"

#define IMPORT(name) __attribute__((import_module("env"), import_name(#name)))

IMPORT(progress) void fxs_web_progress(double done);
/* Functions imported from JavaScript that read files by numbers; file 0 is the opened scene file. Negative results mean
   a missing file or missing bytes. */
IMPORT(read) int fxs_web_read(int file, double offset, void *out, size_t size);
IMPORT(beside) int fxs_web_beside(const char *name);
IMPORT(size) double fxs_web_size(int file);

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

/* ---- Files ------------------------------------------------------------------------------------------------------- */

static int read_file(void *file, uint64_t offset, void *out, size_t size)
{
    return fxs_web_read((int)(intptr_t)file, (double)offset, out, size);
}

static int open_beside(void *first, const char *name, fxs_scene_input *input);

static fxs_scene_input input_of(int file)
{
    return (fxs_scene_input){(uint64_t)fxs_web_size(file), read_file, open_beside, NULL, (void *)(intptr_t)file};
}

static int open_beside(void *first, const char *name, fxs_scene_input *input)
{
    (void)first;
    const int file = fxs_web_beside(name);
    if (file >= 0)
        *input = input_of(file);
    return file < 0;
}

/* ---- Packing ----------------------------------------------------------------------------------------------------- */

static uint32_t threads;

static int pack(fxs_scene_file *file, const fxs_scene_file_info *info, int profile)
{
    fxs_pack_report report;
    const fxs_pack_options options = {.size = sizeof options, .profile = (enum fxs_profile)profile,
                                      .workers = {fxs_web_run, NULL, threads}, .progress.call = progress};
    const int error = fxs_pack(file, info, &packed, &report, &options, &message);
    return error ? error : fxs_file_seal(packed.data, packed.bytes);
}

typedef struct sample {
    fxs_gaussian *gaussians;
    size_t count, room;
} sample;

static long read_sample(void *argument, uint64_t first, fxs_gaussian *out, size_t capacity)
{
    memcpy(out, ((const sample *)argument)->gaussians + first, capacity * sizeof *out);
    return (long)capacity;
}

static void take_sample(fxs_scene_file *file, size_t stride, sample *s)
{
    enum { PART = 256 };
    static fxs_gaussian part[PART];
    size_t until_next = 0;
    for (long count; s->count < s->room && (count = fxs_scene_file_read(file, part, PART, &message)) > 0;
         until_next -= (size_t)count)
        for (; until_next < (size_t)count && s->count < s->room; until_next += stride)
            s->gaussians[s->count++] = part[until_next];
}

/* Enlarges the Gaussians of a sample to cover as much as all Gaussians of the scene, `all` in number. log(scale) grows
   by log(all / count) / 2. */
static void enlarge(sample *s, double all)
{
    const float more = (float)(fxs_log(all / (double)s->count) / 2);
    for (size_t i = 0; i < s->count; i++)
        for (int axis = 0; axis < 3; axis++)
            s->gaussians[i].scale[axis] += more;
}

static double least_gain(double there)
{
    return there < 1 ? 2 : 6;
}

/* Packs a sample of at most `most` Gaussians as a preview. `there` is the downloaded share of the file. Does nothing if
   the whole scene is hardly larger than the sample. */
static int pack_sample(fxs_scene_file *file, const fxs_scene_file_info *info, size_t most, double there)
{
    const double readable = (double)info->count * there;
    sample s = {NULL, 0, (size_t)fmin((double)most, readable)};
    fxs_scene_file *opened;
    fxs_scene_file_info own;
    if ((double)s.room * least_gain(there) > (double)info->count ||
        !(s.gaussians = fxs_allocate(NULL, s.room, sizeof *s.gaussians)))
        return 0;
    take_sample(file, (size_t)ceil(readable / (double)s.room), &s);
    if (s.count == 0)
        return 0;
    enlarge(&s, (double)info->count);
    const fxs_gaussian_source source = {s.count, 0, info->antialiased, read_sample, &s,
                                        {info->origin[0], info->origin[1], info->origin[2]}};
    int error = fxs_scene_file_open_gaussians("sample", &source, NULL, &opened, &own, &message);
    return error ? error : pack(opened, &own, FXS_PROFILE_DEFAULT);
}

static int is_elsewhere(const char *name)
{
    const fxs_scene_source source = {.path = (char *)name, .input = input_of(0)};
    const fxs_format_row *format;
    return !fxs_format_by_content(&source, &format, &(fxs_message){0}) && !format->reader->read;
}

/* Opens the scene file (file 0). In: largest number of Gaussians, largest memory in bytes (0: default). Returns 0, 1 if
   another module may read the file, or a negative error. */
static int open_first(const char *name, int axes, fxs_scene_file **file, fxs_scene_file_info *info)
{
    const fxs_scene_file_options options = {.size = sizeof(fxs_scene_file_options), .axes = (enum fxs_axes)axes,
                                            .max_gaussians = (uint64_t)numbers[0],
                                            .max_memory = (uint64_t)numbers[1]};
    const fxs_scene_input input = input_of(0);
    const int error = fxs_scene_file_open_input(name, &input, &options, file, info, &message);
    return error && is_elsewhere(name) ? 1 : error;
}

EXPORT(look) int fxs_web_look(const char *name, int axes)
{
    fxs_scene_file *file;
    fxs_scene_file_info info;
    const int error = open_first(name, axes, &file, &info);
    if (!error)
        fxs_scene_file_close(file);
    return error;
}

/* The sound stays in memory until the module ends. */
static int put_sound(fxs_scene_file *file)
{
    fxs_sound sound;
    const int found = fxs_scene_file_sound(file, &sound, &message);
    numbers[3] = (double)(uintptr_t)sound.type;
    numbers[4] = (double)(uintptr_t)sound.data;
    numbers[5] = (double)sound.bytes;
    numbers[6] = sound.volume;
    return found;
}

/* Packs the scene file (file 0), or a sample of at most `most` Gaussians if `most` is not 0. In: largest number of
   Gaussians, largest memory in bytes, downloaded share of the file, number of threads. Out: address and size of the
   .fxs file; size 0: no worthwhile sample. Then of the sound of a moving scene: 1, 0 if there is none, or an error;
   address of its media type, address, size, volume. Returns the result of open_first. */
EXPORT(import) int fxs_web_import(const char *name, int profile, int axes, size_t most)
{
    fxs_scene_file *file;
    fxs_scene_file_info info;
    const double there = numbers[2];
    threads = (uint32_t)numbers[3];
    int error = open_first(name, axes, &file, &info);
    if (error)
        return error;
    error = most ? pack_sample(file, &info, most, there) : pack(file, &info, profile);
    numbers[2] = error || most || !(info.time.duration > 0) ? 0 : put_sound(file);
    fxs_scene_file_close(file);
    numbers[0] = (double)(uintptr_t)packed.data;
    numbers[1] = (double)packed.bytes;
    return error;
}
