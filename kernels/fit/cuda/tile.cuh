/* Blends the splats of each tile, and converts gradients of pixels to gradients of splats (the backward pass). A block
 * of threads processes a tile of 16x16 pixels. Half a warp processes a block of 4x4 pixels, a thread one pixel. */
#ifndef FXS_CUDA_FIT_TILE_CUH
#define FXS_CUDA_FIT_TILE_CUH

#include "exposure.cuh"

namespace {

const uint32_t HALF = WARP / 2;    /* threads in half a warp, for the 16 pixels of a 4x4 block */
const uint32_t BLEND_SPLATS = FXS_FIT_PIXELS, BACKWARD_SPLATS = 128;
const uint32_t GROUP = HALF / 2;
const uint32_t BACKWARD_PAIRS = 448;   /* capacity in pairs of a splat and a 4x4-pixel block; enough for at least 28
                                          splats */

template <uint32_t Splats>
struct tile_splats {
    float4 shape[Splats];          /* ux, uy and vy of each splat (which map pixels to u and v), and its offset (-log2
                                      of its highest alpha) */
    float4 colour[Splats];         /* each splat's cut-off level, then its red, green and blue */
    float corner_u[FXS_FIT_BLOCKS][Splats], corner_v[4][Splats];    /* normalised coordinates u and v (of the splat's
                                                                       ellipse) at the first pixel of each 4x4 block */
    uint32_t words[FXS_FIT_BLOCKS][Splats / WARP];    /* for each 4x4-pixel block, a bit set of the splats that may
                                                         touch it */
};

struct tile_place {
    uint32_t block, lane;
    float along, down;
    int32_t left, top;             /* coordinates of the tile's first pixel */
    int32_t x, y;
    bool is_inside;
};

__device__ inline tile_place place_of_thread(const fxs_fit_camera &c, uint32_t tile)
{
    tile_place p;
    p.left = (int32_t)(tile % (uint32_t)c.tiles_x) * FXS_FIT_TILE;
    p.top = (int32_t)(tile / (uint32_t)c.tiles_x) * FXS_FIT_TILE;
    p.block = threadIdx.x / HALF;
    p.lane = threadIdx.x % HALF;
    p.along = (float)(p.lane % 4);
    p.down = (float)(p.lane / 4);
    p.x = p.left + (int32_t)(p.block % 4) * 4 + (int32_t)(p.lane % 4);
    p.y = p.top + (int32_t)(p.block / 4) * 4 + (int32_t)(p.lane / 4);
    p.is_inside = p.x < c.width && p.y < c.height;
    return p;
}

__device__ inline uint32_t half_ballot(bool x)
{
    return __ballot_sync(ALL_LANES, x) >> (threadIdx.x & HALF) & 0xffffu;
}

template <uint32_t Splats>
__device__ inline void keep_splat(tile_splats<Splats> *to, const fxs_fit_splat &s, const tile_place &p)
{
    to->shape[threadIdx.x] = make_float4(s.ux, s.uy, s.vy, s.offset);
    to->colour[threadIdx.x] = make_float4(s.limit, s.colour[0], s.colour[1], s.colour[2]);
#pragma unroll
    for (int row = 0; row < 4; row++) {
        const float y = ((float)(4 * row) + ((float)p.top + 0.5f)) - s.centre[1], along_y = y * s.uy;
        to->corner_v[row][threadIdx.x] = y * s.vy;
#pragma unroll
        for (int column = 0; column < 4; column++) {
            const float x = ((float)(4 * column) + ((float)p.left + 0.5f)) - s.centre[0];
            to->corner_u[4 * row + column][threadIdx.x] = x * s.ux + along_y;
        }
    }
}

template <uint32_t Splats>
__device__ inline uint32_t find_blocks(const tile_splats<Splats> *kept, const fxs_fit_splat &s)
{
    const float across = 3 * s.ux, slant = 3 * s.uy, down = 3 * s.vy, limit = (s.limit - s.offset) * FXS_FIT_WIDER;
    const float less = slant < 0 ? slant : 0, far_side = across + (slant > 0 ? slant : 0);
    uint32_t blocks = 0;
#pragma unroll
    for (int b = 0; b < FXS_FIT_BLOCKS; b++) {
        const float u0 = kept->corner_u[b][threadIdx.x], v0 = kept->corner_v[b / 4][threadIdx.x];
        const float u = most(most(u0 + less, -u0 - far_side), 0.0f), v = most(most(v0, -v0 - down), 0.0f);
        blocks |= (uint32_t)(u * u + v * v <= limit) << b;
    }
    return s.radius2 < 0 ? (1u << FXS_FIT_BLOCKS) - 1 : blocks;
}

/* Turns each splat's bit set of touched 4x4-pixel blocks into each block's bit set of touching splats. All threads of a
   warp must call it. */
template <uint32_t Splats>
__device__ inline void turn_bits(uint32_t blocks, tile_splats<Splats> *to)
{
    const uint32_t lane = threadIdx.x % WARP;
    uint32_t own = 0;
#pragma unroll
    for (uint32_t b = 0; b < FXS_FIT_BLOCKS; b++) {
        const uint32_t word = __ballot_sync(ALL_LANES, blocks >> b & 1);
        own = lane == b ? word : own;
    }
    if (lane < FXS_FIT_BLOCKS)
        to->words[lane][threadIdx.x / WARP] = own;
}

/* Calls put(index, splat) for each splat that may touch the 4x4-pixel block of this half of the warp. Returns their
   number. */
template <uint32_t Splats, class Put>
__device__ inline uint32_t list_splats(const tile_splats<Splats> *of, const tile_place &p, Put put)
{
    uint32_t count = 0;
#pragma unroll
    for (uint32_t w = 0; w < Splats / WARP; w++) {
        const uint32_t bits = of->words[p.block][w];
#pragma unroll
        for (uint32_t bit = p.lane, end = bit + WARP; bit < end; bit += HALF)
            if (bits >> bit & 1)
                put(count + (uint32_t)__popc(bits & ((1u << bit) - 1)), w * WARP + bit);
        count += (uint32_t)__popc(bits);
    }
    __syncwarp();
    return count;
}

__device__ inline uint32_t most_of_halves(uint32_t count)
{
    return max(count, __shfl_xor_sync(ALL_LANES, count, HALF));
}

/* Fills the splat lists with index 0, so that entries beyond a list's end are valid indices too. */
template <uint32_t Splats>
__device__ inline void clear_lists(uint8_t lists[FXS_FIT_BLOCKS][Splats])
{
    for (uint32_t i = threadIdx.x; i < FXS_FIT_BLOCKS * Splats / 4; i += FXS_FIT_PIXELS)
        ((uint32_t *)lists)[i] = 0;
}

/* Computes a splat's level at the thread's pixel, where alpha is 2^-level: u^2 + v^2 + offset, with normalised
   coordinates u and v. */
template <uint32_t Splats>
__device__ inline float level_of(const tile_splats<Splats> *s, uint32_t splat, const tile_place &p, float *u, float *v)
{
    const float4 shape = s->shape[splat];
    *u = (p.along * shape.x + p.down * shape.y) + s->corner_u[p.block][splat];
    *v = p.down * shape.z + s->corner_v[p.block / 4][splat];
    return (*u * *u + *v * *v) + shape.w;
}

struct blend_shared : tile_splats<BLEND_SPLATS> {
    alignas(4) uint8_t lists[FXS_FIT_BLOCKS][BLEND_SPLATS];
    uint32_t taken[BLEND_SPLATS];  /* for each splat, a bit set of the 4x4-pixel blocks that it changes */
    uint32_t needed;
};

struct blend_pixel {
    float transmittance, red, green, blue;
};

__device__ inline bool blend_splat(const blend_shared *s, uint32_t splat, const tile_place &p, bool is_left,
                                   blend_pixel *pixel)
{
    float u, v;
    const float level = level_of(s, splat, p, &u, &v), t = pixel->transmittance;
    const float4 colour = s->colour[splat];
    const bool takes = is_left && takes_of(level, colour.x, t);
    const float weight = weight_of(takes, level, t);
    pixel->transmittance = t - weight;
    pixel->red = pixel->red + weight * colour.y;
    pixel->green = pixel->green + weight * colour.z;
    pixel->blue = pixel->blue + weight * colour.w;
    return takes;
}

/* Records which of 32 splats changed the 4x4-pixel block. Bit i of `taken` is set if splat i changed the thread's
   pixel. */
__device__ inline void note_taken(blend_shared *s, const uint8_t *list, const tile_place &p, uint32_t taken)
{
    for (uint32_t apart = HALF / 2; apart; apart /= 2)
        taken |= __shfl_xor_sync(ALL_LANES, taken, apart);
    for (uint32_t i = p.lane; i < WARP; i += HALF)
        if (taken >> i & 1)
            atomicOr(&s->taken[list[i]], 1u << p.block);
}

__device__ inline void blend_batch(blend_shared *s, const tile_place &p, blend_pixel *pixel)
{
    uint8_t *list = s->lists[p.block];
    uint32_t count = list_splats(s, p, [&](uint32_t place, uint32_t splat) { list[place] = (uint8_t)splat; });
    for (uint32_t first = 0; __any_sync(ALL_LANES, first < count); first += WARP) {
        if (!half_ballot(FXS_FIT_CLOSED <= pixel->transmittance))
            count = 0;
        const uint32_t end = min(most_of_halves(count), first + WARP);
        uint32_t taken = 0;
#pragma unroll 4
        for (uint32_t i = first; i < end; i++)
            taken |= (uint32_t)blend_splat(s, list[i], p, i < count, pixel) << (i - first);
        note_taken(s, list + first, p, taken);
    }
}

/* Writes a pixel of the planes that depths are made of, in place of the derivatives of SSIM. */
__device__ inline void put_depth(const step_buffers &b, const fxs_fit_camera &camera, const tile_place &p,
                                 const blend_pixel &pixel)
{
    const size_t at = (size_t)p.y * (size_t)camera.width + (size_t)p.x;
    const size_t size = (size_t)camera.width * (size_t)camera.height;
    const float planes[3] = {pixel.red, pixel.green, pixel.blue};
    float numbers[4];
    depth_numbers(&camera, (float)p.x, (float)p.y, planes, pixel.transmittance, numbers);
    for (int k = 0; k < 4; k++)
        b.derivatives[k * size + at] = numbers[k];
}

/* HasPlanes: the splats have planes instead of colours (src/fit/stages/fit_surface.h). */
template <bool HasPlanes>
__global__ void __launch_bounds__(FXS_FIT_PIXELS, 5)
blend_tiles(step_buffers b, const __grid_constant__ fxs_fit_camera camera, float3 background)
{
    extern __shared__ __align__(16) unsigned char memory[];
    blend_shared *s = (blend_shared *)memory;
    if (is_stopped(b.status))
        return;
    const uint32_t tile = b.order[blockIdx.x], start = b.starts[tile], count = b.starts[tile + 1] - start;
    const tile_place p = place_of_thread(camera, tile);
    blend_pixel pixel = {1, 0, 0, 0};
    clear_lists<BLEND_SPLATS>(s->lists);
    if (threadIdx.x == 0)
        s->needed = 0;
    for (uint32_t first = 0; first < count && __syncthreads_or(FXS_FIT_CLOSED <= pixel.transmittance);
         first += BLEND_SPLATS) {
        const uint32_t entry = first + threadIdx.x;
        uint32_t blocks = 0;
        s->taken[threadIdx.x] = 0;
        if (entry < count) {
            const fxs_fit_splat splat = b.splats[b.gaussians[start + entry]];
            keep_splat(s, splat, p);
            blocks = find_blocks(s, splat);
        }
        turn_bits(blocks, s);
        __syncthreads();
        blend_batch(s, p, &pixel);
        __syncthreads();
        if (entry < count)
            b.blocks[start + entry] = (uint16_t)s->taken[threadIdx.x];
        if (entry < count && s->taken[threadIdx.x])
            atomicMax(&s->needed, entry + 1);
    }
    __syncthreads();
    if (threadIdx.x == 0)
        b.needed[tile] = s->needed;
    if (HasPlanes) {
        if (p.is_inside)
            put_depth(b, camera, p, pixel);
    } else if (p.is_inside) {
        const size_t at = (size_t)p.y * (size_t)camera.width + (size_t)p.x;
        const size_t size = (size_t)camera.width * (size_t)camera.height;
        const float colour[3] = {pixel.red + pixel.transmittance * background.x,
                                 pixel.green + pixel.transmittance * background.y,
                                 pixel.blue + pixel.transmittance * background.z};
        for (int c = 0; c < 3; c++)
            b.picture[c * size + at] = b.factors ? exposed(b.factors, colour, c) : colour[c];
    }
}

template <class Kernel>
cudaError_t allow_shared(Kernel kernel, size_t bytes)
{
    return cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, (int)bytes);
}

template <bool HasPlanes>
cudaError_t launch_blend(const step_buffers *b, const fxs_fit_camera *camera, const float background[3],
                         cudaStream_t stream)
{
    const uint32_t tiles = (uint32_t)(camera->tiles_x * camera->tiles_y);
    const cudaError_t error = allow_shared(blend_tiles<HasPlanes>, sizeof(blend_shared));
    blend_tiles<HasPlanes><<<tiles, FXS_FIT_PIXELS, sizeof(blend_shared), stream>>>(
        *b, *camera, make_float3(background[0], background[1], background[2]));
    return error ? error : cudaGetLastError();
}

struct backward_shared : tile_splats<BACKWARD_SPLATS> {
    alignas(4) uint8_t lists[FXS_FIT_BLOCKS][BACKWARD_SPLATS];
    uint32_t slots[BACKWARD_SPLATS];
    /* `blocks` is the bit set of the 4x4-pixel blocks that each splat changes. `pairs` numbers the first pair of each
       splat and such a block. */
    uint16_t blocks[BACKWARD_SPLATS], pairs[BACKWARD_SPLATS + 1];
    uint32_t warp_pairs[BACKWARD_SPLATS / WARP], splats;
    float4 gradient[FXS_FIT_PIXELS];
    float2 staged[FXS_FIT_BLOCKS][GROUP][HALF + 2];   /* The row length HALF + 2 avoids bank conflicts. */
    float sums[BACKWARD_PAIRS][FXS_FIT_SUMS];
};

struct backward_pixel {
    passed_pixel passed;
    float red, green, blue;
};

/* Returns two numbers of a splat at the thread's pixel: h = -alpha dL/dalpha, with loss L, and the blending weight. */
__device__ inline float2 pass_pixel(const backward_shared *s, uint32_t splat, const tile_place &p, bool is_left,
                                    backward_pixel *pixel)
{
    float u, v, weight;
    const float level = level_of(s, splat, p, &u, &v);
    const float4 colour = s->colour[splat];
    const float of_colour = (pixel->red * colour.y + pixel->green * colour.z) + pixel->blue * colour.w;
    const bool takes = is_left && takes_of(level, colour.x, pixel->passed.transmittance);
    const float h = pass_splat(takes, level, of_colour, &pixel->passed, &weight);
    return make_float2(h, weight);
}

/* Two threads share the 16 pixels of a 4x4 block, to sum a splat's gradients. This is the state of each thread. */
struct backward_lane {
    const float2 *staged;
    const float4 *gradient;
    uint32_t parity;               /* 0: the thread sums even pixels; 1: odd pixels */
    float along[2], down[4], v[4];
    float corner_u;
};

__device__ inline backward_lane begin_lane(const backward_shared *s, const tile_place &p, uint32_t splat)
{
    const float4 shape = s->shape[splat];
    const float corner_v = s->corner_v[p.block / 4][splat];
    backward_lane l;
    l.parity = p.lane % 2;
    l.staged = s->staged[p.block][p.lane / 2];
    l.gradient = s->gradient + p.block * HALF;
    l.corner_u = s->corner_u[p.block][splat];
    l.along[0] = (float)l.parity * shape.x;
    l.along[1] = (float)(l.parity + 2) * shape.x;
#pragma unroll
    for (int row = 0; row < 4; row++) {
        l.down[row] = (float)row * shape.y;
        l.v[row] = (float)row * shape.z + corner_v;
    }
    return l;
}

__device__ inline void find_sums(const backward_lane &l, int n, float sums[FXS_FIT_SUMS])
{
    const uint32_t place = 2 * (uint32_t)n + l.parity;
    const float2 passed = l.staged[place];
    const float4 g = l.gradient[place];
    const float u = (l.along[n % 2] + l.down[n / 2]) + l.corner_u, v = l.v[n / 2];
    sums_of(passed.x, passed.y, u, v, g.x, g.y, g.z, sums);
}

/* Sums every second pixel of a 4x4 block as a binary tree, in the order of src/fit/stages/tile.h. */
template <int Apart>
__device__ inline void add_places(const backward_lane &l, int n, float sums[FXS_FIT_SUMS])
{
    if constexpr (Apart == HALF) {
        find_sums(l, n, sums);
    } else {
        float other[FXS_FIT_SUMS];
        add_places<2 * Apart>(l, n, sums);
        add_places<2 * Apart>(l, n + Apart / 2, other);
        for (int i = 0; i < FXS_FIT_SUMS; i++)
            sums[i] += other[i];
    }
}

__device__ inline void add_group(backward_shared *s, const tile_place &p, uint32_t first, uint32_t count)
{
    const uint32_t item = first + p.lane / 2, splat = s->lists[p.block][item < count ? item : 0];
    const uint32_t pair = s->pairs[splat] + (uint32_t)__popc(s->blocks[splat] & ((1u << p.block) - 1));
    float sums[FXS_FIT_SUMS];
    add_places<2>(begin_lane(s, p, splat), 0, sums);
#pragma unroll
    for (int i = 0; i < FXS_FIT_SUMS; i++) {
        sums[i] += __shfl_xor_sync(ALL_LANES, sums[i], 1);
        if (item < count && (uint32_t)i % 2 == p.lane % 2)
            s->sums[pair][i] = sums[i];
    }
}

__device__ inline void backward_batch(backward_shared *s, const tile_place &p, backward_pixel *pixel)
{
    uint8_t *list = s->lists[p.block];
    const uint32_t count = list_splats(s, p, [&](uint32_t place, uint32_t splat) { list[place] = (uint8_t)splat; });
    const uint32_t end = most_of_halves(count);
    for (uint32_t first = 0; first < end; first += GROUP) {
#pragma unroll
        for (uint32_t j = 0; j < GROUP; j++) {
            if (j % 2 == 0 && first + j >= end)
                break;
            s->staged[p.block][j][p.lane] = pass_pixel(s, list[first + j], p, first + j < count, pixel);
        }
        __syncwarp();
        add_group(s, p, first, count);
        __syncwarp();
    }
}

/* Numbers the pairs of a splat and a 4x4-pixel block that it changes, as far as they fit into shared memory. s->splats:
   number of splats that fit. All threads of the block must call. */
__device__ inline void place_pairs(backward_shared *s, uint32_t blocks)
{
    const uint32_t warp = threadIdx.x / WARP, own = (uint32_t)__popc(blocks);
    uint32_t end = own;
    for (uint32_t apart = 1; apart < WARP; apart *= 2) {
        const uint32_t below = __shfl_up_sync(ALL_LANES, end, apart);
        end += threadIdx.x % WARP >= apart ? below : 0;
    }
    if (threadIdx.x < BACKWARD_SPLATS && threadIdx.x % WARP == WARP - 1)
        s->warp_pairs[warp] = end;
    if (threadIdx.x == 0)
        s->splats = 0;
    __syncthreads();
    if (threadIdx.x >= BACKWARD_SPLATS)
        return;
    for (uint32_t w = 0; w < warp; w++)
        end += s->warp_pairs[w];
    s->pairs[threadIdx.x] = (uint16_t)(end - own);
    if (end <= BACKWARD_PAIRS)
        atomicMax(&s->splats, threadIdx.x + 1);
    else
        blocks = 0;
    turn_bits(blocks, s);
}

__device__ inline void add_blocks(const backward_shared *s, uint32_t count, float *sums)
{
    for (uint32_t i = threadIdx.x; i < count * FXS_FIT_SUMS; i += FXS_FIT_PIXELS) {
        const uint32_t splat = i / FXS_FIT_SUMS, k = i % FXS_FIT_SUMS, first = s->pairs[splat];
        const uint32_t pairs = (uint32_t)__popc(s->blocks[splat]);
        float sum = 0;
        for (uint32_t n = 0; n < pairs; n++)
            sum += s->sums[first + n][k];
        sums[(size_t)s->slots[splat] * FXS_FIT_SUMS + k] = sum;
    }
}

__device__ inline backward_pixel begin_pixel(const step_buffers &b, const fxs_fit_camera &camera, const tile_place &p)
{
    const size_t at = (size_t)p.y * (size_t)camera.width + (size_t)p.x;
    const size_t size = (size_t)camera.width * (size_t)camera.height;
    float found[3] = {0, 0, 0}, gradient[3], behind = 0;
    for (int c = 0; c < 3 && p.is_inside; c++) {
        found[c] = b.gradient[c * size + at];
        behind += found[c] * (b.picture[c * size + at] - (b.factors ? b.factors[9 + c] : 0.0f));
    }
    for (int c = 0; c < 3; c++)
        gradient[c] = b.factors ? gradient_before(b.factors, found, c) : found[c];
    return {{1, behind}, gradient[0], gradient[1], gradient[2]};
}

__global__ void __launch_bounds__(FXS_FIT_PIXELS, 4)
backward_tiles(step_buffers b, const __grid_constant__ fxs_fit_camera camera)
{
    extern __shared__ __align__(16) unsigned char memory[];
    backward_shared *s = (backward_shared *)memory;
    if (is_stopped(b.status))
        return;
    const uint32_t tile = b.order[blockIdx.x], start = b.starts[tile], count = b.starts[tile + 1] - start;
    const uint32_t needed = b.needed[tile];
    const tile_place p = place_of_thread(camera, tile);
    backward_pixel pixel = begin_pixel(b, camera, p);
    clear_lists<BACKWARD_SPLATS>(s->lists);
    s->gradient[threadIdx.x] = make_float4(pixel.red, pixel.green, pixel.blue, 0);
    for (uint32_t first = 0, here; first < needed; first += here) {
        const uint32_t entry = first + threadIdx.x;
        uint32_t blocks = 0;
        if (threadIdx.x < BACKWARD_SPLATS && entry < needed) {
            blocks = b.blocks[start + entry];
            keep_splat(s, b.splats[b.gaussians[start + entry]], p);
            s->slots[threadIdx.x] = b.slots[start + entry];
            s->blocks[threadIdx.x] = (uint16_t)blocks;
        }
        place_pairs(s, blocks);
        __syncthreads();
        here = min(s->splats, needed - first);
        backward_batch(s, p, &pixel);
        __syncthreads();
        add_blocks(s, here, b.sums);
        __syncthreads();
    }
    /* Zeroes the gradient sums of splats behind the last one that changes a pixel of the tile. */
    for (uint32_t i = needed * FXS_FIT_SUMS + threadIdx.x; i < count * FXS_FIT_SUMS; i += FXS_FIT_PIXELS)
        b.sums[(size_t)b.slots[start + i / FXS_FIT_SUMS] * FXS_FIT_SUMS + i % FXS_FIT_SUMS] = 0;
}

cudaError_t launch_back(const step_buffers *b, const fxs_fit_camera *camera, cudaStream_t stream)
{
    const uint32_t tiles = (uint32_t)(camera->tiles_x * camera->tiles_y);
    const cudaError_t error = allow_shared(backward_tiles, sizeof(backward_shared));
    launch_early(backward_tiles, tiles, FXS_FIT_PIXELS, sizeof(backward_shared), stream, *b, *camera);
    return error ? error : cudaGetLastError();
}

}

#endif
