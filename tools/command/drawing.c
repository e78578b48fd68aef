/* Renders views for the subcommands: opens a back end, sets up cameras and targets for one or two eyes, and picks
   Gaussians at a pixel. For scenes partly in memory, loads missing chunks (256 Gaussians each) and draws again. */
#include "drawing.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/backend.h>
#include <fixsplat/rates.h>
#include <fixsplat/internal/fixed.h>

enum { WAIT_NS = 100000000, TRIES = 6 };

void picture_free(picture *p)
{
    free(p->pixels);
    free(p->depths);
    free(p->ids);
    memset(p, 0, sizeof *p);
}

/* Replaces the back end that auto chose by the processor. */
static int take_cpu(renderer *r, fxs_message *why)
{
    if (r->self)
        r->backend->close(r->self);
    r->self = NULL;
    r->is_auto = 0;
    r->how.device = 0;
    r->backend = fxs_backend_find("cpu");
    return r->backend->open(&r->self, &r->how, why);
}

int renderer_open(renderer *r, const frame_options *options)
{
    fxs_backend_options how = {0};
    fxs_message why;
    memset(r, 0, sizeof *r);
    r->stereo = options->stereo;
    r->mirrored = options->has_tangents;
    r->max_memory = options->max_memory;
    r->gazes = options->gazes;
    memcpy(r->gaze, options->gaze, sizeof r->gaze);
    int devices[DEVICES_MOST];
    choose_devices(options, devices);
    int status = choose_backend(options, devices[0], &r->backend, &how);
    const int is_cpu = !status && !strcmp(r->backend->name, "cpu");
    int error = status ? 0 : r->backend->open(&r->self, &how, &why);
    r->is_auto = options->is_auto && !is_cpu;
    r->how = how;
    if (error && r->is_auto)
        error = take_cpu(r, &why);
    if (error)
        status = fail(EXIT_FAILED, "--backend %s: %s", options->backend, why.text);
    return status;
}

static int may_page(const renderer *r)
{
    return r->backend && (r->backend->can & FXS_CAN_PART);
}

int renderer_pages(const renderer *r)
{
    return may_page(r) && strcmp(r->backend->name, "cuda");
}

void renderer_close(renderer *r)
{
    if (r->self)
        r->backend->close(r->self);
    r->self = 0;
    free(r->rates);
    r->rates = 0;
    r->rate_room = 0;
}

void renderer_forget(renderer *r, const world *w)
{
    for (uint32_t i = 0; i < w->placed.file_count && r->self; i++)
        r->backend->forget(r->self, w->scenes[i].opened->scene);
}

static int grow(void **memory, size_t *room, size_t bytes)
{
    if (bytes <= *room)
        return 1;
    free(*memory);
    *memory = malloc(bytes);
    *room = *memory ? bytes : 0;
    return *memory != 0;
}

static int make_room(const renderer *r, picture *out, int width, int height)
{
    const size_t pixels = (size_t)width * (size_t)height;
    const int depths = r->draws & (DRAW_MEAN_DEPTH | DRAW_MEDIAN_DEPTH), ids = r->draws & DRAW_IDS;
    void *memory[3] = {out->pixels, out->depths, out->ids};
    const int enough = grow(&memory[0], &out->pixel_room, pixels * 4) &&
                       (!depths || grow(&memory[1], &out->depth_room, pixels * sizeof *out->depths)) &&
                       (!ids || grow(&memory[2], &out->id_room, pixels * sizeof *out->ids));
    out->pixels = memory[0];
    out->depths = memory[1];
    out->ids = memory[2];
    out->width = width;
    out->height = height;
    return enough ? 0 : fail(EXIT_FAILED, "out of memory: a picture of %dx%d", width, height);
}

/* Makes the map of rates for the gaze, for one eye. */
static int look_at(renderer *r, const fxs_camera *camera, fxs_image *rates)
{
    const int width = camera->width, height = camera->height;
    const size_t columns = ((size_t)width + 31) / 32, rows = ((size_t)height + 31) / 32;
    void *memory = r->rates;
    const int enough = grow(&memory, &r->rate_room, columns * rows);
    r->rates = memory;
    *rates = (fxs_image){memory, (ptrdiff_t)columns};
    if (!enough)
        return fail(EXIT_FAILED, "out of memory: rates of %dx%d", width, height);
    const uint32_t near = (uint32_t)(r->gazes == 4 ? r->gaze[2] : height / 4);
    fxs_rates_around(rates, width, height, r->gaze[0], r->gaze[1], near,
                     (uint32_t)(r->gazes == 4 ? r->gaze[3] : height / 2));
    return 0;
}

/* Returns the number of fraction bits with which all depths of the world fit into 32 bits. */
static int choose_depth_bits(const world *w, const fxs_view *view)
{
    double farthest = 1;
    int exponent;
    for (int corner = 0; corner < 8; corner++) {
        double depth = 0;
        for (int i = 0; i < 3; i++)
            depth += view->rotation[6 + i] * ((corner >> i & 1 ? w->high[i] : w->low[i]) - view->position[i]);
        farthest = depth > farthest ? depth : farthest;
    }
    frexp(2 * farthest, &exponent);
    return exponent < 4 ? 28 : exponent < 31 ? 32 - exponent : 1;
}

static void aim(const renderer *r, const picture *out, int eye, fxs_targets *targets)
{
    const ptrdiff_t width = out->width, first = eye ? width / 2 : 0;
    const fxs_image depths = {r->draws & (DRAW_MEAN_DEPTH | DRAW_MEDIAN_DEPTH) ? out->depths + first : 0, 4 * width};
    fxs_targets_init(targets);
    targets->format = r->format;
    targets->depth_bits = out->depth_bits;
    targets->colour = (fxs_image){out->pixels + 4 * first, 4 * width};
    if (r->draws & DRAW_MEAN_DEPTH)
        targets->mean_depth = depths;
    if (r->draws & DRAW_MEDIAN_DEPTH)
        targets->median_depth = depths;
    if (r->draws & DRAW_IDS)
        targets->id = (fxs_image){out->ids + first, (ptrdiff_t)sizeof *out->ids * width};
}

static void cut(fxs_camera *camera, const int scissor[4])
{
    camera->whole_width = camera->width;
    camera->whole_height = camera->height;
    camera->whole_x = scissor[0];
    camera->whole_y = scissor[1];
    camera->width = scissor[2];
    camera->height = scissor[3];
}

/* Moves the camera by `offset` units along its right axis. `mirrored` flips its field of view left to right. */
static int camera_beside(fxs_camera *camera, const fxs_view *view, double offset, int mirrored)
{
    fxs_message message;
    fxs_view beside = *view;
    for (int i = 0; i < 3; i++)
        beside.position[i] += offset * view->rotation[i];
    if (mirrored)
        beside.cx = view->width - view->cx;
    return fxs_camera_from_view(camera, &beside, &message) ? fail_for(&message) : 0;
}

int renderer_camera(const renderer *r, const fxs_view *view, fxs_camera *camera)
{
    const int *s = r->scissor;
    if (r->has_scissor && (s[2] > view->width - s[0] || s[3] > view->height - s[1]))
        return fail(EXIT_FAILED, "--scissor %d,%d,%d,%d: view %s is %dx%d", s[0], s[1], s[2], s[3], view->name,
                    view->width, view->height);
    fxs_view part = *view;
    part.cx -= s[0];
    part.cy -= s[1];
    if (camera_beside(camera, &part, -r->stereo / 2, 0))
        return EXIT_FAILED;
    if (r->has_scissor)
        cut(camera, s);
    return 0;
}

static int fail_frame(const renderer *r, const fxs_view *view, int error, const fxs_message *why)
{
    char needed[64];
    if (error == FXS_ERR_STOPPED)
        return EXIT_FAILED;
    if (error == FXS_ERR_MEMORY && why->bytes_needed && r->max_memory)
        return fail(EXIT_FAILED, "view %s: a frame of %dx%d does not fit in --max-memory %zu%s", view->name,
                    view->width, view->height, r->max_memory, needed_bytes(needed, why));
    return fail(EXIT_FAILED, "view %s: %s", view->name, why->text);
}

static int is_stopped(const fxs_options *options)
{
    return options->stop.call && options->stop.call(options->stop.argument);
}

/* Loads all chunks (256 Gaussians each) that the last frame lacked. *came gets the number of loaded chunks. */
static int read_wanted(const world *w, const fxs_options *options, uint32_t *came, fxs_message *why)
{
    char label[] = "reading";
    fxs_pager_state state;
    int error;
    *came = 0;
    do {
        error = world_turn(w, &state, why);
        *came += state.arrived;
        while (!error && !world_wait(w, WAIT_NS)) {
            progress_bar(label, *came / ((double)*came + state.coming + 1));
            if (is_stopped(options)) {
                error = FXS_ERR_STOPPED;
                break;
            }
        }
    } while (!error && (state.arrived || (state.coming && !state.no_room)));
    progress_end();
    return error;
}

/* Counts the chunks (256 Gaussians each) that a frame needs, and those of them that are not in memory. */
typedef struct wanting {
    const world *w;
    const fxs_options *options;
    uint32_t needed, missing;
} wanting;

static void want(void *argument, const fxs_scene *scene, uint32_t chunk, int there)
{
    wanting *g = argument;
    world_want((void *)(uintptr_t)g->w, scene, chunk, there);
    g->needed++;
    FXS_SHARED_WRITE(g->missing, FXS_SHARED_READ(g->missing) + !there);
}

/* Stops a frame that needs a chunk (256 Gaussians) that is not in memory, since its pixels would be discarded. */
static int stop(void *argument)
{
    const wanting *g = argument;
    return FXS_SHARED_READ(g->missing) || is_stopped(g->options);
}

/* Renders scenes that are only partly in memory. If r->shows_part is 0, loads missing chunks (256 Gaussians each) and
   renders again. Fails after TRIES attempts without progress. */
static int draw_in_part(renderer *r, const world *w, const fxs_request *request, fxs_stats *stats, fxs_message *why)
{
    wanting g = {.w = w, .options = &request->options};
    fxs_request asking = *request;
    if (!may_page(r))
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, why, "--backend %s copies whole scenes: no --pool", r->backend->name);
    uint32_t least = UINT32_MAX, missing = 0, came;
    asking.options.want.call = want;
    asking.options.want.argument = &g;
    if (!r->shows_part) {
        asking.options.stop.call = stop;
        asking.options.stop.argument = &g;
    }
    for (int tries = 0; tries < TRIES; tries++) {
        fxs_pager_state state;
        world_turn(w, &state, why);
        g.needed = g.missing = 0;
        int error = r->backend->render(r->self, &asking, stats, why);
        missing = error ? g.missing : stats->missing;  /* the latter with chunks that are not on the device yet */
        if (!error && (missing == 0 || r->shows_part))
            r->lost = world_turn(w, &state, &r->why_lost) != 0 && g.missing;
        if (missing == 0 || r->shows_part || (error && error != FXS_ERR_STOPPED))
            return error;
        tries = g.needed + g.missing < least ? 0 : tries;
        least = g.needed + g.missing < least ? g.needed + g.missing : least;
        error = read_wanted(w, &request->options, &came, why);
        if (error)
            return error;
    }
    return fxs_fail_as(FXS_ERR_MEMORY, why, "the pool has no room for %" PRIu32 " chunks that the picture takes: give "
                       "a larger %s, or a smaller --budget", missing, g.missing ? "--pool" : "--max-memory");
}

static int draw(renderer *r, const world *w, const fxs_request *request, fxs_stats *stats, fxs_message *why)
{
    return world_is_paged(w) ? draw_in_part(r, w, request, stats, why)
                             : r->backend->render(r->self, request, stats, why);
}

int renderer_render(renderer *r, const world *w, const fxs_view *view, const fxs_options *options, picture *out,
                    fxs_stats *stats)
{
    const int eyes = r->stereo > 0 ? 2 : 1;
    fxs_request request;
    fxs_message why;
    fxs_stats own;
    stats = stats ? stats : &own;
    fxs_request_init(&request, w->objects, w->count);
    request.options = *options;
    request.eyes = (uint32_t)eyes;
    if (renderer_camera(r, view, &request.cameras[0]) ||
        camera_beside(&request.cameras[1], view, r->stereo / 2, r->mirrored) ||
        make_room(r, out, eyes * request.cameras->width, request.cameras->height))
        return EXIT_FAILED;
    out->depth_bits = choose_depth_bits(w, view);
    for (int eye = 0; eye < eyes; eye++) {
        aim(r, out, eye, &request.targets[eye]);
        if (r->gazes && look_at(r, request.cameras, &request.targets[eye].rates))
            return EXIT_FAILED;
    }
    int error = draw(r, w, &request, stats, &why);
    if (r->is_auto && (error == FXS_ERR_DEVICE || error == FXS_ERR_MEMORY || error == FXS_ERR_UNSUPPORTED)) {
        error = take_cpu(r, &why);
        error = error ? error : draw(r, w, &request, stats, &why);
    }
    return error ? fail_frame(r, view, error, &why) : world_check(w);
}

static int pick_elsewhere(const fxs_request *request, int x, int y, fxs_pick_result *result, fxs_message *why)
{
    static const fxs_backend_options how = {.size = sizeof(fxs_backend_options)};
    const fxs_backend *cpu = fxs_backend_find("cpu");
    void *self;
    int found = cpu->open(&self, &how, why);
    found = found ? found : cpu->pick(self, request, x, y, result, why);
    cpu->close(self);
    return found;
}

int renderer_pick(renderer *r, const world *w, const fxs_view *view, const fxs_options *options, int x, int y,
                  fxs_pick_result *result)
{
    fxs_request request;
    fxs_message why;
    fxs_request_init(&request, w->objects, w->count);
    request.options = *options;
    if (camera_beside(request.cameras, view, 0, 0))
        return -1;
    const int found = r->backend->pick ? r->backend->pick(r->self, &request, x, y, result, &why)
                                       : pick_elsewhere(&request, x, y, result, &why);
    return found < 0 ? fail(-1, "--pick: %s", why.text) : world_check(w) ? -1 : found;
}
