#include "lanes_neon.h"
#include "kernels/simd/lanes/shade.h"
