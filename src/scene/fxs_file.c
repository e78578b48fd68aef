#include <fixsplat/fxs_file.h>

#include <stdint.h>
#include <string.h>

#include <fixsplat/fixsplat.h>
#include <fixsplat/packed.h>
#include "src/base/crc32.h"
#include "src/base/output_internal.h"
#include "src/core/codes.h"

/* The checksum of the header at `data`, with its field for the checksum 0. */
static uint32_t header_checksum(const fxs_crc32_table *table, const void *data)
{
    fxs_packed_header blank;
    memcpy(&blank, data, sizeof blank);
    blank.checksum = 0;
    return fxs_crc32(table, 0, &blank, sizeof blank);
}

static const unsigned char *rows_of(const fxs_scene *scene, uint32_t i)
{
    return scene->rows + (size_t)i * scene->chunk_bytes;
}

/* The header of a chunk in the byte order of the scene. */
static fxs_chunk chunk_of(const fxs_scene *scene, uint32_t i)
{
    fxs_chunk chunk;
    memcpy(&chunk, scene->chunks + (size_t)i * sizeof chunk, sizeof chunk);
    return chunk;
}

static uint32_t chunk_checksum(const fxs_crc32_table *table, const fxs_scene *scene, uint32_t i)
{
    fxs_chunk blank = chunk_of(scene, i);
    blank.checksum = 0;
    return fxs_crc32(table, fxs_crc32(table, 0, &blank, sizeof blank), rows_of(scene, i), scene->chunk_bytes);
}

static size_t palette_bytes(const fxs_scene *scene)
{
    return scene->palette ? (size_t)(scene->rows - (const unsigned char *)scene->palette) : 0;
}

static uint32_t palette_checksum(const fxs_crc32_table *table, const fxs_scene *scene)
{
    return fxs_crc32(table, 0, scene->palette, palette_bytes(scene));
}

static fxs_packed_header sealed_header(const fxs_crc32_table *table, const void *data, const fxs_scene *scene)
{
    fxs_packed_header header;
    memcpy(&header, data, sizeof header);
    header.palette_checksum = fxs_little_32(palette_checksum(table, scene));
    header.checksum = fxs_little_32(header_checksum(table, &header));
    return header;
}

static fxs_chunk sealed_chunk(const fxs_crc32_table *table, const fxs_scene *scene, uint32_t i)
{
    fxs_chunk chunk = chunk_of(scene, i);
    chunk.checksum = fxs_little_32(chunk_checksum(table, scene, i));
    return chunk;
}

int fxs_file_seal(void *data, size_t bytes)
{
    fxs_crc32_table table;
    fxs_scene scene;
    const int error = fxs_scene_open(&scene, data, bytes);
    if (error)
        return error;
    fxs_crc32_fill(&table);
    const fxs_packed_header header = sealed_header(&table, data, &scene);
    memcpy(data, &header, sizeof header);
    unsigned char *chunks = (unsigned char *)data + sizeof header;
    for (uint32_t i = 0; i < scene.chunk_count; i++) {
        const fxs_chunk chunk = sealed_chunk(&table, &scene, i);
        memcpy(chunks + (size_t)i * sizeof chunk, &chunk, sizeof chunk);
    }
    return 0;
}

uint32_t fxs_scene_numbers(const fxs_scene *scene, uint32_t *numbers)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < scene->chunk_count; i++)
        for (uint32_t g = 0; g < FXS_CHUNK && count < scene->count; g++)
            if (fxs_codes_of(scene, rows_of(scene, i), g).rotation)
                numbers[count++] = i * FXS_CHUNK + g;
    return count;
}

/* Errors stay in the output. */
static void write_scene(fxs_output *output, const void *data, const fxs_scene *scene, fxs_message *message)
{
    fxs_crc32_table table;
    fxs_crc32_fill(&table);
    const fxs_packed_header header = sealed_header(&table, data, scene);
    int result = fxs_output_write(output, &header, sizeof header, message);
    for (uint32_t i = 0; i < scene->chunk_count && !result; i++) {
        const fxs_chunk chunk = sealed_chunk(&table, scene, i);
        result = fxs_output_write(output, &chunk, sizeof chunk, message);
    }
    if (!result && scene->palette)
        result = fxs_output_write(output, scene->palette, palette_bytes(scene), message);
    if (!result)
        fxs_output_write(output, scene->rows, (size_t)scene->chunk_count * scene->chunk_bytes, message);
}

int fxs_file_write(const char *path, const void *data, size_t bytes, fxs_message *message)
{
    fxs_scene scene;
    fxs_output output;
    int error = fxs_scene_open(&scene, data, bytes);
    if (error)
        return fxs_fail_as(error, message, "%s: %s", path, fxs_strerror(error));
    FXS_TRY(fxs_output_open(&output, path, 0, message));
    write_scene(&output, data, &scene, message);
    return fxs_output_close(&output, message);
}

int fxs_file_check(const char *path, const void *data, size_t bytes, int all, fxs_message *message)
{
    fxs_packed_header header;
    fxs_crc32_table table;
    fxs_scene scene;
    fxs_crc32_fill(&table);
    if (bytes < sizeof header)
        return fxs_fail(message, "%s: not an .fxs file", path);
    memcpy(&header, data, sizeof header);
    fxs_packed_header_turn(&header);
    if (header.magic != FXS_PACKED_MAGIC)
        return fxs_fail(message, "%s: not an .fxs file", path);
    if (header.version != FXS_PACKED_VERSION)
        return fxs_fail_as(FXS_ERR_VERSION, message, "%s: .fxs of version %u, this program reads %u; convert its "
                           "source again", path, header.version, FXS_PACKED_VERSION);
    if (header.checksum != header_checksum(&table, data))
        return fxs_fail(message, "%s: the header is damaged: its checksum is wrong", path);
    if (fxs_scene_open(&scene, data, bytes))
        return fxs_fail(message, "%s: damaged or cut short: %zu bytes, expected %zu", path, bytes,
                        fxs_scene_bytes(header.count, (int)(header.sh_degree & 3),
                                        (enum fxs_profile)header.profile, header.palette_entries));
    if (all && header.palette_checksum != palette_checksum(&table, &scene))
        return fxs_fail(message, "%s: the palette is damaged: its checksum is wrong", path);
    for (uint32_t i = 0; i < scene.chunk_count && all; i++)
        if (fxs_little_32(chunk_of(&scene, i).checksum) != chunk_checksum(&table, &scene, i))
            return fxs_fail(message, "%s: chunk %u of %u is damaged: its checksum is wrong", path, i,
                            scene.chunk_count);
    return 0;
}
