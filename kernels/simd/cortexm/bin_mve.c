#include "lanes_mve.h"
#include "../lanes/bin.h"
