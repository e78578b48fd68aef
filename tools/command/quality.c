/* Measures the loss of a scene: renders the scene and its original from several views, and compares the pictures. */
#include "quality.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/system.h>
#include <fixsplat/internal/view_more.h>
#include "src/fit/float_scene.h"
#include "views.h"

#define FARTHEST 134000000.0        /* farthest distance of a camera in scene units, below the limit of 2^27 */

typedef struct pair {
    const world *scene;
    fxs_pool *pool;
    fxs_float_scene *floats[2];             /* scene and original as floats; null: it is rendered packed */
    enum fxs_cutoff original_cutoff;
    const quality_options *how;
    int has_moment;                         /* 1: scenes that move are compared at the time `moment`, seconds */
    double moment;
    int moves;                              /* 1: the scene or a file of floats moves */
    picture pictures[3];
} pair;

static int read_floats(fxs_float_scene **floats, pair *p, const float_files *files, uint32_t threads)
{
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_message message;
    load_options load = *files->load;
    if (p->has_moment && !load.has_moment) {
        load.has_moment = 2;
        load.moment = p->moment;
    }
    load.moved = &p->moves;
    load.still = "is not compared with a still one: give --compare-time SECONDS";
    if (open_merged(files->placed, files->name, &load, &file, &info))
        return EXIT_FAILED;
    const int error = fxs_float_scene_read(floats, file, &info, p->pool ? fxs_pool_run : 0, p->pool, threads, &message);
    fxs_scene_file_close(file);
    return error ? fail(EXIT_FAILED, "%s: %s", files->name, message.text) : 0;
}

static int open_pair(pair *p, const float_files *files, const float_files *original, uint32_t threads)
{
    if (threads > 1 && !(p->pool = fxs_pool_create(threads)))
        return fail(EXIT_FAILED, "cannot start %" PRIu32 " threads", threads);
    if (files && read_floats(&p->floats[0], p, files, threads))
        return EXIT_FAILED;
    if (read_floats(&p->floats[1], p, original, threads))
        return EXIT_FAILED;
    return !is_given("compare-time") || p->moves ? 0
           : fail(EXIT_FAILED, "%s: does not move: no --compare-time", original->name);
}

static void close_pair(pair *p)
{
    for (int i = 0; i < 2; i++)
        fxs_float_scene_free(p->floats[i]);
    for (int i = 0; i < 3; i++)
        picture_free(&p->pictures[i]);
    fxs_pool_destroy(p->pool);
}

static void find_middle(double middle[3], const world *scene)
{
    for (int k = 0; k < 3; k++)
        middle[k] = (scene->inner_low[k] + scene->inner_high[k]) / 2;
}

static int draw_floats(fxs_float_scene *floats, const fxs_view *view, enum fxs_cutoff cutoff, picture *out)
{
    fxs_message message;
    picture_free(out);
    out->pixels = malloc(4 * (size_t)view->width * (size_t)view->height);
    if (!out->pixels)
        return fail(EXIT_FAILED, "out of memory");
    return fxs_float_scene_draw(floats, view, cutoff, out->pixels, &message) ? fail_for(&message) : 0;
}

static int compare_pictures(struct fxs_metrics *out, const pair *p, int i, const fxs_view *view)
{
    const uint8_t *drawn = p->pictures[i].pixels, *original = p->pictures[1].pixels;
    int error = 0;
    if (p->how->has_ssim)
        error = fxs_metrics_compare(drawn, original, view->width, view->height, out);
    else
        fxs_metrics_without_ssim(drawn, original, view->width, view->height, out);
    return error ? fail(EXIT_FAILED, "out of memory") : 0;
}

static int measure_nudged(quality_view *out, pair *p, const fxs_view *view)
{
    struct fxs_metrics nudged;
    double middle[3], distance = 0;
    find_middle(middle, p->scene);
    for (int k = 0; k < 3; k++)
        distance = hypot(distance, view->position[k] - middle[k]);
    fxs_float_scene_nudge(p->floats[1], 1e-6 * distance);
    int status = draw_floats(p->floats[1], view, p->original_cutoff, &p->pictures[2]);
    fxs_float_scene_nudge(p->floats[1], 0);
    if (!status)
        status = compare_pictures(&nudged, p, 2, view);
    if (!status)
        out->nudged_psnr = nudged.psnr;
    return status;
}

static int measure_view(quality_view *out, renderer *r, pair *p, const fxs_view *view, const fxs_options *options)
{
    int status = p->floats[0] ? draw_floats(p->floats[0], view, options->cutoff, &p->pictures[0])
                              : renderer_render(r, p->scene, view, options, &p->pictures[0], 0);
    if (!status)
        status = draw_floats(p->floats[1], view, p->original_cutoff, &p->pictures[1]);
    if (!status)
        status = compare_pictures(&out->metrics, p, 0, view);
    out->nudged_psnr = INFINITY;
    if (!status && out->metrics.psnr < p->how->nudge_below)
        status = measure_nudged(out, p, view);
    memcpy(out->name, view->name, sizeof out->name);
    out->width = view->width;
    out->height = view->height;
    return status;
}

/* Chooses view i: from the camera file, or else turned about the scene's middle at one of three distances. */
static fxs_view choose(quality *q, long i, const fxs_view *views, long given, const frame_options *options,
                            const world *scene)
{
    static const struct {
        const char *name;
        double factor;
    } distances[] = {{"middle", 1}, {"close", 0.35}, {"far", 2}};
    double middle[3];
    q->views[i].index = options->cameras ? i * given / q->count : i;
    if (options->cameras)
        return views[q->views[i].index];
    fxs_view turned = views[0];
    find_middle(middle, scene);
    for (int k = 0; k < 3; k++)
        turned.position[k] = middle[k] + distances[i % 3].factor * (turned.position[k] - middle[k]);
    fxs_view_orbit(&turned, middle, options->up.at, 6.283185307179586 * (double)i / (double)q->count);
    for (int k = 0; k < 3; k++)
        turned.position[k] = fmin(fmax(turned.position[k], -FARTHEST), FARTHEST);
    snprintf(turned.name, sizeof turned.name, "%.0f degrees, %s", 360.0 * (double)i / (double)q->count,
             distances[i % 3].name);
    return turned;
}

/* Returns the mean of all finite PSNR values; infinity if all are infinite. */
static double mean_psnr(const quality *q, int is_affine)
{
    long different = 0;
    double sum = 0;
    for (long i = 0; i < q->count; i++) {
        const double psnr = is_affine ? q->views[i].affine_psnr : q->views[i].metrics.psnr;
        sum += isinf(psnr) ? 0 : psnr;
        different += !isinf(psnr);
    }
    return different ? sum / (double)different : INFINITY;
}

/* Returns how far a view of the scene is worse than a view of the nudged (randomly moved) original: nudged_psnr - psnr
   in dB. Infinity: the original was not nudged. */
static double headroom(const quality_view *v)
{
    return isinf(v->nudged_psnr) ? INFINITY : v->nudged_psnr - v->metrics.psnr;
}

const quality_view *quality_nudged(const quality *q)
{
    const quality_view *v = &q->views[q->nudged_view];
    return q->has_nudged && headroom(v) < 6.02 ? v : 0;
}

void quality_sum_up(quality *q)
{
    long with_ssim = 0;
    q->ssim = 0;
    q->worst_psnr = q->worst_affine_psnr = INFINITY;
    q->worst_ssim = 1;
    for (long i = 0; i < q->count; i++) {
        const struct fxs_metrics *m = &q->views[i].metrics;
        if (m->psnr < q->worst_psnr) {
            q->worst_psnr = m->psnr;
            q->worst_view = i;
        }
        if (m->ssim < q->worst_ssim)
            q->worst_ssim = m->ssim;
        if (q->has_nudged && headroom(&q->views[i]) < headroom(&q->views[q->nudged_view]))
            q->nudged_view = i;
        if (q->has_affine)
            q->worst_affine_psnr = fmin(q->worst_affine_psnr, q->views[i].affine_psnr);
        with_ssim += !isnan(m->ssim);
        q->ssim += isnan(m->ssim) ? 0 : m->ssim;
    }
    q->ssim = with_ssim ? q->ssim / (double)with_ssim : NAN;
    q->worst_ssim = with_ssim ? q->worst_ssim : NAN;
    q->psnr = mean_psnr(q, 0);
    q->affine_psnr = q->has_affine ? mean_psnr(q, 1) : 0;
}

static int measure(quality *q, pair *p, const fxs_view *views, long given, const frame_options *options)
{
    renderer r;
    char label[] = "comparing";
    int status = renderer_open(&r, options);
    for (long i = 0; i < q->count && !status; i++) {
        fxs_view view = choose(q, i, views, given, options, p->scene);
        progress_bar(label, (double)i / (double)q->count);
        status = measure_view(&q->views[i], &r, p, &view, &options->render);
    }
    progress_end();
    renderer_close(&r);
    return status;
}

/* Chooses the moment of scenes that move: that of --compare-time, else half of the duration, in the middle of a frame
   of the source. */
static void choose_moment(pair *p, frame_options *options)
{
    const fxs_time time = world_time(p->scene);
    const double half = time.duration / 2;
    p->moves = time.duration > 0;
    p->has_moment = is_given("compare-time") || p->moves;
    p->moment = is_given("compare-time") ? ldexp((double)options->render.time_q32, -32)
                : time.rate > 0          ? (floor(half * time.rate) + 0.5) / time.rate : half;
    options->render.time_q32 = seconds_q32(p->moment);
}

int quality_measure(quality *q, const world *scene, const float_files *files, const float_files *original,
                    enum fxs_cutoff original_cutoff, const frame_options *options, const quality_options *how)
{
    pair p = {.scene = scene, .original_cutoff = original_cutoff, .how = how};
    frame_options all = *options;
    fxs_view *views = 0;
    all.view = "all";
    all.framed = 1;
    choose_moment(&p, &all);
    memset(q, 0, sizeof *q);
    long given = choose_views(&all, scene, &views, 0);
    if (given < 0)
        return EXIT_FAILED;
    q->has_nudged = 1;
    q->count = options->cameras && given < how->views ? given : how->views;
    q->views = calloc((size_t)q->count, sizeof *q->views);
    int status = q->views ? open_pair(&p, files, original, options->threads) : fail(EXIT_FAILED, "out of memory");
    if (!status)
        status = measure(q, &p, views, given, &all);
    close_pair(&p);
    free(views);
    if (status)
        quality_free(q);
    else
        quality_sum_up(q);
    return status;
}

static const char *print_psnr(char text[80], const quality *q, double psnr, double affine)
{
    char plain[32], mapped[32] = "";
    if (q->has_affine)
        fxs_metrics_psnr(mapped, affine, "equal");
    snprintf(text, 80, q->has_affine ? "%9s %11s" : "%9s", fxs_metrics_psnr(plain, psnr, "equal"), mapped);
    return text;
}

void quality_print_text(const quality *q)
{
    char psnr[80], ssim[32];
    printf("view                                  size    PSNR, dB  %s    SSIM   largest difference\n",
           q->has_affine ? "affine, dB  " : "");
    for (long i = 0; i < q->count; i++) {
        const quality_view *v = &q->views[i];
        printf("%4ld %-24.24s %6dx%-6d %s  %8s   %d\n", v->index, v->name, v->width, v->height,
               print_psnr(psnr, q, v->metrics.psnr, v->affine_psnr), fxs_metrics_ssim(ssim, v->metrics.ssim, "none"),
               v->metrics.largest);
    }
    printf("mean %38s %s  %8s\n", "", print_psnr(psnr, q, q->psnr, q->affine_psnr),
           fxs_metrics_ssim(ssim, q->ssim, "none"));
    printf("worst %37s %s  %8s   view %ld\n", "", print_psnr(psnr, q, q->worst_psnr, q->worst_affine_psnr),
           fxs_metrics_ssim(ssim, q->worst_ssim, "none"), q->views[q->worst_view].index);
    const quality_view *nudged = quality_nudged(q);
    if (nudged)
        printf("nudged %36s %s             view %ld of the original, each Gaussian moved by 1e-6 of the distance\n", "",
               print_psnr(psnr, q, nudged->nudged_psnr, 0), nudged->index);
}

static void end_json(const quality *q, double affine_psnr)
{
    char text[32];
    if (q->has_affine)
        printf(", \"affine_psnr\": %s", fxs_metrics_psnr(text, affine_psnr, "null"));
    putchar('}');
}

void quality_print_json(const quality *q)
{
    char psnr[32], ssim[32];
    printf("{\"views\": [");
    for (long i = 0; i < q->count; i++) {
        const quality_view *v = &q->views[i];
        printf("%s{\"view\": %ld, \"width\": %d, \"height\": %d, \"name\": ", i ? ", " : "", v->index, v->width,
               v->height);
        print_json_string(v->name);
        printf(", \"psnr\": %s, \"ssim\": %s, \"largest\": %d", fxs_metrics_psnr(psnr, v->metrics.psnr, "null"),
               fxs_metrics_ssim(ssim, v->metrics.ssim, "null"), v->metrics.largest);
        if (q->has_nudged)
            printf(", \"nudged_psnr\": %s", fxs_metrics_psnr(psnr, v->nudged_psnr, "null"));
        end_json(q, v->affine_psnr);
    }
    printf("], \"psnr\": %s, \"ssim\": %s, ", fxs_metrics_psnr(psnr, q->psnr, "null"),
           fxs_metrics_ssim(ssim, q->ssim, "null"));
    printf("\"worst_psnr\": %s, \"worst_ssim\": %s, \"worst_view\": %ld",
           fxs_metrics_psnr(psnr, q->worst_psnr, "null"), fxs_metrics_ssim(ssim, q->worst_ssim, "null"),
           q->views[q->worst_view].index);
    end_json(q, q->affine_psnr);
}

void quality_free(quality *q)
{
    free(q->views);
}
