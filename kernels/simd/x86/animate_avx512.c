#include "lanes_avx512.h"
#include "kernels/simd/lanes/lane_animate.h"
