#include "lanes_mve.h"
#include "../lanes/shade.h"
