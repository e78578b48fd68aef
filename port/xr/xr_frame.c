/* The frame loop of a session of OpenXR: events, the display's next frame, both eyes in one request, layers. */
#include <fixsplat/internal/message.h>
#include <fixsplat/rates.h>

#include "xr_internal.h"

#ifdef FXS_WITH_OPENXR

#include <math.h>
#include <time.h>

enum { IDLE_NS = 10000000, TILE = 32 };
#define IMAGE_TIMEOUT 2000000000           /* nanoseconds */

/* ---- Events ------------------------------------------------------------------------------------------------------ */

static int take_state(fxs_xr *xr, XrSessionState state, fxs_message *why)
{
    const XrSessionBeginInfo begin = {.type = XR_TYPE_SESSION_BEGIN_INFO,
                                      .primaryViewConfigurationType = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO};
    int error = 0;
    if (state == XR_SESSION_STATE_READY) {
        error = FXS_XR_TRY(BeginSession, (xr->session, &begin));
        xr->running = !error;
    } else if (state == XR_SESSION_STATE_STOPPING) {
        error = FXS_XR_TRY(EndSession, (xr->session));
        xr->running = 0;
    } else if (state == XR_SESSION_STATE_EXITING) {
        xr->ended = 1;
    } else if (state == XR_SESSION_STATE_LOSS_PENDING) {
        xr->running = 0;
        error = fxs_xr_check(xr, XR_ERROR_SESSION_LOST, "event", why);
    }
    return error;
}

static int take_event(fxs_xr *xr, const XrEventDataBuffer *event, fxs_message *why)
{
    if (event->type == XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED)
        return take_state(xr, ((const XrEventDataSessionStateChanged *)(const void *)event)->state, why);
    if (event->type == XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING)
        xr->placed = 0;                    /* the user recentred the headset */
    return event->type == XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING
               ? fxs_xr_check(xr, XR_ERROR_INSTANCE_LOST, "event", why) : 0;
}

static int take_events(fxs_xr *xr, fxs_message *why)
{
    for (;;) {
        XrEventDataBuffer event = {.type = XR_TYPE_EVENT_DATA_BUFFER};
        const XrResult result = xr->call.PollEvent(xr->instance, &event);
        int error = fxs_xr_check(xr, result, "xrPollEvent", why);
        if (error || result == XR_EVENT_UNAVAILABLE)
            return error;
        error = take_event(xr, &event, why);
        if (error)
            return error;
    }
}

/* ---- Both eyes --------------------------------------------------------------------------------------------------- */

/* Makes the map of rates for the level that the clock has chosen: full rate around the gaze, or straight ahead if the
   gaze is unknown. */
static void set_rates(fxs_xr *xr, const XrView *view, const double look[3], fxs_camera *camera, int eye,
                      fxs_image *rates)
{
    double at[3];
    const int32_t width = camera->width, height = camera->height;
    const XrQuaternionf q = view->pose.orientation, back = {-q.x, -q.y, -q.z, q.w};
    const uint32_t high = (uint32_t)height;
    int32_t x = (int32_t)(camera->cx_q12 / 4096), y = (int32_t)(camera->cy_q12 / 4096);
    *rates = (fxs_image){0};
    if (!xr->pace.rates)
        return;
    if (look) {
        fxs_xr_turn(&back, look, at);      /* the eye's own axes: x right, y up, z back */
        if (at[2] < -0.1) {
            x += (int32_t)(at[0] / -at[2] * (double)camera->fx_q12 / 4096);
            y -= (int32_t)(at[1] / -at[2] * (double)camera->fy_q12 / 4096);
        }
    }
    *rates = (fxs_image){xr->rates[eye], (width + TILE - 1) / TILE};
    fxs_rates_around(rates, width, height, x, y, xr->pace.rates == 2 ? high / 4 : high * 3 / 8,
                     xr->pace.rates == 2 ? high / 2 : 2 * FXS_MAX_SIZE);
}

static int make_request(fxs_xr *xr, const XrView views[2], XrTime time, fxs_request *request, fxs_message *why)
{
    double look[3];
    const double scale = xr->pace.scale_q16 / 65536.0;
    const int32_t width = (int32_t)fmax(1, floor(xr->info.full_width * scale));
    const int32_t height = (int32_t)fmax(1, floor(xr->info.full_height * scale));
    const int looks = xr->pace.rates && fxs_xr_look(xr, time, look);
    int error = 0;
    request->eyes = 2;
    if (xr->pace.budget_most)
        request->options.budget = xr->pace.budget;
    for (int eye = 0; eye < 2 && !error; eye++) {
        fxs_targets_init(&request->targets[eye]);
        error = fxs_xr_camera(xr, &views[eye], width, height, &request->cameras[eye], why);
        if (!error)
            set_rates(xr, &views[eye], looks ? look : 0, &request->cameras[eye], eye, &request->targets[eye].rates);
    }
    xr->info.follows_gaze = looks;
    return error;
}

static void step_pace(fxs_xr *xr, uint32_t drawn)
{
    const uint64_t frame = xr->info.frames, delay = (uint64_t)xr->graphics->delay;
    xr->numbers[frame % 8] = xr->pace.number;
    if (frame >= delay)
        fxs_pace_step(&xr->pace, xr->info.nanoseconds, drawn, xr->numbers[(frame - delay) % 8]);
    xr->info.frames++;
}

/* Acquires an image of each swapchain. *count gets the number of images that can be released. */
static int acquire(fxs_xr *xr, int *count, fxs_message *why)
{
    const XrSwapchainImageWaitInfo wait = {.type = XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO, .timeout = IMAGE_TIMEOUT};
    for (*count = 0; *count < FXS_XR_CHAINS && xr->chains[*count].handle; ++*count) {
        fxs_xr_chain *chain = &xr->chains[*count];
        int error = FXS_XR_TRY(AcquireSwapchainImage, (chain->handle, 0, &chain->image));
        if (error)
            return error;
        const XrResult result = xr->call.WaitSwapchainImage(chain->handle, &wait);
        error = fxs_xr_check(xr, result, "xrWaitSwapchainImage", why);
        if (!error && result == XR_TIMEOUT_EXPIRED)
            error = fxs_fail_as(FXS_ERR_DEVICE, why, "OpenXR: xrWaitSwapchainImage: no image for 2 seconds");
        if (error)
            return error;
    }
    return 0;
}

/* Draws to the swapchains' images, and releases them in any case. Reports the first error. */
static int draw(fxs_xr *xr, const fxs_request *request, fxs_message *why)
{
    fxs_message own;
    uint32_t drawn = 0;
    int count;
    int error = acquire(xr, &count, why);
    if (!error)
        error = xr->graphics->draw(xr, request, &drawn, why);
    for (int i = 0; i < count && !xr->lost; i++) {
        const int released = fxs_xr_check(xr, xr->call.ReleaseSwapchainImage(xr->chains[i].handle, 0),
                                          "xrReleaseSwapchainImage", &own);
        if (released && !error) {
            error = released;
            *why = own;
        }
    }
    if (error)
        return error;
    xr->info.cameras[0] = request->cameras[0];
    xr->info.cameras[1] = request->cameras[1];
    step_pace(xr, drawn);
    return 0;
}

/* ---- A frame ----------------------------------------------------------------------------------------------------- */

typedef struct layers {
    XrCompositionLayerProjection layer;
    XrCompositionLayerProjectionView views[2];
    XrCompositionLayerDepthInfoKHR depths[2];
} layers;

static void fill_layers(const fxs_xr *xr, const XrView views[2], const fxs_request *request, layers *l)
{
    const XrRect2Di drawn = {{0, 0}, {request->cameras[0].width, request->cameras[0].height}};
    l->layer = (XrCompositionLayerProjection){
        .type = XR_TYPE_COMPOSITION_LAYER_PROJECTION, .space = xr->space, .viewCount = 2, .views = l->views,
        .layerFlags = xr->info.passes_through ? XR_COMPOSITION_LAYER_BLEND_TEXTURE_SOURCE_ALPHA_BIT : 0};
    for (uint32_t eye = 0; eye < 2; eye++) {
        l->depths[eye] = (XrCompositionLayerDepthInfoKHR){
            .type = XR_TYPE_COMPOSITION_LAYER_DEPTH_INFO_KHR,
            .subImage = {xr->chains[FXS_XR_DEPTH].handle, drawn, eye}, .maxDepth = 1, .nearZ = (float)FXS_XR_NEAR,
            .farZ = (float)FXS_XR_FAR};
        l->views[eye] = (XrCompositionLayerProjectionView){
            .type = XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW, .next = xr->info.has_depth ? &l->depths[eye] : 0,
            .pose = views[eye].pose, .fov = views[eye].fov,
            .subImage = {xr->chains[FXS_XR_COLOUR].handle, drawn, eye}};
    }
}

/* Finds the eyes at the time when the frame is shown. Returns 1, 0 without a valid pose, or an error. */
static int locate(fxs_xr *xr, XrTime time, XrView views[2], fxs_message *why)
{
    const XrViewLocateInfo info = {.type = XR_TYPE_VIEW_LOCATE_INFO, .displayTime = time, .space = xr->space,
                                   .viewConfigurationType = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO};
    const XrViewStateFlags needed = XR_VIEW_STATE_ORIENTATION_VALID_BIT | XR_VIEW_STATE_POSITION_VALID_BIT;
    XrViewState state = {.type = XR_TYPE_VIEW_STATE};
    uint32_t count = 0;
    views[0] = views[1] = (XrView){.type = XR_TYPE_VIEW};
    const int error = FXS_XR_TRY(LocateViews, (xr->session, &info, &state, 2, &count, views));
    return error ? error : count == 2 && (state.viewStateFlags & needed) == needed;
}

/* Draws a frame that has begun. Returns 1 and the layers, 0 for a frame without layers, or an error. */
static int draw_frame(fxs_xr *xr, const fxs_request *request, const XrFrameState *frame, layers *l, fxs_message *why)
{
    XrView views[2];
    fxs_request own = *request;
    const int located = frame->shouldRender ? locate(xr, frame->predictedDisplayTime, views, why) : 0;
    if (located <= 0)
        return located;
    int error = fxs_xr_move(xr, views, frame->predictedDisplayTime, why);
    error = error ? error : make_request(xr, views, frame->predictedDisplayTime, &own, why);
    error = error ? error : draw(xr, &own, why);
    if (error)
        return error;
    fill_layers(xr, views, &own, l);
    return 1;
}

static void take_rate(fxs_xr *xr, const XrFrameState *frame)
{
    const XrDuration period = frame->predictedDisplayPeriod;
    if (period < 100000 || period > 1000000000)
        return;
    xr->pace.frame_nanoseconds = (uint32_t)period;
    xr->info.refresh = 1e9 / (double)period;
    if (!xr->info.frames && !xr->pace.number)
        fxs_pace_step(&xr->pace, 0, 0, 0);
}

static int show_frame(fxs_xr *xr, const fxs_request *request, fxs_message *why)
{
    layers l;
    const XrCompositionLayerBaseHeader *shown = (const XrCompositionLayerBaseHeader *)(const void *)&l.layer;
    XrFrameState frame = {.type = XR_TYPE_FRAME_STATE};
    XrFrameEndInfo end = {.type = XR_TYPE_FRAME_END_INFO, .environmentBlendMode = xr->blend, .layers = &shown};
    fxs_message of_end;
    int error = FXS_XR_TRY(WaitFrame, (xr->session, 0, &frame));
    error = error ? error : FXS_XR_TRY(BeginFrame, (xr->session, 0));
    if (error)
        return error;
    take_rate(xr, &frame);
    const int drawn = draw_frame(xr, request, &frame, &l, why);
    end.displayTime = frame.predictedDisplayTime;
    end.layerCount = drawn > 0;
    if (xr->lost)
        return drawn;
    error = fxs_xr_check(xr, xr->call.EndFrame(xr->session, &end), "xrEndFrame", &of_end);
    if (drawn >= 0 && error)
        *why = of_end;
    return drawn < 0 ? drawn : error ? error : drawn ? FXS_XR_DRAWN : FXS_XR_IDLE;
}

int fxs_xr_frame(fxs_xr *xr, const fxs_request *request, fxs_message *why)
{
    const struct timespec pause = {0, IDLE_NS};
    int error = xr->lost ? fxs_xr_check(xr, XR_ERROR_SESSION_LOST, "xrWaitFrame", why) : take_events(xr, why);
    if (error || xr->ended)
        return error ? error : FXS_XR_ENDED;
    if (!xr->running) {
        nanosleep(&pause, 0);
        return FXS_XR_IDLE;
    }
    for (uint32_t i = 0; i < request->count && !error; i++)
        error = xr->graphics->upload(xr, request->objects[i].scene, why);
    return error ? error : show_frame(xr, request, why);
}

#endif
