/* CRC-32, eight bytes at a time. */
#include <stdint.h>
#include <string.h>

#include "zlib/zlib.h"

#define POLYNOMIAL 0xedb88320u     /* x^32 + x^26 + ..., bits in reverse */

static uint32_t after[8][256];     /* [k][b]: what byte b is with k bytes 0 behind it */

static void fill_table(void)
{
    for (uint32_t b = 0; b < 256; b++) {
        uint32_t crc = b;
        for (int bit = 0; bit < 8; bit++)
            crc = crc >> 1 ^ (crc & 1 ? POLYNOMIAL : 0);
        after[0][b] = crc;
    }
    for (int k = 1; k < 8; k++)
        for (uint32_t b = 0; b < 256; b++)
            after[k][b] = after[k - 1][b] >> 8 ^ after[0][after[k - 1][b] & 255];
}

static uint32_t next_eight(uint32_t crc, const unsigned char *bytes)
{
    uint64_t eight;
    memcpy(&eight, bytes, sizeof eight);
    eight ^= crc;
    crc = 0;
    for (int k = 0; k < 8; k++)
        crc ^= after[7 - k][eight >> 8 * k & 255];
    return crc;
}

uLong crc32(uLong start, const unsigned char *bytes, uInt count)
{
    uint32_t crc = ~(uint32_t)start;
    if (!after[0][1])
        fill_table();
    for (; count >= 8; count -= 8, bytes += 8)
        crc = next_eight(crc, bytes);
    for (; count > 0; count--)
        crc = crc >> 8 ^ after[0][(crc ^ *bytes++) & 255];
    return ~crc;
}
