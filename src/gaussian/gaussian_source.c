/* Reads Gaussians that a callback of the caller supplies, with the checks of a file reader. */
#include <math.h>
#include <string.h>

#include "origin_internal.h"
#include "stream_internal.h"

typedef struct gaussians_reader {
    fxs_gaussian_source from;
    const char *name;
    uint64_t next;
} gaussians_reader;

static int gaussians_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info,
                          fxs_message *message)
{
    gaussians_reader *r = handle;
    r->from = *(const fxs_gaussian_source *)source->input.argument;
    r->name = source->path;
    if (!r->from.read || r->from.sh_degree < 0 || r->from.sh_degree > 3)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: no function that reads, or SH degree %d, not 0 to 3",
                           r->name, r->from.sh_degree);
    for (int i = 0; i < 3; i++)
        if (!(fabs(r->from.origin[i]) <= FXS_ORIGIN_FARTHEST))
            return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: an origin beyond 2^26 units", r->name);
    memcpy(source->import->origin, r->from.origin, sizeof r->from.origin);
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

static const fxs_reader reader = {
    NULL, sizeof(gaussians_reader), gaussians_open, gaussians_read, gaussians_rewind, NULL, NULL
};

int fxs_scene_file_open_gaussians(const char *name, const fxs_gaussian_source *gaussians,
                                  const fxs_scene_file_options *options, fxs_scene_file **file,
                                  fxs_scene_file_info *info, fxs_message *message)
{
    const fxs_scene_input input = {.argument = (void *)gaussians};
    FXS_TRY(fxs_stream_create(file, name, options, message));
    fxs_scene_file_options *own = &(*file)->source.options;
    own->max_gaussians = own->max_gaussians ? own->max_gaussians : FXS_MAX_COUNT;
    int result = fxs_scene_source_open_input(&(*file)->source, name, &input, message);
    if (!result)
        result = fxs_stream_begin(*file, "gaussians", &reader, info, message);
    if (result) {
        fxs_scene_file_close(*file);
        *file = NULL;
    }
    return result;
}
