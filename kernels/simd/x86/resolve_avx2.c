#include "lanes_avx2.h"
#include "../lanes/resolve.h"
