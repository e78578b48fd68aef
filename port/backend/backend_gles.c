/* OpenGL back ends. The processor lists the Gaussians of each tile; OpenGL draws the pixels, from tile lists or by
 * framebuffer fetch. Both ways give identical pixels. The back ends gles and osmesa time both ways in their first
 * frames and then use the faster. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/backends.h>
#include <fixsplat/camera.h>
#include <fixsplat/pack.h>
#include "processor_internal.h"
#include "without.h"

#ifdef FXS_WITH_GLES
#include <fixsplat/gl.h>
#include <fixsplat/internal/gl_contexts.h>
#else
typedef int fxs_gl_load_fn;
#endif
#ifdef FXS_WITH_EGL
#define EGL fxs_egl_open, fxs_egl_load, fxs_egl_use, fxs_egl_close
#else
#define EGL 0, 0, 0, 0
#endif
#ifdef FXS_WITH_OSMESA
#define OSMESA fxs_osmesa_open, fxs_osmesa_load, fxs_osmesa_use, fxs_osmesa_close
#else
#define OSMESA 0, 0, 0, 0
#endif

enum way { LISTS, FETCH, FASTER };

typedef struct kind {
    const char *name, *without;                /* error message of a build without the library */
    enum way way;
    int (*open)(void **port, fxs_message *why);
    fxs_gl_load_fn *load;
    int (*use)(void *port);
    void (*close)(void *port);
} kind;

static const kind faster = {"gles", FXS_WITHOUT_HEADERS("libegl-dev, libgles-dev"), FASTER, EGL};
static const kind fetch = {"gles-fetch", FXS_WITHOUT_HEADERS("libegl-dev, libgles-dev"), FETCH, EGL};
static const kind osmesa = {"osmesa", FXS_WITHOUT_HEADERS("libosmesa6-dev, libgles-dev"), FASTER, OSMESA};

/* Number of first frames that compare the two ways to draw, by tile lists and by framebuffer fetch. For each way, one
   frame warms up and one is measured. */
enum { MEASURED = 4 };

typedef struct gl_backend {
    const kind *kind;
    void *port;
    struct fxs_gles *gles;
    fxs_processor processor;
    int processor_open;
    unsigned frames;
    uint64_t times[2];
    char lost[512];                /* reason why framebuffer fetch is unavailable; empty: it is available */
} gl_backend;

#ifdef FXS_WITH_GLES
static int open_gles(gl_backend *b, fxs_message *why)
{
    const int error = fxs_gles_create(&b->gles, b->kind->load, b->kind->use, b->port, why);
    if (error)
        return error;
    const char *no_fetch = fxs_gles_info(b->gles).no_fetch;
    if (no_fetch && b->kind->way == FETCH)
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "%s", no_fetch);
    snprintf(b->lost, sizeof b->lost, "%s", no_fetch ? no_fetch : "");
    return 0;
}

static void close_gles(gl_backend *b)
{
    fxs_gles_destroy(b->gles);
}

static fxs_config drawing(const gl_backend *b, enum way way)
{
    static fxs_draw_fn *const draws[] = {fxs_gles_draw, fxs_gles_draw_fetch};
    return (fxs_config){.size = sizeof(fxs_config), .draw = draws[way], .draw_argument = b->gles,
                        .draw_unlisted = way != LISTS};
}

static uint64_t nanoseconds(const void *self)
{
    return fxs_gles_info(((const gl_backend *)self)->gles).nanoseconds;
}

static const char *renderer(const gl_backend *b)
{
    return fxs_gles_info(b->gles).renderer;
}
#else
static int open_gles(gl_backend *b, fxs_message *why)
{
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "%s", b->kind->without);
}

static void close_gles(gl_backend *b)
{
    (void)b;
}

static fxs_config drawing(const gl_backend *b, enum way way)
{
    (void)b, (void)way;
    return (fxs_config){.size = sizeof(fxs_config), .draw = 0};
}

static uint64_t nanoseconds(const void *self)
{
    (void)self;
    return 0;
}

static const char *renderer(const gl_backend *b)
{
    return b->kind->name;
}
#endif

static void close_gl(void *self)
{
    gl_backend *b = self;
    if (!b)
        return;
    if (b->processor_open)
        fxs_processor_close(&b->processor);
    close_gles(b);
    if (b->port)
        b->kind->close(b->port);
    free(b);
}

static int open_context(gl_backend **out, const kind *k, int device, fxs_message *why)
{
    *out = 0;
    if (!k->open)
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "%s", k->without);
    if (device != 0)
        return fxs_fail_as(FXS_ERR_DEVICE, why, "there is no device %d: the first that can be had is 0", device);
    gl_backend *b = calloc(1, sizeof *b);
    if (!b)
        return fxs_fail_memory(why, 0, sizeof *b);
    b->kind = k;
    why->bytes_needed = 0;
    int error = k->open(&b->port, why) ? FXS_ERR_DEVICE : open_gles(b, why);
    if (error)
        close_gl(b);
    else
        *out = b;
    return error;
}

static enum way way_of(const gl_backend *b)
{
    if (b->kind->way != FASTER)
        return b->kind->way;
    if (b->lost[0])
        return LISTS;
    return b->frames < MEASURED ? (enum way)(b->frames % 2) : b->times[FETCH] < b->times[LISTS] ? FETCH : LISTS;
}

static int open_kind(void **self, const kind *k, const fxs_backend_options *options, fxs_message *why)
{
    gl_backend *b;
    *self = 0;
    int error = open_context(&b, k, options->device, why);
    if (error)
        return error;
    const fxs_config config = drawing(b, way_of(b));
    error = fxs_processor_open(&b->processor, options, &config, why);
    b->processor_open = !error;
    if (error)
        close_gl(b);
    else
        *self = b;
    return error;
}

static int render_by(gl_backend *b, enum way way, const fxs_request *request, fxs_stats *stats, fxs_message *why)
{
    const fxs_config config = drawing(b, way);
    b->processor.context.config.draw = config.draw;
    b->processor.context.config.draw_unlisted = config.draw_unlisted;
    return fxs_processor_render(&b->processor, request, stats, why);
}

static int is_of_device(int error)
{
    return error == FXS_ERR_DEVICE || error == FXS_ERR_MEMORY;
}

/* Renders a frame. If framebuffer fetch fails, this frame and all later frames are drawn from tile lists. */
static int render(void *self, const fxs_request *request, fxs_stats *stats, fxs_message *why)
{
    gl_backend *b = self;
    fxs_stats own;
    const enum way way = way_of(b);
    stats = stats ? stats : &own;
    int error = render_by(b, way, request, stats, why);
    if (b->kind->way != FASTER)
        return error;
    if (way == FETCH && is_of_device(error)) {
        const fxs_message failure = *why;
        error = render_by(b, LISTS, request, stats, why);
        if (!error)
            snprintf(b->lost, sizeof b->lost, "framebuffer fetch failed: %.200s", failure.text);
        return error;
    }
    if (!error && b->frames < MEASURED) {
        b->times[way] = stats->frame_nanoseconds;
        b->frames++;
    }
    return error;
}

enum { TRIAL = 4096, TRIAL_WIDTH = 640, TRIAL_HEIGHT = 360 };

static long read_trial(void *argument, uint64_t first, fxs_gaussian *out, size_t capacity)
{
    (void)argument;
    for (size_t i = 0; i < capacity; i++) {
        const uint64_t n = first + i;
        out[i] = (fxs_gaussian){.scale = {-3.5f, -3, -2.5f}, .rotation = {1, 0, 0, 0}, .opacity = 1};
        for (int c = 0; c < 3; c++)
            out[i].position[c] = (float)((n * (uint64_t)(40503 + 20000 * c)) % 65536) / 16384;
        out[i].rotation[1 + n % 3] = (float)(n % 7);
        out[i].dc[n % 3] = 1;
    }
    return (long)capacity;
}

static int pack_trial(fxs_packed_scene *packed, fxs_message *why)
{
    const fxs_gaussian_source source = {TRIAL, 0, 0, read_trial, 0, {0}};
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_pack_report report;
    int error = fxs_scene_file_open_gaussians("trial", &source, 0, &file, &info, why);
    if (error)
        return error;
    error = fxs_pack(file, &info, packed, &report, 0, why);
    fxs_scene_file_close(file);
    return error;
}

static int try_both(gl_backend *b, const fxs_packed_scene *packed, fxs_message *why)
{
    static const double eye[3] = {2, 2, -6}, look[3] = {2, 2, 2}, up[3] = {0, -1, 0};
    unsigned char *pixels = malloc(TRIAL_WIDTH * TRIAL_HEIGHT * 4);
    fxs_view view;
    fxs_scene scene;
    fxs_object object;
    fxs_request request;
    fxs_request_init(&request, &object, 1);
    request.targets->colour = (fxs_image){pixels, TRIAL_WIDTH * 4};
    int error = pixels ? fxs_scene_open(&scene, packed->data, packed->bytes) : FXS_ERR_MEMORY;
    error = error ? error : fxs_view_look_at(&view, eye, look, up, &(fxs_picture){50, TRIAL_WIDTH, TRIAL_HEIGHT}, why);
    error = error ? error : fxs_camera_from_view(request.cameras, &view, why);
    if (!error)
        fxs_object_init(&object, &scene);
    for (int i = 0; i < MEASURED && !error; i++)
        error = render(b, &request, 0, why);
    free(pixels);
    return error;
}

static void say_way(const kind *k, char *name, size_t size)
{
    static const fxs_backend_options options = {.size = sizeof(fxs_backend_options)};
    const size_t used = strlen(name);
    fxs_packed_scene packed;
    fxs_message why;
    void *self;
    if (open_kind(&self, k, &options, &why))
        return;
    gl_backend *b = self;
    if (!b->lost[0] && !pack_trial(&packed, &why)) {
        if (!try_both(b, &packed, &why) && !b->lost[0])
            snprintf(name + used, size - used, ", by %s: a trial took %.1f ms by framebuffer fetch, %.1f by lists",
                     way_of(b) == FETCH ? "fetch" : "lists", (double)b->times[FETCH] / 1e6,
                     (double)b->times[LISTS] / 1e6);
        fxs_packed_scene_free(&packed);
    }
    if (b->lost[0])
        snprintf(name + used, size - used, ", by lists: %s", b->lost);
    close_gl(b);
}

static int device_of(const kind *k, int device, char *name, size_t size, fxs_message *why)
{
    gl_backend *b;
    const int error = open_context(&b, k, device, why);
    if (error)
        return error;
    snprintf(name, size, "%s", renderer(b));
    close_gl(b);
    if (k->way == FASTER)
        say_way(k, name, size);
    return 0;
}

static int pick(void *self, const fxs_request *request, int32_t x, int32_t y, fxs_pick_result *result,
                fxs_message *why)
{
    return fxs_processor_pick(&((gl_backend *)self)->processor, request, x, y, result, why);
}

static void forget(void *self, const fxs_scene *scene)
{
    (void)self, (void)scene;
}

static const char *version(const void *self, enum fxs_stage stage)
{
    const gl_backend *b = self;
    return stage == FXS_BLEND || stage == FXS_RESOLVE ? b->kind->name
        : b->processor.context.config.kernels->name[stage];
}

static int device_faster(int device, char *name, size_t size, fxs_message *why)
{
    return device_of(&faster, device, name, size, why);
}

static int open_faster(void **self, const fxs_backend_options *options, fxs_message *why)
{
    return open_kind(self, &faster, options, why);
}

static int device_fetch(int device, char *name, size_t size, fxs_message *why)
{
    return device_of(&fetch, device, name, size, why);
}

static int open_fetch(void **self, const fxs_backend_options *options, fxs_message *why)
{
    return open_kind(self, &fetch, options, why);
}

static int device_osmesa(int device, char *name, size_t size, fxs_message *why)
{
    return device_of(&osmesa, device, name, size, why);
}

static int open_osmesa(void **self, const fxs_backend_options *options, fxs_message *why)
{
    return open_kind(self, &osmesa, options, why);
}

#define SHARED .render = render, .forget = forget, .version = version, .nanoseconds = nanoseconds, .close = close_gl, \
               .pick = pick

const fxs_backend fxs_backend_gles = {
    .name = "gles", .does = "OpenGL ES 3.0 by EGL",
    .can = FXS_CAN_PART, .device = device_faster, .open = open_faster, SHARED
};

const fxs_backend fxs_backend_gles_fetch = {
    .name = "gles-fetch", .does = "the same device by framebuffer fetch, without lists",
    .can = FXS_CAN_PART, .device = device_fetch, .open = open_fetch, SHARED
};

const fxs_backend fxs_backend_osmesa = {
    .name = "osmesa", .does = "OpenGL by OSMesa",
    .can = FXS_CAN_PART, .device = device_osmesa, .open = open_osmesa, SHARED
};
