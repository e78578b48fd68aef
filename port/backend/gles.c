/* OpenGL in place of blend and resolve: by EGL, exact or as quads, and by OSMesa. */
#include <stdio.h>
#include <stdlib.h>

#include "backends.h"
#include "processor_internal.h"

#ifdef FXS_WITH_GLES
#include "../../kernels/gles/gles.h"
#else
typedef int fxs_gl_load_fn;
#endif
#ifdef FXS_WITH_EGL
#include "../egl/egl.h"
#define EGL fxs_egl_open, fxs_egl_load, fxs_egl_use, fxs_egl_close
#else
#define EGL 0, 0, 0, 0
#endif
#ifdef FXS_WITH_OSMESA
#include "../osmesa/osmesa.h"
#define OSMESA fxs_osmesa_open, fxs_osmesa_load, fxs_osmesa_use, fxs_osmesa_close
#else
#define OSMESA 0, 0, 0, 0
#endif

/* Where the context comes from, and what draws in it. */
typedef struct kind {
    const char *name, *packages;
    int quads;
    int (*open)(void **port, fxs_message *why);
    fxs_gl_load_fn *load;
    int (*use)(void *port);
    void (*close)(void *port);
} kind;

static const kind exact = {"gles", "libegl-dev, libgles-dev", 0, EGL};
static const kind quads = {"gles-quads", "libegl-dev, libgles-dev", 1, EGL};
static const kind osmesa = {"osmesa", "libosmesa6-dev, libgles-dev", 0, OSMESA};

typedef struct gl_backend {
    const kind *kind;
    void *port;
    struct fxs_gles *gles;
    fxs_processor processor;
    int processor_open;
} gl_backend;

#ifdef FXS_WITH_GLES
static int open_gles(gl_backend *b, fxs_message *why)
{
    char text[FXS_GLES_MESSAGE];
    fxs_gles *gles = malloc(fxs_gles_bytes());
    if (!gles)
        return fxs_refuse(FXS_ERR_MEMORY, fxs_gles_bytes(), why, "out of memory");
    const int error = fxs_gles_init(gles, b->kind->load, b->kind->use, b->port, text);
    if (error) {
        free(gles);
        return fxs_refuse(error, 0, why, "%s", text);
    }
    b->gles = gles;
    return 0;
}

static void close_gles(gl_backend *b)
{
    if (b->gles)
        fxs_gles_free(b->gles);
    free(b->gles);
}

static fxs_config drawing(const gl_backend *b)
{
    return (fxs_config){.draw = b->kind->quads ? fxs_gles_draw_quads : fxs_gles_draw, .draw_argument = b->gles,
                        .draw_unlisted = b->kind->quads};
}

static uint64_t nanoseconds(const void *self)
{
    return fxs_gles_nanoseconds(((const gl_backend *)self)->gles);
}

static const char *renderer(const gl_backend *b)
{
    return fxs_gles_renderer(b->gles);
}
#else
static int open_gles(gl_backend *b, fxs_message *why)
{
    return fxs_refuse(FXS_ERR_UNSUPPORTED, 0, why, "built without the headers in %s", b->kind->packages);
}

static void close_gles(gl_backend *b)
{
    (void)b;
}

static fxs_config drawing(const gl_backend *b)
{
    (void)b;
    return (fxs_config){.draw = 0};
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

/* The context alone. */
static int open_context(gl_backend **out, const kind *k, int device, fxs_message *why)
{
    *out = 0;
    if (!k->open)
        return fxs_refuse(FXS_ERR_UNSUPPORTED, 0, why, "built without the headers in %s", k->packages);
    if (device != 0)
        return fxs_refuse(FXS_ERR_DEVICE, 0, why, "there is no device %d: the first that can be had is 0", device);
    gl_backend *b = calloc(1, sizeof *b);
    if (!b)
        return fxs_refuse(FXS_ERR_MEMORY, sizeof *b, why, "out of memory");
    b->kind = k;
    why->bytes_needed = 0;
    int error = k->open(&b->port, why) ? FXS_ERR_DEVICE : open_gles(b, why);
    if (error)
        close_gl(b);
    else
        *out = b;
    return error;
}

static int open_kind(void **self, const kind *k, const fxs_backend_options *options, fxs_message *why)
{
    gl_backend *b;
    *self = 0;
    int error = open_context(&b, k, options->device, why);
    if (error)
        return error;
    const fxs_config config = drawing(b);
    error = fxs_processor_open(&b->processor, options, &config, why);
    b->processor_open = !error;
    if (error)
        close_gl(b);
    else
        *self = b;
    return error;
}

static int device_of(const kind *k, int device, char *name, size_t size, fxs_message *why)
{
    gl_backend *b;
    const int error = open_context(&b, k, device, why);
    if (!error)
        snprintf(name, size, "%s", renderer(b));
    close_gl(b);
    return error;
}

static int render(void *self, const fxs_request *request, fxs_stats *stats, fxs_message *why)
{
    return fxs_processor_render(&((gl_backend *)self)->processor, request, stats, why);
}

static int pick(void *self, const fxs_request *request, int32_t x, int32_t y, fxs_pick_result *result,
                fxs_message *why)
{
    return fxs_processor_pick(&((gl_backend *)self)->processor, request, x, y, result, why);
}

static void forget(void *self, const fxs_scene *scene)
{
    (void)self, (void)scene;       /* a frame's splats are uploaded, not its scenes */
}

static const char *version(const void *self, enum fxs_stage stage)
{
    const gl_backend *b = self;
    return stage == FXS_BLEND || stage == FXS_RESOLVE ? b->kind->name : b->processor.context.kernels.name[stage];
}

static int device_exact(int device, char *name, size_t size, fxs_message *why)
{
    return device_of(&exact, device, name, size, why);
}

static int open_exact(void **self, const fxs_backend_options *options, fxs_message *why)
{
    return open_kind(self, &exact, options, why);
}

static int device_quads(int device, char *name, size_t size, fxs_message *why)
{
    return device_of(&quads, device, name, size, why);
}

static int open_quads(void **self, const fxs_backend_options *options, fxs_message *why)
{
    return open_kind(self, &quads, options, why);
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
    .name = "gles", .does = "OpenGL ES 3.0 by EGL, the same bytes", .can = FXS_CAN_EXACT | FXS_CAN_SHARE_EYES,
    .device = device_exact, .open = open_exact, SHARED
};

const fxs_backend fxs_backend_gles_quads = {
    .name = "gles-quads", .does = "the same device, quads blended by the hardware: inexact", .can = FXS_CAN_SHARE_EYES,
    .device = device_quads, .open = open_quads, SHARED
};

const fxs_backend fxs_backend_osmesa = {
    .name = "osmesa", .does = "OpenGL by OSMesa, the same bytes", .can = FXS_CAN_EXACT | FXS_CAN_SHARE_EYES,
    .device = device_osmesa, .open = open_osmesa, SHARED
};
