/* A session of OpenXR by OpenGL ES 3.1 in the program's context (XR_KHR_opengl_es_enable; on a desktop with
 * XR_MNDX_egl_enable). The back end for compute shaders draws colours and median depths of both eyes; a fragment shader
 * converts the depths for the swapchain. */
#include "xr_internal.h"

#ifdef FXS_XR_BY_GLES

#include <stdlib.h>
#include <string.h>

#include <GLES3/gl31.h>

#include <fixsplat/internal/message.h>

#define SRGB_WRITES 0x8DB9                 /* constants of EXT_sRGB_write_control and EXT_disjoint_timer_query */
#define TIME_ELAPSED 0x88BF
enum { QUERIES = 4 };

#define CALLS(_) \
    _(void, GenTextures, (GLsizei, GLuint *)) \
    _(void, DeleteTextures, (GLsizei, const GLuint *)) \
    _(void, BindTexture, (GLenum, GLuint)) \
    _(void, ActiveTexture, (GLenum)) \
    _(void, TexStorage2D, (GLenum, GLsizei, GLenum, GLsizei, GLsizei)) \
    _(void, TexParameteri, (GLenum, GLenum, GLint)) \
    _(void, GenFramebuffers, (GLsizei, GLuint *)) \
    _(void, DeleteFramebuffers, (GLsizei, const GLuint *)) \
    _(void, BindFramebuffer, (GLenum, GLuint)) \
    _(void, FramebufferTexture2D, (GLenum, GLenum, GLenum, GLuint, GLint)) \
    _(void, FramebufferTextureLayer, (GLenum, GLenum, GLuint, GLint, GLint)) \
    _(void, DrawBuffers, (GLsizei, const GLenum *)) \
    _(GLuint, CreateProgram, (void)) \
    _(void, DeleteProgram, (GLuint)) \
    _(GLuint, CreateShader, (GLenum)) \
    _(void, DeleteShader, (GLuint)) \
    _(void, ShaderSource, (GLuint, GLsizei, const GLchar *const *, const GLint *)) \
    _(void, CompileShader, (GLuint)) \
    _(void, AttachShader, (GLuint, GLuint)) \
    _(void, LinkProgram, (GLuint)) \
    _(void, GetProgramiv, (GLuint, GLenum, GLint *)) \
    _(void, UseProgram, (GLuint)) \
    _(void, Uniform2f, (GLint, GLfloat, GLfloat)) \
    _(void, Viewport, (GLint, GLint, GLsizei, GLsizei)) \
    _(void, Enable, (GLenum)) \
    _(void, Disable, (GLenum)) \
    _(void, DepthFunc, (GLenum)) \
    _(void, DepthMask, (GLboolean)) \
    _(void, BindVertexArray, (GLuint)) \
    _(void, DrawArrays, (GLenum, GLint, GLsizei)) \
    _(void, Finish, (void)) \
    _(GLenum, GetError, (void)) \
    _(const GLubyte *, GetStringi, (GLenum, GLuint)) \
    _(void, GetIntegerv, (GLenum, GLint *)) \
    _(void, GenQueries, (GLsizei, GLuint *)) \
    _(void, DeleteQueries, (GLsizei, const GLuint *)) \
    _(void, BeginQuery, (GLenum, GLuint)) \
    _(void, EndQuery, (GLenum)) \
    _(void, GetQueryObjectuiv, (GLuint, GLenum, GLuint *))

#ifdef __ANDROID__
typedef XrGraphicsBindingOpenGLESAndroidKHR gles_binding;
#define BINDING_TYPE XR_TYPE_GRAPHICS_BINDING_OPENGL_ES_ANDROID_KHR
#else
typedef XrGraphicsBindingEGLMNDX gles_binding;
#define BINDING_TYPE XR_TYPE_GRAPHICS_BINDING_EGL_MNDX
#endif

typedef struct gles_graphics {
    struct {
#define MEMBER(result, name, arguments) result (GL_APIENTRY *name) arguments;
        CALLS(MEMBER)
    } gl;
    gles_binding binding;
    fxs_compute *compute;
    fxs_compute_scene *scenes;             /* copies on the device; scenes[i].key is the caller's scene */
    const fxs_compute_scene **copies;
    uint32_t scene_count, copy_room;
    void *memory;
    size_t memory_bytes;
    GLuint framebuffers[2], depth_framebuffers[2], medians[2], ids[2], to_depth;     /* for each eye */
    int timed;                             /* 1: the context has EXT_disjoint_timer_query */
    GLuint queries[QUERIES];
    uint32_t frame;
} gles_graphics;

/* ---- Context ----------------------------------------------------------------------------------------------------- */

static int load_calls(const fxs_xr *xr, gles_graphics *g)
{
    int all = 1;
#define LOAD(result, name, arguments) \
    g->gl.name = (result (GL_APIENTRY *) arguments)xr->options.load(xr->options.argument, "gl" #name); \
    all = all && g->gl.name;
    CALLS(LOAD)
    return all;
}

static int has_extension(const gles_graphics *g, const char *name)
{
    GLint count = 0;
    g->gl.GetIntegerv(GL_NUM_EXTENSIONS, &count);
    for (GLint i = 0; i < count; i++) {
        const char *there = (const char *)g->gl.GetStringi(GL_EXTENSIONS, (GLuint)i);
        if (there && !strcmp(there, name))
            return 1;
    }
    return 0;
}

/* Describes the current context to the runtime. */
static int bind(const fxs_xr *xr, gles_graphics *g, fxs_message *why)
{
#define EGL(type, name) type name##_ = (type)xr->options.load(xr->options.argument, #name)
    EGL(PFNEGLGETCURRENTDISPLAYPROC, eglGetCurrentDisplay);
    EGL(PFNEGLGETCURRENTCONTEXTPROC, eglGetCurrentContext);
    EGL(PFNEGLQUERYCONTEXTPROC, eglQueryContext);
    EGL(PFNEGLCHOOSECONFIGPROC, eglChooseConfig);
    EGLint attributes[] = {EGL_CONFIG_ID, 0, EGL_NONE}, count = 0;
    g->binding.type = BINDING_TYPE;
#ifndef __ANDROID__
    g->binding.getProcAddress = (PFNEGLGETPROCADDRESSPROC)xr->options.load(xr->options.argument, "eglGetProcAddress");
#endif
    if (!eglGetCurrentDisplay_ || !eglGetCurrentContext_ || !eglQueryContext_ || !eglChooseConfig_)
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "no functions of EGL");
    g->binding.display = eglGetCurrentDisplay_();
    g->binding.context = eglGetCurrentContext_();
    if (!g->binding.context ||
        !eglQueryContext_(g->binding.display, g->binding.context, EGL_CONFIG_ID, &attributes[1]) ||
        !eglChooseConfig_(g->binding.display, attributes, &g->binding.config, 1, &count) || count != 1)
        return fxs_fail_as(FXS_ERR_DEVICE, why, "no EGL context is current");
    return 0;
}

static int ask_requirements(fxs_xr *xr, fxs_message *why)
{
    XrGraphicsRequirementsOpenGLESKHR needs = {.type = XR_TYPE_GRAPHICS_REQUIREMENTS_OPENGL_ES_KHR};
    PFN_xrVoidFunction ask;
    const int error = fxs_xr_find(xr, "xrGetOpenGLESGraphicsRequirementsKHR", &ask, why);
    return error ? error : fxs_xr_check(xr, ((PFN_xrGetOpenGLESGraphicsRequirementsKHR)ask)(xr->instance, xr->system,
                                        &needs), "xrGetOpenGLESGraphicsRequirementsKHR", why);
}

static int open_gles(fxs_xr *xr, fxs_message *why)
{
    gles_graphics *g = calloc(1, sizeof *g);
    if (!g)
        return fxs_fail_memory(why, 0, sizeof *g);
    if (!load_calls(xr, g)) {
        free(g);
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "no OpenGL ES 3.1");
    }
    xr->device = g;
    int error = bind(xr, g, why);
    error = error ? error : ask_requirements(xr, why);
    if (error)
        return error;
    xr->binding = &g->binding;
    g->timed = has_extension(g, "GL_EXT_disjoint_timer_query");
    g->gl.GenQueries(QUERIES, g->queries);
    /* The pixels are sRGB values already, so the framebuffer must not convert them. */
    if (has_extension(g, "GL_EXT_sRGB_write_control"))
        g->gl.Disable(SRGB_WRITES);
    return 0;
}

static void end_gles(fxs_xr *xr)
{
    ((gles_graphics *)xr->device)->gl.Finish();
}

static void close_gles(fxs_xr *xr)
{
    gles_graphics *g = xr->device;
    for (uint32_t i = 0; i < g->scene_count; i++)
        fxs_compute_drop(g->compute, &g->scenes[i]);
    fxs_compute_destroy(g->compute);
    g->gl.DeleteFramebuffers(2, g->framebuffers);
    g->gl.DeleteFramebuffers(2, g->depth_framebuffers);
    g->gl.DeleteTextures(2, g->medians);
    g->gl.DeleteTextures(2, g->ids);
    g->gl.DeleteQueries(QUERIES, g->queries);
    g->gl.DeleteProgram(g->to_depth);
    free(g->scenes);
    free(g->copies);
    free(g->memory);
    free(g);
}

/* ---- Framebuffers ------------------------------------------------------------------------------------------------ */

static const GLchar vertex[] =
    "#version 310 es\n"
    "void main() { gl_Position = vec4(ivec2(gl_VertexID & 1, gl_VertexID >> 1) * 4 - 1, 0, 1); }";

/* Converts median depths of 16 fraction bits to (1/z - 1/near) / (1/far - 1/near). Without a Gaussian: 1. */
static const GLchar fragment[] =
    "#version 310 es\nprecision highp float;\nprecision highp int;\n"
    "uniform highp usampler2D medians;\nlayout(location = 0) uniform vec2 planes;\n"
    "void main() {\nuint depth = texelFetch(medians, ivec2(gl_FragCoord.xy), 0).x;\n"
    "float over = depth == 0xffffffffu ? planes.y : 65536.0 / float(max(depth, 1u));\n"
    "gl_FragDepth = clamp((over - planes.x) / (planes.y - planes.x), 0.0, 1.0); }";

static int make_program(gles_graphics *g, fxs_message *why)
{
    const GLchar *const texts[] = {vertex, fragment};
    GLint linked = 0;
    g->to_depth = g->gl.CreateProgram();
    for (int i = 0; i < 2; i++) {
        const GLuint shader = g->gl.CreateShader(i ? GL_FRAGMENT_SHADER : GL_VERTEX_SHADER);
        g->gl.ShaderSource(shader, 1, &texts[i], 0);
        g->gl.CompileShader(shader);
        g->gl.AttachShader(g->to_depth, shader);
        g->gl.DeleteShader(shader);
    }
    g->gl.LinkProgram(g->to_depth);
    g->gl.GetProgramiv(g->to_depth, GL_LINK_STATUS, &linked);
    return linked ? 0 : fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "the shader of the depth images does not compile");
}

static void attach(const fxs_xr *xr, gles_graphics *g, GLenum attachment, GLenum format, GLuint texture)
{
    g->gl.BindTexture(GL_TEXTURE_2D, texture);
    g->gl.TexStorage2D(GL_TEXTURE_2D, 1, format, xr->info.full_width, xr->info.full_height);
    g->gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    g->gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    g->gl.FramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, texture, 0);
}

static int ready_gles(fxs_xr *xr, fxs_message *why)
{
    static const GLenum three[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2};
    gles_graphics *g = xr->device;
    int error = fxs_compute_create(&g->compute, xr->options.load, 0, xr->options.argument, why);
    if (error)
        return error;
    fxs_compute_limit(g->compute, xr->options.max_memory);
    xr->info.device = fxs_compute_info(g->compute).renderer;
    g->gl.GenFramebuffers(2, g->framebuffers);
    if (!xr->info.has_depth)
        return 0;
    g->gl.GenFramebuffers(2, g->depth_framebuffers);
    g->gl.GenTextures(2, g->medians);
    g->gl.GenTextures(2, g->ids);
    for (int eye = 0; eye < 2; eye++) {
        g->gl.BindFramebuffer(GL_FRAMEBUFFER, g->framebuffers[eye]);
        attach(xr, g, three[1], GL_R32UI, g->medians[eye]);
        attach(xr, g, three[2], GL_RG32UI, g->ids[eye]);
        g->gl.DrawBuffers(3, three);
    }
    error = make_program(g, why);
    return error || !g->gl.GetError() ? error : fxs_fail_as(FXS_ERR_DEVICE, why, "OpenGL ES: no framebuffers");
}

/* ---- Scenes ------------------------------------------------------------------------------------------------------ */

static void forget(fxs_xr *xr, const fxs_scene *scene)
{
    gles_graphics *g = xr->device;
    for (uint32_t i = 0; i < g->scene_count; i++)
        if (g->scenes[i].key == scene) {
            fxs_compute_drop(g->compute, &g->scenes[i]);
            g->scenes[i] = g->scenes[--g->scene_count];
            return;
        }
}

static const fxs_compute_scene *copy_of(const gles_graphics *g, const fxs_scene *scene)
{
    for (uint32_t i = 0; i < g->scene_count; i++)
        if (g->scenes[i].key == scene)
            return &g->scenes[i];
    return 0;
}

static int upload(fxs_xr *xr, const fxs_scene *scene, fxs_message *why)
{
    gles_graphics *g = xr->device;
    const fxs_compute_scene *there = copy_of(g, scene);
    fxs_compute_scene copy = {.key = 0};
    if (there && !memcmp(&there->here, scene, sizeof *scene))
        return 0;
    forget(xr, scene);
    fxs_compute_scene *scenes = realloc(g->scenes, (g->scene_count + 1) * sizeof *scenes);
    if (!scenes)
        return fxs_fail_memory(why, 0, 0);
    g->scenes = scenes;
    const int error = fxs_compute_upload(g->compute, &copy, scene, why);
    if (error)
        return error;
    copy.key = scene;
    g->scenes[g->scene_count++] = copy;
    return 0;
}

/* ---- Frames ------------------------------------------------------------------------------------------------------ */

static int make_room(gles_graphics *g, const fxs_request *request, fxs_message *why)
{
    const size_t bytes = fxs_compute_memory(request);
    if (request->count > g->copy_room) {
        free(g->copies);
        g->copies = malloc(request->count * sizeof *g->copies);
        g->copy_room = g->copies ? request->count : 0;
    }
    if (bytes > g->memory_bytes) {
        free(g->memory);
        g->memory = malloc(bytes);
        g->memory_bytes = g->memory ? bytes : 0;
    }
    if ((request->count && !g->copies) || !g->memory)
        return fxs_fail_memory(why, 0, bytes);
    for (uint32_t i = 0; i < request->count; i++)
        g->copies[i] = copy_of(g, request->objects[i].scene);
    return 0;
}

static GLuint texture_of(const fxs_xr *xr, int which)
{
    return ((const XrSwapchainImageOpenGLESKHR *)(const void *)xr->images[which])[xr->chains[which].image].image;
}

/* Writes the depth images of both eyes. */
static void fill_depths(const fxs_xr *xr, const gles_graphics *g, const fxs_request *request)
{
    g->gl.UseProgram(g->to_depth);
    g->gl.Uniform2f(0, (GLfloat)(1 / (FXS_XR_NEAR * xr->place.units)), (GLfloat)(1 / (FXS_XR_FAR * xr->place.units)));
    g->gl.BindVertexArray(0);
    g->gl.ActiveTexture(GL_TEXTURE0);
    g->gl.Enable(GL_DEPTH_TEST);
    g->gl.DepthFunc(GL_ALWAYS);
    g->gl.DepthMask(GL_TRUE);
    for (int eye = 0; eye < 2; eye++) {
        g->gl.BindFramebuffer(GL_FRAMEBUFFER, g->depth_framebuffers[eye]);
        g->gl.FramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, texture_of(xr, FXS_XR_DEPTH), 0, eye);
        g->gl.BindTexture(GL_TEXTURE_2D, g->medians[eye]);
        g->gl.Viewport(0, 0, request->cameras[eye].width, request->cameras[eye].height);
        g->gl.DrawArrays(GL_TRIANGLES, 0, 3);
    }
    g->gl.Disable(GL_DEPTH_TEST);
    g->gl.UseProgram(0);
}

static void begin_time(fxs_xr *xr, const gles_graphics *g)
{
    const GLuint query = g->queries[g->frame % QUERIES];
    GLuint nanoseconds = 0;
    if (!g->timed)
        return;
    if (g->frame >= QUERIES)
        g->gl.GetQueryObjectuiv(query, GL_QUERY_RESULT, &nanoseconds);
    xr->info.nanoseconds = nanoseconds;
    g->gl.BeginQuery(TIME_ELAPSED, query);
}

static int draw(fxs_xr *xr, const fxs_request *request, uint32_t *drawn, fxs_message *why)
{
    gles_graphics *g = xr->device;
    fxs_gl_target targets[2];
    fxs_stats stats;
    int error = make_room(g, request, why);
    if (error)
        return error;
    for (int eye = 0; eye < 2; eye++) {
        fxs_gl_target_init(&targets[eye]);
        targets[eye].framebuffer = g->framebuffers[eye];
        targets[eye].format = xr->info.passes_through ? FXS_FORMAT_RGBA8_COVERAGE : FXS_FORMAT_RGBA8;
        targets[eye].depths_and_ids = xr->info.has_depth;
        g->gl.BindFramebuffer(GL_FRAMEBUFFER, g->framebuffers[eye]);
        g->gl.FramebufferTextureLayer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, texture_of(xr, FXS_XR_COLOUR), 0, eye);
    }
    begin_time(xr, g);
    error = fxs_compute_draw(g->compute, request, g->copies, targets, g->memory, &stats, why);
    if (!error && xr->info.has_depth)
        fill_depths(xr, g, request);
    if (g->timed)
        g->gl.EndQuery(TIME_ELAPSED);
    *drawn = error ? 0 : stats.drawn;
    g->frame += !error;
    return error;
}

const fxs_xr_graphics fxs_xr_gles = {
#ifdef __ANDROID__
    .extensions = {XR_KHR_OPENGL_ES_ENABLE_EXTENSION_NAME},
#else
    .extensions = {XR_KHR_OPENGL_ES_ENABLE_EXTENSION_NAME, XR_MNDX_EGL_ENABLE_EXTENSION_NAME},
#endif
    .formats = {{GL_SRGB8_ALPHA8, GL_RGBA8}, {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT16}},
    .usage = {XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT, XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT},
    .image_type = XR_TYPE_SWAPCHAIN_IMAGE_OPENGL_ES_KHR, .image_size = sizeof(XrSwapchainImageOpenGLESKHR),
    .open = open_gles, .ready = ready_gles, .upload = upload, .forget = forget, .draw = draw, .delay = QUERIES,
    .end = end_gles, .close = close_gles
};

#endif
