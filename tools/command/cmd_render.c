/* Command-line options of `fixsplat render`. */
#include "cmd_render.h"

#include <stdlib.h>
#include <string.h>

#include <fixsplat/backend.h>
#include <fixsplat/scene.h>
#include "src/base/os_calls.h"
#include "src/image/depth_file.h"
#include "auto_backend.h"
#include "views.h"

enum { FRAMES_MOST = 100000, SAMPLES_MOST = 1024 };

static int take_alpha(const option_row *row, void *field, const char *value)
{
    (void)row, (void)value;
    ((render_options *)field)->format = FXS_FORMAT_RGBA8_COVERAGE;
    return 0;
}

static int take_depth_kind(const option_row *row, void *field, const char *value)
{
    static const int kinds[] = {DRAW_MEDIAN_DEPTH, DRAW_MEAN_DEPTH};
    const int choice = choice_of(row, value);
    if (choice < 0)
        return wrong_value(row, value);
    *(int *)field |= kinds[choice];
    return 0;
}

static int take_pick(const option_row *row, void *field, const char *value)
{
    render_options *o = field;
    o->has_pick = parse_counts(value, 2, 0, FXS_MAX_SIZE - 1, o->pick);
    return o->has_pick ? 0 : wrong_value(row, value);
}

static int take_focus(const option_row *row, void *field, const char *value)
{
    double *focus = &((render_options *)field)->frame.focus;
    *focus = 0;
    return !strcmp(value, "auto") || (parse_vector(value, 1, focus) && *focus > 0) ? 0 : wrong_value(row, value);
}

static int take_scissor(const option_row *row, void *field, const char *value)
{
    render_options *o = field;
    const int *s = o->scissor;
    o->has_scissor = parse_counts(value, 4, 0, FXS_MAX_SIZE, o->scissor) && s[2] > 0 && s[3] > 0;
    return o->has_scissor ? 0 : wrong_value(row, value);
}

static int take_stats(const option_row *row, void *field, const char *value)
{
    render_options *o = field;
    o->stats = 1;
    o->pairs = value && !strcmp(value, "pairs");
    return !value || o->pairs ? 0 : wrong_value(row, value);
}

static int take_format(const option_row *row, void *field, const char *value)
{
    render_options *o = field;
    char ending[8];
    if (choice_of(row, value) < 0)
        return wrong_value(row, value);
    snprintf(ending, sizeof ending, ".%s", value);
    o->encoding = fxs_image_format_of(ending);
    return 0;
}

/* Parses a picture's path, or a hash of 16 lower-case hexadecimal digits. */
static int take_expected(const option_row *row, void *field, const char *value)
{
    render_options *o = field;
    (void)row;
    o->has_expected_hash = strlen(value) == 16 && strspn(value, "0123456789abcdef") == 16;
    o->expected_hash = o->has_expected_hash ? strtoull(value, 0, 16) : 0;
    o->expect = o->has_expected_hash ? 0 : value;
    return 0;
}

#define OPTIONS render_options

static const option_row own_rows[] = {
    {.help = "Options:"},
    {"output", "OUT", OUTPUT(output), .letter = 'o', .basic = 1, .help =
     "picture file, - for standard output. Several views need a name with one %d, as out/%04d.png, in every output. A "
     "film holds all views in one file: .mp4, .webm or .gif (encoded by the program ffmpeg), .y4m (4:4:4, BT.709, "
     "limited range) or .rgba (frames of .raw bytes)"},
    {"format", "FORMAT", take_format, 0, .choices = WORDS("png", "ppm", "raw", "jpg", "webp", "y4m", "rgba"), .help =
     "format of OUT: png, ppm, raw, jpg, webp, y4m or rgba (default: by the ending of OUT; on standard output png for "
     "one view, y4m for several)"},
    {"quality", "Q", INT(quality, 1, 100), .help =
     "quality of a .jpg, 1 to 100 (default 95), or of a .webp (default: lossless). A .png is compressed at level 1, "
     "for speed"},
    {"fps", "RATE", RATE(frame.rate), .help =
     "frames per second of a film, 1 to 1000, also as a fraction: 24000/1001 (default 30; with --times, the rate of "
     "the scene)"},
    {"times", "A..B|all", TIMES(frame.times), .help =
     "render a film of scenes that move: a frame at A seconds, and --fps frames a second until before B; all: from 0 "
     "to their end. One view serves all frames. Several views (--orbit, --path, --view) share them evenly: frame i of "
     "n shows view i / n of the way through them"},
    {"orbit", "N", INT(frame.orbit, 2, FRAMES_MOST), .basic = 1, .help =
     "render N views, 2 to 100000: a turn about the middle of the scene and the axis --up, starting at the camera. "
     "A camera that render chooses is far enough away to see the whole scene from all sides"},
    {"path", "FILE", TEXT(frame.path), .help =
     "render a film along a path through keys: the settings.json of a published page or of SuperSplat, a camera file "
     "for --cameras, or a text NAME.txt with a line \"eye look up fov time\" per key, 11 numbers. Up, fov (50) and "
     "time (seconds from the film's start) may be left out from the end; # starts a comment"},
    {"seconds", "N", REAL(frame.seconds, ABOVE_0, 86400, "seconds above 0, at most 86400"), .help =
     "length of the film of --path. The camera then moves at an even speed by length, turn and zoom, and starts and "
     "ends gently (default: the times of the keys)"},
    {"frames", "N", INT(frame.frames, 2, FRAMES_MOST), .help =
     "instead of --seconds: number of frames of the film of --path, 2 to 100000"},
    {"track", "N|NAME", TEXT(frame.track), .help =
     "track of a settings.json of --path: its number from 0, or its name (default 0)"},
    {"write-cameras", "OUT", OUTPUT(cameras), .help =
     "write the cameras of all views as a cameras.json, for other programs; without -o nothing is drawn"},
    {"shutter", "DEG", REAL(frame.shutter, ABOVE_0, 360, "degrees above 0, at most 360"), .help =
     "motion blur of a film: each frame is the mean of --samples frames in linear light, over DEG / 360 of the time of "
     "a frame (usual: 180)"},
    {"aperture", "UNITS", REAL(frame.aperture, ABOVE_0, INFINITY, "a diameter above 0"), .help =
     "depth of field: each picture is the mean of --samples pictures in linear light, from points of a lens of this "
     "diameter, scene units (a 50th of the depth of --focus is a large lens)"},
    {"focus", "DEPTH|auto", take_focus, 0, .expected = "a depth above 0, or auto", .help =
     "depth that --aperture shows sharply, scene units (default auto: of the Gaussian in the middle of the picture, in "
     "a film of its first frame)"},
    {"samples", "N", INT(frame.samples, 2, SAMPLES_MOST), .help =
     "pictures of a mean, 2 to 1024 (default 32); the time grows with them"},
    {"alpha", 0, take_alpha, 0, .help = "store coverage in alpha, with premultiplied colours (default: alpha is 255)"},
    {"depth", "OUT", OUTPUT(depth), .help =
     "write depths along the camera's axis: .png (16-bit grey, 0: nothing), .pfm or .exr (channel Z; scene units, "
     "infinity: nothing)"},
    {"depth-kind", "KIND", take_depth_kind, FIELD(int, draws), .choices = WORDS("median", "mean"), .help =
     "median (default): the depth at which half of the light is absorbed; mean: the average over all Gaussians, "
     "weighted by contribution"},
    {"depth-range", "UNITS", REAL(depth_range, ABOVE_0, INFINITY, "a depth above 0"), .help =
     "depth that a .png stores as 65535, scene units (default: the largest depth of the picture, which is printed)"},
    {"ids", "OUT", OUTPUT(ids), .help =
     "write the Gaussian that contributes most to each pixel: .png (a colour per Gaussian; with several objects, a hue "
     "per object) or .raw (object id and Gaussian, 4 bytes each, little-endian; 2^32 - 1: nothing)"},
    {"pick", "X,Y", take_pick, 0, .expected = "a pixel X,Y", .help =
     "print object, file, Gaussian, depth and position at a pixel"},
    {"panorama", 0, FLAG(frame.panorama), .help =
     "render the full sphere around the camera, equirectangular, level, twice as wide as high (default camera: the "
     "middle of the scene). Views of a camera file keep their tilt without --up"},
    {"lens", 0, FLAG(frame.lens), .help =
     "render views of a camera file with their lens distortion, to match the photographs pixel by pixel (default: "
     "without distortion). If the file states no picture size, give it with --size. A fisheye is drawn up to 75 "
     "degrees from its axis"},
    {"scissor", "X,Y,W,H", take_scissor, 0, .expected = "X,Y,WIDTH,HEIGHT, pixels", .help =
     "render only this part of the picture, with the same pixels; Gaussians wider than 65536 pixels may differ in the "
     "last bit"},
    {"expect", "HASH|FILE", take_expected, 0, .help =
     "exit 1 unless the picture has this hash (16 hex digits, as --hash prints it) or equals FILE in every pixel, "
     "alpha included"},
    {"diff", "OUT", OUTPUT(diff), .help =
     "if the picture differs from FILE of --expect: write 8 times the absolute difference"},
    {"hash", 0, FLAG(hash), .help = "print the FNV-1a 64 hash of the RGBA bytes"},
    {"stats", "[=pairs]", take_stats, 0, .expected = "--stats or --stats=pairs", .help =
     "print a JSON object: counts, milliseconds per stage, bytes per buffer. With pairs: also the pairs of Gaussian "
     "and pixel, counted in a second frame, in plain C and with unlimited memory"},
    {"json", 0, FLAG(json), .help = "print the result of --pick as a JSON object"},
    {0}
};

/* Options of own_rows that do nothing with others. */
static const option_rule rules[] = {
    {"up auto-up", "cameras", "orbit panorama", "its views have their own up direction; convert --up turns a scene"},
    {"seconds frames track", 0, "path", 0},
    {"seconds", "frames", 0, "give one"},
    {"cameras eye look orbit", "path", 0, "give one"},
    {"fov", "path", 0, "its keys have their own"},
    {"up auto-up", "path", "panorama", "its keys have their own up direction"},
    {"bg sh-degree", 0, "output hash expect stats", "it changes colours only"},
    {"alpha", 0, "output hash expect", "it changes the picture only"},
    {"gaze", 0, "output hash expect depth ids", "it changes pictures only"},
    {"format", 0, "output", 0},
    {"diff", 0, "expect", "a picture"},
    {"depth-kind depth-range", 0, "depth", 0},
    {"json", 0, "pick", 0},
    {"depth ids pick stats", "panorama shutter aperture", 0, "it has colours only"},
    {"shutter", 0, "orbit path times", "a film"},
    {"write-cameras", "shutter", 0, "each of its frames has several cameras"},
    {"write-cameras", "times", 0, "its frames share cameras"},
    {"time", "times", 0, "give one"},
    {"focus", 0, "aperture", 0},
    {"samples", 0, "shutter aperture", 0},
    {"aperture", "panorama stereo ortho", 0, 0},
    {"stats pick", "stereo", 0, "see: fixsplat bench --stereo"},
    {"scissor", "panorama stereo pick", 0, 0},
    {"depth ids pick stats scissor panorama stereo ortho tangents orbit aperture", "lens", 0, 0},
    {0}
};

static int check_picture(render_options *o)
{
    if (o->output && strcmp(o->output, "-")) {
        o->encoding = o->encoding ? o->encoding : fxs_image_format_of(o->output);
        if (!o->encoding)
            return fail(EXIT_USAGE, "%s: expected a name ending in .png, .ppm, .raw, .jpg, .webp, .mp4, .webm, .gif, "
                        ".y4m or .rgba, or -o - | ffmpeg -i - %s for another film", o->output, o->output);
    } else if (o->output) {
        if (o->hash || o->stats || o->has_pick || (o->depth && ends_with(o->depth, ".png") && !(o->depth_range > 0)))
            return fail(EXIT_USAGE, "-o -: the picture goes to standard output, and --%s prints there too",
                        o->hash ? "hash" : o->stats ? "stats" : o->has_pick ? "pick" : "depth without --depth-range");
        if (fxs_is_terminal(stdout))
            return fail(EXIT_USAGE, "-o -: standard output is a terminal");
    }
    if (o->quality && o->encoding != FXS_IMAGE_JPG && o->encoding != FXS_IMAGE_WEBP)
        return fail(EXIT_USAGE, "--quality is for .jpg and .webp");
    const int is_film = o->encoding >= FXS_IMAGE_Y4M && o->encoding != FXS_IMAGE_RGBA;
    if (o->format == FXS_FORMAT_RGBA8_COVERAGE && (is_film || o->encoding == FXS_IMAGE_JPG))
        return fail(EXIT_USAGE, "--alpha: a %s has no alpha; .png, .webp, .raw and .rgba have",
                    o->encoding == FXS_IMAGE_JPG ? ".jpg" : "film");
    if (o->diff && !fxs_image_file_known(o->diff))
        return fail(EXIT_USAGE, "--diff %s: expected a name ending in .png, .ppm, .raw, .jpg or .webp", o->diff);
    return 0;
}

static int check_depths(render_options *o)
{
    const int depths = DRAW_MEAN_DEPTH | DRAW_MEDIAN_DEPTH;
    if (o->depth && !fxs_depth_file_known(o->depth))
        return fail(EXIT_USAGE, "--depth %s: expected a name ending in .png, .pfm or .exr", o->depth);
    if (o->ids && !fxs_id_file_known(o->ids))
        return fail(EXIT_USAGE, "--ids %s: expected a name ending in .png or .raw", o->ids);
    if (o->depth_range > 0 && !ends_with(o->depth, ".png"))
        return fail(EXIT_USAGE, "--depth-range is for a .png: .pfm and .exr have scene units");
    if ((o->draws & depths) == depths)
        return fail(EXIT_USAGE, "--depth-kind: give one kind");
    if (o->depth && !(o->draws & depths))
        o->draws |= DRAW_MEDIAN_DEPTH;
    if (o->ids)
        o->draws |= DRAW_IDS;
    return 0;
}

/* Rejects outputs that the chosen rendering mode cannot produce. */
static int check_drawing(const render_options *o)
{
    const frame_options *f = &o->frame;
    const fxs_backend *backend = fxs_backend_find(f->backend);
    if (o->has_scissor && f->render.cutoff == FXS_CUTOFF_SQUARE)
        return fail(EXIT_USAGE, "--scissor does not go with --cutoff square, which depends on the picture's tiles");
    if (o->draws && backend && !(backend->can & FXS_CAN_TRACE))
        return fail(EXIT_USAGE, "--backend %s has colours only: no --depth, --ids", backend->name);
    return 0;
}

int render_draws(const render_options *o)
{
    return o->output || o->hash || o->stats || o->depth || o->ids || o->has_pick || o->expect || o->has_expected_hash;
}

static int check_outputs(render_options *o)
{
    if (!render_draws(o) && !o->cameras)
        return fail(EXIT_USAGE, "render: where to? Give -o OUT.png, --depth, --ids, --pick, --hash, --expect or "
                    "--stats");
    return check_rules(rules) || check_picture(o) || check_depths(o) || check_drawing(o);
}

static int read_options(render_options *o, int argc, char **argv)
{
    memset(o, 0, sizeof *o);
    frame_options_default(&o->frame);
    o->frame.load.pages = 1;
    o->frame.samples = 32;
    if (take_options(&command_render, o, argc, argv))
        return EXIT_USAGE;
    const char *last = argc - optind > 1 ? argv[argc - 1] : "";
    if (!o->output && fxs_image_format_of(last) && !fxs_scene_format_of(last, 0))
        return fail(EXIT_USAGE, "render: %s is a picture: -o is missing before it", last);
    if (take_scenes(&o->frame.world, "render", argc - optind, argv + optind) || check_outputs(o))
        return EXIT_USAGE;
    return frame_options_check(&o->frame);
}

/* Returns about how many pictures are drawn, with the samples of each. Frames along a path or over times, and views of
   a list, count as many. */
static double pictures_of(const frame_options *f)
{
    const double views = f->path || f->times.given || names_several(f->view) ? AUTO_PIXELS : f->orbit ? f->orbit : 1;
    return f->shutter > 0 || f->aperture > 0 ? views * f->samples : views;
}

static int run(int argc, char **argv)
{
    static render_options o;
    const int status = read_options(&o, argc, argv);
    if (status)
        return status;
    settle_backend(&o.frame, pictures_of(&o.frame));
    return render_views(&o);
}

const command command_render = {
    "render", "scene file -> picture", run,
    "Usage: fixsplat render SCENE... -o OUT [OPTION...]\n\n"
    "Renders scenes to a picture: .png, .ppm, .raw (RGBA bytes, top row first), .jpg or .webp; or to a film: .mp4,\n"
    ".webm, .gif, .y4m or .rgba. fixsplat help formats lists the scene formats. SCENE may be - for standard input.\n",
    0,
    "  $ fixsplat render scene.ply -o scene.png\n"
    "  $ fixsplat render scene.ply --cameras cameras.json --view 8 --size 1280x720 -o view8.png\n"
    "  $ fixsplat render scene.ply --orbit 120 -o film.mp4\n"
    "  $ fixsplat render scene.ply --cameras cameras.json --view all -o out/%04d.png --depth out/%04d.pfm\n"
    "  $ fixsplat render scene.fxs --budget 500000 -o scene.png\n"
    "  $ fixsplat render https://example.org/city.fxs --budget 2000000 --pool 512M -o city.png\n"
    "  $ fixsplat render scene.ply --path settings.json --seconds 10 --fps 24000/1001 -o film.mp4\n"
    "  $ fixsplat render scene.ply --path cameras.json --view 8..40 --seconds 4 -o film.y4m\n"
    "  $ fixsplat render dance.fxs --times all -o dance.mp4\n"
    "  $ fixsplat render dance.splatv --times 0.5..2 --fps 60 --orbit 90 -o out/%04d.png\n"
    "  $ fixsplat render scene.ply --size 640x480 -o got.png --expect golden.png --diff diff.png\n"
    "  $ fixsplat render scene.ply --size 16000x9000 --scissor 8000,0,8000,4500 -o quarter.png\n"
    "  $ gunzip -c scene.ply.gz | fixsplat render - -o scene.png\n"
    "  $ fixsplat render scene.ply --eye 0,-1,-4 --look 0,0,0 --fov 40 --bg ffffff -o white.png --hash\n"
    "  $ fixsplat render room.fxs chair.spz --place chair.spz:1,0,2 --place chair.spz:-1,0,2,0,0,1,0 -o room.png\n"
    "  $ fixsplat render scene.ply --ortho 4 --size 1000x1000 -o plan.png --ids ids.png\n"
    "  $ fixsplat render scene.ply --stereo 0.063 --tangents -1.38,1.19,1.0,-1.2 --size 2064x2208 -o eyes.png\n"
    "  $ fixsplat render scene.ply --stereo 0.063 --size 2064x2208 --gaze 1032,1104,400,800 -o gaze.png\n"
    "  $ fixsplat render scene.ply --panorama --size 4096x2048 -o around.png\n",
    {{own_rows, 0}, {gaze_rows, offsetof(render_options, frame)}, FRAME_TABLES(render_options),
     POOL_TABLE(render_options), COMMON_TABLE}
};
