/* Large pages of memory. */
#ifndef FXS_PAGES_INTERNAL_H
#define FXS_PAGES_INTERNAL_H

#include <stddef.h>

/* Asks the system to back a block with large pages. Saves page faults, about a microsecond per page, if all of the
   block will be written. Does nothing for null. */
void fxs_use_large_pages(void *block, size_t bytes);

#endif
