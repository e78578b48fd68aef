/* Keeps packed scenes on the device. A scene that exceeds the remaining device memory gets a pool for part of its
 * chunks (pool.cuh). A scene in parts (fxs_scene.places) gets a pool with the bookkeeping of src/core/mirror.h. */
#ifndef FXS_CUDA_SCENES_CUH
#define FXS_CUDA_SCENES_CUH

#include "cut.cuh"
#include "device.cuh"
#include "stages.cuh"

extern "C" {
#include "src/core/mirror.h"
}

namespace {

const uint64_t POOL_USUAL = (uint64_t)256 << 20, UPLOAD_USUAL = (uint64_t)8 << 20;

struct scene_copy {
    const fxs_scene *key;
    fxs_scene here, there;         /* here: the scene as given by the caller; there: the same scene with device
                                      pointers, but for `motion`, which only the host reads */
    block data;                    /* device memory of the scene; null: the scene is not copied to the device yet */
    bool wrong_tree;               /* true: the level-of-detail tree is invalid, so the host chooses the level of
                                      detail */
    bool pooled;
    void *rows;                    /* all Gaussians in pinned host memory, if the device holds only part of the scene */
    fxs_mirror *mirror;            /* of a scene in parts; else null */
};

struct scene_table {
    host_block memory;
    uint32_t count;
    uint64_t bytes_wanted, least_wanted;   /* bytes of the scenes that will be copied to the device: with and without
                                              their Gaussians */
    uint32_t pools;
    uint64_t pool_bytes, pool_most, upload_bytes;  /* scenes in parts: size and largest size of a pool; largest upload
                                                      between two calls */
    uint64_t place_most;           /* bytes of the largest chunk of a scene in parts */
};

/* Pinned host memory with the chunks that a call uploads: `most` bytes for the chunks, then their places. */
struct upload {
    host_block memory;
    uint64_t most, used;
    uint32_t count;
};

scene_copy *copies_of(const scene_table *t)
{
    return (scene_copy *)t->memory.data;
}

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

scene_copy *find_scene(const scene_table *t, const fxs_scene *scene)
{
    const uint32_t place = place_of(t, scene);
    return place < t->count && copies_of(t)[place].key == scene ? &copies_of(t)[place] : nullptr;
}

struct copy_layout {
    uint64_t parents, chunks, palette, nodes, places, owners, stamps, rows, bytes;
};

uint64_t all_rows(const fxs_scene *scene)
{
    return (uint64_t)fxs_scene_chunks(scene) * scene->chunk_bytes;
}

copy_layout lay_out_whole(const fxs_scene *scene)
{
    const unsigned char *end = scene->nodes ? scene->node_rows + (scene->chunk_count - 1) * (uint64_t)scene->chunk_bytes
                                            : scene->rows + all_rows(scene);
    copy_layout l = {};
    l.parents = scene->nodes ? sizeof(scene_head) : 0;
    l.chunks = l.parents + parents_bytes(scene);
    l.nodes = l.chunks + (scene->nodes ? (uint64_t)(scene->nodes - scene->chunks) : 0);
    l.rows = l.chunks + (uint64_t)(scene->rows - scene->chunks);
    l.bytes = l.chunks + (uint64_t)(end - scene->chunks);
    l.bytes += !l.bytes;
    return l;
}

copy_layout lay_out_pooled(const fxs_scene *scene, uint64_t places)
{
    copy_layout l = {};
    l.parents = sizeof(scene_head);
    l.chunks = l.parents + parents_bytes(scene);
    l.nodes = l.chunks + padded((uint64_t)(scene->rows - scene->chunks));
    l.places = l.nodes + padded(scene->nodes ? (uint64_t)(scene->node_rows - scene->nodes) : 0);
    l.owners = l.places + padded(fxs_scene_chunks(scene) * sizeof(uint32_t));
    l.stamps = l.owners + padded(places * sizeof(uint32_t));
    l.rows = l.stamps + padded(places * sizeof(uint32_t));
    l.bytes = l.rows + places * scene->chunk_bytes;
    return l;
}

copy_layout lay_out_mirror(const fxs_scene *scene, uint32_t room)
{
    copy_layout l = {};
    l.palette = room * (uint64_t)sizeof(fxs_chunk);
    l.rows = l.palette + fxs_palette_bytes(scene);
    l.bytes = l.rows + room * (uint64_t)scene->chunk_bytes;
    return l;
}

void drop_scene(scene_table *t, budget *taken, const fxs_scene *scene)
{
    scene_copy *copy = find_scene(t, scene);
    if (!copy)
        return;
    reserve(taken, &copy->data, 0, nullptr);
    cudaFreeHost(copy->rows);
    cudaFreeHost(copy->mirror);
    t->pools -= copy->pooled;
    memmove(copy, copy + 1, (size_t)(copies_of(t) + t->count - copy - 1) * sizeof *copy);
    t->count--;
}

uint32_t room_of_pool(const scene_table *t, const fxs_scene *scene)
{
    const uint64_t bytes = t->pool_bytes ? t->pool_bytes : POOL_USUAL;
    return fxs_places_room(scene, bytes < t->pool_most ? bytes : t->pool_most, fxs_mirror_place_bytes(scene));
}

int make_mirror(fxs_mirror **mirror, scene_table *t, const fxs_scene *scene, fxs_message *why)
{
    const uint64_t each = fxs_mirror_place_bytes(scene), least = FXS_PLACES_LEAST * each;
    const uint32_t room = room_of_pool(t, scene);
    host_block memory = {};
    if (!room)
        return failed(why, FXS_ERR_MEMORY, "the device's pool for a scene in parts has no room for 16 chunks",
                      t->pool_most < least ? 2 * least : least);
    const int error = reserve_host(&memory, sizeof **mirror + fxs_mirror_bytes(scene, room), why);
    if (error)
        return error;
    *mirror = (fxs_mirror *)memory.data;
    fxs_mirror_init(*mirror, scene, room, *mirror + 1);
    t->place_most = each > t->place_most ? each : t->place_most;
    return 0;
}

void count_wanted(scene_table *t, const fxs_scene *scene, const fxs_mirror *mirror)
{
    const copy_layout parts = mirror ? lay_out_mirror(scene, mirror->pool.room) : copy_layout{};
    t->bytes_wanted += mirror ? parts.bytes : lay_out_whole(scene).bytes;
    t->least_wanted += mirror ? parts.bytes : lay_out_pooled(scene, 0).bytes;
}

/* Adds a scene to the table of scenes on the device; it is copied later. If the scene has changed, or its pool is to
   grow, its old copy is dropped. */
int want_scene(scene_table *t, budget *taken, const fxs_scene *scene, fxs_message *why)
{
    const scene_copy *found = find_scene(t, scene);
    if (found && !memcmp(&found->here, scene, sizeof *scene) &&
        (!found->mirror || found->mirror->pool.room >= room_of_pool(t, scene)))
        return 0;
    drop_scene(t, taken, scene);
    const uint64_t bytes = (t->count + 1) * sizeof(scene_copy);
    fxs_mirror *mirror = nullptr;
    int error = bytes > t->memory.bytes ? reserve_host(&t->memory, 2 * bytes, why) : 0;
    error = error || !scene->places ? error : make_mirror(&mirror, t, scene, why);
    if (error)
        return error;
    scene_copy *copy = copies_of(t) + place_of(t, scene);
    memmove(copy + 1, copy, (size_t)(copies_of(t) + t->count - copy) * sizeof *copy);
    *copy = {scene, *scene, *scene, {nullptr, 0}, false, false, nullptr, mirror};
    t->count++;
    count_wanted(t, scene, mirror);
    return 0;
}

uint32_t wanted_scenes(const scene_table *t)
{
    uint32_t wanted = 0;
    for (uint32_t i = 0; i < t->count; i++)
        wanted += !copies_of(t)[i].data.data;
    return wanted;
}

int want_pools_again(scene_table *t, budget *taken, fxs_message *why)
{
    int error = 0;
    for (uint32_t i = 0; i < t->count && !error; i++)
        if (copies_of(t)[i].pooled) {
            const fxs_scene *key = copies_of(t)[i].key;
            drop_scene(t, taken, key);
            error = want_scene(t, taken, key, why);
        }
    return error;
}

int check_tree(scene_copy *copy, cudaStream_t stream, fxs_message *why)
{
    const uint32_t blocks = fxs_scene_chunks(&copy->there) / CUT_THREADS + 1;
    uint32_t wrong = 0;
    cudaMemsetAsync(parents_of(&copy->there), 0xff, parents_bytes(&copy->there), stream);
    start(find_parents, blocks, CUT_THREADS, 0, stream, copy->there);
    start(measure_depths, blocks, CUT_THREADS, 0, stream, copy->there);
    cudaMemcpyAsync(&wrong, &head_of(&copy->there)->wrong_tree, sizeof wrong, cudaMemcpyDeviceToHost, stream);
    const int error = check(why, cudaGetLastError(), cudaStreamSynchronize(stream));
    copy->wrong_tree = wrong != 0;
    return error;
}

cudaError_t copy_whole(scene_copy *copy, unsigned char *data, cudaStream_t stream)
{
    const copy_layout l = lay_out_whole(&copy->here);
    const uint64_t bytes = copy->here.chunk_count ? l.bytes - l.chunks : 0;
    const unsigned char *start = copy->here.chunks;
    copy->there.rows = data + l.rows;
    if (copy->here.nodes) {
        copy->there.nodes = data + l.nodes;
        copy->there.node_chunks = copy->there.nodes + (copy->here.node_chunks - copy->here.nodes);
        copy->there.node_rows = copy->there.nodes + (copy->here.node_rows - copy->here.nodes);
    }
    const cudaError_t cleared = l.parents ? cudaMemsetAsync(data, 0, l.parents, stream) : cudaSuccess;
    return first_of(cleared, cudaMemcpyAsync(data + l.chunks, start, bytes, cudaMemcpyHostToDevice, stream));
}

/* Copies a scene's packed Gaussians to pinned host memory. Pinning a mapped file itself could take long. */
int expose_rows(scene_copy *copy, const unsigned char **rows, fxs_message *why)
{
    const fxs_scene *from = &copy->here;
    const uint64_t leaves = (uint64_t)from->chunk_count * from->chunk_bytes;
    void *there = nullptr;
    const int error = check(why, cudaHostAlloc(&copy->rows, all_rows(from), cudaHostAllocMapped));
    if (error)
        return error;
    memcpy(copy->rows, from->rows, leaves);
    if (from->nodes)
        memcpy((unsigned char *)copy->rows + leaves, from->node_rows, all_rows(from) - leaves);
    const int found = check(why, cudaHostGetDevicePointer(&there, copy->rows, 0));
    *rows = (const unsigned char *)there;
    return found;
}

int copy_pooled(scene_copy *copy, unsigned char *data, uint32_t places, cudaStream_t stream, fxs_message *why)
{
    const fxs_scene *from = &copy->here;
    const copy_layout l = lay_out_pooled(from, places);
    const unsigned char *rows;
    const int error = expose_rows(copy, &rows, why);
    if (error)
        return error;
    scene_head head = {};
    head.place_count = places;
    head.owners = (uint32_t *)(data + l.owners);
    head.stamps = (uint32_t *)(data + l.stamps);
    head.rows = rows;
    copy->there.places = (const uint32_t *)(data + l.places);
    copy->there.rows = data + l.rows;
    if (from->nodes) {
        copy->there.nodes = data + l.nodes;
        copy->there.node_chunks = copy->there.nodes + (from->node_chunks - from->nodes);
        copy->there.node_rows = nullptr;
        cudaMemcpyAsync(data + l.nodes, from->nodes, (uint64_t)(from->node_rows - from->nodes), cudaMemcpyHostToDevice,
                        stream);
    }
    cudaMemsetAsync(data + l.places, 0xff, l.stamps - l.places, stream);
    cudaMemsetAsync(data + l.stamps, 0, l.rows - l.stamps, stream);
    cudaMemcpyAsync(data, &head, sizeof head, cudaMemcpyHostToDevice, stream);
    const cudaError_t copied = cudaMemcpyAsync(data + l.chunks, from->chunks, (uint64_t)(from->rows - from->chunks),
                                               cudaMemcpyHostToDevice, stream);
    return check(why, first_of(copied, cudaGetLastError()), cudaStreamSynchronize(stream));
}

/* Makes the empty pool of a scene in parts, with its palette. */
int copy_mirror(scene_copy *copy, budget *taken, cudaStream_t stream, fxs_message *why)
{
    const copy_layout l = lay_out_mirror(&copy->here, copy->mirror->pool.room);
    const int error = reserve(taken, &copy->data, l.bytes, why);
    if (error)
        return error;
    unsigned char *data = (unsigned char *)copy->data.data;
    copy->there = fxs_mirror_pool(copy->mirror);
    copy->there.places = nullptr;
    copy->there.chunks = data;
    copy->there.rows = data + l.rows;
    if (copy->here.palette)
        copy->there.palette = (const int8_t *)data + l.palette;
    return check(why, cudaMemcpyAsync(data + l.palette, copy->here.palette, l.rows - l.palette, cudaMemcpyHostToDevice,
                                      stream), cudaStreamSynchronize(stream));
}

/* Uploads chunks that earlier frames wanted to the pool of a scene in parts, in the order of the stream. After an
   error, the pool is empty. */
int put_wanted(const scene_copy *copy, upload *u, cudaStream_t stream, fxs_message *why)
{
    fxs_mirror *m = copy->mirror;
    const uint32_t *places, count = fxs_mirror_step(m, u->most - u->used, &places);
    unsigned char *chunks = (unsigned char *)u->memory.data + u->used;
    uint32_t *numbers = (uint32_t *)((unsigned char *)u->memory.data + u->most) + u->count;
    if (!count)
        return 0;
    fxs_mirror_fill(m, places, count, chunks);
    memcpy(numbers, places, count * sizeof *places);
    u->used += count * fxs_mirror_place_bytes(m->from);
    u->count += count;
    start(put_chunks, count, FETCH_THREADS, 0, stream, copy->there, (const uint4 *)chunks,
          (const uint32_t *)numbers);
    const int error = check(why, cudaGetLastError());
    if (error)
        fxs_mirror_forget(m);
    return error;
}

int copy_scene(scene_copy *copy, budget *taken, uint64_t rows_most, cudaStream_t stream, fxs_message *why)
{
    const fxs_scene *from = &copy->here;
    const uint64_t of_place = from->chunk_bytes + 2 * sizeof(uint32_t);
    if (copy->mirror)
        return copy_mirror(copy, taken, stream, why);
    copy->pooled = all_rows(from) > rows_most;
    const uint32_t places = copy->pooled ? (uint32_t)(rows_most / of_place) : 0;
    const copy_layout l = copy->pooled ? lay_out_pooled(from, places) : lay_out_whole(from);
    int error = reserve(taken, &copy->data, l.bytes, why);
    if (error)
        return error;
    unsigned char *data = (unsigned char *)copy->data.data;
    copy->there.chunks = data + l.chunks;
    if (from->palette)
        copy->there.palette = (const int8_t *)copy->there.chunks + (from->palette - (const int8_t *)from->chunks);
    error = copy->pooled ? copy_pooled(copy, data, places, stream, why) : check(why, copy_whole(copy, data, stream));
    if (!error && from->nodes)
        error = check_tree(copy, stream, why);
    return error ? error : check(why, cudaStreamSynchronize(stream));
}

/* Copies all new scenes to the device, with at most `rows_most` bytes of Gaussians each. After an error, drops the
   new scenes. */
int fetch_scenes(scene_table *t, budget *taken, uint64_t rows_most, int error, cudaStream_t stream, fxs_message *why)
{
    for (uint32_t i = 0; i < t->count && t->bytes_wanted; i++) {
        scene_copy *copy = &copies_of(t)[i];
        if (copy->data.data || error)
            continue;
        error = copy_scene(copy, taken, rows_most, stream, why);
        t->pools += copy->pooled;
        if (error)
            reserve(taken, &copy->data, 0, nullptr);
    }
    for (uint32_t i = t->count; i-- > 0 && error && t->bytes_wanted;)
        if (!copies_of(t)[i].data.data)
            drop_scene(t, taken, copies_of(t)[i].key);
    t->bytes_wanted = t->least_wanted = 0;
    return error;
}

}

#endif
