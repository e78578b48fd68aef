#include <fixsplat/internal/allocator.h>

#include "inflate_internal.h"

#include <string.h>

#ifdef FXS_WITH_ZLIB

static void *allocate(void *allocator, uInt count, uInt size)
{
    return fxs_allocate(allocator, count, size);
}

static void release(void *allocator, void *block)
{
    fxs_release(allocator, block);
}

void fxs_zlib_allocator(z_stream *stream, const fxs_allocator *allocator)
{
    stream->zalloc = allocate;
    stream->zfree = release;
    stream->opaque = (void *)(uintptr_t)allocator;
}

/* Decompresses zlib data in pieces, because zlib counts bytes in 32 bits. Returns zlib's status. */
static int inflate_all(z_stream *stream, const Bytef *data, size_t size, Bytef *out, size_t wanted)
{
    const size_t piece = 1u << 30;
    int status = Z_OK;
    while (status == Z_OK) {
        const size_t in = size < piece ? size : piece, room = wanted < piece ? wanted : piece;
        stream->next_in = data;
        stream->avail_in = (uInt)in;
        stream->next_out = out;
        stream->avail_out = (uInt)room;
        status = inflate(stream, Z_NO_FLUSH);
        data += in - stream->avail_in;
        size -= in - stream->avail_in;
        out += room - stream->avail_out;
        wanted -= room - stream->avail_out;
    }
    return status == Z_STREAM_END && wanted > 0 ? Z_DATA_ERROR : status;
}

int fxs_inflate(const fxs_scene_source *source, const void *data, size_t size, void *out, size_t wanted,
                fxs_message *message)
{
    z_stream stream;
    memset(&stream, 0, sizeof stream);
    fxs_zlib_allocator(&stream, source->options.allocator);
    int status = inflateInit2(&stream, -MAX_WBITS);
    if (status == Z_OK) {
        status = inflate_all(&stream, data, size, out, wanted);
        inflateEnd(&stream);
    }
    return status == Z_STREAM_END ? 0
           : status == Z_MEM_ERROR ? fxs_fail_memory(message, source->path, 0)
                                   : fxs_fail(message, "%s: compressed data that are damaged, or not %zu bytes",
                                              source->path, wanted);
}

#else

int fxs_inflate(const fxs_scene_source *source, const void *data, size_t size, void *out, size_t wanted,
                fxs_message *message)
{
    (void)data, (void)size, (void)out, (void)wanted;
    return fxs_fail_as(FXS_ERR_UNSUPPORTED, message, "%s: cannot inflate: built without zlib", source->path);
}

#endif
