/* Shows Vulkan frames in an SDL window, with panels that are blended over the frames on the device. */
#include "vulkan_screen.h"

#ifdef FXS_WITH_VULKAN

#include <stdlib.h>
#include <string.h>

#include <SDL2/SDL.h>
#include <SDL2/SDL_vulkan.h>

#include <fixsplat/system.h>
#include <fixsplat/vulkan.h>
#include "panel_shaders.h"

enum { EXTENSIONS = 16 };

/* The push constants of panel.frag. */
struct place {
    int32_t at[2], extent[2], size[2], first;
};

struct fxs_screen {
    fxs_window *window;
    fxs_vulkan_window *shower;
    fxs_vulkan_window_info vk;
    VkDescriptorSetLayout set_layout;
    VkDescriptorPool sets;
    VkDescriptorSet set;
    VkPipelineLayout layout;
    VkPipeline pipeline;
    VkBuffer pixels;               /* of the panels */
    VkDeviceMemory pixel_memory;
    size_t pixel_bytes;
    uint32_t *mapped;
};

#define CALL(name) ((PFN_vk##name)s->vk.load(s->vk.instance, "vk" #name))
#define DEVICE (s->vk.device)

/* ---- Pixels of the panels ---------------------------------------------------------------------------------------- */

static VkResult allocate(fxs_screen *s, const VkMemoryRequirements *needs)
{
    const VkMemoryPropertyFlags wanted = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    VkPhysicalDeviceMemoryProperties types;
    VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs->size};
    CALL(GetPhysicalDeviceMemoryProperties)(s->vk.physical, &types);
    for (uint32_t i = 0; i < types.memoryTypeCount; i++)
        if (needs->memoryTypeBits >> i & 1 && (types.memoryTypes[i].propertyFlags & wanted) == wanted) {
            info.memoryTypeIndex = i;
            return CALL(AllocateMemory)(DEVICE, &info, 0, &s->pixel_memory);
        }
    return VK_ERROR_OUT_OF_DEVICE_MEMORY;
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
    result = allocate(s, &needs);
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
        .pDynamicState = &dynamic, .layout = s->layout, .renderPass = s->vk.pass};
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

static int said(VkResult result, fxs_message *why)
{
    return result ? fxs_fail_as(FXS_ERR_DEVICE, why, "the window's panels failed (error %d)", (int)result) : 0;
}

static void follow_size(fxs_screen *s)
{
    int width, height;
    fxs_window_size(s->window, &width, &height);
    fxs_vulkan_window_resize(s->shower, (uint32_t)width, (uint32_t)height);
}

static VkResult make_surface(void *argument, VkInstance instance, VkSurfaceKHR *surface)
{
    const fxs_screen *s = argument;
    return SDL_Vulkan_CreateSurface(fxs_window_handle(s->window), instance, surface) ? VK_SUCCESS
                                                                                    : VK_ERROR_INITIALIZATION_FAILED;
}

static int start(fxs_screen *s, const fxs_backend_options *options, fxs_message *why)
{
    const char *names[EXTENSIONS];
    unsigned count = EXTENSIONS;
    SDL_Window *window = fxs_window_handle(s->window);
    if (!(SDL_GetWindowFlags(window) & SDL_WINDOW_VULKAN) || !SDL_Vulkan_GetInstanceExtensions(window, &count, names))
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "SDL has no Vulkan here");
    fxs_vulkan_window_options o;
    fxs_vulkan_window_options_init(&o);
    void *const load = SDL_Vulkan_GetVkGetInstanceProcAddr();     /* a function's address */
    memcpy(&o.load, &load, sizeof load);
    o.device = (uint32_t)options->device;
    o.extensions = names;
    o.extension_count = count;
    o.surface = make_surface;
    o.argument = s;
    o.max_memory = options->max_memory;
    const int error = fxs_vulkan_window_open(&s->shower, &o, why);
    if (error)
        return error;
    s->vk = fxs_vulkan_window_get_info(s->shower);
    const VkResult result = make_layouts(s);
    return said(result ? result : make_pipeline(s), why);
}

static void close_screen(void *self)
{
    fxs_screen *s = self;
    if (s && s->shower) {
        CALL(DeviceWaitIdle)(DEVICE);
        drop_pixels(s);
        CALL(DestroyPipeline)(DEVICE, s->pipeline, 0);
        CALL(DestroyPipelineLayout)(DEVICE, s->layout, 0);
        CALL(DestroyDescriptorPool)(DEVICE, s->sets, 0);
        CALL(DestroyDescriptorSetLayout)(DEVICE, s->set_layout, 0);
        fxs_vulkan_window_close(s->shower);
    }
    free(s);
}

int fxs_screen_open(fxs_screen **screen, fxs_window *window, const fxs_backend_options *options, fxs_message *why)
{
    fxs_screen *s = *screen = calloc(1, sizeof *s);
    if (!s)
        return fxs_fail_memory(why, 0, sizeof *s);
    s->window = window;
    const int error = start(s, options, why);
    if (error) {
        close_screen(s);
        *screen = 0;
    }
    return error;
}

/* ---- Drawing ----------------------------------------------------------------------------------------------------- */

/* The frame's time is the device's, if it has a clock. */
static int render(void *self, const fxs_request *request, fxs_stats *stats, fxs_message *why)
{
    fxs_screen *s = self;
    const uint64_t started = fxs_clock(0);
    const int error = fxs_vulkan_window_draw(s->shower, request, stats, why);
    if (error)
        return error;
    const uint64_t device = fxs_vulkan_get_info(s->vk.vulkan).nanoseconds;
    stats->frame_nanoseconds = device ? device : fxs_clock(0) - started;
    return 0;
}

static void forget(void *self, const fxs_scene *scene)
{
    const fxs_screen *s = self;
    fxs_vulkan_drop(s->vk.vulkan, scene);
}

void fxs_screen_turn(fxs_screen *s)
{
    fxs_vulkan_window_turn(s->shower);
}

/* What one call of fxs_screen_show draws over the frame: a picture over the whole window, or null, and panels. */
typedef struct overlay {
    fxs_screen *screen;
    const fxs_canvas *picture;
    const fxs_panel *panels;
    int count;
    VkResult result;
    VkCommandBuffer commands;
    int size[2];
} overlay;

static size_t words_of(const fxs_canvas *picture)
{
    return (size_t)picture->width * (size_t)picture->height;
}

static void draw_panel(const overlay *o, const fxs_canvas *picture, struct place place)
{
    const fxs_screen *s = o->screen;
    const int *at = place.at, *extent = place.extent;
    const int from[2] = {at[0] > 0 ? at[0] : 0, at[1] > 0 ? at[1] : 0};
    int to[2] = {at[0] + extent[0], at[1] + extent[1]};
    to[0] = to[0] < o->size[0] ? to[0] : o->size[0];
    to[1] = to[1] < o->size[1] ? to[1] : o->size[1];
    if (to[0] <= from[0] || to[1] <= from[1])
        return;
    const VkViewport viewport = {(float)at[0], (float)at[1], (float)extent[0], (float)extent[1], 0, 1};
    const VkRect2D scissor = {{from[0], from[1]}, {(uint32_t)(to[0] - from[0]), (uint32_t)(to[1] - from[1])}};
    memcpy(s->mapped + place.first, picture->rgba, 4 * words_of(picture));
    CALL(CmdSetViewport)(o->commands, 0, 1, &viewport);
    CALL(CmdSetScissor)(o->commands, 0, 1, &scissor);
    CALL(CmdPushConstants)(o->commands, s->layout, VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof place, &place);
    CALL(CmdDraw)(o->commands, 3, 1, 0, 0);
}

static size_t all_words(const overlay *o)
{
    size_t words = o->picture ? words_of(o->picture) : 0;
    for (int i = 0; i < o->count; i++)
        words += words_of(&o->panels[i].picture);
    return words;
}

static void draw_overlay(void *argument, VkCommandBuffer commands, uint32_t width, uint32_t height)
{
    overlay *o = argument;
    fxs_screen *s = o->screen;
    struct place place = {{0, 0}, {(int)width, (int)height}, {0, 0}, 0};
    o->result = reserve_pixels(s, 4 * all_words(o));
    if (o->result || (!o->picture && !o->count))
        return;
    o->commands = commands;
    o->size[0] = (int)width;
    o->size[1] = (int)height;
    CALL(CmdBindPipeline)(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, s->pipeline);
    CALL(CmdBindDescriptorSets)(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, s->layout, 0, 1, &s->set, 0, 0);
    if (o->picture) {
        place.size[0] = o->picture->width;
        place.size[1] = o->picture->height;
        draw_panel(o, o->picture, place);
        place.first = (int)words_of(o->picture);
    }
    for (int i = 0; i < o->count; i++) {
        const fxs_canvas *p = &o->panels[i].picture;
        draw_panel(o, p, (struct place){{o->panels[i].x, o->panels[i].y}, {p->width, p->height},
                                        {p->width, p->height}, place.first});
        place.first += (int)words_of(p);
    }
}

int fxs_screen_show(fxs_screen *s, int rendered, const fxs_canvas *picture, uint32_t colour, const fxs_panel *panels,
                    int count, fxs_message *why)
{
    overlay o = {.screen = s, .picture = rendered ? 0 : picture, .panels = panels, .count = count};
    follow_size(s);
    const int error = fxs_vulkan_window_show(s->shower, rendered, colour, draw_overlay, &o, why);
    return error ? error : said(o.result, why);
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
