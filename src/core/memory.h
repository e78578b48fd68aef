/* Includes the only header of the C library that the renderer needs. */
#ifndef FXS_MEMORY_H
#define FXS_MEMORY_H

#include <string.h>

#endif
