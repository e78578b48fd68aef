/* fixsplat info */
#include <inttypes.h>
#include <stdlib.h>

#include "../port/formats/fxs_file.h"
#include "command.h"

static const char help[] =
    "Usage: fixsplat info SCENE [--size WxH] [--lod LEVEL] [--json]\n"
    "       fixsplat info --backends\n\n"
    "Prints the number of Gaussians, SH degree and bounds of a scene, its bytes a Gaussian once packed, the largest\n"
    "difference that packing made to each attribute (of an .fxs file, which is packed\n"
    "already, every checksum is verified instead), and the memory that a frame of the given size (default\n"
    "1280x720) needs. With --backends: what can blend here, and why something cannot.\n\n"
    "Examples:\n"
    "  fixsplat info scene.ply\n"
    "  fixsplat info scene.ply --size 1920x1080 --json\n";

static void print_json(const loaded_scene *s, const fxs_frame_memory *m, int width, int height)
{
    const fxs_pack_report *r = &s->report;
    printf("{\"format\": \"%s\", \"gaussians\": %" PRIu64 ", \"packed\": %" PRIu64 ", \"sh_degree\": %d, "
           "\"antialiased\": %s, ", s->info.format, r->read, r->packed, s->info.sh_degree,
           s->info.antialiased ? "true" : "false");
    printf("\"bounds\": [[%.9g, %.9g, %.9g], [%.9g, %.9g, %.9g]], ", r->low[0], r->low[1], r->low[2], r->high[0],
           r->high[1], r->high[2]);
    printf("\"packed_bytes\": %zu, \"bytes_per_gaussian\": %.3f, ", s->packed.bytes,
           (double)s->packed.bytes / (double)r->packed);
    if (!s->mapped)
        printf("\"largest_error\": {\"position\": %.3g, \"scale\": %.3g, \"rotation_degrees\": %.3g, "
               "\"opacity\": %.3g, "
           "\"dc\": %.3g, \"sh\": %.3g}, ", r->largest.position, r->largest.scale, r->largest.rotation,
           r->largest.opacity, r->largest.dc, r->largest.sh);
    printf("\"frame\": {\"width\": %d, \"height\": %d, \"splats\": %zu, \"keys\": %zu, \"tiles\": %zu, "
           "\"entries\": %zu, \"bytes\": %zu}}\n", width, height, m->splats, m->keys, m->tiles, m->entries, m->total);
}

static void print_text(const loaded_scene *s, const fxs_frame_memory *m, int width, int height)
{
    const fxs_pack_report *r = &s->report;
    printf("format        %s%s\n", s->info.format, s->info.antialiased ? ", anti-aliased" : "");
    printf("Gaussians     %" PRIu64 ", %" PRIu64 " of them drawable\n", r->read, r->packed);
    printf("SH degree     %d\n", s->info.sh_degree);
    printf("bounds        %.6g %.6g %.6g to %.6g %.6g %.6g\n", r->low[0], r->low[1], r->low[2], r->high[0], r->high[1],
           r->high[2]);
    printf("middle 90 %%   %.6g %.6g %.6g to %.6g %.6g %.6g\n", r->inner_low[0], r->inner_low[1], r->inner_low[2],
           r->inner_high[0], r->inner_high[1], r->inner_high[2]);
    printf("packed        %zu bytes, %.2f a Gaussian\n", s->packed.bytes,
           (double)s->packed.bytes / (double)r->packed);
    if (!s->mapped)
        printf("largest error position %.3g, ln(sigma) %.3g, rotation %.3g degrees, opacity %.3g, dc %.3g, sh %.3g\n",
           r->largest.position, r->largest.scale, r->largest.rotation, r->largest.opacity, r->largest.dc,
           r->largest.sh);
    printf("frame         %dx%d needs %zu bytes: splats %zu, keys %zu, tiles %zu, entries %zu\n", width, height,
           m->total, m->splats, m->keys, m->tiles, m->entries);
}

int command_info(int argc, char **argv)
{
    enum { OPT_JSON = OPT_OWN, OPT_BACKENDS };
    static const struct option table[] = {{"size", required_argument, 0, OPT_SIZE}, {"lod", required_argument, 0, OPT_LOD}, {"json", no_argument, 0, OPT_JSON},
                                          {"backends", no_argument, 0, OPT_BACKENDS},
                                          {"help", no_argument, 0, OPT_HELP}, {0, 0, 0, 0}};
    int width = 1280, height = 720, lod = 0, json = 0;
    loaded_scene loaded;
    fxs_context context;
    fxs_frame_memory memory;
    opterr = 0;
    for (int c; (c = getopt_long(argc, argv, "", table, 0)) != -1;)
        switch (c) {
        case OPT_SIZE:
            if (!parse_size(optarg, &width, &height))
                return fail(EXIT_USAGE, "--size %s: expected WxH, each 1 to %d", optarg, FXS_MAX_SIZE);
            break;
        case OPT_LOD:
            if (take_lod(&lod, optarg))
                return EXIT_USAGE;
            break;
        case OPT_JSON: json = 1; break;
        case OPT_BACKENDS: backend_list(); return EXIT_OK;
        case OPT_HELP: fputs(help, stdout); return EXIT_OK;
        default: return wrong_option(argv);
        }
    if (optind != argc - 1)
        return fail(EXIT_USAGE, "info takes one scene file; see: fixsplat info --help");
    if (load_scene(&loaded, argv[optind], lod))
        return EXIT_FAILED;
    fxs_message message;
    if (loaded.mapped && fxs_file_check(argv[optind], loaded.packed.data, loaded.packed.bytes, 1, &message)) {
        free_scene(&loaded);
        return fail(EXIT_FAILED, "%s", message.text);
    }
    fxs_init(&context, 0);
    fxs_frame_bytes(&context, &loaded.scene, width, height, &memory);
    (json ? print_json : print_text)(&loaded, &memory, width, height);
    free_scene(&loaded);
    return EXIT_OK;
}
