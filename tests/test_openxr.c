/* Shows a scene in a simulated headset (xr_runtime.c), by Vulkan on lavapipe and by OpenGL ES on llvmpipe: pictures and
   depths against the processor, controllers, the clock, calls that fail, a session that is lost. Prints the processor
   time of a frame and the course of the clock. */
#include "check.h"

#if !defined(FXS_WITH_OPENXR) || !defined(FXS_WITH_VULKAN) || !defined(FXS_WITH_GLES) || !defined(FXS_WITH_EGL)
static void openxr(void)
{
    SKIP("built without the headers of OpenXR, Vulkan or OpenGL ES");
}

int main(void)
{
    RUN(openxr);
    return check_report();
}
#else

#include <dlfcn.h>
#include <math.h>
#include <string.h>
#include <time.h>

#include <fixsplat/internal/gl_contexts.h>
#include <fixsplat/rates.h>
#include <fixsplat/renderer.h>
#include "packed_scene.h"
#include "procedural_scene.h"
#include "port/xr/xr.h"
#include "xr_runtime.h"

enum { MOST = 512, FRAMES = 1000 };
static const char *const variables[] = {"FAIL", "RESULT", "EVER", "FRAMES", "BLIND", "EVENT", "SIZE", "HERTZ", "STILL",
                                        "HANDS", "LACKS", "LOG"};

static xr_runtime_fn *seen;
static fxs_message why;
static fxs_packed_scene packed;
static fxs_scene scene;
static fxs_object object;
static fxs_request request;
static fxs_renderer *processor;
static uint8_t colours[2][MOST * MOST * 4];
static uint32_t depths[2][MOST * MOST];
static void *egl;                          /* null: sessions draw by Vulkan */

/* ---- A session --------------------------------------------------------------------------------------------------- */

static void set(const char *name, const char *value)
{
    char variable[32];
    snprintf(variable, sizeof variable, "FXS_XR_%s", name);
    if (value)
        setenv(variable, value, 1);
    else
        unsetenv(variable);
}

static void set_nothing(void)
{
    for (size_t i = 0; i < sizeof variables / sizeof *variables; i++)
        set(variables[i], 0);
}

static int open_with(fxs_xr **xr, fxs_xr_options options)
{
    options.load = egl ? fxs_egl_load : 0;
    options.argument = egl;
    return fxs_xr_open(xr, &options, &why);
}

static fxs_xr *open_session(void)
{
    fxs_xr *xr;
    return CHECK(!open_with(&xr, (fxs_xr_options){.name = "test"})) ? xr : (puts(why.text), (fxs_xr *)0);
}

/* Goes on until a frame is drawn. Returns the result of its last call. */
static int next_frame(fxs_xr *xr)
{
    int step = FXS_XR_IDLE;
    for (int i = 0; i < 30 && step == FXS_XR_IDLE; i++)
        step = fxs_xr_frame(xr, &request, &why);
    return step;
}

static int draw_frames(fxs_xr *xr, int count)
{
    int step = FXS_XR_DRAWN;
    for (int i = 0; i < count && step == FXS_XR_DRAWN; i++)
        step = next_frame(xr);
    return step;
}

static void keep_full(fxs_xr *xr)
{
    fxs_xr_pace(xr)->scale_least_q16 = 65536;
    fxs_xr_pace(xr)->rates_most = 0;
}

/* Ends a session as a user does who presses Ctrl-C. */
static void end_session(fxs_xr *xr)
{
    int step = CHECK(!fxs_xr_end(xr, &why)) ? FXS_XR_IDLE : FXS_XR_ENDED;
    for (int i = 0; i < 20 && step > FXS_XR_ENDED; i++)
        step = fxs_xr_frame(xr, &request, &why);
    CHECK(step == FXS_XR_ENDED);
    fxs_xr_close(xr);
}

/* ---- Pictures against the processor ------------------------------------------------------------------------------ */

static const uint32_t *row_of(int which, int eye, int y)
{
    const xr_runtime_seen *s = seen();
    const int row = egl ? s->height - 1 - y : y;
    return (const uint32_t *)s->pixels[which][eye] + (size_t)row * (size_t)s->full_width;
}

/* Draws the eyes of the last frame on the processor. */
static int draw_there(const fxs_xr *xr, const fxs_image rates[2], enum fxs_format format, int deep)
{
    const fxs_xr_info info = fxs_xr_get_info(xr);
    fxs_request wanted = request;
    wanted.eyes = 2;
    for (int eye = 0; eye < 2; eye++) {
        wanted.cameras[eye] = info.cameras[eye];
        wanted.targets[eye].format = format;
        wanted.targets[eye].colour = (fxs_image){colours[eye], 4 * info.cameras[0].width};
        if (deep)
            wanted.targets[eye].median_depth = (fxs_image){depths[eye], 4 * info.cameras[0].width};
        wanted.targets[eye].rates = rates ? rates[eye] : (fxs_image){0};
    }
    return CHECK(!fxs_renderer_render(processor, &wanted, 0, &why));
}

static int are_same(void)
{
    const xr_runtime_seen *s = seen();
    for (int eye = 0; eye < 2; eye++)
        for (int y = 0; y < s->height; y++)
            if (!s->pixels[XR_RUNTIME_COLOUR][eye] ||
                memcmp(row_of(XR_RUNTIME_COLOUR, eye, y), colours[eye] + (size_t)(y * s->width) * 4,
                       (size_t)s->width * 4))
                return printf("  frame %llu, eye %d, row %d differs\n", (unsigned long long)s->frames, eye, y), 0;
    return 1;
}

/* Depths of both eyes, from 0 at 0.1 m to 1 at 1000 m. */
static int are_deep(double units)
{
    const xr_runtime_seen *s = seen();
    const double near = 1 / (0.1 * units), far = 1 / (1000 * units);
    for (int eye = 0; eye < 2; eye++)
        for (int i = 0; i < s->width * s->height; i++) {
            float is;
            const uint32_t depth = depths[eye][i];
            const double over = depth == FXS_NOTHING ? far : 65536.0 / depth, wanted = (over - near) / (far - near);
            memcpy(&is, row_of(XR_RUNTIME_DEPTH, eye, i / s->width) + i % s->width, sizeof is);
            if (!(fabs(is - wanted) < 1e-5))
                return printf("  eye %d, pixel %d: depth %.9g, not %.9g\n", eye, i, is, wanted), 0;
        }
    return 1;
}

static double processor_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void thousand_frames(void)
{
    int same = 1;
    double seconds = 0;
    set_nothing();
    fxs_xr *xr = open_session();
    if (!xr)
        return;
    keep_full(xr);
    for (int i = 0; i < FRAMES && same; i++) {
        const double start = processor_seconds();
        same = CHECK(next_frame(xr) == FXS_XR_DRAWN);
        seconds += processor_seconds() - start;
        same = same && draw_there(xr, 0, FXS_FORMAT_RGBA8, i % 100 == 0) && CHECK(are_same());
        same = same && (i % 100 || CHECK(are_deep(1)));
    }
    const fxs_xr_info info = fxs_xr_get_info(xr);
    CHECK(info.has_depth && !info.passes_through && info.frames == FRAMES);
    CHECK(seen()->shown == FRAMES && info.full_width == 48 && info.full_height == 56);
    CHECK(fabs(info.refresh - 72) < 1e-3);
    printf("  %d frames on %s, hash %016llx, %.3f ms of this thread a frame\n", FRAMES, info.device,
           (unsigned long long)seen()->hash, seconds * 1000 / FRAMES);
    end_session(xr);
}

static fxs_image rates_of(const fxs_camera *camera, uint8_t *map, uint32_t near, uint32_t far)
{
    fxs_image rates = {map, (camera->width + 31) / 32};
    fxs_rates_around(&rates, camera->width, camera->height, (int32_t)(camera->cx_q12 / 4096),
                     (int32_t)(camera->cy_q12 / 4096), near, far);
    return rates;
}

/* The clock's choices: a part of the images, and rates around the point where the eyes look, here straight ahead. */
static void scale_and_rates(void)
{
    uint8_t maps[2][64];
    set_nothing();
    set("SIZE", "200x160");
    fxs_xr *xr = open_session();
    if (!xr)
        return;
    for (uint32_t level = 1; level <= 2; level++) {
        fxs_xr_pace(xr)->scale_q16 = fxs_xr_pace(xr)->scale_least_q16 = 49152;
        fxs_xr_pace(xr)->rates = fxs_xr_pace(xr)->rates_most = level;
        CHECK(next_frame(xr) == FXS_XR_DRAWN);
        const fxs_xr_info info = fxs_xr_get_info(xr);
        fxs_image rates[2];
        for (int eye = 0; eye < 2; eye++)
            rates[eye] = rates_of(&info.cameras[eye], maps[eye], level == 2 ? 30 : 45, level == 2 ? 60 : 100000);
        CHECK(seen()->width == 150 && seen()->height == 120 && info.follows_gaze);
        CHECK(draw_there(xr, rates, FXS_FORMAT_RGBA8, 1) && are_same() && are_deep(1));
        CHECK(draw_there(xr, 0, FXS_FORMAT_RGBA8, 0));
        CHECK(memcmp(maps[0], "\1\1\1\1\1", 5));           /* some rates are not 1 */
    }
    end_session(xr);
}

static void pass_through(void)
{
    fxs_xr *xr;
    for (int offered = 1; offered >= 0; offered--) {
        set_nothing();
        set("LACKS", offered ? 0 : "alpha");
        if (!CHECK(!open_with(&xr, (fxs_xr_options){.pass_through = 1})))
            return;
        keep_full(xr);
        CHECK(next_frame(xr) == FXS_XR_DRAWN);
        CHECK(fxs_xr_get_info(xr).passes_through == offered && seen()->blends == offered);
        CHECK(draw_there(xr, 0, offered ? FXS_FORMAT_RGBA8_COVERAGE : FXS_FORMAT_RGBA8, 0) && are_same());
        end_session(xr);
    }
}

static void without_depth(void)
{
    static const char *const lacks[] = {"depth", "d32"};
    for (int i = 0; i < 2; i++) {
        set_nothing();
        set("LACKS", lacks[i]);
        fxs_xr *xr = open_session();
        if (!xr)
            return;
        keep_full(xr);
        CHECK(next_frame(xr) == FXS_XR_DRAWN && !fxs_xr_get_info(xr).has_depth);
        CHECK(!seen()->pixels[XR_RUNTIME_DEPTH][0] && draw_there(xr, 0, FXS_FORMAT_RGBA8, 0) && are_same());
        end_session(xr);
    }
}

/* ---- Place of the room ------------------------------------------------------------------------------------------- */

static void position_of(const fxs_camera *camera, double at[3])
{
    for (int i = 0; i < 3; i++)
        at[i] = ldexp((double)camera->position_q32[i], -32);
}

static double between(const double a[3], const double b[3])
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/* The eyes are 63 mm apart, in units of the scene. */
static void true_scale(void)
{
    static const double metres[] = {1, 0.01, 25};
    double left[3], right[3];
    fxs_xr *xr;
    for (int i = 0; i < 3; i++) {
        set_nothing();
        if (!CHECK(!open_with(&xr, (fxs_xr_options){.metres_per_unit = metres[i]})))
            return;
        CHECK(next_frame(xr) == FXS_XR_DRAWN);
        const fxs_xr_info info = fxs_xr_get_info(xr);
        position_of(&info.cameras[0], left);
        position_of(&info.cameras[1], right);
        CHECK(fabs(between(left, right) * metres[i] - 0.063) < 1e-6 && fabs(info.metres_per_unit - metres[i]) < 1e-9);
        CHECK(fabs(left[1] * metres[i] + 0.4) < 1e-6);     /* the head is 0.4 m above the origin, y down */
        CHECK(fabs(ldexp((double)info.cameras[0].near_q32, -32) * metres[i] - 0.1) < 1e-6);
        end_session(xr);
    }
    CHECK(open_with(&xr, (fxs_xr_options){.metres_per_unit = -1}) == FXS_ERR_ARGUMENT && !xr);
}

/* The head starts at the start camera and looks in its direction, with a level floor. */
static void start_view(void)
{
    static const double up[3] = {0, 0, 1};
    const fxs_picture size = {.fov = 60, .width = 64, .height = 64};
    fxs_view start;
    fxs_xr *xr;
    double left[3], right[3];
    set_nothing();
    set("STILL", "1");
    CHECK(!fxs_view_look_at(&start, (double[3]){3, -5, 2}, (double[3]){3, 7, 1}, up, &size, &why));
    if (!CHECK(!open_with(&xr, (fxs_xr_options){.start = &start, .up = {0, 0, 1}, .metres_per_unit = 0.5})))
        return;
    CHECK(next_frame(xr) == FXS_XR_DRAWN);
    const fxs_camera *camera = fxs_xr_get_info(xr).cameras;
    position_of(&camera[0], left);
    position_of(&camera[1], right);
    CHECK(fabs(left[0] - 3 + 0.063) < 1e-6 && fabs(right[0] - 3 - 0.063) < 1e-6);
    CHECK(fabs(left[1] + 5) < 1e-6 && fabs(left[2] - 2) < 1e-6);
    CHECK(camera[0].rotation_q30[5] == -(1 << 30) && camera[0].rotation_q30[7] == 1 << 30);    /* down, forward */
    end_session(xr);
}

/* Motion of the cameras after gestures in frames 10 to 19. */
static void hands(void)
{
    static const char *const names[] = {"pull", "stretch", "turn", "walk", "step"};
    for (int i = 0; i < 5; i++) {
        double before[3], after[3], change[3];
        set_nothing();
        set("HANDS", names[i]);
        set("STILL", "1");
        fxs_xr *xr = open_session();
        if (!xr)
            return;
        CHECK(draw_frames(xr, 2) == FXS_XR_DRAWN);
        const fxs_camera first = fxs_xr_get_info(xr).cameras[0];
        CHECK(draw_frames(xr, 30) == FXS_XR_DRAWN);
        const fxs_xr_info info = fxs_xr_get_info(xr);
        const fxs_camera last = info.cameras[0];
        position_of(&first, before);
        position_of(&last, after);
        for (int k = 0; k < 3; k++)
            change[k] = after[k] - before[k];
        const double turned = asin(ldexp((double)last.rotation_q30[2], -30));
        printf("  %s: %.4f %.4f %.4f, turned by %.4f, %.4f m a unit\n", names[i], change[0], change[1], change[2],
               turned, info.metres_per_unit);
        if (i == 0)                        /* the scene follows the hand to the right, so the eyes go to the left */
            CHECK(fabs(change[0] + 0.2) < 1e-5 && fabs(change[1]) < 1e-6 && fabs(turned) < 1e-6);
        if (i == 1)                        /* hands twice as far apart: the scene is twice as large */
            CHECK(fabs(info.metres_per_unit - 2) < 1e-5 && fabs(turned) < 1e-6);
        if (i == 2)                        /* the hands turn the scene to the left, so the eyes turn to the right */
            CHECK(fabs(turned + 1) < 1e-4 && fabs(info.metres_per_unit - 1) < 1e-5);
        if (i == 3)                        /* 10 frames of 1/72 s, 1.5 m a second */
            CHECK(fabs(change[2] - 1.5 * 10 / 72) < 1e-4 && fabs(change[0]) < 1e-6);
        if (i == 4)                        /* one step of 30 degrees to the right */
            CHECK(fabs(turned + 3.14159265 / 6) < 1e-5);
        end_session(xr);
    }
}

/* ---- Faults ------------------------------------------------------------------------------------------------------ */

static int is_one_line(void)
{
    return *why.text && !strchr(why.text, '\n');
}

/* Each call of OpenXR fails once. The library returns an error with one line, and the runtime finds all calls after it
   in order and all objects destroyed. */
static void failing_calls(void)
{
    static const char *const calls[] = {
        "xrCreateInstance", "xrGetInstanceProperties", "xrGetSystem", "xrGetSystemProperties",
        "xrEnumerateViewConfigurationViews", "xrEnumerateEnvironmentBlendModes",
        "xrGetVulkanGraphicsRequirements2KHR", "xrCreateVulkanInstanceKHR", "xrGetVulkanGraphicsDevice2KHR",
        "xrCreateVulkanDeviceKHR", "xrGetOpenGLESGraphicsRequirementsKHR", "xrCreateSession",
        "xrEnumerateReferenceSpaces", "xrCreateReferenceSpace", "xrEnumerateSwapchainFormats",
        "xrEnumerateSwapchainFormats:2", "xrCreateSwapchain", "xrCreateSwapchain:2", "xrEnumerateSwapchainImages",
        "xrEnumerateSwapchainImages:2", "xrEnumerateSwapchainImages:4", "xrStringToPath", "xrStringToPath:7",
        "xrCreateActionSet", "xrCreateAction", "xrCreateAction:4", "xrSuggestInteractionProfileBindings",
        "xrSuggestInteractionProfileBindings:3", "xrAttachSessionActionSets", "xrCreateActionSpace",
        "xrCreateActionSpace:3", "xrPollEvent", "xrBeginSession", "xrWaitFrame", "xrWaitFrame:6", "xrBeginFrame:6",
        "xrLocateViews:3", "xrSyncActions:3", "xrGetActionStateBoolean:2", "xrGetActionStateVector2f",
        "xrAcquireSwapchainImage:3", "xrAcquireSwapchainImage:4", "xrWaitSwapchainImage:3", "xrWaitSwapchainImage:4",
        "xrReleaseSwapchainImage:3", "xrReleaseSwapchainImage:4", "xrEndFrame:6", "xrEndSession"};
    int answered = 0;
    for (size_t i = 0; i < sizeof calls / sizeof *calls; i++) {
        fxs_xr *xr;
        char call[64];
        if (strstr(calls[i], egl ? "Vulkan" : "OpenGLES"))
            continue;
        set_nothing();
        set("FAIL", calls[i]);
        why.text[0] = 0;
        int step = open_with(&xr, (fxs_xr_options){0});
        CHECK(!step == !!xr);
        for (int k = 0; k < 40 && step >= 0; k++) {
            if (k == 30)
                step = fxs_xr_end(xr, &why);
            step = step ? step : 0;
            step = step < 0 ? step : fxs_xr_frame(xr, &request, &why);
        }
        snprintf(call, sizeof call, "%.*s", (int)strcspn(calls[i], ":"), calls[i]);
        if (CHECK(step == FXS_ERR_DEVICE && is_one_line() && strstr(why.text, call)))
            answered++;
        else
            printf("  %s: %d, %s\n", calls[i], step, why.text);
        fxs_xr_close(xr);
    }
    printf("  %d failing calls answered; the last: %s\n", answered, why.text);
    CHECK(answered >= 30);
}

/* The headset vanishes in mid-frame. The program goes on, and opens a new session. */
static void lost_session(void)
{
    static const char *const calls[] = {"xrWaitFrame:7", "xrBeginFrame:7", "xrLocateViews:4", "xrSyncActions:4",
                                        "xrAcquireSwapchainImage:5", "xrWaitSwapchainImage:6",
                                        "xrReleaseSwapchainImage:5", "xrEndFrame:7"};
    static const char *const results[] = {"-17", "-13"};   /* XR_ERROR_SESSION_LOST, XR_ERROR_INSTANCE_LOST */
    for (size_t i = 0; i < sizeof calls / sizeof *calls; i++) {
        set_nothing();
        set("FAIL", calls[i]);
        set("RESULT", results[i % 2]);
        set("EVER", "1");
        fxs_xr *xr = open_session();
        if (!xr)
            return;
        CHECK(draw_frames(xr, 20) == FXS_ERR_DEVICE && is_one_line());
        CHECK(strstr(why.text, i % 2 ? "the runtime has ended" : "the session was lost"));
        CHECK(fxs_xr_frame(xr, &request, &why) == FXS_ERR_DEVICE);
        fxs_xr_close(xr);
    }
    set_nothing();
    fxs_xr *xr = open_session();
    if (xr) {
        CHECK(next_frame(xr) == FXS_XR_DRAWN);
        end_session(xr);
    }
}

static void events(void)
{
    static const char *const losses[] = {"loss:9", "instance:9"};
    double before[3], after[3];
    fxs_xr *xr;
    for (int i = 0; i < 2; i++) {
        set_nothing();
        set("EVENT", losses[i]);
        if (!(xr = open_session()))
            return;
        CHECK(draw_frames(xr, 20) == FXS_ERR_DEVICE && is_one_line());
        fxs_xr_close(xr);
    }
    set("EVENT", "recentre:25");           /* undoes the change of the hands */
    set("HANDS", "stretch");
    set("STILL", "1");
    if (!(xr = open_session()))
        return;
    CHECK(draw_frames(xr, 1) == FXS_XR_DRAWN);
    position_of(fxs_xr_get_info(xr).cameras, before);
    CHECK(draw_frames(xr, 18) == FXS_XR_DRAWN);
    position_of(fxs_xr_get_info(xr).cameras, after);
    CHECK(between(before, after) > 0.1);
    CHECK(draw_frames(xr, 10) == FXS_XR_DRAWN);
    position_of(fxs_xr_get_info(xr).cameras, after);
    CHECK(between(before, after) < 1e-9 && fxs_xr_get_info(xr).metres_per_unit == 1);
    end_session(xr);
    set_nothing();
    set("FRAMES", "12");                   /* the user takes the headset off */
    if (!(xr = open_session()))
        return;
    int step = FXS_XR_IDLE;
    for (int i = 0; i < 60 && step > FXS_XR_ENDED; i++)
        step = fxs_xr_frame(xr, &request, &why);
    CHECK(step == FXS_XR_ENDED && seen()->frames <= 13);
    fxs_xr_close(xr);
    if ((xr = open_session()) != 0) {      /* ends before the runtime asks for frames */
        CHECK(!fxs_xr_end(xr, &why) && fxs_xr_frame(xr, &request, &why) == FXS_XR_ENDED);
        fxs_xr_close(xr);
    }
}

/* Frames without an orientation have no layers. */
static void blind(void)
{
    set_nothing();
    set("BLIND", "10");
    fxs_xr *xr = open_session();
    if (!xr)
        return;
    for (int i = 0; i < 30; i++)
        CHECK(fxs_xr_frame(xr, &request, &why) > FXS_XR_ENDED);
    CHECK(seen()->frames - seen()->shown == 9 && seen()->shown > 10);     /* 4 before the session is visible, 5 blind */
    end_session(xr);
}

static void bad_requests(void)
{
    fxs_request none = request;
    fxs_scene damaged = scene;
    fxs_object bad = object;
    set_nothing();
    fxs_xr *xr = open_session();
    if (!xr)
        return;
    CHECK(next_frame(xr) == FXS_XR_DRAWN);
    none.options.sh_degree = 9;
    CHECK(fxs_xr_frame(xr, &none, &why) < 0 && is_one_line());
    none = request;
    bad.scene = &damaged;
    bad.scale_q32 = -1;
    none.objects = &bad;
    CHECK(fxs_xr_frame(xr, &none, &why) < 0 && is_one_line());
    none.count = 0;
    if (!CHECK(fxs_xr_frame(xr, &none, &why) == FXS_XR_DRAWN))           /* an empty room */
        puts(why.text);
    keep_full(xr);
    CHECK(next_frame(xr) == FXS_XR_DRAWN && draw_there(xr, 0, FXS_FORMAT_RGBA8, 0) && are_same());
    fxs_xr_forget(xr, &damaged);
    fxs_xr_forget(xr, &scene);
    CHECK(next_frame(xr) == FXS_XR_DRAWN && draw_there(xr, 0, FXS_FORMAT_RGBA8, 0) && are_same());
    end_session(xr);
}

/* ---- Clock ------------------------------------------------------------------------------------------------------- */

/* Returns the device's milliseconds for a frame of a part of the size, the median of some. */
static double milliseconds(fxs_xr *xr, uint32_t scale_q16)
{
    enum { SKIPPED = 4, TIMED = 9 };
    double times[TIMED];
    keep_full(xr);
    fxs_xr_pace(xr)->scale_q16 = fxs_xr_pace(xr)->scale_least_q16 = scale_q16;
    for (int i = -SKIPPED; i < TIMED && CHECK(next_frame(xr) == FXS_XR_DRAWN); i++) {
        const double time = (double)fxs_xr_get_info(xr).nanoseconds / 1e6;
        int k = i < 0 ? 0 : i;
        for (; k > 0 && times[k - 1] > time; k--)
            times[k] = times[k - 1];
        times[k] = time;
    }
    return times[TIMED / 2];
}

/* The course of the clock: in the last frames, its changes, and its changes of direction. */
typedef struct course {
    uint32_t number, scale_q16, rates;
    int changes, turns, direction, late;
} course;

static void follow(course *c, const fxs_pace *pace, int counts)
{
    const int up = pace->scale_q16 > c->scale_q16 || (pace->scale_q16 == c->scale_q16 && pace->rates < c->rates);
    const int direction = up ? 1 : -1;
    c->changes += counts;
    c->turns += counts && c->direction && direction != c->direction;
    c->direction = direction;
    c->number = pace->number;
    c->scale_q16 = pace->scale_q16;
    c->rates = pace->rates;
}

/* A device too slow for the whole picture at the display's rate: 72 frames a second, or 18 to 71 on a busy machine,
   which takes more than 3 times that long. The clock settles on a choice and keeps it. */
static int settles(void)
{
    enum { STEPS = 300, LAST = 100 };
    course c = {.scale_q16 = 65536};
    char rate[16];
    set_nothing();
    set("SIZE", "256x256");
    fxs_xr *xr = open_session();
    if (!xr)
        return 0;
    const double whole = milliseconds(xr, 65536);
    end_session(xr);
    snprintf(rate, sizeof rate, "%d", whole * 72 < 3000 ? 72 : whole * 18 > 3000 ? 18 : (int)(3000 / whole));
    set("HERTZ", rate);
    set("SIZE", whole * 72 < 1500 ? "512x512" : "256x256");
    if (!(xr = open_session()))
        return 0;
    fxs_xr_pace(xr)->scale_least_q16 = 8192;
    printf("  a whole frame of 256x256 takes %.1f ms; the display shows %s a second\n", whole, rate);
    for (int i = 0; i < STEPS && CHECK(next_frame(xr) == FXS_XR_DRAWN); i++) {
        const fxs_pace *pace = fxs_xr_pace(xr);
        const double milliseconds_taken = (double)fxs_xr_get_info(xr).nanoseconds / 1e6;
        c.late += i >= STEPS - LAST && milliseconds_taken > pace->frame_nanoseconds / 1e6;
        if (pace->number == c.number && i < STEPS - 1)
            continue;
        printf("  frame %3d: %.3f of the size, rates %u, %.1f ms: %s\n", i, pace->scale_q16 / 65536.0, pace->rates,
               milliseconds_taken, fxs_pace_why(pace->reason));
        if (pace->number != c.number)
            follow(&c, pace, i >= STEPS - LAST);
    }
    printf("  last %d frames: %d changes, %d turns, %d late\n", LAST, c.changes, c.turns, c.late);
    const int is_settled = c.number > 0 && c.scale_q16 < 65536 && c.turns <= 1 && c.changes <= 4 &&
                           (c.late <= LAST / 4 || fxs_xr_pace(xr)->reason == FXS_PACE_LEAST);
    end_session(xr);
    return is_settled;
}

/* Other programs of the machine may slow a run down while the clock settles; so it has three runs. */
static void clock_settles(void)
{
    CHECK(settles() || settles() || settles());
}

/* ---- Main -------------------------------------------------------------------------------------------------------- */

/* Loads the runtime from the folder of the test program. */
static int find_runtime(const char *program)
{
    char path[4096], json[sizeof path];
    const char *slash = strrchr(program, '/');
    const int length = slash ? (int)(slash - program) : 1;
    snprintf(path, sizeof path, "%.*s/xr/libxr_runtime.so", length, slash ? program : ".");
    snprintf(json, sizeof json, "%.*s/xr/runtime.json", length, slash ? program : ".");
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL), *address = library ? dlsym(library, "xr_runtime") : 0;
    memcpy(&seen, &address, sizeof seen);
    setenv("XR_RUNTIME_JSON", json, 1);
    setenv("XR_LOADER_DEBUG", "none", 1);
    return CHECK(address != 0);
}

static int make_scene(void)
{
    if (procedural_scene_make("knot", 300, 0, &packed, 0, &why) || fxs_scene_open(&scene, packed.data, packed.bytes) ||
        fxs_renderer_create("cpu", 0, &processor, &why))
        return CHECK(0);
    fxs_object_init(&object, &scene);
    object.scale_q32 = (int64_t)1 << 30;
    fxs_request_init(&request, &object, 1);
    return 1;
}

static void no_runtime(void)
{
    fxs_xr *xr;
    char *json = strdup(getenv("XR_RUNTIME_JSON"));
    set_nothing();
    setenv("XR_RUNTIME_JSON", "/nowhere.json", 1);
    CHECK(open_with(&xr, (fxs_xr_options){0}) == FXS_ERR_DEVICE && !xr && is_one_line());
    setenv("XR_RUNTIME_JSON", json, 1);
    set("LACKS", "vulkan");
    CHECK(open_with(&xr, (fxs_xr_options){0}) == FXS_ERR_UNSUPPORTED && !xr && strstr(why.text, "vulkan_enable2"));
    free(json);
    fxs_xr_close(0);
}

static void run_all(const char *by)
{
    static const struct {
        const char *name;
        void (*test)(void);
    } tests[] = {{"1,000 frames", thousand_frames}, {"scale and rates", scale_and_rates},
                 {"pass-through", pass_through}, {"without depth", without_depth}, {"true scale", true_scale},
                 {"start view", start_view}, {"hands", hands}, {"calls that fail", failing_calls},
                 {"a lost session", lost_session}, {"events", events}, {"without orientation", blind},
                 {"bad requests", bad_requests}};
    char name[64];
    for (size_t i = 0; i < sizeof tests / sizeof *tests; i++) {
        snprintf(name, sizeof name, "%s: %s", by, tests[i].name);
        RUN_AS(name, tests[i].test());
    }
}

int main(int argc, char **argv)
{
    if (!argc || !find_runtime(argv[0]) || !make_scene())
        return check_failed = 1, check_report();
    run_all("Vulkan");
    RUN(clock_settles);
    if (!fxs_egl_open(&egl, &why)) {
        run_all("OpenGL ES");
        fxs_egl_close(egl);
        egl = 0;
    }
    RUN(no_runtime);                       /* last, as the loader keeps the runtime's extensions */
    fxs_renderer_destroy(processor);
    fxs_packed_scene_free(&packed);
    return check_report();
}

#endif
