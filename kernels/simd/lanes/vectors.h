/* Vectors of LANES numbers, with the vector extensions of GCC and clang. The operators + - * & | ~ and shifts by a
 * constant work on vectors. The header of each instruction set, such as kernels/simd/x86/lanes_avx2.h, has the
 * other operations. That header first defines ISA, the name of the instruction set, and LANES: 4, 8 or 16. */
#ifndef FXS_VECTORS_H
#define FXS_VECTORS_H

#include <stdint.h>

typedef int32_t vi __attribute__((vector_size(4 * LANES)));
typedef uint32_t vu __attribute__((vector_size(4 * LANES)));
typedef uint64_t vw __attribute__((vector_size(4 * LANES)));
typedef int16_t vh __attribute__((vector_size(4 * LANES)));     /* 2 * LANES numbers of 16 bits */
typedef uint8_t anywhere __attribute__((vector_size(4 * LANES), aligned(1), may_alias));

static const int32_t lane_numbers[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};

/* Byte shuffles that move the selected lanes of a vector to the front, indexed by a 4-bit mask of lanes. */
#define BYTES(lane) (0x03020100 + 0x04040404 * (lane))
#define ORDER(a, b, c, d) {BYTES(a), BYTES(b), BYTES(c), BYTES(d)}
static const int32_t compress_order[16][4] __attribute__((aligned(16))) = {
    ORDER(0, 1, 2, 3), ORDER(0, 1, 2, 3), ORDER(1, 0, 2, 3), ORDER(0, 1, 2, 3),
    ORDER(2, 0, 1, 3), ORDER(0, 2, 1, 3), ORDER(1, 2, 0, 3), ORDER(0, 1, 2, 3),
    ORDER(3, 0, 1, 2), ORDER(0, 3, 1, 2), ORDER(1, 3, 0, 2), ORDER(0, 1, 3, 2),
    ORDER(2, 3, 0, 1), ORDER(0, 2, 3, 1), ORDER(1, 2, 3, 0), ORDER(0, 1, 2, 3),
};
#undef ORDER
#undef BYTES

static inline vi load(const void *from)
{
    return (vi)*(const anywhere *)from;
}

static inline void store(void *to, vi x)
{
    *(anywhere *)to = (__typeof__(*(anywhere *)to))x;
}

static inline vu ramp(uint32_t base, uint32_t step)
{
    return base + step * (vu)load(lane_numbers);
}

static inline vh load_h(const int16_t *from)
{
    return (vh)load(from);
}

static inline void store_h(int16_t *to, vh x)
{
    store(to, (vi)x);
}

/* Operations that the headers of the instruction sets define:
 *
 *   load_fours         loads the four words at from + stride * at[lane] for each lane
 *   store_u16          stores numbers of 0 to 65535 in 16 bits each
 *   store_compressed   stores the lanes of a mask without gaps; may write a whole vector
 *   store_pairs        stores a[0], b[0], a[1], b[1], ...
 *   shift_left, shift_right   shift per lane; a shift of 32 to 127 gives 0
 *   scale_down         x * 2^-shift, rounded to nearest; shift is 1 to 127
 *   round_shift        x * 2^-shift, rounded to nearest, halves up; shift is a constant
 *   narrow             bits shift to shift + 31 of 64-bit numbers; shift is a constant, 1 to 31
 *   narrow_by          x * 2^-shift of 64-bit numbers, rounded down; must fit in 32 bits; shift is 0 to 63
 *   scale_down_wide    x * 2^-shift of 64-bit numbers, rounded to nearest; must fit in 31 bits
 *   top_half           (x << shift) >> 32 of 64-bit numbers
 *   octet              8 words or 16 numbers of 16 bits
 *   odd_numbers        expands 15 codes of 3 bits, lowest first, to odd numbers -7 to 7
 *   mul_add_h          rounded Q15 product plus c; mul_add_cut_h saturates the sum
 *   pack_q13           packs a >> 11 and b >> 11 to 16 bits, saturated
 *   open_of            mask of pixels that are not yet opaque */

#endif
