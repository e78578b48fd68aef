/* Opens scenes for rendering. A file in the packed format .fxs is mapped into memory or read in part. Scenes in all
 * other formats are converted to that format in memory. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/renderer.h>
#include <fixsplat/scene.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>
#include <fixsplat/internal/packed.h>
#include <fixsplat/internal/pager_more.h>
#include <fixsplat/internal/parts.h>
#include <fixsplat/internal/start.h>

#include "src/base/files_internal.h"
#include "src/base/options.h"
#include "src/base/try_internal.h"

typedef struct open_scene {
    fxs_opened shown;
    fxs_scene scene;
    fxs_scene_file_info info;
    fxs_pack_report report;
    fxs_packed_scene packed;
    fxs_mapping mapping;
    char name[];
} open_scene;

static int is_fxs(const void *bytes)
{
    uint32_t magic;
    memcpy(&magic, bytes, sizeof magic);
    return fxs_little_32(magic) == FXS_PACKED_MAGIC;
}

static int is_fxs_file(const char *path, fxs_message *message)
{
    unsigned char bytes[4] = {0};
    FILE *file;
    if (fxs_file_kind(path) != FXS_FILE_REGULAR)
        return 0;
    FXS_TRY(fxs_file_open(path, &file, NULL, message));
    const int is = fread(bytes, 1, sizeof bytes, file) == sizeof bytes && is_fxs(bytes);
    fclose(file);
    return is;
}

static int create(const char *name, open_scene **made, fxs_opened **opened, fxs_message *message)
{
    if (!name || !opened)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "no %s to open a scene", name ? "place" : "name");
    const size_t length = strlen(name) + 1;
    open_scene *s = calloc(1, sizeof *s + length);
    if (!s)
        return fxs_fail_memory(message, name, sizeof *s + length);
    memcpy(s->name, name, length);
    *made = s;
    return 0;
}

static int finish(open_scene *s, int error, const void *data, size_t bytes, fxs_opened **opened, fxs_message *message)
{
    if (!error && (error = fxs_scene_open(&s->scene, data, bytes)) != 0)
        fxs_fail_as(error, message, "%s: %s", s->name, fxs_strerror(error));
    s->shown = (fxs_opened){&s->scene, &s->info, &s->report, data, bytes, NULL};
    *opened = error ? NULL : &s->shown;
    if (error)
        fxs_close(&s->shown);
    return error;
}

static void describe(open_scene *s, const void *data)
{
    fxs_packed_header h;
    memcpy(&h, data, sizeof h);
    fxs_packed_header_turn(&h);
    s->info = (fxs_scene_file_info){.format = "fxs", .count = h.count - h.holes, .sh_degree = (int)h.sh_degree,
                                    .stored_sh_degree = (int)h.sh_degree, .levels = 1,
                                    .antialiased = (h.flags & FXS_PACKED_ANTIALIASED) != 0};
    fxs_start_of(&s->info.start, data);
    s->report.read = s->report.packed = h.count - h.holes;
    for (int i = 0; i < 3; i++) {
        s->report.low[i] = ldexp((double)h.low_q32[i], -32);
        s->report.high[i] = ldexp((double)h.high_q32[i], -32);
    }
    fxs_inner_box(data, s->report.inner_low, s->report.inner_high);
}

static int check_count(const open_scene *s, const fxs_open_options *o, fxs_message *message)
{
    if (o->file->axes)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: axes (--axes) are for .spz", s->name);
    if (o->file->max_gaussians && s->info.count > o->file->max_gaussians)
        return fxs_fail(message, "%s: %" PRIu64 " Gaussians; at most %" PRIu64 " are allowed", s->name, s->info.count,
                        o->file->max_gaussians);
    return 0;
}

static int take_packed(open_scene *s, const void *data, size_t bytes, const fxs_open_options *o, fxs_opened **opened,
                       fxs_message *message)
{
    int error = fxs_file_check(s->name, data, bytes, o->check_all, message);
    if (!error) {
        describe(s, data);
        error = check_count(s, o, message);
    }
    return finish(s, error, data, bytes, opened, message);
}

static int map_file(open_scene *s, const fxs_open_options *o, fxs_opened **opened, fxs_message *message)
{
    const int error = fxs_map_open(&s->mapping, s->name, message);
    return error ? finish(s, error, NULL, 0, opened, message)
                 : take_packed(s, s->mapping.data, s->mapping.bytes, o, opened, message);
}

static int page_file(open_scene *s, const fxs_open_options *o, fxs_opened **opened, fxs_message *message)
{
    fxs_pager *pager;
    int error = o->source ? fxs_pager_open(s->name, o->source, o->pager, &pager, message)
                          : fxs_pager_open_file(s->name, o->pager, &pager, message);
    if (!error) {
        describe(s, fxs_pager_head(pager));
        error = check_count(s, o, message);
    }
    s->shown = (fxs_opened){error ? NULL : fxs_pager_scene(pager), &s->info, &s->report,
                            error ? NULL : fxs_pager_head(pager), sizeof(fxs_packed_header), pager};
    *opened = error ? NULL : &s->shown;
    if (error)
        fxs_close(&s->shown);
    return error;
}

static int take_bytes(open_scene *s, const void *data, size_t bytes, const fxs_open_options *o, fxs_opened **opened,
                      fxs_message *message)
{
    if ((uintptr_t)data % 64 == 0)
        return take_packed(s, data, bytes, o, opened, message);
    s->packed.allocator = o->file->allocator;
    s->packed.allocation = bytes < SIZE_MAX - 63 ? fxs_allocate(o->file->allocator, bytes + 63, 1) : NULL;
    if (!s->packed.allocation)
        return finish(s, fxs_fail_memory(message, s->name, bytes), NULL, 0, opened, message);
    s->packed.data = (void *)(((uintptr_t)s->packed.allocation + 63) / 64 * 64);
    memcpy(s->packed.data, data, bytes);
    return take_packed(s, s->packed.data, bytes, o, opened, message);
}

static int pack(open_scene *s, fxs_scene_file *file, const fxs_open_options *o, fxs_message *message)
{
    const uint32_t threads = o->threads ? o->threads : fxs_processors();
    if (threads > 64)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "%u threads: expected 1 to 64", (unsigned)threads);
    fxs_pool *pool = threads > 1 ? fxs_pool_create(threads) : NULL;
    const fxs_pack_options options = {.size = sizeof options, .profile = o->profile, .progress = o->progress,
                                      .workers = {pool ? fxs_pool_run : NULL, pool, pool ? threads : 1},
                                      .allocator = o->file->allocator, .tree = o->tree};
    const int error = fxs_pack(file, &s->info, &s->packed, &s->report, &options, message);
    fxs_pool_destroy(pool);
    return error;
}

static int pack_file(open_scene *s, int error, fxs_scene_file *file, const fxs_open_options *o, fxs_opened **opened,
                     fxs_message *message)
{
    if (!error && o->prepare)
        error = o->prepare(o->prepare_argument, file, &s->info, message);
    if (!error)
        error = pack(s, file, o, message);
    fxs_scene_file_close(file);
    return finish(s, error, s->packed.data, s->packed.bytes, opened, message);
}

/* Options of a program for opening a scene, and the options for the scene's file that they point to. */
typedef struct open_options {
    fxs_open_options open;
    fxs_scene_file_options file;
} open_options;

static int read_options(open_options *all, const fxs_open_options *given, fxs_opened **opened, fxs_message *message)
{
    if (opened)
        *opened = NULL;
    fxs_open_options_init(&all->open);
    fxs_scene_file_options_init(&all->file);
    FXS_TRY(FXS_OPTIONS_READ(fxs_open_options, &all->open, given, message));
    FXS_TRY(FXS_OPTIONS_READ(fxs_scene_file_options, &all->file, all->open.file, message));
    all->open.file = &all->file;
    return 0;
}

int fxs_open(const char *path, const fxs_open_options *options, fxs_opened **opened, fxs_message *message)
{
    open_options all;
    const fxs_open_options *const o = &all.open;
    fxs_scene_file *file = NULL;
    open_scene *s;
    int error = read_options(&all, options, opened, message);
    error = error ? error : create(path, &s, opened, message);
    if (error && o->source && o->source->close)
        o->source->close(o->source->argument);
    if (error)
        return error;
    if (o->pager || o->source)
        return page_file(s, o, opened, message);
    if (fxs_pager_is_url(path))
        return finish(s, fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: what a server has is read in part, by render "
                                     "and view", path), NULL, 0, opened, message);
    const int is = is_fxs_file(path, message);
    if (is < 0)
        return finish(s, is, NULL, 0, opened, message);
    if (is)
        return map_file(s, o, opened, message);
    error = fxs_scene_file_open(path, o->file, &file, &s->info, message);
    return pack_file(s, error, file, o, opened, message);
}

int fxs_open_memory(const char *name, const void *data, size_t bytes, const fxs_open_options *options,
                    fxs_opened **opened, fxs_message *message)
{
    open_options all;
    const fxs_open_options *const o = &all.open;
    fxs_scene_file *file = NULL;
    open_scene *s;
    int error = read_options(&all, options, opened, message);
    error = error ? error : create(name, &s, opened, message);
    if (error)
        return error;
    if (!data && bytes)
        return finish(s, fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: no bytes to open", name), NULL, 0, opened,
                      message);
    if (bytes >= 4 && is_fxs(data))
        return take_bytes(s, data, bytes, o, opened, message);
    error = fxs_scene_file_open_memory(name, data, bytes, o->file, &file, &s->info, message);
    return pack_file(s, error, file, o, opened, message);
}

int fxs_open_gaussians(const char *name, fxs_scene_file *file, const fxs_scene_file_info *info,
                       const fxs_open_options *options, fxs_opened **opened, fxs_message *message)
{
    open_options all;
    open_scene *s;
    int error = read_options(&all, options, opened, message);
    error = error ? error : create(name, &s, opened, message);
    if (!error && (!file || !info))
        error = finish(s, fxs_fail_as(FXS_ERR_ARGUMENT, message, "%s: no stream of Gaussians", name), NULL, 0, opened,
                       message);
    if (error) {
        fxs_scene_file_close(file);
        return error;
    }
    s->info = *info;
    return pack_file(s, 0, file, &all.open, opened, message);
}

int fxs_opened_check(const fxs_opened *opened, fxs_message *message)
{
    const open_scene *s = (const open_scene *)(const void *)opened;
    if (!s)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "no scene to check");
    return s->mapping.data ? fxs_map_check(&s->mapping, s->name, message) : 0;
}

void fxs_close(fxs_opened *opened)
{
    open_scene *s = (open_scene *)(void *)opened;
    if (!s)
        return;
    fxs_pager_close(s->shown.pager);
    if (s->mapping.data)
        fxs_map_close(&s->mapping);
    fxs_packed_scene_free(&s->packed);
    free(s);
}
