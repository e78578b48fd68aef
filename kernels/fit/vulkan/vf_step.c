/* Records the steps of a fit through Vulkan, and completes them. */
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/message.h>
#include "vf.h"

/* ---- Memory of a step -------------------------------------------------------------------------------------------- */

/* Places of a photograph in its block, in words: the pixels and the mask at the camera's size, and at full size. */
typedef struct photograph_places {
    uint64_t full, full_mask, own, mask, end;
} photograph_places;

static photograph_places places_of(const fxs_fit_photograph *p, uint64_t first)
{
    const uint64_t full = (uint64_t)p->width * (uint64_t)p->height;
    const uint64_t own = (uint64_t)p->camera.width * (uint64_t)p->camera.height;
    photograph_places at = {.full = first};
    at.full_mask = at.full + (3 * full + 3) / 4;
    at.end = at.full_mask + (p->mask ? (full + 3) / 4 : 0);
    at.own = at.full;
    at.mask = at.full_mask;
    if (p->divisor > 1) {
        at.own = at.end;
        at.mask = at.own + (3 * own + 3) / 4;
        at.end = at.mask + (p->mask ? (own + 3) / 4 : 0);
    }
    return at;
}

static uint32_t groups(uint64_t threads, uint32_t of_group)
{
    return (uint32_t)((threads + of_group - 1) / of_group);
}

static int moves_poses(const vf_engine *e, const vf_turn *t)
{
    return e->model->poses && t->options.pose_rate > 0;
}

static int moves_gains(const vf_engine *e, const vf_turn *t)
{
    return e->model->gains && t->options.gain_rate > 0;
}

static uint64_t gain_bytes(const vf_engine *e, const vf_turn *t, uint32_t view)
{
    return moves_gains(e, t) ? FXS_FIT_GAIN * (uint64_t)t->photographs[view].camera.height * sizeof(float) : 0;
}

static size_t part_count(const vf_engine *e)
{
    return groups(e->model->count, FXS_FIT_PART);
}

static uint64_t pose_bytes(const vf_engine *e, const vf_turn *t)
{
    return moves_poses(e, t) ? FXS_FIT_POSE * (uint64_t)part_count(e) * sizeof(float) : 0;
}

static uint64_t most(uint64_t a, uint64_t b)
{
    return a > b ? a : b;
}

/* Sets the places of the pixels of a step, for its largest picture. Returns the words that they take. */
static uint64_t cut_pixels(const vf_engine *e, fit_order *o, const vf_turn *t)
{
    uint64_t size = 0, height = 0, tiles = 0, words = 0;
    for (uint32_t v = 0; v < t->count; v++) {
        const fxs_fit_camera *c = &t->photographs[v].camera;
        size = most(size, (uint64_t)c->width * (uint64_t)c->height);
        height = most(height, (uint64_t)c->height);
        tiles = most(tiles, (uint64_t)c->tiles_x * (uint64_t)c->tiles_y);
    }
    o->at_picture = vf_take(&words, 3 * size);
    o->at_derivatives = vf_take(&words, 9 * size);
    o->at_dissimilar = vf_take(&words, 3 * size);
    o->at_gradient = vf_take(&words, 3 * size);
    o->at_rows = vf_take(&words, 6 * height);
    o->at_gain_rows = vf_take(&words, FXS_FIT_GAIN * height);
    o->at_pose_parts = vf_take(&words, pose_bytes(e, t) / sizeof(float));
    o->at_starts = vf_take(&words, tiles + 1);
    o->at_next = vf_take(&words, tiles);
    o->at_needed = vf_take(&words, tiles);
    return words;
}

static uint64_t rows_bytes(const vf_turn *t, uint32_t view)
{
    return t->has_report ? 6 * (uint64_t)t->photographs[view].camera.height * sizeof(float) : 0;
}

/* Return where the rows of a view's report lie behind the status, and behind them the rows for its exposure and the
   parts of its pose's gradient. */
static uint64_t rows_at(const vf_engine *e, const vf_turn *t, uint32_t view)
{
    uint64_t at = sizeof(fit_status);
    for (uint32_t v = 0; v < view; v++)
        at += rows_bytes(t, v) + gain_bytes(e, t, v) + pose_bytes(e, t);
    return at;
}

static uint64_t gains_at(const vf_engine *e, const vf_turn *t, uint32_t view)
{
    return rows_at(e, t, view) + rows_bytes(t, view);
}

static uint64_t poses_at(const vf_engine *e, const vf_turn *t, uint32_t view)
{
    return gains_at(e, t, view) + gain_bytes(e, t, view);
}

static uint64_t photograph_words(const vf_turn *t)
{
    uint64_t end = 0;
    for (uint32_t v = 0; v < t->count; v++)
        end = places_of(&t->photographs[v], end).end;
    return end;
}

static int is_larger(const vf_engine *e, int block, uint64_t bytes)
{
    return !e->blocks[block] || e->blocks[block]->bytes < bytes;
}

/* Makes room for a step, which must not run if a block is replaced. */
static int reserve_step(vf_engine *e, vf_turn *t, fit_order *o, fxs_message *why)
{
    const uint64_t pixels = 4 * cut_pixels(e, o, t), photographs = 4 * photograph_words(t);
    int error = 0;
    if (is_larger(e, VF_PIXELS, pixels) || is_larger(e, VF_PHOTOGRAPH, photographs)) {
        e->v->vk.QueueWaitIdle(e->v->options.queue);
        error = fxs_vk_reserve(e->v, &e->blocks[VF_PIXELS], FXS_VK_DEVICE, pixels, why);
        error = error ? error : fxs_vk_reserve(e->v, &e->blocks[VF_PHOTOGRAPH], FXS_VK_DEVICE, photographs, why);
        if (!error)
            vf_bind_step(e);
    }
    error = error ? error : fxs_vk_reserve(e->v, &t->slot.up, FXS_VK_UP, photographs, why);
    return error ? error : fxs_vk_reserve(e->v, &t->slot.down, FXS_VK_DOWN, rows_at(e, t, t->count), why);
}

/* ---- Recording --------------------------------------------------------------------------------------------------- */

typedef struct copying {
    uint8_t *to;
    const uint8_t *from;
    size_t bytes;
} copying;

enum { COPIED = 1 << 18 };

static void copy_part(void *argument, uint32_t job)
{
    const copying *c = argument;
    const size_t first = (size_t)job * COPIED, left = c->bytes - first;
    memcpy(c->to + first, c->from + first, left < COPIED ? left : COPIED);
}

static void copy_bytes(const vf_engine *e, void *to, const uint8_t *from, size_t bytes)
{
    copying c = {to, from, bytes};
    if (e->run)
        e->run(e->workers, copy_part, &c, (uint32_t)((bytes + COPIED - 1) / COPIED));
    else
        memcpy(to, from, bytes);
}

/* Copies the photographs of a step to the device, through the turn's block, and sets their places and exposures. */
static void send_photographs(const vf_engine *e, vf_turn *t, fit_order *o)
{
    uint8_t *to = t->slot.up->memory.mapped;
    uint64_t end = 0;
    for (uint32_t v = 0; v < t->count; v++) {
        const fxs_fit_photograph *p = &t->photographs[v];
        const photograph_places at = places_of(p, end);
        const size_t size = (size_t)p->width * (size_t)p->height;
        copy_bytes(e, to + 4 * at.full, p->pixels, 3 * size);
        if (p->mask)
            copy_bytes(e, to + 4 * at.full_mask, p->mask, size);
        o->photographs[v] = (fit_photograph){
            (uint32_t)at.own, p->mask ? (uint32_t)at.mask : UINT32_MAX, (uint32_t)at.full, (uint32_t)at.full_mask,
            p->width, p->divisor, {0}};
        fxs_fit_factors_of(e->model, p, o->photographs[v].factors);
        const VkBufferCopy region = {4 * at.full, 4 * at.full,
                                     4 * (p->divisor > 1 ? at.own - at.full : at.end - at.full)};
        e->v->vk.CmdCopyBuffer(t->slot.commands, t->slot.up->buffer, e->blocks[VF_PHOTOGRAPH]->buffer, 1, &region);
        end = at.end;
    }
}

static void fill_order(const vf_engine *e, const vf_turn *t, fit_order *o)
{
    const fxs_fit_step_options *options = &t->options;
    fxs_fit_set_adam(&o->adam, options, t->photographs, t->count, e->model->count);
    for (uint32_t v = 0; v < t->count; v++)
        o->cameras[v] = fxs_fit_camera_of(e->model, &t->photographs[v]);
    o->noise = options->noise;
    if (e->has_masters)
        memcpy(o->grid, e->model->grid, sizeof o->grid);
    memcpy(o->background, options->background, sizeof o->background);
    o->surface_weight = 3 * options->by_surface;
    o->degree = options->sh_degree;
    o->smooths = options->smooths;
    o->has_exposure = e->model->gains != NULL;
    o->is_affine = e->model->gains && e->model->gains->is_affine;
    o->count = (uint32_t)e->model->count;
    o->stride = e->stride;
    o->batch = t->count;
}

static uint32_t groups_at_most(uint64_t threads, uint32_t of_group)
{
    const uint32_t wanted = groups(threads, of_group);
    return wanted < 65535 ? wanted : 65535;
}

enum { PROJECT, BIN, BLEND, LOSS, BACK, UPDATE };

/* Notes the time when a stage begins, in the last view of a step with a report; VF_STAGES: when the step ends. */
static void mark(const vf_engine *e, const vf_turn *t, uint32_t view, uint32_t stage)
{
    if (t->has_report && e->queries && view + 1 == t->count)
        e->v->vk.CmdWriteTimestamp(t->slot.commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, e->queries, stage);
}

static void record_lists(const vf_engine *e, VkCommandBuffer commands, uint32_t tiles_x, uint32_t tiles_y)
{
    const uint64_t count = e->model->count;
    vf_next(e, commands, VF_add_parts, groups(count + 1, 2048), 1, 1);
    vf_next(e, commands, VF_scan_parts, 1, 1, 1);
    vf_next(e, commands, VF_put_bases, groups(count + 1, 2048), 1, 1);
    vf_next(e, commands, VF_cover, groups(count, 128), 1, 1);
    vf_next(e, commands, VF_cover_large, 128, 1, 1);
    vf_next(e, commands, VF_place_lists, 1, 1, 1);
    vf_next(e, commands, VF_append_slots, 0, 1, 1);
    vf_next(e, commands, VF_sort_lists, tiles_x, tiles_y, 1);
}

/* Records a copy from the block of pixels to the turn's block for the host. */
static void fetch_pixels(const vf_engine *e, const vf_turn *t, uint64_t word, uint64_t to, uint64_t bytes)
{
    const VkBufferCopy region = {4 * word, to, bytes};
    fxs_vk_barrier(e->v, t->slot.commands, FXS_VK_ALL, FXS_VK_ALL);
    e->v->vk.CmdCopyBuffer(t->slot.commands, e->blocks[VF_PIXELS]->buffer, t->slot.down->buffer, 1, &region);
}

static void record_gather(const vf_engine *e, VkCommandBuffer commands)
{
    vf_next(e, commands, VF_gather_view, groups_at_most(FXS_FIT_SUMS * (uint64_t)e->model->count, 256), 1, 1);
    vf_next(e, commands, VF_gather_large, 256, 1, 1);
}

/* Records the gradient sums by surfaces of a view, after its other sums are gathered. */
static void record_surface(const vf_engine *e, const vf_turn *t, const fit_order *o, uint32_t view)
{
    const VkCommandBuffer commands = t->slot.commands;
    const fxs_fit_camera *c = &o->cameras[view];
    const uint32_t x = (uint32_t)c->tiles_x, y = (uint32_t)c->tiles_y;
    vf_start(e, commands, 0, view, 1);
    vf_next(e, commands, VF_plane_splats, groups(e->model->count, 128), 1, 1);
    vf_next(e, commands, VF_blend_splats, x, y, 1);
    vf_next(e, commands, VF_compare_depths, groups((uint64_t)c->width * (uint64_t)c->height, 256), 1, 1);
    vf_next(e, commands, VF_backward_tiles, x, y, 1);
    record_gather(e, commands);
}

static void record_view(const vf_engine *e, vf_turn *t, const fit_order *o, uint32_t view)
{
    const VkCommandBuffer commands = t->slot.commands;
    const fxs_fit_camera *c = &o->cameras[view];
    const uint32_t x = (uint32_t)c->tiles_x, y = (uint32_t)c->tiles_y;
    vf_start(e, commands, 0, view, 0);
    mark(e, t, view, PROJECT);
    vf_next(e, commands, VF_project, groups((uint64_t)o->count + 1, 128), 1, 1);
    mark(e, t, view, BIN);
    record_lists(e, commands, x, y);
    mark(e, t, view, BLEND);
    vf_next(e, commands, VF_blend_splats, x, y, 1);
    mark(e, t, view, LOSS);
    if (t->photographs[view].divisor > 1)
        vf_next(e, commands, VF_reduce, groups(3 * (uint64_t)c->width * (uint64_t)c->height, 4 * 256), 1, 1);
    vf_next(e, commands, VF_find_derivatives, x, y, 3);
    vf_next(e, commands, VF_find_gradient, x, y, 3);
    if (t->has_report) {
        vf_next(e, commands, VF_report_rows, groups(3 * (uint64_t)c->height * 16, 256), 1, 1);
        fetch_pixels(e, t, o->at_rows, rows_at(e, t, view), rows_bytes(t, view));
    }
    if (moves_gains(e, t)) {
        vf_next(e, commands, VF_sum_gain_rows, groups(FXS_FIT_GAIN * (uint64_t)c->height * 16, 256), 1, 1);
        fetch_pixels(e, t, o->at_gain_rows, gains_at(e, t, view), gain_bytes(e, t, view));
    }
    mark(e, t, view, BACK);
    vf_next(e, commands, VF_backward_tiles, x, y, 1);
    mark(e, t, view, UPDATE);
    record_gather(e, commands);
    if (moves_poses(e, t)) {
        vf_next(e, commands, VF_sum_pose_parts, (uint32_t)part_count(e), 1, 1);
        fetch_pixels(e, t, o->at_pose_parts, poses_at(e, t, view), pose_bytes(e, t));
    }
    if (o->surface_weight > 0)
        record_surface(e, t, o, view);
}

static void record_quantise(const vf_engine *e, VkCommandBuffer commands)
{
    const uint64_t count = e->model->count;
    vf_next(e, commands, VF_quantise_shapes, groups(count, 64), 1, 1);
    if (e->model->grid->sh_degree > 0)
        vf_next(e, commands, VF_quantise_sh, groups(count, 128), (uint32_t)e->model->grid->sh_degree, 1);
}

static void record_update(const vf_engine *e, const vf_turn *t, const fit_order *o)
{
    const VkCommandBuffer commands = t->slot.commands;
    const uint32_t half = groups(o->count, 64), whole = groups(o->count, 128);
    vf_next(e, commands, VF_update_shapes, half, 1, 1);
    if (o->degree > 0)
        vf_next(e, commands, VF_update_sh, whole, 3, 1);
    if (o->noise.amount > 0)
        vf_next(e, commands, VF_add_noise, whole, 1, 1);
    if (o->smooths && o->camera_count)
        vf_next(e, commands, VF_smooth_scales, whole, 1, 1);
    if (e->has_masters)
        record_quantise(e, commands);
}

static void record(const vf_engine *e, vf_turn *t, fit_order *o)
{
    const fxs_vulkan *v = e->v;
    const VkCommandBuffer commands = t->slot.commands;
    const VkBuffer memory = e->blocks[VF_ORDER]->buffer;
    const VkBufferCopy status = {0, 0, sizeof(fit_status)};
    fxs_vk_barrier(v, commands, FXS_VK_ALL, FXS_VK_ALL);
    send_photographs(e, t, o);
    v->vk.CmdUpdateBuffer(commands, memory, offsetof(vf_memory, order), sizeof *o, o);
    if (t->has_report)
        v->vk.CmdFillBuffer(commands, memory, offsetof(fit_status, visible), 2 * sizeof(uint32_t), 0);
    if (t->has_report && e->queries)
        v->vk.CmdResetQueryPool(commands, e->queries, 0, VF_STAGES + 1);
    for (uint32_t view = 0; view < t->count; view++)
        record_view(e, t, o, view);
    record_update(e, t, o);
    mark(e, t, t->count - 1, VF_STAGES);
    fxs_vk_barrier(v, commands, FXS_VK_ALL, FXS_VK_ALL);
    v->vk.CmdCopyBuffer(commands, memory, t->slot.down->buffer, 1, &status);
    fxs_vk_barrier(v, commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT);
}

int vf_quantise(vf_engine *e, fxs_message *why)
{
    fit_order o = e->order;
    vf_turn t = {.count = 0};
    const int error = fxs_vk_begin(e->v, &e->carrier, why);
    if (error)
        return error;
    t.slot.commands = e->carrier.commands;
    fill_order(e, &t, &o);
    fxs_vk_barrier(e->v, t.slot.commands, FXS_VK_ALL, FXS_VK_ALL);
    e->v->vk.CmdUpdateBuffer(t.slot.commands, e->blocks[VF_ORDER]->buffer, offsetof(vf_memory, order), sizeof o, &o);
    vf_start(e, t.slot.commands, 0, 0, 0);
    record_quantise(e, t.slot.commands);
    return fxs_vk_run(e->v, &e->carrier, why);
}

static int submit(const vf_engine *e, const vf_turn *t, fxs_message *why)
{
    const fxs_vulkan *v = e->v;
    const VkSubmitInfo info = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1,
                               .pCommandBuffers = &t->slot.commands};
    const VkResult result = v->vk.EndCommandBuffer(t->slot.commands);
    return fxs_vk_said(result ? result : v->vk.QueueSubmit(v->options.queue, 1, &info, t->slot.fence), why);
}

static int start(vf_engine *e, vf_turn *t, fxs_message *why)
{
    fit_order o = e->order;
    int error = reserve_step(e, t, &o, why);
    error = error ? error : fxs_vk_begin(e->v, &t->slot, why);
    if (error)
        return error;
    fill_order(e, t, &o);
    record(e, t, &o);
    return submit(e, t, why);
}

/* ---- Completion -------------------------------------------------------------------------------------------------- */

static vf_turn *turn_of(vf_engine *e, uint32_t i)
{
    return &e->turns[(e->first + i) % VF_TURNS];
}

static int wait(const vf_engine *e, const vf_turn *t, fxs_message *why)
{
    const fxs_vulkan *v = e->v;
    return fxs_vk_said(v->vk.WaitForFences(v->options.device, 1, &t->slot.fence, VK_TRUE, UINT64_MAX), why);
}

/* Makes the pending steps again, with more memory for lists, as the oldest of them overflowed it. */
static int repeat(vf_engine *e, fxs_message *why)
{
    int error = 0;
    for (uint32_t i = 1; i < e->pending && !error; i++)
        error = wait(e, turn_of(e, i), why);
    error = error ? error : vf_make_slots(e, e->entries_most + e->entries_most / 4, why);
    error = error ? error : vf_clear_status(e, why);
    if (!error)
        vf_bind_step(e);
    for (uint32_t i = 0; i < e->pending && !error; i++)
        error = start(e, turn_of(e, i), why);
    return error;
}

/* Completes the oldest pending step. */
static int complete(vf_engine *e, fxs_message *why)
{
    for (;;) {
        const vf_turn *t = turn_of(e, 0);
        int error = wait(e, t, why);
        if (error)
            return error;
        const fit_status *status = t->slot.down->memory.mapped;
        e->entries_most = most(e->entries_most, status->entries_most);
        if (!status->is_full)
            break;
        error = repeat(e, why);
        if (error)
            return error;
    }
    e->first = (e->first + 1) % VF_TURNS;
    e->pending--;
    return 0;
}

int vf_finish(vf_engine *e, fxs_message *why)
{
    int error = 0;
    while (e->pending && !error)
        error = complete(e, why);
    if (error)
        e->pending = 0;
    return error;
}

static const float *numbers_at(const vf_turn *t, uint64_t bytes)
{
    return (const float *)t->slot.down->memory.mapped + bytes / sizeof(float);
}

static void fill_times(const vf_engine *e, fxs_fit_report *report)
{
    const fxs_vulkan *v = e->v;
    uint64_t times[VF_STAGES + 1];
    if (!e->queries || v->vk.GetQueryPoolResults(v->options.device, e->queries, 0, VF_STAGES + 1, sizeof times, times,
                                                 sizeof *times, VK_QUERY_RESULT_64_BIT))
        return;
    for (int i = 0; i < VF_STAGES; i++)
        report->nanoseconds[i] =
            (uint64_t)((double)((times[i + 1] - times[i]) & v->timestamp_mask) * v->timestamp_nanoseconds);
}

static void fill_report(const vf_engine *e, const vf_turn *t, fxs_fit_report *report)
{
    const fit_status *status = t->slot.down->memory.mapped;
    memset(report, 0, sizeof *report);
    for (uint32_t v = 0; v < t->count; v++)
        fxs_fit_add_loss(numbers_at(t, rows_at(e, t, v)), &t->photographs[v].camera, t->count, report);
    report->entries = status->entries;
    report->visible = status->visible;
    fill_times(e, report);
}

static void move_gains(const vf_engine *e, const vf_turn *t)
{
    float by_gain[FXS_FIT_BATCH][FXS_FIT_GAIN];
    for (uint32_t v = 0; v < t->count; v++)
        fxs_fit_sum_gains(numbers_at(t, gains_at(e, t, v)), &t->photographs[v].camera, by_gain[v]);
    fxs_fit_move_gains(e->model->gains, t->photographs, t->count, by_gain, &t->options);
}

int vf_step(vf_engine *e, const fxs_fit_photograph *photographs, uint32_t count, const fxs_fit_step_options *options,
            fxs_fit_report *report, fxs_message *why)
{
    int error = e->pending == VF_TURNS ? complete(e, why) : 0;
    if (error)
        return error;
    vf_turn *t = turn_of(e, e->pending);
    memcpy(t->photographs, photographs, count * sizeof *photographs);
    t->count = count;
    t->options = *options;
    t->has_report = report != NULL;
    error = start(e, t, why);
    if (error)
        return error;
    e->pending++;
    if (!report && !moves_poses(e, t) && !moves_gains(e, t))
        return 0;
    error = vf_finish(e, why);
    if (!error && moves_gains(e, t))
        move_gains(e, t);
    for (uint32_t v = 0; v < count && !error && moves_poses(e, t); v++)
        fxs_fit_move_pose(e->model->poses, &photographs[v], numbers_at(t, poses_at(e, t, v)), part_count(e),
                          options->pose_rate);
    if (!error && report)
        fill_report(e, t, report);
    return error;
}
