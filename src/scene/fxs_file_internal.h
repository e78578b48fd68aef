/* The checks of fxs_file_check in parts, for a file that is not completely in memory. Each returns 0, or an error and a
   message that begins with the path. */
#ifndef FXS_FXS_FILE_INTERNAL_H
#define FXS_FXS_FILE_INTERNAL_H

#include <fixsplat/internal/message.h>

#include "src/base/crc32.h"

/* Checks a file's header (192 bytes) and its checksum. */
int fxs_file_check_header(const char *path, const fxs_crc32_table *table, const void *header, fxs_message *message);

/* Checks the palette (`palette_bytes` with padding) and the nodes. `head` begins with the header. */
int fxs_file_check_heads(const char *path, const fxs_crc32_table *table, const void *head, const fxs_scene *scene,
                         size_t palette_bytes, fxs_message *message);

/* Checks the header of a chunk and its rows. */
int fxs_file_check_chunk(const char *path, const fxs_crc32_table *table, const fxs_scene *scene, uint32_t chunk,
                         const unsigned char *rows, fxs_message *message);

/* Fills in the checksums of the header and palette at `head` and of the tree header at `tree`. The last `palette_bytes`
   of the block at `head` are the palette. `tree`: header and nodes, `tree_bytes` together, or null. The chunks must
   already have their checksums. */
void fxs_file_seal_heads(const fxs_crc32_table *table, unsigned char *head, size_t palette_bytes, unsigned char *tree,
                         size_t tree_bytes);

#endif
