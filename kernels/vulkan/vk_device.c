/* Creates the Vulkan back end: checks the device, and makes the pipelines. */
#include <stdlib.h>
#include <string.h>

#include "vk.h"
#include "shaders.h"

/* The programs in SPIR-V, packed; a row per variant of the device's features. */
static const struct {
    const uint8_t *packed;
    size_t bytes;
} programs[1][FXS_VK_PROGRAMS] = {{
#define PROGRAM(entry) {entry##_spv, sizeof entry##_spv},
    FXS_COMPUTE_PROGRAMS_OF(PROGRAM)
    PROGRAM(convert)
}};

static int load_functions(fxs_vulkan *v, fxs_message *why)
{
    const fxs_vulkan_options *o = &v->options;
    const PFN_vkGetDeviceProcAddr load = (PFN_vkGetDeviceProcAddr)o->load(o->instance, "vkGetDeviceProcAddr");
    if (!load)
        return fxs_plan_say(why, FXS_ERR_UNSUPPORTED, "no Vulkan 1.1: no function ", "vkGetDeviceProcAddr");
#define LOADED(name, by, from) \
    v->vk.name = (PFN_vk##name)by(from, "vk" #name); \
    if (!v->vk.name) \
        return fxs_plan_say(why, FXS_ERR_UNSUPPORTED, "no Vulkan 1.1: no function vk", #name);
#define OF_DEVICE(name) LOADED(name, load, o->device)
#define OF_INSTANCE(name) LOADED(name, o->load, o->instance)
    FXS_VK_INSTANCE_FUNCTIONS(OF_INSTANCE)
    FXS_VK_FUNCTIONS(OF_DEVICE)
    return 0;
}

static int check_queue(fxs_vulkan *v, fxs_message *why)
{
    enum { MOST = 16 };
    VkQueueFamilyProperties families[MOST];
    uint32_t count = MOST;
    v->vk.GetPhysicalDeviceQueueFamilyProperties(v->options.physical, &count, families);
    if (v->options.family >= count || !(families[v->options.family].queueFlags & VK_QUEUE_COMPUTE_BIT))
        return fxs_plan_say(why, FXS_ERR_UNSUPPORTED, "the queue is without compute", "");
    const uint32_t bits = families[v->options.family].timestampValidBits;
    v->timestamp_mask = bits >= 64 ? UINT64_MAX : ((uint64_t)1 << bits) - 1;
    v->graphics = (families[v->options.family].queueFlags & VK_QUEUE_GRAPHICS_BIT) != 0;
    return 0;
}

static int check_device(fxs_vulkan *v, fxs_message *why)
{
    VkPhysicalDeviceMaintenance3Properties more = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES};
    VkPhysicalDeviceProperties2 all = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &more};
    v->vk.GetPhysicalDeviceProperties2(v->options.physical, &all);
    v->vk.GetPhysicalDeviceMemoryProperties(v->options.physical, &v->memories);
    const VkPhysicalDeviceLimits *limits = &all.properties.limits;
    memcpy(v->name, all.properties.deviceName, sizeof v->name - 1);
    v->rooms.finishes = fxs_plan_finishes(v->name);
    v->timestamp_nanoseconds = (double)limits->timestampPeriod;
    v->most_allocated = more.maxMemoryAllocationSize;
    const uint64_t most = limits->maxStorageBufferRange;
    v->rooms.most = (most < v->most_allocated ? most : v->most_allocated) / FXS_VK_ALIGNED * FXS_VK_ALIGNED;
    const char *lacks = all.properties.apiVersion < VK_API_VERSION_1_1 ? "Vulkan 1.1 is needed"
                        : limits->maxComputeWorkGroupInvocations < FXS_COMPUTE_THREADS
                            ? "workgroups of fewer than 128 threads"
                        : limits->maxComputeSharedMemorySize < 16384 ? "less than 16 KiB of memory of a workgroup"
                        : v->rooms.most < 1 << 24 ? "storage buffers of less than 16 MiB"
                        : limits->maxPerStageDescriptorStorageBuffers < 4
                            ? "fewer than 4 storage buffers in a compute shader" : 0;
    return lacks ? fxs_plan_say(why, FXS_ERR_UNSUPPORTED, lacks, "") : check_queue(v, why);
}

static VkResult make_layouts(fxs_vulkan *v)
{
    VkDescriptorSetLayoutBinding bindings[6];
    for (uint32_t i = 0; i < 6; i++)
        bindings[i] = (VkDescriptorSetLayoutBinding){
            i, i < 2 ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1,
            VK_SHADER_STAGE_COMPUTE_BIT, 0};
    const VkDescriptorSetLayoutCreateInfo set = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                                 .bindingCount = 6, .pBindings = bindings};
    VkResult result = v->vk.CreateDescriptorSetLayout(v->options.device, &set, v->options.allocator, &v->set_layout);
    const VkPushConstantRange push = {VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(fxs_vk_conversion)};
    const VkPipelineLayoutCreateInfo layout = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                               .setLayoutCount = 1, .pSetLayouts = &v->set_layout,
                                               .pushConstantRangeCount = 1, .pPushConstantRanges = &push};
    return result ? result
                  : v->vk.CreatePipelineLayout(v->options.device, &layout, v->options.allocator, &v->layout);
}

/* Unpacks 32-bit words of 7 bits a byte, lowest bits first; bit 7 is set in all bytes of a word but its last. Returns
   the bytes of the words. */
static size_t unpack(uint32_t *words, const uint8_t *packed, size_t bytes)
{
    size_t count = 0;
    uint32_t word = 0;
    for (size_t i = 0, shift = 0; i < bytes; i++) {
        word |= (uint32_t)(packed[i] & 127) << shift;
        shift += 7;
        if (packed[i] < 128) {
            words[count++] = word;
            word = 0;
            shift = 0;
        }
    }
    return count * sizeof *words;
}

VkResult fxs_vk_make_module(const fxs_vulkan *v, const uint8_t *packed, size_t bytes, VkShaderModule *module)
{
    const fxs_vulkan_options *o = &v->options;
    uint32_t *words = malloc(bytes * sizeof *words);       /* a word takes at least a byte */
    if (!words)
        return VK_ERROR_OUT_OF_HOST_MEMORY;
    const VkShaderModuleCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                           .codeSize = unpack(words, packed, bytes), .pCode = words};
    const VkResult result = v->vk.CreateShaderModule(o->device, &info, o->allocator, module);
    free(words);
    return result;
}

static VkResult make_pipelines(fxs_vulkan *v)
{
    const fxs_vulkan_options *o = &v->options;
    VkShaderModule modules[FXS_VK_PROGRAMS] = {0};
    VkComputePipelineCreateInfo infos[FXS_VK_PROGRAMS];
    VkResult result = VK_SUCCESS;
    for (int i = 0; i < FXS_VK_PROGRAMS && !result; i++) {
        result = fxs_vk_make_module(v, programs[0][i].packed, programs[0][i].bytes, &modules[i]);
        infos[i] = (VkComputePipelineCreateInfo){
            .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO, .layout = v->layout,
            .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                      .stage = VK_SHADER_STAGE_COMPUTE_BIT, .module = modules[i], .pName = "main"}};
    }
    if (!result)
        result = v->vk.CreateComputePipelines(o->device, v->cache, FXS_VK_PROGRAMS, infos, o->allocator,
                                              v->programs);
    for (int i = 0; i < FXS_VK_PROGRAMS; i++)
        v->vk.DestroyShaderModule(o->device, modules[i], o->allocator);
    return result;
}

static int make_objects(fxs_vulkan *v, int renders, fxs_message *why)
{
    const fxs_vulkan_options *o = &v->options;
    const VkPipelineCacheCreateInfo cache = {.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO,
                                             .initialDataSize = o->cache ? o->cache_bytes : 0,
                                             .pInitialData = o->cache};
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                          .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                          .queueFamilyIndex = o->family};
    const VkQueryPoolCreateInfo queries = {.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                           .queryType = VK_QUERY_TYPE_TIMESTAMP, .queryCount = 2 * FXS_VK_SLOTS};
    VkResult result = renders ? make_layouts(v) : VK_SUCCESS;
    result = result ? result : v->vk.CreatePipelineCache(o->device, &cache, o->allocator, &v->cache);
    if (!result && renders)
        result = make_pipelines(v);
    result = result ? result : v->vk.CreateCommandPool(o->device, &pool, o->allocator, &v->commands);
    if (!result && v->timestamp_mask)
        result = v->vk.CreateQueryPool(o->device, &queries, o->allocator, &v->queries);
    return fxs_vk_said(result, why);
}

static void end(fxs_vulkan *v)
{
    const fxs_vulkan_options *o = &v->options;
    fxs_vulkan_idle(v);
    fxs_vk_give_back(v);
    while (v->scenes)
        fxs_vulkan_drop(v, v->scenes->key);
    for (int i = 0; i < FXS_VK_PROGRAMS; i++)
        v->vk.DestroyPipeline(o->device, v->programs[i], o->allocator);
    v->vk.DestroyPipelineCache(o->device, v->cache, o->allocator);
    v->vk.DestroyPipelineLayout(o->device, v->layout, o->allocator);
    v->vk.DestroyDescriptorSetLayout(o->device, v->set_layout, o->allocator);
    v->vk.DestroyQueryPool(o->device, v->queries, o->allocator);
    v->vk.DestroyCommandPool(o->device, v->commands, o->allocator);
    free(v->memory);
}

static int begin(fxs_vulkan *v, int renders, fxs_message *why)
{
    const fxs_vulkan_options *o = &v->options;
    if (!o->load || !o->instance || !o->physical || !o->device || !o->queue || !o->allocate != !o->free ||
        o->frames > FXS_VULKAN_FRAMES)
        return fxs_plan_say(why, FXS_ERR_ARGUMENT, "an option of the Vulkan back end is missing or out of range", "");
    int error = load_functions(v, why);
    error = error ? error : check_device(v, why);
    if (error)
        return error;
    error = make_objects(v, renders, why);
    if (error)
        end(v);
    return error;
}

int fxs_vk_create(fxs_vulkan **out, const fxs_vulkan_options *options, int renders, fxs_message *why)
{
    fxs_vulkan *v = *out = calloc(1, sizeof *v);
    if (!v)
        return fxs_plan_say(why, FXS_ERR_MEMORY, "out of memory", "");
    memcpy(&v->options, options, options->size < sizeof *options ? options->size : sizeof *options);
    v->options.frames = v->options.frames ? v->options.frames : 2;
    const int error = begin(v, renders, why);
    if (error) {
        free(v);
        *out = 0;
    }
    return error;
}

int fxs_vulkan_create(fxs_vulkan **out, const fxs_vulkan_options *options, fxs_message *why)
{
    return fxs_vk_create(out, options, 1, why);
}

void fxs_vulkan_destroy(fxs_vulkan *v)
{
    if (v)
        end(v);
    free(v);
}

fxs_vulkan_info fxs_vulkan_get_info(const fxs_vulkan *v)
{
    return (fxs_vulkan_info){v->name, v->nanoseconds, v->taken, v->missing};
}

void fxs_vulkan_limit(fxs_vulkan *v, uint64_t bytes)
{
    v->options.max_memory = bytes;
}

int fxs_vulkan_cache(fxs_vulkan *v, void *to, size_t *bytes, fxs_message *why)
{
    return fxs_vk_said(v->vk.GetPipelineCacheData(v->options.device, v->cache, bytes, to), why);
}
