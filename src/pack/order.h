/* Orders the Gaussians of a scene in chunks of 256 that look small from around the middle. */
#ifndef FXS_ORDER_H
#define FXS_ORDER_H

#include <string.h>

#include <fixsplat/pack.h>

#define FXS_NO_SLOT UINT32_MAX
#define FXS_BEGINS_CHUNK (1u << 31)   /* in an index; a scene has at most 2^30 Gaussians */

typedef struct fxs_order_entry {
    float position[3];                          /* x is NaN for a Gaussian left out */
    uint32_t index;                             /* in the file; before, 1: to be ordered by themselves */
} fxs_order_entry;

/* Sorts entries whose positions are given in file order, and sets their indexes. Entries that are left out come last,
   before them those ordered by themselves, except that their first ones fill the last chunk of the others. Each stretch
   of FXS_CHUNK is a leaf of a tree, and each subtree a stretch of leaves; only the last leaf is shorter. Where `reach`
   is not 0, a leaf whose box is longer than about so many times the distance of its Gaussians from the middle is cut
   into several chunks, and FXS_BEGINS_CHUNK is set in the index of the first entry of each but the first one. Needs 100
   KB while it runs. options->run is not null. Returns 0 or FXS_ERR_MEMORY. */
int fxs_order(fxs_order_entry *entries, uint32_t count, float reach, const fxs_pack_options *options);

/* Sets the indexes of at most FXS_CHUNK entries to their order along a Morton curve in their cube, then by index, so
   that neighbours in the list are near in space. Positions stay where they are. */
void fxs_order_chunk(fxs_order_entry *entries, uint32_t count);

/* A number that sorts like a float that is not NaN, -0 before 0; and the float of such a number. */
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

/* The value that would be at place `rank` < count if these were sorted. */
float fxs_value_of_rank(const float *values, size_t count, size_t rank);

#endif
