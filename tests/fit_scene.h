/* Random numbers, small cameras and kernel versions for the tests of the fit. */
#ifndef FIT_SCENE_H
#define FIT_SCENE_H

#include <math.h>
#include <string.h>

#include <fixsplat/internal/kernels.h>
#include "src/fit/model.h"
#include "check.h"

static uint64_t fit_state = 1;

/* Random generator splitmix64 (Steele, Lea, Flood 2014). */
static inline uint64_t fit_random(void)
{
    uint64_t z = fit_state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

static inline double fit_uniform(double low, double high)
{
    return low + (high - low) * (double)(fit_random() >> 11) * 0x1p-53;
}

/* Lists the distinct kernel tables of the fit for this processor, plain C first. Returns their number, at most
   FIT_VERSIONS. */
enum { FIT_VERSIONS = 5 };
static const unsigned fit_cpus[FIT_VERSIONS] = {0, FXS_CPU_SSE41, FXS_CPU_AVX2, FXS_CPU_AVX512, FXS_CPU_NEON};
static inline int fit_versions(const fxs_fit_stages *versions[FIT_VERSIONS])
{
    int count = 0;
    for (int i = 0; i < FIT_VERSIONS; i++) {
        const fxs_fit_stages *found = fxs_fit_stages_choose(fit_cpus[i]);
        if (!count || found != versions[0])
            versions[count++] = found;
    }
    return count;
}

/* Makes a camera that is rotated about two axes by angles with rational sines and cosines. */
static inline fxs_fit_camera fit_camera(int32_t width, int32_t height, float focal)
{
    static const double c[2] = {0.96, 24.0 / 25}, s[2] = {0.28, 7.0 / 25};
    const double rotation[9] = {c[1], 0, s[1], s[0] * s[1], c[0], -s[0] * c[1], -c[0] * s[1], s[0], c[0] * c[1]};
    fxs_fit_camera camera = {.eye = {0.1f, 0.2f, -0.3f}, .focal = {focal, focal * 1.1f},
                             .middle = {(float)width / 2 + 0.7f, (float)height / 2 - 0.4f}, .near = 0.2f,
                             .width = width, .height = height,
                             .tiles_x = (width + FXS_FIT_TILE - 1) / FXS_FIT_TILE,
                             .tiles_y = (height + FXS_FIT_TILE - 1) / FXS_FIT_TILE};
    for (int i = 0; i < 9; i++)
        camera.rotation[i] = (float)rotation[i];
    for (int i = 0; i < 2; i++)
        camera.slope_most[i] = 0.65f * (float)(i ? height : width) / camera.focal[i];
    return camera;
}

#endif
