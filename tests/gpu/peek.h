/* Gives tests access to internal buffers of the CUDA back end. */
#ifndef PEEK_H
#define PEEK_H

#include <fixsplat/cuda.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Host copies of a frame's splats (projected Gaussians) and tile lists: the last frame in slot 0 of several frames in
 * flight. Free with peek_free. */
typedef struct peeked {
    void *splats;                  /* array of fxs_splat, the projected Gaussians */
    uint32_t *counts, *ends;
    uint64_t *entries;             /* tile lists: the list of tile t has counts[t] entries and ends at ends[t]; null:
                                      the lists did not fit */
} peeked;

int peek(fxs_cuda *cuda, peeked *out);
void peek_free(peeked *p);

/* Copies the level-of-detail cut of the last frame, which is the list of drawn tree nodes. Free *drawn with free.
 * *by_device: 1 if the device chose the nodes. Returns 0 on success. */
int peek_cut(fxs_cuda *cuda, void **drawn, uint32_t *count, int *by_device);

/* Returns the table of a scene in parts with the place of each chunk on the device; FXS_NOTHING: not on the device. The
 * last frame drew by this table. Null: no frame has drawn the scene. */
const uint32_t *peek_places(const fxs_cuda *cuda, const fxs_scene *scene);

/* Returns 1 if the device sorts a tile list of `count` entries in place, as 32-bit entries without depths. */
int peek_is_sorted(uint32_t count);

/* Compares the device's float computation of alphas and of levels (-2 ln alpha) with the integers of pixel.h. Returns
 * the number of differences; -1: device failure. */
long peek_levels(void);

/* Chooses the sizes of thread blocks as on a device with `shared_most` bytes of shared memory. Returns 0 if they
 * suffice. */
int peek_fit_blocks(fxs_cuda *cuda, size_t shared_most, fxs_message *why);

/* Sets artificial capacities: `entries` for tile lists, `split` for long lists that are split into bins of depth, and
 * `larges` for large splats. 0: the real capacity; `split` counts if `entries` is not 0. */
void peek_limit_room(fxs_cuda *cuda, uint64_t entries, uint64_t split, uint32_t larges);

void *peek_device_memory(size_t bytes);
void peek_device_free(void *memory);
void *peek_pinned_memory(size_t bytes);
void peek_pinned_free(void *memory);
void *peek_stream(void);
void peek_stream_free(void *stream);
int peek_copy(void *to, const void *from, size_t bytes);

/* Copies after the work on the default stream, without waiting. `to` is in pinned memory. */
int peek_copy_after(void *to, const void *from, size_t bytes);

/* Renders the frames and returns their GPU time in milliseconds; negative on failure. */
float peek_time(fxs_cuda *cuda, const fxs_cuda_frame *frames, uint32_t count, const fxs_options *options,
                fxs_message *why);

#ifdef __cplusplus
}
#endif

#endif
