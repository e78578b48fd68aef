/* Chooses a first view of a scene by rendering a small sample of it from many camera positions. The score of a view
   counts visible Gaussians. A single Gaussian that fills the picture, or a border that cuts through the subject, lowers
   the score. Steps: find the scene's core and free places inside, choose the up direction, try 12 yaws around each box,
   then refine height and distance. */
#include "first_view.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/camera.h>
#include <fixsplat/internal/allocator.h>
#include <fixsplat/internal/message.h>
#include <fixsplat/internal/stage.h>
#include "camera_internal.h"
#include "ground.h"
#include "within.h"
#include "src/base/try_internal.h"

enum { WIDTH = 96, HEIGHT = 64, PIXELS = WIDTH * HEIGHT };
enum { BORDER = 4 * WIDTH + 6 * (HEIGHT - 2) };
enum { YAWS = 12, AROUND = 6, STANDS = 2 * YAWS, SIDES_TRIED = 3, THREADS_MOST = 8, BOXES = 3 };

#define FOV 50
#define LARGEST (PIXELS / 16)        /* largest size of a Gaussian in a picture, pixels, that does not lower the view's
                                        score */
#define UNBOUNDED 2                  /* an unbounded scene is at least this many times as large as its core */
#define OPEN 0.65                    /* least mean coverage of the pictures from a useful place inside the scene */
#define CLOSED 0.88                  /* least mean coverage of the pictures inside a closed room */
#define WITHIN 0.74                  /* least ratio of the Gaussians seen from inside to those seen from outside, for a
                                        view from inside */
#define WITHIN_STANDING 1.1          /* largest ratio of the Gaussians seen from inside to those seen from outside, for
                                        a standing figure */

typedef struct look {
    unsigned char colour[PIXELS][4], coverage[PIXELS];
    uint32_t depth[PIXELS];
    fxs_id id[PIXELS];
    uint16_t pixels[FXS_SAMPLE_MOST + 1];
} look;

typedef struct sight {
    int64_t seen;                    /* number of Gaussians that contribute most to some pixel of the picture */
    int64_t largest;
    int64_t detail;
    int64_t covered;                 /* sum of the coverage of all pixels, up to 255 per pixel */
    int64_t close;
    int64_t cut;
} sight;

typedef struct box {
    double low[3], high[3];
} box;

typedef struct stand {
    int yaw;                         /* yaw of the camera, in twelfths of a turn */
    double out, rise;                /* horizontal and upward part of the direction from the scene to the camera */
    double part;
    const box *about;
} stand;

typedef struct chooser {
    fxs_context context;
    const fxs_config *config;
    uint32_t threads;
    fxs_sample sample;
    fxs_core core;
    box boxes[BOXES];                /* boxes of the scene, and if it is unbounded, of its core and of the core's
                                        middle */
    int box_count;
    box places[FXS_WITHIN_MOST];
    int place_count;
    int standing;                    /* 1 or 2: the scene is a subject that stands along the axis y or z */
    int is_within;
    int outlined;                    /* 0: the subject has no outline, as the surroundings thin out with distance */
    double up[3], close;             /* depth below which a pixel counts as close, because it blocks the view */
    size_t frame_bytes;
    unsigned char *frames;
    look *looks;
    fxs_message *message;
} chooser;

static int is_covered(const look *l, int pixel)
{
    return l->coverage[pixel] > 127;
}

static void count_seen(look *l, double close, double far, sight *s)
{
    memset(l->pixels, 0, sizeof l->pixels);
    for (int i = 0; i < PIXELS; i++) {
        s->covered += l->coverage[i];
        const double depth = l->depth[i] != FXS_NOTHING ? l->depth[i] / 65536.0 : close;
        s->close += depth < close;
        if (l->id[i].object == FXS_NOTHING || l->coverage[i] < 48)
            continue;
        const uint16_t pixels = ++l->pixels[l->id[i].object + l->id[i].gaussian];
        s->seen += pixels == 1;
        s->largest = pixels > s->largest && depth < far ? pixels : s->largest;
    }
}

/* Returns the luminance difference of two pixels, at most 40, so that bright spots do not dominate. */
static int difference(const unsigned char *a, const unsigned char *b)
{
    const int d = abs(2 * (a[0] - b[0]) + 5 * (a[1] - b[1]) + a[2] - b[2]) / 8;
    return d < 40 ? d : 40;
}

static void count_detail(const look *l, sight *s)
{
    for (int y = 0; y + 1 < HEIGHT; y++)
        for (int x = 0; x + 1 < WIDTH; x++) {
            const int i = y * WIDTH + x;
            for (int step = 1; step <= WIDTH; step += WIDTH - 1)
                if (is_covered(l, i) && is_covered(l, i + step))
                    s->detail += difference(l->colour[i], l->colour[i + step]);
        }
}

/* Counts covered pixels at the picture's border, where it may cut through the subject. The bottom border counts a
   third, because a ground may continue there. */
static void count_cut(const look *l, sight *s)
{
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x += y % (HEIGHT - 1) ? WIDTH - 1 : 1)
            s->cut += is_covered(l, y * WIDTH + x) * (y == HEIGHT - 1 ? 1 : 3);
}

static double end_of_core(const chooser *c, const fxs_view *view)
{
    return fxs_distance(view->position, c->core.middle) + fxs_distance(c->core.low, c->core.high) / 2;
}

static int take_look(const chooser *c, uint32_t thread, const fxs_view *view, sight *s)
{
    look *l = &c->looks[thread];
    fxs_request r;
    fxs_message unwanted;
    memset(s, 0, sizeof *s);
    fxs_request_init(&r, c->sample.objects, c->sample.count);
    if (fxs_camera_from_view(&r.cameras[0], view, &unwanted))
        return 0;
    r.targets[0].colour = (fxs_image){l->colour, sizeof *l->colour * WIDTH};
    r.targets[0].coverage = (fxs_image){l->coverage, sizeof *l->coverage * WIDTH};
    r.targets[0].median_depth = (fxs_image){l->depth, sizeof *l->depth * WIDTH};
    r.targets[0].id = (fxs_image){l->id, sizeof *l->id * WIDTH};
    const int error = fxs_render(&c->context, &r, c->frames + thread * c->frame_bytes, c->frame_bytes, NULL);
    if (error)
        return error == FXS_ERR_CAMERA ? 0 : error;
    count_seen(l, c->close, end_of_core(c, view), s);
    count_detail(l, s);
    count_cut(l, s);
    return 0;
}

int fxs_first_view_make(const fxs_first_choice *first, double fov, int width, int height, fxs_view *view,
                        fxs_message *message)
{
    FXS_TRY(fxs_view_frame_from(view, first->low, first->high, first->from, first->up,
                                &(fxs_picture){fov, width, height}, message));
    for (int i = 0; i < 3; i++) {
        const double middle = (first->low[i] + first->high[i]) / 2;
        view->position[i] = middle + first->part * (view->position[i] - middle);
    }
    return 0;
}

static const double turns[YAWS][2] = {
    {1, 0}, {0.8660254037844386, 0.5}, {0.5, 0.8660254037844386}, {0, 1}, {-0.5, 0.8660254037844386},
    {-0.8660254037844386, 0.5}, {-1, 0}, {-0.8660254037844386, -0.5}, {-0.5, -0.8660254037844386}, {0, -1},
    {0.5, -0.8660254037844386}, {0.8660254037844386, -0.5}};

static int first_of(fxs_first_choice *first, const stand *s, const double up[3], fxs_message *message)
{
    double back[3];
    double *axis = first->up;
    FXS_TRY(fxs_level_back(back, axis, up, message));
    const double side[3] = {axis[1] * back[2] - axis[2] * back[1], axis[2] * back[0] - axis[0] * back[2],
                            axis[0] * back[1] - axis[1] * back[0]};
    for (int i = 0; i < 3; i++)
        first->from[i] = s->out * (turns[s->yaw][0] * back[i] + turns[s->yaw][1] * side[i]) + s->rise * axis[i];
    first->part = s->part;
    memcpy(first->low, s->about->low, sizeof first->low);
    memcpy(first->high, s->about->high, sizeof first->high);
    return 0;
}

static int view_of(const chooser *c, const stand *s, fxs_view *view)
{
    fxs_first_choice first;
    FXS_TRY(first_of(&first, s, c->up, c->message));
    return fxs_first_view_make(&first, FOV, WIDTH, HEIGHT, view, c->message);
}

typedef struct looking {
    const chooser *c;
    fxs_view views[STANDS];
    sight *sights;
    uint32_t count;
    int errors[THREADS_MOST];
} looking;

static void look_job(void *argument, uint32_t thread)
{
    looking *g = argument;
    for (uint32_t i = thread; i < g->count && !g->errors[thread]; i += g->c->threads)
        g->errors[thread] = take_look(g->c, thread, &g->views[i], &g->sights[i]);
}

static int look_from(chooser *c, const stand *stands, uint32_t count, sight *sights)
{
    looking g = {.c = c, .sights = sights, .count = count};
    for (uint32_t i = 0; i < count; i++)
        FXS_TRY(view_of(c, &stands[i], &g.views[i]));
    if (c->threads > 1)
        c->config->workers.run(c->config->workers.pool, look_job, &g, c->threads);
    else
        look_job(&g, 0);
    for (uint32_t i = 0; i < c->threads; i++)
        if (g.errors[i])
            return fxs_fail_as(g.errors[i], c->message, "%s", fxs_strerror(g.errors[i]));
    return 0;
}

static int look_down(chooser *c, double *seen, double *detail)
{
    stand stands[AROUND];
    sight sights[AROUND];
    *seen = *detail = 1;
    for (int far = 0; far < 2; far++) {
        int64_t all_seen = 0, all_detail = 0;
        for (int i = 0; i < AROUND; i++)
            stands[i] = (stand){2 * i, 0.77, 0.64, far ? 1 : 0.5, &c->boxes[c->box_count - 1]};
        FXS_TRY(look_from(c, stands, AROUND, sights));
        for (int i = 0; i < AROUND; i++) {
            all_seen += sights[i].seen;
            all_detail += sights[i].detail;
        }
        *seen = fmax(*seen, (double)all_seen);
        *detail = fmax(*detail, (double)all_detail);
    }
    return 0;
}

static int is_direction(const double up[3])
{
    return up && (up[0] != 0 || up[1] != 0 || up[2] != 0);
}

/* Decides which direction is up. Captured scenes show most from above, and subjects stand on the ground. In doubt, up
   is -y or z, as in most files. */
static int find_up(chooser *c, const double known[3])
{
    fxs_ground ground;
    double seen[2] = {1, 1}, detail[2] = {1, 1};
    FXS_TRY(fxs_ground_find(&ground, &c->sample, &c->core, c->standing, c->message));
    c->outlined = !(ground.spread > 2.6);
    if (is_direction(known))
        return 0;
    for (int i = 0; i < 3; i++)
        c->up[i] = -ground.axis[i];
    if (!c->is_within)
        FXS_TRY(look_down(c, &seen[1], &detail[1]));
    memcpy(c->up, ground.axis, sizeof c->up);
    if (!c->is_within)
        FXS_TRY(look_down(c, &seen[0], &detail[0]));
    const double upright = (seen[0] - seen[1]) / (seen[0] + seen[1]) +
                           0.25 * (detail[0] - detail[1]) / (detail[0] + detail[1]) + 0.8 * ground.sided + 0.12;
    for (int i = 0; i < 3 && upright < 0; i++)
        c->up[i] = -c->up[i];
    return 0;
}

static const double heights[3][2] = {{0.95, 0.31}, {0.99, 0.14}, {0.82, 0.57}};

typedef struct choice {
    stand best, sides[YAWS];
    double score, scores[YAWS];
} choice;

/* True if the core is thin, as a sheet of paper or a rod. */
static int is_thin(const fxs_core *core)
{
    double sides[3];
    for (int i = 0; i < 3; i++)
        sides[i] = core->high[i] - core->low[i];
    fxs_sort_values(sides, 3);
    return sides[0] < 0.1 * sides[1] || sides[1] < 0.1 * sides[2];
}

/* Returns a factor for a view's score: 0.5 if the picture's border cuts through the subject, 0.25 if the subject is
   thin, up to 1 if not. A completely covered border has no outline of a thick subject to cut. */
static double uncut(const chooser *c, const sight *s)
{
    const double cut = (double)s->cut / BORDER, covered = (double)s->covered / (255 * PIXELS);
    const double all = fmax((cut - 0.5) / 0.4, c->outlined ? 0 : (covered - 0.55) / 0.2);
    return cut < 0.01 ? 1 : is_thin(&c->core) ? 0.25 : 0.5 + 0.5 * fmax(0, fmin(all, 1));
}

static double score_of(const chooser *c, const stand *at, const sight *s)
{
    const int64_t largest = s->largest > LARGEST ? s->largest : LARGEST;
    double shown = (double)s->seen * (at->part > 0 ? uncut(c, s) : 1) * LARGEST / (double)largest;
    if (at->about != c->boxes && at->part > 0)
        shown *= (at->part < 0.7 ? 0.9 : 1) * (at->rise > heights[0][1] ? 0.88 : 1);
    return at->rise != heights[0][1] ? shown : at->yaw == 0 && at->part == 1 ? 1.155 * shown : 1.1 * shown;
}

static int try_stands(chooser *c, const stand *stands, uint32_t count, double factor, choice *made)
{
    sight sights[STANDS];
    FXS_TRY(look_from(c, stands, count, sights));
    for (uint32_t i = 0; i < count; i++) {
        const double score = factor * score_of(c, &stands[i], &sights[i]);
        const int yaw = stands[i].yaw;
        if (score > made->scores[yaw]) {
            made->scores[yaw] = score;
            made->sides[yaw] = stands[i];
        }
        if (score > made->score) {
            made->score = score;
            made->best = stands[i];
        }
    }
    return 0;
}

static int try_sides(chooser *c, const box *about, choice *made)
{
    stand stands[STANDS];
    for (int i = 0; i < STANDS; i++)
        stands[i] = (stand){i / 2, heights[0][0], heights[0][1], i % 2 ? 0.5 : 1, about};
    return try_stands(c, stands, STANDS, 1, made);
}

static int try_place(chooser *c, int place, choice *made)
{
    stand stands[YAWS];
    for (int yaw = 0; yaw < YAWS; yaw++)
        stands[yaw] = (stand){yaw, heights[1][0], heights[1][1], 0, &c->places[place]};
    return try_stands(c, stands, YAWS, !c->is_within ? 1 : c->box_count == 1 ? 1.5 : 3, made);
}

static int try_heights(chooser *c, choice *made)
{
    static const double parts[] = {1, 0.5, 0.85, 0.7};
    stand stands[STANDS];
    uint32_t count = 0;
    int yaw = 0;
    for (int i = 1; i < YAWS; i++)
        yaw = made->scores[i] > made->scores[yaw] ? i : yaw;
    const stand *side = &made->sides[yaw];
    for (int height = 0; height < 3 && side->part > 0; height++)
        for (int part = height ? 0 : 2; part < 4; part++)
            stands[count++] = (stand){yaw, heights[height][0], heights[height][1], parts[part], side->about};
    FXS_TRY(try_stands(c, stands, count, 1, made));
    made->scores[yaw] = 0;
    return 0;
}

/* Renders several views of a place. Returns the largest number of Gaussians seen, the mean coverage and the mean share
   of close pixels. */
static int look_about(chooser *c, const stand *stands, uint32_t count, double *most, double *covered, double *close)
{
    sight sights[STANDS];
    *most = *covered = *close = 0;
    FXS_TRY(look_from(c, stands, count, sights));
    for (uint32_t i = 0; i < count; i++) {
        const int64_t largest = sights[i].largest > LARGEST ? sights[i].largest : LARGEST;
        *most = fmax(*most, (double)sights[i].seen * LARGEST / (double)largest);
        *covered += (double)sights[i].covered / (255 * PIXELS) / count;
        *close += (double)sights[i].close / PIXELS / count;
    }
    return 0;
}

static int is_amid(const chooser *c, const double place[3])
{
    return fxs_distance(place, c->core.middle) < c->core.reach / 2;
}

/* Finds camera places inside the scene. `seen` is the most Gaussians seen from such a place. `weighed` is `seen`,
   raised in a room or a hollow core. Elsewhere in an unbounded scene `weighed` is lowered, because the sky covers every
   view. */
static int find_places(chooser *c, double *seen, double *weighed)
{
    fxs_within within[FXS_WITHIN_MOST];
    const int count = fxs_within_find(within, &c->sample, &c->core, c->up);
    const int is_bounded = c->box_count == 1;
    c->place_count = 0;
    *seen = *weighed = 0;
    for (int p = 0; p < count; p++) {
        stand stands[AROUND];
        box *b = &c->places[c->place_count];
        double most, covered, close;
        for (int i = 0; i < 3; i++) {
            b->low[i] = within[p].place[i] - within[p].clear / 2;
            b->high[i] = within[p].place[i] + within[p].clear / 2;
        }
        for (int i = 0; i < AROUND; i++)
            stands[i] = (stand){2 * i, heights[1][0], heights[1][1], 0, b};
        FXS_TRY(look_about(c, stands, AROUND, &most, &covered, &close));
        if (covered < OPEN || close > 0.25)
            continue;
        const int surrounded = covered > CLOSED && (is_bounded || is_amid(c, within[p].place));
        *seen = fmax(*seen, most);
        *weighed = fmax(*weighed, most * (is_bounded ? surrounded ? 1.5 : 1 : surrounded ? 3 : 0.67));
        c->place_count++;
    }
    return 0;
}

static double size_of(const box *b)
{
    return (b->high[0] - b->low[0]) + (b->high[1] - b->low[1]) + (b->high[2] - b->low[2]);
}

static void find_boxes(chooser *c)
{
    const fxs_core *core = &c->core;
    box *b = c->boxes;
    c->close = INFINITY;
    for (int i = 0; i < 3; i++) {
        c->close = fmin(c->close, 0.15 * (core->high[i] - core->low[i]));
        b[1].low[i] = core->low[i];
        b[1].high[i] = core->high[i];
        b[2].low[i] = fmax(core->low[i], core->middle[i] - 2.5 * core->reach);
        b[2].high[i] = fmin(core->high[i], core->middle[i] + 2.5 * core->reach);
    }
    c->box_count = size_of(&b[0]) > UNBOUNDED * size_of(&b[1]) ? BOXES : 1;
}

static int find_stands(chooser *c, const double known[3])
{
    stand stands[2 * AROUND];
    double outside, inside, weighed, covered, close;
    FXS_TRY(fxs_core_find(&c->core, &c->sample, c->message));
    find_boxes(c);
    for (int i = 0; i < 2 * AROUND; i++) {
        const double rise = i & 2 && c->box_count > 1 ? -heights[0][1] : heights[0][1];
        stands[i] = (stand){i / 2 * 2, heights[0][0], rise, i % 2 ? 0.5 : 1, &c->boxes[c->box_count - 1]};
    }
    FXS_TRY(look_about(c, stands, 2 * AROUND, &outside, &covered, &close));
    FXS_TRY(find_places(c, &inside, &weighed));
    c->standing = inside > WITHIN_STANDING * outside ? 0 : fxs_core_stands(&c->core);
    c->is_within = weighed > WITHIN * outside && !c->standing;
    const double assumed[3] = {c->up[0], c->up[1], c->up[2]};
    FXS_TRY(find_up(c, known));
    if (memcmp(assumed, c->up, sizeof assumed))
        FXS_TRY(find_places(c, &inside, &weighed));
    c->place_count = c->standing ? 0 : c->place_count;
    return 0;
}

static int choose(chooser *c, const double up[3], fxs_first_choice *first)
{
    choice made = {.best = {0, heights[0][0], heights[0][1], 1, &c->boxes[0]}};
    memcpy(c->up, is_direction(up) ? up : (double[3]){0, -1, 0}, sizeof c->up);
    if (c->sample.point_count > 0) {
        FXS_TRY(find_stands(c, up));
        for (int i = 0; i < c->box_count; i++)
            FXS_TRY(try_sides(c, &c->boxes[i], &made));
        for (int i = 0; i < c->place_count; i++)
            FXS_TRY(try_place(c, i, &made));
        for (int i = 0; i < SIDES_TRIED; i++)
            FXS_TRY(try_heights(c, &made));
    }
    return first_of(first, &made.best, c->up, c->message);
}

static int set_up(chooser *c)
{
    const size_t bytes = fxs_frame_bytes(&c->context, c->sample.objects, c->sample.count, WIDTH, HEIGHT, NULL);
    uint32_t first = 0;
    for (uint32_t i = 0; i < c->sample.count; i++) {
        c->sample.objects[i].id = first;
        first += c->sample.scenes[i].count;
    }
    c->frame_bytes = (bytes + 63) / 64 * 64;
    c->looks = fxs_allocate(NULL, c->threads, sizeof *c->looks);
    c->frames = fxs_allocate(NULL, c->threads * c->frame_bytes + 63, 1);
    return c->looks && c->frames ? 0 : fxs_fail_memory(c->message, NULL, c->threads * c->frame_bytes);
}

int fxs_first_view_choose(fxs_first_choice *first, const fxs_context *context, const fxs_object *objects,
                          uint32_t count, const double low[3], const double high[3], const double up[3],
                          fxs_message *message)
{
    chooser c = {.context = *context, .config = &context->config, .threads = 1, .message = message};
    memcpy(c.boxes[0].low, low, sizeof c.boxes[0].low);
    memcpy(c.boxes[0].high, high, sizeof c.boxes[0].high);
    c.context.config = (fxs_config){.size = sizeof(fxs_config), .workers.count = 1, .kernels = context->config.kernels};
    if (c.config->workers.run && c.config->workers.count)
        c.threads = c.config->workers.count < THREADS_MOST ? c.config->workers.count : THREADS_MOST;
    FXS_TRY(fxs_sample_take(&c.sample, objects, count, message));
    int error = set_up(&c);
    unsigned char *block = c.frames;
    if (!error) {
        c.frames += (64 - (uintptr_t)block % 64) % 64;
        error = choose(&c, up, first);
    }
    fxs_release(NULL, block);
    fxs_release(NULL, c.looks);
    fxs_sample_free(&c.sample);
    return error;
}
