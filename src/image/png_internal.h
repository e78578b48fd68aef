/* Encodes a picture as .png, by zlib, or by libdeflate in half the time. */
#ifndef FXS_PNG_INTERNAL_H
#define FXS_PNG_INTERNAL_H

#include <fixsplat/image_file.h>

/* Bits of a channel and the kind of colour, as in IHDR. */
enum { FXS_PNG_GREY_16 = 16 << 8 | 0, FXS_PNG_RGB = 8 << 8 | 2, FXS_PNG_RGBA = 8 << 8 | 6 };

/* Makes room for `bytes` bytes in encoded->memory; null where memory ran out. */
uint8_t *fxs_encoded_room(fxs_encoded *encoded, size_t bytes);

/* 1 where every alpha byte is 255. */
int fxs_image_opaque(const uint8_t *rgba, size_t pixels);

/* 16-bit channels are big-endian. FXS_PNG_RGB takes RGBA too, and leaves out alpha. Returns 0, FXS_ERR_MEMORY, or
   FXS_ERR_UNSUPPORTED where fixsplat was built without zlib. */
int fxs_png_encode(int kind, const uint8_t *pixels, int width, int height, fxs_encoded *png);

#endif
