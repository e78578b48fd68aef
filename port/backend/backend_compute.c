/* Back end that renders whole frames in compute shaders of OpenGL ES (kernels/compute), with a context from EGL. */
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/backends.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/message.h>

#include "src/core/mirror.h"
#include "src/core/sized.h"
#if defined(FXS_WITH_GLES) && defined(FXS_WITH_EGL)
#define HERE 1
#include <fixsplat/gl.h>
#include <fixsplat/internal/gl_contexts.h>
#endif

#ifdef HERE

typedef struct compute_backend {
    void *port;
    fxs_compute *compute;
    fxs_compute_scene *scenes;
    uint32_t scene_count, scene_room;
    const fxs_compute_scene **copies;
    uint32_t copy_room;
    void *memory;
    size_t memory_bytes;
    uint64_t pool_bytes;               /* size of the pools of scenes in parts */
} compute_backend;

static void close_device(void *self)
{
    compute_backend *b = self;
    if (!b)
        return;
    for (uint32_t i = 0; i < b->scene_count; i++)
        fxs_compute_drop(b->compute, &b->scenes[i]);
    if (b->compute)
        fxs_compute_destroy(b->compute);
    fxs_egl_close(b->port);
    free(b->scenes);
    free(b->copies);
    free(b->memory);
    free(b);
}

static int make_compute(compute_backend *b, fxs_message *why)
{
    return fxs_compute_create(&b->compute, fxs_egl_load, fxs_egl_use, b->port, why);
}

static int open_device(void **self, const fxs_backend_options *options, fxs_message *why)
{
    *self = 0;
    if (options->device != 0)
        return fxs_fail_as(FXS_ERR_DEVICE, why, "there is no device %d: the first that can be had is 0",
                           options->device);
    compute_backend *b = calloc(1, sizeof *b);
    if (!b)
        return fxs_fail_memory(why, 0, sizeof *b);
    const int error = fxs_egl_open(&b->port, why) ? FXS_ERR_DEVICE : make_compute(b, why);
    if (error) {
        close_device(b);
        return error;
    }
    fxs_compute_limit(b->compute, options->max_memory);
    *self = b;
    return 0;
}

static int device_name(int device, char *name, size_t size, fxs_message *why)
{
    const fxs_backend_options options = {.size = sizeof(fxs_backend_options), .device = device};
    void *self;
    const int error = open_device(&self, &options, why);
    if (error)
        return error;
    const char *renderer = fxs_compute_info(((compute_backend *)self)->compute).renderer;
    const size_t length = strlen(renderer) < size ? strlen(renderer) : size - 1;
    memcpy(name, renderer, length);
    name[length] = 0;
    close_device(self);
    return 0;
}

static void forget(void *self, const fxs_scene *scene)
{
    compute_backend *b = self;
    for (uint32_t i = 0; i < b->scene_count; i++)
        if (b->scenes[i].key == scene) {
            fxs_compute_drop(b->compute, &b->scenes[i]);
            b->scenes[i] = b->scenes[--b->scene_count];
            return;
        }
}

static int grow_scenes(compute_backend *b, fxs_message *why)
{
    if (b->scene_count < b->scene_room)
        return 0;
    const uint32_t room = 2 * b->scene_room + 4;
    fxs_compute_scene *scenes = realloc(b->scenes, room * sizeof *scenes);
    if (!scenes)
        return fxs_fail_memory(why, 0, room * sizeof *scenes);
    b->scenes = scenes;
    b->scene_room = room;
    return 0;
}

/* Finds a scene's copy in the device's memory. Uploads a new or changed scene first. */
static int find_scene(compute_backend *b, const fxs_scene *scene, uint32_t *place, fxs_message *why)
{
    for (*place = 0; *place < b->scene_count; ++*place)
        if (b->scenes[*place].key == scene && !memcmp(&b->scenes[*place].here, scene, sizeof *scene))
            return 0;
    forget(b, scene);
    int error = grow_scenes(b, why);
    if (error)
        return error;
    fxs_compute_scene copy = {.key = 0};
    error = fxs_compute_upload(b->compute, &copy, scene, why);
    if (error)
        return error;
    copy.key = scene;
    *place = b->scene_count++;
    b->scenes[*place] = copy;
    return 0;
}

/* Finds the device's copies of all scenes of a frame. A second loop takes their addresses, because an upload may move
   the array of scenes. */
static int find_copies(compute_backend *b, const fxs_request *r, fxs_message *why)
{
    uint32_t place = 0;
    if (r->count > b->copy_room) {
        free(b->copies);
        b->copies = malloc(r->count * sizeof *b->copies);
        b->copy_room = b->copies ? r->count : 0;
        if (!b->copies)
            return fxs_fail_memory(why, 0, r->count * sizeof *b->copies);
    }
    for (uint32_t i = 0; i < r->count; i++) {
        const int error = find_scene(b, fxs_object_at(r->objects, i)->scene, &place, why);
        if (error)
            return error;
    }
    for (uint32_t i = 0; i < r->count; i++) {
        const int error = find_scene(b, fxs_object_at(r->objects, i)->scene, &place, why);
        if (error)
            return error;
        b->copies[i] = &b->scenes[place];
    }
    return 0;
}

/* Makes the pools of scenes in parts on the device larger if the request needs more. */
static void choose_pools(compute_backend *b, const fxs_request *r)
{
    const uint64_t bytes = fxs_mirror_usual_bytes(r, b->pool_bytes);
    for (uint32_t i = b->scene_count; i-- > 0 && bytes > b->pool_bytes;)
        if (b->scenes[i].mirror)
            forget(b, b->scenes[i].key);
    b->pool_bytes = bytes;
    fxs_compute_stream(b->compute, bytes, 0);
}

static int make_room(compute_backend *b, const fxs_request *r, fxs_message *why)
{
    const size_t bytes = fxs_compute_memory(r);
    if (bytes > b->memory_bytes) {
        free(b->memory);
        b->memory = malloc(bytes);
        b->memory_bytes = b->memory ? bytes : 0;
        if (!b->memory)
            return fxs_fail_memory(why, 0, bytes);
    }
    return 0;
}

static int check_request(const fxs_request *r, fxs_message *why)
{
    if (r->eyes < 1 || r->eyes > 2 || (r->count && !r->objects))
        return fxs_fail_as(FXS_ERR_ARGUMENT, why, "%s", fxs_strerror(FXS_ERR_ARGUMENT));
    if (!fxs_compute_memory(r))
        return fxs_fail_as(FXS_ERR_OBJECT, why, "%s", fxs_strerror(FXS_ERR_OBJECT));
    return 0;
}

static int render(void *self, const fxs_request *request, fxs_stats *stats, fxs_message *why)
{
    compute_backend *b = self;
    const uint64_t started = fxs_clock(0);
    int error = check_request(request, why);
    if (!error)
        choose_pools(b, request);
    error = error ? error : find_copies(b, request, why);
    error = error ? error : make_room(b, request, why);
    error = error ? error : fxs_compute_render(b->compute, request, b->copies, b->memory, stats, why);
    if (!error && stats)
        stats->frame_nanoseconds = fxs_clock(0) - started;
    return error;
}

static uint64_t nanoseconds(const void *self)
{
    return fxs_compute_info(((const compute_backend *)self)->compute).nanoseconds;
}

#else

#include "without.h"
#define ABSENT FXS_WITHOUT_HEADERS("libegl-dev, libgles-dev")
#include "absent.h"

#endif

static const char *version(const void *self, enum fxs_stage stage)
{
    (void)self, (void)stage;
    return "gles-compute";
}

const fxs_backend fxs_backend_gles_compute = {
    .name = "gles-compute", .does = "whole frames in compute shaders of OpenGL ES 3.1",
    .can = FXS_CAN_TRACE | FXS_CAN_COMPOSE | FXS_CAN_PART | FXS_CAN_RATES, .device = device_name, .open = open_device,
    .render = render, .forget = forget,
    .version = version, .nanoseconds = nanoseconds, .close = close_device
};
