/* Memory of the Vulkan back end: blocks, each a buffer with its memory, and the slots of frames in flight. */
#include <stdlib.h>
#include <string.h>

#include "vk.h"

int fxs_vk_said(VkResult result, fxs_message *why)
{
    return result == VK_SUCCESS ? 0
           : result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY ||
                     result == VK_ERROR_OUT_OF_POOL_MEMORY || result == VK_ERROR_FRAGMENTED_POOL ||
                     result == VK_ERROR_TOO_MANY_OBJECTS
               ? fxs_plan_say(why, FXS_ERR_MEMORY, "the device is out of memory", "")
               : fxs_plan_say(why, FXS_ERR_DEVICE, "the device failed, or was lost", "");
}

static VkResult allocate_of_type(fxs_vulkan *v, uint32_t type, VkMemoryPropertyFlags required, VkDeviceSize bytes,
                                 fxs_vulkan_memory *memory)
{
    const VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = bytes,
                                       .memoryTypeIndex = type};
    VkResult result = v->vk.AllocateMemory(v->options.device, &info, v->options.allocator, &memory->memory);
    if (!result && required & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT)
        result = v->vk.MapMemory(v->options.device, memory->memory, 0, VK_WHOLE_SIZE, 0, &memory->mapped);
    if (result && memory->memory) {
        v->vk.FreeMemory(v->options.device, memory->memory, v->options.allocator);
        memory->memory = VK_NULL_HANDLE;
    }
    return result;
}

/* Allocates from the first memory type that has the preferred properties, else from one with the required. */
static VkResult allocate(fxs_vulkan *v, const VkMemoryRequirements *needs, VkMemoryPropertyFlags required,
                         VkMemoryPropertyFlags preferred, fxs_vulkan_memory *memory)
{
    const fxs_vulkan_options *o = &v->options;
    VkResult result = VK_ERROR_OUT_OF_DEVICE_MEMORY;
    if (o->allocate)
        return o->allocate(o->argument, needs, required, preferred, memory);
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t i = 0; i < v->memories.memoryTypeCount; i++) {
            const VkMemoryType *type = &v->memories.memoryTypes[i];
            const VkMemoryPropertyFlags wanted = required | (pass ? 0 : preferred);
            if (!(needs->memoryTypeBits >> i & 1) || (type->propertyFlags & wanted) != wanted ||
                needs->size > v->memories.memoryHeaps[type->heapIndex].size || needs->size > v->most_allocated)
                continue;
            result = allocate_of_type(v, i, required, needs->size, memory);
            if (result == VK_SUCCESS || result == VK_ERROR_DEVICE_LOST)
                return result;
            break;
        }
    return result;
}

static void free_block(fxs_vulkan *v, fxs_vk_block *block)
{
    const fxs_vulkan_options *o = &v->options;
    v->vk.DestroyBuffer(o->device, block->buffer, o->allocator);
    if (block->memory.memory && o->allocate)
        o->free(o->argument, &block->memory);
    else
        v->vk.FreeMemory(o->device, block->memory.memory, o->allocator);
    v->taken -= block->kind == FXS_VK_DEVICE ? block->bytes : 0;
    free(block);
}

static VkResult fill_block(fxs_vulkan *v, fxs_vk_block *block)
{
    static const VkMemoryPropertyFlags required[] = {
        VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT,
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT};
    static const VkMemoryPropertyFlags preferred[] = {0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT,
                                                      VK_MEMORY_PROPERTY_HOST_CACHED_BIT};
    static const VkBufferUsageFlags usage[] = {
        VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
            VK_BUFFER_USAGE_TRANSFER_DST_BIT,
        VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT, VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    const VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = block->bytes,
                                     .usage = usage[block->kind]};
    const VkDevice device = v->options.device;
    VkMemoryRequirements needs;
    VkResult result = v->vk.CreateBuffer(device, &info, v->options.allocator, &block->buffer);
    if (result)
        return result;
    v->vk.GetBufferMemoryRequirements(device, block->buffer, &needs);
    result = allocate(v, &needs, required[block->kind], preferred[block->kind], &block->memory);
    return result ? result : v->vk.BindBufferMemory(device, block->buffer, block->memory.memory, block->memory.offset);
}

static int allow(const fxs_vulkan *v, uint64_t bytes, fxs_message *why)
{
    const uint64_t limit = v->options.max_memory;
    if (!limit || v->taken + bytes <= limit)
        return 0;
    fxs_plan_say(why, FXS_ERR_MEMORY, "the device memory allowed is too small", "");
    why->bytes_needed = v->taken + bytes;
    return FXS_ERR_MEMORY;
}

/* A block that grows gets an eighth more than it needs, if the limit allows. */
int fxs_vk_reserve(fxs_vulkan *v, fxs_vk_block **block, enum fxs_vk_kind kind, uint64_t bytes, fxs_message *why)
{
    const uint64_t slack = *block ? bytes / 8 / 256 * 256 : 0;
    fxs_message ignored;
    if (*block && (*block)->bytes >= bytes)
        return 0;
    fxs_vk_retire(v, block);
    fxs_vk_collect(v);
    const int error = kind == FXS_VK_DEVICE ? allow(v, bytes, why) : 0;
    if (error)
        return error;
    fxs_vk_block *made = calloc(1, sizeof *made);
    if (!made)
        return fxs_plan_say(why, FXS_ERR_MEMORY, "out of memory", "");
    made->kind = kind;
    made->bytes = bytes + (kind == FXS_VK_DEVICE && allow(v, bytes + slack, &ignored) ? 0 : slack);
    v->taken += kind == FXS_VK_DEVICE ? made->bytes : 0;
    const VkResult result = fill_block(v, made);
    if (result) {
        free_block(v, made);
        return fxs_vk_said(result, why);
    }
    *block = made;
    return 0;
}

void fxs_vk_retire(fxs_vulkan *v, fxs_vk_block **block)
{
    if (*block) {
        (*block)->call = v->call;
        (*block)->next = v->retired;
        v->retired = *block;
    }
    *block = 0;
}

static void free_retired(fxs_vulkan *v)
{
    for (fxs_vk_block **at = &v->retired, *block; (block = *at) != 0;)
        if (block->call <= v->ended) {
            *at = block->next;
            free_block(v, block);
        } else
            at = &block->next;
}

/* Reads the status of a frame that has ended. */
static void look(fxs_vulkan *v, fxs_vk_slot *slot)
{
    uint64_t times[2] = {0, 0};
    fxs_message ignored;
    const uint32_t first = 2 * (uint32_t)(slot - v->slots);
    slot->result = fxs_plan_look(&v->rooms, slot->down->memory.mapped, slot->eyes, &slot->why);
    slot->serial = 0;
    if (slot->result < 0 && slot != v->slots) {
        v->late = slot->result;
        v->late_why = slot->why;
    }
    v->nanoseconds = 0;
    if (v->queries && !fxs_vk_said(v->vk.GetQueryPoolResults(v->options.device, v->queries, first, 2, sizeof times,
                                                             times, sizeof *times, VK_QUERY_RESULT_64_BIT), &ignored))
        v->nanoseconds = (uint64_t)((double)((times[1] - times[0]) & v->timestamp_mask) * v->timestamp_nanoseconds);
}

void fxs_vk_collect(fxs_vulkan *v)
{
    for (int i = 0; i < FXS_VK_SLOTS; i++) {
        fxs_vk_slot *slot = &v->slots[i];
        const volatile uint32_t *words = slot->serial ? slot->down->memory.mapped : 0;
        if (words && words[FXS_VK_SERIAL] == (uint32_t)slot->serial)
            look(v, slot);
    }
    free_retired(v);
}

static VkResult make_commands(fxs_vulkan *v, fxs_vk_slot *slot)
{
    const VkCommandBufferAllocateInfo one = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                             .commandPool = v->commands, .commandBufferCount = 1};
    const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    VkResult result = slot->commands ? VK_SUCCESS
                                     : v->vk.AllocateCommandBuffers(v->options.device, &one, &slot->commands);
    if (!result && !slot->fence)
        result = v->vk.CreateFence(v->options.device, &fence, v->options.allocator, &slot->fence);
    return result;
}

int fxs_vk_begin(fxs_vulkan *v, fxs_vk_slot *slot, fxs_message *why)
{
    const VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                            .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    VkResult result = make_commands(v, slot);
    result = result ? result : v->vk.ResetFences(v->options.device, 1, &slot->fence);
    return fxs_vk_said(result ? result : v->vk.BeginCommandBuffer(slot->commands, &begin), why);
}

int fxs_vk_run(fxs_vulkan *v, fxs_vk_slot *slot, fxs_message *why)
{
    const VkSubmitInfo submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1,
                                 .pCommandBuffers = &slot->commands};
    VkResult result = v->vk.EndCommandBuffer(slot->commands);
    result = result ? result : v->vk.QueueSubmit(v->options.queue, 1, &submit, slot->fence);
    result = result ? result : v->vk.WaitForFences(v->options.device, 1, &slot->fence, VK_TRUE, UINT64_MAX);
    fxs_vk_collect(v);
    return fxs_vk_said(result, why);
}

static VkAccessFlags access_of(VkPipelineStageFlags stages, int writes_only)
{
    static const struct {
        VkPipelineStageFlags stage;
        VkAccessFlags reads, writes;
    } of[] = {{VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT, VK_ACCESS_SHADER_WRITE_BIT},
              {VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT, VK_ACCESS_INDIRECT_COMMAND_READ_BIT, 0},
              {VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_READ_BIT, VK_ACCESS_TRANSFER_WRITE_BIT},
              {VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT, 0}};
    VkAccessFlags access = 0;
    for (size_t i = 0; i < sizeof of / sizeof *of; i++)
        if (stages & of[i].stage)
            access |= of[i].writes | (writes_only ? 0 : of[i].reads);
    return access;
}

void fxs_vk_barrier(const fxs_vulkan *v, VkCommandBuffer commands, VkPipelineStageFlags from, VkPipelineStageFlags to)
{
    const VkMemoryBarrier barrier = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER, .srcAccessMask = access_of(from, 1),
                                     .dstAccessMask = access_of(to, 0)};
    v->vk.CmdPipelineBarrier(commands, from, to, 0, 1, &barrier, 0, 0, 0, 0);
}

void fxs_vk_drop_slot(fxs_vulkan *v, fxs_vk_slot *slot)
{
    const fxs_vulkan_options *o = &v->options;
    fxs_vk_retire(v, &slot->up);
    fxs_vk_retire(v, &slot->down);
    v->vk.DestroyDescriptorPool(o->device, slot->pool, o->allocator);
    v->vk.DestroyFence(o->device, slot->fence, o->allocator);
    if (slot->commands)
        v->vk.FreeCommandBuffers(o->device, v->commands, 1, &slot->commands);
    free(slot->sets);
    memset(slot, 0, sizeof *slot);
}

void fxs_vk_give_back(fxs_vulkan *v)
{
    v->vk.QueueWaitIdle(v->options.queue);
    fxs_vk_collect(v);
    for (int i = 0; i < FXS_VK_SLOTS; i++)
        if (i == 0 || v->call == v->ended)
            fxs_vk_drop_slot(v, &v->slots[i]);
    if (v->call == v->ended) {
        fxs_vk_retire(v, &v->frame);
        v->rooms = (fxs_plan_rooms){.most = v->rooms.most, .finishes = v->rooms.finishes};
    }
    fxs_vk_collect(v);
}
