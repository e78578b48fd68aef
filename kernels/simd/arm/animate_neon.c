#ifdef __aarch64__
#include "lanes_neon.h"
#include "kernels/simd/lanes/lane_animate.h"
#endif
