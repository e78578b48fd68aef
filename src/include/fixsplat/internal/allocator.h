/* Memory for reading and packing scenes. A null allocator stands for malloc and free. fxs_pack may call an allocator
 * from any thread of the pool, one call at a time.
 *
 * Stable from version 1.0 on. */
#ifndef FXS_ALLOCATOR_H
#define FXS_ALLOCATOR_H

#include <stddef.h>

#include <fixsplat/fixsplat.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Allocates count * size bytes. Returns null if memory ran out or the product exceeds SIZE_MAX. */
FXS_EXPERIMENTAL void *fxs_allocate(const fxs_allocator *allocator, size_t count, size_t size);

/* Allocates count * size bytes like fxs_allocate, with all bytes 0. */
FXS_EXPERIMENTAL void *fxs_allocate_zeroed(const fxs_allocator *allocator, size_t count, size_t size);

/* Moves `old_count` items of a block to a new block for `count` items, and frees the old block. `block` may be null
   if old_count is 0. Returns null if memory ran out; the old block then stays unchanged. */
FXS_EXPERIMENTAL void *fxs_enlarge(const fxs_allocator *allocator, void *block, size_t old_count, size_t count,
                                   size_t size);

/* Frees a block. A null block is allowed. */
FXS_EXPERIMENTAL void fxs_release(const fxs_allocator *allocator, void *block);

#ifdef __cplusplus
}
#endif

#endif
