#include "scene_file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "scene_format.h"

struct fxs_scene_file {
    fxs_scene_source source;
    const fxs_scene_format *format;
    void *reader;   /* the format's own */
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

/* .splat has no magic number, so it comes last. */
static const fxs_scene_format *format_of(const fxs_scene_source *source, const char *head, size_t size)
{
    const char *name = first_name(head);
    if (size >= 3 && memcmp(head, "ply", 3) == 0)
        return fxs_is_compressed_ply(source) ? &fxs_scene_compressed_ply : &fxs_scene_ply;
    if (size >= 4 && head[0] == 0 && head[1] != 0 && head[2] == 0 && head[3] == 0)
        return &fxs_scene_ksplat;
    if (memcmp(head, "NGSP", 4) == 0 || memcmp(head, "\x1f\x8b", 2) == 0)
        return &fxs_scene_spz;
    if (memcmp(head, "glTF", 4) == 0 || (name && is_gltf(name)))
        return &fxs_scene_gltf;
    if (memcmp(head, "PK\3\4", 4) == 0 || name)
        return &fxs_scene_sog;
    return fxs_is_splat(source) ? &fxs_scene_splat : NULL;
}

/* The path, or of a folder that of the index in it, for free; NULL when out of memory. */
static char *path_of_file(const char *path)
{
    struct stat status;
    size_t room = strlen(path) + sizeof "/lod-meta.json";
    char *found = malloc(room);
    if (!found)
        return NULL;
    snprintf(found, room, "%s", path);
    if (stat(path, &status) == 0 && S_ISDIR(status.st_mode)) {
        snprintf(found, room, "%s/lod-meta.json", path);
        if (stat(found, &status) != 0)
            snprintf(found, room, "%s/meta.json", path);
    }
    return found;
}

int fxs_scene_source_open(fxs_scene_source *source, const char *path, fxs_message *message)
{
    struct stat status;
    source->path = strdup(path);
    if (!source->path)
        return fxs_fail(message, "%s: out of memory", path);
    if (stat(path, &status) != 0)
        return fxs_fail(message, "%s: %s", path, strerror(errno));
    if (!S_ISREG(status.st_mode))   /* before fopen, which waits for the writer of a pipe */
        return fxs_fail(message, "%s: not a regular file", path);
    source->stream = fopen(path, "rb");
    if (!source->stream)
        return fxs_fail(message, "%s: %s", path, strerror(errno));
    source->size = (uint64_t)status.st_size;
    setvbuf(source->stream, NULL, _IONBF, 0);
    return 0;
}

int fxs_scene_source_read(const fxs_scene_source *source, uint64_t offset, void *out, size_t size,
                          fxs_message *message)
{
    if (fseeko(source->stream, (off_t)offset, SEEK_SET) == 0 && fread(out, 1, size, source->stream) == size)
        return 0;
    return fxs_fail(message, "%s: %s", source->path, feof(source->stream) ? "the file ends early" : "read error");
}

void fxs_scene_source_close(fxs_scene_source *source)
{
    if (source->stream)
        fclose(source->stream);
    free(source->path);
}

static int open_file(fxs_scene_file *file, const char *path, fxs_scene_file_info *info, fxs_message *message)
{
    char head[4096] = "", *found = path_of_file(path);
    int opened = found ? fxs_scene_source_open(&file->source, found, message)
                 : fxs_fail(message, "%s: out of memory", path);
    free(found);
    if (opened != 0)
        return -1;
    size_t size = fread(head, 1, sizeof head - 1, file->source.stream);
    if (ferror(file->source.stream))
        return fxs_fail(message, "%s: %s", path, strerror(errno));
    file->format = format_of(&file->source, head, size);
    if (!file->format)
        return fxs_fail(message, "%s: not a scene file of a known format (.ply, .spz, .glb, .gltf, .sog, .ksplat; or "
                        ".splat: whole records of 32 bytes, finite positions, scales of 0 or more)", path);
    if (fseeko(file->source.stream, 0, SEEK_SET) != 0)
        return fxs_fail(message, "%s: %s", path, strerror(errno));
    info->format = file->format->name;
    info->levels = 1;
    if (file->format->open(&file->source, &file->reader, info, message) != 0)
        return -1;
    if (file->source.level < 0 || file->source.level >= info->levels)
        return fxs_fail(message, "%s: no level %d: levels of detail in this scene: %d", path, file->source.level,
                        info->levels);
    return 0;
}

int fxs_scene_file_open_lod(const char *path, int level, fxs_scene_file **file, fxs_scene_file_info *info,
                            fxs_message *message)
{
    *file = calloc(1, sizeof **file);
    if (!*file)
        return fxs_fail(message, "%s: out of memory", path);
    (*file)->source.level = level;
    if (open_file(*file, path, info, message) == 0)
        return 0;
    fxs_scene_file_close(*file);
    *file = NULL;
    return -1;
}

int fxs_scene_file_open(const char *path, fxs_scene_file **file, fxs_scene_file_info *info, fxs_message *message)
{
    return fxs_scene_file_open_lod(path, 0, file, info, message);
}

long fxs_scene_file_read(fxs_scene_file *file, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    return file->format->read(file->reader, gaussians, capacity, message);
}

int fxs_scene_file_rewind(fxs_scene_file *file, fxs_message *message)
{
    return file->format->rewind(file->reader, message);
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
    if (file->reader)
        file->format->close(file->reader);
    fxs_scene_source_close(&file->source);
    free(file);
}
