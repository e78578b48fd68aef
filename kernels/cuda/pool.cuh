/* Streams scenes that do not fit into device memory. All chunks (256 packed Gaussians each) stay in pinned host
 * memory, which the device can read. A pool on the device has places for some chunks. A visible chunk outside the
 * pool evicts a chunk that the current frame does not draw.
 *
 * The pool of a scene in parts (fxs_scene.places) is filled by the host: put_chunks copies chunks between frames. */
#ifndef FXS_CUDA_POOL_CUH
#define FXS_CUDA_POOL_CUH

#include "stages.cuh"

namespace {

const uint32_t BUSY = FXS_NOTHING - 1;     /* marks a chunk (256 Gaussians) that is being copied into the pool */
const uint32_t TURNS_MOST = 64;
const uint32_t FETCH_THREADS = 128;

struct alignas(64) scene_head {
    uint32_t wrong_tree;           /* nonzero: the level-of-detail tree is invalid, so the host chooses the level of
                                      detail */
    uint32_t place_count, next_place;
    uint32_t *owners, *stamps;     /* for each place of the pool: its chunk (256 Gaussians) or FXS_NOTHING; number of
                                      the last frame that drew the chunk */
    const unsigned char *rows;
};

uint64_t padded(uint64_t bytes)
{
    return (bytes + 63) / 64 * 64;
}

__host__ __device__ inline uint64_t parents_bytes(const fxs_scene *scene)
{
    return scene->nodes ? ((2 * (uint64_t)scene->chunk_count - 1) * sizeof(uint32_t) + 63) / 64 * 64 : 0;
}

__host__ __device__ inline uint32_t *parents_of(const fxs_scene *there)
{
    return (uint32_t *)(there->chunks - parents_bytes(there));
}

/* Returns the head of a scene's device memory. Valid only for a scene with a level-of-detail tree or with a pool, which
   holds part of the scene. */
__host__ __device__ inline scene_head *head_of(const fxs_scene *there)
{
    return (scene_head *)((unsigned char *)parents_of(there) - sizeof(scene_head));
}

__device__ inline const unsigned char *rows_in_host(const fxs_scene *scene, uint32_t chunk)
{
    return fxs_aligned(head_of(scene)->rows + (size_t)chunk * scene->chunk_bytes);
}

__device__ inline const unsigned char *rows_of(const fxs_scene *scene, uint32_t chunk)
{
    return scene->places && scene->places[chunk] == FXS_NOTHING ? rows_in_host(scene, chunk) : fxs_rows(scene, chunk);
}

__device__ inline void keep_place(const fxs_scene *scene, uint32_t chunk, uint32_t number)
{
    if (scene->places && scene->places[chunk] != FXS_NOTHING)
        head_of(scene)->stamps[scene->places[chunk]] = number;
}

/* Takes a place in the pool for a chunk (256 Gaussians), but no place that frame `number` uses. Returns FXS_NOTHING
   after TURNS_MOST failed tries. */
__device__ inline uint32_t take_place(const fxs_scene *scene, uint32_t *places, uint32_t chunk, uint32_t number)
{
    scene_head *head = head_of(scene);
    for (uint32_t turn = 0; turn < TURNS_MOST && head->place_count; turn++) {
        const uint32_t place = atomicAdd(&head->next_place, 1) % head->place_count;
        const uint32_t stamp = *(volatile uint32_t *)&head->stamps[place];
        if (stamp == number || atomicCAS(&head->stamps[place], stamp, number) != stamp)
            continue;
        if (head->owners[place] != FXS_NOTHING)
            places[head->owners[place]] = FXS_NOTHING;
        head->owners[place] = chunk;
        return place;
    }
    return FXS_NOTHING;
}

/* Copies visible chunks of Gaussians into the pools of their scenes, one chunk per thread block. */
__global__ void __launch_bounds__(FETCH_THREADS) fetch_chunks(const __grid_constant__ frame_buffers f)
{
    __shared__ uint32_t place;
    wait_for_last_kernel();
    if (blockIdx.x >= f.status->chunks)
        return;
    const fxs_object_view *o = &f.objects[f.chunk_objects[blockIdx.x]];
    const fxs_scene *scene = &o->scene;
    const uint32_t chunk = chunk_at(&f, f.chunk_views[blockIdx.x].chunk) - o->first_chunk;
    uint32_t *places = (uint32_t *)scene->places;
    if (!places)
        return;
    if (threadIdx.x == 0) {
        place = FXS_NOTHING;
        if (atomicCAS(&places[chunk], FXS_NOTHING, BUSY) == FXS_NOTHING)
            places[chunk] = place = take_place(scene, places, chunk, f.number);
    }
    __syncthreads();
    if (place == FXS_NOTHING)
        return;
    const uint4 *from = (const uint4 *)rows_in_host(scene, chunk);
    uint4 *to = (uint4 *)(scene->rows + (size_t)place * scene->chunk_bytes);
    for (uint32_t i = threadIdx.x; i < scene->chunk_bytes / sizeof *to; i += FETCH_THREADS)
        to[i] = from[i];
}

/* Copies uploaded chunks to places of a pool, one chunk per thread block. `from` is pinned host memory with the headers
   of all chunks, then their rows. */
__global__ void __launch_bounds__(FETCH_THREADS) put_chunks(const __grid_constant__ fxs_scene pool, const uint4 *from,
                                                            const uint32_t *places)
{
    const uint32_t header = sizeof(fxs_chunk) / sizeof(uint4), row = pool.chunk_bytes / sizeof(uint4);
    const size_t place = places[blockIdx.x];
    uint4 *head = (uint4 *)(pool.chunks + place * sizeof(fxs_chunk));
    uint4 *rows = (uint4 *)(pool.rows + place * pool.chunk_bytes);
    for (uint32_t i = threadIdx.x; i < header; i += FETCH_THREADS)
        head[i] = from[blockIdx.x * header + i];
    for (uint32_t i = threadIdx.x; i < row; i += FETCH_THREADS)
        rows[i] = from[gridDim.x * header + (size_t)blockIdx.x * row + i];
}

}

#endif
