/* Random numbers from a range, for tests that need doubles. */
#ifndef UNIFORM_H
#define UNIFORM_H

#include <math.h>
#include <stdint.h>

static uint64_t state = 1;

/* Random generator splitmix64 (Steele, Lea, Flood 2014). */
static double uniform(double low, double high)
{
    uint64_t z = state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return low + (high - low) * ldexp((double)((z ^ z >> 31) >> 11), -53);
}

#endif
