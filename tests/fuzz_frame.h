/* What the targets that render share: a packed scene, cameras and options from the bytes of an input, and memory with
   guard zones, in which any access ends the program. */
#ifndef FUZZ_FRAME_H
#define FUZZ_FRAME_H

#include <sanitizer/asan_interface.h>
#include <stdlib.h>
#include <string.h>

#include "../kernels/kernels.h"
#include "../port/scene/fxs_file.h"
#include "one_scene.h"
#include "random_scene.h"

enum {
    FUZZ_GUARD = 1 << 20,          /* bytes before and after */
    FUZZ_ROOM = 4 << 20,
    FUZZ_CONTROL = 20,             /* bytes at the start of an input */
    FUZZ_EDIT = 6,                 /* bytes of an edit of a scene that is made here */
    FUZZ_LEVELS = 5
};

typedef struct fuzz_frame {
    unsigned char *data;           /* the packed scene; for free */
    size_t bytes;
    fxs_scene scene;
    fxs_camera cameras[2];
    fxs_options options;
    enum fxs_format format;
    int exact;
    fxs_context levels[FUZZ_LEVELS];   /* plain C first, then each that this processor has */
    int level_count;
    uint32_t scribble;             /* for fuzz_scribble.c */
    size_t row;                    /* bytes of a row of pixels */
} fuzz_frame;

/* A zone of its own for each use: memory, the left and the right picture. */
static _Alignas(64) unsigned char fuzz_zones[3][FUZZ_GUARD + FUZZ_ROOM + FUZZ_GUARD];

/* The room of a zone, of which these many bytes may be touched from here on. Null where it is too small. */
static unsigned char *fuzz_room(int zone, size_t bytes)
{
    static size_t open[3] = {FUZZ_ROOM, FUZZ_ROOM, FUZZ_ROOM};
    unsigned char *room = fuzz_zones[zone] + FUZZ_GUARD;
    if (bytes > FUZZ_ROOM)
        return NULL;
    if (open[zone] == FUZZ_ROOM)
        ASAN_POISON_MEMORY_REGION(fuzz_zones[zone], sizeof fuzz_zones[zone]);
    ASAN_POISON_MEMORY_REGION(room, open[zone]);
    ASAN_UNPOISON_MEMORY_REGION(room, bytes);
    open[zone] = bytes;
    return room;
}

static uint32_t fuzz_word(const uint8_t *bytes)
{
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

/* Changes a made scene: each edit says where (a part of the file, an offset in it) and puts 1 to 8 equal bytes. */
static void fuzz_edit(fuzz_frame *f, size_t headers, const uint8_t *edits, size_t size)
{
    for (; size >= FUZZ_EDIT; edits += FUZZ_EDIT, size -= FUZZ_EDIT) {
        const size_t starts[] = {0, 192, 192, headers}, ends[] = {192, headers, 192 + 128, f->bytes};
        const int part = edits[0] & 3;
        size_t at = starts[part] + (fuzz_word(edits + 1) & 0xffffff) % (ends[part] - starts[part]);
        for (int count = 1 << (edits[0] >> 2 & 3); count > 0 && at < f->bytes; count--)
            f->data[at++] = edits[4];
        if (edits[5] & 1 && at < f->bytes)
            f->data[at] = edits[5];
    }
}

/* Scenes of the file's bytes, or made from a seed and edited. Returns 0 where there is none to render. */
static int fuzz_scene(fuzz_frame *f, const uint8_t *control, const uint8_t *rest, size_t size)
{
    fxs_message message;
    if (control[0] & 1) {
        f->bytes = size;
        f->data = check_aligned(size);
        if (size)
            memcpy(f->data, rest, size);
    } else {
        const packed_scene packed = random_scene((enum fxs_profile)(control[0] / 4 % 3), 40 << (control[0] / 16 % 8));
        f->data = packed.data;
        f->bytes = packed.bytes;
        fuzz_edit(f, (size_t)(packed.rows - packed.data), rest, size);
    }
    if (control[0] & 2 && fxs_file_check("fuzz", f->data, f->bytes, 1, &message) &&
        (strncmp(message.text, "fuzz: ", 6) != 0 || strchr(message.text, '\n')))
        abort();
    return fxs_scene_open(&f->scene, f->data, f->bytes) == 0;
}

/* A random camera, or one with some numbers that are no camera's. */
static void fuzz_camera(fxs_camera *camera, const uint8_t *control)
{
    random_camera(camera);
    camera->width = 1 + camera->width * (control[0] % 5) / 8;
    camera->height = 1 + camera->height * (control[0] / 5 % 5) / 6;
    camera->cx_q12 = camera->width * 2048;
    camera->cy_q12 = camera->height * 2048;
    const int32_t wild = (int32_t)(fuzz_word(control) ^ fuzz_word(control) << 20);
    switch (control[1] % 16) {
    case 0: camera->fx_q12 = wild; break;
    case 1: camera->fy_q12 = wild & INT32_MAX; break;
    case 2: camera->cx_q12 = wild; break;
    case 3: camera->cy_q12 = wild; break;
    case 4: camera->position_q32[control[2] % 3] = wild * (INT64_C(1) << control[3] % 33); break;
    case 5: camera->rotation_q30[control[2] % 9] ^= wild >> control[3] % 32; break;
    case 6: camera->fx_q12 = camera->fy_q12 = 1 + control[2]; break;
    case 7: camera->fx_q12 = camera->fy_q12 = INT32_MAX - control[2]; break;
    }
}

static void fuzz_options(fuzz_frame *f, const uint8_t *control)
{
    fxs_options_init(&f->options);
    f->options.cutoff = (enum fxs_cutoff)(control[0] & 1);
    f->format = (enum fxs_format)(control[0] / 2 % 3);
    f->options.sh_degree = control[0] / 8 % 4;
    f->exact = control[0] >> 5 & 1;
    memcpy(f->options.background, control + 1, sizeof f->options.background);
    f->row = (size_t)f->cameras[0].width * (size_t)fxs_pixel_bytes(f->format);
}

static void fuzz_levels(fuzz_frame *f)
{
    const unsigned cpu = fxs_cpu_detect();
    fxs_init(&f->levels[f->level_count++], NULL);
    for (unsigned flag = 1, mask = 1; mask <= cpu; flag *= 2, mask |= flag)
        if (cpu & flag) {
            fxs_init(&f->levels[f->level_count], NULL);
            fxs_kernels_choose(&f->levels[f->level_count++].kernels, mask);
        }
}

/* Returns 0 where the input has no scene that opens; free(f->data) in any case. */
static int fuzz_frame_make(fuzz_frame *f, const uint8_t *input, size_t size)
{
    memset(f, 0, sizeof *f);
    if (size < FUZZ_CONTROL)
        return 0;
    state = fuzz_word(input + 16);
    if (!fuzz_scene(f, input, input + FUZZ_CONTROL, size - FUZZ_CONTROL))
        return 0;
    fuzz_camera(&f->cameras[0], input + 1);
    f->cameras[1] = f->cameras[0];
    if (input[5] & 1)
        fuzz_camera(&f->cameras[1], input + 6);
    f->cameras[1].width = f->cameras[0].width;
    f->cameras[1].height = f->cameras[0].height;
    f->cameras[1].position_q32[0] += input[5] & 2 ? INT64_C(1) << (input[5] >> 2) % 40 : 0;
    fuzz_options(f, input + 10);
    f->scribble = input[14] | (input[15] & 1u) << 8;
    fuzz_levels(f);
    return 1;
}

/* The least memory that fxs_render says it needs for this view, or 0 where it answers with an error. */
static size_t fuzz_least(const fuzz_frame *f, const fxs_context *context, fxs_frame_memory *memory)
{
    fxs_stats stats;
    unsigned char *pixels = fuzz_room(1, f->row * (size_t)f->cameras[0].height);
    const int error = !one_frame_bytes(context, &f->scene, f->cameras[0].width, f->cameras[0].height, memory) ||
                      one_render(context, &f->scene, &f->cameras[0], &f->options, f->format,
                                 fuzz_room(0, memory->least), memory->least, pixels, (ptrdiff_t)f->row,
                                 &stats) != FXS_ERR_MEMORY;
    return error ? memory->least : stats.memory.least;
}

#endif
