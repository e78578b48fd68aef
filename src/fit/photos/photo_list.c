/* Finds the camera file, images, masks and points of a set of photographs. Reads the cameras, and holds out photographs
 * for testing. Image names in camera files often differ from the names of the files; settle_name tries other slashes,
 * cases and endings. */
#include "photo_list.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/message.h>
#include "src/base/files_internal.h"
#include "src/image/photograph.h"

static int is_folder(const char *path)
{
    return fxs_file_kind(path) == FXS_FILE_FOLDER;
}

static int exists(const char *path)
{
    return fxs_file_kind(path) != FXS_FILE_NONE;
}

static int join(char out[FXS_PHOTO_PATH], const char *folder, const char *name)
{
    const int absolute = fxs_path_is_whole(name) || !*folder;
    const char *slash = absolute || folder[strlen(folder) - 1] == '/' ? "" : "/";
    name = fxs_without_dots(name);
    const int length = snprintf(out, FXS_PHOTO_PATH, "%s%s%s", absolute ? "" : folder, slash, name);
    if (length >= 0 && length < FXS_PHOTO_PATH)
        return 1;
    *out = 0;
    return 0;
}

static const char *base_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static void parent_of(char out[FXS_PHOTO_PATH], const char *path)
{
    size_t length = strlen(path);
    while (length > 1 && path[length - 1] == '/')
        length--;
    while (length && path[length - 1] != '/')
        length--;
    const char *name = path + length;
    const size_t named = strcspn(name, "/");
    if (named <= 2 && !strncmp(name, "..", named))
        snprintf(out, FXS_PHOTO_PATH, "%.*s/..", FXS_PHOTO_PATH - 4, path);
    else
        snprintf(out, FXS_PHOTO_PATH, "%.*s", length ? (int)length : 1, length ? path : ".");
}

static int find_cameras(fxs_photo_list *list, const char *path, fxs_message *message)
{
    if (strlen(path) > FXS_PHOTO_PATH - 64)
        return fxs_fail(message, "a name of %zu characters is too long", strlen(path));
    if (is_folder(path))
        return fxs_camera_file_find(path, list->cameras, message);
    strcpy(list->cameras, path);
    return 0;
}

static int colmap_name(const char *name)
{
    static const char *const known[] = {"images.bin", "images.txt", "cameras.bin", "cameras.txt", "points3D.bin",
                                        "points3D.txt"};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (!strcmp(name, known[i]))
            return 1;
    return 0;
}

/* Looks for the image folder in the COLMAP model's folder, then in the three folders above. */
static int find_colmap_images(fxs_photo_list *list, fxs_message *message)
{
    static const char *const names[] = {"images", "input", "images_2", "images_4", "images_8"};
    char folder[FXS_PHOTO_PATH], above[FXS_PHOTO_PATH];
    parent_of(folder, list->cameras);
    for (int i = 0; i < 4; i++) {
        for (size_t k = 0; k < sizeof names / sizeof *names; k++)
            if (join(list->images, folder, names[k]) && is_folder(list->images))
                return 0;
        parent_of(above, folder);
        strcpy(folder, above);
    }
    return fxs_fail(message, "%s: no folder images, input or images_4 beside these cameras or up to three above",
                    list->cameras);
}

static void find_points(fxs_photo_list *list, const char *const *names, size_t count)
{
    char folder[FXS_PHOTO_PATH];
    parent_of(folder, list->cameras);
    for (size_t i = 0; i < count; i++)
        if (join(list->points, folder, names[i]) && exists(list->points))
            return;
    *list->points = 0;
}

/* Finds the files of a COLMAP model after the user named any file of it. The model's images file becomes the camera
   file. */
static int find_colmap(fxs_photo_list *list, fxs_message *message)
{
    static const char *const binary[] = {"points3D.bin"}, *const plain[] = {"points3D.txt"};
    const size_t length = strlen(list->cameras);
    const int is_binary = !strcmp(list->cameras + length - 3, "bin");
    char folder[FXS_PHOTO_PATH];
    parent_of(folder, list->cameras);
    join(list->cameras, folder, is_binary ? "images.bin" : "images.txt");
    find_points(list, is_binary ? binary : plain, 1);
    return find_colmap_images(list, message);
}

static void find_beside(fxs_photo_list *list, const char *folder, const char *points)
{
    if (!join(list->images, folder, "images") || !is_folder(list->images))
        strcpy(list->images, folder);
    find_points(list, &points, 1);
}

static void find_of_transforms(fxs_photo_list *list, const char *folder)
{
    strcpy(list->images, folder);
    if (list->fit.points)
        join(list->points, folder, list->fit.points);
    fxs_path_settle(list->points);
    if (strcmp(base_of(list->cameras), "transforms_train.json") || list->fit.has_parts)
        return;
    if ((!join(list->test, folder, "transforms_test.json") || !exists(list->test)) &&
        (!join(list->test, folder, "transforms_val.json") || !exists(list->test)))
        *list->test = 0;
}

static int find_others(fxs_photo_list *list, fxs_message *message)
{
    char folder[FXS_PHOTO_PATH];
    parent_of(folder, list->cameras);
    if (list->fit.format == FXS_CAMERAS_OF_TRANSFORMS)
        find_of_transforms(list, folder);
    else
        find_beside(list, folder, list->fit.format == FXS_CAMERAS_OF_INRIA ? "input.ply" : "points.ply");
    if (list->fit.format == FXS_CAMERAS_OF_BUNDLER)
        strcpy(list->points, list->cameras);
    return !list->fit.moved || !*list->points ? 0 :
           fxs_fail(message, "%s: the cameras of %s are at a place on the Earth, which is left out, and these points "
                    "are not: export both in a local coordinate system", list->points, base_of(list->cameras));
}

static int compare_images(const void *a, const void *b)
{
    const fxs_listed_view *v = a, *w = b;
    const int order = strcmp(v->image, w->image);
    return order ? order : memcmp(&v->view, &w->view, sizeof v->view);
}

#define FAR 65536.0                 /* limit of coordinates in scene units, where floats are 1/128 apart */
#define FAR_OF_EXTENT 16

/* Checks that the cameras are not too far from the origin for single precision, as in geographic coordinates. */
static int check_place(const fxs_view_list *views)
{
    double far = 0, extent = 0;
    for (size_t i = 0; i < views->count; i++)
        for (int k = 0; k < 3; k++) {
            const double here = views->views[i].view.position[k];
            far = fmax(far, fabs(here));
            extent = fmax(extent, fabs(here - views->views[0].view.position[k]));
        }
    return far < FAR || extent * FAR_OF_EXTENT > far ? 0 :
           fxs_fail(views->message, "%s: the cameras are %.0f units from the origin and %.0f from each other: too far "
                    "for single precision; export them in a local coordinate system", views->path, far, extent);
}

static int read_views(fxs_view_list *views, const char *path, fxs_message *message)
{
    views->path = path;
    views->message = message;
    FXS_TRY(fxs_view_list_read(views));
    for (size_t i = 0; i < views->count; i++) {
        const fxs_listed_view *v = &views->views[i];
        if (!v->image)
            return fxs_fail(message, "%s: view %s: it names no photograph", path, v->view.name);
        if (v->view.projection != FXS_PERSPECTIVE)
            return fxs_fail(message, "%s: view %s: not a perspective camera", path, v->view.name);
    }
    qsort(views->views, views->count, sizeof *views->views, compare_images);
    return check_place(views);
}

/* Chooses the photographs that are held out for testing; n = 0 holds out none. Otherwise these are the views that the
   camera file marks for testing or, without marks, every n-th view. */
static int hold_out(fxs_photo_list *list, uint32_t n, fxs_message *message)
{
    fxs_view_list *fit = &list->fit, *held = &list->held_out, *rest = &list->rest;
    size_t left = 0, tested = 0, place = 0;
    for (size_t i = 0; i < fit->count; i++)
        tested += fit->views[i].part == FXS_VIEW_TO_TEST;
    held->views = malloc((fit->count + 1) * sizeof *held->views);
    rest->views = malloc((fit->has_parts ? fit->count + 1 : 1) * sizeof *rest->views);
    if (!held->views || !rest->views)
        return fxs_fail_memory(message, list->cameras, fit->count * sizeof *held->views);
    held->path = fit->path;
    for (size_t i = 0; i < fit->count; i++) {
        fxs_listed_view *view = &fit->views[i];
        const int fitted = view->part == FXS_VIEW_OF_ANY || view->part == FXS_VIEW_TO_FIT;
        const int held_out = n && (tested ? view->part == FXS_VIEW_TO_TEST : fitted && place++ % n == 0);
        if (held_out)
            held->views[held->count++] = *view;
        else if (fitted)
            fit->views[left++] = *view;
        else
            rest->views[rest->count++] = *view;
    }
    const size_t count = fit->count;
    fit->count = left;
    return left ? 0 : fxs_fail(message, "%s: every photograph of %zu would be held out: none is left to fit",
                               list->cameras, count);
}

/* Looks for an image file under its name and with common endings. An absolute path often comes from another machine, so
   its last part is tried too. */
static int find_image(const fxs_photo_list *list, const char *name, char path[FXS_PHOTO_PATH])
{
    static const char *const endings[] = {"", ".png", ".jpg", ".jpeg", ".PNG", ".JPG", ".JPEG"};
    const char *places[] = {name, fxs_path_is_whole(name) ? base_of(name) : fxs_without_drive(name)};
    for (int k = 0; k < 1 + (places[1] != name); k++) {
        if (!join(path, list->images, places[k]) || strlen(path) > FXS_PHOTO_PATH - 8)
            return 0;
        char *end = path + strlen(path);
        for (size_t i = 0; i < sizeof endings / sizeof *endings; i++) {
            strcpy(end, endings[i]);
            if (exists(path))
                return 1;
        }
    }
    return 0;
}

static void set_ending(char *name, int in_capitals)
{
    char *dot = strrchr(name, '.');
    for (char *c = fxs_photograph_kind_of(name) ? dot + 1 : NULL; c && *c; c++)
        *c = (char)(in_capitals ? toupper((unsigned char)*c) : tolower((unsigned char)*c));
}

static void set_slashes(char *name)
{
    for (char *c = name; (c = strchr(c, '\\'));)
        *c = '/';
}

/* Corrects the name of a view's image if no such file exists: tries / for \, the ending in the other case, and Windows
   paths without drive. */
static void settle_name(const fxs_photo_list *list, fxs_listed_view *view)
{
    char path[FXS_PHOTO_PATH], own[8] = "";
    char *ending = strrchr(view->image, '.');
    int is_found = find_image(list, view->image, path);
    if (!is_found) {
        set_slashes(view->image);
        set_slashes(view->view.name);
        is_found = find_image(list, view->image, path);
    }
    if (ending && strlen(ending) < sizeof own)
        strcpy(own, ending);
    for (int k = 0; k < 2 && *own && !is_found; k++) {
        set_ending(view->image, !k);
        is_found = find_image(list, view->image, path);
    }
    const char *last = fxs_without_drive(view->image);
    if (is_found && !strstr(path, view->image))
        memmove(view->image, last, strlen(last) + 1);
    else if (!is_found && *own)
        strcpy(ending, own);
}

static void settle_names(const fxs_photo_list *list, fxs_view_list *views)
{
    for (size_t i = 0; i < views->count; i++)
        settle_name(list, &views->views[i]);
    if (views->count)
        qsort(views->views, views->count, sizeof *views->views, compare_images);
}

/* Looks for a folder of masks, named `masks`: next to the image folder if that is named `images`, else in the image
   folder. */
static void find_masks(fxs_photo_list *list)
{
    char folder[FXS_PHOTO_PATH];
    strcpy(folder, list->images);
    if (!strcmp(base_of(list->images), "images"))
        parent_of(folder, list->images);
    if (!join(list->masks, folder, "masks") || !is_folder(list->masks))
        *list->masks = 0;
}

static int find(fxs_photo_list *list, const char *path, uint32_t n, fxs_message *message)
{
    FXS_TRY(find_cameras(list, path, message));
    const int is_colmap = colmap_name(base_of(list->cameras));
    if (is_colmap)
        FXS_TRY(find_colmap(list, message));
    FXS_TRY(read_views(&list->fit, list->cameras, message));
    if (!is_colmap)
        FXS_TRY(find_others(list, message));
    find_masks(list);
    settle_names(list, &list->fit);
    if (!*list->test)
        return hold_out(list, n, message);
    if (n)
        FXS_TRY(read_views(&list->held_out, list->test, message));
    settle_names(list, &list->held_out);
    return 0;
}

int fxs_photo_list_find(fxs_photo_list *list, const char *path, uint32_t n, fxs_message *message)
{
    memset(list, 0, sizeof *list);
    const int error = find(list, path, n, message);
    if (error)
        fxs_photo_list_free(list);
    return error;
}

void fxs_photo_list_keep(fxs_view_list *views, const uint8_t *kept)
{
    size_t count = 0;
    for (size_t i = 0; i < views->count; i++)
        if (kept[i])
            views->views[count++] = views->views[i];
        else
            fxs_listed_view_free(&views->views[i]);
    views->count = count;
}

void fxs_photo_list_free(fxs_photo_list *list)
{
    fxs_view_list_free(&list->fit);
    fxs_view_list_free(&list->held_out);
    fxs_view_list_free(&list->rest);
}

int fxs_photo_list_image(const fxs_photo_list *list, const fxs_listed_view *view, char path[FXS_PHOTO_PATH],
                         fxs_message *message)
{
    if (!join(path, list->images, view->image) || strlen(path) > FXS_PHOTO_PATH - 8)
        return fxs_fail(message, "%s: view %s: name too long", list->cameras, view->view.name);
    if (!find_image(list, view->image, path))
        join(path, list->images, view->image);   /* The file does not exist; opening this path later gives the error
                                                    message. */
    return 0;
}

int fxs_photo_list_path(const fxs_photo_list *list, const char *name, char path[FXS_PHOTO_PATH], fxs_message *message)
{
    if (!join(path, list->images, name))
        return fxs_fail(message, "%s: a name of %zu characters is too long", list->cameras, strlen(name));
    fxs_path_settle(path);
    return 0;
}

enum { FOLDERS_MOST = 64, SHOWN_MOST = 300 };

typedef struct names {
    char **names;
    size_t count, room;
    int incomplete;
} names;

typedef struct others {
    names known, found;
    size_t folder;
    const char *of;
} others;

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static void add_name(names *n, const char *folder, size_t length, const char *name)
{
    const size_t size = strlen(name);
    char *copy = malloc(length + size + 1);
    if (n->count == n->room) {
        const size_t room = 2 * n->room + 64;
        char **larger = realloc(n->names, room * sizeof *larger);
        n->names = larger ? larger : n->names;
        n->room = larger ? room : n->room;
    }
    if (!copy || n->count == n->room) {
        free(copy);
        n->incomplete = 1;
        return;
    }
    memcpy(copy, folder, length);
    memcpy(copy + length, name, size + 1);
    n->names[n->count++] = copy;
}

static void free_names(names *n)
{
    for (size_t i = 0; i < n->count; i++)
        free(n->names[i]);
    free(n->names);
    memset(n, 0, sizeof *n);
}

static void sort_names(names *n)
{
    if (n->count)
        qsort(n->names, n->count, sizeof *n->names, compare_names);
}

static int is_in(const names *n, char *name)
{
    return n->count && bsearch(&name, n->names, n->count, sizeof *n->names, compare_names) != NULL;
}

static void add_known(names *known, const fxs_view_list *views)
{
    for (size_t i = 0; i < views->count; i++)
        add_name(known, "", 0, fxs_without_dots(views->views[i].image));
}

static void look_at(void *argument, const char *name)
{
    others *o = argument;
    if (!fxs_photograph_kind_of(name))
        return;
    add_name(&o->found, o->of, o->folder, name);
    if (o->found.incomplete)
        return;
    char *last = o->found.names[o->found.count - 1], *dot = strrchr(last, '.');
    const char first = *dot;
    int has_camera = is_in(&o->known, last);
    *dot = 0;
    has_camera |= is_in(&o->known, last);
    *dot = first;
    if (has_camera)
        free(o->found.names[--o->found.count]);
}

static void say_found(const others *o, const char *path, fxs_left_out_fn *say, void *argument)
{
    char list[SHOWN_MOST + 8] = "";
    size_t shown = 0, length = 0;
    fxs_message message;
    for (; shown < o->found.count; shown++) {
        const char *name = o->found.names[shown] + o->folder;
        if (length + strlen(name) + 2 > SHOWN_MOST)
            break;
        length += (size_t)snprintf(list + length, sizeof list - length, "%s%s", shown ? ", " : "", name);
    }
    fxs_fail(&message, "%.100s: %zu %s no camera: %s%s", path, o->found.count,
             o->found.count > 1 ? "photographs have" : "photograph has", list,
             shown < o->found.count ? ", ..." : "");
    say(argument, message.text);
}

static void look_beside(others *o, const fxs_photo_list *list, fxs_left_out_fn *say, void *argument)
{
    char folder[FXS_PHOTO_PATH], path[FXS_PHOTO_PATH];
    snprintf(folder, sizeof folder, "%.*s", (int)o->folder, o->of);
    if (o->folder >= sizeof folder || !join(path, list->images, folder))
        return;
    fxs_folder_each(*path ? path : ".", look_at, o);
    sort_names(&o->found);
    path[strlen(path) - (strlen(path) > 1)] = 0;
    if (o->found.count)
        say_found(o, path, say, argument);
    free_names(&o->found);
}

void fxs_photo_list_others(const fxs_photo_list *list, fxs_left_out_fn *say, void *argument)
{
    others o = {.folder = 0};
    const char *seen[FOLDERS_MOST];
    size_t lengths[FOLDERS_MOST], count = 0;
    add_known(&o.known, &list->fit);
    add_known(&o.known, &list->held_out);
    add_known(&o.known, &list->rest);
    sort_names(&o.known);
    for (size_t i = 0; i < list->fit.count && !o.known.incomplete; i++) {
        size_t k = 0;
        o.of = fxs_without_dots(list->fit.views[i].image);
        o.folder = (size_t)(base_of(o.of) - o.of);
        while (k < count && (lengths[k] != o.folder || memcmp(seen[k], o.of, o.folder)))
            k++;
        if (k < count || count == FOLDERS_MOST)
            continue;
        seen[count] = o.of;
        lengths[count++] = o.folder;
        look_beside(&o, list, say, argument);
    }
    free_names(&o.known);
}
