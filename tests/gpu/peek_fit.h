/* Gives tests access to internal buffers of fits on CUDA. */
#ifndef PEEK_FIT_H
#define PEEK_FIT_H

#include "kernels/fit/cuda/cuda_fit.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Host copies of the first device's buffers after the last photograph. Free with peek_fit_free. */
typedef struct peeked_fit {
    fxs_fit_splat *splats;         /* indexed by Gaussian */
    uint32_t *starts, *slots, *splat_of, *gaussians, *needed, entries;
    uint16_t *blocks;
    float (*sums)[FXS_FIT_SUMS];
    float *picture, *derivatives, *gradient;   /* 3, 9 and 3 planes of floats */
} peeked_fit;

int peek_fit(void *engine, const fxs_fit_camera *camera, peeked_fit *out);
void peek_fit_free(peeked_fit *p);

int peek_fit_narrow(void *engine, uint32_t capacity);

/* Returns the bytes of device memory taken from the first device's budget. */
uint64_t peek_fit_bytes(const void *engine);

/* Returns for how many alpha from 2^-9 to 0.99 the function odds_of differs from the exact quotient; -1 on failure. */
long peek_fit_odds(void);

/* Runs a kernel that traps. Afterwards all CUDA calls of the process fail, as after a lost device. */
void peek_fit_lose(void *engine);

#ifdef __cplusplus
}
#endif

#endif
