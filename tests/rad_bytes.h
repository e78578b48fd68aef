/* Builds .rad files from given columns of numbers. */
#ifndef RAD_BYTES_H
#define RAD_BYTES_H

#include "scene_bytes.h"
#ifdef FXS_WITH_ZLIB
#include <zlib.h>
#endif

enum { RAD_COLUMNS = 16, RAD_CHUNKS = 8, RAD_COLUMN_ROOM = 1 << 15 };

static struct rad_column {
    const char *property, *encoding;
    const char *more;   /* text of further JSON members for the column's description, such as ",\"min\":0" */
    uint8_t bytes[RAD_COLUMN_ROOM];
    size_t size;
} rad_columns[RAD_COLUMNS];
static int rad_column_count, rad_compressed;
static uint8_t rad_body[1 << 16];
static size_t rad_body_size, rad_sizes[RAD_CHUNKS];
static int rad_chunk_count;

static inline void rad_begin(int compressed)
{
    rad_body_size = size = 0;
    rad_chunk_count = rad_column_count = 0;
    rad_compressed = compressed;
}

/* Makes a column of all bytes that were written since the previous column. */
static inline void rad_add_column(const char *property, const char *encoding, const char *more)
{
    struct rad_column *c = &rad_columns[rad_column_count++];
    c->property = property;
    c->encoding = encoding;
    c->more = more;
    c->size = size;
    memcpy(c->bytes, bytes, size);
    size = 0;
#ifdef FXS_WITH_ZLIB
    z_stream stream;
    memset(&stream, 0, sizeof stream);
    if (rad_compressed && CHECK(deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 9, Z_DEFAULT_STRATEGY) == Z_OK)) {
        static uint8_t packed[RAD_COLUMN_ROOM];
        stream.next_in = c->bytes;
        stream.avail_in = (uInt)c->size;
        stream.next_out = packed;
        stream.avail_out = sizeof packed;
        CHECK(deflate(&stream, Z_FINISH) == Z_STREAM_END);
        c->size = sizeof packed - stream.avail_out;
        memcpy(c->bytes, packed, c->size);
        deflateEnd(&stream);
    }
#endif
}

static inline void rad_pad(void)
{
    while (size % 8)
        put_u8(0);
}

static inline void rad_add_chunk(int base, int count)
{
    size_t payload = 0;
    for (int i = 0; i < rad_column_count; i++)
        payload += (rad_columns[i].size + 7) / 8 * 8;
    put("RADC....{\"version\":1,\"base\":%d,\"count\":%d,\"payloadBytes\":%zu,\"properties\":[", base, count, payload);
    for (size_t i = 0, at = 0; i < (size_t)rad_column_count; at += (rad_columns[i++].size + 7) / 8 * 8)
        put("%s{\"offset\":%zu,\"bytes\":%zu,\"property\":\"%s\",\"encoding\":\"%s\"%s%s}", i ? "," : "", at,
            rad_columns[i].size, rad_columns[i].property, rad_columns[i].encoding,
            rad_compressed ? ",\"compression\":\"gz\"" : "", rad_columns[i].more);
    put("]}");
    put_u32_at(4, (uint32_t)size - 8);
    rad_pad();
    put_u32((uint32_t)payload);
    put_u32(0);
    for (int i = 0; i < rad_column_count; i++) {
        memcpy(bytes + size, rad_columns[i].bytes, rad_columns[i].size);
        size += rad_columns[i].size;
        rad_pad();
    }
    memcpy(rad_body + rad_body_size, bytes, size);
    rad_sizes[rad_chunk_count++] = size;
    rad_body_size += size;
    rad_column_count = 0;
    size = 0;
}

/* Puts the whole .rad into `bytes`. more: further JSON members of the header, such as ",\"maxSh\":1". */
static inline void rad_end(int count, int chunk_size, const char *more)
{
    put("RAD0....{\"version\":1,\"type\":\"gsplat\",\"count\":%d,\"chunkSize\":%d,\"allChunkBytes\":%zu%s,\"chunks\":[",
        count, chunk_size, rad_body_size, more);
    for (size_t i = 0, at = 0; i < (size_t)rad_chunk_count; at += rad_sizes[i++])
        put("%s{\"offset\":%zu,\"bytes\":%zu}", i ? "," : "", at, rad_sizes[i]);
    put("]}");
    put_u32_at(4, (uint32_t)size - 8);
    rad_pad();
    memcpy(bytes + size, rad_body, rad_body_size);
    size += rad_body_size;
}

#endif
