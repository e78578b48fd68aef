/* Memory for what reads and packs scenes: the caller's, or the C library's. */
#ifndef FXS_ALLOCATOR_H
#define FXS_ALLOCATOR_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_allocator {
    void *(*allocate)(void *argument, size_t bytes);   /* at least 1 byte, aligned as by malloc; NULL: there is none */
    void (*release)(void *argument, void *block);      /* a block of allocate's, not NULL */
    void *argument;
} fxs_allocator;

/* An allocator that is null stands for malloc and free. NULL: out of memory, or count * size beyond SIZE_MAX. */
void *fxs_allocate(const fxs_allocator *allocator, size_t count, size_t size);

/* The same, all bytes 0. */
void *fxs_allocate_zeroed(const fxs_allocator *allocator, size_t count, size_t size);

/* The items of a block of `old_count` (NULL: 0) in a larger one; NULL leaves the block as it was. */
void *fxs_enlarge(const fxs_allocator *allocator, void *block, size_t old_count, size_t count, size_t size);

/* NULL is allowed. */
void fxs_release(const fxs_allocator *allocator, void *block);

#ifdef __cplusplus
}
#endif

#endif
