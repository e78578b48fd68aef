/* fixsplat publish: writes a folder for web servers, with scenes, pictures and a page. With --single, writes a
   single file instead. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/scene.h>
#include <fixsplat/system.h>
#include "src/base/os_calls.h"
#include "cmd_render.h"
#include "file_guard.h"
#include "make_voxels.h"
#include "tools/serve/made_list.h"
#include "tools/serve/page_folder.h"
#include "publish_scene.h"
#include "publish_single.h"
#include "tools/serve/scene_list.h"
#include "tools/serve/scene_pages.h"
#include "tools/serve/scene_picture.h"
#include "task.h"

/* What the page tells of a scene besides its names. */
typedef struct page_facts {
    char frame[POSTER_FRAME];
    const char *sound;             /* ending of the sound's file; null: none */
    double volume;
} page_facts;

typedef struct publish_options {
    frame_options frame;
    publish_start start;
    const char *title, *site, *settings;
    char *const *words;
    int single, walk;
    char mark[TASK_PATH];          /* path of the file that marks an unfinished folder */
    scene_list list;
    page_facts *facts;             /* for each scene */
    size_t bytes;
    made_list made;                /* new files and folders, removed on failure */
} publish_options;

#define OPTIONS publish_options

static const option_row own_rows[] = {
    {.help = "Options:"},
    {"title", "TEXT", TEXT(title), .basic = 1, .help =
     "title of the page or, for several scenes, of their list (default: the scene's name)"},
    {"profile", "P", CHOICE(frame.load.profile, profile_names), .basic = 1, .help =
     "how scenes are packed: small (20 bytes per Gaussian), compact or default (default: small; an .fxs is copied "
     "unchanged)"},
    {"single", 0, FLAG(single), .basic = 1, .help =
     "write one scene as one .html file that holds everything. It opens by a double click, without a server or a "
     "network"},
    {"walk", 0, FLAG(walk), .basic = 1, .help =
     "make walls for walking (key 3), as fixsplat collide does from the start view: files NAME.voxel.json and .bin"},
    {"levels", 0, FLAG(frame.load.tree), .basic = 1, .help =
     "pack scenes, .fxs included, with levels of detail: the page then fetches only the visible part of a large scene"},
    {"up", "X,Y,Z", take_direction, FIELD(vector_option, start.up), .expected = DIRECTION_EXPECTED, .basic = 1, .help =
     "up direction in the page, in the axes of a .ply (x right, y down, z to the front). The start view is then chosen "
     "anew (default: the .fxs's own, else found in the scene)"},
    {"start-view", "EYE,LOOK[,FOV]|CAMERAS[:VIEW]", take_start, FIELD(start_option, start.view),
     .expected = START_EXPECTED, .basic = 1, .help =
     "first view of the page and the poster, for one scene: as for fixsplat convert (default: the .fxs's own, else "
     "chosen by looking at the scene from many sides)"},
    {"size", "WxH", take_frame_size, FIELD(frame_options, frame), .expected = SIZE_EXPECTED,
     .help = "size of the poster (default 1280x720)"},
    {"sound", "FILE", take_sound, FIELD(const char *, start.sound), .expected = SOUND_EXPECTED, .basic = 1, .help =
     "sound of a moving scene, which the page plays with it, for one scene: .mp3, .m4a, .aac, .ogg, .opus, .wav, "
     ".flac or .webm (default: the sound in the scene's file)"},
    {"settings", "FILE", TEXT(settings), .basic = 1, .help =
     "settings file of the viewer or of supersplat-viewer, with camera, annotations and tracks; for a folder of one "
     "scene"},
    {0}
};

static int write_bytes(publish_options *o, const char *folder, const char *name, const void *bytes, size_t size)
{
    char path[TASK_PATH];
    fxs_message why;
    const fxs_encoded file = {.bytes = bytes, .size = size};
    join_path(path, folder, name);
    made_list_add(&o->made, path);
    o->bytes += size;
    return fxs_encoded_write(path, &file, &why) ? fail_for(&why) : 0;
}

static int write_sound(publish_options *o, size_t number, const fxs_sound *sound)
{
    char name[LISTED_NAME + 8];
    if (!sound->data)
        return 0;
    o->facts[number].sound = sound->ending;
    o->facts[number].volume = sound->volume;
    snprintf(name, sizeof name, "%s%s", o->list.scenes[number].name, sound->ending);
    return write_bytes(o, o->site, name, sound->data, sound->bytes);
}

/* Writes the voxels of a scene, for walking. */
static int write_walls(publish_options *o, const listed_scene *s, const loaded_scene *scene)
{
    const voxel_options options = {.hint = ": publish without --walk, or give a --start-view in a free place"};
    char name[LISTED_NAME + 16], path[TASK_PATH], bin[TASK_PATH];
    fxs_voxels *voxels = 0;
    fxs_message why;
    int status = make_voxels(&voxels, &options, scene, &o->frame);
    snprintf(name, sizeof name, "%s.voxel.json", s->name);
    join_path(path, o->site, name);
    snprintf(name, sizeof name, "%s.voxel.bin", s->name);
    join_path(bin, o->site, name);
    made_list_add(&o->made, path);
    made_list_add(&o->made, bin);
    if (!status && fxs_voxels_write(voxels, path, &why))
        status = fail_for(&why);
    fxs_voxels_free(voxels);
    return status;
}

static int write_scene(publish_options *o, size_t number)
{
    const listed_scene *s = &o->list.scenes[number];
    char name[LISTED_NAME + 8], path[TASK_PATH];
    loaded_scene scene;
    fxs_message why;
    snprintf(name, sizeof name, "%s.fxs", s->name);
    join_path(path, o->site, name);
    load_options own;
    if (options_of_file(&own, &o->frame.load, 0, 1) ||
        publish_load(&scene, s->path, &own, is_given("profile"), &o->start))
        return EXIT_FAILED;
    if (o->walk && scene.opened->scene->motion) {
        free_scene(&scene);
        return fail(EXIT_FAILED, "%s: a scene that moves has no voxels: publish it without --walk", s->path);
    }
    if (!is_given("profile"))
        publish_say_gain(&scene, o->words);
    o->bytes += scene.opened->bytes;
    publish_frame(o->facts[number].frame, scene.opened, o->frame.width ? o->frame.width : PICTURE_WIDTH,
                  o->frame.height ? o->frame.height : PICTURE_HEIGHT);
    made_list_add(&o->made, path);
    int status = fxs_file_write(path, scene.opened->data, scene.opened->bytes, &why) ? fail_for(&why) : 0;
    status = status ? status : write_sound(o, number, &scene.sound);
    if (!status && o->walk)
        status = write_walls(o, s, &scene);
    free_scene(&scene);
    return status;
}

static int write_poster(publish_options *o, const listed_scene *s)
{
    render_options *r = calloc(1, sizeof *r);
    char name[LISTED_NAME + 8], scene[TASK_PATH], poster[TASK_PATH], *scenes[] = {scene};
    if (!r)
        return fail(EXIT_FAILED, "out of memory");
    snprintf(name, sizeof name, "%s.fxs", s->name);
    join_path(scene, o->site, name);
    snprintf(name, sizeof name, "%s.jpg", s->name);
    join_path(poster, o->site, name);
    made_list_add(&o->made, poster);
    r->frame = o->frame;
    r->frame.load.again = 1;
    r->frame.world = (world_options){.scenes = scenes, .scene_count = 1};
    r->output = poster;
    r->encoding = FXS_IMAGE_JPG;
    r->quality = 85;
    const int status = render_views(r);
    files_done();
    free(r);
    return status;
}

typedef struct copying {
    publish_options *o;
    const char *from, *to;
    int status;
} copying;

static void copy_file(void *argument, const char *name)
{
    copying *c = argument;
    char path[TASK_PATH];
    fxs_mapping file;
    fxs_message why;
    join_path(path, c->from, name);
    if (c->status || is_folder(path))
        return;
    c->status = fxs_map_open(&file, path, &why) ? fail_for(&why) : 0;
    if (!c->status) {
        c->status = write_bytes(c->o, c->to, name, file.data, file.bytes);
        fxs_map_close(&file);
    }
}

static int copy_files(publish_options *o, const char *from, const char *to)
{
    made_list_add(&o->made, to);
    copying c = {o, from, to, make_folder(to)};
    return fxs_folder_each(from, copy_file, &c) ? fail(EXIT_FAILED, "%s: %s", from, strerror(errno)) : c.status;
}

static int copy_settings(publish_options *o)
{
    fxs_mapping file;
    fxs_message why;
    if (!o->settings)
        return 0;
    if (fxs_map_open(&file, o->settings, &why))
        return fail_for(&why);
    const int status = write_bytes(o, o->site, "settings.json", file.data, file.bytes);
    fxs_map_close(&file);
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

static void print_scene(FILE *file, const char *title, const char *name, const page_facts *facts,
                        const publish_options *o)
{
    static const char of_scene[] =
        "<meta property=\"og:image\" content=\"%s.jpg\">\n"
        "<link rel=\"stylesheet\" href=\"fixsplat/viewer/page.css\">\n"
        "<script type=\"module\" src=\"fixsplat/viewer/published.js\"></script>\n"
        "<fixsplat-viewer src=\"%s.fxs\" label=\"%s\" poster=\"%s.jpg\"";
    static const char in_scene[] =
        ">\n<img src=\"%s.jpg\" alt=\"\">\n"
        "<p>The scripts of this page are missing: reload it. "
        "A page in a folder needs a server: python3 -m http.server</p>\n</fixsplat-viewer>\n"
        "<noscript>This page draws with WebAssembly, which needs JavaScript.</noscript>\n";
    print_page_head(file, title);
    print_html(file, of_scene, name, name, title, name);
    if (facts->sound) {
        print_html(file, " sound=\"%s%s\"", name, facts->sound);
        fprintf(file, " volume=\"%g\"", facts->volume);
    }
    fprintf(file, "%s%s", facts->frame, o->settings ? " settings=\"settings.json\"" : " background=\"#000000\"");
    if (o->walk)
        print_html(file, " walls=\"%s.voxel.json\"", name);
    print_html(file, in_scene, name);
}

static void print_list(FILE *file, const char *title, const scene_list *list)
{
    char address[LISTED_NAME + 8], poster[LISTED_NAME + 8];
    print_list_head(file, title, "fixsplat/viewer");
    for (size_t i = 0; i < list->count; i++) {
        snprintf(address, sizeof address, "%s.html", list->scenes[i].name);
        snprintf(poster, sizeof poster, "%s.jpg", list->scenes[i].name);
        print_listed(file, address, poster, list->scenes[i].title);
    }
}

/* Writes the page of a scene, or of the list of scenes if `s` is null. */
static int write_page(publish_options *o, const char *name, const listed_scene *s)
{
    fxs_printed printed;
    if (fxs_print_begin(&printed))
        return fail(EXIT_FAILED, "out of memory");
    FILE *file = printed.file;
    const int is_one = s && o->list.count > 1;
    const char *title = o->title && !is_one ? o->title : s ? s->title : "Scenes";
    if (s)
        print_scene(file, title, s->name, &o->facts[s - o->list.scenes], o);
    else
        print_list(file, title, &o->list);
    if (fxs_print_end(&printed))
        return fail(EXIT_FAILED, "out of memory");
    const int status = write_bytes(o, o->site, name, printed.text, printed.size);
    free(printed.text);
    return status;
}

static int write_pages(publish_options *o)
{
    char name[LISTED_NAME + 8];
    int status = write_page(o, "index.html", o->list.count == 1 ? o->list.scenes : 0);
    for (size_t i = 0; i < o->list.count && o->list.count > 1 && !status; i++) {
        snprintf(name, sizeof name, "%s.html", o->list.scenes[i].name);
        status = write_page(o, name, &o->list.scenes[i]);
    }
    return status;
}

static void count_file(void *files, const char *name)
{
    *(int *)files += strcmp(name, ".") && strcmp(name, "..");
}

/* Accepts an output folder that is missing, empty, or from an earlier publish. A marker file exists until the folder
   is complete. */
static int take_site(publish_options *o)
{
    char page[TASK_PATH];
    int files = 0;
    fxs_folder_each(o->site, count_file, &files);
    join_path(page, o->site, "fixsplat/viewer");
    join_path(o->mark, o->site, ".fixsplat-publish");
    const int has_mark = fxs_file_kind(o->mark) == FXS_FILE_REGULAR;
    if (files && !is_folder(page) && !has_mark)
        return fail(EXIT_FAILED, "%s: not empty, and not a folder that publish made: give a new one", o->site);
    made_list_add_folders(&o->made, o->site);
    const int status = make_folders(o->site);
    if (status || files)
        return status;
    made_list_add(&o->made, o->mark);
    FILE *mark = fxs_stream_open(o->mark, "w");
    return mark && !fclose(mark) ? 0 : fail(EXIT_FAILED, "%s: %s", o->mark, strerror(errno));
}

static int read_options(publish_options *o, int argc, char **argv)
{
    memset(o, 0, sizeof *o);
    frame_options_default(&o->frame);
    o->frame.load.profile = FXS_PROFILE_SMALL;
    o->frame.load.sound = SOUND_KEPT;
    if (take_options(&command_publish, o, argc, argv))
        return EXIT_USAGE;
    if (argc - optind < 2)
        return fail(EXIT_USAGE, "publish takes scenes and a folder to write; see: fixsplat publish --help");
    o->site = argv[argc - 1];
    o->words = argv;
    if (fxs_scene_format_of(o->site, 0))
        return fail(EXIT_USAGE, "publish: %s is a scene: the last name is that of %s to write", o->site,
                    o->single ? "a file" : "a folder");
    if (!o->single && ends_with(o->site, ".html"))
        return fail(EXIT_USAGE, "publish: %s is the name of a file: give --single, or the name of a folder", o->site);
    if (o->single && !ends_with(o->site, ".html"))
        return fail(EXIT_USAGE, "publish: --single writes a file whose name ends in .html, not %s", o->site);
    return frame_options_check(&o->frame);
}

static int publish_folder(publish_options *o, const char *package)
{
    const char *of_one = o->settings ? "settings" : o->start.view.given ? "start-view" : o->start.sound ? "sound" : 0;
    int status = of_one && o->list.count > 1
                     ? fail(EXIT_USAGE, "publish: --%s is for one scene, not %zu", of_one, o->list.count)
                     : take_site(o);
    o->facts = calloc(o->list.count, sizeof *o->facts);
    status = status || o->facts ? status : fail(EXIT_FAILED, "out of memory");
    status = status ? status : copy_settings(o);
    status = status ? status : copy_page(o, package);
    for (size_t i = 0; i < o->list.count && !status; i++) {
        status = write_scene(o, i);
        status = status ? status : write_poster(o, &o->list.scenes[i]);
    }
    status = status ? status : write_pages(o);
    if (!status)
        fxs_file_remove(o->mark);
    return status;
}

static int publish_file(publish_options *o, const char *package)
{
    const listed_scene *s = o->list.scenes;
    if (o->list.count != 1)
        return fail(EXIT_USAGE, "publish: --single takes one scene, not %zu", o->list.count);
    if (o->settings || o->walk)
        return fail(EXIT_USAGE, "publish: --%s does not go with --single", o->settings ? "settings" : "walk");
    const single_page page = {.package = package, .title = o->title ? o->title : s->title, .scene = s->path,
                              .name = s->name, .words = o->words, .start = &o->start,
                              .has_profile = is_given("profile")};
    return write_single(&page, &o->frame, o->site, &o->bytes);
}

static void report(const publish_options *o)
{
    const double megabytes = (double)o->bytes * 1e-6;
    if (o->single)
        printf("%s: %.1f MB, all in one file: any browser opens it, without a server or a network\n", o->site,
               megabytes);
    else {
        printf("%s: %zu scene%s, %.1f MB with the page; any web server shows it: " FXS_PYTHON " -m http.server -d",
               o->site, o->list.count, o->list.count == 1 ? "" : "s", megabytes);
        write_shell_word(stdout, o->site);
        puts("");
    }
}

static int run(int argc, char **argv)
{
    static publish_options o;
    char package[PAGE_PATH];
    int status = read_options(&o, argc, argv);
    for (int i = optind; i < argc - 1 && !status; i++)
        status = scene_list_add(&o.list, argv[i]);
    status = status ? status : page_folder_find(package);
    status = status ? status : o.single ? publish_file(&o, package) : publish_folder(&o, package);
    if (!status)
        report(&o);
    else
        made_list_remove(&o.made);
    made_list_free(&o.made);
    scene_list_free(&o.list);
    free(o.facts);
    return status;
}

const command command_publish = {
    "publish", "scene files -> folder for a web server", run,
    "Usage: fixsplat publish SCENE... SITE [OPTION...]\n"
    "       fixsplat publish --single SCENE FILE.html [OPTION...]\n\n"
    "Writes a folder for any web server or static host: each scene as .fxs with a picture, the page with the viewer,\n"
    "and a list for several scenes. A SCENE may be a folder of scenes. A SITE that publish made before is updated;\n"
    "other files in it stay.\n",
    0,
    "  $ fixsplat publish garden.ply site\n"
    "  $ fixsplat publish garden.fxs site --title 'The garden' --settings settings.json\n"
    "  $ fixsplat publish scenes site --levels\n"
    "  $ fixsplat publish room.fxs site --walk\n"
    "  $ fixsplat publish --single garden.ply garden.html\n",
    {{own_rows, 0}, COMMON_TABLE}
};
