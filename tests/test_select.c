/* Tests the selection of objects: ten things on a floor between walls, whose Gaussians are known, are found by masks
   and by clicks and compared with the truth. Smallest cuts are compared with all cuts of small graphs. */
#include <math.h>
#include <stdint.h>
#include <string.h>
#include <unistd.h>

#include <fixsplat/camera.h>
#include <fixsplat/renderer.h>
#include <fixsplat/select.h>
#include <fixsplat/system.h>
#include <fixsplat/internal/kernels.h>
#include <fixsplat/internal/weigh.h>
#include "check.h"
#include "scene_writer.h"
#include "uniform.h"
#include "src/pack/decode.h"
#include "src/core/chunk.h"
#include "src/select/min_cut.h"

#define PI 3.14159265358979324

/* ---- Things on a floor ------------------------------------------------------------------------------------------- */

enum { THINGS = 10, DISCS = 2500, FLOOR = 110, VIEWS = 12, WIDTH = 320, HEIGHT = 240 };
enum { BALL, CRATE, RING, CONE, SHAPES };

#define SPACING 0.07

typedef struct thing {
    int shape;
    double at[3], size, turn;
    double colour[3];
} thing;

static thing things[THINGS];

/* Lays out the things in rows, y down: the floor is y = 0. */
static void make_things(void)
{
    static const double colours[THINGS][3] = {
        {0.8, 0.2, 0.15}, {0.2, 0.35, 0.75}, {0.9, 0.8, 0.2}, {0.25, 0.6, 0.25}, {0.55, 0.45, 0.35},
        {0.85, 0.85, 0.85}, {0.15, 0.15, 0.18}, {0.6, 0.25, 0.6}, {0.85, 0.5, 0.2}, {0.2, 0.65, 0.65}
    };
    for (int i = 0; i < THINGS; i++) {
        thing *t = &things[i];
        t->shape = i % SHAPES;
        t->size = 0.45 + 0.15 * ((i * 7) % 10) / 10;
        t->at[0] = -2.25 + 1.5 * (i % 4) + 0.05 * ((i * 3) % 5 - 2);
        t->at[2] = -1.6 + 1.6 * (i / 4) + 0.1 * ((i * 5) % 3 - 1);
        t->at[1] = t->shape == RING ? -0.3 * t->size : -t->size;
        t->turn = 0.7 * i;
        memcpy(t->colour, colours[i], sizeof t->colour);
    }
}

/* Point i of n of a thing around the origin, and its normal. */
static void point_of(const thing *t, int i, int n, double p[3], double normal[3])
{
    const double turn = 2 * PI * 0.6180339887498949 * i, part = (i + 0.5) / n, r = t->size;
    if (t->shape == BALL) {
        const double y = 1 - 2 * part, wide = sqrt(1 - y * y);
        memcpy(normal, (double[]){wide * cos(turn), y, wide * sin(turn)}, 3 * sizeof *p);
        for (int k = 0; k < 3; k++)
            p[k] = r * normal[k];
    } else if (t->shape == CRATE) {
        const int side = i % 6, a = side / 2, b = (a + 1) % 3, c = (a + 2) % 3;
        const double sign = side % 2 ? 1 : -1;
        memset(normal, 0, 3 * sizeof *p);
        normal[a] = sign;
        p[a] = sign * r;
        p[b] = r * (2 * fmod(0.7548776662466927 * i, 1) - 1);
        p[c] = r * (2 * fmod(0.5698402909980532 * i, 1) - 1);
    } else if (t->shape == RING) {
        const double around = 2 * PI * part, tube = 0.3 * r, ring = 0.9 * r;
        const double out[3] = {cos(around), 0, sin(around)};
        for (int k = 0; k < 3; k++)
            normal[k] = cos(turn) * out[k] + (k == 1 ? sin(turn) : 0);
        for (int k = 0; k < 3; k++)
            p[k] = ring * out[k] + tube * normal[k];
    } else {
        const double down = sqrt(part), slope = 1 / sqrt(1.25);
        memcpy(p, (double[]){0.8 * r * down * cos(turn), r * (2 * down - 1), 0.8 * r * down * sin(turn)},
               3 * sizeof *p);
        memcpy(normal, (double[]){slope * cos(turn), -0.5 * slope, slope * sin(turn)}, 3 * sizeof *p);
    }
}

static void put_disc(fxs_scene_writer *w, const double at[3], const double normal[3], const double colour[3])
{
    fxs_message m;
    fxs_gaussian g;
    const double noise = uniform(-0.06, 0.06);
    memset(&g, 0, sizeof g);
    const double half[3] = {1 + normal[2], -normal[1], normal[0]};
    const double n = sqrt(half[0] * half[0] + half[1] * half[1] + half[2] * half[2]);
    for (int i = 0; i < 4; i++)
        g.rotation[i] = i == 3 ? 0 : n > 1e-6 ? (float)(half[i] / n) : i == 1;
    for (int i = 0; i < 3; i++) {
        g.position[i] = (float)at[i];
        g.scale[i] = (float)log(i < 2 ? 0.5 * SPACING * uniform(0.8, 1.4) : 0.05 * SPACING);
        g.dc[i] = (float)((colour[i] * (1 + 0.15 * normal[0] - 0.1 * normal[1]) + noise - 0.5) / 0.28209);
    }
    g.opacity = 4;
    CHECK(!fxs_scene_writer_put(w, &g, 1, &m));
}

static void write_thing(fxs_scene_writer *w, const thing *t)
{
    for (int i = 0; i < DISCS; i++) {
        double p[3], normal[3], at[3], turned[3];
        point_of(t, i, DISCS, p, normal);
        const double c = cos(t->turn), s = sin(t->turn);
        memcpy(at, (double[]){t->at[0] + c * p[0] + s * p[2], t->at[1] + p[1], t->at[2] - s * p[0] + c * p[2]},
               sizeof at);
        memcpy(turned, (double[]){c * normal[0] + s * normal[2], normal[1], -s * normal[0] + c * normal[2]}, sizeof at);
        put_disc(w, at, turned, t->colour);
    }
}

/* Floor y = 0.01 and two walls, squares of FLOOR x FLOOR discs. */
static void write_room(fxs_scene_writer *w)
{
    static const double brown[3] = {0.5, 0.42, 0.34}, grey[3] = {0.6, 0.62, 0.65};
    for (int wall = 0; wall < 3; wall++)
        for (int i = 0; i < FLOOR * FLOOR; i++) {
            const double a = SPACING * (i % FLOOR - FLOOR / 2), b = SPACING * (i / FLOOR);
            const double at[3][3] = {{a, 0.01, b - SPACING * FLOOR / 2}, {a, -b, SPACING * FLOOR / 2},
                                     {-SPACING * FLOOR / 2, -b, a}};
            const double normals[3][3] = {{0, -1, 0}, {0, 0, -1}, {1, 0, 0}};
            put_disc(w, at[wall], normals[wall], wall ? grey : brown);
        }
}

static fxs_opened *open_things(void)
{
    char path[] = "/tmp/fixsplat-things-XXXXXX";
    fxs_scene_writer *writer;
    fxs_opened *opened = 0;
    fxs_message m;
    const int descriptor = mkstemp(path);
    make_things();
    if (!CHECK(descriptor >= 0))
        return 0;
    close(descriptor);
    if (CHECK(!open_writer("ply", path, THINGS * DISCS + 3 * FLOOR * FLOOR, 0, 0, &writer, &m))) {
        for (int i = 0; i < THINGS; i++)
            write_thing(writer, &things[i]);
        write_room(writer);
        CHECK(!close_writer(writer, &m));
        CHECK(!fxs_open(path, 0, &opened, &m));
    }
    unlink(path);
    return opened;
}

/* ---- Truth ------------------------------------------------------------------------------------------------------- */

typedef struct truth {
    fxs_opened *opened;
    const fxs_scene *scene;
    uint32_t slots;
    uint8_t *thing_of;              /* of each slot: 1 to THINGS, 0: floor or wall, 255: no Gaussian */
    fxs_camera cameras[VIEWS];
    uint32_t *ids[VIEWS];           /* the largest Gaussian of each pixel */
    uint8_t *pictures[VIEWS];       /* its thing */
} truth;

/* Returns the thing, from 1, whose upright cylinder has a place, or 0. */
static int thing_at(const float p[3])
{
    double least = 1;
    int found = 0;
    for (int i = 0; i < THINGS && (double)p[1] < 0.006; i++) {
        const thing *t = &things[i];
        const double wide = t->size * (t->shape == CRATE ? 1.45 : 1.22);
        const double part = hypot((double)p[0] - t->at[0], (double)p[2] - t->at[2]) / wide;
        found = part < least ? i + 1 : found;
        least = fmin(least, part);
    }
    return found;
}

static void find_truth(truth *t)
{
    fxs_chunk chunk;
    fxs_gaussian g;
    t->slots = t->scene->chunk_count * FXS_CHUNK;
    t->thing_of = malloc(t->slots);
    for (uint32_t i = 0; i < t->slots; i++) {
        CHECK(i % FXS_CHUNK || !fxs_chunk_read(&chunk, t->scene, i / FXS_CHUNK));
        fxs_decode(t->scene, &chunk, t->scene->rows + i / FXS_CHUNK * (size_t)t->scene->chunk_bytes, i % FXS_CHUNK, &g);
        t->thing_of[i] = i < t->scene->count ? (uint8_t)thing_at(g.position) : 255;
    }
}

static void draw_truth(truth *t, int view)
{
    enum { PIXELS = WIDTH * HEIGHT };
    static fxs_id ids[PIXELS];
    fxs_renderer *renderer;
    fxs_request request;
    fxs_object object;
    fxs_message m;
    fxs_view v;
    const fxs_picture picture = {50, WIDTH, HEIGHT};
    const double turn = -0.3 + 2.1 * view / VIEWS;     /* from the open side */
    const double eye[3] = {5.2 * sin(turn), -2.6 - 0.8 * (view % 3), -5.2 * cos(turn)}, at[3] = {0, -0.3, 0};
    CHECK(!fxs_view_look_at(&v, eye, at, (double[]){0, -1, 0}, &picture, &m));
    CHECK(!fxs_camera_from_view(&t->cameras[view], &v, &m));
    fxs_object_init(&object, t->scene);
    fxs_request_init(&request, &object, 1);
    request.cameras[0] = t->cameras[view];
    request.targets[0].id = (fxs_image){ids, 8 * WIDTH};
    if (CHECK(!fxs_renderer_create("cpu", 0, &renderer, &m))) {
        CHECK(!fxs_renderer_render(renderer, &request, 0, &m));
        fxs_renderer_destroy(renderer);
    }
    t->pictures[view] = malloc(PIXELS);
    t->ids[view] = malloc(PIXELS * sizeof *t->ids[view]);
    for (int i = 0; i < PIXELS; i++)
        t->ids[view][i] = ids[i].gaussian;
    for (int i = 0; i < PIXELS; i++)
        t->pictures[view][i] = ids[i].gaussian == FXS_NOTHING ? 0 : t->thing_of[ids[i].gaussian];
}

static int make_truth(truth *t)
{
    memset(t, 0, sizeof *t);
    t->opened = open_things();
    if (!t->opened)
        return -1;
    t->scene = t->opened->scene;
    find_truth(t);
    for (int view = 0; view < VIEWS; view++)
        draw_truth(t, view);
    return 0;
}

static void free_truth(truth *t)
{
    for (int view = 0; view < VIEWS; view++) {
        free(t->pictures[view]);
        free(t->ids[view]);
    }
    free(t->thing_of);
    fxs_close(t->opened);
}

/* Intersection over union of the Gaussians of a thing, and those of the found object. */
static double share_of_gaussians(const truth *t, const uint8_t *objects, int thing_number, int object)
{
    uint32_t both = 0, either = 0;
    for (uint32_t i = 0; i < t->slots; i++) {
        const int is_thing = t->thing_of[i] == thing_number, is_found = objects[i] == object;
        both += (uint32_t)(is_thing && is_found);
        either += (uint32_t)(is_thing || is_found);
    }
    return either ? (double)both / either : 1;
}

/* Likewise of the pixels of a view: those of the thing, and those whose largest Gaussian was found. */
static double share_of_pixels(const truth *t, const uint8_t *objects, int view, int thing_number, int object)
{
    uint32_t both = 0, either = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        const int is_thing = t->pictures[view][i] == thing_number;
        const int is_found = t->ids[view][i] != FXS_NOTHING && objects[t->ids[view][i]] == object;
        both += (uint32_t)(is_thing && is_found);
        either += (uint32_t)(is_thing || is_found);
    }
    return either ? (double)both / either : 1;
}

static fxs_context context;
static fxs_kernels fastest;

/* Smallest shares of a thing's Gaussians, and of its pixels in the views that were not marked. */
typedef struct shares {
    double gaussians, pixels;
} shares;

static shares least_of(const truth *t, const uint8_t *objects, int thing_number, int object, const int *marked,
                       int count)
{
    shares least = {share_of_gaussians(t, objects, thing_number, object), 1};
    for (int view = 0; view < VIEWS; view++) {
        int is_marked = 0;
        for (int i = 0; i < count; i++)
            is_marked |= marked[i] == view;
        if (!is_marked)
            least.pixels = fmin(least.pixels, share_of_pixels(t, objects, view, thing_number, object));
    }
    return least;
}

static int run_select(const truth *t, const fxs_select_view *views, uint32_t count, const fxs_select_options *o,
                      uint8_t *objects)
{
    fxs_message m;
    const int error = fxs_select(&context, t->scene, views, count, o, objects, &m);
    if (error)
        printf("  %s\n", m.text);
    return error;
}

/* A trim takes Gaussians from the objects and from the rest, and gives none to the other. */
static void check_trim(const truth *t, const fxs_select_view *views, fxs_select_options o, const uint8_t *objects)
{
    uint32_t border = 0, wrong = 0;
    uint8_t *trimmed = malloc(t->slots);
    o.trim = 0.4;
    CHECK(!run_select(t, views, 3, &o, trimmed));
    for (uint32_t i = 0; i < t->slots; i++) {
        border += trimmed[i] == FXS_SELECT_BORDER;
        wrong += trimmed[i] != FXS_SELECT_BORDER && trimmed[i] != objects[i];
    }
    CHECK(border > 0 && border < THINGS * DISCS / 10 && !wrong);
    free(trimmed);
}

/* Ten objects at once, by masks in three of the views. */
static void test_masks(const truth *t)
{
    static const int marked[3] = {1, 5, 10};
    fxs_select_view views[3];
    fxs_select_options o;
    shares least = {1, 1};
    uint8_t *objects = malloc(t->slots);
    fxs_select_options_init(&o);
    o.objects = THINGS;
    for (int i = 0; i < 3; i++)
        views[i] = (fxs_select_view){t->cameras[marked[i]], t->pictures[marked[i]]};
    CHECK(!run_select(t, views, 3, &o, objects));
    for (int i = 1; i <= THINGS; i++) {
        const shares s = least_of(t, objects, i, i, marked, 3);
        CHECK(s.gaussians >= 0.95 && s.pixels >= 0.95);
        least = (shares){fmin(least.gaussians, s.gaussians), fmin(least.pixels, s.pixels)};
    }
    printf("  at least %.3f of the Gaussians, %.3f of the pixels\n", least.gaussians, least.pixels);
    check_trim(t, views, o, objects);
    free(objects);
}

/* Finds the pixel of a thing with the most of its pixels in eight directions. */
static int find_click(const truth *t, int view, int thing_number, int32_t *x, int32_t *y)
{
    int best = 0;
    for (int32_t v = 1; v < HEIGHT - 1; v++)
        for (int32_t u = 1; u < WIDTH - 1; u++) {
            int free = 0;
            for (int way = 0; way < 8; way++)
                for (int step = 1; step < 40; step++) {
                    const int to = way < 4 ? way : way + 1;
                    const int32_t a = u + step * (to % 3 - 1), b = v + step * (to / 3 - 1);
                    if (a < 0 || b < 0 || a >= WIDTH || b >= HEIGHT || t->pictures[view][b * WIDTH + a] != thing_number)
                        break;
                    free++;
                }
            if (t->pictures[view][v * WIDTH + u] == thing_number && free > best) {
                best = free;
                *x = u;
                *y = v;
            }
        }
    return best;
}

/* Each thing by one click in one view. */
static void test_click(const truth *t)
{
    static const int view = 5;
    static uint8_t marks[WIDTH * HEIGHT];
    const fxs_select_view marked = {t->cameras[view], marks};
    fxs_select_options o;
    fxs_message m;
    shares least = {1, 1};
    uint8_t *objects = malloc(t->slots);
    fxs_select_options_init(&o);
    for (int i = 1; i <= THINGS; i++) {
        fxs_select_hint hint = {.object = 1};
        CHECK(find_click(t, view, i, &hint.x, &hint.y));
        hint.right = hint.x;
        hint.bottom = hint.y;
        CHECK(!fxs_select_mark(&context, t->scene, &t->cameras[view], &hint, 1, marks, &m));
        CHECK(!run_select(t, &marked, 1, &o, objects));
        const shares s = least_of(t, objects, i, 1, &view, 1);
        CHECK(s.gaussians >= 0.85 && s.pixels >= 0.85);
        least = (shares){fmin(least.gaussians, s.gaussians), fmin(least.pixels, s.pixels)};
    }
    printf("  at least %.3f of the Gaussians, %.3f of the pixels\n", least.gaussians, least.pixels);
    free(objects);
}

/* ---- The same everywhere ----------------------------------------------------------------------------------------- */

static void backwards(void *pool, void (*job)(void *argument, uint32_t i), void *argument, uint32_t jobs)
{
    (void)pool;
    while (jobs--)
        job(argument, jobs);
}

/* Objects are the same by C stages and by the processor's, and for any number of jobs in any order. */
static void test_ways(const truth *t)
{
    static const int marked[3] = {0, 3, 9};
    fxs_select_view views[3];
    fxs_select_options o;
    fxs_context plain;
    fxs_message m;
    uint8_t *objects = malloc(t->slots), *others = malloc(t->slots);
    fxs_select_options_init(&o);
    o.objects = THINGS;
    fxs_context_init(&plain, 0);
    for (int i = 0; i < 3; i++)
        views[i] = (fxs_select_view){t->cameras[marked[i]], t->pictures[marked[i]]};
    CHECK(!run_select(t, views, 3, &o, objects));
    CHECK(!fxs_select(&plain, t->scene, views, 3, &o, others, &m) && !memcmp(objects, others, t->slots));
    for (uint32_t count = 2; count < 5; count++) {
        o.workers = (fxs_workers){backwards, 0, count};
        CHECK(!run_select(t, views, 3, &o, others) && !memcmp(objects, others, t->slots));
    }
    free(objects);
    free(others);
}

/* Weights of two labels add up to those of one label, and in an opaque pixel to 7/8 of its light or more. */
static void test_weights(const truth *t)
{
    enum { VIEW = 4, PIXELS = WIDTH * HEIGHT };
    static uint8_t marks[PIXELS], none[PIXELS];
    fxs_object object;
    fxs_request r;
    uint64_t sum = 0;
    int opaque = 0, wrong = 0;
    fxs_object_init(&object, t->scene);
    fxs_request_init(&r, &object, 1);
    r.cameras[0] = t->cameras[VIEW];
    const size_t bytes = fxs_request_bytes(&context, &r, 0);
    void *memory = check_aligned(bytes);
    uint64_t *one = calloc(t->slots, sizeof *one), *two = calloc(2 * (size_t)t->slots, sizeof *two);
    for (int i = 0; i < PIXELS; i++) {
        marks[i] = t->pictures[VIEW][i] > 4;
        opaque += t->pictures[VIEW][i] != 0;
        none[i] = t->pictures[VIEW][i] ? 0 : 255;
    }
    CHECK(!fxs_weigh(&context, &r, marks, 2, two, memory, bytes));
    memset(marks, 0, PIXELS);
    CHECK(!fxs_weigh(&context, &r, marks, 1, one, memory, bytes));
    for (uint32_t i = 0; i < t->slots; i++)
        wrong += one[i] != two[2 * i] + two[2 * i + 1];
    CHECK(!wrong);
    memset(one, 0, t->slots * sizeof *one);
    CHECK(!fxs_weigh(&context, &r, none, 1, one, memory, bytes));
    for (uint32_t i = 0; i < t->slots; i++)
        sum += one[i];
    CHECK(sum > (uint64_t)opaque * 28000 && sum <= (uint64_t)opaque * 32767);
    CHECK(fxs_weigh(&context, &r, marks, 1, one, memory, bytes / 2) == FXS_ERR_MEMORY);
    CHECK(fxs_weigh(&context, &r, marks, 0, one, memory, bytes) == FXS_ERR_ARGUMENT);
    free(memory);
    free(one);
    free(two);
}

/* ---- Smallest cuts ----------------------------------------------------------------------------------------------- */

enum { NODES = 9 };

static int64_t cost_of(const int32_t *terminals, const fxs_edge *edges, uint32_t count, unsigned side)
{
    int64_t cost = 0;
    for (int i = 0; i < NODES; i++)
        cost += side >> i & 1 ? terminals[i] < 0 ? -terminals[i] : 0 : terminals[i] > 0 ? terminals[i] : 0;
    for (uint32_t e = 0; e < count; e++)
        cost += (side >> edges[e].a & 1) != (side >> edges[e].b & 1) ? edges[e].capacity : 0;
    return cost;
}

/* The cut of random graphs is the least of all, and of the least ones the one within all others. */
static void test_min_cut(void)
{
    for (int round = 0; round < 400; round++) {
        int32_t terminals[NODES], left[NODES];
        fxs_edge edges[24];
        uint8_t side[NODES];
        unsigned found = 0, within = ~0u;
        int64_t least = INT64_MAX;
        const uint32_t count = (uint32_t)uniform(0, 24.999);
        for (int i = 0; i < NODES; i++)
            left[i] = terminals[i] = (int32_t)uniform(-6, 7);
        for (uint32_t e = 0; e < count; e++)
            edges[e] = (fxs_edge){(uint32_t)uniform(0, NODES), (uint32_t)uniform(0, NODES), (int32_t)uniform(0, 5)};
        CHECK(!fxs_min_cut(left, NODES, edges, count, side, 0));
        for (int i = 0; i < NODES; i++)
            found |= (unsigned)side[i] << i;
        for (unsigned k = 0; k < 1u << NODES; k++) {
            const int64_t cost = cost_of(terminals, edges, count, k);
            within = cost < least ? k : cost == least ? within & k : within;
            least = cost < least ? cost : least;
        }
        if (!CHECK(found == within && cost_of(terminals, edges, count, found) == least))
            return;
    }
}

/* ---- Refusals ---------------------------------------------------------------------------------------------------- */

static void test_refusals(const truth *t)
{
    static uint8_t marks[WIDTH * HEIGHT];
    fxs_select_view view = {t->cameras[0], marks};
    fxs_select_options o;
    fxs_message m;
    fxs_select_hint hint = {5, 5, 5, 5, 1};
    uint8_t *objects = malloc(t->slots);
    fxs_select_options_init(&o);
    CHECK(fxs_select(&context, t->scene, &view, 1, &o, objects, &m) == FXS_ERR_ARGUMENT);      /* nothing is marked */
    CHECK(fxs_select(&context, t->scene, &view, 0, &o, objects, &m) == FXS_ERR_ARGUMENT);
    CHECK(fxs_select(&context, 0, &view, 1, &o, objects, &m) == FXS_ERR_ARGUMENT);
    marks[7] = 2;
    CHECK(fxs_select(&context, t->scene, &view, 1, &o, objects, &m) == FXS_ERR_ARGUMENT && strstr(m.text, "mark 2"));
    marks[7] = 1;
    o.bias = NAN;
    CHECK(fxs_select(&context, t->scene, &view, 1, &o, objects, &m) == FXS_ERR_ARGUMENT);
    o.bias = 0;
    o.max_memory = 1000;
    CHECK(fxs_select(&context, t->scene, &view, 1, &o, objects, &m) == FXS_ERR_MEMORY && m.bytes_needed > 1000);
    o.max_memory = 0;
    view.camera.fx_q12 = 0;
    CHECK(fxs_select(&context, t->scene, &view, 1, &o, objects, &m) == FXS_ERR_CAMERA);
    CHECK(fxs_select_mark(&context, t->scene, &view.camera, &hint, 1, marks, &m) == FXS_ERR_CAMERA);
    hint.x = hint.right = WIDTH;
    CHECK(fxs_select_mark(&context, t->scene, &t->cameras[0], &hint, 1, marks, &m) == FXS_ERR_ARGUMENT);
    hint = (fxs_select_hint){5, 5, 5, 5, FXS_SELECT_OBJECTS + 1};
    CHECK(fxs_select_mark(&context, t->scene, &t->cameras[0], &hint, 1, marks, &m) == FXS_ERR_ARGUMENT);
    free(objects);
}

int main(void)
{
    truth t;
    fxs_config config;
    fxs_config_init(&config);
    fxs_kernels_choose(&fastest, ~0u);
    config.kernels = &fastest;
    fxs_context_init(&context, &config);
    if (make_truth(&t))
        return 1;
    RUN_AS("test_masks", test_masks(&t));
    RUN_AS("test_click", test_click(&t));
    RUN_AS("test_ways", test_ways(&t));
    RUN_AS("test_weights", test_weights(&t));
    RUN(test_min_cut);
    RUN_AS("test_refusals", test_refusals(&t));
    free_truth(&t);
    return check_report();
}
