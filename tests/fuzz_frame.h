/* Builds a packed scene, objects, cameras, options and targets from the bytes of a fuzz input. Memory and pictures
   lie in zones between poisoned guards. Any access to a guard ends the program. */
#ifndef FUZZ_FRAME_H
#define FUZZ_FRAME_H

#include <sanitizer/asan_interface.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/scene.h>
#include <fixsplat/internal/kernels.h>
#include "one_scene.h"
#include "random_scene.h"
#include "fastest.h"

enum {
    /* size in bytes of the poisoned guard on either side of the memory that a test may access */
    FUZZ_GUARD = 1 << 20,
    FUZZ_ROOM = 4 << 20,
    FUZZ_CONTROL = 20,
    FUZZ_EDIT = 6,
    FUZZ_OBJECTS = 3,
    FUZZ_IMAGES = 5,
    FUZZ_OCCLUDER = 3,
    FUZZ_ZONES = 4,
    FUZZ_LEVELS = 5
};

typedef struct fuzz_frame {
    unsigned char *data;           /* the packed scene; released with free */
    size_t bytes;
    fxs_scene scene;
    fxs_camera cameras[2];
    fxs_options options;
    enum fxs_format format;
    fxs_object objects[FUZZ_OBJECTS];
    fxs_crop crops[FUZZ_OBJECTS][2];
    uint32_t count;
    unsigned images;               /* bit i: image i (colour, coverage, mean depth, median depth, id) is rendered */
    int depth_bits, occluded, upside_down, wrong_stride;
    fxs_context levels[FUZZ_LEVELS];
    int level_count;
    uint32_t scribble;
    size_t picture;
} fuzz_frame;

/* Four zones of memory between guards: the renderer's memory, left picture, right picture, occluder depths. */
static _Alignas(64) unsigned char fuzz_zones[FUZZ_ZONES][FUZZ_GUARD + FUZZ_ROOM + FUZZ_GUARD];

/* Makes `bytes` bytes of a zone accessible and poisons the rest. Returns their start, or null if the zone is too
   small. */
static unsigned char *fuzz_room(int zone, size_t bytes)
{
    static size_t open[FUZZ_ZONES] = {FUZZ_ROOM, FUZZ_ROOM, FUZZ_ROOM, FUZZ_ROOM};
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

/* Damages a packed scene. Each edit selects a part of the file and an offset, and writes 1 to 8 equal bytes. */
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

static void fuzz_camera(fxs_camera *camera, const uint8_t *control)
{
    random_camera(camera);
    camera->width = 1 + camera->width * (control[0] % 5) / 8;
    camera->height = 1 + camera->height * (control[0] / 5 % 5) / 6;
    camera->cx_q12 = camera->width * 2048;
    camera->cy_q12 = camera->height * 2048;
    const int32_t wild = (int32_t)(fuzz_word(control) ^ fuzz_word(control) << 20);
    int32_t *const parts[] = {&camera->whole_width, &camera->whole_height, &camera->whole_x, &camera->whole_y};
    switch (control[1] % 16) {
    case 0: camera->fx_q12 = wild; break;
    case 1: camera->fy_q12 = wild & INT32_MAX; break;
    case 2: camera->cx_q12 = wild; break;
    case 3: camera->cy_q12 = wild; break;
    case 4: camera->position_q32[control[2] % 3] = wild * (INT64_C(1) << control[3] % 33); break;
    case 5: camera->rotation_q30[control[2] % 9] ^= wild >> control[3] % 32; break;
    case 6: camera->fx_q12 = camera->fy_q12 = 1 + control[2]; break;
    case 7: camera->fx_q12 = camera->fy_q12 = INT32_MAX - control[2]; break;
    case 8:
        camera->whole_x = control[2];
        camera->whole_y = control[3] * 16;
        camera->whole_width = camera->width + camera->whole_x + control[3];
        camera->whole_height = camera->height + camera->whole_y;
        break;
    case 9: *parts[control[2] % 4] = wild; break;
    }
}

static void fuzz_options(fuzz_frame *f, const uint8_t *control)
{
    fxs_options_init(&f->options);
    f->options.cutoff = (enum fxs_cutoff)(control[0] & 1);
    f->format = (enum fxs_format)(control[0] / 2 % 4);
    f->options.sh_degree = control[0] / 8 % 4;
    memcpy(f->options.background, control + 1, sizeof f->options.background);
}

static void fuzz_wild_object(fxs_object *object)
{
    switch (next() % 12) {
    case 0: object->rotation_q30[next() % 9] = (int32_t)next(); break;
    case 1: object->scale_q32 = (int64_t)next(); break;
    case 2: object->translation_q32[next() % 3] = (int64_t)(next() >> next() % 40); break;
    case 3: object->opacity_q16 = (uint32_t)next() >> next() % 32; break;
    case 4: object->tint_q13[next() % 3] = (uint32_t)next() >> next() % 32; break;
    case 5: object->crop_count = (uint32_t)next() >> next() % 32; break;
    case 6: object->crops = NULL; break;
    case 7: object->scene = NULL; break;
    }
    /* more than two crops: adds FXS_MAX_CROPS, so that the renderer refuses the count before it reads the crops */
    if (object->crop_count > 2)
        object->crop_count += FXS_MAX_CROPS;
}

static void fuzz_crop(fxs_crop *crop)
{
    for (int i = 0; i < 3; i++) {
        const int64_t a = (int64_t)(next() << 32 >> next() % 40), b = (int64_t)(next() << 32 >> next() % 40);
        crop->low_q32[i] = a < b || next() % 64 == 0 ? a : b;
        crop->high_q32[i] = a < b ? b : a;
    }
    crop->outside = (int)(next() % 2);
}

static void fuzz_object(const fuzz_frame *f, fxs_object *object, fxs_crop crops[2], int wild)
{
    fxs_camera turned;
    fxs_object_init(object, &f->scene);
    object->id = (uint32_t)next();
    fuzz_crop(&crops[0]);
    fuzz_crop(&crops[1]);
    object->crops = crops;
    if (next() % 2) {
        random_camera(&turned);
        memcpy(object->rotation_q30, turned.rotation_q30, sizeof object->rotation_q30);
        memcpy(object->translation_q32, turned.position_q32, sizeof object->translation_q32);
        object->scale_q32 = INT64_C(1) << (16 + next() % 33);
        object->opacity_q16 = (uint32_t)between(0, 65536);
        object->tint_q13[next() % 3] = (uint32_t)between(0, 32768);
        object->crop_count = (uint32_t)(next() % 3);
        object->visible = next() % 8 != 0;
    }
    if (wild)
        fuzz_wild_object(object);
}

static void fuzz_world(fuzz_frame *f, unsigned control)
{
    f->count = control / 2 % (FUZZ_OBJECTS + 1);
    if (f->count == 1 && !(control & 8))
        fxs_object_init(&f->objects[0], &f->scene);
    else
        for (uint32_t i = 0; i < f->count; i++)
            fuzz_object(f, &f->objects[i], f->crops[i], control & 16 && next() % 2);
    if (control & 32)
        f->cameras[0].projection = f->cameras[1].projection = FXS_ORTHOGRAPHIC;
}

static void fuzz_images(fuzz_frame *f, unsigned control)
{
    const int pixel_bytes[FUZZ_IMAGES] = {fxs_pixel_bytes(f->format), 1, 4, 4, 8};
    const size_t pixels = (size_t)f->cameras[0].width * (size_t)f->cameras[0].height;
    f->images = control & 64 ? 1u << next() % FUZZ_IMAGES | (unsigned)next() % 32 : 1;
    f->depth_bits = next() % 8 ? (int)(next() % 29) : (int)next();
    f->occluded = control >> 7 & 1;
    f->upside_down = (int)(next() % 32);
    f->wrong_stride = next() % 16 ? -1 : (int)(next() % FUZZ_IMAGES);
    f->picture = 0;
    for (int i = 0; i < FUZZ_IMAGES; i++)
        f->picture += f->images >> i & 1 ? (pixels * (size_t)pixel_bytes[i] + 7) / 8 * 8 : 0;
    uint32_t *depths = (uint32_t *)(void *)fuzz_room(FUZZ_OCCLUDER, pixels * 4);
    for (size_t i = 0; i < pixels; i++)
        depths[i] = next() % 4 ? (uint32_t)next() >> next() % 32 : FXS_NOTHING;
}

/* Returns the target images of an eye. All bytes start equal, so that pixels that the renderer leaves unwritten
   compare equal. */
static fxs_targets fuzz_targets(const fuzz_frame *f, int eye)
{
    fxs_targets t;
    fxs_targets_init(&t);
    t.format = f->format;
    t.depth_bits = f->depth_bits;
    fxs_image *const images[FUZZ_IMAGES] = {&t.colour, &t.coverage, &t.mean_depth, &t.median_depth, &t.id};
    const int pixel_bytes[FUZZ_IMAGES] = {fxs_pixel_bytes(f->format), 1, 4, 4, 8};
    const ptrdiff_t width = f->cameras[0].width, height = f->cameras[0].height;
    unsigned char *at = memset(fuzz_room(1 + eye, f->picture), 0x5a, f->picture);
    for (int i = 0; i < FUZZ_IMAGES; i++) {
        const ptrdiff_t row = width * pixel_bytes[i];
        if (!(f->images >> i & 1))
            continue;
        *images[i] = f->upside_down >> i & 1 ? (fxs_image){at + (height - 1) * row, -row} : (fxs_image){at, row};
        images[i]->stride -= i == f->wrong_stride && row > 1 ? images[i]->stride / 2 : 0;
        at += (row * height + 7) / 8 * 8;
    }
    if (f->occluded)
        t.occluder = (fxs_image){fuzz_zones[FUZZ_OCCLUDER] + FUZZ_GUARD, width * 4};
    return t;
}

static void fuzz_levels(fuzz_frame *f)
{
    const unsigned cpu = fxs_cpu_detect();
    fxs_context_init(&f->levels[f->level_count++], NULL);
    for (unsigned flag = 1, mask = 1; mask <= cpu; flag *= 2, mask |= flag)
        if (cpu & flag) {
            fxs_context_init(&f->levels[f->level_count], NULL);
            f->levels[f->level_count++].config.kernels = kernels_for(mask);
        }
}

/* Makes the scene, objects and cameras of a frame from a fuzz input. Returns 0 if no scene of the input opens. The
   caller releases f->data in either case. */
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
    fuzz_world(f, input[15]);
    fuzz_images(f, input[15]);
    fuzz_levels(f);
    return 1;
}

static int fuzz_render(const fuzz_frame *f, const fxs_context *context, size_t bytes, fxs_stats *stats)
{
    const fxs_targets targets = fuzz_targets(f, 0);
    return render_frame(context, f->objects, f->count, &f->cameras[0], &f->options, &targets, fuzz_room(0, bytes),
                        bytes, stats);
}

static int fuzz_render_stereo(const fuzz_frame *f, const fxs_context *context, size_t bytes)
{
    const fxs_targets targets[2] = {fuzz_targets(f, 0), fuzz_targets(f, 1)};
    return render_eyes(context, f->objects, f->count, f->cameras, &f->options, targets, fuzz_room(0, bytes), bytes,
                       NULL);
}

static size_t fuzz_frame_bytes(const fuzz_frame *f, fxs_frame_memory *memory)
{
    return fxs_frame_bytes(&f->levels[0], f->objects, f->count, f->cameras[0].width, f->cameras[0].height, memory);
}

/* Returns the minimum memory in bytes with which the frame renders. */
static size_t fuzz_least(const fuzz_frame *f, const fxs_context *context, fxs_frame_memory *memory)
{
    fxs_stats stats = {.visible = 0};
    const int refused = fuzz_frame_bytes(f, memory) &&
                        fuzz_render(f, context, memory->least, &stats) == FXS_ERR_MEMORY;
    memory->rows = stats.memory.rows;
    return refused ? stats.memory.least : memory->least;
}

#endif
