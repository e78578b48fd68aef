/* Streams of Gaussians: calls the functions of a reader (for one file format), and makes infinite opacity logits
 * finite. */
#include "stream_internal.h"

#include <math.h>
#include <string.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>

#include "attributes.h"
#include "src/base/options.h"

const fxs_motion fxs_still = {.fade = INFINITY, .from = -INFINITY, .to = INFINITY};

int fxs_stream_create(fxs_scene_file **made, const char *path, const fxs_scene_file_options *options,
                      fxs_message *message)
{
    fxs_scene_file_options all;
    fxs_scene_file_options_init(&all);
    *made = NULL;
    FXS_TRY(FXS_OPTIONS_READ(fxs_scene_file_options, &all, options, message));
    fxs_scene_file *file = fxs_allocate_zeroed(all.allocator, 1, sizeof *file);
    if (!file)
        return fxs_fail_memory(message, path, sizeof *file);
    file->source.options = all;
    file->source.import = &file->import;
    *made = file;
    return 0;
}

int fxs_stream_begin(fxs_scene_file *file, const char *format, const fxs_reader *reader, fxs_scene_file_info *info,
                     fxs_message *message)
{
    const fxs_scene_source *source = &file->source;
    const int level = source->options.level;
    file->reader = reader;
    file->data = fxs_allocate_zeroed(source->options.allocator, 1, reader->size);
    if (!file->data)
        return fxs_fail_memory(message, source->path, reader->size);
    info->format = format;
    info->levels = 1;
    info->stored_sh_degree = 0;
    info->colour = info->sh = (fxs_grid){0, 0};
    info->linear_light = info->log_scales = info->clamped_opacity = 0;
    info->unused[0] = 0;
    info->start = (fxs_start){.tangent = 0};
    info->coarse = 0;
    info->time = (fxs_time){.duration = 0};
    FXS_TRY(reader->open(file->data, source, info, message));
    memcpy(info->origin, file->import.origin, sizeof info->origin);
    if (info->stored_sh_degree < info->sh_degree)
        info->stored_sh_degree = info->sh_degree;
    if (level < 0 || level >= info->levels)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: no level %d: levels of detail in this scene: %d",
                           source->path, level, info->levels);
    return fxs_limit_gaussians(source, info->count, message);
}

long fxs_stream_read(const fxs_reader *reader, void *data, fxs_gaussian *gaussians, size_t capacity,
                     fxs_message *message)
{
    const long count = reader->read(data, gaussians, capacity, message);
    for (long i = 0; i < count; i++)
        if (gaussians[i].opacity == INFINITY)
            gaussians[i].opacity = FXS_OPAQUE;
    return count;
}

long fxs_scene_file_read(fxs_scene_file *file, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    return fxs_stream_read(file->reader, file->data, gaussians, capacity, message);
}

const fxs_motion *fxs_scene_file_motions(const fxs_scene_file *file)
{
    return file->reader->motions ? file->reader->motions(file->data) : NULL;
}

int fxs_scene_file_rewind(fxs_scene_file *file, fxs_message *message)
{
    return file->reader->rewind(file->data, message);
}

int fxs_stream_count(fxs_scene_file *file, uint64_t *count, fxs_message *message)
{
    enum { BATCH = 256 };
    fxs_gaussian batch[BATCH];
    long n;
    *count = 0;
    FXS_TRY(fxs_scene_file_rewind(file, message));
    while ((n = fxs_scene_file_read(file, batch, BATCH, message)) > 0)
        *count += (uint64_t)n;
    return n < 0 ? (int)n : fxs_scene_file_rewind(file, message);
}

int fxs_stream_check_still(const fxs_scene_file_info *info, const char *what, fxs_message *message)
{
    return !(info->time.duration > 0) ? 0
           : fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "the scene moves, and moving scenes are not %s; choose a moment",
                         what);
}

const fxs_allocator *fxs_stream_allocator(const fxs_scene_file *file)
{
    return file->source.options.allocator;
}

void fxs_stream_swap(fxs_scene_file *file, const fxs_reader **reader, void **data)
{
    const fxs_reader *old_reader = file->reader;
    void *old_data = file->data;
    file->reader = *reader;
    file->data = *data;
    file->import.moves = 0;
    *reader = old_reader;
    *data = old_data;
}

void fxs_scene_file_close(fxs_scene_file *file)
{
    if (!file)
        return;
    const fxs_allocator *allocator = file->source.options.allocator;
    if (file->data && file->reader->close)
        file->reader->close(file->data);
    fxs_release(allocator, file->data);
    fxs_release(allocator, file->import.files);
    fxs_scene_source_close(&file->source);
    fxs_release(allocator, file);
}
