#include "lanes_neon.h"
#include "../lanes/blend.h"
