/* Finds the Gaussians of a scene file that edits by hand delete. Edits are for a packed scene: the bytes of an .fxs, or
   another file packed in profile default, which has the same bytes on every machine. */
#include "hand_edits.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/pack.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/edits.h>
#include <fixsplat/internal/kernels.h>
#include <fixsplat/internal/packed.h>
#include "src/base/os_calls.h"

/* A packed scene, and the slot of each Gaussian of its file. */
typedef struct edited {
    fxs_packed_scene packed;
    uint32_t *slots;
    uint64_t count;
    fxs_pool *pool;
    uint32_t threads;
} edited;

static int copy_fxs(edited *s, const char *path, const load_options *load)
{
    loaded_scene loaded;
    if (load_scene(&loaded, path, load))
        return EXIT_FAILED;
    const fxs_opened *opened = loaded.opened;
    fxs_scene scene;
    int error = FXS_ERR_MEMORY;
    s->packed.data = fxs_aligned_allocate(opened->bytes);
    if (s->packed.data) {
        memcpy(s->packed.data, opened->data, opened->bytes);
        s->packed.bytes = opened->bytes;
        error = fxs_scene_open(&scene, s->packed.data, s->packed.bytes);
    }
    free_scene(&loaded);
    s->slots = error ? 0 : malloc(((size_t)scene.count + 1) * sizeof *s->slots);
    if (!s->slots)
        return fail(EXIT_FAILED, "%s: %s", path, fxs_strerror(error ? error : FXS_ERR_MEMORY));
    s->count = fxs_scene_numbers(&scene, s->slots);
    return 0;
}

static int pack(edited *s, const char *path, const load_options *load, fxs_scene_file *file,
                const fxs_scene_file_info *info)
{
    char label[] = "packing";
    fxs_pack_report report;
    fxs_message message;
    s->count = info->count;
    s->slots = malloc(((size_t)info->count + 1) * sizeof *s->slots);
    if (!s->slots)
        return fail(EXIT_FAILED, "%s: out of memory", path);
    const fxs_pack_options how = {.size = sizeof how, .workers = {fxs_pool_run, s->pool, s->threads},
                                  .progress = progress_of(load, label), .slots = s->slots};
    const int error = fxs_pack(file, info, &s->packed, &report, &how, &message);
    progress_end();
    if (error)
        return fail(EXIT_FAILED, "%s: %s", path, message.text);
    fxs_file_seal(s->packed.data, s->packed.bytes);
    return 0;
}

static int open_edited(edited *s, const char *path, const load_options *load)
{
    fxs_scene_file *file;
    fxs_scene_file_info info;
    if (open_unfiltered(path, load, &file, &info))
        return EXIT_FAILED;
    const int is_fxs = !strcmp(info.format, "fxs");
    int status = is_fxs ? 0 : pack(s, path, load, file, &info);
    fxs_scene_file_close(file);
    if (is_fxs)
        status = copy_fxs(s, path, load);
    return status || s->count == info.count ? status
                                            : fail(EXIT_FAILED, "%s: the number of Gaussians is damaged", path);
}

static int delete(const edited *s, const fxs_edits *edits, uint8_t *deleted, fxs_message *message)
{
    fxs_kernels fastest;
    fxs_context context;
    fxs_scene scene;
    fxs_editor editor;
    const fxs_config config = {.size = sizeof config, .workers = {fxs_pool_run, s->pool, s->threads},
                               .kernels = &fastest};
    fxs_kernels_choose(&fastest, ~0u);
    fxs_context_init(&context, &config);
    int error = fxs_scene_open(&scene, s->packed.data, s->packed.bytes);
    if (error)
        return fxs_fail_as(error, message, "%s", fxs_strerror(error));
    error = fxs_editor_open(&editor, &scene, message);
    if (!error)
        error = fxs_edits_do(edits, &editor, &context, message);
    for (uint64_t i = 0; i < s->count && !error; i++)
        deleted[i] = s->slots[i] != FXS_NOTHING && fxs_editor_deleted(&editor, s->slots[i]);
    fxs_editor_close(&editor);
    return error;
}

static void note_deleted(const char *path, const uint8_t *deleted, uint64_t count)
{
    uint64_t sum = 0;
    for (uint64_t i = 0; i < count; i++)
        sum += deleted[i];
    note("%s: the edits delete %" PRIu64 " of %" PRIu64 " Gaussians", path, sum, count);
}

int edits_find(const char *path, const char *scene, const load_options *load, uint8_t **deleted, uint64_t *count)
{
    edited s = {.threads = load->threads ? load->threads : fxs_processors()};
    fxs_edits edits;
    fxs_message message;
    load_options own = *load;
    own.filter = 0;
    own.again = 1;
    own.still = "is not edited by hand: give --time SECONDS";
    own.decimate_count = 0;
    own.decimate_share = 0;
    if (fxs_edits_read(&edits, path, &message))
        return fail_for(&message);
    s.pool = fxs_pool_create(s.threads);
    int status = s.pool ? open_edited(&s, scene, &own) : fail(EXIT_FAILED, "out of memory");
    *deleted = status ? 0 : calloc((size_t)s.count + 1, 1);
    if (!status && !*deleted)
        status = fail(EXIT_FAILED, "%s: out of memory", scene);
    if (!status && delete(&s, &edits, *deleted, &message))
        status = fail(EXIT_FAILED, "--edits %s: %s", path, message.text);
    *count = s.count;
    if (!status)
        note_deleted(scene, *deleted, s.count);
    fxs_edits_free(&edits);
    if (s.packed.allocation)
        fxs_packed_scene_free(&s.packed);
    else
        fxs_aligned_free(s.packed.data);
    free(s.slots);
    fxs_pool_destroy(s.pool);
    return status;
}
