/* `fixsplat fit --preview`: runs the fit and serves a page that shows its progress. Every few seconds the fit packs
   its scene into a temporary file and writes its numbers to /fit.json. */
#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/camera.h>
#include <fixsplat/scene.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/output.h>
#include <fixsplat/internal/start.h>
#include <fixsplat/internal/view_more.h>
#include "port/http/server.h"
#include "src/base/os_calls.h"
#include "src/camera/view_print.h"
#include "tools/command/file_guard.h"
#include "tools/fit/fit_result.h"
#include "tools/fit/fit_watcher.h"
#include "page_folder.h"
#include "serve.h"

#define SECOND ((uint64_t)1000000000)
enum {
    SCENE_SECONDS = 3,              /* least number of seconds between two packed scenes */
    SHARE = 40,                     /* packing takes at most 1/SHARE of the time, and so does measuring */
    POINTS = 20,
    MEASURED_MOST = 4,              /* most photographs that are measured for a point of the quality curve */
    PAGE_SECONDS = 3,               /* a page without requests for that many seconds counts as closed */
    GOODBYE_SECONDS = 5             /* most seconds to wait at the end until a page has loaded the last scene */
};

/* A file that the server sends, and that is replaced from time to time. */
typedef struct live_file {
    int descriptor;
    uint32_t asked;
    uint64_t asked_at;
} live_file;

enum { SCENE, NUMBERS, VIEWS, FILES };

typedef struct point {
    uint32_t step;
    double psnr, ssim;
} point;

static struct preview {
    fxs_http_server *server;
    fxs_http_site site;
    fxs_http_file files[FILES];
    char folder[PAGE_PATH];
    pthread_mutex_t lock;           /* lock that guards the array `live` */
    live_file live[FILES];

    const char *out, *state;
    int has_failed;
    int is_written;
    const fxs_photos *photos;       /* the fit's photographs, valid until the final scene is written */
    int held_out;
    frame_options frame;
    fxs_photos few;                 /* photographs that are measured for each point of the quality curve */
    fit_now now;
    uint64_t began, told, packed;   /* times of the fit's start, last numbers and last scene in nanoseconds */
    uint64_t spent_on_scenes, spent_on_points;
    uint32_t version;               /* number of the scene's version, from 1; 0: no scene yet */
    uint32_t measured;
    point *points;
    size_t point_count, point_room;
    quality result;
} preview = {.lock = PTHREAD_MUTEX_INITIALIZER, .live = {{-1, 0, 0}, {-1, 0, 0}, {-1, 0, 0}}, .state = "reads"};

static int open_live(void *file)
{
    struct preview *p = &preview;
    live_file *live = file;
    pthread_mutex_lock(&p->lock);
    const int descriptor = live->descriptor < 0 ? -1 : fxs_descriptor_again(live->descriptor);
    live->asked++;
    live->asked_at = fxs_clock(0);
    pthread_mutex_unlock(&p->lock);
    return descriptor;
}

/* Replaces a file that the server sends, and takes ownership of its descriptor. If the descriptor is -1, prints an
   error for errno. */
static void give(struct preview *p, int which, int descriptor)
{
    live_file *live = &p->live[which];
    if (descriptor < 0) {
        if (!p->has_failed)
            fail(EXIT_FAILED, "--preview: a temporary file: %s; the fit goes on", strerror(errno));
        p->has_failed = 1;
        return;
    }
    pthread_mutex_lock(&p->lock);
    const int before = live->descriptor;
    live->descriptor = descriptor;
    live->asked = 0;
    pthread_mutex_unlock(&p->lock);
    if (before >= 0)
        fxs_descriptor_close(before);
}

static uint32_t asked_for_numbers(struct preview *p, uint64_t *at)
{
    pthread_mutex_lock(&p->lock);
    const uint32_t asked = p->live[NUMBERS].asked;
    *at = p->live[NUMBERS].asked_at;
    pthread_mutex_unlock(&p->lock);
    return asked;
}

static void write_number(FILE *file, const char *before, double number)
{
    fprintf(file, isfinite(number) ? "%s%.4f" : "%snull", before, number);
}

static void write_points(FILE *file, const struct preview *p)
{
    fputs(", \"points\": [", file);
    for (size_t i = 0; i < p->point_count; i++) {
        fprintf(file, "%s[%u", i ? ", " : "", (unsigned)p->points[i].step);
        write_number(file, ", ", p->points[i].psnr);
        write_number(file, ", ", p->points[i].ssim);
        putc(']', file);
    }
    putc(']', file);
}

static void tell(struct preview *p)
{
    FILE *file = fxs_stream_temporary();
    const uint8_t *bg = p->frame.render.background;
    p->told = fxs_clock(0);
    if (file) {
        fputs("{\"scene\": ", file);
        write_json_string(file, p->out);
        fprintf(file, ", \"state\": \"%s\", \"version\": %u, \"background\": \"#%02x%02x%02x\", \"step\": %u, "
                "\"steps\": %u, \"gaussians\": %zu", p->state, (unsigned)p->version, bg[0], bg[1], bg[2],
                (unsigned)p->now.step, (unsigned)p->now.steps, p->now.gaussians);
        write_number(file, ", \"loss\": ", p->now.loss);
        write_number(file, ", \"seconds\": ", p->began ? (double)(p->told - p->began) * 1e-9 : 0);
        write_number(file, ", \"left\": ", p->now.left);
        fprintf(file, ", \"held_out\": %s, \"photographs\": %zu", p->held_out ? "true" : "false",
                p->few.held_out_count + p->few.fit_count);
        write_points(file, p);
        if (p->result.count) {
            fprintf(file, ", \"result\": {\"photographs\": %ld", p->result.count);
            write_number(file, ", \"psnr\": ", p->result.psnr);
            write_number(file, ", \"ssim\": ", p->result.ssim);
            putc('}', file);
        }
        fputs("}\n", file);
    }
    give(p, NUMBERS, keep_written(file));
}

static void tell_views(struct preview *p)
{
    FILE *file = fxs_stream_temporary();
    const fxs_photos *all = p->photos;
    const fxs_fit_photo *photos = all->held_out_count ? all->held_out : all->fit;
    const size_t count = all->held_out_count ? all->held_out_count : all->fit_count;
    for (size_t i = 0; file && i < count; i++) {
        fputs(i ? ",\n" : "[", file);
        fxs_view_print(file, &photos[i].view);
    }
    if (file)
        fputs("]\n", file);
    give(p, VIEWS, keep_written(file));
}

/* Sets a scene's start view to the camera of the first held-out photograph, or else of the first photograph. */
static void set_start(fxs_packed_scene *packed, const fxs_photos *photos)
{
    fxs_message message;
    fxs_start start = {.tangent = 0};
    if (fxs_views_up(&photos->fit->view, photos->fit_count, sizeof *photos->fit, start.up))
        fxs_start_to(packed->data, &start);
    const fxs_fit_photo *first = photos->held_out_count ? photos->held_out : photos->fit;
    fxs_view_to_start(packed->data, &first->view, &message);
}

static void give_scene(struct preview *p, fxs_packed_scene *packed)
{
    set_start(packed, p->photos);
    fxs_file_seal(packed->data, packed->bytes);
    give(p, SCENE, keep(packed->data, packed->bytes));
    p->version++;
}

static void add_point(struct preview *p, uint32_t step, const quality *q)
{
    if (p->point_count == p->point_room) {
        const size_t room = 2 * p->point_room + POINTS;
        point *larger = realloc(p->points, room * sizeof *larger);
        if (!larger)
            return;
        p->points = larger;
        p->point_room = room;
    }
    p->points[p->point_count++] = (point){step, q->psnr, q->ssim};
}

static void choose_few(struct preview *p)
{
    free(p->few.fit);
    free(p->few.held_out);
    p->few = (fxs_photos){.fit = 0};
    const fxs_photos *all = p->photos;
    const fxs_fit_photo *from = all->held_out_count ? all->held_out : all->fit;
    const size_t most = MEASURED_MOST, count = all->held_out_count ? all->held_out_count : all->fit_count;
    const size_t chosen = count < most ? count : most;
    fxs_fit_photo *few = malloc(chosen * sizeof *few);
    for (size_t i = 0; few && i < chosen; i++)
        few[i] = from[i * count / chosen];
    if (few && all->held_out_count)
        p->few = (fxs_photos){.held_out = few, .held_out_count = chosen};
    else if (few)
        p->few = (fxs_photos){.fit = few, .fit_count = chosen};
}

static void measure_few(struct preview *p, fxs_packed_scene *packed)
{
    const uint64_t start = fxs_clock(0);
    quality q = {0};
    world scene = {0};
    int status = world_open_packed(&scene, p->out, packed);
    status = status ? status : result_measure(&q, &scene, &p->few, &p->frame, 0);
    if (!status)
        add_point(p, p->now.step, &q);
    p->measured = p->now.step;
    quality_free(&q);
    world_close(&scene);
    p->spent_on_points += fxs_clock(0) - start;
}

/* True if a point of the quality curve shall be measured now: at the first scene, at the final scene, and between if
   the time share allows. */
static int wants_point(const struct preview *p)
{
    const fit_now *now = &p->now;
    const int is_due = now->step - p->measured >= now->steps / POINTS &&
                       p->spent_on_points * SHARE <= fxs_clock(0) - p->began;
    return (p->few.held_out || p->few.fit) && (!p->point_count || is_due || p->is_written);
}

/* Serves the packed scene. If a point of the quality curve is due, measures the scene `measured`. `start` is the time
   when packing began. */
static void show(struct preview *p, fxs_packed_scene *packed, fxs_packed_scene *measured, uint64_t start)
{
    give_scene(p, packed);
    p->packed = fxs_clock(0);
    p->spent_on_scenes += p->packed - start;
    tell(p);
    if (wants_point(p)) {
        measure_few(p, measured);
        tell(p);
    }
}

static int wants_scene(const struct preview *p, uint64_t time)
{
    return time - p->packed >= SCENE_SECONDS * SECOND && p->spent_on_scenes * SHARE <= time - p->began;
}

static void pack_and_show(struct preview *p, fxs_fit *fit)
{
    const uint64_t start = fxs_clock(0);
    fxs_packed_scene packed;
    fxs_pack_report report;
    fxs_message message;
    const int error = fxs_fit_pack(fit, &packed, &report, &message);
    if (error) {
        fail_for(&message);
        p->packed = fxs_clock(0);
        return;
    }
    p->now.gaussians = (size_t)report.read;
    show(p, &packed, &packed, start);
    fxs_packed_scene_free(&packed);
}

static void say_address(void *self, const char *address, int is_local)
{
    (void)self;
    (void)is_local;
    note("preview: %s/", address);
}

static int open_preview(const char *out, uint64_t port)
{
    static const char *const start = "/viewer/fit.html", *const names[FILES] = {"/scene.fxs", "/fit.json",
                                                                                 "/cameras.json"};
    const fxs_http_options options = {.address = "127.0.0.1", .port = (uint16_t)port};
    struct preview *p = &preview;
    fxs_message message;
    char page[PAGE_PATH + 32];
    const int status = page_folder_find(p->folder);
    if (status)
        return status;
    if (snprintf(page, sizeof page, "%s%s", p->folder, start) >= (int)sizeof page ||
        fxs_file_kind(page) != FXS_FILE_REGULAR)
        return fail(EXIT_FAILED, "%s: the page of --preview is not there: no viewer/fit.html", p->folder);
    for (int i = 0; i < FILES; i++)
        p->files[i] = (fxs_http_file){.name = names[i], .open = open_live, .self = &p->live[i]};
    p->site = (fxs_http_site){.folder = p->folder, .files = p->files, .file_count = FILES, .starts = &start,
                              .start_count = 1};
    p->out = out;
    tell(p);
    if (fxs_http_open(&p->server, &p->site, &options, &message))
        return fail(EXIT_FAILED, "--preview: %s", message.text);
    fxs_http_each_address(p->server, say_address, p);
    return 0;
}

static void begin_preview(fxs_fit *fit, const fxs_photos *photos, const frame_options *frame, int measures,
                          const fit_now *now)
{
    struct preview *p = &preview;
    p->photos = photos;
    p->held_out = photos->held_out_count > 0;
    p->frame = *frame;
    p->state = "fits";
    p->now = *now;
    p->began = fxs_clock(0);
    if (measures)
        choose_few(p);
    tell_views(p);
    pack_and_show(p, fit);
}

static void take_grown(void)
{
    struct preview *p = &preview;
    p->held_out = p->photos->held_out_count > 0;
    if (p->few.fit || p->few.held_out)
        choose_few(p);
    tell_views(p);
}

static void look(fxs_fit *fit, const fit_now *now)
{
    struct preview *p = &preview;
    const uint64_t time = fxs_clock(0);
    p->now = *now;
    if (now->step < now->steps && wants_scene(p, time))
        pack_and_show(p, fit);
    else if (time - p->told >= SECOND)
        tell(p);
}

static void add_measured(uint32_t step, const quality *q)
{
    struct preview *p = &preview;
    if (!p->few.held_out && !p->few.fit)
        add_point(p, step, q);
    if (p->is_written)
        p->result = (quality){.count = q->count, .psnr = q->psnr, .ssim = q->ssim};
    tell(p);
}

static void show_written(fxs_packed_scene *packed, fxs_packed_scene *measured)
{
    preview.state = "measures";
    preview.is_written = 1;
    show(&preview, packed, measured, fxs_clock(0));
}

static void tell_stopped(void)
{
    preview.state = "stopped";
    tell(&preview);
}

static void wait_for_page(struct preview *p)
{
    const uint64_t end = fxs_clock(0) + GOODBYE_SECONDS * SECOND;
    uint64_t asked_at;
    asked_for_numbers(p, &asked_at);
    if (!asked_at || fxs_clock(0) - asked_at > PAGE_SECONDS * SECOND)
        return;
    tell(p);
    while (asked_for_numbers(p, &asked_at) < 2 && fxs_clock(0) < end && !fxs_end_wait(50))
        ;
}

static void close_preview(int status)
{
    struct preview *p = &preview;
    p->state = status ? "failed" : "over";
    wait_for_page(p);
    fxs_http_close(p->server);
    free(p->points);
    free(p->few.fit);
    free(p->few.held_out);
}

int serve_fit(int argc, char **argv)
{
    static const fit_watcher watcher = {open_preview, begin_preview, take_grown, look, add_measured, show_written,
                                        tell_stopped, close_preview};
    fxs_output_remove_at_signals();
    files_begin();
    return fit_run(argc, argv, &watcher);
}
