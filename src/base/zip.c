#include <fixsplat/internal/allocator.h>

#include "zip_internal.h"

#ifdef FXS_WITH_ZIP

#include <errno.h>
#include <string.h>

#include <zip.h>

#include "fail_list.h"

enum { MAX_INFLATION = 1032 };   /* most output bytes that deflate makes from an input byte */

struct fxs_zip {
    const fxs_scene_source *source;
    uint64_t offset;
    zip_error_t error;
    zip_t *archive;
    char *folder;              /* folder in the archive that names are relative to; null: none */
};

static zip_int64_t read_source(fxs_zip *zip, void *out, zip_uint64_t size)
{
    fxs_message ignored;
    uint64_t left = zip->source->input.size - zip->offset;
    size = size < left ? size : left;
    if (fxs_scene_source_read(zip->source, zip->offset, out, (size_t)size, &ignored)) {
        zip_error_set(&zip->error, ZIP_ER_READ, 0);
        return -1;
    }
    zip->offset += size;
    return (zip_int64_t)size;
}

static zip_int64_t seek_source(fxs_zip *zip, void *data, zip_uint64_t size)
{
    zip_int64_t offset = zip_source_seek_compute_offset(zip->offset, zip->source->input.size, data, size, &zip->error);
    if (offset >= 0)
        zip->offset = (uint64_t)offset;
    return offset < 0 ? -1 : 0;
}

static zip_int64_t stat_source(const fxs_zip *zip, void *data)
{
    zip_stat_t *stat = data;
    zip_stat_init(stat);
    stat->valid = ZIP_STAT_SIZE;
    stat->size = zip->source->input.size;
    return sizeof *stat;
}

static zip_int64_t call_source(void *argument, void *data, zip_uint64_t size, zip_source_cmd_t command)
{
    fxs_zip *zip = argument;
    switch (command) {
    case ZIP_SOURCE_OPEN:     zip->offset = 0; return 0;
    case ZIP_SOURCE_READ:     return read_source(zip, data, size);
    case ZIP_SOURCE_SEEK:     return seek_source(zip, data, size);
    case ZIP_SOURCE_TELL:     return (zip_int64_t)zip->offset;
    case ZIP_SOURCE_STAT:     return stat_source(zip, data);
    case ZIP_SOURCE_ERROR:    return zip_error_to_data(&zip->error, data, size);
    case ZIP_SOURCE_SUPPORTS: return ZIP_SOURCE_SUPPORTS_SEEKABLE;
    case ZIP_SOURCE_CLOSE:
    case ZIP_SOURCE_FREE:     return 0;
    default:
        zip_error_set(&zip->error, ZIP_ER_OPNOTSUPP, 0);
        return -1;
    }
}

static int open_archive(fxs_zip *zip, zip_error_t *error, fxs_message *message)
{
    errno = 0;
    zip_source_t *source = zip_source_function_create(call_source, zip, error);
    zip->archive = source ? zip_open_from_source(source, ZIP_RDONLY, error) : NULL;
    if (source && !zip->archive)
        zip_source_free(source);
    if (zip->archive)
        return 0;
    return fxs_fail_library(message, zip->source->path, "%s: cannot be read as a zip: %s", zip->source->path,
                            zip_error_strerror(error));
}

int fxs_zip_open(const fxs_scene_source *source, fxs_zip **opened, fxs_message *message)
{
    zip_error_t error;
    fxs_zip *zip = *opened = fxs_allocate_zeroed(source->options.allocator, 1, sizeof *zip);
    if (!zip)
        return fxs_fail_memory(message, source->path, sizeof *zip);
    zip->source = source;
    zip_error_init(&zip->error);
    zip_error_init(&error);
    const int result = open_archive(zip, &error, message);
    if (result) {
        fxs_zip_close(zip);
        *opened = NULL;
    }
    zip_error_fini(&error);
    return result;
}

static int check_entry(const fxs_zip *zip, const char *name, const zip_stat_t *entry, fxs_message *message)
{
    const zip_uint64_t needed = ZIP_STAT_SIZE | ZIP_STAT_COMP_METHOD;
    const char *path = zip->source->path;
    if ((entry->valid & needed) != needed ||
        (entry->comp_method != ZIP_CM_STORE && entry->comp_method != ZIP_CM_DEFLATE))
        return fxs_fail(message, "%s: %s: packed in an unknown way", path, name);
    if (entry->size > FXS_TEXT_MAX || entry->size / MAX_INFLATION > zip->source->input.size)
        return fxs_fail(message, "%s: %s claims %llu bytes, more than this file can hold", path, name,
                        (unsigned long long)entry->size);
    return 0;
}

static size_t folder_before(const char *entry, const char *name)
{
    const size_t length = strlen(entry), size = strlen(name);
    const size_t folder = length > size ? length - size : 0;
    return folder && strchr("/\\", entry[folder - 1]) && !strcmp(entry + folder, name) ? folder : 0;
}

int fxs_zip_enter(fxs_zip *zip, const char *name, fxs_message *message)
{
    const char *first = NULL;
    size_t shortest = 0;
    for (zip_int64_t i = zip_get_num_entries(zip->archive, 0); i-- > 0;) {
        const char *entry = zip_get_name(zip->archive, (zip_uint64_t)i, 0);
        const size_t folder = entry ? folder_before(entry, name) : 0;
        if (entry && !strcmp(entry, name))
            return 0;
        if (folder && (!shortest || folder <= shortest)) {
            first = entry;
            shortest = folder;
        }
    }
    if (!first)
        return 0;
    zip->folder = fxs_allocate_zeroed(zip->source->options.allocator, shortest + 1, 1);
    if (!zip->folder)
        return fxs_fail_memory(message, zip->source->path, shortest + 1);
    memcpy(zip->folder, first, shortest);
    return 0;
}

static int find_entry(const fxs_zip *zip, const char *name, zip_stat_t *entry)
{
    const size_t folder = zip->folder ? strlen(zip->folder) : 0;
    if (!folder)
        return zip_stat(zip->archive, name, 0, entry);
    for (zip_int64_t i = zip_get_num_entries(zip->archive, 0); i-- > 0;) {
        const char *own = zip_get_name(zip->archive, (zip_uint64_t)i, 0);
        if (own && !strncmp(own, zip->folder, folder) && !strcmp(own + folder, name))
            return zip_stat_index(zip->archive, (zip_uint64_t)i, 0, entry);
    }
    return -1;
}

/* Reads a whole zip entry. Reading one byte more than the entry has makes libzip verify the checksum. */
static int read_entry(zip_file_t *file, char *data, size_t size)
{
    return zip_fread(file, data, size) == (zip_int64_t)size && zip_fread(file, data + size, 1) == 0;
}

int fxs_zip_load(fxs_zip *zip, const char *name, fxs_text *text, fxs_message *message)
{
    const char *path = zip->source->path;
    zip_stat_t entry;
    if (find_entry(zip, name, &entry) != 0)
        return fxs_fail(message, "%s: a .zip archive without %s, so no .sog; if a scene is in it, unpack it", path,
                        name);
    FXS_TRY(check_entry(zip, name, &entry, message));
    char *data = fxs_hold(zip->source, entry.size + 1, message);
    if (!data)
        return FXS_ERR_MEMORY;
    *text = (fxs_text){path, data, (size_t)entry.size};
    data[entry.size] = 0;
    errno = 0;
    zip_file_t *file = zip_fopen_index(zip->archive, entry.index, 0);
    int whole = file && read_entry(file, data, (size_t)entry.size) == 1;
    const int error = whole ? 0 : fxs_fail_library(message, path, "%s: %s: damaged", path, name);
    if (file)
        zip_fclose(file);
    if (error)
        fxs_text_let_go(zip->source, text);
    return error;
}

void fxs_zip_close(fxs_zip *zip)
{
    if (!zip)
        return;
    if (zip->archive)
        zip_discard(zip->archive);
    zip_error_fini(&zip->error);
    fxs_release(zip->source->options.allocator, zip->folder);
    fxs_release(zip->source->options.allocator, zip);
}

#else

int fxs_zip_open(const fxs_scene_source *source, fxs_zip **opened, fxs_message *message)
{
    *opened = NULL;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: cannot read a zip: built without libzip", source->path);
}

int fxs_zip_enter(fxs_zip *zip, const char *name, fxs_message *message)
{
    (void)zip;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: built without libzip", name);
}

int fxs_zip_load(fxs_zip *zip, const char *name, fxs_text *text, fxs_message *message)
{
    (void)zip, (void)text;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: built without libzip", name);
}

void fxs_zip_close(fxs_zip *zip)
{
    (void)zip;
}

#endif
