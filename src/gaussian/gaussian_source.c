/* Gaussians of the program, read like those of a file. What it hands over is trusted no more than a file is. */
#include <string.h>

#include "src/scene/scene_format.h"

typedef struct gaussians_reader {
    fxs_gaussian_source from;
    const char *name;
    uint64_t next;                       /* Gaussian to be read */
} gaussians_reader;

static int gaussians_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info,
                          fxs_message *message)
{
    gaussians_reader *r = handle;
    r->from = *(const fxs_gaussian_source *)source->input.argument;
    r->name = source->path;
    if (!r->from.read || r->from.sh_degree < 0 || r->from.sh_degree > 3)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: no function that reads, or SH degree %d, not 0 to 3", r->name,
                           r->from.sh_degree);
    info->count = r->from.count;
    info->sh_degree = r->from.sh_degree;
    info->antialiased = r->from.antialiased != 0;
    return 0;
}

static long gaussians_read(void *handle, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    gaussians_reader *r = handle;
    const uint64_t left = r->from.count - r->next;
    const size_t wanted = capacity < left ? capacity : (size_t)left;
    const size_t coefficients = 3 * (size_t)(r->from.sh_degree * (r->from.sh_degree + 2));
    if (wanted == 0)
        return 0;
    memset(gaussians, 0, wanted * sizeof *gaussians);
    const long count = r->from.read(r->from.argument, r->next, gaussians, wanted);
    if (count < 1 || (size_t)count > wanted)
        return fxs_fail_as(count < 0 && count >= FXS_ERR_FILE ? (int)count : FXS_ERR_FILE, message,
                           "%s: the function that reads gave %ld of %zu Gaussians from %llu on", r->name, count, wanted,
                           (unsigned long long)r->next);
    for (long i = 0; i < count; i++)
        memset(gaussians[i].sh + coefficients, 0, sizeof gaussians->sh - coefficients * sizeof *gaussians->sh);
    r->next += (uint64_t)count;
    return count;
}

static int gaussians_rewind(void *handle, fxs_message *message)
{
    (void)message;
    ((gaussians_reader *)handle)->next = 0;
    return 0;
}

const fxs_scene_format fxs_scene_gaussians = {
    "gaussians", sizeof(gaussians_reader), gaussians_open, gaussians_read, gaussians_rewind, NULL
};
