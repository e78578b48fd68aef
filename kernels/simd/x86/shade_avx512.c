#include "lanes_avx512.h"
#include "../lanes/shade.h"
