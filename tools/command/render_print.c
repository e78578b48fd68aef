/* Prints the results of --stats and --pick of `fixsplat render`. */
#include "cmd_render.h"
#include "src/core/count.h"

#include <inttypes.h>
#include <stdlib.h>

/* Counts the pairs of a pixel and a Gaussian that a picture evaluates and blends. Ignores the option --max-memory. */
static int count_pairs(const fxs_options *options, const world *w, const fxs_camera *camera, uint64_t *evaluated,
                       uint64_t *blended)
{
    fxs_context context;
    fxs_request request;
    fxs_context_init(&context, 0);
    fxs_request_init(&request, w->objects, w->count);
    request.options = *options;
    request.cameras[0] = *camera;
    const size_t bytes = fxs_frame_bytes(&context, w->objects, w->count, camera->width, camera->height, 0);
    void *allocation = malloc(bytes + 63), *memory = (void *)(((uintptr_t)allocation + 63) / 64 * 64);
    const int error = allocation ? fxs_count_pairs(&request, memory, bytes, evaluated, blended) : FXS_ERR_MEMORY;
    free(allocation);
    return error ? fail(EXIT_FAILED, "%s", fxs_strerror(error)) : 0;
}

static int print_pairs(const renderer *r, const fxs_options *options, const world *w, const fxs_view *view)
{
    fxs_camera camera;
    uint64_t evaluated, blended;
    if (renderer_camera(r, view, &camera) || count_pairs(options, w, &camera, &evaluated, &blended))
        return EXIT_FAILED;
    printf(", \"pairs_evaluated\": %" PRIu64 ", \"pairs_blended\": %" PRIu64, evaluated, blended);
    return 0;
}

int print_stats(const renderer *r, const render_options *o, const world *w, const fxs_view *view,
                const fxs_options *options, const fxs_stats *stats)
{
    const fxs_frame_memory *memory = &stats->memory;
    uint64_t gaussians = 0;
    size_t scene_bytes = 0;
    for (uint32_t i = 0; i < w->count; i++)
        gaussians += w->scenes[w->placed.objects[i].file].opened->report->read;
    for (uint32_t i = 0; i < w->placed.file_count; i++)
        scene_bytes += w->scenes[i].opened->bytes;
    printf("{\"gaussians\": %" PRIu64 ", \"packed\": %" PRIu32 ", \"drawn\": %" PRIu32 ", \"visible\": %" PRIu32
           ", \"entries\": %" PRIu64 ", \"bands\": %" PRIu32 ", \"slices\": %" PRIu32 ", \"runs\": %" PRIu32, gaussians,
           stats->gaussians, stats->drawn, stats->visible, stats->entries, stats->bands, stats->slices, stats->runs);
    if (o->pairs && print_pairs(r, options, w, view))
        return EXIT_FAILED;
    printf(", \"frame_ms\": %.3f, \"stages_ms\": {", (double)stats->frame_nanoseconds * 1e-6);
    for (int i = 0; i < FXS_STAGES; i++)
        printf("%s\"%s\": %.3f", i ? ", " : "", fxs_stage_name((enum fxs_stage)i),
               (double)stats->nanoseconds[i] * 1e-6);
    printf("}, \"versions\": {");
    for (int i = 0; i < FXS_STAGES; i++)
        printf("%s\"%s\": \"%s\"", i ? ", " : "", fxs_stage_name((enum fxs_stage)i),
               r->backend->version(r->self, (enum fxs_stage)i));
    printf("}, \"bytes\": {\"scene\": %zu, \"splats\": %zu, \"keys\": %zu, \"tiles\": %zu, \"entries\": %zu, "
           "\"frame\": %zu}}\n", scene_bytes, memory->splats, memory->keys, memory->tiles, memory->entries,
           memory->total);
    return 0;
}

static double units(int64_t q32)
{
    return (double)q32 / 4294967296.0;
}

int print_pick(renderer *r, const render_options *o, const world *w, const fxs_view *view, const fxs_options *options)
{
    fxs_pick_result p;
    const int x = o->pick[0], y = o->pick[1];
    if (x >= view->width || y >= view->height)
        return fail(EXIT_FAILED, "--pick %d,%d: the picture is %dx%d", x, y, view->width, view->height);
    const int found = renderer_pick(r, w, view, options, x, y, &p);
    if (found < 0)
        return EXIT_FAILED;
    progress_end();
    if (!found) {
        printf(o->json ? "{\"x\": %d, \"y\": %d, \"object\": null}\n" : "%d,%d: nothing\n", x, y);
        return 0;
    }
    const char *file = w->scenes[w->placed.objects[p.object].file].path;
    const double depth = units(p.depth_q32), position[3] = {units(p.position_q32[0]), units(p.position_q32[1]),
                                                            units(p.position_q32[2])};
    int digits[3];
    for (int i = 0; i < 3; i++)
        digits[i] = place_digits(position[i], o->json ? 9 : 6);
    if (o->json) {
        printf("{\"x\": %d, \"y\": %d, \"object\": %" PRIu32 ", \"file\": ", x, y, p.object);
        print_json_string(file);
        printf(", \"gaussian\": %" PRIu32 ", \"id\": %" PRIu32 ", \"depth\": %.9g, \"position\": [%.*g, %.*g, %.*g]}\n",
               p.gaussian, p.id, depth, digits[0], position[0], digits[1], position[1], digits[2], position[2]);
    } else {
        printf("%d,%d: object %" PRIu32 ", %s, Gaussian %" PRIu32 ", id %" PRIu32 ", depth %.6g, position %.*g %.*g "
               "%.*g\n", x, y, p.object, file, p.gaussian, p.id, depth, digits[0], position[0], digits[1], position[1],
               digits[2], position[2]);
    }
    return 0;
}
