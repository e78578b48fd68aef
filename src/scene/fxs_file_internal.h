/* Checks parts of a packed scene (.fxs file) that is not completely in memory. Functions return 0, or an error and a
   message. */
#ifndef FXS_FXS_FILE_INTERNAL_H
#define FXS_FXS_FILE_INTERNAL_H

#include <fixsplat/internal/message.h>

#include "src/base/crc32.h"

/* Checks the 192-byte header of an .fxs file and the header's checksum. */
int fxs_file_check_header(const char *path, const fxs_crc32_table *table, const void *header, fxs_message *message);

/* Checks the SH palette and the nodes of the level-of-detail tree of an .fxs file. `head` begins with the file's
   header. `palette_bytes` includes padding. */
int fxs_file_check_heads(const char *path, const fxs_crc32_table *table, const void *head, const fxs_scene *scene,
                         size_t palette_bytes, fxs_message *message);

int fxs_file_check_chunk(const char *path, const fxs_crc32_table *table, const fxs_scene *scene, uint32_t chunk,
                         const unsigned char *rows, fxs_message *message);

/* Fills in three checksums of an .fxs file: of the header and the SH palette in `head`, and of the level-of-detail
   tree. `tree` may be null. The chunks (256 Gaussians each) must already have checksums. */
void fxs_file_seal_heads(const fxs_crc32_table *table, unsigned char *head, size_t palette_bytes, unsigned char *tree,
                         size_t tree_bytes);

#endif
