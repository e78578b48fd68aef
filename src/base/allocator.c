#include <fixsplat/internal/allocator.h>

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static int overflows(size_t count, size_t size)
{
    return size > 0 && count > SIZE_MAX / size;
}

void *fxs_allocate(const fxs_allocator *allocator, size_t count, size_t size)
{
    if (overflows(count, size))
        return NULL;
    size_t bytes = count * size > 0 ? count * size : 1;
    return allocator ? allocator->allocate(allocator->argument, bytes) : malloc(bytes);
}

/* Allocates zeroed memory. Uses calloc without a program's allocator, because the system supplies large blocks already
   zeroed. */
void *fxs_allocate_zeroed(const fxs_allocator *allocator, size_t count, size_t size)
{
    if (!allocator && !overflows(count, size))
        return calloc(count > 0 ? count : 1, size > 0 ? size : 1);
    void *block = fxs_allocate(allocator, count, size);
    return block ? memset(block, 0, count * size) : NULL;
}

void *fxs_enlarge(const fxs_allocator *allocator, void *block, size_t old_count, size_t count, size_t size)
{
    void *larger = fxs_allocate(allocator, count, size);
    if (!larger)
        return NULL;
    if (block)
        memcpy(larger, block, old_count * size);
    fxs_release(allocator, block);
    return larger;
}

void fxs_release(const fxs_allocator *allocator, void *block)
{
    if (!allocator)
        free(block);
    else if (block)
        allocator->release(allocator->argument, block);
}
