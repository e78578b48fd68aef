#include "lanes_simd128.h"
#include "../lanes/blend.h"
