/* Checks and writes packed scenes (.fxs files). Four kinds of data have CRC-32 checksums: the file header, the SH
   palette, the level-of-detail tree, and every chunk (256 Gaussians) with its chunk header. */
#include <fixsplat/scene.h>

#include <stdint.h>
#include <string.h>

#include <fixsplat/fixsplat.h>
#include <fixsplat/internal/packed.h>
#include <fixsplat/internal/parts.h>
#include "src/base/output_internal.h"
#include "src/base/try_internal.h"
#include "src/core/codes.h"
#include "fxs_file_internal.h"

static uint32_t header_checksum(const fxs_crc32_table *table, const void *data)
{
    fxs_packed_header blank;
    memcpy(&blank, data, sizeof blank);
    blank.checksum = 0;
    return fxs_crc32(table, 0, &blank, sizeof blank);
}

static const unsigned char *header_of(const fxs_scene *scene, uint32_t i)
{
    return i < scene->chunk_count ? scene->chunks + (size_t)i * sizeof(fxs_chunk)
                                  : scene->node_chunks + (size_t)(i - scene->chunk_count) * sizeof(fxs_chunk);
}

static fxs_chunk chunk_of(const fxs_scene *scene, uint32_t i)
{
    fxs_chunk chunk;
    memcpy(&chunk, header_of(scene, i), sizeof chunk);
    return chunk;
}

static uint32_t chunk_checksum(const fxs_crc32_table *table, const fxs_scene *scene, uint32_t i,
                               const unsigned char *rows)
{
    fxs_chunk blank = chunk_of(scene, i);
    blank.checksum = 0;
    return fxs_crc32(table, fxs_crc32(table, 0, &blank, sizeof blank), rows, scene->chunk_bytes);
}

/* The palette, and the motion of a moving scene, lie between the chunk headers and the rows. */
static const unsigned char *palette_of(const fxs_scene *scene)
{
    return scene->chunks + (size_t)scene->chunk_count * sizeof(fxs_chunk);
}

static size_t palette_bytes(const fxs_scene *scene)
{
    return (size_t)(scene->rows - palette_of(scene));
}

static uint32_t palette_checksum(const fxs_crc32_table *table, const fxs_scene *scene)
{
    return fxs_crc32(table, 0, palette_of(scene), palette_bytes(scene));
}

static size_t node_bytes(const fxs_scene *scene)
{
    return (size_t)(scene->node_chunks - scene->nodes);
}

static fxs_tree_header tree_of(const fxs_scene *scene)
{
    fxs_tree_header tree;
    memcpy(&tree, scene->nodes - sizeof tree, sizeof tree);
    return tree;
}

static uint32_t tree_checksum(const fxs_crc32_table *table, const fxs_scene *scene)
{
    fxs_tree_header blank = tree_of(scene);
    blank.checksum = 0;
    return fxs_crc32(table, fxs_crc32(table, 0, &blank, sizeof blank), scene->nodes, node_bytes(scene));
}

static fxs_tree_header sealed_tree(const fxs_crc32_table *table, const fxs_scene *scene)
{
    fxs_tree_header tree = tree_of(scene);
    tree.checksum = fxs_little_32(tree_checksum(table, scene));
    return tree;
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
    chunk.checksum = fxs_little_32(chunk_checksum(table, scene, i, fxs_rows(scene, i)));
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
    for (uint32_t i = 0; i < fxs_scene_chunks(&scene); i++) {
        const fxs_chunk chunk = sealed_chunk(&table, &scene, i);
        memcpy((unsigned char *)data + (header_of(&scene, i) - (unsigned char *)data), &chunk, sizeof chunk);
    }
    if (scene.nodes) {
        const fxs_tree_header tree = sealed_tree(&table, &scene);
        memcpy((unsigned char *)data + (scene.nodes - (unsigned char *)data) - sizeof tree, &tree, sizeof tree);
    }
    return 0;
}

uint32_t fxs_scene_numbers(const fxs_scene *scene, uint32_t *numbers)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < scene->chunk_count; i++)
        for (uint32_t g = 0; g < FXS_CHUNK && count < scene->count; g++)
            if (!fxs_slot_is_empty(scene, fxs_rows(scene, i), g))
                numbers[count++] = i * FXS_CHUNK + g;
    return count;
}

void fxs_file_seal_heads(const fxs_crc32_table *table, unsigned char *head, size_t palette_bytes, unsigned char *tree,
                         size_t tree_bytes)
{
    fxs_packed_header h;
    memcpy(&h, head, sizeof h);
    const size_t chunks = (size_t)fxs_little_32(h.chunk_count) * sizeof(fxs_chunk);
    h.palette_checksum = fxs_little_32(fxs_crc32(table, 0, head + sizeof h + chunks, palette_bytes));
    h.checksum = fxs_little_32(header_checksum(table, &h));
    memcpy(head, &h, sizeof h);
    if (tree) {
        const uint32_t checksum = fxs_little_32(fxs_crc32(table, 0, tree, tree_bytes));
        memcpy(tree + offsetof(fxs_tree_header, checksum), &checksum, sizeof checksum);
    }
}

static int write_chunks(fxs_output *output, const fxs_crc32_table *table, const fxs_scene *scene, uint32_t first,
                        uint32_t end, fxs_message *message)
{
    int result = 0;
    for (uint32_t i = first; i < end && !result; i++) {
        const fxs_chunk chunk = sealed_chunk(table, scene, i);
        result = fxs_output_write(output, &chunk, sizeof chunk, message);
    }
    return result;
}

static int write_tree(fxs_output *output, const fxs_crc32_table *table, const fxs_scene *scene, fxs_message *message)
{
    const uint32_t leaves = scene->chunk_count, end = fxs_scene_chunks(scene);
    const fxs_tree_header tree = sealed_tree(table, scene);
    FXS_TRY(fxs_output_write(output, &tree, sizeof tree, message));
    FXS_TRY(fxs_output_write(output, scene->nodes, node_bytes(scene), message));
    FXS_TRY(write_chunks(output, table, scene, leaves, end, message));
    return fxs_output_write(output, scene->node_rows, (size_t)(end - leaves) * scene->chunk_bytes, message);
}

static int write_scene(fxs_output *output, const void *data, const fxs_scene *scene, fxs_message *message)
{
    fxs_crc32_table table;
    fxs_crc32_fill(&table);
    const fxs_packed_header header = sealed_header(&table, data, scene);
    FXS_TRY(fxs_output_write(output, &header, sizeof header, message));
    FXS_TRY(write_chunks(output, &table, scene, 0, scene->chunk_count, message));
    if (palette_bytes(scene))
        FXS_TRY(fxs_output_write(output, palette_of(scene), palette_bytes(scene), message));
    FXS_TRY(fxs_output_write(output, scene->rows, (size_t)scene->chunk_count * scene->chunk_bytes, message));
    return scene->nodes ? write_tree(output, &table, scene, message) : 0;
}

int fxs_file_write(const char *path, const void *data, size_t bytes, fxs_message *message)
{
    fxs_scene scene;
    fxs_output output;
    int error = fxs_scene_open(&scene, data, bytes);
    if (error)
        return fxs_fail_as(error, message, "%s: %s", path, fxs_strerror(error));
    FXS_TRY(fxs_output_open(&output, path, 0, message));
    (void)write_scene(&output, data, &scene, message);
    return fxs_output_close(&output, message);
}

static unsigned long long expected_bytes(const void *header)
{
    fxs_scene_parts parts;
    return fxs_scene_find_parts(&parts, header) ? 0 : parts.bytes;
}

int fxs_file_check_header(const char *path, const fxs_crc32_table *table, const void *data, fxs_message *message)
{
    fxs_packed_header header;
    memcpy(&header, data, sizeof header);
    fxs_packed_header_turn(&header);
    if (header.magic != FXS_PACKED_MAGIC)
        return fxs_fail(message, "%s: not an .fxs file", path);
    if (header.version < FXS_PACKED_VERSION || header.version > FXS_PACKED_VERSION_MOTION_TREE)
        return fxs_fail_as(FXS_ERR_VERSION, message, "%s: .fxs of version %u, this program reads %u to %u; convert "
                           "its source again", path, header.version, FXS_PACKED_VERSION,
                           FXS_PACKED_VERSION_MOTION_TREE);
    if (header.checksum != header_checksum(table, data))
        return fxs_fail(message, "%s: the header is damaged: its checksum is wrong", path);
    return 0;
}

int fxs_file_check_heads(const char *path, const fxs_crc32_table *table, const void *head, const fxs_scene *scene,
                         size_t palette, fxs_message *message)
{
    fxs_packed_header header;
    memcpy(&header, head, sizeof header);
    if (fxs_little_32(header.palette_checksum) != fxs_crc32(table, 0, palette_of(scene), palette))
        return fxs_fail(message, "%s: the palette or the motion is damaged: its checksum is wrong", path);
    if (scene->nodes && fxs_little_32(tree_of(scene).checksum) != tree_checksum(table, scene))
        return fxs_fail(message, "%s: the tree is damaged: its checksum is wrong", path);
    return 0;
}

int fxs_file_check_chunk(const char *path, const fxs_crc32_table *table, const fxs_scene *scene, uint32_t i,
                         const unsigned char *rows, fxs_message *message)
{
    if (fxs_little_32(chunk_of(scene, i).checksum) != chunk_checksum(table, scene, i, rows))
        return fxs_fail(message, "%s: chunk %u of %u is damaged: its checksum is wrong", path, i,
                        fxs_scene_chunks(scene));
    return 0;
}

int fxs_file_check(const char *path, const void *data, size_t bytes, int all, fxs_message *message)
{
    fxs_crc32_table table;
    fxs_scene scene;
    fxs_crc32_fill(&table);
    if (bytes < sizeof(fxs_packed_header))
        return fxs_fail(message, "%s: not an .fxs file", path);
    FXS_TRY(fxs_file_check_header(path, &table, data, message));
    if (fxs_scene_open(&scene, data, bytes))
        return fxs_fail(message, "%s: damaged or cut short: %zu bytes, expected %llu", path, bytes,
                        expected_bytes(data));
    if (all)
        FXS_TRY(fxs_file_check_heads(path, &table, data, &scene, palette_bytes(&scene), message));
    for (uint32_t i = 0; i < fxs_scene_chunks(&scene) && all; i++)
        FXS_TRY(fxs_file_check_chunk(path, &table, &scene, i, fxs_rows(&scene, i), message));
    return 0;
}
