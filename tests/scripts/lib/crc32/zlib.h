/* Of zlib what .fxs files need, for the processors of processors.sh, of which no zlib is here. */
#ifndef CRC32_ZLIB_H
#define CRC32_ZLIB_H

typedef unsigned int uInt;
typedef unsigned long uLong;

/* CRC-32 of ISO 3309, bit by bit. */
static inline uLong crc32(uLong crc, const unsigned char *bytes, uInt size)
{
    crc ^= 0xffffffffu;
    while (bytes && size-- > 0) {
        crc ^= *bytes++;
        for (int bit = 0; bit < 8; bit++)
            crc = crc & 1 ? crc >> 1 ^ 0xedb88320u : crc >> 1;
    }
    return crc ^ 0xffffffffu;
}

#endif
