/* Frames of the Vulkan back end: commands of a frame by the steps of plan.c, and rendering to images in memory. */
#include <stdlib.h>
#include <string.h>

#include "src/core/sized.h"
#include "vk.h"

/* Stages that use the large buffers. */
enum { STEPS = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT,
       ALL = STEPS | VK_PIPELINE_STAGE_TRANSFER_BIT };

/* Counts or records the steps of a frame. The steps of equal buffers in a row share a descriptor set. */
typedef struct walk {
    fxs_vulkan *v;
    fxs_vk_slot *slot;
    VkCommandBuffer commands;      /* null: only counts the descriptor sets */
    fxs_vk_scene *const *copies;
    fxs_step last;
    uint32_t sets;
} walk;

static int has_set_of(const walk *w, const fxs_step *step)
{
    const fxs_step *last = &w->last;
    return w->sets && !memcmp(last->buffers, step->buffers, sizeof step->buffers) && last->object == step->object &&
           last->part == step->part;
}

static VkDescriptorBufferInfo buffer_of(const walk *w, const fxs_step *step, int32_t buffer)
{
    const fxs_vulkan *v = w->v;
    const fxs_vk_block *block = buffer == FXS_PLAN_HEADS  ? w->copies[step->object]->heads
                                : buffer == FXS_PLAN_ROWS ? w->copies[step->object]->parts[step->part] : 0;
    if (block)
        return (VkDescriptorBufferInfo){block->buffer, 0, block->bytes};
    buffer = buffer == FXS_PLAN_NONE ? FXS_COMPUTE_ARGUMENTS : buffer;
    return (VkDescriptorBufferInfo){v->frame->buffer, v->at[buffer], w->slot->plan.bytes[buffer]};
}

static void fill_set(const walk *w, const fxs_step *step, VkDescriptorSet set)
{
    const fxs_vulkan *v = w->v;
    const VkDescriptorBufferInfo uniforms[2] = {{w->slot->up->buffer, 0, sizeof(fxs_compute_frame)},
                                                {w->slot->up->buffer, 0, sizeof(fxs_compute_object)}};
    VkDescriptorBufferInfo buffers[4];
    for (int i = 0; i < 4; i++)
        buffers[i] = buffer_of(w, step, step->buffers[i]);
    const VkWriteDescriptorSet writes[2] = {
        {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET, .dstSet = set, .descriptorCount = 2,
         .descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, .pBufferInfo = uniforms},
        {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET, .dstSet = set, .dstBinding = 2, .descriptorCount = 4,
         .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, .pBufferInfo = buffers}};
    v->vk.UpdateDescriptorSets(v->options.device, 2, writes, 0, 0);
}

static void record_step(const walk *w, const fxs_step *step, VkDescriptorSet set)
{
    const fxs_vulkan *v = w->v;
    const uint32_t offsets[2] = {0, step->uniform};
    if (step->waits)
        fxs_vk_barrier(v, w->commands, STEPS, STEPS);
    v->vk.CmdBindPipeline(w->commands, VK_PIPELINE_BIND_POINT_COMPUTE, v->programs[step->program]);
    v->vk.CmdBindDescriptorSets(w->commands, VK_PIPELINE_BIND_POINT_COMPUTE, v->layout, 0, 1, &set, 2, offsets);
    if (step->arguments != FXS_PLAN_NONE)
        v->vk.CmdDispatchIndirect(w->commands, v->frame->buffer, v->at[step->arguments] + step->arguments_at);
    else if (step->groups[0])
        v->vk.CmdDispatch(w->commands, step->groups[0], step->groups[1], 1);
}

static void take_step(void *argument, const fxs_step *step)
{
    walk *w = argument;
    const int has = has_set_of(w, step);
    w->last = *step;
    w->sets += !has;
    if (!w->commands)
        return;
    const VkDescriptorSet set = w->slot->sets[w->sets - 1];
    if (!has)
        fill_set(w, step, set);
    record_step(w, step, set);
}

static VkResult make_sets(fxs_vulkan *v, fxs_vk_slot *slot, uint32_t count, const VkDescriptorSetLayout *layouts)
{
    const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, 2 * count},
                                          {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 4 * count}};
    const VkDescriptorPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO, .maxSets = count,
                                             .poolSizeCount = 2, .pPoolSizes = sizes};
    v->vk.DestroyDescriptorPool(v->options.device, slot->pool, v->options.allocator);
    slot->pool = VK_NULL_HANDLE;
    VkResult result = v->vk.CreateDescriptorPool(v->options.device, &pool, v->options.allocator, &slot->pool);
    const VkDescriptorSetAllocateInfo all = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                             .descriptorPool = slot->pool, .descriptorSetCount = count,
                                             .pSetLayouts = layouts};
    return result ? result : v->vk.AllocateDescriptorSets(v->options.device, &all, slot->sets);
}

/* Makes at least `count` descriptor sets. The array holds their layouts behind the sets. */
static int reserve_sets(fxs_vulkan *v, fxs_vk_slot *slot, uint32_t count, fxs_message *why)
{
    if (count <= slot->set_count)
        return 0;
    slot->set_count = 0;
    free(slot->sets);
    slot->sets = malloc(count * (sizeof *slot->sets + sizeof(VkDescriptorSetLayout)));
    if (!slot->sets)
        return fxs_plan_say(why, FXS_ERR_MEMORY, "out of memory", "");
    VkDescriptorSetLayout *layouts = (VkDescriptorSetLayout *)(void *)(slot->sets + count);
    for (uint32_t i = 0; i < count; i++)
        layouts[i] = v->set_layout;
    const VkResult result = make_sets(v, slot, count, layouts);
    slot->set_count = result ? 0 : count;
    return fxs_vk_said(result, why);
}

static uint64_t aligned(uint64_t bytes)
{
    return (bytes + FXS_VK_ALIGNED - 1) / FXS_VK_ALIGNED * FXS_VK_ALIGNED;
}

static int reserve_frame(fxs_vulkan *v, const fxs_plan *plan, fxs_message *why)
{
    uint64_t bytes = 0;
    for (int i = FXS_COMPUTE_MEMORY; i < FXS_COMPUTE_DOWNLOAD; i++) {
        v->at[i] = bytes;
        bytes += aligned(plan->bytes[i]);
    }
    return fxs_vk_reserve(v, &v->frame, FXS_VK_DEVICE, bytes, why);
}

/* The start of buffer FXS_COMPUTE_MEMORY: the table of opacities, then the table of drawn chunks. */
static uint64_t start_bytes(const fxs_plan *plan)
{
    return 4 * (uint64_t)plan->frame.spans_at + fxs_plan_places_bytes(plan);
}

static uint64_t plane_bytes(const fxs_plan *plan)
{
    return 4 * (uint64_t)plan->view.width * (uint64_t)plan->view.height;
}

/* Lays a frame out, and writes what the host gives to it. Nothing after this can fail but the device. */
static int prepare(walk *w, fxs_message *why)
{
    fxs_vulkan *v = w->v;
    fxs_vk_slot *slot = w->slot;
    fxs_plan *plan = &slot->plan;
    const fxs_targets *t = plan->request->targets;
    int error = fxs_plan_lay_out(plan, &v->rooms, why);
    if (error)
        return error;
    const uint64_t start = aligned(plan->bytes[FXS_COMPUTE_UNIFORMS]), planes = start + aligned(start_bytes(plan));
    w->sets = 0;
    fxs_plan_steps(plan, take_step, w);
    error = reserve_frame(v, plan, why);
    error = error ? error : fxs_vk_reserve(v, &slot->up, FXS_VK_UP, planes + 2 * plane_bytes(plan), why);
    error = error ? error : fxs_vk_reserve(v, &slot->down, FXS_VK_DOWN,
                                           4 * (FXS_VK_PICTURE + (uint64_t)plan->read_words), why);
    error = error ? error : reserve_sets(v, slot, w->sets, why);
    if (error)
        return error;
    unsigned char *to = slot->up->memory.mapped;
    fxs_plan_uniforms(plan, to);
    memcpy(to + start, fxs_offset_of_code_q11, sizeof fxs_offset_of_code_q11);
    fxs_plan_places(plan, (uint32_t *)(void *)(to + start + 4 * plan->frame.spans_at));
    if (t->occluder.pixels)
        fxs_plan_put_plane(plan, &t->occluder, to + planes);
    if (t->backdrop.pixels)
        fxs_plan_put_plane(plan, &t->backdrop, to + planes + plane_bytes(plan));
    ((uint32_t *)slot->down->memory.mapped)[FXS_VK_SERIAL] = 0;
    return 0;
}

static void copy(const walk *w, VkBuffer from, uint64_t at, VkBuffer to, uint64_t to_at, uint64_t bytes)
{
    const VkBufferCopy region = {at, to_at, bytes};
    w->v->vk.CmdCopyBuffer(w->commands, from, to, 1, &region);
}

static void record_uploads(const walk *w)
{
    const fxs_plan *plan = &w->slot->plan;
    const fxs_targets *t = plan->request->targets;
    const VkBuffer from = w->slot->up->buffer, to = w->v->frame->buffer;
    const uint64_t start = aligned(plan->bytes[FXS_COMPUTE_UNIFORMS]), memory = w->v->at[FXS_COMPUTE_MEMORY];
    const uint64_t planes = start + aligned(start_bytes(plan)), plane = plane_bytes(plan);
    copy(w, from, start, to, memory, start_bytes(plan));
    if (t->occluder.pixels)
        copy(w, from, planes, to, memory + 4 * (uint64_t)plan->frame.occluder, plane);
    if (t->backdrop.pixels)
        copy(w, from, planes + plane, to, memory + 4 * (uint64_t)plan->frame.backdrop, plane);
}

/* Copies status and picture to the host, then the serial number. */
static void record_downloads(const walk *w)
{
    const fxs_vulkan *v = w->v;
    const fxs_vk_slot *slot = w->slot;
    const VkBuffer from = v->frame->buffer, to = slot->down->buffer;
    copy(w, from, v->at[FXS_COMPUTE_COUNTS], to, 0, 4 * FXS_COMPUTE_STATUS);
    copy(w, from, v->at[FXS_COMPUTE_MEMORY] + 4 * slot->plan.read_at, to, 4 * FXS_VK_PICTURE,
         4 * slot->plan.read_words);
    fxs_vk_barrier(v, w->commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                   VK_PIPELINE_STAGE_TRANSFER_BIT | VK_PIPELINE_STAGE_HOST_BIT);
    v->vk.CmdFillBuffer(w->commands, to, 4 * FXS_VK_SERIAL, 4, (uint32_t)slot->serial);
    fxs_vk_barrier(v, w->commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT);
}

static void record(walk *w)
{
    fxs_vulkan *v = w->v;
    const uint32_t query = 2 * (uint32_t)(w->slot - v->slots);
    w->slot->serial = ++v->serial;
    w->sets = 0;
    if (v->queries) {
        v->vk.CmdResetQueryPool(w->commands, v->queries, query, 2);
        v->vk.CmdWriteTimestamp(w->commands, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, v->queries, query);
    }
    fxs_vk_barrier(v, w->commands, ALL, ALL);
    record_uploads(w);
    fxs_vk_barrier(v, w->commands, VK_PIPELINE_STAGE_TRANSFER_BIT, STEPS);
    fxs_plan_steps(&w->slot->plan, take_step, w);
    fxs_vk_barrier(v, w->commands, STEPS, VK_PIPELINE_STAGE_TRANSFER_BIT);
    record_downloads(w);
    if (v->queries)
        v->vk.CmdWriteTimestamp(w->commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, v->queries, query + 1);
}

static int run_frame(walk *w, fxs_message *why)
{
    int error = prepare(w, why);
    error = error ? error : fxs_vk_begin(w->v, w->slot, why);
    if (error)
        return error;
    w->commands = w->slot->commands;
    record(w);
    w->commands = VK_NULL_HANDLE;
    error = fxs_vk_run(w->v, w->slot, why);
    if (!error && w->slot->result < 0)
        *why = w->slot->why;
    return error ? error : w->slot->result;
}

static void fill_stats(const fxs_vulkan *v, const fxs_plan *plan, fxs_stats *stats)
{
    fxs_plan_stats(plan, stats);
    stats->memory.splats = (size_t)(plan->bytes[FXS_COMPUTE_MEMORY] + plan->bytes[FXS_COMPUTE_SPLATS]);
    stats->memory.tiles = (size_t)plan->bytes[FXS_COMPUTE_COUNTS];
    stats->memory.entries = (size_t)plan->bytes[FXS_COMPUTE_ENTRIES];
    stats->memory.total = (size_t)v->frame->bytes;
}

static int begin_plan(walk *w, const fxs_request *request, fxs_message *why)
{
    fxs_plan *plan = &w->slot->plan;
    const int error = fxs_plan_begin(plan, request, w->v->memory, why);
    for (uint32_t i = 0; i < request->count && !error; i++)
        plan->part_chunks[i] = w->copies[i]->part_chunks;
    return error;
}

static int render_eye(fxs_vulkan *v, const fxs_request *request, fxs_vk_scene *const *copies, fxs_stats *stats,
                      fxs_message *why)
{
    walk w = {.v = v, .copies = copies};
    uint64_t nanoseconds = 0;
    int result = fxs_vk_take_slot(v, &w.slot, why);
    result = result ? result : begin_plan(&w, request, why);
    if (result)
        return result;
    do {
        result = run_frame(&w, why);
        nanoseconds += result < 0 ? 0 : v->nanoseconds;
    } while (result > 0);
    v->nanoseconds = nanoseconds;
    if (!result) {
        fxs_plan_take_picture(&w.slot->plan, (const uint32_t *)w.slot->down->memory.mapped + FXS_VK_PICTURE);
        fill_stats(v, &w.slot->plan, stats);
    } else if (result == FXS_ERR_MEMORY || result == FXS_ERR_DEVICE) {
        w.slot->serial = 0;
        fxs_vk_give_back(v);
    }
    return result;
}

static int check_request(const fxs_request *r, fxs_message *why)
{
    if (r->eyes < 1 || r->eyes > 2 || (r->count && !r->objects))
        return fxs_plan_say(why, FXS_ERR_ARGUMENT, fxs_strerror(FXS_ERR_ARGUMENT), "");
    if (r->eyes == 2 && (r->cameras[0].width != r->cameras[1].width || r->cameras[0].height != r->cameras[1].height ||
                         r->cameras[0].projection != r->cameras[1].projection))
        return fxs_plan_say(why, FXS_ERR_SIZE, "the pictures of two eyes differ in size or projection", "");
    if (!fxs_plan_memory(r))
        return fxs_plan_say(why, FXS_ERR_OBJECT, fxs_strerror(FXS_ERR_OBJECT), "");
    return 0;
}

/* Makes room for a plan, and behind it for the copies of its objects' scenes. */
static int reserve_memory(fxs_vulkan *v, const fxs_request *r, fxs_vk_scene ***copies, fxs_message *why)
{
    const size_t plan = (fxs_plan_memory(r) + 63) / 64 * 64, bytes = plan + r->count * sizeof **copies;
    if (bytes > v->memory_bytes) {
        free(v->memory);
        v->memory = malloc(bytes);
        v->memory_bytes = v->memory ? bytes : 0;
    }
    if (!v->memory)
        return fxs_plan_say(why, FXS_ERR_MEMORY, "out of memory", "");
    *copies = (fxs_vk_scene **)(void *)((unsigned char *)v->memory + plan);
    return 0;
}

static int begin_request(fxs_vulkan *v, const fxs_request *request, fxs_vk_scene ***copies, fxs_message *why)
{
    int error = check_request(request, why);
    error = error ? error : reserve_memory(v, request, copies, why);
    for (uint32_t i = 0; i < request->count && !error; i++) {
        const fxs_scene *scene = fxs_object_at(request->objects, i)->scene;
        error = fxs_vulkan_upload(v, scene, why);
        (*copies)[i] = fxs_vk_find(v, scene);
    }
    return error;
}

static void add_stats(fxs_stats *sum, const fxs_stats *eye)
{
    const fxs_stats before = *sum;
    *sum = *eye;
    sum->visible += before.visible;
    sum->entries += before.entries;
    sum->bands += before.bands;
    sum->runs += before.runs;
}

int fxs_vulkan_render(fxs_vulkan *v, const fxs_request *request, fxs_stats *stats, fxs_message *why)
{
    fxs_vk_scene **copies = 0;
    fxs_stats sum = {0};
    uint64_t nanoseconds = 0;
    int error = begin_request(v, request, &copies, why);
    for (uint32_t eye = 0; eye < request->eyes && !error; eye++) {
        fxs_request own = *request;
        fxs_stats of_eye;
        own.eyes = 1;
        own.cameras[0] = request->cameras[eye];
        own.targets[0] = request->targets[eye];
        error = render_eye(v, &own, copies, &of_eye, why);
        if (!error)
            add_stats(&sum, &of_eye);
        nanoseconds += v->nanoseconds;
    }
    v->nanoseconds = nanoseconds;
    if (!error && stats)
        *stats = sum;
    return error;
}
