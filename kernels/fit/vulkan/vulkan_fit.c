/* Fits Gaussians to photographs on a GPU through Vulkan: the functions of an engine. */
#include "vulkan_fit.h"

#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/message.h>
#include "vf.h"

static int step(void *self, const fxs_fit_photograph *photographs, uint32_t count, const fxs_fit_step_options *options,
                fxs_fit_report *report, fxs_message *why)
{
    return vf_step(self, photographs, count, options, report, why);
}

enum { COPIES = 3 * FXS_FIT_PARAMETERS + 2 };

/* Lists the copies of `planes` planes between host memory and a block. */
static size_t list_planes(const vf_engine *e, float *host, int block, uint64_t first, uint64_t planes, vf_copy *out)
{
    const fxs_fit_model *m = e->model;
    for (uint64_t k = 0; k < planes; k++)
        out[k] = (vf_copy){block, vf_plane(e, first + k), host + k * m->stride, m->count * sizeof(float)};
    return planes;
}

static size_t list_model(const vf_engine *e, vf_copy out[COPIES])
{
    const fxs_fit_model *m = e->model;
    size_t n = list_planes(e, m->parameters, VF_PARAMETERS, 0, FXS_FIT_PARAMETERS, out);
    n += list_planes(e, m->means, VF_MOMENTS, 0, FXS_FIT_PARAMETERS, out + n);
    n += list_planes(e, m->squares, VF_MOMENTS, FXS_FIT_PARAMETERS, FXS_FIT_PARAMETERS, out + n);
    out[n++] = (vf_copy){VF_GAUSSIANS, 4 * (uint64_t)e->order.at_by_centre, m->by_centre, m->count * sizeof(float)};
    out[n++] = (vf_copy){VF_GAUSSIANS, 4 * (uint64_t)e->order.at_views, m->views, m->count * sizeof(float)};
    return n;
}

static int send_chunks(vf_engine *e, fxs_message *why)
{
    const size_t chunks = (e->model->count + FXS_FIT_CHUNK - 1) / FXS_FIT_CHUNK;
    const vf_copy sent = {VF_GAUSSIANS, 4 * (uint64_t)e->order.at_chunks, (void *)e->model->grid->chunks,
                          chunks * sizeof(fxs_fit_chunk)};
    return vf_send(e, &sent, 1, why);
}

static int send_masters(vf_engine *e, fxs_message *why)
{
    vf_copy copies[FXS_FIT_PARAMETERS];
    const size_t n = list_planes(e, e->model->masters, VF_MASTERS, 0, FXS_FIT_PARAMETERS, copies);
    const int error = vf_send(e, copies, n, why);
    return error ? error : send_chunks(e, why);
}

static int give(void *self, fxs_message *why)
{
    vf_engine *e = self;
    vf_copy copies[COPIES];
    int error = vf_finish(e, why);
    error = error ? error : vf_make_room(e, e->model->count, why);
    if (error)
        return error;
    vf_bind_step(e);
    error = vf_send(e, copies, list_model(e, copies), why);
    error = error ? error : vf_send_cameras(e, why);
    return error || !e->has_masters ? error : send_masters(e, why);
}

static int fetch_masters(void *self, fxs_message *why)
{
    vf_engine *e = self;
    vf_copy copies[FXS_FIT_PARAMETERS];
    const int error = vf_finish(e, why);
    return error ? error
                 : vf_fetch(e, copies, list_planes(e, e->model->masters, VF_MASTERS, 0, FXS_FIT_PARAMETERS, copies),
                            why);
}

static int fetch(void *self, fxs_message *why)
{
    vf_engine *e = self;
    vf_copy copies[COPIES];
    int error = vf_finish(e, why);
    if (!error && fxs_fit_model_resize(e->model, e->model->count))
        error = fxs_fail_memory(why, "a fit", 0);
    error = error ? error : vf_fetch(e, copies, list_model(e, copies), why);
    return error || !e->has_masters ? error : fetch_masters(e, why);
}

static int fetch_part(vf_engine *e, fxs_fit_model *part, fxs_message *why)
{
    vf_copy copies[FXS_FIT_COLOUR + 2];
    const uint64_t bytes = e->model->count * sizeof(float);
    if (fxs_fit_model_part(part, e->model->count))
        return fxs_fail_memory(why, "a fit", FXS_FIT_COLOUR * bytes);
    for (uint64_t k = 0; k < FXS_FIT_COLOUR; k++)
        copies[k] = (vf_copy){VF_PARAMETERS, vf_plane(e, k), part->parameters + k * part->stride, bytes};
    copies[FXS_FIT_COLOUR] = (vf_copy){VF_GAUSSIANS, 4 * (uint64_t)e->order.at_by_centre, part->by_centre, bytes};
    copies[FXS_FIT_COLOUR + 1] = (vf_copy){VF_GAUSSIANS, 4 * (uint64_t)e->order.at_views, part->views, bytes};
    return vf_fetch(e, copies, FXS_FIT_COLOUR + 2, why);
}

typedef int change_fn(fxs_fit_model *part, const void *how);

/* Changes a part of the model on the host, and then the model on the device likewise. */
static int change(vf_engine *e, change_fn *changes, const void *how, fxs_message *why)
{
    fxs_fit_model part = {0};
    int error = vf_finish(e, why);
    error = error ? error : fetch_part(e, &part, why);
    if (!error && changes(&part, how))
        error = fxs_fail_memory(why, "a fit", 0);
    if (!error)
        e->model->count = part.count;
    error = error ? error : vf_rebuild(e, &part, why);
    fxs_fit_model_free(&part);
    return error;
}

static int densify_part(fxs_fit_model *part, const void *how)
{
    return fxs_fit_model_densify(part, how);
}

static int relocate_part(fxs_fit_model *part, const void *how)
{
    return fxs_fit_model_relocate(part, how);
}

static int order_part(fxs_fit_model *part, const void *how)
{
    (void)how;
    return fxs_fit_model_order(part);
}

static int densify(void *self, const fxs_fit_densify *how, fxs_message *why)
{
    return change(self, densify_part, how, why);
}

static int relocate(void *self, const fxs_fit_relocate *how, fxs_message *why)
{
    return change(self, relocate_part, how, why);
}

static int order(void *self, fxs_message *why)
{
    return change(self, order_part, NULL, why);
}

static int reset_opacity(void *self, float opacity, fxs_message *why)
{
    vf_engine *e = self;
    fxs_fit_model part = {0};
    int error = vf_finish(e, why);
    error = error ? error : fetch_part(e, &part, why);
    if (!error) {
        const uint64_t bytes = part.count * sizeof(float);
        float *const none = memset(part.views, 0, bytes);
        const vf_copy copies[3] = {
            {VF_PARAMETERS, vf_plane(e, FXS_FIT_OPACITY), part.parameters + FXS_FIT_OPACITY * part.stride, bytes},
            {VF_MOMENTS, vf_plane(e, FXS_FIT_OPACITY), none, bytes},
            {VF_MOMENTS, vf_plane(e, FXS_FIT_PARAMETERS + FXS_FIT_OPACITY), none, bytes}};
        fxs_fit_model_reset_opacity(&part, opacity);
        error = vf_send(e, copies, 3, why);
    }
    fxs_fit_model_free(&part);
    return error;
}

static int quantise(void *self, fxs_message *why)
{
    vf_engine *e = self;
    int error = vf_finish(e, why);
    error = error ? error : send_chunks(e, why);
    return error ? error : vf_quantise(e, why);
}

static void free_engine(void *self)
{
    if (self)
        vf_close(self);
    free(self);
}

static const fxs_fit_engine functions = {"vulkan", step, densify, relocate, order, reset_opacity, fetch, fetch_masters,
                                         give, quantise, free_engine};

int fxs_vulkan_fit_engine(const fxs_fit_engine **out, void **self, fxs_fit_model *model,
                          const fxs_fit_options *options, fxs_message *why)
{
    vf_engine *e = *self = calloc(1, sizeof *e);
    *out = &functions;
    if (!e)
        return fxs_fail_memory(why, "a fit", sizeof *e);
    e->model = model;
    e->run = options->workers.run;
    e->workers = options->workers.pool;
    e->batch = options->batch ? options->batch : 1;
    e->has_surfaces = options->surfaces;
    const int error = vf_open(e, options->devices[0], options->max_memory, why);
    if (error) {
        free_engine(e);
        *self = NULL;
    }
    return error;
}
