/* Sets and reads structs that begin with their size. A struct that a program hands in may be shorter than the
 * library's, because the program was built with an older header. The missing fields get their defaults. A longer struct
 * comes from a newer header; its surplus fields are ignored. */
#include "sized.h"

#include <stddef.h>

static uint32_t size_of(const void *given)
{
    uint32_t size;
    memcpy(&size, given, sizeof size);
    return size > FXS_SIZE_MOST ? 0 : size;
}

void fxs_sized_fill(void *given, uint32_t size, const void *all, size_t bytes)
{
    memset(given, 0, size);
    memcpy(given, all, size < bytes ? size : bytes);
    memcpy(given, &size, sizeof size);
}

void fxs_struct_init(void *options, uint32_t size)
{
    memset(options, 0, size);
    memcpy(options, &size, sizeof size);
}

void (fxs_options_init)(fxs_options *options, uint32_t size)
{
    const fxs_options all = {.sh_degree = 3};
    fxs_sized_fill(options, size, &all, sizeof all);
}

void (fxs_targets_init)(fxs_targets *targets, uint32_t size)
{
    fxs_struct_init(targets, size);
}

void (fxs_object_init)(fxs_object *object, const fxs_scene *scene, uint32_t size)
{
    const fxs_object all = {.scene = scene, .rotation_q30 = {1 << 30, 0, 0, 0, 1 << 30, 0, 0, 0, 1 << 30},
                            .scale_q32 = (int64_t)1 << 32, .opacity_q16 = 1 << 16,
                            .tint_q13 = {1 << 13, 1 << 13, 1 << 13}, .visible = 1};
    fxs_sized_fill(object, size, &all, sizeof all);
}

int fxs_sized_read(void *all, size_t bytes, const void *given)
{
    const uint32_t size = size_of(given), whole = (uint32_t)bytes;
    memcpy(all, given, size < bytes ? size : bytes);
    memcpy(all, &whole, sizeof whole);
    return size ? 0 : FXS_ERR_STRUCT;
}

int fxs_request_is_whole(const fxs_request *request)
{
    return request && request->size == sizeof *request && request->targets[0].size == sizeof request->targets[0] &&
           request->targets[1].size == sizeof request->targets[1] && request->options.size == sizeof request->options;
}

/* A program's request: the fields before the targets, two targets of targets[0].size bytes, and the options. */
int fxs_request_read(fxs_request *all, const fxs_request *given)
{
    const size_t head = offsetof(fxs_request, targets);
    if (!given)
        return FXS_ERR_ARGUMENT;
    const unsigned char *at = (const unsigned char *)given + head;
    const uint32_t size = size_of(given), step = size > head ? size_of(at) : 0;
    fxs_request_init(all, 0, 0);
    if (!step || size < head + 2 * (size_t)step)
        return FXS_ERR_STRUCT;
    memcpy(all, given, head);
    all->size = (uint32_t)sizeof *all;
    int error = fxs_sized_read(&all->targets[0], sizeof all->targets[0], at);
    error = error || size_of(at + step) != step ? FXS_ERR_STRUCT
            : fxs_sized_read(&all->targets[1], sizeof all->targets[1], at + step);
    at += 2 * (size_t)step;
    const size_t left = size - head - 2 * (size_t)step;
    return error || !left ? error
           : left < sizeof size || left < size_of(at) ? FXS_ERR_STRUCT
           : fxs_sized_read(&all->options, sizeof all->options, at);
}

int fxs_object_read(fxs_object *all, const fxs_object *objects, uint32_t i)
{
    const uint32_t size = size_of(objects);
    const void *given = (const unsigned char *)objects + (size_t)i * size;
    fxs_object_init(all, 0);
    return !size || size_of(given) != size ? FXS_ERR_STRUCT : fxs_sized_read(all, sizeof *all, given);
}
