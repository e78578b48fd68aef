/* Makes a procedural scene of 60,000 Gaussians with levels of detail. Renders frames of the scene. */
#ifndef TREE_SCENE_H
#define TREE_SCENE_H

#include <fixsplat/camera.h>
#include <fixsplat/pack.h>
#include <fixsplat/internal/message.h>

#include "check.h"
#include "tools/command/procedural.h"

enum { TREE_WIDTH = 320, TREE_HEIGHT = 200, TREE_COUNT = 60000 };

static inline long read_made(void *argument, uint64_t first, fxs_gaussian *out, size_t capacity)
{
    const fxs_procedural_scene *scene = argument;
    for (size_t i = 0; i < capacity; i++)
        scene->gaussian(first + i, TREE_COUNT, 1, &out[i]);
    return (long)capacity;
}

static inline int pack_tree(const char *name, enum fxs_profile profile, fxs_packed_scene *to, fxs_scene *scene)
{
    const fxs_procedural_scene *made_scene = fxs_procedural_find(name);
    const fxs_pack_options options = {.size = sizeof(fxs_pack_options), .profile = profile, .tree = 1};
    fxs_message m;
    fxs_scene_file *file;
    fxs_scene_file_info info;
    fxs_pack_report report;
    const fxs_gaussian_source source = {TREE_COUNT, made_scene->sh_degree, 0, read_made, (void *)(uintptr_t)made_scene,
                                        {0}};
    if (fxs_scene_file_open_gaussians("made", &source, NULL, &file, &info, &m))
        return 0;
    const int error = fxs_pack(file, &info, to, &report, &options, &m);
    fxs_scene_file_close(file);
    return !error && !fxs_scene_open(scene, to->data, to->bytes);
}

static inline fxs_camera camera_at(double x, double y, double z)
{
    fxs_message m;
    fxs_view view;
    fxs_camera camera;
    const double eye[3] = {x, y, z}, target[3] = {0, 0, 0}, up[3] = {0, -1, 0};
    CHECK(!fxs_view_look_at(&view, eye, target, up, &(fxs_picture){50, TREE_WIDTH, TREE_HEIGHT}, &m) &&
          !fxs_camera_from_view(&camera, &view, &m));
    return camera;
}

static inline fxs_request request_of(const fxs_object *objects, uint32_t count, fxs_camera camera, uint32_t budget,
                              unsigned char *pixels)
{
    fxs_request request;
    fxs_request_init(&request, objects, count);
    request.options.budget = budget;
    request.cameras[0] = camera;
    request.targets[0].colour = (fxs_image){pixels, 4 * (ptrdiff_t)camera.width};
    return request;
}

/* Renders a frame in `bytes` bytes of memory. bytes 0: as much memory as the request needs. */
static inline fxs_stats draw(const fxs_context *context, const fxs_request *request, size_t bytes)
{
    fxs_stats stats;
    bytes = bytes ? bytes : fxs_request_bytes(context, request, 0);
    void *memory = check_aligned(bytes);
    CHECK(bytes && !fxs_render(context, request, memory, bytes, &stats));
    free(memory);
    return stats;
}

#endif
