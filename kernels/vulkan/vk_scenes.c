/* Copies of packed scenes on the device of the Vulkan back end, whole or in parts. */
#include <stdlib.h>
#include <string.h>

#include "vk.h"

enum { STAGED = 1 << 24 };         /* largest number of bytes that are copied at once */

fxs_vk_scene *fxs_vk_find(const fxs_vulkan *v, const fxs_scene *scene)
{
    fxs_vk_scene *copy = v->scenes;
    while (copy && (copy->key != scene || memcmp(&copy->here, scene, sizeof *scene)))
        copy = copy->next;
    return copy;
}

static int put(fxs_vulkan *v, fxs_vk_slot *slot, const fxs_vk_block *to, const fxs_piece *piece, fxs_message *why)
{
    int error = 0;
    for (uint64_t at = 0; at < piece->bytes && !error; at += STAGED) {
        const uint64_t bytes = piece->bytes - at < STAGED ? piece->bytes - at : STAGED;
        const VkBufferCopy region = {0, piece->at + at, bytes};
        memcpy(slot->up->memory.mapped, (const unsigned char *)piece->from + at, (size_t)bytes);
        error = fxs_vk_begin(v, slot, why);
        if (error)
            return error;
        v->vk.CmdCopyBuffer(slot->commands, slot->up->buffer, to->buffer, 1, &region);
        error = fxs_vk_run(v, slot, why);
    }
    return error;
}

/* Makes one buffer of a scene's copy. The pool of a scene in parts gets only its palette. */
static int make_part(fxs_vulkan *v, const fxs_vk_scene *copy, const fxs_scene *scene, fxs_vk_block **block,
                     int64_t part, fxs_message *why)
{
    fxs_piece pieces[3];
    fxs_vk_slot *slot = v->slots;
    uint64_t bytes = fxs_plan_pieces(scene, copy->part_chunks, part, pieces);
    bytes = bytes ? bytes : 64;
    int error = fxs_vk_reserve(v, block, FXS_VK_DEVICE, bytes, why);
    error = error ? error : fxs_vk_reserve(v, &slot->up, FXS_VK_UP, bytes < STAGED ? bytes : STAGED, why);
    for (int i = copy->mirror ? 2 : 0; i < 3 && !error; i++)
        error = put(v, slot, *block, &pieces[i], why);
    return error;
}

static int copy_scene(fxs_vulkan *v, fxs_vk_scene *copy, fxs_message *why)
{
    const fxs_scene scene = copy->mirror ? fxs_mirror_pool(copy->mirror) : copy->here;
    copy->part_chunks = fxs_plan_part_chunks(&scene, v->rooms.most, why);
    if (!copy->part_chunks)
        return FXS_ERR_MEMORY;
    const uint64_t chunks = fxs_scene_chunks(&scene), parts = (chunks + copy->part_chunks - 1) / copy->part_chunks;
    if (parts > FXS_VK_PARTS)
        return fxs_plan_say(why, FXS_ERR_MEMORY, "the scene takes more buffers than there may be", "");
    int error = make_part(v, copy, &scene, &copy->heads, FXS_PLAN_HEADS, why);
    for (uint32_t part = 0; part < parts && !error; part++)
        error = make_part(v, copy, &scene, &copy->parts[part], part, why);
    fxs_vk_walk w = {.v = v, .slot = v->slots, .copies = &copy};
    error = error ? error : fxs_vk_put_chunks(&w, 1, why);
    fxs_vk_retire(v, &v->slots->up);
    return error;
}

static int make_mirror(const fxs_vulkan *v, fxs_vk_scene *copy, fxs_message *why)
{
    const uint32_t room = fxs_mirror_room(copy->key, v->pool_bytes, v->options.max_memory, why);
    if (!room)
        return FXS_ERR_MEMORY;
    copy->mirror = malloc(sizeof *copy->mirror + (size_t)fxs_mirror_bytes(copy->key, room));
    if (!copy->mirror)
        return fxs_plan_say(why, FXS_ERR_MEMORY, "out of memory", "");
    fxs_mirror_init(copy->mirror, copy->key, room, copy->mirror + 1);
    return 0;
}

static void free_copy(fxs_vulkan *v, fxs_vk_scene *copy)
{
    fxs_vk_retire(v, &copy->heads);
    for (int i = 0; i < FXS_VK_PARTS; i++)
        fxs_vk_retire(v, &copy->parts[i]);
    free(copy->mirror);
    free(copy);
    fxs_vk_collect(v);
}

int fxs_vulkan_upload(fxs_vulkan *v, const fxs_scene *scene, fxs_message *why)
{
    if (fxs_vk_find(v, scene))
        return 0;
    fxs_vulkan_drop(v, scene);
    fxs_vk_scene *copy = calloc(1, sizeof *copy);
    if (!copy)
        return fxs_plan_say(why, FXS_ERR_MEMORY, "out of memory", "");
    copy->key = scene;
    copy->here = *scene;
    int error = scene->places ? make_mirror(v, copy, why) : 0;
    error = error ? error : copy_scene(v, copy, why);
    if (error) {
        fxs_vk_give_back(v);
        free_copy(v, copy);
        return error;
    }
    copy->next = v->scenes;
    v->scenes = copy;
    return 0;
}

void fxs_vulkan_drop(fxs_vulkan *v, const fxs_scene *scene)
{
    for (fxs_vk_scene **at = &v->scenes, *copy; (copy = *at) != 0; at = &copy->next)
        if (copy->key == scene) {
            *at = copy->next;
            free_copy(v, copy);
            return;
        }
}

/* ---- Scenes in parts --------------------------------------------------------------------------------------------- */

void fxs_vulkan_stream(fxs_vulkan *v, uint64_t pool_bytes, uint64_t upload_bytes)
{
    v->pool_bytes = pool_bytes;
    v->upload_bytes = upload_bytes;
    for (fxs_vk_scene *copy = v->scenes, *next; copy; copy = next) {
        next = copy->next;
        if (copy->mirror)
            fxs_vulkan_drop(v, copy->key);
    }
}

uint64_t fxs_vk_staged(const fxs_vulkan *v, fxs_vk_scene *const *copies, uint32_t count)
{
    uint64_t most = 0;
    for (uint32_t i = 0; i < count; i++) {
        const uint64_t bytes = copies[i]->mirror ? fxs_mirror_upload_bytes(copies[i]->key, v->upload_bytes) : 0;
        most = bytes > most ? bytes : most;
    }
    return most;
}

/* Copies the chunks of `places` from the staging memory at `at` to the pool. */
static void record_copies(const fxs_vk_walk *w, const fxs_vk_scene *copy, const uint32_t *places, uint32_t count,
                          uint64_t at)
{
    const uint64_t header = sizeof(fxs_chunk), rows = copy->key->chunk_bytes;
    const VkBuffer from = w->slot->up->buffer;
    for (uint32_t i = 0, run; i < count; i += run) {
        const uint32_t place = places[i];
        run = fxs_mirror_run(places + i, count - i, copy->part_chunks);
        const VkBufferCopy of_headers = {at + i * header, place * header, run * header};
        const VkBufferCopy of_rows = {at + count * header + i * rows,
                                      fxs_plan_place_at(copy->key, copy->part_chunks, place), run * rows};
        w->v->vk.CmdCopyBuffer(w->commands, from, copy->heads->buffer, 1, &of_headers);
        w->v->vk.CmdCopyBuffer(w->commands, from, copy->parts[place / copy->part_chunks]->buffer, 1, &of_rows);
    }
}

void fxs_vk_record_chunks(const fxs_vk_walk *w, uint32_t count, uint64_t at, uint64_t bytes)
{
    fxs_vk_slot *slot = w->slot;
    slot->chunks = 0;
    for (uint32_t i = 0; i < count; i++) {
        fxs_mirror *m = w->copies[i]->mirror;
        const uint64_t each = m ? fxs_mirror_place_bytes(m->from) : 0;
        const uint32_t *places, wanted = m ? fxs_mirror_step(m, bytes, &places) : 0;
        if (!wanted)
            continue;
        fxs_mirror_fill(m, places, wanted, (unsigned char *)slot->up->memory.mapped + at);
        record_copies(w, w->copies[i], places, wanted, at);
        slot->chunks += wanted;
        at += wanted * each;
        bytes -= wanted * each;
    }
}

void fxs_vk_forget_chunks(fxs_vulkan *v)
{
    for (fxs_vk_scene *copy = v->scenes; copy; copy = copy->next)
        if (copy->mirror)
            fxs_mirror_forget(copy->mirror);
}

int fxs_vk_put_chunks(fxs_vk_walk *w, uint32_t count, fxs_message *why)
{
    const uint64_t bytes = fxs_vk_staged(w->v, w->copies, count);
    if (!bytes)
        return 0;
    int error = fxs_vk_reserve(w->v, &w->slot->up, FXS_VK_UP, bytes, why);
    error = error ? error : fxs_vk_begin(w->v, w->slot, why);
    if (error)
        return error;
    w->commands = w->slot->commands;
    fxs_vk_barrier(w->v, w->commands, FXS_VK_ALL, FXS_VK_ALL);
    fxs_vk_record_chunks(w, count, 0, bytes);
    error = fxs_vk_run(w->v, w->slot, why);
    if (error)
        fxs_vk_forget_chunks(w->v);
    return error;
}
