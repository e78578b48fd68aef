/* Writes depths and ids of a frame to files. The pixels begin with the top row and have no padding. */
#ifndef FXS_DEPTH_FILE_H
#define FXS_DEPTH_FILE_H

#include <fixsplat/internal/message.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A picture of depths, each times 2^depth_bits; FXS_NOTHING: no depth. */
typedef struct fxs_depths {
    const uint32_t *pixels;
    int width, height, depth_bits;
} fxs_depths;

/* Returns the largest depth of a picture in scene units, or 0 if no pixel has a depth. */
double fxs_depths_farthest(const fxs_depths *depths);

/* Writes a picture of depths in the format of the file name's ending. .png: 16-bit grey, where value v of 1 to 65535 is
   the depth v * range / 65535, clamped; 0: no depth. .pfm: little-endian floats, bottom row first; infinity: no depth.
   .exr: OpenEXR, the same floats as channel Z, uncompressed. Returns 0, or an error and a message. */
int fxs_depth_file_write(const char *path, const fxs_depths *depths, double range, fxs_message *message);

/* Writes a picture of ids in the format of the file name's ending. .png: false colours, black without a Gaussian.
   by_object: 1 gives each object a hue, 0 each Gaussian a colour. .raw: object id and Gaussian number, each 4 bytes,
   little-endian. Returns 0, or an error and a message. */
int fxs_id_file_write(const char *path, const fxs_id *ids, int width, int height, int by_object, fxs_message *message);

/* Return 1 if the ending of a file name is supported for depths or for ids, else 0. */
int fxs_depth_file_known(const char *path);
int fxs_id_file_known(const char *path);

#ifdef __cplusplus
}
#endif

#endif
