/* Chooses the views to draw: the views of a camera file that --view lists, a look-at camera, the scene's start view,
   or the view that shows most of the scene. Makes the frames of a film (--orbit, --path). */
#include "views.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/renderer.h>
#include <fixsplat/internal/pager_more.h>
#include <fixsplat/internal/parts.h>
#include <fixsplat/internal/placements.h>
#include <fixsplat/internal/view_more.h>
#include "src/camera/lens_file.h"
#include "src/camera/path.h"

enum { VIEWS_MOST = 100000, SIDES = 32 };
#define FARTHER_MOST 8.0

/* Parses the number of a view, from 0 to count - 1. Returns the text after the number; null: invalid. */
static const char *take_view(const char *text, long count, long *number)
{
    char *end;
    if (!isdigit((unsigned char)*text))
        return 0;
    *number = strtol(text, &end, 10);
    return *number < count ? end : 0;
}

static const char *take_part(const char *text, long count, long *first, long *last)
{
    text = take_view(text, count, first);
    *last = text ? *first : 0;
    return text && !strncmp(text, "..", 2) ? take_view(text + 2, count, last) : text;
}

/* Parses a list of view numbers and ranges. Returns its length; 0: invalid text; -1: out of memory. */
static long take_list(const char *text, long count, long **chosen)
{
    long found = 0, first, last;
    for (*chosen = 0;; text++) {
        text = take_part(text, count, &first, &last);
        if (!text || (*text && *text != ',') || found + labs(last - first) >= VIEWS_MOST)
            return 0;
        const long length = labs(last - first) + 1;
        long *larger = realloc(*chosen, (size_t)(found + length) * sizeof *larger);
        if (!larger)
            return -1;
        *chosen = larger;
        for (long i = 0; i < length; i++)
            larger[found++] = first < last ? first + i : first - i;
        if (!*text)
            return found;
    }
}

int names_several(const char *view)
{
    return view && (!strcmp(view, "all") || ((strchr(view, ',') || strstr(view, "..")) &&
                                             !view[strspn(view, "0123456789,.")]));
}

/* True if a view has this name. A \ in the view's name also matches a / in `name`. */
static int has_slashes_as(const char *view, const char *name)
{
    while (*view && (*view == *name || (*view == '\\' && *name == '/'))) {
        view++;
        name++;
    }
    return !*view && !*name;
}

long find_view(const frame_options *options, const fxs_view *views, long count)
{
    const char *wanted = options->view ? options->view : "0";
    uint64_t number;
    for (int with_slashes = 0; with_slashes < 2; with_slashes++)
        for (long i = 0; i < count; i++)
            if (with_slashes ? has_slashes_as(views[i].name, wanted) : !strcmp(views[i].name, wanted))
                return i;
    if (parse_count(wanted, 0, (uint64_t)count - 1, &number))
        return (long)number;
    return fail(-1, "%s: no view '%s' (there are %ld, from 0 on)", options->cameras, wanted, count);
}

static long take_one(const frame_options *options, const fxs_view *views, long count, long **chosen)
{
    const long index = find_view(options, views, count);
    if (index < 0)
        return 0;
    *chosen = malloc(sizeof **chosen);
    if (!*chosen)
        return -1;
    **chosen = index;
    return 1;
}

/* Allocates the numbers of the views that option --view names, and returns their count. On failure returns -1, and
   *chosen is null. */
static long views_of_list(const frame_options *options, const fxs_view *views, long count, long **chosen)
{
    const int several = names_several(options->view);
    *chosen = 0;
    const long found = several ? take_list(options->view, count, chosen) : take_one(options, views, count, chosen);
    if (found > 0)
        return found;
    free(*chosen);
    *chosen = 0;
    if (found < 0)
        fail(-1, "out of memory: the views of %s", options->cameras);
    else if (several)
        fail(-1, "%s: no views '%s': expected numbers from 0 to %ld as 8..40 or 0,8,40", options->cameras,
             options->view, count - 1);
    return -1;
}

static int width_of(const frame_options *options)
{
    return options->width ? options->width : options->panorama ? 2048 : 1280;
}

static int height_of(const frame_options *options)
{
    return options->height ? options->height : options->panorama ? 1024 : 720;
}

/* Computes the start view of a single scene. Returns 0 if the scene has no start view or an option asks for another
   camera. */
static int has_start(const frame_options *o, const world *w, fxs_view *view)
{
    return !o->auto_up && o->fov <= 0 && w->count == 1 && fxs_placement_is_plain(w->placed.objects) &&
           fxs_view_of_start(view, w->scenes[0].opened->data, width_of(o), height_of(o));
}

/* True if the scene's visible part lies within the picture from every side of an orbit. Sets *is_outside to 0 if the
   orbit passes through the visible part, as in a room. */
static int is_seen_around(const world *w, const fxs_view *first, const double middle[3], const double up[3],
                          int *is_outside)
{
    for (int i = 0; i < SIDES; i++) {
        fxs_view view = *first;
        if (i)
            fxs_view_orbit(&view, middle, up, 6.283185307179586 * i / SIDES);
        const double right = fxs_view_reach(&view, w->inner_low, w->inner_high, 0);
        const double down = fxs_view_reach(&view, w->inner_low, w->inner_high, 1);
        *is_outside &= right > 0;
        if (right > view.width / 2.0 / view.fx || down > view.height / 2.0 / view.fy)
            return 0;
    }
    return 1;
}

/* Moves the first view of an orbit away from the middle, at most FARTHER_MOST times as far, until the scene's visible
   part lies within the picture from every side. */
static void move_away(const world *w, fxs_view *first, const double middle[3], const double up[3])
{
    const fxs_view near = *first;
    int is_outside = 1;
    for (double times = 1; times < FARTHER_MOST && is_outside; times *= 1.02) {
        for (int i = 0; i < 3; i++)
            first->position[i] = middle[i] + times * (near.position[i] - middle[i]);
        if (is_seen_around(w, first, middle, up, &is_outside))
            return;
    }
    *first = near;
}

int views_per_frame(const frame_options *options)
{
    return options->shutter > 0 ? options->samples : 1;
}

/* Returns the time of a film's view, in frames: the middle of one of the equal parts of the time around the frame in
   which the shutter is open. */
static double time_of(const frame_options *o, long i)
{
    const long parts = views_per_frame(o);
    return (double)(i / parts) + o->shutter / 360 * (((double)(i % parts) + 0.5) / (double)parts - 0.5);
}

static void turn(const frame_options *o, const world *w, fxs_view *first, fxs_view *frames)
{
    double middle[3];
    fxs_view start;
    for (int i = 0; i < 3; i++)
        middle[i] = (w->inner_low[i] + w->inner_high[i]) / 2;
    if (!o->cameras && !o->eye.given && !has_start(o, w, &start) && first->projection == FXS_PERSPECTIVE)
        move_away(w, first, middle, o->up.at);
    for (long i = 0; i < o->orbit * views_per_frame(o); i++) {
        const double time = time_of(o, i);
        frames[i] = *first;
        if (time < 0 || time > 0)
            fxs_view_orbit(&frames[i], middle, o->up.at, 6.283185307179586 * time / (double)o->orbit);
    }
}

/* Replaces the first view by the views of an orbit. Returns their number. On failure returns -1, and *views is null. */
static long views_of_orbit(const frame_options *options, const world *w, fxs_view **views, long count)
{
    const long frames = (long)options->orbit * views_per_frame(options);
    fxs_view *made = 0;
    if (count > 1)
        fail(-1, "--orbit begins at one view, --view %s are %ld", options->view, count);
    else if (!(made = calloc((size_t)frames, sizeof *made)))
        fail(-1, "out of memory: %ld views of a film", frames);
    else
        turn(options, w, *views, made);
    free(*views);
    *views = made;
    return made ? frames : -1;
}

/* Keeps only the views that option --view names, in new arrays. Returns their number; -1: failure. */
static long keep_named(const frame_options *options, fxs_view **views, fxs_lens **lenses, long count)
{
    long *chosen;
    count = views_of_list(options, *views, count, &chosen);
    if (count < 0)
        return -1;
    fxs_view *kept = malloc((size_t)count * sizeof *kept);
    fxs_lens *kept_lenses = malloc((size_t)count * sizeof *kept_lenses);
    const int memory = kept && kept_lenses;
    for (long i = 0; i < count && memory; i++) {
        kept[i] = (*views)[chosen[i]];
        kept_lenses[i] = (*lenses)[chosen[i]];
    }
    free(chosen);
    free(memory ? *views : kept);
    free(memory ? *lenses : kept_lenses);
    if (!memory)
        return fail(-1, "out of memory: the views of %s", options->cameras);
    *views = kept;
    *lenses = kept_lenses;
    return count;
}

static void say_bent(const frame_options *options, const fxs_view *views, long count)
{
    long bent = 0;
    for (long i = 0; i < count; i++)
        bent += views[i].bends;
    if (bent)
        note("%s: %ld of %ld views have a lens that bends: they are drawn as by a pinhole; render --lens draws them as "
             "it does", options->cameras, bent, count);
}

static long views_of_file(const frame_options *options, fxs_view **views, fxs_lens **lenses)
{
    const int sized = options->width || options->panorama;
    fxs_message message;
    long count = fxs_lens_file_read(options->cameras, sized ? width_of(options) : 0, sized ? height_of(options) : 0,
                                    views, lenses, &message);
    if (count < 0)
        return fail(-1, "%s", message.text);
    if (!options->view || strcmp(options->view, "all")) {
        const long kept = keep_named(options, views, lenses, count);
        if (kept < 0) {
            free(*views);
            free(*lenses);
            *views = 0;
            *lenses = 0;
        }
        count = kept;
    }
    if (count > 0 && !options->lens)
        say_bent(options, *views, count);
    return count;
}

/* Reads the keys of a path: of a settings file, of a text, or the views of a camera file. */
static int read_path(const frame_options *o, fxs_path *path)
{
    frame_options of_file = *o;
    fxs_message message;
    fxs_view *views;
    fxs_lens *lenses;
    const int read = fxs_path_read(path, o->path, o->track, o->up.at, &message);
    if (read < 0)
        return fail(-1, "%s", message.text);
    if (read)
        return o->view ? fail(-1, "--view is for camera files, not for %s", o->path) : 0;
    if (o->track)
        return fail(-1, "--track is for a settings.json, not for %s", o->path);
    of_file.cameras = o->path;
    of_file.lens = 1;                   /* no note about lenses: a film is that of a pinhole */
    of_file.view = o->view ? o->view : "all";
    const long count = views_of_file(&of_file, &views, &lenses);
    if (count < 0)
        return -1;
    for (long i = 1; i < count; i++)
        if (views[i].width != views->width || views[i].height != views->height)
            fxs_view_resize(&views[i], views->width, views->height);
    const int error = fxs_path_of_views(path, views, count, &message);
    free(views);
    free(lenses);
    return error ? fail(-1, "%s: %s", o->path, message.text) : 0;
}

static double radius_of(const world *w)
{
    double square = 0;
    for (int i = 0; i < 3; i++)
        square += (w->inner_high[i] - w->inner_low[i]) * (w->inner_high[i] - w->inner_low[i]);
    return square > 0 ? sqrt(square) / 2 : 1;
}

/* Decides how many frames the film along a path has. Returns 0 on failure. */
static int count_frames(const frame_options *o, const world *w, fxs_path *path)
{
    const double rate = (double)o->rate[0] / o->rate[1];
    const int is_even = o->frames || o->seconds > 0;
    const double seconds = o->frames ? o->frames / rate : is_even ? o->seconds : path->end * (1 + path->returns);
    const double count = fmax(floor(seconds * rate + 0.5), 2);
    fxs_message message;
    if (!is_even && !path->timed)
        return fail(0, "%s: its keys have no times: give --seconds", o->path);
    if (count > VIEWS_MOST)
        return fail(0, "%s: a film of %.0f frames: at most %d", o->path, count, VIEWS_MOST);
    path->rate = rate;
    if (is_even && fxs_path_even(path, radius_of(w), (long)count, seconds, &message))
        return fail(0, "%s: %s", o->path, message.text);
    if (is_even && path->timed)
        note("%s: the times of its keys are ignored, for an even speed; without --%s they are kept", o->path,
             o->frames ? "frames" : "seconds");
    return (int)count;
}

/* Makes the frames of the film along a path. */
static long views_of_path(frame_options *o, const world *w, fxs_view **views)
{
    fxs_message message;
    fxs_path path = {.count = 0};
    int error = read_path(o, &path);
    path.frame.width = path.of_views ? path.frame.width : width_of(o);
    path.frame.height = path.of_views ? path.frame.height : height_of(o);
    path.frame.near = fxs_near_of_box(w->inner_low, w->inner_high);
    o->frames = error ? 0 : count_frames(o, w, &path);
    long count = (long)o->frames * views_per_frame(o);
    if (count && !(*views = calloc((size_t)count, sizeof **views)))
        count = fail(0, "out of memory: %ld views of a film", count);
    for (long i = 0; i < count; i++)
        if (fxs_path_view(&path, time_of(o, i), &(*views)[i], &message))
            count = fail(0, "%s: frame %ld: %s", o->path, i / views_per_frame(o), message.text);
    fxs_path_free(&path);
    return count ? count : -1;
}

/* Finds the look-at point: the value of --look, else a point level ahead for a panorama, else the scene's middle. */
static void find_target(const frame_options *options, const double middle[3], const double eye[3], double target[3])
{
    const double *up = options->up.at;
    const int across = fabs(up[2]) > fabs(up[1]) ? 1 : 2;
    for (int i = 0; i < 3; i++)
        target[i] = options->look.given ? options->look.at[i] : options->panorama ? eye[i] + (i == across) : middle[i];
}

static int is_chosen(const frame_options *o)
{
    return !o->cameras && !o->path && !o->eye.given && !o->panorama && !o->up.given && !o->framed;
}

static double fov_of(const frame_options *o)
{
    return o->fov > 0 ? o->fov : 50;
}

/* Chooses the first view of a world (placed scenes) that is wholly in memory. If is_up is 0, also finds the up
   direction. */
static int choose_first(frame_options *o, const world *w, int is_up, const fxs_object *objects, fxs_view *view,
                        fxs_message *message)
{
    const fxs_picture picture = {fov_of(o), width_of(o), height_of(o)};
    double box[2][3], up[3] = {0};
    memcpy(box[0], w->inner_low, sizeof box[0]);
    memcpy(box[1], w->inner_high, sizeof box[1]);
    if (is_up)
        memcpy(up, o->up.at, sizeof up);
    const int error = fxs_first_view(objects, w->count, box, up, &picture, view, message);
    if (!error && !is_up)
        memcpy(o->up.at, up, sizeof up);
    return error;
}

/* Chooses a view of a paged world, which is only partly in memory. The choice needs whole scenes, so their files are
   mapped meanwhile. */
static int choose_by_files(frame_options *o, const world *w, int is_up, fxs_view *view, fxs_message *message)
{
    fxs_opened **opened = calloc(w->placed.file_count, sizeof *opened);
    fxs_object *objects = malloc(w->count * sizeof *objects);
    int error = opened && objects ? 0 : fxs_fail_memory(message, 0, 0);
    for (uint32_t i = 0; i < w->placed.file_count && !error; i++)
        if (w->scenes[i].opened->pager)
            error = fxs_open(w->placed.files[i], 0, &opened[i], message);
    for (uint32_t i = 0; i < w->count && !error; i++) {
        const fxs_opened *whole = opened[w->placed.objects[i].file];
        objects[i] = w->objects[i];
        objects[i].scene = whole ? whole->scene : objects[i].scene;
    }
    error = error ? error : choose_first(o, w, is_up, objects, view, message);
    for (uint32_t i = 0; i < w->placed.file_count && opened; i++)
        fxs_close(opened[i]);
    free(opened);
    free(objects);
    return error;
}

static int is_of_server(const world *w)
{
    for (uint32_t i = 0; i < w->placed.file_count; i++)
        if (fxs_pager_is_url(w->placed.files[i]))
            return 1;
    return 0;
}

/* Chooses the start view of a scene, else the view that shows most of it. A scene from a server is framed by its
   bounds, to avoid reading all of it. */
static int look_at_scene(frame_options *o, const world *w, int is_up, fxs_view *view, fxs_message *message)
{
    if (!has_start(o, w, view) && is_of_server(w)) {
        note("%s: has no start view, so it is framed whole; convert --start-view gives it one", w->placed.files[0]);
        return fxs_view_frame_box(view, w->inner_low, w->inner_high, o->up.at, &(fxs_picture){fov_of(o), width_of(o),
                                                                                              height_of(o)}, message);
    }
    if (!has_start(o, w, view))
        return world_is_paged(w) ? choose_by_files(o, w, is_up, view, message)
                                 : choose_first(o, w, is_up, w->objects, view, message);
    if (!is_up)
        fxs_view_up(view, o->up.at);
    view->near = fxs_near_of_box(w->inner_low, w->inner_high);
    return 0;
}

static int make_view(const frame_options *options, const world *w, fxs_view *view, fxs_message *message)
{
    const int width = width_of(options), height = height_of(options);
    const double fov = fov_of(options);
    double middle[3], target[3];
    int result;
    for (int i = 0; i < 3; i++)
        middle[i] = (w->inner_low[i] + w->inner_high[i]) / 2;
    if (options->eye.given || options->panorama) {
        const double *eye = options->eye.given ? options->eye.at : middle;
        find_target(options, middle, eye, target);
        result = fxs_view_look_at(view, eye, target, options->up.at, &(fxs_picture){fov, width, height}, message);
    } else {
        result = fxs_view_frame_box(view, w->inner_low, w->inner_high, options->up.at,
                                    &(fxs_picture){fov, width, height}, message);
    }
    view->near = fxs_near_of_box(w->inner_low, w->inner_high);
    return result;
}

static int make_level(fxs_view *view, const frame_options *options, fxs_message *message)
{
    const double *forward = view->rotation + 6, *up = options->up.at, *eye = view->position;
    const fxs_view old = *view;
    double square = 0, along = 0, target[3];
    for (int i = 0; i < 3; i++) {
        square += up[i] * up[i];
        along += up[i] * forward[i];
    }
    for (int i = 0; i < 3; i++)
        target[i] = eye[i] + forward[i] - (square > 0 ? along / square * up[i] : 0);
    if (fxs_view_look_at(view, old.position, target, up, &(fxs_picture){90, old.width, old.height}, message))
        return -1;
    memcpy(view->name, old.name, sizeof view->name);
    view->near = old.near;
    return 0;
}

static int finish_view(const frame_options *options, fxs_view *view, fxs_message *message)
{
    fxs_camera camera;
    if (options->near > 0)
        view->near = options->near;
    if (options->ortho > 0) {
        view->projection = FXS_ORTHOGRAPHIC;
        view->fx = view->fy = view->height / options->ortho;
    }
    if (options->has_tangents && fxs_view_set_tangents(view, options->tangents, message))
        return -1;
    const int upright = !options->cameras || options->up.given || options->auto_up;
    if (options->panorama && upright && make_level(view, options, message))
        return -1;
    return options->cameras || options->path ? fxs_camera_from_view(&camera, view, message) : 0;
}

static long choose(frame_options *options, const world *w, fxs_view **views, fxs_lens **lenses)
{
    fxs_message message;
    fxs_view first;
    const int is_up = !options->up.given && world_up(w, options->up.at);
    long count = options->cameras ? views_of_file(options, views, lenses)
                 : options->path  ? views_of_path(options, w, views) : 1;
    if (count < 0)
        return -1;
    int result = (options->auto_up && !is_up) || is_chosen(options) ? look_at_scene(options, w, is_up, &first, &message)
                                                                    : 0;
    if (!options->cameras && !options->path && !result) {
        *views = malloc(sizeof **views);
        result = *views ? 0 : fxs_fail(&message, "out of memory");
        if (!result && is_chosen(options))
            **views = first;
        else if (!result)
            result = make_view(options, w, *views, &message);
    }
    for (long i = 0; i < count && !result; i++)
        result = finish_view(options, &(*views)[i], &message);
    if (!result)
        return options->orbit ? views_of_orbit(options, w, views, count) : count;
    free(*views);
    *views = 0;
    const char *file = options->cameras ? options->cameras : options->path;
    return file ? fail(-1, "%s: %s", file, message.text) : fail(-1, "%s", message.text);
}

long choose_views(frame_options *options, const world *w, fxs_view **views, fxs_lens **lenses)
{
    fxs_lens *found = 0;
    const long count = choose(options, w, views, &found);
    if (count > 0 && lenses && !options->orbit)
        *lenses = found;
    else
        free(found);
    return count;
}
