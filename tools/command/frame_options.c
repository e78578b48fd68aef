/* Option tables that several subcommands share, with checks between options. Chooses the back end, devices and
   instruction sets. */
#include "frame_options.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/backend.h>
#include <fixsplat/system.h>
#ifdef FXS_WITH_KERNELS
#include <fixsplat/internal/kernels.h>
#endif

static int take_lod(const option_row *row, void *field, const char *value)
{
    load_options *o = field;
    char *end;
    for (const char *c = value;; c = end + 1) {
        const long level = *c >= '0' && *c <= '9' ? strtol(c, &end, 10) : -1;
        if (level < 0 || level > 1000 || (*end && *end != ','))
            return wrong_value(row, value);
        if (c == value)
            o->lod = (int)level;
        if (!*end)
            break;
    }
    o->lods = strchr(value, ',') ? value : NULL;
    return 0;
}

int take_frame_size(const option_row *row, void *field, const char *value)
{
    frame_options *options = field;
    return parse_size(value, &options->width, &options->height) ? 0 : wrong_value(row, value);
}

int take_devices(const option_row *row, void *field, const char *value)
{
    frame_options *options = field;
    const char *at = value;
    options->device_count = 0;
    while (strcmp(value, "all")) {
        char *end;
        const long number = strtol(at, &end, 10);
        if (*at < '0' || *at > '9' || number > 255 || options->device_count == DEVICES_MOST || (*end && *end != ','))
            return fail(EXIT_USAGE, "--%s %s: expected all, or up to %d numbers from 0 to 255 with commas", row->name,
                        value, DEVICES_MOST);
        options->devices[options->device_count++] = (int)number;
        if (!*end)
            break;
        at = end + 1;
    }
    return 0;
}

int take_threads(const option_row *row, void *field, const char *value)
{
    frame_options *options = field;
    const int status = take_uint32(row, &options->threads, value);
    options->load.threads = options->threads;
    return status;
}

static int take_detail(const option_row *row, void *field, const char *value)
{
    double pixels = 0;
    if (!parse_vector(value, 1, &pixels) || !(pixels >= 1.0 / 256 && pixels <= FXS_MAX_SIZE))
        return wrong_value(row, value);
    *(uint32_t *)field = (uint32_t)lrint(256 * pixels);
    return 0;
}

static int take_tangents(const option_row *row, void *field, const char *value)
{
    frame_options *options = field;
    options->has_tangents = parse_vector(value, 4, options->tangents);
    return options->has_tangents ? 0 : wrong_value(row, value);
}

static int take_gaze(const option_row *row, void *field, const char *value)
{
    frame_options *options = field;
    options->gazes = strchr(value, ',') && strchr(strchr(value, ',') + 1, ',') ? 4 : 2;
    return parse_counts(value, options->gazes, 0, FXS_MAX_SIZE, options->gaze) ? 0 : wrong_value(row, value);
}

static int take_place(const option_row *row, void *field, const char *value)
{
    world_options *options = field;
    if (options->place_count == PLACES_MOST)
        return fail(EXIT_USAGE, "--place %s: more than %d; --scene takes any number", value, PLACES_MOST);
    if (!strrchr(value, ':'))
        return wrong_value(row, value);
    options->places[options->place_count++] = value;
    return 0;
}

const char *const cutoff_names[] = {"mahalanobis", "square", 0};

#define OPTIONS frame_options

const option_row camera_rows[] = {
    {.help = "Camera (default of render and view: the start view of an .fxs, else the upright view that shows most of "
             "the scene; other commands frame the whole scene):"},
    {"cameras", "FILE", TEXT(cameras), .basic = 1, .help =
     "camera file: cameras.json, transforms.json, COLMAP images.bin or images.txt, Metashape .xml, RealityCapture "
     ".csv, Bundler .out, or a folder with one of them"},
    {"view", "N|NAME|LIST|all", TEXT(view), .basic = 1, .help =
     "view of the camera file: its number from 0, or its image name (default 0). render also takes several: 8..40, "
     "0,8,40..20 or all"},
    {"eye", "X,Y,Z", POINT(eye), .basic = 1, .help = "camera position, scene units"},
    {"look", "X,Y,Z", POINT(look), .basic = 1, .help =
     "point that the camera looks at (default: the middle of the scene; of a panorama: straight ahead)"},
    {"up", "X,Y,Z", POINT(up), .help =
     "up direction in the picture (default: as stored in an .fxs, else 0,-1,0: y points down); use 0,0,1 for scenes "
     "with z up"},
    {"auto-up", 0, FLAG(auto_up), .help =
     "find the up direction in the scene, or take it from an .fxs, for --eye, --orbit and --panorama. The default view "
     "is always upright"},
    {"fov", "DEG", REAL(fov, 1, 170, "1 to 170 degrees"), .basic = 1, .help =
     "vertical field of view, 1 to 170 degrees (default 50)"},
    {"tangents", "L,R,U,D", take_tangents, 0, .expected = "four numbers LEFT,RIGHT,UP,DOWN", .help =
     "field of view of a headset, instead of --fov: tangents to the left (negative), right, up and down (negative). "
     "With --stereo, they are the left eye's; the right eye is its mirror image"},
    {"ortho", "UNITS", REAL(ortho, ABOVE_0, INFINITY, "a height in scene units, above 0"), .help =
     "orthographic projection, instead of --fov: height of the picture in scene units, above 0"},
    {"near", "DEPTH", REAL(near, 0x1p-20, 0x1p28, "a depth from 2^-20 to 2^28"), .help =
     "near plane, 2^-20 to 2^28 scene units: nearer Gaussians are not drawn (default: 0.2 for views of a camera file "
     "in render, bench and info; else 1/100 of the scene's radius, at most 0.2)"},
    {"size", "WxH", take_frame_size, 0, .expected = SIZE_EXPECTED, .basic = 1, .help =
     "picture size, each 1 to 16384 pixels (default: the size of the view, else 1280x720; panorama 2048x1024). A view "
     "of a camera file is scaled with its principal point; in another shape, it shows as large a solid angle"},
    {"stereo", "DISTANCE", REAL(stereo, ABOVE_0, INFINITY, "a distance above 0"), .help =
     "render two eyes side by side, DISTANCE scene units apart (above 0), each byte for byte as its own camera renders "
     "it; with --budget or --detail, both eyes draw the same Gaussians. With --panorama: a panorama of each eye, the "
     "left one above the right one, in 128 upright strips, each from its own place on the circle of the eyes"},
    {0}
};

const option_row frame_rows[] = {
    {.help = "Rendering:"},
    {"cutoff", "NAME", CHOICE(render.cutoff, cutoff_names), .help =
     "where a Gaussian ends: mahalanobis (default) or square"},
    {"time", "SECONDS", TIME(render.time_q32), .help =
     "moment of a scene that moves (default 0). A scene that loops starts again after its duration"},
    {"sh-degree", "D", INT(render.sh_degree, 0, 3), .help = "highest SH degree used, 0 to 3 (default 3)"},
    {"threads", "N", take_threads, 0, 1, 64, .help =
     "number of threads, 1 to 64 (default: one per processor); the picture does not depend on it"},
    {"max-memory", "BYTES", BYTES(max_memory), .help =
     "limit of a frame's working memory, also as 64K, 3M, 2G (default: none). A larger frame is rendered in bands, "
     "with the same picture. With cuda: device memory, with the part of the scene that fits; with gles-compute "
     "and vulkan: device memory, with the whole scene"},
    {"cpu", "LIST", TEXT(cpu), .help =
     "instruction sets to use: all (default), c for none, or a list out of sse41,avx2,avx512,neon"},
    {"backend", "NAME", TEXT(backend), .basic = 1, .help =
     "renderer: cpu, cuda, gles, gles-fetch, gles-compute, osmesa or vulkan, all with the same bytes; auto (default) "
     "takes the fastest by a trial. fixsplat help backends describes them"},
    {"device", "LIST", take_devices, 0, .help =
     "GPUs of --backend cuda or vulkan: numbers from 0, separated by commas, or all (default 0). render --view all "
     "shares its views among them; other commands use the first"},
    {"profile", "P", CHOICE(load.profile, profile_names), .help =
     "how a scene that is not an .fxs is packed: default, compact or small"},
    {0}
};

const option_row background_rows[] = {
    {"bg", "RRGGBB", COLOUR(render.background), .help = "background colour, hex (default 000000)"},
    {0}
};

const option_row gaze_rows[] = {
    {"gaze", "X,Y[,R1,R2]", take_gaze, 0, .expected = "X,Y or X,Y,RADIUS1,RADIUS2, pixels, 0 to 16384", .help =
     "draw as for a headset that follows the eye: tiles of 32x32 pixels within R1 pixels of pixel X,Y in full, within "
     "R2 one pixel in 2x2, beyond one in 4x4 (default: 1/4 and 1/2 of the picture's height)"},
    {0}
};

const option_row level_rows[] = {
    {.help = "Levels of detail (an .fxs by convert --levels):"},
    {"budget", "N", UINT32(render.budget, 1, UINT32_MAX), .help =
     "largest number of Gaussians that a frame draws (default: all). Coarse Gaussians replace those that matter least "
     "to the picture"},
    {"detail", "PIXELS", take_detail, FIELD(uint32_t, render.detail_q8), .expected = "pixels, 1/256 to 16384", .help =
     "draw nothing finer than about PIXELS, 1/256 to 16384; with or without --budget"},
    {0}
};

#undef OPTIONS
#define OPTIONS world_options

const option_row world_rows[] = {
    {.help = "Scenes:"},
    {"place", "SCENE:X,Y,Z[,QW,QX,QY,QZ[,S]]", take_place, 0, .expected = "SCENE:X,Y,Z[,QW,QX,QY,QZ[,S]]", .help =
     "put a scene at X,Y,Z, turned by a quaternion and scaled by S. SCENE is its name as given, the end of its path, "
     "or its number from 0. Repeat for another copy of the scene. Scenes without --place stay as in their files"},
    {"scene", "FILE.json", TEXT(file), .help =
     "read scenes and placements from a file: {\"objects\": [{\"file\": \"a.fxs\", \"translation\": [x, y, z], "
     "\"rotation\": [w, x, y, z], \"scale\": s, \"opacity\": o, \"tint\": [r, g, b], \"visible\": true, \"id\": n, "
     "\"crops\": [{\"low\": [x, y, z], \"high\": [x, y, z], \"keep\": \"inside\"}]}]}. Only \"file\" is required; "
     "\"keep\" may be \"outside\". Scenes must lie in the folder of FILE.json or below it"},
    {0}
};

#undef OPTIONS
#define OPTIONS load_options

const option_row load_rows[] = {
    {.help = "Reading scenes:"},
    {"lod", "LEVEL", take_lod, 0, .expected = "whole numbers from 0 to 1000 as 2 or 2,0", .help =
     "level of detail to read from an .lcc, .lcc2, .rad or streamed .sog; 0 (default) is the finest. One level for all "
     "files, or a list with a level for each file, as 2,0"},
    {"axes", "AXES", CHOICE_FROM(FXS_AXES_RUB, axes, WORDS("rub", "rdf")), .help =
     "axes of an .spz: rub (right, up, back) or rdf (right, down, front; splat-transform 3) (default: as the file "
     "says, else rub)"},
    {"rate", "FPS", REAL(rate, ABOVE_0, 1000, "frames per second above 0, at most 1000"), .help =
     "frames per second of numbered files, a moving scene (default 30)"},
    {"max-gaussians", "N", UINT64(max_gaussians, 1, INFINITY), .help =
     "refuse to import a larger scene (default: 1000000 plus one per byte of its files, at most 67108864). Packing "
     "takes about 100 bytes per Gaussian"},
    {"import-memory", "BYTES", BYTES(import_memory), .help =
     "refuse to import a scene that needs more memory to read and decompress, also as 64K, 3M, 2G (default: 96 bytes "
     "per Gaussian of --max-gaussians, at least of 1000000)"},
    {0}
};

const option_row pool_rows[] = {
    {"pool", "BYTES", BYTES(pool), .help =
     "keep at most BYTES of an .fxs with levels of detail in memory, also as 512M, and read the rest on demand, from a "
     "disk or a URL (default: 256M for a URL; a file is mapped, but render uses a pool if the file has 64 MiB or more "
     "and --budget is a small part of it)"},
    {0}
};

void frame_options_default(frame_options *options)
{
    memset(options, 0, sizeof *options);
    fxs_options_init(&options->render);
    options->up.at[1] = -1;
    options->cpu = "all";
    options->backend = "auto";
    options->threads = fxs_processors();
    options->device_count = 1;
    options->rate[0] = 30;
    options->rate[1] = 1;
}

/* Options of camera_rows and frame_rows that do nothing with others. */
static const option_rule rules[] = {
    {"view", 0, "cameras path", 0},
    {"lens", 0, "cameras", 0},
    {"look", 0, "eye", 0},
    {"eye look", "cameras", 0, "give one camera"},
    {"fov", "cameras", 0, "its views have their own; --ortho and --tangents replace it"},
    {"auto-up", "up", 0, "give one"},
    {"fov", "ortho tangents", 0, "it gives the size of the picture"},
    {"fov ortho tangents", "panorama", 0, "it looks all around"},
    {"tangents", "ortho", 0, "give one"},
    {"gaze", "panorama lens scissor", 0, 0},
    {0}
};

int frame_options_check(const frame_options *options)
{
    const fxs_backend *backend = fxs_backend_find(options->backend);
    if (check_rules(rules))
        return EXIT_USAGE;
    if (is_given("device") && backend && !(backend->can & FXS_CAN_DEVICES))
        return fail(EXIT_USAGE, "--device is for --backend cuda, not for %s", backend->name);
    if (options->gazes && options->render.cutoff == FXS_CUTOFF_SQUARE)
        return fail(EXIT_USAGE, "--gaze does not go with --cutoff square, which depends on the picture's tiles");
    if (options->gazes && backend && !(backend->can & FXS_CAN_RATES))
        return fail(EXIT_USAGE, "--backend %s draws all pixels: no --gaze", backend->name);
    if (options->panorama && options->width != 2 * options->height)
        return fail(EXIT_USAGE, "--panorama is twice as wide as high: --size %dx%d is not", options->width,
                    options->height);
    return 0;
}

#ifdef FXS_WITH_KERNELS
/* Returns the flag bit of an instruction set: 0 for "c", all bits for "all", -1 for an unknown name. */
static long cpu_flag(const char *name, size_t length)
{
    if (length == 1 && *name == 'c')
        return 0;
    if (length == 3 && !strncmp(name, "all", 3))
        return 0xffff;
    for (unsigned flag = 1; fxs_cpu_name(flag); flag *= 2)
        if (strlen(fxs_cpu_name(flag)) == length && !strncmp(name, fxs_cpu_name(flag), length))
            return (long)flag;
    return -1;
}

static int choose_cpu(const char *list, unsigned *without)
{
    unsigned allowed = 0;
    for (const char *name = list;;) {
        size_t length = strcspn(name, ",");
        long flag = cpu_flag(name, length);
        if (flag < 0)
            return fail(EXIT_USAGE, "--cpu %s: expected all, c, or names out of sse41, avx2, avx512, neon", list);
        if (flag != 0xffff && ((unsigned)flag & ~fxs_cpu_detect()))
            return fail(EXIT_USAGE, "--cpu %s: this processor has no %.*s", list, (int)length, name);
        allowed |= (unsigned)flag;
        if (!name[length])
            break;
        name += length + 1;
    }
    *without = ~allowed;
    return 0;
}
#else
static int choose_cpu(const char *list, unsigned *without)
{
    *without = 0;
    if (!strcmp(list, "all") || !strcmp(list, "c"))
        return 0;
    return fail(EXIT_USAGE, "--cpu %s: this build has the plain C versions only; expected all or c", list);
}
#endif

int choose_backend(const frame_options *options, int device, const fxs_backend **backend, fxs_backend_options *how)
{
    *backend = fxs_backend_find(options->backend);
    if (!*backend)
        return fail(EXIT_USAGE, "--backend %s: expected auto or one of those that fixsplat info --backends lists",
                    options->backend);
    *how = (fxs_backend_options){.size = sizeof *how, .device = device, .max_memory = options->max_memory,
                                  .threads = options->threads};
    return choose_cpu(options->cpu, &how->without_cpu);
}

int choose_devices(const frame_options *options, int devices[DEVICES_MOST])
{
    const fxs_backend *backend = fxs_backend_find(options->backend);
    char name[256];
    fxs_message why;
    int count = options->device_count;
    devices[0] = 0;
    if (!backend || !(backend->can & FXS_CAN_DEVICES))
        return 1;
    for (int i = 0; i < count; i++)
        devices[i] = options->devices[i];
    if (count)
        return count;
    while (count < DEVICES_MOST && !backend->device(count, name, sizeof name, &why)) {
        devices[count] = count;
        count++;
    }
    return count ? count : 1;
}
