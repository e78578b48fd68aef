#include "lanes_mve.h"
#include "kernels/simd/lanes/animate.h"
