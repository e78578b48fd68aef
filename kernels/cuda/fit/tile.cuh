/* blend and back: a block of threads a tile, half a warp a block of 4x4 pixels, a thread a pixel. */
#ifndef FXS_CUDA_FIT_TILE_CUH
#define FXS_CUDA_FIT_TILE_CUH

#include "step.cuh"

namespace {

const uint32_t HALF = WARP / 2;    /* a half-warp has the 16 places of a block */
const uint32_t BLEND_SPLATS = FXS_FIT_PIXELS, BACK_SPLATS = 64;   /* of a list at a time */

/* Of a splat, what its pixels need. */
struct tile_splat {
    float4 shape, level_red;       /* centre, ux, uy; vy, offset, limit, red */
    float2 green_blue;
};

/* Where a thread's pixel is. */
struct tile_place {
    uint32_t block, lane;          /* of the tile; of the half-warp: the place in the block */
    float corner_x, corner_y;      /* the first pixel of its block, its centre */
    float along, down;             /* from there to its own */
    int32_t x, y;                  /* of the picture */
    bool is_inside;
};

__device__ inline tile_place place_of_thread(const fxs_fit_camera &c, uint32_t tile)
{
    tile_place p;
    const int32_t left = (int32_t)(tile % (uint32_t)c.tiles_x) * FXS_FIT_TILE;
    const int32_t top = (int32_t)(tile / (uint32_t)c.tiles_x) * FXS_FIT_TILE;
    p.block = threadIdx.x / HALF;
    p.lane = threadIdx.x % HALF;
    const int32_t block_x = (int32_t)(p.block % 4) * 4, block_y = (int32_t)(p.block / 4) * 4;
    p.corner_x = (float)block_x + ((float)left + 0.5f);
    p.corner_y = (float)block_y + ((float)top + 0.5f);
    p.along = (float)(p.lane % 4);
    p.down = (float)(p.lane / 4);
    p.x = left + block_x + (int32_t)(p.lane % 4);
    p.y = top + block_y + (int32_t)(p.lane / 4);
    p.is_inside = p.x < c.width && p.y < c.height;
    return p;
}

/* The bits of both half-warps, as each of them has its own. */
__device__ inline uint32_t half_ballot(bool x)
{
    return __ballot_sync(ALL_LANES, x) >> (threadIdx.x & HALF) & 0xffffu;
}

/* u, v and level of the thread's pixel, in the order of port/fit/tile.h. */
__device__ inline float level_of(const tile_splat &s, const tile_place &p, float *u, float *v)
{
    const float x = p.corner_x - s.shape.x, y = p.corner_y - s.shape.y;
    const float ux = s.shape.z, uy = s.shape.w, vy = s.level_red.x;
    *u = (p.along * ux + p.down * uy) + (x * ux + y * uy);
    *v = p.down * vy + y * vy;
    return (*u * *u + *v * *v) + s.level_red.y;
}

/* The blocks that its ellipse may touch: find_blocks of port/fit/tile.h. */
__device__ inline uint32_t find_blocks(const fxs_fit_splat &s, int32_t left, int32_t top)
{
    const float across = 3 * s.ux, slant = 3 * s.uy, down = 3 * s.vy, limit = (s.limit - s.offset) * FXS_FIT_WIDER;
    uint32_t blocks = 0;
    if (s.radius2 < 0)
        return (1u << FXS_FIT_BLOCKS) - 1;
    const float less = slant < 0 ? slant : 0, far_side = across + (slant > 0 ? slant : 0);
#pragma unroll
    for (int row = 0; row < 4; row++) {
        const float y = ((float)(4 * row) + ((float)top + 0.5f)) - s.centre[1], v0 = y * s.vy, along_y = y * s.uy;
        const float v = most(most(v0, -v0 - down), 0.0f), v2 = v * v;
#pragma unroll
        for (int column = 0; column < 4; column++) {
            const float x = ((float)(4 * column) + ((float)left + 0.5f)) - s.centre[0], u0 = x * s.ux + along_y;
            const float u = most(most(u0 + less, -u0 - far_side), 0.0f);
            blocks |= (uint32_t)(u * u + v2 <= limit) << (4 * row + column);
        }
    }
    return blocks;
}

/* For each block of pixels a bit for each splat, from each splat's bits for the blocks; by whole warps. */
template <uint32_t Words>
__device__ inline void turn_bits(uint32_t blocks, uint32_t (*words)[Words])
{
    const uint32_t lane = threadIdx.x % WARP;
    uint32_t own = 0;
#pragma unroll
    for (uint32_t b = 0; b < FXS_FIT_BLOCKS; b++) {
        const uint32_t word = __ballot_sync(ALL_LANES, blocks >> b & 1);
        own = lane == b ? word : own;
    }
    if (lane < FXS_FIT_BLOCKS)
        words[lane][threadIdx.x / WARP] = own;
}

/* The splats of a half-warp's block, one after the other. */
template <uint32_t Words>
struct walk {
    const uint32_t *words;
    uint32_t word, bits;

    __device__ explicit walk(const uint32_t *words_, bool is_open) : words(words_), word(0), bits(is_open ? *words_ : 0)
    {
        if (!is_open)
            word = Words;
        skip();
    }
    __device__ void skip()
    {
        while (!bits && word < Words)
            bits = ++word < Words ? words[word] : 0;
    }
    __device__ bool is_left() const
    {
        return bits != 0;
    }
    __device__ uint32_t splat() const
    {
        return word * WARP + (uint32_t)__ffs((int)bits) - 1;
    }
    __device__ void next()
    {
        bits &= bits - 1;
        skip();
    }
};

__device__ inline void keep_splat(tile_splat *to, const fxs_fit_splat &s)
{
    to->shape = make_float4(s.centre[0], s.centre[1], s.ux, s.uy);
    to->level_red = make_float4(s.vy, s.offset, s.limit, s.colour[0]);
    to->green_blue = make_float2(s.colour[1], s.colour[2]);
}

/* ---- blend ------------------------------------------------------------------------------------------------------- */

struct blend_shared {
    tile_splat splats[BLEND_SPLATS];
    uint32_t words[FXS_FIT_BLOCKS][BLEND_SPLATS / WARP];    /* splats that a block may take of */
    uint32_t taken[FXS_FIT_BLOCKS][BLEND_SPLATS / WARP];    /* and those it took of */
    uint32_t needed;
};

struct blend_pixel {
    float transmittance, red, green, blue;
};

__device__ inline bool blend_splat(const tile_splat &s, const tile_place &p, blend_pixel *pixel)
{
    float u, v;
    const float level = level_of(s, p, &u, &v), t = pixel->transmittance;
    const bool takes = level <= s.level_red.z && FXS_FIT_CLOSED <= t;
    if (takes) {
        const float weight = least(exp_2_minus(level), FXS_FIT_ALPHA_MOST) * t;
        pixel->transmittance = t - weight;
        pixel->red = pixel->red + weight * s.level_red.w;
        pixel->green = pixel->green + weight * s.green_blue.x;
        pixel->blue = pixel->blue + weight * s.green_blue.y;
    }
    return takes;
}

/* The batch's splats that a half-warp's block may touch. */
__device__ inline void blend_batch(blend_shared *s, const tile_place &p, blend_pixel *pixel)
{
    walk<BLEND_SPLATS / WARP> w(s->words[p.block], half_ballot(FXS_FIT_CLOSED <= pixel->transmittance) != 0);
    while (__any_sync(ALL_LANES, w.is_left())) {
        const bool is_left = w.is_left();
        const bool takes = is_left && blend_splat(s->splats[w.splat()], p, pixel);
        const uint32_t taking = half_ballot(takes);
        if (is_left) {
            if (taking && p.lane == 0)
                s->taken[p.block][w.word] |= w.bits & (0u - w.bits);
            w.next();
        }
    }
}

/* From each block's bits for the splats to each splat's for the blocks. */
__device__ inline uint32_t taken_of(const blend_shared *s)
{
    uint32_t blocks = 0;
#pragma unroll
    for (uint32_t b = 0; b < FXS_FIT_BLOCKS; b++)
        blocks |= (s->taken[b][threadIdx.x / WARP] >> threadIdx.x % WARP & 1) << b;
    return blocks;
}

__global__ void __launch_bounds__(FXS_FIT_PIXELS)
blend_tiles(step_buffers b, fxs_fit_camera camera, float3 background)
{
    __shared__ blend_shared s;
    if (is_stopped(b.status))
        return;
    const uint32_t tile = blockIdx.x, start = b.starts[tile], count = b.starts[tile + 1] - start;
    const tile_place p = place_of_thread(camera, tile);
    const int32_t left = (int32_t)(tile % (uint32_t)camera.tiles_x) * FXS_FIT_TILE;
    const int32_t top = (int32_t)(tile / (uint32_t)camera.tiles_x) * FXS_FIT_TILE;
    blend_pixel pixel = {1, 0, 0, 0};
    if (threadIdx.x == 0)
        s.needed = 0;
    for (uint32_t first = 0; first < count && __syncthreads_or(FXS_FIT_CLOSED <= pixel.transmittance);
         first += BLEND_SPLATS) {
        const uint32_t entry = first + threadIdx.x;
        uint32_t blocks = 0;
        if (entry < count) {
            const fxs_fit_splat splat = b.splats[b.splat_of[b.slots[1][start + entry]]];
            blocks = find_blocks(splat, left, top);
            keep_splat(&s.splats[threadIdx.x], splat);
        }
        turn_bits(blocks, s.words);
        if (threadIdx.x < FXS_FIT_BLOCKS * BLEND_SPLATS / WARP)
            s.taken[0][threadIdx.x] = 0;
        __syncthreads();
        blend_batch(&s, p, &pixel);
        __syncthreads();
        blocks = taken_of(&s);
        if (entry < count)
            b.blocks[start + entry] = (uint16_t)blocks;
        if (blocks)
            atomicMax(&s.needed, entry + 1);
    }
    __syncthreads();
    if (threadIdx.x == 0)
        b.needed[tile] = s.needed;
    if (p.is_inside) {
        const size_t at = (size_t)p.y * (size_t)camera.width + (size_t)p.x;
        const size_t size = (size_t)camera.width * (size_t)camera.height;
        b.picture[at] = pixel.red + pixel.transmittance * background.x;
        b.picture[size + at] = pixel.green + pixel.transmittance * background.y;
        b.picture[2 * size + at] = pixel.blue + pixel.transmittance * background.z;
    }
}

cudaError_t launch_blend(const step_buffers *b, const fxs_fit_camera *camera, const float background[3],
                         cudaStream_t stream)
{
    const uint32_t tiles = (uint32_t)(camera->tiles_x * camera->tiles_y);
    blend_tiles<<<tiles, FXS_FIT_PIXELS, 0, stream>>>(*b, *camera,
                                                     make_float3(background[0], background[1], background[2]));
    return cudaGetLastError();
}

/* ---- back -------------------------------------------------------------------------------------------------------- */

struct back_shared {
    tile_splat splats[BACK_SPLATS];
    uint32_t words[FXS_FIT_BLOCKS][BACK_SPLATS / WARP];
    uint32_t slots[BACK_SPLATS];
    uint16_t blocks[BACK_SPLATS];
    float sums[FXS_FIT_BLOCKS][BACK_SPLATS][FXS_FIT_SUMS];
};

/* What has passed of a pixel, and its gradient. */
struct back_pixel {
    float transmittance, behind, red, green, blue;
};

/* dL/dalpha = T (c . g) - behind / (1 - alpha): back_pixels of port/fit/tile.h */
__device__ inline void find_sums(const tile_splat &s, const tile_place &p, back_pixel *pixel, bool is_left,
                                 float sums[FXS_FIT_SUMS])
{
    float u, v;
    const float level = level_of(s, p, &u, &v), t = pixel->transmittance;
    const bool takes = is_left && level <= s.level_red.z && FXS_FIT_CLOSED <= t;
    for (int i = 0; i < FXS_FIT_SUMS; i++)
        sums[i] = 0;
    if (!takes)
        return;
    const float exact = exp_2_minus(level), alpha = least(exact, FXS_FIT_ALPHA_MOST), weight = alpha * t;
    const float of_colour = (pixel->red * s.level_red.w + pixel->green * s.green_blue.x) +
                            pixel->blue * s.green_blue.y;
    const float own = weight * of_colour, behind = pixel->behind - own;
    pixel->transmittance = t - weight;
    pixel->behind = behind;
    const float h = exact < FXS_FIT_ALPHA_MOST ? behind * (alpha / (1.0f - alpha)) - own : 0.0f;
    const float hu = h * u, hv = h * v;
    sums[FXS_FIT_SUM] = h;
    sums[FXS_FIT_SUM_U] = hu;
    sums[FXS_FIT_SUM_V] = hv;
    sums[FXS_FIT_SUM_UU] = hu * u;
    sums[FXS_FIT_SUM_UV] = hu * v;
    sums[FXS_FIT_SUM_VV] = hv * v;
    sums[FXS_FIT_RED] = weight * pixel->red;
    sums[FXS_FIT_GREEN] = weight * pixel->green;
    sums[FXS_FIT_BLUE] = weight * pixel->blue;
}

/* Each lane keeps the sums of half of the values, its own and those of the lane `apart`. */
template <int Count>
__device__ inline void halve(float *x, uint32_t lane, uint32_t apart)
{
    const bool is_upper = lane & apart;
#pragma unroll
    for (int i = 0; i < Count / 2; i++) {
        const float given = is_upper ? x[i] : x[i + Count / 2], kept = is_upper ? x[i + Count / 2] : x[i];
        x[i] = kept + __shfl_xor_sync(ALL_LANES, given, (int)apart);
    }
}

/* The tree over the places, p and p + 8, p + 4, p + 2, p + 1: eight of the sums are halved among the lanes, the ninth
   is in all of them. */
__device__ inline void add_places(float x[FXS_FIT_SUMS], uint32_t lane, float *out, bool is_left)
{
    float last = x[8];
    halve<8>(x, lane, 8);
    halve<4>(x, lane, 4);
    halve<2>(x, lane, 2);
    x[0] += __shfl_xor_sync(ALL_LANES, x[0], 1);
#pragma unroll
    for (int apart = 8; apart; apart /= 2)
        last += __shfl_xor_sync(ALL_LANES, last, apart);
    if (!is_left)
        return;
    if (lane % 2 == 0)
        out[(lane >> 3 & 1) * 4 + (lane >> 2 & 1) * 2 + (lane >> 1 & 1)] = x[0];
    else if (lane == 1)
        out[8] = last;
}

__device__ inline void back_batch(back_shared *s, const tile_place &p, back_pixel *pixel)
{
    walk<BACK_SPLATS / WARP> w(s->words[p.block], true);
    while (__any_sync(ALL_LANES, w.is_left())) {
        const bool is_left = w.is_left();
        const uint32_t splat = is_left ? w.splat() : 0;
        float sums[FXS_FIT_SUMS];
        find_sums(s->splats[splat], p, pixel, is_left, sums);
        add_places(sums, p.lane, s->sums[p.block][splat], is_left);
        if (is_left)
            w.next();
    }
}

/* The blocks' sums of each splat of the batch, row by row, to its slot. */
__device__ inline void add_blocks(const back_shared *s, uint32_t count, float *sums)
{
    for (uint32_t i = threadIdx.x; i < count * FXS_FIT_SUMS; i += FXS_FIT_PIXELS) {
        const uint32_t splat = i / FXS_FIT_SUMS, k = i % FXS_FIT_SUMS;
        float sum = 0;
        for (uint32_t rest = s->blocks[splat]; rest; rest &= rest - 1)
            sum += s->sums[__ffs((int)rest) - 1][splat][k];
        sums[(size_t)s->slots[splat] * FXS_FIT_SUMS + k] = sum;
    }
}

__device__ inline back_pixel begin_pixel(const step_buffers &b, const fxs_fit_camera &camera, const tile_place &p)
{
    float4 g = make_float4(0, 0, 0, 0);
    if (p.is_inside)
        g = b.gradient[(size_t)p.y * (size_t)camera.width + (size_t)p.x];
    return {1, g.w, g.x, g.y, g.z};
}

__global__ void __launch_bounds__(FXS_FIT_PIXELS) back_tiles(step_buffers b, fxs_fit_camera camera)
{
    extern __shared__ __align__(16) unsigned char memory[];
    back_shared *s = (back_shared *)memory;
    if (is_stopped(b.status))
        return;
    const uint32_t tile = blockIdx.x, start = b.starts[tile], count = b.starts[tile + 1] - start;
    const uint32_t needed = b.needed[tile];
    const tile_place p = place_of_thread(camera, tile);
    back_pixel pixel = begin_pixel(b, camera, p);
    for (uint32_t first = 0; first < needed; first += BACK_SPLATS) {
        const uint32_t here = needed - first < BACK_SPLATS ? needed - first : BACK_SPLATS;
        if (threadIdx.x < BACK_SPLATS) {
            uint32_t blocks = 0;
            if (threadIdx.x < here) {
                const uint32_t entry = start + first + threadIdx.x, slot = b.slots[1][entry];
                blocks = b.blocks[entry];
                keep_splat(&s->splats[threadIdx.x], b.splats[b.splat_of[slot]]);
                s->slots[threadIdx.x] = slot;
                s->blocks[threadIdx.x] = (uint16_t)blocks;
            }
            turn_bits(blocks, s->words);
        }
        __syncthreads();
        back_batch(s, p, &pixel);
        __syncthreads();
        add_blocks(s, here, b.sums);
        __syncthreads();
    }
    /* what no pixel takes of */
    for (uint32_t i = needed * FXS_FIT_SUMS + threadIdx.x; i < count * FXS_FIT_SUMS; i += FXS_FIT_PIXELS)
        b.sums[(size_t)b.slots[1][start + i / FXS_FIT_SUMS] * FXS_FIT_SUMS + i % FXS_FIT_SUMS] = 0;
}

cudaError_t launch_back(const step_buffers *b, const fxs_fit_camera *camera, cudaStream_t stream)
{
    const cudaError_t error = cudaFuncSetAttribute(back_tiles, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                                   (int)sizeof(back_shared));
    back_tiles<<<(uint32_t)(camera->tiles_x * camera->tiles_y), FXS_FIT_PIXELS, sizeof(back_shared), stream>>>(*b,
                                                                                                          *camera);
    return error ? error : cudaGetLastError();
}

}

#endif
