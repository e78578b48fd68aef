/* A loader of Vulkan functions for tests. It switches on the validation layer with synchronisation validation, and
   counts its messages. A chosen call may fail, as on a lost device or without memory; it does nothing then. */
#ifndef LOSING_VULKAN_H
#define LOSING_VULKAN_H

#include <dlfcn.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>

#include "kernels/vulkan/vk.h"

static PFN_vkGetInstanceProcAddr real_load;
static PFN_vkGetDeviceProcAddr real_load_of_device;
static PFN_vkCreateInstance real_CreateInstance;
static PFN_vkEnumeratePhysicalDevices real_EnumeratePhysicalDevices;
static PFN_vkCreateDevice real_CreateDevice;
static fxs_vk_functions real;
static const char *missing;                /* name of a function that the loader does not find; null: none */

static long calls_left = LONG_MAX;         /* number of calls that succeed before one fails */
static VkResult loss;
static unsigned long messages;             /* number of messages of the validation layer */
static int validated;                      /* 1: the validation layer is there */

/* 1 in a dispatch without a barrier before it, whose threads write other words of the buffers than those of the
   dispatch before. Synchronisation validation looks at buffers as a whole. */
static int side_by_side;
static int after_barrier;
static unsigned waits;                     /* number of barriers between dispatches */

static int is_losing(void)
{
    return calls_left != LONG_MAX && calls_left-- == 0;
}

static void lose_at(long calls, VkResult result)
{
    calls_left = calls;
    loss = result;
}

static struct messenger {
    VkInstance instance;
    VkDebugUtilsMessengerEXT messenger;
} messengers[4];

static VkBool32 VKAPI_PTR hear(VkDebugUtilsMessageSeverityFlagBitsEXT severity, VkDebugUtilsMessageTypeFlagsEXT kinds,
                               const VkDebugUtilsMessengerCallbackDataEXT *data, void *argument)
{
    (void)severity, (void)kinds, (void)argument;
    if (side_by_side && data->pMessageIdName && strstr(data->pMessageIdName, "SYNC-HAZARD"))
        return VK_FALSE;
    if (messages++ < 5)
        printf("  %.900s\n", data->pMessage);
    return VK_FALSE;
}

static int has_layer(const char *name)
{
    const PFN_vkEnumerateInstanceLayerProperties list =
        (PFN_vkEnumerateInstanceLayerProperties)real_load(0, "vkEnumerateInstanceLayerProperties");
    VkLayerProperties layers[32];
    uint32_t count = 32;
    list(&count, layers);
    while (count && strcmp(layers[count - 1].layerName, name))
        count--;
    return count > 0;
}

static VkResult VKAPI_PTR losing_CreateInstance(const VkInstanceCreateInfo *info,
                                                const VkAllocationCallbacks *allocator, VkInstance *instance)
{
    static const char *const layers[] = {"VK_LAYER_KHRONOS_validation"}, *const extensions[] = {"VK_EXT_debug_utils"};
    static const VkValidationFeatureEnableEXT enabled = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    static const VkValidationFeaturesEXT features = {.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                                     .enabledValidationFeatureCount = 1,
                                                     .pEnabledValidationFeatures = &enabled};
    static const VkDebugUtilsMessengerCreateInfoEXT messenger = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT, .pNext = &features,
        .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = hear};
    VkDebugUtilsMessengerCreateInfoEXT plain = messenger;
    VkInstanceCreateInfo own = *info;
    struct messenger *messenger_of;
    plain.pNext = 0;
    if (is_losing())
        return loss;
    validated = has_layer(layers[0]);
    if (!validated)
        return real_CreateInstance(info, allocator, instance);
    own.pNext = &messenger;
    own.enabledLayerCount = own.enabledExtensionCount = 1;
    own.ppEnabledLayerNames = layers;
    own.ppEnabledExtensionNames = extensions;
    const VkResult result = real_CreateInstance(&own, allocator, instance);
    if (result)
        return result;
    for (messenger_of = messengers; messenger_of->instance; messenger_of++)
        ;
    messenger_of->instance = *instance;
    return ((PFN_vkCreateDebugUtilsMessengerEXT)real_load(*instance, "vkCreateDebugUtilsMessengerEXT"))(
        *instance, &plain, allocator, &messenger_of->messenger);
}

static void VKAPI_PTR losing_DestroyInstance(VkInstance instance, const VkAllocationCallbacks *allocator)
{
    for (struct messenger *m = messengers; m < messengers + 4; m++)
        if (m->instance == instance) {
            ((PFN_vkDestroyDebugUtilsMessengerEXT)real_load(instance, "vkDestroyDebugUtilsMessengerEXT"))(
                instance, m->messenger, allocator);
            m->instance = 0;
        }
    ((PFN_vkDestroyInstance)real_load(instance, "vkDestroyInstance"))(instance, allocator);
}

static VkResult VKAPI_PTR losing_EnumeratePhysicalDevices(VkInstance instance, uint32_t *count,
                                                          VkPhysicalDevice *devices)
{
    return is_losing() ? loss : real_EnumeratePhysicalDevices(instance, count, devices);
}

static VkResult VKAPI_PTR losing_CreateDevice(VkPhysicalDevice physical, const VkDeviceCreateInfo *info,
                                              const VkAllocationCallbacks *allocator, VkDevice *device)
{
    return is_losing() ? loss : real_CreateDevice(physical, info, allocator, device);
}

#define LOSING(name, arguments, values) \
    static VkResult VKAPI_PTR losing_##name arguments \
    { \
        return is_losing() ? loss : real.name values; \
    }
#define LOSING_CREATE(name, Info, Made) \
    LOSING(name, (VkDevice d, const Info *i, const VkAllocationCallbacks *a, Made *m), (d, i, a, m))
LOSING(AllocateCommandBuffers, (VkDevice d, const VkCommandBufferAllocateInfo *i, VkCommandBuffer *m), (d, i, m))
LOSING(AllocateDescriptorSets, (VkDevice d, const VkDescriptorSetAllocateInfo *i, VkDescriptorSet *m), (d, i, m))
LOSING(BeginCommandBuffer, (VkCommandBuffer c, const VkCommandBufferBeginInfo *i), (c, i))
LOSING(BindBufferMemory, (VkDevice d, VkBuffer b, VkDeviceMemory m, VkDeviceSize at), (d, b, m, at))
LOSING(CreateComputePipelines, (VkDevice d, VkPipelineCache c, uint32_t n, const VkComputePipelineCreateInfo *i,
                                const VkAllocationCallbacks *a, VkPipeline *m), (d, c, n, i, a, m))
LOSING(EndCommandBuffer, (VkCommandBuffer c), (c))
LOSING(GetPipelineCacheData, (VkDevice d, VkPipelineCache c, size_t *n, void *to), (d, c, n, to))
LOSING(GetQueryPoolResults, (VkDevice d, VkQueryPool q, uint32_t first, uint32_t n, size_t bytes, void *to,
                             VkDeviceSize stride, VkQueryResultFlags flags), (d, q, first, n, bytes, to, stride, flags))
LOSING(MapMemory, (VkDevice d, VkDeviceMemory m, VkDeviceSize at, VkDeviceSize bytes, VkMemoryMapFlags flags,
                   void **to), (d, m, at, bytes, flags, to))
LOSING(QueueSubmit, (VkQueue q, uint32_t n, const VkSubmitInfo *i, VkFence f), (q, n, i, f))
LOSING(QueueWaitIdle, (VkQueue q), (q))
LOSING(ResetFences, (VkDevice d, uint32_t n, const VkFence *f), (d, n, f))
LOSING(WaitForFences, (VkDevice d, uint32_t n, const VkFence *f, VkBool32 all, uint64_t t), (d, n, f, all, t))
LOSING_CREATE(AllocateMemory, VkMemoryAllocateInfo, VkDeviceMemory)
LOSING_CREATE(CreateBuffer, VkBufferCreateInfo, VkBuffer)
LOSING_CREATE(CreateCommandPool, VkCommandPoolCreateInfo, VkCommandPool)
LOSING_CREATE(CreateDescriptorPool, VkDescriptorPoolCreateInfo, VkDescriptorPool)
LOSING_CREATE(CreateDescriptorSetLayout, VkDescriptorSetLayoutCreateInfo, VkDescriptorSetLayout)
LOSING_CREATE(CreateFence, VkFenceCreateInfo, VkFence)
LOSING_CREATE(CreatePipelineCache, VkPipelineCacheCreateInfo, VkPipelineCache)
LOSING_CREATE(CreatePipelineLayout, VkPipelineLayoutCreateInfo, VkPipelineLayout)
LOSING_CREATE(CreateQueryPool, VkQueryPoolCreateInfo, VkQueryPool)
LOSING_CREATE(CreateShaderModule, VkShaderModuleCreateInfo, VkShaderModule)

static void VKAPI_PTR losing_CmdPipelineBarrier(VkCommandBuffer c, VkPipelineStageFlags from, VkPipelineStageFlags to,
                                                VkDependencyFlags flags, uint32_t n, const VkMemoryBarrier *m,
                                                uint32_t buffers, const VkBufferMemoryBarrier *b, uint32_t images,
                                                const VkImageMemoryBarrier *i)
{
    after_barrier = 1;
    waits += from == to && !(to & VK_PIPELINE_STAGE_TRANSFER_BIT);
    real.CmdPipelineBarrier(c, from, to, flags, n, m, buffers, b, images, i);
}

static void VKAPI_PTR losing_CmdDispatch(VkCommandBuffer c, uint32_t x, uint32_t y, uint32_t z)
{
    side_by_side = !after_barrier;
    real.CmdDispatch(c, x, y, z);
    after_barrier = side_by_side = 0;
}

static void VKAPI_PTR losing_CmdDispatchIndirect(VkCommandBuffer c, VkBuffer b, VkDeviceSize at)
{
    side_by_side = !after_barrier;
    real.CmdDispatchIndirect(c, b, at);
    after_barrier = side_by_side = 0;
}

typedef struct losing_row {
    const char *name;
    PFN_vkVoidFunction function;
} losing_row;

static PFN_vkVoidFunction row_of(const losing_row *rows, size_t count, const char *name)
{
    for (size_t i = 0; i < count; i++)
        if (!strcmp(rows[i].name, name))
            return rows[i].function;
    return 0;
}
#define LOSES(name) {"vk" #name, (PFN_vkVoidFunction)losing_##name}

static PFN_vkVoidFunction VKAPI_PTR load_of_device(VkDevice device, const char *name)
{
    static const losing_row rows[] = {
        LOSES(AllocateCommandBuffers), LOSES(AllocateDescriptorSets), LOSES(BeginCommandBuffer),
        LOSES(BindBufferMemory), LOSES(CreateComputePipelines), LOSES(EndCommandBuffer), LOSES(GetPipelineCacheData),
        LOSES(GetQueryPoolResults), LOSES(MapMemory), LOSES(QueueSubmit), LOSES(QueueWaitIdle), LOSES(ResetFences),
        LOSES(WaitForFences), LOSES(AllocateMemory), LOSES(CreateBuffer), LOSES(CreateCommandPool),
        LOSES(CreateDescriptorPool), LOSES(CreateDescriptorSetLayout), LOSES(CreateFence), LOSES(CreatePipelineCache),
        LOSES(CreatePipelineLayout), LOSES(CreateQueryPool), LOSES(CreateShaderModule), LOSES(CmdPipelineBarrier),
        LOSES(CmdDispatch), LOSES(CmdDispatchIndirect)};
#define REAL(function) real.function = (PFN_vk##function)real_load_of_device(device, "vk" #function);
    FXS_VK_FUNCTIONS(REAL)
    const PFN_vkVoidFunction own = row_of(rows, sizeof rows / sizeof *rows, name);
    return missing && !strcmp(missing, name) ? 0 : own ? own : real_load_of_device(device, name);
}

static PFN_vkVoidFunction VKAPI_PTR losing_load(VkInstance instance, const char *name)
{
    static const losing_row rows[] = {LOSES(CreateInstance), LOSES(EnumeratePhysicalDevices), LOSES(CreateDevice),
                                      LOSES(DestroyInstance),
                                      {"vkGetDeviceProcAddr", (PFN_vkVoidFunction)load_of_device}};
    const PFN_vkVoidFunction found = real_load(instance, name), own = row_of(rows, sizeof rows / sizeof *rows, name);
#define KEEP(type, pointer) \
    if (!strcmp(name, "vk" #type)) \
        pointer = (PFN_vk##type)found;
    KEEP(CreateInstance, real_CreateInstance)
    KEEP(EnumeratePhysicalDevices, real_EnumeratePhysicalDevices)
    KEEP(CreateDevice, real_CreateDevice)
    KEEP(GetDeviceProcAddr, real_load_of_device)
    return missing && !strcmp(missing, name) ? 0 : own ? own : found;
}

/* Loads Vulkan's loader. Returns 0 if it is not here. */
static int load_vulkan(void)
{
    void *library = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
    void *address = library ? dlsym(library, "vkGetInstanceProcAddr") : 0;
    memcpy(&real_load, &address, sizeof real_load);
    return address != 0;
}

#endif
