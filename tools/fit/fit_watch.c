/* Runs `fixsplat fit FOLDER --watch`: fits photographs as they arrive in a folder.
 *
 * Once a second, between two steps, the folder is listed. If a photograph has the size and time of the last look, it is
 * copied to OUT.cameras/images, under a number in the order of arrival and its name. COLMAP then places it
 * (reconstruct.h), and it is added to the fit with its new points. Photograph k is held out if k is a multiple of
 * --hold-out. Until the last photograph has arrived, the fit repeats the steps before three tenths of its recipe, where
 * the recipes fast and mcmc still reduce the photographs. */
#define _XOPEN_SOURCE 700          /* declares strdup */

#include "cmd_fit.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/image.h>
#include <fixsplat/internal/fit_more.h>
#include <fixsplat/system.h>
#include "src/base/os_calls.h"
#include "src/fit/photos/photo_points.h"
#include "src/image/photograph.h"
#include "tools/command/file_guard.h"
#include "fit_result.h"
#include "photo_folder.h"
#include "reconstruct.h"

#define SECOND ((uint64_t)1000000000)

/* FIRST: photographs for the first cameras; LEAST: the same when the watch ends. PATIENCE: seconds until an unchanged
   photograph that cannot be read is left out. */
enum { FIRST = 8, LEAST = 3, PATIENCE = 10, SAVE_SECONDS = 60, COPIED_NAME = 100 };
#define LARGEST ((uint64_t)1 << 31)

enum { COMES, TAKEN, LEFT_OUT };

typedef struct arrival {           /* a photograph in the folder */
    char *name;
    uint64_t size, modified;
    uint64_t since;                /* time of the look that found its size or time changed, in nanoseconds */
    int state;
} arrival;

typedef struct copy {              /* a photograph in OUT.cameras/images */
    char *name;
    uint64_t hash;                 /* of the bytes of the photograph in the folder */
} copy;

struct fit_watch {
    fit_command *c;
    const char *folder;
    char images[TASK_PATH];
    reconstruct_options finding;
    reconstruct_work *cameras;
    arrival *arrivals;
    copy *copies;
    size_t arrival_count, arrival_room, copy_count, copy_room;
    size_t placed_of;              /* number of copies at the last search for cameras */
    fxs_photos photos;
    size_t waiting;                /* number of photographs behind the first photos.fit_count, not in the fit yet */
    uint64_t last_point;           /* largest number of a point of COLMAP that the fit has */
    uint64_t looked, arrived, saved;    /* times of the last look, arrival and save in nanoseconds */
    int gone;                      /* number of looks in a row that did not find the folder */
    int has_begun, is_over, has_grown;  /* has_grown 1: not saved since photographs were added */
    int has_new;                   /* 1: photographs or points are not in the fit yet */
};

static int no_memory(void)
{
    return fail(EXIT_FAILED, "out of memory");
}

static void *room_for(void *list, size_t count, size_t *room, size_t size)
{
    if (count < *room)
        return list;
    void *larger = realloc(list, (2 * *room + 64) * size);
    *room = larger ? 2 * *room + 64 : *room;
    return larger;
}

/* ---- The folder -------------------------------------------------------------------------------------------------- */

static arrival *find_arrival(fit_watch *w, const char *name)
{
    for (size_t i = 0; i < w->arrival_count; i++)
        if (!strcmp(w->arrivals[i].name, name))
            return &w->arrivals[i];
    arrival *larger = room_for(w->arrivals, w->arrival_count, &w->arrival_room, sizeof *larger);
    if (!larger)
        return 0;
    w->arrivals = larger;
    larger[w->arrival_count] = (arrival){.name = strdup(name)};
    return larger[w->arrival_count].name ? &larger[w->arrival_count++] : 0;
}

/* Writes a name that COLMAP's lists can hold: the end of a long name, without blanks. */
static void name_copy(char text[COPIED_NAME + 1], const char *name)
{
    const size_t length = strlen(name);
    snprintf(text, COPIED_NAME + 1, "%s", name + (length > COPIED_NAME ? length - COPIED_NAME : 0));
    for (char *c = text; *c; c++)
        if ((unsigned char)*c <= ' ')
            *c = '_';
}

/* Returns the copy that an earlier run has made of a photograph, or null. Its name has a number before, and .jpg behind
   if it was converted. */
static const copy *find_copy(const fit_watch *w, const char *name)
{
    char text[COPIED_NAME + 1];
    name_copy(text, name);
    for (size_t i = 0; i < w->copy_count; i++) {
        const char *dash = strchr(w->copies[i].name, '-');
        const size_t length = strlen(text);
        if (dash && !strncmp(dash + 1, text, length) && (!dash[1 + length] || !strcmp(dash + 1 + length, ".jpg")))
            return &w->copies[i];
    }
    return 0;
}

static const copy *find_same(const fit_watch *w, uint64_t hash)
{
    for (size_t i = 0; i < w->copy_count; i++)
        if (w->copies[i].hash == hash)
            return &w->copies[i];
    return 0;
}

static int add_copy(fit_watch *w, const char *name, uint64_t hash)
{
    copy *larger = room_for(w->copies, w->copy_count, &w->copy_room, sizeof *larger);
    if (!larger)
        return no_memory();
    w->copies = larger;
    larger[w->copy_count] = (copy){strdup(name), hash};
    return larger[w->copy_count++].name ? 0 : no_memory();
}

/* Reads a file. Returns null if it cannot be read, or is empty, larger than LARGEST or no file. The caller frees it. */
static uint8_t *read_bytes(const char *path, size_t *size)
{
    fxs_file_facts facts;
    FILE *file = fxs_file_look(path, &facts) == FXS_FILE_REGULAR && facts.size && facts.size < LARGEST
                     ? fxs_stream_open(path, "rb") : 0;
    uint8_t *bytes = file ? malloc((size_t)facts.size) : 0;
    *size = bytes ? fread(bytes, 1, (size_t)facts.size, file) : 0;
    const int is_whole = bytes && *size == facts.size;
    if (file)
        fclose(file);
    if (is_whole)
        return bytes;
    free(bytes);
    return 0;
}

static uint64_t hash_of(const uint8_t *bytes, size_t size)
{
    uint64_t hash = 14695981039346656037u;
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ bytes[i]) * 1099511628211u;
    return hash;
}

/* Checks that a copied photograph decodes, and moves it to its place. A HEIF is converted there. */
static int settle(const char *from, const char *to, int is_heif, fxs_message *why)
{
    uint8_t *pixels = 0;
    int width, height;
    fxs_exif exif;
    int error = is_heif ? fxs_photograph_to_jpg(from, to, why)
                        : fxs_photograph_read(from, &pixels, &width, &height, &exif, why);
    free(pixels);
    if (!error && !is_heif && fxs_file_rename(from, to)) {
        snprintf(why->text, sizeof why->text, "%.200s: cannot be written", to);
        error = FXS_ERR_FILE;
    }
    fxs_file_remove(from);
    return error;
}

/* Copies a complete photograph to OUT.cameras/images. */
static int copy_bytes(fit_watch *w, arrival *a, const uint8_t *bytes, size_t size)
{
    char from[TASK_PATH], to[TASK_PATH], name[COPIED_NAME + 32], text[COPIED_NAME + 1];
    const int is_heif = fxs_photograph_kind_of(a->name) == FXS_PHOTOGRAPH_HEIF;
    const fxs_encoded file = {.bytes = (void *)bytes, .size = size};
    fxs_message why;
    name_copy(text, a->name);
    snprintf(name, sizeof name, "%05zu-%s%s", w->copy_count, text, is_heif ? ".jpg" : "");
    snprintf(from, sizeof from, "%.3900s/arriving-%s", reconstruct_folder(w->cameras), text);
    join_path(to, w->images, name);
    int error = fxs_encoded_write(from, &file, &why);
    if (error)
        return fail_for(&why);
    error = settle(from, to, is_heif, &why);
    if (error && error != FXS_ERR_FILE)
        return fail_for(&why);
    if (error && fxs_clock(0) - a->since < PATIENCE * SECOND)
        return 0;
    a->state = error ? LEFT_OUT : TAKEN;
    if (error) {
        const char *fault = strncmp(why.text, from, strlen(from)) ? why.text : why.text + strlen(from);
        note("%s/%s%s: left out", w->folder, a->name, fault);
        return 0;
    }
    w->arrived = fxs_clock(0);
    return add_copy(w, name, hash_of(bytes, size));
}

/* Takes a photograph after its size has settled. */
static int take(fit_watch *w, arrival *a)
{
    char path[TASK_PATH];
    size_t size;
    join_path(path, w->folder, a->name);
    uint8_t *bytes = read_bytes(path, &size);
    const copy *same = bytes ? find_same(w, hash_of(bytes, size)) : 0;
    int status = 0;
    if (same) {
        a->state = LEFT_OUT;
        note("%s: left out: the same photograph as %s", path, strchr(same->name, '-') + 1);
    } else if (bytes) {
        status = copy_bytes(w, a, bytes, size);
    } else if (fxs_clock(0) - a->since >= PATIENCE * SECOND) {
        a->state = LEFT_OUT;
        note("%s: left out: it cannot be read", path);
    }
    free(bytes);
    return status;
}

/* Looks at one photograph of the folder. */
static int look_at(fit_watch *w, const char *name, uint64_t now)
{
    char path[TASK_PATH];
    fxs_file_facts facts;
    join_path(path, w->folder, name);
    if (fxs_file_look(path, &facts) != FXS_FILE_REGULAR)
        return 0;
    arrival *a = find_arrival(w, name);
    if (!a)
        return no_memory();
    const int is_new = !a->since, has_changed = facts.size != a->size || facts.modified != a->modified;
    if (has_changed || is_new) {
        a->size = facts.size;
        a->modified = facts.modified;
        a->since = now;
        if (a->state == TAKEN)
            note("%s: has changed: the fit keeps the photograph as it was", path);
        a->state = a->state == LEFT_OUT ? COMES : is_new && find_copy(w, name) ? TAKEN : a->state;
        w->arrived = a->state == COMES ? now : w->arrived;
        return 0;
    }
    return a->state == COMES ? take(w, a) : 0;
}

static int look_at_folder(fit_watch *w)
{
    photographs found = {0};
    const uint64_t now = fxs_clock(0);
    int status = 0;
    w->looked = now;
    w->gone = is_folder(w->folder) ? 0 : w->gone + 1;
    if (w->gone)
        return 0;
    status = photographs_list(&found, w->folder) ? 0 : no_memory();
    for (size_t i = 0; i < found.count && !status; i++)
        status = look_at(w, found.names[i], now);
    photographs_free(&found);
    return status;
}

static int list_copies(fit_watch *w)
{
    photographs found = {0};
    int status = photographs_list(&found, w->images) ? 0 : no_memory();
    for (size_t i = 0; i < found.count && !status; i++) {
        char path[TASK_PATH];
        size_t size;
        join_path(path, w->images, found.names[i]);
        uint8_t *bytes = read_bytes(path, &size);
        status = add_copy(w, found.names[i], bytes ? hash_of(bytes, size) : 0);
        free(bytes);
    }
    photographs_free(&found);
    return status;
}

/* ---- Photographs with cameras ------------------------------------------------------------------------------------ */

static int is_read(const fit_watch *w, const char *name)
{
    const fxs_fit_photo *lists[] = {w->photos.fit, w->photos.held_out};
    const size_t counts[] = {w->photos.fit_count + w->waiting, w->photos.held_out_count};
    for (int k = 0; k < 2; k++)
        for (size_t i = 0; i < counts[k]; i++)
            if (!strcmp(lists[k][i].view.name, name))
                return 1;
    return 0;
}

static int is_wanted(void *argument, const char *name)
{
    return !is_read(argument, name);
}

static int append(fxs_fit_photo **list, size_t count, const fxs_fit_photo *photo)
{
    fxs_fit_photo *longer = realloc(*list, (count + 1) * sizeof *longer);
    if (!longer)
        return no_memory();
    *list = longer;
    longer[count] = *photo;
    return 0;
}

/* Reads the photographs that have a camera and were not read yet. Those to fit go behind the fit's, as `waiting`. */
static int read_placed(fit_watch *w)
{
    const uint32_t hold_out = w->c->reading.hold_out;
    fxs_photos *all = &w->photos, more;
    fxs_photos_options quietly = w->c->reading;
    fxs_message why;
    quietly.progress = (fxs_progress){0};
    quietly.skip_bad = 1;
    const int error = fxs_photos_read_some(reconstruct_folder(w->cameras), &quietly, is_wanted, w, &more, &why);
    if (error == FXS_ERR_FILE)     /* none of them can be read, for example because of an odd lens */
        note("left out: %s", why.text);
    int status = error && error != FXS_ERR_FILE ? fail_for(&why) : 0;
    for (size_t i = 0; i < more.fit_count && !status; i++) {
        const unsigned long number = strtoul(more.fit[i].view.name, 0, 10);
        const int is_held_out = hold_out && number % hold_out == 0;
        status = is_held_out ? append(&all->held_out, all->held_out_count, &more.fit[i])
                             : append(&all->fit, all->fit_count + w->waiting, &more.fit[i]);
        if (!status)
            *(is_held_out ? &all->held_out_count : &w->waiting) += 1;
        w->has_new = 1;
    }
    free(more.fit);                /* the pixels belong to w->photos now */
    return status;
}

static int read_points(fit_watch *w, fxs_photo_points *points)
{
    char path[TASK_PATH];
    fxs_message why;
    *points = (fxs_photo_points){.after = w->last_point};
    join_path(path, reconstruct_folder(w->cameras), "sparse/0/points3D.bin");
    if (fxs_photo_points_colmap(points, path, &why)) {
        free(points->points);
        return fail_for(&why);
    }
    w->last_point = points->last;
    return 0;
}

/* Finds cameras, and prints which photographs have none yet. */
static int place(fit_watch *w)
{
    const uint64_t start = fxs_clock(0);
    const size_t taken = w->copy_count, before = w->photos.fit_count + w->waiting + w->photos.held_out_count;
    files_forget();
    const int status = reconstruct_place(w->cameras);
    const size_t fresh = taken - w->placed_of;
    w->placed_of = taken;
    w->arrived = fxs_clock(0);     /* COLMAP's time does not count as time without photographs */
    if (status == RECONSTRUCT_LATER && !before)
        note("%s: %zu photographs: no two from different places overlap enough yet", w->folder, taken);
    if (status)
        return status == RECONSTRUCT_LATER ? 0 : status;
    if (read_placed(w))
        return EXIT_FAILED;
    const size_t placed = w->photos.fit_count + w->waiting + w->photos.held_out_count;
    note("%s: %zu new photograph%s; places of %zu of %zu, in %.1f s", w->folder, fresh, fresh == 1 ? "" : "s", placed,
         taken, (double)(fxs_clock(0) - start) * 1e-9);
    for (size_t i = 0; i < w->copy_count; i++)
        if (!is_read(w, w->copies[i].name))
            note("%s: no place yet: tried again when more have arrived", strchr(w->copies[i].name, '-') + 1);
    return 0;
}

/* ---- The fit ----------------------------------------------------------------------------------------------------- */

/* Adds the photographs that wait, and their points, to the fit. */
static int add_to_fit(fit_watch *w, fxs_fit *fit)
{
    fxs_photo_points points;
    fxs_message why;
    if (read_points(w, &points))
        return EXIT_FAILED;
    w->photos.fit_count += w->waiting;
    w->waiting = 0;
    w->has_new = 0;
    const int error = fxs_fit_add_photos(fit, w->photos.fit, w->photos.fit_count, points.points, points.count, &why);
    free(points.points);
    w->has_grown = 1;
    if (!error && w->c->watcher)
        w->c->watcher->grown();
    return error ? fail_for(&why) : 0;
}

/* Saves the fit and the scene. After a failure the fit goes on. */
static void save_all(fit_watch *w, fxs_fit *fit, fit_progress *p)
{
    fit_result result;
    fxs_message why;
    files_forget();
    if (fxs_fit_save(fit, w->c->saved, &why))
        fail_for(&why);
    else
        p->saved = fxs_fit_steps(fit);
    result_write(&result, fit, &w->photos, 0, w->c->out);
    result_free(&result);
    w->saved = fxs_clock(0);
    w->has_grown = 0;
}

/* Ends a watch that cannot go on, with the scene and a saved fit. */
static int give_up(fit_watch *w, fxs_fit *fit, fit_progress *p)
{
    save_all(w, fit, p);
    fit_save_for_later(w->c, fit, "saved");
    return EXIT_FAILED;
}

static uint32_t recipe_at(const fxs_fit *fit)
{
    return fxs_fit_steps(fit) - fxs_fit_repeated(fit);
}

/* Returns the number of the recipe's steps that are made until the last photograph has arrived. */
static uint32_t steps_to_hold(const fxs_fit *fit)
{
    const uint32_t steps = fxs_fit_options_of(fit)->steps;
    return steps < 7 ? 1 : 3 * steps / 10 - 1;
}

/* Repeats a sixteenth of the recipe's steps. */
static int hold(fxs_fit *fit, fit_progress *p)
{
    const uint32_t steps = fxs_fit_options_of(fit)->steps, again = steps / 16 ? steps / 16 : 1;
    fxs_message why;
    if (recipe_at(fit) < steps_to_hold(fit))
        return 0;
    p->steps += again;
    return fxs_fit_repeat(fit, again, &why) ? fail_for(&why) : 0;
}

static int look_and_add(fit_watch *w, fxs_fit *fit, fit_progress *p)
{
    int status = look_at_folder(w);
    if (!status && w->gone > 1)
        status = fail(EXIT_FAILED, "%s: the folder is gone", w->folder);
    if (!status && w->copy_count > w->placed_of)
        status = place(w);
    if (status && !fxs_end_asked())                /* a signal may have ended COLMAP, too, and is handled later */
        return give_up(w, fit, p);
    status = w->has_new && !status ? add_to_fit(w, fit) : 0;
    if (!status && w->has_grown && fxs_clock(0) - w->saved >= SAVE_SECONDS * SECOND)
        save_all(w, fit, p);
    return status;
}

static void say_incomplete(const fit_watch *w)
{
    for (size_t i = 0; i < w->arrival_count; i++)
        if (w->arrivals[i].state == COMES)
            note("%s/%s: left out: not complete in time", w->folder, w->arrivals[i].name);
}

int fit_watch_look(fit_watch *w, fxs_fit *fit, fit_progress *p)
{
    if (!w->has_begun && w->c->resume)
        w->is_over = recipe_at(fit) > steps_to_hold(fit);
    w->has_begun = 1;
    if (w->is_over)
        return 0;
    const int status = fxs_clock(0) - w->looked >= SECOND ? look_and_add(w, fit, p) : 0;
    if (status)
        return status;
    if (fxs_clock(0) - w->arrived >= w->c->watch_seconds * SECOND) {
        w->is_over = 1;
        say_incomplete(w);
        note("%s: no photograph arrived for %u s: %zu have arrived; the rest of the steps follows", w->folder,
             (unsigned)w->c->watch_seconds, w->copy_count);
        save_all(w, fit, p);
        return 0;
    }
    return hold(fit, p);
}

/* Waits until the first photographs have arrived and have cameras. */
static int wait_for_first(fit_watch *w)
{
    size_t said = SIZE_MAX;
    int status = 0;
    while (!status && !w->waiting) {
        const int is_late = fxs_clock(0) - w->arrived >= w->c->watch_seconds * SECOND;
        const size_t needed = is_late ? LEAST : FIRST;
        status = look_at_folder(w);
        if (!status && w->gone > 1)
            return fail(EXIT_FAILED, "%s: the folder is gone", w->folder);
        if (!status && w->copy_count < FIRST && w->copy_count != said && !is_late)
            note("%s: %zu of the first %d photographs have arrived", w->folder, said = w->copy_count, FIRST);
        if (!status && w->copy_count >= needed && w->copy_count > w->placed_of)
            status = place(w);
        else if (!status && is_late)
            return fail(EXIT_FAILED, "%s: no photograph arrived for %u s, and %zu are too few to find their cameras",
                        w->folder, (unsigned)w->c->watch_seconds, w->copy_count);
        else if (!status)
            fxs_end_wait(250);
    }
    return status;
}

/* Prepares the photographs for fit_make. Those that a resumed fit lacks wait for its first step. */
static int begin(fit_watch *w)
{
    fxs_photo_points points;
    fxs_message why;
    fxs_photos *all = &w->photos;
    if (read_points(w, &points))
        return EXIT_FAILED;
    all->points = points.points;
    all->point_count = points.count;
    all->fit_count = w->waiting;
    w->waiting = 0;
    w->has_new = 0;
    if (!w->c->resume)
        return 0;
    size_t known;
    if (fxs_fit_saved_order(w->c->resume, all->fit, all->fit_count, &known, &why))
        return fail_for(&why);
    w->waiting = all->fit_count - known;
    w->has_new = w->waiting > 0;
    all->fit_count = known;
    return 0;
}

static int open_watch(fit_watch *w, fit_command *c)
{
    w->finding = (reconstruct_options){.in = c->in, .out = c->out, .threads = c->frame.threads, .quality = c->quality,
                                       .masks = "", .mixed = c->photos};
    w->c = c;
    w->folder = c->in;
    if (!is_folder(c->in))
        return fail(EXIT_USAGE, "%s: --watch takes a folder, into which photographs arrive", c->in);
    if (!reconstruct_is_needed(c->in))
        return fail(EXIT_USAGE, "%s: has cameras: --watch takes a folder of photographs without, and finds them itself",
                    c->in);
    const int status = reconstruct_open(&w->finding, &w->cameras);
    if (status)
        return status;
    join_path(w->images, reconstruct_folder(w->cameras), "images");
    w->arrived = w->saved = fxs_clock(0);
    c->watch = w;
    return list_copies(w);
}

static void close_watch(fit_watch *w)
{
    for (size_t i = 0; i < w->arrival_count; i++)
        free(w->arrivals[i].name);
    for (size_t i = 0; i < w->copy_count; i++)
        free(w->copies[i].name);
    free(w->arrivals);
    free(w->copies);
    w->photos.fit_count += w->waiting;
    fxs_photos_free(&w->photos);
    reconstruct_close(w->cameras);
}

int fit_watched(fit_command *c)
{
    fit_watch w = {.c = 0};
    int status = open_watch(&w, c);
    if (!status && reconstruct_has_cameras(w.cameras)) {
        w.placed_of = w.copy_count;
        status = read_placed(&w);
    }
    status = status ? status : wait_for_first(&w);
    progress_end();
    status = status ? status : begin(&w);
    if (!status) {
        fit_say_photos(c, &w.photos, w.photos.point_count);
        status = fit_make(c, &w.photos, 0);
    }
    close_watch(&w);
    c->watch = 0;
    return status;
}
