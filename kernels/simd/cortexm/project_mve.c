#include "lanes_mve.h"
#include "../lanes/project.h"
