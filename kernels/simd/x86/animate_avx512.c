#include "lanes_avx512.h"
#include "kernels/simd/lanes/animate.h"
