#include "backends.h"

#include <string.h>

#include "../files/message.h"

#ifdef FXS_WITH_CUDA
extern const fxs_backend fxs_backend_cuda;
#else
static int no_device(int device, char *name, size_t size, fxs_message *why)
{
    (void)device, (void)name, (void)size;
    fxs_fail(why, "this build is without nvcc, the compiler of the CUDA toolkit");
    why->bytes_needed = 0;
    return FXS_ERR_UNSUPPORTED;
}

static int open_none(void **self, const fxs_backend_options *options, fxs_message *why)
{
    (void)options;
    *self = 0;
    return no_device(0, 0, 0, why);
}

static void close_none(void *self)
{
    (void)self;
}

static const fxs_backend fxs_backend_cuda = {
    .name = "cuda", .does = "whole frames on a GPU, the same bytes", .can = FXS_CAN_EXACT | FXS_CAN_DEVICES,
    .device = no_device, .open = open_none, .close = close_none
};
#endif

const fxs_backend *fxs_backend_at(int index)
{
    static const fxs_backend *const all[] = {&fxs_backend_cpu, &fxs_backend_gles, &fxs_backend_gles_quads,
                                             &fxs_backend_osmesa, &fxs_backend_cuda};
    return index >= 0 && index < (int)(sizeof all / sizeof *all) ? all[index] : 0;
}

const fxs_backend *fxs_backend_find(const char *name)
{
    const fxs_backend *backend = 0;
    if (!strcmp(name, "auto"))
        name = "cpu";
    for (int i = 0; (backend = fxs_backend_at(i)) != 0 && strcmp(backend->name, name); i++)
        ;
    return backend;
}
