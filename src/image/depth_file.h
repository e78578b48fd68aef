/* Writes depth and id targets of a frame to files. Rows from the top, no padding between rows. */
#ifndef FXS_DEPTH_FILE_H
#define FXS_DEPTH_FILE_H

#include <fixsplat/message.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Depths times 2^depth_bits, FXS_NOTHING where there is none, as in fxs_targets. */
typedef struct fxs_depths {
    const uint32_t *pixels;
    int width, height, depth_bits;
} fxs_depths;

/* The largest depth, scene units; 0 where there is none. */
double fxs_depths_farthest(const fxs_depths *depths);

/* Writes depths as .png (16 bits grey, by zlib) or .pfm (32-bit floats in scene units, little-endian, rows from the
   bottom; infinity where there is no depth), by the ending of the name. In a .png, a value v, 1 to 65535, is the
   rounded depth v * range / 65535; farther depths are 65535, and 0 is no depth. The file is written as output.h says.
   Returns 0, or an FXS_ERR_* and a message. */
int fxs_depth_file_write(const char *path, const fxs_depths *depths, double range, fxs_message *message);

/* Writes ids as .png (false colours, black where there is no Gaussian; with `by_object`, a hue for each object and
   shades of it for its Gaussians, else a colour for each Gaussian) or .raw (for each pixel the object's id and the
   Gaussian's number, both 4 bytes, little-endian). Returns the same as fxs_depth_file_write. */
int fxs_id_file_write(const char *path, const fxs_id *ids, int width, int height, int by_object, fxs_message *message);

/* 1 where the function above knows the ending of the name, else 0. */
int fxs_depth_file_known(const char *path);
int fxs_id_file_known(const char *path);

#ifdef __cplusplus
}
#endif

#endif
