/* Windows, EGL and the natives of StandIn.java. EGL is Mesa's without a window system; the surface of a window is a
 * pbuffer, and eglSwapBuffers copies its pixels to the window. */
#define _GNU_SOURCE    /* dladdr */
#include "stand_in.h"

#include <dlfcn.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GLES3/gl3.h>
#include <jni.h>
#include <jvmti.h>

#include <fixsplat/renderer.h>

volatile int stand_in_faults[FAULTS];
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

int stand_in_fails(int fault)
{
    pthread_mutex_lock(&lock);
    const int fails = stand_in_faults[fault] > 0;
    stand_in_faults[fault] -= fails;
    pthread_mutex_unlock(&lock);
    return fails;
}

void stand_in_show(stand_in_window *window, const void *pixels, int32_t width, int32_t height, int bottom_up)
{
    const size_t row = (size_t)width * 4;
    pthread_mutex_lock(&lock);
    window->pixels = realloc(window->pixels, row * (size_t)height);
    for (int32_t y = 0; y < height; y++)
        memcpy((char *)window->pixels + row * (size_t)y,
               (const char *)pixels + row * (size_t)(bottom_up ? height - 1 - y : y), row);
    window->shown_width = width;
    window->shown_height = height;
    window->shown++;
    pthread_mutex_unlock(&lock);
}

/* ---- libandroid -------------------------------------------------------------------------------------------------- */

void *ANativeWindow_fromSurface(JNIEnv *env, jobject surface)
{
    const jclass class = (*env)->GetObjectClass(env, surface);
    stand_in_window *const window =
        (stand_in_window *)(intptr_t)(*env)->GetLongField(env, surface, (*env)->GetFieldID(env, class, "window", "J"));
    if (window)
        window->refs++;
    return window;
}

void ANativeWindow_release(stand_in_window *window)
{
    window->refs--;
}

int32_t ANativeWindow_getWidth(stand_in_window *window)
{
    return window->width;
}

int32_t ANativeWindow_getHeight(stand_in_window *window)
{
    return window->height;
}

/* ---- libEGL ------------------------------------------------------------------------------------------------------ */

static EGLint fault;                   /* of the next eglGetError; 0: Mesa's */
static struct {
    EGLSurface surface;
    stand_in_window *window;
} surfaces[16];

static void (*real(const char *name))(void)
{
    static void *library;
    void (*found)(void);
    library = library ? library : dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
    void *const address = dlsym(library, name);
    memcpy(&found, &address, sizeof found);
    return found;
}
#define REAL(TYPE, name) ((PFN##TYPE##PROC)real(#name))

EGLDisplay eglGetDisplay(EGLNativeDisplayType unused)
{
    (void)unused;
    return REAL(EGLGETPLATFORMDISPLAY, eglGetPlatformDisplay)(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
}

EGLBoolean eglInitialize(EGLDisplay display, EGLint *major, EGLint *minor)
{
    return !stand_in_fails(NO_EGL) && REAL(EGLINITIALIZE, eglInitialize)(display, major, minor);
}

EGLBoolean eglTerminate(EGLDisplay display)
{
    return REAL(EGLTERMINATE, eglTerminate)(display);
}

EGLBoolean eglReleaseThread(void)
{
    return REAL(EGLRELEASETHREAD, eglReleaseThread)();
}

EGLBoolean eglChooseConfig(EGLDisplay display, const EGLint *wanted, EGLConfig *configs, EGLint size, EGLint *count)
{
    EGLint without[32];
    int n = 0;
    for (; wanted[n] != EGL_NONE; n += 2) {
        without[n] = wanted[n];
        without[n + 1] = wanted[n] == EGL_SURFACE_TYPE ? EGL_PBUFFER_BIT : wanted[n + 1];
    }
    without[n] = EGL_NONE;
    return REAL(EGLCHOOSECONFIG, eglChooseConfig)(display, without, configs, size, count);
}

EGLContext eglCreateContext(EGLDisplay display, EGLConfig config, EGLContext shared, const EGLint *wanted)
{
    return REAL(EGLCREATECONTEXT, eglCreateContext)(display, config, shared, wanted);
}

EGLBoolean eglDestroyContext(EGLDisplay display, EGLContext context)
{
    return REAL(EGLDESTROYCONTEXT, eglDestroyContext)(display, context);
}

EGLSurface eglCreatePbufferSurface(EGLDisplay display, EGLConfig config, const EGLint *wanted)
{
    return REAL(EGLCREATEPBUFFERSURFACE, eglCreatePbufferSurface)(display, config, wanted);
}

EGLSurface eglCreateWindowSurface(EGLDisplay display, EGLConfig config, EGLNativeWindowType native,
                                  const EGLint *wanted)
{
    stand_in_window *const window = (stand_in_window *)native;
    const EGLint size[] = {EGL_WIDTH, window->width, EGL_HEIGHT, window->height, EGL_NONE};
    (void)wanted;
    if (window->is_taken) {
        fault = EGL_BAD_ALLOC;
        return EGL_NO_SURFACE;
    }
    if (stand_in_fails(SURFACE_LOST)) {
        fault = EGL_BAD_NATIVE_WINDOW;
        return EGL_NO_SURFACE;
    }
    for (size_t i = 0; i < sizeof surfaces / sizeof *surfaces; i++)
        if (!surfaces[i].surface) {
            window->is_taken = 1;
            surfaces[i].window = window;
            return surfaces[i].surface = eglCreatePbufferSurface(display, config, size);
        }
    return EGL_NO_SURFACE;
}

EGLBoolean eglDestroySurface(EGLDisplay display, EGLSurface surface)
{
    for (size_t i = 0; i < sizeof surfaces / sizeof *surfaces; i++)
        if (surfaces[i].surface == surface) {
            surfaces[i].window->is_taken = 0;
            surfaces[i].surface = NULL;
        }
    return REAL(EGLDESTROYSURFACE, eglDestroySurface)(display, surface);
}

EGLBoolean eglMakeCurrent(EGLDisplay display, EGLSurface draw, EGLSurface read, EGLContext context)
{
    return REAL(EGLMAKECURRENT, eglMakeCurrent)(display, draw, read, context);
}

EGLBoolean eglQuerySurface(EGLDisplay display, EGLSurface surface, EGLint what, EGLint *value)
{
    return REAL(EGLQUERYSURFACE, eglQuerySurface)(display, surface, what, value);
}

EGLint eglGetError(void)
{
    const EGLint now = fault ? fault : REAL(EGLGETERROR, eglGetError)();
    fault = 0;
    return now;
}

__eglMustCastToProperFunctionPointerType eglGetProcAddress(const char *name)
{
    if (!strcmp(name, "glDispatchCompute") && stand_in_fails(NO_COMPUTE))
        return NULL;
    return REAL(EGLGETPROCADDRESS, eglGetProcAddress)(name);
}

EGLBoolean eglSwapBuffers(EGLDisplay display, EGLSurface surface)
{
    (void)display;
    fault = stand_in_fails(DEVICE_LOST) ? EGL_CONTEXT_LOST : stand_in_fails(OUT_OF_DATE) ? EGL_BAD_SURFACE : 0;
    if (fault)
        return EGL_FALSE;
    for (size_t i = 0; i < sizeof surfaces / sizeof *surfaces; i++)
        if (surfaces[i].surface == surface) {
            EGLint width, height;
            eglQuerySurface(display, surface, EGL_WIDTH, &width);
            eglQuerySurface(display, surface, EGL_HEIGHT, &height);
            void *const pixels = malloc((size_t)width * (size_t)height * 4);
            ((PFNGLBINDFRAMEBUFFERPROC)eglGetProcAddress("glBindFramebuffer"))(GL_READ_FRAMEBUFFER, 0);
            ((PFNGLREADPIXELSPROC)eglGetProcAddress("glReadPixels"))(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE,
                                                                    pixels);
            stand_in_show(surfaces[i].window, pixels, width, height, 1);
            free(pixels);
        }
    return EGL_TRUE;
}

/* ---- StandIn.java ------------------------------------------------------------------------------------------------ */

static jniNativeInterface *functions;
static jobject(JNICALL *real_new)(JNIEnv *, jobject);
static void(JNICALL *real_delete)(JNIEnv *, jobject);
static int global_references;

/* Returns true if a caller is in the library, and false if it is in a library of Java. */
static int is_ours(void *caller)
{
    Dl_info info;
    return dladdr(caller, &info) && strstr(info.dli_fname, "libfixsplat");
}

static jobject JNICALL counting_new(JNIEnv *env, jobject object)
{
    const int change = object && is_ours(__builtin_return_address(0));
    __atomic_add_fetch(&global_references, change, __ATOMIC_SEQ_CST);
    return real_new(env, object);
}

static void JNICALL counting_delete(JNIEnv *env, jobject object)
{
    const int change = object && is_ours(__builtin_return_address(0));
    __atomic_sub_fetch(&global_references, change, __ATOMIC_SEQ_CST);
    real_delete(env, object);
}

JNIEXPORT jint JNICALL JNI_OnLoad(JavaVM *vm, void *unused)
{
    jvmtiEnv *tools;
    (void)unused;
    if ((*vm)->GetEnv(vm, (void *)&tools, JVMTI_VERSION_1_2) || (*tools)->GetJNIFunctionTable(tools, &functions))
        return JNI_ERR;
    real_new = functions->NewGlobalRef;
    real_delete = functions->DeleteGlobalRef;
    functions->NewGlobalRef = counting_new;
    functions->DeleteGlobalRef = counting_delete;
    return (*tools)->SetJNIFunctionTable(tools, functions) ? JNI_ERR : JNI_VERSION_1_6;
}

static stand_in_window *window_of(jlong handle)
{
    return (stand_in_window *)(intptr_t)handle;
}

JNIEXPORT jlong JNICALL Java_org_fixsplat_StandIn_newWindow(JNIEnv *env, jclass class)
{
    (void)env, (void)class;
    return (jlong)(intptr_t)calloc(1, sizeof(stand_in_window));
}

JNIEXPORT void JNICALL Java_org_fixsplat_StandIn_resize(JNIEnv *env, jclass class, jlong handle, jint width,
                                                        jint height)
{
    (void)env, (void)class;
    window_of(handle)->width = width;
    window_of(handle)->height = height;
}

/* The size of the picture, 0 for none; the number of pictures shown; references; whether a surface uses the window. */
JNIEXPORT void JNICALL Java_org_fixsplat_StandIn_look(JNIEnv *env, jclass class, jlong handle, jlongArray to)
{
    const stand_in_window *const w = window_of(handle);
    (void)class;
    pthread_mutex_lock(&lock);
    const jlong numbers[] = {w->shown_width, w->shown_height, (jlong)w->shown, w->refs, w->is_taken};
    pthread_mutex_unlock(&lock);
    (*env)->SetLongArrayRegion(env, to, 0, 5, numbers);
}

JNIEXPORT jintArray JNICALL Java_org_fixsplat_StandIn_pixels(JNIEnv *env, jclass class, jlong handle)
{
    const stand_in_window *const w = window_of(handle);
    (void)class;
    pthread_mutex_lock(&lock);
    const jsize count = w->shown_width * w->shown_height;
    const jintArray array = (*env)->NewIntArray(env, count);
    if (array)
        (*env)->SetIntArrayRegion(env, array, 0, count, (const jint *)w->pixels);
    pthread_mutex_unlock(&lock);
    return array;
}

JNIEXPORT void JNICALL Java_org_fixsplat_StandIn_fail(JNIEnv *env, jclass class, jint which, jint count)
{
    (void)env, (void)class;
    stand_in_faults[which] = count;
}

JNIEXPORT jint JNICALL Java_org_fixsplat_StandIn_globalReferences(JNIEnv *env, jclass class)
{
    (void)env, (void)class;
    return __atomic_load_n(&global_references, __ATOMIC_SEQ_CST);
}
