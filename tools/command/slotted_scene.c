/* Opens a scene file for work on its Gaussians by number: packs it, and keeps the slot of each Gaussian. */
#include "slotted_scene.h"

#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/packed.h>
#include "src/base/os_calls.h"

static int copy_fxs(slotted_scene *s, const char *path, const load_options *load)
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

static int pack(slotted_scene *s, const char *path, const load_options *load, fxs_scene_file *file,
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

static int open_file(slotted_scene *s, const char *path, const load_options *load)
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

int slotted_open(slotted_scene *s, const char *path, const load_options *load, const char *still)
{
    load_options own = *load;
    own.filter = 0;
    own.again = 1;
    own.still = still;
    own.decimate_count = 0;
    own.decimate_share = 0;
    *s = (slotted_scene){.threads = load->threads ? load->threads : fxs_processors()};
    s->pool = fxs_pool_create(s->threads);
    return s->pool ? open_file(s, path, &own) : fail(EXIT_FAILED, "out of memory: %u threads", (unsigned)s->threads);
}

void slotted_close(slotted_scene *s)
{
    if (s->packed.allocation)
        fxs_packed_scene_free(&s->packed);
    else
        fxs_aligned_free(s->packed.data);
    free(s->slots);
    fxs_pool_destroy(s->pool);
}
