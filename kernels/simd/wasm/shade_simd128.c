#include "lanes_simd128.h"
#include "../lanes/shade.h"
