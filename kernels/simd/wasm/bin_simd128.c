#include "lanes_simd128.h"
#include "../lanes/bin.h"
