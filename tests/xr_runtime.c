/* An OpenXR runtime for tests, with images of Vulkan or OpenGL ES. It checks the order and the arguments of all calls,
 * the layouts of the images (by the validation layer), and the layers. At a fault it prints a line and ends the process
 * with status 99. It simulates a display, a moving head and two controllers. Variables of the environment:
 *
 *     FXS_XR_FAIL=CALL[:N]     call N (default 1) of a function fails with FXS_XR_RESULT (default -2); with
 *                              FXS_XR_EVER=1 all later calls that take a session fail too
 *     FXS_XR_FRAMES=N          the user takes the headset off after N frames
 *     FXS_XR_BLIND=N           in frames N to N + 4 the head has no orientation
 *     FXS_XR_EVENT=NAME:N      frame N has an event: loss, instance or recentre
 *     FXS_XR_SIZE=WxH          pixels of an eye (default 48x56)
 *     FXS_XR_HERTZ=N           xrWaitFrame waits for a display of N frames a second (default: it does not wait)
 *     FXS_XR_STILL=1           the head rests; the eyes have the same field of view
 *     FXS_XR_HANDS=NAME        gesture in frames 10 to 19: pull, stretch, turn, walk or step
 *     FXS_XR_LACKS=NAME        an extension, format or blend mode that the runtime lacks: depth, d32, egl, alpha
 *     FXS_XR_LOG=FILE          gets a line for each shown frame: the size of an eye, the hash of both */
#include <dlfcn.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <vulkan/vulkan_core.h>
#include <EGL/egl.h>
#include <GLES3/gl31.h>

#define XR_USE_GRAPHICS_API_VULKAN 1
#define XR_USE_GRAPHICS_API_OPENGL_ES 1
#define XR_USE_PLATFORM_EGL 1
#include "xr_runtime.h"
#include <openxr/openxr_platform.h>
#include <openxr/openxr_reflection.h>

enum { IMAGES = 3, CHAINS = 2, EVENTS = 16, OBJECTS = 64, PATHS = 64, FAULT = 99, HANDS_FROM = 10, HANDS_TO = 20 };
enum kind { NONE, INSTANCE, SESSION, SPACE, CHAIN, ACTION_SET, ACTION, KINDS };
enum phase { ENDED, WAITED, BEGUN };

typedef struct chain {
    XrSwapchain handle;
    int depth;
    int64_t format;
    VkImage images[IMAGES];
    VkDeviceMemory memory[IMAGES];
    GLuint textures[IMAGES];
    unsigned acquired, waited, released;   /* numbers of calls */
    int last;                          /* image released last; -1: none */
    uint32_t *pixels;                  /* of that image, both layers */
} chain;

static struct {
    enum kind objects[OBJECTS];
    XrActionType action_types[OBJECTS];
    uint32_t live[KINDS];
    XrSessionState state;
    XrSessionState events[EVENTS];
    int event_count, running, attached, required, by_vulkan, synced;
    enum phase phase;
    uint64_t waits;
    XrTime time, before;
    int located, blind;
    chain chains[CHAINS];
    char paths[PATHS][128];
    int path_count, suggested;
    uint64_t calls;                    /* of the function that fails */
    int failing, failed;               /* all calls fail; a call has failed */
    xr_runtime_seen seen;
} now;

/* ---- Settings ---------------------------------------------------------------------------------------------------- */

static void fault(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fputs("xr_runtime: ", stderr);
    vfprintf(stderr, format, arguments);
    fputs("\n", stderr);
    va_end(arguments);
    _Exit(FAULT);
}

#define NEED(condition) do { if (!(condition)) fault("%s: not so: %s", __func__, #condition); } while (0)

static long number_of(const char *variable, long otherwise)
{
    const char *text = getenv(variable);
    return text && *text ? strtol(text, 0, 10) : otherwise;
}

static int is_set(const char *variable, const char *value)
{
    const char *text = getenv(variable);
    return text && !strcmp(text, value);
}

/* True for NAME:N in a variable. A name without a number has the number `otherwise`. */
static int is_named(const char *variable, const char *name, uint64_t number, uint64_t otherwise)
{
    const char *text = getenv(variable);
    const size_t length = strlen(name);
    if (!text || strncmp(text, name, length) || (text[length] && text[length] != ':'))
        return 0;
    return number == (text[length] ? strtoull(text + length + 1, 0, 10) : otherwise);
}

static XrResult enter(const char *name, int of_session)
{
    const XrResult result = (XrResult)number_of("FXS_XR_RESULT", XR_ERROR_RUNTIME_FAILURE);
    char call[64];
    snprintf(call, sizeof call, "xr%s", name);
    if (now.failing && of_session)
        return result;
    const char *wanted = getenv("FXS_XR_FAIL");
    const size_t length = strlen(call);
    if (!wanted || strncmp(wanted, call, length) || (wanted[length] && wanted[length] != ':') ||
        !is_named("FXS_XR_FAIL", call, ++now.calls, 1))
        return XR_SUCCESS;
    now.failed = 1;
    now.failing = number_of("FXS_XR_EVER", 0) != 0;
    return result;
}

/* Begins each function of the runtime. */
#define ENTER(of_session) \
    do { const XrResult failed = enter(__func__ + 3, of_session); if (failed) return failed; } while (0)

/* ---- Objects ----------------------------------------------------------------------------------------------------- */

static uintptr_t make(enum kind kind)
{
    for (uintptr_t i = 1; i < OBJECTS; i++)
        if (!now.objects[i]) {
            now.objects[i] = kind;
            now.live[kind]++;
            return i;
        }
    fault("too many objects");
    return 0;
}

static void need(const void *handle, enum kind kind, const char *call)
{
    if ((uintptr_t)handle >= OBJECTS || now.objects[(uintptr_t)handle] != kind)
        fault("%s: a handle that is not valid", call);
}
#define IS(handle, kind) need(handle, kind, __func__)

static void destroy(const void *handle, enum kind kind)
{
    need(handle, kind, "destroy");
    now.objects[(uintptr_t)handle] = NONE;
    now.live[kind]--;
}

static void put_state(XrSessionState state)
{
    NEED(now.event_count < EVENTS);
    now.events[now.event_count++] = state;
}

/* ---- Instance ---------------------------------------------------------------------------------------------------- */

static const struct {
    const char *name, *short_name;
} extensions[] = {{XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME, "vulkan"}, {XR_KHR_OPENGL_ES_ENABLE_EXTENSION_NAME, "gles"},
                  {XR_MNDX_EGL_ENABLE_EXTENSION_NAME, "egl"}, {XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME, "depth"},
                  {XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME, "gaze"}};
enum { EXTENSIONS = sizeof extensions / sizeof *extensions };

static XrResult rt_EnumerateInstanceExtensionProperties(const char *layer, uint32_t room, uint32_t *count,
                                                        XrExtensionProperties *out)
{
    ENTER(0);
    NEED(!layer);
    *count = 0;
    for (int i = 0; i < EXTENSIONS; i++) {
        if (is_set("FXS_XR_LACKS", extensions[i].short_name))
            continue;
        if (room && *count == room)
            return XR_ERROR_SIZE_INSUFFICIENT;
        if (room) {
            NEED(out[*count].type == XR_TYPE_EXTENSION_PROPERTIES);
            strcpy(out[*count].extensionName, extensions[i].name);
            out[*count].extensionVersion = 1;
        }
        ++*count;
    }
    return XR_SUCCESS;
}

static XrResult rt_CreateInstance(const XrInstanceCreateInfo *info, XrInstance *out)
{
    memset(&now, 0, sizeof now);
    now.seen.hash = 0xcbf29ce484222325u;
    ENTER(0);
    NEED(info->type == XR_TYPE_INSTANCE_CREATE_INFO && *info->applicationInfo.applicationName);
    *out = (XrInstance)make(INSTANCE);
    return XR_SUCCESS;
}

static XrResult rt_DestroyInstance(XrInstance instance)
{
    IS(instance, INSTANCE);
    for (int kind = SESSION; kind < KINDS; kind++)
        if (now.live[kind])
            fault("%u objects of kind %d were not destroyed", now.live[kind], kind);
    destroy(instance, INSTANCE);
    return XR_SUCCESS;
}

static XrResult rt_GetInstanceProperties(XrInstance instance, XrInstanceProperties *out)
{
    ENTER(0);
    IS(instance, INSTANCE);
    NEED(out->type == XR_TYPE_INSTANCE_PROPERTIES);
    strcpy(out->runtimeName, "fixsplat's runtime for tests");
    return XR_SUCCESS;
}

static XrResult rt_ResultToString(XrInstance instance, XrResult result, char out[XR_MAX_RESULT_STRING_SIZE])
{
    (void)instance;
    switch (result) {
#define NAME(name, value) case name: strcpy(out, #name); break;
        XR_LIST_ENUM_XrResult(NAME)
    default: return XR_ERROR_VALIDATION_FAILURE;
    }
    return XR_SUCCESS;
}

static XrResult rt_PollEvent(XrInstance instance, XrEventDataBuffer *out)
{
    ENTER(0);
    IS(instance, INSTANCE);
    NEED(out->type == XR_TYPE_EVENT_DATA_BUFFER);
    if (!now.event_count)
        return XR_EVENT_UNAVAILABLE;
    XrEventDataSessionStateChanged *event = (XrEventDataSessionStateChanged *)(void *)out;
    memset(event, 0, sizeof *event);
    event->type = XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED;
    event->state = now.events[0];
    memmove(now.events, now.events + 1, (size_t)--now.event_count * sizeof *now.events);
    if ((int)event->state < 0)
        event->type = (int)event->state == -1 ? XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING
                                              : XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING;
    else
        now.state = event->state;
    return XR_SUCCESS;
}

static XrResult rt_GetSystem(XrInstance instance, const XrSystemGetInfo *info, XrSystemId *out)
{
    ENTER(0);
    IS(instance, INSTANCE);
    NEED(info->type == XR_TYPE_SYSTEM_GET_INFO && info->formFactor == XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY);
    *out = 1;
    return XR_SUCCESS;
}

static XrResult rt_GetSystemProperties(XrInstance instance, XrSystemId system, XrSystemProperties *out)
{
    ENTER(0);
    IS(instance, INSTANCE);
    NEED(system == 1 && out->type == XR_TYPE_SYSTEM_PROPERTIES);
    XrSystemEyeGazeInteractionPropertiesEXT *gaze = out->next;
    if (gaze && gaze->type == XR_TYPE_SYSTEM_EYE_GAZE_INTERACTION_PROPERTIES_EXT)
        gaze->supportsEyeGazeInteraction = XR_TRUE;
    strcpy(out->systemName, "a simulated headset");
    return XR_SUCCESS;
}

static XrResult rt_EnumerateEnvironmentBlendModes(XrInstance instance, XrSystemId system, XrViewConfigurationType type,
                                                  uint32_t room, uint32_t *count, XrEnvironmentBlendMode *out)
{
    ENTER(0);
    IS(instance, INSTANCE);
    NEED(system == 1 && type == XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO && room >= 2);
    out[0] = XR_ENVIRONMENT_BLEND_MODE_OPAQUE;
    out[1] = XR_ENVIRONMENT_BLEND_MODE_ALPHA_BLEND;
    *count = is_set("FXS_XR_LACKS", "alpha") ? 1 : 2;
    return XR_SUCCESS;
}

static XrResult rt_EnumerateViewConfigurationViews(XrInstance instance, XrSystemId system, XrViewConfigurationType type,
                                                   uint32_t room, uint32_t *count, XrViewConfigurationView *out)
{
    const char *size = getenv("FXS_XR_SIZE");
    ENTER(0);
    IS(instance, INSTANCE);
    NEED(system == 1 && type == XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO && room >= 2);
    if (!size || sscanf(size, "%dx%d", &now.seen.full_width, &now.seen.full_height) != 2)
        now.seen.full_width = 48, now.seen.full_height = 56;
    *count = 2;
    for (int i = 0; i < 2; i++) {
        NEED(out[i].type == XR_TYPE_VIEW_CONFIGURATION_VIEW);
        out[i].recommendedImageRectWidth = out[i].maxImageRectWidth = (uint32_t)now.seen.full_width;
        out[i].recommendedImageRectHeight = out[i].maxImageRectHeight = (uint32_t)now.seen.full_height;
        out[i].recommendedSwapchainSampleCount = out[i].maxSwapchainSampleCount = 1;
    }
    return XR_SUCCESS;
}

/* ---- Vulkan ------------------------------------------------------------------------------------------------------ */

static struct {
    PFN_vkGetInstanceProcAddr load;
    VkInstance instance;
    VkPhysicalDevice physical;
    VkDevice device;
    VkQueue queue;
    VkCommandPool pool;
    VkCommandBuffer commands;
    VkFence fence;
    VkBuffer buffer;
    VkDeviceMemory memory;
    void *mapped;
} vk;
#define VK(name) ((PFN_vk##name)(void (*)(void))vk.load(vk.instance, "vk" #name))
#define DO(call) do { const VkResult result = (call); if (result) fault("%s: %d", #call, (int)result); } while (0)

static XrResult rt_GetVulkanGraphicsRequirements2KHR(XrInstance instance, XrSystemId system,
                                                     XrGraphicsRequirementsVulkan2KHR *out)
{
    ENTER(0);
    IS(instance, INSTANCE);
    NEED(system == 1 && out->type == XR_TYPE_GRAPHICS_REQUIREMENTS_VULKAN2_KHR);
    out->minApiVersionSupported = XR_MAKE_VERSION(1, 0, 0);
    out->maxApiVersionSupported = XR_MAKE_VERSION(1, 3, 0);
    now.required = 1;
    return XR_SUCCESS;
}

static XrResult rt_CreateVulkanInstanceKHR(XrInstance instance, const XrVulkanInstanceCreateInfoKHR *info,
                                           VkInstance *out, VkResult *result)
{
    ENTER(0);
    IS(instance, INSTANCE);
    NEED(info->type == XR_TYPE_VULKAN_INSTANCE_CREATE_INFO_KHR && now.required && info->systemId == 1);
    memset(&vk, 0, sizeof vk);
    vk.load = info->pfnGetInstanceProcAddr;
    *result = VK(CreateInstance)(info->vulkanCreateInfo, info->vulkanAllocator, out);
    vk.instance = *out;
    return XR_SUCCESS;
}

static XrResult rt_GetVulkanGraphicsDevice2KHR(XrInstance instance, const XrVulkanGraphicsDeviceGetInfoKHR *info,
                                               VkPhysicalDevice *out)
{
    uint32_t one = 1;
    ENTER(0);
    IS(instance, INSTANCE);
    NEED(info->type == XR_TYPE_VULKAN_GRAPHICS_DEVICE_GET_INFO_KHR && info->vulkanInstance == vk.instance);
    NEED(VK(EnumeratePhysicalDevices)(vk.instance, &one, out) >= 0 && one == 1);
    vk.physical = *out;
    return XR_SUCCESS;
}

static XrResult rt_CreateVulkanDeviceKHR(XrInstance instance, const XrVulkanDeviceCreateInfoKHR *info, VkDevice *out,
                                         VkResult *result)
{
    ENTER(0);
    IS(instance, INSTANCE);
    NEED(info->type == XR_TYPE_VULKAN_DEVICE_CREATE_INFO_KHR && info->vulkanPhysicalDevice == vk.physical);
    *result = VK(CreateDevice)(vk.physical, info->vulkanCreateInfo, info->vulkanAllocator, out);
    vk.device = *out;
    return XR_SUCCESS;
}

static VkDeviceMemory allocate(VkMemoryRequirements needs, VkMemoryPropertyFlags flags)
{
    VkPhysicalDeviceMemoryProperties all;
    VkDeviceMemory memory;
    uint32_t type = 0;
    VK(GetPhysicalDeviceMemoryProperties)(vk.physical, &all);
    while (!(needs.memoryTypeBits >> type & 1) || (all.memoryTypes[type].propertyFlags & flags) != flags)
        type++;
    const VkMemoryAllocateInfo info = {VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, 0, needs.size, type};
    DO(VK(AllocateMemory)(vk.device, &info, 0, &memory));
    return memory;
}

static size_t layer_bytes(void)
{
    return (size_t)now.seen.full_width * (size_t)now.seen.full_height * 4;
}

static void begin_vulkan(const XrGraphicsBindingVulkan2KHR *binding)
{
    NEED(binding->instance == vk.instance && binding->physicalDevice == vk.physical && binding->device == vk.device);
    const VkCommandPoolCreateInfo pool = {VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO, 0,
                                          VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT, binding->queueFamilyIndex};
    const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    const VkBufferCreateInfo buffer = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = 2 * layer_bytes(),
                                       .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    VkMemoryRequirements needs;
    VK(GetDeviceQueue)(vk.device, binding->queueFamilyIndex, binding->queueIndex, &vk.queue);
    DO(VK(CreateCommandPool)(vk.device, &pool, 0, &vk.pool));
    const VkCommandBufferAllocateInfo one = {VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, 0, vk.pool,
                                             VK_COMMAND_BUFFER_LEVEL_PRIMARY, 1};
    DO(VK(AllocateCommandBuffers)(vk.device, &one, &vk.commands));
    DO(VK(CreateFence)(vk.device, &fence, 0, &vk.fence));
    DO(VK(CreateBuffer)(vk.device, &buffer, 0, &vk.buffer));
    VK(GetBufferMemoryRequirements)(vk.device, vk.buffer, &needs);
    vk.memory = allocate(needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    DO(VK(BindBufferMemory)(vk.device, vk.buffer, vk.memory, 0));
    DO(VK(MapMemory)(vk.device, vk.memory, 0, VK_WHOLE_SIZE, 0, &vk.mapped));
}

static void end_vulkan(void)
{
    VK(DestroyFence)(vk.device, vk.fence, 0);
    VK(DestroyCommandPool)(vk.device, vk.pool, 0);
    VK(DestroyBuffer)(vk.device, vk.buffer, 0);
    VK(FreeMemory)(vk.device, vk.memory, 0);
}

static void move(const chain *c, VkImage image, VkImageLayout from, VkImageLayout to)
{
    const VkAccessFlags any = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
    const VkImageMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER, .srcAccessMask = any, .dstAccessMask = any, .oldLayout = from,
        .newLayout = to, .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED, .image = image,
        .subresourceRange = {c->depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 2}};
    VK(CmdPipelineBarrier)(vk.commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, 0,
                           0, 0, 1, &barrier);
}

static void record(void)
{
    const VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    DO(VK(BeginCommandBuffer)(vk.commands, &begin));
}

static void run(void)
{
    const VkSubmitInfo info = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1,
                               .pCommandBuffers = &vk.commands};
    DO(VK(EndCommandBuffer)(vk.commands));
    DO(VK(QueueSubmit)(vk.queue, 1, &info, vk.fence));
    DO(VK(WaitForFences)(vk.device, 1, &vk.fence, VK_TRUE, UINT64_MAX));
    DO(VK(ResetFences)(vk.device, 1, &vk.fence));
}

static VkImageLayout layout_of(const chain *c)
{
    return c->depth ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
}

static void make_vulkan_images(chain *c, XrSwapchainUsageFlags usage)
{
    const VkImageCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, .imageType = VK_IMAGE_TYPE_2D, .format = (VkFormat)c->format,
        .extent = {(uint32_t)now.seen.full_width, (uint32_t)now.seen.full_height, 1}, .mipLevels = 1, .arrayLayers = 2,
        .samples = VK_SAMPLE_COUNT_1_BIT,
        .usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                 (usage & XR_SWAPCHAIN_USAGE_TRANSFER_DST_BIT ? VK_IMAGE_USAGE_TRANSFER_DST_BIT : 0u) |
                 (c->depth ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT)};
    VkMemoryRequirements needs;
    record();
    for (int i = 0; i < IMAGES; i++) {
        DO(VK(CreateImage)(vk.device, &info, 0, &c->images[i]));
        VK(GetImageMemoryRequirements)(vk.device, c->images[i], &needs);
        c->memory[i] = allocate(needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
        DO(VK(BindImageMemory)(vk.device, c->images[i], c->memory[i], 0));
        move(c, c->images[i], VK_IMAGE_LAYOUT_UNDEFINED, layout_of(c));
    }
    run();
}

/* Reads an image that the program has released. The validation layer reports it if the image has another layout. */
static void read_vulkan(const chain *c)
{
    const VkBufferImageCopy region = {
        .imageSubresource = {c->depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 2},
        .imageExtent = {(uint32_t)now.seen.full_width, (uint32_t)now.seen.full_height, 1}};
    const VkImage image = c->images[c->last];
    record();
    move(c, image, layout_of(c), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    VK(CmdCopyImageToBuffer)(vk.commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, vk.buffer, 1, &region);
    move(c, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, layout_of(c));
    run();
    memcpy(c->pixels, vk.mapped, 2 * layer_bytes());
}

/* ---- OpenGL ES --------------------------------------------------------------------------------------------------- */

static PFNEGLGETPROCADDRESSPROC load_gl;
#define GL(result, name, arguments) ((result (*) arguments)load_gl("gl" #name))
static GLuint framebuffer, words, to_words;

static XrResult rt_GetOpenGLESGraphicsRequirementsKHR(XrInstance instance, XrSystemId system,
                                                      XrGraphicsRequirementsOpenGLESKHR *out)
{
    ENTER(0);
    IS(instance, INSTANCE);
    NEED(system == 1 && out->type == XR_TYPE_GRAPHICS_REQUIREMENTS_OPENGL_ES_KHR);
    now.required = 1;
    return XR_SUCCESS;
}

static GLuint texture_of(GLenum target, GLenum format)
{
    GLuint texture;
    GL(void, GenTextures, (GLsizei, GLuint *))(1, &texture);
    GL(void, BindTexture, (GLenum, GLuint))(target, texture);
    if (target == GL_TEXTURE_2D)
        GL(void, TexStorage2D, (GLenum, GLsizei, GLenum, GLsizei, GLsizei))(target, 1, format, now.seen.full_width,
                                                                          now.seen.full_height);
    else
        GL(void, TexStorage3D, (GLenum, GLsizei, GLenum, GLsizei, GLsizei, GLsizei))(target, 1, format,
            now.seen.full_width, now.seen.full_height, 2);
    GL(void, TexParameteri, (GLenum, GLenum, GLint))(target, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    GL(void, TexParameteri, (GLenum, GLenum, GLint))(target, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return texture;
}

static void begin_gles(const XrGraphicsBindingEGLMNDX *binding)
{
    static const GLchar *const texts[] = {
        "#version 310 es\nvoid main() { gl_Position = vec4(ivec2(gl_VertexID & 1, gl_VertexID >> 1) * 4 - 1, 0, 1); }",
        "#version 310 es\nprecision highp float;\nprecision highp int;\nuniform highp sampler2DArray depths;\n"
        "layout(location = 0) uniform int layer;\nout uint word;\n"
        "void main() { word = floatBitsToUint(texelFetch(depths, ivec3(gl_FragCoord.xy, layer), 0).x); }"};
    NEED(binding->getProcAddress && binding->display && binding->context && binding->config);
    load_gl = binding->getProcAddress;
    NEED(((PFNEGLGETCURRENTCONTEXTPROC)load_gl("eglGetCurrentContext"))() == binding->context);
    GL(void, GenFramebuffers, (GLsizei, GLuint *))(1, &framebuffer);
    words = texture_of(GL_TEXTURE_2D, GL_R32UI);
    to_words = GL(GLuint, CreateProgram, (void))();
    for (int i = 0; i < 2; i++) {
        const GLuint shader = GL(GLuint, CreateShader, (GLenum))(i ? GL_FRAGMENT_SHADER : GL_VERTEX_SHADER);
        GL(void, ShaderSource, (GLuint, GLsizei, const GLchar *const *, const GLint *))(shader, 1, &texts[i], 0);
        GL(void, CompileShader, (GLuint))(shader);
        GL(void, AttachShader, (GLuint, GLuint))(to_words, shader);
    }
    GL(void, LinkProgram, (GLuint))(to_words);
}

/* Depths are converted to words, because OpenGL ES does not read depths back. */
static void attach_layer(const chain *c, int layer)
{
    if (!c->depth) {
        GL(void, FramebufferTextureLayer, (GLenum, GLenum, GLuint, GLint, GLint))(GL_FRAMEBUFFER,
            GL_COLOR_ATTACHMENT0, c->textures[c->last], 0, layer);
        return;
    }
    GL(void, FramebufferTexture2D, (GLenum, GLenum, GLenum, GLuint, GLint))(GL_FRAMEBUFFER,
        GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, words, 0);
    GL(void, UseProgram, (GLuint))(to_words);
    GL(void, Uniform1i, (GLint, GLint))(0, layer);
    GL(void, ActiveTexture, (GLenum))(GL_TEXTURE0);
    GL(void, BindTexture, (GLenum, GLuint))(GL_TEXTURE_2D_ARRAY, c->textures[c->last]);
    GL(void, Viewport, (GLint, GLint, GLsizei, GLsizei))(0, 0, now.seen.full_width, now.seen.full_height);
    GL(void, DrawArrays, (GLenum, GLint, GLsizei))(GL_TRIANGLES, 0, 3);
}

static void read_gles(const chain *c)
{
    const size_t pixels = layer_bytes() / 4;
    uint32_t *four = malloc(pixels * 4 * sizeof *four);
    NEED(four);
    GL(void, BindFramebuffer, (GLenum, GLuint))(GL_FRAMEBUFFER, framebuffer);
    for (int layer = 0; layer < 2; layer++) {
        uint32_t *to = c->pixels + (size_t)layer * pixels;
        attach_layer(c, layer);
        GL(void, ReadPixels, (GLint, GLint, GLsizei, GLsizei, GLenum, GLenum, void *))(0, 0, now.seen.full_width,
            now.seen.full_height, c->depth ? GL_RGBA_INTEGER : GL_RGBA, c->depth ? GL_UNSIGNED_INT : GL_UNSIGNED_BYTE,
            c->depth ? four : to);
        for (size_t i = 0; i < pixels && c->depth; i++)
            to[i] = four[4 * i];
    }
    free(four);
    const GLenum error = GL(GLenum, GetError, (void))();
    if (error)
        fault("OpenGL ES: error 0x%x", error);
}

/* ---- Session ----------------------------------------------------------------------------------------------------- */

static XrResult rt_CreateSession(XrInstance instance, const XrSessionCreateInfo *info, XrSession *out)
{
    const XrBaseInStructure *binding = info->next;
    ENTER(0);
    IS(instance, INSTANCE);
    NEED(info->type == XR_TYPE_SESSION_CREATE_INFO && info->systemId == 1 && binding && now.required);
    now.by_vulkan = binding->type == XR_TYPE_GRAPHICS_BINDING_VULKAN2_KHR;
    if (now.by_vulkan)
        begin_vulkan((const void *)binding);
    else if (binding->type == XR_TYPE_GRAPHICS_BINDING_EGL_MNDX)
        begin_gles((const void *)binding);
    else
        return XR_ERROR_GRAPHICS_DEVICE_INVALID;
    *out = (XrSession)make(SESSION);
    put_state(XR_SESSION_STATE_IDLE);
    put_state(XR_SESSION_STATE_READY);
    return XR_SUCCESS;
}

static XrResult rt_DestroySession(XrSession session)
{
    destroy(session, SESSION);
    if (now.by_vulkan)
        end_vulkan();
    return XR_SUCCESS;
}

static XrResult rt_BeginSession(XrSession session, const XrSessionBeginInfo *info)
{
    ENTER(1);
    IS(session, SESSION);
    NEED(info->type == XR_TYPE_SESSION_BEGIN_INFO && now.state == XR_SESSION_STATE_READY && !now.running);
    NEED(info->primaryViewConfigurationType == XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO);
    now.running = 1;
    return XR_SUCCESS;
}

static XrResult rt_EndSession(XrSession session)
{
    ENTER(1);
    IS(session, SESSION);
    NEED(now.state == XR_SESSION_STATE_STOPPING && now.running && now.phase == ENDED);
    now.running = 0;
    put_state(XR_SESSION_STATE_IDLE);
    put_state(XR_SESSION_STATE_EXITING);
    return XR_SUCCESS;
}

static void ask_stop(void)
{
    put_state(XR_SESSION_STATE_VISIBLE);
    put_state(XR_SESSION_STATE_SYNCHRONIZED);
    put_state(XR_SESSION_STATE_STOPPING);
}

static XrResult rt_RequestExitSession(XrSession session)
{
    ENTER(1);
    IS(session, SESSION);
    NEED(now.running);
    ask_stop();
    return XR_SUCCESS;
}

static XrResult rt_EnumerateReferenceSpaces(XrSession session, uint32_t room, uint32_t *count,
                                            XrReferenceSpaceType *out)
{
    ENTER(1);
    IS(session, SESSION);
    NEED(room >= 3);
    *count = 3;
    out[0] = XR_REFERENCE_SPACE_TYPE_VIEW;
    out[1] = XR_REFERENCE_SPACE_TYPE_LOCAL;
    out[2] = XR_REFERENCE_SPACE_TYPE_STAGE;
    return XR_SUCCESS;
}

static XrResult rt_CreateReferenceSpace(XrSession session, const XrReferenceSpaceCreateInfo *info, XrSpace *out)
{
    ENTER(1);
    IS(session, SESSION);
    NEED(info->type == XR_TYPE_REFERENCE_SPACE_CREATE_INFO && info->poseInReferenceSpace.orientation.w == 1);
    NEED(info->referenceSpaceType == XR_REFERENCE_SPACE_TYPE_STAGE);
    *out = (XrSpace)make(SPACE);
    return XR_SUCCESS;
}

static XrResult rt_DestroySpace(XrSpace space)
{
    destroy(space, SPACE);
    return XR_SUCCESS;
}

/* ---- Swapchains -------------------------------------------------------------------------------------------------- */

static XrResult rt_EnumerateSwapchainFormats(XrSession session, uint32_t room, uint32_t *count, int64_t *out)
{
    static const int64_t of_vulkan[] = {VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_B8G8R8A8_SRGB,
                                        VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_D32_SFLOAT};
    static const int64_t of_gles[] = {GL_RGBA16F, GL_RGBA8, GL_SRGB8_ALPHA8, GL_DEPTH_COMPONENT32F};
    ENTER(1);
    IS(session, SESSION);
    NEED(room >= 4);
    *count = is_set("FXS_XR_LACKS", "d32") ? 3 : 4;
    memcpy(out, now.by_vulkan ? of_vulkan : of_gles, *count * sizeof *out);
    return XR_SUCCESS;
}

static chain *chain_of(XrSwapchain handle)
{
    IS(handle, CHAIN);
    for (int i = 0; i < CHAINS; i++)
        if (now.chains[i].handle == handle)
            return &now.chains[i];
    fault("no such swapchain");
    return 0;
}

static XrResult rt_CreateSwapchain(XrSession session, const XrSwapchainCreateInfo *info, XrSwapchain *out)
{
    ENTER(1);
    IS(session, SESSION);
    const int depth = info->format == VK_FORMAT_D32_SFLOAT || info->format == GL_DEPTH_COMPONENT32F;
    chain *c = &now.chains[depth];
    NEED(info->type == XR_TYPE_SWAPCHAIN_CREATE_INFO && info->arraySize == 2 && info->sampleCount == 1 &&
         info->faceCount == 1 && info->mipCount == 1 && !c->handle);
    NEED(info->format == (now.by_vulkan ? depth ? VK_FORMAT_D32_SFLOAT : VK_FORMAT_R8G8B8A8_SRGB
                                        : depth ? GL_DEPTH_COMPONENT32F : GL_SRGB8_ALPHA8));
    NEED(info->width == (uint32_t)now.seen.full_width && info->height == (uint32_t)now.seen.full_height);
    NEED(info->usageFlags & (depth ? XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT
                                   : XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT));
    *c = (chain){.depth = depth, .format = info->format, .last = -1, .pixels = calloc(2, layer_bytes())};
    *out = c->handle = (XrSwapchain)make(CHAIN);
    if (now.by_vulkan)
        make_vulkan_images(c, info->usageFlags);
    for (int i = 0; i < IMAGES && !now.by_vulkan; i++)
        c->textures[i] = texture_of(GL_TEXTURE_2D_ARRAY, (GLenum)info->format);
    return XR_SUCCESS;
}

static XrResult rt_DestroySwapchain(XrSwapchain handle)
{
    chain *c = chain_of(handle);
    for (int i = 0; i < IMAGES && now.by_vulkan; i++) {
        VK(DestroyImage)(vk.device, c->images[i], 0);
        VK(FreeMemory)(vk.device, c->memory[i], 0);
    }
    if (!now.by_vulkan)
        GL(void, DeleteTextures, (GLsizei, const GLuint *))(IMAGES, c->textures);
    free(c->pixels);
    memset(c, 0, sizeof *c);
    destroy(handle, CHAIN);
    return XR_SUCCESS;
}

static XrResult rt_EnumerateSwapchainImages(XrSwapchain handle, uint32_t room, uint32_t *count,
                                            XrSwapchainImageBaseHeader *out)
{
    ENTER(1);
    const chain *c = chain_of(handle);
    *count = IMAGES;
    for (uint32_t i = 0; i < room; i++)
        if (now.by_vulkan) {
            XrSwapchainImageVulkan2KHR *image = (XrSwapchainImageVulkan2KHR *)(void *)out + i;
            NEED(image->type == XR_TYPE_SWAPCHAIN_IMAGE_VULKAN2_KHR);
            image->image = c->images[i];
        } else {
            XrSwapchainImageOpenGLESKHR *image = (XrSwapchainImageOpenGLESKHR *)(void *)out + i;
            NEED(image->type == XR_TYPE_SWAPCHAIN_IMAGE_OPENGL_ES_KHR);
            image->image = c->textures[i];
        }
    return XR_SUCCESS;
}

static XrResult rt_AcquireSwapchainImage(XrSwapchain handle, const XrSwapchainImageAcquireInfo *info, uint32_t *out)
{
    ENTER(1);
    chain *c = chain_of(handle);
    (void)info;
    NEED(now.phase == BEGUN && c->acquired == c->released);
    *out = c->acquired++ % IMAGES;
    return XR_SUCCESS;
}

static XrResult rt_WaitSwapchainImage(XrSwapchain handle, const XrSwapchainImageWaitInfo *info)
{
    ENTER(1);
    chain *c = chain_of(handle);
    NEED(info->type == XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO && info->timeout > 0);
    NEED(c->waited < c->acquired);
    c->waited++;
    return XR_SUCCESS;
}

static XrResult rt_ReleaseSwapchainImage(XrSwapchain handle, const XrSwapchainImageReleaseInfo *info)
{
    ENTER(1);
    chain *c = chain_of(handle);
    (void)info;
    NEED(c->released < c->waited);
    c->last = (int)(c->released++ % IMAGES);
    if (now.by_vulkan)
        read_vulkan(c);
    else
        read_gles(c);
    return XR_SUCCESS;
}

/* ---- Simulated head and hands ------------------------------------------------------------------------------------ */

static XrTime clock_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (XrTime)t.tv_sec * 1000000000 + t.tv_nsec;
}

static XrDuration period(void)
{
    const long hertz = number_of("FXS_XR_HERTZ", 0);
    return 1000000000 / (hertz ? hertz : 72);
}

static void locate_eye(int eye, XrView *view)
{
    const int still = number_of("FXS_XR_STILL", 0) != 0;
    const double t = still ? 0 : (double)now.waits * 0.01, turn = 0.3 * sin(t), nod = 0.1 * sin(1.7 * t);
    const float apart = eye ? 0.0315f : -0.0315f;
    const XrFovf wide[2] = {{-0.94f, 0.70f, 0.77f, -0.87f}, {-0.70f, 0.94f, 0.77f, -0.87f}};
    view->fov = still ? (XrFovf){-0.7f, 0.7f, 0.7f, -0.7f} : wide[eye];
    view->pose.orientation = (XrQuaternionf){(float)(cos(turn / 2) * sin(nod / 2)),
                                             (float)(sin(turn / 2) * cos(nod / 2)),
                                             (float)(-sin(turn / 2) * sin(nod / 2)),
                                             (float)(cos(turn / 2) * cos(nod / 2))};
    view->pose.position = (XrVector3f){apart * (float)cos(turn) + 0.1f * (float)sin(2 * t), still ? 1.6f : 0.4f,
                                       (still ? 0 : 2.4f) - apart * (float)sin(turn)};
}

static int acts(const char *name)
{
    return is_set("FXS_XR_HANDS", name) && now.waits >= HANDS_FROM && now.waits < HANDS_TO;
}

static XrPosef hand_pose(int hand)
{
    const double done = now.waits < HANDS_FROM ? 0 : now.waits >= HANDS_TO ? 1
                        : (double)(now.waits - HANDS_FROM) / (HANDS_TO - 1 - HANDS_FROM);
    const double side = hand ? 0.1 : -0.1, grown = is_set("FXS_XR_HANDS", "stretch") ? 1 + done : 1;
    const double angle = is_set("FXS_XR_HANDS", "turn") ? done : 0;
    return (XrPosef){{0, 0, 0, 1},
                     {(float)(side * grown * cos(angle) + (is_set("FXS_XR_HANDS", "pull") ? 0.2 * done : 0)), 1,
                      (float)(1.8 - side * grown * sin(angle))}};
}

/* ---- Frames ------------------------------------------------------------------------------------------------------ */

static void simulate_user(void)
{
    if (now.waits == 2)
        put_state(XR_SESSION_STATE_SYNCHRONIZED);
    if (now.waits == 4)
        put_state(XR_SESSION_STATE_VISIBLE);
    if (now.waits == 6)
        put_state(XR_SESSION_STATE_FOCUSED);
    if ((long)now.waits == number_of("FXS_XR_FRAMES", -1))
        ask_stop();
    if (is_named("FXS_XR_EVENT", "loss", now.waits, 0))
        put_state(XR_SESSION_STATE_LOSS_PENDING);
    if (is_named("FXS_XR_EVENT", "instance", now.waits, 0))
        put_state((XrSessionState)-1);
    if (is_named("FXS_XR_EVENT", "recentre", now.waits, 0))
        put_state((XrSessionState)-2);
}

static XrResult rt_WaitFrame(XrSession session, const XrFrameWaitInfo *info, XrFrameState *out)
{
    ENTER(1);
    IS(session, SESSION);
    (void)info;
    NEED(now.running && now.phase == ENDED && out->type == XR_TYPE_FRAME_STATE);
    now.phase = WAITED;
    now.waits++;
    if (number_of("FXS_XR_HERTZ", 0)) {
        const XrTime shown = (clock_now() / period() + 1) * period();
        const struct timespec until = {(time_t)(shown / 1000000000), (long)(shown % 1000000000)};
        clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, 0);
        now.time = shown + 2 * period();
    } else {
        now.time += period();
    }
    simulate_user();
    out->predictedDisplayTime = now.time;
    out->predictedDisplayPeriod = period();
    out->shouldRender = now.state == XR_SESSION_STATE_VISIBLE || now.state == XR_SESSION_STATE_FOCUSED;
    now.blind = now.waits - (uint64_t)number_of("FXS_XR_BLIND", -10) < 5;
    return XR_SUCCESS;
}

static XrResult rt_BeginFrame(XrSession session, const XrFrameBeginInfo *info)
{
    ENTER(1);
    IS(session, SESSION);
    (void)info;
    NEED(now.phase == WAITED);
    now.phase = BEGUN;
    now.located = now.synced = 0;
    return XR_SUCCESS;
}

static XrResult rt_LocateViews(XrSession session, const XrViewLocateInfo *info, XrViewState *state, uint32_t room,
                               uint32_t *count, XrView *out)
{
    ENTER(1);
    IS(session, SESSION);
    IS(info->space, SPACE);
    NEED(info->type == XR_TYPE_VIEW_LOCATE_INFO && state->type == XR_TYPE_VIEW_STATE && room >= 2);
    NEED(now.phase == BEGUN && info->displayTime == now.time);
    NEED(info->viewConfigurationType == XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO);
    *count = 2;
    state->viewStateFlags = now.blind ? XR_VIEW_STATE_POSITION_VALID_BIT
                                      : XR_VIEW_STATE_ORIENTATION_VALID_BIT | XR_VIEW_STATE_POSITION_VALID_BIT;
    for (int eye = 0; eye < 2; eye++) {
        NEED(out[eye].type == XR_TYPE_VIEW);
        locate_eye(eye, &out[eye]);
        if (now.blind)
            memset(&out[eye].pose, 0xff, sizeof out[eye].pose);        /* not numbers */
        now.seen.views[eye] = out[eye];
        now.seen.hands[eye] = hand_pose(eye);
    }
    now.located = 1;
    return XR_SUCCESS;
}

static void need_image(const XrSwapchainSubImage *image, int depth, uint32_t eye)
{
    const chain *c = chain_of(image->swapchain);
    const XrRect2Di r = image->imageRect;
    NEED(c->depth == depth && c->last >= 0 && c->acquired == c->released && image->imageArrayIndex == eye);
    NEED(r.offset.x == 0 && r.offset.y == 0 && r.extent.width > 0 && r.extent.height > 0);
    NEED(r.extent.width <= now.seen.full_width && r.extent.height <= now.seen.full_height);
    if (!depth) {
        now.seen.width = r.extent.width;
        now.seen.height = r.extent.height;
    }
    NEED(r.extent.width == now.seen.width && r.extent.height == now.seen.height);
    now.seen.pixels[depth][eye] = c->pixels + eye * layer_bytes() / 4;
}

/* The hash of both eyes side by side, as fixsplat render --stereo --hash prints it. */
static uint64_t hash_eyes(void)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (int i = 0; i < 2 * now.seen.height; i++) {
        const int y = now.by_vulkan ? i / 2 : now.seen.height - 1 - i / 2;
        const uint32_t *eye = now.seen.pixels[XR_RUNTIME_COLOUR][i % 2];
        const unsigned char *row = (const unsigned char *)(eye + (size_t)y * (size_t)now.seen.full_width);
        for (int x = 0; x < 4 * now.seen.width; x++)
            hash = (hash ^ row[x]) * 0x100000001b3u;
    }
    return hash;
}

static void write_log(uint64_t hash)
{
    const char *name = getenv("FXS_XR_LOG");
    FILE *file = name ? fopen(name, "a") : 0;
    if (!file)
        return;
    fprintf(file, "%dx%d %016llx\n", now.seen.width, now.seen.height, (unsigned long long)hash);
    fclose(file);
}

static void take_layer(const XrCompositionLayerProjection *layer)
{
    NEED(layer->type == XR_TYPE_COMPOSITION_LAYER_PROJECTION && layer->viewCount == 2);
    IS(layer->space, SPACE);
    NEED(now.located && !now.blind && now.synced);
    memset(now.seen.pixels, 0, sizeof now.seen.pixels);
    for (uint32_t eye = 0; eye < 2; eye++) {
        const XrCompositionLayerProjectionView *view = &layer->views[eye];
        const XrCompositionLayerDepthInfoKHR *depth = view->next;
        NEED(view->type == XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW);
        NEED(!memcmp(&view->pose, &now.seen.views[eye].pose, sizeof view->pose));
        NEED(!memcmp(&view->fov, &now.seen.views[eye].fov, sizeof view->fov));
        need_image(&view->subImage, 0, eye);
        if (depth) {
            NEED(depth->type == XR_TYPE_COMPOSITION_LAYER_DEPTH_INFO_KHR);
            NEED(depth->nearZ > 0 && depth->farZ > depth->nearZ);
            NEED(depth->minDepth == 0 && depth->maxDepth == 1);
            need_image(&depth->subImage, 1, eye);
        }
    }
    const uint64_t hash = hash_eyes();
    now.seen.hash = (now.seen.hash ^ hash) * 0x100000001b3u;
    now.seen.blends = layer->layerFlags == XR_COMPOSITION_LAYER_BLEND_TEXTURE_SOURCE_ALPHA_BIT;
    now.seen.shown++;
    write_log(hash);
}

static XrResult rt_EndFrame(XrSession session, const XrFrameEndInfo *info)
{
    ENTER(1);
    IS(session, SESSION);
    NEED(info->type == XR_TYPE_FRAME_END_INFO && now.phase == BEGUN && info->displayTime == now.time);
    NEED(info->layerCount <= 1);
    for (int i = 0; i < CHAINS; i++)
        NEED(!now.chains[i].handle || now.failed || now.chains[i].released == now.chains[i].waited);
    now.phase = ENDED;
    now.seen.frames++;
    if (info->layerCount)
        take_layer((const void *)info->layers[0]);
    NEED(info->environmentBlendMode == (now.seen.blends ? XR_ENVIRONMENT_BLEND_MODE_ALPHA_BLEND
                                                        : XR_ENVIRONMENT_BLEND_MODE_OPAQUE) || !info->layerCount);
    return XR_SUCCESS;
}

/* ---- Actions ----------------------------------------------------------------------------------------------------- */

static XrResult rt_StringToPath(XrInstance instance, const char *text, XrPath *out)
{
    ENTER(0);
    IS(instance, INSTANCE);
    int i = 0;
    while (i < now.path_count && strcmp(now.paths[i], text))
        i++;
    NEED(i < PATHS && *text == '/' && strlen(text) < sizeof *now.paths);
    if (i == now.path_count)
        strcpy(now.paths[now.path_count++], text);
    *out = (XrPath)(i + 1);
    return XR_SUCCESS;
}

static const char *path_text(XrPath path)
{
    NEED(path && path <= (XrPath)now.path_count);
    return now.paths[path - 1];
}

static XrResult rt_CreateActionSet(XrInstance instance, const XrActionSetCreateInfo *info, XrActionSet *out)
{
    ENTER(0);
    IS(instance, INSTANCE);
    NEED(info->type == XR_TYPE_ACTION_SET_CREATE_INFO && *info->actionSetName && *info->localizedActionSetName);
    *out = (XrActionSet)make(ACTION_SET);
    return XR_SUCCESS;
}

/* Actions end with their set. */
static XrResult rt_DestroyActionSet(XrActionSet set)
{
    destroy(set, ACTION_SET);
    for (uintptr_t i = 0; i < OBJECTS; i++)
        if (now.objects[i] == ACTION)
            destroy((const void *)i, ACTION);
    return XR_SUCCESS;
}

static XrResult rt_CreateAction(XrActionSet set, const XrActionCreateInfo *info, XrAction *out)
{
    ENTER(0);
    IS(set, ACTION_SET);
    NEED(info->type == XR_TYPE_ACTION_CREATE_INFO && *info->actionName && *info->localizedActionName && !now.attached);
    const uintptr_t made = make(ACTION);
    now.action_types[made] = info->actionType;
    *out = (XrAction)made;
    return XR_SUCCESS;
}

static XrResult rt_SuggestInteractionProfileBindings(XrInstance instance,
                                                     const XrInteractionProfileSuggestedBinding *info)
{
    static const struct {
        const char *profile, *path;
        XrActionType type;
    } inputs[] = {{"khr/simple_controller", "/input/select/click", XR_ACTION_TYPE_BOOLEAN_INPUT},
                  {"khr/simple_controller", "/input/grip/pose", XR_ACTION_TYPE_POSE_INPUT},
                  {"oculus/touch_controller", "/input/squeeze/value", XR_ACTION_TYPE_BOOLEAN_INPUT},
                  {"oculus/touch_controller", "/input/grip/pose", XR_ACTION_TYPE_POSE_INPUT},
                  {"oculus/touch_controller", "/input/thumbstick", XR_ACTION_TYPE_VECTOR2F_INPUT},
                  {"ext/eye_gaze_interaction", "/input/gaze_ext/pose", XR_ACTION_TYPE_POSE_INPUT}};
    ENTER(0);
    IS(instance, INSTANCE);
    NEED(info->type == XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING && !now.attached);
    for (uint32_t i = 0; i < info->countSuggestedBindings; i++) {
        const char *profile = path_text(info->interactionProfile);
        const char *path = path_text(info->suggestedBindings[i].binding);
        const XrAction action = info->suggestedBindings[i].action;
        size_t k = 0;
        IS(action, ACTION);
        while (k < sizeof inputs / sizeof *inputs &&
               (!strstr(profile, inputs[k].profile) || !strstr(path, inputs[k].path)))
            k++;
        if (k == sizeof inputs / sizeof *inputs || inputs[k].type != now.action_types[(uintptr_t)action])
            fault("%s has no such input %s", profile, path);
    }
    now.suggested++;
    return XR_SUCCESS;
}

static XrResult rt_AttachSessionActionSets(XrSession session, const XrSessionActionSetsAttachInfo *info)
{
    ENTER(1);
    IS(session, SESSION);
    NEED(info->type == XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO && info->countActionSets == 1 && !now.attached);
    IS(info->actionSets[0], ACTION_SET);
    now.attached = 1;
    return XR_SUCCESS;
}

/* Kinds of spaces follow from the action's number: hands have a path. */
static XrPath space_paths[OBJECTS];

static XrResult rt_CreateActionSpace(XrSession session, const XrActionSpaceCreateInfo *info, XrSpace *out)
{
    ENTER(1);
    IS(session, SESSION);
    IS(info->action, ACTION);
    NEED(info->type == XR_TYPE_ACTION_SPACE_CREATE_INFO);
    NEED(now.action_types[(uintptr_t)info->action] == XR_ACTION_TYPE_POSE_INPUT);
    const uintptr_t made = make(SPACE);
    space_paths[made] = info->subactionPath;
    *out = (XrSpace)made;
    return XR_SUCCESS;
}

static int hand_of(XrPath path)
{
    return strstr(path_text(path), "right") != 0;
}

static XrResult rt_LocateSpace(XrSpace space, XrSpace base, XrTime time, XrSpaceLocation *out)
{
    ENTER(1);
    IS(space, SPACE);
    IS(base, SPACE);
    NEED(out->type == XR_TYPE_SPACE_LOCATION && time == now.time);
    out->locationFlags = XR_SPACE_LOCATION_ORIENTATION_VALID_BIT | XR_SPACE_LOCATION_POSITION_VALID_BIT;
    const XrPath of_hand = space_paths[(uintptr_t)space];      /* else it is the eyes' space */
    out->pose = of_hand ? hand_pose(hand_of(of_hand)) : now.seen.views[0].pose;
    return XR_SUCCESS;
}

static XrResult rt_SyncActions(XrSession session, const XrActionsSyncInfo *info)
{
    ENTER(1);
    IS(session, SESSION);
    NEED(info->type == XR_TYPE_ACTIONS_SYNC_INFO && info->countActiveActionSets == 1 && now.attached);
    now.synced = 1;
    return now.state == XR_SESSION_STATE_FOCUSED ? XR_SUCCESS : XR_SESSION_NOT_FOCUSED;
}

static int need_action(const XrActionStateGetInfo *info, XrActionType type)
{
    NEED(info->type == XR_TYPE_ACTION_STATE_GET_INFO && now.synced);
    IS(info->action, ACTION);
    NEED(now.action_types[(uintptr_t)info->action] == type);
    return hand_of(info->subactionPath);
}

static XrResult rt_GetActionStateBoolean(XrSession session, const XrActionStateGetInfo *info, XrActionStateBoolean *out)
{
    ENTER(1);
    IS(session, SESSION);
    const int right = need_action(info, XR_ACTION_TYPE_BOOLEAN_INPUT);
    NEED(out->type == XR_TYPE_ACTION_STATE_BOOLEAN);
    out->isActive = XR_TRUE;
    out->currentState = acts("stretch") || acts("turn") || (acts("pull") && right);
    return XR_SUCCESS;
}

static XrResult rt_GetActionStateVector2f(XrSession session, const XrActionStateGetInfo *info,
                                          XrActionStateVector2f *out)
{
    ENTER(1);
    IS(session, SESSION);
    const int right = need_action(info, XR_ACTION_TYPE_VECTOR2F_INPUT);
    NEED(out->type == XR_TYPE_ACTION_STATE_VECTOR2F);
    out->isActive = XR_TRUE;
    out->currentState = (XrVector2f){acts("step") && right ? 1.0f : 0, acts("walk") && !right ? 1.0f : 0};
    return XR_SUCCESS;
}

/* ---- Entry ------------------------------------------------------------------------------------------------------- */

#define CALLS(_) \
    _(EnumerateInstanceExtensionProperties) _(CreateInstance) _(DestroyInstance) _(GetInstanceProperties) \
    _(ResultToString) _(PollEvent) _(GetSystem) _(GetSystemProperties) _(EnumerateEnvironmentBlendModes) \
    _(EnumerateViewConfigurationViews) _(GetVulkanGraphicsRequirements2KHR) _(CreateVulkanInstanceKHR) \
    _(GetVulkanGraphicsDevice2KHR) _(CreateVulkanDeviceKHR) _(GetOpenGLESGraphicsRequirementsKHR) _(CreateSession) \
    _(DestroySession) _(BeginSession) _(EndSession) _(RequestExitSession) _(EnumerateReferenceSpaces) \
    _(CreateReferenceSpace) _(DestroySpace) _(EnumerateSwapchainFormats) _(CreateSwapchain) _(DestroySwapchain) \
    _(EnumerateSwapchainImages) _(AcquireSwapchainImage) _(WaitSwapchainImage) _(ReleaseSwapchainImage) _(WaitFrame) \
    _(BeginFrame) _(LocateViews) _(EndFrame) _(StringToPath) _(CreateActionSet) _(DestroyActionSet) _(CreateAction) \
    _(SuggestInteractionProfileBindings) _(AttachSessionActionSets) _(CreateActionSpace) _(LocateSpace) \
    _(SyncActions) _(GetActionStateBoolean) _(GetActionStateVector2f)

static XrResult rt_GetInstanceProcAddr(XrInstance instance, const char *name, PFN_xrVoidFunction *out)
{
    static const struct {
        const char *name;
        PFN_xrVoidFunction function;
    } calls[] = {
#define ROW(call) {"xr" #call, (PFN_xrVoidFunction)rt_##call},
        CALLS(ROW){"xrGetInstanceProcAddr", (PFN_xrVoidFunction)rt_GetInstanceProcAddr}};
    (void)instance;
    for (size_t i = 0; i < sizeof calls / sizeof *calls; i++)
        if (!strcmp(calls[i].name, name)) {
            *out = calls[i].function;
            return XR_SUCCESS;
        }
    *out = 0;
    return XR_ERROR_FUNCTION_UNSUPPORTED;
}

/* The loader's interface, version 1 (OpenXR's loader specification). */
typedef struct loader_info {
    int type;
    uint32_t version;
    size_t size;
    uint32_t least_interface, most_interface;
    XrVersion least_api, most_api;
} loader_info;

typedef struct runtime_info {
    int type;
    uint32_t version;
    size_t size;
    uint32_t interface;
    XrVersion api;
    PFN_xrGetInstanceProcAddr find;
} runtime_info;

__attribute__((visibility("default"))) XrResult xrNegotiateLoaderRuntimeInterface(const loader_info *loader,
                                                                                  runtime_info *out);
XrResult xrNegotiateLoaderRuntimeInterface(const loader_info *loader, runtime_info *out)
{
    if (loader->least_interface > 1 || out->size != sizeof *out)
        return XR_ERROR_INITIALIZATION_FAILED;
    out->interface = 1;
    out->api = XR_CURRENT_API_VERSION;
    out->find = rt_GetInstanceProcAddr;
    return XR_SUCCESS;
}

__attribute__((visibility("default"))) xr_runtime_fn xr_runtime;
const xr_runtime_seen *xr_runtime(void)
{
    return &now.seen;
}
