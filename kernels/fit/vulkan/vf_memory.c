/* Memory of the fit through Vulkan: places of data in the blocks, and transfers through staging memory. */
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/message.h>
#include "vf.h"

enum { STAGED = 1 << 24, COPIES = 256 };

uint32_t vf_take(uint64_t *words, uint64_t count)
{
    const uint64_t at = *words;
    *words += (count + 15) / 16 * 16;
    return (uint32_t)at;
}

static uint64_t cut_gaussians(vf_engine *e, uint64_t stride)
{
    uint64_t words = 0;
    fit_order *o = &e->order;
    o->at_splats = vf_take(&words, 16 * stride);
    o->at_bases = vf_take(&words, stride + 1);
    o->at_parts = vf_take(&words, stride / 2048 + 2);
    o->at_large = vf_take(&words, stride);
    o->at_by_centre = vf_take(&words, stride);
    o->at_views = vf_take(&words, stride);
    o->at_chunks = vf_take(&words, stride / FXS_FIT_CHUNK * (sizeof(fxs_fit_chunk) / 4));
    o->camera_count = e->model->cameras ? e->model->cameras->count : 0;
    o->at_cameras = vf_take(&words, o->camera_count * (uint64_t)(sizeof(fxs_fit_camera) / 4));
    o->view_numbers = (uint32_t)((uint64_t)VF_VIEW_PLANES * stride * (e->has_surfaces ? 2 : 1));
    o->at_planes = vf_take(&words, e->batch * (uint64_t)o->view_numbers);
    return words;
}

static uint64_t cut_slots(vf_engine *e, uint64_t capacity)
{
    uint64_t words = 0;
    fit_order *o = &e->order;
    o->at_keys = vf_take(&words, 2 * capacity);
    o->at_splat_of = vf_take(&words, capacity);
    o->at_slots = vf_take(&words, capacity);
    o->at_list = vf_take(&words, capacity);
    o->at_blocks = vf_take(&words, capacity);
    o->at_sums = vf_take(&words, FXS_FIT_SUMS * capacity);
    o->at_tiles = o->at_sums;      /* until the backward pass */
    o->capacity = (uint32_t)capacity;
    return words;
}

int vf_reserve(vf_engine *e, int block, uint64_t words, fxs_message *why)
{
    if (4 * words <= e->v->rooms.most)
        return fxs_vk_reserve(e->v, &e->blocks[block], FXS_VK_DEVICE, 4 * words, why);
    return fxs_fail_as(FXS_ERR_MEMORY, why, "%s takes no buffer of %llu MiB", e->device.name,
                       (unsigned long long)(4 * words >> 20));
}

int vf_make_slots(vf_engine *e, uint64_t capacity, fxs_message *why)
{
    if (capacity <= e->capacity)
        return 0;
    e->capacity = 0;
    const int error = vf_reserve(e, VF_SLOTS, cut_slots(e, capacity), why);
    e->capacity = error ? 0 : (uint32_t)capacity;
    return error;
}

uint64_t vf_plane(const vf_engine *e, uint64_t plane)
{
    return plane * e->stride * sizeof(float);
}

uint32_t vf_stride_for(const vf_engine *e, size_t count)
{
    const uint64_t least = (count + FXS_FIT_CHUNK - 1) / FXS_FIT_CHUNK * FXS_FIT_CHUNK;
    const uint64_t wide = e->stride ? least + least / 8 / FXS_FIT_CHUNK * FXS_FIT_CHUNK : least;
    return least <= e->stride ? e->stride : (uint32_t)wide;
}

int vf_send_cameras(vf_engine *e, fxs_message *why)
{
    const fxs_fit_cameras *cameras = e->model->cameras;
    if (!cameras)
        return 0;
    const vf_copy sent = {VF_GAUSSIANS, 4 * (uint64_t)e->order.at_cameras, cameras->of,
                          cameras->count * sizeof *cameras->of};
    return vf_send(e, &sent, 1, why);
}

int vf_make_room(vf_engine *e, size_t count, fxs_message *why)
{
    if (count > e->most)
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "%s fits at most %zu Gaussians", e->device.name, e->most);
    const uint32_t stride = vf_stride_for(e, count);
    e->has_masters = e->model->masters != NULL;
    e->stride = 0;
    int error = vf_reserve(e, VF_PARAMETERS, FXS_FIT_PARAMETERS * (uint64_t)stride, why);
    error = error ? error : vf_reserve(e, VF_MOMENTS, 2 * FXS_FIT_PARAMETERS * (uint64_t)stride, why);
    if (!error && e->has_masters)
        error = vf_reserve(e, VF_MASTERS, FXS_FIT_PARAMETERS * (uint64_t)stride, why);
    error = error ? error : vf_reserve(e, VF_GAUSSIANS, cut_gaussians(e, stride), why);
    error = error ? error : vf_make_slots(e, 4 * (uint64_t)stride, why);
    e->stride = error ? 0 : stride;
    return error;
}

/* ---- Transfers --------------------------------------------------------------------------------------------------- */

/* A transfer in pieces that fit into the staging memory. */
typedef struct transfer {
    vf_engine *e;
    fxs_vk_block *staging;
    int is_up, is_begun;
    uint64_t used;
    vf_copy pieces[COPIES];
    size_t count;
} transfer;

static int flush(transfer *t, fxs_message *why)
{
    if (!t->is_begun)
        return 0;
    fxs_vk_barrier(t->e->v, t->e->carrier.commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT);
    const int error = fxs_vk_run(t->e->v, &t->e->carrier, why);
    const unsigned char *from = t->staging->memory.mapped;
    for (size_t i = 0; i < t->count && !error && !t->is_up; from += t->pieces[i++].bytes)
        memcpy(t->pieces[i].host, from, t->pieces[i].bytes);
    t->used = t->count = 0;
    t->is_begun = 0;
    return error;
}

static int add(transfer *t, const vf_copy *piece, fxs_message *why)
{
    fxs_vulkan *v = t->e->v;
    const int error = t->is_begun ? 0 : fxs_vk_begin(v, &t->e->carrier, why);
    if (error)
        return error;
    const VkCommandBuffer commands = t->e->carrier.commands;
    if (!t->is_begun)
        fxs_vk_barrier(v, commands, FXS_VK_ALL, FXS_VK_ALL);
    const VkBuffer there = t->e->blocks[piece->block]->buffer;
    const VkBufferCopy up = {t->used, piece->at, piece->bytes}, down = {piece->at, t->used, piece->bytes};
    t->is_begun = 1;
    if (t->is_up) {
        memcpy((unsigned char *)t->staging->memory.mapped + t->used, piece->host, piece->bytes);
        v->vk.CmdCopyBuffer(commands, t->staging->buffer, there, 1, &up);
    } else
        v->vk.CmdCopyBuffer(commands, there, t->staging->buffer, 1, &down);
    t->pieces[t->count++] = *piece;
    t->used += piece->bytes;
    return 0;
}

static int carry(vf_engine *e, int is_up, const vf_copy *copies, size_t count, fxs_message *why)
{
    fxs_vk_block **staging = is_up ? &e->carrier.up : &e->carrier.down;
    int error = fxs_vk_reserve(e->v, staging, is_up ? FXS_VK_UP : FXS_VK_DOWN, STAGED, why);
    transfer t = {.e = e, .staging = *staging, .is_up = is_up};
    for (size_t i = 0; i < count; i++)
        for (uint64_t at = 0, some; at < copies[i].bytes && !error; at += some) {
            if (t.used == STAGED || t.count == COPIES)
                error = flush(&t, why);
            some = copies[i].bytes - at < STAGED - t.used ? copies[i].bytes - at : STAGED - t.used;
            const vf_copy piece = {copies[i].block, copies[i].at + at, (unsigned char *)copies[i].host + at, some};
            error = error ? error : add(&t, &piece, why);
        }
    return error ? error : flush(&t, why);
}

int vf_send(vf_engine *e, const vf_copy *copies, size_t count, fxs_message *why)
{
    return carry(e, 1, copies, count, why);
}

int vf_fetch(vf_engine *e, const vf_copy *copies, size_t count, fxs_message *why)
{
    return carry(e, 0, copies, count, why);
}

int vf_clear_status(vf_engine *e, fxs_message *why)
{
    fit_status none;
    memset(&none, 0, sizeof none);
    const vf_copy sent = {VF_ORDER, 0, &none, sizeof none};
    return vf_send(e, &sent, 1, why);
}
