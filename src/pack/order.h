/* Orders the Gaussians of a scene into chunks of 256 with small bounding boxes, as seen from the middle of the
   scene. */
#ifndef FXS_ORDER_H
#define FXS_ORDER_H

#include <string.h>

#include <fixsplat/pack.h>

#define FXS_NO_SLOT UINT32_MAX
#define FXS_BEGINS_CHUNK (1u << 31)   /* flag of an entry's index; free, because a scene has at most 2^30 Gaussians */

typedef struct fxs_order_entry {
    float position[3];                          /* position of the Gaussian; x is NaN for a dropped Gaussian */
    uint32_t index;                             /* input: 1 to order the Gaussian separately, else 0; output: index
                                                   in the file */
} fxs_order_entry;

/* Sorts entries, one per Gaussian, given in file order, and sets their indexes. Normal entries come first, then entries
   with input index 1, then dropped entries. Each FXS_CHUNK entries are a leaf of a k-d tree. With `reach` > 0, long
   leaves are cut into several chunks: the limit is about `reach` times their distance from the scene's middle.
   FXS_BEGINS_CHUNK marks the first entry of each additional chunk. options->workers.run must not be null. Returns 0 or
   FXS_ERR_MEMORY. */
int fxs_order(fxs_order_entry *entries, uint32_t count, float reach, const fxs_pack_options *options);

/* Sorts the indexes of at most FXS_CHUNK entries along a Morton curve. Leaves the positions unsorted. */
void fxs_order_chunk(fxs_order_entry *entries, uint32_t count);

/* Maps a float to an integer of the same order, and back. -0 sorts before 0; NaN is not allowed. */
static inline uint32_t fxs_ordered_bits(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits >> 31 ? ~bits : bits | 0x80000000u;
}

static inline float fxs_ordered_float(uint32_t bits)
{
    float x;
    bits = bits >> 31 ? bits & 0x7fffffff : ~bits;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Returns the value that sorting would put at index `rank`; rank < count. */
float fxs_value_of_rank(const float *values, size_t count, size_t rank);

#endif
