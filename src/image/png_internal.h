/* Encodes .png files with zlib, or faster with libdeflate. */
#ifndef FXS_PNG_INTERNAL_H
#define FXS_PNG_INTERNAL_H

#include <fixsplat/image.h>

/* Kinds of .png: bits per channel and colour type, as in the PNG header. */
enum { FXS_PNG_GREY_16 = 16 << 8 | 0, FXS_PNG_RGB = 8 << 8 | 2, FXS_PNG_RGBA = 8 << 8 | 6 };

uint8_t *fxs_encoded_room(fxs_encoded *encoded, size_t bytes);

int fxs_image_opaque(const uint8_t *rgba, size_t pixels);

/* Encodes pixels as a .png. 16-bit channels are big-endian. FXS_PNG_RGB also takes RGBA and drops alpha. Returns 0,
   FXS_ERR_MEMORY, or FXS_ERR_UNSUPPORTED without zlib. */
int fxs_png_encode(int kind, const uint8_t *pixels, int width, int height, fxs_encoded *png);

#endif
