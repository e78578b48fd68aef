#include "viewer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../port/backend/backends.h"
#include "../port/image/image_file.h"
#include "../port/posix/clock.h"
#include "../port/window/motion.h"
#include "view.h"

enum { OVERLAY_WIDTH = 480, OVERLAY_HEIGHT = 440, STILL_MS = 150, FRAME_MS = 16 };

static const char *cutoff_name(enum fxs_cutoff cutoff)
{
    return cutoff == FXS_CUTOFF_SQUARE ? "square" : "mahalanobis";
}

/* ---- Scene and views --------------------------------------------------------------------------------------------- */

/* Shows a view as it came. The pivot is the point looked at, or the one ahead that is nearest to the scene's middle. */
static void show_view(viewer *v, long index)
{
    const double *low = v->world.inner_low, *high = v->world.inner_high;
    const fxs_file_view *view = &v->views[index];
    double ahead = 0, square = 0;
    for (int i = 0; i < 3; i++) {
        double half = (high[i] - low[i]) / 2;
        double target = v->options.has_look ? v->options.look[i] : low[i] + half;
        square += half * half;
        ahead += (target - view->position[i]) * view->rotation[6 + i];
    }
    v->radius = fmax(sqrt(square), 1e-3);
    v->distance = ahead > 0.01 * v->radius ? ahead : v->radius;
    v->view = *view;
    v->view.near = v->options.near > 0 ? v->options.near : fxs_near_of_box(low, high);
    v->index = index;
    v->changed = 1;
}

/* Up in the scene: as given, or the mean of the views' where they come from a file. */
static void find_up(viewer *v)
{
    double mean[3] = {0, 0, 0};
    for (long i = 0; i < v->view_count; i++)
        for (int k = 0; k < 3; k++)
            mean[k] -= v->views[i].rotation[3 + k] / (double)v->view_count;
    int of_views = v->options.cameras && !v->options.has_up && hypot(hypot(mean[0], mean[1]), mean[2]) > 0.1;
    memcpy(v->up, of_views ? mean : v->options.up, sizeof v->up);
}

/* Puts other scenes and their views in the place of those there are, which stay where that fails. `path`, or null: a
   file in place of those that the options name. */
static int take_scenes_of(viewer *v, const char *path, const frame_options *options)
{
    world w;
    fxs_file_view *views = 0;
    frame_options all = *options;
    all.view = "all";
    const char *name = path ? path : options->world.file ? options->world.file : options->world.scenes[0];
    char *copy = strdup(name);
    if (!copy)
        return fail(EXIT_FAILED, "%s: out of memory", name);
    if (path ? world_open_file(&w, path, &options->load) : world_open(&w, &options->world, &options->load)) {
        free(copy);
        return EXIT_FAILED;
    }
    long count = choose_views(&all, &w, &views), index = count < 0 ? -1 : find_view(options, views, count);
    if (index < 0) {
        world_close(&w);
        free(views);
        free(copy);
        return EXIT_FAILED;
    }
    renderer_forget(&v->renderer, &v->world);
    world_close(&v->world);
    free(v->views);
    free(v->path);
    v->world = w;
    v->views = views;
    v->view_count = count;
    v->path = copy;
    v->options = *options;
    if (path)
        v->options.world = (world_options){.scenes = &v->path, .scene_count = 1};
    find_up(v);
    show_view(v, index);
    return 0;
}

static void drop(viewer *v, const char *path)
{
    frame_options options = v->options;
    options.cameras = options.view = 0;
    options.has_eye = options.has_look = 0;
    if (take_scenes_of(v, path, &options)) {
        snprintf(v->note, sizeof v->note, "cannot open %.128s: see the terminal", path);
        v->changed = 1;
    }
}

/* ---- Frames ------------------------------------------------------------------------------------------------------ */

/* Side by side in the window. */
static int eyes_of(const viewer *v)
{
    return v->options.stereo > 0 ? 2 : 1;
}

/* The view on show at the window's size, or a fraction of it; of two eyes, one of them. */
static fxs_file_view fit_view(const viewer *v, int divisor)
{
    fxs_file_view view = v->view;
    fxs_message message;
    int width, height;
    fxs_window_size(v->window, &width, &height);
    width /= eyes_of(v);
    width = width > divisor ? width / divisor : 1;
    height = height > divisor ? height / divisor : 1;
    if (width != view.width || height != view.height)
        fxs_view_resize(&view, width, height);
    if (v->options.has_tangents)
        fxs_view_set_tangents(&view, v->options.tangents, &message);
    return view;
}

static int render(viewer *v, const fxs_file_view *view)
{
    fxs_stats stats;
    if (renderer_render(&v->renderer, &v->world, view, &v->options.render, &v->picture, &stats))
        return EXIT_FAILED;
    fxs_frame_times_add(&v->times, &stats);
    return 0;
}

static const fxs_picture *draw_overlay(viewer *v)
{
    const fxs_picture *overlay = &v->overlay;
    int top = v->graph ? FXS_GRAPH_HEIGHT + 8 : 0;
    if (!v->graph && !v->help)
        return 0;
    memset(overlay->rgba, 0, OVERLAY_WIDTH * OVERLAY_HEIGHT * 4);
    if (v->graph)
        fxs_draw_frame_times(overlay, 0, 0, &v->times);
    if (v->help) {
        fxs_draw_rectangle(overlay, 0, top, OVERLAY_WIDTH, OVERLAY_HEIGHT - FXS_GRAPH_HEIGHT - 8, FXS_PANEL);
        fxs_draw_text(overlay, 8, top + 10, 2, viewer_keys, 0xe8ecf2ff);
    }
    return overlay;
}

static void draw_title(viewer *v)
{
    char title[1024];
    const char *slash = strrchr(v->path, '/');
    snprintf(title, sizeof title, "%.200s - %s (%ld of %ld) - %s, SH %d, %s, 1/%d - %.1f ms%s%s",
             slash && slash[1] ? slash + 1 : v->path, v->view.name, v->index + 1, v->view_count,
             cutoff_name(v->options.render.cutoff), v->options.render.sh_degree, v->options.backend,
             v->coarse ? v->divisor : 1, v->times.frame, *v->note ? " - " : "", v->note);
    fxs_window_title(v->window, title);
}

static int draw(viewer *v)
{
    fxs_message message;
    v->coarse = v->moving && v->divisor > 1;
    v->changed = v->moving = 0;
    const fxs_file_view view = fit_view(v, v->coarse ? v->divisor : 1);
    v->renderer.divisor = v->coarse ? v->divisor : 1;
    int status = render(v, &view);
    if (status)
        snprintf(v->note, sizeof v->note, "not rendered: see the terminal");
    const fxs_picture shown = {v->picture.pixels, v->picture.width, v->picture.height};
    if (!status && fxs_window_show(v->window, &shown, draw_overlay(v), &message))
        status = fail(EXIT_FAILED, "%s", message.text);
    draw_title(v);
    return status;
}

/* ---- Screenshots ------------------------------------------------------------------------------------------------- */

/* SCENE-001.png, or the first number that is free. */
static void name_beside(const viewer *v, char *path, size_t size)
{
    const char *slash = strrchr(v->path, '/'), *dot = strrchr(v->path, '.');
    int length = (int)(dot && (!slash || dot > slash + 1) ? (size_t)(dot - v->path) : strlen(v->path));
    for (int i = 1; i < 1000; i++) {
        snprintf(path, size, "%.*s-%03d.png", length, v->path, i);
        if (access(path, F_OK))
            return;
    }
}

static void print_scenes(const world_options *o)
{
    if (o->file)
        printf(" --scene %s", o->file);
    for (int i = 0; i < o->scene_count; i++)
        printf(" %s", o->scenes[i]);
    for (int i = 0; i < o->place_count; i++)
        printf(" --place %s", o->places[i]);
}

static void print_eyes(const viewer *v)
{
    const foveate_options *o = &v->options.foveate;
    if (v->options.stereo > 0)
        printf(" --stereo %.17g%s", v->options.stereo, v->options.stereo_exact ? " --stereo-exact" : "");
    if (o->on)
        printf(" --foveate");
    for (int i = 0; i < o->given; i++)
        printf("%c%.17g", i ? ',' : '=', o->numbers[i]);
}

/* The command that renders the picture again, to the byte where pixels are square and the axis in the middle. */
static void print_command(const viewer *v, const fxs_file_view *view, const char *path)
{
    const fxs_options *render = &v->options.render;
    const fxs_file_view *start = &v->views[v->index];
    const double *e = view->position, *down = view->rotation + 3, *ahead = view->rotation + 6, d = v->distance;
    int sized = v->options.width || view->width != start->width || view->height != start->height;
    printf("fixsplat render");
    print_scenes(&v->options.world);
    printf(" --cutoff %s --sh-degree %d --bg %02x%02x%02x", cutoff_name(render->cutoff), render->sh_degree,
           render->background[0], render->background[1], render->background[2]);
    if (v->options.cameras && !memcmp(e, start->position, sizeof view->position) &&
        !memcmp(view->rotation, start->rotation, sizeof view->rotation))
        printf(" --cameras %s --view %ld", v->options.cameras, v->index);
    else {
        printf(" --eye %.17g,%.17g,%.17g --look %.17g,%.17g,%.17g", e[0], e[1], e[2], e[0] + d * ahead[0],
               e[1] + d * ahead[1], e[2] + d * ahead[2]);
        printf(" --up %.17g,%.17g,%.17g", -down[0], -down[1], -down[2]);
        if (v->options.has_tangents)
            printf(" --tangents %.17g,%.17g,%.17g,%.17g", v->options.tangents[0], v->options.tangents[1],
                   v->options.tangents[2], v->options.tangents[3]);
        else if (view->projection == FXS_PERSPECTIVE)
            printf(" --fov %.17g", 2 * atan(view->height / 2.0 / view->fy) * 180 / acos(-1));
        sized = 1;
    }
    if (view->projection == FXS_ORTHOGRAPHIC)
        printf(" --ortho %.17g", view->height / view->fy);
    if (sized)
        printf(" --size %dx%d", view->width, view->height);
    print_eyes(v);
    printf(" --near %.17g --lod %d --profile %s -o %s\n", view->near, v->options.load.lod,
           profile_name(v->options.load.profile), path);
    fflush(stdout);
}

static void screenshot(viewer *v, int key)
{
    (void)key;
    char path[4096];
    fxs_message message;
    const fxs_file_view view = fit_view(v, 1);
    v->renderer.divisor = 1;
    if (v->screenshot)
        snprintf(path, sizeof path, "%s", v->screenshot);
    else
        name_beside(v, path, sizeof path);
    if (render(v, &view))
        snprintf(v->note, sizeof v->note, "no screenshot: see the terminal");
    else if (fxs_image_file_write(path, v->picture.pixels, v->picture.width, v->picture.height,
                                  &message)) {
        fail(0, "%s", message.text);
        snprintf(v->note, sizeof v->note, "%.200s", message.text);
    } else {
        print_command(v, &view, path);
        snprintf(v->note, sizeof v->note, "written: %.200s", path);
    }
}

/* ---- Keys and pointer -------------------------------------------------------------------------------------------- */

static void next_view(viewer *v, int key)
{
    show_view(v, (v->index + (key == 'n' ? 1 : v->view_count - 1)) % v->view_count);
}

static void reset(viewer *v, int key)
{
    (void)key;
    show_view(v, v->index);
}

static void toggle_cutoff(viewer *v, int key)
{
    (void)key;
    v->options.render.cutoff = v->options.render.cutoff == FXS_CUTOFF_SQUARE ? FXS_CUTOFF_MAHALANOBIS
                                                                            : FXS_CUTOFF_SQUARE;
}

static void choose_degree(viewer *v, int key)
{
    v->options.render.sh_degree = key - '0';
}

/* The next of the back ends that can be had, maybe the same again. */
static void next_backend(viewer *v, int key)
{
    (void)key;
    int now = 0, count = 0;
    while (fxs_backend_at(count))
        count++;
    while (fxs_backend_at(now) != v->renderer.backend)
        now++;
    for (int i = 1; i <= count; i++) {
        renderer other;
        frame_options options = v->options;
        options.backend = fxs_backend_at((now + i) % count)->name;
        if (!renderer_open(&other, &options)) {
            renderer_close(&v->renderer);
            v->renderer = other;
            v->options.backend = options.backend;
            return;
        }
    }
}

static void next_divisor(viewer *v, int key)
{
    (void)key;
    v->divisor = v->divisor == 4 ? 1 : 2 * v->divisor;
    snprintf(v->note, sizeof v->note, "1/%d of the resolution in motion", v->divisor);
}

static void change_speed(viewer *v, int key)
{
    v->speed = fmin(fmax(v->speed * (key == '-' ? 1 / 1.5 : 1.5), 1e-3), 1e3);
    snprintf(v->note, sizeof v->note, "speed %.3g units a second", v->speed * v->radius);
}

static void toggle_graph(viewer *v, int key) { (void)key; v->graph = !v->graph; }

static void toggle_help(viewer *v, int key) { (void)key; v->help = !v->help; }

static void quit(viewer *v, int key) { (void)key; v->quit = 1; }

static void press(viewer *v, int pressed)
{
    static const struct {
        int key;
        void (*act)(viewer *v, int key);
    } keys[] = {{'n', next_view}, {'p', next_view}, {'r', reset}, {'c', toggle_cutoff}, {'0', choose_degree},
                {'1', choose_degree}, {'2', choose_degree}, {'3', choose_degree}, {'b', next_backend},
                {'v', next_divisor}, {'+', change_speed}, {'=', change_speed}, {'-', change_speed},
                {'g', toggle_graph}, {'h', toggle_help}, {'i', screenshot}, {FXS_KEY_ESCAPE, quit}};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
        if (keys[i].key == pressed) {
            *v->note = 0;
            v->changed = 1;
            keys[i].act(v, pressed);
        }
}

/* Half a turn across the window's height; what is seen keeps up with the pointer. */
static void point(viewer *v, const fxs_window_event *event)
{
    int width, height, look = fxs_window_holds(' ');
    fxs_window_size(v->window, &width, &height);
    double turn = acos(-1) / height, pixels = (double)v->view.width * eyes_of(v) / width;
    if (look)
        fxs_motion_look(&v->view, v->up, event->dx * pixels / v->view.fx, event->dy * pixels / v->view.fy);
    else if (event->left)
        fxs_motion_orbit(&v->view, v->distance, v->up, event->dx * turn, event->dy * turn);
    else if (event->other)
        fxs_motion_pan(&v->view, v->distance, event->dx * pixels, event->dy * pixels);
    if (look || event->left || event->other)
        v->changed = v->moving = 1;
}

static void zoom(viewer *v, double steps)
{
    double nearest = 1e-4 * v->radius / v->distance;
    fxs_motion_zoom(&v->view, &v->distance, fmax(pow(0.9, steps), nearest));
    v->changed = v->moving = 1;
}

static void fly(viewer *v, double seconds)
{
    double step = seconds * v->speed * v->radius * (fxs_window_holds(FXS_KEY_SHIFT) ? 4 : 1);
    int right = fxs_window_holds('d') - fxs_window_holds('a'), down = fxs_window_holds('q') - fxs_window_holds('e');
    int forward = fxs_window_holds('w') - fxs_window_holds('s');
    v->flying = right || down || forward;
    if (v->flying) {
        fxs_motion_fly(&v->view, right * step, down * step, forward * step);
        v->changed = v->moving = 1;
    }
}

static void take(viewer *v, const fxs_window_event *event)
{
    switch (event->type) {
    case FXS_EVENT_QUIT: v->quit = 1; break;
    case FXS_EVENT_KEY: press(v, event->key); break;
    case FXS_EVENT_POINTER: point(v, event); break;
    case FXS_EVENT_WHEEL: zoom(v, event->dy); break;
    case FXS_EVENT_DROP: drop(v, event->path); break;
    case FXS_EVENT_CHANGED: v->changed = 1; break;
    case FXS_EVENT_NONE: break;
    }
}

/* ---- The viewer -------------------------------------------------------------------------------------------------- */

void viewer_step(viewer *v, int milliseconds)
{
    const fxs_file_view view = v->view;
    const double distance = v->distance;
    fxs_camera camera;
    fxs_message message;
    fxs_window_event event;
    int passed = (int)((fxs_clock(0) - v->clock) / 1000000);
    int wait = v->flying ? (passed < FRAME_MS ? FRAME_MS - passed : 0) : v->coarse ? STILL_MS : milliseconds;
    for (; !v->quit && fxs_window_wait(v->window, wait, &event); wait = 0)
        take(v, &event);
    uint64_t now = fxs_clock(0);
    fly(v, v->flying ? fmin((double)(now - v->clock) * 1e-9, 0.1) : FRAME_MS * 1e-3);
    v->clock = now;
    if (fxs_camera_from_view(&camera, &v->view, &message)) {   /* moved out of the renderer's range */
        v->view = view;
        v->distance = distance;
    }
    if (!v->quit && (v->changed || v->coarse))
        draw(v);
}

int viewer_open(viewer *v, const frame_options *options, const char *screenshot_path)
{
    fxs_message message;
    memset(v, 0, sizeof *v);
    v->screenshot = screenshot_path;
    v->divisor = 2;
    v->speed = 0.5;
    v->overlay = (fxs_picture){malloc(OVERLAY_WIDTH * OVERLAY_HEIGHT * 4), OVERLAY_WIDTH, OVERLAY_HEIGHT};
    int status = v->overlay.rgba ? renderer_open(&v->renderer, options) : fail(EXIT_FAILED, "out of memory");
    if (!status && fxs_window_open(&v->window, &message))
        status = fail(EXIT_FAILED, "%s", message.text);
    status = status ? status : take_scenes_of(v, 0, options);
    if (!status) {
        fxs_window_resize(v->window, v->view.width * eyes_of(v), v->view.height);
        status = draw(v);
    }
    if (status)
        viewer_close(v);
    return status;
}

void viewer_close(viewer *v)
{
    if (v->window)
        fxs_window_close(v->window);
    renderer_close(&v->renderer);
    world_close(&v->world);
    picture_free(&v->picture);
    free(v->views);
    free(v->path);
    free(v->overlay.rgba);
}
