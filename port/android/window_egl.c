/* Draws into a window of Android by OpenGL ES: in compute shaders, or without these in fragment shaders. Without a
 * window, a hidden surface of one pixel keeps the context and the scenes. Frames are drawn into a texture, which is
 * scaled to the window. */
#include "window_way.h"

#include <stdlib.h>

#include <EGL/egl.h>
#include <GLES3/gl3.h>

#include <fixsplat/gl.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/kernels.h>
#include <fixsplat/internal/message.h>

/* Functions: F(name in the type of the pointer, name). */
#define LIST_EGL(F) \
    F(CHOOSECONFIG, ChooseConfig) F(CREATECONTEXT, CreateContext) F(CREATEPBUFFERSURFACE, CreatePbufferSurface) \
    F(CREATEWINDOWSURFACE, CreateWindowSurface) F(DESTROYCONTEXT, DestroyContext) \
    F(DESTROYSURFACE, DestroySurface) F(GETDISPLAY, GetDisplay) F(GETERROR, GetError) \
    F(GETPROCADDRESS, GetProcAddress) F(INITIALIZE, Initialize) F(MAKECURRENT, MakeCurrent) \
    F(QUERYSURFACE, QuerySurface) F(RELEASETHREAD, ReleaseThread) F(SWAPBUFFERS, SwapBuffers) \
    F(TERMINATE, Terminate)
#define LIST_GL(F) \
    F(BINDFRAMEBUFFER, BindFramebuffer) F(BINDTEXTURE, BindTexture) F(BLITFRAMEBUFFER, BlitFramebuffer) \
    F(DELETEFRAMEBUFFERS, DeleteFramebuffers) F(DELETETEXTURES, DeleteTextures) \
    F(FRAMEBUFFERTEXTURE2D, FramebufferTexture2D) F(GENFRAMEBUFFERS, GenFramebuffers) F(GENTEXTURES, GenTextures) \
    F(GETERROR, GetError) F(TEXSTORAGE2D, TexStorage2D)
#define EGL_MEMBER(type, name) PFNEGL##type##PROC name;
#define GL_MEMBER(type, name) PFNGL##type##PROC name;

typedef struct egl_way {
    struct {
        LIST_EGL(EGL_MEMBER)
    } egl;
    struct {
        LIST_GL(GL_MEMBER)
    } gl;
    EGLDisplay display;
    EGLConfig config;
    EGLContext context;
    EGLSurface hidden, shown;          /* shown: the window's surface, or EGL_NO_SURFACE */
    GLuint texture, framebuffer;
    int32_t width, height;             /* of the texture */
    uint64_t pool_bytes;
    fxs_compute *compute;              /* null: the fragment shaders draw */
    fxs_compute_scene scene;
    fxs_gles *gles;
    fxs_pool *pool;
    fxs_kernels kernels;
    fxs_context processor;
    void *memory;
    size_t bytes;
} egl_way;

/* ---- The context ------------------------------------------------------------------------------------------------- */

static int egl_fail(const egl_way *way, int error, const char *what, fxs_message *why)
{
    return fxs_fail_as(error, why, "OpenGL ES: %s (EGL error 0x%x)", what, (unsigned)way->egl.GetError());
}

static int use_context(void *self)
{
    const egl_way *const way = self;
    const EGLSurface surface = way->shown ? way->shown : way->hidden;
    return way->egl.MakeCurrent(way->display, surface, surface, way->context) ? 0 : -1;
}

static fxs_gl_function find_gl(void *self, const char *name)
{
    return ((egl_way *)self)->egl.GetProcAddress(name);
}

static int load_egl(egl_way *way, fxs_message *why)
{
#define LOAD_EGL(type, name) \
    if (!fxs_system_function("libEGL.so", "egl" #name, &way->egl.name)) \
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "no OpenGL ES: libEGL.so has no egl" #name);
    LIST_EGL(LOAD_EGL)
    return 0;
}

static int load_gl(egl_way *way, fxs_message *why)
{
#define LOAD_GL(type, name) \
    if (!(way->gl.name = (PFNGL##type##PROC)find_gl(way, "gl" #name))) \
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "OpenGL ES has no gl" #name);
    LIST_GL(LOAD_GL)
    return 0;
}

static int make_context(egl_way *way, fxs_message *why)
{
    static const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_WINDOW_BIT | EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                                    EGL_OPENGL_ES3_BIT, EGL_RED_SIZE, 8, EGL_GREEN_SIZE, 8, EGL_BLUE_SIZE, 8, EGL_NONE};
    static const EGLint version[] = {EGL_CONTEXT_CLIENT_VERSION, 3, EGL_NONE};
    static const EGLint one[] = {EGL_WIDTH, 1, EGL_HEIGHT, 1, EGL_NONE};
    EGLint count = 0;
    way->display = way->egl.GetDisplay(EGL_DEFAULT_DISPLAY);
    if (!way->egl.Initialize(way->display, NULL, NULL) ||
        !way->egl.ChooseConfig(way->display, wanted, &way->config, 1, &count) || !count)
        return egl_fail(way, FXS_ERR_UNSUPPORTED, "no display with version 3.0", why);
    way->context = way->egl.CreateContext(way->display, way->config, EGL_NO_CONTEXT, version);
    way->hidden = way->egl.CreatePbufferSurface(way->display, way->config, one);
    return way->context && way->hidden ? 0 : egl_fail(way, FXS_ERR_UNSUPPORTED, "no context of version 3.0", why);
}

static int take_window(void *self, void *window, fxs_message *why)
{
    egl_way *const way = self;
    const EGLSurface before = way->shown;
    way->shown = EGL_NO_SURFACE;
    if (use_context(way))
        return egl_fail(way, FXS_ERR_DEVICE, "the context was lost", why);
    if (before)
        way->egl.DestroySurface(way->display, before);
    if (!window)
        return 0;
    way->shown = way->egl.CreateWindowSurface(way->display, way->config, (EGLNativeWindowType)window, NULL);
    return way->shown && !use_context(way) ? 0 : egl_fail(way, FXS_ERR_DEVICE, "no surface for the window", why);
}

/* ---- The back ends ----------------------------------------------------------------------------------------------- */

static int open_fragments(egl_way *way, fxs_message *why)
{
    fxs_config config;
    fxs_config_init(&config);
    fxs_kernels_choose(&way->kernels, fxs_cpu_detect());
    config.kernels = &way->kernels;
    way->pool = fxs_pool_create(fxs_processors());
    if (way->pool)
        config.workers = (fxs_workers){fxs_pool_run, way->pool, fxs_processors()};
    const int error = fxs_context_init(&way->processor, &config);
    return error ? error : fxs_gles_create(&way->gles, find_gl, use_context, way, why);
}

static void close_way(void *self)
{
    egl_way *const way = self;
    if (way->compute)
        fxs_compute_drop(way->compute, &way->scene);
    fxs_compute_destroy(way->compute);
    fxs_gles_destroy(way->gles);
    fxs_pool_destroy(way->pool);
    if (way->texture && !use_context(way)) {
        way->gl.DeleteTextures(1, &way->texture);
        way->gl.DeleteFramebuffers(1, &way->framebuffer);
    }
    if (way->display) {
        way->egl.MakeCurrent(way->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        if (way->shown)
            way->egl.DestroySurface(way->display, way->shown);
        if (way->hidden)
            way->egl.DestroySurface(way->display, way->hidden);
        if (way->context)
            way->egl.DestroyContext(way->display, way->context);
        way->egl.Terminate(way->display);
        way->egl.ReleaseThread();
    }
    free(way->memory);
    free(way);
}

static int open_way(void **self, void *window, uint64_t pool_bytes, fxs_message *why)
{
    egl_way *const way = calloc(1, sizeof *way);
    if (!way)
        return fxs_fail_memory(why, NULL, sizeof *way);
    way->pool_bytes = pool_bytes;
    int error = load_egl(way, why);
    if (!error)
        error = make_context(way, why);
    if (!error)
        error = take_window(way, window, why);
    if (!error)
        error = load_gl(way, why);
    if (!error && fxs_compute_create(&way->compute, find_gl, use_context, way, why))
        error = open_fragments(way, why);
    if (error)
        close_way(way);
    *self = error ? NULL : way;
    return error;
}

/* ---- Frames ------------------------------------------------------------------------------------------------------ */

static int make_texture(egl_way *way, int32_t width, int32_t height, fxs_message *why)
{
    if (way->texture && way->width == width && way->height == height)
        return 0;
    if (way->texture)
        way->gl.DeleteTextures(1, &way->texture);
    else
        way->gl.GenFramebuffers(1, &way->framebuffer);
    way->gl.GenTextures(1, &way->texture);
    way->gl.BindTexture(GL_TEXTURE_2D, way->texture);
    way->gl.TexStorage2D(GL_TEXTURE_2D, 1, GL_RGBA8, width, height);
    way->gl.BindFramebuffer(GL_FRAMEBUFFER, way->framebuffer);
    way->gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, way->texture, 0);
    way->width = width;
    way->height = height;
    const GLenum fault = way->gl.GetError();
    return fault ? fxs_fail_as(fault == GL_OUT_OF_MEMORY ? FXS_ERR_MEMORY : FXS_ERR_DEVICE, why,
                               "OpenGL ES: no texture of %dx%d (error 0x%x)", (int)width, (int)height, (unsigned)fault)
                 : 0;
}

static int grow(egl_way *way, size_t bytes, fxs_message *why)
{
    if (bytes <= way->bytes)
        return 0;
    free(way->memory);
    way->bytes = 0;
    if (posix_memalign(&way->memory, 64, bytes)) {
        way->memory = NULL;
        return fxs_fail_memory(why, NULL, bytes);
    }
    way->bytes = bytes;
    return 0;
}

static int draw_by_compute(egl_way *way, const fxs_request *request, const fxs_gl_target *target, fxs_stats *stats,
                           fxs_message *why)
{
    const fxs_scene *const scene = request->objects->scene;
    const fxs_compute_scene *const scenes[] = {&way->scene};
    int error = grow(way, fxs_compute_memory(request), why);
    if (!error && way->scene.key != scene) {
        fxs_compute_stream(way->compute, way->pool_bytes, 0);
        error = fxs_compute_upload(way->compute, &way->scene, scene, why);
        way->scene.key = error ? NULL : scene;
    }
    if (!error)
        error = fxs_compute_draw(way->compute, request, scenes, target, way->memory, NULL, why);
    return error ? error : fxs_compute_wait(way->compute, stats, why);
}

static int draw_by_fragments(egl_way *way, const fxs_request *request, const fxs_gl_target *target, fxs_stats *stats,
                             fxs_message *why)
{
    int error = grow(way, fxs_request_bytes(&way->processor, request, NULL), why);
    if (error)
        return error;
    error = fxs_gles_render(way->gles, &way->processor, request, target, way->memory, way->bytes, stats);
    return error ? fxs_fail_as(error, why, "OpenGL ES: %s", fxs_strerror(error)) : 0;
}

static int draw(void *self, const fxs_request *request, fxs_stats *stats, fxs_message *why)
{
    egl_way *const way = self;
    fxs_gl_target target;
    if (use_context(way))
        return egl_fail(way, FXS_ERR_DEVICE, "the context was lost", why);
    const int error = make_texture(way, request->cameras[0].width, request->cameras[0].height, why);
    if (error)
        return error;
    fxs_gl_target_init(&target);
    target.framebuffer = way->framebuffer;
    return (way->compute ? draw_by_compute : draw_by_fragments)(way, request, &target, stats, why);
}

static int show(void *self, fxs_message *why)
{
    egl_way *const way = self;
    EGLint width = 0, height = 0;
    way->egl.QuerySurface(way->display, way->shown, EGL_WIDTH, &width);
    way->egl.QuerySurface(way->display, way->shown, EGL_HEIGHT, &height);
    way->gl.BindFramebuffer(GL_READ_FRAMEBUFFER, way->framebuffer);
    way->gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    way->gl.BlitFramebuffer(0, 0, way->width, way->height, 0, 0, width, height, GL_COLOR_BUFFER_BIT,
                            way->width == width && way->height == height ? GL_NEAREST : GL_LINEAR);
    return way->egl.SwapBuffers(way->display, way->shown)
               ? 0 : egl_fail(way, FXS_ERR_DEVICE, "the window did not take the picture", why);
}

static void drop(void *self, const fxs_scene *scene)
{
    egl_way *const way = self;
    if (way->compute && way->scene.key == scene)
        fxs_compute_drop(way->compute, &way->scene);
}

static void limit(void *self, uint64_t pool_bytes)
{
    egl_way *const way = self;
    way->pool_bytes = pool_bytes;
    if (way->scene.here.places)
        fxs_compute_drop(way->compute, &way->scene);
}

static const char *name(const void *self)
{
    return ((const egl_way *)self)->compute ? "gles-compute" : "gles";
}

const fxs_window_way fxs_window_egl = {open_way, take_window, draw, show, drop, limit, name, close_way};
