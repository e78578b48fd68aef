#define _DEFAULT_SOURCE            /* declares madvise */
#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>

#include "src/base/pages_internal.h"
#include "src/base/os_calls.h"

void *fxs_aligned_allocate(size_t bytes)
{
    void *block;
    return posix_memalign(&block, 64, bytes) ? NULL : block;
}

void fxs_aligned_free(void *block)
{
    free(block);
}

/* Opens a stream that prints to memory. glibc reports no error if the stream's last growth fails, so fxs_print_end also
   checks text and size. */
int fxs_print_begin(fxs_printed *printed)
{
    *printed = (fxs_printed){.text = NULL};
    printed->file = open_memstream(&printed->text, &printed->size);
    return printed->file ? 0 : -1;
}

int fxs_print_end(fxs_printed *printed)
{
    const int failed = ferror(printed->file);
    if (!fclose(printed->file) && !failed && printed->text && printed->size)
        return 0;
    free(printed->text);
    printed->text = NULL;
    return -1;
}

/* Asks for large pages in a memory block. Only complete large pages (2 MiB) are included, so that no other block shares
   them. */
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
