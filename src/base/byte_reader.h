/* Buffered sequential reader of a scene file. Several readers may read one file at the same time. */
#ifndef FXS_BYTE_READER_H
#define FXS_BYTE_READER_H

#include <math.h>
#include <string.h>

#include "source_internal.h"

enum { FXS_BYTE_READER_BUFFER = 1 << 17 };

typedef struct fxs_byte_reader {
    const fxs_scene_source *source;
    const char *fault;          /* reason why the last read or seek failed */
    uint64_t offset;            /* file offset of the end of the buffered bytes */
    size_t begin, end;
    uint8_t buffer[FXS_BYTE_READER_BUFFER];
} fxs_byte_reader;

/* Returns the next `size` bytes of the file, at most FXS_BYTE_READER_BUFFER. The bytes stay valid until the next call.
   Returns null at the end of the file. */
const uint8_t *fxs_bytes_take(fxs_byte_reader *reader, size_t size);

/* Move the reader to another position of the file. Return 0, or FXS_ERR_FILE for a position beyond the end. */
int fxs_bytes_seek(fxs_byte_reader *reader, uint64_t offset);
int fxs_bytes_skip(fxs_byte_reader *reader, uint64_t size);

/* Stores the reason of a failed read for fxs_bytes_fail_row, and returns FXS_ERR_FILE. */
int fxs_bytes_fail(fxs_byte_reader *reader, const char *fault);

/* Writes a message with the stored reason of a failed read and the number of the row, counted from 0. Returns
   FXS_ERR_FILE. */
int fxs_bytes_fail_row(const fxs_byte_reader *reader, const char *rows, uint64_t row, uint64_t count,
                       fxs_message *message);

static inline uint64_t fxs_bytes_tell(const fxs_byte_reader *reader)
{
    return reader->offset - (reader->end - reader->begin);
}

static inline uint16_t fxs_load_u16(const uint8_t *bytes)
{
    return (uint16_t)(bytes[0] | bytes[1] << 8);
}

static inline uint32_t fxs_load_u32(const uint8_t *bytes)
{
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static inline float fxs_half(uint32_t bits)
{
    const int exponent = bits >> 10 & 31, fraction = bits & 1023;
    float value = exponent ? ldexpf((float)(1024 + fraction), exponent - 25) : ldexpf((float)fraction, -24);
    if (exponent == 31)
        value = fraction ? NAN : INFINITY;
    return bits >> 15 & 1 ? -value : value;
}

static inline float fxs_load_float(const uint8_t *bytes)
{
    uint32_t bits = fxs_load_u32(bytes);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

#endif
