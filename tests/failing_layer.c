/* A layer of Vulkan for tests, above the validation layer: counts the calls of the back end, and fails a chosen call,
   as on a lost device or without memory. A failing call that waits still waits, so that nothing is pending; others do
   nothing. The layer prints and counts the messages of the validation layer. test_vulkan sets fxs_failing; a command
   is told by FXS_FAIL_AT (number of the call, from 0), FXS_FAIL_WITH (a VkResult), FXS_FAIL_EVER (set: all later calls
   fail too), FXS_FAIL_LOG (file for the number of calls) and FXS_FAIL_SHADERS (set: no shader runs). All devices of a
   process must have one driver. */
#include "failing_layer.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vk_layer.h>

#include "kernels/vulkan/vk.h"

EXPORT fxs_failing_layer fxs_failing = {.fails_at = -1};

static fxs_vk_functions real;
static PFN_vkGetInstanceProcAddr next_of_instance;
static PFN_vkGetDeviceProcAddr next_of_device;
static PFN_vkDestroyInstance real_DestroyInstance;
static PFN_vkEnumeratePhysicalDevices real_EnumeratePhysicalDevices;
static PFN_vkCreateDebugUtilsMessengerEXT create_messenger;
static PFN_vkDestroyDebugUtilsMessengerEXT destroy_messenger;

static struct messenger {
    VkInstance instance;
    VkDebugUtilsMessengerEXT messenger;
} messengers[4];

static int fails(void)
{
    const long call = fxs_failing.calls++;
    return fxs_failing.fails_at >= 0 &&
           (fxs_failing.ever ? call >= fxs_failing.fails_at : call == fxs_failing.fails_at);
}

static VkBool32 VKAPI_PTR hear(VkDebugUtilsMessageSeverityFlagBitsEXT severity, VkDebugUtilsMessageTypeFlagsEXT kinds,
                               const VkDebugUtilsMessengerCallbackDataEXT *data, void *argument)
{
    (void)severity, (void)kinds, (void)argument;
    if (fxs_failing.messages++ < 5)
        fprintf(stderr, "layer: %.900s\n", data->pMessage);
    return VK_FALSE;
}

static void read_environment(void)
{
    const char *at = getenv("FXS_FAIL_AT"), *with = getenv("FXS_FAIL_WITH");
    if (!at || !with)
        return;
    fxs_failing.fails_at = strtol(at, 0, 10);
    fxs_failing.result = (VkResult)strtol(with, 0, 10);
    fxs_failing.ever = getenv("FXS_FAIL_EVER") != 0;
}

/* Finds the loader's record of the next layer in the chain of a CreateInfo. */
#define NEXT_LAYER(Info, info, type) \
    Info *chain = (Info *)(uintptr_t)(info)->pNext; \
    while (chain->sType != type || chain->function != VK_LAYER_LINK_INFO) \
        chain = (Info *)(uintptr_t)chain->pNext;

static VkResult VKAPI_PTR failing_CreateInstance(const VkInstanceCreateInfo *info,
                                                 const VkAllocationCallbacks *allocator, VkInstance *instance)
{
    static const char *const extensions[] = {"VK_EXT_debug_utils"};
    static const VkValidationFeatureEnableEXT enabled = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    const VkValidationFeaturesEXT features = {.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT, .pNext = info->pNext,
                                              .enabledValidationFeatureCount = 1,
                                              .pEnabledValidationFeatures = &enabled};
    VkDebugUtilsMessengerCreateInfoEXT messenger = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT, .pNext = &features,
        .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = hear};
    VkInstanceCreateInfo own = *info;
    struct messenger *m = messengers;
    NEXT_LAYER(VkLayerInstanceCreateInfo, info, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO)
    read_environment();
    if (fails())
        return fxs_failing.result;
    next_of_instance = chain->u.pLayerInfo->pfnNextGetInstanceProcAddr;
    chain->u.pLayerInfo = chain->u.pLayerInfo->pNext;
    const int is_validated = chain->u.pLayerInfo != 0;     /* a layer is below */
    if (is_validated) {
        own.pNext = &messenger;
        own.enabledExtensionCount = 1;
        own.ppEnabledExtensionNames = extensions;
    }
    const VkResult result = ((PFN_vkCreateInstance)next_of_instance(0, "vkCreateInstance"))(&own, allocator, instance);
    if (result)
        return result;
#define NEXT(variable, name) variable = (PFN_vk##name)next_of_instance(*instance, "vk" #name);
    NEXT(real_DestroyInstance, DestroyInstance)
    NEXT(real_EnumeratePhysicalDevices, EnumeratePhysicalDevices)
    NEXT(create_messenger, CreateDebugUtilsMessengerEXT)
    NEXT(destroy_messenger, DestroyDebugUtilsMessengerEXT)
    while (m->instance)
        m++;
    m->instance = *instance;
    messenger.pNext = 0;
    return is_validated ? create_messenger(*instance, &messenger, 0, &m->messenger) : VK_SUCCESS;
}

static void write_calls(const char *path)
{
    FILE *log = path ? fopen(path, "w") : 0;
    if (!log)
        return;
    fprintf(log, "%ld\n", fxs_failing.calls);
    fclose(log);
}

static void VKAPI_PTR failing_DestroyInstance(VkInstance instance, const VkAllocationCallbacks *allocator)
{
    struct messenger *m = messengers;
    write_calls(getenv("FXS_FAIL_LOG"));
    while (m->instance != instance)
        m++;
    if (m->messenger)
        destroy_messenger(instance, m->messenger, 0);
    *m = (struct messenger){0};
    real_DestroyInstance(instance, allocator);
}

static VkResult VKAPI_PTR failing_EnumeratePhysicalDevices(VkInstance instance, uint32_t *count,
                                                           VkPhysicalDevice *devices)
{
    return fails() ? fxs_failing.result : real_EnumeratePhysicalDevices(instance, count, devices);
}

static VkResult VKAPI_PTR failing_CreateDevice(VkPhysicalDevice physical, const VkDeviceCreateInfo *info,
                                               const VkAllocationCallbacks *allocator, VkDevice *device)
{
    NEXT_LAYER(VkLayerDeviceCreateInfo, info, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO)
    const PFN_vkCreateDevice create =
        (PFN_vkCreateDevice)chain->u.pLayerInfo->pfnNextGetInstanceProcAddr(0, "vkCreateDevice");
    next_of_device = chain->u.pLayerInfo->pfnNextGetDeviceProcAddr;
    chain->u.pLayerInfo = chain->u.pLayerInfo->pNext;
    const VkResult result = fails() ? fxs_failing.result : create(physical, info, allocator, device);
    if (result)
        return result;
#define REAL(name) real.name = (PFN_vk##name)next_of_device(*device, "vk" #name);
    FXS_VK_FUNCTIONS(REAL)
    return VK_SUCCESS;
}

#define FAILING(name, arguments, values) \
    static VkResult VKAPI_PTR failing_##name arguments \
    { \
        return fails() ? fxs_failing.result : real.name values; \
    }
#define FAILING_CREATE(name, Info, Made) \
    FAILING(name, (VkDevice d, const Info *i, const VkAllocationCallbacks *a, Made *m), (d, i, a, m))
#define FAILING_WAIT(name, arguments, values) \
    static VkResult VKAPI_PTR failing_##name arguments \
    { \
        const VkResult result = real.name values; \
        return fails() ? fxs_failing.result : result; \
    }
FAILING(AllocateCommandBuffers, (VkDevice d, const VkCommandBufferAllocateInfo *i, VkCommandBuffer *m), (d, i, m))
FAILING(AllocateDescriptorSets, (VkDevice d, const VkDescriptorSetAllocateInfo *i, VkDescriptorSet *m), (d, i, m))
FAILING(BeginCommandBuffer, (VkCommandBuffer c, const VkCommandBufferBeginInfo *i), (c, i))
FAILING(BindBufferMemory, (VkDevice d, VkBuffer b, VkDeviceMemory m, VkDeviceSize at), (d, b, m, at))
FAILING(CreateComputePipelines, (VkDevice d, VkPipelineCache c, uint32_t n, const VkComputePipelineCreateInfo *i,
                                 const VkAllocationCallbacks *a, VkPipeline *m), (d, c, n, i, a, m))
FAILING(EndCommandBuffer, (VkCommandBuffer c), (c))
FAILING(GetPipelineCacheData, (VkDevice d, VkPipelineCache c, size_t *n, void *to), (d, c, n, to))
FAILING(GetQueryPoolResults, (VkDevice d, VkQueryPool q, uint32_t first, uint32_t n, size_t bytes, void *to,
                              VkDeviceSize stride, VkQueryResultFlags flags),
        (d, q, first, n, bytes, to, stride, flags))
FAILING(MapMemory, (VkDevice d, VkDeviceMemory m, VkDeviceSize at, VkDeviceSize bytes, VkMemoryMapFlags flags,
                    void **to), (d, m, at, bytes, flags, to))
FAILING(QueueSubmit, (VkQueue q, uint32_t n, const VkSubmitInfo *i, VkFence f), (q, n, i, f))
FAILING(ResetFences, (VkDevice d, uint32_t n, const VkFence *f), (d, n, f))
FAILING_WAIT(QueueWaitIdle, (VkQueue q), (q))
FAILING_WAIT(WaitForFences, (VkDevice d, uint32_t n, const VkFence *f, VkBool32 all, uint64_t t), (d, n, f, all, t))
FAILING_CREATE(AllocateMemory, VkMemoryAllocateInfo, VkDeviceMemory)
FAILING_CREATE(CreateBuffer, VkBufferCreateInfo, VkBuffer)
FAILING_CREATE(CreateCommandPool, VkCommandPoolCreateInfo, VkCommandPool)
FAILING_CREATE(CreateDescriptorPool, VkDescriptorPoolCreateInfo, VkDescriptorPool)
FAILING_CREATE(CreateDescriptorSetLayout, VkDescriptorSetLayoutCreateInfo, VkDescriptorSetLayout)
FAILING_CREATE(CreateFence, VkFenceCreateInfo, VkFence)
FAILING_CREATE(CreatePipelineCache, VkPipelineCacheCreateInfo, VkPipelineCache)
FAILING_CREATE(CreatePipelineLayout, VkPipelineLayoutCreateInfo, VkPipelineLayout)
FAILING_CREATE(CreateQueryPool, VkQueryPoolCreateInfo, VkQueryPool)
FAILING_CREATE(CreateShaderModule, VkShaderModuleCreateInfo, VkShaderModule)

static void VKAPI_PTR failing_CmdPipelineBarrier(VkCommandBuffer c, VkPipelineStageFlags from, VkPipelineStageFlags to,
                                                 VkDependencyFlags flags, uint32_t n, const VkMemoryBarrier *m,
                                                 uint32_t buffers, const VkBufferMemoryBarrier *b, uint32_t images,
                                                 const VkImageMemoryBarrier *i)
{
    fxs_failing.waits += from == to && !(to & VK_PIPELINE_STAGE_TRANSFER_BIT);
    real.CmdPipelineBarrier(c, from, to, flags, n, m, buffers, b, images, i);
}

static void VKAPI_PTR failing_CmdDispatch(VkCommandBuffer c, uint32_t x, uint32_t y, uint32_t z)
{
    if (!getenv("FXS_FAIL_SHADERS"))
        real.CmdDispatch(c, x, y, z);
}

typedef struct row {
    const char *name;
    PFN_vkVoidFunction function;
} row;

static PFN_vkVoidFunction row_of(const row *rows, size_t count, const char *name)
{
    for (size_t i = 0; i < count; i++)
        if (!strcmp(rows[i].name, name))
            return rows[i].function;
    return 0;
}
#define ROW(name) {"vk" #name, (PFN_vkVoidFunction)failing_##name}

EXPORT PFN_vkVoidFunction VKAPI_PTR fxs_failing_of_device(VkDevice device, const char *name)
{
    static const row rows[] = {
        {"vkGetDeviceProcAddr", (PFN_vkVoidFunction)fxs_failing_of_device},
        ROW(AllocateCommandBuffers), ROW(AllocateDescriptorSets), ROW(BeginCommandBuffer), ROW(BindBufferMemory),
        ROW(CreateComputePipelines), ROW(EndCommandBuffer), ROW(GetPipelineCacheData), ROW(GetQueryPoolResults),
        ROW(MapMemory), ROW(QueueSubmit), ROW(QueueWaitIdle), ROW(ResetFences), ROW(WaitForFences),
        ROW(AllocateMemory), ROW(CreateBuffer), ROW(CreateCommandPool), ROW(CreateDescriptorPool),
        ROW(CreateDescriptorSetLayout), ROW(CreateFence), ROW(CreatePipelineCache), ROW(CreatePipelineLayout),
        ROW(CreateQueryPool), ROW(CreateShaderModule), ROW(CmdDispatch), ROW(CmdPipelineBarrier)};
    const PFN_vkVoidFunction own = row_of(rows, sizeof rows / sizeof *rows, name);
    return own ? own : next_of_device(device, name);
}

EXPORT PFN_vkVoidFunction VKAPI_PTR fxs_failing_of_instance(VkInstance instance, const char *name)
{
    static const row rows[] = {ROW(CreateInstance), ROW(EnumeratePhysicalDevices), ROW(CreateDevice),
                               ROW(DestroyInstance),
                               {"vkGetInstanceProcAddr", (PFN_vkVoidFunction)fxs_failing_of_instance},
                               {"vkGetDeviceProcAddr", (PFN_vkVoidFunction)fxs_failing_of_device}};
    const PFN_vkVoidFunction own = row_of(rows, sizeof rows / sizeof *rows, name);
    return own ? own : next_of_instance ? next_of_instance(instance, name) : 0;
}

EXPORT VkResult VKAPI_PTR vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface *version)
{
    version->loaderLayerInterfaceVersion = 2;
    version->pfnGetInstanceProcAddr = fxs_failing_of_instance;
    version->pfnGetDeviceProcAddr = fxs_failing_of_device;
    version->pfnGetPhysicalDeviceProcAddr = 0;
    return VK_SUCCESS;
}
