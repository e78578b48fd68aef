/* Fills in the table of backend.h for the CUDA back end (kernels/cuda). */
#include <stdlib.h>
#include <string.h>

#include <fixsplat/message.h>
#include <fixsplat/clock.h>
#include <fixsplat/backends.h>
#ifdef FXS_WITH_CUDA
#include <fixsplat/cuda.h>
#endif

#ifdef FXS_WITH_CUDA

#define EYES 2u                    /* slots, so that the stages of both are timed */

typedef struct cuda_backend {
    fxs_cuda *cuda;
    uint64_t nanoseconds;          /* of the last frame, on the device */
} cuda_backend;

static int device_name(int device, char *name, size_t size, fxs_message *why)
{
    return fxs_cuda_name(device, name, size, why);
}

static int open_device(void **self, const fxs_backend_options *options, fxs_message *why)
{
    *self = 0;
    cuda_backend *b = calloc(1, sizeof *b);
    if (!b)
        return fxs_fail_memory(why, 0, sizeof *b);
    const int error = fxs_cuda_create(&b->cuda, options->device, options->max_memory, EYES, why);
    if (error) {
        free(b);
        return error;
    }
    fxs_cuda_time(b->cuda, 1);
    *self = b;
    return 0;
}

static uint64_t nanoseconds_of(const fxs_cuda_stats *stats, enum fxs_cuda_stage stage)
{
    return (uint64_t)(stats->milliseconds[stage] * 1e6f);
}

/* shade is part of project, resolve is part of blend. */
static void fill_stats(fxs_stats *out, const fxs_cuda_stats *stats, uint32_t eyes, uint64_t nanoseconds)
{
    memset(out, 0, sizeof *out);
    out->gaussians = stats->gaussians / eyes;
    out->visible = stats->visible;
    out->entries = stats->entries;
    out->bands = out->runs = eyes;
    out->memory.splats = (size_t)stats->memory.splats;
    out->memory.tiles = (size_t)stats->memory.tiles;
    out->memory.entries = (size_t)stats->memory.entries;
    out->memory.total = (size_t)(stats->memory.total - stats->memory.scenes);
    out->nanoseconds[FXS_PROJECT] = nanoseconds_of(stats, FXS_CUDA_PROJECT);
    out->nanoseconds[FXS_BIN] = nanoseconds_of(stats, FXS_CUDA_BIN);
    out->nanoseconds[FXS_SORT] = nanoseconds_of(stats, FXS_CUDA_SORT);
    out->nanoseconds[FXS_BLEND] = nanoseconds_of(stats, FXS_CUDA_BLEND);
    out->frame_nanoseconds = nanoseconds;
}

static int check_request(const fxs_request *r, fxs_message *why)
{
    if (r->eyes < 1 || r->eyes > EYES)
        return fxs_fail_as(FXS_ERR_ARGUMENT, why, "one or two eyes");
    if (r->eyes == 1)
        return 0;
    if (!r->exact)
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "the CUDA back end renders each eye by itself: exact only");
    if (r->cameras[0].width != r->cameras[1].width || r->cameras[0].height != r->cameras[1].height ||
        r->cameras[0].projection != r->cameras[1].projection)
        return fxs_fail_as(FXS_ERR_SIZE, why, "the pictures of two eyes differ in size or projection");
    return 0;
}

static int render(void *self, const fxs_request *request, fxs_stats *stats, fxs_message *why)
{
    cuda_backend *b = self;
    fxs_cuda_frame frames[EYES];
    fxs_cuda_stats cuda_stats;
    const uint64_t start = fxs_clock(0);
    int error = check_request(request, why);
    for (uint32_t i = 0; i < request->eyes && !error; i++)
        frames[i] = (fxs_cuda_frame){request->cameras[i], request->objects, request->count, request->targets[i]};
    if (!error)
        error = fxs_cuda_render_host(b->cuda, frames, request->eyes, &request->options, &cuda_stats, why);
    if (error)
        return error;
    b->nanoseconds = 0;
    for (int stage = 0; stage < FXS_CUDA_STAGES; stage++)
        b->nanoseconds += nanoseconds_of(&cuda_stats, (enum fxs_cuda_stage)stage);
    if (stats)
        fill_stats(stats, &cuda_stats, request->eyes, fxs_clock(0) - start);
    return 0;
}

static void forget(void *self, const fxs_scene *scene)
{
    fxs_cuda_forget(((cuda_backend *)self)->cuda, scene);
}

static uint64_t nanoseconds(const void *self)
{
    return ((const cuda_backend *)self)->nanoseconds;
}

static void close_device(void *self)
{
    cuda_backend *b = self;
    if (b)
        fxs_cuda_destroy(b->cuda);
    free(b);
}

#else

#define ABSENT FXS_WITHOUT_CUDA
#include "absent.h"

#endif

static const char *version(const void *self, enum fxs_stage stage)
{
    (void)self, (void)stage;
    return "cuda";
}

const fxs_backend fxs_backend_cuda = {
    .name = "cuda", .does = "whole frames on a GPU, the same bytes",
    .can = FXS_CAN_EXACT | FXS_CAN_TRACE | FXS_CAN_COMPOSE | FXS_CAN_DEVICES,
    .device = device_name, .open = open_device, .render = render, .forget = forget, .version = version,
    .nanoseconds = nanoseconds, .close = close_device
};
