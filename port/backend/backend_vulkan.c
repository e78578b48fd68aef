/* Back end that renders whole frames in compute shaders of Vulkan (kernels/vulkan), on a device of its own. */
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/backends.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/message.h>
#ifdef FXS_WITH_VULKAN
#include "port/vulkan/vulkan_device.h"
#include "src/core/mirror.h"
#endif

#ifdef FXS_WITH_VULKAN

typedef struct vulkan_backend {
    fxs_backend_options options;
    fxs_vulkan_device device;
    fxs_vulkan *vulkan;            /* null after the device was lost */
    uint64_t pool_bytes;           /* size of the pools of scenes in parts */
} vulkan_backend;

static int device_name(int device, char *name, size_t size, fxs_message *why)
{
    fxs_vulkan_device d;
    const int error = fxs_vulkan_find_device(&d, 0, device, why);
    if (error)
        return error;
    const size_t length = strlen(d.name) < size ? strlen(d.name) : size - 1;
    memcpy(name, d.name, length);
    name[length] = 0;
    fxs_vulkan_close_device(&d);
    return 0;
}

static void shut(vulkan_backend *b)
{
    fxs_vulkan_destroy(b->vulkan);
    fxs_vulkan_close_device(&b->device);
    b->vulkan = 0;
}

static int start(vulkan_backend *b, fxs_message *why)
{
    int error = fxs_vulkan_find_device(&b->device, 0, b->options.device, why);
    error = error ? error : fxs_vulkan_open_device(&b->device, why);
    error = error ? error : fxs_vulkan_create(&b->vulkan, &b->device.options, why);
    if (error) {
        shut(b);
        return error;
    }
    fxs_vulkan_limit(b->vulkan, b->options.max_memory);
    fxs_vulkan_stream(b->vulkan, b->pool_bytes, 0);
    return 0;
}

static void close_device(void *self)
{
    if (self)
        shut(self);
    free(self);
}

static int open_device(void **self, const fxs_backend_options *options, fxs_message *why)
{
    vulkan_backend *b = *self = calloc(1, sizeof *b);
    if (!b)
        return fxs_fail_memory(why, 0, sizeof *b);
    b->options = *options;
    const int error = start(b, why);
    if (error) {
        free(b);
        *self = 0;
    }
    return error;
}

/* Makes the pools of scenes in parts on the device larger if the request needs more. */
static void choose_pools(vulkan_backend *b, const fxs_request *r)
{
    const uint64_t bytes = fxs_mirror_usual_bytes(r, b->pool_bytes);
    if (bytes > b->pool_bytes)
        fxs_vulkan_stream(b->vulkan, bytes, 0);
    b->pool_bytes = bytes;
}

/* Opens the device again if it was lost. */
static int render(void *self, const fxs_request *request, fxs_stats *stats, fxs_message *why)
{
    vulkan_backend *b = self;
    const uint64_t started = fxs_clock(0);
    int error = b->vulkan ? 0 : start(b, why);
    if (!error)
        choose_pools(b, request);
    error = error ? error : fxs_vulkan_render(b->vulkan, request, stats, why);
    if (error == FXS_ERR_DEVICE)
        shut(b);
    if (!error && stats)
        stats->frame_nanoseconds = fxs_clock(0) - started;
    return error;
}

static void forget(void *self, const fxs_scene *scene)
{
    vulkan_backend *b = self;
    if (b->vulkan)
        fxs_vulkan_drop(b->vulkan, scene);
}

static uint64_t nanoseconds(const void *self)
{
    const vulkan_backend *b = self;
    return b->vulkan ? fxs_vulkan_get_info(b->vulkan).nanoseconds : 0;
}

#else

#include "without.h"
#define ABSENT FXS_WITHOUT_HEADERS("libvulkan-dev")
#include "absent.h"

#endif

static const char *version(const void *self, enum fxs_stage stage)
{
    (void)self, (void)stage;
    return "vulkan";
}

const fxs_backend fxs_backend_vulkan = {
    .name = "vulkan", .does = "whole frames in compute shaders of Vulkan 1.1",
    .can = FXS_CAN_TRACE | FXS_CAN_COMPOSE | FXS_CAN_DEVICES | FXS_CAN_PART | FXS_CAN_RATES,
    .device = device_name, .open = open_device,
    .render = render, .forget = forget, .version = version, .nanoseconds = nanoseconds, .close = close_device
};
