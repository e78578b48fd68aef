#include "quality.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "views.h"

#define FARTHEST 134000000.0        /* a camera may be within 2^27 units */

/* Of a scene and its original, to be compared. */
typedef struct pair {
    const world *worlds[2];
    picture pictures[2];
} pair;

static int measure_view(quality_view *out, renderer *r, pair *p, const fxs_file_view *view, const fxs_options *options)
{
    int status = 0;
    for (int i = 0; i < 2 && !status; i++)
        status = renderer_render(r, p->worlds[i], view, options, &p->pictures[i], 0);
    if (!status && fxs_metrics_compare(p->pictures[0].pixels, p->pictures[1].pixels, view->width, view->height,
                                       &out->metrics))
        status = fail(EXIT_FAILED, "out of memory");
    memcpy(out->name, view->name, sizeof out->name);
    out->width = view->width;
    out->height = view->height;
    return status;
}

/* View i of q->count: one of the file, or the only one, turned about the middle of the scene, nearer to it or farther
   off. */
static fxs_file_view choose(quality *q, long i, const fxs_file_view *views, long given, const frame_options *options,
                            const world *original)
{
    static const struct {
        const char *name;
        double factor;
    } distances[] = {{"middle", 1}, {"close", 0.35}, {"far", 2}};
    double middle[3];
    q->views[i].index = options->cameras ? i * given / q->count : i;
    if (options->cameras)
        return views[q->views[i].index];
    fxs_file_view turned = views[0];
    for (int k = 0; k < 3; k++) {
        middle[k] = (original->inner_low[k] + original->inner_high[k]) / 2;
        turned.position[k] = middle[k] + distances[i % 3].factor * (turned.position[k] - middle[k]);
    }
    fxs_view_orbit(&turned, middle, options->up.at, 6.283185307179586 * (double)i / (double)q->count);
    for (int k = 0; k < 3; k++)
        turned.position[k] = fmin(fmax(turned.position[k], -FARTHEST), FARTHEST);
    snprintf(turned.name, sizeof turned.name, "%.0f degrees, %s", 360.0 * (double)i / (double)q->count,
             distances[i % 3].name);
    return turned;
}

void quality_sum_up(quality *q)
{
    long different = 0;
    q->psnr = q->ssim = 0;
    q->worst_psnr = INFINITY;
    q->worst_ssim = 1;
    for (long i = 0; i < q->count; i++) {
        const struct fxs_metrics *m = &q->views[i].metrics;
        if (m->psnr < q->worst_psnr) {
            q->worst_psnr = m->psnr;
            q->worst_view = i;
        }
        if (m->ssim < q->worst_ssim)
            q->worst_ssim = m->ssim;
        q->ssim += m->ssim / (double)q->count;
        if (!isinf(m->psnr)) {
            q->psnr += m->psnr;
            different++;
        }
    }
    q->psnr = different ? q->psnr / (double)different : INFINITY;
}

static int measure(quality *q, pair *p, const fxs_file_view *views, long given, const frame_options *options)
{
    renderer r;
    char label[] = "comparing";
    int status = renderer_open(&r, options);
    for (long i = 0; i < q->count && !status; i++) {
        fxs_file_view view = choose(q, i, views, given, options, p->worlds[1]);
        progress_bar(label, (double)i / (double)q->count);
        status = measure_view(&q->views[i], &r, p, &view, &options->render);
    }
    progress_end();
    renderer_close(&r);
    picture_free(&p->pictures[0]);
    picture_free(&p->pictures[1]);
    return status;
}

int quality_measure(quality *q, const world *scene, const world *original, const frame_options *options, long wanted)
{
    pair p = {.worlds = {scene, original}};
    frame_options all = *options;
    fxs_file_view *views = 0;
    all.view = "all";
    memset(q, 0, sizeof *q);
    long given = choose_views(&all, original, &views);
    if (given < 0)
        return EXIT_FAILED;
    q->count = options->cameras && given < wanted ? given : wanted;
    q->views = calloc((size_t)q->count, sizeof *q->views);
    int status = q->views ? measure(q, &p, views, given, options) : fail(EXIT_FAILED, "out of memory");
    free(views);
    if (status)
        quality_free(q);
    else
        quality_sum_up(q);
    return status;
}

void quality_print_text(const quality *q)
{
    char psnr[32];
    puts("view                                  size    PSNR, dB      SSIM   largest difference");
    for (long i = 0; i < q->count; i++) {
        const quality_view *v = &q->views[i];
        printf("%4ld %-24.24s %6dx%-6d %9s  %.6f   %d\n", v->index, v->name, v->width, v->height,
               fxs_metrics_psnr(psnr, v->metrics.psnr, "equal"), v->metrics.ssim, v->metrics.largest);
    }
    printf("mean %38s %9s  %.6f\n", "", fxs_metrics_psnr(psnr, q->psnr, "equal"), q->ssim);
    printf("worst %37s %9s  %.6f   view %ld\n", "", fxs_metrics_psnr(psnr, q->worst_psnr, "equal"), q->worst_ssim,
           q->views[q->worst_view].index);
}

void quality_print_json(const quality *q)
{
    char psnr[32];
    printf("{\"views\": [");
    for (long i = 0; i < q->count; i++) {
        const quality_view *v = &q->views[i];
        printf("%s{\"view\": %ld, \"width\": %d, \"height\": %d, \"name\": ", i ? ", " : "", v->index, v->width,
               v->height);
        print_json_string(v->name);
        printf(", \"psnr\": %s, \"ssim\": %.6f, \"largest\": %d}", fxs_metrics_psnr(psnr, v->metrics.psnr, "null"),
               v->metrics.ssim, v->metrics.largest);
    }
    printf("], \"psnr\": %s, \"ssim\": %.6f, ", fxs_metrics_psnr(psnr, q->psnr, "null"), q->ssim);
    printf("\"worst_psnr\": %s, \"worst_ssim\": %.6f, \"worst_view\": %ld}",
           fxs_metrics_psnr(psnr, q->worst_psnr, "null"), q->worst_ssim, q->views[q->worst_view].index);
}

void quality_free(quality *q)
{
    free(q->views);
}
