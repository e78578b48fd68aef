/* Writes depth and id targets of a frame. Targets begin with the top row and have no padding. */
#ifndef FXS_DEPTH_FILE_H
#define FXS_DEPTH_FILE_H

#include <fixsplat/internal/message.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Depths times 2^depth_bits; FXS_NOTHING: no depth. */
typedef struct fxs_depths {
    const uint32_t *pixels;
    int width, height, depth_bits;
} fxs_depths;

/* Returns the largest depth in scene units; 0: no depth. */
double fxs_depths_farthest(const fxs_depths *depths);

/* Writes depths by the ending of the name. .png: 16-bit grey, v of 1 to 65535 is the depth v * range / 65535,
   clamped; 0: no depth. .pfm: little-endian floats, bottom row first; infinity: no depth. Returns 0, or an error
   and a message. */
int fxs_depth_file_write(const char *path, const fxs_depths *depths, double range, fxs_message *message);

/* Writes ids by the ending of the name. .png: false colours, black without a Gaussian; by_object: 1 gives each
   object a hue, 0 each Gaussian a colour. .raw: object id and Gaussian number, each 4 bytes, little-endian.
   Returns 0, or an error and a message. */
int fxs_id_file_write(const char *path, const fxs_id *ids, int width, int height, int by_object, fxs_message *message);

/* Returns 1 if the ending of a file name is supported, else 0. */
int fxs_depth_file_known(const char *path);
int fxs_id_file_known(const char *path);

#ifdef __cplusplus
}
#endif

#endif
