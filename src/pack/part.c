/* Computes the layout of a part file (a scene's part, packed separately) from its two headers. Checks that the two
 * headers agree. See part.h. */
#include <fixsplat/internal/parts.h>

#include "part.h"

#include <string.h>

static uint64_t padded(uint64_t bytes)
{
    return (bytes + 63) / 64 * 64;
}

int fxs_part_lay_out(fxs_part_layout *l, const fxs_part_header *part, const fxs_packed_header *scene)
{
    fxs_packed_header little = *scene;
    fxs_scene_parts whole;
    fxs_packed_header_turn(&little);
    if (fxs_scene_find_parts(&whole, &little) || part->magic != FXS_PART_MAGIC || part->count < 1 ||
        part->count > FXS_PARTS_MOST || part->count > scene->chunk_count || part->number < 1 ||
        part->number > part->count)
        return FXS_ERR_FILE;
    const uint32_t first = fxs_part_first(scene->chunk_count, part->number, part->count);
    const uint32_t chunks = fxs_part_first(scene->chunk_count, part->number + 1, part->count) - first;
    const int has_tree = fxs_version_has_tree(scene->version);
    if (part->first != first || part->chunk_count != chunks || part->node_count >= chunks + !has_tree ||
        (!has_tree && part->node_count) || part->top_count > part->node_count)
        return FXS_ERR_FILE;
    const uint64_t stages = fxs_palette_stages((enum fxs_profile)scene->profile, (int)scene->sh_degree);
    l->scene = sizeof *part;
    l->chunks = l->scene + sizeof *scene;
    l->palette = l->chunks + (uint64_t)chunks * sizeof(fxs_chunk);
    l->groups = l->palette + padded(stages * scene->palette_entries * FXS_PALETTE_STRIDE);
    l->rows = l->groups + stages * FXS_PALETTE_GROUPS * sizeof(fxs_sh_vector);
    l->sums = l->rows + (uint64_t)chunks * scene->chunk_bytes;
    l->node_chunks = l->sums + padded((uint64_t)part->node_count * sizeof(fxs_node_sums));
    l->node_rows = l->node_chunks + (uint64_t)part->node_count * sizeof(fxs_chunk);
    l->tops = l->node_rows + (uint64_t)part->node_count * scene->chunk_bytes;
    l->bytes = l->tops + (uint64_t)part->top_count * FXS_TREE_TOP_BYTES;
    return 0;
}

uint32_t fxs_part_first(uint32_t chunks, uint32_t number, uint32_t count)
{
    return (uint32_t)((uint64_t)chunks * (number - 1) / count);
}

uint32_t fxs_part_add_box(const fxs_crc32_table *table, uint32_t checksum, const float box[6])
{
    float little[6];
    memcpy(little, box, sizeof little);
    fxs_little_endian(little, 0, 6, sizeof *little);
    return fxs_crc32(table, checksum, little, sizeof little);
}
