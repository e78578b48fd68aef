#include "lanes_simd128.h"
#include "../lanes/project.h"
