/* A clock for fxs_config. Stable from version 1.0 on. */
#ifndef FXS_CLOCK_H
#define FXS_CLOCK_H

#include <stdint.h>

#include "fixsplat.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Nanoseconds of a monotonic clock. */
FXS_API uint64_t fxs_clock(void *unused);

#ifdef __cplusplus
}
#endif

#endif
