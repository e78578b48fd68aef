/* fixsplat bench: times the stages of rendering, and compares the times with an earlier run. */
#include <fixsplat/internal/view_more.h>

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "auto_backend.h"
#include "bench_earlier.h"
#include "drawing.h"
#include "views.h"

typedef struct bench_options {
    frame_options frame;
    int frames, orbit, json;
    const char *compare;
    int draws;
} bench_options;

/* Columns of the printed times: the rendering stages, the whole frame, and the share of the frame on the device. */
enum { FRAME = FXS_STAGES, DEVICE, COLUMNS };

static int take_draw(const option_row *row, void *field, const char *value)
{
    static const int kinds[] = {DRAW_MEAN_DEPTH, DRAW_MEDIAN_DEPTH, DRAW_IDS};
    const int depths = DRAW_MEAN_DEPTH | DRAW_MEDIAN_DEPTH, choice = choice_of(row, value);
    int *draws = field;
    if (choice < 0)
        return wrong_value(row, value);
    *draws |= kinds[choice];
    return (*draws & depths) == depths ? fail(EXIT_USAGE, "--draw: give one kind of depth") : 0;
}

#define OPTIONS bench_options

static const option_row own_rows[] = {
    {.help = "Options:"},
    {"orbit", "N", INT(orbit, 2, 10000), .basic = 1, .help =
     "fly once around the scene in N frames, 2 to 10000, and print minimum, median and maximum"},
    {"times", "A..B|all", TIMES(frame.times), .help =
     "measure frames of scenes that move: one at A seconds, and --fps frames a second until before B; all: from 0 to "
     "their end. Prints minimum, median, maximum and mean, and the time of the slowest frame"},
    {"fps", "RATE", RATE(frame.rate), .help =
     "frames per second of --times, 1 to 1000, also as a fraction: 24000/1001 (default: the rate of the scene, else "
     "30)"},
    {"frames", "N", INT(frames, 10, 10000), .help =
     "frames to measure, after two warm-up frames, 10 to 10000 (default 10)"},
    {"draw", "KIND", take_draw, FIELD(int, draws), .choices = WORDS("mean-depth", "median-depth", "ids"), .help =
     "also draw mean-depth, median-depth or ids; may be repeated"},
    {"json", 0, FLAG(json), .basic = 1, .help = "print a JSON object"},
    {"compare", "FILE", TEXT(compare), .basic = 1, .help =
     "also print the times of FILE, written by --json with the same scenes, view and options, and the ratio; * marks "
     "another cut-off, back end, budget, detail, processor or number of threads"},
    {0}
};

static const option_rule rules[] = {
    {"json", "compare", 0, "it prints a table"},
    {"view", 0, "cameras", 0},
    {"frames", "orbit times", 0, "it has a number of frames"},
    {"orbit time", "times", 0, "give one"},
    {"fps", 0, "times", 0},
    {"up auto-up", "cameras", "orbit", "its views have their own up direction"},
    {0}
};

static int read_options(bench_options *o, int argc, char **argv)
{
    memset(o, 0, sizeof *o);
    frame_options_default(&o->frame);
    if (take_options(&command_bench, o, argc, argv))
        return EXIT_USAGE;
    if (take_scenes(&o->frame.world, "bench", argc - optind, argv + optind))
        return EXIT_USAGE;
    if (check_rules(rules))
        return EXIT_USAGE;
    o->frames = o->orbit ? o->orbit : o->frames ? o->frames : 10;
    return frame_options_check(&o->frame);
}

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

typedef struct spread {
    double least, median, most, mean;
    int slowest;                            /* number of the frame with the largest value */
} spread;

static spread spread_of(double *values, int count)
{
    spread s = {.slowest = 0};
    for (int i = 0; i < count; i++) {
        s.mean += values[i] / count;
        s.slowest = values[i] > values[s.slowest] ? i : s.slowest;
    }
    qsort(values, (size_t)count, sizeof *values, compare_doubles);
    s.least = values[0];
    s.median = (values[(count - 1) / 2] + values[count / 2]) / 2;
    s.most = values[count - 1];
    return s;
}

static fxs_view view_of_frame(const bench_options *o, const world *w, const fxs_view *view, int i)
{
    fxs_view turned = *view;
    double middle[3];
    for (int k = 0; k < 3; k++)
        middle[k] = (w->inner_low[k] + w->inner_high[k]) / 2;
    if (o->orbit)
        fxs_view_orbit(&turned, middle, o->frame.up.at, 6.283185307179586 * i / o->orbit);
    return turned;
}

static int measure(spread columns[COLUMNS], renderer *r, const bench_options *o, const world *w,
                   const fxs_view *view)
{
    enum { WARM_UP = 2 };
    int frames = o->frames, status = 0;
    double *times = malloc((size_t)frames * COLUMNS * sizeof *times);
    if (!times)
        return fail(EXIT_FAILED, "out of memory");
    picture pixels = {.pixels = 0};
    for (int i = -WARM_UP; i < frames && !status; i++) {
        fxs_stats stats;
        fxs_options options = o->frame.render;
        fxs_view turned = view_of_frame(o, w, view, i);
        if (o->frame.times.given)
            options.time_q32 = seconds_q32(times_at(&o->frame.times, fmax(i, 0)));
        status = renderer_render(r, w, &turned, &options, &pixels, &stats);
        for (int s = 0; s < FXS_STAGES && i >= 0; s++)
            times[s * frames + i] = (double)stats.nanoseconds[s] * 1e-6;
        if (i >= 0) {
            times[FRAME * frames + i] = (double)stats.frame_nanoseconds * 1e-6;
            times[DEVICE * frames + i] = (double)r->backend->nanoseconds(r->self) * 1e-6;
        }
    }
    for (int s = 0; s < COLUMNS && !status; s++)
        columns[s] = spread_of(times + s * frames, frames);
    free(times);
    picture_free(&pixels);
    return status;
}

static const char *column_name(int column)
{
    return column < FXS_STAGES ? fxs_stage_name((enum fxs_stage)column) : column == FRAME ? "frame" : "device";
}

#define SCENES_ROOM 4096
#define CAMERA_ROOM 640
#define FACTS 21

typedef struct bench_facts {
    bench_fact facts[FACTS];
    char scenes[SCENES_ROOM], camera[CAMERA_ROOM], processor[128];
} bench_facts;

static void name_scenes(char names[SCENES_ROOM], const world *w)
{
    size_t used = 0;
    names[0] = 0;
    for (uint32_t i = 0; i < w->placed.file_count && used < SCENES_ROOM; i++) {
        const char *path = w->placed.files[i], *slash = strrchr(path, '/');
        used += (size_t)snprintf(names + used, SCENES_ROOM - used, "%s%s", i ? ", " : "", slash ? slash + 1 : path);
    }
}

static void name_camera(char text[CAMERA_ROOM], const fxs_view *v)
{
    const double *r = v->rotation, *p = v->position;
    snprintf(text, CAMERA_ROOM, "%s %.9g %.9g %.9g, %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g, %.9g %.9g %.9g %.9g, "
             "%.9g", v->projection == FXS_ORTHOGRAPHIC ? "orthographic" : "perspective", p[0], p[1], p[2], r[0], r[1],
             r[2], r[3], r[4], r[5], r[6], r[7], r[8], v->fx, v->fy, v->cx, v->cy, v->near);
}

static void state(bench_facts *f, const renderer *r, const bench_options *o, const world *w,
                  const fxs_view *view)
{
    name_scenes(f->scenes, w);
    name_camera(f->camera, view);
    name_processor(f->processor);
    const bench_fact facts[FACTS] = {
        {"gaussians", 0, w->gaussians, FACT_SAME}, {"width", 0, view->width, FACT_SAME},
        {"height", 0, view->height, FACT_SAME}, {"threads", 0, o->frame.threads, FACT_MARKED},
        {"cpu", o->frame.cpu, 0, FACT_MARKED}, {"cutoff", cutoff_names[o->frame.render.cutoff], 0, FACT_MARKED},
        {"backend", r->backend->name, 0, FACT_MARKED},
        {"frames", 0, o->frames, o->orbit || o->frame.times.given ? FACT_SAME : FACT_ASIDE},
        {"orbit", 0, o->orbit, FACT_SAME}, {"scenes", f->scenes, 0, FACT_SAME}, {"camera", f->camera, 0, FACT_SAME},
        {"stereo", 0, o->frame.stereo, FACT_SAME}, {"draws", 0, o->draws, FACT_SAME},
        {"sh_degree", 0, o->frame.render.sh_degree, FACT_SAME}, {"budget", 0, o->frame.render.budget, FACT_MARKED},
        {"detail", 0, o->frame.render.detail_q8 / 256.0, FACT_MARKED},
        {"max_memory", 0, (double)o->frame.max_memory, FACT_MARKED}, {"processor", f->processor, 0, FACT_MARKED},
        {"time", 0, ldexp((double)o->frame.render.time_q32, -32), FACT_SAME},
        {"times_from", 0, o->frame.times.from, FACT_SAME}, {"times_to", 0, o->frame.times.to, FACT_SAME}};
    memcpy(f->facts, facts, sizeof facts);
}

static void print_ratios(const spread columns[COLUMNS], const bench_earlier *earlier, const char *file)
{
    const char *mark = earlier->marks[0] ? " *" : "";
    printf("medians, milliseconds; %s\n  %-8s %9s %9s   ratio\n", file, "", "there", "here");
    for (int s = 0; s < DEVICE; s++) {
        const double there = s < FXS_STAGES ? earlier->stages[s] : earlier->frame, here = columns[s].median;
        printf("  %-8s %9.3f %9.3f", column_name(s), there, here);
        if (there > 0)
            printf("  %6.3f%s\n", here / there, mark);
        else
            printf("       -%s\n", mark);
    }
    if (*mark)
        printf("* not like with like: %s\n", earlier->marks);
}

/* ---- Printed ----------------------------------------------------------------------------------------------------- */

static double time_of_slowest(const spread columns[COLUMNS], const bench_options *o)
{
    return times_at(&o->frame.times, columns[FRAME].slowest);
}

static void print_text(const spread columns[COLUMNS], const renderer *r, const bench_options *o, const world *w,
                       const fxs_view *view)
{
    printf("%" PRIu32 " Gaussians, %dx%d, %" PRIu32 " threads, cut-off %s, %d frames%s; milliseconds\n",
           w->gaussians, view->width, view->height, o->frame.threads, cutoff_names[o->frame.render.cutoff], o->frames,
           o->orbit ? " around the scene" : o->frame.times.given ? " over its times" : "");
    printf("           %9s %9s %9s   share  version\n", "minimum", "median", "maximum");
    for (int s = 0; s < (columns[DEVICE].most > 0 ? DEVICE + 1 : DEVICE); s++)
        printf("  %-8s %9.3f %9.3f %9.3f  %5.1f%%  %s\n", column_name(s), columns[s].least, columns[s].median,
               columns[s].most, 100 * columns[s].median / columns[FRAME].median,
               s < FXS_STAGES ? r->backend->version(r->self, (enum fxs_stage)s) : "");
    if (o->frame.times.given)
        printf("  mean %.3f; the slowest is at %.4g seconds\n", columns[FRAME].mean, time_of_slowest(columns, o));
}

static void print_json(const spread columns[COLUMNS], const bench_fact facts[FACTS], const bench_options *o,
                       const world *w)
{
    for (int i = 0; i < FACTS; i++) {
        printf("%s\"%s\": ", i ? ", " : "{", facts[i].name);
        if (facts[i].text)
            print_json_string(facts[i].text);
        else
            printf("%.15g", facts[i].number);
    }
    if (o->frame.times.given)
        printf(", \"frame_ms_mean\": %.3f, \"slowest_at\": %.6g", columns[FRAME].mean, time_of_slowest(columns, o));
    printf(", \"frame_ms\": %.3f, \"frame_ms_min\": %.3f, \"frame_ms_max\": %.3f, \"device_ms\": %.3f, "
           "\"load_ms\": %.3f, \"stages\": {", columns[FRAME].median, columns[FRAME].least, columns[FRAME].most,
           columns[DEVICE].median, (double)w->load_nanoseconds * 1e-6);
    for (int s = 0; s < FXS_STAGES; s++)
        printf("%s\"%s\": %.3f", s ? ", " : "", column_name(s), columns[s].median);
    puts("}}");
}

static int bench(renderer *r, const bench_options *o, const world *w, const fxs_view *view)
{
    spread columns[COLUMNS];
    bench_facts f;
    bench_earlier earlier;
    state(&f, r, o, w, view);
    int status = o->compare ? bench_earlier_read(&earlier, o->compare, f.facts, FACTS) : 0;
    status = status ? status : measure(columns, r, o, w, view);
    if (status)
        return status;
    if (o->json)
        print_json(columns, f.facts, o, w);
    else
        print_text(columns, r, o, w, view);
    if (o->compare)
        print_ratios(columns, &earlier, o->compare);
    return 0;
}

/* Counts the frames of --times. */
static int settle_times(bench_options *o, const world *w)
{
    const fxs_time time = world_time(w);
    const long frames = o->frame.times.given ? times_settle(&o->frame.times, o->frame.rate, &time, w->placed.files[0])
                                             : o->frames;
    o->frames = (int)frames;
    return frames < 0 ? EXIT_FAILED : 0;
}

static int run(int argc, char **argv)
{
    bench_options o;
    renderer r;
    world w;
    fxs_view *views = 0;
    int status = read_options(&o, argc, argv);
    if (status)
        return status;
    if (names_several(o.frame.view))
        return fail(EXIT_USAGE, "bench takes one view, not all");
    o.frame.framed = 1;
    status = renderer_open(&r, &o.frame);
    r.draws = o.draws;
    o.frame.load.budget = !status && renderer_pages(&r) ? o.frame.render.budget : 0;
    if (!status && !(status = world_open(&w, &o.frame.world, &o.frame.load))) {
        status = settle_times(&o, &w) || choose_views(&o.frame, &w, &views, 0) < 0 ? EXIT_FAILED
                                                                                  : bench(&r, &o, &w, views);
        free(views);
        renderer_close(&r);
        world_close(&w);
    }
    renderer_close(&r);
    return status;
}

const command command_bench = {
    "bench", "times each stage", run,
    "Usage: fixsplat bench SCENE... [OPTION...]\n\n"
    "Renders one view repeatedly and prints the median milliseconds of each stage, and the device's own times if\n"
    "the back end has a timer.\n",
    0,
    "  $ fixsplat bench scene.ply --cameras cameras.json --view 8 --size 1280x720\n"
    "  $ fixsplat bench scene.ply --json > before.json\n"
    "  $ fixsplat bench scene.ply --compare before.json\n"
    "  $ fixsplat bench scene.ply --threads 1 --cutoff square --json\n"
    "  $ fixsplat bench scene.ply --draw median-depth --draw ids\n"
    "  $ fixsplat bench scene.ply --orbit 120\n"
    "  $ fixsplat bench scene.fxs --budget 500000 --orbit 120\n"
    "  $ fixsplat bench dance.fxs --times all --fps 30\n"
    "  $ fixsplat bench scene.ply --compare before.json --cutoff square\n",
    {{own_rows, 0}, {gaze_rows, offsetof(bench_options, frame)},
     {camera_rows, offsetof(bench_options, frame)}, {world_rows, offsetof(bench_options, frame.world)},
     {frame_rows, offsetof(bench_options, frame)}, {level_rows, offsetof(bench_options, frame)},
     {load_rows, offsetof(bench_options, frame.load)}, COMMON_TABLE}
};
