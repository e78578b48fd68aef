/* fixsplat info */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "../port/scene/fxs_file.h"
#include "quality.h"

static const char help[] =
    "Usage: fixsplat info SCENE [OPTION...]\n"
    "       fixsplat info --backends\n\n"
    "Prints the number of Gaussians, SH degree and bounds of a scene, its bytes a Gaussian once packed, the largest\n"
    "difference that packing made to each attribute (of an .fxs file, which is packed already, every checksum is\n"
    "verified instead), and the memory that a frame needs: for any view, and the least.\n\n"
    "  --compare ORIGINAL  render SCENE and the scene that it was made from, and print PSNR and SSIM of each view,\n"
    "                      their means (that of PSNR without views that are equal), the worst of each, and the view\n"
    "                      of the worst PSNR. The original is packed as convert does without options: what that\n"
    "                      loses itself, against the floats, is not in the figures (57 dB on a captured scene; the\n"
    "                      tests hold a mean of 54 dB, 50 dB in the worst view)\n"
    "  --cameras FILE      compare from evenly spaced views of this file (default: around the scene, in turn framed\n"
    "                      as by render, close, where it is larger than the picture, and far)\n"
    "  --views N           how many, 1 to 1000 (default 8)\n"
    "  --size WxH          pixels (default 1280x720; of the views of a file their own)\n"
    "  --max-memory BYTES  (also as 64K, 3M, 2G) what render and bench can do with so much\n"
    "  --profile P         how a scene that is not an .fxs file is packed: default, compact or small\n"
    "  --lod LEVEL         level of detail of SCENE, where it is a streamed .sog, 0 the finest (default 0)\n"
    IMPORT_HELP
    "  --json              print a JSON object: of --compare a list of views, psnr and ssim (means), worst_psnr,\n"
    "                      worst_ssim and worst_view (a PSNR is null where the pictures are equal)\n"
    "  --backends          what can blend here, and why something cannot\n"
    "  --help              this text\n\n"
    "Examples:\n"
    "  fixsplat info scene.ply\n"
    "  fixsplat info scene.ply --size 1920x1080 --json\n"
    "  fixsplat info scene.spz --compare scene.ply --cameras cameras.json --views 4\n";

typedef struct info_options {
    view_options view;                      /* cameras, size and lod are used */
    const char *scene, *original;
    uint64_t views;                         /* 0: none given */
    int json;
} info_options;

enum { OPT_JSON = OPT_OWN, OPT_COMPARE, OPT_VIEWS, OPT_BACKENDS };

/* What is known of a scene. */
typedef struct findings {
    loaded_scene scene;
    int width, height;
    fxs_frame_memory memory;
    size_t limit;                           /* --max-memory; 0: none */
    int compared;
    quality quality;
} findings;

/* ---- Printing -------------------------------------------------------------------------------------------------- */

static void print_error_json(const char *name, const fxs_pack_error *e)
{
    printf("\"%s\": {\"position\": %.3g, \"scale\": %.3g, \"rotation_degrees\": %.3g, \"opacity\": %.3g, \"dc\": %.3g, "
           "\"sh\": %.3g}, ", name, e->position, e->scale, e->rotation, e->opacity, e->dc, e->sh);
}

static void print_json(const findings *f)
{
    const loaded_scene *s = &f->scene;
    const fxs_pack_report *r = &s->report;
    const fxs_frame_memory *m = &f->memory;
    printf("{\"format\": \"%s\", \"gaussians\": %" PRIu64 ", \"packed\": %" PRIu64 ", \"sh_degree\": %d, "
           "\"antialiased\": %s, ", s->info.format, r->read, r->packed, s->info.sh_degree,
           s->info.antialiased ? "true" : "false");
    if (!s->mapping.data)
        printf("\"left_out\": {\"not_finite\": %" PRIu64 ", \"zero_quaternion\": %" PRIu64 ", \"share\": %.3g}, "
               "\"brought_in\": %" PRIu64 ", ", r->dropped.not_finite, r->dropped.rotation,
               fxs_dropped_share(&r->dropped), r->brought_in);
    printf("\"bounds\": [[%.9g, %.9g, %.9g], [%.9g, %.9g, %.9g]], ", r->low[0], r->low[1], r->low[2], r->high[0],
           r->high[1], r->high[2]);
    printf("\"profile\": \"%s\", ", profile_name(s->scene.profile));
    printf("\"packed_bytes\": %zu, \"bytes_per_gaussian\": %.3f, ", s->packed.bytes,
           (double)s->packed.bytes / (double)r->packed);
    if (!s->mapping.data) {
        print_error_json("largest_error", &r->largest);
        print_error_json("rms_error", &r->rms);
    }
    if (f->compared) {
        printf("\"compare\": ");
        quality_print_json(&f->quality);
        printf(", ");
    }
    printf("\"frame\": {\"width\": %d, \"height\": %d, \"splats\": %zu, \"keys\": %zu, \"tiles\": %zu, "
           "\"entries\": %zu, \"bytes\": %zu, \"least\": %zu}}\n", f->width, f->height, m->splats, m->keys, m->tiles,
           m->entries, m->total, m->least);
}

static void print_error_text(const char *name, const fxs_pack_error *e)
{
    printf("%-13s position %.3g, ln(sigma) %.3g, rotation %.3g degrees, opacity %.3g, dc %.3g, sh %.3g\n", name,
           e->position, e->scale, e->rotation, e->opacity, e->dc, e->sh);
}

/* What a frame can be with --max-memory: beyond the least, a band takes 88 bytes a splat. */
static void print_limit(const fxs_frame_memory *m, size_t limit)
{
    if (limit < m->least)
        printf("--max-memory  %zu bytes: too little for any view\n", limit);
    else if (limit >= m->total)
        printf("--max-memory  %zu bytes: enough for any view\n", limit);
    else
        printf("--max-memory  %zu bytes: enough for views with at most %zu Gaussians in a row of tiles (16 pixels)\n",
               limit, (limit - m->least) / 88 / 16 * 16);
}

static void print_text(const findings *f)
{
    const loaded_scene *s = &f->scene;
    const fxs_pack_report *r = &s->report;
    const fxs_frame_memory *m = &f->memory;
    printf("format        %s%s\n", s->info.format, s->info.antialiased ? ", anti-aliased" : "");
    printf("Gaussians     %" PRIu64 ", %" PRIu64 " of them drawable\n", r->read, r->packed);
    printf("SH degree     %d\n", s->info.sh_degree);
    printf("profile       %s\n", profile_name(s->scene.profile));
    printf("bounds        %.6g %.6g %.6g to %.6g %.6g %.6g\n", r->low[0], r->low[1], r->low[2], r->high[0], r->high[1],
           r->high[2]);
    printf("seen          %.6g %.6g %.6g to %.6g %.6g %.6g\n", r->inner_low[0], r->inner_low[1], r->inner_low[2],
           r->inner_high[0], r->inner_high[1], r->inner_high[2]);
    printf("packed        %zu bytes, %.2f a Gaussian\n", s->packed.bytes,
           (double)s->packed.bytes / (double)r->packed);
    if (!s->mapping.data) {
        print_error_text("largest error", &r->largest);
        print_error_text("rms error", &r->rms);
    }
    printf("frame         %dx%d needs %zu bytes: splats %zu, keys %zu, tiles %zu, entries %zu; in bands %zu or more\n",
           f->width, f->height, m->total, m->splats, m->keys, m->tiles, m->entries, m->least);
    if (f->limit)
        print_limit(m, f->limit);
    if (f->compared) {
        puts("");
        quality_print_text(&f->quality);
    }
}

/* ---- The command ----------------------------------------------------------------------------------------------- */

static int take_options(info_options *o, int argc, char **argv)
{
    static const struct option table[] = {{"compare", required_argument, 0, OPT_COMPARE},
                                          {"cameras", required_argument, 0, OPT_CAMERAS},
                                          {"views", required_argument, 0, OPT_VIEWS}, {"backends", no_argument, 0, OPT_BACKENDS},
                                          {"size", required_argument, 0, OPT_SIZE},
                                          {"max-memory", required_argument, 0, OPT_MAX_MEMORY},
                                          {"lod", required_argument, 0, OPT_LOD}, IMPORT_OPTIONS,
                                          {"profile", required_argument, 0, OPT_PROFILE}, {"json", no_argument, 0, OPT_JSON},
                                          {"help", no_argument, 0, OPT_HELP}, {0, 0, 0, 0}};
    memset(o, 0, sizeof *o);
    view_options_default(&o->view);
    opterr = 0;
    for (int c; (c = getopt_long(argc, argv, "", table, 0)) != -1;)
        switch (c) {
        case OPT_COMPARE: o->original = optarg; break;
        case OPT_VIEWS:
            if (!parse_count(optarg, 1, 1000, &o->views))
                return fail(EXIT_USAGE, "--views %s: expected 1 to 1000", optarg);
            break;
        case OPT_JSON: o->json = 1; break;
        case OPT_BACKENDS: backend_list(); cuda_list(); exit(EXIT_OK);
        case OPT_HELP: fputs(help, stdout); exit(EXIT_OK);
        case '?': return wrong_option(argv);
        default:
            if (view_option(&o->view, c, optarg))
                return EXIT_USAGE;
        }
    if (optind != argc - 1)
        return fail(EXIT_USAGE, "info takes one scene file; see: fixsplat info --help");
    if (!o->original && (o->view.cameras || o->views))
        return fail(EXIT_USAGE, "--cameras and --views need --compare");
    o->scene = argv[optind];
    return 0;
}

static int compare(findings *f, const info_options *o)
{
    loaded_scene original;
    const load_options *load = &o->view.load;
    int status = load_scene(&original, o->original, &(load_options){.max_gaussians = load->max_gaussians,
                                                                    .import_memory = load->import_memory});
    if (status)
        return status;
    status = quality_measure(&f->quality, &f->scene, &original, &o->view, o->views ? (long)o->views : 8);
    f->compared = !status;
    free_scene(&original);
    return status;
}

static int find(findings *f, const info_options *o)
{
    fxs_message message;
    fxs_context context;
    const fxs_packed_scene *packed = &f->scene.packed;
    if (f->scene.mapping.data && fxs_file_check(o->scene, packed->data, packed->bytes, 1, &message))
        return fail(EXIT_FAILED, "%s", message.text);
    f->width = o->view.width ? o->view.width : 1280;
    f->height = o->view.height ? o->view.height : 720;
    const fxs_config config = {.run = fxs_pool_run, .threads = fxs_processors()};   /* only asked for sizes */
    f->limit = o->view.max_memory;
    fxs_init(&context, &config);
    fxs_object object;
    fxs_object_init(&object, &f->scene.scene);
    fxs_frame_bytes(&context, &object, 1, f->width, f->height, &f->memory);
    return o->original ? compare(f, o) : 0;
}

int command_info(int argc, char **argv)
{
    info_options o;
    findings f = {.compared = 0};
    int status = take_options(&o, argc, argv);
    if (!status && !(status = load_scene(&f.scene, o.scene, &o.view.load))) {
        status = find(&f, &o);
        if (!status)
            (o.json ? print_json : print_text)(&f);
        if (f.compared)
            quality_free(&f.quality);
        free_scene(&f.scene);
    }
    return status;
}
