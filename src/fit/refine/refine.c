/* Refines the levels of detail of a packed scene. The leaves of its tree are chunks of 256 Gaussians; a node is one
 * merged chunk that stands for two children. Leaves have level 0, a node one more than its higher child. The cover of
 * level L is the coarsest set of chunks up to level L that stands for all leaves. From the leaves up, the nodes of each
 * cover are fitted to pictures of the leaves. The error of a node in a view is measured in the picture of the cover of
 * its level: the squared difference from the picture of the leaves, distributed at each pixel by the blending weights
 * of the Gaussians. The gain of replacing a node by its children is the node's error minus its children's errors. It is
 * multiplied by (distance / focal length)^2 as in src/core/cut.c, and averaged over the views that see the node. */
#include <fixsplat/fit.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <fixsplat/internal/message.h>
#include <fixsplat/internal/packed.h>
#include "src/base/exponential.h"
#include "src/base/report.h"
#include "src/base/options.h"
#include "src/base/try_internal.h"
#include "src/core/chunk.h"
#include "src/gaussian/origin_internal.h"
#include "src/core/codes.h"
#include "src/pack/decode.h"
#include "src/pack/move.h"
#include "src/pack/tree.h"
#include "src/fit/fit_internal.h"
#include "src/fit/stages/planes.h"
#include "src/base/random.h"
#include "refine_views.h"

#define LOGIT_MOST 7.0f                /* logits of opacity are clamped to this; larger ones have practically no
                                          gradient */
#define LARGE 3                        /* covers (sets of chunks of one level of detail) with more than 1/LARGE of the
                                          Gaussians are fitted to large pictures */
#define LAST 0.1                       /* last learning rate, relative to the first */

typedef struct refiner {
    fxs_scene scene;
    fxs_node *nodes;
    uint8_t *levels;                   /* level of detail of each chunk: leaves first, then nodes */
    uint32_t *parents;                 /* parent node of each chunk; 0: none */
    uint32_t chunks, leaves;
    int highest;
    const fxs_refine_options *options;
    fxs_refine_views views;
    fxs_fit_stepper *stepper;
    fxs_tree_editor *editor;
    float *errors;                     /* error of each node of the tree in each view, as squared colour differences
                                          summed over pixels; below 0: not visible */
    fxs_fit_model model;               /* Gaussians of the cover (the chunks chosen for a level of detail): nodes first,
                                          then leaves */
    uint32_t *cover, *starts;          /* chunks of the cover (those chosen for a level of detail), and the first
                                          Gaussian of each */
    uint32_t cover_count, cover_nodes;
    uint32_t order[FXS_REFINE_VIEWS];
    fxs_message *message;
} refiner;

static int fail_memory(const refiner *r, size_t bytes)
{
    return fxs_fail_memory(r->message, "levels of detail", bytes);
}

static int read_tree(refiner *r)
{
    r->leaves = r->scene.chunk_count;
    r->chunks = fxs_scene_chunks(&r->scene);
    r->nodes = malloc((r->leaves - 1) * sizeof *r->nodes);
    r->levels = calloc(r->chunks, sizeof *r->levels);
    r->parents = calloc(r->chunks, sizeof *r->parents);
    r->cover = malloc(r->chunks * sizeof *r->cover);
    r->starts = malloc((r->chunks + (size_t)1) * sizeof *r->starts);
    r->errors = calloc((size_t)(r->leaves - 1) * r->views.count, sizeof *r->errors);
    if (!r->nodes || !r->levels || !r->parents || !r->cover || !r->starts || !r->errors)
        return fail_memory(r, r->chunks * (sizeof *r->nodes + r->views.count * sizeof *r->errors));
    for (uint32_t i = r->leaves - 1; i-- > 0;) {
        uint8_t *level = &r->levels[r->leaves + i];
        fxs_chunk header;
        int error = fxs_node_read(&r->nodes[i], &r->scene, i);
        if (!error)
            error = fxs_chunk_read(&header, &r->scene, r->leaves + i);
        if (error)
            return fxs_fail_as(error, r->message, "%s", fxs_strerror(error));
        for (int side = 0; side < 2; side++) {
            const uint32_t child = r->nodes[i].children[side];
            if (r->parents[child])
                return fxs_fail_as(FXS_ERR_SCENE, r->message, "the tree of levels has a chunk below two nodes");
            r->parents[child] = r->leaves + i;
            if (r->levels[child] == UINT8_MAX)
                return fxs_fail_as(FXS_ERR_SCENE, r->message, "the tree of levels is too deep");
            *level = r->levels[child] + 1 > *level ? (uint8_t)(r->levels[child] + 1) : *level;
        }
    }
    r->highest = r->levels[r->leaves];
    return 0;
}

static int is_in_cover(const refiner *r, uint32_t chunk, int level)
{
    return r->levels[chunk] <= level && (chunk == r->leaves || r->levels[r->parents[chunk]] > level);
}

static void find_cover(refiner *r, int level)
{
    r->cover_count = 0;
    for (uint32_t c = r->leaves; c < r->chunks; c++)
        if (is_in_cover(r, c, level))
            r->cover[r->cover_count++] = c;
    r->cover_nodes = r->cover_count;
    for (uint32_t c = 0; c < r->leaves; c++)
        if (is_in_cover(r, c, level))
            r->cover[r->cover_count++] = c;
}

static void put(const fxs_fit_model *m, size_t i, const fxs_gaussian *g)
{
    for (int k = 0; k < FXS_FIT_PARAMETERS; k++)
        memcpy(&plane(m, k)[i], (const char *)g + (size_t)k * sizeof(float), sizeof(float));
    plane(m, FXS_FIT_OPACITY)[i] = fminf(fmaxf(g->opacity, -FXS_FIT_FARTHEST), LOGIT_MOST);
}

static void take(const fxs_fit_model *m, size_t i, fxs_gaussian *g)
{
    double square = 0;
    for (int k = 0; k < FXS_FIT_PARAMETERS; k++)
        memcpy((char *)g + (size_t)k * sizeof(float), &plane(m, k)[i], sizeof(float));
    for (int k = 0; k < 4; k++)
        square += (double)g->rotation[k] * g->rotation[k];
    for (int k = 0; k < 4; k++)
        g->rotation[k] = (float)(g->rotation[k] / sqrt(square));
}

static uint32_t read_chunk(const refiner *r, uint32_t number, const fxs_fit_model *model, size_t at)
{
    const unsigned char *rows = fxs_rows(&r->scene, number);
    fxs_gaussian g;
    fxs_chunk chunk;
    uint32_t count = 0;
    memcpy(&chunk, fxs_header(&r->scene, number), sizeof chunk);
    fxs_chunk_turn(&chunk);
    for (uint32_t slot = 0; slot < FXS_CHUNK; slot++) {
        if (fxs_slot_is_empty(&r->scene, rows, slot))
            continue;
        if (model) {
            fxs_decode(&r->scene, &chunk, rows, slot, &g);
            put(model, at + count, &g);
        }
        count++;
    }
    return count;
}

static int read_cover(refiner *r)
{
    r->starts[0] = 0;
    for (uint32_t i = 0; i < r->cover_count; i++)
        r->starts[i + 1] = r->starts[i] + read_chunk(r, r->cover[i], NULL, 0);
    const size_t count = r->starts[r->cover_count];
    fxs_fit_model_free(&r->model);
    if (fxs_fit_model_room(&r->model, count) || fxs_fit_model_resize(&r->model, count))
        return fail_memory(r, count * 4 * FXS_FIT_PARAMETERS * sizeof(float));
    for (uint32_t i = 0; i < r->cover_count; i++)
        read_chunk(r, r->cover[i], &r->model, r->starts[i]);
    return 0;
}

/* Merges the refined children of each node of a level again. The results are the Gaussians of the node, before it is
   refined too. */
static void merge_again(refiner *r, int level)
{
    for (uint32_t i = 0; i < r->cover_nodes; i++)
        if (r->levels[r->cover[i]] == level)
            fxs_tree_edit_merge(r->editor, r->cover[i] - r->leaves);
}

static void write_cover(refiner *r)
{
    fxs_gaussian gaussians[FXS_CHUNK];
    for (uint32_t i = 0; i < r->cover_nodes; i++) {
        const uint32_t count = r->starts[i + 1] - r->starts[i];
        for (uint32_t g = 0; g < count; g++)
            take(&r->model, r->starts[i] + g, &gaussians[g]);
        fxs_tree_edit_node(r->editor, r->cover[i] - r->leaves, gaussians, count);
    }
}

static int note(const refiner *r, int level, double part)
{
    const fxs_refine_options *o = r->options;
    return fxs_report(&o->progress, (level - 1 + part) / r->highest)
               ? fxs_fail_as(FXS_ERR_STOPPED, r->message, "refining stopped") : 0;
}

static void set_rates(const refiner *r, uint32_t step, fxs_fit_step_options *to)
{
    const float fall = (float)fxs_exp(fxs_log(LAST) * step / r->options->steps);
    for (int i = 0; i < FXS_FIT_PARAMETERS; i++)
        to->rate[i] = fall * (i < FXS_FIT_SCALE      ? 5e-5f * r->views.extent
                              : i < FXS_FIT_ROTATION ? 0.01f
                              : i < FXS_FIT_OPACITY  ? 0.001f
                              : i < FXS_FIT_COLOUR   ? 0.05f
                              : i < FXS_FIT_SH       ? 0.005f
                                                     : 0.001f);
}

/* Returns the view of step `number`. Steps visit all views in a random order, then again in another random order
   (Fisher and Yates). */
static const fxs_fit_photograph *choose_view(refiner *r, int level, uint32_t number)
{
    const uint32_t count = r->views.count, at = number % count;
    for (uint32_t i = 0; i < count && at == 0; i++)
        r->order[i] = i;
    for (uint32_t i = count - 1; i > 0 && at == 0; i--) {
        const uint32_t j = (uint32_t)(fxs_random((uint64_t)level, number, i) % (i + 1)), swap = r->order[i];
        r->order[i] = r->order[j];
        r->order[j] = swap;
    }
    const int size = r->starts[r->cover_count] > r->scene.count / LARGE ? FXS_REFINE_LARGE : FXS_REFINE_SMALL;
    return &r->views.photographs[size][r->order[at]];
}

static int refine_cover(refiner *r, int level)
{
    const uint32_t steps = r->options->steps;
    fxs_fit_step_options options = {.sh_degree = r->scene.sh_degree, .changed = r->starts[r->cover_nodes]};
    fxs_fit_report report;
    for (uint32_t step = 1; step <= steps; step++) {
        const int error = note(r, level, 0.9 * step / steps);
        if (error)
            return error;
        set_rates(r, step, &options);
        options.number = step;
        if (fxs_fit_stepper_step(r->stepper, &r->model, choose_view(r, level, step - 1), 1, &options, &report))
            return fail_memory(r, 0);
    }
    write_cover(r);
    return 0;
}

static float *errors_of(const refiner *r, uint32_t node)
{
    return r->errors + (size_t)node * r->views.count;
}

static void note_errors(const refiner *r, uint32_t i, uint32_t view, const float *found)
{
    double sum = 0, seen = 0;
    for (uint32_t g = r->starts[i]; g < r->starts[i + 1]; g++) {
        sum += (double)found[g];
        seen += (double)r->model.views[g];
    }
    errors_of(r, r->cover[i] - r->leaves)[view] = seen > 0 ? (float)sum : -1;
}

static int measure_cover(refiner *r, int level)
{
    const fxs_fit_step_options options = {.sh_degree = r->scene.sh_degree};
    float *found = malloc(r->model.stride * sizeof *found);
    int error = found ? 0 : fail_memory(r, r->model.stride * sizeof *found);
    for (uint32_t v = 0; v < r->views.count && !error; v++) {
        memset(r->model.views, 0, r->model.stride * sizeof *r->model.views);
        if (fxs_fit_find_errors(r->stepper, &r->model, &r->views.photographs[FXS_REFINE_SMALL][v], &options, found,
                                NULL))
            error = fail_memory(r, 0);
        for (uint32_t i = 0; i < r->cover_nodes && !error; i++)
            if (r->levels[r->cover[i]] == level)
                note_errors(r, i, v, found);
    }
    free(found);
    return error;
}

/* Returns the squared distance from a camera to a chunk's bounding box, plus 1/64 of the box's squared diagonal. */
static double square_distance(const refiner *r, uint32_t number, const float eye[3])
{
    fxs_chunk chunk;
    double square = 0;
    memcpy(&chunk, fxs_header(&r->scene, number), sizeof chunk);
    fxs_chunk_turn(&chunk);
    for (int k = 0; k < 3; k++) {
        const double low = ldexp((double)chunk.origin_q32[k], -32);
        const double reach = ldexp((double)((int64_t)chunk.step_q32[k] * 65535 << chunk.step_shift), -32);
        const double below = low - (double)eye[k], above = -below - reach, out = fmax(fmax(below, above), 0);
        square += out * out + reach * reach / 64;
    }
    return square;
}

static double error_in(const refiner *r, uint32_t chunk, uint32_t view)
{
    return chunk < r->leaves ? 0 : fmax((double)errors_of(r, chunk - r->leaves)[view], 0);
}

static double gain_of(const refiner *r, uint32_t node)
{
    const uint32_t *children = r->nodes[node].children;
    double sum = 0, views = 0;
    for (uint32_t v = 0; v < r->views.count; v++) {
        const fxs_fit_camera *c = &r->views.photographs[FXS_REFINE_SMALL][v].camera;
        const double focal = fmax((double)c->focal[0], (double)c->focal[1]), own = (double)errors_of(r, node)[v];
        if (own < 0)
            continue;
        sum += (own - error_in(r, children[0], v) - error_in(r, children[1], v)) / (focal * focal) *
               square_distance(r, r->leaves + node, c->eye);
        views++;
    }
    return views > 0 ? sum / views : 0;
}

static int write_gains(refiner *r)
{
    double *gains = malloc((r->leaves - 1) * sizeof *gains);
    if (!gains)
        return fail_memory(r, r->leaves * sizeof *gains);
    for (uint32_t i = 0; i < r->leaves - 1; i++)
        gains[i] = gain_of(r, i);
    const int error = fxs_tree_edit_gains(r->editor, gains, r->message);
    free(gains);
    return error;
}

static int refine_all(refiner *r, void *data)
{
    const fxs_refine_options *o = r->options;
    int error = fxs_refine_views_make(&r->views, &r->scene, data, o, r->message);
    if (!error)
        error = read_tree(r);
    if (!error)
        error = fxs_tree_edit(&r->editor, &r->scene, data, r->message);
    if (!error) {
        const fxs_config *c = &o->context->config;
        r->stepper = fxs_fit_stepper_create(fxs_fit_stages_choose(o->cpu), c->workers.run, c->workers.pool,
                                            c->workers.count, NULL);
        error = r->stepper ? 0 : fail_memory(r, 0);
    }
    for (int level = 1; level <= r->highest && !error; level++) {
        find_cover(r, level);
        if (o->steps)
            merge_again(r, level);
        error = read_cover(r);
        if (!error && o->steps)
            error = refine_cover(r, level);
        if (!error && o->steps)
            error = read_cover(r);
        if (!error)
            error = measure_cover(r, level);
        if (!error)
            error = note(r, level, 1);
    }
    return error ? error : write_gains(r);
}

static void find_origin(const fxs_scene *scene, double origin[3])
{
    double places[FXS_ORIGIN_SAMPLE][3];
    for (uint64_t i = 0; i < FXS_ORIGIN_SAMPLE; i++)
        fxs_packed_place(fxs_header(scene, (uint32_t)(scene->chunk_count * i / FXS_ORIGIN_SAMPLE)), places[i]);
    fxs_origin_of(origin, places, FXS_ORIGIN_SAMPLE);
}

/* Refines a scene far from the origin: moves it near 0 and refines it there, because steps use floats. */
static int refine_far(void *data, size_t bytes, const fxs_refine_options *options, const double origin[3],
                      fxs_message *message)
{
    fxs_refine_options near = *options;
    fxs_view *views = malloc((options->view_count + 1) * sizeof *views);
    double back[3];
    if (!views)
        return fxs_fail_memory(message, "levels of detail", options->view_count * sizeof *views);
    for (size_t i = 0; i < options->view_count; i++) {
        views[i] = options->views[i];
        for (int k = 0; k < 3; k++)
            views[i].position[k] -= origin[k];
    }
    for (int k = 0; k < 3; k++)
        back[k] = -origin[k];
    near.views = options->views ? views : NULL;
    fxs_packed_move(data, back);
    const int error = fxs_refine(data, bytes, &near, message);
    fxs_packed_move(data, origin);
    free(views);
    return error;
}

int fxs_refine(void *data, size_t bytes, const fxs_refine_options *given, fxs_message *message)
{
    fxs_refine_options all;
    const fxs_refine_options *const options = &all;
    refiner r = {.options = options, .message = message};
    fxs_refine_options_init(&all);
    FXS_TRY(FXS_OPTIONS_READ(fxs_refine_options, &all, given, message));
    if (!data || !options->context || options->steps > FXS_REFINE_STEPS_MOST ||
        (options->view_count && !options->views))
        return fxs_fail_as(FXS_ERR_ARGUMENT, message, "refining: a null pointer, or more than %u steps",
                           FXS_REFINE_STEPS_MOST);
    int error = fxs_scene_open(&r.scene, data, bytes);
    if (error)
        return fxs_fail_as(error, message, "%s", fxs_strerror(error));
    if (!r.scene.nodes)
        return 0;
    if (r.scene.motion)
        return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "a scene that moves is not refined");
    double origin[3];
    find_origin(&r.scene, origin);
    if (fxs_is_far(origin))
        return refine_far(data, bytes, options, origin, message);
    error = refine_all(&r, data);
    fxs_refine_views_free(&r.views);
    fxs_fit_stepper_free(r.stepper);
    fxs_fit_model_free(&r.model);
    fxs_tree_edit_end(r.editor);
    free(r.nodes);
    free(r.levels);
    free(r.parents);
    free(r.cover);
    free(r.starts);
    free(r.errors);
    return error;
}
