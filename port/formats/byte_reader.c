#include "byte_reader.h"

int fxs_bytes_fail(fxs_byte_reader *reader, const char *fault)
{
    reader->fault = fault;
    return -1;
}

int fxs_bytes_fail_row(const fxs_byte_reader *reader, const char *rows, uint64_t row, uint64_t count,
                       fxs_message *message)
{
    return fxs_fail(message, "%s: %s %llu of %llu: %s", reader->source->path, rows, (unsigned long long)row + 1,
                    (unsigned long long)count, reader->fault);
}

static void fill(fxs_byte_reader *reader)
{
    FILE *stream = reader->source->stream;
    reader->end -= reader->begin;
    memmove(reader->buffer, reader->buffer + reader->begin, reader->end);
    reader->begin = 0;
    if (fseeko(stream, (off_t)reader->offset, SEEK_SET) != 0)
        return;
    size_t got = fread(reader->buffer + reader->end, 1, FXS_BYTE_READER_BUFFER - reader->end, stream);
    reader->end += got;
    reader->offset += got;
}

const uint8_t *fxs_bytes_take(fxs_byte_reader *reader, size_t size)
{
    if (reader->end - reader->begin < size)
        fill(reader);
    if (reader->end - reader->begin < size) {
        fxs_bytes_fail(reader, ferror(reader->source->stream) ? "read error" : "the file ends early");
        return NULL;
    }
    reader->begin += size;
    return reader->buffer + reader->begin - size;
}

int fxs_bytes_seek(fxs_byte_reader *reader, uint64_t offset)
{
    if (offset > reader->source->size)
        return fxs_bytes_fail(reader, "the file ends early");
    reader->offset = offset;
    reader->begin = reader->end = 0;
    return 0;
}

int fxs_bytes_skip(fxs_byte_reader *reader, uint64_t size)
{
    if (size > reader->end - reader->begin)
        return fxs_bytes_seek(reader, fxs_bytes_tell(reader) + size);
    reader->begin += (size_t)size;
    return 0;
}
