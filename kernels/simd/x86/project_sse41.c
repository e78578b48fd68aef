#include "lanes_sse41.h"
#include "../lanes/project.h"
