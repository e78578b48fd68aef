/* A step of the fit on a device: the text of src/fit compiled for the device, and the memory that the kernels share. */
#ifndef FXS_CUDA_FIT_STEP_CUH
#define FXS_CUDA_FIT_STEP_CUH

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cuda_runtime.h>

#include "kernels/cuda/warp.cuh"
#include "src/fit/fit_stage.h"

/* The text of src/fit for one lane: `real` is float, so the operations are the same, one by one. It is compiled without
   contraction. */
namespace {
#define static static __host__ __device__
#include "src/fit/fit_lanes.h"
#include "src/fit/fit_gaussian.h"

/* alpha / (1 - alpha), alpha in 2^-8..0.99, rounded as a division is, without a look at numbers that are too large or
   too small for this: Newton's step for 1 / (1 - alpha), and one of the quotient by its rest (Markstein 1990). test_fit
   tries all of them. */
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

/* Counts of what was in the pictures, since they were last cleared. */
struct step_seen {
    uint64_t entries;
    uint32_t visible;
};

/* How the steps since the host last looked went. */
struct step_status {
    uint32_t done;                 /* steps that were completed */
    uint32_t is_full;              /* 1: a step had more entries than there is room for; it and those after it change
                                      nothing */
    uint32_t updates_sh;           /* whether the last update was of a step that had room: the next step may be full
                                      by the time that SH are updated */
    uint32_t entries_most;         /* of a step */
    uint32_t large_count[2], huge_count[2];    /* of step_buffers, by turns */
    uint32_t long_lists;           /* the first so many in `order` are long */
    step_seen seen;
};

/* Device memory of a step; of one view. Slots are numbers of pairs of a splat and a tile, Gaussian by Gaussian, each
   one's tiles row by row. */
struct step_buffers {
    step_status *status;
    fxs_fit_splat *splats;         /* by Gaussian; depth 0: not in the picture. slot: not set */
    uint32_t *bases;               /* by Gaussian, and one more: its tiles; then the slots of those before it */
    uint32_t *large, *huge;        /* Gaussians of more than FEW_TILES tiles, and of more than MANY_TILES, in any
                                      order */
    uint32_t turn;                 /* of their counters */
    uint32_t *splat_of;            /* by slot: the Gaussian */
    uint32_t *tiles;               /* by slot: the tile; in the memory of sums, like long lists in bins later on */
    uint64_t *keys;                /* the lists, of the first tile, of the next...: depth above, slot below, in no
                                      order */
    uint32_t *slots, *gaussians;   /* by place in the lists, near to far: the slot, the Gaussian */
    uint32_t capacity;             /* slots */
    uint32_t *starts;              /* by tile, and one more: how long its list is; then where it begins */
    uint32_t *next;                /* by tile: where the next entry of its list goes */
    uint32_t *order;               /* the tiles, those with long lists first: so none is late */
    uint16_t *blocks;              /* by place in the lists: the blocks of 4x4 that take of it (fit_stage.h) */
    uint32_t *needed;              /* by tile: entries up to the last one that a pixel took of */
    float *sums;                   /* by slot: FXS_FIT_SUMS; 0 of entries beyond `needed` */
    /* Planes of pixels, of picture_stride = width by height numbers, without margins: red, green, blue. */
    float *picture;                /* 3: with background, as `factors` change it */
    float *derivatives;            /* 9: of each channel, of SSIM by mean, square and product */
    float *dissimilar;             /* 3: 1 - SSIM; written where a report is wanted */
    float *gradient;               /* 3: dL/dcolour of `picture` */
    float *rows;                   /* of a report: 3 times height sums of |a - b|, then as many of 1 - SSIM */
    float *factors;                /* FXS_FIT_GAIN: of the photograph's exposure; null: photographs have none */
    float *gain_rows;              /* with exposures: for each sum of gain_gradient, those of the rows */
    uint8_t *photograph;           /* red, green, blue, of the camera's size; then its mask, if any */
    void *scratch;                 /* for sums */
    size_t scratch_bytes;
};

/* The Gaussians on a device: planes as in fxs_fit_model, which say what they are. */
struct device_model {
    uint32_t count, stride;        /* `stride` is the room, a multiple of FXS_FIT_CHUNK; what is beyond `count` is not
                                      read */
    float *parameters, *means, *squares, *by_centre, *views;
    float *masters;                /* null: the parameters are */
    fxs_fit_chunk *chunks;         /* of the grid, where there are masters */
};

/* What a pose changes of a camera. */
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

/* A stream beside the one of a step: from its event `begin` on, until its event `end`. */
struct side_stream {
    cudaStream_t stream;
    cudaEvent_t begin, end;

    /* Waits for what the step's stream has so far. */
    cudaError_t start(cudaStream_t of_step) const
    {
        const cudaError_t failure = cudaEventRecord(begin, of_step);
        return failure ? failure : cudaStreamWaitEvent(stream, begin);
    }
};

/* Starts a kernel that begins with is_stopped: it is launched while the one before it still runs. */
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

/* Kernels begin with this: whether a step before it, or this one, had no room. Waits for the kernel before it. */
__device__ inline bool is_stopped(const step_status *status)
{
    wait_for_last_kernel();
    return *(volatile const uint32_t *)&status->is_full != 0;
}

}

#endif
