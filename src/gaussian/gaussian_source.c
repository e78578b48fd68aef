/* Reads Gaussians that a callback of the caller supplies, with the checks of a file reader. */
#include <math.h>
#include <string.h>

#include "origin_internal.h"
#include "src/base/options.h"
#include "stream_internal.h"

enum { MOTIONS = 4096 };

typedef struct gaussians_reader {
    fxs_gaussian_source from;
    fxs_motion_source moving;      /* read is null: the Gaussians are still */
    fxs_motion *motions;
    const fxs_scene_source *source;
    const char *name;
    uint64_t next;
} gaussians_reader;

/* What a program hands in. */
typedef struct program_source {
    const fxs_gaussian_source *gaussians;
    const fxs_motion_source *motions;
} program_source;

static int open_motions(gaussians_reader *r, const fxs_scene_source *source, const fxs_motion_source *motions,
                        fxs_scene_file_info *info, fxs_message *message)
{
    FXS_TRY(FXS_OPTIONS_READ(fxs_motion_source, &r->moving, motions, message));
    const fxs_time *time = &r->moving.time;
    if (!r->moving.read || !(time->duration > 0 && time->duration <= 16384) || time->degree < 0 || time->degree > 3)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: no function that reads motions, a duration of %g seconds, "
                           "not above 0 and at most 16384, or a degree of %d, not 0 to 3", r->name, time->duration,
                           time->degree);
    r->motions = fxs_hold(source, MOTIONS * sizeof *r->motions, message);
    info->time = *time;
    return r->motions ? 0 : FXS_ERR_MEMORY;
}

static void gaussians_close(void *handle)
{
    gaussians_reader *r = handle;
    if (r->motions)
        fxs_let_go(r->source, r->motions, MOTIONS * sizeof *r->motions);
}

static const fxs_motion *gaussians_motions(const void *handle)
{
    return ((const gaussians_reader *)handle)->motions;
}

static int gaussians_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info,
                          fxs_message *message)
{
    gaussians_reader *r = handle;
    const program_source *program = source->input.argument;
    r->from = *program->gaussians;
    r->source = source;
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
    return program->motions ? open_motions(r, source, program->motions, info, message) : 0;
}

static long gaussians_read(void *handle, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    gaussians_reader *r = handle;
    const uint64_t left = r->from.count - r->next;
    const size_t room = r->motions && capacity > MOTIONS ? MOTIONS : capacity;
    const size_t wanted = room < left ? room : (size_t)left;
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
    const int error = r->motions ? r->moving.read(r->moving.argument, r->next, r->motions, (size_t)count) : 0;
    if (error)
        return fxs_fail_as(error < 0 && error >= FXS_ERR_FILE ? error : FXS_ERR_FILE, message,
                           "%s: the function that reads motions failed", r->name);
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
    NULL, sizeof(gaussians_reader), gaussians_open, gaussians_read, gaussians_rewind, gaussians_close,
    gaussians_motions
};

static int open_program(const char *name, const program_source *program, const fxs_scene_file_options *options,
                        fxs_scene_file **file, fxs_scene_file_info *info, fxs_message *message)
{
    const fxs_scene_input input = {.argument = (void *)program};
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

int fxs_scene_file_open_gaussians(const char *name, const fxs_gaussian_source *gaussians,
                                  const fxs_scene_file_options *options, fxs_scene_file **file,
                                  fxs_scene_file_info *info, fxs_message *message)
{
    return open_program(name, &(program_source){gaussians, NULL}, options, file, info, message);
}

int fxs_scene_file_open_moving(const char *name, const fxs_gaussian_source *gaussians,
                               const fxs_motion_source *motions, const fxs_scene_file_options *options,
                               fxs_scene_file **file, fxs_scene_file_info *info, fxs_message *message)
{
    return open_program(name, &(program_source){gaussians, motions}, options, file, info, message);
}
