#include "lanes_neon.h"
#include "../lanes/bin.h"
