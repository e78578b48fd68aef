/* fixsplat convert */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../port/scene/fxs_file.h"
#include "../port/scene/ply_write.h"
#include "../port/scene/splat_write.h"
#include "../port/scene/spz_write.h"
#include "quality.h"

static const char help[] =
    "Usage: fixsplat convert IN... OUT [OPTION...]\n\n"
    "Writes a scene file, or several as they are placed, as another, by the ending of OUT:\n\n"
    "  .fxs    packed: opens at once and is rendered from the file as it lies\n"
    "  .ply    Inria's, floats\n"
    "  .splat  32 bytes a Gaussian: no SH above degree 0\n"
    "  .spz    compressed: positions in 24 bits over the scene, the rest in 8 to 10\n\n"
    "What .fxs leaves out because it cannot be drawn, the others leave out too. An .fxs file is not converted back.\n\n"
    "  --crop MINX,MINY,MINZ,MAXX,MAXY,MAXZ\n"
    "                      keep the Gaussians with their centre in this box, edges included\n"
    "  --prune ALPHA       keep those of this opacity or more, 0 to 1\n"
    "  --sh-degree D       keep SH up to this degree, 0 to 3\n"
    "  --profile P         of .fxs, bytes a Gaussian at SH degree 3, and loss against floats on a captured scene:\n"
    "                      default 63.5 (56.9 dB), compact 39.6 (53.9 dB), small 19.6 (44.4 dB). Where SH lose much,\n"
    "                      views are compared with default, and one that loses more than it should is said\n"
    "  --spz-version V     3 (gzip) or 4 (zstd, the default), for .spz\n"
    "  --lod LEVEL         level of detail of a streamed .sog, 0 the finest (default 0)\n"
    WORLD_HELP
    IMPORT_HELP
    "  --help              this text\n\n"
    "Examples:\n"
    "  fixsplat convert scene.ply scene.fxs\n"
    "  fixsplat render scene.fxs -o scene.png\n"
    "  fixsplat convert scene.ply phone.fxs --profile compact\n"
    "  fixsplat convert scene.ply small.spz --prune 0.02 --sh-degree 1\n"
    "  fixsplat convert scene.spz table.ply --crop -1,-1,-1,1,0.5,1\n"
    "  fixsplat convert room.ply chair.spz both.fxs --place chair.spz:1,0,2\n"
    "  fixsplat convert --scene world.json all.fxs\n";

typedef struct convert_options {
    const char *in, *out;                   /* in: what is placed, by the name of the one file or of its list */
    world_options world;
    fxs_world placed;
    fxs_scene_filter filter;
    int filtered;                           /* an option asks for the filter */
    load_options load;
    int profile_given, spz_version;         /* spz_version 0: none given */
} convert_options;

enum { OPT_CROP = OPT_OWN, OPT_PRUNE, OPT_SPZ_VERSION };

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

static int take_option(convert_options *o, int which, const char *value)
{
    uint64_t number;
    o->filtered |= which == OPT_CROP || which == OPT_PRUNE || which == OPT_SH_DEGREE;
    switch (which) {
    case OPT_LOD: return take_lod(&o->load, value);
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
    case OPT_SH_DEGREE:
        if (!parse_count(value, 0, 3, &number))
            return fail(EXIT_USAGE, "--sh-degree %s: expected 0 to 3", value);
        o->filter.sh_degree = (int)number;
        return 0;
    case OPT_SPZ_VERSION:
        if (!parse_count(value, 3, 4, &number))
            return fail(EXIT_USAGE, "--spz-version %s: expected 3 or 4", value);
        o->spz_version = (int)number;
        return 0;
    default: return EXIT_USAGE;
    }
}

static int take_options(convert_options *o, int argc, char **argv)
{
    static const struct option table[] = {{"crop", required_argument, 0, OPT_CROP},
                                          {"prune", required_argument, 0, OPT_PRUNE},
                                          {"sh-degree", required_argument, 0, OPT_SH_DEGREE},
                                          {"spz-version", required_argument, 0, OPT_SPZ_VERSION},
                                          {"lod", required_argument, 0, OPT_LOD}, IMPORT_OPTIONS,
                                          WORLD_OPTIONS, {"profile", required_argument, 0, OPT_PROFILE},
                                          {"help", no_argument, 0, OPT_HELP}, {0, 0, 0, 0}};
    memset(o, 0, sizeof *o);
    fxs_scene_filter_default(&o->filter);
    opterr = 0;
    for (int c; (c = getopt_long(argc, argv, "", table, 0)) != -1;) {
        if (c == OPT_HELP) {
            fputs(help, stdout);
            exit(EXIT_OK);
        }
        if (c == '?')
            return wrong_option(argv);
        if (take_option(o, c, optarg))
            return EXIT_USAGE;
    }
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
    const int small = packed->scenes[0].scene.profile == FXS_PROFILE_SMALL;
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
        fprintf(stderr, "fixsplat: %s: not compared with the profile default\n", o->out);
    else if (q.worst_psnr < promised)
        fprintf(stderr, "fixsplat: %s: profile %s loses more of this scene than of most: a view %s is %.1f dB from the "
                "profile default, where %.0f is usual; %s\n", o->out, profile_name(packed->scenes[0].scene.profile),
                q.views[q.worst_view].name, q.worst_psnr, promised,
                small ? "profile compact loses less" : "profile default loses less");
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
    int result = fxs_file_write(o->out, loaded->packed.data, loaded->packed.bytes, &message);
    if (!result && loaded->report.rms.sh > loss_to_check(loaded->scene.profile))
        check_views(&w, o, &load);
    world_close(&w);
    return result ? fail(EXIT_FAILED, "%s", message.text) : EXIT_OK;
}

/* ---- The others, Gaussian by Gaussian -------------------------------------------------------------------------- */

/* One of them is open. */
typedef struct writer {
    fxs_ply_writer *ply;
    fxs_splat_writer *splat;
    fxs_spz_writer *spz;
} writer;

static int open_writer(writer *w, const convert_options *o, const fxs_scene_file_info *info, fxs_message *message)
{
    memset(w, 0, sizeof *w);
    if (ends_with(o->out, ".ply"))
        return fxs_ply_writer_open(o->out, info->count, info->sh_degree, info->antialiased, &w->ply, message);
    if (ends_with(o->out, ".splat"))
        return fxs_splat_writer_open(o->out, info->count, &w->splat, message);
    return fxs_spz_writer_open(o->out, o->spz_version ? o->spz_version : 4, info->count, info->sh_degree,
                               info->antialiased, &w->spz, message);
}

static int put(const writer *w, const fxs_gaussian *gaussians, size_t n, fxs_message *message)
{
    return w->ply     ? fxs_ply_writer_put(w->ply, gaussians, n, message)
           : w->splat ? fxs_splat_writer_put(w->splat, gaussians, n, message)
                      : fxs_spz_writer_put(w->spz, gaussians, n, message);
}

static int close_writer(writer *w, fxs_message *message)
{
    char label[] = "compressing";
    int result = w->ply     ? fxs_ply_writer_close(w->ply, message)
                 : w->splat ? fxs_splat_writer_close(w->splat, message)
                            : fxs_spz_writer_close(w->spz, progress_bar, label, message);
    progress_end();
    return result;
}

static int copy(const writer *w, fxs_scene_file *file, uint64_t count, fxs_message *message)
{
    enum { BATCH = 256 };
    fxs_gaussian batch[BATCH];
    char label[] = "converting";
    uint64_t done = 0;
    int result = 0;
    for (long n; !result && (n = fxs_scene_file_read(file, batch, BATCH, message)) != 0;) {
        result = n < 0 ? -1 : put(w, batch, (size_t)n, message);
        done += n < 0 ? 0 : (uint64_t)n;
        progress_bar(label, (double)done / (double)count);
    }
    progress_end();
    return result;
}

static void note_clamped(const char *out, uint32_t count, const char *what)
{
    if (count)
        fprintf(stderr, "fixsplat: %s: clamped %s, of %" PRIu32 " Gaussians\n", out, what, count);
}

/* What the format of OUT cannot say. */
static void note_losses(const char *out, const fxs_scene_file_info *info, const fxs_spz_clamped *clamped)
{
    if (ends_with(out, ".splat") && (info->sh_degree || info->antialiased))
        fprintf(stderr, "fixsplat: %s: a .splat cannot hold%s%s%s\n", out,
                info->sh_degree ? " the SH above degree 0" : "", info->sh_degree && info->antialiased ? " and" : "",
                info->antialiased ? " that the scene is anti-aliased" : "");
    if (clamped->position)
        fprintf(stderr, "fixsplat: %s: brought in %" PRIu32 " Gaussians from beyond %g units: an .spz has 24 bits "
                "for a position\n", out, clamped->position, clamped->reach);
    note_clamped(out, clamped->dc, "dc beyond +-3.33");
    note_clamped(out, clamped->sh, "SH beyond +-1");
    note_clamped(out, clamped->scale, "ln(sigma) outside -10 to 5.94");
}

static int stream(const convert_options *o)
{
    writer w;
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_message message, closing;
    fxs_scene_filter filter = o->filter;
    load_options load = o->load;
    filter.drawable = 1;
    load.filter = &filter;
    if (open_merged(&o->placed, o->in, &load, &file, &info))
        return EXIT_FAILED;
    int result = open_writer(&w, o, &info, &message);
    if (!result) {
        result = copy(&w, file, info.count, &message);
        const fxs_spz_clamped clamped = w.spz ? fxs_spz_writer_finish(w.spz) : (fxs_spz_clamped){0};
        if (close_writer(&w, &closing) && !result) {
            message = closing;
            result = -1;
        }
        if (!result)
            note_losses(o->out, &info, &clamped);
    }
    fxs_scene_file_close(file);
    return result ? fail(EXIT_FAILED, "%s", message.text) : EXIT_OK;
}

/* No file of a world may be packed. */
static int check_inputs(const fxs_world *placed)
{
    for (uint32_t i = 0; i < placed->file_count; i++)
        if (is_packed(placed->files[i]))
            return fail(EXIT_FAILED, "%s: an .fxs file is not converted; convert the scene that it was made from",
                        placed->files[i]);
    return 0;
}

int command_convert(int argc, char **argv)
{
    static convert_options o;
    int status = take_options(&o, argc, argv);
    if (status)
        return status;
    int packed = ends_with(o.out, ".fxs");
    if (!packed && !ends_with(o.out, ".ply") && !ends_with(o.out, ".splat") && !ends_with(o.out, ".spz"))
        return fail(EXIT_USAGE, "%s: expected a name ending in .fxs, .ply, .splat or .spz", o.out);
    status = place_scenes(&o.placed, &o.world);
    if (status)
        return status;
    status = check_inputs(&o.placed);
    if (!status)
        status = packed ? to_fxs(&o) : stream(&o);
    fxs_world_free(&o.placed);
    return status;
}
