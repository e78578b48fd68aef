/* Groups the photographs of a moving scene by moment, and checks that each camera takes one at each. */
#include "moments.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/message.h>
#include "src/base/files_internal.h"
#include "src/base/try_internal.h"
#include "src/image/photograph.h"
#include "photo_masks.h"
#include "photos_internal.h"

#define FPS 30.0
#define SAME 1e-4                  /* a camera that moves or turns by less, relative to its distance from the origin or
                                      to 1, stands still */

struct fxs_moments {
    fxs_photo_list list;
    const fxs_photos_options *photos;
    double *times;
    size_t *held;                  /* index of the first held-out photograph of each moment, and their number */
    size_t count, cameras;         /* numbers of moments, and of fitted photographs of each */
};

/* ---- A folder for each camera ------------------------------------------------------------------------------------ */

typedef struct file_names {
    char **names;
    size_t count, room;
    int error;
} file_names;

static void free_names(file_names *n)
{
    for (size_t i = 0; i < n->count; i++)
        free(n->names[i]);
    free(n->names);
    memset(n, 0, sizeof *n);
}

static void add_photograph(void *argument, const char *name)
{
    file_names *n = argument;
    if (!fxs_photograph_kind_of(name) || n->error)
        return;
    if (n->count == n->room) {
        const size_t room = 2 * n->room + 64;
        char **larger = realloc(n->names, room * sizeof *larger);
        n->names = larger ? larger : n->names;
        n->room = larger ? room : n->room;
    }
    char *copy = n->count < n->room ? malloc(strlen(name) + 1) : NULL;
    n->error = !copy;
    if (copy)
        n->names[n->count++] = strcpy(copy, name);
}

/* Returns the digits of the last number in a name, without leading zeros. */
static const char *last_number(const char *name, size_t *digits)
{
    const char *end = name + strlen(name);
    while (end > name && !isdigit((unsigned char)end[-1]))
        end--;
    const char *first = end;
    while (first > name && isdigit((unsigned char)first[-1]))
        first--;
    while (first < end && *first == '0')
        first++;
    *digits = (size_t)(end - first);
    return first;
}

static int compare_names(const void *a, const void *b)
{
    const char *names[2] = {*(char *const *)a, *(char *const *)b}, *numbers[2];
    size_t digits[2];
    for (int i = 0; i < 2; i++)
        numbers[i] = last_number(names[i], &digits[i]);
    if (digits[0] != digits[1])
        return digits[0] < digits[1] ? -1 : 1;
    const int order = memcmp(numbers[0], numbers[1], digits[0]);
    return order ? order : strcmp(names[0], names[1]);
}

/* Finds the folder of a camera's photographs. `name`: the camera's image, NAME.png or NAME/FILE.png. */
static int find_folder(const fxs_photo_list *list, const fxs_moments_options *o, const char *name,
                       char folder[FXS_PHOTO_PATH])
{
    const char *slash = strrchr(name, '/'), *dot = strrchr(slash ? slash : name, '.');
    const int stem = (int)(slash ? slash - name : dot ? dot - name : (ptrdiff_t)strlen(name));
    const char *const places[] = {o->frames ? o->frames : list->images, o->frames ? NULL : list->images};
    for (int i = 0; i < 2 && places[i]; i++) {
        size_t named = strlen(places[i]);
        while (named > 1 && places[i][named - 1] == '/')
            named--;
        const int length = snprintf(folder, FXS_PHOTO_PATH, "%.*s%s%.*s", (int)named, places[i], i ? "/../" : "/", stem,
                                    name);
        if (length > 0 && length < FXS_PHOTO_PATH && fxs_file_kind(folder) == FXS_FILE_FOLDER)
            return 1;
    }
    return 0;
}

static int list_folder(const char *folder, file_names *names, fxs_message *message)
{
    fxs_folder_each(folder, add_photograph, names);
    if (names->error)
        return fxs_fail_memory(message, folder, 0);
    if (names->count)
        qsort(names->names, names->count, sizeof *names->names, compare_names);
    return 0;
}

static int add_view(fxs_view_list *list, const fxs_listed_view *camera, const char *folder, const char *name,
                    double time)
{
    char path[FXS_PHOTO_PATH];
    fxs_listed_view *view;
    if (snprintf(path, sizeof path, "%s/%s", folder, name) >= (int)sizeof path)
        return fxs_fail(list->message, "%s: a name of %zu characters is too long", folder, strlen(name));
    FXS_TRY(fxs_view_list_add(list, path, &view));
    char *const image = view->image;
    *view = *camera;
    view->image = image;
    view->mask = NULL;
    view->time = time;
    return 0;
}

/* Adds a view for each photograph of a camera's folder. */
static int add_camera(const fxs_photo_list *list, const fxs_listed_view *camera, const fxs_moments_options *o,
                      fxs_view_list *out, size_t *moments, fxs_message *message)
{
    char folder[FXS_PHOTO_PATH];
    file_names names = {0};
    if (!find_folder(list, o, camera->image, folder))
        return fxs_fail(message, "%s: view %s: the photograph has no time, and the camera has no folder of photographs",
                        list->cameras, camera->view.name);
    int error = list_folder(folder, &names, message);
    if (!error && *moments && names.count != *moments)
        error = fxs_fail(message, "%s: %zu photographs, but %zu of the cameras before: a camera takes one at each "
                         "moment", folder, names.count, *moments);
    *moments = names.count;
    for (size_t i = 0; i < names.count && !error; i++)
        error = add_view(out, camera, folder, names.names[i], (double)i / (o->fps > 0 ? o->fps : FPS));
    free_names(&names);
    return error;
}

/* Replaces the cameras by the photographs in their folders. */
static int take_folders(fxs_photo_list *list, const fxs_moments_options *o, fxs_message *message)
{
    fxs_view_list *const lists[] = {&list->fit, &list->held_out};
    size_t moments = 0;
    for (int k = 0; k < 2; k++) {
        fxs_view_list out = *lists[k];
        out.views = NULL;
        out.count = out.capacity = 0;
        out.message = message;
        int error = 0;
        for (size_t i = 0; i < lists[k]->count && !error; i++)
            error = add_camera(list, &lists[k]->views[i], o, &out, &moments, message);
        for (size_t i = 0; i < lists[k]->count; i++)
            fxs_listed_view_free(&lists[k]->views[i]);
        free(lists[k]->views);
        lists[k]->views = out.views;
        lists[k]->count = out.count;
        lists[k]->capacity = out.capacity;
        FXS_TRY(error);
    }
    *list->images = *list->masks = 0;
    return 0;
}

/* ---- Moments ----------------------------------------------------------------------------------------------------- */

static int compare_views(const void *a, const void *b)
{
    const fxs_listed_view *v = a, *w = b;
    return v->time != w->time ? (v->time > w->time) - (v->time < w->time) : strcmp(v->image, w->image);
}

static int check_times(const fxs_view_list *views, fxs_message *message)
{
    for (size_t i = 0; i < views->count; i++)
        if (!isfinite(views->views[i].time))
            return fxs_fail(message, "%s: view %s: its photograph has %s", views->path, views->views[i].view.name,
                            isnan(views->views[i].time) ? "no time, unlike others" : "a time that is not a number");
    return 0;
}

static int has_times(const fxs_view_list *views)
{
    for (size_t i = 0; i < views->count; i++)
        if (!isnan(views->views[i].time))
            return 1;
    return 0;
}

/* Holds out every n-th camera, by its place among the photographs of a moment. */
static int hold_out(fxs_photo_list *list, size_t cameras, uint32_t n, fxs_message *message)
{
    fxs_view_list *fit = &list->fit, *held = &list->held_out;
    size_t left = 0;
    free(held->views);
    held->views = malloc((fit->count + 1) * sizeof *held->views);
    held->count = 0;
    if (!held->views)
        return fxs_fail_memory(message, list->cameras, fit->count * sizeof *held->views);
    for (size_t i = 0; i < fit->count; i++)
        if (i % cameras % n == 0)
            held->views[held->count++] = fit->views[i];
        else
            fit->views[left++] = fit->views[i];
    fit->count = left;
    return 0;
}

static int stand_apart(const fxs_view *a, const fxs_view *b)
{
    double size = 1, place = 0, turn = 0;
    for (int k = 0; k < 3; k++) {
        size = fmax(size, fabs(a->position[k]));
        place = fmax(place, fabs(a->position[k] - b->position[k]));
    }
    for (int k = 0; k < 9; k++)
        turn = fmax(turn, fabs(a->rotation[k] - b->rotation[k]));
    return place > SAME * size || turn > SAME || fabs(a->fx - b->fx) > SAME * a->fx ||
           fabs(a->fy - b->fy) > SAME * a->fy || a->width != b->width || a->height != b->height;
}

static size_t count_from(const fxs_view_list *views, size_t first)
{
    size_t end = first + 1;
    while (end < views->count && views->views[end].time == views->views[first].time)
        end++;
    return end - first;
}

/* Counts the photographs of the first moment, and checks that all moments have the same cameras. */
static int check_cameras(const fxs_view_list *views, size_t *cameras, fxs_message *message)
{
    const fxs_listed_view *v = views->views;
    const size_t count = *cameras = count_from(views, 0);
    for (size_t i = 0; i < views->count; i += count)
        if (count_from(views, i) != count)
            return fxs_fail(message, "%s: %zu photographs at the time %g, but %zu at %g: each camera takes one at each "
                            "moment", views->path, count, v[0].time, count_from(views, i), v[i].time);
    for (size_t i = count; i < views->count && count > 1; i++)
        if (stand_apart(&v[i % count].view, &v[i].view))
            return fxs_fail(message, "%s: %s was taken by another camera than %s: the cameras of a moving scene stand "
                            "still, and their photographs have names in the same order at each moment", views->path,
                            v[i].view.name, v[i % count].view.name);
    return 0;
}

static int group(fxs_moments *m, fxs_message *message)
{
    const fxs_view_list *fit = &m->list.fit, *held = &m->list.held_out;
    size_t next = 0;
    m->count = fit->count / m->cameras;
    m->times = malloc(m->count * sizeof *m->times);
    m->held = malloc((m->count + 1) * sizeof *m->held);
    if (!m->times || !m->held)
        return fxs_fail_memory(message, m->list.cameras, m->count * sizeof *m->times);
    for (size_t i = 0; i < m->count; i++) {
        m->times[i] = fit->views[i * m->cameras].time;
        m->held[i] = next;
        while (next < held->count && held->views[next].time == m->times[i])
            next++;
    }
    m->held[m->count] = next;
    return next == held->count ? 0 :
           fxs_fail(message, "%s: %s is held out at the time %g, at which no photograph is fitted", m->list.cameras,
                    held->views[next].view.name, held->views[next].time);
}

static void sort_views(fxs_view_list *views)
{
    if (views->count)
        qsort(views->views, views->count, sizeof *views->views, compare_views);
}

static int arrange(fxs_moments *m, int has_tests, const fxs_moments_options *o, fxs_message *message)
{
    fxs_view_list *fit = &m->list.fit;
    const uint32_t n = m->photos->hold_out;
    size_t all = 1;
    if (!has_times(fit))
        FXS_TRY(take_folders(&m->list, o, message));
    if (!fit->count)
        return fxs_fail(message, "%s: the folders of its cameras have no photographs", m->list.cameras);
    FXS_TRY(check_times(fit, message));
    FXS_TRY(check_times(&m->list.held_out, message));
    sort_views(fit);
    sort_views(&m->list.held_out);
    FXS_TRY(check_cameras(fit, &all, message));
    m->cameras = has_tests || !n ? all : all - (all + n - 1) / n;
    if (m->cameras < 2)
        return fxs_fail(message, "%s: %zu photograph%s to fit at each moment, but the first moment is fitted as a "
                        "still scene: this needs several cameras, which see each moment from different places",
                        m->list.cameras, m->cameras, m->cameras == 1 ? "" : "s");
    if (fit->count == all)
        return fxs_fail(message, "%s: all photographs are of one moment, so nothing moves", m->list.cameras);
    if (!has_tests && n)
        FXS_TRY(hold_out(&m->list, all, n, message));
    return group(m, message);
}

static int open_moments(fxs_moments *m, const char *path, const fxs_moments_options *o, fxs_message *message)
{
    FXS_TRY(fxs_photo_list_find(&m->list, path, 0, message));
    const int has_tests = *m->list.test || m->list.fit.has_parts;
    if (has_tests) {
        fxs_photo_list_free(&m->list);
        FXS_TRY(fxs_photo_list_find(&m->list, path, m->photos->hold_out, message));
    }
    FXS_TRY(fxs_photo_masks_check(&m->list, m->photos, message));
    return arrange(m, has_tests, o, message);
}

int fxs_moments_open(fxs_moments **moments, const char *path, const fxs_photos_options *photos,
                     const fxs_moments_options *options, fxs_message *message)
{
    fxs_moments *m = *moments = calloc(1, sizeof *m);
    if (!m)
        return fxs_fail_memory(message, path, sizeof *m);
    m->photos = photos;
    const int error = open_moments(m, path, options, message);
    if (error) {
        fxs_moments_free(m);
        *moments = NULL;
    }
    return error;
}

void fxs_moments_free(fxs_moments *m)
{
    if (!m)
        return;
    fxs_photo_list_free(&m->list);
    free(m->times);
    free(m->held);
    free(m);
}

size_t fxs_moments_count(const fxs_moments *m)
{
    return m->count;
}

double fxs_moments_time(const fxs_moments *m, size_t number)
{
    return m->times[number];
}

int fxs_moments_read(const fxs_moments *m, size_t number, fxs_photos *photos, fxs_message *message)
{
    fxs_photo_list some = m->list;
    memset(photos, 0, sizeof *photos);
    some.fit.views += number * m->cameras;
    some.fit.count = m->cameras;
    some.held_out.views += m->held[number];
    some.held_out.count = m->held[number + 1] - m->held[number];
    int error = fxs_photos_pixels(&some, m->photos, photos, message);
    if (!error && photos->fit_count != m->cameras)
        error = fxs_fail(message, "%s: a photograph of the time %g cannot be read, so its moment has a camera less",
                         m->list.cameras, m->times[number]);
    if (!error && !number)
        error = fxs_photos_points(&some, m->photos, photos, message);
    if (error)
        fxs_photos_free(photos);
    return error;
}
