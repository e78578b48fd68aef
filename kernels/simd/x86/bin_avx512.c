#include "lanes_avx512.h"
#include "../lanes/bin.h"
