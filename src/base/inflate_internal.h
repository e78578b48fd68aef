/* Inflates data in memory with zlib. */
#ifndef FXS_INFLATE_INTERNAL_H
#define FXS_INFLATE_INTERNAL_H

#include "source_internal.h"

#define FXS_MAX_EXPANSION 1032u        /* most output bytes that deflate makes from an input byte */

/* Decompresses a raw deflate stream to exactly `wanted` bytes. Returns 0, or an error and a message. */
int fxs_inflate(const fxs_scene_source *source, const void *data, size_t size, void *out, size_t wanted,
                fxs_message *message);

#ifdef FXS_WITH_ZLIB
#define ZLIB_CONST
#include <zlib.h>

void fxs_zlib_allocator(z_stream *stream, const fxs_allocator *allocator);
#endif

#endif
