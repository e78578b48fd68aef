#include "lanes_avx2.h"
#include "../lanes/blend.h"
