#include <fixsplat/scene.h>
#include <fixsplat/internal/allocator.h>

#include "source_internal.h"
#include "report.h"

#include <inttypes.h>
#include <string.h>

#include "files_internal.h"
#include "opened.h"

static int read_file(void *argument, uint64_t offset, void *out, size_t size)
{
    return fxs_file_read_at(argument, offset, out, size);
}

static void close_file(void *argument)
{
    fclose(argument);
}

/* Opens the file of a source. first: a file whose folder must contain the opened file; null: any folder is allowed. */
static int open_file(fxs_scene_source *source, const char *first, fxs_message *message)
{
    fxs_file_facts facts;
    FILE *file;
    FXS_TRY(first ? fxs_file_open_within(first, source->path, &file, &facts, message)
                  : fxs_file_open(source->path, &file, &facts, message));
    setvbuf(file, NULL, _IONBF, 0);
    source->input = (fxs_scene_input){facts.size, read_file, NULL, close_file, file};
    source->device = facts.device;
    source->inode = facts.inode;
    fxs_note_opened(facts.device, facts.inode);
    return 0;
}

static int read_memory(void *argument, uint64_t offset, void *out, size_t size)
{
    memcpy(out, (const unsigned char *)argument + offset, size);
    return 0;
}

fxs_scene_input fxs_memory_input(const void *data, size_t size)
{
    return (fxs_scene_input){size, read_memory, NULL, NULL, (void *)data};
}

static int hex_digit(int c)
{
    static const char digits[] = "0123456789abcdef0123456789ABCDEF";
    const char *at = c ? strchr(digits, c) : NULL;
    return at ? (int)(at - digits) % 16 : -1;
}

static int take_letter(const char **text)
{
    const char *at = *text;
    const int high = *at == '%' ? hex_digit(at[1]) : -1, low = high < 0 ? -1 : hex_digit(at[2]);
    *text += low < 0 ? 1 : 3;
    return low < 0 ? (unsigned char)*at : high << 4 | low;
}

/* Returns 1 if a file name begins with a drive or a URL scheme, such as "C:" or "https:". */
static int begins_elsewhere(const char *name)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789+-.";
    const char *at = name;
    int letter = take_letter(&at);
    if (!letter || !memchr(letters, letter, 52))
        return 0;
    while (letter && memchr(letters, letter, sizeof letters - 1))
        letter = take_letter(&at);
    return letter == ':';
}

static int is_separator(int letter)
{
    return letter == '/' || letter == '\\';
}

int fxs_name_stays(const char *name)
{
    const char *at = name;
    size_t length = 0, dots = 0;
    int letter = take_letter(&at);
    if (is_separator(letter) || begins_elsewhere(name))
        return 0;
    for (at = name; *at && (letter = take_letter(&at)) >= ' ';) {
        const int is_end = is_separator(letter);
        if (is_end && length == 2 && dots == 2)
            return 0;
        dots = is_end ? 0 : dots + (letter == '.');
        length = is_end ? 0 : length + 1;
    }
    return letter >= ' ' && !(length == 2 && dots == 2);
}

int fxs_check_name(const fxs_scene_source *source, const char *name, fxs_message *message)
{
    if (name && fxs_name_stays(name))
        return 0;
    return fxs_fail(message, "%s: a file name that is missing, leaves the folder or has control characters",
                    source->path);
}

int fxs_compare_names(const char *a, const char *b)
{
    for (;;) {
        while (*a == '/' || (a[0] == '.' && a[1] == '/'))
            a++;
        while (*b == '/' || (b[0] == '.' && b[1] == '/'))
            b++;
        for (; *a && *a == *b && *a != '/'; a++)
            b++;
        if (*a != *b || !*a)
            return (unsigned char)*a - (unsigned char)*b;
    }
}

void fxs_decode_percent(char *text)
{
    const char *from = text;
    while (*from)
        *text++ = (char)take_letter(&from);
    *text = '\0';
}

static int set_path(fxs_scene_source *source, const char *path, size_t folder, const char *name, fxs_message *message)
{
    size_t length = strlen(name);
    source->path = fxs_allocate(source->options.allocator, folder + length + 1, 1);
    if (!source->path)
        return fxs_fail_memory(message, path, folder + length + 1);
    memcpy(source->path, path, folder);
    memcpy(source->path + folder, name, length + 1);
    return 0;
}

static uint64_t hash(uint64_t so_far, const void *bytes, size_t size)   /* computes an FNV-1a hash (Fowler, Noll, Vo) */
{
    for (const unsigned char *byte = bytes; size > 0; size--, byte++)
        so_far = (so_far ^ *byte) * 0x100000001b3u;
    return so_far;
}

static uint64_t key_of(const fxs_scene_source *source)
{
    const uint64_t number[2] = {source->device, source->inode}, none = 0xcbf29ce484222325u;
    const uint64_t key = source->inode ? hash(none, number, sizeof number)
                                       : hash(none, source->path, strlen(source->path));
    return key + !key;
}

static uint64_t *slot_of(uint64_t *files, size_t room, uint64_t key)
{
    size_t at = (size_t)key & (room - 1);
    while (files[at] && files[at] != key)
        at = (at + 1) & (room - 1);
    return &files[at];
}

static int grow(fxs_import *import, const fxs_allocator *allocator)
{
    const size_t room = import->room ? 2 * import->room : 64;
    uint64_t *files = fxs_allocate_zeroed(allocator, room, sizeof *files);
    for (size_t i = 0; files && i < import->room; i++)
        if (import->files[i])
            *slot_of(files, room, import->files[i]) = import->files[i];
    if (!files)
        return -1;
    fxs_release(allocator, import->files);
    import->files = files;
    import->room = room;
    return 0;
}

int fxs_import_count(const fxs_scene_source *source, fxs_message *message)
{
    fxs_import *import = source->import;
    const uint64_t key = key_of(source);
    if (import->room && *slot_of(import->files, import->room, key))
        return 0;
    if (2 * import->file_count >= import->room && grow(import, source->options.allocator))
        return fxs_fail_memory(message, source->path, 0);
    *slot_of(import->files, import->room, key) = key;
    import->file_count++;
    import->file_bytes += source->input.size;
    return 0;
}

static size_t folder_length(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash + 1 - path) : 0;
}

int fxs_scene_source_open(fxs_scene_source *source, const char *path, fxs_message *message)
{
    FXS_TRY(set_path(source, path, 0, path, message));
    return open_file(source, NULL, message);
}

int fxs_scene_source_open_input(fxs_scene_source *source, const char *name, const fxs_scene_input *input,
                                fxs_message *message)
{
    source->input = *input;
    return set_path(source, name, 0, name, message);
}

/* Replaces backslashes in a file name by slashes, unless a file has exactly this name. A program's callbacks never get
   a backslash, because names may become part of a URL. */
static int settle_name(fxs_scene_source *opened, const fxs_scene_source *source, const char *name,
                       fxs_message *message)
{
    char *own = opened->path + folder_length(source->path);
    if (!strchr(name, '\\') || (opened->first->input.read == read_file && fxs_file_is_named(opened->path)))
        return 0;
    for (char *c = own; (c = strchr(c, '\\'));)
        *c = '/';
    return fxs_check_name(source, own, message);
}

static int open_beside(fxs_scene_source *opened, const fxs_scene_source *source, const char *name,
                       fxs_message *message)
{
    const fxs_scene_source *first = opened->first;
    FXS_TRY(fxs_check_name(source, name, message));
    FXS_TRY(set_path(opened, source->path, folder_length(source->path), name, message));
    FXS_TRY(settle_name(opened, source, name, message));
    if (first->input.read == read_file)
        return open_file(opened, first->path, message);
    if (!first->input.beside)
        return fxs_fail(message, "%s: needs the file %s beside it, but was not opened from a folder", source->path,
                        name);
    if (!first->input.beside(first->input.argument, opened->path + folder_length(first->path), &opened->input))
        return 0;
    memset(&opened->input, 0, sizeof opened->input);
    return fxs_fail(message, "%s: cannot be opened", opened->path);
}

int fxs_scene_source_open_beside(fxs_scene_source *opened, const fxs_scene_source *source, const char *name,
                                 fxs_message *message)
{
    memset(opened, 0, sizeof *opened);
    opened->first = source->first ? source->first : source;
    opened->options = source->options;
    opened->import = source->import;
    FXS_TRY(open_beside(opened, source, name, message));
    return opened->import ? fxs_import_count(opened, message) : 0;
}

int fxs_scene_source_is_beside(const fxs_scene_source *source, const char *name, fxs_message *message)
{
    const fxs_scene_source *first = source->first ? source->first : source;
    fxs_scene_source beside = {.options = source->options};
    int is_there = 0;
    FXS_TRY(set_path(&beside, source->path, folder_length(source->path), name, message));
    if (first->input.read == read_file)
        is_there = fxs_file_is_named(beside.path);
    else if (first->input.beside)
        is_there = first->input.beside(first->input.argument, beside.path + folder_length(first->path),
                                       &beside.input) == 0;
    if (!is_there)
        memset(&beside.input, 0, sizeof beside.input);
    fxs_scene_source_close(&beside);
    return is_there;
}

void fxs_scene_source_shut(fxs_scene_source *source)
{
    if (source->input.close)
        source->input.close(source->input.argument);
    memset(&source->input, 0, sizeof source->input);
}

void fxs_scene_source_close(fxs_scene_source *source)
{
    fxs_scene_source_shut(source);
    fxs_release(source->options.allocator, source->path);
    memset(source, 0, sizeof *source);
}

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
    char *data = fxs_hold(source, size + 1, message);
    if (!data)
        return FXS_ERR_MEMORY;
    *text = (fxs_text){source->path, data, (size_t)size};
    data[size] = 0;
    const int result = fxs_scene_source_read(source, offset, data, (size_t)size, message);
    if (result)
        fxs_text_let_go(source, text);
    return result;
}

void fxs_text_let_go(const fxs_scene_source *source, fxs_text *text)
{
    fxs_let_go(source, text->data, (uint64_t)text->size + 1);
    text->data = NULL;
}

int fxs_scene_source_progress(const fxs_scene_source *source, double done, fxs_message *message)
{
    const fxs_scene_file_options *options = &source->options;
    if (!fxs_report(&options->progress, done))
        return 0;
    return fxs_fail_as(FXS_ERR_STOPPED, message, "%s: stopped", source->path);
}

static uint64_t most_gaussians(const fxs_scene_source *source)
{
    if (source->options.max_gaussians > 0)
        return source->options.max_gaussians;
    uint64_t most = FXS_GAUSSIANS_ALWAYS + source->import->file_bytes;
    return most < FXS_GAUSSIANS_CEILING ? most : FXS_GAUSSIANS_CEILING;
}

static uint64_t most_memory(const fxs_scene_source *source)
{
    if (source->options.max_memory > 0)
        return source->options.max_memory;
    uint64_t count = most_gaussians(source);
    count = count > FXS_GAUSSIANS_ALWAYS ? count : FXS_GAUSSIANS_ALWAYS;
    return count < UINT64_MAX / FXS_IMPORT_BYTES ? count * FXS_IMPORT_BYTES : UINT64_MAX;
}

int fxs_limit_gaussians(const fxs_scene_source *source, uint64_t count, fxs_message *message)
{
    if (!source->import || count <= most_gaussians(source))
        return 0;
    return fxs_fail(message, "%s: %" PRIu64 " Gaussians or more in %" PRIu64 " bytes of files, beyond the limit of %"
                    PRIu64 "; --max-gaussians raises it (a program: max_gaussians)", source->path, count,
                    source->import->file_bytes, most_gaussians(source));
}

int fxs_limit_memory(const fxs_scene_source *source, uint64_t bytes, fxs_message *message)
{
    const fxs_import *import = source->import;
    if (!import)
        return 0;
    const uint64_t most = most_memory(source);
    while (bytes > most || import->held > most - bytes)
        if (bytes > most || !import->drop || !import->drop(import->reader)) {
            const uint64_t needed = bytes > UINT64_MAX - import->held ? bytes : import->held + bytes;
            fxs_fail(message, "%s: reading it takes %" PRIu64 " bytes of memory or more, beyond the limit of %" PRIu64
                     "; --import-memory raises it (a program: max_memory)", source->path, needed, most);
            message->bytes_needed = needed;
            return FXS_ERR_MEMORY;
        }
    return 0;
}

void *fxs_hold(const fxs_scene_source *source, uint64_t bytes, fxs_message *message)
{
    if (fxs_limit_memory(source, bytes, message))
        return NULL;
    void *block = bytes <= SIZE_MAX ? fxs_allocate(source->options.allocator, (size_t)bytes, 1) : NULL;
    if (!block)
        fxs_fail_memory(message, source->path, bytes);
    else if (source->import)
        source->import->held += bytes;
    return block;
}

void fxs_let_go(const fxs_scene_source *source, void *block, uint64_t bytes)
{
    if (block && source->import)
        source->import->held -= bytes;
    fxs_release(source->options.allocator, block);
}
