/* Back end that runs all stages of a frame on the processor (no GPU). */
#include <stdio.h>
#include <stdlib.h>

#include <fixsplat/internal/backends.h>
#include "processor_internal.h"

static int device(int number, char *name, size_t size, fxs_message *why)
{
    if (number != 0)
        return fxs_fail_as(FXS_ERR_DEVICE, why, "there is no device %d: the processor is 0", number);
    snprintf(name, size, "the processor");
    return 0;
}

static int open_cpu(void **self, const fxs_backend_options *options, fxs_message *why)
{
    static const fxs_config no_drawing = {.size = sizeof(fxs_config)};
    fxs_processor *p = malloc(sizeof *p);
    *self = 0;
    if (!p)
        return fxs_fail_memory(why, 0, sizeof *p);
    const int error = options->device ? device(options->device, 0, 0, why)
                                      : fxs_processor_open(p, options, &no_drawing, why);
    if (error)
        free(p);
    else
        *self = p;
    return error;
}

static int render(void *self, const fxs_request *request, fxs_stats *stats, fxs_message *why)
{
    return fxs_processor_render(self, request, stats, why);
}

static int pick(void *self, const fxs_request *request, int32_t x, int32_t y, fxs_pick_result *result,
                fxs_message *why)
{
    return fxs_processor_pick(self, request, x, y, result, why);
}

static void forget(void *self, const fxs_scene *scene)
{
    (void)self, (void)scene;
}

static const char *version(const void *self, enum fxs_stage stage)
{
    const fxs_processor *p = self;
    return p->context.config.kernels->name[stage];
}

static uint64_t nanoseconds(const void *self)
{
    (void)self;
    return 0;
}

static void close_cpu(void *self)
{
    if (self)
        fxs_processor_close(self);
    free(self);
}

const fxs_backend fxs_backend_cpu = {
    .name = "cpu", .does = "every stage on the processor",
    .can = FXS_CAN_TRACE | FXS_CAN_COMPOSE | FXS_CAN_PART | FXS_CAN_RATES,
    .device = device, .open = open_cpu,
    .render = render, .forget = forget, .version = version, .nanoseconds = nanoseconds, .close = close_cpu,
    .pick = pick
};
