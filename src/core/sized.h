/* Sets and reads structs that begin with their size (fixsplat.h). A program built with an older header hands in shorter
 * structs. */
#ifndef FXS_SIZED_H
#define FXS_SIZED_H

#include "memory.h"

#include <fixsplat/fixsplat.h>

#ifdef __cplusplus
extern "C" {
#endif

#define FXS_SIZE_MOST 65535u       /* largest size of a struct; a larger value means that the program never set the
                                      size */

/* Copies the first `size` bytes of the default struct `all`, which is `bytes` long, to the program's struct `given`.
   Zeroes the rest of `given`, and stores `size` in it. */
void fxs_sized_fill(void *given, uint32_t size, const void *all, size_t bytes);

/* Copies the program's struct `given` over the default struct `all`, which is `bytes` long. Copies only the fields that
   `given` has. Sets the size of `all` to `bytes`. Returns 0, or FXS_ERR_STRUCT. */
int fxs_sized_read(void *all, size_t bytes, const void *given);

/* True if a request, its targets and options have the sizes of this version, so that it need not be copied. */
int fxs_request_is_whole(const fxs_request *request);

/* Reads a request with its targets and options; their sizes are those of the program's header too. Returns 0,
   FXS_ERR_ARGUMENT for null, or FXS_ERR_STRUCT. */
int fxs_request_read(fxs_request *all, const fxs_request *given);

/* Reads object `i` of a program's array; objects[0].size is the distance between two objects. If the object has another
   size than objects[0], sets a default object and returns FXS_ERR_STRUCT. Otherwise returns 0. */
int fxs_object_read(fxs_object *all, const fxs_object *objects, uint32_t i);

/* Returns object `i` of a program's array; its structs may be shorter than the library's. Only the fields up to
   `visible`, which every version has, may be read. */
static inline const fxs_object *fxs_object_at(const fxs_object *objects, uint32_t i)
{
    return (const fxs_object *)(const void *)((const unsigned char *)objects + (size_t)i * objects->size);
}

#ifdef __cplusplus
}
#endif

#endif
