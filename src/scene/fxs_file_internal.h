/* The checks of fxs_file_check by parts, for a file that is not in memory as a whole. Each returns 0, or an error and a
   message that begins with the path. */
#ifndef FXS_FXS_FILE_INTERNAL_H
#define FXS_FXS_FILE_INTERNAL_H

#include <fixsplat/message.h>

#include "src/base/crc32.h"

/* The header of a file, its first 192 bytes: what it is, and its checksum. */
int fxs_file_check_header(const char *path, const fxs_crc32_table *table, const void *header, fxs_message *message);

/* What lies before the rows: the palette, of `palette_bytes` with the zeros behind it, and the nodes. `head` begins
   with the header. */
int fxs_file_check_heads(const char *path, const fxs_crc32_table *table, const void *head, const fxs_scene *scene,
                         size_t palette_bytes, fxs_message *message);

/* The header of a chunk with its rows, wherever those are. */
int fxs_file_check_chunk(const char *path, const fxs_crc32_table *table, const fxs_scene *scene, uint32_t chunk,
                         const unsigned char *rows, fxs_message *message);

/* Fills in the checksums of a header with the palette of so many bytes, which ends what lies at `head`, and of a tree
   (or null), whose header and nodes have so many bytes. Their chunks have theirs. */
void fxs_file_seal_heads(const fxs_crc32_table *table, unsigned char *head, size_t palette_bytes, unsigned char *tree,
                         size_t tree_bytes);

#endif
