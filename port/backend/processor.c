/* Renders frames and picks Gaussians on the processor. Owns the rendering context, the thread pool, and working memory
 * that grows as frames need it. */
#include "processor_internal.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/system.h>
#ifdef FXS_WITH_KERNELS
#include <fixsplat/internal/kernels.h>
#endif

int fxs_processor_open(fxs_processor *p, const fxs_backend_options *options, const fxs_config *drawing,
                       fxs_message *why)
{
    const uint32_t threads = options->threads ? options->threads : fxs_processors();
    fxs_config config = *drawing;
    memset(p, 0, sizeof *p);
    if (threads > 64)
        return fxs_fail_as(FXS_ERR_ARGUMENT, why, "%" PRIu32 " threads: expected 1 to 64", threads);
    p->max_memory = options->max_memory < SIZE_MAX ? (size_t)options->max_memory : SIZE_MAX;
    config.workers.count = threads;
    config.clock = fxs_clock;
    if (threads > 1) {
        p->pool = fxs_pool_create(threads);
        if (!p->pool)
            return fxs_fail_as(FXS_ERR_MEMORY, why, "cannot start %" PRIu32 " threads", threads);
        config.workers.run = fxs_pool_run;
        config.workers.pool = p->pool;
    }
#ifdef FXS_WITH_KERNELS
    fxs_kernels_choose(&p->kernels, fxs_cpu_detect() & ~options->without_cpu);
    config.kernels = &p->kernels;
#endif
    const int error = fxs_context_init(&p->context, &config);
    if (error) {
        fxs_processor_close(p);
        return fxs_fail_as(error, why, "%s", fxs_strerror(error));
    }
    return 0;
}

static int make_room(fxs_processor *p, size_t bytes, const fxs_camera *camera, fxs_message *why)
{
    bytes = bytes ? bytes : 64;
    if (p->max_memory && p->max_memory < bytes)
        bytes = p->max_memory;
    if (bytes <= p->memory_bytes)
        return 0;
    free(p->allocation);
    p->allocation = bytes < SIZE_MAX - 63 ? malloc(bytes + 63) : 0;
    p->memory = (void *)(((uintptr_t)p->allocation + 63) / 64 * 64);
    p->memory_bytes = p->allocation ? bytes : 0;
    if (p->allocation)
        return 0;
    fxs_fail(why, "out of memory: a frame of %" PRId32 "x%" PRId32 " needs %zu bytes", camera->width, camera->height,
             bytes);
    why->bytes_needed = bytes;
    return FXS_ERR_MEMORY;
}

static int fail_frame(const fxs_processor *p, int error, const fxs_stats *stats, fxs_message *why)
{
    if (error != FXS_ERR_MEMORY || stats->memory.least <= p->memory_bytes)
        return fxs_fail_as(error, why, "%s", fxs_strerror(error));
    fxs_fail(why, "%zu bytes of memory are too few, it takes %zu", p->memory_bytes, stats->memory.least);
    why->bytes_needed = stats->memory.least;
    return error;
}

int fxs_processor_render(fxs_processor *p, const fxs_request *q, fxs_stats *stats, fxs_message *why)
{
    fxs_stats own;
    if (q->eyes != 1 && q->eyes != 2)
        return fxs_fail_as(FXS_ERR_ARGUMENT, why, "%" PRIu32 " eyes: expected 1 or 2", q->eyes);
    stats = stats ? stats : &own;
    memset(stats, 0, sizeof *stats);
    const size_t bytes = fxs_request_bytes(&p->context, q, 0);
    if (make_room(p, bytes, q->cameras, why))
        return FXS_ERR_MEMORY;
    const int error = fxs_render(&p->context, q, p->memory, p->memory_bytes, stats);
    return error ? fail_frame(p, error, stats, why) : 0;
}

int fxs_processor_pick(fxs_processor *p, const fxs_request *q, int32_t x, int32_t y, fxs_pick_result *result,
                       fxs_message *why)
{
    fxs_request one = *q;
    one.eyes = 1;
    const size_t bytes = fxs_request_bytes(&p->context, &one, 0);
    if (make_room(p, bytes, q->cameras, why))
        return FXS_ERR_MEMORY;
    const int found = fxs_pick(&p->context, q, x, y, p->memory, p->memory_bytes, result);
    return found < 0 ? fxs_fail_as(found, why, "%s", fxs_strerror(found)) : found;
}

void fxs_processor_close(fxs_processor *p)
{
    fxs_pool_destroy(p->pool);
    free(p->allocation);
}
