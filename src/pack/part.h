/* A part of a packed scene: a run of its chunks, packed apart from the others, with what is needed to make one scene of
 * all parts again, the same as if it had been packed at once.
 *
 * All numbers are little-endian, and each of these begins at a multiple of 64 bytes:
 *
 *   fxs_part_header
 *   fxs_packed_header                  of the whole scene, without checksums
 *   fxs_chunk[chunk_count]
 *   int8_t palette[stages][entries][48], int16_t groups[stages][16][48]   the palette, and the middles of its groups
 *   rows[chunk_count]
 *
 * and of a scene with a tree, of the nodes whose leaves all lie in the run, in the order of their numbers:
 *
 *   fxs_node_sums[node_count]
 *   fxs_chunk[node_count]
 *   rows[node_count]
 *   top[top_count]                     FXS_TREE_TOP_BYTES each: those with a parent that has leaves in other parts too
 *
 * A part is no scene: what it holds has no meaning but for a program of the same version that merges it. */
#ifndef FXS_PART_H
#define FXS_PART_H

#include <fixsplat/pack.h>
#include <fixsplat/packed.h>
#include "src/base/crc32.h"
#include "tree.h"

#define FXS_PART_MAGIC 0x50535846u        /* "FXSP" */
#define FXS_PART_VERSION 1u
#define FXS_PARTS_MOST 512                /* all are open while they are merged */

typedef struct fxs_part_header {          /* 64 bytes */
    uint32_t magic, version;
    uint32_t program;                     /* FXS_VERSION_NUMBER of the one that made it */
    uint32_t number, count;               /* this one, from 1 on; of all parts */
    uint32_t first, chunk_count;          /* its run of the scene's chunks */
    uint32_t node_count, top_count;
    uint32_t source[2];                   /* a hash of all Gaussians that were read, in their order */
    uint32_t boxes;                       /* CRC-32 of the boxes of all chunks of the scene, little-endian floats */
    int32_t unit_exponent, centred;       /* of the palette */
    uint32_t head_checksum;               /* CRC-32 of all before the rows, with 0 here and in tree_checksum, */
    uint32_t tree_checksum;               /* and of the sums, the nodes' headers and the tops. Rows: as in an .fxs */
} fxs_part_header;

typedef char fxs_part_header_is_64[sizeof(fxs_part_header) == 64 ? 1 : -1];

static inline void fxs_part_header_turn(fxs_part_header *header)
{
    fxs_little_endian(header, 0, sizeof *header / 4, 4);
}

/* Where what a part has begins, and its bytes. */
typedef struct fxs_part_layout {
    uint64_t scene, chunks, palette, groups, rows, sums, node_chunks, node_rows, tops, bytes;
} fxs_part_layout;

/* Both headers are in this processor's byte order. Returns 0, or FXS_ERR_FILE where one is none or they do not go
   together. */
int fxs_part_lay_out(fxs_part_layout *layout, const fxs_part_header *part, const fxs_packed_header *scene);

/* The first chunk of part `number` of `count`; that of part count + 1 is the end. */
uint32_t fxs_part_first(uint32_t chunks, uint32_t number, uint32_t count);

/* Adds the box of a chunk to the checksum of boxes. */
uint32_t fxs_part_add_box(const fxs_crc32_table *table, uint32_t checksum, const float box[6]);

/* Packs part `number` of `count`, 1 to FXS_PARTS_MOST, as fxs_pack packs the whole: the same Gaussians have the same
   bytes. The file is read as often, as the order and the palette are of the whole scene, but only the run's headers and
   rows are kept. The report has the whole scene's numbers, without losses. `part` is as above, with checksums of 0, for
   fxs_packed_scene_free. Errors: those of fxs_pack; FXS_ERR_ARGUMENT where the scene has fewer chunks than parts. */
int fxs_pack_part(fxs_scene_file *file, const fxs_scene_file_info *info, uint32_t number, uint32_t count,
                  fxs_packed_scene *part, fxs_pack_report *report, const fxs_pack_options *options,
                  fxs_message *message);

#endif
