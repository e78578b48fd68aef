/* Large pages of memory. */
#ifndef FXS_PAGES_INTERNAL_H
#define FXS_PAGES_INTERNAL_H

#include <stddef.h>

/* Asks the system to give a block, of which all is going to be written, memory in large pages, where it has them: a
   page that is touched first costs it a microsecond. Does nothing for null. */
void fxs_use_large_pages(void *block, size_t bytes);

#endif
