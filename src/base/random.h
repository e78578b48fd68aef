/* Random numbers. They depend only on (seed, step, index), not on the order of calls. */
#ifndef FXS_RANDOM_H
#define FXS_RANDOM_H

#include <stdint.h>

/* Hashes 64 bits (final mix of splitmix64: Steele, Lea, Flood 2014). */
static inline uint64_t fxs_random_mix(uint64_t x)
{
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return x ^ x >> 31;
}

static inline uint64_t fxs_random(uint64_t seed, uint64_t step, uint64_t index)
{
    return fxs_random_mix(fxs_random_mix(fxs_random_mix(seed) ^ step) ^ index);
}

static inline float fxs_random_uniform(uint64_t random)
{
    return (float)(random >> 40) * 0x1p-24f;
}

#endif
