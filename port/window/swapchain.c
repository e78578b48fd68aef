/* Shows Vulkan frames in an SDL window: a device with a swapchain, and panels that are blended on the device. */
#include "swapchain.h"

#ifdef FXS_WITH_VULKAN

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include <SDL2/SDL.h>
#include <SDL2/SDL_vulkan.h>

#include <fixsplat/system.h>
#include "port/vulkan/vulkan_device.h"
#include "src/core/sized.h"
#include "panel_shaders.h"

enum { IMAGES = 8, TRIES = 4, EXTENSIONS = 16, FAMILIES = 16, FORMATS = 64 };

struct picture {
    VkImage image;
    VkDeviceMemory memory;
    uint32_t width, height;
};

/* The push constants of panel.frag. */
struct place {
    int32_t at[2], extent[2], size[2], first;
};

struct fxs_screen {
    fxs_window *window;
    fxs_vulkan_device device;
    fxs_vulkan *vulkan;
    pthread_mutex_t queue;         /* held by the thread that uses the queue */
    VkSurfaceKHR surface;
    VkSurfaceFormatKHR format;
    struct picture pictures[2];
    int shown;                     /* number of the picture to show; `render` draws the other */
    VkFence drawn, presented;
    VkSemaphore acquired;
    VkCommandPool pool;
    VkCommandBuffer commands;

    VkRenderPass pass;
    VkDescriptorSetLayout set_layout;
    VkDescriptorPool sets;
    VkDescriptorSet set;
    VkPipelineLayout layout;
    VkPipeline pipeline;
    VkBuffer pixels;               /* of the panels */
    VkDeviceMemory pixel_memory;
    size_t pixel_bytes;
    uint32_t *mapped;

    VkSwapchainKHR swapchain;
    VkExtent2D extent;
    uint32_t count;                /* number of images of the swapchain */
    VkImage images[IMAGES];
    VkImageView views[IMAGES];
    VkFramebuffer framebuffers[IMAGES];
    VkSemaphore finished[IMAGES];
};

#define CALL(name) ((PFN_vk##name)s->device.options.load(s->device.options.instance, "vk" #name))
#define DEVICE (s->device.options.device)

static int said(VkResult result, fxs_message *why)
{
    if (result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY)
        return fxs_fail_as(FXS_ERR_MEMORY, why, "the device is out of memory");
    return result ? fxs_fail_as(FXS_ERR_DEVICE, why, "the window's device or surface was lost (error %d)", (int)result)
                  : 0;
}

/* ---- Memory ------------------------------------------------------------------------------------------------------ */

static VkResult allocate(fxs_screen *s, const VkMemoryRequirements *needs, VkMemoryPropertyFlags wanted,
                         VkDeviceMemory *memory)
{
    VkPhysicalDeviceMemoryProperties types;
    VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs->size};
    CALL(GetPhysicalDeviceMemoryProperties)(s->device.options.physical, &types);
    for (uint32_t i = 0; i < types.memoryTypeCount; i++)
        if (needs->memoryTypeBits >> i & 1 && (types.memoryTypes[i].propertyFlags & wanted) == wanted) {
            info.memoryTypeIndex = i;
            return CALL(AllocateMemory)(DEVICE, &info, 0, memory);
        }
    return VK_ERROR_OUT_OF_DEVICE_MEMORY;
}

static void drop_picture(fxs_screen *s, struct picture *p)
{
    CALL(DestroyImage)(DEVICE, p->image, 0);
    CALL(FreeMemory)(DEVICE, p->memory, 0);
    *p = (struct picture){.image = VK_NULL_HANDLE};
}

static const VkImageUsageFlags picture_usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;

/* Makes a picture of this size. Commands that read the old one may be under way. */
static VkResult resize_picture(fxs_screen *s, struct picture *p, uint32_t width, uint32_t height)
{
    const VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, .imageType = VK_IMAGE_TYPE_2D,
                                    .format = s->format.format, .extent = {width, height, 1}, .mipLevels = 1,
                                    .arrayLayers = 1, .samples = VK_SAMPLE_COUNT_1_BIT, .usage = picture_usage};
    VkMemoryRequirements needs;
    if (p->image && p->width == width && p->height == height)
        return VK_SUCCESS;
    CALL(QueueWaitIdle)(s->device.options.queue);
    drop_picture(s, p);
    VkResult result = CALL(CreateImage)(DEVICE, &info, 0, &p->image);
    if (result)
        return result;
    CALL(GetImageMemoryRequirements)(DEVICE, p->image, &needs);
    result = allocate(s, &needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, &p->memory);
    result = result ? result : CALL(BindImageMemory)(DEVICE, p->image, p->memory, 0);
    p->width = width;
    p->height = height;
    if (result)
        drop_picture(s, p);
    return result;
}

static void drop_pixels(fxs_screen *s)
{
    CALL(DestroyBuffer)(DEVICE, s->pixels, 0);
    CALL(FreeMemory)(DEVICE, s->pixel_memory, 0);
    s->pixels = VK_NULL_HANDLE;
    s->pixel_memory = VK_NULL_HANDLE;
    s->pixel_bytes = 0;
}

static VkResult fill_pixel_buffer(fxs_screen *s, size_t bytes)
{
    const VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = bytes,
                                     .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT};
    VkMemoryRequirements needs;
    VkResult result = CALL(CreateBuffer)(DEVICE, &info, 0, &s->pixels);
    if (result)
        return result;
    CALL(GetBufferMemoryRequirements)(DEVICE, s->pixels, &needs);
    result = allocate(s, &needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
                      &s->pixel_memory);
    result = result ? result : CALL(BindBufferMemory)(DEVICE, s->pixels, s->pixel_memory, 0);
    void *mapped = 0;
    result = result ? result : CALL(MapMemory)(DEVICE, s->pixel_memory, 0, VK_WHOLE_SIZE, 0, &mapped);
    s->mapped = mapped;
    return result;
}

/* Makes room for the pixels of panels. The commands of the last fxs_screen_show must have ended. */
static VkResult reserve_pixels(fxs_screen *s, size_t bytes)
{
    if (bytes <= s->pixel_bytes)
        return VK_SUCCESS;
    drop_pixels(s);
    const VkResult result = fill_pixel_buffer(s, bytes);
    if (result) {
        drop_pixels(s);
        return result;
    }
    s->pixel_bytes = bytes;
    const VkDescriptorBufferInfo buffer = {s->pixels, 0, VK_WHOLE_SIZE};
    const VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET, .dstSet = s->set,
                                        .descriptorCount = 1, .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                        .pBufferInfo = &buffer};
    CALL(UpdateDescriptorSets)(DEVICE, 1, &write, 0, 0);
    return VK_SUCCESS;
}

/* ---- Pipeline of the panels -------------------------------------------------------------------------------------- */

static VkResult make_pass(fxs_screen *s)
{
    const VkAttachmentDescription image = {
        .format = s->format.format, .samples = VK_SAMPLE_COUNT_1_BIT, .loadOp = VK_ATTACHMENT_LOAD_OP_LOAD,
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
    return CALL(CreateRenderPass)(DEVICE, &info, 0, &s->pass);
}

static VkResult make_layouts(fxs_screen *s)
{
    const VkDescriptorSetLayoutBinding binding = {0, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1,
                                                  VK_SHADER_STAGE_FRAGMENT_BIT, 0};
    const VkDescriptorSetLayoutCreateInfo set = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                                 .bindingCount = 1, .pBindings = &binding};
    const VkPushConstantRange push = {VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof(struct place)};
    const VkPipelineLayoutCreateInfo layout = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                               .setLayoutCount = 1, .pSetLayouts = &s->set_layout,
                                               .pushConstantRangeCount = 1, .pPushConstantRanges = &push};
    const VkDescriptorPoolSize one = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1};
    const VkDescriptorPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO, .maxSets = 1,
                                             .poolSizeCount = 1, .pPoolSizes = &one};
    VkResult result = CALL(CreateDescriptorSetLayout)(DEVICE, &set, 0, &s->set_layout);
    result = result ? result : CALL(CreatePipelineLayout)(DEVICE, &layout, 0, &s->layout);
    result = result ? result : CALL(CreateDescriptorPool)(DEVICE, &pool, 0, &s->sets);
    const VkDescriptorSetAllocateInfo all = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                             .descriptorPool = s->sets, .descriptorSetCount = 1,
                                             .pSetLayouts = &s->set_layout};
    return result ? result : CALL(AllocateDescriptorSets)(DEVICE, &all, &s->set);
}

static VkResult make_pipeline_of(fxs_screen *s, const VkPipelineShaderStageCreateInfo stages[2])
{
    static const VkDynamicState changes[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    const VkPipelineVertexInputStateCreateInfo input = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    const VkPipelineInputAssemblyStateCreateInfo assembly = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    const VkPipelineViewportStateCreateInfo viewport = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO, .viewportCount = 1, .scissorCount = 1};
    const VkPipelineRasterizationStateCreateInfo raster = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO, .lineWidth = 1};
    const VkPipelineMultisampleStateCreateInfo samples = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
    const VkPipelineColorBlendAttachmentState over = {
        VK_TRUE, VK_BLEND_FACTOR_SRC_ALPHA, VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA, VK_BLEND_OP_ADD,
        VK_BLEND_FACTOR_ONE, VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA, VK_BLEND_OP_ADD, 0xf};
    const VkPipelineColorBlendStateCreateInfo blend = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO, .attachmentCount = 1,
        .pAttachments = &over};
    const VkPipelineDynamicStateCreateInfo dynamic = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO, .dynamicStateCount = 2,
        .pDynamicStates = changes};
    const VkGraphicsPipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO, .stageCount = 2, .pStages = stages,
        .pVertexInputState = &input, .pInputAssemblyState = &assembly, .pViewportState = &viewport,
        .pRasterizationState = &raster, .pMultisampleState = &samples, .pColorBlendState = &blend,
        .pDynamicState = &dynamic, .layout = s->layout, .renderPass = s->pass};
    return CALL(CreateGraphicsPipelines)(DEVICE, VK_NULL_HANDLE, 1, &info, 0, &s->pipeline);
}

static VkResult make_pipeline(fxs_screen *s)
{
    const VkShaderModuleCreateInfo modules[2] = {
        {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = sizeof panel_vert, .pCode = panel_vert},
        {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = sizeof panel_frag, .pCode = panel_frag}};
    VkPipelineShaderStageCreateInfo stages[2];
    VkResult result = VK_SUCCESS;
    for (int i = 0; i < 2; i++) {
        stages[i] = (VkPipelineShaderStageCreateInfo){
            .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, .pName = "main",
            .stage = i ? VK_SHADER_STAGE_FRAGMENT_BIT : VK_SHADER_STAGE_VERTEX_BIT};
        result = result ? result : CALL(CreateShaderModule)(DEVICE, &modules[i], 0, &stages[i].module);
    }
    result = result ? result : make_pipeline_of(s, stages);
    for (int i = 0; i < 2; i++)
        CALL(DestroyShaderModule)(DEVICE, stages[i].module, 0);
    return result;
}

/* ---- Opening ----------------------------------------------------------------------------------------------------- */

static VkResult make_objects(fxs_screen *s)
{
    const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    const VkFenceCreateInfo signalled = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO,
                                         .flags = VK_FENCE_CREATE_SIGNALED_BIT};
    const VkSemaphoreCreateInfo semaphore = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                          .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                          .queueFamilyIndex = s->device.options.family};
    VkResult result = CALL(CreateFence)(DEVICE, &fence, 0, &s->drawn);
    result = result ? result : CALL(CreateFence)(DEVICE, &signalled, 0, &s->presented);
    result = result ? result : CALL(CreateSemaphore)(DEVICE, &semaphore, 0, &s->acquired);
    for (int i = 0; i < IMAGES && !result; i++)
        result = CALL(CreateSemaphore)(DEVICE, &semaphore, 0, &s->finished[i]);
    result = result ? result : CALL(CreateCommandPool)(DEVICE, &pool, 0, &s->pool);
    const VkCommandBufferAllocateInfo one = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                             .commandPool = s->pool, .commandBufferCount = 1};
    result = result ? result : CALL(AllocateCommandBuffers)(DEVICE, &one, &s->commands);
    result = result ? result : make_pass(s);
    result = result ? result : make_layouts(s);
    return result ? result : make_pipeline(s);
}

/* Pictures have the bytes of the other back ends only in a format without a conversion to sRGB. */
static int choose_format(fxs_screen *s, fxs_message *why)
{
    VkSurfaceFormatKHR formats[FORMATS];
    uint32_t count = FORMATS;
    const VkResult result =
        CALL(GetPhysicalDeviceSurfaceFormatsKHR)(s->device.options.physical, s->surface, &count, formats);
    for (uint32_t i = 0; result >= 0 && i < count; i++)
        if (formats[i].format == VK_FORMAT_B8G8R8A8_UNORM || formats[i].format == VK_FORMAT_R8G8B8A8_UNORM) {
            s->format = formats[i];
            return 0;
        }
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "%s has no format of 8 bits for the window", s->device.name);
}

static int make_surface(fxs_screen *s, fxs_message *why)
{
    VkQueueFamilyProperties families[FAMILIES];
    uint32_t count = FAMILIES;
    VkBool32 shows = VK_FALSE;
    VkSurfaceCapabilitiesKHR can;
    const VkImageUsageFlags usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    if (!SDL_Vulkan_CreateSurface(fxs_window_handle(s->window), s->device.options.instance, &s->surface))
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "%s", SDL_GetError());
    CALL(GetPhysicalDeviceQueueFamilyProperties)(s->device.options.physical, &count, families);
    CALL(GetPhysicalDeviceSurfaceSupportKHR)(s->device.options.physical, s->device.options.family, s->surface, &shows);
    if (!shows || !(families[s->device.options.family].queueFlags & VK_QUEUE_GRAPHICS_BIT) ||
         CALL(GetPhysicalDeviceSurfaceCapabilitiesKHR)(s->device.options.physical, s->surface, &can) ||
        (can.supportedUsageFlags & usage) != usage || can.minImageCount > IMAGES)
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "%s cannot draw into the window", s->device.name);
    return choose_format(s, why);
}

static int start(fxs_screen *s, const fxs_backend_options *options, fxs_message *why)
{
    const char *names[EXTENSIONS];
    unsigned count = EXTENSIONS;
    SDL_Window *window = fxs_window_handle(s->window);
    if (!(SDL_GetWindowFlags(window) & SDL_WINDOW_VULKAN) || !SDL_Vulkan_GetInstanceExtensions(window, &count, names))
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "SDL has no Vulkan here");
    void *const load = SDL_Vulkan_GetVkGetInstanceProcAddr();     /* a function's address */
    memcpy(&s->device.options.load, &load, sizeof load);
    s->device.extensions = names;
    s->device.extension_count = count;
    s->device.extension = VK_KHR_SWAPCHAIN_EXTENSION_NAME;
    int error = fxs_vulkan_choose_device(&s->device, options->device, why);
    error = error ? error : make_surface(s, why);
    error = error ? error : fxs_vulkan_open_device(&s->device, why);
    s->device.options.frames = 1;
    s->device.options.max_memory = options->max_memory;
    error = error ? error : fxs_vulkan_create(&s->vulkan, &s->device.options, why);
    return error ? error : said(make_objects(s), why);
}

static void drop_swapchain(fxs_screen *s)
{
    for (uint32_t i = 0; i < s->count; i++) {
        CALL(DestroyFramebuffer)(DEVICE, s->framebuffers[i], 0);
        CALL(DestroyImageView)(DEVICE, s->views[i], 0);
        s->framebuffers[i] = VK_NULL_HANDLE;
        s->views[i] = VK_NULL_HANDLE;
    }
    if (s->swapchain)
        CALL(DestroySwapchainKHR)(DEVICE, s->swapchain, 0);
    s->swapchain = VK_NULL_HANDLE;
    s->count = 0;
}

static void end_device(fxs_screen *s)
{
    CALL(DeviceWaitIdle)(DEVICE);
    fxs_vulkan_destroy(s->vulkan);
    drop_swapchain(s);
    drop_pixels(s);
    for (int i = 0; i < 2; i++)
        drop_picture(s, &s->pictures[i]);
    for (int i = 0; i < IMAGES; i++)
        CALL(DestroySemaphore)(DEVICE, s->finished[i], 0);
    CALL(DestroySemaphore)(DEVICE, s->acquired, 0);
    CALL(DestroyFence)(DEVICE, s->drawn, 0);
    CALL(DestroyFence)(DEVICE, s->presented, 0);
    CALL(DestroyPipeline)(DEVICE, s->pipeline, 0);
    CALL(DestroyPipelineLayout)(DEVICE, s->layout, 0);
    CALL(DestroyDescriptorPool)(DEVICE, s->sets, 0);
    CALL(DestroyDescriptorSetLayout)(DEVICE, s->set_layout, 0);
    CALL(DestroyRenderPass)(DEVICE, s->pass, 0);
    CALL(DestroyCommandPool)(DEVICE, s->pool, 0);
}

static void close_screen(void *self)
{
    fxs_screen *s = self;
    if (!s)
        return;
    if (DEVICE)
        end_device(s);
    if (s->surface)
        CALL(DestroySurfaceKHR)(s->device.options.instance, s->surface, 0);
    fxs_vulkan_close_device(&s->device);
    pthread_mutex_destroy(&s->queue);
    free(s);
}

int fxs_screen_open(fxs_screen **screen, fxs_window *window, const fxs_backend_options *options, fxs_message *why)
{
    fxs_screen *s = *screen = calloc(1, sizeof *s);
    if (!s)
        return fxs_fail_memory(why, 0, sizeof *s);
    s->window = window;
    pthread_mutex_init(&s->queue, 0);
    const int error = start(s, options, why);
    if (error) {
        close_screen(s);
        *screen = 0;
    }
    return error;
}

/* ---- Rendering --------------------------------------------------------------------------------------------------- */

static int submit(fxs_screen *s, const fxs_request *request, fxs_message *why)
{
    const uint32_t width = (uint32_t)request->cameras->width, height = (uint32_t)request->cameras->height;
    struct picture *p = &s->pictures[!s->shown];
    const fxs_vulkan_sync sync = {.fence = s->drawn};
    fxs_vulkan_target targets[2] = {{.format = FXS_FORMAT_RGBA8}, {.format = FXS_FORMAT_RGBA8}};
    int error = said(resize_picture(s, p, request->eyes * width, height), why);
    for (uint32_t eye = 0; eye < request->eyes; eye++)
        targets[eye].colour = (fxs_vulkan_image){
            .image = p->image, .format = s->format.format, .usage = picture_usage, .width = p->width,
            .height = p->height, .x = eye * width,
            .before = eye ? VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL : VK_IMAGE_LAYOUT_UNDEFINED,
            .after = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
    for (uint32_t i = 0; i < request->count && !error; i++)
        error = fxs_vulkan_upload(s->vulkan, fxs_object_at(request->objects, i)->scene, why);
    return error ? error : fxs_vulkan_submit(s->vulkan, request, targets, &sync, why);
}

/* The frame's time is the device's, if it has a clock. */
static int render(void *self, const fxs_request *request, fxs_stats *stats, fxs_message *why)
{
    fxs_screen *s = self;
    const uint64_t started = fxs_clock(0);
    pthread_mutex_lock(&s->queue);
    int error = submit(s, request, why);
    pthread_mutex_unlock(&s->queue);
    if (error)
        return error;
    error = said(CALL(WaitForFences)(DEVICE, 1, &s->drawn, VK_TRUE, UINT64_MAX), why);
    error = error ? error : said(CALL(ResetFences)(DEVICE, 1, &s->drawn), why);
    error = error ? error : fxs_vulkan_stats(s->vulkan, stats, why);
    if (error)
        return error;
    const uint64_t device = fxs_vulkan_get_info(s->vulkan).nanoseconds;
    stats->frame_nanoseconds = device ? device : fxs_clock(0) - started;
    return 0;
}

static void forget(void *self, const fxs_scene *scene)
{
    fxs_screen *s = self;
    fxs_vulkan_drop(s->vulkan, scene);
}

void fxs_screen_turn(fxs_screen *s)
{
    s->shown = !s->shown;
}

/* ---- Showing ----------------------------------------------------------------------------------------------------- */

static VkResult make_images(fxs_screen *s)
{
    VkResult result = CALL(GetSwapchainImagesKHR)(DEVICE, s->swapchain, &s->count, 0);
    if (!result && s->count > IMAGES) {
        s->count = 0;
        return VK_ERROR_INITIALIZATION_FAILED;
    }
    result = result ? result : CALL(GetSwapchainImagesKHR)(DEVICE, s->swapchain, &s->count, s->images);
    for (uint32_t i = 0; i < s->count && !result; i++) {
        const VkImageViewCreateInfo view = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO, .image = s->images[i],
                                            .viewType = VK_IMAGE_VIEW_TYPE_2D, .format = s->format.format,
                                            .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
        result = CALL(CreateImageView)(DEVICE, &view, 0, &s->views[i]);
        const VkFramebufferCreateInfo framebuffer = {
            .sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO, .renderPass = s->pass, .attachmentCount = 1,
            .pAttachments = &s->views[i], .width = s->extent.width, .height = s->extent.height, .layers = 1};
        result = result ? result : CALL(CreateFramebuffer)(DEVICE, &framebuffer, 0, &s->framebuffers[i]);
    }
    return result;
}

static VkResult make_swapchain(fxs_screen *s, const VkSurfaceCapabilitiesKHR *can)
{
    const uint32_t most = can->maxImageCount && can->maxImageCount < IMAGES ? can->maxImageCount : IMAGES;
    const VkCompositeAlphaFlagsKHR alphas = can->supportedCompositeAlpha;
    const VkSwapchainCreateInfoKHR info = {
        .sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR, .surface = s->surface,
        .minImageCount = can->minImageCount < most ? can->minImageCount + 1 : most,
        .imageFormat = s->format.format, .imageColorSpace = s->format.colorSpace, .imageExtent = s->extent,
        .imageArrayLayers = 1, .imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
        .preTransform = can->currentTransform, .presentMode = VK_PRESENT_MODE_FIFO_KHR, .clipped = VK_TRUE,
        .compositeAlpha = alphas & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                              ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                              : (VkCompositeAlphaFlagBitsKHR)(alphas & (~alphas + 1))};
    const VkResult result = CALL(CreateSwapchainKHR)(DEVICE, &info, 0, &s->swapchain);
    return result ? result : make_images(s);
}

/* Gives the swapchain the window's size. A size of 0: there is nothing to draw. */
static VkResult follow_size(fxs_screen *s, int stale)
{
    VkSurfaceCapabilitiesKHR can;
    VkResult result = CALL(GetPhysicalDeviceSurfaceCapabilitiesKHR)(s->device.options.physical, s->surface, &can);
    if (result)
        return result;
    VkExtent2D extent = can.currentExtent;
    if (extent.width == UINT32_MAX) {
        int width, height;
        fxs_window_size(s->window, &width, &height);
        extent = (VkExtent2D){(uint32_t)width, (uint32_t)height};
    }
    const int same = extent.width == s->extent.width && extent.height == s->extent.height;
    s->extent = extent;
    if ((same && s->swapchain && !stale) || !extent.width || !extent.height)
        return VK_SUCCESS;
    pthread_mutex_lock(&s->queue);
    result = CALL(QueueWaitIdle)(s->device.options.queue);
    pthread_mutex_unlock(&s->queue);
    drop_swapchain(s);
    return result ? result : make_swapchain(s, &can);
}

static size_t words_of(const fxs_canvas *picture)
{
    return (size_t)picture->width * (size_t)picture->height;
}

static void draw_panel(fxs_screen *s, const fxs_canvas *picture, struct place place)
{
    const int *at = place.at, *extent = place.extent;
    const int from[2] = {at[0] > 0 ? at[0] : 0, at[1] > 0 ? at[1] : 0};
    int to[2] = {at[0] + extent[0], at[1] + extent[1]};
    to[0] = to[0] < (int)s->extent.width ? to[0] : (int)s->extent.width;
    to[1] = to[1] < (int)s->extent.height ? to[1] : (int)s->extent.height;
    if (to[0] <= from[0] || to[1] <= from[1])
        return;
    const VkViewport viewport = {(float)at[0], (float)at[1], (float)extent[0], (float)extent[1], 0, 1};
    const VkRect2D scissor = {{from[0], from[1]}, {(uint32_t)(to[0] - from[0]), (uint32_t)(to[1] - from[1])}};
    memcpy(s->mapped + place.first, picture->rgba, 4 * words_of(picture));
    CALL(CmdSetViewport)(s->commands, 0, 1, &viewport);
    CALL(CmdSetScissor)(s->commands, 0, 1, &scissor);
    CALL(CmdPushConstants)(s->commands, s->layout, VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof place, &place);
    CALL(CmdDraw)(s->commands, 3, 1, 0, 0);
}

/* Draws a picture over the whole window, if there is one, and the panels. */
static void draw_panels(fxs_screen *s, uint32_t image, const fxs_canvas *picture, const fxs_panel *panels, int count)
{
    const VkRenderPassBeginInfo pass = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO, .renderPass = s->pass,
                                        .framebuffer = s->framebuffers[image], .renderArea = {{0, 0}, s->extent}};
    struct place place = {{0, 0}, {(int)s->extent.width, (int)s->extent.height}, {0, 0}, 0};
    CALL(CmdBeginRenderPass)(s->commands, &pass, VK_SUBPASS_CONTENTS_INLINE);
    CALL(CmdBindPipeline)(s->commands, VK_PIPELINE_BIND_POINT_GRAPHICS, s->pipeline);
    if (picture || count)
        CALL(CmdBindDescriptorSets)(s->commands, VK_PIPELINE_BIND_POINT_GRAPHICS, s->layout, 0, 1, &s->set, 0, 0);
    if (picture) {
        place.size[0] = picture->width;
        place.size[1] = picture->height;
        draw_panel(s, picture, place);
        place.first = (int)words_of(picture);
    }
    for (int i = 0; i < count; i++) {
        const fxs_canvas *p = &panels[i].picture;
        draw_panel(s, p, (struct place){{panels[i].x, panels[i].y}, {p->width, p->height}, {p->width, p->height},
                                        place.first});
        place.first += (int)words_of(p);
    }
    CALL(CmdEndRenderPass)(s->commands);
}

static void draw_below(fxs_screen *s, VkImage image, int rendered, uint32_t colour)
{
    const VkImageLayout layout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    const VkImageSubresourceRange all = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    const VkImageMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER, .dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
        .newLayout = layout, .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED, .image = image, .subresourceRange = all};
    const struct picture *p = &s->pictures[s->shown];
    const VkImageBlit blit = {{VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                              {{0, 0, 0}, {(int32_t)p->width, (int32_t)p->height, 1}},
                              {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                              {{0, 0, 0}, {(int32_t)s->extent.width, (int32_t)s->extent.height, 1}}};
    const VkClearColorValue clear = {{(float)(colour >> 24) / 255, (float)(colour >> 16 & 255) / 255,
                                      (float)(colour >> 8 & 255) / 255, 1}};
    CALL(CmdPipelineBarrier)(s->commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, 0, 0, 0,
                             1, &barrier);
    if (rendered && p->image)
        CALL(CmdBlitImage)(s->commands, p->image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, image, layout, 1, &blit,
                           VK_FILTER_NEAREST);
    else
        CALL(CmdClearColorImage)(s->commands, image, layout, &clear, 1, &all);
}

/* Submits the commands and presents the image when they have ended. */
static VkResult present(fxs_screen *s, uint32_t image)
{
    const VkPipelineStageFlags stage = VK_PIPELINE_STAGE_TRANSFER_BIT;
    const VkSubmitInfo work = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .waitSemaphoreCount = 1,
                               .pWaitSemaphores = &s->acquired, .pWaitDstStageMask = &stage, .commandBufferCount = 1,
                               .pCommandBuffers = &s->commands, .signalSemaphoreCount = 1,
                               .pSignalSemaphores = &s->finished[image]};
    const VkPresentInfoKHR info = {.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR, .waitSemaphoreCount = 1,
                                   .pWaitSemaphores = &s->finished[image], .swapchainCount = 1,
                                   .pSwapchains = &s->swapchain, .pImageIndices = &image};
    pthread_mutex_lock(&s->queue);
    VkResult result = CALL(ResetFences)(DEVICE, 1, &s->presented);
    result = result ? result : CALL(QueueSubmit)(s->device.options.queue, 1, &work, s->presented);
    result = result ? result : CALL(QueuePresentKHR)(s->device.options.queue, &info);
    pthread_mutex_unlock(&s->queue);
    return result;
}

static VkResult show(fxs_screen *s, int rendered, const fxs_canvas *picture, uint32_t colour, const fxs_panel *panels,
                     int count)
{
    const VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                            .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    size_t words = picture ? words_of(picture) : 0;
    uint32_t image = 0;
    for (int i = 0; i < count; i++)
        words += words_of(&panels[i].picture);
    VkResult result = CALL(WaitForFences)(DEVICE, 1, &s->presented, VK_TRUE, UINT64_MAX);
    result = result ? result : reserve_pixels(s, 4 * words);
    result = result ? result : CALL(AcquireNextImageKHR)(DEVICE, s->swapchain, UINT64_MAX, s->acquired, VK_NULL_HANDLE,
                                                         &image);
    if (result && result != VK_SUBOPTIMAL_KHR)
        return result;
    result = CALL(BeginCommandBuffer)(s->commands, &begin);
    if (result)
        return result;
    draw_below(s, s->images[image], rendered, colour);
    draw_panels(s, image, picture, panels, count);
    result = CALL(EndCommandBuffer)(s->commands);
    return result ? result : present(s, image);
}

int fxs_screen_show(fxs_screen *s, int rendered, const fxs_canvas *picture, uint32_t colour, const fxs_panel *panels,
                    int count, fxs_message *why)
{
    VkResult result = VK_SUCCESS;
    for (int tries = 0; tries < TRIES && (!tries || result == VK_ERROR_OUT_OF_DATE_KHR); tries++) {
        result = follow_size(s, tries);
        if (!result && s->extent.width && s->extent.height)
            result = show(s, rendered, rendered ? 0 : picture, colour, panels, count);
    }
    return result < 0 && result != VK_ERROR_OUT_OF_DATE_KHR ? said(result, why) : 0;
}

const fxs_backend fxs_screen_backend = {.name = "vulkan", .does = "frames in a window", .can = FXS_CAN_RATES,
                                        .render = render, .forget = forget, .close = close_screen};

#else

int fxs_screen_open(fxs_screen **screen, fxs_window *window, const fxs_backend_options *options, fxs_message *why)
{
    (void)window, (void)options;
    *screen = 0;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "this build is without Vulkan");
}

void fxs_screen_turn(fxs_screen *screen)
{
    (void)screen;
}

int fxs_screen_show(fxs_screen *screen, int rendered, const fxs_canvas *picture, uint32_t colour,
                    const fxs_panel *panels, int count, fxs_message *why)
{
    (void)screen, (void)rendered, (void)picture, (void)colour, (void)panels, (void)count, (void)why;
    return 0;
}

const fxs_backend fxs_screen_backend = {.name = "vulkan"};

#endif
