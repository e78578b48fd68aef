/* Shows a scene in a headset through OpenXR 1.0, by Vulkan or by OpenGL ES. OpenXR's loader is loaded at run time. This
   header includes no header of OpenXR or Vulkan. docs/openxr.md has an example.

   Functions return 0 or more, or an FXS_ERR_* and a message in `why`, which must not be null. FXS_ERR_UNSUPPORTED: the
   build or the runtime lacks something. FXS_ERR_DEVICE: a call of OpenXR failed, or the session was lost. The program
   goes on: it calls fxs_xr_close, and may open a new session later. All calls come from one thread. */
#ifndef FXS_XR_H
#define FXS_XR_H

#include <fixsplat/camera.h>
#include <fixsplat/gl.h>
#include <fixsplat/pace.h>

typedef struct fxs_xr fxs_xr;

/* Options of a session. A field of 0 stands for its default. */
typedef struct fxs_xr_options {
    const char *name;                  /* name of the program, shown by some runtimes; null: "fixsplat" */
    fxs_gl_load_fn *load;              /* null: draws by Vulkan, on a device of its own. Else draws by OpenGL ES 3.1, in
                                          the EGL context that is current now and in each call. The context's state is
                                          not preserved */
    void *argument;                    /* first argument of `load` */
    double metres_per_unit;            /* size of a scene unit; 0: 1 */
    const fxs_view *start;             /* the head starts at this camera, with a level floor; null: the scene's origin
                                          lies at the room's origin, y down. Used during fxs_xr_open only */
    double up[3];                      /* up direction of the scene, for `start` */
    int pass_through;                  /* 1: shows the room behind the scene, if the headset can */
    uint64_t max_memory;               /* limit of device memory, bytes; 0: no limit */
    void *java, *activity;             /* Android: JavaVM and the jobject of the activity */
} fxs_xr_options;

/* Opens a session: the runtime, a headset, swapchains, controllers. fxs_xr_close frees *out, which is null after an
   error. */
int fxs_xr_open(fxs_xr **out, const fxs_xr_options *options, fxs_message *why);

/* Ends and frees a session; null is allowed. With OpenGL ES, the context must be current, or none if it was lost. */
void fxs_xr_close(fxs_xr *xr);

enum fxs_xr_step {
    FXS_XR_ENDED,                      /* the session has ended: call fxs_xr_close */
    FXS_XR_IDLE,                       /* nothing was drawn: the headset is not worn or not tracked. If the runtime asks
                                          for no frames, the call takes 10 ms */
    FXS_XR_DRAWN
};

/* Handles the runtime's events, waits for the display's next frame and draws it. The request has objects and options;
   its eyes, cameras and targets are ignored. A scene that is not on the device is uploaded first. If the clock chooses
   a budget, it replaces options.budget. Returns an enum fxs_xr_step or an error, also of fxs_vulkan_submit or
   fxs_compute_draw. */
int fxs_xr_frame(fxs_xr *xr, const fxs_request *request, fxs_message *why);

/* Drops the device's copy of a scene. Call it before the scene is closed or its bytes change. */
void fxs_xr_forget(fxs_xr *xr, const fxs_scene *scene);

/* Asks the runtime to end the session. Later calls of fxs_xr_frame return FXS_XR_ENDED, usually after some frames. */
int fxs_xr_end(fxs_xr *xr, fxs_message *why);

/* The clock, which fxs_xr_frame steps with the display's rate. Its choices set the part of the swapchain's images that
   is drawn, the rates of the periphery, and the budget. The program may change its limits. The default: 0.35 to 1 of
   the size, all levels of rates, no budget. */
fxs_pace *fxs_xr_pace(fxs_xr *xr);

typedef struct fxs_xr_info {
    const char *runtime, *system, *device;     /* names of the runtime, the headset and the GPU; valid as long as the
                                                  session */
    int32_t full_width, full_height;   /* size of an eye's picture at full scale, pixels */
    int passes_through;                /* 1: the room shows behind the scene */
    int has_depth;                     /* 1: the runtime gets depths */
    int follows_gaze;                  /* 1: the full rate follows the eyes */
    double metres_per_unit;            /* changes if the user scales the scene */
    uint64_t frames;                   /* number of drawn frames */
    uint64_t nanoseconds;              /* device time of a recent frame; 0: unknown */
    double refresh;                    /* frames per second of the display; 0: unknown yet */
    fxs_camera cameras[2];             /* cameras of the last drawn frame, left and right */
} fxs_xr_info;

fxs_xr_info fxs_xr_get_info(const fxs_xr *xr);

#endif
