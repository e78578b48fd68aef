/* Finds the Gaussians of a scene file that edits by hand delete. */
#include "hand_edits.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/edits.h>
#include <fixsplat/internal/kernels.h>
#include "slotted_scene.h"

static int delete(const slotted_scene *s, const fxs_edits *edits, uint8_t *deleted, fxs_message *message)
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
    slotted_scene s;
    fxs_edits edits;
    fxs_message message;
    if (fxs_edits_read(&edits, path, &message))
        return fail_for(&message);
    int status = slotted_open(&s, scene, load, "is not edited by hand: give --time SECONDS");
    *deleted = status ? 0 : calloc((size_t)s.count + 1, 1);
    if (!status && !*deleted)
        status = fail(EXIT_FAILED, "%s: out of memory", scene);
    if (!status && delete(&s, &edits, *deleted, &message))
        status = fail(EXIT_FAILED, "--edits %s: %s", path, message.text);
    *count = s.count;
    if (!status)
        note_deleted(scene, *deleted, s.count);
    fxs_edits_free(&edits);
    slotted_close(&s);
    return status;
}
