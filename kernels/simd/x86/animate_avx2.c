#include "lanes_avx2.h"
#include "kernels/simd/lanes/animate.h"
