#include "lanes_neon.h"
#include "../lanes/shade.h"
