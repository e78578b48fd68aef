/* A part file holds a run of consecutive chunks of a scene, packed separately. A chunk is 256 Gaussians. Merging all
 * parts gives the same bytes as packing the scene at once.
 *
 * All numbers are little-endian. Each section begins at a multiple of 64 bytes:
 *
 *   fxs_part_header
 *   fxs_packed_header                  of the whole scene, without checksums
 *   fxs_chunk[chunk_count]
 *   int8_t palette[stages][entries][48], int16_t groups[stages][16][48]   the palette, and the middles of its groups
 *   rows[chunk_count]
 *
 * If the scene has a level-of-detail tree, these sections follow. They hold the nodes with all leaves in the run, in
 * ascending order of node number:
 *
 *   fxs_node_sums[node_count]
 *   fxs_chunk[node_count]
 *   rows[node_count]
 * top[top_count] FXS_TREE_TOP_BYTES each: nodes with a parent that also has leaves of other parts
 *
 * A part is an intermediate file: only the program version that wrote it can merge it. */
#ifndef FXS_PART_H
#define FXS_PART_H

#include <fixsplat/pack.h>
#include <fixsplat/internal/packed.h>
#include "src/base/crc32.h"
#include "tree.h"

#define FXS_PART_MAGIC 0x50535846u        /* "FXSP" as little-endian ASCII */
#define FXS_PART_VERSION 1u
#define FXS_PARTS_MOST 512

typedef struct fxs_part_header {
    uint32_t magic, version;
    uint32_t program;
    uint32_t number, count;
    uint32_t first, chunk_count;
    uint32_t node_count, top_count;
    uint32_t source[2];                   /* hash of all Gaussians of the source file, in file order */
    uint32_t boxes;                       /* CRC-32 of the boxes of all chunks of the scene, as little-endian floats */
    int32_t unit_exponent, centred;
    uint32_t head_checksum;               /* CRC-32 of all bytes before the rows, with both header checksums 0 */
    uint32_t tree_checksum;               /* CRC-32 of the node sums, node headers and topmost nodes */
} fxs_part_header;

typedef char fxs_part_header_is_64[sizeof(fxs_part_header) == 64 ? 1 : -1];

static inline void fxs_part_header_turn(fxs_part_header *header)
{
    fxs_little_endian(header, 0, sizeof *header / 4, 4);
}

typedef struct fxs_part_layout {
    uint64_t scene, chunks, palette, groups, rows, sums, node_chunks, node_rows, tops, bytes;
} fxs_part_layout;

/* Computes the layout of a part file from its two headers in native byte order. Returns 0, or FXS_ERR_FILE if a header
   is invalid or the headers disagree. */
int fxs_part_lay_out(fxs_part_layout *layout, const fxs_part_header *part, const fxs_packed_header *scene);

/* Returns the first chunk of part `number`, 1..count, when `chunks` chunks are divided into `count` parts. For number =
   count + 1, returns the number of chunks. */
uint32_t fxs_part_first(uint32_t chunks, uint32_t number, uint32_t count);

/* Continues a CRC-32 over the bounding boxes of chunks with one more box. Returns the new checksum. */
uint32_t fxs_part_add_box(const fxs_crc32_table *table, uint32_t checksum, const float box[6]);

/* Packs part `number` of `count` parts, count 1 to FXS_PARTS_MOST. The whole file is read, but only the part's
   headers and rows are in memory. The report is for the whole scene, without losses. All checksums of `part` are 0;
   free it with fxs_packed_scene_free. Errors are those of fxs_pack, or FXS_ERR_ARGUMENT if the scene has fewer
   chunks than parts. */
int fxs_pack_part(fxs_scene_file *file, const fxs_scene_file_info *info, uint32_t number, uint32_t count,
                  fxs_packed_scene *part, fxs_pack_report *report, const fxs_pack_options *options,
                  fxs_message *message);

#endif
