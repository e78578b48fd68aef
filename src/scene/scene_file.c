#include <fixsplat/scene_file.h>

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "scene_format.h"

struct fxs_scene_file {
    fxs_scene_source source;
    const fxs_scene_format *format;
    void *reader;   /* the format's own, or NULL */
    fxs_import import;
};

/* The first name in a JSON object, or NULL. */
static const char *first_name(const char *head)
{
    static const char blanks[] = " \t\r\n";
    head += strspn(head, blanks);
    if (*head != '{')
        return NULL;
    head += 1 + strspn(head + 1, blanks);
    return *head == '"' ? head + 1 : NULL;
}

/* Whether a JSON object with that first name is a glTF. The index of a .sog has "asset" of these, but also what is
   looked for. */
static int is_gltf(const char *name)
{
    static const char *const names[] = {
        "accessors\"", "animations\"", "asset\"", "buffers\"", "bufferViews\"", "cameras\"", "extensions", "extras\"",
        "images\"", "materials\"", "meshes\"", "nodes\"", "samplers\"", "scene\"", "scenes\"", "skins\"", "textures\""
    };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strncmp(name, names[i], strlen(names[i])) == 0)
            return !strstr(name, "\"means\"") && !strstr(name, "\"lodLevels\"");
    return 0;
}

/* Whether a JSON object is a tileset, each tile of which has an error. That of a glTF may begin as it does. */
static int is_tileset(const char *head, const char *name)
{
    return strstr(head, "\"geometricError\"") || strncmp(name, "root\"", 5) == 0;
}

/* .splat has no magic number, so it comes last. */
static const fxs_scene_format *format_of(const fxs_scene_source *source, const char *head, size_t size)
{
    const char *name = first_name(head);
    if (size >= 4 && head[0] == 0 && head[1] != 0 && head[2] == 0 && head[3] == 0)
        return &fxs_scene_ksplat;
    if (memcmp(head, "NGSP", 4) == 0 || memcmp(head, "\x1f\x8b", 2) == 0)
        return &fxs_scene_spz;
    if (name && is_tileset(head, name))
        return &fxs_scene_tileset;
    if (memcmp(head, "glTF", 4) == 0 || (name && is_gltf(name)))
        return &fxs_scene_gltf;
    if (name && strstr(head, "\"totalLevel\""))
        return &fxs_scene_lcc;
    if (memcmp(head, "PK\3\4", 4) == 0 || name)
        return &fxs_scene_sog;
    return fxs_is_splat(source) ? &fxs_scene_splat : NULL;
}

int fxs_scene_format_of(const fxs_scene_source *source, const fxs_scene_format **format, fxs_message *message)
{
    char head[4096] = "";
    const size_t size = source->input.size < sizeof head - 1 ? (size_t)source->input.size : sizeof head - 1;
    FXS_TRY(fxs_scene_source_read(source, 0, head, size, message));
    if (size >= 3 && memcmp(head, "ply", 3) == 0) {
        const int is_compressed = fxs_is_compressed_ply(source, message);
        *format = is_compressed ? &fxs_scene_compressed_ply : &fxs_scene_ply;
        return is_compressed < 0 ? is_compressed : 0;
    }
    *format = format_of(source, head, size);
    return *format ? 0 : fxs_fail(message, "%s: not a scene file of a known format (.ply, .spz, .glb, .gltf, .sog, "
                                  ".ksplat, .lcc, tileset.json; or .splat: whole records of 32 bytes, finite positions "
                                  "and scales)", source->path);
}

/* The path, or of a folder that of the index in it, for fxs_release; NULL when out of memory. */
static char *path_of_file(const char *path, const fxs_allocator *allocator)
{
    static const char *const names[] = {"lod-meta.json", "tileset.json", "meta.json"};
    struct stat status;
    size_t room = strlen(path) + sizeof "/lod-meta.json";
    char *found = fxs_allocate(allocator, room, 1);
    if (!found)
        return NULL;
    snprintf(found, room, "%s", path);
    int is_found = stat(path, &status) != 0 || !S_ISDIR(status.st_mode);
    for (int i = 0; i < 3 && !is_found; i++) {
        snprintf(found, room, "%s/%s", path, names[i]);
        is_found = stat(found, &status) == 0;
    }
    return found;
}

static int open_path(fxs_scene_source *source, const char *path, fxs_message *message)
{
    char *found = path_of_file(path, source->options.allocator);
    if (!found)
        return fxs_fail_memory(message, path, 0);
    int result = fxs_scene_source_open(source, found, message);
    fxs_release(source->options.allocator, found);
    return result;
}

static int open_reader(fxs_scene_file *file, fxs_scene_file_info *info, fxs_message *message)
{
    const fxs_scene_source *source = &file->source;
    const int level = source->options.level;
    FXS_TRY(fxs_import_count(source, message));
    if (!file->format)
        FXS_TRY(fxs_scene_format_of(source, &file->format, message));
    file->reader = fxs_allocate_zeroed(source->options.allocator, 1, file->format->reader_size);
    if (!file->reader)
        return fxs_fail_memory(message, source->path, file->format->reader_size);
    info->format = file->format->name;
    info->levels = 1;
    info->stored_sh_degree = 0;
    info->colour = info->sh = (fxs_grid){0, 0};
    FXS_TRY(file->format->open(file->reader, source, info, message));
    if (info->stored_sh_degree < info->sh_degree)
        info->stored_sh_degree = info->sh_degree;
    if (level < 0 || level >= info->levels)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: no level %d: levels of detail in this scene: %d",
                           source->path, level, info->levels);
    return fxs_limit_gaussians(source, info->count, message);
}

/* Opens the input, or where that is null the file at a path. `format` may be null: told by the content. */
static int open_any(const char *path, const fxs_scene_input *input, const fxs_scene_format *format,
                    const fxs_scene_file_options *options, fxs_scene_file **file, fxs_scene_file_info *info,
                    fxs_message *message)
{
    fxs_scene_file *f = *file = fxs_allocate_zeroed(options ? options->allocator : NULL, 1, sizeof *f);
    if (!f) {
        if (input && input->close)
            input->close(input->argument);
        return fxs_fail_memory(message, path, sizeof *f);
    }
    if (options)
        f->source.options = *options;
    f->source.import = &f->import;
    f->format = format;
    int result = input ? fxs_scene_source_open_input(&f->source, path, input, message)
                 : open_path(&f->source, path, message);
    if (result == 0)
        result = open_reader(f, info, message);
    if (result) {
        fxs_scene_file_close(f);
        *file = NULL;
    }
    return result;
}

int fxs_scene_file_open(const char *path, const fxs_scene_file_options *options, fxs_scene_file **file,
                        fxs_scene_file_info *info, fxs_message *message)
{
    return open_any(path, NULL, NULL, options, file, info, message);
}

int fxs_scene_file_open_memory(const char *name, const void *data, size_t size, const fxs_scene_file_options *options,
                               fxs_scene_file **file, fxs_scene_file_info *info, fxs_message *message)
{
    const fxs_scene_input input = fxs_memory_input(data, size);
    return open_any(name, &input, NULL, options, file, info, message);
}

int fxs_scene_file_open_input(const char *name, const fxs_scene_input *input, const fxs_scene_file_options *options,
                              fxs_scene_file **file, fxs_scene_file_info *info, fxs_message *message)
{
    return open_any(name, input, NULL, options, file, info, message);
}

int fxs_scene_file_open_gaussians(const char *name, const fxs_gaussian_source *gaussians,
                                  const fxs_scene_file_options *options, fxs_scene_file **file,
                                  fxs_scene_file_info *info, fxs_message *message)
{
    const fxs_scene_input input = {.argument = (void *)gaussians};
    fxs_scene_file_options own = {.max_gaussians = 0};
    if (options)
        own = *options;
    if (own.max_gaussians == 0)
        own.max_gaussians = FXS_MAX_COUNT;
    return open_any(name, &input, &fxs_scene_gaussians, &own, file, info, message);
}

long fxs_scene_file_read(fxs_scene_file *file, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    return file->format->read(file->reader, gaussians, capacity, message);
}

int fxs_scene_file_rewind(fxs_scene_file *file, fxs_message *message)
{
    return file->format->rewind(file->reader, message);
}

const fxs_allocator *fxs_scene_file_allocator(const fxs_scene_file *file)
{
    return file->source.options.allocator;
}

void fxs_scene_file_swap(fxs_scene_file *file, const fxs_scene_format **format, void **reader)
{
    const fxs_scene_format *old_format = file->format;
    void *old_reader = file->reader;
    file->format = *format;
    file->reader = *reader;
    *format = old_format;
    *reader = old_reader;
}

void fxs_scene_file_close(fxs_scene_file *file)
{
    if (!file)
        return;
    const fxs_allocator *allocator = file->source.options.allocator;
    if (file->reader && file->format->close)
        file->format->close(file->reader);
    fxs_release(allocator, file->reader);
    fxs_release(allocator, file->import.files);
    fxs_scene_source_close(&file->source);
    fxs_release(allocator, file);
}
