/* Finds the Gaussians of marked objects: adds up weights, then cuts a graph of neighbours for each object.
 *
 * The cut minimises, over the Gaussians i in the object and j outside,
 *   sum over i of -u_i  +  sum over neighbours i, j of c_ij,
 * where u = (A - B - bias (A + B)) / (A + B + SURE) for a Gaussian with the weights A in the object's pixels and B in
 * others, and c falls with the distance and the difference in colour. A Gaussian without weight has a small u below 0,
 * and a lower one if the rest has its colour more often than the object. */
#include <fixsplat/select.h>

#include <math.h>
#include <string.h>

#include <fixsplat/internal/message.h>
#include <fixsplat/internal/packed.h>
#include <fixsplat/internal/weigh.h>
#include "src/base/run.h"
#include "src/core/codes.h"
#include "src/core/sized.h"
#include "src/gaussian/nearest.h"
#include "src/pack/decode.h"
#include "min_cut.h"

enum {
    EVIDENCE = 1024,                   /* |u| of a Gaussian that is surely seen, as a capacity */
    LINK = 256,                        /* capacity between near neighbours of one colour */
    HINT = 32,                         /* largest |u| by colour alone */
    SHADES = 6,                        /* shades of a colour channel in a histogram */
    HISTOGRAM = SHADES * SHADES * SHADES,
    MEMORY_DEFAULT_BITS = 31
};

#define SURE (4.0 * FXS_CLEAR_Q15)     /* weight of which half counts: that of four pixels */
#define DOUBT 0.25                     /* share of the weight in FXS_SELECT_PERHAPS that counts */
#define HIDDEN 0.3                     /* sum of |u| of all hidden Gaussians, by the square root of their number */
#define REACH 6.0                      /* an object lies within so many standard deviations of its seen Gaussians */
#define CONTRAST (1.0 / 12)            /* difference in colour that halves a capacity, for a range of 1 */

typedef struct selecting {
    const fxs_context *context;
    fxs_scene scene;
    const fxs_select_view *views;
    fxs_select_options o;
    uint32_t view_count, labels, slots, jobs;
    double bias;
    uint64_t *sums;                    /* weights: of each job, of each slot, of each label: rest, objects, perhaps */
    int *errors;                       /* of each job */
    size_t frame_bytes;                /* the largest memory of a view's frame */
    float *planes[3];                  /* position of each slot */
    uint8_t *colours;                  /* red, green and blue of each slot; a slot without a Gaussian has is_full 0 */
    uint8_t *is_full;
} selecting;

/* ---- Weights ----------------------------------------------------------------------------------------------------- */

static uint64_t *sums_of(const selecting *s, uint32_t job, size_t slot)
{
    return s->sums + ((size_t)job * s->slots + slot) * s->labels;
}

/* Weighs views job, job + jobs, ... */
static void weigh_views(void *argument, uint32_t job)
{
    selecting *s = argument;
    const fxs_allocator *a = s->o.allocator;
    uint8_t *marks = NULL;
    void *block = fxs_allocate(a, s->frame_bytes + 63, 1);
    int error = block ? 0 : FXS_ERR_MEMORY;
    for (uint32_t v = job; v < s->view_count && !error; v += s->jobs) {
        const fxs_camera *c = &s->views[v].camera;
        const size_t pixels = (size_t)c->width * (size_t)c->height;
        marks = fxs_allocate(a, pixels, 1);
        for (size_t i = 0; i < pixels && marks; i++) {
            const uint8_t mark = s->views[v].marks[i];
            marks[i] = mark == FXS_SELECT_PERHAPS ? (uint8_t)(s->labels - 1) : mark;
        }
        fxs_object object;
        fxs_request request;
        fxs_object_init(&object, &s->scene);
        fxs_request_init(&request, &object, 1);
        request.cameras[0] = *c;
        error = marks ? fxs_weigh(s->context, &request, marks, s->labels, sums_of(s, job, 0),
                                  (void *)(((uintptr_t)block + 63) / 64 * 64), s->frame_bytes)
                      : FXS_ERR_MEMORY;
        fxs_release(a, marks);
    }
    fxs_release(a, block);
    s->errors[job] = error;
}

/* Adds the sums of all jobs to those of the first. */
static void join_sums(selecting *s)
{
    const size_t count = (size_t)s->slots * s->labels;
    for (uint32_t job = 1; job < s->jobs; job++)
        for (size_t i = 0; i < count; i++)
            s->sums[i] += s->sums[job * count + i];
}

static int find_frame_bytes(selecting *s, fxs_message *m)
{
    for (uint32_t v = 0; v < s->view_count; v++) {
        fxs_object object;
        fxs_request request;
        fxs_object_init(&object, &s->scene);
        fxs_request_init(&request, &object, 1);
        request.cameras[0] = s->views[v].camera;
        const size_t bytes = fxs_request_bytes(s->context, &request, NULL);
        if (!bytes)
            return fxs_fail_as(FXS_ERR_CAMERA, m, "picture %u: %s", v, fxs_strerror(FXS_ERR_CAMERA));
        s->frame_bytes = bytes > s->frame_bytes ? bytes : s->frame_bytes;
    }
    return 0;
}

static int weigh(selecting *s, fxs_message *m)
{
    const size_t sums = (size_t)s->slots * s->labels * sizeof *s->sums;
    const uint32_t threads = s->o.workers.run && s->o.workers.count ? s->o.workers.count : 1;
    int error = find_frame_bytes(s, m);
    if (error)
        return error;
    const size_t fits = s->o.max_memory / (sums + s->frame_bytes);
    if (!fits)
        return fxs_fail_memory(m, NULL, (uint64_t)sums + s->frame_bytes);
    s->jobs = threads < s->view_count ? threads : s->view_count;
    s->jobs = fits < s->jobs ? (uint32_t)fits : s->jobs;
    s->sums = fxs_allocate_zeroed(s->o.allocator, s->jobs * (size_t)s->slots * s->labels, sizeof *s->sums);
    s->errors = fxs_allocate_zeroed(s->o.allocator, s->jobs, sizeof *s->errors);
    if (!s->sums || !s->errors)
        return fxs_fail_memory(m, NULL, s->jobs * ((uint64_t)sums + s->frame_bytes));
    fxs_run_fn *run = s->o.workers.run ? s->o.workers.run : fxs_run_here;
    run(s->o.workers.pool, weigh_views, s, s->jobs);
    for (uint32_t job = 0; job < s->jobs && !error; job++)
        error = s->errors[job];
    join_sums(s);
    return error ? fxs_fail_as(error, m, "%s", fxs_strerror(error)) : 0;
}

/* ---- Gaussians --------------------------------------------------------------------------------------------------- */

static uint8_t shade_of(float dc)
{
    const float shade = (0.282094792f * dc + 0.5f) * 255 + 0.5f;
    return shade > 0 ? shade < 255 ? (uint8_t)shade : 255 : 0;
}

static int decode(selecting *s, fxs_message *m)
{
    const fxs_allocator *a = s->o.allocator;
    fxs_chunk chunk;
    float position[3], dc[3];
    for (int k = 0; k < 3; k++)
        s->planes[k] = fxs_allocate(a, s->slots, sizeof *s->planes[k]);
    s->colours = fxs_allocate(a, s->slots, 3);
    s->is_full = fxs_allocate(a, s->slots, 1);
    if (!s->planes[0] || !s->planes[1] || !s->planes[2] || !s->colours || !s->is_full)
        return fxs_fail_memory(m, NULL, 16 * (uint64_t)s->slots);
    for (uint32_t i = 0; i < s->slots; i++) {
        const unsigned char *rows = s->scene.rows + i / FXS_CHUNK * (size_t)s->scene.chunk_bytes;
        if (i % FXS_CHUNK == 0 && fxs_chunk_read(&chunk, &s->scene, i / FXS_CHUNK))
            return fxs_fail_as(FXS_ERR_SCENE, m, "%s", fxs_strerror(FXS_ERR_SCENE));
        const fxs_codes codes = fxs_codes_of(&s->scene, rows, i % FXS_CHUNK);
        s->is_full[i] = codes.colour >> 24 != 0;       /* a Gaussian that an editor deleted has opacity code 0 */
        fxs_decode_point(&chunk, &codes, position, dc);
        for (int k = 0; k < 3; k++) {
            s->planes[k][i] = position[k];
            s->colours[3 * (size_t)i + (size_t)k] = shade_of(dc[k]);
        }
    }
    return 0;
}

/* ---- Evidence of one object -------------------------------------------------------------------------------------- */

/* The Gaussians near an object, as nodes of a graph. */
typedef struct graph {
    uint32_t count, edge_count;
    uint32_t *slots;                   /* slot of each node */
    float *planes[3];
    uint32_t *near;                    /* FXS_NEAR neighbours of each node */
    float *squares;                    /* mean squared distance to them */
    int32_t *terminals;
    fxs_edge *edges;
    uint8_t *side;
} graph;

static void graph_free(graph *g, const fxs_allocator *a)
{
    void *const blocks[] = {g->slots, g->planes[0], g->planes[1], g->planes[2], g->near, g->squares, g->terminals,
                            g->edges, g->side};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
        fxs_release(a, blocks[i]);
}

/* Sets own and other to a slot's weights in the pixels of an object and in all others. */
static void weights_of(const selecting *s, size_t slot, uint32_t object, double *own, double *other)
{
    const uint64_t *sums = sums_of(s, 0, slot);
    uint64_t all = 0;
    for (uint32_t label = 0; label + 1 < s->labels; label++)
        all += sums[label];
    *own = (double)sums[object];
    *other = (double)(all - sums[object]) + DOUBT * (double)sums[s->labels - 1];
}

static double lead_of(const selecting *s, double own, double other)
{
    return own - other - s->bias * (own + other);
}

/* Finds the box in which an object is looked for: its Gaussians' mean and REACH times their widest standard deviation.
   Returns 0 if it has no weight. */
static int find_box(const selecting *s, uint32_t object, double low[3], double high[3])
{
    double sum = 0, mean[3] = {0}, square[3] = {0}, widest = 0;
    for (size_t i = 0; i < s->slots; i++) {
        double own, other;
        weights_of(s, i, object, &own, &other);
        if (!(lead_of(s, own, other) > 0))
            continue;
        sum += own;
        for (int k = 0; k < 3; k++) {
            const double x = (double)s->planes[k][i];
            mean[k] += own * x;
            square[k] += own * x * x;
        }
    }
    for (int k = 0; k < 3 && sum > 0; k++) {
        mean[k] /= sum;
        square[k] = square[k] / sum - mean[k] * mean[k];
        widest = square[k] > widest ? square[k] : widest;
    }
    for (int k = 0; k < 3; k++) {
        low[k] = mean[k] - REACH * sqrt(widest);
        high[k] = mean[k] + REACH * sqrt(widest);
    }
    return sum > 0;
}

static int gather(const selecting *s, uint32_t object, graph *g)
{
    const fxs_allocator *a = s->o.allocator;
    double low[3], high[3];
    if (!find_box(s, object, low, high))
        return FXS_ERR_OBJECT;
    g->slots = fxs_allocate(a, s->slots, sizeof *g->slots);
    for (uint32_t i = 0; i < s->slots && g->slots; i++) {
        int is_inside = s->is_full[i];
        for (int k = 0; k < 3; k++)
            is_inside = is_inside && (double)s->planes[k][i] >= low[k] && (double)s->planes[k][i] <= high[k];
        if (is_inside)
            g->slots[g->count++] = i;
    }
    const size_t room = (size_t)g->count + 1;
    for (int k = 0; k < 3; k++)
        g->planes[k] = fxs_allocate(a, room, sizeof *g->planes[k]);
    g->near = fxs_allocate(a, room, FXS_NEAR * sizeof *g->near);
    g->squares = fxs_allocate(a, room, sizeof *g->squares);
    g->terminals = fxs_allocate(a, room, sizeof *g->terminals);
    g->edges = fxs_allocate(a, room, FXS_NEAR * sizeof *g->edges);
    g->side = fxs_allocate(a, room, 1);
    if (!g->slots || !g->planes[0] || !g->planes[1] || !g->planes[2] || !g->near || !g->squares ||
        !g->terminals || !g->edges || !g->side)
        return FXS_ERR_MEMORY;
    for (uint32_t i = 0; i < g->count; i++)
        for (int k = 0; k < 3; k++)
            g->planes[k][i] = s->planes[k][g->slots[i]];
    return 0;
}

static uint32_t bin_of(const uint8_t *colour)
{
    uint32_t bin = 0;
    for (int k = 0; k < 3; k++)
        bin = SHADES * bin + (uint32_t)(colour[k] * SHADES / 256);
    return bin;
}

/* Spreads a histogram by 1/4, 1/2, 1/4 along each colour channel. */
static void blur(double *colours)
{
    for (int step = 1; step < HISTOGRAM; step *= SHADES)
        for (int i = 0; i < HISTOGRAM; i++)
            if (i / step % SHADES == 0) {
                double before = 0;
                for (int k = 0; k < SHADES; k++) {
                    double *at = colours + i + k * step;
                    const double own = *at, after = k + 1 < SHADES ? at[step] : 0;
                    *at = (before + 2 * own + after) / 4;
                    before = own;
                }
            }
}

/* Sets the terminals: |u| is EVIDENCE for a Gaussian that is surely seen, and at most HINT for one that is not. */
static void set_terminals(const selecting *s, uint32_t object, graph *g)
{
    double own_colours[HISTOGRAM] = {0}, other_colours[HISTOGRAM] = {0}, own_sum = 1, other_sum = 1;
    const double hidden = LINK * HIDDEN / sqrt(g->count);
    double own, other;
    for (uint32_t i = 0; i < g->count; i++) {
        weights_of(s, g->slots[i], object, &own, &other);
        const uint32_t bin = bin_of(s->colours + 3 * (size_t)g->slots[i]);
        own_colours[bin] += own;
        other_colours[bin] += other;
        own_sum += own;
        other_sum += other;
    }
    blur(own_colours);
    blur(other_colours);
    for (uint32_t i = 0; i < g->count; i++) {
        weights_of(s, g->slots[i], object, &own, &other);
        const uint32_t bin = bin_of(s->colours + 3 * (size_t)g->slots[i]);
        const double a = own_colours[bin] / own_sum, b = other_colours[bin] / other_sum, seen = own + other;
        const double unlike = b > a ? (b - a) / (a + b) : 0, sure = seen / (seen + SURE);
        const double lead = seen > 0 ? lead_of(s, own, other) / seen : 0;
        g->terminals[i] = (int32_t)(EVIDENCE * lead * sure - (HINT * unlike + hidden) * (1 - sure));
    }
}

static double square_between(const graph *g, uint32_t i, uint32_t j)
{
    double square = 0;
    for (int k = 0; k < 3; k++) {
        const double d = (double)g->planes[k][i] - (double)g->planes[k][j];
        square += d * d;
    }
    return square;
}

/* The capacity between neighbours, with their distance d, r^2, the mean of their squared distances to neighbours, and
   the difference q of their colours: LINK / ((1 + (d / r)^4) (1 + (q / CONTRAST)^4)). */
static int32_t capacity_of(const selecting *s, const graph *g, uint32_t i, uint32_t j)
{
    const uint8_t *a = s->colours + 3 * (size_t)g->slots[i], *b = s->colours + 3 * (size_t)g->slots[j];
    const double r = ((double)g->squares[i] + (double)g->squares[j]) / 2;
    const double d = square_between(g, i, j) / (r > 1e-30 ? r : 1e-30);
    double q = 0;
    for (int k = 0; k < 3; k++)
        q += ((double)a[k] - b[k]) * ((double)a[k] - b[k]) / (255.0 * 255.0 * CONTRAST * CONTRAST);
    return (int32_t)(LINK / ((1 + d * d) * (1 + q * q)));
}

static int is_near(const graph *g, uint32_t i, uint32_t j)
{
    for (size_t k = 0; k < FXS_NEAR; k++)
        if (g->near[(size_t)i * FXS_NEAR + k] == j)
            return 1;
    return 0;
}

static int link_neighbours(const selecting *s, graph *g)
{
    const float *const planes[3] = {g->planes[0], g->planes[1], g->planes[2]};
    if (fxs_neighbours(planes, g->count, g->near))
        return FXS_ERR_MEMORY;
    for (uint32_t i = 0; i < g->count; i++) {
        double sum = 0;
        for (size_t k = 0; k < FXS_NEAR; k++)
            sum += square_between(g, i, g->near[(size_t)i * FXS_NEAR + k]);
        g->squares[i] = (float)(sum / FXS_NEAR);
    }
    for (uint32_t i = 0; i < g->count; i++)
        for (size_t k = 0; k < FXS_NEAR; k++) {
            const uint32_t j = g->near[(size_t)i * FXS_NEAR + k];
            if (j != i && (i < j || !is_near(g, j, i)))
                g->edges[g->edge_count++] = (fxs_edge){i, j, capacity_of(s, g, i, j)};
        }
    return 0;
}

/* ---- Objects ----------------------------------------------------------------------------------------------------- */

/* Gives a slot to an object, unless another object has more of its weight. */
static void give(const selecting *s, uint32_t slot, uint32_t object, uint8_t *objects)
{
    const uint64_t *sums = sums_of(s, 0, slot);
    if (!objects[slot] || sums[object] > sums[objects[slot]])
        objects[slot] = (uint8_t)object;
}

static int cut_object(const selecting *s, uint32_t object, uint8_t *objects)
{
    graph g = {0};
    int error = gather(s, object, &g);
    if (!error)
        error = link_neighbours(s, &g);
    if (!error) {
        set_terminals(s, object, &g);
        error = fxs_min_cut(g.terminals, g.count, g.edges, g.edge_count, g.side, s->o.allocator);
    }
    for (uint32_t i = 0; i < g.count && !error; i++)
        if (g.side[i])
            give(s, g.slots[i], object, objects);
    graph_free(&g, s->o.allocator);
    return error;
}

static int take_weights(const selecting *s, uint32_t object, uint8_t *objects)
{
    for (uint32_t i = 0; i < s->slots; i++) {
        double own, other;
        weights_of(s, i, object, &own, &other);
        if (s->is_full[i] && lead_of(s, own, other) > 0)
            give(s, i, object, objects);
    }
    return 0;
}

/* Finds the objects with a bias. */
static int find_with(selecting *s, double bias, uint8_t *objects)
{
    int error = 0;
    s->bias = bias < -1 ? -1 : bias > 1 ? 1 : bias;
    memset(objects, 0, s->slots);
    for (uint32_t object = 1; object <= s->o.objects && !error; object++)
        error = s->o.exact ? take_weights(s, object, objects) : cut_object(s, object, objects);
    return error == FXS_ERR_OBJECT ? 0 : error;
}

/* Marks the Gaussians of the border: those in an object with a bias lower by `trim`, but in none with a higher one. */
static int mark_border(selecting *s, uint8_t *objects)
{
    uint8_t *wide = fxs_allocate(s->o.allocator, s->slots, 1);
    const int error = wide ? find_with(s, s->o.bias - s->o.trim, wide) : FXS_ERR_MEMORY;
    for (uint32_t i = 0; i < s->slots && !error; i++)
        if (wide[i] && !objects[i])
            objects[i] = FXS_SELECT_BORDER;
    fxs_release(s->o.allocator, wide);
    return error;
}

static int find_objects(selecting *s, uint8_t *objects, fxs_message *m)
{
    int error = find_with(s, s->o.bias + s->o.trim, objects);
    if (!error && s->o.trim > 0)
        error = mark_border(s, objects);
    if (error)
        return fxs_fail_as(error, m, "%s", fxs_strerror(error));
    for (uint32_t object = 1; object <= s->o.objects; object++)
        if (!memchr(objects, (int)object, s->slots))
            return fxs_fail_as(FXS_ERR_OBJECT, m, "object %u: its marks show no Gaussian more than other marks do",
                               object);
    return 0;
}

/* ---- Arguments --------------------------------------------------------------------------------------------------- */

static int check_view(const fxs_select_view *view, uint32_t number, uint32_t objects, uint8_t *is_marked,
                      fxs_message *m)
{
    const fxs_camera *c = &view->camera;
    if (!view->marks || c->width < 1 || c->height < 1 || c->width > FXS_MAX_SIZE || c->height > FXS_MAX_SIZE)
        return fxs_fail_as(FXS_ERR_ARGUMENT, m, "picture %u: no marks, or a size beyond %d", number, FXS_MAX_SIZE);
    for (size_t i = 0, count = (size_t)c->width * (size_t)c->height; i < count; i++) {
        const uint8_t mark = view->marks[i];
        if (mark > objects && mark < FXS_SELECT_PERHAPS)
            return fxs_fail_as(FXS_ERR_ARGUMENT, m, "picture %u: mark %u, of %u object%s", number, mark, objects,
                               objects == 1 ? "" : "s");
        is_marked[mark] = 1;
    }
    return 0;
}

static int check(const selecting *s, fxs_message *m)
{
    uint8_t is_marked[256] = {0};
    if (s->scene.motion)
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, m, "a scene that moves: objects are found in still scenes");
    if (s->scene.places)
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, m, "a scene in parts: objects are found in whole scenes");
    if (!s->view_count || s->view_count > FXS_SELECT_VIEWS || !(s->o.bias >= -1 && s->o.bias <= 1) ||
        !(s->o.trim >= 0 && s->o.trim <= 1) || s->o.objects > FXS_SELECT_OBJECTS)
        return fxs_fail_as(FXS_ERR_ARGUMENT, m, "expected 1 to %u pictures, 1 to %u objects, a bias from -1 to 1 and "
                           "a trim from 0 to 1", FXS_SELECT_VIEWS, FXS_SELECT_OBJECTS);
    for (uint32_t v = 0; v < s->view_count; v++) {
        const int error = check_view(&s->views[v], v, s->o.objects, is_marked, m);
        if (error)
            return error;
    }
    for (uint32_t object = 1; object <= s->o.objects; object++)
        if (!is_marked[object])
            return fxs_fail_as(FXS_ERR_ARGUMENT, m, "object %u: no pixel of a picture is marked", object);
    return 0;
}

int fxs_select(const fxs_context *context, const fxs_scene *scene, const fxs_select_view *views, uint32_t view_count,
               const fxs_select_options *options, uint8_t *objects, fxs_message *m)
{
    selecting s = {.context = context, .views = views, .view_count = view_count};
    if (!context || !scene || !views || !objects || fxs_sized_read(&s.o, sizeof s.o, options))
        return fxs_fail_as(FXS_ERR_ARGUMENT, m, "an argument is null, or options are not initialised");
    s.o.objects = s.o.objects ? s.o.objects : 1;
    s.o.max_memory = s.o.max_memory ? s.o.max_memory : (size_t)1 << MEMORY_DEFAULT_BITS;
    s.scene = *scene;
    s.scene.nodes = NULL;
    s.slots = scene->chunk_count * FXS_CHUNK;
    s.labels = s.o.objects + 2;
    int error = check(&s, m);
    error = error ? error : weigh(&s, m);
    error = error ? error : decode(&s, m);
    error = error ? error : find_objects(&s, objects, m);
    void *const blocks[] = {s.sums, s.errors, s.planes[0], s.planes[1], s.planes[2], s.colours, s.is_full};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
        fxs_release(s.o.allocator, blocks[i]);
    return error;
}
