/* Fits Gaussians to photographs on NVIDIA GPUs. Each device computes the gradients of its share of a batch's
 * photographs, then receives the gradients of the other devices. All devices then make the same update, so that their
 * models stay equal. If the splat lists of the tiles overflow in a step, this step and all later ones change nothing;
 * the function finish repeats them with more memory. */
#include "cuda_fit.h"

#include "kernels/cuda/device.cuh"
#include "bin.cuh"
#include "exposure.cuh"
#include "model.cuh"
#include "pose.cuh"
#include "fit_surface.cuh"
#include "tile.cuh"
#include "update.cuh"

namespace {

enum { PROJECT, BIN, BLEND, LOSS, BACK, UPDATE, STAGES };

const uint32_t VIEW_PLANES = FXS_FIT_SUMS + 1;
const uint32_t PENDING = 64;       /* largest number of fitting steps that are started and not yet completed */
const uint32_t PHOTOGRAPHS = 3;    /* number of photographs in device memory: one in use, two in transfer */

/* A photograph in transfer from host to device memory. Its mask follows its pixels. */
struct photograph_slot {
    host_block sent;
    block pixels;
    cudaEvent_t ready, is_free;
};

/* The state of one GPU. All GPUs hold the same Gaussians, bit for bit. */
struct device {
    int number;
    cudaStream_t stream, copies;
    side_stream beside;            /* a second CUDA stream, for colours and for updates of spherical harmonics */
    budget memory;
    device_model model;
    step_buffers buffers;
    fxs_fit_gains gains;           /* exposures of the photographs; count 0: they are not fitted */
    fxs_fit_poses poses;           /* corrections of the cameras' poses; count 0: they are not fitted */
    fxs_fit_cameras cameras;
    posed_camera *posed;           /* cameras with corrected poses; null: poses are not fitted */
    block splats, slots, pixels, sums_of_views, scratch, status, reduced, exposures, all_poses, pose_parts,
        all_cameras;
    photograph_slot photographs[PHOTOGRAPHS];
    uint32_t next_photograph;
    float *views[FXS_FIT_BATCH];   /* gradient sums of all Gaussians, for each photograph of the batch */
    /* `gathered` is recorded when the device has summed its own gradients, `received` when the gradients of all other
       devices have arrived. */
    cudaEvent_t stages[STAGES + 1], gathered, received;
};

struct step_order {
    fxs_fit_photograph photographs[FXS_FIT_BATCH];
    uint32_t count;
    fxs_fit_step_options options;
    bool has_report;
};

struct engine {                    /* The engine is in pinned host memory, so that devices can copy to `statuses`
                                      asynchronously. */
    fxs_fit_model *model;
    fxs_run_fn *run;               /* null: single-threaded */
    void *pool;
    uint32_t device_count;
    device devices[FXS_FIT_BATCH];
    step_order pending[PENDING];
    uint32_t pending_count;
    uint64_t entries_most;
    step_status statuses[FXS_FIT_BATCH];
    host_block rows[FXS_FIT_BATCH];
};

uint64_t cut_gaussians(step_buffers *b, unsigned char *memory, uint64_t stride)
{
    unsigned char *at = memory;
    b->splats = cut<fxs_fit_splat>(&at, stride);
    b->bases = cut<uint32_t>(&at, stride + 1);
    b->large = cut<uint32_t>(&at, stride);
    b->huge = cut<uint32_t>(&at, stride);
    return (uint64_t)(at - memory);
}

uint64_t cut_slots(step_buffers *b, unsigned char *memory, uint64_t capacity)
{
    unsigned char *at = memory;
    b->keys = cut<uint64_t>(&at, capacity);
    b->splat_of = cut<uint32_t>(&at, capacity);
    b->slots = cut<uint32_t>(&at, capacity);
    b->gaussians = cut<uint32_t>(&at, capacity);
    b->blocks = cut<uint16_t>(&at, capacity);
    b->sums = cut<float>(&at, capacity * FXS_FIT_SUMS);
    b->tiles = (uint32_t *)b->sums;
    return (uint64_t)(at - memory);
}

uint64_t cut_pixels(step_buffers *b, unsigned char *memory, uint64_t width, uint64_t height, uint64_t tiles)
{
    unsigned char *at = memory;
    const uint64_t pixels = width * height;
    b->picture = cut<float>(&at, 3 * pixels);
    b->derivatives = cut<float>(&at, 9 * pixels);
    b->dissimilar = cut<float>(&at, 3 * pixels);
    b->gradient = cut<float>(&at, 3 * pixels);
    b->rows = cut<float>(&at, 6 * height);
    b->gain_rows = cut<float>(&at, FXS_FIT_GAIN * height);
    b->starts = cut<uint32_t>(&at, tiles + 1);
    b->next = cut<uint32_t>(&at, tiles);
    b->order = cut<uint32_t>(&at, tiles);
    b->needed = cut<uint32_t>(&at, tiles);
    return (uint64_t)(at - memory);
}

int reserve_scratch(device *d, fxs_message *why)
{
    step_buffers *b = &d->buffers;
    const int error = reserve(&d->memory, &d->scratch, bin_scratch(d->model.stride), why);
    b->scratch = d->scratch.data;
    b->scratch_bytes = d->scratch.bytes;
    return error;
}

int reserve_slots(device *d, uint64_t capacity, fxs_message *why)
{
    step_buffers *b = &d->buffers;
    if (capacity <= b->capacity)
        return 0;
    if (capacity > UINT32_MAX / 2)
        return failed(why, FXS_ERR_MEMORY, "a step has more than 2^31 tile list entries", capacity * 58);
    const int error = reserve(&d->memory, &d->slots, cut_slots(b, nullptr, capacity), why);
    b->capacity = error ? 0 : (uint32_t)capacity;
    cut_slots(b, (unsigned char *)d->slots.data, b->capacity);
    return error;
}

int reserve_gaussians(device *d, fxs_message *why)
{
    step_buffers *b = &d->buffers;
    int error = reserve(&d->memory, &d->splats, cut_gaussians(b, nullptr, d->model.stride), why);
    cut_gaussians(b, (unsigned char *)d->splats.data, d->model.stride);
    if (!error)
        error = reserve_slots(d, 4 * (uint64_t)d->model.stride, why);
    return error ? error : reserve_scratch(d, why);
}

int reserve_pixels(device *d, const fxs_fit_camera *c, fxs_message *why)
{
    step_buffers *b = &d->buffers;
    const uint64_t width = (uint64_t)c->width, height = (uint64_t)c->height;
    const uint64_t tiles = (uint64_t)c->tiles_x * (uint64_t)c->tiles_y;
    const int error = reserve(&d->memory, &d->pixels, cut_pixels(b, nullptr, width, height, tiles), why);
    cut_pixels(b, (unsigned char *)d->pixels.data, width, height, tiles);
    return error;
}

uint64_t planes_end(const device *d)
{
    return VIEW_PLANES * (uint64_t)d->model.stride + 64;
}

/* The numbers of a view: VIEW_PLANES planes of sums, 64 other numbers, and in a step with surfaces once more as many
   planes. */
uint64_t view_numbers(const device *d, const fxs_fit_step_options *o)
{
    return planes_end(d) + (o->by_surface > 0 ? VIEW_PLANES * (uint64_t)d->model.stride : 0);
}

float *surface_planes_of(const device *d, uint32_t view)
{
    return d->views[view] + planes_end(d);
}

const float *surface_sums_of(const device *d, uint32_t view)
{
    return surface_planes_of(d, view) + FXS_FIT_RED * (size_t)d->model.stride;
}

float *flag_of(const device *d, uint32_t view)
{
    return d->views[view] + VIEW_PLANES * (size_t)d->model.stride;
}

float *by_gain_of(const device *d, uint32_t view)
{
    return flag_of(d, view) + 1;
}

float *by_pose_of(const device *d, uint32_t view)
{
    return by_gain_of(d, view) + FXS_FIT_GAIN;
}

int reserve_views(device *d, uint32_t count, const fxs_fit_step_options *o, fxs_message *why)
{
    const uint64_t numbers = view_numbers(d, o);
    const int error = reserve(&d->memory, &d->sums_of_views, count * numbers * sizeof(float), why);
    for (uint32_t v = 0; v < count && !error; v++)
        d->views[v] = (float *)d->sums_of_views.data + v * numbers;
    return error;
}

const size_t COPIED = 1 << 18;

struct copying {
    uint8_t *to;
    const uint8_t *from;
    size_t bytes;
};

void copy_part(void *argument, uint32_t job)
{
    const copying *c = (const copying *)argument;
    const size_t first = job * COPIED, left = c->bytes - first;
    memcpy(c->to + first, c->from + first, left < COPIED ? left : COPIED);
}

/* Copies bytes with all threads of the pool, because a single thread would take longer than the rest of a step. */
void copy_bytes(const engine *e, void *to, const uint8_t *from, size_t bytes)
{
    copying c = {(uint8_t *)to, from, bytes};
    if (e->run)
        e->run(e->pool, copy_part, &c, (uint32_t)((bytes + COPIED - 1) / COPIED));
    else
        memcpy(to, from, bytes);
}

/* Starts the transfer of a photograph to a device, through pinned memory. The caller's memory is not pinned in place,
   because its pages may hold other data. */
int send_photograph(const engine *e, device *d, const fxs_fit_photograph *p, photograph_slot **out, fxs_message *why)
{
    photograph_slot *slot = &d->photographs[d->next_photograph++ % PHOTOGRAPHS];
    const size_t size = (size_t)p->width * (size_t)p->height, bytes = (p->mask ? 4 : 3) * size;
    int error = check(why, cudaEventSynchronize(slot->ready));
    error = error ? error : reserve(&d->memory, &slot->pixels, bytes, why);
    error = error ? error : reserve_host(&slot->sent, bytes, why);
    if (error)
        return error;
    copy_bytes(e, slot->sent.data, p->pixels, 3 * size);
    if (p->mask)
        copy_bytes(e, (uint8_t *)slot->sent.data + 3 * size, p->mask, size);
    cudaStreamWaitEvent(d->copies, slot->is_free, 0);
    cudaMemcpyAsync(slot->pixels.data, slot->sent.data, bytes, cudaMemcpyHostToDevice, d->copies);
    cudaEventRecord(slot->ready, d->copies);
    *out = slot;
    return check(why, cudaGetLastError(), cudaStreamWaitEvent(d->stream, slot->ready, 0));
}

void mark(const device *d, const step_order *s, int stage)
{
    if (s->has_report)
        cudaEventRecord(d->stages[stage], d->stream);
}

int fetch_rows(engine *e, device *d, const step_order *s, uint32_t view, fxs_message *why)
{
    const uint64_t bytes = 6 * (uint64_t)s->photographs[view].camera.height * sizeof(float);
    const int error = reserve_host(&e->rows[view], bytes, why);
    return error ? error : check(why, cudaMemcpyAsync(e->rows[view].data, d->buffers.rows, bytes,
                                                      cudaMemcpyDeviceToHost, d->stream));
}

bool moves_gains(const device *d, const step_order *s)
{
    return d->gains.count && s->options.gain_rate > 0;
}

int find_loss(engine *e, device *d, const step_order *s, uint32_t view, fxs_message *why)
{
    const fxs_fit_photograph *p = &s->photographs[view];
    step_buffers *b = &d->buffers;
    photograph_slot *slot;
    int error = send_photograph(e, d, p, &slot, why);
    if (error)
        return error;
    const uint8_t *pixels = (const uint8_t *)slot->pixels.data;
    loss_photograph sent = {pixels, p->mask ? pixels + 3 * (size_t)p->width * (size_t)p->height : nullptr};
    cudaError_t failure = cudaSuccess;
    if (p->divisor > 1) {
        error = reserve(&d->memory, &d->reduced,
                        (p->mask ? 4 : 3) * (uint64_t)p->camera.width * (uint64_t)p->camera.height, why);
        if (error)
            return error;
        b->photograph = (uint8_t *)d->reduced.data;
        failure = launch_reduce(b, &sent, p->width, p->divisor, &p->camera, d->stream);
    }
    failure = first_of(failure, launch_loss(b, sent, &p->camera, s->has_report, d->stream));
    if (moves_gains(d, s))
        failure = first_of(failure, launch_by_gain(b, sent, &p->camera, d->gains.is_affine, by_gain_of(d, view),
                                                   d->stream));
    error = check(why, failure, cudaEventRecord(slot->is_free, d->stream));
    return error || !s->has_report ? error : fetch_rows(e, d, s, view, why);
}

bool moves_poses(const device *d, const step_order *s)
{
    return d->posed && s->options.pose_rate > 0;
}

const posed_camera *posed_of(const device *d, uint32_t view)
{
    return d->posed ? d->posed + view : nullptr;
}

pose_batch poses_of(const device *d, const step_order *s)
{
    pose_batch batch = {};
    batch.count = s->count;
    for (uint32_t v = 0; v < s->count; v++) {
        batch.numbers[v] = s->photographs[v].number;
        batch.given[v] = s->photographs[v].camera;
        batch.by_pose[v] = by_pose_of(d, v);
    }
    return batch;
}

int pose_all(engine *e, const step_order *s, fxs_message *why)
{
    int error = 0;
    for (uint32_t i = 0; i < e->device_count && !error; i++) {
        device *d = &e->devices[i];
        const on_device here(d->number);
        if (!d->posed)
            continue;
        const pose_batch batch = poses_of(d, s);
        error = check(why, launch_pose_cameras(&batch, &d->poses, d->posed, d->stream));
    }
    return error;
}

int sum_by_pose(device *d, const step_order *s, uint32_t view, fxs_message *why)
{
    const uint64_t bytes = FXS_FIT_POSE * (uint64_t)part_count(&d->model) * sizeof(float);
    const int error = reserve(&d->memory, &d->pose_parts, bytes, why);
    return error ? error : check(why, launch_by_pose(&d->buffers, &d->model, d->views[view],
                                                     &s->photographs[view].camera, posed_of(d, view),
                                                     s->options.sh_degree, (float *)d->pose_parts.data,
                                                     by_pose_of(d, view), d->stream));
}

int pass(engine *e, device *d, const step_order *s, uint32_t view, fxs_message *why)
{
    step_buffers *b = &d->buffers;
    const fxs_fit_camera *c = &s->photographs[view].camera;
    int error = reserve_pixels(d, c, why);
    if (error)
        return error;
    b->turn = 1 - b->turn;
    mark(d, s, PROJECT);
    cudaError_t failure = launch_project(b, &d->model, c, posed_of(d, view), d->stream);
    failure = first_of(failure, launch_shade(b, &d->model, c, posed_of(d, view), s->options.sh_degree, d->stream,
                                             &d->beside));
    mark(d, s, BIN);
    failure = first_of(failure, launch_bin(b, &d->model, c, d->stream));
    failure = first_of(failure, cudaStreamWaitEvent(d->stream, d->beside.end));
    mark(d, s, BLEND);
    if (d->gains.count)
        failure = first_of(failure, launch_factors(b, &d->gains, s->photographs[view].number, d->stream));
    failure = first_of(failure, launch_blend<false>(b, c, s->options.background, d->stream));
    mark(d, s, LOSS);
    error = check(why, failure);
    error = error ? error : find_loss(e, d, s, view, why);
    mark(d, s, BACK);
    error = error ? error : check(why, launch_back(b, c, d->stream));
    mark(d, s, UPDATE);
    return error;
}

__global__ void say_full(const step_status *status, float *flag)
{
    *flag = (float)status->is_full;
}

struct flags {
    const float *of_views[FXS_FIT_BATCH];
};

__global__ void hear_full(step_status *status, flags f, uint32_t views)
{
    for (uint32_t v = 0; v < views; v++)
        if (*f.of_views[v] > 0)
            status->is_full = 1;
}

uint32_t device_of(const engine *e, const step_order *s, uint32_t view)
{
    return view / (s->count / e->device_count);
}

int receive(engine *e, uint32_t to, const step_order *s, fxs_message *why)
{
    device *d = &e->devices[to];
    for (uint32_t v = 0; v < s->count; v++) {
        const device *from = &e->devices[device_of(e, s, v)];
        if (from == d)
            continue;
        const cudaError_t waited = cudaStreamWaitEvent(d->stream, from->gathered, 0);
        const int error = check(why, waited, cudaMemcpyPeerAsync(d->views[v], d->number, from->views[v], from->number,
                                                                 view_numbers(d, &s->options) * sizeof(float),
                                                                 d->stream));
        if (error)
            return error;
    }
    return e->device_count > 1 ? check(why, cudaEventRecord(d->received, d->stream)) : 0;
}

fxs_fit_adam adam_of(const engine *e, const step_order *s)
{
    fxs_fit_adam adam;
    fxs_fit_set_adam(&adam, &s->options, s->photographs, s->count, e->model->count);
    return adam;
}

/* Makes a device's stream wait until the other devices have copied its gradient sums, because the update overwrites
   them. */
void wait_for_receivers(const engine *e, const device *d)
{
    for (uint32_t i = 0; i < e->device_count; i++)
        if (&e->devices[i] != d)
            cudaStreamWaitEvent(d->stream, e->devices[i].received, 0);
}

cudaError_t step_gains(const device *d, const step_order *s)
{
    gain_batch batch = {};
    batch.count = s->count;
    for (uint32_t v = 0; v < s->count; v++) {
        batch.numbers[v] = s->photographs[v].number;
        batch.by_gain[v] = by_gain_of(d, v);
    }
    return launch_update_gains(&d->buffers, &d->gains, &batch, s->options.gain_rate, s->options.gain_decay,
                               d->stream);
}

int update(engine *e, device *d, const step_order *s, fxs_message *why)
{
    const fxs_fit_adam adam = adam_of(e, s);
    const fxs_fit_step_options *o = &s->options;
    const fxs_fit_grid *grid = d->model.masters ? e->model->grid : nullptr;
    step_buffers *b = &d->buffers;
    fxs_fit_camera cameras[FXS_FIT_BATCH];
    const float *surfaces[FXS_FIT_BATCH];
    flags f;
    for (uint32_t v = 0; v < s->count; v++) {
        cameras[v] = s->photographs[v].camera;
        surfaces[v] = o->by_surface > 0 ? surface_sums_of(d, v) : nullptr;
        f.of_views[v] = flag_of(d, v);
    }
    wait_for_receivers(e, d);
    if (e->device_count > 1)
        hear_full<<<1, 1, 0, d->stream>>>(b->status, f, s->count);
    cudaError_t failure = launch_update(b, &d->model, d->views, surfaces, cameras, d->posed, s->count, o->sh_degree,
                                        &adam, grid, d->stream, &d->beside);
    if (o->noise.amount > 0)
        failure = first_of(failure, launch_noise(b, &d->model, &o->noise, d->stream));
    if (o->smooths && d->cameras.count)
        failure = first_of(failure, launch_smooth(b, &d->model, &d->cameras, o->smooths, d->stream));
    if (grid)
        failure = first_of(failure, launch_quantise_shapes(&d->model, grid, d->stream));
    if (moves_gains(d, s))
        failure = first_of(failure, step_gains(d, s));
    if (moves_poses(d, s)) {
        const pose_batch batch = poses_of(d, s);
        failure = first_of(failure, launch_update_poses(b, &d->poses, &batch, o->pose_rate, d->stream));
    }
    if (s->has_report)
        failure = first_of(failure, cudaStreamWaitEvent(d->stream, d->beside.end));
    mark(d, s, STAGES);
    return check(why, failure, cudaGetLastError());
}

/* Sums the gradients by surfaces of a view, after its other sums are gathered. Replaces the splats' colours. */
int pass_surface(device *d, const step_order *s, uint32_t view, fxs_message *why)
{
    static const float black[3] = {0, 0, 0};
    const fxs_fit_camera *c = &s->photographs[view].camera;
    step_buffers b = d->buffers;
    b.factors = nullptr;
    cudaError_t failure = launch_planes(&b, &d->model, c, posed_of(d, view), d->stream);
    failure = first_of(failure, launch_blend<true>(&b, c, black, d->stream));
    failure = first_of(failure, launch_depths(&b, c, posed_of(d, view), s->options.is_depth,
                                              3 * s->options.by_surface, d->stream));
    failure = first_of(failure, launch_back(&b, c, d->stream));
    return check(why, failure, launch_gather(&b, &d->model, surface_planes_of(d, view), d->stream));
}

int pass_all(engine *e, const step_order *s, fxs_message *why)
{
    int error = 0;
    for (uint32_t v = 0; v < s->count && !error; v++) {
        device *d = &e->devices[device_of(e, s, v)];
        const on_device here(d->number);
        error = reserve_views(d, s->count, &s->options, why);
        error = error ? error : pass(e, d, s, v, why);
        if (error)
            break;
        error = check(why, launch_gather(&d->buffers, &d->model, d->views[v], d->stream));
        if (moves_poses(d, s) && !error)
            error = sum_by_pose(d, s, v, why);
        if (s->options.by_surface > 0 && !error)
            error = pass_surface(d, s, v, why);
        if (e->device_count == 1)
            continue;
        say_full<<<1, 1, 0, d->stream>>>(d->buffers.status, flag_of(d, v));
        error = error ? error : check(why, cudaGetLastError(), cudaEventRecord(d->gathered, d->stream));
    }
    return error;
}

int clear_counts(engine *e, fxs_message *why)
{
    int error = 0;
    for (uint32_t i = 0; i < e->device_count && !error; i++) {
        const on_device here(e->devices[i].number);
        error = check(why, cudaMemsetAsync(&e->devices[i].buffers.status->seen, 0, sizeof(step_seen),
                                           e->devices[i].stream));
    }
    return error;
}

int start_step(engine *e, const step_order *s, fxs_message *why)
{
    int error = s->has_report ? clear_counts(e, why) : 0;
    error = error ? error : pose_all(e, s, why);
    error = error ? error : pass_all(e, s, why);
    for (uint32_t i = 0; i < e->device_count && !error; i++) {
        const on_device here(e->devices[i].number);
        error = receive(e, i, s, why);
    }
    for (uint32_t i = 0; i < e->device_count && !error; i++) {
        const on_device here(e->devices[i].number);
        error = update(e, &e->devices[i], s, why);
    }
    return error;
}

int wait(engine *e, fxs_message *why)
{
    for (uint32_t i = 0; i < e->device_count; i++) {
        device *d = &e->devices[i];
        const on_device here(d->number);
        cudaError_t failure = cudaStreamWaitEvent(d->stream, d->beside.end);
        failure = first_of(failure, cudaMemcpyAsync(&e->statuses[i], d->buffers.status, sizeof e->statuses[i],
                                                    cudaMemcpyDeviceToHost, d->stream));
        const int error = check(why, failure, cudaStreamSynchronize(d->stream));
        if (error)
            return error;
    }
    return 0;
}

/* Grows the memory of the tiles' splat lists if the longest lists until now fill more than 8/9 of it. Discards the
   lists' contents. */
int widen_lists(engine *e, fxs_message *why)
{
    int error = 0;
    for (uint32_t i = 0; i < e->device_count && !error; i++) {
        device *d = &e->devices[i];
        const on_device here(d->number);
        if (e->entries_most + e->entries_most / 8 > d->buffers.capacity)
            error = reserve_slots(d, e->entries_most + e->entries_most / 4, why);
    }
    return error;
}

int take_statuses(engine *e, bool *is_full, fxs_message *why)
{
    int error = 0;
    *is_full = false;
    for (uint32_t i = 0; i < e->device_count && !error; i++) {
        device *d = &e->devices[i];
        const on_device here(d->number);
        const uint64_t most = e->statuses[i].entries_most;
        e->entries_most = most > e->entries_most ? most : e->entries_most;
        *is_full = *is_full || e->statuses[i].is_full;
        error = check(why, cudaMemsetAsync(d->buffers.status, 0, sizeof(step_status), d->stream));
    }
    return error;
}

/* Completes the steps already started. If tile lists overflowed in a step, repeats this and all later steps with more
   memory. */
int finish(engine *e, fxs_message *why)
{
    uint32_t first = 0;
    int error = 0;
    while (first < e->pending_count && !error) {
        bool is_full;
        error = wait(e, why);
        first += error ? 0 : e->statuses[0].done;
        error = error ? error : take_statuses(e, &is_full, why);
        if (!error && is_full)
            error = widen_lists(e, why);
        for (uint32_t i = first; i < e->pending_count && !error; i++)
            error = start_step(e, &e->pending[i], why);
    }
    e->pending_count = 0;
    return error;
}

void fill_report(const engine *e, const step_order *s, fxs_fit_report *report)
{
    memset(report, 0, sizeof *report);
    for (uint32_t v = 0; v < s->count; v++)
        fxs_fit_add_loss((const float *)e->rows[v].data, &s->photographs[v].camera, s->count, report);
    for (uint32_t i = 0; i < e->device_count; i++) {
        report->entries += e->statuses[i].seen.entries;
        report->visible += e->statuses[i].seen.visible;
    }
    for (int i = 0; i < STAGES; i++) {
        float milliseconds = 0;
        if (cudaEventElapsedTime(&milliseconds, e->devices[0].stages[i], e->devices[0].stages[i + 1]))
            cudaGetLastError();
        report->nanoseconds[i] = (uint64_t)(milliseconds * 1e6f);
    }
}

int step(void *self, const fxs_fit_photograph *photographs, uint32_t count, const fxs_fit_step_options *options,
         fxs_fit_report *report, fxs_message *why)
{
    engine *e = (engine *)self;
    int error = e->pending_count == PENDING ? finish(e, why) : 0;
    if (error)
        return error;
    step_order *s = &e->pending[e->pending_count++];
    memcpy(s->photographs, photographs, count * sizeof *photographs);
    s->count = count;
    s->options = *options;
    s->has_report = report != nullptr;
    error = start_step(e, s, why);
    if (error || !report)
        return error;
    error = finish(e, why);
    if (!error)
        fill_report(e, s, report);
    return error;
}

/* Completes the steps already started, then makes the same change to the Gaussians on all devices. */
template <class Change>
int change_model(engine *e, fxs_message *why, Change change)
{
    int error = finish(e, why);
    error = error ? error : widen_lists(e, why);
    for (uint32_t i = 0; i < e->device_count && !error; i++) {
        device *d = &e->devices[i];
        const on_device here(d->number);
        error = change(d);
        error = error ? error : reserve_gaussians(d, why);
    }
    e->model->count = e->devices[0].model.count;
    return error;
}

int densify(void *self, const fxs_fit_densify *how, fxs_message *why)
{
    return change_model((engine *)self, why,
                        [&](device *d) { return model_densify(&d->model, how, &d->memory, d->stream, why); });
}

int relocate(void *self, const fxs_fit_relocate *how, fxs_message *why)
{
    return change_model((engine *)self, why,
                        [&](device *d) { return model_relocate(&d->model, how, &d->memory, d->stream, why); });
}

int order(void *self, fxs_message *why)
{
    return change_model((engine *)self, why,
                        [&](device *d) { return model_order(&d->model, &d->memory, d->stream, why); });
}

int reset_opacity(void *self, float opacity, fxs_message *why)
{
    return change_model((engine *)self, why,
                        [&](device *d) { return model_reset_opacity(&d->model, opacity, d->stream, why); });
}

int upload_gains(device *d, const fxs_fit_gains *from, fxs_message *why)
{
    const uint64_t bytes = from ? from->count * sizeof *from->of : 0;
    d->gains = {nullptr, 0, 0};
    d->buffers.factors = nullptr;
    if (!from)
        return 0;
    const int error = reserve(&d->memory, &d->exposures, bytes + FXS_FIT_GAIN * sizeof(float), why);
    if (error)
        return error;
    d->gains = {(fxs_fit_gain *)d->exposures.data, from->count, from->is_affine};
    d->buffers.factors = (float *)(d->gains.of + from->count);
    return check(why, cudaMemcpyAsync(d->gains.of, from->of, bytes, cudaMemcpyHostToDevice, d->stream),
                 cudaStreamSynchronize(d->stream));
}

int upload_poses(device *d, const fxs_fit_poses *from, fxs_message *why)
{
    const uint64_t bytes = from ? from->count * sizeof *from->of : 0;
    d->poses = {nullptr, 0};
    d->posed = nullptr;
    if (!from)
        return 0;
    const int error = reserve(&d->memory, &d->all_poses, bytes + FXS_FIT_BATCH * sizeof *d->posed, why);
    if (error)
        return error;
    d->poses = {(fxs_fit_pose *)d->all_poses.data, from->count};
    d->posed = (posed_camera *)(d->poses.of + from->count);
    return check(why, cudaMemcpyAsync(d->poses.of, from->of, bytes, cudaMemcpyHostToDevice, d->stream),
                 cudaStreamSynchronize(d->stream));
}

int upload_cameras(device *d, const fxs_fit_cameras *from, fxs_message *why)
{
    const uint64_t bytes = from ? from->count * sizeof *from->of : 0;
    d->cameras = {nullptr, 0};
    if (!from)
        return 0;
    const int error = reserve(&d->memory, &d->all_cameras, bytes, why);
    if (error)
        return error;
    d->cameras = {(fxs_fit_camera *)d->all_cameras.data, from->count};
    return check(why, cudaMemcpyAsync(d->cameras.of, from->of, bytes, cudaMemcpyHostToDevice, d->stream),
                 cudaStreamSynchronize(d->stream));
}

int download_poses(const device *d, const fxs_fit_poses *to, fxs_message *why)
{
    if (!d->poses.count)
        return 0;
    return check(why, cudaMemcpyAsync(to->of, d->poses.of, d->poses.count * sizeof *d->poses.of,
                                      cudaMemcpyDeviceToHost, d->stream), cudaStreamSynchronize(d->stream));
}

int give(void *self, fxs_message *why)
{
    engine *e = (engine *)self;
    return change_model(e, why, [&](device *d) {
        int error = upload_gains(d, e->model->gains, why);
        error = error ? error : upload_poses(d, e->model->poses, why);
        error = error ? error : upload_cameras(d, e->model->cameras, why);
        return error ? error : model_upload(&d->model, e->model, &d->memory, d->stream, why);
    });
}

int fetch(void *self, fxs_message *why)
{
    engine *e = (engine *)self;
    const device *d = &e->devices[0];
    const on_device here(d->number);
    int error = finish(e, why);
    error = error ? error : model_download(&d->model, e->model, d->stream, why);
    error = error ? error : download_poses(d, e->model->poses, why);
    if (error || !d->gains.count)
        return error;
    return check(why, cudaMemcpyAsync(e->model->gains->of, d->gains.of, d->gains.count * sizeof *d->gains.of,
                                      cudaMemcpyDeviceToHost, d->stream), cudaStreamSynchronize(d->stream));
}

int fetch_masters(void *self, fxs_message *why)
{
    engine *e = (engine *)self;
    const device *d = &e->devices[0];
    const on_device here(d->number);
    const int error = finish(e, why);
    return error ? error : download_masters(&d->model, e->model, d->stream, why);
}

int quantise(void *self, fxs_message *why)
{
    engine *e = (engine *)self;
    int error = finish(e, why);
    for (uint32_t i = 0; i < e->device_count && !error; i++) {
        device *d = &e->devices[i];
        const on_device here(d->number);
        const cudaError_t sent = upload_chunks(&d->model, e->model, d->stream);
        const cudaError_t launched = first_of(launch_quantise_shapes(&d->model, e->model->grid, d->stream),
                                              launch_quantise_sh(&d->model, e->model->grid, d->stream));
        error = check(why, sent, launched);
    }
    return error;
}

void close(device *d)
{
    const on_device here(d->number);
    if (d->stream)
        cudaStreamSynchronize(d->stream);
    if (d->copies)
        cudaStreamSynchronize(d->copies);
    if (d->beside.stream)
        cudaStreamSynchronize(d->beside.stream);
    model_free(&d->model, &d->memory);
    block *const blocks[] = {&d->splats,  &d->slots,  &d->pixels, &d->sums_of_views,
                             &d->scratch, &d->status, &d->reduced, &d->exposures,
                             &d->all_poses, &d->pose_parts, &d->all_cameras};
    for (block *b : blocks)
        reserve(&d->memory, b, 0, nullptr);
    for (photograph_slot &slot : d->photographs) {
        reserve(&d->memory, &slot.pixels, 0, nullptr);
        cudaFreeHost(slot.sent.data);
        cudaEventDestroy(slot.ready);
        cudaEventDestroy(slot.is_free);
    }
    for (cudaEvent_t event : d->stages)
        cudaEventDestroy(event);
    cudaEventDestroy(d->gathered);
    cudaEventDestroy(d->received);
    cudaStreamDestroy(d->stream);
    cudaStreamDestroy(d->copies);
    cudaEventDestroy(d->beside.begin);
    cudaEventDestroy(d->beside.end);
    cudaStreamDestroy(d->beside.stream);
    cudaGetLastError();
}

void free_engine(void *self)
{
    engine *e = (engine *)self;
    if (!e)
        return;
    for (uint32_t i = 0; i < e->device_count; i++)
        close(&e->devices[i]);
    for (host_block &rows : e->rows)
        cudaFreeHost(rows.data);
    cudaFreeHost(e);
    cudaGetLastError();
}

int open(device *d, int number, uint64_t max_memory, fxs_message *why)
{
    d->number = number;
    d->memory.most = max_memory;
    int error = check(why, cudaSetDevice(number));
    if (error)
        return error;
    cudaError_t failure = cudaStreamCreateWithFlags(&d->stream, cudaStreamNonBlocking);
    failure = first_of(failure, cudaStreamCreateWithFlags(&d->copies, cudaStreamNonBlocking));
    failure = first_of(failure, cudaStreamCreateWithFlags(&d->beside.stream, cudaStreamNonBlocking));
    failure = first_of(failure, cudaEventCreateWithFlags(&d->beside.begin, cudaEventDisableTiming));
    failure = first_of(failure, cudaEventCreateWithFlags(&d->beside.end, cudaEventDisableTiming));
    for (photograph_slot &slot : d->photographs) {
        failure = first_of(failure, cudaEventCreateWithFlags(&slot.ready, cudaEventDisableTiming));
        failure = first_of(failure, cudaEventCreateWithFlags(&slot.is_free, cudaEventDisableTiming));
    }
    for (cudaEvent_t &event : d->stages)
        failure = first_of(failure, cudaEventCreate(&event));
    failure = first_of(failure, cudaEventCreateWithFlags(&d->gathered, cudaEventDisableTiming));
    failure = first_of(failure, cudaEventCreateWithFlags(&d->received, cudaEventDisableTiming));
    error = check(why, failure);
    error = error ? error : reserve(&d->memory, &d->status, sizeof(step_status), why);
    d->buffers.status = (step_status *)d->status.data;
    return error ? error : check(why, cudaMemsetAsync(d->status.data, 0, sizeof(step_status), d->stream));
}

void connect(const engine *e)
{
    for (uint32_t i = 0; i < e->device_count; i++)
        for (uint32_t k = 0; k < e->device_count; k++) {
            const on_device here(e->devices[i].number);
            int can = 0;
            if (i != k && !cudaDeviceCanAccessPeer(&can, e->devices[i].number, e->devices[k].number) && can)
                cudaDeviceEnablePeerAccess(e->devices[k].number, 0);
            cudaGetLastError();
        }
}

const fxs_fit_engine functions = {"cuda", step, densify, relocate, order, reset_opacity, fetch, fetch_masters, give,
                                  quantise, free_engine};

}

int fxs_cuda_fit_engine(const fxs_fit_engine **out, void **self, fxs_fit_model *model, const fxs_fit_options *options,
                        fxs_message *why)
{
    *self = nullptr;
    *out = &functions;
    int before = 0, error = check(why, cudaGetDevice(&before));
    if (error)
        return error;
    engine *e = nullptr;
    error = check(why, cudaHostAlloc((void **)&e, sizeof *e, cudaHostAllocPortable));
    if (error)
        return error;
    memset(e, 0, sizeof *e);
    e->model = model;
    e->run = options->workers.run;
    e->pool = options->workers.pool;
    for (uint32_t i = 0; i < options->device_count && !error; i++) {
        e->device_count++;
        error = open(&e->devices[i], options->devices[i], options->max_memory, why);
    }
    if (!error)
        connect(e);
    cudaSetDevice(before);
    if (error) {
        free_engine(e);
        return error;
    }
    *self = e;
    return 0;
}
