/* The arguments of a frame: checked, its objects placed, its memory measured. */
#include "memory.h"
#include "parts.h"

/* Counts the chunks of the objects, and checks what needs no camera. */
static int take_objects(fxs_frame *f, const fxs_object *objects, uint32_t count)
{
    uint64_t chunks = 0, gaussians = 0;
    int error = count > FXS_MAX_OBJECTS ? FXS_ERR_OBJECT : 0;
    f->objects = objects;
    f->object_count = count;
    for (uint32_t i = 0; i < count && !error; i++) {
        error = fxs_object_check(&objects[i]);
        chunks += error ? 0 : objects[i].scene->chunk_count;
        gaussians += error ? 0 : objects[i].scene->count;
    }
    if (!error && chunks > FXS_MAX_COUNT / FXS_CHUNK)
        error = FXS_ERR_OBJECT;
    f->chunk_count = (uint32_t)chunks;
    f->stats.gaussians = (uint32_t)gaussians;
    return error;
}

static int check(const fxs_context *context, const fxs_object *objects, uint32_t count, const fxs_camera *camera,
                 const fxs_options *options, const void *memory)
{
    return !context || (!objects && count) || !camera || !options || !memory || options->sh_degree < 0 ||
           options->sh_degree > 3 ||
           (options->cutoff != FXS_CUTOFF_MAHALANOBIS && options->cutoff != FXS_CUTOFF_SQUARE)
               ? FXS_ERR_ARGUMENT : 0;
}

static int eye_init(fxs_eye *eye, const fxs_camera *camera, const fxs_options *options, const fxs_targets *targets)
{
    eye->camera = *camera;
    eye->targets = targets;
    const int error = fxs_view_init(&eye->view, camera, options);
    return error || !targets ? error : fxs_targets_check(targets, camera->width, camera->height);
}

int fxs_frame_init(fxs_frame *f, const fxs_context *context, const fxs_object *objects, uint32_t count,
                   const fxs_camera *camera, const fxs_options *options, const fxs_targets *targets, void *memory,
                   size_t memory_bytes)
{
    memset(f, 0, sizeof *f);
    int error = check(context, objects, count, camera, options, memory);
    error = error ? error : take_objects(f, objects, count);
    error = error ? error : eye_init(&f->eyes[0], camera, options, targets);
    if (error)
        return error;
    f->context = context;
    f->options = options;
    f->memory = memory;
    f->memory_bytes = memory_bytes;
    f->eye = f->eyes;
    f->eye_count = 1;
    f->draw_tile = context->config.draw ? 0 : fxs_draw_tile;
    f->only_tile = FXS_NOTHING;
    return (uintptr_t)memory % 64 ? FXS_ERR_MEMORY : 0;
}

int fxs_frame_add_eye(fxs_frame *f, const fxs_camera *camera, const fxs_targets *targets)
{
    f->eye_count = 2;
    return eye_init(&f->eyes[1], camera, f->options, targets);
}

/* Each object as each eye sees it. */
static int place_objects(fxs_frame *f)
{
    uint32_t first_chunk = 0;
    for (uint32_t i = 0; i < f->object_count; i++) {
        for (fxs_eye *eye = f->eye; eye < f->eye + f->eye_count; eye++) {
            const int error = fxs_object_view_init(&eye->objects[i], &eye->view, &eye->camera, &f->objects[i]);
            if (error)
                return error;
            eye->objects[i].first_chunk = first_chunk;
        }
        first_chunk += f->objects[i].scene->chunk_count;
    }
    return 0;
}

int fxs_frame_begin(fxs_frame *f)
{
    int error = fxs_bands_init(f);
    error = error ? error : place_objects(f);
    return error || f->mode == FXS_FRAME_WHOLE ? error : fxs_bands_plan(f);
}

size_t fxs_measure(const fxs_context *context, const fxs_object *objects, uint32_t count, int32_t width,
                   int32_t height, uint32_t eyes, fxs_frame_memory *memory)
{
    fxs_frame f;
    memset(&f, 0, sizeof f);
    if (!context || (!objects && count) || width < 1 || height < 1 || width > FXS_MAX_SIZE || height > FXS_MAX_SIZE ||
        take_objects(&f, objects, count))
        return 0;
    f.context = context;
    f.eye = f.eyes;
    f.eye_count = eyes;
    f.eyes[0].view.tiles_x = (width + FXS_TILE - 1) / FXS_TILE;
    f.eyes[0].view.tiles_y = (height + FXS_TILE - 1) / FXS_TILE;
    if (fxs_bands_measure(&f) > SIZE_MAX)
        return 0;
    if (memory)
        *memory = f.stats.memory;
    return f.stats.memory.total;
}

size_t fxs_frame_bytes(const fxs_context *context, const fxs_object *objects, uint32_t count, int32_t width,
                       int32_t height, fxs_frame_memory *memory)
{
    return fxs_measure(context, objects, count, width, height, 1, memory);
}
