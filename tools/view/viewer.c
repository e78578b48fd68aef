/* The window's thread of `fixsplat view`. Opens scenes, turns keys and pointer into camera motion, adapts the budget
   (Gaussians per frame) to the frame rate, and queues requests for the renderer's thread. */
#include "viewer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/system.h>
#include "port/window/motion.h"
#include "port/window/words.h"
#include "src/base/os_calls.h"
#include "tools/command/views.h"
#include <fixsplat/internal/packed.h>
#include <fixsplat/internal/pager_more.h>
#include <fixsplat/internal/parts.h>
#include <fixsplat/internal/view_more.h>

enum { STILL_MS = 150, SLIDER_MS = 2500, FRAME_MS = 16, LOADING_MS = 50, HINT_MS = 6000,
       FILM_NS = 1000000000 / FILM_RATE };

/* Shows a view of the camera file or of the options. The pivot (centre of orbits) is the --look point, or else the
   point ahead that is nearest to the scene's middle. */
static void show_view(viewer *v, long index)
{
    const double *low = v->world.inner_low, *high = v->world.inner_high;
    const fxs_view *view = &v->views[index];
    double ahead = 0, square = 0;
    for (int i = 0; i < 3; i++) {
        double half = (high[i] - low[i]) / 2;
        double target = v->options.look.given ? v->options.look.at[i] : low[i] + half;
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

static void find_up(viewer *v)
{
    double mean[3];
    if (!v->options.up.given && world_up(&v->world, v->up))
        return;
    const int of_views = v->options.cameras && !v->options.up.given && !v->options.auto_up &&
                         fxs_views_up(v->views, (size_t)v->view_count, sizeof *v->views, mean);
    memcpy(v->up, of_views ? mean : v->options.up.at, sizeof v->up);
}

/* Computes the origin of a chunk (256 Gaussians) in the world: p = R o s + t, with rotation R,
   origin o, scale s and translation t. */
static void point_of(const fxs_object *object, uint32_t chunk, double point[3])
{
    fxs_chunk header;
    memcpy(&header, object->scene->chunks + (size_t)chunk * sizeof header, sizeof header);
    fxs_little_endian(&header, offsetof(fxs_chunk, origin_q32), 3, sizeof *header.origin_q32);
    for (int i = 0; i < 3; i++) {
        double turned = 0;
        for (int k = 0; k < 3; k++)
            turned += ldexp((double)object->rotation_q30[3 * i + k], -30) * ldexp((double)header.origin_q32[k], -32);
        point[i] = turned * ldexp((double)object->scale_q32, -32) + ldexp((double)object->translation_q32[i], -32);
    }
}

/* Samples the scene by taking one point of every n-th chunk. Each chunk has 256 Gaussians, so the sample is even. */
static void find_points(viewer *v)
{
    uint64_t chunks = 0, number = 0;
    for (uint32_t i = 0; i < v->world.count; i++)
        chunks += v->world.objects[i].scene->chunk_count;
    const uint64_t step = (chunks + NEAR_POINTS - 1) / NEAR_POINTS;
    v->point_count = 0;
    for (uint32_t i = 0; i < v->world.count; i++)
        for (uint32_t k = 0; k < v->world.objects[i].scene->chunk_count; k++)
            if (number++ % step == 0)
                point_of(&v->world.objects[i], k, v->points[v->point_count++]);
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Returns the distance from the camera within which the nearest twentieth of the scene lies. It is clamped to 0.01 to 2
   scene radii. */
static double reach(const viewer *v)
{
    double distances[NEAR_POINTS];
    for (int i = 0; i < v->point_count; i++) {
        const double *p = v->points[i], *e = v->view.position;
        distances[i] = hypot(hypot(p[0] - e[0], p[1] - e[1]), p[2] - e[2]);
    }
    qsort(distances, (size_t)v->point_count, sizeof *distances, ascending);
    const double near = v->point_count ? distances[v->point_count / 20] : v->radius;
    return fmin(fmax(near, 0.01 * v->radius), 2 * v->radius);
}

static void keep_recent(loading *l)
{
    fxs_message message;
    if (l->world.placed.file_count == 1 && fxs_recent_add(l->world.placed.files[0], &message) && !l->unkept++)
        note("recent scenes are not kept: %s", message.text);
}

static void note_arrived(void *viewer_)
{
    viewer *v = viewer_;
    if (!__atomic_exchange_n(&v->arrived, 1, __ATOMIC_ACQ_REL))
        fxs_window_wake();
}

static void note_why(loading *l)
{
    const world_options *given = &l->options.world;
    const char *why = last_failure(), *path = l->path ? l->path : given->file ? given->file : given->scenes[0];
    if (!strncmp(why, path, strlen(path)))
        why += viewer_file_name(path) - path;
    snprintf(l->why, sizeof l->why, "%.255s", why);
}

int has_levels(const world *w)
{
    for (uint32_t i = 0; i < w->count; i++)
        if (w->objects[i].scene->nodes)
            return 1;
    return 0;
}

static int open_given(viewer *v, const load_options *how)
{
    loading *l = &v->loading;
    const int status = world_open(&l->world, &l->options.world, how);
    if (status || v->rate_wanted <= 0 || has_levels(&l->world))
        return status;
    fail(EXIT_FAILED, "%s: has no levels of detail for --fps; convert --levels makes them", l->world.placed.files[0]);
    world_close(&l->world);
    return EXIT_FAILED;
}

static void load(void *argument)
{
    viewer *v = argument;
    loading *l = &v->loading;
    load_options how = l->options.load;
    how.progress = (fxs_progress){fxs_worker_tell, v->loader};
    how.arrived = note_arrived;
    how.arrived_argument = v;
    frame_options all = l->options;
    all.view = "all";
    l->views = 0;
    l->status = l->path ? world_open_file(&l->world, l->path, &how) : open_given(v, &how);
    if (l->status) {
        note_why(l);
        return;
    }
    l->count = choose_views(&all, &l->world, &l->views, 0);
    l->options.up = all.up;
    l->index = l->count < 0 ? -1 : find_view(&l->options, l->views, l->count);
    if (l->index >= 0) {
        keep_recent(l);
        return;
    }
    world_close(&l->world);
    free(l->views);
    l->status = EXIT_FAILED;
    note_why(l);
}

static void start_loading(viewer *v)
{
    v->loading.on = v->exposed = 1;
    fxs_worker_do(v->loader, load, v);
}

/* Opens a dropped file in place of the current scenes. If another scene is being opened, opens the file after that. */
static void drop(viewer *v, const char *path)
{
    char **place = v->loading.on ? &v->loading.next : &v->loading.path;
    free(*place);
    *place = strdup(path);
    if (v->loading.on || !*place)
        return;
    v->loading.options = v->options;
    v->loading.options.cameras = v->loading.options.view = 0;
    v->loading.options.eye.given = v->loading.options.look.given = 0;
    v->loading.options.load.pool = 0;
    start_loading(v);
}

static void end_loading(viewer *v)
{
    char *next = v->loading.next;
    v->loading.on = 0;
    v->exposed = 1;
    v->loading.next = 0;
    if (next)
        drop(v, next);
    free(next);
}

/* Shows the scenes that were loaded. If a dropped file could not be loaded, the current scenes remain. A failure at the
   start ends the program, unless its terminal would vanish with the message. */
static void collect_loaded(viewer *v)
{
    if (!v->loading.on || v->installing || fxs_worker_busy(v->loader))
        return;
    if (!v->loading.status) {
        v->installing = ask_install(v);
        return;
    }
    if (v->loading.path || fxs_terminal_ends_with_this())
        memcpy(v->note, v->loading.why, sizeof v->note);
    else {
        v->quit = 1;
        v->status = v->loading.status;
    }
    end_loading(v);
}

void viewer_install(viewer *v)
{
    loading *l = &v->loading;
    const frame_options *o = &l->options;
    const int first = !v->path, is_dropped = l->path != 0;
    walk_forget(v);
    v->walk.file = is_dropped ? 0 : v->walk.file;
    world_close(&v->world);
    edit_end(&v->edit);
    free(v->views);
    free(v->path);
    v->path = l->path ? l->path : strdup(o->world.file ? o->world.file : o->world.scenes[0]);
    v->world = l->world;
    v->views = l->views;
    v->view_count = l->count;
    v->options.cameras = o->cameras;
    v->options.view = o->view;
    v->options.eye.given = o->eye.given;
    v->options.look.given = o->look.given;
    v->options.up = o->up;
    if (l->path)
        v->options.world = (world_options){.scenes = &v->path, .scene_count = 1};
    l->path = 0;
    v->ends = v->installing = v->cropped = v->lost = 0;
    v->gaussians = v->missing = 0;
    fxs_pace_init(&v->pace);
    if (world_is_paged(&v->world) && !v->options.render.budget)
        v->options.render.budget = viewer_budget_most(v);
    v->film = v->film == FILM_TAKEN ? FILM_NONE : v->film;
    find_up(v);
    find_points(v);
    crop_begin(v);
    play_begin(v, is_dropped);
    show_view(v, l->index);
    if (first)
        fxs_window_resize(v->window, v->view.width * eyes_of(v), v->view.height);
    end_loading(v);
}

static void next_view(viewer *v, int key)
{
    (void)key;
    const int back = fxs_window_holds(FXS_KEY_SHIFT);
    show_view(v, (v->index + (back ? v->view_count - 1 : 1)) % v->view_count);
}

static void reset(viewer *v, int key)
{
    (void)key;
    show_view(v, v->index);
}

static void toggle_crop(viewer *v, int key) { (void)key; crop_toggle(v); }

static int is_writing(const viewer *v)
{
    return v->film == FILM_WRITTEN || v->crop_written;
}

static void write_crop(viewer *v, int key)
{
    (void)key;
    if (!edit_write(v) && v->crop.on && !is_writing(v))
        ask_crop(v);
}

static void toggle_cutoff(viewer *v, int key)
{
    (void)key;
    v->options.render.cutoff = v->options.render.cutoff == FXS_CUTOFF_SQUARE ? FXS_CUTOFF_MAHALANOBIS
                                                                            : FXS_CUTOFF_SQUARE;
    v->changed = 1;
}

static void next_degree(viewer *v, int key)
{
    (void)key;
    v->options.render.sh_degree = (v->options.render.sh_degree + 3) % 4;
    v->changed = 1;
}

static void choose_motion(viewer *v, int key)
{
    if (key == '3')
        walk_start(v);
    else
        walk_stop(v);
}

static void next_backend(viewer *v, int key) { (void)key; ask_backend(v); }

static void screenshot(viewer *v, int key) { (void)key; ask_screenshot(v); }

static void next_divisor(viewer *v, int key)
{
    (void)key;
    v->divisor = v->divisor == 4 ? 1 : 2 * v->divisor;
    snprintf(v->note, sizeof v->note, "1/%d of the resolution in motion", v->divisor);
}

static void change_speed(viewer *v, int key)
{
    v->speed = fmin(fmax(v->speed * (key == '-' ? 1 / 1.5 : 1.5), 1e-3), 1e3);
    snprintf(v->note, sizeof v->note, "speed here %.3g units a second",
             walk_is_on(v) ? walk_speed(v) : v->speed * reach(v));
}

static void show_other(viewer *v, int key)
{
    const enum viewer_picture other = key == 'z' ? SHOW_DEPTH : SHOW_IDS;
    v->shown = v->shown == other ? SHOW_COLOUR : other;
    v->changed = 1;
}

static void toggle_measure(viewer *v, int key)
{
    (void)key;
    v->measuring = !v->measuring;
    v->ends = 0;
    if (v->measuring)
        snprintf(v->note, sizeof v->note, "measure: click one end");
}

/* Handles the film key. The first press starts to record the camera's path, the second writes the film, and a third
   cancels the writing. */
static void toggle_film(viewer *v, int key)
{
    (void)key;
    if (v->film == FILM_WRITTEN) {
        fxs_worker_stop(v->drawer);
    } else if (v->film == FILM_TAKEN) {
        if (v->way_count && !v->crop_written)
            ask_film(v);
    } else {
        free(v->way);
        free(v->way_times_q32);
        v->way = malloc(FILM_MOST * sizeof *v->way);
        v->way_times_q32 = malloc(FILM_MOST * sizeof *v->way_times_q32);
        v->way_count = 0;
        v->film = v->way && v->way_times_q32 ? FILM_TAKEN : FILM_NONE;
        if (v->film == FILM_NONE)
            snprintf(v->note, sizeof v->note, "no film: out of memory");
    }
}

static void take_way(viewer *v, uint64_t now)
{
    v->filmed = v->way_count ? v->filmed : now;
    for (; v->way_count < FILM_MOST && v->filmed <= now; v->filmed += FILM_NS) {
        v->way_times_q32[v->way_count] = v->options.render.time_q32;
        v->way[v->way_count++] = v->view;
    }
    if (v->way_count == FILM_MOST && !v->crop_written)
        ask_film(v);
}

/* Returns the largest budget (Gaussians per frame). Half of each memory pool is left for prefetched and recently
   visible chunks (256 Gaussians each). */
uint32_t viewer_budget_most(const viewer *v)
{
    uint64_t most = 0;
    for (uint32_t i = 0; i < v->world.placed.file_count; i++)
        most += fxs_pager_room(v->world.scenes[i].opened->pager) / 2 * (uint64_t)FXS_CHUNK;
    most = most && most < v->world.gaussians ? most : v->world.gaussians;
    return most > BUDGET_LEAST ? (uint32_t)most : BUDGET_LEAST;
}

/* Sets the budget (Gaussians per frame). The largest budget stands for no limit, unless scenes are partly in memory. */
static void set_budget(viewer *v, double gaussians)
{
    const uint32_t most = viewer_budget_most(v);
    const double budget = fmin(fmax(gaussians, BUDGET_LEAST), most);
    v->options.render.budget = budget < most || world_is_paged(&v->world) ? (uint32_t)budget : 0;
}

static double budget_of(const viewer *v)
{
    return v->options.render.budget ? v->options.render.budget : viewer_budget_most(v);
}

static void change_budget(viewer *v, int key)
{
    if (!has_levels(&v->world)) {
        snprintf(v->note, sizeof v->note, "no levels of detail: convert --levels makes them");
        return;
    }
    set_budget(v, budget_of(v) * (key == ',' ? 1 / 1.25 : 1.25));
    v->slider = fxs_clock(0) + SLIDER_MS * 1000000ull;
    v->changed = 1;
}

static void toggle_levels(viewer *v, int key)
{
    (void)key;
    v->options.render.show_levels = !v->options.render.show_levels;
    v->changed = 1;
}

void viewer_follow_rate(viewer *v, uint64_t nanoseconds, uint32_t drawn)
{
    fxs_pace *p = &v->pace;
    p->frame_nanoseconds = (uint32_t)(1e9 / v->rate_wanted);
    p->budget_least = BUDGET_LEAST;
    p->budget_most = viewer_budget_most(v);
    p->budget = (uint32_t)budget_of(v);                 /* the keys change it too */
    if (has_levels(&v->world) && fxs_pace_step(p, nanoseconds, drawn, p->number) > 0)
        set_budget(v, p->budget);
}

static void toggle_graph(viewer *v, int key) { (void)key; v->graph = !v->graph; }

static void toggle_rate(viewer *v, int key) { (void)key; v->rate = !v->rate; }

static void toggle_theme(viewer *v, int key) { (void)key; v->light = !v->light; }

static void toggle_help(viewer *v, int key) { (void)key; v->help = !v->help; }

static void leave(viewer *v, int key)
{
    (void)key;
    if (v->crop_written)
        fxs_worker_stop(v->drawer);
    else if (v->crop.on)
        crop_toggle(v);
    else if (!edit_leave(v) && !walk_stop(v))
        v->quit = 1;
}

static void next_tool(viewer *v, int key) { (void)key; edit_tool(v); }

static void delete_chosen(viewer *v, int key) { (void)key; edit_delete(v); }

static void undo(viewer *v, int key) { (void)key; edit_undo(v); }

static void toggle_front(viewer *v, int key) { (void)key; edit_front(v); }

static void play(viewer *v, int key)
{
    play_toggle(v, key);
    v->play.spaced = 1;
}

/* What a key needs: nothing, a scene, a scene that moves, or scenes that are all still. */
enum { OF_WINDOW, OF_SCENE, OF_MOVING, OF_STILL };

static int has_use(const viewer *v, int of)
{
    return of == OF_WINDOW || (of == OF_SCENE && v->path) || (of == OF_MOVING && play_moves(v)) ||
           (of == OF_STILL && v->path && !play_moves(v));
}

static void press(viewer *v, int pressed)
{
    static const struct {
        int key, of;
        void (*act)(viewer *v, int key);
    } keys[] = {{'n', OF_SCENE, next_view}, {'r', OF_SCENE, reset}, {'c', OF_SCENE, toggle_crop},
                {FXS_KEY_ENTER, OF_SCENE, write_crop}, {'x', OF_SCENE, toggle_cutoff}, {'0', OF_SCENE, next_degree},
                {'1', OF_SCENE, choose_motion}, {'2', OF_SCENE, choose_motion}, {'3', OF_SCENE, choose_motion},
                {'b', OF_SCENE, next_backend}, {'v', OF_WINDOW, next_divisor}, {'+', OF_SCENE, change_speed},
                {'=', OF_SCENE, change_speed}, {'-', OF_SCENE, change_speed}, {'z', OF_SCENE, show_other},
                {'i', OF_SCENE, show_other}, {'m', OF_SCENE, toggle_measure}, {'k', OF_SCENE, toggle_film},
                {'f', OF_WINDOW, toggle_rate}, {'g', OF_WINDOW, toggle_graph}, {',', OF_STILL, change_budget},
                {'.', OF_STILL, change_budget}, {'o', OF_SCENE, toggle_levels}, {'l', OF_SCENE, next_tool},
                {'j', OF_SCENE, toggle_front}, {'u', OF_SCENE, undo}, {FXS_KEY_DELETE, OF_SCENE, delete_chosen},
                {FXS_KEY_BACKSPACE, OF_SCENE, delete_chosen}, {'t', OF_WINDOW, toggle_theme},
                {'h', OF_WINDOW, toggle_help}, {'p', OF_SCENE, screenshot}, {' ', OF_MOVING, play},
                {',', OF_MOVING, play_step_frame}, {'.', OF_MOVING, play_step_frame},
                {'[', OF_MOVING, play_change_speed}, {']', OF_MOVING, play_change_speed},
                {'y', OF_MOVING, play_toggle_loop}, {FXS_KEY_ESCAPE, OF_WINDOW, leave}};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
        if (keys[i].key == pressed && has_use(v, keys[i].of)) {
            *v->note = 0;
            v->exposed = 1;
            keys[i].act(v, pressed);
        }
}

static int point_at_handle(viewer *v, const fxs_window_event *event)
{
    v->dragged = v->dragged && event->left;
    if (v->dragged)
        crop_drag(v, event->x, event->y);
    else if (v->crop.on) {
        const int face = event->left || event->other ? CROP_NONE : crop_face_at(v, event->x, event->y);
        v->exposed |= face != v->face;
        v->face = face;
    }
    return v->dragged;
}

/* Handles pointer motion. A drag across the window's height is half a turn. Looking and panning keep the scene under
   the pointer. During a walk, drags look around. */
static void point(viewer *v, const fxs_window_event *event)
{
    int width, height, look = fxs_window_holds(' ');
    if (play_drag(v, event) || point_at_handle(v, event) || edit_drag(v, event))
        return;
    if (look)
        play_undo_space(v);
    fxs_window_size(v->window, &width, &height);
    double turn = acos(-1) / height, pixels = (double)v->view.height / height;
    if (look)
        fxs_motion_look(&v->view, v->up, event->dx * pixels / v->view.fx, event->dy * pixels / v->view.fy);
    else if (walk_is_on(v) && (event->left || event->other))
        fxs_motion_look(&v->view, v->up, event->dx * turn, event->dy * turn);
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
    if (walk_is_on(v)) {
        walk_by_wheel(v, pow(0.9, steps));
        return;
    }
    fxs_motion_zoom(&v->view, &v->distance, fmax(pow(0.9, steps), nearest));
    v->changed = v->moving = 1;
}

static void fly(viewer *v, double seconds)
{
    int right = fxs_window_holds('d') - fxs_window_holds('a'), down = fxs_window_holds('q') - fxs_window_holds('e');
    int forward = fxs_window_holds('w') - fxs_window_holds('s');
    v->flying = right || down || forward;
    if (v->flying) {
        double step = seconds * v->speed * reach(v) * (fxs_window_holds(FXS_KEY_SHIFT) ? 4 : 1);
        fxs_motion_fly(&v->view, right * step, down * step, forward * step);
        v->changed = v->moving = 1;
    }
}

static void press_at(viewer *v, const fxs_window_event *event)
{
    if (play_press(v, event->x, event->y))
        return;
    v->face = v->crop.on ? crop_face_at(v, event->x, event->y) : CROP_NONE;
    v->dragged = v->face != CROP_NONE;
    v->exposed |= v->dragged;
    if (v->edit.tool != EDIT_OFF && !v->dragged)
        edit_press(v, event->x, event->y);
}

static void click(viewer *v, const fxs_window_event *event)
{
    *v->note = 0;
    if (play_release(v) || v->dragged)
        return;
    if (v->edit.tool != EDIT_OFF)
        edit_release(v);
    else if (v->measuring)
        ask_end(v, event->x, event->y);
    else if (event->count == 2)
        ask_focus(v, event->x, event->y);
}

static void open_recent(viewer *v, int i)
{
    if (i >= 0 && i < v->recent.count && !v->loading.on)
        drop(v, v->recent.paths[i]);
}

static void choose_recent(viewer *v, const fxs_window_event *event)
{
    if (event->type == FXS_EVENT_WHEEL || v->help)
        return;
    const int i = viewer_recent_at(v, event->x, event->y);
    if (event->type == FXS_EVENT_CLICK)
        open_recent(v, i);
    v->exposed |= i != v->recent_marked;
    v->recent_marked = i;
}

static void take(viewer *v, const fxs_window_event *event)
{
    switch (event->type) {
    case FXS_EVENT_QUIT: v->quit = 1; break;
    case FXS_EVENT_KEY:
        if (!v->path && event->key >= '0' && event->key <= '9')
            open_recent(v, (event->key - '0' + 9) % 10);
        else
            press(v, event->key);
        break;
    case FXS_EVENT_DROP: drop(v, event->path); break;
    case FXS_EVENT_CHANGED: v->changed = v->exposed = 1; break;
    case FXS_EVENT_POINTER:
    case FXS_EVENT_PRESS:
    case FXS_EVENT_WHEEL:
    case FXS_EVENT_CLICK:
    case FXS_EVENT_RELEASE:
        if (!v->path)
            choose_recent(v, event);
        else if (event->type == FXS_EVENT_POINTER)
            point(v, event);
        else if (event->type == FXS_EVENT_PRESS)
            press_at(v, event);
        else if (event->type == FXS_EVENT_WHEEL)
            zoom(v, event->dy);
        else if (event->type == FXS_EVENT_RELEASE && !play_release(v))
            edit_release(v);
        else if (event->type == FXS_EVENT_CLICK)
            click(v, event);
        break;
    case FXS_EVENT_WOKEN:
    case FXS_EVENT_NONE: break;
    }
}

static int milliseconds_until(uint64_t now, uint64_t then)
{
    return then > now ? (int)((then - now) / 1000000) + 1 : 0;
}

static int time_to_wait(const viewer *v, int milliseconds)
{
    const uint64_t now = fxs_clock(0);
    const int due[] = {v->flying ? milliseconds_until(now, v->clock + FRAME_MS * 1000000) : -1,
                       v->coarse && !v->request_count ? milliseconds_until(now, v->moved + STILL_MS * 1000000) : -1,
                       (v->loading.on && !v->installing) || is_writing(v) || walk_is_making(v) ? LOADING_MS : -1,
                       v->film == FILM_TAKEN && v->way_count < FILM_MOST ? milliseconds_until(now, v->filmed) : -1,
                       play_due(v) ? milliseconds_until(now, play_due(v)) : -1,
                       v->slider ? milliseconds_until(now, v->slider) : -1,
                       v->hint ? milliseconds_until(now, v->hint) : -1};
    for (size_t i = 0; i < sizeof due / sizeof *due; i++)
        if (due[i] >= 0 && (milliseconds < 0 || due[i] < milliseconds))
            milliseconds = due[i];
    return milliseconds;
}

static void move(viewer *v, int milliseconds)
{
    const fxs_view view = v->view;
    const double distance = v->distance;
    fxs_camera camera;
    fxs_message message;
    fxs_window_event event;
    for (int wait = time_to_wait(v, milliseconds); !v->quit && fxs_window_wait(v->window, wait, &event); wait = 0)
        take(v, &event);
    uint64_t now = fxs_clock(0);
    if (v->path)
        (walk_is_on(v) ? walk_by_keys : fly)(v, v->flying ? fmin((double)(now - v->clock) * 1e-9, 0.1)
                                                : FRAME_MS * 1e-3);
    v->clock = now;
    play_advance(v, now);
    v->play.spaced &= fxs_window_holds(' ');
    if (v->moving)
        v->moved = now;
    if (v->path && fxs_camera_from_view(&camera, &v->view, &message)) {   /* goes back if the camera is out of range */
        v->view = view;
        v->distance = distance;
    }
    if (v->film == FILM_TAKEN)
        take_way(v, now);
    if (v->slider && now >= v->slider) {
        v->slider = 0;
        v->exposed = 1;
    }
    if (v->hint && now >= v->hint) {
        v->hint = 0;
        v->exposed = 1;
    }
}

static void take_arrived(viewer *v)
{
    if (v->missing && !v->request_count && __atomic_exchange_n(&v->arrived, 0, __ATOMIC_ACQ_REL))
        v->changed = 1;
}

/* True if the last frame was drawn in a reduced size and the camera has rested for STILL_MS milliseconds. */
static int is_still(const viewer *v)
{
    return v->coarse && v->clock >= v->moved + STILL_MS * 1000000;
}

int viewer_busy(const viewer *v)
{
    return v->loading.on || v->request_count || (v->path && v->changed) || walk_is_making(v);
}

void viewer_step(viewer *v, int milliseconds)
{
    move(v, milliseconds);
    if (v->quit)
        return;
    collect_loaded(v);
    walk_collect(v);
    stop_frame(v);
    if (v->screen_lost)
        lose_screen(v);
    viewer_collect(v);
    take_arrived(v);
    if (v->path && !v->request_count && (v->changed || is_still(v))) {
        ask_frame(v);
        viewer_collect(v);
    }
    v->exposed |= v->loading.on || is_writing(v) || walk_is_making(v);
    if (v->exposed && !v->quit && viewer_show(v)) {
        v->quit = 1;
        v->status = EXIT_FAILED;
    }
    v->exposed = 0;
}

static int has_scenes(const frame_options *options)
{
    return options->world.file || options->world.scene_count;
}

static int start(viewer *v)
{
    fxs_message message;
    v->drawer = fxs_worker_start(fxs_window_wake);
    v->loader = fxs_worker_start(fxs_window_wake);
    v->points = malloc(NEAR_POINTS * sizeof *v->points);
    if (!v->drawer || !v->loader || !v->points)
        return fail(EXIT_FAILED, "no window: out of memory");
    if (fxs_words_open(&v->words, &message))
        fail(0, "%s", message.text);
    fxs_window_resize(v->window, v->options.width ? v->options.width * eyes_of(v) : 1280,
                      v->options.height ? v->options.height : 720);
    v->hint = fxs_clock(0) + HINT_MS * 1000000ull;
    ask_open(v);
    if (has_scenes(&v->options))
        start_loading(v);
    else
        fxs_recent_read(&v->recent);
    return viewer_show(v);
}

int viewer_open(viewer *v, const frame_options *options, const char *screenshot_path, double rate_wanted)
{
    fxs_message message;
    memset(v, 0, sizeof *v);
    v->screenshot = screenshot_path;
    v->divisor = 2;
    v->speed = 0.5;
    v->rate_wanted = rate_wanted;
    v->recent_marked = -1;
    v->options = v->loading.options = *options;
    v->vulkan = fxs_backend_find(options->backend) == fxs_backend_find("vulkan");
    int status = fxs_window_open(&v->window, v->vulkan, &message) ? fail_for(&message) : start(v);
    if (status)
        viewer_close(v);
    return status;
}

static void close_renderers(void *argument)
{
    viewer *v = argument;
    renderer_close(&v->screen_renderer);
    renderer_close(&v->renderer);
}

void viewer_close(viewer *v)
{
    if (v->loader)
        fxs_worker_end(v->loader);
    if (v->drawer) {
        fxs_worker_stop(v->drawer);
        fxs_worker_wait(v->drawer);
        fxs_worker_do(v->drawer, close_renderers, v);
        fxs_worker_end(v->drawer);
    }
    walk_forget(v);
    fxs_worker_end(v->walk.maker);
    if (v->loading.on && !v->loading.status) {
        world_close(&v->loading.world);
        free(v->loading.views);
    }
    free(v->loading.path);
    free(v->loading.next);
    world_close(&v->world);                             /* closed before the window, which threads of the world wake */
    edit_end(&v->edit);
    free(v->edit.stroke);
    fxs_words_close(v->words);
    if (v->window)
        fxs_window_close(v->window);
    picture_free(&v->picture);
    picture_free(&v->drawn);
    fxs_recent_free(&v->recent);
    free(v->points);
    free(v->way);
    free(v->way_times_q32);
    free(v->views);
    free(v->path);
}
