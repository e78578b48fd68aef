#include "lanes_sse41.h"
#include "../lanes/resolve.h"
