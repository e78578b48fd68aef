/* What the tests see of the insides of fits on CUDA. */
#ifndef PEEK_FIT_H
#define PEEK_FIT_H

#include "kernels/fit/cuda/cuda_fit.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The buffers of the last photograph of the first device, on the host, for free. */
typedef struct peeked_fit {
    fxs_fit_splat *splats;         /* by Gaussian */
    uint32_t *starts, *slots, *splat_of, *gaussians, *needed, entries;
    uint16_t *blocks;
    float (*sums)[FXS_FIT_SUMS];
    float *picture, *derivatives, *gradient;   /* 3, 9 and 3 planes */
} peeked_fit;

/* Returns 0 where they could be copied. */
int peek_fit(void *engine, const fxs_fit_camera *camera, peeked_fit *out);
void peek_fit_free(peeked_fit *p);

/* Lists from now on have room for so few entries. Returns 0 where that worked. */
int peek_fit_narrow(void *engine, uint32_t capacity);

/* Bytes of device memory that the first device's budget has taken. */
uint64_t peek_fit_bytes(const void *engine);

/* For how many alpha from 2^-9 to 0.99 odds_of is not the quotient; -1: could not be run. */
long peek_fit_odds(void);

/* A kernel of the first device ends in a trap: from then on CUDA fails, as where the device is lost, in all of the
   process. */
void peek_fit_lose(void *engine);

#ifdef __cplusplus
}
#endif

#endif
