#include "crc32.h"

#define POLYNOMIAL 0xedb88320u     /* CRC-32 polynomial, bits in reverse order */

void fxs_crc32_fill(fxs_crc32_table *table)
{
    uint32_t (*after)[256] = table->after;
    for (uint32_t b = 0; b < 256; b++) {
        uint32_t crc = b;
        for (int bit = 0; bit < 8; bit++)
            /* The operator ?: is avoided, because gcc 12 for ARM miscompiles it here. */
            crc = crc >> 1 ^ ((0u - (crc & 1)) & POLYNOMIAL);
        after[0][b] = crc;
    }
    for (int k = 1; k < 8; k++)
        for (uint32_t b = 0; b < 256; b++)
            after[k][b] = after[k - 1][b] >> 8 ^ after[0][after[k - 1][b] & 255];
}

/* Extends a CRC-32 by eight bytes at once (slicing by 8). */
static uint32_t next_eight(const fxs_crc32_table *table, uint32_t crc, const unsigned char *bytes)
{
    uint32_t next = 0;
    for (int k = 0; k < 4; k++, crc >>= 8)
        next ^= table->after[7 - k][(bytes[k] ^ crc) & 255] ^ table->after[3 - k][bytes[4 + k]];
    return next;
}

uint32_t fxs_crc32(const fxs_crc32_table *table, uint32_t crc, const void *data, size_t count)
{
    const unsigned char *bytes = data;
    for (crc = ~crc; count >= 8; count -= 8, bytes += 8)
        crc = next_eight(table, crc, bytes);
    for (; count > 0; count--)
        crc = crc >> 8 ^ table->after[0][(crc ^ *bytes++) & 255];
    return ~crc;
}
