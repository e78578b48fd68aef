#ifdef __aarch64__
#include "lanes_neon.h"
#include "kernels/simd/lanes/animate.h"
#endif
