#include "lanes_sse41.h"
#include "kernels/simd/lanes/lane_animate.h"
