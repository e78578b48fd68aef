/* Renders the views of `fixsplat render` in rounds of several views. While a round is rendered, a thread encodes,
   writes and compares the previous round. */
#include "cmd_render.h"

#include <inttypes.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "src/image/depth_file.h"
#include <fixsplat/image.h>
#include <fixsplat/internal/film.h>
#include <fixsplat/system.h>
#include "src/image/panorama.h"
#include "src/camera/lens_warp.h"
#include "file_guard.h"
#include "metrics.h"
#include "samples.h"
#include "views.h"
#include "walls.h"

typedef struct drawn_view {
    picture picture;
    int status, unwritten, unexpected;
    fxs_message why;
    fxs_stats stats;
    uint64_t hash;
    double range;
    fxs_encoded encoded;
    char depth_name[4096];
} drawn_view;

enum { DRAWN_MOST = 64 };

/* A round of rendered views, with a picture for each thread. Its pictures are written while the next round is
   rendered. */
typedef struct drawn_round {
    drawn_view *drawn;
    long first, count;
    pthread_t writer;
    int writing;                            /* 1: the writer thread must be joined */
} drawn_round;

typedef struct batch {
    const render_options *o;
    const world *world;
    const fxs_view *views;
    const fxs_lens *lenses;                 /* lenses of the views; null: pinhole cameras */
    long picture_count;
    long view_count;                        /* views that the pictures share */
    int moments;                            /* views of each of them, with motion blur; else 1 */
    times_option times;
    rate_option rate;
    renderer renderers[DEVICES_MOST];
    picture faces[DEVICES_MOST][FXS_PANORAMA_FACES];    /* for each device, pictures of the cube faces of a panorama */
    picture samples[DEVICES_MOST];
    light_sums sums[DEVICES_MOST];
    light_codes codes;
    double focus;                           /* depth of a film's focus; 0: of each view */
    int devices;
    fxs_pool *pool, *writers;
    drawn_round rounds[2];
    long round_most;
    enum fxs_image_format encoding;
    fxs_film *film;                         /* output of a film; null: a file for each view */
    int failed;
    int unexpected;                         /* 1: a view differs from its expected picture */
} batch;

typedef struct round_of_batch {
    batch *batch;
    drawn_round *round;
} round_of_batch;

/* A picture to draw, or one sample of it. */
typedef struct shot {
    long number;                            /* of the picture */
    long view_number;
    fxs_view view;
    fxs_options options;
} shot;

/* Makes a sample of a picture. Its view is that of the picture's share of the views, its moment that of the frame. */
static shot shot_of(const batch *b, long number, int sample)
{
    const frame_options *f = &b->o->frame;
    const double open = f->shutter / 360 * ((sample + 0.5) / f->samples - 0.5);
    shot s = {.number = number, .options = f->render};
    s.view_number = number * b->view_count / b->picture_count;
    s.view = b->views[s.view_number * b->moments + sample % b->moments];
    if (b->times.given)
        s.options.time_q32 = seconds_q32(times_at(&b->times, (double)number + open));
    return s;
}

/* A panorama, or a strip of it, that jobs of 16 rows assemble from its cube faces. */
typedef struct panorama {
    uint8_t *pixels;
    int width, height, strip, strips;
    fxs_panorama_part parts[FXS_PANORAMA_FACES];
} panorama;

enum { PANORAMA_ROWS = 16 };

static void join_rows(void *argument, uint32_t job)
{
    const panorama *p = argument;
    const int first = (int)job * PANORAMA_ROWS, end = first + PANORAMA_ROWS;
    fxs_panorama_rows(p->pixels, p->width, p->height, p->parts, p->strip, p->strips, first,
                      end < p->height ? end : p->height);
}

static size_t bytes_of(const picture *p)
{
    return (size_t)p->width * (size_t)p->height * 4;
}

static int make_pixels(picture *out, int width, int height)
{
    const size_t bytes = (size_t)width * (size_t)height * 4;
    if (out->pixel_room < bytes) {
        free(out->pixels);
        out->pixels = malloc(bytes);
        out->pixel_room = out->pixels ? bytes : 0;
    }
    out->width = width;
    out->height = height;
    return out->pixels ? 0 : fail(EXIT_FAILED, "out of memory: a picture of %dx%d", width, height);
}

/* Draws the parts of cube faces that a panorama or strip needs, and its pixels. */
static int draw_strip(batch *b, int device, const shot *s, const fxs_view *view, panorama *p)
{
    renderer *r = &b->renderers[device];
    fxs_panorama_parts(p->width, p->height, p->strip, p->strips, p->parts);
    for (int i = 0; i < FXS_PANORAMA_FACES; i++) {
        fxs_panorama_part *part = &p->parts[i];
        fxs_view face;
        if (!part->width)
            continue;
        r->has_scissor = p->strips > 1;
        if (r->has_scissor)
            memcpy(r->scissor, (int[4]){part->x, part->y, part->width, part->height}, sizeof r->scissor);
        fxs_panorama_face(view, i, p->width, &face);
        if (renderer_render(r, b->world, &face, &s->options, &b->faces[device][i], 0))
            return EXIT_FAILED;
        part->rgba = b->faces[device][i].pixels;
    }
    fxs_pool_run(b->pool, join_rows, p, (uint32_t)((p->height + PANORAMA_ROWS - 1) / PANORAMA_ROWS));
    return 0;
}

/* Draws a panorama: whole, or of two eyes, the left one above the right one, in strips. */
static int draw_panorama(batch *b, int device, const shot *s, picture *out)
{
    const fxs_view *view = &s->view;
    const double stereo = b->o->frame.stereo;
    const int eyes = stereo > 0 ? 2 : 1, strips = stereo > 0 ? FXS_PANORAMA_STRIPS : 1;
    panorama p = {.width = view->width, .height = view->height, .strips = strips};
    if (make_pixels(out, view->width, eyes * view->height))
        return EXIT_FAILED;
    for (int i = 0; i < eyes * strips; i++) {
        const int eye = i / strips;
        fxs_view moved = *view;
        p.strip = i % strips;
        p.pixels = out->pixels + (size_t)eye * bytes_of(out) / 2;
        if (strips > 1)
            fxs_panorama_aside(view, p.strip, strips, (eye - 0.5) * stereo, &moved);
        if (draw_strip(b, device, s, &moved, &p))
            return EXIT_FAILED;
        if (device == 0)
            progress_bar("rendering", ((double)s->number + (i + 1.0) / (eyes * strips)) / (double)b->picture_count);
    }
    return 0;
}

/* A picture that jobs of 16 rows warp through a lens. */
typedef struct bent {
    fxs_lens_warp warp;
    const uint8_t *straight;
    uint8_t outside[4];
    picture *out;
} bent;

static void bend_rows(void *argument, uint32_t job)
{
    const bent *d = argument;
    const int first = (int)job * PANORAMA_ROWS, height = d->out->height;
    fxs_lens_warp_rows(&d->warp, d->straight, d->outside, d->out->pixels, first,
                       first + PANORAMA_ROWS < height ? first + PANORAMA_ROWS : height);
}

static int draw_bent(batch *b, int device, const shot *s, picture *out)
{
    const fxs_view *view = &s->view;
    const fxs_options *options = &s->options;
    picture *straight = &b->faces[device][0];
    bent *d = calloc(1, sizeof *d);
    int status = d ? 0 : fail(EXIT_FAILED, "out of memory: a lens");
    if (!status) {
        fxs_lens_warp_make(&d->warp, &b->lenses[s->view_number], view);
        if (b->o->format != FXS_FORMAT_RGBA8_COVERAGE) {
            memcpy(d->outside, options->background, 3);
            d->outside[3] = 255;
        }
        status = renderer_render(&b->renderers[device], b->world, &d->warp.cover, options, straight, 0) ||
                 make_pixels(out, view->width, view->height) ? EXIT_FAILED : 0;
    }
    if (!status) {
        d->straight = straight->pixels;
        d->out = out;
        fxs_pool_run(b->pool, bend_rows, d, (uint32_t)((view->height + PANORAMA_ROWS - 1) / PANORAMA_ROWS));
    }
    free(d);
    return status;
}

/* Draws one sample of a picture, or the whole picture if it has one only. */
static int draw_sample(batch *b, int device, const shot *s, picture *out, fxs_stats *stats)
{
    if (b->o->frame.panorama)
        return draw_panorama(b, device, s, out);
    if (b->lenses && !fxs_lens_is_pinhole(&b->lenses[s->view_number]))
        return draw_bent(b, device, s, out);
    return renderer_render(&b->renderers[device], b->world, &s->view, &s->options, out, stats);
}

/* The sums of a picture's samples, which jobs add to. */
typedef struct summing {
    batch *b;
    int device, sample;
    picture *out;                           /* gets the mean; null: jobs add a sample */
} summing;

enum { SUMMING_BYTES = 1 << 16 };

static void sum_part(void *argument, uint32_t job)
{
    const summing *s = argument;
    const picture *sample = &s->b->samples[s->device];
    const size_t first = (size_t)job * SUMMING_BYTES, left = bytes_of(sample) - first;
    const size_t count = left < SUMMING_BYTES ? left : SUMMING_BYTES;
    if (s->out)
        light_mean(&s->b->sums[s->device], &s->b->codes, s->sample, first, count, s->out->pixels);
    else
        light_add(&s->b->sums[s->device], &s->b->codes, sample->pixels, first, count, s->sample);
}

static int sum(summing *s)
{
    const size_t bytes = bytes_of(&s->b->samples[s->device]);
    light_sums *sums = &s->b->sums[s->device];
    if (sums->room < bytes) {
        free(sums->sums);
        sums->sums = calloc(bytes, sizeof *sums->sums);
        sums->room = sums->sums ? bytes : 0;
    }
    if (!sums->sums)
        return fail(EXIT_FAILED, "out of memory: sums of %zu bytes", bytes * sizeof *sums->sums);
    fxs_pool_run(s->b->pool, sum_part, s, (uint32_t)((bytes + SUMMING_BYTES - 1) / SUMMING_BYTES));
    return 0;
}

/* Finds the depth in the middle of a picture. A scene that is only partly in memory is drawn first, to load what is
   there. Returns 0 on failure. */
static double focus_on(batch *b, int device, const shot *s)
{
    renderer *r = &b->renderers[device];
    const fxs_view *view = &s->view;
    const fxs_options *options = &s->options;
    fxs_pick_result p;
    if (b->o->frame.focus > 0)
        return b->o->frame.focus;
    if (world_is_paged(b->world) && renderer_render(r, b->world, view, options, &b->samples[device], 0))
        return 0;
    const int found = renderer_pick(r, b->world, view, options, view->width / 2, view->height / 2, &p);
    if (!found)
        fail(EXIT_FAILED, "view %s: nothing is in the middle: give --focus DEPTH", view->name);
    return found > 0 ? (double)p.depth_q32 / 4294967296.0 : 0;
}

/* Draws a picture that is the mean of its samples. */
static int draw_mean(batch *b, int device, long number, picture *out)
{
    const frame_options *f = &b->o->frame;
    const shot first = shot_of(b, number, 0);
    picture *sample = &b->samples[device];
    summing s = {.b = b, .device = device};
    const double focus = f->aperture > 0 && !(b->focus > 0) ? focus_on(b, device, &first) : b->focus;
    if (f->aperture > 0 && !(focus > 0))
        return EXIT_FAILED;
    for (; s.sample < f->samples; s.sample++) {
        shot part = shot_of(b, number, s.sample);
        if (f->aperture > 0)
            lens_move(&part.view, f->aperture, focus, s.sample, f->samples);
        if (draw_sample(b, device, &part, sample, 0) || sum(&s))
            return EXIT_FAILED;
        if (device == 0)
            progress_bar("rendering", ((double)number + (s.sample + 1.0) / f->samples) / (double)b->picture_count);
    }
    s.out = out;
    return make_pixels(out, sample->width, sample->height) || sum(&s) ? EXIT_FAILED : 0;
}

static void draw_views(void *argument, uint32_t device)
{
    const round_of_batch *r = argument;
    batch *b = r->batch;
    for (long i = (long)device; i < r->round->count; i += b->devices) {
        drawn_view *d = &r->round->drawn[i];
        const long number = r->round->first + i;
        const shot s = shot_of(b, number, 0);
        d->status = b->o->frame.shutter > 0 || b->o->frame.aperture > 0
                        ? draw_mean(b, (int)device, number, &d->picture)
                        : draw_sample(b, (int)device, &s, &d->picture, &d->stats);
        if (d->status)
            break;
        if (device == 0 && b->picture_count > 1)
            progress_bar("rendering", (double)(number + 1) / (double)b->picture_count);
    }
}

static uint64_t fnv1a64(const uint8_t *bytes, size_t count)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < count; i++)
        hash = (hash ^ bytes[i]) * 0x100000001b3u;
    return hash;
}

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
    name_numbered(name, sizeof name, o->expect, index);
    d->unexpected = fxs_image_file_read(name, &expected, &width, &height, &d->why) != 0;
    if (d->unexpected)
        return;
    d->unexpected = width != p->width || height != p->height || memcmp(expected, p->pixels, bytes_of(p));
    if (width != p->width || height != p->height) {
        fxs_fail(&d->why, "%s is %dx%d, the picture %dx%d", name, width, height, p->width, p->height);
    } else if (d->unexpected) {
        say_difference(d, name, expected);
        if (o->diff) {
            name_numbered(difference, sizeof difference, o->diff, index);
            d->unwritten = fxs_metrics_difference(difference, expected, p->pixels, p->width, p->height, &d->why);
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

static int write_depths(const render_options *o, drawn_view *d, long index)
{
    const fxs_depths depths = {d->picture.depths, d->picture.width, d->picture.height, d->picture.depth_bits};
    d->range = o->depth_range > 0 ? o->depth_range : fxs_depths_farthest(&depths);
    d->range = d->range > 0 ? d->range : 1;
    name_numbered(d->depth_name, sizeof d->depth_name, o->depth, index);
    return fxs_depth_file_write(d->depth_name, &depths, d->range, &d->why);
}

static int write_picture(const batch *b, drawn_view *d, long index)
{
    const picture *p = &d->picture;
    char name[4096];
    fxs_message why;
    name_numbered(name, sizeof name, b->o->output, index);
    int error = fxs_image_encode(b->encoding, b->o->quality, p->pixels, p->width, p->height, &d->encoded, &why);
    if (!error && b->o->frame.panorama && !(b->o->frame.stereo > 0) && b->encoding == FXS_IMAGE_JPG &&
        fxs_panorama_mark(&d->encoded, p->width, p->height))
        error = fxs_fail_memory(&why, 0, 0);
    if (error)
        return fxs_fail_as(error, &d->why, "%s: %s", name, why.text);
    return b->film ? 0 : fxs_encoded_write(name, &d->encoded, &d->why);
}

static void write_view(void *argument, uint32_t i)
{
    const round_of_batch *r = argument;
    const render_options *o = r->batch->o;
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
        d->unwritten = write_picture(r->batch, d, index);
    if (o->depth && !d->unwritten)
        d->unwritten = write_depths(o, d, index);
    if (o->ids && !d->unwritten) {
        name_numbered(name, sizeof name, o->ids, index);
        d->unwritten = fxs_id_file_write(name, p->ids, p->width, p->height, r->batch->world->count > 1, &d->why);
    }
    if (o->expect && !d->unwritten)
        compare_with_file(o, d, index);
    else if (o->has_expected_hash && !d->unwritten)
        compare_with_hash(o, d);
}

/* Encodes and writes the pictures of a round. After a failed frame, no later frame of a film is written. */
static void *write_round(void *argument)
{
    round_of_batch *r = argument;
    batch *b = r->batch;
    fxs_pool_run(b->writers, write_view, r, (uint32_t)r->round->count);
    int stopped = 0;
    for (long i = 0; i < r->round->count; i++) {
        drawn_view *d = &r->round->drawn[i];
        stopped |= d->status || d->unwritten;
        if (b->film && !stopped)
            stopped = d->unwritten = fxs_film_write(b->film, &d->encoded, &d->why);
    }
    return 0;
}

/* Prints the results of a rendered view. Call in ascending order of views. */
static int report_view(batch *b, const drawn_view *d, const shot *s)
{
    const render_options *o = b->o;
    if (d->status)
        return d->status;
    if (d->unwritten)
        return b->failed ? EXIT_FAILED : fail(EXIT_FAILED, "%s", d->why.text);
    if (o->hash || o->depth || o->frame.panorama)
        progress_end();
    if (d->unexpected)
        b->unexpected = fail(EXIT_FAILED, "%s", d->why.text);
    if (o->hash)
        printf("%016" PRIx64 "\n", d->hash);
    if (o->depth && !(o->depth_range > 0) && ends_with(o->depth, ".png"))
        printf("%s: 65535 is a depth of %.9g\n", d->depth_name, d->range);
    if (o->has_pick && print_pick(&b->renderers[0], o, b->world, &s->view, &s->options))
        return EXIT_FAILED;
    return o->stats ? print_stats(&b->renderers[0], o, b->world, &s->view, &s->options, &d->stats) : 0;
}

static void draw_round(batch *b, drawn_round *round, long first)
{
    round_of_batch argument = {b, round};
    round->first = first;
    round->count = b->picture_count - first < b->round_most ? b->picture_count - first : b->round_most;
    for (long i = 0; i < round->count; i++)
        round->drawn[i].status = EXIT_FAILED;
    if (b->devices == 1)
        draw_views(&argument, 0);               /* drawn by this thread, to which the OpenGL context belongs */
    else
        fxs_pool_run(b->pool, draw_views, &argument, (uint32_t)(round->count < b->devices ? round->count : b->devices));
    for (long i = 0; i < round->count; i++)
        b->failed |= round->drawn[i].status;
}

static int finish_round(batch *b, drawn_round *round)
{
    int status = 0;
    if (round->writing)
        pthread_join(round->writer, 0);
    round->writing = 0;
    for (long i = 0; i < round->count && !status; i++) {
        const shot s = shot_of(b, round->first + i, 0);
        status = report_view(b, &round->drawn[i], &s);
    }
    round->count = 0;
    return status;
}

static int render_rounds(batch *b)
{
    round_of_batch arguments[2] = {{b, &b->rounds[0]}, {b, &b->rounds[1]}};
    int status = 0, now = 1;
    for (long first = 0; first < b->picture_count && !b->failed && !status;) {
        now = !now;
        draw_round(b, &b->rounds[now], first);
        first += b->rounds[now].count;
        status = finish_round(b, &b->rounds[!now]);
        b->rounds[now].writing = !status && !b->failed && first < b->picture_count &&
                                 !pthread_create(&b->rounds[now].writer, 0, write_round, &arguments[now]);
        if (!status && !b->rounds[now].writing)
            write_round(&arguments[now]);
    }
    return status ? status : finish_round(b, &b->rounds[now]);
}

static int check_patterns(const batch *b, int film)
{
    const render_options *o = b->o;
    const char *const names[] = {film ? 0 : o->output, o->depth, o->ids, o->expect, o->diff};
    if (film && is_pattern(o->output))
        return fail(EXIT_USAGE, "%s: a film is one file, expected a name without %%", o->output);
    for (int i = 0; i < 5; i++)
        if (names[i] && b->picture_count > 1 && !is_pattern(names[i]))
            return fail(EXIT_USAGE, "%s: for %ld views, expected a name with one %%d, as out/%%04d.png", names[i],
                        b->picture_count);
    if (o->has_expected_hash && b->picture_count > 1)
        return fail(EXIT_USAGE, "--expect: a hash is of one view, not of %ld", b->picture_count);
    return 0;
}

static void tell_files(const batch *b, int film, long index)
{
    const render_options *o = b->o;
    const char *const outputs[] = {film && index ? 0 : o->output, index ? 0 : o->cameras, o->depth, o->ids, o->diff};
    char name[4096];
    for (int i = 0; i < 5; i++)
        if (outputs[i]) {
            name_numbered(name, sizeof name, outputs[i], index);
            files_write(name);
        }
    if (o->expect) {
        name_numbered(name, sizeof name, o->expect, index);
        files_read(name);
    }
}

static int open_film(batch *b)
{
    const render_options *o = b->o;
    const int eyes = o->frame.stereo > 0 ? 2 : 1, across = o->frame.panorama ? 1 : eyes;
    const fxs_view *first = b->views;
    fxs_message why;
    for (long i = 1; i < b->view_count && !o->has_scissor; i++)
        if (b->views[i].width != first->width || b->views[i].height != first->height)
            return fail(EXIT_USAGE, "%s: the frames of a film have one size, view %s is %dx%d, view %s %dx%d: give "
                        "--size", o->output, first->name, first->width, first->height, b->views[i].name,
                        b->views[i].width, b->views[i].height);
    const int width = o->has_scissor ? o->scissor[2] : across * first->width;
    const int height = o->has_scissor ? o->scissor[3] : eyes / across * first->height;
    return fxs_film_open_rate(&b->film, o->output, b->encoding, width, height, b->rate, &why)
               ? fail_for(&why) : 0;
}

static int focus_film(batch *b)
{
    const shot first = shot_of(b, 0, views_per_frame(&b->o->frame) / 2);
    b->focus = focus_on(b, 0, &first);
    return b->focus > 0 ? 0 : EXIT_FAILED;
}

static int render_all(batch *b)
{
    const render_options *o = b->o;
    fxs_message why;
    b->encoding = o->encoding ? o->encoding : b->picture_count > 1 ? FXS_IMAGE_Y4M : FXS_IMAGE_PNG;
    const int film = o->output && (!strcmp(o->output, "-") || b->encoding >= FXS_IMAGE_Y4M);
    int status = check_patterns(b, film);
    for (long i = 0; i < b->picture_count && !status; i++)
        tell_files(b, film, i);
    if (!status)
        status = files_check();
    const int has_rate = b->encoding == FXS_IMAGE_Y4M || b->encoding > FXS_IMAGE_RGBA;
    if (!status && is_given("fps") && !o->frame.path && !b->times.given && (!film || !has_rate))
        status = fail(EXIT_USAGE, "--fps is for .y4m, .mp4, .webm and .gif, and for --path and --times");
    if (!status && o->cameras && fxs_camera_file_write(o->cameras, b->views, (size_t)b->view_count, &why))
        status = fail_for(&why);
    if (!status && film)
        status = open_film(b);
    if (!status && o->frame.aperture > 0 && (o->frame.orbit || o->frame.path || b->times.given))
        status = focus_film(b);
    if (!status && render_draws(o))
        status = render_rounds(b);
    progress_end();
    if (fxs_film_close(b->film, !status, &why) && !status)
        status = fail_for(&why);
    return status ? status : b->unexpected;
}

static int open_renderers(batch *b, const frame_options *options)
{
    int devices[DEVICES_MOST], count = choose_devices(options, devices), status = 0;
    const uint32_t threads = options->threads < (uint32_t)count ? (uint32_t)count : options->threads;
    while (b->devices < count && !status) {
        frame_options own = *options;
        renderer *r = &b->renderers[b->devices];
        own.devices[0] = devices[b->devices++];
        own.device_count = 1;
        status = renderer_open(r, &own);
        r->stereo = options->panorama ? 0 : r->stereo;
        r->format = b->o->format;
        r->draws = b->o->draws;
        r->has_scissor = b->o->has_scissor;
        memcpy(r->scissor, b->o->scissor, sizeof r->scissor);
    }
    b->round_most = threads < DRAWN_MOST ? (long)threads : DRAWN_MOST;
    for (int i = 0; i < 2; i++)
        b->rounds[i].drawn = calloc((size_t)b->round_most, sizeof *b->rounds[i].drawn);
    if (!status && (!b->rounds[0].drawn || !b->rounds[1].drawn))
        status = fail(EXIT_FAILED, "out of memory");
    if (!status && (!(b->pool = fxs_pool_create(threads)) || !(b->writers = fxs_pool_create(threads))))
        status = fail(EXIT_FAILED, "cannot start %u threads", threads);
    return status;
}

static void close_renderers(batch *b)
{
    for (int i = 0; i < b->devices; i++) {
        renderer_close(&b->renderers[i]);
        for (int k = 0; k < FXS_PANORAMA_FACES; k++)
            picture_free(&b->faces[i][k]);
        picture_free(&b->samples[i]);
        free(b->sums[i].sums);
    }
    for (int i = 0; i < 2; i++) {
        for (long k = 0; k < b->round_most && b->rounds[i].drawn; k++) {
            picture_free(&b->rounds[i].drawn[k].picture);
            fxs_encoded_free(&b->rounds[i].drawn[k].encoded);
        }
        free(b->rounds[i].drawn);
    }
    fxs_pool_destroy(b->pool);
    fxs_pool_destroy(b->writers);
}

/* Counts the pictures: a frame for each time, else one of each view. */
static int count_pictures(batch *b, const frame_options *frame)
{
    const fxs_time time = world_time(b->world);
    b->moments = frame->orbit || frame->path ? views_per_frame(frame) : 1;
    b->view_count /= b->moments;
    b->times = frame->times;
    memcpy(b->rate, frame->rate, sizeof b->rate);
    b->picture_count = b->times.given ? times_settle(&b->times, b->rate, &time, b->world->placed.files[0])
                                      : b->view_count;
    return b->picture_count < 0 ? EXIT_FAILED : 0;
}

int render_views(const render_options *o)
{
    static batch b;
    world w = {.count = 0};
    frame_options frame = o->frame;
    fxs_view *views = 0;
    fxs_lens *lenses = 0;
    b = (batch){.o = o, .world = &w};
    int status = open_renderers(&b, &o->frame);
    frame.load.budget = b.devices == 1 && renderer_pages(&b.renderers[0]) ? frame.render.budget : 0;
    if (!status)
        status = world_open(&w, &o->frame.world, &frame.load);
    if (!status && b.devices > 1 && world_is_paged(&w))
        status = fail(EXIT_USAGE, "a scene in a pool, or from a server, is drawn by one device: --device 0");
    if (!status) {
        b.view_count = choose_views(&frame, &w, &views, &lenses);
        status = b.view_count < 0 ? EXIT_FAILED : count_pictures(&b, &frame);
    }
    if (!status) {
        b.views = views;
        light_codes_make(&b.codes, o->format != FXS_FORMAT_RGBA8_COVERAGE);
        b.lenses = frame.lens ? lenses : 0;
        if (frame.path)
            say_walls(&b.renderers[0], &w, &frame, views, b.view_count);
        status = render_all(&b);
    }
    close_renderers(&b);
    free(views);
    free(lenses);
    world_close(&w);
    return status;
}
