/* Large pages of memory. */
#ifndef FXS_PAGES_INTERNAL_H
#define FXS_PAGES_INTERNAL_H

#include <stddef.h>

/* Asks for large pages for a memory block, to save page faults. */
void fxs_use_large_pages(void *block, size_t bytes);

#endif
