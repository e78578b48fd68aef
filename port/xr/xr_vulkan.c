/* A session of OpenXR by Vulkan (XR_KHR_vulkan_enable2): the runtime makes the device, the back end for Vulkan draws
 * both eyes to the layers of the swapchain's images in one submission. */
#include "xr_internal.h"

#ifdef FXS_XR_BY_VULKAN

#include <stdlib.h>

#include <fixsplat/internal/message.h>

#include "port/vulkan/vulkan_device.h"

enum { FAMILIES = 16, FRAMES = 2 };
#define FENCE_TIMEOUT 10000000000u         /* nanoseconds */

typedef struct vulkan_graphics {
    fxs_vulkan_device device;
    fxs_vulkan *vulkan;
    XrGraphicsBindingVulkan2KHR binding;
    VkFence fences[FRAMES];
    int pending[FRAMES];                   /* 1: a frame was submitted with the fence */
    uint32_t frame;
} vulkan_graphics;

/* A function of Vulkan, by `g`. */
#define VK(name) ((PFN_vk##name)(void (*)(void))g->device.options.load(g->device.options.instance, "vk" #name))

static int say(VkResult result, const char *call, fxs_message *why)
{
    return result >= 0 ? 0 : fxs_fail_as(FXS_ERR_DEVICE, why, "Vulkan: %s: error %d", call, (int)result);
}

/* ---- Device ------------------------------------------------------------------------------------------------------ */

static int ask_requirements(fxs_xr *xr, fxs_message *why)
{
    XrGraphicsRequirementsVulkan2KHR needs = {.type = XR_TYPE_GRAPHICS_REQUIREMENTS_VULKAN2_KHR};
    PFN_xrVoidFunction ask;
    const int error = fxs_xr_find(xr, "xrGetVulkanGraphicsRequirements2KHR", &ask, why);
    return error ? error : fxs_xr_check(xr, ((PFN_xrGetVulkanGraphicsRequirements2KHR)ask)(xr->instance, xr->system,
                                        &needs), "xrGetVulkanGraphicsRequirements2KHR", why);
}

static int make_instance(fxs_xr *xr, vulkan_graphics *g, fxs_message *why)
{
    const VkApplicationInfo application = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .pEngineName = "fixsplat",
                                           .engineVersion = FXS_VERSION_NUMBER, .apiVersion = VK_API_VERSION_1_1};
    const VkInstanceCreateInfo own = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                      .pApplicationInfo = &application};
    const XrVulkanInstanceCreateInfoKHR info = {
        .type = XR_TYPE_VULKAN_INSTANCE_CREATE_INFO_KHR, .systemId = xr->system,
        .pfnGetInstanceProcAddr = g->device.options.load, .vulkanCreateInfo = &own};
    VkResult result = 0;
    PFN_xrVoidFunction create;
    int error = fxs_xr_find(xr, "xrCreateVulkanInstanceKHR", &create, why);
    error = error ? error : fxs_xr_check(xr, ((PFN_xrCreateVulkanInstanceKHR)create)(xr->instance, &info,
                                         &g->device.options.instance, &result), "xrCreateVulkanInstanceKHR", why);
    return error ? error : say(result, "vkCreateInstance", why);
}

static int find_device(fxs_xr *xr, vulkan_graphics *g, fxs_message *why)
{
    const XrVulkanGraphicsDeviceGetInfoKHR info = {.type = XR_TYPE_VULKAN_GRAPHICS_DEVICE_GET_INFO_KHR,
                                                   .systemId = xr->system,
                                                   .vulkanInstance = g->device.options.instance};
    const VkQueueFlags needed = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;      /* graphics, to write depths */
    VkQueueFamilyProperties families[FAMILIES];
    uint32_t count = FAMILIES;
    PFN_xrVoidFunction find;
    int error = fxs_xr_find(xr, "xrGetVulkanGraphicsDevice2KHR", &find, why);
    error = error ? error : fxs_xr_check(xr, ((PFN_xrGetVulkanGraphicsDevice2KHR)find)(xr->instance, &info,
                                         &g->device.options.physical), "xrGetVulkanGraphicsDevice2KHR", why);
    if (error)
        return error;
    VK(GetPhysicalDeviceQueueFamilyProperties)(g->device.options.physical, &count, families);
    for (uint32_t i = 0; i < count; i++)
        if ((families[i].queueFlags & needed) == needed) {
            g->device.options.family = i;
            return 0;
        }
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "the headset's GPU has no queue with graphics and compute");
}

static int make_device(fxs_xr *xr, vulkan_graphics *g, fxs_message *why)
{
    const float priority = 1;
    const VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, .queueCount = 1,
                                           .queueFamilyIndex = g->device.options.family, .pQueuePriorities = &priority};
    const VkDeviceCreateInfo own = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, .queueCreateInfoCount = 1,
                                    .pQueueCreateInfos = &queue};
    const XrVulkanDeviceCreateInfoKHR info = {
        .type = XR_TYPE_VULKAN_DEVICE_CREATE_INFO_KHR, .systemId = xr->system,
        .pfnGetInstanceProcAddr = g->device.options.load, .vulkanPhysicalDevice = g->device.options.physical,
        .vulkanCreateInfo = &own};
    VkResult result = 0;
    PFN_xrVoidFunction create;
    int error = fxs_xr_find(xr, "xrCreateVulkanDeviceKHR", &create, why);
    error = error ? error : fxs_xr_check(xr, ((PFN_xrCreateVulkanDeviceKHR)create)(xr->instance, &info,
                                         &g->device.options.device, &result), "xrCreateVulkanDeviceKHR", why);
    error = error ? error : say(result, "vkCreateDevice", why);
    if (!error)
        VK(GetDeviceQueue)(g->device.options.device, g->device.options.family, 0, &g->device.options.queue);
    return error;
}

static int make_fences(vulkan_graphics *g, fxs_message *why)
{
    const VkFenceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    int error = 0;
    for (int i = 0; i < FRAMES && !error; i++)
        error = say(VK(CreateFence)(g->device.options.device, &info, 0, &g->fences[i]), "vkCreateFence", why);
    return error;
}

static int open_vulkan(fxs_xr *xr, fxs_message *why)
{
    vulkan_graphics *g = xr->device = calloc(1, sizeof *g);
    if (!g)
        return fxs_fail_memory(why, 0, sizeof *g);
    fxs_vulkan_options_init(&g->device.options);
    g->device.options.frames = FRAMES;
    g->device.options.max_memory = xr->options.max_memory;
    int error = fxs_vulkan_load(&g->device.options.load, why);
    error = error ? error : ask_requirements(xr, why);
    error = error ? error : make_instance(xr, g, why);
    error = error ? error : find_device(xr, g, why);
    error = error ? error : make_device(xr, g, why);
    error = error ? error : make_fences(g, why);
    if (error)
        return error;
    g->binding = (XrGraphicsBindingVulkan2KHR){
        .type = XR_TYPE_GRAPHICS_BINDING_VULKAN2_KHR, .instance = g->device.options.instance,
        .physicalDevice = g->device.options.physical, .device = g->device.options.device,
        .queueFamilyIndex = g->device.options.family};
    xr->binding = &g->binding;
    return 0;
}

static int ready_vulkan(fxs_xr *xr, fxs_message *why)
{
    vulkan_graphics *g = xr->device;
    const int error = fxs_vulkan_create(&g->vulkan, &g->device.options, why);
    xr->info.device = error ? 0 : fxs_vulkan_get_info(g->vulkan).name;
    return error;
}

static void end_vulkan(fxs_xr *xr)
{
    const vulkan_graphics *g = xr->device;
    if (g->device.options.device)
        VK(DeviceWaitIdle)(g->device.options.device);
}

static void close_vulkan(fxs_xr *xr)
{
    vulkan_graphics *g = xr->device;
    fxs_vulkan_destroy(g->vulkan);
    for (int i = 0; i < FRAMES; i++)
        if (g->fences[i])
            VK(DestroyFence)(g->device.options.device, g->fences[i], 0);
    fxs_vulkan_close_device(&g->device);
    free(g);
}

/* ---- Frames ------------------------------------------------------------------------------------------------------ */

static int upload(fxs_xr *xr, const fxs_scene *scene, fxs_message *why)
{
    return fxs_vulkan_upload(((const vulkan_graphics *)xr->device)->vulkan, scene, why);
}

static void forget(fxs_xr *xr, const fxs_scene *scene)
{
    fxs_vulkan_drop(((const vulkan_graphics *)xr->device)->vulkan, scene);
}

/* OpenXR hands out images in the layout of an attachment, and takes them back so. */
static fxs_vulkan_image image_of(const fxs_xr *xr, int which, uint32_t eye)
{
    const fxs_xr_chain *chain = &xr->chains[which];
    const XrSwapchainImageVulkan2KHR *images = (const void *)xr->images[which];
    const VkImageLayout layout = which == FXS_XR_DEPTH ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL
                                                       : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    if (!chain->handle)
        return (fxs_vulkan_image){.image = VK_NULL_HANDLE};
    return (fxs_vulkan_image){.image = images[chain->image].image, .format = (VkFormat)chain->format,
                              .usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT, .width = (uint32_t)xr->info.full_width,
                              .height = (uint32_t)xr->info.full_height, .layers = 2, .layer = eye, .before = layout,
                              .after = layout};
}

/* Waits until the frame before the last one has ended. */
static int wait_for_frame(vulkan_graphics *g, fxs_message *why)
{
    const VkFence fence = g->fences[g->frame % FRAMES];
    if (!g->pending[g->frame % FRAMES])
        return 0;
    const VkResult result = VK(WaitForFences)(g->device.options.device, 1, &fence, VK_TRUE, FENCE_TIMEOUT);
    if (result == VK_TIMEOUT)
        return fxs_fail_as(FXS_ERR_DEVICE, why, "Vulkan: a frame takes more than 10 seconds");
    g->pending[g->frame % FRAMES] = 0;
    return result ? say(result, "vkWaitForFences", why)
                  : say(VK(ResetFences)(g->device.options.device, 1, &fence), "vkResetFences", why);
}

static int draw(fxs_xr *xr, const fxs_request *request, uint32_t *drawn, fxs_message *why)
{
    vulkan_graphics *g = xr->device;
    fxs_vulkan_target targets[2];
    fxs_stats stats;
    const fxs_vulkan_sync sync = {.fence = g->fences[g->frame % FRAMES]};
    int error = wait_for_frame(g, why);
    if (error)
        return error;
    for (uint32_t eye = 0; eye < 2; eye++)
        targets[eye] = (fxs_vulkan_target){
            .format = xr->info.passes_through ? FXS_FORMAT_RGBA8_COVERAGE : FXS_FORMAT_RGBA8,
            .plane_0 = (float)(FXS_XR_NEAR * xr->place.units), .plane_1 = (float)(FXS_XR_FAR * xr->place.units),
            .colour = image_of(xr, FXS_XR_COLOUR, eye), .depth = image_of(xr, FXS_XR_DEPTH, eye)};
    *drawn = fxs_vulkan_stats(g->vulkan, &stats, why) ? 0 : stats.drawn;
    error = fxs_vulkan_submit(g->vulkan, request, targets, &sync, why);
    if (error)
        return error;
    g->pending[g->frame++ % FRAMES] = 1;
    xr->info.nanoseconds = fxs_vulkan_get_info(g->vulkan).nanoseconds;
    return 0;
}

const fxs_xr_graphics fxs_xr_vulkan = {
    .extensions = {XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME},
    .formats = {{VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_B8G8R8A8_SRGB, VK_FORMAT_R8G8B8A8_UNORM}, {VK_FORMAT_D32_SFLOAT}},
    .usage = {XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT | XR_SWAPCHAIN_USAGE_TRANSFER_DST_BIT,
              XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | XR_SWAPCHAIN_USAGE_TRANSFER_DST_BIT},
    .image_type = XR_TYPE_SWAPCHAIN_IMAGE_VULKAN2_KHR, .image_size = sizeof(XrSwapchainImageVulkan2KHR),
    .open = open_vulkan, .ready = ready_vulkan, .upload = upload, .forget = forget, .draw = draw, .delay = FRAMES,
    .end = end_vulkan, .close = close_vulkan
};

#endif
