/* The one function of zlib that an .fxs file needs (crc.c): the browser inflates. */
#ifndef FXS_WEB_ZLIB_H
#define FXS_WEB_ZLIB_H

typedef unsigned long uLong;
typedef unsigned uInt;

uLong crc32(uLong crc, const unsigned char *bytes, uInt count);

#endif
