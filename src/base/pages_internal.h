/* Large pages of memory, which save page faults. */
#ifndef FXS_PAGES_INTERNAL_H
#define FXS_PAGES_INTERNAL_H

#include <stddef.h>

/* Asks the system to use large pages for a memory block. */
void fxs_use_large_pages(void *block, size_t bytes);

#endif
