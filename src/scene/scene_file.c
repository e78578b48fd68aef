/* Opens scenes in files or in memory. The content of the file tells the format, whose reader is started. */
#include <fixsplat/scene.h>

#include <stdio.h>
#include <string.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>

#include "formats_internal.h"
#include "src/base/files_internal.h"

static char *path_of_file(const char *path, const fxs_allocator *allocator)
{
    const size_t room = strlen(path) + 64;
    const char *name;
    char *found = fxs_allocate(allocator, room, 1);
    if (!found)
        return NULL;
    snprintf(found, room, "%s", path);
    int is_found = fxs_file_kind(path) != FXS_FILE_FOLDER;
    for (int i = 0; !is_found && (name = fxs_format_index_name(i)) != NULL; i++) {
        snprintf(found, room, "%s/%.*s", path, (int)strcspn(name, " "), name);
        is_found = fxs_file_kind(found) != FXS_FILE_NONE;
    }
    return found;
}

/* Numbered files stand for a moving scene: a path with a *, or a folder without the index of another format. */
static int is_numbered(const char *path, const fxs_allocator *allocator)
{
    if (strchr(path, '*'))
        return fxs_file_kind(path) == FXS_FILE_NONE;
    char *found = fxs_file_kind(path) == FXS_FILE_FOLDER ? path_of_file(path, allocator) : NULL;
    const int is = found && fxs_file_kind(found) == FXS_FILE_NONE;
    fxs_release(allocator, found);
    return is;
}

#ifdef FXS_TO_PACK
#define NUMBERED NULL
#else
#define NUMBERED &fxs_read_numbered
#endif

static int open_path(fxs_scene_source *source, const char *path, fxs_message *message)
{
    char *found = path_of_file(path, source->options.allocator);
    if (!found)
        return fxs_fail_memory(message, path, 0);
    int result = fxs_scene_source_open(source, found, message);
    fxs_release(source->options.allocator, found);
    return result;
}

static int begin(fxs_scene_file *file, fxs_scene_file_info *info, fxs_message *message)
{
    const fxs_format_row *format;
    FXS_TRY(fxs_import_count(&file->source, message));
    FXS_TRY(fxs_format_by_content(&file->source, &format, message));
    if (file->source.options.rate > 0)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: a rate (--rate) is for numbered files", file->source.path);
    if (file->source.options.axes && format->reader != &fxs_read_spz)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: axes (--axes) are for .spz", file->source.path);
    return fxs_stream_begin(file, format->about.name, format->reader, info, message);
}

static int open_any(const char *path, const fxs_scene_input *input, const fxs_scene_file_options *options,
                    fxs_scene_file **file, fxs_scene_file_info *info, fxs_message *message)
{
    int result = fxs_stream_create(file, path, options, message);
    if (result) {
        if (input && input->close)
            input->close(input->argument);
        return result;
    }
    fxs_scene_file *f = *file;
    const fxs_reader *numbered = NUMBERED;
    if (numbered && !input && is_numbered(path, f->source.options.allocator)) {
        result = fxs_scene_source_open_input(&f->source, path, &(fxs_scene_input){.size = 0}, message);
        result = result ? result : fxs_stream_begin(f, "numbered files", numbered, info, message);
    } else {
        result = input ? fxs_scene_source_open_input(&f->source, path, input, message)
                       : open_path(&f->source, path, message);
        result = result ? result : begin(f, info, message);
    }
    if (result) {
        fxs_scene_file_close(f);
        *file = NULL;
    }
    return result;
}

int fxs_scene_file_open(const char *path, const fxs_scene_file_options *options, fxs_scene_file **file,
                        fxs_scene_file_info *info, fxs_message *message)
{
    return open_any(path, NULL, options, file, info, message);
}

int fxs_scene_file_open_memory(const char *name, const void *data, size_t size, const fxs_scene_file_options *options,
                               fxs_scene_file **file, fxs_scene_file_info *info, fxs_message *message)
{
    const fxs_scene_input input = fxs_memory_input(data, size);
    return open_any(name, &input, options, file, info, message);
}

int fxs_scene_file_open_input(const char *name, const fxs_scene_input *input, const fxs_scene_file_options *options,
                              fxs_scene_file **file, fxs_scene_file_info *info, fxs_message *message)
{
    return open_any(name, input, options, file, info, message);
}
