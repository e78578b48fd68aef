/* A clock for fxs_config: nanoseconds, never backwards. */
#ifndef FXS_CLOCK_H
#define FXS_CLOCK_H

#include <stdint.h>

uint64_t fxs_clock(void *unused);

#endif
