/* fixsplat view */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../port/image/image_file.h"
#include "view.h"

const char viewer_keys[] =
    "left drag      orbit\n"
    "right drag     pan, also middle drag\n"
    "wheel          zoom\n"
    "w a s d q e    fly, faster with shift\n"
    "space, mouse   look around\n"
    "+ -            speed of flight\n"
    "n p            next, previous view\n"
    "r              back to the view\n"
    "c              cut-off\n"
    "0 1 2 3        SH degree\n"
    "v              resolution in motion\n"
    "b              back end\n"
    "g              frame times\n"
    "i              screenshot\n"
    "h              these keys\n"
    "escape         quit\n";

static const char help[] =
    "Usage: fixsplat view SCENE... [OPTION...]\n\n"
    "Shows scenes (.fxs, .ply, .splat, .ksplat, .spz, .sog, .gltf, .glb, tileset.json) in a window; opens files\n"
    "dropped on it.\n"
    "With --cameras, up is the mean of the views' up, unless --up says otherwise.\n\n"
    "  --screenshot OUT    the picture that key i writes: .png, .ppm or .raw (default: beside the scene,\n"
    "                      SCENE-001.png and on); the command that renders it again is printed\n"
    "%s%s\n"
    "Keys:\n"
    "%s\n"
    "Examples:\n"
    "  fixsplat view scene.ply\n"
    "  fixsplat view scene.ply --cameras cameras.json --view 8\n"
    "  fixsplat view scene.ply --up 0,0,1 --size 1920x1080 --screenshot shot.png\n";

enum { OPT_SCREENSHOT = OPT_OWN };

int view_options_take(view_options *o, int argc, char **argv)
{
    static const struct option table[] = {FRAME_OPTIONS, {"screenshot", required_argument, 0, OPT_SCREENSHOT},
                                          {0, 0, 0, 0}};
    memset(o, 0, sizeof *o);
    frame_options_default(&o->frame);
    opterr = 0;
    for (int c; (c = getopt_long(argc, argv, "", table, 0)) != -1;)
        switch (c) {
        case OPT_SCREENSHOT: o->screenshot = optarg; break;
        case OPT_HELP: printf(help, camera_options_help, frame_options_help, viewer_keys); exit(EXIT_OK);
        case '?': return wrong_option(argv);
        default:
            if (frame_option(&o->frame, c, optarg))
                return EXIT_USAGE;
        }
    if (take_scenes(&o->frame.world, "view", argc - optind, argv + optind))
        return EXIT_USAGE;
    if (o->frame.view && !strcmp(o->frame.view, "all"))
        return fail(EXIT_USAGE, "view: --view takes one view to start from; n and p show the others");
    if (o->screenshot && !fxs_image_file_known(o->screenshot))
        return fail(EXIT_USAGE, "%s: expected a name ending in .png, .ppm or .raw", o->screenshot);
    return frame_options_check(&o->frame);
}

static const char *scene_name(const view_options *o)
{
    return o->frame.world.file ? o->frame.world.file : o->frame.world.scenes[0];
}

#ifdef FXS_WITH_SDL
/* The window's libraries are many, and the other commands do without: a program beside this one has them. */
static int show(const view_options *o, char **argv)
{
    char path[4096] = "fixsplat";
    ssize_t length = readlink("/proc/self/exe", path, sizeof path - sizeof "-view");
    strcpy(path + (length > 0 ? (size_t)length : strlen(path)), "-view");
    execvp(path, argv);
    return fail(EXIT_FAILED, "%s: cannot be shown: %s: %s", scene_name(o), path, strerror(errno));
}
#else
static int show(const view_options *o, char **argv)
{
    (void)argv;
    return fail(EXIT_FAILED, "%s: cannot be shown: this program was built without SDL2", scene_name(o));
}
#endif

int command_view(int argc, char **argv)
{
    view_options o;
    int status = view_options_take(&o, argc, argv);
    return status ? status : show(&o, argv);
}
