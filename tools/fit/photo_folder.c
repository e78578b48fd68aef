/* Prepares a folder of photographs for COLMAP: links the originals, converts HEIF to JPEG, finds masks, and groups
   photographs by size and lens. */
#define _XOPEN_SOURCE 700          /* declares strdup */

#include "photo_folder.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/system.h>
#include "tools/command/command.h"
#include "src/image/photograph.h"

enum { BATCH = 16 };

static const char skips[] = "--skip-bad leaves such photographs out";

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static int add_photograph(photographs *p, const char *name)
{
    if (p->count == p->room) {
        const size_t room = 2 * p->room + 64;
        char **larger = realloc(p->names, room * sizeof *larger);
        if (!larger)
            return 0;
        p->names = larger;
        p->room = room;
    }
    p->names[p->count] = strdup(name);
    return p->names[p->count] && ++p->count;
}

void photographs_free(photographs *p)
{
    for (size_t i = 0; i < p->count; i++)
        free(p->names[i]);
    free(p->names);
    free(p->lenses);
    free(p->table);
    memset(p, 0, sizeof *p);
}

typedef struct listing {
    photographs *p;
    int fits;
} listing;

static void list_photograph(void *argument, const char *name)
{
    listing *l = argument;
    l->fits = l->fits && (!fxs_photograph_kind_of(name) || add_photograph(l->p, name));
}

int photographs_list(photographs *p, const char *path)
{
    listing l = {p, 1};
    fxs_folder_each(path, list_photograph, &l);
    if (p->count)
        qsort(p->names, p->count, sizeof *p->names, compare_names);
    return l.fits;
}

int photographs_list_more(photographs *p, const char *folder)
{
    photographs all = {0};
    int fits = photographs_list(&all, folder);
    for (size_t i = 0; i < all.count && fits; i++)
        if (!p->count || strcmp(all.names[i], p->names[p->count - 1]) > 0)
            fits = add_photograph(p, all.names[i]);
    photographs_free(&all);
    return fits;
}

typedef struct conversion {
    const char *folder, *to, *const *names;
    fxs_message messages[BATCH];
    int errors[BATCH];
} conversion;

static int link_to(const char *path, const char *to)
{
    fxs_file_remove(to);
    return fxs_file_link(path, to) ? fail(EXIT_FAILED, "%s: %s", to, strerror(errno)) : 0;
}

static void convert_one(void *argument, uint32_t i)
{
    conversion *c = argument;
    char from[TASK_PATH], to[TASK_PATH], name[TASK_PATH];
    join_path(from, c->folder, c->names[i]);
    snprintf(name, sizeof name, "%.1000s.jpg", c->names[i]);
    join_path(to, c->to, name);
    c->errors[i] = fxs_file_kind(to) == FXS_FILE_NONE ? fxs_photograph_to_jpg(from, to, &c->messages[i]) : 0;
}

static int convert(task *t, conversion *c, size_t count, uint32_t threads, int skip_bad)
{
    int status = 0;
    fxs_pool *pool = fxs_pool_create(threads);
    const char *const *const names = c->names;
    task_begin(t, "converting photographs", 0);
    for (size_t first = 0; first < count && !status; first += BATCH) {
        const size_t left = count - first;
        const uint32_t jobs = left < BATCH ? (uint32_t)left : BATCH;
        c->names = names + first;
        if (pool)
            fxs_pool_run(pool, convert_one, c, jobs);
        else
            for (uint32_t i = 0; i < jobs; i++)
                convert_one(c, i);
        for (uint32_t i = 0; i < jobs && !status; i++)
            if (c->errors[i] && skip_bad && c->errors[i] == FXS_ERR_FILE)
                note("left out: %s", c->messages[i].text);
            else if (c->errors[i])
                status = c->errors[i] == FXS_ERR_FILE ? fail(EXIT_FAILED, "%s (%s)", c->messages[i].text, skips)
                                                      : fail_for(&c->messages[i]);
        task_show(t, first + jobs, count);
    }
    progress_end();
    fxs_pool_destroy(pool);
    return status;
}

static int make_mixed(task *t, const photographs *p, const char *from, const char *to, uint32_t threads, int skip_bad)
{
    static conversion c;
    char path[TASK_PATH], name[TASK_PATH];
    size_t heif = 0;
    const char **names = malloc(p->count * sizeof *names);
    fxs_file_unlink(to);       /* an earlier `to` may be a link to the user's own folder */
    int status = names ? make_folder(to) : fail(EXIT_FAILED, "out of memory");
    for (size_t i = 0; i < p->count && !status; i++) {
        if (fxs_photograph_kind_of(p->names[i]) == FXS_PHOTOGRAPH_HEIF) {
            names[heif++] = p->names[i];
            continue;
        }
        join_path(path, from, p->names[i]);
        join_path(name, to, p->names[i]);
        status = link_to(path, name);
    }
    memset(&c, 0, sizeof c);
    c.folder = from;
    c.to = to;
    c.names = names;
    status = status ? status : convert(t, &c, heif, threads, skip_bad);
    free(names);
    return status;
}

int photo_folder_make(task *t, const photographs *p, const char *from, const char *to, uint32_t threads, int skip_bad)
{
    int is_mixed = !fxs_links_folders(), status;
    char *whole = fxs_path_whole(from);
    for (size_t i = 0; i < p->count; i++)
        is_mixed |= fxs_photograph_kind_of(p->names[i]) == FXS_PHOTOGRAPH_HEIF;
    status = !whole     ? fail(EXIT_FAILED, "%s: %s", from, strerror(errno))
             : is_mixed ? make_mixed(t, p, whole, to, threads, skip_bad)
                        : link_to(whole, to);
    free(whole);
    return status;
}

typedef struct photo_lens {
    int width, height;
    fxs_exif exif;
} photo_lens;

static size_t find_lens(const photo_lens *lenses, size_t count, const photo_lens *s)
{
    size_t i = 0;
    while (i < count && (lenses[i].width != s->width || lenses[i].height != s->height ||
                         strcmp(lenses[i].exif.lens, s->exif.lens) != 0))
        i++;
    return i;
}

int photograph_mask(const char *masks, const char *name, char path[FXS_PHOTO_PATH])
{
    char original[TASK_PATH];
    const int length = (int)strlen(name) - 4;
    if (fxs_photo_mask_in(masks, name, path))
        return 1;
    if (length < 1 || length >= TASK_PATH || strcmp(name + length, ".jpg"))
        return 0;
    snprintf(original, sizeof original, "%.*s", length, name);
    return fxs_photograph_kind_of(original) == FXS_PHOTOGRAPH_HEIF && fxs_photo_mask_in(masks, original, path);
}

static int look_at_mask(const photograph_look *how, const char *path, const char *name, const photo_lens *s,
                        fxs_message *why)
{
    fxs_photo_masking masking = {.is_inverse = how->masks_are_inverse};
    uint8_t *counts = 0;
    const int has_mask = *how->masks && photograph_mask(how->masks, name, masking.path);
    const int error = has_mask ? fxs_photo_mask_read(&masking, path, 0, s->width, s->height, &counts, why) : 0;
    free(counts);
    return error;
}

/* COLMAP reads a list of file names, one a line, and strips blanks at the ends of names. */
static int check_name(const char *name, const char *path, fxs_message *why)
{
    return strchr(" \t\v\f\r", *name) || strchr(name, '\n')
               ? fxs_fail(why, "%s: COLMAP takes no name that begins with a blank or has a line break: rename it", path)
               : 0;
}

static int look(task *t, photographs *p, const char *folder, const photograph_look *how)
{
    size_t kept = p->looked_at;
    const size_t count = p->count;
    for (size_t i = kept; i < count; i++) {
        char path[TASK_PATH];
        uint8_t *pixels = 0;
        fxs_message why;
        photo_lens s = {0};
        join_path(path, folder, p->names[i]);
        int error = check_name(p->names[i], path, &why);
        error = error ? error : fxs_photograph_read(path, &pixels, &s.width, &s.height, &s.exif, &why);
        error = error ? error : look_at_mask(how, path, p->names[i], &s, &why);
        free(pixels);
        if (!how->is_quiet)
            task_show(t, i + 1, count);
        if (error && error != FXS_ERR_FILE)
            return fail_for(&why);
        if (error && !how->skip_bad)
            return fail(EXIT_FAILED, "%s (%s)", why.text, skips);
        if (error) {
            note("left out: %s", why.text);
            free(p->names[i]);
            p->names[i] = 0;
            continue;
        }
        const size_t lens = find_lens(p->table, p->lens_count, &s);
        if (lens == p->lens_count)
            p->table[p->lens_count++] = s;
        p->has_exif |= *s.exif.lens;
        p->lenses[kept] = lens;
        p->names[kept] = p->names[i];
        p->names[i] = kept < i ? 0 : p->names[i];
        kept++;
    }
    p->count = p->looked_at = kept;
    return 0;
}

static int make_room(photographs *p)
{
    const size_t room = p->count + 1;
    size_t *lenses = realloc(p->lenses, room * sizeof *lenses);
    p->lenses = lenses ? lenses : p->lenses;
    photo_lens *table = realloc(p->table, room * sizeof *table);
    p->table = table ? table : p->table;
    return lenses && table;
}

int photographs_look(task *t, photographs *p, const char *folder, const photograph_look *how)
{
    const size_t lenses = p->lens_count;
    task_begin(t, "looking at photographs", 0);
    const int status = make_room(p) ? look(t, p, folder, how) : fail(EXIT_FAILED, "out of memory");
    progress_end();
    if (!status && p->lens_count > 1 && p->lens_count > lenses)
        note("%s: photographs of %zu sizes and lenses, each of which is a camera", t->of, p->lens_count);
    return status;
}
