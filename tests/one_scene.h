/* Renders a single scene without placement into a single picture. */
#ifndef ONE_SCENE_H
#define ONE_SCENE_H

#include "src/core/object.h"
#include "src/core/count.h"

static inline fxs_object one_object(const fxs_scene *scene)
{
    fxs_object object;
    fxs_object_init(&object, scene);
    return object;
}

static inline fxs_targets one_target(enum fxs_format format, void *pixels, ptrdiff_t stride)
{
    fxs_targets targets;
    fxs_targets_init(&targets);
    targets.format = format;
    targets.colour = (fxs_image){pixels, stride};
    return targets;
}

static inline fxs_request request_for(const fxs_object *objects, uint32_t count, const fxs_options *options,
                                      uint32_t eyes, const fxs_camera *cameras, const fxs_targets *targets)
{
    fxs_request request;
    fxs_request_init(&request, objects, count);
    request.options = *options;
    request.eyes = eyes;
    for (uint32_t eye = 0; eye < eyes; eye++) {
        request.cameras[eye] = cameras[eye];
        if (targets)
            request.targets[eye] = targets[eye];
    }
    return request;
}

static inline int render_frame(const fxs_context *context, const fxs_object *objects, uint32_t count,
                               const fxs_camera *camera, const fxs_options *options, const fxs_targets *targets,
                               void *memory, size_t memory_bytes, fxs_stats *stats)
{
    const fxs_request request = request_for(objects, count, options, 1, camera, targets);
    return fxs_render(context, &request, memory, memory_bytes, stats);
}

static inline int render_eyes(const fxs_context *context, const fxs_object *objects, uint32_t count,
                              const fxs_camera cameras[2], const fxs_options *options, const fxs_targets targets[2],
                              void *memory, size_t memory_bytes, fxs_stats *stats)
{
    const fxs_request request = request_for(objects, count, options, 2, cameras, targets);
    return fxs_render(context, &request, memory, memory_bytes, stats);
}

static inline int count_pairs(const fxs_object *objects, uint32_t count, const fxs_camera *camera,
                              const fxs_options *options, void *memory, size_t memory_bytes, uint64_t *evaluated,
                              uint64_t *blended)
{
    const fxs_request request = request_for(objects, count, options, 1, camera, 0);
    return fxs_count_pairs(&request, memory, memory_bytes, evaluated, blended);
}

static inline int pick_pixel(const fxs_context *context, const fxs_object *objects, uint32_t count,
                             const fxs_camera *camera, const fxs_options *options, const fxs_targets *targets,
                             int32_t x, int32_t y, void *memory, size_t memory_bytes, fxs_pick_result *result)
{
    const fxs_request request = request_for(objects, count, options, 1, camera, targets);
    return fxs_pick(context, &request, x, y, memory, memory_bytes, result);
}

static inline size_t one_frame_bytes(const fxs_context *context, const fxs_scene *scene, int32_t width, int32_t height,
                                     fxs_frame_memory *memory)
{
    const fxs_object object = one_object(scene);
    return fxs_frame_bytes(context, &object, 1, width, height, memory);
}

static inline int one_render(const fxs_context *context, const fxs_scene *scene, const fxs_camera *camera,
                             const fxs_options *options, enum fxs_format format, void *memory, size_t memory_bytes,
                             void *pixels, ptrdiff_t stride, fxs_stats *stats)
{
    const fxs_object object = one_object(scene);
    const fxs_targets targets = one_target(format, pixels, stride);
    return render_frame(context, &object, 1, camera, options, &targets, memory, memory_bytes, stats);
}

static inline int one_count_pairs(const fxs_scene *scene, const fxs_camera *camera, const fxs_options *options,
                                  void *memory, size_t memory_bytes, uint64_t *evaluated, uint64_t *blended)
{
    const fxs_object object = one_object(scene);
    return count_pairs(&object, 1, camera, options, memory, memory_bytes, evaluated, blended);
}

/* Renders a stereo pair. The pictures of both eyes have the same stride. */
static inline int one_render_stereo(const fxs_context *context, const fxs_scene *scene, const fxs_camera cameras[2],
                                    const fxs_options *options, enum fxs_format format, void *memory,
                                    size_t memory_bytes, void *const pixels[2], ptrdiff_t stride, fxs_stats *stats)
{
    const fxs_object object = one_object(scene);
    const fxs_targets targets[2] = {one_target(format, pixels[0], stride), one_target(format, pixels[1], stride)};
    return render_eyes(context, &object, 1, cameras, options, targets, memory, memory_bytes, stats);
}

/* Computes the camera in the coordinates of the scene, as the renderer's stages receive the camera. */
static inline int one_view_init(fxs_stage_view *view, const fxs_scene *scene, const fxs_camera *camera,
                                const fxs_options *options)
{
    fxs_stage_view world;
    const fxs_object object = one_object(scene);
    const int error = fxs_view_init(&world, camera, options);
    return error ? error : fxs_view_of_object(view, &world, camera, &object);
}

#endif
