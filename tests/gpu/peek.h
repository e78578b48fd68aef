/* Access to internals of the CUDA back end, for tests. */
#ifndef PEEK_H
#define PEEK_H

#include <fixsplat/cuda.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Host copies of the buffers after the last frame of slot 0; release with peek_free. */
typedef struct peeked {
    void *splats;                  /* fxs_splat, by index */
    uint32_t *counts, *ends;
    uint64_t *entries;             /* for each tile: `counts` entries, up to its end */
} peeked;

/* Returns 0 on success. */
int peek(fxs_cuda *cuda, peeked *out);
void peek_free(peeked *p);

/* Copies the cut of that frame (fxs_drawn; release with free). *by_device: 1 if the device computed it. Returns 0 on
   success. */
int peek_cut(fxs_cuda *cuda, void **drawn, uint32_t *count, int *by_device);

/* True if a list of this length is sorted in place. It then begins with 32-bit entries without depths. */
int peek_is_sorted(uint32_t count);

/* Returns how many levels and alphas computed with floats differ from pixel.h; -1 on a device failure. */
long peek_levels(void);

/* Fits the kernels' blocks to an artificial limit of shared memory. Returns 0 if it suffices. */
int peek_fit_blocks(fxs_cuda *cuda, size_t shared_most, fxs_message *why);

/* Sets artificial capacities: `entries`, up to the real one (0: the real one), and `split` entries in bins. */
void peek_limit_room(fxs_cuda *cuda, uint64_t entries, uint64_t split);

void *peek_device_memory(size_t bytes);
void peek_device_free(void *memory);
void *peek_pinned_memory(size_t bytes);
void peek_pinned_free(void *memory);
/* Copies between host and device memory. Returns 0 on success. */
int peek_copy(void *to, const void *from, size_t bytes);

/* Returns the milliseconds of the frames by the device's clock; negative on failure. */
float peek_time(fxs_cuda *cuda, const fxs_cuda_frame *frames, uint32_t count, const fxs_options *options,
                fxs_message *why);

#ifdef __cplusplus
}
#endif

#endif
