/* Frames of the Vulkan back end in images of the caller. Images are copied from and to buffer FXS_COMPUTE_MEMORY, so a
 * queue with compute suffices; the shader `convert` changes pixels there. */
#include <string.h>

#include "vk.h"

enum { COLOURS = 1, DEPTHS = 2, OCCLUDERS = 4 };

static const struct format {
    VkFormat format;
    unsigned of;
    VkImageAspectFlags aspect;
    uint32_t in, out;              /* conversions */
} formats[] = {
    {VK_FORMAT_R8G8B8A8_UNORM, COLOURS, VK_IMAGE_ASPECT_COLOR_BIT, FXS_VK_AS_IS, FXS_VK_AS_IS},
    {VK_FORMAT_R8G8B8A8_SRGB, COLOURS, VK_IMAGE_ASPECT_COLOR_BIT, FXS_VK_AS_IS, FXS_VK_AS_IS},
    {VK_FORMAT_B8G8R8A8_UNORM, COLOURS, VK_IMAGE_ASPECT_COLOR_BIT, FXS_VK_SWAP, FXS_VK_SWAP},
    {VK_FORMAT_B8G8R8A8_SRGB, COLOURS, VK_IMAGE_ASPECT_COLOR_BIT, FXS_VK_SWAP, FXS_VK_SWAP},
    {VK_FORMAT_R32_UINT, DEPTHS | OCCLUDERS, VK_IMAGE_ASPECT_COLOR_BIT, FXS_VK_AS_IS, FXS_VK_AS_IS},
    {VK_FORMAT_R32_SFLOAT, DEPTHS | OCCLUDERS, VK_IMAGE_ASPECT_COLOR_BIT, FXS_VK_FROM_FLOAT, FXS_VK_TO_FLOAT},
    {VK_FORMAT_D32_SFLOAT, DEPTHS | OCCLUDERS, VK_IMAGE_ASPECT_DEPTH_BIT, FXS_VK_FROM_FLOAT, FXS_VK_TO_FLOAT},
    {VK_FORMAT_D16_UNORM, OCCLUDERS, VK_IMAGE_ASPECT_DEPTH_BIT, FXS_VK_FROM_16, 0}};

static const struct format *format_of(const fxs_vulkan_image *image)
{
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        if (formats[i].format == image->format)
            return &formats[i];
    return 0;
}

/* ---- Checks ------------------------------------------------------------------------------------------------------ */

static const char *fault_of(const fxs_vulkan *v, const fxs_vulkan_image *i, unsigned of, VkImageUsageFlags usage,
                            const fxs_camera *camera)
{
    const struct format *format = format_of(i);
    return !format || !(format->of & of) ? "its format is not supported"
           : !(i->usage & usage) ? usage == VK_IMAGE_USAGE_TRANSFER_DST_BIT
                                       ? "its usage lacks VK_IMAGE_USAGE_TRANSFER_DST_BIT"
                                       : "its usage lacks VK_IMAGE_USAGE_TRANSFER_SRC_BIT"
           : i->layer >= (i->layers ? i->layers : 1) ? "it has no such layer"
           : i->x > i->width || i->width - i->x < (uint32_t)camera->width || i->y > i->height ||
                     i->height - i->y < (uint32_t)camera->height
               ? "the picture does not fit in it"
           : i->after == VK_IMAGE_LAYOUT_UNDEFINED || i->after == VK_IMAGE_LAYOUT_PREINITIALIZED
               ? "its layout after the frame is none that an image can be given"
           : usage == VK_IMAGE_USAGE_TRANSFER_SRC_BIT && i->before == VK_IMAGE_LAYOUT_UNDEFINED
               ? "its layout before the frame discards its content"
           : of == DEPTHS && format->aspect == VK_IMAGE_ASPECT_DEPTH_BIT && !v->graphics
               ? "a queue without graphics cannot write its format" : 0;
}

static int is_float(const fxs_vulkan_image *image)
{
    return image->image && format_of(image)->in >= FXS_VK_FROM_FLOAT;
}

static int check_planes(const fxs_vulkan_target *t)
{
    return (!is_float(&t->depth) && !is_float(&t->occluder)) ||
           (t->plane_0 > 0 && t->plane_1 > 0 && (t->plane_0 < t->plane_1 || t->plane_1 < t->plane_0));
}

/* Returns 0, or the error of the first image that cannot be used. */
static int check_target(const fxs_vulkan *v, const fxs_vulkan_target *t, const fxs_camera *camera, fxs_message *why)
{
    const struct {
        const char *name;
        const fxs_vulkan_image *image;
        unsigned of;
        VkImageUsageFlags usage;
    } images[] = {{"the colour image: ", &t->colour, COLOURS, VK_IMAGE_USAGE_TRANSFER_DST_BIT},
                  {"the depth image: ", &t->depth, DEPTHS, VK_IMAGE_USAGE_TRANSFER_DST_BIT},
                  {"the occluder: ", &t->occluder, OCCLUDERS, VK_IMAGE_USAGE_TRANSFER_SRC_BIT},
                  {"the backdrop: ", &t->backdrop, COLOURS, VK_IMAGE_USAGE_TRANSFER_SRC_BIT}};
    for (size_t i = 0; i < sizeof images / sizeof *images; i++) {
        const char *fault = images[i].image->image
                                ? fault_of(v, images[i].image, images[i].of, images[i].usage, camera) : 0;
        if (fault)
            return fxs_plan_say(why, FXS_ERR_TARGET, images[i].name, fault);
    }
    return !t->colour.image && !t->depth.image
               ? fxs_plan_say(why, FXS_ERR_TARGET, "a target needs a colour image or a depth image", "")
           : t->backdrop.image && t->format != FXS_FORMAT_RGBA8
               ? fxs_plan_say(why, FXS_ERR_TARGET, "a backdrop needs the format RGBA8", "")
           : t->format > FXS_FORMAT_RGBA8_COVERAGE
               ? fxs_plan_say(why, FXS_ERR_UNSUPPORTED, "a target's format is RGBA8 or RGBA8_COVERAGE", "")
           : !check_planes(t)
               ? fxs_plan_say(why, FXS_ERR_TARGET, "plane_0 and plane_1 must be positive and differ", "") : 0;
}

/* ---- Commands ---------------------------------------------------------------------------------------------------- */

/* Moves an image from its layout `before` to the layout for a copy if it arrives, else from there to `after`. */
static void turn(const fxs_vk_walk *w, const fxs_vulkan_image *image, VkImageLayout layout, int arrives)
{
    const VkAccessFlags any = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
    const VkAccessFlags copies = VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
    const VkImageMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER, .srcAccessMask = arrives ? any : copies,
        .dstAccessMask = arrives ? copies : any, .oldLayout = arrives ? image->before : layout,
        .newLayout = arrives ? layout : image->after,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED, .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image->image, .subresourceRange = {format_of(image)->aspect, 0, 1, image->layer, 1}};
    const VkPipelineStageFlags all = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT;
    w->v->vk.CmdPipelineBarrier(w->commands, arrives ? all : VK_PIPELINE_STAGE_TRANSFER_BIT,
                                arrives ? VK_PIPELINE_STAGE_TRANSFER_BIT : all, 0, 0, 0, 0, 0, 1, &barrier);
}

static void copy(const fxs_vk_walk *w, uint32_t eye, const fxs_vulkan_image *image, uint64_t word, VkImageLayout layout)
{
    const fxs_vulkan *v = w->v;
    const int32_t *size = w->slot->plan.frames[eye].size;
    const VkBufferImageCopy region = {
        .bufferOffset = w->slot->at[eye][FXS_COMPUTE_MEMORY] + 4 * word,
        .imageSubresource = {format_of(image)->aspect, 0, image->layer, 1},
        .imageOffset = {(int32_t)image->x, (int32_t)image->y, 0},
        .imageExtent = {(uint32_t)size[0], (uint32_t)size[1], 1}};
    turn(w, image, layout, 1);
    if (layout == VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL)
        v->vk.CmdCopyImageToBuffer(w->commands, image->image, layout, v->frame->buffer, 1, &region);
    else
        v->vk.CmdCopyBufferToImage(w->commands, v->frame->buffer, image->image, layout, 1, &region);
    turn(w, image, layout, 0);
}

/* Pixels of 16 bits are copied to the words of the finished picture, which the frame writes last. */
static uint64_t occluder_at(const fxs_vk_walk *w, uint32_t eye)
{
    const fxs_plan *plan = &w->slot->plan;
    return format_of(&w->targets[eye].occluder)->in == FXS_VK_FROM_16 ? plan->read_at[eye] : plan->frames[eye].occluder;
}

void fxs_vk_copy_in(const fxs_vk_walk *w)
{
    for (uint32_t eye = 0; eye < w->slot->eyes; eye++) {
        const fxs_vulkan_target *t = &w->targets[eye];
        if (t->occluder.image)
            copy(w, eye, &t->occluder, occluder_at(w, eye), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
        if (t->backdrop.image)
            copy(w, eye, &t->backdrop, w->slot->plan.frames[eye].backdrop, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    }
}

void fxs_vk_copy_out(const fxs_vk_walk *w)
{
    for (uint32_t eye = 0; eye < w->slot->eyes; eye++) {
        const fxs_vulkan_target *t = &w->targets[eye];
        const fxs_compute_frame *f = &w->slot->plan.frames[eye];
        if (t->colour.image)
            copy(w, eye, &t->colour, f->colour, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
        if (t->depth.image)
            copy(w, eye, &t->depth, f->median_depth, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    }
}

static void convert(fxs_vk_walk *w, uint32_t eye, const fxs_vulkan_image *image, int out, uint64_t from, uint64_t to)
{
    const fxs_vulkan *v = w->v;
    const fxs_compute_frame *f = &w->slot->plan.frames[eye];
    const struct format *format = image->image ? format_of(image) : formats;
    const uint32_t pixels = (uint32_t)f->size[0] * (uint32_t)f->size[1];
    const uint32_t groups = (pixels + FXS_COMPUTE_THREADS - 1) / FXS_COMPUTE_THREADS;
    const fxs_vk_conversion push = {out ? format->out : format->in, pixels, (uint32_t)from, (uint32_t)to,
                                    f->depth_bits, {1 / w->targets[eye].plane_0, 1 / w->targets[eye].plane_1}};
    const fxs_step step = {
        .program = FXS_VK_CONVERT, .waits = 1, .eye = eye, .arguments = FXS_PLAN_NONE,
        .groups = {groups < FXS_COMPUTE_ROW ? groups : FXS_COMPUTE_ROW,
                   (groups + FXS_COMPUTE_ROW - 1) / FXS_COMPUTE_ROW},
        .buffers = {FXS_COMPUTE_MEMORY, FXS_PLAN_NONE, FXS_PLAN_NONE, FXS_PLAN_NONE}};
    if (push.kind == FXS_VK_AS_IS)
        return;
    if (w->commands)
        v->vk.CmdPushConstants(w->commands, v->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
    fxs_vk_take_step(w, &step);
}

void fxs_vk_convert_in(fxs_vk_walk *w)
{
    for (uint32_t eye = 0; eye < w->slot->eyes; eye++) {
        const fxs_vulkan_target *t = &w->targets[eye];
        const fxs_compute_frame *f = &w->slot->plan.frames[eye];
        if (t->occluder.image)
            convert(w, eye, &t->occluder, 0, occluder_at(w, eye), f->occluder);
        convert(w, eye, &t->backdrop, 0, f->backdrop, f->backdrop);
    }
}

void fxs_vk_convert_out(fxs_vk_walk *w)
{
    for (uint32_t eye = 0; eye < w->slot->eyes; eye++) {
        const fxs_vulkan_target *t = &w->targets[eye];
        const fxs_compute_frame *f = &w->slot->plan.frames[eye];
        convert(w, eye, &t->colour, 1, f->colour, f->colour);
        convert(w, eye, &t->depth, 1, f->median_depth, f->median_depth);
    }
}

/* ---- Calls ------------------------------------------------------------------------------------------------------- */

/* The caller's images in place of the request's targets. The colour images are placeholders for the checks of
   fxs_plan_begin, and lie apart. */
static fxs_request request_of(const fxs_request *request, const fxs_vulkan_target *targets)
{
    fxs_request own = *request;
    for (uint32_t eye = 0; eye < own.eyes; eye++) {
        const ptrdiff_t row = 4 * (ptrdiff_t)own.cameras->width;
        fxs_targets_init(&own.targets[eye]);
        own.targets[eye].rates = request->targets[eye].rates;
        own.targets[eye].format = targets[eye].format;
        own.targets[eye].depth_bits = targets[eye].depth_bits;
        own.targets[eye].colour = (fxs_image){(unsigned char *)(uintptr_t)(64 + eye * row), own.eyes * row};
    }
    return own;
}

void fxs_vk_ask_planes(fxs_targets *t, const fxs_vulkan_target *target)
{
    const fxs_image wanted = t->colour, none = {0, 0};
    t->colour = target->colour.image ? wanted : none;
    t->median_depth = target->depth.image ? wanted : none;
    t->occluder = target->occluder.image ? wanted : none;
    t->backdrop = target->backdrop.image ? wanted : none;
}

/* Starts a call: those before it have ended, but for options.frames - 1. */
static int start(fxs_vulkan *v, fxs_message *why)
{
    fxs_vk_collect(v);
    if (v->late) {
        const int error = v->late;
        *why = v->late_why;
        v->late = 0;
        return error;
    }
    if (v->slots[1 + v->call % v->options.frames].serial)
        return fxs_plan_say(why, FXS_ERR_ARGUMENT, "too many frames are in flight: wait for one, or raise ",
                            "fxs_vulkan_options.frames");
    if (v->call >= v->options.frames && v->ended < v->call - v->options.frames + 1)
        v->ended = v->call - v->options.frames + 1;
    return 0;
}

/* Does all that may fail. */
static int prepare(fxs_vk_walk *w, const fxs_request *request, const fxs_vulkan_target *targets, fxs_message *why)
{
    fxs_vulkan *v = w->v;
    fxs_vk_scene **copies = 0;
    int error = start(v, why);
    error = error ? error : fxs_vk_begin_request(v, request, 0, &copies, why);
    for (uint32_t eye = 0; !error && eye < request->eyes; eye++)
        error = check_target(v, &targets[eye], &request->cameras[eye], why);
    if (error)
        return error;
    w->slot = &v->slots[1 + v->call % v->options.frames];
    w->copies = copies;
    w->targets = targets;
    w->slot->request = request_of(request, targets);
    return fxs_vk_prepare(w, why);
}

static void record(fxs_vk_walk *w, VkCommandBuffer commands)
{
    w->commands = commands;
    fxs_vk_record(w);
    w->v->call++;
}

int fxs_vulkan_record(fxs_vulkan *v, const fxs_request *request, const fxs_vulkan_target *targets,
                      VkCommandBuffer commands, fxs_message *why)
{
    fxs_vk_walk w = {.v = v};
    const int error = prepare(&w, request, targets, why);
    if (!error)
        record(&w, commands);
    return error;
}

static VkResult submit(fxs_vulkan *v, VkCommandBuffer commands, const fxs_vulkan_sync *s)
{
    enum { MOST = 16 };
    VkPipelineStageFlags stages[MOST];
    for (int i = 0; i < MOST; i++)
        stages[i] = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT;
    const VkTimelineSemaphoreSubmitInfo values = {
        .sType = VK_STRUCTURE_TYPE_TIMELINE_SEMAPHORE_SUBMIT_INFO,
        .waitSemaphoreValueCount = s->wait_values ? s->wait_count : 0, .pWaitSemaphoreValues = s->wait_values,
        .signalSemaphoreValueCount = s->signal_values ? s->signal_count : 0,
        .pSignalSemaphoreValues = s->signal_values};
    const VkSubmitInfo info = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                               .pNext = s->wait_values || s->signal_values ? &values : 0,
                               .waitSemaphoreCount = s->wait_count, .pWaitSemaphores = s->waits,
                               .pWaitDstStageMask = stages, .commandBufferCount = 1, .pCommandBuffers = &commands,
                               .signalSemaphoreCount = s->signal_count, .pSignalSemaphores = s->signals};
    const VkResult result = v->vk.EndCommandBuffer(commands);
    return result ? result : v->vk.QueueSubmit(v->options.queue, 1, &info, s->fence);
}

int fxs_vulkan_submit(fxs_vulkan *v, const fxs_request *request, const fxs_vulkan_target *targets,
                      const fxs_vulkan_sync *sync, fxs_message *why)
{
    static const fxs_vulkan_sync none;
    fxs_vk_walk w = {.v = v};
    sync = sync ? sync : &none;
    if (sync->wait_count > 16)
        return fxs_plan_say(why, FXS_ERR_ARGUMENT, "more than 16 semaphores to wait for", "");
    int error = prepare(&w, request, targets, why);
    error = error ? error : fxs_vk_begin(v, w.slot, why);
    if (error)
        return error;
    record(&w, w.slot->commands);
    error = fxs_vk_said(submit(v, w.slot->commands, sync), why);
    if (error) {
        v->call--;
        if (w.slot->chunks)
            fxs_vk_forget_chunks(v);
        fxs_vk_drop_slot(v, w.slot);
    }
    return error;
}

void fxs_vulkan_idle(fxs_vulkan *v)
{
    uint32_t lost = 0;
    fxs_vk_collect(v);
    for (int i = 0; i < FXS_VK_SLOTS; i++) {
        lost += v->slots[i].serial ? v->slots[i].chunks : 0;
        v->slots[i].serial = 0;
    }
    if (lost)
        fxs_vk_forget_chunks(v);
    v->ended = v->call;
    fxs_vk_collect(v);
}
