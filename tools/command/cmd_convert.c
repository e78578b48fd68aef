/* fixsplat convert: converts scene files to any format. Scenes are read as floats, filtered, placed and merged, then
   packed or written. Parts of an .fxs file are merged without unpacking. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/fit.h>
#include <fixsplat/pack.h>
#include <fixsplat/renderer.h>
#include <fixsplat/scene.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/kernels.h>
#include <fixsplat/internal/parts.h>
#include <fixsplat/internal/placements.h>
#include <fixsplat/internal/start.h>
#include <fixsplat/internal/view_more.h>
#include "cmd_convert.h"
#include "frame_options.h"
#include "file_guard.h"
#include "hand_edits.h"
#include "quality.h"
#include "start_option.h"
#include "src/pack/part.h"
#include "src/scene/part_file.h"

enum { SHAPES_MOST = 256 };

typedef struct convert_options {
    const char *in, *out;
    world_options world;
    fxs_world placed;
    fxs_placement whole;
    double degrees[3], up[3];
    double level[9];
    int has_level;
    int auto_up;
    fxs_scene_filter filter;
    fxs_filter_shape shapes[SHAPES_MOST];
    load_options load;
    times_option times;
    rate_option rate;
    int64_t time_q32;                       /* --time */
    int spz_version;
    int spz_fine;
    start_option start;
    int device;                             /* --for: row of the table `devices`, from 1; 0: none */
    int refine_steps;
    int has_refine;
    const char *cameras, *edits;
    uint8_t *deleted;                       /* --edits: a byte for each Gaussian of the scene */
    uint32_t block, blocks;                 /* --block: which part of a large scene, from 1, and the number of parts;
                                               0: the whole scene */
} convert_options;

/* Computes the up direction from three points of the ground: up = (b - a) x (c - a). Refuses points on a line. */
static int take_level(const option_row *row, void *field, const char *value)
{
    convert_options *o = field;
    const double *p = o->level;
    double u[3], v[3], square[3] = {0};
    o->has_level = parse_vector(value, 9, o->level);
    for (int i = 0; i < 3; i++) {
        u[i] = p[3 + i] - p[i];
        v[i] = p[6 + i] - p[i];
    }
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        o->up[i] = u[j] * v[k] - u[k] * v[j];
        square[0] += o->up[i] * o->up[i];
        square[1] += u[i] * u[i];
        square[2] += v[i] * v[i];
    }
    return o->has_level && isfinite(square[0]) && square[0] > 1e-12 * square[1] * square[2] ? 0
                                                                                            : wrong_value(row, value);
}

static int add_shape(convert_options *o, const option_row *row, const char *value, fxs_filter_shape shape, int is_right)
{
    if (!is_right)
        return wrong_value(row, value);
    if (o->filter.shape_count == SHAPES_MOST)
        return fail(EXIT_USAGE, "--%s %s: more than %d shapes", row->name, value, SHAPES_MOST);
    o->shapes[o->filter.shape_count++] = shape;
    o->filter.shapes = o->shapes;
    return 0;
}

static int take_crop(const option_row *row, void *field, const char *value)
{
    fxs_filter_shape s = {FXS_FILTER_BOX, {0}};
    const double *n = s.numbers;
    const int is_box = parse_vector(value, 6, s.numbers) && n[0] <= n[3] && n[1] <= n[4] && n[2] <= n[5];
    return add_shape(field, row, value, s, is_box);
}

static int take_sphere(const option_row *row, void *field, const char *value)
{
    fxs_filter_shape s = {FXS_FILTER_SPHERE, {0}};
    const int is_sphere = parse_vector(value, 4, s.numbers) && s.numbers[3] >= 0;
    return add_shape(field, row, value, s, is_sphere);
}

static int take_cylinder(const option_row *row, void *field, const char *value)
{
    fxs_filter_shape s = {FXS_FILTER_CYLINDER, {0}};
    double square = 0;
    int is_cylinder = parse_vector(value, 7, s.numbers) && s.numbers[6] >= 0;
    for (int i = 0; i < 3; i++)
        square += (s.numbers[3 + i] - s.numbers[i]) * (s.numbers[3 + i] - s.numbers[i]);
    is_cylinder = is_cylinder && square > 0 && isfinite(square);
    return add_shape(field, row, value, s, is_cylinder);
}

static int take_decimate(const option_row *row, void *field, const char *value)
{
    convert_options *o = field;
    const size_t length = strlen(value);
    char number[64];
    o->filter.drawable = 1;
    o->load.decimate_share = 0;
    o->load.decimate_count = 0;
    if (parse_count(value, 1, UINT64_MAX, &o->load.decimate_count))
        return 0;
    o->load.decimate_count = 0;
    if (!length || length >= sizeof number || value[length - 1] != '%')
        return wrong_value(row, value);
    memcpy(number, value, length - 1);
    number[length - 1] = 0;
    if (!parse_vector(number, 1, &o->load.decimate_share) || o->load.decimate_share <= 0 ||
        o->load.decimate_share > 100)
        return wrong_value(row, value);
    o->load.decimate_share /= 100;
    return 0;
}

static int take_floaters(const option_row *row, void *field, const char *value)
{
    int *strength = field;
    *strength = 1;
    return value ? take_int(row, field, value) : 0;
}

static int take_refine(const option_row *row, void *field, const char *value)
{
    convert_options *o = field;
    o->has_refine = 1;
    o->refine_steps = FXS_REFINE_STEPS;
    return value ? take_int(row, &o->refine_steps, value) : 0;
}

static int take_block(const option_row *row, void *field, const char *value)
{
    convert_options *o = field;
    const char *slash = strchr(value, '/');
    char first[16] = "";
    uint64_t block, blocks;
    if (slash && (size_t)(slash - value) < sizeof first)
        memcpy(first, value, (size_t)(slash - value));
    if (!slash || !parse_count(slash + 1, 1, FXS_PARTS_MOST, &blocks) || !parse_count(first, 1, blocks, &block))
        return wrong_value(row, value);
    o->block = (uint32_t)block;
    o->blocks = (uint32_t)blocks;
    return 0;
}

static int take_force(const option_row *row, void *field, const char *value)
{
    (void)row, (void)field, (void)value;
    files_force(FILES_FORCED);
    return 0;
}

/* What --for sets, unless an option is given itself. A board has 512 KB of flash for scene and program. */
static const char *const device_names[] = {"phone", "web", "board", 0};
static const struct {
    enum fxs_profile profile;
    int sh_degree, tree;
    uint64_t count;                         /* most Gaussians; 0: all */
    size_t bytes;                           /* most bytes of the file; 0: no limit */
} devices[] = {
    {FXS_PROFILE_SMALL, 3, 0, 500000, 0},
    {FXS_PROFILE_SMALL, 3, 1, 0, 0},
    {FXS_PROFILE_SMALL, 1, 0, 20000, 450000},
};

static void choose_for_device(convert_options *o)
{
    const int i = o->device - 1;
    char count[40] = "";
    if (!o->device)
        return;
    if (!is_given("profile"))
        o->load.profile = devices[i].profile;
    if (!is_given("sh-degree"))
        o->filter.sh_degree = devices[i].sh_degree;
    o->load.tree |= devices[i].tree;
    if (!is_given("decimate") && devices[i].count) {
        o->load.decimate_count = devices[i].count;
        o->filter.drawable = 1;
        snprintf(count, sizeof count, " --decimate %" PRIu64, devices[i].count);
    }
    note("--for %s: --profile %s --sh-degree %d%s%s", device_names[i], profile_names[o->load.profile],
         o->filter.sh_degree, o->load.tree ? " --levels" : "", count);
}

#define OPTIONS convert_options

static const option_row own_rows[] = {
    {.help = "Options:"},
    {"edits", "FILE", TEXT(edits), .help =
     "first delete the Gaussians that were deleted by hand in the viewer, which saved FILE for this scene (the search "
     "for an up direction still sees them)"},
    {.help =
     "First, the whole scene is rotated, scaled and moved, always in this order, SH included. Axes are as in a .ply "
     "(x right, y down, z to the front):"},
    {"up", "X,Y,Z", take_direction, FIELD(vector_option, up), .expected = DIRECTION_EXPECTED, .basic = 1, .help =
     "turn this direction to up, 0,-1,0, by the shortest rotation. An .fxs then stores it as up"},
    {"auto-up", 0, FLAG(auto_up), .help =
     "find the scene's up direction by looking at it from many sides, and turn it to up as --up does"},
    {"level", "X,Y,Z,X,Y,Z,X,Y,Z", take_level, 0, .expected =
     "three points X,Y,Z,X,Y,Z,X,Y,Z that lie on no line", .help =
     "turn three points of the ground level, instead of --up; up is the side with most centres of Gaussians. render "
     "--pick prints the position of a point"},
    {"rotate", "X,Y,Z", VECTOR(degrees, "degrees about three axes X,Y,Z"), .help =
     "rotate about the x axis, then the y axis, then the z axis, in degrees; the axes stay fixed"},
    {"scale", "S", REAL(whole.scale, ABOVE_0, INFINITY, "a number above 0"), .help =
     "scale about the origin by the factor S, above 0"},
    {"translate", "X,Y,Z", VECTOR(whole.translation, "three numbers X,Y,Z"), .help = "move by this vector"},
    {.help = "Second, Gaussians are removed, by their new positions:"},
    {"crop", "MINX,MINY,MINZ,MAXX,MAXY,MAXZ", take_crop, 0, .expected =
     "six numbers MINX,MINY,MINZ,MAXX,MAXY,MAXZ, no MIN above its MAX", .basic = 1, .help =
     "keep Gaussians with their centre in this box, edges included, in a moving scene at any time while they are "
     "visible. Boxes may be repeated: any of them; likewise spheres and cylinders. Options of different kinds: all of "
     "them"},
    {"sphere", "X,Y,Z,R", take_sphere, 0, .expected =
     "four numbers X,Y,Z,R, R 0 or more", .help =
     "keep Gaussians with their centre at most R from X,Y,Z"},
    {"cylinder", "X,Y,Z,X,Y,Z,R", take_cylinder, 0, .expected =
     "seven numbers X,Y,Z,X,Y,Z,R, two places and R 0 or more", .help =
     "keep Gaussians with their centre in the cylinder from the first point to the second, radius R"},
    {"prune", "ALPHA", REAL(filter.opacity, 0, 1, "an opacity, 0 to 1"), .help =
     "keep Gaussians with an opacity of at least ALPHA, 0 to 1"},
    {"drop-floaters", "[=STRENGTH]", take_floaters, FIELD(int, filter.floaters), 1, FXS_FLOATER_STRENGTHS,
     .basic = 1, .help =
     "then drop Gaussians with fewer than 8 others in the 27 cells around them. STRENGTH 1 (default): strays; 2 and 3: "
     "haze too (opacity below 0.9); 4 and 5: also large isolated ones and backgrounds, for scenes of one object. A "
     "cell is 4 times the largest sigma of the Gaussian (at least the median Gaussian's), rounded up to a power of "
     "two"},
    {"thing", 0, FLAG(filter.thing), .basic = 1, .help =
     "then keep one thing, such as a statue, without cameras: the cluster of small opaque Gaussians in the middle, "
     "without the ground below, walls, floaters and haze. Without --up and --level, the scene is also turned level, by "
     "its ground. An .fxs gets a new start view. Ends with an error if no thing stands out"},
    {"sh-degree", "D", INT(filter.sh_degree, 0, 3), .help =
     "keep SH up to this degree, 0 to 3 (default 3)"},
    {.help = "Third, Gaussians are merged:"},
    {"decimate", "N", take_decimate, 0, .expected =
     "a number of Gaussians from 1 on, or a share above 0% up to 100%", .basic = 1, .help =
     "merge neighbours until N Gaussians, or N%, are left. Two Gaussians become one with their joint position, "
     "covariance, colour and SH, weighted by opacity and area"},
    {.help = "Output file:"},
    {"for", "DEVICE", CHOICE_FROM(1, device, device_names), .basic = 1, .help =
     "choose options of an .fxs, unless they are given: phone (--profile small --decimate 500000), web "
     "(--profile small --levels) or board (--profile small --sh-degree 1 --decimate 20000, at most 450000 bytes)"},
    {"profile", "P", CHOICE(load.profile, profile_names), .basic = 1, .help =
     "how an .fxs is packed, with bytes per Gaussian at SH degree 3 and PSNR on a captured scene: default 63.5 (56.9 "
     "dB), compact 39.6 (53.9 dB) or small 19.6 (44.4 dB). Without SH: 18.5, 18.5 and 13.5 bytes. Up to 8 million "
     "Gaussians, the result is compared with the floats, and a view below 52, 48 or 38 dB is reported"},
    {"levels", 0, FLAG(load.tree), .basic = 1, .help =
     "add levels of detail to an .fxs, a tree of coarser Gaussians: about twice the size"},
    {"refine", "[=STEPS]", take_refine, 0, 0, FXS_REFINE_STEPS_MOST, .help =
     "with --levels: fit the coarse Gaussians of each level to pictures of the scene, in STEPS steps, 0 to 100000 "
     "(default 200), and measure the value of each node in them. 0: only measure"},
    {"cameras", "CAMERAS", TEXT(cameras), .help =
     "camera file for the pictures of --refine, in the axes of OUT: at most 64 evenly spaced views, 16 with --refine=0 "
     "(default: views around the scene and within it)"},
    {"block", "I/N", take_block, 0, .expected = "I/N, I from 1 to N, N up to 512", .help =
     "write only part I of N of an .fxs, N up to 512. convert PART... OUT merges all parts, made with the same files "
     "and options"},
    {"start-view", "EYE,LOOK[,FOV]|CAMERAS[:VIEW]", take_start, FIELD(start_option, start),
     .expected = START_EXPECTED, .basic = 1, .help =
     "first camera of render and view, stored in an .fxs: eye and target, X,Y,Z each, and vertical field of view "
     "(default 50 degrees); or a view of a camera file, by its number from 0 or its name (default 0). In the axes of "
     "OUT, with the .fxs's up direction, or 0,-1,0 (default: the start view of an .fxs in IN, moved with it; "
     "of a cropped scene, the first view of what is left)"},
    {"spz-version", "V", INT(spz_version, 3, 4), .help = "version of an .spz: 3 (gzip) or 4 (zstd, default)"},
    {"spz-fine", 0, FLAG(spz_fine), .help =
     "store 8 bits of SH and 24 bits of positions in an .spz: nearly twice the size at SH degree 3, and 53 instead of "
     "37 dB on a captured scene (default, as Niantic's encoder: 5 bits for SH degree 1, 4 above, and about 12 bits of "
     "positions after the point)"},
    {.help = "Scenes that move (an .fxs or a .splat4d keeps their motion; --drop-floaters, --thing and --decimate need "
     "--time):"},
    {"time", "SECONDS", TIME(time_q32), .help =
     "convert the scene as it is at one moment. A scene that loops starts again after its duration"},
    {"times", "A..B|all", TIMES(times), .help =
     "write numbered files, OUT has one %d, as out/%04d.ply: the moment A, and --fps moments a second until before B; "
     "all: from 0 to the end of the scene. If OUT is one .fxs or .splat4d: the moving scene from A to B, which begins "
     "at 0 there"},
    {"fps", "RATE", RATE(rate), .help =
     "moments per second of --times, 1 to 1000, also as a fraction: 24000/1001 (default: the rate of the scene, else "
     "30)"},
    {.help = "Replacing files:"},
    {"force", 0, take_force, 0, .help =
     "allow OUT to replace a file of IN, when OUT is complete; never an .fxs, and never a file that only belongs to a "
     "file of IN, as a tile of a tileset"},
    {0}
};

static int is_filtered(void)
{
    return is_given("crop") || is_given("sphere") || is_given("cylinder") || is_given("prune") ||
           is_given("drop-floaters") || is_given("thing") || is_given("for") || is_given("sh-degree") ||
           is_given("decimate") || is_given("edits");
}

static const option_rule rules[] = {
    {"time", "times", 0, "give one"},
    {"fps", 0, "times", 0},
    {"times", "block", 0, 0},
    {0}
};

static int check_moments(convert_options *o)
{
    const fxs_scene_format *format = fxs_scene_format_of(o->out, 1);
    if (check_rules(rules))
        return EXIT_USAGE;
    o->load.has_range = o->times.given && !is_pattern(o->out) && format && format->moves;
    if (o->times.given && !is_pattern(o->out) && !o->load.has_range)
        return fail(EXIT_USAGE, "%s: for --times, expected a name with one %%d, as out/%%04d.ply", o->out);
    if (is_given("fps") && o->load.has_range)
        return fail(EXIT_USAGE, "--fps is for numbered files: %s has no %%d", o->out);
    o->load.has_moment = is_given("time");
    o->load.moment = ldexp((double)o->time_q32, -32);
    return 0;
}

static int read_options(convert_options *o, int argc, char **argv)
{
    memset(o, 0, sizeof *o);
    o->rate[0] = 30;
    o->rate[1] = 1;
    o->load.sound = SOUND_LOST;
    files_force(FILES_REFUSE_UNFORCED);
    fxs_scene_filter_init(&o->filter);
    fxs_placement_init(&o->whole, 0, 0);
    if (take_options(&command_convert, o, argc, argv))
        return EXIT_USAGE;
    if (optind > argc - (o->world.file ? 1 : 2))
        return fail(EXIT_USAGE, "convert takes two files or more, IN and OUT; see: fixsplat convert --help");
    if (take_scenes(&o->world, "convert", argc - 1 - optind, argv + optind))
        return EXIT_USAGE;
    o->in = o->world.file ? o->world.file : argv[optind];
    o->out = argv[argc - 1];
    if (is_given("force") && ends_with(o->out, ".fxs"))
        return fail(EXIT_USAGE, "--force: an .fxs never replaces a file of IN: give it a name of its own");
    if (is_given("profile") && !ends_with(o->out, ".fxs"))
        return fail(EXIT_USAGE, "--profile is for .fxs");
    if (o->device && !ends_with(o->out, ".fxs"))
        return fail(EXIT_USAGE, "--for is for .fxs");
    if (o->device && o->blocks)
        return fail(EXIT_USAGE, "--for is for a whole scene, not for a --block of it");
    if (o->filter.thing && o->blocks)
        return fail(EXIT_USAGE, "--thing is for a whole scene, not for a --block of it");
    choose_for_device(o);
    if (o->load.tree && !ends_with(o->out, ".fxs"))
        return fail(EXIT_USAGE, "--levels is for .fxs");
    if (o->has_refine && !o->load.tree)
        return fail(EXIT_USAGE, "--refine is for --levels");
    if (o->cameras && !o->has_refine)
        return fail(EXIT_USAGE, "--cameras is for --refine");
    if (o->blocks && !ends_with(o->out, ".fxs"))
        return fail(EXIT_USAGE, "--block is for .fxs");
    if (o->blocks && (o->has_refine || o->start.given))
        return fail(EXIT_USAGE, "--%s is for a whole scene, not for a --block of it",
                    o->has_refine ? "refine" : "start-view");
    if (o->edits && (o->world.file || o->world.scene_count > 1 || o->world.place_count))
        return fail(EXIT_USAGE, "--edits is for one scene; edit it first, then merge or --place it");
    if (o->has_level + o->auto_up + is_given("up") > 1)
        return fail(EXIT_USAGE, "--up, --auto-up and --level: give one");
    if (o->start.given && !ends_with(o->out, ".fxs"))
        return fail(EXIT_USAGE, "--start-view is for .fxs");
    if ((o->spz_version || o->spz_fine) && !ends_with(o->out, ".spz"))
        return fail(EXIT_USAGE, "--spz-%s: %s is no .spz", o->spz_version ? "version" : "fine", o->out);
    return check_moments(o);
}

/* Quality that each compression profile promises. */
static const struct promise {
    double worst;                           /* least PSNR in dB over all views, which most scenes reach */
    int views;
    const char *better;
} promises[] = {
    [FXS_PROFILE_DEFAULT] = {52, 3, "no profile loses less"},
    [FXS_PROFILE_COMPACT] = {48, 6, "profile default loses less"},
    [FXS_PROFILE_SMALL] = {38, 6, "profile compact loses less"},
};

/* Compares views of a packed scene with views of the same scene as floats. Prints a note about views below the promised
   quality. */
static void check_views(const world *packed, const convert_options *o, const load_options *load)
{
    enum { WIDTH = 480, HEIGHT = 320, MOST = 8000000 };     /* MOST Gaussians take about 3 GB of floats */
    const enum fxs_profile profile = packed->scenes[0].opened->scene->profile;
    const struct promise *promise = &promises[profile];
    load_options again = *load;
    frame_options options;
    quality q;
    if (packed->scenes[0].opened->scene->count > MOST) {
        note("%s: not compared with the floats: more than %d Gaussians; info --compare has no limit", o->out, MOST);
        return;
    }
    again.again = 1;
    frame_options_default(&options);
    options.width = WIDTH;
    options.height = HEIGHT;
    const int status = quality_measure(&q, packed, 0, &(float_files){&o->placed, o->in, &again},
                                       options.render.cutoff, &options,
                                       &(quality_options){promise->views, promise->worst, .has_ssim = 0});
    if (status)
        note("%s: not compared with the floats", o->out);
    else if (q.worst_psnr < promise->worst)
        note("%s: profile %s loses more of this scene than of most: a view %s is %.1f dB from the floats, "
             "where %.0f is usual; %s", o->out, profile_names[profile], q.views[q.worst_view].name, q.worst_psnr,
             promise->worst, quality_nudged(&q) ? "moving its Gaussians by 1e-6 of the distance changes a view by as "
             "much or more" : promise->better);
    if (!status)
        quality_free(&q);
}

static int refine_by(const convert_options *o, const fxs_opened *packed, const load_options *load,
                     const fxs_view *views, long count)
{
    const uint32_t threads = load->threads ? load->threads : fxs_processors();
    fxs_pool *pool = fxs_pool_create(threads);
    fxs_kernels fastest;
    const fxs_config config = {.size = sizeof config, .workers.run = fxs_pool_run, .workers.pool = pool,
                               .workers.count = threads,
                               .kernels = &fastest};
    char label[] = "refining";
    fxs_context context;
    fxs_message message;
    fxs_refine_options how = {.size = sizeof(fxs_refine_options), .context = &context,
                              .steps = (uint32_t)o->refine_steps, .views = views,
                              .view_count = (size_t)count, .cpu = ~0u};
    if (!pool)
        return fail(EXIT_FAILED, "out of memory: %u threads", (unsigned)threads);
    fxs_kernels_choose(&fastest, ~0u);
    fxs_context_init(&context, &config);
    how.progress = progress_of(load, label);
    const int error = fxs_refine((void *)(uintptr_t)packed->data, packed->bytes, &how, &message);
    fxs_pool_destroy(pool);
    return error ? fail(EXIT_FAILED, "--refine: %s", message.text) : 0;
}

static int refine(const convert_options *o, const fxs_opened *packed, const load_options *load)
{
    fxs_view *views = 0;
    fxs_message message;
    long count = 0;
    if (o->cameras)
        files_read(o->cameras);
    if (o->cameras && (count = fxs_camera_file_read(o->cameras, &views, &message)) < 0)
        return fail(EXIT_FAILED, "--cameras: %s", message.text);
    const int status = refine_by(o, packed, load, views, count);
    free(views);
    return status;
}

/* Stores the start view of the options in a packed scene. A cropped scene gets a new one, which shows what is left. */
static int set_start(const convert_options *o, const fxs_opened *packed)
{
    void *data = (void *)(uintptr_t)packed->data;
    fxs_message message;
    if (o->start.given)
        return start_store(&o->start, data, &message) ? fail(EXIT_FAILED, "--start-view: %s", message.text) : 0;
    if (!(o->filter.shape_count || o->filter.thing) || packed->info->start.tangent > 0)
        return 0;
    return fxs_start_choose(data, packed->bytes, &message) ? fail_for(&message) : 0;
}

static int to_fxs(const convert_options *o, const load_options *how)
{
    world w;
    fxs_message message;
    load_options load = *how;
    load.still = o->has_refine ? "is not refined: give --time SECONDS" : 0;
    if (world_open_merged(&w, &o->placed, o->in, &load))
        return EXIT_FAILED;
    const loaded_scene *loaded = &w.scenes[0];
    const fxs_scene *scene = loaded->opened->scene;
    int status = files_check();
    if (!status && o->device && devices[o->device - 1].bytes && loaded->opened->bytes > devices[o->device - 1].bytes)
        status = fail(EXIT_FAILED, "%s: %zu bytes: --for %s allows %zu; --decimate, --sh-degree and --profile small "
                      "make it smaller", o->out, loaded->opened->bytes, device_names[o->device - 1],
                      devices[o->device - 1].bytes);
    if (!status && scene->profile == FXS_PROFILE_COMPACT && !scene->sh_degree)
        note("%s: profile compact is no smaller than default for a scene without SH; small is", o->out);
    if (!status)
        status = set_start(o, loaded->opened);
    if (!status && o->has_refine)
        status = refine(o, loaded->opened, &load);
    if (!status && fxs_file_write(o->out, loaded->opened->data, loaded->opened->bytes, &message))
        status = fail_for(&message);
    if (!status)
        check_views(&w, o, &load);
    world_close(&w);
    return status;
}

static int pack_part(const convert_options *o, const load_options *load, fxs_scene_file *file,
                     const fxs_scene_file_info *info, fxs_packed_scene *part)
{
    const uint32_t threads = load->threads ? load->threads : fxs_processors();
    fxs_pool *pool = threads > 1 ? fxs_pool_create(threads) : 0;
    fxs_pack_options options = {.size = sizeof(fxs_pack_options), .profile = load->profile, .workers.run = pool
                                ? fxs_pool_run : 0, .workers.pool = pool,
                                .workers.count = pool ? threads : 1, .tree = load->tree};
    char label[] = "packing";
    fxs_pack_report report;
    fxs_message message;
    options.progress = progress_of(load, label);
    const int error = fxs_pack_part(file, info, o->block, o->blocks, part, &report, &options, &message);
    progress_end();
    fxs_pool_destroy(pool);
    if (error)
        return fail(EXIT_FAILED, "%s: %s", o->in, message.text);
    note_packed(o->in, &report);
    return 0;
}

static int to_part(const convert_options *o, const load_options *how)
{
    load_options load = *how;
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_packed_scene part;
    fxs_message message;
    load.still = "is not written in blocks: give --time SECONDS";
    if (open_merged(&o->placed, o->in, &load, &file, &info))
        return EXIT_FAILED;
    int status = pack_part(o, &load, file, &info, &part);
    fxs_scene_file_close(file);
    if (status)
        return status;
    status = files_check();
    if (!status && fxs_part_file_write(o->out, &part, &message))
        status = fail_for(&message);
    fxs_packed_scene_free(&part);
    return status;
}

static int set_start_of_parts(void *argument, void *header, fxs_message *message)
{
    const convert_options *o = argument;
    return o->start.given ? start_store(&o->start, header, message) : 0;
}

static int check_options_of_parts(const convert_options *o)
{
    const char *other = given_beside("levels start-view quiet");
    if (other)
        return fail(EXIT_USAGE, "--%s: %s is a part of a scene; parts are merged unchanged", other,
                    o->world.scenes[0]);
    return ends_with(o->out, ".fxs") ? 0 : fail(EXIT_USAGE, "%s: parts of an .fxs are merged to an .fxs", o->out);
}

static int merge_parts(convert_options *o)
{
    char label[] = "merging";
    fxs_message message;
    fxs_part_merge how = {.tree = o->load.tree, .change = set_start_of_parts, .argument = o};
    int status = check_options_of_parts(o);
    for (int i = 0; i < o->world.scene_count; i++)
        files_read(o->world.scenes[i]);
    files_write(o->out);
    files_force(FILES_REFUSE);
    if (!status)
        status = files_check();
    if (status)
        return status;
    how.progress = progress_of(&o->load, label);
    const int error = fxs_part_files_merge(o->world.scenes, (uint32_t)o->world.scene_count, o->out, &how, &message);
    progress_end();
    return error ? fail_for(&message) : 0;
}

static int has_part(const convert_options *o)
{
    fxs_message message;
    for (int i = 0; i < o->world.scene_count; i++)
        if (fxs_part_file_is(o->world.scenes[i], &message) == 1)
            return 1;
    return 0;
}

enum { BATCH = 256 };

static int find_bounds(fxs_scene_file *file, fxs_scene_write_options *o, fxs_message *message)
{
    fxs_gaussian batch[BATCH];
    int first = 1;
    for (long n; (n = fxs_scene_file_read(file, batch, BATCH, message)) != 0;) {
        if (n < 0)
            return -1;
        for (int i = 0; i < 3; i++)
            for (long k = 0; k < n; k++) {
                const float x = batch[k].position[i];
                o->low[i] = (first && !k) || x < o->low[i] ? x : o->low[i];
                o->high[i] = (first && !k) || x > o->high[i] ? x : o->high[i];
            }
        first = 0;
    }
    return fxs_scene_file_rewind(file, message);
}

static int copy(fxs_scene_writer *w, const char *out, fxs_scene_file *file, const fxs_scene_file_info *info,
                const load_options *load, fxs_message *message)
{
    fxs_gaussian batch[BATCH];
    char label[] = "converting";
    const fxs_progress progress = progress_of(load, label);
    const int moves = info->time.duration > 0;
    uint64_t done = 0;
    int result = 0;
    for (long n; !result && (n = fxs_scene_file_read(file, batch, BATCH, message)) != 0;) {
        result = n < 0   ? -1
                 : moves ? fxs_scene_writer_put_moving(w, batch, fxs_scene_file_motions(file), (size_t)n, message)
                         : fxs_scene_writer_put(w, batch, (size_t)n, message);
        done += n < 0 ? 0 : (uint64_t)n;
        if (progress.call(progress.argument, (double)done / (double)info->count) && !result)
            result = fxs_fail_as(FXS_ERR_STOPPED, message, "%s: stopped", out);
    }
    progress_end();
    return result;
}

static void note_clamped(const char *out, uint32_t count, const char *what)
{
    if (count)
        note("%s: clamped %s, of %" PRIu32 " Gaussians", out, what, count);
}

static void note_losses(const char *out, const double origin[3], const fxs_scene_write_report *report)
{
    const fxs_spz_clamped *clamped = &report->clamped;
    if (report->lost_sh || report->lost_antialiased)
        note("%s: a %s cannot hold%s%s%s", out, strrchr(out, '.'), report->lost_sh ? " the SH above degree 0" : "",
             report->lost_sh && report->lost_antialiased ? " and" : "",
             report->lost_antialiased ? " that the scene is anti-aliased" : "");
    if (clamped->position)
        note("%s: brought in %" PRIu32 " Gaussians from beyond %g units: an .spz has 24 bits for a position", out,
             clamped->position, clamped->reach);
    if (report->moved > 0)
        note("%s: single precision moves positions so far out by up to %.2g units; nothing is lost with --translate "
             "%.0f,%.0f,%.0f", out, report->moved, 0 - origin[0], 0 - origin[1], 0 - origin[2]);
    note_clamped(out, clamped->dc, "dc beyond +-3.33");
    note_clamped(out, clamped->sh, "SH beyond +-1");
    note_clamped(out, clamped->scale, "ln(sigma) outside -10 to 5.94");
}

static int write_file(const char *out, int spz_version, int spz_fine, const load_options *load, fxs_scene_file *file,
                      const fxs_scene_file_info *info)
{
    fxs_scene_writer *w = NULL;
    fxs_scene_write_report report;
    fxs_message message, closing;
    fxs_scene_write_options options = {.size = sizeof(fxs_scene_write_options), .count = info->count,
                                       .sh_degree = info->sh_degree,
                                       .antialiased = info->antialiased, .spz_version = spz_version,
                                       .spz_fine = spz_fine, .time = info->time};
    memcpy(options.origin, info->origin, sizeof options.origin);
    char label[] = "compressing";
    const fxs_progress progress = progress_of(load, label);
    int result = ends_with(out, ".glb") ? find_bounds(file, &options, &message) : 0;
    if (!result)
        result = fxs_scene_writer_open(out, &options, &w, &message);
    if (!result)
        result = copy(w, out, file, info, load, &message);
    if (fxs_scene_writer_close(w, &report, &progress, &closing) && !result) {
        message = closing;
        result = -1;
    }
    progress_end();
    if (result)
        return fail_for(&message);
    note_losses(out, info->origin, &report);
    return EXIT_OK;
}

int convert_merged(const char *out, int spz_version, int spz_fine, const fxs_world *placed, const char *name,
                   const load_options *how)
{
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_scene_filter filter;
    load_options load = *how;
    char still[128];
    snprintf(still, sizeof still, "is not kept by a %.30s: give --time SECONDS, or --times A..B for numbered files",
             strrchr(out, '.'));
    load.still = fxs_scene_format_of(out, 1)->moves ? 0 : still;
    fxs_scene_filter_init(&filter);
    if (how->filter)
        filter = *how->filter;
    filter.drawable = 1;
    load.filter = &filter;
    if (open_merged(placed, name, &load, &file, &info))
        return EXIT_FAILED;
    int status = files_check();
    if (!status)
        status = write_file(out, spz_version, spz_fine, &load, file, &info);
    fxs_scene_file_close(file);
    return status;
}

/* Turns the up direction `up` to the side of the ground plane that has more Gaussians. */
static int turn_level(convert_options *o)
{
    fxs_gaussian batch[BATCH];
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_message message;
    load_options load = o->load;
    int64_t above = 0;
    long n;
    load.again = 1;
    if (open_merged(&o->placed, o->in, &load, &file, &info))
        return EXIT_FAILED;
    while ((n = fxs_scene_file_read(file, batch, BATCH, &message)) > 0)
        for (long k = 0; k < n; k++) {
            double height = 0;
            for (int i = 0; i < 3; i++)
                height += o->up[i] * (info.origin[i] + (double)batch[k].position[i] - o->level[i]);
            above += (height > 0) - (height < 0);
        }
    fxs_scene_file_close(file);
    if (above < 0 || (above == 0 && o->up[1] > 0))
        for (int i = 0; i < 3; i++)
            o->up[i] = -o->up[i];
    return n < 0 ? fail_for(&message) : 0;
}

static int look_for_up(convert_options *o)
{
    world w;
    fxs_message message;
    load_options load = o->load;
    load.again = 1;
    load.tree = 0;
    load.filter = 0;
    if (world_open_merged(&w, &o->placed, o->in, &load))
        return EXIT_FAILED;
    memcpy(o->up, w.scenes[0].opened->info->start.up, sizeof o->up);
    const int is_known = !o->auto_up && (o->up[0] != 0 || o->up[1] != 0 || o->up[2] != 0);
    const int status = !is_known && find_up(w.scenes[0].opened, o->up, &message) ? fail_for(&message) : 0;
    if (!status && !o->filter.thing)
        note("%s: up is %.4f,%.4f,%.4f", o->in, o->up[0], o->up[1], o->up[2]);
    world_close(&w);
    return status;
}

/* Corrects the up direction to the normal of the ground under the thing. */
static int look_for_ground(convert_options *o)
{
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_scene_filter filter;
    load_options load = o->load;
    fxs_scene_filter_init(&filter);
    filter.thing = 2;
    load.filter = &filter;
    load.again = 1;
    load.decimate_count = 0;
    load.decimate_share = 0;
    memcpy(o->placed.up, o->up, sizeof o->up);
    if (open_merged(&o->placed, o->in, &load, &file, &info))
        return EXIT_FAILED;
    fxs_scene_file_close(file);
    memcpy(o->up, info.start.up, sizeof o->up);
    note("%s: up is %.4f,%.4f,%.4f", o->in, o->up[0], o->up[1], o->up[2]);
    return 0;
}

static int place_whole(convert_options *o)
{
    fxs_message message;
    fxs_object checked;
    if (o->up[0] != 0 || o->up[1] != 0 || o->up[2] != 0)
        fxs_placement_turn_up(&o->whole, o->up);
    memcpy(o->placed.up, o->up, sizeof o->up);
    for (int axis = 0; axis < 3; axis++)
        if (o->degrees[axis] != 0)
            fxs_placement_turn(&o->whole, axis, o->degrees[axis]);
    if (fxs_object_place(&checked, 0, &o->whole, 0, &message))
        return fail(EXIT_USAGE, "--scale or --translate: %s", message.text);
    if (fxs_placement_is_plain(&o->whole))
        return 0;
    fxs_world_place(&o->placed, &o->whole);
    for (uint32_t i = 0; i < o->placed.count; i++) {
        const fxs_placement *p = &o->placed.objects[i];
        fxs_crop crops[FXS_MAX_CROPS];
        if (fxs_object_place(&checked, 0, p, crops, &message))
            return fail(EXIT_FAILED, "%s, placed: %s", o->placed.files[p->file], message.text);
    }
    return 0;
}

/* Writes one file. */
static int write_out(const convert_options *o)
{
    load_options load = o->load;
    load.filter = is_filtered() ? &o->filter : 0;
    return o->blocks                   ? to_part(o, &load)
           : ends_with(o->out, ".fxs") ? to_fxs(o, &load)
                                       : convert_merged(o->out, o->spz_version, o->spz_fine, &o->placed, o->in, &load);
}

/* Finds the time of the scenes in files: the longest duration, the highest rate. */
static int find_time(const convert_options *o, fxs_time *time)
{
    load_options load = o->load;
    *time = (fxs_time){.duration = 0};
    load.again = 1;
    load.has_moment = load.has_range = 0;
    load.filter = 0;
    load.decimate_count = 0;
    load.decimate_share = 0;
    for (uint32_t i = 0; i < o->placed.file_count; i++) {
        fxs_scene_file *file;
        fxs_scene_file_info info;
        load_options own;
        if (options_of_file(&own, &load, i, o->placed.file_count) ||
            open_unfiltered(o->placed.files[i], &own, &file, &info))
            return EXIT_FAILED;
        fxs_scene_file_close(file);
        time->duration = fmax(time->duration, info.time.duration);
        time->rate = fmax(time->rate, info.time.rate);
    }
    return 0;
}

/* Checks that a scene moves if a moment or a range of times is given, and takes the range. */
static int check_time(convert_options *o)
{
    fxs_time time;
    if (!o->load.has_moment && !o->load.has_range)
        return 0;
    if (find_time(o, &time))
        return EXIT_FAILED;
    o->load.from = o->times.all ? 0 : o->times.from;
    o->load.to = o->times.all ? time.duration : o->times.to;
    return time.duration > 0 ? 0
           : fail(EXIT_FAILED, "%s: does not move: no --time%s", o->in, o->load.has_range ? "s" : "");
}

/* Writes a file for each time. */
static int write_times(const convert_options *given)
{
    convert_options o = *given;
    fxs_time time;
    char name[4096];
    int status = find_time(given, &time);
    const long count = status ? 0 : times_settle(&o.times, o.rate, &time, o.in);
    for (long i = 0; i < count && !status; i++) {
        name_numbered(name, sizeof name, given->out, i);
        files_write(name);
    }
    status = status || count < 0 ? EXIT_FAILED : files_check();
    o.load.has_moment = 1;
    for (long i = 0; i < count && !status; i++) {
        name_numbered(name, sizeof name, given->out, i);
        o.out = name;
        o.load.moment = times_at(&o.times, (double)i);
        status = write_out(&o);
        o.load.again = 1;
        progress_bar("converting", (double)(i + 1) / (double)count);
    }
    progress_end();
    return status;
}

static int check_files(const convert_options *o)
{
    const fxs_world *placed = &o->placed;
    for (uint32_t i = 0; i < placed->file_count; i++)
        files_read(placed->files[i]);
    if (o->edits)
        files_read(o->edits);
    if (!o->times.given || o->load.has_range)
        files_write(o->out);
    if (ends_with(o->out, ".fxs"))
        files_force(FILES_REFUSE);          /* no input may be replaced, since the comparison of views reads it again */
    return files_check();
}

static int run(int argc, char **argv)
{
    static convert_options o;
    int status = read_options(&o, argc, argv);
    if (status)
        return status;
    char endings[256];
    fxs_scene_format_endings(endings, sizeof endings, 1);
    if (!fxs_scene_format_of(o.out, 1))
        return fail(EXIT_USAGE, "%s: expected a name ending in one of %s", o.out, endings);
    if (has_part(&o))
        return merge_parts(&o);
    status = place_scenes(&o.placed, &o.world);
    if (status)
        return status;
    status = check_time(&o);
    const int looks = o.auto_up || (o.filter.thing && !o.has_level && !is_given("up"));
    if (!status)
        status = o.has_level ? turn_level(&o) : looks ? look_for_up(&o) : 0;
    if (!status && looks && o.filter.thing)
        status = look_for_ground(&o);
    if (!status)
        status = place_whole(&o);
    if (!status)
        status = check_files(&o);
    if (!status && o.edits)
        status = edits_find(o.edits, o.in, &o.load, &o.deleted, &o.filter.deleted_count);
    o.filter.deleted = o.deleted;
    o.load.filter = &o.filter;
    if (!status)
        status = o.times.given && !o.load.has_range ? write_times(&o) : write_out(&o);
    fxs_world_free(&o.placed);
    free(o.deleted);
    return status;
}

const command command_convert = {
    "convert", "scene files -> one of another format", run,
    "Usage: fixsplat convert IN... OUT [OPTION...]\n\n"
    "Converts a scene, or several scenes merged into one. The ending of OUT chooses the format; fixsplat help formats\n"
    "lists the formats and their losses. Gaussians that cannot be drawn are left out. An .fxs is decoded.\n\n"
    "Merged scenes get the highest SH degree of any file; missing coefficients are 0. All files must be anti-aliased,\n"
    "or none. An existing OUT is replaced when the new file is complete; a file of IN only with --force.\n",
    0,
    "  $ fixsplat convert scene.ply scene.fxs\n"
    "  $ fixsplat convert scene.ply phone.fxs --profile compact\n"
    "  $ fixsplat convert scene.ply small.spz --prune 0.02 --sh-degree 1\n"
    "  $ fixsplat convert scene.ply hall.fxs --start-view 0,-1.6,-4,0,-1,0,65\n"
    "  $ fixsplat convert scan.ply statue.fxs --thing --for phone\n"
    "  $ fixsplat convert scene.spz table.ply --crop -1,-1,-1,1,0.5,1\n"
    "  $ fixsplat convert scan.ply level.sog --up 0,0,1 --scale 0.01 --sphere 0,0,0,2 --drop-floaters=3\n"
    "  $ fixsplat convert scene.ply far.glb --decimate 10%\n"
    "  $ fixsplat convert room.ply chair.spz both.fxs --place chair.spz:1,0,2\n"
    "  $ fixsplat convert --scene world.json all.fxs\n"
    "  $ fixsplat convert city.ply part-3.fxs --levels --block 3/8\n"
    "  $ fixsplat convert part-*.fxs city.fxs\n"
    "  $ fixsplat convert dance.splatv dance.fxs\n"
    "  $ fixsplat convert dance.fxs pose.ply --time 1.5\n"
    "  $ fixsplat convert dance.fxs out/%04d.ply --times all --fps 24\n",
    {{own_rows, 0}, {world_rows, offsetof(convert_options, world)},
     {load_rows, offsetof(convert_options, load)}, COMMON_TABLE}
};
