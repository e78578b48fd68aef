/* Opens a context of OpenGL ES 3 through EGL without a window. Tries the EGL devices in order, then Mesa's surfaceless
 * platform, then the default display. libEGL and libGLESv2 are loaded at run time. */
#include <fixsplat/gl.h>
#include <fixsplat/internal/gl_contexts.h>
#include <fixsplat/internal/message.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

#define DEVICES 16

typedef void function(void);

typedef struct fxs_egl {
    void *egl_library, *gl_library;
    function *(*get_address)(const char *name);
    EGLDisplay display;
    EGLSurface surface;
    EGLContext context;
} fxs_egl;

/* Finds a function of a loaded library. dlsym returns a data pointer; POSIX allows its use as a function pointer. */
static function *symbol(void *library, const char *name)
{
    function *found = 0;
    void *address = library ? dlsym(library, name) : 0;
    memcpy(&found, &address, sizeof found);
    return found;
}

void (*fxs_egl_load(void *argument, const char *name))(void)
{
    const fxs_egl *e = argument;
    function *found = symbol(e->gl_library, name);
    return found ? found : e->get_address(name);
}

static function *egl_function(const fxs_egl *e, const char *name)
{
    function *found = symbol(e->egl_library, name);
    return found ? found : e->get_address(name);
}
#define CALL(type, name) ((PFN##type##PROC)egl_function(e, #name))

/* Makes the EGL context current in this thread. First makes no context current, because EGL ignores a call for a
   context that it believes to be current. */
int fxs_egl_use(void *egl)
{
    const fxs_egl *e = egl;
    PFNEGLMAKECURRENTPROC make_current = CALL(EGLMAKECURRENT, eglMakeCurrent);
    make_current(e->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    return make_current(e->display, e->surface, e->surface, e->context) ? 0 : -1;
}

static int make_surface(fxs_egl *e, EGLConfig config)
{
    static const EGLint size[] = {EGL_WIDTH, 1, EGL_HEIGHT, 1, EGL_NONE};
    e->surface = EGL_NO_SURFACE;
    if (fxs_egl_use(e) == 0)
        return 1;
    e->surface = CALL(EGLCREATEPBUFFERSURFACE, eglCreatePbufferSurface)(e->display, config, size);
    return e->surface && fxs_egl_use(e) == 0;
}

static int make_context(fxs_egl *e, EGLDisplay display)
{
    static const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_ES3_BIT,
                                    EGL_NONE};
    static const EGLint version[] = {EGL_CONTEXT_CLIENT_VERSION, 3, EGL_NONE};
    EGLConfig config = 0;
    EGLint count = 0, major, minor;
    if (!display || !CALL(EGLINITIALIZE, eglInitialize)(display, &major, &minor))
        return 0;
    e->display = display;
    CALL(EGLBINDAPI, eglBindAPI)(EGL_OPENGL_ES_API);
    if (CALL(EGLCHOOSECONFIG, eglChooseConfig)(display, wanted, &config, 1, &count) && count) {
        e->context = CALL(EGLCREATECONTEXT, eglCreateContext)(display, config, EGL_NO_CONTEXT, version);
        if (e->context && make_surface(e, config))
            return 1;
    }
    if (e->surface)
        CALL(EGLDESTROYSURFACE, eglDestroySurface)(display, e->surface);
    if (e->context)
        CALL(EGLDESTROYCONTEXT, eglDestroyContext)(display, e->context);
    CALL(EGLTERMINATE, eglTerminate)(display);
    e->display = EGL_NO_DISPLAY;
    e->context = EGL_NO_CONTEXT;
    e->surface = EGL_NO_SURFACE;
    return 0;
}

static int try_devices(fxs_egl *e)
{
    PFNEGLQUERYDEVICESEXTPROC query_devices = CALL(EGLQUERYDEVICESEXT, eglQueryDevicesEXT);
    PFNEGLGETPLATFORMDISPLAYEXTPROC platform_display = CALL(EGLGETPLATFORMDISPLAYEXT, eglGetPlatformDisplayEXT);
    EGLDeviceEXT devices[DEVICES];
    EGLint count = 0;
    if (!platform_display)
        return 0;
    if (query_devices && query_devices(DEVICES, devices, &count))
        for (EGLint i = 0; i < count; i++)
            if (make_context(e, platform_display(EGL_PLATFORM_DEVICE_EXT, devices[i], 0)))
                return 1;
    return make_context(e, platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, 0));
}

static int load(fxs_egl *e, fxs_message *m)
{
    e->egl_library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
    if (!e->egl_library)
        return fxs_fail(m, "no EGL: %s", dlerror());
    e->gl_library = dlopen("libGLESv2.so.2", RTLD_NOW | RTLD_LOCAL);
    e->get_address = (function *(*)(const char *))symbol(e->egl_library, "eglGetProcAddress");
    if (!e->get_address)
        return fxs_fail(m, "libEGL.so.1 has no eglGetProcAddress");
    return 0;
}

int fxs_egl_open(void **out, fxs_message *m)
{
    fxs_egl *e = *out = calloc(1, sizeof *e);
    if (!e)
        return fxs_fail(m, "out of memory");
    int result = load(e, m);
    if (!result && !try_devices(e) && !make_context(e, CALL(EGLGETDISPLAY, eglGetDisplay)(EGL_DEFAULT_DISPLAY)))
        result = fxs_fail(m, "no device with OpenGL ES 3.0 through EGL");
    if (result) {
        fxs_egl_close(e);
        *out = 0;
    }
    return result;
}

void fxs_egl_close(void *egl)
{
    fxs_egl *e = egl;
    if (!e)
        return;
    if (e->display) {
        CALL(EGLMAKECURRENT, eglMakeCurrent)(e->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        if (e->surface)
            CALL(EGLDESTROYSURFACE, eglDestroySurface)(e->display, e->surface);
        CALL(EGLDESTROYCONTEXT, eglDestroyContext)(e->display, e->context);
    }
    /* The loaded libraries stay in memory, because unloading them can crash drivers. */
    free(e);
}
