/* Opens a device for a fit: makes the pipelines, and tests that the device computes as IEEE 754 asks. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/message.h>
#include "vf.h"
#include "shaders.h"
#include "src/base/random.h"
#include "src/base/run.h"
#include "src/fit/stages/fit_lanes.h"

static const struct {
    const uint8_t *packed;
    size_t bytes;
} shaders[VF_COUNT] = {
#define SHADER(name) {name##_spv, sizeof name##_spv},
    VF_SHADERS(SHADER)
};

enum { PUSHED = 2 * sizeof(uint32_t) + sizeof(fit_rebuilt) };

static VkResult make_layouts(vf_engine *e)
{
    fxs_vulkan *v = e->v;
    VkDescriptorSetLayoutBinding bindings[VF_BUFFERS];
    VkDescriptorSetLayout layouts[VF_SETS];
    for (uint32_t i = 0; i < VF_BUFFERS; i++)
        bindings[i] = (VkDescriptorSetLayoutBinding){i, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1,
                                                     VK_SHADER_STAGE_COMPUTE_BIT, 0};
    const VkDescriptorSetLayoutCreateInfo set = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                                 .bindingCount = VF_BUFFERS, .pBindings = bindings};
    VkResult result = v->vk.CreateDescriptorSetLayout(v->options.device, &set, 0, &e->set_layout);
    const VkPushConstantRange push = {VK_SHADER_STAGE_COMPUTE_BIT, 0, PUSHED};
    const VkPipelineLayoutCreateInfo layout = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                               .setLayoutCount = 1, .pSetLayouts = &e->set_layout,
                                               .pushConstantRangeCount = 1, .pPushConstantRanges = &push};
    result = result ? result : v->vk.CreatePipelineLayout(v->options.device, &layout, 0, &e->layout);
    const VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VF_SETS * VF_BUFFERS};
    const VkDescriptorPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                             .maxSets = VF_SETS, .poolSizeCount = 1, .pPoolSizes = &size};
    result = result ? result : v->vk.CreateDescriptorPool(v->options.device, &pool, 0, &e->pool);
    for (int i = 0; i < VF_SETS; i++)
        layouts[i] = e->set_layout;
    const VkDescriptorSetAllocateInfo sets = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                              .descriptorPool = e->pool, .descriptorSetCount = VF_SETS,
                                              .pSetLayouts = layouts};
    result = result ? result : v->vk.AllocateDescriptorSets(v->options.device, &sets, e->sets);
    const VkQueryPoolCreateInfo queries = {.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                           .queryType = VK_QUERY_TYPE_TIMESTAMP, .queryCount = VF_STAGES + 1};
    return result || !v->timestamp_mask ? result
                                        : v->vk.CreateQueryPool(v->options.device, &queries, 0, &e->queries);
}

/* What the shaders are specialised for, in the order of their constants. */
typedef struct traits {
    uint32_t has_fma;              /* 1: fused multiply-adds are fused */
    uint32_t subgroup;             /* threads of a subgroup, 16, 32 or 64; 0: others, or subgroups are not full */
    uint32_t splats, pairs;        /* of a batch of backward_tiles */
} traits;

typedef struct making {
    vf_engine *e;
    uint32_t first;
    const traits *made_for;
    VkResult results[VF_COUNT];
} making;

/* Makes shader `job`; a job of its own each, because drivers take long to compile some. */
static void make_program(void *argument, uint32_t job)
{
    making *m = argument;
    fxs_vulkan *v = m->e->v;
    const uint32_t i = m->first + job;
    VkSpecializationMapEntry entries[sizeof(traits) / sizeof(uint32_t)];
    for (uint32_t k = 0; k < sizeof(traits) / sizeof(uint32_t); k++)
        entries[k] = (VkSpecializationMapEntry){k, k * sizeof(uint32_t), sizeof(uint32_t)};
    const VkSpecializationInfo constants = {sizeof entries / sizeof *entries, entries, sizeof(traits), m->made_for};
    VkShaderModule module = VK_NULL_HANDLE;
    m->results[i] = fxs_vk_make_module(v, shaders[i].packed, shaders[i].bytes, &module);
    const VkComputePipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO, .layout = m->e->layout,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                  .module = module, .pName = "main", .pSpecializationInfo = &constants}};
    if (!m->results[i])
        m->results[i] = v->vk.CreateComputePipelines(v->options.device, v->cache, 1, &info, 0, &m->e->programs[i]);
    v->vk.DestroyShaderModule(v->options.device, module, 0);
}

/* Makes the shaders first..end. */
static VkResult make_programs(vf_engine *e, uint32_t first, uint32_t end, const traits *made_for)
{
    making m = {.e = e, .first = first, .made_for = made_for};
    VkResult result = VK_SUCCESS;
    (e->run ? e->run : fxs_run_here)(e->workers, make_program, &m, end - first);
    for (uint32_t i = first; i < end && !result; i++)
        result = m.results[i];
    return result;
}

/* Checks what the device offers, and chooses the batches of backward_tiles by the memory of a workgroup. */
static int check_limits(const vf_engine *e, traits *found, fxs_message *why)
{
    VkPhysicalDeviceSubgroupProperties subgroups = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES};
    VkPhysicalDeviceProperties2 all = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &subgroups};
    e->v->vk.GetPhysicalDeviceProperties2(e->v->options.physical, &all);
    const VkPhysicalDeviceLimits *limits = &all.properties.limits;
    const char *lacks = limits->maxComputeWorkGroupInvocations < 256 ? "workgroups of fewer than 256 threads"
                        : limits->maxComputeSharedMemorySize < 32768 ? "less than 32 KiB of memory of a workgroup"
                        : limits->maxPerStageDescriptorStorageBuffers < VF_BUFFERS
                            ? "fewer than 9 storage buffers in a compute shader"
                        : !(subgroups.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT) ||
                            !(subgroups.supportedOperations & VK_SUBGROUP_FEATURE_BALLOT_BIT)
                            ? "no ballots in compute shaders" : 0;
    const int is_large = limits->maxComputeSharedMemorySize >= 49152;
    found->splats = is_large ? 128 : 64;
    found->pairs = is_large ? 448 : 192;
    return lacks ? fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "%s cannot fit: %s", e->device.name, lacks) : 0;
}

/* Returns the largest number of Gaussians. llvmpipe ends the loops of a shader after 65535 turns in all, without an
   error; a shader makes fewer than 64 turns for each splat of a tile. */
static size_t most_gaussians(const char *name)
{
    return strstr(name, "llvmpipe") ? 65535 / 64 : UINT32_MAX / (4 * FXS_FIT_PARAMETERS);
}

/* The test of the arithmetic: results that a device may round otherwise, of pairs of numbers of all sizes. The last two
   may differ: whether the device's fma is fused, and the threads of a subgroup. */
enum { TESTED = 1024, RESULTS = 8, FMA = RESULTS - 2, THREADS = RESULTS - 1 };

static float test_number(uint64_t i)
{
    const uint64_t random = fxs_random(1, i, 2);
    const uint32_t exponent = 127 - 30 + (uint32_t)(random >> 32) % 60;
    return real_of((whole)(((uint32_t)random & 0x807fffffu) | exponent << 23));
}

static void find_results(float a, float b, float results[RESULTS])
{
    const float bounded = least(most(a, -80), 80);
    results[0] = a / b;
    results[1] = root(absolute(a));
    results[2] = a * b + 1.0f;
    results[3] = a - b * 0.3f;
    results[4] = exp_e(bounded);
    results[5] = ln(absolute(a));
    results[FMA] = (float)((double)a * (double)b - (double)(a * b));
}

/* Returns whether all results are right, and finds the traits of fma and of subgroups. */
static int are_right(const float *numbers, const float *results, traits *found)
{
    int are_equal = 1;
    found->has_fma = 1;
    found->subgroup = results[THREADS] == 16 ? 16 : results[THREADS] == 32 ? 32 : results[THREADS] == 64 ? 64 : 0;
    for (int i = 0; i < TESTED; i++, results += RESULTS) {
        float expected[RESULTS];
        find_results(numbers[2 * i], numbers[2 * i + 1], expected);
        are_equal &= !memcmp(expected, results, FMA * sizeof *expected);
        found->has_fma &= !memcmp(expected + FMA, results + FMA, sizeof *expected);
        found->subgroup = results[THREADS] == (float)found->subgroup ? found->subgroup : 0;
    }
    return are_equal;
}

static int test_arithmetic(vf_engine *e, int *is_right, traits *found, fxs_message *why)
{
    float numbers[2 * TESTED], results[RESULTS * TESTED];
    const vf_copy sent = {VF_PARAMETERS, 0, numbers, sizeof numbers};
    const vf_copy fetched = {VF_MASTERS, 0, results, sizeof results};
    for (uint64_t i = 0; i < 2 * TESTED; i++)
        numbers[i] = test_number(i);
    int error = fxs_vk_reserve(e->v, &e->blocks[VF_PARAMETERS], FXS_VK_DEVICE, sizeof numbers, why);
    error = error ? error : fxs_vk_reserve(e->v, &e->blocks[VF_MASTERS], FXS_VK_DEVICE, sizeof results, why);
    if (!error)
        vf_bind(e, 0, e->blocks);
    error = error ? error : vf_send(e, &sent, 1, why);
    error = error ? error : fxs_vk_begin(e->v, &e->carrier, why);
    if (error)
        return error;
    vf_start(e, e->carrier.commands, 0, 0, 0);
    vf_next(e, e->carrier.commands, VF_test, TESTED / 64, 1, 1);
    error = fxs_vk_run(e->v, &e->carrier, why);
    error = error ? error : vf_fetch(e, &fetched, 1, why);
    fxs_vk_retire(e->v, &e->blocks[VF_PARAMETERS]);
    fxs_vk_retire(e->v, &e->blocks[VF_MASTERS]);
    *is_right = !error && are_right(numbers, results, found);
    return error;
}

static int try_arithmetic(vf_engine *e, const traits *tried, int *is_right, traits *found, fxs_message *why)
{
    const int error = fxs_vk_said(make_programs(e, VF_test, VF_test + 1, tried), why);
    return error ? error : test_arithmetic(e, is_right, found, why);
}

/* Tests the arithmetic, with fused multiply-adds if the device has them. If they do not help, tests it without. */
static int choose_arithmetic(vf_engine *e, traits *chosen, fxs_message *why)
{
    int is_right, helps = 0;
    traits found = *chosen, again = *chosen;
    int error = try_arithmetic(e, chosen, &is_right, &found, why);
    if (!error && is_right && found.has_fma) {
        e->v->vk.DestroyPipeline(e->v->options.device, e->programs[VF_test], 0);
        e->programs[VF_test] = VK_NULL_HANDLE;
        error = try_arithmetic(e, &found, &helps, &again, why);
    }
    chosen->has_fma = found.has_fma && helps;
    chosen->subgroup = found.subgroup;
    return error || is_right ? error
                             : fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "%s does not round as IEEE 754 asks: its fit "
                                           "would differ from that of other devices", e->device.name);
}

static int make_all(vf_engine *e, fxs_message *why)
{
    traits found = {0};
    int error = check_limits(e, &found, why);
    error = error ? error : fxs_vk_said(make_layouts(e), why);
    error = error ? error : fxs_vk_reserve(e->v, &e->blocks[VF_ORDER], FXS_VK_DEVICE, sizeof(vf_memory), why);
    error = error ? error : vf_clear_status(e, why);
    error = error ? error : choose_arithmetic(e, &found, why);
    return error ? error : fxs_vk_said(make_programs(e, 0, VF_test, &found), why);
}

int vf_open(vf_engine *e, int number, uint64_t max_memory, fxs_message *why)
{
    int error = fxs_vulkan_find_device(&e->device, 0, number, why);
    error = error ? error : fxs_vulkan_open_device(&e->device, why);
    e->device.options.max_memory = max_memory;
    error = error ? error : fxs_vk_create(&e->v, &e->device.options, 0, why);
    e->most = most_gaussians(e->device.name);
    return error ? error : make_all(e, why);
}

void vf_close(vf_engine *e)
{
    fxs_vulkan *v = e->v;
    if (v) {
        v->vk.QueueWaitIdle(v->options.queue);
        fxs_vk_drop_slot(v, &e->carrier);
        for (int i = 0; i < VF_TURNS; i++)
            fxs_vk_drop_slot(v, &e->turns[i].slot);
        for (int i = 0; i < VF_BLOCKS; i++)
            fxs_vk_retire(v, &e->blocks[i]);
        for (int i = 0; i < VF_COUNT; i++)
            v->vk.DestroyPipeline(v->options.device, e->programs[i], 0);
        v->vk.DestroyQueryPool(v->options.device, e->queries, 0);
        v->vk.DestroyDescriptorPool(v->options.device, e->pool, 0);
        v->vk.DestroyPipelineLayout(v->options.device, e->layout, 0);
        v->vk.DestroyDescriptorSetLayout(v->options.device, e->set_layout, 0);
    }
    fxs_vulkan_destroy(v);
    fxs_vulkan_close_device(&e->device);
}

void vf_bind(const vf_engine *e, uint32_t set, fxs_vk_block *const blocks[VF_BUFFERS])
{
    VkDescriptorBufferInfo infos[VF_BUFFERS];
    VkWriteDescriptorSet writes[VF_BUFFERS];
    for (uint32_t i = 0; i < VF_BUFFERS; i++) {
        const int is_order = i == VF_BUFFERS - 1;
        infos[i] = (VkDescriptorBufferInfo){(is_order || !blocks[i] ? e->blocks[VF_ORDER] : blocks[i])->buffer,
                                            is_order ? offsetof(vf_memory, order) : 0, VK_WHOLE_SIZE};
        writes[i] = (VkWriteDescriptorSet){.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET, .dstSet = e->sets[set],
                                           .dstBinding = i, .descriptorCount = 1,
                                           .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                           .pBufferInfo = &infos[i]};
    }
    e->v->vk.UpdateDescriptorSets(e->v->options.device, VF_BUFFERS, writes, 0, 0);
}

void vf_bind_step(const vf_engine *e)
{
    fxs_vk_block *blocks[VF_BUFFERS];
    memcpy(blocks, e->blocks, sizeof blocks);
    if (!e->has_masters)
        blocks[VF_MASTERS] = e->blocks[VF_PARAMETERS];
    vf_bind(e, 0, blocks);
}

void vf_start(const vf_engine *e, VkCommandBuffer commands, uint32_t set, uint32_t view, uint32_t is_surface)
{
    const fxs_vulkan *v = e->v;
    const uint32_t pushed[2] = {view, is_surface};
    v->vk.CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, e->layout, 0, 1, &e->sets[set], 0, 0);
    v->vk.CmdPushConstants(commands, e->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof pushed, pushed);
}

void vf_next(const vf_engine *e, VkCommandBuffer commands, int shader, uint32_t x, uint32_t y, uint32_t z)
{
    const fxs_vulkan *v = e->v;
    fxs_vk_barrier(v, commands, FXS_VK_ALL, FXS_VK_ALL);
    v->vk.CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, e->programs[shader]);
    if (x)
        v->vk.CmdDispatch(commands, x, y, z);
    else
        v->vk.CmdDispatchIndirect(commands, e->blocks[VF_ORDER]->buffer, offsetof(vf_memory, status.slot_groups));
}
