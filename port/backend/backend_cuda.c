/* Back end of the CUDA renderer (kernels/cuda). */
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/backends.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/message.h>
#ifdef FXS_WITH_CUDA
#include <fixsplat/cuda.h>
#include "src/core/mirror.h"
#include "src/core/stereo.h"
#endif

#ifdef FXS_WITH_CUDA

#define EYES 2u                    /* number of frames that CUDA renders concurrently: the two eyes of a stereo frame */

typedef struct cuda_backend {
    fxs_cuda *cuda;
    uint64_t nanoseconds;
    uint64_t pool_bytes;           /* size of the pools of scenes in parts */
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

/* Divides the GPU's time of a frame among the stages of rendering, in proportion to the stages' times. The stages of
   two eyes overlap, so their times cannot be added. */
static void fill_times(fxs_stats *out, const fxs_cuda_stats *stats, uint64_t nanoseconds)
{
    static const enum fxs_stage stages[FXS_CUDA_STAGES] = {FXS_PROJECT, FXS_BIN, FXS_SORT, FXS_BLEND};
    double sum = 0;
    for (int i = 0; i < FXS_CUDA_STAGES; i++)
        sum += (double)stats->milliseconds[i];
    for (int i = 0; i < FXS_CUDA_STAGES && sum > 0; i++)
        out->nanoseconds[stages[i]] = (uint64_t)((double)nanoseconds * (double)stats->milliseconds[i] / sum);
}

static void fill_stats(fxs_stats *out, const fxs_cuda_stats *stats, const fxs_request *request, uint64_t device,
                       uint64_t nanoseconds)
{
    memset(out, 0, sizeof *out);
    out->gaussians = stats->gaussians / request->eyes;
    out->missing = stats->missing;
    out->visible = stats->visible;
    out->entries = stats->entries;
    out->bands = out->runs = request->eyes;
    out->memory.splats = (size_t)stats->memory.splats;
    out->memory.tiles = (size_t)stats->memory.tiles;
    out->memory.entries = (size_t)stats->memory.entries;
    out->memory.total = (size_t)(stats->memory.total - stats->memory.scenes);
    fill_times(out, stats, device);
    out->frame_nanoseconds = nanoseconds;
}

static int check_request(const fxs_request *r, fxs_message *why)
{
    if (r->eyes < 1 || r->eyes > EYES)
        return fxs_fail_as(FXS_ERR_ARGUMENT, why, "one or two eyes");
    const int error = r->eyes == 2 ? fxs_stereo_check(r) : 0;
    return !error ? 0
           : fxs_fail_as(error, why, error == FXS_ERR_SIZE ? "the pictures of two eyes differ in size or projection"
                                                           : "the targets of two eyes overlap");
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
    fxs_cuda_stereo(b->cuda, request->eyes == 2);
    b->pool_bytes = fxs_mirror_usual_bytes(request, b->pool_bytes);
    fxs_cuda_stream(b->cuda, b->pool_bytes, 0);
    error = error ? error : fxs_cuda_render_host(b->cuda, frames, request->eyes, &request->options, &cuda_stats, why);
    if (error)
        return error;
    b->nanoseconds = (uint64_t)(cuda_stats.device_milliseconds * 1e6f);
    if (stats)
        fill_stats(stats, &cuda_stats, request, b->nanoseconds, fxs_clock(0) - start);
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
    .name = "cuda", .does = "whole frames on a GPU",
    .can = FXS_CAN_TRACE | FXS_CAN_COMPOSE | FXS_CAN_DEVICES | FXS_CAN_PART,
    .device = device_name, .open = open_device, .render = render, .forget = forget, .version = version,
    .nanoseconds = nanoseconds, .close = close_device
};
