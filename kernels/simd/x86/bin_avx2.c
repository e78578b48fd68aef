#include "lanes_avx2.h"
#include "../lanes/bin.h"
