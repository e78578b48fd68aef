/* The option tables that render, view, bench and other commands share, with the checks between options and the
   choice of back end, devices and instruction sets. */
#include "frame_options.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/backends.h>
#include <fixsplat/pool.h>
#ifdef FXS_WITH_KERNELS
#include <fixsplat/kernels.h>
#endif

/* ---- Taking ------------------------------------------------------------------------------------------------------ */

/* One level, or a list with one for each file. */
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

static int take_foveate(const option_row *row, void *field, const char *value)
{
    static const int counts[] = {2, 4, 5};
    foveate_options *foveate = field;
    double *n = foveate->numbers;
    foveate->on = 1;
    foveate->given = 0;
    for (int i = 0; i < 3 && value && !foveate->given; i++)
        foveate->given = parse_vector(value, counts[i], n) ? counts[i] : 0;
    const int given = foveate->given;
    const int right = !value || (given && fabs(n[0]) <= FXS_MAX_SIZE && fabs(n[1]) <= FXS_MAX_SIZE &&
                                 (given < 4 || (n[2] >= 1 && n[3] >= n[2] + 1 && n[3] <= FXS_MAX_SIZE)) &&
                                 (given < 5 || (n[4] >= 0 && n[4] <= n[2])));
    return right ? 0 : wrong_value(row, value);
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

/* ---- Rows -------------------------------------------------------------------------------------------------------- */

const char *const cutoff_names[] = {"mahalanobis", "square", 0};

#define OPTIONS frame_options

const option_row camera_rows[] = {
    {.help = "Camera (without one, render and view take the start view of an .fxs, or else look at the scene from many "
             "sides and take the view that shows most, upright; other commands frame it whole):"},
    {"cameras", "FILE", TEXT(cameras), .help =
     "cameras.json, transforms.json, images.bin or images.txt of COLMAP, .xml of Metashape, .csv of RealityCapture, "
     ".out of Bundler, or a folder with one of them"},
    {"view", "N|NAME|LIST|all", TEXT(view), .help =
     "a view of that file: its number from 0, its image name, several as 8..40 or 0,8,40..20 (render alone), or all "
     "(default 0)"},
    {"eye", "X,Y,Z", POINT(eye), .help = "camera centre"},
    {"look", "X,Y,Z", POINT(look), .help = "point looked at (default: the middle of the scene)"},
    {"up", "X,Y,Z", POINT(up), .help =
     "up in the picture (default: what an .fxs says, else 0,-1,0: y points down; 0,0,1 for scenes with z up)"},
    {"auto-up", 0, FLAG(auto_up), .help =
     "find up in the scene, or take what an .fxs says, for --eye, --orbit and --panorama; a view without a camera is "
     "upright in any case"},
    {"fov", "DEG", REAL(fov, 1, 170, "1 to 170 degrees"), .help = "vertical field of view, 1 to 170 (default 50)"},
    {"tangents", "L,R,U,D", take_tangents, 0, .expected = "four numbers LEFT,RIGHT,UP,DOWN", .help =
     "field of view as a headset states it, tangents to the left (negative), right, up and down (negative), in place "
     "of --fov; with --stereo of the left eye, the right one is its mirror"},
    {"ortho", "UNITS", REAL(ortho, ABOVE_0, INFINITY, "a height in scene units, above 0"), .help =
     "parallel rays, a picture so many scene units high, in place of --fov"},
    {"near", "DEPTH", REAL(near, 0x1p-20, 0x1p28, "a depth from 2^-20 to 2^28"), .help =
     "near plane: only what lies beyond is drawn, scene units, 2^-20 to 2^28 (default: 0.2 for views of a file in "
     "render, bench and info; else 1/100 of the scene's radius, at most 0.2)"},
    {"size", "WxH", take_frame_size, 0, .expected = SIZE_EXPECTED, .help =
     "pixels (default: the view's own size, else 1280x720; of a panorama 2048x1024); a view of a file is scaled by the "
     "widths, its principal point too"},
    {"stereo", "DISTANCE", REAL(stereo, ABOVE_0, INFINITY, "a distance above 0"), .help =
     "two pictures side by side, of eyes so far apart (scene units, above 0) about the camera, each as its camera alone "
     "would be rendered"},
    {"foveate", "[=X,Y[,R1,R2[,BAND]]]", take_foveate, FIELD(foveate_options, foveate), .expected =
     "X,Y or X,Y,R1,R2 or X,Y,R1,R2,BAND, pixels: R1 from 1, R2 larger, BAND at most R1", .help =
     "full rate R1 pixels about the gaze X,Y (of two eyes in the left picture; the other looks the same way), half "
     "rate as far as R2, a quarter beyond; edges faded over BAND pixels (default: straight ahead, 1/5 and 2/5 of the "
     "shorter side, 1/4 of R1)"},
    {0}
};

const option_row frame_rows[] = {
    {.help = "Rendering:"},
    {"bg", "RRGGBB", COLOUR(render.background), .help = "background (default 000000)"},
    {"cutoff", "NAME", CHOICE(render.cutoff, cutoff_names), .help = "mahalanobis (default) or square"},
    {"sh-degree", "D", INT(render.sh_degree, 0, 3), .help = "highest SH degree used, 0 to 3 (default 3)"},
    {"threads", "N", take_threads, 0, 1, 64, .help =
     "threads, 1 to 64 (default: one a processor); the picture does not depend on it"},
    {"max-memory", "BYTES", BYTES(max_memory), .help =
     "working memory of a frame, also as 64K, 3M, 2G: rendered in bands where it does not hold every Gaussian; the "
     "picture does not depend on it. With --backend cuda: device memory, with what fits of the scene; with "
     "gles-compute: device memory, scene included"},
    {"cpu", "LIST", TEXT(cpu), .help =
     "instruction sets that may be used: all (default), c for none, or names out of sse41,avx2,avx512,neon"},
    {"backend", "NAME", TEXT(backend), .help =
     "what renders: cpu; gles (OpenGL ES 3.0 by EGL) or osmesa in place of blend and resolve; gles-fetch (gles "
     "without lists); gles-compute (every stage in compute shaders of OpenGL ES 3.1); cuda. All give the same "
     "bytes. auto (default): cpu. See fixsplat info --backends"},
    {"device", "LIST", take_devices, 0, .help =
     "GPUs of --backend cuda: numbers from 0 on with commas, or all (default 0); render --view all shares the views "
     "out among them, other commands take the first"},
    {"profile", "P", CHOICE(load.profile, profile_names), .help =
     "how a scene that is not an .fxs file is packed: default, compact or small"},
    {0}
};

const option_row level_rows[] = {
    {.help = "Levels of detail (of an .fxs by convert --levels):"},
    {"budget", "N", UINT32(render.budget, 1, UINT32_MAX), .help =
     "Gaussians that a frame draws at most: coarse ones take the place of those that matter least to the picture "
     "(default: all are drawn)"},
    {"detail", "PIXELS", take_detail, FIELD(uint32_t, render.detail_q8), .expected = "pixels, 1/256 to 16384", .help =
     "draw nothing finer than about this size; with or without --budget"},
    {0}
};

#undef OPTIONS
#define OPTIONS world_options

const option_row world_rows[] = {
    {.help = "Scenes:"},
    {"place", "SCENE:X,Y,Z[,QW,QX,QY,QZ[,S]]", take_place, 0, .expected = "SCENE:X,Y,Z[,QW,QX,QY,QZ[,S]]", .help =
     "put a scene, named as it was given, by the end of its path or by its number from 0 on, at X,Y,Z, turned by a "
     "quaternion and S times as large. Given again for the same scene, it is there once more. A scene that is not "
     "placed is as in its file"},
    {"scene", "FILE.json", TEXT(file), .help =
     "the scenes, and how they are placed, from a file: {\"objects\": [{\"file\": \"a.fxs\", \"translation\": [x, y, "
     "z], \"rotation\": [w, x, y, z], \"scale\": s, \"opacity\": o, \"tint\": [r, g, b], \"visible\": true, \"id\": "
     "n, \"crops\": [{\"low\": [x, y, z], \"high\": [x, y, z], \"keep\": \"inside\"}]}]}; all but \"file\" may be "
     "left out, \"keep\" may be \"outside\" too. The scenes lie in the folder of FILE.json or below it"},
    {0}
};

#undef OPTIONS
#define OPTIONS load_options

const option_row load_rows[] = {
    {.help = "Reading scenes:"},
    {"lod", "LEVEL", take_lod, 0, .expected = "whole numbers from 0 to 1000 as 2 or 2,0", .help =
     "level of detail of an .lcc, .lcc2, .rad or streamed .sog, 0 the finest (default 0); with several files for all "
     "that have levels, or as 2,0 one for each"},
    {"axes", "AXES", CHOICE_FROM(FXS_AXES_RUB, axes, WORDS("rub", "rdf")), .help =
     "of an .spz: rub (right, up, back) or rdf (right, down, front: files of splat-transform 3); default: as the "
     "file says, without a word rub"},
    {"max-gaussians", "N", UINT64(max_gaussians, 1, INFINITY), .help =
     "refuse to import a scene of more Gaussians (default: 1000000 and one for each byte of its files, 67108864 at "
     "most); each takes about 100 bytes while it is packed"},
    {"import-memory", "BYTES", BYTES(import_memory), .help =
     "refuse to import a scene that takes more memory to read and decompress, also as 64K, 3M, 2G (default: 96 bytes "
     "for each Gaussian of that limit, for 1000000 at least)"},
    {0}
};

const option_row pool_rows[] = {
    {"pool", "BYTES", BYTES(pool), .help =
     "do not map an .fxs with levels of detail, but keep so much of it in memory, also as 512M: what is drawn is read "
     "as it is wanted, from a disk or from the address of a server (default for an address: 256M; render reads an .fxs "
     "of 64 MiB or more so by itself, where --budget is a small part of it)"},
    {0}
};

/* ---- Checks of options together ---------------------------------------------------------------------------------- */

void frame_options_default(frame_options *options)
{
    memset(options, 0, sizeof *options);
    fxs_options_init(&options->render);
    options->up.at[1] = -1;
    options->cpu = "all";
    options->backend = "auto";
    options->threads = fxs_processors();
    options->device_count = 1;
}

int frame_options_check(const frame_options *options)
{
    if (options->view && !options->cameras)
        return fail(EXIT_USAGE, "--view needs --cameras");
    if (options->cameras && (options->eye.given || options->look.given))
        return fail(EXIT_USAGE, "--cameras and --eye or --look: give one camera");
    if (options->auto_up && options->up.given)
        return fail(EXIT_USAGE, "--auto-up and --up: give one");
    if (options->panorama && (options->stereo > 0 || options->ortho > 0 || options->has_tangents ||
                              options->foveate.on))
        return fail(EXIT_USAGE, "--panorama looks all around: no --stereo, --ortho, --tangents, --foveate");
    if (options->has_tangents && options->ortho > 0)
        return fail(EXIT_USAGE, "--tangents and --ortho: give one");
    if (options->panorama && options->width != 2 * options->height)
        return fail(EXIT_USAGE, "--panorama is twice as wide as high: --size %dx%d is not", options->width,
                    options->height);
    if (options->orbit && options->frames)
        return fail(EXIT_USAGE, "--orbit and --frames: give one");
    if (options->frames && !options->view)
        return fail(EXIT_USAGE, "--frames needs --view with several views, as 8..40 or all");
    if (options->look.given && !options->eye.given)
        return fail(EXIT_USAGE, "--look needs --eye");
    return 0;
}

#ifdef FXS_WITH_KERNELS
/* The flag of a name of `length` characters; 0 for "c", all bits for "all"; -1 for an unknown name. */
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

/* Finds the instruction sets that --cpu leaves out. */
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
    *how = (fxs_backend_options){.device = device, .max_memory = options->max_memory, .threads = options->threads};
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
