#define ISA c
#include "fit_isa.h"
