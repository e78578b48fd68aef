/* fixsplat convert */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/fxs_file.h>
#include <fixsplat/formats.h>
#include <fixsplat/scene_write.h>
#include "src/scene/edit/merge.h"
#include "cmd_convert.h"
#include "file_guard.h"
#include "quality.h"

static const char help[] =
    "Usage: fixsplat convert IN... OUT [OPTION...]\n\n"
    "Writes a scene file, or several as they are placed, as another, by the ending of OUT:\n\n"
    "  .fxs             packed: opens at once and is rendered from the file as it lies\n"
    "  .ply             Inria's, floats\n"
    "  .compressed.ply  PlayCanvas's: 16 bytes a Gaussian, and one for each SH coefficient\n"
    "  .splat           32 bytes a Gaussian: no SH above degree 0\n"
    "  .spz             compressed: positions in 24 bits over the scene, the rest in 8 to 10\n"
    "  .sog             PlayCanvas's, version 2: positions in 16 bits, the rest in 8, SH by a palette\n"
    "  .glb             glTF with KHR_gaussian_splatting, floats, y up\n"
    "  .csv             text, a line a Gaussian, columns as in a .ply\n\n"
    "What .fxs leaves out because it cannot be drawn, the others leave out too. Of an .fxs file the Gaussians that its\n"
    "codes stand for are written.\n"
    "Several files become one with the highest SH degree of any: coefficients that a file lacks are 0. All must be\n"
    "anti-aliased, or none. A file that is there is replaced when OUT is complete; one of IN only with --force.\n\n"
    "The whole is turned, scaled and moved in this order, whatever that of the options, with its SH, in the axes of a\n"
    ".ply (x right, y down, z to the front):\n\n"
    "  --up X,Y,Z          turn this direction to up, which is 0,-1,0, by the shortest way\n"
    "  --rotate X,Y,Z      turn by so many degrees about the x axis, then the y axis, then the z axis; the axes stay\n"
    "                      where they are\n"
    "  --scale S           times as large, about the origin\n"
    "  --translate X,Y,Z   move\n\n"
    "Then Gaussians are left out, by where they are now:\n\n"
    "  --crop MINX,MINY,MINZ,MAXX,MAXY,MAXZ\n"
    "                      keep those with their centre in this box, edges included\n"
    "  --sphere X,Y,Z,R    keep those with their centre at most R from X,Y,Z\n"
    "  --prune ALPHA       keep those of this opacity or more, 0 to 1\n"
    "  --drop-floaters     of what these leave, drop those with fewer than 8 others in the 27 cells around them; a\n"
    "                      cell is as wide as 4 of a Gaussian's largest sigma (of the median Gaussian's, where that is\n"
    "                      more), rounded up to a power of two\n"
    "  --sh-degree D       keep SH up to this degree, 0 to 3\n\n"
    "Last:\n\n"
    "  --decimate N        merge neighbours until N Gaussians are left, or N%: position, covariance, colour and SH of\n"
    "                      two become those of both together, weighted by opacity and area\n\n";

/* C99 promises strings of 4095 bytes. */
static const char more_help[] =
    "  --profile P         of .fxs, bytes a Gaussian at SH degree 3, and loss against floats on a captured scene:\n"
    "                      default 63.5 (56.9 dB), compact 39.6 (53.9 dB), small 19.6 (44.4 dB). Where SH lose much,\n"
    "                      views are compared with default, and one that loses more than it should is said\n"
    "  --spz-version V     3 (gzip) or 4 (zstd, the default), for .spz\n"
    "  --force             OUT may be one of IN, but for an .fxs: that is replaced, when OUT is complete. What only\n"
    "                      belongs to one of IN, as a content of a tileset, is never replaced\n"
    "  --lod LEVEL         level of detail of an .lcc or streamed .sog, 0 the finest (default 0)\n"
    WORLD_HELP
    IMPORT_HELP
    "  --help              this text\n\n"
    "Examples:\n"
    "  fixsplat convert scene.ply scene.fxs\n"
    "  fixsplat render scene.fxs -o scene.png\n"
    "  fixsplat convert scene.ply phone.fxs --profile compact\n"
    "  fixsplat convert scene.ply small.spz --prune 0.02 --sh-degree 1\n"
    "  fixsplat convert scene.spz table.ply --crop -1,-1,-1,1,0.5,1\n"
    "  fixsplat convert scan.ply level.sog --up 0,0,1 --scale 0.01 --sphere 0,0,0,2 --drop-floaters\n"
    "  fixsplat convert scene.ply far.glb --decimate 10%\n"
    "  fixsplat convert room.ply chair.spz both.fxs --place chair.spz:1,0,2\n"
    "  fixsplat convert --scene world.json all.fxs\n";

typedef struct convert_options {
    const char *in, *out;                   /* in: what is placed, by the name of the one file or of its list */
    world_options world;
    fxs_world placed;
    fxs_placement whole;                    /* how all of it is placed; its rotation follows from these: */
    double degrees[3], up[3];               /* up all 0: as it is */
    fxs_scene_filter filter;
    int filtered;                           /* an option asks for the filter */
    load_options load;
    int profile_given, spz_version;         /* spz_version 0: none given */
} convert_options;

enum { OPT_CROP = OPT_OWN, OPT_SPHERE, OPT_PRUNE, OPT_DROP_FLOATERS, OPT_DECIMATE, OPT_TRANSLATE, OPT_ROTATE, OPT_SCALE,
       OPT_SPZ_VERSION, OPT_FORCE };

/* ---- Options --------------------------------------------------------------------------------------------------- */

static int take_crop(fxs_scene_filter *filter, const char *value)
{
    double box[6];
    if (!parse_vector(value, 6, box) || box[0] > box[3] || box[1] > box[4] || box[2] > box[5])
        return fail(EXIT_USAGE, "--crop %s: expected six numbers MINX,MINY,MINZ,MAXX,MAXY,MAXZ", value);
    memcpy(filter->low, box, sizeof filter->low);
    memcpy(filter->high, box + 3, sizeof filter->high);
    return 0;
}

static int take_sphere(fxs_scene_filter *filter, const char *value)
{
    double sphere[4];
    if (!parse_vector(value, 4, sphere) || sphere[3] < 0)
        return fail(EXIT_USAGE, "--sphere %s: expected four numbers X,Y,Z,R, R 0 or more", value);
    memcpy(filter->middle, sphere, sizeof filter->middle);
    filter->radius = sphere[3];
    return 0;
}

/* N or N% */
static int take_decimate(convert_options *o, const char *value)
{
    const size_t length = strlen(value);
    char number[64];
    uint64_t count;
    o->filter.drawable = o->filtered = 1;
    o->load.decimate_share = 0;
    o->load.decimate_count = 0;
    if (parse_count(value, 1, UINT64_MAX, &count)) {
        o->load.decimate_count = count;
        return 0;
    }
    if (length > 1 && length < sizeof number && value[length - 1] == '%') {
        memcpy(number, value, length - 1);
        number[length - 1] = 0;
        if (parse_vector(number, 1, &o->load.decimate_share) && o->load.decimate_share > 0 &&
            o->load.decimate_share <= 100) {
            o->load.decimate_share /= 100;
            return 0;
        }
    }
    return fail(EXIT_USAGE, "--decimate %s: expected a number of Gaussians from 1 on, or a share above 0%% up to 100%%",
                value);
}

/* How the whole is placed. */
static int take_place(convert_options *o, int which, const char *value)
{
    const double *up = o->up;
    if (which == OPT_SCALE)
        return parse_vector(value, 1, &o->whole.scale) && o->whole.scale > 0
                   ? 0 : fail(EXIT_USAGE, "--scale %s: expected a number above 0", value);
    if (which == OPT_UP)
        return parse_vector(value, 3, o->up) && (up[0] != 0 || up[1] != 0 || up[2] != 0)
                   ? 0 : fail(EXIT_USAGE, "--up %s: expected a direction X,Y,Z, not 0,0,0", value);
    if (which == OPT_ROTATE)
        return parse_vector(value, 3, o->degrees)
                   ? 0 : fail(EXIT_USAGE, "--rotate %s: expected degrees about three axes X,Y,Z", value);
    return parse_vector(value, 3, o->whole.translation)
               ? 0 : fail(EXIT_USAGE, "--translate %s: expected three numbers X,Y,Z", value);
}

static int take_option(convert_options *o, int which, const char *value)
{
    o->filtered |= which == OPT_CROP || which == OPT_SPHERE || which == OPT_PRUNE || which == OPT_DROP_FLOATERS ||
                   which == OPT_SH_DEGREE;
    switch (which) {
    case OPT_UP:
    case OPT_ROTATE:
    case OPT_SCALE:
    case OPT_TRANSLATE: return take_place(o, which, value);
    case OPT_SPHERE: return take_sphere(&o->filter, value);
    case OPT_DROP_FLOATERS: o->filter.floaters = 1; return 0;
    case OPT_DECIMATE: return take_decimate(o, value);
    case OPT_LOD: return take_int("lod", value, 0, 1000, &o->load.lod);
    case OPT_AXES:
    case OPT_MAX_GAUSSIANS:
    case OPT_IMPORT_MEMORY: return take_import_option(&o->load, which, value);
    case OPT_SCENE:
    case OPT_PLACE: return take_world_option(&o->world, which, value);
    case OPT_PROFILE: o->profile_given = 1; return take_profile(&o->load, value);
    case OPT_CROP: return take_crop(&o->filter, value);
    case OPT_PRUNE:
        if (!parse_vector(value, 1, &o->filter.opacity) || o->filter.opacity < 0 || o->filter.opacity > 1)
            return fail(EXIT_USAGE, "--prune %s: expected an opacity, 0 to 1", value);
        return 0;
    case OPT_SH_DEGREE: return take_int("sh-degree", value, 0, 3, &o->filter.sh_degree);
    case OPT_FORCE: files_force(FILES_FORCED); return 0;
    case OPT_SPZ_VERSION: return take_int("spz-version", value, 3, 4, &o->spz_version);
    default: return EXIT_USAGE;
    }
}

static void print_help(void)
{
    fputs(help, stdout);
    fputs(more_help, stdout);
}

static int take_options(convert_options *o, int argc, char **argv)
{
    static const struct option table[] = {{"up", required_argument, 0, OPT_UP},
                                          {"rotate", required_argument, 0, OPT_ROTATE},
                                          {"scale", required_argument, 0, OPT_SCALE},
                                          {"translate", required_argument, 0, OPT_TRANSLATE},
                                          {"crop", required_argument, 0, OPT_CROP},
                                          {"sphere", required_argument, 0, OPT_SPHERE},
                                          {"drop-floaters", no_argument, 0, OPT_DROP_FLOATERS},
                                          {"decimate", required_argument, 0, OPT_DECIMATE},
                                          {"prune", required_argument, 0, OPT_PRUNE},
                                          {"sh-degree", required_argument, 0, OPT_SH_DEGREE},
                                          {"spz-version", required_argument, 0, OPT_SPZ_VERSION},
                                          {"force", no_argument, 0, OPT_FORCE},
                                          {"lod", required_argument, 0, OPT_LOD}, IMPORT_OPTIONS,
                                          WORLD_OPTIONS, {"profile", required_argument, 0, OPT_PROFILE},
                                          COMMON_OPTIONS};
    memset(o, 0, sizeof *o);
    files_force(FILES_REFUSE_UNFORCED);
    fxs_scene_filter_default(&o->filter);
    fxs_placement_init(&o->whole, 0, 0);
    for (int c; (c = next_option(argc, argv, COMMON_LETTERS, table, 0, print_help)) != -1;)
        if (c == '?' || take_option(o, c, optarg))
            return EXIT_USAGE;
    if (optind > argc - (o->world.file ? 1 : 2))
        return fail(EXIT_USAGE, "convert takes two files or more, IN and OUT; see: fixsplat convert --help");
    if (take_scenes(&o->world, "convert", argc - 1 - optind, argv + optind))
        return EXIT_USAGE;
    o->in = o->world.file ? o->world.file : argv[optind];
    o->out = argv[argc - 1];
    if (o->profile_given && !ends_with(o->out, ".fxs"))
        return fail(EXIT_USAGE, "--profile is for .fxs");
    if (o->spz_version && !ends_with(o->out, ".spz"))
        return fail(EXIT_USAGE, "--spz-version: %s is no .spz", o->out);
    return 0;
}

/* ---- .fxs ------------------------------------------------------------------------------------------------------ */

/* SH that are rounded by this much, root mean square, may cost a view what the profile promises: pictures are compared
   then. */
static double loss_to_check(enum fxs_profile profile)
{
    return profile == FXS_PROFILE_DEFAULT ? INFINITY : profile == FXS_PROFILE_COMPACT ? 0.01 : 0.02;
}

/* Says so where a view of a packed scene is farther from the same scene in the profile default than its profile
   promises, from around the scene, small; or why that is not known. */
static void check_views(const world *packed, const convert_options *o, const load_options *load)
{
    enum { WIDTH = 480, HEIGHT = 320, AROUND = 6 };
    const int small = packed->scenes[0].opened->scene->profile == FXS_PROFILE_SMALL;
    const double promised = small ? 36 : 46;
    world original;
    load_options plain = *load;
    frame_options options;
    quality q;
    plain.profile = FXS_PROFILE_DEFAULT;
    plain.again = 1;
    frame_options_default(&options);
    options.width = WIDTH;
    options.height = HEIGHT;
    int status = world_open_merged(&original, &o->placed, o->in, &plain);
    if (!status) {
        status = quality_measure(&q, packed, &original, &options, AROUND);
        world_close(&original);
    }
    if (status)
        note("%s: not compared with the profile default", o->out);
    else if (q.worst_psnr < promised)
        note("%s: profile %s loses more of this scene than of most: a view %s is %.1f dB from the profile default, where "
             "%.0f is usual; %s", o->out, profile_name(packed->scenes[0].opened->scene->profile), q.views[q.worst_view].name,
             q.worst_psnr, promised, small ? "profile compact loses less" : "profile default loses less");
    if (!status)
        quality_free(&q);
}

static int to_fxs(const convert_options *o)
{
    world w;
    fxs_message message;
    load_options load = o->load;
    load.filter = o->filtered ? &o->filter : 0;
    if (world_open_merged(&w, &o->placed, o->in, &load))
        return EXIT_FAILED;
    const loaded_scene *loaded = &w.scenes[0];
    int status = files_check();
    if (!status && fxs_file_write(o->out, loaded->opened->data, loaded->opened->bytes, &message))
        status = fail(EXIT_FAILED, "%s", message.text);
    if (!status && loaded->opened->report->rms.sh > loss_to_check(loaded->opened->scene->profile))
        check_views(&w, o, &load);
    world_close(&w);
    return status;
}

/* ---- The others, Gaussian by Gaussian -------------------------------------------------------------------------- */

enum { BATCH = 256 };

/* Reads the file once for the bounds of its centres, and goes back to its beginning. */
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

static int copy(fxs_scene_writer *w, const char *out, fxs_scene_file *file, uint64_t count, const load_options *load,
                fxs_message *message)
{
    fxs_gaussian batch[BATCH];
    char label[] = "converting";
    void *argument;
    fxs_progress_fn *progress = progress_of(load, label, &argument);
    uint64_t done = 0;
    int result = 0;
    for (long n; !result && (n = fxs_scene_file_read(file, batch, BATCH, message)) != 0;) {
        result = n < 0 ? -1 : fxs_scene_writer_put(w, batch, (size_t)n, message);
        done += n < 0 ? 0 : (uint64_t)n;
        if (progress(argument, (double)done / (double)count) && !result)
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

/* What the format of OUT cannot say. */
static void note_losses(const char *out, const fxs_scene_write_report *report)
{
    const fxs_spz_clamped *clamped = &report->clamped;
    if (report->lost_sh || report->lost_antialiased)
        note("%s: a %s cannot hold%s%s%s", out, strrchr(out, '.'), report->lost_sh ? " the SH above degree 0" : "",
             report->lost_sh && report->lost_antialiased ? " and" : "",
             report->lost_antialiased ? " that the scene is anti-aliased" : "");
    if (clamped->position)
        note("%s: brought in %" PRIu32 " Gaussians from beyond %g units: an .spz has 24 bits for a position", out,
             clamped->position, clamped->reach);
    note_clamped(out, clamped->dc, "dc beyond +-3.33");
    note_clamped(out, clamped->sh, "SH beyond +-1");
    note_clamped(out, clamped->scale, "ln(sigma) outside -10 to 5.94");
}

static int write_file(const char *out, int spz_version, const load_options *load, fxs_scene_file *file,
                      const fxs_scene_file_info *info)
{
    fxs_scene_writer *w = NULL;
    fxs_scene_write_report report;
    fxs_message message, closing;
    fxs_scene_write_options options = {.count = info->count, .sh_degree = info->sh_degree,
                                       .antialiased = info->antialiased, .spz_version = spz_version};
    char label[] = "compressing";
    void *argument;
    fxs_progress_fn *progress = progress_of(load, label, &argument);
    int result = ends_with(out, ".glb") ? find_bounds(file, &options, &message) : 0;
    if (!result)
        result = fxs_scene_writer_open(out, &options, &w, &message);
    if (!result)
        result = copy(w, out, file, info->count, load, &message);
    if (fxs_scene_writer_close(w, &report, progress, argument, &closing) && !result) {
        message = closing;
        result = -1;
    }
    progress_end();
    if (result)
        return fail(EXIT_FAILED, "%s", message.text);
    note_losses(out, &report);
    return EXIT_OK;
}

int convert_merged(const char *out, int spz_version, const fxs_world *placed, const char *name, const load_options *how)
{
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_scene_filter filter = *how->filter;
    load_options load = *how;
    filter.drawable = 1;
    load.filter = &filter;
    if (open_merged(placed, name, &load, &file, &info))
        return EXIT_FAILED;
    int status = files_check();
    if (!status)
        status = write_file(out, spz_version, &load, file, &info);
    fxs_scene_file_close(file);
    return status;
}

/* ---- The command ----------------------------------------------------------------------------------------------- */

/* q = r q, with r the turn about an axis (0, 1, 2) by some degrees */
static void turn_about(double q[4], int axis, double degrees)
{
    const double half = fmod(degrees, 360) * (3.14159265358979324 / 360), c = cos(half), s = sin(half);
    const int j = (axis + 1) % 3 + 1, k = (axis + 2) % 3 + 1;
    const double old[4] = {q[0], q[1], q[2], q[3]};
    q[0] = c * old[0] - s * old[axis + 1];
    q[axis + 1] = c * old[axis + 1] + s * old[0];
    q[j] = c * old[j] - s * old[k];
    q[k] = c * old[k] + s * old[j];
}

/* The shortest turn from u to v = (0, -1, 0): (1 + u v, u x v); from (0, 1, 0), half a turn about x. */
static void turn_up(double q[4], const double up[3])
{
    const double most = fmax(fmax(fabs(up[0]), fabs(up[1])), fabs(up[2]));
    const double x = up[0] / most, y = up[1] / most, z = up[2] / most, length = sqrt(x * x + y * y + z * z);
    const double turn[4] = {1 - y / length, z / length, 0, -x / length};
    const double opposite[4] = {0, 1, 0, 0};
    memcpy(q, turn[0] > 1e-12 ? turn : opposite, 4 * sizeof *q);
}

/* Places the whole. Returns 0, or prints why not and returns the exit status. */
static int place_whole(convert_options *o)
{
    fxs_message message;
    fxs_object checked;
    if (o->up[0] != 0 || o->up[1] != 0 || o->up[2] != 0)
        turn_up(o->whole.rotation, o->up);
    for (int axis = 0; axis < 3; axis++)
        if (o->degrees[axis] != 0)
            turn_about(o->whole.rotation, axis, o->degrees[axis]);
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

static int check_files(const convert_options *o)
{
    const fxs_world *placed = &o->placed;
    for (uint32_t i = 0; i < placed->file_count; i++)
        files_read(placed->files[i]);
    files_write(o->out);
    if (ends_with(o->out, ".fxs"))
        files_force(FILES_REFUSE);          /* check_views reads IN again */
    return files_check();
}

int command_convert(int argc, char **argv)
{
    static convert_options o;
    int status = take_options(&o, argc, argv);
    if (status)
        return status;
    const int packed = ends_with(o.out, ".fxs");
    char endings[256];
    fxs_scene_format_endings(endings, sizeof endings, 1);
    if (!fxs_scene_format_of(o.out, 1))
        return fail(EXIT_USAGE, "%s: expected a name ending in one of %s", o.out, endings);
    status = place_scenes(&o.placed, &o.world);
    if (status)
        return status;
    status = place_whole(&o);
    if (!status)
        status = check_files(&o);
    o.load.filter = &o.filter;
    if (!status)
        status = packed ? to_fxs(&o) : convert_merged(o.out, o.spz_version, &o.placed, o.in, &o.load);
    fxs_world_free(&o.placed);
    return status;
}
