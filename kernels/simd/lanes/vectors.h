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

/* Byte shuffles that move the lanes of a mask to the front. */
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

#endif
