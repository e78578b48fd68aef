/* Writes depth and id targets of a frame to files. Targets begin with the top row, without padding. */
#ifndef FXS_DEPTH_FILE_H
#define FXS_DEPTH_FILE_H

#include <fixsplat/internal/message.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Depths times 2^depth_bits; FXS_NOTHING: no depth. As in fxs_targets. */
typedef struct fxs_depths {
    const uint32_t *pixels;
    int width, height, depth_bits;
} fxs_depths;

/* The largest depth in scene units; 0 if no pixel has a depth. */
double fxs_depths_farthest(const fxs_depths *depths);

/* Writes depths by the ending of the name. .png: 16-bit grey, needs zlib; value v, 1 to 65535, is the depth v *
   range / 65535, rounded; farther depths become 65535; 0: no depth. .pfm: little-endian 32-bit floats in scene
   units, from the bottom row; infinity: no depth. Outputs are written as output.h describes. Returns 0, or an
   FXS_ERR_* and a message. */
int fxs_depth_file_write(const char *path, const fxs_depths *depths, double range, fxs_message *message);

/* Writes ids by the ending of the name. .png: false colours, black without a Gaussian; by_object: 1 gives each
   object a hue and its Gaussians shades of it, 0 gives each Gaussian a colour. .raw: per pixel the object's id and
   the Gaussian's number, each 4 bytes, little-endian. Returns as fxs_depth_file_write. */
int fxs_id_file_write(const char *path, const fxs_id *ids, int width, int height, int by_object, fxs_message *message);

/* 1 if the ending of a name is known to the writer above, else 0. */
int fxs_depth_file_known(const char *path);
int fxs_id_file_known(const char *path);

#ifdef __cplusplus
}
#endif

#endif
