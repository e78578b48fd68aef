/* `fixsplat view --xr`: shows scenes in a headset through OpenXR. */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/gl_contexts.h>
#include <fixsplat/system.h>
#include "port/xr/xr.h"
#include "src/base/os_calls.h"
#include "cmd_view.h"
#include "views.h"

enum { BUDGET_LEAST = 4096 };

typedef struct headset {
    world world;
    fxs_xr *xr;
    void *egl;
} headset;

/* Opens the context for --backend gles-compute. Otherwise Vulkan draws. */
static int open_context(headset *h, const frame_options *o, fxs_xr_options *xr)
{
    if (strcmp(o->backend, "gles-compute"))
        return 0;
#if defined(FXS_WITH_GLES) && defined(FXS_WITH_EGL)
    fxs_message why;
    if (fxs_egl_open(&h->egl, &why))
        return fail(EXIT_FAILED, "--backend gles-compute: %s", why.text);
    xr->load = fxs_egl_load;
    xr->argument = h->egl;
    return 0;
#else
    (void)h, (void)xr;
    return fail(EXIT_FAILED, "--backend gles-compute: this build is without OpenGL ES");
#endif
}

static int open_headset(headset *h, const view_options *o, const fxs_view *start, const double up[3])
{
    fxs_xr_options options = {.name = "fixsplat view", .start = start, .metres_per_unit = o->metres_per_unit,
                              .pass_through = o->pass_through, .max_memory = o->frame.max_memory};
    fxs_message why;
    memcpy(options.up, up, sizeof options.up);
    if (open_context(h, &o->frame, &options))
        return EXIT_FAILED;
    if (!getenv("XR_LOADER_DEBUG"))
        fxs_program_set("XR_LOADER_DEBUG", "none");     /* the loader's own lines: the message has the reason */
    if (fxs_xr_open(&h->xr, &options, &why))
        return fail(EXIT_FAILED, "--xr: %s", why.text);
    const fxs_xr_info info = fxs_xr_get_info(h->xr);
    if (o->pass_through && !info.passes_through)
        note("--pass-through: this headset does not show the room");
    note("%s on %s: %dx%d pixels an eye, drawn by %s; Ctrl-C ends", info.system, info.runtime, (int)info.full_width,
         (int)info.full_height, info.device);
    return 0;
}

/* Lets the clock choose the budget of scenes with levels of detail. */
static void set_limits(const headset *h, const frame_options *o)
{
    fxs_pace *pace = fxs_xr_pace(h->xr);
    for (uint32_t i = 0; i < h->world.count; i++)
        if (h->world.objects[i].scene->nodes)
            pace->budget_most = o->render.budget ? o->render.budget : h->world.gaussians;
    pace->budget_least = pace->budget_most < BUDGET_LEAST ? pace->budget_most : BUDGET_LEAST;
    if (o->render.cutoff == FXS_CUTOFF_SQUARE)
        pace->rates_most = 0;
}

static int show_frames(headset *h, const frame_options *o)
{
    const int paged = world_is_paged(&h->world);
    fxs_pager_state state;
    fxs_request request;
    fxs_message why;
    const uint64_t start = fxs_clock(0);
    int step = FXS_XR_IDLE, asked = 0;
    fxs_request_init(&request, h->world.objects, h->world.count);
    request.options = o->render;
    if (paged)
        request.options.want = (fxs_want){world_want, &h->world};
    while (step > FXS_XR_ENDED) {
        if (fxs_end_asked() && !asked++ && (step = fxs_xr_end(h->xr, &why)) < 0)
            break;
        request.options.time_q32 = o->render.time_q32 + seconds_q32((double)(fxs_clock(0) - start) * 1e-9);
        step = paged ? world_turn(&h->world, &state, &why) : 0;
        step = step ? step : fxs_xr_frame(h->xr, &request, &why);
    }
    if (step)
        return fail(EXIT_FAILED, "--xr: %s", why.text);
    note("%" PRIu64 " frames were shown", fxs_xr_get_info(h->xr).frames);
    return world_check(&h->world);
}

static int show(headset *h, const view_options *o, const fxs_view *start, const double up[3])
{
    int status = open_headset(h, o, start, up);
    if (!status) {
        set_limits(h, &o->frame);
        fxs_end_listen();
        status = show_frames(h, &o->frame);
        fxs_end_listen_no_more();
    }
    fxs_xr_close(h->xr);
#if defined(FXS_WITH_GLES) && defined(FXS_WITH_EGL)
    fxs_egl_close(h->egl);
#endif
    return status;
}

int view_in_headset(const view_options *o)
{
    headset h = {.xr = 0};
    frame_options all = o->frame;
    fxs_view *views = 0;
    all.view = "all";
    int status = world_open(&h.world, &o->frame.world, &o->frame.load);
    if (status)
        return status;
    const long count = choose_views(&all, &h.world, &views, 0);
    const long index = count < 0 ? -1 : find_view(&o->frame, views, count);
    double up[3];
    if (o->frame.up.given || !world_up(&h.world, up))
        memcpy(up, all.up.at, sizeof up);
    status = index < 0 ? EXIT_FAILED : show(&h, o, &views[index], up);
    free(views);
    world_close(&h.world);
    return status;
}
