/* Shared by the files of port/xr. */
#ifndef FXS_XR_INTERNAL_H
#define FXS_XR_INTERNAL_H

#include "xr.h"

#if defined(FXS_WITH_OPENXR) && defined(FXS_WITH_VULKAN)
#define FXS_XR_BY_VULKAN 1
#define XR_USE_GRAPHICS_API_VULKAN 1
#include <fixsplat/vulkan.h>
#endif
#if defined(FXS_WITH_OPENXR) && defined(FXS_WITH_GLES) && defined(FXS_WITH_EGL)
#define FXS_XR_BY_GLES 1
#define XR_USE_GRAPHICS_API_OPENGL_ES 1
#include <EGL/egl.h>
#endif

#ifdef FXS_WITH_OPENXR

#ifdef __ANDROID__
#define XR_USE_PLATFORM_ANDROID 1
#include <jni.h>
#elif defined(FXS_XR_BY_GLES)
#define XR_USE_PLATFORM_EGL 1
#endif
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

/* Functions of OpenXR that need an instance. */
#define FXS_XR_CALLS(_) \
    _(DestroyInstance) _(GetInstanceProperties) _(ResultToString) _(PollEvent) _(GetSystem) _(GetSystemProperties) \
    _(EnumerateEnvironmentBlendModes) _(EnumerateViewConfigurationViews) _(CreateSession) _(DestroySession) \
    _(BeginSession) _(EndSession) _(RequestExitSession) _(EnumerateReferenceSpaces) _(CreateReferenceSpace) \
    _(DestroySpace) _(LocateSpace) _(EnumerateSwapchainFormats) _(CreateSwapchain) _(DestroySwapchain) \
    _(EnumerateSwapchainImages) _(AcquireSwapchainImage) _(WaitSwapchainImage) _(ReleaseSwapchainImage) _(WaitFrame) \
    _(BeginFrame) _(EndFrame) _(LocateViews) _(StringToPath) _(CreateActionSet) _(DestroyActionSet) _(CreateAction) \
    _(SuggestInteractionProfileBindings) _(AttachSessionActionSets) _(CreateActionSpace) _(SyncActions) \
    _(GetActionStateBoolean) _(GetActionStateVector2f)

enum { FXS_XR_COLOUR, FXS_XR_DEPTH, FXS_XR_CHAINS };
enum { FXS_XR_LEFT, FXS_XR_RIGHT, FXS_XR_HANDS };
enum { FXS_XR_IMAGES = 16 };           /* most images of a swapchain */

/* Depths of the depth images, metres. */
#define FXS_XR_NEAR 0.1
#define FXS_XR_FAR 1000.0

/* A swapchain. Its images have a layer for each eye. */
typedef struct fxs_xr_chain {
    XrSwapchain handle;
    int64_t format;
    uint32_t count, image;             /* number of images; the acquired one */
} fxs_xr_chain;

/* The room in the scene: its axes (right, up, back) and origin in scene units, and the number of scene units in a
   metre. */
typedef struct fxs_xr_place {
    double axes[3][3], origin[3], units;
} fxs_xr_place;

/* How a device draws. Functions return 0 or an error, unless a comment says otherwise. */
typedef struct fxs_xr_graphics {
    const char *extensions[2];         /* of OpenXR; the second may be null */
    int64_t formats[FXS_XR_CHAINS][4]; /* formats of the images, the best first; 0 ends a list */
    XrSwapchainUsageFlags usage[FXS_XR_CHAINS];
    XrStructureType image_type;
    size_t image_size;
    int (*open)(fxs_xr *xr, fxs_message *why);         /* sets xr->device and xr->binding */
    int (*ready)(fxs_xr *xr, fxs_message *why);        /* compiles the shaders, when all of the runtime is ready */
    int (*upload)(fxs_xr *xr, const fxs_scene *scene, fxs_message *why);
    void (*forget)(fxs_xr *xr, const fxs_scene *scene);
    /* Draws both eyes to the acquired images. Adds the time of an earlier frame to xr->info, and sets *drawn to its
       Gaussians if they are known. */
    int (*draw)(fxs_xr *xr, const fxs_request *request, uint32_t *drawn, fxs_message *why);
    int delay;                         /* how many frames earlier that frame was requested, at most */
    void (*end)(fxs_xr *xr);           /* waits until the swapchains' images are not in use */
    void (*close)(fxs_xr *xr);
} fxs_xr_graphics;

extern const fxs_xr_graphics fxs_xr_vulkan, fxs_xr_gles;

typedef struct fxs_xr_hand {
    XrSpace space;
    int grips;                         /* 1: held the scene in the last frame, at `at` */
    double at[3];
} fxs_xr_hand;

struct fxs_xr {
    PFN_xrGetInstanceProcAddr find;
#define FXS_XR_MEMBER(name) PFN_xr##name name;
    struct {
        FXS_XR_CALLS(FXS_XR_MEMBER)
    } call;
    XrInstance instance;
    XrSystemId system;
    XrSession session;
    XrSpace space;
    XrEnvironmentBlendMode blend;
    fxs_xr_options options;
    fxs_xr_info info;
    char runtime[XR_MAX_RUNTIME_NAME_SIZE], name[XR_MAX_SYSTEM_NAME_SIZE];
    int running, ended, lost;          /* lost: a call said that session or instance are lost */
    int floor, gaze;                   /* 1: the runtime has XR_EXT_local_floor, XR_EXT_eye_gaze_interaction */
    int depth;                         /* 1: the runtime takes depths */

    const fxs_xr_graphics *graphics;
    void *device;
    const void *binding;
    fxs_xr_chain chains[FXS_XR_CHAINS];
    XrSwapchainImageBaseHeader *images[FXS_XR_CHAINS];

    fxs_pace pace;
    uint32_t numbers[8];               /* pace.number of the latest frames */
    uint8_t *rates[2];                 /* maps of rates, in one block */

    fxs_view start;
    int has_start, placed;
    fxs_xr_place place;
    XrActionSet actions;
    XrAction grab, grip, walk, look;
    XrPath hands[FXS_XR_HANDS];
    fxs_xr_hand hand[FXS_XR_HANDS];
    XrSpace look_space;
    int turned;                        /* 1: the thumbstick must be let go before the next turn */
    XrTime before;                     /* display time of the last frame */
};

/* Returns 0 for a successful result of the call named `call`, else an error and a message. */
int fxs_xr_check(fxs_xr *xr, XrResult result, const char *call, fxs_message *why);
#define FXS_XR_TRY(name, arguments) fxs_xr_check(xr, xr->call.name arguments, "xr" #name, why)

/* Finds a function of an extension, or fails. */
int fxs_xr_find(fxs_xr *xr, const char *name, PFN_xrVoidFunction *function, fxs_message *why);

/* ---- Controllers (xr_hands.c) ------------------------------------------------------------------------------------ */

int fxs_xr_make_actions(fxs_xr *xr, fxs_message *why);

/* Reads the controllers, and places the room in the scene for a frame at `time`. */
int fxs_xr_move(fxs_xr *xr, const XrView views[2], XrTime time, fxs_message *why);

/* Finds the direction of the eyes in the room, of length 1. Returns 0 if it is unknown. */
int fxs_xr_look(fxs_xr *xr, XrTime time, double direction[3]);

/* Makes the camera of an eye for a picture of this size. */
int fxs_xr_camera(const fxs_xr *xr, const XrView *view, int32_t width, int32_t height, fxs_camera *camera,
                  fxs_message *why);

/* Rotates a vector by a quaternion. */
void fxs_xr_turn(const XrQuaternionf *by, const double in[3], double out[3]);

#endif

#endif
