/* CRC-32 as in zlib and ISO 3309. */
#ifndef FXS_CRC32_H
#define FXS_CRC32_H

#include <stddef.h>
#include <stdint.h>

typedef struct fxs_crc32_table {
    uint32_t after[8][256];        /* after[k][b]: checksum of byte b followed by k zero bytes */
} fxs_crc32_table;

void fxs_crc32_fill(fxs_crc32_table *table);

/* Extends the CRC-32 checksum `crc` by `count` bytes. The checksum of no bytes is 0. */
uint32_t fxs_crc32(const fxs_crc32_table *table, uint32_t crc, const void *bytes, size_t count);

#endif
