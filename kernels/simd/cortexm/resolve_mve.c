#include "lanes_mve.h"
#include "../lanes/resolve.h"
