/* Shows Vulkan frames on a surface of the caller: a device with a swapchain. Frames are drawn into one of two pictures,
   and the other is copied to the swapchain. */
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/message.h>
#include "src/core/sized.h"
#include "vulkan_device.h"

enum { IMAGES = 8, TRIES = 4, FAMILIES = 16, FORMATS = 64, PICTURES = 2 };

struct picture {
    VkImage image;
    VkDeviceMemory memory;
    uint32_t width, height;
    VkFence drawn;
    int pending;                   /* true if the fence will be signalled */
};

struct image {
    VkImage image;
    VkImageView view;
    VkFramebuffer framebuffer;
    VkSemaphore finished;
};

struct fxs_vulkan_window {
    fxs_vulkan_window_options options;
    fxs_vulkan_device device;
    fxs_vulkan *vulkan;
    pthread_mutex_t queue;         /* held by the thread that uses the queue */
    VkSurfaceKHR surface;
    VkSurfaceFormatKHR format;
    struct picture pictures[PICTURES];
    int shown;                     /* number of the picture to show; fxs_vulkan_window_draw draws the other */
    VkRenderPass pass;
    VkCommandPool pool;
    VkCommandBuffer commands;
    VkFence presented;
    int pending;                   /* true if `presented` will be signalled */
    VkSwapchainKHR swapchain;
    VkExtent2D extent;
    VkSemaphore acquired;
    uint32_t count;                /* number of images of the swapchain */
    struct image images[IMAGES];
};

#define CALL(name) ((PFN_vk##name)w->device.options.load(w->device.options.instance, "vk" #name))
#define DEVICE (w->device.options.device)

static int said(VkResult result, fxs_message *why)
{
    if (result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY)
        return fxs_fail_as(FXS_ERR_MEMORY, why, "the device is out of memory");
    return result ? fxs_fail_as(FXS_ERR_DEVICE, why, "the window's device or surface was lost (error %d)", (int)result)
                  : 0;
}

static VkResult wait_for_queue(fxs_vulkan_window *w)
{
    pthread_mutex_lock(&w->queue);
    const VkResult result = CALL(QueueWaitIdle)(w->device.options.queue);
    pthread_mutex_unlock(&w->queue);
    return result;
}

/* Waits for a fence that was given to a submission, and resets it. */
static VkResult wait_for(fxs_vulkan_window *w, VkFence fence, int *pending)
{
    VkResult result = *pending ? CALL(WaitForFences)(DEVICE, 1, &fence, VK_TRUE, UINT64_MAX) : VK_SUCCESS;
    if (*pending && !result)
        result = CALL(ResetFences)(DEVICE, 1, &fence);
    *pending = *pending && result;
    return result;
}

/* ---- Pictures ---------------------------------------------------------------------------------------------------- */

static const VkImageUsageFlags picture_usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;

static void drop_picture(fxs_vulkan_window *w, struct picture *p)
{
    CALL(DestroyImage)(DEVICE, p->image, 0);
    CALL(FreeMemory)(DEVICE, p->memory, 0);
    p->image = VK_NULL_HANDLE;
    p->memory = VK_NULL_HANDLE;
}

static VkResult allocate(fxs_vulkan_window *w, struct picture *p)
{
    VkPhysicalDeviceMemoryProperties types;
    VkMemoryRequirements needs;
    CALL(GetImageMemoryRequirements)(DEVICE, p->image, &needs);
    CALL(GetPhysicalDeviceMemoryProperties)(w->device.options.physical, &types);
    VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size};
    while (info.memoryTypeIndex < types.memoryTypeCount &&
           (!(needs.memoryTypeBits >> info.memoryTypeIndex & 1) ||
            !(types.memoryTypes[info.memoryTypeIndex].propertyFlags & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT)))
        info.memoryTypeIndex++;
    if (info.memoryTypeIndex == types.memoryTypeCount)
        return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    const VkResult result = CALL(AllocateMemory)(DEVICE, &info, 0, &p->memory);
    return result ? result : CALL(BindImageMemory)(DEVICE, p->image, p->memory, 0);
}

/* Makes a picture of this size. Commands that read the old one may be under way. */
static VkResult resize_picture(fxs_vulkan_window *w, struct picture *p, uint32_t width, uint32_t height)
{
    const VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, .imageType = VK_IMAGE_TYPE_2D,
                                    .format = w->format.format, .extent = {width, height, 1}, .mipLevels = 1,
                                    .arrayLayers = 1, .samples = VK_SAMPLE_COUNT_1_BIT, .usage = picture_usage};
    if (p->image && p->width == width && p->height == height)
        return VK_SUCCESS;
    VkResult result = CALL(QueueWaitIdle)(w->device.options.queue);
    drop_picture(w, p);
    result = result ? result : CALL(CreateImage)(DEVICE, &info, 0, &p->image);
    result = result ? result : allocate(w, p);
    p->width = width;
    p->height = height;
    if (result)
        drop_picture(w, p);
    return result;
}

static int submit(fxs_vulkan_window *w, struct picture *p, const fxs_request *request, fxs_message *why)
{
    const uint32_t width = (uint32_t)request->cameras->width, height = (uint32_t)request->cameras->height;
    const fxs_vulkan_sync sync = {.fence = p->drawn};
    fxs_vulkan_target targets[2] = {{.format = FXS_FORMAT_RGBA8}, {.format = FXS_FORMAT_RGBA8}};
    int error = said(wait_for(w, p->drawn, &p->pending), why);
    error = error ? error : said(resize_picture(w, p, request->eyes * width, height), why);
    for (uint32_t eye = 0; eye < request->eyes; eye++)
        targets[eye].colour = (fxs_vulkan_image){
            .image = p->image, .format = w->format.format, .usage = picture_usage, .width = p->width,
            .height = p->height, .x = eye * width,
            .before = eye ? VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL : VK_IMAGE_LAYOUT_UNDEFINED,
            .after = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
    for (uint32_t i = 0; i < request->count && !error; i++)
        error = fxs_vulkan_upload(w->vulkan, fxs_object_at(request->objects, i)->scene, why);
    error = error ? error : fxs_vulkan_submit(w->vulkan, request, targets, &sync, why);
    p->pending = !error;
    return error;
}

int fxs_vulkan_window_draw(fxs_vulkan_window *w, const fxs_request *request, fxs_stats *stats, fxs_message *why)
{
    struct picture *p = &w->pictures[!w->shown];
    if (request->eyes < 1 || request->eyes > 2)
        return fxs_fail_as(FXS_ERR_ARGUMENT, why, "%s", fxs_strerror(FXS_ERR_ARGUMENT));
    pthread_mutex_lock(&w->queue);
    int error = submit(w, p, request, why);
    pthread_mutex_unlock(&w->queue);
    if (error || !stats)
        return error;
    error = said(wait_for(w, p->drawn, &p->pending), why);
    return error ? error : fxs_vulkan_stats(w->vulkan, stats, why);
}

void fxs_vulkan_window_turn(fxs_vulkan_window *w)
{
    w->shown = !w->shown;
}

/* ---- Surface and swapchain --------------------------------------------------------------------------------------- */

static const VkImageUsageFlags image_usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;

static void drop_swapchain(fxs_vulkan_window *w)
{
    for (uint32_t i = 0; i < IMAGES; i++) {
        CALL(DestroyFramebuffer)(DEVICE, w->images[i].framebuffer, 0);
        CALL(DestroyImageView)(DEVICE, w->images[i].view, 0);
        CALL(DestroySemaphore)(DEVICE, w->images[i].finished, 0);
        w->images[i] = (struct image){.image = VK_NULL_HANDLE};
    }
    CALL(DestroySemaphore)(DEVICE, w->acquired, 0);
    w->acquired = VK_NULL_HANDLE;
    if (w->swapchain)
        CALL(DestroySwapchainKHR)(DEVICE, w->swapchain, 0);
    w->swapchain = VK_NULL_HANDLE;
    w->count = 0;
}

static VkResult make_image(fxs_vulkan_window *w, struct image *i, VkImage image)
{
    const VkSemaphoreCreateInfo semaphore = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    const VkImageViewCreateInfo view = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO, .image = image,
                                        .viewType = VK_IMAGE_VIEW_TYPE_2D, .format = w->format.format,
                                        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    i->image = image;
    VkResult result = CALL(CreateSemaphore)(DEVICE, &semaphore, 0, &i->finished);
    result = result ? result : CALL(CreateImageView)(DEVICE, &view, 0, &i->view);
    const VkFramebufferCreateInfo framebuffer = {
        .sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO, .renderPass = w->pass, .attachmentCount = 1,
        .pAttachments = &i->view, .width = w->extent.width, .height = w->extent.height, .layers = 1};
    return result ? result : CALL(CreateFramebuffer)(DEVICE, &framebuffer, 0, &i->framebuffer);
}

static VkResult make_images(fxs_vulkan_window *w)
{
    const VkSemaphoreCreateInfo semaphore = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    VkImage images[IMAGES];
    VkResult result = CALL(CreateSemaphore)(DEVICE, &semaphore, 0, &w->acquired);
    w->count = IMAGES;
    result = result ? result : CALL(GetSwapchainImagesKHR)(DEVICE, w->swapchain, &w->count, images);
    result = result == VK_INCOMPLETE ? VK_ERROR_INITIALIZATION_FAILED : result;
    for (uint32_t i = 0; i < w->count && !result; i++)
        result = make_image(w, &w->images[i], images[i]);
    return result;
}

/* The identity leaves a turned display to the system. */
static VkSurfaceTransformFlagBitsKHR transform_of(const VkSurfaceCapabilitiesKHR *can)
{
    return can->supportedTransforms & VK_SURFACE_TRANSFORM_IDENTITY_BIT_KHR ? VK_SURFACE_TRANSFORM_IDENTITY_BIT_KHR
                                                                            : can->currentTransform;
}

static VkResult make_swapchain(fxs_vulkan_window *w, const VkSurfaceCapabilitiesKHR *can)
{
    const uint32_t most = can->maxImageCount && can->maxImageCount < IMAGES ? can->maxImageCount : IMAGES;
    const VkCompositeAlphaFlagsKHR alphas = can->supportedCompositeAlpha;
    const VkSwapchainCreateInfoKHR info = {
        .sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR, .surface = w->surface,
        .minImageCount = can->minImageCount < most ? can->minImageCount + 1 : most,
        .imageFormat = w->format.format, .imageColorSpace = w->format.colorSpace, .imageExtent = w->extent,
        .imageArrayLayers = 1, .imageUsage = image_usage, .preTransform = transform_of(can),
        .presentMode = VK_PRESENT_MODE_FIFO_KHR, .clipped = VK_TRUE,
        .compositeAlpha = alphas & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                              ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                              : (VkCompositeAlphaFlagBitsKHR)(alphas & (~alphas + 1))};
    VkResult result = CALL(CreateSwapchainKHR)(DEVICE, &info, 0, &w->swapchain);
    if (result)
        w->swapchain = VK_NULL_HANDLE;
    result = result ? result : make_images(w);
    if (result)
        drop_swapchain(w);
    return result;
}

/* Gives the swapchain the surface's size. A size of 0: the window shows nothing. */
static VkResult follow_size(fxs_vulkan_window *w, int stale)
{
    VkSurfaceCapabilitiesKHR can;
    VkResult result = CALL(GetPhysicalDeviceSurfaceCapabilitiesKHR)(w->device.options.physical, w->surface, &can);
    if (result)
        return result;
    VkExtent2D extent = can.currentExtent;
    if (extent.width == UINT32_MAX)
        extent = (VkExtent2D){w->options.width, w->options.height};
    const int same = extent.width == w->extent.width && extent.height == w->extent.height;
    w->extent = extent;
    if ((same && w->swapchain && !stale) || !extent.width || !extent.height)
        return VK_SUCCESS;
    result = wait_for_queue(w);
    drop_swapchain(w);
    return result ? result : make_swapchain(w, &can);
}

/* Pictures have the bytes of the other back ends only in a format without a conversion to sRGB. */
static int choose_format(fxs_vulkan_window *w, fxs_message *why)
{
    VkSurfaceFormatKHR formats[FORMATS];
    uint32_t count = FORMATS;
    const VkResult result =
        CALL(GetPhysicalDeviceSurfaceFormatsKHR)(w->device.options.physical, w->surface, &count, formats);
    for (uint32_t i = 0; result >= 0 && i < count; i++)
        if ((formats[i].format == VK_FORMAT_B8G8R8A8_UNORM || formats[i].format == VK_FORMAT_R8G8B8A8_UNORM) &&
            (!w->format.format || formats[i].format == w->format.format)) {
            w->format = formats[i];
            return 0;
        }
    return result < 0 ? said(result, why)
                      : fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "%s has no format of 8 bits for the window",
                                    w->device.name);
}

static int check_surface(fxs_vulkan_window *w, fxs_message *why)
{
    const fxs_vulkan_options *o = &w->device.options;
    VkQueueFamilyProperties families[FAMILIES];
    uint32_t count = FAMILIES;
    VkBool32 shows = VK_FALSE;
    VkSurfaceCapabilitiesKHR can;
    CALL(GetPhysicalDeviceQueueFamilyProperties)(o->physical, &count, families);
    VkResult result = CALL(GetPhysicalDeviceSurfaceSupportKHR)(o->physical, o->family, w->surface, &shows);
    result = result ? result : CALL(GetPhysicalDeviceSurfaceCapabilitiesKHR)(o->physical, w->surface, &can);
    if (result)
        return said(result, why);
    if (!shows || !(families[o->family].queueFlags & VK_QUEUE_GRAPHICS_BIT) ||
        (can.supportedUsageFlags & image_usage) != image_usage || can.minImageCount > IMAGES)
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "%s cannot draw into the window", w->device.name);
    return choose_format(w, why);
}

static void drop_surface(fxs_vulkan_window *w)
{
    if (w->surface)
        CALL(DestroySurfaceKHR)(w->device.options.instance, w->surface, 0);
    w->surface = VK_NULL_HANDLE;
}

static int make_surface(fxs_vulkan_window *w, fxs_message *why)
{
    const VkResult result = w->options.surface(w->options.argument, w->device.options.instance, &w->surface);
    if (result) {
        w->surface = VK_NULL_HANDLE;
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "Vulkan has no surface for this window (error %d)", (int)result);
    }
    const int error = check_surface(w, why);
    if (error)
        drop_surface(w);
    return error;
}

int fxs_vulkan_window_renew(fxs_vulkan_window *w, int make, fxs_message *why)
{
    const VkResult result = wait_for_queue(w);
    drop_swapchain(w);
    drop_surface(w);
    const int error = said(result, why);
    return error || !make ? error : make_surface(w, why);
}

void fxs_vulkan_window_resize(fxs_vulkan_window *w, uint32_t width, uint32_t height)
{
    w->options.width = width;
    w->options.height = height;
}

/* ---- Opening ----------------------------------------------------------------------------------------------------- */

static VkResult make_pass(fxs_vulkan_window *w)
{
    const VkAttachmentDescription image = {
        .format = w->format.format, .samples = VK_SAMPLE_COUNT_1_BIT, .loadOp = VK_ATTACHMENT_LOAD_OP_LOAD,
        .storeOp = VK_ATTACHMENT_STORE_OP_STORE, .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
        .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE, .initialLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
        .finalLayout = VK_IMAGE_LAYOUT_PRESENT_SRC_KHR};
    const VkAttachmentReference reference = {0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    const VkSubpassDescription subpass = {.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
                                          .colorAttachmentCount = 1, .pColorAttachments = &reference};
    const VkSubpassDependency after = {
        VK_SUBPASS_EXTERNAL, 0, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
        VK_ACCESS_TRANSFER_WRITE_BIT, VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT, 0};
    const VkRenderPassCreateInfo info = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO, .attachmentCount = 1,
                                         .pAttachments = &image, .subpassCount = 1, .pSubpasses = &subpass,
                                         .dependencyCount = 1, .pDependencies = &after};
    return CALL(CreateRenderPass)(DEVICE, &info, 0, &w->pass);
}

static VkResult make_objects(fxs_vulkan_window *w)
{
    const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                          .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                          .queueFamilyIndex = w->device.options.family};
    VkResult result = CALL(CreateFence)(DEVICE, &fence, 0, &w->presented);
    for (int i = 0; i < PICTURES && !result; i++)
        result = CALL(CreateFence)(DEVICE, &fence, 0, &w->pictures[i].drawn);
    result = result ? result : CALL(CreateCommandPool)(DEVICE, &pool, 0, &w->pool);
    const VkCommandBufferAllocateInfo one = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                             .commandPool = w->pool, .commandBufferCount = 1};
    result = result ? result : CALL(AllocateCommandBuffers)(DEVICE, &one, &w->commands);
    return result ? result : make_pass(w);
}

static int start(fxs_vulkan_window *w, fxs_message *why)
{
    const fxs_vulkan_window_options *o = &w->options;
    w->device.options.load = o->load;
    w->device.extensions = o->extensions;
    w->device.extension_count = o->extension_count;
    w->device.extension = VK_KHR_SWAPCHAIN_EXTENSION_NAME;
    int error = fxs_vulkan_choose_device(&w->device, (int)o->device, why);
    error = error ? error : make_surface(w, why);
    error = error ? error : fxs_vulkan_open_device(&w->device, why);
    w->device.options.frames = PICTURES;
    w->device.options.max_memory = o->max_memory;
    w->device.options.cache = o->cache;
    w->device.options.cache_bytes = o->cache_bytes;
    error = error ? error : fxs_vulkan_create(&w->vulkan, &w->device.options, why);
    return error ? error : said(make_objects(w), why);
}

static void end_device(fxs_vulkan_window *w)
{
    CALL(DeviceWaitIdle)(DEVICE);
    fxs_vulkan_destroy(w->vulkan);
    drop_swapchain(w);
    for (int i = 0; i < PICTURES; i++) {
        drop_picture(w, &w->pictures[i]);
        CALL(DestroyFence)(DEVICE, w->pictures[i].drawn, 0);
    }
    CALL(DestroyFence)(DEVICE, w->presented, 0);
    CALL(DestroyRenderPass)(DEVICE, w->pass, 0);
    CALL(DestroyCommandPool)(DEVICE, w->pool, 0);
}

void fxs_vulkan_window_close(fxs_vulkan_window *w)
{
    if (!w)
        return;
    if (DEVICE)
        end_device(w);
    drop_surface(w);
    fxs_vulkan_close_device(&w->device);
    pthread_mutex_destroy(&w->queue);
    free(w);
}

int fxs_vulkan_window_open(fxs_vulkan_window **out, const fxs_vulkan_window_options *options, fxs_message *why)
{
    fxs_vulkan_window *w = *out = calloc(1, sizeof *w);
    if (!w)
        return fxs_fail_memory(why, 0, sizeof *w);
    pthread_mutex_init(&w->queue, 0);
    int error = fxs_sized_read(&w->options, sizeof w->options, options);
    error = error || w->options.surface ? error : FXS_ERR_ARGUMENT;
    error = error ? fxs_fail_as(error, why, "%s", fxs_strerror(error)) : start(w, why);
    if (error) {
        fxs_vulkan_window_close(w);
        *out = 0;
    }
    return error;
}

fxs_vulkan_window_info fxs_vulkan_window_get_info(const fxs_vulkan_window *w)
{
    const fxs_vulkan_options *o = &w->device.options;
    return (fxs_vulkan_window_info){w->vulkan, o->load, o->instance, o->physical, o->device, w->pass, w->extent.width,
                                    w->extent.height};
}

/* ---- Showing ----------------------------------------------------------------------------------------------------- */

static void fill_image(fxs_vulkan_window *w, VkImage image, int drawn, uint32_t colour)
{
    const VkImageLayout layout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    const VkImageSubresourceRange all = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    const VkImageMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER, .dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
        .newLayout = layout, .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED, .image = image, .subresourceRange = all};
    const struct picture *p = &w->pictures[w->shown];
    const VkImageBlit blit = {{VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                              {{0, 0, 0}, {(int32_t)p->width, (int32_t)p->height, 1}},
                              {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                              {{0, 0, 0}, {(int32_t)w->extent.width, (int32_t)w->extent.height, 1}}};
    const VkClearColorValue clear = {{(float)(colour >> 24) / 255, (float)(colour >> 16 & 255) / 255,
                                      (float)(colour >> 8 & 255) / 255, 1}};
    CALL(CmdPipelineBarrier)(w->commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, 0, 0, 0,
                             1, &barrier);
    if (drawn && p->image)
        CALL(CmdBlitImage)(w->commands, p->image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, image, layout, 1, &blit,
                           VK_FILTER_NEAREST);
    else
        CALL(CmdClearColorImage)(w->commands, image, layout, &clear, 1, &all);
}

/* Submits the commands and presents the image when they have ended. */
static VkResult present(fxs_vulkan_window *w, uint32_t image)
{
    const VkPipelineStageFlags stage = VK_PIPELINE_STAGE_TRANSFER_BIT;
    const VkSemaphore *finished = &w->images[image].finished;
    const VkSubmitInfo work = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .waitSemaphoreCount = 1,
                               .pWaitSemaphores = &w->acquired, .pWaitDstStageMask = &stage, .commandBufferCount = 1,
                               .pCommandBuffers = &w->commands, .signalSemaphoreCount = 1,
                               .pSignalSemaphores = finished};
    const VkPresentInfoKHR info = {.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR, .waitSemaphoreCount = 1,
                                   .pWaitSemaphores = finished, .swapchainCount = 1, .pSwapchains = &w->swapchain,
                                   .pImageIndices = &image};
    pthread_mutex_lock(&w->queue);
    VkResult result = CALL(QueueSubmit)(w->device.options.queue, 1, &work, w->presented);
    w->pending = !result;
    result = result ? result : CALL(QueuePresentKHR)(w->device.options.queue, &info);
    pthread_mutex_unlock(&w->queue);
    return result;
}

struct show {
    int drawn;
    uint32_t colour;
    fxs_vulkan_overlay_fn *overlay;
    void *argument;
};

static VkResult record(fxs_vulkan_window *w, uint32_t image, const struct show *s)
{
    const VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                            .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    const VkRenderPassBeginInfo pass = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO, .renderPass = w->pass,
                                        .framebuffer = w->images[image].framebuffer,
                                        .renderArea = {{0, 0}, w->extent}};
    const VkResult result = CALL(BeginCommandBuffer)(w->commands, &begin);
    if (result)
        return result;
    fill_image(w, w->images[image].image, s->drawn, s->colour);
    CALL(CmdBeginRenderPass)(w->commands, &pass, VK_SUBPASS_CONTENTS_INLINE);
    if (s->overlay)
        s->overlay(s->argument, w->commands, w->extent.width, w->extent.height);
    CALL(CmdEndRenderPass)(w->commands);
    return CALL(EndCommandBuffer)(w->commands);
}

static VkResult show(fxs_vulkan_window *w, const struct show *s)
{
    uint32_t image = 0;
    VkResult result = wait_for(w, w->presented, &w->pending);
    result = result ? result : CALL(AcquireNextImageKHR)(DEVICE, w->swapchain, UINT64_MAX, w->acquired, VK_NULL_HANDLE,
                                                         &image);
    if (result && result != VK_SUBOPTIMAL_KHR)
        return result;
    result = record(w, image, s);
    return result ? result : present(w, image);
}

/* After a failure, the swapchain's semaphores may be signalled, so the next call makes them anew. */
int fxs_vulkan_window_show(fxs_vulkan_window *w, int drawn, uint32_t colour, fxs_vulkan_overlay_fn *overlay,
                           void *argument, fxs_message *why)
{
    const struct show all = {drawn, colour, overlay, argument};
    VkResult result = VK_ERROR_OUT_OF_DATE_KHR;
    for (int tries = 0; tries < TRIES && w->surface; tries++) {
        result = follow_size(w, tries);
        result = result || !w->extent.width || !w->extent.height ? result : show(w, &all);
        if (result >= 0)
            return 0;
        if (wait_for_queue(w) == VK_ERROR_DEVICE_LOST)
            break;
        drop_swapchain(w);
        if (result == VK_ERROR_SURFACE_LOST_KHR) {
            const int error = fxs_vulkan_window_renew(w, 1, why);
            if (error)
                return error;
        } else if (result != VK_ERROR_OUT_OF_DATE_KHR)
            break;
    }
    return !w->surface || result == VK_ERROR_OUT_OF_DATE_KHR ? 0 : said(result, why);
}
