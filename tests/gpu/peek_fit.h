/* Gives tests access to internal buffers of fits on CUDA. */
#ifndef PEEK_FIT_H
#define PEEK_FIT_H

#include "kernels/fit/cuda/cuda_fit.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Copies in host memory of the first device's buffers, after the last photograph of a fit step. Free with
   peek_fit_free. */
typedef struct peeked_fit {
    fxs_fit_splat *splats;
    uint32_t *starts, *slots, *splat_of, *gaussians, *needed, entries;
    uint16_t *blocks;
    float (*sums)[FXS_FIT_SUMS];
    float *picture, *derivatives, *gradient;   /* float planes: 3 in picture, 9 in derivatives, 3 in gradient */
} peeked_fit;

int peek_fit(void *engine, const fxs_fit_camera *camera, peeked_fit *out);
void peek_fit_free(peeked_fit *p);

int peek_fit_narrow(void *engine, uint32_t capacity);

/* Returns how many bytes of device memory are in use. */
uint64_t peek_fit_bytes(const void *engine);

/* Counts the alphas for which the kernels' alpha / (1 - alpha) differs from the exact quotient. -1: failure. */
long peek_fit_odds(void);

/* Runs a CUDA kernel that crashes. Afterwards all CUDA calls of the process fail, as after a lost device. */
void peek_fit_lose(void *engine);

#ifdef __cplusplus
}
#endif

#endif
