/* Common parts of a fitting step on a GPU: compiles the sources of src/fit for it, and declares its buffers. A slot is
 * a pair of a splat (a projected Gaussian) and a tile that it touches. */
#ifndef FXS_CUDA_FIT_STEP_CUH
#define FXS_CUDA_FIT_STEP_CUH

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cuda_runtime.h>

#include "kernels/cuda/warp.cuh"
#include "src/fit/stages/fit_stage.h"

/* Compiles the sources of src/fit for scalars instead of vectors: `real` is float, and each operation matches the
   CPU's. The compiler must not contract multiplications and additions. */
namespace {
#define static static __host__ __device__
#include "src/fit/stages/fit_lanes.h"
#include "src/fit/stages/fit_gaussian.h"

/* Returns alpha / (1 - alpha), correctly rounded, for alpha in 2^-8..0.99. A Newton step improves the approximate
   reciprocal, then the remainder corrects the quotient (Markstein 1990). */
#define FXS_FIT_ODDS
static inline float odds_of(float alpha)
{
#ifdef __CUDA_ARCH__
    const float whole = 1.0f - alpha;
    float inverse;
    asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(inverse) : "f"(whole));
    inverse = __fmaf_rn(inverse, __fmaf_rn(-whole, inverse, 1.0f), inverse);
    const float quotient = alpha * inverse;
    return __fmaf_rn(inverse, __fmaf_rn(-whole, quotient, alpha), quotient);
#else
    return alpha / (1.0f - alpha);
#endif
}

#include "src/fit/stages/fit_pixel.h"
#include "src/fit/stages/span.h"
#include "src/fit/stages/fit_project.h"
#include "src/fit/stages/adam.h"
#include "src/fit/stages/noise.h"
#include "src/fit/quantise.h"
#include "src/fit/stages/smooth.h"
#include "src/fit/stages/fit_surface.h"
#undef static

struct step_seen {
    uint64_t entries;
    uint32_t visible;
};

struct step_status {
    uint32_t done;
    uint32_t is_full;              /* 1: the tiles' splat lists overflowed; this step and all later ones change
                                      nothing */
    uint32_t updates_sh;           /* 1: the last step did update the Gaussians, so a second stream updates their
                                      spherical harmonics too */
    uint32_t entries_most;
    uint32_t large_count[2], huge_count[2];
    uint32_t long_lists;
    step_seen seen;
};

/* The buffers of a fitting step in device memory, for one view. Slots (pairs of a splat and a tile) are numbered by
   Gaussian, then by tile. */
struct step_buffers {
    step_status *status;
    fxs_fit_splat *splats;         /* projected Gaussians; depth 0: Gaussian is not visible */
    uint32_t *bases;               /* number of tiles that each Gaussian touches, later index of its first slot (pair
                                      with a tile) */
    uint32_t *large, *huge;        /* `large` lists Gaussians that touch more than FEW_TILES tiles, `huge` those that
                                      touch more than MANY_TILES */
    uint32_t turn;
    uint32_t *splat_of;
    uint32_t *tiles;               /* tile of each slot (pair of a splat and a tile); shares memory with `sums` */
    uint64_t *keys;                /* splat lists of the tiles before sorting: depth in the upper 32 bits, slot in the
                                      lower 32 bits */
    uint32_t *slots, *gaussians;   /* splat lists of the tiles, sorted from near to far */
    uint32_t capacity;
    uint32_t *starts;              /* length of each tile's splat list, later the list's start */
    uint32_t *next;                /* place where each tile's next list entry is written */
    uint32_t *order;               /* tiles sorted by descending length of their splat lists, for load balance */
    uint16_t *blocks;              /* for each list entry, a bit set of the 4x4-pixel blocks that its splat changes */
    uint32_t *needed;              /* for each tile, number of list entries up to the last that changes a pixel */
    float *sums;                   /* FXS_FIT_SUMS gradient sums of each slot (pair of a splat and a tile); 0 beyond
                                      `needed` */
    float *picture;                /* rendered picture: 3 planes of pixels, with background and exposure applied */
    float *derivatives;            /* 9 planes of pixels: derivatives of SSIM */
    float *dissimilar;             /* 3 planes of pixels: 1 - SSIM, for a progress report */
    float *gradient;               /* 3 planes of pixels: loss gradient by the colour of each pixel */
    float *rows;
    float *factors;                /* fitted exposure of the photograph; null: not fitted */
    float *gain_rows;
    uint8_t *photograph;           /* the photograph, scaled to the camera's size; then its mask */
    void *scratch;
    size_t scratch_bytes;
};

struct device_model {
    uint32_t count, stride;        /* `stride`: number of Gaussians that fit, a multiple of FXS_FIT_CHUNK */
    float *parameters, *means, *squares, *by_centre, *views;
    float *masters;                /* exact parameters before quantisation; null: not quantised */
    fxs_fit_chunk *chunks;
};

struct posed_camera {
    float rotation[9], eye[3];
};

__device__ inline fxs_fit_camera with_pose(const fxs_fit_camera &given, const posed_camera *posed)
{
    fxs_fit_camera camera = given;
    memcpy(camera.rotation, posed->rotation, sizeof camera.rotation);
    memcpy(camera.eye, posed->eye, sizeof camera.eye);
    return camera;
}

/* A second CUDA stream. Its work starts at the event `begin` of the step's stream and ends with the event `end`. */
struct side_stream {
    cudaStream_t stream;
    cudaEvent_t begin, end;

    cudaError_t start(cudaStream_t of_step) const
    {
        const cudaError_t failure = cudaEventRecord(begin, of_step);
        return failure ? failure : cudaStreamWaitEvent(stream, begin);
    }
};

/* Launches a kernel before the previous one ends (programmatic dependent launch). The kernel must begin with
   is_stopped, which waits for the previous kernel. */
template <class... Parameters>
cudaError_t launch_early(void (*kernel)(Parameters...), dim3 blocks, uint32_t threads, size_t shared,
                         cudaStream_t stream, const Parameters &...parameters)
{
    cudaLaunchAttribute early = {};
    early.id = cudaLaunchAttributeProgrammaticStreamSerialization;
    early.val.programmaticStreamSerializationAllowed = 1;
    cudaLaunchConfig_t how = {};
    how.gridDim = blocks;
    how.blockDim = dim3(threads);
    how.dynamicSmemBytes = shared;
    how.stream = stream;
    how.attrs = &early;
    how.numAttrs = 1;
    return cudaLaunchKernelEx(&how, kernel, parameters...);
}

/* Waits for the previous kernel. Returns true if the tiles' splat lists overflowed, so that this step must change
   nothing. */
__device__ inline bool is_stopped(const step_status *status)
{
    wait_for_last_kernel();
    return *(volatile const uint32_t *)&status->is_full != 0;
}

}

#endif
