#define _XOPEN_SOURCE 700   /* declares strdup */
#include "scene_list.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/scene.h>
#include "src/base/os_calls.h"
#include "tools/command/command.h"
#include "tools/fit/reconstruct.h"
#include "tools/command/task.h"

static int is_taken(const scene_list *list, const char *name)
{
    int taken = !*name || !strcmp(name, "index");
    for (size_t i = 0; i < list->count; i++)
        taken |= !strcmp(list->scenes[i].name, name);
    return taken;
}

static void name_scene(const scene_list *list, listed_scene *s)
{
    const char *slash = strrchr(s->path, '/'), *base = slash && slash[1] ? slash + 1 : s->path;
    const char *dot = strrchr(base, '.');
    size_t length = 0;
    snprintf(s->title, LISTED_NAME, "%.*s", dot ? (int)(dot - base) : LISTED_NAME, base);
    for (; s->title[length] && length < LISTED_NAME - 16; length++)
        s->name[length] = isalnum((unsigned char)s->title[length]) ? s->title[length] : '-';
    s->name[length] = 0;
    for (unsigned number = 2; is_taken(list, s->name); number++)
        snprintf(s->name + length, 16, "-%u", number);
}

static int add_scene(scene_list *list, const char *folder, const char *name)
{
    char path[TASK_PATH];
    if (list->count == list->room) {
        const size_t room = 2 * list->room + 16;
        listed_scene *larger = realloc(list->scenes, room * sizeof *larger);
        if (!larger)
            return 0;
        list->scenes = larger;
        list->room = room;
    }
    join_path(path, folder, name);
    listed_scene s = {.path = strdup(*folder ? path : name)};
    if (!s.path)
        return 0;
    name_scene(list, &s);
    list->scenes[list->count++] = s;
    return 1;
}

static int compare_paths(const void *a, const void *b)
{
    return strcmp(((const listed_scene *)a)->path, ((const listed_scene *)b)->path);
}

/* True if a folder has a file with the fixed name of a scene format, such as tileset.json. */
static int is_scene_of_files(const char *folder)
{
    const fxs_scene_format *format;
    char path[TASK_PATH], name[64];
    for (int i = 0; (format = fxs_scene_format_at(i)) != 0; i++)
        for (const char *ending = format->endings; *ending; ending += strspn(ending, " ")) {
            const size_t length = strcspn(ending, " ");
            snprintf(name, sizeof name, "%.*s", (int)length, ending);
            join_path(path, folder, name);
            if (*ending != '.' && fxs_file_kind(path) != FXS_FILE_NONE)
                return 1;
            ending += length;
        }
    return 0;
}

int is_folder_of_scenes(const char *path)
{
    return is_folder(path) && !fxs_scene_format_of(path, 0) && !is_scene_of_files(path);
}

static int fail_without_scene(const char *path)
{
    fxs_printed command;
    if (!reconstruct_is_photographs(path) || fxs_print_begin(&command))
        return fail(EXIT_FAILED, "%s: no scene in this folder", path);
    fputs("fixsplat fit", command.file);
    write_shell_word(command.file, path);
    fputs(" -o scene.fxs", command.file);
    if (!fxs_print_end(&command))
        fail(EXIT_FAILED, "%s: a folder of photographs: fit a scene to them first: %s", path, command.text);
    free(command.text);
    return EXIT_FAILED;
}

typedef struct taking {
    scene_list *list;
    const char *path;
    int fits;
} taking;

static void take_scene(void *argument, const char *name)
{
    taking *t = argument;
    if (t->fits && *name != '.' && fxs_scene_format_of(name, 0))
        t->fits = add_scene(t->list, t->path, name);
}

int scene_list_add(scene_list *list, const char *path)
{
    const size_t before = list->count;
    taking t = {list, path, 1};
    const int is_folder = is_folder_of_scenes(path) && !fxs_folder_each(path, take_scene, &t);
    if (list->count > before)
        qsort(list->scenes + before, list->count - before, sizeof *list->scenes, compare_paths);
    else if (t.fits && is_folder)
        return fail_without_scene(path);
    else if (t.fits)
        t.fits = add_scene(list, "", path);
    return t.fits ? 0 : fail(EXIT_FAILED, "out of memory");
}

void scene_list_free(scene_list *list)
{
    for (size_t i = 0; i < list->count; i++)
        free(list->scenes[i].path);
    free(list->scenes);
    *list = (scene_list){0};
}
