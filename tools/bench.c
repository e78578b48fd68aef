/* fixsplat bench */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "command.h"

static const char help[] =
    "Usage: fixsplat bench SCENE [OPTION...]\n\n"
    "Renders one view again and again and prints the median milliseconds of each stage.\n\n"
    "  --frames N          frames measured after a warm-up of two, 10 to 10000 (default 10)\n"
    "  --json              print a JSON object\n"
    "%s\n"
    "Examples:\n"
    "  fixsplat bench scene.ply --cameras cameras.json --view 8 --size 1280x720\n"
    "  fixsplat bench scene.ply --threads 1 --cutoff square --json\n";

typedef struct bench_options {
    view_options view;
    const char *scene;
    int frames, json;
} bench_options;

enum { OPT_FRAMES = OPT_OWN, OPT_JSON };

static int take_options(bench_options *o, int argc, char **argv)
{
    static const struct option table[] = {VIEW_OPTIONS, {"frames", required_argument, 0, OPT_FRAMES},
                                          {"json", no_argument, 0, OPT_JSON}, {0, 0, 0, 0}};
    uint64_t frames = 10;
    memset(o, 0, sizeof *o);
    view_options_default(&o->view);
    for (int c; (c = getopt_long(argc, argv, "", table, 0)) != -1;)
        switch (c) {
        case OPT_FRAMES:
            if (!parse_count(optarg, 10, 10000, &frames))
                return fail(EXIT_USAGE, "--frames %s: expected 10 to 10000", optarg);
            break;
        case OPT_JSON: o->json = 1; break;
        case OPT_HELP: printf(help, view_options_help); exit(EXIT_OK);
        case '?': return usage_hint("bench");
        default:
            if (view_option(&o->view, c, optarg))
                return EXIT_USAGE;
        }
    if (optind != argc - 1)
        return fail(EXIT_USAGE, "bench takes one scene file; see: fixsplat bench --help");
    o->scene = argv[optind];
    o->frames = (int)frames;
    return 0;
}

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, int count)
{
    qsort(values, (size_t)count, sizeof *values, compare_doubles);
    return (values[(count - 1) / 2] + values[count / 2]) / 2;
}

/* Columns: the stages, then the whole frame. */
static int measure(double medians[FXS_STAGES + 1], renderer *r, const bench_options *o, const loaded_scene *loaded,
                   const fxs_file_view *view)
{
    enum { WARM_UP = 2 };
    int frames = o->frames, status = 0;
    double *times = malloc((size_t)frames * (FXS_STAGES + 1) * sizeof *times);
    if (!times)
        return fail(EXIT_FAILED, "out of memory");
    for (int i = -WARM_UP; i < frames && !status; i++) {
        fxs_stats stats;
        status = renderer_render(r, loaded, view, &o->view.render, &stats);
        for (int s = 0; s <= FXS_STAGES && i >= 0; s++)
            times[s * frames + i] = (double)(s < FXS_STAGES ? stats.nanoseconds[s] : stats.frame_nanoseconds) * 1e-6;
    }
    for (int s = 0; s <= FXS_STAGES && !status; s++)
        medians[s] = median(times + s * frames, frames);
    free(times);
    return status;
}

static void print(const double medians[FXS_STAGES + 1], const bench_options *o, const loaded_scene *loaded,
                  const fxs_file_view *view)
{
    const char *cutoff = o->view.render.cutoff == FXS_CUTOFF_SQUARE ? "square" : "mahalanobis";
    if (!o->json) {
        printf("%" PRIu32 " Gaussians, %dx%d, %" PRIu32 " threads, cut-off %s, median of %d frames\n",
               loaded->scene.count, view->width, view->height, o->view.threads, cutoff, o->frames);
        for (int s = 0; s < FXS_STAGES; s++)
            printf("  %-8s %9.3f ms\n", fxs_stage_name((enum fxs_stage)s), medians[s]);
        printf("  %-8s %9.3f ms\n", "frame", medians[FXS_STAGES]);
        return;
    }
    printf("{\"gaussians\": %" PRIu32 ", \"width\": %d, \"height\": %d, \"threads\": %" PRIu32 ", \"cpu\": \"%s\", "
           "\"cutoff\": \"%s\", \"backend\": \"cpu\", \"frame_ms\": %.3f, \"stages\": {", loaded->scene.count,
           view->width, view->height, o->view.threads, o->view.cpu, cutoff, medians[FXS_STAGES]);
    for (int s = 0; s < FXS_STAGES; s++)
        printf("%s\"%s\": %.3f", s ? ", " : "", fxs_stage_name((enum fxs_stage)s), medians[s]);
    puts("}}");
}

int command_bench(int argc, char **argv)
{
    bench_options o;
    renderer r;
    loaded_scene loaded;
    fxs_file_view *views = 0;
    double medians[FXS_STAGES + 1];
    int status = take_options(&o, argc, argv);
    if (status)
        return status;
    if (o.view.view && !strcmp(o.view.view, "all"))
        return fail(EXIT_USAGE, "bench takes one view, not all");
    status = renderer_init(&r, &o.view);
    if (!status && !(status = load_scene(&loaded, o.scene))) {
        status = choose_views(&o.view, &loaded.report, &views) < 0
                     ? EXIT_FAILED : measure(medians, &r, &o, &loaded, views);
        if (!status)
            print(medians, &o, &loaded, views);
        if (views && !status)
            free(views);
        free_scene(&loaded);
    }
    renderer_free(&r);
    return status;
}
