/* The one place where the C library is named: a compiler may emit calls to these anyway. */
#ifndef FXS_MEMORY_H
#define FXS_MEMORY_H

#include <string.h>

#endif
