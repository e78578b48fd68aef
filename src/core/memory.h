/* The only include of the C library. Compilers may emit calls to its memory functions in any case. */
#ifndef FXS_MEMORY_H
#define FXS_MEMORY_H

#include <string.h>

#endif
