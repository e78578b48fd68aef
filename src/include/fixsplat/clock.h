/* A clock for fxs_config: nanoseconds, never backwards. */
#ifndef FXS_CLOCK_H
#define FXS_CLOCK_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

uint64_t fxs_clock(void *unused);

#ifdef __cplusplus
}
#endif

#endif
