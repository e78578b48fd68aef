/* fixsplat render */
#include "cmd_render.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <fixsplat/backends.h>
#include "src/image/depth_file.h"

static const char help[] =
    "Usage: fixsplat render SCENE... -o OUT [OPTION...]\n\n"
    "Renders scenes (.fxs, .ply, .splat, .ksplat, .lcc, .spz, .sog, .gltf, .glb, tileset.json; - is standard input)\n"
    "to OUT: .png, .ppm, .raw (RGBA bytes, rows from the top), .jpg, .webp, or a film, .y4m or .rgba.\n\n"
    "  -o, --output OUT    the picture; of several views a name with one %%d, as out/%%04d.png, and so below; - is\n"
    "                      standard output. A film has all views in one file or stream: .y4m (4:4:4, BT.709, limited\n"
    "                      range) or .rgba (the bytes of a .raw, frame after frame)\n"
    "  --format FORMAT     of OUT, whatever its name: png, ppm, raw, jpg, webp, y4m or rgba (default: as its name\n"
    "                      ends; on standard output png for one view, y4m for several)\n"
    "  --quality Q         of .jpg, 1 to 100 (default 95), and of .webp (default: without loss). A .png is compressed\n"
    "                      at level 1, for speed\n"
    "  --fps N             frames a second of a .y4m, 1 to 1000 (default 30)\n"
    "  --orbit N           N views, a turn about the middle of the scene and the axis --up; the camera is the first\n"
    "  --frames N          N views on a smooth way through those of --view, from the first to the last, all of the\n"
    "                      first one's size\n"
    "  --alpha             alpha holds the coverage, colours premultiplied; else alpha is 255\n"
    "  --depth OUT         depths along the camera's axis: .png (16 bits grey, 0 where there is none) or .pfm (scene\n"
    "                      units, infinity where there is none)\n"
    "  --depth-kind KIND   median (default): of the Gaussian at which half of the light is taken; mean: of all that\n"
    "                      contribute, weighted by that\n"
    "  --depth-range UNITS the depth that is 65535 in the .png (default: the largest in the picture, it is printed)\n"
    "  --ids OUT           what contributes most: .png (a colour for each Gaussian; of several objects a hue for\n"
    "                      each) or .raw (object id and Gaussian, 4 bytes each, little-endian; 2^32 - 1: nothing)\n"
    "  --pick X,Y          print what the picture shows at a pixel: object, file, Gaussian, depth, position\n"
    "  --panorama          all around the camera, equirectangular, twice as wide as high; without a camera from the\n"
    "                      middle of the scene; level, but for the views of a file without --up\n"
    "  --scissor X,Y,W,H   only this part of the picture: the same pixels. (Gaussians of more than 65536 pixels may\n"
    "                      differ in the last bit)\n"
    "  --expect HASH|FILE  exit 1 unless the picture has this hash (16 hex digits, as --hash prints it), or is that\n"
    "                      of FILE, pixel by pixel, alpha too\n"
    "  --diff OUT          where the picture is not that of FILE: 8 times the absolute difference\n"
    "  --hash              print the FNV-1a 64 hash of the RGBA bytes\n"
    "  --stats[=pairs]     print a JSON object: counts, milliseconds of each stage, bytes of each buffer; with pairs\n"
    "                      also how many pairs of a Gaussian and a pixel there are, counted in a second frame, by\n"
    "                      plain C, in all the memory that takes\n"
    "  --json              print what --pick finds as a JSON object\n"
    "%s%s\n";

static const char examples[] =
    "Examples:\n"
    "  fixsplat render scene.ply -o scene.png\n"
    "  fixsplat render scene.ply --cameras cameras.json --view 8 --size 1280x720 -o view8.png\n"
    "  fixsplat render scene.ply --cameras cameras.json --view all -o out/%04d.png --depth out/%04d.pfm\n"
    "  fixsplat render scene.ply --orbit 120 -o - | ffmpeg -i - -pix_fmt yuv420p film.mp4\n"
    "  fixsplat render scene.ply --cameras cameras.json --view 8..40 --frames 120 -o film.y4m\n"
    "  fixsplat render scene.ply --size 640x480 -o got.png --expect golden.png --diff diff.png\n"
    "  fixsplat render scene.ply --size 16000x9000 --scissor 8000,0,8000,4500 -o quarter.png\n"
    "  gunzip -c scene.ply.gz | fixsplat render - -o scene.png\n"
    "  fixsplat render scene.ply --eye 0,-1,-4 --look 0,0,0 --fov 40 --bg ffffff -o white.png --hash\n"
    "  fixsplat render room.fxs chair.spz --place chair.spz:1,0,2 --place chair.spz:-1,0,2,0,0,1,0 -o room.png\n"
    "  fixsplat render scene.ply --ortho 4 --size 1000x1000 -o plan.png --ids ids.png\n"
    "  fixsplat render scene.ply --stereo 0.063 --tangents -1.38,1.19,1.0,-1.2 --size 2064x2208 --foveate -o eyes.png\n"
    "  fixsplat render scene.ply --panorama --size 4096x2048 -o around.png\n";

enum { OPT_ALPHA = OPT_OWN, OPT_HASH, OPT_STATS, OPT_JSON, OPT_DEPTH, OPT_DEPTH_KIND, OPT_DEPTH_RANGE, OPT_IDS,
       OPT_PICK, OPT_PANORAMA, OPT_FORMAT, OPT_QUALITY, OPT_FPS, OPT_ORBIT, OPT_FRAMES, OPT_EXPECT, OPT_DIFF,
       OPT_SCISSOR };
enum { FRAMES_MOST = 100000 };              /* of a film */

/* ---- Options ----------------------------------------------------------------------------------------------------- */

static int take_depth_kind(render_options *o, const char *value)
{
    if (strcmp(value, "median") && strcmp(value, "mean"))
        return fail(EXIT_USAGE, "--depth-kind %s: expected median or mean", value);
    o->draws |= strcmp(value, "mean") ? DRAW_MEDIAN_DEPTH : DRAW_MEAN_DEPTH;
    return 0;
}

static int take_pick(render_options *o, const char *value)
{
    o->has_pick = parse_counts(value, 2, 0, FXS_MAX_SIZE - 1, o->pick);
    return o->has_pick ? 0 : fail(EXIT_USAGE, "--pick %s: expected a pixel X,Y", value);
}

static int take_scissor(render_options *o, const char *value)
{
    const int *s = o->scissor;
    o->has_scissor = parse_counts(value, 4, 0, FXS_MAX_SIZE, o->scissor) && s[2] > 0 && s[3] > 0;
    return o->has_scissor ? 0 : fail(EXIT_USAGE, "--scissor %s: expected X,Y,WIDTH,HEIGHT, pixels", value);
}

static int take_stats(render_options *o, const char *value)
{
    o->stats = 1;
    o->pairs = value && !strcmp(value, "pairs");
    return !value || o->pairs ? 0 : fail(EXIT_USAGE, "--stats=%s: expected --stats or --stats=pairs", value);
}

static int take_format(render_options *o, const char *value)
{
    char ending[8];
    snprintf(ending, sizeof ending, ".%s", value);
    o->encoding = strlen(value) < sizeof ending - 1 ? fxs_image_format_of(ending) : FXS_IMAGE_UNKNOWN;
    return o->encoding ? 0 : fail(EXIT_USAGE, "--format %s: expected png, ppm, raw, jpg, webp, y4m or rgba", value);
}

/* Letters of a hash are small, as it is printed. */
static int take_expected(render_options *o, const char *value)
{
    o->has_expected_hash = strlen(value) == 16 && strspn(value, "0123456789abcdef") == 16;
    o->expected_hash = o->has_expected_hash ? strtoull(value, 0, 16) : 0;
    o->expect = o->has_expected_hash ? 0 : value;
    return 0;
}

static int take_option(render_options *o, int which, const char *value)
{
    switch (which) {
    case 'o': return take_output("output", value, &o->output);
    case OPT_ALPHA: o->format = FXS_FORMAT_RGBA8_COVERAGE; break;
    case OPT_HASH: o->hash = 1; break;
    case OPT_STATS: return take_stats(o, value);
    case OPT_JSON: o->json = 1; break;
    case OPT_DEPTH: return take_output("depth", value, &o->depth);
    case OPT_DEPTH_KIND: return take_depth_kind(o, value);
    case OPT_DEPTH_RANGE:
        if (!parse_vector(value, 1, &o->depth_range) || o->depth_range <= 0)
            return fail(EXIT_USAGE, "--depth-range %s: expected a depth above 0", value);
        break;
    case OPT_IDS: o->draws |= DRAW_IDS; return take_output("ids", value, &o->ids);
    case OPT_PICK: return take_pick(o, value);
    case OPT_FORMAT: return take_format(o, value);
    case OPT_QUALITY: return take_int("quality", value, 1, 100, &o->quality);
    case OPT_FPS: return take_int("fps", value, 1, 1000, &o->rate);
    case OPT_ORBIT: return take_int("orbit", value, 2, FRAMES_MOST, &o->frame.orbit);
    case OPT_FRAMES: return take_int("frames", value, 2, FRAMES_MOST, &o->frame.frames);
    case OPT_EXPECT: return take_expected(o, value);
    case OPT_DIFF: return take_output("diff", value, &o->diff);
    case OPT_SCISSOR: return take_scissor(o, value);
    case OPT_PANORAMA: o->frame.panorama = 1; break;
    default: return frame_option(&o->frame, which, value);
    }
    return 0;
}

/* The picture's name and format. */
static int check_picture(render_options *o)
{
    if (o->output && strcmp(o->output, "-")) {
        o->encoding = o->encoding ? o->encoding : fxs_image_format_of(o->output);
        if (!o->encoding)
            return fail(EXIT_USAGE, "%s: expected a name ending in .png, .ppm, .raw, .jpg, .webp, .y4m or .rgba, or "
                        "-o - | ffmpeg -i - %s for a film", o->output, o->output);
    } else if (o->output) {
        if (o->hash || o->stats || o->has_pick || (o->depth && !(o->depth_range > 0)))
            return fail(EXIT_USAGE, "-o -: the picture goes to standard output, and so does what --%s prints",
                        o->hash ? "hash" : o->stats ? "stats" : o->has_pick ? "pick" : "depth without --depth-range");
        if (isatty(STDOUT_FILENO))
            return fail(EXIT_USAGE, "-o -: standard output is a terminal");
    }
    if (o->quality && o->encoding != FXS_IMAGE_JPG && o->encoding != FXS_IMAGE_WEBP)
        return fail(EXIT_USAGE, "--quality is of .jpg and .webp");
    if (o->diff && !o->expect)
        return fail(EXIT_USAGE, "--diff needs --expect with a picture");
    if (o->diff && !fxs_image_file_known(o->diff))
        return fail(EXIT_USAGE, "--diff %s: expected a name ending in .png, .ppm, .raw, .jpg or .webp", o->diff);
    return 0;
}

static int check_depths(render_options *o)
{
    const int depths = DRAW_MEAN_DEPTH | DRAW_MEDIAN_DEPTH;
    if (o->depth && !fxs_depth_file_known(o->depth))
        return fail(EXIT_USAGE, "--depth %s: expected a name ending in .png or .pfm", o->depth);
    if (o->ids && !fxs_id_file_known(o->ids))
        return fail(EXIT_USAGE, "--ids %s: expected a name ending in .png or .raw", o->ids);
    if (!o->depth && (o->draws & depths || o->depth_range > 0))
        return fail(EXIT_USAGE, "%s needs --depth", o->depth_range > 0 ? "--depth-range" : "--depth-kind");
    if ((o->draws & depths) == depths)
        return fail(EXIT_USAGE, "--depth-kind: give one kind");
    if (o->depth && !(o->draws & depths))
        o->draws |= DRAW_MEDIAN_DEPTH;
    return 0;
}

/* What is asked for against how it is drawn. */
static int check_drawing(const render_options *o)
{
    const frame_options *f = &o->frame;
    const fxs_backend *backend = fxs_backend_find(f->backend);
    if (f->panorama && (o->draws || o->has_pick || o->stats))
        return fail(EXIT_USAGE, "--panorama is a picture of colours: no --depth, --ids, --pick, --stats");
    if (f->stereo > 0 && (o->stats || o->has_pick))
        return fail(EXIT_USAGE, "%s is of one picture, not of --stereo%s", o->stats ? "--stats" : "--pick",
                    o->stats ? "; see: fixsplat bench --stereo" : "");
    if (f->foveate.on && (o->draws || o->stats))
        return fail(EXIT_USAGE, "--foveate is of colours: no --depth, --ids, --stats; see: fixsplat bench --foveate");
    if (o->has_scissor && (f->panorama || f->stereo > 0 || f->foveate.on || o->has_pick))
        return fail(EXIT_USAGE, "--scissor is of one picture: no --panorama, --stereo, --foveate, --pick");
    if (o->has_scissor && f->render.cutoff == FXS_CUTOFF_SQUARE)
        return fail(EXIT_USAGE, "--scissor: a part has other tiles than the whole, on which --cutoff square depends");
    if (o->json && !o->has_pick)
        return fail(EXIT_USAGE, "--json is for --pick");
    if (o->draws && backend && !(backend->can & FXS_CAN_TRACE))
        return fail(EXIT_USAGE, "--backend %s has colours only: no --depth, --ids", backend->name);
    return 0;
}

static int check_outputs(render_options *o)
{
    if (!o->output && !o->hash && !o->stats && !o->depth && !o->ids && !o->has_pick && !o->expect &&
        !o->has_expected_hash)
        return fail(EXIT_USAGE, "render: where to? Give -o OUT.png, --depth, --ids, --pick, --hash, --expect or "
                    "--stats");
    return check_picture(o) || check_depths(o) || check_drawing(o);
}

static void print_help(void)
{
    printf(help, camera_options_help, frame_options_help);
    fputs(examples, stdout);
}

static int take_options(render_options *o, int argc, char **argv)
{
    static const struct option table[] = {FRAME_OPTIONS, {"output", required_argument, 0, 'o'},
                                          {"alpha", no_argument, 0, OPT_ALPHA}, {"hash", no_argument, 0, OPT_HASH},
                                          {"stats", optional_argument, 0, OPT_STATS},
                                          {"json", no_argument, 0, OPT_JSON},
                                          {"depth", required_argument, 0, OPT_DEPTH},
                                          {"depth-kind", required_argument, 0, OPT_DEPTH_KIND},
                                          {"depth-range", required_argument, 0, OPT_DEPTH_RANGE},
                                          {"ids", required_argument, 0, OPT_IDS},
                                          {"pick", required_argument, 0, OPT_PICK},
                                          {"panorama", no_argument, 0, OPT_PANORAMA},
                                          {"format", required_argument, 0, OPT_FORMAT},
                                          {"quality", required_argument, 0, OPT_QUALITY},
                                          {"fps", required_argument, 0, OPT_FPS},
                                          {"orbit", required_argument, 0, OPT_ORBIT},
                                          {"frames", required_argument, 0, OPT_FRAMES},
                                          {"expect", required_argument, 0, OPT_EXPECT},
                                          {"diff", required_argument, 0, OPT_DIFF},
                                          {"scissor", required_argument, 0, OPT_SCISSOR}, COMMON_OPTIONS};
    memset(o, 0, sizeof *o);
    frame_options_default(&o->frame);
    for (int c; (c = next_option(argc, argv, "o:" COMMON_LETTERS, table, 0, print_help)) != -1;)
        if (c == '?' || take_option(o, c, optarg))
            return EXIT_USAGE;
    if (take_scenes(&o->frame.world, "render", argc - optind, argv + optind) || check_outputs(o))
        return EXIT_USAGE;
    return frame_options_check(&o->frame);
}

int command_render(int argc, char **argv)
{
    static render_options o;
    const int status = take_options(&o, argc, argv);
    return status ? status : render_views(&o);
}
