/* The host's side of the CUDA back end: the packed scenes that are on the device. */
#ifndef FXS_CUDA_SCENES_CUH
#define FXS_CUDA_SCENES_CUH

#include "device.cuh"
#include "stages.cuh"

namespace {

struct scene_copy {
    const fxs_scene *key;
    fxs_scene here, there;         /* as it was given; with the device's pointers */
    block data;                    /* none: it is wanted */
};

/* The scene_copies, in the order of their keys. */
struct scene_table {
    host_block memory;
    uint32_t count;
    uint64_t bytes_wanted;
};

scene_copy *copies_of(const scene_table *t)
{
    return (scene_copy *)t->memory.data;
}

/* The place of a scene, or where it would be. */
uint32_t place_of(const scene_table *t, const fxs_scene *scene)
{
    uint32_t low = 0, high = t->count;
    while (low < high) {
        const uint32_t middle = (low + high) / 2;
        if ((uintptr_t)copies_of(t)[middle].key < (uintptr_t)scene)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* A scene's copy; null where there is none. */
scene_copy *find_scene(const scene_table *t, const fxs_scene *scene)
{
    const uint32_t place = place_of(t, scene);
    return place < t->count && copies_of(t)[place].key == scene ? &copies_of(t)[place] : nullptr;
}

/* Bytes of a scene's copy, with its tree; at least 1. */
uint64_t bytes_of(const fxs_scene *scene)
{
    const unsigned char *rows = scene->nodes ? scene->node_rows : scene->rows;
    const uint64_t chunks = scene->chunk_count - (scene->nodes ? 1 : 0);
    const uint64_t bytes = (uint64_t)(rows - scene->chunks) + chunks * scene->chunk_bytes;
    return bytes + !bytes;
}

void drop_scene(scene_table *t, budget *taken, const fxs_scene *scene)
{
    scene_copy *copy = find_scene(t, scene);
    if (!copy)
        return;
    reserve(taken, &copy->data, 0, nullptr);
    memmove(copy, copy + 1, (size_t)(copies_of(t) + t->count - copy - 1) * sizeof *copy);
    t->count--;
}

/* Makes a place for a scene that is not there. One that has changed is dropped first. */
int want_scene(scene_table *t, budget *taken, const fxs_scene *scene, fxs_message *why)
{
    const scene_copy *found = find_scene(t, scene);
    if (found && !memcmp(&found->here, scene, sizeof *scene))
        return 0;
    drop_scene(t, taken, scene);
    const uint64_t bytes = (t->count + 1) * sizeof(scene_copy);
    const int error = bytes > t->memory.bytes ? reserve_host(&t->memory, 2 * bytes, why) : 0;
    if (error)
        return error;
    scene_copy *copy = copies_of(t) + place_of(t, scene);
    memmove(copy + 1, copy, (size_t)(copies_of(t) + t->count - copy) * sizeof *copy);
    *copy = {scene, *scene, *scene, {nullptr, 0}};
    t->count++;
    t->bytes_wanted += bytes_of(scene);
    return 0;
}

int copy_scene(scene_copy *copy, budget *taken, cudaStream_t stream, fxs_message *why)
{
    const fxs_scene *from = &copy->here;
    int error = reserve(taken, &copy->data, bytes_of(from), why);
    if (!error && from->chunk_count)
        error = check(why, cudaMemcpyAsync(copy->data.data, from->chunks, bytes_of(from), cudaMemcpyHostToDevice,
                                           stream));
    error = error ? error : check(why, cudaStreamSynchronize(stream));
    if (error) {
        reserve(taken, &copy->data, 0, nullptr);
        return error;
    }
    const unsigned char *start = from->chunks;
    unsigned char *data = (unsigned char *)copy->data.data;
    copy->there.chunks = data;
    copy->there.rows = data + (from->rows - start);
    if (from->nodes) {
        copy->there.nodes = data + (from->nodes - start);
        copy->there.node_chunks = data + (from->node_chunks - start);
        copy->there.node_rows = data + (from->node_rows - start);
    }
    copy->there.palette = from->palette ? (const int8_t *)data + (from->palette - (const int8_t *)start) : nullptr;
    return 0;
}

/* Copies the scenes that are wanted; after an error, they are wanted no more. */
int fetch_scenes(scene_table *t, budget *taken, int error, cudaStream_t stream, fxs_message *why)
{
    for (uint32_t i = 0; i < t->count && t->bytes_wanted; i++) {
        scene_copy *copy = &copies_of(t)[i];
        if (!copy->data.data && !error)
            error = copy_scene(copy, taken, stream, why);
    }
    for (uint32_t i = t->count; i-- > 0 && error && t->bytes_wanted;)
        if (!copies_of(t)[i].data.data)
            drop_scene(t, taken, copies_of(t)[i].key);
    t->bytes_wanted = 0;
    return error;
}

}

#endif
