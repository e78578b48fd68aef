#include "lanes_simd128.h"
#include "../lanes/resolve.h"
