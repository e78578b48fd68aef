#include "lanes_avx2.h"
#include "kernels/simd/lanes/lane_animate.h"
