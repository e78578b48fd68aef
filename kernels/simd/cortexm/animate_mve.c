#include "lanes_mve.h"
#include "kernels/simd/lanes/lane_animate.h"
