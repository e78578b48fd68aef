#include "lanes_sse41.h"
#include "../lanes/blend.h"
