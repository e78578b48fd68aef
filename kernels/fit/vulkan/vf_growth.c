/* Changes the number of Gaussians on the device: copies their parameters and moments as the host has decided. */
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/message.h>
#include "vf.h"

/* A set of planes that is rebuilt: those of the parameters, of the means, or of the squares. */
typedef struct plane_set {
    int block;
    uint32_t first;
} plane_set;

static void push(const vf_engine *e, VkCommandBuffer commands, const fit_rebuilt *rebuilt)
{
    e->v->vk.CmdPushConstants(commands, e->layout, VK_SHADER_STAGE_COMPUTE_BIT, 2 * sizeof(uint32_t), sizeof *rebuilt,
                              rebuilt);
}

static void bind(const vf_engine *e, fxs_vk_block *from, fxs_vk_block *to)
{
    fxs_vk_block *blocks[VF_BUFFERS] = {0};
    blocks[VF_PARAMETERS] = from;
    blocks[VF_MASTERS] = to;
    blocks[VF_GAUSSIANS] = e->blocks[VF_SOURCES];
    vf_bind(e, 1, blocks);
}

/* Copies a set of planes: to `to` with the stride `stride`, at the same places. */
static int copy_set(vf_engine *e, plane_set set, fxs_vk_block *from, fxs_vk_block *to, uint32_t to_plane,
                    uint32_t stride, uint32_t count, int goes_back, fxs_message *why)
{
    const fxs_vulkan *v = e->v;
    const fit_rebuilt rebuilt = {count, e->stride, stride, set.first, to_plane, set.block == VF_MOMENTS};
    VkBufferCopy regions[FXS_FIT_PARAMETERS];
    int error = fxs_vk_begin(e->v, &e->carrier, why);
    if (error)
        return error;
    const VkCommandBuffer commands = e->carrier.commands;
    bind(e, from, to);
    vf_start(e, commands, 1, 0, 0);
    push(e, commands, &rebuilt);
    vf_next(e, commands, VF_rebuild, (count + 255) / 256, FXS_FIT_PARAMETERS, 1);
    for (uint64_t k = 0; k < FXS_FIT_PARAMETERS; k++)
        regions[k] = (VkBufferCopy){k * stride * sizeof(float), vf_plane(e, set.first + k), count * sizeof(float)};
    if (goes_back) {
        fxs_vk_barrier(v, commands, FXS_VK_ALL, FXS_VK_ALL);
        v->vk.CmdCopyBuffer(commands, to->buffer, from->buffer, FXS_FIT_PARAMETERS, regions);
    }
    return fxs_vk_run(e->v, &e->carrier, why);
}

/* Copies all sets within their blocks, through the memory of slots, which has room for 60 planes. */
static int copy_in_place(vf_engine *e, uint32_t count, fxs_message *why)
{
    static const plane_set sets[3] = {{VF_PARAMETERS, 0}, {VF_MOMENTS, 0}, {VF_MOMENTS, FXS_FIT_PARAMETERS}};
    int error = 0;
    for (int i = 0; i < 3 && !error; i++)
        error = copy_set(e, sets[i], e->blocks[sets[i].block], e->blocks[VF_SLOTS], 0, count, count, 1, why);
    return error;
}

/* Copies the sets of a block to a new block with more room. */
static int copy_to_new(vf_engine *e, int block, uint32_t sets, uint32_t stride, uint32_t count, fxs_message *why)
{
    fxs_vk_block *const before = e->blocks[block];
    e->blocks[block] = NULL;
    int error = vf_reserve(e, block, (uint64_t)sets * FXS_FIT_PARAMETERS * stride, why);
    for (uint32_t i = 0; i < sets && !error; i++) {
        const plane_set set = {block, i * FXS_FIT_PARAMETERS};
        error = copy_set(e, set, before, e->blocks[block], i * FXS_FIT_PARAMETERS, stride, count, 0, why);
    }
    fxs_vk_block *old = before;
    fxs_vk_retire(e->v, &old);
    fxs_vk_collect(e->v);
    return error;
}

static int send_sources(vf_engine *e, const fxs_fit_model *part, fxs_message *why)
{
    uint32_t *sources = malloc(part->count * sizeof *sources);
    const vf_copy sent = {VF_SOURCES, 0, sources, part->count * sizeof *sources};
    if (!sources)
        return fxs_fail_memory(why, "a fit", part->count * sizeof *sources);
    for (size_t i = 0; i < part->count; i++)
        sources[i] = part->origins[i].source | (part->origins[i].kind == FXS_FIT_KEPT ? 0 : 0x80000000u);
    int error = vf_reserve(e, VF_SOURCES, part->count, why);
    error = error ? error : vf_send(e, &sent, 1, why);
    free(sources);
    return error;
}

static int grow(vf_engine *e, uint32_t count, fxs_message *why)
{
    const uint32_t stride = vf_stride_for(e, count);
    int error = copy_to_new(e, VF_PARAMETERS, 1, stride, count, why);
    error = error ? error : copy_to_new(e, VF_MOMENTS, 2, stride, count, why);
    e->stride = error ? 0 : stride;
    return error;
}

int vf_rebuild(vf_engine *e, const fxs_fit_model *part, fxs_message *why)
{
    const uint32_t count = (uint32_t)part->count;
    vf_copy copies[FXS_FIT_COLOUR + 2];
    int error = send_sources(e, part, why);
    if (!error)
        error = count <= e->stride ? copy_in_place(e, count, why) : grow(e, count, why);
    error = error ? error : vf_make_room(e, count, why);
    if (error)
        return error;
    vf_bind_step(e);
    for (uint64_t k = 0; k < FXS_FIT_COLOUR; k++)
        copies[k] = (vf_copy){VF_PARAMETERS, vf_plane(e, k), part->parameters + k * part->stride,
                              count * sizeof(float)};
    copies[FXS_FIT_COLOUR] = (vf_copy){VF_GAUSSIANS, 4 * (uint64_t)e->order.at_by_centre, part->by_centre,
                                       count * sizeof(float)};
    copies[FXS_FIT_COLOUR + 1] = (vf_copy){VF_GAUSSIANS, 4 * (uint64_t)e->order.at_views, part->views,
                                           count * sizeof(float)};
    error = vf_send(e, copies, FXS_FIT_COLOUR + 2, why);
    return error ? error : vf_send_cameras(e, why);
}
