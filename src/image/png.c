#include "png_internal.h"

#include <string.h>

#ifdef FXS_WITH_ZLIB
#include <zlib.h>
#ifdef FXS_WITH_DEFLATE
#include <libdeflate.h>
#endif

#ifdef FXS_WITH_DEFLATE
enum { LEVEL = 1 };

static size_t bound_of(size_t size)
{
    return libdeflate_zlib_compress_bound(NULL, size);
}

static size_t compress_rows(uint8_t *out, size_t room, const uint8_t *rows, size_t size)
{
    struct libdeflate_compressor *compressor = libdeflate_alloc_compressor(LEVEL);
    const size_t bytes = compressor ? libdeflate_zlib_compress(compressor, rows, size, out, room) : 0;
    libdeflate_free_compressor(compressor);
    return bytes;
}
#else
static size_t bound_of(size_t size)
{
    return compressBound((uLong)size);
}

static size_t compress_rows(uint8_t *out, size_t room, const uint8_t *rows, size_t size)
{
    z_stream stream;
    memset(&stream, 0, sizeof stream);
    if (deflateInit2(&stream, 1, Z_DEFLATED, MAX_WBITS, 9, Z_RLE) != Z_OK)
        return 0;
    stream.next_in = (Bytef *)(uintptr_t)rows;
    stream.avail_in = (uInt)size;
    stream.next_out = out;
    stream.avail_out = (uInt)room;
    const int ended = deflate(&stream, Z_FINISH);
    const size_t bytes = stream.total_out;
    deflateEnd(&stream);
    return ended == Z_STREAM_END ? bytes : 0;
}
#endif

/* PNG filters: the first row of a picture has filter 0 (none), the other rows 2 (difference from the row above). */

/* Subtracts four bytes at once: each byte of b from the same byte of a. The upper bit of each byte catches the
   borrow. */
static inline uint32_t minus_bytes(uint32_t a, uint32_t b)
{
    return ((a | 0x80808080u) - (b & 0x7f7f7f7fu)) ^ ((a ^ ~b) & 0x80808080u);
}

/* Filters the rows of a picture for a .png, keeping the first `used` bytes of each pixel. It writes four bytes; the
   next pixel overwrites the rest. */
static inline void filter_colours(uint8_t *out, const uint8_t *rgba, size_t width, size_t height, size_t used)
{
    for (size_t y = 0; y < height; y++) {
        const uint8_t *in = rgba + 4 * width * y;
        *out++ = y ? 2 : 0;
        for (const uint8_t *end = in + 4 * width; in < end; in += 4, out += used) {
            uint32_t pixel, above = 0;
            memcpy(&pixel, in, 4);
            if (y)
                memcpy(&above, in - 4 * width, 4);
            pixel = minus_bytes(pixel, above);
            memcpy(out, &pixel, 4);
        }
    }
}

static void filter_greys(uint8_t *out, const uint8_t *greys, size_t width, size_t height)
{
    const size_t row = 2 * width;
    for (size_t y = 0; y < height; y++) {
        *out++ = y ? 2 : 0;
        for (const uint8_t *in = greys + row * y, *end = in + row; in < end; in++)
            *out++ = (uint8_t)(y ? *in - in[-(ptrdiff_t)row] : *in);
    }
}

static size_t used_bytes(int kind)
{
    return kind == FXS_PNG_GREY_16 ? 2 : kind == FXS_PNG_RGB ? 3 : 4;
}

static void filter(uint8_t *out, int kind, const uint8_t *pixels, int width, int height)
{
    const size_t w = (size_t)width, h = (size_t)height;
    if (kind == FXS_PNG_GREY_16)
        filter_greys(out, pixels, w, h);
    else if (kind == FXS_PNG_RGB)
        filter_colours(out, pixels, w, h, 3);
    else
        filter_colours(out, pixels, w, h, 4);
}

enum { AROUND_DATA = 8 + 25 + 12 + 12 };

static uint8_t *put_32(uint8_t *out, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        *out++ = (uint8_t)(value >> (24 - 8 * i));
    return out;
}

/* Completes a PNG chunk around its data at out + 8: adds length, type and checksum. */
static uint8_t *put_chunk(uint8_t *out, const char *type, size_t length)
{
    put_32(out, (uint32_t)length);
    memcpy(out + 4, type, 4);
    return put_32(out + 8 + length, (uint32_t)crc32(0, out + 4, (uInt)length + 4));
}

static uint8_t *put_header(uint8_t *out, int kind, int width, int height)
{
    static const uint8_t signature[8] = {137, 'P', 'N', 'G', 13, 10, 26, 10};
    const uint8_t form[5] = {(uint8_t)(kind >> 8), (uint8_t)kind, 0, 0, 0};
    memcpy(out, signature, sizeof signature);
    out += sizeof signature;
    put_32(put_32(out + 8, (uint32_t)width), (uint32_t)height);
    memcpy(out + 16, form, sizeof form);
    return put_chunk(out, "IHDR", 13);
}

int fxs_png_encode(int kind, const uint8_t *pixels, int width, int height, fxs_encoded *png)
{
    const size_t size = (used_bytes(kind) * (size_t)width + 1) * (size_t)height, room = bound_of(size);
    uint8_t *bytes = fxs_encoded_room(png, AROUND_DATA + room + size + 1), *rows = bytes + AROUND_DATA + room;
    if (!bytes)
        return FXS_ERR_MEMORY;
    filter(rows, kind, pixels, width, height);
    uint8_t *out = put_header(bytes, kind, width, height);
    const size_t compressed = compress_rows(out + 8, room, rows, size);
    out = put_chunk(put_chunk(out, "IDAT", compressed), "IEND", 0);
    png->bytes = bytes;
    png->size = (size_t)(out - bytes);
    return compressed ? 0 : FXS_ERR_MEMORY;
}
#else
int fxs_png_encode(int kind, const uint8_t *pixels, int width, int height, fxs_encoded *png)
{
    (void)kind, (void)pixels, (void)width, (void)height, (void)png;
    return FXS_ERR_UNSUPPORTED;
}
#endif
