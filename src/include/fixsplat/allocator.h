/* Memory for what reads and packs scenes: the caller's, or the C library's.
 *
 * An allocator that is null stands for malloc and free. fxs_pack calls its functions from any thread of the pool, one
 * call at a time. */
#ifndef FXS_ALLOCATOR_H
#define FXS_ALLOCATOR_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fxs_allocator {
    void *(*allocate)(void *argument, size_t bytes);   /* at least 1 byte, aligned as by malloc; null: there is none */
    void (*release)(void *argument, void *block);      /* a block that allocate returned, never null */
    void *argument;                                    /* first argument of both */
} fxs_allocator;

/* Allocates count * size bytes. Returns null where there is no memory, or the product is beyond SIZE_MAX. */
void *fxs_allocate(const fxs_allocator *allocator, size_t count, size_t size);

/* The same, with all bytes 0. */
void *fxs_allocate_zeroed(const fxs_allocator *allocator, size_t count, size_t size);

/* Moves the `old_count` items of a block to a larger one, and releases the block. `block` may be null where old_count
   is 0. Returns null where there is no memory; the block is as it was then. */
void *fxs_enlarge(const fxs_allocator *allocator, void *block, size_t old_count, size_t count, size_t size);

/* Gives a block back. It may be null. */
void fxs_release(const fxs_allocator *allocator, void *block);

#ifdef __cplusplus
}
#endif

#endif
