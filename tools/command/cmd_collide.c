/* fixsplat collide: makes voxels and meshes that a walker cannot go through. */
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "cmd_render.h"
#include "file_guard.h"
#include "make_voxels.h"

enum { NAME_MOST = 4096 };

typedef struct collide_options {
    frame_options frame;
    const char *output;
    char mesh_name[NAME_MOST];     /* mesh beside a .voxel.json; empty: none */
    voxel_options voxels;
    int mesh;
} collide_options;

#define OPTIONS collide_options

static const option_row own_rows[] = {
    {.help = "Options:"},
    {"output", "OUT", OUTPUT(output), .letter = 'o', .basic = 1, .help =
     "NAME.voxel.json, with NAME.voxel.bin beside it: an octree of voxels, as splat-transform writes it; or a .glb: a "
     "mesh of the voxels' faces (required)"},
    {"mesh", 0, FLAG(mesh), .basic = 1, .help = "write NAME.collision.glb too, beside NAME.voxel.json"},
    {"voxel", "SIZE", REAL(voxels.voxel, 0x1p-16, 0x1p16, "units from 2^-16 to 2^16"), .basic = 1, .help =
     "edge of a voxel, units (default 0.05)"},
    {"opacity", "SHARE", REAL(voxels.opacity, 0.001, 0.999, "a share from 0.001 to 0.999"), .basic = 1, .help =
     "a voxel is solid if it absorbs at least this share of light (default 0.1)"},
    {"seed", "X,Y,Z", POINT(voxels.seed), .basic = 1, .help =
     "a free place where the walker starts, in the axes of a .ply (default: the camera of the start view, else the "
     "middle of the scene)"},
    {"radius", "R", REAL(voxels.radius, ABOVE_0, 0x1p20, "units above 0"), .basic = 1, .help =
     "radius of the walker, a capsule, units (default 0.2); at most 31 voxels"},
    {"height", "H", REAL(voxels.height, ABOVE_0, 0x1p20, "units above 0"), .basic = 1, .help =
     "height of the walker, units (default 1.6); at least twice the radius"},
    {"time", "SECONDS", TIME(frame.render.time_q32), .basic = 1, .help =
     "moment of a scene that moves. A scene that loops starts again after its duration"},
    {"threads", "N", take_threads, FIELD(frame_options, frame), 1, 64, .basic = 1, .help =
     "number of threads, 1 to 64 (default: one per processor); the files do not depend on it"},
    {"max-memory", "BYTES", BYTES(frame.max_memory), .help =
     "refuse voxels that need more working memory, also as 64K, 3M, 2G (default 2G)"},
    {"profile", "P", CHOICE(frame.load.profile, profile_names), .help =
     "how a scene that is not an .fxs is packed: default, compact or small"},
    {0}
};

static int name_mesh(collide_options *o)
{
    const size_t length = strlen(o->output) - (ends_with(o->output, ".voxel.json") ? strlen(".voxel.json") : 0);
    if (!o->mesh)
        return 0;
    if (ends_with(o->output, ".glb"))
        return fail(EXIT_USAGE, "--mesh is for a .voxel.json: %s is a mesh", o->output);
    if (length + sizeof ".collision.glb" > sizeof o->mesh_name)
        return fail(EXIT_USAGE, "%s: the name is too long", o->output);
    snprintf(o->mesh_name, sizeof o->mesh_name, "%.*s.collision.glb", (int)length, o->output);
    return 0;
}

static int read_options(collide_options *o, int argc, char **argv)
{
    frame_options_default(&o->frame);
    if (take_options(&command_collide, o, argc, argv))
        return EXIT_USAGE;
    if (argc - optind > 1)
        return fail(EXIT_USAGE, "collide takes one scene; see: fixsplat collide --help");
    if (take_scenes(&o->frame.world, "collide", argc - optind, argv + optind))
        return EXIT_USAGE;
    if (!o->output)
        return fail(EXIT_USAGE, "collide needs -o OUT, a .voxel.json or .glb");
    if (!fxs_voxels_ending(o->output))
        return fail(EXIT_USAGE, "%s: expected a name ending in .voxel.json or .glb", o->output);
    return name_mesh(o);
}

/* Registers the files of the command, so that no output replaces an input. */
static int check_files(const collide_options *o, const char *path)
{
    char bin[NAME_MOST];
    files_read(path);
    files_write(o->output);
    files_write(*o->mesh_name ? o->mesh_name : 0);
    if (ends_with(o->output, ".voxel.json")) {
        snprintf(bin, sizeof bin, "%.*s.bin", (int)(strlen(o->output) - strlen(".json")), o->output);
        files_write(bin);
    }
    return files_check();
}

/* Opens the scene, or its moment. */
static int load(world *w, const collide_options *o)
{
    world moving;
    load_options l = o->frame.load;
    if (world_open(w, &o->frame.world, &l))
        return EXIT_FAILED;
    if (!is_given("time"))
        return 0;
    moving = *w;
    l.again = 1;
    l.has_moment = 1;
    l.moment = ldexp((double)o->frame.render.time_q32, -32);
    const int status = world_open_merged(w, &moving.placed, moving.placed.files[0], &l);
    world_close(&moving);
    return status;
}

static void print_voxels(const collide_options *o, const fxs_voxels *voxels)
{
    const fxs_voxels_info *info = fxs_voxels_describe(voxels);
    printf("%s:", o->output);
    for (int i = 0; i < 3; i++)
        printf(i ? " x %d" : " %d", (int)(info->high[i] - info->low[i]));
    printf(" voxels of %g units, %" PRIu64 " free; %" PRIu64 " of the scene absorb %g or more\n", info->voxel,
           info->free, info->absorbing, o->voxels.opacity == 0 ? 0.1 : o->voxels.opacity);
}

static int write(const fxs_voxels *voxels, const char *path)
{
    fxs_message why;
    return fxs_voxels_write(voxels, path, &why) ? fail_for(&why) : 0;
}

static int run(int argc, char **argv)
{
    static collide_options o = {.voxels.hint = ": give --seed X,Y,Z"};
    world w;
    fxs_voxels *voxels = 0;
    int status = read_options(&o, argc, argv);
    if (!status)
        status = check_files(&o, argv[optind]);
    if (status || load(&w, &o))
        return status ? status : EXIT_FAILED;
    o.voxels.max_memory = o.frame.max_memory;
    status = make_voxels(&voxels, &o.voxels, &w.scenes[0], &o.frame);
    status = status ? status : world_check(&w);
    status = status ? status : write(voxels, o.output);
    status = status || !*o.mesh_name ? status : write(voxels, o.mesh_name);
    if (!status && !is_quiet())
        print_voxels(&o, voxels);
    fxs_voxels_free(voxels);
    world_close(&w);
    return status;
}

const command command_collide = {
    "collide", "makes voxels or a mesh for walking in a scene", run,
    "Usage: fixsplat collide SCENE -o OUT [OPTION...]\n\n"
    "Finds where a scene is solid: a voxel is, if the Gaussians that reach it absorb enough light. Then a walker, a\n"
    "capsule that stands upright, moves from the seed to all places that it fits into. What it touches is free,\n"
    "everything else is solid. supersplat-viewer reads the .voxel.json, programs for physics the .glb.\n\n"
    "The files have the axes of glTF: (-x, -y, z) of a .ply. The same scene and options give the same bytes on every\n"
    "machine.\n",
    0,
    "  $ fixsplat collide room.fxs -o room.voxel.json\n"
    "  $ fixsplat collide room.ply -o room.voxel.json --mesh --seed 0,0.4,2 --voxel 0.03\n"
    "  $ fixsplat collide room.ply -o room.collision.glb --height 1.2 --radius 0.15\n",
    {{own_rows, 0}, {load_rows, offsetof(collide_options, frame.load)}, COMMON_TABLE}
};
