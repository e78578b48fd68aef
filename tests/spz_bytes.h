/* Builds .spz files from given codes. */
#ifndef SPZ_BYTES_H
#define SPZ_BYTES_H

#include <stdint.h>
#include <string.h>

#ifdef FXS_WITH_ZLIB
#include <zlib.h>
#endif
#ifdef FXS_WITH_ZSTD
#include <zstd.h>
#endif

enum { SPZ_ARRAYS = 6 };

typedef struct spz_bytes {
    int version, count, degree, fractional_bits, flags;
    const uint8_t *extensions;
    size_t extensions_size;
    /* arrays of the .spz in file order: positions, alphas, colours, scales, rotations, SH */
    uint8_t arrays[SPZ_ARRAYS][1 << 10];
} spz_bytes;

static inline size_t spz_array_size(const spz_bytes *s, int array)
{
    const int stride[SPZ_ARRAYS] = {s->version == 1 ? 6 : 9, 1, 3, 3, s->version < 3 ? 3 : 4,
                                    3 * s->degree * (s->degree + 2)};
    return (size_t)(s->count * stride[array]);
}

static inline uint8_t *spz_put(uint8_t *to, uint64_t value, int length)
{
    for (int i = 0; i < length; i++)
        *to++ = (uint8_t)(i < 8 ? value >> 8 * i : 0);
    return to;
}

static inline uint8_t *spz_put_header(const spz_bytes *s, uint8_t *to)
{
    to = spz_put(to, 0x5053474e, 4);
    to = spz_put(to, (uint64_t)s->version, 4);
    to = spz_put(to, (uint64_t)s->count, 4);
    *to++ = (uint8_t)s->degree;
    *to++ = (uint8_t)s->fractional_bits;
    *to++ = (uint8_t)s->flags;
    *to++ = 0;
    return to;
}

static inline size_t spz_plain(const spz_bytes *s, uint8_t *out)
{
    uint8_t *to = spz_put_header(s, out);
    for (int i = 0; i < SPZ_ARRAYS; i++) {
        memcpy(to, s->arrays[i], spz_array_size(s, i));
        to += spz_array_size(s, i);
    }
    if (s->extensions_size)
        memcpy(to, s->extensions, s->extensions_size);
    return (size_t)(to - out) + s->extensions_size;
}

#ifdef FXS_WITH_ZLIB
static inline size_t spz_gzip(const uint8_t *data, size_t length, uint8_t *out, size_t room)
{
    z_stream z;
    memset(&z, 0, sizeof z);
    deflateInit2(&z, 9, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
    z.next_in = (uint8_t *)(uintptr_t)data;
    z.avail_in = (uInt)length;
    z.next_out = out;
    z.avail_out = (uInt)room;
    deflate(&z, Z_FINISH);
    deflateEnd(&z);
    return room - z.avail_out;
}
#endif

#ifdef FXS_WITH_ZSTD
static inline size_t spz_zstd(const spz_bytes *s, uint8_t *out, size_t room)
{
    int streams = 0;
    for (int i = 0; i < SPZ_ARRAYS; i++)
        streams += spz_array_size(s, i) > 0;
    uint8_t *to = spz_put_header(s, out);
    to[-1] = (uint8_t)streams;
    to = spz_put(to, 32 + s->extensions_size, 4);
    memset(to, 0, 12);
    if (s->extensions_size)
        memcpy(to + 12, s->extensions, s->extensions_size);
    uint8_t *entry = to + 12 + s->extensions_size;
    to = entry + 16 * streams;
    for (int i = 0; i < SPZ_ARRAYS; i++) {
        size_t length = spz_array_size(s, i);
        if (length == 0)
            continue;
        size_t compressed = ZSTD_compress(to, room - (size_t)(to - out), s->arrays[i], length, 9);
        entry = spz_put(spz_put(entry, compressed, 8), length, 8);
        to += compressed;
    }
    return (size_t)(to - out);
}
#endif

#endif
