/* Sets up a frame: checks its arguments, transforms its objects to camera space, measures its memory. */
#include <fixsplat/internal/parts.h>
#include "sized.h"
#include "animate.h"
#include "bands.h"
#include "draw.h"
#include "targets.h"
#include "tile_rates.h"

static int take_objects(fxs_frame *f, const fxs_request *request)
{
    const fxs_object *objects = request->objects;
    const uint32_t count = request->count;
    uint64_t chunks = 0, gaussians = 0;
    int error = count > FXS_MAX_OBJECTS ? FXS_ERR_OBJECT : 0;
    f->objects = objects;
    f->object_count = count;
    f->cameras = request->cameras;
    f->eyes = request->eyes;
    for (uint32_t i = 0; i < count && !error; i++) {
        fxs_object object;
        error = fxs_object_read(&object, objects, i);
        error = error ? error : fxs_object_check(&object);
        chunks += error ? 0 : object.scene->chunk_count;
        gaussians += error ? 0 : object.scene->count;
        if (!error && object.scene->motion && f->animated_bytes < fxs_animated_bytes(object.scene))
            f->animated_bytes = fxs_animated_bytes(object.scene);
    }
    if (!error && chunks > FXS_MAX_COUNT / FXS_CHUNK)
        error = FXS_ERR_OBJECT;
    f->cut_room = error ? 0 : fxs_cut_room(objects, count, &request->options);
    f->chunk_count = f->cut_room ? f->cut_room : (uint32_t)chunks;
    f->stats.gaussians = (uint32_t)gaussians;
    return error;
}

static int check(const fxs_context *context, const fxs_request *request, const void *memory)
{
    return !context || !request || (!request->objects && request->count) || !memory || request->eyes < 1 ||
           request->eyes > 2 || request->options.sh_degree < 0 || request->options.sh_degree > 3 ||
           (request->options.cutoff != FXS_CUTOFF_MAHALANOBIS && request->options.cutoff != FXS_CUTOFF_SQUARE)
               ? FXS_ERR_ARGUMENT : 0;
}

int fxs_frame_look(fxs_frame *f, const fxs_request *request, uint32_t eye)
{
    f->camera = &request->cameras[eye];
    f->targets = &request->targets[eye];
    int error = fxs_view_init(&f->view, f->camera, &request->options);
    error = error ? error : fxs_targets_check(f->targets, f->camera->width, f->camera->height);
    return error ? error : fxs_rates_check(&f->targets->rates, &f->view);
}

int fxs_frame_init(fxs_frame *f, const fxs_context *context, const fxs_request *request, void *memory,
                   size_t memory_bytes)
{
    memset(f, 0, sizeof *f);
    int error = check(context, request, memory);
    error = error ? error : take_objects(f, request);
    for (uint32_t eye = request->eyes; !error && eye > 0; eye--)
        error = fxs_frame_look(f, request, eye - 1);
    for (uint32_t eye = 0; !error && context->config.draw && eye < request->eyes; eye++)
        error = request->targets[eye].rates.pixels ? FXS_ERR_UNSUPPORTED : 0;
    if (error)
        return error;
    f->context = context;
    f->options = &request->options;
    f->memory = memory;
    f->memory_bytes = memory_bytes;
    f->draw_tile = context->config.draw ? 0 : fxs_draw_tile;
    f->only_tile = FXS_NOTHING;
    return (uintptr_t)memory % 64 ? FXS_ERR_MEMORY : 0;
}

static int place_objects(fxs_frame *f)
{
    uint32_t first_chunk = 0;
    f->chunk_count = f->cut_room ? f->cut_room : f->chunk_count;
    int error = fxs_bands_init(f);
    for (uint32_t i = 0; i < f->object_count && !error; i++) {
        fxs_object object;
        error = fxs_object_read(&object, f->objects, i);
        const uint32_t chunks = fxs_cut_chunks(object.scene, f->cut_room != 0);
        error = error ? error : fxs_object_view_init(&f->views[i], &f->view, f->camera, &object);
        f->views[i].first_chunk = first_chunk;
        first_chunk += chunks;
        f->views[i].end_chunk = first_chunk;
    }
    return error;
}

static int choose_chunks(fxs_frame *f)
{
    fxs_cut cut = {.objects = f->objects, .object_count = f->object_count, .options = f->options,
                   .cameras = f->cameras, .eyes = f->eyes, .views = f->views, .room = f->cut_room,
                   .memory = f->cut_memory};
    const int error = f->drawn ? 0 : fxs_cut_find(&cut);
    if (error)
        return error;
    if (!f->drawn) {
        f->drawn = cut.drawn;
        f->drawn_count = cut.count;
        f->stats.missing = cut.missing;
    }
    f->chunk_count = f->drawn_count;
    return fxs_bands_init(f);
}

int fxs_foresee(const fxs_context *context, const fxs_request *given, void *memory, size_t memory_bytes)
{
    fxs_frame f;
    fxs_request request;
    int error = fxs_request_read(&request, given);
    error = error ? error : fxs_frame_init(&f, context, &request, memory, memory_bytes);
    if (error || !f.cut_room)
        return error;
    error = place_objects(&f);
    return error ? error : choose_chunks(&f);
}

int fxs_frame_begin(fxs_frame *f)
{
    int error = place_objects(f);
    error = error || !f->cut_room ? error : choose_chunks(f);
    f->stats.drawn = f->chunk_count * FXS_CHUNK;
    return error || f->mode == FXS_FRAME_WHOLE ? error : fxs_bands_plan(f);
}

int fxs_frame_check(fxs_frame *f)
{
    const int error = place_objects(f);
    return error || f->mode == FXS_FRAME_WHOLE || fxs_bands_can_slice(f) ? error : fxs_frame_begin(f);
}

/* Returns the bytes of memory that a frame needs, or 0 if an argument is out of range. Does not read the request's
   cameras. */
static size_t measure(const fxs_context *context, const fxs_request *request, int32_t width, int32_t height,
                      fxs_frame_memory *memory)
{
    fxs_frame f;
    memset(&f, 0, sizeof f);
    if (!context || (!request->objects && request->count) || width < 1 || height < 1 || width > FXS_MAX_SIZE ||
        height > FXS_MAX_SIZE || take_objects(&f, request))
        return 0;
    f.context = context;
    f.view.tiles_x = (width + FXS_TILE - 1) / FXS_TILE;
    f.view.tiles_y = (height + FXS_TILE - 1) / FXS_TILE;
    if (fxs_bands_measure(&f) > SIZE_MAX)
        return 0;
    if (memory)
        *memory = f.stats.memory;
    return f.stats.memory.total;
}

size_t fxs_frame_bytes(const fxs_context *context, const fxs_object *objects, uint32_t count, int32_t width,
                       int32_t height, fxs_frame_memory *memory)
{
    fxs_request request;
    fxs_request_init(&request, objects, count);
    return measure(context, &request, width, height, memory);
}

size_t fxs_request_bytes(const fxs_context *context, const fxs_request *given, fxs_frame_memory *memory)
{
    fxs_request request;
    return !fxs_request_read(&request, given) && (request.eyes == 1 || request.eyes == 2)
               ? measure(context, &request, request.cameras->width, request.cameras->height, memory) : 0;
}
