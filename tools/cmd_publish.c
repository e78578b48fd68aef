/* fixsplat publish: a folder for any web server, with scenes, their pictures and the page that shows them. */
#define _XOPEN_SOURCE 700   /* strdup */
#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/formats.h>
#include <fixsplat/fxs_file.h>
#include <fixsplat/map.h>
#include "cmd_render.h"
#include "page_folder.h"
#include "task.h"

enum { NAMES_MOST = 80 };

typedef struct shown {
    char *path;
    char name[NAMES_MOST];         /* of its files, without an ending */
    char title[NAMES_MOST];        /* the last part of its path, without the ending */
} shown;

typedef struct publish_options {
    frame_options frame;           /* the poster's size, how scenes are packed and read */
    const char *title, *site, *settings;
    shown *scenes;
    size_t count, room;
    size_t bytes;                  /* of all that was written */
} publish_options;

#define OPTIONS publish_options

static const option_row own_rows[] = {
    {.help = "Options:"},
    {"title", "TEXT", TEXT(title), .help = "of the page (default: the scene's name)"},
    {"profile", "P", CHOICE(frame.load.profile, profile_names), .help =
     "how scenes are packed that are no .fxs: small (default, 20 bytes a Gaussian), compact or default"},
    {"levels", 0, FLAG(frame.load.tree), .help =
     "pack them with levels of detail: of a large scene the page then fetches what it shows"},
    {"size", "WxH", take_frame_size, FIELD(frame_options, frame), .help = "of the poster (default 1280x720)"},
    {"settings", "FILE", TEXT(settings), .help =
     "a settings file of the viewer or of supersplat-viewer, for one scene: camera, annotations, camera tracks"},
    {0}
};

/* ---- Scenes ------------------------------------------------------------------------------------------------------ */

static int is_taken(const publish_options *o, const char *name)
{
    int taken = !*name || !strcmp(name, "index");
    for (size_t i = 0; i < o->count; i++)
        taken |= !strcmp(o->scenes[i].name, name);
    return taken;
}

/* The name without its ending, in letters, digits and dashes, as it stands in addresses. */
static void name_scene(publish_options *o, shown *s)
{
    const char *slash = strrchr(s->path, '/'), *base = slash && slash[1] ? slash + 1 : s->path;
    const char *dot = strrchr(base, '.');
    size_t length = 0;
    snprintf(s->title, NAMES_MOST, "%.*s", dot ? (int)(dot - base) : NAMES_MOST, base);
    for (; s->title[length] && length < NAMES_MOST - 16; length++)
        s->name[length] = isalnum((unsigned char)s->title[length]) ? s->title[length] : '-';
    s->name[length] = 0;
    for (unsigned number = 2; is_taken(o, s->name); number++)
        snprintf(s->name + length, 16, "-%u", number);
}

static int add_scene(publish_options *o, const char *folder, const char *name)
{
    char path[TASK_PATH];
    if (o->count == o->room) {
        const size_t room = 2 * o->room + 16;
        shown *larger = realloc(o->scenes, room * sizeof *larger);
        if (!larger)
            return 0;
        o->scenes = larger;
        o->room = room;
    }
    join_path(path, folder, name);
    shown s = {.path = strdup(*folder ? path : name)};
    if (!s.path)
        return 0;
    name_scene(o, &s);
    o->scenes[o->count++] = s;
    return 1;
}

static int compare_paths(const void *a, const void *b)
{
    return strcmp(((const shown *)a)->path, ((const shown *)b)->path);
}

/* A scene, or a folder of scenes. */
static int add_scenes(publish_options *o, const char *path)
{
    const size_t before = o->count;
    DIR *folder = is_folder(path) && !fxs_scene_format_of(path, 0) ? opendir(path) : 0;
    int fits = 1;
    for (struct dirent *entry; folder && fits && (entry = readdir(folder)) != 0;)
        if (entry->d_name[0] != '.' && fxs_scene_format_of(entry->d_name, 0))
            fits = add_scene(o, path, entry->d_name);
    if (folder)
        closedir(folder);
    if (o->count > before)
        qsort(o->scenes + before, o->count - before, sizeof *o->scenes, compare_paths);
    else if (fits && folder)
        return fail(EXIT_FAILED, "%s: no scene in this folder", path);
    else if (fits)
        fits = add_scene(o, "", path);
    return fits ? 0 : fail(EXIT_FAILED, "out of memory");
}

static int write_scene(publish_options *o, shown *s)
{
    char name[NAMES_MOST + 8], path[TASK_PATH];
    loaded_scene scene;
    fxs_message why;
    snprintf(name, sizeof name, "%s.fxs", s->name);
    join_path(path, o->site, name);
    if (load_scene(&scene, s->path, &o->frame.load))
        return EXIT_FAILED;
    if (is_packed(&scene) && (is_given("profile") || o->frame.load.tree))
        note("%s: is packed already, and is taken as it is", s->path);
    o->bytes += scene.opened->bytes;
    const int error = fxs_file_write(path, scene.opened->data, scene.opened->bytes, &why);
    free_scene(&scene);
    return error ? fail_for(&why) : 0;
}

/* From where the page begins. */
static int write_poster(const publish_options *o, const shown *s)
{
    render_options *r = calloc(1, sizeof *r);
    char name[NAMES_MOST + 8], scene[TASK_PATH], poster[TASK_PATH], *scenes[] = {scene};
    if (!r)
        return fail(EXIT_FAILED, "out of memory");
    snprintf(name, sizeof name, "%s.fxs", s->name);
    join_path(scene, o->site, name);
    snprintf(name, sizeof name, "%s.jpg", s->name);
    join_path(poster, o->site, name);
    r->frame = o->frame;
    r->frame.world = (world_options){.scenes = scenes, .scene_count = 1};
    r->output = poster;
    r->encoding = FXS_IMAGE_JPG;
    r->quality = 85;
    const int status = render_views(r);
    free(r);
    return status;
}

/* ---- The page ---------------------------------------------------------------------------------------------------- */

static int write_bytes(publish_options *o, const char *folder, const char *name, const void *bytes, size_t size)
{
    char path[TASK_PATH];
    fxs_message why;
    const fxs_encoded file = {.bytes = bytes, .size = size};
    join_path(path, folder, name);
    o->bytes += size;
    return fxs_encoded_write(path, &file, &why) ? fail_for(&why) : 0;
}

static int copy_files(publish_options *o, const char *from, const char *to)
{
    DIR *folder = opendir(from);
    char path[TASK_PATH];
    int status = folder ? make_folder(to) : fail(EXIT_FAILED, "%s: %s", from, strerror(errno));
    for (struct dirent *entry; folder && !status && (entry = readdir(folder)) != 0;) {
        fxs_mapping file;
        fxs_message why;
        join_path(path, from, entry->d_name);
        if (is_folder(path))
            continue;
        status = fxs_map(&file, path, &why) ? fail_for(&why) : 0;
        if (!status) {
            status = write_bytes(o, to, entry->d_name, file.data, file.bytes);
            fxs_unmap(&file);
        }
    }
    if (folder)
        closedir(folder);
    return status;
}

/* Beside the scene, as the page asks for it. */
static int copy_settings(publish_options *o)
{
    fxs_mapping file;
    fxs_message why;
    if (!o->settings)
        return 0;
    if (fxs_map(&file, o->settings, &why))
        return fail_for(&why);
    const int status = write_bytes(o, o->site, "settings.json", file.data, file.bytes);
    fxs_unmap(&file);
    return status;
}

static int copy_page(publish_options *o, const char *package)
{
    char from[TASK_PATH], to[TASK_PATH], to_viewer[TASK_PATH];
    join_path(from, package, "viewer");
    join_path(to, o->site, "fixsplat");
    join_path(to_viewer, to, "viewer");
    const int status = copy_files(o, package, to);
    return status ? status : copy_files(o, from, to_viewer);
}

/* Prints a format in which each %s is a text, written as HTML wants it. */
static void print_html(FILE *file, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    for (; *format; format++) {
        if (format[0] != '%' || format[1] != 's') {
            fputc(*format, file);
            continue;
        }
        for (const char *text = va_arg(arguments, const char *); *text; text++)
            if (strchr("<>&\"'", *text))
                fprintf(file, "&#%d;", *text);
            else
                fputc(*text, file);
        format++;
    }
    va_end(arguments);
}

static const char head[] =
    "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n"
    "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1, viewport-fit=cover\">\n"
    "<meta name=\"color-scheme\" content=\"dark light\">\n<link rel=\"icon\" href=\"data:,\">\n"
    "<title>%s</title>\n<meta property=\"og:title\" content=\"%s\">\n";
static const char of_scene[] =
    "<meta property=\"og:image\" content=\"%s.jpg\">\n"
    "<link rel=\"stylesheet\" href=\"fixsplat/viewer/page.css\">\n"
    "<script type=\"module\" src=\"fixsplat/viewer/viewer.js\"></script>\n"
    "<fixsplat-viewer src=\"%s.fxs\" poster=\"%s.jpg\" ";
static const char with_settings[] = "settings=\"settings.json\"", without_settings[] = "background=\"#000000\"";
static const char in_scene[] =
    ">\nThis page needs a server of files, say: python3 -m http.server\n</fixsplat-viewer>\n"
    "<noscript>This page draws with WebAssembly, which needs JavaScript.</noscript>\n";
static const char of_list[] =
    "<link rel=\"stylesheet\" href=\"fixsplat/viewer/list.css\">\n"
    "<h1>%s</h1>\n<main>\n";

/* A page of one scene, or the list of all. */
static int write_page(publish_options *o, const char *name, const shown *s)
{
    char *text = 0;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    if (!file)
        return fail(EXIT_FAILED, "out of memory");
    const char *title = o->title ? o->title : s ? s->title : "Scenes";
    print_html(file, head, title, title);
    if (s)
        print_html(file, of_scene, s->name, s->name, s->name);
    if (s)
        fprintf(file, "%s%s", o->settings ? with_settings : without_settings, in_scene);
    else
        print_html(file, of_list, title);
    for (size_t i = 0; i < o->count && !s; i++)
        print_html(file, "<a href=\"%s.html\"><img src=\"%s.jpg\" alt=\"\" loading=\"lazy\">%s</a>\n", o->scenes[i].name,
                   o->scenes[i].name, o->scenes[i].title);
    const int is_whole = !ferror(file) && !fclose(file);
    const int status = is_whole ? write_bytes(o, o->site, name, text, size) : fail(EXIT_FAILED, "out of memory");
    free(text);
    return status;
}

static int write_pages(publish_options *o)
{
    char name[NAMES_MOST + 8];
    int status = write_page(o, "index.html", o->count == 1 ? o->scenes : 0);
    for (size_t i = 0; i < o->count && o->count > 1 && !status; i++) {
        snprintf(name, sizeof name, "%s.html", o->scenes[i].name);
        status = write_page(o, name, &o->scenes[i]);
    }
    return status;
}

/* ---- The command ------------------------------------------------------------------------------------------------- */

/* A folder that is not there, is empty, or is of an earlier call. */
static int take_site(const publish_options *o)
{
    char path[TASK_PATH];
    DIR *folder = opendir(o->site);
    int files = 0;
    for (struct dirent *entry; folder && (entry = readdir(folder)) != 0;)
        files += strcmp(entry->d_name, ".") && strcmp(entry->d_name, "..");
    if (folder)
        closedir(folder);
    join_path(path, o->site, "fixsplat/viewer");
    if (files && !is_folder(path))
        return fail(EXIT_FAILED, "%s: not empty, and not a folder that publish made: give a new one", o->site);
    return make_folder(o->site);
}

static int read_options(publish_options *o, int argc, char **argv)
{
    memset(o, 0, sizeof *o);
    frame_options_default(&o->frame);
    o->frame.load.profile = FXS_PROFILE_SMALL;
    if (take_options(&command_publish, o, argc, argv))
        return EXIT_USAGE;
    if (argc - optind < 2)
        return fail(EXIT_USAGE, "publish takes scenes and a folder to write; see: fixsplat publish --help");
    o->site = argv[argc - 1];
    if (fxs_scene_format_of(o->site, 0))
        return fail(EXIT_USAGE, "publish: %s is a scene: the last name is that of a folder to write", o->site);
    return frame_options_check(&o->frame);
}

static int publish(publish_options *o)
{
    char package[PAGE_PATH];
    int status = page_folder_find(package);
    if (!status && o->settings && o->count > 1)
        status = fail(EXIT_USAGE, "publish: --settings is of one scene, and there are %zu", o->count);
    status = status ? status : take_site(o);
    status = status ? status : copy_settings(o);
    status = status ? status : copy_page(o, package);
    for (size_t i = 0; i < o->count && !status; i++) {
        status = write_scene(o, &o->scenes[i]);
        status = status ? status : write_poster(o, &o->scenes[i]);
    }
    return status ? status : write_pages(o);
}

static int run(int argc, char **argv)
{
    static publish_options o;
    int status = read_options(&o, argc, argv);
    for (int i = optind; i < argc - 1 && !status; i++)
        status = add_scenes(&o, argv[i]);
    status = status ? status : publish(&o);
    if (!status)
        printf("%s: %zu scene%s, %.1f MB with the page; any web server shows it: python3 -m http.server -d %s\n", o.site,
               o.count, o.count == 1 ? "" : "s", (double)o.bytes * 1e-6, o.site);
    for (size_t i = 0; i < o.count; i++)
        free(o.scenes[i].path);
    free(o.scenes);
    return status;
}

const command command_publish = {
    "publish", "scene files -> folder for a web server", run,
    "Usage: fixsplat publish SCENE... SITE [OPTION...]\n\n"
    "Writes a folder that any web server, or a host of static pages, can show: each scene as .fxs, a picture of it,\n"
    "the page with the viewer, and of several scenes a list. A SCENE may be a folder of scenes. A SITE that publish\n"
    "made before is written anew, and keeps what else is in it.\n",
    0,
    "  $ fixsplat publish garden.ply site\n"
    "  $ fixsplat publish garden.fxs site --title 'The garden' --settings settings.json\n"
    "  $ fixsplat publish scenes site --levels\n",
    {{own_rows, 0}, COMMON_TABLE}
};
