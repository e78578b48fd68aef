/* Implements fxs_renderer by the chosen back end. If a back end cannot pick the Gaussian at a pixel, the processor
   does. */
#include <fixsplat/renderer.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/backends.h>
#include <fixsplat/internal/message.h>
#include "src/core/sized.h"

struct fxs_renderer {
    const fxs_backend *backend;
    void *self;
    fxs_backend_options picking;
    void *picker;                  /* processor's state for picking Gaussians; null until the first pick */
};

static int unknown(const char *name, fxs_message *message)
{
    char names[128] = "auto";
    const fxs_backend *backend;
    for (int i = 0; (backend = fxs_backend_at(i)) != NULL; i++) {
        const size_t length = strlen(names);
        snprintf(names + length, sizeof names - length, ", %s", backend->name);
    }
    return fxs_fail_as(FXS_ERR_ARGUMENT, message, "no back end is called \"%s\": expected %s", name, names);
}

int fxs_renderer_create(const char *name, const fxs_backend_options *options, fxs_renderer **renderer,
                        fxs_message *message)
{
    fxs_backend_options all;
    const fxs_backend *backend = fxs_backend_find(name ? name : "auto");
    if (!renderer)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "no place for a renderer");
    *renderer = NULL;
    if (!backend)
        return unknown(name, message);
    fxs_renderer *made = calloc(1, sizeof *made);
    if (!made)
        return fxs_fail_memory(message, NULL, sizeof *made);
    made->backend = backend;
    fxs_backend_options_init(&all);
    int error = options ? fxs_sized_read(&all, sizeof all, options) : 0;
    made->picking = all;
    made->picking.device = 0;
    error = error ? fxs_fail_as(error, message, "%s", fxs_strerror(error)) : backend->open(&made->self, &all, message);
    if (error)
        free(made);
    else
        *renderer = made;
    return error;
}

int fxs_renderer_render(fxs_renderer *renderer, const fxs_request *request, fxs_stats *stats, fxs_message *message)
{
    fxs_request all;
    if (!renderer || !request)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "no %s to render", renderer ? "request" : "renderer");
    const int error = fxs_request_read(&all, request);
    return error ? fxs_fail_as(error, message, "%s", fxs_strerror(error))
                 : renderer->backend->render(renderer->self, &all, stats, message);
}

int fxs_renderer_pick(fxs_renderer *renderer, const fxs_request *request, int32_t x, int32_t y,
                      fxs_pick_result *result, fxs_message *message)
{
    if (!renderer || !request || !result)
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "no %s to pick from",
                           !renderer ? "renderer" : request ? "result" : "request");
    fxs_request all;
    int error = fxs_request_read(&all, request);
    if (error)
        return fxs_fail_as(error, message, "%s", fxs_strerror(error));
    if (renderer->backend->pick)
        return renderer->backend->pick(renderer->self, &all, x, y, result, message);
    error = renderer->picker ? 0 : fxs_backend_cpu.open(&renderer->picker, &renderer->picking, message);
    return error ? error : fxs_backend_cpu.pick(renderer->picker, &all, x, y, result, message);
}

void fxs_renderer_forget(fxs_renderer *renderer, const fxs_scene *scene)
{
    if (renderer)
        renderer->backend->forget(renderer->self, scene);
}

const fxs_backend *fxs_renderer_backend(const fxs_renderer *renderer)
{
    return renderer ? renderer->backend : NULL;
}

void fxs_renderer_destroy(fxs_renderer *renderer)
{
    if (!renderer)
        return;
    renderer->backend->close(renderer->self);
    fxs_backend_cpu.close(renderer->picker);
    free(renderer);
}
