/* fixsplat view */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <fixsplat/image_file.h>
#include "cmd_view.h"
#include "views.h"

const char viewer_keys[] =
    "left drag      orbit\n"
    "right drag     pan, also middle drag\n"
    "wheel          zoom\n"
    "double click   turn about what is there\n"
    "w a s d q e    fly, faster with shift\n"
    "space, mouse   look around\n"
    "+ -            speed of flight\n"
    "n              next view, with shift the previous one\n"
    "r              back to the view\n"
    "p              screenshot\n"
    "m              measure between two clicks\n"
    "k              film the way from here; again: write it, fixsplat-001.y4m\n"
    "z i            depths, ids; again: colours\n"
    "c              crop box, by its handles; again: the whole scene\n"
    "enter          write what is in the crop box, SCENE-cropped-001\n"
    "x              cut-off\n"
    "0 1 2 3        SH degree\n"
    "v              resolution in motion\n"
    "b              back end\n"
    "f g            frames a second, frame times\n"
    "t              dark or light words\n"
    "h              these keys\n"
    "escape         leave the crop box, or quit\n";

static const char help[] =
    "Usage: fixsplat view [SCENE...] [OPTION...]\n\n"
    "Shows scenes (.fxs, .ply, .splat, .ksplat, .lcc, .spz, .sog, .gltf, .glb, tileset.json) in a window; opens files\n"
    "dropped on it. Without a scene the window waits for one, and lists the last ten that were open; they are kept\n"
    "in $XDG_STATE_HOME/fixsplat/recent (~/.local/state/fixsplat/recent). Key enter writes what the crop box of key c\n"
    "leaves beside the scene, in its format or else as .ply; the convert command that does the same is printed.\n"
    "With --cameras, up is the mean of the views' up, unless --up says otherwise.\n\n"
    "  --screenshot OUT    the picture that key p writes: .png, .ppm, .raw, .jpg or .webp (default: fixsplat-001.png\n"
    "                      and on, in the current folder); the command that renders it again is printed, but not for\n"
    "                      depths, ids and crops\n"
    "In a browser:\n"
    "  --web               serve the scenes and a page that shows them, and print the page's address, until Ctrl-C.\n"
    "                      Of what follows it takes --cameras, --view, --bg and the options of an import; a scene is\n"
    "                      sent as it lies on the disk, or packed here where it has several files or such an option\n"
    "  --port N            1 to 65535, or 0 for any that is free (default 8080)\n"
    "  --bind ADDRESS      0.0.0.0 for every machine of the network, or one address of this one (default 127.0.0.1)\n"
    "  --cert FILE --key FILE\n"
    "                      https by this certificate, .pem: what browsers of other machines ask for before a page may\n"
    "                      have threads or a headset\n"
    "%s%s\n"
    "Keys:\n"
    "%s\n"
    "Examples:\n"
    "  fixsplat view scene.ply\n"
    "  fixsplat view scene.ply --cameras cameras.json --view 8\n"
    "  fixsplat view scene.ply --up 0,0,1 --size 1920x1080 --screenshot shot.png\n"
    "  fixsplat view scene.ply --web --bind 0.0.0.0 --cert cert.pem --key key.pem\n";

enum { OPT_SCREENSHOT = OPT_OWN, OPT_WEB, OPT_PORT, OPT_BIND, OPT_CERT, OPT_KEY };

/* Of the options of frames, those that --web takes. */
static int is_for_web(int option)
{
    static const int taken[] = {OPT_CAMERAS, OPT_VIEW, OPT_BG, OPT_AXES, OPT_LOD, OPT_PROFILE, OPT_THREADS,
                                OPT_MAX_GAUSSIANS, OPT_IMPORT_MEMORY};
    for (size_t i = 0; i < sizeof taken / sizeof *taken; i++)
        if (taken[i] == option)
            return 1;
    return 0;
}

/* Options of the window with the page, and the other way round. */
static int check_web(const view_options *o, const char *of_window, const char *of_page)
{
    if (o->web && of_window)
        return fail(EXIT_USAGE, "view: --web shows scenes as the page does: no --%s", of_window);
    if (!o->web && of_page)
        return fail(EXIT_USAGE, "view: --%s needs --web", of_page);
    if (!o->certificate != !o->key)
        return fail(EXIT_USAGE, "view: --cert and --key: give both");
    return 0;
}

/* The scenes that are given; a window may wait for one. */
static int take_scenes_or_none(view_options *o, int count, char *const *scenes)
{
    world_options *w = &o->frame.world;
    if (o->web || count || w->file)
        return take_scenes(w, "view", count, scenes);
    if (o->frame.cameras || w->place_count)
        return fail(EXIT_USAGE, "view: --%s needs a scene", o->frame.cameras ? "cameras" : "place");
    return 0;
}

static void print_help(void)
{
    printf(help, camera_options_help, frame_options_help, viewer_keys);
}

static int take_option(view_options *o, int which, const char *value)
{
    switch (which) {
    case OPT_SCREENSHOT: o->screenshot = value; return 0;
    case OPT_WEB: o->web = 1; return 0;
    case OPT_BIND: o->bind = value; return 0;
    case OPT_CERT: o->certificate = value; return 0;
    case OPT_KEY: o->key = value; return 0;
    case OPT_PORT: return take_number("port", value, 0, 65535, &o->port);
    default: return frame_option(&o->frame, which, value);
    }
}

int view_options_take(view_options *o, int argc, char **argv)
{
    static const struct option table[] = {
        FRAME_OPTIONS, {"screenshot", required_argument, 0, OPT_SCREENSHOT}, {"web", no_argument, 0, OPT_WEB},
        {"port", required_argument, 0, OPT_PORT}, {"bind", required_argument, 0, OPT_BIND},
        {"cert", required_argument, 0, OPT_CERT}, {"key", required_argument, 0, OPT_KEY}, COMMON_OPTIONS
    };
    const char *of_window = 0, *of_page = 0;
    int index = 0;
    memset(o, 0, sizeof *o);
    o->bind = "127.0.0.1";
    o->port = 8080;
    frame_options_default(&o->frame);
    for (int c; (c = next_option(argc, argv, COMMON_LETTERS, table, &index, print_help)) != -1;) {
        if (c > OPT_WEB)
            of_page = table[index].name;
        else if (c != OPT_WEB && !is_for_web(c))
            of_window = table[index].name;
        if (c == '?' || take_option(o, c, optarg))
            return EXIT_USAGE;
    }
    if (check_web(o, of_window, of_page) || take_scenes_or_none(o, argc - optind, argv + optind))
        return EXIT_USAGE;
    if (names_several(o->frame.view))
        return fail(EXIT_USAGE, "view: --view takes one view to start from; n shows the others");
    if (o->screenshot && !fxs_image_file_known(o->screenshot))
        return fail(EXIT_USAGE, "%s: expected a name ending in .png, .ppm, .raw, .jpg or .webp", o->screenshot);
    return frame_options_check(&o->frame);
}

static const char *scene_name(const view_options *o)
{
    const world_options *w = &o->frame.world;
    return w->file ? w->file : w->scene_count ? w->scenes[0] : "view";
}

/* What of the program needs libraries that are many, and that the other commands do without, is a program beside it. */
#ifdef FXS_WITH_SDL
static const char window[] = "-view";
#else
static const char window[] = "";
#endif
#ifdef FXS_WITH_MICROHTTPD
static const char server[] = "-web";
#else
static const char server[] = "";
#endif

static int show(const view_options *o, char **argv)
{
    const char *ending = o->web ? server : window, *without = o->web ? "libmicrohttpd" : "SDL2";
    char path[4096] = "fixsplat";
    if (!*ending)
        return fail(EXIT_FAILED, "%s: cannot be shown: this program was built without %s", scene_name(o), without);
    ssize_t length = readlink("/proc/self/exe", path, sizeof path - sizeof "-view");
    strcpy(path + (length > 0 ? (size_t)length : strlen(path)), ending);
    execvp(path, argv);
    return fail(EXIT_FAILED, "%s: cannot be shown: %s: %s", scene_name(o), path, strerror(errno));
}

int command_view(int argc, char **argv)
{
    view_options o;
    int status = view_options_take(&o, argc, argv);
    return status ? status : show(&o, argv);
}
