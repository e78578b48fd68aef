/* Walking in the window, as in the page (port/web/viewer/walk.js). The first walk in a scene finds the eye's height on
   the renderer's thread, then makes walls on a thread of its own, or reads them. */
#include "viewer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/system.h>
#include "port/window/motion.h"
#include "tools/command/make_voxels.h"

/* As in the page. CELL to BACK are multiples of the eye's height. */
enum { CELLS = 48, TRIES = 8, NEAR_CELLS = 32 };
#define FOCAL 4096.0
#define CELL (1 / 16.0)
#define FOOT 0.12
#define BACK 0.4
#define BY_ZOOM 4
#define BY_KEY 400

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void add(double out[3], const double a[3], const double b[3], double times)
{
    for (int i = 0; i < 3; i++)
        out[i] = a[i] + times * b[i];
}

static void cross(double out[3], const double a[3], const double b[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static void unit(double out[3], const double a[3])
{
    const double zero[3] = {0, 0, 0};
    add(out, zero, a, 1 / sqrt(dot(a, a)));
}

/* Computes the horizontal direction of view. If the view goes straight up or down, its down axis gives it. */
static void level_of(const viewer *v, double level[3])
{
    const double *up = v->walk.walker.up, *ahead = v->view.rotation + 6, *down = v->view.rotation + 3;
    const double along = dot(ahead, up);
    add(level, ahead, up, -along);
    if (dot(level, level) < 1e-6) {
        for (int i = 0; i < 3; i++)
            level[i] = along > 0 ? down[i] : -down[i];
        add(level, level, up, -dot(level, up));
    }
    unit(level, level);
}

/* ---- The eye's height -------------------------------------------------------------------------------------------- */

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Makes an orthographic view straight down from a place. */
static fxs_view view_down(const viewer *v, const double place[3], double height)
{
    const double *up = v->walk.walker.up, x[3] = {1, 0, 0}, z[3] = {0, 0, 1};
    fxs_view view = v->views[v->index];
    const double *aside = fabs(up[0]) < 0.9 ? x : z;
    double *right = view.rotation, *forward = view.rotation + 6;
    view.width = view.height = CELLS;
    view.cx = view.cy = CELLS / 2;
    view.fx = view.fy = fmax(1, floor(FOCAL / (CELL * height) + 0.5)) / FOCAL;
    view.near = height / 50;
    view.projection = FXS_ORTHOGRAPHIC;
    memcpy(view.position, place, sizeof view.position);
    add(right, aside, up, -dot(aside, up));
    unit(right, right);
    for (int i = 0; i < 3; i++)
        forward[i] = -up[i];
    cross(view.rotation + 3, forward, right);
    return view;
}

/* Finds how far the ground is below a place: the mean of the middle half of the depths around it. Returns 0 if there is
   none. */
static int find_ground(viewer *v, const request *r, const double place[3], double height, double *below)
{
    const fxs_view view = view_down(v, place, height);
    const double far = FOOT * height * view.fx;
    renderer small = v->renderer;
    picture p = {.pixels = 0};
    double list[NEAR_CELLS], sum = 0;
    int count = 0;
    small.draws = DRAW_MEDIAN_DEPTH;
    small.stereo = 0;
    if (!(small.backend->can & FXS_CAN_TRACE) || renderer_render(&small, &v->world, &view, &r->render, &p, 0))
        return 0;
    for (int y = 0; y < CELLS; y++)
        for (int x = 0; x < CELLS; x++)
            if (hypot(x + 0.5 - view.cx, y + 0.5 - view.cy) <= far && p.depths[CELLS * y + x] != FXS_NOTHING &&
                count < NEAR_CELLS)
                list[count++] = ldexp(p.depths[CELLS * y + x], -p.depth_bits);
    picture_free(&p);
    qsort(list, (size_t)count, sizeof *list, ascending);
    for (int i = count / 4; i < count - count / 4; i++)
        sum += list[i];
    *below = count ? sum / (count - count / 4 * 2) : 0;
    return count > 0;
}

/* Estimates the eye's height above the ground from the view that the scene was made for, else as an eighth of the
   scene's height. */
static void find_height(viewer *v, request *r)
{
    const double *low = v->world.inner_low, *high = v->world.inner_high;
    const fxs_opened *opened = v->world.scenes[0].opened;
    double tall = 0, below = 0;
    fxs_view start;
    for (int i = 0; i < 3; i++)
        tall += fabs(v->walk.walker.up[i]) * (high[i] - low[i]);
    tall = fmax(tall, 1e-3);
    const int is_taken = v->options.cameras || v->options.eye.given || fxs_view_of_start(&start, opened->data, 64, 48);
    if (v->walk.height_given > 0)
        v->walk.walker.height = v->walk.height_given;
    else if (is_taken && find_ground(v, r, v->views[v->index].position, tall / 16, &below))
        v->walk.walker.height = fmax(fmin(below, tall / 2), tall / 100);
    else
        v->walk.walker.height = tall / 8;
}

/* ---- Walls ------------------------------------------------------------------------------------------------------- */

static int make_from(viewer *v, const loaded_scene *scene)
{
    const double h = v->walk.walker.height;
    frame_options how = v->walk.options;
    const voxel_options o = {.voxel = h / 32, .radius = h / 8, .height = h, .from = v->walk.seed,
                             .hint = ": fly to a free place first"};
    how.load.progress = (fxs_progress){fxs_worker_tell, v->walk.maker};
    return make_voxels(&v->walk.voxels, &o, scene, &how);
}

static int make(viewer *v)
{
    load_options load = v->walk.options.load;
    world merged;
    fxs_message why;
    if (v->walk.file)
        return fxs_voxels_read(&v->walk.voxels, v->walk.file, &why) ? fail_for(&why) : 0;
    if (world_is_paged(&v->world))
        return fail(EXIT_FAILED, "no walls of a scene in parts: make them with fixsplat collide, for --walls");
    if (!v->options.world.file && !v->options.world.place_count && v->world.placed.file_count == 1)
        return make_from(v, &v->world.scenes[0]);
    load.again = 1;
    if (world_open_merged(&merged, &v->world.placed, v->path, &load))
        return EXIT_FAILED;
    const int status = make_from(v, &merged.scenes[0]);
    world_close(&merged);
    return status;
}

/* Runs on the maker's thread. */
static void make_walls(void *argument)
{
    viewer *v = argument;
    const size_t length = strlen(v->path);
    v->walk.status = make(v);
    if (!v->walk.status)
        return;
    const char *why = last_failure();
    if (!strncmp(why, v->path, length))
        why += viewer_file_name(v->path) - v->path;
    snprintf(v->walk.why, sizeof v->walk.why, "%.255s", why);
}

static void take_height(viewer *v, request *r)
{
    (void)r;
    if (v->walk.state != WALK_ASKED)
        return;
    v->walk.state = WALK_MAKING;
    v->walk.options = v->options;
    memcpy(v->walk.seed, v->view.position, sizeof v->walk.seed);
    fxs_worker_do(v->walk.maker, make_walls, v);
}

static void make_again(viewer *v)
{
    if (!v->walk.maker)
        v->walk.maker = fxs_worker_start(fxs_window_wake);
    fxs_voxels_free(v->walk.voxels);
    v->walk.voxels = 0;
    v->walk.state = v->walk.maker && ask(v, find_height, take_height, 1) ? WALK_ASKED : WALK_OFF;
    v->walk.is_new = 1;
    v->exposed = 1;
}

/* ---- Places ------------------------------------------------------------------------------------------------------ */

/* Turns the view upright, with its direction at most 45 degrees up or down, and moves it to the walker's eye. */
static void take_eye(viewer *v)
{
    const double *up = v->walk.walker.up;
    double level[3], ahead[3], *r = v->view.rotation;
    level_of(v, level);
    const double rise = dot(r + 6, up), far = sqrt(fmax(1 - rise * rise, 0));
    add(ahead, level, up, fmax(-1, fmin(rise / fmax(far, 1e-3), 1)));
    unit(r + 6, ahead);
    cross(r, r + 6, up);
    unit(r, r);
    cross(r + 3, r + 6, r);
    memcpy(v->view.position, v->walk.walker.eye, sizeof v->view.position);
    v->distance = fmax(v->distance, v->walk.walker.height);
    v->changed = v->flying = 1;
}

/* Stands below the camera, else on the way to the pivot. Returns 0 if there is no room. */
static int stand(viewer *v)
{
    double level[3], place[3];
    level_of(v, level);
    const double far = v->distance * dot(v->view.rotation + 6, level);
    for (int i = 0; i <= TRIES; i++) {
        add(place, v->view.position, level, far * i / TRIES);
        if (fxs_walker_place(&v->walk.walker, v->walk.voxels, place)) {
            take_eye(v);
            return 1;
        }
    }
    return 0;
}

/* Begins to walk with the walls that are there. If they have no room at the camera, makes others from there. */
static void begin(viewer *v)
{
    if (stand(v)) {
        v->walk.state = WALK_ON;
        v->walk.is_new = 0;
    } else if (!v->walk.is_new && !v->walk.file)
        make_again(v);
    else {
        v->walk.state = WALK_OFF;
        v->walk.is_new = 0;
        tell(v, "no room to stand here: fly to a free place first");
    }
}

/* ---- Actions ----------------------------------------------------------------------------------------------------- */

int walk_is_on(const viewer *v)
{
    return v->walk.state == WALK_ON;
}

int walk_is_making(const viewer *v)
{
    return v->walk.state == WALK_ASKED || v->walk.state == WALK_MAKING;
}

void walk_start(viewer *v)
{
    if (v->walk.state != WALK_OFF)
        return;
    if (play_moves(v))
        tell(v, "a scene that moves has no walls");
    else if (v->view.projection == FXS_ORTHOGRAPHIC)
        tell(v, "walking needs perspective: open the scene without --ortho");
    else {
        v->walk.walker.size = sizeof v->walk.walker;
        unit(v->walk.walker.up, v->up);
        if (v->walk.voxels)
            begin(v);
        else
            make_again(v);
    }
}

int walk_stop(viewer *v)
{
    const int was = v->walk.state != WALK_OFF;
    if (v->walk.state == WALK_MAKING)
        fxs_worker_stop(v->walk.maker);
    else
        v->walk.state = WALK_OFF;
    v->exposed = 1;
    return was;
}

void walk_collect(viewer *v)
{
    if (v->walk.state != WALK_MAKING || fxs_worker_busy(v->walk.maker))
        return;
    v->walk.state = WALK_OFF;
    v->exposed = 1;
    if (fxs_worker_stopped(v->walk.maker))
        tell(v, "no walls made");
    else if (v->walk.status)
        tell(v, v->walk.why);
    else
        begin(v);
}

void walk_forget(viewer *v)
{
    if (v->walk.state == WALK_MAKING) {
        fxs_worker_stop(v->walk.maker);
        fxs_worker_wait(v->walk.maker);
    }
    v->walk.state = WALK_OFF;
    v->walk.is_new = 0;
    fxs_voxels_free(v->walk.voxels);
    v->walk.voxels = 0;
}

double walk_speed(const viewer *v)
{
    return v->speed * FXS_WALKER_PACE * v->walk.walker.height;
}

/* Walks to the right and ahead, seconds at full speed, and lets time pass. If another action moved the camera, stands
   there first. */
static void go(viewer *v, double right, double forward, double seconds)
{
    fxs_walker *w = &v->walk.walker;
    double level[3], aside[3], way[3] = {0, 0, 0};
    const int is_elsewhere = memcmp(v->view.position, w->eye, sizeof w->eye) != 0;
    if (is_elsewhere && !(right || forward))
        return;
    if (is_elsewhere && !stand(v)) {
        walk_stop(v);
        tell(v, "no room to stand here");
        return;
    }
    level_of(v, level);
    cross(aside, level, w->up);
    add(way, way, level, forward * walk_speed(v));
    add(way, way, aside, right * walk_speed(v));
    const int moves = fxs_walker_move(w, v->walk.voxels, way, seconds);
    v->flying = moves || right || forward;
    if (memcmp(v->view.position, w->eye, sizeof w->eye)) {
        memcpy(v->view.position, w->eye, sizeof w->eye);
        v->changed = v->moving = 1;
    }
}

void walk_by_keys(viewer *v, double seconds)
{
    const double fast = seconds * (fxs_window_holds(FXS_KEY_SHIFT) ? 4 : 1);
    const int right = fxs_window_holds('d') - fxs_window_holds('a') + fxs_window_holds(FXS_KEY_RIGHT) -
                      fxs_window_holds(FXS_KEY_LEFT);
    const int forward = fxs_window_holds('w') - fxs_window_holds('s') + fxs_window_holds(FXS_KEY_UP) -
                        fxs_window_holds(FXS_KEY_DOWN);
    const int turn = fxs_window_holds('e') - fxs_window_holds('q');
    int width, height;
    go(v, right * fast, forward * fast, seconds);
    fxs_window_size(v->window, &width, &height);
    if (turn) {
        fxs_motion_look(&v->view, v->up, turn * BY_KEY * fxs_window_scale(v->window) * fast * acos(-1) / height, 0);
        v->changed = v->moving = v->flying = 1;
    }
}

void walk_by_wheel(viewer *v, double factor)
{
    go(v, 0, BY_ZOOM * (1 - factor), 0);
    v->flying = 1;
}

void walk_to(viewer *v, const double point[3])
{
    fxs_walker *w = &v->walk.walker;
    double level[3], place[3];
    level_of(v, level);
    add(place, point, level, -BACK * w->height);
    add(place, place, w->up, w->height);
    if (fxs_walker_place(w, v->walk.voxels, place))
        take_eye(v);
    else
        tell(v, "no room to stand there");
}
