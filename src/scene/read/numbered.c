/* Reads numbered files, each a frame of a moving scene: prefix, number, ending. They are in a folder, or a path with a
 * * stands for them. The frames are read once, when the scene is opened. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>

#include "src/base/files_internal.h"
#include "src/base/foreign.h"
#include "src/base/os_calls.h"
#include "src/scene/formats_internal.h"
#include "src/scene/sequence.h"

enum { BATCH = 4096, RATE = 30, NAME_MOST = 1024, FRAMES_MOST = 1000000 };

/* The names of the files, split: the folder with its last /, the prefix, the numbers, the ending. */
typedef struct names {
    char folder[NAME_MOST], prefix[NAME_MOST], ending[NAME_MOST];
    int given;                     /* 1: prefix and ending are those of a path with a * */
    char (*numbers)[16];
    uint32_t count, room;
    int several, failed;           /* 1: files of another prefix or ending are there too; memory ran out */
    int network;                   /* 1: the weights of a network that deforms a scene are there too */
} names;

typedef struct numbered_reader {
    fxs_sequence *sequence;
    uint64_t next, count, held;
    const fxs_scene_source *source;
    fxs_motion motions[BATCH];
} numbered_reader;

/* Splits a file name before its ending of letters and dots, at its last digits. Returns 0 if it has none. */
static int split(const char *name, size_t *digits, size_t *ending)
{
    const fxs_scene_format *format = fxs_scene_format_of(name, 0);
    const size_t length = strlen(name);
    size_t end = length;
    while (end > 0 && name[end - 1] != '.')
        end--;
    if (!format || end < 2)
        return 0;
    if (end > 11 && !strcmp(name + end - 11, "compressed.ply"))
        end -= 11;
    *ending = --end;
    while (end > 0 && name[end - 1] >= '0' && name[end - 1] <= '9')
        end--;
    *digits = end;
    return *ending > end && *ending - end < 10;
}

static void take_name(void *argument, const char *name)
{
    names *n = argument;
    size_t digits, ending;
    n->network |= !strcmp(name, "deformation.pth") || !strcmp(name, "deform.pth");    /* 4DGaussians, Deformable3DGS */
    if (!split(name, &digits, &ending) || strlen(name) >= NAME_MOST || n->failed)
        return;
    if (!n->given && !n->count) {
        snprintf(n->prefix, sizeof n->prefix, "%.*s", (int)digits, name);
        snprintf(n->ending, sizeof n->ending, "%s", name + ending);
    }
    if (strlen(n->prefix) != digits || strncmp(n->prefix, name, digits) || strcmp(n->ending, name + ending)) {
        n->several = 1;
        return;
    }
    if (n->count == n->room) {
        const uint32_t room = n->room ? 2 * n->room : 256;
        char (*more)[16] = room > FRAMES_MOST * 2 ? 0 : realloc(n->numbers, room * sizeof *more);
        n->failed = !more;
        if (!more)
            return;
        n->numbers = more;
        n->room = room;
    }
    snprintf(n->numbers[n->count++], sizeof *n->numbers, "%.*s", (int)(ending - digits), name + digits);
}

static int by_number(const void *a, const void *b)
{
    const long x = atol(a), y = atol(b);
    return x < y ? -1 : x > y;
}

/* Lists the files of a folder or of a path with a *, sorted by number. */
static int list_files(names *n, const char *path, fxs_message *message)
{
    const char *star = strchr(path, '*'), *slash = strrchr(path, '/');
    const size_t folder = star ? (slash ? (size_t)(slash - path) + 1 : 0) : strlen(path);
    if (strlen(path) >= NAME_MOST - 2)
        return fxs_fail(message, "%s: the name is too long", path);
    snprintf(n->folder, sizeof n->folder, "%.*s%s", (int)folder, path, star || path[folder - 1] == '/' ? "" : "/");
    if (star) {
        n->given = 1;
        snprintf(n->prefix, sizeof n->prefix, "%.*s", (int)((size_t)(star - path) - folder), path + folder);
        snprintf(n->ending, sizeof n->ending, "%s", star + 1);
    }
    if (fxs_folder_each(*n->folder ? n->folder : ".", take_name, n))
        return fxs_fail(message, "%s: the folder cannot be read", path);
    if (n->failed)
        return fxs_fail_memory(message, path, 0);
    if (!n->count && n->network)
        return fxs_fail(message, "%s: a scene that a network deforms (deformation.pth or deform.pth): " FXS_NETWORK,
                        path);
    if (!n->count)
        return fxs_fail(message, n->given ? "%s: no numbered scene files of this name"
                                          : "%s: not a regular file, but a folder without an index or numbered scene "
                                            "files, such as frame0001.ply", path);
    if (n->several && !n->given)
        return fxs_fail(message, "%s: numbered scene files of several names or endings; choose some, as '%s%s*%s'",
                        path, n->folder, n->prefix, n->ending);
    qsort(n->numbers, n->count, sizeof *n->numbers, by_number);
    for (uint32_t i = 1; i < n->count; i++) {
        const long before = atol(n->numbers[i - 1]), now = atol(n->numbers[i]);
        if (now == before)
            return fxs_fail(message, "%s: two frames have the number %ld: %s%s%s and %s%s%s", path, now, n->prefix,
                            n->numbers[i - 1], n->ending, n->prefix, n->numbers[i], n->ending);
        if (now != before + 1)
            return fxs_fail(message, "%s: no frame %ld between %s%s%s and %s%s%s", path, before + 1, n->prefix,
                            n->numbers[i - 1], n->ending, n->prefix, n->numbers[i], n->ending);
    }
    return 0;
}

static void path_of(const names *n, uint32_t i, char *path, size_t size)
{
    snprintf(path, size, "%s%s%s%s", n->folder, n->prefix, n->numbers[i], n->ending);
}

static int open_frame(const numbered_reader *r, const names *n, uint32_t i, fxs_scene_file **file,
                      fxs_scene_file_info *info, fxs_message *message)
{
    char path[3 * NAME_MOST];
    fxs_scene_file_options options = r->source->options;
    path_of(n, i, path, sizeof path);
    options.progress = (fxs_progress){NULL, NULL};
    options.rate = 0;
    if (fxs_file_kind(path) == FXS_FILE_FOLDER)
        return fxs_fail(message, "%s: a folder, not a frame", path);
    FXS_TRY(fxs_scene_file_open(path, &options, file, info, message));
    if (info->time.duration > 0) {
        fxs_scene_file_close(*file);
        return fxs_fail(message, "%s: a frame that moves itself", path);
    }
    return 0;
}

/* Reads a frame into the sequence. */
static int take_frame(numbered_reader *r, const names *n, uint32_t i, const fxs_scene_file_info *first,
                      fxs_message *message)
{
    fxs_gaussian batch[64];
    fxs_scene_file *file;
    fxs_scene_file_info info;
    long count;
    FXS_TRY(open_frame(r, n, i, &file, &info, message));
    int error = info.antialiased == first->antialiased ? 0
                : fxs_fail(message, "%s%s%s: anti-aliased, or not, unlike the first frame", n->prefix, n->numbers[i],
                           n->ending);
    while (!error && (count = fxs_scene_file_read(file, batch, 64, message)) != 0) {
        error = count < 0 ? (int)count : 0;
        for (long k = 0; k < count && !error; k++) {
            for (int axis = 0; axis < 3; axis++)
                batch[k].position[axis] += (float)(info.origin[axis] - first->origin[axis]);
            error = fxs_sequence_put(r->sequence, &batch[k]) ? fxs_fail_memory(message, r->source->path, 0) : 0;
        }
    }
    r->source->import->file_bytes += file->import.file_bytes;
    fxs_scene_file_close(file);
    if (!error && fxs_sequence_next(r->sequence))
        error = fxs_fail_memory(message, r->source->path, fxs_sequence_bytes(r->sequence));
    return error;
}

static int read_frames(numbered_reader *r, const names *n, fxs_scene_file_info *info, fxs_message *message)
{
    const fxs_scene_source *source = r->source;
    fxs_scene_file *file;
    fxs_scene_file_info first;
    FXS_TRY(open_frame(r, n, 0, &file, &first, message));
    fxs_scene_file_close(file);
    const double rate = source->options.rate > 0 ? source->options.rate : RATE;
    r->sequence = fxs_sequence_create(n->count, rate, first.sh_degree, source->options.allocator);
    if (!r->sequence)
        return fxs_fail_memory(message, source->path, 0);
    for (uint32_t i = 0; i < n->count; i++) {
        FXS_TRY(take_frame(r, n, i, &first, message));
        FXS_TRY(fxs_scene_source_progress(source, (i + 1.0) / n->count, message));
        FXS_TRY(fxs_limit_memory(source, fxs_sequence_bytes(r->sequence), message));
    }
    if (fxs_sequence_finish(r->sequence, &info->time))
        return fxs_fail_memory(message, source->path, fxs_sequence_bytes(r->sequence));
    r->count = info->count = fxs_sequence_count(r->sequence);
    info->sh_degree = first.sh_degree;
    info->antialiased = first.antialiased;
    info->colour = first.colour;
    info->sh = first.sh;
    memcpy(source->import->origin, first.origin, sizeof first.origin);
    return 0;
}

static int numbered_open(void *handle, const fxs_scene_source *source, fxs_scene_file_info *info, fxs_message *message)
{
    numbered_reader *r = handle;
    names n;
    memset(&n, 0, sizeof n);
    r->source = source;
    int error = list_files(&n, source->path, message);
    error = error ? error : read_frames(r, &n, info, message);
    free(n.numbers);
    return error;
}

static long numbered_read(void *handle, fxs_gaussian *gaussians, size_t capacity, fxs_message *message)
{
    numbered_reader *r = handle;
    const uint64_t left = r->count - r->next;
    size_t count = capacity < BATCH ? capacity : BATCH;
    count = count < left ? count : (size_t)left;
    (void)message;
    fxs_sequence_get(r->sequence, r->next, count, gaussians, r->motions);
    r->next += count;
    return (long)count;
}

static int numbered_rewind(void *handle, fxs_message *message)
{
    (void)message;
    ((numbered_reader *)handle)->next = 0;
    return 0;
}

static void numbered_close(void *handle)
{
    fxs_sequence_free(((numbered_reader *)handle)->sequence);
}

static const fxs_motion *numbered_motions(const void *handle)
{
    return ((const numbered_reader *)handle)->motions;
}

const fxs_reader fxs_read_numbered = {
    NULL, sizeof(numbered_reader), numbered_open, numbered_read, numbered_rewind, numbered_close, numbered_motions
};
