/* Copies of packed scenes on the device of the Vulkan back end. */
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

static int make_part(fxs_vulkan *v, fxs_vk_slot *slot, fxs_vk_scene *copy, fxs_vk_block **block, int64_t part,
                     fxs_message *why)
{
    fxs_piece pieces[3];
    uint64_t bytes = fxs_plan_pieces(&copy->here, copy->part_chunks, part, pieces);
    bytes = bytes ? bytes : 64;
    int error = fxs_vk_reserve(v, block, FXS_VK_DEVICE, bytes, why);
    error = error ? error : fxs_vk_reserve(v, &slot->up, FXS_VK_UP, bytes < STAGED ? bytes : STAGED, why);
    for (int i = 0; i < 3 && !error; i++)
        error = put(v, slot, *block, &pieces[i], why);
    return error;
}

static int copy_scene(fxs_vulkan *v, fxs_vk_scene *copy, fxs_message *why)
{
    fxs_vk_slot *slot = v->slots;
    copy->part_chunks = fxs_plan_part_chunks(&copy->here, v->rooms.most, why);
    if (!copy->part_chunks)
        return FXS_ERR_MEMORY;
    const uint64_t chunks = fxs_scene_chunks(&copy->here), parts = (chunks + copy->part_chunks - 1) / copy->part_chunks;
    if (parts > FXS_VK_PARTS)
        return fxs_plan_say(why, FXS_ERR_MEMORY, "the scene takes more buffers than there may be", "");
    int error = make_part(v, slot, copy, &copy->heads, FXS_PLAN_HEADS, why);
    for (uint32_t part = 0; part < parts && !error; part++)
        error = make_part(v, slot, copy, &copy->parts[part], part, why);
    fxs_vk_retire(v, &slot->up);
    return error;
}

static void free_copy(fxs_vulkan *v, fxs_vk_scene *copy)
{
    fxs_vk_retire(v, &copy->heads);
    for (int i = 0; i < FXS_VK_PARTS; i++)
        fxs_vk_retire(v, &copy->parts[i]);
    free(copy);
    fxs_vk_collect(v);
}

int fxs_vulkan_upload(fxs_vulkan *v, const fxs_scene *scene, fxs_message *why)
{
    if (fxs_vk_find(v, scene))
        return 0;
    if (scene->places)
        return fxs_plan_say(why, FXS_ERR_UNSUPPORTED, "a scene of which a part is in memory cannot be on the device",
                            "");
    fxs_vulkan_drop(v, scene);
    fxs_vk_scene *copy = calloc(1, sizeof *copy);
    if (!copy)
        return fxs_plan_say(why, FXS_ERR_MEMORY, "out of memory", "");
    copy->key = scene;
    copy->here = *scene;
    const int error = copy_scene(v, copy, why);
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
