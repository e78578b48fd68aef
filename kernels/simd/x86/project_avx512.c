#include "lanes_avx512.h"
#include "../lanes/project.h"
