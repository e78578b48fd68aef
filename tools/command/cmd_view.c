/* Command-line options of `fixsplat view`. Separate programs, fixsplat-view and fixsplat-web, open the window and serve
   the web page; headset.c shows the scenes in a headset. */
#include <string.h>

#include <fixsplat/image.h>
#include "programs.h"
#include "cmd_view.h"
#include "views.h"

const char viewer_keys[] =
    "left drag      orbit\n"
    "right drag     pan, also middle drag\n"
    "wheel          zoom\n"
    "double click   turn about what is there\n"
    "w a s d q e    fly, faster with shift\n"
    "space, mouse   look around\n"
    "space [ ] y    scene that moves: play or pause, speed, once or again\n"
    "+ -            speed of flight\n"
    "n              next view, with shift the previous one\n"
    "r              back to the view\n"
    "p              screenshot\n"
    "m              measure between two clicks\n"
    "k              film the way from here; again: write it, fixsplat-001.y4m\n"
    "z i            depths, ids; again: colours\n"
    "c              crop box, by its handles; again: the whole scene\n"
    "enter          write the crop box or the edits, SCENE-cropped-001\n"
    "l j            lasso, brush (shift adds, alt takes out), object; front only\n"
    "delete u       delete selection or crop box, undo; shift: keep, redo\n"
    "1 2 3          1 or 2: turn and fly; 3: walk, also by arrows, q e turn\n"
    "x 0 v b        cut-off, SH degree, resolution in motion, back end\n"
    "f g o          frames a second, frame times, colours of the levels\n"
    ", .            a frame back, forward; still scenes: fewer, more Gaussians\n"
    "t h            dark or light words, these keys\n"
    "escape         leave the crop box or the walk, or quit\n";

#define OPTIONS view_options

static const option_row window_rows[] = {
    {.help = "Options:"},
    {"screenshot", "OUT", TEXT(screenshot), .basic = 1, .help =
     "picture that key p writes: .png, .ppm, .raw, .jpg or .webp (default: fixsplat-001.png and on, in the current "
     "folder). A command that renders it again is printed, except for depths, ids and crops"},
    {"walls", "FILE", TEXT(walls), .help =
     "walls of the scene for walks (key 3): a .voxel.json of fixsplat collide or splat-transform (default: made from "
     "the scene when a walk begins)"},
    {"eye-height", "H", REAL(eye_height, 1e-6, 1e6, "units from 1e-6 to 1e6"), .help =
     "height of the eye above the ground in walks, units (default: estimated from the view of --cameras, --eye or the "
     "file, else an eighth of the scene's height)"},
    {"fps", "N", REAL(rate, 1, 1000, "1 to 1000 frames a second"), .help =
     "for scenes with levels of detail: adapt the budget while the view moves, to draw N frames per second, 1 to 1000 "
     "(default: fixed budget). Pictures then depend on the speed of the machine"},
    {0}
};

static const option_row page_rows[] = {
    {.help = "In a browser:"},
    {"web", 0, FLAG(web), .basic = 1, .help =
     "serve a page that shows the scenes, print its address and open it, until Ctrl-C. Several scenes, or a folder, "
     "become a list with pictures. A changed file is shown anew. --cameras, --view, --bg and the options of imports "
     "apply, the others of the window do not"},
    {"no-open", 0, FLAG(no_open), .help =
     "do not open a browser (default: open one on a desktop, from a terminal, unless FIXSPLAT_NO_OPEN is set)"},
    {"qr", 0, FLAG(qr), .help =
     "print the address as a QR code (default: in a terminal, with --bind for other machines)"},
    {"levels", 0, FLAG(frame.load.tree), .help =
     "pack scenes with levels of detail: the page then fetches only the visible part of a large scene"},
    {"port", "N", UINT64(port, 0, 65535), .help = "port, 1 to 65535, or 0 for any free port (default 8080)"},
    {"bind", "ADDRESS", TEXT(bind), .help =
     "address to listen on: 0.0.0.0 for every machine of the network, or one address of this machine (default "
     "127.0.0.1)"},
    {"host", "NAME", TEXT(host), .help =
     "also answer to this host name (default: numeric addresses, localhost and, with --bind, this machine's name)"},
    {"cert", "FILE", TEXT(certificate), .help =
     "serve https with this certificate, .pem; browsers on other machines require https for threads and headsets"},
    {"key", "FILE", TEXT(key), .help = "key of that certificate, .pem"},
    {0}
};

static const option_row headset_rows[] = {
    {.help = "In a headset:"},
    {"xr", 0, FLAG(xr), .basic = 1, .help =
     "show the scenes in a headset through OpenXR, until Ctrl-C, by --backend vulkan (default) or gles-compute. The "
     "head starts at the view. The clock chooses the resolution and, with levels of detail, the budget"},
    {"metres-per-unit", "X", REAL(metres_per_unit, 1e-6, 1e6, "metres, 1e-6 to 1e6"), .help =
     "size of a scene unit with --xr, metres (default 1)"},
    {"pass-through", 0, FLAG(pass_through), .help = "show the room behind the scene with --xr, if the headset can"},
    {0}
};

/* Options of the window and the page that do nothing in a headset. */
static const option_rule headset_rules[] = {
    {"metres-per-unit pass-through", 0, "xr", 0},
    {"web screenshot walls eye-height fps", "xr", 0, 0},
    {"fov tangents ortho near size stereo", "xr", 0, "the headset has its own"},
    {"device cpu", "xr", 0, "the runtime chooses the device"},
    {0}
};

static int is_for_page(const char *name)
{
    static const char *const taken[] = {"cameras", "view", "bg", "threads", "profile"};
    for (size_t i = 0; i < sizeof taken / sizeof *taken; i++)
        if (!strcmp(name, taken[i]))
            return 1;
    return 0;
}

static const char *given_of(const option_row *rows)
{
    for (; rows->help; rows++)
        if (rows->name && is_given(rows->name) && !is_for_page(rows->name))
            return rows->name;
    return 0;
}

static int check_web(const view_options *o)
{
    const option_row *const of_window[] = {window_rows, camera_rows, world_rows, frame_rows, level_rows, pool_rows};
    const char *name = given_of(page_rows);
    if (!o->web && name)
        return fail(EXIT_USAGE, "view: --%s needs --web", name);
    for (size_t i = 0; o->web && i < sizeof of_window / sizeof *of_window; i++)
        if ((name = given_of(of_window[i])) != 0)
            return fail(EXIT_USAGE, "view: --%s is for the window, not for --web", name);
    if (o->web && is_given("rate"))
        return fail(EXIT_USAGE, "view: --rate is for the window, not for --web");
    if (!o->certificate != !o->key)
        return fail(EXIT_USAGE, "view: --cert and --key: give both");
    return check_rules(headset_rules);
}

static int check_headset(const view_options *o)
{
    const char *by = o->frame.backend;
    return !o->xr || !strcmp(by, "auto") || !strcmp(by, "vulkan") || !strcmp(by, "gles-compute")
               ? 0 : fail(EXIT_USAGE, "--xr draws by --backend vulkan or gles-compute, not by %s", by);
}

static int take_scenes_or_none(view_options *o, int count, char *const *scenes)
{
    world_options *w = &o->frame.world;
    if (o->web || o->xr || count || w->file)
        return take_scenes(w, "view", count, scenes);
    if (o->frame.cameras || w->place_count)
        return fail(EXIT_USAGE, "view: --%s needs a scene", o->frame.cameras ? "cameras" : "place");
    return 0;
}

static void list_keys(void)
{
    puts("\nKeys:");
    for (const char *key = viewer_keys, *end; (end = strchr(key, '\n')) != 0; key = end + 1)
        printf("  %.*s\n", (int)(end - key), key);
}

int view_options_take(view_options *o, int argc, char **argv)
{
    memset(o, 0, sizeof *o);
    o->bind = "127.0.0.1";
    o->port = 8080;
    frame_options_default(&o->frame);
    o->frame.load.pages = 1;
    if (take_options(&command_view, o, argc, argv))
        return EXIT_USAGE;
    if (check_web(o) || check_headset(o) || take_scenes_or_none(o, argc - optind, argv + optind))
        return EXIT_USAGE;
    if (names_several(o->frame.view))
        return fail(EXIT_USAGE, "view: --view takes one view to start from; n shows the others");
    if (o->screenshot && !fxs_image_file_known(o->screenshot))
        return fail(EXIT_USAGE, "%s: expected a name ending in .png, .ppm, .raw, .jpg or .webp", o->screenshot);
    if (o->walls && !ends_with(o->walls, ".voxel.json"))
        return fail(EXIT_USAGE, "--walls %s: expected a name ending in .voxel.json", o->walls);
    if (o->walls && !o->frame.world.file && !o->frame.world.scene_count)
        return fail(EXIT_USAGE, "view: --walls needs a scene");
    return frame_options_check(&o->frame);
}

static const char *scene_name(const view_options *o)
{
    const world_options *w = &o->frame.world;
    return w->file ? w->file : w->scene_count ? w->scenes[0] : "view";
}

static int run(int argc, char **argv)
{
    view_options o;
    int status = view_options_take(&o, argc, argv);
    if (!status && o.xr)
        return view_in_headset(&o);
    return status ? status : run_separate(o.web ? &server_program : &window_program, scene_name(&o), argv);
}

const command command_view = {
    "view", "scene file -> window, --web: page, --xr: headset", run,
    "Usage: fixsplat view [SCENE...] [OPTION...]\n\n"
    "Shows scenes in a window, in a browser with --web, or in a headset with --xr. fixsplat help formats lists\n"
    "the scene formats.\n\n"
    "A scene that moves plays; with --time, it is paused at that moment. The bar below it seeks.\n\n"
    "The window opens files that are dropped on it. Without a scene, it lists the last ten scenes, from the file\n"
    "$XDG_STATE_HOME/fixsplat/recent (default ~/.local/state/fixsplat/recent; Windows: %APPDATA%\\fixsplat\\recent).\n"
    "Key c shows a crop box; key enter writes its contents beside the scene, in the same format or else as .ply, and\n"
    "prints the convert command that does the same. After key l, enter writes SCENE-edited-001.fxs, and the edits for\n"
    "convert --edits in SCENE-edits-001.json. With --cameras, the default of --up is the mean of the views.\n",
    list_keys,
    "  $ fixsplat view scene.ply\n"
    "  $ fixsplat view scene.ply --cameras cameras.json --view 8\n"
    "  $ fixsplat view --web folder\n"
    "  $ fixsplat view scene.ply --up 0,0,1 --size 1920x1080 --screenshot shot.png\n"
    "  $ fixsplat view room.fxs --walls room.voxel.json\n"
    "  $ fixsplat view city.fxs --budget 1000000 --pool 512M\n"
    "  $ fixsplat view https://example.org/city.fxs --fps 60\n"
    "  $ fixsplat view scene.ply --web --bind 0.0.0.0 --cert cert.pem --key key.pem\n"
    "  $ fixsplat view --xr room.fxs --metres-per-unit 1\n",
    {{window_rows, 0}, {page_rows, 0}, {headset_rows, 0}, FRAME_TABLES(view_options), POOL_TABLE(view_options),
     COMMON_TABLE}
};
