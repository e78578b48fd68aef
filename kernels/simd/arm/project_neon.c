#include "lanes_neon.h"
#include "../lanes/project.h"
