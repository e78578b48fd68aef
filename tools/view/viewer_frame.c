/* Jobs of the renderer's thread, such as frames, picks and screenshots. Each ask function queues a job. `work` runs
   on the renderer's thread, `done` on the window's thread. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/backend.h>
#include <fixsplat/image.h>
#include <fixsplat/system.h>
#include "port/window/motion.h"
#include "src/base/os_calls.h"
#include "tools/command/cmd_convert.h"
#include <fixsplat/scene.h>

#include "viewer.h"

int eyes_of(const viewer *v)
{
    return v->options.stereo > 0 ? 2 : 1;
}

static fxs_view fit(const viewer *v, fxs_view view, int width, int height)
{
    fxs_message message;
    if (width != view.width || height != view.height)
        fxs_motion_fit(&view, width, height);
    if (v->options.has_tangents)
        fxs_view_set_tangents(&view, v->options.tangents, &message);
    return view;
}

static fxs_view fit_view(const viewer *v, int divisor)
{
    int width, height;
    fxs_window_size(v->window, &width, &height);
    width /= eyes_of(v);
    width = width > divisor ? width / divisor : 1;
    height = height > divisor ? height / divisor : 1;
    return fit(v, v->view, width, height);
}

/* Queues a request for the renderer's thread. Returns null if the queue is full. */
request *ask(viewer *v, void (*work)(viewer *, request *), void (*done)(viewer *, request *), int divisor)
{
    if (v->request_count == REQUESTS_MOST)
        return 0;
    request *r = &v->requests[v->request_count++];
    memset(r, 0, sizeof *r);
    r->work = work;
    r->done = done;
    r->render = v->options.render;
    r->shown = v->shown;
    r->crop = v->crop;
    r->divisor = divisor;
    if (v->path)
        r->view = fit_view(v, divisor);
    return r;
}

static void work_at_first(void *argument)
{
    viewer *v = argument;
    v->requests[0].work(v, &v->requests[0]);
}

void viewer_collect(viewer *v)
{
    if (v->given && !fxs_worker_busy(v->drawer)) {
        request done = v->requests[0];
        memmove(v->requests, v->requests + 1, (size_t)--v->request_count * sizeof done);
        v->given = 0;
        done.done(v, &done);
    }
    if (!v->given && v->request_count) {
        v->given = 1;
        fxs_worker_do(v->drawer, work_at_first, v);
    }
}

void tell(viewer *v, const char *text)
{
    snprintf(v->note, sizeof v->note, "%.255s", text);
    v->exposed = 1;
}

/* Opens the screen for frames of Vulkan. Without one, Vulkan's pictures are copied to the window. */
static void open_screen(viewer *v)
{
    fxs_backend_options how;
    fxs_screen *screen = 0;
    fxs_message why;
    int devices[DEVICES_MOST];
    const fxs_backend *backend;
    choose_devices(&v->opened, devices);
    if (!v->vulkan || strcmp(v->renderer.backend->name, "vulkan") ||
        choose_backend(&v->opened, devices[0], &backend, &how))
        return;
    if (fxs_screen_open(&screen, v->window, &how, &why))
        fail(0, "--backend vulkan: pictures are copied to the window: %s", why.text);
    v->screen_renderer = v->renderer;
    v->screen_renderer.backend = &fxs_screen_backend;
    v->screen_renderer.self = screen;
    v->screen_renderer.rates = 0;
    v->screen_renderer.rate_room = 0;
}

static void open_renderer(viewer *v, request *r)
{
    r->status = renderer_open(&v->renderer, &v->opened);
    if (!r->status)
        open_screen(v);
}

static void end_without(viewer *v, request *r)
{
    if (r->status) {
        v->quit = 1;
        v->status = r->status;
    }
}

static void take_renderer(viewer *v, request *r)
{
    v->screen = v->screen_renderer.self;
    end_without(v, r);
}

void ask_open(viewer *v)
{
    v->opened = v->options;
    ask(v, open_renderer, take_renderer, 1);
}

static void open_next(viewer *v, request *r)
{
    int now = 0, count = 0;
    (void)r;
    v->opened.is_auto = 0;
    renderer_close(&v->screen_renderer);
    while (fxs_backend_at(count))
        count++;
    while (fxs_backend_at(now) != v->renderer.backend)
        now++;
    for (int i = 1; i <= count; i++) {
        renderer other;
        v->opened.backend = fxs_backend_at((now + i) % count)->name;
        if (!renderer_open(&other, &v->opened)) {
            renderer_close(&v->renderer);
            v->renderer = other;
            open_screen(v);
            return;
        }
    }
}

static void take_backend(viewer *v, request *r)
{
    (void)r;
    v->screen = v->screen_renderer.self;
    v->options.backend = v->renderer.backend->name;
    v->options.is_auto = 0;
    v->changed = 1;
}

void ask_backend(viewer *v)
{
    if (ask(v, open_next, take_backend, 1))
        v->screen = 0;
}

static void take_next(viewer *v, request *r)
{
    char text[64];
    take_backend(v, r);
    snprintf(text, sizeof text, "Vulkan failed; %s draws", v->options.backend);
    tell(v, text);
}

void lose_screen(viewer *v)
{
    v->screen = 0;
    v->screen_lost = !ask(v, open_next, take_next, 1);
}

void forget_scenes(viewer *v)
{
    renderer_forget(&v->renderer, &v->world);
    renderer_forget(&v->screen_renderer, &v->world);
}

static void forget(viewer *v, request *r)
{
    (void)r;
    forget_scenes(v);
}

static void install(viewer *v, request *r)
{
    (void)r;
    viewer_install(v);
}

int ask_install(viewer *v)
{
    return ask(v, forget, install, 1) != 0;
}

static void crop_objects(viewer *v, const crop_box *crop)
{
    if (crop->on || v->cropped)
        crop_world(&v->world, crop);
    v->cropped = crop->on;
}

/* Draws into the screen's memory, if nothing is to be drawn over the pixels. */
static int draws_on_screen(const viewer *v, const request *r)
{
    return v->screen_renderer.self && r->shows_part && r->shown == SHOW_COLOUR &&
           !(v->edit.copy && v->edit.editor.chosen);
}

static void render(viewer *v, request *r)
{
    static const int draws[] = {[SHOW_DEPTH] = DRAW_MEDIAN_DEPTH, [SHOW_IDS] = DRAW_IDS};
    const picture *p = &v->drawn;
    r->on_screen = draws_on_screen(v, r);
    renderer *by = r->on_screen ? &v->screen_renderer : &v->renderer;
    crop_objects(v, &r->crop);
    by->shows_part = r->shows_part;
    by->draws = draws[r->shown];
    r->status = renderer_render(by, &v->world, &r->view, &r->render, &v->drawn, &r->stats);
    const fxs_canvas out = {p->pixels, p->width, p->height};
    if (!r->status && r->shown == SHOW_DEPTH)
        fxs_paint_depths(&out, p->depths);
    else if (!r->status && r->shown == SHOW_IDS)
        fxs_paint_ids(&out, p->ids);
    if (!r->status && r->shows_part)
        edit_mark(v, r, p);
}

static void take_frame(viewer *v, request *r)
{
    if (r->status && fxs_worker_stopped(v->drawer))     /* a newer request has stopped this frame */
        return;
    if (r->on_screen && (r->status || !v->screen)) {
        if (v->screen)
            lose_screen(v);
        v->changed = 1;
        return;
    }
    if (r->status) {
        tell(v, "not rendered: see the terminal");
        v->coarse = 0;
        if (!v->seen.width)
            end_without(v, r);
        return;
    }
    const picture shown = v->picture;
    v->picture = v->drawn;
    v->drawn = shown;
    v->on_screen = r->on_screen;
    if (v->on_screen)
        fxs_screen_turn(v->screen);
    v->seen = r->view;
    v->coarse = r->divisor > 1;
    v->moved = v->coarse ? fxs_clock(0) : v->moved;
    v->exposed = 1;
    v->gaussians = r->stats.drawn;
    v->missing = r->stats.missing;
    fxs_frame_times_add(&v->times, &r->stats);
    play_take_time(v, r->stats.frame_nanoseconds, r->divisor);
    if (v->rate_wanted > 0 && r->moves && r->render.budget == v->options.render.budget)
        viewer_follow_rate(v, r->stats.frame_nanoseconds, r->stats.drawn);
    if (v->renderer.lost && !v->lost++)
        tell(v, v->renderer.why_lost.text);
}

void ask_frame(viewer *v)
{
    request *r = ask(v, render, take_frame, v->moving || (v->play.on && v->play.slow) ? v->divisor : 1);
    if (r) {
        r->render.stop = (fxs_stop){fxs_worker_stopped, v->drawer};
        r->shows_part = 1;
        r->moves = v->moving || v->play.on;
    }
    v->changed = v->moving = 0;
}

void stop_frame(viewer *v)
{
    const request *r = v->requests;
    if (v->given && r->done == take_frame && r->divisor == 1 && v->moving && v->divisor > 1)
        fxs_worker_stop(v->drawer);
}

/* Finds the first free file name of STEM-001 to STEM-999. Returns 0, or nonzero and a message. */
static int name_file(request *r, const char *stem, const char *ending)
{
    for (int i = 1; i < 1000; i++) {
        const int length = snprintf(r->path, sizeof r->path, "%s-%03d%s", stem, i, ending);
        if (length >= (int)sizeof r->path)
            return fxs_fail(&r->message, "not written: the name of the scene is too long");
        if (fxs_file_kind(r->path) == FXS_FILE_NONE)
            return 0;
    }
    return fxs_fail(&r->message, "%s-001%s to -999%s are there already", stem, ending, ending);
}

static void write_picture(viewer *v, request *r)
{
    render(v, r);
    if (r->status)
        return;
    if (v->screenshot)
        snprintf(r->path, sizeof r->path, "%s", v->screenshot);
    else
        r->unwritten = name_file(r, "fixsplat", ".png");
    if (!r->unwritten)
        r->unwritten = fxs_image_file_write(r->path, v->drawn.pixels, v->drawn.width, v->drawn.height, &r->message);
}

static void print_named(const char *option, const char *name)
{
    printf("%s", option);
    write_shell_word(stdout, name);
}

static void print_level(const load_options *o)
{
    if (o->lods)
        printf(" --lod %s", o->lods);
    else
        printf(" --lod %d", o->lod);
}

static int has_floats(const world *w)
{
    for (uint32_t i = 0; i < w->placed.file_count; i++)
        if (!is_packed(&w->scenes[i]))
            return 1;
    return 0;
}

static void print_scenes(const world_options *o)
{
    if (o->file)
        print_named(" --scene", o->file);
    for (int i = 0; i < o->scene_count; i++)
        print_named("", o->scenes[i]);
    for (int i = 0; i < o->place_count; i++)
        print_named(" --place", o->places[i]);
}

/* True if a view is the same as in the camera file. */
static int is_of_file(const viewer *v, const fxs_view *view)
{
    const fxs_view *start = &v->views[v->index];
    return v->options.cameras && !memcmp(view->position, start->position, sizeof view->position) &&
           !memcmp(view->rotation, start->rotation, sizeof view->rotation) &&
           view->width * (int64_t)start->height == start->width * (int64_t)view->height;
}

static void print_camera(const viewer *v, const fxs_view *view)
{
    const double *e = view->position, *down = view->rotation + 3, *ahead = view->rotation + 6, d = v->distance;
    printf(" --eye %.17g,%.17g,%.17g --look %.17g,%.17g,%.17g", e[0], e[1], e[2], e[0] + d * ahead[0],
           e[1] + d * ahead[1], e[2] + d * ahead[2]);
    printf(" --up %.17g,%.17g,%.17g", -down[0], -down[1], -down[2]);
    if (v->options.has_tangents)
        printf(" --tangents %.17g,%.17g,%.17g,%.17g", v->options.tangents[0], v->options.tangents[1],
               v->options.tangents[2], v->options.tangents[3]);
    else if (view->projection == FXS_PERSPECTIVE)
        printf(" --fov %.17g", 2 * atan(view->height / 2.0 / view->fy) * 180 / acos(-1));
}

/* Prints the command line that renders the current picture again. The pictures are
   equal if pixels are square and the principal point is central. */
static void print_command(const viewer *v, const fxs_view *view, const fxs_options *render_options,
                          const char *path)
{
    const fxs_view *start = &v->views[v->index];
    const int of_file = is_of_file(v, view);
    printf("fixsplat render");
    print_scenes(&v->options.world);
    printf(" --cutoff %s --sh-degree %d --bg %02x%02x%02x", cutoff_names[render_options->cutoff],
           render_options->sh_degree, render_options->background[0], render_options->background[1],
           render_options->background[2]);
    if (of_file) {
        print_named(" --cameras", v->options.cameras);
        printf(" --view %ld", v->index);
    } else
        print_camera(v, view);
    if (view->projection == FXS_ORTHOGRAPHIC)
        printf(" --ortho %.17g", view->height / view->fy);
    if (!of_file || v->options.width || view->width != start->width)
        printf(" --size %dx%d", view->width, view->height);
    if (v->options.stereo > 0)
        printf(" --stereo %.17g", v->options.stereo);
    if (render_options->budget)
        printf(" --budget %" PRIu32, render_options->budget);
    if (render_options->detail_q8)
        printf(" --detail %.9g", render_options->detail_q8 / 256.0);
    if (play_moves(v))
        printf(" --time %.17g", ldexp((double)render_options->time_q32, -32));
    printf(" --near %.17g", view->near);
    print_level(&v->options.load);
    if (v->options.load.profile && has_floats(&v->world))
        printf(" --profile %s", profile_names[v->options.load.profile]);
    print_named(" -o", path);
    puts("");
    fflush(stdout);
}

void tell_written(viewer *v, const request *r)
{
    char text[256];
    snprintf(text, sizeof text, "written: %.200s", r->path);
    if (r->unwritten)
        fail(0, "%s", r->message.text);
    tell(v, r->unwritten ? r->message.text : text);
}

static void take_written(viewer *v, request *r)
{
    take_frame(v, r);
    if (r->status)
        return;
    tell_written(v, r);
    if (!r->unwritten && r->shown == SHOW_COLOUR && !r->crop.on && !is_edited(v))
        print_command(v, &r->view, &r->render, r->path);
}

void ask_screenshot(viewer *v)
{
    ask(v, write_picture, take_written, 1);
}

/* Renders and writes the frames of a film. Returns 0, or nonzero with r->status or a message. */
static int write_frames(viewer *v, request *r, fxs_film *film)
{
    fxs_encoded encoded = {0};
    int failed = 0;
    for (int i = 0; i < v->way_count && !failed; i++) {
        request frame = *r;
        frame.view = fit(v, v->way[i], r->view.width, r->view.height);
        frame.render.time_q32 = v->way_times_q32[i];
        render(v, &frame);
        failed = r->status = frame.status;
        failed = failed || fxs_image_encode(FXS_IMAGE_Y4M, 0, v->drawn.pixels, v->drawn.width, v->drawn.height,
                                            &encoded, &r->message) || fxs_film_write(film, &encoded, &r->message);
        if (!failed && fxs_worker_tell(v->drawer, (i + 1.0) / v->way_count))
            failed = fxs_fail(&r->message, "%s: dropped", r->path);
    }
    fxs_encoded_free(&encoded);
    return failed;
}

static void write_film(viewer *v, request *r)
{
    fxs_film *film = 0;
    const int width = eyes_of(v) * r->view.width;
    r->unwritten = name_file(r, "fixsplat", ".y4m") ||
                   fxs_film_open(&film, r->path, FXS_IMAGE_Y4M, width, r->view.height, FILM_RATE, &r->message) ||
                   write_frames(v, r, film);
    if (!r->unwritten)
        r->unwritten = fxs_film_close(film, 1, &r->message);
    else {
        fxs_message of_close;
        fxs_film_close(film, 0, &of_close);
    }
}

static void take_film(viewer *v, request *r)
{
    char text[256];
    v->film = FILM_NONE;
    if (r->status)
        snprintf(text, sizeof text, "no film: see the terminal");
    else if (r->unwritten)
        snprintf(text, sizeof text, "%.255s", r->message.text);
    else
        snprintf(text, sizeof text, "written: %.200s, %d frames", r->path, v->way_count);
    tell(v, text);
    v->changed = 1;
}

void ask_film(viewer *v)
{
    if (ask(v, write_film, take_film, 1))
        v->film = FILM_WRITTEN;
}

/* Returns the file ending for a cropped scene: that of the source if its format can be written, else .ply. */
static const char *cropped_ending(const viewer *v)
{
    const fxs_scene_format *format = v->world.placed.file_count == 1 ? fxs_scene_format_of(v->path, 1) : 0;
    if (!format || !strcmp(format->name, "fxs"))
        return ".ply";
    return v->path + strlen(v->path) - strcspn(format->endings, " ");
}

int name_beside(const viewer *v, request *r, const char *word, const char *ending)
{
    const char *slash = strrchr(v->path, '/'), *dot = strrchr(v->path, '.');
    char stem[4096];
    size_t length = ends_with(v->path, ending) ? strlen(v->path) - strlen(ending)
                    : dot && dot > (slash ? slash + 1 : v->path) ? (size_t)(dot - v->path) : strlen(v->path);
    const int is_piped = !strcmp(v->path, "-");
    if (length >= sizeof stem)
        return fxs_fail(&r->message, "not written: the name of the scene is too long");
    snprintf(stem, sizeof stem, "%.*s-%s", is_piped ? 5 : (int)length, is_piped ? "scene" : v->path, word);
    return name_file(r, stem, ending);
}

static void write_cropped(viewer *v, request *r)
{
    fxs_scene_filter filter;
    load_options load = v->options.load;
    fxs_scene_filter_init(&filter);
    for (int i = 0; i < 3; i++) {
        filter.low[i] = r->crop.low[i];
        filter.high[i] = r->crop.high[i];
    }
    load.filter = &filter;
    load.again = 1;
    load.has_moment = play_moves(v);
    load.moment = ldexp((double)r->render.time_q32, -32);
    load.progress = (fxs_progress){fxs_worker_tell, v->drawer};
    r->unwritten = is_edited(v) ? fxs_fail(&r->message, "not written: the scene is edited; shift and delete keeps the "
                                           "box, l and enter write it")
                                : name_beside(v, r, "cropped", cropped_ending(v));
    if (!r->unwritten)
        r->status = convert_merged(r->path, 0, 0, &v->world.placed, v->path, &load);
}

static void print_conversion(const viewer *v, const request *r)
{
    const load_options *o = &v->options.load;
    printf("fixsplat convert");
    print_scenes(&v->options.world);
    print_named("", r->path);
    printf(" --crop ");
    for (int i = 0; i < 6; i++) {
        const double side = i < 3 ? r->crop.low[i] : r->crop.high[i - 3];
        printf("%s%.*g", i ? "," : "", fabs(side) < 4096 ? 9 : 17, side);
    }
    if (play_moves(v))
        printf(" --time %.17g", ldexp((double)r->render.time_q32, -32));
    if (o->lod || o->lods)
        print_level(o);
    if (o->axes)
        printf(" --axes %s", o->axes == FXS_AXES_RUB ? "rub" : "rdf");
    printf("\n");
    fflush(stdout);
}

static void take_cropped(viewer *v, request *r)
{
    v->crop_written = 0;
    if (r->status)
        tell(v, "not written: see the terminal");
    else
        tell_written(v, r);
    if (!r->status && !r->unwritten)
        print_conversion(v, r);
}

void ask_crop(viewer *v)
{
    if (ask(v, write_cropped, take_cropped, 1))
        v->crop_written = 1;
}

static void pick(viewer *v, request *r)
{
    crop_objects(v, &r->crop);
    r->status = renderer_pick(&v->renderer, &v->world, &r->view, &r->render, r->x, r->y, &r->pick);
}

static void ask_pick(viewer *v, void (*done)(viewer *, request *), double x, double y)
{
    request *r = ask(v, pick, done, 1);
    if (!r)
        return;
    x = fmod(x, r->view.width);
    r->x = (int)fmax(x, 0);
    r->y = (int)fmin(fmax(y, 0), r->view.height - 1);
}

static int found(viewer *v, const request *r)
{
    if (r->status <= 0)
        tell(v, r->status ? "not found: see the terminal" : "nothing there");
    return r->status > 0;
}

static double units(int64_t q32)
{
    return (double)q32 / 4294967296.0;
}

/* Moves the camera sideways, so that the picked point is in the middle of the picture at the same depth. The point
   becomes the pivot (centre of orbits). */
static void take_focus(viewer *v, request *r)
{
    double seen[3] = {0, 0, 0};
    if (!found(v, r))
        return;
    if (walk_is_on(v)) {
        walk_to(v, (double[3]){units(r->pick.position_q32[0]), units(r->pick.position_q32[1]),
                               units(r->pick.position_q32[2])});
        return;
    }
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            seen[i] += v->view.rotation[3 * i + k] * (units(r->pick.position_q32[k]) - v->view.position[k]);
    if (seen[2] <= 0)
        return;
    fxs_motion_fly(&v->view, seen[0], seen[1], 0);
    v->distance = seen[2];
    v->changed = 1;
}

void ask_focus(viewer *v, double x, double y)
{
    ask_pick(v, take_focus, x, y);
}

static void take_end(viewer *v, request *r)
{
    if (!v->measuring || !found(v, r))
        return;
    v->ends = v->ends == 2 ? 0 : v->ends;
    for (int i = 0; i < 3; i++)
        v->end[v->ends][i] = units(r->pick.position_q32[i]);
    v->ends++;
    const double *a = v->end[0], *b = v->end[1];
    if (v->ends == 2)
        snprintf(v->note, sizeof v->note, "%.4g units", hypot(hypot(b[0] - a[0], b[1] - a[1]), b[2] - a[2]));
    else
        snprintf(v->note, sizeof v->note, "measure: click the other end");
    v->exposed = 1;
}

void ask_end(viewer *v, double x, double y)
{
    ask_pick(v, take_end, x, y);
}
