/* fixsplat render */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "../port/backend/backends.h"
#include "../port/image/depth_file.h"
#include "../port/image/image_file.h"
#include "../port/image/panorama.h"
#include "../port/posix/pool.h"
#include "renderer.h"

static const char help[] =
    "Usage: fixsplat render SCENE... -o OUT [OPTION...]\n\n"
    "Renders scenes (.fxs, .ply, .splat, .ksplat, .spz, .sog, .gltf, .glb, tileset.json) to OUT: .png, .ppm or\n"
    ".raw (RGBA bytes, rows from the top).\n\n"
    "  -o, --output OUT    the picture; with --view all a name with one %%d, as out/%%04d.png, and so below\n"
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
    "  --hash              print the FNV-1a 64 hash of the RGBA bytes\n"
    "  --stats             print a JSON object: counts, milliseconds of each stage, bytes of each buffer; pairs are\n"
    "                      counted in a second frame, by plain C, in all the memory that takes\n"
    "  --json              print what --pick finds as a JSON object\n"
    "%s%s\n"
    "Examples:\n"
    "  fixsplat render scene.ply -o scene.png\n"
    "  fixsplat render scene.ply --cameras cameras.json --view 8 --size 1280x720 -o view8.png\n"
    "  fixsplat render scene.ply --cameras cameras.json --view all -o out/%%04d.png --depth out/%%04d.pfm\n"
    "  fixsplat render scene.ply --eye 0,-1,-4 --look 0,0,0 --fov 40 --bg ffffff -o white.png --hash\n"
    "  fixsplat render room.fxs chair.spz --place chair.spz:1,0,2 --place chair.spz:-1,0,2,0,0,1,0 -o room.png\n"
    "  fixsplat render scene.ply --ortho 4 --size 1000x1000 -o plan.png --ids ids.png\n"
    "  fixsplat render scene.ply --stereo 0.063 --tangents -1.38,1.19,1.0,-1.2 --size 2064x2208 --foveate -o eyes.png\n"
    "  fixsplat render scene.ply --panorama --size 4096x2048 -o around.png\n";

typedef struct render_options {
    frame_options frame;
    enum fxs_format format;
    const char *output, *depth, *ids;
    int draws;                              /* DRAW_* */
    double depth_range;                     /* 0: that of the picture */
    int has_pick, pick[2];
    int hash, stats, json;
} render_options;

enum { OPT_ALPHA = OPT_OWN, OPT_HASH, OPT_STATS, OPT_JSON, OPT_DEPTH, OPT_DEPTH_KIND, OPT_DEPTH_RANGE, OPT_IDS,
       OPT_PICK, OPT_PANORAMA };

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
    const char *comma = strchr(value, ',');
    char x[8];
    uint64_t numbers[2];
    const size_t length = comma ? (size_t)(comma - value) : sizeof x;
    if (length >= sizeof x)
        return fail(EXIT_USAGE, "--pick %s: expected a pixel X,Y", value);
    memcpy(x, value, length);
    x[length] = 0;
    if (!parse_count(x, 0, FXS_MAX_SIZE - 1, &numbers[0]) || !parse_count(comma + 1, 0, FXS_MAX_SIZE - 1, &numbers[1]))
        return fail(EXIT_USAGE, "--pick %s: expected a pixel X,Y", value);
    o->has_pick = 1;
    o->pick[0] = (int)numbers[0];
    o->pick[1] = (int)numbers[1];
    return 0;
}

static int take_option(render_options *o, int which, const char *value)
{
    switch (which) {
    case 'o': o->output = value; break;
    case OPT_ALPHA: o->format = FXS_FORMAT_RGBA8_COVERAGE; break;
    case OPT_HASH: o->hash = 1; break;
    case OPT_STATS: o->stats = 1; break;
    case OPT_JSON: o->json = 1; break;
    case OPT_DEPTH: o->depth = value; break;
    case OPT_DEPTH_KIND: return take_depth_kind(o, value);
    case OPT_DEPTH_RANGE:
        if (!parse_vector(value, 1, &o->depth_range) || o->depth_range <= 0)
            return fail(EXIT_USAGE, "--depth-range %s: expected a depth above 0", value);
        break;
    case OPT_IDS: o->ids = value; o->draws |= DRAW_IDS; break;
    case OPT_PICK: return take_pick(o, value);
    case OPT_PANORAMA: o->frame.panorama = 1; break;
    default: return frame_option(&o->frame, which, value);
    }
    return 0;
}

/* The outputs that are asked for, against each other and the back end. */
static int check_outputs(render_options *o)
{
    const int depths = DRAW_MEAN_DEPTH | DRAW_MEDIAN_DEPTH;
    const fxs_backend *backend = fxs_backend_find(o->frame.backend);
    if (!o->output && !o->hash && !o->stats && !o->depth && !o->ids && !o->has_pick)
        return fail(EXIT_USAGE, "render: where to? Give -o OUT.png, --depth, --ids, --pick, --hash or --stats");
    if (o->output && !fxs_image_file_known(o->output))
        return fail(EXIT_USAGE, "%s: expected a name ending in .png, .ppm or .raw", o->output);
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
    if (o->frame.panorama && (o->draws || o->has_pick || o->stats))
        return fail(EXIT_USAGE, "--panorama is a picture of colours: no --depth, --ids, --pick, --stats");
    if (o->frame.stereo > 0 && (o->stats || o->has_pick))
        return fail(EXIT_USAGE, "%s is of one picture, not of --stereo%s", o->stats ? "--stats" : "--pick",
                    o->stats ? "; see: fixsplat bench --stereo" : "");
    if (o->frame.foveate.on && (o->draws || o->stats))
        return fail(EXIT_USAGE, "--foveate is of colours: no --depth, --ids, --stats; see: fixsplat bench --foveate");
    if (o->json && !o->has_pick)
        return fail(EXIT_USAGE, "--json is for --pick");
    if (o->draws && backend && !(backend->can & FXS_CAN_TRACE))
        return fail(EXIT_USAGE, "--backend %s has colours only: no --depth, --ids", backend->name);
    return 0;
}

static int take_options(render_options *o, int argc, char **argv)
{
    static const struct option table[] = {FRAME_OPTIONS, {"output", required_argument, 0, 'o'},
                                          {"alpha", no_argument, 0, OPT_ALPHA}, {"hash", no_argument, 0, OPT_HASH},
                                          {"stats", no_argument, 0, OPT_STATS}, {"json", no_argument, 0, OPT_JSON},
                                          {"depth", required_argument, 0, OPT_DEPTH},
                                          {"depth-kind", required_argument, 0, OPT_DEPTH_KIND},
                                          {"depth-range", required_argument, 0, OPT_DEPTH_RANGE},
                                          {"ids", required_argument, 0, OPT_IDS},
                                          {"pick", required_argument, 0, OPT_PICK},
                                          {"panorama", no_argument, 0, OPT_PANORAMA}, {0, 0, 0, 0}};
    memset(o, 0, sizeof *o);
    frame_options_default(&o->frame);
    opterr = 0;
    for (int c; (c = getopt_long(argc, argv, "o:", table, 0)) != -1;) {
        if (c == OPT_HELP) {
            printf(help, camera_options_help, frame_options_help);
            exit(EXIT_OK);
        }
        if (c == '?')
            return wrong_option(argv);
        if (take_option(o, c, optarg))
            return EXIT_USAGE;
    }
    if (take_scenes(&o->frame.world, "render", argc - optind, argv + optind) || check_outputs(o))
        return EXIT_USAGE;
    return frame_options_check(&o->frame);
}

/* ---- Names and hashes -------------------------------------------------------------------------------------------- */

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

/* The name of a view's file: the pattern's, or just the name. */
static void name_file(char *name, size_t size, const char *pattern, long index)
{
    if (is_pattern(pattern))
        output_name(name, size, pattern, index);
    else
        snprintf(name, size, "%s", pattern);
}

static uint64_t fnv1a64(const uint8_t *bytes, size_t count)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < count; i++)
        hash = (hash ^ bytes[i]) * 0x100000001b3u;
    return hash;
}

/* ---- What is printed --------------------------------------------------------------------------------------------- */

/* In the memory of a frame on one thread, whatever --max-memory says: pairs are counted without slices. */
static int count_pairs(const render_options *o, const world *w, const fxs_camera *camera, uint64_t *evaluated,
                       uint64_t *blended)
{
    fxs_context context;
    fxs_init(&context, 0);
    const size_t bytes = fxs_frame_bytes(&context, w->objects, w->count, camera->width, camera->height, 0);
    void *allocation = malloc(bytes + 63), *memory = (void *)(((uintptr_t)allocation + 63) / 64 * 64);
    const int error = allocation ? fxs_count_pairs(w->objects, w->count, camera, &o->frame.render, memory, bytes,
                                                   evaluated, blended) : FXS_ERR_MEMORY;
    free(allocation);
    return error ? fail(EXIT_FAILED, "%s", fxs_strerror(error)) : 0;
}

static int print_stats(const renderer *r, const render_options *o, const world *w, const fxs_file_view *view,
                       const fxs_stats *stats)
{
    fxs_camera camera;
    fxs_message message;
    const fxs_frame_memory *memory = &stats->memory;
    uint64_t evaluated = 0, blended = 0, gaussians = 0;
    size_t scene_bytes = 0;
    fxs_camera_from_view(&camera, view, &message);
    if (count_pairs(o, w, &camera, &evaluated, &blended))
        return EXIT_FAILED;
    for (uint32_t i = 0; i < w->count; i++)
        gaussians += w->scenes[w->placed.objects[i].file].report.read;
    for (uint32_t i = 0; i < w->placed.file_count; i++)
        scene_bytes += w->scenes[i].packed.bytes;
    printf("{\"gaussians\": %" PRIu64 ", \"packed\": %" PRIu32 ", \"visible\": %" PRIu32 ", \"entries\": %" PRIu64
           ", \"bands\": %" PRIu32 ", \"slices\": %" PRIu32 ", \"runs\": %" PRIu32 ", \"pairs_evaluated\": %" PRIu64
           ", \"pairs_blended\": %" PRIu64 ", \"frame_ms\": %.3f, \"stages_ms\": {", gaussians, stats->gaussians,
           stats->visible, stats->entries, stats->bands, stats->slices, stats->runs, evaluated, blended,
           (double)stats->frame_nanoseconds * 1e-6);
    for (int i = 0; i < FXS_STAGES; i++)
        printf("%s\"%s\": %.3f", i ? ", " : "", fxs_stage_name((enum fxs_stage)i),
               (double)stats->nanoseconds[i] * 1e-6);
    printf("}, \"versions\": {");
    for (int i = 0; i < FXS_STAGES; i++)
        printf("%s\"%s\": \"%s\"", i ? ", " : "", fxs_stage_name((enum fxs_stage)i),
               r->backend->version(r->self, (enum fxs_stage)i));
    printf("}, \"bytes\": {\"scene\": %zu, \"splats\": %zu, \"keys\": %zu, \"tiles\": %zu, \"entries\": %zu, "
           "\"frame\": %zu}}\n", scene_bytes, memory->splats, memory->keys, memory->tiles, memory->entries,
           memory->total);
    return 0;
}

static double units(int64_t q32)
{
    return (double)q32 / 4294967296.0;
}

static int print_pick(renderer *r, const render_options *o, const world *w, const fxs_file_view *view)
{
    fxs_pick_result p;
    const int x = o->pick[0], y = o->pick[1];
    if (x >= view->width || y >= view->height)
        return fail(EXIT_FAILED, "--pick %d,%d: the picture is %dx%d", x, y, view->width, view->height);
    const int found = renderer_pick(r, w, view, &o->frame.render, x, y, &p);
    if (found < 0)
        return EXIT_FAILED;
    progress_end();
    if (!found) {
        printf(o->json ? "{\"x\": %d, \"y\": %d, \"object\": null}\n" : "%d,%d: nothing\n", x, y);
        return 0;
    }
    const char *file = w->scenes[w->placed.objects[p.object].file].path;
    const double depth = units(p.depth_q32), position[3] = {units(p.position_q32[0]), units(p.position_q32[1]),
                                                            units(p.position_q32[2])};
    if (o->json) {
        printf("{\"x\": %d, \"y\": %d, \"object\": %" PRIu32 ", \"file\": ", x, y, p.object);
        print_json_string(file);
        printf(", \"gaussian\": %" PRIu32 ", \"id\": %" PRIu32 ", \"depth\": %.9g, \"position\": [%.9g, %.9g, %.9g]}\n",
               p.gaussian, p.id, depth, position[0], position[1], position[2]);
    } else {
        printf("%d,%d: object %" PRIu32 ", %s, Gaussian %" PRIu32 ", id %" PRIu32 ", depth %.6g, position %.6g %.6g "
               "%.6g\n", x, y, p.object, file, p.gaussian, p.id, depth, position[0], position[1], position[2]);
    }
    return 0;
}

/* ---- Views ------------------------------------------------------------------------------------------------------- */

/* A view that is drawn, to be written. */
typedef struct drawn_view {
    picture picture;
    int status, unwritten;
    fxs_message why;                        /* unwritten */
    fxs_stats stats;
    uint64_t hash;
    double range;                           /* of depths, as written */
    char depth_name[4096];
} drawn_view;

enum { DRAWN_MOST = 64 };                   /* as many as threads, at most */

/* The views, in rounds of a picture a thread: each device renders some of a round, then all of them are written. */
typedef struct shared_views {
    const render_options *o;
    const world *world;
    const fxs_file_view *views;
    renderer renderers[DEVICES_MOST];
    picture faces[DEVICES_MOST][FXS_PANORAMA_FACES];
    int devices;                            /* renderers, one on each */
    fxs_pool *pool;
    drawn_view *drawn;
    long first, all, round, round_most;     /* views done, of all, of this round, of a round at most: threads */
} shared_views;

/* Rows of a panorama, one job each 16. */
typedef struct panorama {
    picture *out;
    uint8_t *faces[FXS_PANORAMA_FACES];
} panorama;

enum { PANORAMA_ROWS = 16 };

static void join_rows(void *argument, uint32_t job)
{
    const panorama *p = argument;
    const int first = (int)job * PANORAMA_ROWS, height = p->out->height;
    fxs_panorama_rows(p->out->pixels, p->out->width, height, p->faces, first,
                      first + PANORAMA_ROWS < height ? first + PANORAMA_ROWS : height);
}

static int draw_panorama(shared_views *s, int device, long number, picture *out)
{
    const fxs_file_view *view = &s->views[number];
    panorama p = {.out = out};
    const size_t bytes = (size_t)view->width * (size_t)view->height * 4;
    for (int i = 0; i < FXS_PANORAMA_FACES; i++) {
        fxs_file_view face;
        fxs_panorama_face(view, i, view->width, &face);
        if (renderer_render(&s->renderers[device], s->world, &face, &s->o->frame.render, &s->faces[device][i], 0))
            return EXIT_FAILED;
        p.faces[i] = s->faces[device][i].pixels;
        if (device == 0)
            progress_bar("rendering", ((double)number + (i + 1) / (FXS_PANORAMA_FACES + 1.0)) / (double)s->all);
    }
    if (out->pixel_room < bytes) {
        free(out->pixels);
        out->pixels = malloc(bytes);
        out->pixel_room = out->pixels ? bytes : 0;
    }
    if (!out->pixels)
        return fail(EXIT_FAILED, "out of memory: a picture of %dx%d", view->width, view->height);
    out->width = view->width;
    out->height = view->height;
    fxs_pool_run(s->pool, join_rows, &p, (uint32_t)((view->height + PANORAMA_ROWS - 1) / PANORAMA_ROWS));
    return 0;
}

static void draw_views(void *argument, uint32_t device)
{
    shared_views *s = argument;
    for (long i = (long)device; i < s->round; i += s->devices) {
        drawn_view *d = &s->drawn[i];
        const fxs_file_view *view = &s->views[s->first + i];
        d->status = s->o->frame.panorama ? draw_panorama(s, (int)device, s->first + i, &d->picture)
                                         : renderer_render(&s->renderers[device], s->world, view, &s->o->frame.render,
                                                           &d->picture, &d->stats);
        if (d->status)
            break;
        if (device == 0 && s->all > 1)
            progress_bar("rendering", (double)(s->first + i + 1) / (double)s->all);
    }
}

static int write_depths(shared_views *s, drawn_view *d, long index)
{
    const fxs_depths depths = {d->picture.depths, d->picture.width, d->picture.height, d->picture.depth_bits};
    d->range = s->o->depth_range > 0 ? s->o->depth_range : fxs_depths_farthest(&depths);
    d->range = d->range > 0 ? d->range : 1;
    name_file(d->depth_name, sizeof d->depth_name, s->o->depth, index);
    return fxs_depth_file_write(d->depth_name, &depths, d->range, &d->why);
}

static void write_view(void *argument, uint32_t i)
{
    shared_views *s = argument;
    drawn_view *d = &s->drawn[i];
    const picture *p = &d->picture;
    const long index = s->first + i;
    char name[4096];
    if (d->status)
        return;
    if (s->o->hash)
        d->hash = fnv1a64(p->pixels, (size_t)p->width * (size_t)p->height * 4);
    d->unwritten = 0;
    if (s->o->output) {
        name_file(name, sizeof name, s->o->output, index);
        d->unwritten = fxs_image_file_write(name, p->pixels, p->width, p->height, &d->why);
    }
    if (s->o->depth && !d->unwritten)
        d->unwritten = write_depths(s, d, index);
    if (s->o->ids && !d->unwritten) {
        name_file(name, sizeof name, s->o->ids, index);
        d->unwritten = fxs_id_file_write(name, p->ids, p->width, p->height, s->world->count > 1, &d->why);
    }
}

/* What is printed of a view, in the order of the views. */
static int report_view(shared_views *s, long i)
{
    const drawn_view *d = &s->drawn[i];
    const render_options *o = s->o;
    const fxs_file_view *view = &s->views[s->first + i];
    if (!d->status && d->unwritten)
        return fail(EXIT_FAILED, "%s", d->why.text);
    if (!d->status && (o->hash || o->depth || o->frame.panorama))
        progress_end();
    if (!d->status && o->hash)
        printf("%016" PRIx64 "\n", d->hash);
    if (!d->status && o->depth && !(o->depth_range > 0) && strcmp(strrchr(o->depth, '.'), ".pfm"))
        printf("%s: 65535 is a depth of %.9g\n", d->depth_name, d->range);
    if (!d->status && o->has_pick && print_pick(&s->renderers[0], o, s->world, view))
        return EXIT_FAILED;
    return d->status || !o->stats ? d->status : print_stats(&s->renderers[0], o, s->world, view, &d->stats);
}

static int render_round(shared_views *s)
{
    s->round = s->all - s->first < s->round_most ? s->all - s->first : s->round_most;
    for (long i = 0; i < s->round; i++)
        s->drawn[i].status = EXIT_FAILED;       /* until it is drawn */
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
    const char *const names[] = {s->o->output, s->o->depth, s->o->ids};
    for (int i = 0; i < 3; i++)
        if (names[i] && s->all > 1 && !is_pattern(names[i]))
            return fail(EXIT_USAGE, "%s: for %ld views, expected a name with one %%d, as out/%%04d.png", names[i],
                        s->all);
    while (s->first < s->all)
        if (render_round(s))
            return EXIT_FAILED;
    progress_end();
    return 0;
}

/* ---- The command ------------------------------------------------------------------------------------------------- */

static int open_renderers(shared_views *s, const frame_options *options)
{
    int devices[DEVICES_MOST], count = choose_devices(options, devices), status = 0;
    const uint32_t threads = options->threads < (uint32_t)count ? (uint32_t)count : options->threads;
    while (s->devices < count && !status) {
        frame_options own = *options;
        renderer *r = &s->renderers[s->devices];
        own.devices[0] = devices[s->devices++];
        own.device_count = 1;
        status = renderer_open(r, &own);
        r->format = s->o->format;
        r->draws = s->o->draws;
    }
    s->round_most = threads < DRAWN_MOST ? threads : DRAWN_MOST;
    s->drawn = calloc(DRAWN_MOST, sizeof *s->drawn);
    if (!status && !s->drawn)
        status = fail(EXIT_FAILED, "out of memory");
    if (!status && !(s->pool = fxs_pool_create(threads)))
        status = fail(EXIT_FAILED, "cannot start %u threads", threads);
    return status;
}

static void close_renderers(shared_views *s)
{
    for (int i = 0; i < s->devices; i++) {
        renderer_close(&s->renderers[i]);
        for (int k = 0; k < FXS_PANORAMA_FACES; k++)
            picture_free(&s->faces[i][k]);
    }
    for (int i = 0; i < DRAWN_MOST && s->drawn; i++)
        picture_free(&s->drawn[i].picture);
    free(s->drawn);
    fxs_pool_destroy(s->pool);
}

int command_render(int argc, char **argv)
{
    static render_options o;
    static shared_views s;
    world w = {.count = 0};
    fxs_file_view *views = 0;
    int status = take_options(&o, argc, argv);
    if (status)
        return status;
    s = (shared_views){.o = &o, .world = &w};
    status = open_renderers(&s, &o.frame);
    if (!status)
        status = world_open(&w, &o.frame.world, &o.frame.load);
    if (!status) {
        s.all = choose_views(&o.frame, &w, &views);
        s.views = views;
        status = s.all < 0 ? EXIT_FAILED : render_all(&s);
    }
    close_renderers(&s);
    free(views);
    world_close(&w);
    return status;
}
