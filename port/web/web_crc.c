/* The CRC-32 functions that zlib and libzip call. */
#include "src/base/crc32.h"

unsigned long crc32(unsigned long crc, const unsigned char *bytes, unsigned count);

unsigned long crc32(unsigned long crc, const unsigned char *bytes, unsigned count)
{
    static fxs_crc32_table table;
    if (!table.after[0][1])
        fxs_crc32_fill(&table);
    return fxs_crc32(&table, (uint32_t)crc, bytes, count);
}
