#include "fxs_file.h"

#include <stdint.h>
#include <string.h>

#include "../../src/fixsplat.h"
#include "../../src/packed.h"
#include "output_internal.h"

#ifdef FXS_WITH_ZLIB
#include <zlib.h>

static uint32_t header_checksum(const fxs_packed_header *header)
{
    fxs_packed_header blank = *header;
    blank.checksum[0] = 0;
    return (uint32_t)crc32(0, (const unsigned char *)&blank, sizeof blank);
}

static uint32_t chunk_checksum(const fxs_chunk *chunk, uint32_t chunk_bytes)
{
    fxs_chunk blank = *chunk;
    blank.checksum = 0;
    uLong crc = crc32(0, (const unsigned char *)&blank, sizeof blank);
    return (uint32_t)crc32(crc, (const unsigned char *)(chunk + 1), chunk_bytes - (uInt)sizeof blank);
}

/* Errors stay in the output. */
static void write_scene(fxs_output *output, const unsigned char *data, fxs_message *message)
{
    fxs_packed_header header;
    memcpy(&header, data, sizeof header);
    header.checksum[0] = header_checksum(&header);
    int result = fxs_output_write(output, &header, sizeof header, message);
    for (uint32_t i = 0; i < header.chunk_count && !result; i++) {
        const void *at = data + sizeof header + (size_t)i * header.chunk_bytes;
        const fxs_chunk *from = at;
        fxs_chunk chunk = *from;
        chunk.checksum = chunk_checksum(from, header.chunk_bytes);
        result = fxs_output_write(output, &chunk, sizeof chunk, message) ||
                 fxs_output_write(output, from + 1, header.chunk_bytes - sizeof chunk, message);
    }
}

int fxs_file_write(const char *path, const void *data, size_t bytes, fxs_message *message)
{
    fxs_scene scene;
    fxs_output output;
    int error = fxs_scene_open(&scene, data, bytes);
    if (error)
        return fxs_fail(message, "%s: %s", path, fxs_strerror(error));
    if (fxs_output_open(&output, path, 0, message))
        return -1;
    write_scene(&output, data, message);
    return fxs_output_close(&output, message);
}

int fxs_file_check(const char *path, const void *data, size_t bytes, int all, fxs_message *message)
{
    const fxs_packed_header *header = data;
    fxs_scene scene;
    if (bytes < sizeof *header || header->magic != FXS_PACKED_MAGIC)
        return fxs_fail(message, "%s: not an .fxs file", path);
    if (header->version != FXS_PACKED_VERSION)
        return fxs_fail(message, "%s: .fxs of version %u, this program reads %u", path, header->version,
                        FXS_PACKED_VERSION);
    if (header->checksum[0] != header_checksum(header))
        return fxs_fail(message, "%s: the header is damaged: its checksum is wrong", path);
    if (fxs_scene_open(&scene, data, bytes))
        return fxs_fail(message, "%s: damaged or cut short: %zu bytes, expected %zu", path, bytes,
                        fxs_scene_bytes(header->count, (int)(header->sh_degree & 3)));
    for (uint32_t i = 0; i < scene.chunk_count && all; i++) {
        const void *chunk = scene.chunks + (size_t)i * scene.chunk_bytes;
        if (((const fxs_chunk *)chunk)->checksum != chunk_checksum(chunk, scene.chunk_bytes))
            return fxs_fail(message, "%s: chunk %u of %u is damaged: its checksum is wrong", path, i,
                            scene.chunk_count);
    }
    return 0;
}
#else
int fxs_file_write(const char *path, const void *data, size_t bytes, fxs_message *message)
{
    (void)data;
    (void)bytes;
    return fxs_fail(message, "%s: this program was built without zlib, which .fxs needs", path);
}

int fxs_file_check(const char *path, const void *data, size_t bytes, int all, fxs_message *message)
{
    (void)all;
    return fxs_file_write(path, data, bytes, message);
}
#endif
