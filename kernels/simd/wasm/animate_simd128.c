#include "lanes_simd128.h"
#include "kernels/simd/lanes/lane_animate.h"
