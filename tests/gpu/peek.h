/* What the tests see of the CUDA back end's insides. */
#ifndef PEEK_H
#define PEEK_H

#include <fixsplat/cuda.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The buffers of the last frame of slot 0, on the host, for free. */
typedef struct peeked {
    void *splats;                  /* fxs_splat, by index */
    uint32_t *counts, *ends;
    uint64_t *entries;             /* of a tile: up to its end */
} peeked;

/* Returns 0 where they could be copied. */
int peek(fxs_cuda *cuda, peeked *out);
void peek_free(peeked *p);

/* The cut of that frame, fxs_drawns, for free; and whether the device found it. Returns 0 where it could be copied. */
int peek_cut(fxs_cuda *cuda, void **drawn, uint32_t *count, int *by_device);

/* Whether a list of so many entries is sorted in its place: entries alone, from where it began. */
int peek_is_sorted(uint32_t count);

/* How many of the levels computed in float registers differ from pixel.h's; -1 where the device failed. */
long peek_levels(void);

/* As if a block could have only so much shared memory. Returns 0 where that is enough. */
int peek_fit_blocks(fxs_cuda *cuda, size_t shared_most, fxs_message *why);

/* As if there were room for so many entries, no more than there is, and for `split` in bins; entries 0: all again. */
void peek_limit_room(fxs_cuda *cuda, uint64_t entries, uint64_t split);

void *peek_device_memory(size_t bytes);
void peek_device_free(void *memory);
void *peek_pinned_memory(size_t bytes);
void peek_pinned_free(void *memory);
/* From and to any memory. Returns 0 where that worked. */
int peek_copy(void *to, const void *from, size_t bytes);

/* Milliseconds of frames on the device, by its own clock; below 0 where they failed. */
float peek_time(fxs_cuda *cuda, const fxs_cuda_frame *frames, uint32_t count, const fxs_options *options,
                fxs_message *why);

#ifdef __cplusplus
}
#endif

#endif
