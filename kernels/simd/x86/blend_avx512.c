#include "lanes_avx512.h"
#include "../lanes/blend.h"
