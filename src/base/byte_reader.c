#include "byte_reader.h"

int fxs_bytes_fail(fxs_byte_reader *reader, const char *fault)
{
    reader->fault = fault;
    return FXS_ERR_FILE;
}

int fxs_bytes_fail_row(const fxs_byte_reader *reader, const char *rows, uint64_t row, uint64_t count,
                       fxs_message *message)
{
    return fxs_fail(message, "%s: %s %llu of %llu: %s", reader->source->path, rows, (unsigned long long)row + 1,
                    (unsigned long long)count, reader->fault);
}

static int fill(fxs_byte_reader *reader)
{
    const fxs_scene_input *input = &reader->source->input;
    reader->end -= reader->begin;
    memmove(reader->buffer, reader->buffer + reader->begin, reader->end);
    reader->begin = 0;
    uint64_t left = input->size - reader->offset;
    size_t room = FXS_BYTE_READER_BUFFER - reader->end, wanted = left < room ? (size_t)left : room;
    if (wanted > 0 && input->read(input->argument, reader->offset, reader->buffer + reader->end, wanted) != 0)
        return fxs_bytes_fail(reader, "read error");
    reader->end += wanted;
    reader->offset += wanted;
    return 0;
}

const uint8_t *fxs_bytes_take(fxs_byte_reader *reader, size_t size)
{
    if (reader->end - reader->begin < size && fill(reader) != 0)
        return NULL;
    if (reader->end - reader->begin < size) {
        fxs_bytes_fail(reader, "the file ends early");
        return NULL;
    }
    reader->begin += size;
    return reader->buffer + reader->begin - size;
}

int fxs_bytes_seek(fxs_byte_reader *reader, uint64_t offset)
{
    if (offset > reader->source->input.size)
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
