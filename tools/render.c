/* fixsplat render */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "../port/image/image_file.h"
#include "command.h"

static const char help[] =
    "Usage: fixsplat render SCENE -o OUT [OPTION...]\n\n"
    "Renders a scene (.fxs, .ply, .splat, .ksplat, .spz, .sog, .gltf, .glb, tileset.json) to OUT: .png, .ppm or\n"
    ".raw (RGBA bytes, rows from the top).\n\n"
    "  -o, --output OUT    the picture; with --view all a name with one %%d, as out/%%04d.png\n"
    "  --alpha             alpha holds the coverage, colours premultiplied; else alpha is 255\n"
    "  --hash              print the FNV-1a 64 hash of the RGBA bytes\n"
    "  --stats             print a JSON object: counts, milliseconds of each stage, bytes of each buffer\n"
    "%s\n"
    "Examples:\n"
    "  fixsplat render scene.ply -o scene.png\n"
    "  fixsplat render scene.ply --cameras cameras.json --view 8 --size 1280x720 -o view8.png\n"
    "  fixsplat render scene.ply --cameras cameras.json --view all -o out/%%04d.png\n"
    "  fixsplat render scene.ply --eye 0,-1,-4 --look 0,0,0 --fov 40 --bg ffffff -o white.png --hash\n";

typedef struct render_options {
    view_options view;
    const char *scene, *output;
    int hash, stats;
} render_options;

enum { OPT_ALPHA = OPT_OWN, OPT_HASH, OPT_STATS };

static int take_options(render_options *o, int argc, char **argv)
{
    static const struct option table[] = {VIEW_OPTIONS, {"output", required_argument, 0, 'o'},
                                          {"alpha", no_argument, 0, OPT_ALPHA}, {"hash", no_argument, 0, OPT_HASH},
                                          {"stats", no_argument, 0, OPT_STATS}, {0, 0, 0, 0}};
    memset(o, 0, sizeof *o);
    view_options_default(&o->view);
    opterr = 0;
    for (int c; (c = getopt_long(argc, argv, "o:", table, 0)) != -1;)
        switch (c) {
        case 'o': o->output = optarg; break;
        case OPT_ALPHA: o->view.format = FXS_FORMAT_RGBA8_COVERAGE; break;
        case OPT_HASH: o->hash = 1; break;
        case OPT_STATS: o->stats = 1; break;
        case OPT_HELP: printf(help, view_options_help); exit(EXIT_OK);
        case '?': return wrong_option(argv);
        default:
            if (view_option(&o->view, c, optarg))
                return EXIT_USAGE;
        }
    if (optind != argc - 1)
        return fail(EXIT_USAGE, "render takes one scene file; see: fixsplat render --help");
    o->scene = argv[optind];
    if (!o->output && !o->hash && !o->stats)
        return fail(EXIT_USAGE, "render: where to? Give -o OUT.png, --hash or --stats");
    if (o->stats && o->view.stereo > 0)
        return fail(EXIT_USAGE, "--stats is of one picture, not of --stereo; see: fixsplat bench --stereo");
    if (o->output && !fxs_image_file_known(o->output))
        return fail(EXIT_USAGE, "%s: expected a name ending in .png, .ppm or .raw", o->output);
    return view_options_check(&o->view);
}

/* The name has exactly one % conversion, a %d with an optional zero-padded width. */
static int is_pattern(const char *name)
{
    const char *percent = strchr(name, '%');
    if (!percent || strchr(percent + 1, '%'))
        return 0;
    return percent[1 + strspn(percent + 1, "0123456789")] == 'd' && strspn(percent + 1, "0123456789") <= 2;
}

static void output_name(char *name, size_t size, const char *pattern, long index)
{
    const char *percent = strchr(pattern, '%');
    int width = atoi(percent + 1);
    snprintf(name, size, "%.*s%0*ld%s", (int)(percent - pattern), pattern, width, index, strchr(percent, 'd') + 1);
}

static uint64_t fnv1a64(const uint8_t *bytes, size_t count)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < count; i++)
        hash = (hash ^ bytes[i]) * 0x100000001b3u;
    return hash;
}

static int print_stats(renderer *r, const render_options *o, const loaded_scene *loaded, const fxs_file_view *view,
                       const fxs_stats *stats)
{
    fxs_camera camera;
    fxs_message message;
    const fxs_frame_memory *memory = &stats->memory;
    uint64_t evaluated = 0, blended = 0;
    fxs_camera_from_view(&camera, view, &message);
    fxs_object object;
    fxs_object_init(&object, &loaded->scene);
    int error = fxs_count_pairs(&object, 1, &camera, &o->view.render, r->memory, r->memory_bytes, &evaluated,
                                &blended);
    if (error)
        return fail(EXIT_FAILED, "%s", fxs_strerror(error));
    printf("{\"gaussians\": %" PRIu64 ", \"packed\": %" PRIu32 ", \"visible\": %" PRIu32 ", \"entries\": %" PRIu64
           ", \"bands\": %" PRIu32 ", \"runs\": %" PRIu32 ", \"pairs_evaluated\": %" PRIu64
           ", \"pairs_blended\": %" PRIu64 ", \"frame_ms\": %.3f, \"stages_ms\": {", loaded->report.read, stats->gaussians,
           stats->visible, stats->entries, stats->bands, stats->runs, evaluated, blended, (double)stats->frame_nanoseconds * 1e-6);
    for (int i = 0; i < FXS_STAGES; i++)
        printf("%s\"%s\": %.3f", i ? ", " : "", fxs_stage_name((enum fxs_stage)i),
               (double)stats->nanoseconds[i] * 1e-6);
    printf("}, \"versions\": {");
    for (int i = 0; i < FXS_STAGES; i++)
        printf("%s\"%s\": \"%s\"", i ? ", " : "", fxs_stage_name((enum fxs_stage)i), r->context.kernels.name[i]);
    printf("}, \"bytes\": {\"scene\": %zu, \"splats\": %zu, \"keys\": %zu, \"tiles\": %zu, \"entries\": %zu, "
           "\"frame\": %zu}}\n", loaded->packed.bytes, memory->splats, memory->keys, memory->tiles, memory->entries,
           memory->total);
    return 0;
}

/* A picture that is done, to be written. */
typedef struct picture {
    uint8_t *pixels;
    size_t bytes;
    int width, height, status, unwritten;
    fxs_message why;                        /* unwritten */
    fxs_stats stats;
    uint64_t hash;
} picture;

enum { PICTURES_MOST = 64 };                /* as many as threads, at most */

/* The views, in rounds of a picture a thread: each device renders some of a round, then all of them are written. */
typedef struct shared_views {
    const render_options *o;
    const loaded_scene *loaded;
    const fxs_file_view *views;
    renderer renderers[DEVICES_MOST];
    int devices;                            /* renderers, one on each */
    fxs_pool *pool;
    picture pictures[PICTURES_MOST];
    long first, all, round, round_most;     /* views done, of all, of this round, of a round at most: threads */
} shared_views;

static void draw_view(shared_views *s, renderer *r, const fxs_file_view *view, picture *out)
{
    out->status = renderer_render(r, s->loaded, view, &s->o->view.render, &out->stats);
    const picture done = {.pixels = r->pixels, .bytes = r->pixel_bytes};
    r->pixels = out->pixels;                /* the one that was written, for the next view */
    r->pixel_bytes = out->bytes;
    out->pixels = done.pixels;
    out->bytes = done.bytes;
    out->width = r->width;
    out->height = r->height;
}

static void draw_views(void *argument, uint32_t device)
{
    shared_views *s = argument;
    for (long i = (long)device; i < s->round; i += s->devices) {
        draw_view(s, &s->renderers[device], &s->views[s->first + i], &s->pictures[i]);
        if (s->pictures[i].status)
            break;
        if (device == 0 && s->all > 1)
            progress_bar("rendering", (double)(s->first + i + 1) / (double)s->all);
    }
}

static void write_view(void *argument, uint32_t i)
{
    shared_views *s = argument;
    picture *p = &s->pictures[i];
    char name[4096];
    if (p->status)
        return;
    if (s->o->hash)
        p->hash = fnv1a64(p->pixels, (size_t)p->width * (size_t)p->height * 4);
    if (!s->o->output)
        return;
    if (is_pattern(s->o->output))
        output_name(name, sizeof name, s->o->output, s->first + i);
    else
        snprintf(name, sizeof name, "%s", s->o->output);
    p->unwritten = fxs_image_file_write(name, p->pixels, p->width, p->height, &p->why);
}

/* What is printed of a view, in the order of the views. */
static int report_view(shared_views *s, long i)
{
    const picture *p = &s->pictures[i];
    if (!p->status && p->unwritten)
        return fail(EXIT_FAILED, "%s", p->why.text);
    if (!p->status && s->o->hash) {
        progress_end();
        printf("%016" PRIx64 "\n", p->hash);
    }
    return p->status || !s->o->stats
               ? p->status : print_stats(&s->renderers[0], s->o, s->loaded, &s->views[s->first + i], &p->stats);
}

static int render_round(shared_views *s)
{
    s->round = s->all - s->first < s->round_most ? s->all - s->first : s->round_most;
    for (long i = 0; i < s->round; i++)
        s->pictures[i].status = EXIT_FAILED;    /* until it is drawn */
    if (s->devices == 1)
        draw_views(s, 0);                       /* on this thread, whose a GL context is */
    else
        fxs_pool_run(s->pool, draw_views, s, (uint32_t)(s->round < s->devices ? s->round : s->devices));
    fxs_pool_run(s->pool, write_view, s, (uint32_t)s->round);
    for (long i = 0; i < s->round; i++)
        if (report_view(s, i))
            return EXIT_FAILED;
    s->first += s->round;
    return 0;
}

static int render_all(shared_views *s)
{
    if (s->o->output && s->all > 1 && !is_pattern(s->o->output))
        return fail(EXIT_USAGE, "%s: for %ld views, expected a name with one %%d, as out/%%04d.png", s->o->output,
                    s->all);
    while (s->first < s->all)
        if (render_round(s))
            return EXIT_FAILED;
    progress_end();
    return 0;
}

static int open_renderers(shared_views *s, const view_options *options)
{
    int devices[DEVICES_MOST], count = cuda_devices(options, devices), status = 0;
    const uint32_t threads = options->threads < (uint32_t)count ? (uint32_t)count : options->threads;
    while (s->devices < count && !status) {
        view_options own = *options;
        own.devices[0] = devices[s->devices];
        own.device_count = 1;
        status = renderer_init(&s->renderers[s->devices++], &own);
    }
    s->round_most = threads;
    if (!status && !(s->pool = fxs_pool_create(threads)))
        status = fail(EXIT_FAILED, "cannot start %u threads", threads);
    return status;
}

static void close_renderers(shared_views *s)
{
    for (int i = 0; i < s->devices; i++)
        renderer_free(&s->renderers[i]);
    for (int i = 0; i < PICTURES_MOST; i++)
        free(s->pictures[i].pixels);
    fxs_pool_destroy(s->pool);
}

int command_render(int argc, char **argv)
{
    render_options o;
    loaded_scene loaded;
    fxs_file_view *views = 0;
    shared_views s = {.o = &o, .loaded = &loaded};
    int status = take_options(&o, argc, argv);
    if (status)
        return status;
    status = open_renderers(&s, &o.view);
    if (!status && !(status = load_scene(&loaded, o.scene, &o.view.load))) {
        s.all = choose_views(&o.view, &loaded.report, &views);
        s.views = views;
        status = s.all < 0 ? EXIT_FAILED : render_all(&s);
        free(views);
        free_scene(&loaded);
    }
    close_renderers(&s);
    return status;
}
