/* The native methods of the class Fixsplat, and calls of its class Source from the library's threads. A thread of the
 * library is attached to Java at its first call, and detached when it ends. A native method that fails throws a
 * FixsplatException with the code and the message. */
#include "window_way.h"

#include <jni.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/message.h>

enum { GAP = 65536 };    /* largest gap between two wanted chunks that is read too, bytes */

static struct {
    JavaVM *vm;
    pthread_key_t attached;
    jclass fault;
    jmethodID make_fault, size, read, cancel, arrived, progress;
    void *(*window_of)(JNIEnv *env, jobject surface);
    fxs_window_library windows;
} java;

/* ---- Threads and faults ------------------------------------------------------------------------------------------ */

static void detach(void *unused)
{
    (void)unused;
    (*java.vm)->DetachCurrentThread(java.vm);
}

/* Returns null if Java has no memory for the thread. */
static JNIEnv *environment(void)
{
    void *env = NULL;
    if ((*java.vm)->GetEnv(java.vm, &env, JNI_VERSION_1_6) == JNI_OK)
        return env;
    JNIEnv *made = NULL;
    if ((*java.vm)->AttachCurrentThreadAsDaemon(java.vm, (void *)&made, NULL))
        return NULL;
    pthread_setspecific(java.attached, &java);
    return made;
}

static void throw_fault(JNIEnv *env, int error, const fxs_message *why)
{
    const jsize length = (jsize)strlen(why->text);
    const jbyteArray text = (*env)->ExceptionCheck(env) ? NULL : (*env)->NewByteArray(env, length);
    if (!text)
        return;
    (*env)->SetByteArrayRegion(env, text, 0, length, (const jbyte *)why->text);
    const jobject fault = (*env)->NewObject(env, java.fault, java.make_fault, (jint)error, text);
    if (fault)
        (*env)->Throw(env, fault);
}

/* ---- Sources ----------------------------------------------------------------------------------------------------- */

static int read_source(void *source, uint64_t offset, void *out, size_t size, fxs_message *why)
{
    JNIEnv *const env = environment();
    const jobject bytes = env ? (*env)->NewDirectByteBuffer(env, out, (jlong)size) : NULL;
    if (!bytes)
        return fxs_fail_memory(why, NULL, size);
    const jstring fault = (*env)->CallObjectMethod(env, source, java.read, (jlong)offset, bytes);
    const int threw = (*env)->ExceptionCheck(env);
    (*env)->ExceptionClear(env);
    const char *const text = fault && !threw ? (*env)->GetStringUTFChars(env, fault, NULL) : NULL;
    const int error = fault || threw ? fxs_fail(why, "%s", text ? text : "out of memory") : 0;
    if (text)
        (*env)->ReleaseStringUTFChars(env, fault, text);
    (*env)->DeleteLocalRef(env, fault);
    (*env)->DeleteLocalRef(env, bytes);
    return error;
}

static void call_source(void *source, jmethodID method)
{
    JNIEnv *const env = environment();
    if (!env)
        return;
    (*env)->CallVoidMethod(env, source, method);
    (*env)->ExceptionClear(env);
}

static void cancel_source(void *source)
{
    call_source(source, java.cancel);
}

static void chunks_arrived(void *source)
{
    call_source(source, java.arrived);
}

static void close_source(void *source)
{
    JNIEnv *const env = environment();
    if (env)
        (*env)->DeleteGlobalRef(env, source);
}

static int tell_progress(void *source, double done)
{
    JNIEnv *const env = environment();
    const int stops = env && (*env)->CallBooleanMethod(env, source, java.progress, done);
    if (env)
        (*env)->ExceptionClear(env);
    return stops;
}

/* ---- Scenes ------------------------------------------------------------------------------------------------------ */

/* A scene, and the buffer of Java that holds its bytes, or null. */
typedef struct scene {
    fxs_opened *opened;
    jobject bytes;
} scene;

static void JNICALL close_scene(JNIEnv *env, jclass class, jlong handle)
{
    scene *const s = (scene *)(intptr_t)handle;
    (void)class;
    if (!s)
        return;
    fxs_close(s->opened);
    if (s->bytes)
        (*env)->DeleteGlobalRef(env, s->bytes);
    free(s);
}

/* Opens a scene in parts from `source`, which a global reference holds until the pager closes it. */
static int open_parts(JNIEnv *env, const char *name, jobject source, fxs_opened **opened, fxs_message *why)
{
    fxs_open_options options;
    const jobject held = (*env)->NewGlobalRef(env, source);
    const fxs_pager_options pager = {.size = sizeof pager, .pool_bytes = FXS_WINDOW_POOL, .arrived = chunks_arrived,
                                     .arrived_argument = held};
    fxs_pager_source parts = {.size = (uint64_t)(*env)->CallLongMethod(env, source, java.size), .read = read_source,
                              .cancel = cancel_source, .close = close_source, .argument = held, .gap = GAP};
    if ((*env)->ExceptionCheck(env)) {
        close_source(held);
        return FXS_ERR_FILE;
    }
    fxs_open_options_init(&options);
    options.pager = &pager;
    options.source = &parts;
    return fxs_open(name, &options, opened, why);
}

static int open_whole(JNIEnv *env, const char *name, jobject source, jobject bytes, scene *s, fxs_message *why)
{
    fxs_open_options options;
    const void *const data = (*env)->GetDirectBufferAddress(env, bytes);
    fxs_open_options_init(&options);
    options.progress = (fxs_progress){tell_progress, source};
    const int error = fxs_open_memory(name, data, (size_t)(*env)->GetDirectBufferCapacity(env, bytes), &options,
                                      &s->opened, why);
    if (!error && s->opened->data == data)
        s->bytes = (*env)->NewGlobalRef(env, bytes);
    return error;
}

/* Opens the scene of a buffer, or if that is null, in parts. */
static jlong JNICALL open_scene(JNIEnv *env, jclass class, jstring name, jobject source, jobject bytes)
{
    fxs_message why = {{0}, 0, {0}};
    const char *const text = (*env)->GetStringUTFChars(env, name, NULL);
    scene *const s = text ? calloc(1, sizeof *s) : NULL;
    int error = s ? 0 : fxs_fail_memory(&why, NULL, sizeof *s);
    (void)class;
    if (!error)
        error = bytes ? open_whole(env, text, source, bytes, s, &why) : open_parts(env, text, source, &s->opened, &why);
    if (text)
        (*env)->ReleaseStringUTFChars(env, name, text);
    if (!error)
        return (jlong)(intptr_t)s;
    free(s);
    throw_fault(env, error, &why);
    return 0;
}

static void JNICALL first_camera(JNIEnv *env, jclass class, jlong handle, jint width, jint height, jdoubleArray to)
{
    const scene *const s = (const scene *)(intptr_t)handle;
    fxs_message why;
    double numbers[FXS_NUMBERS];
    const int error = fxs_window_camera(s->opened, width, height, numbers, &why);
    (void)class;
    if (error)
        throw_fault(env, error, &why);
    else
        (*env)->SetDoubleArrayRegion(env, to, 0, FXS_NUMBERS, numbers);
}

/* ---- Views ------------------------------------------------------------------------------------------------------- */

static fxs_window_view *view_of(jlong handle)
{
    return (fxs_window_view *)(intptr_t)handle;
}

static jlong JNICALL create(JNIEnv *env, jclass class)
{
    fxs_message why;
    fxs_window_view *const view = calloc(1, sizeof *view);
    (void)class;
    if (!view)
        throw_fault(env, fxs_fail_memory(&why, NULL, sizeof *view), &why);
    else
        view->pool_bytes = FXS_WINDOW_POOL;
    return (jlong)(intptr_t)view;
}

static void JNICALL destroy(JNIEnv *env, jclass class, jlong view)
{
    (void)env, (void)class;
    fxs_window_end(view_of(view), &java.windows);
    free(view_of(view));
}

static void JNICALL take(JNIEnv *env, jclass class, jlong view, jobject surface)
{
    fxs_message why;
    int error = 0;
    void *window = NULL;
    (void)class;
    if (surface && !java.window_of)
        error = fxs_fail_as(FXS_ERR_UNSUPPORTED, &why, "no windows: there is no libandroid.so");
    else if (surface && !(window = java.window_of(env, surface)))
        error = fxs_fail_as(FXS_ERR_DEVICE, &why, "the surface has no window: it was released");
    const int taken = fxs_window_take(view_of(view), window, &java.windows, &why);
    if (error || taken)
        throw_fault(env, error ? error : taken, &why);
}

static void JNICALL set_scene(JNIEnv *env, jclass class, jlong view, jlong handle)
{
    const scene *const s = (const scene *)(intptr_t)handle;
    (void)env, (void)class;
    fxs_window_scene(view_of(view), s ? s->opened : NULL);
}

static void JNICALL pace(JNIEnv *env, jclass class, jlong view, jint frame_nanoseconds, jint budget)
{
    (void)env, (void)class;
    fxs_window_pace(view_of(view), (uint32_t)frame_nanoseconds, (uint32_t)budget);
}

/* Returns the name of the back end, or null if nothing was drawn. */
static jstring JNICALL draw(JNIEnv *env, jclass class, jlong handle, jdoubleArray camera, jintArray to)
{
    fxs_window_view *const view = view_of(handle);
    fxs_message why;
    double numbers[FXS_NUMBERS];
    (void)class;
    (*env)->GetDoubleArrayRegion(env, camera, 0, FXS_NUMBERS, numbers);
    const int error = fxs_window_draw(view, numbers, &why);
    const fxs_window_state *const now = &view->state;
    const jint state[] = {(jint)now->missing, (jint)now->coming, (jint)now->budget, now->width, now->height,
                          now->changed};
    (*env)->SetIntArrayRegion(env, to, 0, sizeof state / sizeof *state, state);
    if (error)
        throw_fault(env, error, &why);
    return error || !view->way ? NULL : (*env)->NewStringUTF(env, view->way->name(view->self));
}

/* Writes the number, depth and position of the Gaussian at a pixel. Returns false if the pixel shows none. */
static jboolean JNICALL pick(JNIEnv *env, jclass class, jlong view, jdoubleArray camera, jint x, jint y,
                             jdoubleArray to)
{
    fxs_message why;
    fxs_pick_result result;
    double numbers[FXS_NUMBERS];
    (void)class;
    (*env)->GetDoubleArrayRegion(env, camera, 0, FXS_NUMBERS, numbers);
    const int found = fxs_window_pick(view_of(view), numbers, x, y, &result, &why);
    if (found < 0)
        throw_fault(env, found, &why);
    if (found != 1)
        return JNI_FALSE;
    const double written[] = {result.gaussian, ldexp((double)result.depth_q32, -32),
                              ldexp((double)result.position_q32[0], -32), ldexp((double)result.position_q32[1], -32),
                              ldexp((double)result.position_q32[2], -32)};
    (*env)->SetDoubleArrayRegion(env, to, 0, sizeof written / sizeof *written, written);
    return JNI_TRUE;
}

static void JNICALL trim(JNIEnv *env, jclass class, jlong view)
{
    (void)env, (void)class;
    fxs_window_trim(view_of(view));
}

/* ---- Loading ----------------------------------------------------------------------------------------------------- */

#define NATIVE(name, signature, function) \
    {(char *)(intptr_t)name, (char *)(intptr_t)signature, (void *)(intptr_t)function}

static int find_classes(JNIEnv *env)
{
    const jclass fault = (*env)->FindClass(env, "org/fixsplat/FixsplatException");
    const jclass source = fault ? (*env)->FindClass(env, "org/fixsplat/Source") : NULL;
    java.fault = source ? (*env)->NewGlobalRef(env, fault) : NULL;
    return java.fault && (java.make_fault = (*env)->GetMethodID(env, fault, "<init>", "(I[B)V")) &&
           (java.size = (*env)->GetMethodID(env, source, "size", "()J")) &&
           (java.read = (*env)->GetMethodID(env, source, "tryRead",
                                            "(JLjava/nio/ByteBuffer;)Ljava/lang/String;")) &&
           (java.cancel = (*env)->GetMethodID(env, source, "cancel", "()V")) &&
           (java.arrived = (*env)->GetMethodID(env, source, "arrived", "()V")) &&
           (java.progress = (*env)->GetMethodID(env, source, "progress", "(D)Z"));
}

JNIEXPORT jint JNICALL JNI_OnLoad(JavaVM *vm, void *unused)
{
    static const JNINativeMethod methods[] = {
        NATIVE("open", "(Ljava/lang/String;Lorg/fixsplat/Source;Ljava/nio/ByteBuffer;)J", open_scene),
        NATIVE("closeScene", "(J)V", close_scene), NATIVE("firstCamera", "(JII[D)V", first_camera),
        NATIVE("create", "()J", create), NATIVE("destroy", "(J)V", destroy),
        NATIVE("take", "(JLandroid/view/Surface;)V", take), NATIVE("setScene", "(JJ)V", set_scene),
        NATIVE("pace", "(JII)V", pace), NATIVE("draw", "(J[D[I)Ljava/lang/String;", draw),
        NATIVE("pick", "(J[DII[D)Z", pick), NATIVE("trim", "(J)V", trim)};
    JNIEnv *env = NULL;
    (void)unused;
    java.vm = vm;
    if ((*vm)->GetEnv(vm, (void *)&env, JNI_VERSION_1_6) != JNI_OK || pthread_key_create(&java.attached, detach) ||
        !find_classes(env))
        return JNI_ERR;
    if (!fxs_system_function("libandroid.so", "ANativeWindow_fromSurface", &java.window_of) ||
        !fxs_system_function("libandroid.so", "ANativeWindow_getWidth", &java.windows.width) ||
        !fxs_system_function("libandroid.so", "ANativeWindow_getHeight", &java.windows.height) ||
        !fxs_system_function("libandroid.so", "ANativeWindow_release", &java.windows.release))
        java.window_of = NULL;
    const jclass class = (*env)->FindClass(env, "org/fixsplat/Fixsplat");
    return class && !(*env)->RegisterNatives(env, class, methods, sizeof methods / sizeof *methods) ? JNI_VERSION_1_6
                                                                                                   : JNI_ERR;
}
