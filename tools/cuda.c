/* --backend cuda: frames rendered on a GPU. */
#include <inttypes.h>
#include <string.h>

#include "../port/posix/clock.h"
#include "command.h"

#ifdef FXS_WITH_CUDA
#include "../kernels/cuda/cuda.h"

static int fail_cuda(const renderer *r, const fxs_message *why)
{
    if (why->bytes_needed && r->max_memory)
        return fail(EXIT_FAILED, "--backend cuda: %s: %" PRIu64 " bytes needed, --max-memory is %zu", why->text,
                    why->bytes_needed, r->max_memory);
    if (why->bytes_needed)
        return fail(EXIT_FAILED, "--backend cuda: %s: %" PRIu64 " bytes needed", why->text, why->bytes_needed);
    return fail(EXIT_FAILED, "--backend cuda: %s", why->text);
}

int cuda_open(renderer *r, int device)
{
    fxs_message why;
    if (fxs_cuda_create(&r->cuda, device, r->max_memory, 1, &why))
        return fail_cuda(r, &why);
    fxs_cuda_time(r->cuda, 1);
    for (int i = 0; i < FXS_STAGES; i++)
        r->context.kernels.name[i] = "cuda";
    return 0;
}

void cuda_close(renderer *r)
{
    fxs_cuda_destroy(r->cuda);
}

/* shade is part of project, sort and resolve are part of blend. */
static void fill_stats(fxs_stats *out, const fxs_cuda_stats *stats, uint32_t gaussians, uint64_t nanoseconds)
{
    memset(out, 0, sizeof *out);
    out->gaussians = gaussians;
    out->visible = stats->visible;
    out->entries = stats->entries;
    out->bands = out->runs = 1;
    out->memory.splats = (size_t)stats->memory.splats;
    out->memory.tiles = (size_t)stats->memory.tiles;
    out->memory.entries = (size_t)stats->memory.entries;
    out->memory.total = (size_t)(stats->memory.total - stats->memory.scenes);
    out->nanoseconds[FXS_PROJECT] = (uint64_t)(stats->milliseconds[FXS_CUDA_PROJECT] * 1e6f);
    out->nanoseconds[FXS_BIN] = (uint64_t)(stats->milliseconds[FXS_CUDA_BIN] * 1e6f);
    out->nanoseconds[FXS_BLEND] = (uint64_t)(stats->milliseconds[FXS_CUDA_BLEND] * 1e6f);
    out->frame_nanoseconds = nanoseconds;
}

int cuda_render(renderer *r, const loaded_scene *loaded, const fxs_camera *camera, const fxs_options *options,
                uint8_t *pixels, ptrdiff_t stride, fxs_stats *stats)
{
    fxs_message why;
    fxs_cuda_stats cuda_stats;
    fxs_object object;
    fxs_cuda_frame frame = {*camera, &object, 1, {.colour = {pixels, stride}}};
    fxs_object_init(&object, &loaded->scene);
    int error = fxs_cuda_upload(r->cuda, &loaded->scene, &why);
    uint64_t start = fxs_clock(0);
    if (!error)
        error = fxs_cuda_render_host(r->cuda, &frame, 1, options, &cuda_stats, &why);
    if (error)
        return fail_cuda(r, &why);
    if (stats)
        fill_stats(stats, &cuda_stats, loaded->scene.count, fxs_clock(0) - start);
    return 0;
}

static int devices_here(void)
{
    return fxs_cuda_devices();
}

void cuda_list(void)
{
    char name[256];
    fxs_message why;
    int device = 0;
    for (; device < fxs_cuda_devices() && !fxs_cuda_name(device, name, sizeof name, &why); device++)
        printf("%-11s here: %s, --device %d (whole frames on a GPU, the same bytes)\n", "cuda", name, device);
    if (device == 0 && fxs_cuda_name(0, name, sizeof name, &why))
        printf("%-11s not here: %s (whole frames on a GPU, the same bytes)\n", "cuda", why.text);
}

#else

int cuda_open(renderer *r, int device)
{
    (void)r, (void)device;
    return fail(EXIT_FAILED, "--backend cuda: this build has no CUDA back end; build it where there is nvcc");
}

void cuda_close(renderer *r)
{
    (void)r;
}

int cuda_render(renderer *r, const loaded_scene *loaded, const fxs_camera *camera, const fxs_options *options,
                uint8_t *pixels, ptrdiff_t stride, fxs_stats *stats)
{
    (void)r, (void)loaded, (void)camera, (void)options, (void)pixels, (void)stride, (void)stats;
    return EXIT_FAILED;
}

static int devices_here(void)
{
    return 0;
}

void cuda_list(void)
{
    printf("%-11s not here: built without nvcc (whole frames on a GPU, the same bytes)\n", "cuda");
}

#endif

int cuda_devices(const view_options *options, int devices[DEVICES_MOST])
{
    int count = strcmp(options->backend, "cuda") ? 1 : options->device_count;
    for (int i = 0; i < count; i++)
        devices[i] = options->devices[i];
    if (count)
        return count;
    count = devices_here();
    count = count < 1 ? 1 : count > DEVICES_MOST ? DEVICES_MOST : count;
    for (int i = 0; i < count; i++)
        devices[i] = i;
    return count;
}
