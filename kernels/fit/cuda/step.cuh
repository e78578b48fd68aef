/* A step of the fit on a device: compiles the sources of src/fit for the device, and declares the device buffers. */
#ifndef FXS_CUDA_FIT_STEP_CUH
#define FXS_CUDA_FIT_STEP_CUH

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cuda_runtime.h>

#include "kernels/cuda/warp.cuh"
#include "src/fit/fit_stage.h"

/* src/fit with one lane: `real` is float, so the operations are the same one by one. Compiled without contraction of
   multiplications and additions. */
namespace {
#define static static __host__ __device__
#include "src/fit/fit_lanes.h"
#include "src/fit/fit_gaussian.h"

/* alpha / (1 - alpha) for alpha in 2^-8..0.99, correctly rounded, without the range checks of a division: a Newton step
   for 1 / (1 - alpha), then a correction of the quotient by its remainder (Markstein 1990). test_fit checks every
   alpha. */
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

#include "src/fit/fit_pixel.h"
#include "src/fit/span.h"
#include "src/fit/fit_project.h"
#include "src/fit/adam.h"
#include "src/fit/noise.h"
#include "src/fit/quantise.h"
#include "src/fit/smooth.h"
#undef static

/* Counts since the last clear. */
struct step_seen {
    uint64_t entries;
    uint32_t visible;
};

/* Status of the steps since the host last read it. */
struct step_status {
    uint32_t done;                 /* completed steps */
    uint32_t is_full;              /* 1: a step exceeded `capacity`; it and all later steps change nothing */
    uint32_t updates_sh;           /* 1: the last update was of a step with room. SH are updated on a side stream; the
                                      next step may be full by then */
    uint32_t entries_most;         /* largest number of entries of a step */
    uint32_t large_count[2], huge_count[2];    /* lengths of large and huge, indexed by `turn` */
    uint32_t long_lists;           /* the first long_lists tiles in `order` have long lists */
    step_seen seen;
};

/* Device memory of a step, for one view. A slot is a pair of splat and tile; slots are numbered by Gaussian, then by
   its tiles row by row. */
struct step_buffers {
    step_status *status;
    fxs_fit_splat *splats;         /* per Gaussian; depth 0: not in the picture. The member `slot` is not set */
    uint32_t *bases;               /* per Gaussian, plus one: number of tiles; then its first slot */
    uint32_t *large, *huge;        /* Gaussians with more than FEW_TILES, and with more than MANY_TILES tiles;
                                      unordered */
    uint32_t turn;                 /* index of their counters, 0 or 1 */
    uint32_t *splat_of;            /* per slot: its Gaussian */
    uint32_t *tiles;               /* per slot: its tile. Shares memory with `sums`, as do long lists in bins */
    uint64_t *keys;                /* the lists, tile by tile: depth above, slot below; unsorted */
    uint32_t *slots, *gaussians;   /* per list entry, sorted near to far: slot; Gaussian */
    uint32_t capacity;             /* slots */
    uint32_t *starts;              /* per tile, plus one: list length; then list start */
    uint32_t *next;                /* per tile: where its next entry goes */
    uint32_t *order;               /* tiles, longest lists first, for load balance */
    uint16_t *blocks;              /* per list entry: the 4x4 blocks that blend it (fit_stage.h) */
    uint32_t *needed;              /* per tile: entries up to the last one that a pixel blends */
    float *sums;                   /* per slot: FXS_FIT_SUMS numbers; 0 for entries beyond `needed` */
    /* Planes of picture_stride = width * height pixels, without margins: red, green, blue. */
    float *picture;                /* 3 planes: with background and, if any, exposure */
    float *derivatives;            /* 9 planes: derivatives of SSIM by mean, square and product, per channel */
    float *dissimilar;             /* 3 planes: 1 - SSIM; written for a report only */
    float *gradient;               /* 3 planes: dL/dcolour of `picture` */
    float *rows;                   /* for a report, per channel: `height` sums of |a - b|, then `height` sums of 1 -
                                      SSIM */
    float *factors;                /* FXS_FIT_GAIN numbers: the photograph's exposure; null: no exposures */
    float *gain_rows;              /* exposures: row sums for each number of gain_gradient */
    uint8_t *photograph;           /* red, green, blue at the camera's size, then the mask, if any */
    void *scratch;                 /* for CUB */
    size_t scratch_bytes;
};

/* The Gaussians on a device; planes as in fxs_fit_model. */
struct device_model {
    uint32_t count, stride;        /* stride: capacity, a multiple of FXS_FIT_CHUNK; numbers beyond `count` are not
                                      used */
    float *parameters, *means, *squares, *by_centre, *views;
    float *masters;                /* null: `parameters` are the masters */
    fxs_fit_chunk *chunks;         /* of the grid; null without masters */
};

/* The camera members that a pose changes. */
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

/* A side stream: runs between the events `begin` (recorded on the step's stream) and `end`. */
struct side_stream {
    cudaStream_t stream;
    cudaEvent_t begin, end;

    /* Makes the side stream wait for the work on the step's stream so far. */
    cudaError_t start(cudaStream_t of_step) const
    {
        const cudaError_t failure = cudaEventRecord(begin, of_step);
        return failure ? failure : cudaStreamWaitEvent(stream, begin);
    }
};

/* Launches a kernel with programmatic dependent launch. It must begin with is_stopped, which waits for the previous
   kernel. */
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

/* First call in a kernel: waits for the previous kernel; true if this or an earlier step exceeded its capacity. */
__device__ inline bool is_stopped(const step_status *status)
{
    wait_for_last_kernel();
    return *(volatile const uint32_t *)&status->is_full != 0;
}

}

#endif
