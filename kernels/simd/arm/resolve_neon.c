#include "lanes_neon.h"
#include "../lanes/resolve.h"
