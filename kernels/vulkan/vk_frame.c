/* Frames of the Vulkan back end: commands of a frame by the steps of plan.c, and rendering to images in memory. */
#include <stdlib.h>
#include <string.h>

#include "src/core/sized.h"
#include "vk.h"

static int has_set_of(const fxs_vk_walk *w, const fxs_step *step)
{
    const fxs_step *last = &w->last;
    return w->sets && !memcmp(last->buffers, step->buffers, sizeof step->buffers) && last->object == step->object &&
           last->part == step->part && last->eye == step->eye;
}

static VkDescriptorBufferInfo buffer_of(const fxs_vk_walk *w, const fxs_step *step, int32_t buffer)
{
    const fxs_vulkan *v = w->v;
    const fxs_vk_block *block = buffer == FXS_PLAN_HEADS  ? w->copies[step->object]->heads
                                : buffer == FXS_PLAN_ROWS ? w->copies[step->object]->parts[step->part] : 0;
    if (block)
        return (VkDescriptorBufferInfo){block->buffer, 0, block->bytes};
    buffer = buffer == FXS_PLAN_NONE ? FXS_COMPUTE_ARGUMENTS : buffer;
    return (VkDescriptorBufferInfo){v->frame->buffer, w->slot->at[step->eye][buffer], w->slot->plan.bytes[buffer]};
}

static void fill_set(const fxs_vk_walk *w, const fxs_step *step, VkDescriptorSet set)
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

static void record_step(const fxs_vk_walk *w, const fxs_step *step, VkDescriptorSet set)
{
    const fxs_vulkan *v = w->v;
    const uint32_t offsets[2] = {step->frame, step->uniform};
    if (step->waits)
        fxs_vk_barrier(v, w->commands, FXS_VK_STEPS, FXS_VK_STEPS);
    v->vk.CmdBindPipeline(w->commands, VK_PIPELINE_BIND_POINT_COMPUTE, v->programs[step->program]);
    v->vk.CmdBindDescriptorSets(w->commands, VK_PIPELINE_BIND_POINT_COMPUTE, v->layout, 0, 1, &set, 2, offsets);
    if (step->arguments != FXS_PLAN_NONE)
        v->vk.CmdDispatchIndirect(w->commands, v->frame->buffer,
                                  w->slot->at[step->eye][step->arguments] + step->arguments_at);
    else if (step->groups[0])
        v->vk.CmdDispatch(w->commands, step->groups[0], step->groups[1], 1);
}

void fxs_vk_take_step(void *walk, const fxs_step *step)
{
    fxs_vk_walk *w = walk;
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

static int reserve_frame(fxs_vulkan *v, fxs_vk_slot *slot, fxs_message *why)
{
    uint64_t bytes = 0;
    for (uint32_t eye = 0; eye < slot->eyes; eye++)
        for (int i = FXS_COMPUTE_MEMORY; i < FXS_COMPUTE_DOWNLOAD; i++) {
            slot->at[eye][i] = bytes;
            bytes += aligned(slot->plan.bytes[i]);
        }
    return fxs_vk_reserve(v, &v->frame, FXS_VK_DEVICE, bytes, why);
}

/* The start of each eye's buffer FXS_COMPUTE_MEMORY: the table of opacities, then the table of drawn chunks. */
static uint64_t start_bytes(const fxs_plan *plan)
{
    return 4 * (uint64_t)plan->frames->spans_at + fxs_plan_places_bytes(plan);
}

static uint64_t plane_bytes(const fxs_plan *plan)
{
    return 4 * (uint64_t)plan->size[0] * (uint64_t)plan->size[1];
}

static void take_steps(fxs_vk_walk *w)
{
    w->sets = 0;
    if (w->targets)
        fxs_vk_convert_in(w);
    fxs_plan_steps(&w->slot->plan, fxs_vk_take_step, w);
    if (w->targets)
        fxs_vk_convert_out(w);
}

/* Words of the pictures that go to the host. */
static uint64_t words_down(const fxs_vk_walk *w)
{
    uint64_t words = 0;
    for (uint32_t eye = 0; eye < w->slot->eyes && !w->targets; eye++)
        words += w->slot->plan.read_words[eye];
    return words;
}

static size_t memory_of(const fxs_request *request)
{
    return (fxs_plan_memory(request) + 63) / 64 * 64;
}

/* The host's images behind the tables in the block `up`: two planes an eye. */
static void put_planes(const fxs_vk_walk *w, unsigned char *to)
{
    const fxs_plan *plan = &w->slot->plan;
    const uint64_t plane = plane_bytes(plan);
    for (uint32_t eye = 0; eye < w->slot->eyes; eye++, to += 2 * plane) {
        const fxs_targets *t = &plan->request->targets[eye];
        if (t->occluder.pixels)
            fxs_plan_put_plane(plan, &t->occluder, to);
        if (t->backdrop.pixels)
            fxs_plan_put_plane(plan, &t->backdrop, to + plane);
    }
}

static uint64_t planes_at(const fxs_plan *plan)
{
    return aligned(plan->bytes[FXS_COMPUTE_UNIFORMS]) + aligned(start_bytes(plan));
}

/* The chunks that the frame uploads, behind the host's images. */
static uint64_t chunks_at(const fxs_vk_walk *w)
{
    const fxs_plan *plan = &w->slot->plan;
    return planes_at(plan) + (w->targets ? 0 : 2 * w->slot->eyes * plane_bytes(plan));
}

/* The first window of a frame uploads chunks. */
static uint64_t chunk_bytes(const fxs_vk_walk *w)
{
    return w->windows ? 0 : fxs_vk_staged(w->v, w->copies, w->slot->request.count);
}

/* Makes the buffers of the plan, and fills those that the host writes. */
static int fill_buffers(fxs_vk_walk *w, fxs_message *why)
{
    fxs_vulkan *v = w->v;
    fxs_vk_slot *slot = w->slot;
    fxs_plan *plan = &slot->plan;
    const uint64_t start = aligned(plan->bytes[FXS_COMPUTE_UNIFORMS]), planes = planes_at(plan);
    w->commands = VK_NULL_HANDLE;
    take_steps(w);
    int error = reserve_frame(v, slot, why);
    error = error ? error : fxs_vk_reserve(v, &slot->up, FXS_VK_UP, chunks_at(w) + chunk_bytes(w), why);
    error = error ? error : fxs_vk_reserve(v, &slot->down, FXS_VK_DOWN, 4 * (FXS_VK_PICTURE + words_down(w)), why);
    error = error ? error : reserve_sets(v, slot, w->sets, why);
    if (error)
        return error;
    unsigned char *to = slot->up->memory.mapped;
    fxs_plan_uniforms(plan, to);
    memcpy(to + start, fxs_offset_of_code_q11, sizeof fxs_offset_of_code_q11);
    fxs_plan_places(plan, (uint32_t *)(void *)(to + start + 4 * plan->frames->spans_at));
    if (!w->targets)
        put_planes(w, to + planes);
    ((uint32_t *)slot->down->memory.mapped)[FXS_VK_SERIAL] = 0;
    return 0;
}

static void copy(const fxs_vk_walk *w, VkBuffer from, uint64_t at, VkBuffer to, uint64_t to_at, uint64_t bytes)
{
    const VkBufferCopy region = {at, to_at, bytes};
    if (bytes)
        w->v->vk.CmdCopyBuffer(w->commands, from, to, 1, &region);
}

static void record_uploads(const fxs_vk_walk *w, uint32_t eye)
{
    const fxs_plan *plan = &w->slot->plan;
    const fxs_targets *t = &plan->request->targets[eye];
    const VkBuffer from = w->slot->up->buffer, to = w->v->frame->buffer;
    const uint64_t memory = w->slot->at[eye][FXS_COMPUTE_MEMORY], plane = plane_bytes(plan);
    const uint64_t planes = planes_at(plan) + 2 * eye * plane;
    copy(w, from, aligned(plan->bytes[FXS_COMPUTE_UNIFORMS]), to, memory, start_bytes(plan));
    if (!w->targets && t->occluder.pixels)
        copy(w, from, planes, to, memory + 4 * (uint64_t)plan->frames[eye].occluder, plane);
    if (!w->targets && t->backdrop.pixels)
        copy(w, from, planes + plane, to, memory + 4 * (uint64_t)plan->frames[eye].backdrop, plane);
}

/* Copies statuses and pictures to the host, then the serial number. */
static void record_downloads(const fxs_vk_walk *w)
{
    const fxs_vulkan *v = w->v;
    const fxs_vk_slot *slot = w->slot;
    const VkBuffer from = v->frame->buffer, to = slot->down->buffer;
    uint64_t picture = 4 * FXS_VK_PICTURE;
    for (uint32_t eye = 0; eye < slot->eyes; eye++) {
        const uint64_t bytes = w->targets ? 0 : 4 * slot->plan.read_words[eye];
        copy(w, from, slot->at[eye][FXS_COMPUTE_COUNTS], to, 4 * eye * FXS_COMPUTE_STATUS, 4 * FXS_COMPUTE_STATUS);
        copy(w, from, slot->at[eye][FXS_COMPUTE_MEMORY] + 4 * slot->plan.read_at[eye], to, picture, bytes);
        picture += bytes;
    }
    fxs_vk_barrier(v, w->commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                   VK_PIPELINE_STAGE_TRANSFER_BIT | VK_PIPELINE_STAGE_HOST_BIT);
    v->vk.CmdFillBuffer(w->commands, to, 4 * FXS_VK_SERIAL, 4, (uint32_t)slot->serial);
    fxs_vk_barrier(v, w->commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT);
}

void fxs_vk_record(fxs_vk_walk *w)
{
    fxs_vulkan *v = w->v;
    const uint32_t query = 2 * (uint32_t)(w->slot - v->slots);
    w->slot->serial = ++v->serial;
    fxs_vk_barrier(v, w->commands, FXS_VK_ALL, FXS_VK_ALL);
    fxs_vk_record_chunks(w, w->slot->request.count, chunks_at(w), chunk_bytes(w));
    for (uint32_t eye = 0; eye < w->slot->eyes; eye++)
        record_uploads(w, eye);
    if (w->targets)
        fxs_vk_copy_in(w);
    fxs_vk_barrier(v, w->commands, VK_PIPELINE_STAGE_TRANSFER_BIT, FXS_VK_STEPS);
    if (v->queries) {
        v->vk.CmdResetQueryPool(w->commands, v->queries, query, 2);
        v->vk.CmdWriteTimestamp(w->commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, v->queries, query);
    }
    take_steps(w);
    if (v->queries)
        v->vk.CmdWriteTimestamp(w->commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, v->queries, query + 1);
    fxs_vk_barrier(v, w->commands, FXS_VK_STEPS, VK_PIPELINE_STAGE_TRANSFER_BIT);
    if (w->targets)
        fxs_vk_copy_out(w);
    record_downloads(w);
}

static fxs_mirror *mirror_of(const void *copies, uint32_t i)
{
    return ((fxs_vk_scene *const *)copies)[i]->mirror;
}

/* The objects lie behind the plan, as reserve_memory says. */
static int take_mirrors(const fxs_vk_walk *w, fxs_message *why)
{
    fxs_vulkan *v = w->v;
    fxs_request *request = &w->slot->request;
    fxs_object *objects = (fxs_object *)(void *)((unsigned char *)v->memory + memory_of(request));
    const int error = fxs_mirror_is_asked(request)
                          ? fxs_mirror_take(request, objects, ++v->turn, mirror_of, w->copies) : 0;
    return error ? fxs_plan_say(why, error, fxs_strerror(error), "") : 0;
}

static int begin_plan(fxs_vk_walk *w, fxs_message *why)
{
    fxs_vulkan *v = w->v;
    fxs_request *request = &w->slot->request;
    fxs_plan *plan = &w->slot->plan;
    int error = take_mirrors(w, why);
    error = error ? error : fxs_plan_begin(plan, request, v->memory, why);
    w->slot->eyes = request->eyes;
    v->missing = plan->missing;
    for (uint32_t i = 0; i < request->count && !error; i++) {
        const fxs_vk_scene *copy = w->copies[i];
        plan->part_chunks[i] = copy->part_chunks;
        plan->part_counts[i] = copy->mirror ? fxs_mirror_parts(copy->mirror, copy->part_chunks) : 0;
    }
    for (uint32_t eye = 0; eye < request->eyes && w->targets; eye++)
        fxs_vk_ask_planes(&request->targets[eye], &w->targets[eye]);
    return error;
}

int fxs_vk_prepare(fxs_vk_walk *w, fxs_message *why)
{
    int error = begin_plan(w, why);
    error = error ? error : fxs_plan_lay_out(&w->slot->plan, &w->v->rooms, why);
    return error ? error : fill_buffers(w, why);
}

static int run_frame(fxs_vk_walk *w, fxs_message *why)
{
    int error = fxs_vk_begin(w->v, w->slot, why);
    if (error)
        return error;
    w->commands = w->slot->commands;
    fxs_vk_record(w);
    error = fxs_vk_run(w->v, w->slot, why);
    if (error && w->slot->chunks)
        fxs_vk_forget_chunks(w->v);
    return error;
}

/* A stopped frame, too, uploads what it lacks. */
static int put_stopped(fxs_vk_walk *w, fxs_message *why)
{
    const int error = fxs_vk_put_chunks(w, w->slot->request.count, why);
    return error ? error : fxs_plan_say(why, FXS_ERR_STOPPED, fxs_strerror(FXS_ERR_STOPPED), "");
}

static void fill_stats(const fxs_vk_slot *slot, const fxs_vulkan *v, fxs_stats *stats)
{
    const fxs_plan *plan = &slot->plan;
    fxs_plan_stats(plan, stats);
    fxs_plan_count(stats, slot->down->memory.mapped, slot->eyes);
    stats->memory.splats = slot->eyes * (size_t)(plan->bytes[FXS_COMPUTE_MEMORY] + plan->bytes[FXS_COMPUTE_SPLATS]);
    stats->memory.tiles = slot->eyes * (size_t)plan->bytes[FXS_COMPUTE_COUNTS];
    stats->memory.entries = slot->eyes * (size_t)plan->bytes[FXS_COMPUTE_ENTRIES];
    stats->memory.total = (size_t)v->frame->bytes;
}

int fxs_vulkan_stats(fxs_vulkan *v, fxs_stats *stats, fxs_message *why)
{
    const fxs_vk_slot *slot = &v->slots[1 + (v->call - 1) % v->options.frames];
    fxs_vk_collect(v);
    if (!v->call || slot->serial || !slot->down || !v->frame)
        return fxs_plan_say(why, FXS_ERR_ARGUMENT, "no submitted frame has ended", "");
    if (slot->result < 0) {
        v->late = 0;
        *why = slot->why;
        return slot->result;
    }
    memset(stats, 0, sizeof *stats);
    fill_stats(slot, v, stats);
    return 0;
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

/* Makes room for a plan, and behind it for its objects and the copies of their scenes. */
static int reserve_memory(fxs_vulkan *v, const fxs_request *r, fxs_vk_scene ***copies, fxs_message *why)
{
    const size_t before = memory_of(r) + r->count * sizeof(fxs_object), bytes = before + r->count * sizeof **copies;
    if (bytes > v->memory_bytes) {
        free(v->memory);
        v->memory = malloc(bytes);
        v->memory_bytes = v->memory ? bytes : 0;
    }
    if (!v->memory)
        return fxs_plan_say(why, FXS_ERR_MEMORY, "out of memory", "");
    *copies = (fxs_vk_scene **)(void *)((unsigned char *)v->memory + before);
    return 0;
}

int fxs_vk_begin_request(fxs_vulkan *v, const fxs_request *request, int upload, fxs_vk_scene ***copies,
                         fxs_message *why)
{
    int error = check_request(request, why);
    error = error ? error : reserve_memory(v, request, copies, why);
    for (uint32_t i = 0; i < request->count && !error; i++) {
        const fxs_scene *scene = fxs_object_at(request->objects, i)->scene;
        error = upload ? fxs_vulkan_upload(v, scene, why) : 0;
        (*copies)[i] = fxs_vk_find(v, scene);
        if (!error && !(*copies)[i])
            error = fxs_plan_say(why, FXS_ERR_ARGUMENT, "a scene was not uploaded", "");
    }
    return error;
}

/* Renders the frame, or window of one, that the plan has laid out. */
static int render(void *walk, fxs_message *why)
{
    fxs_vk_walk *w = walk;
    const fxs_vk_slot *slot = w->slot;
    int error = fill_buffers(w, why);
    error = error ? error : run_frame(w, why);
    if (!error && slot->result)
        *why = slot->why;
    error = error ? error : slot->result;
    if (error)
        return error;
    fxs_plan_take_pictures(&slot->plan, (const uint32_t *)slot->down->memory.mapped + FXS_VK_PICTURE);
    fill_stats(slot, w->v, w->stats);
    w->nanoseconds += w->v->nanoseconds;
    w->windows++;
    return 0;
}

int fxs_vulkan_render(fxs_vulkan *v, const fxs_request *request, fxs_stats *stats, fxs_message *why)
{
    fxs_stats of_frame;
    fxs_vk_walk w = {.v = v, .slot = v->slots, .stats = &of_frame};
    fxs_vk_scene **copies = 0;
    memset(&of_frame, 0, sizeof of_frame);
    int error = fxs_vk_begin_request(v, request, 1, &copies, why);
    if (error)
        return error;
    w.copies = copies;
    w.slot->request = *request;
    error = begin_plan(&w, why);
    error = !error ? fxs_plan_draw(&w.slot->plan, &v->rooms, render, &w, why)
            : error == FXS_ERR_STOPPED ? put_stopped(&w, why) : error;
    v->nanoseconds = w.nanoseconds;
    if (!error && stats)
        *stats = of_frame;
    if (error == FXS_ERR_MEMORY || error == FXS_ERR_DEVICE)
        fxs_vk_give_back(v);
    return error;
}
