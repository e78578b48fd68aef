/* Turns frames of Gaussians, given one after the other, into Gaussians that move. */
#ifndef FXS_SEQUENCE_H
#define FXS_SEQUENCE_H

#include <fixsplat/scene.h>

typedef struct fxs_sequence fxs_sequence;

/* Begins a sequence of `frames` frames, 1 or more, at `rate` frames a second. Returns null if memory runs out. */
fxs_sequence *fxs_sequence_create(uint32_t frames, double rate, int sh_degree, const fxs_allocator *allocator);

/* Adds a Gaussian of the present frame. Returns 0 or FXS_ERR_MEMORY. */
int fxs_sequence_put(fxs_sequence *sequence, const fxs_gaussian *gaussian);

/* Ends the present frame. Returns 0 or FXS_ERR_MEMORY. */
int fxs_sequence_next(fxs_sequence *sequence);

/* Completes the sequence after its last frame. Returns 0 or FXS_ERR_MEMORY. */
int fxs_sequence_finish(fxs_sequence *sequence, fxs_time *time);

/* Returns the number of moving Gaussians of a complete sequence. */
uint64_t fxs_sequence_count(const fxs_sequence *sequence);

/* Returns the memory that a sequence has allocated, bytes. */
uint64_t fxs_sequence_bytes(const fxs_sequence *sequence);

/* Writes `count` Gaussians of a complete sequence and their motions, from number `first` on. */
void fxs_sequence_get(const fxs_sequence *sequence, uint64_t first, size_t count, fxs_gaussian *gaussians,
                      fxs_motion *motions);

void fxs_sequence_free(fxs_sequence *sequence);

#endif
