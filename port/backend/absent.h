/* Functions of a back end (a way to render) that was built without its library. Each fails with the error message
   ABSENT. */
#ifndef FXS_ABSENT_H
#define FXS_ABSENT_H

#include <fixsplat/backend.h>
#include <fixsplat/internal/message.h>

static int device_name(int device, char *name, size_t size, fxs_message *why)
{
    (void)device, (void)name, (void)size;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, ABSENT);
}

static int open_device(void **self, const fxs_backend_options *options, fxs_message *why)
{
    (void)options;
    *self = 0;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, ABSENT);
}

static int render(void *self, const fxs_request *request, fxs_stats *stats, fxs_message *why)
{
    (void)self, (void)request, (void)stats;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, ABSENT);
}

static void forget(void *self, const fxs_scene *scene)
{
    (void)self, (void)scene;
}

static uint64_t nanoseconds(const void *self)
{
    (void)self;
    return 0;
}

static void close_device(void *self)
{
    (void)self;
}

#endif
