#define _DEFAULT_SOURCE            /* madvise */
#include <stdint.h>
#include <sys/mman.h>

#include "src/base/pages_internal.h"

/* Only whole large pages, so that no other block has a part in one. */
void fxs_use_large_pages(void *block, size_t bytes)
{
#ifdef MADV_HUGEPAGE
    const uintptr_t large = (uintptr_t)1 << 21;
    const uintptr_t first = ((uintptr_t)block + large - 1) / large * large;
    const uintptr_t end = ((uintptr_t)block + bytes) / large * large;
    if (block && first < end)
        (void)madvise((void *)first, end - first, MADV_HUGEPAGE);
#else
    (void)block;
    (void)bytes;
#endif
}
