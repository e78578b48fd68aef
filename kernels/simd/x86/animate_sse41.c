#include "lanes_sse41.h"
#include "kernels/simd/lanes/animate.h"
