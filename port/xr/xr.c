/* Opens and closes a session of OpenXR. Loads OpenXR's loader at run time. */
#include <fixsplat/internal/message.h>

#include "xr_internal.h"

#ifdef FXS_WITH_OPENXR

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Not in the headers of OpenXR 1.0.20. */
#define LOCAL_FLOOR "XR_EXT_local_floor"
#define LOCAL_FLOOR_SPACE ((XrReferenceSpaceType)1000426000)

#ifdef __ANDROID__
static const char loader[] = "libopenxr_loader.so";
#else
static const char loader[] = "libopenxr_loader.so.1";
#endif

enum { EXTENSIONS = 6, LISTED = 512, FORMATS = 256, MODES = 8, SPACES = 16 };

/* ---- Errors ------------------------------------------------------------------------------------------------------ */

/* Returns a text for results with names that do not help a user, else null. */
static const char *hint_of(XrResult result)
{
    switch (result) {
    case XR_ERROR_FORM_FACTOR_UNAVAILABLE: return "no headset is connected";
    case XR_ERROR_RUNTIME_UNAVAILABLE: return "no OpenXR runtime is running; XR_RUNTIME_JSON names one";
    case XR_ERROR_SESSION_LOST: return "the session was lost";
    case XR_ERROR_INSTANCE_LOST: return "the runtime has ended";
    default: return 0;
    }
}

int fxs_xr_check(fxs_xr *xr, XrResult result, const char *call, fxs_message *why)
{
    char name[XR_MAX_RESULT_STRING_SIZE];
    if (XR_SUCCEEDED(result))
        return 0;
    xr->lost |= result == XR_ERROR_SESSION_LOST || result == XR_ERROR_INSTANCE_LOST;
    const char *hint = hint_of(result);
    if (!hint && (!xr->call.ResultToString || XR_FAILED(xr->call.ResultToString(xr->instance, result, name))))
        snprintf(name, sizeof name, "error %d", (int)result);
    return fxs_fail_as(FXS_ERR_DEVICE, why, "OpenXR: %s: %s", call, hint ? hint : name);
}

/* ---- Runtime ----------------------------------------------------------------------------------------------------- */

int fxs_xr_find(fxs_xr *xr, const char *name, PFN_xrVoidFunction *function, fxs_message *why)
{
    *function = 0;
    return fxs_xr_check(xr, xr->find(xr->instance, name, function), name, why);
}

/* dlsym returns a data pointer; POSIX allows its use as a function pointer. */
static int load_loader(fxs_xr *xr, fxs_message *why)
{
    void *library = dlopen(loader, RTLD_NOW | RTLD_LOCAL);
    void *address = library ? dlsym(library, "xrGetInstanceProcAddr") : 0;
    memcpy(&xr->find, &address, sizeof address);
    return address ? 0 : fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "no OpenXR: %s", dlerror());
}

static int start_loader(fxs_xr *xr, fxs_message *why)
{
#ifdef __ANDROID__
    const XrLoaderInitInfoAndroidKHR info = {XR_TYPE_LOADER_INIT_INFO_ANDROID_KHR, 0, xr->options.java,
                                             xr->options.activity};
    PFN_xrVoidFunction start;
    int error = fxs_xr_find(xr, "xrInitializeLoaderKHR", &start, why);
    return error ? error : fxs_xr_check(xr, ((PFN_xrInitializeLoaderKHR)start)((const void *)&info),
                                        "xrInitializeLoaderKHR", why);
#else
    (void)xr, (void)why;
    return 0;
#endif
}

static int list_extensions(fxs_xr *xr, XrExtensionProperties *listed, uint32_t *count, fxs_message *why)
{
    PFN_xrVoidFunction list;
    const int error = fxs_xr_find(xr, "xrEnumerateInstanceExtensionProperties", &list, why);
    for (uint32_t i = 0; i < LISTED; i++)
        listed[i] = (XrExtensionProperties){.type = XR_TYPE_EXTENSION_PROPERTIES};
    const PFN_xrEnumerateInstanceExtensionProperties call = (PFN_xrEnumerateInstanceExtensionProperties)list;
    return error ? error : fxs_xr_check(xr, call(0, LISTED, count, listed), "xrEnumerateInstanceExtensionProperties",
                                        why);
}

/* Chooses the extensions to enable. The graphics' own extensions are required. */
static int choose_extensions(fxs_xr *xr, const char **chosen, uint32_t *count, fxs_message *why)
{
    const struct {
        const char *name;
        int is_needed, *found;
    } wanted[] = {{xr->graphics->extensions[0], 1, 0}, {xr->graphics->extensions[1], 1, 0},
                  {XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME, 0, &xr->depth},
                  {XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME, 0, &xr->gaze}, {LOCAL_FLOOR, 0, &xr->floor},
#ifdef __ANDROID__
                  {XR_KHR_ANDROID_CREATE_INSTANCE_EXTENSION_NAME, 1, 0}
#endif
    };
    XrExtensionProperties *listed = malloc(LISTED * sizeof *listed);
    uint32_t there = 0;
    int error = listed ? list_extensions(xr, listed, &there, why) : fxs_fail_memory(why, 0, 0);
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted && !error; i++) {
        uint32_t k = 0;
        while (wanted[i].name && k < there && strcmp(listed[k].extensionName, wanted[i].name))
            k++;
        if (wanted[i].name && k < there)
            chosen[(*count)++] = wanted[i].name;
        else if (wanted[i].name && wanted[i].is_needed)
            error = fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "the OpenXR runtime has no %s", wanted[i].name);
        if (wanted[i].found)
            *wanted[i].found = k < there;
    }
    free(listed);
    return error;
}

static int find_calls(fxs_xr *xr, fxs_message *why)
{
    PFN_xrVoidFunction function = 0;
    int error = 0;
#define FIND(name) \
    error = error ? error : fxs_xr_find(xr, "xr" #name, &function, why); \
    xr->call.name = error ? 0 : (PFN_xr##name)function;
    FXS_XR_CALLS(FIND)
    return error;
}

static int make_instance(fxs_xr *xr, fxs_message *why)
{
    const char *extensions[EXTENSIONS];
    XrInstanceCreateInfo info = {.type = XR_TYPE_INSTANCE_CREATE_INFO, .enabledExtensionNames = extensions};
    PFN_xrVoidFunction create;
    int error = choose_extensions(xr, extensions, &info.enabledExtensionCount, why);
    error = error ? error : fxs_xr_find(xr, "xrCreateInstance", &create, why);
    if (error)
        return error;
#ifdef __ANDROID__
    const XrInstanceCreateInfoAndroidKHR android = {XR_TYPE_INSTANCE_CREATE_INFO_ANDROID_KHR, 0, xr->options.java,
                                                    xr->options.activity};
    info.next = &android;
#endif
    info.applicationInfo.apiVersion = XR_MAKE_VERSION(1, 0, 0);
    info.applicationInfo.engineVersion = FXS_VERSION_NUMBER;
    snprintf(info.applicationInfo.applicationName, XR_MAX_APPLICATION_NAME_SIZE, "%s",
             xr->options.name ? xr->options.name : "fixsplat");
    strcpy(info.applicationInfo.engineName, "fixsplat");
    error = fxs_xr_check(xr, ((PFN_xrCreateInstance)create)(&info, &xr->instance), "xrCreateInstance", why);
    return error ? error : find_calls(xr, why);
}

/* ---- Headset ----------------------------------------------------------------------------------------------------- */

static int choose_blend(fxs_xr *xr, fxs_message *why)
{
    XrEnvironmentBlendMode modes[MODES];
    uint32_t count = 0;
    const int error = FXS_XR_TRY(EnumerateEnvironmentBlendModes, (xr->instance, xr->system,
                                 XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO, MODES, &count, modes));
    if (error)
        return error;
    xr->blend = count ? modes[0] : XR_ENVIRONMENT_BLEND_MODE_OPAQUE;
    for (uint32_t i = count; i-- > 0;)
        if (modes[i] == XR_ENVIRONMENT_BLEND_MODE_OPAQUE)
            xr->blend = modes[i];
    for (uint32_t i = 0; i < count && xr->options.pass_through; i++)
        if (modes[i] == XR_ENVIRONMENT_BLEND_MODE_ALPHA_BLEND)
            xr->blend = modes[i];
    xr->info.passes_through = xr->blend == XR_ENVIRONMENT_BLEND_MODE_ALPHA_BLEND;
    return 0;
}

static int find_system(fxs_xr *xr, fxs_message *why)
{
    const XrSystemGetInfo head = {.type = XR_TYPE_SYSTEM_GET_INFO,
                                  .formFactor = XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY};
    XrInstanceProperties runtime = {.type = XR_TYPE_INSTANCE_PROPERTIES};
    XrSystemEyeGazeInteractionPropertiesEXT gaze = {.type = XR_TYPE_SYSTEM_EYE_GAZE_INTERACTION_PROPERTIES_EXT};
    XrSystemProperties properties = {.type = XR_TYPE_SYSTEM_PROPERTIES, .next = xr->gaze ? &gaze : 0};
    XrViewConfigurationView views[2] = {{.type = XR_TYPE_VIEW_CONFIGURATION_VIEW},
                                        {.type = XR_TYPE_VIEW_CONFIGURATION_VIEW}};
    uint32_t count = 0;
    int error = FXS_XR_TRY(GetInstanceProperties, (xr->instance, &runtime));
    error = error ? error : FXS_XR_TRY(GetSystem, (xr->instance, &head, &xr->system));
    error = error ? error : FXS_XR_TRY(GetSystemProperties, (xr->instance, xr->system, &properties));
    error = error ? error : FXS_XR_TRY(EnumerateViewConfigurationViews, (xr->instance, xr->system,
                                       XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO, 2, &count, views));
    if (error)
        return error;
    memcpy(xr->runtime, runtime.runtimeName, sizeof xr->runtime);
    memcpy(xr->name, properties.systemName, sizeof xr->name);
    xr->gaze = xr->gaze && gaze.supportsEyeGazeInteraction;
    for (int i = 0; i < 2; i++) {
        const int32_t width = (int32_t)views[i].recommendedImageRectWidth;
        const int32_t height = (int32_t)views[i].recommendedImageRectHeight;
        xr->info.full_width = xr->info.full_width > width ? xr->info.full_width : width;
        xr->info.full_height = xr->info.full_height > height ? xr->info.full_height : height;
    }
    if (count != 2 || xr->info.full_width < 1 || xr->info.full_height < 1 || xr->info.full_width > FXS_MAX_SIZE ||
        xr->info.full_height > FXS_MAX_SIZE)
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "the headset asks for %u pictures of %dx%d", (unsigned)count,
                           (int)xr->info.full_width, (int)xr->info.full_height);
    return choose_blend(xr, why);
}

/* ---- Session ----------------------------------------------------------------------------------------------------- */

/* A space with a floor keeps the scene's floor level and in place. */
static int make_space(fxs_xr *xr, fxs_message *why)
{
    const XrReferenceSpaceType wanted[] = {XR_REFERENCE_SPACE_TYPE_STAGE, LOCAL_FLOOR_SPACE,
                                           XR_REFERENCE_SPACE_TYPE_LOCAL};
    XrReferenceSpaceType there[SPACES];
    XrReferenceSpaceCreateInfo info = {.type = XR_TYPE_REFERENCE_SPACE_CREATE_INFO,
                                       .referenceSpaceType = XR_REFERENCE_SPACE_TYPE_LOCAL,
                                       .poseInReferenceSpace.orientation.w = 1};
    uint32_t count = 0;
    const int error = FXS_XR_TRY(EnumerateReferenceSpaces, (xr->session, SPACES, &count, there));
    for (int i = 2; i >= 0; i--)
        for (uint32_t k = 0; k < count && !error && (i != 1 || xr->floor); k++)
            if (there[k] == wanted[i])
                info.referenceSpaceType = there[k];
    return error ? error : FXS_XR_TRY(CreateReferenceSpace, (xr->session, &info, &xr->space));
}

/* Makes a swapchain in the first of the graphics' formats that the runtime has. None: no swapchain. */
static int make_chain(fxs_xr *xr, int which, fxs_message *why)
{
    fxs_xr_chain *chain = &xr->chains[which];
    XrSwapchainCreateInfo info = {.type = XR_TYPE_SWAPCHAIN_CREATE_INFO, .usageFlags = xr->graphics->usage[which],
                                  .sampleCount = 1, .width = (uint32_t)xr->info.full_width,
                                  .height = (uint32_t)xr->info.full_height, .faceCount = 1, .arraySize = 2,
                                  .mipCount = 1};
    int64_t formats[FORMATS];
    uint32_t count = 0;
    int error = FXS_XR_TRY(EnumerateSwapchainFormats, (xr->session, FORMATS, &count, formats));
    for (const int64_t *wanted = xr->graphics->formats[which]; *wanted && !error && !info.format; wanted++)
        for (uint32_t i = 0; i < count; i++)
            if (formats[i] == *wanted)
                info.format = *wanted;
    if (error || !info.format)
        return error;
    chain->format = info.format;
    error = FXS_XR_TRY(CreateSwapchain, (xr->session, &info, &chain->handle));
    error = error ? error : FXS_XR_TRY(EnumerateSwapchainImages, (chain->handle, 0, &chain->count, 0));
    if (error)
        return error;
    if (chain->count > FXS_XR_IMAGES)
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "a swapchain has %u images", (unsigned)chain->count);
    xr->images[which] = calloc(chain->count, xr->graphics->image_size);
    if (!xr->images[which])
        return fxs_fail_memory(why, 0, 0);
    for (uint32_t i = 0; i < chain->count; i++) {
        char *image = (char *)xr->images[which] + i * xr->graphics->image_size;
        ((XrSwapchainImageBaseHeader *)(void *)image)->type = xr->graphics->image_type;
    }
    return FXS_XR_TRY(EnumerateSwapchainImages, (chain->handle, chain->count, &chain->count, xr->images[which]));
}

static int make_chains(fxs_xr *xr, fxs_message *why)
{
    int error = make_chain(xr, FXS_XR_COLOUR, why);
    if (!error && !xr->chains[FXS_XR_COLOUR].handle)
        error = fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "the headset has no swapchains with 8 bits a channel");
    if (!error && xr->depth)
        error = make_chain(xr, FXS_XR_DEPTH, why);
    xr->info.has_depth = xr->chains[FXS_XR_DEPTH].handle != XR_NULL_HANDLE;
    return error;
}

static int make_session(fxs_xr *xr, fxs_message *why)
{
    XrSessionCreateInfo info = {.type = XR_TYPE_SESSION_CREATE_INFO, .systemId = xr->system};
    int error = xr->graphics->open(xr, why);
    if (error)
        return error;
    info.next = xr->binding;
    error = FXS_XR_TRY(CreateSession, (xr->instance, &info, &xr->session));
    error = error ? error : make_space(xr, why);
    error = error ? error : make_chains(xr, why);
    error = error ? error : fxs_xr_make_actions(xr, why);
    return error ? error : xr->graphics->ready(xr, why);
}

/* ---- Calls ------------------------------------------------------------------------------------------------------- */

static int set_up(fxs_xr *xr, const fxs_xr_options *options, fxs_message *why)
{
    const size_t tiles = 512 * 512;                      /* macro tiles of the largest picture */
    xr->options = *options;
    xr->has_start = options->start != 0;
    if (options->start)
        xr->start = *options->start;
    if (!(xr->options.metres_per_unit >= 0) || xr->options.metres_per_unit > 1e6)
        return fxs_fail_as(FXS_ERR_ARGUMENT, why, "%g metres per unit", xr->options.metres_per_unit);
    if (!(xr->options.metres_per_unit > 0))
        xr->options.metres_per_unit = 1;
    xr->place.units = 1 / xr->options.metres_per_unit;
    fxs_pace_init(&xr->pace);
    xr->pace.scale_least_q16 = 65536 * 35 / 100;
    xr->pace.rates_most = 2;
    xr->rates[0] = malloc(2 * tiles);
    xr->rates[1] = xr->rates[0] ? xr->rates[0] + tiles : 0;
    return xr->rates[0] ? 0 : fxs_fail_memory(why, 0, 2 * tiles);
}

static int choose_graphics(fxs_xr *xr, fxs_message *why)
{
#ifdef FXS_XR_BY_GLES
    xr->graphics = xr->options.load ? &fxs_xr_gles : 0;
#endif
#ifdef FXS_XR_BY_VULKAN
    xr->graphics = xr->options.load ? xr->graphics : &fxs_xr_vulkan;
#endif
    return xr->graphics ? 0 : fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "this build is without %s",
                                          xr->options.load ? "OpenGL ES" : "Vulkan");
}

int fxs_xr_open(fxs_xr **out, const fxs_xr_options *options, fxs_message *why)
{
    fxs_xr *xr = *out = calloc(1, sizeof *xr);
    if (!xr)
        return fxs_fail_memory(why, 0, sizeof *xr);
    int error = set_up(xr, options, why);
    error = error ? error : choose_graphics(xr, why);
    error = error ? error : load_loader(xr, why);
    error = error ? error : start_loader(xr, why);
    error = error ? error : make_instance(xr, why);
    error = error ? error : find_system(xr, why);
    error = error ? error : make_session(xr, why);
    if (error) {
        fxs_xr_close(xr);
        *out = 0;
    }
    return error;
}

/* A runtime that was lost still frees its handles. */
static void close_session(fxs_xr *xr)
{
    for (int i = 0; i < FXS_XR_HANDS; i++)
        if (xr->hand[i].space)
            xr->call.DestroySpace(xr->hand[i].space);
    if (xr->look_space)
        xr->call.DestroySpace(xr->look_space);
    if (xr->space)
        xr->call.DestroySpace(xr->space);
    for (int i = 0; i < FXS_XR_CHAINS; i++)
        if (xr->chains[i].handle)
            xr->call.DestroySwapchain(xr->chains[i].handle);
    if (xr->session)
        xr->call.DestroySession(xr->session);
    if (xr->actions)
        xr->call.DestroyActionSet(xr->actions);
}

void fxs_xr_close(fxs_xr *xr)
{
    if (!xr)
        return;
    if (xr->device)
        xr->graphics->end(xr);
    close_session(xr);
    if (xr->device)
        xr->graphics->close(xr);
    if (xr->instance && xr->call.DestroyInstance)
        xr->call.DestroyInstance(xr->instance);
    for (int i = 0; i < FXS_XR_CHAINS; i++)
        free(xr->images[i]);
    free(xr->rates[0]);
    free(xr);
}

void fxs_xr_forget(fxs_xr *xr, const fxs_scene *scene)
{
    xr->graphics->forget(xr, scene);
}

int fxs_xr_end(fxs_xr *xr, fxs_message *why)
{
    if (xr->running)
        return FXS_XR_TRY(RequestExitSession, (xr->session));
    xr->ended = 1;
    return 0;
}

fxs_pace *fxs_xr_pace(fxs_xr *xr)
{
    return &xr->pace;
}

fxs_xr_info fxs_xr_get_info(const fxs_xr *xr)
{
    fxs_xr_info info = xr->info;
    info.runtime = xr->runtime;
    info.system = xr->name;
    info.metres_per_unit = 1 / xr->place.units;
    return info;
}

#else

int fxs_xr_open(fxs_xr **out, const fxs_xr_options *options, fxs_message *why)
{
    (void)options;
    *out = 0;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "this build is without OpenXR");
}

/* Without fxs_xr_open, no other function can be called. */
void fxs_xr_close(fxs_xr *xr) { (void)xr; }

void fxs_xr_forget(fxs_xr *xr, const fxs_scene *scene) { (void)xr, (void)scene; }

int fxs_xr_end(fxs_xr *xr, fxs_message *why)
{
    (void)xr, (void)why;
    return FXS_ERR_UNSUPPORTED;
}

int fxs_xr_frame(fxs_xr *xr, const fxs_request *request, fxs_message *why)
{
    (void)xr, (void)request, (void)why;
    return FXS_ERR_UNSUPPORTED;
}

fxs_pace *fxs_xr_pace(fxs_xr *xr)
{
    (void)xr;
    return 0;
}

fxs_xr_info fxs_xr_get_info(const fxs_xr *xr)
{
    const fxs_xr_info none = {.runtime = 0};
    (void)xr;
    return none;
}

#endif
