#include "render.h"

#include <inttypes.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "../port/image/depth_file.h"
#include "../port/image/film_file.h"
#include "../port/image/panorama.h"
#include "files.h"
#include "metrics.h"

/* ---- Names ----------------------------------------------------------------------------------------------------- */

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

static int print_pairs(const renderer *r, const render_options *o, const world *w, const fxs_file_view *view)
{
    fxs_camera camera;
    uint64_t evaluated, blended;
    if (renderer_camera(r, view, &camera) || count_pairs(o, w, &camera, &evaluated, &blended))
        return EXIT_FAILED;
    printf(", \"pairs_evaluated\": %" PRIu64 ", \"pairs_blended\": %" PRIu64, evaluated, blended);
    return 0;
}

static int print_stats(const renderer *r, const render_options *o, const world *w, const fxs_file_view *view,
                       const fxs_stats *stats)
{
    const fxs_frame_memory *memory = &stats->memory;
    uint64_t gaussians = 0;
    size_t scene_bytes = 0;
    for (uint32_t i = 0; i < w->count; i++)
        gaussians += w->scenes[w->placed.objects[i].file].report.read;
    for (uint32_t i = 0; i < w->placed.file_count; i++)
        scene_bytes += w->scenes[i].packed.bytes;
    printf("{\"gaussians\": %" PRIu64 ", \"packed\": %" PRIu32 ", \"visible\": %" PRIu32 ", \"entries\": %" PRIu64
           ", \"bands\": %" PRIu32 ", \"slices\": %" PRIu32 ", \"runs\": %" PRIu32, gaussians, stats->gaussians,
           stats->visible, stats->entries, stats->bands, stats->slices, stats->runs);
    if (o->pairs && print_pairs(r, o, w, view))
        return EXIT_FAILED;
    printf(", \"frame_ms\": %.3f, \"stages_ms\": {", (double)stats->frame_nanoseconds * 1e-6);
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
    int status, unwritten, unexpected;
    fxs_message why;                        /* unwritten or unexpected */
    fxs_stats stats;
    uint64_t hash;
    double range;                           /* of depths, as written */
    fxs_encoded encoded;
    char depth_name[4096];
} drawn_view;

enum { DRAWN_MOST = 64 };                   /* as many as threads, at most */

/* A picture a thread: each device renders some of them, then they are written while the next round is rendered. */
typedef struct drawn_round {
    drawn_view *drawn;
    long first, count;                      /* views; 0: none */
    pthread_t writer;
    int writing;                            /* the writer is to be joined */
} drawn_round;

typedef struct shared_views {
    const render_options *o;
    const world *world;
    const fxs_file_view *views;
    long all;                               /* views */
    renderer renderers[DEVICES_MOST];
    picture faces[DEVICES_MOST][FXS_PANORAMA_FACES];
    int devices;                            /* renderers, one on each */
    fxs_pool *pool, *writers;
    drawn_round rounds[2];
    long round_most;                        /* views of a round: threads */
    enum fxs_image_format encoding;
    fxs_film *film;                         /* null: each view has a file */
    int failed;                             /* a view could not be drawn, and that was said */
    int unexpected;                         /* a view was */
} shared_views;

typedef struct round_of_views {
    shared_views *views;
    drawn_round *round;
} round_of_views;

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
    const round_of_views *r = argument;
    shared_views *s = r->views;
    for (long i = (long)device; i < r->round->count; i += s->devices) {
        drawn_view *d = &r->round->drawn[i];
        const long number = r->round->first + i;
        d->status = s->o->frame.panorama ? draw_panorama(s, (int)device, number, &d->picture)
                                         : renderer_render(&s->renderers[device], s->world, &s->views[number],
                                                           &s->o->frame.render, &d->picture, &d->stats);
        if (d->status)
            break;
        if (device == 0 && s->all > 1)
            progress_bar("rendering", (double)(number + 1) / (double)s->all);
    }
}

/* ---- What is expected -------------------------------------------------------------------------------------------- */

static uint64_t fnv1a64(const uint8_t *bytes, size_t count)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < count; i++)
        hash = (hash ^ bytes[i]) * 0x100000001b3u;
    return hash;
}

static size_t bytes_of(const picture *p)
{
    return (size_t)p->width * (size_t)p->height * 4;
}

static int write_difference(const char *path, const uint8_t *expected, const picture *p, fxs_message *why)
{
    uint8_t *rgba = malloc(bytes_of(p));
    if (!rgba)
        return fxs_fail_memory(why, path, bytes_of(p));
    fxs_metrics_difference(expected, p->pixels, p->width, p->height, rgba);
    const int error = fxs_image_file_write(path, rgba, p->width, p->height, why);
    free(rgba);
    return error;
}

/* Says how the picture differs from one of its size. */
static void say_difference(drawn_view *d, const char *name, const uint8_t *expected)
{
    const picture *p = &d->picture;
    struct fxs_metrics m;
    char psnr[32];
    size_t pixels = 0;
    for (size_t i = 0; i < bytes_of(p); i += 4)
        pixels += memcmp(expected + i, p->pixels + i, 4) != 0;
    if (fxs_metrics_compare(expected, p->pixels, p->width, p->height, &m))
        fxs_fail_memory(&d->why, name, 0);
    else
        fxs_fail(&d->why, "%s: the picture is another: %zu pixels differ, PSNR %s dB, SSIM %.6f, largest difference %d",
                 name, pixels, fxs_metrics_psnr(psnr, m.psnr, "infinite"), m.ssim, m.largest);
}

static void compare_with_file(const render_options *o, drawn_view *d, long index)
{
    const picture *p = &d->picture;
    char name[4096], difference[4096];
    uint8_t *expected;
    int width, height;
    name_file(name, sizeof name, o->expect, index);
    d->unexpected = fxs_image_file_read(name, &expected, &width, &height, &d->why) != 0;
    if (d->unexpected)
        return;
    d->unexpected = width != p->width || height != p->height || memcmp(expected, p->pixels, bytes_of(p));
    if (width != p->width || height != p->height) {
        fxs_fail(&d->why, "%s is %dx%d, the picture %dx%d", name, width, height, p->width, p->height);
    } else if (d->unexpected) {
        say_difference(d, name, expected);
        if (o->diff) {
            name_file(difference, sizeof difference, o->diff, index);
            d->unwritten = write_difference(difference, expected, p, &d->why);
        }
    }
    free(expected);
}

static void compare_with_hash(const render_options *o, drawn_view *d)
{
    d->unexpected = d->hash != o->expected_hash;
    if (d->unexpected)
        fxs_fail(&d->why, "the picture is another: its hash is %016" PRIx64 ", not %016" PRIx64, d->hash,
                 o->expected_hash);
}

/* ---- Writing ----------------------------------------------------------------------------------------------------- */

static int write_depths(const render_options *o, drawn_view *d, long index)
{
    const fxs_depths depths = {d->picture.depths, d->picture.width, d->picture.height, d->picture.depth_bits};
    d->range = o->depth_range > 0 ? o->depth_range : fxs_depths_farthest(&depths);
    d->range = d->range > 0 ? d->range : 1;
    name_file(d->depth_name, sizeof d->depth_name, o->depth, index);
    return fxs_depth_file_write(d->depth_name, &depths, d->range, &d->why);
}

static int write_picture(const shared_views *s, drawn_view *d, long index)
{
    const picture *p = &d->picture;
    char name[4096];
    fxs_message why;
    name_file(name, sizeof name, s->o->output, index);
    const int error = fxs_image_encode(s->encoding, s->o->quality, p->pixels, p->width, p->height, &d->encoded, &why);
    if (error)
        return fxs_fail_as(error, &d->why, "%s: %s", name, why.text);
    return s->film ? 0 : fxs_encoded_write(name, &d->encoded, &d->why);
}

static void write_view(void *argument, uint32_t i)
{
    const round_of_views *r = argument;
    const render_options *o = r->views->o;
    drawn_view *d = &r->round->drawn[i];
    const picture *p = &d->picture;
    const long index = r->round->first + (long)i;
    char name[4096];
    if (d->status)
        return;
    if (o->hash || o->has_expected_hash)
        d->hash = fnv1a64(p->pixels, bytes_of(p));
    d->unwritten = d->unexpected = 0;
    if (o->output)
        d->unwritten = write_picture(r->views, d, index);
    if (o->depth && !d->unwritten)
        d->unwritten = write_depths(o, d, index);
    if (o->ids && !d->unwritten) {
        name_file(name, sizeof name, o->ids, index);
        d->unwritten = fxs_id_file_write(name, p->ids, p->width, p->height, r->views->world->count > 1, &d->why);
    }
    if (o->expect && !d->unwritten)
        compare_with_file(o, d, index);
    else if (o->has_expected_hash && !d->unwritten)
        compare_with_hash(o, d);
}

/* What follows a frame that cannot be written is not. */
static void *write_round(void *argument)
{
    round_of_views *r = argument;
    shared_views *s = r->views;
    fxs_pool_run(s->writers, write_view, r, (uint32_t)r->round->count);
    int stopped = 0;
    for (long i = 0; i < r->round->count; i++) {
        drawn_view *d = &r->round->drawn[i];
        stopped |= d->status || d->unwritten;
        if (s->film && !stopped)
            stopped = d->unwritten = fxs_film_write(s->film, &d->encoded, &d->why);
    }
    return 0;
}

/* What is printed of a view, in the order of the views. */
static int report_view(shared_views *s, const drawn_view *d, const fxs_file_view *view)
{
    const render_options *o = s->o;
    if (d->status)
        return d->status;
    if (d->unwritten)
        return s->failed ? EXIT_FAILED : fail(EXIT_FAILED, "%s", d->why.text);
    if (o->hash || o->depth || o->frame.panorama)
        progress_end();
    if (d->unexpected)
        s->unexpected = fail(EXIT_FAILED, "%s", d->why.text);
    if (o->hash)
        printf("%016" PRIx64 "\n", d->hash);
    if (o->depth && !(o->depth_range > 0) && strcmp(strrchr(o->depth, '.'), ".pfm"))
        printf("%s: 65535 is a depth of %.9g\n", d->depth_name, d->range);
    if (o->has_pick && print_pick(&s->renderers[0], o, s->world, view))
        return EXIT_FAILED;
    return o->stats ? print_stats(&s->renderers[0], o, s->world, view, &d->stats) : 0;
}

/* ---- Rounds ------------------------------------------------------------------------------------------------------ */

static void draw_round(shared_views *s, drawn_round *round, long first)
{
    round_of_views argument = {s, round};
    round->first = first;
    round->count = s->all - first < s->round_most ? s->all - first : s->round_most;
    for (long i = 0; i < round->count; i++)
        round->drawn[i].status = EXIT_FAILED;   /* until it is drawn */
    if (s->devices == 1)
        draw_views(&argument, 0);               /* on this thread, whose a GL context is */
    else
        fxs_pool_run(s->pool, draw_views, &argument, (uint32_t)(round->count < s->devices ? round->count : s->devices));
    for (long i = 0; i < round->count; i++)
        s->failed |= round->drawn[i].status;
}

/* Waits until a round is written. */
static int finish_round(shared_views *s, drawn_round *round)
{
    int status = 0;
    if (round->writing)
        pthread_join(round->writer, 0);
    round->writing = 0;
    for (long i = 0; i < round->count && !status; i++)
        status = report_view(s, &round->drawn[i], &s->views[round->first + i]);
    round->count = 0;
    return status;
}

/* One round is written while the next one is rendered. */
static int render_rounds(shared_views *s)
{
    round_of_views arguments[2] = {{s, &s->rounds[0]}, {s, &s->rounds[1]}};
    int status = 0, now = 1;
    for (long first = 0; first < s->all && !s->failed && !status;) {
        now = !now;
        draw_round(s, &s->rounds[now], first);
        first += s->rounds[now].count;
        status = finish_round(s, &s->rounds[!now]);
        s->rounds[now].writing = !status && !s->failed && first < s->all &&
                                 !pthread_create(&s->rounds[now].writer, 0, write_round, &arguments[now]);
        if (!status && !s->rounds[now].writing)
            write_round(&arguments[now]);
    }
    return status ? status : finish_round(s, &s->rounds[now]);
}

/* ---- Outputs ----------------------------------------------------------------------------------------------------- */

static int check_patterns(const shared_views *s, int film)
{
    const render_options *o = s->o;
    const char *const names[] = {film ? 0 : o->output, o->depth, o->ids, o->expect, o->diff};
    if (film && is_pattern(o->output))
        return fail(EXIT_USAGE, "%s: a film is one file, expected a name without %%", o->output);
    for (int i = 0; i < 5; i++)
        if (names[i] && s->all > 1 && !is_pattern(names[i]))
            return fail(EXIT_USAGE, "%s: for %ld views, expected a name with one %%d, as out/%%04d.png", names[i],
                        s->all);
    if (o->has_expected_hash && s->all > 1)
        return fail(EXIT_USAGE, "--expect: a hash is of one view, not of %ld", s->all);
    return 0;
}

/* What the library has not opened yet is the expected picture. */
static void tell_files(const shared_views *s, int film, long index)
{
    const render_options *o = s->o;
    const char *const outputs[] = {film && index ? 0 : o->output, o->depth, o->ids, o->diff};
    char name[4096];
    for (int i = 0; i < 4; i++)
        if (outputs[i]) {
            name_file(name, sizeof name, outputs[i], index);
            files_write(name);
        }
    if (o->expect) {
        name_file(name, sizeof name, o->expect, index);
        files_read(name);
    }
}

/* All frames have one size. */
static int open_film(shared_views *s)
{
    const render_options *o = s->o;
    const int eyes = o->frame.stereo > 0 ? 2 : 1, rate = o->rate ? o->rate : 30;
    const fxs_file_view *first = s->views;
    fxs_message why;
    for (long i = 1; i < s->all && !o->has_scissor; i++)
        if (s->views[i].width != first->width || s->views[i].height != first->height)
            return fail(EXIT_USAGE, "%s: the frames of a film have one size, view %s is %dx%d, view %s %dx%d: give "
                        "--size", o->output, first->name, first->width, first->height, s->views[i].name,
                        s->views[i].width, s->views[i].height);
    const int width = o->has_scissor ? o->scissor[2] : eyes * first->width;
    const int height = o->has_scissor ? o->scissor[3] : first->height;
    return fxs_film_open(&s->film, o->output, s->encoding, width, height, rate, &why)
               ? fail(EXIT_FAILED, "%s", why.text) : 0;
}

static int render_all(shared_views *s)
{
    const render_options *o = s->o;
    fxs_message why;
    s->encoding = o->encoding ? o->encoding : s->all > 1 ? FXS_IMAGE_Y4M : FXS_IMAGE_PNG;
    const int film = o->output && (!strcmp(o->output, "-") || s->encoding >= FXS_IMAGE_Y4M);
    int status = check_patterns(s, film);
    for (long i = 0; i < s->all && !status; i++)
        tell_files(s, film, i);
    if (!status)
        status = files_check(FILES_REFUSE);
    if (!status && o->rate && (!film || s->encoding != FXS_IMAGE_Y4M))
        status = fail(EXIT_USAGE, "--fps is of .y4m");
    if (!status && film)
        status = open_film(s);
    if (!status)
        status = render_rounds(s);
    progress_end();
    if (fxs_film_close(s->film, !status, &why) && !status)
        status = fail(EXIT_FAILED, "%s", why.text);
    return status ? status : s->unexpected;
}

/* ---- All of it --------------------------------------------------------------------------------------------------- */

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
        r->has_scissor = s->o->has_scissor;
        memcpy(r->scissor, s->o->scissor, sizeof r->scissor);
    }
    s->round_most = threads < DRAWN_MOST ? (long)threads : DRAWN_MOST;
    for (int i = 0; i < 2; i++)
        s->rounds[i].drawn = calloc((size_t)s->round_most, sizeof *s->rounds[i].drawn);
    if (!status && (!s->rounds[0].drawn || !s->rounds[1].drawn))
        status = fail(EXIT_FAILED, "out of memory");
    if (!status && (!(s->pool = fxs_pool_create(threads)) || !(s->writers = fxs_pool_create(threads))))
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
    for (int i = 0; i < 2; i++) {
        for (long k = 0; k < s->round_most && s->rounds[i].drawn; k++) {
            picture_free(&s->rounds[i].drawn[k].picture);
            fxs_encoded_free(&s->rounds[i].drawn[k].encoded);
        }
        free(s->rounds[i].drawn);
    }
    fxs_pool_destroy(s->pool);
    fxs_pool_destroy(s->writers);
}

int render_views(const render_options *o)
{
    static shared_views s;
    world w = {.count = 0};
    fxs_file_view *views = 0;
    s = (shared_views){.o = o, .world = &w};
    int status = open_renderers(&s, &o->frame);
    if (!status)
        status = world_open(&w, &o->frame.world, &o->frame.load);
    if (!status) {
        s.all = choose_views(&o->frame, &w, &views);
        s.views = views;
        status = s.all < 0 ? EXIT_FAILED : render_all(&s);
    }
    close_renderers(&s);
    free(views);
    world_close(&w);
    return status;
}
