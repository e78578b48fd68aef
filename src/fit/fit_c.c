#define ISA c
#include "fit_stages.h"
