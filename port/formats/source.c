#include "source_internal.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* ---- Files ----------------------------------------------------------------------------------------------------- */

static int read_file(void *argument, uint64_t offset, void *out, size_t size)
{
    FILE *stream = argument;
    return fseeko(stream, (off_t)offset, SEEK_SET) == 0 && fread(out, 1, size, stream) == size ? 0 : -1;
}

static void close_file(void *argument)
{
    fclose(argument);
}

/* Unbuffered: who reads little at a time has a buffer of his own. */
static int open_file(fxs_scene_source *source, fxs_message *message)
{
    const char *path = source->path;
    struct stat status;
    if (stat(path, &status) != 0)
        return fxs_fail(message, "%s: %s", path, strerror(errno));
    if (!S_ISREG(status.st_mode))   /* before fopen, which waits for the writer of a pipe */
        return fxs_fail(message, "%s: not a regular file", path);
    FILE *stream = fopen(path, "rb");
    if (!stream)
        return fxs_fail(message, "%s: %s", path, strerror(errno));
    setvbuf(stream, NULL, _IONBF, 0);
    source->input = (fxs_scene_input){(uint64_t)status.st_size, read_file, NULL, close_file, stream};
    return 0;
}

/* ---- Memory ---------------------------------------------------------------------------------------------------- */

static int read_memory(void *argument, uint64_t offset, void *out, size_t size)
{
    memcpy(out, (const unsigned char *)argument + offset, size);
    return 0;
}

fxs_scene_input fxs_memory_input(const void *data, size_t size)
{
    return (fxs_scene_input){size, read_memory, NULL, NULL, (void *)data};
}

/* ---- Opening --------------------------------------------------------------------------------------------------- */

/* Sets the path to a folder, the first `folder` characters of a path, and a name. */
static int set_path(fxs_scene_source *source, const char *path, size_t folder, const char *name, fxs_message *message)
{
    size_t length = strlen(name);
    source->path = fxs_allocate(source->options.allocator, folder + length + 1, 1);
    if (!source->path)
        return fxs_fail(message, "%s: out of memory", path);
    memcpy(source->path, path, folder);
    memcpy(source->path + folder, name, length + 1);
    return 0;
}

static size_t folder_length(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash + 1 - path) : 0;
}

int fxs_scene_source_open(fxs_scene_source *source, const char *path, fxs_message *message)
{
    return set_path(source, path, 0, path, message) ? -1 : open_file(source, message);
}

int fxs_scene_source_open_input(fxs_scene_source *source, const char *name, const fxs_scene_input *input,
                                fxs_message *message)
{
    source->input = *input;
    return set_path(source, name, 0, name, message);
}

int fxs_scene_source_open_beside(fxs_scene_source *opened, const fxs_scene_source *source, const char *name,
                                 fxs_message *message)
{
    const fxs_scene_source *first = source->first ? source->first : source;
    memset(opened, 0, sizeof *opened);
    opened->first = first;
    opened->options = source->options;
    if (set_path(opened, source->path, folder_length(source->path), name, message))
        return -1;
    if (first->input.read == read_file)
        return open_file(opened, message);
    if (!first->input.beside)
        return fxs_fail(message, "%s: needs the file %s beside it, but was not opened from a folder", source->path,
                        name);
    if (!first->input.beside(first->input.argument, opened->path + folder_length(first->path), &opened->input))
        return 0;
    memset(&opened->input, 0, sizeof opened->input);
    return fxs_fail(message, "%s: cannot be opened", opened->path);
}

void fxs_scene_source_close(fxs_scene_source *source)
{
    if (source->input.close)
        source->input.close(source->input.argument);
    fxs_release(source->options.allocator, source->path);
    memset(source, 0, sizeof *source);
}

/* ---- Reading --------------------------------------------------------------------------------------------------- */

int fxs_scene_source_read(const fxs_scene_source *source, uint64_t offset, void *out, size_t size,
                          fxs_message *message)
{
    const fxs_scene_input *input = &source->input;
    if (offset > input->size || size > input->size - offset)
        return fxs_fail(message, "%s: the file ends early", source->path);
    if (size > 0 && input->read(input->argument, offset, out, size) != 0)
        return fxs_fail(message, "%s: read error", source->path);
    return 0;
}

int fxs_scene_source_load(const fxs_scene_source *source, uint64_t offset, uint64_t size, fxs_text *text,
                          fxs_message *message)
{
    if (size > FXS_TEXT_MAX)
        return fxs_fail(message, "%s: larger than %zu MiB", source->path, FXS_TEXT_MAX >> 20);
    char *data = fxs_allocate(source->options.allocator, (size_t)size + 1, 1);
    if (!data)
        return fxs_fail(message, "%s: out of memory", source->path);
    if (fxs_scene_source_read(source, offset, data, (size_t)size, message)) {
        fxs_release(source->options.allocator, data);
        return -1;
    }
    data[size] = 0;
    *text = (fxs_text){source->path, data, (size_t)size};
    return 0;
}

int fxs_scene_source_progress(const fxs_scene_source *source, double done, fxs_message *message)
{
    const fxs_scene_file_options *options = &source->options;
    if (!options->progress || options->progress(options->progress_argument, done) == 0)
        return 0;
    return fxs_fail(message, "%s: stopped", source->path);
}
