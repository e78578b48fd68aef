#include "lanes_neon.h"
#include "kernels/simd/lanes/resolve.h"
