/* Gives tests access to internal buffers of fits on CUDA, by including the engine's source file. */
#include <stdlib.h>

#include "kernels/fit/cuda/cuda_fit.cu"
#include "peek_fit.h"

namespace {

template <class T, class U>
int download(U **out, const T *from, uint64_t count)
{
    *out = (U *)malloc(count * sizeof(T) + 1);
    return !*out || cudaMemcpy(*out, from, count * sizeof(T), cudaMemcpyDefault) != cudaSuccess;
}

}

int peek_fit(void *self, const fxs_fit_camera *c, peeked_fit *out)
{
    engine *e = (engine *)self;
    const step_buffers *b = &e->devices[0].buffers;
    const uint64_t tiles = (uint64_t)(c->tiles_x * c->tiles_y), pixels = (uint64_t)(c->width * c->height);
    memset(out, 0, sizeof *out);
    if (download(&out->starts, b->starts, tiles + 1))
        return 1;
    out->entries = out->starts[tiles];
    return download(&out->splats, b->splats, e->devices[0].model.count) ||
           download(&out->slots, b->slots, out->entries) || download(&out->splat_of, b->splat_of, out->entries) ||
           download(&out->gaussians, b->gaussians, out->entries) ||
           download(&out->needed, b->needed, tiles) || download(&out->blocks, b->blocks, out->entries) ||
           download(&out->sums, (const float(*)[FXS_FIT_SUMS])b->sums, out->entries) ||
           download(&out->picture, b->picture, 3 * pixels) ||
           download(&out->derivatives, b->derivatives, 9 * pixels) ||
           download(&out->gradient, b->gradient, 3 * pixels);
}

void peek_fit_free(peeked_fit *p)
{
    void *const all_of_it[] = {p->splats, p->starts, p->slots,   p->splat_of,    p->gaussians, p->needed,
                               p->blocks, p->sums,   p->picture, p->derivatives, p->gradient};
    for (void *memory : all_of_it)
        free(memory);
}

int peek_fit_narrow(void *self, uint32_t capacity)
{
    fxs_message why;
    engine *e = (engine *)self;
    int error = finish(e, &why);
    for (uint32_t i = 0; i < e->device_count && !error; i++) {
        device *d = &e->devices[i];
        const on_device here(d->number);
        d->buffers.capacity = 0;
        error = reserve(&d->memory, &d->slots, 0, &why) || reserve_slots(d, capacity, &why);
    }
    return error;
}

uint64_t peek_fit_bytes(const void *self)
{
    return ((const engine *)self)->devices[0].memory.bytes;
}

static __global__ void trap()
{
    __trap();
}

void peek_fit_lose(void *self)
{
    trap<<<1, 1, 0, ((engine *)self)->devices[0].stream>>>();
}

static __global__ void compare_odds(uint32_t first, uint32_t last, unsigned long long *wrong)
{
    for (uint32_t bits = first + blockIdx.x * blockDim.x + threadIdx.x; bits <= last; bits += gridDim.x * blockDim.x) {
        const float alpha = __uint_as_float(bits);
        if (odds_of(alpha) != __fdiv_rn(alpha, 1.0f - alpha))
            atomicAdd(wrong, 1ull);
    }
}

long peek_fit_odds()
{
    const float ends[2] = {0x1p-9f, FXS_FIT_ALPHA_MOST};
    uint32_t bits[2];
    unsigned long long *there = nullptr, wrong = 0;
    memcpy(bits, ends, sizeof bits);
    if (cudaMalloc(&there, sizeof wrong) || cudaMemset(there, 0, sizeof wrong))
        return -1;
    compare_odds<<<1024, 256>>>(bits[0], bits[1], there);
    const bool failed = cudaMemcpy(&wrong, there, sizeof wrong, cudaMemcpyDeviceToHost) != cudaSuccess;
    cudaFree(there);
    return failed ? -1 : (long)wrong;
}
